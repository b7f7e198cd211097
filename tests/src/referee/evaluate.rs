//! The statements of a mechanism carried out at a state, one after the other, as the manual says.

use std::rc::Rc;

use super::mechanism::Mechanism;
use super::number::Real;
use super::syntax::{Declaration, Expression, Kind, Statement};
use super::unit;
use super::value::{Mixing, Moving, Pose, Shared, Triple, Value, dot, moving, number};
use super::wide::{degree, pi};

mod arithmetic;
mod element;

use element::{entry, holds_body, path, spread};

/// Everything that a mechanism's functions may take.
#[derive(Clone, Debug)]
pub(super) struct State<S> {
    pub(super) t: S,
    pub(super) q: Vec<S>,
    pub(super) qd: Vec<S>,
    pub(super) qdd: Vec<S>,
    pub(super) u: Vec<S>,
    /// Value, rate and acceleration of the signals without a formula, 0 for the others.
    pub(super) prescribed: Vec<[S; 3]>,
    pub(super) parameters: Vec<S>,
}

impl<S: Copy> State<S> {
    /// The state in other numbers.
    pub(super) fn map<R>(&self, f: &mut impl FnMut(S) -> R) -> State<R> {
        let State { t, q, qd, qdd, u, prescribed, parameters } = self;
        let mut all = |values: &[S]| values.iter().map(|&x| f(x)).collect::<Vec<R>>();
        let (q, qd, qdd, u, parameters) = (all(q), all(qd), all(qdd), all(u), all(parameters));
        let prescribed = prescribed.iter().map(|signal| signal.map(&mut *f)).collect();
        State { t: f(*t), q, qd, qdd, u, prescribed, parameters }
    }
}

/// A constraint: φ, or the rows that are linear in the velocities.
#[derive(Clone, Debug)]
pub(super) struct Row<S> {
    pub(super) components: Vec<Moving<S>>,
}

/// What the statements add up to.
#[derive(Clone, Debug)]
pub(super) struct Sums<S> {
    pub(super) kinetic: Moving<S>,
    pub(super) potential: Moving<S>,
    /// The terms of D.
    pub(super) dissipation: Vec<Moving<S>>,
    pub(super) lagrangian: Moving<S>,
    /// Forces on coordinates.
    pub(super) forces: Vec<(usize, Moving<S>)>,
    /// Places or rotations of poses, by their rates, and what does work on them.
    pub(super) works: Vec<(Triple<S>, Triple<S>)>,
    pub(super) constraints: Vec<Row<S>>,
    pub(super) outputs: Vec<(Rc<str>, Shared<S>)>,
    pub(super) joints: Vec<(Rc<str>, usize)>,
    /// Masses and mass centres of declared bodies, and what gravity accelerates them with.
    bodies: Vec<(Moving<S>, Triple<S>)>,
    gravity: Option<Triple<S>>,
}

/// A name and its value.
type Bound<S> = (Rc<str>, Shared<S>);

/// A coordinate, and how many follow if it is an array.
type Place = (usize, Option<usize>);

/// A part that is gone through.
struct Instance {
    path: String,
    /// Arguments that are coordinates: the first one, and how many if they are an array.
    coordinates: Vec<(Rc<str>, Place)>,
}

pub(super) struct Evaluator<'m, S> {
    pub(super) mechanism: &'m Mechanism,
    state: &'m State<S>,
    globals: Vec<Bound<S>>,
    locals: Vec<Bound<S>>,
    /// Parts with an index, which are seen behind the loop that they stand in.
    arrays: Vec<Bound<S>>,
    /// The parts that are gone through: what their names begin with, and which coordinates their arguments are.
    within: Vec<Instance>,
    /// How many coordinates, signals, inputs and parameters have been declared so far.
    declared: [usize; 4],
    mixing: Mixing<S>,
    pub(super) sums: Sums<S>,
}

