//! A plan and its mechanism: all that is wrong with either is found before a member moves.

use std::fs;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mbs_derive::diagnostic::Diagnostics;
use mbs_derive::expr::{Graph, Number};
use mbs_derive::interpret::{State, Violation};
use mbs_derive::model::Unit;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::variable::{Variable, component_names};
use mbs_derive::{Analysis, Error, parse};
use mbs_ensemble::journal::{Identity, digest};
use mbs_ensemble::plan::{Amount, Direction, Located, Named, Reduction};
use mbs_ensemble::table::Column;
use mbs_ensemble::{Design, Fault, Faults, Member, Motion, Plan};
use mbs_native::{Compilers, NotCompiled};

use super::gathering::{Wanted, quantities};
use super::names::{Names, Slot};
use super::start::{RULES, Start};
use crate::cache::Cache;
use crate::equations::{Equations, Native, Redundant};
use crate::failure::Failure;
use crate::files::Files;
use crate::mechanism;
use crate::message::Messages;
use crate::output;
use crate::simulate::assembly::Held;
use crate::simulate::drive::{self, Drive, Driven, Drives};
use crate::simulate::formula::Formula;
use crate::simulate::method::{Accuracy, MOST_STEPS, Method};
use crate::simulate::motion::{Drift, Run, Settings};
use crate::state::Point;

/// The text of a plan, as messages show it.
pub(super) struct Text {
    name: String,
    text: String,
}

impl Text {
    /// Reads a file.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let bytes = fs::read(path).map_err(|error| Failure::new(format_args!("cannot read {name}: {error}")))?;
        let text = String::from_utf8(bytes).map_err(|_| Failure::new(format_args!("{name} is not UTF-8 text")))?;
        Ok(Text { text: text.strip_prefix('\u{feff}').unwrap_or(&text).to_string(), name })
    }

    /// Mistakes at their places.
    fn refused(&self, faults: &Faults) -> Failure {
        let mut diagnostics = Diagnostics::default();
        for Fault { span, message, help } in faults.iter() {
            let diagnostic = diagnostics.data(span.clone(), message.clone());
            if let Some(help) = help {
                diagnostic.help(help.clone());
            }
        }
        Messages::of(&diagnostics, &Sources::new(&self.name, &self.text)).into()
    }

    fn fault(&self, fault: Fault) -> Failure {
        self.refused(&Faults::from(fault))
    }
}

/// What runs the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Engine {
    /// Code of a C compiler.
    Compiled,
    /// The interpreter of the generator.
    Interpreter,
}

impl Engine {
    /// In a sentence: members done by …
    pub(super) fn name(self) -> &'static str {
        match self {
            Engine::Compiled => "compiled code",
            Engine::Interpreter => "the interpreter",
        }
    }

    /// In JSON.
    pub(super) fn key(self) -> &'static str {
        match self {
            Engine::Compiled => "compiled",
            Engine::Interpreter => "interpreter",
        }
    }
}

/// What is integrated, for each member from its own values.
pub(super) struct Study {
    pub(super) design: Design,
    pub(super) columns: Vec<Column>,
    pub(super) identity: Identity,
    derivation: Derivation,
    /// Where the values of what varies go.
    slots: Vec<Slot>,
    /// What all members share.
    base: Point,
    settings: Settings,
    /// How members start where there are constraints.
    start: Start,
    driven: Driven,
    wanted: Vec<Wanted>,
    until: Option<(Formula, Direction)>,
    duration: f64,
    /// Its compiled functions; they are interpreted without.
    native: Option<Native>,
}

impl Study {
    /// Of the plan in a file.
    pub(super) fn read(path: &Path, cache: &Cache, files: &mut Files) -> Result<Study, Failure> {
        let text = Text::read(path)?;
        files.reads("the plan", path);
        let plan = Plan::read(&text.text).map_err(|faults| text.refused(&faults))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Reading { text: &text, plan: &plan, folder }.study(cache, files)
    }

    /// Compiles what members ask for; what is wrong where that cannot be, and members are interpreted as before.
    pub(super) fn compile(&mut self, compilers: &Compilers, cache: &Cache) -> Result<(), NotCompiled> {
        self.native = Some(Native::compiled(&self.derivation, compilers, cache)?);
        Ok(())
    }

