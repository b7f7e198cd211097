//! What there is to see of a mechanism: bodies, frames, places and lines between them, as functions of the coordinates.
//!
//! Bodies and frames are those of the declaration. A place that is written as a sum, `upper + [l*sin(theta), 0, …]`, is
//! joined to what it is added to, where their distance does not change; so are the two sides of a vector constraint. A
//! named difference of two places, `joint(i) - foot(i)`, is a line between them, of whatever length. Where this sees
//! nothing, frames and bodies are there all the same.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Expr, Id, Node, Vector};
use crate::interpret::{Interpreter, State};
use crate::model::frame::{Edge, FrameId};
use crate::model::lagrangian::{Body, Drawing, Output};
use crate::model::{Lagrangian, OutputValue};
use crate::numeric::Random;
use crate::optimise::{self, Derivation};
use crate::variable;

/// More places than anybody tells apart are not looked at.
const MOST_PLACES: usize = 400;

/// At this many states a line must have one length.
const STATES: usize = 4;

/// What moves, and how it is computed.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Programs of the outputs `frames` (position and rotation of each), `bodies` (mass, mass centre in the body's
    /// frame, inertia about it there: xx, yy, zz, xy, xz, yz), `places` (x, y, z in the world) and `shapes` (three
    /// sizes each, as declared, the rest zero); of none where the list is empty.
    pub derivation: Derivation,
    /// How many frames; each stands behind the one it is attached to.
    pub frames: usize,
    /// What has inertia.
    pub bodies: Vec<SceneBody>,
    /// What bodies look like, as declared.
    pub shapes: Vec<SceneShape>,
    /// Names of the places; empty of those that have none.
    pub places: Vec<String>,
    /// Pairs of places with a line between them.
    pub links: Vec<[usize; 2]>,
    /// Places whose paths are worth a look: mass centres and outputs that move.
    pub traced: Vec<usize>,
}

/// A body of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneBody {
    /// The number of its frame.
    pub frame: usize,
    /// Whether it is a rigid body, no particle.
    pub is_rigid: bool,
    /// Whether shapes are fixed to it, which show it.
    pub has_shape: bool,
}

/// A shape of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneShape {
    /// `box`, `cylinder`, `sphere` or `mesh`.
    pub kind: &'static str,
    /// The file of a mesh, from the folder of the file that the statement stands in.
    pub file: Option<String>,
    /// Where the statement begins, among the texts of all files.
    pub place: usize,
    /// The number of its frame.
    pub frame: usize,
}

impl Scene {
    /// What there is to see of a mechanism.
    pub(crate) fn of(declared: &Lagrangian<'_>) -> Self {
        // Its first outputs are those that were declared; frames of shapes are among its frames.
        let lagrangian = &declared.pictured();
        let declared_outputs = &lagrangian.outputs[..declared.outputs.len()];
        let (bodies, drawings) = (lagrangian.bodies().0, lagrangian.drawings());
        let frames = frames(lagrangian, &bodies, declared_outputs);
        let number = |id: FrameId| frames.iter().position(|frame| *frame == id).unwrap_or_default();
        let mut finder = Finder::new(lagrangian);
        let origins: Vec<usize> =
            frames.iter().map(|&id| finder.place(lagrangian.frames.get(id).position, "")).collect();
        for (&id, &own) in frames.iter().zip(&origins) {
            let frame = lagrangian.frames.get(id);
            let (Some(parent), Some(Edge::Translation(shift))) = (frame.parent, frame.edge) else { continue };
            // What shifts along several coordinates is held by nothing.
            if parent != FrameId::WORLD || finder.freedom(shift) == 1 {
                finder.links.push([origins[number(parent)], own]);
            }
        }
        let mut traced = BTreeSet::new();
        for body in &bodies {
            let centre = finder.place(in_world(lagrangian, body.frame, body.com), "");
            finder.links.push([origins[number(body.frame)], centre]);
            finder.join(centre);
            traced.insert(centre);
        }
        for output in declared_outputs {
            for (name, position) in seen_in(lagrangian, output) {
                let own = finder.place(position, &name);
                finder.join(own);
                traced.insert(own);
            }
        }
        finder.sides_of_constraints();
        finder.named_differences();
        finder.points_of_forces();

        let traced = traced.into_iter().filter(|&place| !finder.is_fixed(finder.places[place].1)).collect();
        let derivation = programs(lagrangian, &frames, &bodies, &finder.places);
        let links = finder.shown_links(&derivation, origins[0]);
        let shown: BTreeSet<FrameId> = drawings.iter().map(|drawing| carrier(lagrangian, drawing.frame)).collect();
        let of_body = |body: &Body<'_>| SceneBody {
            frame: number(body.frame),
            is_rigid: body.inertia.is_some(),
            has_shape: shown.contains(&carrier(lagrangian, body.frame)),
        };
        let of_drawing = |drawing: &Drawing<'_>| SceneShape {
            kind: drawing.kind,
            file: drawing.file.clone(),
            place: drawing.place.start,
            frame: number(drawing.frame),
        };
        Scene {
            derivation,
            frames: frames.len(),
            bodies: bodies.iter().map(of_body).collect(),
            shapes: drawings.iter().map(of_drawing).collect(),
            places: finder.places.into_iter().map(|(name, _)| name).collect(),
            links,
            traced,
        }
    }
}

