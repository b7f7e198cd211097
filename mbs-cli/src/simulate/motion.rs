//! Integration, and what is recorded of it.

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Variable;
use mbs_derive::model::lagrangian::component_names;
use mbs_derive::optimise::{Derivation, Function};
use mbs_runtime::{Dop853, IntegrationError, Integrator, Rk4};

use super::progress::Progress;
use crate::failure::Failure;
use crate::state::Point;

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Dormand and Prince's method of order 8 with error control; rows between its steps are interpolated.
    Dop853,
    /// The classical method of order 4, with the fixed step --dt.
    Rk4,
}

/// A motion, row by row.
#[derive(Debug)]
pub(crate) struct Motion {
    /// Of the mechanism.
    pub(crate) name: String,
    /// The names of the coordinates.
    pub(crate) coordinates: Vec<String>,
    /// Their units.
    pub(crate) units: Vec<String>,
    /// The names of the constraints' rows.
    pub(crate) constraints: Vec<String>,
    /// In order of time.
    pub(crate) rows: Vec<Row>,
}

/// What is recorded at one time.
#[derive(Debug)]
pub(crate) struct Row {
    /// Time in seconds.
    pub(crate) t: f64,
    /// Coordinates.
    pub(crate) q: Vec<f64>,
    /// Velocities.
    pub(crate) qd: Vec<f64>,
    /// T
    pub(crate) kinetic: f64,
    /// V
    pub(crate) potential: f64,
    /// Lagrange multipliers, then what the constraints' rows are instead of zero.
    pub(crate) constraints: Vec<f64>,
}

impl Motion {
    /// From a state over the given times, the first of which is the state's.
    pub(crate) fn integrate(
        derivation: &Derivation,
        start: &Point,
        times: &[f64],
        method: Method,
        relative: f64,
        absolute: f64,
    ) -> Result<Motion, Failure> {
        let equations = Equations::new(derivation, start)?;
        let rows = match (method, times) {
            (Method::Dop853, _) => equations.rows(&Dop853::new(relative, absolute), times),
            (Method::Rk4, [first, second, ..]) => equations.rows(&Rk4::new(second - first), times),
            (Method::Rk4, _) => equations.rows(&Rk4::new(1.0), times),
        };
        Ok(Motion {
            name: derivation.name.clone(),
            coordinates: component_names(&derivation.coordinates),
            units: derivation.coordinates.iter().flat_map(units).collect(),
            constraints: derivation.constraints.clone(),
            rows: rows?,
        })
    }
}

fn units(variable: &Variable) -> Vec<String> {
    vec![variable.unit.clone(); variable.count()]
}

/// The equations of motion with parameters and inputs as they stay.
struct Equations<'d> {
    interpreter: Interpreter<'d>,
    forward_dynamics: &'d Function,
    kinetic_energy: &'d Function,
    potential_energy: &'d Function,
    start: State,
}

impl<'d> Equations<'d> {
    fn new(derivation: &'d Derivation, start: &Point) -> Result<Self, Failure> {
        let function = |name: &str| {
            derivation.function(name).ok_or_else(|| Failure::new(format_args!("{} has no {name}", derivation.name)))
        };
        Ok(Equations {
            interpreter: Interpreter::with_parameters(derivation, start.parameters.clone()),
            forward_dynamics: function("forward_dynamics")?,
            kinetic_energy: function("kinetic_energy")?,
            potential_energy: function("potential_energy")?,
            start: start.state.clone(),
        })
    }

    fn rows(&self, integrator: &impl Integrator<f64>, times: &[f64]) -> Result<Vec<Row>, Failure> {
        let mut rows = Vec::with_capacity(times.len());
        let mut motion = mbs_runtime::State::new(self.start.q.clone(), self.start.qd.clone());
        let mut progress = Progress::new(self.start.t, times.last().copied().unwrap_or(self.start.t));
        let mut state = self.start.clone();
        let accelerations = |t: f64, q: &Vec<f64>, qd: &Vec<f64>, qdd: &mut Vec<f64>| {
            progress.at(t);
            state.t = t;
            state.q.copy_from_slice(q);
            state.qd.copy_from_slice(qd);
            qdd.copy_from_slice(&self.interpreter.evaluate(self.forward_dynamics, &state));
        };
        let record = |t: f64, motion: &mbs_runtime::State<Vec<f64>>| rows.push(self.row(t, motion));
        let outcome = integrator.sample(accelerations, self.start.t, times, &mut motion, record);
        progress.finish();
        match outcome {
            Ok(_) => Ok(rows),
            Err(error) => Err(self.stopped(error, &motion)),
        }
    }

    fn state(&self, t: f64, motion: &mbs_runtime::State<Vec<f64>>) -> State {
        State { t, q: motion.q.clone(), qd: motion.qd.clone(), ..self.start.clone() }
    }

    fn row(&self, t: f64, motion: &mbs_runtime::State<Vec<f64>>) -> Row {
        let state = self.state(t, motion);
        let energy = |function| self.interpreter.evaluate(function, &state)[0];
        let (kinetic, potential) = (energy(self.kinetic_energy), energy(self.potential_energy));
        let constraints = ["multipliers", "constraint"]
            .into_iter()
            .filter_map(|name| self.interpreter.call(name, &state))
            .flatten()
            .collect();
        Row { t, q: state.q, qd: state.qd, kinetic, potential, constraints }
    }

    /// One line with the time and the state from which there was no way on.
    fn stopped(&self, error: IntegrationError, motion: &mbs_runtime::State<Vec<f64>>) -> Failure {
        let state = self.state(error.time().unwrap_or(self.start.t), motion);
        let accelerations = self.interpreter.evaluate(self.forward_dynamics, &state);
        let singular = accelerations.iter().any(|qdd| !qdd.is_finite());
        let hint = if singular { "; the accelerations are not finite there: is the mass matrix singular?" } else { "" };
        let (q, qd) = (&state.q, &state.qd);
        Failure::new(format_args!("the integration stopped: {error}, at q = {q:?}, qd = {qd:?}{hint}"))
    }
}
