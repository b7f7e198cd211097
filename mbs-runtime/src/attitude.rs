//! Attitudes as rotation matrices and as rotation vectors: axis times angle.
//!
//! The rotation vector `φ` of a rotation `R` is the axis that it turns about, as long as the angle that it turns by
//! \[rad\]: `R = exp(φ×)`, where `φ×` is the skew-symmetric matrix with `(φ×) x = φ × x`. The difference of two
//! attitudes is one: `log(R₂ R₁ᵀ)` turns `R₁` into `R₂`, in world axes. Differences that are matrices, or Euler angles,
//! vanish at half a turn or depend on the axes chosen; this one does neither.
//!
//! Matrices are arrays of rows, as in a [`Pose`](crate::Pose).

use core::error::Error;
use core::fmt;

use crate::scalar::{Scalar, length};

/// How far from orthogonal a matrix may be for [`orthonormalized`]: the largest entry of `RᵀR − 1`.
///
/// A rotation written with four digits is off by some 1e-4.
pub const ROTATION_TOLERANCE: f64 = 1e-3;

/// Why a matrix is not taken for a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotARotation {
    /// An entry is infinite or NaN.
    NonFinite {
        /// Its row, counted from 0.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// The determinant is not positive: a reflection, or a matrix without inverse.
    Reflection {
        /// The determinant, −1 for a reflection.
        determinant: f64,
    },
    /// The columns are not orthogonal unit vectors.
    NotOrthogonal {
        /// The largest entry of `RᵀR − 1` by magnitude.
        error: f64,
        /// The largest allowed.
        tolerance: f64,
    },
}

impl fmt::Display for NotARotation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NonFinite { row, column } => {
                write!(f, "entry ({row}, {column}) of the rotation is infinite or NaN")
            }
            Self::Reflection { determinant } => {
                write!(f, "a rotation has the determinant 1, this matrix has {determinant}")
            }
            Self::NotOrthogonal { error, tolerance } => {
                write!(f, "the rotation is off orthogonal by {error:e}, {tolerance:e} is allowed")
            }
        }
    }
}

impl Error for NotARotation {}

/// The rotation `exp(φ×)` by the angle `|φ|` about the axis `φ/|φ|`.
///
/// ```text
/// R = 1 + cos ½θ k× + ½ (k×)²,   k = (sin ½θ / ½θ) φ,   θ = |φ|
/// ```
///
/// Exact where `φ` is zero, and accurate to rounding; that of the angle itself, `ε θ`, turns the result of a large one.
/// An entry of `φ` that is infinite or NaN gives NaN.
///
/// | argument          | meaning                      | shape | unit |
/// |-------------------|------------------------------|-------|------|
/// | `rotation_vector` | axis times angle, world axes | 3     | rad  |
///
/// ```
/// use mbs_runtime::attitude::exp;
///
/// // A quarter turn about z takes x to y: the first column.
/// let rotation = exp(&[0.0, 0.0, core::f64::consts::FRAC_PI_2]);
/// assert!((rotation[1][0] - 1.0).abs() < 1e-15 && rotation[0][0].abs() < 1e-15);
/// ```
///
/// # Source
/// O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, 1840; with half angles,
/// because `1 − cos θ` cancels.
#[must_use]
pub fn exp(rotation_vector: &[f64; 3]) -> [[f64; 3]; 3] {
    let square: f64 = rotation_vector.iter().map(|x| x * x).sum();
    let angle = if square.is_finite() { Scalar::sqrt(square) } else { length(rotation_vector.iter().copied()) };
    let half_angle = 0.5 * angle;
    // Where the angle vanishes, k is φ.
    let (part, cos) = if half_angle == 0.0 {
        (1.0, 1.0)
    } else {
        let (sin, cos) = Scalar::sin_cos(half_angle);
        (sin / half_angle, cos)
    };
    let [x, y, z] = rotation_vector.map(|x| part * x);
    let [a, b, c] = [cos * x, cos * y, cos * z];
    let [xy, xz, yz] = [0.5 * x * y, 0.5 * x * z, 0.5 * y * z];
    let [xx, yy, zz] = [0.5 * x * x, 0.5 * y * y, 0.5 * z * z];
    [[1.0 - (yy + zz), xy - c, xz + b], [xy + c, 1.0 - (xx + zz), yz - a], [xz - b, yz + a, 1.0 - (xx + yy)]]
}

