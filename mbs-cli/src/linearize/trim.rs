//! The search for a state without accelerations, but for those that a steady motion has.
//!
//! `q̈(q, q̇, u) = 0`, `φ(q) = 0` and `A q̇ + b = 0` are solved for what is free by Newton's method: steps of least
//! norm, halved while what is left grows. Rows are weighed by the size of their derivatives.

use mbs_derive::expr::Symbol;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::variable::component_names;
use nalgebra::{DMatrix, DVector};

use super::along::Along;
use crate::failure::Failure;
use crate::output;
use crate::state::Point;
use crate::words::{abridged, vector, without_noise};

const MOST_STEPS: usize = 100;
const MOST_HALVINGS: usize = 30;
/// What a change of the unknowns by this part explains is rounding.
const ROUNDING: f64 = 1e-10;

/// Coordinates, velocities, inputs.
pub(super) fn names(derivation: &Derivation) -> Vec<String> {
    let coordinates = component_names(&derivation.coordinates);
    let velocities: Vec<String> = coordinates.iter().map(|name| format!("{name}_dot")).collect();
    [coordinates, velocities, component_names(&derivation.inputs)].concat()
}

/// Changes what is free so that the state stays without accelerations, those of some coordinates excepted.
pub(super) fn trim(
    derivation: &Derivation,
    point: &mut Point,
    free: &[usize],
    accelerating: &[usize],
) -> Result<(), Failure> {
    let interpreter = Interpreter::with_parameters(derivation, point.parameters.clone());
    let conditions = Conditions { derivation, interpreter, parameters: point.parameters.clone(), free, accelerating };
    let given = point.state.qd.clone();
    let mut left = conditions.evaluate(&point.state)?;
    for _ in 0..MOST_STEPS {
        let step = left.step()?;
        let start = point.state.clone();
        let size = conditions.size(&start);
        let (before, mut share) = (left.norm(), 1.0);
        let mut better = None;
        for _ in 0..MOST_HALVINGS {
            let mut state = start.clone();
            conditions.change(&mut state, &(&step * share));
            // A state where nothing is finite is too far.
            if let Ok(next) = conditions.evaluate(&state)
                && next.weighed_by(&left) < before
            {
                better = Some((state, next));
                break;
            }
            share *= 0.5;
        }
        let Some((state, next)) = better else { break };
        (point.state, left) = (state, next);
        if (step.amax() * share) <= 1e-14 * size {
            break;
        }
    }
    conditions.check(&point.state, &left)?;
    warn_of_lost_speeds(derivation, &given, &point.state.qd);
    Ok(())
}

/// A search that is free to choose speeds may end at rest, where nobody has asked for that.
fn warn_of_lost_speeds(derivation: &Derivation, given: &[f64], found: &[f64]) {
    let names = component_names(&derivation.coordinates);
    let is_lost = |i: &usize| given[*i] != 0.0 && (found[*i] - given[*i]).abs() > 0.5 * given[*i].abs();
    let lost = (0..given.len()).filter(is_lost).map(|i| {
        let found = without_noise(&[given[i], found[i]])[1];
        format!("`{}_dot` is {found:?}, {:?} was given", names[i], given[i])
    });
    let lost: Vec<String> = lost.collect();
    if !lost.is_empty() {
        output::warn(format_args!(
            "the equilibrium is far from the state given: {}; leave out of `--trim` what is to stay",
            abridged(&lost)
        ));
    }
}

struct Conditions<'a> {
    derivation: &'a Derivation,
    interpreter: Interpreter<'a>,
    parameters: Vec<f64>,
    /// Numbers among coordinates, velocities and inputs.
    free: &'a [usize],
    /// Coordinates whose accelerations need not vanish.
    accelerating: &'a [usize],
}

/// What is to be zero, and its derivatives in what is free.
struct Left {
    values: DVector<f64>,
    slopes: DMatrix<f64>,
}

impl Left {
    fn weights(&self) -> DVector<f64> {
        DVector::from_iterator(
            self.values.len(),
            self.slopes.row_iter().map(|row| {
                let size = row.norm();
                if size > 0.0 { 1.0 / size } else { 1.0 }
            }),
        )
    }

    fn norm(&self) -> f64 {
        self.weighed_by(self)
    }

    fn weighed_by(&self, other: &Self) -> f64 {
        self.values.component_mul(&other.weights()).norm()
    }

    /// Newton's step of least norm.
    fn step(&self) -> Result<DVector<f64>, Failure> {
        let weights = self.weights();
        let rows = DMatrix::from_fn(self.slopes.nrows(), self.slopes.ncols(), |i, j| weights[i] * self.slopes[(i, j)]);
        let right = -self.values.component_mul(&weights);
        let svd = rows.svd(true, true);
        let greatest = svd.singular_values.amax();
        svd.solve(&right, 1e-12 * greatest).map_err(|error| Failure::new(format_args!("the search ended: {error}")))
    }
}

