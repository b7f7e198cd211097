//! The equations of motion, with parameters, inputs and prescribed motions as they stay: interpreted, or compiled.

mod native;

use std::cell::RefCell;

use mbs_derive::expr::Symbol;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_runtime::{ConstraintError, Constraints, Projector, RedundantRows};

use crate::failure::Failure;
use crate::simulate::drive::Driven;
use crate::state::Point;

use native::Compiled;
pub(crate) use native::Native;

/// Positions and velocities, as the runtime integrates them.
pub(crate) type Motion = mbs_runtime::State<Vec<f64>>;

/// What to do about constraints that depend on others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Redundant {
    /// Refuse them, by name.
    Refuse,
    /// Go on with multipliers of the least norm.
    LeastNorm,
}

impl From<Redundant> for RedundantRows {
    fn from(redundant: Redundant) -> Self {
        match redundant {
            Redundant::Refuse => RedundantRows::Refuse,
            Redundant::LeastNorm => RedundantRows::LeaveOut,
        }
    }
}

/// Evaluates a mechanism's functions along a motion.
pub(crate) struct Equations<'d> {
    interpreter: Interpreter<'d>,
    derivation: &'d Derivation,
    /// The number of `forward_dynamics`.
    forward_dynamics: usize,
    start: State,
    driven: Driven,
    compiled: Option<Compiled<'d>>,
    /// Kept from call to call, so that memory is not asked for at each: as many as calls are within each other.
    states: RefCell<Vec<State>>,
}

impl<'d> Equations<'d> {
    /// Of this mechanism, from this state.
    pub(crate) fn new(derivation: &'d Derivation, start: &Point) -> Result<Self, Failure> {
        let missing = || Failure::new(format_args!("{} has no forward_dynamics", derivation.name));
        Ok(Equations {
            interpreter: Interpreter::with_parameters(derivation, start.parameters.clone()),
            derivation,
            forward_dynamics: number_of(derivation, FunctionKind::ForwardDynamics).ok_or_else(missing)?,
            start: start.state.clone(),
            driven: Driven::default(),
            compiled: None,
            states: RefCell::new(Vec::new()),
        })
    }

    /// With compiled functions of the same mechanism in place of interpreted ones.
    pub(crate) fn with_native(self, native: &'d Native) -> Result<Self, Failure> {
        let compiled = native.with_parameters(self.interpreter.parameters()).map_err(Failure::new)?;
        Ok(Equations { compiled: Some(compiled), ..self })
    }

    /// With inputs and signals that change.
    pub(crate) fn with_driven(self, driven: Driven) -> Self {
        Equations { driven, ..self }
    }

    /// The first time.
    pub(crate) fn start_time(&self) -> f64 {
        self.start.t
    }

    /// From another state, with the same time and inputs.
    pub(crate) fn starting_from(mut self, motion: Motion) -> Self {
        self.start.q = motion.q;
        self.start.qd = motion.qd;
        self
    }

    /// Where the motion starts.
    pub(crate) fn start(&self) -> Motion {
        Motion::new(self.start.q.clone(), self.start.qd.clone())
    }

    /// Whether accelerations depend on velocities.
    pub(crate) fn depends_on_velocities(&self) -> bool {
        let forward_dynamics = &self.derivation.functions[self.forward_dynamics];
        forward_dynamics.program.uses(|symbol| matches!(symbol, Symbol::Velocity(_)))
    }

    /// The arguments of the mechanism's functions.
    pub(crate) fn state(&self, t: f64, q: &[f64], qd: &[f64]) -> State {
        let mut state = State { t, q: q.to_vec(), qd: qd.to_vec(), ..self.start.clone() };
        self.driven.put(self, &mut state);
        state
    }

    /// Hands out the arguments of the mechanism's functions.
    pub(crate) fn at<R>(&self, t: f64, q: &[f64], qd: &[f64], ask: impl FnOnce(&State) -> R) -> R {
        let kept = self.states.borrow_mut().pop();
        let mut state = kept.unwrap_or_else(|| self.start.clone());
        state.t = t;
        state.q.copy_from_slice(q);
        state.qd.copy_from_slice(qd);
        self.driven.put(self, &mut state);
        let answer = ask(&state);
        self.states.borrow_mut().push(state);
        answer
    }

    /// Puts the results of the function with this number where there is place for as many.
    fn put(&self, number: usize, state: &State, results: &mut [f64]) {
        let is_put = self.compiled.as_ref().is_some_and(|compiled| compiled.put(number, state, None, results));
        if !is_put {
            results.copy_from_slice(&self.interpreter.evaluate(&self.derivation.functions[number], state));
        }
    }

