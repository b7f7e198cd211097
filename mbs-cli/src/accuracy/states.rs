//! Where accuracy is measured: random states, and those at which digits are easily lost.

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Lagrangian;
use mbs_derive::numeric::Random;
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::variable::Variable;
use nalgebra::{DMatrix, DVector};

use super::vanishing;

/// A state with parameters.
pub(crate) struct Point {
    /// For messages.
    pub(crate) name: String,
    pub(crate) state: State,
    pub(crate) parameters: Vec<f64>,
}

/// Nearer than this things touch.
pub(crate) const CLOSE: f64 = 1e-9;

/// Farther than this nothing is.
const FAR: f64 = 1e7;

/// The points of a mechanism.
pub(crate) fn points(lagrangian: &Lagrangian<'_>) -> Vec<Point> {
    let mut random = Random::new(0x0061_6363_7572_6163);
    let declared: Vec<f64> =
        lagrangian.parameters.iter().flat_map(|p| &p.defaults).map(|default| default.to_f64()).collect();
    let mut points = Vec::new();
    let mut add = |name: String, state: State, parameters: &[f64]| {
        points.push(Point { name, state, parameters: parameters.to_vec() });
    };
    let stiff = stiffened(lagrangian, &declared);
    for k in 0..2 {
        add(format!("random {k}"), state(lagrangian, &mut random), &declared);
    }
    let mut far = state(lagrangian, &mut random);
    far.q.iter_mut().for_each(|q| *q *= FAR);
    // A frame that is given from outside is as far.
    far.prescribed.iter_mut().flatten().for_each(|value| *value *= FAR);
    add("far".to_string(), far, &declared);
    // All coordinates near zero, near each other, and near a right angle.
    for (name, place) in
        [("near zero", 0.0), ("near each other", 0.8), ("near a right angle", std::f64::consts::FRAC_PI_2)]
    {
        let mut close = state(lagrangian, &mut random);
        close.q.iter_mut().for_each(|q| *q = place + CLOSE * random.symmetric());
        let speed = close.qd.first().copied().unwrap_or_default();
        close.qd.iter_mut().for_each(|qd| *qd = speed + CLOSE * random.symmetric());
        add(name.to_string(), close, &stiff);
    }
    for (k, near) in near_parameters(lagrangian, &declared).into_iter().enumerate() {
        let mut close = state(lagrangian, &mut random);
        for (q, place) in close.q.iter_mut().zip(near) {
            if let Some(place) = place {
                *q = place + CLOSE * random.symmetric();
            }
        }
        add(format!("near parameters {k}"), close, &stiff);
    }
    let start = state(lagrangian, &mut random);
    for (sum, place) in vanishing::places(lagrangian, &start, &declared) {
        let mut close = state(lagrangian, &mut random);
        (close.t, close.prescribed) = (start.t, start.prescribed.clone());
        close.q = place.iter().map(|q| q + CLOSE * random.symmetric()).collect();
        add(format!("where sum {sum} vanishes"), close, &declared);
    }
    let mut zeros = state(lagrangian, &mut random);
    zeros.q.iter_mut().step_by(2).for_each(|q| *q = 0.0);
    zeros.qd.iter_mut().skip(1).step_by(2).for_each(|qd| *qd = 0.0);
    add("zeros".to_string(), zeros, &declared);
    points
}

/// The nearest states to some points that constraints allow.
pub(crate) fn on_the_constraints(derivation: &Derivation, points: &[Point]) -> Vec<Point> {
    if derivation.constraints.is_empty() {
        return Vec::new();
    }
    let nearest = |point: &Point| {
        let mechanism = Interpreter::with_parameters(derivation, point.parameters.clone());
        let mut state = point.state.clone();
        let call = |kind, state: &State| mechanism.rows(kind, state);
        let change = |state: &State, residuals: &[f64]| {
            let (k, n) = (residuals.len(), state.q.len());
            let slopes = DMatrix::from_row_slice(k, n, &call(FunctionKind::ConstraintJacobian, state));
            let inverse = slopes.pseudo_inverse(1e-9).expect("not negative");
            inverse * DVector::from_column_slice(residuals)
        };
        for _ in 0..50 {
            let mut residuals = call(FunctionKind::Constraint, &state);
            let is_place = residuals.iter_mut().zip(&derivation.holonomic);
            is_place.filter(|(_, holonomic)| !**holonomic).for_each(|(residual, _)| *residual = 0.0);
            let change = change(&state, &residuals);
            state.q.iter_mut().zip(change.iter()).for_each(|(q, change)| *q -= change);
        }
        let change = change(&state, &call(FunctionKind::ConstraintRate, &state));
        state.qd.iter_mut().zip(change.iter()).for_each(|(qd, change)| *qd -= change);
        Point { name: format!("{} on the constraints", point.name), state, parameters: point.parameters.clone() }
    };
    points.iter().take(2).map(nearest).collect()
}

/// A random one.
pub(crate) fn state(lagrangian: &Lagrangian<'_>, random: &mut Random) -> State {
    let count = |variables: &[Variable]| variables.iter().map(Variable::count).sum::<usize>();
    let mut numbers = |n: usize, range: f64| random.vector(n, range);
    let n = lagrangian.dof();
    State {
        t: numbers(1, 2.0)[0],
        q: numbers(n, std::f64::consts::PI),
        qd: numbers(n, 3.0),
        qdd: numbers(n, 10.0),
        u: numbers(count(&lagrangian.inputs), 2.0),
        prescribed: (0..count(&lagrangian.prescribed)).map(|_| [0; 3].map(|_| numbers(1, 1.0)[0])).collect(),
    }
}

/// Springs of 1e9 N/m.
fn stiffened(lagrangian: &Lagrangian<'_>, declared: &[f64]) -> Vec<f64> {
    let units = lagrangian.parameters.iter().flat_map(|p| std::iter::repeat_n(p.unit.as_str(), p.count()));
    declared
        .iter()
        .zip(units)
        .map(|(&value, unit)| if unit == "N/m" { 1e9_f64.copysign(value) } else { value })
        .collect()
}

/// Coordinates of a length at the parameters of a length, in several orders.
fn near_parameters(lagrangian: &Lagrangian<'_>, declared: &[f64]) -> Vec<Vec<Option<f64>>> {
    let with_units = |variables: &[Variable]| -> Vec<String> {
        variables.iter().flat_map(|v| std::iter::repeat_n(v.unit.clone(), v.count())).collect()
    };
    let lengths: Vec<f64> = declared
        .iter()
        .zip(with_units(&lagrangian.parameters))
        .filter(|(_, unit)| unit == "m")
        .map(|(&value, _)| value)
        .collect();
    let coordinates = with_units(&lagrangian.coordinates);
    let along = |offset: usize| {
        let mut next = offset;
        let mut place = |unit: &String| {
            (unit == "m").then(|| {
                next += 1;
                lengths[(next - 1) % lengths.len()]
            })
        };
        coordinates.iter().map(&mut place).collect()
    };
    if !coordinates.iter().any(|unit| unit == "m") {
        Vec::new()
    } else {
        (0..lengths.len().min(6)).map(along).collect()
    }
}
