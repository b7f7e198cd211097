//! Value numbering (Alpern, Wegman, Zadeck, 1988): what is computed by the same operation of the same operands has one
//! number, whether a Program computes it or a text.
//!
//! Only what gives the same bits is one value: operands of sums and products in either order; `a − b` and `a + (−b)`;
//! a sign of a factor, of a dividend or of a divisor, and that of the whole. Nothing is associated anew, and `−(a − b)`
//! is not `b − a`, which has another zero. A sum with a product is `mul_add`, as the emitter says.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;

use crate::expr::graph::MixHasher;
use crate::expr::{Binary, Function, Spline, Symbol};
use crate::optimise::{Instruction, Program};

/// A value that is known by its number, or its opposite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Number {
    index: u32,
    is_opposite: bool,
}

impl Number {
    /// `−a`
    pub(super) fn opposite(self) -> Self {
        Number { is_opposite: !self.is_opposite, ..self }
    }
}

/// How a value is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Operation {
    /// The bits of a number that is not negative.
    Constant(u64),
    Symbol(Symbol),
    /// A component of the accelerations or multipliers of the motion, where a function finds them itself.
    OfTheMotion(Symbol),
    Sum(Number, Number),
    Product(u32, u32),
    Quotient(u32, u32),
    Root(Number),
    Call(Function, Number),
    Call2(Binary, Number, Number),
    /// The number of the spline, and how often it is differentiated.
    Spline(usize, usize, Number),
    Less(Number, Number),
    LessEqual(Number, Number),
    And(Number, Number),
    Not(Number),
    Select(Number, Number, Number),
}

/// The numbers that were given.
#[derive(Default)]
pub(super) struct Numbering {
    operations: Vec<Operation>,
    numbers: HashMap<Operation, u32, BuildHasherDefault<MixHasher>>,
    /// The bits of the places and rows of splines.
    splines: Vec<[Vec<Vec<u64>>; 2]>,
    /// Whether sech(a) is 1/cosh(a), as languages without it have it.
    divides_for_sech: bool,
}

impl Numbering {
    fn of(&mut self, operation: Operation) -> Number {
        let next = u32::try_from(self.operations.len()).expect("fewer than 2³² values");
        let index = *self.numbers.entry(operation).or_insert(next);
        if index == next {
            self.operations.push(operation);
        }
        Number { index, is_opposite: false }
    }

    /// A constant; equal where their bits are, signs apart.
    pub(super) fn constant(&mut self, value: f64) -> Number {
        let number = self.of(Operation::Constant(value.abs().to_bits()));
        if value.is_sign_negative() { number.opposite() } else { number }
    }

    pub(super) fn is_constant(&self, number: Number) -> bool {
        matches!(self.operations[number.index as usize], Operation::Constant(_))
    }

    pub(super) fn symbol(&mut self, symbol: Symbol) -> Number {
        self.of(Operation::Symbol(symbol))
    }

    /// A component of the accelerations or multipliers that a function finds itself, before it goes on.
    pub(super) fn of_the_motion(&mut self, symbol: Symbol) -> Number {
        self.of(Operation::OfTheMotion(symbol))
    }

    /// `a + b`
    pub(super) fn sum(&mut self, a: Number, b: Number) -> Number {
        self.of(Operation::Sum(a.min(b), a.max(b)))
    }

    /// `a · b`
    pub(super) fn product(&mut self, a: Number, b: Number) -> Number {
        let product = self.of(Operation::Product(a.index.min(b.index), a.index.max(b.index)));
        Number { is_opposite: a.is_opposite != b.is_opposite, ..product }
    }

    /// `a / b`
    pub(super) fn quotient(&mut self, a: Number, b: Number) -> Number {
        let quotient = self.of(Operation::Quotient(a.index, b.index));
        Number { is_opposite: a.is_opposite != b.is_opposite, ..quotient }
    }

    /// `√a`
    pub(super) fn root(&mut self, a: Number) -> Number {
        self.of(Operation::Root(a))
    }

