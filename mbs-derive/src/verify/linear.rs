//! Linear algebra of numbers in which claims are tested.

use super::tested::Tested;

pub(super) fn add<V: Tested>(a: &[V], b: &[V]) -> Vec<V> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

/// A matrix, given row by row, times a vector.
pub(super) fn times<V: Tested>(rows: &[V], x: &[V]) -> Vec<V> {
    rows.chunks(x.len()).map(|row| row.iter().zip(x).map(|(&a, &b)| a * b).sum()).collect()
}

pub(super) fn quadratic_form<V: Tested>(m: &[V], x: &[V]) -> V {
    times(m, x).iter().zip(x).map(|(&a, &b)| a * b).sum()
}
