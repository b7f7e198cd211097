//! What functions are to give, as each language writes it: values are slots of a text, `⟨17⟩`.

use std::collections::HashSet;

use crate::emit::{Identifiers, Options};
use crate::expr::Symbol;
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind, Program};
use crate::shape::Shape;
use crate::variable::{Variable, count};

use super::super::meaning::{Expectation, Meaning, System, shaped, width};
use super::super::numbering::{Number, Numbering};
use super::super::reading::Reading;
use super::dialect::{Dialect, Family};
use super::expression::Value;

/// A text that is expected.
pub(super) struct Expected {
    /// With slots: `⟨17⟩` for the value with this number, `⟨⟩` for statements, `⟨function 3⟩` where one begins,
    /// `⟨fields⟩` for those of what the constructor computes, `⟨shared⟩` for what all files of the language share,
    /// `⟨stored result 7 12⟩` for what is written to an array of the caller, the slots from 7 to before 12.
    pub(super) text: String,
    pub(super) numbers: Vec<Number>,
    pub(super) scopes: Vec<Scope>,
    /// What evaluates the spline with a number, in C.
    pub(super) table: String,
    /// The constant that says how many numbers a mechanism is.
    pub(super) numbers_name: String,
    /// What the text itself defines.
    pub(super) own: HashSet<String>,
}

/// What the statements of a function see.
pub(super) struct Scope {
    /// Its name, for a report.
    pub(super) function: String,
    pub(super) names: Vec<(String, Value)>,
    pub(super) is_constructor: bool,
}

/// An argument of a function: its name, and how many numbers it is; a number has none.
pub(super) type Argued = (&'static str, Option<usize>);

/// What a function is to give, in slots.
pub(super) struct Routine<'d> {
    pub(super) function: &'d Function,
    /// Its name in the text, and that by which callers know it.
    pub(super) name: String,
    pub(super) known_as: String,
    pub(super) arguments: Vec<Argued>,
    /// `⟨function 3⟩`
    pub(super) begin: String,
    pub(super) ending: Ending,
    /// Names of parts and their shapes.
    pub(super) parts: Vec<(&'static str, Shape)>,
    /// Of each part: of what is solved the right sides.
    pub(super) values: Vec<Vec<String>>,
    /// Of what is solved M, row by row, and A.
    pub(super) masses: Vec<String>,
    pub(super) jacobian: Vec<String>,
}

/// How results come from values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// They are the results.
    Values,
    /// `M⁻¹` of right sides; whether that is at the accelerations of the motion.
    Solve {
        in_motion: bool,
    },
    /// The constrained motion.
    Motion,
    /// Its accelerations, or its multipliers.
    Accelerations,
    Multipliers,
    /// Its derivatives; whether multipliers are read for them.
    Slopes {
        of_multipliers: bool,
    },
}

impl Routine<'_> {
    /// How many columns each part has.
    pub(super) fn widths(&self) -> Vec<usize> {
        self.function.results.iter().map(width).collect()
    }
}

/// Makes slots.
pub(super) struct Sheet<'d, 'n> {
    pub(super) derivation: &'d Derivation,
    pub(super) dialect: Dialect,
    pub(super) is_library: bool,
    pub(super) identifiers: Identifiers,
    numbering: &'n mut Numbering,
    expectation: Expectation<'d>,
    numbers: Vec<Number>,
    scopes: Vec<Scope>,
}

impl<'d, 'n> Sheet<'d, 'n> {
    pub(super) fn new(
        derivation: &'d Derivation,
        dialect: Dialect,
        options: &Options,
        numbering: &'n mut Numbering,
    ) -> Reading<Self> {
        let identifiers = Identifiers::of(dialect.language, derivation, options);
        are_spelled(&identifiers, derivation, options)?;
        let is_library = options.trigonometry == crate::emit::Trigonometry::Library;
        let expectation = Expectation::new(derivation, numbering);
        let (numbers, scopes) = (Vec::new(), Vec::new());
        Ok(Sheet { derivation, dialect, is_library, identifiers, numbering, expectation, numbers, scopes })
    }

