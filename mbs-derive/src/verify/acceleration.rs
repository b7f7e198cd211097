//! What is claimed of accelerations: where they are determined, that they satisfy the equations of motion, and what
//! their derivatives are.

use crate::catalogue::FunctionKind as Kind;
use crate::expr::{AGREEMENT, Dual, Rounded, Symbol, least_change};
use crate::interpret::{Interpreter, State};
use crate::numeric::elimination::{Elimination, eliminate_rounded, on_allowed_motions, scales};
use crate::optimise::{Completion, Function};

use super::Failure;
use super::claim::{CLOSED, Trial, called, doubles, doubles_of};
use super::group::Group;
use super::inertia;
use super::linear::{add, times};
use super::motion::Motion;
use super::tested::Tested;
use super::witness::lift_all;

impl<'a, V: Tested> Trial<'a, V> {
    /// The derivative of accelerations along that of a state and of the parameters of a mechanism.
    fn acceleration_slope(&self, varied: &Interpreter<'_, Dual<V>>, state: &State<Dual<V>>) -> Vec<V> {
        match self.derivation.function(Kind::ForwardDynamics) {
            Some(function) if function.completion == Completion::SolveConstrained => {
                self.motion(function).slope(self.n(), &varied.system_of_motion(function, state))
            }
            _ => called(varied, Kind::ForwardDynamics, state).iter().map(|v| v.derivative).collect(),
        }
    }

    pub(super) fn motion(&self, forward_dynamics: &Function) -> &Motion<'a, V> {
        self.motion.get_or_init(|| {
            Motion::new(self.n(), self.interpreter.system_of_motion(forward_dynamics, self.state), self.vectors())
        })
    }

    /// `Aᵀ λ`
    pub(super) fn constraint_force(&self) -> Vec<V> {
        let (a, l) = (self.rows(Kind::ConstraintJacobian), self.rows(Kind::Multipliers));
        let n = self.n();
        (0..n).map(|i| l.iter().enumerate().map(|(k, &l)| a[k * n + i] * l).sum()).collect()
    }

    pub(super) fn forward_dynamics(&self) -> Result<(), Failure> {
        if V::CLAIMS_SYSTEMS && self.is_constrained() {
            return self.systems_of_motion();
        }
        if self.derivation.function(Kind::MassMatrix).is_none() {
            return self.accelerations_need_the_forces();
        }
        let (m, qdd) = (self.call(Kind::MassMatrix), self.call(Kind::ForwardDynamics));
        let product = times(&m, &qdd);
        let (h, d, q) = (self.call(Kind::Bias), self.call(Kind::DissipationForce), self.call(Kind::GeneralizedForce));
        let reaction = self.constraint_force();
        let residual: Vec<V> = (0..self.n()).map(|i| product[i] + h[i] + d[i] - reaction[i]).collect();
        self.equal("M q̈ + h + ∂D/∂q̇ = Q + Aᵀ λ", &residual, &q)?;
        let (bias, a) = (self.rows(Kind::ConstraintBias), self.rows(Kind::ConstraintJacobian));
        V::rows_of_motion(self, &a, &qdd, &bias)
    }

    /// Inverse dynamics of q̈ is `Q + Aᵀ λ`: what is claimed without M.
    fn accelerations_need_the_forces(&self) -> Result<(), Failure> {
        let moved = State { qdd: self.call(Kind::ForwardDynamics), ..self.state.clone() };
        let needed = called(&self.interpreter, Kind::InverseDynamics, &moved);
        let force = self.call(Kind::GeneralizedForce);
        if !self.is_constrained() {
            return self.equal("inverse dynamics of q̈ = Q", &needed, &force);
        }
        let along = times(&self.rows(Kind::ConstraintJacobian), &self.state.qdd);
        self.equal("A q̈ of the system = that of the rates", &along, &self.along_rows(&self.state.qdd))?;
        self.equal("inverse dynamics of q̈ = Q + Aᵀ λ", &needed, &add(&force, &self.constraint_force()))?;
        let (bias, a) = (self.rows(Kind::ConstraintBias), self.rows(Kind::ConstraintJacobian));
        V::rows_of_motion(self, &a, &moved.qdd, &bias)
    }

    /// The function, if what is claimed of it is the system with constraints that it sets up.
    fn set_up_by(&self, kind: Kind) -> Option<&'a Function> {
        self.derivation.function(kind).filter(|_| V::CLAIMS_SYSTEMS && self.is_constrained())
    }

    pub(super) fn linearization(&self) -> Result<(), Failure> {
        if let Some(function) = self.set_up_by(Kind::Linearize) {
            return self.systems_of_linearization(function);
        }
        let n = self.n();
        let found = self.call(Kind::Linearize);
        let inputs = self.state.u.len();
        let kinds: [fn(u32) -> Symbol; 3] = [Symbol::Coordinate, Symbol::Velocity, Symbol::Input];
        let mut start = 0;
        for (width, symbol) in [n, n, inputs].into_iter().zip(kinds) {
            for group in Group::of(width) {
                let varied = self.state.along(|other| group.weight_of(other, symbol));
                let expected = self.acceleration_slope(&self.dual, &varied);
                let found = group.combined(&found[start..start + n * width], n);
                self.equal("linearization", &found, &expected)?;
            }
            start += n * width;
        }
        Ok(())
    }

    pub(super) fn linearization_in_parameters(&self) -> Result<(), Failure> {
        if let Some(function) = self.set_up_by(Kind::LinearizeParameters) {
            return self.systems_of_linearization_in_parameters(function);
        }
        let found = self.call(Kind::LinearizeParameters);
        let state = self.state.along(|_| V::default());
        for group in Group::of(self.parameters.len()) {
            let mut parameters = lift_all(self.parameters);
            group.columns().for_each(|j| parameters[j].derivative = group.weight(j));
            let varied = Interpreter::with_parameters(self.derivation, parameters);
            let expected = self.acceleration_slope(&varied, &state);
            self.equal("linearization in the parameters", &group.combined(&found, self.n()), &expected)?;
        }
        Ok(())
    }
}

