//! Forces at places that no body holds: where a body slides, the place of contact moves on over it.
//!
//! `force at r += F` adds `Q = (∂ṙ/∂q̇)ᵀ F`, with the velocity of the *place*. Of a place that is fixed in a body that
//! is the velocity of the body's point there, `v = v_o + ω × (r − r_o)`; of a place of contact it is not, and the force
//! would not turn the body as it does. Two signs of it are looked for:
//!
//! - the place is counted in a pose, by components that depend on the coordinates which move the pose itself;
//! - the force is friction against the velocity `v` of a body's point, and drives its place nevertheless: at all states
//!   `F·v ≤ 0`, at some `F·ṙ > 0`, and all forces together bring energy in.
//!
//! Both at random states, with the default parameters. What moves with no motion of the coordinates is no part of it.

use std::collections::BTreeSet;

use crate::diagnostic::Code;
use crate::expr::{Dual, Expr, Graph, Node, Symbol, Tape, Vector, carry_out};
use crate::model::check::Place;
use crate::model::check::misplaced::motions;
use crate::model::check::sample::default_parameters;
use crate::model::check::singular::along_the_motion;
use crate::model::frame::{Edge, FrameId};
use crate::model::lagrangian::{Body, Draft};
use crate::model::landmark::is_still;
use crate::model::value::constant::Dependence;
use crate::model::value::evaluate::Resolver;
use crate::numeric::Random;
use crate::state::State;

/// Where a force acts that was declared with its place.
#[derive(Clone, Debug)]
pub(in crate::model) struct Acting<'g> {
    /// Its number among the forces on points and torques.
    pub(in crate::model) number: usize,
    /// The axes of its velocity and of the force.
    pub(in crate::model) axes: FrameId,
    pub(in crate::model) position: Position<'g>,
    /// In the text.
    pub(in crate::model) place: Place,
}

