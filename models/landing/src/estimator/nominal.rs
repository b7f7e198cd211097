//! The nominal state, its errors, and its step in time.

use nalgebra::{Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};

use crate::sensors::Pose;
use crate::sensors::imu::{Biases, ImuSample};
use mbs_models::sensors::strapdown::Strapdown;
use mbs_runtime::to_matrix;

/// Errors of place, velocity, attitude, gyroscopes' and accelerometers' biases, three each.
pub const ERRORS: usize = 15;

/// Where the errors of the state begin.
pub const PLACE: usize = 0;
/// Where those of the velocity begin.
pub const VELOCITY: usize = 3;
/// Where those of the attitude begin.
pub const ATTITUDE: usize = 6;
/// Where those of the gyroscopes' biases begin.
pub const GYRO: usize = 9;
/// Where those of the accelerometers' biases begin.
pub const ACCELEROMETER: usize = 12;

/// The state of the IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Its place, and the attitude of the body.
    pub pose: Pose,
    /// Its velocity \[m/s\].
    pub velocity: Vector3<f64>,
    /// Its biases.
    pub biases: Biases,
}

/// A step of the nominal state, to first order in errors and noise: `δ⁺ = F δ + G n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The state after it.
    pub next: Nominal,
    /// F
    pub transition: SMatrix<f64, ERRORS, ERRORS>,
    /// G, of the white noise of rates and specific force.
    pub input: SMatrix<f64, ERRORS, 6>,
}

impl Nominal {
    /// With these errors: the state of which they are the errors.
    #[must_use]
    pub fn with(&self, errors: &SVector<f64, ERRORS>, origin: &Vector3<f64>) -> Self {
        let part = |first: usize| errors.fixed_rows::<3>(first).into_owned();
        Nominal {
            pose: moved(&self.pose, origin, &part(PLACE), &part(ATTITUDE)),
            velocity: turned(&self.pose, &part(ATTITUDE)) * self.velocity + part(VELOCITY),
            biases: Biases {
                gyro: self.biases.gyro + part(GYRO),
                accelerometer: self.biases.accelerometer + part(ACCELEROMETER),
            },
        }
    }

    /// The errors of this estimate where that is the truth.
    #[must_use]
    pub fn errors(&self, truth: &Nominal, origin: &Vector3<f64>) -> SVector<f64, ERRORS> {
        let mut errors = SVector::<f64, ERRORS>::zeros();
        let turn = (self.pose.attitude.inverse() * truth.pose.attitude).scaled_axis();
        let turned = turned(&self.pose, &turn);
        for (first, error) in [
            (PLACE, truth.pose.place - origin - turned * (self.pose.place - origin)),
            (VELOCITY, truth.velocity - turned * self.velocity),
            (ATTITUDE, turn),
            (GYRO, truth.biases.gyro - self.biases.gyro),
            (ACCELEROMETER, truth.biases.accelerometer - self.biases.accelerometer),
        ] {
            errors.fixed_rows_mut::<3>(first).copy_from(&error);
        }
        errors
    }

    /// What is missing from this estimate to the truth: place, velocity, attitude as a rotation vector in axes of the
    /// body, biases.
    #[must_use]
    pub fn differences(&self, truth: &Nominal) -> SVector<f64, ERRORS> {
        let mut differences = self.errors(truth, &Vector3::zeros());
        differences.fixed_rows_mut::<3>(PLACE).copy_from(&(truth.pose.place - self.pose.place));
        differences.fixed_rows_mut::<3>(VELOCITY).copy_from(&(truth.velocity - self.velocity));
        differences
    }

    /// Differences by errors: place and velocity are turned by the error of the attitude.
    pub(super) fn differences_by_errors(&self, origin: &Vector3<f64>) -> SMatrix<f64, ERRORS, ERRORS> {
        let mut matrix = SMatrix::<f64, ERRORS, ERRORS>::identity();
        for (first, arm) in [(PLACE, self.pose.place - origin), (VELOCITY, self.velocity)] {
            matrix.fixed_view_mut::<3, 3>(first, ATTITUDE).copy_from(&-turning(&arm, &self.pose));
        }
        matrix
    }

