//! The arm's examples as outside programs call them: what they print and what they write, against the thesis' values.

use std::path::Path;

use crate::support::{figure, good, json, keys, numbers, run};
use mbs_arm::Arm;
use serde_json::Value;

const KINEMATICS: &str = env!("CARGO_BIN_EXE_arm_kinematics");
const TRAJECTORY: &str = env!("CARGO_BIN_EXE_arm_trajectory");

/// Lengths of the array, and of its rows.
fn shape(value: &Value) -> (usize, usize) {
    let rows = value.as_array().unwrap();
    (rows.len(), rows.first().and_then(Value::as_array).map_or(0, Vec::len))
}

/// Each number to `tolerance` of the largest, or of 1.
#[track_caller]
fn assert_close(found: &Value, expected: &Value, tolerance: f64) {
    let (found, expected) = (numbers(found), numbers(expected));
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() <= tolerance * scale, "{found} instead of {expected}");
    }
}

/// How far two angles are apart, but for whole turns \[°\].
fn apart(a: f64, b: f64) -> f64 {
    let rest = (a - b).rem_euclid(360.0);
    rest.min(360.0 - rest)
}

#[test]
fn kinematics_has_the_thesis_values() {
    let found = json(&good(KINEMATICS, &["--json"]));
    let expected = json(include_str!("../../../tests/data/serial.json"));
    let names = [
        "fk_position",
        "fk_rotation",
        "jacobian",
        "jacobian_det",
        "singular_values",
        "ik",
        "ik_from_printed",
        "mass_matrix",
        "gravity",
        "coriolis",
        "torque",
        "assumed",
    ];
    assert_eq!(keys(&found), names);
    for (key, rows, columns) in [("fk_rotation", 3, 3), ("jacobian", 6, 6), ("ik", 8, 6), ("mass_matrix", 6, 6)] {
        assert_eq!(shape(&found[key]), (rows, columns), "{key}");
    }
    let (pose, jacobian, dynamics) =
        (&expected["fk_table1"], &expected["jacobian_table1"], &expected["dynamics_table1"]);
    for (key, expected, tolerance) in [
        ("fk_position", &pose["P_m"], 1e-12),
        ("fk_rotation", &pose["R"], 1e-12),
        ("jacobian", &jacobian["J"], 1e-12),
        ("jacobian_det", &jacobian["det"], 1e-12),
        ("singular_values", &jacobian["singular_values"], 1e-12),
        ("mass_matrix", &dynamics["M_kg_m2"], 1e-12),
        ("gravity", &dynamics["gravity_vector_N_m"], 1e-12),
        ("coriolis", &dynamics["coriolis_vector_N_m"], 1e-12),
        ("torque", &dynamics["tau_N_m"], 1e-12),
    ] {
        assert_close(&found[key], expected, tolerance);
    }
    let reference = json(include_str!("../../../tests/data/arm_kinematics.json"));
    let configurations = reference["ik_table1"].as_array().unwrap().iter().map(|entry| numbers(&entry["theta_rad"]));
    let mut missing: Vec<Vec<f64>> =
        configurations.map(|angles| angles.iter().map(|angle| angle.to_degrees()).collect()).collect();
    assert_eq!(missing.len(), 8);
    for row in found["ik"].as_array().unwrap() {
        let row = numbers(row);
        let is_row = |expected: &Vec<f64>| row.iter().zip(expected).all(|(q, expected)| apart(*q, *expected) < 1e-11);
        let position = missing.iter().position(is_row).unwrap_or_else(|| panic!("{row:?} is none of {missing:?}"));
        missing.swap_remove(position);
    }
    // The first configuration is the posture itself; the thesis prints the angles of its formulas with four decimals.
    assert_close(&found["ik"][0], &json("[45, 30, 30, -45, 30, 0]"), 1e-12);
    let rounded: Vec<f64> = numbers(&found["ik_from_printed"]).iter().map(|q| (q * 1e4).round() / 1e4).collect();
    assert_eq!(rounded, [45.0, 29.9977, 29.9993, -44.9962, 30.0036, -0.0052]);
}

