//! The docking example as outside programs call it: what it prints and what it writes.

use crate::support::{figure, good, json, keys, number, numbers, refused};
use serde_json::Value;

const DOCKING: &str = env!("CARGO_BIN_EXE_docking");

#[test]
fn both_axes_dock_within_the_tolerances_of_a_port() {
    for axis in ["v-bar", "r-bar"] {
        let found = json(&good(DOCKING, &["--json", "--axis", axis]));
        assert_eq!(found["axis"], axis);
        assert_eq!((&found["keep_out_violations"], &found["corridor_violations"]), (&Value::from(0), &Value::from(0)));
        for (run, position) in [(&found, 0.01), (&found["perfect_thrusters"], 1e-6), (&found["station_mass"], 1e-4)] {
            assert!(number(&run["port_position_error"]) < position, "{axis}: {run}");
            assert!((number(&run["port_velocity"]) - 0.05).abs() < 5e-3, "{axis}: {run}");
            assert!((50.0..80.0).contains(&number(&run["total_delta_v"])), "{axis}: {run}");
            assert!((10_000.0..40_000.0).contains(&number(&run["duration"])), "{axis}: {run}");
            // Position and velocity at contact are those whose sizes are reported.
            let size = |name: &str| numbers(&run[name]).iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((size("contact_position") - number(&run["port_position_error"])).abs() < 1e-12);
            assert!((size("contact_velocity") - number(&run["port_velocity"])).abs() < 1e-12);
        }
        assert!(number(&found["port_position_error"]) > number(&found["perfect_thrusters"]["port_position_error"]));

        let phases = ["approach", "closing", "docking", "homing", "phasing"];
        let mut names = keys(&found["phases"]);
        names.sort_unstable();
        assert_eq!(names, phases);
        let sum = |key: &str| phases.iter().map(|name| number(&found["phases"][name][key])).sum::<f64>();
        assert!((sum("delta_v") - number(&found["total_delta_v"])).abs() < 1e-9);
        assert!((sum("duration") - number(&found["duration"])).abs() < 1e-6);
        for name in ["homing", "closing"] {
            assert!(number(&found["phases"][name]["drift_clearance"]) > 200.0, "{axis} {name}");
        }
    }
}

#[test]
fn figures_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let summary = good(DOCKING, &["--out", folder.path().to_str().unwrap()]);
    assert!(summary.contains("approach along the v-bar") && summary.contains("closing"), "{summary}");
    for name in ["docking_way", "docking_closing", "docking_approach", "docking_delta_v"] {
        figure(folder.path(), name);
    }
    // The burns in the table are those of the budget.
    let burns = std::fs::read_to_string(folder.path().join("docking_burns.csv")).unwrap();
    let total: f64 = burns
        .lines()
        .skip(1)
        .map(|line| {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            row[2..].iter().map(|v| v * v).sum::<f64>().sqrt()
        })
        .sum();
    let found = json(&good(DOCKING, &["--json"]));
    assert!((total - number(&found["total_delta_v"])).abs() < 1e-9);
    // The last row of the way is at the port, 15 m behind the station.
    let way = std::fs::read_to_string(folder.path().join("docking_way.csv")).unwrap();
    let last: Vec<f64> = way.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    assert!((last[3] + 15.0).abs() < 1e-6 && last[2].abs() < 0.01, "{last:?}");
}

#[test]
fn wrong_usage_ends_with_2() {
    for arguments in [["--axis", "h-bar"], ["--axis", ""]] {
        refused(DOCKING, &arguments);
    }
}
