//! Copies expressions, replacing symbols, into the same or another graph; the target's local rules apply.

use super::graph::{Condition, Expr, Graph, Id, Node, Symbol};
use super::table::Table;
use super::tangent::Tangent;

/// The expressions with each symbol replaced as `replacement` says; `None` leaves it.
pub fn substitute<'g>(roots: &[Expr<'g>], replacement: impl Fn(Symbol) -> Option<Expr<'g>>) -> Vec<Expr<'g>> {
    let Some(first) = roots.first() else { return Vec::new() };
    let graph = first.graph();
    let order = graph.reachable(roots.iter().map(|root| root.id()));
    let mut copies = Table::new(&order, *first);
    for id in order {
        let copy = match graph.node(id) {
            Node::Symbol(symbol) => replacement(symbol).unwrap_or(graph.expr(id)),
            node => rebuild(graph, node, |operand| copies[operand]),
        };
        copies[id] = copy;
    }
    roots.iter().map(|root| copies[root.id()]).collect()
}

/// Copies verbatim expressions into `graph`, carrying out the time derivatives along `direction`.
pub fn carry_out<'v, 'g>(
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
            node => rebuild(graph, node, |operand| copies[operand]),
        };
        copies[id] = copy;
    }
    roots.iter().map(|root| copies[root.id()]).collect()
}

/// The same operation on new operands.
fn rebuild<'g>(graph: &'g Graph, node: Node, new: impl Fn(Id) -> Expr<'g>) -> Expr<'g> {
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
        Node::Less(a, b) => new(a).less(new(b)).0,
        Node::LessEqual(a, b) => new(a).less_equal(new(b)).0,
        Node::And(a, b) => Condition(new(a)).and(Condition(new(b))).0,
        Node::Not(a) => Condition(new(a)).not().0,
        Node::Select(c, a, b) => graph.select(Condition(new(c)), new(a), new(b)),
    }
}
