//! Degrees of what is computed: how likely it is that an expression which is not zero vanishes at a random point.
//!
//! Every number is a quotient of polynomials, in the symbols and in the coordinates of points on circles, sines and
//! cosines: a sum of quotients `a/b + c/d` is `(a d + c b)/(b d)`. A degree is a bound: what cancels is not noticed.

use super::evaluate::{Solutions, Value, operators};
use super::factors::symmetric;
use super::field::Prime;
use super::function::{Binary, Function};
use super::number::Number;
use super::ratio::Ratio;
use super::spline::Spline;

/// The degrees of a number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Degree {
    /// Of numerator and denominator in the symbols and in what is opaque.
    plain: Quotient,
    /// Of numerator and denominator in the points of circles.
    angle: Quotient,
    /// The least common multiple of the denominators of all angles: by so much points are turned on.
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
    /// A symbol.
    pub(crate) fn symbol() -> Self {
        let one = Multiple { turns: 1.0, denominator: 1.0 };
        Degree { plain: Quotient::polynomial(1.0), form: Form::Term(one), ..Self::of_constant(Form::Opaque) }
    }

    /// A bound on the probability that a number of these degrees vanishes at a random point, though it is not zero;
    /// with this many arguments of functions.
    pub(crate) fn chance(self, arguments: usize) -> f64 {
        let (p, n) = (Prime::<2>::P as f64, Prime::<2>::N as f64);
        let pairs = (arguments * arguments) as f64 / 2.0;
        (self.plain.sum() + pairs * self.inner) / p + self.angle.sum() * self.denominators / n
    }

    /// In all it is made of.
    pub(crate) fn total(self) -> f64 {
        self.plain.sum() + self.angle.sum() * self.denominators
    }

    fn of_constant(form: Form) -> Self {
        Degree { plain: Quotient::default(), angle: Quotient::default(), denominators: 1.0, inner: 0.0, form }
    }

    fn is_zero(self) -> bool {
        self.form == Form::Rational(Ratio::ZERO)
    }

    fn with(self, other: Self, combined: impl Fn(Quotient, Quotient) -> Quotient, form: Form) -> Self {
        Degree {
            plain: combined(self.plain, other.plain),
            angle: combined(self.angle, other.angle),
            denominators: common_multiple(self.denominators, other.denominators),
            inner: self.inner.max(other.inner),
            form,
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
            plain: Quotient::default(),
            angle: Quotient { numerator: numerator * turns, denominator: denominator * turns },
            denominators: common_multiple(self.denominators, steps),
            inner: self.inner.max(self.total()),
            form: Form::Opaque,
        }
    }

    fn opaque(self) -> Self {
        let inner = self.inner.max(self.total());
        Degree { plain: Quotient::polynomial(1.0), inner, ..Self::of_constant(Form::Opaque) }
    }

    /// The solutions of a system of so many rows, by Cramer's rule: all have one bound.
    fn of_solution(rows: &[Vec<Self>], right_side: &[Self]) -> Self {
        let row = |(row, &right): (&Vec<Self>, &Self)| {
            let entries = || row.iter().chain([&right]).filter(|entry| !entry.is_zero());
            let zero = Self::of_constant(Form::Opaque);
            let cleared = |of: fn(&Self) -> Quotient| {
                let denominators: f64 = entries().map(|entry| of(entry).denominator).sum();
                let numerator = |entry: &Self| of(entry).numerator + denominators - of(entry).denominator;
                Quotient::polynomial(entries().map(numerator).fold(0.0, f64::max))
            };
            let all = entries().fold(zero, |all, &entry| all.with(entry, |_, _| Quotient::default(), Form::Opaque));
            Degree { plain: cleared(|entry| entry.plain), angle: cleared(|entry| entry.angle), ..all }
        };
        let one = Self::of_constant(Form::Opaque);
        let determinant = rows.iter().zip(right_side).map(row).fold(one, Self::mul);
        determinant.with(determinant, |a, b| Quotient { numerator: a.numerator, denominator: b.numerator }, Form::Opaque)
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
        Quotient { numerator: a.max(b), denominator: self.denominator + other.denominator }
    }

    fn times(self, other: Self) -> Self {
        Quotient {
            numerator: self.numerator + other.numerator,
            denominator: self.denominator + other.denominator,
        }
    }

    fn raised(self, exponent: f64) -> Self {
        Quotient { numerator: exponent * self.numerator, denominator: exponent * self.denominator }
    }

    fn inverted(self) -> Self {
        Quotient { numerator: self.denominator, denominator: self.numerator }
    }
}

