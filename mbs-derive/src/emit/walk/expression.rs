//! How values are written in languages with infix operators.

use super::super::expression::{Tree, unfused};
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

    fn within(&self, tree: &Tree, least: Precedence) -> String {
        use Precedence::{And, Choice, Comparison, Primary, Product, Sign, Sum};
        let (syntax, part) = (self.syntax, |tree: &Tree, least: Precedence| self.within(tree, least));
        let binary = |a: &Tree, sign: &str, b: &Tree, own: Precedence, right: Precedence| {
            (own, format!("{} {sign} {}", part(a, own), part(b, right)))
        };
        let (precedence, text) = match tree {
            Tree::Constant(value) => {
                let text = syntax.constant(*value);
                (if text.starts_with('-') { Sign } else { Primary }, text)
            }
            Tree::Hoisted(_) => (Primary, syntax.hoisted(self.body.name(tree))),
            Tree::Symbol(_) | Tree::Local(_) => (Primary, syntax.identifier(self.body.name(tree))),
            Tree::Neg(a) => (Sign, format!("-{}", part(a, Primary))),
            Tree::Add(a, b) => binary(a, "+", b, Sum, Product),
            Tree::Sub(a, b) => binary(a, "-", b, Sum, Product),
            Tree::Mul(a, b) => binary(a, "*", b, Product, Sign),
            Tree::Div(a, b) => binary(a, "/", b, Product, Sign),
            Tree::Less(a, b) => binary(a, "<", b, Comparison, Sum),
            Tree::LessEqual(a, b) => binary(a, "<=", b, Comparison, Sum),
            Tree::And(a, b) if syntax.and_is_tight() => {
                (And, format!("{} {} {}", part(a, Primary), syntax.and(), part(b, Primary)))
            }
            Tree::And(a, b) => binary(a, syntax.and(), b, And, Comparison),
            Tree::Not(a) => (Sign, format!("{}{}", syntax.not(), part(a, Primary))),
            Tree::Select(c, a, b) => {
                let [c, a, b] = [c, a, b].map(|operand| part(operand, And));
                (Choice, syntax.select(&c, &a, &b))
            }
            Tree::Method("mul_add", a, rest) => return self.within(&unfused(a, rest), least),
            Tree::Method(name, a, rest) => {
                let arguments: Vec<String> =
                    std::iter::once(&**a).chain(rest).map(|argument| part(argument, Choice)).collect();
                let name = match *name {
                    "sin" if !self.library_sines => "own_sin",
                    "cos" if !self.library_sines => "own_cos",
                    name => name,
                };
                (Primary, syntax.call(name, &arguments))
            }
        };
        if precedence < least { format!("({text})") } else { text }
    }
}
