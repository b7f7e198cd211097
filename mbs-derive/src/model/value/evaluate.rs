//! Expressions → values: literals, names, components, elements; and what values are used as.
//!
//! A function that cannot go on notes why and answers [`Refused`]. What is made of a refused value is refused without a
//! word, and both sides of an operator are looked at before it is given up, so that one run reports all mistakes.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, nearest};
use crate::expr::{Expr, Graph, Node, Number, Symbol, Vector};
use crate::model::check::Found;
use crate::model::check::singular::Sites;
use crate::model::effort::Effort;
use crate::model::frame::FrameId;
use crate::model::lagrangian::Draft;
use crate::model::landmark;
use crate::model::names::Names;
use crate::model::names::function::{Function, Home};
use crate::model::report::Report;
use crate::model::statement::reaction::Hold;
use crate::model::value::Known;
use crate::model::value::builtin::{self, CONSTANTS};
use crate::model::value::constant::{Dependence, Facts};
use crate::model::value::difference::Differences;
use crate::model::value::dimension::Dimension;
use crate::model::value::operator::Sum;
use crate::model::value::root::ROOTS;
use crate::model::value::{Array, Free, Point, Pose, Scalar, Value};
use crate::parse::syntax::{BinaryOperator, Expression, ExpressionKind, Name, Span};

/// The expression is given up; why has been noted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) struct Refused;

pub(in crate::model) type Resolved<T> = Result<T, Refused>;

/// A value with its place.
#[derive(Clone, Debug)]
pub(in crate::model) struct Argument<'g> {
    pub(in crate::model) value: Value<'g>,
    pub(in crate::model) span: Span,
}

/// Larger mechanisms have run away: the six-joint arm takes two thousand nodes.
pub(in crate::model) const MAX_NODES: usize = 2_000_000;

/// Expressions looked at, turns of loops and calls of functions included: these could go on for ever.
pub(in crate::model) const MAX_STEPS: usize = 20_000_000;

/// As many levels as the parser allows; what was built by hand may be deeper.
const MAX_DEPTH: usize = 260;

/// Everything that is known while the statements are gone through.
pub(in crate::model) struct Resolver<'d, 'g> {
    pub(in crate::model) graph: &'g Graph,
    /// What the statements write.
    pub(in crate::model) lagrangian: Draft<'g>,
    pub(in crate::model) names: Names<'d, 'g>,
    pub(in crate::model) known: Known<'g>,
    pub(in crate::model) report: Report,
    pub(in crate::model) effort: Effort,
    pub(in crate::model) found: Found<'g>,
    /// Whether joints whose wrenches are asked for are held.
    pub(in crate::model) hold: Hold<'g>,
    /// Whether shapes are drawn, or passed over.
    pub(in crate::model) draws: bool,
    pub(in crate::model) dimensionless: bool,
    /// The dimension of what the statement at hand declares, where it is an energy, a power or a force.
    pub(in crate::model) wanted: Option<Dimension>,
}

