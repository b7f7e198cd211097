//! Dual numbers: values that carry a derivative, nestable for higher derivatives.
//!
//! The independent witness of the symbolic sweeps: nothing here shares a line with them.

use super::constrained::{remainder, remainder_sizes};
use super::evaluate::{Solution, Solutions, Terms, Value};
use super::factors::{Factors, symmetric_times};
use super::function::{Binary, Function};
use super::number::Number;
use super::sparse::Elimination;
use super::spline::Spline;

/// `value + derivative ε` with `ε² = 0`.
///
/// On the outermost level ε may stand for time: then [`Value::rate`] is the time derivative. A second time derivative
/// is not carried and comes out as NaN.
///
/// ```
/// use mbs_derive::expr::{Dual, Value};
/// let x = Dual::new(3.0, 1.0);
/// assert_eq!(x.mul(x).derivative, 6.0); // d(x²)/dx
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The value.
    pub value: S,
    /// The derivative.
    pub derivative: S,
}

impl<S: Value> Dual<S> {
    /// A value that changes.
    pub fn new(value: S, derivative: S) -> Self {
        Dual { value, derivative }
    }

    /// A value that does not change.
    pub fn fixed(value: S) -> Self {
        Dual { value, derivative: S::constant(0.0) }
    }
}

impl<S: Value> Value for Dual<S> {
    const TAKES_BOTH_SIDES: bool = S::TAKES_BOTH_SIDES;