    pub(super) fn finished(self, text: String) -> Expected {
        let Identifiers { mechanism: prefix, class, functions, .. } = &self.identifiers;
        let functions = functions.iter().flat_map(|(_, name, known_as)| [name, known_as]);
        let own = functions.chain([prefix, class]).cloned().collect();
        Expected {
            own,
            text,
            numbers: self.numbers,
            scopes: self.scopes,
            table: format!("{prefix}_table_"),
            numbers_name: format!("{}_NUMBERS", prefix.to_uppercase()),
        }
    }

    fn slot(&mut self, number: Number) -> String {
        self.numbers.push(number);
        format!("⟨{}⟩", self.numbers.len() - 1)
    }

    fn slots(&mut self, numbers: &[Number]) -> Vec<String> {
        numbers.iter().map(|&number| self.slot(number)).collect()
    }

    pub(super) fn constant(&mut self, value: f64) -> String {
        let number = self.numbering.constant(value);
        self.slot(number)
    }

    /// A parameter's declared value, with these brackets around lists.
    pub(super) fn defaults(&mut self, parameter: &Variable, list: &dyn Fn(&[String]) -> String) -> String {
        let values: Vec<String> = parameter.defaults.iter().map(|value| self.constant(value.to_f64())).collect();
        match (parameter.length, parameter.columns) {
            (None, _) => values[0].clone(),
            (Some(_), None) => list(&values),
            (Some(_), Some(columns)) => list(&values.chunks(columns).map(list).collect::<Vec<_>>()),
        }
    }

    /// A component of a parameter, as a value.
    pub(super) fn parameter(&mut self, component: usize) -> String {
        let number = self.numbering.symbol(Symbol::Parameter(component as u32));
        self.slot(number)
    }

    /// What is required of parameters besides: the values.
    pub(super) fn required(&mut self) -> Vec<String> {
        let numbers = self.numbering.results(&self.derivation.required, &[], |_| false);
        self.slots(&numbers)
    }

    /// A scope with the parameters behind this.
    pub(super) fn scope(&mut self, function: &str, parameters: &str, is_constructor: bool) -> String {
        let names = self.derivation.parameters.iter().zip(&self.identifiers.parameters);
        let names = names.map(|(parameter, field)| {
            let symbol = |i: usize| self.numbering.symbol(Symbol::Parameter((parameter.first + i) as u32));
            let numbers: Vec<Number> = (0..parameter.count()).map(symbol).collect();
            let value = match numbers.as_slice() {
                [number] if parameter.length.is_none() => Value::Number(*number),
                numbers => Value::Array(parameter.lengths().into(), numbers.into()),
            };
            (format!("{parameters}{field}"), value)
        });
        let names = names.collect();
        self.scopes.push(Scope { function: function.to_string(), names, is_constructor });
        format!("⟨function {}⟩", self.scopes.len() - 1)
    }

