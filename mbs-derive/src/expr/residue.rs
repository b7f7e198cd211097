//! Numbers of a finite field, in which whether two expressions are equal is decided without rounding.
//!
//! Two rational functions of degree d that differ agree at a random point of a field of p elements with probability d/p at most
//! (Schwartz, *Fast probabilistic algorithms for verification of polynomial identities*, Journal of the ACM 27:4, 1980). What is
//! not rational is given values that obey the laws by which energies are simplified:
//!
//! - a sine with its cosine is a point of the unit circle. Its points over F_p are a cyclic group of order `p + 1 = 720 N`, N prime:
//!   angles are added as its exponents are. A multiple of π is read as one of half degrees, everything else modulo N, where sums,
//!   products and quotients of angles are formed as of the numbers themselves. So `sin(a + b)`, `sin 2a` and `cos 30° = √3/2` have
//!   the values that they should;
//! - of the two roots of a square one is itself a square, since `p ≡ 3 (mod 4)`, and that one is `√x`: roots are multiplicative,
//!   `√x · √x = x`, and `√(x²)` is x at half of the points and −x at the others, as |x| is;
//! - `exp(−x) = 1/exp(x)`, of which the hyperbolic functions are made;
//! - every other function is opaque: equal where its arguments are, odd where it is odd. So are roots and functions inside angles;
//! - which of two different numbers is the smaller one is decided by a coin, and the other way round for the negatives of both.
//!
//! An identity that rests on no more than these laws holds at every point. One that needs others, `ln(exp(x)) = x` for instance,
//! seems not to hold.

use super::evaluate::Value;
use super::function::{Binary, Function};
use super::number::Number;
use super::ratio::Ratio;

/// `720 · 3202559735011933 − 1`, with which `(p − 1)/2` is prime as well.
const P: u64 = 2_305_843_009_208_591_759;

/// `(p + 1)/720`
const N: u64 = 3_202_559_735_011_933;

/// `2⁶¹ − p`
const FOLD: u64 = (1 << 61) - P;

/// A number of the field, or the mark of what has no value there: 1/0, the root of what is no square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residue {
    /// Below p, or [`UNDEFINED`].
    value: u64,
    /// The same number modulo N but for `half_turns`, as an exponent of a point of the circle.
    angle: u64,
    /// What it holds of π.
    half_turns: Ratio,
    /// What it is, where it is a rational number whatever the point.
    rational: Option<Ratio>,
}

const UNDEFINED: u64 = u64::MAX;

/// The values that stand for π.
const PI: (u64, u64) = (mixed(0x7069), mixed(0x7069_7069) % N);

impl Residue {
    const NOT_DEFINED: Residue = Residue { value: UNDEFINED, angle: 0, half_turns: Ratio::ZERO, rational: None };

    /// A number with no relation to others, the same for the same key.
    pub fn random(key: u64) -> Residue {
        let value = mixed(key) % P;
        Residue { value, angle: mixed(mixed(key)) % N, half_turns: Ratio::ZERO, rational: None }
    }

    /// Whether it has a value.
    pub fn is_defined(self) -> bool {
        self.value != UNDEFINED
    }

    /// Whether it is zero.
    pub fn is_zero(self) -> bool {
        self.value == 0
    }

    fn rational(ratio: Ratio) -> Residue {
        let Ratio { numerator, denominator } = ratio;
        let of = |modulus: u64, quotient: fn(u64, u64) -> u64| {
            quotient(i128::from(numerator).rem_euclid(i128::from(modulus)) as u64, denominator as u64 % modulus)
        };
        let value = of(P, |a, b| if b == 1 { a } else { times(a, inverse(b)) });
        let angle = of(N, |a, b| if b == 1 { a } else { times_angle(a, inverse_angle(b)) });
        Residue { value, angle, half_turns: Ratio::ZERO, rational: Some(ratio) }
    }

    /// A value of which nothing else is known; odd.
    fn opaque(value: u64) -> Residue {
        let (size, negative) = sign(value);
        let angle = mixed(size ^ 0x616e_676c) % N;
        let angle = if negative { negated_angle(angle) } else { angle };
        Residue { value, angle, half_turns: Ratio::ZERO, rational: None }
    }