/// The rotation vector of a rotation: its axis times its angle, which is in `[0, π]`.
///
/// Zero for the identity, and accurate to rounding up to half a turn, where both signs of the axis turn alike: there
/// the largest component of the axis is positive.
///
/// | argument   | meaning                                | shape   | unit |
/// |------------|----------------------------------------|---------|------|
/// | `rotation` | a rotation; [`orthonormalized`] checks | `3 × 3` |      |
///
/// The result \[rad\] is in the axes that `rotation` turns; the axis of a rotation is the same in both. An entry of
/// `rotation` that is infinite or NaN gives NaN.
///
/// ```
/// use mbs_runtime::attitude::log;
///
/// // Half a turn about y.
/// let vector = log(&[[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
/// assert_eq!(vector, [0.0, core::f64::consts::PI, 0.0]);
/// ```
///
/// # Source
/// By the quaternion whose largest component is found first: S. W. Shepperd, *Quaternion from rotation matrix*, Journal
/// of Guidance and Control 1:3, 1978; its angle is `2 atan2(|v|, w)`.
#[must_use]
pub fn log(rotation: &[[f64; 3]; 3]) -> [f64; 3] {
    let r = |i: usize, j: usize| rotation[i][j];
    let trace = r(0, 0) + r(1, 1) + r(2, 2);
    let largest = (0..3).fold(0, |best, i| if r(i, i) > r(best, best) { i } else { best });
    // Four times the quaternion's largest component, squared, is at least 4; all of it is scaled by one factor.
    let (mut v, w);
    if trace >= r(largest, largest) {
        v = [r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)];
        w = 1.0 + trace;
    } else {
        let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
        v = [0.0; 3];
        v[i] = 1.0 + r(i, i) - r(j, j) - r(k, k);
        v[j] = r(j, i) + r(i, j);
        v[k] = r(k, i) + r(i, k);
        w = r(k, j) - r(j, k);
    }
    // q and −q are the same rotation: the one with w ≥ 0 has the angle up to π.
    let (v, w) = if w < 0.0 { (v.map(|x| -x), -w) } else { (v, w) };
    // Every entry is in one of these four. `max` below would drop a NaN, and `atan2` an infinity.
    if ![v[0], v[1], v[2], w].iter().all(|x| x.is_finite()) {
        return [f64::NAN; 3];
    }
    // Scaled, so that no square vanishes while its root does not.
    let scale = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if scale == 0.0 {
        return [0.0; 3];
    }
    let [x, y, z] = v.map(|x| x / scale);
    let norm = Scalar::sqrt(x * x + y * y + z * z);
    let angle = 2.0 * Scalar::atan2(scale * norm, w);
    [x, y, z].map(|x| x * (angle / norm))
}

/// The rotation vector that turns the attitude `from` into `to`, `log(to fromᵀ)` \[rad\], in world axes.
#[must_use]
pub fn difference(to: &[[f64; 3]; 3], from: &[[f64; 3]; 3]) -> [f64; 3] {
    log(&to.map(|row| from.map(|column| dot(row, column))))
}

/// The rotation nearest to `matrix`, if that is one up to [`ROTATION_TOLERANCE`].
///
/// # Errors
/// As [`orthonormalized_within`].
pub fn orthonormalized(matrix: &[[f64; 3]; 3]) -> Result<[[f64; 3]; 3], NotARotation> {
    orthonormalized_within(matrix, ROTATION_TOLERANCE)
}

/// The rotation nearest to `matrix` (the sum of the squared differences of all entries is least), if no entry of `RᵀR −
/// 1` is larger than `tolerance`.
///
/// It is the orthogonal factor of the polar decomposition. A matrix that is a rotation up to rounding comes back
/// unchanged.
///
/// ```
/// use mbs_runtime::attitude::{NotARotation, orthonormalized};
///
/// let diagonal = |x, y, z| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
/// assert_eq!(orthonormalized(&diagonal(1.0001, 1.0001, 1.0001)).unwrap(), diagonal(1.0, 1.0, 1.0));
/// let mirror = diagonal(1.0, 1.0, -1.0);
/// assert_eq!(orthonormalized(&mirror), Err(NotARotation::Reflection { determinant: -1.0 }));
/// ```
///
/// # Errors
/// [`NotARotation`], as [`check_rotation`]; [`NotARotation::NotOrthogonal`] with what is left after the iteration, if
/// it does not come to 1e-12, as for matrices that are nearly singular.
///
/// # Source
/// Newton's iteration `X ← ½ (X + X⁻ᵀ)`: N. J. Higham, *Computing the polar decomposition – with applications*, SIAM
/// Journal on Scientific and Statistical Computing 7:4, 1986, equation (3.1).
pub fn orthonormalized_within(matrix: &[[f64; 3]; 3], tolerance: f64) -> Result<[[f64; 3]; 3], NotARotation> {
    let mut error = check_rotation(matrix, tolerance)?;
    let mut x = *matrix;
    // Quadratic: from an error of 1e-3 the second step reaches rounding.
    for _ in 0..NEWTON_STEPS {
        if error <= ROUNDING {
            break;
        }
        let (cofactors, determinant) = (cofactors(&x), determinant(&x));
        x = core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (x[i][j] + cofactors[i][j] / determinant)));
        error = defect(&x).0;
    }
    // Where an entry is NaN so is the error, and no comparison with it holds.
    if error <= ACCURACY { Ok(x) } else { Err(NotARotation::NotOrthogonal { error, tolerance: ACCURACY }) }
}

