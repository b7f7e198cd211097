//! A mechanism's functions along a motion.

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_runtime::{ConstraintError, Constraints, Projector, RedundantRows};

use crate::columns;
use crate::model::{Model, Point, as_portable};
use crate::portable::{Portable, plain, portable};

/// Positions and velocities, as the runtime integrates them.
pub(crate) type Moving = mbs_runtime::State<Vec<f64>>;

/// Writes inputs and prescribed motions at `(t, q, q̇)`, or refuses; where no inputs are asked for there is no room for
/// them.
pub type Drive<'a> = dyn Fn(f64, &[f64], &[f64], &mut [f64], &mut [[f64; 3]]) -> bool + 'a;

/// Evaluates a mechanism's functions along a motion.
pub(crate) struct Equations<'a> {
    interpreter: Interpreter<'a, Portable>,
    derivation: &'a Derivation,
    start: &'a Point,
    drive: Option<&'a Drive<'a>>,
}

impl<'a> Equations<'a> {
    /// From this state, inputs and prescribed motions given by `drive`, or staying as they are.
    pub(crate) fn new(model: &'a Model, start: &'a Point, drive: Option<&'a Drive<'a>>) -> Self {
        let derivation = model.derivation();
        let interpreter = Interpreter::with_parameters(derivation, portable(&start.parameters));
        Equations { interpreter, derivation, start, drive }
    }

    /// Where the motion starts.
    pub(crate) fn start(&self) -> Moving {
        Moving::new(self.start.state.q.clone(), self.start.state.qd.clone())
    }

    /// How constraints bring states back.
    pub(crate) fn projector(&self, redundant_rows: RedundantRows) -> Projector<f64, Vec<f64>> {
        let size = Projector::<f64, Vec<f64>>::size(self.derivation.dof(), self.rows());
        Projector::new(vec![0.0; size]).with_redundant_rows(redundant_rows)
    }

    /// `q̈`; `None` where the inputs are refused.
    pub(crate) fn accelerations(&self, t: f64, q: &[f64], qd: &[f64]) -> Option<Vec<f64>> {
        let state = self.state(t, q, qd)?;
        Some(self.call(FunctionKind::ForwardDynamics, &state))
    }

    /// What a motion records; `None` where the inputs are refused.
    pub(crate) fn row(&self, t: f64, q: &[f64], qd: &[f64]) -> Option<Vec<f64>> {
        let state = self.state(t, q, qd)?;
        let energy = |kind| self.call(kind, &state).first().copied().unwrap_or(f64::NAN);
        let [kinetic, potential] = [FunctionKind::KineticEnergy, FunctionKind::PotentialEnergy].map(energy);
        let multipliers = self.interpreter.rows(FunctionKind::Multipliers, &state);
        let residuals = self.rows_of(FunctionKind::Constraint, &state);
        let value = |function: &Function| plain(self.interpreter.evaluate_with(function, &state, &multipliers));
        let outputs: Vec<f64> = columns::outputs(self.derivation).flat_map(value).collect();
        let energies = [kinetic, potential, kinetic + potential];
        Some([&[t], q, qd, &energies, &plain(multipliers.clone()), &residuals, &outputs].concat())
    }

    /// What went wrong with which row.
    pub(crate) fn explained(&self, error: ConstraintError) -> String {
        let name = |row: usize| self.derivation.constraints.get(row).map_or("", String::as_str);
        match error {
            ConstraintError::Open { row, residual } => {
                format!("the constraints do not close: `{}` stays open by {residual:e}", name(row))
            }
            ConstraintError::Redundant { row } => format!(
                "constraint `{}` depends on the others; with `redundant: \"least-norm\"` the motion goes on with \
                 multipliers of the least norm",
                name(row)
            ),
            ConstraintError::Contradiction { row, residual } => {
                format!("constraint `{}` contradicts the others: {residual:e} is left of it", name(row))
            }
            other => other.to_string(),
        }
    }

    fn state(&self, t: f64, q: &[f64], qd: &[f64]) -> Option<State<Portable>> {
        self.driven(t, q, qd, self.start.state.u.clone())
    }

    /// Without inputs, for what does not depend on them; not numbers where prescribed motions are refused.
    fn place(&self, t: f64, q: &[f64], qd: &[f64]) -> State<Portable> {
        let refused = || self.undriven(f64::NAN, q, qd, Vec::new());
        self.driven(t, q, qd, Vec::new()).unwrap_or_else(|| as_portable(&refused()))
    }

    fn driven(&self, t: f64, q: &[f64], qd: &[f64], u: Vec<f64>) -> Option<State<Portable>> {
        let mut state = self.undriven(t, q, qd, u);
        let is_given = self.drive.is_none_or(|drive| drive(t, q, qd, &mut state.u, &mut state.prescribed));
        is_given.then(|| as_portable(&state))
    }

    fn undriven(&self, t: f64, q: &[f64], qd: &[f64], u: Vec<f64>) -> State {
        State { t, q: q.to_vec(), qd: qd.to_vec(), u, ..self.start.state.clone() }
    }

    fn call(&self, kind: FunctionKind, state: &State<Portable>) -> Vec<f64> {
        self.interpreter.call(kind, state).map(plain).unwrap_or_default()
    }

    fn rows_of(&self, kind: FunctionKind, state: &State<Portable>) -> Vec<f64> {
        plain(self.interpreter.rows(kind, state))
    }
}

impl Constraints<f64> for Equations<'_> {
    fn rows(&self) -> usize {
        self.derivation.constraints.len()
    }

    fn is_holonomic(&self, row: usize) -> bool {
        self.derivation.holonomic[row]
    }

    fn mass_matrix(&self, t: f64, q: &[f64], m: &mut [f64]) {
        m.copy_from_slice(&self.call(FunctionKind::MassMatrix, &self.place(t, q, &self.start.state.qd)));
    }

    fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
        phi.copy_from_slice(&self.rows_of(FunctionKind::Constraint, &self.place(t, q, &self.start.state.qd)));
    }

    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        rate.copy_from_slice(&self.rows_of(FunctionKind::ConstraintRate, &self.place(t, q, qd)));
    }

    fn jacobian(&self, t: f64, q: &[f64], a: &mut [f64]) {
        a.copy_from_slice(&self.rows_of(FunctionKind::ConstraintJacobian, &self.place(t, q, &self.start.state.qd)));
    }
}
