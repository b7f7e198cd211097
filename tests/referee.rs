//! The generator against a second reading of the language.
//!
//! A short run of what `cargo run --release -p mbs-tests --bin referee -- --seed 1 --count 10000` does at length.

use mbs_tests::referee::{Construct, draw, judge, shrink};
use mbs_tests::robustness::Models;

/// Mechanisms of the manual that are small enough for a patient referee.
#[test]
fn mechanisms_of_the_manual() {
    let models = Models::read();
    let small = |text: &str| text.len() < 1500;
    let mut compared = 0;
    for (name, text) in models.mechanisms.iter().filter(|(name, text)| name.starts_with("manual") && small(text)) {
        match judge((text, &models.shared), 1, 1) {
            Ok(judged) => compared += judged.numbers,
            Err(fault) => panic!("{name}: {fault}\n{text}"),
        }
    }
    assert!(compared > 500, "{compared} numbers");
}

/// Each construct once, with what else its seed has; what makes large mechanisms is met alone.
#[test]
fn random_mechanisms() {
    let large = [Construct::Loops, Construct::Closures, Construct::Rolling, Construct::Quaternions, Construct::Parts];
    let mut compared = 0;
    for (seed, construct) in (1..).zip(Construct::ALL) {
        let without: Vec<Construct> = large.into_iter().filter(|other| *other != construct).collect();
        let drawn = draw(seed, Some(construct), &without);
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
