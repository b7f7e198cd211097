//! Lagrange's equations by degree in the velocities.

use crate::expr::{Expr, Symbol, Tangent, gradient, hessian, substitute};
use crate::mistake::rule;

use super::{Energies, Lagrange, LeftOut, Rows, Symbols, time_derivative};

/// Differentiates the energies.
pub(crate) fn equations<'g>(energies: &Energies<'g>, symbols: &Symbols, left_out: LeftOut) -> Lagrange<'g> {
    let l = energies.lagrangian;
    let momentum = gradient(l, &symbols.qd); // p = ∂L/∂q̇
    let position_gradient = gradient(l, &symbols.q); // ∂L/∂q
    let dissipation_force = gradient(energies.dissipation, &symbols.qd); // ∂D/∂q̇

    // L = ½ q̇ᵀ M q̇ + aᵀ q̇ + L₀
    let mass_matrix: Rows<'g> = match left_out.mass_matrix {
        true => Rows::new(),
        false => hessian(l, &symbols.qd).iter().map(|row| at_rest(row)).collect(),
    };
    let a = at_rest(&momentum);
    let rest = at_rest(&[l])[0];
    let bias = sub(&rate_without_acceleration(&momentum), &position_gradient);
    let inverse_dynamics = add(&sub(&rate(&momentum), &position_gradient), &dissipation_force);

    Lagrange {
        kinetic_energy: energies.kinetic,
        potential_energy: energies.potential,
        coriolis_matrix: match left_out.coriolis_matrix {
            true => Rows::new(),
            false => coriolis_matrix(&mass_matrix, &momentum, &a, symbols),
        },
        gravity: gravity(rest, &a, symbols),
        residual: sub(&inverse_dynamics, &energies.forces),
        free_force: sub(&energies.forces, &add(&bias, &dissipation_force)),
        bias,
        inverse_dynamics,
        generalized_force: energies.forces.clone(),
        momentum,
        mass_matrix,
        dissipation_force,
        position_gradient,
        accelerations: None,
        slopes: None,
    }
}

/// `C = ½ (Ṁ + ∂M/∂t + P − Pᵀ) + (∂aᵢ/∂qⱼ − ∂aⱼ/∂qᵢ)` with `Pᵢⱼ = ∂(M q̇)ᵢ/∂qⱼ`.
///
/// The Christoffel form without a triple loop: `Cᵢⱼ = Σₖ Γᵢⱼₖ q̇ₖ` where M and a do not depend on t.
fn coriolis_matrix<'g>(m: &Rows<'g>, momentum: &[Expr<'g>], a: &[Expr<'g>], symbols: &Symbols) -> Rows<'g> {
    let n = momentum.len();
    let quadratic = sub(momentum, a); // M q̇ = p − a
    let p = jacobian(&quadratic, &symbols.q);
    let da = jacobian(a, &symbols.q);
    let mut dt = Tangent::new(|symbol| velocity_direction(symbol, m[0][0]));
    let mut partial_t = Tangent::new(|symbol| time_direction(symbol, m[0][0]));
    let mut entry = |i: usize, j: usize| {
        let (row, column) = (i.max(j), i.min(j));
        let m_dot = dt.of(m[row][column]) + partial_t.of(m[row][column]);
        let gyroscopic = da[i][j] - da[j][i];
        (m_dot + (p[i][j] - p[j][i])) / 2 + rule!("gyroscopic terms", gyroscopic, -gyroscopic)
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// `G = −∂L₀/∂q + ∂a/∂t`
fn gravity<'g>(rest: Expr<'g>, a: &[Expr<'g>], symbols: &Symbols) -> Vec<Expr<'g>> {
    let mut partial_t = Tangent::new(|symbol| time_direction(symbol, rest));
    let slope = gradient(rest, &symbols.q);
    a.iter()
        .zip(slope)
        .map(|(&a, slope)| rule!("the gravity of what moves in time", partial_t.of(a) - slope, -slope))
        .collect()
}

/// `ṗ`
pub(super) fn rate<'g>(momentum: &[Expr<'g>]) -> Vec<Expr<'g>> {
    Tangent::new(|symbol| time_derivative(symbol, momentum[0].graph())).of_all(momentum)
}

/// `ṗ` at `q̈ = 0`
fn rate_without_acceleration<'g>(momentum: &[Expr<'g>]) -> Vec<Expr<'g>> {
    Tangent::new(|symbol| velocity_direction(symbol, momentum[0])).of_all(momentum)
}

/// `dq = q̇ dt`, `dq̇ = 0`
pub(super) fn velocity_direction<'g>(symbol: Symbol, any: Expr<'g>) -> Option<Expr<'g>> {
    match symbol {
        Symbol::Velocity(_) => None,
        other => time_derivative(other, any.graph()),
    }
}

/// `∂/∂t`: time and prescribed motions go on, coordinates and velocities are held.
fn time_direction<'g>(symbol: Symbol, any: Expr<'g>) -> Option<Expr<'g>> {
    match symbol {
        Symbol::Coordinate(_) | Symbol::Velocity(_) => None,
        other => time_derivative(other, any.graph()),
    }
}

/// Expressions at `q̇ = 0`.
pub(super) fn at_rest<'g>(expressions: &[Expr<'g>]) -> Vec<Expr<'g>> {
    substitute(expressions, |symbol| match symbol {
        Symbol::Velocity(_) => Some(expressions[0].graph().integer(0)),
        _ => None,
    })
}

