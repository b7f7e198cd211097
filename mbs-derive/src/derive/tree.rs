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
//! - `load`: forces on points and torques on bodies, which ride along with the wrenches;
//! - `spring`: terms of V that pull at points, likewise;
//! - `composite`: the mass matrix; `coriolis`: the Coriolis matrix.
//!
//! What is no body is derived plainly and added.

mod composite;
mod coriolis;
mod gauge;
pub(super) mod inertia;
pub(super) mod linkage;
pub(super) mod load;
mod newton_euler;
mod regroup;
pub(super) mod spring;
#[cfg(test)]
mod trial;
mod twist;
mod wrench;

use crate::expr::normal::weight;
use crate::expr::{Expr, Symbol, Tangent, Vector, gradient};

use super::lagrange::{Lagrange, add, at_rest, sub, transpose};
use super::lift::Lifted;
use super::{Energies, Rows, Symbols};
use inertia::Inertia;
use linkage::{Accelerations, Linkage};
use load::Load;
use spring::{Anchor, Held};
use wrench::Wrench;

/// Where the masses are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Masses {
    /// Where they were declared.
    AsDeclared,
    /// As near to the base as joints cannot tell.
    Regrouped,
}

/// Lagrange's equations of the bodies by sweeps over their tree, of everything else plainly; `rest` is the latter.
pub(super) fn equations<'g>(
    lifted: &Lifted<'g>,
    masses: Masses,
    energies: &Energies<'g>,
    rest: &Lagrange<'g>,
    symbols: &Symbols,
) -> Lagrange<'g> {
    let tree = Tree::new(lifted, masses, symbols);
    let bias = add(&tree.forces(Accelerations::Zero), &rest.bias);
    let kinetic_energy = tree.kinetic_energy() + rest.kinetic_energy;
    // L with T written shorter.
    let lagrangian = energies.lagrangian - energies.kinetic + kinetic_energy;
    let inverse_dynamics = add(&tree.forces(Accelerations::Given), &rest.inverse_dynamics);
    let (residual, free_force) = match tree.loads.is_empty() {
        true => (sub(&inverse_dynamics, &rest.generalized_force), free_force(&bias, rest)),
        false => (
            add(&tree.net_forces(Accelerations::Given), &rest.residual),
            sub(&rest.free_force, &tree.net_forces(Accelerations::Zero)),
        ),
    };
    Lagrange {
        kinetic_energy,
        potential_energy: energies.potential,
        momentum: gradient(lagrangian, &symbols.qd),
        position_gradient: gradient(lagrangian, &symbols.q),
        mass_matrix: sum(&tree.mass_matrix(), &rest.mass_matrix),
        coriolis_matrix: sum(&tree.coriolis_matrix(), &rest.coriolis_matrix),
        gravity: at_rest(&bias),
        inverse_dynamics,
        bias,
        dissipation_force: rest.dissipation_force.clone(),
        generalized_force: cheaper(energies.forces.clone(), add(&tree.applied_forces(), &rest.generalized_force)),
        residual,
        free_force,
    }
}

/// `M q̈ + C q̇ + G` of the bodies less Q of the loads, for the coordinates from a number on.
pub(super) fn net_forces<'g>(lifted: &Lifted<'g>, masses: Masses, symbols: &Symbols, first: usize) -> Vec<Expr<'g>> {
    let symbols = Symbols { q: symbols.q[first..].to_vec(), ..symbols.clone() };
    Tree::new(lifted, masses, &symbols).net_forces(Accelerations::Given)
}

/// The one that costs less by itself; the first wins a draw.
fn cheaper<'g>(a: Vec<Expr<'g>>, b: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
    if weight(&b) < weight(&a) { b } else { a }
}

/// `Q − h − ∂D/∂q̇` with the Q and D that are not bodies'.
fn free_force<'g>(bias: &[Expr<'g>], rest: &Lagrange<'g>) -> Vec<Expr<'g>> {
    sub(&rest.generalized_force, &add(bias, &rest.dissipation_force))
}

/// The tree with its masses grouped, and how its joints follow the coordinates.
struct Tree<'g> {
    linkage: Linkage<'g>,
    inertias: Vec<Inertia<'g>>,
    gravity: Vector<'g>,
    loads: Vec<Load<'g>>,
    /// What terms of V pull with.
    springs: Vec<Load<'g>>,
    /// The links behind a moving edge, in order.
    moving: Vec<usize>,
    /// `S = ∂s/∂q`, a row per moving edge, s its displacement.
    joint_jacobian: Rows<'g>,
    /// The number of coordinates; no edge moves where all bodies rest.
    coordinates: usize,
}

