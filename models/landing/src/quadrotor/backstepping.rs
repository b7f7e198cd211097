//! Backstepping control of each channel, and of the quadrotor by six of them.
//!
//! With the reference r of a channel `ÿ = a`, the error `z₁ = r − y` and its velocity's `z₂ = ẏ − ṙ − k₁ z₁`, the law
//!
//! ```text
//! a = r̈ + z₁ − k₂ z₂ − k₁ (z₂ + k₁ z₁)
//! ```
//!
//! makes `V = ½ (z₁² + z₂²)` fall as `V̇ = −k₁ z₁² − k₂ z₂²`: from `ż₁ = −z₂ − k₁ z₁`, and `ż₂ = a − r̈ − k₁ ż₁ = z₁ −
//! k₂ z₂`. The error obeys `ë + (k₁ + k₂) ė + (1 + k₁ k₂) e = 0`.
//!
//! # Source
//! S. Bouabdallah and R. Siegwart, *Backstepping and sliding-mode techniques applied to an indoor micro quadrotor*,
//! 2005, for the structure; here with feed-forward of the reference.

use mbs_runtime::Scalar;

use super::flatness;
use super::mixer::{Effort, Mixer, RotorSpeeds};
use mbs_models::quadrotor_euler::Params;

/// What a channel is to follow: value, rate, acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// r
    pub value: f64,
    /// ṙ
    pub rate: f64,
    /// r̈
    pub acceleration: f64,
}

impl Reference {
    /// A value to stay at.
    #[must_use]
    pub fn fixed(value: f64) -> Self {
        Reference { value, ..Reference::default() }
    }
}

/// Gains of one channel \[1/s\], positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// k₁
    pub k1: f64,
    /// k₂
    pub k2: f64,
}

impl Channel {
    /// The acceleration that brings y, with the rate v, to the reference.
    #[must_use]
    pub fn acceleration(&self, reference: Reference, y: f64, v: f64) -> f64 {
        let z1 = reference.value - y;
        let z2 = v - reference.rate - self.k1 * z1;
        reference.acceleration + z1 - self.k2 * z2 - self.k1 * (z2 + self.k1 * z1)
    }
}

/// The controller of a quadrotor, with what it knows of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backstepping {
    /// The quadrotor as the controller believes it to be.
    pub params: Params<f64>,
    /// Its rotors.
    pub mixer: Mixer,
    /// x and y.
    pub horizontal: Channel,
    /// z
    pub vertical: Channel,
    /// φ and θ
    pub tilt: Channel,
    /// ψ
    pub yaw: Channel,
    /// Least and greatest thrust, in units of the weight.
    pub thrust_range: [f64; 2],
    /// The greatest tilt that horizontal errors may ask for \[rad\].
    pub greatest_tilt: f64,
}

/// What the controller asks for, and what the rotors make of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Thrust \[N\] and torques \[N·m\] that are asked for, thrust within its range.
    pub effort: Effort,
    /// Whether thrust or tilt was limited.
    pub limited: bool,
    /// The rotors.
    pub rotors: RotorSpeeds,
}

/// The least part of g that counts as upward acceleration where the tilt is limited.
const LEAST_LIFT: f64 = 0.3;

impl Backstepping {
    /// Gains and limits for the landings of the thesis, assumed.
    #[must_use]
    pub fn new(params: Params<f64>) -> Self {
        Backstepping {
            params,
            mixer: Mixer::new(&params),
            horizontal: Channel { k1: 1.0, k2: 1.0 },
            vertical: Channel { k1: 2.5, k2: 2.5 },
            tilt: Channel { k1: 8.0, k2: 8.0 },
            yaw: Channel { k1: 4.0, k2: 4.0 },
            thrust_range: [0.05, 2.2],
            greatest_tilt: 25.0_f64.to_radians(),
        }
    }

