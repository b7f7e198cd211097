//! What a mechanism is: coordinates, energies, forces, outputs, and the bodies and frames they were declared with.
//!
//! The expressions live in a verbatim graph, as declared, time derivatives not yet carried out; `derive` works on a
//! copy with the local rules applied, and `verify` proves the result against the verbatim one.

use std::collections::BTreeMap;
#[cfg(test)]
use std::ops::DerefMut;
use std::ops::{Deref, Range};

use crate::expr::table::Table;
use crate::expr::{Expr, Graph, Id, Matrix, Node, Number, Symbol, Vector};
use crate::variable::Variable;

use crate::model::frame::{Edge, FrameId, Frames};
use crate::model::landmark::{Landmarks, Motion};
use crate::model::names::local::Local;

/// A rigid body, or a particle (a body without rotational inertia), whose kinetic energy is part of T.
#[derive(Clone, Copy, Debug)]
pub struct Body<'g> {
    /// Its mass.
    pub mass: Expr<'g>,
    /// Its mass centre in the axes of its frame.
    pub com: Vector<'g>,
    /// Its inertia about the mass centre in the axes of its frame; `None` for a particle.
    pub inertia: Option<Matrix<'g>>,
    /// The frame it is fixed in.
    pub frame: FrameId,
}

/// A force on a point, or a torque on a body: `Q = (∂v/∂q̇)ᵀ F`.
#[derive(Clone, Copy, Debug)]
pub struct PointForce<'g> {
    /// Velocity of the point, or angular velocity of the body.
    pub velocity: Vector<'g>,
    /// The force or torque, in the same axes.
    pub force: Vector<'g>,
    /// Where it acts, if that is a frame or a place that is fixed in one.
    pub application: Option<Application<'g>>,
}

/// Where a force or torque acts, and as what it was declared.
#[derive(Clone, Copy, Debug)]
pub struct Application<'g> {
    /// The frame.
    pub frame: FrameId,
    /// The place that a force acts on, in the axes of the frame; a torque acts on all of it.
    pub point: Option<Vector<'g>>,
    /// The force or torque.
    pub vector: Vector<'g>,
    /// Whether it is in the axes of the world, not of the frame.
    pub is_in_world: bool,
}

/// What kind of constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// `φ(q, t) = 0`
    Holonomic,
    /// `a(q, t)·q̇ + b(q, t) = 0`
    Pfaffian,
}

/// A named constraint of one or more rows.
#[derive(Clone, Debug)]
pub struct Constraint<'g> {
    /// As declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// Holonomic or Pfaffian.
    pub kind: ConstraintKind,
    /// What must vanish.
    pub rows: Vec<Expr<'g>>,
    /// The unit of each row, and that of its multiplier, in SI base units.
    pub units: Vec<[String; 2]>,
}

impl Constraint<'_> {
    /// The names of its rows: `rod`, or `closure_0`, `closure_1`, ….
    pub fn row_names(&self) -> Vec<String> {
        match self.rows.len() {
            1 => vec![self.name.clone()],
            m => (0..m).map(|i| format!("{}_{i}", self.name)).collect(),
        }
    }
}

/// A joint whose wrench is asked for, or an array of them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reaction {
    /// As declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// How many, where it is an array.
    pub length: Option<usize>,
}

impl Reaction {
    /// How many joints.
    pub fn count(&self) -> usize {
        self.length.unwrap_or(1)
    }

    /// The names of the joints: `hinge`, or `joint_0`, `joint_1`, ….
    pub fn component_names(&self) -> Vec<String> {
        match self.length {
            None => vec![self.name.clone()],
            Some(n) => (0..n).map(|i| format!("{}_{i}", self.name)).collect(),
        }
    }
}

