//! Numbers of a finite field, in which whether two expressions are equal is decided without rounding.
//!
//! Two rational functions of degree d that differ agree at a random point of a field of p elements with probability d/p
//! at most (Schwartz, *Fast probabilistic algorithms for verification of polynomial identities*, Journal of the ACM
//! 27:4, 1980). What is not rational is given values that obey the laws by which energies are simplified:
//!
//! - a sine with its cosine is a point of the unit circle. Its points over F_p are a cyclic group of order
//!   `p + 1 = 720 N`, N prime: angles are added as its exponents are. A multiple of π is read as one of half degrees,
//!   everything else modulo N, where sums, products and quotients of angles are formed as of the numbers themselves. So
//!   `sin(a + b)`, `sin 2a` and `cos 30° = √3/2` have the values that they should;
//! - of the two roots of a square one is itself a square, since `p ≡ 3 (mod 4)`, and that one is `√x`: roots are
//!   multiplicative, `√x · √x = x`, and `√(x²)` is x at half of the points and −x at the others, as |x| is;
//! - exponentials are powers of a number of prime order `(p − 1)/2`, modulo which exponents are formed as angles are:
//!   `exp(a + b)` is `exp(a) exp(b)`. An exponent with roots or functions in it is equal to another where its value is,
//!   and `exp(−x) = 1/exp(x)`. Hyperbolic functions are made of exponentials;
//! - every other function is opaque: equal where its arguments are, odd where it is odd, `atan2(y, x)` in y where that
//!   is not zero throughout. So are roots and functions inside angles;
//! - which of two different numbers is the smaller one is decided by a coin, and the other way round for the negatives
//!   of both.
//!
//! An identity that rests on no more than these laws holds at every point. One that needs others, `ln(exp(x)) = x` for
//! instance, seems not to hold.
//!
//! There are two such fields. An integer that is a multiple of p has no value in one of them, since it would be zero; a
//! sum that comes out as one, `2^61 x − 5102193 x`, is zero in one and not in the other. So whatever is decided is
//! decided in both.

use super::element::Element;
use super::evaluate::Value;
use super::field::{BASE, Prime, inverse, mixed, negative_of, product, sum};
use super::function::{Binary, Function};
use super::number::Number;
use super::ratio::Ratio;
use super::spline::Spline;

/// A number of the field, or the mark of what has no value there: 1/0, the root of what is no square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Residue<const K: usize> {
    /// Below p, or [`UNDEFINED`].
    value: u64,
    /// The same number modulo n but for `half_turns`, as an exponent of a point of the circle.
    angle: u64,
    /// The same number modulo h, as an exponent, where it is made of numbers and symbols alone.
    exponent: Option<u64>,
    /// What it holds of π.
    half_turns: Ratio,
    /// What it is, where it is a rational number whatever the point.
    rational: Option<Ratio>,
}

const UNDEFINED: u64 = u64::MAX;

/// The value that stands for π.
const PI: u64 = mixed(0x7069);

impl<const K: usize> Residue<K> {
    const P: u64 = Prime::<K>::P;
    const N: u64 = Prime::<K>::N;
    const H: u64 = Prime::<K>::H;

    const fn plain(value: u64, angle: u64, exponent: Option<u64>) -> Self {
        Residue { value, angle, exponent, half_turns: Ratio::ZERO, rational: None }
    }

    /// A number with no relation to others, the same for the same key.
    pub(crate) fn random(key: u64) -> Self {
        let [value, angle, exponent] = [mixed(key), mixed(mixed(key)), mixed(mixed(key) ^ 0x6578)];
        Self::plain(value % Self::P, angle % Self::N, Some(exponent % Self::H))
    }

    fn pi() -> Self {
        Self::plain(PI % Self::P, mixed(PI) % Self::N, Some(mixed(PI ^ 0x6578) % Self::H))
    }

    /// Whether it has a value.
    pub(crate) fn is_defined(self) -> bool {
        self.value != UNDEFINED
    }

    /// Whether it is zero.
    pub(crate) fn is_zero(self) -> bool {
        self.value == 0
    }

    /// A number that is not zero, and a multiple of one of the moduli, has no value.
    fn without_chance(self) -> Self {
        let vanishes = self.value == 0 || self.angle == 0 || self.exponent == Some(0);
        if vanishes && self.rational.is_some_and(|ratio| ratio != Ratio::ZERO) { Self::NOT_DEFINED } else { self }
    }

    /// A value of which nothing else is known; odd.
    fn opaque(value: u64) -> Self {
        let (size, negative) = Prime::<K>::sign(value);
        let angle = mixed(size ^ 0x616e_676c) % Self::N;
        Self::plain(value, if negative { negative_of(angle, Self::N) } else { angle }, None)
    }

    /// The number modulo n, with the part that is a multiple of π.
    fn whole_angle(self) -> u64 {
        let turns = Self::rational(self.half_turns).angle;
        sum(self.angle, product(turns, Self::pi().angle, Self::N), Self::N)
    }

