//! What functions are to give, as each language writes it.

use crate::expr::Symbol;
use crate::optimise::{Argument, Completion, Function, FunctionKind};
use crate::shape::{ResultPart, Shape};
use crate::variable::count;

use super::super::meaning::{Meaning, System, width};
use super::super::numbering::Number;
use super::super::reader::Reading;
use super::Foreign;
use super::dialect::Family;
use super::value::Value;

/// Numbers, one after the other.
fn list(values: &[Number]) -> Value {
    Value::Array(values.iter().copied().map(Value::Number).collect())
}

/// Rows of this many numbers.
fn rows(values: &[Number], columns: usize) -> Value {
    Value::Array(values.chunks(columns).map(list).collect())
}

fn integers(values: impl IntoIterator<Item = usize>) -> Value {
    Value::Array(values.into_iter().map(Value::Integer).collect())
}

fn text(text: &str) -> Value {
    Value::Text(text.to_string())
}

impl Foreign<'_, '_> {
    /// What a function gives; of the motion with constraints both.
    pub(super) fn expected(&mut self, function: &Function, is_motion: bool) -> Reading<Value> {
        if is_motion {
            let system = self.expectation.system(function, &mut self.numbering);
            return Ok(self.motion(&system));
        }
        let of_the_motion = match function.completion {
            Completion::SolveMultipliers => Some(Argument::Multipliers),
            Completion::SolveConstrained if function.kind == FunctionKind::ForwardDynamics => Some(Argument::Qdd),
            _ => None,
        };
        if let Some(argument) = of_the_motion {
            return Ok(Value::from(&self.expectation.of_the_motion(argument, &mut self.numbering)));
        }
        match function.completion {
            Completion::None => self.values(function),
            Completion::Solve => {
                let system = self.expectation.system(function, &mut self.numbering);
                Ok(self.solved(function, &system))
            }
            Completion::SolveConstrained | Completion::SolveMultipliers => {
                let system = self.expectation.system(function, &mut self.numbering);
                Ok(self.slopes(function, &system))
            }
        }
    }

    /// The values of a program, as they are.
    fn values(&mut self, function: &Function) -> Reading<Value> {
        let returned = self.expectation.returned(function, &mut self.numbering);
        let parts: Vec<Value> = match (&returned, function.results.len()) {
            (_, 1) => vec![Value::from(&returned)],
            (Meaning::Tuple(parts), _) => parts.iter().map(Value::from).collect(),
            (Meaning::Record(_, fields), _) => {
                function.results.iter().map(|part| Value::from(&fields[part.name])).collect()
            }
            _ => return Err("it has no parts".to_string()),
        };
        match self.dialect.family {
            Family::C if self.outputs(function, false).is_empty() => {
                Ok(parts.into_iter().next().unwrap_or(Value::Unset))
            }
            Family::C | Family::Matlab => {
                let flat = parts.iter().map(Value::flat).collect::<Reading<Vec<_>>>()?;
                Ok(Value::Array(flat.concat()))
            }
            Family::Js => Ok(self.together(function, parts)),
            Family::Python => {
                let parts = function.results.iter().zip(&parts);
                let parts = parts.map(|(part, value)| Ok(filled(part.shape, Value::Array(value.flat()?))));
                let parts = parts.collect::<Reading<Vec<_>>>()?;
                Ok(self.together(function, parts))
            }
        }
    }

