//! Assignments: to locals that are declared and not yet bound, and to components of arrays and records.

use std::rc::Rc;

use syn::{Expr, UnOp};

use super::super::meaning::Meaning;
use super::{Reader, Reading, cannot_read, member, unknown};

impl Reader<'_> {
    pub(super) fn assign(&mut self, place: &Expr, value: Meaning) -> Reading<()> {
        match (place, value) {
            (Expr::Infer(_), _) => Ok(()),
            (Expr::Path(path), value) => {
                let name = path.path.require_ident().map_err(|_| cannot_read(path))?.to_string();
                let local = *self.names.get(&name).ok_or_else(|| format!("`{name}` is not declared"))?;
                if local < self.outer || self.locals[local].is_some() {
                    return Err(format!("`{name}` is given a value here"));
                }
                self.locals[local] = Some(value);
                Ok(())
            }
            (Expr::Index(_) | Expr::Field(_) | Expr::Unary(_), value) => {
                *self.component(place)? = value;
                Ok(())
            }
            (Expr::Array(places), value) => {
                let values = self.entries(value, places.elems.len())?;
                places.elems.iter().zip(values).try_for_each(|(place, value)| self.assign(place, value))
            }
            (Expr::Tuple(places), Meaning::Tuple(values)) if places.elems.len() == values.len() => {
                places.elems.iter().zip(values.iter()).try_for_each(|(place, value)| self.assign(place, value.clone()))
            }
            (other, _) => unknown(other),
        }
    }

    /// What a component of a local means, to be given another meaning.
    fn component(&mut self, place: &Expr) -> Reading<&mut Meaning> {
        match place {
            Expr::Path(whole) => {
                let name = whole.path.require_ident().map_err(|_| cannot_read(whole))?.to_string();
                let local = self.names.get(&name).copied().filter(|local| *local >= self.outer);
                local.and_then(|local| self.locals[local].as_mut()).ok_or_else(|| cannot_read(place))
            }
            Expr::Unary(whole) if matches!(whole.op, UnOp::Deref(_)) => self.component(&whole.expr),
            Expr::Index(component) => {
                let Meaning::Integer(i) = self.value(&component.index)? else { return unknown(place) };
                match self.component(&component.expr)? {
                    Meaning::List(entries) if i < entries.len() => Ok(&mut Rc::make_mut(entries)[i]),
                    _ => unknown(place),
                }
            }
            Expr::Field(field) => match self.component(&field.base)? {
                Meaning::Record(_, fields) => {
                    let found = Rc::make_mut(fields).get_mut(&member(&field.member));
                    found.ok_or_else(|| cannot_read(place))
                }
                _ => unknown(place),
            },
            _ => unknown(place),
        }
    }
}
