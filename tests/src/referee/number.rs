//! What the referee calculates with, beside numbers of twice the digits: doubles whose rounding is made worse on
//! purpose, and dual numbers over either, nested as deep as derivatives are wanted.

use std::cell::Cell;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::wide::Wide;

/// Real arithmetic and the functions of the language.
pub(super) trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Whether results are rounded, and worse than need be: then derivatives are those of the manual to the letter.
    const ROUGH: bool = false;

    fn of(value: f64) -> Self;
    /// A constant of the text.
    fn exact(value: Wide) -> Self;
    /// The nearest double.
    fn value(self) -> f64;
    fn less(self, other: Self) -> bool;
    fn less_equal(self, other: Self) -> bool;
    fn sqrt(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn tan(self) -> Self;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn sinh(self) -> Self;
    fn cosh(self) -> Self;
    fn tanh(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn atan2(self, x: Self) -> Self;

    /// Whether it is 0, with all its derivatives.
    fn is_zero(self) -> bool;
    fn zero() -> Self {
        Self::of(0.0)
    }
    /// What a rounding adds to 1: nothing where it is not made worse on purpose.
    fn noise() -> f64 {
        0.0
    }
    /// Something between 0 and 1, at random: 0 where roundings are not made worse on purpose.
    fn share() -> f64 {
        0.0
    }
    /// −1, 0 or 1.
    fn signum(self) -> Self {
        let zero = Self::zero();
        Self::of(f64::from(i8::from(zero.less(self)) - i8::from(self.less(zero))))
    }
    fn abs(self) -> Self {
        self * self.signum()
    }
    /// An integer power, by repeated multiplication.
    fn powi(self, n: i64) -> Self {
        let power = (0..n.unsigned_abs()).fold(Self::of(1.0), |power, _| power * self);
        if n < 0 { Self::of(1.0) / power } else { power }
    }
    /// Any power of a positive number.
    fn powf(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
}

/// Numbers that are no dual numbers.
pub(super) trait Base: Real {
    fn wide(self) -> Wide;
}

impl Base for Wide {
    fn wide(self) -> Wide {
        self
    }
}

impl Base for Noisy {
    fn wide(self) -> Wide {
        Wide::from(self.0)
    }
}

thread_local! {
    static NOISE: Cell<u64> = const { Cell::new(1) };
}

/// Starts the stream of roundings of [`Noisy`] anew: the same in every run.
pub(super) fn reseed(seed: u64) {
    NOISE.set(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
}

/// A double whose every result is off by up to one unit of the last place, at random: what rounding may do to a
/// calculation is seen from a few of them (Monte Carlo arithmetic: Parker, *Monte Carlo arithmetic: exploiting
/// randomness in floating-point arithmetic*, UCLA CSD-970002, 1997).
#[derive(Clone, Copy, Debug)]
pub(super) struct Noisy(f64);

impl Noisy {
    /// `value`, off by up to one unit of the last place.
    pub(super) fn rounded(value: f64) -> Self {
        Noisy(value + value * ((random() - 1.0) * f64::EPSILON))
    }
}

/// Something between 0 and 2.
fn random() -> f64 {
    // xorshift64 (Marsaglia, *Xorshift RNGs*, 2003).
    let mut x = NOISE.get();
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    NOISE.set(x);
    (x >> 11) as f64 / (1_u64 << 52) as f64
}

macro_rules! noisy {
    ($($operator:ident $name:ident),*) => {$(
        impl $operator for Noisy {
            type Output = Self;
            fn $name(self, other: Self) -> Self {
                Noisy::rounded($operator::$name(self.0, other.0))
            }
        }
    )*};
}
noisy!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Noisy {
    type Output = Self;
    fn neg(self) -> Self {
        Noisy(-self.0)
    }
}

macro_rules! noisy_functions {
    ($($name:ident),*) => {$(
        fn $name(self) -> Self {
            Noisy::rounded(f64::$name(self.0))
        }
    )*};
}

impl Real for Noisy {
    const ROUGH: bool = true;

    fn of(value: f64) -> Self {
        Noisy(value)
    }
    fn exact(value: Wide) -> Self {
        if value.lo() == 0.0 { Noisy(value.hi()) } else { Noisy::rounded(value.hi()) }
    }
    fn value(self) -> f64 {
        self.0
    }
    fn is_zero(self) -> bool {
        self.0 == 0.0
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn noise() -> f64 {
        Noisy::rounded(1.0).0 - 1.0
    }
    fn share() -> f64 {
        0.5 * random()
    }
    noisy_functions!(sqrt, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, ln);
    fn atan2(self, x: Self) -> Self {
        Noisy::rounded(self.0.atan2(x.0))
    }
}

/// `re + eps ε` with `ε² = 0`: a value and its derivative in one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<S> {
    pub(super) re: S,
    pub(super) eps: S,
}

impl<S: Real> Dual<S> {
    pub(super) fn new(re: S, eps: S) -> Self {
        Dual { re, eps }
    }
    pub(super) fn fixed(re: S) -> Self {
        Dual { re, eps: S::zero() }
    }
    /// f of it, whose value and derivative these are. Where the derivative does not exist it is NaN even for what
    /// stays.
    fn chain(self, value: S, slope: S) -> Self {
        Dual::new(value, slope * self.eps)
    }
    /// `1/√(1 − x²)`
    fn slope_of_arc_sine(self) -> S {
        let (x, one) = (self.re, S::of(1.0));
        // 1 − x² loses its digits where x is nearly 1.
        let square = if S::ROUGH { one - x * x } else { (one - x) * (one + x) };
        one / square.sqrt()
    }
}

impl<S: Real> Add for Dual<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let eps = if other.eps.is_zero() { self.eps } else { self.eps + other.eps };
        Dual::new(self.re + other.re, eps)
    }
}

impl<S: Real> Sub for Dual<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Dual::new(self.re - other.re, self.eps - other.eps)
    }
}

