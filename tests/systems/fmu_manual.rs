//! The manual of FMUs and the program that the tests of `mbs fmu` run.

#[test]
fn the_manual_shows_the_program_that_is_run() {
    let manual = include_str!("../../docs/fmu.md");
    let program = include_str!("../../mbs-cli/tests/fmu/example.py");
    assert!(manual.contains(&format!("```python\n{program}```")));
    assert!(manual.contains("mbs fmu models/mechanisms/cart_pole.mbs --state '{\"theta\": 0.2}' --out cart_pole.fmu"));
}
