//! The variables of a mechanism that a plan may fix or vary: parameters, coordinates, their rates, and inputs,
//! component by component.

use mbs_derive::model::Unit;
use mbs_derive::optimise::Derivation;
use mbs_derive::variable::Variable;
use mbs_ensemble::Vocabulary;

use crate::state::Point;

/// Where a value goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Parameter(usize),
    Coordinate(usize),
    Rate(usize),
    Input(usize),
}

impl Slot {
    /// Puts a value there.
    pub(super) fn put(self, point: &mut Point, value: f64) {
        match self {
            Slot::Parameter(i) => point.parameters[i] = value,
            Slot::Coordinate(i) => point.state.q[i] = value,
            Slot::Rate(i) => point.state.qd[i] = value,
            Slot::Input(i) => point.state.u[i] = value,
        }
    }
}

/// A mechanism's names.
pub(super) struct Names<'d>(pub(super) &'d Derivation);

impl Names<'_> {
    /// All, with the units of their numbers.
    fn all(&self) -> Vec<(String, Slot, String)> {
        let Names(derivation) = self;
        let mut all = Vec::new();
        let mut add = |variables: &[Variable], suffix: &str, per: &str, slot: fn(usize) -> Slot| {
            for variable in variables {
                for (i, name) in variable.component_names().into_iter().enumerate() {
                    let unit = if per.is_empty() { variable.unit.clone() } else { format!("({}){per}", variable.unit) };
                    all.push((format!("{name}{suffix}"), slot(variable.first + i), unit));
                }
            }
        };
        add(&derivation.parameters, "", "", Slot::Parameter);
        add(&derivation.coordinates, "", "", Slot::Coordinate);
        add(&derivation.coordinates, "_dot", "/s", Slot::Rate);
        add(&derivation.inputs, "", "", Slot::Input);
        all
    }

    /// Where the value of a variable goes.
    pub(super) fn slot(&self, name: &str) -> Option<Slot> {
        self.all().into_iter().find(|(own, ..)| own == name).map(|(_, slot, _)| slot)
    }

    /// The unit that a parameter was declared in, if that is not the one its numbers are in; and the latter.
    pub(super) fn declared_unit(&self, name: &str) -> Option<(&str, &str)> {
        let Some(Slot::Parameter(number)) = self.slot(name) else { return None };
        let variable = self.0.parameters.iter().find(|variable| variable.contains(number))?;
        Some((variable.declared_unit.as_deref()?, &variable.unit))
    }
}

impl Vocabulary for Names<'_> {
    fn unit(&self, name: &str) -> Option<String> {
        self.all().into_iter().find(|(own, ..)| own == name).map(|(.., unit)| unit)
    }

    fn names(&self) -> Vec<String> {
        self.all().into_iter().map(|(name, ..)| name).collect()
    }

    fn number(&self, text: &str, unit: &str) -> Result<f64, String> {
        Unit(unit).in_si(text)
    }
}