/// Of integers; their product where they are too large.
fn common_multiple(a: f64, b: f64) -> f64 {
    if a == b || a == 1.0 || b == 1.0 {
        return a.max(b);
    }
    let (mut greater, mut rest) = (a, b);
    while rest != 0.0 {
        (greater, rest) = (rest, greater % rest);
    }
    a / greater * b
}

impl Value for Degree {
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
        Self::of_constant(form)
    }

    fn neg(self) -> Self {
        match self.form {
            Form::Rational(ratio) => Degree { form: Form::Rational(ratio.negative()), ..self },
            Form::Term(_) | Form::Sum(_) | Form::Opaque => self,
        }
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
        self.with(other, Quotient::plus, form)
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
        self.with(other, Quotient::times, form)
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
        let reciprocal = Degree { plain: other.plain.inverted(), angle: other.angle.inverted(), form, ..other };
        self.mul(reciprocal)
    }

    fn power(self, halves: i32) -> Self {
        if halves == 0 {
            return Self::of_constant(Form::Rational(Ratio::ONE));
        }
        // A root is of the degree of what it is of: it counts by its norm.
        let exponent = f64::from(halves.abs()) / if halves % 2 == 0 { 2.0 } else { 1.0 };
        let form = match self.form {
            form if halves == 2 => form,
            Form::Rational(ratio) if ratio == Ratio::ZERO || ratio == Ratio::ONE => self.form,
            Form::Term(multiple) if halves > 0 && halves % 2 == 0 => Form::Term(Multiple {
                turns: libm::pow(multiple.turns, exponent),
                denominator: libm::pow(multiple.denominator, exponent),
            }),
            Form::Rational(_) | Form::Term(_) | Form::Sum(_) | Form::Opaque => Form::Opaque,
        };
        let power = Degree { plain: self.plain.raised(exponent), angle: self.angle.raised(exponent), form, ..self };
        if halves > 0 {
            return power;
        }
        Degree { plain: power.plain.inverted(), angle: power.angle.inverted(), ..power }
    }

    fn call(self, function: Function) -> Self {
        let is_zero = self.is_zero();
        match function {
            Function::Sin | Function::Tan | Function::Sinh | Function::Tanh if is_zero => self,
            Function::Cos | Function::Cosh | Function::Sech | Function::Exp if is_zero => Self::constant(1.0),
            // A function of degree k on a conic has 2 k zeros.
            Function::Sin | Function::Cos => self.on_circle(2.0, 0.0),
            Function::Tan => self.on_circle(2.0, 2.0),
            Function::Exp => self.on_circle(1.0, 1.0),
            Function::Sinh | Function::Cosh => self.on_circle(2.0, 1.0),
            Function::Tanh | Function::Sech => self.on_circle(2.0, 2.0),
            Function::Asin | Function::Acos | Function::Atan | Function::Ln => self.opaque(),
            Function::Abs => self,
            Function::Signum => self.div(self),
        }
    }

    fn call2(self, _: Binary, other: Self) -> Self {
        self.with(other, Quotient::plus, Form::Opaque).opaque()
    }

    fn spline(self, spline: &Spline, order: usize) -> Self {
        if order > spline.degree() { Self::of_constant(Form::Rational(Ratio::ZERO)) } else { self.opaque() }
    }

    fn rate(self) -> Self {
        self
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
        let forces = symmetric(n, &mass).into_iter().enumerate().map(|(i, row)| {
            row.into_iter().chain((0..k).map(|r| jacobian[r * n + i])).collect::<Vec<_>>()
        });
        let targets = (0..k).map(|r| [&jacobian[r * n..(r + 1) * n], vec![zero; k].as_slice()].concat());
        let rows: Vec<Vec<Self>> = forces.chain(targets).collect();
        Box::new(move |columns, _| {
            columns.iter().map(|column| vec![Self::of_solution(&rows, column); column.len()]).collect()
        })
    }
}

