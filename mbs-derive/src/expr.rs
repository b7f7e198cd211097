//! Expressions: a hash-consed graph and the calculus on it. No mechanics here.
//!
//! An [`Expr`] is a `Copy` handle into a [`Graph`]; operators on handles build nodes. Equal expressions are one node,
//! and operands come before what is made of them, so that a pass over the graph is a loop over node numbers. Nothing
//! recurses on the depth of an expression.
//!
//! - `number`: exact constants; `double_double`: numbers of 100 bits; `definition`: what constants are folded from;
//! - `graph`: the arena and [`Node`]; `arithmetic`, `power`, `condition`: the constructors with their local rules;
//! - `function`: sin, cos, … with derivative and value side by side;
//! - `sin_cos`: sine and cosine as generated code has them;
//! - `spline`: piecewise polynomials, which tables of samples are;
//! - `tangent`: directional derivatives by a forward sweep;
//! - `adjoint`: gradients by a reverse sweep;
//! - `hessian`: second derivatives by edge pushing;
//! - `substitute`: copies with symbols replaced or time derivatives carried out;
//! - `evaluate`: numerical values, over doubles or dual numbers;
//! - `dual`: dual numbers, the witness of the symbolic sweeps;
//! - `rounded`: numbers with a bound on their rounding errors;
//! - `factors`, `constrained`: symmetric systems and systems with constraints, solved as the runtime solves them;
//! - `sparse`: systems most entries of which are zero, eliminated in an order that is chosen once;
//! - `range`: between which values expressions stay;
//! - `field`: prime fields; `element`: what their numbers have in common; `ratio`: rational numbers;
//! - `residue`, `identity`: what holds for all values of the symbols, decided in a field;
//! - `image`, `degree`: what claims are proved with, and how likely they are to hold by chance;
//! - `branch`: the sides of conditions, and what leads to them;
//! - `vanishing`: sums that are zero, left out;
//! - `table`: tables over nodes, where a hash map would be slow;
//! - `vector`: vectors and matrices over expressions;
//! - `display`: infix printing.

pub(crate) mod adjoint;
mod arithmetic;
pub(crate) mod branch;
mod condition;
mod constrained;
mod definition;
mod degree;
pub(crate) mod display;
mod double_double;
pub(crate) mod dual;
mod element;
pub(crate) mod evaluate;
mod factors;
mod field;
pub(crate) mod function;
pub(crate) mod graph;
pub(crate) mod hessian;
pub(crate) mod identity;
mod image;
pub(crate) mod normal;
mod note;
pub(crate) mod number;
mod power;
mod range;
mod ratio;
pub(crate) mod residue;
pub(crate) mod rounded;
pub(crate) mod sin_cos;
pub(crate) mod sparse;
pub(crate) mod spline;
pub(crate) mod substitute;
pub(crate) mod table;
pub(crate) mod tangent;
#[cfg(test)]
mod tests;
mod vanishing;
pub(crate) mod vector;

pub(crate) use adjoint::{gradient, gradient_of_combination};
pub(crate) use condition::Condition;
pub(crate) use constrained::{AGREEMENT, Scales, largest, least_change, remainder, remainder_sizes};
pub(crate) use degree::Degree;
pub use dual::Dual;
pub(crate) use evaluate::{Solutions, evaluate};
pub use evaluate::{Tape, Terms, Value};
pub(crate) use field::FIELDS;
pub use function::{Binary, Function};
pub(crate) use graph::HalfInteger;
pub use graph::{Expr, Graph, Id, Node, Symbol};
pub(crate) use hessian::hessian;
pub(crate) use identity::{Fingerprints, Verdict, degree_is_at_most, generic, vanishes};
pub(crate) use image::Image;
pub(crate) use normal::{Kept, cheapest_form, normal_form, quotients};
pub use number::Number;
pub(crate) use residue::Residue;
pub use rounded::Rounded;
pub(crate) use sin_cos::Trigonometry;
pub(crate) use sparse::Elimination;
pub use spline::Spline;
pub(crate) use spline::SplineDerivative;
pub(crate) use substitute::{carry_out, cut, substitute, substitute_into};
pub(crate) use tangent::Tangent;
pub(crate) use vanishing::without_vanishing_sums;
pub(crate) use vector::{Matrix, Vector};
