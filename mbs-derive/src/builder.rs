//! A mechanism written as Rust values: in a build script, from a table, from another format, by a loop.
//!
//! Every call records what the statement or operator of the language of the same name says, and where it was made. The
//! passes read the record as they read a text: dimensions, axes, places, degrees and proofs are looked at alike, and a
//! report names the call, by file, line and column, where it would underline a text. What a message calls `at_12_9` is
//! the value that the call at line 12, column 9 gave.
//!
//! Loops, functions and parts are those of Rust. Missing here: matrices other than the six entries of an inertia;
//! arrays of constraints, outputs, signals and positive parameters; meshes; comparisons other than `<`, which is
//! [`Scalar::below`].
//!
//! ```
//! use mbs_derive::builder::{Mechanism, Vector, particle};
//!
//! let mut pendulum = Mechanism::new("Pendulum", "A bob on a thread.");
//! let m = pendulum.param("m", "kg", 1.0);
//! let length = pendulum.param("length", "m", 0.5);
//! let g = pendulum.param("g", "m/s^2", 9.81);
//! let theta = pendulum.coord("theta", "rad");
//! let bob = Vector::new(&length * theta.sin(), 0.0, -&length * theta.cos());
//! pendulum.kinetic(particle(&m, &bob));
//! pendulum.potential(m * g * bob.z());
//! pendulum.output("tip", &bob);
//! let module = pendulum.generate(&Default::default()).unwrap();
//! assert_eq!((module.name.as_str(), module.dof), ("Pendulum", 1));
//! ```
//!
//! In reading order: `term`: the values, their operators and functions; here: the mechanism and its statements.

mod term;

use std::collections::{BTreeMap, HashMap};
use std::panic::Location;
use std::rc::Rc;

use crate::diagnostic::{Code, Diagnostics};
use crate::parse;
use crate::parse::syntax::{
    Comparison, Declaration, EnergyTerm, Expression, ExpressionKind, Name, Quantity, Statement, StatementKind, Unit,
};
use crate::source::{Place, Sources};
use crate::span::Span;
use term::{Kind, Node, Term};

pub use term::{Pose, Scalar, Value, Vector, angular_velocity, particle, quantity, rigid_body, time};

/// A mechanism that is being written, statement by statement.
///
/// ```
/// use mbs_derive::builder::Mechanism;
/// let mut trolley = Mechanism::new("Trolley", "A mass on a rail, pushed.");
/// let m = trolley.param("m", "kg", 2.0);
/// let x = trolley.coord("x", "m");
/// let push = trolley.input("push", "N");
/// trolley.kinetic(m * x.dt().pow(2.0) / 2.0);
/// trolley.force(&x, push);
/// let module = trolley.generate(&Default::default()).unwrap();
/// assert_eq!((module.dof, module.inputs), (1, 1));
/// ```
#[derive(Debug)]
pub struct Mechanism {
    name: String,
    /// Where it was begun.
    begun: Place,
    /// Where statements are said to be made, if that is not where they are.
    at: Option<Place>,
    docs: Vec<String>,
    /// The documentation of what is declared next.
    next: Vec<String>,
    dimensionless: bool,
    statements: Vec<Statement>,
    /// Values that may be used again have names; kept, so that no other value takes their address.
    named: HashMap<*const Node, (Term, String)>,
    /// How many values each call has given names to.
    taken: BTreeMap<(u32, u32), usize>,
    /// The calls that spans count.
    calls: Vec<Place>,
    numbers: HashMap<Place, usize>,
    errors: Diagnostics,
}

impl Mechanism {
    /// A mechanism without statements; `doc` is its documentation in the generated code, as `///` before `mechanism`.
    #[track_caller]
    pub fn new(name: &str, doc: &str) -> Self {
        let begun = Place::from(Location::caller());
        let mut mechanism = Mechanism {
            name: name.to_string(),
            begun,
            at: None,
            docs: lines(doc),
            next: Vec::new(),
            dimensionless: false,
            statements: Vec::new(),
            named: HashMap::new(),
            taken: BTreeMap::new(),
            calls: Vec::new(),
            numbers: HashMap::new(),
            errors: Diagnostics::default(),
        };
        let place = mechanism.place(begun);
        if mechanism.parsed(&format!("mechanism {name} {{ }}"), &place).is_some_and(|read| read.name.text != name) {
            mechanism.errors.error(Code::NotAName, place, format!("`{name}` is no name"));
        }
        mechanism
    }

