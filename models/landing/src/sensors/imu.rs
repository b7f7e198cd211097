//! An inertial measurement unit: rates and specific force in axes of the body, with biases that walk and white noise.
//!
//! ```text
//! ω_m = Rᵀ ω + b_g + n_g       f_m = Rᵀ (a − g) + b_a + n_a       ḃ = w
//! ```
//!
//! at the place of the unit. A sample stands for an interval T and is what is the case in the middle of it, as behind a
//! filter that averages over the interval. White noise of the density σ then has the standard deviation σ/√T in a
//! sample, and a bias that walks with the density σ_w changes by σ_w √T from one sample to the next.
//!
//! # Source
//! J. L. Crassidis, *Sigma-point Kalman filtering for integrated GPS and inertial navigation*, 2006, appendix, for the
//! noise of samples.

use mbs_runtime::Scalar;
use nalgebra::Vector3;

use super::motion::Motion;
use super::{Normal, scattered};
use mbs_models::check::{Invalid, finite, not_negative, positive};

/// An IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu {
    /// From the mass centre, in axes of the body \[m\].
    pub place: [f64; 3],
    /// T \[s\].
    pub interval: f64,
    /// Its three gyroscopes \[rad/s\].
    pub gyro: Noise,
    /// Its three accelerometers \[m/s²\].
    pub accelerometer: Noise,
    /// Acceleration of gravity, downwards \[m/s²\].
    pub gravity: f64,
}

/// Noise of three axes alike, of a quantity of some unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// σ of the white noise \[unit/√Hz\].
    pub density: f64,
    /// σ_w of the white noise that drives the bias \[unit/s/√Hz\].
    pub walk: f64,
    /// Standard deviation of the bias when the unit is switched on \[unit\].
    pub bias: f64,
}

/// What an IMU says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuSample {
    /// Angular velocity in axes of the body \[rad/s\].
    pub rate: Vector3<f64>,
    /// Specific force in axes of the body \[m/s²\].
    pub specific_force: Vector3<f64>,
}

/// What an IMU adds to the true values, slowly changing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Biases {
    /// The angular velocity by the gyro \[rad/s\].
    pub gyro: Vector3<f64>,
    /// The specific force by the accelerometer \[m/s²\].
    pub accelerometer: Vector3<f64>,
}

impl Imu {
    /// Without bias and noise, on a body whose mass centre moves so.
    #[must_use]
    pub fn ideal(&self, body: &Motion) -> ImuSample {
        let here = body.at(&self.place);
        let gravity = Vector3::new(0.0, 0.0, -self.gravity);
        ImuSample {
            rate: here.rotation.tr_mul(&here.angular_velocity),
            specific_force: here.rotation.tr_mul(&(here.acceleration - gravity)),
        }
    }

    /// A sample; the biases then walk on to the next one.
    pub fn measure(&self, body: &Motion, biases: &mut Biases, normal: &mut impl Normal) -> ImuSample {
        let ImuSample { rate, specific_force } = self.ideal(body);
        let root = Scalar::sqrt(self.interval);
        let sample = ImuSample {
            rate: rate + biases.gyro + scattered(self.gyro.density / root, normal),
            specific_force: specific_force
                + biases.accelerometer
                + scattered(self.accelerometer.density / root, normal),
        };
        biases.gyro += scattered(self.gyro.walk * root, normal);
        biases.accelerometer += scattered(self.accelerometer.walk * root, normal);
        sample
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        finite("imu.place", self.place)?;
        positive("imu.interval", self.interval)?;
        positive("imu.gravity", self.gravity)?;
        let Noise { density, walk, bias } = self.gyro;
        not_negative("imu.gyro", [density, walk, bias])?;
        let Noise { density, walk, bias } = self.accelerometer;
        not_negative("imu.accelerometer", [density, walk, bias])
    }
}
