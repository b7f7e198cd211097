//! Outputs: values, velocities, Jacobians and their rates.

use crate::expr::{Expr, Graph, Symbol, Tangent, carry_out, gradient};
use crate::model::{Lagrangian, OutputValue};

use super::{Rows, Symbols, time_derivative};

/// An output's equations.
#[derive(Clone, Debug)]
pub struct OutputEquations<'g> {
    /// As declared.
    pub name: String,
    /// Its shape.
    pub shape: OutputShape,
    /// Its components, row by row; for each pose the position and then the rows of the rotation.
    pub value: Vec<Expr<'g>>,
    /// Its time derivative; for each pose the velocity of its origin and the angular velocity, in world axes.
    /// Absent where the value depends on velocities or inputs.
    pub velocity: Option<Vec<Expr<'g>>>,
    /// `∂velocity/∂q̇`, one row per component; of a value that depends on velocities `∂value/∂q`.
    pub jacobian: Rows<'g>,
    /// `∂value/∂q̇`, where the value depends on velocities.
    pub jacobian_qd: Option<Rows<'g>>,
    /// `∂value/∂u`, where the value depends on inputs.
    pub jacobian_u: Option<Rows<'g>>,
    /// The total time derivative of the Jacobian, `J̇ = Σ ∂J/∂q_k q̇_k + ∂J/∂t`, where it was asked for. With the
    /// velocity `J q̇ + b`, `b = ∂value/∂t`, the acceleration is `J q̈ + J̇ q̇ + ḃ`.
    pub jacobian_rate: Option<Rows<'g>>,
}

/// The shape of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputShape {
    /// One number.
    Scalar,
    /// This many numbers.
    Array(usize),
    /// Rows and columns.
    Matrix(usize, usize),
    /// Position and rotation.
    Pose,
    /// This many matrices of these rows and columns.
    Matrices(usize, usize, usize),
    /// This many positions and rotations.
    Poses(usize),
}

/// Carries out all outputs.
pub fn outputs<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph, symbols: &Symbols) -> Vec<OutputEquations<'g>> {
    lagrangian
        .outputs
        .iter()
        .map(|output| {
            let (shape, value) = (shape(&output.value), output.value.components(&lagrangian.frames));
            let value = carry_out(&value, graph, |symbol| time_derivative(symbol, graph));
            let velocity = match output.value.frames() {
                [] => positional(&value).then(|| rates(&value)),
                frames => Some(frames.iter().flat_map(|frame| twist(lagrangian, *frame, graph)).collect()),
            };
            let jacobian = match &velocity {
                Some(velocity) => velocity.iter().map(|&v| gradient(v, &symbols.qd)).collect(),
                None => value.iter().map(|&v| gradient(v, &symbols.q)).collect(),
            };
            let jacobian_rate = output.jacobian_rate.then(|| rates_of_rows(&jacobian, graph));
            let by = |symbols: &[Symbol], is_meant: fn(Symbol) -> bool| {
                let rows = || value.iter().map(|&v| gradient(v, symbols)).collect();
                (velocity.is_none() && depends(&value, is_meant)).then(rows)
            };
            OutputEquations {
                name: output.name.clone(),
                shape,
                jacobian_qd: by(&symbols.qd, |symbol| matches!(symbol, Symbol::Velocity(_))),
                jacobian_u: by(&symbols.u, |symbol| matches!(symbol, Symbol::Input(_))),
                value,
                velocity,
                jacobian,
                jacobian_rate,
            }
        })
        .collect()
}

fn shape(value: &OutputValue<'_>) -> OutputShape {
    let columns = |rows: &[Vec<Expr<'_>>]| rows.first().map_or(0, Vec::len);
    match value {
        OutputValue::Scalar(_) => OutputShape::Scalar,
        OutputValue::Array(entries) => OutputShape::Array(entries.len()),
        OutputValue::Matrix(rows) => OutputShape::Matrix(rows.len(), columns(rows)),
        OutputValue::Pose(_) => OutputShape::Pose,
        OutputValue::Matrices(matrices) => {
            let first = matrices.first().map_or(&[][..], Vec::as_slice);
            OutputShape::Matrices(matrices.len(), first.len(), columns(first))
        }
        OutputValue::Poses(frames) => OutputShape::Poses(frames.len()),
    }
}

/// Velocity of the origin and angular velocity, turned into world axes.
fn twist<'g>(lagrangian: &Lagrangian<'_>, id: crate::model::FrameId, graph: &'g Graph) -> Vec<Expr<'g>> {
    let frame = lagrangian.frames.get(id);
    let (v, w) = (frame.rotation * frame.velocity, frame.rotation * frame.angular_velocity);
    let components: Vec<_> = v.0.into_iter().chain(w.0).collect();
    carry_out(&components, graph, |symbol| time_derivative(symbol, graph))
}

fn positional(value: &[Expr<'_>]) -> bool {
    let stays =
        |symbol| matches!(symbol, Symbol::Coordinate(_) | Symbol::Time | Symbol::Parameter(_) | Symbol::Prescribed(..));
    !depends(value, |symbol| !stays(symbol))
}

/// Whether a symbol of some kind is in the expressions.
fn depends(value: &[Expr<'_>], is_meant: impl Fn(Symbol) -> bool) -> bool {
    let Some(first) = value.first() else { return false };
    let graph = first.graph();
    graph.reachable(value.iter().map(|e| e.id())).into_iter().any(|id| match graph.node(id) {
        crate::expr::Node::Symbol(symbol) => is_meant(symbol),
        _ => false,
    })
}

fn rates<'g>(value: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let Some(first) = value.first() else { return Vec::new() };
    let graph = first.graph();
    Tangent::new(|symbol| time_derivative(symbol, graph)).of_all(value)
}

/// One forward sweep along the motion for all entries.
fn rates_of_rows<'g>(rows: &Rows<'g>, graph: &'g Graph) -> Rows<'g> {
    let mut rate = Tangent::new(|symbol| time_derivative(symbol, graph));
    rows.iter().map(|row| rate.of_all(row)).collect()
}
