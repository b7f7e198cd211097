//! Landing on a deck that moves: guidance, and simulation up to the touchdown.
//!
//! The vehicle is led down straight over the point of the deck that is to be landed on, with the deck's yaw; it touches down
//! where its mass centre comes to the plane of the deck.

use core::fmt;
use core::ops::ControlFlow;

use mbs_runtime::{Dop853, Event, IntegrationError, Integrator, Scalar, State, Step};

use super::backstepping::{Backstepping, Command, Reference};
use super::deck::{Deck, DeckState, HeavingDeck, Relative};
use super::ground_effect::GroundEffect;
use super::heave::Heave;
use super::lqr::Lqr;
use super::small_angle;
use crate::platform::PoseError;
use crate::platform::limits::InvalidLimits;
use crate::quadrotor_euler::{Params, QuadrotorEuler};

/// Height over the platform against time: a quintic down to a last height, then a steady sink rate. Assumed; the thesis prints none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Height at the beginning \[m\], where it rests over the platform.
    pub height: f64,
    /// Height at which the quintic ends \[m\].
    pub last_height: f64,
    /// Sink rate from then on, positive \[m/s\].
    pub sink_rate: f64,
    /// How long the quintic takes, positive \[s\].
    pub duration: f64,
}

impl Default for Approach {
    fn default() -> Self {
        Approach { height: 10.0, last_height: 0.25, sink_rate: 0.2, duration: 12.0 }
    }
}

impl Approach {
    /// Height over the platform at t.
    #[must_use]
    pub fn at(&self, t: f64) -> Reference {
        let Approach { height, last_height, sink_rate, duration: end } = *self;
        if t >= end {
            return Reference { value: last_height - sink_rate * (t - end), rate: -sink_rate, acceleration: 0.0 };
        }
        // s³ (a + b s + c s²) of the fall and its rate at the end, at rest before; accelerations vanish at both ends.
        let (s, fall, rate) = (t / end, last_height - height, -sink_rate * end);
        let (a, b, c) = (10.0 * fall - 4.0 * rate, -15.0 * fall + 7.0 * rate, 6.0 * fall - 3.0 * rate);
        let s2 = s * s;
        Reference {
            value: height + s2 * s * (a + s * (b + s * c)),
            rate: s2 * (3.0 * a + s * (4.0 * b + s * 5.0 * c)) / end,
            acceleration: s * (6.0 * a + s * (12.0 * b + s * 20.0 * c)) / (end * end),
        }
    }
}

/// The equations that move the quadrotor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// The generated ones.
    Exact,
    /// Those for small angles, (5.8).
    SmallAngle,
}

/// Who flies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is no heap
pub enum Controller {
    /// Backstepping in six channels.
    Backstepping(Backstepping),
    /// A regulator about the flat trajectory.
    Lqr(Lqr),
}

impl Controller {
    /// The command at a state that is to follow a position and a yaw \[rad\].
    #[must_use]
    pub fn command(&self, position: &[Reference; 3], heading: Reference, q: &[f64; 6], qd: &[f64; 6]) -> Command {
        match self {
            Controller::Backstepping(controller) => controller.command(position, heading, q, qd),
            Controller::Lqr(controller) => controller.command(position, heading, q, qd),
        }
    }
}

/// A landing that is to be simulated.
#[derive(Clone, Debug)]
pub struct Landing<D = HeavingDeck<4>> {
    /// The vehicle as it is.
    pub vehicle: QuadrotorEuler<f64>,
    /// Which equations move it.
    pub plant: Plant,
    /// Its controller.
    pub controller: Controller,
    /// Height over the platform that it is to keep.
    pub approach: Approach,
    /// What it lands on.
    pub deck: D,
    /// Velocity of the air \[m/s\].
    pub wind: [f64; 3],
    /// How much harder the rotors push near the deck, if that counts; the controller does not know of it.
    pub ground_effect: Option<GroundEffect>,
    /// When it is given up \[s\].
    pub t_end: f64,
    /// The integrator.
    pub integrator: Dop853,
}

