//! Forward dynamics with constraints: `M q̈ = f + Aᵀ λ`, `A q̈ = c`.

use super::null_space::{Fault, NullSpace, Terms};
use crate::error::{ConstraintError, SingularMassMatrix};
use crate::scalar::{Real, Scalar};

/// Accelerations and multipliers of a mechanism with constraints.
///
/// ```text
/// ⎡ M  −Aᵀ ⎤ ⎡ q̈ ⎤   ⎡ f ⎤
/// ⎣ A   0  ⎦ ⎣ λ ⎦ = ⎣ c ⎦
/// ```
///
/// | argument | meaning                                                          | shape    | unit                         |
/// |----------|------------------------------------------------------------------|----------|------------------------------|
/// | `m`      | mass matrix, lower triangle read; it may be singular             | `[N][N]` | of force per acceleration    |
/// | `a`      | rows of the constraints; they may depend on each other           | `[K][N]` | of `c` per acceleration      |
/// | `force`  | `f = Q − C q̇ − G − ∂D/∂q̇`                                        | `N`      | conjugate to `q`             |
/// | `target` | `c = −γ`                                                         | `K`      | of the rows, per s²          |
///
/// Only motions that `A` leaves need inertia: the condition that counts is that of the constrained motion, not those of
/// `M` or of `A M⁻¹ Aᵀ`. A change of units of coordinates, rows and forces by powers of two changes exponents only.
///
/// Rows that depend on others (to about 1e-10, 5e-6 for `f32`) and agree with them (to about 1e-8, 5e-4 for `f32`, of
/// `c` and of the terms of `A q̈`, of the row and of those it depends on) leave `q̈` and `Aᵀ λ` as they are;
/// `Σ (λₖ aₖ)²` is then least, where `aₖ` is the greatest `|Aₖᵢ| dᵢ` of the row, rounded down to a power of two, and
/// `dᵢ` are the scales of the coordinates: `1/√Mᵢᵢ` of those that are independent. Everything is NaN where rows
/// contradict each other, where a motion that they leave has no inertia, and where a number is infinite or NaN;
/// [`try_constrained_solve`] says which.
///
/// Lanes are solved one by one, each in its own basis; of dual numbers the derivatives are a second solution,
/// `q̈′ = K⁻¹ (b′ − K′ x)`.
///
/// ```
/// // A bead of mass 2 on the line y = x/2, pulled along x; and a massless coordinate z = y.
/// let (q, l) = mbs_runtime::constrained_solve(
///     [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]],
///     [[-0.5, 1.0, 0.0], [0.0, -1.0, 1.0]],
///     [5.0, 0.0, 0.0],
///     [0.0, 0.0],
/// );
/// assert_eq!((q, l), ([2.0, 1.0, 1.0], [2.0, 0.0]));
/// ```
///
/// Source: M. Benzi, G. H. Golub, J. Liesen, *Numerical solution of saddle point problems*, Acta Numerica 14 (2005),
/// section 6 (null space methods), with scales after Duff and Koster (`dynamics/scaling.rs`); J. Nocedal, S. J.
/// Wright, *Numerical Optimization*, 2nd ed. 2006, section 16.2.
#[must_use]
pub fn constrained_solve<T: Scalar, const N: usize, const K: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [T; N],
    target: [T; K],
) -> ([T; N], [T; K]) {
    let (accelerations, multipliers) = constrained_solve_many(m, a, force.map(|f| [f]), target.map(|c| [c]));
    (accelerations.map(|[q]| q), multipliers.map(|[l]| l))
}

/// Solves `M q̈ = f + Aᵀ λ`, `A q̈ = c` where rows are the components of vectors: those with the same number in
/// `vectors` share a unit, and a row that moves the same coordinates less than another of its vector is known no better
/// than that.
///
/// So a component that vanishes for the vectors of a hinge that are nearly parallel to an axis is one of a vector of
/// order one, not an equation of its own; in what [`constrained_solve`] makes least, `aₖ` is then the greatest
/// `|Aⱼᵢ| dᵢ` of its vector in the coordinates that it moves.
///
/// ```
/// // The axes of a hinge, 1e-12 from upright: the third component asks for what the others do, to rounding.
/// let (x, y) = (1e-12, 2e-12);
/// let a = [[0.0, 1.0, 0.0, -1.0], [-1.0, 0.0, 1.0, 0.0], [y, -x, -y, x]];
/// let m: [[f64; 4]; 4] = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
/// let (f, c) = ([4.0, 2.0, 0.0, 0.0], [3.0, 1.0, -3.0 * x - y + 1e-16]);
/// let (q, _) = mbs_runtime::constrained_solve_vectors(m, a, f, c, [0; 3]);
/// assert_eq!(q, [1.5, 2.5, 2.5, -0.5]);
/// let (alone, _) = mbs_runtime::constrained_solve(m, a, f, c);
/// assert!(alone[0].is_nan());
/// ```
#[must_use]
pub fn constrained_solve_vectors<T: Scalar, const N: usize, const K: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [T; N],
    target: [T; K],
    vectors: [usize; K],
) -> ([T; N], [T; K]) {
    let terms = Terms { vectors: Some(&vectors), ..Terms::unknown() };
    let (accelerations, multipliers) = T::constrained_solve(&m, &a, &force.map(|f| [f]), &target.map(|c| [c]), &terms);
    (accelerations.map(|[q]| q), multipliers.map(|[l]| l))
}

/// [`constrained_solve`] for several right sides, column by column to the bit; matrices are arrays of rows. A column
/// that contradicts the rows is NaN by itself.
#[must_use]
pub fn constrained_solve_many<T: Scalar, const N: usize, const K: usize, const C: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [[T; C]; N],
    target: [[T; C]; K],
) -> ([[T; C]; N], [[T; C]; K]) {
    T::constrained_solve(&m, &a, &force, &target, &Terms::unknown())
}

