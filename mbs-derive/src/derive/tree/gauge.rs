//! Frames turned about their own joint axes, so that constant turns between joints become turns about one axis.
//!
//! The axes of a link behind a turning joint are fixed up to a constant turn about the joint's axis: nothing physical
//! tells θ from θ + α. Between two joints a constant turn is `R_k(α) R_i(β) R_k(γ)` (Euler), of which the outer two
//! join the angles of the two joints; what remains costs a plane rotation instead of a full one, as Denavit and
//! Hartenberg's convention has it.

use crate::expr::{Binary, Expr, Function, Graph, Matrix, Number, Vector};

use super::force_element::Anchor;
use super::inertia::Inertia;
use super::linkage::{Edge, Link, Linkage};
use super::load::Load;

/// The same mechanism, its frames turned so.
pub(super) fn turned<'g>(linkage: &Linkage<'g>, inertias: &[Inertia<'g>]) -> Turned<'g> {
    let splits: Vec<Option<Split>> = (0..linkage.links.len()).map(|link| linkage.split(link)).collect();
    let empty = Linkage { links: Vec::new() };
    let mut new = Turned { linkage: empty, inertias: Vec::new(), numbers: Vec::new(), gauges: Vec::new() };
    let mut claimed = vec![None; linkage.links.len()];
    for split in splits.iter().flatten() {
        claimed[split.outer].get_or_insert(split.before);
    }
    for (number, link) in linkage.links.iter().enumerate() {
        new.add(link, inertias[number], splits[number].as_ref(), claimed[number]);
    }
    new
}

/// A constant turn between two turning joints, as `R_k(before) R_i(middle) R_k(after) Qᵀ`.
struct Split {
    /// The link behind the joint towards the base.
    outer: usize,
    /// The axis k of that joint.
    axis: usize,
    /// The axis of the joint towards the tip; Q takes k to it.
    inner_axis: usize,
    before: Number,
    middle: Number,
    after: Number,
}

/// Axes at a smaller sine are parallel, but for the rounding of 100 bits.
const ROUNDING: f64 = 1e-27;

/// The angles of a turn between axes at a smaller sine are not known to the digits of a double.
const NEARLY_PARALLEL: f64 = 1e-9;

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
        if r.iter().flatten().all(|e| [0.0, 1.0, -1.0].contains(&e.to_f64())) {
            return None;
        }
        // R Q: its columns are those of R, shifted in a ring.
        let rq = r.map(|row| [0, 1, 2].map(|column| row[(column + 3 + inner_axis - axis) % 3]));
        let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
        let sine = (rq[k][i] * rq[k][i] + rq[k][j] * rq[k][j]).power(1)?;
        // Axes that are given by decimals and nearly parallel are not parallel: what of the 100 bits is left of their
        // sine does not tell the other two angles, and they stay as they are.
        let (before, middle, after) = if sine.to_f64() < ROUNDING {
            let middle = if rq[k][k].is_negative() { Number::PI } else { Number::ZERO };
            (Number::ZERO, middle, angle(-rq[i][j], rq[i][i]))
        } else if sine.to_f64() < NEARLY_PARALLEL {
            return None;
        } else {
            (angle(rq[i][k], -rq[j][k]), angle(sine, rq[k][k]), angle(rq[k][i], rq[k][j]))
        };
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

/// How the axes of a link are turned against the old ones.
#[derive(Clone, Copy)]
struct Gauge {
    axis: usize,
    angle: Number,
}

impl Gauge {
    /// From the old axes to the turned ones.
    fn turn_from_old<'g>(self, graph: &'g Graph) -> Matrix<'g> {
        rotation(self.axis, -self.angle, graph)
    }
}

/// The mechanism in turned frames.
pub(super) struct Turned<'g> {
    /// The links.
    pub(super) linkage: Linkage<'g>,
    /// Their masses.
    pub(super) inertias: Vec<Inertia<'g>>,
    /// The new link of each old one.
    numbers: Vec<usize>,
    /// How each old link was turned.
    gauges: Vec<Option<Gauge>>,
}

