//! What expressions of the language stand for. In reading order:
//!
//! - [`dimension`]: SI dimensions and units; [`constant`]: what is known of an expression;
//! - [`evaluate`]: expressions → values; [`usage`]: what values are used as; [`quantity`]: numbers with units;
//!   [`operator`]: `+ - * / ^` and `dt`; [`root`]: roots of squares;
//! - [`condition`]: `if … else`; [`difference`]: differences of places, in their nearest common frame;
//! - [`builtin`]: functions and methods; [`attitude`]: axes of parameters, arrays for several arguments;
//!   [`interpolation`]: tables.

pub(in crate::model) mod attitude;
pub(in crate::model) mod builtin;
pub(in crate::model) mod condition;
pub(in crate::model) mod constant;
pub(in crate::model) mod difference;
pub(super) mod dimension;
pub(in crate::model) mod evaluate;
pub(in crate::model) mod interpolation;
pub(in crate::model) mod operator;
pub(in crate::model) mod quantity;
pub(in crate::model) mod root;
pub(in crate::model) mod usage;

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::expr::{Expr, Matrix, Vector};
use crate::model::check::singular::Sites;
use crate::model::frame::{Edge, FrameId};
use crate::model::value::dimension::Dimension;
use constant::Facts;
use difference::Differences;

/// What is known of expressions, beside what they are.
pub(in crate::model) struct Known<'g> {
    pub(in crate::model) facts: Facts,
    /// Which expressions are sums of places.
    pub(in crate::model) differences: Differences<'g>,
    /// Where derivatives may fail.
    pub(in crate::model) sites: Sites<'g>,
}

/// The value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) enum Value<'g> {
    /// One number.
    Scalar(Scalar<'g>),
    /// A free vector.
    Vector(Free<'g>),
    /// A place that knows its frame, in which it is fixed.
    Point(Point<'g>),
    /// Three by three numbers, or a tensor that knows its axes.
    Matrix(Box<Tensor<'g>>),
    /// Position and attitude in the world.
    Pose(Pose<'g>),
    /// A part that has been built, with the values that it gives.
    Part(Rc<Instance<'g>>),
    /// Several values; three numbers are a vector in world axes wherever one is wanted, three rows of three a matrix.
    Array(Array<'g>),
}

/// A part that has been built.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct Instance<'g> {
    /// The name of the part.
    pub(in crate::model) part: String,
    /// What it declares; nothing where a declaration was wrong.
    pub(in crate::model) values: BTreeMap<String, Option<Value<'g>>>,
    /// Whether none of its statements was refused.
    pub(in crate::model) is_whole: bool,
}

/// One number with its dimension. The literal 0 fits every dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) struct Scalar<'g> {
    pub(in crate::model) expr: Expr<'g>,
    pub(in crate::model) dimension: Dimension,
}

/// A vector's components in the axes of `frame`; those of the world for a plain `[x, y, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) struct Free<'g> {
    pub(in crate::model) components: Vector<'g>,
    pub(in crate::model) frame: FrameId,
    pub(in crate::model) dimension: Dimension,
}

/// A place: its coordinates in `frame`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) struct Point<'g> {
    pub(in crate::model) coordinates: Vector<'g>,
    pub(in crate::model) frame: FrameId,
}

/// A matrix with the dimension that its entries share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) struct Tensor<'g> {
    pub(in crate::model) entries: Matrix<'g>,
    /// The axes that rows and columns are in; plain numbers `[[…], […], […]]` do not say.
    pub(in crate::model) axes: Option<(FrameId, FrameId)>,
    pub(in crate::model) dimension: Dimension,
}

/// A frame, and what moves from there on: frames are made only of poses that something stands on.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct Pose<'g> {
    pub(in crate::model) base: FrameId,
    pub(in crate::model) edges: Vec<Edge<'g>>,
}

/// Values in a row.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct Array<'g> {
    values: Rc<Vec<Value<'g>>>,
    /// How many values that are no arrays there are in it, all levels together.
    leaves: usize,
    /// Levels of arrays.
    depth: usize,
}

/// What a value can be used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) enum Shape {
    Number,
    Vector,
    Matrix,
    Pose,
    Part,
    Array,
}

impl<'g> Value<'g> {
    pub(in crate::model) fn matrix(matrix: Tensor<'g>) -> Self {
        Value::Matrix(Box::new(matrix))
    }

    pub(in crate::model) fn shape(&self) -> Shape {
        match self {
            Value::Scalar(_) => Shape::Number,
            Value::Vector(_) | Value::Point(_) => Shape::Vector,
            Value::Matrix(_) => Shape::Matrix,
            Value::Pose(_) => Shape::Pose,
            Value::Part(_) => Shape::Part,
            Value::Array(array) if array.values.len() != 3 => Shape::Array,
            Value::Array(array) if array.values.iter().all(|v| v.shape() == Shape::Number) => Shape::Vector,
            Value::Array(array) if array.values.iter().all(|v| v.shape() == Shape::Vector) => Shape::Matrix,
            Value::Array(_) => Shape::Array,
        }
    }

