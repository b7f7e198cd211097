//! Numbers of twice the digits of a double, and the functions of the language in them.
//!
//! # Source
//! Joldes, Muller, Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*, ACM
//! Transactions on Mathematical Software 44(2), 2017: algorithms 6, 9, 12 and 17.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::number::Real;

/// The unevaluated sum of two doubles, of which the second is less than half a unit of the last place of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide {
    hi: f64,
    lo: f64,
}

impl Wide {
    /// The nearest double, nearly.
    pub(super) fn hi(self) -> f64 {
        self.hi
    }
    /// What it is off by.
    pub(super) fn lo(self) -> f64 {
        self.lo
    }
    /// The number with these parts.
    pub(super) fn of_parts(hi: f64, lo: f64) -> Self {
        Wide { hi, lo }
    }
}

impl From<f64> for Wide {
    fn from(value: f64) -> Self {
        Wide { hi: value, lo: 0.0 }
    }
}

/// `a + b` of doubles, exactly (Møller and Knuth).
fn twice(a: f64, b: f64) -> Wide {
    let hi = a + b;
    let rest = hi - a;
    Wide { hi, lo: (a - (hi - rest)) + (b - rest) }
}

/// `a + b` of doubles, exactly, where a is the larger (Dekker).
fn quick(a: f64, b: f64) -> Wide {
    let hi = a + b;
    Wide { hi, lo: b - (hi - a) }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (sum, rest) = (twice(self.hi, other.hi), twice(self.lo, other.lo));
        let sum = quick(sum.hi, sum.lo + rest.hi);
        quick(sum.hi, sum.lo + rest.lo)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Wide { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul<f64> for Wide {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        let hi = self.hi * other;
        quick(hi, self.lo.mul_add(other, self.hi.mul_add(other, -hi)))
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let hi = self.hi * other.hi;
        let rest = self.hi.mul_add(other.hi, -hi);
        quick(hi, rest + self.lo.mul_add(other.hi, self.hi.mul_add(other.lo, self.lo * other.lo)))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let product = other * first;
        quick(first, ((self.hi - product.hi) + (self.lo - product.lo)) / other.hi)
    }
}

/// Operators with a double behind them.
macro_rules! with_doubles {
    ($($operator:ident $name:ident),*) => {$(
        impl $operator<f64> for Wide {
            type Output = Self;
            fn $name(self, other: f64) -> Self {
                $operator::$name(self, Wide::from(other))
            }
        }
    )*};
}
with_doubles!(Add add, Sub sub, Div div);

/// Two values of each function at each place.
type Values = HashMap<(u8, [u64; 4]), [Wide; 2]>;

thread_local! {
    static KNOWN: RefCell<Values> = RefCell::default();
}

/// A function of two numbers, which is asked for at the same place in every direction that is differentiated in.
fn remembered(function: u8, x: Wide, y: Wide, value: impl FnOnce() -> [Wide; 2]) -> [Wide; 2] {
    let key = (function, [x.hi, x.lo, y.hi, y.lo].map(f64::to_bits));
    if let Some(known) = KNOWN.with_borrow(|known| known.get(&key).copied()) {
        return known;
    }
    let value = value();
    KNOWN.with_borrow_mut(|known| {
        if known.len() > 10_000 {
            known.clear();
        }
        known.insert(key, value);
    });
    value
}

/// π/2 and ln 2 to 33 digits.
const HALF_PI: (f64, f64) = (std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17);
const LN_2: (f64, f64) = (std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// π/180
pub(super) fn degree() -> Wide {
    twice(HALF_PI.0, HALF_PI.1) / 90.0
}

/// π
pub(super) fn pi() -> Wide {
    twice(HALF_PI.0, HALF_PI.1) * 2.0
}

/// A decimal as it is written.
pub(super) fn decimal(text: &str) -> Option<Wide> {
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let exponent = exponent.parse::<i32>().ok()? - part.len() as i32;
    let digit = |value: Wide, c: char| Some(value * 10.0 + f64::from(c.to_digit(10)?));
    let value = whole.chars().chain(part.chars()).try_fold(Wide::from(0.0), digit)?;
    let scale = (0..exponent.unsigned_abs()).fold(Wide::from(1.0), |scale, _| scale * 10.0);
    Some(if exponent < 0 { value / scale } else { value * scale })
}

/// Σ xᵏ/k! over k = first, first + step, … with signs that alternate where they are asked to.
fn series(x: Wide, first: u32, step: u32, alternate: bool) -> Wide {
    let mut term = (1..=first).fold(Wide::from(1.0), |term, k| term * x / f64::from(k));
    let (mut sum, mut k) = (term, first);
    for _ in 0..30 {
        term = (k + 1..=k + step).fold(term, |term, k| term * x / f64::from(k));
        term = if alternate { -term } else { term };
        sum = sum + term;
        k += step;
        if term.hi().abs() <= 1e-35 * sum.hi().abs() {
            break;
        }
    }
    sum
}

/// sin x and cos x: Taylor's series within ±π/4.
fn sine_and_cosine(x: Wide) -> [Wide; 2] {
    remembered(0, x, Wide::from(0.0), || reduced_sine_and_cosine(x))
}

fn reduced_sine_and_cosine(x: Wide) -> [Wide; 2] {
    let half_pi = twice(HALF_PI.0, HALF_PI.1);
    let turns = (x.hi() / half_pi.hi()).round();
    if !turns.is_finite() {
        return [Wide::from(f64::NAN); 2];
    }
    let rest = x - half_pi * turns;
    let (sin, cos) = (series(rest, 1, 2, true), series(rest, 0, 2, true));
    match turns.rem_euclid(4.0) as u8 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

fn exponential(x: Wide) -> Wide {
    remembered(1, x, Wide::from(0.0), || [reduced_exponential(x); 2])[0]
}

fn reduced_exponential(x: Wide) -> Wide {
    let ln_2 = twice(LN_2.0, LN_2.1);
    let doublings = (x.hi() / ln_2.hi()).round();
    match doublings {
        d if d < -1000.0 => return Wide::from(0.0),
        d if d > 1000.0 || d.is_nan() => return Wide::from(f64::NAN),
        _ => {}
    }
    series(x - ln_2 * doublings, 0, 1, false) * 2.0_f64.powi(doublings as i32)
}

impl Real for Wide {
    fn of(value: f64) -> Self {
        Wide::from(value)
    }
    fn exact(value: Wide) -> Self {
        value
    }
    fn value(self) -> f64 {
        self.hi + self.lo()
    }
    fn is_zero(self) -> bool {
        self.hi == 0.0
    }
    fn less(self, other: Self) -> bool {
        self.hi < other.hi || self.hi == other.hi && self.lo < other.lo
    }
    fn less_equal(self, other: Self) -> bool {
        self.hi < other.hi || self.hi == other.hi && self.lo <= other.lo
    }
    fn sqrt(self) -> Self {
        let first = self.hi.sqrt();
        if first == 0.0 {
            return Self::of(0.0);
        }
        // Newton's method, once.
        let square = Self::of(first) * Self::of(first);
        let rest = self - square;
        quick(first, rest.hi / (2.0 * first))
    }
    fn sin(self) -> Self {
        sine_and_cosine(self)[0]
    }
    fn cos(self) -> Self {
        sine_and_cosine(self)[1]
    }
    fn tan(self) -> Self {
        let [sin, cos] = sine_and_cosine(self);
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
        if self.hi.abs() < 0.5 {
            return series(self, 1, 2, false);
        }
        (exponential(self) - exponential(-self)) / 2.0
    }
    fn cosh(self) -> Self {
        (exponential(self) + exponential(-self)) / 2.0
    }
    fn tanh(self) -> Self {
        if self.hi.abs() > 100.0 {
            return Real::signum(self);
        }
        Real::sinh(self) / Real::cosh(self)
    }
    fn exp(self) -> Self {
        exponential(self)
    }
    /// Newton's method on the exponential, from the double.
    fn ln(self) -> Self {
        let newton = |y: Self, _| y + self * reduced_exponential(-y) - 1.0;
        remembered(2, self, Self::of(0.0), || [(0..2).fold(Self::of(self.hi.ln()), newton); 2])[0]
    }
    /// Newton's method on the sine of what is missing, from the double.
    fn atan2(self, x: Self) -> Self {
        let start = Self::of(self.hi.atan2(x.hi()));
        let length = Real::sqrt(self * self + x * x);
        if length.hi() == 0.0 {
            return start;
        }
        let newton = |angle: Self, _| {
            let [sin, cos] = reduced_sine_and_cosine(angle);
            angle + (self * cos - x * sin) / length
        };
        remembered(3, self, x, || [(0..2).fold(start, newton); 2])[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Identities that hold to all digits; the same functions of a double hold them to sixteen.
    #[test]
    fn functions_have_thirty_digits() {
        for k in 0..200 {
            let x = Wide::from(-6.0 + 0.061 * f64::from(k)) / 3.0;
            let near = |what: &str, one: Wide, other: Wide| {
                let error = ((one - other) / (Wide::from(1.0) + Real::abs(other))).value().abs();
                assert!(error < 1e-29, "{what} of {x:?}: {error:e}");
            };
            let (sin, cos) = (Real::sin(x), Real::cos(x));
            near("sine and cosine", sin * sin + cos * cos, Wide::from(1.0));
            near("twice the angle", Real::sin(x * 2.0), sin * cos * 2.0);
            near("arc", Real::atan2(sin, cos), x);
            near("logarithm", Real::ln(Real::exp(x)), x);
            near("hyperbolic", Real::cosh(x) + Real::sinh(x), Real::exp(x));
            near("sine of the arc", Real::sin(Real::asin(Real::tanh(x))), Real::tanh(x));
            near("root", Real::sqrt(x * x), Real::abs(x));
            near("quotient", x / (x + 3.0) * (x + 3.0), x);
        }
    }
}
