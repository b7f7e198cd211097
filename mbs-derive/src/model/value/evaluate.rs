//! Expressions → values: literals, names, components, elements; and what values are used as.
//!
//! A function that cannot go on notes why and answers [`Refused`]. What is made of a refused value is refused without a
//! word, and both sides of an operator are looked at before it is given up, so that one run reports all mistakes.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use crate::diagnostic::{Diagnostic, Diagnostics, nearest};
use crate::expr::{Expr, Graph, Matrix, Node, Number, Symbol, Vector};
use crate::model::check::singular::Sites;
use crate::model::check::{Physical, Place, Places};
use crate::model::frame::{Edge, FrameId};
use crate::model::lagrangian::Lagrangian;
use crate::model::landmark::{self, Motion};
use crate::model::names::family::Family;
use crate::model::names::function::{Call, Function, Home};
use crate::model::names::part::Parts;
use crate::model::names::scope::Scope;
use crate::model::statement::gravity::Weights;
use crate::model::statement::output::Outputs;
use crate::model::statement::reaction::{Hold, Joint};
use crate::model::value::builtin::{self, CONSTANTS};
use crate::model::value::constant::{Dependence, Facts};
use crate::model::value::difference::Differences;
use crate::model::value::dimension::Dimension;
use crate::model::value::operator::Sum;
use crate::model::value::{Array, Free, Point, Pose, Scalar, Shape, Tensor, Value, shared};
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

/// Calls that a message about the body of a function shows.
const MAX_NOTES: usize = 3;

/// Everything that is known while the statements are gone through.
pub(in crate::model) struct Resolver<'d, 'g> {
    pub(in crate::model) graph: &'g Graph,
    pub(in crate::model) lagrangian: Lagrangian<'g>,
    pub(in crate::model) scope: Scope<'g>,
    pub(in crate::model) facts: Facts,
    /// Which expressions are sums of places.
    pub(in crate::model) differences: Differences<'g>,
    pub(in crate::model) errors: Diagnostics,
    /// What has been said, and where: loops would repeat it.
    said: HashSet<(usize, usize, String)>,
    pub(in crate::model) dimensionless: bool,
    /// The mechanism's own names, with what they are defined by.
    pub(in crate::model) definitions: BTreeMap<&'d str, Option<&'d Expression>>,
    /// The functions that may be called.
    pub(in crate::model) functions: BTreeMap<&'d str, Function<'d>>,
    /// Those that imported files may call.
    pub(in crate::model) shared: BTreeMap<&'d str, Function<'d>>,
    /// Those that have been called.
    pub(in crate::model) called: BTreeSet<&'d str>,
    /// The parts, and those that are being built.
    pub(in crate::model) parts: Parts<'d, 'g>,
    /// The calls that are being made, the outermost first.
    pub(in crate::model) calls: Vec<Call>,
    /// Calls so far.
    pub(in crate::model) calls_so_far: usize,
    /// The name that is being defined.
    pub(in crate::model) defining: Option<&'d str>,
    /// Masses and inertias, to be looked at when all is known.
    pub(in crate::model) physical: Vec<Physical<'g>>,
    /// The field that bodies weigh in, and the bodies that were declared as such.
    pub(in crate::model) weights: Weights<'g>,
    /// Where each kinetic, potential and lagrangian term and each constraint stands.
    pub(in crate::model) places: Places,
    /// Whether joints whose wrenches are asked for are held.
    pub(in crate::model) hold: Hold<'g>,
    /// These joints, as far as they have been met.
    pub(in crate::model) joints: Vec<Joint>,
    /// Of each constraint, which of its rows do not vanish.
    pub(in crate::model) effective_rows: Vec<Vec<bool>>,
    /// Where derivatives may fail.
    pub(in crate::model) sites: Sites<'g>,
    /// Turns of loops so far.
    pub(in crate::model) turns: usize,
    /// Blocks that are open: loops and choices.
    pub(in crate::model) depth_of_blocks: usize,
    /// Loops that are open.
    pub(in crate::model) loops: usize,
    /// Whether statements were passed over because of an error: what they would have done is not known.
    pub(in crate::model) gave_up: bool,
    /// Outputs, and arrays of them, as far as they have been met.
    pub(in crate::model) outputs: Vec<Outputs<'g>>,
    /// Arrays of constraints, as far as they have been met.
    pub(in crate::model) constraints: Vec<Family>,
    pub(in crate::model) depth: usize,
    /// Expressions looked at so far.
    steps: usize,
    exhausted: bool,
    /// The dimension of what the statement at hand declares, where it is an energy, a power or a force.
    pub(in crate::model) wanted: Option<Dimension>,
}

