//! What parameters of a mechanism must satisfy: the generated `Params::check` calls what stands here.

use core::error::Error;
use core::fmt;

use crate::scalar::{Mask, Scalar};

/// A parameter, or an expression of parameters, that no mechanism can have.
///
/// ```
/// use mbs_runtime::{ParameterCondition, ParameterError};
/// let error = ParameterError::new("m", -1.0, ParameterCondition::NotNegative);
/// assert_eq!(error.to_string(), "`m` must not be negative, it is -1.0");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParameterError<T = f64> {
    /// The parameter by its name, or what is made of parameters as the declaration has it: `m1 - m2`.
    pub quantity: &'static str,
    /// Its value in SI units, in all lanes; of an inertia the least principal moment, or the greatest less the other
    /// two.
    pub value: T,
    /// What does not hold.
    pub condition: ParameterCondition,
}

/// What a parameter, or an expression of parameters, must satisfy; in every lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ParameterCondition {
    /// It is neither infinite nor NaN.
    Finite,
    /// It is not zero: something is divided by it.
    NotZero,
    /// It is zero or more: a mass, a moment of inertia, what a square root is taken of.
    NotNegative,
    /// It is more than zero: it was declared `positive`, or its logarithm is taken.
    Positive,
    /// The symmetric matrix has no negative principal moment, to a thousandth of the greatest.
    SemiDefinite,
    /// The inertia is that of a body: its principal moments are `0 ≤ a ≤ b ≤ c ≤ a + b`, to a thousandth.
    InertiaOfABody,
}

impl<T> ParameterError<T> {
    /// That this quantity of this value does not satisfy the condition.
    #[must_use]
    pub const fn new(quantity: &'static str, value: T, condition: ParameterCondition) -> Self {
        Self { quantity, value, condition }
    }
}

impl<T: fmt::Debug> fmt::Display for ParameterError<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ParameterError { quantity, value, .. } = self;
        match self.condition {
            ParameterCondition::Finite => write!(f, "`{quantity}` must be finite, it is {value:?}"),
            ParameterCondition::NotZero => write!(f, "`{quantity}` must not be zero, it is {value:?}"),
            ParameterCondition::NotNegative => write!(f, "`{quantity}` must not be negative, it is {value:?}"),
            ParameterCondition::Positive => write!(f, "`{quantity}` must be positive, it is {value:?}"),
            ParameterCondition::SemiDefinite => {
                write!(f, "`{quantity}` must have no negative principal moment, one is {value:?}")
            }
            ParameterCondition::InertiaOfABody => write!(
                f,
                "`{quantity}` must be the inertia of a body: a principal moment is negative, or greater than the sum of the \
                 other two, by {value:?}"
            ),
        }
    }
}

impl<T: fmt::Debug> Error for ParameterError<T> {}

/// Moments of inertia are rounded in data sheets.
const TOLERANCE: f64 = 1e-3;

/// Refuses a number that does not satisfy a condition; NaN satisfies none.
///
/// # Errors
/// [`ParameterError`] with the number.
pub fn require<T: Scalar>(
    quantity: &'static str,
    value: T,
    condition: ParameterCondition,
) -> Result<(), ParameterError<T>> {
    if !value.is_finite() {
        return Err(ParameterError { quantity, value, condition: ParameterCondition::Finite });
    }
    let holds = match condition {
        ParameterCondition::NotZero => !value.equal(T::zero()),
        ParameterCondition::NotNegative => T::zero().less_equal(value),
        ParameterCondition::Positive => T::zero().less(value),
        ParameterCondition::Finite | ParameterCondition::SemiDefinite | ParameterCondition::InertiaOfABody => {
            return Ok(());
        }
    };
    if holds.all() { Ok(()) } else { Err(ParameterError { quantity, value, condition }) }
}

/// Refuses a symmetric matrix, given by its entries xx, yy, zz, xy, xz, yz, that is not positive semidefinite, or not
/// the inertia of a body.
///
/// # Errors
/// [`ParameterError`] with the least principal moment, or what the greatest is more than the sum of the other two.
pub fn require_inertia<T: Scalar>(
    quantity: &'static str,
    entries: [T; 6],
    condition: ParameterCondition,
) -> Result<(), ParameterError<T>> {
    for entry in entries {
        require(quantity, entry, ParameterCondition::Finite)?;
    }
    let [a, b, c] = principal_moments(entries);
    let size = larger(a.abs(), larger(b.abs(), c.abs()));
    let negative = a.less(T::from_f64(-TOLERANCE) * size);
    if negative.any() {
        return Err(ParameterError { quantity, value: a, condition });
    }
    let unequal = (a + b).less(c * T::from_f64(1.0 - TOLERANCE));
    if condition == ParameterCondition::InertiaOfABody && unequal.any() {
        return Err(ParameterError { quantity, value: c - a - b, condition });
    }
    Ok(())
}

