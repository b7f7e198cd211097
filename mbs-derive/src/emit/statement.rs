//! Statements of a body, before they are printed in a language.

use std::collections::BTreeSet;

use crate::expr::Symbol;

use super::body::{FAMILIAR, familiar};
use super::expression::Tree;

/// A component of a result.
#[derive(Clone, Debug)]
pub(super) enum Component {
    /// The program's result with this number, and a name that it would have as a local; empty for none.
    Result(usize, String),
    /// 0
    Zero,
}

/// A step of a body.
#[derive(Clone, Debug)]
pub(super) enum Statement {
    /// `let local = tree;`
    Let(usize, Tree),
    /// `let ([sin_a, sin_b], [cos_a, cos_b]) = T::sin_cos_all([a, b]);`, of the library `let (sin, cos) = a.sin_cos();`
    SinCos(Vec<Angle>),
    /// `let [value, _, second] = TABLE_0.derivatives(x);`, of the orders that are read.
    Spline {
        /// Its number in [`Names`].
        table: usize,
        orders: Vec<usize>,
        locals: Vec<usize>,
        x: Tree,
    },
    /// `let local = T::select(condition, || …, || …);`, of several locals `let [a, b] = T::select_each(…);`
    Branch(Vec<usize>, Tree, [Block; 2]),
    /// `let local: &dyn Fn() -> T = &|| …; let local = LazyCell::new(local);`
    OnDemand(usize, Block),
}

impl Statement {
    /// The expressions in it.
    pub(super) fn trees(&self) -> Vec<&Tree> {
        match self {
            Statement::Let(_, tree) | Statement::Spline { x: tree, .. } => vec![tree],
            Statement::SinCos(angles) => angles.iter().map(|angle| &angle.tree).collect(),
            Statement::Branch(_, condition, [then, otherwise]) => {
                std::iter::once(condition).chain(then.trees()).chain(otherwise.trees()).collect()
            }
            Statement::OnDemand(_, block) => block.trees(),
        }
    }

    /// The locals that it binds.
    pub(super) fn binds(&self) -> Vec<usize> {
        match self {
            Statement::Let(local, _) | Statement::OnDemand(local, _) => vec![*local],
            Statement::SinCos(angles) => {
                angles.iter().flat_map(|angle| angle.sin.into_iter().chain(angle.cos)).collect()
            }
            Statement::Branch(locals, ..) | Statement::Spline { locals, .. } => locals.clone(),
        }
    }

    /// The locals that it reads, some of which blocks within it may bind.
    pub(super) fn reads(&self) -> BTreeSet<usize> {
        locals(self.trees())
    }

    /// The link that what it binds belongs to, by those of all locals.
    pub(super) fn link(&self, links: &[Option<usize>]) -> Option<usize> {
        self.binds().into_iter().find_map(|local| links[local])
    }
}

/// An angle, and the locals that its sine and cosine are bound to, as far as they are read.
#[derive(Clone, Debug)]
pub(super) struct Angle {
    pub(super) tree: Tree,
    pub(super) sin: Option<usize>,
    pub(super) cos: Option<usize>,
}

/// Statements, and what comes of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) statements: Vec<Statement>,
    pub(super) results: Vec<Tree>,
}

impl Block {
    /// The expressions in it, blocks within it included.
    pub(super) fn trees(&self) -> Vec<&Tree> {
        self.statements.iter().flat_map(Statement::trees).chain(&self.results).collect()
    }

    /// What it reads.
    pub(super) fn leaves(&self) -> Leaves {
        let mut leaves = Leaves::default();
        let mut found = |leaf: &Tree| match leaf {
            Tree::Symbol(symbol) => leaves.symbols.extend([*symbol]),
            Tree::Hoisted(k) => leaves.hoisted.extend([*k]),
            Tree::Constant(value) => *familiar(*value).map_or(&mut leaves.others, |i| &mut leaves.familiar[i]) += 1,
            _ => {}
        };
        self.trees().into_iter().for_each(|tree| tree.each_leaf(&mut found));
        leaves
    }
}

/// The locals in these expressions.
pub(super) fn locals<'t>(trees: impl IntoIterator<Item = &'t Tree>) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut leaf = |leaf: &Tree| {
        if let Tree::Local(local) = leaf {
            found.insert(*local);
        }
    };
    trees.into_iter().for_each(|tree| tree.each_leaf(&mut leaf));
    found
}

/// What a body reads but locals.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaves {
    pub(super) symbols: BTreeSet<Symbol>,
    pub(super) hoisted: BTreeSet<u32>,
    /// How often each of the familiar constants.
    pub(super) familiar: [usize; FAMILIAR.len()],
    /// How often others.
    pub(super) others: usize,
}
