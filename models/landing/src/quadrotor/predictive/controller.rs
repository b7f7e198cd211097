//! Nonlinear predictive control of the landing in real time: one quadratic program a sample.
//!
//! At every sample the horizon begins anew with the state that is measured. The plan of the sample before, moved on, is
//! the first guess (warm start), about which the problem is linearized once. Followed is a descent that slows down
//! towards the deck, from the height that the vehicle has:
//!
//! ```text
//! ḣ = −min(v, v₀ + κ h)
//! ```
//!
//! After its touchdown the descent goes on below the deck, where no condition holds any more: a plan that ended on the
//! deck would near it without reaching it. What comes after the horizon costs what the regulator about hovering has as
//! its least cost.
//!
//! What the vehicle feels beside its model, a wind or a mass that is not the one believed, is taken as a constant
//! specific force, and learnt from how far velocities are from what was predicted a sample ago.
//!
//! # Source
//! M. Diehl, H. G. Bock and J. P. Schlöder, *A real-time iteration scheme for nonlinear optimization in optimal
//! feedback control*, SIAM Journal on Control and Optimization 43:5, 2005; G. Pannocchia and J. B. Rawlings,
//! *Disturbance models for offset-free model-predictive control*, AIChE Journal 49:2, 2003.

use std::vec::Vec;

use mbs_models::Error;
use mbs_models::check::{Invalid, Must, finite, positive, within};
use mbs_models::quadrotor_euler::Params;
use mbs_runtime::control::discrete_lqr;
use mbs_runtime::{Scalar, State, to_matrix, to_rows};
use nalgebra::SMatrix;

use super::limits::{Limits, Sight};
use super::problem::{Condition, Cost, FreeEnd, OptimalControl, Plan, Step};
use super::sequential::{Options, Sequential};
use super::shortest::vector;
use super::step::{InputVector, Prediction, ROTORS, STATES, StateVector};
use crate::quadrotor::deck::{Deck, HeavingDeck};

/// The horizon, and what counts in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// From one sample to the next \[s\].
    pub period: f64,
    /// Its length \[s\].
    pub duration: f64,
    /// How many intervals it has.
    pub intervals: usize,
    /// Deviations that count as much as each other: of a position \[m\], a velocity \[m/s\], an angle \[rad\], the
    /// rate of an angle \[rad/s\], a rotor's speed by that of hovering.
    pub deviations: [f64; 5],
    /// What part of a velocity's error becomes a disturbance at a sample.
    pub learning: f64,
}

impl Default for Horizon {
    /// 100 samples a second, 1.5 s ahead in 15 intervals.
    fn default() -> Self {
        Horizon { period: 0.01, duration: 1.5, intervals: 15, deviations: [0.3, 0.5, 0.3, 1.0, 0.3], learning: 0.05 }
    }
}

/// The descent that is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    /// v, far up \[m/s\].
    pub speed: f64,
    /// v₀, at the deck \[m/s\].
    pub touchdown: f64,
    /// κ \[1/s\]
    pub slowing: f64,
    /// The slowing of the limit that is kept on the way, which is `v_max + κ_max h` \[1/s\].
    pub limit: f64,
}

impl Default for Descent {
    fn default() -> Self {
        Descent { speed: 3.0, touchdown: 0.2, slowing: 0.8, limit: 1.2 }
    }
}

impl Descent {
    /// The height after a time \[s\], in closed form, and its rate.
    #[must_use]
    pub fn after(&self, height: f64, time: f64) -> [f64; 2] {
        let Descent { speed, touchdown, slowing, .. } = *self;
        let knee = (speed - touchdown) / slowing;
        let straight = (height - knee) / speed;
        if time <= straight {
            return [height - speed * time, -speed];
        }
        let straight = straight.max(0.0);
        let (height, time) = (height - speed * straight, time - straight);
        // Below the deck it goes on as fast as it came to it.
        let until_touchdown = Scalar::ln((1.0 + slowing * height.max(0.0) / touchdown).max(1.0)) / slowing;
        if time >= until_touchdown {
            return [height.min(0.0) - touchdown * (time - until_touchdown), -touchdown];
        }
        let rate = (touchdown + slowing * height) * Scalar::exp(-slowing * time);
        [(rate - touchdown) / slowing, -rate]
    }
}

