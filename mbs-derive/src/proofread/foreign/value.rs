//! What expressions of other languages mean: values that statements change in place.

use std::collections::BTreeMap;

use super::super::meaning::Meaning;
use super::super::numbering::{Number, Numbering};
use super::super::reader::Reading;

/// What an expression means.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// It is declared, and has no value yet.
    Unset,
    /// A number or a condition.
    Number(Number),
    Integer(usize),
    Text(String),
    Array(Vec<Value>),
    Struct(BTreeMap<String, Value>),
    /// What a function gives for these arguments that is not computed here.
    Call(String, Vec<Value>),
}

/// A step to a part of a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Field(String),
    Index(usize),
}

/// What an output of a function of MATLAB is called, by its number.
pub(super) fn output(number: usize) -> String {
    format!("output {number}")
}

impl Value {
    pub(super) fn call(name: &str, arguments: impl IntoIterator<Item = Value>) -> Self {
        Value::Call(name.to_string(), arguments.into_iter().collect())
    }

    /// The part that a step leads to.
    pub(super) fn part(&self, step: &Step) -> Option<&Value> {
        match (self, step) {
            (Value::Array(entries), Step::Index(i)) => entries.get(*i),
            (Value::Struct(fields), Step::Field(name)) => fields.get(name),
            _ => None,
        }
    }

    pub(super) fn part_mut(&mut self, step: &Step) -> Option<&mut Value> {
        match (self, step) {
            (Value::Array(entries), Step::Index(i)) => entries.get_mut(*i),
            (Value::Struct(fields), Step::Field(name)) => fields.get_mut(name),
            _ => None,
        }
    }

    /// Its numbers, one after the other.
    pub(super) fn flat(&self) -> Reading<Vec<Value>> {
        match self {
            Value::Array(entries) => {
                let parts = entries.iter().map(Value::flat).collect::<Reading<Vec<_>>>()?;
                Ok(parts.concat())
            }
            Value::Struct(fields) => {
                let parts = fields.values().map(Value::flat).collect::<Reading<Vec<_>>>()?;
                Ok(parts.concat())
            }
            Value::Unset => Err("a value is missing".to_string()),
            other => Ok(vec![other.clone()]),
        }
    }

    /// Where it differs from another one, if it does.
    pub(super) fn difference(&self, expected: &Value, numbering: &Numbering) -> Option<String> {
        let all = |found: &[Value], expected: &[Value], what: &str| match found.len() == expected.len() {
            false => Some(format!("{what}: {} instead of {}", found.len(), expected.len())),
            true => found.iter().zip(expected).enumerate().find_map(|(i, (found, expected))| {
                found.difference(expected, numbering).map(|difference| format!("{what} {i}: {difference}"))
            }),
        };
        match (self, expected) {
            (found, expected) if found == expected => None,
            (Value::Number(found), Value::Number(expected)) => {
                let [found, expected] = numbering.difference(*found, *expected).map(|number| numbering.shown(number));
                Some(format!("`{found}` instead of `{expected}`"))
            }
            (Value::Array(found), Value::Array(expected)) => all(found, expected, "component"),
            (Value::Call(name, found), Value::Call(other, expected)) if name == other => {
                all(found, expected, &format!("`{name}`, argument"))
            }
            (Value::Struct(found), Value::Struct(expected)) if found.keys().eq(expected.keys()) => {
                found.iter().zip(expected.values()).find_map(|((name, found), expected)| {
                    found.difference(expected, numbering).map(|difference| format!("`{name}`: {difference}"))
                })
            }
            (found, expected) => Some(format!("{} instead of {}", found.shown(numbering), expected.shown(numbering))),
        }
    }

    pub(super) fn shown(&self, numbering: &Numbering) -> String {
        match self {
            Value::Unset => "nothing".to_string(),
            Value::Number(number) => format!("`{}`", numbering.shown(*number)),
            Value::Integer(value) => format!("`{value}`"),
            Value::Text(text) => format!("`{text:?}`"),
            Value::Array(entries) => format!("{} components", entries.len()),
            Value::Struct(fields) => format!("{} fields", fields.len()),
            Value::Call(name, _) => format!("`{name}(…)`"),
        }
    }
}

impl From<Number> for Value {
    fn from(number: Number) -> Self {
        Value::Number(number)
    }
}

/// What a function is to give, as far as it is numbers.
impl From<&Meaning> for Value {
    fn from(meaning: &Meaning) -> Self {
        match meaning {
            Meaning::Number(number) => Value::Number(*number),
            Meaning::Integer(value) => Value::Integer(*value),
            Meaning::List(entries) | Meaning::Tuple(entries) => Value::Array(entries.iter().map(Value::from).collect()),
            Meaning::Record(_, fields) => {
                Value::Struct(fields.iter().map(|(name, value)| (name.clone(), Value::from(value))).collect())
            }
            Meaning::Call(name, arguments) => Value::Call(name.clone(), arguments.iter().map(Value::from).collect()),
            Meaning::Literal(_)
            | Meaning::Text(_)
            | Meaning::Path(_)
            | Meaning::Closure(_)
            | Meaning::OnDemand(_)
            | Meaning::FromF64
            | Meaning::Table(_)
            | Meaning::Derivatives(..)
            | Meaning::Columns(..) => Value::Unset,
        }
    }
}
