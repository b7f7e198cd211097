//! Adaptive control as outside programs call it: what it prints and what it writes.

use crate::support::{figure, good, json, keys, number};
use serde_json::Value;

const ADAPTIVE: &str = env!("CARGO_BIN_EXE_adaptive");

/// What must hold for every run that learns: V never grows, and loses what damping takes.
fn assert_lyapunov(run: &Value) {
    let found = &run["lyapunov"];
    assert_eq!(found["never_increases"], true, "{found}");
    let (first, last) = (number(&found["start"]), number(&found["end"]));
    assert!(0.0 <= last && last < first && number(&found["greatest_imbalance"]) < 1e-8 * first, "{found}");
}

#[test]
fn arm_and_quadrotor_learn_what_they_move() {
    let folder = std::env::temp_dir().join(format!("mbs-adaptive-{}", std::process::id()));
    let found = json(&good(ADAPTIVE, &["--json", "--out", folder.to_str().unwrap()]));
    assert_eq!(keys(&found), ["arm", "quadrotor", "assumed"]);
    assert_eq!(found["assumed"]["adaptive.vehicle"]["status"], "assumed");

    let arm = &found["arm"];
    let base = &arm["base_parameters"];
    assert_eq!((&base["parameters"], &base["rank"]), (&Value::from(60), &Value::from(36)));
    let runs = [&arm["payload"]["table_2_there_and_back"], &arm["payload"]["sines"], &arm["all_links"]];
    for run in runs {
        assert_lyapunov(run);
        let rms = |control: &str, part: &str| number(&run["flange_error"][control][part]["rms"]);
        assert!(rms("computed_torque_right", "end") < 1e-9, "{run}");
        // Learning pays: less than a fiftieth of what the wrong model leaves, and less than at the beginning.
        assert!(rms("adaptive", "end") < 0.02 * rms("computed_torque_wrong", "end"), "{run}");
        assert!(rms("adaptive", "end") < 0.2 * rms("adaptive", "start"), "{run}");
        assert!(number(&run["torque_ratio_max"]) < 1.0, "within the drives: {run}");
    }
    // Sines show all ten numbers of the last link: of its mass, 300 kg were not known.
    let mass = arm["payload"]["sines"]["base_parameters"].as_array().unwrap().iter().find(|row| row["name"] == "m6");
    assert!((number(&mass.unwrap()["estimated"]) - 340.0).abs() < 5.0, "{mass:?}");

    for (reference, run) in found["quadrotor"].as_object().unwrap() {
        assert_lyapunov(run);
        let rms = |control: &str| number(&run[control]["error"]["end"]["rms"]);
        assert!(rms("adaptive") < 0.1 * rms("backstepping_wrong"), "{reference}: {run}");
        let mass = &run["parameters"][0];
        assert!((number(&mass["estimated"]) - number(&mass["true"])).abs() < 1e-3, "{mass}");
    }
    let landing = &found["quadrotor"]["landing_case_I"];
    // Known and learnt models come down as planned, 13.25 s; the wrong one, which sags, before.
    for control in ["backstepping_right", "adaptive"] {
        assert!((number(&landing[control]["touchdown_time"]) - 13.25).abs() < 0.01, "{landing}");
    }
    assert!(number(&landing["backstepping_wrong"]["touchdown_time"]) < 12.0, "{landing}");

    for name in ["arm_all_links", "arm_sines", "quadrotor_eight", "quadrotor_landing_case_I"] {
        assert!(figure(&folder, name).contains("assumed: "), "{name}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
