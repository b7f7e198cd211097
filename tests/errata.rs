//! The errata of the thesis, E1 to E50, a test a number: the printed form and the right one are evaluated, and the
//! right one is that of the generated code, or of the model that computes it.
//!
//! `docs/thesis/errata.md` tells them; `systems/thesis_map.rs` holds the pages of `docs/thesis/` against these tests
//! and
//! against the repository, [`assumed`] its table of assumed values against the code.

#[path = "errata/assumed.rs"]
mod assumed;
#[path = "errata/chapter_3.rs"]
pub(crate) mod chapter_3;
#[path = "errata/chapter_4.rs"]
pub(crate) mod chapter_4;
#[path = "errata/chapter_5.rs"]
mod chapter_5;
#[path = "errata/chapter_7.rs"]
mod chapter_7;

/// The largest difference of two rows of numbers; NaN where one is.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |most, x| if x <= most { most } else { x })
}

/// The printed form gives other numbers, by more than this.
#[track_caller]
fn refuted(what: &str, printed: &[f64], right: &[f64], by: f64) {
    let apart = apart(printed, right);
    assert!(apart > by, "{what}: printed and right are {apart:e} apart\nprinted: {printed:?}\n  right: {right:?}");
}

/// Matrix times vector.
pub(crate) fn times<const N: usize, const M: usize>(matrix: &[[f64; M]; N], vector: &[f64; M]) -> [f64; N] {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}
