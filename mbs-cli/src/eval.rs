//! `mbs eval`: the value of every function at given states.

use std::path::PathBuf;

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, FunctionKind, ResultPart, Shape};
use mbs_runtime::RedundantRows;
use serde_json::{Map, Value, json};

use crate::cache::Cache;
use crate::check::freedom::LostRank;
use crate::equations::{Equations, Redundant, Solver};
use crate::failure::Failure;
use crate::simulate::assembly;
use crate::state::{self, Point, Request};
use crate::{mechanism, output};

/// Evaluate a mechanism's equations at one state, or at each of many: matrices, forces, energies, outputs.
///
/// It is algebra at the given state: what is singular there is printed as null, with a warning.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs eval pendulum.mbs --state '{\"theta\": 0.5}' --only mass_matrix,gravity")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// A file with a JSON object, or an array of them: {"t": 0, "q": […], "qd": […], "qdd": […], "u": […], "params":
    /// {name: value}, "prescribed": {name: [value, rate, acceleration]}}, all but q optional: zero, or the declared
    /// default. `-` is standard input; JSON itself is taken, too.
    #[arg(long, value_name = "STATE.json")]
    state: String,
    /// Print these quantities alone: names of the output, or of any generated function, such as `tip_velocity`,
    /// `tip_jacobian`, `momentum`.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    only: Vec<String>,
    /// Constraints that depend on others: an error, or multipliers of the least norm. Without this option accelerations
    /// and multipliers are those of the generated functions, which take multipliers of the least norm in the scale of
    /// their rows.
    #[arg(long, value_enum)]
    redundant: Option<Redundant>,
}

/// Prints one JSON object for a state, an array of them for an array of states.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let derivation = mechanism::read(&arguments.file, cache)?.derivation;
    check_names(&arguments.only, &derivation)?;
    if arguments.redundant.is_some() && derivation.constraints.is_empty() {
        output::warn(format_args!("{} has no constraints, --redundant does nothing", derivation.name));
    }
    let mut ranks = LostRank::of(&derivation);
    let mut evaluation = |point: &Point, place: &str| {
        ranks.warn(point, place)?;
        let all = evaluation(&derivation, point, Moving::of(&derivation, point, arguments.redundant)?);
        Ok(chosen(&derivation, point, all, &arguments.only, place))
    };
    let evaluations = match state::read(&arguments.state, &derivation, &[])? {
        Request::One(point) => evaluation(&point, "the state")?,
        Request::Many(points) => {
            let all = points.iter().enumerate().map(|(i, point)| evaluation(point, &format!("state {i}")));
            all.collect::<Result<Value, Failure>>()?
        }
    };
    output::print(&output::json(&evaluations))
}

/// What `eval` prints beside the values of functions.
const COMPOSED: [&str; 5] = ["conserved", "outputs", "output_jacobians", "reactions", "constraint_force"];

/// Accelerations and multipliers at a state.
struct Moving {
    accelerations: Vec<f64>,
    multipliers: Vec<f64>,
}

impl Moving {
    /// Those of the generated functions, the multipliers on request of the least norm; NaN where constraints contradict
    /// each other.
    fn of(derivation: &Derivation, point: &Point, redundant: Option<Redundant>) -> Result<Self, Failure> {
        let (equations, state) = (Equations::new(derivation, point)?, &point.state);
        let [accelerations, mut multipliers] =
            [equations.call(FunctionKind::ForwardDynamics, state), equations.rows_of(FunctionKind::Multipliers, state)];
        let is_constrained = !derivation.constraints.is_empty();
        match redundant.filter(|_| is_constrained) {
            None => {}
            Some(Redundant::Refuse) => {
                assembly::check_rows(&equations, &equations.start(), RedundantRows::Refuse).map_err(Failure::new)?;
            }
            // What all rows bear together, and the accelerations, are the same.
            Some(Redundant::LeastNorm) if accelerations.iter().all(|x| x.is_finite()) => {
                let found = Solver::numerical(&equations, RedundantRows::LeaveOut, [0.0; 2]).multipliers(state);
                multipliers = found.unwrap_or_else(|_| vec![f64::NAN; multipliers.len()]);
            }
            Some(Redundant::LeastNorm) => {}
        }
        Ok(Moving { accelerations, multipliers })
    }
}

/// There is such a function, or such a part of what `eval` prints.
fn check_names(only: &[String], derivation: &Derivation) -> Result<(), Failure> {
    let functions = derivation.functions.iter().map(|function| function.name.clone());
    let known: Vec<String> = functions.chain(COMPOSED.map(String::from)).collect();
    match only.iter().find(|name| !known.contains(name)) {
        Some(name) => {
            let hint = state::hint(name, &known, "quantities");
            Err(Failure::new(format_args!("--only: there is no quantity `{name}`{hint}")))
        }
        None => Ok(()),
    }
}

