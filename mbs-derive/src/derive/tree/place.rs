//! Places: links that share their origin, because only turns are between them.
//!
//! A force F at an arm r from the place takes the moment `e·(r × F)` of each joint there, with both in the axes of the
//! link behind it; or else its couple is turned from link to link. Where the force is along an axis the one is 0 as it
//! stands, and the other keeps what the rounding of the turns leaves: of a weight far from the place, more than all
//! else about the axis.

use crate::expr::{Expr, Vector};

use super::linkage::{Edge, Linkage};
use super::wrench::Wrench;

/// What a force does about the joints of a place, one wrench a link; `None` where turned couples are as good.
///
/// `links` are of one place, each before its parent, the first of the place last; `arms` are fixed in each of them, and
/// the same `force` acts at all of them, here in the axes of the first.
pub(super) fn moments<'g>(
    linkage: &Linkage<'g>,
    links: &[usize],
    arms: &[Vector<'g>],
    force: Vector<'g>,
) -> Option<Vec<Wrench<'g>>> {
    let zero = Vector::zero(force.0[0].graph());
    let (size, direction) = split(force);
    let arms: Vec<Vector<'g>> = arms.iter().map(|arm| arm.scale(size)).collect();
    let forces = swept_out(linkage, links, direction);
    let couples: Vec<Vector<'g>> = arms.iter().zip(&forces).map(|(arm, force)| arm.cross(*force)).collect();
    let (turned, reaches) = (swept_back(linkage, links, &couples), swept_back(linkage, links, &arms));
    let axis = |i: usize| match linkage.links[links[i]].edge {
        Some(Edge::Revolute { axis, .. }) => Some(axis),
        _ => None,
    };
    let about = |i: usize| axis(i).map(|axis| (turned[i].0[axis], reaches[i].cross(forces[i]).0[axis]));
    let vanishes = |(turned, direct): (Expr<'g>, Expr<'g>)| direct.is_zero() && !turned.is_zero();
    if !(0..links.len()).any(|i| about(i).is_some_and(vanishes)) {
        return None;
    }
    let first = links.len() - 1;
    let moment = |i: usize| match about(i) {
        Some((_, direct)) => Wrench { about_edge: direct, ..Wrench::new(zero, zero) },
        None if i == first => Wrench::new(zero, reaches[i].cross(forces[i])),
        None => Wrench::new(zero, zero),
    };
    Some((0..links.len()).map(moment).collect())
}

/// A force along an axis as its size and the axis, where the size is constant in time and joins the arms.
fn split<'g>(force: Vector<'g>) -> (Expr<'g>, Vector<'g>) {
    let graph = force.0[0].graph();
    let along: Vec<usize> = (0..3).filter(|&i| !force.0[i].is_zero()).collect();
    match along[..] {
        [axis] if graph.is_parametric(force.0[axis].id()) => (force.0[axis], Vector::unit(graph, axis)),
        _ => (graph.integer(1), force),
    }
}

/// A vector of the first link of a place in the axes of each.
fn swept_out<'g>(linkage: &Linkage<'g>, links: &[usize], vector: Vector<'g>) -> Vec<Vector<'g>> {
    let mut vectors = vec![vector; links.len()];
    for (i, &link) in links.iter().enumerate().rev() {
        if let Some((at, edge)) = within(linkage, links, link) {
            vectors[i] = edge.turned_back(vectors[at]);
        }
    }
    vectors
}

/// Vectors of links of one place added up towards its first link, each sum in the axes of its link.
fn swept_back<'g>(linkage: &Linkage<'g>, links: &[usize], vectors: &[Vector<'g>]) -> Vec<Vector<'g>> {
    let mut sums = vectors.to_vec();
    for (i, &link) in links.iter().enumerate() {
        if let Some((at, edge)) = within(linkage, links, link) {
            sums[at] = sums[at] + edge.turned(sums[i]);
        }
    }
    sums
}

/// Where the parent of a link is among those of its place, and the turn between them; the first has none.
fn within<'g>(linkage: &Linkage<'g>, links: &[usize], link: usize) -> Option<(usize, Edge<'g>)> {
    let (parent, edge) = (linkage.links[link].parent?, linkage.links[link].edge.filter(Edge::only_turns)?);
    Some((links.iter().position(|&other| other == parent)?, edge))
}

#[cfg(test)]
mod tests {
    use super::super::trial::{joint, linkage, value};
    use super::*;
    use crate::expr::{Graph, Symbol};

    #[test]
    fn a_force_along_an_axis_has_no_moment_about_it() {
        let graph = Graph::new();
        let numbers = |v: [i64; 3]| Vector(v.map(|i| graph.integer(i)));
        let arm = linkage(&[(0, joint(2, 0, &graph)), (1, joint(1, 1, &graph)), (2, joint(0, 2, &graph))]);
        let (links, arms) = ([3, 2, 1, 0], [[1, 2, 3], [4, 5, 6], [0; 3], [0; 3]].map(numbers));
        let weight = numbers([0, 0, 1]).scale(graph.symbol(Symbol::Parameter(0)));
        let moments = moments(&arm, &links, &arms, weight).expect("about the first joint there is none");
        assert!(moments[2].about_edge.is_zero());
        // The others are those of the couples, turned from link to link.
        let mut couple = Vector::zero(&graph);
        for (i, edge) in links.iter().enumerate().filter_map(|(i, &link)| Some((i, arm.links[link].edge?))) {
            couple = couple + arms[i].cross(swept_out(&arm, &links, weight)[i]);
            let expected = couple.0[[0, 1, 2][i]];
            assert!((value(moments[i].about_edge) - value(expected)).abs() < 1e-14 * 30.0, "{i}");
            couple = edge.turned(couple);
        }
        // A force along no axis loses nothing by it.
        assert!(super::moments(&arm, &links, &arms, numbers([1, 2, 3])).is_none());
    }
}
