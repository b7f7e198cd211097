//! Reverse sweep: the gradient of one expression at a small multiple of its own cost.

use crate::mistake::rule;

use super::graph::{Expr, Graph, Id, Node, Symbol};
use super::table::Table;
use super::tangent::{Tangent, power_derivative};

/// `∂root/∂symbol` for each symbol.
///
/// Source: Griewank & Walther, *Evaluating Derivatives*, 2nd ed. 2008, section 3.2.
pub(crate) fn gradient<'g>(root: Expr<'g>, symbols: &[Symbol]) -> Vec<Expr<'g>> {
    gradient_of_combination(&[(root, root.graph().integer(1))], symbols)
}

/// `Σ weight · ∂root/∂symbol` for each symbol: one sweep for several roots.
pub(crate) fn gradient_of_combination<'g>(roots: &[(Expr<'g>, Expr<'g>)], symbols: &[Symbol]) -> Vec<Expr<'g>> {
    let graph = roots.first().expect("at least one root").0.graph();
    let order = active(graph, roots.iter().map(|(root, _)| root.id()), |symbol| symbols.contains(&symbol));
    let mut adjoints = Adjoints::new(graph, &order);
    for &(root, weight) in roots {
        adjoints.add(root.id(), weight);
    }
    let mut branches = Branches::new(graph, symbols);
    for &id in order.iter().rev() {
        if let Some(adjoint) = adjoints.get(id) {
            adjoint.note_derivative_by(id);
            for (operand, partial) in branches.partials(graph.expr(id)) {
                adjoints.add_product(operand, partial, adjoint);
            }
        }
    }
    symbols.iter().map(|&symbol| adjoints.get(graph.symbol(symbol).id()).unwrap_or_else(|| graph.integer(0))).collect()
}

/// The nodes of the roots that depend on a chosen symbol, operands first.
pub(super) fn active(graph: &Graph, roots: impl Iterator<Item = Id>, chosen: impl Fn(Symbol) -> bool) -> Vec<Id> {
    let mut order = graph.reachable(roots);
    let mut depends = Table::new(&order, false);
    order.retain(|&id| {
        depends[id] = match graph.node(id) {
            Node::Symbol(symbol) => chosen(symbol),
            node => node.operands().any(|operand| depends[operand]),
        };
        depends[id]
    });
    order
}

/// The adjoints of the active nodes; contributions to others are dropped.
pub(super) struct Adjoints<'g> {
    values: Table<Option<Expr<'g>>>,
    graph: &'g Graph,
}

impl<'g> Adjoints<'g> {
    pub(super) fn new(graph: &'g Graph, active: &[Id]) -> Self {
        Adjoints { values: Table::new(active, None), graph }
    }

    pub(super) fn get(&self, id: Id) -> Option<Expr<'g>> {
        self.values.position(id).and_then(|_| self.values[id])
    }

    pub(super) fn add(&mut self, id: Id, contribution: Expr<'g>) {
        if let Some(value) = self.values.get_mut(id) {
            *value = Some(match *value {
                Some(sum) => sum + contribution,
                None => contribution,
            });
        }
    }

    pub(super) fn is_active(&self, id: Id) -> bool {
        self.values.position(id).is_some()
    }

    pub(super) fn add_product(&mut self, id: Id, partial: Partial<'g>, adjoint: Expr<'g>) {
        if self.is_active(id) {
            self.add(id, partial.times(self.graph, adjoint));
        }
    }
}

/// `∂node/∂operand`, made only where it is wanted.
#[derive(Clone, Copy)]
pub(super) enum Partial<'g> {
    One,
    MinusOne,
    /// Another operand.
    Factor(Expr<'g>),
    /// That of the node's first (0) or second (1) operand.
    Derivative(Expr<'g>, usize),
    /// This.
    Given(Expr<'g>),
}

impl<'g> Partial<'g> {
    /// `∂node/∂operand · weight`
    pub(super) fn times(self, graph: &'g Graph, weight: Expr<'g>) -> Expr<'g> {
        match self {
            Partial::One => weight,
            Partial::MinusOne => -weight,
            Partial::Factor(other) | Partial::Given(other) => other * weight,
            Partial::Derivative(expr, which) => {
                let derivative = match expr.node() {
                    Node::Power(a, n) => power_derivative(graph.expr(a), n),
                    Node::Call(function, a) => function.derivative(graph.expr(a), expr),
                    Node::Call2(function, a, b) => function.derivative(graph.expr(a), graph.expr(b), expr)[which],
                    Node::Spline(derivative, a) => graph.spline_derivative(derivative.next(), graph.expr(a)),
                    node => unreachable!("{node:?} has constant partial derivatives"),
                };
                derivative * weight
            }
        }
    }
}

/// Piecewise expressions in a reverse sweep: functions of the symbols themselves, each branch differentiated by itself.
///
/// An adjoint sent into a branch that is not taken would be zero times what the branch's derivatives are there, and
/// that may be NaN. So the derivatives in the symbols are selected instead.
pub(super) struct Branches<'g> {
    graph: &'g Graph,
    sweeps: Vec<(Symbol, Tangent<'g, 'g>)>,
}

