//! Attitude control by quaternion feedback.
//!
//! ```text
//! τ = ω × I ω − 2 ω_n² I q_e − 2 ζ ω_n I (ω − ω_d)
//! ```
//!
//! with q_e the vector part of the quaternion from the attitude that is wanted to the one that is, on its shorter side.
//! For small errors q_e is half of the angle, and each axis a damped oscillator of the frequency ω_n.
//!
//! # Source
//! Wie, Barba, *Quaternion Feedback for Spacecraft Large Angle Maneuvers*, Journal of Guidance, Control, and Dynamics
//! 8(3), 1985; gains in proportion to the inertia and the gyroscopic term after Wie, Weiss, Arapostathis, *Quaternion
//! Feedback Regulator for Spacecraft Eigenaxis Rotations*, 12(3), 1989.

use super::bodies::Quaternion;
use crate::vector::{Vector, cross};

/// Gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeControl {
    /// `ω_n` \[rad/s\].
    pub frequency: f64,
    /// `ζ`.
    pub damping: f64,
}

impl AttitudeControl {
    /// The torque in the body's axes \[N·m\].
    ///
    /// | argument  | meaning                                          | unit   |
    /// |-----------|--------------------------------------------------|--------|
    /// | `inertia` | principal inertias                               | kg·m²  |
    /// | `error`   | from the attitude that is wanted to the one that is |        |
    /// | `spin`    | angular velocity against inertial space           | rad/s  |
    /// | `wanted`  | the one that is wanted, in the body's axes          | rad/s  |
    #[must_use]
    pub fn torque(&self, inertia: &Vector, error: &Quaternion, spin: &Vector, wanted: &Vector) -> Vector {
        let momentum: Vector = core::array::from_fn(|i| inertia[i] * spin[i]);
        let gyroscopic = cross(spin, &momentum);
        let side = if error[0] < 0.0 { -1.0 } else { 1.0 };
        core::array::from_fn(|i| {
            let back = 2.0 * self.frequency * self.frequency * side * error[i + 1];
            gyroscopic[i] - inertia[i] * (back + 2.0 * self.damping * self.frequency * (spin[i] - wanted[i]))
        })
    }
}
