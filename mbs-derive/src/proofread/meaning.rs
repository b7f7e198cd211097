//! What expressions of a text mean, and what those of a function are to mean.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::expr::{Elimination, Symbol};
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind};
use crate::shape::{ResultPart, Shape};
use crate::variable::{Variable, count};

use super::numbering::{Number, Numbering};

/// What an expression means.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    /// A number or a condition.
    Number(Number),
    /// A literal with a point.
    Literal(f64),
    /// A literal without.
    Integer(usize),
    Text(String),
    /// An array.
    List(Rc<[Meaning]>),
    Tuple(Rc<[Meaning]>),
    /// A struct of this path.
    Record(String, Rc<BTreeMap<String, Meaning>>),
    /// What a function of the runtime gives for these arguments.
    Call(String, Rc<[Meaning]>),
    /// A constant or a variant by its path.
    Path(String),
    /// A closure without arguments that gives this.
    Closure(Rc<Meaning>),
    /// What is computed when it is first asked for.
    OnDemand(Rc<Meaning>),
    /// `T::from_f64`
    FromF64,
    /// The spline with this number.
    Table(usize),
    /// All derivatives of a spline at a place.
    Derivatives(usize, Number),
    /// The columns of `solution` from one on: of an array of arrays.
    Columns(Rc<Meaning>, usize),
}

impl Meaning {
    pub(super) fn list(entries: impl IntoIterator<Item = Meaning>) -> Self {
        Meaning::List(entries.into_iter().collect())
    }

    pub(super) fn call(function: &str, arguments: impl IntoIterator<Item = Meaning>) -> Self {
        Meaning::Call(format!("mbs_runtime::{function}"), arguments.into_iter().collect())
    }

    pub(super) fn record<'a>(path: &str, fields: impl IntoIterator<Item = (&'a str, Meaning)>) -> Self {
        let fields = fields.into_iter().map(|(name, meaning)| (name.to_string(), meaning)).collect();
        Meaning::Record(path.to_string(), Rc::new(fields))
    }

    /// Where two meanings begin to differ, if they do.
    pub(super) fn difference(&self, expected: &Meaning, numbering: &Numbering) -> Option<String> {
        let all = |found: &[Meaning], expected: &[Meaning], what: &str| match found.len() == expected.len() {
            false => Some(format!("{what}: {} instead of {}", found.len(), expected.len())),
            true => found.iter().zip(expected).enumerate().find_map(|(i, (found, expected))| {
                let difference = found.difference(expected, numbering)?;
                Some(format!("{what} {i}: {difference}"))
            }),
        };
        match (self, expected) {
            (found, expected) if found == expected => None,
            (Meaning::Number(found), Meaning::Number(expected)) => {
                let [found, expected] = numbering.difference(*found, *expected).map(|number| numbering.shown(number));
                Some(format!("`{found}` instead of `{expected}`"))
            }
            (Meaning::List(found), Meaning::List(expected)) => all(found, expected, "component"),
            (Meaning::Tuple(found), Meaning::Tuple(expected)) => all(found, expected, "part"),
            (Meaning::Call(name, found), Meaning::Call(other, expected)) if name == other => {
                all(found, expected, &format!("`{name}`, argument"))
            }
            (Meaning::Record(name, found), Meaning::Record(other, expected)) if name == other => {
                let field = |(field, expected): (&String, &Meaning)| match found.get(field) {
                    None => Some(format!("`{field}` is missing")),
                    Some(found) => Some(format!("`{field}`: {}", found.difference(expected, numbering)?)),
                };
                expected.iter().find_map(field).or_else(|| Some(format!("`{name}` has other fields")))
            }
            (found, expected) => Some(format!("{} instead of {}", found.shown(numbering), expected.shown(numbering))),
        }
    }

    /// What it is, for a report.
    pub(super) fn shown(&self, numbering: &Numbering) -> String {
        match self {
            Meaning::Number(number) => format!("`{}`", numbering.shown(*number)),
            Meaning::Literal(value) => format!("`{value:?}`"),
            Meaning::Integer(value) => format!("`{value}`"),
            Meaning::Text(text) => format!("`{text:?}`"),
            Meaning::List(entries) => format!("{} components", entries.len()),
            Meaning::Tuple(parts) => format!("{} parts", parts.len()),
            Meaning::Record(path, _) | Meaning::Path(path) => format!("`{path}`"),
            Meaning::Call(function, _) => format!("`{function}(…)`"),
            Meaning::Closure(_) => "a closure".to_string(),
            Meaning::OnDemand(of) | Meaning::Columns(of, _) => of.shown(numbering),
            Meaning::FromF64 => "`T::from_f64`".to_string(),
            Meaning::Table(_) | Meaning::Derivatives(..) => "a table".to_string(),
        }
    }
}

