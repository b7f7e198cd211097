//! Exact constants: rationals, and rationals times a power of π; numbers of 100 bits only where exactness ends.
//!
//! - `parts`: what sums of a rational and a part of π are as angles.

mod parts;

use std::fmt;
use std::ops::{Add, Mul, Neg};

use super::definition::{Definition, define};
use super::double_double::DoubleDouble;
use super::element::Element;
use super::evaluate::Value;
use super::function::{Binary, Function};
use super::image::{Image, Images, NO_IMAGES, UNDEFINED};
use super::rounded::Rounded;
use super::spline::Spline;

/// A constant of the graph.
///
/// `Exact` is `numerator / denominator · π^pi`, in lowest terms with a positive denominator. What cannot be held so (a
/// square root of two, an overflow) is `Real`, of about 100 bits, and 0 as soon as it may be nothing but rounding: what
/// cancels in exact numbers leaves no trace in rounded ones. What is emitted is its nearest double. A `Real` carries
/// its images in prime fields beside its digits, formed by the same operations: by them it is told from others of the
/// same double, and proved with. Equality and hashing are by bits of the doubles and by the images, so that numbers can
/// be hash-consed however they were folded.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Number {
    /// `numerator / denominator · π^pi`
    Exact {
        /// Carries the sign.
        numerator: i128,
        /// Positive.
        denominator: i128,
        /// Power of π.
        pi: i8,
    },
    /// `value + rest`
    Real {
        /// The nearest double; not zero.
        value: f64,
        /// What the constant is more than that.
        rest: f64,
        /// How far, to first order, rounding may have carried their sum from the constant that is meant, in parts of
        /// it.
        error: f32,
        /// The constant that is meant in prime fields; the greatest number where it has no value there.
        images: Images,
        /// Numerator and denominator of r, and those of s, where the constant is `r + s·π`; zeros where it is not known
        /// to be such a sum, or one of them is long.
        parts: [i32; 4],
    },
}

/// What is computed of the images of numbers, in every field.
macro_rules! in_every_field {
    ($a:ident => $image:expr) => {
        [in_every_field!(0; $a; $image), in_every_field!(1; $a; $image), in_every_field!(2; $a; $image)]
    };
    ($a:ident, $b:ident => $image:expr) => {
        [in_every_field!(0; $a $b; $image), in_every_field!(1; $a $b; $image), in_every_field!(2; $a $b; $image)]
    };
    ($k:literal; $($number:ident)*; $image:expr) => {{
        $(let $number = Image::<$k>::number($number);)*
        ($image).value()
    }};
}

impl Number {
    /// 0
    pub const ZERO: Number = Number::integer(0);
    /// 1
    pub const ONE: Number = Number::integer(1);
    /// π
    pub const PI: Number = Number::Exact { numerator: 1, denominator: 1, pi: 1 };

    /// An integer.
    pub const fn integer(value: i64) -> Number {
        Number::Exact { numerator: value as i128, denominator: 1, pi: 0 }
    }

    /// `numerator / denominator`; `None` where the denominator is zero.
    pub fn rational(numerator: i128, denominator: i128) -> Option<Number> {
        Self::exact(numerator, denominator, 0)
    }