impl Conditions<'_> {
    fn evaluate(&self, state: &State) -> Result<Left, Failure> {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        use FunctionKind::{Constraint, ConstraintJacobian, ConstraintRate, ConstraintRateJacobian};
        let call = |kind| self.interpreter.call(kind, state).expect("every mechanism has it");
        let rows = |kind| self.interpreter.rows(kind, state);
        let (mut linearize, a, moved) =
            (call(FunctionKind::Linearize), rows(ConstraintJacobian), rows(ConstraintRateJacobian));
        let inputs = state.u.len();
        // Where rows repeat others all derivatives are NaN; no row is about inputs.
        if !linearize.iter().all(|x| x.is_finite()) {
            let by_inputs = self.by_inputs(state);
            linearize[2 * n * n..][..n * inputs].copy_from_slice(by_inputs.transpose().as_slice());
        }
        let holonomic = |row: usize| self.derivation.holonomic[row];
        let mut values = call(FunctionKind::ForwardDynamics);
        let position = rows(Constraint);
        values.extend((0..k).map(|row| if holonomic(row) { position[row] } else { 0.0 }));
        values.extend(rows(ConstraintRate));
        // By the kind of what is free: coordinate, velocity, input.
        let slope = |i: usize, j: usize| -> f64 {
            let (kind, index) = if j < 2 * n { (j / n, j % n) } else { (2, j - 2 * n) };
            match (i, kind) {
                (i, 0 | 1) if i < n => linearize[kind * n * n + i * n + index],
                (i, _) if i < n => linearize[2 * n * n + i * inputs + index],
                (i, 0) if i < n + k && holonomic(i - n) => a[(i - n) * n + index],
                (i, 0) if i >= n + k => moved[(i - n - k) * n + index],
                (i, 1) if i >= n + k => a[(i - n - k) * n + index],
                _ => 0.0,
            }
        };
        let mut slopes = DMatrix::from_fn(values.len(), self.free.len(), |i, j| slope(i, self.free[j]));
        for &i in self.accelerating {
            values[i] = 0.0;
            slopes.row_mut(i).fill(0.0);
        }
        if values.iter().chain(slopes.iter()).all(|x| x.is_finite()) {
            Ok(Left { values: DVector::from_vec(values), slopes })
        } else {
            let hint = match k > 0 && values.iter().all(|x| x.is_finite()) {
                true => "; where constraints repeat others only inputs can be trimmed",
                false => "",
            };
            Err(Failure::new(format_args!(
                "accelerations, or their derivatives, are infinite or NaN at the state{hint}"
            )))
        }
    }

    /// Derivatives of accelerations, a column for each input.
    fn by_inputs(&self, state: &State) -> DMatrix<f64> {
        let (state, parameters) = (state.clone(), self.parameters.clone());
        let point = Point { state, accelerations_are_given: false, parameters };
        let along = Along::new(self.derivation, &point);
        let function = self.derivation.function(FunctionKind::ForwardDynamics).expect("every mechanism has it");
        let is_it = |symbol, j| f64::from(u8::from(symbol == Symbol::Input(j as u32)));
        let columns = (0..point.state.u.len()).flat_map(|j| along.slope(function, |symbol| is_it(symbol, j)));
        DMatrix::from_iterator(self.derivation.dof(), point.state.u.len(), columns)
    }

    fn change(&self, state: &mut State, step: &DVector<f64>) {
        let n = state.q.len();
        for (&number, change) in self.free.iter().zip(step.iter()) {
            match number {
                number if number < n => state.q[number] += change,
                number if number < 2 * n => state.qd[number - n] += change,
                number => state.u[number - 2 * n] += change,
            }
        }
    }

    /// The greatest of what is free, or 1.
    fn size(&self, state: &State) -> f64 {
        let n = state.q.len();
        let value = |number: usize| match number {
            number if number < n => state.q[number],
            number if number < 2 * n => state.qd[number - n],
            number => state.u[number - 2 * n],
        };
        self.free.iter().fold(1.0, |size: f64, &number| size.max(value(number).abs()))
    }

    /// Whether all is zero but for rounding.
    fn check(&self, state: &State, left: &Left) -> Result<(), Failure> {
        let size = self.size(state);
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let coordinates = component_names(&self.derivation.coordinates);
        for (i, value) in left.values.iter().enumerate() {
            let explained = ROUNDING * (size * left.slopes.row(i).amax()).max(1.0);
            if value.abs() > explained {
                let what = match i {
                    i if i < n => format!("the acceleration of `{}`", coordinates[i]),
                    i if i < n + k => format!("`{}`", self.derivation.constraints[i - n]),
                    i => format!("the rate of `{}`", self.derivation.constraints[i - n - k]),
                };
                // In a turn the velocity turns, too.
                let turns = if i < n && state.qd.iter().any(|&rate| rate != 0.0) {
                    ", or the coordinate in `--accelerating` where a steady motion has such an acceleration, as in a turn"
                } else {
                    ""
                };
                let [q, qd, u] = [&state.q, &state.qd, &state.u].map(|numbers| vector(numbers));
                return Err(Failure::new(format_args!(
                    "no equilibrium was found: {what} stays at {value:e}, with q = {q}, qd = {qd}, u = {u}; another guess, or \
                     more names in `--trim`, may help{turns}"
                )));
            }
        }
        Ok(())
    }
}