/// What functions of a derivation are to mean.
pub(super) struct Expectation<'d> {
    pub(super) derivation: &'d Derivation,
    /// What the constructor computes.
    pub(super) hoisted: Vec<Number>,
}

/// A system that is solved for a result.
pub(super) struct System {
    /// Row by row; above the diagonal, of which nothing is read, it is zero.
    pub(super) mass_matrix: Vec<Number>,
    /// A, row by row.
    pub(super) jacobian: Vec<Number>,
    /// Of both those that are not zero everywhere, where they are eliminated in a known order.
    pub(super) entries: Vec<Number>,
    /// Of each part, row by row.
    pub(super) right_sides: Vec<Vec<Number>>,
}

impl<'d> Expectation<'d> {
    pub(super) fn new(derivation: &'d Derivation, numbering: &mut Numbering) -> Self {
        let hoisted = numbering.results(&derivation.constructor, &[], |_| false);
        Expectation { derivation, hoisted }
    }

    /// The arguments of a function with their meanings, in order.
    pub(super) fn arguments(&self, function: &Function, numbering: &mut Numbering) -> Vec<(&'static str, Meaning)> {
        let derivation = self.derivation;
        let signals = count(&derivation.prescribed) as u32;
        let mut arguments = Vec::new();
        if derivation.depends_on_time {
            arguments.push(("t", Meaning::Number(numbering.symbol(Symbol::Time))));
        }
        if signals > 0 {
            let mut order = |i, order| Meaning::Number(numbering.symbol(Symbol::Prescribed(i, order)));
            let rows = (0..signals).map(|i| Meaning::list([order(i, 0), order(i, 1), order(i, 2)]));
            arguments.push(("prescribed", Meaning::list(rows.collect::<Vec<_>>())));
        }
        for &argument in &function.arguments {
            let (count, symbol) = self.components(argument);
            if argument != Argument::U || count > 0 {
                let entries = (0..count).map(|i| Meaning::Number(numbering.symbol(symbol(i as u32))));
                arguments.push((argument.name(), Meaning::list(entries.collect::<Vec<_>>())));
            }
        }
        arguments
    }

    /// How many components an argument has, and what they are.
    pub(super) fn components(&self, argument: Argument) -> (usize, fn(u32) -> Symbol) {
        let n = self.derivation.dof();
        match argument {
            Argument::Q => (n, Symbol::Coordinate),
            Argument::Qd => (n, Symbol::Velocity),
            Argument::Qdd => (n, Symbol::Acceleration),
            Argument::U => (count(&self.derivation.inputs), Symbol::Input),
            Argument::Multipliers => (self.derivation.constraints.len(), Symbol::Multiplier),
        }
    }

    /// The components of q̈ or λ of the motion.
    pub(super) fn of_the_motion(&self, argument: Argument, numbering: &mut Numbering) -> Meaning {
        let (count, symbol) = self.components(argument);
        let entries = (0..count).map(|i| Meaning::Number(numbering.of_the_motion(symbol(i as u32))));
        Meaning::list(entries.collect::<Vec<_>>())
    }

    /// A parameter's components, in its shape.
    pub(super) fn parameter(&self, parameter: &Variable, numbering: &mut Numbering) -> Meaning {
        let component = |i: usize| Meaning::Number(numbering.symbol(Symbol::Parameter((parameter.first + i) as u32)));
        nested(&parameter.lengths(), &mut (0..parameter.count()).map(component))
    }

