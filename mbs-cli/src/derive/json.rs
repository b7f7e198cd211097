//! The programs of a mechanism, and their graph, as data.
//!
//! ```json
//! {
//!   "mechanism": "Pendulum",
//!   "coordinates": [{"name": "theta", "unit": "rad", "length": null}],
//!   "parameters": [{"name": "m", "unit": "kg", "length": null, "columns": null, "defaults": [1.0]}],
//!   "inputs": [],
//!   "depends_on_time": false,
//!   "constructor": {"instructions": [["parameter", 0], …], "results": [3]},
//!   "functions": {"mass_matrix": {
//!     "arguments": ["q"], "returns": [{"name": "", "shape": ["symmetric", 1]}], "completion": "none",
//!     "operations": {"add": 0, …}, "instructions": [["hoisted", 0]], "results": [0]}, …},
//!   "prescribed": [],
//!   "constraints": [],
//!   "elimination": null,
//!   "graph": {"nodes": [{"operation": "symbol", "name": "m", "symbol": ["parameter", 0]}, …],
//!             "roots": {"mass_matrix": [3], …}},
//!   "splines": []
//! }
//! ```
//!
//! `docs/json.md` says what it all means.

use mbs_derive::expr::{Spline, Symbol};
use mbs_derive::optimise::{Completion, Derivation, Function, Instruction, Program, Shape};
use mbs_derive::variable::Variable;
use serde_json::{Map, Value, json};

use super::graph::graph;
use crate::{ops, output};

/// All programs of a mechanism, one instruction a line, and the graph of all of them.
pub(crate) fn programs(derivation: &Derivation) -> String {
    let functions: Map<String, Value> = derivation
        .functions
        .iter()
        .map(|function| (function.name.clone(), of_function(derivation, function)))
        .collect();
    let object = json!({
        "mechanism": derivation.name,
        "coordinates": variables(&derivation.coordinates),
        "parameters": derivation.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "inputs": variables(&derivation.inputs),
        "depends_on_time": derivation.depends_on_time,
        "constructor": program(derivation, &derivation.constructor),
        "functions": functions,
        "prescribed": variables(&derivation.prescribed),
        "constraints": derivation.constraints,
        "elimination": derivation.elimination.as_ref().map(|e| json!({ "order": e.order, "entries": e.entries })),
        "graph": graph(derivation),
        "splines": derivation.splines().into_iter().map(spline).collect::<Vec<_>>(),
    });
    output::json(&object)
}

fn variables(variables: &[Variable]) -> Vec<Value> {
    variables.iter().map(|v| json!({ "name": v.name, "unit": v.unit, "length": v.length })).collect()
}

fn parameter(variable: &Variable) -> Value {
    let Variable { name, unit, length, columns, defaults, .. } = variable;
    let defaults: Vec<f64> = defaults.iter().map(|number| number.to_f64()).collect();
    json!({ "name": name, "unit": unit, "length": length, "columns": columns, "defaults": defaults })
}

fn of_function(derivation: &Derivation, function: &Function) -> Value {
    // As functions of other languages have them.
    let time = derivation.depends_on_time.then_some("t");
    let prescribed = (!derivation.prescribed.is_empty()).then_some("prescribed");
    let state = function.arguments.iter().map(|a| a.name());
    let arguments: Vec<&str> = time.into_iter().chain(prescribed).chain(state).collect();
    let returns: Vec<Value> =
        function.results.iter().map(|part| json!({ "name": part.name, "shape": shape(part.shape) })).collect();
    let completion = match function.completion {
        Completion::None => "none",
        Completion::Solve => "solve",
        Completion::SolveConstrained => "solve constrained",
        Completion::SolveMultipliers => "solve multipliers",
    };
    json!({
        "arguments": arguments,
        "returns": returns,
        "completion": completion,
        "operations": ops::counts(function.operations),
        "instructions": instructions(derivation, &function.program),
        "results": results(&function.program),
    })
}

fn program(derivation: &Derivation, program: &Program) -> Value {
    json!({ "instructions": instructions(derivation, program), "results": results(program) })
}

fn instructions(derivation: &Derivation, program: &Program) -> Vec<Value> {
    let splines = spline_numbers(derivation, program);
    program.instructions.iter().map(|&i| instruction(i, &splines)).collect()
}

fn results(program: &Program) -> Vec<usize> {
    program.results.iter().map(|value| value.index()).collect()
}

fn spline(spline: &Spline) -> Value {
    json!({ "places": spline.places(), "rows": spline.rows() })
}

/// The number of each of a program's splines among those of all programs.
pub(super) fn spline_numbers(derivation: &Derivation, program: &Program) -> Vec<usize> {
    let all = derivation.splines();
    let number = |spline: &Spline| all.iter().position(|known| *known == spline).expect("one of all splines");
    program.splines.iter().map(number).collect()
}

fn shape(shape: Shape) -> Value {
    match shape {
        Shape::Scalar => json!(["scalar"]),
        Shape::Vector(n) => json!(["vector", n]),
        Shape::Matrix(rows, columns) => json!(["matrix", rows, columns]),
        Shape::Symmetric(n) => json!(["symmetric", n]),
        Shape::Pose => json!(["pose"]),
        Shape::Wrench => json!(["wrench"]),
        Shape::Wrenches(n) => json!(["wrenches", n]),
        Shape::Matrices(n, rows, columns) => json!(["matrices", n, rows, columns]),
        Shape::Poses(n) => json!(["poses", n]),
    }
}

/// Its name, and its operands or what it reads.
pub(super) fn instruction(instruction: Instruction, splines: &[usize]) -> Value {
    match instruction {
        Instruction::Constant(value) => json!(["constant", value.to_f64()]),
        Instruction::Symbol(symbol) => of_symbol(symbol),
        Instruction::Hoisted(k) => json!(["hoisted", k]),
        Instruction::Neg(a) => json!(["neg", a.index()]),
        Instruction::Add(a, b) => json!(["add", a.index(), b.index()]),
        Instruction::Sub(a, b) => json!(["sub", a.index(), b.index()]),
        Instruction::Mul(a, b) => json!(["mul", a.index(), b.index()]),
        Instruction::Div(a, b) => json!(["div", a.index(), b.index()]),
        Instruction::Sqrt(a) => json!(["sqrt", a.index()]),
        Instruction::Call(function, a) => json!([function.name(), a.index()]),
        Instruction::Call2(function, a, b) => json!([function.name(), a.index(), b.index()]),
        Instruction::Spline(d, a) => json!(["spline", splines[d.spline as usize], d.order, a.index()]),
        Instruction::Less(a, b) => json!(["less", a.index(), b.index()]),
        Instruction::LessEqual(a, b) => json!(["less_equal", a.index(), b.index()]),
        Instruction::And(a, b) => json!(["and", a.index(), b.index()]),
        Instruction::Not(a) => json!(["not", a.index()]),
        Instruction::Select(c, a, b) => json!(["select", c.index(), a.index(), b.index()]),
    }
}

/// Its kind and number.
pub(super) fn of_symbol(symbol: Symbol) -> Value {
    match symbol {
        Symbol::Time => json!(["t"]),
        Symbol::Coordinate(i) => json!(["q", i]),
        Symbol::Velocity(i) => json!(["qd", i]),
        Symbol::Acceleration(i) => json!(["qdd", i]),
        Symbol::Parameter(i) => json!(["parameter", i]),
        Symbol::Input(i) => json!(["u", i]),
        Symbol::Prescribed(i, order) => json!(["prescribed", i, order]),
        Symbol::Multiplier(i) => json!(["multiplier", i]),
    }
}
