//! The degree of expressions in the velocities, decided on the graph.
//!
//! Most degrees can be read off: that of a product is the sum of those of its factors, that of a sum the larger one of
//! its terms. Where that is too much, or a root or a quotient says nothing, the expression may still be of the degree,
//! because higher powers cancel: that is decided in a finite field ([`degree_is_at_most`]), where no term is too small
//! to be seen.

use std::collections::BTreeMap;

use crate::expr::{Expr, Graph, Id, Node, Symbol, Verdict, degree_is_at_most};

/// The numbers of the terms that are not polynomials of at most this degree in the velocities, the same one at all of
/// them; where that cannot be decided, those for which `seems` says so.
pub(in crate::model) fn beyond(degree: usize, terms: &[Expr<'_>], seems: impl Fn(usize) -> bool) -> Vec<usize> {
    let Some(first) = terms.first() else { return Vec::new() };
    let bounds = bounds(first.graph(), terms);
    let is_beyond = |&term: &usize| {
        if bounds[&terms[term].id()].is_some_and(|bound| bound <= degree) {
            return false;
        }
        match degree_is_at_most(degree, terms[term], |symbol| matches!(symbol, Symbol::Velocity(_))) {
            Verdict::Holds => false,
            Verdict::Fails => true,
            Verdict::Undecided => seems(term),
        }
    };
    (0..terms.len()).filter(is_beyond).collect()
}

/// The numbers of the terms whose degree cannot be read off.
pub(in crate::model) fn unbounded(terms: &[Expr<'_>]) -> Vec<usize> {
    let Some(first) = terms.first() else { return Vec::new() };
    let bounds = bounds(first.graph(), terms);
    (0..terms.len()).filter(|&term| bounds[&terms[term].id()].is_none()).collect()
}

/// Degrees that nodes do not exceed; `None` where nothing is known.
fn bounds(graph: &Graph, roots: &[Expr<'_>]) -> BTreeMap<Id, Option<usize>> {
    let mut known: BTreeMap<Id, Option<usize>> = BTreeMap::new();
    for id in graph.reachable(roots.iter().map(|root| root.id())) {
        let node = graph.node(id);
        let of = |a: Id| known[&a];
        let are_all_zero = node.operands().all(|a| of(a) == Some(0));
        let sum = |a: Option<usize>, b: Option<usize>| a?.checked_add(b?);
        let larger = |a: Option<usize>, b: Option<usize>| Some(a?.max(b?));
        let bound = match node {
            Node::Symbol(Symbol::Velocity(_)) => Some(1),
            Node::Constant(_) | Node::Symbol(_) => Some(0),
            // Where the coordinates stand still, their functions do.
            Node::Rate(_) => are_all_zero.then_some(1),
            _ if are_all_zero => Some(0),
            Node::Neg(a) => of(a),
            Node::Add(a, b) | Node::Sub(a, b) => larger(of(a), of(b)),
            Node::Mul(a, b) => sum(of(a), of(b)),
            Node::Power(a, n) => power(of(a), n.to_integer()),
            Node::Select(condition, a, b) if of(condition) == Some(0) => larger(of(a), of(b)),
            Node::Call(..)
            | Node::Call2(..)
            | Node::Spline(..)
            | Node::Less(..)
            | Node::LessEqual(..)
            | Node::And(..)
            | Node::Not(_)
            | Node::Select(..) => None,
        };
        known.insert(id, bound);
    }
    known
}

fn power(base: Option<usize>, exponent: Option<i32>) -> Option<usize> {
    base?.checked_mul(usize::try_from(exponent?).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_read_off_where_they_can_be() {
        let graph = Graph::verbatim();
        let x = graph.symbol(Symbol::Coordinate(0));
        let (v, c) = (x.rate(), graph.symbol(Symbol::Parameter(0)));
        let bound = |expr: Expr<'_>| bounds(&graph, &[expr])[&expr.id()];
        assert_eq!(bound(x.sin().sqrt() / c), Some(0));
        assert_eq!(bound(c * (x.sin() * v - v).powi(2) + x), Some(2));
        assert_eq!(bound(graph.select(x.less(c), v, v.powi(3))), Some(3));
        assert_eq!(bound((v * v).sqrt().powi(2)), None);
        assert_eq!(bound(c / v), None);
        assert_eq!(bound(graph.select(v.less(c), v, v)), None);
        let terms = [v.powi(2), v.powi(3), (v * v).sqrt().powi(2), v.sin(), v.powi(3) / v];
        assert_eq!(beyond(2, &terms, |_| false), [1, 3]);
    }
}
