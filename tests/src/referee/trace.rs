//! A calculation written down, operation by operation, as it is carried out at one state; and its derivatives, by the
//! chain rule from the result back to what it depends on (Griewank and Walther, *Evaluating derivatives*, 2nd edition,
//! 2008, section 3.2).
//!
//! The statements of a text are gone through once a state. What is wanted of them, hundreds of derivatives, is had from
//! the list.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::number::{Base, Dual, Real};
use super::wide::Wide;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Function {
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
}

impl Function {
    fn of<S: Real>(self, x: S) -> S {
        match self {
            Function::Sqrt => x.sqrt(),
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Sinh => x.sinh(),
            Function::Cosh => x.cosh(),
            Function::Tanh => x.tanh(),
            Function::Exp => x.exp(),
            Function::Ln => x.ln(),
        }
    }

    fn slope<S: Real>(self, x: S) -> S {
        self.of(Dual::new(x, S::of(1.0))).eps
    }
}

/// One line of the list: what is done to which lines before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Line {
    /// A number that the calculation was given.
    Given(usize),
    /// The bits of a constant.
    Constant([u64; 2]),
    Sum(usize, usize),
    Difference(usize, usize),
    Product(usize, usize),
    Quotient(usize, usize),
    Negative(usize),
    Call(Function, usize),
    Atan2(usize, usize),
}

impl Line {
    fn operands(self) -> [Option<usize>; 2] {
        match self {
            Line::Given(_) | Line::Constant(_) => [None, None],
            Line::Negative(a) | Line::Call(_, a) => [Some(a), None],
            Line::Sum(a, b)
            | Line::Difference(a, b)
            | Line::Product(a, b)
            | Line::Quotient(a, b)
            | Line::Atan2(a, b) => [Some(a), Some(b)],
        }
    }
}

#[derive(Default)]
struct Pen {
    lines: Vec<Line>,
    /// The same line is written once.
    known: HashMap<Line, usize>,
}

thread_local! {
    static PEN: RefCell<Pen> = RefCell::default();
}

fn write(line: Line) -> usize {
    PEN.with_borrow_mut(|Pen { lines, known }| {
        *known.entry(line).or_insert_with(|| {
            lines.push(line);
            lines.len() - 1
        })
    })
}

/// A number that knows how it was calculated: by which line, or not at all if it is a constant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traced<R> {
    value: R,
    line: Option<usize>,
}

impl<R: Base> Traced<R> {
    /// The number that the calculation is given at this place.
    fn given(place: usize, value: R) -> Self {
        Traced { value, line: Some(write(Line::Given(place))) }
    }

    fn constant(value: R) -> Self {
        Traced { value, line: None }
    }

    fn is(self, constant: f64) -> bool {
        self.line.is_none() && (self.value - R::of(constant)).is_zero()
    }

    /// Its line, which a constant gets only now.
    pub(super) fn line(self) -> usize {
        let wide = self.value.wide();
        self.line.unwrap_or_else(|| write(Line::Constant([wide.hi().to_bits(), wide.lo().to_bits()])))
    }

    /// Whether it was calculated from one of these.
    pub(super) fn depends_on(self, others: &[Self]) -> bool {
        let Some(last) = self.line else { return false };
        PEN.with_borrow(|Pen { lines, .. }| {
            let mut depends = vec![false; last + 1];
            for (number, line) in lines.iter().enumerate().take(last + 1) {
                depends[number] = others.iter().any(|other| other.line == Some(number))
                    || line.operands().into_iter().flatten().any(|operand| depends[operand]);
            }
            depends[last]
        })
    }

    fn call(self, function: Function) -> Self {
        let value = function.of(self.value);
        Traced { value, line: self.line.map(|a| write(Line::Call(function, a))) }
    }

    /// What comes of two numbers: a constant if both are.
    fn pair(self, other: Self, value: R, line: impl FnOnce(usize, usize) -> Line) -> Self {
        if self.line.is_none() && other.line.is_none() {
            return Self::constant(value);
        }
        Traced { value, line: Some(write(line(self.line(), other.line()))) }
    }
}

