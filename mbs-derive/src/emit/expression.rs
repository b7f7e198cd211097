//! How values are written.
//!
//! A [`Tree`] is an expression as it will stand in the text. The constructors choose among the ways to write the same
//! bits: factors and terms may change places (`a·b = b·a`, `a + b = b + a`), signs may move (`−(a·b) = (−a)·b`,
//! `a − b = a + (−b)`), but nothing is associated anew. A product that only a sum uses becomes `mul_add`, which is a
//! product and a sum, unless the target has them in one instruction.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::expr::Symbol;

use super::name::ident;

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    Constant(f64),
    Symbol(Symbol),
    /// A field of the mechanism.
    Hoisted(u32),
    /// A local of the function.
    Local(usize),
    /// `−a`
    Neg(Box<Tree>),
    Add(Box<Tree>, Box<Tree>),
    Sub(Box<Tree>, Box<Tree>),
    Mul(Box<Tree>, Box<Tree>),
    Div(Box<Tree>, Box<Tree>),
    /// `a.method(arguments)`
    Method(&'static str, Box<Tree>, Vec<Tree>),
    /// `a < b`, a condition
    Less(Box<Tree>, Box<Tree>),
    /// `a <= b`, a condition
    LessEqual(Box<Tree>, Box<Tree>),
    /// Both conditions hold
    And(Box<Tree>, Box<Tree>),
    /// The condition does not hold
    Not(Box<Tree>),
    /// `if condition { a } else { b }`
    Select(Box<Tree>, Box<Tree>, Box<Tree>),
}

/// How tightly an expression holds together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Any,
    Sum,
    Product,
    Sign,
    Method,
}

impl Tree {
    /// `−a`
    pub(super) fn neg(a: Tree) -> Tree {
        match a {
            Tree::Constant(value) => Tree::Constant(-value),
            Tree::Neg(a) => *a,
            Tree::Mul(a, b) => Tree::Mul(Box::new(Tree::neg(*a)), b),
            Tree::Div(a, b) => Tree::Div(Box::new(Tree::neg(*a)), b),
            other => Tree::Neg(Box::new(other)),
        }
    }

    /// `a · b`, constants and parameters first, then in the order of the declaration.
    pub(super) fn mul(a: Tree, b: Tree) -> Tree {
        match (a, b) {
            (Tree::Neg(a), Tree::Neg(b)) => Tree::mul(*a, *b),
            (Tree::Neg(a), b) | (b, Tree::Neg(a)) => match Tree::mul(*a, b) {
                Tree::Mul(a, b) => Tree::Mul(Box::new(Tree::neg(*a)), b),
                other => Tree::neg(other),
            },
            (a, b) => {
                let keep = match (a.is_product(), b.is_product()) {
                    // `k * (x * y)`, but `x * y * z` for `z * (x * y)`.
                    (false, true) => a.key() < b.key(),
                    (true, false) => b.key() >= a.key(),
                    (true, true) | (false, false) => a.key() <= b.key(),
                };
                let (a, b) = if keep { (a, b) } else { (b, a) };
                Tree::Mul(Box::new(a), Box::new(b))
            }
        }
    }

    /// `a / b`
    pub(super) fn div(a: Tree, b: Tree) -> Tree {
        match (a, b) {
            (Tree::Neg(a), Tree::Neg(b)) => Tree::div(*a, *b),
            (a, Tree::Neg(b)) => Tree::div(Tree::neg(a), *b),
            (a, b) => Tree::Div(Box::new(a), Box::new(b)),
        }
    }

