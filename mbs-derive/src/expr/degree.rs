//! Degrees of what is computed: how likely it is that an expression which is not zero vanishes at a random point.
//!
//! Every number is a quotient of polynomials, in the symbols and in the coordinates of points on circles, sines and
//! cosines: a sum of quotients `a/b + c/d` is `(a d + c b)/(b d)`. What was divided by is kept as a factor, so that
//! `a/b + c/b` is `(a + c)/b`. A degree is a bound: what else cancels is not noticed.

#[cfg(test)]
mod tests;

use super::evaluate::{Solutions, Value, operators};
use super::factors::symmetric;
use super::field::{Prime, mixed};
use super::function::{Binary, Function};
use super::number::Number;
use super::ratio::Ratio;
use super::spline::Spline;

/// The degrees of a number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Degree {
    /// Tells numbers that are computed in one way from others.
    key: u64,
    /// Of numerator and denominator in the symbols and in what is opaque, without the factors.
    plain: Quotient,
    /// Of numerator and denominator in the points of circles, without the factors.
    angle: Quotient,
    factors: Factors,
    /// The least common multiple of the denominators of all angles: the part of a term that a point is of.
    denominators: f64,
    /// Of what an argument of functions is, of which two may have the same value by chance.
    inner: f64,
    form: Form,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Quotient {
    numerator: f64,
    denominator: f64,
}

/// Powers of numerators of what was divided by; positive in the denominator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Factors {
    count: usize,
    all: [Factor; 8],
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Factor {
    key: u64,
    /// An integer, of powers of powers a large one.
    exponent: f64,
    plain: f64,
    angle: f64,
}

/// What a number is as an angle: as of an [`Image`](super::Image).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Rational(Ratio),
    Term(Multiple),
    Sum(Multiple),
    Opaque,
}

/// The absolute values of rational coefficients, added, and the least common multiple of their denominators.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Multiple {
    turns: f64,
    denominator: f64,
}

impl Degree {
    /// The symbol of this number.
    pub(crate) fn symbol(number: u64) -> Self {
        let form = Form::Term(Multiple { turns: 1.0, denominator: 1.0 });
        Degree { key: mixed(number), plain: Quotient::polynomial(1.0), form, ..Self::of_constant(Form::Opaque) }
    }

    /// A bound on the probability that a number of these degrees vanishes at a random point, though it is not zero;
    /// with this many arguments of functions.
    pub(crate) fn chance(self, arguments: usize) -> f64 {
        let (p, n) = (Prime::<2>::P as f64, Prime::<2>::N as f64);
        let pairs = (arguments * arguments) as f64 / 2.0;
        let Degree { plain, angle, denominators, inner, .. } = self.without_factors();
        (plain.sum() + pairs * inner) / p + angle.sum() * denominators / n
    }

    /// In all it is made of.
    pub(crate) fn total(self) -> f64 {
        let Degree { plain, angle, denominators, .. } = self.without_factors();
        plain.sum() + angle.sum() * denominators
    }

    /// The factors multiplied out.
    fn without_factors(self) -> Self {
        let mut number = self;
        for factor in self.factors.iter() {
            number.plain.multiply(factor.exponent, factor.plain);
            number.angle.multiply(factor.exponent, factor.angle);
        }
        Degree { factors: Factors::default(), ..number }
    }

    fn of_constant(form: Form) -> Self {
        Degree {
            key: 0,
            plain: Quotient::default(),
            angle: Quotient::default(),
            factors: Factors::default(),
            denominators: 1.0,
            inner: 0.0,
            form,
        }
    }

    fn is_zero(self) -> bool {
        self.form == Form::Rational(Ratio::ZERO)
    }

    fn with(self, other: Self, combined: impl Fn(Quotient, Quotient) -> Quotient, form: Form) -> Self {
        Degree {
            key: 0,
            plain: combined(self.plain, other.plain),
            angle: combined(self.angle, other.angle),
            factors: Factors::default(),
            denominators: common_multiple(self.denominators, other.denominators),
            inner: larger(self.inner, other.inner),
            form,
        }
    }

