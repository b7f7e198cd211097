//! What the scripts of the page are told: names, units, functions with their arguments, what there is to see.

use std::collections::BTreeMap;

use mbs_derive::emit::Language;
use mbs_derive::optimise::{Argument, Derivation, Function, FunctionKind};
use mbs_derive::variable::Variable;
use serde_json::{Map, Value, json};

use super::Parts;
use crate::scene::mesh::{self, Triangles};
use crate::state::Point;

/// What the motion is computed and judged by.
const NEEDED: [FunctionKind; 9] = [
    FunctionKind::KineticEnergy,
    FunctionKind::PotentialEnergy,
    FunctionKind::MassMatrix,
    FunctionKind::ForwardDynamics,
    FunctionKind::Conserved,
    FunctionKind::Constraint,
    FunctionKind::ConstraintRate,
    FunctionKind::ConstraintJacobian,
    FunctionKind::Multipliers,
];

/// Whether the page calls it.
fn is_called(function: &Function) -> bool {
    let is_empty =
        function.kind == FunctionKind::Conserved && function.results.iter().all(|part| part.shape.count() == 0);
    (NEEDED.contains(&function.kind) && !is_empty) || matches!(function.kind, FunctionKind::Output(_))
}

/// The names of the functions that the page calls.
pub(super) fn called(derivation: &Derivation) -> Vec<String> {
    derivation.functions.iter().filter(|function| is_called(function)).map(|function| function.name.clone()).collect()
}

/// What the page's scripts know of the mechanism, its meshes and its motion.
pub(super) fn about(parts: &Parts, meshes: &BTreeMap<usize, Triangles>, start: &Point, end: f64) -> Value {
    let (derivation, scene) = (&parts.mechanism.derivation, &parts.scene);
    let has_meshes = mesh::are_all(scene, meshes);
    let bodies = scene
        .bodies
        .iter()
        .map(|body| json!({ "frame": body.frame, "rigid": body.is_rigid, "shaped": body.has_shape && has_meshes }));
    let shapes =
        scene.shapes.iter().enumerate().map(
            |(number, shape)| json!({ "kind": shape.kind, "frame": shape.frame, "triangles": meshes.get(&number) }),
        );
    json!({
        "name": derivation.name,
        "coordinates": variables(&derivation.coordinates),
        "parameters": variables(&derivation.parameters),
        "inputs": variables(&derivation.inputs),
        "prescribed": variables(&derivation.prescribed),
        "constraints": derivation.constraints,
        "holonomic": derivation.holonomic,
        "constraint_units": derivation.constraint_units,
        "conserved": derivation.conserved,
        "functions": functions(derivation, is_called),
        "outputs": outputs(derivation),
        "scene": {
            "functions": functions(&scene.derivation, |_| true),
            "frames": scene.frames,
            "bodies": bodies.collect::<Vec<_>>(),
            "shapes": shapes.collect::<Vec<_>>(),
            "places": scene.places,
            "links": scene.links,
            "traced": scene.traced,
        },
        "start": {
            "t": start.state.t,
            "q": start.state.q,
            "qd": start.state.qd,
            "u": start.state.u,
            "prescribed": start.state.prescribed,
            "parameters": start.parameters,
        },
        "end": start.state.t + end,
    })
}

fn variables(variables: &[Variable]) -> Vec<Value> {
    let of = |variable: &Variable| {
        let defaults: Vec<f64> = variable.defaults.iter().map(|number| number.to_f64()).collect();
        json!({
            "name": variable.name,
            "unit": variable.unit,
            "docs": variable.docs.join(" ").trim(),
            "first": variable.first,
            "names": variable.component_names(),
            "lengths": variable.lengths(),
            "defaults": defaults,
            "positive": variable.positive,
        })
    };
    variables.iter().map(of).collect()
}

/// By name the method of the class, and what it takes in which order.
fn functions(derivation: &Derivation, is_called: impl Fn(&Function) -> bool) -> Value {
    let names = Language::documented(derivation);
    let functions = derivation.functions.iter().zip(names).filter(|(function, _)| is_called(function));
    let entry = |(function, (name, _)): (&Function, (String, Vec<String>))| {
        let method = if name == "constructor" { "constructor_2".to_string() } else { name };
        (function.name.clone(), json!({ "method": method, "arguments": arguments(derivation, function) }))
    };
    Value::Object(functions.map(entry).collect::<Map<_, _>>())
}

fn arguments(derivation: &Derivation, function: &Function) -> Vec<&'static str> {
    let time = derivation.depends_on_time.then_some("t");
    let signals = (!derivation.prescribed.is_empty()).then_some("prescribed");
    let state = function.arguments.iter().filter_map(|argument| match argument {
        Argument::Q => Some("q"),
        Argument::Qd => Some("qd"),
        Argument::Qdd => Some("qdd"),
        Argument::U => (!derivation.inputs.is_empty()).then_some("u"),
        Argument::Multipliers => (!derivation.constraints.is_empty()).then_some("multipliers"),
    });
    time.into_iter().chain(signals).chain(state).collect()
}

/// Outputs with the names and units of their components; attitudes are left to the picture.
fn outputs(derivation: &Derivation) -> Vec<Value> {
    let of = |function: &Function| {
        let FunctionKind::Output(number) = function.kind else { return None };
        let shape = function.results.first()?.shape;
        Some(json!({
            "name": function.name,
            "components": shape.components(&function.name),
            "units": derivation.output_units[number],
        }))
    };
    derivation.functions.iter().filter_map(of).collect()
}
