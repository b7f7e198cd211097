//! What declaration and Programs are made of that fields cannot decide, or only at some points.

use crate::expr::{Binary, Dual, Function, Image, Node, Value};
use crate::interpret::Interpreter;
use crate::optimise::{Derivation, Instruction, Program};

use super::exact::Point;
use super::witness::{Witness, moving};

/// A point at which more roots exist is too rare.
const ROOTS: usize = 12;

/// At this many points roots are looked at: by chance they seem to depend on each other once in 2⁴⁰.
const POINTS: u64 = 52;

/// What there is of each kind.
#[derive(Default)]
pub(super) struct Nodes {
    /// Functions that obey no law in a field.
    pub opaque: Vec<&'static str>,
    /// Conditions, signum and absolute values.
    pub has_choices: bool,
    pub has_roots: bool,
    /// Constants of which the double alone is known.
    pub has_rounded_constants: bool,
    /// How many arguments of functions there are.
    pub arguments: usize,
}

impl Nodes {
    pub(super) fn of(witness: &Witness<'_, '_>, derivation: &Derivation) -> Nodes {
        let mut nodes = Nodes::default();
        let released = witness.released.iter().flat_map(|released| released.tapes());
        for step in witness.tapes().into_iter().chain(released).flat_map(|tape| tape.steps()) {
            match *step {
                Node::Call(function, _) => nodes.call(function),
                Node::Call2(function, ..) => nodes.call2(function),
                Node::Spline(..) => nodes.table(),
                Node::Power(_, n) => nodes.has_roots |= n.to_integer().is_none(),
                Node::Less(..) | Node::LessEqual(..) => nodes.condition(),
                Node::Constant(number) => nodes.has_rounded_constants |= number.is_rounded(),
                Node::Symbol(_)
                | Node::Rate(_)
                | Node::Neg(_)
                | Node::Add(..)
                | Node::Sub(..)
                | Node::Mul(..)
                | Node::And(..)
                | Node::Not(_)
                | Node::Select(..) => {}
            }
        }
        programs(derivation).for_each(|program| nodes.program(program));
        nodes
    }

    fn program(&mut self, program: &Program) {
        for instruction in &program.instructions {
            match *instruction {
                Instruction::Call(function, _) => self.call(function),
                Instruction::Call2(function, ..) => self.call2(function),
                Instruction::Spline(..) => self.table(),
                Instruction::Sqrt(_) => self.has_roots = true,
                Instruction::Less(..) | Instruction::LessEqual(..) => self.condition(),
                Instruction::Constant(number) => self.has_rounded_constants |= number.is_rounded(),
                Instruction::Symbol(_)
                | Instruction::Hoisted(_)
                | Instruction::Neg(_)
                | Instruction::Add(..)
                | Instruction::Sub(..)
                | Instruction::Mul(..)
                | Instruction::Div(..)
                | Instruction::And(..)
                | Instruction::Not(_)
                | Instruction::Select(..) => {}
            }
        }
    }

    fn call(&mut self, function: Function) {
        self.arguments += 1;
        match function {
            Function::Asin | Function::Acos => {
                self.has_roots = true;
                self.opaque(function.name());
            }
            Function::Atan | Function::Ln => self.opaque(function.name()),
            Function::Abs | Function::Signum => self.has_choices = true,
            Function::Sin
            | Function::Cos
            | Function::Tan
            | Function::Sinh
            | Function::Cosh
            | Function::Tanh
            | Function::Sech
            | Function::Exp => {}
        }
    }

    fn call2(&mut self, function: Binary) {
        self.arguments += 1;
        self.has_roots |= function == Binary::Powf;
        self.opaque(function.name());
    }

    fn table(&mut self) {
        self.arguments += 1;
        self.opaque("a table");
    }

    fn condition(&mut self) {
        self.arguments += 1;
        self.has_choices = true;
    }

    fn opaque(&mut self, name: &'static str) {
        if !self.opaque.contains(&name) {
            self.opaque.push(name);
        }
    }

    /// Of how many roots claims are made, or what keeps them from being decided.
    pub(super) fn obstacle(
        &self,
        witness: &Witness<'_, '_>,
        point: impl Fn(u64) -> Point<Image<0>>,
    ) -> Result<usize, &'static str> {
        if !self.has_roots {
            return Ok(0);
        }
        let points: Vec<Vec<Image<0>>> = (0..POINTS).map(|number| roots(witness, &point(number))).collect();
        independent(&points).ok_or("roots that depend on each other")
    }
}

fn programs(derivation: &Derivation) -> impl Iterator<Item = &Program> {
    derivation.functions.iter().map(|function| &function.program).chain([&derivation.constructor])
}

/// What the roots of a declaration are of, constants too.
fn roots<const K: usize>(witness: &Witness<'_, '_>, (state, parameters): &Point<Image<K>>) -> Vec<Image<K>> {
    let mut found = Vec::new();
    for tape in witness.tapes() {
        let values = tape.all(moving(state, parameters));
        let value = |id: crate::expr::Id| values[id.index()].value;
        found.extend(tape.steps().iter().filter_map(|step| match *step {
            Node::Power(a, n) if n.to_integer().is_none() => Some(value(a)),
            // That of its slope.
            Node::Call(Function::Asin | Function::Acos, a) => {
                Some(Value::sub(Image::constant(1.0), Value::mul(value(a), value(a))))
            }
            Node::Call2(Binary::Powf, a, b) if value(b).is_rational() => Some(value(a)),
            _ => None,
        }));
    }
    found
}