    /// An interval later, by what the IMU said in it.
    #[must_use]
    pub fn step(&self, model: &Strapdown<f64>, sample: &ImuSample, origin: &Vector3<f64>) -> Step {
        let (q, v, u) = (self.pose.coordinates(), self.velocity, self.corrected(sample));
        let qd = [v.x, v.y, v.z, 0.0, 0.0, 0.0, 0.0];
        let [w, x, y, z] = model.next_attitude(&q, &u);
        let place = Vector3::from(model.next_place(&q, &qd, &u));
        let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        let next = Nominal {
            pose: Pose { place, attitude },
            velocity: Vector3::from(model.next_velocity(&q, &qd, &u)),
            biases: self.biases,
        };

        let errors = errors_to_coordinates(&self.pose, origin);
        let velocity_by_turn = -turning(&self.velocity, &self.pose);
        let mut transition = SMatrix::<f64, ERRORS, ERRORS>::identity();
        let mut input = SMatrix::<f64, ERRORS, 6>::zeros();
        let mut rows = |first: usize, by_q: SMatrix<f64, 3, 7>, by_v: Matrix3<f64>, by_u: SMatrix<f64, 3, 6>| {
            let by_errors = by_q * errors;
            let mut set = |column: usize, block: Matrix3<f64>| {
                transition.fixed_view_mut::<3, 3>(first, column).copy_from(&block);
            };
            set(PLACE, by_errors.fixed_columns::<3>(0).into_owned());
            set(VELOCITY, by_v);
            set(ATTITUDE, by_errors.fixed_columns::<3>(3) + by_v * velocity_by_turn);
            // What is felt is what was said less bias and noise.
            set(GYRO, -by_u.fixed_columns::<3>(0).into_owned());
            set(ACCELEROMETER, -by_u.fixed_columns::<3>(3).into_owned());
            input.fixed_rows_mut::<3>(first).copy_from(&-by_u);
        };
        let of_velocity = |by_qd: [[f64; 7]; 3]| to_matrix(&by_qd).fixed_columns::<3>(0).into_owned();
        rows(
            PLACE,
            to_matrix(&model.next_place_jacobian(&q, &u)),
            of_velocity(model.next_place_jacobian_qd(&q)),
            to_matrix(&model.next_place_jacobian_u(&q, &u)),
        );
        rows(
            VELOCITY,
            to_matrix(&model.next_velocity_jacobian(&q, &u)),
            of_velocity(model.next_velocity_jacobian_qd(&q)),
            to_matrix(&model.next_velocity_jacobian_u(&q, &u)),
        );
        let turn = 2.0 * of_error(&next.pose.attitude).transpose();
        rows(
            ATTITUDE,
            turn * to_matrix(&model.next_attitude_jacobian(&q, &u)),
            Matrix3::zeros(),
            turn * to_matrix(&model.next_attitude_jacobian_u(&q, &u)),
        );
        // From changes of place and velocity to errors: less what the error of the attitude turns.
        for (first, arm) in [(PLACE, next.pose.place - origin), (VELOCITY, next.velocity)] {
            let arm = turning(&arm, &next.pose);
            let rows = arm * transition.fixed_rows::<3>(ATTITUDE);
            let mut of_vector = transition.fixed_rows_mut::<3>(first);
            of_vector += rows;
            let rows = arm * input.fixed_rows::<3>(ATTITUDE);
            let mut of_vector = input.fixed_rows_mut::<3>(first);
            of_vector += rows;
        }
        Step { next, transition, input }
    }

    /// Rates and specific force without the biases that it has.
    #[must_use]
    pub fn corrected(&self, sample: &ImuSample) -> [f64; 6] {
        let (rate, force) = (sample.rate - self.biases.gyro, sample.specific_force - self.biases.accelerometer);
        let mut u = SVector::<f64, 6>::zeros();
        u.fixed_rows_mut::<3>(0).copy_from(&rate);
        u.fixed_rows_mut::<3>(3).copy_from(&force);
        u.into()
    }
}

/// A pose with these errors of place and attitude.
#[must_use]
pub fn moved(pose: &Pose, origin: &Vector3<f64>, place: &Vector3<f64>, turn: &Vector3<f64>) -> Pose {
    Pose {
        place: origin + turned(pose, turn) * (pose.place - origin) + place,
        attitude: pose.attitude * UnitQuaternion::from_scaled_axis(*turn),
    }
}

/// `R̂ exp[δθ]× R̂ᵀ`: an error of the attitude as a turn of the world.
fn turned(pose: &Pose, turn: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(pose.attitude * turn)
}

/// `[r]× R̂`: what an error of the attitude takes from an arm r, `−[r]× R̂ δθ = (R̂ δθ) × r`, with its sign turned.
fn turning(arm: &Vector3<f64>, pose: &Pose) -> Matrix3<f64> {
    arm.cross_matrix() * pose.attitude.to_rotation_matrix().matrix()
}

/// ∂(x, e)/∂(δx, δθ): the place turns about the origin, `∂e/∂δθ` is that of `e ⊗ (1, ½ δθ)`. Solà 2017, (281).
#[must_use]
pub fn errors_to_coordinates(pose: &Pose, origin: &Vector3<f64>) -> SMatrix<f64, 7, 6> {
    let mut matrix = SMatrix::<f64, 7, 6>::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&-turning(&(pose.place - origin), pose));
    matrix.fixed_view_mut::<4, 3>(3, 3).copy_from(&(0.5 * of_error(&pose.attitude)));
    matrix
}

/// Columns: `e ⊗ i`, `e ⊗ j`, `e ⊗ k`, scalar part first. They are orthonormal.
fn of_error(attitude: &UnitQuaternion<f64>) -> SMatrix<f64, 4, 3> {
    let e = attitude.quaternion();
    to_matrix(&[[-e.i, -e.j, -e.k], [e.w, -e.k, e.j], [e.k, e.w, -e.i], [-e.j, e.i, e.w]])
}

/// Right Jacobian of the rotation vector: `exp(φ + δ) ≈ exp(φ) exp(J δ)`, by its series, exact to 1e-9 up to 0.5 rad.
///
/// `J = I − (1 − cos φ)/φ² [φ]× + (φ − sin φ)/φ³ [φ]×²`, Solà 2017, (183).
#[must_use]
pub fn right_jacobian(rotation: &Vector3<f64>) -> Matrix3<f64> {
    let (cross, square) = (rotation.cross_matrix(), rotation.norm_squared());
    let first = 1.0 / 2.0 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0));
    let second = 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0));
    Matrix3::identity() - first * cross + second * cross * cross
}
