//! The least effort of the arm, and its front of time and effort, as outside programs see them.

use serde_json::Value;

use crate::support::{figure, good, json, number, numbers, refused};

const MINIMUM_EFFORT: &str = env!("CARGO_BIN_EXE_minimum_effort");

fn largest(value: &Value) -> f64 {
    numbers(value).into_iter().fold(0.0, f64::max)
}

/// Rows of time, effort and slope.
fn choices(list: &Value) -> Vec<[f64; 3]> {
    let row = |row: &Value| ["duration", "effort", "slope"].map(|key| number(&row[key]));
    list.as_array().unwrap().iter().map(row).collect()
}

#[test]
fn the_least_effort_and_its_front() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(MINIMUM_EFFORT, &["--json", "--out", folder.path().to_str().unwrap()]));
    let (motion, front) = (&found["within_ranges"], &found["front"]);
    let (quintic, optimum) = (&motion["quintic"], &motion["optimum"]);
    assert!(number(&optimum["effort"]) < 0.65 * number(&quintic["effort"]), "{motion}");
    // Twice: by the collocation's own rule, and from the motion by the inverse dynamics.
    let again = number(&optimum["effort_by_inverse_dynamics"]);
    assert!((again / number(&optimum["effort"]) - 1.0).abs() < 1e-4, "{motion}");
    assert!(["stationarity", "defect", "complementarity"].iter().all(|key| number(&optimum[key]) <= 1e-9));
    assert!(largest(&optimum["peak_torque_over_limit"]) < 1.0 && largest(&optimum["peak_speed_over_limit"]) < 1.02);
    let [least, most] = numbers(&optimum["hamiltonian"])[..] else { panic!("{optimum}") };
    assert!(most - least < 5e-4, "{least} {most}");
    let efforts: Vec<f64> = motion["grids"].as_array().unwrap().iter().map(|grid| number(&grid["effort"])).collect();
    assert!((efforts[2] - efforts[1]).abs() < 0.3 * (efforts[1] - efforts[0]).abs(), "{efforts:?}");

    let (pareto, dominated) = (choices(&front["pareto"]), choices(&front["dominated"]));
    for pair in pareto.windows(2) {
        let [[earlier, more, steep], [later, less, flat]] = [pair[0], pair[1]];
        // Slower and with less effort: neither dominates the other.
        assert!(earlier < later && more > less, "{pair:?}");
        // The chord of a convex curve is between its slopes, which are H at both ends.
        let chord = (less - more) / (later - earlier);
        assert!(steep < chord && chord < flat, "{pair:?} {chord}");
    }
    let end = pareto[pareto.len() - 1];
    assert!(end[2].abs() < 1e-5, "{end:?}");
    assert!(dominated.iter().all(|choice| choice[0] > end[0] && choice[1] > end[1] && choice[2] > 0.0));
    for key in ["gravity", "arm.masses", "arm.torques", "effort.start", "effort.stop", "effort.duration"] {
        assert!(found["assumed"][key]["value"].is_string(), "{key}");
    }
    for (key, values) in [("effort.start", "start_deg"), ("effort.stop", "stop_deg")] {
        let told = found["assumed"][key]["value"].as_str().unwrap().replace('−', "-");
        let told: Vec<f64> = told.trim_end_matches(" °").split(", ").map(|angle| angle.parse().unwrap()).collect();
        assert_eq!(told, numbers(&motion[values]), "{key}");
    }
    assert_eq!(found["assumed"]["effort.duration"]["value"], format!("{} s", number(&motion["duration"])));

    for name in ["minimum_effort", "pareto"] {
        figure(folder.path(), name);
    }
    let table = std::fs::read_to_string(folder.path().join("pareto.csv")).unwrap();
    assert_eq!(table.lines().count(), pareto.len() + 1);
}

#[test]
fn wrong_usage_ends_with_2() {
    refused(MINIMUM_EFFORT, &["--duration", "2"]);
}
