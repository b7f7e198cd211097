//! The declared frames, reduced to what moves: a tree of links, each behind one elementary motion.
//!
//! Constant turns and shifts in a row become one of each; a turn about a skew axis e becomes a constant turn of z onto
//! e, a turn about z, and the turn back, which joins what follows; a translation that moves becomes slides along
//! constant directions.

use crate::expr::{Expr, Graph, HalfInteger, Matrix, Node, Tangent, Vector};
use crate::model::Lagrangian;
use crate::model::frame::{Edge as Declared, FrameId};
use crate::model::landmark::is_still;

use super::super::lagrange::velocity_direction;
use super::super::{carried, time_derivative};
use super::wrench::turned_about;

/// How a link moves in its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge<'g> {
    /// Turned, once and for all; the matrix takes components in the link's axes to the parent's.
    Turn(Matrix<'g>),
    /// Turned about a coordinate axis, once and for all.
    Tilt {
        /// 0, 1 or 2.
        axis: usize,
        /// The sine of the angle.
        sin: Expr<'g>,
        /// Its cosine.
        cos: Expr<'g>,
    },
    /// Shifted, once and for all, in the parent's axes.
    Shift(Vector<'g>),
    /// Turned about a coordinate axis.
    Revolute {
        /// 0, 1 or 2.
        axis: usize,
        /// Any expression of coordinates and time.
        angle: Expr<'g>,
        /// The sine of the turn of the axes: of the angle, or 0 where the axes do not follow a body that looks the same
        /// from all sides.
        sin: Expr<'g>,
        /// Its cosine.
        cos: Expr<'g>,
    },
    /// Shifted along a direction that is constant in the parent's axes.
    Slide {
        /// Need not have length 1.
        direction: Vector<'g>,
        /// How far, in units of the direction.
        displacement: Expr<'g>,
    },
}

impl<'g> Edge<'g> {
    /// What moves it.
    pub(super) fn displacement(&self) -> Option<Expr<'g>> {
        match *self {
            Edge::Revolute { angle, .. } => Some(angle),
            Edge::Slide { displacement, .. } => Some(displacement),
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => None,
        }
    }

    /// A vector of the link in the axes of the parent.
    pub(super) fn turned(&self, v: Vector<'g>) -> Vector<'g> {
        match *self {
            Edge::Turn(r) => r * v,
            Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => turned_about(v, axis, sin, cos),
            Edge::Shift(_) | Edge::Slide { .. } => v,
        }
    }

    /// A vector of the parent in the axes of the link.
    pub(super) fn turned_back(&self, v: Vector<'g>) -> Vector<'g> {
        match *self {
            Edge::Turn(r) => r.transpose() * v,
            Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => turned_about(v, axis, -sin, cos),
            Edge::Shift(_) | Edge::Slide { .. } => v,
        }
    }

    /// Whether the link's origin is the parent's.
    pub(super) fn only_turns(&self) -> bool {
        matches!(self, Edge::Turn(_) | Edge::Revolute { .. } | Edge::Tilt { .. })
    }

    /// The coordinate axis that it slides along.
    pub(super) fn slides_along(&self) -> Option<usize> {
        let Edge::Slide { direction, .. } = self else { return None };
        (0..3).find(|&axis| (0..3).all(|other| other == axis || direction.0[other].is_zero()))
    }

    /// A turn about a coordinate axis, axes and all.
    pub(super) fn revolute(axis: usize, angle: Expr<'g>) -> Self {
        Edge::Revolute { axis, angle, sin: angle.sin(), cos: angle.cos() }
    }
}

/// One link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<'g> {
    /// Its number among the links; the base has none.
    pub(crate) parent: Option<usize>,
    /// How it moves there; the base does not.
    pub(crate) edge: Option<Edge<'g>>,
}

/// Where a declared frame is: fixed in a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seat<'g> {
    /// The link.
    pub(crate) link: usize,
    /// The origin of the frame, in the link's axes.
    pub(crate) shift: Vector<'g>,
    /// From the frame's axes to the link's; `None` where they are the same.
    pub(crate) turn: Option<Matrix<'g>>,
}

