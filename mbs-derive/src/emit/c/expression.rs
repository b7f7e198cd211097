//! How values are written in C.

use super::super::body::Body;
use super::super::expression::{Tree, unfused};

/// Keywords of C and C++, and what `math.h` and the prelude call theirs: a local of such a name gets another.
const TAKEN: [&str; 60] = [
    "asm",
    "auto",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "continue",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "mutable",
    "namespace",
    "new",
    "operator",
    "private",
    "protected",
    "public",
    "register",
    "restrict",
    "return",
    "self",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typename",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "while",
    "result",
];

/// The identifier for a name of Rust.
pub(super) fn identifier(name: &str) -> String {
    let plain = name.strip_prefix("r#").unwrap_or(name);
    let is_taken = TAKEN.contains(&plain) || plain.starts_with("mbs_") || plain.starts_with("by_q") || plain == "by_u";
    if is_taken { format!("c_{plain}") } else { plain.to_string() }
}

/// The shortest literal that reads back as a value, of the number type.
pub(super) fn constant(value: f64) -> String {
    if value == std::f64::consts::PI {
        "MBS_C(3.14159265358979323846)".to_string()
    } else {
        format!("MBS_C({value:?})")
    }
}

/// A body's leaves as C.
pub(super) struct Printer<'b, 'n> {
    pub(super) body: &'b Body<'n>,
    /// What the table with a number is called.
    pub(super) table: &'b dyn Fn(usize) -> String,
    /// What is before a field of the mechanism.
    pub(super) own: &'static str,
}

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

impl Printer<'_, '_> {
    pub(super) fn local(&self, local: usize) -> String {
        identifier(&self.body.locals[local])
    }

    /// `mbs_spline(count, places, columns, rows`, a derivative's order and the argument to follow.
    pub(super) fn spline(&self, table: &str) -> String {
        format!(
            "mbs_spline(sizeof({table}_places)/sizeof(mbs_real), {table}_places, sizeof({table}_rows)/sizeof(mbs_real), {table}_rows"
        )
    }

    pub(super) fn tree(&self, tree: &Tree) -> String {
        self.within(tree, Precedence::Choice)
    }

    fn within(&self, tree: &Tree, least: Precedence) -> String {
        use Precedence::{And, Choice, Comparison, Primary, Product, Sign, Sum};
        let binary = |a: &Tree, sign: &str, b: &Tree, own: Precedence, right: Precedence| {
            (own, format!("{} {sign} {}", self.within(a, own), self.within(b, right)))
        };
        let (precedence, text) = match tree {
            Tree::Constant(value) => (Primary, constant(*value)),
            Tree::Hoisted(_) => (Primary, format!("{}{}", self.own, identifier(self.body.name(tree)))),
            Tree::Symbol(_) | Tree::Local(_) => (Primary, identifier(self.body.name(tree))),
            Tree::Neg(a) => (Sign, format!("-{}", self.within(a, Primary))),
            Tree::Add(a, b) => binary(a, "+", b, Sum, Product),
            Tree::Sub(a, b) => binary(a, "-", b, Sum, Product),
            Tree::Mul(a, b) => binary(a, "*", b, Product, Sign),
            Tree::Div(a, b) => binary(a, "/", b, Product, Sign),
            Tree::Less(a, b) => binary(a, "<", b, Comparison, Sum),
            Tree::LessEqual(a, b) => binary(a, "<=", b, Comparison, Sum),
            Tree::And(a, b) => binary(a, "&&", b, And, Comparison),
            Tree::Not(a) => (Sign, format!("!{}", self.within(a, Primary))),
            Tree::Select(c, a, b) => {
                let [c, a, b] = [c, a, b].map(|part| self.within(part, And));
                (Choice, format!("{c} ? {a} : {b}"))
            }
            Tree::Method("mul_add", a, rest) => return self.within(&unfused(a, rest), least),
            Tree::Method(name, a, rest) => {
                let arguments: Vec<String> = std::iter::once(&**a).chain(rest).map(|part| self.tree(part)).collect();
                (Primary, format!("mbs_{name}({})", arguments.join(", ")))
            }
        };
        if precedence < least { format!("({text})") } else { text }
    }
}
