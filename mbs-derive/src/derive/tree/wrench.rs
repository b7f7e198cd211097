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
}

impl<'g> Wrench<'g> {
    /// None at all.
    pub(super) fn zero(graph: &'g Graph) -> Self {
        Wrench { force: Vector::zero(graph), couple: Vector::zero(graph) }
    }

    /// What is left of it where another one acts.
    pub(super) fn minus(self, other: Self) -> Self {
        Wrench { force: self.force - other.force, couple: self.couple - other.couple }
    }

    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Wrench { force: self.force + other.force, couple: self.couple + other.couple }
    }

    /// The part that works on the edge's own motion: the couple about the axis, the force along the slide.
    pub(super) fn along(&self, edge: &Edge<'g>) -> Option<Expr<'g>> {
        match *edge {
            Edge::Revolute { axis, .. } => Some(self.couple.0[axis]),
            Edge::Slide { direction, .. } => Some(direction.dot(self.force)),
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => None,
        }
    }

    /// The same about the parent's origin, in its axes.
    pub(super) fn across(self, edge: &Edge<'g>) -> Self {
        let Wrench { force, couple } = self;
        match *edge {
            Edge::Turn(r) => Wrench { force: r * force, couple: r * couple },
            Edge::Shift(t) => self.shifted(t),
            Edge::Slide { direction, displacement } => self.shifted(direction.scale(displacement)),
            Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => self.turned(axis, sin, cos),
        }
    }

    fn turned(self, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Self {
        Wrench { force: turned_about(self.force, axis, s, c), couple: turned_about(self.couple, axis, s, c) }
    }

    /// `n + t × f`
    fn shifted(self, t: Vector<'g>) -> Self {
        Wrench { couple: self.couple + t.cross(self.force), ..self }
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
