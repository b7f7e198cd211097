//! Lagrange's equations by degree in the velocities.

use crate::expr::{Expr, Symbol, Tangent, gradient, hessian, substitute};

use super::{Energies, Rows, Symbols, time_derivative};

/// The terms of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q`.
#[derive(Clone, Debug)]
pub struct Lagrange<'g> {
    /// T
    pub kinetic_energy: Expr<'g>,
    /// V
    pub potential_energy: Expr<'g>,
    /// `p = ∂L/∂q̇`
    pub momentum: Vec<Expr<'g>>,
    /// `M = ∂²L/∂q̇²`
    pub mass_matrix: Rows<'g>,
    /// C
    pub coriolis_matrix: Rows<'g>,
    /// G
    pub gravity: Vec<Expr<'g>>,
    /// `h = C q̇ + G`
    pub bias: Vec<Expr<'g>>,
    /// `∂D/∂q̇`
    pub dissipation_force: Vec<Expr<'g>>,
    /// Q
    pub generalized_force: Vec<Expr<'g>>,
    /// `M q̈ + C q̇ + G + ∂D/∂q̇`
    pub inverse_dynamics: Vec<Expr<'g>>,
    /// `M q̈ + C q̇ + G + ∂D/∂q̇ − Q`, which forward dynamics makes zero.
    pub residual: Vec<Expr<'g>>,
    /// `Q − C q̇ − G − ∂D/∂q̇`, what accelerates.
    pub free_force: Vec<Expr<'g>>,
    /// `∂L/∂q`, which vanishes where the coordinate is cyclic.
    pub position_gradient: Vec<Expr<'g>>,
}

/// Differentiates the energies.
pub fn equations<'g>(energies: &Energies<'g>, symbols: &Symbols) -> Lagrange<'g> {
    let l = energies.lagrangian;
    let momentum = gradient(l, &symbols.qd); // p = ∂L/∂q̇
    let position_gradient = gradient(l, &symbols.q); // ∂L/∂q
    let dissipation_force = gradient(energies.dissipation, &symbols.qd); // ∂D/∂q̇

    // L = ½ q̇ᵀ M q̇ + aᵀ q̇ + L₀
    let mass_matrix: Rows<'g> = hessian(l, &symbols.qd).iter().map(|row| at_rest(row)).collect();
    let a = at_rest(&momentum);
    let rest = at_rest(&[l])[0];
    let bias = sub(&rate_without_acceleration(&momentum), &position_gradient);
    let inverse_dynamics = add(&sub(&rate(&momentum), &position_gradient), &dissipation_force);

    Lagrange {
        kinetic_energy: energies.kinetic,
        potential_energy: energies.potential,
        coriolis_matrix: coriolis_matrix(&mass_matrix, &momentum, &a, symbols),
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
        (m_dot + (p[i][j] - p[j][i])) / 2 + (da[i][j] - da[j][i])
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// `G = −∂L₀/∂q + ∂a/∂t`
fn gravity<'g>(rest: Expr<'g>, a: &[Expr<'g>], symbols: &Symbols) -> Vec<Expr<'g>> {
    let mut partial_t = Tangent::new(|symbol| time_direction(symbol, rest));
    let slope = gradient(rest, &symbols.q);
    a.iter().zip(slope).map(|(&a, slope)| partial_t.of(a) - slope).collect()
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
