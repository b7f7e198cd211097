//! Inputs and prescribed signals that change while a mechanism moves: formulas in the model language, and tables.
//!
//! `--input "push=2*sin(3*t)"` is a formula of t, the state and the outputs; `--signal "heave=a*sin(w*t)"` one of t and
//! parameters. `--input push=@table.csv` is a table of times and values, straight in between; `--signal
//! heave=@table.csv` likewise by a cubic spline, whose first and second derivative the signal takes. Formulas become
//! part of the declaration, so that they are checked and differentiated as it is: an output for an input, the value of
//! the `prescribed` statement for a signal.
//!
//! An array is given element by element, `road_0=…` or `road[0]=…`, or as a whole, `road=[…, …]` and `road=@table.csv`.
//!
//! In a formula that names nothing but t, numbers are in SI units: `2*sin(3*t)` is `2 N * sin(3 rad/s * t)` of a force.
//! In all others dimensions are checked.

mod element;
mod table;

use std::path::{Path, PathBuf};

use mbs_derive::interpret::State;
use mbs_derive::model::Unit;
use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_derive::parse;
use mbs_derive::parse::{Statement, StatementKind};
use mbs_derive::source::{Insertion, Sources};
use mbs_derive::variable::{Variable, component_names};

use self::element::Kind;
use self::table::{Tables, Wanted};
use super::curve::Curve;
use crate::equations::Equations;
use crate::failure::Failure;
use crate::files::Files;
use crate::message::Messages;
use crate::output;
use crate::state::hint;

/// `name=formula` or `name=@file`.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    /// As in tables: `road_0`.
    name: String,
    /// As given: `road[0]`.
    given: String,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Formula(String),
    Table(PathBuf),
}

impl Drive {
    /// What gives a variable: a formula, or `@` and the file of a table, a path from this folder.
    pub(crate) fn new(name: &str, value: &str, folder: &Path) -> Self {
        let source = match value.trim().strip_prefix('@') {
            Some(file) => Source::Table(folder.join(file)),
            None => Source::Formula(value.trim().to_string()),
        };
        Drive { name: element::column(name), given: name.to_string(), source }
    }

    /// A formula of it, as reports show it.
    fn quoted(&self, option: &str, formula: &str) -> Insertion {
        Insertion::quoted(&format!("{option} {}", self.given), formula)
    }

    /// The file of its table, if it is one.
    pub(crate) fn table(&self) -> Option<&Path> {
        match &self.source {
            Source::Table(path) => Some(path),
            Source::Formula(_) => None,
        }
    }
}

impl std::str::FromStr for Drive {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "write `name=formula` or `name=@table.csv`";
        let (name, value) = text.split_once('=').ok_or(form)?;
        let (name, value) = (name.trim().to_string(), value.trim());
        if name.is_empty() || value.is_empty() {
            Err(form.to_string())
        } else {
            Ok(Drive::new(&name, value, Path::new("")))
        }
    }
}

/// All that was asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drives<'a> {
    /// How messages call the places where inputs and signals are given.
    pub(crate) options: [&'static str; 2],
    pub(crate) inputs: &'a [Drive],
    pub(crate) signals: &'a [Drive],
    /// Parameters for formulas that the mechanism does not have, with their values: `2 N*m`.
    pub(crate) parameters: &'a [(String, String)],
    /// Formulas that give nothing, but are evaluated along the motion: see [`watched`].
    pub(crate) watched: &'a [String],
}

/// What messages of `mbs simulate` call the places where inputs and signals are given.
pub(crate) const OPTIONS: [&str; 2] = ["--input", "--signal"];