    /// No dimensional analysis, as `#![dimensionless]`.
    pub fn dimensionless(&mut self) {
        self.dimensionless = true;
    }

    /// Documents what is declared next, as `///` before it.
    pub fn doc(&mut self, text: &str) {
        self.next.extend(lines(text));
    }

    /// Reports say of the statements that follow, and before the first of them of the mechanism's name, that they were
    /// made there, for those who write mechanisms in another language; values are moved by [`Scalar::at`] and its like.
    ///
    /// ```
    /// use mbs_derive::{builder::Mechanism, source::Place};
    /// let mut wrong = Mechanism::new("Wrong", "");
    /// wrong.at(Place { file: "model.py", line: 7, column: 3 });
    /// let x = wrong.coord("x", "m");
    /// wrong.potential(&x);
    /// let error = wrong.generate(&Default::default()).unwrap_err();
    /// assert!(error.render_in(&wrong.sources()).contains("--> model.py:7:3"));
    /// ```
    pub fn at(&mut self, place: Place) {
        if self.at.is_none() && self.statements.is_empty() {
            self.begun = place;
            self.calls[0] = place;
        }
        self.at = Some(place);
    }

    fn here(&self, made: &'static Location<'static>) -> Place {
        self.at.unwrap_or_else(|| made.into())
    }

    // ---- declarations

    /// `param name: unit = default;`
    #[track_caller]
    pub fn param(&mut self, name: &str, unit: &str, default: f64) -> Scalar {
        self.parameter(name, unit, &[default], false, None, self.here(Location::caller())).remove(0)
    }

    /// `param name: unit = default, positive;`: refused at run time where it is not.
    #[track_caller]
    pub fn positive(&mut self, name: &str, unit: &str, default: f64) -> Scalar {
        self.parameter(name, unit, &[default], true, None, self.here(Location::caller())).remove(0)
    }

    /// `param name[n]: unit = [defaults];`
    #[track_caller]
    pub fn params(&mut self, name: &str, unit: &str, defaults: &[f64]) -> Vec<Scalar> {
        self.parameter(name, unit, defaults, false, Some(defaults.len()), self.here(Location::caller()))
    }

    fn parameter(
        &mut self,
        name: &str,
        unit: &str,
        defaults: &[f64],
        positive: bool,
        length: Option<usize>,
        call: Place,
    ) -> Vec<Scalar> {
        let place = self.place(call);
        let mut values: Vec<_> = defaults.iter().map(|&default| self.number(default, &place)).collect();
        let value = match length {
            Some(_) => expression(ExpressionKind::Array(values), &place),
            None => values.remove(0),
        };
        let positive = positive.then(|| place.clone());
        self.declare("param", name, unit, length, Some(value), positive, call)
    }

    /// `coord name: unit;`
    #[track_caller]
    pub fn coord(&mut self, name: &str, unit: &str) -> Scalar {
        self.declare("coord", name, unit, None, None, None, self.here(Location::caller())).remove(0)
    }

    /// `coord name[n]: unit;`
    #[track_caller]
    pub fn coords(&mut self, name: &str, n: usize, unit: &str) -> Vec<Scalar> {
        self.declare("coord", name, unit, Some(n), None, None, self.here(Location::caller()))
    }

    /// `input name: unit;`
    #[track_caller]
    pub fn input(&mut self, name: &str, unit: &str) -> Scalar {
        self.declare("input", name, unit, None, None, None, self.here(Location::caller())).remove(0)
    }

    /// `input name[n]: unit;`
    #[track_caller]
    pub fn inputs(&mut self, name: &str, n: usize, unit: &str) -> Vec<Scalar> {
        self.declare("input", name, unit, Some(n), None, None, self.here(Location::caller()))
    }