// ---- limits

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn new(graph: &'g Graph, name: &str, dimensionless: bool, hold: Hold<'g>) -> Self {
        Resolver {
            graph,
            lagrangian: Draft::new(graph, name),
            names: Names::new(),
            known: Known { facts: Facts::default(), differences: Differences::default(), sites: Sites::new() },
            report: Report::default(),
            effort: Effort::default(),
            found: Found::default(),
            hold,
            draws: false,
            dimensionless,
            wanted: None,
        }
    }

    /// Notes an error, once: in a function together with the calls that led there.
    pub(in crate::model) fn refuse(
        &mut self,
        code: Code,
        span: &Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Refused {
        self.report.refuse(code, span, message, help)
    }

    /// Whether the mechanism has outgrown its limit; says so once.
    pub(in crate::model) fn exhausted(&mut self, span: &Span) -> bool {
        if !self.effort.exhausted && self.graph.len() > MAX_NODES {
            self.effort.exhausted = true;
            let message = format!("the expressions of this mechanism grow beyond {MAX_NODES} nodes");
            self.refuse(
                Code::TooMuch,
                span,
                message,
                "do loops repeat more than was meant, or do values double in each turn?",
            );
        }
        if !self.effort.exhausted && self.effort.steps > MAX_STEPS {
            self.effort.exhausted = true;
            let message = format!("this mechanism takes more than {MAX_STEPS} steps to evaluate");
            self.refuse(Code::TooMuch, span, message, "do loops or functions repeat more than was meant?");
        }
        self.effort.exhausted
    }

    /// As many steps, of what takes longer than others.
    pub(in crate::model) fn spend(&mut self, steps: usize) {
        self.effort.steps += steps;
    }

    /// The dimension, where dimensions are looked at.
    pub(in crate::model) fn dimension(&self, dimension: Dimension) -> Dimension {
        if self.dimensionless { Dimension::ONE } else { dimension }
    }

    /// A dimension that may have run away.
    pub(in crate::model) fn bounded(&mut self, dimension: Option<Dimension>, span: &Span) -> Resolved<Dimension> {
        dimension
            .ok_or_else(|| self.refuse(Code::OutOfRange, span, "the exponents of this dimension are out of range", ""))
    }
}

// ---- expressions

