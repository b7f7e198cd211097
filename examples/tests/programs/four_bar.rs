//! `four_bar` as outside programs call it: what it prints and what it draws.

use crate::support::{figure, good, json, numbers};

const PROGRAM: &str = env!("CARGO_BIN_EXE_four_bar");

#[test]
fn the_swing_has_the_period_of_its_linearization() {
    let folder = tempfile::tempdir().unwrap();
    let mut expected = 0.0;
    let periods = ["0.02", "0.01"].map(|amplitude| {
        let out = folder.path().to_str().unwrap();
        let found = json(&good(PROGRAM, &["--json", "--amplitude", amplitude, "--out", out]));
        let number = |name: &str| numbers(&found[name])[0];
        assert!(number("largest_residual") < 1e-14, "{found}");
        expected = number("linear_period");
        number("period")
    });
    // Richardson: the error falls with the square of the amplitude.
    let limit = (4.0 * periods[1] - periods[0]) / 3.0;
    assert!((limit - expected).abs() < 1e-6 * expected, "{limit} {expected} {periods:?}");
    assert!(figure(folder.path(), "four_bar").contains("middle of the coupler"));
}
