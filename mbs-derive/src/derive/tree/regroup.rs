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

use crate::expr::{Expr, Graph};

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

/// The axes of a link at a tip need not follow a body that looks the same from all sides: a wheel, a rotor, a top.
///
/// With `h = 0` across the axis and `Σ = diag(s, s, ·)` the body's moments are the same in axes that do not spin.
pub(super) fn without_spin<'g>(linkage: &Linkage<'g>, inertias: &[Inertia<'g>]) -> Linkage<'g> {
    let mut calm = linkage.clone();
    let mut loaded: Vec<bool> = vec![false; inertias.len()];
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let Some(parent) = link.parent else { continue };
        if let (Some(Edge::Revolute { axis, angle, .. }), false) = (link.edge, loaded[number])
            && is_round(&inertias[number], axis)
        {
            let graph = angle.graph();
            let edge = Edge::Revolute { axis, angle, sin: graph.integer(0), cos: graph.integer(1) };
            calm.links[number].edge = Some(edge);
        }
        loaded[parent] |= loaded[number] || !inertias[number].is_zero();
    }
    calm
}

fn is_round(inertia: &Inertia<'_>, axis: usize) -> bool {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let across = [inertia.first.0[i], inertia.first.0[j]];
    let products = inertia.second.products;
    let vanish = across.iter().chain(&products).all(|e: &Expr<'_>| e.is_zero());
    vanish && inertia.second.diagonal[i] == inertia.second.diagonal[j]
}

fn unseen<'g>(inertia: &Inertia<'g>, edge: &Edge<'g>, graph: &'g Graph) -> Inertia<'g> {
    match *edge {
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => *inertia,
        Edge::Revolute { axis, .. } => inertia.on_axis(axis),
        Edge::Slide { .. } => Inertia { second: inertia.second, ..Inertia::zero(graph) },
    }
}

fn seen_from_parent<'g>(inertia: Inertia<'g>, edge: &Edge<'g>) -> Inertia<'g> {
    match *edge {
        Edge::Turn(r) => inertia.turned(r),
        Edge::Tilt { axis, sin, cos } => inertia.turned_about(axis, sin, cos),
        Edge::Shift(t) => inertia.shifted(t),
        // The line is on the axis; second moments without mass are the same about every point.
        Edge::Revolute { .. } | Edge::Slide { .. } => inertia,
    }
}
