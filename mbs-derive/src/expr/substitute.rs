//! Copies expressions, replacing symbols, into the same or another graph; the target's local rules apply.

use std::collections::BTreeMap;

use super::condition::Condition;
use super::graph::{Expr, Graph, Id, Node, Symbol};
use super::spline::SplineDerivative;
use super::table::Table;
use super::tangent::Tangent;

/// The expressions with each symbol replaced as `replacement` says; `None` leaves it.
pub(crate) fn substitute<'g>(roots: &[Expr<'g>], replacement: impl Fn(Symbol) -> Option<Expr<'g>>) -> Vec<Expr<'g>> {
    roots.first().map_or(Vec::new(), |first| substitute_into(first.graph(), roots, replacement))
}

/// The expressions with each symbol replaced, copied into another graph.
pub(crate) fn substitute_into<'g>(
    graph: &'g Graph,
    roots: &[Expr<'_>],
    replacement: impl Fn(Symbol) -> Option<Expr<'g>>,
) -> Vec<Expr<'g>> {
    let Some(source) = roots.first().map(|first| first.graph()) else { return Vec::new() };
    let order = source.reachable(roots.iter().map(|root| root.id()));
    let mut copies = Table::new(&order, graph.integer(0));
    for id in order {
        let copy = match source.node(id) {
            Node::Symbol(symbol) => replacement(symbol).unwrap_or_else(|| graph.symbol(symbol)),
            node => rebuild((source, graph), node, &|operand| copies[operand]),
        };
        copy.note_of(id, source);
        copies[id] = copy;
    }
    roots.iter().map(|root| copies[root.id()]).collect()
}

/// A verbatim expression in another verbatim graph, cut where `cut` puts something else in the place of a node; `None`
/// where it has symbols besides that `allowed` does not let pass.
pub(crate) fn cut<'g>(
    root: Expr<'_>,
    graph: &'g Graph,
    cut: impl Fn(Id) -> Option<Expr<'g>>,
    allowed: impl Fn(Symbol) -> bool,
) -> Option<Expr<'g>> {
    let verbatim = root.graph();
    let mut copies: BTreeMap<Id, Option<Expr<'g>>> = BTreeMap::new();
    let mut waiting = vec![root.id()];
    while let Some(id) = waiting.pop() {
        if copies.contains_key(&id) {
            continue;
        }
        let replaced = cut(id);
        copies.insert(id, replaced);
        match verbatim.node(id) {
            _ if replaced.is_some() => {}
            Node::Symbol(symbol) if !allowed(symbol) => return None,
            node => waiting.extend(node.operands()),
        }
    }
    // Operands have smaller numbers.
    let order: Vec<Id> = copies.iter().filter(|(_, copy)| copy.is_none()).map(|(id, _)| *id).collect();
    for id in order {
        let copy = rebuild((verbatim, graph), verbatim.node(id), &|operand| copies[&operand].expect("it comes before"));
        copies.insert(id, Some(copy));
    }
    copies[&root.id()]
}

/// Copies verbatim expressions into `graph`, carrying out the time derivatives along `direction`.
pub(crate) fn carry_out<'v, 'g>(
    roots: &[Expr<'v>],
    graph: &'g Graph,
    direction: impl Fn(Symbol) -> Option<Expr<'g>>,
) -> Vec<Expr<'g>> {
    let Some(first) = roots.first() else { return Vec::new() };
    let verbatim = first.graph();
    let mut dt = Tangent::new(direction);
    let order = verbatim.reachable(roots.iter().map(|root| root.id()));
    let mut copies = Table::new(&order, graph.integer(0));
    for id in order {
        let copy = match verbatim.node(id) {
            Node::Symbol(symbol) => graph.symbol(symbol),
            Node::Rate(a) => dt.of(copies[a]),
            node => rebuild((verbatim, graph), node, &|operand| copies[operand]),
        };
        copies[id] = copy;
    }
    roots.iter().map(|root| copies[root.id()]).collect()
}

/// The same operation on new operands, in another graph.
pub(super) fn rebuild<'g>((source, graph): (&Graph, &'g Graph), node: Node, new: &dyn Fn(Id) -> Expr<'g>) -> Expr<'g> {
    match node {
        Node::Constant(value) => graph.constant(value),
        Node::Symbol(symbol) => graph.symbol(symbol),
        Node::Rate(a) => new(a).rate(),
        Node::Neg(a) => -new(a),
        Node::Add(a, b) => new(a) + new(b),
        Node::Sub(a, b) => new(a) - new(b),
        Node::Mul(a, b) => new(a) * new(b),
        Node::Power(a, n) => new(a).power(n),
        Node::Call(function, a) => new(a).call(function),
        Node::Call2(function, a, b) => new(a).call2(function, new(b)),
        Node::Spline(derivative, a) => {
            let spline = graph.spline_number(&source.spline_of(derivative.spline));
            graph.spline_derivative(SplineDerivative { spline, ..derivative }, new(a))
        }
        Node::Less(a, b) => new(a).less(new(b)).0,
        Node::LessEqual(a, b) => new(a).less_equal(new(b)).0,
        Node::And(a, b) => Condition(new(a)).and(Condition(new(b))).0,
        Node::Not(a) => Condition(new(a)).not().0,
        Node::Select(c, a, b) => graph.select(Condition(new(c)), new(a), new(b)),
    }
}
