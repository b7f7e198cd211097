//! What is not taken apart: its place in a product, and what its powers look like.

use crate::expr::Function;

use super::layout::{applied, bracketed};
use super::notation::script;

/// Where a factor stands in a product: the kind of thing it is, its number or its first coordinate, then its text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    pub(super) kind: Kind,
    pub(super) number: u32,
    pub(super) text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Parameter,
    ParametricFunction,
    Coordinate,
    Velocity,
    Acceleration,
    Input,
    Time,
    Function,
    /// Last, because it takes everything that follows for its argument; so do logarithms and what else has no brackets.
    Trigonometric,
}

/// A factor that is not taken apart.
#[derive(Clone, Debug)]
pub(super) struct Atom {
    pub(super) place: Place,
    /// Whether it depends on parameters alone.
    pub(super) parametric: bool,
    /// The first coordinate that it depends on.
    pub(super) first_coordinate: u32,
    pub(super) shape: Shape,
}

impl Atom {
    /// Whether it is written among coefficients: parameters, and time and what is given from outside.
    pub(super) fn is_given(&self) -> bool {
        self.parametric || matches!(self.place.kind, Kind::Input | Kind::Time)
    }
}

/// What its powers look like.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// `x`, `x^2`
    Symbol(String),
    /// `\sin x`, `\sin^2 x`
    Named(&'static str, String),
    /// `f(x)`, `\left(f(x)\right)^2`
    Closed(String),
    /// `a + b`, `(a + b)^2`
    Sum(String),
}

impl Shape {
    /// Its power, for `halves > 0`.
    pub(super) fn power(&self, halves: i32) -> String {
        let exponent = match halves {
            1 => return format!("\\sqrt{{{}}}", self.inside()),
            2 => None,
            n if n % 2 == 0 => Some(script('^', &(n / 2).to_string())),
            n => Some(script('^', &format!("{n}/2"))),
        };
        match (self, exponent) {
            (Shape::Sum(text), None) => bracketed(text),
            (_, None) => self.inside(),
            (Shape::Symbol(text), Some(exponent)) => format!("{text}{exponent}"),
            (Shape::Named(name, argument), Some(exponent)) if halves % 2 == 0 => {
                applied(&format!("{name}{exponent}"), argument)
            }
            (Shape::Named(..) | Shape::Closed(_) | Shape::Sum(_), Some(exponent)) => {
                format!("{}{exponent}", bracketed(&self.inside()))
            }
        }
    }

    /// Whether it takes everything that follows for its argument.
    pub(super) fn is_open(&self) -> bool {
        const OPEN: [&str; 5] = ["\\arcsin", "\\arccos", "\\arctan", "\\ln", "\\operatorname{sgn}"];
        match self {
            Shape::Named(..) => true,
            Shape::Closed(text) => OPEN.iter().any(|name| text.starts_with(name)),
            Shape::Symbol(_) | Shape::Sum(_) => false,
        }
    }

    /// Without brackets.
    pub(super) fn inside(&self) -> String {
        match self {
            Shape::Symbol(text) | Shape::Closed(text) | Shape::Sum(text) => text.clone(),
            Shape::Named(name, argument) => applied(name, argument),
        }
    }
}

/// 1 for even functions, −1 for odd ones, 0 for others.
pub(super) fn parity(function: Function) -> i32 {
    match function {
        Function::Cos | Function::Cosh | Function::Sech | Function::Abs => 1,
        Function::Sin | Function::Tan | Function::Asin | Function::Atan => -1,
        Function::Sinh | Function::Tanh | Function::Signum => -1,
        Function::Acos | Function::Exp | Function::Ln => 0,
    }
}

/// `argument` has brackets where it needs them, `bare` has none.
pub(super) fn shape(function: Function, argument: String, bare: &str) -> Shape {
    let closed = |name: &str| Shape::Closed(applied(name, &argument));
    match function {
        Function::Sin => Shape::Named("\\sin", argument),
        Function::Cos => Shape::Named("\\cos", argument),
        Function::Tan => Shape::Named("\\tan", argument),
        Function::Sinh => Shape::Named("\\sinh", argument),
        Function::Cosh => Shape::Named("\\cosh", argument),
        Function::Tanh => Shape::Named("\\tanh", argument),
        Function::Sech => Shape::Named("\\operatorname{sech}", argument),
        Function::Asin => closed("\\arcsin"),
        Function::Acos => closed("\\arccos"),
        Function::Atan => closed("\\arctan"),
        Function::Ln => closed("\\ln"),
        Function::Signum => closed("\\operatorname{sgn}"),
        Function::Exp => Shape::Closed(format!("e^{{{bare}}}")),
        // Its bars are all the brackets it needs.
        Function::Abs => Shape::Symbol(format!("\\left|{bare}\\right|")),
    }
}