    /// The number modulo N, with the part that is a multiple of π.
    fn whole_angle(self) -> u64 {
        let turns = Residue::rational(self.half_turns).angle;
        add_angles(self.angle, times_angle(turns, PI.1))
    }

    fn times_ratio(self, ratio: Ratio) -> Option<Ratio> {
        self.half_turns.times(ratio)
    }

    /// Cosine and sine.
    fn on_circle(self) -> (u64, u64) {
        let half_degrees = self.half_turns.times(Ratio { numerator: 360, denominator: 1 });
        match half_degrees.and_then(Ratio::integer) {
            Some(count) => {
                multiplied(power_of(CIRCLE, self.angle), power_of(HALF_DEGREE, count.rem_euclid(720) as u64))
            }
            None => power_of(CIRCLE, self.whole_angle()),
        }
    }

    fn exponential(self) -> u64 {
        let (size, negative) = sign(self.value);
        let value = if size == 0 { 1 } else { mixed(size ^ 0x6578_7000) % (P - 1) + 1 };
        if negative { inverse(value) } else { value }
    }

    /// The root that is a square, of a square.
    fn root(self) -> Residue {
        if let Some(root) = self.rational.and_then(Ratio::root) {
            return Residue::rational(root);
        }
        let root = power(self.value, (P + 1) / 4);
        if times(root, root) == self.value { Residue::opaque(root) } else { Residue::NOT_DEFINED }
    }

    fn to_integer_power(self, n: u32) -> Residue {
        let (mut result, mut square, mut rest) = (Residue::rational(Ratio::ONE), self, n);
        while rest > 0 {
            if rest % 2 == 1 {
                result = result.mul(square);
            }
            square = square.mul(square);
            rest /= 2;
        }
        result
    }

    fn size(self) -> Residue {
        match self.rational {
            Some(ratio) => Residue::rational(Ratio { numerator: ratio.numerator.abs(), ..ratio }),
            None => self.mul(self).root(),
        }
    }
}

impl Value for Residue {
    fn constant(value: f64) -> Self {
        const SHORT: f64 = (1u64 << 53) as f64;
        let doubled = 2.0 * value;
        if doubled.fract() == 0.0 && doubled.abs() < SHORT {
            return halved(doubled as i64);
        }
        Number::from_f64(value).map_or(Residue::NOT_DEFINED, Self::number)
    }

    fn number(number: Number) -> Self {
        match number {
            Number::Exact { numerator, denominator, pi } => {
                let short = |n: i128| i64::try_from(n).ok();
                let ratio = short(numerator).zip(short(denominator));
                let ratio = ratio.map(|(numerator, denominator)| Ratio { numerator, denominator });
                match (ratio, pi) {
                    (Some(ratio), 0) => Residue::rational(ratio),
                    (Some(ratio), 1) => Residue {
                        value: times(Residue::rational(ratio).value, PI.0),
                        angle: 0,
                        half_turns: ratio,
                        rational: None,
                    },
                    _ => long(numerator).div(long(denominator)).mul(power_of_pi(pi)),
                }
            }
            Number::Real { value, .. } => dyadic(value),
        }
    }

    fn neg(self) -> Self {
        if !self.is_defined() {
            return self;
        }
        Residue {
            value: negated(self.value),
            angle: negated_angle(self.angle),
            half_turns: self.half_turns.negative(),
            rational: self.rational.map(Ratio::negative),
        }
    }