// ---- messages and limits

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn new(graph: &'g Graph, name: &str, dimensionless: bool) -> Self {
        Resolver {
            graph,
            lagrangian: Lagrangian::new(graph, name),
            scope: Scope::new(),
            facts: Facts::default(),
            differences: Differences::default(),
            errors: Diagnostics::default(),
            said: HashSet::new(),
            dimensionless,
            definitions: BTreeMap::new(),
            functions: BTreeMap::new(),
            shared: BTreeMap::new(),
            called: BTreeSet::new(),
            parts: Parts::default(),
            calls: Vec::new(),
            calls_so_far: 0,
            defining: None,
            physical: Vec::new(),
            weights: Weights::default(),
            places: Places::default(),
            hold: Hold::Always,
            joints: Vec::new(),
            effective_rows: Vec::new(),
            sites: Sites::new(),
            turns: 0,
            depth_of_blocks: 0,
            loops: 0,
            gave_up: false,
            outputs: Vec::new(),
            constraints: Vec::new(),
            depth: 0,
            steps: 0,
            exhausted: false,
            wanted: None,
        }
    }

    /// Notes an error, once: in a function together with the calls that led there.
    pub(in crate::model) fn refuse(
        &mut self,
        span: &Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Refused {
        let (mut message, help) = (message.into(), help.into());
        let (place, calls) = self.place(span);
        if let Some(call) = self.calls.iter().find(|call| call.home == Home::Library) {
            message = format!("in `{}`: {message}", call.name);
        }
        if self.said.insert((place.start, place.end, message.clone())) {
            let error = self.errors.error(place, message);
            if !help.is_empty() {
                error.help(help);
            }
            for (call, what) in calls {
                error.note(call, what);
            }
        }
        Refused
    }

    /// Whether this has been said about this place; from now on it has.
    pub(in crate::model) fn has_said(&mut self, place: &Span, what: &str) -> bool {
        !self.said.insert((place.start, place.end, what.to_string()))
    }

    /// Notes an error about what was built before, with the calls that had led there.
    pub(in crate::model) fn refuse_at(&mut self, at: &Place, message: impl Into<String>, help: impl Into<String>) {
        let (message, help) = (message.into(), help.into());
        let same: Vec<usize> = at.calls.iter().map(|(call, _)| call.start).collect();
        if self.said.insert((at.span.start, at.span.end, format!("{message} {same:?}"))) {
            let error = self.errors.error(at.span.clone(), message);
            if !help.is_empty() {
                error.help(help);
            }
            for (call, what) in &at.calls {
                error.note(call.clone(), what);
            }
        }
    }

    /// Notes a warning about what was built before, with the calls that had led there.
    pub(in crate::model) fn warn_at(&mut self, at: &Place, message: impl Into<String>) -> &mut Diagnostic {
        let warning = self.errors.warning(at.span.clone(), message);
        for (call, what) in &at.calls {
            warning.note(call.clone(), what);
        }
        warning
    }

    /// This place, for messages that come when all is built.
    pub(in crate::model) fn here(&self, span: &Span) -> Place {
        let (span, calls) = self.place(span);
        Place { span, calls }
    }

    /// Where a message about this place is shown, and the calls that led there, the innermost first.
    pub(in crate::model) fn place(&self, span: &Span) -> (Span, Vec<(Span, String)>) {
        // Nobody can look into a library function: the call of it is the place.
        let own = self.calls.iter().take_while(|call| call.home != Home::Library).count();
        let place = self.calls.get(own).map_or(span, |call| &call.span).clone();
        let calls = self.calls[..own].iter().rev().take(MAX_NOTES);
        (place, calls.map(|call| (call.span.clone(), call.described())).collect())
    }

    /// Whether the mechanism has outgrown its limit; says so once.
    pub(in crate::model) fn exhausted(&mut self, span: &Span) -> bool {
        if !self.exhausted && self.graph.len() > MAX_NODES {
            self.exhausted = true;
            let message = format!("the expressions of this mechanism grow beyond {MAX_NODES} nodes");
            self.refuse(span, message, "do loops repeat more than was meant, or do values double in each turn?");
        }
        if !self.exhausted && self.steps > MAX_STEPS {
            self.exhausted = true;
            let message = format!("this mechanism takes more than {MAX_STEPS} steps to evaluate");
            self.refuse(span, message, "do loops or functions repeat more than was meant?");
        }
        self.exhausted
    }

    /// As many steps, of what takes longer than others.
    pub(in crate::model) fn spend(&mut self, steps: usize) {
        self.steps += steps;
    }

    /// The dimension, where dimensions are looked at.
    pub(in crate::model) fn dimension(&self, dimension: Dimension) -> Dimension {
        if self.dimensionless { Dimension::ONE } else { dimension }
    }

    /// A dimension that may have run away.
    pub(in crate::model) fn bounded(&mut self, dimension: Option<Dimension>, span: &Span) -> Resolved<Dimension> {
        dimension.ok_or_else(|| self.refuse(span, "the exponents of this dimension are out of range", ""))
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
        self.depth -= 1;
        value
    }

    /// One level deeper, of expressions and of the functions that they call; the caller comes back up by itself.
    pub(in crate::model) fn deeper(&mut self, span: &Span) -> Resolved<()> {
        self.steps += 1;
        if self.exhausted(span) {
            return Err(Refused);
        }
        if self.depth == MAX_DEPTH {
            let message = format!("this is nested deeper than {MAX_DEPTH} levels");
            let help = match self.calls.is_empty() {
                true => "name the inner values with `let`",
                false => "the calls within calls count too",
            };
            return Err(self.refuse(span, message, help));
        }
        self.depth += 1;
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
            return Err(self.refuse(&span, message, "choose other units, or check the exponents"));
        }
        self.watch(&value, &span);
        self.defined(value, &span)
    }

    fn is_nonzero_constant(&mut self, value: &Value<'g>) -> bool {
        matches!(value, Value::Scalar(a) if self.facts.constant(a.expr).is_some_and(|number| !number.is_zero()))
    }

    fn is_zero_constant(&mut self, value: &Value<'g>) -> bool {
        matches!(value, Value::Scalar(a) if self.facts.constant(a.expr).is_some_and(Number::is_zero))
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
        self.watch(&value, span);
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
        self.watch(&value, span);
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
            && self.scope.get(name).is_some_and(|binding| binding.elements.is_some())
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
            None => Err(self.refuse(span, format!("`{text}` is not a number"), "")),
        }
    }

    pub(in crate::model) fn array(&mut self, values: Vec<Value<'g>>, span: &Span) -> Resolved<Value<'g>> {
        if values.is_empty() {
            return Err(self.refuse(span, "an array has at least one element", ""));
        }
        match Array::new(values) {
            Some(array) => Ok(Value::Array(array)),
            None => Err(self.refuse(span, "this array is too large or nested too deeply", "")),
        }
    }

    /// A number, if it is one: `sqrt(-2)` and the like are not.
    fn defined(&mut self, value: Value<'g>, span: &Span) -> Resolved<Value<'g>> {
        match value {
            Value::Scalar(scalar) if self.facts.dependence(scalar.expr).on(Dependence::UNDEFINED) => {
                Err(self.refuse(span, "this is not a finite real number", ""))
            }
            value => Ok(value),
        }
    }
}

// ---- names

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn name(&mut self, name: &str, span: &Span) -> Resolved<Value<'g>> {
        if let Some(binding) = self.scope.get(name) {
            if binding.elements.is_some() {
                return self.element(name, &[], span);
            }
            let value = binding.value.clone().ok_or(Refused);
            if let Ok(Value::Pose(_)) = value {
                self.scope.note_use(name, span);
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
        if let Some(origin) = self.scope.hidden(name) {
            let who = if self.scope.is_in_part() { "part" } else { "function" };
            let message = format!("`{name}` is {}: a {who} does not see it", origin.described());
            let help =
                format!("give it to the {who} as an argument; coordinates, parameters, inputs and constants it sees");
            return self.refuse(span, message, help);
        }
        if let Some(cycle) = self.cycle(name) {
            let message = format!("`{name}` is defined by itself: {}", cycle.join(" → "));
            return self.refuse(span, message, "a `let mut` can take a new value made of its old one: `x = x + …;`");
        }
        if self.definitions.contains_key(name) {
            let message = format!("`{name}` is declared further down");
            return self.refuse(span, message, "names are known from their declaration on: move it up");
        }
        if self.joints.iter().any(|joint| joint.family.name.text == name) {
            let message = format!("`{name}` is a reaction: it follows from the accelerations, and is no value here");
            let help = "state the load by what causes it, such as `mu*m*g`, or make it an input";
            return self.refuse(span, message, help);
        }
        let own = self.functions.get(name).map(Function::form);
        if let Some(form) = own.or(builtin::form_of_function(name).map(str::to_string)) {
            return self.refuse(span, format!("`{name}` is a function"), format!("write `{form}`"));
        }
        let known: Vec<&str> = self.scope.names().map(|(name, _)| name).chain(CONSTANTS).collect();
        let rate_of = ["_dot", "_d", "d"].iter().find_map(|end| name.strip_suffix(end).filter(|x| known.contains(x)));
        if let Some(variable) = rate_of {
            let help = format!("the rate of `{variable}` is `dt({variable})`");
            return self.refuse(span, format!("`{name}` is not declared"), help);
        }
        let help = match nearest(name, known) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("declare it: `param {name}: m = …;` or `let {name} = …;`"),
        };
        self.refuse(span, format!("`{name}` is not declared"), help)
    }

    /// From the name that is being defined through `name` back to it, where its definition leads there.
    fn cycle(&self, name: &str) -> Option<Vec<String>> {
        let start = self.defining?;
        let (&name, _) = self.definitions.get_key_value(name)?;
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
            for next in self.definitions.get(at).copied().flatten().map(names_in).unwrap_or_default() {
                if let Some((&next, _)) = self.definitions.get_key_value(next)
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
            return Err(self.refuse(&field.span, format!("there is no component `{}`", field.text), help));
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
                Err(self.refuse(&index.span, message, format!("indices run from 0 to {}", length - 1)))
            }
        }
    }

    /// A constant integer.
    pub(in crate::model) fn integer(&mut self, argument: &Argument<'g>, what: &str) -> Resolved<i64> {
        let Scalar { expr, dimension } = self.scalar(argument)?;
        match self.facts.integer(expr).filter(|_| dimension == Dimension::ONE || expr.is_zero()) {
            Some(value) => Ok(value),
            None => {
                let help = match expr.node() {
                    Node::Symbol(Symbol::Parameter(_)) => {
                        "a parameter may change at run time: declare it as `const name = …;`"
                    }
                    _ => "it is made of numbers, constants and loop variables",
                };
                Err(self.refuse(&argument.span, format!("{what} must be a constant integer"), help))
            }
        }
    }
}

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
        self.refuse(&argument.span, message, help)
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
        Err(self.refuse(span, format!("{what} must be {}, this is {}", in_words(wanted), in_words(found.0)), help))
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
                return Err(self.refuse(span, message, ""));
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
                        return Err(self.refuse(&argument.span, message, ""));
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
    fn velocity_in_world(&self, components: Vector<'g>) -> Option<Vector<'g>> {
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
        Err(self.refuse(&argument.span, message, "write its components in the axes of this pose: `[x, y, z]`"))
    }

    /// An edge of a pose; `None` where it does nothing.
    pub(in crate::model) fn edge(&mut self, edge: Edge<'g>, span: &Span) -> Resolved<Option<Edge<'g>>> {
        let motion: Vec<Expr<'g>> = match edge {
            Edge::Rotation { angle, .. } => vec![angle],
            Edge::Quaternion(q) => q.to_vec(),
            Edge::Translation(t) => t.0.to_vec(),
        };
        let dependence = motion.iter().map(|e| self.facts.dependence(*e)).fold(Dependence::default(), Dependence::or);
        if dependence.on(Dependence::INPUT) {
            let help = "the rate of an input is not known: make it a coordinate or a formula of `t`";
            return Err(self.refuse(span, "a pose cannot depend on an input", help));
        }
        if dependence.on(Dependence::RATE) {
            let help = "its own velocity would be an acceleration";
            return Err(self.refuse(span, "a pose cannot depend on a time derivative", help));
        }
        // A quaternion is still where its vector part is zero.
        let moving = if let Edge::Quaternion(_) = edge { &motion[1..] } else { &motion[..] };
        let still = moving.iter().all(|e| self.facts.constant(*e).is_some_and(Number::is_zero));
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

#[cfg(test)]
mod tests {
    use crate::expr::Graph;
    use crate::model::check::trial::{messages, near, refusals, refused, same, value, value_with_unit};
    use crate::parse::syntax::{
        BinaryOperator, Declaration, EnergyTerm, Expression, ExpressionKind, Name, Statement, StatementKind,
    };

    #[test]
    fn numbers_names_and_built_in_constants() {
        let check = |expression, expected: f64, unit: &str| {
            assert_eq!(value_with_unit("", expression), (vec![expected], unit.to_string()), "{expression}");
        };
        check("1/2", 0.5, "1");
        check("1e-3", 1e-3, "1");
        check("pi", std::f64::consts::PI, "1");
        check("180*deg", std::f64::consts::PI, "1");
        check("t", 0.25, "s");
        check("m", 2.0, "kg");
        check("x", 0.3, "m");
        check("q[1]", 1.3, "1");
        check("u", 1.5, "kg·m/s²");
        check("2^3^2", 512.0, "1");
        check("-2^2", -4.0, "1");
    }

    /// Nothing is turned into a frame's axes and back.
    #[test]
    fn velocities_along_axes_of_the_world_keep_their_digits() {
        let frame = "let pose = translation([x, 1e8*l, 0]) * rot_z(theta) * rot_y(y/l) * rot_x(x/l);";
        assert_eq!(value(frame, "dt(pose.origin()).x"), value("", "dt(x)"));
        assert_eq!(value(frame, "dt(pose.origin()).y"), value("", "0"));
        assert_eq!(value(frame, "dt(pose.origin()).z"), value("", "0"));
        let turning = "let arm = rot_z(theta) * translation([l, 0, 0]) * rot_y(y/l) * rot_x(x/l);";
        assert_eq!(value(turning, "dt(arm.origin()).z"), value("", "0"));
        near(&value(turning, "dt(arm.origin()).x"), &value("", "-l*sin(theta)*dt(theta)"), "a velocity");
    }

    #[test]
    fn components_and_elements() {
        near(&value("", "[x, y, z].y"), &[-0.7], "a component");
        near(&value("", "[[1, 2], [3, 4]][1][0]"), &[3.0], "an element");
        near(&value("const n = 2;", "[x, y, z][n]"), &[1.1], "an element by a constant");
        same(
            "let pose = translation([l, 0, 0]) * rot_z(theta);",
            "(pose * [x, y, z]).x",
            "x*cos(theta) - y*sin(theta)",
        );
        same(
            "let pose = translation([l, 0, 0]) * rot_z(theta);",
            "pose.point([x, y, z]).x",
            "l + x*cos(theta) - y*sin(theta)",
        );
        same("", "diag(1, 2, 3)[1][1]", "2");
        same("", "translation(x, 0, 0).origin()[0]", "x");
        refused("let a = q[2];", "2: the index 2 is out of range: there are 2 elements; indices run from 0 to 1");
        refused(
            "let a = q[0 - 1];",
            "0 - 1: the index -1 is out of range: there are 2 elements; indices run from 0 to 1",
        );
        refused(
            "let a = q[m/m];",
            "m/m: an index must be a constant integer; it is made of numbers, constants and loop variables",
        );
        refused(
            "let a = q[1/2];",
            "1/2: an index must be a constant integer; it is made of numbers, constants and loop variables",
        );
        refused(
            "let a = m[0];",
            "m: a number has no elements; arrays are declared with their length: `param mass[6]: kg = 1;`",
        );
        refused(
            "let a = [x, y, z].w;",
            "w: there is no component `w`; vectors and points have `.x`, `.y` and `.z`, along the axes of the world",
        );
        refused("let a = [x, y, z].norm;", "norm: there is no component `norm`; write `v.norm()`");
        refused("let a = x.x;", "x: expected a vector, found a number; a vector is written `[x, y, z]`");
    }

    #[test]
    fn unknown_names_get_the_nearest() {
        refused("let a = thetta;", "thetta: `thetta` is not declared; did you mean `theta`?");
        refused(
            "let a = mass_of_it;",
            "mass_of_it: `mass_of_it` is not declared; declare it: `param mass_of_it: m = …;` or `let mass_of_it = …;`",
        );
        refused("let a = theta_dot;", "theta_dot: `theta_dot` is not declared; the rate of `theta` is `dt(theta)`");
        refused("let a = sin;", "sin: `sin` is a function; write `sin(x)`");
        refused(
            "let a = late; let late = 1;",
            "late: `late` is declared further down; names are known from their declaration on: move it up",
        );
        // What is made of a refused value is refused without a word; the rest is looked at.
        assert_eq!(refusals("let a = nothing; let b = a + 1; let c = b * nowhere;").len(), 2);
        assert_eq!(refusals("let a = first_thing + second_thing;").len(), 2);
    }

    #[test]
    fn definitions_in_a_circle_are_named() {
        let help = "a `let mut` can take a new value made of its old one: `x = x + …;`";
        refused("let a = b; let b = a;", &format!("b: `b` is defined by itself: a → b → a; {help}"));
        refused(
            "let a = 1 + c; let b = 2*a; let c = -b;",
            &format!("c: `c` is defined by itself: a → c → b → a; {help}"),
        );
        refused("let a = a + 1;", &format!("a: `a` is defined by itself: a → a; {help}"));
        refused("param p: m = c; const c = p;", &format!("c: `c` is defined by itself: p → c → p; {help}"));
        assert!(refusals("for i in 0..2 { let m = m + m; kinetic += m*dt(x)^2; }").is_empty());
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        refused("let a = sqrt(-2);", "sqrt(-2): this is not a finite real number");
        refused("let a = 1 + ln(0);", "ln(0): this is not a finite real number");
        refused("let a = x/(1 - 1);", "(1 - 1): division by zero");
        refused("let a = 0^(-1);", "0: division by zero");
        refused("let a = 1e300 * 1e300;", "1e300 * 1e300: this is not a finite real number");
        refused("let a = asin(2) * x;", "asin(2): this is not a finite real number");
    }

    #[test]
    fn arrays_stay_small() {
        refused("let a = [];", "[]: an array has at least one element");
        let grown = refusals("let mut a = [1]; for i in 0..40 { a = [a, a]; }");
        assert_eq!(grown, ["[a, a]: this array is too large or nested too deeply"]);
    }

    #[test]
    fn runaway_models_are_stopped() {
        let doubling = "let mut p = world; for i in 0..60 { p = p * rot_z(theta) * p; kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, p); }";
        assert_eq!(
            refusals(doubling).last().map(|m| m.split_once(": ").unwrap().1.to_string()).as_deref(),
            Some(
                "the expressions of this mechanism grow beyond 2000000 nodes; do loops repeat more than was meant, or do values double in each turn?"
            )
        );
    }

    #[test]
    fn dimensionless_mechanisms_are_not_analysed() {
        let model = "coord x: 1; param l: m = 2; kinetic += dt(x)^2 + l*dt(x)^2; potential += sin(l) + x;";
        assert!(messages(&format!("#![dimensionless] mechanism A {{ {model} }}")).is_empty());
        assert_eq!(messages(&format!("mechanism A {{ {model} }}")).len(), 2);
    }

    fn expression(kind: ExpressionKind) -> Expression {
        Expression { kind, span: 0..0 }
    }

    fn number(text: &str) -> Expression {
        expression(ExpressionKind::Number(text.to_string()))
    }

    fn declaration(value: Expression) -> Declaration {
        let name = Name { text: "A".to_string(), span: 0..0 };
        let kind = StatementKind::Energy { term: EnergyTerm::Kinetic, value };
        let statements = vec![Statement { kind, span: 0..0 }];
        let (imports, imported) = (Vec::new(), Vec::new());
        Declaration { dimensionless: false, imports, imported, name, docs: Vec::new(), statements }
    }

    /// Built by hand, past the parser.
    #[test]
    fn no_syntax_tree_panics() {
        let deep = |wrap: fn(Box<Expression>) -> ExpressionKind, levels: usize| {
            (0..levels).fold(number("1"), |inner, _| expression(wrap(Box::new(inner))))
        };
        let left = |a| ExpressionKind::Binary(BinaryOperator::Add, a, Box::new(number("1")));
        let right = |a| ExpressionKind::Binary(BinaryOperator::Pow, Box::new(number("1")), a);
        for value in [
            number("1.2.3"),
            number(""),
            deep(ExpressionKind::Negate, 400),
            deep(|a| ExpressionKind::Array(vec![*a]), 400),
            deep(|a| ExpressionKind::Method(a, Name { text: "norm".to_string(), span: 0..0 }, Vec::new()), 400),
            deep(right, 400),
            deep(left, 100_000),
        ] {
            let graph = Graph::verbatim();
            assert!(crate::model::resolve(&declaration(value), &graph).is_err());
        }
    }
}
