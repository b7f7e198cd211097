//! Landing on a deck that moves: guidance, and simulation up to the touchdown.
//!
//! The vehicle is led down straight over the point of the deck that is to be landed on, with the deck's yaw; it touches
//! down where its mass centre comes to the plane of the deck, or the first foot of its [`gear`](Landing::gear).

mod check;

use core::cell::Cell;
use core::ops::ControlFlow;

use mbs_models::{Error, Failure};
use mbs_platform::geometry::attitude;
use mbs_runtime::{Dop853, Event, IntegrationError, Integrator, State, Step, to_matrix};
use nalgebra::Vector3;

use super::approach::Approach;
use super::backstepping::{Backstepping, Command, Reference};
use super::deck::{Deck, DeckState, HeavingDeck};
use super::gear::Gear;
use super::ground_effect::GroundEffect;
use super::heave::Heave;
use super::lqr::Lqr;
use super::small_angle;
use super::touchdown::{Touchdown, Way};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};

pub use check::{HEIGHT, LEVEL};
pub(super) use check::{attitude_told, finite_deck, upright};

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
    /// Height over the deck at which it has landed, not negative \[m\].
    pub touchdown_height: f64,
    /// The legs whose feet are to come to that height, if it has legs; its mass centre without.
    pub gear: Option<Gear>,
    /// What it lands on.
    pub deck: D,
    /// Velocity of the air \[m/s\].
    pub wind: [f64; 3],
    /// How much harder the rotors push near the deck, if that counts; the controller does not know of it.
    pub ground_effect: Option<GroundEffect>,
    /// When it is given up \[s\]; [`MOST_MOMENTS`] are 20 000 s where the controller is not sampled.
    pub t_end: f64,
    /// The integrator.
    pub integrator: Dop853,
}

/// How often the way is looked at for its extremes \[s\].
const SAMPLING: f64 = 0.002;