/// The problem of a sample.
struct Sample<'a> {
    controller: &'a PredictiveController,
    start: f64,
    initial: StateVector,
    /// Over the deck at the beginning \[m\].
    height: f64,
}

/// The controller.
#[derive(Clone, Debug)]
pub struct PredictiveController {
    /// The vehicle as it is believed to be, with what it has felt besides.
    pub prediction: Prediction,
    /// What is kept.
    pub limits: Limits,
    /// What is landed on; its motion is known ahead.
    pub deck: HeavingDeck<4>,
    /// The horizon.
    pub horizon: Horizon,
    /// What is followed.
    pub descent: Descent,
    /// What comes after the horizon costs half its quadratic form.
    last: SMatrix<f64, STATES, STATES>,
}

/// A controller at work: what it remembers from one sample to the next.
pub struct Memory {
    /// The plan.
    pub plan: Option<Plan<STATES, ROTORS>>,
    solver: Sequential,
    /// What velocities should be at the next sample.
    expected: Option<[f64; 3]>,
}

impl Default for Memory {
    fn default() -> Self {
        let options = Options { broken: 1e3, damping: 1e-6, accuracy: 1e-6, ..Options::default() };
        Memory { plan: None, solver: Sequential::new(options), expected: None }
    }
}

impl PredictiveController {
    /// Of a vehicle with these parameters.
    ///
    /// # Errors
    /// [`Error`] of a number, or where no regulator gives the cost of what comes after the horizon.
    pub fn new(
        params: Params<f64>,
        limits: Limits,
        deck: HeavingDeck<4>,
        horizon: Horizon,
        descent: Descent,
    ) -> Result<Self, Error> {
        limits.check()?;
        horizon.check()?;
        descent.check()?;
        let prediction = Prediction::new(params);
        let (state, input) = horizon.weights();
        let hover = prediction.step(
            &StateVector::zeros(),
            &InputVector::repeat(1.0),
            horizon.duration / horizon.intervals as f64,
        );
        let regulator =
            discrete_lqr(&to_rows(&hover.by_state), &to_rows(&hover.by_input), &to_rows(&state), &to_rows(&input))?;
        Ok(PredictiveController { prediction, limits, deck, horizon, descent, last: to_matrix(&regulator.cost) })
    }

    /// Rotor speeds \[rad/s\] from a moment on, for the state that is measured then.
    ///
    /// # Errors
    /// [`Error`].
    pub fn command(&mut self, memory: &mut Memory, t: f64, state: &State<[f64; 6]>) -> Result<[f64; ROTORS], Error> {
        finite("state.q", state.q)?;
        finite("state.qd", state.qd)?;
        let Horizon { period, duration, intervals, learning, .. } = self.horizon;
        if let Some(expected) = memory.expected {
            for i in 0..3 {
                self.prediction.disturbance[i] += learning * (state.qd[i] - expected[i]) / period;
            }
        }
        let initial = vector(state);
        let height = initial[2] - self.deck.at(t).position[2];
        let mut plan = match &memory.plan {
            Some(plan) => plan.moved(t, duration),
            None => Plan {
                start: t,
                duration,
                states: std::vec![initial; intervals + 1],
                inputs: std::vec![InputVector::repeat(1.0); intervals],
            },
        };
        let first = memory.plan.is_none();
        let problem = Sample { controller: self, start: t, initial, height };
        // Nothing is known of the first plan: a few programs more.
        for _ in 0..if first { 5 } else { 1 } {
            memory.solver.iterate(&problem, &mut plan)?;
        }
        let [least, greatest] = self.limits.inputs();
        // The interior-point method leaves its bounds by what it is accurate to.
        let input = plan.inputs[0].zip_zip_map(&least, &greatest, |u, least, greatest| u.clamp(least, greatest));
        let next = self.prediction.step(&initial, &input, period).end;
        memory.expected = Some([next[6], next[7], next[8]]);
        memory.plan = Some(plan);
        Ok((input * self.prediction.hover_speed()).into())
    }
}