impl<'m, S: Real> Evaluator<'m, S> {
    pub(super) fn new(mechanism: &'m Mechanism, state: &'m State<S>) -> Self {
        let sums = Sums {
            kinetic: number(0.0),
            potential: number(0.0),
            dissipation: Vec::new(),
            lagrangian: number(0.0),
            forces: Vec::new(),
            works: Vec::new(),
            constraints: Vec::new(),
            outputs: Vec::new(),
            joints: Vec::new(),
            bodies: Vec::new(),
            gravity: None,
        };
        // Behind the coordinates stand three shifts and three turns of each joint.
        let turns = (mechanism.dof()..state.q.len()).filter(|i| (i - mechanism.dof()) % 6 >= 3);
        let angles = mechanism.angles.iter().copied().filter(|&i| i < state.q.len()).chain(turns);
        let angles: Vec<_> = angles.map(|i| moving(state.q[i], state.qd[i], state.qdd[i])).collect();
        let mixing = Mixing::new(&angles);
        Evaluator {
            mechanism,
            state,
            globals: Vec::new(),
            locals: Vec::new(),
            arrays: Vec::new(),
            within: Vec::new(),
            declared: [0; 4],
            mixing,
            sums,
        }
    }

    /// Carries out all statements.
    pub(super) fn run(mut self) -> Result<Sums<S>, String> {
        let mechanism = self.mechanism;
        self.block(&mechanism.statements)?;
        if let Some(gravity) = self.sums.gravity {
            let mixing = &self.mixing;
            let weights = self.sums.bodies.iter().map(|(mass, centre)| *mass * dot(&gravity, &mixing.place(centre)));
            self.sums.potential = weights.fold(self.sums.potential, |sum, weight| sum - weight);
        }
        Ok(self.sums)
    }

    fn block(&mut self, statements: &[Statement]) -> Result<(), String> {
        let depth = self.locals.len();
        for statement in statements {
            self.statement(statement)?;
        }
        self.locals.truncate(depth);
        Ok(())
    }

    fn statement(&mut self, statement: &Statement) -> Result<(), String> {
        match statement {
            Statement::Declaration(declaration) => self.declaration(declaration)?,
            Statement::Function { .. } | Statement::Part { .. } => {}
            Statement::Instance { part, name, index, arguments } => {
                self.instance(part, name, index.as_ref(), arguments)?
            }
            Statement::Let { name, value } => {
                let value = self.value(value)?;
                self.locals.push((name.clone(), value));
            }
            Statement::Array { name, lengths } => {
                let empty = Rc::new(Value::Truth(false));
                let lengths = lengths.iter().map(|length| self.integer(length)).collect::<Result<Vec<_>, _>>()?;
                let array =
                    lengths.iter().rev().fold(empty, |entry, &n| Rc::new(Value::Array(vec![entry; n as usize])));
                self.locals.push((name.clone(), array));
            }
            Statement::Assign { name, indices, value } => {
                let value = self.value(value)?;
                *self.place_of(name, indices)? = value;
            }
            Statement::Choice { blocks } => {
                for (condition, body) in blocks {
                    let taken = match condition {
                        Some(condition) => self.value(condition)?.truth()?,
                        None => true,
                    };
                    if taken {
                        return self.block(body);
                    }
                }
            }
            Statement::Gravity { value } => self.sums.gravity = Some(self.value(value)?.vector()?),
            Statement::Energy { sum, value } => {
                if sum == "kinetic" {
                    self.weigh(value, number(1.0))?;
                }
                let value = self.number(value)?;
                let sum = match sum.as_str() {
                    "kinetic" => &mut self.sums.kinetic,
                    "potential" => &mut self.sums.potential,
                    "dissipation" => {
                        self.sums.dissipation.push(value);
                        return Ok(());
                    }
                    _ => &mut self.sums.lagrangian,
                };
                *sum = *sum + value;
            }
            Statement::Force { name, index, value } => self.force(name, index.as_ref(), value)?,
            Statement::ForceAt { place, value } => {
                let place = self.value(place)?.vector()?;
                let force = self.value(value)?.vector()?;
                self.sums.works.push((super::value::rates(&place), self.mixing.vector(&force)));
            }
            Statement::TorqueOn { pose, value } => {
                let turning = self.value(pose)?.pose()?.angular_velocity();
                let torque = self.value(value)?.vector()?;
                self.sums.works.push((turning, self.mixing.vector(&torque)));
            }
            Statement::Reaction { name, index, pose } => self.reaction(name, index.as_ref(), pose)?,
            Statement::Constraint { left, right } => self.constraint(left, right)?,
            Statement::Output { name, index, value } => {
                let index = index.as_ref().map(|index| self.integer(index)).transpose()?;
                let value = self.value(value)?;
                self.output(name, index, value);
            }
            Statement::For { name, from, to, body } => {
                let (from, to) = (self.integer(from)?, self.integer(to)?);
                for i in from..to {
                    self.locals.push((name.clone(), Rc::new(Value::Number(number(i as f64)))));
                    self.block(body)?;
                    self.locals.pop();
                }
            }
        }
        Ok(())
    }