/// How a landing ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touchdown {
    /// \[s\]
    pub time: f64,
    /// Along the normal of the deck, against the point of it that is touched: `ż − ż_p` on a level one, negative \[m/s\].
    pub relative_velocity: f64,
    /// Distance from the point that was to be landed on, in the plane of the deck \[m\].
    pub horizontal_offset: f64,
    /// Of the vehicle over the deck, in its plane \[m/s\].
    pub horizontal_speed: f64,
    /// The vehicle as the deck sees it.
    pub relative: Relative,
    /// The state.
    pub state: State<[f64; 6]>,
    /// The deck.
    pub deck: DeckState,
    /// The greatest downward acceleration that the deck's point had on the way \[m/s²\]: where it is above g, nothing that only
    /// pushes upwards could follow.
    pub deck_fall: f64,
    /// The greatest roll and pitch on the way \[rad\].
    pub greatest_tilt: [f64; 2],
    /// When all three angles were within half a degree for good \[s\].
    pub settling_time: f64,
    /// The least and the greatest thrust that the controller asked for \[N\].
    pub thrust_range: [f64; 2],
    /// What the rotors spend on turning the air, `∫ Σ d Ω³ dt` \[J\].
    pub rotor_work: f64,
    /// The part of the time in which thrust, tilt or a rotor was at its limit.
    pub limited: f64,
}

