//! Images of real numbers in a prime field: what the proof is made with, without rounding.
//!
//! A rational function of degree d that is not zero vanishes at a random point of a field of p elements with
//! probability d/p at most (Schwartz, *Fast probabilistic algorithms for verification of polynomial identities*,
//! Journal of the ACM 27:4, 1980). Functions that are not rational get values that obey the laws of the functions:
//!
//! - a sine with its cosine is a point of the unit circle, which is a cyclic group, and angles are exponents. An angle
//!   is read as a sum of terms: each product of symbols, `θ`, `k θ`, `ω t`, and the radian, has an exponent of its own,
//!   without relation to others and to the value, and rational factors and sums are those of exponents modulo the prime
//!   n. So a random point is one of the torus of these terms, on which `sin(a + b)`, `sin 2a` and `cos² (a/2)` are
//!   what they are of real angles. Parts of a turn are exact, to half degrees;
//! - exponentials are powers of a number of prime order in the same way;
//! - of the two roots of a square one is itself a square, and that one is `√x`: roots are multiplicative, and
//!   `√x · √x = x`. Of what is no square there is no root, and no value;
//! - every other function is opaque: equal where its arguments are, and odd where it is odd, `atan2(y, x)` in y where
//!   that is not zero throughout. What is not a sum of terms, as a function inside an angle, is a term of its own, told
//!   from others by its value;
//! - a condition is a number of its own, t, told from others by the difference that is compared, and a choice is
//!   `t a + (1 − t) b`: what holds for all t holds for 0 and 1. `a < b` is `1 − t` of `b <= a`, and of two rational
//!   numbers it is known. Signum is such a number as well, odd, and `|x|` is x times that. Where a double goes along
//!   with every number, conditions come out as the doubles say, and signum is 1 or −1: what holds is then an identity
//!   on one side of each choice, with `|x|² = x²` and all else that holds there.
//!
//! Unlike [`Residue`](super::Residue), with which the generator decides what is equal, this keeps terms apart that are
//! products of others: powers of one base whose exponents are a, b and a b are no random point of a torus. And it
//! shares nothing with what it proves but the arithmetic of the field.

mod solve;

use std::f64::consts::PI;

use super::element::Element;
use super::evaluate::{Solutions, Value, operators};
use super::field::{FIELDS, Prime, inverse, mixed, negative_of, product, sum};
use super::function::{Binary, Function, signum};
use super::number::Number;
use super::ratio::Ratio;
use super::spline::Spline;

/// A number of the field, or the mark of what has no value there: 1/0, the root of what is no square.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<const K: usize> {
    /// Below p, or [`UNDEFINED`].
    value: u64,
    form: Form,
    /// What it is at the state on whose side of each choice the identity is to hold; NaN where there is none.
    double: f64,
}

/// What a number is as an angle or as an exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Rational(Ratio),
    /// This part of π.
    Turn(Ratio),
    /// A rational number times a product of symbols.
    Term(Ratio),
    /// A sum of these.
    Sum {
        /// Modulo n, without what is a part of π.
        angle: u64,
        /// Modulo h.
        exponent: u64,
        /// The part of π.
        turn: Ratio,
    },
    /// A term, of which it is known only if somebody asks.
    Opaque,
}

/// The value of what has none.
pub(super) const UNDEFINED: u64 = u64::MAX;

/// The values of a constant in all fields.
pub(super) type Images = [u64; FIELDS];

/// Those of a constant of which the double alone is known.
pub(super) const NO_IMAGES: Images = [UNDEFINED; FIELDS];

impl<const K: usize> Image<K> {
    const P: u64 = Prime::<K>::P;
    const N: u64 = Prime::<K>::N;
    const H: u64 = Prime::<K>::H;

    /// The sizes of all fields.
    pub(crate) fn moduli() -> [u64; FIELDS] {
        [Prime::<0>::P, Prime::<1>::P, Prime::<2>::P]
    }

    /// A symbol: a number with no relation to others, the same for the same key.
    pub(crate) fn random(key: u64) -> Self {
        Self::of_constant(mixed(mixed(key) ^ K as u64) % Self::P, f64::NAN)
    }

    /// The image with this value of a constant that is not rational.
    pub(super) fn of_constant(value: u64, double: f64) -> Self {
        Image { value, form: Form::Term(Ratio::ONE), double }
    }

    /// The same number with a double that decides conditions.
    pub(crate) fn beside(self, double: f64) -> Self {
        Image { double, ..self }
    }

