//! `+ - * / ^` and the sign, on every pair of values that has one.

use crate::diagnostic::Code;
use crate::expr::{Binary, Expr, HalfInteger, Matrix, Number, Vector};
use crate::model::frame::FrameId;
use crate::model::landmark::Motion;
use crate::model::names::function::Home;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::{Dimension, lacks_power, second_lacks};
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::model::value::{Free, Point, Pose, Scalar, Shape, Tensor, Value, shared};
use crate::parse::syntax::{BinaryOperator, Span};

/// Exponents beyond this are a slip of the pen.
const LARGEST_EXPONENT: i128 = 100;

/// A longer pose becomes a frame.
const MAX_EDGES: usize = 16;

impl<'d, 'g> Resolver<'d, 'g> {
    /// `left operator right`
    pub(in crate::model) fn binary(
        &mut self,
        operator: BinaryOperator,
        left: Argument<'g>,
        right: Argument<'g>,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        match operator {
            BinaryOperator::Add => self.sum(left, right, false, span),
            BinaryOperator::Sub => self.sum(left, right, true, span),
            BinaryOperator::Mul => self.product(left, right, span),
            BinaryOperator::Div => self.quotient(left, right, span),
            BinaryOperator::Pow => self.power(left, right, span),
        }
    }

    /// `−a`
    pub(in crate::model) fn negative(&mut self, a: Argument<'g>) -> Resolved<Value<'g>> {
        match a.value.shape() {
            Shape::Number => {
                let a = self.scalar(&a)?;
                let minus_one = self.graph.integer(-1);
                self.note_multiple(a.expr, minus_one, -a.expr);
                Ok(Value::Scalar(Scalar::new(-a.expr, a.dimension)))
            }
            Shape::Vector => {
                let a = self.vector(&a)?;
                let minus_one = self.graph.integer(-1);
                a.components.0.iter().for_each(|&c| self.note_multiple(c, minus_one, -c));
                Ok(Value::Vector(Free { components: -a.components, ..a }))
            }
            Shape::Matrix => {
                let a = self.matrix(&a)?;
                Ok(Value::matrix(Tensor { entries: Matrix(a.entries.0.map(|row| row.map(|x| -x))), ..a }))
            }
            Shape::Pose => Err(self.refuse(
                Code::NoOperator,
                &a.span,
                "a pose has no sign",
                "the inverse of a pose is `pose.inverse()`",
            )),
            Shape::Part => Err(self.no_value_of_a_part(&a)),
            Shape::Array => Err(self.no_array_arithmetic(&a)),
        }
    }

    fn no_array_arithmetic(&mut self, a: &Argument<'g>) -> Refused {
        let message = format!("{} cannot be calculated with as a whole", a.value.described());
        self.refuse(
            Code::NoOperator,
            &a.span,
            message,
            "only vectors can, arrays of three numbers: use its elements, `a[0]`",
        )
    }

    fn no_operator(&mut self, sign: &str, left: &Argument<'g>, right: &Argument<'g>, span: &Span) -> Refused {
        for side in [left, right] {
            match side.value.shape() {
                Shape::Array => return self.no_array_arithmetic(side),
                Shape::Part => return self.no_value_of_a_part(side),
                Shape::Number | Shape::Vector | Shape::Matrix | Shape::Pose => {}
            }
        }
        let message = format!("no `{sign}` between {} and {}", left.value.described(), right.value.described());
        let help = match (sign, left.value.shape(), right.value.shape()) {
            ("*", Shape::Vector, Shape::Vector) => "write `a.dot(b)` or `a.cross(b)`",
            ("^", Shape::Vector, _) => "the square of a vector is `v.norm_squared()`",
            ("*", Shape::Vector, Shape::Pose | Shape::Matrix) => "the vector stands behind what turns it: `pose * v`",
            ("+" | "-", Shape::Pose, Shape::Pose) => "poses are composed by `*`",
            ("+" | "-", Shape::Pose, _) => "a shifted pose is `pose * translation([x, y, z])`",
            ("/", _, Shape::Pose) => "the inverse of a pose is `pose.inverse()`",
            ("/", _, Shape::Vector) => "divide by its length, `v.norm()`",
            _ => "",
        };
        self.refuse(Code::NoOperator, span, message, help)
    }
}