/// The links, parents first, the base at 0.
#[derive(Clone, Debug)]
pub(crate) struct Linkage<'g> {
    pub(crate) links: Vec<Link<'g>>,
}

impl<'g> Linkage<'g> {
    /// The links that these frames need, and where each frame is; `None` where one turns by a quaternion.
    pub(crate) fn of(
        lagrangian: &Lagrangian<'_>,
        frames: &[FrameId],
        graph: &'g Graph,
    ) -> Option<(Self, Vec<Seat<'g>>)> {
        let mut linkage = Linkage { links: vec![Link { parent: None, edge: None }] };
        let base = Seat { link: 0, shift: Vector::zero(graph), turn: None };
        let mut seats: Vec<Option<Seat<'g>>> = vec![None; lagrangian.frames.iter().count()];
        seats[FrameId::WORLD.index()] = Some(base);
        for &frame in frames {
            let mut way: Vec<FrameId> = Vec::new();
            let mut at = frame;
            while seats[at.index()].is_none() {
                way.push(at);
                at = lagrangian.frames.get(at).parent?;
            }
            for &next in way.iter().rev() {
                let (parent, edge) = (lagrangian.frames.get(next).parent?, lagrangian.frames.get(next).edge?);
                let seat = linkage.attach(seats[parent.index()]?, edge, graph)?;
                seats[next.index()] = Some(seat);
            }
        }
        let seats = frames.iter().map(|frame| seats[frame.index()]).collect::<Option<Vec<_>>>()?;
        Some((linkage, seats))
    }

    /// Whether there is a joint at all.
    pub(crate) fn has_joints(&self) -> bool {
        self.links.iter().any(|link| link.edge.is_some_and(|edge| edge.displacement().is_some()))
    }

    /// The link nearest to the base that has the same origin at all times. Joints between it and this one turn: a force
    /// through the origin does nothing along them, and in axes nearer to the world it keeps the digits that it was
    /// given with.
    pub(super) fn first_of_place(&self, link: usize) -> usize {
        let turns = |link: usize| self.links[link].edge.is_some_and(|edge| edge.only_turns());
        let up = |&link: &usize| self.links[link].parent.filter(|_| turns(link));
        std::iter::successors(Some(link), up).last().unwrap_or(link)
    }

    /// The links of each place, each before its parent.
    pub(super) fn places(&self) -> Vec<Vec<usize>> {
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        (0..self.links.len()).rev().for_each(|link| places[self.first_of_place(link)].push(link));
        places.retain(|links| !links.is_empty());
        places
    }

    /// Whether a link elsewhere hangs from one of these.
    pub(super) fn bears_others(&self, links: &[usize]) -> bool {
        let hangs = |link: usize| self.links[link].parent.is_some_and(|parent| links.contains(&parent));
        (0..self.links.len()).any(|link| hangs(link) && !links.contains(&link))
    }

    /// The links from one to another that it hangs from, both included.
    pub(super) fn way(&self, from: usize, to: usize) -> Vec<usize> {
        let up = |&link: &usize| self.links[link].parent.filter(|_| link != to);
        std::iter::successors(Some(from), up).collect()
    }

    /// Whether every joint follows coordinates and time linearly.
    pub(crate) fn is_linear(&self) -> bool {
        self.links.iter().filter_map(|link| link.edge?.displacement()).all(|displacement| {
            let graph = displacement.graph();
            let linear = |id| {
                matches!(
                    graph.node(id),
                    Node::Symbol(_) | Node::Constant(_) | Node::Neg(_) | Node::Add(..) | Node::Sub(..) | Node::Mul(..)
                )
            };
            let moves = |id| !graph.is_parametric(id);
            let mut nodes = graph.reachable([displacement.id()]).into_iter();
            nodes.all(|id| linear(id) && !matches!(graph.node(id), Node::Mul(a, b) if moves(a) && moves(b)))
        })
    }

