//! Places that are counted from another origin than was probably meant: mass centres in room coordinates, vectors in
//! the axes of a pose that stand for a place in it, arms of torques from the origin of the world.

use std::collections::BTreeSet;

use crate::diagnostic::Code;
use crate::model::frame::{Edge, FrameId};
use crate::model::value::constant::Dependence;
use crate::model::value::evaluate::{Argument, Resolved, Resolver};

use crate::expr::{Expr, Node, Symbol, Vector};
use crate::model::value::{Free, Value};
use crate::parse::syntax::{Expression, ExpressionKind, Span};
use crate::variable::component_names;

// ---- mass centres

impl<'g> Resolver<'_, 'g> {
    /// A mass centre is counted in the axes of its pose. One that moves with the coordinates that move the pose itself
    /// is a place in the room: the pose would move it once more.
    pub(in crate::model) fn check_mass_centre(&mut self, com: Vector<'g>, frame: FrameId, span: &Span) -> Resolved<()> {
        if !com.0.iter().any(|c| self.known.facts.dependence(*c).on(Dependence::COORDINATE)) {
            return Ok(());
        }
        let path = self.lagrangian.frames.path(frame);
        let own = self.coordinates_in(com.0.to_vec());
        let moved = self.coordinates_in(path.iter().flat_map(motions).collect());
        let shared: Vec<usize> = own.intersection(&moved).copied().collect();
        if shared.is_empty() {
            self.warn_of_room_coordinates(com, &path, span);
            return Ok(());
        }
        let names = self.names_of(&shared);
        let message =
            format!("this mass centre depends on {names}, which the pose depends on, too: it would be moved twice");
        let help = "a mass centre is written in the axes of its pose, such as `[0, 0, -l]`; where it moves in them, move the \
                    pose: `rigid_body(m, [0, 0, 0], i, pose * translation([…]))`";
        Err(self.refuse(Code::MovedTwice, span, message, help))
    }

    /// The inertia of a body is constant in the axes of its pose; in those of the room it turns with the pose.
    pub(in crate::model) fn check_axes_of_inertia(
        &mut self,
        entries: &[Expr<'g>],
        frame: FrameId,
        span: &Span,
    ) -> Resolved<()> {
        if !entries.iter().any(|e| self.known.facts.dependence(*e).on(Dependence::COORDINATE)) {
            return Ok(());
        }
        let moved = self.coordinates_moving(frame);
        let own = self.coordinates_in(entries.to_vec());
        let shared: Vec<usize> = own.intersection(&moved).copied().collect();
        if shared.is_empty() {
            return Ok(());
        }
        let message =
            format!("this inertia depends on {}, as the pose does: it would be turned twice", self.names_of(&shared));
        let help =
            "an inertia is written in the axes of its pose, in which it is constant: `inertia(xx, yy, zz, xy, xz, yz)`";
        Err(self.refuse(Code::MovedTwice, span, message, help))
    }

    /// Two coordinates that are components of the mass centre in a pose that only turns: a pose that was forgotten to
    /// be shifted?
    fn warn_of_room_coordinates(&mut self, com: Vector<'g>, path: &[Edge<'g>], span: &Span) {
        let is_coordinate = |c: &Expr<'g>| match c.node() {
            Node::Symbol(Symbol::Coordinate(i)) => Some(i as usize),
            _ => None,
        };
        let coordinates: BTreeSet<usize> = com.0.iter().filter_map(is_coordinate).collect();
        let turns = path.iter().any(|edge| {
            let motion = motions(edge);
            motion.iter().any(|e| self.known.facts.dependence(*e).on(Dependence::COORDINATE))
        });
        let shifts = path.iter().any(|edge| matches!(edge, Edge::Translation(_)));
        if coordinates.len() < 2 || !turns || shifts {
            return;
        }
        let names = self.names_of(&coordinates.into_iter().collect::<Vec<_>>());
        let message = format!("this mass centre moves by {names} in the axes of its pose, which turn");
        let help = "where these are coordinates of the room, write `translation([x, y, z]) * pose` and the mass centre in the \
                    axes of the pose; where they are meant so, `pose * translation([x, y, z])`";
        self.warn_once(Code::MassCentreOfTheRoom, span, message, help);
    }

    /// The coordinates, not auxiliary ones of joints, that some expressions depend on.
    pub(in crate::model) fn coordinates_in(&self, exprs: Vec<Expr<'g>>) -> BTreeSet<usize> {
        let own = self.lagrangian.dof();
        let reachable = self.graph.reachable(exprs.into_iter().map(|e| e.id())).into_iter();
        let number = |id| match self.graph.node(id) {
            Node::Symbol(Symbol::Coordinate(i)) => Some(i as usize),
            _ => None,
        };
        reachable.filter_map(number).filter(|i| *i < own).collect()
    }

    /// The coordinates that move a frame.
    pub(in crate::model) fn coordinates_moving(&self, frame: FrameId) -> BTreeSet<usize> {
        self.coordinates_in(self.lagrangian.frames.path(frame).iter().flat_map(motions).collect())
    }

    /// "`x` and `q_0`"
    pub(in crate::model) fn names_of(&self, coordinates: &[usize]) -> String {
        let names = component_names(&self.lagrangian.coordinates);
        let quoted: Vec<String> =
            coordinates.iter().filter_map(|&i| names.get(i)).map(|name| format!("`{name}`")).collect();
        match quoted.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, before)) => format!("{} and {last}", before.join(", ")),
            None => String::new(),
        }
    }

    /// What is probably not meant, once for each place.
    fn warn_once(&mut self, code: Code, span: &Span, message: String, help: &str) {
        let (place, calls) = self.report.place(span);
        if self.report.has_said(&place, &message) {
            return;
        }
        let warning = self.report.errors.warning(code, place, message).help(help);
        for (call, what) in calls {
            warning.note(call, what);
        }
    }
}