    /// Forward dynamics, where constraints are solved for it.
    pub(super) fn constrained(&self) -> Option<&'d Function> {
        let derivation = self.derivation;
        let is_needed =
            self.identifiers.functions.iter().any(|(i, ..)| derivation.functions[*i].completion.is_constrained());
        derivation.function(FunctionKind::ForwardDynamics).filter(|_| is_needed)
    }

    /// All functions; before those with constraints what they have in common.
    pub(super) fn routines(&mut self, parameters: &str) -> Vec<Routine<'d>> {
        let mut routines = Vec::new();
        if let Some(function) = self.constrained() {
            let name = self.identifiers.motion.clone();
            routines.push(self.routine(function, (name.clone(), name), parameters, true));
        }
        for (number, name, known_as) in self.identifiers.functions.clone() {
            let function = &self.derivation.functions[number];
            routines.push(self.routine(function, (name, known_as), parameters, false));
        }
        routines
    }

    fn routine(
        &mut self,
        function: &'d Function,
        (name, known_as): (String, String),
        parameters: &str,
        is_motion: bool,
    ) -> Routine<'d> {
        let reads = |is_it: fn(Symbol) -> bool| function.program.uses(is_it);
        let ending = match function.completion {
            _ if is_motion => Ending::Motion,
            Completion::None => Ending::Values,
            Completion::Solve => Ending::Solve { in_motion: reads(|symbol| matches!(symbol, Symbol::Acceleration(_))) },
            Completion::SolveMultipliers => Ending::Multipliers,
            Completion::SolveConstrained if function.kind == FunctionKind::ForwardDynamics => Ending::Accelerations,
            Completion::SolveConstrained => {
                Ending::Slopes { of_multipliers: reads(|symbol| matches!(symbol, Symbol::Multiplier(_))) }
            }
        };
        let begin = self.scope(&function.name, parameters, false);
        let arguments = self.arguments(function, ending);
        let (mut masses, mut jacobian) = (Vec::new(), Vec::new());
        let values = match ending {
            Ending::Accelerations | Ending::Multipliers => Vec::new(),
            Ending::Values => {
                let results = self.expectation.results(function, self.numbering);
                let mut results = results.into_iter().map(Meaning::Number);
                let part = |shape| flat(&shaped(shape, &mut results));
                let parts: Vec<Vec<Number>> = function.results.iter().map(|part| part.shape).map(part).collect();
                parts.iter().map(|numbers| self.slots(numbers)).collect()
            }
            Ending::Solve { .. } | Ending::Motion | Ending::Slopes { .. } => {
                let system = self.expectation.system(function, self.numbering);
                let System { mass_matrix, jacobian: constraints, right_sides, .. } = system;
                (masses, jacobian) = (self.slots(&mass_matrix), self.slots(&constraints));
                right_sides.iter().map(|numbers| self.slots(numbers)).collect()
            }
        };
        let parts = match ending {
            Ending::Motion => {
                let [n, rows] = [self.derivation.dof(), self.derivation.constraints.len()];
                vec![("qdd", Shape::Vector(n)), ("multipliers", Shape::Vector(rows))]
            }
            _ => function.results.iter().map(|part| (part.name, part.shape)).collect(),
        };
        Routine { function, name, known_as, arguments, begin, ending, parts, values, masses, jacobian }
    }

    /// The arguments of a function, which are made known in its scope, with what it finds itself.
    fn arguments(&mut self, function: &Function, ending: Ending) -> Vec<Argued> {
        let signals = count(&self.derivation.prescribed);
        let mut names = Vec::new();
        let mut arguments: Vec<Argued> = Vec::new();
        if self.derivation.depends_on_time {
            arguments.push(("t", None));
            names.push(("t", Value::Number(self.numbering.symbol(Symbol::Time))));
        }
        if signals > 0 {
            let of = |i| Symbol::Prescribed(i as u32 / 3, (i % 3) as u8);
            let numbers: Vec<Number> = (0..3 * signals).map(|i| self.numbering.symbol(of(i))).collect();
            let lengths = if self.dialect.family == Family::C { vec![3 * signals] } else { vec![signals, 3] };
            names.push(("prescribed", Value::Array(lengths.into(), numbers.into())));
            arguments.push(("prescribed", Some(signals)));
        }
        for &argument in &function.arguments {
            let (count, symbol) = self.expectation.components(argument);
            if count > 0 {
                let numbers = (0..count as u32).map(|i| self.numbering.symbol(symbol(i))).collect();
                names.push((argument.name(), Value::vector(numbers)));
                arguments.push((argument.name(), Some(count)));
            }
        }
        let found: &[Argument] = match ending {
            Ending::Solve { in_motion: true } => &[Argument::Qdd],
            Ending::Slopes { .. } => &[Argument::Qdd, Argument::Multipliers],
            _ => &[],
        };
        for &argument in found {
            let numbers = flat(&self.expectation.of_the_motion(argument, self.numbering));
            names.push((argument.name(), Value::vector(numbers)));
        }
        let names = names.into_iter().map(|(name, value)| (name.to_string(), value));
        self.scopes.last_mut().expect("a function has begun").names.extend(names);
        arguments
    }

    /// Values of forward dynamics, in a scope of all that there is.
    pub(super) fn switches(&mut self, program: Option<&Program>, values: Vec<crate::optimise::Value>) -> Vec<String> {
        let Some(function) = self.derivation.function(FunctionKind::ForwardDynamics) else { return Vec::new() };
        self.arguments(function, Ending::Values);
        let program = program.map(|program| Program { results: values, ..program.clone() }).unwrap_or_default();
        let numbers = self.numbering.results(&program, &self.expectation.hoisted, |_| false);
        self.slots(&numbers)
    }

    /// The name of forward dynamics in the text.
    pub(super) fn forward_dynamics(&self) -> String {
        let functions = &self.derivation.functions;
        let found =
            self.identifiers.functions.iter().find(|(i, ..)| functions[*i].kind == FunctionKind::ForwardDynamics);
        found.map(|(_, name, _)| name.clone()).unwrap_or_default()
    }

    /// The vector that each constraint is of.
    pub(super) fn vectors(&self) -> String {
        joined(&self.derivation.constraint_vectors, ", ")
    }

    /// The kinds of coordinates, by which columns of a linearization are measured.
    pub(super) fn kinds(&self) -> String {
        joined(&self.derivation.coordinate_kinds(), ", ")
    }

    /// How many inputs there are.
    pub(super) fn inputs(&self) -> usize {
        count(&self.derivation.inputs)
    }

    /// All components of parameters, where a function gives derivatives by them.
    pub(super) fn sizes(&mut self, routine: &Routine<'_>) -> Option<Vec<String>> {
        let of_parameters = routine.function.kind == FunctionKind::LinearizeParameters;
        of_parameters.then(|| (0..count(&self.derivation.parameters)).map(|i| self.parameter(i)).collect())
    }
}