/// How many roots there are, if no product of what some of them are of is a square: then each is as much of one sign as
/// of the other, whatever the others are. `None` where there are too many, or some depend on others.
///
/// Whether numbers are squares is a vector of bits over the points; the vectors are to be independent.
fn independent<const K: usize>(points: &[Vec<Image<K>>]) -> Option<usize> {
    let points: Vec<_> = points.iter().filter(|roots| roots.iter().all(|root| root.is_defined())).collect();
    let columns = |k: usize| points.iter().map(move |roots| roots[k]).collect::<Vec<_>>();
    let mut distinct: Vec<Vec<Image<K>>> = Vec::new();
    for k in 0..points.first()?.len() {
        let column = columns(k);
        let is_constant = column.iter().all(|root| root.is_equal(column[0]));
        let is_known = |known: &Vec<Image<K>>| known.iter().zip(&column).all(|(a, &b)| a.is_equal(b));
        if !is_constant && !distinct.iter().any(is_known) {
            distinct.push(column);
        }
    }
    // The first is that of numbers that are no squares anywhere.
    let mut basis: Vec<u64> = vec![(1 << points.len()) - 1];
    for column in &distinct {
        let bits = column.iter().map(|root| u64::from(!root.is_square()));
        let mut row = bits.enumerate().fold(0, |row, (at, bit)| row | bit << at);
        for &other in &basis {
            row = row.min(row ^ other);
        }
        if row == 0 {
            return None;
        }
        basis.push(row);
    }
    let is_enough = points.len() as u64 >= POINTS - 1 || distinct.is_empty();
    (is_enough && distinct.len() <= ROOTS).then_some(distinct.len())
}

/// What a point shows of Programs.
#[derive(Clone, Copy, Default)]
pub(super) struct Shown {
    /// Whether a root is of something that no root of the declaration is of.
    pub has_other_roots: bool,
    /// Whether an angle or an exponent is no sum of products of symbols.
    pub has_other_angles: bool,
}

impl Shown {
    /// Whether there is anything that fields do not know.
    pub(super) fn is_unusual(self) -> bool {
        self.has_other_roots || self.has_other_angles
    }

    /// At a point at which everything declared has a value.
    pub(super) fn at<const K: usize>(
        witness: &Witness<'_, '_>,
        derivation: &Derivation,
        (state, parameters): &Point<Image<K>>,
        multipliers: &[Image<K>],
    ) -> Shown {
        let roots = roots(witness, &(state.clone(), parameters.clone()));
        let interpreter = Interpreter::with_parameters(derivation, parameters.clone());
        let mut shown = Shown::default();
        for tape in witness.tapes() {
            let values = tape.all(moving(state, parameters));
            shown.has_other_angles |= tape
                .steps()
                .iter()
                .any(|step| matches!(*step, Node::Call(f, a) if has_law(f) && !is_sum_of_terms(values[a.index()])));
        }
        for program in programs(derivation) {
            let values = interpreter.steps(program, state, multipliers);
            for instruction in &program.instructions {
                match *instruction {
                    Instruction::Call(f, a) if has_law(f) => {
                        shown.has_other_angles |= !values[a.index()].is_sum_of_terms();
                    }
                    Instruction::Sqrt(a) => {
                        shown.has_other_roots |= !roots.iter().any(|root| root.is_equal(values[a.index()]));
                    }
                    _ => {}
                }
            }
        }
        shown
    }
}

/// Whether arguments of a function are angles or exponents.
fn has_law(function: Function) -> bool {
    !matches!(
        function,
        Function::Asin | Function::Acos | Function::Atan | Function::Ln | Function::Abs | Function::Signum
    )
}

fn is_sum_of_terms<const K: usize>(value: Dual<Image<K>>) -> bool {
    value.value.is_sum_of_terms()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of roots of what `build` makes of three symbols.
    fn count(build: impl Fn([Image<0>; 3]) -> Vec<Image<0>>) -> Option<usize> {
        let points = (0..POINTS).map(|at| build([0, 1, 2].map(|symbol| Image::random(100 * at + symbol))));
        independent(&points.collect::<Vec<_>>())
    }

    #[test]
    fn roots_of_which_no_product_is_a_square_are_independent() {
        let two = Image::constant(2.0);
        assert_eq!(count(|[x, y, z]| vec![x, y, z, x]), Some(3));
        assert_eq!(count(|[x, y, _]| vec![x, x + y, two, x * y]), Some(3));
        assert_eq!(count(|[x, y, _]| vec![x, y, x * y]), None);
        assert_eq!(count(|[x, ..]| vec![x * x]), None);
        assert_eq!(count(|[x, ..]| vec![-(x * x)]), None);
        assert_eq!(count(|[x, y, _]| vec![x, x * y * y]), None);
        assert_eq!(count(|_| vec![two]), Some(0));
        assert_eq!(count(|[x, ..]| (0..13).map(|n| x + Image::constant(f64::from(n))).collect()), None);
    }
}