// ---- sums

/// The terms of a sum that are not zero, as far as it has been read.
#[derive(Default)]
pub(in crate::model) struct Sum {
    terms: Vec<Term>,
    /// Whether their dimensions differ; which of them is wrong is seen when all have been read.
    differ: bool,
}

struct Term {
    span: Span,
    shape: Shape,
    dimension: Dimension,
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// Takes note of a term, and of what stands before the first sign; refused from the first term on that does not
    /// fit.
    #[inline(never)]
    pub(in crate::model) fn summed(
        &mut self,
        sum: &mut Sum,
        left: &Resolved<Value<'g>>,
        place: &Span,
        right: &Resolved<Argument<'g>>,
    ) -> Resolved<()> {
        if let (true, Ok(left)) = (sum.terms.is_empty(), left) {
            self.term(sum, &Argument { value: left.clone(), span: place.clone() });
        }
        if let Ok(right) = right {
            self.term(sum, right);
        }
        if sum.differ { Err(Refused) } else { Ok(()) }
    }

    fn term(&mut self, sum: &mut Sum, term: &Argument<'g>) {
        let shape = term.value.shape();
        let (dimension, is_zero) = match shape {
            Shape::Number => self.scalar(term).map(|a| a.fit()),
            Shape::Vector => self.vector(term).map(|a| a.fit()),
            Shape::Matrix => self.matrix(term).map(|a| a.fit()),
            Shape::Pose | Shape::Part | Shape::Array => return,
        }
        .unwrap_or((Dimension::ONE, true));
        if !is_zero {
            sum.differ |= sum.terms.iter().take(1).any(|first| first.shape == shape && first.dimension != dimension);
            sum.terms.push(Term { span: term.span.clone(), shape, dimension });
        }
    }

    /// At the end of a sum: reports the terms that have another dimension than the others, at the first of these.
    pub(in crate::model) fn ended(&mut self, sum: &mut Sum) {
        let Sum { terms, differ } = std::mem::take(sum);
        if !differ {
            return;
        }
        let mut counts: Vec<(Dimension, usize)> = Vec::new();
        for term in &terms {
            match counts.iter().position(|(dimension, _)| *dimension == term.dimension) {
                Some(known) => counts[known].1 += 1,
                // A sum of a hundred kinds of terms is no sum of anything: its other kinds are not counted.
                None if counts.len() < 100 => counts.push((term.dimension, 1)),
                None => {}
            }
        }
        // What the statement is about, or what most terms are; of equally many the first.
        let weight = |(dimension, count): &(Dimension, usize)| (Some(*dimension) == self.wanted, *count);
        let Some(&(common, _)) = counts.iter().rev().max_by_key(|entry| weight(entry)) else { return };
        let Some(fitting) = terms.iter().find(|term| term.dimension == common) else { return };
        for odd in terms.iter().filter(|term| term.dimension != common) {
            self.odd_term(odd, fitting);
        }
    }

    fn odd_term(&mut self, odd: &Term, fitting: &Term) {
        let (found, wanted) = (in_words(odd.dimension), in_words(fitting.dimension));
        let message = format!("a sum needs equal dimensions, this term is {found}, not {wanted}");
        self.refuse(Code::UnlikeTerms, &odd.span, message, lacks_power(fitting.dimension, odd.dimension, "it"));
        // Of a library function only the call is shown.
        if self.report.calls.iter().all(|call| call.home != Home::Library) {
            self.report.errors.note(&odd.span, &fitting.span, &format!("this is {wanted}"));
        }
    }

