//! Adaptive control of a quadrotor whose mass and principal inertias nobody knows.
//!
//! Four rotors cannot move six coordinates. Adaptive control is that of z, φ, θ and ψ, of which four generalized forces
//! make what they like; x and y are held by the tilt, which does not depend on the mass: (5.11) of the thesis. What the
//! tilt is to be goes through a filter of second order, so that its rate and acceleration are known without a model.
//!
//! # Source
//! J.-J. E. Slotine, W. Li, *On the adaptive control of robot manipulators*, International Journal of Robotics Research
//! 6:3, 1987; (5.11) of the doctoral thesis *Dynamics of multibody systems in a gravitational field*.

use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::control::{AdaptiveControl, Sliding, regressor};

use super::backstepping::Reference;
use super::flatness;
use super::rotors::{CALM, Rotors, Speeds};

/// The declared vehicle with another mass \[kg\] and other principal inertias \[kg·m²\].
#[must_use]
pub fn vehicle(numbers: &[f64; 4]) -> QuadrotorEuler<f64> {
    let [m, x, y, z] = *numbers;
    QuadrotorEuler::new(Params { m, inertias: [x, y, z], ..Params::default() })
}

/// Y of mass and principal inertias, a row for each of the six coordinates.
///
/// ```
/// use mbs_landing::quadrotor::adaptive::{vehicle, vehicle_regressor};
/// use mbs_landing::quadrotor::rotors::CALM;
/// use mbs_runtime::control::Sliding;
///
/// let (q, qd, qdd) = ([0.0, 0.0, 9.0, 0.3, -0.4, 1.1], [1.0, -2.0, 0.5, 0.6, -0.7, 0.8], [0.1; 6]);
/// let y = vehicle_regressor(&Sliding { error: [0.0; 6], qd, qdd }, &q, &qd);
/// let numbers = [30.0, 2.0, 2.1, 3.5];
/// let forces = vehicle(&numbers).inverse_dynamics(&CALM, &q, &qd, &qdd);
/// for i in 0..6 {
///     let found: f64 = (0..4).map(|k| y[i][k] * numbers[k]).sum();
///     assert!((found - forces[i]).abs() < 1e-9);
/// }
/// ```
#[must_use]
pub fn vehicle_regressor(sliding: &Sliding<6>, q: &[f64; 6], qd: &[f64; 6]) -> [[f64; 4]; 6] {
    let forces = |numbers: &[f64; 4]| {
        let unit = vehicle(numbers);
        sliding.forces(&unit.mass_matrix(&CALM, q), &unit.coriolis_matrix(&CALM, q, qd), &unit.gravity(&CALM, q))
    };
    regressor(forces, &[1.0; 4])
}

/// The control; x and y, and the filter of the tilt, are critically damped.
#[derive(Clone, Debug)]
pub struct Learning {
    /// Of z, φ, θ and ψ; its gains for x and y count for nothing.
    pub control: AdaptiveControl<6, 4>,
    /// The rotors that it has.
    pub rotors: Rotors,
    /// ω of x and y \[rad/s\].
    pub horizontal_frequency: f64,
    /// ω of the filter of the tilt \[rad/s\].
    pub filter_frequency: f64,
    /// The least part of g with which thrust is thought to lift where it is to tilt.
    pub least_lift: f64,
}

/// What is known beside coordinates and velocities: integrals of the rates that the control [asks for](Acted).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Mass and principal inertias, as far as they are learnt \[kg, kg·m²\].
    pub estimate: [f64; 4],
    /// Roll and pitch of the filter, each with its rate \[rad, rad/s\].
    pub tilt: [[f64; 2]; 2],
}

/// What the control does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acted {
    /// Speeds of the rotors.
    pub rotors: Speeds,
    /// Rates of the estimate \[kg/s, kg·m²/s\].
    pub estimate_rate: [f64; 4],
    /// Accelerations of the filter's roll and pitch \[rad/s²\].
    pub tilt_acceleration: [f64; 2],
    /// How far off the sliding surface it is.
    pub error: [f64; 6],
}

impl Learning {
    /// What it does for a position and a yaw that are to be followed.
    ///
    /// Where no attitude gives the acceleration that x and y ask for, it is NaN, which integrators refuse.
    #[must_use]
    pub fn act(&self, position: &[Reference; 3], heading: Reference, [q, qd]: [&[f64; 6]; 2], known: &Known) -> Acted {
        let [[roll, roll_rate], [pitch, pitch_rate]] = known.tilt;
        let tilt_acceleration = self.tilt(position, q, qd, known);
        let [_, _, height] = position;
        // x and y are where they should be, as far as this is concerned.
        let reference = [
            [q[0], q[1], height.value, roll, pitch, heading.value],
            [qd[0], qd[1], height.rate, roll_rate, pitch_rate, heading.rate],
            [0.0, 0.0, height.acceleration, tilt_acceleration[0], tilt_acceleration[1], heading.acceleration],
        ];
        let sliding = self.control.sliding(&reference, q, qd);
        let y = vehicle_regressor(&sliding, q, qd);
        let [_, _, wanted @ ..] = self.control.forces(&y, &known.estimate, &sliding.error);
        Acted {
            rotors: self.rotors.speeds(&wanted, q, qd),
            estimate_rate: self.control.estimate_rate(&y, &sliding.error),
            tilt_acceleration,
            error: sliding.error,
        }
    }

    /// Accelerations of the filter towards the tilt that x and y ask for.
    fn tilt(&self, position: &[Reference; 3], q: &[f64; 6], qd: &[f64; 6], known: &Known) -> [f64; 2] {
        let ahead = |i: usize| {
            let (w, wanted) = (self.horizontal_frequency, position[i]);
            wanted.acceleration + 2.0 * w * (wanted.rate - qd[i]) + w * w * (wanted.value - q[i])
        };
        let g = Params::<f64>::default().g;
        let up = position[2].acceleration.max((self.least_lift - 1.0) * g);
        let wanted = flatness::attitude([ahead(0), ahead(1), up], q[5], g);
        let wanted = wanted.map_or([f64::NAN; 2], |wanted| [wanted.roll, wanted.pitch]);
        let w = self.filter_frequency;
        [0, 1].map(|i| w * w * (wanted[i] - known.tilt[i][0]) - 2.0 * w * known.tilt[i][1])
    }
}
