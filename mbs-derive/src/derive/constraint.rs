//! Constraints: what must vanish, its Jacobian, and its bias.
//!
//! Holonomic `φ(q, t) = 0` and Pfaffian `a(q, t)·q̇ + b(q, t) = 0` rows both read `A q̇ + b = 0` (`A = ∂φ/∂q`, `b =
//! ∂φ/∂t`) and, once more differentiated, `A q̈ + γ = 0` with `γ = Ȧ q̇ + ḃ`. They enter the equations of motion as `M
//! q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`.

use crate::expr::{Expr, Graph, Symbol, Tangent, carry_out, gradient};
use crate::mistake::rule;
use crate::model::{ConstraintKind, Lagrangian};

use super::lagrange::{at_rest, velocity_direction};
use super::{Constraints, Symbols, time_derivative};

impl<'g> Constraints<'g> {
    /// How many rows.
    pub(crate) fn count(&self) -> usize {
        self.value.len()
    }

    /// `Aᵀ λ`
    pub(crate) fn force(&self, n: usize, graph: &'g Graph) -> Vec<Expr<'g>> {
        let component = |i: usize| {
            let terms = self.jacobian.iter().zip(&self.multipliers).map(|(row, &l)| row[i] * graph.symbol(l));
            terms.fold(graph.integer(0), |sum, term| sum + term)
        };
        (0..n).map(component).collect()
    }
}

/// Differentiates the declared constraints.
pub(crate) fn constraints<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph, symbols: &Symbols) -> Constraints<'g> {
    let mut all = Constraints::default();
    for constraint in &lagrangian.constraints {
        for &row in &constraint.rows {
            let row = carry_out(&[row], graph, |symbol| time_derivative(symbol, graph))[0];
            let rate = match constraint.kind {
                ConstraintKind::Holonomic => Tangent::new(|symbol| velocity_direction(symbol, row)).of(row),
                ConstraintKind::Pfaffian => row,
            };
            all.multipliers.push(Symbol::Multiplier(all.value.len() as u32));
            all.value.push(row);
            all.rate.push(rate);
            all.rate_jacobian.push(gradient(rate, &symbols.q));
            all.jacobian.push(at_rest(&gradient(rate, &symbols.qd)));
            all.drift.push(at_rest(&[rate])[0]);
            let bias = Tangent::new(|symbol| velocity_direction(symbol, row)).of(rate);
            all.bias.push(rule!("the bias of a constraint", bias, -bias));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::evaluate;

    /// `φ = x² + x y t` and `ẏ − x ẋ + t³ = 0`, differentiated by hand.
    #[test]
    fn moving_and_pfaffian_rows_are_those_derived_by_hand() {
        let text = "#![dimensionless]
            mechanism A {
                coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2;
                constraint holonomic: x^2 + x*y*t = 0;
                constraint pfaffian: dt(y) - x*dt(x) + t^3 = 0;
            }";
        let (verbatim, graph) = (Graph::verbatim(), Graph::new());
        let (lagrangian, _) =
            crate::declared(text, &verbatim, &[]).unwrap_or_else(|error| panic!("{}", error.render("a", text)));
        let all = constraints(&lagrangian, &graph, &Symbols::of(&lagrangian));

        let ([x, y], [x_dot, y_dot], t) = ([0.7, -1.3], [0.4, 2.1], 1.6);
        let is = |found: &[Expr<'_>], expected: &[f64]| {
            let found: Vec<f64> = evaluate(found, |symbol| match symbol {
                Symbol::Coordinate(i) => [x, y][i as usize],
                Symbol::Velocity(i) => [x_dot, y_dot][i as usize],
                Symbol::Time => t,
                other => unreachable!("{other:?}"),
            });
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        };
        let rate = (2.0 * x + y * t) * x_dot + x * t * y_dot + x * y;
        is(&all.value, &[x * x + x * y * t, y_dot - x * x_dot + t * t * t]);
        is(&all.rate, &[rate, y_dot - x * x_dot + t * t * t]);
        is(&all.jacobian.concat(), &[2.0 * x + y * t, x * t, -x, 1.0]);
        is(&all.drift, &[x * y, t * t * t]);
        is(&all.rate_jacobian.concat(), &[2.0 * x_dot + t * y_dot + y, t * x_dot + x, -x_dot, 0.0]);
        let bias = 2.0 * x_dot * x_dot + 2.0 * t * x_dot * y_dot + 2.0 * (y * x_dot + x * y_dot);
        is(&all.bias, &[bias, -x_dot * x_dot + 3.0 * t * t]);
    }
}
