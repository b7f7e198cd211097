//! Landmarks: what some of the verbatim expressions stand for in space.
//!
//! `½ m dt(p).norm_squared()` is a sum of squares like any other, but `p` was a point of a frame: whoever knows that
//! finds the body again behind the scalar, and gravity behind `m g p.z`. The expressions are one node wherever they are
//! written, so a table from nodes to their meaning is enough, and a node that is missing in it loses nothing but speed.

use std::collections::BTreeMap;

use crate::expr::graph::IdMap;
use crate::expr::{Expr, HalfInteger, Id, Matrix, Node, Vector};
use crate::model::frame::FrameId;
use crate::model::lagrangian::Body;

/// A world component of a place that is fixed in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<'g> {
    /// Along which axis of the world: 0, 1 or 2.
    pub axis: usize,
    /// Where, in the axes of the frame.
    pub coordinates: Vector<'g>,
    /// The frame.
    pub frame: FrameId,
}

/// A vector that is linear in how a frame moves; in any axes, as long as all that it is multiplied with are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) enum Motion<'g> {
    /// The velocity of a place that is fixed in the frame, times a factor: a momentum.
    Velocity { factor: Expr<'g>, coordinates: Vector<'g>, frame: FrameId },
    /// `A ω`, with A in the axes of the frame.
    Turning { tensor: Matrix<'g>, frame: FrameId },
}

/// What nodes stand for.
#[derive(Clone, Debug, Default)]
pub struct Landmarks<'g> {
    bodies: IdMap<Body<'g>>,
    places: IdMap<Place<'g>>,
    /// World components of velocities.
    velocities: IdMap<Place<'g>>,
    motions: BTreeMap<[Id; 3], Motion<'g>>,
}

impl<'g> Landmarks<'g> {
    /// That an expression is the kinetic energy of a body.
    pub(in crate::model) fn note_body(&mut self, energy: Expr<'g>, body: Body<'g>) {
        self.bodies.insert(energy.id(), body);
    }

    /// That these are the world components of a place.
    pub(in crate::model) fn note_place(&mut self, position: Vector<'g>, coordinates: Vector<'g>, frame: FrameId) {
        for (axis, &component) in position.0.iter().enumerate() {
            self.note_component(component, Place { axis, coordinates, frame });
        }
    }

    /// That an expression is a world component of a place; one that moves in its frame says nothing.
    pub(in crate::model) fn note_component(&mut self, component: Expr<'g>, place: Place<'g>) {
        if place.coordinates.0.iter().all(|&c| is_still(c)) {
            self.places.insert(component.id(), place);
        }
    }

    /// That a vector is the motion of something.
    pub(in crate::model) fn note_motion(&mut self, vector: Vector<'g>, motion: Motion<'g>) {
        self.motions.insert(key(vector), motion);
    }