impl<'g> Turned<'g> {
    /// `claimed` is the angle that a turn behind this joint wants of it.
    fn add(&mut self, link: &Link<'g>, inertia: Inertia<'g>, split: Option<&Split>, claimed: Option<Number>) {
        let graph = inertia.mass.graph();
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else {
            let base = self.push(*link, graph);
            return self.settle(base, None, inertia);
        };
        let (above, gauge) = (self.numbers[parent], self.gauges[parent]);
        let from_old = |v: Vector<'g>| gauge.map_or(v, |gauge| gauge.turn_from_old(graph) * v);
        let (edge, own) = match (edge, split) {
            (Edge::Turn(_), Some(split)) => return self.add_split(above, gauge, split, inertia),
            (Edge::Revolute { axis, angle, .. }, _) => {
                return self.add_joint(above, gauge, (axis, angle), claimed, inertia);
            }
            (Edge::Turn(r), None) => (Edge::Turn(gauge.map_or(r, |gauge| gauge.turn_from_old(graph) * r)), None),
            (Edge::Shift(t), _) => (Edge::Shift(from_old(t)), gauge),
            (Edge::Slide { direction, displacement }, _) => {
                (Edge::Slide { direction: from_old(direction), displacement }, gauge)
            }
            (Edge::Tilt { .. }, _) => unreachable!("tilts are made here"),
        };
        let at = self.hang(above, edge, graph);
        self.settle(at, own, inertia);
    }

    /// A turn in its three parts, of which the last is left to the joint behind it.
    fn add_split(&mut self, mut above: usize, gauge: Option<Gauge>, split: &Split, inertia: Inertia<'g>) {
        let graph = inertia.mass.graph();
        // What another joint has claimed of the parent's turn is made good here.
        let before = split.before + gauge.map_or(Number::ZERO, |gauge| -gauge.angle);
        if !before.is_zero() {
            above = self.hang(above, tilt(split.axis, before, graph), graph);
        }
        above = self.hang(above, tilt((split.axis + 1) % 3, split.middle, graph), graph);
        if split.axis != split.inner_axis {
            above = self.hang(above, Edge::Turn(ring(split.axis, split.inner_axis, graph).transpose()), graph);
        }
        self.settle(above, Some(Gauge { axis: split.inner_axis, angle: -split.after }), inertia);
    }