/// What rounding leaves of `RᵀR − 1` where every entry is within half a unit in the last place, or nearly.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// What may be left of `RᵀR − 1` in a result.
const ACCURACY: f64 = 1e-12;
/// Newton's steps from a matrix of positive determinant whose error is some thousands, with room.
const NEWTON_STEPS: usize = 30;

/// The largest entry of `RᵀR − 1` by magnitude, if it is at most `tolerance`.
///
/// # Errors
/// [`NotARotation::NonFinite`] where an entry is infinite or NaN, [`NotARotation::NotOrthogonal`] where the columns are
/// not orthogonal unit vectors within `tolerance`, [`NotARotation::Reflection`] where the determinant is not positive.
pub fn check_rotation(matrix: &[[f64; 3]; 3], tolerance: f64) -> Result<f64, NotARotation> {
    let (error, determinant) = defect(matrix);
    // Where an entry is NaN so is the error, and no comparison with it holds.
    if error <= tolerance && determinant > 0.0 {
        return Ok(error);
    }
    for (row, column) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        if !matrix[row][column].is_finite() {
            return Err(NotARotation::NonFinite { row, column });
        }
    }
    if determinant > 0.0 {
        Err(NotARotation::NotOrthogonal { error, tolerance })
    } else {
        Err(NotARotation::Reflection { determinant })
    }
}

/// The largest entry of `RᵀR − 1`, NaN where an entry is, and the determinant of `R`.
fn defect(matrix: &[[f64; 3]; 3]) -> (f64, f64) {
    let [a, b, c] = columns(matrix);
    let entries = [dot(a, a) - 1.0, dot(b, b) - 1.0, dot(c, c) - 1.0, dot(a, b), dot(a, c), dot(b, c)];
    let larger = |largest: f64, x: f64| if largest.is_nan() || x.abs() <= largest { largest } else { x.abs() };
    (entries.into_iter().fold(0.0, larger), determinant(matrix))
}

/// Along the first row.
fn determinant([[m11, m12, m13], [m21, m22, m23], [m31, m32, m33]]: &[[f64; 3]; 3]) -> f64 {
    let minors = [m22 * m33 - m32 * m23, m21 * m33 - m31 * m23, m21 * m32 - m31 * m22];
    m11 * minors[0] - m12 * minors[1] + m13 * minors[2]
}

/// `det(X) X⁻ᵀ`: the columns are the cross products of the others.
fn cofactors(x: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let [a, b, c] = columns(x);
    columns(&[cross(b, c), cross(c, a), cross(a, b)])
}

