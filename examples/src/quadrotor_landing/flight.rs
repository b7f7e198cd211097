//! One landing on a deck that moves exactly as it is to, with what is drawn of it.

use crate::Failure;
use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::{Deck, HeavingDeck, MovingDeck, Relative};
use mbs_landing::quadrotor::ground_effect::GroundEffect;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Controller, Landing, Plant};
use mbs_landing::quadrotor::lqr::{Lqr, Weights};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_platform::Superposition;
use mbs_runtime::State;

/// Cases of the thesis.
pub const CASES: [(&str, Heave<4>); 2] = [("I", Heave::CASE_I), ("II", Heave::CASE_II)];

/// Where the middle of the platform is \[m\].
pub const PLACE: [f64; 2] = [12.0, 7.0];

/// The deck of a case.
pub fn heaving(heave: Heave<4>) -> HeavingDeck<4> {
    HeavingDeck { heave, place: PLACE }
}

/// The name of the landing on a deck at sea.
pub const MARINE: &str = "marine";

/// The middle of the landing field in the axes of the platform \[m\]: beside its middle, and above it.
pub const FIELD: [f64; 3] = [0.4, -0.3, 0.3];

/// The deck at sea; with its base so far down that its mean height is zero.
pub fn marine(motion: Superposition<2>) -> MovingDeck<Superposition<2>> {
    over_base(motion, FIELD)
}

/// A platform at the place of the landing, with its base so far down that its mean height is zero.
pub fn over_base<const K: usize>(motion: Superposition<K>, point: [f64; 3]) -> MovingDeck<Superposition<K>> {
    let [x, y] = PLACE;
    MovingDeck { motion, base: [x, y, -motion.mean()[2]], point }
}

/// How it is flown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// By the exact equations under backstepping control.
    Exact,
    /// By those for small angles.
    SmallAngle,
    /// By a linear quadratic regulator.
    Lqr,
    /// Exact, with rotors that push harder near the deck.
    GroundEffect,
    /// Exact, without guidance: the deck's elevation is followed, down to [`TOLERANCE`] over it.
    Unguided,
}

impl Kind {
    /// Those of every deck; the unguided one is of the cases of the thesis.
    pub const ALL: [Self; 4] = [Self::Exact, Self::SmallAngle, Self::Lqr, Self::GroundEffect];

    /// In the JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::SmallAngle => "small_angle",
            Self::Lqr => "lqr",
            Self::GroundEffect => "ground_effect",
            Self::Unguided => "unguided",
        }
    }
}

/// Height over the deck at which an unguided descent has landed, assumed \[m\].
pub const TOLERANCE: f64 = 0.01;

/// The radius of the rotors, assumed \[m\]: a thrust coefficient of 0.011 at hover.
pub const ROTOR_RADIUS: f64 = 0.4;

/// What happens at one moment.
pub struct Moment {
    /// When \[s\].
    pub t: f64,
    /// The state of the vehicle.
    pub state: State<[f64; 6]>,
    /// Elevation of the deck \[m\].
    pub platform: f64,
    /// The vehicle as the deck sees it.
    pub relative: Relative,
    /// The thrust that is asked for \[N\].
    pub thrust: f64,
    /// Of each rotor, far from the ground \[N\].
    pub rotor_thrust: [f64; 4],
}

/// A landing, and the way to it.
pub struct Flight {
    /// Of the thesis, or [`MARINE`].
    pub case: &'static str,
    /// How it is flown.
    pub kind: Kind,
    /// Every 10 ms.
    pub moments: Vec<Moment>,
    /// Its end.
    pub touchdown: Touchdown,
}

/// One in this many moments that the simulation shows is kept.
pub const KEPT: usize = 5;

impl Flight {
    /// Flies from the initial state of the thesis to the touchdown.
    pub fn of<D: Deck>(case: &'static str, kind: Kind, deck: D) -> Result<Self, Failure> {
        let mut landing = Landing::on(if kind == Kind::SmallAngle { Plant::SmallAngle } else { Plant::Exact }, deck);
        match kind {
            Kind::Exact | Kind::SmallAngle => (),
            Kind::Lqr => {
                landing.controller = Controller::Lqr(Lqr::new(*landing.vehicle.params(), &Weights::default())?);
            }
            Kind::GroundEffect => landing.ground_effect = Some(GroundEffect::new(ROTOR_RADIUS)?),
            Kind::Unguided => (landing.approach, landing.touchdown_height) = (Approach::UNGUIDED, TOLERANCE),
        }
        let (mut moments, mut seen) = (Vec::new(), 0);
        let touchdown = landing.simulate(Landing::initial_state(), |t, state, command| {
            if seen % KEPT == 0 {
                let deck = landing.deck.at(t);
                moments.push(Moment {
                    t,
                    state: *state,
                    platform: deck.position[2],
                    relative: deck.relative(&state.q, &state.qd),
                    thrust: command.effort.thrust,
                    rotor_thrust: command.rotors.speed.map(|o| landing.vehicle.params().thrust_factor * o * o),
                });
            }
            seen += 1;
        })?;
        Ok(Flight { case, kind, moments, touchdown })
    }
}