    /// `prescribed name: unit;`: a motion that is given at run time, with its first and second derivative.
    #[track_caller]
    pub fn signal(&mut self, name: &str, unit: &str) -> Scalar {
        self.declare("prescribed", name, unit, None, None, None, self.here(Location::caller())).remove(0)
    }

    /// `prescribed name: unit = formula;`: a motion that is a formula of the [`time`].
    #[track_caller]
    pub fn prescribed(&mut self, name: &str, unit: &str, formula: impl Into<Scalar>) -> Scalar {
        let formula = self.value(formula.into().0, self.here(Location::caller()));
        self.declare("prescribed", name, unit, None, Some(formula), None, self.here(Location::caller())).remove(0)
    }

    /// One parse of the declaration as text says whether name and unit are good.
    fn declare(
        &mut self,
        keyword: &str,
        name: &str,
        unit: &str,
        length: Option<usize>,
        value: Option<Expression>,
        positive: Option<Span>,
        call: Place,
    ) -> Vec<Scalar> {
        let place = self.place(call);
        let docs = std::mem::take(&mut self.next);
        // Behind a unit; what is written there already is then none.
        let default = if matches!(keyword, "param" | "prescribed") { " = 1" } else { "" };
        if let Some(unit) = self.one(&format!("{keyword} {name}: {unit}{default};"), name, &place).and_then(unit_of) {
            let length = length.map(|n| expression(ExpressionKind::Number(n.to_string()), &place));
            let name = named(name, &place);
            let unit = Some(moved(unit, &place));
            let quantity = Quantity { docs, name, length, columns: None, unit, value, positive };
            let kind = match keyword {
                "param" => StatementKind::Param(quantity),
                "coord" => StatementKind::Coord(quantity),
                "input" => StatementKind::Input(quantity),
                _ => StatementKind::Prescribed(quantity),
            };
            self.push(kind, &place);
        }
        match length {
            None => vec![Scalar(Term::leaf(Kind::Name(name.to_string())))],
            Some(n) => (0..n).map(|i| Scalar(Term::leaf(Kind::Element(name.to_string(), i)))).collect(),
        }
    }

    // ---- energies and forces

    /// `kinetic += energy;`
    #[track_caller]
    pub fn kinetic(&mut self, energy: impl Into<Scalar>) {
        self.energy(EnergyTerm::Kinetic, energy.into(), self.here(Location::caller()));
    }

    /// `potential += energy;`
    #[track_caller]
    pub fn potential(&mut self, energy: impl Into<Scalar>) {
        self.energy(EnergyTerm::Potential, energy.into(), self.here(Location::caller()));
    }

    /// `dissipation += power;`: Rayleigh's function.
    #[track_caller]
    pub fn dissipation(&mut self, power: impl Into<Scalar>) {
        self.energy(EnergyTerm::Dissipation, power.into(), self.here(Location::caller()));
    }

    /// `lagrangian += energy;`: a term of L that is neither T nor −V.
    #[track_caller]
    pub fn lagrangian(&mut self, energy: impl Into<Scalar>) {
        self.energy(EnergyTerm::Lagrangian, energy.into(), self.here(Location::caller()));
    }

    fn energy(&mut self, term: EnergyTerm, value: Scalar, call: Place) {
        let value = self.value(value.0, call);
        self.state(StatementKind::Energy { term, value }, call);
    }

    /// `gravity acceleration;`: the uniform field that all bodies weigh in.
    #[track_caller]
    pub fn gravity(&mut self, acceleration: impl Into<Vector>) {
        let call = self.here(Location::caller());
        let acceleration = self.value(acceleration.into().0, call);
        self.state(StatementKind::Gravity { acceleration }, call);
    }

    /// `force coordinate += force;`: a generalized force, as it acts on the mechanism.
    #[track_caller]
    pub fn force(&mut self, coordinate: &Scalar, force: impl Into<Scalar>) {
        let call = self.here(Location::caller());
        let (place, value) = (self.place(call), self.value(force.into().0, call));
        let (name, index) = match &coordinate.0.0.kind {
            Kind::Name(name) => (name, None),
            Kind::Element(name, i) => (name, Some(expression(ExpressionKind::Number(i.to_string()), &place))),
            _ => {
                let error = self.errors.error(
                    Code::ForceTarget,
                    place,
                    "a generalized force acts on a coordinate, this is a formula",
                );
                error.help("give `force` what `coord` or `coords` returned; forces on places are `force_at`");
                return;
            }
        };
        self.push(StatementKind::Force { coordinate: named(name, &place), index, value }, &place);
    }