    fn times_ratio(self, ratio: Ratio) -> Option<Ratio> {
        self.half_turns.times(ratio)
    }

    /// Cosine and sine.
    fn on_circle(self) -> (u64, u64) {
        let half_degrees = self.half_turns.times(Ratio { numerator: 360, denominator: 1 });
        match half_degrees.and_then(Ratio::integer) {
            Some(count) => {
                let part = Prime::<K>::power_of(Prime::<K>::HALF_DEGREE, count.rem_euclid(720) as u64);
                Prime::<K>::multiplied(Prime::<K>::power_of(Prime::<K>::CIRCLE, self.angle), part)
            }
            None => Prime::<K>::power_of(Prime::<K>::CIRCLE, self.whole_angle()),
        }
    }

    fn exponential(self) -> u64 {
        if let Some(exponent) = self.exponent {
            return Prime::<K>::raised(BASE, exponent);
        }
        let (size, negative) = Prime::<K>::sign(self.value);
        let value = if size == 0 { 1 } else { mixed(size ^ 0x6578_7000) % (Self::P - 1) + 1 };
        if negative { Prime::<K>::inverted(value) } else { value }
    }

    /// `atan2(0, self)`: 0 or π, by a sign that only numbers have in a field.
    fn on_axis(self) -> Self {
        match self.rational {
            Some(ratio) if ratio.numerator < 0 => Self::number(Number::PI),
            Some(_) => Self::rational(Ratio::ZERO),
            None => Self::opaque(Prime::<K>::any(0x6178_6973, self.value)),
        }
    }

    fn size(self) -> Self {
        match self.rational {
            Some(ratio) => Self::rational(Ratio { numerator: ratio.numerator.abs(), ..ratio }),
            None => self.mul(self).root(),
        }
    }
}

impl<const K: usize> Element for Residue<K> {
    const NOT_DEFINED: Self = Self::plain(UNDEFINED, 0, None);

    fn rational(ratio: Ratio) -> Self {
        let Ratio { numerator, denominator } = ratio;
        let of = |modulus: u64| {
            let [a, b] = [numerator, denominator].map(|n| i128::from(n).rem_euclid(i128::from(modulus)) as u64);
            if b == 1 { a } else { product(a, inverse(b, modulus), modulus) }
        };
        Residue { rational: Some(ratio), ..Self::plain(of(Self::P), of(Self::N), Some(of(Self::H))) }.without_chance()
    }

    fn long(n: i128) -> Self {
        let of = |modulus: u64| n.rem_euclid(i128::from(modulus)) as u64;
        let number = Self::plain(of(Self::P), of(Self::N), Some(of(Self::H)));
        let vanishes = number.value == 0 || number.angle == 0 || number.exponent == Some(0);
        if vanishes && n != 0 { Self::NOT_DEFINED } else { number }
    }

    fn root(self) -> Self {
        if let Some(root) = self.rational.and_then(Ratio::root) {
            return Self::rational(root);
        }
        Prime::<K>::root(self.value).map_or(Self::NOT_DEFINED, Self::opaque)
    }
}

impl<const K: usize> Value for Residue<K> {
    fn constant(value: f64) -> Self {
        Self::of_double(value)
    }

    fn number(number: Number) -> Self {
        match number {
            Number::Exact { numerator, denominator, pi } => {
                let short = |n: i128| i64::try_from(n).ok();
                let ratio = short(numerator).zip(short(denominator));
                let ratio = ratio.map(|(numerator, denominator)| Ratio { numerator, denominator });
                match (ratio, pi) {
                    (Some(ratio), 0) => Self::rational(ratio),
                    (Some(ratio), 1) => {
                        Residue { angle: 0, half_turns: ratio, rational: None, ..Self::rational(ratio).mul(Self::pi()) }
                    }
                    _ => Self::long(numerator).div(Self::long(denominator)).mul(Self::pi().power(2 * i32::from(pi))),
                }
            }
            Number::Real { value, .. } => Self::dyadic(value),
        }
    }

    fn neg(self) -> Self {
        if !self.is_defined() {
            return self;
        }
        Residue {
            value: negative_of(self.value, Self::P),
            angle: negative_of(self.angle, Self::N),
            exponent: self.exponent.map(|exponent| negative_of(exponent, Self::H)),
            half_turns: self.half_turns.negative(),
            rational: self.rational.map(Ratio::negative),
        }
    }