impl Drives<'_> {
    /// Notes the files of tables.
    pub(crate) fn note(&self, files: &mut Files) {
        for drive in self.inputs.iter().chain(self.signals) {
            if let Some(path) = drive.table() {
                files.reads("the table", path);
            }
        }
    }

    /// The components of signals that tables give.
    pub(crate) fn signal_names(&self, derivation: &Derivation) -> Vec<String> {
        let of = |drive: &Drive| element::components(&derivation.prescribed, &drive.name).unwrap_or_default();
        self.signals.iter().flat_map(of).map(|(_, name)| name).collect()
    }

    /// The declaration with the formulas in it.
    pub(crate) fn declared(&self, sources: Sources) -> Result<Sources, Failure> {
        let [input, signal] = self.options;
        for (option, drives) in [(input, self.inputs), (signal, self.signals)] {
            let again = |(i, drive): &(usize, &Drive)| drives[..*i].iter().any(|other| other.name == drive.name);
            if let Some((_, drive)) = drives.iter().enumerate().find(again) {
                return Err(Failure::new(format_args!("{option} {} is given twice", drive.name)));
            }
        }
        let mut drives = self.inputs.iter().chain(self.signals);
        let adds = !self.watched.is_empty() || !self.parameters.is_empty();
        if !adds && !drives.any(|drive| matches!(drive.source, Source::Formula(_))) {
            return Ok(sources);
        }
        // What is wrong with the declaration itself is said where it is derived.
        let Ok(declaration) = parse::declaration_of(&sources) else { return Ok(sources) };
        let text = sources.main().text.clone().unwrap_or_default();
        // Those of a robot that it imports stand in a file of their own.
        let own = &declaration.statements[declaration.of_robots..];
        let mut insertions: Vec<(usize, Insertion)> = Vec::new();
        let mut constants = format!("const {SECOND}: s = 1; ");
        for (name, value) in self.parameters {
            let (number, unit) = value.split_once(' ').unwrap_or((value, "1"));
            constants += &format!("param {name}: {unit} = {number}; ");
        }
        let signals = element::declared(&text, &declaration.statements, Kind::Signal);
        for drive in self.signals {
            if let Source::Formula(formula) = &drive.source {
                check_formula(signal, &drive.given, formula)?;
                if !signals.iter().any(|known| known.is_called(&drive.name)) {
                    return Err(unknown(signal, "prescribed signal", &drive.given, &element::names(&signals)));
                }
            }
        }
        for known in &signals {
            let drives: Vec<&Drive> = self.signals.iter().filter(|drive| known.is_called(&drive.name)).collect();
            let value = known.value_of(&drives, signal);
            if let Some(value) = value.map_err(|reason| Failure::new(format_args!("{signal} {reason}")))? {
                insertions.push((known.end, value));
                constants += &unit_constant(&known.name, &known.unit);
            }
        }
        let end = own.last().map_or_else(|| text.rfind('}').unwrap_or(0), |statement| statement.span.end);
        let mut added = Insertion::default();
        let inputs = element::declared(&text, &declaration.statements, Kind::Input);
        for drive in self.inputs {
            let Source::Formula(formula) = &drive.source else { continue };
            // Of what is no input `resolved` says so, and which there are.
            let Some(known) = inputs.iter().find(|known| known.is_called(&drive.name)) else { continue };
            check_formula(input, &drive.given, formula)?;
            let refused = |reason: String| Failure::new(format_args!("{input} {reason}"));
            for (name, formula) in known.formulas_of(drive, drive.quoted(input, formula)).map_err(refused)? {
                if added.text().contains(&format!(" output {} = ", formula_name(&name))) {
                    return Err(Failure::new(format_args!("{input} {name} is given twice")));
                }
                added.push(&outputs_in(formula.text(), &text, own, added.text()));
                constants += &unit_constant(&name, &known.unit);
                added.push(&format!(" output {} = ", formula_name(&name)));
                added.append(in_si_units(&formula, &name));
                added.push(";");
            }
        }
        for (number, formula) in self.watched.iter().enumerate() {
            added.push(&outputs_in(formula, &text, own, added.text()));
            added.push(&format!(" output {} = ", formula_name(&number.to_string())));
            added.append(Insertion::quoted("formula", formula));
            added.push(";");
        }
        insertions.push((end, added));
        let mut before = Insertion::default();
        before.push(&constants);
        insertions.push((own.first().map_or(end, |statement| statement.span.start), before));
        Ok(sources.with_insertions(insertions))
    }

    /// What gives the inputs and signals of a mechanism that was declared [so](Self::declared).
    pub(crate) fn resolved(&self, derivation: &Derivation, span: (f64, f64)) -> Result<Driven, Failure> {
        let (mut driven, mut tables) = (Driven::default(), Tables::default());
        let [input, signal] = self.options;
        for drive in self.inputs {
            let known = element::components(&derivation.inputs, &drive.name);
            let known =
                known.ok_or_else(|| unknown(input, "input", &drive.given, &component_names(&derivation.inputs)))?;
            let beyond = formula_name(&format!("{}_{}", drive.name, known.len()));
            if known.len() > 1 && derivation.functions.iter().any(|f| f.name == beyond) {
                let many = format!("the array has {} elements, the formula more", known.len());
                return Err(Failure::new(format_args!("{input} {}: {many}", drive.given)));
            }
            let is_one_of_several = known.len() > 1;
            for (index, name) in known {
                if driven.inputs.iter().any(|(other, _)| *other == index) {
                    return Err(Failure::new(format_args!("{input} {name} is given twice")));
                }
                let given = match &drive.source {
                    Source::Table(path) => {
                        let unit = unit(&derivation.inputs, index);
                        let wanted = Wanted { name: &name, unit, is_one_of_several };
                        Given::Curve(tables.curve(path, &wanted, span, Curve::broken_line)?)
                    }
                    Source::Formula(_) => Given::Function(formula(input, derivation, index, &name)?),
                };
                driven.inputs.push((index, given));
            }
        }
        for drive in self.signals {
            let Source::Table(path) = &drive.source else { continue };
            let known = element::components(&derivation.prescribed, &drive.name);
            let known = known.ok_or_else(|| {
                unknown(signal, "prescribed signal", &drive.given, &component_names(&derivation.prescribed))
            })?;
            let is_one_of_several = known.len() > 1;
            for (index, name) in known {
                if driven.signals.iter().any(|(other, _)| *other == index) {
                    return Err(Failure::new(format_args!("{signal} {name} is given twice")));
                }
                let unit = unit(&derivation.prescribed, index);
                let wanted = Wanted { name: &name, unit, is_one_of_several };
                let curve = tables.curve(path, &wanted, span, Curve::spline)?;
                if let Some([[least, most], [lowest, highest]]) = curve.overshoot() {
                    driven.doubts.push(format!(
                        "{signal} {name}: the values of the table are from {least} to {most}, the cubic spline through them \
                         goes from {lowest:.3} to {highest:.3}; give more rows where it bends, or `import` the table in the \
                         mechanism and declare the signal by `table_monotone(t, times, values)`, which stays within them"
                    ));
                }
                driven.signals.push((index, curve));
            }
        }
        Ok(driven)
    }
}

