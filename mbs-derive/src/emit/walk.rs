//! One walk over a [`Derivation`] for all languages: what stands in each function, in which order, with which names and
//! documentation. A language says how that is written: [`Syntax`].
//!
//! - `expression`: values, by operators and functions;
//! - `layout`: lines and comments that languages have in common.
//!
//! What is computed on demand in Rust is computed at once in the others: it has no effect but time.

mod expression;
mod layout;

use crate::expr::{Symbol, Trigonometry};
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind, Instruction, Program};
use crate::shape::Shape;
use crate::variable::{self, Variable};

use super::body::{Angle, Block, Body, Component, Statement};
use super::expression::Tree;
use super::name::{Names, Scope, snake_case};
use super::rolled::{self, Loops};
use super::{Options, doc, links, shape};
pub(super) use layout::{block_comment, defaults, if_else, indented};

/// How a language is written.
pub(super) trait Syntax {
    /// The identifier for a name of Rust.
    fn identifier(&self, name: &str) -> String;
    /// A constant or a name, as a body writes it.
    fn leaf(&self, leaf: &Tree, body: &Body<'_>) -> String {
        match leaf {
            Tree::Constant(value) => self.constant(*value),
            Tree::Hoisted(_) => self.hoisted(body.name(leaf)),
            // What loops call components is written already.
            leaf if body.name(leaf).ends_with([']', ')']) => body.name(leaf).to_string(),
            leaf => self.identifier(body.name(leaf)),
        }
    }
    /// The shortest literal that reads back as a value.
    fn constant(&self, value: f64) -> String;
    /// A value that depends on parameters alone, in a function.
    fn hoisted(&self, name: &str) -> String;
    /// Both conditions.
    fn and(&self) -> &'static str;
    /// Whether that binds tighter than a comparison, as NumPy's does.
    fn and_is_tight(&self) -> bool {
        false
    }
    /// Not the condition.
    fn not(&self) -> &'static str;
    /// One of two values; `known` where nothing has to be computed for either.
    fn select(&self, condition: &str, sides: [&str; 2], known: bool) -> String;
    /// A function of the language, by its name on `Scalar`; `own_sin`, `own_cos` give the same bits everywhere.
    fn call(&self, name: &str, arguments: &[String]) -> String;
    /// Whether functions are methods of their first argument, comparisons among them.
    fn has_methods(&self) -> bool {
        false
    }
    /// Whether a product that a sum alone uses is fused with it, by the function `mul_add`.
    fn fuses(&self) -> bool {
        false
    }
    /// Whether systems are eliminated in the order that the derivation knows, and not by a full matrix.
    fn eliminates(&self) -> bool {
        false
    }
    /// What a body begins with: names for what it reads.
    fn begin(&self, reads: &[(&str, Place<'_>)], _body: &Body<'_>) -> Vec<String> {
        reads.iter().map(|(name, place)| self.bind(&self.identifier(name), &self.read(place))).collect()
    }
    /// A comment on what follows.
    fn comment(&self, text: &str) -> String;
    /// How it writes loops over the links of a long chain, if it does.
    fn loops(&self) -> Option<&dyn Loops> {
        None
    }
    /// The statements of a block.
    fn block(&self, block: &Block, writer: &Writer<'_, '_>) -> Vec<String> {
        writer.statements(block)
    }
    /// Gives a value a name.
    fn bind(&self, name: &str, value: &str) -> String;
    /// Sine and cosine of an angle, by the function that gives the same bits everywhere.
    fn sin_cos(&self, names: [&str; 2], angle: &str) -> Vec<String>;
    /// Those of several angles, which one call may compute; `number` is that of no other such call of the function.
    fn sin_cos_all(&self, angles: &[Wanted], library: bool, _number: usize) -> Vec<String> {
        angles.iter().flat_map(|angle| one_angle(self, angle, library)).collect()
    }
    /// The derivative of this order of the spline with a number.
    fn spline(&self, table: usize, order: usize, x: &str) -> String;
    /// Derivatives of one spline, by their orders.
    fn splines(&self, names: &[String], orders: &[usize], table: usize, x: &str) -> Vec<String> {
        names.iter().zip(orders).map(|(name, order)| self.bind(name, &self.spline(table, *order, x))).collect()
    }
    /// Gives values names, of one side or the other.
    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String>;
    /// Gives a value a name that may not be asked for.
    fn on_demand(&self, name: &str, wanted: Side) -> Vec<String> {
        wanted.lines.into_iter().chain([self.bind(name, &wanted.values[0])]).collect()
    }
    /// What a function reads.
    fn read(&self, place: &Place<'_>) -> String;
}

/// One side of a branch, or what is computed on demand: its lines, and the values.
pub(super) struct Side {
    pub(super) lines: Vec<String>,
    pub(super) values: Vec<String>,
    /// Whether the last line does nothing but give just the values their names.
    pub(super) is_named_last: bool,
}

/// An angle, and the names of its sine and cosine, as far as they are read.
pub(super) struct Wanted {
    pub(super) angle: String,
    pub(super) sin: Option<String>,
    pub(super) cos: Option<String>,
}

/// Where a function finds a number.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place<'d> {
    /// The component of an argument.
    Argument(&'static str, usize),
    /// The derivative of this order of a prescribed motion.
    Prescribed(usize, usize),
    /// The component of a parameter; of a number no indices.
    Parameter(&'d str, Vec<usize>),
}

/// An argument of a function: its name, and how many numbers it is; a number has none.
pub(super) type Argued = (&'static str, Option<usize>);

/// A function, as far as all languages agree.
pub(super) struct Routine {
    pub(super) kind: FunctionKind,
    /// Its name in Rust, without an escape.
    pub(super) name: String,
    pub(super) docs: Vec<String>,
    pub(super) arguments: Vec<Argued>,
    /// Names of what it returns, empty where it is one thing, and shapes.
    pub(super) parts: Vec<(String, Shape)>,
    /// What the program needs before: nothing, or the motion.
    pub(super) motion: Motion,
    /// Whether that reads the multipliers of the motion.
    pub(super) reads_multipliers: bool,
    pub(super) lines: Vec<String>,
    /// M, row by row, where a system is solved.
    pub(super) mass_matrix: Vec<String>,
    /// A, row by row, where a system with constraints is solved.
    pub(super) jacobian: Vec<String>,
    /// The entries of M and A, where the system is eliminated in a known order; M and A are then empty.
    pub(super) entries: Vec<String>,
    /// Of each part: its numbers, or the right sides that it is solved for, row by row.
    pub(super) values: Vec<Vec<String>>,
    pub(super) ending: Ending,
}

impl Routine {
    /// Whether it is what all functions with constraints have in common.
    pub(super) fn is_motion(&self) -> bool {
        matches!(self.ending, Ending::Motion)
    }

    /// How many columns each part has.
    pub(super) fn widths(&self) -> Vec<usize> {
        self.parts.iter().map(|(_, shape)| columns(*shape)).collect()
    }

    /// The right sides of all parts side by side: this many rows.
    pub(super) fn right_sides(&self, rows: usize) -> Vec<Vec<String>> {
        let widths = self.widths();
        let row = |i: usize| {
            let parts = self.values.iter().zip(&widths);
            parts.flat_map(|(values, width)| values[i * width..(i + 1) * width].iter().cloned()).collect()
        };
        (0..rows).map(row).collect()
    }
}

fn columns(shape: Shape) -> usize {
    if let Shape::Matrix(_, columns) = shape { columns } else { 1 }
}

/// What a program is evaluated at.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// What the caller gives.
    Given,
    /// `qdd` of forward dynamics.
    Accelerations,
    /// `qdd` and `multipliers` of the constrained motion.
    Constrained,
}

/// How results come from values.
pub(super) enum Ending {
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
pub(super) enum Sizes {
    /// Of coordinates of these kinds, of their rates, and of this many inputs.
    State(Vec<usize>, usize),
    /// The parameters.
    Parameters(Vec<String>),
}

/// A mechanism, to be written.
pub(super) struct Walk<'d> {
    pub(super) derivation: &'d Derivation,
    pub(super) names: Names,
    pub(super) functions: Vec<(usize, &'d Function)>,
    pub(super) source: &'d str,
    /// Whether the language's own sine and cosine are called.
    pub(super) library_sines: bool,
}

/// What a body is written with.
pub(super) struct Writer<'w, 'n> {
    pub(super) body: &'w Body<'n>,
    pub(super) syntax: &'w dyn Syntax,
    pub(super) library_sines: bool,
}

impl<'d> Walk<'d> {
    pub(super) fn new(derivation: &'d Derivation, source: &'d str, options: &Options) -> Self {
        let functions = selected(derivation, options.functions.as_deref());
        Walk {
            derivation,
            names: Names::of(derivation, options.trigonometry),
            functions,
            source,
            library_sines: options.trigonometry == Trigonometry::Library,
        }
    }

    /// The mechanism's name in snake case.
    pub(super) fn snake_case(&self) -> String {
        snake_case(&self.derivation.name)
    }

    /// What stands on top.
    pub(super) fn docs(&self) -> Vec<String> {
        let functions: Vec<&Function> = self.functions.iter().map(|(_, f)| *f).collect();
        [generated_from(self.source), String::new()]
            .into_iter()
            .chain(doc::mechanism(self.derivation, &functions))
            .collect()
    }

    /// Parameters with the names of their fields, without escapes.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (&'d Variable, String)> + '_ {
        self.derivation.parameters.iter().zip(&self.names.fields).map(|(parameter, field)| (parameter, plain(field)))
    }

    /// Forward dynamics, where constraints are solved for it.
    pub(super) fn constrained(&self) -> Option<(usize, &'d Function)> {
        let is_needed = self.functions.iter().any(|(_, f)| f.completion.is_constrained());
        let all = || self.derivation.functions.iter().enumerate();
        is_needed.then(|| all().find(|(_, f)| f.kind == FunctionKind::ForwardDynamics)).flatten()
    }

    pub(super) fn hoisted(&self) -> Vec<usize> {
        let functions = self.functions.iter().map(|(_, function)| *function);
        hoisted(self.derivation, functions.chain(self.constrained().map(|(_, function)| function)))
    }

    /// The lines of the constructor, then names and values of what depends on parameters alone.
    pub(super) fn constructor(&self, syntax: &dyn Syntax) -> (Vec<String>, Vec<(String, String)>) {
        let hoisted = self.hoisted();
        let components: Vec<Component> =
            hoisted.iter().map(|&k| Component::Result(k, self.names.hoisted[k].clone())).collect();
        let scope = self.names.constructor_scope();
        let (lines, values) = self.evaluated(&self.derivation.constructor, &components, scope, syntax);
        let names = hoisted.iter().map(|&k| self.names.hoisted[k].clone());
        (lines, names.zip(values).collect())
    }

    /// The lines that compute what parameters must satisfy, and its values.
    pub(super) fn required(&self, syntax: &dyn Syntax) -> (Vec<String>, Vec<String>) {
        let program = &self.derivation.required;
        let all: Vec<Component> = (0..program.results.len()).map(|k| Component::Result(k, String::new())).collect();
        self.evaluated(program, &all, self.names.constructor_scope(), syntax)
    }

    /// The lines that compute a program, and its values.
    pub(super) fn evaluated(
        &self,
        program: &Program,
        components: &[Component],
        scope: Scope,
        syntax: &dyn Syntax,
    ) -> (Vec<String>, Vec<String>) {
        let body = Body::new(program, components, &self.names, scope);
        let writer = Writer { body: &body, syntax, library_sines: self.library_sines };
        if let Some((lines, values)) = syntax.loops().and_then(|loops| rolled::lines(&writer, loops)) {
            // Loops read components of arguments where they need them.
            let is_argument = |symbol: &Symbol| matches!(self.place(*symbol), Some(Place::Argument(..)));
            let begin = self.begin(&writer, |symbol| !is_argument(symbol));
            return (begin.into_iter().chain(lines).collect(), values);
        }
        (self.lines(&writer), body.block.results.iter().map(|tree| writer.print(tree)).collect())
    }

    /// All functions; before those with constraints what they have in common.
    pub(super) fn routines(&self, syntax: &dyn Syntax) -> Vec<Routine> {
        let motion = self.constrained().map(|(number, function)| self.routine(number, function, syntax, true));
        let functions = self.functions.iter().map(|(number, function)| self.routine(*number, function, syntax, false));
        motion.into_iter().chain(functions).collect()
    }

    fn routine(&self, number: usize, function: &Function, syntax: &dyn Syntax, is_motion: bool) -> Routine {
        let (motion, ending) = match is_motion {
            true => (Motion::Given, Ending::Motion),
            false => self.steps(function, syntax),
        };
        let (lines, values) = match ending {
            Ending::OfMotion(_) => (Vec::new(), Vec::new()),
            Ending::Values | Ending::Solve | Ending::Motion | Ending::Slopes(_) => {
                let components = shape::components(self.derivation, function, !syntax.eliminates());
                self.evaluated(&function.program, &components, self.names.function_scope(), syntax)
            }
        };
        let [n, .., k] = self.sizes();
        let (name, docs, parts) = match is_motion {
            true => {
                let parts = [("qdd", n), ("multipliers", k)].map(|(name, n)| (name.to_string(), Shape::Vector(n)));
                let docs = vec!["Accelerations and multipliers.".to_string()];
                (&self.names.constrained_motion, docs, parts.to_vec())
            }
            false => {
                let parts = function.results.iter().map(|part| (part.name.to_string(), part.shape));
                (
                    &self.names.functions[number],
                    doc::function(self.derivation, function, syntax.eliminates()),
                    parts.collect(),
                )
            }
        };
        let mut values = values.into_iter();
        let mut next = |count: usize| values.by_ref().take(count).collect::<Vec<String>>();
        let elimination = self.derivation.elimination.as_ref().filter(|_| syntax.eliminates());
        let (none, is_solved) = (Vec::new, !matches!(ending, Ending::Values | Ending::OfMotion(_)));
        let (mass_matrix, jacobian, entries) = match elimination {
            _ if !is_solved => (none(), none(), none()),
            Some(elimination) => (none(), none(), next(elimination.entries.len())),
            None => (next(n * n), next(k * n), none()),
        };
        let count = |shape: Shape| match ending {
            Ending::Slopes(_) => (n + k) * columns(shape),
            Ending::Values | Ending::Solve | Ending::Motion | Ending::OfMotion(_) => shape.entries(),
        };
        Routine {
            kind: function.kind,
            name: plain(name),
            docs,
            arguments: self.arguments(function),
            motion,
            reads_multipliers: function.program.uses(|symbol| matches!(symbol, Symbol::Multiplier(_))),
            lines,
            mass_matrix,
            jacobian,
            entries,
            values: parts.iter().map(|(_, shape)| next(count(*shape))).collect(),
            parts,
            ending,
        }
    }

    /// The lines that compute the entries of M and A that are not zero, and those entries, of a system that is
    /// eliminated in a known order.
    pub(super) fn entries(&self, forward_dynamics: &Function, syntax: &dyn Syntax) -> (Vec<String>, Vec<String>) {
        let mut components = shape::components(self.derivation, forward_dynamics, false);
        components.truncate(self.derivation.matrix_entries());
        self.evaluated(&forward_dynamics.program, &components, self.names.function_scope(), syntax)
    }

    /// What a function's program is evaluated at, and how its results come from its values.
    fn steps(&self, function: &Function, syntax: &dyn Syntax) -> (Motion, Ending) {
        match (function.kind, function.completion) {
            (_, Completion::None) => (Motion::Given, Ending::Values),
            (_, Completion::Solve) if calls_forward_dynamics(function) => (Motion::Accelerations, Ending::Solve),
            (_, Completion::Solve) => (Motion::Given, Ending::Solve),
            (FunctionKind::ForwardDynamics, Completion::SolveConstrained) => {
                (Motion::Constrained, Ending::OfMotion("qdd"))
            }
            (_, Completion::SolveMultipliers) => (Motion::Constrained, Ending::OfMotion("multipliers")),
            (kind, Completion::SolveConstrained) => (Motion::Constrained, Ending::Slopes(self.measures(kind, syntax))),
        }
    }

    /// The name of forward dynamics.
    pub(super) fn forward_dynamics(&self) -> String {
        let number = self.derivation.functions.iter().position(|f| f.kind == FunctionKind::ForwardDynamics);
        plain(&self.names.functions[number.expect("it was selected")])
    }

    fn measures(&self, kind: FunctionKind, syntax: &dyn Syntax) -> Sizes {
        match kind {
            FunctionKind::LinearizeParameters => {
                let all = 0..variable::count(&self.derivation.parameters);
                Sizes::Parameters(all.map(|i| syntax.read(&self.parameter(i))).collect())
            }
            _ => Sizes::State(self.derivation.coordinate_kinds(), variable::count(&self.derivation.inputs)),
        }
    }

    /// The number of the vector that each row of A is of.
    pub(super) fn vectors(&self) -> Vec<String> {
        self.derivation.constraint_vectors.iter().map(ToString::to_string).collect()
    }

    /// How many coordinates, inputs, prescribed motions and rows of constraints there are.
    pub(super) fn sizes(&self) -> [usize; 4] {
        let derivation = self.derivation;
        let [inputs, signals] =
            [&derivation.inputs, &derivation.prescribed].map(|variables| variable::count(variables));
        [derivation.dof(), inputs, signals, derivation.constraints.len()]
    }

    pub(super) fn arguments(&self, function: &Function) -> Vec<Argued> {
        let [n, inputs, signals, rows] = self.sizes();
        let time = self.derivation.depends_on_time.then_some(("t", None));
        let prescribed = (signals > 0).then_some(("prescribed", Some(signals)));
        let state = function.arguments.iter().filter_map(|&argument| {
            let count = match argument {
                Argument::Q | Argument::Qd | Argument::Qdd => n,
                Argument::U => inputs,
                Argument::Multipliers => rows,
            };
            (count > 0).then_some((argument.name(), Some(count)))
        });
        time.into_iter().chain(prescribed).chain(state).collect()
    }

    /// Names for what a body reads, then its statements.
    fn lines(&self, writer: &Writer<'_, '_>) -> Vec<String> {
        let mut lines = self.begin(writer, |_| true);
        lines.extend(writer.syntax.block(&writer.body.block, writer));
        lines
    }

    /// Names for what a body reads, of the symbols that are named.
    fn begin(&self, writer: &Writer<'_, '_>, is_named: impl Fn(&Symbol) -> bool) -> Vec<String> {
        let place = |symbol: &Symbol| self.place(*symbol).map(|place| (self.names.symbol(*symbol), place));
        let symbols = writer.body.leaves.symbols.iter().filter(|symbol| is_named(symbol));
        let reads: Vec<(&str, Place<'_>)> = symbols.filter_map(place).collect();
        writer.syntax.begin(&reads, writer.body)
    }

    /// Where a symbol is found; time is an argument itself.
    fn place(&self, symbol: Symbol) -> Option<Place<'_>> {
        Some(match symbol {
            Symbol::Time => return None,
            Symbol::Coordinate(i) => Place::Argument("q", i as usize),
            Symbol::Velocity(i) => Place::Argument("qd", i as usize),
            Symbol::Acceleration(i) => Place::Argument("qdd", i as usize),
            Symbol::Input(i) => Place::Argument("u", i as usize),
            Symbol::Multiplier(i) => Place::Argument("multipliers", i as usize),
            Symbol::Prescribed(i, order) => Place::Prescribed(i as usize, usize::from(order)),
            Symbol::Parameter(i) => self.parameter(i as usize),
        })
    }

    /// Where a parameter's component is.
    pub(super) fn parameter(&self, i: usize) -> Place<'_> {
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
    /// The lines of a block's statements, with a comment wherever another link begins.
    pub(super) fn statements(&self, block: &Block) -> Vec<String> {
        let mut links = links::starts(&block.statements, &self.body.links);
        block.statements.iter().enumerate().flat_map(|(i, one)| self.below_link(links.remove(&i), one)).collect()
    }

    /// The lines of a statement, below a comment if a link begins with it.
    pub(super) fn below_link(
        &self,
        link: Option<usize>,
        statement: &Statement,
    ) -> impl Iterator<Item = String> + use<> {
        let comment = link.map(|link| self.syntax.comment(&format!("Link {link}.")));
        comment.into_iter().chain(self.statement(statement))
    }

    /// The lines of a statement.
    pub(super) fn statement(&self, statement: &Statement) -> Vec<String> {
        let syntax = self.syntax;
        let name = |local: &usize| syntax.identifier(&self.body.locals[*local]);
        match statement {
            Statement::Let(local, tree) => vec![syntax.bind(&name(local), &self.print(tree))],
            Statement::SinCos(angles) => {
                let number = angles.iter().find_map(|angle| angle.sin.or(angle.cos)).unwrap_or_default();
                let wanted = angles.iter().map(|Angle { tree, sin, cos }| {
                    let [sin, cos] = [sin, cos].map(|local| local.as_ref().map(name));
                    let angle = if self.library_sines { self.first_argument(tree) } else { self.print(tree) };
                    Wanted { angle, sin, cos }
                });
                let wanted: Vec<Wanted> = wanted.collect();
                syntax.sin_cos_all(&wanted, self.library_sines, number)
            }
            Statement::Spline { table, orders, locals, x } => {
                let names: Vec<String> = locals.iter().map(name).collect();
                syntax.splines(&names, orders, *table, &self.print(x))
            }
            Statement::Branch(locals, condition, sides) => {
                let names: Vec<String> = locals.iter().map(name).collect();
                syntax.branch(&names, &self.print(condition), sides.each_ref().map(|side| self.side(side)))
            }
            Statement::OnDemand(local, wanted) => syntax.on_demand(&name(local), self.side(wanted)),
        }
    }

    fn side(&self, block: &Block) -> Side {
        let names_all = |last: &Statement| {
            let (is_one, locals) = (matches!(last, Statement::Let(..) | Statement::Branch(..)), last.binds());
            is_one && locals.into_iter().map(Tree::Local).eq(block.results.iter().cloned())
        };
        Side {
            lines: self.syntax.block(block, self),
            values: block.results.iter().map(|tree| self.print(tree)).collect(),
            is_named_last: block.statements.last().is_some_and(names_all),
        }
    }
}

/// The functions asked for, and those that they call, in their order.
pub(super) fn selected<'d>(derivation: &'d Derivation, asked_for: Option<&[String]>) -> Vec<(usize, &'d Function)> {
    let is_asked_for = |f: &Function| asked_for.is_none_or(|names| names.contains(&f.name));
    let calls_dynamics = derivation.functions.iter().any(|f| is_asked_for(f) && calls_forward_dynamics(f));
    let chosen = |f: &Function| is_asked_for(f) || (calls_dynamics && f.kind == FunctionKind::ForwardDynamics);
    derivation.functions.iter().enumerate().filter(|(_, f)| chosen(f)).collect()
}

/// Whether a function evaluates its program at the accelerations of forward dynamics.
fn calls_forward_dynamics(function: &Function) -> bool {
    function.completion == Completion::Solve
        && function.program.uses(|symbol| matches!(symbol, Symbol::Acceleration(_)))
}

/// The hoisted values that some functions read.
fn hoisted<'d>(derivation: &Derivation, functions: impl Iterator<Item = &'d Function>) -> Vec<usize> {
    let mut read = vec![false; derivation.constructor.results.len()];
    for instruction in functions.flat_map(|function| &function.program.instructions) {
        if let Instruction::Hoisted(k) = instruction {
            read[*k as usize] = true;
        }
    }
    (0..read.len()).filter(|&k| read[k]).collect()
}

/// Sine and cosine of one angle, as far as they are read.
pub(super) fn one_angle<S: Syntax + ?Sized>(
    syntax: &S,
    Wanted { angle, sin, cos }: &Wanted,
    library: bool,
) -> Vec<String> {
    match [sin, cos] {
        [Some(sin), Some(cos)] if !library => syntax.sin_cos([sin, cos], angle),
        locals => {
            let functions = if library { ["sin", "cos"] } else { ["own_sin", "own_cos"] };
            let bound = |(function, local): (_, &Option<String>)| {
                local.as_ref().map(|local| syntax.bind(local, &syntax.call(function, std::slice::from_ref(angle))))
            };
            functions.into_iter().zip(locals).filter_map(bound).collect()
        }
    }
}

/// The first line of a text.
pub(super) fn generated_from(source: &str) -> String {
    let source: String = source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("Generated by mbs {} from {source}. Do not edit.", env!("CARGO_PKG_VERSION"))
}

/// Without the escape of a keyword of Rust.
pub(super) fn plain(name: &str) -> String {
    name.strip_prefix("r#").unwrap_or(name).to_string()
}
