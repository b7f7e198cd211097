//! Sums that are zero for all values of their symbols, and so would leave nothing but rounding.
//!
//! The rate of a slope less the slope of that rate is zero, where the order of factors hides it: `a (b c) − b (a c)`.
//! Beside small terms its rounding may be all that is seen. Which sums vanish is decided in two finite fields
//! ([`residue`](super::residue)), never by a tolerance; doubles only tell which sums need not be asked about.

use super::evaluate::{Value, value_of};
use super::field::mixed;
use super::graph::{Expr, Graph, Id, Node, Symbol};
use super::identity::{Chance, chance, generic, key};
use super::residue::Residue;
use super::spline::SplineDerivative;
use super::substitute::rebuild;
use super::table::Table;

/// At this many points a sum without roots is zero.
const POINTS: u32 = 4;

/// At this many one with roots, each of which has one sign or the other at a point.
const POINTS_OF_ROOTS: u32 = 24;

/// This many points are tried at most: at one in two a root has no value.
const TRIED: u64 = 96;

/// The expressions with zero in the place of each sum that vanishes; unchanged where no sum does.
pub(crate) fn without_vanishing_sums<'g>(roots: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let Some(graph) = roots.first().map(|root| root.graph()) else { return Vec::new() };
    let order = graph.reachable(roots.iter().map(|root| root.id()));
    let vanishing = vanishing_sums(graph, &order);
    if vanishing.is_empty() {
        return roots.to_vec();
    }
    let mut copies = Table::new(&order, None);
    for &id in &order {
        let node = graph.node(id);
        copies[id] = if vanishing.binary_search(&id).is_ok() {
            Some(graph.integer(0))
        } else {
            let is_touched = node.operands().any(|operand| copies[operand].is_some());
            let copy = || rebuild((graph, graph), node, &|a| copies[a].unwrap_or_else(|| graph.expr(a)));
            is_touched.then(copy).inspect(|copy| copy.note_of(id, graph))
        };
    }
    roots.iter().map(|root| copies[root.id()].unwrap_or(*root)).collect()
}

/// The sums that vanish, in the order of their numbers. What depends on a comparison is left alone: no point may lead
/// to one of its sides.
fn vanishing_sums(graph: &Graph, order: &[Id]) -> Vec<Id> {
    let mut chances = Table::new(order, None);
    for &id in order {
        let node = graph.node(id);
        let inherited = node.operands().filter_map(|operand| chances[operand]);
        chances[id] = inherited.chain(chance(&node)).max();
    }
    let is_sum = |id: &Id| matches!(graph.node(*id), Node::Add(..) | Node::Sub(..));
    let candidate = |id: &Id| match chances[*id] {
        Some(Chance::Outcome) => None,
        Some(Chance::Root | Chance::Slope) => Some((*id, POINTS_OF_ROOTS)),
        None => Some((*id, POINTS)),
    };
    let mut left: Vec<(Id, u32)> = order.iter().filter(|id| is_sum(id)).filter_map(candidate).collect();
    let cancels = cancelling(graph, order);
    left.retain(|(id, _)| cancels[*id]);
    let mut order = graph.reachable(left.iter().map(|(id, _)| *id));
    for point in 1..=TRIED {
        let before = left.len();
        left = if point % 2 == 0 {
            zeros::<0>(graph, &order, point, left)
        } else {
            zeros::<1>(graph, &order, point, left)
        };
        if left.iter().all(|(_, points)| *points == 0) {
            break;
        }
        if left.len() < before {
            order = graph.reachable(left.iter().map(|(id, _)| *id));
        }
    }
    left.into_iter().filter_map(|(id, points)| (points == 0).then_some(id)).collect()
}

/// Of each node whether it is a sum that cancels to six digits in doubles at a point, or has no finite value there.
///
/// Another one is taken not to vanish: should rounding hide that it does, it stays in the code, where it costs
/// operations and changes no value.
fn cancelling(graph: &Graph, order: &[Id]) -> Table<bool> {
    let (mut values, mut cancels) = (Table::new(order, 0.0), Table::new(order, false));
    for &id in order {
        let node = graph.node(id);
        let spline = |d: SplineDerivative, a: f64| graph.spline_of(d.spline).derivative(a, d.order as usize);
        let value = value_of(&node, |a| values[a], somewhere, spline, |holds| holds);
        values[id] = value;
        if let Node::Add(a, b) | Node::Sub(a, b) = node {
            let is_seen = value.abs() > 1e-6 * (values[a].abs() + values[b].abs());
            cancels[id] = !is_seen;
        }
    }
    cancels
}

/// Between 1/2 and 1, another for each symbol.
fn somewhere(symbol: Symbol) -> f64 {
    0.5 + (mixed(key(symbol)) >> 12) as f64 / (1_u64 << 53) as f64
}

/// Those of some sums that are zero at a point of a field, with one point less to go, or have no value there.
fn zeros<const K: usize>(graph: &Graph, order: &[Id], point: u64, mut sums: Vec<(Id, u32)>) -> Vec<(Id, u32)> {
    let mut values = Table::new(order, Residue::<K>::constant(0.0));
    for &id in order {
        let spline = |d: SplineDerivative, a: Residue<K>| a.spline(&graph.spline_of(d.spline), d.order as usize);
        let value = value_of(&graph.node(id), |a| values[a], |symbol| generic(symbol, point), spline, |holds| holds);
        values[id] = value;
    }
    sums.retain_mut(|(id, points)| {
        let value = values[*id];
        *points = points.saturating_sub(u32::from(value.is_defined()));
        value.is_zero() || !value.is_defined()
    });
    sums
}

#[cfg(test)]
mod tests {
    use super::without_vanishing_sums;
    use crate::expr::{Function, Graph, Number, Symbol};

    #[test]
    fn what_the_order_of_factors_hides_is_zero() {
        let graph = Graph::new();
        let [x, y, v] = [Symbol::Coordinate(0), Symbol::Coordinate(1), Symbol::Velocity(0)].map(|s| graph.symbol(s));
        let m = graph.symbol(Symbol::Parameter(0));
        let hidden = v * (m * x.sin()) - m * (v * x.sin());
        assert!(!hidden.is_zero());
        let [zero, beside, alone] = without_vanishing_sums(&[hidden, y + hidden * x.cos(), y * x])[..] else {
            panic!()
        };
        assert_eq!((zero, beside, alone), (graph.integer(0), y, y * x));
        // Through a root, too.
        let root = (x * x + y * y).sqrt();
        let hidden = (m * root) * (v * root) - (v * m) * (root * root);
        assert_eq!(without_vanishing_sums(&[x + hidden]), [x]);
    }

    #[test]
    fn what_is_small_is_not_zero() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let tiny = graph.constant(Number::parse_decimal("1e-40").unwrap());
        for expr in [
            x.sin().powi(2) + x.cos().powi(2) - 1 + tiny * x,
            (x + tiny) * y - y * x,
            x.powi(2).sqrt() - x,
            x.call(Function::Abs) - x,
            graph.select(graph.integer(100).less(x), y, x) - x,
        ] {
            assert_eq!(without_vanishing_sums(&[expr, x]), [expr, x]);
        }
    }
}