    fn exact(numerator: i128, denominator: i128, pi: i8) -> Option<Number> {
        if denominator == 0 || numerator == i128::MIN || denominator == i128::MIN {
            return None;
        }
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()) as i128;
        let sign = if denominator < 0 { -1 } else { 1 };
        Some(Number::Exact {
            numerator: sign * numerator / divisor,
            denominator: sign * denominator / divisor,
            pi: if numerator == 0 { 0 } else { pi },
        })
    }

    /// A decimal as written (`9.81`, `1e-3`), exactly; the nearest double where digits or exponent are too many.
    /// `None` if it is not a decimal or not finite.
    pub fn parse_decimal(text: &str) -> Option<Number> {
        let nearest: f64 = text.parse().ok().filter(|x: &f64| x.is_finite())?;
        let exactly = || {
            let (mantissa, exponent) = match text.find(['e', 'E']) {
                Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
                None => (text, 0),
            };
            let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
            let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
            let exponent = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
            let scale = 10i128.checked_pow(exponent.unsigned_abs())?;
            if exponent >= 0 { Self::rational(digits.checked_mul(scale)?, 1) } else { Self::rational(digits, scale) }
        };
        Some(exactly().unwrap_or_else(|| Number::of_double(nearest)))
    }

    /// The shortest decimal that reads back as `value`, exactly; `None` if it is not finite.
    pub fn from_f64(value: f64) -> Option<Number> {
        Self::parse_decimal(&format!("{value:e}"))
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        match self {
            Number::Exact { numerator, denominator, pi: 0 } => divide_correctly_rounded(numerator, denominator),
            _ => self.to_double_double().high,
        }
    }

    /// The number to about 100 bits.
    pub(super) fn to_double_double(self) -> DoubleDouble {
        match self {
            Number::Real { value, rest, .. } => DoubleDouble { high: value, low: rest },
            Number::Exact { numerator, denominator, pi } => {
                let ratio = DoubleDouble::of_integer(numerator).div(DoubleDouble::of_integer(denominator));
                ratio.mul(DoubleDouble::PI.powi(pi.into()))
            }
        }
    }

    /// Whether it is 0.
    pub fn is_zero(self) -> bool {
        match self {
            Number::Exact { numerator, .. } => numerator == 0,
            Number::Real { value, .. } => value == 0.0,
        }
    }

    /// Whether nothing but its double is known.
    pub(crate) fn is_rounded(self) -> bool {
        matches!(self, Number::Real { images, .. } if images.contains(&UNDEFINED))
    }

    /// Whether it is 1.
    pub fn is_one(self) -> bool {
        self == Number::ONE
    }

    /// Whether it is below 0.
    pub fn is_negative(self) -> bool {
        match self {
            Number::Exact { numerator, .. } => numerator < 0,
            Number::Real { value, .. } => value < 0.0,
        }
    }

    /// `self · other`; `None` where neither is 0 and no double is as near to 0 as their product.
    pub(crate) fn times(self, other: Number) -> Option<Number> {
        let product = self * other;
        (product.is_zero() == (self.is_zero() || other.is_zero())).then_some(product)
    }

    /// `self^(halves/2)`; `None` where that is not a finite real number.
    pub fn power(self, halves: i32) -> Option<Number> {
        if self.is_zero() {
            return (halves > 0).then_some(Number::ZERO);
        }
        if halves % 2 != 0 {
            return self.sqrt()?.power(2 * halves);
        }
        let exponent = halves / 2;
        let exactly = || match self {
            Number::Exact { numerator, denominator, pi } => {
                let n = exponent.unsigned_abs();
                let (n1, n2) = (numerator.checked_pow(n)?, denominator.checked_pow(n)?);
                let pi = i32::from(pi).checked_mul(exponent)?.try_into().ok()?;
                if exponent >= 0 { Self::exact(n1, n2, pi) } else { Self::exact(n2, n1, pi) }
            }
            Number::Real { .. } => None,
        };
        let base = self;
        let rounded = || {
            let power = self.to_double_double().powi(exponent);
            // n relative errors, and one rounding a product.
            let relative = self.uncertainty() / self.to_f64().abs() + DoubleDouble::UNIT;
            let error = f64::from(exponent.unsigned_abs()) * relative * power.high.abs();
            let value = Self::computed(power, error, in_every_field!(base => base.power(halves)));
            define(value, || Definition::Power(self, halves))
        };
        let value = exactly().unwrap_or_else(rounded);
        value.to_f64().is_finite().then_some(value)
    }

    /// `self^(halves/2)`; `None` too where self is not 0 and no double is as near to 0 as that.
    pub(crate) fn kept_power(self, halves: i32) -> Option<Number> {
        self.power(halves).filter(|power| power.is_zero() == self.is_zero())
    }

    fn sqrt(self) -> Option<Number> {
        if self.is_negative() {
            return None;
        }
        let exactly = || match self {
            Number::Exact { numerator, denominator, pi: 0 } => {
                Self::exact(exact_square_root(numerator)?, exact_square_root(denominator)?, 0)
            }
            _ => None,
        };
        let square = self;
        let rounded = || {
            let root = self.to_double_double().power(1);
            let error = self.uncertainty() / (2.0 * root.high);
            define(Number::computed(root, error, in_every_field!(square => square.power(1))), || {
                Definition::Power(self, 1)
            })
        };
        Some(exactly().unwrap_or_else(rounded))
    }

    /// A double as it is.
    pub(crate) fn of_double(value: f64) -> Number {
        let (first, second, third) = (Image::<0>::dyadic(value), Image::<1>::dyadic(value), Image::<2>::dyadic(value));
        let images = [first.value(), second.value(), third.value()];
        define(Self::computed(DoubleDouble::of(value), 0.0, images), || Definition::Double(value))
    }

    /// A double that is rounded once, of operands that bring in this error, and of which no more is known.
    pub fn rounded(value: f64, inherited: f64) -> Number {
        let error = inherited + value.abs() * f64::EPSILON;
        define(Self::computed(DoubleDouble::of(value), error, NO_IMAGES), || Definition::Double(value))
    }

    /// The number without its images, where the laws of a field do not hold of functions that it is made with.
    pub(crate) fn without_images(self) -> Number {
        let number = Self::computed(self.to_double_double(), self.uncertainty(), NO_IMAGES);
        define(number, || Definition::Product(self, Number::ONE))
    }

    /// The result of an operation on operands that bring in this error, with its images; held exactly where it is a
    /// small integer (0 and 1 above all), and 0 where it may be nothing but error, unless the images tell otherwise.
    fn computed(value: DoubleDouble, inherited: f64, images: Images) -> Number {
        let DoubleDouble { high, low } = value;
        // Where a slope is vertical nothing is known of the error.
        let inherited = if inherited.is_finite() { inherited } else { 0.0 };
        let error = inherited + value.rounding();
        let may_be = |integer: i64| {
            let number = Number::integer(integer);
            let images_of_integer = in_every_field!(number => number);
            images.iter().zip(images_of_integer).any(|(&image, of_integer)| image == UNDEFINED || image == of_integer)
        };
        if high.abs() <= inherited && may_be(0) || high == 0.0 && inherited == 0.0 {
            Number::ZERO
        } else if high == 0.0 {
            // It is no zero, but less than the digits tell.
            Number::Real { value: inherited, rest: 0.0, error: 1.0, images, parts: [0; 4] }
        } else if high.fract() == 0.0 && high.abs() < 1e9 && low.abs() <= error && may_be(high as i64) {
            Number::integer(high as i64)
        } else {
            Number::Real { value: high, rest: low, error: (error / high.abs()) as f32, images, parts: [0; 4] }
        }
    }

    /// `f(self)`, where it is not held exactly.
    pub(super) fn call(self, function: Function) -> Number {
        // The two parts of an angle stay.
        if function == Function::Abs {
            return if self.is_negative() { -self } else { self };
        }
        let (x, value) = (self, self.to_double_double().call(function));
        let error = error_beside(value, self.magnified().call(function));
        let number = Number::computed(value, error, in_every_field!(x => x.call(function)));
        define(number, || Definition::Call(function, self))
    }

    /// `f(self, other)`
    pub(crate) fn call2(self, function: Binary, other: Number) -> Number {
        let (x, value) = (self, self.to_double_double().call2(function, other.to_double_double()));
        let error = error_beside(value, self.magnified().call2(function, other.magnified()));
        let number = Number::computed(value, error, in_every_field!(x, other => x.call2(function, other)));
        define(number, || Definition::Call2(function, self, other))
    }

    /// A derivative of a spline there.
    pub(crate) fn spline(self, spline: &Spline, order: usize) -> Number {
        let (x, value) = (self, spline.derivative(self.to_double_double(), order));
        let error = error_beside(value, self.magnified().spline(spline, order));
        let number = Number::computed(value, error, in_every_field!(x => x.spline(spline, order)));
        define(number, || Definition::Spline(spline.clone(), order, self))
    }

    /// With its error as many times as large as those of doubles are.
    fn magnified(self) -> Rounded {
        Rounded { value: self.to_f64(), error: self.uncertainty() * (f64::EPSILON / DoubleDouble::UNIT) }
    }

    /// `self / other`, to be multiplied with the same `other` again, whose error it therefore does not take over;
    /// `None` where that is zero.
    pub(crate) fn in_units_of(self, other: Number) -> Option<Number> {
        let exactly = match (self, other) {
            (Number::Exact { .. }, Number::Exact { .. }) => other.power(-2).map(|reciprocal| self * reciprocal),
            _ => None,
        };
        let dividend = self;
        let rounded = || {
            let quotient = self.to_double_double().div(other.to_double_double());
            let images = || in_every_field!(dividend, other => dividend.div(other));
            let number = quotient.high.is_finite().then(|| Number::computed(quotient, 0.0, images()));
            number.map(|number| define(number, || Definition::Quotient(self, other)))
        };
        if other.is_zero() { None } else { exactly.or_else(rounded) }
    }

    /// How far, to first order, the constant that is meant may be from [`to_f64`](Self::to_f64).
    pub fn error(self) -> f64 {
        match self {
            Number::Real { rest, .. } => rest.abs() + self.uncertainty(),
            Number::Exact { .. } => self.to_f64().abs() * f64::EPSILON,
        }
    }

    /// How far, to first order, it may be from its 100 bits.
    fn uncertainty(self) -> f64 {
        match self {
            Number::Real { value, error, .. } => value.abs() * f64::from(error),
            Number::Exact { .. } => self.to_f64().abs() * DoubleDouble::UNIT,
        }
    }

    /// For `r π` with `2 r` an integer: that integer modulo 4, the number of quarter turns.
    pub fn quarter_turns(self) -> Option<i64> {
        match self {
            Number::Exact { numerator: 0, .. } => Some(0),
            Number::Exact { numerator, denominator, pi: 1 } if denominator <= 2 => {
                Some((numerator.rem_euclid(4) * (2 / denominator)).rem_euclid(4) as i64)
            }
            _ => None,
        }
    }
}

