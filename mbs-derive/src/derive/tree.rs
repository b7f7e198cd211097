//! The structured route: bodies on a tree of frames, by Newton–Euler and composite bodies.
//!
//! Where a mechanism is declared by bodies on frames, its equations follow in a form that is shorter than what differentiation
//! of the energies gives:
//!
//! - `linkage`: the declared frames, reduced to what moves;
//! - `inertia`: pseudo-inertias, mass with its first and second moments;
//! - `gauge`: frames turned about their joint axes until constant turns are plane rotations;
//! - `regroup`: masses move towards the base as far as joints cannot tell;
//! - `twist`: velocities, and the kinetic energy;
//! - `newton_euler`: motions out, wrenches back: inverse dynamics, bias, gravity;
//! - `composite`: the mass matrix; `coriolis`: the Coriolis matrix.
//!
//! What is no body is derived plainly and added.

mod composite;
mod coriolis;
mod gauge;
pub(super) mod inertia;
pub(super) mod linkage;
mod newton_euler;
mod regroup;
mod twist;
mod wrench;

use crate::expr::{Expr, Symbol, Tangent, Vector, gradient};

use super::lagrange::{Lagrange, add, at_rest, transpose};
use super::lift::Lifted;
use super::{Energies, Rows, Symbols};
use inertia::Inertia;
use linkage::Linkage;

/// Where the masses are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// Where they were declared.
    AsDeclared,
    /// As near to the base as joints cannot tell.
    Regrouped,
}

/// Lagrange's equations of the bodies by sweeps over their tree, of everything else plainly; `rest` is the latter.
pub fn equations<'g>(
    lifted: &Lifted<'g>,
    masses: Masses,
    energies: &Energies<'g>,
    rest: &Lagrange<'g>,
    symbols: &Symbols,
) -> Lagrange<'g> {
    let tree = Tree::new(lifted, masses, symbols);
    let bias = add(&tree.forces(false), &rest.bias);
    let kinetic_energy = tree.kinetic_energy() + rest.kinetic_energy;
    // L with T written shorter.
    let lagrangian = energies.lagrangian - energies.kinetic + kinetic_energy;
    Lagrange {
        kinetic_energy,
        potential_energy: energies.potential,
        momentum: gradient(lagrangian, &symbols.qd),
        position_gradient: gradient(lagrangian, &symbols.q),
        mass_matrix: sum(&tree.mass_matrix(), &rest.mass_matrix),
        coriolis_matrix: sum(&tree.coriolis_matrix(), &rest.coriolis_matrix),
        gravity: at_rest(&bias),
        inverse_dynamics: add(&tree.forces(true), &rest.inverse_dynamics),
        bias,
        dissipation_force: rest.dissipation_force.clone(),
        generalized_force: rest.generalized_force.clone(),
    }
}

/// The tree with its masses grouped, and how its joints follow the coordinates.
struct Tree<'g> {
    linkage: Linkage<'g>,
    inertias: Vec<Inertia<'g>>,
    gravity: Vector<'g>,
    /// The links behind a moving edge, in order.
    moving: Vec<usize>,
    /// `∂(displacement)/∂q`, a row per moving edge.
    slopes: Rows<'g>,
    /// The number of coordinates; no edge moves where all bodies rest.
    coordinates: usize,
}

impl<'g> Tree<'g> {
    fn new(lifted: &Lifted<'g>, masses: Masses, symbols: &Symbols) -> Self {
        let (linkage, inertias) = gauge::turned(&lifted.linkage, &lifted.inertias);
        let inertias = match masses {
            Masses::Regrouped => regroup::regrouped(&linkage, inertias),
            Masses::AsDeclared => inertias,
        };
        let linkage = regroup::without_spin(&linkage, &inertias);
        let displacement = |link: usize| linkage.links[link].edge?.displacement();
        let moving: Vec<usize> = (0..linkage.links.len()).filter(|&link| displacement(link).is_some()).collect();
        let slopes = moving.iter().filter_map(|&link| displacement(link)).map(|d| slope(d, &symbols.q)).collect();
        Tree { linkage, inertias, gravity: lifted.gravity, moving, slopes, coordinates: symbols.q.len() }
    }

