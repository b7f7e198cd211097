//! `force at …` and `torque on …`: kept with the velocity that they do work on, and generalized by `derive`.

use crate::diagnostic::Code;
use crate::expr::{Matrix, Vector};
use crate::model::check::contact::{Acting, Position};
use crate::model::frame::FrameId;
use crate::model::lagrangian::{Application, PointForce};
use crate::model::landmark::Motion;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::{Free, Point, Value};
use crate::parse::syntax::{Expression, Span};

impl<'d, 'g> Resolver<'d, 'g> {
    /// `force at point += value;`
    pub(in crate::model) fn force_at(&mut self, point: &Expression, value: &Expression) -> Resolved<()> {
        let (found, force) = (self.velocity_at(point), self.argument(value));
        let newton = Dimension::ENERGY.over(Dimension::LENGTH).unwrap_or(Dimension::ONE);
        let number = self.lagrangian.point_forces.len();
        self.does_work(found.map(|(velocity, _)| velocity), force, "a force", newton)?;
        if let Ok((velocity, position)) = found {
            let place = self.report.here(&point.span);
            self.found.acting.push(Acting { number, axes: velocity.frame, position, place });
        }
        Ok(())
    }

    /// `torque on pose += value;`
    pub(in crate::model) fn torque_on(&mut self, pose: &Expression, value: &Expression) -> Resolved<()> {
        let pose = self.argument(pose);
        let velocity = pose.clone().and_then(|pose| self.angular_velocity_of(&pose));
        let torque = self.argument(value);
        if let (Ok(pose), Ok(_)) = (pose, &torque) {
            self.warn_of_an_arm(&pose, value);
        }
        self.does_work(velocity, torque, "a torque", Dimension::ENERGY)
    }

    fn angular_velocity_of(&mut self, pose: &Argument<'g>) -> Resolved<Free<'g>> {
        let frame = self.frame(pose)?;
        let components = self.lagrangian.frames.get(frame).angular_velocity;
        let tensor = Matrix::identity(self.graph);
        self.lagrangian.landmarks.note_motion(components, Motion::Turning { tensor, frame });
        if !self.is_moved(&components) && !self.may_be_released() {
            let message = "no coordinate turns this pose: a torque does no work here";
            return Err(self.refuse(Code::NoWork, &pose.span, message, "leave the torque out"));
        }
        Ok(Free { components, frame, dimension: Dimension::ANGULAR_VELOCITY })
    }

    fn is_moved(&mut self, rate: &Vector<'g>) -> bool {
        rate.0.iter().any(|c| self.known.facts.dependence(*c).on(Dependence::VELOCITY))
    }

    /// The velocity of a place, and the place.
    fn velocity_at(&mut self, point: &Expression) -> Resolved<(Free<'g>, Position<'g>)> {
        let place = self.argument(point)?;
        let span = point.span.clone();
        if !matches!(place.value, Value::Point(_)) {
            let vector = self.vector(&place)?;
            self.check_dimension(vector.fit(), "the place that a force acts at", Dimension::LENGTH, &span)?;
            self.warn_of_a_vector_for_a_place(&place);
        }
        let (rate, position) = match &place.value {
            Value::Point(Point { coordinates, frame }) => (self.rate(&place)?, Position::Of(*coordinates, *frame)),
            _ => {
                let vector = self.vector(&place)?;
                let rate = self.rate(&Argument { value: Value::Vector(vector), span: span.clone() })?;
                (rate, Position::FromTheWorld(vector.components, vector.frame))
            }
        };
        self.check_moved(&rate, &span)?;
        Ok((self.vector(&Argument { value: rate, span })?, position))
    }

    /// A force on what no coordinate moves does nothing.
    fn check_moved(&mut self, rate: &Value<'g>, span: &Span) -> Resolved<()> {
        let Free { components, .. } = self.vector(&Argument { value: rate.clone(), span: span.clone() })?;
        if self.is_moved(&components) || self.may_be_released() {
            return Ok(());
        }
        Err(self.refuse(
            Code::NoWork,
            span,
            "no coordinate moves this point: a force does no work here",
            "leave the force out",
        ))
    }

    fn does_work(
        &mut self,
        velocity: Resolved<Free<'g>>,
        value: Resolved<Argument<'g>>,
        what: &str,
        wanted: Dimension,
    ) -> Resolved<()> {
        let value = value?;
        let force = self.vector(&value)?;
        self.check_dimension(force.fit(), what, wanted, &value.span)?;
        let Free { components: velocity, frame, .. } = velocity?;
        let application = self.application(velocity, &force);
        // A force is turned, not the velocity, which depends on more.
        let force = self.in_axes(force, frame);
        self.lagrangian.point_forces.push(PointForce { velocity, force, application });
        Ok(())
    }

    /// What moves at this velocity, and the force in axes that need no further turn.
    fn application(&mut self, velocity: Vector<'g>, force: &Free<'g>) -> Option<Application<'g>> {
        let (frame, point) = match self.lagrangian.landmarks.motion(velocity)? {
            Motion::Velocity { factor, coordinates, frame } => factor.is_one().then_some((frame, Some(coordinates)))?,
            Motion::Turning { tensor, frame } => (tensor == Matrix::identity(self.graph)).then_some((frame, None))?,
        };
        let is_in_world = self.same_axes(force.frame, FrameId::WORLD);
        let vector = if is_in_world { force.components } else { self.in_axes(*force, frame) };
        Some(Application { frame, point, vector, is_in_world })
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol, carry_out, evaluate, gradient_of_combination};
    use crate::model::check::trial::{at, mechanism, near, refused};

