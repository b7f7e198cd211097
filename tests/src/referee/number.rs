//! What the referee calculates with: numbers of twice the digits, doubles whose rounding is made worse on purpose, and dual
//! numbers over either, nested as deep as derivatives are wanted.

use std::cell::Cell;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use twofloat::TwoFloat;

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
    fn of(value: f64) -> Self;
    /// A constant of the text.
    fn exact(value: TwoFloat) -> Self;
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
    /// −1, 0 or 1.
    fn signum(self) -> Self {
        let zero = Self::zero();
        Self::of(f64::from(i8::from(zero.less(self)) - i8::from(self.less(zero))))
    }
    fn abs(self) -> Self {
        self * self.signum()
    }
    /// An integer power, by multiplying so often.
    fn powi(self, n: i64) -> Self {
        let power = (0..n.unsigned_abs()).fold(Self::of(1.0), |power, _| power * self);
        if n < 0 { Self::of(1.0) / power } else { power }
    }
    /// Any power of a positive number.
    fn powf(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
}

fn twice(hi: f64, lo: f64) -> TwoFloat {
    TwoFloat::new_add(hi, lo)
}

/// π/2 and ln 2 to 33 digits.
const HALF_PI: (f64, f64) = (std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17);
const LN_2: (f64, f64) = (std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// π/180
pub(super) fn degree() -> TwoFloat {
    twice(HALF_PI.0, HALF_PI.1) / 90.0
}

/// π
pub(super) fn pi() -> TwoFloat {
    twice(HALF_PI.0, HALF_PI.1) * 2.0
}

/// A decimal as it is written.
pub(super) fn decimal(text: &str) -> Option<TwoFloat> {
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let exponent = exponent.parse::<i32>().ok()? - part.len() as i32;
    let digit = |value: TwoFloat, c: char| Some(value * 10.0 + f64::from(c.to_digit(10)?));
    let value = whole.chars().chain(part.chars()).try_fold(TwoFloat::from(0.0), digit)?;
    let scale = (0..exponent.unsigned_abs()).fold(TwoFloat::from(1.0), |scale, _| scale * 10.0);
    Some(if exponent < 0 { value / scale } else { value * scale })
}

/// Σ xᵏ/k! over k = first, first + step, … with signs that alternate where they are asked to.
fn series(x: TwoFloat, first: u32, step: u32, alternate: bool) -> TwoFloat {
    let mut term = (1..=first).fold(TwoFloat::from(1.0), |term, k| term * x / f64::from(k));
    let (mut sum, mut k) = (term, first);
    for _ in 0..30 {
        term = (k + 1..=k + step).fold(term, |term, k| term * x / f64::from(k));
        term = if alternate { -term } else { term };
        sum += term;
        k += step;
        if term.hi().abs() <= 1e-35 * sum.hi().abs() {
            break;
        }
    }
    sum
}

/// sin x and cos x: Taylor's series within ±π/4. Those of `twofloat` have 20 digits only.
fn sine_and_cosine(x: TwoFloat) -> (TwoFloat, TwoFloat) {
    let half_pi = twice(HALF_PI.0, HALF_PI.1);
    let turns = (x.hi() / half_pi.hi()).round();
    if !turns.is_finite() {
        return (TwoFloat::from(f64::NAN), TwoFloat::from(f64::NAN));
    }
    let rest = x - half_pi * turns;
    let (sin, cos) = (series(rest, 1, 2, true), series(rest, 0, 2, true));
    match turns.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

fn exponential(x: TwoFloat) -> TwoFloat {
    let ln_2 = twice(LN_2.0, LN_2.1);
    let doublings = (x.hi() / ln_2.hi()).round();
    match doublings {
        d if d < -1000.0 => return TwoFloat::from(0.0),
        d if d > 1000.0 || d.is_nan() => return TwoFloat::from(f64::NAN),
        _ => {}
    }
    series(x - ln_2 * doublings, 0, 1, false) * 2.0_f64.powi(doublings as i32)
}

impl Real for TwoFloat {
    fn of(value: f64) -> Self {
        TwoFloat::from(value)
    }
    fn exact(value: TwoFloat) -> Self {
        value
    }
    fn value(self) -> f64 {
        self.hi() + self.lo()
    }
    fn is_zero(self) -> bool {
        self.hi() == 0.0
    }
    fn less(self, other: Self) -> bool {
        self < other
    }
    fn less_equal(self, other: Self) -> bool {
        self <= other
    }
    fn sqrt(self) -> Self {
        TwoFloat::sqrt(self)
    }
    fn sin(self) -> Self {
        sine_and_cosine(self).0
    }
    fn cos(self) -> Self {
        sine_and_cosine(self).1
    }
    fn tan(self) -> Self {
        let (sin, cos) = sine_and_cosine(self);
        sin / cos
    }
    fn asin(self) -> Self {
        Real::atan2(self, Real::sqrt((Self::of(1.0) - self) * (Self::of(1.0) + self)))
    }
    fn acos(self) -> Self {
        Real::atan2(Real::sqrt((Self::of(1.0) - self) * (Self::of(1.0) + self)), self)
    }
    fn atan(self) -> Self {
        Real::atan2(self, Self::of(1.0))
    }
    fn sinh(self) -> Self {
        if self.hi().abs() < 0.5 {
            return series(self, 1, 2, false);
        }
        (exponential(self) - exponential(-self)) / 2.0
    }
    fn cosh(self) -> Self {
        (exponential(self) + exponential(-self)) / 2.0
    }
    fn tanh(self) -> Self {
        if self.hi().abs() > 100.0 {
            return Real::signum(self);
        }
        Real::sinh(self) / Real::cosh(self)
    }
    fn exp(self) -> Self {
        exponential(self)
    }
    /// Newton's method on the exponential, from the double.
    fn ln(self) -> Self {
        let start = Self::of(self.hi().ln());
        (0..2).fold(start, |y, _| y + self * exponential(-y) - 1.0)
    }
    /// Newton's method on the sine of what is missing, from the double.
    fn atan2(self, x: Self) -> Self {
        let start = Self::of(self.hi().atan2(x.hi()));
        let length = Real::sqrt(self * self + x * x);
        if length.hi() == 0.0 {
            return start;
        }
        (0..2).fold(start, |angle, _| {
            let (sin, cos) = sine_and_cosine(angle);
            angle + (self * cos - x * sin) / length
        })
    }
}

thread_local! {
    static NOISE: Cell<u64> = const { Cell::new(1) };
}

/// Starts the stream of roundings of [`Noisy`] anew: the same in every run.
pub(super) fn reseed(seed: u64) {
    NOISE.set(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
}

/// A double whose every result is off by up to one unit of the last place, at random: what rounding may do to a calculation is
/// seen from a few of them (Monte Carlo arithmetic: Parker, *Monte Carlo arithmetic: exploiting randomness in floating-point
/// arithmetic*, UCLA CSD-970002, 1997).
#[derive(Clone, Copy, Debug)]
pub(super) struct Noisy(f64);

impl Noisy {
    /// `value`, off by up to one unit of the last place.
    pub(super) fn rounded(value: f64) -> Self {
        // xorshift64 (Marsaglia, *Xorshift RNGs*, 2003).
        let mut x = NOISE.get();
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        NOISE.set(x);
        Noisy(value + value * (((x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * f64::EPSILON))
    }
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
    fn of(value: f64) -> Self {
        Noisy(value)
    }
    fn exact(value: TwoFloat) -> Self {
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
    /// f of it, whose value and derivative these are. Where the derivative does not exist it is NaN even for what stays.
    fn chain(self, value: S, slope: S) -> Self {
        Dual::new(value, slope * self.eps)
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
    fn of(value: f64) -> Self {
        Dual::fixed(S::of(value))
    }
    fn exact(value: TwoFloat) -> Self {
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
        let one = S::of(1.0);
        self.chain(self.re.asin(), one / ((one - self.re) * (one + self.re)).sqrt())
    }
    fn acos(self) -> Self {
        let one = S::of(1.0);
        self.chain(self.re.acos(), -(one / ((one - self.re) * (one + self.re)).sqrt()))
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
        // 1 − tanh² loses its digits where tanh is nearly 1.
        let (tanh, cosh) = (self.re.tanh(), self.re.cosh());
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

    /// Identities that hold to all digits; the same functions of a double hold them to sixteen.
    #[test]
    fn functions_have_thirty_digits() {
        for k in 0..200 {
            let x = TwoFloat::from(-6.0 + 0.061 * f64::from(k)) / 3.0;
            let near = |what: &str, one: TwoFloat, other: TwoFloat| {
                let error = ((one - other) / (TwoFloat::from(1.0) + Real::abs(other))).value().abs();
                assert!(error < 1e-29, "{what} of {x:?}: {error:e}");
            };
            let (sin, cos) = (Real::sin(x), Real::cos(x));
            near("sine and cosine", sin * sin + cos * cos, TwoFloat::from(1.0));
            near("twice the angle", Real::sin(x * 2.0), sin * cos * 2.0);
            near("arc", Real::atan2(sin, cos), x);
            near("logarithm", Real::ln(Real::exp(x)), x);
            near("hyperbolic", Real::cosh(x) + Real::sinh(x), Real::exp(x));
            near("sine of the arc", Real::sin(Real::asin(Real::tanh(x))), Real::tanh(x));
            near("root", Real::sqrt(x * x), Real::abs(x));
        }
    }

    #[test]
    fn duals_differentiate() {
        let pair = |re: f64, eps: f64| Dual::new(TwoFloat::of(re), TwoFloat::of(eps));
        let x = Dual::new(pair(0.3, 1.0), pair(1.0, 0.0));
        // d²/dx² (x³ sin x) = 6 x sin x + 6 x² cos x − x³ sin x
        let found = (x.powi(3) * x.sin()).eps.eps.value();
        let expected = 6.0 * 0.3 * 0.3_f64.sin() + 6.0 * 0.09 * 0.3_f64.cos() - 0.027 * 0.3_f64.sin();
        assert!((found - expected).abs() < 1e-15, "{found} is not {expected}");
    }
}
