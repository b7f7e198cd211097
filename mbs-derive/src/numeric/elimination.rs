//! Elimination of symmetric matrices whose entries are known to rounding: M, and M on the motions that A allows.

use crate::expr::{Rounded, Scales};

/// The first-order bounds of rounding errors are allowed this many times.
pub(crate) const ROUNDING: f64 = 8.0;

/// `M + Aᵀ A`, positive definite where M is so on the motions that A leaves; in the scales of the solution, which are
/// those of the units.
pub(crate) fn on_allowed_motions(
    n: usize,
    mut mass: Vec<Rounded>,
    mut a: Vec<Rounded>,
    vectors: &[usize],
) -> Vec<Rounded> {
    let scales = scales(n, &mass, &a, vectors);
    mass.iter_mut().enumerate().for_each(|(k, x)| *x = scales.mass(k / n, k % n, *x));
    a.iter_mut().enumerate().for_each(|(k, x)| *x = scales.row(k / n, k % n, *x));
    let gram = |i: usize, j: usize| a.chunks(n).map(|row| row[i] * row[j]).sum::<Rounded>();
    (0..n * n).map(|k| mass[k] + gram(k / n, k % n)).collect()
}

/// The scales of M and A, rows of the same number in `vectors` of one vector; what cannot be told from zero is zero.
pub(crate) fn scales(n: usize, mass: &[Rounded], a: &[Rounded], vectors: &[usize]) -> Scales {
    let known = |v: &Rounded| if v.value.abs() <= ROUNDING * v.error { 0.0 } else { v.value };
    let rows: Vec<Vec<f64>> = a.chunks(n).map(|row| row.iter().map(known).collect()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    Scales::of(n, &|i| known(&mass[i * (n + 1)]), &rows, vectors)
}

/// What elimination shows, and below what a pivot may be nothing but rounding.
pub(crate) fn eliminate_rounded(m: &[Rounded], n: usize) -> (Elimination, f64) {
    // A diagonal that cannot be told from zero is zero.
    let value = |k: usize| if k / n == k % n && m[k].value.abs() <= ROUNDING * m[k].error { 0.0 } else { m[k].value };
    let values: Vec<f64> = (0..n * n).map(value).collect();
    let scale = |k: usize| (values[k / n * (n + 1)] * values[k % n * (n + 1)]).sqrt();
    let inherited = (0..n * n).map(|k| if scale(k) > 0.0 { m[k].error / scale(k) } else { 0.0 }).fold(0.0, f64::max);
    // Elimination with the largest pivots is backward stable: Higham, Accuracy and Stability of Numerical Algorithms,
    // 2nd ed. 2002, section 10.3.
    let rounding = 64.0 * n as f64 * (inherited + f64::EPSILON);
    (eliminate(&values, n), rounding)
}

/// What a symmetric elimination with the largest pivot first shows of a matrix scaled to a unit diagonal.
#[derive(Clone, Debug)]
pub struct Elimination {
    /// The smallest pivot: 0 where the matrix is singular, negative where it is indefinite.
    pub smallest: f64,
    /// Its row.
    pub(crate) last: usize,
}

/// Eliminates `m`, a square matrix given row by row.
pub fn eliminate(m: &[f64], n: usize) -> Elimination {
    let diagonal = |i: usize| m[i * n + i];
    if let Some(i) = (0..n).find(|&i| diagonal(i) < 0.0 || diagonal(i).is_nan()) {
        return Elimination { smallest: -1.0, last: i };
    }
    if let Some(i) = (0..n).find(|&i| diagonal(i) == 0.0) {
        return Elimination { smallest: 0.0, last: i };
    }
    let mut a: Vec<f64> = (0..n * n).map(|k| m[k] / (diagonal(k / n) * diagonal(k % n)).sqrt()).collect();
    let mut left: Vec<usize> = (0..n).collect();
    let mut result = Elimination { smallest: 1.0, last: 0 };
    while let Some(at) = (0..left.len()).max_by(|&i, &j| a[left[i] * (n + 1)].total_cmp(&a[left[j] * (n + 1)])) {
        let k = left[at];
        let pivot = a[k * n + k];
        if pivot < result.smallest {
            (result.smallest, result.last) = (pivot, k);
        }
        // Nothing but rounding may be left, or what is indefinite.
        if pivot <= n as f64 * f64::EPSILON {
            let negative = left.iter().copied().min_by(|&i, &j| a[i * (n + 1)].total_cmp(&a[j * (n + 1)]));
            let last = negative.unwrap_or(k);
            return Elimination { smallest: a[last * (n + 1)], last };
        }
        left.swap_remove(at);
        // Of a large mechanism most entries are zero, and stay so.
        let coupled: Vec<usize> = left.iter().copied().filter(|&i| a[i * n + k] != 0.0).collect();
        for &i in &coupled {
            let factor = a[i * n + k] / pivot;
            coupled.iter().for_each(|&j| a[i * n + j] -= factor * a[k * n + j]);
        }
    }
    result
}