    /// The results of a function's program.
    pub(super) fn results(&self, function: &Function, numbering: &mut Numbering) -> Vec<Number> {
        let takes = |argument: Argument| function.arguments.contains(&argument);
        let is_found = |symbol: Symbol| match symbol {
            Symbol::Acceleration(_) => !takes(Argument::Qdd),
            Symbol::Multiplier(_) => !takes(Argument::Multipliers),
            _ => false,
        };
        numbering.results(&function.program, &self.hoisted, is_found)
    }

    /// What a function is to return.
    pub(super) fn returned(&self, function: &Function, numbering: &mut Numbering) -> Meaning {
        match function.completion {
            Completion::None => {
                let results = self.results(function, numbering);
                let mut values = results.into_iter().map(Meaning::Number);
                let parts: Vec<Meaning> = function.results.iter().map(|part| shaped(part.shape, &mut values)).collect();
                assembled(function, parts)
            }
            Completion::Solve => self.solved(function, numbering),
            Completion::SolveConstrained if function.kind == FunctionKind::ForwardDynamics => {
                self.of_the_motion(Argument::Qdd, numbering)
            }
            Completion::SolveMultipliers => self.of_the_motion(Argument::Multipliers, numbering),
            Completion::SolveConstrained => self.slopes(function, numbering),
        }
    }

    /// The system of a function.
    pub(super) fn system(&self, function: &Function, numbering: &mut Numbering) -> System {
        let (n, rows) = (self.derivation.dof(), self.derivation.constraints.len());
        let results = self.results(function, numbering);
        let (entries, mut rest) = results.split_at(self.derivation.matrix_entries());
        let zero = numbering.constant(0.0);
        let (mut mass_matrix, mut jacobian) = (vec![zero; n * n], Vec::new());
        let mut put = |i: usize, j: usize, entry| mass_matrix[i * n + j] = entry;
        match &self.derivation.elimination {
            None => {
                let (triangle, rows) = entries.split_at(n * (n + 1) / 2);
                (0..n).for_each(|i| (0..=i).for_each(|j| put(i, j, triangle[i * (i + 1) / 2 + j])));
                jacobian.extend(rows);
            }
            Some(elimination) => {
                jacobian.resize(rows * n, zero);
                for (&[i, j], &entry) in elimination.entries.iter().zip(entries) {
                    if i < n { put(i, j, entry) } else { jacobian[(i - n) * n + j] = entry }
                }
            }
        }
        let part = |of: &ResultPart| {
            let (own, behind) = rest.split_at((n + rows) * width(of));
            rest = behind;
            own.to_vec()
        };
        let right_sides = function.results.iter().map(part).collect();
        System { entries: entries.to_vec(), mass_matrix, jacobian, right_sides }
    }

    fn solved(&self, function: &Function, numbering: &mut Numbering) -> Meaning {
        let n = self.derivation.dof();
        let system = self.system(function, numbering);
        let mass_matrix = in_shape(Shape::Matrix(n, n), &system.mass_matrix);
        let mut right_sides =
            function.results.iter().zip(&system.right_sides).map(|(part, values)| in_shape(part.shape, values));
        if let [part] = function.results.as_slice() {
            let solve = if matches!(part.shape, Shape::Vector(_)) { "ldlt_solve" } else { "ldlt_solve_many" };
            let right_side = right_sides.next().expect("one part");
            return Meaning::call(solve, [mass_matrix, right_side]);
        }
        let factors = Meaning::call("Ldlt::new", [mass_matrix]);
        let solved = |right_side| Meaning::Call("solve_many".to_string(), [factors.clone(), right_side].into());
        assembled(function, right_sides.map(solved).collect())
    }