impl<'g> Tree<'g> {
    fn new(lifted: &Lifted<'g>, masses: Masses, symbols: &Symbols) -> Self {
        let graph = lifted.gravity.0[0].graph();
        let turned = gauge::turned(&lifted.linkage, &lifted.inertias);
        let loads: Vec<Load<'g>> = lifted.loads.iter().map(|load| turned.load(load)).collect();
        let anchors_of = |spring: &Held<'g>| spring.anchors.iter().map(|anchor| turned.anchor(anchor)).collect();
        let anchors: Vec<Vec<Anchor<'g>>> = lifted.springs.iter().map(anchors_of).collect();
        let (linkage, inertias) = (turned.linkage, turned.inertias);
        let inertias = match masses {
            Masses::Regrouped => regroup::regrouped(&linkage, inertias),
            Masses::AsDeclared => inertias,
        };
        let held = loads.iter().map(|load| load.link).chain(anchors.iter().flatten().map(|anchor| anchor.link));
        let linkage = regroup::without_spin(&linkage, &inertias, held);
        let springs = lifted.springs.iter().zip(&anchors);
        let springs = springs.flat_map(|(held, anchors)| held.spring.loads(anchors, &linkage, graph)).collect();
        let displacement = |link: usize| linkage.links[link].edge?.displacement();
        let moving: Vec<usize> = (0..linkage.links.len()).filter(|&link| displacement(link).is_some()).collect();
        let joint_jacobian =
            moving.iter().filter_map(|&link| displacement(link)).map(|d| slope(d, &symbols.q)).collect();
        let gravity = lifted.gravity;
        Tree { linkage, inertias, gravity, loads, springs, moving, joint_jacobian, coordinates: symbols.q.len() }
    }

    /// T of the bodies.
    fn kinetic_energy(&self) -> Expr<'g> {
        twist::kinetic_energy(&self.linkage, &self.inertias)
    }

    /// `M q̈ + C q̇ + G` of the bodies and springs.
    fn forces(&self, accelerations: Accelerations) -> Vec<Expr<'g>> {
        self.swept_back(self.inertial(accelerations))
    }

    /// The same less Q of the loads, in one sweep.
    fn net_forces(&self, accelerations: Accelerations) -> Vec<Expr<'g>> {
        self.swept_back(less(self.inertial(accelerations), self.applied()))
    }

    /// Q of the loads.
    fn applied_forces(&self) -> Vec<Expr<'g>> {
        self.swept_back(self.applied())
    }

    fn inertial(&self, accelerations: Accelerations) -> Vec<Wrench<'g>> {
        let inertial = newton_euler::wrenches(&self.linkage, &self.inertias, self.gravity, accelerations);
        if self.springs.is_empty() { inertial } else { less(inertial, self.wrenches(&self.springs)) }
    }

    fn applied(&self) -> Vec<Wrench<'g>> {
        self.wrenches(&self.loads)
    }

    fn wrenches(&self, loads: &[Load<'g>]) -> Vec<Wrench<'g>> {
        load::wrenches(&self.linkage, loads, self.gravity.0[0].graph())
    }

    fn swept_back(&self, wrenches: Vec<Wrench<'g>>) -> Vec<Expr<'g>> {
        let joint = newton_euler::joint_forces(&self.linkage, wrenches);
        let joint: Vec<_> = self.moving.iter().filter_map(|&link| joint[link]).collect();
        self.on_coordinates(&joint)
    }

    /// M of the bodies: `Sᵀ M̂ S`, with M̂ over the joints.
    fn mass_matrix(&self) -> Rows<'g> {
        self.congruent(&self.joint_mass_matrix(&self.composites()))
    }

    /// C of the bodies: `Sᵀ Ĉ S + Sᵀ M̂ Ṡ`, with Ĉ and M̂ over the joints, and what poses change by themselves, at `q̇ = 0`, once
    /// more (`docs/structured.md`, sections 2 and 8).
    fn coriolis_matrix(&self) -> Rows<'g> {
        let composites = self.composites();
        let joint_coriolis = coriolis::coriolis_matrix(&self.linkage, &self.moving, &composites);
        let turning = product(&self.joint_mass_matrix(&composites), &self.joint_jacobian_rate());
        let along_the_motion = sum(&self.congruent(&joint_coriolis), &self.transposed_times(&turning));
        let explicit = along_the_motion.iter().map(|row| at_rest(row)).collect();
        sum(&along_the_motion, &explicit)
    }

    fn composites(&self) -> Vec<Inertia<'g>> {
        composite::composites(&self.linkage, &self.inertias)
    }

    /// M̂
    fn joint_mass_matrix(&self, composites: &[Inertia<'g>]) -> Rows<'g> {
        composite::mass_matrix(&self.linkage, &self.moving, composites)
    }

    /// Ṡ
    fn joint_jacobian_rate(&self) -> Rows<'g> {
        self.joint_jacobian.iter().map(|row| row.iter().map(|&e| linkage::rate(e)).collect()).collect()
    }

    /// `Sᵀ A S`
    fn congruent(&self, a: &Rows<'g>) -> Rows<'g> {
        // A S: row by row as Sᵀ turns columns.
        let half = a.iter().map(|row| self.on_coordinates(row)).collect();
        self.transposed_times(&half)
    }

    /// `Sᵀ A`
    fn transposed_times(&self, a: &Rows<'g>) -> Rows<'g> {
        let columns = transpose(a, self.coordinates);
        transpose(&columns.iter().map(|column| self.on_coordinates(column)).collect(), self.coordinates)
    }

    /// `Sᵀ f`: what forces along the joints are along the coordinates.
    fn on_coordinates(&self, forces: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let zero = self.gravity.0[0].graph().integer(0);
        let on = |k: usize| forces.iter().zip(&self.joint_jacobian).fold(zero, |sum, (&f, slope)| sum + slope[k] * f);
        (0..self.coordinates).map(on).collect()
    }
}

/// Link by link.
fn less<'g>(a: Vec<Wrench<'g>>, b: Vec<Wrench<'g>>) -> Vec<Wrench<'g>> {
    a.into_iter().zip(b).map(|(a, b)| a.minus(b)).collect()
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