impl Horizon {
    /// Whether it is one.
    ///
    /// # Errors
    /// [`Invalid`].
    pub fn check(&self) -> Result<(), Invalid> {
        positive("horizon.period", self.period)?;
        positive("horizon.duration", self.duration)?;
        positive("horizon.deviations", self.deviations)?;
        within("horizon.learning", self.learning, [0.0, 1.0])?;
        if self.intervals == 0 {
            return Err(Must::BePositive.broken_by("horizon.intervals", 0.0));
        }
        Ok(())
    }

    /// Q and R of an interval.
    fn weights(&self) -> (SMatrix<f64, STATES, STATES>, SMatrix<f64, ROTORS, ROTORS>) {
        let [position, velocity, angle, rate, rotor] = self.deviations.map(|deviation| 1.0 / (deviation * deviation));
        let state = StateVector::from_fn(|i, _| match i / 3 {
            0 => position,
            1 => angle,
            2 => velocity,
            _ => rate,
        });
        (SMatrix::from_diagonal(&state), SMatrix::identity() * rotor)
    }
}

impl Descent {
    /// Whether it is one that leads down and that the limit allows.
    ///
    /// # Errors
    /// [`Invalid`].
    pub fn check(&self) -> Result<(), Invalid> {
        positive("descent.touchdown", self.touchdown)?;
        positive("descent.slowing", self.slowing)?;
        within("descent.speed", self.speed, [self.touchdown, f64::MAX])?;
        within("descent.limit", self.limit, [self.slowing, f64::MAX])
    }
}

impl OptimalControl<STATES, ROTORS> for Sample<'_> {
    fn intervals(&self) -> usize {
        self.controller.horizon.intervals
    }

    fn start(&self) -> f64 {
        self.start
    }

    fn initial_state(&self) -> StateVector {
        self.initial
    }

    fn step(&self, x: &StateVector, u: &InputVector, length: f64) -> Step<STATES, ROTORS> {
        self.controller.prediction.step(x, u, length)
    }

    fn bounds(&self, _node: usize) -> [InputVector; 2] {
        self.controller.limits.inputs()
    }

    fn free_end(&self) -> Option<FreeEnd> {
        None
    }

    fn cost(&self, node: usize, t: f64) -> Cost<STATES, ROTORS> {
        let (state, input) = self.controller.horizon.weights();
        let deck = self.controller.deck.at(t);
        let [height, rate] = self.controller.descent.after(self.height, t - self.start);
        let mut target = StateVector::zeros();
        target.fixed_rows_mut::<3>(0).copy_from_slice(&deck.position);
        target.fixed_rows_mut::<3>(6).copy_from_slice(&deck.velocity);
        target[2] += height;
        target[8] += rate;
        let params = self.controller.prediction.vehicle.params();
        let lift = (1.0 + (deck.acceleration[2] - self.controller.prediction.disturbance[2]) / params.g).max(0.0);
        let last = node == self.controller.horizon.intervals;
        Cost {
            state: if last { self.controller.last } else { state },
            target,
            input,
            input_target: InputVector::repeat(Scalar::sqrt(lift)),
        }
    }

    fn conditions(&self, _node: usize, t: f64, x: &StateVector, rows: &mut Vec<Condition<STATES>>) {
        let PredictiveController { prediction, limits, deck, descent, .. } = self.controller;
        let sight = Sight::new(&prediction.vehicle, limits, deck, t, x);
        rows.push(sight.tilt());
        // On the deck and after it there is none of the others.
        let over = descent.after(self.height, t - self.start)[0] > 0.0;
        let held = |row: Condition<STATES>| if over { row } else { row.vacant() };
        rows.push(held(sight.visibility()));
        rows.push(held(sight.height()));
        rows.push(held(sight.sink_rate(descent.limit)));
    }
}
