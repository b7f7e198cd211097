//! Equations of the thesis typed from the print, or as corrected, and evaluated beside the generated code: those that
//! have no erratum of their own, and those whose numbers `docs/thesis/` shows.
//!
//! What is wrong in print is in `tests/errata/`; `docs/thesis/equations.md` names the tests of every number.

mod chapter_3;
mod chapter_4;
mod chapter_5;
mod chapter_7;

use mbs_runtime::Dual;

use crate::thesis_map::page;

/// Dual numbers at these values, with these derivatives.
fn along<const N: usize>(values: &[f64; N], rates: &[f64; N]) -> [Dual<f64>; N] {
    std::array::from_fn(|i| Dual { value: values[i], derivative: rates[i] })
}

/// The page of the chapter shows these numbers, in this order, with this many decimals.
#[track_caller]
fn assert_shown(chapter: u32, numbers: &[f64], decimals: usize) {
    let shown: Vec<String> = numbers.iter().map(|x| format!("{x:.decimals$}").replace('-', "−")).collect();
    let shown = shown.join(", ");
    assert!(page(&format!("chapter_{chapter}.md")).contains(&shown), "chapter {chapter} does not show {shown}");
}
