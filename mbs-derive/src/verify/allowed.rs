//! Motions that the constraints allow: states that hold them, and what is conserved there.

use crate::catalogue::FunctionKind as Kind;
use crate::expr::{Dual, Rounded, Value, least_change, sparse};
use crate::interpret::State;
use crate::numeric::elimination::{ROUNDING, scales};

use super::Failure;
use super::claim::{CLOSED, Trial, called, doubles, doubles_of};
use super::linear::times;
use super::tested::Tested;
use super::witness::{exact, explicit_path, lift_all, path};

impl<V: Tested> Trial<'_, V> {
    /// First integrals keep their values along the motion with `u = 0`, `D = 0`; and with everything on, the energy
    /// balance `d/dt (q̇·∂L/∂q̇ − L) = q̇·(Q − ∂D/∂q̇ + Aᵀ λ) − ∂L/∂t`.
    pub(super) fn conserved(&self) -> Result<(), Failure> {
        let n = self.n();
        if V::CLAIMS_SYSTEMS && self.is_constrained() {
            let count = self.derivation.function(Kind::Conserved).map_or(0, |f| f.program.results.len());
            self.pass_over("conserved quantities", count)?;
            return self.pass_over("energy balance", 1);
        }
        // Constraint forces do no work along motions that the constraints allow.
        let free =
            State { u: vec![V::default(); self.state.u.len()], qd: V::allowed_velocities(self), ..self.state.clone() };
        let [force, h] = [Kind::GeneralizedForce, Kind::Bias].map(|kind| called(&self.interpreter, kind, &free));
        let unforced: Vec<V> = (0..n).map(|i| force[i] - h[i]).collect();
        let (qdd, multipliers) = self.accelerations(&unforced, &free);
        let free = State { qdd, ..free };
        if let Some(power) = V::power_left(self, &free, &multipliers) {
            let along = free.along(|symbol| path(&free, symbol));
            let rates = called(&self.dual, Kind::Conserved, &along);
            let moves = free.qdd.iter().all(|qdd| qdd.is_number());
            let rate = |v: &Dual<V>| if moves && has_no_rate(v) { power } else { v.derivative };
            let rates: Vec<V> = rates.iter().map(rate).collect();
            self.equal("conserved quantities", &rates, &vec![power; rates.len()])?;
        }

        let real = State { qdd: self.call(Kind::ForwardDynamics), ..self.state.clone() };
        let along = real.along(|symbol| path(&real, symbol));
        let momentum = called(&self.dual, Kind::Momentum, &along);
        if real.qdd.iter().all(|qdd| qdd.is_number()) && momentum.iter().any(has_no_rate) {
            return Ok(());
        }
        let parameters = lift_all(self.parameters);
        let [l, ..] = self.witness.energies(&along, &parameters);
        let by_time = real.along(|symbol| explicit_path(&real, symbol));
        let [l_t, ..] = self.witness.energies(&by_time, &parameters);
        let momentum_dot_velocity_rate: V =
            (0..n).map(|i| real.qdd[i] * momentum[i].value + real.qd[i] * momentum[i].derivative).sum();
        let (force, damping) = (self.call(Kind::GeneralizedForce), self.call(Kind::DissipationForce));
        let reaction = self.constraint_force();
        let power: V = (0..n).map(|i| real.qd[i] * (force[i] - damping[i] + reaction[i])).sum();
        self.equal("energy balance", &[momentum_dot_velocity_rate - l.derivative], &[power - l_t.derivative])
    }

    /// q̈ and λ of `M q̈ = f + Aᵀ λ`, `A q̈ + γ = 0` at a state with this one's coordinates.
    fn accelerations(&self, f: &[V], at: &State<V>) -> (Vec<V>, Vec<V>) {
        let (n, mass, a) = (self.n(), self.call(Kind::MassMatrix), self.rows(Kind::ConstraintJacobian));
        let triangle: Vec<V> = (0..n).flat_map(|i| mass[i * n..=i * n + i].to_vec()).collect();
        let bias = self.rows_at(Kind::ConstraintBias, at);
        let column: Vec<V> = f.iter().copied().chain(bias.iter().map(|&g| -g)).collect();
        let mut solution = V::constrained(n, triangle, a, self.vectors())(&column);
        let multipliers = solution.split_off(n);
        (solution, multipliers)
    }
}

