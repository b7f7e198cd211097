//! Graph nodes → instructions, in the order in which the roots need them.

use std::hash::{Hash, Hasher};

use crate::expr::graph::MixHasher;
use crate::expr::table::{Finder, Table};
use crate::expr::{Expr, Graph, HalfInteger, Id, Node, Number, Spline, SplineDerivative};

use super::program::{Instruction, Program, Value};
use super::schedule::Hoisting;

/// The program that computes `roots`.
pub(crate) fn program(roots: &[Expr<'_>], hoisting: &Hoisting) -> Program {
    let Some(first) = roots.first() else { return Program::default() };
    let mut lowering = Lowering::new(first.graph(), roots, hoisting);
    let results = roots.iter().map(|root| lowering.value(root.id())).collect();
    let splines = lowering.splines.iter().map(|&number| Spline::clone(&lowering.graph.spline_of(number))).collect();
    // Of several names the first stays.
    lowering.notes.sort_by_key(|(value, _)| *value);
    lowering.notes.dedup_by_key(|(value, _)| *value);
    Program { splines, ..Program::new(lowering.instructions, results, lowering.notes) }
}

struct Lowering<'a> {
    graph: &'a Graph,
    nodes: Table<Entry>,
    instructions: Vec<Instruction>,
    /// The numbers of splines in the graph, by those in the program.
    splines: Vec<u32>,
    /// Equal instructions are one.
    known: Finder,
    /// What values are called.
    notes: Vec<(Value, String)>,
}

/// What is known of a node.
#[derive(Clone, Copy, Default)]
struct Entry {
    /// How often it is used, by nodes that are computed here and as a root.
    uses: u32,
    /// Its number, where the constructor computes it.
    hoisted: Option<u32>,
    /// Its value, once it is computed.
    value: Option<Value>,
}

/// How a node is computed from the values of other nodes.
#[derive(Clone, Copy)]
enum Recipe {
    Leaf(Instruction),
    Neg(Id),
    Binary(fn(Value, Value) -> Instruction, Id, Id),
    Power(Id, i32),
    Call(crate::expr::Function, Id),
    Call2(crate::expr::Binary, Id, Id),
    Spline(SplineDerivative, Id),
    Not(Id),
    Select(Id, Id, Id),
}

impl Recipe {
    fn operands(self) -> impl Iterator<Item = Id> {
        let none = Id(0);
        let (operands, count) = match self {
            Recipe::Leaf(_) => ([none; 3], 0),
            Recipe::Neg(a) | Recipe::Power(a, _) | Recipe::Call(_, a) | Recipe::Spline(_, a) | Recipe::Not(a) => {
                ([a, none, none], 1)
            }
            Recipe::Binary(_, a, b) | Recipe::Call2(_, a, b) => ([a, b, none], 2),
            Recipe::Select(c, a, b) => ([c, a, b], 3),
        };
        operands.into_iter().take(count)
    }
}

