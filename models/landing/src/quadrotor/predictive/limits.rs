//! What a landing must keep, as conditions on its nodes with exact derivatives: tilt, visibility, deck, touchdown.
//!
//! With z_b the body's axis, ω its angular velocity by rates of coordinates (the generated `pose_jacobian`), d from the
//! vehicle to the point that is landed on, and c = Rᵀ d as the camera sees it, which looks along −z_b,
//!
//! ```text
//! δ z_b = ω × z_b,   δ c = Rᵀ (δp_d − δp − ω × d)
//! tilt         z_b·e_z ≥ cos β
//! visibility   √(c_x² + c_y² + ε²) ≤ −c_z tan α + r      a mark of radius r is in the cone, at least its edge
//! height       z ≥ z_d                                   before the touchdown, and z ≤ z_d at it
//! ```

use std::vec::Vec;

use mbs_models::check::{Invalid, positive, within};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::{Scalar, to_matrix};
use nalgebra::{Matrix3, SVector, Vector3};

use super::problem::Condition;
use super::step::{InputVector, STATES, StateVector};
use crate::quadrotor::deck::{Deck, DeckState, HeavingDeck};

/// What the vehicle is to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The least and the greatest thrust of all rotors, in units of the weight; each has a quarter of it.
    pub thrust: [f64; 2],
    /// The greatest angle between the body's axis and the vertical \[rad\].
    pub tilt: f64,
    /// What the camera sees.
    pub view: View,
    /// At the touchdown.
    pub touchdown: TouchdownLimits,
}

/// The cone of a camera that looks down the body's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Between its axis and its edge \[rad\].
    pub half_angle: f64,
    /// Radius of the mark on the deck of which something is to be seen \[m\].
    pub mark: f64,
}

/// What is kept at the touchdown, against the deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchdownLimits {
    /// Downwards \[m/s\].
    pub sink_rate: f64,
    /// Along the deck \[m/s\].
    pub horizontal_speed: f64,
    /// From the point that is landed on \[m\].
    pub offset: f64,
    /// The tilt \[rad\].
    pub tilt: f64,
    /// Of the rates of the angles \[rad/s\].
    pub rate: f64,
}

impl Default for Limits {
    /// Assumed.
    fn default() -> Self {
        Limits {
            thrust: [0.05, 2.2],
            tilt: 25.0_f64.to_radians(),
            view: View { half_angle: 30.0_f64.to_radians(), mark: 0.5 },
            touchdown: TouchdownLimits {
                sink_rate: 0.3,
                horizontal_speed: 0.2,
                offset: 0.1,
                tilt: 5.0_f64.to_radians(),
                rate: 0.5,
            },
        }
    }
}

/// ε, which rounds the tip of the cone \[m\].
const ROUNDING: f64 = 0.01;

impl Limits {
    /// Whether they are limits.
    ///
    /// # Errors
    /// [`Invalid`].
    pub fn check(&self) -> Result<(), Invalid> {
        const RIGHT_ANGLE: f64 = core::f64::consts::FRAC_PI_2 - 0.01;
        let TouchdownLimits { sink_rate, horizontal_speed, offset, tilt, rate } = self.touchdown;
        within("limits.thrust[0]", self.thrust[0], [0.0, f64::MAX])?;
        within("limits.thrust[1]", self.thrust[1], [self.thrust[0], f64::MAX])?;
        for (name, angle) in [("tilt", self.tilt), ("view.half_angle", self.view.half_angle), ("touchdown.tilt", tilt)]
        {
            within(name, angle, [1e-3, RIGHT_ANGLE])?;
        }
        positive("view.mark", self.view.mark)?;
        positive("touchdown.sink_rate", sink_rate)?;
        positive("touchdown.horizontal_speed", horizontal_speed)?;
        positive("touchdown.offset", offset)?;
        positive("touchdown.rate", rate)
    }

    /// The least and the greatest speeds of the rotors, in units of the one at which the vehicle hovers.
    #[must_use]
    pub fn inputs(&self) -> [InputVector; 2] {
        self.thrust.map(|part| InputVector::repeat(Scalar::sqrt(part)))
    }

    /// The least and the greatest thrust of a rotor \[N\].
    #[must_use]
    pub fn rotor_thrust(&self, params: &Params<f64>) -> [f64; 2] {
        self.thrust.map(|part| part * params.m * params.g / 4.0)
    }
}

/// A vehicle over a deck, and how what it keeps changes with its state and with time.
pub struct Sight<'a> {
    limits: &'a Limits,
    deck: DeckState,
    x: &'a StateVector,
    /// The body's axes, in columns.
    rotation: Matrix3<f64>,
    /// The axes about which the rates of the angles turn.
    turns: Matrix3<f64>,
}

impl<'a> Sight<'a> {
    /// Of a state at a time \[s\].
    #[must_use]
    pub fn new(
        vehicle: &QuadrotorEuler<f64>,
        limits: &'a Limits,
        deck: &HeavingDeck<4>,
        t: f64,
        x: &'a StateVector,
    ) -> Self {
        let q = x.fixed_rows::<6>(0).into();
        let calm = [[0.0; 3]; 3];
        let jacobian = to_matrix(&vehicle.pose_jacobian(&calm, &q));
        Sight {
            limits,
            deck: deck.at(t),
            x,
            rotation: to_matrix(&vehicle.pose(&calm, &q).rotation),
            turns: jacobian.fixed_view::<3, 3>(3, 3).into(),
        }
    }