impl Add for Number {
    type Output = Number;

    fn add(self, other: Number) -> Number {
        let exactly = || match (self, other) {
            (
                Number::Exact { numerator: a, denominator: b, pi: p },
                Number::Exact { numerator: c, denominator: d, pi: q },
            ) if p == q || a == 0 || c == 0 => {
                let pi = if a == 0 { q } else { p };
                let sum = a.checked_mul(d)?.checked_add(c.checked_mul(b)?)?;
                Number::exact(sum, b.checked_mul(d)?, pi)
            }
            _ => None,
        };
        exactly().unwrap_or_else(|| {
            let (a, sum) = (self, self.to_double_double().add(other.to_double_double()));
            let error = self.uncertainty() + other.uncertainty();
            let number = define(Number::computed(sum, error, in_every_field!(a, other => a + other)), || {
                Definition::Sum(self, other)
            });
            number.as_sum(self, other)
        })
    }
}

impl Mul for Number {
    type Output = Number;

    fn mul(self, other: Number) -> Number {
        let exactly = || match (self, other) {
            (
                Number::Exact { numerator: a, denominator: b, pi: p },
                Number::Exact { numerator: c, denominator: d, pi: q },
            ) => Number::exact(a.checked_mul(c)?, b.checked_mul(d)?, p.checked_add(q)?),
            _ => None,
        };
        exactly().unwrap_or_else(|| {
            let (a, product) = (self, self.to_double_double().mul(other.to_double_double()));
            let error = self.to_f64().abs() * other.uncertainty() + other.to_f64().abs() * self.uncertainty();
            let number = Number::computed(product, error, in_every_field!(a, other => a * other));
            let number = define(number, || Definition::Product(self, other));
            number.as_product(self, other)
        })
    }
}