/// Why there is no touchdown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LandingError {
    /// What must be positive is not (or is no number, or infinite).
    NotPositive {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// What must be a finite number is none.
    NotFinite {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// The vehicle does not stand over the platform at the beginning.
    NotAbove {
        /// Over the deck \[m\].
        height: f64,
    },
    /// A coordinate of the deck is infinite or NaN.
    Deck {
        /// When \[s\].
        time: f64,
    },
    /// It has not touched down in time.
    NoTouchdown {
        /// When it was given up \[s\].
        time: f64,
        /// Over the deck then \[m\].
        height: f64,
    },
    /// A sensor gave a value that is no number.
    Sensor {
        /// When \[s\].
        time: f64,
    },
    /// The integration failed.
    Integration(IntegrationError),
    /// The legs of a driven platform cannot hold it.
    Platform {
        /// When \[s\].
        time: f64,
        /// Why.
        error: PoseError,
    },
    /// Nothing can keep the limits of a driven platform.
    Limits(InvalidLimits),
}

impl fmt::Display for LandingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LandingError::NotPositive { parameter, value } => write!(f, "{parameter} must be positive, it is {value}"),
            LandingError::NotFinite { parameter, value } => write!(f, "{parameter} must be finite, it is {value}"),
            LandingError::NotAbove { height } => write!(f, "the vehicle begins {height} m over the platform"),
            LandingError::NoTouchdown { time, height } => {
                write!(f, "no touchdown until t = {time} s, {height} m over the platform")
            }
            LandingError::Sensor { time } => write!(f, "a sensor gives no number at t = {time} s"),
            LandingError::Deck { time } => write!(f, "a coordinate of the deck is no number at t = {time} s"),
            LandingError::Integration(error) => error.fmt(f),
            LandingError::Platform { time, error } => write!(f, "the platform at t = {time} s: {error}"),
            LandingError::Limits(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for LandingError {}

impl From<IntegrationError> for LandingError {
    fn from(error: IntegrationError) -> Self {
        LandingError::Integration(error)
    }
}

/// The angle below which an attitude counts as settled \[rad\].
const SETTLED: f64 = 0.5 * core::f64::consts::PI / 180.0;

/// How often the way is looked at for its extremes \[s\].
const SAMPLING: f64 = 0.002;

impl Landing {
    /// A case of the thesis: the vehicle of the declared parameters, at a level platform at (12 m, 7 m).
    #[must_use]
    pub fn new(plant: Plant, heave: Heave<4>) -> Self {
        Landing::on(plant, HeavingDeck { heave, place: [12.0, 7.0] })
    }

    /// The state in which the cases of the thesis begin: 10 m up, tilted by 3°, 8° and 5°, at rest.
    #[must_use]
    pub fn initial_state() -> State<[f64; 6]> {
        let [roll, pitch, yaw] = [3.0_f64, 8.0, 5.0].map(f64::to_radians);
        State::new([12.0, 7.0, 10.0, roll, pitch, yaw], [0.0; 6])
    }
}

impl<D> Landing<D> {
    /// Of the vehicle of the declared parameters on a deck, under backstepping control, in calm air.
    #[must_use]
    pub fn on(plant: Plant, deck: D) -> Self {
        let vehicle = QuadrotorEuler::default();
        Landing {
            controller: Controller::Backstepping(Backstepping::new(*vehicle.params())),
            vehicle,
            plant,
            approach: Approach::default(),
            deck,
            wind: [0.0; 3],
            ground_effect: None,
            t_end: 60.0,
            integrator: Dop853::new(1e-11, 1e-12),
        }
    }

    /// What the controller does over a deck.
    pub(super) fn command_over(&self, deck: &DeckState, t: f64, q: &[f64; 6], qd: &[f64; 6]) -> Command {
        self.controller.command(&self.reference_over(deck, t), deck.heading, q, qd)
    }

    fn reference_over(&self, deck: &DeckState, t: f64) -> [Reference; 3] {
        let [x, y, z] = core::array::from_fn(|axis| Reference {
            value: deck.position[axis],
            rate: deck.velocity[axis],
            acceleration: deck.acceleration[axis],
        });
        let height = self.approach.at(t);
        let vertical = Reference {
            value: z.value + height.value,
            rate: z.rate + height.rate,
            acceleration: z.acceleration + height.acceleration,
        };
        [x, y, vertical]
    }

    /// `q̈` at these rotor speeds \[rad/s\] and this height over the deck \[m\], which is asked for where it counts.
    pub(super) fn accelerations_at(
        &self,
        height: impl FnOnce() -> f64,
        q: &[f64; 6],
        qd: &[f64; 6],
        speeds: &[f64; 4],
    ) -> [f64; 6] {
        let Some(effect) = &self.ground_effect else {
            return self.accelerations_of(&self.vehicle, q, qd, speeds);
        };
        let params = *self.vehicle.params();
        let thrust_factor = effect.factor(height()) * params.thrust_factor;
        self.accelerations_of(&QuadrotorEuler::new(Params { thrust_factor, ..params }), q, qd, speeds)
    }

    fn accelerations_of(
        &self,
        vehicle: &QuadrotorEuler<f64>,
        q: &[f64; 6],
        qd: &[f64; 6],
        speeds: &[f64; 4],
    ) -> [f64; 6] {
        match self.plant {
            Plant::Exact => vehicle.forward_dynamics(&self.wind.map(|v| [v, 0.0, 0.0]), q, qd, speeds),
            Plant::SmallAngle => small_angle::accelerations(vehicle.params(), &self.wind, q, qd, speeds),
        }
    }

    pub(super) fn touchdown(
        &self,
        time: f64,
        state: State<[f64; 6]>,
        deck: DeckState,
        way: &Way,
    ) -> Result<Touchdown, LandingError> {
        if !deck.is_finite() {
            return Err(LandingError::Deck { time });
        }
        let length = |a: f64, b: f64| Scalar::sqrt(a * a + b * b);
        let relative = deck.relative(&state.q, &state.qd);
        let Relative { offset: [x, y, _], velocity: [xd, yd, zd], .. } = relative;
        Ok(Touchdown {
            time,
            relative_velocity: zd,
            horizontal_offset: length(x, y),
            horizontal_speed: length(xd, yd),
            relative,
            state,
            deck,
            deck_fall: way.deck_fall,
            greatest_tilt: way.greatest_tilt,
            settling_time: way.settling_time,
            thrust_range: way.thrust_range,
            rotor_work: self.vehicle.params().drag_factor * way.cubes,
            limited: f64::from(way.limited) / f64::from(way.samples),
        })
    }
}

impl<D: Deck> Landing<D> {
    /// What the position is to follow: the point of the deck, and the approach straight over it.
    #[must_use]
    pub fn reference(&self, t: f64) -> [Reference; 3] {
        self.reference_over(&self.deck.at(t), t)
    }

    /// What the controller does at a state.
    #[must_use]
    pub fn command(&self, t: f64, q: &[f64; 6], qd: &[f64; 6]) -> Command {
        self.command_over(&self.deck.at(t), t, q, qd)
    }

    /// `q̈` at these rotor speeds \[rad/s\].
    #[must_use]
    pub fn accelerations(&self, t: f64, q: &[f64; 6], qd: &[f64; 6], speeds: &[f64; 4]) -> [f64; 6] {
        self.accelerations_at(|| self.height(t, q), q, qd, speeds)
    }

    /// Over the deck \[m\].
    pub(super) fn height(&self, t: f64, q: &[f64; 6]) -> f64 {
        self.deck.at(t).height(&[q[0], q[1], q[2]])
    }

    /// Simulates from a state at t = 0 up to the touchdown, found on the dense output.
    ///
    /// The controller acts in continuous time. `observer` sees times, states and commands every 2 ms.
    ///
    /// # Errors
    /// [`LandingError`].
    pub fn simulate(
        &self,
        mut state: State<[f64; 6]>,
        mut observer: impl FnMut(f64, &State<[f64; 6]>, &Command),
    ) -> Result<Touchdown, LandingError> {
        self.check(&state)?;
        let height = |t: f64, state: &State<[f64; 6]>| self.height(t, &state.q);
        let mut way = Way::new();
        let mut events = [Event::new(&height).falling().terminal()];
        let mut sample = state;
        let mut next = 0_u64;
        let look = |step: &mut dyn Step<[f64; 6]>| {
            while next as f64 * SAMPLING <= step.time() {
                let t = next as f64 * SAMPLING;
                if step.interpolate(t, &mut sample).is_err() {
                    return ControlFlow::Break(step.time());
                }
                let deck = self.deck.at(t);
                let command = self.command_over(&deck, t, &sample.q, &sample.qd);
                way.add(t, &sample, &command, &deck);
                observer(t, &sample, &command);
                next += 1;
            }
            ControlFlow::Continue(())
        };
        let accelerations = |t: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
            *qdd = self.accelerations(t, q, qd, &self.command(t, q, qd).rotors.speed);
        };
        let summary =
            self.integrator.integrate_with_events(accelerations, 0.0, self.t_end, &mut state, &mut events, look)?;
        if !summary.stopped {
            return Err(LandingError::NoTouchdown { time: summary.time, height: height(summary.time, &state) });
        }
        let deck = self.deck.at(summary.time);
        way.add(summary.time, &state, &self.command_over(&deck, summary.time, &state.q, &state.qd), &deck);
        self.touchdown(summary.time, state, deck, &way)
    }

    /// Whether this can be a landing, from this state.
    pub(super) fn check(&self, state: &State<[f64; 6]>) -> Result<(), LandingError> {
        let params = self.vehicle.params();
        let [x, y, z] = params.inertias;
        let positive = [
            ("m", params.m),
            ("g", params.g),
            ("inertias[0]", x),
            ("inertias[1]", y),
            ("inertias[2]", z),
            ("arm", params.arm),
            ("thrust_factor", params.thrust_factor),
            ("drag_factor", params.drag_factor),
            ("approach.duration", self.approach.duration),
            ("approach.sink_rate", self.approach.sink_rate),
            ("t_end", self.t_end),
        ];
        let bad = positive.into_iter().find(|&(_, value)| !(value > 0.0 && value.is_finite()));
        if let Some((parameter, value)) = bad {
            return Err(LandingError::NotPositive { parameter, value });
        }
        let finite = [
            ("rotor_inertia", params.rotor_inertia),
            ("approach.height", self.approach.height),
            ("approach.last_height", self.approach.last_height),
            ("wind[0]", self.wind[0]),
            ("wind[1]", self.wind[1]),
            ("wind[2]", self.wind[2]),
        ];
        if let Some((parameter, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(LandingError::NotFinite { parameter, value });
        }
        let deck = self.deck.at(0.0);
        if !deck.is_finite() {
            return Err(LandingError::Deck { time: 0.0 });
        }
        let height = deck.height(&[state.q[0], state.q[1], state.q[2]]);
        if height.is_nan() || height <= 0.0 { Err(LandingError::NotAbove { height }) } else { Ok(()) }
    }
}

/// Extremes on the way down.
pub(super) struct Way {
    greatest_tilt: [f64; 2],
    settling_time: f64,
    thrust_range: [f64; 2],
    /// `∫ Σ Ω³ dt`, until `time`.
    cubes: f64,
    time: f64,
    samples: u32,
    limited: u32,
    /// The greatest downward acceleration of the deck.
    deck_fall: f64,
}

impl Way {
    pub(super) fn new() -> Self {
        Way {
            greatest_tilt: [0.0; 2],
            settling_time: 0.0,
            thrust_range: [f64::INFINITY, f64::NEG_INFINITY],
            cubes: 0.0,
            time: 0.0,
            samples: 0,
            limited: 0,
            deck_fall: 0.0,
        }
    }

    pub(super) fn add(&mut self, t: f64, state: &State<[f64; 6]>, command: &Command, deck: &DeckState) {
        self.deck_fall = self.deck_fall.max(-deck.acceleration[2]);
        let [.., roll, pitch, yaw] = state.q.map(f64::abs);
        self.greatest_tilt = [self.greatest_tilt[0].max(roll), self.greatest_tilt[1].max(pitch)];
        if [roll, pitch, yaw].iter().any(|&angle| angle > SETTLED) {
            self.settling_time = t;
        }
        let [least, greatest] = self.thrust_range;
        self.thrust_range = [least.min(command.effort.thrust), greatest.max(command.effort.thrust)];
        let cubes: f64 = command.rotors.speed.iter().map(|speed| speed * speed * speed).sum();
        self.cubes += cubes * (t - self.time);
        self.time = t;
        self.samples += 1;
        self.limited += u32::from(command.limited || command.rotors.saturated);
    }
}
