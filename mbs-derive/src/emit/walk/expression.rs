//! How values are written: parentheses, operators, functions.

use super::super::expression::Tree;
use super::Writer;

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Choice,
    And,
    Comparison,
    Sum,
    Product,
    Sign,
    Primary,
}

impl Writer<'_, '_> {
    /// The text of an expression.
    pub(in crate::emit) fn print(&self, tree: &Tree) -> String {
        self.within(tree, Precedence::Choice)
    }

    /// The text of what a function is called with, of a method that it belongs to.
    pub(super) fn first_argument(&self, tree: &Tree) -> String {
        self.within(tree, if self.syntax.has_methods() { Precedence::Primary } else { Precedence::Choice })
    }

    fn within(&self, tree: &Tree, least: Precedence) -> String {
        use Precedence::{And, Choice, Comparison, Primary, Product, Sign, Sum};
        let (syntax, part) = (self.syntax, |tree: &Tree, least: Precedence| self.within(tree, least));
        let binary = |a: &Tree, sign: &str, b: &Tree, own: Precedence, right: Precedence| {
            (own, format!("{} {sign} {}", part(a, own), part(b, right)))
        };
        let called = |name: &str, a: &Tree, rest: &[Tree]| {
            let rest = rest.iter().map(|argument| part(argument, Choice));
            let arguments: Vec<String> = std::iter::once(self.first_argument(a)).chain(rest).collect();
            (Primary, syntax.call(name, &arguments))
        };
        let (precedence, text) = match tree {
            Tree::Constant(_) | Tree::Hoisted(_) | Tree::Symbol(_) | Tree::Local(_) => {
                let text = syntax.leaf(tree, self.body);
                (if text.starts_with(['-', '*']) { Sign } else { Primary }, text)
            }
            Tree::Neg(a) => (Sign, format!("-{}", part(a, Primary))),
            Tree::Add(a, b) => binary(a, "+", b, Sum, Product),
            Tree::Sub(a, b) => binary(a, "-", b, Sum, Product),
            Tree::Mul(a, b) => binary(a, "*", b, Product, Sign),
            Tree::Div(a, b) => binary(a, "/", b, Product, Sign),
            Tree::Less(a, b) if syntax.has_methods() => called("less", a, std::slice::from_ref(b)),
            Tree::LessEqual(a, b) if syntax.has_methods() => called("less_equal", a, std::slice::from_ref(b)),
            Tree::Less(a, b) => binary(a, "<", b, Comparison, Sum),
            Tree::LessEqual(a, b) => binary(a, "<=", b, Comparison, Sum),
            Tree::And(a, b) if syntax.and_is_tight() => {
                (And, format!("{} {} {}", part(a, Primary), syntax.and(), part(b, Primary)))
            }
            Tree::And(a, b) => binary(a, syntax.and(), b, And, Comparison),
            Tree::Not(a) => (Sign, format!("{}{}", syntax.not(), part(a, Primary))),
            Tree::Select(c, a, b) => {
                let known = [a, b].iter().all(|side| side.is_free() && !self.asks(side));
                let [c, a, b] = [c, a, b].map(|operand| part(operand, And));
                (Choice, syntax.select(&c, [&a, &b], known))
            }
            Tree::Method("mul_add", a, rest) if !syntax.fuses() => return self.within(&unfused(a, rest), least),
            Tree::Method(name, a, rest) => {
                let name = match *name {
                    "sin" if !self.library_sines => "own_sin",
                    "cos" if !self.library_sines => "own_cos",
                    name => name,
                };
                called(name, a, rest)
            }
        };
        if precedence < least { format!("({text})") } else { text }
    }

    /// Whether a value that is computed on demand is in it.
    fn asks(&self, tree: &Tree) -> bool {
        matches!(tree, Tree::Local(local) if self.body.on_demand.contains(local))
            || tree.children().into_iter().any(|part| self.asks(part))
    }
}

/// `a · b + c` as a sum, or as a difference where a sign allows it.
fn unfused(a: &Tree, rest: &[Tree]) -> Tree {
    let [b, c] = rest else { unreachable!("`mul_add` has two arguments") };
    let product = Tree::Mul(Box::new(a.clone()), Box::new(b.clone()));
    match (a, b, c) {
        (_, b, _) if b.is_negative() => {
            let product = Tree::Mul(Box::new(a.clone()), Box::new(Tree::neg(b.clone())));
            Tree::Sub(Box::new(c.clone()), Box::new(product))
        }
        (a, ..) if a.is_negative() => Tree::Sub(Box::new(c.clone()), Box::new(Tree::neg(product))),
        (.., c) if c.is_negative() => Tree::Sub(Box::new(product), Box::new(Tree::neg(c.clone()))),
        _ => Tree::Add(Box::new(product), Box::new(c.clone())),
    }
}
