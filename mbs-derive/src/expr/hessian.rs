//! Second-order reverse sweep: all second derivatives of one expression by edge pushing.
//!
//! Source: Gower & Mello, *A new framework for the computation of Hessians*, Optimization Methods and Software 27:2,
//! 2012, algorithm 3.1. Beside the adjoint of every node the sweep carries the second derivatives `w(i, j)` of the root
//! in the values of the nodes not yet eliminated, taken as independent. Eliminating node `i` pushes its edges to its
//! operands and creates those of its own curvature. On the kinetic energy of a chain of bodies, in the velocities, the
//! `w` are the entries of composite inertias.

use std::collections::BTreeMap;

use crate::mistake::rule;

use super::adjoint::{Adjoints, Branches, Partial, active};
use super::function::Binary;
use super::graph::{Expr, Graph, HalfInteger, Id, IdMap, Node, Symbol};

/// `∂²root/∂symbolᵢ∂symbolⱼ`, as rows; symmetric to the node.
pub(crate) fn hessian<'g>(root: Expr<'g>, symbols: &[Symbol]) -> Vec<Vec<Expr<'g>>> {
    let graph = root.graph();
    let order = active(graph, std::iter::once(root.id()), |symbol| symbols.contains(&symbol));
    let mut adjoints = Adjoints::new(graph, &order);
    adjoints.add(root.id(), graph.integer(1));
    let mut branches = Branches::new(graph, symbols);
    let mut edges = Edges { graph, rows: IdMap::default() };
    for &id in order.iter().rev() {
        if matches!(graph.node(id), Node::Symbol(_)) {
            continue;
        }
        let partials = branches.partials(graph.expr(id));
        let operands: Vec<_> = partials.filter(|(operand, _)| adjoints.is_active(*operand)).collect();
        for (neighbour, weight) in edges.take(id) {
            push(graph, &mut edges, id, neighbour, weight, &operands);
        }
        if let Some(adjoint) = adjoints.get(id) {
            create(graph.expr(id), adjoint, &adjoints, &mut edges);
            if matches!(graph.node(id), Node::Select(..)) {
                branches.curvatures(graph.expr(id)).into_iter().for_each(|(i, j, w)| edges.add(i, j, w * adjoint));
            }
            for &(operand, partial) in &operands {
                adjoints.add_product(operand, partial, adjoint);
            }
        }
    }
    let id = |symbol: &Symbol| graph.symbol(*symbol).id();
    let entry = |i: &Symbol, j: &Symbol| edges.get(id(i), id(j)).unwrap_or_else(|| graph.integer(0));
    symbols.iter().map(|i| symbols.iter().map(|j| entry(i, j)).collect()).collect()
}

/// Moves the edge between `id` and `neighbour` to the operands of `id`.
fn push<'g>(
    graph: &'g Graph,
    edges: &mut Edges<'g>,
    id: Id,
    neighbour: Id,
    weight: Expr<'g>,
    operands: &[(Id, Partial<'g>)],
) {
    if neighbour != id {
        for &(j, partial) in operands {
            let pushed = partial.times(graph, weight);
            let is_twice = rule!("an edge that becomes a loop", j == neighbour, false);
            edges.add(j, neighbour, if is_twice { 2 * pushed } else { pushed });
        }
        return;
    }
    for (position, &(k, second)) in operands.iter().enumerate() {
        let pushed = second.times(graph, weight);
        for &(j, first) in &operands[..position] {
            let mixed = first.times(graph, pushed);
            edges.add(j, k, if j == k { 2 * mixed } else { mixed });
        }
        edges.add(k, k, second.times(graph, pushed));
    }
}

/// The edges of the node's own curvature.
fn create<'g>(expr: Expr<'g>, adjoint: Expr<'g>, adjoints: &Adjoints<'g>, edges: &mut Edges<'g>) {
    let graph = expr.graph();
    match expr.node() {
        Node::Mul(a, b) if adjoints.is_active(a) && adjoints.is_active(b) => {
            edges.add(a, b, if a == b { 2 * adjoint } else { adjoint });
        }
        Node::Power(a, n) => edges.add(a, a, power_curvature(graph.expr(a), n) * adjoint),
        Node::Call(function, a) => edges.add(a, a, function.second_derivative(graph.expr(a), expr) * adjoint),
        Node::Spline(derivative, a) => {
            edges.add(a, a, graph.spline_derivative(derivative.next().next(), graph.expr(a)) * adjoint);
        }
        Node::Call2(function, a, b) => {
            create_for_two_arguments(function, graph.expr(a), graph.expr(b), expr, adjoint, adjoints, edges);
        }
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Mul(..)
        | Node::Less(..)
        | Node::LessEqual(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => {}
    }
}

fn create_for_two_arguments<'g>(
    function: Binary,
    a: Expr<'g>,
    b: Expr<'g>,
    value: Expr<'g>,
    adjoint: Expr<'g>,
    adjoints: &Adjoints<'g>,
    edges: &mut Edges<'g>,
) {
    let [aa, ab, bb] = function.second_derivative(a, b, value);
    let (first, second) = (adjoints.is_active(a.id()), adjoints.is_active(b.id()));
    if first {
        edges.add(a.id(), a.id(), aa * adjoint);
    }
    if first && second {
        edges.add(a.id(), b.id(), if a == b { 2 * ab * adjoint } else { ab * adjoint });
    }
    if second {
        edges.add(b.id(), b.id(), bb * adjoint);
    }
}

