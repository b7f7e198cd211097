//! Landings by a plan as they are flown: a vehicle that need not be the one planned for, and a pilot who is asked once
//! a period and whose rotor speeds are held.

use std::vec::Vec;

use mbs_models::Error;
use mbs_runtime::State;

use super::limits::{Limits, Sight};
use super::problem::Plan;
use super::sequential::{Optimum, Options, Sequential};
use super::shortest::{ShortestLanding, vector};
use super::step::{InputVector, ROTORS, STATES};
use crate::quadrotor::backstepping::Command;
use crate::quadrotor::deck::{Deck, DeckState, HeavingDeck};
use crate::quadrotor::landing::{Landing, attitude_told, finite_deck};
use crate::quadrotor::mixer::{Mixer, RotorSpeeds};
use crate::quadrotor::touchdown::{Touchdown, Way};
use crate::quadrotor::zero_order_hold::ZeroOrderHold;

/// A moment of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time \[s\].
    pub time: f64,
    /// The vehicle.
    pub state: State<[f64; 6]>,
    /// The deck.
    pub deck: DeckState,
    /// Speeds of its rotors from now on \[rad/s\].
    pub speeds: [f64; ROTORS],
    /// Between the body's axis and the vertical \[rad\].
    pub tilt: f64,
    /// How far the edge of the mark is within the cone of the camera, negative beyond \[m\].
    pub visibility: f64,
}

/// How often a flight is looked at between two moments at which the pilot acts.
pub const LOOKS: usize = 5;

/// Flies until the touchdown: a vehicle, its wind and its deck are those of a [`Landing`], whose controller does not
/// act. `pilot` gives rotor speeds \[rad/s\] once a period \[s\]; the motion is integrated by [`LOOKS`] steps of RK4 a
/// period.
///
/// # Errors
/// [`Error`], those of the pilot and `Landing`.
pub fn fly(
    landing: &Landing<HeavingDeck<4>>,
    limits: &Limits,
    state: State<[f64; 6]>,
    period: f64,
    mut pilot: impl FnMut(f64, &State<[f64; 6]>) -> Result<[f64; ROTORS], Error>,
) -> Result<(Touchdown, Vec<Moment>), Error> {
    landing.check(&state, period)?;
    limits.check()?;
    let mixer = Mixer::new(landing.vehicle.params());
    let (mut way, mut moments, mut speeds) = (Way::new(), Vec::new(), [0.0; ROTORS]);
    let hold = |time: f64, state: &State<[f64; 6]>| {
        attitude_told(state, time)?;
        let deck = finite_deck(landing.deck.at(time), time)?;
        if moments.len() % LOOKS == 0 {
            speeds = pilot(time, state)?;
        }
        let x = vector(state);
        let sight = Sight::new(&landing.vehicle, limits, &landing.deck, time, &x);
        let command = held(&mixer, speeds);
        way.hold(time, state, &command, &deck);
        let (tilt, visibility) = (sight.tilt_angle(), sight.visibility().value);
        moments.push(Moment { time, state: *state, deck, speeds, tilt, visibility });
        Ok(speeds)
    };
    let run = ZeroOrderHold {
        period: period / LOOKS as f64,
        t_end: landing.t_end,
        hold,
        accelerations: |speeds: &[f64; ROTORS], t: f64, q: &[f64; 6], qd: &[f64; 6]| {
            landing.accelerations(t, q, qd, speeds)
        },
        height: |t: f64, state: &State<[f64; 6]>| landing.above(t, &state.q),
    };
    let (time, state) = run.until_touchdown(state)?;
    let deck = landing.deck.at(time);
    Ok((way.touchdown(landing, time, state, deck)?, moments))
}

fn held(mixer: &Mixer, speed: [f64; ROTORS]) -> Command {
    let squares = speed.map(|speed| speed * speed);
    let least_square = squares.into_iter().fold(f64::INFINITY, f64::min);
    let greatest = speed.into_iter().fold(0.0, f64::max);
    Command {
        effort: mixer.effort(&speed),
        limited: false,
        rotors: RotorSpeeds { speed, least_square, greatest, saturated: false },
    }
}