/// What inputs and signals are at any time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Driven {
    inputs: Vec<(usize, Given)>,
    signals: Vec<(usize, Curve)>,
    /// What may not have been meant.
    doubts: Vec<String>,
}

#[derive(Clone, Debug)]
enum Given {
    Curve(Curve),
    /// The number of the function that computes it.
    Function(usize),
}

impl Driven {
    /// Warns of what may not have been meant.
    pub(crate) fn warn(&self) {
        self.doubts.iter().for_each(output::warn);
    }

    /// Whether this prescribed signal, by its number, comes from a table.
    pub(crate) fn gives_signal(&self, number: usize) -> bool {
        self.signals.iter().any(|(index, _)| *index == number)
    }

    /// Puts signals, then inputs, into a state.
    pub(crate) fn put(&self, equations: &Equations<'_>, state: &mut State) {
        for (index, curve) in &self.signals {
            state.prescribed[*index] = curve.at(state.t);
        }
        for (index, given) in &self.inputs {
            state.u[*index] = match given {
                Given::Curve(curve) => curve.at(state.t)[0],
                Given::Function(number) => equations.evaluate_number(*number, state),
            };
        }
    }
}

/// Outputs that this stands for are not shown as such.
pub(crate) const FORMULA: &str = "formula_of_";

fn formula_name(input: &str) -> String {
    format!("{FORMULA}{input}")
}

/// One second, for formulas of t alone.
const SECOND: &str = "second_of_formulas";

/// `const unit_of_push: N = 1;`
fn unit_constant(name: &str, unit: &str) -> String {
    format!("const unit_of_{name}: {unit} = 1; ")
}

/// A formula that names nothing but t with its numbers in SI units; any other as it is.
fn in_si_units(formula: &Insertion, name: &str) -> Insertion {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (mut whole, mut changed) = (Insertion::default(), Insertion::default());
    whole.append(formula.clone());
    changed.push(&format!("unit_of_{name}*("));
    let (text, mut at) = (formula.text(), 0);
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = if is_part(c) { rest.find(|c| !is_part(c)).unwrap_or(rest.len()) } else { c.len_utf8() };
        let (word, behind) = rest.split_at(length);
        let is_name = word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let is_known = matches!(word, "pi" | "deg" | "if" | "else") || behind.trim_start().starts_with('(');
        if is_name && !is_known && word != "t" {
            return whole;
        }
        let written = formula.slice(at..at + length);
        if word == "t" {
            changed.push("(");
            changed.append(written);
            changed.push(&format!("/{SECOND})"));
        } else {
            changed.append(written);
        }
        at += length;
    }
    changed.push(")");
    changed
}

