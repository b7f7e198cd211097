//! `platform_dynamics` as outside programs call it: what it prints and what it writes, against the thesis' values.

use crate::support::{good, json, keys, numbers, run};
use mbs_platform::{Motion, Platform};
use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_platform_dynamics");

/// Rows of six, each number to 1e-9 of the largest in its row.
#[track_caller]
fn assert_rows(found: &Value, expected: &Value) {
    let (found, expected) = (found.as_array().unwrap(), expected.as_array().unwrap());
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let (found, expected) = (numbers(found), numbers(expected));
        assert_eq!((found.len(), expected.len()), (6, 6));
        let scale = expected.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() <= 1e-9 * scale, "{found} instead of {expected}");
        }
    }
}

#[test]
fn prints_the_reference_values() {
    let found = json(&good(PROGRAM, &["--json"]));
    let expected = json(include_str!("../../../tests/data/stewart.json"));
    let names = ["table3", "table4", "direct_kinematics", "mass_matrix", "coriolis_matrix", "gravity", "assumed"];
    assert_eq!(keys(&found), names);
    assert_eq!(keys(&found["table3"]), ["lengths", "forces"]);
    let forces = &found["table3"]["forces"];
    assert_eq!(keys(forces), ["payload_0", "payload_300", "payload_1250"]);
    for payload in keys(forces) {
        assert_eq!(keys(&forces[payload]), ["with_actuators", "without_actuators"]);
        for (key, name) in [("with_actuators", "True"), ("without_actuators", "False")] {
            let case = &expected["table3"][format!("{payload}_act_{name}")];
            assert_eq!(forces[payload][key].as_array().unwrap().len(), 9);
            assert_rows(&found["table3"]["lengths"], &case["lengths"]);
            assert_rows(&forces[payload][key], &case["forces"]);
        }
    }
    assert_eq!(keys(&found["table4"]), ["base_psi20", "theta10_psi20", "phi10_psi20"]);
    for (run, found) in found["table4"].as_object().unwrap() {
        assert_eq!(keys(found), ["lengths", "with_actuators", "without_actuators"]);
        for key in ["with_actuators", "without_actuators"] {
            assert_rows(&found["lengths"], &expected["table4"][run][key]["lengths"]);
            assert_rows(&found[key], &expected["table4"][run][key]["forces"]);
        }
    }
    let direct = &found["direct_kinematics"];
    assert_eq!(keys(direct), ["pose", "iterations", "residual"]);
    assert!(direct["iterations"].as_u64().unwrap() <= 5 && direct["residual"].as_f64().unwrap() <= 1e-12);
    for (found, expected) in numbers(&direct["pose"]).iter().zip(numbers(&expected["fk_newton"]["q_true"])) {
        assert!((found - expected).abs() <= 1e-12, "{found} {expected}");
    }
    let expected = &expected["eq_4_18"]["with_actuators"];
    assert_rows(&found["mass_matrix"], &expected["M"]);
    assert_rows(&found["coriolis_matrix"], &expected["C"]);
    assert_rows(&Value::from(vec![found["gravity"].clone()]), &Value::from(vec![expected["G"].clone()]));
}

