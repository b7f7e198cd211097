//! One walk over a [`Derivation`] for languages that are not Rust: what stands in each function, in which order, with
//! which names and documentation. A language says how that is written: [`Syntax`].
//!
//! - `expression`: values; `pieces`: of what all files of a language share, the part that one needs;
//! - `js`, `python`, `matlab`: the languages, each with its part of that beside it.
//!
//! What is computed on demand in Rust is computed at once: it has no effect but time.

mod expression;
pub(super) mod js;
pub(super) mod matlab;
mod pieces;
pub(super) mod python;

use std::collections::BTreeSet;

use crate::expr::{Symbol, Trigonometry};
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind};
use crate::shape::Shape;
use crate::variable::{self, Variable};

use super::body::{Angle, Block, Body, Component, Statement};
use super::expression::Tree;
use super::name::{Names, snake_case};
use super::text::each_leaf;
use super::{Options, doc, item, shape};

/// How a language is written.
trait Syntax {
    /// The identifier for a name of Rust.
    fn identifier(&self, name: &str) -> String;
    /// The shortest literal that reads back as a value.
    fn constant(&self, value: f64) -> String;
    /// A value that depends on parameters alone, in a function.
    fn hoisted(&self, name: &str) -> String;
    /// Both conditions.
    fn and(&self) -> &'static str;
    /// Not the condition.
    fn not(&self) -> &'static str;
    /// One of two values that are known.
    fn select(&self, condition: &str, then: &str, otherwise: &str) -> String;
    /// A function of the language, by its name on `Scalar`; `own_sin`, `own_cos` give the same bits everywhere.
    fn call(&self, name: &str, arguments: &[String]) -> String;
    /// Gives a value a name.
    fn bind(&self, name: &str, value: &str) -> String;
    /// Sine and cosine of an angle, by the function that gives the same bits everywhere.
    fn sin_cos(&self, names: [&str; 2], angle: &str) -> String;
    /// Derivatives of these orders of the spline with a number.
    fn spline(&self, names: &[String], table: usize, orders: &[usize], x: &str) -> Vec<String>;
    /// Gives values names, of one side or the other.
    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String>;
    /// What a function reads.
    fn read(&self, place: &Place<'_>) -> String;
}

/// One side of a branch: its lines, and the values.
struct Side {
    lines: Vec<String>,
    values: Vec<String>,
}

/// Where a function finds a number.
enum Place<'d> {
    /// The component of an argument.
    Argument(&'static str, usize),
    /// The derivative of this order of a prescribed motion.
    Prescribed(usize, usize),
    /// The component of a parameter; of a number no indices.
    Parameter(&'d str, Vec<usize>),
}

/// An argument of a function: its name, and how many numbers it is; a number has none.
type Argued = (&'static str, Option<usize>);

/// A function, as far as all languages agree.
struct Routine {
    /// Its name in Rust, without an escape.
    name: String,
    docs: Vec<String>,
    arguments: Vec<Argued>,
    /// Names of what it returns, empty where it is one thing, and shapes.
    parts: Vec<(String, Shape)>,
    /// What the program needs before: nothing, or the motion.
    motion: Motion,
    lines: Vec<String>,
    /// Of the results; of what is solved M, row by row, A, and the right sides.
    values: Vec<String>,
    ending: Ending,
}

/// What a program is evaluated at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Motion {
    /// What the caller gives.
    Given,
    /// `qdd` of forward dynamics.
    Accelerations,
    /// `qdd` and `multipliers` of the constrained motion.
    Constrained,
}

/// How results come from values.
enum Ending {
    /// They are the results.
    Values,
    /// `M⁻¹` of right sides.
    Solve,
    /// The constrained motion: `qdd`, then `multipliers`.
    Motion,
    /// One of these, of the constrained motion, without a program.
    OfMotion(&'static str),
    /// Derivatives of the constrained motion: how large that is by which each column is one.
    Slopes(Sizes),
}

/// How large that is by which columns are derivatives.
enum Sizes {
    /// Of coordinates of these kinds, of their rates, and of this many inputs.
    State(Vec<usize>, usize),
    /// The parameters.
    Parameters(Vec<String>),
}

/// A mechanism, to be written.
struct Walk<'d> {
    derivation: &'d Derivation,
    names: Names,
    functions: Vec<(usize, &'d Function)>,
    source: &'d str,
    /// Whether the language's own sine and cosine are called.
    library_sines: bool,
}

/// What a body is written with.
struct Writer<'w, 'n> {
    body: &'w Body<'n>,
    syntax: &'w dyn Syntax,
    library_sines: bool,
}

impl<'d> Walk<'d> {
    fn new(derivation: &'d Derivation, source: &'d str, options: &Options) -> Self {
        let functions = item::selected(derivation, options.functions.as_deref());
        Walk {
            derivation,
            names: Names::of(derivation, true, options.trigonometry),
            functions,
            source,
            library_sines: options.trigonometry == Trigonometry::Library,
        }
    }

    /// The mechanism's name in snake case.
    fn snake_case(&self) -> String {
        snake_case(&self.derivation.name)
    }

    /// What stands on top.
    fn docs(&self) -> Vec<String> {
        let functions: Vec<&Function> = self.functions.iter().map(|(_, f)| *f).collect();
        let source: String = self.source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let first = format!("Generated by mbs {} from {source}. Do not edit.", env!("CARGO_PKG_VERSION"));
        [first, String::new()].into_iter().chain(doc::mechanism(self.derivation, &functions)).collect()
    }

    /// Parameters with the names of their fields, without escapes.
    fn parameters(&self) -> impl Iterator<Item = (&'d Variable, String)> + '_ {
        self.derivation.parameters.iter().zip(&self.names.fields).map(|(parameter, field)| (parameter, plain(field)))
    }

    /// Forward dynamics, where constraints are solved for it.
    fn constrained(&self) -> Option<(usize, &'d Function)> {
        let is_needed = self.functions.iter().any(|(_, f)| f.completion.is_constrained());
        let all = || self.derivation.functions.iter().enumerate();
        is_needed.then(|| all().find(|(_, f)| f.kind == FunctionKind::ForwardDynamics)).flatten()
    }

    fn hoisted(&self) -> Vec<usize> {
        let functions = self.functions.iter().map(|(_, function)| *function);
        item::hoisted(self.derivation, functions.chain(self.constrained().map(|(_, function)| function)))
    }

    fn writer<'w>(&self, body: &'w Body<'d>, syntax: &'w dyn Syntax) -> Writer<'w, 'd> {
        Writer { body, syntax, library_sines: self.library_sines }
    }

    /// The lines of the constructor, then names and values of what depends on parameters alone.
    fn constructor(&self, syntax: &dyn Syntax) -> (Vec<String>, Vec<(String, String)>) {
        let hoisted = self.hoisted();
        let components: Vec<Component> =
            hoisted.iter().map(|&k| Component::Result(k, self.names.hoisted[k].clone())).collect();
        let body = Body::new(&self.derivation.constructor, &components, &self.names, self.names.constructor_scope());
        let writer = self.writer(&body, syntax);
        let values = body.block.results.iter().map(|tree| writer.print(tree));
        let names = hoisted.iter().map(|&k| self.names.hoisted[k].clone());
        (self.lines(&writer), names.zip(values).collect())
    }

    /// All functions; before those with constraints what they have in common.
    fn routines(&self, syntax: &dyn Syntax) -> Vec<Routine> {
        let motion = self.constrained().map(|(number, function)| {
            let mut motion = self.routine(number, function, syntax, true);
            motion.name = plain(&self.names.constrained_motion);
            motion.docs = vec!["Accelerations and multipliers.".to_string()];
            motion.parts = vec![
                ("qdd".to_string(), Shape::Vector(self.derivation.dof())),
                ("multipliers".to_string(), Shape::Vector(self.derivation.constraints.len())),
            ];
            motion
        });
        let functions = self.functions.iter().map(|(number, function)| self.routine(*number, function, syntax, false));
        motion.into_iter().chain(functions).collect()
    }

    fn routine(&self, number: usize, function: &Function, syntax: &dyn Syntax, is_motion: bool) -> Routine {
        let (motion, ending) = match (&function.kind, function.completion) {
            _ if is_motion => (Motion::Given, Ending::Motion),
            (_, Completion::None) => (Motion::Given, Ending::Values),
            (_, Completion::Solve) if item::calls_forward_dynamics(function) => (Motion::Accelerations, Ending::Solve),
            (_, Completion::Solve) => (Motion::Given, Ending::Solve),
            (FunctionKind::ForwardDynamics, Completion::SolveConstrained) => {
                (Motion::Constrained, Ending::OfMotion("qdd"))
            }
            (_, Completion::SolveMultipliers) => (Motion::Constrained, Ending::OfMotion("multipliers")),
            (kind, Completion::SolveConstrained) => (Motion::Constrained, Ending::Slopes(self.sizes(*kind, syntax))),
        };
        let (lines, values) = match ending {
            Ending::OfMotion(_) => (Vec::new(), Vec::new()),
            Ending::Values | Ending::Solve | Ending::Motion | Ending::Slopes(_) => {
                let components = shape::components(self.derivation, function);
                let body = Body::new(&function.program, &components, &self.names, self.names.function_scope());
                let writer = self.writer(&body, syntax);
                (self.lines(&writer), body.block.results.iter().map(|tree| writer.print(tree)).collect())
            }
        };
        Routine {
            name: plain(&self.names.functions[number]),
            docs: doc::function(self.derivation, function),
            arguments: self.arguments(function),
            parts: function.results.iter().map(|part| (part.name.to_string(), part.shape)).collect(),
            motion,
            lines,
            values,
            ending,
        }
    }

    /// The name of forward dynamics.
    fn forward_dynamics(&self) -> String {
        let number = self.derivation.functions.iter().position(|f| f.kind == FunctionKind::ForwardDynamics);
        plain(&self.names.functions[number.expect("it was selected")])
    }

    fn sizes(&self, kind: FunctionKind, syntax: &dyn Syntax) -> Sizes {
        match kind {
            FunctionKind::LinearizeParameters => {
                let all = 0..variable::count(&self.derivation.parameters);
                Sizes::Parameters(all.map(|i| syntax.read(&self.parameter(i))).collect())
            }
            _ => Sizes::State(self.derivation.coordinate_kinds(), variable::count(&self.derivation.inputs)),
        }
    }

    /// The number of the vector that each row of A is of.
    fn vectors(&self) -> Vec<String> {
        self.derivation.constraint_vectors.iter().map(ToString::to_string).collect()
    }

    fn arguments(&self, function: &Function) -> Vec<Argued> {
        let time = self.derivation.depends_on_time.then_some(("t", None));
        let signals = variable::count(&self.derivation.prescribed);
        let prescribed = (signals > 0).then_some(("prescribed", Some(signals)));
        let state = function.arguments.iter().filter_map(|&argument| {
            let count = match argument {
                Argument::Q | Argument::Qd | Argument::Qdd => self.derivation.dof(),
                Argument::U => variable::count(&self.derivation.inputs),
                Argument::Multipliers => self.derivation.constraints.len(),
            };
            (count > 0).then_some((argument.name(), Some(count)))
        });
        time.into_iter().chain(prescribed).chain(state).collect()
    }

    /// Names for what a body reads, then its statements.
    fn lines(&self, writer: &Writer<'_, '_>) -> Vec<String> {
        let Writer { body, syntax, .. } = writer;
        let mut symbols = BTreeSet::new();
        each_leaf(body.block.trees().into_iter(), &mut |leaf| {
            if let Tree::Symbol(symbol) = leaf {
                symbols.insert(*symbol);
            }
        });
        let mut lines = Vec::new();
        for symbol in symbols {
            let place = match symbol {
                Symbol::Time => continue,
                Symbol::Coordinate(i) => Place::Argument("q", i as usize),
                Symbol::Velocity(i) => Place::Argument("qd", i as usize),
                Symbol::Acceleration(i) => Place::Argument("qdd", i as usize),
                Symbol::Input(i) => Place::Argument("u", i as usize),
                Symbol::Multiplier(i) => Place::Argument("multipliers", i as usize),
                Symbol::Prescribed(i, order) => Place::Prescribed(i as usize, usize::from(order)),
                Symbol::Parameter(i) => self.parameter(i as usize),
            };
            lines.push(syntax.bind(&syntax.identifier(self.names.symbol(symbol)), &syntax.read(&place)));
        }
        lines.extend(writer.block(&body.block));
        lines
    }

    /// Where a parameter's component is.
    fn parameter(&self, i: usize) -> Place<'_> {
        let parameters = self.derivation.parameters.iter().zip(&self.names.fields);
        let (parameter, field) =
            parameters.into_iter().find(|(parameter, _)| parameter.contains(i)).expect("a parameter of this number");
        let i = i - parameter.first;
        let indices = match (parameter.length, parameter.columns) {
            (None, _) => Vec::new(),
            (Some(_), None) => vec![i],
            (Some(_), Some(columns)) => vec![i / columns, i % columns],
        };
        Place::Parameter(field.strip_prefix("r#").unwrap_or(field), indices)
    }
}

impl Writer<'_, '_> {
    /// Statements, one or more lines each.
    fn block(&self, block: &Block) -> Vec<String> {
        let syntax = self.syntax;
        let name = |local: &usize| syntax.identifier(&self.body.locals[*local]);
        let mut lines = Vec::new();
        for statement in &block.statements {
            match statement {
                Statement::Let(local, tree) => lines.push(syntax.bind(&name(local), &self.print(tree))),
                Statement::SinCos(angles) => {
                    for Angle { tree, sin, cos } in angles {
                        let angle = self.print(tree);
                        match [sin, cos].map(|local| local.as_ref().map(name)) {
                            [Some(sin), Some(cos)] if !self.library_sines => {
                                lines.push(syntax.sin_cos([&sin, &cos], &angle));
                            }
                            locals => {
                                let own = if self.library_sines { ["sin", "cos"] } else { ["own_sin", "own_cos"] };
                                for (function, local) in own.into_iter().zip(locals) {
                                    let call = || syntax.call(function, std::slice::from_ref(&angle));
                                    lines.extend(local.map(|local| syntax.bind(&local, &call())));
                                }
                            }
                        }
                    }
                }
                Statement::Spline { table, orders, locals, x } => {
                    let names: Vec<String> = locals.iter().map(name).collect();
                    lines.extend(syntax.spline(&names, *table, orders, &self.print(x)));
                }
                Statement::Branch(locals, condition, sides) => {
                    let names: Vec<String> = locals.iter().map(name).collect();
                    let sides = sides.each_ref().map(|side| Side {
                        lines: self.block(side),
                        values: side.results.iter().map(|tree| self.print(tree)).collect(),
                    });
                    lines.extend(syntax.branch(&names, &self.print(condition), sides));
                }
                Statement::OnDemand(local, wanted) => {
                    lines.extend(self.block(wanted));
                    lines.push(syntax.bind(&name(local), &self.print(&wanted.results[0])));
                }
            }
        }
        lines
    }
}

/// Without the escape of a keyword of Rust.
fn plain(name: &str) -> String {
    name.strip_prefix("r#").unwrap_or(name).to_string()
}

/// Farther to the right.
fn indented<'a>(lines: impl IntoIterator<Item = &'a String>, by: usize) -> impl Iterator<Item = String> {
    let indent = " ".repeat(by);
    let lines = lines.into_iter();
    let lines: Vec<String> =
        lines.map(|line| if line.is_empty() { String::new() } else { format!("{indent}{line}") }).collect();
    lines.into_iter()
}

/// The entries that a function returns in this shape.
fn entries(shape: Shape) -> usize {
    match shape {
        Shape::Symmetric(n) => n * n,
        other => other.count(),
    }
}

/// A parameter's declared value, with these brackets around lists.
fn defaults(parameter: &Variable, constant: &dyn Fn(f64) -> String, list: &dyn Fn(&[String]) -> String) -> String {
    let values: Vec<String> = parameter.defaults.iter().map(|value| constant(value.to_f64())).collect();
    match (parameter.length, parameter.columns) {
        (None, _) => values[0].clone(),
        (Some(_), None) => list(&values),
        (Some(_), Some(columns)) => list(&values.chunks(columns).map(list).collect::<Vec<_>>()),
    }
}

/// A longer list has an element a line.
const WIDEST: usize = 100;

/// On one line where that is short.
fn list(values: &[String], [open, close]: [&str; 2]) -> String {
    let short = format!("{open}{}{close}", values.join(", "));
    if values.is_empty() || (short.len() <= WIDEST && !short.contains('\n')) {
        return if values.is_empty() { short.replace(' ', "") } else { short };
    }
    let lines = values.iter().flat_map(|value| format!("{value},").lines().map(String::from).collect::<Vec<_>>());
    let lines: Vec<String> = lines.collect();
    let inside: String = indented(&lines, 2).map(|line| line + "\n").collect();
    format!("{}\n{inside}{}", open.trim(), close.trim())
}
