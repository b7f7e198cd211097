//! Loads: forces on points and torques on bodies, as wrenches on links.
//!
//! Swept back together with what it takes to move the masses, a load costs its turn into the axes of its link and no more.

use crate::expr::{Graph, Vector};

use super::linkage::{Edge, Linkage};
use super::wrench::{Wrench, turned_about};

/// A force on a point of a link, or a torque on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load<'g> {
    /// The link.
    pub(crate) link: usize,
    /// Where the force acts, in the link's axes; a torque acts nowhere.
    pub(crate) point: Option<Vector<'g>>,
    /// The force or torque.
    pub(crate) vector: Vector<'g>,
    /// Whether its components are along the axes of the world, not those of the link.
    pub(crate) is_in_world: bool,
}

/// What acts on each link.
pub(super) fn wrenches<'g>(linkage: &Linkage<'g>, loads: &[Load<'g>], graph: &'g Graph) -> Vec<Wrench<'g>> {
    let mut wrenches = vec![Wrench::zero(graph); linkage.links.len()];
    for load in merged(loads) {
        let along = |link: usize| if load.is_in_world { in_link(linkage, link, load.vector) } else { load.vector };
        let Some(point) = load.point else {
            let couple = Wrench { force: Vector::zero(graph), couple: along(load.link) };
            wrenches[load.link] = wrenches[load.link].plus(couple);
            continue;
        };
        let couple = point.cross(along(load.link));
        wrenches[load.link] = wrenches[load.link].plus(Wrench { force: Vector::zero(graph), couple });
        let taker = if load.is_in_world { first_of_place(linkage, load.link) } else { load.link };
        wrenches[taker] = wrenches[taker].plus(Wrench { force: along(taker), couple: Vector::zero(graph) });
    }
    wrenches
}

/// The link nearest to the base that has the same origin at all times. Joints between it and this one turn: a force through the
/// origin does nothing along them, and in axes nearer to the world it keeps the digits that it was given with.
fn first_of_place(linkage: &Linkage<'_>, mut link: usize) -> usize {
    while let (Some(parent), Some(edge)) = (linkage.links[link].parent, linkage.links[link].edge) {
        match edge {
            Edge::Turn(_) | Edge::Revolute { .. } | Edge::Tilt { .. } => link = parent,
            Edge::Shift(_) | Edge::Slide { .. } => break,
        }
    }
    link
}

/// Those at one point added up: they are turned once.
fn merged<'g>(loads: &[Load<'g>]) -> Vec<Load<'g>> {
    let mut merged: Vec<Load<'g>> = Vec::new();
    for load in loads {
        let same = |other: &&mut Load<'g>| {
            (other.link, other.point, other.is_in_world) == (load.link, load.point, load.is_in_world)
        };
        match merged.iter_mut().find(same) {
            Some(other) => other.vector = other.vector + load.vector,
            None => merged.push(*load),
        }
    }
    merged
}

/// A vector of the world in the axes of a link, turned edge by edge.
fn in_link<'g>(linkage: &Linkage<'g>, link: usize, vector: Vector<'g>) -> Vector<'g> {
    let up = |&link: &usize| linkage.links[link].parent;
    let way: Vec<usize> = std::iter::successors(Some(link), up).collect();
    way.iter().rev().filter_map(|&link| linkage.links[link].edge).fold(vector, |v, edge| match edge {
        Edge::Turn(r) => r.transpose() * v,
        Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => turned_about(v, axis, -sin, cos),
        Edge::Shift(_) | Edge::Slide { .. } => v,
    })
}