    /// What moves so.
    pub(in crate::model) fn motion(&self, vector: Vector<'g>) -> Option<Motion<'g>> {
        self.motions.get(&key(vector)).copied()
    }

    /// That one vector is another in other axes.
    pub(in crate::model) fn note_turned(&mut self, from: Vector<'g>, to: Vector<'g>) {
        if let Some(motion) = self.motion(from) {
            self.note_motion(to, motion);
        }
    }

    /// That one vector is a multiple of another.
    pub(in crate::model) fn note_scaled(&mut self, from: Vector<'g>, by: Expr<'g>, to: Vector<'g>) {
        if !is_still(by) {
            return;
        }
        let scaled = match self.motion(from) {
            Some(Motion::Velocity { factor, coordinates, frame }) => {
                Motion::Velocity { factor: by * factor, coordinates, frame }
            }
            Some(Motion::Turning { tensor, frame }) => Motion::Turning { tensor: tensor.scale(by), frame },
            None => return,
        };
        self.note_motion(to, scaled);
    }

    /// That one vector is a matrix times another, rows and columns in these axes: of an angular velocity, a momentum.
    pub(in crate::model) fn note_transformed(
        &mut self,
        from: Vector<'g>,
        axes: (FrameId, FrameId),
        by: Matrix<'g>,
        to: Vector<'g>,
    ) {
        if let Some(Motion::Turning { tensor, frame }) = self.motion(from)
            && axes == (frame, frame)
            && by.0.as_flattened().iter().all(|&entry| is_still(entry))
        {
            self.note_motion(to, Motion::Turning { tensor: by * tensor, frame });
        }
    }

    /// That an expression is the scalar product of two vectors: twice a kinetic energy, where both are of one motion.
    pub(in crate::model) fn note_product(&mut self, a: Vector<'g>, b: Vector<'g>, product: Expr<'g>) {
        let (Some(a), Some(b)) = (self.motion(a), self.motion(b)) else { return };
        let graph = product.graph();
        let body = match (a, b) {
            (
                Motion::Velocity { factor: m, coordinates, frame },
                Motion::Velocity { factor: n, coordinates: c, frame: f },
            ) if coordinates == c && frame == f => Body { mass: 2 * m * n, com: coordinates, inertia: None, frame },
            (Motion::Turning { tensor: a, frame }, Motion::Turning { tensor: b, frame: f }) if frame == f => {
                // (A ω)·(B ω) = ½ ωᵀ (AᵀB + BᵀA) ω
                let inertia = a.transpose() * b + b.transpose() * a;
                Body { mass: graph.integer(0), com: Vector::zero(graph), inertia: Some(inertia), frame }
            }
            _ => return,
        };
        self.note_body(product, body);
    }

    /// That an expression is the world component of a vector along an axis.
    pub(in crate::model) fn note_component_of(&mut self, vector: Vector<'g>, axis: usize, component: Expr<'g>) {
        if let Some(Motion::Velocity { factor, coordinates, frame }) = self.motion(vector)
            && factor.is_one()
        {
            self.velocities.insert(component.id(), Place { axis, coordinates, frame });
        }
    }

    /// Bodies whose kinetic energies add up, with factors that are constant in time, to the sum of these terms, and the
    /// terms left over. Squares of velocities are particles on these frames alone.
    pub fn bodies_of(
        &self,
        energies: &[Expr<'g>],
        has_particles: impl Fn(FrameId) -> bool,
    ) -> (Vec<Body<'g>>, Vec<Expr<'g>>) {
        let (mut bodies, mut rest, mut squares) = (Vec::new(), Vec::new(), Vec::new());
        for (factor, term) in energies.iter().flat_map(|&e| terms(e, |term| self.bodies.contains_key(&term))) {
            match (self.bodies.get(&term.id()), self.squared_velocity(term)) {
                (Some(body), _) => bodies.push(scaled(body, factor)),
                (None, Some(place)) if has_particles(place.frame) => {
                    squares.push(Square { factor, place, term: factor * term });
                }
                (None, _) => rest.push(factor * term),
            }
        }
        gather(squares, &mut bodies, &mut rest);
        (bodies, rest)
    }

    /// The place whose velocity's component is squared here.
    fn squared_velocity(&self, term: Expr<'g>) -> Option<Place<'g>> {
        let graph = term.graph();
        let squared = match term.node() {
            Node::Power(a, n) if n == HalfInteger::integer(2) => a,
            Node::Mul(a, b) if a == b => a,
            _ => return None,
        };
        let by_rate = match graph.node(squared) {
            Node::Rate(place) => self.places.get(&place),
            _ => None,
        };
        by_rate.or(self.velocities.get(&squared)).copied()
    }

    /// The place of which an expression is a world component.
    pub fn place(&self, expression: Id) -> Option<Place<'g>> {
        self.places.get(&expression).copied()
    }

    /// The place of whose velocity an expression is a world component.
    pub fn velocity(&self, expression: Id) -> Option<Place<'g>> {
        self.velocities.get(&expression).copied()
    }

    /// Components of places that add up, with factors that are constant in time, to `energy`, and the terms left over.
    pub fn places_of(&self, energy: Expr<'g>) -> (Vec<(Expr<'g>, Place<'g>)>, Vec<Expr<'g>>) {
        let (mut places, mut rest) = (Vec::new(), Vec::new());
        for (factor, term) in terms(energy, |term| self.places.contains_key(&term)) {
            match self.places.get(&term.id()) {
                Some(place) => places.push((factor, *place)),
                None => rest.push(factor * term),
            }
        }
        (places, rest)
    }
}

/// `factor · (component of a place's velocity)²`
#[derive(Clone, Copy)]
struct Square<'g> {
    factor: Expr<'g>,
    place: Place<'g>,
    /// All of it.
    term: Expr<'g>,
}

