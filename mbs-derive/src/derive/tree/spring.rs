//! Springs: terms of V that are functions of points alone, whatever pulls there.
//!
//! `F = −∂V/∂p` is differentiated with the coordinates of the points as the only variables; as a load on the link it is swept back
//! with the other wrenches.

use std::cell::RefCell;
use std::rc::Rc;

use crate::expr::{Expr, Graph, Id, Symbol, Vector, cut, gradient, substitute_into};
use crate::model::landmark::{Landmarks, Place};

use super::linkage::{Edge, Linkage};
use super::load::Load;
use super::wrench::turned_about;

/// `∂V/∂p` of a term of V, over points given elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Spring {
    /// Along which axis of the world each component of a place is.
    axes: Vec<usize>,
    /// In a graph of their own, where coordinate i stands for the i-th of these components.
    slopes: Vec<Id>,
    graph: Rc<Graph>,
}

/// A spring with a point for each of its components.
#[derive(Clone, Debug)]
pub(crate) struct Held<'g> {
    pub(crate) spring: Spring,
    pub(crate) anchors: Vec<Anchor<'g>>,
}

/// A point of a link, in its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor<'g> {
    /// The link.
    pub(crate) link: usize,
    /// The point.
    pub(crate) point: Vector<'g>,
}

impl Spring {
    /// What a term says of points, and the places that its components are of; `None` where it depends on the motion in another
    /// way as well.
    pub(crate) fn of<'v>(term: Expr<'v>, landmarks: &Landmarks<'v>) -> Option<(Self, Vec<Place<'v>>)> {
        let graph = Rc::new(Graph::new());
        let places = RefCell::new(Vec::<Place<'v>>::new());
        let component = |id: Id| {
            let mut places = places.borrow_mut();
            places.push(landmarks.place(id)?);
            Some(graph.symbol(Symbol::Coordinate(places.len() as u32 - 1)))
        };
        let still = |symbol| matches!(symbol, Symbol::Parameter(_) | Symbol::Time | Symbol::Prescribed(_, 0));
        let energy = cut(term, &graph, component, still)?;
        let places = places.take();
        let variables: Vec<Symbol> = (0..places.len() as u32).map(Symbol::Coordinate).collect();
        let slopes = gradient(energy, &variables).iter().map(|slope| slope.id()).collect();
        let axes = places.iter().map(|place| place.axis).collect();
        (!places.is_empty()).then_some((Spring { axes, slopes, graph: graph.clone() }, places))
    }

    /// The forces on its ends, with each component's anchor.
    pub(super) fn loads<'g>(&self, anchors: &[Anchor<'g>], linkage: &Linkage<'g>, graph: &'g Graph) -> Vec<Load<'g>> {
        let component = |(&axis, anchor): (&usize, &Anchor<'g>)| in_world(linkage, anchor).0[axis];
        let positions: Vec<Expr<'g>> = self.axes.iter().zip(anchors).map(component).collect();
        let slopes: Vec<Expr<'_>> = self.slopes.iter().map(|&id| self.graph.expr(id)).collect();
        let slopes = substitute_into(graph, &slopes, |symbol| match symbol {
            Symbol::Coordinate(i) => Some(positions[i as usize]),
            _ => None,
        });
        let component = |((&axis, anchor), slope): ((&usize, &Anchor<'g>), Expr<'g>)| {
            let vector = Vector::unit(graph, axis).scale(-slope);
            Load { link: anchor.link, point: Some(anchor.point), vector, is_in_world: true }
        };
        self.axes.iter().zip(anchors).zip(slopes).map(component).collect()
    }
}

/// Where a point is in the world, edge by edge.
fn in_world<'g>(linkage: &Linkage<'g>, anchor: &Anchor<'g>) -> Vector<'g> {
    let up = |&link: &usize| linkage.links[link].parent;
    let way = std::iter::successors(Some(anchor.link), up);
    way.filter_map(|link| linkage.links[link].edge).fold(anchor.point, |p, edge| match edge {
        Edge::Turn(r) => r * p,
        Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => turned_about(p, axis, sin, cos),
        Edge::Shift(t) => p + t,
        Edge::Slide { direction, displacement } => p + direction.scale(displacement),
    })
}
