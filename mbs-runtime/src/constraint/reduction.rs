//! Linearized motion on constraints, in coordinates and speeds that are independent.
//!
//! About a state that satisfies the constraints, neighbouring ones satisfy `A_h δq = 0`, with the holonomic rows `A_h`
//! of A, and
//!
//! ```text
//! A δq̇ + D δq = 0,    D = ∂(A q̇ + b)/∂q
//! ```
//!
//! Of `n` coordinates `n − rank A_h` are independent, and of the speeds `n − rank A`. With chosen ones, `δq_I` and
//! `δq̇_J`, the rows are solved for the others by elimination:
//!
//! ```text
//! δq = P δq_I,    δq̇ = S δq_I + R δq̇_J
//! d/dt δq_I = S_I δq_I + R_I δq̇_J
//! d/dt δq̇_J = (Q_J P + V_J S) δq_I + V_J R δq̇_J + U_J δu
//! ```
//!
//! with `Q = ∂q̈/∂q`, `V = ∂q̈/∂q̇`, `U = ∂q̈/∂u` of the constrained accelerations; an index stands for rows.
//! Accelerations keep to `A q̈ + γ = 0` in all neighbouring states, so nothing is left out.
//!
//! Source: J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, *Linearized dynamics equations for the balance
//! and steer of a bicycle: a benchmark and review*, Proc. R. Soc. A 463 (2007), appendix A (independent speeds and
//! coordinates of nonholonomic mechanisms); Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972, chapter VI; G.
//! H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, section 3.4.8 (complete pivoting).

use crate::error::ReductionError;
use crate::mechanism::Linearization;
use crate::scalar::Real;

/// How all changes of coordinates and speeds follow from the independent ones: `δq = P δq_I`, `δq̇ = S δq_I + R δq̇_J`.
///
/// ```
/// use mbs_runtime::{Linearization, Reduction};
///
/// // A point of mass 1 on a circle of radius 1 hangs at (0, −1): φ = (x² + y² − 1)/2, A = [x, y], D = [ẋ, ẏ].
/// let [a, d] = [[[0.0, -1.0]], [[0.0, 0.0]]];
/// // ẍ = λ x, ÿ = λ y − g with λ = (g y − ẋ² − ẏ²)/(x² + y²).
/// let g = 9.81;
/// let accelerations = Linearization { q: [[-g, 0.0], [0.0, 0.0]], qd: [[0.0; 2]; 2], u: [[]; 2] };
/// let reduction = Reduction::new(&a, &d, |_| true, [0], [0]).unwrap();
/// assert_eq!((reduction.p, reduction.r), ([[1.0], [0.0]], [[1.0], [0.0]]));
/// assert_eq!(reduction.linearize(&accelerations).acceleration_q, [[-g]]);
/// // The height does not tell where it is: x would.
/// assert!(Reduction::new(&a, &d, |_| true, [1], [0]).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction<T, const N: usize, const I: usize, const J: usize> {
    /// The independent coordinates.
    pub coordinates: [usize; I],
    /// The independent speeds.
    pub speeds: [usize; J],
    /// P; row `i` is that of coordinate `i`.
    pub p: [[T; I]; N],
    /// R: the mass matrix of the independent speeds is `Rᵀ M R`, forces on them are `Rᵀ Q`.
    pub r: [[T; J]; N],
    /// S
    pub s: [[T; I]; N],
}

/// Linearized motion in independent coordinates and speeds; where they are the same ones, this is
/// `δq̈_I = acceleration_q δq_I + acceleration_qd δq̇_I + acceleration_u δu`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedLinearization<T, const I: usize, const J: usize, const U: usize> {
    /// Rates of the independent coordinates by these: `S_I`.
    pub rate_q: [[T; I]; I],
    /// Rates of the independent coordinates by the independent speeds: `R_I`.
    pub rate_qd: [[T; J]; I],
    /// Rates of the independent speeds by the independent coordinates.
    pub acceleration_q: [[T; I]; J],
    /// Rates of the independent speeds by these.
    pub acceleration_qd: [[T; J]; J],
    /// Rates of the independent speeds by the inputs.
    pub acceleration_u: [[T; U]; J],
}

