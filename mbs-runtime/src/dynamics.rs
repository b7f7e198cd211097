//! Linear algebra of forward dynamics: `M x = b` with a mass matrix, symmetric and positive definite; and with
//! constraints, `M q̈ − Aᵀ λ = f`, `A q̈ = c`, where M may be singular.
//!
//! | step                                                                  | file                      |
//! |-----------------------------------------------------------------------|---------------------------|
//! | with constraints: what is solved, and what is reported                 | `constrained.rs`          |
//! | a basis of the motions that constraints leave, chosen at run time      | `null_space.rs`           |
//! | scales that do not depend on units                                    | `scaling.rs`              |
//! | with many constraints: an order of elimination, chosen before          | `sparse.rs`               |
//!
//! # Without constraints
//!
//! The factorization is `M = L D Lᵀ`, `L` unit lower triangular, `D` diagonal; no square roots, no pivoting (a positive
//! definite matrix needs none), no branches. Only the lower triangle of `M` is read.
//!
//! # Order of operations
//!
//! Programs that are to give the same bits do the same operations, in this order, each rounded by itself (plain `*`,
//! `+`, `-`, `/`; never a fused multiply–add). With `u`, `l`, `r`, `y`, `z` as names of intermediate values:
//!
//! ```text
//! for j in 0..N:
//!     u[j][j] = ((M[j][j] − u[j][0]·l[j][0]) − u[j][1]·l[j][1]) − … − u[j][j−1]·l[j][j−1]      pivot d[j]
//!     r[j]    = 1 / u[j][j]
//!     for i in j+1..N:
//!         u[i][j] = ((M[i][j] − u[i][0]·l[j][0]) − u[i][1]·l[j][1]) − … − u[i][j−1]·l[j][j−1]
//!         l[i][j] = u[i][j]·r[j]
//! for i in 0..N:                       L y = b
//!     y[i] = ((b[i] − l[i][0]·y[0]) − l[i][1]·y[1]) − … − l[i][i−1]·y[i−1]
//! for i in N−1 down to 0:              Lᵀ x = D⁻¹ y
//!     z[i] = y[i]·r[i]
//!     x[i] = ((z[i] − l[i+1][i]·x[i+1]) − l[i+2][i]·x[i+2]) − … − l[N−1][i]·x[N−1]
//! ```
//!
//! Every sum is taken from left to right, and every product has its factors in the order written (which matters to no
//! bit). The order in which independent values are computed does not matter either, and differs here: updates go
//! column by column, so that the compiler can use vector instructions.
//!
//! Source: G. H. Golub and C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, section 4.1.2.

use crate::error::SingularMassMatrix;
use crate::scalar::{Real, Scalar};

mod constrained;
mod null_space;
mod scaling;
mod sparse;

pub(crate) use constrained::solve as solve_constrained;
pub use constrained::{
    constrained_slopes, constrained_solve, constrained_solve_many, constrained_solve_vectors, state_sizes,
    try_constrained_solve,
};
pub use null_space::Terms;
pub(crate) use scaling::scaled;
pub use sparse::{Elimination, Factors, sparse_least_change, sparse_slopes, sparse_solve};

/// `x` with `M x = b`, for `M` symmetric and positive definite.
///
/// `N³/6 + 3N²/2` multiplications or so and `N` divisions, in the [order documented](self). Where `M` is singular the
/// result is infinite, NaN or what rounding makes of it; [`try_ldlt_solve`] checks.
///
/// | argument | meaning                              | shape     | unit                              |
/// |----------|--------------------------------------|-----------|-----------------------------------|
/// | `m`      | mass matrix, lower triangle read     | `[N][N]`  | of force per acceleration         |
/// | `rhs`    | right-hand side `b`, a force         | `N`       | conjugate to `q`                  |
///
/// ```
/// let x = mbs_runtime::ldlt_solve([[4.0, 2.0], [2.0, 3.0]], [8.0, 8.0]);
/// assert_eq!(x, [1.0, 2.0]);
/// ```
#[must_use]
pub fn ldlt_solve<T: Scalar, const N: usize>(m: [[T; N]; N], rhs: [T; N]) -> [T; N] {
    Ldlt::new(m).solve(rhs)
}

/// `X` with `M X = B`, column by column what [`ldlt_solve`] gives, to the bit. `rhs` and result are arrays of rows.
#[must_use]
pub fn ldlt_solve_many<T: Scalar, const N: usize, const K: usize>(m: [[T; N]; N], rhs: [[T; K]; N]) -> [[T; K]; N] {
    Ldlt::new(m).solve_many(rhs)
}

