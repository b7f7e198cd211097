//! The landing that is the shortest in time: its end is a variable, and what is kept is kept at every node.
//!
//! What it costs is time, and a little what the rotors do besides hovering and how fast the body turns, so that of
//! motions that take equally long one is the best.

use std::vec::Vec;

use mbs_models::Error;
use mbs_models::check::{Invalid, Must, finite, positive, within};
use mbs_runtime::State;
use nalgebra::SMatrix;

use super::limits::{Limits, Sight};
use super::problem::{Condition, Cost, FreeEnd, OptimalControl, Plan, Step};
use super::sequential::{Optimum, Options, Sequential};
use super::step::{InputVector, Prediction, ROTORS, STATES, StateVector};
use crate::quadrotor::deck::{Deck, HeavingDeck};

/// A landing that is to be as short as it can.
#[derive(Clone, Debug)]
pub struct ShortestLanding {
    /// The vehicle as the plan knows it.
    pub prediction: Prediction,
    /// What is kept.
    pub limits: Limits,
    /// What is landed on.
    pub deck: HeavingDeck<4>,
    /// N
    pub intervals: usize,
    /// The shortest and the longest time that it may take \[s\].
    pub duration: [f64; 2],
    /// What the rotors cost besides time, of the whole motion at twice the speed of hovering or none \[s\].
    pub effort: f64,
    /// What thrust is left aside at both ends but in the first fifth of a plan, in units of the weight: what is there
    /// for plans that are made later, with what has been felt until then.
    pub reserve: f64,
    /// When it begins \[s\].
    pub start: f64,
    /// Where.
    pub initial: StateVector,
}

/// A state as a vector `(q, q̇)`.
#[must_use]
pub fn vector(state: &State<[f64; 6]>) -> StateVector {
    StateVector::from_fn(|i, _| if i < 6 { state.q[i] } else { state.qd[i - 6] })
}

impl ShortestLanding {
    /// Of a vehicle in this state at t = 0, over 30 intervals.
    #[must_use]
    pub fn new(prediction: Prediction, limits: Limits, deck: HeavingDeck<4>, state: &State<[f64; 6]>) -> Self {
        ShortestLanding {
            prediction,
            limits,
            deck,
            intervals: 30,
            duration: [0.02, 20.0],
            effort: 0.02,
            reserve: 0.0,
            start: 0.0,
            initial: vector(state),
        }
    }

    /// Whether there can be a plan.
    ///
    /// # Errors
    /// [`Invalid`].
    pub fn check(&self) -> Result<(), Invalid> {
        self.limits.check()?;
        if self.intervals == 0 {
            return Err(Must::BePositive.broken_by("intervals", 0.0));
        }
        positive("duration[0]", self.duration[0])?;
        within("duration[1]", self.duration[1], [self.duration[0], f64::MAX])?;
        positive("effort", self.effort)?;
        let [least, greatest] = self.limits.thrust;
        within("reserve", self.reserve, [0.0, 0.5 * (greatest - least)])?;
        finite("start", self.start)?;
        self.initial.iter().try_for_each(|&x| finite("state", x))
    }

    /// Straight from where it is to the deck, upright, hovering, in a time \[s\].
    #[must_use]
    pub fn straight(&self, duration: f64) -> Plan<STATES, ROTORS> {
        let deck = self.deck.at(self.start + duration);
        let mut end = StateVector::zeros();
        end.fixed_rows_mut::<3>(0).copy_from_slice(&deck.position);
        end.fixed_rows_mut::<3>(6).copy_from_slice(&deck.velocity);
        let part = |node: usize| node as f64 / self.intervals as f64;
        Plan {
            start: self.start,
            duration,
            states: (0..=self.intervals).map(|node| self.initial + (end - self.initial) * part(node)).collect(),
            inputs: std::vec![InputVector::repeat(1.0); self.intervals],
        }
    }

    /// The shortest landing of those that are reached from straight ones in these times \[s\]: where the deck moves,
    /// there may be several that are shorter than what is near them.
    ///
    /// # Errors
    /// [`Error`] of the last time, if none leads to a landing; `Failure::Infeasible` where it breaks a limit.
    pub fn plan(&self, options: Options, durations: &[f64]) -> Result<Optimum<STATES, ROTORS>, Error> {
        self.check()?;
        durations.iter().try_for_each(|&duration| positive("durations", duration))?;
        let mut found: Result<Optimum<STATES, ROTORS>, Error> =
            Err(Must::BePositive.broken_by("durations.len()", 0.0).into());
        for &duration in durations {
            let tried = Sequential::new(options).solve(self, self.straight(duration));
            found = match (found, tried) {
                (Ok(best), Ok(tried)) if tried.plan.duration < best.plan.duration => Ok(tried),
                (Ok(best), _) => Ok(best),
                (Err(_), tried) => tried,
            };
        }
        found
    }
}

impl OptimalControl<STATES, ROTORS> for ShortestLanding {
    fn intervals(&self) -> usize {
        self.intervals
    }

    fn start(&self) -> f64 {
        self.start
    }

    fn initial_state(&self) -> StateVector {
        self.initial
    }

    fn step(&self, x: &StateVector, u: &InputVector, length: f64) -> Step<STATES, ROTORS> {
        self.prediction.step(x, u, length)
    }

    fn bounds(&self, node: usize) -> [InputVector; 2] {
        let [least, greatest] = self.limits.thrust;
        let reserve = if 5 * node < self.intervals { 0.0 } else { self.reserve };
        Limits { thrust: [least + reserve, greatest - reserve], ..self.limits }.inputs()
    }

    fn free_end(&self) -> Option<FreeEnd> {
        Some(FreeEnd { range: self.duration, weight: 1.0 })
    }

    fn cost(&self, _node: usize, _t: f64) -> Cost<STATES, ROTORS> {
        let each = self.effort / (self.intervals * ROTORS) as f64;
        let rates = StateVector::from_fn(|i, _| if i >= 9 { each } else { 0.0 });
        Cost {
            state: SMatrix::from_diagonal(&rates),
            target: StateVector::zeros(),
            input: SMatrix::identity() * each,
            input_target: InputVector::repeat(1.0),
        }
    }

    fn conditions(&self, node: usize, t: f64, x: &StateVector, rows: &mut Vec<Condition<STATES>>) {
        let sight = Sight::new(&self.prediction.vehicle, &self.limits, &self.deck, t, x);
        rows.push(sight.tilt());
        rows.push(sight.visibility());
        if node < self.intervals {
            rows.push(sight.height());
        } else {
            sight.touchdown(rows);
        }
    }
}
