//! Calls that Python has recorded, made anew on the builder: Python's values are only numbers of calls.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Mutex, PoisonError};

use mbs_derive::builder::{
    Mechanism, Pose, Scalar, Value, Vector, angular_velocity, particle, quantity, rigid_body, time,
};
use mbs_derive::source::Place;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::{guarded, refused};

/// A recorded call: its name, the values that it is given, numbers, words, how often its own value is used.
struct Call {
    name: String,
    operands: Vec<usize>,
    numbers: Vec<f64>,
    words: Vec<String>,
    place: Place,
}

/// The name of a file of Python, kept for good: there are as many as there are files that write mechanisms.
fn kept(file: &str) -> &'static str {
    static FILES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = files.get(file) {
        return known;
    }
    let new: &'static str = Box::leak(file.to_string().into_boxed_str());
    files.insert(new);
    new
}

/// Recorded calls; the value of each is known by its number.
pub(crate) struct Calls(Vec<Call>);

/// As Python records a call: name, operands, numbers, words, and file, line and column.
type Recorded = (String, Vec<usize>, Vec<f64>, Vec<String>, (String, u32, u32));

/// From a list of them; operands are numbers of earlier calls.
pub(crate) fn read(list: &Bound<'_, PyList>) -> PyResult<Calls> {
    let mut calls = Vec::with_capacity(list.len());
    for (number, item) in list.iter().enumerate() {
        let item = item.cast_into::<PyTuple>().map_err(|_| refused("a call is a tuple"))?;
        let (name, operands, numbers, words, (file, line, column)): Recorded = item.extract()?;
        let place = Place { file: kept(&file), line, column };
        if operands.iter().any(|&operand| operand >= number) {
            return Err(refused(format!("call {number}, {name}: an operand comes after it")));
        }
        calls.push(Call { name, operands, numbers, words, place });
    }
    Ok(Calls(calls))
}

impl Calls {
    /// What `work` makes of the mechanism, without Python: values of the builder stay on one thread.
    pub(crate) fn py_free<T: Send>(&self, work: impl FnOnce(Mechanism) -> PyResult<T> + Send) -> PyResult<T> {
        Python::attach(|py| py.detach(|| guarded(|| self.mechanism().and_then(work))))
    }

    fn mechanism(&self) -> PyResult<Mechanism> {
        let Some(Call { name, words, place, .. }) = self.0.first() else { return Err(refused("there are no calls")) };
        let ("mechanism", [own, doc]) = (name.as_str(), words.as_slice()) else {
            return Err(refused("the first call is `mechanism`"));
        };
        let mut uses = vec![0_usize; self.0.len()];
        self.0.iter().flat_map(|call| &call.operands).for_each(|&operand| uses[operand] += 1);
        let mut mechanism = Mechanism::new(own, doc);
        mechanism.at(*place);
        let mut replay = Replay { mechanism, values: HashMap::new(), uses };
        for (number, call) in self.0.iter().enumerate().skip(1) {
            if let Some(value) = replay.made(call)? {
                replay.values.insert(number, value);
            }
        }
        Ok(replay.mechanism)
    }
}

/// What calls give.
#[derive(Clone)]
enum Made {
    Scalar(Scalar),
    Vector(Vector),
    Pose(Pose),
    Array(Vec<Scalar>),
}

impl Made {
    fn at(self, place: Place) -> Self {
        match self {
            Made::Scalar(value) => Made::Scalar(value.at(place)),
            Made::Vector(value) => Made::Vector(value.at(place)),
            Made::Pose(value) => Made::Pose(value.at(place)),
            Made::Array(values) => Made::Array(values),
        }
    }
}

struct Replay {
    mechanism: Mechanism,
    values: HashMap<usize, Made>,
    /// A value that nobody uses again is given away, so that it gets no name in messages.
    uses: Vec<usize>,
}

/// The operands and words of one call.
struct Given<'c> {
    call: &'c Call,
    values: std::vec::IntoIter<Made>,
    words: std::slice::Iter<'c, String>,
    numbers: std::slice::Iter<'c, f64>,
}

impl<'c> Given<'c> {
    fn wrong(&self, what: &str) -> PyErr {
        refused(format!("{}: {what} is expected", self.call.name))
    }

    fn scalar(&mut self) -> PyResult<Scalar> {
        match self.values.next() {
            Some(Made::Scalar(value)) => Ok(value),
            _ => Err(self.wrong("a number")),
        }
    }

    fn vector(&mut self) -> PyResult<Vector> {
        match self.values.next() {
            Some(Made::Vector(value)) => Ok(value),
            _ => Err(self.wrong("a vector")),
        }
    }

    fn pose(&mut self) -> PyResult<Pose> {
        match self.values.next() {
            Some(Made::Pose(value)) => Ok(value),
            _ => Err(self.wrong("a pose")),
        }
    }