    /// A sum or a product, in any order of its operands.
    fn keyed(self, operation: u64, a: Self, b: Self) -> Self {
        Degree { key: mixed(a.key.min(b.key) ^ mixed(a.key.max(b.key) ^ operation)), ..self }
    }

    fn with_key(self, operation: u64, a: Self) -> Self {
        Degree { key: mixed(a.key ^ mixed(operation)), ..self }
    }

    /// `1/x^n`: the numerator is a factor of its denominator, unless it is a constant.
    fn reciprocal(self, n: i32, form: Form) -> Self {
        let (plain, angle) = (self.plain.numerator, self.angle.numerator);
        let mut reciprocal = Degree {
            plain: Quotient::polynomial(f64::from(n) * self.plain.denominator),
            angle: Quotient::polynomial(f64::from(n) * self.angle.denominator),
            factors: self.factors.raised(f64::from(-n)),
            form,
            ..self
        };
        if plain > 0.0 || angle > 0.0 {
            reciprocal.put(Factor { key: self.key, exponent: f64::from(n), plain, angle });
        }
        reciprocal.with_key(n as u64, self)
    }

    /// Multiplied with a factor; where there is no room for it, it is multiplied out.
    fn put(&mut self, factor: Factor) {
        if !self.factors.put(factor) {
            self.plain.multiply(factor.exponent, factor.plain);
            self.angle.multiply(factor.exponent, factor.angle);
        }
    }

    fn multiple(self) -> Multiple {
        match self.form {
            Form::Rational(ratio) => Multiple {
                turns: (ratio.numerator as f64 / ratio.denominator as f64).abs(),
                denominator: ratio.denominator as f64,
            },
            Form::Term(multiple) | Form::Sum(multiple) => multiple,
            Form::Opaque => Multiple { turns: 1.0, denominator: 1.0 },
        }
    }

    /// A function of points of the circle.
    fn on_circle(self, numerator: f64, denominator: f64) -> Self {
        let Multiple { turns, denominator: steps } = self.multiple();
        Degree {
            angle: Quotient { numerator: numerator * turns, denominator: denominator * turns },
            denominators: common_multiple(self.denominators, steps),
            inner: larger(self.inner, self.total()),
            ..Self::of_constant(Form::Opaque)
        }
    }

    fn opaque(self) -> Self {
        let inner = larger(self.inner, self.total());
        Degree { plain: Quotient::polynomial(1.0), inner, ..Self::of_constant(Form::Opaque) }
    }

    /// The solutions of a system, by Cramer's rule: all have one bound.
    fn of_solution(rows: &[Vec<Self>], right_side: &[Self]) -> Self {
        let row = |(row, &right): (&Vec<Self>, &Self)| {
            let row: Vec<Self> = row.iter().chain([&right]).map(|entry| entry.without_factors()).collect();
            let entries = || row.iter().filter(|entry| !entry.is_zero());
            let zero = Self::of_constant(Form::Opaque);
            let cleared = |of: fn(&Self) -> Quotient| {
                let denominators: f64 = entries().map(|entry| of(entry).denominator).sum();
                let numerator = |entry: &Self| of(entry).numerator + denominators - of(entry).denominator;
                Quotient::polynomial(entries().map(numerator).fold(0.0, larger))
            };
            let all = entries().fold(zero, |all, &entry| all.with(entry, |_, _| Quotient::default(), Form::Opaque));
            Degree { plain: cleared(|entry| entry.plain), angle: cleared(|entry| entry.angle), ..all }
        };
        let one = Self::of_constant(Form::Opaque);
        let determinant = rows.iter().zip(right_side).map(row).fold(one, Self::mul);
        determinant.with(
            determinant,
            |a, b| Quotient { numerator: a.numerator, denominator: b.numerator },
            Form::Opaque,
        )
    }
}