    /// Its value, [`UNDEFINED`] where it has none.
    pub(super) fn value(self) -> u64 {
        self.value
    }

    /// Whether it has a value.
    pub(crate) fn is_defined(self) -> bool {
        self.value != UNDEFINED
    }

    /// Whether it is zero.
    pub(crate) fn is_zero(self) -> bool {
        self.value == 0
    }

    /// Whether it has the value of another.
    pub(crate) fn is_equal(self, other: Self) -> bool {
        self.is_defined() && self.value == other.value
    }

    /// Whether it has a root.
    pub(crate) fn is_square(self) -> bool {
        Prime::<K>::raised(self.value, Self::H) <= 1
    }

    /// Whether it is a rational number whatever the point is.
    pub(crate) fn is_rational(self) -> bool {
        matches!(self.form, Form::Rational(_))
    }

    /// Whether it is a sum of products and quotients of symbols, with rational factors.
    pub(crate) fn is_sum_of_terms(self) -> bool {
        self.form != Form::Opaque
    }

    /// The value that stands for π.
    fn pi() -> u64 {
        mixed(0x7069 + K as u64) % Self::P
    }

    /// A part of π.
    fn turn(ratio: Ratio) -> Self {
        let pi = Self::of_constant(Self::pi(), PI);
        Image { form: Form::Turn(ratio), ..Self::rational(ratio).mul(pi) }
    }

    fn opaque(value: u64) -> Self {
        Image { value, form: Form::Opaque, double: f64::NAN }
    }

    fn signum(self) -> Self {
        match self.form {
            Form::Rational(ratio) => Self::halved(2 * ratio.numerator.signum()),
            // Whatever rounding leaves of it.
            _ if self.is_zero() => Self::rational(Ratio::ZERO),
            _ if !self.double.is_nan() => Self::halved(2 * signum(self.double) as i64),
            _ => Self::keyed(0x7369_676e, self.value),
        }
    }

    /// `atan2(0, self)`: 0 or π, by a sign that only numbers have in a field.
    fn on_axis(self) -> Self {
        match self.form {
            Form::Rational(ratio) if ratio.numerator < 0 => Self::turn(Ratio::ONE),
            Form::Rational(_) => Self::rational(Ratio::ZERO),
            _ => Self::opaque(Prime::<K>::any(0x6178_6973, self.value)),
        }
    }

    /// An odd function of the value, another one for each tag.
    fn keyed(tag: u64, value: u64) -> Self {
        Self::opaque(Prime::<K>::odd(tag, value))
    }
}

/// Angles and exponents.
impl<const K: usize> Image<K> {
    /// The exponent on the circle without the part of π, the exponent of an exponential, and the part of π.
    fn exponents(self) -> (u64, u64, Ratio) {
        match self.form {
            Form::Sum { angle, exponent, turn } => (angle, exponent, turn),
            // The term is the radian, or 1.
            Form::Rational(ratio) => {
                let (angle, exponent) = Self::exponents_of(ratio, 1);
                (angle, exponent, Ratio::ZERO)
            }
            Form::Turn(ratio) => (0, Self::exponents_of(ratio, Self::pi()).1, ratio),
            Form::Term(ratio) => {
                let (angle, exponent) = Self::exponents_of(ratio, self.without(ratio));
                (angle, exponent, Ratio::ZERO)
            }
            Form::Opaque => {
                let (angle, exponent) = Self::exponents_of(Ratio::ONE, self.value);
                (angle, exponent, Ratio::ZERO)
            }
        }
    }

    /// The value without a factor.
    fn without(self, ratio: Ratio) -> u64 {
        if ratio == Ratio::ONE {
            return self.value;
        }
        let reciprocal = Ratio { numerator: ratio.denominator, denominator: ratio.numerator };
        Prime::<K>::times(self.value, ratio_modulo(reciprocal, Self::P))
    }

    /// Of a rational number times the term that has this value: odd, as angles are.
    fn exponents_of(ratio: Ratio, term: u64) -> (u64, u64) {
        let (size, is_negative) = Prime::<K>::sign(term);
        if size == 0 {
            return (0, 0);
        }
        let ratio = if is_negative { ratio.negative() } else { ratio };
        let of =
            |key: u64, modulus: u64| product(ratio_modulo(ratio, modulus), mixed(mixed(size) ^ key) % modulus, modulus);
        (of(0x616e_676c, Self::N), of(0x6578_706f, Self::H))
    }