    /// The generalized forces of points and torques at the trial state.
    fn generalized(statements: &str) -> Vec<f64> {
        mechanism(statements, |lagrangian| {
            let graph = Graph::new();
            let along = |symbol| match symbol {
                Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
                Symbol::Time => Some(graph.integer(1)),
                _ => None,
            };
            let all = |vectors: Vec<crate::expr::Vector<'_>>| {
                carry_out(&vectors.iter().flat_map(|v| v.0).collect::<Vec<_>>(), &graph, along)
            };
            let velocities = all(lagrangian.point_forces.iter().map(|f| f.velocity).collect());
            let forces = all(lagrangian.point_forces.iter().map(|f| f.force).collect());
            let pairs: Vec<_> = velocities.into_iter().zip(forces).collect();
            let qd: Vec<Symbol> = (0..6).map(Symbol::Velocity).collect();
            evaluate(&gradient_of_combination(&pairs, &qd), at)
        })
    }

    fn equal(statements: &str, expected: [f64; 6]) {
        near(&generalized(statements), &expected, statements);
    }

    #[test]
    fn forces_do_virtual_work() {
        let (s, c) = 0.4f64.sin_cos();
        // u = 1.5 N, l = 3 m
        equal("force at [x, y, z] += [u, 2*u, 0];", [1.5, 3.0, 0.0, 0.0, 0.0, 0.0]);
        let arm = "let a = translation([x, 0, 0]) * rot_z(theta); let tip = a.point([l, 0, 0]);";
        // The tip moves by (1, 0) with x and by l (−sin θ, cos θ) with θ.
        equal(&format!("{arm} force at tip += [u, 2*u, 0];"), [1.5, 0.0, 0.0, 3.0 * (-s * 1.5 + c * 3.0), 0.0, 0.0]);
        // Along the arm.
        equal(&format!("{arm} force at tip += a * [u, 0, 0];"), [1.5 * c, 0.0, 0.0, 0.0, 0.0, 0.0]);
        equal(&format!("{arm} force at tip += a * [0, u, 0];"), [-1.5 * s, 0.0, 0.0, 4.5, 0.0, 0.0]);
        equal(&format!("{arm} force at [tip.x, tip.y, 0] += a * [0, u, 0];"), [-1.5 * s, 0.0, 0.0, 4.5, 0.0, 0.0]);
        // A place that moves with time is no coordinate: only what q̇ moves counts.
        equal(
            "force at [x + l*t*u/(u*t), 0, 0] + [0*x, t*l/(l/l*t), 0]*0 += [u, 0, 0];"
                .replace("l*t*u/(u*t)", "l*t/t")
                .as_str(),
            [1.5, 0.0, 0.0, 0.0, 0.0, 0.0],
        );
        // Two forces, opposite and equal: a spring between two points.
        equal(
            "let f = [k*(x - y), 0, 0]; force at [x, 0, 0] += -f; force at [y, 0, 0] += f;",
            [-5.0, 5.0, 0.0, 0.0, 0.0, 0.0],
        );
    }

    #[test]
    fn torques_do_virtual_work() {
        let (s, c) = 0.4f64.sin_cos();
        equal("torque on rot_z(theta) += [0, 0, u*l];", [0.0, 0.0, 0.0, 4.5, 0.0, 0.0]);
        let two = "let a = rot_z(theta) * rot_x(q[0]);";
        equal(&format!("{two} torque on a += [u*l, 0, 0];"), [0.0, 0.0, 0.0, 0.0, 4.5 * c, 0.0]);
        equal(&format!("{two} torque on a += [0, u*l, 0];"), [0.0, 0.0, 0.0, 0.0, 4.5 * s, 0.0]);
        equal(&format!("{two} torque on a += a * [u*l, 0, 0];"), [0.0, 0.0, 0.0, 0.0, 4.5, 0.0]);
    }

    #[test]
    fn wrong_forces() {
        refused("force at [x, y, z] += [m, 0, 0];", "[m, 0, 0]: a force must be kg·m/s², this is kg");
        refused("force at [x, y, z] += u;", "u: expected a vector, found a number; a vector is written `[x, y, z]`");
        refused("force at x += [u, 0, 0];", "x: expected a vector, found a number; a vector is written `[x, y, z]`");
        refused(
            "force at [theta, 0, 0] += [u, 0, 0];",
            "[theta, 0, 0]: the place that a force acts at must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        refused(
            "force at rot_z(theta) += [u, 0, 0];",
            "rot_z(theta): expected a vector, found a pose; the place of a pose is `pose.origin()`",
        );
        refused(
            "force at world.origin() += [u, 0, 0];",
            "world.origin(): no coordinate moves this point: a force does no work here; leave the force out",
        );
        refused(
            "torque on translation([x, 0, 0]) += [0, 0, u*l];",
            "translation([x, 0, 0]): no coordinate turns this pose: a torque does no work here; leave the torque out",
        );
        refused("torque on rot_z(theta) += [0, 0, u];", "[0, 0, u]: a torque must be kg·m²/s², this is kg·m/s²");
        refused(
            "torque on theta += [0, 0, u*l];",
            "theta: expected a pose, found a number; poses are made by `rot_z(angle)`, `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
        );
    }
}
