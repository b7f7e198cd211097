//! Landing on what the vehicle's sensors say: the controller sees an estimate in place of the truth.
//!
//! IMU, estimator and controller run at one rate. An interval of the IMU is what passed since the controller acted
//! last; its sample is of the middle of it, with the rotor speeds that were held.

use mbs_models::{Error, Failure};
use mbs_runtime::{IntegrationError, Rk4Stepper, State, to_matrix, to_rows};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::backstepping::Command;
use super::deck::{Deck, DeckState, angles_of};
use super::landing::{Landing, attitude_told, finite_deck};
use super::touchdown::{Touchdown, Way};
use super::zero_order_hold::ZeroOrderHold;
use crate::estimator::filter::{Filter, Innovation};
use crate::estimator::measurement;
use crate::estimator::nominal::Nominal;
use crate::sensors::camera::Image;
use crate::sensors::imu::{Biases, ImuSample};
use crate::sensors::motion::Motion;
use crate::sensors::{Normal, Pose, Sensors, intervals};
use mbs_platform::jacobian::angular_rates;

/// What is the case at a moment at which the controller acts.
#[derive(Clone, Copy, Debug)]
pub struct EstimatedMoment<'a> {
    /// The time \[s\].
    pub time: f64,
    /// The vehicle.
    pub vehicle: &'a State<[f64; 6]>,
    /// What is to be estimated.
    pub truth: &'a Nominal,
    /// The estimator, after all that was measured until now.
    pub filter: &'a Filter,
    /// What the controller sees of the vehicle.
    pub seen: &'a State<[f64; 6]>,
    /// The deck.
    pub deck: &'a DeckState,
    /// The range of this moment, if there was one.
    pub range: Option<Innovation>,
    /// The image that was told of at this moment, if one was.
    pub image: Option<(&'a Image, Innovation)>,
}

/// An image that is not told of yet.
struct Look {
    due: u64,
    deck: DeckState,
    image: Image,
}

/// The vehicle when the controller acted, and what it held from then on.
struct Held {
    state: State<[f64; 6]>,
    command: Command,
}