/// The columns as rows.
fn columns(x: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    core::array::from_fn(|j| x.map(|row| row[j]))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use nalgebra::{Matrix3, UnitQuaternion, UnitVector3, Vector3};

    /// nalgebra's, as the tests compute with them.
    fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| rows[i][j])
    }
    fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
        matrix.transpose().into()
    }
    fn exp(vector: &Vector3<f64>) -> Matrix3<f64> {
        matrix(super::exp(&(*vector).into()))
    }
    fn log(rotation: &Matrix3<f64>) -> Vector3<f64> {
        super::log(&rows(rotation)).into()
    }
    fn orthonormalized(matrix: &Matrix3<f64>) -> Result<Matrix3<f64>, NotARotation> {
        super::orthonormalized(&rows(matrix)).map(self::matrix)
    }
    fn orthonormalized_within(matrix: &Matrix3<f64>, tolerance: f64) -> Result<Matrix3<f64>, NotARotation> {
        super::orthonormalized_within(&rows(matrix), tolerance).map(self::matrix)
    }
    fn check_rotation(matrix: &Matrix3<f64>, tolerance: f64) -> Result<f64, NotARotation> {
        super::check_rotation(&rows(matrix), tolerance)
    }

    /// From nothing to half a turn, dense at both ends.
    const ANGLES: [f64; 22] = [
        0.0,
        1e-300,
        1e-160,
        1e-20,
        1e-12,
        1e-9,
        1e-6,
        1e-3,
        0.1,
        0.5,
        1.0,
        PI / 2.0,
        2.0 * PI / 3.0,
        2.5,
        3.0,
        PI - 1e-3,
        PI - 1e-6,
        PI - 1e-9,
        PI - 1e-12,
        PI - 1e-14,
        PI - 1e-15,
        PI,
    ];

    /// Of a small turn about an axis in a plane, what turns stay in it is of second order: `θ²/2` times products of the
    /// axis.
    #[test]
    fn small_turns_keep_their_second_order() {
        for size in [1e-4, 1e-7, 1e-9, 1e-100] {
            let turned = exp(&Vector3::new(size, size, 0.0))[(0, 1)];
            assert!((turned / (0.5 * size * size) - 1.0).abs() < 1e-8, "{size}: {turned}");
        }
    }

    /// The axes of the world and its diagonals, in all senses, and others near them.
    fn axes() -> impl Iterator<Item = UnitVector3<f64>> {
        let components = [-1.0, -0.3, -1e-9, 0.0, 1e-17, 0.7, 1.0];
        components
            .into_iter()
            .flat_map(move |x| {
                components.into_iter().flat_map(move |y| components.into_iter().map(move |z| Vector3::new(x, y, z)))
            })
            .filter(|axis| axis.norm() > 0.1)
            .map(UnitVector3::new_normalize)
    }

    fn largest(matrix: Matrix3<f64>) -> f64 {
        matrix.iter().fold(0.0, |largest, x| if x.abs() <= largest { largest } else { x.abs() })
    }

    #[test]
    fn exp_is_the_rotation_of_the_quaternion() {
        for axis in axes() {
            for angle in ANGLES {
                let want = UnitQuaternion::from_axis_angle(&axis, angle).to_rotation_matrix();
                let found = exp(&(axis.into_inner() * angle));
                let error = largest(found - want.matrix());
                assert!(error < 1e-15, "{axis:?} by {angle}: {error:e}");
            }
        }
    }

    #[test]
    fn log_is_the_rotation_vector_of_the_quaternion() {
        for axis in axes() {
            for angle in ANGLES {
                let rotation = UnitQuaternion::from_axis_angle(&axis, angle).to_rotation_matrix();
                let found = log(rotation.matrix());
                let want = axis.into_inner() * angle;
                // Within rounding of half a turn both senses are right.
                let error = if angle > PI - 4e-16 {
                    (found - want).amax().min((found + want).amax())
                } else {
                    (found - want).amax()
                };
                assert!(error < 1e-15 * angle.clamp(1e-3, 1.0), "{axis:?} by {angle}: {error:e}");
                assert!(found.norm() <= PI * (1.0 + f64::EPSILON));
            }
        }
    }

    #[test]
    fn log_inverts_exp() {
        for axis in axes() {
            for angle in ANGLES {
                let vector = axis.into_inner() * angle;
                let found = log(&exp(&vector));
                let error = if angle > PI - 4e-16 {
                    (found - vector).amax().min((found + vector).amax())
                } else {
                    (found - vector).amax()
                };
                assert!(error < 1e-15, "{axis:?} by {angle}: {error:e}");
                // Of small rotations all digits come back.
                assert!(angle > 1e-6 || error <= 4.0 * f64::EPSILON * angle, "{axis:?} by {angle}: {error:e}");
            }
        }
    }

    #[test]
    fn ends_are_exact() {
        assert_eq!(exp(&Vector3::zeros()), Matrix3::identity());
        assert_eq!(log(&Matrix3::identity()), Vector3::zeros());
        for i in 0..3 {
            let half_turn = Matrix3::from_fn(|row, column| match (row == column, row == i) {
                (true, true) => 1.0,
                (true, false) => -1.0,
                (false, _) => 0.0,
            });
            let vector = Vector3::from_fn(|row, _| if row == i { PI } else { 0.0 });
            assert_eq!(log(&half_turn), vector);
        }
        // Half a turn about the diagonal of x and y exchanges them.
        let exchange = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
        let diagonal = Vector3::new(1.0, 1.0, 0.0) * (PI / Scalar::sqrt(2.0_f64));
        assert!((log(&exchange) - diagonal).amax() < 1e-15);
    }

    #[test]
    fn no_entry_that_is_not_finite_is_lost() {
        let half_turn = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0));
        for rotation in [Matrix3::identity(), half_turn, exp(&Vector3::new(0.3, 0.2, -0.5))] {
            for (row, column) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let mut broken = rotation;
                    broken[(row, column)] = value;
                    let found = log(&broken);
                    assert!(found.iter().all(|x| x.is_nan()), "{value} at ({row}, {column}): {found:?}");
                }
            }
        }
    }

    /// Squares that overflow, or vanish, do no harm; the axis is kept.
    #[test]
    fn angles_of_any_size() {
        for angle in [5e-324, 1e-200, 1e155, 1e300] {
            let (sin, cos) = Scalar::sin_cos(angle);
            let want = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos);
            assert!(largest(exp(&Vector3::new(angle, 0.0, 0.0)) - want) < 1e-15, "{angle}");
            let turned = exp(&Vector3::new(0.0, 3.0 * angle, 4.0 * angle));
            let axis = Vector3::new(0.0, 0.6, 0.8);
            assert!(
                (turned * axis - axis).amax() < 1e-15
                    && largest(turned.transpose() * turned - Matrix3::identity()) < 1e-15
            );
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(exp(&Vector3::new(0.0, bad, 0.0)).iter().all(|x| x.is_nan()), "{bad}");
        }
    }

    #[test]
    fn more_than_a_turn() {
        let vector = Vector3::new(0.6, -0.8, 0.0) * (2.0 * PI + 0.5);
        assert!((log(&exp(&vector)) - Vector3::new(0.3, -0.4, 0.0)).amax() < 1e-14);
    }

    #[test]
    fn the_nearest_rotation() {
        for axis in axes().step_by(7) {
            let rotation = exp(&(axis.into_inner() * 2.0));
            // A stretch: symmetric, positive. The polar decomposition takes it off again.
            let stretch = Matrix3::new(1.0003, 1e-4, -2e-4, 1e-4, 0.9998, 3e-4, -2e-4, 3e-4, 1.0001);
            let found = orthonormalized(&(rotation * stretch)).expect("within the tolerance");
            assert!(largest(found - rotation) < 1e-15);
            assert!(check_rotation(&found, 2e-15).is_ok());
            // Far from orthogonal, where that is allowed.
            let large = Matrix3::new(3.0, 0.5, 0.0, 0.5, 0.2, 0.1, 0.0, 0.1, 7.0);
            let found = orthonormalized_within(&(rotation * large), 100.0).expect("within the tolerance");
            assert!(largest(found - rotation) < 1e-13);
        }
        // Nearly singular, the iteration ends far from a rotation, or in numbers that are none.
        for least in [1e-30, 1e-200, 1e-305, 5e-324] {
            let flat = Matrix3::from_diagonal(&Vector3::new(least, 1.0, 1.0));
            let refused = orthonormalized_within(&flat, 2.0);
            assert!(
                matches!(refused, Err(NotARotation::NotOrthogonal { error, tolerance }) if (error.is_nan() || error > 1e-12) && tolerance == 1e-12),
                "{least:e}: {refused:?}"
            );
        }
        let exact = exp(&Vector3::new(0.1, -0.7, 0.4));
        assert_eq!(orthonormalized(&exact), Ok(exact), "what is a rotation stays as it is");
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        let rotation = exp(&Vector3::new(0.3, 0.2, -0.5));
        let mut broken = rotation;
        broken[(1, 2)] = f64::NAN;
        assert_eq!(orthonormalized(&broken), Err(NotARotation::NonFinite { row: 1, column: 2 }));
        broken[(0, 0)] = f64::INFINITY;
        assert_eq!(orthonormalized(&broken), Err(NotARotation::NonFinite { row: 0, column: 0 }));
        let mirrored = orthonormalized(&(-rotation));
        assert!(matches!(mirrored, Err(NotARotation::Reflection { determinant }) if (determinant + 1.0).abs() < 1e-15));
        let stretched = orthonormalized(&(1.01 * rotation));
        assert!(
            matches!(stretched, Err(NotARotation::NotOrthogonal { error, tolerance }) if (error - 0.0201).abs() < 1e-12 && tolerance == ROTATION_TOLERANCE)
        );
        assert_eq!(orthonormalized(&Matrix3::zeros()), Err(NotARotation::Reflection { determinant: 0.0 }));
        let columns_alike = Matrix3::from_columns(&[Vector3::x(), Vector3::x(), Vector3::z()]);
        assert!(matches!(orthonormalized(&columns_alike), Err(NotARotation::Reflection { determinant: 0.0 })));
    }
}
