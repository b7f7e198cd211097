//! The generator against a second reading of the language.
//!
//! A short run of what `cargo run --release -p mbs-tests --bin referee -- --seed 1 --count 10000` does at length.

use mbs_tests::referee::{Construct, draw, judge, shrink};
use mbs_tests::robustness::Models;

/// What is still wrong in `forward_dynamics` and `linearize` where M is singular does not hide the rest.
const STATES: usize = 2;

/// Mechanisms of the repository and of the manual that are small enough for a patient referee.
#[test]
fn mechanisms_of_the_repository() {
    let models = Models::read();
    let small = |text: &str| text.len() < 900 && !text.contains("quaternion");
    let mut compared = 0;
    for (name, text) in models.mechanisms.iter().filter(|(_, text)| small(text)) {
        match judge((text, &models.shared), 1, STATES) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => panic!("{name}: {fault}"),
        }
    }
    assert!(compared > 1000, "{compared} numbers");
}

/// Every construct by itself, a few times.
#[test]
fn random_mechanisms() {
    let mut compared = 0;
    for (i, construct) in Construct::ALL.into_iter().enumerate() {
        for seed in [1000 * i as u64 + 1, 1000 * i as u64 + 2] {
            let drawn = draw(seed, Some(construct));
            match judge((&drawn.text, &drawn.imports), seed, STATES) {
                Ok(judged) => compared += judged.numbers,
                Err(fault) => {
                    let (small, fault) = shrink(&drawn, &fault, seed, STATES);
                    panic!("seed {seed}, {}: {fault}\n{:?}\n{}", construct.name(), small.imports, small.text);
                }
            }
        }
    }
    assert!(compared > 5000, "{compared} numbers");
}