    /// `force at point += force;`, in N.
    #[track_caller]
    pub fn force_at(&mut self, point: impl Into<Vector>, force: impl Into<Vector>) {
        let call = self.here(Location::caller());
        let (point, value) = (self.value(point.into().0, call), self.value(force.into().0, call));
        self.state(StatementKind::ForceAt { point, value }, call);
    }

    /// `torque on pose += torque;`, in N·m.
    #[track_caller]
    pub fn torque_on(&mut self, pose: &Pose, torque: impl Into<Vector>) {
        let call = self.here(Location::caller());
        let (pose, value) = (self.value(pose.0.clone(), call), self.value(torque.into().0, call));
        self.state(StatementKind::TorqueOn { pose, value }, call);
    }

    // ---- constraints, outputs, reactions

    /// `constraint name: left = right;`: holonomic where no velocity occurs, else linear in the velocities.
    #[track_caller]
    pub fn constraint<V: Value>(&mut self, name: &str, left: &V, right: &V) {
        let call = self.here(Location::caller());
        let (left, right) = (self.value(left.term(), call), self.value(right.term(), call));
        let (place, docs) = (self.place(call), std::mem::take(&mut self.next));
        if self.one(&format!("constraint {name}: x = 0;"), name, &place).is_some() {
            let name = named(name, &place);
            self.push(StatementKind::Constraint { docs, name, index: None, left, right }, &place);
        }
    }

    /// `output name = value;`: its value, velocity and Jacobian are generated.
    #[track_caller]
    pub fn output<V: Value>(&mut self, name: &str, value: &V) {
        self.add_output(name, value.term(), false, self.here(Location::caller()));
    }

    /// `output name = value, jacobian_rate;`: the rate of its Jacobian is generated, too.
    #[track_caller]
    pub fn output_with_jacobian_rate<V: Value>(&mut self, name: &str, value: &V) {
        self.add_output(name, value.term(), true, self.here(Location::caller()));
    }

    fn add_output(&mut self, name: &str, value: Term, jacobian_rate: bool, call: Place) {
        let value = self.value(value, call);
        let (place, docs) = (self.place(call), std::mem::take(&mut self.next));
        if self.one(&format!("output {name} = 1;"), name, &place).is_some() {
            let (name, jacobian_rate) = (named(name, &place), jacobian_rate.then(|| place.clone()));
            self.push(StatementKind::Output { docs, name, index: None, value, jacobian_rate }, &place);
        }
    }

    /// `reaction name at pose;`: what the part before the joint exerts on the part behind it, which is what is built on
    /// the pose that is returned.
    #[must_use = "on what is not built on this pose the joint exerts nothing"]
    #[track_caller]
    pub fn reaction(&mut self, name: &str, pose: impl Into<Pose>) -> Pose {
        let call = self.here(Location::caller());
        let (place, value) = (self.place(call), self.value(pose.into().0, call));
        let (docs, local) = (std::mem::take(&mut self.next), self.fresh(call));
        self.push(StatementKind::Let { mutable: false, name: named(&local, &place), value }, &place);
        if self.one(&format!("reaction {name} at x;"), name, &place).is_some() {
            let (name, pose) = (named(name, &place), named(&local, &place));
            self.push(StatementKind::Reaction { docs, name, index: None, pose, element: Vec::new() }, &place);
        }
        Pose(Term::leaf(Kind::Name(local)))
    }

    // ---- drawing

    /// `shape pose += box([x, y, z]);`: centred at the origin of the pose, edges along its axes.
    #[track_caller]
    pub fn draw_box(&mut self, pose: &Pose, edges: impl Into<Vector>) {
        self.shape("box", pose, vec![edges.into().0], self.here(Location::caller()));
    }

