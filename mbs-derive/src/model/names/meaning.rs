//! What names stand for, in a few words: for editors.

use std::collections::BTreeMap;

use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::Resolver;
use crate::model::value::{Shape, Value};
use crate::parse::syntax::Span;

/// What the names at some places stand for: their dimension, and what kind of value it is unless it is a number; by
/// where they begin.
pub(in crate::model) type Meanings = BTreeMap<usize, (Span, String)>;

impl<'g> Resolver<'_, 'g> {
    /// Notes what the name that is declared at a place stands for: the first time it is given a value.
    pub(in crate::model) fn note_meaning(&mut self, place: &Span, value: &Value<'g>) {
        // What the library declares has places of another text.
        let in_library = self.report.calls.iter().any(|call| call.home == crate::model::names::function::Home::Library);
        if in_library || self.names.meanings.contains_key(&place.start) {
            return;
        }
        let mut text = described(value);
        if let Value::Scalar(scalar) = value
            && let Some(number) = self.known.facts.constant(scalar.expr)
        {
            text += &format!(" = {}", number.to_f64());
        }
        self.names.meanings.insert(place.start, (place.clone(), text));
    }
}

/// `m/s²`, `vector of m`, `6 of kg`.
fn described(value: &Value<'_>) -> String {
    let of = |what: &str, dimension: Option<Dimension>| match dimension {
        Some(dimension) => format!("{what} of {dimension}"),
        None => what.to_string(),
    };
    match value {
        Value::Scalar(scalar) => scalar.dimension.to_string(),
        Value::Vector(vector) => of("vector", Some(vector.dimension)),
        Value::Point(_) => of("point", Some(Dimension::LENGTH)),
        Value::Matrix(matrix) => of("matrix", Some(matrix.dimension)),
        Value::Pose(_) => "pose".to_string(),
        Value::Part(part) => format!("part {}", part.part),
        Value::Array(array) => match value.shape() {
            Shape::Vector => of("vector", common(value)),
            Shape::Matrix => of("matrix", common(value)),
            _ => match array.values().first() {
                Some(first) => format!("{} of {}", array.values().len(), described(first)),
                None => "array".to_string(),
            },
        },
    }
}

/// The dimension of three numbers, or of three rows of three.
fn common(value: &Value<'_>) -> Option<Dimension> {
    match value {
        // A zero has any.
        Value::Scalar(scalar) => Some(scalar.dimension).filter(|_| !scalar.expr.is_zero()),
        Value::Vector(vector) => Some(vector.dimension),
        Value::Array(array) => {
            let mut dimensions = array.values().iter().filter_map(common);
            let first = dimensions.next()?;
            dimensions.all(|other| other == first).then_some(first)
        }
        Value::Point(_) | Value::Matrix(_) | Value::Pose(_) | Value::Part(_) => None,
    }
}