/// Derivatives of accelerations: [`constrained_solve_many`] of columns that are derivatives of one motion.
///
/// | argument         | meaning                                                                    | shape            |
/// |------------------|----------------------------------------------------------------------------|------------------|
/// | `m`, `a`         | M and A, as of [`constrained_solve`]                                       | `[N][N]`, `[K][N]` |
/// | `force`,`target` | `f′ − M′ q̈ + A′ᵀ λ` and `c′ − A′ q̈`, column by column                       | `[N][C]`, `[K][C]` |
/// | `vectors`        | the number of the vector that each row is of, as of [`constrained_solve_vectors`] | `K`        |
/// | `motion`         | q̈                                                                          | `N`              |
/// | `sizes`          | how large that is by which each column is a derivative, with any sign; 0 where it is not known | `C` |
///
/// Where rows depend on others, a column that is a difference of larger terms may be nothing but their rounding, and
/// need not agree with itself. So its rows contradict each other only by more than rounding (about 1e-8, 5e-4 for
/// `f32`) of the greatest scaled acceleration, of `motion` and of all columns, each for a change by its own size. The
/// results are those of [`constrained_solve_many`], but for columns that it takes for contradictions. All are NaN where
/// `motion` is infinite or NaN.
///
/// ```
/// // Both accelerate by 9.81, and two rows say that they do so alike: the second column is what rounding has left.
/// let (m, a): ([[f64; 2]; 2], _) = ([[1.0, 0.0], [0.0, 1.0]], [[1.0, -1.0], [2.0, -2.0]]);
/// let (force, target) = ([[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1e-15]]);
/// let slopes = mbs_runtime::constrained_slopes(m, a, force, target, [0, 1], &[9.81, 9.81], [1.0, 1.0]);
/// assert_eq!(slopes, [[0.5, 0.0], [0.5, 0.0]]);
/// let (alone, _) = mbs_runtime::constrained_solve_many(m, a, force, target);
/// assert!(alone[0][0] == 0.5 && alone[0][1].is_nan());
/// ```
#[must_use]
pub fn constrained_slopes<T: Scalar, const N: usize, const K: usize, const C: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [[T; C]; N],
    target: [[T; C]; K],
    vectors: [usize; K],
    motion: &[T; N],
    sizes: [T; C],
) -> [[T; C]; N] {
    let terms = Terms { vectors: Some(&vectors), sizes: None, motion: Some(motion), scales: sizes };
    T::constrained_solve(&m, &a, &force, &target, &terms).0
}

/// How large coordinates, speeds and inputs are by which accelerations are differentiated, for [`constrained_slopes`]:
/// numbers of one kind are as large as the largest of them, coordinates of kind 0, which have no unit, as one. That of
/// inputs, the columns after those of coordinates and speeds, does not matter, because no constraint depends on
/// them: 0.
#[must_use]
pub fn state_sizes<T: Scalar, const N: usize, const C: usize>(q: &[T; N], qd: &[T; N], kinds: [usize; N]) -> [T; C] {
    let largest = |values: &[T; N], kind: usize| {
        let alike = values.iter().zip(kinds).filter(|(_, other)| *other == kind);
        alike.fold(T::zero(), |largest, (x, _)| T::blend(largest.less(x.abs()), x.abs(), largest))
    };
    core::array::from_fn(|column| match (kinds.get(column), column.checked_sub(N).and_then(|i| kinds.get(i))) {
        (Some(0), _) => T::one(),
        (Some(&kind), _) => largest(q, kind),
        (None, Some(&kind)) => largest(qd, kind),
        (None, None) => T::zero(),
    })
}

/// [`constrained_solve`], checked: the same bits, or an error.
///
/// # Errors
/// [`ConstraintError::Contradiction`] with a row that depends on others and asks for something else,
/// [`ConstraintError::SingularMassMatrix`] with the coordinate that moves most in a motion without inertia,
/// [`ConstraintError::NonFinite`].
pub fn try_constrained_solve<T: Real, const N: usize, const K: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [T; N],
    target: [T; K],
) -> Result<([T; N], [T; K]), ConstraintError> {
    let mut system = NullSpace::new(&m, &a, None);
    system.factorize()?;
    Ok(system.solve(&force, &target)?)
}

impl<T: Real> From<Fault<T>> for ConstraintError {
    fn from(fault: Fault<T>) -> Self {
        match fault {
            Fault::NonFinite => ConstraintError::NonFinite,
            Fault::Singular { pivot, index } => SingularMassMatrix { pivot: pivot.to_f64(), index }.into(),
            Fault::Contradiction { row, residual } => {
                ConstraintError::Contradiction { row, residual: residual.to_f64() }
            }
        }
    }
}

/// For numbers that are compared as a whole.
pub(crate) fn solve<T: Scalar, const N: usize, const K: usize, const C: usize>(
    m: &[[T; N]; N],
    a: &[[T; N]; K],
    force: &[[T; C]; N],
    target: &[[T; C]; K],
    terms: &Terms<'_, T, N, K, C>,
) -> ([[T; C]; N], [[T; C]; K]) {
    let undefined = T::from_f64(f64::NAN);
    let (mut accelerations, mut multipliers) = ([[undefined; C]; N], [[undefined; C]; K]);
    let mut system = NullSpace::new(m, a, terms.vectors);
    if system.factorize().is_ok() {
        system.solve_columns(force, target, terms, (&mut accelerations, &mut multipliers));
    }
    (accelerations, multipliers)
}