/// The frame that a frame does not move in, as near to the world as can be.
fn carrier(lagrangian: &Lagrangian<'_>, frame: FrameId) -> FrameId {
    let graph = lagrangian.graph;
    let is_fixed = |values: &[Expr<'_>]| values.iter().all(|value| graph.is_parametric(value.id()));
    let mut at = frame;
    while let Some(parent) = lagrangian.frames.get(at).parent {
        let stays = match lagrangian.frames.get(at).edge {
            Some(Edge::Rotation { angle, .. }) => is_fixed(&[angle]),
            Some(Edge::Quaternion(e)) => is_fixed(&e),
            Some(Edge::Translation(shift)) => is_fixed(&shift.0),
            None => true,
        };
        if !stays {
            return at;
        }
        at = parent;
    }
    at
}

/// The frames of bodies, shapes and outputs, and those that they hang from, the world first.
fn frames(lagrangian: &Lagrangian<'_>, bodies: &[Body<'_>], outputs: &[Output<'_>]) -> Vec<FrameId> {
    let outputs = outputs.iter().flat_map(|output| output.value.frames().iter().copied());
    let drawings = lagrangian.drawings().iter().map(|drawing| drawing.frame);
    let mut frames = BTreeSet::from([FrameId::WORLD]);
    for leaf in bodies.iter().map(|body| body.frame).chain(drawings).chain(outputs) {
        let ancestors = std::iter::successors(Some(leaf), |id| lagrangian.frames.get(*id).parent);
        frames.extend(ancestors);
    }
    frames.into_iter().collect()
}

/// A place in a frame, in world axes.
fn in_world<'g>(lagrangian: &Lagrangian<'g>, frame: FrameId, coordinates: Vector<'g>) -> Vector<'g> {
    let at = lagrangian.frames.get(frame);
    // The origin itself is written as the frame has it: what it is a sum of is seen.
    match frame == FrameId::WORLD {
        true => coordinates,
        false if coordinates == Vector::zero(lagrangian.graph) => at.position,
        false => at.position + at.rotation * coordinates,
    }
}

/// The places that an output shows.
fn seen_in<'g>(lagrangian: &Lagrangian<'g>, output: &Output<'g>) -> Vec<(String, Vector<'g>)> {
    let frames = output.value.frames().iter().map(|&id| lagrangian.frames.get(id).position).collect::<Vec<_>>();
    let positions = match &output.value {
        OutputValue::Pose(_) | OutputValue::Poses(_) => frames,
        OutputValue::Array(numbers) if output.units.iter().all(|unit| unit == "m" || unit.is_empty()) => {
            match numbers.as_slice() {
                &[x, y, z] => vec![Vector([x, y, z])],
                _ => Vec::new(),
            }
        }
        OutputValue::Array(_) | OutputValue::Scalar(_) | OutputValue::Matrix(_) | OutputValue::Matrices(_) => {
            Vec::new()
        }
    };
    let several = positions.len() > 1;
    let name = |i: usize| if several { format!("{}_{i}", output.name) } else { output.name.clone() };
    positions.into_iter().enumerate().map(|(i, position)| (name(i), position)).collect()
}

