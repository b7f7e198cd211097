//! The examples of orbits as outside programs call them, against the reference values of `tests/data/orbit.json` and
//! `orbit_relative.json`.

use crate::support::{figure, good, json, keys, numbers};
use serde_json::Value;

const TWO_BODY: &str = env!("CARGO_BIN_EXE_two_body");
const THREE_BODY: &str = env!("CARGO_BIN_EXE_three_body");
const RELATIVE_MOTION: &str = env!("CARGO_BIN_EXE_relative_motion");

/// Periods of the stations \[s\].
const CIRCLE: f64 = 5_553.624_271_252_228;
const ELLIPSE: f64 = 6_464.022_739_908_78;

/// Those at this time.
fn after(samples: &[Value], time: f64) -> impl Iterator<Item = &Value> {
    // Periods are powers, and differ in their last bit from one library to the next.
    samples.iter().filter(move |sample| (sample["t_s"].as_f64().unwrap() - time).abs() < 1e-9)
}

fn reference() -> Value {
    json(include_str!("../../../tests/data/orbit.json"))
}

/// What the program prints, and a folder in which it wrote these figures and tables.
fn printed(program: &str, figures: &[&str], tables: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let value = json(&good(program, &["--json", "--out", folder.path().to_str().unwrap()]));
    for name in figures {
        figure(folder.path(), name);
    }
    for name in tables {
        assert!(folder.path().join(format!("{name}.csv")).metadata().unwrap().len() > 1000, "{name}");
    }
    value
}

#[track_caller]
fn near(what: &str, found: &Value, expected: &Value, tolerance: f64) {
    let (found, expected) = (numbers(found), numbers(expected));
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected}");
    }
}

#[test]
fn two_bodies() {
    let (found, expected) =
        (printed(TWO_BODY, &["two_body_barycentre", "two_body_relative"], &["two_body"]), reference());
    assert_eq!(keys(&found), ["dimensionless", "earth_moon", "drift", "assumed"]);
    for (way, tolerance) in [("kepler", 1e-13), ("dop853", 1e-12)] {
        let samples = found["dimensionless"][way].as_array().unwrap();
        for (sample, expected) in samples.iter().zip(expected["dimensionless"].as_array().unwrap()) {
            assert_eq!(sample["t"], expected["t"]);
            near(way, &sample["state"], &expected["state"], tolerance);
        }
        assert_eq!(samples.len(), 5);
    }
    for body in ["body1_m", "body2_m"] {
        near(body, &found["earth_moon"][body], &expected["earth_moon"][body], 1e-3);
    }
    near("barycentre", &found["earth_moon"]["barycentre_m"], &json("[0, 0, 0]"), 1e-6);
    assert!(numbers(&found["drift"]["barycentre_m"])[0] < 1e-6);
    for drift in ["energy", "angular_momentum", "laplace_vector", "earth_moon_energy", "earth_moon_angular_momentum"] {
        assert!(numbers(&found["drift"][drift])[0] < 1e-12, "{drift}");
    }
}

#[test]
fn three_bodies() {
    let (found, expected) = (printed(THREE_BODY, &["arenstorf", "tadpole", "horseshoe"], &["arenstorf"]), reference());
    for pair in ["earth_moon", "arenstorf"] {
        near(pair, &found["libration"][pair], &expected["libration"][pair], 1e-12);
        let growth = numbers(&found["libration_growth"][pair]);
        assert!(growth[..3].iter().all(|growth| *growth > 0.1) && growth[3..] == [0.0, 0.0], "{growth:?}");
    }
    assert!(numbers(&found["arenstorf_return_error"])[0] <= 1e-9);
    assert!(numbers(&found["jacobi_drift"])[0] <= 1e-12);
    assert_eq!(keys(&found["assumed"]), ["three_body.asteroids"]);
    for asteroid in ["tadpole", "horseshoe"] {
        assert!(numbers(&found["asteroids"][asteroid]["jacobi_drift"])[0] <= 1e-12, "{asteroid}");
    }
}