    fn word(&mut self) -> PyResult<&'c str> {
        self.words.next().map(String::as_str).ok_or_else(|| self.wrong("a word"))
    }

    fn number(&mut self) -> PyResult<f64> {
        self.numbers.next().copied().ok_or_else(|| self.wrong("a plain number"))
    }
}

impl Replay {
    fn operand(&mut self, number: usize) -> PyResult<Made> {
        self.uses[number] -= 1;
        let value = match self.uses[number] {
            0 => self.values.remove(&number),
            _ => self.values.get(&number).cloned(),
        };
        value.ok_or_else(|| refused(format!("call {number} has no value")))
    }

    fn made(&mut self, call: &Call) -> PyResult<Option<Made>> {
        let values: Vec<Made> = call.operands.iter().map(|&i| self.operand(i)).collect::<PyResult<_>>()?;
        let numbers = call.numbers.iter();
        let mut given = Given { call, values: values.into_iter(), words: call.words.iter(), numbers };
        self.mechanism.at(call.place);
        match self.stated(&mut given)? {
            Some(Made::Array(all)) if all.is_empty() => Ok(None),
            Some(made) => Ok(Some(made)),
            None => computed(&mut given).map(|made| Some(made.at(call.place))),
        }
    }

    /// Statements and declarations; an empty array where there is no value, `None` where it is neither.
    fn stated(&mut self, given: &mut Given<'_>) -> PyResult<Option<Made>> {
        let m = &mut self.mechanism;
        let name = given.call.name.as_str();
        let count = given.call.numbers.first().copied().unwrap_or(0.0) as usize;
        match name {
            "doc" => m.doc(given.word()?),
            "dimensionless" => m.dimensionless(),
            "param" => return Ok(Some(Made::Scalar(m.param(given.word()?, given.word()?, given.number()?)))),
            "positive" => return Ok(Some(Made::Scalar(m.positive(given.word()?, given.word()?, given.number()?)))),
            "params" => {
                let numbers = given.call.numbers.as_slice();
                return Ok(Some(Made::Array(m.params(given.word()?, given.word()?, numbers))));
            }
            "coord" => return Ok(Some(Made::Scalar(m.coord(given.word()?, given.word()?)))),
            "coords" => return Ok(Some(Made::Array(m.coords(given.word()?, count, given.word()?)))),
            "input" => return Ok(Some(Made::Scalar(m.input(given.word()?, given.word()?)))),
            "inputs" => return Ok(Some(Made::Array(m.inputs(given.word()?, count, given.word()?)))),
            "signal" => return Ok(Some(Made::Scalar(m.signal(given.word()?, given.word()?)))),
            "prescribed" => {
                let (own, unit) = (given.word()?, given.word()?);
                return Ok(Some(Made::Scalar(m.prescribed(own, unit, given.scalar()?))));
            }
            "kinetic" => m.kinetic(given.scalar()?),
            "potential" => m.potential(given.scalar()?),
            "dissipation" => m.dissipation(given.scalar()?),
            "lagrangian" => m.lagrangian(given.scalar()?),
            "gravity" => m.gravity(given.vector()?),
            "force" => {
                let coordinate = given.scalar()?;
                m.force(&coordinate, given.scalar()?);
            }
            "force_at" => m.force_at(given.vector()?, given.vector()?),
            "torque_on" => {
                let pose = given.pose()?;
                m.torque_on(&pose, given.vector()?);
            }
            "constraint" => {
                let own = given.word()?;
                match (given.values.next(), given.values.next()) {
                    (Some(Made::Scalar(a)), Some(Made::Scalar(b))) => m.constraint(own, &a, &b),
                    (Some(Made::Vector(a)), Some(Made::Vector(b))) => m.constraint(own, &a, &b),
                    _ => return Err(given.wrong("two numbers or two vectors")),
                }
            }
            "output" => {
                fn put(m: &mut Mechanism, name: &str, value: &impl Value) {
                    m.output(name, value);
                }
                let own = given.word()?;
                match given.values.next() {
                    Some(Made::Scalar(value)) => put(m, own, &value),
                    Some(Made::Vector(value)) => put(m, own, &value),
                    Some(Made::Pose(value)) => put(m, own, &value),
                    _ => return Err(given.wrong("a number, a vector or a pose")),
                }
            }
            "reaction" => {
                let own = given.word()?;
                return Ok(Some(Made::Pose(m.reaction(own, given.pose()?))));
            }
            _ => return Ok(None),
        }
        Ok(Some(Made::Array(Vec::new())))
    }
}

