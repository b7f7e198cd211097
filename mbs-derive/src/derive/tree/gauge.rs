//! Frames turned about their own joint axes, so that constant turns between joints become turns about one axis.
//!
//! The axes of a link behind a turning joint are fixed up to a constant turn about the joint's axis: nothing physical tells
//! θ from θ + α. Between two joints a constant turn is `R_k(α) R_i(β) R_k(γ)` (Euler), of which the outer two join the angles
//! of the two joints; what remains costs a plane rotation instead of a full one, as Denavit and Hartenberg's convention has it.

use crate::expr::{Expr, Graph, Matrix, Number, Vector};

use super::inertia::Inertia;
use super::linkage::{Edge, Link, Linkage};

/// The same mechanism, its frames turned so.
pub(super) fn turned<'g>(linkage: &Linkage<'g>, inertias: &[Inertia<'g>]) -> (Linkage<'g>, Vec<Inertia<'g>>) {
    let graph = inertias[0].mass.graph();
    let splits: Vec<Option<Split>> = (0..linkage.links.len()).map(|link| linkage.split(link)).collect();
    let mut new = Turned { links: Vec::new(), inertias: Vec::new(), numbers: Vec::new(), about: Vec::new() };
    let mut claimed = vec![None; linkage.links.len()];
    for split in splits.iter().flatten() {
        claimed[split.outer].get_or_insert(split.before);
    }
    for (number, link) in linkage.links.iter().enumerate() {
        new.add(number, link, &inertias[number], splits[number].as_ref(), claimed[number], graph);
    }
    (Linkage { links: new.links }, new.inertias)
}

/// A constant turn between two turning joints, as `R_k(before) R_i(middle) R_k(after) Qᵀ`.
struct Split {
    /// The link behind the joint towards the base.
    outer: usize,
    /// The axis k of that joint.
    axis: usize,
    /// The axis of the joint towards the tip; Q takes k to it.
    inner_axis: usize,
    before: f64,
    middle: f64,
    after: f64,
}

impl<'g> Linkage<'g> {
    /// How this link's turn splits; `None` where it is none, is of numbers 0 and ±1, of parameters, or not between two
    /// turning joints.
    fn split(&self, link: usize) -> Option<Split> {
        let Some(Edge::Turn(r)) = self.links[link].edge else { return None };
        let r = numbers(r)?;
        let inner_axis = self.only_turning_child(link)?;
        let mut outer = self.links[link].parent?;
        while let Some(Edge::Shift(_)) = self.links[outer].edge {
            outer = self.links[outer].parent?;
        }
        let Some(Edge::Revolute { axis, .. }) = self.links[outer].edge else { return None };
        if r.iter().flatten().all(|e| [0.0, 1.0, -1.0].contains(e)) {
            return None;
        }
        // R Q: its columns are those of R, shifted in a ring.
        let rq = r.map(|row| [0, 1, 2].map(|column| row[(column + 3 + inner_axis - axis) % 3]));
        let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
        let sine = libm::hypot(rq[k][i], rq[k][j]);
        let parallel = sine < 1e-9;
        let middle = if parallel {
            f64::from(u8::from(rq[k][k] < 0.0)) * core::f64::consts::PI
        } else {
            libm::atan2(sine, rq[k][k])
        };
        let before = if parallel { 0.0 } else { libm::atan2(rq[i][k], -rq[j][k]) };
        let after = if parallel { libm::atan2(-rq[i][j], rq[i][i]) } else { libm::atan2(rq[k][i], rq[k][j]) };
        Some(Split { outer, axis, inner_axis, before, middle, after })
    }

    /// The axis of the turning joint that is all that hangs on a link.
    fn only_turning_child(&self, link: usize) -> Option<usize> {
        let mut children = self.links.iter().filter(|other| other.parent == Some(link));
        match (children.next()?.edge, children.next()) {
            (Some(Edge::Revolute { axis, .. }), None) => Some(axis),
            _ => None,
        }
    }
}

/// The links so far.
struct Turned<'g> {
    links: Vec<Link<'g>>,
    inertias: Vec<Inertia<'g>>,
    /// Of each old link the new one.
    numbers: Vec<usize>,
    /// Of each old link the angle by which its axes are turned, and about which of them.
    about: Vec<Option<(usize, f64)>>,
}

