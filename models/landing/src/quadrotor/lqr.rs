//! A linear quadratic regulator about the flat trajectory, from the generated linearization.
//!
//! Straight over the platform the flat trajectory is upright, with equal rotor speeds `Ω² = m (g + z̈) / 4b`. About
//! hovering, errors `e = (q − q_r, q̇ − q̇_r)` and changes of speed v obey `ė = A e + B v`, with A and B from
//! [`QuadrotorEuler::linearize`]. `v = −K e` makes `∫ eᵀ Q e + vᵀ R v dt` least, with `K = R⁻¹ Bᵀ X` and
//!
//! ```text
//! Aᵀ X + X A − X B R⁻¹ Bᵀ X + Q = 0
//! ```
//!
//! by [`mbs_runtime::control::lqr`].

use mbs_runtime::{Scalar, control, to_matrix};
use nalgebra::SMatrix;

use super::backstepping::{Command, Reference, nearest_turn};
use super::mixer::Mixer;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};

/// Coordinates and velocities.
const STATES: usize = 12;
const INPUTS: usize = 4;

/// Deviations that count as much as each other, in the sense of Bryson: Q and R have their inverse squares on the
/// diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// The deviation of each position \[m\].
    pub position: f64,
    /// The deviation of each angle \[rad\].
    pub angle: f64,
    /// The deviation of each velocity \[m/s\].
    pub velocity: f64,
    /// Of each rate of an angle \[rad/s\].
    pub rate: f64,
    /// The deviation of each rotor's speed \[rad/s\].
    pub rotor_speed: f64,
}

impl Default for Weights {
    /// Half a metre, 10°, 1 m/s, 1 rad/s, 30 rad/s.
    fn default() -> Self {
        Weights { position: 0.5, angle: 10.0_f64.to_radians(), velocity: 1.0, rate: 1.0, rotor_speed: 30.0 }
    }
}

/// The regulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lqr {
    /// The quadrotor as the controller believes it to be.
    pub params: Params<f64>,
    /// Its rotors.
    pub mixer: Mixer,
    /// K: rotor speeds \[rad/s\] against errors of `q` and `q̇`.
    pub gain: SMatrix<f64, INPUTS, STATES>,
}

impl Lqr {
    /// For these deviations, about hovering.
    ///
    /// # Errors
    /// [`ControlError`](control::ControlError) where a parameter is NaN or infinite, or some motion is out of control.
    pub fn new(params: Params<f64>, weights: &Weights) -> Result<Self, control::ControlError> {
        let mixer = Mixer::new(&params);
        let (a, b) = linearized(&params);
        let square = |deviation: f64| 1.0 / (deviation * deviation);
        let q: [[f64; STATES]; STATES] = diagonal(|i| match i / 3 {
            0 => square(weights.position),
            1 => square(weights.angle),
            2 => square(weights.velocity),
            _ => square(weights.rate),
        });
        let r: [[f64; INPUTS]; INPUTS] = diagonal(|_| square(weights.rotor_speed));
        let regulator = control::lqr(&a, &b, &q, &r)?;
        Ok(Lqr { params, mixer, gain: to_matrix(&regulator.gain) })
    }

    /// The command at a state that is to follow a position and a yaw \[rad\], both near to those that it was made
    /// about: yaw 0.
    #[must_use]
    pub fn command(&self, position: &[Reference; 3], heading: Reference, q: &[f64; 6], qd: &[f64; 6]) -> Command {
        let Params { m, g, .. } = self.params;
        // NaN stays NaN.
        let pushed = |x: f64| if x < 0.0 { 0.0 } else { x };
        let steady = hover_speed(&self.params, m * pushed(g + position[2].acceleration));
        let level = Reference::default();
        let attitude = [level, level, heading];
        let error = SMatrix::<f64, STATES, 1>::from_fn(|i, _| match (i / 3, i % 3) {
            (0, k) => q[k] - position[k].value,
            (1, k) => nearest_turn(q[3 + k], attitude[k].value) - attitude[k].value,
            (2, k) => qd[k] - position[k].rate,
            (_, k) => qd[3 + k] - attitude[k].rate,
        });
        let change = self.gain * error;
        let asked: [f64; 4] = core::array::from_fn(|i| steady - change[i]);
        let limited = asked.iter().any(|&speed| speed < 0.0 || speed > self.mixer.greatest_speed);
        let effort = self.mixer.effort(&asked.map(pushed));
        Command { effort, limited, rotors: self.mixer.speeds(&effort) }
    }
}

/// Of each rotor, for this thrust \[N\].
fn hover_speed(params: &Params<f64>, thrust: f64) -> f64 {
    Scalar::sqrt(thrust / (4.0 * params.thrust_factor))
}

fn diagonal<const N: usize>(entry: impl Fn(usize) -> f64) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { entry(i) } else { 0.0 }))
}

/// A and B about hovering; errors in the order positions, angles, velocities, rates.
fn linearized(params: &Params<f64>) -> ([[f64; STATES]; STATES], [[f64; INPUTS]; STATES]) {
    let speed = hover_speed(params, params.m * params.g);
    let rest = [[0.0; 3]; 3];
    let slopes = QuadrotorEuler::new(*params).linearize(&rest, &[0.0; 6], &[0.0; 6], &[speed; 4]);
    let n = STATES / 2;
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(j == i + n)),
        (false, true) => slopes.q[i - n][j],
        (false, false) => slopes.qd[i - n][j - n],
    };
    let a = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
    (a, core::array::from_fn(|i| if i < n { [0.0; INPUTS] } else { slopes.u[i - n] }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_stabilizes() {
        let params = Params::default();
        let (a, b) = linearized(&params);
        let gain = Lqr::new(params, &Weights::default()).expect("a regulator").gain;
        let closed: SMatrix<f64, STATES, STATES> = to_matrix(&a) - to_matrix(&b) * gain;
        let slowest = closed.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
        assert!(slowest < -0.3, "{slowest}");
    }

    #[test]
    fn nothing_is_commanded_of_no_number() {
        let regulator = Lqr::new(Params::default(), &Weights::default()).expect("a regulator");
        let lost = |vertical: Reference, q: [f64; 6]| {
            let position = [Reference::default(), Reference::default(), vertical];
            let speeds = regulator.command(&position, Reference::default(), &q, &[0.0; 6]).rotors.speed;
            speeds.iter().any(|speed| speed.is_nan())
        };
        assert!(!lost(Reference::default(), [0.1; 6]));
        assert!(lost(Reference { acceleration: f64::NAN, ..Reference::default() }, [0.1; 6]));
        assert!(lost(Reference::default(), [0.1, f64::NAN, 0.1, 0.1, 0.1, 0.1]));
    }

    #[test]
    fn nothing_is_regulated_without_rotors() {
        let params = Params { thrust_factor: f64::NAN, ..Params::default() };
        assert!(matches!(Lqr::new(params, &Weights::default()), Err(control::ControlError::NotFinite { .. })));
    }
}
