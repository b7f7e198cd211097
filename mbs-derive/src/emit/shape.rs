//! The components of results, as programs compute them.

use std::collections::BTreeMap;

use crate::optimise::{Completion, Derivation, Function, FunctionKind};
use crate::shape::{ResultPart, Shape};
use crate::variable::component_names;

use super::body::Component;

/// Which of a program's results make up what a function returns, or hands to the runtime; of a system that is
/// eliminated in a known order nothing but its entries, unless it is to be `in_full`.
pub(super) fn components(derivation: &Derivation, function: &Function, in_full: bool) -> Vec<Component> {
    let n = derivation.dof();
    let square = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let mut components = Vec::new();
    let mut start = 0;
    let mut shapes: Vec<Shape> = function.results.iter().map(|part| part.shape).collect();
    if function.completion.solves() {
        shapes = shapes.into_iter().map(|shape| right_side_shape(derivation, shape)).collect();
        components = matrices(derivation, in_full);
        start = derivation.matrix_entries();
    }
    let names = part_names(function);
    for (shape, name) in shapes.into_iter().zip(&names) {
        match shape {
            Shape::Symmetric(_) => components.extend(square().map(|(i, j)| {
                let (row, column) = (i.max(j), i.min(j));
                Component::Result(start + triangular(row, column), format!("m_{row}_{column}"))
            })),
            Shape::Scalar
            | Shape::Vector(_)
            | Shape::Matrix(..)
            | Shape::Pose
            | Shape::Wrench
            | Shape::Wrenches(_)
            | Shape::Matrices(..)
            | Shape::Poses(_) => {
                let wish = |i| result_name(derivation, function, (name, shape), i);
                components.extend((0..shape.count()).map(|i| Component::Result(start + i, wish(i))));
            }
        }
        start += shape.count();
    }
    components
}

/// M and A of the system for accelerations and multipliers: of M the lower triangle, which the runtime reads.
fn matrices(derivation: &Derivation, in_full: bool) -> Vec<Component> {
    let (n, k) = (derivation.dof(), derivation.constraints.len());
    let name = |i: usize, j: usize| if i < n { format!("m_{i}_{j}") } else { format!("a_{}_{j}", i - n) };
    let full = (0..n + k).flat_map(|i| (0..n).map(move |j| [i, j]));
    match &derivation.elimination {
        None => full
            .map(|[i, j]| match j <= i {
                true if i < n => Component::Result(triangular(i, j), name(i, j)),
                true => Component::Result(triangular(n, 0) + (i - n) * n + j, name(i, j)),
                false => Component::Zero,
            })
            .collect(),
        Some(elimination) => {
            let entries = elimination.entries.iter().enumerate();
            let entries = entries.map(|(number, &[i, j])| ([i, j], Component::Result(number, name(i, j))));
            if !in_full {
                return entries.map(|(_, entry)| entry).collect();
            }
            let mut known: BTreeMap<[usize; 2], Component> = entries.collect();
            full.map(|place| known.remove(&place).unwrap_or(Component::Zero)).collect()
        }
    }
}

/// The right sides of the system for accelerations and multipliers, for a result of this shape.
fn right_side_shape(derivation: &Derivation, shape: Shape) -> Shape {
    let size = derivation.dof() + derivation.constraints.len();
    match shape {
        Shape::Matrix(_, columns) => Shape::Matrix(size, columns),
        Shape::Scalar
        | Shape::Vector(_)
        | Shape::Symmetric(_)
        | Shape::Pose
        | Shape::Wrench
        | Shape::Wrenches(_)
        | Shape::Matrices(..)
        | Shape::Poses(_) => Shape::Vector(size),
    }
}

/// The number of an entry of a lower triangle.
fn triangular(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// What the parts of a result are called.
fn part_names(function: &Function) -> Vec<String> {
    let of = match function.kind {
        FunctionKind::Linearize | FunctionKind::ForwardDynamics => "qdd",
        FunctionKind::LinearizeParameters => "qdd_by_p",
        FunctionKind::InverseDynamicsJacobian => "tau",
        _ => function.name.as_str(),
    };
    let name = |part: &ResultPart| if part.name.is_empty() { of.to_string() } else { format!("{of}_by_{}", part.name) };
    function.results.iter().map(name).collect()
}

/// What a component of a part is called.
fn result_name(derivation: &Derivation, function: &Function, (name, shape): (&str, Shape), i: usize) -> String {
    let coordinate = || component_names(&derivation.coordinates)[i].clone();
    let axis = |i: usize| ["x", "y", "z"][i % 3];
    let pose = |i: usize| if i < 3 { axis(i).to_string() } else { format!("{}{}", axis(i / 3 - 1), axis(i)) };
    let wrench = |i: usize| format!("{}{}", if i < 3 { "f" } else { "n" }, axis(i));
    match (&function.kind, shape) {
        (FunctionKind::Momentum, _) => format!("p_{}", coordinate()),
        (FunctionKind::Gravity, _) => format!("g_{}", coordinate()),
        (FunctionKind::Bias, _) => format!("h_{}", coordinate()),
        (FunctionKind::InverseDynamics, _) => format!("tau_{}", coordinate()),
        (FunctionKind::ForwardDynamics, _) if function.completion == Completion::None => {
            format!("{}_ddot", coordinate())
        }
        (FunctionKind::CoriolisMatrix, Shape::Matrix(_, columns)) => format!("c_{}_{}", i / columns, i % columns),
        (_, Shape::Scalar) => name.to_string(),
        (_, Shape::Vector(_)) => format!("{name}_{i}"),
        (_, Shape::Matrix(_, columns) | Shape::Symmetric(columns)) => format!("{name}_{}_{}", i / columns, i % columns),
        (_, Shape::Matrices(_, rows, columns)) => {
            format!("{name}_{}_{}_{}", i / (rows * columns), i / columns % rows, i % columns)
        }
        (_, Shape::Pose) => format!("{name}_{}", pose(i)),
        (_, Shape::Poses(_)) => format!("{name}_{}_{}", i / 12, pose(i % 12)),
        (_, Shape::Wrench) => format!("{name}_{}", wrench(i)),
        (_, Shape::Wrenches(_)) => format!("{name}_{}_{}", i / 6, wrench(i % 6)),
    }
}
