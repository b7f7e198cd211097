//! Landing on the Stewart platform of chapter 4 while its legs drive it.
//!
//! Vehicle and platform are integrated together, each under a controller of its own; both are sampled at the same
//! moments and hold what they ask for in between. The platform's controller is to follow the motion of the deck by
//! [computed torque](mbs_platform::control), with forces that are cut to what the actuators give. The vehicle's
//! controller sees where the deck is and how fast it moves; of the acceleration it knows what was planned. The platform
//! does not feel the vehicle before the touchdown.
//!
//! What legs cannot do is not held back but told: lengths, speeds and forces go into a [`Survey`] with all excesses.
//! Legs that leave their stroke are as long as the motion needs; forces that are cut leave the motion behind its plan.

use mbs_models::{Error, check};
use mbs_runtime::control::ComputedTorque;
use mbs_runtime::{Scalar, State};
use nalgebra::Vector3;

use super::backstepping::Command;
use super::deck::{DeckState, MovingDeck};
use super::landing::{Landing, attitude_told, finite_deck};
use super::mixer::RotorSpeeds;
use super::touchdown::{Touchdown, Way};
use super::zero_order_hold::ZeroOrderHold;
use mbs_platform::jacobian::Regularity;
use mbs_platform::limits::{LegState, Survey};
use mbs_platform::{Coordinates, LegVector, NOT_FINITE, Platform, PlatformMotion};

/// What is not positive where a driven platform has come through a pose in which its legs could not hold it: the
/// determinant of their Jacobian by coordinates has changed its sign.
pub const SIDE: &str = "determinant of the legs over that at the beginning";

/// What drives a deck.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The platform; the controller knows it as it is.
    pub platform: Platform,
    /// Its controller.
    pub control: ComputedTorque<6>,
}

/// How far a platform is from where it was to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackingError {
    /// Distance of its frame \[m\].
    pub distance: f64,
    /// The greatest difference of an angle \[rad\].
    pub angle: f64,
}

impl TrackingError {
    /// Between two poses; NaN where a coordinate of them is.
    #[must_use]
    pub fn between(a: &Coordinates, b: &Coordinates) -> Self {
        let [x, y, z, phi, theta, psi]: Coordinates = core::array::from_fn(|i| a[i] - b[i]);
        // NaN stays NaN.
        let greater =
            |greatest: f64, angle: f64| if angle.abs() > greatest || angle.is_nan() { angle.abs() } else { greatest };
        TrackingError {
            distance: Vector3::new(x, y, z).norm(),
            angle: [phi, theta, psi].into_iter().fold(0.0, greater),
        }
    }
}

/// What is the case at a moment at which both controllers act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenMoment {
    /// The time \[s\].
    pub time: f64,
    /// The quadrotor.
    pub vehicle: State<[f64; 6]>,
    /// The platform, over its base.
    pub platform: State<[f64; 6]>,
    /// The deck as the vehicle's controller sees it.
    pub deck: DeckState,
    /// What that one asks for.
    pub command: Command,
    /// The legs; forces are those that the platform's controller asks for.
    pub legs: LegState,
}

/// How a landing on a driven platform ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenTouchdown {
    /// On the deck as it is.
    pub touchdown: Touchdown,
    /// The platform then, over its base.
    pub platform: State<[f64; 6]>,
    /// The greatest tracking errors on the way.
    pub greatest_error: TrackingError,
    /// Those at the touchdown.
    pub last_error: TrackingError,
    /// What the legs did, at the moments at which the controllers acted; of forces what was asked for.
    pub survey: Survey,
}

/// What both controllers hold for one period.
struct Held {
    rotors: RotorSpeeds,
    /// The forces \[N\].
    forces: LegVector,
}

