//! The variables of an FMU, in the order of their value references.

use std::collections::BTreeSet;

use mbs_derive::expr::Symbol;
use mbs_derive::optimise::{Derivation, FunctionKind, Instruction, Program};
use mbs_derive::variable::Variable as Declared;

use crate::simulate::column::{Column, of_variables, rate_unit};
use crate::simulate::record::of_output;
use crate::state::Point;

/// What a variable is to whoever uses the FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    State,
    Derivative,
    Input,
    Parameter,
    Output,
    /// Computed, but not connected to others.
    Local,
    /// Which side of a comparison holds.
    Switch,
}

/// A variable; its place in the list is its value reference.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) unit: String,
    pub(super) description: String,
    pub(super) start: Option<f64>,
    /// The variable that it is the derivative of, with respect to time.
    pub(super) derivative_of: Option<usize>,
    /// What it is computed from, if it is an output or the derivative of a state.
    pub(super) dependencies: Vec<usize>,
}

/// All of them.
pub(super) fn variables(derivation: &Derivation, point: &Point, switches: usize) -> Vec<Variable> {
    let n = derivation.dof();
    let list = List { all: Vec::new(), taken: BTreeSet::new() };
    let places = Places::of(derivation);
    let mut list = list.with(Role::Time, &[Column::new("", "time", "s")], &["Time.".to_string()], &[point.state.t]);
    let coordinates = &derivation.coordinates;
    let docs = documented(coordinates);
    let states = of_variables("", coordinates, "", "");
    let says =
        |what: &str| -> Vec<String> { states.iter().zip(&docs).map(|(c, doc)| about(what, &c.name, doc)).collect() };
    list = list.with(Role::State, &states, &docs, &point.state.q);
    let rates = of_variables("", coordinates, "_dot", "/s");
    list = list.with(Role::State, &rates, &says("Rate"), &point.state.qd);
    let of = |columns: &[Column], per: &str| -> Vec<Column> {
        columns.iter().map(|c| Column::new("", &format!("der({})", c.name), &rate_unit(&c.unit, per))).collect()
    };
    let first = list.all.len();
    list = list.with(Role::Derivative, &of(&states, "/s"), &says("Derivative"), &[]);
    let accelerations: Vec<Column> = of(&rates, "")
        .into_iter()
        .zip(of_variables("", coordinates, "", "/s^2"))
        .map(|(c, unit)| Column { unit: unit.unit, ..c })
        .collect();
    list = list.with(Role::Derivative, &accelerations, &says("Acceleration"), &[]);
    list = list.with(
        Role::Input,
        &of_variables("", &derivation.inputs, "", ""),
        &documented(&derivation.inputs),
        &point.state.u,
    );
    let (signals, signal_docs) = signals(&derivation.prescribed);
    let signal_starts: Vec<f64> = point.state.prescribed.iter().flatten().copied().collect();
    list = list.with(Role::Input, &signals, &signal_docs, &signal_starts);
    let parameters = of_variables("", &derivation.parameters, "", "");
    list = list.with(Role::Parameter, &parameters, &documented(&derivation.parameters), &point.parameters);
    let first_output = list.all.len();
    let outputs = derivation.functions.iter().filter(|f| matches!(f.kind, FunctionKind::Output(_)));
    let mut output_dependencies = Vec::new();
    for (function, units) in outputs.zip(&derivation.output_units) {
        let columns = of_output(function, units);
        output_dependencies.extend(columns.iter().map(|_| places.used_by(&function.program)));
        list = list.with(Role::Output, &columns, &vec![format!("Output {}.", function.name); columns.len()], &[]);
    }
    let energies = [("kinetic_energy", "T"), ("potential_energy", "V"), ("energy", "T + V")];
    let names = energies.map(|(name, _)| Column::new("", name, "J"));
    list = list.with(Role::Local, &names, &energies.map(|(_, what)| format!("{what}.")), &[]);
    for (prefix, which, what) in [("lambda_", 1, "Multiplier of"), ("residual_", 0, "What is left of")] {
        let rows = derivation.constraints.iter().zip(&derivation.constraint_units);
        let columns: Vec<Column> =
            rows.map(|(row, units)| Column::new("", &format!("{prefix}{row}"), &units[which])).collect();
        let docs: Vec<String> =
            derivation.constraints.iter().map(|row| format!("{what} the constraint {row}.")).collect();
        list = list.with(Role::Local, &columns, &docs, &[]);
    }
    let columns: Vec<Column> = (0..switches).map(|k| Column::new("", &format!("condition_{k}"), "1")).collect();
    list = list.with(Role::Switch, &columns, &vec!["Left less right side of a comparison.".to_string(); switches], &[]);

    let mut all = list.all;
    for i in 0..2 * n {
        all[first + i].derivative_of = Some(1 + i);
    }
    for (i, variable) in all.iter_mut().enumerate().skip(1).take(2 * n) {
        variable.dependencies = vec![i];
    }
    let dynamics = derivation.function(FunctionKind::ForwardDynamics);
    for i in 0..n {
        all[first + i].dependencies = vec![1 + n + i];
        all[first + n + i].dependencies = dynamics.map(|f| places.used_by(&f.program)).unwrap_or_default();
    }
    let signals = places.signals;
    for i in (0..3 * point.state.prescribed.len()).filter(|i| i % 3 > 0) {
        all[signals + i].derivative_of = Some(signals + i - 1);
    }
    for (i, dependencies) in output_dependencies.into_iter().enumerate() {
        all[first_output + i].dependencies = dependencies;
    }
    if is_of_plain_numbers(derivation) {
        all.iter_mut().for_each(|variable| variable.unit = "1".to_string());
    }
    all
}