    /// Cosine and sine.
    fn on_circle(self) -> (u64, u64) {
        let (angle, _, turn) = self.exponents();
        let point = Prime::<K>::at_angle(angle);
        if turn == Ratio::ZERO {
            return point;
        }
        let half_degrees = turn.times(Ratio { numerator: 360, denominator: 1 });
        let part = match half_degrees.and_then(Ratio::integer) {
            Some(count) => Prime::<K>::power_of(Prime::<K>::HALF_DEGREE, count.rem_euclid(720) as u64),
            None => Prime::<K>::at_angle(Self::exponents_of(turn, Self::pi()).0),
        };
        Prime::<K>::multiplied(point, part)
    }

    fn exponential(self) -> Self {
        Self::opaque(Prime::<K>::exponential(self.exponents().1))
    }
}

impl Form {
    fn scaled(self, ratio: Ratio, of: impl Fn(u64, Ratio) -> (u64, u64)) -> Form {
        match self {
            _ if ratio == Ratio::ONE => self,
            _ if ratio == Ratio::ZERO => Form::Rational(Ratio::ZERO),
            Form::Rational(own) => own.times(ratio).map_or(Form::Opaque, Form::Rational),
            Form::Turn(own) => own.times(ratio).map_or(Form::Opaque, Form::Turn),
            Form::Term(own) => own.times(ratio).map_or(Form::Opaque, Form::Term),
            Form::Sum { angle, exponent, turn } => turn.times(ratio).map_or(Form::Opaque, |turn| {
                let ((angle, _), (_, exponent)) = (of(angle, ratio), of(exponent, ratio));
                Form::Sum { angle, exponent, turn }
            }),
            Form::Opaque => Form::Opaque,
        }
    }

    /// The rational factor of a single term.
    fn factor(self) -> Option<Ratio> {
        match self {
            Form::Rational(ratio) | Form::Turn(ratio) | Form::Term(ratio) => Some(ratio),
            Form::Sum { .. } | Form::Opaque => None,
        }
    }
}

impl<const K: usize> Element for Image<K> {
    const NOT_DEFINED: Self = Image { value: UNDEFINED, form: Form::Opaque, double: f64::NAN };

    /// A number that is not zero, and a multiple of the prime, has no value.
    fn rational(ratio: Ratio) -> Self {
        let value = ratio_modulo(ratio, Self::P);
        if value == 0 && ratio != Ratio::ZERO {
            return Self::NOT_DEFINED;
        }
        let double = ratio.numerator as f64 / ratio.denominator as f64;
        Image { value, form: Form::Rational(ratio), double }
    }

    /// Of more than 64 bits: what part of an angle or an exponent it is is not known.
    fn long(n: i128) -> Self {
        let value = n.rem_euclid(i128::from(Self::P)) as u64;
        if value == 0 && n != 0 { Self::NOT_DEFINED } else { Self::opaque(value).beside(n as f64) }
    }

    fn root(self) -> Self {
        if let Form::Rational(ratio) = self.form
            && let Some(root) = ratio.root()
        {
            return Self::rational(root);
        }
        Prime::<K>::root(self.value).map_or(Self::NOT_DEFINED, Self::opaque).beside(libm::sqrt(self.double))
    }
}

impl<const K: usize> Value for Image<K> {
    const TAKES_BOTH_SIDES: bool = true;

    fn constant(value: f64) -> Self {
        Self::of_double(value)
    }

    fn number(number: Number) -> Self {
        let short = |n: i128| i64::try_from(n).ok().filter(|n| *n != i64::MIN);
        match number {
            Number::Exact { numerator, denominator, pi } => match (short(numerator), short(denominator), pi) {
                (Some(numerator), Some(denominator), 0) => Self::rational(Ratio { numerator, denominator }),
                (Some(numerator), Some(denominator), 1) => Self::turn(Ratio { numerator, denominator }),
                _ => {
                    let pi = Self::of_constant(Self::pi(), PI).power(2 * i32::from(pi));
                    Self::long(numerator).div(Self::long(denominator)).mul(pi)
                }
            },
            Number::Real { value, images, .. } => match number.parts() {
                // As an angle it is the sum of these.
                Some([r, s]) => Self::rational(r).add(Self::turn(s)).beside(value),
                None => Self::of_constant(images[K], value),
            },
        }
    }

    fn neg(self) -> Self {
        if !self.is_defined() {
            return self;
        }
        let form = match self.form {
            Form::Rational(ratio) => Form::Rational(ratio.negative()),
            Form::Turn(ratio) => Form::Turn(ratio.negative()),
            Form::Term(ratio) => Form::Term(ratio.negative()),
            Form::Sum { angle, exponent, turn } => Form::Sum {
                angle: negative_of(angle, Self::N),
                exponent: negative_of(exponent, Self::H),
                turn: turn.negative(),
            },
            Form::Opaque => Form::Opaque,
        };
        Image { value: negative_of(self.value, Self::P), form, double: -self.double }
    }