/// `∂fᵢ/∂xⱼ`, by one forward sweep per symbol.
pub(super) fn jacobian<'g>(f: &[Expr<'g>], x: &[Symbol]) -> Rows<'g> {
    let column = |&symbol: &Symbol| Tangent::new(|other| (other == symbol).then(|| f[0].graph().integer(1))).of_all(f);
    transpose(&x.iter().map(column).collect(), f.len())
}

/// `∂fᵢ/∂xⱼ`, by one reverse sweep per function.
pub(super) fn jacobian_by_rows<'g>(f: &[Expr<'g>], x: &[Symbol]) -> Rows<'g> {
    f.iter().map(|&f| gradient(f, x)).collect()
}

pub(super) fn transpose<'g>(columns: &Rows<'g>, rows: usize) -> Rows<'g> {
    (0..rows).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
}

pub(super) fn add<'g>(a: &[Expr<'g>], b: &[Expr<'g>]) -> Vec<Expr<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

pub(super) fn sub<'g>(a: &[Expr<'g>], b: &[Expr<'g>]) -> Vec<Expr<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, evaluate};

    /// A particle in plane polar coordinates `(r, φ)` about a turntable that turns by `½ α t²`, on a spring, with
    /// friction along the ray: Goldstein, Poole & Safko, *Classical Mechanics*, 3rd ed. 2002, section 1.6, with φ + ½ α
    /// t² for the angle.
    #[test]
    fn a_particle_on_a_turntable_moves_as_in_the_textbook() {
        let graph = Graph::new();
        let symbols = Symbols {
            q: [0, 1].map(Symbol::Coordinate).to_vec(),
            qd: [0, 1].map(Symbol::Velocity).to_vec(),
            qdd: [0, 1].map(Symbol::Acceleration).to_vec(),
            u: vec![Symbol::Input(0)],
            parameters: Vec::new(),
        };
        let [m, k, rest, alpha, c] = [2, 30, 1, 3, 5].map(|n| graph.integer(n));
        let [r, r_dot, phi_dot] =
            [Symbol::Coordinate(0), Symbol::Velocity(0), Symbol::Velocity(1)].map(|symbol| graph.symbol(symbol));
        let (t, u) = (graph.symbol(Symbol::Time), graph.symbol(Symbol::Input(0)));
        let kinetic = m * (r_dot.powi(2) + r.powi(2) * (phi_dot + alpha * t).powi(2)) / 2;
        let potential = k * (r - rest).powi(2) / 2;
        let energies = Energies {
            kinetic,
            potential,
            dissipation: c * r_dot.powi(2) / 2,
            other: graph.integer(0),
            lagrangian: kinetic - potential,
            forces: vec![u, graph.integer(0)],
            declared_forces: vec![u, graph.integer(0)],
            declared_inertias: vec![m * r.powi(2) / 2],
        };
        let found = equations(&energies, &symbols, LeftOut::default());

        let (r, phi, r_dot, phi_dot, r_ddot, phi_ddot, t, u) = (1.3, 0.4, -0.7, 2.1, 0.9, -1.6, 0.35, 4.0);
        let (m, k, rest, alpha, c) = (2.0, 30.0, 1.0, 3.0, 5.0);
        let point = |symbol: Symbol| match symbol {
            Symbol::Coordinate(i) => [r, phi][i as usize],
            Symbol::Velocity(i) => [r_dot, phi_dot][i as usize],
            Symbol::Acceleration(i) => [r_ddot, phi_ddot][i as usize],
            Symbol::Time => t,
            Symbol::Input(_) => u,
            other => unreachable!("{other:?}"),
        };
        let is = |found: &[Expr<'_>], expected: &[f64]| {
            let found: Vec<f64> = evaluate(found, point);
            let equal = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
            assert!(found.len() == expected.len() && found.iter().zip(expected).all(equal), "{found:?} {expected:?}");
        };
        let w = phi_dot + alpha * t;
        let bias = [-m * r * w * w + k * (r - rest), 2.0 * m * r * r_dot * w + m * r * r * alpha];
        is(&found.momentum, &[m * r_dot, m * r * r * w]);
        is(&found.mass_matrix.concat(), &[m, 0.0, 0.0, m * r * r]);
        is(&found.bias, &bias);
        is(&found.inverse_dynamics, &[m * r_ddot + bias[0] + c * r_dot, m * r * r * phi_ddot + bias[1]]);
        is(&found.residual, &[m * r_ddot + bias[0] + c * r_dot - u, m * r * r * phi_ddot + bias[1]]);
        is(&found.free_force, &[u - bias[0] - c * r_dot, -bias[1]]);
        is(&found.dissipation_force, &[c * r_dot, 0.0]);
        is(&found.position_gradient, &[m * r * w * w - k * (r - rest), 0.0]);
        // Relative to the turntable: a = (0, m r² α t), L₀ = ½ m r² (α t)² − V.
        let drag = alpha * t;
        is(&found.gravity, &[-m * r * drag * drag + k * (r - rest), m * r * r * alpha]);
        // Christoffel's symbols of diag(m, m r²), and the gyroscopic terms ∂a₁/∂q₂ − ∂a₂/∂q₁.
        let turning = 2.0 * m * r * drag;
        let coriolis = [0.0, -m * r * phi_dot - turning, m * r * phi_dot + turning, m * r * r_dot];
        is(&found.coriolis_matrix.concat(), &coriolis);
    }
}