    /// The statements of a part with these arguments; what it declares is seen by its name.
    fn instance(
        &mut self,
        part: &str,
        name: &Rc<str>,
        index: Option<&Expression>,
        given: &[Expression],
    ) -> Result<(), String> {
        let (names, body) = self.mechanism.parts.get(part).ok_or_else(|| format!("there is no part `{part}`"))?.clone();
        let index = index.map(|index| self.integer(index)).transpose()?;
        let own = index.map_or(name.to_string(), |index| format!("{name}_{index}"));
        let path = self.named_here(&own) + "_";
        let arguments = names.iter().cloned().zip(self.values(given)?).collect();
        let mut coordinates = Vec::new();
        for (name, argument) in names.iter().zip(given) {
            let alias = match &argument.kind {
                Kind::Name(name) => self.coordinate(name),
                Kind::Index(base, index) => match &base.kind {
                    Kind::Name(name) => match self.coordinate(name) {
                        Some((first, Some(_))) => Some((first + self.integer(index)? as usize, None)),
                        _ => None,
                    },
                    _ => None,
                },
                _ => None,
            };
            coordinates.extend(alias.map(|alias| (name.clone(), alias)));
        }
        let outside = std::mem::replace(&mut self.locals, arguments);
        let arrays_outside = std::mem::take(&mut self.arrays);
        self.within.push(Instance { path, coordinates });
        let first_output = self.sums.outputs.len();
        for statement in body.iter() {
            self.statement(statement)?;
        }
        let Instance { path, .. } = self.within.pop().expect("the part that was begun");
        let mut seen = std::mem::replace(&mut self.locals, outside);
        seen.extend(std::mem::replace(&mut self.arrays, arrays_outside));
        let outputs = self.sums.outputs[first_output..].iter();
        seen.extend(outputs.filter_map(|(name, y)| Some((Rc::from(name.strip_prefix(&path)?), y.clone()))));
        let seen = Rc::new(Value::Part(seen));
        match index {
            None => self.locals.push((name.clone(), seen)),
            Some(_) => match self.arrays.iter_mut().find(|(known, _)| known == name) {
                Some((_, array)) => match Rc::make_mut(array) {
                    Value::Array(entries) => entries.push(seen),
                    _ => return Err(format!("`{name}` is no array of parts")),
                },
                None => self.arrays.push((name.clone(), Rc::new(Value::Array(vec![seen])))),
            },
        }
        Ok(())
    }

    /// A name with the path of the part that it stands in.
    fn named_here(&self, name: &str) -> String {
        self.within.last().map_or(String::new(), |part| part.path.clone()) + name
    }

    /// The coordinate that a name is here, by itself or as an argument.
    fn coordinate(&self, name: &str) -> Option<(usize, Option<usize>)> {
        if let Some(part) = self.within.last() {
            let given = part.coordinates.iter().find(|(known, _)| known.as_ref() == name).map(|(_, place)| *place);
            let hidden = self.locals.iter().any(|(known, _)| known.as_ref() == name);
            return given.or_else(|| self.mechanism.coordinate(name).filter(|_| !hidden));
        }
        self.mechanism.coordinate(name)
    }

