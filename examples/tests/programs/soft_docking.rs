//! The soft docking as outside programs call it: what it prints and what it writes.

use crate::support::{figure, good, json, number, numbers};
use serde_json::Value;

const SOFT_DOCKING: &str = env!("CARGO_BIN_EXE_soft_docking");

#[test]
fn the_approach_is_captured_and_bad_contacts_are_not() {
    let found = json(&good(SOFT_DOCKING, &["--json"]));
    let contact = &found["contact"];
    assert_eq!((&contact["outcome"], &contact["refused"]), (&Value::from("captured"), &Value::Null));
    assert!(number(&contact["touch"]["lateral"]) < 0.1 && number(&contact["touch"]["tilt"]) < 0.07, "{contact}");
    let energy = numbers(&contact["energy"]);
    assert!(energy[1] < energy[0], "{contact}");
    // 9.80665 × 285 m/s: Tsiolkovsky's equation for little propellant.
    let propellant = number(&found["jet_impulse"]) / (285.0 * 9.80665);
    assert!((number(&found["propellant"]) - propellant).abs() < 1e-9);
    // Jets that are not canted push the station more.
    assert!(number(&found["straight_jets"]["plume"]["impulse"]) > number(&found["plume"]["impulse"]));
    let outcomes: Vec<&str> =
        found["contacts"].as_array().unwrap().iter().filter_map(|c| c["outcome"].as_str()).collect();
    assert_eq!(outcomes, ["captured", "captured", "bounced", "bounced", "bounced", "bounced", "missed"]);
    // Twice the thrust, a quarter of the loss.
    let burns = found["finite_burns"].as_array().unwrap();
    let loss = |thrust: f64| {
        number(&burns.iter().find(|burn| (number(&burn["thrust"]) - thrust).abs() < 1e-9).unwrap()["gravity_loss"])
    };
    assert!((loss(800.0) / loss(1600.0) - 4.0).abs() < 0.02, "{burns:?}");
    assert_eq!(found["assumed"]["soft_docking.latches"]["status"], "recalled");
}

#[test]
fn figures_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let summary = good(SOFT_DOCKING, &["--out", folder.path().to_str().unwrap()]);
    assert!(summary.contains("canted by 20°") && summary.contains("gravity loss"), "{summary}");
    for name in ["approach", "jets", "contact", "burns"] {
        figure(folder.path(), &format!("soft_docking_{name}"));
    }
    let way = std::fs::read_to_string(folder.path().join("soft_docking_way.csv")).unwrap();
    assert!(way.starts_with("t_s,depth_m,left_m,above_m,") && way.lines().count() > 200);
}