    /// Takes sech(a) for 1/cosh(a) from now on, or does not.
    pub(super) fn divide_for_sech(&mut self, divides: bool) {
        self.divides_for_sech = divides;
    }

    /// `f(a)`
    pub(super) fn call(&mut self, function: Function, a: Number) -> Number {
        if function == Function::Sech && self.divides_for_sech {
            let [one, cosh] = [self.constant(1.0), self.call(Function::Cosh, a)];
            return self.quotient(one, cosh);
        }
        self.of(Operation::Call(function, a))
    }

    /// `f(a, b)`
    pub(super) fn call2(&mut self, function: Binary, a: Number, b: Number) -> Number {
        self.of(Operation::Call2(function, a, b))
    }

    /// A derivative of the spline with this number.
    pub(super) fn spline(&mut self, spline: usize, order: usize, x: Number) -> Number {
        self.of(Operation::Spline(spline, order, x))
    }

    /// `a < b`
    pub(super) fn less(&mut self, a: Number, b: Number) -> Number {
        self.of(Operation::Less(a, b))
    }

    /// `a <= b`
    pub(super) fn less_equal(&mut self, a: Number, b: Number) -> Number {
        self.of(Operation::LessEqual(a, b))
    }

    /// Both conditions hold.
    pub(super) fn and(&mut self, a: Number, b: Number) -> Number {
        self.of(Operation::And(a, b))
    }

    /// A condition does not hold.
    pub(super) fn not(&mut self, a: Number) -> Number {
        self.of(Operation::Not(a))
    }

    /// `if condition { a } else { b }`
    pub(super) fn select(&mut self, condition: Number, a: Number, b: Number) -> Number {
        self.of(Operation::Select(condition, a, b))
    }

    /// The number of a spline with these places and rows.
    pub(super) fn table(&mut self, places: &[f64], rows: &[Vec<f64>]) -> usize {
        let bits = |row: &Vec<f64>| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let spline = [vec![bits(&places.to_vec())], rows.iter().map(bits).collect()];
        if let Some(known) = self.splines.iter().position(|other| *other == spline) {
            return known;
        }
        self.splines.push(spline);
        self.splines.len() - 1
    }

    /// The results of a program, of these values that the constructor computed. Symbols that `is_found` holds of are
    /// those of the motion, which the function finds itself.
    pub(super) fn results(
        &mut self,
        program: &Program,
        hoisted: &[Number],
        is_found: impl Fn(Symbol) -> bool,
    ) -> Vec<Number> {
        let of_spline = |spline: &Spline, numbers: &mut Self| numbers.table(spline.places(), spline.rows());
        let splines: Vec<usize> = program.splines.iter().map(|spline| of_spline(spline, self)).collect();
        let mut values: Vec<Number> = Vec::with_capacity(program.instructions.len());
        for &instruction in &program.instructions {
            let at = |value: crate::optimise::Value| values[value.index()];
            let value = match instruction {
                Instruction::Constant(number) => self.constant(number.to_f64()),
                Instruction::Symbol(symbol) if is_found(symbol) => self.of_the_motion(symbol),
                Instruction::Symbol(symbol) => self.symbol(symbol),
                Instruction::Hoisted(k) => hoisted[k as usize],
                Instruction::Neg(a) => at(a).opposite(),
                Instruction::Add(a, b) => self.sum(at(a), at(b)),
                Instruction::Sub(a, b) => self.sum(at(a), at(b).opposite()),
                Instruction::Mul(a, b) => self.product(at(a), at(b)),
                Instruction::Div(a, b) => self.quotient(at(a), at(b)),
                Instruction::Sqrt(a) => self.root(at(a)),
                Instruction::Call(function, a) => self.call(function, at(a)),
                Instruction::Call2(function, a, b) => self.call2(function, at(a), at(b)),
                Instruction::Spline(of, a) => self.spline(splines[of.spline as usize], of.order as usize, at(a)),
                Instruction::Less(a, b) => self.less(at(a), at(b)),
                Instruction::LessEqual(a, b) => self.less_equal(at(a), at(b)),
                Instruction::And(a, b) => self.and(at(a), at(b)),
                Instruction::Not(a) => self.not(at(a)),
                Instruction::Select(c, a, b) => self.select(at(c), at(a), at(b)),
            };
            values.push(value);
        }
        program.results.iter().map(|result| values[result.index()]).collect()
    }

