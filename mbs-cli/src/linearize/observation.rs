//! What outputs say of a change of the state: `δy = ∂y/∂q δq + ∂y/∂q̇ δq̇ + ∂y/∂u δu`.

use mbs_derive::expr::Symbol;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, FunctionKind, Shape};
use nalgebra::DMatrix;

use crate::simulate::record::of_output;
use crate::state::Point;

use super::along::Along;

/// By q, q̇ and u, a row for each component.
type Slopes = [DMatrix<f64>; 3];

/// Names and units of the components of all outputs, as the table of a motion has them.
pub(super) fn components(derivation: &Derivation) -> Vec<[String; 2]> {
    let columns = outputs(derivation).zip(&derivation.output_units);
    let columns = columns.flat_map(|((_, function), unit)| of_output(function, unit));
    columns.map(|column| [column.name, column.unit]).collect()
}

/// The derivatives of all outputs: by the generated Jacobians, and those of poses, for which these give twists, by dual
/// numbers.
pub(super) fn slopes(derivation: &Derivation, point: &Point) -> Slopes {
    let interpreter = Interpreter::with_parameters(derivation, point.parameters.clone());
    let mut rows: [Vec<f64>; 3] = Default::default();
    for (number, function) in outputs(derivation) {
        let is_pose = matches!(function.results[0].shape, Shape::Pose | Shape::Poses(_));
        let own = if is_pose { None } else { generated(&interpreter, &point.state, number) };
        let own = own.unwrap_or_else(|| by_duals(derivation, function, point));
        rows.iter_mut().zip(own).for_each(|(rows, own)| rows.extend(own));
    }
    let count = components(derivation).len();
    let mut rows = rows.into_iter().zip(widths(point));
    std::array::from_fn(|_| {
        let (rows, width) = rows.next().expect("three of them");
        DMatrix::from_row_slice(count, width, &rows)
    })
}

fn outputs(derivation: &Derivation) -> impl Iterator<Item = (usize, &Function)> {
    derivation.functions.iter().filter_map(|function| match function.kind {
        FunctionKind::Output(number) => Some((number, function)),
        _ => None,
    })
}

fn widths(point: &Point) -> [usize; 3] {
    [point.state.q.len(), point.state.qd.len(), point.state.u.len()]
}

/// The rows of an output's Jacobians, zero where it does not depend on the argument; `None` where they were not
/// generated.
fn generated(interpreter: &Interpreter<'_>, state: &State, number: usize) -> Option<[Vec<f64>; 3]> {
    let of = |kind: FunctionKind| interpreter.call(kind, state);
    let by_q = of(FunctionKind::OutputJacobian(number))?;
    let height = by_q.len() / state.q.len().max(1);
    let zero = |width: usize| vec![0.0; height * width];
    let by_qd = of(FunctionKind::OutputJacobianQd(number)).unwrap_or_else(|| zero(state.qd.len()));
    let by_u = of(FunctionKind::OutputJacobianU(number)).unwrap_or_else(|| zero(state.u.len()));
    Some([by_q, by_qd, by_u])
}

/// The derivatives by dual numbers, for every component.
fn by_duals(derivation: &Derivation, function: &Function, point: &Point) -> [Vec<f64>; 3] {
    let along = Along::new(derivation, point);
    let rows = |width: usize, variable: fn(u32) -> Symbol| {
        let column = |j: usize| along.slope(function, |symbol| f64::from(u8::from(symbol == variable(j as u32))));
        let columns: Vec<Vec<f64>> = (0..width).map(column).collect();
        let height = columns.first().map_or(0, Vec::len);
        (0..height).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
    };
    let [by_q, by_qd, by_u] = widths(point);
    [rows(by_q, Symbol::Coordinate), rows(by_qd, Symbol::Velocity), rows(by_u, Symbol::Input)]
}

#[cfg(test)]
mod tests {
    use mbs_derive::expr::Graph;
    use mbs_derive::{declared, derived};

    use super::*;

    /// Scalars, vectors, matrices and arrays, of places, rates and inputs, in place and order.
    #[test]
    fn generated_jacobians_are_those_of_dual_numbers() {
        let text = "mechanism Arm { param l: m = 0.7; coord a: rad; coord x: m; input f[2]: N; \
            kinetic += 1/2*2 kg*dt(x)^2 + 1/2*3 kg*m^2*dt(a)^2; force x += f[0]; force a += l*f[1]; \
            let arm = world*rot_z(a)*translation([x, 0, 0]); \
            output power = f[0]*dt(x); output tip = [l*cos(a) + x, l*sin(a), l]; output speed = [dt(x), l*dt(a)]; \
            output turn = [[cos(a), x*sin(a)], [f[0]*x, f[1]*dt(x)]]; output hand = arm; }";
        let graph = Graph::verbatim();
        let derivation = derived(&declared(text, &graph, &[]).unwrap().0);
        let state = State {
            t: 0.0,
            q: vec![0.4, 1.3],
            qd: vec![-0.6, 0.8],
            qdd: vec![0.0; 2],
            u: vec![2.0, -3.0],
            prescribed: Vec::new(),
        };
        let point = Point { state, accelerations_are_given: false, parameters: vec![0.7] };
        let interpreter = Interpreter::with_parameters(&derivation, point.parameters.clone());
        let mut compared = 0;
        for (number, function) in outputs(&derivation).take(4) {
            let generated = generated(&interpreter, &point.state, number).unwrap();
            for (one, other) in generated.iter().flatten().zip(by_duals(&derivation, function, &point).iter().flatten())
            {
                assert!((one - other).abs() < 1e-15, "{}: {one}, not {other}", function.name);
                compared += 1;
            }
        }
        assert_eq!(compared, (1 + 3 + 2 + 4) * 6);
        let [by_q, by_qd, by_u] = slopes(&derivation, &point);
        assert_eq!([by_q.shape(), by_qd.shape(), by_u.shape()], [(22, 2); 3]);
        assert_eq!((by_qd[(0, 1)], by_u[(0, 0)]), (2.0, 0.8));
    }
}