/// The quantities asked for, in this order; all that `eval` prints where none are.
fn chosen(derivation: &Derivation, point: &Point, all: Value, only: &[String], place: &str) -> Value {
    let interpreter = Interpreter::with_parameters(derivation, point.parameters.clone());
    let value = |name: &String| match (all.get(name), derivation.named(name)) {
        (Some(value), _) => value.clone(),
        (None, Some(function)) => shaped(function, &interpreter.evaluate(function, &point.state)),
        (None, None) => Value::Null,
    };
    let chosen = match only {
        [] => all.clone(),
        names => Value::Object(names.iter().map(|name| (name.clone(), value(name))).collect()),
    };
    warn_of_nulls(&chosen, place);
    chosen
}

/// The functions that are printed first; those of a mechanism that are not among them follow behind what is composed.
const FIRST: [FunctionKind; 13] = [
    FunctionKind::MassMatrix,
    FunctionKind::CoriolisMatrix,
    FunctionKind::Gravity,
    FunctionKind::Bias,
    FunctionKind::DissipationForce,
    FunctionKind::GeneralizedForce,
    FunctionKind::InverseDynamics,
    FunctionKind::InverseDynamicsJacobian,
    FunctionKind::ForwardDynamics,
    FunctionKind::Linearize,
    FunctionKind::Multipliers,
    FunctionKind::KineticEnergy,
    FunctionKind::PotentialEnergy,
];

/// Functions that are printed on request, or as a part of something else.
const APART: [FunctionKind; 3] = [FunctionKind::Momentum, FunctionKind::LinearizeParameters, FunctionKind::Conserved];

/// All functions at one point.
fn evaluation(derivation: &Derivation, point: &Point, moving: Moving) -> Value {
    let interpreter = Interpreter::with_parameters(derivation, point.parameters.clone());
    let evaluated = |function: &Function| interpreter.evaluate_with(function, &point.state, &moving.multipliers);
    let value = |kind| derivation.function(kind).map_or(Value::Null, |f| shaped(f, &evaluated(f)));
    let printed = |kind: FunctionKind| {
        let value = match kind {
            FunctionKind::ForwardDynamics => moving.accelerations.clone().into(),
            FunctionKind::Multipliers => moving.multipliers.clone().into(),
            FunctionKind::Linearize => {
                let mut linearize = value(kind);
                let is_there = derivation.function(FunctionKind::LinearizeParameters).is_some();
                let none = || vec![json!([]); derivation.dof()].into();
                linearize["params"] = if is_there { value(FunctionKind::LinearizeParameters) } else { none() };
                linearize
            }
            kind => value(kind),
        };
        (kind.name().to_string(), value)
    };
    // Of many coordinates most matrices are left out.
    let is_there = |kind: &FunctionKind| *kind == FunctionKind::Multipliers || derivation.function(*kind).is_some();
    let mut evaluation: Map<String, Value> = FIRST.into_iter().filter(is_there).map(printed).collect();
    evaluation.insert("conserved".to_string(), conserved(derivation, evaluated).into());
    evaluation.insert("outputs".to_string(), outputs(derivation, evaluated).into());
    let jacobians = output_jacobians(derivation, evaluated);
    if !jacobians.is_empty() {
        evaluation.insert("output_jacobians".to_string(), jacobians.into());
    }
    if !derivation.reactions.is_empty() {
        let reactions = reactions(derivation, &interpreter, point, &moving);
        evaluation.insert("reactions".to_string(), reactions.into());
    }
    let of_mechanism = |kind: &FunctionKind| kind.output().or(kind.reaction()).is_none();
    let others = derivation.functions.iter().map(|function| function.kind).filter(of_mechanism);
    evaluation.extend(others.filter(|kind| !FIRST.contains(kind) && !APART.contains(kind)).map(printed));
    if !derivation.constraints.is_empty() {
        let force = constraint_force(&interpreter, &point.state, &moving.multipliers);
        evaluation.insert("constraint_force".to_string(), force.into());
    }
    evaluation.into()
}

/// `Aᵀ λ`, with the multipliers of the motion.
fn constraint_force(interpreter: &Interpreter<'_>, state: &State, multipliers: &[f64]) -> Vec<f64> {
    let jacobian = interpreter.rows(FunctionKind::ConstraintJacobian, state);
    let mut force = vec![0.0; state.q.len()];
    for (row, multiplier) in jacobian.chunks(force.len()).zip(multipliers) {
        force.iter_mut().zip(row).for_each(|(force, a)| *force += a * multiplier);
    }
    force
}