    /// Puts the results of a function of the constraints at a state, which there is where there are some.
    fn put_rows(&self, kind: FunctionKind, t: f64, q: &[f64], qd: &[f64], results: &mut [f64]) {
        if !results.is_empty() {
            self.at(t, q, qd, |state| match number_of(self.derivation, kind) {
                Some(number) => self.put(number, state, results),
                None => results.copy_from_slice(&self.call(kind, state)),
            });
        }
    }

    fn number(&self, kind: FunctionKind) -> usize {
        let missing = || panic!("{} has no function `{}`", self.derivation.name, kind.name());
        number_of(self.derivation, kind).unwrap_or_else(missing)
    }

    /// The results of the function with this number, where it takes multipliers with these, or those of the motion.
    fn results(&self, number: usize, state: &State, multipliers: Option<&[f64]>) -> Vec<f64> {
        let compiled = self.compiled.as_ref().and_then(|compiled| compiled.evaluate(number, state, multipliers));
        compiled.unwrap_or_else(|| {
            let function = &self.derivation.functions[number];
            match multipliers {
                Some(multipliers) => self.interpreter.evaluate_with(function, state, multipliers),
                None => self.interpreter.evaluate(function, state),
            }
        })
    }

    /// The results of a function, where it takes multipliers with these.
    pub(crate) fn evaluate(&self, function: &Function, state: &State, multipliers: &[f64]) -> Vec<f64> {
        self.interpreter.evaluate_with(function, state, multipliers)
    }

    /// The first result of the function with this number.
    pub(crate) fn evaluate_number(&self, number: usize, state: &State) -> f64 {
        let compiled = self.compiled.as_ref().and_then(|compiled| compiled.first(number, state));
        let interpreted = || self.interpreter.evaluate(&self.derivation.functions[number], state).first().copied();
        compiled.or_else(interpreted).unwrap_or(f64::NAN)
    }

    /// A number that every mechanism has.
    pub(crate) fn scalar(&self, kind: FunctionKind, state: &State) -> f64 {
        self.evaluate_number(self.number(kind), state)
    }

    /// The results of a function; `None` where the mechanism has none, which M and A are no reason for where their
    /// system is eliminated.
    pub(crate) fn try_call(&self, kind: FunctionKind, state: &State) -> Option<Vec<f64>> {
        match number_of(self.derivation, kind) {
            Some(number) => Some(self.results(number, state, None)),
            None => self.interpreter.call(kind, state),
        }
    }

    /// The results of a function that every mechanism has.
    pub(crate) fn call(&self, kind: FunctionKind, state: &State) -> Vec<f64> {
        let missing = || panic!("{} has no function `{}`", self.derivation.name, kind.name());
        self.try_call(kind, state).unwrap_or_else(missing)
    }

    /// The results of a function of the constraints, one that all mechanisms with constraints have.
    pub(crate) fn rows_of(&self, kind: FunctionKind, state: &State) -> Vec<f64> {
        if self.derivation.constraints.is_empty() { Vec::new() } else { self.call(kind, state) }
    }

    /// `q̈` in closed form.
    fn put_accelerations(&self, state: &State, accelerations: &mut [f64]) {
        self.put(self.forward_dynamics, state, accelerations);
    }

    /// Whether inertia and forces are numbers: then accelerations are, too, unless M is singular.
    pub(crate) fn are_finite(&self, state: &State) -> bool {
        let matrix = self.interpreter.call(FunctionKind::MassMatrix, state).unwrap_or_default();
        matrix.iter().chain(&self.free_force(state)).all(|x| x.is_finite())
    }

    /// `Q − C q̇ − G − ∂D/∂q̇`, without a function for the bias by inverse dynamics without accelerations.
    fn free_force(&self, state: &State) -> Vec<f64> {
        use FunctionKind::{Bias, DissipationForce, GeneralizedForce, InverseDynamics};
        let applied = self.call(GeneralizedForce, state).into_iter();
        if number_of(self.derivation, Bias).is_some() {
            let [bias, dissipation] = [Bias, DissipationForce].map(|kind| self.call(kind, state));
            return applied.zip(bias).zip(dissipation).map(|((applied, h), d)| applied - h - d).collect();
        }
        let unaccelerated = State { qdd: vec![0.0; state.q.len()], ..state.clone() };
        applied
            .zip(self.call(InverseDynamics, &unaccelerated))
            .map(|(applied, resisting)| applied - resisting)
            .collect()
    }

    /// How constraints bring states back.
    pub(crate) fn projector(&self, redundant_rows: RedundantRows) -> Projector<f64, Vec<f64>> {
        let size = Projector::<f64, Vec<f64>>::size(self.derivation.dof(), self.rows());
        Projector::new(vec![0.0; size]).with_redundant_rows(redundant_rows)
    }

    /// The names of the constraints' rows.
    pub(crate) fn row_names(&self) -> &'d [String] {
        &self.derivation.constraints
    }
}

