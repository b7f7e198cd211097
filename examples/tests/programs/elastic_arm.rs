//! The arm with elastic joints as outside programs see it.

use crate::support::{figure, good, json, numbers};

const ELASTIC_ARM: &str = env!("CARGO_BIN_EXE_elastic_arm");

#[test]
fn the_flange_rings_where_the_acceleration_jumps() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(ELASTIC_ARM, &["--json", "--out", folder.path().to_str().unwrap()]));
    let frequencies = numbers(&found["natural_frequencies_hz"]);
    assert!(frequencies.windows(2).all(|pair| pair[0] < pair[1]) && frequencies[0] > 1.0, "{frequencies:?}");
    let [quartic, quintic] =
        ["quartic", "quintic"].map(|name| found["swing_after_stop"][name].as_f64().expect("a number"));
    assert!(quartic > 10.0 * quintic && quintic >= 0.0, "{quartic} {quintic}");
    // Half a tonne at the flange: millimetres, down.
    assert!((-2e-2..-1e-4).contains(&numbers(&found["deflection"])[2]));
    for key in ["elastic.rotors", "elastic.stiffness", "elastic.damping", "arm.masses"] {
        assert!(found["assumed"][key]["value"].is_string(), "{key}");
    }
    figure(folder.path(), "elastic_arm");
}
