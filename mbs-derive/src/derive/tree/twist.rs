//! Velocities of the links, swept from the base to the tips, and the kinetic energy that follows.

use crate::expr::{Expr, Vector};

use super::inertia::Inertia;
use super::linkage::{Edge, Linkage, rate};
use super::notation;
use super::wrench::{Wrench, turned_about};

/// ω and the velocity of the origin, in the axes of the link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist<'g> {
    pub(super) angular: Vector<'g>,
    pub(super) linear: Vector<'g>,
}

/// Velocities of every link; the base rests.
pub(super) fn twists<'g>(linkage: &Linkage<'g>, zero: Expr<'g>) -> Vec<Twist<'g>> {
    let mut twists = vec![Twist { angular: Vector([zero; 3]), linear: Vector([zero; 3]) }];
    for (link, joint) in linkage.links.iter().zip(linkage.joints()).skip(1) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { unreachable!("only the base has no parent") };
        let twist = twists[parent].beyond(&edge);
        notation::vector("w", joint, twist.angular);
        notation::vector("v", joint, twist.linear);
        twists.push(twist);
    }
    twists
}

/// Velocities of every link without what all links beyond it have in common because the base slides along directions
/// that are fixed in the world.
pub(super) fn twists_on_slides<'g>(linkage: &Linkage<'g>, zero: Expr<'g>) -> Vec<Twist<'g>> {
    let rest = Twist { angular: Vector([zero; 3]), linear: Vector([zero; 3]) };
    let mut twists = vec![rest];
    // Which links do not turn.
    let mut is_straight = vec![true];
    for link in linkage.links.iter().skip(1) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { unreachable!("only the base has no parent") };
        let is_on_slides = is_straight[parent] && !matches!(edge, Edge::Revolute { .. });
        is_straight.push(is_on_slides);
        twists.push(if is_on_slides { rest } else { twists[parent].beyond(&edge) });
    }
    twists
}

impl<'g> Twist<'g> {
    fn beyond(&self, edge: &Edge<'g>) -> Self {
        let Twist { angular: w, linear: v } = *self;
        match *edge {
            Edge::Turn(r) => Twist { angular: r.transpose() * w, linear: r.transpose() * v },
            Edge::Tilt { axis, sin, cos } => {
                let [angular, linear] = [w, v].map(|u| turned_about(u, axis, -sin, cos));
                Twist { angular, linear }
            }
            Edge::Shift(t) => Twist { angular: w, linear: v + w.cross(t) },
            Edge::Slide { direction, displacement } => {
                let rate = rate(displacement);
                Twist { angular: w, linear: v + w.cross(direction.scale(displacement)) + direction.scale(rate) }
            }
            Edge::Revolute { axis, angle, sin, cos } => {
                let rate = rate(angle);
                let [w, v] = [w, v].map(|u| turned_about(u, axis, -sin, cos));
                Twist { angular: w + Vector::unit(rate.graph(), axis).scale(rate), linear: v }
            }
        }
    }
}

/// `Σ ½ m v·v + h·(v × ω) + ½ ωᵀ J ω` over the links.
pub(super) fn kinetic_energy<'g>(inertias: &[Inertia<'g>], twists: &[Twist<'g>]) -> Expr<'g> {
    let zero = inertias[0].mass.graph().integer(0);
    inertias.iter().zip(twists).fold(zero, |sum, (inertia, twist)| sum + energy(inertia, twist))
}

/// `∂T/∂(v, ω)` of each link, a wrench: force `m v + ω × h`, couple `h × v + J ω`.
pub(super) fn momenta<'g>(inertias: &[Inertia<'g>], twists: &[Twist<'g>]) -> Vec<Wrench<'g>> {
    inertias.iter().zip(twists).map(|(inertia, twist)| momentum(inertia, twist)).collect()
}

fn momentum<'g>(inertia: &Inertia<'g>, twist: &Twist<'g>) -> Wrench<'g> {
    let Twist { angular: w, linear: v } = *twist;
    let second = &inertia.second;
    let spin = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        inertia.axial(i) * w.0[i] - (second.products[k] * w.0[j] + second.products[j] * w.0[k])
    };
    let couple = inertia.first.cross(v) + Vector([0, 1, 2].map(spin));
    Wrench::new(v.scale(inertia.mass) + w.cross(inertia.first), couple)
}

fn energy<'g>(inertia: &Inertia<'g>, twist: &Twist<'g>) -> Expr<'g> {
    let Twist { angular: w, linear: v } = *twist;
    let second = &inertia.second;
    let axial = (0..3).map(|i| inertia.axial(i) * w.0[i].powi(2));
    // J_ij = −Σ_ij
    let products = (0..3).map(|i| -second.products[i] * (w.0[(i + 1) % 3] * w.0[(i + 2) % 3]));
    let turning = axial.zip(products).fold(w.0[0].graph().integer(0), |sum, (a, p)| sum + (a / 2 + p));
    inertia.mass * v.norm_squared() / 2 + inertia.first.dot(v.cross(w)) + turning
}