    /// A turning joint, whose angle takes up what is claimed of it and what the parent's axes are turned by.
    fn add_joint(
        &mut self,
        mut above: usize,
        gauge: Option<Gauge>,
        (axis, angle): (usize, Expr<'g>),
        claimed: Option<Number>,
        inertia: Inertia<'g>,
    ) {
        let graph = inertia.mass.graph();
        let before = match gauge {
            // A joint about another axis: the parent is turned back for it.
            Some(gauge) if gauge.axis != axis => {
                above = self.hang(above, tilt(gauge.axis, -gauge.angle, graph), graph);
                Number::ZERO
            }
            Some(gauge) => gauge.angle,
            None => Number::ZERO,
        };
        let more = claimed.unwrap_or(Number::ZERO) + -before;
        // Quarter turns are exact before the joint, and would cost its angle digits.
        let right_angle = Number::PI * Number::rational(1, 2).expect("one half");
        let quarters = Number::integer(libm::round(more.to_f64() / right_angle.to_f64()) as i64);
        let is_quarters = (more + -(quarters * right_angle)).is_zero();
        if is_quarters && !quarters.is_zero() {
            above = self.hang(above, Edge::Turn(rotation(axis, quarters * right_angle, graph)), graph);
        }
        let angle = if is_quarters { angle } else { angle + graph.constant(more) };
        let at = self.hang(above, Edge::revolute(axis, angle), graph);
        self.settle(at, claimed.map(|angle| Gauge { axis, angle }), inertia);
    }

    /// The load on the new link, in its axes.
    pub(super) fn load(&self, load: &Load<'g>) -> Load<'g> {
        let turned = |v: Vector<'g>| self.in_new_axes(load.link, v);
        Load {
            link: self.numbers[load.link],
            point: load.point.map(turned),
            vector: if load.is_in_world { load.vector } else { turned(load.vector) },
            ..*load
        }
    }

    /// The point on the new link, in its axes.
    pub(super) fn anchor(&self, anchor: &Anchor<'g>) -> Anchor<'g> {
        Anchor { link: self.numbers[anchor.link], point: self.in_new_axes(anchor.link, anchor.point) }
    }

    /// A vector in the axes of an old link, in those of the new one.
    fn in_new_axes(&self, link: usize, v: Vector<'g>) -> Vector<'g> {
        let graph = v.0[0].graph();
        self.gauges[link].map_or(v, |gauge| gauge.turn_from_old(graph) * v)
    }

    /// A further link, without masses.
    fn hang(&mut self, parent: usize, edge: Edge<'g>, graph: &'g Graph) -> usize {
        self.push(Link { parent: Some(parent), edge: Some(edge) }, graph)
    }

    fn push(&mut self, link: Link<'g>, graph: &'g Graph) -> usize {
        self.linkage.links.push(link);
        self.inertias.push(Inertia::zero(graph));
        self.linkage.links.len() - 1
    }

    /// The next old link is this new one, its axes turned so; there its masses are.
    fn settle(&mut self, link: usize, gauge: Option<Gauge>, inertia: Inertia<'g>) {
        let graph = inertia.mass.graph();
        self.inertias[link] = gauge.map_or(inertia, |gauge| inertia.turned(gauge.turn_from_old(graph)));
        self.numbers.push(link);
        self.gauges.push(gauge);
    }
}

/// The angle of the point (x, y). Without images: a field does not know what it has to do with sines and cosines.
fn angle(y: Number, x: Number) -> Number {
    y.call2(Binary::Atan2, x).without_images()
}

/// Its sine and cosine.
fn sin_cos(angle: Number, graph: &Graph) -> [Expr<'_>; 2] {
    [Function::Sin, Function::Cos].map(|function| graph.constant(angle).call(function))
}

fn tilt<'g>(axis: usize, angle: Number, graph: &'g Graph) -> Edge<'g> {
    let [sin, cos] = sin_cos(angle, graph);
    Edge::Tilt { axis, sin, cos }
}

fn rotation<'g>(axis: usize, angle: Number, graph: &'g Graph) -> Matrix<'g> {
    let [sin, cos] = sin_cos(angle, graph);
    Matrix::plane_rotation(axis, sin, cos)
}

/// The rotation that takes one coordinate axis to another, and the others in a ring.
fn ring<'g>(from: usize, to: usize, graph: &'g Graph) -> Matrix<'g> {
    let column = |k: usize| Vector::unit(graph, (k + 3 + to - from) % 3).0;
    Matrix([0, 1, 2].map(column)).transpose()
}

