//! First integrals: momenta of cyclic coordinates, and the energy integral where t is absent.

use crate::expr::{Expr, Symbol, evaluate, substitute};
use crate::model::Lagrangian;
use crate::model::lagrangian::component_names;

use super::constraint::Constraints;
use super::lagrange::Lagrange;
use super::{Energies, Symbols};

/// A quantity that keeps its value for `u = 0`, `D = 0`.
#[derive(Clone, Debug)]
pub struct Conserved<'g> {
    /// `energy_integral`, or `p_` and the coordinate.
    pub name: String,
    /// Its value.
    pub value: Expr<'g>,
}

/// What is conserved for `u = 0`, `D = 0`: `q̇·∂L/∂q̇ − L` where t does not occur and no force acts, and each
/// momentum `pᵢ = ∂L/∂q̇ᵢ` with `∂L/∂qᵢ = 0` on which no force acts.
pub fn conserved<'g>(
    lagrange: &Lagrange<'g>,
    energies: &Energies<'g>,
    constraints: &Constraints<'g>,
    symbols: &Symbols,
    lagrangian: &Lagrangian<'_>,
) -> Vec<Conserved<'g>> {
    let graph = energies.lagrangian.graph();
    let without_inputs = substitute(&lagrange.generalized_force, |symbol| match symbol {
        Symbol::Input(_) => Some(graph.integer(0)),
        _ => None,
    });
    let force_free: Vec<bool> = without_inputs.iter().map(|force| vanishes(*force)).collect();
    let mut found = Vec::new();
    // The power of a constraint is −b·λ: constraints that do not move do no work.
    let workless = constraints.drift.iter().all(|&drift| vanishes(drift));
    if force_free.iter().all(|&free| free) && workless && !depends_on_time(energies.lagrangian) {
        found.push(Conserved {
            name: "energy_integral".to_string(),
            value: energy_integral(lagrange, energies, symbols),
        });
    }
    for (i, name) in component_names(&lagrangian.coordinates).into_iter().enumerate() {
        let unconstrained = constraints.jacobian.iter().all(|row| vanishes(row[i]));
        if force_free[i] && unconstrained && vanishes(lagrange.position_gradient[i]) {
            found.push(Conserved { name: format!("p_{name}"), value: lagrange.momentum[i] });
        }
    }
    found
}

/// `q̇·∂L/∂q̇ − L`, Jacobi's integral; `T + V` where T is homogeneous of second degree in the velocities.
fn energy_integral<'g>(lagrange: &Lagrange<'g>, energies: &Energies<'g>, symbols: &Symbols) -> Expr<'g> {
    let graph = energies.lagrangian.graph();
    let action: Expr<'g> =
        lagrange.momentum.iter().zip(&symbols.qd).fold(graph.integer(0), |sum, (&p, &qd)| sum + p * graph.symbol(qd));
    action - energies.lagrangian
}

fn depends_on_time(expr: Expr<'_>) -> bool {
    let graph = expr.graph();
    graph.reachable([expr.id()]).into_iter().any(|id| match graph.node(id) {
        crate::expr::Node::Symbol(symbol) => matches!(symbol, Symbol::Time | Symbol::Prescribed(..)),
        _ => false,
    })
}

/// Whether an expression is zero for all values of its symbols: tried at points with no special relation.
///
/// An analytic function that is not identically zero is zero at a random point with probability 0; twelve points,
/// parameters among the symbols, leave no doubt.
fn vanishes(expr: Expr<'_>) -> bool {
    if expr.is_zero() {
        return true;
    }
    (0..12u64).all(|round| {
        let value: f64 = evaluate(&[expr], |symbol| generic_value(symbol, round))[0];
        let scale: f64 = evaluate(&[expr], |symbol| Magnitude(generic_value(symbol, round)))[0].0;
        value.abs() <= 1e-12 * scale
    })
}

/// A value in (0.3, 1.3) for each symbol and round.
pub(super) fn generic_value(symbol: Symbol, round: u64) -> f64 {
    let (kind, index) = match symbol {
        Symbol::Time => (0, 0),
        Symbol::Coordinate(i) => (1, i),
        Symbol::Velocity(i) => (2, i),
        Symbol::Acceleration(i) => (3, i),
        Symbol::Parameter(i) => (4, i),
        Symbol::Input(i) => (5, i),
        Symbol::Prescribed(i, order) => (6 + u64::from(order), i),
        Symbol::Multiplier(i) => (9, i),
    };
    let mixed = (kind * 1_000_003 + u64::from(index) * 7919 + round * 104_729 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    0.3 + (mixed >> 11) as f64 / (1u64 << 53) as f64
}

/// The sum of the magnitudes of the terms that an expression adds up: what its rounding errors are relative to.
#[derive(Clone, Copy)]
struct Magnitude(f64);

impl crate::expr::Value for Magnitude {
    fn constant(value: f64) -> Self {
        Magnitude(value.abs())
    }
    fn neg(self) -> Self {
        self
    }
    fn add(self, other: Self) -> Self {
        Magnitude(self.0 + other.0)
    }
    fn sub(self, other: Self) -> Self {
        Magnitude(self.0 + other.0)
    }
    fn mul(self, other: Self) -> Self {
        Magnitude(self.0 * other.0)
    }
    fn div(self, other: Self) -> Self {
        Magnitude(self.0 / other.0)
    }
    fn power(self, halves: i32) -> Self {
        Magnitude(self.0.powf(f64::from(halves) / 2.0).max(1.0))
    }
    fn call(self, function: crate::expr::Function) -> Self {
        Magnitude(function.value(self.0).abs().max(1.0))
    }
    fn call2(self, function: crate::expr::Binary, other: Self) -> Self {
        Magnitude(function.value(self.0, other.0).abs().max(1.0))
    }
    fn rate(self) -> Self {
        self
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
}
