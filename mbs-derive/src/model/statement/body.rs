//! `particle` and `rigid_body`: bodies with their kinetic energies.

use crate::diagnostic::Code;
use crate::expr::{Expr, Matrix, Vector, Verdict, vanishes};
use crate::model::check::Physical;
use crate::model::frame::{Edge, FrameId};
use crate::model::lagrangian::Body;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::{Free, Point, Pose, Scalar, Tensor, Value};
use crate::parse::syntax::Span;

impl<'d, 'g> Resolver<'d, 'g> {
    /// `½ m |ṙ|²`
    pub(in crate::model) fn particle(&mut self, mass: &Argument<'g>, position: &Argument<'g>) -> Resolved<Value<'g>> {
        let m = self.mass(mass);
        let place = match position.value {
            Value::Point(point) => Ok(point),
            _ => {
                self.warn_of_a_vector_for_a_place(position);
                self.vector(position).and_then(|vector| self.tip_of(vector, &position.span))
            }
        };
        let (m, Point { coordinates, frame }) = (m?, place?);
        self.found.physical.push(Physical { mass: m, mass_place: self.report.here(&mass.span), inertia: None });
        Ok(self.energy_of(Body { mass: m, com: coordinates, inertia: None, frame }))
    }

    /// The place at the tip of a vector from the world's origin: of a frame there, turned as the vector's axes are.
    fn tip_of(&mut self, vector: Free<'g>, span: &Span) -> Resolved<Point<'g>> {
        self.check_dimension(vector.fit(), "the place of a particle", Dimension::LENGTH, span)?;
        for component in vector.components.0 {
            self.rate_of(component, span)?;
        }
        let mut edges = self.lagrangian.frames.path(vector.frame);
        edges.retain(|edge| !matches!(edge, Edge::Translation(_)));
        let frame = self.attached(&Pose { base: FrameId::WORLD, edges }, span)?;
        self.point_at(vector.components, frame, span)
    }

    fn energy_of(&mut self, body: Body<'g>) -> Value<'g> {
        let energy = self.lagrangian.declared_energy_of(&body);
        self.found.weights.bodies.insert(energy.id(), body);
        Value::Scalar(Scalar::new(energy, self.dimension(Dimension::ENERGY)))
    }

    /// `½ m |v_c|² + ½ ωᵀ I ω`
    pub(in crate::model) fn rigid_body(
        &mut self,
        mass: &Argument<'g>,
        com: &Argument<'g>,
        inertia: &Argument<'g>,
        pose: &Argument<'g>,
    ) -> Resolved<Value<'g>> {
        let m = self.mass(mass);
        let frame = self.frame(pose);
        let tensor = self.inertia(inertia, frame);
        let (m, tensor, frame) = (m?, tensor?, frame?);
        let Free { components, .. } = self.mass_centre(com, frame)?;
        let physical = Physical {
            mass: m,
            mass_place: self.report.here(&mass.span),
            inertia: Some((tensor, self.report.here(&inertia.span))),
        };
        self.found.physical.push(physical);
        let (com, frame) = self.fixed(components, frame, &com.span)?;
        Ok(self.energy_of(Body { mass: m, com, inertia: Some(tensor), frame }))
    }

    fn mass(&mut self, argument: &Argument<'g>) -> Resolved<Expr<'g>> {
        let mass = self.of_dimension(argument, "a mass", Dimension::MASS)?;
        self.constant_in_time(&[mass], "a mass", &argument.span)?;
        Ok(mass)
    }

    /// The entries in the axes of the frame.
    fn inertia(&mut self, argument: &Argument<'g>, frame: Resolved<FrameId>) -> Resolved<Matrix<'g>> {
        let tensor = self.matrix(argument)?;
        if let (Some((rows, columns)), Ok(frame)) = (tensor.axes, frame)
            && !(self.same_axes(rows, frame) && self.same_axes(columns, frame))
        {
            let help = "write its entries in the axes of this pose: `inertia(xx, yy, zz, xy, xz, yz)`";
            return Err(self.refuse(
                Code::OtherAxes,
                &argument.span,
                "this inertia is in the axes of another pose",
                help,
            ));
        }
        let Tensor { entries: Matrix(rows), .. } = tensor;
        self.check_dimension(tensor.fit(), "an inertia", Dimension::INERTIA, &argument.span)?;
        if let Ok(frame) = frame {
            self.check_axes_of_inertia(rows.as_flattened(), frame, &argument.span)?;
        }
        self.constant_in_time(rows.as_flattened(), "an inertia", &argument.span)?;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (rows[i][j], rows[j][i]);
            let equal = a == b
                || self.known.facts.constant(a).is_some_and(|a| Some(a) == self.known.facts.constant(b))
                || vanishes(a - b) == Verdict::Holds;
            if !equal {
                let message = format!("an inertia is symmetric, here the entries [{i}][{j}] and [{j}][{i}] differ");
                return Err(self.refuse(
                    Code::InertiaNotSymmetric,
                    &argument.span,
                    message,
                    "write `inertia(xx, yy, zz, xy, xz, yz)`",
                ));
            }
        }
        // The same on both sides to the letter.
        Ok(Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| rows[i.min(j)][i.max(j)]))))
    }

    fn mass_centre(&mut self, argument: &Argument<'g>, frame: FrameId) -> Resolved<Free<'g>> {
        let com = self.components_in(argument, frame, "this mass centre")?;
        self.check_dimension(com.fit(), "a mass centre", Dimension::LENGTH, &argument.span)?;
        self.check_mass_centre(com.components, frame, &argument.span)?;
        Ok(com)
    }

    fn constant_in_time(&mut self, exprs: &[Expr<'g>], what: &str, span: &Span) -> Resolved<()> {
        let moves = exprs.iter().any(|&e| self.known.facts.dependence(e).moves());
        if moves {
            let message = format!("{what} must be constant in time");
            let help = if what == "a mass" {
                "write the kinetic energy out, `1/2 * m * dt(r).norm_squared()`, and the force of the mass that comes or \
                 leaves: `force at r += dt(m)*dt(r);` of a rocket with m(t), besides its thrust; see `mbs explain MBS0907`"
            } else {
                "write the kinetic energy out, `1/2 * j * dt(q)^2` about one axis, and the moment of the mass that comes or \
                 leaves: `force q += dt(j)*dt(q);` of a rocket with j(t); see `mbs explain MBS0907`"
            };
            return Err(self.refuse(Code::MassThatChanges, span, message, help));
        }
        Ok(())
    }

    /// The place in a frame that it does not move in: a moving place gets a frame of its own.
    pub(in crate::model) fn fixed(
        &mut self,
        place: Vector<'g>,
        frame: FrameId,
        span: &Span,
    ) -> Resolved<(Vector<'g>, FrameId)> {
        let moving =
            place.0.iter().map(|e| self.known.facts.dependence(*e)).fold(Dependence::default(), Dependence::or);
        if !moving.moves() && !moving.on(Dependence::RATE) {
            return Ok((place, frame));
        }
        match self.edge(Edge::Translation(place), span)? {
            Some(edge) => Ok((Vector::zero(self.graph), self.lagrangian.frames.attach(frame, edge))),
            None => Ok((place, frame)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, near, refusals, refused, values};

    /// The kinetic energy that some statements add, at the trial state.
    fn kinetic(statements: &str) -> (f64, usize) {
        mechanism(statements, |lagrangian| (values(&lagrangian.kinetic)[1..].iter().sum(), lagrangian.bodies().0.len()))
    }

    /// Two ways to write a kinetic energy, and how many bodies the first one has.
    fn equal(a: &str, bodies: usize, b: &str) {
        let ((t, count), (expected, _)) = (kinetic(a), kinetic(b));
        near(&[t], &[expected], a);
        assert_eq!(count, bodies, "{a}");
    }

    #[test]
    fn particles() {
        equal("kinetic += particle(m, [x, y*theta, l]);", 1, "kinetic += 1/2*m*(dt(x)^2 + dt(y*theta)^2);");
        let pose = "let a = rot_z(theta) * rot_x(q[0]) * translation([l, 0, l]);";
        let written = "let p = a.point([l, l, x]); kinetic += 1/2*m*(dt(p.x)^2 + dt(p.y)^2 + dt(p.z)^2);";
        equal(&format!("{pose} kinetic += particle(m, a.point([l, l, x]));"), 1, &format!("{pose} {written}"));
        equal("kinetic += particle(m, world.point([x, y, z]));", 1, "kinetic += particle(m, [x, y, z]);");
        let free = "let v = rot_z(theta) * [x, l, 0];";
        equal(
            &format!("{free} kinetic += particle(m, v);"),
            1,
            &format!("{free} kinetic += particle(m, [v.x, v.y, v.z]);"),
        );
    }

    #[test]
    fn rigid_bodies() {
        let pose = "let a = rot_z(theta) * rot_x(q[0]) * translation([l, x, l]); let w = angular_velocity(a); let i = inertia(3*m*l^2, 4*m*l^2, 5*m*l^2, m*l^2, -m*l^2, m*l^2/2);";
        let written = "let c = a.point([l, l, 0]); kinetic += 1/2*m*dt(c).norm_squared() + 1/2*w.dot((a*i)*w);";
        equal(&format!("{pose} kinetic += rigid_body(m, [l, l, 0], i, a);"), 1, &format!("{pose} {written}"));
        equal(&format!("{pose} kinetic += rigid_body(m, a.point([l, l, 0]), i, a);"), 1, &format!("{pose} {written}"));
        equal(&format!("{pose} kinetic += rigid_body(m, a * [l, l, 0], i, a);"), 1, &format!("{pose} {written}"));
        // A mass centre that moves in its pose gets a frame of its own.
        let moving = "let c = a.point([y, l, 0]); kinetic += 1/2*m*dt(c).norm_squared() + 1/2*w.dot((a*i)*w);";
        equal(&format!("{pose} kinetic += rigid_body(m, [y, l, 0], i, a);"), 1, &format!("{pose} {moving}"));
        // Plane motion against the textbook: ½ m ẋ² + ½ J θ̇².
        let disc = "kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 2)*m*l^2, translation([x, 0, 0]) * rot_y(theta));";
        equal(disc, 1, "kinetic += 1/2*m*dt(x)^2 + 1/2*m*l^2*dt(theta)^2;");
        let nested = "let i = [[2*m*l^2, 0, m*l^2], [0, 2*m*l^2, 0], [m*l^2, 0, 2*m*l^2]];";
        equal(
            &format!("{nested} kinetic += rigid_body(m, [0, 0, 0], i, rot_z(theta));"),
            1,
            "kinetic += m*l^2*dt(theta)^2;",
        );
    }

    /// Turns about the origin leave the squares of what slides, those by a quaternion of another length as well:
    /// nothing of 1e-16 of the mass stands beside them.
    #[test]
    fn a_free_body_has_the_squares_of_its_coordinates_rates() {
        let pose = "let a = translation([x, y, z]) * rot_z(theta) * quaternion(8*q[0], 7, 0, 1);";
        let free = format!("{pose} kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*0*m*l^2, a);");
        equal(&free, 1, "kinetic += particle(m, [x, y, z]);");
        equal(&format!("{pose} kinetic += particle(m, a.origin());"), 1, "kinetic += particle(m, [x, y, z]);");
    }

    /// Where a quaternion's length is not 1, which constraints alone forbid, T is positive all the same.
    #[test]
    fn a_stretched_quaternion_leaves_kinetic_energies_positive() {
        let pose = "let a = translation([x, y, z]) * quaternion(8*q[0], 7, 0, 1);";
        for component in ["[l, 0, 0]", "[0, l, 0]", "[0, 0, l]", "[l, l, -l]", "[-l, l, l]", "[-l, -l, -l]"] {
            let (energy, _) =
                kinetic(&format!("{pose} kinetic += rigid_body(m, {component}, diag(1, 1, 1)*0*m*l^2, a);"));
            assert!(energy > 0.0, "{component}: {energy}");
        }
    }

    #[test]
    fn bodies_stay_visible_in_sums() {
        let two = "particle(m, world.point([x, y, z])) + particle(2*m, world.point([x, 0, 0]))";
        equal(
            &format!("kinetic += {two} + 1/2*k*t^2*dt(x)^2;"),
            2,
            &format!("kinetic += 1*({two}) + 1/2*k*t^2*dt(x)^2;"),
        );
        equal(&format!("let e = {two}; kinetic += e;"), 2, &format!("kinetic += {two};"));
        equal(&format!("kinetic += 2*({two});"), 2, &format!("kinetic += {two}; kinetic += {two};"));
        equal(
            "let mut e = 0; for i in 0..3 { e = e + particle(m, world.point([x, y, z])); } kinetic += e;",
            3,
            "kinetic += 3*particle(m, [x, y, z]);",
        );
    }

    #[test]
    fn bodies_declared_in_world_axes_are_found_again() {
        let pose = "let a = rot_z(theta) * rot_x(q[0]) * translation([l, x, l]); let i = inertia(3*m*l^2, 4*m*l^2, 5*m*l^2, m*l^2, -m*l^2, m*l^2/2); let p = a.point([l, l, 0]); let v = dt(p); let w = angular_velocity(a);";
        let body = format!("{pose} kinetic += rigid_body(m, [l, l, 0], i, a);");
        let found = |written: &str| equal(&format!("{pose} kinetic += {written};"), 2, &body);
        found("1/2*m*v.norm_squared() + 1/2*w.dot((a*i)*w)");
        found("m*v.dot(v)/2 + dot(a.rotation()*i*a.rotation().transpose()*w, w)/2");
        found("(1/2*(m*v)).dot(v) + ((a*i)*(1/2*w)).dot(w)");
        found("0.5*m*v.norm()^2 - (-w.dot((a*i)*w))/2");
        found("1/2*m*(v.x^2 + v.y*v.y + v.z^2) + 1/2*w.dot((a*i)*w)");
        found("1/2*m*dt(p.x)^2 + 1/2*m*(dt(p.y)^2 + dt(p.z)^2) + 1/2*w.dot((a*i)*w)");
        // Unequal factors are no particle.
        equal(
            &format!("{pose} kinetic += m*(v.x^2 + 2*v.y^2 + v.z^2);"),
            0,
            &format!("{pose} kinetic += m*v.norm_squared() + m*v.y^2;"),
        );
        equal(
            &format!("{pose} kinetic += 1/2*t^2*k*v.norm_squared();"),
            0,
            &format!("{pose} kinetic += t^2*k*(v.x^2 + v.y^2 + v.z^2)/2;"),
        );
    }

    #[test]
    fn wrong_bodies() {
        refused("kinetic += particle(l, [x, y, z]);", "l: a mass must be kg, this is m");
        refused(
            "kinetic += particle(2, [x, y, z]);",
            "2: a mass must be kg, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        refused(
            "kinetic += particle(m*cos(theta), [x, y, z]);",
            "m*cos(theta): a mass must be constant in time; write the kinetic energy out, `1/2 * m * dt(r).norm_squared()`, and the \
             force of the mass that comes or leaves: `force at r += dt(m)*dt(r);` of a rocket with m(t), besides its thrust; \
             see `mbs explain MBS0907`",
        );
        refused(
            "kinetic += particle(m, [theta, 0, 0]);",
            "[theta, 0, 0]: the place of a particle must be m, this is a plain number; a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        refused(
            "kinetic += particle(m, [dt(x)*t, 0, 0]);",
            "[dt(x)*t, 0, 0]: accelerations cannot enter: this is a time derivative already; energies and forces are made of positions and velocities, inertia is kinetic energy",
        );
        refused("kinetic += particle(m, x);", "x: expected a vector, found a number; a vector is written `[x, y, z]`");
        refused(
            "kinetic += particle(m, rot_z(theta));",
            "rot_z(theta): expected a vector, found a pose; the place of a pose is `pose.origin()`",
        );
        refused(
            "kinetic += rigid_body(m, [0, 0, 0], diag(m, m, m), world);",
            "diag(m, m, m): an inertia must be kg·m², this is kg",
        );
        refused(
            "kinetic += rigid_body(m, [0, 0, 0], m*l^2, world);",
            "m*l^2: expected a matrix, found a number; a matrix is written `diag(xx, yy, zz)` or `inertia(xx, yy, zz, xy, xz, yz)`",
        );
        refused(
            "kinetic += rigid_body(m, [0, 0, 0], [[m*l^2, m*l^2, 0], [0, m*l^2, 0], [0, 0, m*l^2]], world);",
            "[[m*l^2, m*l^2, 0], [0, m*l^2, 0], [0, 0, m*l^2]]: an inertia is symmetric, here the entries [0][1] and [1][0] differ; write `inertia(xx, yy, zz, xy, xz, yz)`",
        );
        refused(
            "kinetic += rigid_body(m, rot_x(theta).origin(), diag(1, 1, 1)*m*l^2, world);",
            "rot_x(theta).origin(): this mass centre belongs to another pose; write its components in the axes of this pose: `[x, y, z]`",
        );
        // All four arguments are looked at.
        assert_eq!(refusals("kinetic += rigid_body(l, [0, 0, 0], diag(m, m, m), x);").len(), 3);
    }
}
