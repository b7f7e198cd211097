//! The columns of a motion's table: names, units, and what they are computed by.

use std::collections::BTreeSet;

use mbs_derive::model::Unit;
use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_derive::variable::Variable;

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// `theta`, `theta_dot`, `energy`, `tip_0` …
    pub name: String,
    /// As the language writes it.
    pub unit: String,
}

/// Time, coordinates, rates, energies, multipliers and what is left of constraints, outputs: in the order of a row.
pub(crate) fn columns(derivation: &Derivation) -> Vec<Column> {
    let mut columns = Columns { all: Vec::new(), taken: BTreeSet::new() };
    columns.push("t", "s");
    for (suffix, per) in [("", ""), ("_dot", "/s")] {
        for variable in &derivation.coordinates {
            for name in variable.component_names() {
                columns.push(&format!("{name}{suffix}"), &rate_unit(variable, per));
            }
        }
    }
    ["kinetic_energy", "potential_energy", "energy"].iter().for_each(|name| columns.push(name, "J"));
    for (prefix, unit) in [("lambda_", 1), ("residual_", 0)] {
        for (row, units) in derivation.constraints.iter().zip(&derivation.constraint_units) {
            columns.push(&format!("{prefix}{row}"), &units[unit]);
        }
    }
    for function in outputs(derivation) {
        let units = output_of(derivation, function).map(|number| &derivation.output_units[number]);
        let names = function.results.iter().flat_map(|part| part.shape.components(&function.name));
        for (i, name) in names.enumerate() {
            columns.push(&name, units.and_then(|units| units.get(i)).map_or("1", String::as_str));
        }
    }
    columns.all
}

struct Columns {
    all: Vec<Column>,
    taken: BTreeSet<String>,
}

impl Columns {
    /// An output may be called as the coordinate that it shows.
    fn push(&mut self, name: &str, unit: &str) {
        let mut name = name.to_string();
        while !self.taken.insert(name.clone()) {
            name += "_output";
        }
        self.all.push(Column { name, unit: Unit(unit).in_ascii() });
    }
}

/// The values of outputs, without their velocities and Jacobians.
pub(crate) fn outputs(derivation: &Derivation) -> impl Iterator<Item = &Function> {
    derivation.functions.iter().filter(|function| matches!(function.kind, FunctionKind::Output(_)))
}

/// The number of the output that a function is the value of.
pub(crate) fn output_of(derivation: &Derivation, function: &Function) -> Option<usize> {
    match function.kind {
        FunctionKind::Output(number) if number < derivation.output_units.len() => Some(number),
        _ => None,
    }
}

/// `rad/s`, `1/s`, `(m/s)/s`
fn rate_unit(variable: &Variable, per: &str) -> String {
    match variable.unit.as_str() {
        unit if per.is_empty() => unit.to_string(),
        "" => format!("1{per}"),
        unit if unit.contains('/') => format!("({unit}){per}"),
        unit => format!("{unit}{per}"),
    }
}