    /// `a + b`
    pub(super) fn add(a: Tree, b: Tree) -> Tree {
        match (a, b) {
            (a, Tree::Neg(b)) | (Tree::Neg(b), a) => Tree::sub(a, *b),
            (a @ Tree::Mul(..), b @ Tree::Mul(..)) if b.key() < a.key() => Tree::add(b, a),
            (Tree::Mul(a, b), c) | (c, Tree::Mul(a, b)) => Tree::mul_add(*a, *b, c),
            (a, b) if b.is_sum() && !a.is_sum() => Tree::Add(Box::new(b), Box::new(a)),
            (a, b) if a.is_free() && b.is_free() && b.key() < a.key() => Tree::Add(Box::new(b), Box::new(a)),
            (a, b) => Tree::Add(Box::new(a), Box::new(b)),
        }
    }

    /// `a − b`
    pub(super) fn sub(a: Tree, b: Tree) -> Tree {
        match (a, b) {
            (a, Tree::Neg(b)) => Tree::add(a, *b),
            (Tree::Mul(a, b), c) => Tree::mul_add(*a, *b, Tree::neg(c)),
            (c, Tree::Mul(a, b)) if a.is_negative() => Tree::mul_add(Tree::neg(*a), *b, c),
            (c, Tree::Mul(a, b)) if a.is_compound() && !b.is_compound() => Tree::mul_add(*b, Tree::neg(*a), c),
            (c, Tree::Mul(a, b)) => Tree::mul_add(*a, Tree::neg(*b), c),
            (a, b) => Tree::Sub(Box::new(a), Box::new(b)),
        }
    }

    /// `a · b + c`
    fn mul_add(a: Tree, b: Tree, c: Tree) -> Tree {
        let (a, b) = if a.is_compound() && !b.is_compound() { (b, a) } else { (a, b) };
        Tree::Method("mul_add", Box::new(a), vec![b, c])
    }

    /// Whether it has a sign, which may go.
    fn is_negative(&self) -> bool {
        match self {
            Tree::Constant(value) => *value < 0.0,
            Tree::Neg(_) => true,
            Tree::Mul(a, _) | Tree::Div(a, _) => a.is_negative(),
            Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) | Tree::Add(..) | Tree::Sub(..) | Tree::Method(..) => {
                false
            }
            Tree::Less(..) | Tree::LessEqual(..) | Tree::And(..) | Tree::Not(_) | Tree::Select(..) => false,
        }
    }

    fn is_sum(&self) -> bool {
        matches!(self, Tree::Add(..) | Tree::Sub(..))
    }

    fn is_product(&self) -> bool {
        matches!(self, Tree::Mul(..) | Tree::Div(..))
    }

    /// Whether it would need parentheses before a method.
    fn is_compound(&self) -> bool {
        self.is_sum() || self.is_product() || self.is_negative()
    }

    /// Whether it costs nothing to write it more than once.
    pub(super) fn is_free(&self) -> bool {
        match self {
            Tree::Constant(_) | Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => true,
            Tree::Neg(a) | Tree::Not(a) => a.is_free(),
            // A condition is written again wherever it is asked: a comparison of what is known.
            Tree::Less(a, b) | Tree::LessEqual(a, b) | Tree::And(a, b) => a.is_free() && b.is_free(),
            Tree::Add(..) | Tree::Sub(..) | Tree::Mul(..) | Tree::Div(..) | Tree::Method(..) | Tree::Select(..) => {
                false
            }
        }
    }

    /// Its parts.
    pub(super) fn children(&self) -> Vec<&Tree> {
        match self {
            Tree::Constant(_) | Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => Vec::new(),
            Tree::Neg(a) | Tree::Not(a) => vec![a],
            Tree::Add(a, b)
            | Tree::Sub(a, b)
            | Tree::Mul(a, b)
            | Tree::Div(a, b)
            | Tree::Less(a, b)
            | Tree::LessEqual(a, b)
            | Tree::And(a, b) => {
                vec![a, b]
            }
            Tree::Select(c, a, b) => vec![c, a, b],
            Tree::Method(_, a, rest) => std::iter::once(&**a).chain(rest).collect(),
        }
    }

    /// Number of operations; signs are free.
    pub(super) fn operations(&self) -> usize {
        let own = match self {
            Tree::Constant(_) | Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) | Tree::Neg(_) => 0,
            Tree::Not(_) => 0,
            Tree::Add(..) | Tree::Sub(..) | Tree::Mul(..) | Tree::Div(..) | Tree::And(..) => 1,
            Tree::Less(..) | Tree::LessEqual(..) | Tree::Select(..) => 1,
            Tree::Method(_, _, arguments) => arguments.len().max(1),
        };
        own + self.children().into_iter().map(Tree::operations).sum::<usize>()
    }

    /// Where it stands among factors: by its first part.
    fn key(&self) -> (u8, u64) {
        match self {
            Tree::Constant(_) => (0, 0),
            Tree::Symbol(Symbol::Parameter(i)) => (1, u64::from(*i)),
            Tree::Hoisted(k) => (1, (1 << 32) + u64::from(*k)),
            Tree::Symbol(Symbol::Time) => (2, 0),
            Tree::Symbol(Symbol::Coordinate(i)) => (2, (1 << 32) + u64::from(*i)),
            Tree::Symbol(Symbol::Velocity(i)) => (2, (2 << 32) + u64::from(*i)),
            Tree::Symbol(Symbol::Acceleration(i)) => (2, (3 << 32) + u64::from(*i)),
            Tree::Symbol(Symbol::Input(i)) => (2, (4 << 32) + u64::from(*i)),
            Tree::Symbol(Symbol::Prescribed(i, order)) => (2, ((5 + u64::from(*order)) << 32) + u64::from(*i)),
            Tree::Symbol(Symbol::Multiplier(i)) => (2, (8 << 32) + u64::from(*i)),
            Tree::Local(i) => (3, *i as u64),
            Tree::Neg(a) | Tree::Mul(a, _) | Tree::Div(a, _) => a.key(),
            Tree::Method(..) | Tree::Less(..) | Tree::LessEqual(..) => (4, 0),
            Tree::And(..) | Tree::Not(_) | Tree::Select(..) => (4, 0),
            Tree::Add(..) | Tree::Sub(..) => (5, 0),
        }
    }
}

