//! Force elements: terms of V and D that are functions of points and their velocities alone, whatever acts there.
//!
//! A spring pulls with `F = −∂V/∂p`, a damper with `F = −∂D/∂ṗ`, differentiated with the coordinates of the points and
//! their velocities as the only variables; as a load on the link the force is swept back with the other wrenches.

use std::cell::RefCell;
use std::rc::Rc;

use crate::derive::time_derivative;
use crate::expr::{Expr, Graph, Id, Symbol, Vector, carry_out, cut, gradient, substitute_into};
use crate::model::landmark::{Landmarks, Place};

use super::linkage::{Edge, Linkage};
use super::load::Load;
use super::twist::Twist;

/// The slopes of a term of V or D in the coordinates or velocities of points given elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct ForceElement {
    /// Along which axis of the world each component of a place is.
    axes: Vec<usize>,
    /// In a graph of their own, where coordinate and velocity i stand for those of the i-th of these components.
    slopes: Vec<Id>,
    graph: Rc<Graph>,
}

/// A force element with a point for each of its components.
#[derive(Clone, Debug)]
pub(crate) struct Held<'g> {
    pub(crate) element: ForceElement,
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

impl ForceElement {
    /// What a term of V says of points, and the places that its components are of; `None` where it depends on the
    /// motion in another way as well.
    pub(crate) fn spring<'v>(term: Expr<'v>, landmarks: &Landmarks<'v>) -> Option<(Self, Vec<Place<'v>>)> {
        ForceElement::of(term, landmarks, Symbol::Coordinate)
    }

    /// What a term of D says, if it is a damper between places.
    pub(crate) fn damper<'v>(term: Expr<'v>, landmarks: &Landmarks<'v>) -> Option<(Self, Vec<Place<'v>>)> {
        ForceElement::of(term, landmarks, Symbol::Velocity)
    }

    /// With slopes in these symbols of the places.
    fn of<'v>(
        term: Expr<'v>,
        landmarks: &Landmarks<'v>,
        variable: fn(u32) -> Symbol,
    ) -> Option<(Self, Vec<Place<'v>>)> {
        let verbatim = Graph::verbatim();
        let places = RefCell::new(Vec::<Place<'v>>::new());
        let number = |place| {
            let mut places = places.borrow_mut();
            let known = places.iter().position(|&other| other == place);
            known.unwrap_or_else(|| {
                places.push(place);
                places.len() - 1
            }) as u32
        };
        let component = |id: Id| match (landmarks.place(id), landmarks.velocity(id)) {
            (Some(place), _) => Some(verbatim.symbol(Symbol::Coordinate(number(place)))),
            (None, Some(place)) => Some(verbatim.symbol(Symbol::Velocity(number(place)))),
            (None, None) => None,
        };
        let still = |symbol| matches!(symbol, Symbol::Parameter(_) | Symbol::Time | Symbol::Prescribed(_, 0));
        let declared = cut(term, &verbatim, component, still)?;
        let places = places.take();
        let graph = Rc::new(Graph::new());
        let scalar = carry_out(&[declared], &graph, |symbol| time_derivative(symbol, &graph))[0];
        let variables: Vec<Symbol> = (0..places.len() as u32).map(variable).collect();
        let slopes = gradient(scalar, &variables).iter().map(|slope| slope.id()).collect();
        let axes = places.iter().map(|place| place.axis).collect();
        (!places.is_empty()).then_some((ForceElement { axes, slopes, graph: graph.clone() }, places))
    }

    /// The forces on its points, with each component's anchor and what its link moves with.
    pub(super) fn loads<'g>(
        &self,
        anchors: &[Anchor<'g>],
        linkage: &Linkage<'g>,
        twists: &[Twist<'g>],
        graph: &'g Graph,
    ) -> Vec<Load<'g>> {
        let slopes: Vec<Expr<'_>> = self.slopes.iter().map(|&id| self.graph.expr(id)).collect();
        let slopes = substitute_into(graph, &slopes, |symbol| match symbol {
            Symbol::Coordinate(i) => Some(position(linkage, &anchors[i as usize]).0[self.axes[i as usize]]),
            Symbol::Velocity(i) => Some(velocity(linkage, twists, &anchors[i as usize]).0[self.axes[i as usize]]),
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
fn position<'g>(linkage: &Linkage<'g>, anchor: &Anchor<'g>) -> Vector<'g> {
    edges_to_base(linkage, anchor.link).fold(anchor.point, |p, edge| match edge {
        Edge::Shift(t) => p + t,
        Edge::Slide { direction, displacement } => p + direction.scale(displacement),
        Edge::Turn(_) | Edge::Revolute { .. } | Edge::Tilt { .. } => edge.turned(p),
    })
}

/// How fast it is there: `v + ω × p`, turned edge by edge.
fn velocity<'g>(linkage: &Linkage<'g>, twists: &[Twist<'g>], anchor: &Anchor<'g>) -> Vector<'g> {
    let Twist { angular, linear } = twists[anchor.link];
    let velocity = linear + angular.cross(anchor.point);
    edges_to_base(linkage, anchor.link).fold(velocity, |v, edge| edge.turned(v))
}

fn edges_to_base<'g>(linkage: &Linkage<'g>, link: usize) -> impl Iterator<Item = Edge<'g>> {
    let up = |&link: &usize| linkage.links[link].parent;
    std::iter::successors(Some(link), up).filter_map(|link| linkage.links[link].edge)
}