    fn add(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        let (a, b, half_turns) = match self.half_turns.plus(other.half_turns) {
            Some(sum) => (self.angle, other.angle, sum),
            None => (self.whole_angle(), other.whole_angle(), Ratio::ZERO),
        };
        let exponents = self.exponent.zip(other.exponent);
        let sum = Residue {
            value: sum(self.value, other.value, Self::P),
            angle: sum(a, b, Self::N),
            exponent: exponents.map(|(a, b)| sum(a, b, Self::H)),
            half_turns,
            rational: self.rational.zip(other.rational).and_then(|(a, b)| a.plus(b)),
        };
        sum.without_chance()
    }

    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    fn mul(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        let value = Prime::<K>::times(self.value, other.value);
        let exponent = self.exponent.zip(other.exponent).map(|(a, b)| product(a, b, Self::H));
        let without = |angle| Self::plain(value, angle, exponent);
        if self.half_turns == Ratio::ZERO && other.half_turns == Ratio::ZERO {
            let rational = self.rational.zip(other.rational).and_then(|(a, b)| a.times(b));
            return Residue { rational, ..without(product(self.angle, other.angle, Self::N)) }.without_chance();
        }
        // A rational number has no part that is a multiple of π.
        let scaled = match (self.rational, other.rational) {
            (Some(ratio), _) => other.times_ratio(ratio),
            (_, Some(ratio)) => self.times_ratio(ratio),
            _ => None,
        };
        match scaled {
            Some(half_turns) => Residue { half_turns, ..without(product(self.angle, other.angle, Self::N)) },
            None => without(product(self.whole_angle(), other.whole_angle(), Self::N)),
        }
    }

    fn div(self, other: Self) -> Self {
        if !other.is_defined() || other.is_zero() {
            return Self::NOT_DEFINED;
        }
        let reciprocal = match other.rational.and_then(Ratio::reciprocal) {
            Some(ratio) => Self::rational(ratio),
            None => {
                let exponent = other.exponent.map(|exponent| inverse(exponent, Self::H));
                Self::plain(Prime::<K>::inverted(other.value), inverse(other.whole_angle(), Self::N), exponent)
            }
        };
        self.mul(reciprocal)
    }

    fn power(self, halves: i32) -> Self {
        if self.is_defined() { self.to_half_power(halves) } else { self }
    }

    fn call(self, function: Function) -> Self {
        if !self.is_defined() {
            return self;
        }
        let (one, two) = (Self::rational(Ratio::ONE), Self::rational(Ratio::TWO));
        let e = || Self::opaque(self.exponential());
        let growing = || e().add(one.div(e())).div(two);
        let odd = || e().sub(one.div(e())).div(two);
        match function {
            Function::Cos => Self::opaque(self.on_circle().0),
            Function::Sin => Self::opaque(self.on_circle().1),
            Function::Tan => self.call(Function::Sin).div(self.call(Function::Cos)),
            Function::Asin | Function::Atan => Self::opaque(Prime::<K>::odd(function as u64, self.value)),
            Function::Acos => Self::number(Number::PI).div(two).sub(self.call(Function::Asin)),
            Function::Sinh => odd(),
            Function::Cosh => growing(),
            Function::Tanh => odd().div(growing()),
            Function::Sech => one.div(growing()),
            Function::Exp => e(),
            Function::Ln if self.value == 1 => Self::rational(Ratio::ZERO),
            Function::Ln => Self::opaque(mixed(self.value ^ 0x6c6e_0000) % Self::P),
            Function::Abs => self.size(),
            Function::Signum if self.is_zero() => self,
            Function::Signum => self.div(self.size()),
        }
    }

    fn call2(self, function: Binary, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        match function {
            Binary::Atan2 if self.is_zero() => other.on_axis(),
            Binary::Atan2 => Self::opaque(Prime::<K>::odd(mixed(other.value), self.value)),
            Binary::Powf => match other.rational.and_then(|n| n.times(Ratio::TWO)).and_then(Ratio::integer) {
                Some(halves @ -1000..=1000) => self.power(halves as i32),
                _ => Self::opaque(mixed(mixed(self.value) ^ other.value) % Self::P),
            },
        }
    }

    fn spline(self, spline: &Spline, order: usize) -> Self {
        if !self.is_defined() {
            return self;
        }
        if order > spline.degree() {
            Self::constant(0.0)
        } else {
            Self::opaque(Prime::<K>::any(mixed(spline.key() ^ order as u64), self.value))
        }
    }

    fn rate(self) -> Self {
        Self::NOT_DEFINED
    }

    fn less(self, other: Self) -> bool {
        if let (Some(a), Some(b)) = (self.rational, other.rational) {
            return b.plus(a.negative()).is_some_and(|difference| difference.numerator > 0);
        }
        let difference = other.sub(self);
        difference.is_defined() && !difference.is_zero() && {
            let (size, negative) = Prime::<K>::sign(difference.value);
            (mixed(size) % 2 == 1) != negative
        }
    }

    fn less_equal(self, other: Self) -> bool {
        let difference = other.sub(self);
        difference.is_defined() && (difference.is_zero() || self.less(other))
    }

    fn is_exactly_zero(self) -> bool {
        self.rational == Some(Ratio::ZERO)
    }
}

#[cfg(test)]
mod tests;