operators!([] Degree);

#[cfg(test)]
mod tests {
    use super::*;

    fn number(numerator: i128, denominator: i128) -> Degree {
        Degree::number(Number::rational(numerator, denominator).unwrap())
    }

    fn plain(numerator: f64, denominator: f64) -> Quotient {
        Quotient { numerator, denominator }
    }

    #[test]
    fn rational_operations_by_hand() {
        let x = Degree::symbol();
        // x³/(x + 1) + 1/x = (x⁴ + x + 1)/(x² + x)
        let sum = x.power(6).div(x.add(number(1, 1))).add(number(1, 1).div(x));
        assert_eq!((sum.plain, sum.angle), (plain(4.0, 2.0), plain(0.0, 0.0)));
        assert_eq!(sum.power(-4).plain, plain(4.0, 8.0));
        assert_eq!(x.mul(number(0, 1)).add(number(3, 1)).plain, plain(0.0, 0.0));
        assert_eq!(x.mul(x).sub(x).power(1).plain, plain(2.0, 0.0));
    }

    #[test]
    fn multiples_of_angles_by_hand() {
        let (x, y) = (Degree::symbol(), Degree::symbol());
        // sin(3 x − y/4): 2 (3 + 1/4), by quarters.
        let sine = x.mul(number(3, 1)).sub(y.div(number(4, 1))).call(Function::Sin);
        assert_eq!((sine.angle, sine.denominators), (plain(6.5, 0.0), 4.0));
        assert_eq!(sine.total(), 26.0);
        // cos(x/6) sin(x/4): by twelfths, of which there are 2 (2 + 3).
        let product = x.div(number(6, 1)).call(Function::Cos).mul(x.div(number(4, 1)).call(Function::Sin));
        assert!((product.total() - 10.0).abs() < 1e-12, "{product:?}");
        // A product of symbols is a term, a root is one too: 2.
        assert_eq!(x.mul(y).call(Function::Cos).total(), 2.0);
        assert_eq!(x.add(y).power(1).mul(number(1, 7)).call(Function::Cos).total(), 2.0);
    }

    /// `[2, x; x, y] (a, b) = (1, z)`: rows of degree one each.
    #[test]
    fn linear_solves_by_hand() {
        let x = Degree::symbol();
        let mut columns = vec![vec![number(1, 1), x]];
        Degree::solve_symmetric(&[number(2, 1), x, x], &mut columns);
        assert!(columns[0].iter().all(|entry| entry.plain == plain(2.0, 2.0)));
        let solved = Degree::constrained(1, vec![x.mul(x)], vec![x], &[0])(&[x, x]);
        assert!(solved.iter().all(|entry| entry.plain == plain(3.0, 3.0)));
    }

    #[test]
    fn a_chance_is_that_of_degrees() {
        let (x, y) = (Degree::symbol(), Degree::symbol());
        let (p, n) = (Prime::<2>::P as f64, Prime::<2>::N as f64);
        assert_eq!(x.mul(y).add(x).chance(0), 2.0 / p);
        assert_eq!(x.mul(y.call(Function::Sin)).chance(0), 1.0 / p + 2.0 / n);
        // Four arguments are six pairs: at most eight, of degree two each.
        assert_eq!(x.mul(y).call(Function::Atan).chance(4), (1.0 + 8.0 * 2.0) / p);
    }
}
