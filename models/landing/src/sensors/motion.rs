//! How a body moves: its frame with two derivatives, at any point fixed in it.

use mbs_models::quadrotor_euler::QuadrotorEuler;
use mbs_runtime::{Dual, to_matrix};
use nalgebra::{Matrix3, Vector3};

/// A frame of a body, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// From its axes to the world's.
    pub rotation: Matrix3<f64>,
    /// Its origin \[m\].
    pub place: Vector3<f64>,
    /// Velocity of the origin \[m/s\].
    pub velocity: Vector3<f64>,
    /// Acceleration of the origin \[m/s²\].
    pub acceleration: Vector3<f64>,
    /// ω \[rad/s\].
    pub angular_velocity: Vector3<f64>,
    /// α \[rad/s²\].
    pub angular_acceleration: Vector3<f64>,
}

impl Motion {
    /// Of the quadrotor's frame, at the mass centre: the output `pose` and its generated velocity `ẏ = J q̇`, whose
    /// rate `ÿ = J q̈ + J̇ q̇` is had from the same generated code in dual numbers along (q̇, q̈).
    #[must_use]
    pub fn of_quadrotor(q: &[f64; 6], qd: &[f64; 6], qdd: &[f64; 6]) -> Self {
        let vehicle = QuadrotorEuler::<Dual<f64>>::default();
        let calm = [[Dual::constant(0.0); 3]; 3];
        let along = |x: &[f64; 6], rate: &[f64; 6]| core::array::from_fn(|i| Dual { value: x[i], derivative: rate[i] });
        let (q, qd) = (along(q, qd), along(qd, qdd));
        let (pose, twist) = (vehicle.pose(&calm, &q), vehicle.pose_velocity(&calm, &q, &qd));
        let half = |first: usize, part: fn(&Dual<f64>) -> f64| Vector3::from_fn(|i, _| part(&twist[first + i]));
        Motion {
            rotation: to_matrix(&pose.rotation.map(|row| row.map(|entry| entry.value))),
            place: Vector3::from(pose.position.map(|x| x.value)),
            velocity: half(0, |x| x.value),
            acceleration: half(0, |x| x.derivative),
            angular_velocity: half(3, |x| x.value),
            angular_acceleration: half(3, |x| x.derivative),
        }
    }

    /// The same axes at a point r fixed in the body \[m\]:
    ///
    /// ```text
    /// x + R r      v + ω × R r      a + α × R r + ω × (ω × R r)
    /// ```
    #[must_use]
    pub fn at(&self, point: &[f64; 3]) -> Self {
        let lever = self.rotation * Vector3::from(*point);
        let around = self.angular_velocity.cross(&lever);
        Motion {
            place: self.place + lever,
            velocity: self.velocity + around,
            acceleration: self.acceleration
                + self.angular_acceleration.cross(&lever)
                + self.angular_velocity.cross(&around),
            ..*self
        }
    }
}
