//! The rotor speeds that give generalized forces, by the generated ones.

use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::Scalar;

use super::mixer::{Effort, Mixer};

/// The rotors of a vehicle, with the drag and the gyroscopic moments that they have in it.
#[derive(Clone, Debug)]
pub struct Rotors {
    mixer: Mixer,
    vehicle: QuadrotorEuler<f64>,
}

/// What the rotors are to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// The speed of each rotor \[rad/s\].
    pub speed: [f64; 4],
    /// Whether one of them would have to turn backwards.
    pub limited: bool,
}

/// Air that does not move: the prescribed signals of the mechanism without wind.
pub const CALM: [[f64; 3]; 3] = [[0.0; 3]; 3];
/// Each takes the error to a thirtieth or less: gyroscopic moments are small.
const ITERATIONS: usize = 8;

impl Rotors {
    /// Of a vehicle with these parameters.
    #[must_use]
    pub fn new(params: &Params<f64>) -> Self {
        Self { mixer: Mixer::new(params), vehicle: QuadrotorEuler::new(*params) }
    }

    /// Speeds with which the forces \[N\] and torques \[N·m\] of z, φ, θ, ψ are these: the mixer's for what is left of
    /// them without drag of the air and gyroscopic moments, which the generated forces have besides.
    ///
    /// Where no speeds give them, a rotor stands still.
    #[must_use]
    pub fn speeds(&self, wanted: &[f64; 4], q: &[f64; 6], qd: &[f64; 6]) -> Speeds {
        let mut rotors = self.mixer.speeds(&effort(wanted, q));
        for _ in 0..ITERATIONS {
            let all = self.vehicle.generalized_force(&CALM, q, qd, &rotors.speed);
            let own = forces(&self.mixer.effort(&rotors.speed), q);
            let left = core::array::from_fn(|i| wanted[i] - (all[i + 2] - own[i]));
            rotors = self.mixer.speeds(&effort(&left, q));
        }
        Speeds { speed: rotors.speed, limited: rotors.saturated }
    }

    /// Thrust \[N\] and torques \[N·m\] of these speeds.
    #[must_use]
    pub fn effort_of(&self, speed: &[f64; 4]) -> [f64; 4] {
        let Effort { thrust, torque: [x, y, z] } = self.mixer.effort(speed);
        [thrust, x, y, z]
    }
}

/// Forces of z, φ, θ, ψ, of thrust along the body's axis, and `Q = Tᵀ τ`.
fn forces(&Effort { thrust, torque: [x, y, z] }: &Effort, q: &[f64; 6]) -> [f64; 4] {
    let ((sr, cr), (sp, cp)) = (Scalar::sin_cos(q[3]), Scalar::sin_cos(q[4]));
    [thrust * cr * cp, x, cr * y - sr * z, cp * (sr * y + cr * z) - sp * x]
}

/// The other way: `τ = T⁻ᵀ Q`.
fn effort(&[lift, roll, pitch, yaw]: &[f64; 4], q: &[f64; 6]) -> Effort {
    let ((sr, cr), (sp, cp)) = (Scalar::sin_cos(q[3]), Scalar::sin_cos(q[4]));
    let across = (yaw + sp * roll) / cp;
    Effort { thrust: lift / (cr * cp), torque: [roll, cr * pitch + sr * across, cr * across - sr * pitch] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vehicle_feels_what_was_wanted() {
        let params = Params::default();
        let (rotors, vehicle) = (Rotors::new(&params), QuadrotorEuler::new(params));
        let (q, qd) = ([0.0, 0.0, 9.0, 0.3, -0.4, 1.1], [1.0, -2.0, 0.5, 0.6, -0.7, 0.8]);
        let wanted = [380.0, 12.0, -7.0, 2.0];
        let Speeds { speed, limited } = rotors.speeds(&wanted, &q, &qd);
        let forces = vehicle.generalized_force(&CALM, &q, &qd, &speed);
        assert!(!limited && (0..4).all(|i| (forces[i + 2] - wanted[i]).abs() < 1e-10), "{forces:?}");
        assert!(rotors.speeds(&[10.0, 400.0, 0.0, 0.0], &q, &qd).limited);
    }
}