    /// What there is to say of how the members started that were done.
    pub(super) fn moved_starts(&self) -> Option<String> {
        self.start.moved()
    }

    /// What runs the equations.
    pub(super) fn engine(&self) -> Engine {
        if self.native.is_some() { Engine::Compiled } else { Engine::Interpreter }
    }

    /// The state and the parameters that a member starts with.
    fn point(&self, values: &[f64]) -> Point {
        let mut point = self.base.clone();
        for (slot, value) in self.slots.iter().zip(values) {
            slot.put(&mut point, *value);
        }
        point
    }
}

impl Motion for Study {
    fn quantities(&self, member: &Member) -> Result<Vec<f64>, String> {
        let point = self.point(&member.values);
        let equations = Equations::new(&self.derivation, &point).map_err(|failure| failure.text())?;
        let mut equations = equations.with_driven(self.driven.clone());
        if let Some(native) = &self.native {
            equations = equations.with_native(native).map_err(|failure| failure.text())?;
        }
        let equations = self.start.on_constraints(equations, member.index, self.settings.redundant_rows)?;
        let run = Run { equations: &equations, settings: &self.settings, is_attended: false };
        quantities(run, point.state.t + self.duration, &self.wanted, self.until)
    }
}

/// Finds what is wrong.
struct Reading<'a> {
    text: &'a Text,
    plan: &'a Plan,
    folder: &'a Path,
}

/// How messages call the places where a plan gives inputs and signals.
const OPTIONS: [&str; 2] = ["[inputs]", "[signals]"];

