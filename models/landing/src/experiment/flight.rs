//! The flight that the flange is to repeat: the vehicle's six coordinates as smooth functions of time.
//!
//! ```
//! use mbs_landing::experiment::flight::Flight;
//! use mbs_landing::quadrotor::heave::Heave;
//! use mbs_landing::quadrotor::landing::{Landing, Plant};
//!
//! let flight = Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I))?;
//! // At the touchdown the vehicle is over the middle of the platform, at the height of its deck.
//! let [q, ..] = flight.at(flight.touchdown())?;
//! assert_eq!([q[0], q[1]], flight.platform);
//! assert!((q[2] - flight.heave.at(flight.touchdown()).value).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::vec::Vec;

use mbs_models::check::{self, Invalid, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::{Integrator, State};

use super::inbound::Inbound;
use crate::quadrotor::backstepping::Reference;
use crate::quadrotor::deck::{Deck, HeavingDeck};
use crate::quadrotor::heave::Heave;
use crate::quadrotor::landing::{Landing, MOST_MOMENTS};
use mbs_platform::Coordinates;
use mbs_platform::motion::hermite;

/// A landing, known at equal distances of time and interpolated between, and what it lands on.
///
/// Between two moments every coordinate is the polynomial of degree 5 that has its value, rate and acceleration at
/// both: what is interpolated is C² and off by `h⁶ q⁽⁶⁾/46080` at most.
///
/// A flight goes on for [`OVERRUN`] after the touchdown, as if there were no platform, so that an arm that lags behind
/// still knows where to go.
///
/// # Source
/// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, section II.6, for Hermite's
/// interpolation.
#[derive(Clone, Debug)]
pub struct Flight {
    /// At least two.
    moments: Vec<[Coordinates; 3]>,
    /// Between moments, positive \[s\].
    step: f64,
    touchdown: f64,
    /// Elevation of the platform.
    pub heave: Heave<4>,
    /// Where the platform is \[m\].
    pub platform: [f64; 2],
}

/// How long a flight is continued after the touchdown \[s\].
pub const OVERRUN: f64 = 0.5;

/// Between the moments of a [`Flight::guided`] \[s\].
const STEP: f64 = 0.002;

impl Flight {
    /// The simulated landing from this state: controller, rotors and drag included.
    ///
    /// # Errors
    /// [`Error`], as of [`Landing::simulate`].
    pub fn simulated(landing: &Landing, state: State<[f64; 6]>) -> Result<Self, Error> {
        let HeavingDeck { heave, place } = landing.deck;
        Self::flown(landing, state, heave, place)
    }

    /// The simulated landing of a vehicle that comes from afar, level and moving as guidance asks for at the beginning.
    ///
    /// # Errors
    /// [`Error`], as of [`Landing::simulate`]; of a number too where the way is not finite or takes no time.
    pub fn inbound(landing: &Landing<Inbound>) -> Result<Self, Error> {
        landing.deck.check()?;
        let Inbound { heave, place, .. } = landing.deck;
        Self::flown(landing, landing.deck.over_start(landing.approach.height), heave, place)
    }

    fn flown<D: Deck>(
        landing: &Landing<D>,
        state: State<[f64; 6]>,
        heave: Heave<4>,
        platform: [f64; 2],
    ) -> Result<Self, Error> {
        let motion = |t: f64, q: &[f64; 6], qd: &[f64; 6]| {
            landing.accelerations(t, q, qd, &landing.command(t, q, qd).rotors.speed)
        };
        let mut times = Vec::new();
        let mut moments = Vec::new();
        let end = landing.simulate(state, |t, state, _| {
            times.push(t);
            moments.push([state.q, state.qd, motion(t, &state.q, &state.qd)]);
        })?;
        let step = match times[..] {
            [first, second, ..] => second - first,
            // It is down before it is seen twice.
            _ => STEP,
        };
        let after: Vec<f64> =
            (moments.len()..).map(|k| k as f64 * step).take_while(|&t| t < end.time + OVERRUN + step).collect();
        let mut state = end.state;
        landing.integrator.sample(
            |t, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| *qdd = motion(t, q, qd),
            end.time,
            &after,
            &mut state,
            |t, state| moments.push([state.q, state.qd, motion(t, &state.q, &state.qd)]),
        )?;
        Self::of(moments, step, end.time, heave, platform)
    }

    /// The landing that the guidance asks for: level, over the middle of the platform, without any error.
    ///
    /// # Errors
    /// [`Failure::Invalid`] where the approach never comes down, `t_end` is no time, or the touchdown is more than
    /// [`MOST_MOMENTS`] moments of 2 ms away; [`Failure::NoContact`] where it is later than `t_end`.
    pub fn guided(landing: &Landing) -> Result<Self, Error> {
        let approach = &landing.approach;
        let positive = [
            ("approach.duration", approach.duration),
            ("approach.sink_rate", approach.sink_rate),
            ("approach.last_height", approach.last_height),
            ("t_end", landing.t_end),
        ];
        check::each(check::positive, positive)?;
        let touchdown = approach.duration + approach.last_height / approach.sink_rate;
        if touchdown > landing.t_end {
            return Err(Failure::NoContact { distance: approach.at(landing.t_end).value }.at_time(landing.t_end));
        }
        Must::BeAtMost(f64::from(MOST_MOMENTS)).check("number of moments", touchdown / STEP)?;
        let moment = |t: f64| {
            let [x, y, z] = landing.reference(t);
            let part = |of: fn(&Reference) -> f64| [of(&x), of(&y), of(&z), 0.0, 0.0, 0.0];
            [part(|r| r.value), part(|r| r.rate), part(|r| r.acceleration)]
        };
        let times = (0_u32..).map(|k| f64::from(k) * STEP).take_while(|&t| t < touchdown + OVERRUN + STEP);
        let HeavingDeck { heave, place } = landing.deck;
        Self::of(times.map(moment).collect(), STEP, touchdown, heave, place)
    }

    fn of(
        moments: Vec<[Coordinates; 3]>,
        step: f64,
        touchdown: f64,
        heave: Heave<4>,
        platform: [f64; 2],
    ) -> Result<Self, Error> {
        moments.as_flattened().iter().try_for_each(|&values| check::finite("a coordinate of the vehicle", values))?;
        Ok(Self { moments, step, touchdown, heave, platform })
    }

    /// When the vehicle touches down \[s\].
    #[must_use]
    pub fn touchdown(&self) -> f64 {
        self.touchdown
    }

    /// The last moment that is known \[s\], after the touchdown.
    #[must_use]
    pub fn end(&self) -> f64 {
        (self.moments.len() - 1) as f64 * self.step
    }

    /// Coordinates `(x, y, z, φ, θ, ψ)` of the vehicle, their rates and accelerations.
    ///
    /// # Errors
    /// [`Invalid`] for a time before the beginning or after the end of the flight, or NaN.
    pub fn at(&self, t: f64) -> Result<[Coordinates; 3], Invalid> {
        check::within("time", t, [0.0, self.end()])?;
        let k = ((t / self.step) as usize).min(self.moments.len() - 2);
        let (from, to) = (&self.moments[k], &self.moments[k + 1]);
        let s = t / self.step - k as f64;
        let mut found = [[0.0; 6]; 3];
        for i in 0..6 {
            let [value, rate, acceleration] =
                hermite([0, 1, 2].map(|order| from[order][i]), [0, 1, 2].map(|order| to[order][i]), self.step, s);
            (found[0][i], found[1][i], found[2][i]) = (value, rate, acceleration);
        }
        Ok(found)
    }
}