    fn sum(&mut self, a: Argument<'g>, b: Argument<'g>, minus: bool, span: &Span) -> Resolved<Value<'g>> {
        match (a.value.shape(), b.value.shape()) {
            (Shape::Number, Shape::Number) => {
                let (a, b) = (self.scalar(&a)?, self.scalar(&b)?);
                let dimension = self.common(a.fit(), b.fit(), span)?;
                Ok(Value::Scalar(Scalar::new(self.sum_of_numbers(a.expr, b.expr, minus), dimension)))
            }
            (Shape::Vector, Shape::Vector) => self.sum_of_vectors(a, b, minus, span),
            (Shape::Matrix, Shape::Matrix) => {
                let (a, b) = (self.matrix(&a)?, self.matrix(&b)?);
                let dimension = self.common(a.fit(), b.fit(), span)?;
                let (left, right, axes) = match a.axes == b.axes {
                    true => (a.entries, b.entries, a.axes),
                    false => (self.entries_in_world(&a), self.entries_in_world(&b), None),
                };
                let entries = if minus { left - right } else { left + right };
                Ok(Value::matrix(Tensor { entries, axes, dimension }))
            }
            _ => Err(self.no_operator(if minus { "-" } else { "+" }, &a, &b, span)),
        }
    }

    fn common(&mut self, a: (Dimension, bool), b: (Dimension, bool), span: &Span) -> Resolved<Dimension> {
        shared(a, b).ok_or_else(|| {
            let message = format!("a sum needs equal dimensions, these are {} and {}", in_words(a.0), in_words(b.0));
            self.refuse(Code::UnlikeTerms, span, message, second_lacks(a.0, b.0))
        })
    }

    /// A point moved by a vector in its own axes stays a point of its frame; two of its points differ by a vector in
    /// them.
    fn sum_of_vectors(&mut self, a: Argument<'g>, b: Argument<'g>, minus: bool, span: &Span) -> Resolved<Value<'g>> {
        let (left, right) = (self.vector(&a)?, self.vector(&b)?);
        let dimension = self.common(left.fit(), right.fit(), span)?;
        match (&a.value, &b.value) {
            (Value::Point(p), Value::Point(q)) if minus && p.frame == q.frame => {
                let components = p.coordinates - q.coordinates;
                return Ok(Value::Vector(Free { components, frame: p.frame, dimension }));
            }
            (Value::Point(_), Value::Point(_)) => {}
            (Value::Point(p), _) if self.same_axes(p.frame, right.frame) => {
                let moved = if minus { p.coordinates - right.components } else { p.coordinates + right.components };
                return self.point_at(moved, p.frame, span).map(Value::Point);
            }
            (_, Value::Point(p)) if !minus && self.same_axes(p.frame, left.frame) => {
                return self.point_at(left.components + p.coordinates, p.frame, span).map(Value::Point);
            }
            _ => {}
        }
        if let Some(difference) = self.difference((&a.value, left), (&b.value, right), minus) {
            return Ok(Value::Vector(Free { dimension, ..difference }));
        }
        let (u, v, frame) = self.aligned(left, right);
        let components = Vector([0, 1, 2].map(|i| match self.same_axes(frame, FrameId::WORLD) {
            true => self.sum_of_numbers(u.0[i], v.0[i], minus),
            false if minus => u.0[i] - v.0[i],
            false => u.0[i] + v.0[i],
        }));
        Ok(Value::Vector(Free { components, frame, dimension }))
    }
}

// ---- products