impl<S: Real> Mul for Dual<S> {
    type Output = Self;
    /// Most numbers do not move in most directions: what is multiplied by such a derivative is left out.
    fn mul(self, other: Self) -> Self {
        let eps = match (self.eps.is_zero(), other.eps.is_zero()) {
            (true, true) => S::zero(),
            (true, false) => self.re * other.eps,
            (false, true) => self.eps * other.re,
            (false, false) => self.re * other.eps + self.eps * other.re,
        };
        Dual::new(self.re * other.re, eps)
    }
}

impl<S: Real> Div for Dual<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.re / other.re;
        Dual::new(quotient, (self.eps - quotient * other.eps) / other.re)
    }
}

impl<S: Real> Neg for Dual<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual::new(-self.re, -self.eps)
    }
}

impl<S: Real> Real for Dual<S> {
    const ROUGH: bool = S::ROUGH;

    fn of(value: f64) -> Self {
        Dual::fixed(S::of(value))
    }
    fn exact(value: Wide) -> Self {
        Dual::fixed(S::exact(value))
    }
    fn value(self) -> f64 {
        self.re.value()
    }
    fn is_zero(self) -> bool {
        self.re.is_zero() && self.eps.is_zero()
    }
    fn noise() -> f64 {
        S::noise()
    }
    fn less(self, other: Self) -> bool {
        self.re.less(other.re)
    }
    fn less_equal(self, other: Self) -> bool {
        self.re.less_equal(other.re)
    }
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, S::of(0.5) / root)
    }
    fn sin(self) -> Self {
        self.chain(self.re.sin(), self.re.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.re.cos(), -self.re.sin())
    }
    fn tan(self) -> Self {
        let tan = self.re.tan();
        self.chain(tan, S::of(1.0) + tan * tan)
    }
    fn asin(self) -> Self {
        self.chain(self.re.asin(), self.slope_of_arc_sine())
    }
    fn acos(self) -> Self {
        self.chain(self.re.acos(), -self.slope_of_arc_sine())
    }
    fn atan(self) -> Self {
        self.chain(self.re.atan(), S::of(1.0) / (S::of(1.0) + self.re * self.re))
    }
    fn sinh(self) -> Self {
        self.chain(self.re.sinh(), self.re.cosh())
    }
    fn cosh(self) -> Self {
        self.chain(self.re.cosh(), self.re.sinh())
    }
    fn tanh(self) -> Self {
        let (tanh, cosh) = (self.re.tanh(), self.re.cosh());
        if S::ROUGH {
            return self.chain(tanh, S::of(1.0) - tanh * tanh);
        }
        // 1 − tanh² loses its digits where tanh is nearly 1.
        let slope = S::of(1.0) / (cosh * cosh);
        self.chain(tanh, if cosh.value() < 1e100 { slope } else { S::zero() })
    }
    fn exp(self) -> Self {
        let exp = self.re.exp();
        self.chain(exp, exp)
    }
    fn ln(self) -> Self {
        self.chain(self.re.ln(), S::of(1.0) / self.re)
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.re * self.re + x.re * x.re;
        Dual::new(self.re.atan2(x.re), (x.re * self.eps - self.re * x.eps) / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duals_differentiate() {
        let pair = |re: f64, eps: f64| Dual::new(Wide::of(re), Wide::of(eps));
        let x = Dual::new(pair(0.3, 1.0), pair(1.0, 0.0));
        // d²/dx² (x³ sin x) = 6 x sin x + 6 x² cos x − x³ sin x
        let found = (x.powi(3) * x.sin()).eps.eps.value();
        let expected = 6.0 * 0.3 * 0.3_f64.sin() + 6.0 * 0.09 * 0.3_f64.cos() - 0.027 * 0.3_f64.sin();
        assert!((found - expected).abs() < 1e-15, "{found} is not {expected}");
    }
}