    /// The seat of a frame that moves in another as declared.
    fn attach(&mut self, seat: Seat<'g>, edge: Declared<'_>, graph: &'g Graph) -> Option<Seat<'g>> {
        match edge {
            Declared::Rotation { axis, angle } => {
                let [x, y, z, angle] = carried([axis.0[0], axis.0[1], axis.0[2], angle], graph);
                let axis = Vector([x, y, z]);
                // An axis of parameters is derived plainly.
                let is_number = axis.0.iter().all(|e| e.as_constant().is_some());
                (is_number || is_still(angle)).then(|| self.turned(seat, axis, angle))
            }
            Declared::Translation(t) => Some(self.translated(seat, Vector(carried(t.0, graph)))),
            Declared::Quaternion(_) => None,
        }
    }

    fn turned(&mut self, seat: Seat<'g>, axis: Vector<'g>, angle: Expr<'g>) -> Seat<'g> {
        let graph = angle.graph();
        if is_still(angle) {
            return seat.turned(Matrix::rotation(axis, angle));
        }
        let along = (0..3).find(|&k| axis == Vector::unit(graph, k));
        let before = along.map_or_else(|| seat.turned(rotation_from_z(axis)), |_| seat);
        let link = self.settled(before);
        let link = self.link(link, Edge::revolute(along.unwrap_or(2), angle));
        let back = along.is_none().then(|| rotation_from_z(axis).transpose());
        Seat { link, shift: Vector::zero(graph), turn: back }
    }

    fn translated(&mut self, seat: Seat<'g>, t: Vector<'g>) -> Seat<'g> {
        let (rest, slides) = slides_of(t);
        let mut seat = Seat { shift: seat.shift + seat.in_link(rest), ..seat };
        for (direction, displacement) in slides {
            if components(seat.in_link(direction)) > components(direction) {
                seat = Seat { link: self.settled(seat), shift: Vector::zero(displacement.graph()), turn: None };
            }
            // What is fixed in the link is shifted behind the slide as before it: translations commute.
            let edge = Edge::Slide { direction: seat.in_link(direction), displacement };
            seat = Seat { link: self.link(seat.link, edge), ..seat };
        }
        seat
    }

    /// The link that the frame itself is: behind a constant shift and a constant turn.
    fn settled(&mut self, seat: Seat<'g>) -> usize {
        let shifted =
            if components(seat.shift) == 0 { seat.link } else { self.link(seat.link, Edge::Shift(seat.shift)) };
        seat.turn.map_or(shifted, |turn| self.link(shifted, Edge::Turn(turn)))
    }

    /// The same edge on the same parent is the same link.
    fn link(&mut self, parent: usize, edge: Edge<'g>) -> usize {
        let known = self.links.iter().position(|link| link.parent == Some(parent) && link.edge == Some(edge));
        known.unwrap_or_else(|| {
            self.links.push(Link { parent: Some(parent), edge: Some(edge) });
            self.links.len() - 1
        })
    }
}

impl<'g> Seat<'g> {
    fn turned(self, r: Matrix<'g>) -> Self {
        Seat { turn: Some(self.turn.map_or(r, |turn| turn * r)), ..self }
    }

    /// A vector's components in the axes of the link.
    pub(crate) fn in_link(&self, v: Vector<'g>) -> Vector<'g> {
        self.turn.map_or(v, |turn| turn * v)
    }
}

/// How many components are not 0.
fn components(v: Vector<'_>) -> usize {
    v.0.iter().filter(|c| !c.is_zero()).count()
}

/// A constant rotation that takes z to a unit axis of numbers: its columns are two unit vectors across it, and the
/// axis.
fn rotation_from_z<'g>(axis: Vector<'g>) -> Matrix<'g> {
    let graph = axis.0[0].graph();
    let number = |e: Expr<'g>| e.as_constant().expect("`attach` lets no other axis turn").to_f64();
    // The coordinate axis that is farthest from it, so that nothing is divided by little.
    let k = (0..3).min_by(|&i, &j| number(axis.0[i]).abs().total_cmp(&number(axis.0[j]).abs())).unwrap_or(0);
    let across = Vector::unit(graph, k).cross(axis);
    let x = across.scale(across.norm_squared().power(HalfInteger::halves(-1)));
    let y = axis.cross(x);
    Matrix([x.0, y.0, axis.0]).transpose()
}

