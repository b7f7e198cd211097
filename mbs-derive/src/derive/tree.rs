//! The structured route: bodies on a tree of frames, by Newton–Euler and composite bodies.
//!
//! Where a mechanism is declared by bodies on frames, its equations follow in a form that is shorter than what
//! differentiation of the energies gives:
//!
//! - `linkage`: the declared frames, reduced to what moves;
//! - `inertia`: pseudo-inertias, mass with its first and second moments;
//! - `gauge`: frames turned about their joint axes until constant turns are plane rotations;
//! - `regroup`: masses move towards the base as far as joints cannot tell;
//! - `twist`: velocities, and the kinetic energy;
//! - `newton_euler`: motions out, wrenches back: inverse dynamics, bias, gravity;
//! - `place`: links that share their origin, and moments about their joints;
//! - `load`: forces on points and torques on bodies, which ride along with the wrenches;
//! - `force_element`: springs and dampers between points, likewise;
//! - `composite`: the mass matrix; `coriolis`: the Coriolis matrix; `derivative`: derivatives of inverse dynamics;
//! - `articulated`: accelerations without a mass matrix, for long chains;
//! - `notation`: what all these are called in generated code.
//!
//! What is no body is derived plainly and added.

mod articulated;
mod composite;
mod coriolis;
mod derivative;
pub(super) mod force_element;
mod gauge;
pub(super) mod inertia;
pub(super) mod linkage;
pub(super) mod load;
mod newton_euler;
mod notation;
mod place;
mod regroup;
#[cfg(test)]
mod trial;
mod twist;
mod wrench;

use std::collections::BTreeMap;

use crate::expr::normal::weight;
use crate::expr::{Expr, Node, Symbol, Tangent, Vector, gradient};

use super::lagrange::{add, at_rest, sub, transpose};
use super::lift::Lifted;
use super::{Energies, FEW_COORDINATES, Lagrange, LeftOut, Rows, Slopes, Symbols};
use articulated::Drive;
use force_element::{Anchor, Held};
use inertia::Inertia;
use linkage::{Accelerations, Linkage};
use load::Load;
use twist::Twist;
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
    left_out: LeftOut,
) -> Lagrange<'g> {
    let tree = Tree::new(lifted, masses, symbols);
    if left_out.mass_matrix {
        return tree.dynamics(lifted, energies, rest, symbols);
    }
    let bias = add(&tree.bias(), &rest.bias);
    let kinetic_energy = tree.kinetic_energy() + rest.kinetic_energy;
    // L with T written shorter.
    let lagrangian = energies.lagrangian - energies.kinetic + kinetic_energy;
    let inverse_dynamics = add(&tree.inverse_dynamics(), &rest.inverse_dynamics);
    let residual = match tree.loads.is_empty() {
        true => sub(&inverse_dynamics, &rest.generalized_force),
        false => add(&tree.net_forces(Accelerations::Given), &rest.residual),
    };
    let free_force = match tree.is_free() {
        true => free_force(&bias, rest),
        false => sub(&rest.free_force, &tree.net_forces(Accelerations::Zero)),
    };
    let dissipation_force = gradient(energies.dissipation, &symbols.qd);
    Lagrange {
        kinetic_energy,
        potential_energy: energies.potential,
        momentum: gradient(lagrangian, &symbols.qd),
        position_gradient: gradient(lagrangian, &symbols.q),
        mass_matrix: sum(&tree.mass_matrix(), &rest.mass_matrix),
        coriolis_matrix: match left_out.coriolis_matrix {
            true => Rows::new(),
            false => sum(&tree.coriolis_matrix(), &rest.coriolis_matrix),
        },
        gravity: at_rest(&bias),
        inverse_dynamics,
        bias,
        dissipation_force: cheaper(dissipation_force, add(&tree.dissipation_force(), &rest.dissipation_force)),
        generalized_force: cheaper(energies.forces.clone(), add(&tree.applied_forces(), &rest.generalized_force)),
        residual,
        free_force,
        accelerations: tree.accelerations(rest, lifted.own_inertia(symbols)),
        slopes: tree.slopes(rest, left_out),
    }
}