/// A place, as it was written.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) enum Position<'g> {
    /// Coordinates in a frame.
    Of(Vector<'g>, FrameId),
    /// From the origin of the world, in the axes of a frame.
    FromTheWorld(Vector<'g>, FrameId),
}

/// How many states are looked at.
const STATES: usize = 40;

const HELP: &str = "friction of a body that slides is `dissipation += 1/2*c*slip.norm_squared();`; any force F on the \
                    body where it touches is `force at pose.origin() += F; torque on pose += r.cross(F);`, with r from \
                    the origin of the pose to that place";

impl<'g> Resolver<'_, 'g> {
    pub(in crate::model) fn warn_of_places_no_body_holds(&mut self) {
        let all = std::mem::take(&mut self.found.acting);
        let mut told: BTreeSet<(usize, usize)> = BTreeSet::new();
        let mut tell = |resolver: &mut Self, acting: &Acting<'g>, message: String, help: String| {
            if told.insert((acting.place.span.start, acting.place.span.end)) {
                resolver.report.warn_at(Code::PlaceNoBodyHolds, &acting.place, message).help(help);
            }
        };
        let mut rubbing = Vec::new();
        for acting in all {
            let shared = self.moved_twice(&acting);
            if !shared.is_empty() && self.differs(&acting) {
                let names = self.names_of(&shared);
                let message = format!(
                    "the components of this place depend on {names}, which its pose depends on, too: the force acts along the \
                     velocity of the place, not of the body's point that is there"
                );
                let help =
                    format!("{HELP}; where the place of a part moves so in the pose, declare the part's mass there");
                tell(self, &acting, message, help);
            } else if self.depends_on_velocities(&acting) {
                rubbing.push(acting);
            }
        }
        for acting in self.rubs_elsewhere(rubbing) {
            let message = "this force acts against the velocity of a body's point at this place, but its work is done along \
                           the velocity of the place, which is another: friction brings energy in";
            tell(self, &acting, message.to_string(), HELP.to_string());
        }
    }

    fn depends_on_velocities(&mut self, acting: &Acting<'g>) -> bool {
        let force = self.lagrangian.point_forces[acting.number].force;
        force.0.iter().any(|c| self.known.facts.dependence(*c).on(Dependence::VELOCITY))
    }

    /// The coordinates that move a place in its pose and the pose as well; none where a body moves with the place.
    fn moved_twice(&self, acting: &Acting<'g>) -> Vec<usize> {
        let Position::Of(_, frame) = acting.position else { return Vec::new() };
        let at = self.lagrangian.frames.get(frame);
        let (Some(Edge::Translation(shift)), Some(pose)) = (at.edge, at.parent) else { return Vec::new() };
        let own = self.coordinates_in(shift.0.to_vec());
        if own.is_empty() {
            return Vec::new();
        }
        let moved = self.coordinates_moving(pose);
        own.intersection(&moved).copied().collect()
    }

    /// The frame nearest to the world in which this one is fixed.
    fn fixed_in(&self, frame: FrameId) -> FrameId {
        let is_fixed = |edge: Edge<'g>| motions(&edge).into_iter().all(is_still);
        let up = |&frame: &FrameId| {
            let at = self.lagrangian.frames.get(frame);
            at.parent.filter(|_| at.edge.is_some_and(is_fixed))
        };
        std::iter::successors(Some(frame), up).last().unwrap_or(frame)
    }

    /// Whether a body rides on the pose, and it makes a difference to it that the place moves on, and nothing has its
    /// mass there.
    fn differs(&self, acting: &Acting<'g>) -> bool {
        let lagrangian = &self.lagrangian;
        let Position::Of(_, frame) = acting.position else { return false };
        let Some(pose) = lagrangian.frames.get(frame).parent else { return false };
        let bodies = lagrangian.bodies().0;
        let rides_along = |body: &Body<'g>| self.fixed_in(body.frame) == self.fixed_in(pose);
        if !bodies.iter().any(rides_along)
            || bodies.iter().any(|body| lagrangian.frames.nearest_common(body.frame, frame) == frame)
        {
            return false;
        }
        let centres = bodies.iter().flat_map(|body| world_position(lagrangian, Position::Of(body.com, body.frame)).0);
        let mut roots = forces_at(lagrangian, &[acting]);
        roots.extend(twist(lagrangian, pose));
        roots.extend(centres);
        let samples = Samples::new(lagrangian, &roots);
        let has_mass_there = (0..bodies.len()).any(|body| {
            let centre = |at: &Sample| vector(&at.moving, Force::NUMBERS + Twist::NUMBERS + 3 * body);
            let is_there = |at: &Sample| {
                let (centre, place) = (centre(at), Force::of(&at.moving, 0).place);
                norm(minus(centre, place)) <= 1e-9 * (norm(centre) + norm(place))
            };
            samples.0.iter().all(is_there)
        });
        let is_felt = |at: &Sample| {
            let force = Force::of(&at.moving, 0);
            let velocity = at.difference(|values| Force::of(values, 0).velocity);
            let of_body = at.difference(|values| Twist::of(values, Force::NUMBERS).velocity_at(force.place));
            let power = dot(force.force, minus(of_body, velocity));
            power.abs() > 1e-9 * norm(force.force) * (norm(of_body) + norm(velocity))
        };
        !has_mass_there && samples.0.iter().any(is_felt)
    }

    /// Those that rub against a body's point, and drive their place.
    fn rubs_elsewhere(&self, acting: Vec<Acting<'g>>) -> Vec<Acting<'g>> {
        let driving = self.driving(acting);
        if driving.is_empty() {
            return Vec::new();
        }
        let lagrangian = &self.lagrangian;
        let bodies = lagrangian.bodies().0;
        let is_rigid = |body: &&Body<'g>| body.inertia.is_some();
        let frames: BTreeSet<FrameId> = bodies.iter().filter(is_rigid).map(|body| body.frame).collect();
        let mut roots = forces_at(lagrangian, &driving.iter().collect::<Vec<_>>());
        let first = roots.len();
        roots.extend(frames.iter().flat_map(|frame| twist(lagrangian, *frame)));
        let samples = Samples::new(lagrangian, &roots);
        let rubs_on = |number: usize, frame: usize| {
            let start = first + frame * Twist::NUMBERS;
            let powers = samples.0.iter().map(|at| {
                let friction = at.difference(|values| Force::of(values, number).force);
                let place = Force::of(&at.moving, number).place;
                let of_body = at.difference(|values| Twist::of(values, start).velocity_at(place));
                let of_origin = at.difference(|values| Twist::of(values, start).velocity);
                let power = dot(friction, of_body);
                let is_none = power.abs() <= 1e-9 * norm(friction) * norm(of_body);
                (if is_none { 0.0 } else { power }, dot(friction, of_origin))
            });
            let powers: Vec<(f64, f64)> = powers.collect();
            let against = powers.iter().filter(|(power, _)| *power < 0.0).count();
            // Against the body's point there and no other of it, such as its origin.
            against >= STATES / 4
                && powers.iter().all(|(power, _)| *power <= 0.0)
                && powers.iter().any(|(_, of_origin)| *of_origin > 0.0)
        };
        let numbered = driving.into_iter().enumerate();
        numbered
            .filter(|(number, _)| (0..frames.len()).any(|f| rubs_on(*number, f)))
            .map(|(_, acting)| acting)
            .collect()
    }

    /// Those whose part that depends on the velocities drives its place somewhere; none where all such parts together
    /// never bring energy in.
    fn driving(&self, acting: Vec<Acting<'g>>) -> Vec<Acting<'g>> {
        let lagrangian = &self.lagrangian;
        if acting.is_empty() {
            return acting;
        }
        let mut roots = forces_at(lagrangian, &acting.iter().collect::<Vec<_>>());
        let first = roots.len();
        roots.extend(lagrangian.point_forces.iter().flat_map(|f| f.velocity.0.into_iter().chain(f.force.0)));
        let forces = roots.len();
        roots.extend(lagrangian.forces.iter().map(|(_, force)| *force));
        let samples = Samples::with_dissipation(lagrangian, &roots);
        let power_of_all = |at: &Sample| {
            let of_points = (first..forces).step_by(6).map(|start| {
                let [velocity, force] = [0, 3].map(|offset| at.difference(|values| vector(values, start + offset)));
                dot(velocity, force)
            });
            let rates = lagrangian.forces.iter().map(|(coordinate, _)| at.rates[*coordinate]);
            let of_coordinates = rates.zip(forces..).map(|(rate, i)| rate * (at.moving[i] - at.resting[i]));
            of_points.chain(of_coordinates).sum::<f64>() - at.dissipated
        };
        if !samples.0.iter().any(|at| power_of_all(at) > 0.0) {
            return Vec::new();
        }
        let drives = |number: usize| {
            let of = |at: &Sample| {
                let [velocity, force] = [
                    at.difference(|values| Force::of(values, number).velocity),
                    at.difference(|values| Force::of(values, number).force),
                ];
                dot(velocity, force) > 1e-9 * norm(velocity) * norm(force)
            };
            samples.0.iter().any(of)
        };
        let numbered = acting.into_iter().enumerate();
        numbered.filter(|(number, _)| drives(*number)).map(|(_, acting)| acting).collect()
    }
}

// ---- expressions

fn world_position<'g>(lagrangian: &Draft<'g>, position: Position<'g>) -> Vector<'g> {
    match position {
        Position::Of(coordinates, frame) => {
            let at = lagrangian.frames.get(frame);
            at.position + at.rotation * coordinates
        }
        Position::FromTheWorld(components, axes) => lagrangian.frames.get(axes).rotation * components,
    }
}

/// Of each its place, velocity and force, in world axes.
fn forces_at<'g>(lagrangian: &Draft<'g>, acting: &[&Acting<'g>]) -> Vec<Expr<'g>> {
    let of = |acting: &&Acting<'g>| {
        let force = lagrangian.point_forces[acting.number];
        let axes = lagrangian.frames.get(acting.axes).rotation;
        let place = world_position(lagrangian, acting.position);
        [place, axes * force.velocity, axes * force.force].into_iter().flat_map(|v| v.0).collect::<Vec<_>>()
    };
    acting.iter().flat_map(of).collect()
}

/// The origin of a frame, its velocity and the angular velocity, in world axes.
fn twist<'g>(lagrangian: &Draft<'g>, frame: FrameId) -> Vec<Expr<'g>> {
    let at = lagrangian.frames.get(frame);
    let vectors = [at.position, at.rotation * at.velocity, at.rotation * at.angular_velocity];
    vectors.into_iter().flat_map(|v| v.0).collect()
}

