//! The nonholonomic example as outside programs call it: what it prints and what it writes.

use std::f64::consts::PI;

use crate::support::{figure, good, json, number, numbers};

const NONHOLONOMIC: &str = env!("CARGO_BIN_EXE_nonholonomic");

#[test]
fn motions_are_those_of_the_closed_forms() {
    let found = json(&good(NONHOLONOMIC, &["--json"]));
    for name in ["knife_edge", "chaplygin_sleigh", "rolling_coin"] {
        let one = &found[name];
        // Rounding is 1e-15 of tens of metres and of a hundred radians.
        for key in ["path_error", "angle_error"] {
            assert!(number(&one[key]) < 1e-11, "{name}: {one}");
        }
        assert!(number(&one["slip"]) < 1e-13 && number(&one["energy_drift"]) < 1e-12, "{name}: {one}");
    }
    // Typed anew, from the parameters of the mechanisms: g sin α/(2 ω²), and 4 π of it across in two turns.
    let edge = &found["knife_edge"];
    let size = 9.80665 * 20_f64.to_radians().sin() / (2.0 * 0.7 * 0.7);
    assert!((number(&edge["across"]) - 4.0 * PI * size).abs() < 1e-9 && number(&edge["multiplier_error"]) < 1e-10);
    assert!((number(&edge["lowest"]) - size).abs() < 1e-9, "{edge}");
    // A sleigh keeps its energy and no momentum: as fast as before, the other way.
    let sleigh = &found["chaplygin_sleigh"];
    let [start, end] = ["start", "end"].map(|end| numbers(&sleigh["momentum"][end]));
    let size = |p: &[f64]| p[0].hypot(p[1]);
    assert!((size(&start) - size(&end)).abs() < 1e-9 && (start[0] - end[0]).abs() > 1.0, "{sleigh}");
    assert!(number(&sleigh["angular_momentum"]["greatest"]) > 20.0 * number(&sleigh["angular_momentum"]["start"]));
    assert!((number(&sleigh["turns_in_all_time"]) - PI * (0.2 / 1.5 / 0.09 + 1.0_f64).sqrt()).abs() < 1e-12);
    // A uniform disk stays upright from √(g r/3) on; the swing differs by the square of its size, 1e-4.
    let coin = &found["rolling_coin"];
    assert!((number(&coin["least_speed_upright"]) - (9.81 * 0.012_f64 / 3.0).sqrt()).abs() < 1e-12, "{coin}");
    let ratio = number(&coin["swing_period"]) / number(&coin["swing_period_formula"]);
    assert!((ratio - 1.0).abs() < 1e-7, "{coin}");
    assert_eq!(found["assumed"]["nonholonomic.coin"]["status"], "assumed");
}

#[test]
fn figures_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let summary = good(NONHOLONOMIC, &["--out", folder.path().to_str().unwrap()]);
    assert!(summary.contains("knife edge") && summary.contains("sleigh") && summary.contains("coin"), "{summary}");
    for name in ["nonholonomic_edge", "nonholonomic_sleigh", "nonholonomic_sleigh_rates", "nonholonomic_coin"] {
        figure(folder.path(), name);
    }
    let table = std::fs::read_to_string(folder.path().join("nonholonomic_coin.csv")).unwrap();
    assert!(table.starts_with("t_s,x_m,y_m,heading_rad,lean_rad,spin_rad,exact_x_m,"), "{table}");
}