    fn add(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        let value = sum(self.value, other.value, Self::P);
        let form = match (self.form, other.form) {
            (Form::Rational(Ratio::ZERO), form) | (form, Form::Rational(Ratio::ZERO)) => form,
            (Form::Opaque, _) | (_, Form::Opaque) => Form::Opaque,
            (Form::Rational(a), Form::Rational(b)) => {
                // A sum that is a multiple of the prime has no value.
                match a.plus(b) {
                    Some(ratio) if value == 0 && ratio != Ratio::ZERO => return Self::NOT_DEFINED,
                    Some(ratio) => Form::Rational(ratio),
                    None => Form::Opaque,
                }
            }
            (Form::Turn(a), Form::Turn(b)) => a.plus(b).map_or(Form::Opaque, Form::Turn),
            _ => {
                let ((a, e, s), (b, f, t)) = (self.exponents(), other.exponents());
                s.plus(t).map_or(Form::Opaque, |turn| Form::Sum {
                    angle: sum(a, b, Self::N),
                    exponent: sum(e, f, Self::H),
                    turn,
                })
            }
        };
        Image { value, form, double: self.double + other.double }
    }

    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    fn mul(self, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        let value = Prime::<K>::times(self.value, other.value);
        let scaled = |exponent: u64, ratio: Ratio| {
            (
                product(ratio_modulo(ratio, Self::N), exponent, Self::N),
                product(ratio_modulo(ratio, Self::H), exponent, Self::H),
            )
        };
        let form = match (self.form, other.form) {
            (Form::Rational(ratio), form) | (form, Form::Rational(ratio)) => form.scaled(ratio, scaled),
            (a, b) => {
                let factor = a.factor().zip(b.factor()).and_then(|(a, b)| a.times(b));
                factor.map_or(Form::Opaque, Form::Term)
            }
        };
        Image { value, form, double: self.double * other.double }
    }

    fn div(self, other: Self) -> Self {
        if !other.is_defined() || other.is_zero() {
            return Self::NOT_DEFINED;
        }
        let value = Prime::<K>::inverted(other.value);
        let reciprocal = |form: fn(Ratio) -> Form, ratio: Ratio| ratio.reciprocal().map_or(Form::Opaque, form);
        let form = match (self.form, other.form) {
            // So that π/2π is a number.
            (Form::Turn(a), Form::Turn(b)) => {
                return a
                    .times(b.reciprocal().unwrap_or(Ratio::ZERO))
                    .map_or(self.mul(Self::opaque(value).beside(1.0 / other.double)), Self::rational);
            }
            (_, Form::Rational(ratio)) => reciprocal(Form::Rational, ratio),
            (_, Form::Turn(ratio) | Form::Term(ratio)) => reciprocal(Form::Term, ratio),
            (_, Form::Sum { .. } | Form::Opaque) => Form::Opaque,
        };
        self.mul(Image { value, form, double: 1.0 / other.double })
    }

    fn power(self, halves: i32) -> Self {
        if self.is_defined() { self.to_half_power(halves) } else { self }
    }

    fn call(self, function: Function) -> Self {
        if !self.is_defined() {
            return self;
        }
        let one = Self::rational(Ratio::ONE);
        let halved = |x: Self| x.mul(Self::halved(1));
        let growing = || halved(self.exponential().add(self.neg().exponential()));
        let odd = || halved(self.exponential().sub(self.neg().exponential()));
        let image = match (function, self.form) {
            (Function::Sin | Function::Tan | Function::Sinh | Function::Tanh, Form::Rational(Ratio::ZERO)) => self,
            (Function::Cos | Function::Cosh | Function::Sech | Function::Exp, Form::Rational(Ratio::ZERO)) => one,
            (Function::Cos, _) => Self::opaque(self.on_circle().0),
            (Function::Sin, _) => Self::opaque(self.on_circle().1),
            (Function::Tan, _) => {
                let (cos, sin) = self.on_circle();
                Self::opaque(sin).div(Self::opaque(cos))
            }
            (Function::Asin | Function::Atan, _) => Self::keyed(function as u64, self.value),
            (Function::Acos, _) => Self::number(Number::PI).mul(Self::halved(1)).sub(self.call(Function::Asin)),
            (Function::Sinh, _) => odd(),
            (Function::Cosh, _) => growing(),
            (Function::Tanh, _) => odd().div(growing()),
            (Function::Sech, _) => one.div(growing()),
            (Function::Exp, _) => self.exponential(),
            (Function::Ln, _) if self.value == 1 => Self::rational(Ratio::ZERO),
            (Function::Ln, _) => Self::opaque(mixed(self.value ^ 0x6c6e_0000) % Self::P),
            (Function::Abs, _) => self.mul(self.signum()),
            (Function::Signum, _) => self.signum(),
        };
        if self.double.is_nan() { image } else { image.beside(function.folded(self.double)) }
    }

