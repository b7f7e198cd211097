//! The components of results, as programs compute them.

use crate::optimise::{Completion, Derivation, Function, FunctionKind};
use crate::shape::{ResultPart, Shape};
use crate::variable::component_names;

use super::body::Component;

/// Which of a program's results make up what a function returns, or hands to the runtime.
pub(super) fn components(derivation: &Derivation, function: &Function) -> Vec<Component> {
    let n = derivation.dof();
    let square = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let mut components = Vec::new();
    let mut start = 0;
    let mut shapes: Vec<Shape> = function.results.iter().map(|part| part.shape).collect();
    if function.completion.solves() {
        let right_sides = shapes.into_iter().map(|shape| right_side_shape(derivation, shape));
        shapes = [Shape::Matrix(derivation.constraints.len(), n)].into_iter().chain(right_sides).collect();
        // The runtime reads the lower triangle of M.
        components.extend(square().map(|(i, j)| match j <= i {
            true => Component::Result(triangular(i, j), format!("m_{i}_{j}")),
            false => Component::Zero,
        }));
        start = triangular(n, 0);
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

/// What the parts of a result are called; before the right sides of a system come the rows of A.
fn part_names(function: &Function) -> Vec<String> {
    let of = match function.kind {
        FunctionKind::Linearize | FunctionKind::ForwardDynamics => "qdd",
        FunctionKind::LinearizeParameters => "qdd_by_p",
        FunctionKind::InverseDynamicsJacobian => "tau",
        _ => function.name.as_str(),
    };
    let name = |part: &ResultPart| if part.name.is_empty() { of.to_string() } else { format!("{of}_by_{}", part.name) };
    let rows = function.completion.solves().then(|| "a".to_string());
    rows.into_iter().chain(function.results.iter().map(name)).collect()
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
