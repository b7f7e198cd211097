//! Composite bodies: M from what each joint carries when it moves alone.
//!
//! The masses beyond a joint, as one rigid body `(m, h, Σ)`, take the wrench of momentum `f = e × h`, `n = J e` per
//! unit of a turn about e, `f = m d`, `n = h × d` per unit of a slide along d; its part on the joints towards the base
//! is a column of M.
//!
//! Source: Walker & Orin, *Efficient dynamic computer simulation of robotic mechanisms*, 1982.

use crate::expr::{Expr, Vector};
use crate::mistake::rule;

use super::super::Rows;
use super::inertia::Inertia;
use super::linkage::{Edge, Linkage};
use super::notation;
use super::wrench::Wrench;

/// The masses beyond each edge as one body, in the axes of the link behind it.
pub(super) fn composites<'g>(linkage: &Linkage<'g>, inertias: &[Inertia<'g>]) -> Vec<Inertia<'g>> {
    let mut composites = inertias.to_vec();
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        composites[parent] = composites[parent].plus(across(composites[number], &edge));
    }
    composites.iter().zip(linkage.joints()).for_each(|(composite, joint)| notation::inertia("c", joint, composite));
    composites
}

fn across<'g>(inertia: Inertia<'g>, edge: &Edge<'g>) -> Inertia<'g> {
    match *edge {
        Edge::Turn(r) => inertia.turned(r),
        Edge::Shift(t) => inertia.shifted(t),
        Edge::Slide { direction, displacement } => inertia.shifted(direction.scale(displacement)),
        Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => inertia.turned_about(axis, sin, cos),
    }
}

/// M over the moving edges, in the order of `moving`; pairs on different branches are 0.
pub(super) fn mass_matrix<'g>(linkage: &Linkage<'g>, moving: &[usize], composites: &[Inertia<'g>]) -> Rows<'g> {
    let zero = composites[0].mass.graph().integer(0);
    let mut m = vec![vec![zero; moving.len()]; moving.len()];
    for (column, &joint) in moving.iter().enumerate() {
        let Some(edge) = linkage.links[joint].edge else { continue };
        for (row, part) in on_joints(linkage, moving, joint, momentum(&composites[joint], &edge)) {
            m[column][row] = part;
            m[row][column] = part;
        }
    }
    m
}

/// What a wrench at a link does to the moving edges from there to the base.
pub(super) fn on_joints<'g>(
    linkage: &Linkage<'g>,
    moving: &[usize],
    from: usize,
    wrench: Wrench<'g>,
) -> Vec<(usize, Expr<'g>)> {
    let (mut at, mut wrench, mut parts) = (from, wrench, Vec::new());
    while let (Some(parent), Some(edge)) = (linkage.links[at].parent, linkage.links[at].edge) {
        if let (Some(part), Ok(row)) = (wrench.along(&edge), moving.binary_search(&at)) {
            parts.push((row, part));
        }
        (at, wrench) = (parent, wrench.across(&edge));
    }
    parts
}

/// Momentum per unit of the edge's motion.
pub(super) fn momentum<'g>(inertia: &Inertia<'g>, edge: &Edge<'g>) -> Wrench<'g> {
    let zero = Vector::zero(inertia.mass.graph());
    match *edge {
        Edge::Revolute { axis, .. } => {
            let mut couple = Vector([0, 1, 2].map(|i| -inertia.second.entry(i, axis)));
            couple.0[axis] = inertia.axial(axis);
            let e = Vector::unit(inertia.mass.graph(), axis);
            Wrench::new(rule!("the momentum of a turn", e.cross(inertia.first), inertia.first.cross(e)), couple)
        }
        Edge::Slide { direction, .. } => Wrench::new(direction.scale(inertia.mass), inertia.first.cross(direction)),
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => Wrench::new(zero, zero),
    }
}
