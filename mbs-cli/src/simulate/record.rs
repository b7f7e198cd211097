//! What is recorded of a motion besides its standard columns, where it is asked for.

use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_derive::variable::Variable;
use mbs_runtime::ConstraintError;

use super::column::{Column, of_variables};
use super::drive::FORMULA;
use crate::equations::{Equations, Solver};
use mbs_derive::interpret::State;

/// What may be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Record {
    /// Every output, component by component.
    Outputs,
    /// The inputs.
    Inputs,
    /// The accelerations of the coordinates.
    Accelerations,
    /// Force and moment of every joint that a `reaction` asks for.
    Reactions,
    /// The multipliers of constraints, which are among the standard columns already.
    Multipliers,
    /// The first integrals.
    Conserved,
}

/// The columns asked for, and how they are filled.
pub(crate) struct Recorder<'d> {
    derivation: &'d Derivation,
    asked_for: Vec<Record>,
}

impl<'d> Recorder<'d> {
    /// Each kind is recorded once, in the order in which it was asked for.
    pub(crate) fn new(derivation: &'d Derivation, asked_for: &[Record]) -> Self {
        let mut kinds: Vec<Record> = Vec::new();
        for kind in asked_for {
            if !kinds.contains(kind) {
                kinds.push(*kind);
            }
        }
        Recorder { derivation, asked_for: kinds }
    }

    /// The kinds that the mechanism has nothing of.
    pub(crate) fn empty_handed(&self) -> Vec<&'static str> {
        let derivation = self.derivation;
        let has_nothing = |kind: &Record| match kind {
            Record::Multipliers => derivation.constraints.is_empty(),
            _ => self.columns_of(*kind).is_empty(),
        };
        self.asked_for.iter().filter(|kind| has_nothing(kind)).map(|kind| kind.name()).collect()
    }

    /// In the order of the values.
    pub(crate) fn columns(&self) -> Vec<Column> {
        self.asked_for.iter().flat_map(|kind| self.columns_of(*kind)).collect()
    }

    fn columns_of(&self, kind: Record) -> Vec<Column> {
        let derivation = self.derivation;
        match kind {
            Record::Multipliers => Vec::new(),
            Record::Inputs => of_variables("inputs", &derivation.inputs, "", ""),
            Record::Accelerations => of_variables("accelerations", &derivation.coordinates, "_ddot", "/s^2"),
            Record::Outputs => {
                let outputs = functions(derivation, is_output).zip(&derivation.output_units);
                outputs.flat_map(|(function, unit)| of_output(function, unit)).collect()
            }
            Record::Conserved => {
                let column = |name| Column::new("conserved", name, &unit_of_integral(derivation, name));
                derivation.conserved.iter().map(|name| column(name)).collect()
            }
            Record::Reactions => {
                let joints = derivation.reactions.iter().flat_map(|reaction| reaction.component_names());
                joints.flat_map(|joint| of_wrench(&joint)).collect()
            }
        }
    }

    /// The values at a state with its accelerations and multipliers.
    pub(crate) fn values(
        &self,
        equations: &Equations<'_>,
        solver: &mut Solver<'_, '_>,
        state: &State,
        multipliers: &[f64],
    ) -> Result<Vec<f64>, ConstraintError> {
        let needs_accelerations = [Record::Accelerations, Record::Reactions].iter().any(|k| self.asked_for.contains(k));
        let qdd = if needs_accelerations { solver.accelerations(state)? } else { Vec::new() };
        let evaluated = |chosen: fn(&Function) -> bool, state: &State| -> Vec<f64> {
            functions(self.derivation, chosen).flat_map(|f| equations.evaluate(f, state, multipliers)).collect()
        };
        let values = self.asked_for.iter().flat_map(|kind| match kind {
            Record::Multipliers => Vec::new(),
            Record::Inputs => state.u.clone(),
            Record::Accelerations => qdd.clone(),
            Record::Outputs => evaluated(is_output, state),
            Record::Conserved => evaluated(is_conserved, state),
            Record::Reactions => evaluated(is_reaction, &State { qdd: qdd.clone(), ..state.clone() }),
        });
        Ok(values.collect())
    }
}

impl Record {
    fn name(self) -> &'static str {
        match self {
            Record::Outputs => "outputs",
            Record::Inputs => "inputs",
            Record::Accelerations => "accelerations",
            Record::Reactions => "reactions",
            Record::Multipliers => "multipliers",
            Record::Conserved => "conserved",
        }
    }
}

fn functions(derivation: &Derivation, chosen: fn(&Function) -> bool) -> impl Iterator<Item = &Function> {
    derivation.functions.iter().filter(move |function| chosen(function))
}

/// Formulas of inputs are outputs, too, but were not declared.
fn is_output(function: &Function) -> bool {
    matches!(function.kind, FunctionKind::Output(_)) && !function.name.starts_with(FORMULA)
}

fn is_conserved(function: &Function) -> bool {
    function.kind == FunctionKind::Conserved
}

fn is_reaction(function: &Function) -> bool {
    matches!(function.kind, FunctionKind::Reaction(_))
}

/// `tip`, `tip_0` …, `tip_0_1` …; of a pose `hand_position_0` …, `hand_rotation_0_0` …; with the unit of each.
pub(crate) fn of_output(function: &Function, units: &[String]) -> Vec<Column> {
    let names = function.results.iter().flat_map(|part| part.shape.components(&function.name));
    names.zip(units).map(|(name, unit)| Column::new("outputs", &name, unit)).collect()
}

fn of_wrench(joint: &str) -> Vec<Column> {
    let part = |what: &str, unit: &str| -> Vec<Column> {
        ["x", "y", "z"].iter().map(|axis| Column::new("reactions", &format!("{joint}_{what}_{axis}"), unit)).collect()
    };
    [part("force", "N"), part("moment", "N*m")].concat()
}

/// J, or that of the momentum of a coordinate, which is J s per its unit.
fn unit_of_integral(derivation: &Derivation, name: &str) -> String {
    let unit_of = |variable: &Variable| variable.unit.clone();
    let components = derivation.coordinates.iter().flat_map(|v| v.component_names().into_iter().map(move |n| (n, v)));
    let coordinate = name.strip_prefix("p_").and_then(|name| components.clone().find(|(own, _)| own == name));
    match coordinate.map(|(_, variable)| unit_of(variable)).as_deref() {
        None => "J".to_string(),
        Some("m") => "N*s".to_string(),
        Some("rad" | "1" | "") => "N*m*s".to_string(),
        Some(other) => format!("J*s/({other})"),
    }
}
