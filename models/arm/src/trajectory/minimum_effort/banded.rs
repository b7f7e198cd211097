//! Systems of linear equations whose matrix is zero far from its diagonal.

use std::vec::Vec;

/// A square matrix with nothing farther than `bandwidth` from its diagonal.
pub(super) struct Banded {
    size: usize,
    bandwidth: usize,
    /// Row by row, from `bandwidth` left of the diagonal to `2 bandwidth` right of it: pivoting fills the last part.
    entries: Vec<f64>,
}

impl Banded {
    pub(super) fn zero(size: usize, bandwidth: usize) -> Self {
        Self { size, bandwidth, entries: std::vec![0.0; size * (3 * bandwidth + 1)] }
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        let at = self.at(row, column);
        self.entries[at] += value;
    }

    /// Where an entry is; its column is at most `bandwidth` left of the row's diagonal and `2 bandwidth` right of it.
    fn at(&self, row: usize, column: usize) -> usize {
        row * (3 * self.bandwidth + 1) + column + self.bandwidth - row
    }

    /// `P A = L U` with the largest pivot of each column; `None` where one is zero or NaN: the matrix is singular.
    ///
    /// # Source
    /// G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, section 4.3.3.
    pub(super) fn factorized(mut self) -> Option<Factorized> {
        let (n, b) = (self.size, self.bandwidth);
        let mut pivots = Vec::with_capacity(n);
        for k in 0..n {
            let (below, right) = ((k + b).min(n - 1), (k + 2 * b).min(n - 1));
            let size = |row: usize| self.entries[self.at(row, k)].abs();
            let pivot = (k..=below).fold(k, |best, row| if size(row) > size(best) { row } else { best });
            let regular = size(pivot) > 0.0 && size(pivot).is_finite();
            if !regular {
                return None;
            }
            pivots.push(pivot);
            if pivot != k {
                for column in k..=right {
                    let (upper, lower) = (self.at(k, column), self.at(pivot, column));
                    self.entries.swap(upper, lower);
                }
            }
            let width = right - k;
            let from = self.at(k, k);
            for row in k + 1..=below {
                let to = self.at(row, k);
                let factor = self.entries[to] / self.entries[from];
                self.entries[to] = factor;
                if factor != 0.0 {
                    let (head, tail) = self.entries.split_at_mut(to);
                    let pivot_row = &head[from + 1..=from + width];
                    for (entry, above) in tail[1..=width].iter_mut().zip(pivot_row) {
                        *entry -= factor * above;
                    }
                }
            }
        }
        Some(Factorized { matrix: self, pivots })
    }
}

/// L and U in the place of the matrix.
pub(super) struct Factorized {
    matrix: Banded,
    /// The row that came to each place when that column was eliminated.
    pivots: Vec<usize>,
}

impl Factorized {
    /// The solution of `A x = b`, in the place of b.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let (n, b, a) = (self.matrix.size, self.matrix.bandwidth, &self.matrix.entries);
        for k in 0..n {
            x.swap(k, self.pivots[k]);
            for row in k + 1..=(k + b).min(n - 1) {
                x[row] -= a[self.matrix.at(row, k)] * x[k];
            }
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..=(k + 2 * b).min(n - 1)).map(|j| a[self.matrix.at(k, j)] * x[j]).sum();
            x[k] = (x[k] - known) / a[self.matrix.at(k, k)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Entries that repeat nowhere, zeros on the diagonal among them, so that rows must be exchanged.
    fn matrix(size: usize, bandwidth: usize) -> (Banded, DMatrix<f64>) {
        let mut banded = Banded::zero(size, bandwidth);
        let mut dense = DMatrix::zeros(size, size);
        for row in 0..size {
            for column in row.saturating_sub(bandwidth)..(row + bandwidth + 1).min(size) {
                let angle = (7 * row + 13 * column * column + row * column) as f64;
                let value = if row == column && row % 3 == 0 { 0.0 } else { angle.sin() };
                banded.add(row, column, value);
                dense[(row, column)] += value;
            }
        }
        (banded, dense)
    }

    #[test]
    fn solutions_are_those_of_a_dense_factorization() {
        for (size, bandwidth) in [(1, 1), (7, 1), (40, 5), (30, 29)] {
            let (mut banded, mut dense) = matrix(size, bandwidth);
            if size == 1 {
                banded.add(0, 0, 2.0);
                dense[(0, 0)] += 2.0;
            }
            let right = DVector::from_fn(size, |i, _| (i as f64).cos());
            let want = dense.lu().solve(&right).unwrap();
            let mut found = right.as_slice().to_vec();
            banded.factorized().unwrap().solve(&mut found);
            let error = (DVector::from_vec(found) - &want).amax();
            assert!(error < 1e-10 * want.amax(), "{size} {bandwidth}: {error}");
        }
    }

    #[test]
    fn singular_matrices_have_no_factors() {
        assert!(Banded::zero(3, 1).factorized().is_none());
        let mut unknown = Banded::zero(2, 1);
        unknown.add(0, 0, f64::NAN);
        unknown.add(1, 1, 1.0);
        assert!(unknown.factorized().is_none());
    }
}