    /// Bodies that are terms of a kinetic energy, times factors.
    fn weigh(&mut self, term: &Expression, factor: Moving<S>) -> Result<(), String> {
        match &term.kind {
            Kind::Binary(sign @ ("+" | "-"), left, right) => {
                self.weigh(left, factor)?;
                self.weigh(right, if *sign == "-" { -factor } else { factor })
            }
            Kind::Unary('-', value) => self.weigh(value, -factor),
            Kind::Binary("*", left, right) => match (holds_body(left), holds_body(right)) {
                (false, true) => {
                    let by = self.number(left)?;
                    self.weigh(right, factor * by)
                }
                (true, false) => {
                    let by = self.number(right)?;
                    self.weigh(left, factor * by)
                }
                _ => Ok(()),
            },
            Kind::Binary("/", left, right) if holds_body(left) => {
                let by = self.number(right)?;
                self.weigh(left, factor / by)
            }
            Kind::Call(name, arguments) if name.as_ref() == "particle" => {
                let (mass, place) = (self.number(&arguments[0])?, self.value(&arguments[1])?.vector()?);
                self.sums.bodies.push((factor * mass, place));
                Ok(())
            }
            Kind::Call(name, arguments) if name.as_ref() == "rigid_body" => {
                let (mass, centre) = (self.number(&arguments[0])?, self.value(&arguments[1])?.vector()?);
                let centre = self.value(&arguments[3])?.pose()?.place(&centre);
                self.sums.bodies.push((factor * mass, centre));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// A value of its own, or the next element of an array.
    fn output(&mut self, name: &Rc<str>, index: Option<i64>, value: Shared<S>) {
        let name = &Rc::from(self.named_here(name));
        let known = self.sums.outputs.iter_mut().find(|(known, _)| known == name);
        match (index, known.map(|(_, array)| Rc::make_mut(array))) {
            (Some(_), Some(Value::Array(entries))) => entries.push(value),
            (Some(_), _) => self.sums.outputs.push((name.clone(), Rc::new(Value::Array(vec![value])))),
            (None, _) => self.sums.outputs.push((name.clone(), value)),
        }
    }

    /// A name, or an element of the array that it names.
    fn place_of(&mut self, name: &str, indices: &[Expression]) -> Result<&mut Shared<S>, String> {
        let indices = indices.iter().map(|index| self.integer(index)).collect::<Result<Vec<_>, _>>()?;
        indices.into_iter().try_fold(self.local(name)?, |place, index| match Rc::make_mut(place) {
            Value::Array(entries) => entries.get_mut(index as usize).ok_or_else(|| "no such element".to_string()),
            _ => Err("this has no elements".to_string()),
        })
    }

    fn local(&mut self, name: &str) -> Result<&mut Shared<S>, String> {
        let found = self.locals.iter_mut().rev().find(|(known, _)| known.as_ref() == name);
        found.map(|(_, value)| value).ok_or_else(|| format!("there is no `{name}` to be changed"))
    }

    /// The value of a declared name; signals and coordinates move, parameters and inputs do not.
    pub(super) fn declaration(&mut self, declaration: &Declaration) -> Result<(), String> {
        let lengths = self.lengths(declaration)?;
        let count = (!lengths.is_empty()).then(|| lengths.iter().product());
        let kind = match declaration.keyword.as_str() {
            "const" => return self.constant(declaration, &lengths),
            "coord" => 0,
            "prescribed" => 1,
            "input" => 2,
            _ => 3,
        };
        if let (1, Some(formula)) = (kind, &declaration.value) {
            self.declared[1] += count.unwrap_or(1);
            let value = self.value(formula)?;
            self.globals.push((declaration.name.clone(), spread(value, &lengths)));
            return Ok(());
        }
        let first = self.declared[kind];
        self.declared[kind] += count.unwrap_or(1);
        let entry = |i: usize| Rc::new(Value::Number(self.symbol(kind, first + i)));
        let row = |n: usize, from: usize| Rc::new(Value::Array((from..from + n).map(entry).collect()));
        let value = match lengths.as_slice() {
            [] => entry(0),
            [n] => row(*n, 0),
            [rows, n] => Rc::new(Value::Array((0..*rows).map(|i| row(*n, n * i)).collect())),
            _ => return Err("three lengths".to_string()),
        };
        self.globals.push((declaration.name.clone(), value));
        Ok(())
    }

    fn symbol(&self, kind: usize, i: usize) -> Moving<S> {
        let State { q, qd, qdd, u, prescribed, parameters, .. } = self.state;
        let (zero, missing) = (S::zero(), S::of(1.0));
        let fixed = |values: &[S]| moving(values.get(i).copied().unwrap_or(missing), zero, zero);
        match kind {
            // Before the number of coordinates is known they are asked for all the same.
            0 if i >= q.len() => number(1.0),
            0 => moving(q[i], qd[i], qdd[i]),
            1 => prescribed.get(i).map_or(number(1.0), |[value, rate, second]| moving(*value, *rate, *second)),
            2 => fixed(u),
            _ => fixed(parameters),
        }
    }

    /// None of a number, one of an array, two of a matrix.
    pub(super) fn lengths(&mut self, declaration: &Declaration) -> Result<Vec<usize>, String> {
        declaration.lengths.iter().map(|length| Ok(self.integer(length)? as usize)).collect()
    }

    /// A plain number counts in the declared unit. That of a part is its own.
    fn constant(&mut self, declaration: &Declaration, lengths: &[usize]) -> Result<(), String> {
        let value = declaration.value.as_ref().ok_or("a constant without a value")?;
        let value = self.converted(declaration, value, lengths)?;
        let names = if self.within.is_empty() { &mut self.globals } else { &mut self.locals };
        names.push((declaration.name.clone(), value));
        Ok(())
    }

    /// The value of a `const` or the default of a `param`, in SI.
    pub(super) fn converted(
        &mut self,
        declaration: &Declaration,
        value: &Expression,
        lengths: &[usize],
    ) -> Result<Shared<S>, String> {
        let found = self.value(value)?;
        let Some(unit) = &declaration.unit else { return Ok(spread(found, lengths)) };
        let (scale, _) = unit::meaning(unit)?;
        Ok(spread(self.in_si(value, &found, Moving::exact(scale))?, lengths))
    }

    /// Entry by entry.
    fn in_si(&self, written: &Expression, found: &Shared<S>, scale: Moving<S>) -> Result<Shared<S>, String> {
        if let (Kind::Array(written), Value::Array(entries)) = (&written.kind, found.as_ref()) {
            let entries = written.iter().zip(entries).map(|(written, entry)| self.in_si(written, entry, scale));
            return Ok(Rc::new(Value::Array(entries.collect::<Result<_, _>>()?)));
        }
        let plain =
            !unit::holds_quantity(written) && unit::dimension(written, &self.mechanism.dimensions) == unit::PLAIN;
        if plain { Ok(Rc::new(found.each(&|x| x * scale)?)) } else { Ok(found.clone()) }
    }

    fn force(&mut self, name: &str, index: Option<&Expression>, value: &Expression) -> Result<(), String> {
        let (first, count) = self.coordinate(name).ok_or_else(|| format!("no coordinate `{name}`"))?;
        let value = self.value(value)?;
        match (index, count) {
            (Some(index), _) => {
                let index = self.integer(index)? as usize;
                self.sums.forces.push((first + index, value.number()?));
            }
            (None, None) => self.sums.forces.push((first, value.number()?)),
            (None, Some(_)) => {
                self.sums.forces.extend(value.flat().into_iter().enumerate().map(|(i, force)| (first + i, force)));
            }
        }
        Ok(())
    }

    /// From here on the pose moves with six auxiliary coordinates: shifts along its axes, turns about them.
    fn reaction(&mut self, name: &Rc<str>, index: Option<&Expression>, pose: &Expression) -> Result<(), String> {
        let index = match index {
            Some(index) => self.integer(index)? as usize,
            None => 0,
        };
        let first = self.mechanism.dof() + 6 * self.sums.joints.len();
        let auxiliary: [Moving<S>; 6] =
            std::array::from_fn(
                |i| {
                    if first + i < self.state.q.len() { self.symbol(0, first + i) } else { number(0.0) }
                },
            );
        let [x, y, z, along_x, along_y, along_z] = auxiliary;
        let turns = [along_x, along_y, along_z].into_iter().enumerate();
        let freed = turns.fold(Pose::shift([x, y, z]), |pose, (axis, angle)| pose.then(&Pose::turn_about(axis, angle)));
        let moved = self.value(pose)?.pose()?.then(&freed);
        let (name_of_pose, indices) = path(pose)?;
        *self.place_of(&name_of_pose, &indices)? = Rc::new(Value::Pose(Box::new(moved)));
        self.sums.joints.push((self.named_here(name).into(), index));
        Ok(())
    }

    fn constraint(&mut self, left: &Expression, right: &Expression) -> Result<(), String> {
        let literally_zero = |side: &Expression| matches!(&side.kind, Kind::Number(x) if x.hi() == 0.0);
        let (left, right) = match (literally_zero(left), literally_zero(right)) {
            (_, true) => (self.value(left)?.flat(), Vec::new()),
            (true, _) => (self.value(right)?.flat(), Vec::new()),
            _ => (self.value(left)?.flat(), self.value(right)?.flat()),
        };
        let mut components = left;
        components.iter_mut().zip(right).for_each(|(left, right)| *left = *left - right);
        self.sums.constraints.push(Row { components });
        Ok(())
    }

    pub(super) fn integer(&mut self, value: &Expression) -> Result<i64, String> {
        let value = self.number(value)?.value();
        let nearest = value.round();
        if (value - nearest).abs() < 1e-9 { Ok(nearest as i64) } else { Err(format!("{value} is no integer")) }
    }

    pub(super) fn number(&mut self, value: &Expression) -> Result<Moving<S>, String> {
        self.value(value)?.number()
    }

    fn named(&self, name: &str) -> Result<Shared<S>, String> {
        let known = self.locals.iter().rev().chain(&self.arrays).chain(self.globals.iter().rev());
        if let Some((_, value)) = known.into_iter().find(|(known, _)| known.as_ref() == name) {
            return Ok(value.clone());
        }
        let value = match name {
            "t" => Value::Number(moving(self.state.t, S::of(1.0), S::zero())),
            "pi" => Value::Number(Moving::exact(pi())),
            "deg" => Value::Number(Moving::exact(degree())),
            "world" => Value::Pose(Box::new(Pose::world())),
            _ => return Err(format!("there is no `{name}`")),
        };
        Ok(Rc::new(value))
    }

    pub(super) fn value(&mut self, expression: &Expression) -> Result<Shared<S>, String> {
        let value = match &expression.kind {
            Kind::Number(value) => Value::Number(Moving::exact(*value)),
            Kind::Quantity(value, unit) => Value::Number(Moving::exact(*value * unit::meaning(unit)?.0)),
            Kind::Name(name) => return self.named(name),
            Kind::Array(entries) => Value::Array(self.values(entries)?),
            Kind::Index(base, index) => {
                let (base, index) = (self.value(base)?, self.integer(index)?);
                return entry(&base, index);
            }
            Kind::Field(base, name) => {
                let base = self.value(base)?;
                if let Value::Part(seen) = base.as_ref() {
                    let found = seen.iter().rev().find(|(known, _)| known == name);
                    return found.map(|(_, value)| value.clone()).ok_or_else(|| format!("no `{name}` in this part"));
                }
                let axis = ["x", "y", "z"].iter().position(|axis| *axis == name.as_ref());
                return entry(&base, axis.ok_or_else(|| format!("no component `{name}`"))? as i64);
            }
            Kind::Unary('-', value) => self.value(value)?.each(&|x| -x)?,
            Kind::Unary(_, value) => Value::Truth(!self.value(value)?.truth()?),
            Kind::Binary(operator, left, right) => self.binary(operator, left, right)?,
            Kind::If(condition, taken, other) => {
                let chosen = if self.value(condition)?.truth()? { taken } else { other };
                return self.value(chosen);
            }
            Kind::Call(name, arguments) | Kind::Method(name, arguments) => {
                let arguments = self.values(arguments)?;
                return self.call(name, arguments);
            }
        };
        Ok(Rc::new(value))
    }

    fn values(&mut self, expressions: &[Expression]) -> Result<Vec<Shared<S>>, String> {
        expressions.iter().map(|expression| self.value(expression)).collect()
    }

    /// Functions of the text, then those of the language.
    fn call(&mut self, name: &Rc<str>, arguments: Vec<Shared<S>>) -> Result<Shared<S>, String> {
        let Some((names, body)) = self.mechanism.functions.get(name) else {
            return super::builtin::call(name, &arguments, &self.mixing).map(Rc::new);
        };
        if names.len() != arguments.len() {
            return Err(format!("`{name}` takes {} arguments", names.len()));
        }
        let bound = names.iter().cloned().zip(arguments).collect();
        let outside = std::mem::replace(&mut self.locals, bound);
        let value = self.value(&body.clone());
        self.locals = outside;
        value
    }
}