    /// q̈ and λ as the runtime gives them, from forward dynamics.
    pub(super) fn motion(&self, forward_dynamics: &Function, numbering: &mut Numbering) -> Meaning {
        let (n, rows) = (self.derivation.dof(), self.derivation.constraints.len());
        let System { entries, mass_matrix, jacobian, right_sides } = self.system(forward_dynamics, numbering);
        let (force, target) = right_sides[0].split_at(n);
        let right_side = [in_shape(Shape::Vector(n), force), in_shape(Shape::Vector(rows), target)];
        if let Some(elimination) = &self.derivation.elimination {
            return Meaning::call("sparse_solve", sparse(elimination, &entries).into_iter().chain(right_side));
        }
        let matrices = [in_shape(Shape::Matrix(n, n), &mass_matrix), in_shape(Shape::Matrix(rows, n), &jacobian)];
        let arguments = matrices.into_iter().chain(right_side);
        if self.derivation.constraint_vectors.iter().enumerate().all(|(row, &first)| row == first) {
            return Meaning::call("constrained_solve", arguments);
        }
        Meaning::call("constrained_solve_vectors", arguments.chain([self.vectors()]))
    }

    /// What is not zero of M and A.
    pub(super) fn entries(&self, forward_dynamics: &Function, numbering: &mut Numbering) -> Meaning {
        let System { entries, .. } = self.system(forward_dynamics, numbering);
        in_shape(Shape::Vector(entries.len()), &entries)
    }

    fn vectors(&self) -> Meaning {
        Meaning::list(self.derivation.constraint_vectors.iter().map(|&number| Meaning::Integer(number)))
    }

    /// Derivatives of the motion with constraints.
    fn slopes(&self, function: &Function, numbering: &mut Numbering) -> Meaning {
        let (n, rows) = (self.derivation.dof(), self.derivation.constraints.len());
        let System { entries, mass_matrix, jacobian, right_sides } = self.system(function, numbering);
        let widths: Vec<usize> = function.results.iter().map(width).collect();
        let row = |i: usize| {
            let parts = right_sides.iter().zip(&widths);
            let entries = parts.flat_map(|(part, &width)| &part[i * width..(i + 1) * width]);
            Meaning::list(entries.copied().map(Meaning::Number).collect::<Vec<_>>())
        };
        let force = Meaning::list((0..n).map(row).collect::<Vec<_>>());
        let target = Meaning::list((n..n + rows).map(row).collect::<Vec<_>>());
        let (mass_matrix, jacobian) =
            (in_shape(Shape::Matrix(n, n), &mass_matrix), in_shape(Shape::Matrix(rows, n), &jacobian));
        let motion = self.of_the_motion(Argument::Qdd, numbering);
        let sizes = self.sizes(function, numbering);
        let solution = match &self.derivation.elimination {
            Some(elimination) => {
                Meaning::call("sparse_slopes", sparse(elimination, &entries).into_iter().chain([force, target]))
            }
            None => {
                let measures = [self.vectors(), motion, sizes];
                Meaning::call("constrained_slopes", [mass_matrix, jacobian, force, target].into_iter().chain(measures))
            }
        };
        if widths.len() == 1 {
            return solution;
        }
        let solution = Rc::new(solution);
        let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
        assembled(function, starts.map(|start| Meaning::Columns(solution.clone(), start)).collect())
    }

    /// What columns of derivatives are measured by.
    fn sizes(&self, function: &Function, numbering: &mut Numbering) -> Meaning {
        if function.kind == FunctionKind::Linearize {
            let mut argument = |argument: Argument| {
                let (count, symbol) = self.components(argument);
                let symbols = (0..count).map(|i| Meaning::Number(numbering.symbol(symbol(i as u32))));
                Meaning::list(symbols.collect::<Vec<_>>())
            };
            let kinds = self.derivation.coordinate_kinds().into_iter().map(Meaning::Integer);
            return Meaning::call("state_sizes", [argument(Argument::Q), argument(Argument::Qd), Meaning::list(kinds)]);
        }
        let parameters = 0..count(&self.derivation.parameters) as u32;
        let parameter = |i: u32| Meaning::Number(numbering.symbol(Symbol::Parameter(i)));
        Meaning::list(parameters.map(parameter).collect::<Vec<_>>())
    }
}

