//! Linear systems of the size of a mechanism, in numbers of twice the digits: elimination with complete pivoting after the rows
//! and columns have been scaled. Of redundant rows it finds some solution, of which q̈ and Aᵀλ are the same as of every other.

use twofloat::TwoFloat;

use super::number::Real;

/// Solutions of `matrix · x = right side`, and the rank.
pub(super) struct Solution {
    pub(super) columns: Vec<Vec<TwoFloat>>,
    pub(super) rank: usize,
}

fn size(x: TwoFloat) -> f64 {
    x.value().abs()
}

/// `a / b`, corrected once: the library's quotient may be off in its second half.
fn quotient(a: TwoFloat, b: TwoFloat) -> TwoFloat {
    let first = a / b;
    first + (a - first * b) / b
}

/// Powers of two that bring the largest entries of the rows and columns of a symmetric matrix near 1.
fn scales(matrix: &[Vec<TwoFloat>]) -> Vec<f64> {
    let n = matrix.len();
    let mut scales = vec![1.0; n];
    for _ in 0..20 {
        let largest = |i: usize| (0..n).map(|j| size(matrix[i][j]) * scales[i] * scales[j]).fold(0.0, f64::max);
        let found: Vec<f64> = (0..n).map(largest).collect();
        for (scale, largest) in scales.iter_mut().zip(found).filter(|(_, largest)| *largest > 0.0) {
            *scale *= 2.0_f64.powi((-0.5 * largest.log2()).round() as i32);
        }
    }
    scales
}

/// Solves a symmetric system. Pivots below `threshold` of the largest count as zero, and so do those behind `rank`.
pub(super) fn solve(
    matrix: &[Vec<TwoFloat>],
    right: &[Vec<TwoFloat>],
    threshold: f64,
    rank: Option<usize>,
) -> Solution {
    let (n, scales) = (matrix.len(), scales(matrix));
    // Each row with its right sides behind it.
    let mut rows: Vec<Vec<TwoFloat>> = (0..n)
        .map(|i| {
            let left = (0..n).map(|j| matrix[i][j] * scales[i] * scales[j]);
            left.chain(right.iter().map(|column| column[i] * scales[i])).collect()
        })
        .collect();
    let mut order: Vec<usize> = (0..n).collect();
    let mut found = 0;
    for k in 0..n.min(rank.unwrap_or(n)) {
        let entries = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let Some((i, j)) = entries.max_by(|a, b| size(rows[a.0][a.1]).total_cmp(&size(rows[b.0][b.1]))) else { break };
        let pivot = size(rows[i][j]);
        if pivot.is_nan() || pivot <= threshold {
            break;
        }
        rows.swap(k, i);
        rows.iter_mut().for_each(|row| row.swap(k, j));
        order.swap(k, j);
        found = k + 1;
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = quotient(row[k], pivot[k]);
            row.iter_mut().zip(&pivot).skip(k).for_each(|(entry, above)| *entry -= factor * *above);
        }
    }
    let columns = (0..right.len()).map(|c| {
        let mut x = vec![TwoFloat::from(0.0); n];
        for k in (0..found).rev() {
            let rest = (k + 1..found).fold(rows[k][n + c], |rest, j| rest - rows[k][j] * x[order[j]]);
            x[order[k]] = quotient(rest, rows[k][k]);
        }
        x.iter().zip(&scales).map(|(x, scale)| *x * *scale).collect()
    });
    Solution { columns: columns.collect(), rank: found }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_corner_and_redundant_row() {
        let matrix = [[0.0, 0.0, 1.0, 2.0], [0.0, 3e9, 1.0, 2.0], [1.0, 1.0, 0.0, 0.0], [2.0, 2.0, 0.0, 0.0]];
        let matrix = matrix.map(|row| row.map(TwoFloat::from).to_vec());
        let right = [1.0, 2.0, 3.0, 6.0].map(TwoFloat::from).to_vec();
        let solution = solve(&matrix, std::slice::from_ref(&right), 1e-20, None);
        assert_eq!(solution.rank, 3);
        for (row, right) in matrix.iter().zip(right) {
            let terms = row.iter().zip(&solution.columns[0]).map(|(a, x)| *a * *x);
            let left = terms.clone().fold(TwoFloat::from(0.0), |sum, term| sum + term);
            // A double-double rounds to 2⁻¹⁰⁴ of its terms.
            let bound = 1e-30 * (terms.map(size).sum::<f64>() + size(right));
            assert!(size(left - right) <= bound, "{} of {bound}", size(left - right));
        }
    }
}
