//! Six equations with six unknowns.

use mbs_runtime::Scalar;

/// The factorization `P A = L U` with partial pivoting.
///
/// # Source
/// G. H. Golub and C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, algorithm 3.4.1.
pub(crate) struct Lu<T> {
    /// Below the diagonal `L`, above it `U`; on it the reciprocals of the pivots.
    factors: [[T; 6]; 6],
    /// The rows in the order in which they were taken.
    order: [usize; 6],
}

/// A pivot that is no larger than this part of the matrix' norm is one of rounding.
const ROUNDING: f64 = 1e-14;

impl<T: Scalar<Mask = bool>> Lu<T> {
    /// `None` where the matrix has no inverse, up to rounding, or is not finite.
    #[inline]
    pub(crate) fn new(mut a: [[T; 6]; 6]) -> Option<Self> {
        let mut order = [0, 1, 2, 3, 4, 5];
        // Frobenius' norm, squared, summed column by column: branches would cost more than squares.
        let mut columns = [T::zero(); 6];
        for row in &a {
            for j in 0..6 {
                columns[j] = columns[j] + row[j] * row[j];
            }
        }
        let square = columns.into_iter().fold(T::zero(), |sum, column| sum + column);
        let least = T::from_f64(ROUNDING * ROUNDING) * square;
        for k in 0..6 {
            let mut best = k;
            for i in k + 1..6 {
                if a[best][k].abs().less(a[i][k].abs()) {
                    best = i;
                }
            }
            a.swap(k, best);
            order.swap(k, best);
            // NaN is larger than nothing.
            if !least.less(a[k][k] * a[k][k]) {
                return None;
            }
            let reciprocal = T::one() / a[k][k];
            a[k][k] = reciprocal;
            let (above, below) = a.split_at_mut(k + 1);
            let pivot_row = &above[k];
            for row in below {
                let factor = row[k] * reciprocal;
                row[k] = factor;
                for j in k + 1..6 {
                    row[j] = row[j] - factor * pivot_row[j];
                }
            }
        }
        Some(Self { factors: a, order })
    }

    /// `x` with `A x = b`.
    #[inline]
    pub(crate) fn solve(&self, b: &[T; 6]) -> [T; 6] {
        let mut x = *b;
        for i in 0..6 {
            x[i] = b[self.order[i]];
        }
        for i in 1..6 {
            for j in 0..i {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
        }
        for i in (0..6).rev() {
            for j in i + 1..6 {
                x[i] = x[i] - self.factors[i][j] * x[j];
            }
            x[i] = x[i] * self.factors[i][i];
        }
        x
    }
}

pub(crate) fn transpose<T: Scalar>(a: &[[T; 6]; 6]) -> [[T; 6]; 6] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_where_rows_must_be_exchanged() {
        let a: [[f64; 6]; 6] =
            core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 0.0 } else { 1.0 / (1 + i + 2 * j) as f64 }));
        let x = [1.0, -2.0, 3.0, 0.5, -0.25, 4.0];
        let b = a.map(|row| (0..6).map(|j| row[j] * x[j]).sum());
        let found = Lu::new(a).unwrap().solve(&b);
        assert!((0..6).all(|i| (found[i] - x[i]).abs() < 1e-11), "{found:?}");
    }

    #[test]
    fn refuses_what_has_no_inverse() {
        let twice: [[f64; 6]; 6] = core::array::from_fn(|i| core::array::from_fn(|j| ((i % 5) * 7 + j * j) as f64));
        assert!(Lu::new(twice).is_none());
        assert!(Lu::new([[0.0; 6]; 6]).is_none());
        assert!(Lu::new([[f64::NAN; 6]; 6]).is_none());
    }
}
