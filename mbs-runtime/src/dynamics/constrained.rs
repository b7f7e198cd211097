//! Forward dynamics with constraints: `M q̈ = f + Aᵀ λ`, `A q̈ = c`.

use super::null_space::{Fault, NullSpace};
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
/// Only motions that `A` leaves need inertia: the condition that counts is that of the constrained motion, not those of `M` or
/// of `A M⁻¹ Aᵀ`. A change of units of coordinates, rows and forces by powers of two changes exponents only.
///
/// Rows that depend on others (to about 1e-10, 5e-6 for `f32`) and agree with them (to about 1e-8, 5e-4 for `f32`) leave `q̈` and
/// `Aᵀ λ` as they are; `Σ (λₖ aₖ)²` is then least, where `aₖ` is the greatest `|Aₖᵢ| dᵢ` of the row, rounded down to a power of
/// two, and `dᵢ` are the scales of the coordinates: `1/√Mᵢᵢ` of those that are independent. Everything is NaN where rows
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
/// Source: M. Benzi, G. H. Golub, J. Liesen, *Numerical solution of saddle point problems*, Acta Numerica 14 (2005), section 6
/// (null space methods), with scales after Duff and Koster (`dynamics/scaling.rs`); J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed. 2006, section 16.2.
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

/// The same for several right sides, column by column to the bit; matrices are arrays of rows. A column that contradicts the
/// rows is NaN by itself.
#[must_use]
pub fn constrained_solve_many<T: Scalar, const N: usize, const K: usize, const C: usize>(
    m: [[T; N]; N],
    a: [[T; N]; K],
    force: [[T; C]; N],
    target: [[T; C]; K],
) -> ([[T; C]; N], [[T; C]; K]) {
    T::constrained_solve(&m, &a, &force, &target)
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
    let mut system = NullSpace::new(&m, &a);
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
) -> ([[T; C]; N], [[T; C]; K]) {
    let undefined = T::from_f64(f64::NAN);
    let (mut accelerations, mut multipliers) = ([[undefined; C]; N], [[undefined; C]; K]);
    let mut system = NullSpace::new(m, a);
    if system.factorize().is_ok() {
        for column in 0..C {
            let (force, target) = (force.each_ref().map(|f| f[column]), target.each_ref().map(|c| c[column]));
            let Ok((q, l)) = system.solve(&force, &target) else { continue };
            (0..N).for_each(|i| accelerations[i][column] = q[i]);
            (0..K).for_each(|k| multipliers[k][column] = l[k]);
        }
    }
    (accelerations, multipliers)
}