/// The tadpole stays on the side of L₄; the horseshoe passes L₃ and both L₄ and L₅, and turns round before the planet.
#[test]
fn asteroids_keep_company() {
    let folder = tempfile::tempdir().unwrap();
    good(THREE_BODY, &["--json", "--out", folder.path().to_str().unwrap()]);
    let angles = |name: &str| -> Vec<f64> {
        let table = std::fs::read_to_string(folder.path().join(format!("{name}.csv"))).unwrap();
        let place = |row: &str| row.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
        table.lines().skip(1).map(place).map(|row| row[2].atan2(row[1]).to_degrees()).collect()
    };
    let tadpole = angles("tadpole");
    assert!(tadpole.iter().all(|angle| (20.0..160.0).contains(angle)));
    assert!(tadpole.iter().any(|angle| *angle < 55.0) && tadpole.iter().any(|angle| *angle > 65.0));
    let horseshoe = angles("horseshoe");
    assert!(horseshoe.iter().all(|angle| angle.abs() > 10.0));
    for passed in [-60.0, 60.0, 175.0, -175.0] {
        assert!(horseshoe.iter().any(|angle| (angle - passed).abs() < 5.0), "{passed}");
    }
}

#[test]
fn motion_about_a_station() {
    let figures = ["figure_7_3", "figure_7_4", "near_with_station_mass", "elliptic_near", "elliptic_far"];
    let (found, expected) = (printed(RELATIVE_MOTION, &figures, &["circular_far_radial"]), reference());
    let motions = json(include_str!("../../../tests/data/orbit_relative.json"));
    let check = |group: &str, case: &str, sample: &Value| {
        for what in ["position_km", "velocity_km_s", "position_m", "velocity_m_s"] {
            let Some(value) = sample.get(what) else { continue };
            // Kilometres; near the station metres.
            let is_far_or_metres = case.starts_with("far") || what.ends_with("_m") || what.ends_with("_m_s");
            let tolerance = if is_far_or_metres { 1e-9 } else { 1e-12 };
            near(&format!("{group} {case} {what}"), &found[group][case][what], value, tolerance);
        }
    };
    for (group, motions, period) in
        [("circular", &motions["relative_circular"], CIRCLE), ("elliptic", &motions["relative_elliptic"], ELLIPSE)]
    {
        assert_eq!(keys(&found[group]), keys(motions), "{group}");
        for (case, motion) in motions.as_object().unwrap() {
            check(group, case, after(motion["samples"].as_array().unwrap(), period).next().unwrap());
        }
    }
    let with_mass: Vec<&Value> = after(motions["relative_with_station_mass"].as_array().unwrap(), CIRCLE).collect();
    let names: Vec<&str> = with_mass.iter().map(|sample| sample["case"].as_str().unwrap()).collect();
    assert_eq!(keys(&found["station_mass"]), names);
    with_mass.iter().zip(names).for_each(|(sample, case)| check("station_mass", case, sample));
    // Against the difference of two Kepler motions, and in cylindrical coordinates, which lose digits near the station
    // [m].
    for (group, case) in
        [("circular", "far_radial"), ("circular", "near_radial"), ("elliptic", "near"), ("elliptic", "far")]
    {
        let [kepler, cylindrical] =
            ["kepler_difference_m", "cylindrical_difference_m"].map(|key| numbers(&found[group][case][key])[0]);
        let tolerance = if case.starts_with("far") { [1e-7, 1e-5] } else { [1e-11, 1e-6] };
        assert!(kepler <= tolerance[0] && cylindrical <= tolerance[1], "{group} {case}: {kepler:e} {cylindrical:e}");
    }
    near("HCW", &found["hcw_difference_m"], &expected["hcw_difference_m"], 1e-9);
    for row in expected["amplification"].as_array().unwrap() {
        let is_it = |growth: &&Value| growth["case"] == row[0] && growth["station_mass_kg"].as_f64() == row[1].as_f64();
        let growth = found["sensitivity"].as_array().unwrap().iter().find(is_it).unwrap();
        let factors = numbers(&growth["amplification_after_orbits"]);
        let expected = row[2].as_f64().unwrap();
        assert!((factors[0] - expected).abs() < 1e-3 * expected, "{row}: {factors:?}");
        // No chaos: from the second orbit on it grows evenly.
        let steps: Vec<f64> = factors.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.iter().all(|step| (step - steps[0]).abs() < 0.05 * steps[0]), "{row}: {factors:?}");
    }
}

#[test]
fn summaries_are_for_people() {
    for (program, word) in [(TWO_BODY, "Laplace"), (THREE_BODY, "Arenstorf"), (RELATIVE_MOTION, "not chaotic")] {
        assert!(good(program, &[]).contains(word), "{program}");
    }
}
