//! Regrouping: masses move towards the base as far as joints cannot tell, so that fewer numbers remain.
//!
//! From the tips to the base, with what is already grouped at a link:
//!
//! - a constant edge moves all of it to the parent;
//! - a turn about an axis moves the line of mass on the axis: m, `(e·h) e`, `(e·Σ e) e eᵀ`;
//! - a slide moves Σ, which does not see where it is: second moments without mass are the same about every point;
//! - what reaches the base does not move at all.
//!
//! The energies are the same functions of the coordinates, up to a constant of V; the single groups need not be bodies.
//! Source: Gautier & Khalil, *Direct calculation of minimum set of inertial parameters of serial robots*, 1990, for the rule
//! of the turn, here with second moments in the place of inertias.

use crate::expr::Graph;

use super::inertia::Inertia;
use super::linkage::{Edge, Linkage};

/// The same mechanism with its masses where they are cheapest.
pub(super) fn regrouped<'g>(linkage: &Linkage<'g>, inertias: Vec<Inertia<'g>>) -> Vec<Inertia<'g>> {
    let mut grouped = inertias;
    let graph = grouped[0].mass.graph();
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        let unseen = unseen(&grouped[number], &edge, graph);
        grouped[number] = grouped[number].minus(unseen);
        grouped[parent] = grouped[parent].plus(seen_from_parent(unseen, &edge));
    }
    grouped[0] = Inertia::zero(graph);
    grouped
}

fn unseen<'g>(inertia: &Inertia<'g>, edge: &Edge<'g>, graph: &'g Graph) -> Inertia<'g> {
    match *edge {
        Edge::Turn(_) | Edge::Shift(_) => *inertia,
        Edge::Revolute { axis, .. } => inertia.on_axis(axis),
        Edge::Slide { .. } => Inertia { second: inertia.second, ..Inertia::zero(graph) },
    }
}

fn seen_from_parent<'g>(inertia: Inertia<'g>, edge: &Edge<'g>) -> Inertia<'g> {
    match *edge {
        Edge::Turn(r) => inertia.turned(r),
        Edge::Shift(t) => inertia.shifted(t),
        // The line is on the axis; second moments without mass are the same about every point.
        Edge::Revolute { .. } | Edge::Slide { .. } => inertia,
    }
}
