//! Forward sweep: directional derivatives, and the total time derivative by the chain rule.

use crate::mistake::rule;

use super::condition::Condition;
use super::graph::{Expr, Id, IdMap, Node, Symbol};

/// The derivative along one direction, given by the derivatives of the symbols.
///
/// It remembers what it has differentiated, so that many expressions that share nodes cost one sweep.
pub(crate) struct Tangent<'g, 'd> {
    direction: Box<dyn Fn(Symbol) -> Option<Expr<'g>> + 'd>,
    derivatives: IdMap<Expr<'g>>,
}

impl<'g, 'd> Tangent<'g, 'd> {
    /// `direction` tells how each symbol changes; `None` is not at all.
    pub(crate) fn new(direction: impl Fn(Symbol) -> Option<Expr<'g>> + 'd) -> Self {
        Tangent { direction: Box::new(direction), derivatives: IdMap::default() }
    }

    /// The derivative of `root` along the direction.
    pub(crate) fn of(&mut self, root: Expr<'g>) -> Expr<'g> {
        let graph = root.graph();
        let mut stack = vec![root.id()];
        while let Some(&id) = stack.last() {
            if self.derivatives.contains_key(&id) {
                stack.pop();
                continue;
            }
            let node = graph.node(id);
            let before = stack.len();
            stack.extend(node.operands().filter(|operand| !self.derivatives.contains_key(operand)));
            if stack.len() == before {
                let derivative = self.local(graph.expr(id), node);
                self.derivatives.insert(id, derivative);
                stack.pop();
            }
        }
        self.derivatives[&root.id()]
    }

    /// The derivatives of several expressions.
    pub(crate) fn of_all(&mut self, roots: &[Expr<'g>]) -> Vec<Expr<'g>> {
        roots.iter().map(|&root| self.of(root)).collect()
    }

    /// The chain rule at one node whose operands are done.
    fn local(&self, expr: Expr<'g>, node: Node) -> Expr<'g> {
        let graph = expr.graph();
        let zero = graph.integer(0);
        let d = |id: Id| self.derivatives[&id];
        match node {
            Node::Constant(_) => zero,
            Node::Symbol(symbol) => (self.direction)(symbol).unwrap_or(zero),
            Node::Rate(_) => unreachable!("time derivatives are carried out before others"),
            Node::Neg(a) => -d(a),
            Node::Add(a, b) => d(a) + d(b),
            Node::Sub(a, b) => d(a) - d(b),
            // Leibniz
            Node::Mul(a, b) => {
                let first = d(a) * graph.expr(b);
                rule!("the derivative of a product", first + graph.expr(a) * d(b), first)
            }
            Node::Power(..) | Node::Call(..) | Node::Spline(..)
                if d(node.operands().next().expect("one operand")).is_zero() =>
            {
                zero
            }
            Node::Power(a, n) => power_derivative(graph.expr(a), n) * d(a),
            Node::Call(function, a) => function.derivative(graph.expr(a), expr) * d(a),
            Node::Spline(derivative, a) => graph.spline_derivative(derivative.next(), graph.expr(a)) * d(a),
            Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => zero,
            // Inside each branch by itself; the jump between them has no derivative.
            Node::Select(c, a, b) => graph.select(Condition(graph.expr(c)), d(a), d(b)),
            Node::Call2(_, a, b) if d(a).is_zero() && d(b).is_zero() => zero,
            Node::Call2(function, a, b) => {
                let [da, db] = function.derivative(graph.expr(a), graph.expr(b), expr);
                da * d(a) + db * d(b)
            }
        }
    }
}

/// `n xⁿ⁻¹`
pub(super) fn power_derivative<'g>(x: Expr<'g>, n: super::HalfInteger) -> Expr<'g> {
    let less = rule!("the exponent of a derivative", 2, 1);
    x.graph().constant(n.to_number()) * x.power(super::HalfInteger::halves(n.to_halves() - less))
}

#[cfg(test)]
mod tests {
    use super::super::Graph;
    use super::*;

    #[test]
    fn chain_rule() {
        let graph = Graph::new();
        let [x, v] = [Symbol::Coordinate(0), Symbol::Velocity(0)].map(|s| graph.symbol(s));
        let mut dt = Tangent::new(|symbol| (symbol == Symbol::Coordinate(0)).then_some(v));
        assert_eq!(dt.of(x.sin()), x.cos() * v);
        assert_eq!(dt.of(x.powi(3)), 3 * x.powi(2) * v);
        assert_eq!(dt.of(graph.integer(7)), graph.integer(0));
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_nodes_is_no_recursion() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let deep = (0..100_000).fold(x, |e, _| (e + 1).sin());
        let one = graph.integer(1);
        let derivative = Tangent::new(|_| Some(one)).of(deep);
        assert!(!derivative.is_zero());
    }
}