impl<'d, 'g> Resolver<'d, 'g> {
    /// The value of an expression.
    pub(in crate::model) fn expression(&mut self, expression: &Expression) -> Resolved<Value<'g>> {
        self.deeper(&expression.span)?;
        let (first, steps) = expression.left_spine();
        let mut value = self.operand(first);
        // What stands before each operator, in brackets or not.
        let lefts = std::iter::successors(Some(expression), |e| match &e.kind {
            ExpressionKind::Binary(_, left, _) => Some(&**left),
            _ => None,
        });
        let lefts: Vec<&Span> = lefts.skip(1).map(|e| &e.span).collect();
        let mut sum = Sum::default();
        for ((operator, right), left) in steps.into_iter().zip(lefts.into_iter().rev()) {
            value = self.step(value, operator, right, left.clone(), &mut sum);
        }
        self.ended(&mut sum);
        self.effort.depth -= 1;
        value
    }

    /// One level deeper, of expressions and of the functions that they call; the caller comes back up by itself.
    pub(in crate::model) fn deeper(&mut self, span: &Span) -> Resolved<()> {
        self.effort.steps += 1;
        if self.exhausted(span) {
            return Err(Refused);
        }
        if self.effort.depth == MAX_DEPTH {
            let message = format!("this is nested deeper than {MAX_DEPTH} levels");
            let help = match self.report.calls.is_empty() {
                true => "name the inner values with `let`",
                false => "the calls within calls count too",
            };
            return Err(self.refuse(Code::TooDeep, span, message, help));
        }
        self.effort.depth += 1;
        Ok(())
    }

    /// One operator of a chain, with what stands before it.
    #[inline(never)]
    fn step(
        &mut self,
        left: Resolved<Value<'g>>,
        operator: BinaryOperator,
        right: &Expression,
        place: Span,
        sum: &mut Sum,
    ) -> Resolved<Value<'g>> {
        let right = self.argument(right);
        if matches!(operator, BinaryOperator::Add | BinaryOperator::Sub) {
            self.summed(sum, &left, &place, &right)?;
        } else {
            self.ended(sum);
        }
        let right = right?;
        self.combined(left?, operator, right, place)
    }

    #[inline(never)]
    fn combined(
        &mut self,
        left: Value<'g>,
        operator: BinaryOperator,
        right: Argument<'g>,
        place: Span,
    ) -> Resolved<Value<'g>> {
        let span = place.start..right.span.end;
        let factors = !matches!(operator, BinaryOperator::Add | BinaryOperator::Sub)
            && self.is_nonzero_constant(&left)
            && (operator == BinaryOperator::Pow || self.is_nonzero_constant(&right.value));
        let value = self.binary(operator, Argument { value: left, span: place }, right, &span)?;
        if factors && self.is_zero_constant(&value) {
            let message = "this is not zero, but nearer to it than an `f64` can be";
            return Err(self.refuse(Code::OutOfRange, &span, message, "choose other units, or check the exponents"));
        }
        self.watch(&value, &span, operator == BinaryOperator::Pow);
        self.defined(value, &span)
    }

    fn is_nonzero_constant(&mut self, value: &Value<'g>) -> bool {
        matches!(value, Value::Scalar(a) if self.known.facts.constant(a.expr).is_some_and(|number| !number.is_zero()))
    }

    fn is_zero_constant(&mut self, value: &Value<'g>) -> bool {
        matches!(value, Value::Scalar(a) if self.known.facts.constant(a.expr).is_some_and(Number::is_zero))
    }

    /// The value of an expression, with its place.
    pub(in crate::model) fn argument(&mut self, expression: &Expression) -> Resolved<Argument<'g>> {
        Ok(Argument { value: self.expression(expression)?, span: expression.span.clone() })
    }

    /// The values of all expressions; all are looked at before any is given up.
    pub(in crate::model) fn arguments(&mut self, expressions: &[Expression]) -> Resolved<Vec<Argument<'g>>> {
        let values: Vec<_> = expressions.iter().map(|e| self.argument(e)).collect();
        values.into_iter().collect()
    }

    /// One function for each kind: together they would need a stack too large for deep expressions.
    fn operand(&mut self, expression: &Expression) -> Resolved<Value<'g>> {
        let span = &expression.span;
        match &expression.kind {
            ExpressionKind::Number(text) => self.number(text, span),
            ExpressionKind::Quantity(text, unit) => self.quantity(text, unit, span),
            ExpressionKind::Name(name) => self.name(name, span),
            ExpressionKind::Negate(inner) => self.negate(inner),
            // The left spine has taken these apart.
            ExpressionKind::Binary(..) => self.expression(expression),
            ExpressionKind::Call(name, arguments) => self.call(name, arguments, span),
            ExpressionKind::Method(receiver, name, arguments) => self.method(receiver, name, arguments, span),
            ExpressionKind::Field(value, field) => self.field(value, field),
            ExpressionKind::Index(array, index) => self.indexed(expression, array, index),
            ExpressionKind::Array(elements) => self.elements_in_a_row(elements, span),
            ExpressionKind::If(condition, yes, no) => self.conditional(condition, yes, no, span),
            ExpressionKind::Compare(..) | ExpressionKind::And(..) | ExpressionKind::Or(..) | ExpressionKind::Not(_) => {
                Err(self.no_value(expression))
            }
        }
    }

    #[inline(never)]
    fn negate(&mut self, inner: &Expression) -> Resolved<Value<'g>> {
        let value = self.argument(inner)?;
        self.negative(value)
    }

    #[inline(never)]
    fn call(&mut self, name: &Name, arguments: &[Expression], span: &Span) -> Resolved<Value<'g>> {
        let arguments = self.arguments(arguments);
        if let Some(function) = self.functions_in_sight().get(name.text.as_str()).copied() {
            return self.value_of_function(function, name, arguments, span);
        }
        let value = builtin::function(self, name, arguments, span)?;
        self.watch(&value, span, ROOTS.contains(&name.text.as_str()));
        self.defined(value, span)
    }

    #[inline(never)]
    fn method(
        &mut self,
        receiver: &Expression,
        name: &Name,
        arguments: &[Expression],
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let receiver = self.argument(receiver);
        let arguments = self.arguments(arguments);
        let value = builtin::method(self, name, receiver, arguments, span)?;
        self.watch(&value, span, ROOTS.contains(&name.text.as_str()));
        Ok(value)
    }

    #[inline(never)]
    fn field(&mut self, value: &Expression, field: &Name) -> Resolved<Value<'g>> {
        let value = self.argument(value)?;
        if let Value::Part(instance) = &value.value {
            return self.value_of_part(instance, field);
        }
        self.component(&value, field)
    }

    #[inline(never)]
    fn indexed(&mut self, whole: &Expression, array: &Expression, index: &Expression) -> Resolved<Value<'g>> {
        if let Some((name, indices)) = whole.element_of()
            && self.names.scope.get(name).is_some_and(|binding| binding.elements.is_some())
        {
            return self.element(name, &indices, &whole.span);
        }
        let (array, index) = (self.argument(array), self.argument(index));
        self.element_of(&array?, &index?)
    }

    #[inline(never)]
    fn elements_in_a_row(&mut self, elements: &[Expression], span: &Span) -> Resolved<Value<'g>> {
        let elements = self.arguments(elements)?;
        self.array(elements.into_iter().map(|e| e.value).collect(), span)
    }

    fn number(&mut self, text: &str, span: &Span) -> Resolved<Value<'g>> {
        match Number::parse_decimal(text) {
            Some(value) => Ok(Value::Scalar(Scalar::plain(self.graph.constant(value)))),
            None => Err(self.refuse(Code::NotANumber, span, format!("`{text}` is not a number"), "")),
        }
    }

    pub(in crate::model) fn array(&mut self, values: Vec<Value<'g>>, span: &Span) -> Resolved<Value<'g>> {
        if values.is_empty() {
            return Err(self.refuse(Code::ArraySize, span, "an array has at least one element", ""));
        }
        match Array::new(values) {
            Some(array) => Ok(Value::Array(array)),
            None => Err(self.refuse(Code::ArraySize, span, "this array is too large or nested too deeply", "")),
        }
    }

    /// A number, if it is one: `sqrt(-2)` and the like are not.
    fn defined(&mut self, value: Value<'g>, span: &Span) -> Resolved<Value<'g>> {
        match value {
            Value::Scalar(scalar) if self.known.facts.dependence(scalar.expr).on(Dependence::UNDEFINED) => {
                Err(self.refuse(Code::NotFinite, span, "this is not a finite real number", ""))
            }
            value => Ok(value),
        }
    }
}

// ---- names

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn name(&mut self, name: &str, span: &Span) -> Resolved<Value<'g>> {
        if let Some(binding) = self.names.scope.get(name) {
            if binding.elements.is_some() {
                return self.element(name, &[], span);
            }
            let value = binding.value.clone().ok_or(Refused);
            if let Ok(Value::Pose(_)) = value {
                self.names.scope.note_use(name, span);
            }
            return value;
        }
        match name {
            "pi" => Ok(Value::Scalar(Scalar::plain(self.graph.constant(Number::PI)))),
            "deg" => {
                let degree = Number::rational(1, 180).unwrap_or(Number::ONE) * Number::PI;
                Ok(Value::Scalar(Scalar::plain(self.graph.constant(degree))))
            }
            "t" => Ok(Value::Scalar(Scalar::new(self.graph.symbol(Symbol::Time), self.dimension(Dimension::TIME)))),
            "world" => Ok(Value::Pose(Pose { base: FrameId::WORLD, edges: Vec::new() })),
            _ => Err(self.unknown(name, span)),
        }
    }

    fn unknown(&mut self, name: &str, span: &Span) -> Refused {
        if self.home() != Home::Mechanism {
            return self.unknown_to_imports(name, span);
        }
        if let Some(origin) = self.names.scope.hidden(name) {
            let who = if self.names.scope.is_in_part() { "part" } else { "function" };
            let message = format!("`{name}` is {}: a {who} does not see it", origin.described());
            let help =
                format!("give it to the {who} as an argument; coordinates, parameters, inputs and constants it sees");
            return self.refuse(Code::OutOfSight, span, message, help);
        }
        if let Some(cycle) = self.cycle(name) {
            let message = format!("`{name}` is defined by itself: {}", cycle.join(" → "));
            return self.refuse(
                Code::DefinedByItself,
                span,
                message,
                "a `let mut` can take a new value made of its old one: `x = x + …;`",
            );
        }
        if self.names.definitions.contains_key(name) {
            let message = format!("`{name}` is declared further down");
            return self.refuse(
                Code::DeclaredLater,
                span,
                message,
                "names are known from their declaration on: move it up",
            );
        }
        if self.found.joints.iter().any(|joint| joint.family.name.text == name) {
            let message = format!("`{name}` is a reaction: it follows from the accelerations, and is no value here");
            let help = "state the load by what causes it, such as `mu*m*g`, or make it an input";
            return self.refuse(Code::NotAValue, span, message, help);
        }
        let own = self.names.functions.get(name).map(Function::form);
        if let Some(form) = own.or(builtin::form_of_function(name).map(str::to_string)) {
            return self.refuse(Code::NotAValue, span, format!("`{name}` is a function"), format!("write `{form}`"));
        }
        let known: Vec<&str> = self.names.scope.names().map(|(name, _)| name).chain(CONSTANTS).collect();
        let rate_of = ["_dot", "_d", "d"].iter().find_map(|end| name.strip_suffix(end).filter(|x| known.contains(x)));
        if let Some(variable) = rate_of {
            let help = format!("the rate of `{variable}` is `dt({variable})`");
            return self.refuse(Code::Undeclared, span, format!("`{name}` is not declared"), help);
        }
        let help = match nearest(name, known) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("declare it: `param {name}: m = …;` or `let {name} = …;`"),
        };
        self.refuse(Code::Undeclared, span, format!("`{name}` is not declared"), help)
    }

    /// From the name that is being defined through `name` back to it, where its definition leads there.
    fn cycle(&self, name: &str) -> Option<Vec<String>> {
        let start = self.names.defining?;
        let (&name, _) = self.names.definitions.get_key_value(name)?;
        let mut reached_from: BTreeMap<&str, &str> = BTreeMap::from([(name, start)]);
        let mut waiting = vec![name];
        while let Some(at) = waiting.pop() {
            if at == start {
                let mut back = std::iter::successors(Some(start), |at| reached_from.get(at).copied());
                let mut path: Vec<String> = back.next().into_iter().map(str::to_string).collect();
                for step in back {
                    path.push(step.to_string());
                    if step == start {
                        break;
                    }
                }
                path.reverse();
                return Some(path);
            }
            for next in self.names.definitions.get(at).copied().flatten().map(names_in).unwrap_or_default() {
                if let Some((&next, _)) = self.names.definitions.get_key_value(next)
                    && !reached_from.contains_key(next)
                {
                    reached_from.insert(next, at);
                    waiting.push(next);
                }
            }
        }
        None
    }
}

