//! The planned landings as outside programs call them: limits in flight, times, what is written.

use crate::support::{figure, good, json, number, numbers, run};
use mbs_examples::assumed;
use mbs_landing::quadrotor::predictive::controller::{Descent, Horizon};
use mbs_landing::quadrotor::predictive::limits::Limits;
use serde_json::Value;

const MPC: &str = env!("CARGO_BIN_EXE_mpc");

#[test]
fn planned_landings_keep_their_limits_and_are_shorter_than_the_guided_one() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(MPC, &["--json", "--case", "I", "--out", folder.path().to_str().unwrap()]));
    let case = &found["cases"]["I"];
    let time = |flight: &Value| number(&flight["touchdown_time"]);
    for name in ["shortest", "with_reserve"] {
        for residual in ["stationarity", "continuity", "complementarity"] {
            assert!(number(&case[name][residual]) < 1e-5, "{name}: {}", case[name]);
        }
    }
    assert!(time(&case["shortest"]) < time(&case["with_reserve"]));
    // Of the same world as `quadrotor_landing`.
    assert!((time(&case["guided"]) - 13.25464).abs() < 1e-4, "{}", case["guided"]);
    for (kind, latest) in [("replanned", 2.2), ("predictive", 7.0)] {
        for air in ["calm", "windy"] {
            let flight = &case[kind][air];
            assert!(time(flight) < latest && time(flight) > time(&case["shortest"]) - 1e-3, "{kind} {air}: {flight}");
            // What is assumed of the touchdown, tilt, camera and rotors: 2.2 m g/4 of 40 kg.
            assert!(number(&flight["relative_velocity"]) > -0.3 && number(&flight["offset"]) < 0.1, "{flight}");
            assert!(
                number(&flight["greatest_tilt_deg"]) < 25.0 && number(&flight["least_visibility"]) > 0.0,
                "{flight}"
            );
            assert!(number(&flight["least_height"]) > 0.0, "{flight}");
            let thrust = numbers(&flight["rotor_thrust"]);
            let quarter = 40.0 * 9.80665 / 4.0;
            assert!(thrust[0] > 0.05 * quarter - 1e-6 && thrust[1] < 2.2 * quarter + 1e-6, "{flight}");
        }
    }
    let saved = found["looser"].as_object().unwrap();
    assert!(saved.len() == 6 && saved.values().all(|time| number(time) < number(&saved["none"]) + 1e-5), "{saved:?}");
    for key in ["predictive.view", "predictive.touchdown", "predictive.disturbance", "quadrotor.limits"] {
        assert!(found["assumed"][key]["value"].is_string(), "{key}");
    }
    for name in ["mpc_landing_I", "mpc_planning_I"] {
        figure(folder.path(), name);
    }
    // The last row is not beyond the touchdown.
    let table = std::fs::read_to_string(folder.path().join("mpc_shortest_I_calm.csv")).unwrap();
    let last: f64 = table.lines().last().unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((0.0..0.011).contains(&(time(&case["replanned"]["calm"]) - last)), "{last}");
}

#[test]
fn what_is_no_horizon_is_told() {
    for (arguments, code, complaint) in [
        (["--horizon", "nan"], 1, "horizon.duration must be positive and finite, it is NaN"),
        (["--intervals", "0"], 2, "0 is not in 2..=200"),
        (["--case", "III"], 2, "invalid value 'III'"),
    ] {
        let output = run(MPC, &arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(complaint) && output.stdout.is_empty(), "{error}");
    }
}

/// Rows of the page of assumed values are what the controller is made with.
#[test]
fn assumed_values_are_those_of_the_controller() {
    let (Limits { thrust, tilt, view, touchdown }, horizon, descent) =
        (Limits::default(), Horizon::default(), Descent::default());
    let end = [touchdown.sink_rate, touchdown.horizontal_speed, touchdown.offset, touchdown.tilt.to_degrees()];
    let wanted: [(&str, Vec<f64>); 7] = [
        ("quadrotor.limits", vec![thrust[0], thrust[1], tilt.to_degrees()]),
        ("predictive.view", vec![view.half_angle.to_degrees(), view.mark]),
        ("predictive.touchdown", [&end[..], &[touchdown.rate]].concat()),
        ("predictive.horizon", vec![horizon.period, horizon.duration, horizon.intervals as f64]),
        ("predictive.deviations", horizon.deviations.into()),
        ("predictive.learning", vec![horizon.learning]),
        ("predictive.descent", vec![descent.speed, descent.touchdown, descent.slowing, descent.limit]),
    ];
    for (key, want) in wanted {
        let [row] = assumed::of(&[key])[..] else { panic!("{key} is one row") };
        let found: Vec<f64> = row.value.split([' ', ',', ';']).filter_map(|word| word.parse().ok()).collect();
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12 * (1.0 + b.abs());
        assert!(found.len() == want.len() && found.iter().zip(&want).all(is_close), "{key}: {found:?}, {want:?}");
    }
}