/// Whether nothing that was declared has a unit, as in a `#![dimensionless]` mechanism: time is a plain number, too.
fn is_of_plain_numbers(d: &Derivation) -> bool {
    let declared = [&d.coordinates, &d.parameters, &d.inputs, &d.prescribed].into_iter().flatten().map(|v| &v.unit);
    let computed = d.output_units.iter().flatten().chain(d.constraint_units.iter().flatten());
    declared.chain(computed).all(|unit| matches!(unit.as_str(), "" | "1"))
}

/// Variables that are being listed, and the names that are taken.
struct List {
    all: Vec<Variable>,
    taken: BTreeSet<String>,
}

impl List {
    fn with(mut self, role: Role, columns: &[Column], docs: &[String], starts: &[f64]) -> Self {
        for (i, column) in columns.iter().enumerate() {
            let numbered = (2..).map(|k| format!("{}_{k}", column.name));
            let free = std::iter::once(column.name.clone()).chain(numbered).find(|name| !self.taken.contains(name));
            let name = free.expect("there are more numbers than names");
            self.taken.insert(name.clone());
            self.all.push(Variable {
                name,
                role,
                unit: column.unit.clone(),
                description: docs.get(i).cloned().unwrap_or_default(),
                start: starts.get(i).copied(),
                derivative_of: None,
                dependencies: Vec::new(),
            });
        }
        self
    }
}

/// Where the symbols of programs are among the variables.
struct Places {
    dof: usize,
    inputs: usize,
    signals: usize,
}

impl Places {
    fn of(derivation: &Derivation) -> Self {
        let count = |variables: &[Declared]| variables.iter().map(Declared::count).sum::<usize>();
        let inputs = 1 + 4 * derivation.dof();
        Places { dof: derivation.dof(), inputs, signals: inputs + count(&derivation.inputs) }
    }

    /// The states, inputs and time that a program reads.
    fn used_by(&self, program: &Program) -> Vec<usize> {
        let place = |first: usize, i: u32| Some(first + i as usize);
        let symbols = program.instructions.iter().filter_map(|instruction| match *instruction {
            Instruction::Symbol(symbol) => Some(symbol),
            _ => None,
        });
        let used: BTreeSet<usize> = symbols
            .filter_map(|symbol| match symbol {
                Symbol::Time => Some(0),
                Symbol::Coordinate(i) => place(1, i),
                Symbol::Velocity(i) => place(1 + self.dof, i),
                Symbol::Input(i) => place(self.inputs, i),
                Symbol::Prescribed(i, order) => place(self.signals, 3 * i + u32::from(order)),
                Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Multiplier(_) => None,
            })
            .collect();
        used.into_iter().collect()
    }
}

/// The documentation of each component.
fn documented(variables: &[Declared]) -> Vec<String> {
    variables.iter().flat_map(|v| vec![v.docs.join(" "); v.count()]).collect()
}

/// What a derivative is of, by its documentation or its name.
fn about(what: &str, name: &str, doc: &str) -> String {
    if doc.is_empty() { format!("{what} of {name}.") } else { format!("{what}: {doc}") }
}

/// Value, rate and acceleration of each signal.
fn signals(prescribed: &[Declared]) -> (Vec<Column>, Vec<String>) {
    let orders =
        [("", ""), ("_dot", "/s"), ("_ddot", "/s^2")].map(|(suffix, per)| of_variables("", prescribed, suffix, per));
    let columns = (0..orders[0].len()).flat_map(|i| orders.iter().map(move |columns| columns[i].clone())).collect();
    let docs = orders[0].iter().zip(documented(prescribed)).flat_map(|(Column { name, .. }, doc)| {
        let [rate, acceleration] = ["Rate", "Acceleration"].map(|what| about(what, name, &doc));
        [doc, rate, acceleration]
    });
    (columns, docs.collect())
}