#[test]
fn writes_figures_and_tables() {
    let folder = tempfile::tempdir().unwrap();
    let summary = good(PROGRAM, &["--out", folder.path().to_str().unwrap()]);
    let figures = || (5..=12).map(|number| format!("figure_4_{number}"));
    for name in figures().chain(["platform_poses".to_string()]) {
        let svg = std::fs::read_to_string(folder.path().join(format!("{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"), "{name}");
        let png = std::fs::read(folder.path().join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000, "{name}");
    }
    // Lengths of six legs, forces in two panels, a force at three attitudes in three panels.
    for (name, columns) in figures().zip([7, 13, 13, 13, 10, 10, 10, 10]) {
        let mut table = csv::Reader::from_path(folder.path().join(format!("{name}.csv"))).unwrap();
        assert_eq!(table.headers().unwrap().len(), columns, "{name}");
        let rows: Vec<Vec<f64>> = table.deserialize().map(Result::unwrap).collect();
        assert_eq!((rows.len(), rows[400][0]), (401, 4.0));
        // One period.
        assert!(
            rows[0][1..].iter().zip(&rows[400][1..]).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + a.abs())),
            "{name}"
        );
    }
    // Motion 6 leaves the stroke at once, and says which leg; what keeps the limits is not told of.
    assert!(summary.contains("motion 6 (table 4), leg 1: stroke from 0.00 s on"), "{summary}");
    assert!(!summary.contains("motion 8 (combined), "), "{summary}");
    let cases = std::fs::read_to_string(folder.path().join("cases.csv")).unwrap();
    assert_eq!(cases.lines().count(), 1 + 8 * 3);
    let limits = std::fs::read_to_string(folder.path().join("limits.csv")).unwrap();
    assert!(limits.lines().any(|line| line.starts_with("6,table 4,1250,3,force,N,10000,")), "{limits}");
    assert!(limits.lines().skip(1).all(|line| line.ends_with(",with mass")), "{limits}");
    forces_beyond_the_limit_are_those_with_mass(&limits);
    let sensitivity = std::fs::read_to_string(folder.path().join("sensitivity.csv")).unwrap();
    assert_eq!(sensitivity.lines().count(), 10);
    derivatives_are_those_of_a_moving_platform(&sensitivity);
    assert_eq!(std::fs::read_to_string(folder.path().join("stiffness.csv")).unwrap().lines().count(), 7);
}

/// The first force of each row, on legs with mass, at the moment the row names.
fn forces_beyond_the_limit_are_those_with_mass(table: &str) {
    let mut compared = 0;
    for row in table.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[4] == "force") {
        let [motion, leg] = [0, 3].map(|i| row[i].parse::<usize>().unwrap() - 1);
        let [payload, time, force] = [2, 7, 8].map(|i| row[i].parse::<f64>().unwrap());
        let [q, qd, qdd] = Motion::CASES[motion].1.at(time);
        let loaded = Platform::default().with_payload(payload).unwrap();
        let forces = |platform: Platform| platform.leg_forces(&q, &qd, &qdd).unwrap()[leg];
        assert_eq!(force, forces(loaded.clone()));
        assert!((force - forces(loaded.without_actuator_inertia())).abs() > 1.0);
        compared += 1;
    }
    assert!(compared > 0, "{table}");
}

/// The rows of φ, θ, ψ against differences of the forces over a hundredth of a degree, along the combined motion at 0.3
/// s.
fn derivatives_are_those_of_a_moving_platform(table: &str) {
    let (platform, [q, qd, qdd]) = (Platform::default(), Motion::COMBINED.at(0.3));
    for (coordinate, name) in [(3, "φ"), (4, "θ"), (5, "ψ")] {
        let row = table.lines().find_map(|line| line.strip_prefix(&format!("{name},N/°,"))).unwrap();
        let row: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
        let turned = |degrees: f64, qd: &[f64; 6]| {
            let mut q = q;
            q[coordinate] += degrees.to_radians();
            platform.leg_forces(&q, qd, &qdd).unwrap()
        };
        let differences = |qd: &[f64; 6]| -> Vec<f64> {
            let (more, less) = (turned(0.01, qd), turned(-0.01, qd));
            (0..6).map(|leg| (more[leg] - less[leg]) / 0.02).collect()
        };
        let scale = row.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let off = |wanted: &[f64]| (0..6).map(|leg| (row[leg] - wanted[leg]).abs() / scale).fold(0.0, f64::max);
        assert!(off(&differences(&qd)) < 1e-6, "{name}: {row:?} {:?}", differences(&qd));
        // At rest they are others.
        assert!(off(&differences(&[0.0; 6])) > 1e-4, "{name}: {row:?}");
    }
}

#[test]
fn refuses_what_it_does_not_know() {
    let output = run(PROGRAM, &["--fast"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("unexpected argument '--fast'"));
}
