//! What is computed when: once per set of parameters, or at each call.

use crate::expr::graph::IdMap;
use crate::expr::{Expr, Graph, Id, Node, Symbol, normal_form};

use super::lower;
use super::program::Program;

/// Longer polynomials of parameters are taken as they are.
const MOST_TERMS: usize = 40;

/// The nodes that depend on parameters alone and are computed by the constructor.
pub struct Hoisting {
    numbers: IdMap<u32>,
    /// From parameters to the hoisted values, in the order of their numbers.
    pub constructor: Program,
}

impl Hoisting {
    /// No hoisting: the constructor itself is scheduled so.
    pub fn none() -> Self {
        Hoisting { numbers: IdMap::default(), constructor: Program::default() }
    }

    /// Finds the largest subexpressions of parameters alone that the functions use.
    pub fn of<'g, 'r>(functions: impl Iterator<Item = &'r [Expr<'g>]>) -> Self
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
                    *by_value.entry(value(graph.expr(id)).id()).or_insert_with(|| {
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
    pub fn number(&self, id: Id) -> Option<u32> {
        self.numbers.get(&id).copied()
    }
}

/// One expression for all ways to multiply and add the same parameters, so that `(m g) l` and `m (g l)` are one value.
fn value(expr: Expr<'_>) -> Expr<'_> {
    normal_form(&[expr], MOST_TERMS).map_or(expr, |forms| forms[0])
}

/// What a node depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Dependence {
    Constant,
    Parameters,
    State,
}

/// The parameter-only nodes that are roots or operands of nodes that are not, operations only, in order of their numbers.
fn candidates(graph: &Graph, roots: &[Expr<'_>]) -> Vec<Id> {
    let order = graph.reachable(roots.iter().map(|root| root.id()));
    let mut dependence: IdMap<Dependence> = IdMap::default();
    for &id in &order {
        let value = match graph.node(id) {
            Node::Constant(_) => Dependence::Constant,
            Node::Symbol(Symbol::Parameter(_)) => Dependence::Parameters,
            Node::Symbol(_) => Dependence::State,
            node => node.operands().map(|operand| dependence[&operand]).max().unwrap_or(Dependence::Constant),
        };
        dependence.insert(id, value);
    }
    let by_state = order.iter().filter(|id| dependence[id] == Dependence::State);
    let used = by_state.flat_map(|&id| graph.node(id).operands()).chain(roots.iter().map(|root| root.id()));
    let mut found: Vec<Id> = used
        .map(|id| behind_sign(graph, id))
        .filter(|id| dependence[id] == Dependence::Parameters && !matches!(graph.node(*id), Node::Symbol(_)))
        .collect();
    found.sort();
    found.dedup();
    found
}

/// A sign is free at its place of use, so it is not hoisted.
fn behind_sign(graph: &Graph, id: Id) -> Id {
    match graph.node(id) {
        Node::Neg(a) => a,
        _ => id,
    }
}
