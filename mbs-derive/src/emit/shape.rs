//! Results and their shapes: types, the components that a program computes, and values put in shape.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

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

/// `T` or `[T; 6]`
pub(super) fn array(of: TokenStream, length: Option<usize>) -> TokenStream {
    match length {
        None => of,
        Some(n) => {
            let n = Literal::usize_unsuffixed(n);
            quote!([#of; #n])
        }
    }
}

pub(super) fn shape_type(shape: Shape) -> TokenStream {
    match shape {
        Shape::Scalar => quote!(T),
        Shape::Vector(n) => array(quote!(T), Some(n)),
        Shape::Matrix(rows, columns) => array(array(quote!(T), Some(columns)), Some(rows)),
        Shape::Symmetric(n) => array(array(quote!(T), Some(n)), Some(n)),
        Shape::Pose => quote!(::mbs_runtime::Pose<T>),
        Shape::Wrench => quote!(::mbs_runtime::Wrench<T>),
        Shape::Wrenches(n) => array(shape_type(Shape::Wrench), Some(n)),
        Shape::Matrices(n, rows, columns) => array(shape_type(Shape::Matrix(rows, columns)), Some(n)),
        Shape::Poses(n) => array(shape_type(Shape::Pose), Some(n)),
    }
}

/// The next values in this shape.
pub(super) fn shaped(shape: Shape, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
    match shape {
        Shape::Scalar => values.next().expect("a value for each component"),
        Shape::Vector(n) => {
            let entries = values.take(n);
            quote!([#(#entries),*])
        }
        Shape::Matrix(rows, columns) => {
            let rows: Vec<_> = (0..rows).map(|_| shaped(Shape::Vector(columns), values)).collect();
            quote!([#(#rows),*])
        }
        Shape::Symmetric(n) => shaped(Shape::Matrix(n, n), values),
        Shape::Pose => {
            let (position, rotation) = (shaped(Shape::Vector(3), values), shaped(Shape::Matrix(3, 3), values));
            quote!(::mbs_runtime::Pose { position: #position, rotation: #rotation })
        }
        Shape::Wrench => {
            let (force, moment) = (shaped(Shape::Vector(3), values), shaped(Shape::Vector(3), values));
            quote!(::mbs_runtime::Wrench { force: #force, moment: #moment })
        }
        Shape::Wrenches(n) => several(n, Shape::Wrench, values),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns), values),
        Shape::Poses(n) => several(n, Shape::Pose, values),
    }
}

/// An array of `n` results in this shape.
fn several(n: usize, shape: Shape, values: &mut dyn Iterator<Item = TokenStream>) -> TokenStream {
    let elements: Vec<_> = (0..n).map(|_| shaped(shape, values)).collect();
    quote!([#(#elements),*])
}