/// What an edge moves by.
pub(super) fn motions<'g>(edge: &Edge<'g>) -> Vec<Expr<'g>> {
    match edge {
        Edge::Rotation { angle, .. } => vec![*angle],
        Edge::Quaternion(q) => q.to_vec(),
        Edge::Translation(t) => t.0.to_vec(),
    }
}

// ---- vectors and points

impl<'g> Resolver<'_, 'g> {
    /// `pose * v` is a vector, which does not know where the pose stands: as a place it is counted from the origin of
    /// the world.
    pub(in crate::model) fn warn_of_a_vector_for_a_place(&mut self, place: &Argument<'g>) {
        let Value::Vector(Free { frame, components, .. }) = place.value else { return };
        if components.0.iter().all(|c| c.is_zero()) || !self.is_shifted(frame) {
            return;
        }
        let message = "this is a vector in the axes of a pose: as a place it is counted from the origin of the world, not from \
                       that of the pose";
        let help = "the place with these components in the pose is `pose.point([x, y, z])`; where the origin of the world is \
                    meant, write `translation(v).origin()`";
        self.warn_once(Code::VectorForAPlace, &place.span, message.to_string(), help);
    }

    /// The moment of a force about the origin of the world is not its moment about that of a pose.
    pub(in crate::model) fn warn_of_an_arm(&mut self, pose: &Argument<'g>, torque: &Expression) {
        let Ok(frame) = self.frame(pose) else { return };
        if !self.is_shifted(frame) {
            return;
        }
        for part in torque.parts() {
            let arm = match &part.kind {
                ExpressionKind::Method(arm, name, _) if name.text == "cross" => &**arm,
                ExpressionKind::Call(name, arguments) if name.text == "cross" && arguments.len() == 2 => &arguments[0],
                _ => continue,
            };
            let Ok(Argument { value: Value::Point(_), span }) = self.argument(arm) else { continue };
            let message = "this arm is a place, counted from the origin of the world, not from that of the pose";
            let help = "write `force at point += F;`, which turns the body as well, or the arm from the pose: \
                        `(point - pose.origin()).cross(F)`";
            self.warn_once(Code::VectorForAPlace, &span, message.to_string(), help);
        }
    }

    fn is_shifted(&self, frame: FrameId) -> bool {
        frame != FrameId::WORLD && self.lagrangian.frames.get(frame).position.0.iter().any(|p| !p.is_zero())
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::refusals;

    const BODY: &str = "let b = translation([x, 0, 0])*rot_y(theta); let i = diag(1, 1, 1)*m*l^2;";

    fn found(statements: &str) -> Vec<String> {
        refusals(&format!("{BODY} {statements}"))
    }

    #[track_caller]
    fn accepted(statements: &str) {
        assert_eq!(found(statements), [""; 0], "{statements}");
    }

    #[test]
    fn mass_centres_in_room_coordinates_are_refused() {
        let help = "a mass centre is written in the axes of its pose, such as `[0, 0, -l]`; where it moves in them, move the \
                    pose: `rigid_body(m, [0, 0, 0], i, pose * translation([…]))`";
        let check = |statements: &str, place: &str, names: &str| {
            let message =
                format!("this mass centre depends on {names}, which the pose depends on, too: it would be moved twice");
            assert_eq!(found(statements), [format!("{place}: {message}; {help}")], "{statements}");
        };
        let room = "[x - l*sin(theta), 0, -l*cos(theta)]";
        check(&format!("kinetic += rigid_body(m, {room}, i, b);"), room, "`x` and `theta`");
        check(&format!("let c = {room}; kinetic += rigid_body(m, c, i, b);"), "c", "`x` and `theta`");
        check(
            "let c = b.point([0, 0, -l]); kinetic += rigid_body(m, [c.x, c.y, c.z], i, b);",
            "[c.x, c.y, c.z]",
            "`x` and `theta`",
        );
        check(
            "kinetic += rigid_body(m, [x, 0, 0] + b*[0, 0, -l], i, b);",
            "[x, 0, 0] + b*[0, 0, -l]",
            "`x` and `theta`",
        );
        check("kinetic += rigid_body(m, [x, 0, 0], i, translation([x, 0, 0]));", "[x, 0, 0]", "`x`");
        check(
            "kinetic += rigid_body(m, [0, 0, -l*cos(q[1])], i, rot_y(theta)*rot_x(q[1]));",
            "[0, 0, -l*cos(q[1])]",
            "`q_1`",
        );
        let shown = "fn body(c, p) = rigid_body(m, c, diag(1, 1, 1)*m*l^2, p);";
        assert!(found(&format!("{shown} kinetic += body({room}, b);"))[0].contains("moved twice"));
    }

    #[test]
    fn inertias_in_room_axes_are_refused() {
        let turned = "[[i[0][0]*cos(theta)^2 + i[2][2]*sin(theta)^2, 0, 0], [0, i[1][1], 0], [0, 0, i[0][0]]]";
        let all = found(&format!("kinetic += rigid_body(m, [0, 0, -l], {turned}, b);"));
        assert!(all.len() == 1 && all[0].contains("this inertia depends on `theta`, as the pose does"), "{all:?}");
        accepted("kinetic += rigid_body(m, [0, 0, -l], b*i, b);");
    }

    #[test]
    fn mass_centres_that_move_in_their_pose_are_not() {
        accepted("kinetic += rigid_body(m, [0, 0, -l], i, b);");
        accepted("kinetic += rigid_body(m, b.point([0, 0, -l]), i, b) + rigid_body(m, b*[0, 0, -l], i, b);");
        // A point of the pose: its components there are constant.
        accepted("kinetic += rigid_body(m, b.origin() + b*[0, 0, -l], i, b);");
        // A slider on the arm, a wheel out of balance, a mass that time moves on a base that it moves, too.
        accepted("kinetic += rigid_body(m, [y, 0, 0], i, b);");
        accepted("kinetic += rigid_body(m, [l*cos(q[0]), 0, l*sin(q[0])], i, b);");
        accepted(
            "kinetic += rigid_body(m, [l*cos(t/t*x/x), 0, 0], i, translation([l*sin(t/t), 0, 0]));"
                .replace("*x/x", "")
                .as_str(),
        );
        accepted("kinetic += rigid_body(m, [x, y, z], i, world);");
        accepted("kinetic += rigid_body(m, [x, y, z], i, rot_y(pi/3));");
    }

    #[test]
    fn poses_that_were_not_shifted_earn_a_warning() {
        let help = "where these are coordinates of the room, write `translation([x, y, z]) * pose` and the mass centre in the \
                    axes of the pose; where they are meant so, `pose * translation([x, y, z])`";
        let message = "this mass centre moves by `x`, `y` and `z` in the axes of its pose, which turn";
        assert_eq!(
            found("kinetic += rigid_body(m, [x, y, z], i, rot_y(theta));"),
            [format!("[x, y, z]: {message}; {help}")]
        );
        accepted("kinetic += rigid_body(m, [0, 0, 0], i, translation([x, y, z])*rot_y(theta));");
        accepted("kinetic += rigid_body(m, [0, 0, 0], i, rot_y(theta)*translation([x, y, z]));");
        accepted("kinetic += rigid_body(m, [y, 0, 0], i, rot_y(theta));");
    }

    #[test]
    fn vectors_for_places_earn_a_warning() {
        let help = "the place with these components in the pose is `pose.point([x, y, z])`; where the origin of the world is \
                    meant, write `translation(v).origin()`";
        let message = "this is a vector in the axes of a pose: as a place it is counted from the origin of the world, not from \
                       that of the pose";
        let check = |statements: &str, place: &str| {
            assert_eq!(found(statements), [format!("{place}: {message}; {help}")], "{statements}");
        };
        check("kinetic += particle(m, b*[0, 0, -l]);", "b*[0, 0, -l]");
        check("let r = l*(b*[0, 0, -1]); kinetic += particle(m, r/2);", "r/2");
        check("force at b*[0, 0, -l] += [u, 0, 0];", "b*[0, 0, -l]");
        check("constraint c: b.point([l, 0, 0]) = b*[0, 0, l];", "b*[0, 0, l]");
        check("for i in 0..2 { kinetic += particle(m, (b*rot_x(q[i]))*[0, 0, -l]); }", "(b*rot_x(q[i]))*[0, 0, -l]");
        accepted("kinetic += particle(m, b.point([0, 0, -l])) + particle(m, b.origin() + b*[0, 0, -l]);");
        accepted("kinetic += particle(m, rot_y(theta)*[0, 0, -l]); force at rot_y(theta)*[0, 0, -l] += [u, 0, 0];");
        accepted("kinetic += particle(m, translation(b*[0, 0, -l]).origin());");
        accepted("kinetic += particle(m, [x, 0, 0] + b*[0, 0, -l]); output v = b*[0, 0, -l];");
        accepted("force at b.point([0, 0, -l]) += b*[0, 0, u]; torque on b += b*[0, u*l, 0];");
    }

    #[test]
    fn arms_from_the_origin_of_the_world_earn_a_warning() {
        let found_arm = |statements: &str, place: &str| {
            let all = found(statements);
            assert!(all.len() == 1 && all[0].starts_with(&format!("{place}: this arm is a place")), "{all:?}");
        };
        found_arm("torque on b += b.point([0, 0, l]).cross([u, 0, 0]);", "b.point([0, 0, l])");
        found_arm("let p = b.point([0, 0, l]); torque on b += -cross(p, [u, 0, 0]);", "p");
        accepted("torque on b += (b.point([0, 0, l]) - b.origin()).cross([u, 0, 0]);");
        accepted("torque on b += (b*[0, 0, l]).cross([u, 0, 0]);");
        accepted("let a = rot_y(theta); torque on a += a.point([0, 0, l]).cross([u, 0, 0]);");
    }
}
