//! Whether a form has the digits of the expressions that it stands for.
//!
//! `2 cos a − cos(a − b) − cos(a + b)` is `4 cos a sin² (b/2)`, but next to b = 0 it is nothing but the rounding of its
//! terms. Such states are tried: one place after another, then all of them, is nearly zero or a quarter of a turn.

use crate::expr::evaluate::{Tape, Value};
use crate::expr::field::mixed;
use crate::expr::identity::key;
use crate::expr::{Expr, Node, Rounded, Symbol};

/// How near the states are to those where sines, cosines and differences vanish.
const NEAR: f64 = 1e-9;

/// How many times the bound on the error of what is written a form's may be.
const ALLOWED: f64 = 1e4;

/// Whether each component of `form` has the digits that it has in `given`, at all states tried.
pub(super) fn are_kept(given: &[Expr<'_>], form: &[Expr<'_>]) -> bool {
    let Some(first) = given.first() else { return true };
    let graph = first.graph();
    let is_place = |symbol: &Symbol| matches!(symbol, Symbol::Time | Symbol::Coordinate(_) | Symbol::Prescribed(_, 0));
    let mut places: Vec<Option<Symbol>> = graph
        .reachable(given.iter().map(|expr| expr.id()))
        .into_iter()
        .filter_map(|id| if let Node::Symbol(symbol) = graph.node(id) { Some(symbol) } else { None })
        .filter(is_place)
        .map(Some)
        .collect();
    places.push(None);
    let tapes = [given, form].map(Tape::new);
    places.iter().all(|&place| {
        [0.0, std::f64::consts::FRAC_PI_2].into_iter().all(|target| {
            let point = |symbol: Symbol| {
                // From 0.5 to 1.5.
                let anywhere = 0.5 + (mixed(key(symbol)) >> 11) as f64 * 2f64.powi(-53);
                let is_near = place.map_or_else(|| is_place(&symbol), |place| place == symbol);
                Rounded::constant(if is_near { target + NEAR * anywhere } else { anywhere })
            };
            let [given, form] = tapes.each_ref().map(|tape| tape.run(point));
            // What is not finite is no less so in another form.
            !given
                .iter()
                .zip(&form)
                .any(|(given, form)| form.error > ALLOWED * (given.error + f64::EPSILON * given.value.abs()))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::are_kept;
    use crate::expr::{Graph, Symbol};

    #[test]
    fn sums_that_vanish_lose_what_products_keep() {
        let graph = Graph::new();
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let m = graph.symbol(Symbol::Parameter(0));
        let product = m * a.cos() * b.sin().powi(2);
        let sum = m * (2 * a.cos() - (a - 2 * b).cos() - (a + 2 * b).cos());
        assert!(!are_kept(&[m, product], &[m, sum]) && are_kept(&[m, sum], &[m, product]));
        // Next to a quarter of a turn.
        assert!(!are_kept(&[b.cos().powi(2)], &[1 - b.sin().powi(2)]));
        assert!(!are_kept(&[(a - b).powi(2)], &[a.powi(2) - 2 * a * b + b.powi(2)]));
        // Nothing is lost that was there.
        let turned = a.cos() * b.cos() + a.sin() * b.sin();
        assert!(are_kept(&[turned], &[(a - b).cos()]) && are_kept(&[(a - b).cos()], &[turned]));
        assert!(are_kept(&[], &[]));
    }
}