    fn add(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Residue::NOT_DEFINED;
        }
        let (a, b, half_turns) = match self.half_turns.plus(other.half_turns) {
            Some(sum) => (self.angle, other.angle, sum),
            None => (self.whole_angle(), other.whole_angle(), Ratio::ZERO),
        };
        Residue {
            value: sum(self.value, other.value),
            angle: add_angles(a, b),
            half_turns,
            rational: self.rational.zip(other.rational).and_then(|(a, b)| a.plus(b)),
        }
    }

    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    fn mul(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Residue::NOT_DEFINED;
        }
        let value = times(self.value, other.value);
        let without = |angle| Residue { value, angle, half_turns: Ratio::ZERO, rational: None };
        if self.half_turns == Ratio::ZERO && other.half_turns == Ratio::ZERO {
            let rational = self.rational.zip(other.rational).and_then(|(a, b)| a.times(b));
            return Residue { rational, ..without(times_angle(self.angle, other.angle)) };
        }
        // A rational number has no part that is a multiple of π.
        let scaled = match (self.rational, other.rational) {
            (Some(ratio), _) => other.times_ratio(ratio),
            (_, Some(ratio)) => self.times_ratio(ratio),
            _ => None,
        };
        match scaled {
            Some(half_turns) => Residue { half_turns, ..without(times_angle(self.angle, other.angle)) },
            None => without(times_angle(self.whole_angle(), other.whole_angle())),
        }
    }

    fn div(self, other: Self) -> Self {
        if !other.is_defined() || other.is_zero() {
            return Residue::NOT_DEFINED;
        }
        let reciprocal = match other.rational.and_then(Ratio::reciprocal) {
            Some(ratio) => Residue::rational(ratio),
            None => Residue {
                value: inverse(other.value),
                angle: inverse_angle(other.whole_angle()),
                half_turns: Ratio::ZERO,
                rational: None,
            },
        };
        self.mul(reciprocal)
    }

    fn power(self, halves: i32) -> Self {
        if !self.is_defined() {
            return self;
        }
        let base = if halves % 2 == 0 { self } else { self.root() };
        let exponent = if halves % 2 == 0 { halves / 2 } else { halves };
        let power = base.to_integer_power(exponent.unsigned_abs());
        if exponent < 0 { Residue::rational(Ratio::ONE).div(power) } else { power }
    }

    fn call(self, function: Function) -> Self {
        if !self.is_defined() {
            return self;
        }
        let (one, two) = (Residue::rational(Ratio::ONE), Residue::rational(Ratio::TWO));
        let e = || Residue::opaque(self.exponential());
        let growing = || e().add(one.div(e())).div(two);
        let odd = || e().sub(one.div(e())).div(two);
        match function {
            Function::Cos => Residue::opaque(self.on_circle().0),
            Function::Sin => Residue::opaque(self.on_circle().1),
            Function::Tan => self.call(Function::Sin).div(self.call(Function::Cos)),
            Function::Asin | Function::Atan => keyed(function as u64, self.value),
            Function::Acos => Residue::number(Number::PI).div(two).sub(self.call(Function::Asin)),
            Function::Sinh => odd(),
            Function::Cosh => growing(),
            Function::Tanh => odd().div(growing()),
            Function::Exp => e(),
            Function::Ln if self.value == 1 => Residue::rational(Ratio::ZERO),
            Function::Ln => Residue::opaque(mixed(self.value ^ 0x6c6e_0000) % P),
            Function::Abs => self.size(),
            Function::Signum if self.is_zero() => self,
            Function::Signum => self.div(self.size()),
        }
    }

    fn call2(self, function: Binary, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Residue::NOT_DEFINED;
        }
        match function {
            Binary::Atan2 => keyed(mixed(other.value), self.value),
            Binary::Powf => match other.rational.and_then(|n| n.times(Ratio::TWO)).and_then(Ratio::integer) {
                Some(halves @ -1000..=1000) => self.power(halves as i32),
                _ => Residue::opaque(mixed(mixed(self.value) ^ other.value) % P),
            },
        }
    }

    fn rate(self) -> Self {
        Residue::NOT_DEFINED
    }

    fn less(self, other: Self) -> bool {
        if let (Some(a), Some(b)) = (self.rational, other.rational) {
            return b.plus(a.negative()).is_some_and(|difference| difference.numerator > 0);
        }
        let difference = other.sub(self);
        difference.is_defined() && !difference.is_zero() && {
            let (size, negative) = sign(difference.value);
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

/// An odd function of the value, another one for each tag.
fn keyed(tag: u64, value: u64) -> Residue {
    let (size, negative) = sign(value);
    let image = if size == 0 { 0 } else { mixed(mixed(size) ^ tag) % P };
    Residue::opaque(if negative { negated(image) } else { image })
}

fn halved(n: i64) -> Residue {
    let whole = Ratio { numerator: n / 2, denominator: 1 };
    Residue::rational(if n % 2 == 0 { whole } else { Ratio { numerator: n, denominator: 2 } })
}

/// A number whose parts are too long for a [`Ratio`].
fn long(n: i128) -> Residue {
    let of = |modulus: u64| n.rem_euclid(i128::from(modulus)) as u64;
    Residue { value: of(P), angle: of(N), half_turns: Ratio::ZERO, rational: None }
}

fn power_of_pi(exponent: i8) -> Residue {
    let pi = Residue { value: PI.0, angle: PI.1, half_turns: Ratio::ZERO, rational: None };
    pi.power(2 * i32::from(exponent))
}

/// What a double holds, to the last bit.
fn dyadic(value: f64) -> Residue {
    let (mantissa, exponent) = libm::frexp(value);
    long((mantissa * (1u64 << 53) as f64) as i128).mul(long(2).power(2 * (exponent - 53)))
}

// ---- arithmetic modulo p

const fn sum(a: u64, b: u64) -> u64 {
    let sum = a + b;
    if sum >= P { sum - P } else { sum }
}

const fn negated(a: u64) -> u64 {
    if a == 0 { 0 } else { P - a }
}

/// `2⁶¹ ≡ 2⁶¹ − p`, which is small.
const fn times(a: u64, b: u64) -> u64 {
    const LOW: u128 = (1 << 61) - 1;
    let product = a as u128 * b as u128;
    let once = (product & LOW) + (product >> 61) * FOLD as u128;
    let twice = (once & LOW) as u64 + (once >> 61) as u64 * FOLD;
    if twice >= P { twice - P } else { twice }
}

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut result, mut square) = (1, base);
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = times(result, square);
        }
        square = times(square, square);
        exponent /= 2;
    }
    result
}