/// What an output is.
#[derive(Clone, Debug)]
pub enum OutputValue<'g> {
    /// One number.
    Scalar(Expr<'g>),
    /// Several numbers: a vector's components in world axes, or an array.
    Array(Vec<Expr<'g>>),
    /// Rows of numbers.
    Matrix(Vec<Vec<Expr<'g>>>),
    /// Position and attitude of a frame in the world.
    Pose(FrameId),
    /// Several matrices, all of one size.
    Matrices(Vec<Vec<Vec<Expr<'g>>>>),
    /// Several frames.
    Poses(Vec<FrameId>),
}

impl<'g> OutputValue<'g> {
    /// All numbers, row by row; none of frames.
    pub fn numbers(&self) -> Vec<Expr<'g>> {
        match self {
            OutputValue::Scalar(number) => vec![*number],
            OutputValue::Array(numbers) => numbers.clone(),
            OutputValue::Matrix(rows) => rows.concat(),
            OutputValue::Matrices(matrices) => matrices.concat().concat(),
            OutputValue::Pose(_) | OutputValue::Poses(_) => Vec::new(),
        }
    }

    /// The frames whose position and attitude it is.
    pub fn frames(&self) -> &[FrameId] {
        match self {
            OutputValue::Pose(frame) => std::slice::from_ref(frame),
            OutputValue::Poses(frames) => frames,
            OutputValue::Scalar(_) | OutputValue::Array(_) | OutputValue::Matrix(_) | OutputValue::Matrices(_) => &[],
        }
    }

    /// All components: numbers row by row, of each frame its position and then the rows of its rotation.
    pub fn components(&self, frames: &Frames<'g>) -> Vec<Expr<'g>> {
        let of_frame = |id: &FrameId| {
            let frame = frames.get(*id);
            frame.position.0.into_iter().chain(frame.rotation.0.into_iter().flatten()).collect::<Vec<_>>()
        };
        self.numbers().into_iter().chain(self.frames().iter().flat_map(of_frame)).collect()
    }
}

/// A named output.
#[derive(Clone, Debug)]
pub struct Output<'g> {
    /// As declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// The unit of each of its components, in SI base units; empty of a literal 0 among others that do not share one.
    pub units: Vec<String>,
    /// Its value.
    pub value: OutputValue<'g>,
    /// Whether the time derivative of its Jacobian is generated; only where the value depends on no velocities or
    /// inputs.
    pub jacobian_rate: bool,
}

/// What a body looks like: `shape pose += box([x, y, z]);`.
#[derive(Clone, Debug)]
pub struct Drawing<'g> {
    /// `box`, `cylinder`, `sphere` or `mesh`.
    pub kind: &'static str,
    /// The file of a mesh, as written: from the folder of the file that the statement stands in.
    pub file: Option<String>,
    /// In m: the edges of a box; radius and length of a cylinder along z; the radius of a sphere. Of a mesh the
    /// factors along its axes. Constant in time.
    pub sizes: Vec<Expr<'g>>,
    /// The frame that it is fixed in, with its centre at the origin; a mesh as its file has it. One of
    /// [`pictured`](Draft::pictured).
    pub frame: FrameId,
    /// The pose as written.
    pub on: String,
    /// Where the statement stands.
    pub place: Range<usize>,
}

/// Where a choice between two sides stands in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The condition of an `if`, or the call of a function such as `max` or `abs`.
    pub place: Range<usize>,
    /// Whether it is a condition.
    pub is_condition: bool,
}

/// Auxiliary coordinates of a joint that is let go: shifts along the axes of its pose, then turns about them.
pub(crate) const AUXILIARY: usize = 6;

/// A mechanism as declared: `L = T − V + Σ lagrangian terms`, with `D`, `Q` and outputs. All passes read it; only
/// `model`, whose statements fill in a draft, writes it.
#[derive(Clone, Debug)]
pub struct Lagrangian<'g>(pub(in crate::model) Draft<'g>);

impl<'g> Deref for Lagrangian<'g> {
    type Target = Draft<'g>;

    fn deref(&self) -> &Draft<'g> {
        &self.0
    }
}

/// Tests of the passes put mechanisms together without a text.
#[cfg(test)]
impl<'g> DerefMut for Lagrangian<'g> {
    fn deref_mut(&mut self) -> &mut Draft<'g> {
        &mut self.0
    }
}

#[cfg(test)]
impl<'g> Lagrangian<'g> {
    pub(crate) fn new(graph: &'g Graph, name: &str) -> Self {
        Lagrangian(Draft::new(graph, name))
    }
}