impl Trial<'_> {
    /// What is left of the rates of constraints is no motion that they allow: there the forces do work.
    pub(super) fn power_left(&self, free: &State<Rounded>, multipliers: &[Rounded]) -> Option<Rounded> {
        let left = || self.rows_at(Kind::ConstraintRate, free);
        let work = || left().iter().zip(multipliers).map(|(v, l)| (v.value * l.value).abs()).sum();
        self.is_allowed(free).then(|| Rounded { value: 0.0, error: work() })
    }

    /// Whether velocities and accelerations satisfy the constraints: off them, more rows than coordinates may
    /// contradict each other.
    fn is_allowed(&self, state: &State<Rounded>) -> bool {
        let rates = self.rows_at(Kind::ConstraintRate, state);
        let product = times(&self.rows(Kind::ConstraintJacobian), &state.qdd);
        let bias = self.rows_at(Kind::ConstraintBias, state);
        let is_small = |v: &Rounded, size: f64| v.value.abs() <= 1e-9 * size + ROUNDING * v.error;
        let along = product.iter().zip(&bias).map(|(&a, &b)| (a + b, a.value.abs() + b.value.abs()));
        let speed = state.qd.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        state.qd.iter().chain(&state.qdd).all(|v| v.value.is_finite())
            && rates.iter().all(|rate| is_small(rate, speed))
            && along.into_iter().all(|(rate, size)| is_small(&rate, size))
    }

    /// Whether places and velocities satisfy the constraints.
    pub(super) fn holds_constraints(&self) -> bool {
        let small = |kind, size: f64| {
            let is_small = |v: &Rounded| v.value.abs() <= 1e-9 * size + ROUNDING * v.error;
            self.rows(kind).iter().all(is_small)
        };
        let greatest = |numbers: &[Rounded]| numbers.iter().map(|v| v.value.abs()).fold(0.0, f64::max);
        small(Kind::Constraint, greatest(&self.state.q)) && small(Kind::ConstraintRate, greatest(&self.state.qd))
    }

    /// The state moved onto the constraints: Newton's method on φ, each step the least in the scales of M and A, then
    /// the allowed velocities. `None` where it does not get there.
    pub(crate) fn consistent_state(&self) -> Option<State<Rounded>> {
        let (n, weights) = (self.n(), doubles_of(&self.weights()));
        let mut state = self.state.clone();
        for _ in 0..50 {
            let [value, a] = [Kind::Constraint, Kind::ConstraintJacobian].map(|kind| self.holonomic(kind, &state));
            let size = |row: &[Rounded]| row.iter().zip(&state.q).map(|(a, q)| (a.value * q.value).abs()).sum::<f64>();
            let is_closed = |(v, row): (&Rounded, &[Rounded])| v.value.abs() <= CLOSED * size(row) + ROUNDING * v.error;
            if value.iter().zip(a.chunks(n)).all(is_closed) {
                let trial = Trial::new(self.witness, self.derivation, &state, self.parameters);
                let qd = trial.allowed_velocities()?;
                return Some(exact(&doubles(&State { qd, ..state.clone() })));
            }
            let target: Vec<f64> = value.iter().map(|v| -v.value).collect();
            // Off the constraints a row is not yet small in its vector, and its equation is needed to get there.
            let each: Vec<usize> = (0..target.len()).collect();
            let step = self.least_change(&weights, &doubles_of(&a), &each, &target)?;
            state.q.iter_mut().zip(step).for_each(|(q, step)| *q = Rounded::exact(q.value + step));
        }
        None
    }

    /// The least x with `A x = target`, of these rows.
    fn least_change(&self, weights: &[f64], a: &[f64], vectors: &[usize], target: &[f64]) -> Option<Vec<f64>> {
        let known = self.derivation.elimination.as_ref().filter(|_| target.len() == self.derivation.constraints.len());
        match known {
            Some(_) => sparse::least_change(weights, a, target, known),
            None => least_change(weights, a, vectors, target),
        }
    }

    /// The rows of a function that belong to holonomic constraints.
    fn holonomic(&self, kind: Kind, state: &State<Rounded>) -> Vec<Rounded> {
        let values = self.rows_at(kind, state);
        let holonomic = &self.derivation.holonomic;
        if holonomic.iter().all(|is_holonomic| *is_holonomic) {
            return values;
        }
        let rows = values.chunks(values.len() / holonomic.len()).zip(holonomic);
        rows.filter(|(_, is_holonomic)| **is_holonomic).flat_map(|(row, _)| row.to_vec()).collect()
    }

    /// The diagonal of a metric of q̇ that follows the units, as the scales of the solution do: powers of two.
    pub(super) fn weights(&self) -> Vec<Rounded> {
        let n = self.n();
        if self.derivation.elimination.is_some() {
            // Every coordinate has inertia.
            let inertias = self.call(Kind::MassMatrix).into_iter().step_by(n + 1);
            return inertias.map(|m| Rounded::exact(2.0_f64.powi(m.exponent()))).collect();
        }
        let scales = scales(n, &self.call(Kind::MassMatrix), &self.rows(Kind::ConstraintJacobian), self.vectors());
        (0..n).map(|i| scales.weight(i)).collect()
    }

    /// The velocities nearest to the state's with `A q̇ + b = 0`; `None` where they are so large that energies
    /// overflow: where a slope has faded, as that of tanh far away, a row may be held by it alone at no other.
    pub(super) fn allowed_velocities(&self) -> Option<Vec<Rounded>> {
        if !self.is_constrained() {
            return Some(self.state.qd.clone());
        }
        let a = doubles_of(&self.rows(Kind::ConstraintJacobian));
        let target: Vec<f64> = self.rows(Kind::ConstraintRate).iter().map(|v| -v.value).collect();
        let change = self.least_change(&doubles_of(&self.weights()), &a, self.vectors(), &target)?;
        let is_moderate = change.iter().all(|change| change.abs() < 1e50);
        let changed = self.state.qd.iter().zip(change).map(|(qd, change)| Rounded::exact(qd.value + change));
        is_moderate.then(|| changed.collect())
    }
}

/// Whether a value has no rate by dual numbers: the slope of `x √x` at zero, which is 0, comes out as 0 · ∞.
fn has_no_rate<V: Tested>(rated: &Dual<V>) -> bool {
    rated.value.is_number() && !rated.derivative.is_number()
}
