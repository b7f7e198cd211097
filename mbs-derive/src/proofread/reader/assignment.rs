//! Assignments: to locals that are declared and not yet bound, and to components of arrays and records.

use std::rc::Rc;

use super::super::meaning::Meaning;
use super::super::reading::{Reading, cannot_read, unknown};
use super::super::rust::{Expression, ExpressionKind};
use super::Reader;

impl Reader<'_> {
    pub(super) fn assign(&mut self, place: &Expression<'_>, value: Meaning) -> Reading<()> {
        match (&place.kind, value) {
            (ExpressionKind::Wild, _) => Ok(()),
            (ExpressionKind::Path(name), value) => {
                let local = *self.names.get(name).ok_or_else(|| format!("`{name}` is not declared"))?;
                if local < self.outer || self.locals[local].is_some() {
                    return Err(format!("`{name}` is given a value here"));
                }
                self.locals[local] = Some(value);
                Ok(())
            }
            (ExpressionKind::Index(_) | ExpressionKind::Field(..) | ExpressionKind::Unary(..), value) => {
                *self.component(place)? = value;
                Ok(())
            }
            (ExpressionKind::Array(places), value) => {
                let values = self.entries(value, places.len())?;
                places.iter().zip(values).try_for_each(|(place, value)| self.assign(place, value))
            }
            (ExpressionKind::Tuple(places), Meaning::Tuple(values)) if places.len() == values.len() => {
                places.iter().zip(values.iter()).try_for_each(|(place, value)| self.assign(place, value.clone()))
            }
            _ => unknown(place.text),
        }
    }

    /// What a component of a local means, to be given another meaning.
    fn component(&mut self, place: &Expression<'_>) -> Reading<&mut Meaning> {
        let text = place.text;
        match &place.kind {
            ExpressionKind::Path(name) => {
                let local = self.names.get(name).copied().filter(|local| *local >= self.outer);
                local.and_then(|local| self.locals[local].as_mut()).ok_or_else(|| cannot_read(text))
            }
            ExpressionKind::Unary('*', whole) => self.component(whole),
            ExpressionKind::Index(parts) => {
                let Meaning::Integer(i) = self.value(&parts[1])? else { return unknown(text) };
                match self.component(&parts[0])? {
                    Meaning::List(entries) if i < entries.len() => Ok(&mut Rc::make_mut(entries)[i]),
                    _ => unknown(text),
                }
            }
            ExpressionKind::Field(of, name) => match self.component(of)? {
                Meaning::Record(_, fields) => Rc::make_mut(fields).get_mut(*name).ok_or_else(|| cannot_read(text)),
                _ => unknown(text),
            },
            _ => unknown(text),
        }
    }
}