    fn slope(&self, name: &'static str, value: f64, by_time: f64) -> Condition<STATES> {
        Condition { name, value, by_state: SVector::zeros(), by_time }
    }

    /// Over the deck \[m\].
    #[must_use]
    pub fn height(&self) -> Condition<STATES> {
        let mut row = self.slope("height over the deck", self.x[2] - self.deck.position[2], -self.deck.velocity[2]);
        row.by_state[2] = 1.0;
        row
    }

    /// At the deck or below \[m\].
    #[must_use]
    pub fn contact(&self) -> Condition<STATES> {
        let Condition { value, by_state, by_time, .. } = self.height();
        Condition { name: "contact", value: -value, by_state: -by_state, by_time: -by_time }
    }

    /// Not faster towards the deck than the touchdown allows and this rate \[1/s\] times the height besides \[m/s\].
    #[must_use]
    pub fn sink_rate(&self, rate: f64) -> Condition<STATES> {
        let height = self.height();
        let velocity = self.x[8] - self.deck.velocity[2];
        let value = velocity + self.limits.touchdown.sink_rate + rate * height.value;
        let by_time = rate * height.by_time - self.deck.acceleration[2];
        let mut row = self.slope("sink rate", value, by_time);
        row.by_state[2] = rate;
        row.by_state[8] = 1.0;
        row
    }

    /// Between the body's axis and the vertical \[rad\].
    #[must_use]
    pub fn tilt_angle(&self) -> f64 {
        let axis = self.rotation.column(2);
        Scalar::atan2(Scalar::sqrt(axis.x * axis.x + axis.y * axis.y), axis.z)
    }

    /// Upright but for the tilt that is allowed \[rad\], nearly.
    #[must_use]
    pub fn tilt(&self) -> Condition<STATES> {
        self.upright("tilt", self.limits.tilt)
    }

    fn upright(&self, name: &'static str, greatest: f64) -> Condition<STATES> {
        let (sin, cos) = Scalar::sin_cos(greatest);
        let axis: Vector3<f64> = self.rotation.column(2).into();
        let mut row = self.slope(name, (axis.z - cos) / sin, 0.0);
        for i in 0..3 {
            let turn: Vector3<f64> = self.turns.column(i).into();
            row.by_state[3 + i] = turn.cross(&axis).z / sin;
        }
        row
    }

    /// The mark is within the cone \[m\].
    #[must_use]
    pub fn visibility(&self) -> Condition<STATES> {
        let View { half_angle, mark } = self.limits.view;
        let slope = Scalar::tan(half_angle);
        let d = Vector3::from(self.deck.position) - self.x.fixed_rows::<3>(0);
        let seen = self.rotation.tr_mul(&d);
        let aside = Scalar::sqrt(seen.x * seen.x + seen.y * seen.y + ROUNDING * ROUNDING);
        let by_seen = Vector3::new(-seen.x / aside, -seen.y / aside, -slope);
        // ∂g/∂c Rᵀ, against displacements in world axes.
        let by_place = self.rotation * by_seen;
        let mut row =
            self.slope("visibility", mark - slope * seen.z - aside, by_place.dot(&Vector3::from(self.deck.velocity)));
        for i in 0..3 {
            let turn: Vector3<f64> = self.turns.column(i).into();
            row.by_state[i] = -by_place[i];
            row.by_state[3 + i] = -by_place.dot(&turn.cross(&d));
        }
        row
    }

    /// All that is kept at the touchdown.
    pub fn touchdown(&self, rows: &mut Vec<Condition<STATES>>) {
        let TouchdownLimits { horizontal_speed, offset, tilt, rate, .. } = self.limits.touchdown;
        let [x, y, _] = self.deck.position;
        rows.push(self.contact());
        rows.push(self.sink_rate(0.0));
        rows.push(self.upright("tilt at the touchdown", tilt));
        rows.push(self.within("offset at the touchdown", offset, &[(0, x), (1, y)]));
        rows.push(self.within("horizontal speed at the touchdown", horizontal_speed, &[(6, 0.0), (7, 0.0)]));
        rows.push(self.within("rates at the touchdown", rate, &[(9, 0.0), (10, 0.0), (11, 0.0)]));
    }

    /// These components of the state no farther from these places than a radius: `(r² − d²)/2r ≥ 0`.
    fn within(&self, name: &'static str, radius: f64, places: &[(usize, f64)]) -> Condition<STATES> {
        let square: f64 = places.iter().map(|&(i, place)| (self.x[i] - place) * (self.x[i] - place)).sum();
        let mut row = self.slope(name, (radius * radius - square) / (2.0 * radius), 0.0);
        for &(i, place) in places {
            row.by_state[i] = -(self.x[i] - place) / radius;
        }
        row
    }
}
