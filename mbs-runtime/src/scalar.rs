//! The numbers that equations of motion are evaluated in.
//!
//! Generated code is generic over [`Scalar`]: `f64` and `f32`, two to sixteen lanes of them
//! ([`wide`](https://docs.rs/wide), feature `wide`), and [`Dual`](crate::Dual) numbers over any of these. What controls
//! errors or writes results needs [`Real`], a scalar with an order and a value as `f64`.
//!
//! The elementary functions of `f32` and `f64` come from the standard library with the feature `std`, from the libm
//! crate with the feature `libm` alone, and with neither of them `f32` and `f64` are not scalars. Generated code has
//! its sines and cosines from [`Scalar::sin_cos_all`], which needs the library for large angles only.

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::dynamics::{Elimination, Factors, Terms};

#[cfg(any(feature = "std", feature = "libm"))]
mod float;
#[cfg(feature = "wide")]
mod lanes;
#[cfg(any(feature = "std", feature = "libm"))]
mod sin_cos;

/// A number, or several numbers in lockstep, that mechanics can be computed with.
///
/// The names are those of `f64`. Where a concrete `f32` or `f64` has a method of the same name, the inherent method
/// wins in method syntax; all but [`signum`](Scalar::signum) and [`mul_add`](Scalar::mul_add) agree with it to the bit
/// where the feature `std` is on.
///
/// Angles are in radians. A branch of a model is written with a [`Mask`] and [`select`](Scalar::select), because lanes
/// may have to go both ways:
///
/// ```
/// use mbs_runtime::Scalar;
///
/// /// Square root of the positive part of `x`.
/// fn root<T: Scalar>(x: T) -> T {
///     T::select(T::zero().less(x), || x.sqrt(), || T::zero())
/// }
/// assert_eq!(root(4.0), 2.0);
/// assert_eq!(root(-4.0), 0.0);
/// ```
pub trait Scalar:
    Copy
    + Clone
    + Debug
    + PartialEq
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What a comparison gives: `bool`, or one truth value per lane.
    type Mask: Mask;

    /// The constant nearest to `value`, in every lane.
    fn from_f64(value: f64) -> Self;

    /// 0.
    #[inline]
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// 1.
    #[inline]
    fn one() -> Self {
        Self::from_f64(1.0)
    }

    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Sine and cosine, the same bits as [`sin`](Scalar::sin) and [`cos`](Scalar::cos) give.
    fn sin_cos(self) -> (Self, Self);
    /// Sines and cosines of several angles at once, in less time than one by one.
    ///
    /// Of `f64` up to 1e5 and of `f32` up to 400 they come from polynomials that are evaluated in lockstep with `+`,
    /// `−` and `×` alone, within 1 ulp (the largest error found is 0.84); of larger ones they are those of
    /// [`sin_cos`](Scalar::sin_cos). Lanes and dual numbers have the same values, number by number.
    ///
    /// | | does a bit of a sine depend on it? |
    /// |---|---|
    /// | the other angles, their number, lanes | no |
    /// | target, its vector instructions, fused multiply–add, optimization | no; beyond 1e5 the library is the platform's |
    /// | features `std`, `libm` | beyond 1e5 only |
    /// | `sin_cos_all` or [`sin`](Scalar::sin) | yes: about one in twenty differs in the last bit |
    ///
    /// On a target without vector instructions, such as a microcontroller, each angle is a call of one function, which
    /// keeps the code small; `f32` needs no arithmetic of doubles there, which the library's functions do.
    ///
    /// The steps, for other languages to take: `src/scalar/sin_cos.rs`.
    #[inline(always)]
    fn sin_cos_all<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        let both = angles.map(Self::sin_cos);
        (both.map(|(sin, _)| sin), both.map(|(_, cos)| cos))
    }
    /// Tangent.
    fn tan(self) -> Self;
    /// Arc sine, in `[−π/2, π/2]`.
    fn asin(self) -> Self;
    /// Arc cosine, in `[0, π]`.
    fn acos(self) -> Self;
    /// Arc tangent, in `(−π/2, π/2)`.
    fn atan(self) -> Self;
    /// The angle of the point `(x, self)`, in `[−π, π]`: `y.atan2(x)` as in `f64`.
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Hyperbolic secant `1/cosh`, whose square is the slope of [`tanh`](Scalar::tanh).
    #[inline]
    fn sech(self) -> Self {
        Self::one() / self.cosh()
    }
    /// `e` to the power of `self`.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `self` to the power of `exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;

    /// −1, 0 or 1: the derivative of `|x|`. `signum(±0) = 0`, where `f64::signum` gives `±1`; NaN for NaN.
    ///
    /// Concrete code writes `Scalar::signum(x)`, because `x.signum()` is the inherent method of `f64`.
    fn signum(self) -> Self;

    /// `self · factor + summand`.
    ///
    /// Fused, with one rounding, where the target has the instruction (`cfg!(target_feature = "fma")`); otherwise a
    /// product and a sum, because the library's function takes three times as long.
    #[inline]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }

    /// True where every lane, and every part of a dual number, is neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// `self < other`, lane by lane; as `less_equal` and `equal` false where one of them is NaN.
    fn less(self, other: Self) -> Self::Mask;
    /// `self ≤ other`, lane by lane.
    fn less_equal(self, other: Self) -> Self::Mask;
    /// `self = other`, lane by lane; a dual number compares its value alone.
    fn equal(self, other: Self) -> Self::Mask;

    /// `self = 0`, lane by lane; of a dual number all parts.
    #[inline]
    fn vanishes(self) -> Self::Mask {
        self.equal(Self::zero())
    }

    /// The relative rounding error of an operation: the distance from 1 to the next larger number.
    const ROUNDING: f64 = f64::EPSILON;

    /// `⌊log₂ |self|⌋`, of a subnormal number that of the smallest normal one; anything where it is zero, infinite or
    /// NaN.
    ///
    /// What is scaled by powers of two asks for it, of numbers that are compared as a whole.
    fn exponent(self) -> i32 {
        let size = Self::blend(self.less(Self::zero()), -self, self);
        let power = |exponent: i32| Self::from_f64(f64::from_bits(((1023 + exponent) as u64) << 52));
        let (mut least, mut beyond) = (-1022_i32, 1024_i32);
        while beyond - least > 1 {
            let middle = (least + beyond).div_euclid(2);
            if size.less(power(middle)).all() { beyond = middle } else { least = middle }
        }
        least
    }

    /// What [`constrained_solve_many`](crate::constrained_solve_many) calls: accelerations and multipliers, column by
    /// column, with what tells rounding from a contradiction.
    ///
    /// The basis of motions is chosen by comparisons; numbers of several lanes are solved lane by lane, so that each
    /// chooses by itself.
    fn constrained_solve<const N: usize, const K: usize, const C: usize>(
        m: &[[Self; N]; N],
        a: &[[Self; N]; K],
        force: &[[Self; C]; N],
        target: &[[Self; C]; K],
        terms: &Terms<'_, Self, N, K, C>,
    ) -> ([[Self; C]; N], [[Self; C]; K]) {
        crate::dynamics::solve_constrained(m, a, force, target, terms)
    }

    /// What [`sparse_solve`](crate::sparse_solve) calls: the unknowns in the order of elimination, accelerations and
    /// multipliers with the sign changed; `sizes` are those of the terms that the right side is the sum of.
    fn sparse_solve<const N: usize, const U: usize, const E: usize, const L: usize>(
        elimination: &Elimination<U, E, L>,
        factors: &Factors<Self, U, L>,
        right_side: &[Self; U],
        sizes: &[Self; U],
    ) -> [Self; U] {
        factors.refined::<N, E>(elimination, right_side, sizes)
    }

    /// `then` in the lanes where `mask` is true, `otherwise` in the others.
    ///
    /// A NaN or an infinity in a lane that is not chosen leaves no trace.
    fn blend(mask: Self::Mask, then: Self, otherwise: Self) -> Self;

    /// The larger of the two, and NaN where one of them is NaN (`f64::max` would drop it).
    #[inline]
    fn maximum(self, other: Self) -> Self {
        Self::blend(other.less(self) | !self.equal(self), self, other)
    }

    /// `then()` where `mask` is true, `otherwise()` elsewhere; a side that no lane takes is not evaluated.
    #[inline]
    fn select(mask: Self::Mask, then: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        if mask.all() {
            then()
        } else if mask.any() {
            Self::blend(mask, then(), otherwise())
        } else {
            otherwise()
        }
    }

    /// [`select`](Scalar::select) of several values with one mask.
    #[inline]
    fn select_each<const N: usize>(
        mask: Self::Mask,
        then: impl FnOnce() -> [Self; N],
        otherwise: impl FnOnce() -> [Self; N],
    ) -> [Self; N] {
        if mask.all() {
            then()
        } else if mask.any() {
            let (then, otherwise) = (then(), otherwise());
            core::array::from_fn(|i| Self::blend(mask, then[i], otherwise[i]))
        } else {
            otherwise()
        }
    }
}