// ---- numbers

/// What [`forces_at`] gives of one force.
struct Force {
    place: [f64; 3],
    velocity: [f64; 3],
    force: [f64; 3],
}

impl Force {
    const NUMBERS: usize = 9;

    fn of(values: &[f64], number: usize) -> Self {
        let [place, velocity, force] = [0, 3, 6].map(|offset| vector(values, Self::NUMBERS * number + offset));
        Force { place, velocity, force }
    }
}

/// What [`twist`] gives.
struct Twist {
    origin: [f64; 3],
    velocity: [f64; 3],
    angular: [f64; 3],
}

impl Twist {
    const NUMBERS: usize = 9;

    fn of(values: &[f64], start: usize) -> Self {
        let [origin, velocity, angular] = [0, 3, 6].map(|offset| vector(values, start + offset));
        Twist { origin, velocity, angular }
    }

    fn velocity_at(&self, place: [f64; 3]) -> [f64; 3] {
        let arm = minus(place, self.origin);
        let [x, y, z] = self.angular;
        let turning = [y * arm[2] - z * arm[1], z * arm[0] - x * arm[2], x * arm[1] - y * arm[0]];
        [0, 1, 2].map(|i| self.velocity[i] + turning[i])
    }
}

fn vector(values: &[f64], start: usize) -> [f64; 3] {
    [0, 1, 2].map(|i| values[start + i])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Values at a state, and at rest in the same place.
struct Sample {
    rates: Vec<f64>,
    moving: Vec<f64>,
    resting: Vec<f64>,
    /// The power of the dissipation.
    dissipated: f64,
}

impl Sample {
    /// What comes of the motion of the coordinates.
    fn difference(&self, of: impl Fn(&[f64]) -> [f64; 3]) -> [f64; 3] {
        minus(of(&self.moving), of(&self.resting))
    }
}

/// At states where all is finite.
struct Samples(Vec<Sample>);

impl Samples {
    fn new(lagrangian: &Draft<'_>, roots: &[Expr<'_>]) -> Self {
        Self::of(lagrangian, roots, &[])
    }

    fn with_dissipation(lagrangian: &Draft<'_>, roots: &[Expr<'_>]) -> Self {
        Self::of(lagrangian, roots, &lagrangian.dissipation)
    }

    fn of(lagrangian: &Draft<'_>, roots: &[Expr<'_>], dissipation: &[Expr<'_>]) -> Self {
        let graph = Graph::new();
        let all: Vec<Expr<'_>> = roots.iter().chain(dissipation).copied().collect();
        let tape = Tape::new(&carry_out(&all, &graph, |symbol| along_the_motion(&graph, symbol)));
        let parameters = default_parameters(lagrangian);
        let attitudes = attitudes(lagrangian);
        let mut random = Random::new(0x736c_6964);
        let sample = |_| {
            let mut state = random.state(lagrangian);
            // Slow and fast: a small body's rim is slow where it does not turn fast.
            state.qd.iter_mut().for_each(|rate| *rate *= 10f64.powf(2.0 * random.symmetric()));
            attitudes.iter().for_each(|numbers| make_unit(&mut state, *numbers));
            let at_rest = State { qd: vec![0.0; state.qd.len()], ..state.clone() };
            let [moving, resting] =
                [&state, &at_rest].map(|state| tape.run(|symbol| value(state, &parameters, symbol)));
            let (moving, of_dissipation) = moving.split_at(roots.len());
            let dissipated = of_dissipation.iter().map(|d| d.derivative).sum();
            let values = |all: &[Dual<f64>]| all.iter().map(|v| v.value).collect::<Vec<f64>>();
            let (moving, resting) = (values(moving), values(&resting[..roots.len()]));
            let is_finite = moving.iter().chain(&resting).all(|v| v.is_finite()) && f64::is_finite(dissipated);
            is_finite.then_some(Sample { rates: state.qd, moving, resting, dissipated })
        };
        Samples((0..STATES).filter_map(sample).collect())
    }
}