#[test]
fn trajectories_have_the_reference_values() {
    let found = json(&good(TRAJECTORY, &["--json"]));
    let reference = json(include_str!("../../../tests/data/trajectory.json"));
    assert_eq!(keys(&found), ["case1", "case2", "assumed"]);
    assert_eq!(found["assumed"]["arm.case_2"]["value"], "1.5 °/s");
    for case in ["case1", "case2"] {
        assert_eq!(keys(&found[case]), ["quartic", "two_piece_quartic", "quintic"]);
        for method in ["quartic", "two_piece_quartic", "quintic"] {
            let run = &found[case][method];
            let names =
                ["t", "q_deg", "qd_deg", "qdd_deg", "torque", "peak_speed_deg", "energy_joule", "singularities"];
            assert_eq!(keys(run), names);
            assert_eq!(numbers(&run["t"]), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0]);
            for key in ["q_deg", "qd_deg", "qdd_deg", "torque"] {
                assert_eq!(shape(&run[key]), (11, 6), "{case} {method} {key}");
            }
            assert_eq!(shape(&run["peak_speed_deg"]), (6, 0));
            assert_eq!(numbers(&run["singularities"]).len(), 1);
        }
        for (method, name) in [("quartic", "default_quartic"), ("quintic", "alternative_quintic")] {
            let (run, expected) = (&found[case][method], &reference[case][name]);
            for (key, expected) in [
                ("q_deg", &expected["position_deg"]),
                ("qd_deg", &expected["velocity_deg_s"]),
                ("qdd_deg", &expected["acceleration_deg_s2"]),
            ] {
                assert_close(&run[key], expected, 1e-12);
            }
        }
        let (run, expected) = (&found[case]["quartic"], &reference[case]["default_quartic"]);
        for (found, expected) in numbers(&run["torque"]).iter().zip(numbers(&expected["tau_N_m"])) {
            assert!((found - expected).abs() < 1e-8, "{found} instead of {expected}");
        }
        let (energy, expected_energy) = (&run["energy_joule"], &expected["integral_abs_mechanical_power_J"]);
        assert!((energy.as_f64().unwrap() / expected_energy.as_f64().unwrap() - 1.0).abs() < 1e-5);
        for (joint, extrema) in expected["extrema"].as_array().unwrap().iter().enumerate() {
            let [low, high] = ["v_min_deg_s", "v_max_deg_s"].map(|key| extrema[key].as_f64().unwrap().abs());
            let peak = run["peak_speed_deg"][joint].as_f64().unwrap();
            assert!((peak - low.max(high)).abs() < 1e-12, "{peak}");
        }
        let [time, expected] =
            [&run["singularities"][0], &expected["jacobian_det_zero_crossings_s"][0]].map(|x| x.as_f64().unwrap());
        assert!((time - expected).abs() < 1e-9, "{time}, {expected}");
    }
}

