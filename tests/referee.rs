//! The generator against a second reading of the language.
//!
//! A short run of what `cargo run --release -p mbs-tests --bin referee -- --seed 1 --count 10000` does at length.

use mbs_tests::referee::{Construct, draw, judge, shrink};
use mbs_tests::robustness::Models;

/// Mechanisms of the manual that are small enough for a patient referee.
#[test]
fn mechanisms_of_the_manual() {
    let models = Models::read();
    let small = |text: &str| text.len() < 900 && !text.contains("quaternion");
    let mut compared = 0;
    for (name, text) in models.mechanisms.iter().filter(|(name, text)| name.starts_with("manual") && small(text)) {
        match judge((text, &models.shared), 1, 1) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => panic!("{name}: {fault}\n{text}"),
        }
    }
    assert!(compared > 300, "{compared} numbers");
}

/// Some constructs at a time; constraints and quaternions, where M may be singular, are the long run's.
#[test]
fn random_mechanisms() {
    let without = [Construct::Constraints, Construct::Quaternions];
    let mut compared = 0;
    for seed in 1..9 {
        let drawn = draw(seed, None, &without);
        match judge((&drawn.text, &drawn.imports), seed, 1) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => {
                let (small, fault) = shrink(&drawn, &fault, seed, 1);
                panic!("seed {seed}: {fault}\n{:?}\n{}", small.imports, small.text);
            }
        }
    }
    assert!(compared > 500, "{compared} numbers");
}