    fn constant(value: f64) -> Self {
        Dual::fixed(S::constant(value))
    }
    fn number(number: Number) -> Self {
        Dual::fixed(S::number(number))
    }
    fn neg(self) -> Self {
        Dual::new(self.value.neg(), self.derivative.neg())
    }
    fn add(self, other: Self) -> Self {
        Dual::new(self.value.add(other.value), self.derivative.add(other.derivative))
    }
    fn sub(self, other: Self) -> Self {
        Dual::new(self.value.sub(other.value), self.derivative.sub(other.derivative))
    }
    fn mul(self, other: Self) -> Self {
        let derivative = self.derivative.mul(other.value).add(self.value.mul(other.derivative));
        Dual::new(self.value.mul(other.value), derivative)
    }
    fn div(self, other: Self) -> Self {
        let quotient = self.value.div(other.value);
        let derivative = self.derivative.sub(quotient.mul(other.derivative)).div(other.value);
        Dual::new(quotient, derivative)
    }
    fn power(self, halves: i32) -> Self {
        if halves == 0 {
            return Self::constant(1.0);
        }
        let slope = S::constant(f64::from(halves) / 2.0).mul(self.value.power(halves - 2));
        Dual::new(self.value.power(halves), slope.mul(self.derivative))
    }
    fn call(self, function: Function) -> Self {
        Dual::new(self.value.call(function), slope(function, self.value).mul(self.derivative))
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        let ((a, da), (b, db)) = ((self.value, self.derivative), (other.value, other.derivative));
        let derivative = match function {
            Binary::Atan2 => da.mul(b).sub(a.mul(db)).div(a.mul(a).add(b.mul(b))),
            Binary::Powf => {
                let value = a.call2(Binary::Powf, b);
                b.mul(a.call2(Binary::Powf, b.sub(S::constant(1.0))))
                    .mul(da)
                    .add(value.mul(a.call(Function::Ln)).mul(db))
            }
        };
        Dual::new(a.call2(function, b), derivative)
    }
    fn raised_to(self, exponent: Self) -> Self {
        let (a, b) = (self.value, exponent.value);
        let slope = b.mul(a.raised_to(b.sub(S::constant(1.0))));
        Dual::new(a.raised_to(b), slope.mul(self.derivative))
    }
    fn spline(self, spline: &Spline, order: usize) -> Self {
        Dual::new(self.value.spline(spline, order), self.value.spline(spline, order + 1).mul(self.derivative))
    }
    fn rate(self) -> Self {
        Dual::new(self.derivative, S::constant(f64::NAN))
    }
    fn less(self, other: Self) -> bool {
        self.value.less(other.value)
    }
    fn less_equal(self, other: Self) -> bool {
        self.value.less_equal(other.value)
    }
    fn condition(self, other: Self, or_equal: bool) -> Self {
        Dual::fixed(self.value.condition(other.value, or_equal))
    }
    fn select(self, a: Self, b: Self) -> Self {
        Dual::new(self.value.select(a.value, b.value), self.value.select(a.derivative, b.derivative))
    }
    /// From `M x = b` follows `M x′ = b′ − M′ x`: one factorization, of numbers without derivatives.
    fn solve_symmetric(triangle: &[Self], columns: &mut [Vec<Self>]) {
        let Some(first) = columns.first() else { return };
        let values: Vec<S> = triangle.iter().map(|entry| entry.value).collect();
        let derivatives: Vec<S> = triangle.iter().map(|entry| entry.derivative).collect();
        let factors = Factors::new(first.len(), &values);
        for column in columns {
            let mut x: Vec<S> = column.iter().map(|b| b.value).collect();
            factors.solve(&mut x);
            let turned = symmetric_times(&derivatives, &x);
            let mut rate: Vec<S> = column.iter().zip(turned).map(|(b, turned)| b.derivative.sub(turned)).collect();
            factors.solve(&mut rate);
            *column = x.into_iter().zip(rate).map(|(x, rate)| Dual::new(x, rate)).collect();
        }
    }
    /// Solutions with their derivatives, in the basis of the values.
    fn constrained_columns<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solutions<'a, Self>
    where
        Self: 'a,
    {
        let value = |numbers: &[Self]| numbers.iter().map(|v| v.value).collect::<Vec<S>>();
        let rate = |numbers: &[Self]| numbers.iter().map(|v| v.derivative).collect::<Vec<S>>();
        let solve = S::constrained_columns(n, value(&mass), value(&jacobian), vectors);
        let (mass, jacobian) = (rate(&mass), rate(&jacobian));
        Box::new(move |columns, terms| {
            let values: Vec<Vec<S>> = columns.iter().map(|column| value(column)).collect();
            let sizes = terms.sizes.iter().map(|sizes| value(sizes)).collect();
            let solutions =
                solve(&values, &Terms { sizes, motion: value(&terms.motion), scales: value(&terms.scales) });
            let solved = || columns.iter().map(|column| rate(column)).zip(&solutions);
            let right_sides: Vec<Vec<S>> =
                solved().map(|(column, x)| remainder(&mass, &jacobian, &column, x, n)).collect();
            let sizes = solved().map(|(column, x)| remainder_sizes(&jacobian, &column, x, n)).collect();
            let rates = solve(&right_sides, &Terms { sizes, motion: Vec::new(), scales: Vec::new() });
            let pair =
                |(x, rates): (&Vec<S>, Vec<S>)| x.iter().zip(rates).map(|(&x, rate)| Dual::new(x, rate)).collect();
            solutions.iter().zip(rates).map(pair).collect()
        })
    }
    fn eliminated<'a>(elimination: &'a Elimination, entries: Vec<Self>) -> Solution<'a, Self>
    where
        Self: 'a,
    {
        let solve = S::eliminated(elimination, entries.iter().map(|v| v.value).collect());
        let slopes: Vec<S> = entries.iter().map(|v| v.derivative).collect();
        Box::new(move |column| {
            let x = solve(&column.iter().map(|b| b.value).collect::<Vec<S>>());
            let turned = elimination.times(&slopes, &elimination.signed(x.clone()));
            let rest: Vec<S> = column.iter().zip(turned).map(|(b, turned)| b.derivative.sub(turned)).collect();
            x.into_iter().zip(solve(&rest)).map(|(x, rate)| Dual::new(x, rate)).collect()
        })
    }
    fn exponent(self) -> i32 {
        self.value.exponent()
    }
}