fn numbers(r: Matrix<'_>) -> Option<[[Number; 3]; 3]> {
    let mut values = [[Number::ZERO; 3]; 3];
    for (value, entry) in values.as_flattened_mut().iter_mut().zip(r.0.as_flattened()) {
        *value = entry.as_constant()?;
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::super::trial::{body, joint, linkage, same_energy};
    use super::*;
    use crate::expr::Symbol;

    fn decimal(value: f64) -> Number {
        Number::from_f64(value).expect("it is finite")
    }

    /// Two joints with a skew turn and a shift between them; what is behind the second is turned too.
    fn arm<'g>(inner_axis: usize, graph: &'g Graph) -> Linkage<'g> {
        let skew = |x, y| rotation(0, decimal(x), graph) * rotation(1, decimal(y), graph);
        linkage(&[
            (0, joint(2, 0, graph)),
            (1, Edge::Shift(Vector([1, 2, 3].map(|i| graph.integer(i))))),
            (2, Edge::Turn(skew(0.4, -1.1))),
            (3, joint(inner_axis, 1, graph)),
            (4, Edge::Turn(skew(2.0, 0.3))),
            (5, joint(0, 2, graph)),
        ])
    }

    /// A tilt that is known well enough is split off, one that is not stays; what is left of parallel axes is none.
    #[test]
    fn axes_that_are_nearly_parallel_are_not_parallel() {
        let graph = Graph::new();
        let tilted = |angle: f64| {
            let turn = Edge::Turn(rotation(0, decimal(angle), &graph));
            linkage(&[(0, joint(2, 0, &graph)), (1, turn), (2, joint(2, 1, &graph))])
        };
        for angle in [1e-3, 1e-6, 2e-9] {
            let middle = tilted(angle).split(2).expect("a turn").middle.to_f64();
            assert!((middle.abs() - angle).abs() <= 1e-12 * angle, "{angle}: {middle}");
        }
        assert!([1e-10, 1e-14, 1e-17, 1e-25].into_iter().all(|angle| tilted(angle).split(2).is_none()));
        assert!(tilted(1e-29).split(2).is_some_and(|split| split.middle.is_zero()));
    }

    /// Whether a turn takes axes to axes.
    fn is_ring(r: Matrix<'_>) -> bool {
        numbers(r).is_some_and(|r| r.as_flattened().iter().all(|e| [0.0, 1.0, -1.0].contains(&e.to_f64())))
    }

    #[test]
    fn constant_turns_between_joints_become_plane() {
        let graph = Graph::new();
        for inner_axis in 0..3 {
            let old = arm(inner_axis, &graph);
            let inertias: Vec<_> = (0..old.links.len()).map(|link| body(link, &graph)).collect();
            let new = turned(&old, &inertias);
            let is_plane = |link: &Link<'_>| !matches!(link.edge, Some(Edge::Turn(r)) if !is_ring(r));
            assert!(new.linkage.links.iter().all(is_plane), "{inner_axis}");
            same_energy((&old, &inertias), (&new.linkage, &new.inertias));
        }
    }

    /// The second branch finds the axes of its parent turned for the first.
    #[test]
    fn a_branch_is_not_disturbed_by_the_other() {
        let graph = Graph::new();
        let mut old = arm(1, &graph);
        for (parent, edge) in [
            (1, joint(2, 3, &graph)),
            (1, joint(0, 4, &graph)),
            (1, Edge::Turn(rotation(1, decimal(0.7), &graph))),
            (9, joint(1, 5, &graph)),
            (3, Edge::Slide { direction: Vector::unit(&graph, 1), displacement: graph.symbol(Symbol::Coordinate(6)) }),
        ] {
            old.links.push(Link { parent: Some(parent), edge: Some(edge) });
        }
        let inertias: Vec<_> = (0..old.links.len()).map(|link| body(link, &graph)).collect();
        let new = turned(&old, &inertias);
        same_energy((&old, &inertias), (&new.linkage, &new.inertias));
    }

    /// Half a turn added to a joint's angle would cost an angle of 1e7 its last digits.
    #[test]
    fn quarter_turns_stand_before_the_joint() {
        let graph = Graph::new();
        for (first, axis, second) in [(1, 0, 2), (1, 2, 0), (0, 2, 1), (2, 1, 0)] {
            for angle in [1.9, -1.9, 0.4] {
                let turn = rotation(axis, decimal(angle), &graph);
                let old =
                    linkage(&[(0, joint(first, 0, &graph)), (1, Edge::Turn(turn)), (2, joint(second, 1, &graph))]);
                let inertias: Vec<_> = (0..old.links.len()).map(|link| body(link, &graph)).collect();
                let new = turned(&old, &inertias);
                let angles = new.linkage.links.iter().filter_map(|link| match link.edge {
                    Some(Edge::Revolute { angle, .. }) => Some(angle),
                    _ => None,
                });
                let expected = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
                assert_eq!(angles.collect::<Vec<_>>(), expected, "{first} {axis} {second} {angle}");
                same_energy((&old, &inertias), (&new.linkage, &new.inertias));
            }
        }
    }

    /// The cosine of a right angle in doubles is 6e-17: a length with that factor was added to masses.
    #[test]
    fn right_angles_are_exact() {
        let graph = Graph::new();
        for (quarters, [s, c]) in [(-1, [-1, 0]), (1, [1, 0]), (2, [0, -1])] {
            let angle = angle(Number::integer(s), Number::integer(c));
            let Edge::Tilt { sin, cos, .. } = tilt(0, angle, &graph) else { panic!("a tilt") };
            assert_eq!([sin.id(), cos.id()], [graph.integer(s).id(), graph.integer(c).id()], "{quarters}");
        }
    }
}