/// A symbol's value, which grows with the velocities in proportion.
fn value(state: &State, parameters: &[f64], symbol: Symbol) -> Dual<f64> {
    let number = |of: &[f64], i: u32| of.get(i as usize).copied().unwrap_or(0.0);
    match symbol {
        Symbol::Time => Dual::fixed(state.t),
        Symbol::Coordinate(i) => Dual::fixed(number(&state.q, i)),
        Symbol::Velocity(i) => Dual::new(number(&state.qd, i), number(&state.qd, i)),
        Symbol::Parameter(i) => Dual::fixed(number(parameters, i)),
        Symbol::Input(i) => Dual::fixed(number(&state.u, i)),
        Symbol::Prescribed(i, order @ 0..=2) => Dual::fixed(state.prescribed[i as usize][usize::from(order)]),
        Symbol::Prescribed(..) | Symbol::Acceleration(_) | Symbol::Multiplier(_) => Dual::fixed(0.0),
    }
}

/// Quaternions that are coordinates, by their numbers.
fn attitudes(lagrangian: &Draft<'_>) -> BTreeSet<[usize; 4]> {
    let number = |e: Expr<'_>| match e.node() {
        Node::Symbol(Symbol::Coordinate(i)) => Some(i as usize),
        _ => None,
    };
    let quaternion = |edge: Edge<'_>| match edge {
        Edge::Quaternion([w, x, y, z]) => Some([number(w)?, number(x)?, number(y)?, number(z)?]),
        Edge::Rotation { .. } | Edge::Translation(_) => None,
    };
    let found = lagrangian.frames.iter().filter_map(|frame| quaternion(frame.edge?));
    found.filter(|numbers| numbers.iter().all(|i| *i < lagrangian.dof())).collect()
}