/// A translation as a constant one and slides along constant directions: one where it goes along a line, else one an
/// axis.
fn slides_of<'g>(t: Vector<'g>) -> (Vector<'g>, Vec<(Vector<'g>, Expr<'g>)>) {
    let parts = t.0.map(Affine::of);
    let rest = Vector(parts.map(|part| part.constant));
    let moving: Vec<usize> = (0..3).filter(|&i| !parts[i].factor.is_zero()).collect();
    let graph = t.0[0].graph();
    let along = |axes: &[usize]| {
        let mut direction = Vector::zero(graph);
        axes.iter().for_each(|&i| direction.0[i] = parts[i].factor);
        (direction, parts[axes[0]].variable)
    };
    let on_a_line = moving.iter().all(|&i| parts[i].variable == parts[moving[0]].variable);
    let slides = match moving.is_empty() {
        true => Vec::new(),
        false if on_a_line => vec![along(&moving)],
        false => moving.iter().map(|&i| along(&[i])).collect(),
    };
    (rest, slides)
}

/// `constant + factor · variable`, the first two constant in time.
#[derive(Clone, Copy, Debug)]
struct Affine<'g> {
    constant: Expr<'g>,
    factor: Expr<'g>,
    variable: Expr<'g>,
}

impl<'g> Affine<'g> {
    /// Splits off what is added and multiplied from outside.
    fn of(e: Expr<'g>) -> Self {
        let graph = e.graph();
        let (zero, one) = (graph.integer(0), graph.integer(1));
        let mut split = Affine { constant: zero, factor: one, variable: e };
        if is_still(e) {
            return Affine { constant: e, factor: zero, variable: one };
        }
        while let Some(next) = split.peeled() {
            split = next;
        }
        split
    }

    fn peeled(self) -> Option<Self> {
        let graph = self.variable.graph();
        let part = |id| graph.expr(id);
        let Affine { constant, factor, .. } = self;
        match self.variable.node() {
            Node::Neg(a) => Some(Affine { factor: -factor, variable: part(a), ..self }),
            Node::Mul(a, b) if graph.is_parametric(a) => {
                Some(Affine { factor: factor * part(a), variable: part(b), ..self })
            }
            Node::Mul(a, b) if graph.is_parametric(b) => {
                Some(Affine { factor: factor * part(b), variable: part(a), ..self })
            }
            Node::Add(a, b) | Node::Sub(a, b) if graph.is_parametric(b) => {
                let added = factor * part(b);
                let minus = matches!(self.variable.node(), Node::Sub(..));
                let constant = if minus { constant - added } else { constant + added };
                Some(Affine { constant, variable: part(a), ..self })
            }
            Node::Add(a, b) if graph.is_parametric(a) => {
                Some(Affine { constant: constant + factor * part(a), variable: part(b), ..self })
            }
            Node::Sub(a, b) if graph.is_parametric(a) => {
                Some(Affine { constant: constant + factor * part(a), factor: -factor, variable: part(b) })
            }
            _ => None,
        }
    }
}

/// Whether q̈ is given or 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Accelerations {
    /// As symbols.
    Given,
    /// For the bias.
    Zero,
}

/// The rate of a displacement.
pub(super) fn rate<'g>(displacement: Expr<'g>) -> Expr<'g> {
    let graph = displacement.graph();
    Tangent::new(|symbol| time_derivative(symbol, graph)).of(displacement)
}