/// `n (n − 1) xⁿ⁻²`
fn power_curvature<'g>(x: Expr<'g>, n: HalfInteger) -> Expr<'g> {
    let exponent = x.graph().constant(n.to_number());
    let next = rule!("the curvature of a power", exponent - 1, exponent);
    exponent * next * x.power(HalfInteger::halves(n.to_halves() - 4))
}

/// Symmetric weights, kept at the node that is eliminated first: the later one, and symbols last of all.
struct Edges<'g> {
    graph: &'g Graph,
    rows: IdMap<BTreeMap<Id, Expr<'g>>>,
}

impl<'g> Edges<'g> {
    fn add(&mut self, i: Id, j: Id, weight: Expr<'g>) {
        if weight.is_zero() {
            return;
        }
        let (first, last) = self.by_elimination(i, j);
        let row = self.rows.entry(first).or_default();
        row.entry(last).and_modify(|sum| *sum = *sum + weight).or_insert(weight);
    }

    fn get(&self, i: Id, j: Id) -> Option<Expr<'g>> {
        let (first, last) = self.by_elimination(i, j);
        self.rows.get(&first)?.get(&last).copied()
    }

    fn by_elimination(&self, i: Id, j: Id) -> (Id, Id) {
        let rank = |id: Id| (!matches!(self.graph.node(id), Node::Symbol(_)), id);
        if rank(i) >= rank(j) { (i, j) } else { (j, i) }
    }

    fn take(&mut self, i: Id) -> impl Iterator<Item = (Id, Expr<'g>)> + use<'g> {
        self.rows.remove(&i).unwrap_or_default().into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_derivatives_agree_with_twice_the_gradient() {
        let graph = Graph::new();
        let symbols = [0, 1, 2].map(Symbol::Velocity);
        let [x, y, z] = symbols.map(|s| graph.symbol(s));
        let f = (x * y + 3 * z).powi(2) * y - (x + y).powi(2);
        let rows = hessian(f, &symbols);
        let point = |symbol: Symbol| match symbol {
            Symbol::Velocity(i) => [0.3, -1.1, 0.7][i as usize],
            _ => unreachable!(),
        };
        for (i, row) in rows.iter().enumerate() {
            let first = crate::expr::gradient(f, &symbols)[i];
            let reference = crate::expr::gradient(first, &symbols);
            for (entry, other) in row.iter().zip(reference) {
                let (a, b) = (value(*entry, &point), value(other, &point));
                assert!((a - b).abs() < 1e-12, "{a} {b}");
            }
        }
    }

    #[test]
    fn symbols_made_late_are_eliminated_last() {
        let graph = Graph::new();
        let symbols = [0, 1].map(Symbol::Velocity);
        let x = graph.symbol(symbols[0]);
        let early = 3 * x;
        let late = graph.symbol(symbols[1]);
        let rows = hessian((early + late).powi(2), &symbols);
        assert_eq!(rows[0][1], graph.integer(6));
        assert_eq!(rows[1][0], graph.integer(6));
    }

    /// Plain evaluation of a polynomial.
    fn value(root: Expr<'_>, point: &impl Fn(Symbol) -> f64) -> f64 {
        let graph = root.graph();
        let mut values: IdMap<f64> = IdMap::default();
        for id in graph.reachable([root.id()]) {
            let v = |id: Id| values[&id];
            let result: f64 = match graph.node(id) {
                Node::Constant(c) => c.to_f64(),
                Node::Symbol(symbol) => point(symbol),
                Node::Neg(a) => -v(a),
                Node::Add(a, b) => v(a) + v(b),
                Node::Sub(a, b) => v(a) - v(b),
                Node::Mul(a, b) => v(a) * v(b),
                Node::Power(a, n) => v(a).powi(n.to_integer().unwrap()),
                other => unreachable!("{other:?}"),
            };
            values.insert(id, result);
        }
        values[&root.id()]
    }
}
