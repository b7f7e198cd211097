//! Linear systems of the size of a mechanism, in numbers of twice the digits: elimination with complete pivoting after
//! the rows and columns have been scaled. Of redundant rows it finds some solution, of which q̈ and Aᵀλ are the same as
//! of every other.

use super::number::Real;
use super::wide::Wide;

/// Solutions of `matrix · x = right side`, and the rank.
pub(super) struct Solution {
    pub(super) columns: Vec<Vec<Wide>>,
    pub(super) rank: usize,
    /// Whether the pivots tell the rank from any other: none is nearly zero.
    pub(super) clear: bool,
    /// The least pivot; of the scaled matrix, whose entries are at most about 1.
    pub(super) least: f64,
    /// Whether the rows that are left contradict the others on some right side.
    pub(super) contradictory: bool,
}

fn size(x: Wide) -> f64 {
    x.value().abs()
}

/// The power of two nearest to `x`.
fn power(x: f64) -> f64 {
    2.0_f64.powi(x.log2().round() as i32)
}

/// Powers of two that bring the largest entries of the rows and columns of a symmetric matrix near 1.
fn largest_near_one(matrix: &[Vec<Wide>]) -> Vec<f64> {
    let n = matrix.len();
    let mut scales = vec![1.0; n];
    for _ in 0..20 {
        let largest = |i: usize| (0..n).map(|j| size(matrix[i][j]) * scales[i] * scales[j]).fold(0.0, f64::max);
        let found: Vec<f64> = (0..n).map(largest).collect();
        for (scale, largest) in scales.iter_mut().zip(found).filter(|(_, largest)| *largest > 0.0) {
            *scale *= power(largest.powf(-0.5));
        }
    }
    scales
}

/// Powers of two that bring the diagonal near 1 where it is not zero, and from there the largest entries that lead on
/// to further rows, so that a heavy coordinate and one without inertia count alike in a row that has both.
fn diagonal_near_one(matrix: &[Vec<Wide>]) -> Vec<f64> {
    let n = matrix.len();
    let own = |i: usize| Some(size(matrix[i][i])).filter(|x| *x > 0.0).map(|x| power(x.powf(-0.5)));
    let mut scales: Vec<Option<f64>> = (0..n).map(own).collect();
    loop {
        let reached = |i: usize| {
            let entries = (0..n).filter_map(|j| Some(size(matrix[i][j]) * scales[j]?));
            Some(entries.fold(0.0, f64::max)).filter(|x| *x > 0.0).map(|x| power(1.0 / x))
        };
        let found: Vec<(usize, f64)> =
            (0..n).filter(|&i| scales[i].is_none()).filter_map(|i| Some((i, reached(i)?))).collect();
        if found.is_empty() {
            return scales.into_iter().map(|scale| scale.unwrap_or(1.0)).collect();
        }
        found.into_iter().for_each(|(i, scale)| scales[i] = Some(scale));
    }
}

/// Solves a symmetric system. Pivots below `threshold` of the largest count as zero, and so do those behind `rank`.
/// Each entry, of the scaled system, is off by `noise()` of the largest: no way to solve a dense system bounds its
/// errors entry by entry (Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd edition, 2002, section 9.3).
///
/// Solved in two scalings: the one with more pivots counts, of equal ones that whose least pivot is greater.
pub(super) fn solve(
    matrix: &[Vec<Wide>],
    right: &[Vec<Wide>],
    threshold: f64,
    rank: Option<usize>,
    noise: impl Fn() -> f64,
) -> Solution {
    let by_largest = solve_in(&largest_near_one(matrix), matrix, right, threshold, rank, &noise);
    if by_largest.clear && by_largest.rank == matrix.len() {
        return by_largest;
    }
    let by_diagonal = solve_in(&diagonal_near_one(matrix), matrix, right, threshold, rank, &noise);
    let order = by_diagonal.rank.cmp(&by_largest.rank).then(by_diagonal.least.total_cmp(&by_largest.least));
    if order.is_gt() { by_diagonal } else { by_largest }
}

fn solve_in(
    scales: &[f64],
    matrix: &[Vec<Wide>],
    right: &[Vec<Wide>],
    threshold: f64,
    rank: Option<usize>,
    noise: &impl Fn() -> f64,
) -> Solution {
    let n = matrix.len();
    // Each row with its right sides behind it.
    let mut rows: Vec<Vec<Wide>> = (0..n)
        .map(|i| {
            let left = (0..n).map(|j| matrix[i][j] * scales[i] * scales[j]);
            left.chain(right.iter().map(|column| column[i] * scales[i])).collect()
        })
        .collect();
    let largest: Vec<f64> =
        (0..n + right.len()).map(|j| rows.iter().map(|row| size(row[j])).fold(0.0, f64::max)).collect();
    for row in &mut rows {
        row.iter_mut().zip(&largest).for_each(|(entry, largest)| *entry = *entry + *largest * noise());
    }
    let mut order: Vec<usize> = (0..n).collect();
    let (mut found, mut least, mut left) = (0, f64::INFINITY, 0.0);
    for k in 0..n.min(rank.unwrap_or(n)) {
        let entries = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let Some((i, j)) = entries.max_by(|a, b| size(rows[a.0][a.1]).total_cmp(&size(rows[b.0][b.1]))) else { break };
        let pivot = size(rows[i][j]);
        if pivot.is_nan() || pivot <= threshold {
            left = pivot;
            break;
        }
        least = pivot.min(least);
        rows.swap(k, i);
        rows.iter_mut().for_each(|row| row.swap(k, j));
        order.swap(k, j);
        found = k + 1;
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).skip(k).for_each(|(entry, above)| *entry = *entry - factor * *above);
        }
    }
    let columns = (0..right.len()).map(|c| {
        let mut x = vec![Wide::from(0.0); n];
        for k in (0..found).rev() {
            let rest = (k + 1..found).fold(rows[k][n + c], |rest, j| rest - rows[k][j] * x[order[j]]);
            x[order[k]] = rest / rows[k][k];
        }
        x.iter().zip(scales).map(|(x, scale)| *x * *scale).collect()
    });
    let columns = columns.collect();
    let largest = |range: std::ops::Range<usize>| {
        rows[range].iter().flat_map(|row| &row[n..]).map(|x| size(*x)).fold(0.0, f64::max)
    };
    let contradictory = largest(found..n) > 1e-6 * largest(0..found);
    Solution { columns, rank: found, least, clear: least > 1e-6 && left < 1e-13, contradictory }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_corner_and_redundant_row() {
        let matrix = [[0.0, 0.0, 1.0, 2.0], [0.0, 3e9, 1.0, 2.0], [1.0, 1.0, 0.0, 0.0], [2.0, 2.0, 0.0, 0.0]];
        let matrix = matrix.map(|row| row.map(Wide::from).to_vec());
        let right = [1.0, 2.0, 3.0, 6.0].map(Wide::from).to_vec();
        let solution = solve(&matrix, std::slice::from_ref(&right), 1e-20, None, || 0.0);
        assert_eq!(solution.rank, 3);
        for (row, right) in matrix.iter().zip(right) {
            let terms = row.iter().zip(&solution.columns[0]).map(|(a, x)| *a * *x);
            let left = terms.clone().fold(Wide::from(0.0), |sum, term| sum + term);
            // A double-double rounds to 2⁻¹⁰⁴ of its terms.
            let bound = 1e-30 * (terms.map(size).sum::<f64>() + size(right));
            assert!(size(left - right) <= bound, "{} of {bound}", size(left - right));
        }
    }
}