/// The result of comparing two [`Scalar`]s: a truth value per lane. `&`, `|` and `!` work lane by lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// True where all lanes are.
    fn all(self) -> bool;
    /// True where one lane at least is.
    fn any(self) -> bool;
}

impl Mask for bool {
    #[inline]
    fn all(self) -> bool {
        self
    }

    #[inline]
    fn any(self) -> bool {
        self
    }
}

/// A [`Scalar`] that is one real number: `f32` or `f64`. Error control compares and reports such numbers.
pub trait Real: Scalar<Mask = bool> + PartialOrd {
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;

    /// The same number as `f64`.
    fn to_f64(self) -> f64;

    /// True for NaN alone.
    #[inline]
    fn is_nan(self) -> bool {
        self.partial_cmp(&self).is_none()
    }
}

/// The Euclidean length, whatever the size of the entries.
#[cfg(any(feature = "std", feature = "libm"))]
pub(crate) fn length(entries: impl Iterator<Item = f64> + Clone) -> f64 {
    let greatest = entries.clone().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    if greatest > 0.0 && greatest.is_finite() {
        greatest * Scalar::sqrt(entries.map(|entry| (entry / greatest) * (entry / greatest)).sum::<f64>())
    } else {
        // Zero; infinity; or NaN, which `max` drops.
        entries.map(|entry| entry.abs()).sum()
    }
}
