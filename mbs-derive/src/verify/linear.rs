//! Linear algebra of numbers that carry bounds on their rounding errors.

use crate::expr::Rounded;

pub(super) fn add(a: &[Rounded], b: &[Rounded]) -> Vec<Rounded> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

/// A matrix, given row by row, times a vector.
pub(super) fn times(rows: &[Rounded], x: &[Rounded]) -> Vec<Rounded> {
    rows.chunks(x.len()).map(|row| row.iter().zip(x).map(|(&a, &b)| a * b).sum()).collect()
}

pub(super) fn quadratic_form(m: &[Rounded], x: &[Rounded]) -> Rounded {
    times(m, x).iter().zip(x).map(|(&a, &b)| a * b).sum()
}