/// The names that an expression uses.
fn names_in<'d>(expression: &'d Expression) -> Vec<&'d str> {
    let name = |part: &'d Expression| match &part.kind {
        ExpressionKind::Name(name) => Some(name.as_str()),
        _ => None,
    };
    expression.parts().filter_map(name).collect()
}

// ---- components and elements

impl<'d, 'g> Resolver<'d, 'g> {
    /// `v.x`: the component along a world axis; only that one is turned.
    fn component(&mut self, value: &Argument<'g>, field: &Name) -> Resolved<Value<'g>> {
        let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == field.text) else {
            let help = match builtin::form_of_method(&field.text) {
                Some(form) => format!("write `{form}`"),
                None => "vectors and points have `.x`, `.y` and `.z`, along the axes of the world".to_string(),
            };
            return Err(self.refuse(
                Code::NoComponent,
                &field.span,
                format!("there is no component `{}`", field.text),
                help,
            ));
        };
        if let Value::Point(point) = value.value {
            let expr = self.world_component(point, axis);
            return Ok(Value::Scalar(Scalar::new(expr, self.dimension(Dimension::LENGTH))));
        }
        let Free { components, frame, dimension } = self.vector(value)?;
        let component = match self.velocity_in_world(components) {
            Some(velocity) => velocity.0[axis],
            None => self.turned(components, frame, axis),
        };
        self.lagrangian.landmarks.note_component_of(components, axis, component);
        self.note_component_of_velocity(component, axis, components);
        Ok(Value::Scalar(Scalar::new(component, dimension)))
    }

