//! Sensors of the vehicle: what an IMU, a laser altimeter and a camera say while it lands.
//!
//! Rates and accelerations come from the quadrotor's output `pose` and its derivatives ([`motion`]); ranges and pixels
//! are outputs of [`sensor_head`](mbs_models::sensors::sensor_head), a mechanism of its own, whose Jacobians the
//! [`estimator`](crate::estimator) uses.
//!
//! - [`imu`]: rates, specific force, biases that walk;
//! - [`altimeter`]: range to the deck's plane;
//! - [`camera`]: markers of the deck in the image, delayed.

pub mod altimeter;
pub mod camera;
pub mod imu;
pub mod motion;

use nalgebra::{UnitQuaternion, Vector3};

use crate::quadrotor::deck::DeckState;
use altimeter::Altimeter;
use camera::{Camera, MARKERS};
use imu::{Imu, Noise};
use mbs_models::check::{Invalid, Must, finite};
use mbs_models::sensors::sensor_head::{Params, SensorHead};

/// Independent normal deviates of mean 0 and variance 1.
pub trait Normal {
    /// One more.
    fn next(&mut self) -> f64;
}

impl<F: FnMut() -> f64> Normal for F {
    fn next(&mut self) -> f64 {
        self()
    }
}

/// Three deviates of this standard deviation.
pub(crate) fn scattered(deviation: f64, normal: &mut impl Normal) -> Vector3<f64> {
    Vector3::from_fn(|_, _| deviation * normal.next())
}

/// Where the IMU is, and the attitude of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The place \[m\].
    pub place: Vector3<f64>,
    /// From axes of the body to the world's.
    pub attitude: UnitQuaternion<f64>,
}

impl Pose {
    /// `(x, y, z, e₀, e₁, e₂, e₃)` of the generated mechanisms, scalar part first.
    #[must_use]
    pub fn coordinates(&self) -> [f64; 7] {
        let (x, e) = (self.place, self.attitude.quaternion());
        [x.x, x.y, x.z, e.w, e.i, e.j, e.k]
    }
}

/// Inputs of the sensor head: a marker's place, a point and the normal of the deck's plane, in the world.
#[must_use]
pub fn deck_inputs(deck: &DeckState, marker: &Vector3<f64>) -> [f64; 9] {
    let ([x, y, z], [[_, _, nx], [_, _, ny], [_, _, nz]]) = (deck.position, deck.rotation);
    [marker.x, marker.y, marker.z, x, y, z, nx, ny, nz]
}

/// All sensors of the vehicle, and the markers that its camera knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Rates and specific force.
    pub imu: Imu,
    /// Range.
    pub altimeter: Altimeter,
    /// Markers.
    pub camera: Camera,
    /// Places of the markers, in axes of the deck from the point that is landed on \[m\].
    pub markers: [[f64; 3]; MARKERS],
}

impl Sensors {
    /// Of a small vehicle: a MEMS IMU, a laser altimeter, a camera of 640 × 480 pixels. Assumed.
    pub const TYPICAL: Self = Sensors {
        imu: Imu {
            place: [0.05, -0.03, 0.04],
            interval: 0.005,
            gyro: Noise { density: 2.4e-4, walk: 1e-5, bias: 1e-3 },
            accelerometer: Noise { density: 1.7e-3, walk: 1e-4, bias: 0.05 },
            gravity: 9.80665,
        },
        altimeter: Altimeter {
            place: [-0.1, 0.05, 0.0],
            noise: 0.02,
            period: 0.02,
            ranges: [0.1, 30.0],
            greatest_incidence: 0.52,
        },
        camera: Camera {
            place: [0.12, 0.0, 0.0],
            focal: 400.0,
            size: [640.0, 480.0],
            noise: 0.5,
            margin: 8.0,
            least_depth: 0.15,
            period: 0.1,
            delay: 0.08,
        },
        markers: [
            [0.8, 0.5, 0.0],
            [-0.8, 0.5, 0.0],
            [-0.8, -0.5, 0.0],
            [0.8, -0.5, 0.0],
            [0.2, 0.12, 0.0],
            [-0.2, 0.12, 0.0],
            [-0.2, -0.12, 0.0],
            [0.2, -0.12, 0.0],
        ],
    };

    /// The generated mechanism of camera and altimeter, with their places from the IMU.
    #[must_use]
    pub fn head(&self) -> SensorHead<f64> {
        let from_imu = |place: &[f64; 3]| core::array::from_fn(|i| place[i] - self.imu.place[i]);
        SensorHead::new(Params {
            focal: self.camera.focal,
            principal: self.camera.size.map(|size| 0.5 * size),
            lens_place: from_imu(&self.camera.place),
            laser_place: from_imu(&self.altimeter.place),
        })
    }

    /// Whether every number makes sense, and all times are whole intervals of the IMU.
    ///
    /// # Errors
    /// [`Invalid`], the first number that does not.
    pub fn check(&self) -> Result<(), Invalid> {
        self.imu.check()?;
        self.altimeter.check()?;
        self.camera.check()?;
        for marker in self.markers {
            finite("markers", marker)?;
        }
        let interval = self.imu.interval;
        for (name, time) in [
            ("altimeter.period", self.altimeter.period),
            ("camera.period", self.camera.period),
            ("camera.delay", self.camera.delay),
        ] {
            let off = time - interval * intervals(time, interval) as f64;
            if off.abs() > 1e-9 * interval {
                return Err(Must::BeWithin([time - off; 2]).broken_by(name, time));
            }
        }
        let (delay, period) = (self.camera.delay, self.camera.period);
        if delay >= period {
            return Err(Must::BeWithin([0.0, period - interval]).broken_by("camera.delay", delay));
        }
        Ok(())
    }
}

/// The nearest number of intervals in a time that is not negative; beyond all counting for what is that long.
pub(crate) fn intervals(time: f64, interval: f64) -> u64 {
    (time / interval + 0.5) as u64
}