impl<R: Base> Add for Traced<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (true, _) => other,
            (_, true) => self,
            _ => self.pair(other, self.value + other.value, |a, b| Line::Sum(a.min(b), a.max(b))),
        }
    }
}

impl<R: Base> Sub for Traced<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (_, true) => self,
            (true, _) => -other,
            _ => self.pair(other, self.value - other.value, Line::Difference),
        }
    }
}

impl<R: Base> Mul for Traced<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        match (self, other) {
            (zero, _) | (_, zero) if zero.is(0.0) => zero,
            (one, x) | (x, one) if one.is(1.0) => x,
            _ => self.pair(other, self.value * other.value, |a, b| Line::Product(a.min(b), a.max(b))),
        }
    }
}

impl<R: Base> Div for Traced<R> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if self.is(0.0) || other.is(1.0) {
            return self;
        }
        self.pair(other, self.value / other.value, Line::Quotient)
    }
}

impl<R: Base> Neg for Traced<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Traced { value: -self.value, line: self.line.map(|a| write(Line::Negative(a))) }
    }
}

macro_rules! functions {
    ($($name:ident $function:ident),*) => {$(
        fn $name(self) -> Self {
            self.call(Function::$function)
        }
    )*};
}

impl<R: Base> Real for Traced<R> {
    const ROUGH: bool = R::ROUGH;

    fn of(value: f64) -> Self {
        Self::constant(R::of(value))
    }
    fn exact(value: Wide) -> Self {
        Self::constant(R::exact(value))
    }
    fn value(self) -> f64 {
        self.value.value()
    }
    /// Whether it is 0 at every state.
    fn is_zero(self) -> bool {
        self.line.is_none() && self.value.is_zero()
    }
    fn less(self, other: Self) -> bool {
        self.value.less(other.value)
    }
    fn less_equal(self, other: Self) -> bool {
        self.value.less_equal(other.value)
    }
    fn noise() -> f64 {
        R::noise()
    }
    functions!(sqrt Sqrt, sin Sin, cos Cos, tan Tan, asin Asin, acos Acos, atan Atan);
    functions!(sinh Sinh, cosh Cosh, tanh Tanh, exp Exp, ln Ln);
    fn atan2(self, x: Self) -> Self {
        self.pair(x, self.value.atan2(x.value), Line::Atan2)
    }
}

/// A calculation, line by line.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    lines: Vec<Line>,
    /// Which is the first group of results that a line is needed for.
    group: Vec<usize>,
}

impl Trace {
    /// Writes down what `calculation` makes of the given numbers, and how; it says which lines are the results, by
    /// groups.
    pub(super) fn of<R: Base, T>(
        given: &[R],
        calculation: impl FnOnce(&[Traced<R>]) -> Result<T, String>,
        groups: impl FnOnce(&T) -> Vec<Vec<usize>>,
    ) -> Result<(Self, T), String> {
        PEN.set(Pen::default());
        let given: Vec<_> = given.iter().enumerate().map(|(place, &value)| Traced::given(place, value)).collect();
        let results = calculation(&given)?;
        let groups = groups(&results);
        let lines = PEN.take().lines;
        let mut group = vec![usize::MAX; lines.len()];
        for (number, roots) in groups.iter().enumerate() {
            roots.iter().for_each(|&root| group[root] = group[root].min(number));
        }
        for (i, line) in lines.iter().enumerate().rev() {
            line.operands().into_iter().flatten().for_each(|a| group[a] = group[a].min(group[i]));
        }
        Ok((Trace { lines, group }, results))
    }

    /// The number on every line that the groups up to this one need.
    pub(super) fn values<S: Real>(&self, given: &[S], group: usize) -> Vec<S> {
        let mut values: Vec<S> = Vec::with_capacity(self.lines.len());
        for (line, needed) in self.lines.iter().zip(&self.group) {
            let value = if *needed > group { S::zero() } else { carried_out(*line, given, &values) };
            values.push(value);
        }
        values
    }