    /// One coordinate of a place in the world.
    pub(in crate::model) fn world_component(
        &mut self,
        Point { coordinates, frame }: Point<'g>,
        axis: usize,
    ) -> Expr<'g> {
        let place = self.lagrangian.frames.get(frame);
        let turned = self.turned(coordinates, frame, axis);
        let expr = if place.position.0.iter().all(|p| p.is_zero()) { turned } else { place.position.0[axis] + turned };
        self.lagrangian.landmarks.note_component(expr, landmark::Place { axis, coordinates, frame });
        self.note_component(expr, axis, Point { coordinates, frame });
        expr
    }

    /// One component in world axes.
    fn turned(&self, v: Vector<'g>, frame: FrameId, axis: usize) -> Expr<'g> {
        match self.same_axes(frame, FrameId::WORLD) {
            true => v.0[axis],
            false => Vector(self.lagrangian.frames.get(frame).rotation.0[axis]).dot(v),
        }
    }

    pub(in crate::model) fn element_of(&mut self, array: &Argument<'g>, index: &Argument<'g>) -> Resolved<Value<'g>> {
        if let Value::Array(array) = &array.value {
            let number = self.index(index, array.values().len())?;
            return Ok(array.values()[number].clone());
        }
        let elements = self.elements(array)?;
        let number = self.index(index, elements.len())?;
        Ok(elements[number].clone())
    }

    /// What can be picked by an index.
    pub(in crate::model) fn elements(&mut self, array: &Argument<'g>) -> Resolved<Vec<Value<'g>>> {
        let dimension = |dimension| move |expr| Value::Scalar(Scalar::new(expr, dimension));
        match &array.value {
            Value::Array(array) => Ok(array.values().to_vec()),
            Value::Vector(_) | Value::Point(_) => {
                let vector = self.vector(array)?;
                Ok(self.in_world(vector).0.map(dimension(vector.dimension)).to_vec())
            }
            Value::Matrix(matrix) => {
                let rows = self.entries_in_world(matrix).0;
                let rows = rows.map(|row| Array::new(row.map(dimension(matrix.dimension)).to_vec()));
                Ok(rows.into_iter().flatten().map(Value::Array).collect())
            }
            other => {
                let message = format!("{} has no elements", other.described());
                Err(self.refuse(
                    Code::NoElements,
                    &array.span,
                    message,
                    "arrays are declared with their length: `param mass[6]: kg = 1;`",
                ))
            }
        }
    }

    /// A constant integer below `length`.
    pub(in crate::model) fn index(&mut self, index: &Argument<'g>, length: usize) -> Resolved<usize> {
        let value = self.integer(index, "an index")?;
        match usize::try_from(value) {
            Ok(number) if number < length => Ok(number),
            _ => {
                let message = format!("the index {value} is out of range: there are {length} elements");
                Err(self.refuse(
                    Code::IndexOutOfRange,
                    &index.span,
                    message,
                    format!("indices run from 0 to {}", length - 1),
                ))
            }
        }
    }

    /// A constant integer.
    pub(in crate::model) fn integer(&mut self, argument: &Argument<'g>, what: &str) -> Resolved<i64> {
        let Scalar { expr, dimension } = self.scalar(argument)?;
        match self.known.facts.integer(expr).filter(|_| dimension == Dimension::ONE || expr.is_zero()) {
            Some(value) => Ok(value),
            None => {
                let help = match expr.node() {
                    Node::Symbol(Symbol::Parameter(_)) => {
                        "a parameter may change at run time: declare it as `const name = …;`"
                    }
                    _ => "it is made of numbers, constants and loop variables",
                };
                Err(self.refuse(
                    Code::KnownAtBuildTime,
                    &argument.span,
                    format!("{what} must be a constant integer"),
                    help,
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests;
