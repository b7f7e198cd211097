//! The assembly cell as outside programs see it.

use crate::support::{figure, good, json, keys, number};
use serde_json::Value;

const ASSEMBLY_CELL: &str = env!("CARGO_BIN_EXE_assembly_cell");

#[test]
fn compliance_inserts_what_stiffness_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(ASSEMBLY_CELL, &["--json", "--out", folder.path().to_str().unwrap()]));
    assert_eq!(keys(&found), ["greatest_push", "runs", "assumed"]);
    let runs = found["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 18);
    for run in runs {
        // Work and energy agree to the integrator's tolerance, through every touch.
        assert!(number(&run["energy_imbalance"]) < 1e-4 * number(&run["energy_exchanged"]), "{run}");
        // The peg swings below a rigid wrist by less than half a millimetre.
        assert!(number(&run["carried_error_max"]) < 5e-4, "{run}");
        let inserted = run["outcome"] == "inserted";
        assert_eq!(inserted, run["cycle_time"].is_number());
        if inserted {
            // Gripper, three motions there and back, 34 mm at 20 mm/s with ramps of 0.5 m/s², rest.
            let want = 0.3 + 2.0 * 1.15 + (0.034 / 0.02 + 0.02 / 0.5) + 0.25;
            assert!((number(&run["cycle_time"]) - want).abs() < 1e-9, "{run}");
            assert!((number(&run["depth"]) - 0.03).abs() < 2e-4 + 1e-9, "{run}");
        }
        // A straight hole presses the peg aside by springs in series: at its tip, or all along, which holds it upright.
        if run["way"] == "position control" && run["hole_tilt"] == 0.0 {
            let (springs, aside) = (1.0 / 2e5 + 1.0 / 2e6, number(&run["hole_aside"]) - 5e-5);
            let side = number(&run["side_force_max"]);
            let (least, most) = (aside / (springs + 0.05 * 0.05 / 2000.0), aside / springs);
            assert!(least < side && side < 1.01 * most, "{run}: {least} {most}");
        }
        // Where both sides touch is geometry, but for what contacts give way.
        if run["way"] == "remote centre" && run["hole_tilt"] == 0.02 {
            let both = &run["two_points"];
            let ratio = number(&both["depth"]) / number(&both["depth_by_geometry"]);
            assert!((ratio - 1.0).abs() < 0.05, "{run}");
        }
    }
    let of = |way: &str, aside: f64, tilt: f64, friction: f64| {
        let same = |run: &&Value| {
            run["way"] == way && run["hole_aside"] == aside && run["hole_tilt"] == tilt && run["friction"] == friction
        };
        runs.iter().find(same).unwrap()
    };
    for friction in [0.1, 0.3] {
        for (aside, tilt) in [(5e-4, 0.0), (1e-3, 5e-3), (1e-3, 2e-2)] {
            let [stiff, soft, remote] =
                ["position control", "impedance control", "remote centre"].map(|way| of(way, aside, tilt, friction));
            assert_eq!(remote["outcome"], "inserted", "{remote}");
            let side = |run: &Value| number(&run["side_force_max"]);
            assert!(side(remote) < 0.2 * side(stiff) && side(soft) < 0.35 * side(stiff), "{stiff} {soft} {remote}");
            let push = |run: &Value| number(&run["push_max"]);
            assert!(push(remote) < 0.25 * push(stiff), "{stiff} {remote}");
            // A hole that leans much: only the wrist can follow, neither position nor impedance control can.
            let straight = tilt < 0.01;
            assert_eq!([stiff, soft].map(|run| run["outcome"] == "inserted"), [straight; 2], "{stiff} {soft}");
        }
    }
    for name in ["assembly_cell_1", "assembly_cell_2", "assembly_cell_3"] {
        assert!(figure(folder.path(), name).contains("assumed: "), "{name}");
    }
    assert!(found["assumed"]["assembly.wrists"]["value"].is_string());
}
