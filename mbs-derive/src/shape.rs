//! What functions return.

use std::fmt;

/// A returned value and its shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultPart {
    /// Its name where a function returns several; empty where it returns one.
    pub name: &'static str,
    /// Its shape.
    pub shape: Shape,
}

/// The shape of a returned value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// One number.
    Scalar,
    /// This many numbers.
    Vector(usize),
    /// Rows and columns.
    Matrix(usize, usize),
    /// A square matrix of this size, of which the program gives the lower triangle.
    Symmetric(usize),
    /// A position, then the rows of a rotation.
    Pose,
    /// A force, then a moment.
    Wrench,
    /// This many of them.
    Wrenches(usize),
    /// This many matrices of these rows and columns.
    Matrices(usize, usize, usize),
    /// This many positions and rotations.
    Poses(usize),
}

impl Shape {
    /// How many values the program gives for it.
    pub fn count(self) -> usize {
        match self {
            Shape::Scalar => 1,
            Shape::Vector(n) => n,
            Shape::Matrix(rows, columns) => rows * columns,
            Shape::Symmetric(n) => n * (n + 1) / 2,
            Shape::Pose => 12,
            Shape::Wrench => 6,
            Shape::Wrenches(n) => 6 * n,
            Shape::Matrices(n, rows, columns) => n * rows * columns,
            Shape::Poses(n) => 12 * n,
        }
    }

    /// How many numbers a function returns in it: those of the program, and symmetric matrices in full.
    ///
    /// ```
    /// use mbs_derive::optimise::Shape;
    /// assert_eq!((Shape::Symmetric(2).count(), Shape::Symmetric(2).entries()), (3, 4));
    /// ```
    pub fn entries(self) -> usize {
        match self {
            Shape::Symmetric(n) => n * n,
            other => other.count(),
        }
    }

    /// The names of the components of a value with this name and shape, in the order of its values, symmetric matrices
    /// in full: `tip_0`, `inertia_0_1`, `hand_position_0`, `hand_rotation_0_0`.
    ///
    /// ```
    /// use mbs_derive::optimise::Shape;
    /// assert_eq!(Shape::Vector(2).components("tip"), ["tip_0", "tip_1"]);
    /// ```
    pub fn components(self, name: &str) -> Vec<String> {
        let of_each = |count: usize, shape: Shape| -> Vec<String> {
            (0..count).flat_map(|i| shape.components(&format!("{name}_{i}"))).collect()
        };
        let parts = |parts: [(&str, Shape); 2]| -> Vec<String> {
            parts.into_iter().flat_map(|(part, shape)| shape.components(&format!("{name}_{part}"))).collect()
        };
        match self {
            Shape::Scalar => vec![name.to_string()],
            Shape::Vector(n) => of_each(n, Shape::Scalar),
            Shape::Matrix(rows, columns) => of_each(rows, Shape::Vector(columns)),
            Shape::Symmetric(n) => of_each(n, Shape::Vector(n)),
            Shape::Matrices(n, rows, columns) => of_each(n, Shape::Matrix(rows, columns)),
            Shape::Pose => parts([("position", Shape::Vector(3)), ("rotation", Shape::Matrix(3, 3))]),
            Shape::Poses(n) => of_each(n, Shape::Pose),
            Shape::Wrench => parts([("force", Shape::Vector(3)), ("moment", Shape::Vector(3))]),
            Shape::Wrenches(n) => of_each(n, Shape::Wrench),
        }
    }
}

/// Whether results of these shapes take more than 64 kB as doubles. In Rust the caller gives the storage of such a
/// result; what is solved on the way still stands on the stack.
pub(crate) fn is_large(shapes: impl IntoIterator<Item = Shape>) -> bool {
    shapes.into_iter().map(Shape::entries).sum::<usize>() * size_of::<f64>() > 64 * 1024
}

/// As documentation says it.
impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Shape::Scalar => write!(f, "one number"),
            Shape::Vector(1) => write!(f, "1 component"),
            Shape::Vector(n) => write!(f, "{n} components"),
            Shape::Matrix(rows, columns) => write!(f, "{rows} × {columns}"),
            Shape::Symmetric(n) => write!(f, "{n} × {n}"),
            Shape::Pose => write!(f, "a pose"),
            Shape::Wrench => write!(f, "a force and a moment"),
            Shape::Wrenches(n) => write!(f, "{n} forces and moments"),
            Shape::Matrices(n, rows, columns) => write!(f, "{n} matrices {rows} × {columns}"),
            Shape::Poses(n) => write!(f, "{n} poses"),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for ResultPart {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.name, self.shape).serialize(serializer)
    }
}

/// A name is one of those that functions give their parts.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for ResultPart {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const NAMES: [&str; 4] = ["", "q", "qd", "u"];
        let (name, shape) = <(String, Shape)>::deserialize(deserializer)?;
        match NAMES.into_iter().find(|known| *known == name) {
            Some(name) => Ok(ResultPart { name, shape }),
            None => Err(serde::de::Error::custom(format_args!("no function returns a part `{name}`"))),
        }
    }
}