    fn call2(self, function: Binary, other: Self) -> Self {
        if !(self.is_defined() && other.is_defined()) {
            return Self::NOT_DEFINED;
        }
        let halves = match other.form {
            Form::Rational(ratio) => ratio.times(Ratio::TWO).and_then(Ratio::integer),
            _ => None,
        };
        let image = match (function, halves) {
            (Binary::Atan2, _) if self.is_zero() => other.on_axis(),
            (Binary::Atan2, _) => Self::keyed(mixed(other.value), self.value),
            (Binary::Powf, Some(halves @ -1000..=1000)) => self.power(halves as i32),
            (Binary::Powf, _) => Self::opaque(mixed(mixed(self.value) ^ other.value) % Self::P),
        };
        image.beside(function.folded(self.double, other.double))
    }

    fn spline(self, spline: &Spline, order: usize) -> Self {
        match self.form {
            _ if !self.is_defined() => self,
            _ if order > spline.degree() => Self::rational(Ratio::ZERO),
            Form::Rational(_) => spline.derivative(self, order),
            // What cancels, as `x - x`.
            _ if self.is_zero() => spline.derivative(Self::rational(Ratio::ZERO), order),
            _ => {
                let image = Self::opaque(Prime::<K>::any(mixed(spline.key() ^ order as u64), self.value));
                if self.double.is_nan() { image } else { image.beside(spline.derivative(self.double, order)) }
            }
        }
    }

    fn rate(self) -> Self {
        Self::NOT_DEFINED
    }

    /// Of rational numbers alone; of all others a [`condition`](Value::condition) is a number.
    fn less(self, other: Self) -> bool {
        matches!(other.sub(self).form, Form::Rational(difference) if difference.numerator > 0)
    }

    fn less_equal(self, other: Self) -> bool {
        self.is_equal(other) || self.less(other)
    }

    fn condition(self, other: Self, or_equal: bool) -> Self {
        let difference = other.sub(self);
        let truth = |holds: bool| Self::halved(if holds { 2 } else { 0 });
        match difference.form {
            _ if !difference.is_defined() => Self::NOT_DEFINED,
            _ if difference.is_zero() => truth(or_equal),
            Form::Rational(ratio) => truth(ratio.numerator > 0),
            _ if !difference.double.is_nan() => truth(difference.double > 0.0 || or_equal && difference.double == 0.0),
            _ => {
                // `0 < −d` is `!(0 <= d)`.
                let (size, is_negative) = Prime::<K>::sign(difference.value);
                let number = Self::opaque(mixed(mixed(size) ^ u64::from(or_equal != is_negative)) % Self::P);
                if is_negative { truth(true).sub(number) } else { number }
            }
        }
    }

    fn select(self, a: Self, b: Self) -> Self {
        match self.form {
            Form::Rational(Ratio::ZERO) => b,
            Form::Rational(Ratio::ONE) => a,
            _ => b.add(self.mul(a.sub(b))),
        }
    }

    fn is_exactly_zero(self) -> bool {
        self.is_defined() && self.form == Form::Rational(Ratio::ZERO)
    }

    fn constrained_columns<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solutions<'a, Self>
    where
        Self: 'a,
    {
        let system = solve::System::new(n, vectors.len(), &mass, &jacobian);
        Box::new(move |columns, _| columns.iter().map(|column| system.solution(column)).collect())
    }
}

operators!([const K: usize] Image<K>);

/// A rational number modulo a prime; 0 where the prime divides it.
fn ratio_modulo(ratio: Ratio, modulus: u64) -> u64 {
    let of = |n: i64| {
        let size = n.unsigned_abs() % modulus;
        if n < 0 { negative_of(size, modulus) } else { size }
    };
    match ratio.denominator {
        1 => of(ratio.numerator),
        denominator => product(of(ratio.numerator), inverse(of(denominator), modulus), modulus),
    }
}

#[cfg(test)]
mod tests;