#[test]
fn the_summary_says_what_the_thesis_needs_corrected() {
    let text = good(TRAJECTORY, &[]);
    for part in
        ["E9 ", "E11 ", "E48 ", "E49 ", "E50 ", "elbow at 39.638805 s", "elbow at 37.085631 s", "-0.39 % of work"]
    {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let text = good(KINEMATICS, &[]);
    for part in ["Front, Positive, Positive", "Back, Negative, Negative", "printed formulas"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn figures_tables_and_modules_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    let printed = good(TRAJECTORY, &["--json", "--out", out.to_str().unwrap()]);
    assert_eq!(printed, good(TRAJECTORY, &["--json"]), "files change nothing that is printed");

    let mut expected: Vec<String> = ["svg", "png"]
        .iter()
        .flat_map(|extension| {
            let figures = (4..=11).map(move |k| format!("figure_3_{k}.{extension}"));
            figures.chain([1, 2].map(|case| format!("torques_case{case}.{extension}")))
        })
        .collect();
    for case in ["case1", "case2"] {
        expected.extend(["quartic", "two_piece_quartic", "quintic"].map(|method| format!("{case}_{method}.csv")));
        expected.extend([format!("{case}.mod"), format!("{case}_in_range.mod")]);
    }
    expected.push("fastest.csv".to_string());
    expected.sort();
    assert_eq!(names(&out), expected);

    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    for k in 4..=11 {
        let svg = figure(&out, &format!("figure_3_{k}"));
        assert!(svg.contains(&format!("Figure 3.{k}: ")), "{k}");
        let words = match k {
            4 | 5 => ["x [m]", "y [m]", "z [m]", "start", "quartic"],
            6 | 7 => ["t [s]", "quartic: q [°]", "joint 1", "joint 6", "quintic less quartic: q [°]"],
            8 | 9 => ["t [s]", "quartic: dq/dt [°/s]", "joint 1", "joint 6", "two quartics: dq/dt [°/s]"],
            _ => ["t [s]", "quartic: d²q/dt² [°/s²]", "joint 1", "joint 6", "quintic: d²q/dt² [°/s²]"],
        };
        for word in words {
            assert!(svg.contains(word), "{word} is not in figure 3.{k}");
        }
    }

    let table = read("case2_quartic.csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 502);
    assert!(rows.iter().all(|row| row.len() == 30), "{:?}", rows[0]);
    assert_eq!(
        (rows[0][0], rows[0][1], rows[0][7], rows[0][19], rows[0][28]),
        ("t_s", "q1_deg", "qd1_deg_s", "torque1_Nm", "det_jacobian_m3")
    );
    let [q, qd]: [f64; 2] = [1, 7].map(|column| rows[1][column].parse().unwrap());
    assert!((q - 20.0).abs() < 1e-13 && (qd - 1.5).abs() < 1e-14, "{q}, {qd}");

    let module = read("case1.mod");
    assert!(module.starts_with("MODULE Case1\n") && module.trim_end().ends_with("ENDMODULE"), "{module}");
    // The robot's own second angle is 90° more.
    assert!(module.contains("CONST jointtarget j00:=[[20.000000,100.000000,10.000000,10.000000,20.000000,10.000000],"));
    assert!(
        module.contains("CONST jointtarget j50:=[[50.000000,180.000000,120.000000,80.000000,60.000000,100.000000],")
    );
    assert_eq!(module.matches("MoveAbsJ ").count(), 51);
    assert!(module.contains("! OUT OF RANGE: axis 2 goes from 100.0 to 180.0 deg from 0.00 to 50.00 s"), "{module}");
    assert!(module.contains("! OUT OF RANGE: axis 3 goes from 60.0 to 120.0 deg"), "{module}");
    assert_eq!(module.matches("OUT OF RANGE").count(), 2);
    // A controller reads plain ASCII.
    assert!(module.is_ascii());
}

/// A row of a table: time, and six numbers each.
struct Row {
    t: f64,
    q: [f64; 6],
    qd: [f64; 6],
    qdd: [f64; 6],
    torque: [f64; 6],
    determinant: f64,
}

impl Row {
    fn of(line: &str) -> Self {
        let values: Vec<f64> = line.split(',').map(|text| text.parse().unwrap()).collect();
        let six = |first: usize| std::array::from_fn(|i| values[first + i]);
        let radians = |first: usize| six(first).map(f64::to_radians);
        let [q, qd, qdd] = [radians(1), radians(7), radians(13)];
        Row { t: values[0], q, qd, qdd, torque: six(19), determinant: values[28] }
    }

    fn power(&self, of: fn(f64) -> f64) -> f64 {
        (0..6).map(|i| of(self.torque[i] * self.qd[i])).sum()
    }
}

/// Of every method: rates are slopes, the determinant is the closed form of the thesis' Jacobian, what the drives do is
/// what the arm's energy gains, and what is printed follows from the rows.
#[test]
fn tables_are_motions_of_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let printed = json(&good(TRAJECTORY, &["--json", "--out", folder.path().to_str().unwrap()]));
    let arm = Arm::default();
    for case in ["case1", "case2"] {
        for method in ["quartic", "two_piece_quartic", "quintic"] {
            let table = std::fs::read_to_string(folder.path().join(format!("{case}_{method}.csv"))).unwrap();
            let rows: Vec<Row> = table.lines().skip(1).map(Row::of).collect();
            let step = rows[1].t - rows[0].t;
            for three in rows.windows(3) {
                let [before, row, after] = three else { unreachable!() };
                for i in 0..6 {
                    let slope = (after.q[i] - before.q[i]) / (2.0 * step);
                    assert!((slope - row.qd[i]).abs() < 1e-5, "{case} {method}, joint {i} at {} s", row.t);
                    let slope = (after.qd[i] - before.qd[i]) / (2.0 * step);
                    // Two quartics meet in the middle: the third derivative has a corner there.
                    assert!((slope - row.qdd[i]).abs() < 1e-5, "{case} {method}, joint {i} at {} s", row.t);
                }
                let ([s3, s5], c3) = ([row.q[2].sin(), row.q[4].sin()], row.q[2].cos());
                let (c2, (s23, c23)) = (row.q[1].cos(), (row.q[1] + row.q[2]).sin_cos());
                let (stretch, reach) = (0.165 * s3 + 1.056 * c3, 0.41 + 1.075 * c2 + 0.165 * c23 - 1.056 * s23);
                assert!((row.determinant + 1.075 * stretch * s5 * reach).abs() < 1e-12, "{case} {method}");
            }
            let sum = |of: fn(f64) -> f64| -> f64 {
                rows.windows(2).map(|two| 0.5 * step * (two[0].power(of) + two[1].power(of))).sum()
            };
            let energy = |row: &Row| arm.model.kinetic_energy(&row.q, &row.qd) + arm.model.potential_energy(&row.q);
            let gained = energy(&rows[rows.len() - 1]) - energy(&rows[0]);
            let found = &printed[case][method];
            let spent = found["energy_joule"].as_f64().unwrap();
            assert!((sum(|power| power) - gained).abs() < 1e-5 * spent, "{case} {method}: {gained} J");
            assert!((sum(f64::abs) - spent).abs() < 1e-5 * spent, "{case} {method}: {spent} J");

            let changes: Vec<f64> = rows
                .windows(2)
                .filter(|two| two[0].determinant * two[1].determinant < 0.0)
                .map(|two| two[0].t)
                .collect();
            let singular = numbers(&found["singularities"]);
            assert_eq!(changes.len(), singular.len());
            assert!(changes.iter().zip(&singular).all(|(&t, &time)| t <= time && time <= t + step), "{singular:?}");
        }
    }
}

#[test]
fn the_same_bytes_again() {
    let [first, second] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    for folder in [&first, &second] {
        good(TRAJECTORY, &["--out", folder.path().to_str().unwrap()]);
        good(KINEMATICS, &["--out", folder.path().to_str().unwrap()]);
    }
    for name in names(first.path()) {
        assert_eq!(
            std::fs::read(first.path().join(&name)).unwrap(),
            std::fs::read(second.path().join(&name)).unwrap(),
            "{name}"
        );
    }
    assert!(first.path().join("arm_kinematics.json").exists());
}

#[test]
fn a_folder_that_cannot_be_ends_with_1() {
    for program in [KINEMATICS, TRAJECTORY] {
        let file = tempfile::NamedTempFile::new().unwrap();
        let inside = file.path().join("folder");
        let output = run(program, &["--out", inside.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(1));
        assert!(output.stdout.is_empty());
    }
}