    /// The parts of a result, as the language returns them.
    fn together(&self, function: &Function, mut parts: Vec<Value>) -> Value {
        if parts.len() == 1 {
            return parts.remove(0);
        }
        match self.dialect.family {
            Family::C | Family::Matlab => Value::Array(parts),
            Family::Js => {
                let names = function.results.iter().map(|part| part.name.to_string());
                Value::Struct(names.zip(parts).collect())
            }
            Family::Python => {
                let words = function.name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]);
                Value::call(&(words.collect::<String>() + "Result"), parts)
            }
        }
    }

    /// `M⁻¹` of right sides.
    fn solved(&self, function: &Function, system: &System) -> Value {
        let n = self.derivation.dof();
        let size = Value::Integer(n);
        let masses = match self.dialect.family {
            Family::C | Family::Js => list(&system.mass_matrix),
            Family::Python | Family::Matlab => rows(&system.mass_matrix, n),
        };
        let parts = function.results.iter().zip(&system.right_sides);
        let solved = |(part, values): (&ResultPart, &Vec<Number>)| {
            let columns = Value::Integer(width(part));
            match self.dialect.family {
                Family::C => {
                    let factors = Value::call("mbs_ldlt", [size.clone(), masses.clone()]);
                    let reciprocals = Value::call("reciprocals", [factors.clone()]);
                    Value::call("mbs_ldlt_solve", [size.clone(), columns, factors, reciprocals, list(values)])
                }
                Family::Js | Family::Python => {
                    let reciprocals = Value::call("mbs_ldlt", [size.clone(), masses.clone()]);
                    let arguments = [size.clone(), columns, masses.clone(), reciprocals, list(values)];
                    let solution = Value::call("mbs_ldlt_solve", arguments);
                    if self.dialect.family == Family::Js {
                        in_rows(solution, part.shape)
                    } else {
                        filled(part.shape, solution)
                    }
                }
                Family::Matlab => {
                    let factors = Value::call("mbs_ldlt", [masses.clone()]);
                    let [factors, reciprocals] =
                        [0, 1].map(|i| Value::call("part", [factors.clone(), Value::Integer(i)]));
                    Value::call("mbs_ldlt_solve", [factors, reciprocals, matrix(values, width(part), n)])
                }
            }
        };
        let is_there =
            |(part, _): &(&ResultPart, &Vec<Number>)| self.dialect.family != Family::C || part.shape.entries() > 0;
        let solved: Vec<Value> = parts.filter(is_there).map(solved).collect();
        match self.dialect.family {
            Family::C | Family::Matlab => Value::Array(solved),
            Family::Js | Family::Python => self.together(function, solved),
        }
    }

    fn vectors(&self) -> Value {
        integers(self.derivation.constraint_vectors.iter().copied())
    }

    /// M, A and what follows of them for a language that solves by these.
    fn all(&self, system: &System) -> Vec<Number> {
        [&system.mass_matrix[..], &system.jacobian, &system.right_sides.concat()].concat()
    }

    /// Accelerations and multipliers.
    fn motion(&self, system: &System) -> Value {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let right_side = &system.right_sides[0];
        let none = || Value::Array(Vec::new());
        match self.dialect.family {
            Family::C => {
                let (force, target) = right_side.split_at(n);
                let solution = |i| {
                    let one = Value::Integer(1);
                    let arguments = [list(&system.mass_matrix), list(&system.jacobian), one, list(force), list(target)];
                    let zeros = [Value::Integer(0), Value::Integer(0), Value::Integer(i)];
                    let name = format!("{}_constrained_solution", self.prefix);
                    Value::call(&name, arguments.into_iter().chain(zeros))
                };
                Value::Array(vec![solution(0), solution(1)])
            }
            Family::Js => {
                let solve = [self.null_space(system), Value::Array(vec![list(right_side)]), none(), none()];
                let motion = Value::call("part", [Value::call(".solve", solve), Value::Integer(0)]);
                let slice = |from: &[usize]| {
                    let ends = from.iter().copied().map(Value::Integer);
                    Value::call(".slice", [motion.clone()].into_iter().chain(ends))
                };
                Value::Struct([("qdd".to_string(), slice(&[0, n])), ("multipliers".to_string(), slice(&[n]))].into())
            }
            Family::Python => {
                let values = self.all(system);
                let values = filled(Shape::Vector(values.len()), list(&values));
                let given = [Value::Integer(n), self.vectors(), values, integers([1]), text("None"), text("None")];
                let solved = Value::call("[]", [Value::call("mbs_constrained", given), text("..."), Value::Integer(0)]);
                let slice = |ends: &[Value]| {
                    Value::call("[]", [solved.clone(), text("..."), Value::call(":", ends.iter().cloned())])
                };
                Value::Array(vec![slice(&[Value::Integer(n)]), slice(&[Value::Integer(n), Value::Unset])])
            }
            Family::Matlab => {
                let solve = [self.null_space(system), list(right_side), none(), none()];
                let motion = Value::call("mbs_solve", solve);
                let part = |from, to| Value::call("[]", [motion.clone(), range(from, to)]);
                Value::Array(vec![part(1, n), part(n + 1, n + k)])
            }
        }
    }

    fn null_space(&self, system: &System) -> Value {
        let n = self.derivation.dof();
        match self.dialect.family {
            Family::Matlab => {
                let [masses, jacobian] = [&system.mass_matrix, &system.jacobian].map(|values| matrix(values, n, n));
                Value::call("mbs_null_space", [self.vectors(), masses, jacobian])
            }
            _ => {
                let (masses, jacobian) = (list(&system.mass_matrix), list(&system.jacobian));
                Value::call("mbs_NullSpace", [Value::Integer(n), self.vectors(), masses, jacobian])
            }
        }
    }

    /// Derivatives of the motion with constraints.
    fn slopes(&mut self, function: &Function, system: &System) -> Value {
        let n = self.derivation.dof();
        let widths: Vec<usize> = function.results.iter().map(width).collect();
        let columns: usize = widths.iter().sum();
        let sizes = self.sizes(function, columns);
        let motion = Value::from(&self.expectation.of_the_motion(Argument::Qdd, &mut self.numbering));
        let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
        let spans = starts.zip(&widths).map(|(start, width)| (start, *width));
        let parts: Vec<Value> = match self.dialect.family {
            Family::C => {
                let row = |i: usize| {
                    let parts = system.right_sides.iter().zip(&widths);
                    parts.flat_map(move |(part, &width)| part[i * width..(i + 1) * width].iter().copied())
                };
                let all = n + self.derivation.constraints.len();
                let [force, target] = [0..n, n..all].map(|rows| rows.flat_map(row).collect::<Vec<_>>());
                let arguments = [
                    list(&system.mass_matrix),
                    list(&system.jacobian),
                    Value::Integer(columns),
                    list(&force),
                    list(&target),
                    motion,
                    sizes,
                    Value::Integer(0),
                ];
                let solution = Value::call(&format!("{}_constrained_solution", self.prefix), arguments);
                let part = |(start, width)| {
                    let numbers = [n, width, columns, start].map(Value::Integer);
                    Value::call("columns", [solution.clone()].into_iter().chain(numbers))
                };
                spans.filter(|(_, width)| *width > 0).map(part).collect()
            }
            Family::Js => {
                let right_side = list(&system.right_sides.concat());
                let motion = Value::call("Array.from", [motion]);
                let given = [self.null_space(system), right_side, integers(widths.iter().copied()), motion, sizes];
                let solved = Value::call("mbs_slopes", given);
                let part = |i| Value::call("[]", [solved.clone(), Value::Integer(i)]);
                function.results.iter().enumerate().map(|(i, of)| in_rows(part(i), of.shape)).collect()
            }
            Family::Python => {
                let values = self.all(system);
                let values = filled(Shape::Vector(values.len()), list(&values));
                let given =
                    [Value::Integer(n), self.vectors(), values, integers(widths.iter().copied()), motion, sizes];
                let solved = Value::call("mbs_constrained", given);
                let part = |(start, width)| {
                    let rows = Value::call(":", [Value::Integer(n)]);
                    Value::call("[]", [solved.clone(), text("..."), rows, range(start, start + width)])
                };
                spans.map(part).collect()
            }
            Family::Matlab => {
                let right_sides = system.right_sides.iter().zip(&widths);
                let all = n + self.derivation.constraints.len();
                let right_sides = right_sides.map(|(values, &width)| matrix(values, width, all)).collect();
                let given = [self.null_space(system), Value::Array(right_sides), motion, sizes];
                let solved = Value::call("mbs_solve", given);
                let part =
                    |(start, width)| Value::call("[]", [solved.clone(), range(1, n), range(start + 1, start + width)]);
                spans.map(part).collect()
            }
        };
        match self.dialect.family {
            Family::C | Family::Matlab => Value::Array(parts),
            Family::Js | Family::Python => self.together(function, parts),
        }
    }

    /// How large that is by which columns are derivatives.
    fn sizes(&mut self, function: &Function, columns: usize) -> Value {
        let n = self.derivation.dof();
        if function.kind != FunctionKind::Linearize {
            let all = 0..count(&self.derivation.parameters) as u32;
            let parameters: Vec<Number> = all.map(|i| self.numbering.symbol(Symbol::Parameter(i))).collect();
            return match self.dialect.family {
                Family::Python => filled(Shape::Vector(columns), list(&parameters)),
                Family::C | Family::Js | Family::Matlab => list(&parameters),
            };
        }
        let [q, qd] = [Symbol::Coordinate as fn(u32) -> Symbol, Symbol::Velocity].map(|symbol| {
            let symbols: Vec<Number> = (0..n as u32).map(|i| self.numbering.symbol(symbol(i))).collect();
            list(&symbols)
        });
        let kinds = integers(self.derivation.coordinate_kinds());
        let inputs = Value::Integer(count(&self.derivation.inputs));
        match self.dialect.family {
            Family::C => {
                let [size, columns] = [n, columns].map(Value::Integer);
                Value::call("mbs_state_sizes", [size, columns, kinds, q, qd])
            }
            Family::Python => Value::call("mbs_state_sizes", [text("batch"), q, qd, kinds, inputs]),
            Family::Js | Family::Matlab => Value::call("mbs_state_sizes", [q, qd, kinds, inputs]),
        }
    }
}