/// How often a landing is looked at, or a sampled controller acts, at most.
pub const MOST_MOMENTS: u32 = 10_000_000;

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
            touchdown_height: 0.0,
            gear: None,
            deck,
            wind: [0.0; 3],
            ground_effect: None,
            t_end: 60.0,
            integrator: Dop853::new(1e-11, 1e-12),
        }
    }

    /// What is over the deck when a vehicle with these coordinates touches: its mass centre, or its lowest foot \[m\].
    pub(super) fn clearance(&self, deck: &DeckState, q: &[f64; 6]) -> f64 {
        let lever = self.lever(deck, q);
        deck.height(&[q[0] + lever.x, q[1] + lever.y, q[2] + lever.z])
    }

    /// From the mass centre to what touches first, in world axes: to the lowest foot, if there are legs \[m\].
    pub(super) fn lever(&self, deck: &DeckState, q: &[f64; 6]) -> Vector3<f64> {
        let Some(gear) = &self.gear else { return Vector3::zeros() };
        let own = to_matrix(&attitude(q));
        let over = |foot: &Vector3<f64>| to_matrix(&deck.rotation).column(2).dot(foot);
        let feet = gear.feet().map(|foot| own * Vector3::from(foot));
        feet.into_iter().min_by(|a, b| over(a).total_cmp(&over(b))).unwrap_or_default()
    }

    /// What the controller does over a deck.
    #[must_use]
    pub fn command_over(&self, deck: &DeckState, t: f64, q: &[f64; 6], qd: &[f64; 6]) -> Command {
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

    /// `q̈` in this wind \[m/s\] at these rotor speeds \[rad/s\] and this height over the deck \[m\], which is asked
    /// for where it counts.
    pub(super) fn accelerations_at(
        &self,
        wind: &[f64; 3],
        height: impl FnOnce() -> f64,
        q: &[f64; 6],
        qd: &[f64; 6],
        speeds: &[f64; 4],
    ) -> [f64; 6] {
        let Some(effect) = &self.ground_effect else {
            return self.accelerations_of(wind, &self.vehicle, q, qd, speeds);
        };
        let params = *self.vehicle.params();
        let thrust_factor = effect.factor(height()) * params.thrust_factor;
        self.accelerations_of(wind, &QuadrotorEuler::new(Params { thrust_factor, ..params }), q, qd, speeds)
    }

    fn accelerations_of(
        &self,
        wind: &[f64; 3],
        vehicle: &QuadrotorEuler<f64>,
        q: &[f64; 6],
        qd: &[f64; 6],
        speeds: &[f64; 4],
    ) -> [f64; 6] {
        match self.plant {
            Plant::Exact => vehicle.forward_dynamics(&wind.map(|v| [v, 0.0, 0.0]), q, qd, speeds),
            Plant::SmallAngle => small_angle::accelerations(vehicle.params(), wind, q, qd, speeds),
        }
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
        self.accelerations_at(&self.wind, || self.height(t, q), q, qd, speeds)
    }

    /// Over the deck \[m\].
    pub(super) fn height(&self, t: f64, q: &[f64; 6]) -> f64 {
        self.deck.at(t).height(&[q[0], q[1], q[2]])
    }

    /// Of what touches, over the height at which it has landed \[m\].
    pub(super) fn above(&self, t: f64, q: &[f64; 6]) -> f64 {
        self.clearance(&self.deck.at(t), q) - self.touchdown_height
    }

    /// Simulates from a state at t = 0 up to the touchdown, found on the dense output.
    ///
    /// The controller acts in continuous time. `observer` sees times, states and commands every 2 ms.
    ///
    /// # Errors
    /// [`Error`].
    pub fn simulate(
        &self,
        mut state: State<[f64; 6]>,
        mut observer: impl FnMut(f64, &State<[f64; 6]>, &Command),
    ) -> Result<Touchdown, Error> {
        self.check(&state, SAMPLING)?;
        // When the deck was NaN; the last time is the nearest one, as steps get shorter.
        let lost = Cell::new(None);
        let deck_at = |t: f64| {
            let deck = self.deck.at(t);
            if !deck.is_finite() {
                lost.set(Some(t));
            }
            deck
        };
        let place = |q: &[f64; 6]| [q[0], q[1], q[2]];
        let height = |t: f64, state: &State<[f64; 6]>| self.clearance(&deck_at(t), &state.q) - self.touchdown_height;
        let mut way = Way::new();
        let mut events = [Event::new(&height).falling().terminal()];
        let mut sample = state;
        let mut next = 0_u64;
        let failed = Cell::new(None);
        let look = |step: &mut dyn Step<[f64; 6]>| {
            while next as f64 * SAMPLING <= step.time() {
                let t = next as f64 * SAMPLING;
                let deck = self.deck.at(t);
                let seen = step.interpolate(t, &mut sample).map_err(Error::from);
                let told = seen.and_then(|()| attitude_told(&sample, t));
                if let Err(error) = told.and_then(|()| finite_deck(deck, t)) {
                    failed.set(Some(error));
                    return ControlFlow::Break(step.time());
                }
                let command = self.command_over(&deck, t, &sample.q, &sample.qd);
                way.reach(t, &sample, &command, &deck);
                observer(t, &sample, &command);
                next += 1;
            }
            ControlFlow::Continue(())
        };
        let accelerations = |t: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
            let deck = deck_at(t);
            let speeds = self.command_over(&deck, t, q, qd).rotors.speed;
            *qdd = if deck.is_finite() {
                self.accelerations_at(&self.wind, || deck.height(&place(q)), q, qd, &speeds)
            } else {
                [f64::NAN; 6]
            };
        };
        let end = self.integrator.integrate_with_events(accelerations, 0.0, self.t_end, &mut state, &mut events, look);
        if let Some(error) = failed.get() {
            return Err(error);
        }
        let summary = match (end, lost.get()) {
            (Ok(summary), _) => summary,
            (Err(IntegrationError::NonFiniteState { .. } | IntegrationError::NonFiniteEvent { .. }), Some(time)) => {
                return Err(Failure::NotFinite("the deck").at_time(time));
            }
            (Err(error), _) => return Err(error.into()),
        };
        let time = summary.time;
        let deck = finite_deck(self.deck.at(time), time)?;
        if !summary.stopped {
            return Err(Failure::NoContact { distance: deck.height(&place(&state.q)) }.at_time(time));
        }
        way.reach(time, &state, &self.command_over(&deck, time, &state.q, &state.qd), &deck);
        way.touchdown(self, time, state, deck)
    }
}