fn larger<T: Scalar>(a: T, b: T) -> T {
    T::blend(a.less(b), b, a)
}

/// The eigenvalues of a symmetric matrix, ascending.
///
/// Source: Smith, *Eigenvalues of a symmetric 3 × 3 matrix*, Communications of the ACM 4:4, 1961; of the matrix in
/// units of its greatest entry, so that no square overflows or underflows.
fn principal_moments<T: Scalar>(entries: [T; 6]) -> [T; 3] {
    let constant = T::from_f64;
    let greatest = entries.iter().fold(T::zero(), |greatest, entry| larger(greatest, entry.abs()));
    let unit = T::blend(greatest.equal(T::zero()), T::one(), greatest);
    let [xx, yy, zz, xy, xz, yz] = entries.map(|entry| entry / unit);
    let mean = (xx + yy + zz) * constant(1.0 / 3.0);
    let [a, b, c] = [xx - mean, yy - mean, zz - mean];
    let squares = a * a + b * b + c * c + constant(2.0) * (xy * xy + xz * xz + yz * yz);
    let spread = (squares * constant(1.0 / 6.0)).sqrt();
    let one = T::one();
    let scale = T::blend(spread.equal(T::zero()), one, spread);
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let cosine = determinant / (scale * scale * scale) * constant(0.5);
    let cosine = T::blend(cosine.less(-one), -one, T::blend(one.less(cosine), one, cosine));
    let angle = cosine.acos() * constant(1.0 / 3.0);
    let largest = mean + constant(2.0) * spread * angle.cos();
    let smallest = mean + constant(2.0) * spread * (angle + constant(2.0 * core::f64::consts::FRAC_PI_3)).cos();
    [smallest, constant(3.0) * mean - largest - smallest, largest].map(|moment| moment * unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn numbers() {
        let check = |value: f64, condition, expected: Option<&str>| {
            let found = require("m", value, condition).err().map(|error| error.to_string());
            assert_eq!(found.as_deref(), expected);
        };
        use ParameterCondition::*;
        check(-0.0, NotNegative, None);
        check(-1.0, NotNegative, Some("`m` must not be negative, it is -1.0"));
        check(0.0, Positive, Some("`m` must be positive, it is 0.0"));
        check(0.0, NotZero, Some("`m` must not be zero, it is 0.0"));
        check(1e-300, Positive, None);
        for condition in [Finite, NotZero, NotNegative, Positive] {
            check(f64::NAN, condition, Some("`m` must be finite, it is NaN"));
            check(f64::INFINITY, condition, Some("`m` must be finite, it is inf"));
        }
    }

    #[test]
    fn inertias() {
        let body = |entries| require_inertia("i", entries, ParameterCondition::InertiaOfABody).err();
        let moments = |entries| require_inertia("i", entries, ParameterCondition::SemiDefinite).err();
        for scale in [1e-250, 1e-9, 1.0, 1e250] {
            let scaled = |entries: [f64; 6]| entries.map(|entry| entry * scale);
            assert_eq!(body(scaled([1.0, 2.0, 2.9, 0.0, 0.0, 0.0])), None);
            assert_eq!(body(scaled([2.0, 2.0, 2.0, 0.0, 0.0, 0.0])), None);
            let excess = body(scaled([1.0, 2.0, 4.0, 0.0, 0.0, 0.0])).unwrap().value;
            assert!((excess / scale - 1.0).abs() < 1e-12, "{excess}");
            assert_eq!(moments(scaled([1.0, 2.0, 4.0, 0.0, 0.0, 0.0])), None);
            // Eigenvalues −1, 3, 1.
            let least = moments(scaled([1.0, 1.0, 1.0, 2.0, 0.0, 0.0])).unwrap().value;
            assert!((least / scale + 1.0).abs() < 1e-12, "{least}");
            // A rod along (1, 1, 1), turned: moments 0, 1, 1.
            let third = -1.0 / 3.0;
            assert_eq!(body(scaled([2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, third, third, third])), None);
        }
        assert_eq!(body([0.0; 6]), None);
        assert!(body([f64::NAN; 6]).is_some());
        assert_eq!(
            require_inertia("i", [1e-20_f32, 1e-20, 2e-20, 0.0, 0.0, 0.0], ParameterCondition::InertiaOfABody),
            Ok(())
        );
    }

    /// Each lane must satisfy it; a derivative that is NaN is not finite.
    #[test]
    #[cfg(feature = "wide")]
    fn lanes() {
        let value = wide::f64x4::new([1.0, 2.0, -3.0, 4.0]);
        let error = require("m", value, ParameterCondition::NotNegative).unwrap_err();
        assert_eq!(error.value, value);
        assert!(require("m", value, ParameterCondition::NotZero).is_ok());
    }
}