/// [`ldlt_solve`], checked: the same bits, or an error.
///
/// # Errors
/// [`SingularMassMatrix`] if a pivot is not greater than `N ε |M[i][i]|`, the rounding error it may hold: `M` is
/// singular, indefinite or not finite.
pub fn try_ldlt_solve<T: Real, const N: usize>(m: [[T; N]; N], rhs: [T; N]) -> Result<[T; N], SingularMassMatrix> {
    Ok(Ldlt::try_new(m)?.solve(rhs))
}

/// The factorization `M = L D Lᵀ` of a symmetric positive definite matrix, to solve with more than once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ldlt<T, const N: usize> {
    /// Below the diagonal `L`, on it `D`; what is above is not read.
    factors: [[T; N]; N],
    /// `1 / D`.
    reciprocals: [T; N],
}

impl<T: Scalar, const N: usize> Ldlt<T, N> {
    /// Factorizes `m`, of which the lower triangle is read, in the [order documented](self).
    #[must_use]
    pub fn new(mut m: [[T; N]; N]) -> Self {
        let mut reciprocals = [T::one(); N];
        for k in 0..N {
            reciprocals[k] = T::one() / m[k][k];
            // Column k of L; u[i][j] for j > k loses u[i][k]·l[j][k].
            let mut column = [T::zero(); N];
            for i in k + 1..N {
                column[i] = m[i][k] * reciprocals[k];
            }
            for i in k + 1..N {
                let u = m[i][k];
                for j in k + 1..=i {
                    m[i][j] = m[i][j] - u * column[j];
                }
                m[i][k] = column[i];
            }
        }
        Self { factors: m, reciprocals }
    }

    /// `x` with `M x = b`.
    #[must_use]
    pub fn solve(&self, mut rhs: [T; N]) -> [T; N] {
        for k in 0..N {
            for i in k + 1..N {
                rhs[i] = rhs[i] - self.factors[i][k] * rhs[k];
            }
        }
        for i in (0..N).rev() {
            let mut x = rhs[i] * self.reciprocals[i];
            for k in i + 1..N {
                x = x - self.factors[k][i] * rhs[k];
            }
            rhs[i] = x;
        }
        rhs
    }

    /// `X` with `M X = B`, arrays of rows: column by column what [`solve`](Self::solve) gives, to the bit.
    #[must_use]
    pub fn solve_many<const K: usize>(&self, mut rhs: [[T; K]; N]) -> [[T; K]; N] {
        for k in 0..N {
            let y = rhs[k];
            for i in k + 1..N {
                for c in 0..K {
                    rhs[i][c] = rhs[i][c] - self.factors[i][k] * y[c];
                }
            }
        }
        for i in (0..N).rev() {
            let mut x = rhs[i].map(|y| y * self.reciprocals[i]);
            for k in i + 1..N {
                for c in 0..K {
                    x[c] = x[c] - self.factors[k][i] * rhs[k][c];
                }
            }
            rhs[i] = x;
        }
        rhs
    }

    /// The diagonal of `D`, in the units of the mass matrix; all positive where `M` is positive definite.
    #[must_use]
    pub fn pivots(&self) -> [T; N] {
        core::array::from_fn(|i| self.factors[i][i])
    }
}

