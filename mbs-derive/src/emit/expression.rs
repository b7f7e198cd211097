//! Expressions as they will stand in the text, in any language.
//!
//! The constructors choose among the ways to write the same
//! bits: factors and terms may change places (`a·b = b·a`, `a + b = b + a`), signs may move (`−(a·b) = (−a)·b`,
//! `a − b = a + (−b)`), but nothing is associated anew. A product that only a sum uses becomes `mul_add`, which is a
//! product and a sum, unless the target has them in one instruction.

use crate::expr::Symbol;

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
    pub(super) fn is_negative(&self) -> bool {
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

    /// The same operations with other leaves, which are asked for in the order of [`each_leaf`](Self::each_leaf).
    pub(super) fn with_leaves(&self, other: &mut dyn FnMut(&Tree) -> Tree) -> Tree {
        let mut of = |tree: &Tree| tree.with_leaves(other);
        let mut boxed = |tree: &Tree| Box::new(of(tree));
        match self {
            Tree::Constant(_) | Tree::Symbol(_) | Tree::Hoisted(_) | Tree::Local(_) => other(self),
            Tree::Neg(a) => Tree::Neg(boxed(a)),
            Tree::Not(a) => Tree::Not(boxed(a)),
            Tree::Add(a, b) => Tree::Add(boxed(a), boxed(b)),
            Tree::Sub(a, b) => Tree::Sub(boxed(a), boxed(b)),
            Tree::Mul(a, b) => Tree::Mul(boxed(a), boxed(b)),
            Tree::Div(a, b) => Tree::Div(boxed(a), boxed(b)),
            Tree::Less(a, b) => Tree::Less(boxed(a), boxed(b)),
            Tree::LessEqual(a, b) => Tree::LessEqual(boxed(a), boxed(b)),
            Tree::And(a, b) => Tree::And(boxed(a), boxed(b)),
            Tree::Select(c, a, b) => Tree::Select(boxed(c), boxed(a), boxed(b)),
            Tree::Method(name, a, rest) => {
                Tree::Method(name, boxed(a), rest.iter().map(|tree| tree.with_leaves(other)).collect())
            }
        }
    }

    /// Calls `found` with every leaf.
    pub(super) fn each_leaf<'t>(&'t self, found: &mut impl FnMut(&'t Tree)) {
        match self.children().as_slice() {
            [] => found(self),
            children => children.iter().for_each(|child| child.each_leaf(found)),
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