impl Neg for Number {
    type Output = Number;

    fn neg(self) -> Number {
        match self {
            Number::Exact { numerator, denominator, pi } => Number::Exact { numerator: -numerator, denominator, pi },
            Number::Real { value, rest, error, parts: [r, over_r, s, over_s], .. } => {
                let (a, parts) = (self, [-r, over_r, -s, over_s]);
                let number =
                    Number::Real { value: -value, rest: -rest, error, images: in_every_field!(a => -a), parts };
                define(number, || Definition::Product(self, Number::integer(-1)))
            }
        }
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Number) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for Number {}

impl std::hash::Hash for Number {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.bits().hash(state);
    }
}

impl Number {
    fn bits(self) -> (i128, i128, i8, Images) {
        match self {
            Number::Exact { numerator, denominator, pi } => (numerator, denominator, pi, Images::default()),
            Number::Real { value, images, .. } => (i128::from(value.to_bits()), 0, 0, images),
        }
    }
}

/// `2`, `3/4`, `pi/180`, `1.4142135623730951`
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Number::Real { value, .. } => write!(f, "{value:?}"),
            Number::Exact { numerator, denominator, pi } => {
                match (numerator, pi) {
                    (n, 0) => write!(f, "{n}")?,
                    (1, 1) => f.write_str("pi")?,
                    (-1, 1) => f.write_str("-pi")?,
                    (n, 1) => write!(f, "{n}*pi")?,
                    (n, p) => write!(f, "{n}*pi^{p}")?,
                }
                if denominator == 1 { Ok(()) } else { write!(f, "/{denominator}") }
            }
        }
    }
}