    /// The command at a state that is to follow a position and a yaw \[rad\].
    ///
    /// Desired roll and pitch are taken as constant: the tilt is much faster than the position. Where a number of these
    /// is none, neither is a rotor's speed.
    #[must_use]
    pub fn command(&self, position: &[Reference; 3], heading: Reference, q: &[f64; 6], qd: &[f64; 6]) -> Command {
        let Params { g, inertias: [ix, iy, iz], .. } = self.params;
        let [phi, theta, psi] = [q[3], q[4], q[5]];
        let [phid, thetad, psid] = [qd[3], qd[4], qd[5]];
        let upward = self.vertical.acceleration(position[2], q[2], qd[2]);
        let (thrust, thrust_limited) = self.thrust(upward, phi, theta);

        let lift = if g + upward < LEAST_LIFT * g { LEAST_LIFT * g } else { g + upward };
        let greatest = lift * Scalar::tan(self.greatest_tilt);
        let ahead: [f64; 2] = [0, 1].map(|i| self.horizontal.acceleration(position[i], q[i], qd[i]));
        let size = Scalar::sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1]);
        // NaN stays NaN, here and where it allows no attitude.
        let scale = if size <= greatest { 1.0 } else { greatest / size };
        let [x, y] = ahead.map(|a| a * scale);
        let desired = flatness::attitude([x, y, lift - g], psi, g);
        let level = if (x + y + lift).is_finite() { 0.0 } else { f64::NAN };
        let (roll, pitch) = desired.map_or((level, level), |desired| (desired.roll, desired.pitch));

        let roll = self.tilt.acceleration(Reference::fixed(roll), nearest_turn(phi, roll), phid);
        let pitch = self.tilt.acceleration(Reference::fixed(pitch), nearest_turn(theta, pitch), thetad);
        let yaw = self.yaw.acceleration(heading, nearest_turn(psi, heading.value), psid);
        let torque = [
            ix * roll - (iy - iz) * thetad * psid,
            iy * pitch - (iz - ix) * phid * psid,
            iz * yaw - (ix - iy) * phid * thetad,
        ];
        let effort = Effort { thrust, torque };
        Command { effort, limited: thrust_limited || scale < 1.0, rotors: self.mixer.speeds(&effort) }
    }

    /// `m (g + a) / cφ cθ` within its range, and whether it was limited.
    fn thrust(&self, upward: f64, phi: f64, theta: f64) -> (f64, bool) {
        let Params { m, g, .. } = self.params;
        let asked = m * (g + upward) / (Scalar::cos(phi) * Scalar::cos(theta));
        let [least, greatest] = self.thrust_range.map(|part| part * m * g);
        // NaN stays NaN.
        let thrust = if asked < least { least } else { asked };
        let thrust = if thrust > greatest { greatest } else { thrust };
        (thrust, thrust != asked)
    }
}

/// The angle that differs from this one by whole turns and is nearest to another \[rad\].
pub(super) fn nearest_turn(angle: f64, other: f64) -> f64 {
    let d = angle - other;
    if d.abs() <= core::f64::consts::PI {
        return angle;
    }
    let (sin, cos) = Scalar::sin_cos(d);
    other + Scalar::atan2(sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_commanded_of_no_number() {
        let controller = Backstepping::new(Params::default());
        let fixed = Reference::fixed(0.0);
        let (position, q) = ([fixed; 3], [0.1; 6]);
        assert!(controller.command(&position, fixed, &q, &q).rotors.speed.iter().all(|speed| speed.is_finite()));
        let lost = |position: [Reference; 3], heading: Reference, q: [f64; 6], qd: [f64; 6]| {
            let rotors = controller.command(&position, heading, &q, &qd).rotors;
            assert!(rotors.speed.iter().any(|speed| speed.is_nan()), "{rotors:?}");
            assert!(rotors.greatest.is_nan() && rotors.least_square.is_nan(), "{rotors:?}");
        };
        for i in 0..6 {
            let mut unknown = q;
            unknown[i] = f64::NAN;
            lost(position, fixed, unknown, q);
            lost(position, fixed, q, unknown);
        }
        for i in 0..3 {
            let mut nowhere = position;
            nowhere[i].acceleration = f64::NAN;
            lost(nowhere, fixed, q, q);
        }
        lost(position, Reference::fixed(f64::NAN), q, q);
    }

    /// Poles of the closed channel: `s² + (k₁ + k₂) s + 1 + k₁ k₂`.
    #[test]
    fn a_channel_is_linear_in_its_errors() {
        let channel = Channel { k1: 3.0, k2: 2.0 };
        let reference = Reference { value: 1.0, rate: -0.5, acceleration: 0.25 };
        let (e, ed) = (0.7, -0.3);
        let a = channel.acceleration(reference, reference.value - e, reference.rate - ed);
        assert!((reference.acceleration - a + 5.0 * ed + 7.0 * e).abs() < 1e-15);
    }
}