/// The order of an elimination, and the entries of its system.
fn sparse(elimination: &Elimination, entries: &[Number]) -> [Meaning; 2] {
    [self::elimination(elimination), in_shape(Shape::Vector(entries.len()), entries)]
}

/// The order of an elimination.
pub(super) fn elimination(elimination: &Elimination) -> Meaning {
    let Elimination { order, starts, rows, places, .. } = elimination;
    let integers = |numbers: &[usize]| Meaning::list(numbers.iter().copied().map(Meaning::Integer));
    let tables = [("order", order.as_slice()), ("ends", &starts[1..]), ("rows", rows), ("places", places)];
    Meaning::record("mbs_runtime::Elimination", tables.map(|(name, numbers)| (name, integers(numbers))))
}

/// The parts of a function's result as it returns them.
fn assembled(function: &Function, mut parts: Vec<Meaning>) -> Meaning {
    let record = |name: &str, parts: Vec<Meaning>| {
        Meaning::record(&format!("mbs_runtime::{name}"), function.results.iter().map(|part| part.name).zip(parts))
    };
    match function.kind {
        FunctionKind::Linearize => record("Linearization", parts),
        FunctionKind::InverseDynamicsJacobian => record("InverseDynamicsJacobian", parts),
        _ if parts.len() == 1 => parts.remove(0),
        _ => Meaning::Tuple(parts.into()),
    }
}

/// A result in storage of the caller, of which nothing is written.
pub(super) fn unwritten(function: &Function) -> Meaning {
    let mut nothing = std::iter::repeat(Meaning::Tuple([].into()));
    assembled(function, function.results.iter().map(|part| shaped(part.shape, &mut nothing)).collect())
}

/// How many columns the right sides of a part have.
pub(super) fn width(part: &ResultPart) -> usize {
    match part.shape {
        Shape::Matrix(_, columns) => columns,
        _ => 1,
    }
}

/// All these values in this shape.
fn in_shape(shape: Shape, values: &[Number]) -> Meaning {
    shaped(shape, &mut values.iter().copied().map(Meaning::Number))
}

/// The next values in this shape; of a symmetric matrix they are the lower triangle.
pub(super) fn shaped(shape: Shape, values: &mut dyn Iterator<Item = Meaning>) -> Meaning {
    let mut several = |n: usize, of: Shape| Meaning::list((0..n).map(|_| shaped(of, values)).collect::<Vec<_>>());
    match shape {
        Shape::Scalar => values.next().expect("a value for each component"),
        Shape::Vector(n) => several(n, Shape::Scalar),
        Shape::Matrix(rows, columns) => several(rows, Shape::Vector(columns)),
        Shape::Wrenches(n) => several(n, Shape::Wrench),
        Shape::Poses(n) => several(n, Shape::Pose),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns)),
        Shape::Symmetric(n) => {
            let triangle: Vec<Meaning> = values.take(shape.count()).collect();
            let entry = |i: usize, j: usize| triangle[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)].clone();
            let row = |i: usize| Meaning::list((0..n).map(|j| entry(i, j)).collect::<Vec<_>>());
            Meaning::list((0..n).map(row).collect::<Vec<_>>())
        }
        Shape::Pose => {
            let position = shaped(Shape::Vector(3), values);
            let rotation = shaped(Shape::Matrix(3, 3), values);
            Meaning::record("mbs_runtime::Pose", [("position", position), ("rotation", rotation)])
        }
        Shape::Wrench => {
            let [force, moment] = [(); 2].map(|()| shaped(Shape::Vector(3), values));
            Meaning::record("mbs_runtime::Wrench", [("force", force), ("moment", moment)])
        }
    }
}

/// The next values in arrays of these lengths.
pub(super) fn nested(lengths: &[usize], values: &mut dyn Iterator<Item = Meaning>) -> Meaning {
    match lengths {
        [] => values.next().expect("a value for each component"),
        [length, inner @ ..] => Meaning::list((0..*length).map(|_| nested(inner, values)).collect::<Vec<_>>()),
    }
}