/// First integrals by name.
fn conserved(derivation: &Derivation, evaluated: impl Fn(&Function) -> Vec<f64>) -> Map<String, Value> {
    let values = derivation.function(FunctionKind::Conserved).map(evaluated);
    derivation.conserved.iter().cloned().zip(values.into_iter().flatten().map(Value::from)).collect()
}

/// Values of the outputs by name, and rates of Jacobians that were asked for.
fn outputs(derivation: &Derivation, evaluated: impl Fn(&Function) -> Vec<f64>) -> Map<String, Value> {
    let shown = |f: &&Function| matches!(f.kind, FunctionKind::Output(_) | FunctionKind::OutputJacobianRate(_));
    let outputs = derivation.functions.iter().filter(shown);
    outputs.map(|function| (function.name.clone(), shaped(function, &evaluated(function)))).collect()
}

/// The derivatives of those outputs that depend on velocities or inputs, by name: by q, and where they depend on them
/// by q̇ and u.
fn output_jacobians(derivation: &Derivation, evaluated: impl Fn(&Function) -> Vec<f64>) -> Map<String, Value> {
    let slopes = derivation.functions.iter().filter_map(|output| {
        let FunctionKind::Output(number) = output.kind else { return None };
        let functions = [
            ("q", FunctionKind::OutputJacobian(number)),
            ("qd", FunctionKind::OutputJacobianQd(number)),
            ("u", FunctionKind::OutputJacobianU(number)),
        ];
        let functions = functions.into_iter().filter_map(|(by, kind)| Some((by, derivation.function(kind)?)));
        let by: Map<String, Value> = functions.map(|(by, f)| (by.to_string(), shaped(f, &evaluated(f)))).collect();
        (by.len() > 1).then(|| (output.name.clone(), by.into()))
    });
    slopes.collect()
}

/// Force and moment at each joint by name, at the given accelerations, or at those of the motion.
fn reactions(
    derivation: &Derivation,
    interpreter: &Interpreter<'_>,
    point: &Point,
    moving: &Moving,
) -> Map<String, Value> {
    let mut state = point.state.clone();
    if !point.accelerations_are_given {
        state.qdd.clone_from(&moving.accelerations);
    }
    let functions = derivation.functions.iter().filter_map(|function| match function.kind {
        FunctionKind::Reaction(number) => Some((function, &derivation.reactions[number])),
        _ => None,
    });
    let joints = functions.flat_map(|(function, reaction)| {
        let wrenches = interpreter.evaluate_with(function, &state, &moving.multipliers);
        let wrenches: Vec<Value> = wrenches.chunks(6).map(|wrench| in_shape(Shape::Wrench, wrench)).collect();
        reaction.component_names().into_iter().zip(wrenches)
    });
    joints.collect()
}

/// A function's results in their shape: one value, or an object of named ones.
fn shaped(function: &Function, values: &[f64]) -> Value {
    if let [ResultPart { name: "", shape }] = function.results.as_slice() {
        return in_shape(*shape, values);
    }
    let mut start = 0;
    let parts = function.results.iter().map(|part| {
        let part_values = &values[start..start + part.shape.count()];
        start += part.shape.count();
        (part.name.to_string(), in_shape(part.shape, part_values))
    });
    Value::Object(parts.collect())
}

fn in_shape(shape: Shape, values: &[f64]) -> Value {
    match shape {
        Shape::Scalar => json!(values[0]),
        Shape::Vector(_) => json!(values),
        Shape::Matrix(height, width) => rows(values, height, width),
        Shape::Symmetric(n) => rows(values, n, n),
        Shape::Pose => json!({ "position": values[..3], "rotation": rows(&values[3..], 3, 3) }),
        Shape::Wrench => json!({ "force": values[..3], "moment": values[3..6] }),
        Shape::Wrenches(_) => values.chunks(6).map(|wrench| in_shape(Shape::Wrench, wrench)).collect(),
        Shape::Matrices(_, height, width) => {
            values.chunks(height * width).map(|matrix| rows(matrix, height, width)).collect()
        }
        Shape::Poses(_) => values.chunks(12).map(|pose| in_shape(Shape::Pose, pose)).collect(),
    }
}

fn rows(values: &[f64], height: usize, width: usize) -> Value {
    (0..height).map(|i| json!(values[i * width..(i + 1) * width])).collect()
}

fn warn_of_nulls(evaluation: &Value, place: &str) {
    let entries = evaluation.as_object().into_iter().flatten();
    let names: Vec<&str> = entries.filter(|(_, value)| holds_null(value)).map(|(name, _)| name.as_str()).collect();
    if !names.is_empty() {
        let names = names.join(", ");
        output::warn(format_args!("infinite or NaN at {place}, printed as null: {names}"));
    }
}

fn holds_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.iter().any(holds_null),
        Value::Object(items) => items.values().any(holds_null),
        Value::Bool(_) | Value::Number(_) | Value::String(_) => false,
    }
}
