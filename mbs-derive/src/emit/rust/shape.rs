//! Results and their shapes: types, and values put in shape.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::shape::Shape;

/// `[T; 6]`
pub(super) fn array(of: TokenStream, length: usize) -> TokenStream {
    let length = Literal::usize_unsuffixed(length);
    quote!([#of; #length])
}

pub(super) fn shape_type(shape: Shape) -> TokenStream {
    match shape {
        Shape::Scalar => quote!(T),
        Shape::Vector(n) => array(quote!(T), n),
        Shape::Matrix(rows, columns) => array(array(quote!(T), columns), rows),
        Shape::Symmetric(n) => array(array(quote!(T), n), n),
        Shape::Pose => quote!(::mbs_runtime::Pose<T>),
        Shape::Wrench => quote!(::mbs_runtime::Wrench<T>),
        Shape::Wrenches(n) => array(shape_type(Shape::Wrench), n),
        Shape::Matrices(n, rows, columns) => array(shape_type(Shape::Matrix(rows, columns)), n),
        Shape::Poses(n) => array(shape_type(Shape::Pose), n),
    }
}

/// A matrix or vector of zeros.
pub(super) fn zeros(shape: Shape) -> TokenStream {
    let zero = quote!(T::zero());
    match shape {
        Shape::Vector(n) => array(zero, n),
        Shape::Matrix(rows, columns) => array(array(zero, columns), rows),
        Shape::Symmetric(n) => array(array(zero, n), n),
        other => unreachable!("no function of a trait returns {other}"),
    }
}

/// The assignments that write values in this shape to a place, row by row.
pub(super) fn written(place: &str, shape: Shape, values: &[String]) -> String {
    let (rows, row) = match shape {
        Shape::Matrix(rows, columns) => (rows, Shape::Vector(columns)),
        Shape::Symmetric(n) => (n, Shape::Vector(n)),
        Shape::Matrices(n, rows, columns) => (n, Shape::Matrix(rows, columns)),
        Shape::Poses(n) => (n, Shape::Pose),
        Shape::Wrenches(n) => (n, Shape::Wrench),
        Shape::Vector(n) => (n, Shape::Scalar),
        Shape::Scalar | Shape::Pose | Shape::Wrench => unreachable!("{shape} takes little storage"),
    };
    let mut values = values.iter();
    (0..rows).map(|i| format!("{place}[{i}] = {};\n", shaped(row, &mut values))).collect()
}

/// The next values in this shape.
pub(super) fn shaped(shape: Shape, values: &mut dyn Iterator<Item = &String>) -> String {
    let mut several =
        |count: usize, shape: Shape| array_of(&(0..count).map(|_| shaped(shape, values)).collect::<Vec<_>>());
    match shape {
        Shape::Scalar => values.next().expect("a value for each component").clone(),
        Shape::Vector(n) => several(n, Shape::Scalar),
        Shape::Matrix(rows, columns) => several(rows, Shape::Vector(columns)),
        Shape::Symmetric(n) => several(n, Shape::Vector(n)),
        Shape::Pose => {
            let (position, rotation) = (several(3, Shape::Scalar), several(3, Shape::Vector(3)));
            format!("::mbs_runtime::Pose {{ position: {position}, rotation: {rotation} }}")
        }
        Shape::Wrench => {
            let (force, moment) = (several(3, Shape::Scalar), several(3, Shape::Scalar));
            format!("::mbs_runtime::Wrench {{ force: {force}, moment: {moment} }}")
        }
        Shape::Wrenches(n) => several(n, Shape::Wrench),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns)),
        Shape::Poses(n) => several(n, Shape::Pose),
    }
}

/// `[a, b]`
pub(super) fn array_of(values: &[String]) -> String {
    format!("[{}]", values.join(", "))
}
