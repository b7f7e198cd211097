//! Linear algebra of numbers that carry bounds on their rounding errors.

use crate::expr::{Rounded, Value};

pub(super) fn dot(a: &[Rounded], b: &[Rounded]) -> Rounded {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

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

/// A solution of a positive semidefinite system that has one: rows that others determine are left out.
pub(super) fn solve_semidefinite(m: &[Rounded], b: &[Rounded]) -> Vec<Rounded> {
    const DEPENDENT: f64 = 1e-12;
    let n = b.len();
    let (mut a, mut left) = (m.to_vec(), (0..n).collect::<Vec<_>>());
    let mut kept: Vec<usize> = Vec::new();
    let share = |a: &[Rounded], i: usize| (a[i * (n + 1)].value / m[i * (n + 1)].value).max(0.0);
    while let Some(at) = (0..left.len()).max_by(|&i, &j| share(&a, left[i]).total_cmp(&share(&a, left[j]))) {
        let k = left.swap_remove(at);
        if share(&a, k) <= DEPENDENT {
            break;
        }
        kept.push(k);
        for &i in &left {
            let factor = a[i * n + k].div(a[k * n + k]);
            left.iter().for_each(|&j| a[i * n + j] = a[i * n + j] - factor * a[k * n + j]);
        }
    }
    let entries = kept.iter().flat_map(|&i| kept.iter().map(move |&j| m[i * n + j])).collect::<Vec<_>>();
    let solution = solve(&entries, &kept.iter().map(|&i| b[i]).collect::<Vec<_>>());
    let mut x = vec![Rounded::default(); n];
    kept.into_iter().zip(solution).for_each(|(i, value)| x[i] = value);
    x
}

/// Elimination without pivoting, on a positive definite matrix.
pub(super) fn solve(m: &[Rounded], b: &[Rounded]) -> Vec<Rounded> {
    let n = b.len();
    let (mut m, mut x) = (m.to_vec(), b.to_vec());
    for k in 0..n {
        for i in k + 1..n {
            let factor = m[i * n + k].div(m[k * n + k]);
            (k..n).for_each(|j| m[i * n + j] = m[i * n + j] - factor * m[k * n + j]);
            x[i] = x[i] - factor * x[k];
        }
    }
    for i in (0..n).rev() {
        let rest: Rounded = (i + 1..n).map(|j| m[i * n + j] * x[j]).sum();
        x[i] = (x[i] - rest).div(m[i * n + i]);
    }
    x
}