    /// The derivative of a sum of lines, each times a factor, by every given number.
    pub(super) fn gradient<S: Real>(&self, values: &[S], sum: &[(usize, S)], given: usize) -> Vec<S> {
        let last = sum.iter().map(|(line, _)| line + 1).max().unwrap_or(0);
        // None where the sum does not depend on a line.
        let mut slopes: Vec<Option<S>> = vec![None; last];
        let mut gradient = vec![S::zero(); given];
        let gain = |slopes: &mut [Option<S>], line: usize, more: S| {
            slopes[line] = Some(slopes[line].map_or(more, |slope| slope + more));
        };
        sum.iter().for_each(|&(line, factor)| gain(&mut slopes, line, factor));
        for i in (0..last).rev() {
            let Some(slope) = slopes[i] else { continue };
            match self.lines[i] {
                Line::Given(place) => gradient[place] = slope,
                Line::Constant(_) => {}
                Line::Sum(a, b) => {
                    gain(&mut slopes, a, slope);
                    gain(&mut slopes, b, slope);
                }
                Line::Difference(a, b) => {
                    gain(&mut slopes, a, slope);
                    gain(&mut slopes, b, -slope);
                }
                Line::Product(a, b) => {
                    gain(&mut slopes, a, slope * values[b]);
                    gain(&mut slopes, b, slope * values[a]);
                }
                Line::Quotient(a, b) => {
                    let upper = slope / values[b];
                    gain(&mut slopes, a, upper);
                    gain(&mut slopes, b, -(upper * values[i]));
                }
                Line::Negative(a) => gain(&mut slopes, a, -slope),
                Line::Call(function, a) => gain(&mut slopes, a, slope * function.slope(values[a])),
                Line::Atan2(y, x) => {
                    let square = values[y] * values[y] + values[x] * values[x];
                    gain(&mut slopes, y, slope * values[x] / square);
                    gain(&mut slopes, x, -(slope * values[y] / square));
                }
            }
        }
        gradient
    }
}

fn carried_out<S: Real>(line: Line, given: &[S], values: &[S]) -> S {
    match line {
        Line::Given(place) => given[place],
        Line::Constant([hi, lo]) => S::exact(Wide::of_parts(f64::from_bits(hi), f64::from_bits(lo))),
        Line::Sum(a, b) => values[a] + values[b],
        Line::Difference(a, b) => values[a] - values[b],
        Line::Product(a, b) => values[a] * values[b],
        Line::Quotient(a, b) => values[a] / values[b],
        Line::Negative(a) => -values[a],
        Line::Call(function, a) => function.of(values[a]),
        Line::Atan2(y, x) => values[y].atan2(values[x]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = x y sin(x/y) + atan2(x, y) of `x = 0.3`, `y = 0.7`: derivatives forwards and backwards, and one of the
    /// other.
    #[test]
    fn backwards_is_forwards() {
        fn f<S: Real>(x: &[S]) -> S {
            x[0] * x[1] * (x[0] / x[1]).sin() + x[0].atan2(x[1]) - (-x[1]).exp().sqrt()
        }
        let given = [0.3, 0.7].map(Wide::of);
        let written = Trace::of(&given, |x| Ok(f(x).line()), |&line| vec![vec![line]]);
        let (trace, root) = written.expect("a calculation");
        let near = |one: Wide, other: Wide| assert!((one - other).value().abs() < 1e-29, "{one:?} is not {other:?}");
        let one = Wide::of(1.0);
        for i in 0..2 {
            let seeded = |k: usize| {
                given
                    .map(Dual::fixed)
                    .map(|x| x)
                    .into_iter()
                    .enumerate()
                    .map(move |(j, x)| if j == k { Dual::new(x.re, one) } else { x })
            };
            let forwards: Vec<Dual<Wide>> = seeded(i).collect();
            let values = trace.values(&given, 0);
            near(trace.gradient(&values, &[(root, one)], 2)[i], f(&forwards).eps);
            let values = trace.values(&forwards, 0);
            let backwards = trace.gradient(&values, &[(root, Dual::fixed(one))], 2);
            for j in 0..2 {
                let twice: Vec<Dual<Dual<Wide>>> = (0..2)
                    .map(|k| {
                        let unit = |at: usize| if k == at { one } else { Wide::of(0.0) };
                        Dual::new(Dual::new(given[k], unit(i)), Dual::new(unit(j), Wide::of(0.0)))
                    })
                    .collect();
                near(backwards[j].eps, f(&twice).eps.eps);
            }
        }
    }
}