    /// `shape pose += cylinder(radius, length);`: along z.
    #[track_caller]
    pub fn draw_cylinder(&mut self, pose: &Pose, radius: impl Into<Scalar>, length: impl Into<Scalar>) {
        self.shape("cylinder", pose, vec![radius.into().0, length.into().0], self.here(Location::caller()));
    }

    /// `shape pose += sphere(radius);`
    #[track_caller]
    pub fn draw_sphere(&mut self, pose: &Pose, radius: impl Into<Scalar>) {
        self.shape("sphere", pose, vec![radius.into().0], self.here(Location::caller()));
    }

    fn shape(&mut self, kind: &str, pose: &Pose, sizes: Vec<Term>, call: Place) {
        let (pose, sizes) = (self.value(pose.0.clone(), call), sizes.into_iter().map(|size| self.value(size, call)));
        let (sizes, place) = (sizes.collect(), self.place(call));
        self.push(StatementKind::Shape { pose, kind: named(kind, &place), file: None, sizes }, &place);
    }

    // ---- what the passes read

    /// The record, and the calls that its spans count.
    ///
    /// # Errors
    /// Names, units and numbers that are none.
    pub(crate) fn declaration(&self) -> Result<Declaration, Diagnostics> {
        self.errors.clone().finish(Declaration {
            dimensionless: self.dimensionless,
            imports: Vec::new(),
            imported: Vec::new(),
            name: named(&self.name, &(0..1)),
            docs: self.docs.clone(),
            statements: self.statements.clone(),
            of_robots: 0,
            warnings: Diagnostics::default(),
        })
    }

    /// Where reports say that its calls are.
    pub fn sources(&self) -> Sources {
        Sources::of_calls(self.begun.file, self.calls.clone())
    }

    fn state(&mut self, kind: StatementKind, call: Place) {
        let place = self.place(call);
        self.push(kind, &place);
    }

    fn push(&mut self, kind: StatementKind, place: &Span) {
        self.statements.push(Statement { kind, span: place.clone() });
    }

    fn place(&mut self, call: Place) -> Span {
        let next = self.calls.len();
        let number = *self.numbers.entry(call).or_insert(next);
        if number == next {
            self.calls.push(call);
        }
        number..number + 1
    }

    /// What a text says; its mistakes are those of the call.
    fn parsed(&mut self, text: &str, place: &Span) -> Option<Declaration> {
        parse::declaration(text).map_err(|errors| self.errors.append(errors.at(place))).ok()
    }

    /// The one statement of this name that a text holds.
    fn one(&mut self, text: &str, name: &str, place: &Span) -> Option<Statement> {
        let mut read = self.parsed(&format!("mechanism A {{ {text} }}"), place)?.statements;
        match (read.pop(), read.is_empty()) {
            (Some(statement), true) if name.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_') => Some(statement),
            _ => {
                self.errors.error(Code::NotAName, place.clone(), format!("`{name}` is no name, or its unit is none"));
                None
            }
        }
    }

    /// A name that the value of a call has in messages.
    fn fresh(&mut self, call: Place) -> String {
        let (line, column) = (call.line, call.column);
        let count = self.taken.entry((line, column)).or_insert(0);
        *count += 1;
        if *count == 1 { format!("at_{line}_{column}") } else { format!("at_{line}_{column}_{count}") }
    }

    /// The value as the expression of a statement. What may be used again, because somebody holds it, is a `let`
    /// before.
    fn value(&mut self, root: Term, call: Place) -> Expression {
        let mut done: HashMap<*const Node, Expression> = HashMap::new();
        let mut waiting = vec![(&root, false)];
        while let Some((term, is_ready)) = waiting.pop() {
            let key = Rc::as_ptr(&term.0);
            if term.is_leaf() || self.named.contains_key(&key) {
                continue;
            }
            if !is_ready {
                waiting.push((term, true));
                waiting.extend(term.0.operands.iter().rev().map(|operand| (operand, false)));
                continue;
            }
            let at = term.0.call.unwrap_or(call);
            let place = self.place(at);
            let operands = term.0.operands.iter().map(|operand| self.operand(operand, &mut done, &place)).collect();
            let value = expression(combined(&term.0.kind, operands, &place), &place);
            if term.is_kept() {
                let name = self.fresh(at);
                self.push(StatementKind::Let { mutable: false, name: named(&name, &place), value }, &place);
                self.named.insert(key, (term.clone(), name));
            } else {
                done.insert(key, value);
            }
        }
        let place = self.place(call);
        self.operand(&root, &mut done, &place)
    }