/// The place of a function among those of a mechanism.
fn number_of(derivation: &Derivation, kind: FunctionKind) -> Option<usize> {
    derivation.functions.iter().position(|function| function.kind == kind)
}

impl Constraints<f64> for Equations<'_> {
    fn rows(&self) -> usize {
        self.derivation.constraints.len()
    }

    fn is_holonomic(&self, row: usize) -> bool {
        self.derivation.holonomic[row]
    }

    fn mass_matrix(&self, t: f64, q: &[f64], m: &mut [f64]) {
        self.put_rows(FunctionKind::MassMatrix, t, q, &self.start.qd, m);
    }

    fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
        self.put_rows(FunctionKind::Constraint, t, q, &self.start.qd, phi);
    }

    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        self.put_rows(FunctionKind::ConstraintRate, t, q, qd, rate);
    }

    fn jacobian(&self, t: f64, q: &[f64], a: &mut [f64]) {
        self.put_rows(FunctionKind::ConstraintJacobian, t, q, &self.start.qd, a);
    }

    fn least_change(&self, t: f64, q: &[f64], target: &[f64], change: &mut [f64]) -> Option<usize> {
        let (found, rank) = self.at(t, q, &self.start.qd, |state| self.interpreter.least_change(state, target))?;
        change.copy_from_slice(&found);
        Some(rank)
    }
}

/// Accelerations and multipliers: in closed form, or by the runtime's factorization where rows are redundant or
/// stabilized, or where M is singular, but not on the motions that constraints leave.
pub(crate) struct Solver<'e, 'd> {
    equations: &'e Equations<'d>,
    /// Whether the closed form is taken where it is finite.
    is_closed: bool,
    projector: Projector<f64, Vec<f64>>,
    /// Baumgarte's `α` and `β`.
    gains: [f64; 2],
}

impl<'e, 'd> Solver<'e, 'd> {
    /// In closed form where that is finite.
    pub(crate) fn closed(equations: &'e Equations<'d>) -> Self {
        Solver { is_closed: true, ..Self::numerical(equations, RedundantRows::Refuse, [0.0; 2]) }
    }

    /// By factorization of A, with Baumgarte's gains.
    pub(crate) fn numerical(equations: &'e Equations<'d>, redundant_rows: RedundantRows, gains: [f64; 2]) -> Self {
        Solver { equations, is_closed: false, projector: equations.projector(redundant_rows), gains }
    }

    /// `q̈`
    pub(crate) fn accelerations(&mut self, state: &State) -> Result<Vec<f64>, ConstraintError> {
        let mut accelerations = vec![0.0; state.q.len()];
        self.put_accelerations(state, &mut accelerations).map(|()| accelerations)
    }

    /// Puts `q̈` where there is place for it.
    pub(crate) fn put_accelerations(&mut self, state: &State, qdd: &mut [f64]) -> Result<(), ConstraintError> {
        if self.is_closed {
            self.equations.put_accelerations(state, qdd);
            if qdd.iter().all(|x| x.is_finite()) {
                return Ok(());
            }
        }
        self.factorize(state).map(|(accelerations, _)| qdd.copy_from_slice(&accelerations))
    }

    /// `λ`
    pub(crate) fn multipliers(&mut self, state: &State) -> Result<Vec<f64>, ConstraintError> {
        let closed = self.is_closed.then(|| self.equations.rows_of(FunctionKind::Multipliers, state));
        finite(closed).map_or_else(|| self.factorize(state).map(|(_, multipliers)| multipliers), Ok)
    }

    fn factorize(&mut self, state: &State) -> Result<(Vec<f64>, Vec<f64>), ConstraintError> {
        let equations = self.equations;
        use FunctionKind::{Constraint, ConstraintBias, ConstraintRate};
        let force = equations.free_force(state);
        let [gamma, rate, position] =
            [ConstraintBias, ConstraintRate, Constraint].map(|kind| equations.rows_of(kind, state));
        let [alpha, beta] = self.gains;
        let stabilized = |row: usize| {
            // A Pfaffian row has no position to come back to.
            let position = if equations.is_holonomic(row) { position[row] } else { 0.0 };
            gamma[row] + 2.0 * alpha * rate[row] + beta * beta * position
        };
        let bias: Vec<f64> = (0..gamma.len()).map(stabilized).collect();
        let (mut accelerations, mut multipliers) = (vec![0.0; force.len()], vec![0.0; bias.len()]);
        let (qdd, lambda) = (&mut accelerations, &mut multipliers);
        self.projector.accelerations(equations, state.t, &state.q, &force, &bias, qdd, lambda)?;
        Ok((accelerations, multipliers))
    }
}

/// The numbers, if all of them are finite.
fn finite(numbers: Option<Vec<f64>>) -> Option<Vec<f64>> {
    numbers.filter(|numbers| numbers.iter().all(|x| x.is_finite()))
}