/// Length 1, which does not change.
fn make_unit(state: &mut State, numbers: [usize; 4]) {
    let length = numbers.iter().map(|&i| state.q[i].powi(2)).sum::<f64>().sqrt();
    numbers.iter().for_each(|&i| state.q[i] /= length);
    let along = numbers.iter().map(|&i| state.q[i] * state.qd[i]).sum::<f64>();
    numbers.iter().for_each(|&i| state.qd[i] -= along * state.q[i]);
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::refusals;

    const BALL: &str = "const c: N*s/m = 2; const i: kg*m^2 = 1; const r: m = 0.1; let arm = [0, 0, -r];
        let b = translation([x, 0, r])*rot_y(theta); kinetic += rigid_body(m, [0, 0, 0], diag(i, i, i), b);
        let slip = dt(b.origin()) + angular_velocity(b).cross(arm);";
    const MOVES_ON: &str = "the components of this place depend on `theta`, which its pose depends on, too";
    const DRIVES: &str = "this force acts against the velocity of a body's point at this place, but its work is done";

    #[track_caller]
    fn warned(statements: &str, place: &str, message: &str) {
        let all = refusals(&format!("{BALL} {statements}"));
        assert!(all.len() == 1 && all[0].starts_with(&format!("{place}: {message}")), "{statements}: {all:?}");
    }

    #[track_caller]
    fn accepted(statements: &str) {
        assert_eq!(refusals(&format!("{BALL} {statements}")), [""; 0], "{statements}");
    }

    #[test]
    fn a_place_that_moves_on_over_the_body() {
        let place = "b.point([r*sin(theta), 0, -r*cos(theta)])";
        warned(&format!("force at {place} += -c*slip;"), place, MOVES_ON);
        warned(&format!("force at {place} += [u, 0, 0];"), place, MOVES_ON);
        warned(&format!("let p = {place}; force at p += [u, 0, 0];"), "p", MOVES_ON);
        warned("force at b.point([r*theta, 0, 0]) += [0, 0, u];", "b.point([r*theta, 0, 0])", MOVES_ON);
        // The normal force does no work either way.
        accepted(&format!("force at {place} += [0, 0, u];"));
        // A mass is there, or a place that a motion of its own moves, or time.
        let slider = "b.point([r*theta, 0, 0])";
        accepted(&format!("kinetic += particle(m, {slider}); force at {slider} += [0, 0, u];"));
        let cart = "let cart = b*translation([r*theta, 0, 0]);";
        accepted(&format!(
            "{cart} kinetic += rigid_body(m, [r, 0, 0], diag(i, i, i), cart*rot_y(y/r)); force at cart.origin() += [0, 0, u];"
        ));
        accepted("force at b.point([y, 0, -l]) += [u, 0, 0];");
        // The pose is geometry alone.
        accepted("let f = rot_y(theta/2); force at f.point([l*cos(theta/2), 0, 0]) += [u, 0, 0];");
        accepted("let f = translation([x/3, 0, 0]); force at f.point([x/3, 0, 0]) += [u, 0, 0];");
        accepted("force at b.point([l*sin(2*pi*t/(1 s)), 0, 0]) += [0, 0, u];");
    }

    #[test]
    fn friction_that_drives_its_place() {
        for place in ["[x, 0, 0]", "b.origin() + arm", "[x, y, 0]"] {
            warned(&format!("force at {place} += -c*slip;"), place, DRIVES);
        }
        warned(
            "const n: N = 3; const s: m/s = 0.1; force at [x, 0, 0] += -n*slip/sqrt(slip.norm_squared() + s^2);",
            "[x, 0, 0]",
            DRIVES,
        );
        // Where the frame does not spin.
        let frame = "let f = translation([x, 0, r]);";
        warned(&format!("{frame} force at f.point(arm) += -c*slip;"), "f.point(arm)", DRIVES);
    }

    #[test]
    fn the_right_forms_of_friction() {
        accepted("dissipation += 1/2*c*slip.norm_squared();");
        accepted("force at b.origin() += -c*slip; torque on b += arm.cross(-c*slip);");
        // The moment of the force about the axle, as of a tyre.
        accepted("force at [x, 0, 0] += -c*slip; force theta += c*r*slip.x;");
        accepted("force at b.point(arm) += -c*dt(b.point(arm));");
    }

    #[test]
    fn other_forces_that_depend_on_velocities() {
        accepted("force at [x, y, z] += -c*dt([x, y, z]);");
        // A damper between two places, control by the velocity of another place, lift of what spins.
        accepted("let v = dt(x) - dt(y); force at [x, 0, 0] += [-c*v, 0, 0]; force at [0, y, 0] += [0, c*v, 0];");
        accepted("force at [x + l*sin(q[0]), 0, -l*cos(q[0])] += [-c*dt(x), 0, 0];");
        accepted("force at b.origin() += 1 kg*angular_velocity(b).cross(dt(b.origin()));");
    }
}
