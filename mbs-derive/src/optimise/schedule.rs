//! What is computed when: once per set of parameters, or at each call.

use crate::expr::graph::IdMap;
use crate::expr::table::Table;
use crate::expr::{Expr, Function, Graph, Id, Kept, Node, Symbol, normal_form};

use super::lower;
use super::program::Program;

/// Longer polynomials of parameters are taken as they are.
const MOST_TERMS: usize = 40;

/// The nodes that depend on parameters alone and are computed by the constructor.
pub(crate) struct Hoisting {
    numbers: IdMap<u32>,
    /// From parameters to the hoisted values, in the order of their numbers.
    pub constructor: Program,
}

impl Hoisting {
    /// No hoisting: the constructor itself is scheduled so.
    pub(crate) fn none() -> Self {
        Hoisting { numbers: IdMap::default(), constructor: Program::default() }
    }

    /// Finds the largest subexpressions of parameters alone that the functions use.
    pub(crate) fn of<'g, 'r>(functions: impl Iterator<Item = &'r [Expr<'g>]>, forms: &mut Forms) -> Self
    where
        'g: 'r,
    {
        let mut hoisted: Vec<Expr<'g>> = Vec::new();
        let mut numbers: IdMap<u32> = IdMap::default();
        let mut by_value: IdMap<u32> = IdMap::default();
        for roots in functions {
            let Some(first) = roots.first() else { continue };
            let graph = first.graph();
            for id in candidates(graph, roots) {
                numbers.entry(id).or_insert_with(|| {
                    *by_value.entry(forms.form(graph.expr(id))).or_insert_with(|| {
                        hoisted.push(graph.expr(id));
                        hoisted.len() as u32 - 1
                    })
                });
            }
        }
        let constructor =
            if hoisted.is_empty() { Program::default() } else { lower::program(&hoisted, &Hoisting::none()) };
        Hoisting { numbers, constructor }
    }

    /// The number of a hoisted node.
    pub(crate) fn number(&self, id: Id) -> Option<u32> {
        self.numbers.get(&id).copied()
    }
}

/// One expression for all ways to multiply and add the same parameters, so that `(m g) l` and `m (g l)` are one value.
/// Each is found once.
#[derive(Default)]
pub(crate) struct Forms(IdMap<Id>);

impl Forms {
    fn form(&mut self, expr: Expr<'_>) -> Id {
        // `(a − b)²` is not taken for `a² − 2 a b + b²`, though it is the same: one of them has lost digits.
        let kept = || Kept::default().and_constants_of(&[expr]);
        let form = || normal_form(&[expr], &kept(), MOST_TERMS).map_or(expr, |forms| forms[0]).id();
        *self.0.entry(expr.id()).or_insert_with(form)
    }
}

/// What a node depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Dependence {
    Constant,
    Parameters,
    State,
}

/// The largest parameter-only operations that the roots are made of, in order of their numbers. What only some side of
/// a branch needs is among them where it has a value whatever the parameters are.
fn candidates(graph: &Graph, roots: &[Expr<'_>]) -> Vec<Id> {
    let order = graph.reachable(roots.iter().map(|root| root.id()));
    if !order.iter().any(|id| matches!(graph.node(*id), Node::Symbol(Symbol::Parameter(_)))) {
        return Vec::new();
    }
    let facts = facts(graph, &order);
    let mut certain: Table<Option<bool>> = Table::new(&order, None);
    roots.iter().for_each(|root| certain[root.id()] = Some(true));
    let mut found: Vec<Id> = Vec::new();
    for &id in order.iter().rev() {
        let Some(needed) = certain[id] else { continue };
        let (dependence, total) = facts[id];
        let is_number = !is_condition(graph.node(id));
        if dependence == Dependence::Parameters && is_number && (needed || total) {
            found.extend(Some(behind_sign(graph, id)).filter(|id| !matches!(graph.node(*id), Node::Symbol(_))));
            continue;
        }
        let arms = match graph.node(id) {
            Node::Select(condition, _, _) => Some(condition),
            _ => None,
        };
        for operand in graph.node(id).operands() {
            let needed = needed && arms.is_none_or(|condition| condition == operand);
            certain[operand] = Some(needed || certain[operand] == Some(true));
        }
    }
    found.sort();
    found.dedup();
    found
}

/// What each node depends on, and whether it has a value for all values of the symbols.
fn facts(graph: &Graph, order: &[Id]) -> Table<(Dependence, bool)> {
    let mut facts = Table::new(order, (Dependence::Constant, false));
    for &id in order {
        let node = graph.node(id);
        let dependence = match node {
            Node::Constant(_) => Dependence::Constant,
            Node::Symbol(Symbol::Parameter(_)) => Dependence::Parameters,
            Node::Symbol(_) => Dependence::State,
            _ => node.operands().map(|operand| facts[operand].0).max().unwrap_or(Dependence::Constant),
        };
        let total = is_total(node) && node.operands().all(|operand| facts[operand].1);
        facts[id] = (dependence, total);
    }
    facts
}

/// Whether it is true or false, which the fields of a mechanism do not hold.
fn is_condition(node: Node) -> bool {
    matches!(node, Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_))
}

/// Whether an operation has a value for all values of its operands.
fn is_total(node: Node) -> bool {
    match node {
        Node::Constant(_) | Node::Symbol(_) | Node::Neg(_) | Node::Add(..) | Node::Sub(..) | Node::Mul(..) => true,
        Node::Power(_, n) => n.to_integer().is_some_and(|n| n > 0),
        Node::Call(function, _) => matches!(function, Function::Sin | Function::Cos),
        Node::Spline(..) => true,
        Node::Rate(_) | Node::Call2(..) | Node::Select(..) => false,
        Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => false,
    }
}

/// A sign is free at its place of use, so it is not hoisted.
fn behind_sign(graph: &Graph, id: Id) -> Id {
    match graph.node(id) {
        Node::Neg(a) => a,
        _ => id,
    }
}
