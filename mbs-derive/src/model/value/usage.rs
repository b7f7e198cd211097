//! What values are used as: numbers, vectors, matrices, frames; in which axes.

use crate::diagnostic::Code;
use crate::expr::{Expr, Matrix, Number, Vector};
use crate::model::frame::{Edge, FrameId};
use crate::model::landmark::Motion;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::{Free, Point, Pose, Scalar, Shape, Tensor, Value, shared};
use crate::parse::syntax::Span;

// ---- what values are used as

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn wrong_shape(&mut self, argument: &Argument<'g>, wanted: Shape) -> Refused {
        let message = format!("expected {}, found {}", wanted.described(), argument.value.described());
        let help = match (wanted, argument.value.shape()) {
            (Shape::Number, Shape::Vector) => "of a vector, `.x`, `.norm()` and `.dot(v)` are numbers",
            (Shape::Vector, Shape::Pose) => "the place of a pose is `pose.origin()`",
            (Shape::Vector, Shape::Number) => "a vector is written `[x, y, z]`",
            (Shape::Vector, Shape::Array) => "a vector has three components: in a plane, `[x, y, 0]` or `[x, 0, z]`",
            (Shape::Matrix, Shape::Number) => {
                "a matrix is written `diag(xx, yy, zz)` or `inertia(xx, yy, zz, xy, xz, yz)`"
            }
            (Shape::Pose, _) => "poses are made by `rot_z(angle)`, `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
            _ => "",
        };
        self.refuse(Code::WrongShape, &argument.span, message, help)
    }

    pub(in crate::model) fn scalar(&mut self, argument: &Argument<'g>) -> Resolved<Scalar<'g>> {
        match &argument.value {
            Value::Scalar(scalar) => Ok(*scalar),
            _ => Err(self.wrong_shape(argument, Shape::Number)),
        }
    }

    /// A number of the dimension wanted; `what` begins the message.
    pub(in crate::model) fn of_dimension(
        &mut self,
        argument: &Argument<'g>,
        what: &str,
        wanted: Dimension,
    ) -> Resolved<Expr<'g>> {
        let scalar = self.scalar(argument)?;
        self.check_dimension(scalar.fit(), what, wanted, &argument.span)?;
        Ok(scalar.expr)
    }

    /// `what` begins the message.
    pub(in crate::model) fn check_dimension(
        &mut self,
        found: (Dimension, bool),
        what: &str,
        wanted: Dimension,
        span: &Span,
    ) -> Resolved<()> {
        let wanted = self.dimension(wanted);
        if shared((wanted, false), found).is_some() {
            return Ok(());
        }
        let help = match (wanted, found.0) {
            (Dimension::ONE, _) => "divide by a quantity of the same dimension".to_string(),
            (_, Dimension::ONE) => {
                "a number has no unit unless it is written behind it: `0.3 kg`, `9.81 m/s^2`".to_string()
            }
            _ => String::new(),
        };
        Err(self.refuse(
            Code::WrongDimension,
            span,
            format!("{what} must be {}, this is {}", in_words(wanted), in_words(found.0)),
            help,
        ))
    }

    /// A vector in any axes; a point stands for its place in the world.
    pub(in crate::model) fn vector(&mut self, argument: &Argument<'g>) -> Resolved<Free<'g>> {
        match &argument.value {
            Value::Vector(vector) => Ok(*vector),
            Value::Point(point) => Ok(self.position(*point)),
            Value::Array(array) if argument.value.shape() == Shape::Vector => {
                let (exprs, dimension) = self.numbers(array.values(), "the components of a vector", &argument.span)?;
                let plain = Free { components: Vector(exprs), frame: FrameId::WORLD, dimension };
                Ok(self.difference_with(exprs).unwrap_or(plain))
            }
            _ => Err(self.wrong_shape(argument, Shape::Vector)),
        }
    }

    /// Three numbers of one dimension.
    fn numbers(&mut self, values: &[Value<'g>], what: &str, span: &Span) -> Resolved<([Expr<'g>; 3], Dimension)> {
        let mut exprs = [self.graph.integer(0); 3];
        let mut common = (Dimension::ONE, true);
        for (expr, value) in exprs.iter_mut().zip(values) {
            let number = self.scalar(&Argument { value: value.clone(), span: span.clone() })?;
            *expr = number.expr;
            let Some(dimension) = shared(common, number.fit()) else {
                let message = format!("{what} share one dimension, these are {} and {}", common.0, number.dimension);
                return Err(self.refuse(Code::UnequalDimensions, span, message, ""));
            };
            common = (dimension, common.1 && number.expr.is_zero());
        }
        Ok((exprs, common.0))
    }

    pub(in crate::model) fn matrix(&mut self, argument: &Argument<'g>) -> Resolved<Tensor<'g>> {
        match &argument.value {
            Value::Matrix(matrix) => Ok(**matrix),
            Value::Array(array) if argument.value.shape() == Shape::Matrix => {
                let mut rows = [[self.graph.integer(0); 3]; 3];
                let mut common = (Dimension::ONE, true);
                for (row, value) in rows.iter_mut().zip(array.values()) {
                    let found = self.vector(&Argument { value: value.clone(), span: argument.span.clone() })?;
                    *row = self.in_world(found).0;
                    let Some(dimension) = shared(common, found.fit()) else {
                        let message = "the entries of a matrix share one dimension";
                        return Err(self.refuse(Code::UnequalDimensions, &argument.span, message, ""));
                    };
                    common = (dimension, common.1 && found.fit().1);
                }
                Ok(Tensor::plain(Matrix(rows), common.0))
            }
            _ => Err(self.wrong_shape(argument, Shape::Matrix)),
        }
    }

    /// A matrix with its entries in world axes.
    pub(in crate::model) fn matrix_in_world(&mut self, argument: &Argument<'g>) -> Resolved<Tensor<'g>> {
        let matrix = self.matrix(argument)?;
        Ok(Tensor::plain(self.entries_in_world(&matrix), matrix.dimension))
    }

    /// The frame of a pose.
    pub(in crate::model) fn frame(&mut self, argument: &Argument<'g>) -> Resolved<FrameId> {
        match &argument.value {
            Value::Pose(pose) => self.attached(pose, &argument.span),
            _ => Err(self.wrong_shape(argument, Shape::Pose)),
        }
    }

    /// The frame of a pose.
    pub(in crate::model) fn attached(&mut self, pose: &Pose<'g>, span: &Span) -> Resolved<FrameId> {
        let mut frame = pose.base;
        for &edge in &pose.edges {
            if self.exhausted(span) {
                return Err(Refused);
            }
            frame = self.lagrangian.frames.attach(frame, edge);
        }
        Ok(frame)
    }
}

// ---- axes

impl<'d, 'g> Resolver<'d, 'g> {
    /// Whether components in the one frame are components in the other.
    pub(in crate::model) fn same_axes(&self, a: FrameId, b: FrameId) -> bool {
        let frames = &self.lagrangian.frames;
        a == b || frames.get(a).rotation == frames.get(b).rotation
    }

    pub(in crate::model) fn in_world(&mut self, vector: Free<'g>) -> Vector<'g> {
        if self.same_axes(vector.frame, FrameId::WORLD) {
            return vector.components;
        }
        let turned = self.velocity_in_world(vector.components);
        let turned = turned.unwrap_or_else(|| self.lagrangian.frames.get(vector.frame).rotation * vector.components);
        self.lagrangian.landmarks.note_turned(vector.components, turned);
        turned
    }

    /// What is the velocity of a place, in world axes: turned back from the axes of its frame, it would keep what the
    /// rounding of these turns leaves.
    pub(in crate::model) fn velocity_in_world(&self, components: Vector<'g>) -> Option<Vector<'g>> {
        match self.lagrangian.landmarks.motion(components)? {
            Motion::Velocity { factor, coordinates, frame } if factor.is_one() => {
                Some(self.lagrangian.velocity_in_world(coordinates, frame))
            }
            Motion::Velocity { .. } | Motion::Turning { .. } => None,
        }
    }

    /// In the axes of `frame`.
    pub(in crate::model) fn in_axes(&mut self, vector: Free<'g>, frame: FrameId) -> Vector<'g> {
        if self.same_axes(vector.frame, frame) {
            return vector.components;
        }
        let world = self.in_world(vector);
        match self.same_axes(frame, FrameId::WORLD) {
            true => world,
            false => self.lagrangian.frames.get(frame).rotation.transpose() * world,
        }
    }

    /// `R A Sᵀ`, where rows are in axes turned by R and columns in axes turned by S.
    pub(in crate::model) fn entries_in_world(&self, matrix: &Tensor<'g>) -> Matrix<'g> {
        let Some((rows, columns)) = matrix.axes else { return matrix.entries };
        let mut entries = matrix.entries;
        if !self.same_axes(rows, FrameId::WORLD) {
            entries = self.lagrangian.frames.get(rows).rotation * entries;
        }
        if !self.same_axes(columns, FrameId::WORLD) {
            entries = entries * self.lagrangian.frames.get(columns).rotation.transpose();
        }
        entries
    }

    /// A place: where it moves in the frame, it gets a frame of its own.
    pub(in crate::model) fn point_at(
        &mut self,
        coordinates: Vector<'g>,
        frame: FrameId,
        span: &Span,
    ) -> Resolved<Point<'g>> {
        let (coordinates, frame) = self.fixed(coordinates, frame, span)?;
        Ok(Point { coordinates, frame })
    }

    /// From the origin of the world, in its axes.
    pub(in crate::model) fn position(&mut self, Point { coordinates, frame }: Point<'g>) -> Free<'g> {
        let dimension = self.dimension(Dimension::LENGTH);
        let components = match frame {
            FrameId::WORLD => coordinates,
            frame => self.lagrangian.position(coordinates, frame),
        };
        if frame != FrameId::WORLD {
            self.note_components(components, Point { coordinates, frame });
        }
        Free { components, frame: FrameId::WORLD, dimension }
    }

    /// Two vectors in common axes: their own where they share them, else those of the world.
    pub(in crate::model) fn aligned(&mut self, a: Free<'g>, b: Free<'g>) -> (Vector<'g>, Vector<'g>, FrameId) {
        if self.same_axes(a.frame, b.frame) || b.fit().1 {
            (a.components, b.components, a.frame)
        } else if a.fit().1 {
            (a.components, b.components, b.frame)
        } else {
            (self.in_world(a), self.in_world(b), FrameId::WORLD)
        }
    }

    /// Components in the axes of `frame`, of a plain `[x, y, z]` or a vector of that frame.
    pub(in crate::model) fn components_in(
        &mut self,
        argument: &Argument<'g>,
        frame: FrameId,
        what: &str,
    ) -> Resolved<Free<'g>> {
        let vector = match argument.value {
            Value::Point(Point { coordinates, frame }) => {
                Free { components: coordinates, frame, dimension: self.dimension(Dimension::LENGTH) }
            }
            _ => self.vector(argument)?,
        };
        let is_point = matches!(argument.value, Value::Point(_));
        let plain = vector.frame == FrameId::WORLD && !is_point;
        let of_frame = if is_point { vector.frame == frame } else { self.same_axes(vector.frame, frame) };
        if plain || of_frame {
            return Ok(Free { frame, ..vector });
        }
        let message = format!("{what} belongs to another pose");
        Err(self.refuse(
            Code::OtherAxes,
            &argument.span,
            message,
            "write its components in the axes of this pose: `[x, y, z]`",
        ))
    }

    /// An edge of a pose; `None` where it does nothing.
    pub(in crate::model) fn edge(&mut self, edge: Edge<'g>, span: &Span) -> Resolved<Option<Edge<'g>>> {
        let motion: Vec<Expr<'g>> = match edge {
            Edge::Rotation { angle, .. } => vec![angle],
            Edge::Quaternion(q) => q.to_vec(),
            Edge::Translation(t) => t.0.to_vec(),
        };
        let dependence =
            motion.iter().map(|e| self.known.facts.dependence(*e)).fold(Dependence::default(), Dependence::or);
        if dependence.on(Dependence::INPUT) {
            let help = "the rate of an input is not known: make it a coordinate or a formula of `t`";
            return Err(self.refuse(Code::PoseThatJumps, span, "a pose cannot depend on an input", help));
        }
        if dependence.on(Dependence::RATE) {
            let help = "its own velocity would be an acceleration";
            return Err(self.refuse(Code::PoseThatJumps, span, "a pose cannot depend on a time derivative", help));
        }
        // A quaternion is still where its vector part is zero.
        let moving = if let Edge::Quaternion(_) = edge { &motion[1..] } else { &motion[..] };
        let still = moving.iter().all(|e| self.known.facts.constant(*e).is_some_and(Number::is_zero));
        Ok((!still).then_some(edge))
    }
}

/// A dimension for messages.
pub(in crate::model) fn in_words(dimension: Dimension) -> String {
    match dimension {
        Dimension::ONE => "a plain number".to_string(),
        dimension => dimension.to_string(),
    }
}
