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
//! Source: Gautier & Khalil, *Direct calculation of minimum set of inertial parameters of serial robots*, 1990, for the
//! rule of the turn, here with second moments in the place of inertias.

use crate::expr::{Expr, Graph};

use super::inertia::Inertia;
use super::linkage::{Edge, Linkage};
use super::notation;

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
    grouped.iter().zip(linkage.joints()).for_each(|(inertia, joint)| notation::inertia("r", joint, inertia));
    grouped
}

/// The axes of a link at a tip need not follow a body that looks the same from all sides: a wheel, a rotor, a top.
///
/// Links that are held by something need theirs. With `h = 0` across the axis and `Σ = diag(s, s, ·)` the body's
/// moments are the same in axes that do not spin.
pub(super) fn without_spin<'g>(
    linkage: &Linkage<'g>,
    inertias: &[Inertia<'g>],
    held: impl Iterator<Item = usize>,
) -> Linkage<'g> {
    let mut calm = linkage.clone();
    let mut loaded: Vec<bool> = vec![false; inertias.len()];
    held.for_each(|link| loaded[link] = true);
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

#[cfg(test)]
mod tests {
    use super::super::trial::{body, joint, linkage, same_energy};
    use super::*;
    use crate::expr::{Matrix, Symbol, Vector};

    /// On a base that does not move: a joint, all constant edges, a slide.
    fn arm(graph: &Graph) -> Linkage<'_> {
        let numbers = |v: [i64; 3]| Vector(v.map(|i| graph.integer(i)));
        let angle = graph.integer(2);
        linkage(&[
            (0, joint(1, 0, graph)),
            (1, Edge::Shift(numbers([1, -2, 3]))),
            (2, Edge::Turn(Matrix::rotation(Vector::unit(graph, 0), angle))),
            (3, Edge::Tilt { axis: 2, sin: angle.sin(), cos: angle.cos() }),
            (4, joint(2, 1, graph)),
            (2, Edge::Slide { direction: numbers([3, 0, 4]), displacement: graph.symbol(Symbol::Coordinate(2)) }),
        ])
    }

    #[test]
    fn regrouping_keeps_the_kinetic_energy() {
        let graph = Graph::new();
        let arm = arm(&graph);
        let inertias: Vec<_> = (0..arm.links.len()).map(|link| body(link, &graph)).collect();
        same_energy((&arm, &inertias), (&arm, &regrouped(&arm, inertias.clone())));
    }

    #[test]
    fn nothing_is_left_that_a_joint_does_not_feel() {
        let graph = Graph::new();
        let arm = arm(&graph);
        let grouped = regrouped(&arm, (0..arm.links.len()).map(|link| body(link, &graph)).collect());
        for still in [0, 2, 3, 4] {
            assert!(grouped[still].is_zero(), "constant edges hand on all, and nothing moves the base");
        }
        let [tip, slide] = [&grouped[5], &grouped[6]];
        assert!(tip.mass.is_zero() && tip.first.0[2].is_zero() && tip.second.diagonal[2].is_zero());
        assert!(!tip.first.0[0].is_zero() && !slide.mass.is_zero());
        assert!(slide.second.diagonal.iter().chain(&slide.second.products).all(|e| e.is_zero()));
    }

    #[test]
    fn a_round_tip_needs_no_axes_that_spin() {
        let graph = Graph::new();
        let arm = linkage(&[(0, joint(1, 0, &graph)), (1, joint(2, 1, &graph))]);
        let number = |i| graph.integer(i);
        let mut wheel = Inertia::zero(&graph);
        (wheel.mass, wheel.first.0[2]) = (number(3), number(2));
        wheel.second.diagonal = [number(5), number(5), number(7)];
        let inertias = [Inertia::zero(&graph), body(1, &graph), wheel];
        let calm = without_spin(&arm, &inertias, [].into_iter());
        assert!(matches!(calm.links[2].edge, Some(Edge::Revolute { sin, .. }) if sin.is_zero()));
        assert_eq!(calm.links[1].edge, arm.links[1].edge, "what carries something else is turned");
        same_energy((&arm, &inertias), (&calm, &inertias));

        wheel.second.diagonal[0] = number(6);
        let inertias = [inertias[0], inertias[1], wheel];
        assert_eq!(without_spin(&arm, &inertias, [].into_iter()).links[2].edge, arm.links[2].edge);
    }
}
