//! Outputs: values, velocities, Jacobians and their rates.

use crate::expr::{Expr, Graph, Symbol, Tangent, carry_out, gradient};
use crate::model::{Lagrangian, OutputValue};
use crate::shape::Shape;

use super::{OutputEquations, Rows, Symbols, time_derivative};

/// Carries out all outputs.
pub(crate) fn outputs<'g>(
    lagrangian: &Lagrangian<'_>,
    graph: &'g Graph,
    symbols: &Symbols,
) -> Vec<OutputEquations<'g>> {
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

/// The values of all outputs with their shapes.
pub(crate) fn values<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Vec<(Shape, Vec<Expr<'g>>)> {
    let value = |value: &OutputValue<'_>| {
        let components = value.components(&lagrangian.frames);
        (shape(value), carry_out(&components, graph, |symbol| time_derivative(symbol, graph)))
    };
    lagrangian.outputs.iter().map(|output| value(&output.value)).collect()
}

fn shape(value: &OutputValue<'_>) -> Shape {
    let columns = |rows: &[Vec<Expr<'_>>]| rows.first().map_or(0, Vec::len);
    match value {
        OutputValue::Scalar(_) => Shape::Scalar,
        OutputValue::Array(entries) => Shape::Vector(entries.len()),
        OutputValue::Matrix(rows) => Shape::Matrix(rows.len(), columns(rows)),
        OutputValue::Pose(_) => Shape::Pose,
        OutputValue::Matrices(matrices) => {
            let first = matrices.first().map_or(&[][..], Vec::as_slice);
            Shape::Matrices(matrices.len(), first.len(), columns(first))
        }
        OutputValue::Poses(frames) => Shape::Poses(frames.len()),
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
