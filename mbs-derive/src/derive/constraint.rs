//! Constraints: what must vanish, its Jacobian, and its bias.
//!
//! Holonomic `φ(q, t) = 0` and Pfaffian `a(q, t)·q̇ + b(q, t) = 0` rows both read `A q̇ + b = 0` (`A = ∂φ/∂q`, `b = ∂φ/∂t`) and,
//! once more differentiated, `A q̈ + γ = 0` with `γ = Ȧ q̇ + ḃ`. They enter the equations of motion as
//! `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`.

use crate::expr::{Expr, Graph, Symbol, Tangent, carry_out, gradient};
use crate::model::{ConstraintKind, Lagrangian};

use super::lagrange::{at_rest, velocity_direction};
use super::{Rows, Symbols, time_derivative};

/// All rows of all constraints, in declaration order.
#[derive(Clone, Debug, Default)]
pub struct Constraints<'g> {
    /// `φ`, or `a·q̇ + b` of Pfaffian rows.
    pub value: Vec<Expr<'g>>,
    /// `A q̇ + b`
    pub rate: Vec<Expr<'g>>,
    /// `∂(A q̇ + b)/∂q`
    pub rate_jacobian: Rows<'g>,
    /// A
    pub jacobian: Rows<'g>,
    /// b
    pub drift: Vec<Expr<'g>>,
    /// γ
    pub bias: Vec<Expr<'g>>,
    /// λ, as symbols.
    pub multipliers: Vec<Symbol>,
}

impl<'g> Constraints<'g> {
    /// How many rows.
    pub fn count(&self) -> usize {
        self.value.len()
    }

    /// `Aᵀ λ`
    pub fn force(&self, n: usize, graph: &'g Graph) -> Vec<Expr<'g>> {
        let component = |i: usize| {
            let terms = self.jacobian.iter().zip(&self.multipliers).map(|(row, &l)| row[i] * graph.symbol(l));
            terms.fold(graph.integer(0), |sum, term| sum + term)
        };
        (0..n).map(component).collect()
    }
}

/// Differentiates the declared constraints.
pub fn constraints<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph, symbols: &Symbols) -> Constraints<'g> {
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
            all.bias.push(Tangent::new(|symbol| velocity_direction(symbol, row)).of(rate));
        }
    }
    all
}
