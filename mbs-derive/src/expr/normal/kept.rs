//! Sums that stay factors: the differences that springs, dampers and forces were written with.
//!
//! `k (r − r₀)` is exact where r is near r₀, and so is `(r − r₀)²`; `k r − k r₀` and `r² − 2 r r₀ + r₀²` have lost the digits that the two
//! share. So a sum that an energy or a force takes in a product, a power or a function is one symbol wherever it is
//! multiplied, in all that is derived from it. Where it is only added to others, its terms are added to theirs. A sum of terms that
//! parameters scale, `b z − c y`, is rounded in each of them as it stands: other factors that are constant in time may join these.

use std::cell::RefCell;
use std::collections::BTreeMap;

use crate::expr::{Expr, Function, Graph, Id, Node};

/// The nodes that stay factors.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// With whether they do so beside what is constant in time, too. Those that are written anew join them.
    sums: RefCell<BTreeMap<Id, bool>>,
}

impl Kept {
    /// The sums that these energies are not linear in, and that these forces are made of.
    pub fn of(energies: &[Expr<'_>], forces: &[Expr<'_>]) -> Self {
        let kept = Kept::default();
        for (roots, is_force) in [(energies, false), (forces, true)] {
            let Some(graph) = roots.first().map(|root| root.graph()) else { continue };
            for id in graph.reachable(roots.iter().map(|root| root.id())) {
                for (sum, is_scaled) in factors(graph, id).into_iter().flatten() {
                    let has_digits = has_digits(graph, sum);
                    // Weight falls with the height, whatever that is measured from.
                    if !is_scaled || (is_force && has_digits) {
                        kept.sums.borrow_mut().insert(sum, has_digits);
                    }
                }
            }
        }
        kept
    }

    /// And the differences of parameters that these expressions multiply, as of lengths: `(a − b) x`.
    pub fn and_constants_of(self, expressions: &[Expr<'_>]) -> Self {
        let Some(graph) = expressions.first().map(|e| e.graph()) else { return self };
        for id in graph.reachable(expressions.iter().map(|e| e.id())) {
            let node = graph.node(id);
            if matches!(node, Node::Mul(..) | Node::Power(..)) {
                let behind_signs = node.operands().map(|operand| behind_sign(graph, operand));
                let is_difference = |id: &Id| graph.is_parametric(*id) && matches!(graph.node(*id), Node::Sub(..));
                self.sums.borrow_mut().extend(behind_signs.filter(is_difference).map(|difference| (difference, true)));
            }
        }
        self
    }

    /// That one of them is written as another node.
    pub(super) fn rewritten(&self, sum: Id, anew: Id) {
        let mut sums = self.sums.borrow_mut();
        if let Some(&has_digits) = sums.get(&sum) {
            sums.entry(anew).or_insert(has_digits);
        }
    }

    /// Whether a node is one of them, beside a factor that is constant in time or one that is not.
    pub(super) fn contains(&self, id: Id, beside_constant: bool) -> bool {
        self.sums.borrow().get(&id).is_some_and(|has_digits| *has_digits || !beside_constant)
    }
}

/// The sums that a node multiplies or takes as arguments, and whether it does no more than to scale them by what is constant in
/// time.
fn factors(graph: &Graph, id: Id) -> [Option<(Id, bool)>; 2] {
    let taken = |operand: Id| behind_parameters(graph, operand).map(|sum| (sum, false));
    match graph.node(id) {
        Node::Mul(a, b) => [(a, b), (b, a)]
            .map(|(operand, other)| behind_parameters(graph, operand).map(|sum| (sum, graph.is_parametric(other)))),
        // Multiples of a sum of angles are sums of multiples.
        Node::Call(Function::Sin | Function::Cos, a) if is_sum(graph, a) => [None, None],
        Node::Power(a, _) | Node::Call(_, a) => [taken(a), None],
        Node::Call2(_, a, b) => [taken(a), taken(b)],
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Less(..)
        | Node::LessEqual(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => [None, None],
    }
}

/// The sum that moves in `p (a + b)`, with a sign or without.
fn behind_parameters(graph: &Graph, mut id: Id) -> Option<Id> {
    loop {
        id = match graph.node(id) {
            Node::Neg(a) => a,
            Node::Mul(a, b) if graph.is_parametric(a) => b,
            Node::Mul(a, b) if graph.is_parametric(b) => a,
            Node::Add(..) | Node::Sub(..) if !graph.is_parametric(id) => return Some(id),
            _ => return None,
        }
    }
}

fn is_sum(graph: &Graph, id: Id) -> bool {
    matches!(graph.node(behind_sign(graph, id)), Node::Add(..) | Node::Sub(..))
}

fn behind_sign(graph: &Graph, id: Id) -> Id {
    if let Node::Neg(a) = graph.node(id) { a } else { id }
}

/// Whether a term is not scaled by a parameter, so that it may be exact, and a factor has no constant to join.
fn has_digits(graph: &Graph, sum: Id) -> bool {
    let is_scale = |id: Id| graph.is_parametric(id) && graph.expr(id).as_constant().is_none();
    let mut waiting = vec![sum];
    while let Some(id) = waiting.pop() {
        match graph.node(id) {
            Node::Add(a, b) | Node::Sub(a, b) => waiting.extend([a, b]),
            Node::Neg(a) => waiting.push(a),
            Node::Mul(a, b) if is_scale(a) || is_scale(b) => {}
            _ => return true,
        }
        // In loops a sum could double with each turn.
        if waiting.len() > 100 {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn factors_of_energies_and_forces_are_kept() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let kept = |energies: &[Expr<'_>], forces: &[Expr<'_>], sum: Expr<'_>| {
            let sum = if let Node::Neg(a) = sum.node() { a } else { sum.id() };
            Kept::of(energies, forces).contains(sum, true)
        };
        let stretch = x - rest;
        assert!(kept(&[k * stretch.powi(2)], &[], stretch));
        assert!(kept(&[-(k * stretch) * y], &[], stretch));
        assert!(kept(&[(k * stretch).call(Function::Exp)], &[], stretch));
        let distance = (x.powi(2) + y.powi(2)).sqrt() - rest;
        assert!(kept(&[k * distance.powi(2)], &[], distance));
        // Weight falls with the height, whatever that is measured from.
        assert!(!kept(&[k * stretch], &[], stretch));
        assert!(kept(&[], &[-(k * stretch)], stretch));
        let difference = k - rest;
        let kept = Kept::default().and_constants_of(&[difference.powi(2) * x, (k + rest) * y]);
        assert!(kept.contains(if let Node::Neg(a) = difference.node() { a } else { difference.id() }, true));
        assert!(!kept.contains((k + rest).id(), false));
    }

    #[test]
    fn factors_join_scaled_terms() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        // Scaled terms are rounded as they stand.
        let moment = k * x - rest * y;
        let id = if let Node::Neg(a) = moment.node() { a } else { moment.id() };
        assert!(!Kept::of(&[], &[k * moment]).contains(id, false));
        let squared = Kept::of(&[moment.powi(2)], &[]);
        assert!(squared.contains(id, false) && !squared.contains(id, true));
    }
}
