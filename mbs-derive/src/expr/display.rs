//! Infix printing, as in a textbook; symbols print as `q_0`, `qd_0`, `qdd_0`, `p_0`, `u_0`, `t`.

use std::fmt;

use super::graph::{Expr, Graph, HalfInteger, Id, Node, Symbol};

/// Longer texts end in `…`: a shared graph written out as a tree can be exponentially long.
const LONGEST: usize = 20_000;

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Symbol::Time => f.write_str("t"),
            Symbol::Coordinate(i) => write!(f, "q_{i}"),
            Symbol::Velocity(i) => write!(f, "qd_{i}"),
            Symbol::Acceleration(i) => write!(f, "qdd_{i}"),
            Symbol::Parameter(i) => write!(f, "p_{i}"),
            Symbol::Input(i) => write!(f, "u_{i}"),
            Symbol::Prescribed(i, order) => write!(f, "s{}_{i}", "d".repeat(usize::from(*order))),
            Symbol::Multiplier(i) => write!(f, "lambda_{i}"),
        }
    }
}

impl fmt::Display for HalfInteger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_integer() {
            Some(n) => write!(f, "{n}"),
            None => write!(f, "({}/2)", self.to_halves()),
        }
    }
}

impl fmt::Display for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&infix(self.graph(), self.id(), &|symbol| symbol.to_string()))
    }
}

/// What is still to be written: a text, or an expression that binds at least so tightly.
enum Piece {
    Text(&'static str),
    Operand(Id, u8),
}

const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const NEGATION: u8 = 2;
const POWER: u8 = 3;

/// An expression with its symbols called so.
pub(crate) fn infix(graph: &Graph, root: Id, name: &dyn Fn(Symbol) -> String) -> String {
    use Piece::{Operand, Text};
    let mut text = String::new();
    let mut stack = vec![Operand(root, SUM)];
    while let Some(piece) = stack.pop() {
        if text.len() > LONGEST {
            text.push('…');
            break;
        }
        let (id, least) = match piece {
            Text(literal) => {
                text.push_str(literal);
                continue;
            }
            Operand(id, least) => (id, least),
        };
        let (binding, pieces) = match graph.node(id) {
            Node::Constant(value) => {
                text.push_str(&value.to_string());
                continue;
            }
            Node::Symbol(symbol) => {
                text.push_str(&name(symbol));
                continue;
            }
            Node::Rate(a) => (POWER, vec![Text("dt("), Operand(a, SUM), Text(")")]),
            Node::Neg(a) => (NEGATION, vec![Text("-"), Operand(a, NEGATION)]),
            Node::Add(a, b) => (SUM, vec![Operand(a, SUM), Text(" + "), Operand(b, PRODUCT)]),
            Node::Sub(a, b) => (SUM, vec![Operand(a, SUM), Text(" - "), Operand(b, PRODUCT)]),
            Node::Mul(a, b) => (PRODUCT, vec![Operand(a, PRODUCT), Text(" * "), Operand(b, NEGATION)]),
            Node::Power(a, n) if n == HalfInteger::HALF => (POWER, vec![Text("sqrt("), Operand(a, SUM), Text(")")]),
            Node::Power(a, n) => {
                // The exponent is written after its base.
                let closing = if least > POWER { ")" } else { "" };
                let opening = if least > POWER { "(" } else { "" };
                text.push_str(opening);
                stack.push(Text(closing));
                stack.push(Text(exponent(n)));
                stack.push(Operand(a, POWER + 1));
                continue;
            }
            Node::Call(function, a) => (POWER, vec![Text(function.name()), Text("("), Operand(a, SUM), Text(")")]),
            Node::Spline(derivative, a) => {
                text.push_str(&format!("table_{}{}", derivative.spline, "'".repeat(derivative.order as usize)));
                (POWER, vec![Text("("), Operand(a, SUM), Text(")")])
            }
            Node::Less(a, b) => (SUM, vec![Operand(a, PRODUCT), Text(" < "), Operand(b, PRODUCT)]),
            Node::LessEqual(a, b) => (SUM, vec![Operand(a, PRODUCT), Text(" <= "), Operand(b, PRODUCT)]),
            Node::And(a, b) => (SUM, vec![Operand(a, PRODUCT), Text(" && "), Operand(b, PRODUCT)]),
            Node::Not(a) => (NEGATION, vec![Text("!"), Operand(a, POWER)]),
            Node::Select(c, a, b) => (
                POWER,
                vec![
                    Text("if "),
                    Operand(c, SUM),
                    Text(" { "),
                    Operand(a, SUM),
                    Text(" } else { "),
                    Operand(b, SUM),
                    Text(" }"),
                ],
            ),
            Node::Call2(function, a, b) => {
                (POWER, vec![Text(function.name()), Text("("), Operand(a, SUM), Text(", "), Operand(b, SUM), Text(")")])
            }
        };
        let bracketed = binding < least;
        if bracketed {
            stack.push(Text(")"));
        }
        stack.extend(pieces.into_iter().rev());
        if bracketed {
            stack.push(Text("("));
        }
    }
    text
}

/// Exponents that occur in practice; others are rare enough to be shown as `^…`.
fn exponent(n: HalfInteger) -> &'static str {
    match n.to_halves() {
        -6 => "^-3",
        -4 => "^-2",
        -3 => "^(-3/2)",
        -2 => "^-1",
        -1 => "^(-1/2)",
        3 => "^(3/2)",
        4 => "^2",
        6 => "^3",
        8 => "^4",
        _ => "^…",
    }
}