/// The rate of a displacement, and the rate of that.
pub(super) fn rates<'g>(displacement: Expr<'g>, accelerations: Accelerations) -> (Expr<'g>, Expr<'g>) {
    let (graph, rate) = (displacement.graph(), rate(displacement));
    let direction = |symbol| match accelerations {
        Accelerations::Given => time_derivative(symbol, graph),
        Accelerations::Zero => velocity_direction(symbol, rate),
    };
    (rate, Tangent::new(direction).of(rate))
}

#[cfg(test)]
mod tests {
    use super::super::trial::{linkage, value};
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn what_is_constant_in_time_is_split_off() {
        let graph = Graph::new();
        let (q, l) = (graph.symbol(Symbol::Coordinate(0)), graph.symbol(Symbol::Parameter(0)));
        for e in [l - 2 * (l * q + 3), -(q - l) * l, (l + q) / 2, l - (3 - q), l * 3, q.sin() * l] {
            let Affine { constant, factor, variable } = Affine::of(e);
            assert!(is_still(constant) && is_still(factor), "{e}");
            assert!((value(constant + factor * variable) - value(e)).abs() < 1e-12, "{e}");
            assert!(variable == q || variable == q.sin() || factor.is_zero(), "{e}: {variable}");
        }
    }

    #[test]
    fn a_translation_along_a_line_is_one_slide() {
        let graph = Graph::new();
        let [zero, one, two] = [0, 1, 2].map(|i| graph.integer(i));
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let line = slides_of(Vector([x, 2 * x + one, one]));
        assert_eq!(line, (Vector([zero, one, one]), vec![(Vector([one, two, zero]), x)]));
        let plane = slides_of(Vector([x, 2 * y, one]));
        let slides = vec![(Vector([one, zero, zero]), x), (Vector([zero, two, zero]), y)];
        assert_eq!(plane, (Vector([zero, zero, one]), slides));
    }

    #[test]
    fn skew_axes_are_turned_from_z() {
        let graph = Graph::new();
        let thirds = [1, -2, 2].map(|i| graph.integer(i) / 3);
        let fifths = [3, 0, 4].map(|i| graph.integer(i) / 5);
        for axis in [fifths, [0, 0, -1].map(|i| graph.integer(i)), thirds].map(Vector) {
            let r = rotation_from_z(axis);
            assert_eq!(r * Vector::unit(&graph, 2), axis);
            let square = r.transpose() * r;
            for (entry, unit) in square.0.as_flattened().iter().zip(Matrix::identity(&graph).0.as_flattened()) {
                assert!((value(*entry) - value(*unit)).abs() < 1e-15, "{entry}");
            }
        }
    }

    #[test]
    fn joints_that_follow_coordinates_linearly() {
        let graph = Graph::new();
        let (q, l, t) =
            (graph.symbol(Symbol::Coordinate(0)), graph.symbol(Symbol::Parameter(0)), graph.symbol(Symbol::Time));
        let is_linear = |displacement| linkage(&[(0, Edge::revolute(0, displacement))]).is_linear();
        assert!([q, l * q + 3 * t - l, -(q - t) / 2].into_iter().all(is_linear));
        assert!(![q * q, q * t, q.sin(), (q + 1).powi(3)].into_iter().any(is_linear));
    }

    /// Each node of a long sum is looked at once, not once for each sum that it is part of.
    #[test]
    fn long_displacements_take_work_in_proportion() {
        let graph = Graph::new();
        let l = graph.symbol(Symbol::Parameter(0));
        let sum = (1..20_000).fold(graph.symbol(Symbol::Coordinate(0)), |sum, i| sum + i * l);
        let before = graph.len();
        assert!(linkage(&[(0, Edge::revolute(0, sum))]).is_linear());
        assert_eq!(Affine::of(sum).variable, graph.symbol(Symbol::Coordinate(0)));
        assert!(graph.len() <= 2 * before, "{} nodes of {before}", graph.len());
    }
}
