//! A linear quadratic regulator of all thrusters, from the generated linearization at rest.
//!
//! Six thrusters move four coordinates. `u = −K x`, x = (q, q̇), makes `∫ xᵀ Q x + uᵀ R u dt` least, so of all thrusts
//! with the same effect it asks for the least in the sense of R: that is how they share the work. In heave, roll and
//! pitch the sea is stronger than the thrusters, and what they can do is damp: there Q weighs rates before all, in yaw
//! the angle, too. Greater gains make it worse: thrusters at their limits come late.

use mbs_models::marine_platform::{MarinePlatform, Params};
use mbs_runtime::control::{self, StateSpace};

use super::Four;
use super::thrusters::Thrust;

/// Coordinates and rates.
pub const STATES: usize = 8;

/// Deviations that count as much as each other, in the sense of Bryson: Q and R have their inverse squares on the
/// diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// The deviation of heave \[m\], roll, pitch and yaw \[rad\].
    pub position: Four,
    /// The deviation of their rates.
    pub rate: Four,
    /// The deviation of the thrusters \[N\].
    pub thrust: Thrust,
}

impl Default for Weights {
    /// 10 m, 20°, 20°, 1°; 0.25 m/s, 1.2, 1, 1 °/s; the thrusters' limits.
    fn default() -> Self {
        let angles = |[a, b, c]: [f64; 3]| [a, b, c].map(f64::to_radians);
        let ([roll, pitch, yaw], [p, q, r]) = (angles([20.0, 20.0, 1.0]), angles([1.2, 1.0, 1.0]));
        Self {
            position: [10.0, roll, pitch, yaw],
            rate: [0.25, p, q, r],
            thrust: super::thrusters::Thrusters::default().thrust,
        }
    }
}

/// The platform at rest as a linear system: A, and B of the thrusters.
#[must_use]
pub fn linearized(params: &Params) -> StateSpace<STATES, 6, STATES> {
    let slopes = MarinePlatform::new(*params).linearize(&[0.0; 4], &[0.0; 4], &[0.0; 10]);
    let n = STATES / 2;
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(j == i + n)),
        (false, true) => slopes.q[i - n][j],
        (false, false) => slopes.qd[i - n][j - n],
    };
    let a = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
    let b = core::array::from_fn(|i| if i < n { [0.0; 6] } else { core::array::from_fn(|j| slopes.u[i - n][j]) });
    StateSpace { a, b, c: diagonal(|_| 1.0), d: [[0.0; 6]; STATES] }
}

/// A feedback of all coordinates and rates, `u = −K x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator {
    /// Thrusts against coordinates and rates.
    pub gain: [[f64; STATES]; 6],
}

impl Regulator {
    /// Of a platform with these parameters.
    ///
    /// # Errors
    /// [`ControlError`](control::ControlError).
    pub fn new(params: &Params, weights: &Weights) -> Result<Self, control::ControlError> {
        let plant = linearized(params);
        let square = |deviation: f64| 1.0 / (deviation * deviation);
        let q = diagonal(|i| square(if i < 4 { weights.position[i] } else { weights.rate[i - 4] }));
        let regulator = control::lqr(&plant.a, &plant.b, &q, &diagonal(|i| square(weights.thrust[i])))?;
        Ok(Self { gain: regulator.gain })
    }

    /// The thrusts that it asks for, whether there are such or not \[N\].
    #[must_use]
    pub fn thrust(&self, q: &Four, qd: &Four) -> Thrust {
        self.gain.map(|row| -(0..4).map(|i| row[i] * q[i] + row[4 + i] * qd[i]).sum::<f64>())
    }
}

fn diagonal<const N: usize>(entry: impl Fn(usize) -> f64) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { entry(i) } else { 0.0 }))
}