    fn operand(&mut self, term: &Term, done: &mut HashMap<*const Node, Expression>, place: &Span) -> Expression {
        let key = Rc::as_ptr(&term.0);
        if let Some((_, name)) = self.named.get(&key) {
            return expression(ExpressionKind::Name(name.clone()), place);
        }
        match &term.0.kind {
            Kind::Number(number) => self.number(*number, place),
            Kind::Quantity(number, unit) => {
                let unit = self.one(&format!("param x: {unit} = 1;"), "x", place).and_then(unit_of);
                self.decimal(*number, unit, place)
            }
            Kind::Name(name) => expression(ExpressionKind::Name(name.clone()), place),
            Kind::Element(name, i) => {
                let array = expression(ExpressionKind::Name(name.clone()), place);
                let index = expression(ExpressionKind::Number(i.to_string()), place);
                expression(ExpressionKind::Index(Box::new(array), Box::new(index)), place)
            }
            _ => done.remove(&key).expect("operands come first"),
        }
    }

    fn number(&mut self, number: f64, place: &Span) -> Expression {
        self.decimal(number, None, place)
    }

    /// The shortest decimal of a number, which is what it stands for exactly.
    fn decimal(&mut self, number: f64, unit: Option<Unit>, place: &Span) -> Expression {
        if !number.is_finite() {
            self.errors.error(Code::NotANumber, place.clone(), format!("{number} is not finite"));
        }
        let text = format!("{:?}", number.abs());
        let text = text.strip_suffix(".0").unwrap_or(&text).to_string();
        let size = match unit {
            Some(unit) => expression(ExpressionKind::Quantity(text, moved(unit, place)), place),
            None => expression(ExpressionKind::Number(text), place),
        };
        if number < 0.0 { expression(ExpressionKind::Negate(Box::new(size)), place) } else { size }
    }
}

fn lines(doc: &str) -> Vec<String> {
    doc.lines().map(str::to_string).collect()
}

fn named(text: &str, place: &Span) -> Name {
    Name { text: text.to_string(), span: place.clone() }
}

fn expression(kind: ExpressionKind, place: &Span) -> Expression {
    Expression { kind, span: place.clone() }
}

fn unit_of(statement: Statement) -> Option<Unit> {
    match statement.kind {
        StatementKind::Param(quantity)
        | StatementKind::Coord(quantity)
        | StatementKind::Input(quantity)
        | StatementKind::Prescribed(quantity) => quantity.unit,
        _ => None,
    }
}

fn moved(mut unit: Unit, place: &Span) -> Unit {
    unit.span = place.clone();
    unit.factors.iter_mut().for_each(|factor| factor.name.span = place.clone());
    unit
}

/// An operator or function, of its operands.
fn combined(kind: &Kind, operands: Vec<Expression>, place: &Span) -> ExpressionKind {
    let mut operands = operands.into_iter();
    let mut next = || Box::new(operands.next().expect("as many operands as it takes"));
    match kind {
        Kind::Negate => ExpressionKind::Negate(next()),
        Kind::Binary(operator) => ExpressionKind::Binary(*operator, next(), next()),
        Kind::Field(name) => ExpressionKind::Field(next(), named(name, place)),
        Kind::Method(name) => ExpressionKind::Method(next(), named(name, place), operands.collect()),
        Kind::Call(name) => ExpressionKind::Call(named(name, place), operands.collect()),
        Kind::Array => ExpressionKind::Array(operands.collect()),
        Kind::Less => {
            let condition = ExpressionKind::Compare(Comparison::Less, next(), next());
            ExpressionKind::If(Box::new(expression(condition, place)), next(), next())
        }
        Kind::Number(_) | Kind::Quantity(..) | Kind::Name(_) | Kind::Element(..) => {
            unreachable!("leaves have no operands")
        }
    }
}

#[cfg(test)]
mod tests;
