//! The platform at sea as outside programs call it: what it prints and what it writes.

use crate::support::{figure, good, json, keys, number, numbers, run};

const MARINE: &str = env!("CARGO_BIN_EXE_marine");
const COORDINATES: [&str; 4] = ["heave", "roll", "pitch", "yaw"];

#[test]
fn the_report_fits_together() {
    let text = good(MARINE, &["--json"]);
    let found = json(&text);
    let sea = &found["sea"];
    assert!((number(&sea["variance"]) - 2.5_f64.powi(2) / 16.0).abs() < 1e-12);
    assert!((number(&sea["variance_of_the_waves"]) - number(&sea["variance"])).abs() < 1e-12);
    assert!((number(&sea["record"]["significant_wave_height"]) / 2.5 - 1.0).abs() < 0.1, "{sea}");
    let (asked, measured) = (number(&sea["zero_crossing_period"]), number(&sea["record"]["zero_crossing_period"]));
    assert!((asked - 7.774).abs() < 1e-3 && (measured / asked - 1.0).abs() < 0.1, "{sea}");

    // The formulas of the textbook, worked out by hand.
    let periods = &found["platform"]["natural_periods"];
    for (name, period) in COORDINATES.into_iter().zip([11.578, 19.340, 13.094, 60.079]) {
        assert!((number(&periods[name]) - period).abs() < 1e-3, "{periods}");
    }
    for run in ["uncontrolled", "controlled"] {
        let poles = numbers(&found["poles"][run]);
        assert!(poles.chunks(2).all(|pole| pole[0] < 0.0), "{poles:?}");
        for name in COORDINATES {
            let of = &found[run][name];
            assert!((number(&of["significant_double_amplitude"]) - 4.0 * number(&of["rms"])).abs() < 1e-12);
            assert!(number(&of["greatest"]) > 2.0 * number(&of["rms"]), "{run} {name}: {of}");
        }
        assert!(number(&found[run]["least_air_gap"]) > 0.0 && number(&found[run]["least_column_depth"]) > 0.0);
        let landings = found[run]["touchdowns"].as_array().unwrap();
        assert_eq!((landings.len(), &landings[0]), (10, &found[run]["touchdown"]));
        for landing in landings {
            assert!((number(&landing["time"]) - 13.25).abs() < 0.05, "{landing}");
            assert!((number(&landing["relative_velocity"]) + 0.2).abs() < 0.01, "{landing}");
            assert!(number(&landing["horizontal_offset"]) < 0.05, "{landing}");
        }
    }
    for name in COORDINATES {
        let [before, after] = ["uncontrolled", "controlled"].map(|run| number(&found[run][name]["rms"]));
        let ratio = number(&found["rms_ratio"][name]);
        assert!(ratio < 0.9 && (ratio - after / before).abs() < 1e-12, "{name}: {ratio}");
    }
    let thrusters = found["thrusters"].as_object().unwrap();
    assert_eq!(thrusters.len(), 6);
    for (name, of) in thrusters {
        assert!(number(&of["greatest"]) <= number(&of["limit"]) && number(&of["rms"]) > 0.0, "{name}: {of}");
    }
    let assumed = keys(&found["assumed"]);
    for key in ["marine.freedoms", "marine.hull", "marine.weather", "marine.control", "quadrotor.guidance"] {
        assert!(assumed.contains(&key), "{assumed:?}");
    }
    // A seed is a sea.
    assert_eq!(good(MARINE, &["--json"]), text);
    let other = json(&good(MARINE, &["--json", "--seed", "2"]));
    assert_ne!(other["uncontrolled"], found["uncontrolled"]);
    assert_eq!(other["platform"], found["platform"]);
}

#[test]
fn figures_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let summary = good(MARINE, &["--out", folder.path().to_str().unwrap()]);
    assert!(summary.contains("Hs = 2.5 m") && summary.contains("assumed"), "{summary}");
    for name in ["sea", "response", "motion", "thrust", "spectra"] {
        figure(folder.path(), &format!("marine_{name}"));
    }
    // The motion in the table has the root mean square of the summary.
    let table = std::fs::read_to_string(folder.path().join("marine_motion.csv")).unwrap();
    let heave: Vec<f64> = table.lines().skip(1).map(|line| line.split(',').nth(2).unwrap().parse().unwrap()).collect();
    let mean = heave.iter().sum::<f64>() / heave.len() as f64;
    let rms = (heave.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / heave.len() as f64).sqrt();
    assert!(summary.contains(&format!(" {rms:.3} ")), "{rms}: {summary}");
}

#[test]
fn weathers_that_there_are_not_are_refused() {
    for (arguments, code, words) in [
        (["--height", "0"], 1, "significant wave height must be positive, it is 0"),
        (["--height", "NaN"], 1, "it is NaN"),
        (["--period", "-3"], 1, "peak period must be positive, it is -3"),
        (["--period", "4"], 1, "steepness 2π Hs/(g Tp²) of the waves must be at most 0.0666"),
        (["--wind", "-1"], 1, "mean wind must not be negative, it is -1"),
        (["--height", "high"], 2, "--height"),
        (["--seed", "first"], 2, "--seed"),
    ] {
        let output = run(MARINE, &arguments);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {complaint}");
        assert!(output.stdout.is_empty() && complaint.contains(words), "{arguments:?}: {complaint}");
    }
}