    /// With an article, for messages.
    pub(in crate::model) fn described(&self) -> String {
        match self {
            Value::Scalar(_) => "a number".to_string(),
            Value::Vector(_) => "a vector".to_string(),
            Value::Point(_) => "a point".to_string(),
            Value::Matrix(_) => "a matrix".to_string(),
            Value::Pose(_) => "a pose".to_string(),
            Value::Part(_) => "a part".to_string(),
            Value::Array(array) => match self.shape() {
                Shape::Vector => "a vector".to_string(),
                Shape::Matrix => "a matrix".to_string(),
                _ => format!("an array of {}", array.values.len()),
            },
        }
    }
}

impl Shape {
    /// With an article, for messages.
    pub(in crate::model) fn described(self) -> &'static str {
        match self {
            Shape::Number => "a number",
            Shape::Vector => "a vector",
            Shape::Matrix => "a matrix",
            Shape::Pose => "a pose",
            Shape::Part => "a part",
            Shape::Array => "an array",
        }
    }
}

impl<'g> Array<'g> {
    /// More numbers than any mechanism has.
    pub(in crate::model) const MAX_LEAVES: usize = 100_000;
    /// More indices than any mechanism needs.
    pub(in crate::model) const MAX_DEPTH: usize = 6;

    /// `None` where that is more than any mechanism needs: loops could make arrays without end.
    pub(in crate::model) fn new(values: Vec<Value<'g>>) -> Option<Self> {
        let (mut leaves, mut depth) = (0usize, 0);
        for value in &values {
            match value {
                Value::Array(inner) => {
                    leaves = leaves.saturating_add(inner.leaves);
                    depth = depth.max(inner.depth);
                }
                _ => leaves += 1,
            }
        }
        Array { values: values.into(), leaves, depth: depth + 1 }.unless_too_large()
    }

    /// With one more value, which is no array, behind the others; they are copied only where the array is held
    /// elsewhere, too.
    pub(in crate::model) fn with(mut self, value: Value<'g>) -> Option<Self> {
        Rc::make_mut(&mut self.values).push(value);
        self.leaves += 1;
        self.unless_too_large()
    }

    fn unless_too_large(self) -> Option<Self> {
        (self.leaves <= Self::MAX_LEAVES && self.depth <= Self::MAX_DEPTH).then_some(self)
    }

    pub(in crate::model) fn values(&self) -> &[Value<'g>] {
        &self.values
    }
}

impl<'g> Scalar<'g> {
    pub(in crate::model) fn new(expr: Expr<'g>, dimension: Dimension) -> Self {
        Scalar { expr, dimension }
    }

    /// A plain number.
    pub(in crate::model) fn plain(expr: Expr<'g>) -> Self {
        Scalar { expr, dimension: Dimension::ONE }
    }
}

/// Which dimension two values share; a zero fits every dimension.
pub(in crate::model) fn shared(a: (Dimension, bool), b: (Dimension, bool)) -> Option<Dimension> {
    match (a, b) {
        ((a, _), (_, true)) => Some(a),
        ((_, true), (b, _)) => Some(b),
        ((a, _), (b, _)) => (a == b).then_some(a),
    }
}

impl Scalar<'_> {
    /// For [`shared`].
    pub(in crate::model) fn fit(&self) -> (Dimension, bool) {
        (self.dimension, self.expr.is_zero())
    }
}

impl Free<'_> {
    /// For [`shared`].
    pub(in crate::model) fn fit(&self) -> (Dimension, bool) {
        (self.dimension, self.components.0.iter().all(|c| c.is_zero()))
    }
}

impl<'g> Tensor<'g> {
    /// Entries that do not say in which axes they are.
    pub(in crate::model) fn plain(entries: Matrix<'g>, dimension: Dimension) -> Self {
        Tensor { entries, axes: None, dimension }
    }

    /// For [`shared`].
    pub(in crate::model) fn fit(&self) -> (Dimension, bool) {
        (self.dimension, self.entries.0.iter().flatten().all(|c| c.is_zero()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    #[test]
    fn arrays_of_three_are_vectors_and_of_three_rows_matrices() {
        let graph = Graph::verbatim();
        let number = || Value::Scalar(Scalar::plain(graph.integer(1)));
        let array = |values| Value::Array(Array::new(values).unwrap());
        let row = || array(vec![number(), number(), number()]);
        assert_eq!(row().described(), "a vector");
        assert_eq!(array(vec![row(), row(), row()]).described(), "a matrix");
        assert_eq!(array(vec![number(), row(), row()]).described(), "an array of 3");
        assert_eq!(array(vec![number(), number()]).described(), "an array of 2");
    }

    #[test]
    fn arrays_do_not_grow_without_end() {
        let graph = Graph::verbatim();
        let mut value = Value::Scalar(Scalar::plain(graph.integer(1)));
        let mut levels = 0;
        while let Some(array) = Array::new(vec![value.clone()]) {
            value = Value::Array(array);
            levels += 1;
        }
        assert_eq!(levels, Array::MAX_DEPTH);
        assert!(Array::new(vec![value; Array::MAX_LEAVES + 1]).is_none());
    }

    #[test]
    fn zero_fits_every_dimension() {
        let (m, kg) = (Dimension::LENGTH, Dimension::MASS);
        assert_eq!(shared((m, false), (m, false)), Some(m));
        assert_eq!(shared((m, false), (kg, true)), Some(m));
        assert_eq!(shared((Dimension::ONE, true), (kg, false)), Some(kg));
        assert_eq!(shared((m, false), (kg, false)), None);
    }
}