impl<T: Real, const N: usize, const I: usize, const J: usize> Reduction<T, N, I, J> {
    /// Solves the constraints at one state for what is not named.
    ///
    /// | argument        | meaning                                                                             | shape   |
    /// |-----------------|-------------------------------------------------------------------------------------|---------|
    /// | `jacobian`      | A: the generated `constraint_jacobian`                                              | `K × N` |
    /// | `rate_jacobian` | `∂(A q̇ + b)/∂q`: the generated `constraint_rate_jacobian`                           | `K × N` |
    /// | `is_holonomic`  | of each row: [`Constraints::is_holonomic`](crate::Constraints::is_holonomic)        |         |
    /// | `coordinates`   | numbers of the independent ones, in the order of the result                         | `I`     |
    /// | `speeds`        | likewise                                                                            | `J`     |
    ///
    /// Rows that depend on others are left out. It takes some `K² N` multiplications and allocates nothing.
    ///
    /// # Errors
    /// [`ReductionError`]: what is named is not there or named twice; the constraints tie named ones to each other, or
    /// leave one free that is not named; a number is not finite.
    pub fn new<const K: usize>(
        jacobian: &[[T; N]; K],
        rate_jacobian: &[[T; N]; K],
        is_holonomic: impl Fn(usize) -> bool,
        coordinates: [usize; I],
        speeds: [usize; J],
    ) -> Result<Self, ReductionError> {
        let named = are_named::<N>(&coordinates).map_err(|index| ReductionError::InvalidCoordinate { index })?;
        let constant = [[]; K];
        let solved =
            Elimination::new(jacobian, &constant, is_holonomic, named).solve().map_err(|fault| match fault {
                Fault::Dependent(index) => ReductionError::DependentCoordinate { index },
                Fault::Free(index) => ReductionError::FreeCoordinate { index },
                Fault::Contradiction(row) => ReductionError::RankChanges { row },
                Fault::NonFinite => ReductionError::NonFinite,
            })?;
        let p = core::array::from_fn(|i| coordinates.map(|j| solved.slope(i, j)));

        let named = are_named::<N>(&speeds).map_err(|index| ReductionError::InvalidSpeed { index })?;
        let constant = rate_jacobian.map(|row| times(&row, &p).map(|x| -x));
        let solved = Elimination::new(jacobian, &constant, |_| true, named).solve().map_err(|fault| match fault {
            Fault::Dependent(index) => ReductionError::DependentSpeed { index },
            Fault::Free(index) => ReductionError::FreeSpeed { index },
            Fault::Contradiction(row) => ReductionError::RankChanges { row },
            Fault::NonFinite => ReductionError::NonFinite,
        })?;
        let r = core::array::from_fn(|i| speeds.map(|j| solved.slope(i, j)));
        let s = core::array::from_fn(|i| solved.constant(i));
        Ok(Self { coordinates, speeds, p, r, s })
    }

    /// The motion next to the state, from the derivatives of the constrained accelerations there: the generated
    /// `linearize`.
    #[must_use]
    pub fn linearize<const U: usize>(
        &self,
        accelerations: &Linearization<T, N, U>,
    ) -> ReducedLinearization<T, I, J, U> {
        let Linearization { q, qd, u } = accelerations;
        let by_coordinates = |j: usize| {
            let [position, velocity] = [times(&q[j], &self.p), times(&qd[j], &self.s)];
            core::array::from_fn(|i| position[i] + velocity[i])
        };
        ReducedLinearization {
            rate_q: self.coordinates.map(|i| self.s[i]),
            rate_qd: self.coordinates.map(|i| self.r[i]),
            acceleration_q: self.speeds.map(by_coordinates),
            acceleration_qd: self.speeds.map(|j| times(&qd[j], &self.r)),
            acceleration_u: self.speeds.map(|j| u[j]),
        }
    }
}

/// Row times matrix.
fn times<T: Real, const N: usize, const M: usize>(row: &[T; N], matrix: &[[T; M]; N]) -> [T; M] {
    core::array::from_fn(|j| row.iter().zip(matrix).fold(T::zero(), |sum, (&a, b)| sum + a * b[j]))
}

/// Which are named; else a number that is too large or named before.
fn are_named<const N: usize>(chosen: &[usize]) -> Result<[bool; N], usize> {
    let mut named = [false; N];
    for &index in chosen {
        match named.get_mut(index) {
            Some(named) if !*named => *named = true,
            _ => return Err(index),
        }
    }
    Ok(named)
}

/// Why rows cannot be solved for the columns that are not named.
enum Fault {
    /// A named column follows from other named ones.
    Dependent(usize),
    /// Nothing tells what this column is.
    Free(usize),
    /// The row has no columns left, but a constant.
    Contradiction(usize),
    NonFinite,
}