impl<'g> Turned<'g> {
    fn add(
        &mut self,
        number: usize,
        link: &Link<'g>,
        inertia: &Inertia<'g>,
        split: Option<&Split>,
        claimed: Option<f64>,
        graph: &'g Graph,
    ) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else {
            return self.push(None, None, *inertia, None);
        };
        let (above, turned) = (self.numbers[parent], self.about[parent]);
        let back = |v: Vector<'g>| turned.map_or(v, |(axis, angle)| rotation(axis, -angle, graph) * v);
        match (edge, split) {
            (Edge::Turn(_), Some(split)) => {
                let (axis, quarter) = ((split.axis + 1) % 3, split.axis != split.inner_axis);
                // What another joint has claimed of the parent's turn is made good here.
                let before = split.before - turned.map_or(0.0, |(_, angle)| angle);
                let mut at = above;
                if before != 0.0 {
                    at = self.link(at, tilt(split.axis, before, graph), graph);
                }
                at = self.link(at, tilt(axis, split.middle, graph), graph);
                if quarter {
                    at = self.link(at, Edge::Turn(ring(split.axis, split.inner_axis, graph).transpose()), graph);
                }
                let about = (split.inner_axis, -split.after);
                self.inertias[at] = inertia.turned(rotation(about.0, -about.1, graph));
                self.numbers.push(at);
                self.about.push(Some(about));
                debug_assert_eq!(self.numbers.len(), number + 1);
            }
            (Edge::Turn(r), None) => {
                let r = turned.map_or(r, |(axis, angle)| rotation(axis, -angle, graph) * r);
                self.push(Some((above, Edge::Turn(r))), None, *inertia, None);
            }
            (Edge::Shift(t), _) => self.push(Some((above, Edge::Shift(back(t)))), turned, *inertia, turned),
            (Edge::Slide { direction, displacement }, _) => {
                let edge = Edge::Slide { direction: back(direction), displacement };
                self.push(Some((above, edge)), turned, *inertia, turned);
            }
            (Edge::Revolute { axis, angle, .. }, _) => {
                let (mut above, mut before) = (above, 0.0);
                match turned {
                    // A joint about another axis: the parent is turned back for it.
                    Some((other, angle)) if other != axis => {
                        above = self.link(above, tilt(other, -angle, graph), graph)
                    }
                    Some((_, angle)) => before = angle,
                    None => {}
                }
                let own = claimed.map(|angle| (axis, angle));
                let more = own.map_or(0.0, |(_, angle)| angle) - before;
                let angle = if more == 0.0 { angle } else { angle + rounded(more, graph) };
                self.push(Some((above, Edge::revolute(axis, angle))), own, *inertia, own);
            }
            (Edge::Tilt { .. }, _) => unreachable!("tilts are made here"),
        }
    }

    /// A link whose axes are turned against the old one's.
    fn push(
        &mut self,
        edge: Option<(usize, Edge<'g>)>,
        about: Option<(usize, f64)>,
        inertia: Inertia<'g>,
        turned: Option<(usize, f64)>,
    ) {
        let graph = inertia.mass.graph();
        self.links.push(Link { parent: edge.map(|(parent, _)| parent), edge: edge.map(|(_, edge)| edge) });
        self.inertias.push(turned.map_or(inertia, |(axis, angle)| inertia.turned(rotation(axis, -angle, graph))));
        self.numbers.push(self.links.len() - 1);
        self.about.push(about);
    }

    fn link(&mut self, parent: usize, edge: Edge<'g>, graph: &'g Graph) -> usize {
        self.links.push(Link { parent: Some(parent), edge: Some(edge) });
        self.inertias.push(Inertia::zero(graph));
        self.links.len() - 1
    }
}

/// An angle, or its sine or cosine, after a few operations on numbers of about one.
fn rounded(value: f64, graph: &Graph) -> Expr<'_> {
    graph.constant(Number::rounded(value, 4.0 * f64::EPSILON))
}

fn tilt<'g>(axis: usize, angle: f64, graph: &'g Graph) -> Edge<'g> {
    let [sin, cos] = [libm::sin(angle), libm::cos(angle)].map(|value| rounded(value, graph));
    Edge::Tilt { axis, sin, cos }
}

fn rotation<'g>(axis: usize, angle: f64, graph: &'g Graph) -> Matrix<'g> {
    Matrix::rotation(Vector::unit(graph, axis), rounded(angle, graph))
}

/// The rotation that takes one coordinate axis to another, and the others in a ring.
fn ring<'g>(from: usize, to: usize, graph: &'g Graph) -> Matrix<'g> {
    let column = |k: usize| Vector::unit(graph, (k + 3 + to - from) % 3).0;
    Matrix([0, 1, 2].map(column)).transpose()
}

fn numbers(r: Matrix<'_>) -> Option<[[f64; 3]; 3]> {
    let mut values = [[0.0; 3]; 3];
    for (value, entry) in values.as_flattened_mut().iter_mut().zip(r.0.as_flattened()) {
        *value = entry.as_constant()?.to_f64();
    }
    Some(values)
}