impl<'d, 'g> Resolver<'d, 'g> {
    fn product(&mut self, a: Argument<'g>, b: Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        match (a.value.shape(), b.value.shape()) {
            (Shape::Number, Shape::Number) => {
                let (a, b) = (self.scalar(&a)?, self.scalar(&b)?);
                let dimension = self.bounded(a.dimension.times(b.dimension), span)?;
                Ok(Value::Scalar(Scalar::new(self.product_of_numbers(a.expr, b.expr), dimension)))
            }
            (Shape::Number, Shape::Vector | Shape::Matrix) => {
                let factor = self.scalar(&a)?;
                self.scaled(factor, &b, span)
            }
            (Shape::Vector | Shape::Matrix, Shape::Number) => {
                let factor = self.scalar(&b)?;
                self.scaled(factor, &a, span)
            }
            (Shape::Matrix, Shape::Matrix) => {
                let (a, b) = (self.matrix(&a)?, self.matrix(&b)?);
                let dimension = self.bounded(a.dimension.times(b.dimension), span)?;
                Ok(Value::matrix(self.product_of_matrices(&a, &b, dimension)))
            }
            (Shape::Matrix, Shape::Vector) => {
                let (a, v) = (self.matrix(&a)?, self.vector(&b)?);
                let dimension = self.bounded(a.dimension.times(v.dimension), span)?;
                self.applied(&a, v, dimension, span).map(Value::Vector)
            }
            (Shape::Pose, Shape::Pose | Shape::Vector | Shape::Matrix) => self.posed(a, b),
            _ => Err(self.no_operator("*", &a, &b, span)),
        }
    }

    fn product_of_numbers(&mut self, a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
        let product = a * b;
        self.note_multiple(a, b, product);
        self.note_multiple(b, a, product);
        product
    }

    fn scaled(&mut self, factor: Scalar<'g>, b: &Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        if b.value.shape() == Shape::Matrix {
            let matrix = self.matrix(b)?;
            let dimension = self.bounded(factor.dimension.times(matrix.dimension), span)?;
            return Ok(Value::matrix(Tensor { entries: matrix.entries.scale(factor.expr), dimension, ..matrix }));
        }
        let vector = self.vector(b)?;
        let dimension = self.bounded(factor.dimension.times(vector.dimension), span)?;
        let components = vector.components.scale(factor.expr);
        self.lagrangian.landmarks.note_scaled(vector.components, factor.expr, components);
        for (&component, multiple) in vector.components.0.iter().zip(components.0) {
            self.note_multiple(component, factor.expr, multiple);
        }
        Ok(Value::Vector(Free { components, dimension, ..vector }))
    }

    /// Rows of the left factor's axes, columns of the right one's; turned between them where these differ.
    fn product_of_matrices(&self, a: &Tensor<'g>, b: &Tensor<'g>, dimension: Dimension) -> Tensor<'g> {
        let world = (FrameId::WORLD, FrameId::WORLD);
        let ((rows, inner), (outer, columns)) = (a.axes.unwrap_or(world), b.axes.unwrap_or(world));
        if self.same_axes(inner, outer) {
            let axes = (a.axes.or(b.axes)).map(|_| (rows, columns));
            return Tensor { entries: a.entries * b.entries, axes, dimension };
        }
        let entries = self.entries_in_world(a) * self.entries_in_world(b);
        Tensor { entries, axes: Some(world), dimension }
    }

    /// `A v`, in the axes of A's rows. Numbers that do not say in which axes they are take a vector in world axes only.
    fn applied(&mut self, a: &Tensor<'g>, v: Free<'g>, dimension: Dimension, span: &Span) -> Resolved<Free<'g>> {
        let (rows, columns) = match a.axes {
            Some(axes) => axes,
            None if self.same_axes(v.frame, FrameId::WORLD) => (FrameId::WORLD, FrameId::WORLD),
            None => {
                let message =
                    "this matrix does not say in which axes its entries are, and the vector is in those of a pose";
                let help = "write `(pose * matrix) * v` for entries in the axes of the pose, `(world * matrix) * v` for those of the world";
                return Err(self.refuse(Code::MatrixWithoutAxes, span, message, help));
            }
        };
        let turned = self.in_axes(v, columns);
        let components = a.entries * turned;
        self.lagrangian.landmarks.note_transformed(turned, (rows, columns), a.entries, components);
        Ok(Free { components, frame: rows, dimension })
    }

    /// A pose moves poses and points, and turns vectors and tensors.
    fn posed(&mut self, a: Argument<'g>, b: Argument<'g>) -> Resolved<Value<'g>> {
        let Value::Pose(pose) = &a.value else { return Err(self.wrong_shape(&a, Shape::Pose)) };
        match &b.value {
            Value::Pose(inner) => self.composed(pose, inner, &a.span).map(Value::Pose),
            Value::Point(Point { coordinates, frame }) => {
                let frame = self.moved(pose, *frame, &a.span)?;
                Ok(Value::Point(Point { coordinates: *coordinates, frame }))
            }
            _ if b.value.shape() == Shape::Matrix => {
                let matrix = self.matrix(&b)?;
                let (rows, columns) = matrix.axes.unwrap_or((FrameId::WORLD, FrameId::WORLD));
                let axes = (self.moved(pose, rows, &a.span)?, self.moved(pose, columns, &a.span)?);
                Ok(Value::matrix(Tensor { axes: Some(axes), ..matrix }))
            }
            _ => {
                let vector = self.vector(&b)?;
                let frame = self.moved(pose, vector.frame, &a.span)?;
                Ok(Value::Vector(Free { frame, ..vector }))
            }
        }
    }

    /// The frame that moves in `pose` as `frame` moves in the world.
    fn moved(&mut self, pose: &Pose<'g>, frame: FrameId, span: &Span) -> Resolved<FrameId> {
        let edges = self.lagrangian.frames.path(frame);
        let base = self.attached(pose, span)?;
        self.attached(&Pose { base, edges }, span)
    }

    fn composed(&mut self, a: &Pose<'g>, b: &Pose<'g>, span: &Span) -> Resolved<Pose<'g>> {
        let mut edges = self.lagrangian.frames.path(b.base);
        edges.extend_from_slice(&b.edges);
        let mut pose = a.clone();
        if a.edges.len() + edges.len() > MAX_EDGES {
            pose = Pose { base: self.attached(a, span)?, edges: Vec::new() };
        }
        if edges.len() > MAX_EDGES {
            pose = Pose { base: self.attached(&Pose { base: pose.base, edges }, span)?, edges: Vec::new() };
        } else {
            pose.edges.extend(edges);
        }
        Ok(pose)
    }

    /// The inverse pose.
    pub(in crate::model) fn inverse(&mut self, pose: &Pose<'g>, span: &Span) -> Resolved<Pose<'g>> {
        let mut edges = self.lagrangian.frames.path(pose.base);
        edges.extend_from_slice(&pose.edges);
        let edges: Vec<_> = edges.into_iter().rev().map(|edge| edge.reversed()).collect();
        let inverse = Pose { base: FrameId::WORLD, edges };
        if inverse.edges.len() <= MAX_EDGES {
            return Ok(inverse);
        }
        Ok(Pose { base: self.attached(&inverse, span)?, edges: Vec::new() })
    }
}