/// `from:to`
fn range(from: usize, to: usize) -> Value {
    Value::call(":", [from, to].map(Value::Integer))
}

/// A matrix of MATLAB; of one column it is the numbers of that.
fn matrix(values: &[Number], columns: usize, count: usize) -> Value {
    match columns {
        0 => Value::Array(vec![Value::Array(Vec::new()); count]),
        1 => list(values),
        columns => rows(values, columns),
    }
}

/// An array of JavaScript in rows, where it is a matrix.
fn in_rows(part: Value, shape: Shape) -> Value {
    match shape {
        Shape::Matrix(rows, 0) => Value::Array(vec![Value::Array(Vec::new()); rows]),
        Shape::Matrix(_, columns) => Value::call("mbs_rows", [part, Value::Integer(columns)]),
        _ => part,
    }
}

/// Values as arrays of NumPy in this shape, behind the axes of the batch.
fn filled(shape: Shape, values: Value) -> Value {
    let (fill, axes) = match shape {
        Shape::Scalar => ("mbs_filled", Vec::new()),
        Shape::Vector(n) => ("mbs_filled", vec![n]),
        Shape::Matrix(rows, columns) => ("mbs_filled", vec![rows, columns]),
        Shape::Symmetric(n) => ("mbs_filled", vec![n, n]),
        Shape::Matrices(n, rows, columns) => ("mbs_filled", vec![n, rows, columns]),
        Shape::Pose => ("mbs_pose", Vec::new()),
        Shape::Poses(n) => ("mbs_pose", vec![n]),
        Shape::Wrench => ("mbs_wrench", Vec::new()),
        Shape::Wrenches(n) => ("mbs_wrench", vec![n]),
    };
    let filled = Value::call(fill, [text("batch"), integers(axes), values]);
    if shape == Shape::Scalar { Value::call("[]", [filled, Value::Array(Vec::new())]) } else { filled }
}