/// The function of an input's formula: a number of its unit, that no input enters.
fn formula(option: &str, derivation: &Derivation, index: usize, name: &str) -> Result<usize, Failure> {
    let wanted = formula_name(name);
    let is_value = |f: &Function| matches!(f.kind, FunctionKind::Output(_)) && f.name == wanted;
    let refused = |reason: String| Failure::new(format_args!("{option} {name}: {reason}"));
    let missing = || refused("there is no formula: the array has more elements than the formula".to_string());
    let number = derivation.functions.iter().position(is_value).ok_or_else(missing)?;
    let function = &derivation.functions[number];
    let FunctionKind::Output(output) = function.kind else { return Err(refused("there is no value".to_string())) };
    let unit = unit(&derivation.inputs, index);
    if function.program.results.len() != 1 {
        return Err(refused("an input is one number".to_string()));
    }
    let found = &derivation.output_units[output][0];
    if !Unit(unit).is_shown_as(found) {
        return Err(refused(format!("it is in {unit}, the formula is in {found}")));
    }
    if function.program.uses(|symbol| matches!(symbol, mbs_derive::expr::Symbol::Input(_))) {
        return Err(refused("a formula does not depend on inputs".to_string()));
    }
    Ok(number)
}

/// The number of the function of a watched formula, and the units of what it computes.
pub(crate) fn watched(derivation: &Derivation, number: usize) -> Option<(usize, &[String])> {
    let wanted = formula_name(&number.to_string());
    let place = derivation.functions.iter().position(|f| f.name == wanted)?;
    match derivation.functions[place].kind {
        FunctionKind::Output(output) => Some((place, &derivation.output_units[output])),
        _ => None,
    }
}

/// Where watched formulas stand in the text of a mechanism that was declared with them.
pub(crate) fn places_of_watched(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut places = Vec::new();
    loop {
        let head = format!(" output {} = ", formula_name(&places.len().to_string()));
        let Some(at) = text.find(&head) else { return places };
        let begin = at + head.len();
        places.push(begin..begin + text[begin..].find(';').unwrap_or(0));
    }
}

/// It is one expression, and nothing behind it.
pub(crate) fn check_formula(option: &str, name: &str, formula: &str) -> Result<(), Failure> {
    if formula.contains("//") {
        let reason = "a formula has no comment; leave out what stands behind `//`";
        return Err(Failure::new(format_args!("{option} {name}: {reason}")));
    }
    let name_of_all = format!("{option} {name}");
    let mut text = Insertion::default();
    text.push("mechanism Formula { let value = ");
    text.append(Insertion::quoted(&name_of_all, formula));
    text.push("; }");
    let sources = Sources::new(&name_of_all, "").with_insertions(vec![(0, text)]);
    let declaration = parse::declaration_of(&sources).map_err(|errors| Messages::of(&errors, &sources))?;
    match declaration.statements.len() {
        1 => Ok(()),
        _ => Err(Failure::new(format_args!("{option} {name}: a formula is one expression, without `;`"))),
    }
}

/// Whether a statement declares a variable of this name.
fn declares(statement: &Statement, wanted: &str) -> bool {
    match &statement.kind {
        StatementKind::Param(quantity)
        | StatementKind::Coord(quantity)
        | StatementKind::Input(quantity)
        | StatementKind::Prescribed(quantity)
        | StatementKind::Const(quantity) => quantity.name.text == wanted,
        StatementKind::Let { name, .. } => name.text == wanted,
        _ => false,
    }
}

/// `let` statements for the outputs that a formula names, but for those that are called as the variable they show.
fn outputs_in(formula: &str, text: &str, statements: &[Statement], before: &str) -> String {
    let words: Vec<&str> = formula.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).collect();
    let outputs = statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Output { name, value, .. }
            if words.contains(&name.text.as_str())
                && !statements.iter().any(|statement| declares(statement, &name.text)) =>
        {
            Some(format!(" let {} = {};", name.text, &text[value.span.clone()]))
        }
        _ => None,
    });
    outputs.filter(|line| !before.contains(line.as_str())).collect()
}

fn unknown(option: &str, what: &str, name: &str, known: &[String]) -> Failure {
    let hint = hint(name, known, &format!("{what}s"));
    Failure::new(format_args!("{option}: there is no {what} `{name}`{hint}"))
}

/// The unit of the component with this number.
fn unit(variables: &[Variable], index: usize) -> &str {
    let mut units = variables.iter().flat_map(|v| std::iter::repeat_n(v.unit.as_str(), v.count()));
    units.nth(index).unwrap_or("1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_of_time_alone_are_in_si_units() {
        let check = |formula: &str, expected: &str| {
            assert_eq!(in_si_units(&Insertion::quoted("--input push", formula), "push").text(), expected);
        };
        check("2*sin(3*t)", "unit_of_push*(2*sin(3*(t/second_of_formulas)))");
        check("1.5e-3", "unit_of_push*(1.5e-3)");
        check(
            "if t < 1 { 2 } else { -exp (t*pi) }",
            "unit_of_push*(if (t/second_of_formulas) < 1 { 2 } else { -exp ((t/second_of_formulas)*pi) })",
        );
        check("b*cos(w*t)", "b*cos(w*t)");
        check("-k*x", "-k*x");
    }
}