/// The derivatives of the functions, over numbers.
pub(super) fn slope<S: Value>(function: Function, x: S) -> S {
    let one = S::constant(1.0);
    let square = |y: S| y.mul(y);
    match function {
        Function::Sin => x.call(Function::Cos),
        Function::Cos => x.call(Function::Sin).neg(),
        Function::Tan => one.div(square(x.call(Function::Cos))),
        Function::Asin => one.div(one.sub(square(x)).power(1)),
        Function::Acos => one.div(one.sub(square(x)).power(1)).neg(),
        Function::Atan => one.div(one.add(square(x))),
        Function::Sinh => x.call(Function::Cosh),
        Function::Cosh => x.call(Function::Sinh),
        Function::Tanh => square(x.call(Function::Sech)),
        Function::Sech => x.call(Function::Sech).mul(x.call(Function::Tanh)).neg(),
        Function::Exp => x.call(Function::Exp),
        Function::Ln => one.div(x),
        Function::Abs => x.call(Function::Signum),
        Function::Signum => S::constant(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, Number, Symbol, Tangent, evaluate};

    /// Every function's symbolic first and second derivative against nested duals and a difference quotient.
    #[test]
    fn functions_agree_with_their_symbolic_derivatives() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        for function in Function::ALL.into_iter().chain([Function::Sech]) {
            let at = 0.4;
            let f = x.call(function);
            let mut d = Tangent::new(|_| Some(graph.integer(1)));
            let first: f64 = evaluate(&[d.of(f)], |_| at)[0];
            let second: f64 = evaluate(&[function.second_derivative(x, f)], |_| at)[0];
            let seed = Dual::new(Dual::new(at, 1.0), Dual::new(1.0, 0.0));
            let value = seed.call(function);
            assert!((value.value.derivative - first).abs() < 1e-12, "{}", function.name());
            assert!((value.derivative.derivative - second).abs() < 1e-12, "{}", function.name());
            let quotient = (function.value(at + 1e-6) - function.value(at - 1e-6)) / 2e-6;
            assert!((quotient - first).abs() < 1e-8, "{}", function.name());
            let folded = function.folded(at);
            assert!((folded - function.value(at)).abs() < 1e-15, "{}", function.name());
        }
    }

    #[test]
    fn binary_functions_agree_with_their_symbolic_derivatives() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, b] = [0.7, 1.9];
        let point = |symbol| if symbol == Symbol::Coordinate(0) { a } else { b };
        for function in Binary::ALL {
            let f = x.call2(function, y);
            let symbolic: Vec<f64> = evaluate(&function.derivative(x, y, f), point);
            let second: Vec<f64> = evaluate(&function.second_derivative(x, y, f), point);
            let nested = |p: [f64; 2], r: [f64; 2]| {
                let number = |value, i: usize| Dual::new(Dual::new(value, r[i]), Dual::new(p[i], 0.0));
                number(a, 0).call2(function, number(b, 1))
            };
            let pairs = [([1.0, 0.0], [1.0, 0.0]), ([1.0, 0.0], [0.0, 1.0]), ([0.0, 1.0], [0.0, 1.0])];
            for (k, (p, r)) in pairs.into_iter().enumerate() {
                assert!((nested(p, r).derivative.derivative - second[k]).abs() < 1e-12, "{} {k}", function.name());
            }
            assert!((nested([1.0, 0.0], [0.0, 0.0]).derivative.value - symbolic[0]).abs() < 1e-12);
            assert!((nested([0.0, 1.0], [0.0, 0.0]).derivative.value - symbolic[1]).abs() < 1e-12);
        }
    }

    #[test]
    fn half_integer_powers() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        for halves in [-3, -2, -1, 1, 3, 4, 7] {
            let f = x.power(crate::expr::HalfInteger::halves(halves));
            let first: f64 = evaluate(&[Tangent::new(|_| Some(graph.constant(Number::ONE))).of(f)], |_| 1.7)[0];
            let dual = Dual::new(1.7, 1.0).power(halves);
            assert!((dual.derivative - first).abs() < 1e-13 * (1.0 + first.abs()), "{halves}");
        }
    }
}