impl<'g> Branches<'g> {
    pub(super) fn new(graph: &'g Graph, symbols: &[Symbol]) -> Self {
        let along = |chosen: Symbol| (chosen, Tangent::new(move |symbol| (symbol == chosen).then(|| graph.integer(1))));
        Branches { graph, sweeps: symbols.iter().map(|&symbol| along(symbol)).collect() }
    }

    /// The nodes that a node's derivative is passed to: its operands, or of a piecewise expression the symbols.
    pub(super) fn partials(&mut self, expr: Expr<'g>) -> impl Iterator<Item = (Id, Partial<'g>)> + use<'g> {
        let slopes = if matches!(expr.node(), Node::Select(..)) { self.slopes(expr) } else { Vec::new() };
        partials(expr).chain(slopes)
    }

    /// The derivatives of a piecewise expression in the symbols.
    fn slopes(&mut self, expr: Expr<'g>) -> Vec<(Id, Partial<'g>)> {
        let graph = self.graph;
        let slopes = self.sweeps.iter_mut().map(|(symbol, sweep)| (graph.symbol(*symbol).id(), sweep.of(expr)));
        slopes.filter(|(_, slope)| !slope.is_zero()).map(|(id, slope)| (id, Partial::Given(slope))).collect()
    }

    /// The second derivatives of a piecewise expression, each pair of symbols once.
    pub(super) fn curvatures(&mut self, expr: Expr<'g>) -> Vec<(Id, Id, Expr<'g>)> {
        let mut found = Vec::new();
        for i in 0..self.sweeps.len() {
            let slope = self.sweeps[i].1.of(expr);
            for j in 0..=i {
                let ids = [i, j].map(|k| self.graph.symbol(self.sweeps[k].0).id());
                found.push((ids[0], ids[1], self.sweeps[j].1.of(slope)));
            }
        }
        found.retain(|(_, _, curvature)| !curvature.is_zero());
        found
    }
}

/// The operands of a node, each with the node's derivative in it; none of a piecewise expression.
fn partials<'g>(expr: Expr<'g>) -> impl Iterator<Item = (Id, Partial<'g>)> {
    let graph = expr.graph();
    let (first, second) = match expr.node() {
        Node::Constant(_) | Node::Symbol(_) => (None, None),
        Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => (None, None),
        // Branches are differentiated by `Branches`.
        Node::Select(..) => (None, None),
        Node::Rate(_) => unreachable!("time derivatives are carried out before others"),
        Node::Neg(a) => (Some((a, Partial::MinusOne)), None),
        Node::Add(a, b) => (Some((a, Partial::One)), Some((b, Partial::One))),
        Node::Sub(a, b) => {
            let second = rule!("the adjoint of a difference", Partial::MinusOne, Partial::One);
            (Some((a, Partial::One)), Some((b, second)))
        }
        Node::Mul(a, b) => (Some((a, Partial::Factor(graph.expr(b)))), Some((b, Partial::Factor(graph.expr(a))))),
        Node::Power(a, _) | Node::Call(_, a) | Node::Spline(_, a) => (Some((a, Partial::Derivative(expr, 0))), None),
        Node::Call2(_, a, b) => (Some((a, Partial::Derivative(expr, 0))), Some((b, Partial::Derivative(expr, 1)))),
    };
    first.into_iter().chain(second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_of_a_product() {
        let graph = Graph::new();
        let symbols = [0, 1, 2].map(Symbol::Coordinate);
        let [x, y, z] = symbols.map(|s| graph.symbol(s));
        let f = x * y * z.sin();
        assert_eq!(gradient(f, &symbols), [y * z.sin(), x * z.sin(), x * y * z.cos()]);
    }

    #[test]
    fn a_doubling_chain_stays_linear() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let f = (0..60).fold(x, |e, _| (e * e + x).sin());
        let before = graph.len();
        gradient(f, &[Symbol::Coordinate(0)]);
        assert!(graph.len() < 10 * before);
    }
}
