//! Whether there can be a landing: parameters, controller, first state, deck.

use core::f64::consts::FRAC_PI_2;

use mbs_models::check::{Invalid, Must, each, finite, positive, within};
use mbs_models::{Error, Failure};
use mbs_runtime::{Scalar, State};

use super::{Controller, Landing, MOST_MOMENTS};
use crate::quadrotor::backstepping::Backstepping;
use crate::quadrotor::deck::{Deck, DeckState};
use crate::quadrotor::lqr::Lqr;
use crate::quadrotor::mixer::Mixer;
use mbs_models::quadrotor_euler::Params;

impl<D: Deck> Landing<D> {
    /// Whether this can be a landing, from this state, looked at once a period \[s\].
    pub(in crate::quadrotor) fn check(&self, state: &State<[f64; 6]>, period: f64) -> Result<(), Error> {
        let params = self.vehicle.params();
        positive("inertias", params.inertias)?;
        each(
            positive,
            [
                ("m", params.m),
                ("g", params.g),
                ("arm", params.arm),
                ("thrust_factor", params.thrust_factor),
                ("drag_factor", params.drag_factor),
                ("approach.duration", self.approach.duration),
                ("t_end", self.t_end),
                ("period", period),
            ],
        )?;
        each(
            finite,
            [
                ("rotor_inertia", params.rotor_inertia),
                ("drag_coefficient", params.drag_coefficient),
                ("area", params.area),
                ("air_density", params.air_density),
                ("approach.height", self.approach.height),
                ("approach.last_height", self.approach.last_height),
            ],
        )?;
        within("approach.sink_rate", self.approach.sink_rate, [0.0, f64::MAX])?;
        within("touchdown_height", self.touchdown_height, [0.0, f64::MAX])?;
        if let Some(gear) = &self.gear {
            gear.check()?;
        }
        finite("wind", self.wind)?;
        finite("q", state.q)?;
        finite("qd", state.qd)?;
        attitude_told(state, 0.0)?;
        self.controller.check()?;
        Must::BeAtMost(f64::from(MOST_MOMENTS)).check("number of moments", self.t_end / period)?;
        let deck = upright(finite_deck(self.deck.at(0.0), 0.0)?, 0.0)?;
        let height = self.clearance(&deck, &state.q);
        // Of finite numbers, but it may overflow.
        finite(HEIGHT, height)?;
        Must::BeMoreThan(self.touchdown_height).check(HEIGHT, height)?;
        Ok(())
    }
}

/// The deck at a time, where it is one.
pub(in crate::quadrotor) fn finite_deck(deck: DeckState, time: f64) -> Result<DeckState, Error> {
    if deck.is_finite() { Ok(deck) } else { Err(Failure::NotFinite("the deck").at_time(time)) }
}

/// What is too little where a vehicle or a flange begins at or below the height at which it has landed \[m\].
pub const HEIGHT: &str = "height over the deck at the beginning";
/// What is too little where the vehicle's pitch is within 1° of ±90° or beyond: its angles do not tell its attitude.
pub const LEVEL: &str = "cosine of the pitch";
/// Cosine of the pitch, 1° from ±90°.
const LEAST_COSINE: f64 = 0.0175;

/// Whether the angles tell the attitude: the pitch is not near ±90°, nor beyond.
pub(in crate::quadrotor) fn attitude_told(state: &State<[f64; 6]>, time: f64) -> Result<(), Error> {
    let pitch = state.q[4];
    let attitude = Must::BeMoreThan(LEAST_COSINE).check(LEVEL, Scalar::cos(pitch));
    attitude.map_err(|error| error.at_time(time))
}

/// The least vertical component of the normal of a deck that is not turned over: that of a vertical one, rounded.
const LEAST_UPWARD: f64 = 1e-12;

/// The deck at a time, where its normal points up.
pub(in crate::quadrotor) fn upright(deck: DeckState, time: f64) -> Result<DeckState, Error> {
    let upright = Must::BeMoreThan(LEAST_UPWARD).check("upward component of the deck's normal", deck.rotation[2][2]);
    upright.map(|()| deck).map_err(|error| error.at_time(time))
}

impl Controller {
    /// Whether every number is one that the law can work with: a NaN limit would limit nothing.
    fn check(&self) -> Result<(), Invalid> {
        match self {
            Controller::Backstepping(Backstepping {
                params,
                mixer,
                horizontal,
                vertical,
                tilt,
                yaw,
                thrust_range: [least, greatest],
                greatest_tilt,
            }) => {
                believed(params, mixer)?;
                each(
                    positive,
                    [
                        ("controller.horizontal.k1", horizontal.k1),
                        ("controller.horizontal.k2", horizontal.k2),
                        ("controller.vertical.k1", vertical.k1),
                        ("controller.vertical.k2", vertical.k2),
                        ("controller.tilt.k1", tilt.k1),
                        ("controller.tilt.k2", tilt.k2),
                        ("controller.yaw.k1", yaw.k1),
                        ("controller.yaw.k2", yaw.k2),
                    ],
                )?;
                within("controller.thrust_range[0]", *least, [0.0, f64::MAX])?;
                within("controller.thrust_range[1]", *greatest, [*least, f64::INFINITY])?;
                within("controller.greatest_tilt", *greatest_tilt, [0.0, FRAC_PI_2])
            }
            Controller::Lqr(Lqr { params, mixer, gain }) => {
                believed(params, mixer)?;
                gain.iter().try_for_each(|&gain| finite("controller.gain", gain))
            }
        }
    }
}

/// What a controller knows of the vehicle.
fn believed(params: &Params<f64>, mixer: &Mixer) -> Result<(), Invalid> {
    positive("controller.params.inertias", params.inertias)?;
    each(
        positive,
        [
            ("controller.params.m", params.m),
            ("controller.params.g", params.g),
            ("controller.params.thrust_factor", params.thrust_factor),
            ("controller.mixer.thrust_factor", mixer.thrust_factor),
            ("controller.mixer.drag_factor", mixer.drag_factor),
            ("controller.mixer.arm", mixer.arm),
        ],
    )?;
    within("controller.mixer.greatest_speed", mixer.greatest_speed, [0.0, f64::INFINITY])
}