impl<D: Deck> Landing<D> {
    /// The landing from a state at t = 0, on the estimates of a filter from the sensors with these first biases.
    ///
    /// The controller acts once an interval of the IMU, and the vehicle is integrated by RK4 with that step; the
    /// touchdown is found within it by halving. The filter knows where the deck is at each moment, as the controller
    /// does. `observer` sees every moment at which the controller acts.
    ///
    /// # Errors
    /// [`Error`]; of a number of the sensors that is none; `NotFinite` where an estimate is NaN or infinite.
    pub fn simulate_estimated(
        &self,
        state: State<[f64; 6]>,
        sensors: &Sensors,
        mut biases: Biases,
        mut filter: Filter,
        mut normal: impl Normal,
        mut observer: impl FnMut(&EstimatedMoment<'_>),
    ) -> Result<Touchdown, Error> {
        sensors.check()?;
        let period = sensors.imu.interval;
        self.check(&state, period)?;
        let head = sensors.head();
        let every = |time: f64| intervals(time, period);
        let (ranges, images, delay) =
            (every(sensors.altimeter.period), every(sensors.camera.period), every(sensors.camera.delay));
        let (mut way, mut stepper) = (Way::new(), Rk4Stepper::new(&state));
        let mut held: Option<Held> = None;
        let mut look: Option<Look> = None;
        let mut last = ImuSample { rate: Vector3::zeros(), specific_force: Vector3::zeros() };
        let mut count = 0_u64;
        let hold = |t: f64, state: &State<[f64; 6]>| {
            attitude_told(state, t)?;
            let deck = finite_deck(self.deck.at(t), t)?;
            if let Some(Held { state: mut middle, command }) = held.take() {
                let speeds = command.rotors.speed;
                let begin = t - period;
                let right = |t: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
                    *qdd = self.accelerations(t, q, qd, &speeds);
                };
                let moved = stepper.step(right, begin, 0.5 * period, &mut middle).is_ok();
                if !(moved && middle.is_finite()) {
                    return Err(IntegrationError::NonFiniteState { time: begin }.into());
                }
                let accelerations = self.accelerations(begin + 0.5 * period, &middle.q, &middle.qd, &speeds);
                let body = Motion::of_quadrotor(&middle.q, &middle.qd, &accelerations);
                last = sensors.imu.measure(&body, &mut biases, &mut normal);
                filter.propagate(&last);
            }
            let truth = inertial_state(state, sensors, biases);
            let range = if count.is_multiple_of(ranges) {
                let range = sensors.altimeter.measure(&head, &truth.pose, &deck, &mut normal);
                range.map(|range| filter.correct(|about| measurement::range(sensors, &head, &deck, range, about)))
            } else {
                None
            };
            let mut told = None;
            let mut hear = |look: &mut Option<Look>, filter: &mut Filter| {
                let Some(Look { deck, image, .. }) = look.take_if(|look| look.due == count) else { return };
                if image.iter().any(Option::is_some) {
                    let seen = filter.correct(|about| measurement::image(sensors, &head, &deck, &image, about));
                    told = Some((image, seen));
                }
            };
            hear(&mut look, &mut filter);
            if count.is_multiple_of(images) {
                filter.clone_pose();
                let image = sensors.camera.look(&head, &truth.pose, &deck, &sensors.markers, &mut normal);
                look = Some(Look { due: count + delay, deck, image });
                hear(&mut look, &mut filter);
            }
            count += 1;

            let seen = vehicle_state(&filter.estimate.nominal, &last, sensors);
            if !seen.is_finite() {
                return Err(Failure::NotFinite("what a sensor gives").at_time(t));
            }
            let command = self.command_over(&deck, t, &seen.q, &seen.qd);
            way.hold(t, state, &command, &deck);
            let image = told.as_ref().map(|(image, seen)| (image, *seen));
            let (vehicle, truth, filter) = (state, &truth, &filter);
            observer(&EstimatedMoment { time: t, vehicle, truth, filter, seen: &seen, deck: &deck, range, image });
            held = Some(Held { state: *state, command });
            Ok(command)
        };
        let run = ZeroOrderHold {
            period,
            t_end: self.t_end,
            hold,
            accelerations: |held: &Command, t: f64, q: &[f64; 6], qd: &[f64; 6]| {
                self.accelerations(t, q, qd, &held.rotors.speed)
            },
            height: |t: f64, state: &State<[f64; 6]>| self.above(t, &state.q),
        };
        let (time, state) = run.until_touchdown(state)?;
        way.touchdown(self, time, state, self.deck.at(time))
    }
}

/// The state of the IMU, with its biases, on a vehicle with these coordinates and rates.
#[must_use]
pub fn inertial_state(vehicle: &State<[f64; 6]>, sensors: &Sensors, biases: Biases) -> Nominal {
    let here = Motion::of_quadrotor(&vehicle.q, &vehicle.qd, &[0.0; 6]).at(&sensors.imu.place);
    let rotation = Rotation3::from_matrix_unchecked(here.rotation);
    let pose = Pose { place: here.place, attitude: UnitQuaternion::from_rotation_matrix(&rotation) };
    Nominal { pose, velocity: here.velocity, biases }
}

/// Coordinates and rates of the vehicle whose IMU is in this state and said this last, at the mass centre:
/// `x − R r`, `v − R (ω × r)`, and rates of the angles by ω. NaN where the angles have none.
#[must_use]
pub fn vehicle_state(inertial: &Nominal, last: &ImuSample, sensors: &Sensors) -> State<[f64; 6]> {
    let rotation = inertial.pose.attitude.to_rotation_matrix();
    let (lever, rate) = (Vector3::from(sensors.imu.place), last.rate - inertial.biases.gyro);
    let place = inertial.pose.place - rotation * lever;
    let velocity = inertial.velocity - rotation * rate.cross(&lever);
    let [phi, theta, psi] = angles_of(&to_rows(rotation.matrix()));
    let q = [place.x, place.y, place.z, phi, theta, psi];
    let rates = to_matrix(&angular_rates(&q)).try_inverse().map(|inverse| inverse * (rotation * rate));
    let [phid, thetad, psid] = rates.unwrap_or(Vector3::repeat(f64::NAN)).into();
    State::new(q, [velocity.x, velocity.y, velocity.z, phid, thetad, psid])
}