/// Of a number that is not zero.
fn inverse(a: u64) -> u64 {
    power(a, P - 2)
}

/// The one of `a` and `−a` that is below p/2, and whether that is not `a`.
fn sign(a: u64) -> (u64, bool) {
    if a > P / 2 { (P - a, true) } else { (a, false) }
}

// ---- arithmetic modulo N

fn add_angles(a: u64, b: u64) -> u64 {
    (a + b) % N
}

fn negated_angle(a: u64) -> u64 {
    if a == 0 { 0 } else { N - a }
}

fn times_angle(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(N)) as u64
}

/// 0 of 0: no angle, but the number itself may be fine.
fn inverse_angle(a: u64) -> u64 {
    let (mut result, mut square, mut exponent) = (1, a, N - 2);
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = times_angle(result, square);
        }
        square = times_angle(square, square);
        exponent /= 2;
    }
    result
}

// ---- the circle

/// A point of order N.
const CIRCLE: (u64, u64) = (1_733_659_751_054_248_685, 761_210_962_574_323_124);

/// A point of order 720 whose multiples are 90° = (0, 1), 45° = (√2, √2)/2, 60° = (1, √3)/2, and 36° with the cosine (1 + √5)/4; the
/// first that is found among the N-th powers of `((1 − t²)/(1 + t²), 2t/(1 + t²))`.
const HALF_DEGREE: (u64, u64) = (1_964_450_089_492_106_191, 2_259_175_976_771_650_554);

/// Angles are added.
const fn multiplied((c, s): (u64, u64), (d, r): (u64, u64)) -> (u64, u64) {
    (sum(times(c, d), negated(times(s, r))), sum(times(c, r), times(s, d)))
}

fn power_of(point: (u64, u64), mut exponent: u64) -> (u64, u64) {
    let (mut result, mut square) = ((1, 0), point);
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = multiplied(result, square);
        }
        square = multiplied(square, square);
        exponent /= 2;
    }
    result
}