/// What error a function's value has, of the same over magnified errors: to first order errors of numbers of 100 bits
/// are those of doubles, but smaller. Next to a pole that is not so, and the digits are all unknown.
fn error_beside(value: DoubleDouble, magnified: Rounded) -> f64 {
    // By more than any mathematical library is off, so that every machine decides alike.
    if (value.high - magnified.value).abs() > 16.0 * magnified.error {
        value.high.abs() / 2.0
    } else {
        magnified.error * (DoubleDouble::UNIT / f64::EPSILON)
    }
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

fn exact_square_root(value: i128) -> Option<i128> {
    let root = value.isqrt();
    (root * root == value).then_some(root)
}

/// The double nearest to `numerator / denominator`. Decimals are such quotients, and must print as they were written.
fn divide_correctly_rounded(numerator: i128, denominator: i128) -> f64 {
    const EXACT: u128 = 1 << 53;
    if numerator.unsigned_abs() <= EXACT && denominator.unsigned_abs() <= EXACT {
        return numerator as i64 as f64 / denominator as i64 as f64; // one rounding
    }
    // Long division to 64 significant bits, the last of them sticky; then one rounding.
    let (mut remainder, divisor) = (numerator.unsigned_abs(), denominator.unsigned_abs());
    let mut quotient = remainder / divisor;
    remainder %= divisor;
    let mut exponent = 0;
    while quotient < 1 << 63 && exponent < 1200 {
        let doubled = remainder.checked_mul(2);
        let (bit, rest) = match doubled {
            Some(twice) => (u128::from(twice >= divisor), if twice >= divisor { twice - divisor } else { twice }),
            // 2 r overflows only if r ≥ 2^127 > divisor/2, so the bit is 1.
            None => (1, remainder - (divisor - remainder)),
        };
        quotient = 2 * quotient + bit;
        remainder = rest;
        exponent += 1;
    }
    let sticky = u128::from(remainder != 0);
    let magnitude = scale_by_power_of_two((quotient | sticky) as f64, -exponent);
    if numerator < 0 { -magnitude } else { magnitude }
}

fn scale_by_power_of_two(value: f64, exponent: i32) -> f64 {
    libm::scalbn(value, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact_and_read_back() {
        for text in ["9.81", "0.1", "-0.295242", "1e-3", "2.5e4", "123456789.123456789", "1e30", "5e-324", "1.7e308"] {
            let number = Number::parse_decimal(text).unwrap();
            assert_eq!(number.to_f64(), text.parse::<f64>().unwrap(), "{text}");
        }
        assert_eq!(Number::parse_decimal("0.25"), Number::rational(1, 4));
        assert_eq!(Number::parse_decimal("1e400"), None);
        assert_eq!(Number::parse_decimal("abc"), None);
    }

    #[test]
    fn rational_arithmetic_is_exact() {
        let third = Number::rational(1, 3).unwrap();
        assert_eq!(third + third + third, Number::ONE);
        assert_eq!(third * Number::integer(3), Number::ONE);
        assert_eq!(Number::rational(9, 4).unwrap().power(1), Number::rational(3, 2));
        assert_eq!(Number::rational(9, 4).unwrap().power(-3), Number::rational(8, 27));
        assert_eq!(Number::integer(-1).power(1), None);
        assert_eq!(Number::ZERO.power(-2), None);
    }

    #[test]
    fn overflow_falls_back_to_100_bits() {
        let big = Number::parse_decimal("1e30").unwrap();
        assert_eq!((big * big).to_f64(), 1e60);
        assert_ne!(1e30 * 1e30, 1e60);
        assert_eq!((big + Number::parse_decimal("1e-30").unwrap()).to_f64(), 1e30);
    }

    #[test]
    fn quarter_turns_of_degrees() {
        let degree = Number::PI * Number::rational(1, 180).unwrap();
        let turns = |degrees| (Number::integer(degrees) * degree).quarter_turns();
        assert_eq!(
            [turns(-90), turns(0), turns(90), turns(180), turns(450)],
            [Some(3), Some(0), Some(1), Some(2), Some(1)]
        );
        assert_eq!(turns(45), None);
    }

    #[test]
    fn long_quotients_are_rounded_once() {
        let number = Number::rational(1234567890123456789012345678, 9876543210987654321098765).unwrap();
        assert_eq!(number.to_f64(), 124.9999988609375);
        let small = Number::rational(1, 10i128.pow(38)).unwrap();
        assert_eq!(small.to_f64(), 1e-38);
    }

    #[test]
    fn what_may_be_nothing_but_error_is_zero() {
        assert!(Number::rounded(6.1e-17, 8.9e-16).is_zero());
        assert!(!Number::rounded(6.1e-17, 1e-32).is_zero());
    }

    /// Coefficients are divided by the first of them, and multiplied with it again: what is unknown of it must not
    /// swallow the sums of their quotients.
    #[test]
    fn quotients_do_not_take_over_what_is_unknown_of_the_divisor() {
        let [first, other] = [Number::rounded(1e-3, 0.9e-3), Number::rounded(1.5e-3, 1.4e-3)];
        let quotient = other.in_units_of(first).expect("finite");
        assert_eq!((quotient.to_f64(), (quotient + Number::ONE).to_f64()), (1.5, 2.5));
        let exact = Number::rational(3, 7).expect("no zero").in_units_of(Number::integer(-3));
        assert_eq!(exact, Number::rational(-1, 7));
        assert_eq!(Number::ONE.in_units_of(Number::ZERO), None);
        let least = Number::rounded(1e-310, 0.0);
        assert_eq!(Number::ONE.in_units_of(least), None, "infinite");
    }
}