/// `m ẋ² + m ẏ² + m ż²` of one place is a particle; squares that find no fellows are left over.
fn gather<'g>(squares: Vec<Square<'g>>, bodies: &mut Vec<Body<'g>>, rest: &mut Vec<Expr<'g>>) {
    let mut waiting: BTreeMap<(FrameId, [Id; 3], Id), Vec<Square<'g>>> = BTreeMap::new();
    for square in squares {
        let Square { factor, place, term } = square;
        let fellows = waiting.entry((place.frame, key(place.coordinates), factor.id())).or_default();
        if fellows.iter().any(|other| other.place.axis == place.axis) {
            rest.push(term);
        } else {
            fellows.push(square);
        }
    }
    for fellows in waiting.into_values() {
        match fellows[..] {
            [Square { factor, place: Place { coordinates, frame, .. }, .. }, _, _] => {
                bodies.push(Body { mass: 2 * factor, com: coordinates, inertia: None, frame });
            }
            _ => rest.extend(fellows.iter().map(|square| square.term)),
        }
    }
}

fn key(vector: Vector<'_>) -> [Id; 3] {
    vector.0.map(Expr::id)
}

fn scaled<'g>(body: &Body<'g>, factor: Expr<'g>) -> Body<'g> {
    Body { mass: factor * body.mass, inertia: body.inertia.map(|inertia| inertia.scale(factor)), ..*body }
}

/// The terms of a sum, each split into a factor that is constant in time and the rest; what is `known` is not taken
/// apart.
pub(in crate::model) fn terms<'g>(sum: Expr<'g>, known: impl Fn(Id) -> bool) -> Vec<(Expr<'g>, Expr<'g>)> {
    let graph = sum.graph();
    let mut waiting = vec![(graph.integer(1), sum.id())];
    let mut terms = Vec::new();
    while let Some((factor, id)) = waiting.pop() {
        match graph.node(id) {
            _ if known(id) => terms.push((factor, graph.expr(id))),
            Node::Neg(a) => waiting.push((-factor, a)),
            Node::Add(a, b) => waiting.extend([(factor, b), (factor, a)]),
            Node::Sub(a, b) => waiting.extend([(-factor, b), (factor, a)]),
            Node::Mul(a, b) if graph.is_parametric(a) => waiting.push((factor * graph.expr(a), b)),
            // |v|² written as the square of a length
            Node::Power(root, n) if n == HalfInteger::integer(2) => match graph.node(root) {
                Node::Power(square, half) if half == HalfInteger::HALF => waiting.push((factor, square)),
                _ => terms.push((factor, graph.expr(id))),
            },
            Node::Mul(a, b) if graph.is_parametric(b) => waiting.push((factor * graph.expr(b), a)),
            _ => terms.push((factor, graph.expr(id))),
        }
        // In loops a sum could double with each turn; what is left is one term.
        if terms.len() + waiting.len() > MOST_TERMS {
            return vec![(graph.integer(1), sum)];
        }
    }
    terms
}

/// A longer sum is left as one number.
const MOST_TERMS: usize = 10_000;

/// Whether it is constant in time.
pub(crate) fn is_still(e: Expr<'_>) -> bool {
    e.graph().is_parametric(e.id())
}