impl Trial<'_> {
    /// What elimination shows of M, and of `M + Aᵀ A`, which is singular where a motion that the constraints allow has
    /// no inertia; each with the size of a pivot that may be nothing but rounding.
    pub(super) fn inertia(&self) -> [(Elimination, f64); 2] {
        [self.call(Kind::MassMatrix), self.augmented_mass_matrix()].map(|matrix| eliminate_rounded(&matrix, self.n()))
    }

    /// `M + Aᵀ A`, regular wherever M is on the motions that A allows.
    fn augmented_mass_matrix(&self) -> Vec<Rounded> {
        on_allowed_motions(self.n(), self.call(Kind::MassMatrix), self.rows(Kind::ConstraintJacobian), self.vectors())
    }

    /// Whether accelerations are determined at this state: not where M, or M on the motions that A allows, is singular,
    /// or where rows contradict each other. They are numbers where it clearly is not, no row does, and all else is
    /// finite. Without constraints they may be numbers where M is singular, too: a pivot that would be zero is what
    /// rounding leaves of it.
    pub(super) fn accelerations_are_determined(&self) -> Result<bool, Failure> {
        let found = self.call(Kind::ForwardDynamics);
        if self.derivation.function(Kind::MassMatrix).is_none() {
            return Ok(self.has_accelerations());
        }
        if found.iter().all(|qdd| qdd.value.is_finite()) {
            let at = || inertia::is_undetermined(self, &doubles(self.state), &doubles_of(self.parameters));
            return Ok(self.is_constrained() || !at());
        }
        if self.derivation.elimination.is_some() {
            // There M itself may be singular, which elimination does not take.
            return Ok(false);
        }
        let finite = |kind| self.call(kind).iter().all(|v| v.value.is_finite() && v.error.is_finite());
        let kinds = [Kind::MassMatrix, Kind::Bias, Kind::DissipationForce, Kind::GeneralizedForce];
        let is_bound = !self.is_constrained() || finite(Kind::ConstraintBias) && finite(Kind::ConstraintJacobian);
        let is_given = is_bound && kinds.into_iter().all(finite);
        if is_given && self.is_regular(&self.augmented_mass_matrix(), self.n()) && self.rows_agree() {
            let zero = vec![Rounded::default(); found.len()];
            self.equal("accelerations are numbers where M is regular on the allowed motions", &found, &zero)?;
        }
        Ok(false)
    }

    /// Whether accelerations are finite, if there are any.
    pub(super) fn has_accelerations(&self) -> bool {
        let found = self.derivation.function(Kind::ForwardDynamics).map(|_| self.call(Kind::ForwardDynamics));
        found.iter().flatten().all(|qdd| qdd.value.is_finite())
    }

    /// Whether what holds the rows that others do not determine holds all of them.
    fn rows_agree(&self) -> bool {
        const AGREED: f64 = 1e-10;
        let (n, a) = (self.n(), doubles_of(&self.rows(Kind::ConstraintJacobian)));
        let target: Vec<f64> = self.rows(Kind::ConstraintBias).iter().map(|v| -v.value).collect();
        let Some(qdd) = least_change(&doubles_of(&self.weights()), &a, self.vectors(), &target) else { return false };
        a.chunks(n).zip(&target).all(|(row, c)| {
            let terms = || row.iter().zip(&qdd).map(|(a, x)| a * x);
            (c - terms().sum::<f64>()).abs() <= AGREED * (c.abs() + terms().map(f64::abs).sum::<f64>())
        })
    }

    /// Whether no pivot of a matrix is anywhere near zero.
    fn is_regular(&self, matrix: &[Rounded], n: usize) -> bool {
        let (elimination, rounding) = eliminate_rounded(matrix, n);
        elimination.smallest > rounding.max(1e-6)
    }

    /// `A q̈ + γ = 0`, as far as the state holds the constraints.
    pub(super) fn rows_of_motion(&self, a: &[Rounded], qdd: &[Rounded], bias: &[Rounded]) -> Result<(), Failure> {
        let product = times(a, qdd);
        // A row that depends on others where the constraints hold does so no better than the state holds them.
        let open = |k: usize| {
            let size: f64 = (0..self.n()).map(|i| (a[k * self.n() + i].value * qdd[i].value).abs()).sum();
            Rounded { value: 0.0, error: 10.0 * CLOSED * (size + bias[k].value.abs()) }
        };
        let zero: Vec<Rounded> = (0..bias.len()).map(open).collect();
        let rates = add(&product, bias);
        self.equal("A q̈ + γ = 0", &rates, &zero).or_else(|_| {
            let left: Vec<Rounded> =
                zero.iter().zip(self.left_by_state(a, qdd)).map(|(&zero, left)| zero + left).collect();
            let found = self.equal("A q̈ + γ = 0", &rates, &left);
            found.or_else(|failure| match self.holds_constraints() {
                true => Err(failure),
                false => self.equal("A q̈ + γ = 0", &rates, &self.left_by_solution(a, qdd, bias)),
            })
        })
    }

    /// What the solution accepts of rows that depend on others: off the constraints these contradict each other, by a
    /// part of the terms of a row and of those it depends on, here of the greatest.
    fn left_by_solution(&self, a: &[Rounded], qdd: &[Rounded], bias: &[Rounded]) -> Vec<Rounded> {
        let n = self.n();
        let scales = scales(n, &self.call(Kind::MassMatrix), a, self.vectors());
        let size = |(k, row): (usize, &[Rounded])| {
            let along: f64 = row.iter().zip(qdd).map(|(a, qdd)| (a.value * qdd.value).abs()).sum();
            scales.target(k, along + bias[k].value.abs())
        };
        let greatest = a.chunks(n).enumerate().map(size).fold(0.0, f64::max);
        let left = |k: usize| Rounded { value: 0.0, error: 2.0 * AGREEMENT * greatest / scales.target(k, 1.0) };
        (0..bias.len()).map(left).collect()
    }

    /// What places and velocities that hold the constraints to rounding leave of `A q̈ + γ`: rows that depend on others
    /// contradict them by that. An angle of hundreds of turns is held less well than a small one.
    fn left_by_state(&self, a: &[Rounded], qdd: &[Rounded]) -> Vec<Rounded> {
        let speed = self.state.qd.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        let blurred = |v: &Rounded, size: f64| Rounded { value: v.value, error: v.error + CLOSED * size };
        let qd = self.state.qd.iter().map(|v| blurred(v, speed)).collect();
        let moving = State { qd, ..self.state.clone() };
        let placed = State { q: self.state.q.iter().map(|v| blurred(v, v.value.abs())).collect(), ..moving.clone() };
        let accelerations = called(&self.interpreter, Kind::ForwardDynamics, &moving);
        let [slopes, bias] = [Kind::ConstraintJacobian, Kind::ConstraintBias].map(|kind| self.rows_at(kind, &placed));
        let n = self.n();
        let left = |(k, bias): (usize, &Rounded)| {
            let along = |i: usize| {
                a[k * n + i].value.abs() * accelerations[i].error + slopes[k * n + i].error * qdd[i].value.abs()
            };
            Rounded { value: 0.0, error: (0..n).map(along).sum::<f64>() + bias.error }
        };
        bias.iter().enumerate().map(left).collect()
    }
}