    /// T of the bodies.
    fn kinetic_energy(&self) -> Expr<'g> {
        twist::kinetic_energy(&self.linkage, &self.inertias)
    }

    /// `M q̈ + C q̇ + G` of the bodies.
    fn forces(&self, accelerated: bool) -> Vec<Expr<'g>> {
        let joint = newton_euler::joint_forces(&self.linkage, &self.inertias, self.gravity, accelerated);
        let joint: Vec<_> = self.moving.iter().filter_map(|&link| joint[link]).collect();
        self.on_coordinates(&joint)
    }

    /// M of the bodies: `Sᵀ M S` of the joints' one.
    fn mass_matrix(&self) -> Rows<'g> {
        self.congruent(&composite::mass_matrix(&self.linkage, &self.moving, &self.composites()))
    }

    /// C of the bodies: `Sᵀ C S + Sᵀ M Ṡ`, and the explicit change in time once more.
    fn coriolis_matrix(&self) -> Rows<'g> {
        let composites = self.composites();
        let c = self.congruent(&coriolis::coriolis_matrix(&self.linkage, &self.moving, &composites));
        let m = composite::mass_matrix(&self.linkage, &self.moving, &composites);
        let turning = self.turning_slopes();
        let half = product(&m, &turning);
        let columns = transpose(&half, self.coordinates);
        let c = sum(&c, &transpose(&columns.iter().map(|column| self.on_coordinates(column)).collect(), columns.len()));
        let at_rest = c.iter().map(|row| at_rest(row)).collect();
        sum(&c, &at_rest)
    }

    fn composites(&self) -> Vec<Inertia<'g>> {
        composite::composites(&self.linkage, &self.inertias)
    }

    /// Ṡ
    fn turning_slopes(&self) -> Rows<'g> {
        let rate = |e: &Expr<'g>| linkage::rates(*e, false).0;
        self.slopes.iter().map(|row| row.iter().map(rate).collect()).collect()
    }

    /// `Sᵀ A S`
    fn congruent(&self, a: &Rows<'g>) -> Rows<'g> {
        let half: Rows<'g> = a.iter().map(|row| self.on_coordinates(row)).collect();
        let columns = transpose(&half, self.coordinates);
        let turned = columns.iter().map(|column| self.on_coordinates(column)).collect();
        transpose(&turned, self.coordinates)
    }

    /// `Sᵀ f`: what forces along the joints are along the coordinates.
    fn on_coordinates(&self, forces: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let zero = self.gravity.0[0].graph().integer(0);
        let on = |k: usize| forces.iter().zip(&self.slopes).fold(zero, |sum, (&f, slope)| sum + slope[k] * f);
        (0..self.coordinates).map(on).collect()
    }
}

/// `∂e/∂q`
fn slope<'g>(e: Expr<'g>, q: &[Symbol]) -> Vec<Expr<'g>> {
    let one = e.graph().integer(1);
    q.iter().map(|&symbol| Tangent::new(|other| (other == symbol).then_some(one)).of(e)).collect()
}

fn sum<'g>(a: &Rows<'g>, b: &Rows<'g>) -> Rows<'g> {
    a.iter().zip(b).map(|(a, b)| add(a, b)).collect()
}

fn product<'g>(a: &Rows<'g>, b: &Rows<'g>) -> Rows<'g> {
    let (Some(first), Some(columns)) = (a.first().and_then(|row| row.first()), b.first()) else { return Vec::new() };
    let zero = first.graph().integer(0);
    let entry = |row: &[Expr<'g>], k: usize| row.iter().zip(b).fold(zero, |sum, (&a, b)| sum + a * b[k]);
    a.iter().map(|row| (0..columns.len()).map(|k| entry(row, k)).collect()).collect()
}