/// `M q̈ + C q̇ + G + ∂D/∂q̇` of the bodies less Q of the loads, for the coordinates from a number on.
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
    /// What drags on the links, as masses whose T is D.
    drags: Vec<Inertia<'g>>,
    twists: Vec<Twist<'g>>,
    gravity: Vector<'g>,
    loads: Vec<Load<'g>>,
    springs: Vec<Load<'g>>,
    dampers: Vec<Load<'g>>,
    /// The links behind a moving edge, in order.
    moving: Vec<usize>,
    /// `S = ∂s/∂q`, of each moving edge what is not zero, with the numbers of the coordinates; s is its displacement.
    joint_jacobian: Vec<Vec<(usize, Expr<'g>)>>,
    /// The number of coordinates; no edge moves where all bodies rest.
    coordinates: usize,
}

impl<'g> Tree<'g> {
    fn new(lifted: &Lifted<'g>, masses: Masses, symbols: &Symbols) -> Self {
        let graph = lifted.gravity.0[0].graph();
        let turned = gauge::turned(&lifted.linkage, &lifted.inertias);
        let loads: Vec<Load<'g>> = lifted.loads.iter().map(|load| turned.load(load)).collect();
        let anchored = |held: &[Held<'g>]| -> Vec<Vec<Anchor<'g>>> {
            held.iter().map(|held| held.anchors.iter().map(|anchor| turned.anchor(anchor)).collect()).collect()
        };
        let (spring_anchors, damper_anchors) = (anchored(&lifted.springs), anchored(&lifted.dampers));
        // The frames are turned alike: masses have no say in it.
        let drags = gauge::turned(&lifted.linkage, &lifted.drags).inertias;
        let (linkage, inertias) = (turned.linkage, turned.inertias);
        let grouped = |inertias: Vec<Inertia<'g>>| match masses {
            Masses::Regrouped => regroup::regrouped(&linkage, inertias),
            Masses::AsDeclared => inertias,
        };
        let (inertias, drags) = (grouped(inertias), grouped(drags));
        let anchors = spring_anchors.iter().chain(&damper_anchors).flatten().map(|anchor| anchor.link);
        let dragged = (0..drags.len()).filter(|&link| !drags[link].is_zero());
        let held = loads.iter().map(|load| load.link).chain(anchors).chain(dragged);
        let linkage = regroup::without_spin(&linkage, &inertias, held);
        let twists = twist::twists(&linkage, graph.integer(0));
        let loads_of = |held: &[Held<'g>], anchors: &[Vec<Anchor<'g>>]| -> Vec<Load<'g>> {
            let elements = held.iter().map(|held| &held.element).zip(anchors);
            elements.flat_map(|(element, anchors)| element.loads(anchors, &linkage, &twists, graph)).collect()
        };
        let springs = loads_of(&lifted.springs, &spring_anchors);
        let dampers = loads_of(&lifted.dampers, &damper_anchors);
        let displacement = |link: usize| linkage.links[link].edge?.displacement();
        let moving: Vec<usize> = (0..linkage.links.len()).filter(|&link| displacement(link).is_some()).collect();
        let numbers = symbols.q.iter().enumerate().map(|(k, &symbol)| (symbol, k)).collect();
        let joint_jacobian = moving.iter().filter_map(|&link| displacement(link)).map(|d| slope(d, &numbers)).collect();
        let gravity = lifted.gravity;
        let coordinates = symbols.q.len();
        Tree { linkage, inertias, drags, twists, gravity, loads, springs, dampers, moving, joint_jacobian, coordinates }
    }

    /// Whether nothing acts on the links that is neither inertia nor follows from V.
    fn is_free(&self) -> bool {
        self.loads.is_empty() && !self.is_damped()
    }

    fn is_damped(&self) -> bool {
        !self.dampers.is_empty() || self.drags.iter().any(|drag| !drag.is_zero())
    }

    /// T, V, the forces and the dynamics, without M and what is made of it: all that grows with the number of links.
    fn dynamics(
        &self,
        lifted: &Lifted<'g>,
        energies: &Energies<'g>,
        rest: &Lagrange<'g>,
        symbols: &Symbols,
    ) -> Lagrange<'g> {
        let dissipation_force = gradient(energies.dissipation, &symbols.qd);
        Lagrange {
            kinetic_energy: self.kinetic_energy() + rest.kinetic_energy,
            potential_energy: energies.potential,
            slopes: None,
            inverse_dynamics: add(&self.inverse_dynamics(), &rest.inverse_dynamics),
            dissipation_force: cheaper(dissipation_force, add(&self.dissipation_force(), &rest.dissipation_force)),
            generalized_force: cheaper(energies.forces.clone(), add(&self.applied_forces(), &rest.generalized_force)),
            accelerations: self.accelerations(rest, lifted.own_inertia(symbols)),
            momentum: Vec::new(),
            mass_matrix: Rows::new(),
            coriolis_matrix: Rows::new(),
            gravity: Vec::new(),
            bias: Vec::new(),
            residual: Vec::new(),
            free_force: Vec::new(),
            position_gradient: Vec::new(),
        }
    }

    /// T of the bodies.
    fn kinetic_energy(&self) -> Expr<'g> {
        twist::kinetic_energy(&self.inertias, &self.twists)
    }

    /// `C q̇ + G` of the bodies and springs.
    fn bias(&self) -> Vec<Expr<'g>> {
        self.swept_back(self.inertial(Accelerations::Zero))
    }

    /// `M q̈ + C q̇ + G + ∂D/∂q̇` of the bodies, springs and dampers.
    fn inverse_dynamics(&self) -> Vec<Expr<'g>> {
        self.swept_back(self.resisted(self.inertial(Accelerations::Given)))
    }

    /// `M q̈ + C q̇ + G + ∂D/∂q̇ − Q` with Q of the loads, in one sweep.
    fn net_forces(&self, accelerations: Accelerations) -> Vec<Expr<'g>> {
        self.swept_back(less(self.resisted(self.inertial(accelerations)), self.applied()))
    }

    /// The derivatives of inverse dynamics, where joints follow the coordinates linearly and they are asked for.
    fn slopes(&self, rest: &Lagrange<'g>, left_out: LeftOut) -> Option<Slopes<'g>> {
        let is_asked_for = !left_out.inverse_dynamics_jacobian || !left_out.linearization;
        // `Sᵀ A S` costs n³ where each joint follows many coordinates: of many coordinates that is not tried.
        let followed: usize = self.joint_jacobian.iter().map(Vec::len).sum();
        let is_sparse = self.coordinates <= FEW_COORDINATES || followed <= 2 * self.moving.len();
        if !is_asked_for || !is_sparse || !self.linkage.is_linear() {
            return None;
        }
        let joint = derivative::slopes(&self.linkage, &self.moving, &self.inertias, &self.composites(), self.gravity);
        let nothing = vec![Wrench::zero(self.gravity.0[0].graph()); self.linkage.links.len()];
        let others = self.resisted(less(nothing, self.wrenches(&self.springs)));
        let other_inverse_dynamics = add(&self.swept_back(others.clone()), &rest.inverse_dynamics);
        let other_residual = match self.loads.is_empty() {
            true => sub(&other_inverse_dynamics, &rest.generalized_force),
            false => add(&self.swept_back(less(others, self.applied())), &rest.residual),
        };
        Some(Slopes {
            q: self.congruent(&joint.displacement),
            qd: self.congruent(&joint.rate),
            other_inverse_dynamics,
            other_residual,
        })
    }

    /// `∂D/∂q̇` of the dampers.
    fn dissipation_force(&self) -> Vec<Expr<'g>> {
        self.swept_back(self.resisted(vec![Wrench::zero(self.gravity.0[0].graph()); self.linkage.links.len()]))
    }

    /// Q of the loads.
    fn applied_forces(&self) -> Vec<Expr<'g>> {
        self.swept_back(self.applied())
    }

    /// q̈ by articulated bodies, where each joint follows one coordinate, one each, and nothing has inertia but bodies
    /// and what moves with one coordinate: of each of these its [own inertia](Lifted::own_inertia).
    fn accelerations(&self, rest: &Lagrange<'g>, own_inertia: Option<Vec<Expr<'g>>>) -> Option<Vec<Expr<'g>>> {
        let own_inertia = own_inertia?;
        let one = self.gravity.0[0].graph().integer(1);
        let coordinate = |slopes: &Vec<(usize, Expr<'g>)>| match slopes.as_slice() {
            &[(k, slope)] if slope == one => Some(k),
            _ => None,
        };
        let coordinates: Vec<usize> = self.joint_jacobian.iter().map(coordinate).collect::<Option<_>>()?;
        let mut joints: Vec<Option<usize>> = vec![None; self.coordinates];
        for (joint, &k) in coordinates.iter().enumerate() {
            if joints[k].replace(joint).is_some() {
                return None;
            }
        }
        let joints: Vec<usize> = joints.into_iter().collect::<Option<_>>()?;
        let mut drives = vec![None; self.linkage.links.len()];
        for (&link, &k) in self.moving.iter().zip(&coordinates) {
            drives[link] = Some(Drive { force: rest.free_force[k], inertia: own_inertia[k] });
        }
        let wrenches = less(self.resisted(self.inertial(Accelerations::Zero)), self.applied());
        let found = articulated::accelerations(&self.linkage, &self.inertias, wrenches, &drives);
        joints.into_iter().map(|joint| found[self.moving[joint]]).collect()
    }

    fn inertial(&self, accelerations: Accelerations) -> Vec<Wrench<'g>> {
        let inertial = newton_euler::wrenches(&self.linkage, &self.inertias, self.gravity, accelerations);
        if self.springs.is_empty() { inertial } else { less(inertial, self.wrenches(&self.springs)) }
    }

    /// These wrenches and those that it takes to move the links against drag and dampers.
    fn resisted(&self, wrenches: Vec<Wrench<'g>>) -> Vec<Wrench<'g>> {
        if !self.is_damped() {
            return wrenches;
        }
        let drag = twist::momenta(&self.drags, &self.twists);
        let dragged = wrenches.into_iter().zip(drag).map(|(wrench, drag)| wrench.plus(drag)).collect();
        if self.dampers.is_empty() { dragged } else { less(dragged, self.wrenches(&self.dampers)) }
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

    /// C of the bodies: `Sᵀ Ĉ S + Sᵀ M̂ Ṡ`, with Ĉ and M̂ over the joints, and what poses change by themselves, at
    /// `q̇ = 0`, once more (`docs/structured.md`, sections 2 and 8).
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
        let zero = self.gravity.0[0].graph().integer(0);
        let row = |slopes: &Vec<(usize, Expr<'g>)>| {
            let mut row = vec![zero; self.coordinates];
            slopes.iter().for_each(|&(k, slope)| row[k] = linkage::rate(slope));
            row
        };
        self.joint_jacobian.iter().map(row).collect()
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
        let mut on_coordinates = vec![zero; self.coordinates];
        for (&force, slopes) in forces.iter().zip(&self.joint_jacobian) {
            slopes.iter().for_each(|&(k, slope)| on_coordinates[k] = on_coordinates[k] + slope * force);
        }
        on_coordinates
    }
}

/// Link by link.
fn less<'g>(a: Vec<Wrench<'g>>, b: Vec<Wrench<'g>>) -> Vec<Wrench<'g>> {
    a.into_iter().zip(b).map(|(a, b)| a.minus(b)).collect()
}

/// `∂e/∂q`, what is not zero of it, with the numbers of the coordinates.
fn slope<'g>(e: Expr<'g>, numbers: &BTreeMap<Symbol, usize>) -> Vec<(usize, Expr<'g>)> {
    let graph = e.graph();
    let moved = graph.reachable([e.id()]).into_iter().filter_map(|id| match graph.node(id) {
        Node::Symbol(symbol) => numbers.get(&symbol).map(|&k| (k, symbol)),
        _ => None,
    });
    let mut moved: Vec<(usize, Symbol)> = moved.collect();
    moved.sort_unstable();
    let along = |symbol| Tangent::new(move |other| (other == symbol).then(|| graph.integer(1))).of(e);
    moved.into_iter().map(|(k, symbol)| (k, along(symbol))).filter(|(_, slope)| !slope.is_zero()).collect()
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