// ---- quotients and powers

impl<'d, 'g> Resolver<'d, 'g> {
    fn quotient(&mut self, a: Argument<'g>, b: Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        if b.value.shape() != Shape::Number || !matches!(a.value.shape(), Shape::Number | Shape::Vector | Shape::Matrix)
        {
            return Err(self.no_operator("/", &a, &b, span));
        }
        let divisor = self.scalar(&b)?;
        if self.known.facts.constant(divisor.expr).is_some_and(Number::is_zero) {
            return Err(self.refuse(Code::NotFinite, &b.span, "division by zero", ""));
        }
        let inverse = Scalar {
            expr: divisor.expr.power(HalfInteger::MINUS_ONE),
            dimension: self.bounded(divisor.dimension.power(-1, 1), span)?,
        };
        if a.value.shape() != Shape::Number {
            return self.scaled(inverse, &a, span);
        }
        let a = self.scalar(&a)?;
        let dimension = self.bounded(a.dimension.times(inverse.dimension), span)?;
        Ok(Value::Scalar(Scalar::new(self.product_of_numbers(a.expr, inverse.expr), dimension)))
    }

    fn power(&mut self, a: Argument<'g>, b: Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        if (a.value.shape(), b.value.shape()) != (Shape::Number, Shape::Number) {
            return Err(self.no_operator("^", &a, &b, span));
        }
        let base = self.scalar(&a)?;
        let exponent = self.of_dimension(&b, "an exponent", Dimension::ONE)?;
        let constant = self.known.facts.constant(exponent);
        if let Some(Number::Exact { numerator, denominator: denominator @ (1 | 2), pi: 0 }) = constant {
            return self.rational_power(base, numerator, denominator, (&a.span, &b.span), span);
        }
        let dimension = self.dimension_of_power(base.dimension, constant, &b.span)?;
        let known_base = self.known.facts.constant(base.expr);
        if known_base.is_some_and(Number::is_zero) && self.known.facts.dependence(exponent).moves() {
            let message = "zero has no power with an exponent that changes";
            return Err(self.refuse(
                Code::NotFinite,
                &a.span,
                message,
                "write 0 in its place: that is what it is where the exponent is positive",
            ));
        }
        if known_base.is_some_and(Number::is_negative) {
            let message = "a negative number has no power with this exponent";
            return Err(self.refuse(
                Code::NotFinite,
                &a.span,
                message,
                "integers and halves are exponents for any base",
            ));
        }
        let root = match constant {
            Some(Number::Exact { numerator, denominator, pi: 0 }) => {
                self.root_of_squares(base.expr, numerator, denominator)
            }
            _ => None,
        };
        let power = root.unwrap_or_else(|| base.expr.call2(Binary::Powf, exponent));
        Ok(Value::Scalar(Scalar::new(power, dimension)))
    }

    /// `m^(1/3)` is a dimension, `m^x` is none.
    fn dimension_of_power(&mut self, base: Dimension, exponent: Option<Number>, span: &Span) -> Resolved<Dimension> {
        let fraction = match exponent {
            _ if base == Dimension::ONE => return Ok(base),
            Some(Number::Exact { numerator, denominator, pi: 0 }) => {
                i32::try_from(numerator).ok().zip(i32::try_from(denominator).ok())
            }
            _ => None,
        };
        fraction.and_then(|(n, d)| base.power(n, d)).ok_or_else(|| {
            if let Some(Number::Exact { numerator, denominator, pi: 0 }) = exponent {
                let message = format!("{base} to the power of {numerator}/{denominator} is no dimension");
                let help = "the exponents of a dimension are small fractions: divide the base by a quantity of its \
                            dimension to make it a plain number";
                return self.refuse(Code::PowerOfAQuantity, span, message, help);
            }
            let message = format!("a power of {base} needs a constant exponent, such as 2, -1 or 1/3");
            self.refuse(
                Code::PowerOfAQuantity,
                span,
                message,
                "divide the base by a quantity of its dimension to make it a plain number",
            )
        })
    }

    fn rational_power(
        &mut self,
        base: Scalar<'g>,
        numerator: i128,
        denominator: i128,
        (at_base, at_exponent): (&Span, &Span),
        span: &Span,
    ) -> Resolved<Value<'g>> {
        if numerator.abs() > LARGEST_EXPONENT * denominator {
            let message = format!("an exponent is at most {LARGEST_EXPONENT}");
            return Err(self.refuse(Code::OutOfRange, at_exponent, message, "`exp(n * ln(x))` takes any"));
        }
        if numerator < 0 && self.known.facts.constant(base.expr).is_some_and(Number::is_zero) {
            return Err(self.refuse(Code::NotFinite, at_base, "division by zero", ""));
        }
        let (n, d) = (numerator as i32, denominator as i32);
        let dimension = self.bounded(base.dimension.power(n, d), span)?;
        let root = if d == 2 { self.root_of_squares(base.expr, numerator, denominator) } else { None };
        let power = root.unwrap_or_else(|| base.expr.power(HalfInteger::halves(2 / d * n)));
        Ok(Value::Scalar(Scalar::new(power, dimension)))
    }
}

