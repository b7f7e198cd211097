//! What local names and functions of a mechanism stand for: on paper intermediate results are called so.

use crate::expr::{Expr, Node, Number, Vector};
use crate::model::frame::FrameId;
use crate::model::value::Value;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Resolver};

/// A number that a name of the text stands for: `leg(0).x`, or `length` in the first turn of a loop.
#[derive(Clone, Debug)]
pub(crate) struct Local<'g> {
    /// The name of a `let` or a `fn`.
    pub(crate) name: String,
    /// The numbers of the turns, or the arguments of the function.
    pub(crate) numbers: Vec<i64>,
    /// `x`, `y`, `z` of a vector; nothing of a number.
    pub(crate) axis: &'static str,
    /// What it stands for, verbatim.
    pub(crate) value: Expr<'g>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// A place, or a vector between two of them, and the frame whose coordinates these are.
fn length<'g>(value: &Value<'g>) -> Option<(FrameId, Vector<'g>)> {
    let fits = |expr: Expr<'g>, dimension| expr.is_zero() || dimension == Dimension::LENGTH;
    match value {
        Value::Point(point) => Some((point.frame, point.coordinates)),
        Value::Vector(vector) => {
            let is_seen = vector.dimension == Dimension::LENGTH && vector.frame == FrameId::WORLD;
            is_seen.then_some((vector.frame, vector.components))
        }
        Value::Array(array) => {
            let number = |value: &Value<'g>| match value {
                Value::Scalar(scalar) if fits(scalar.expr, scalar.dimension) => Some(scalar.expr),
                _ => None,
            };
            let [x, y, z] = array.values() else { return None };
            Some((FrameId::WORLD, Vector([number(x)?, number(y)?, number(z)?])))
        }
        Value::Scalar(_) | Value::Matrix(_) | Value::Pose(_) | Value::Part(_) => None,
    }
}

impl<'g> Resolver<'_, 'g> {
    /// Remembers what a local name stands for.
    pub(in crate::model) fn remember(&mut self, name: &str, numbers: Vec<i64>, value: &Value<'g>) {
        let components: Vec<(&'static str, Expr<'g>)> = match value {
            Value::Scalar(scalar) => vec![("", scalar.expr)],
            Value::Vector(vector) => AXES.into_iter().zip(vector.components.0).collect(),
            Value::Point(point) => AXES.into_iter().zip(point.coordinates.0).collect(),
            Value::Array(array) if array.values().len() == 3 => {
                let number = |(axis, value): (&'static str, &Value<'g>)| match value {
                    Value::Scalar(scalar) => Some((axis, scalar.expr)),
                    _ => None,
                };
                AXES.into_iter().zip(array.values()).filter_map(number).collect()
            }
            Value::Matrix(_) | Value::Pose(_) | Value::Part(_) | Value::Array(_) => Vec::new(),
        };
        if let Some((frame, vector)) = length(value) {
            let name: String = numbers.iter().fold(name.to_string(), |name, number| format!("{name}_{number}"));
            self.lagrangian.named_lengths.push((name, frame, vector));
        }
        for (axis, value) in components {
            let local = Local { name: name.to_string(), numbers: numbers.clone(), axis, value };
            self.lagrangian.locals.push(local);
        }
    }

    /// Remembers what a function gives for whole numbers.
    pub(in crate::model) fn remember_call(&mut self, name: &str, numbers: Option<Vec<i64>>, value: &Value<'g>) {
        if let Some(numbers) = numbers.filter(|numbers| !numbers.is_empty()) {
            self.remember(name, numbers, value);
        }
    }

    /// Arguments that are all whole numbers as written.
    pub(in crate::model) fn whole_numbers(&self, arguments: &[Argument<'g>]) -> Option<Vec<i64>> {
        let number = |argument: &Argument<'g>| match &argument.value {
            Value::Scalar(scalar) => match scalar.expr.node() {
                Node::Constant(Number::Exact { numerator, denominator: 1, pi: 0 }) => i64::try_from(numerator).ok(),
                _ => None,
            },
            _ => None,
        };
        arguments.iter().map(number).collect()
    }
}