/// The programs of frames, bodies, places and shapes.
fn programs<'g>(
    lagrangian: &Lagrangian<'g>,
    frames: &[FrameId],
    bodies: &[Body<'g>],
    places: &[(String, Vector<'g>)],
) -> Derivation {
    let zero = lagrangian.graph.integer(0);
    let of_body = |body: &Body<'g>| {
        let inertia = body.inertia.map_or([zero; 6], |i| {
            let i = i.0;
            [i[0][0], i[1][1], i[2][2], i[0][1], i[0][2], i[1][2]]
        });
        [&[body.mass], &body.com.0[..], &inertia].concat()
    };
    let sizes = |drawing: &Drawing<'g>| [0, 1, 2].map(|i| drawing.sizes.get(i).copied().unwrap_or(zero));
    let numbers = |numbers: Vec<Expr<'g>>| (!numbers.is_empty()).then_some(OutputValue::Array(numbers));
    let values = [
        ("frames", Some(OutputValue::Poses(frames.to_vec()))),
        ("bodies", numbers(bodies.iter().flat_map(of_body).collect())),
        ("places", numbers(places.iter().flat_map(|(_, position)| position.0).collect())),
        ("shapes", numbers(lagrangian.drawings().iter().flat_map(sizes).collect())),
    ];
    let output = |(name, value): (&str, Option<OutputValue<'g>>)| {
        let (name, docs, units) = (name.to_string(), Vec::new(), Vec::new());
        value.map(|value| Output { name, docs, units, value, jacobian_rate: false })
    };
    optimise::of_outputs(&lagrangian.seen(values.into_iter().filter_map(output).collect()))
}

/// Gathers places and lines.
struct Finder<'l, 'g> {
    lagrangian: &'l Lagrangian<'g>,
    places: Vec<(String, Vector<'g>)>,
    numbers: BTreeMap<[Id; 3], usize>,
    /// Lines that are there in any case.
    links: Vec<[usize; 2]>,
    /// Lines, if they keep their length.
    supposed: Vec<[usize; 2]>,
    /// What names stand for.
    named: BTreeMap<[Id; 3], &'l str>,
}

fn key(vector: Vector<'_>) -> [Id; 3] {
    vector.0.map(Expr::id)
}

/// How deep sums with zero and products with one are looked through: a rotation about nothing is three of each.
const LOOKED_THROUGH: usize = 8;

/// The same without sums with zero and products with zero or one, as poses of frames that do not turn have them.
fn peeled(value: Expr<'_>, depth: usize) -> Expr<'_> {
    let graph = value.graph();
    let (Node::Add(a, b) | Node::Mul(a, b)) = value.node() else { return value };
    if depth == 0 {
        return value;
    }
    let [a, b] = [a, b].map(|operand| peeled(graph.expr(operand), depth - 1));
    match value.node() {
        Node::Add(..) if a.is_zero() => b,
        Node::Add(..) if b.is_zero() => a,
        Node::Mul(..) if a.is_zero() || b.is_one() => a,
        Node::Mul(..) if b.is_zero() || a.is_one() => b,
        _ => value,
    }
}

/// The operands of a sum or of a difference.
fn operands<'g>(value: Expr<'g>, of_sum: bool) -> Option<(Expr<'g>, Expr<'g>)> {
    let graph = value.graph();
    match value.node() {
        Node::Add(a, b) if of_sum => Some((graph.expr(a), graph.expr(b))),
        Node::Sub(a, b) => Some((graph.expr(a), graph.expr(b))),
        _ => None,
    }
}

impl<'l, 'g> Finder<'l, 'g> {
    fn new(lagrangian: &'l Lagrangian<'g>) -> Self {
        let named = lagrangian.named_lengths.iter().filter(|(_, frame, _)| *frame == FrameId::WORLD);
        let named = named.map(|(name, _, vector)| (key(*vector), name.as_str())).collect();
        let (places, numbers) = (Vec::new(), BTreeMap::new());
        Finder { lagrangian, places, numbers, links: Vec::new(), supposed: Vec::new(), named }
    }

    /// The number of a place; the first name that it is given stays.
    fn place(&mut self, position: Vector<'g>, name: &str) -> usize {
        let position = position.map(|component| peeled(component, LOOKED_THROUGH));
        let number = *self.numbers.entry(key(position)).or_insert_with(|| {
            self.places.push((String::new(), position));
            self.places.len() - 1
        });
        let own = &mut self.places[number].0;
        if own.is_empty() {
            *own = if name.is_empty() { self.named.get(&key(position)).unwrap_or(&"") } else { name }.to_string();
        }
        number
    }

    fn is_fixed(&self, position: Vector<'g>) -> bool {
        position.0.iter().all(|component| self.lagrangian.graph.is_parametric(component.id()))
    }

    /// How many components change.
    fn freedom(&self, shift: Vector<'g>) -> usize {
        shift.0.iter().filter(|component| !self.lagrangian.graph.is_parametric(component.id())).count()
    }

    /// What a place is written as the sum of: another place, and the way from there.
    fn base(&self, position: Vector<'g>) -> Option<Vector<'g>> {
        let zero = self.lagrangian.graph.integer(0);
        let parts = position.0.map(|component| operands(component, true).map(|(base, _)| base));
        parts.iter().any(Option::is_some).then(|| {
            let bases = Vector(parts.map(|base| base.unwrap_or(zero)));
            // A component that is the same in both is no sum.
            let named = self.named.keys().find(|named| {
                (0..3).all(|i| named[i] == bases.0[i].id() || (parts[i].is_none() && named[i] == position.0[i].id()))
            });
            named.map_or(bases, |named| Vector(named.map(|id| self.lagrangian.graph.expr(id))))
        })
    }

    /// Supposes lines from a place to the one that it is added to, and on from there.
    fn join(&mut self, place: usize) {
        let mut at = place;
        // Sums of sums end.
        for _ in 0..MOST_PLACES {
            let position = self.places[at].1;
            if self.is_fixed(position) || self.places.len() > MOST_PLACES {
                return;
            }
            let Some(base) = self.base(position) else {
                let origin = self.place(Vector::zero(self.lagrangian.graph), "");
                self.supposed.push([origin, at]);
                return;
            };
            let base = self.place(base, "");
            self.supposed.push([base, at]);
            at = base;
        }
    }

    /// Both sides of constraints that are vectors are places.
    fn sides_of_constraints(&mut self) {
        for constraint in &self.lagrangian.constraints {
            if constraint.units.iter().any(|[unit, _]| unit != "m") || !(2..=3).contains(&constraint.rows.len()) {
                continue;
            }
            let sides: Option<Vec<_>> = constraint.rows.iter().map(|row| operands(*row, false)).collect();
            let Some(sides) = sides else { continue };
            let (left, right): (Vec<_>, Vec<_>) = sides.into_iter().unzip();
            for side in [left, right] {
                if let Some(position) = self.spread(&side) {
                    let place = self.place(position, "");
                    self.join(place);
                }
            }
        }
    }

    /// Rows as a vector; of two rows the third component vanishes: the one without which they begin at a known place.
    fn spread(&self, rows: &[Expr<'g>]) -> Option<Vector<'g>> {
        let zero = self.lagrangian.graph.integer(0);
        let ways = match *rows {
            [x, y, z] => vec![[x, y, z]],
            [a, b] => vec![[a, zero, b], [a, b, zero], [zero, a, b]],
            _ => return None,
        };
        let is_known = |position: &Vector<'g>| {
            let base = self.base(*position);
            let known = |place| self.numbers.contains_key(&key(place)) || self.named.contains_key(&key(place));
            known(*position) || base.is_some_and(known)
        };
        let mut ways = ways.into_iter().map(Vector);
        ways.find(is_known)
    }

    /// Names for a difference of two places, the first of which has a name or is seen.
    fn named_differences(&mut self) {
        let zero = self.lagrangian.graph.integer(0);
        for (_, frame, vector) in &self.lagrangian.named_lengths {
            if *frame != FrameId::WORLD || self.places.len() > MOST_PLACES {
                continue;
            }
            let parts = vector.0.map(|component| operands(component, false));
            if parts.iter().all(Option::is_none) {
                continue;
            }
            let [mut from, mut to] = [*vector, Vector::zero(self.lagrangian.graph)];
            for i in 0..3 {
                let (a, b) = parts[i].unwrap_or((vector.0[i], zero));
                (from.0[i], to.0[i]) = (a, b);
            }
            if self.numbers.contains_key(&key(from)) || self.named.contains_key(&key(from)) {
                let ends = [from, to].map(|end| self.place(end, ""));
                self.links.push(ends);
                ends.into_iter().for_each(|end| self.join(end));
            }
        }
    }

    /// Where forces act.
    fn points_of_forces(&mut self) {
        let graph = self.lagrangian.graph;
        for force in &self.lagrangian.point_forces {
            let rates = force.velocity.0.map(|component| match component.node() {
                Node::Rate(id) => Some(graph.expr(id)),
                _ => None,
            });
            if let [Some(x), Some(y), Some(z)] = rates
                && self.named.contains_key(&key(Vector([x, y, z])))
            {
                let place = self.place(Vector([x, y, z]), "");
                self.join(place);
            }
        }
    }

    /// Lines, each once: those that are there in any case, and of the others those that keep a length.
    fn shown_links(&self, scene: &Derivation, world: usize) -> Vec<[usize; 2]> {
        let lengths = self.lengths(scene);
        let keeps = |[a, b]: &[usize; 2]| {
            let own: Vec<f64> = lengths.iter().map(|of| of([*a, *b])).collect();
            let (least, most) = own.iter().fold((f64::MAX, 0.0_f64), |(l, m), &x| (l.min(x), m.max(x)));
            most.is_finite() && most > 0.0 && most - least <= 1e-9 * most
        };
        let rigid = self.supposed.iter().filter(|link| keeps(link));
        let mut links: Vec<[usize; 2]> = self.links.iter().chain(rigid).copied().collect();
        links.retain(|[a, b]| {
            a != b
                && !(self.is_fixed(self.places[*a].1)
                    && self.is_fixed(self.places[*b].1)
                    && (*a != world && *b != world))
        });
        links.iter_mut().for_each(|link| link.sort_unstable());
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Distances of places at random states.
    fn lengths(&self, scene: &Derivation) -> Vec<impl Fn([usize; 2]) -> f64> {
        let mut random = Random::new(0x7363_656e);
        let interpreter = Interpreter::new(scene);
        let signals = variable::count(&scene.prescribed);
        let states = (0..STATES).map(|_| State {
            q: random.vector(scene.dof(), 1.0),
            qd: random.vector(scene.dof(), 1.0),
            u: random.vector(variable::count(&scene.inputs), 1.0),
            prescribed: random.vector(signals, 1.0).into_iter().map(|value| [value, 0.0, 0.0]).collect(),
            ..State::default()
        });
        let values = states.map(|state| {
            let places = scene.named("places").map(|function| interpreter.evaluate(function, &state));
            let places = places.unwrap_or_default();
            move |[a, b]: [usize; 2]| {
                let squares = (0..3).map(|i| (places[3 * a + i] - places[3 * b + i]).powi(2));
                squares.sum::<f64>().sqrt()
            }
        });
        values.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    /// Links as pairs of positions at a state.
    fn links(text: &str, q: &[f64]) -> Vec<[[f64; 3]; 2]> {
        let graph = Graph::verbatim();
        let (lagrangian, _) = crate::declared(text, &graph, &[]).unwrap();
        let scene = Scene::of(&lagrangian);
        let state = State { q: q.to_vec(), qd: vec![0.0; q.len()], ..State::default() };
        let places = Interpreter::new(&scene.derivation).evaluate(scene.derivation.named("places").unwrap(), &state);
        let at = |place: usize| [0, 1, 2].map(|i| (1e6 * places[3 * place + i]).round() / 1e6 + 0.0);
        scene.links.iter().map(|link| link.map(at)).collect()
    }

    #[test]
    fn rods_of_a_pendulum_of_sums() {
        let text = "mechanism A { param m: kg = 1; param l: m = 2; coord a: rad; coord b: rad;
            let upper = [l*sin(a), 0, -l*cos(a)]; let lower = upper + [l*sin(b), 0, -l*cos(b)];
            kinetic += particle(m, upper) + particle(m, lower); }";
        let [origin, upper, lower] = [[0.0; 3], [0.0, 0.0, -2.0], [0.0, 0.0, -4.0]];
        assert_eq!(links(text, &[0.0, 0.0]), [[origin, upper], [upper, lower]]);
    }

    #[test]
    fn what_slides_is_not_joined_to_the_world() {
        let text = "mechanism A { param m: kg = 1; param l: m = 2; coord x: m; coord a: rad;
            let bob = [x + l*sin(a), 0, -l*cos(a)];
            kinetic += 1/2*m*dt(x)^2 + particle(m, bob); }";
        assert_eq!(links(text, &[3.0, 0.0]), [[[3.0, 0.0, -2.0], [3.0, 0.0, 0.0]]]);
    }

    #[test]
    fn a_loop_is_closed_and_a_difference_is_a_line() {
        let text = "mechanism A { param m: kg = 1; coord a: rad; coord b: rad; const l: m = 1; const d: m = 3;
            fn along(angle) = [l*cos(angle), 0, l*sin(angle)];
            let knee = along(a); let base = [d, 0, 0];
            kinetic += particle(m, knee);
            kinetic += 1/2*m*l^2*dt(b)^2;
            constraint closure: knee + along(a + b) = base + along(b); }";
        let found = links(text, &[0.0, 0.0]);
        for wanted in
            [[[0.0; 3], [1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0]]]
        {
            assert!(
                found.iter().any(|link| *link == wanted || *link == [wanted[1], wanted[0]]),
                "{wanted:?} {found:?}"
            );
        }
        let text = "mechanism A { param m: kg = 1; coord x: m; coord y: m; const d: m = 3;
            fn joint(i) = [x + i*d, y, 0]; fn foot(i) = [i*d, 0, -d]; fn leg(i) = joint(i) - foot(i);
            kinetic += particle(m, [x, y, 0]);
            for i in 0..2 { potential += 1 N*leg(i).norm(); } }";
        let found = links(text, &[0.5, 0.25]);
        assert!(found.contains(&[[0.5, 0.25, 0.0], [0.0, 0.0, -3.0]]), "{found:?}");
        assert!(found.contains(&[[3.5, 0.25, 0.0], [3.0, 0.0, -3.0]]), "{found:?}");
    }

    #[test]
    fn bodies_hang_from_their_frames() {
        let text = "mechanism A { param m: kg = 1; coord a: rad; coord b: rad; const l: m = 1;
            let upper = rot_y(a) * translation([l, 0, 0]);
            let lower = upper * rot_z(b);
            kinetic += rigid_body(m, [0, l, 0], diag(1, 1, 1)*m*l^2, lower);
            output end = lower; }";
        let graph = Graph::verbatim();
        let (lagrangian, _) = crate::declared(text, &graph, &[]).unwrap();
        let scene = Scene::of(&lagrangian);
        let body = SceneBody { frame: 3, is_rigid: true, has_shape: false };
        assert_eq!((scene.frames, &scene.bodies[..]), (4, &[body][..]));
        let found = links(text, &[0.0, 0.0]);
        assert_eq!(found, [[[0.0; 3], [1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]]);
        let state = State { q: vec![0.0, 0.0], ..State::default() };
        let bodies = Interpreter::new(&scene.derivation).evaluate(scene.derivation.named("bodies").unwrap(), &state);
        assert_eq!(bodies, [1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn shapes_show_the_bodies_that_they_are_fixed_to() {
        let text = "mechanism A { param m: kg = 1; param r: m = 0.5; coord a: rad; coord b: rad; const l: m = 1;
            let upper = rot_y(a); let lower = upper * translation([l, 0, 0]) * rot_y(b);
            kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, upper);
            kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, lower);
            shape lower * translation([0, 0, l]) += cylinder(r, l); }";
        let graph = Graph::verbatim();
        let (lagrangian, _) = crate::declared(text, &graph, &[]).unwrap();
        let scene = Scene::of(&lagrangian);
        assert_eq!(scene.bodies.iter().map(|body| body.has_shape).collect::<Vec<_>>(), [false, true]);
        let [shape] = &scene.shapes[..] else { panic!("{:?}", scene.shapes) };
        assert_eq!((shape.kind, shape.file.as_deref()), ("cylinder", None));
        assert!(text[shape.place..].starts_with("shape lower"));
        let state = State { q: vec![0.0, 0.0], ..State::default() };
        let sizes = Interpreter::new(&scene.derivation).evaluate(scene.derivation.named("shapes").unwrap(), &state);
        assert_eq!(sizes, [0.5, 1.0, 0.0]);
    }

    #[test]
    fn nothing_to_see_is_no_error() {
        let text = "mechanism A { coord a: rad; kinetic += 1 kg*m^2*dt(a)^2; }";
        let graph = Graph::verbatim();
        let (lagrangian, _) = crate::declared(text, &graph, &[]).unwrap();
        let scene = Scene::of(&lagrangian);
        assert_eq!((scene.frames, scene.bodies.len(), scene.links.len()), (1, 0, 0));
    }
}
