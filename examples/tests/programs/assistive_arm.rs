//! The assistive arm as outside programs see it.

use crate::support::{figure, good, json, numbers};

const ASSISTIVE_ARM: &str = env!("CARGO_BIN_EXE_assistive_arm");

#[test]
fn springs_carry_the_forearm_and_the_hand_moves_it() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(ASSISTIVE_ARM, &["--json", "--out", folder.path().to_str().unwrap()]));
    let of = |name: &str, key: &str| numbers(&found["runs"][name][key]);
    // At rest, at the level of the shoulder: the whole weight, nothing, and that of 0.3 kg at the elbow.
    let lift = |name: &str, key: &str| of(name, key)[2];
    let [bare, balanced, heavy] =
        ["without springs", "balanced", "0.3 kg too heavy"].map(|name| lift(name, "holding_torque"));
    let moment = 1.4 * 0.15 + (0.9 + 1.6) * 0.32;
    assert!((bare - 9.80665 * moment).abs() < 1e-9 && balanced.abs() < 1e-9, "{bare} {balanced}");
    assert!((heavy - 9.80665 * 0.3 * 0.32).abs() < 1e-9, "{heavy}");
    assert!(lift("balanced", "peak_torque") < 0.2 * lift("without springs", "peak_torque"));
    // What a push moves in a viscous medium is its impulse over the damping: sin² of 1 s has half of its peak.
    for name in ["without springs", "balanced", "0.3 kg too heavy"] {
        for (found, force) in of(name, "way").into_iter().zip([3.0, -4.0, 6.0]) {
            let want = 0.5 * force / 10.0;
            assert!((found / want - 1.0).abs() < 5e-3, "{name}: {found} {want}");
        }
    }
    figure(folder.path(), "assistive_arm");
    assert!(found["assumed"]["assistive.feel"]["value"].is_string());
}