/// The finalizer of splitmix64 (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014).
pub(super) const fn mixed(key: u64) -> u64 {
    let mut z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(numerator: i128, denominator: i128) -> Residue {
        Residue::number(Number::rational(numerator, denominator).unwrap())
    }

    /// Points with no relation, at which no square root is missing.
    fn points() -> impl Iterator<Item = [Residue; 3]> {
        let squared = |key| Residue::random(key).power(4);
        (1..20).map(move |key| [squared(key), squared(key + 100), squared(key + 200)])
    }

    fn equal(a: Residue, b: Residue) {
        assert!(a.is_defined() && a.value == b.value, "{a:?}, {b:?}");
    }

    #[test]
    fn arithmetic_is_that_of_a_field() {
        for [x, y, z] in points() {
            equal(x.add(y).mul(z), x.mul(z).add(y.mul(z)));
            equal(x.mul(y).div(y), x);
            equal(x.sub(x), number(0, 1));
            equal(x.power(6).mul(x.power(-4)), x);
            equal(x.add(number(1, 3)).sub(number(1, 3)), x);
        }
        assert_eq!(times(P - 1, P - 1), 1);
        assert_eq!(inverse(7), (u128::from(inverse(7)) % u128::from(P)) as u64);
        assert_eq!(times(7, inverse(7)), 1);
        assert!(!number(1, 1).div(number(0, 1)).is_defined());
    }

    #[test]
    fn angles_add() {
        let [sin, cos] = [Function::Sin, Function::Cos].map(|f| move |x: Residue| x.call(f));
        for [x, y, z] in points() {
            equal(sin(x).mul(sin(x)).add(cos(x).mul(cos(x))), number(1, 1));
            equal(sin(x.add(y)), sin(x).mul(cos(y)).add(cos(x).mul(sin(y))));
            equal(cos(x.mul(y.add(z))), cos(x.mul(z)).mul(cos(x.mul(y))).sub(sin(x.mul(z)).mul(sin(x.mul(y)))));
            equal(cos(x.div(number(2, 1))).power(4).mul(number(2, 1)), cos(x).add(number(1, 1)));
            equal(sin(x.neg()), sin(x).neg());
            assert_ne!(sin(x).value, sin(y).value);
            assert_ne!(sin(x.mul(y)).value, sin(x.mul(z)).value);
        }
    }

    #[test]
    fn parts_of_a_turn_have_the_sines_that_they_have() {
        let degrees = |count: i128| Residue::number(Number::PI * Number::rational(count, 180).unwrap());
        let check = |count, sine: Residue| equal(degrees(count).call(Function::Sin), sine);
        check(30, number(1, 2));
        check(-90, number(-1, 1));
        check(180, number(0, 1));
        check(45, number(2, 1).power(1).div(number(2, 1)));
        check(240, number(3, 1).power(1).div(number(-2, 1)));
        check(54, number(1, 1).add(number(5, 1).power(1)).div(number(4, 1)));
        for [x, ..] in points() {
            equal(x.add(degrees(90)).call(Function::Sin), x.call(Function::Cos));
            let half = x.add(degrees(60)).div(number(2, 1));
            equal(half.sub(degrees(30)).call(Function::Cos), x.div(number(2, 1)).call(Function::Cos));
            // Multiplied with anything but a rational number, π is as any other.
            let scaled = |y: Residue| x.mul(y).call(Function::Cos);
            equal(scaled(degrees(90)).power(4).mul(number(2, 1)).sub(number(1, 1)), scaled(degrees(180)));
        }
    }

    #[test]
    fn roots_are_multiplicative_and_of_either_sign() {
        let mut signs = [0, 0];
        for [x, y, _] in points() {
            equal(x.power(1).mul(y.power(1)), x.mul(y).power(1));
            equal(x.power(1).power(4), x);
            let plain = Residue::random(x.value);
            let size = plain.call(Function::Abs);
            equal(size.mul(size), plain.mul(plain));
            equal(plain.call(Function::Signum).mul(size), plain);
            signs[usize::from(size == Residue { rational: None, ..plain } || size.value == plain.value)] += 1;
        }
        assert!(signs[0] > 0 && signs[1] > 0);
        assert_eq!(number(49, 4).power(1), number(7, 2));
        assert!((0..20).any(|key| !Residue::random(key).power(1).is_defined()));
    }

    #[test]
    fn other_functions_are_equal_where_their_arguments_are() {
        for [x, y, _] in points() {
            for function in [Function::Asin, Function::Atan, Function::Sinh, Function::Tanh] {
                equal(x.neg().call(function), x.call(function).neg());
                equal(x.add(y).call(function), y.add(x).call(function));
                assert_ne!(x.call(function).value, y.call(function).value);
            }
            equal(x.call(Function::Cosh).power(4), x.call(Function::Sinh).power(4).add(number(1, 1)));
            equal(x.call2(Binary::Powf, number(3, 1)), x.power(6));
            assert_ne!(x.less(y), y.less(x));
            assert!(x.less_equal(x) && !x.less(x));
        }
        assert!(number(1, 3).less(number(1, 2)) && number(-1, 2).less(number(0, 1)));
        assert!(number(0, 1).call(Function::Atan).is_zero() && number(1, 1).call(Function::Ln).is_zero());
    }
}
