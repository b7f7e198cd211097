//! Loads: forces on points and torques on bodies, as wrenches on links.
//!
//! Swept back together with what it takes to move the masses, a load costs its turn into the axes of its link and no
//! more.

use crate::expr::{Graph, Vector};

use super::linkage::Linkage;
use super::place;
use super::wrench::Wrench;

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
    let zero = Vector::zero(graph);
    let mut wrenches = vec![Wrench::zero(graph); linkage.links.len()];
    for load in merged(loads) {
        let along = |link: usize| if load.is_in_world { in_link(linkage, link, load.vector) } else { load.vector };
        let Some(point) = load.point else {
            wrenches[load.link] = wrenches[load.link].plus(Wrench::new(zero, along(load.link)));
            continue;
        };
        let taker = if load.is_in_world { linkage.first_of_place(load.link) } else { load.link };
        let way = linkage.way(load.link, taker);
        let arms: Vec<Vector<'g>> = way.iter().map(|&link| if link == load.link { point } else { zero }).collect();
        let couple = || vec![Wrench::new(zero, point.cross(along(load.link)))];
        let moments = place::moments(linkage, &way, &arms, along(taker)).unwrap_or_else(couple);
        for (&link, moment) in way.iter().zip(moments) {
            wrenches[link] = wrenches[link].plus(moment);
        }
        wrenches[taker] = wrenches[taker].plus(Wrench::new(along(taker), zero));
    }
    wrenches
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
    let way = linkage.way(link, 0);
    way.iter().rev().filter_map(|&link| linkage.links[link].edge).fold(vector, |v, edge| edge.turned_back(v))
}
