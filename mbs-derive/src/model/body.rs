//! `particle` and `rigid_body`: bodies with their kinetic energies.

use std::rc::Rc;

use super::check::Physical;
use super::constant::Dependence;
use super::dimension::Dimension;
use super::evaluate::{Argument, Resolved, Resolver};
use super::frame::{Edge, FrameId};
use super::lagrangian::Body;
use super::value::{Free, Point, Tensor, Term, Value};
use crate::expr::{Expr, Matrix, Vector};
use crate::parse::syntax::Span;

impl<'d, 'g> Resolver<'d, 'g> {
    /// `½ m |ṙ|²`: a body where r is a point of a pose, else the sum of squares in the axes of r.
    pub(super) fn particle(&mut self, mass: &Argument<'g>, position: &Argument<'g>) -> Resolved<Value<'g>> {
        let m = self.mass(mass);
        let place = match position.value {
            Value::Point(point) => Ok(Err(point)),
            _ => self.vector(position).map(Ok),
        };
        let (m, place) = (m?, place?);
        self.physical.push(Physical { mass: m, mass_span: mass.span.clone(), inertia: None });
        let term = match place {
            Err(Point { coordinates, frame }) => {
                let (com, frame) = self.fixed(coordinates, frame, &position.span)?;
                Term::Body(Body { mass: m, com, inertia: None, frame })
            }
            Ok(vector) => {
                self.check_dimension(vector.fit(), "the place of a particle", Dimension::LENGTH, &position.span)?;
                let rate = self.rate(&Argument { value: Value::Vector(vector), span: position.span.clone() })?;
                let velocity = self.vector(&Argument { value: rate, span: position.span.clone() })?;
                Term::Other(1 / self.graph.integer(2) * m * velocity.components.norm_squared())
            }
        };
        Ok(Value::Energy(Rc::new([term])))
    }

    /// `½ m |v_c|² + ½ ωᵀ I ω`
    pub(super) fn rigid_body(
        &mut self,
        mass: &Argument<'g>,
        com: &Argument<'g>,
        inertia: &Argument<'g>,
        pose: &Argument<'g>,
    ) -> Resolved<Value<'g>> {
        let m = self.mass(mass);
        let tensor = self.inertia(inertia);
        let frame = self.frame(pose);
        let (m, tensor, frame) = (m?, tensor?, frame?);
        let Free { components, .. } = self.mass_centre(com, frame)?;
        let physical = Physical { mass: m, mass_span: mass.span.clone(), inertia: Some((tensor, inertia.span.clone())) };
        self.physical.push(physical);
        let (com, frame) = self.fixed(components, frame, &com.span)?;
        Ok(Value::Energy(Rc::new([Term::Body(Body { mass: m, com, inertia: Some(tensor), frame })])))
    }

    fn mass(&mut self, argument: &Argument<'g>) -> Resolved<Expr<'g>> {
        let mass = self.of_dimension(argument, "a mass", Dimension::MASS)?;
        self.constant_in_time(&[mass], "a mass", &argument.span)?;
        Ok(mass)
    }

    fn inertia(&mut self, argument: &Argument<'g>) -> Resolved<Matrix<'g>> {
        let tensor = self.matrix(argument)?;
        let Tensor { entries: Matrix(rows), .. } = tensor;
        self.check_dimension(tensor.fit(), "an inertia", Dimension::INERTIA, &argument.span)?;
        self.constant_in_time(rows.as_flattened(), "an inertia", &argument.span)?;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (rows[i][j], rows[j][i]);
            let equal = a == b || self.facts.constant(a).is_some_and(|a| Some(a) == self.facts.constant(b));
            if !equal {
                let message = format!("an inertia is symmetric, here the entries [{i}][{j}] and [{j}][{i}] differ");
                return Err(self.refuse(&argument.span, message, "write `inertia(xx, yy, zz, xy, xz, yz)`"));
            }
        }
        Ok(tensor.entries)
    }

    fn mass_centre(&mut self, argument: &Argument<'g>, frame: FrameId) -> Resolved<Free<'g>> {
        let com = self.components_in(argument, frame, "this mass centre")?;
        self.check_dimension(com.fit(), "a mass centre", Dimension::LENGTH, &argument.span)?;
        Ok(com)
    }

    fn constant_in_time(&mut self, exprs: &[Expr<'g>], what: &str, span: &Span) -> Resolved<()> {
        let moves = exprs.iter().any(|&e| self.facts.dependence(e).moves());
        if moves {
            let message = format!("{what} must be constant in time");
            let help = "for anything else write the kinetic energy out: `1/2 * m * dt(r).norm_squared()`";
            return Err(self.refuse(span, message, help));
        }
        Ok(())
    }

    /// The place in a frame that it does not move in: a moving place gets a frame of its own.
    fn fixed(&mut self, place: Vector<'g>, frame: FrameId, span: &Span) -> Resolved<(Vector<'g>, FrameId)> {
        let moving = place.0.iter().map(|e| self.facts.dependence(*e)).fold(Dependence::default(), Dependence::or);
        if !moving.moves() && !moving.on(Dependence::RATE) {
            return Ok((place, frame));
        }
        match self.edge(Edge::Translation(place), span)? {
            Some(edge) => Ok((Vector::zero(self.graph), self.lagrangian.frames.attach(frame, edge))),
            None => Ok((place, frame)),
        }
    }
}