/// Numbers as they are written, with this between them.
pub(super) fn joined(values: &[impl ToString], between: &str) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(between)
}

/// The numbers of a result, one after the other.
fn flat(meaning: &Meaning) -> Vec<Number> {
    match meaning {
        Meaning::Number(number) => vec![*number],
        Meaning::List(parts) | Meaning::Tuple(parts) => parts.iter().flat_map(flat).collect(),
        // A position comes before a rotation, a force before a moment.
        Meaning::Record(_, fields) => fields.values().flat_map(flat).collect(),
        _ => Vec::new(),
    }
}

/// An error unless names spell what they are names of, each another one.
fn are_spelled(identifiers: &Identifiers, derivation: &Derivation, options: &Options) -> Reading<()> {
    let functions = &derivation.functions;
    let is_asked_for = |name: &String| options.functions.as_ref().is_none_or(|names| names.contains(name));
    let is_there = |i: usize| identifiers.functions.iter().any(|(number, ..)| *number == i);
    if let Some((_, missing)) =
        functions.iter().enumerate().find(|(i, function)| is_asked_for(&function.name) && !is_there(*i))
    {
        return Err(format!("`{}` is missing", missing.name));
    }
    let fields = identifiers.parameters.iter().zip(derivation.parameters.iter().map(|parameter| &parameter.name));
    let names = identifiers.functions.iter().map(|(i, name, _)| (name, &functions[*i].name));
    let known = identifiers.functions.iter().map(|(i, _, known_as)| (known_as, &functions[*i].name));
    let (mut fields, mut names, mut known): (Vec<_>, Vec<_>, Vec<_>) =
        (fields.collect(), names.collect(), known.collect());
    for list in [&mut fields, &mut names, &mut known] {
        // MATLAB's names have no more than 63 letters.
        let spells = |(name, of): &&(&String, &String)| {
            name.contains(of.as_str()) || (name.len() == 63 && name.contains(&of[..40]))
        };
        if let Some((wrong, of)) = list.iter().find(|pair| !spells(pair)) {
            return Err(format!("`{wrong}` instead of `{of}`"));
        }
        list.sort_unstable();
        if let Some(twice) = list.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(format!("`{}` is there twice", twice[0].0));
        }
    }
    Ok(())
}