impl Form {
    /// As an image has it; `None` where it is no term.
    fn power(self, halves: i32) -> Option<Form> {
        let exponent = halves.unsigned_abs();
        match self {
            form if halves == 2 => Some(form),
            Form::Rational(ratio) => {
                let (base, count) = if halves % 2 == 0 { (ratio, exponent / 2) } else { (ratio.root()?, exponent) };
                let power = (0..count).try_fold(Ratio::ONE, |power, _| power.times(base))?;
                Some(Form::Rational(if halves < 0 { power.reciprocal()? } else { power }))
            }
            Form::Term(Multiple { turns, denominator }) if halves % 2 == 0 => {
                let raised = |x: f64| libm::pow(x, f64::from(exponent / 2));
                Some(Form::Term(match halves < 0 {
                    false => Multiple { turns: raised(turns), denominator: raised(denominator) },
                    true => Multiple { turns: 1.0 / raised(turns), denominator: raised(turns * denominator) },
                }))
            }
            Form::Term(_) | Form::Sum(_) | Form::Opaque => None,
        }
    }
}

impl Quotient {
    fn polynomial(degree: f64) -> Self {
        Quotient { numerator: degree, denominator: 0.0 }
    }

    fn sum(self) -> f64 {
        self.numerator + self.denominator
    }

    fn plus(self, other: Self) -> Self {
        let (a, b) = (self.numerator + other.denominator, other.numerator + self.denominator);
        Quotient { numerator: larger(a, b), denominator: self.denominator + other.denominator }
    }

    fn times(self, other: Self) -> Self {
        Quotient { numerator: self.numerator + other.numerator, denominator: self.denominator + other.denominator }
    }

    fn raised(self, exponent: f64) -> Self {
        Quotient { numerator: exponent * self.numerator, denominator: exponent * self.denominator }
    }

    /// With more powers of a polynomial in the denominator.
    fn multiply(&mut self, exponent: f64, degree: f64) {
        let side = if exponent > 0.0 { &mut self.denominator } else { &mut self.numerator };
        *side += exponent.abs() * degree;
    }
}

impl Factors {
    fn iter(&self) -> impl Iterator<Item = Factor> {
        self.all.into_iter().take(self.count)
    }

    fn exponent(&self, key: u64) -> f64 {
        self.iter().find(|factor| factor.key == key).map_or(0.0, |factor| factor.exponent)
    }

    /// Whether there was room for it.
    fn put(&mut self, factor: Factor) -> bool {
        let room = self.all.len() - self.count;
        match self.all[..self.count].iter_mut().find(|known| known.key == factor.key) {
            Some(known) => known.exponent += factor.exponent,
            None if room == 0 => return false,
            None => {
                self.all[self.count] = factor;
                self.count += 1;
            }
        }
        true
    }

    fn raised(mut self, exponent: f64) -> Self {
        self.all.iter_mut().for_each(|factor| factor.exponent *= exponent);
        self
    }
}

/// What tells operations apart in keys.
const SUM: u64 = 1 << 32;
const PRODUCT: u64 = 2 << 32;
const CALL: u64 = 3 << 32;

/// Of integers; infinite where they are too large to be told from their neighbours.
fn common_multiple(a: f64, b: f64) -> f64 {
    const EXACT: f64 = (1u64 << f64::MANTISSA_DIGITS) as f64;
    if !(a <= EXACT && b <= EXACT) {
        return f64::INFINITY;
    }
    if a == b || a == 1.0 || b == 1.0 {
        return a.max(b);
    }
    let (mut greater, mut rest) = (a, b);
    while rest != 0.0 {
        (greater, rest) = (rest, greater % rest);
    }
    a / greater * b
}

/// The larger one of two bounds; of one that is NaN nothing is known.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}

impl Value for Degree {
    const TAKES_BOTH_SIDES: bool = true;

    fn constant(value: f64) -> Self {
        Number::from_f64(value).map_or(Self::of_constant(Form::Opaque), Self::number)
    }