impl<T: Real, const N: usize> Ldlt<T, N> {
    /// Factorizes `m`, with a check of the pivots.
    ///
    /// # Errors
    /// [`SingularMassMatrix`] as in [`try_ldlt_solve`].
    pub fn try_new(m: [[T; N]; N]) -> Result<Self, SingularMassMatrix> {
        let ldlt = Self::new(m);
        let rounding = T::from_f64(N as f64) * T::EPSILON;
        for (index, pivot) in ldlt.pivots().into_iter().enumerate() {
            let positive = pivot > rounding * m[index][index].abs();
            if !(positive && pivot.is_finite()) {
                return Err(SingularMassMatrix { pivot: pivot.to_f64(), index });
            }
        }
        Ok(ldlt)
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
    use crate::dual::Dual;

    /// A symmetric positive definite matrix and a right-hand side, deterministic.
    fn problem<const N: usize>() -> ([[f64; N]; N], [f64; N]) {
        let entry = |i: usize, j: usize| (((i * 7 + j * 13 + 5) % 11) as f64 - 5.0) / 3.0;
        let m = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let product: f64 = (0..N).map(|k| entry(i, k) * entry(j, k)).sum();
                product + if i == j { 1.5 } else { 0.0 }
            })
        });
        (m, core::array::from_fn(|i| entry(i, 3)))
    }

    /// The order of operations as the module's documentation states it, literally.
    fn as_documented<const N: usize>(m: [[f64; N]; N], b: [f64; N]) -> [f64; N] {
        let (mut u, mut l, mut r) = ([[0.0; N]; N], [[0.0; N]; N], [0.0; N]);
        for j in 0..N {
            for i in j..N {
                let mut sum = m[i][j];
                for k in 0..j {
                    sum -= u[i][k] * l[j][k];
                }
                u[i][j] = sum;
                if i == j {
                    r[j] = 1.0 / sum;
                } else {
                    l[i][j] = sum * r[j];
                }
            }
        }
        let (mut y, mut x) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            y[i] = b[i];
            for k in 0..i {
                y[i] -= l[i][k] * y[k];
            }
        }
        for i in (0..N).rev() {
            x[i] = y[i] * r[i];
            for k in i + 1..N {
                x[i] -= l[k][i] * x[k];
            }
        }
        x
    }

    fn check<const N: usize>() {
        let (m, b) = problem::<N>();
        let x = ldlt_solve(m, b);
        assert_eq!(x.map(f64::to_bits), as_documented(m, b).map(f64::to_bits), "N = {N}");
        assert_eq!(try_ldlt_solve(m, b), Ok(x));
        for i in 0..N {
            let residual: f64 = (0..N).map(|j| m[i][j] * x[j]).sum::<f64>() - b[i];
            assert!(residual.abs() < 1e-11, "N = {N}: {residual}");
        }
        let many = ldlt_solve_many(m, core::array::from_fn(|i| [b[i], 2.0 * b[i], m[i][0]]));
        for i in 0..N {
            assert_eq!(many[i][0].to_bits(), x[i].to_bits());
            assert_eq!(many[i][1], 2.0 * x[i]);
            let unit = if i == 0 { 1.0 } else { 0.0 };
            assert!((many[i][2] - unit).abs() < 1e-11);
        }
    }

    #[test]
    fn solves_in_the_documented_order() {
        check::<1>();
        check::<2>();
        check::<3>();
        check::<6>();
        check::<9>();
        check::<17>();
    }

    #[test]
    fn no_coordinates_no_work() {
        let nothing: [f64; 0] = [];
        assert_eq!(ldlt_solve([], nothing), nothing);
        assert_eq!(ldlt_solve_many([[1.0, 0.0], [0.0, 1.0]], [nothing; 2]), [nothing; 2]);
    }

    #[test]
    fn the_upper_triangle_is_not_read() {
        let (mut m, b) = problem::<4>();
        let x = ldlt_solve(m, b);
        for i in 0..4 {
            for j in i + 1..4 {
                m[i][j] = f64::NAN;
            }
        }
        assert_eq!(ldlt_solve(m, b), x);
    }

    #[test]
    fn singular_matrices_are_reported() {
        let solve = |m| try_ldlt_solve(m, [1.0, 1.0]).unwrap_err();
        assert_eq!(solve([[1.0, 2.0], [2.0, 4.0]]), SingularMassMatrix { pivot: 0.0, index: 1 });
        assert_eq!(solve([[0.0, 0.0], [0.0, 4.0]]), SingularMassMatrix { pivot: 0.0, index: 0 });
        assert_eq!(solve([[1.0, 3.0], [3.0, 4.0]]), SingularMassMatrix { pivot: -5.0, index: 1 });
        assert_eq!(solve([[f64::NAN, 0.0], [0.0, 4.0]]).index, 0);
        assert_eq!(solve([[1.0, 0.0], [f64::INFINITY, 4.0]]).index, 1);
        // What is left of 1/3 is rounding, not inertia.
        let third = 1.0 / 3.0;
        assert_eq!(solve([[3.0, 1.0], [1.0, third + f64::EPSILON / 8.0]]).index, 1);
    }

    #[test]
    fn dual_numbers_differentiate_the_solution() {
        // x = b/m, x' = −b m'/m².
        let x = ldlt_solve([[Dual::variable(2.0)]], [Dual::constant(3.0)]);
        assert_eq!((x[0].value, x[0].derivative), (1.5, -0.75));
    }
}