// ---- time derivatives

impl<'d, 'g> Resolver<'d, 'g> {
    /// The total time derivative: of vectors with `ω × v`, in the axes that they are in.
    pub(in crate::model) fn rate(&mut self, a: &Argument<'g>) -> Resolved<Value<'g>> {
        match &a.value {
            Value::Scalar(_) => {
                let Scalar { expr, dimension } = self.scalar(a)?;
                let dimension = self.per_second(dimension, &a.span)?;
                // The literal 0 goes on fitting every dimension.
                let rate = if expr.is_zero() { expr } else { self.rate_of(expr, &a.span)? };
                Ok(Value::Scalar(Scalar::new(rate, dimension)))
            }
            Value::Point(Point { coordinates, frame }) => {
                coordinates.0.iter().try_for_each(|&c| self.check_rate(c, &a.span))?;
                let components = self.lagrangian.velocity(*coordinates, *frame);
                let motion =
                    Motion::Velocity { factor: self.graph.integer(1), coordinates: *coordinates, frame: *frame };
                self.lagrangian.landmarks.note_motion(components, motion);
                let dimension = self.dimension(Dimension::VELOCITY);
                Ok(Value::Vector(Free { components, frame: *frame, dimension }))
            }
            Value::Vector(Free { components, frame, dimension }) => {
                components.0.iter().try_for_each(|&c| self.check_rate(c, &a.span))?;
                let rate =
                    self.rate_of_components(Free { components: *components, frame: *frame, dimension: *dimension });
                let dimension = self.per_second(*dimension, &a.span)?;
                Ok(Value::Vector(Free { components: rate, frame: *frame, dimension }))
            }
            Value::Matrix(matrix) => {
                let (entries, dimension) = (self.entries_in_world(matrix), matrix.dimension);
                entries.0.iter().flatten().try_for_each(|&c| self.check_rate(c, &a.span))?;
                let dimension = self.per_second(dimension, &a.span)?;
                Ok(Value::matrix(Tensor::plain(Matrix(entries.0.map(|row| row.map(Expr::rate))), dimension)))
            }
            Value::Array(array) => {
                let of = |value: &Value<'g>| Argument { value: value.clone(), span: a.span.clone() };
                let rates: Resolved<Vec<_>> = array.values().iter().map(|value| self.rate(&of(value))).collect();
                self.array(rates?, &a.span)
            }
            Value::Pose(_) => {
                let help = "its velocities are `angular_velocity(pose)` and `dt(pose.origin())`";
                Err(self.refuse(Code::NoRate, &a.span, "a pose has no time derivative", help))
            }
            Value::Part(_) => Err(self.no_value_of_a_part(a)),
        }
    }

    pub(in crate::model) fn rate_of(&mut self, expr: Expr<'g>, span: &Span) -> Resolved<Expr<'g>> {
        self.check_rate(expr, span)?;
        if let Some(rate) = self.rate_of_difference(expr) {
            return Ok(rate);
        }
        self.note_rate(expr, expr.rate());
        Ok(expr.rate())
    }

    /// `ω × v + v̇`, in the axes that the vector is in.
    pub(in crate::model) fn rate_of_components(&mut self, Free { components, frame, .. }: Free<'g>) -> Vector<'g> {
        let rate = components.map(Expr::rate);
        let w = self.lagrangian.frames.get(frame).angular_velocity;
        if !w.0.iter().all(|c| c.is_zero()) {
            return w.cross(components) + rate;
        }
        components.0.iter().zip(rate.0).for_each(|(&of, rate)| self.note_rate(of, rate));
        rate
    }

    fn check_rate(&mut self, expr: Expr<'g>, span: &Span) -> Resolved<()> {
        let dependence = self.known.facts.dependence(expr);
        if dependence.on(Dependence::RATE) {
            let help = "energies and forces are made of positions and velocities, inertia is kinetic energy";
            return Err(self.refuse(
                Code::NoRate,
                span,
                "accelerations cannot enter: this is a time derivative already",
                help,
            ));
        }
        if dependence.on(Dependence::INPUT) {
            let help = "make it a coordinate or a formula of `t`";
            return Err(self.refuse(Code::NoRate, span, "the rate of an input is not known", help));
        }
        Ok(())
    }

    fn per_second(&mut self, dimension: Dimension, span: &Span) -> Resolved<Dimension> {
        let second = self.dimension(Dimension::TIME);
        self.bounded(dimension.over(second), span)
    }
}

#[cfg(test)]
mod tests;