    fn number(number: Number) -> Self {
        let short = |n: i128| i64::try_from(n).ok().filter(|n| *n != i64::MIN);
        let form = match number {
            Number::Exact { numerator, denominator, pi } => match short(numerator).zip(short(denominator)) {
                Some((numerator, denominator)) => {
                    let ratio = Ratio { numerator, denominator };
                    let rational = Self::of_constant(Form::Rational(ratio));
                    if pi == 0 { rational.form } else { Form::Term(rational.multiple()) }
                }
                None => Form::Opaque,
            },
            Number::Real { .. } => Form::Opaque,
        };
        Degree { key: mixed(number.to_f64().to_bits()), ..Self::of_constant(form) }
    }

    fn neg(self) -> Self {
        let form = match self.form {
            Form::Rational(ratio) => Form::Rational(ratio.negative()),
            form @ (Form::Term(_) | Form::Sum(_) | Form::Opaque) => form,
        };
        Degree { key: !self.key, form, ..self }
    }

    fn add(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return if self.is_zero() { other } else { self };
        }
        let form = match (self.form, other.form) {
            (Form::Rational(a), Form::Rational(b)) => a.plus(b).map_or(Form::Opaque, Form::Rational),
            (Form::Opaque, _) | (_, Form::Opaque) => Form::Opaque,
            _ => {
                let (a, b) = (self.multiple(), other.multiple());
                let denominator = common_multiple(a.denominator, b.denominator);
                Form::Sum(Multiple { turns: a.turns + b.turns, denominator })
            }
        };
        if self.factors.count == 0 && other.factors.count == 0 {
            return self.with(other, Quotient::plus, form).keyed(SUM, self, other);
        }
        // Over the greater power of each factor.
        let (mut factors, mut rest) = (self.factors, [self, other]);
        for factor in other.factors.iter() {
            if self.factors.exponent(factor.key) == 0.0 {
                let is_put = factors.put(Factor { exponent: 0.0, ..factor });
                if !is_put {
                    rest[1].plain.multiply(factor.exponent, factor.plain);
                    rest[1].angle.multiply(factor.exponent, factor.angle);
                }
            }
        }
        let count = factors.count;
        for factor in &mut factors.all[..count] {
            let exponents = [self, other].map(|number| number.factors.exponent(factor.key));
            factor.exponent = exponents[0].max(exponents[1]);
            for (number, exponent) in rest.iter_mut().zip(exponents) {
                number.plain.numerator += (factor.exponent - exponent) * factor.plain;
                number.angle.numerator += (factor.exponent - exponent) * factor.angle;
            }
        }
        let sum = rest[0].with(rest[1], Quotient::plus, form);
        Degree { factors, ..sum }.keyed(SUM, self, other)
    }

    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::of_constant(Form::Rational(Ratio::ZERO));
        }
        let (a, b) = (self.multiple(), other.multiple());
        let multiple = Multiple { turns: a.turns * b.turns, denominator: a.denominator * b.denominator };
        let form = match (self.form, other.form) {
            (Form::Rational(a), Form::Rational(b)) => a.times(b).map_or(Form::Opaque, Form::Rational),
            (Form::Rational(_), Form::Sum(_)) | (Form::Sum(_), Form::Rational(_)) => Form::Sum(multiple),
            (Form::Rational(_) | Form::Term(_), Form::Rational(_) | Form::Term(_)) => Form::Term(multiple),
            _ => Form::Opaque,
        };
        let mut product = self.with(other, Quotient::times, form);
        product.factors = self.factors;
        other.factors.iter().for_each(|factor| product.put(factor));
        product.keyed(PRODUCT, self, other)
    }

    fn div(self, other: Self) -> Self {
        let form = match other.form {
            Form::Rational(ratio) => ratio.reciprocal().map_or(Form::Opaque, Form::Rational),
            // The reciprocal of its coefficient.
            Form::Term(Multiple { turns, denominator }) => {
                Form::Term(Multiple { turns: 1.0 / turns, denominator: turns * denominator })
            }
            Form::Sum(_) | Form::Opaque => Form::Opaque,
        };
        self.mul(other.reciprocal(1, form))
    }

    fn power(self, halves: i32) -> Self {
        if halves == 0 {
            return Self::of_constant(Form::Rational(Ratio::ONE));
        }
        // A root is of the degree of what it is of: it counts by its norm.
        let exponent = f64::from(halves.abs()) / if halves % 2 == 0 { 2.0 } else { 1.0 };
        let form = self.form.power(halves).unwrap_or(Form::Opaque);
        if halves < 0 && halves % 2 == 0 {
            return self.reciprocal(-halves / 2, form);
        }
        let base = if halves % 2 == 0 { self } else { self.without_factors() };
        let power = Degree {
            plain: base.plain.raised(exponent),
            angle: base.angle.raised(exponent),
            factors: base.factors.raised(f64::from(halves / 2)),
            form,
            ..base
        };
        let power = power.with_key(halves.unsigned_abs().into(), self);
        if halves > 0 { power } else { power.reciprocal(1, form) }
    }

    fn call(self, function: Function) -> Self {
        let is_zero = self.is_zero();
        let value = match function {
            Function::Sin | Function::Tan | Function::Sinh | Function::Tanh if is_zero => self,
            Function::Cos | Function::Cosh | Function::Sech | Function::Exp if is_zero => Self::constant(1.0),
            // A function of degree k on a conic has 2 k zeros.
            Function::Sin | Function::Cos => self.on_circle(2.0, 0.0),
            Function::Tan => self.on_circle(2.0, 2.0),
            Function::Exp => self.on_circle(1.0, 1.0),
            Function::Sinh | Function::Cosh => self.on_circle(2.0, 1.0),
            Function::Tanh | Function::Sech => self.on_circle(2.0, 2.0),
            Function::Asin | Function::Acos | Function::Atan | Function::Ln => self.opaque(),
            Function::Abs => self.mul(self.opaque()),
            Function::Signum => self.opaque(),
        };
        if is_zero { value } else { value.with_key(CALL + function as u64, self) }
    }

    fn call2(self, function: Binary, other: Self) -> Self {
        let [a, b] = [self, other].map(Self::without_factors);
        let value = a.with(b, Quotient::plus, Form::Opaque).opaque();
        value.with_key(CALL + 100 + function as u64, self.with_key(other.key, self))
    }

    fn spline(self, spline: &Spline, order: usize) -> Self {
        if order > spline.degree() {
            return Self::of_constant(Form::Rational(Ratio::ZERO));
        }
        self.opaque().with_key(CALL + 200 + order as u64, self)
    }

    fn rate(self) -> Self {
        self
    }

    fn condition(self, other: Self, _: bool) -> Self {
        let difference = other.sub(self);
        difference.opaque().with_key(CALL + 300, difference)
    }

    fn select(self, a: Self, b: Self) -> Self {
        b.add(self.mul(a.sub(b)))
    }

    fn less(self, _: Self) -> bool {
        false
    }

    fn less_equal(self, _: Self) -> bool {
        false
    }

    fn is_exactly_zero(self) -> bool {
        self.is_zero()
    }

    fn solve_symmetric(triangle: &[Self], columns: &mut [Vec<Self>]) {
        let Some(first) = columns.first() else { return };
        let rows = symmetric(first.len(), triangle);
        for column in columns {
            let solution = Self::of_solution(&rows, column);
            column.iter_mut().for_each(|entry| *entry = solution);
        }
    }

    fn constrained_columns<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solutions<'a, Self>
    where
        Self: 'a,
    {
        let zero = Self::of_constant(Form::Rational(Ratio::ZERO));
        let k = vectors.len();
        let forces = symmetric(n, &mass)
            .into_iter()
            .enumerate()
            .map(|(i, row)| row.into_iter().chain((0..k).map(|r| jacobian[r * n + i])).collect::<Vec<_>>());
        let targets = (0..k).map(|r| [&jacobian[r * n..(r + 1) * n], vec![zero; k].as_slice()].concat());
        let rows: Vec<Vec<Self>> = forces.chain(targets).collect();
        Box::new(move |columns, _| {
            columns.iter().map(|column| vec![Self::of_solution(&rows, column); column.len()]).collect()
        })
    }
}

operators!([] Degree);