/// Plans the shortest landing anew while it is flown.
///
/// A plan takes time to be made. So it begins at the next moment of planning, in the state that the vehicle will have
/// then, as the model says; until then the plan before is flown.
pub struct Replanning {
    /// The landing as the plan knows it; its beginning moves on.
    pub landing: ShortestLanding,
    /// From one plan to the next \[s\].
    pub every: f64,
    /// Programs a plan at most.
    pub programs: usize,
    /// What part of a velocity's error becomes a disturbance at a planning.
    pub learning: f64,
    solver: Sequential,
    plan: Plan<STATES, ROTORS>,
    next: Option<Plan<STATES, ROTORS>>,
    planned: u32,
    /// What velocities should be at the next planning.
    expected: Option<[f64; 3]>,
}

impl Replanning {
    /// From a first plan on.
    #[must_use]
    pub fn new(landing: ShortestLanding, first: Plan<STATES, ROTORS>, every: f64, programs: usize) -> Self {
        // In flight a limit may be broken already: of that nothing is to be seen but in what is flown.
        let solver = Sequential::new(Options { damping: 1e-3, accuracy: 1e-7, tolerance: 1e-4, ..Options::default() });
        let (next, expected) = (None, None);
        Replanning { landing, every, programs, learning: 1.0, solver, plan: first, next, planned: 0, expected }
    }

    /// Whether a plan is due: what was planned before takes over, and the next is made, unless the flight ends before.
    ///
    /// # Errors
    /// [`Error`].
    pub fn replan(&mut self, t: f64, state: &State<[f64; 6]>) -> Result<Option<Optimum<STATES, ROTORS>>, Error> {
        // Moments are multiples of a period, up to rounding.
        if t < f64::from(self.planned) * self.every - 1e-9 {
            return Ok(None);
        }
        self.planned += 1;
        if let Some(next) = self.next.take() {
            self.plan = next;
        }
        if let Some(expected) = self.expected {
            for i in 0..3 {
                self.landing.prediction.disturbance[i] += self.learning * (state.qd[i] - expected[i]) / self.every;
            }
        }
        let (begin, end) = (t + self.every, self.plan.start + self.plan.duration);
        let (mut at, mut x) = (t, vector(state));
        while at < begin - 1e-9 {
            let until = self.plan.change_after(at).min(begin);
            x = self.landing.prediction.step(&x, &self.input(at, until - at), until - at).end;
            at = until;
        }
        self.expected = Some([x[6], x[7], x[8]]);
        if end - begin < self.every {
            return Ok(None);
        }
        (self.landing.start, self.landing.initial) = (begin, x);
        let guess = self.plan.moved(begin, end - begin);
        let found = self.solver.improve(&self.landing, guess, self.programs)?;
        self.next = Some(found.plan.clone());
        Ok(Some(found))
    }

    /// Rotor speeds \[rad/s\] from a time on for a period \[s\].
    #[must_use]
    pub fn speeds(&self, t: f64, period: f64) -> [f64; ROTORS] {
        (self.input(t, period) * self.landing.prediction.hover_speed()).into()
    }

    /// That of the plan; after its end the one that keeps the velocity against the deck.
    fn input(&self, t: f64, period: f64) -> InputVector {
        let [least, greatest] = self.landing.limits.inputs();
        let input = if t < self.plan.start + self.plan.duration {
            self.plan.mean_input(t, period)
        } else {
            let prediction = &self.landing.prediction;
            let follow = self.landing.deck.at(t).acceleration[2] - prediction.disturbance[2];
            InputVector::repeat((1.0 + follow / prediction.vehicle.params().g).max(0.0).sqrt())
        };
        input.zip_zip_map(&least, &greatest, |u, least, greatest| u.clamp(least, greatest))
    }
}