impl Reading<'_> {
    fn missing<T>(&self, value: Option<T>, message: &str, help: &str) -> Result<T, Failure> {
        value.ok_or_else(|| self.text.fault(Fault::with_help(0..0, message, help)))
    }

    fn study(&self, cache: &Cache, files: &mut Files) -> Result<Study, Failure> {
        let plan = self.plan;
        let file = self.missing(plan.mechanism.as_ref(), "the plan has no mechanism", "`mechanism = \"arm.mbs\"`")?;
        let motion =
            self.missing(plan.motion.as_ref(), "the plan has no motion", "`[motion]`, `duration = \"10 s\"`")?;
        if plan.quantities.is_empty() {
            let help = "`[quantities]`, `highest = { max = \"height\" }`";
            return self.missing(None, "the plan wants no quantities", help);
        }
        self.check_names()?;
        self.check_parameters()?;

        let sources = mechanism::open(&self.folder.join(&file.value), files)?;
        let original = sources.clone();
        let drives = |list: &[Named<Located<String>>]| -> Vec<Drive> {
            list.iter().map(|entry| Drive::new(&entry.name.value, &entry.value.value, self.folder)).collect()
        };
        let (inputs, signals) = (drives(&plan.inputs), drives(&plan.signals));
        let formulas = self.formulas(&sources);
        let watched: Vec<String> = formulas.iter().map(|formula| formula.value.clone()).collect();
        self.check_formulas(&formulas)?;
        let parameters: Vec<(String, String)> = plan.parameters.iter().map(parameter).collect();
        let drives =
            Drives { options: OPTIONS, inputs: &inputs, signals: &signals, parameters: &parameters, watched: &watched };
        drives.note(files);
        let sources = drives.declared(sources)?;
        mechanism::note(mechanism::MECHANISM, &sources, cache, files);
        let proved = mechanism::proved(&sources, cache);
        let derivation = proved.map_err(|failure| self.at_formulas(&sources, &formulas).unwrap_or(failure))?.derivation;

        let names = Names(&derivation);
        let design = plan.design(&names).map_err(|faults| self.text.refused(&faults))?;
        self.warn_of_plain_numbers(&names);
        let mut base = start(&derivation);
        for (name, value) in design.fixed() {
            if let Some(slot) = names.slot(name) {
                slot.put(&mut base, *value);
            }
        }
        let slots = design.variables().iter().filter_map(|variable| names.slot(&variable.name)).collect();
        self.check_given_once(&design)?;
        let duration = self.positive(&motion.duration, "s")?;
        let (wanted, columns) = self.wanted(&derivation, &formulas)?;
        let until = match &motion.until {
            None => None,
            Some(crossing) => Some((self.formula(&derivation, &formulas, &crossing.formula)?.0, crossing.direction)),
        };
        let settings = self.settings(&derivation, duration)?;
        let start = self.start(&derivation, &design, &names)?;
        let driven = drives.resolved(&derivation, (base.state.t, base.state.t + duration))?;
        driven.warn();
        let tables = inputs.iter().chain(&signals).filter_map(Drive::table);
        let identity = self.identity(&original, tables, !derivation.constraints.is_empty())?;
        let study = Study {
            design,
            columns,
            identity,
            derivation,
            slots,
            base,
            settings,
            start,
            driven,
            wanted,
            until,
            duration,
            native: None,
        };
        self.check_members(&study)?;
        Ok(study)
    }

    /// Parameters that are added to the declaration: names of the language, and numbers with units.
    fn check_parameters(&self) -> Result<(), Failure> {
        let mut faults = Vec::new();
        for entry in &self.plan.parameters {
            if !is_word(&entry.name.value) {
                faults.push(Fault::new(entry.name.span.clone(), "a name is made of letters, digits and `_`"));
            }
            let Amount::Text(text) = &entry.value.value else { continue };
            let unit = text.trim().split_once(' ').map_or("1", |(_, unit)| unit);
            if let Err(reason) = Unit(unit).in_si(text.trim()) {
                faults.push(Fault::new(entry.value.span.clone(), format!("{text:?}: {reason}")));
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(self.text.refused(&Faults::from(faults))) }
    }

    /// Quantities are columns: they have names of their own that every reader of tables takes.
    fn check_names(&self) -> Result<(), Failure> {
        let varied: Vec<&str> = self.plan.vary.iter().map(|entry| entry.name.value.as_str()).collect();
        for entry in &self.plan.quantities {
            let Located { value: name, span } = &entry.name;
            let message = match name.as_str() {
                "member" | "stopped" => format!("`{name}` is a column of every table"),
                name if varied.contains(&name) => format!("`{name}` varies, and is a column already"),
                name if !is_word(name) => "a name is made of letters, digits and `_`".to_string(),
                _ => continue,
            };
            return Err(self.text.fault(Fault::new(span.clone(), message)));
        }
        Ok(())
    }

    /// What is given over time is not fixed or varied besides.
    fn check_given_once(&self, design: &Design) -> Result<(), Failure> {
        for entry in &self.plan.inputs {
            let name = &entry.name.value;
            let varies = design.variables().iter().any(|variable| variable.name == *name);
            if varies || design.fixed().iter().any(|(fixed, _)| fixed == name) {
                let message = format!("`{name}` is given over time here, and a value elsewhere");
                return Err(self.text.fault(Fault::new(entry.name.span.clone(), message)));
            }
        }
        Ok(())
    }

    /// All formulas that the declaration does not know yet, each once, in the order of the plan.
    fn formulas(&self, sources: &Sources) -> Vec<Located<String>> {
        let until = self.plan.motion.iter().filter_map(|motion| motion.until.as_ref()).map(|until| &until.formula);
        let text = sources.main().text.clone().unwrap_or_default();
        let mut formulas: Vec<Located<String>> = Vec::new();
        for formula in self.plan.quantities.iter().map(|entry| &entry.value.formula).chain(until) {
            if !Formula::is_word(&formula.value, &text) && formulas.iter().all(|other| other.value != formula.value) {
                formulas.push(formula.clone());
            }
        }
        formulas
    }

    /// Each is one expression.
    fn check_formulas(&self, formulas: &[Located<String>]) -> Result<(), Failure> {
        const HEAD: &str = "mechanism Formula { let value = ";
        let mut faults = Vec::new();
        for formula in formulas {
            let sources = Sources::new("formula", &format!("{HEAD}{}; }}", formula.value));
            match parse::declaration_of(&sources) {
                Err(errors) => {
                    let fault =
                        |error: &mbs_derive::diagnostic::Diagnostic| self.in_formula(formula, HEAD.len(), error);
                    faults.extend(errors.iter().map(fault));
                }
                Ok(declaration) if declaration.statements.len() != 1 => {
                    faults.push(Fault::new(formula.span.clone(), "a formula is one expression, without `;`"));
                }
                Ok(_) => {}
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(self.text.refused(&Faults::from(faults))) }
    }

    /// A mistake in a formula that begins at an offset of another text, at its place in the plan.
    fn in_formula(
        &self,
        formula: &Located<String>,
        offset: usize,
        error: &mbs_derive::diagnostic::Diagnostic,
    ) -> Fault {
        let begin = formula.span.start + 1;
        let is_verbatim = self.text.text.get(begin..).is_some_and(|rest| rest.starts_with(&formula.value));
        let at = |place: usize| begin + place.saturating_sub(offset).min(formula.value.len());
        let span = if is_verbatim { at(error.span.start)..at(error.span.end) } else { formula.span.clone() };
        Fault { span, message: error.message.clone(), help: error.help.clone() }
    }

    /// What is wrong with formulas, at their places in the plan; `None` where it is the mechanism that is wrong.
    fn at_formulas(&self, sources: &Sources, formulas: &[Located<String>]) -> Option<Failure> {
        let graph = Graph::verbatim();
        let Err(Error::Declaration(errors)) = Analysis::of(sources, &graph) else { return None };
        let text = sources.main().text.clone().ok()?;
        let places = drive::places_of_watched(&text);
        let mut faults = Vec::new();
        for error in errors.iter() {
            let place = places.iter().zip(formulas).find(|(place, _)| place.contains(&error.span.start));
            faults.extend(place.map(|(place, formula)| self.in_formula(formula, place.start, error)));
        }
        (!faults.is_empty()).then(|| self.text.refused(&Faults::from(faults)))
    }

    /// What evaluates a formula, and its unit.
    fn formula(
        &self,
        derivation: &Derivation,
        formulas: &[Located<String>],
        formula: &Located<String>,
    ) -> Result<(Formula, String), Failure> {
        let watched: Vec<String> = formulas.iter().map(|formula| formula.value.clone()).collect();
        let found = Formula::resolved(derivation, &formula.value, &watched);
        found.ok_or_else(|| self.text.fault(Fault::new(formula.span.clone(), "a quantity is one number")))
    }

    fn wanted(
        &self,
        derivation: &Derivation,
        formulas: &[Located<String>],
    ) -> Result<(Vec<Wanted>, Vec<Column>), Failure> {
        let (mut wanted, mut columns) = (Vec::new(), Vec::new());
        for entry in &self.plan.quantities {
            let (formula, unit) = self.formula(derivation, formulas, &entry.value.formula)?;
            let (name, reduction) = (entry.name.value.clone(), entry.value.reduction.clone());
            let unit = match reduction {
                Reduction::Final | Reduction::Min | Reduction::Max | Reduction::Mean => unit,
                Reduction::TimeOf(_) => "s".to_string(),
                Reduction::Count(_) | Reduction::Happened(_) => "1".to_string(),
            };
            columns.push(Column::new(&name, &unit));
            wanted.push(Wanted { name, formula, reduction });
        }
        Ok((wanted, columns))
    }

    fn number(&self, amount: &Located<Amount>, unit: &str) -> Result<f64, Failure> {
        match &amount.value {
            Amount::Number(number) => Ok(*number),
            Amount::Text(text) => Unit(unit)
                .in_si(text)
                .map_err(|reason| self.text.fault(Fault::new(amount.span.clone(), format!("{text:?}: {reason}")))),
        }
    }

    fn positive(&self, amount: &Located<Amount>, unit: &str) -> Result<f64, Failure> {
        let number = self.number(amount, unit)?;
        let message = format!("it must be positive, it is {number:?}");
        if number > 0.0 { Ok(number) } else { Err(self.text.fault(Fault::new(amount.span.clone(), message))) }
    }

    /// A word that is none of those that an option of `mbs simulate` takes.
    fn unknown_word<E: ValueEnum>(&self, what: &str, word: &Located<String>) -> Failure {
        let values = E::value_variants().iter().filter_map(ValueEnum::to_possible_value);
        let known: Vec<String> = values.map(|value| value.get_name().to_string()).collect();
        self.text.fault(Fault::unknown(word.span.clone(), what, &word.value, &known))
    }

    fn settings(&self, derivation: &Derivation, duration: f64) -> Result<Settings, Failure> {
        let motion = self.missing(self.plan.motion.as_ref(), "the plan has no motion", "`[motion]`")?;
        let method = match &motion.method {
            None => Method::Dop853,
            Some(name) => {
                Method::from_str(&name.value, false).map_err(|_| self.unknown_word::<Method>("method", name))?
            }
        };
        let redundant = match &motion.redundant {
            None => Redundant::Refuse,
            Some(name) => Redundant::from_str(&name.value, false)
                .map_err(|_| self.unknown_word::<Redundant>("way with redundant constraints", name))?,
        };
        let step = motion.step.as_ref().map(|step| self.positive(step, "s")).transpose()?;
        let longest = motion.max_step.as_ref().map(|step| self.positive(step, "s")).transpose()?;
        let has_control = method.has_error_control();
        let of_control = [
            (motion.relative.as_ref().map(|value| &value.span), "rtol"),
            (motion.absolute.as_ref().map(|value| &value.span), "atol"),
            (motion.max_step.as_ref().map(|step| &step.span), "max_step"),
        ];
        let given = of_control.into_iter().find_map(|(span, name)| Some((span?, name)));
        if let Some((span, name)) = given.filter(|_| !has_control) {
            let message = format!("the method has no error control, `{name}` does nothing");
            return Err(self.text.fault(Fault::new(span.clone(), message)));
        }
        if let (Some(step), true) = (&motion.step, has_control) {
            let fault = Fault::new(step.span.clone(), "the method chooses its steps itself, `step` does nothing");
            return Err(self.text.fault(fault));
        }
        Ok(Settings {
            method,
            accuracy: Accuracy {
                relative: motion.relative.as_ref().map_or(1e-10, |value| value.value),
                absolute: motion.absolute.as_ref().map_or(1e-12, |value| value.value),
                step: step.unwrap_or(duration / 1000.0),
                longest: longest.unwrap_or(duration / 100.0),
                most_steps: MOST_STEPS,
            },
            drift: Drift::Projected,
            redundant_rows: redundant.into(),
            held: Held::nothing(derivation.dof()),
        })
    }

    /// What members start with, where constraints may move it.
    fn start(&self, derivation: &Derivation, design: &Design, names: &Names<'_>) -> Result<Start, Failure> {
        let hold = self.plan.motion.as_ref().and_then(|motion| motion.hold.as_ref());
        let held = hold.map(|words| self.held(words, derivation)).transpose()?;
        let varied = design.variables().iter().map(|variable| variable.name.as_str());
        let fixed = design.fixed().iter().map(|(name, _)| name.as_str());
        let slots = |list: &mut dyn Iterator<Item = &str>| list.filter_map(|name| names.slot(name)).collect();
        let [varied, fixed]: [Vec<Slot>; 2] = [slots(&mut { varied }), slots(&mut { fixed })];
        Ok(Start::new(derivation, &varied, &fixed, held))
    }

    /// What the key `hold` names.
    fn held(&self, words: &[Located<String>], derivation: &Derivation) -> Result<Held, Failure> {
        if let (Some(first), true) = (words.first(), derivation.constraints.is_empty()) {
            let message = format!("{} has no constraints, `hold` does nothing", derivation.name);
            return Err(self.text.fault(Fault::new(first.span.clone(), message)));
        }
        Held::named(words.iter().map(|word| word.value.as_str()), derivation, "hold").map_err(|number| {
            let Located { value, span } = &words[number];
            let known = component_names(&derivation.coordinates);
            self.text.fault(Fault::unknown(span.clone(), "coordinate", value, &known))
        })
    }

    /// A number without a unit is in SI units; where the declaration is in others, that may not be what was meant.
    fn warn_of_plain_numbers(&self, names: &Names<'_>) {
        let fixed = self.plan.fixed.iter().map(|entry| (&entry.name, vec![&entry.value]));
        let varied = self.plan.vary.iter().map(|entry| (&entry.name, entry.value.value.amounts()));
        for (name, amounts) in fixed.chain(varied) {
            let is_plain = |amount: &&Located<Amount>| matches!(amount.value, Amount::Number(x) if x != 0.0);
            if let (Some((declared, unit)), true) = (names.declared_unit(&name.value), amounts.iter().any(is_plain)) {
                let (plan, name) = (&self.text.name, &name.value);
                output::warn(format_args!(
                    "{plan}: `{name}` is declared in {declared}; a plain number is in {unit}, write it with its unit, \
                     \"20 {declared}\""
                ));
            }
        }
    }

    /// Digests of all that decides on the table.
    fn identity<'p>(
        &self,
        sources: &Sources,
        tables: impl Iterator<Item = &'p Path>,
        is_constrained: bool,
    ) -> Result<Identity, Failure> {
        let mut texts = Vec::new();
        for number in 0..sources.count() {
            let text = sources.file(number).text.as_deref().unwrap_or_default();
            texts.extend((text.len() as u64).to_le_bytes());
            texts.extend(text.as_bytes());
        }
        let mut contents = Vec::new();
        for table in tables {
            let name = table.display();
            let bytes = fs::read(table).map_err(|error| Failure::new(format_args!("cannot read {name}: {error}")))?;
            contents.extend((bytes.len() as u64).to_le_bytes());
            contents.extend(bytes);
        }
        let mut parts = vec![
            ("program", format!("mbs {}", env!("CARGO_PKG_VERSION"))),
            ("plan", digest(self.text.text.as_bytes())),
            ("mechanism", digest(&texts)),
        ];
        if !contents.is_empty() {
            parts.push(("tables", digest(&contents)));
        }
        if is_constrained {
            parts.push(("start of members", RULES.to_string()));
        }
        Ok(Identity::new(parts))
    }

    /// The mechanism can have the parameters of every member.
    fn check_members(&self, study: &Study) -> Result<(), Failure> {
        let varies = study.slots.iter().any(|slot| matches!(slot, Slot::Parameter(_)));
        let members = if varies { study.design.members() } else { 1 };
        let (mut first, mut count) = (None, 0_u64);
        for index in 0..members {
            let point = study.point(&study.design.values(index));
            if let Some(violation) = Violation::all(&study.derivation, &point.parameters).into_iter().next() {
                count += 1;
                first.get_or_insert((index, violation));
            }
        }
        let Some((index, Violation { quantity, value, must })) = first else { return Ok(()) };
        let entries = self.plan.vary.iter().map(|entry| &entry.name).chain(self.plan.fixed.iter().map(|e| &e.name));
        let place = entries.clone().find(|name| name.value == quantity).or(entries.clone().next());
        let span = place.map_or(0..0, |name| name.span.clone());
        let message =
            format!("member {index} cannot be: `{quantity}` {must}, it is {value:?}; {count} of {members} are such");
        let help = "cut the distribution off, `within = [lowest, highest]`, or let it be lognormal";
        Err(self.text.fault(Fault::with_help(span, message, help)))
    }
}

/// Whether a text is a name of the language.
fn is_word(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A parameter's name and its value as the language writes it: `2.5 N*m`.
fn parameter(entry: &Named<Located<Amount>>) -> (String, String) {
    let value = match &entry.value.value {
        Amount::Number(number) => format!("{number:?}"),
        Amount::Text(text) => text.trim().to_string(),
    };
    (entry.name.value.clone(), value)
}

/// Parameters as declared, all else zero.
fn start(derivation: &Derivation) -> Point {
    let count = |variables: &[Variable]| component_names(variables).len();
    let state = State {
        t: 0.0,
        q: vec![0.0; derivation.dof()],
        qd: vec![0.0; derivation.dof()],
        qdd: vec![0.0; derivation.dof()],
        u: vec![0.0; count(&derivation.inputs)],
        prescribed: vec![[0.0; 3]; count(&derivation.prescribed)],
    };
    let parameters = derivation.parameters.iter().flat_map(|p| &p.defaults).map(|&n| Number::to_f64(n)).collect();
    Point { state, accelerations_are_given: false, parameters }
}

/// The plan's file with another ending: where its table goes.
pub(super) fn table_of(plan: &Path) -> PathBuf {
    plan.with_extension("csv")
}