/// Rows `a x = c`, reduced until each unnamed column that was a pivot stands in one row alone, with the factor 1.
struct Elimination<T, const N: usize, const K: usize, const C: usize> {
    a: [[T; N]; K],
    c: [[T; C]; K],
    named: [bool; N],
    /// Rows that can still give a pivot.
    waiting: [bool; K],
    /// The row that was solved for this column.
    row_of: [Option<usize>; N],
}

impl<T: Real, const N: usize, const K: usize, const C: usize> Elimination<T, N, K, C> {
    /// Rows are scaled to a largest entry of 1, unless all are zero; those that take no part become zero.
    fn new(a: &[[T; N]; K], c: &[[T; C]; K], takes_part: impl Fn(usize) -> bool, named: [bool; N]) -> Self {
        let scale = |row: usize| {
            let size = largest(&a[row]);
            if !takes_part(row) {
                T::zero()
            } else if size == T::zero() {
                T::one()
            } else {
                T::one() / size
            }
        };
        Self {
            a: core::array::from_fn(|row| a[row].map(|x| x * scale(row))),
            c: core::array::from_fn(|row| c[row].map(|x| x * scale(row))),
            named,
            waiting: core::array::from_fn(takes_part),
            row_of: [None; N],
        }
    }

    /// Gauss–Jordan elimination with the largest pivot of all rows and columns that are left.
    fn solve(mut self) -> Result<Self, Fault> {
        let size = self.c.iter().map(|row| largest(row)).fold(T::one(), T::maximum);
        let rounding = T::EPSILON.sqrt() * T::from_f64(1e-2);
        if !self.a.as_flattened().iter().chain(self.c.as_flattened()).all(|x| x.is_finite()) {
            return Err(Fault::NonFinite);
        }
        while let Some((row, column)) = self.pivot().filter(|&(row, column)| self.a[row][column].abs() > rounding) {
            self.solve_for(row, column);
        }
        for row in (0..K).filter(|&row| self.waiting[row]) {
            let rest = |column: &usize| if self.named[*column] { self.a[row][*column].abs() } else { T::zero() };
            let tied = (0..N).reduce(|a, b| if rest(&b) > rest(&a) { b } else { a });
            if let Some(column) = tied.filter(|column| rest(column) > rounding) {
                return Err(Fault::Dependent(column));
            }
        }
        if let Some(column) = (0..N).find(|&column| !self.named[column] && self.row_of[column].is_none()) {
            return Err(Fault::Free(column));
        }
        match (0..K).find(|&row| self.waiting[row] && largest(&self.c[row]) > rounding * size) {
            Some(row) => Err(Fault::Contradiction(row)),
            None => Ok(self),
        }
    }

    /// The largest entry in rows that wait and columns that are neither named nor solved for.
    fn pivot(&self) -> Option<(usize, usize)> {
        let size = |&(row, column): &(usize, usize)| self.a[row][column].abs();
        let columns = || (0..N).filter(|&column| !self.named[column] && self.row_of[column].is_none());
        let entries =
            (0..K).filter(|&row| self.waiting[row]).flat_map(|row| columns().map(move |column| (row, column)));
        entries.reduce(|a, b| if size(&b) > size(&a) { b } else { a })
    }

    /// Divides the row by its entry, and takes it from all others.
    fn solve_for(&mut self, row: usize, column: usize) {
        let reciprocal = T::one() / self.a[row][column];
        self.a[row] = self.a[row].map(|x| x * reciprocal);
        self.c[row] = self.c[row].map(|x| x * reciprocal);
        let (a, c) = (self.a[row], self.c[row]);
        for other in (0..K).filter(|&other| other != row) {
            let factor = self.a[other][column];
            self.a[other] = core::array::from_fn(|j| self.a[other][j] - factor * a[j]);
            self.c[other] = core::array::from_fn(|j| self.c[other][j] - factor * c[j]);
            // What is left of a pivot's column is rounding.
            self.a[other][column] = T::zero();
        }
        self.waiting[row] = false;
        self.row_of[column] = Some(row);
    }

    /// How x of a column changes with x of a named column.
    fn slope(&self, column: usize, named: usize) -> T {
        match self.row_of[column] {
            Some(row) => -self.a[row][named],
            None if column == named => T::one(),
            None => T::zero(),
        }
    }

    /// What x of a column is where the named ones are zero.
    fn constant(&self, column: usize) -> [T; C] {
        self.row_of[column].map_or([T::zero(); C], |row| self.c[row])
    }
}

