//! Wrenches: a force and a couple about the origin of a link, in its axes, and how edges carry them to the parent.

use crate::expr::{Expr, Graph, Vector};

use super::linkage::Edge;

/// Force and couple.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench<'g> {
    /// f
    pub(super) force: Vector<'g>,
    /// n, about the origin of the link.
    pub(super) couple: Vector<'g>,
    /// A moment about the axis of the link's own edge alone, which is no part of n and goes no further.
    pub(super) about_edge: Expr<'g>,
}

impl<'g> Wrench<'g> {
    /// None at all.
    pub(super) fn zero(graph: &'g Graph) -> Self {
        Wrench::new(Vector::zero(graph), Vector::zero(graph))
    }

    /// A force through the origin and a couple.
    pub(super) fn new(force: Vector<'g>, couple: Vector<'g>) -> Self {
        Wrench { force, couple, about_edge: force.0[0].graph().integer(0) }
    }

    /// What is left of it where another one acts.
    pub(super) fn minus(self, other: Self) -> Self {
        Wrench {
            force: self.force - other.force,
            couple: self.couple - other.couple,
            about_edge: self.about_edge - other.about_edge,
        }
    }

    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Wrench {
            force: self.force + other.force,
            couple: self.couple + other.couple,
            about_edge: self.about_edge + other.about_edge,
        }
    }

    /// Its force and its couple multiplied by a number.
    pub(super) fn scale(self, s: Expr<'g>) -> Self {
        Wrench::new(self.force.scale(s), self.couple.scale(s))
    }

    /// The part that works on the edge's own motion: the couple about the axis, the force along the slide.
    pub(super) fn along(&self, edge: &Edge<'g>) -> Option<Expr<'g>> {
        match *edge {
            Edge::Revolute { axis, .. } => Some(self.couple.0[axis] + self.about_edge),
            Edge::Slide { direction, .. } => Some(direction.dot(self.force)),
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => None,
        }
    }

    /// The wrench about the parent's origin, in its axes.
    pub(super) fn across(self, edge: &Edge<'g>) -> Self {
        match *edge {
            Edge::Shift(t) => self.shifted(t),
            Edge::Slide { direction, displacement } => self.shifted(direction.scale(displacement)),
            Edge::Turn(_) | Edge::Revolute { .. } | Edge::Tilt { .. } => {
                Wrench::new(edge.turned(self.force), edge.turned(self.couple))
            }
        }
    }

    /// The wrench about the origin of a frame in which this one's origin is at t: `n + t × f`.
    pub(super) fn shifted(self, t: Vector<'g>) -> Self {
        Wrench::new(self.force, self.couple + t.cross(self.force))
    }
}

/// Turned about a coordinate axis by the angle with this sine and cosine.
pub(super) fn turned_about<'g>(v: Vector<'g>, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Vector<'g> {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut turned = v;
    turned.0[i] = c * v.0[i] - s * v.0[j];
    turned.0[j] = s * v.0[i] + c * v.0[j];
    turned
}
