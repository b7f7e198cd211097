//! For tests: linkages of a few joints, bodies without symmetry, and the same kinetic energy at one state.

use crate::expr::{Expr, Graph, Symbol, Vector, evaluate};

use super::inertia::{Inertia, Symmetric};
use super::linkage::{Edge, Link, Linkage};
use super::twist;

/// The links behind the base, each given by its parent and its edge.
pub(super) fn linkage<'g>(edges: &[(usize, Edge<'g>)]) -> Linkage<'g> {
    let base = Link { parent: None, edge: None };
    let links = edges.iter().map(|&(parent, edge)| Link { parent: Some(parent), edge: Some(edge) });
    Linkage { links: std::iter::once(base).chain(links).collect() }
}

/// Turns by a coordinate.
pub(super) fn joint(axis: usize, coordinate: u32, graph: &Graph) -> Edge<'_> {
    Edge::revolute(axis, graph.symbol(Symbol::Coordinate(coordinate)))
}

/// A different one for each link.
pub(super) fn body(link: usize, graph: &Graph) -> Inertia<'_> {
    let number = |i: usize| graph.integer((link + 1) as i64 * 10 + i as i64);
    let second = Symmetric { diagonal: [7, 8, 9].map(number), products: [1, 2, 3].map(number) };
    Inertia { mass: number(0), first: Vector([4, 5, 6].map(number)), second }
}

/// Asserts it to rounding.
pub(super) fn same_energy(a: (&Linkage<'_>, &[Inertia<'_>]), b: (&Linkage<'_>, &[Inertia<'_>])) {
    let [a, b] = [a, b].map(|(linkage, inertias)| {
        let twists = twist::twists(linkage, inertias[0].mass.graph().integer(0));
        value(twist::kinetic_energy(inertias, &twists))
    });
    assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b}");
}

/// At one state.
pub(super) fn value(e: Expr<'_>) -> f64 {
    evaluate(&[e], |symbol| match symbol {
        Symbol::Coordinate(i) => 0.3 + 0.7 * f64::from(i),
        Symbol::Velocity(i) => 1.1 - 0.4 * f64::from(i),
        Symbol::Parameter(i) => 1.7 + 0.2 * f64::from(i),
        _ => unreachable!("nothing else moves"),
    })[0]
}