/// The largest magnitude; NaN if one is.
fn largest<T: Real>(row: &[T]) -> T {
    row.iter().fold(T::zero(), |largest, &x| largest.maximum(x.abs()))
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    /// A disk of radius 2 rolls upright along x with `ẋ = 3`: coordinates x, y, heading φ, spin ψ; rows `ẋ − 2 ψ̇ cos
    /// φ`, `ẏ − 2 ψ̇ sin φ`.
    const A: [[f64; 4]; 2] = [[1.0, 0.0, 0.0, -2.0], [0.0, 1.0, 0.0, 0.0]];
    const D: [[f64; 4]; 2] = [[0.0; 4], [0.0, 0.0, -3.0, 0.0]];

    #[test]
    fn a_disk_that_rolls() {
        let reduction = Reduction::new(&A, &D, |_| false, [0, 1, 2, 3], [3, 2]).unwrap();
        assert_eq!(reduction.r, [[2.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
        // δẏ = 3 δφ: where the heading is another, it goes aside.
        let mut s = [[0.0; 4]; 4];
        s[1][2] = 3.0;
        assert_eq!(reduction.s, s);
        let accelerations = Linearization { q: [[0.0; 4]; 4], qd: [[0.0; 4]; 4], u: [[0.0], [0.0], [5.0], [7.0]] };
        let reduced = reduction.linearize(&accelerations);
        assert_eq!(reduced.acceleration_u, [[7.0], [5.0]]);
        assert_eq!(reduced.rate_q[1], [0.0, 0.0, 3.0, 0.0]);
    }

    #[test]
    fn holonomic_rows_tie_coordinates_too_and_rows_may_be_redundant() {
        // x = 2 ψ, twice, in other units.
        let a = [[1.0, -2.0], [1000.0, -2000.0]];
        let reduction = Reduction::new(&a, &[[0.0; 2]; 2], |_| true, [1], [0]).unwrap();
        assert_eq!((reduction.p, reduction.r), ([[2.0], [1.0]], [[1.0], [0.5]]));
    }

    #[test]
    fn what_is_not_independent_is_named() {
        let reduce = |coordinates: [usize; 4], speeds: [usize; 2]| {
            Reduction::new(&A, &D, |_| false, coordinates, speeds).map(|_| ())
        };
        let all = [0, 1, 2, 3];
        assert_eq!(reduce([0, 1, 2, 2], [2, 3]), Err(ReductionError::InvalidCoordinate { index: 2 }));
        assert_eq!(reduce(all, [2, 4]), Err(ReductionError::InvalidSpeed { index: 4 }));
        // ẋ is given by ψ̇, and ẏ is zero.
        assert_eq!(reduce(all, [0, 3]), Err(ReductionError::DependentSpeed { index: 3 }));
        assert_eq!(reduce(all, [1, 3]), Err(ReductionError::DependentSpeed { index: 1 }));
        let few = Reduction::new(&A, &D, |_| false, all, [3]).map(|_| ());
        assert_eq!(few, Err(ReductionError::FreeSpeed { index: 2 }));
        let few = Reduction::new(&A, &D, |_| false, [0, 1, 2], [2, 3]).map(|_| ());
        assert_eq!(few, Err(ReductionError::FreeCoordinate { index: 3 }));
        let tied = Reduction::new(&A, &D, |_| true, [0, 3], [2, 3]).map(|_| ());
        assert_eq!(tied, Err(ReductionError::DependentCoordinate { index: 3 }));
        let nan = Reduction::new(&[[f64::NAN, 1.0]], &[[0.0; 2]], |_| false, [0, 1], [0]).map(|_| ());
        assert_eq!(nan, Err(ReductionError::NonFinite));
        // One row twice here, but not in the neighbourhood.
        let bent =
            Reduction::new(&[[1.0, 1.0], [1.0, 1.0]], &[[0.0; 2], [0.0, 1.0]], |_| false, [0, 1], [0]).map(|_| ());
        assert!(matches!(bent, Err(ReductionError::RankChanges { .. })), "{bent:?}");
        // x y = 0 at the origin, where the row is zero: at rest it asks for nothing there, on the way along x for δẏ.
        let crossing = |rate: f64| Reduction::new(&[[0.0, 0.0]], &[[0.0, rate]], |_| true, [0, 1], [0, 1]).map(|_| ());
        assert_eq!([0.0, 1.0].map(crossing), [Ok(()), Err(ReductionError::RankChanges { row: 0 })]);
    }
}
