//! Elements of arrays: which one is named, and what it is.

use std::rc::Rc;

use super::{Expression, Kind, Real, Shared, Value};

/// The name and the indices of an element of an array.
pub(super) fn path(place: &Expression) -> Result<(Rc<str>, Vec<Expression>), String> {
    match &place.kind {
        Kind::Name(name) => Ok((name.clone(), Vec::new())),
        Kind::Index(base, index) => {
            let (name, mut indices) = path(base)?;
            indices.push(index.as_ref().clone());
            Ok((name, indices))
        }
        _ => Err("this is no name of a pose".to_string()),
    }
}

/// Whether a body is declared in an expression.
pub(super) fn holds_body(expression: &Expression) -> bool {
    let is_body = matches!(&expression.kind, Kind::Call(name, _) if matches!(name.as_ref(), "particle" | "rigid_body"));
    is_body || expression.parts().into_iter().any(holds_body)
}

/// One value for every element of an array or matrix.
pub(super) fn spread<S: Real>(value: Shared<S>, lengths: &[usize]) -> Shared<S> {
    if !matches!(value.as_ref(), Value::Number(_)) {
        return value;
    }
    lengths.iter().rev().fold(value, |entry, &n| Rc::new(Value::Array(vec![entry; n])))
}

pub(super) fn entry<S: Real>(base: &Shared<S>, index: i64) -> Result<Shared<S>, String> {
    let index = usize::try_from(index).map_err(|_| "a negative index")?;
    match base.as_ref() {
        Value::Array(entries) => entries.get(index).cloned().ok_or_else(|| format!("no element {index}")),
        Value::Point(place) => place.get(index).map(|&x| Rc::new(Value::Number(x))).ok_or_else(|| "no axis".into()),
        _ => Err("this has no elements".to_string()),
    }
}
