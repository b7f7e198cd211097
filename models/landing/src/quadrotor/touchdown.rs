//! How a landing ended, and what is gathered on the way to it.

use mbs_models::Error;
use mbs_models::check::Must;
use mbs_platform::jacobian::angular_rates;
use mbs_runtime::{Scalar, State, to_matrix};
use nalgebra::Vector3;

use super::backstepping::{Command, nearest_turn};
use super::deck::{DeckState, Relative};
use super::landing::{Landing, attitude_told, finite_deck, upright};
use super::mixer::RotorSpeeds;

/// What is too much where the vehicle leaves the deck when it is to reach it \[m/s\]: the period does not resolve the
/// motion, or the velocity of the deck is not the rate of its position.
pub const LEAVING: &str = "velocity away from the deck at the touchdown";

/// How a landing ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touchdown {
    /// The time \[s\].
    pub time: f64,
    /// Of what touches, the mass centre or the lowest foot, along the normal of the deck against the point of it that
    /// is touched: negative, and `ż − ż_p` of the mass centre on a level deck \[m/s\].
    pub relative_velocity: f64,
    /// Distance from the point that was to be landed on, in the plane of the deck \[m\].
    pub horizontal_offset: f64,
    /// Of the mass centre over the deck, in its plane \[m/s\].
    pub horizontal_speed: f64,
    /// The vehicle as the deck sees it.
    pub relative: Relative,
    /// The state.
    pub state: State<[f64; 6]>,
    /// The deck.
    pub deck: DeckState,
    /// The greatest downward acceleration that the deck's point had on the way \[m/s²\]: where it is above g, nothing
    /// that only pushes upwards could follow.
    pub deck_fall: f64,
    /// The greatest roll and pitch on the way \[rad\].
    pub greatest_tilt: [f64; 2],
    /// When all three angles were within half a degree for good \[s\].
    pub settling_time: f64,
    /// The least and the greatest thrust that the controller asked for \[N\].
    pub thrust_range: [f64; 2],
    /// What the rotors spend on turning the air, `∫ Σ d Ω³ dt` \[J\]; under a controller in continuous time by the
    /// speeds at the end of every 2 ms.
    pub rotor_work: f64,
    /// The part of the moments looked at in which thrust, tilt or a rotor was at its limit.
    pub limited: f64,
}

/// The angle below which an attitude counts as settled \[rad\].
const SETTLED: f64 = 0.5 * core::f64::consts::PI / 180.0;

/// What a relative velocity may be above zero at a touchdown that grazes the deck \[m/s\].
const ROUNDING: f64 = 1e-9;

/// What is gathered on the way down.
pub(super) struct Way {
    greatest_tilt: [f64; 2],
    settling_time: f64,
    thrust_range: [f64; 2],
    /// The greatest downward acceleration of the deck.
    deck_fall: f64,
    /// `∫ Σ Ω³ dt`, until `time`.
    cubes: f64,
    time: f64,
    /// `Σ Ω³` from then on, where rotor speeds are held.
    held: f64,
    moments: u32,
    limited: u32,
}

impl Way {
    pub(super) fn new() -> Self {
        Way {
            greatest_tilt: [0.0; 2],
            settling_time: 0.0,
            thrust_range: [f64::INFINITY, f64::NEG_INFINITY],
            deck_fall: 0.0,
            cubes: 0.0,
            time: 0.0,
            held: 0.0,
            moments: 0,
            limited: 0,
        }
    }

    /// A moment under a controller in continuous time: its rotor speeds stand for those since the moment before.
    pub(super) fn reach(&mut self, t: f64, state: &State<[f64; 6]>, command: &Command, deck: &DeckState) {
        self.see(t, state, deck);
        self.ask(command);
        self.held = cubes(&command.rotors);
        self.spend_until(t);
    }

    /// A moment at which a sampled controller acts: its rotor speeds are held from then on.
    pub(super) fn hold(&mut self, t: f64, state: &State<[f64; 6]>, command: &Command, deck: &DeckState) {
        self.see(t, state, deck);
        self.ask(command);
        self.spend_until(t);
        self.held = cubes(&command.rotors);
    }

    /// The end of the way. What touches, at r from the mass centre, has against the deck the velocity of that and
    /// `(ω − ω_d) × r`.
    pub(super) fn touchdown<D>(
        mut self,
        landing: &Landing<D>,
        time: f64,
        state: State<[f64; 6]>,
        deck: DeckState,
    ) -> Result<Touchdown, Error> {
        let deck = upright(finite_deck(deck, time)?, time)?;
        attitude_told(&state, time)?;
        self.see(time, &state, &deck);
        self.spend_until(time);
        let length = |a: f64, b: f64| Scalar::sqrt(a * a + b * b);
        let relative = deck.relative(&state.q, &state.qd);
        let Relative { offset: [x, y, _], velocity: [xd, yd, zd], .. } = relative;
        let [.., roll, pitch, yaw] = state.qd;
        let turning = to_matrix(&angular_rates(&state.q)) * Vector3::new(roll, pitch, yaw);
        let around = (turning - Vector3::from(deck.angular_velocity)).cross(&landing.lever(&deck, &state.q));
        let relative_velocity = zd + to_matrix(&deck.rotation).column(2).dot(&around);
        Must::BeAtMost(ROUNDING).check(LEAVING, relative_velocity).map_err(|error| error.at_time(time))?;
        Ok(Touchdown {
            time,
            relative_velocity,
            horizontal_offset: length(x, y),
            horizontal_speed: length(xd, yd),
            relative,
            state,
            deck,
            deck_fall: self.deck_fall,
            greatest_tilt: self.greatest_tilt,
            settling_time: self.settling_time,
            thrust_range: self.thrust_range,
            rotor_work: landing.vehicle.params().drag_factor * self.cubes,
            limited: f64::from(self.limited) / f64::from(self.moments),
        })
    }

    fn see(&mut self, t: f64, state: &State<[f64; 6]>, deck: &DeckState) {
        self.deck_fall = self.deck_fall.max(-deck.acceleration[2]);
        let [.., roll, pitch, yaw] = state.q.map(|angle| nearest_turn(angle, 0.0).abs());
        self.greatest_tilt = [self.greatest_tilt[0].max(roll), self.greatest_tilt[1].max(pitch)];
        if [roll, pitch, yaw].iter().any(|&angle| angle > SETTLED) {
            self.settling_time = t;
        }
    }

    fn ask(&mut self, command: &Command) {
        let [least, greatest] = self.thrust_range;
        self.thrust_range = [least.min(command.effort.thrust), greatest.max(command.effort.thrust)];
        self.moments += 1;
        self.limited += u32::from(command.limited || command.rotors.saturated);
    }

    fn spend_until(&mut self, t: f64) {
        self.cubes += self.held * (t - self.time);
        self.time = t;
    }
}

/// `Σ Ω³` \[rad³/s³\].
fn cubes(rotors: &RotorSpeeds) -> f64 {
    rotors.speed.iter().map(|speed| speed * speed * speed).sum()
}
