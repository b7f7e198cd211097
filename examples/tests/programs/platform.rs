//! `platform_dynamics` as outside programs call it: what it prints and what it writes, against the thesis' values.

use std::collections::BTreeSet;

use crate::support::{figure, good, json, keys, numbers, refused};
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
    let names = [
        "table3",
        "table4",
        "direct_kinematics",
        "mass_matrix",
        "coriolis_matrix",
        "gravity",
        "cases",
        "sensitivity",
        "assumed",
    ];
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
        figure(folder.path(), &name);
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
    for case in 1..=8 {
        let read = |name: String| std::fs::read_to_string(folder.path().join(name)).unwrap();
        let svg = figure(folder.path(), &format!("case_{case}"));
        for word in ["l [m]", "dl/dt [m/s]", "F [N]", "F dl/dt [W]", "payload 300 kg"] {
            assert!(svg.contains(word), "{word} is not in case {case}");
        }
        // Legs that do the same share a line.
        let names = svg.split("<text").filter_map(|part| part.split_once(">leg")?.1.split_once('<')).map(|name| name.0);
        let legs: BTreeSet<char> = names.flat_map(str::chars).filter(char::is_ascii_digit).collect();
        assert_eq!(String::from_iter(legs), "123456", "case {case}");
        let table = read(format!("sensitivity_case_{case}.csv"));
        assert_eq!(table.lines().count(), 1 + 44);
        assert!(table.lines().all(|line| line.split(',').count() == 2 + 25), "{table}");
        histories_are_those_of_the_legs(case, &read(format!("case_{case}.csv")));
    }
}

/// Speeds are slopes of lengths, powers forces times speeds, forces those of the model at the row's time.
fn histories_are_those_of_the_legs(case: usize, table: &str) {
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!((rows.len(), rows[0].len()), (if case == 8 { 2001 } else { 401 }, 1 + 12 + 36));
    let [q, qd, qdd] = Motion::CASES[case - 1].1.at(rows[123][0]);
    for (k, payload) in [0.0, 300.0, 1250.0].into_iter().enumerate() {
        let forces = Platform::default().with_payload(payload).unwrap().leg_forces(&q, &qd, &qdd).unwrap();
        assert_eq!(rows[123][13 + 12 * k..][..6], forces);
        for row in &rows {
            assert!((0..6).all(|leg| row[19 + 12 * k + leg] == row[13 + 12 * k + leg] * row[7 + leg]), "{row:?}");
        }
    }
    for five in rows.windows(5) {
        for leg in 1..=6 {
            let slope = (8.0 * (five[3][leg] - five[1][leg]) - five[4][leg] + five[0][leg]) / 0.12;
            assert!((slope - five[2][leg + 6]).abs() < 1e-8, "case {case}, {} s: {slope}", five[2][0]);
        }
    }
}

/// Extremes of the cases, limits that are passed, and sensitivities of a pair, against the model.
#[test]
fn reports_the_eight_cases() {
    let found = json(&good(PROGRAM, &["--json", "--sensitivity", "force_3:payload_mass"]));
    let cases = found["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 8);
    for (case, (name, motion)) in cases.iter().zip(&Motion::CASES) {
        assert_eq!(case["name"], *name);
        assert_eq!(keys(&case["payloads"]), ["0", "300", "1250"]);
        for payload in keys(&case["payloads"]) {
            let (entry, platform) =
                (&case["payloads"][payload], Platform::default().with_payload(payload.parse().unwrap()).unwrap());
            for (kind, which) in [("length", 0), ("speed", 1), ("force", 2), ("power", 3)] {
                for end in ["least", "greatest"] {
                    let extreme = &entry[kind][end];
                    let [q, qd, qdd] = motion.at(extreme["time"].as_f64().unwrap());
                    let legs = platform.leg_state(&q, &qd, &qdd).unwrap();
                    let values = [legs.length, legs.rate, legs.force, legs.power()][which];
                    assert_eq!(
                        values[extreme["leg"].as_u64().unwrap() as usize - 1],
                        extreme["value"].as_f64().unwrap()
                    );
                }
            }
            let passed = entry["limits_passed"].as_array().unwrap();
            let is_long = entry["length"]["greatest"]["value"].as_f64().unwrap() > 1.7;
            assert_eq!(passed.iter().any(|limit| limit["limit"] == "longest"), is_long, "{name}");
        }
    }
    let courses = &found["sensitivity_of"];
    assert_eq!((&courses["unit"], keys(&courses["cases"]).len()), (&Value::from("N/(kg)"), 8));
    let platform = |mass: f64| Platform::default().with_payload(mass).unwrap();
    for (number, (name, motion)) in Motion::CASES.iter().enumerate() {
        let course = &courses["cases"][format!("case_{}", number + 1)];
        let (times, values) = (numbers(&course["t"]), numbers(&course["values"]));
        for k in (0..times.len()).step_by(37) {
            let [q, qd, qdd] = motion.at(times[k]);
            let [more, less] = [301.0, 299.0].map(|mass| platform(mass).leg_forces(&q, &qd, &qdd).unwrap()[2]);
            // Forces are straight in the mass.
            assert!((0.5 * (more - less) - values[k]).abs() < 1e-9, "{name} at {} s", times[k]);
        }
        let largest = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert_eq!(course["largest"]["value"].as_f64().unwrap().abs(), largest);
        assert_eq!(keys(&found["sensitivity"][format!("case_{}", number + 1)]).len(), 44);
    }
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
    for (pair, complaint) in [
        ("force_7:g", "there is no output 'force_7'; outputs are length_1, "),
        ("force_1:mass", "there is no parameter 'mass'; parameters are base_radius, "),
        ("force_1", "it is to be OUTPUT:PARAMETER"),
    ] {
        let told = refused(PROGRAM, &["--sensitivity", pair]);
        assert!(told.contains(complaint), "{told}");
    }
}