impl<'a> Lowering<'a> {
    fn new(graph: &'a Graph, roots: &[Expr<'_>], hoisting: &Hoisting) -> Self {
        let order = graph.reachable(roots.iter().map(|root| root.id()));
        let mut nodes = Table::new(&order, Entry::default());
        roots.iter().for_each(|root| nodes[root.id()].uses += 1);
        for &id in order.iter().rev() {
            nodes[id].hoisted = hoisting.number(id);
            if nodes[id].uses > 0 && nodes[id].hoisted.is_none() {
                graph.node(id).operands().for_each(|operand| nodes[operand].uses += 1);
            }
        }
        let most = order.len();
        let instructions = Vec::with_capacity(most);
        Lowering {
            graph,
            nodes,
            instructions,
            splines: Vec::new(),
            known: Finder::with_capacity(most),
            notes: Vec::new(),
        }
    }

    /// The value of a node, after those that it needs, depth first.
    fn value(&mut self, root: Id) -> Value {
        let mut stack = vec![root];
        while let Some(&id) = stack.last() {
            if self.nodes[id].value.is_some() {
                stack.pop();
                continue;
            }
            let recipe = self.recipe(id);
            let before = stack.len();
            recipe
                .operands()
                .filter(|&operand| self.nodes[operand].value.is_none())
                .for_each(|operand| stack.push(operand));
            stack[before..].reverse();
            if stack.len() == before {
                let value = self.follow(recipe);
                self.nodes[id].value = Some(value);
                self.notes.extend(self.graph.note(id).map(|name| (value, name.to_string())));
                stack.pop();
            }
        }
        self.known_value(root)
    }

    fn known_value(&self, id: Id) -> Value {
        self.nodes[id].value.expect("operands are computed first")
    }

    /// Whether one other node takes it, and it is computed here.
    fn is_used_once(&self, id: Id) -> bool {
        self.nodes[id].uses == 1 && self.nodes[id].hoisted.is_none()
    }

    fn recipe(&self, id: Id) -> Recipe {
        if let Some(number) = self.nodes[id].hoisted {
            return Recipe::Leaf(Instruction::Hoisted(number));
        }
        match self.graph.node(id) {
            Node::Constant(value) => Recipe::Leaf(Instruction::Constant(value)),
            Node::Symbol(symbol) => Recipe::Leaf(Instruction::Symbol(symbol)),
            Node::Rate(_) => unreachable!("time derivatives were carried out by derive"),
            // −(a − b) is b − a where nobody else wants a − b.
            Node::Neg(a) => match self.graph.node(a) {
                Node::Sub(x, y) if self.is_used_once(a) => Recipe::Binary(Instruction::Sub, y, x),
                _ => Recipe::Neg(a),
            },
            Node::Add(a, b) => Recipe::Binary(Instruction::Add, a, b),
            Node::Sub(a, b) => Recipe::Binary(Instruction::Sub, a, b),
            Node::Mul(a, b) => match (self.divisor(a), self.divisor(b)) {
                (_, Some(divisor)) => Recipe::Binary(Instruction::Div, a, divisor),
                (Some(divisor), None) => Recipe::Binary(Instruction::Div, b, divisor),
                (None, None) => Recipe::Binary(Instruction::Mul, a, b),
            },
            Node::Power(a, n) => Recipe::Power(a, n.to_halves()),
            Node::Call(function, a) => Recipe::Call(function, a),
            Node::Call2(function, a, b) => Recipe::Call2(function, a, b),
            Node::Spline(derivative, a) => Recipe::Spline(derivative, a),
            Node::Less(a, b) => Recipe::Binary(Instruction::Less, a, b),
            Node::LessEqual(a, b) => Recipe::Binary(Instruction::LessEqual, a, b),
            Node::And(a, b) => Recipe::Binary(Instruction::And, a, b),
            Node::Not(a) => Recipe::Not(a),
            Node::Select(c, a, b) => Recipe::Select(c, a, b),
        }
    }

    /// The base of a reciprocal that is used once: multiplying by it is a division.
    fn divisor(&self, id: Id) -> Option<Id> {
        match self.graph.node(id) {
            Node::Power(base, n) if n == HalfInteger::MINUS_ONE && self.is_used_once(id) => Some(base),
            _ => None,
        }
    }

    fn follow(&mut self, recipe: Recipe) -> Value {
        let value = |id| self.known_value(id);
        let instruction = match recipe {
            Recipe::Leaf(instruction) => instruction,
            Recipe::Neg(a) => Instruction::Neg(value(a)),
            Recipe::Binary(operation, a, b) => operation(value(a), value(b)),
            Recipe::Power(a, halves) => return self.power(value(a), halves),
            Recipe::Call(function, a) => Instruction::Call(function, value(a)),
            Recipe::Call2(function, a, b) => Instruction::Call2(function, value(a), value(b)),
            Recipe::Spline(derivative, a) => {
                let a = value(a);
                let spline = self.spline(derivative.spline);
                Instruction::Spline(SplineDerivative { spline, ..derivative }, a)
            }
            Recipe::Not(a) => Instruction::Not(value(a)),
            Recipe::Select(c, a, b) => Instruction::Select(value(c), value(a), value(b)),
        };
        self.push(instruction)
    }

    /// The number in the program of a spline of the graph.
    fn spline(&mut self, number: u32) -> u32 {
        let known = self.splines.iter().position(|&known| known == number);
        known.unwrap_or_else(|| {
            self.splines.push(number);
            self.splines.len() - 1
        }) as u32
    }

    /// `x^(halves/2)` by products, a square root and a division; partial powers are shared.
    fn power(&mut self, x: Value, halves: i32) -> Value {
        if halves < 0 {
            let positive = self.power(x, -halves);
            let one = self.push(Instruction::Constant(Number::ONE));
            return self.push(Instruction::Div(one, positive));
        }
        match halves {
            0 => self.push(Instruction::Constant(Number::ONE)),
            1 => self.push(Instruction::Sqrt(x)),
            2 => x,
            odd if odd % 2 == 1 => {
                let (whole, root) = (self.power(x, odd - 1), self.power(x, 1));
                self.push(Instruction::Mul(whole, root))
            }
            _ => {
                // xⁿ = (x^⌊n/2⌋)² · x^(n mod 2)
                let n = halves / 2;
                let half = self.power(x, 2 * (n / 2));
                let square = self.push(Instruction::Mul(half, half));
                if n % 2 == 0 { square } else { self.push(Instruction::Mul(square, x)) }
            }
        }
    }

    fn push(&mut self, instruction: Instruction) -> Value {
        let mut hasher = MixHasher::default();
        instruction.hash(&mut hasher);
        let known = self.known.find_or_add(hasher.finish(), |number| self.instructions[number as usize] == instruction);
        Value(known.unwrap_or_else(|| {
            self.instructions.push(instruction);
            self.instructions.len() as u32 - 1
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    fn lowered(build: impl Fn(Expr<'_>, Expr<'_>) -> Vec<Id>) -> String {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let roots: Vec<_> = build(x, y).into_iter().map(|id| graph.expr(id)).collect();
        program(&roots, &Hoisting::none()).to_string()
    }

    #[test]
    fn a_reciprocal_used_once_is_a_division() {
        assert_eq!(lowered(|x, y| vec![(x / y).id()]), "v0 = q_0\nv1 = q_1\nv2 = v0 / v1\nreturn v2\n");
    }

    #[test]
    fn powers_are_products_and_share_what_they_can() {
        let text = lowered(|x, _| vec![x.powi(2).id(), x.powi(3).id(), x.power(HalfInteger::halves(-3)).id()]);
        let expected = "v0 = q_0\nv1 = v0 * v0\nv2 = v1 * v0\nv3 = sqrt(v0)\nv4 = v0 * v3\nv5 = 1\nv6 = v5 / v4\n";
        assert_eq!(text, format!("{expected}return v1, v2, v6\n"));
    }

    #[test]
    fn the_sign_of_a_difference_costs_nothing() {
        let text = lowered(|x, y| vec![(x - y).id()]) + &lowered(|x, y| vec![(y - x).id()]);
        assert!(!text.contains("= -"), "{text}");
    }
}