impl<M: PlatformMotion> Landing<MovingDeck<M>> {
    /// The landing of a vehicle in this state on the platform that is driven along the motion of the deck, from rest at
    /// the place where that motion begins.
    ///
    /// Rotor speeds and forces of the legs are held for one period \[s\] and integrated by one step of RK4 a period;
    /// the touchdown is found within the period by halving it. `observer` sees every moment at which the controllers
    /// act.
    ///
    /// # Errors
    /// [`Error`]; of a number where the period or a limit of the platform is none, and of [`SIDE`] where its legs could
    /// not hold it on the way from one moment to the next; `Singular` where they cannot at a moment.
    pub fn simulate_driven(
        &self,
        vehicle: State<[f64; 6]>,
        drive: &Drive,
        period: f64,
        mut observer: impl FnMut(&DrivenMoment),
    ) -> Result<DrivenTouchdown, Error> {
        self.check(&vehicle, period)?;
        let Drive { platform, control } = drive;
        platform.limits.check()?;
        let start = State::new(self.deck.motion.at(0.0)[0], [0.0; 6]);
        let regularity = |time: f64, q: &Coordinates| platform.regularity(q).map_err(|error| error.or_at_time(time));
        let before = determinant(&regularity(0.0, &start.q)?, &start.q);
        // How far from a singular pose it is, on the side of the singular ones on which it began.
        let held = |time: f64, q: &Coordinates| {
            let regularity = regularity(time, q)?;
            let determinant = determinant(&regularity, q);
            let same_side = check::positive(SIDE, determinant / before);
            same_side.map(|()| regularity).map_err(|error| error.at_time(time))
        };
        let (mut way, mut survey, mut greatest_error) = (Way::new(), Survey::default(), TrackingError::default());
        let hold = |t: f64, both: &State<[f64; 12]>| {
            let (vehicle, stands) = parted(both);
            attitude_told(&vehicle, t)?;
            let plan = self.deck.motion.at(t);
            let failed = |error: Error| error.or_at_time(t);
            let force = platform.computed_forces(control, &plan, &stands.q, &stands.qd).map_err(failed)?;
            let legs = LegState {
                length: platform.lengths(&stands.q).map_err(failed)?,
                rate: platform.leg_rates(&stands.q, &stands.qd).map_err(failed)?,
                force,
            };
            survey.add(&platform.limits, t, &legs, held(t, &stands.q)?.condition);
            let error = TrackingError::between(&stands.q, &plan[0]);
            greatest_error.distance = greatest_error.distance.max(error.distance);
            greatest_error.angle = greatest_error.angle.max(error.angle);

            let deck = finite_deck(self.deck.over_base(&[stands.q, stands.qd, plan[2]]), t)?;
            let command = self.command_over(&deck, t, &vehicle.q, &vehicle.qd);
            way.hold(t, &vehicle, &command, &deck);
            observer(&DrivenMoment { time: t, vehicle, platform: stands, deck, command, legs });
            Ok(Held { rotors: command.rotors, forces: platform.limits.saturated(&force) })
        };
        let height = |vehicle: &State<[f64; 6]>, stands: &State<[f64; 6]>| {
            let [x, y, z, ..] = vehicle.q;
            self.deck.over_base(&[stands.q, stands.qd, [0.0; 6]]).height(&[x, y, z])
        };
        let run = ZeroOrderHold {
            period,
            t_end: self.t_end,
            hold,
            accelerations: |held: &Held, _: f64, q: &[f64; 12], qd: &[f64; 12]| {
                let (vehicle, stands) = parted(&State::new(*q, *qd));
                let flown = || height(&vehicle, &stands);
                joined(
                    &self.accelerations_at(&self.wind, flown, &vehicle.q, &vehicle.qd, &held.rotors.speed),
                    &platform.model().forward_dynamics(&stands.q, &stands.qd, &held.forces),
                )
            },
            height: |_: f64, both: &State<[f64; 12]>| {
                let (vehicle, stands) = parted(both);
                let deck = self.deck.over_base(&[stands.q, stands.qd, [0.0; 6]]);
                self.clearance(&deck, &vehicle.q) - self.touchdown_height
            },
        };
        let both = State::new(joined(&vehicle.q, &start.q), joined(&vehicle.qd, &start.qd));
        let (time, both) = run.until_touchdown(both)?;
        let (vehicle, stands) = parted(&both);
        held(time, &stands.q)?;
        let plan = self.deck.motion.at(time);
        if !plan.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(NOT_FINITE.at_time(time));
        }
        let deck = self.deck.over_base(&[stands.q, stands.qd, plan[2]]);
        Ok(DrivenTouchdown {
            touchdown: way.touchdown(self, time, vehicle, deck)?,
            platform: stands,
            greatest_error,
            last_error: TrackingError::between(&stands.q, &plan[0]),
            survey,
        })
    }
}

/// Determinant of the Jacobian of the legs by coordinates \[m³\]: that by twists times cos θ.
fn determinant(regularity: &Regularity, q: &Coordinates) -> f64 {
    regularity.determinant * Scalar::cos(q[4])
}

fn joined(vehicle: &[f64; 6], platform: &[f64; 6]) -> [f64; 12] {
    core::array::from_fn(|i| if i < 6 { vehicle[i] } else { platform[i - 6] })
}

/// The vehicle and the platform.
fn parted(both: &State<[f64; 12]>) -> (State<[f64; 6]>, State<[f64; 6]>) {
    let part = |first: usize, all: &[f64; 12]| core::array::from_fn(|i| all[first + i]);
    (State::new(part(0, &both.q), part(0, &both.qd)), State::new(part(6, &both.q), part(6, &both.qd)))
}