/// A mechanism while statements are added to it, and the parts of a [`Lagrangian`].
#[derive(Clone, Debug)]
pub struct Draft<'g> {
    /// The verbatim graph of all expressions below.
    pub graph: &'g Graph,
    /// In upper camel case, as declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// Generalized coordinates q.
    pub coordinates: Vec<Variable>,
    /// Parameters, constant in time.
    pub parameters: Vec<Variable>,
    /// Inputs u.
    pub inputs: Vec<Variable>,
    /// The terms of T.
    pub kinetic: Vec<Expr<'g>>,
    /// The terms of V.
    pub potential: Vec<Expr<'g>>,
    /// The terms of Rayleigh's D, and those that inputs enter, whose `−∂D/∂q̇` is a part of Q.
    pub dissipation: Vec<Expr<'g>>,
    /// Terms of L that are neither T nor −V.
    pub lagrangian: Vec<Expr<'g>>,
    /// Generalized forces: coordinate number and force; several on one coordinate add up.
    pub forces: Vec<(usize, Expr<'g>)>,
    /// Forces on points and torques on bodies, generalized by virtual work.
    pub point_forces: Vec<PointForce<'g>>,
    /// Run-time signals that prescribe motions, each with two derivatives.
    pub prescribed: Vec<Variable>,
    /// Constraints in declaration order.
    pub constraints: Vec<Constraint<'g>>,
    /// Outputs in declaration order.
    pub outputs: Vec<Output<'g>>,
    /// Joints whose wrenches are asked for, in declaration order.
    pub reactions: Vec<Reaction>,
    /// The mechanism with these joints let go, where there are any: behind its own coordinates it has six
    /// more for each joint, in the order of `reactions`, and is the same mechanism where they are zero. Its constraints
    /// have the same rows.
    pub released: Option<Box<Lagrangian<'g>>>,
    /// The frames, with their twists.
    pub frames: Frames<'g>,
    /// What some of the expressions stand for in space: bodies, places.
    pub landmarks: Landmarks<'g>,
    /// Where in the text choices stand, `if` and functions with a corner, by their numbers in the graph.
    pub choices: BTreeMap<Id, Choice>,
    /// Vectors with the dimension of a length that local names and functions of whole numbers stand for, places among
    /// them: the name (`joint_0` of `joint(0)`), the frame, and the coordinates in it. What a picture is drawn from.
    pub named_lengths: Vec<(String, FrameId, Vector<'g>)>,
    /// What local names and functions stand for.
    pub(crate) locals: Vec<Local<'g>>,
    /// What bodies look like; only where shapes are drawn.
    pub(in crate::model) drawings: Vec<Drawing<'g>>,
    /// The mechanism once more, with its shapes drawn, where there are any: frames that they alone need are in it.
    pub(in crate::model) drawn: Option<Box<Lagrangian<'g>>>,
}

impl<'g> Draft<'g> {
    /// An empty mechanism, to be built up by the methods below.
    pub fn new(graph: &'g Graph, name: &str) -> Self {
        Draft {
            graph,
            name: name.to_string(),
            docs: Vec::new(),
            coordinates: Vec::new(),
            parameters: Vec::new(),
            inputs: Vec::new(),
            kinetic: Vec::new(),
            potential: Vec::new(),
            dissipation: Vec::new(),
            lagrangian: Vec::new(),
            forces: Vec::new(),
            point_forces: Vec::new(),
            prescribed: Vec::new(),
            constraints: Vec::new(),
            outputs: Vec::new(),
            reactions: Vec::new(),
            released: None,
            frames: Frames::new(graph),
            landmarks: Landmarks::default(),
            choices: BTreeMap::new(),
            named_lengths: Vec::new(),
            locals: Vec::new(),
            drawings: Vec::new(),
            drawn: None,
        }
    }

    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.coordinates.iter().map(Variable::count).sum()
    }

    /// The terms of `dissipation` that D consists of, and those that inputs enter: a state alone does not give these.
    pub(crate) fn dissipation_without_and_with_inputs(&self) -> [Vec<Expr<'g>>; 2] {
        let order = self.graph.reachable(self.dissipation.iter().map(|term| term.id()));
        let mut has_input = Table::new(&order, false);
        for &id in &order {
            let node = self.graph.node(id);
            let is_input = matches!(node, Node::Symbol(Symbol::Input(_)));
            has_input[id] = is_input || node.operands().any(|operand| has_input[operand]);
        }
        let (with, without) = self.dissipation.iter().partition(|term| has_input[term.id()]);
        [without, with]
    }

    /// Whether each row of the constraints is holonomic.
    pub fn holonomic_rows(&self) -> Vec<bool> {
        let rows = |c: &Constraint<'_>| vec![c.kind == ConstraintKind::Holonomic; c.rows.len()];
        self.constraints.iter().flat_map(rows).collect()
    }

    /// Adds a coordinate, or an array of them.
    pub fn coordinate(&mut self, name: &str, unit: &str, length: Option<usize>) -> Vec<Expr<'g>> {
        declare(self.graph, &mut self.coordinates, name, unit, length, Vec::new(), Symbol::Coordinate)
    }

    /// Adds an input, or an array of them.
    pub fn input(&mut self, name: &str, unit: &str, length: Option<usize>) -> Vec<Expr<'g>> {
        declare(self.graph, &mut self.inputs, name, unit, length, Vec::new(), Symbol::Input)
    }

    /// Adds a prescribed motion that is given at run time with two derivatives, or an array of them.
    pub fn prescribe(&mut self, name: &str, unit: &str, length: Option<usize>) -> Vec<Expr<'g>> {
        let value = |i| Symbol::Prescribed(i, 0);
        declare(self.graph, &mut self.prescribed, name, unit, length, Vec::new(), value)
    }

    /// Adds a parameter with its default.
    pub fn parameter(&mut self, name: &str, unit: &str, default: Number) -> Expr<'g> {
        declare(self.graph, &mut self.parameters, name, unit, None, vec![default], Symbol::Parameter)[0]
    }

    /// Adds an array of parameters with their defaults.
    pub fn parameter_array(&mut self, name: &str, unit: &str, defaults: Vec<Number>) -> Vec<Expr<'g>> {
        let length = Some(defaults.len());
        declare(self.graph, &mut self.parameters, name, unit, length, defaults, Symbol::Parameter)
    }

    /// For each row of the constraints the first one of the same constraint in the same unit: those are a vector's.
    pub fn constraint_vectors(&self) -> Vec<usize> {
        let rows = self
            .constraints
            .iter()
            .enumerate()
            .flat_map(|(number, constraint)| constraint.units.iter().map(move |[unit, _]| (number, unit.as_str())));
        let rows: Vec<(usize, &str)> = rows.collect();
        let first = |row: &(usize, &str)| rows.iter().position(|other| other == row).unwrap_or_default();
        rows.iter().map(first).collect()
    }

    /// Adds a rigid body's kinetic energy `½ m |v_c|² + ½ ωᵀ I ω` to T.
    ///
    /// Mass centre and inertia are constant in the axes of the frame.
    pub fn rigid_body(&mut self, mass: Expr<'g>, com: Vector<'g>, inertia: Matrix<'g>, frame: FrameId) {
        let energy = self.kinetic_energy_of(&Body { mass, com, inertia: Some(inertia), frame });
        self.kinetic.push(energy);
    }

    /// Adds the kinetic energy `½ m |v|²` of a particle at `point` of `frame` to T.
    pub fn particle(&mut self, mass: Expr<'g>, point: Vector<'g>, frame: FrameId) {
        let energy = self.kinetic_energy_of(&Body { mass, com: point, inertia: None, frame });
        self.kinetic.push(energy);
    }

    /// `½ m |v_c|² + ½ ωᵀ I ω`, ω in the axes of the body's frame, `v·v` as of `Frames::speed_squared`; it is known
    /// from then on as the energy of this body.
    ///
    /// Of a rigid body it is written with the mass moments about the frame's origin, which are constant: `½ m v·v +
    /// h·(v × ω) + ½ ωᵀ J ω` with `h = m c` and `J = I + m (c·c 1 − c cᵀ)`, and each product of two velocities once: on
    /// a six-joint arm a sixth fewer operations in what is derived from it. `v·v` is taken before the turns about the
    /// origin; behind a quaternion e, J has `m |e|⁴` for m, so that T is positive where `|e|` is not 1.
    pub fn kinetic_energy_of(&mut self, body: &Body<'g>) -> Expr<'g> {
        let energy = self.energy_of(body);
        self.landmarks.note_body(energy, *body);
        energy
    }

    /// A body's kinetic energy as a node of its own, which neither another call nor an energy that is written out has.
    pub(in crate::model) fn declared_energy_of(&mut self, body: &Body<'g>) -> Expr<'g> {
        let energy = self.kinetic_energy_of(body).distinct();
        self.landmarks.note_body(energy, *body);
        energy
    }

    /// The expression of [`Draft::kinetic_energy_of`].
    pub(crate) fn energy_of(&self, body: &Body<'g>) -> Expr<'g> {
        let half = 1 / self.graph.integer(2);
        let Body { mass, com, inertia, frame } = *body;
        let Some(inertia) = inertia else {
            let is_at_origin = com == Vector::zero(self.graph);
            let at_point = || self.velocity(com, frame).norm_squared();
            let speed_squared = if is_at_origin { self.frames.speed_squared(frame).0 } else { at_point() };
            return half * mass * speed_squared;
        };
        let (v, w) = (self.frames.get(frame).velocity, self.frames.get(frame).angular_velocity);
        let (speed_squared, stretch) = self.frames.speed_squared(frame);
        let h = com.scale(mass);
        let moments = Matrix::diagonal([com.norm_squared(); 3]) - com.outer(com);
        let Matrix(j) = inertia + moments.scale(mass * stretch);
        let [x, y, z] = w.0;
        let diagonal = j[0][0] * x.powi(2) + j[1][1] * y.powi(2) + j[2][2] * z.powi(2);
        let products = j[0][1] * (x * y) + j[0][2] * (x * z) + j[1][2] * (y * z);
        half * mass * speed_squared + h.dot(v.cross(w)) + half * diagonal + products
    }

    /// Velocity of a point given in the axes of `frame`, in those axes: `v + ω × c + ċ`.
    pub fn velocity(&self, point: Vector<'g>, frame: FrameId) -> Vector<'g> {
        let moving = self.frames.get(frame);
        moving.velocity + moving.angular_velocity.cross(point) + point.map(Expr::rate)
    }

    /// The same velocity in world axes, summed up on the way there: nothing is turned into the axes of the frame and
    /// back, so a component that is exact in the world stays so beside large ones.
    pub(in crate::model) fn velocity_in_world(&self, point: Vector<'g>, frame: FrameId) -> Vector<'g> {
        let own = self.frames.get(frame).angular_velocity.cross(point) + point.map(Expr::rate);
        // An edge that shifts turns no axes, and ω is the same on both sides of it.
        self.frames.way_to_world(frame).fold(own, |v, at| match at.edge {
            Some(Edge::Translation(t)) => v + at.angular_velocity.cross(t) + t.map(Expr::rate),
            Some(edge) => edge.rotation().map_or(v, |r| r * v),
            None => v,
        })
    }

    /// The scalar product of two vectors that are known as multiples of the velocity of one frame's origin, written as
    /// in the kinetic energy of a body there.
    pub(in crate::model) fn product_of_velocities(&self, a: Vector<'g>, b: Vector<'g>) -> Option<Expr<'g>> {
        let of_origin = |vector: Vector<'g>| match self.landmarks.motion(vector)? {
            Motion::Velocity { factor, coordinates, frame } => {
                (coordinates == Vector::zero(self.graph)).then_some((factor, frame))
            }
            Motion::Turning { .. } => None,
        };
        let ((m, frame), (n, other)) = (of_origin(a)?, of_origin(b)?);
        let speed_squared = self.frames.speed_squared(frame).0;
        let factor = if m.is_one() && n.is_one() { None } else { Some(m * n) };
        (frame == other).then(|| factor.map_or(speed_squared, |factor| factor * speed_squared))
    }

    /// Position of a point given in the axes of `frame`, in world axes: `p + R c`.
    pub fn position(&mut self, point: Vector<'g>, frame: FrameId) -> Vector<'g> {
        let moving = self.frames.get(frame);
        let position = moving.position + moving.rotation * point;
        self.landmarks.note_place(position, point, frame);
        position
    }

    /// The bodies among the terms of T, and the terms of T that are no bodies.
    pub fn bodies(&self) -> (Vec<Body<'g>>, Vec<Expr<'g>>) {
        self.landmarks.bodies_of(&self.kinetic, |_| true)
    }
}

fn declare<'g>(
    graph: &'g Graph,
    variables: &mut Vec<Variable>,
    name: &str,
    unit: &str,
    length: Option<usize>,
    defaults: Vec<Number>,
    symbol: fn(u32) -> Symbol,
) -> Vec<Expr<'g>> {
    let first = variables.iter().map(Variable::count).sum();
    let variable = Variable {
        name: name.to_string(),
        docs: Vec::new(),
        unit: unit.to_string(),
        length,
        columns: None,
        first,
        defaults,
        declared_unit: None,
        positive: false,
    };
    let numbers = first..first + variable.count();
    variables.push(variable);
    numbers.map(|i| graph.symbol(symbol(i as u32))).collect()
}