/// Values, of operators and functions.
fn computed(given: &mut Given<'_>) -> PyResult<Made> {
    use Made::{Pose as P, Scalar as S, Vector as V};
    let name = given.call.name.as_str();
    Ok(match name {
        "number" => S(Scalar::from(given.number()?)),
        "quantity" => S(quantity(given.number()?, given.word()?)),
        "time" => S(time()),
        "world" => P(Pose::world()),
        "vector" => V(Vector::new(given.scalar()?, given.scalar()?, given.scalar()?)),
        "element" => match (given.values.next(), given.number()?) {
            (Some(Made::Array(all)), i) if (i as usize) < all.len() => S(all[i as usize].clone()),
            _ => return Err(given.wrong("an array with this element")),
        },
        "neg" => match given.values.next() {
            Some(S(a)) => S(-a),
            Some(V(a)) => V(-a),
            _ => return Err(given.wrong("a number or a vector")),
        },
        "add" | "sub" | "mul" | "div" => match (name, given.values.next(), given.values.next()) {
            ("add", Some(S(a)), Some(S(b))) => S(a + b),
            ("add", Some(V(a)), Some(V(b))) => V(a + b),
            ("sub", Some(S(a)), Some(S(b))) => S(a - b),
            ("sub", Some(V(a)), Some(V(b))) => V(a - b),
            ("mul", Some(S(a)), Some(S(b))) => S(a * b),
            ("mul", Some(S(a)), Some(V(b))) => V(a * b),
            ("mul", Some(V(a)), Some(S(b))) => V(a * b),
            ("mul", Some(P(a)), Some(V(b))) => V(a * b),
            ("mul", Some(P(a)), Some(P(b))) => P(a * b),
            ("div", Some(S(a)), Some(S(b))) => S(a / b),
            ("div", Some(V(a)), Some(S(b))) => V(a / b),
            _ => return Err(given.wrong("a pair of values that go together")),
        },
        "dt" => match given.values.next() {
            Some(S(a)) => S(a.dt()),
            Some(V(a)) => V(a.dt()),
            _ => return Err(given.wrong("a number or a vector")),
        },
        "x" => S(given.vector()?.x()),
        "y" => S(given.vector()?.y()),
        "z" => S(given.vector()?.z()),
        "dot" => S(given.vector()?.dot(given.vector()?)),
        "cross" => V(given.vector()?.cross(given.vector()?)),
        "norm" => S(given.vector()?.norm()),
        "norm_squared" => S(given.vector()?.norm_squared()),
        "translation" => P(Pose::translation(given.vector()?)),
        "rotation" => P(Pose::rotation(given.vector()?, given.scalar()?)),
        "rpy" => P(Pose::rpy(given.scalar()?, given.scalar()?, given.scalar()?)),
        "inverse" => P(given.pose()?.inverse()),
        "origin" => V(given.pose()?.origin()),
        "point" => V(given.pose()?.point(given.vector()?)),
        "angular_velocity" => V(angular_velocity(&given.pose()?)),
        "particle" => S(particle(given.scalar()?, given.vector()?)),
        "rigid_body" => {
            let (mass, com) = (given.scalar()?, given.vector()?);
            let mut inertia = Vec::with_capacity(6);
            for _ in 0..6 {
                inertia.push(given.scalar()?);
            }
            let inertia = inertia.try_into().map_err(|_| given.wrong("six entries"))?;
            S(rigid_body(mass, com, inertia, &given.pose()?))
        }
        _ => S(of_numbers(name, given)?),
    })
}

/// Functions of one number or two, and a choice among them.
fn of_numbers(name: &str, given: &mut Given<'_>) -> PyResult<Scalar> {
    let one: fn(&Scalar) -> Scalar = match name {
        "sin" => Scalar::sin,
        "cos" => Scalar::cos,
        "tan" => Scalar::tan,
        "asin" => Scalar::asin,
        "acos" => Scalar::acos,
        "atan" => Scalar::atan,
        "sinh" => Scalar::sinh,
        "cosh" => Scalar::cosh,
        "tanh" => Scalar::tanh,
        "exp" => Scalar::exp,
        "ln" => Scalar::ln,
        "abs" => Scalar::abs,
        "signum" => Scalar::signum,
        "sqrt" => Scalar::sqrt,
        "atan2" => return Ok(given.scalar()?.atan2(given.scalar()?)),
        "hypot" => return Ok(given.scalar()?.hypot(given.scalar()?)),
        "min" => return Ok(given.scalar()?.min(given.scalar()?)),
        "max" => return Ok(given.scalar()?.max(given.scalar()?)),
        "pow" => return Ok(given.scalar()?.pow(given.scalar()?)),
        "below" => return Ok(given.scalar()?.below(given.scalar()?, given.scalar()?, given.scalar()?)),
        _ => return Err(refused(format!("there is no call `{name}`"))),
    };
    Ok(one(&given.scalar()?))
}