/// How the leaves of a tree are written.
pub(super) trait Leaves {
    /// A constant's tokens, a method may follow; a negative one may come out as its sign and the positive one.
    fn constant(&self, value: f64) -> TokenStream;
    /// Whether a negative constant comes out with its sign in front.
    fn is_signed(&self, value: f64) -> bool;
    /// The name of a symbol, a hoisted value or a local; of a value computed on demand `*name`.
    fn leaf(&self, leaf: &Tree) -> TokenStream;
    /// Whether that is a value computed on demand.
    fn is_on_demand(&self, leaf: &Tree) -> bool;
    /// Whether `a.mul_add(b, c)` is written `a * b + c`.
    fn is_infix(&self) -> bool;
}

/// The tokens of an expression.
pub(super) fn print(tree: &Tree, leaves: &impl Leaves) -> TokenStream {
    within(tree, leaves, Precedence::Any)
}

fn within(tree: &Tree, leaves: &impl Leaves, least: Precedence) -> TokenStream {
    let (precedence, tokens) = match tree {
        Tree::Constant(value) => {
            let signed = leaves.is_signed(*value);
            (if signed { Precedence::Sign } else { Precedence::Method }, leaves.constant(*value))
        }
        Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => {
            let starred = leaves.is_on_demand(tree);
            (if starred { Precedence::Sign } else { Precedence::Method }, leaves.leaf(tree))
        }
        Tree::Neg(a) => {
            let a = within(a, leaves, Precedence::Method);
            (Precedence::Sign, quote!(-#a))
        }
        Tree::Add(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Sum), within(b, leaves, Precedence::Product));
            (Precedence::Sum, quote!(#a + #b))
        }
        Tree::Sub(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Sum), within(b, leaves, Precedence::Product));
            (Precedence::Sum, quote!(#a - #b))
        }
        Tree::Mul(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Product), within(b, leaves, Precedence::Sign));
            (Precedence::Product, quote!(#a * #b))
        }
        Tree::Div(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Product), within(b, leaves, Precedence::Sign));
            (Precedence::Product, quote!(#a / #b))
        }
        Tree::Less(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Method), print(b, leaves));
            (Precedence::Method, quote!(#a.less(#b)))
        }
        Tree::LessEqual(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Method), print(b, leaves));
            (Precedence::Method, quote!(#a.less_equal(#b)))
        }
        Tree::And(a, b) => {
            let (a, b) = (within(a, leaves, Precedence::Method), within(b, leaves, Precedence::Method));
            (Precedence::Any, quote!(#a & #b))
        }
        Tree::Not(a) => {
            let a = within(a, leaves, Precedence::Method);
            (Precedence::Sign, quote!(!#a))
        }
        Tree::Select(c, a, b) => {
            let known = [a, b].iter().all(|side| side.is_free() && !asks(side, leaves));
            let [c, a, b] = [c, a, b].map(|part| print(part, leaves));
            let select = if known { quote!(T::blend(#c, #a, #b)) } else { quote!(T::select(#c, || #a, || #b)) };
            (Precedence::Method, select)
        }
        Tree::Method("mul_add", a, rest) if leaves.is_infix() => return within(&unfused(a, rest), leaves, least),
        Tree::Method(name, a, arguments) => {
            let (name, a) = (ident(name), within(a, leaves, Precedence::Method));
            let arguments = arguments.iter().map(|argument| print(argument, leaves));
            (Precedence::Method, quote!(#a.#name(#(#arguments),*)))
        }
    };
    if precedence < least { quote!((#tokens)) } else { tokens }
}

/// `a · b + c` as a sum, or as a difference where a sign allows it.
pub(super) fn unfused(a: &Tree, rest: &[Tree]) -> Tree {
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

/// Whether a value that is computed on demand is in it.
fn asks(tree: &Tree, leaves: &impl Leaves) -> bool {
    leaves.is_on_demand(tree) || tree.children().into_iter().any(|part| asks(part, leaves))
}

/// The shortest literal that reads back as `value`, its sign in front.
pub(super) fn literal(value: f64) -> TokenStream {
    assert!(value.is_finite(), "constants are finite");
    let digits: Literal = format!("{:?}", value.abs()).parse().expect("Rust's floats print as literals");
    if value.is_sign_negative() { quote!(-#digits) } else { quote!(#digits) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether infix.
    struct Plain(bool);

    impl Leaves for Plain {
        fn constant(&self, value: f64) -> TokenStream {
            literal(value)
        }
        fn is_signed(&self, value: f64) -> bool {
            value.is_sign_negative()
        }
        fn leaf(&self, leaf: &Tree) -> TokenStream {
            match leaf {
                Tree::Local(0) => quote!(a),
                Tree::Local(1) => quote!(b),
                Tree::Local(2) => quote!(c),
                Tree::Local(3) => quote!(d),
                _ => quote!(k),
            }
        }
        fn is_on_demand(&self, _: &Tree) -> bool {
            false
        }
        fn is_infix(&self) -> bool {
            self.0
        }
    }

    #[track_caller]
    fn check(tree: Tree, expected: &str) {
        check_as(&tree, &Plain(false), expected);
    }

    #[track_caller]
    fn check_as(tree: &Tree, leaves: &Plain, expected: &str) {
        let expected: TokenStream = expected.parse().unwrap();
        assert_eq!(print(tree, leaves).to_string(), expected.to_string());
    }

    #[test]
    fn association_is_kept_and_parentheses_are_few() {
        let [a, b, c, d] = [0, 1, 2, 3].map(Tree::Local);
        let k = || Tree::Hoisted(0);
        check(Tree::mul(c.clone(), Tree::mul(b.clone(), a.clone())), "a * b * c");
        check(Tree::mul(Tree::mul(b.clone(), a.clone()), k()), "k * (a * b)");
        check(Tree::mul(Tree::mul(a.clone(), b.clone()), Tree::mul(c.clone(), d.clone())), "a * b * (c * d)");
        check(Tree::mul(Tree::add(a.clone(), b.clone()), c.clone()), "c * (a + b)");
        check(Tree::sub(a.clone(), Tree::sub(b.clone(), c.clone())), "a - (b - c)");
        check(Tree::add(a.clone(), Tree::sub(b.clone(), c.clone())), "b - c + a");
        check(Tree::div(a.clone(), Tree::mul(b.clone(), c.clone())), "a / (b * c)");
        check(Tree::Method("sqrt", Box::new(Tree::sub(a, b)), Vec::new()), "(a - b).sqrt()");
    }

    #[test]
    fn signs_move_where_they_cost_nothing() {
        let [a, b, c, _] = [0, 1, 2, 3].map(Tree::Local);
        let minus = |x: &Tree| Tree::neg(x.clone());
        check(Tree::mul(minus(&a), minus(&b)), "a * b");
        check(Tree::mul(a.clone(), minus(&b)), "-a * b");
        check(Tree::add(a.clone(), minus(&b)), "a - b");
        check(Tree::sub(a.clone(), minus(&b)), "a + b");
        check(Tree::neg(Tree::div(a.clone(), b.clone())), "-a / b");
        check(Tree::neg(Tree::sub(a, b)), "-(a - b)");
        check(Tree::mul(Tree::Constant(-2.0), c), "-2.0 * c");
    }

    #[test]
    fn a_product_in_a_sum_is_fused() {
        let [a, b, c, d] = [0, 1, 2, 3].map(Tree::Local);
        let ab = || Tree::mul(a.clone(), b.clone());
        check(Tree::add(ab(), c.clone()), "a.mul_add(b, c)");
        check(Tree::add(c.clone(), ab()), "a.mul_add(b, c)");
        check(Tree::sub(ab(), c.clone()), "a.mul_add(b, -c)");
        check(Tree::sub(c.clone(), ab()), "a.mul_add(-b, c)");
        check(Tree::sub(ab(), Tree::mul(c.clone(), d.clone())), "a.mul_add(b, -c * d)");
        check(Tree::sub(d.clone(), Tree::mul(c.clone(), ab())), "c.mul_add(-a * b, d)");
        check(Tree::sub(c, Tree::mul(Tree::Constant(2.0), a)), "2.0.mul_add(-a, c)");
    }

    #[test]
    fn for_review_it_is_a_sum_again() {
        let [a, b, c, d] = [0, 1, 2, 3].map(Tree::Local);
        let ab = || Tree::mul(a.clone(), b.clone());
        for (tree, expected) in [
            (Tree::add(ab(), c.clone()), "a * b + c"),
            (Tree::sub(ab(), c.clone()), "a * b - c"),
            (Tree::sub(c.clone(), ab()), "c - a * b"),
            (Tree::sub(ab(), Tree::mul(c.clone(), d.clone())), "a * b - c * d"),
            (Tree::sub(d.clone(), Tree::mul(c.clone(), ab())), "d - c * (a * b)"),
            (Tree::add(ab(), Tree::add(c.clone(), d.clone())), "a * b + (c + d)"),
            (Tree::mul(Tree::add(ab(), c.clone()), d.clone()), "d * (a * b + c)"),
        ] {
            check_as(&tree, &Plain(true), expected);
        }
    }

    #[test]
    fn literals_are_shortest_and_read_back() {
        for (value, expected) in
            [(0.5, "0.5"), (2.0, "2.0"), (1e300, "1e300"), (5e-324, "5e-324"), (0.295242, "0.295242")]
        {
            assert_eq!(literal(value).to_string(), expected);
            assert_eq!(expected.parse(), Ok(value));
        }
        assert_eq!(literal(-0.1).to_string(), "- 0.1");
    }
}