    /// Where two values begin to differ: the parts of them that the same operations lead to.
    pub(super) fn difference(&self, mut a: Number, mut b: Number) -> [Number; 2] {
        loop {
            let [x, y] = [a, b].map(|number| self.operations[number.index as usize]);
            let is_alike = a.is_opposite == b.is_opposite && is_same_function(x, y);
            let (x, y) = (operands(x), operands(y));
            let mut differ = x.iter().zip(&y).filter(|(x, y)| x != y);
            match (differ.next(), differ.next()) {
                (Some((x, y)), None) if is_alike && x.is_opposite == y.is_opposite => (a, b) = (*x, *y),
                _ => return [a, b],
            }
        }
    }

    /// A value as an expression, its outermost operations written out.
    pub(super) fn shown(&self, number: Number) -> String {
        self.shown_to(number, 3)
    }

    fn shown_to(&self, number: Number, depth: usize) -> String {
        let sign = if number.is_opposite { "-" } else { "" };
        let operation = self.operations[number.index as usize];
        let of = |number: Number| if depth == 0 { "…".to_string() } else { self.shown_to(number, depth - 1) };
        let plain = |index: u32| of(Number { index, is_opposite: false });
        let shown = match operation {
            Operation::Constant(bits) => format!("{:?}", f64::from_bits(bits)),
            Operation::Symbol(symbol) => symbol.to_string(),
            Operation::OfTheMotion(symbol) => format!("{symbol} of the motion"),
            Operation::Sum(a, b) => format!("({} + {})", of(a), of(b)),
            Operation::Product(a, b) => format!("({} * {})", plain(a), plain(b)),
            Operation::Quotient(a, b) => format!("({} / {})", plain(a), plain(b)),
            Operation::Root(a) => format!("sqrt({})", of(a)),
            Operation::Call(function, a) => format!("{}({})", function.name(), of(a)),
            Operation::Call2(function, a, b) => format!("{}({}, {})", function.name(), of(a), of(b)),
            Operation::Spline(spline, order, x) => format!("table_{spline}{}({})", "'".repeat(order), of(x)),
            Operation::Less(a, b) => format!("({} < {})", of(a), of(b)),
            Operation::LessEqual(a, b) => format!("({} <= {})", of(a), of(b)),
            Operation::And(a, b) => format!("({} && {})", of(a), of(b)),
            Operation::Not(a) => format!("!{}", of(a)),
            Operation::Select(c, a, b) => format!("if {} {{ {} }} else {{ {} }}", of(c), of(a), of(b)),
        };
        format!("{sign}{shown}")
    }
}

/// Whether two values differ by their operands alone.
fn is_same_function(a: Operation, b: Operation) -> bool {
    match (a, b) {
        (Operation::Call(f, _), Operation::Call(g, _)) => f == g,
        (Operation::Call2(f, ..), Operation::Call2(g, ..)) => f == g,
        (Operation::Spline(i, k, _), Operation::Spline(j, l, _)) => (i, k) == (j, l),
        _ => std::mem::discriminant(&a) == std::mem::discriminant(&b),
    }
}

fn operands(operation: Operation) -> Vec<Number> {
    let plain = |index: u32| Number { index, is_opposite: false };
    match operation {
        Operation::Constant(_) | Operation::Symbol(_) | Operation::OfTheMotion(_) => Vec::new(),
        Operation::Product(a, b) | Operation::Quotient(a, b) => vec![plain(a), plain(b)],
        Operation::Root(a) | Operation::Call(_, a) | Operation::Spline(_, _, a) | Operation::Not(a) => vec![a],
        Operation::Sum(a, b)
        | Operation::Call2(_, a, b)
        | Operation::Less(a, b)
        | Operation::LessEqual(a, b)
        | Operation::And(a, b) => vec![a, b],
        Operation::Select(c, a, b) => vec![c, a, b],
    }
}
