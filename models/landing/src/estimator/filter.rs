//! The filter: a nominal state with the covariance of its errors, and of those of the clone.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::chi_square;
use super::nominal::{ACCELEROMETER, ATTITUDE, ERRORS, GYRO, Nominal, PLACE, VELOCITY, moved, right_jacobian};
use crate::sensors::Pose;
use crate::sensors::imu::{Imu, ImuSample};
use mbs_models::sensors::strapdown::{Params, Strapdown};
use mbs_runtime::Scalar;

/// Errors of the state, then those of place and attitude of the clone.
pub const ALL: usize = ERRORS + 6;

/// Where the errors of the clone begin.
pub const CLONE: usize = ERRORS;

/// Normal deviate beyond which a measurement is not believed: at most one in 100 000 of good
/// ones.
pub const GATE: f64 = 4.264_890_793_922_825;

/// How often the equations of a measurement are linearized anew, at most.
const ITERATIONS: usize = 6;

/// A change below this part of a standard deviation ends the iteration.
const SETTLED: f64 = 1e-3;

/// What is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The state.
    pub nominal: Nominal,
    /// The pose at the last image.
    pub clone: Pose,
    /// What errors of the attitude turn everything about \[m\].
    pub origin: Vector3<f64>,
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Filter {
    /// What is estimated.
    pub estimate: Estimate,
    /// Covariance of all errors.
    pub covariance: SMatrix<f64, ALL, ALL>,
    model: Strapdown<f64>,
    /// Variances of the white noise of rates and specific force in a sample.
    white: SVector<f64, 6>,
    /// Variances of the steps of the biases.
    walk: SVector<f64, 6>,
}

/// Standard deviations of the first state, each of three axes alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// The place \[m\].
    pub place: f64,
    /// The velocity \[m/s\].
    pub velocity: f64,
    /// The attitude \[rad\].
    pub attitude: f64,
}

impl Uncertainty {
    /// Those of `landing_monte_carlo`'s starts.
    pub const START: Self = Uncertainty { place: 0.3, velocity: 0.2, attitude: 0.035 };

    /// Of all errors of a state; those of the biases are the IMU's.
    #[must_use]
    pub fn deviations(&self, imu: &Imu) -> SVector<f64, ERRORS> {
        let mut deviations = SVector::<f64, ERRORS>::zeros();
        for (first, deviation) in [
            (PLACE, self.place),
            (VELOCITY, self.velocity),
            (ATTITUDE, self.attitude),
            (GYRO, imu.gyro.bias),
            (ACCELEROMETER, imu.accelerometer.bias),
        ] {
            deviations.fixed_rows_mut::<3>(first).fill(deviation);
        }
        deviations
    }
}

/// A measurement about an estimate: `z = h + H δ + n`, its rows independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearized<const M: usize> {
    /// z − h
    pub residual: SVector<f64, M>,
    /// H
    pub jacobian: SMatrix<f64, M, ALL>,
    /// Variances of n.
    pub variance: SVector<f64, M>,
    /// How many of its rows are measured; the others are zero.
    pub freedom: usize,
}

/// How a measurement compared with what was expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Normalized innovation squared, `νᵀ S⁻¹ ν`.
    pub squared: f64,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// Whether it was believed.
    pub accepted: bool,
}

impl Filter {
    /// Of a first state with independent errors, which turn it about an origin: the place that sensors look at.
    #[must_use]
    pub fn new(imu: &Imu, nominal: Nominal, origin: Vector3<f64>, deviations: &SVector<f64, ERRORS>) -> Self {
        let Imu { interval, gyro, accelerometer, gravity, .. } = *imu;
        let of_both = |gyro: f64, accelerometer: f64| {
            SVector::<f64, 6>::from_fn(|i, _| if i < 3 { gyro * gyro } else { accelerometer * accelerometer })
        };
        let mut covariance = SMatrix::<f64, ALL, ALL>::zeros();
        covariance.fixed_view_mut::<ERRORS, ERRORS>(0, 0).set_diagonal(&deviations.component_mul(deviations));
        let mut filter = Filter {
            estimate: Estimate { nominal, clone: nominal.pose, origin },
            covariance,
            model: Strapdown::new(Params { interval, g: gravity }),
            white: of_both(gyro.density, accelerometer.density) / interval,
            walk: of_both(gyro.walk, accelerometer.walk) * interval,
        };
        filter.clone_pose();
        filter
    }

    /// An interval on: `P⁺ = F P Fᵀ + G W Gᵀ + W_b`. Biases and clone stay, so that only the first rows of F count.
    pub fn propagate(&mut self, sample: &ImuSample) {
        let step = self.estimate.nominal.step(&self.model, sample, &self.estimate.origin);
        self.estimate.nominal = step.next;
        let (f, g) = (step.transition.fixed_rows::<GYRO>(0), step.input.fixed_rows::<GYRO>(0));
        let rows = f * self.covariance.fixed_rows::<ERRORS>(0);
        let scaled = g * SMatrix::<f64, 6, 6>::from_diagonal(&self.white);
        let moving = rows.fixed_columns::<ERRORS>(0) * f.transpose() + scaled * g.transpose();
        self.covariance.fixed_rows_mut::<GYRO>(0).copy_from(&rows);
        self.covariance.fixed_columns_mut::<GYRO>(0).copy_from(&rows.transpose());
        self.covariance.fixed_view_mut::<GYRO, GYRO>(0, 0).copy_from(&(0.5 * (moving + moving.transpose())));
        for i in 0..6 {
            self.covariance[(GYRO + i, GYRO + i)] += self.walk[i];
        }
    }

    /// Keeps the pose of this moment as the clone.
    pub fn clone_pose(&mut self) {
        self.estimate.clone = self.estimate.nominal.pose;
        let source = |i: usize| match i {
            _ if i < CLONE => i,
            _ if i < CLONE + 3 => PLACE + i - CLONE,
            _ => ATTITUDE + i - CLONE - 3,
        };
        let p = self.covariance;
        self.covariance = SMatrix::from_fn(|i, j| p[(source(i), source(j))]);
    }

    /// Corrects state and clone by a measurement, which is linearized about every estimate it is asked for.
    ///
    /// The estimate is the minimum of `‖δ‖²` in the metric of P⁻¹ and of the residual in that of its own variance,
    /// found by Gauss and Newton's iterations, of which the first is the extended Kalman filter's. The covariance is
    /// Joseph's, `(I − K H) P (I − K H)ᵀ + K V Kᵀ`, and is then carried to the axes of the corrected attitudes.
    pub fn correct<const M: usize>(&mut self, measured: impl Fn(&Estimate) -> Linearized<M>) -> Innovation {
        let (p, prior) = (self.covariance, self.estimate);
        let mut errors = SVector::<f64, ALL>::zeros();
        let mut innovation = None;
        let mut last = None;
        for _ in 0..ITERATIONS {
            let at = prior.with(&errors);
            let about = measured(&at);
            let h = carried(about.jacobian, &at.transport(&errors));
            let expected = about.residual + h * errors;
            let ph = p * h.transpose();
            let s = h * ph + SMatrix::<f64, M, M>::from_diagonal(&about.variance);
            let Some(s) = s.cholesky() else {
                return Innovation { squared: f64::NAN, freedom: about.freedom, accepted: false };
            };
            let seen = innovation.get_or_insert_with(|| {
                let squared = expected.dot(&s.solve(&expected));
                let accepted = squared <= chi_square::gate(GATE, about.freedom as f64);
                Innovation { squared, freedom: about.freedom, accepted }
            });
            if !seen.accepted {
                return *seen;
            }
            let gain = s.solve(&ph.transpose()).transpose();
            let better = gain * expected;
            let change = better - errors;
            errors = better;
            last = Some((gain, h, about.variance));
            if (0..ALL).all(|i| change[i].abs() <= SETTLED * Scalar::sqrt(p[(i, i)])) {
                break;
            }
        }
        self.estimate = prior.with(&errors);
        if let Some((gain, h, variance)) = last {
            let left = p - gain * (h * p);
            let noise = gain * SMatrix::<f64, M, M>::from_diagonal(&variance);
            self.covariance = left + (noise - left * h.transpose()) * gain.transpose();
        }
        self.reset(&self.estimate.transport(&errors));
        self.covariance = 0.5 * (self.covariance + self.covariance.transpose());
        innovation.unwrap_or(Innovation { squared: 0.0, freedom: 0, accepted: true })
    }

    /// Γ P Γᵀ, in the axes of the corrected attitudes.
    fn reset(&mut self, transport: &Transport) {
        for &(row, column, block) in transport.iter().rev() {
            let source = block * self.covariance.fixed_rows::<3>(column);
            let sum = if row == column { source } else { self.covariance.fixed_rows::<3>(row) + source };
            self.covariance.fixed_rows_mut::<3>(row).copy_from(&sum);
        }
        for &(row, column, block) in transport.iter().rev() {
            let source = self.covariance.fixed_columns::<3>(column) * block.transpose();
            let sum = if row == column { source } else { self.covariance.fixed_columns::<3>(row) + source };
            self.covariance.fixed_columns_mut::<3>(row).copy_from(&sum);
        }
    }

    /// Covariance of the state alone.
    #[must_use]
    pub fn state_covariance(&self) -> SMatrix<f64, ERRORS, ERRORS> {
        self.covariance.fixed_view::<ERRORS, ERRORS>(0, 0).into_owned()
    }

    /// Standard deviations of the [differences](Nominal::differences) from the truth, to first order.
    #[must_use]
    pub fn deviations(&self) -> SVector<f64, ERRORS> {
        let by_errors = self.estimate.nominal.differences_by_errors(&self.estimate.origin);
        (by_errors * self.state_covariance() * by_errors.transpose()).diagonal().map(Scalar::sqrt)
    }

    /// Normalized estimation error squared, `δᵀ P⁻¹ δ` of the state's errors where that is the truth; NaN where P is
    /// not positive definite.
    #[must_use]
    pub fn normalized_error(&self, truth: &Nominal) -> f64 {
        let errors = self.estimate.nominal.errors(truth, &self.estimate.origin);
        self.state_covariance().cholesky().map_or(f64::NAN, |p| errors.dot(&p.solve(&errors)))
    }
}

impl Estimate {
    /// With these errors.
    #[must_use]
    pub fn with(&self, errors: &SVector<f64, ALL>) -> Self {
        Estimate {
            nominal: self.nominal.with(&errors.fixed_rows::<ERRORS>(0).into_owned(), &self.origin),
            clone: moved(&self.clone, &self.origin, &three(errors, CLONE), &three(errors, CLONE + 3)),
            origin: self.origin,
        }
    }

    /// Γ, by which errors δ about a first estimate become those about this one, which is the first one with the errors
    /// d: `Γ (δ − d)` to first order in δ − d.
    ///
    /// ```text
    /// J(dθ) (δθ − dθ)        δx − dx + [dx]× R J(dθ) (δθ − dθ)        the same for v
    /// ```
    ///
    /// with the right Jacobian J: `I − ½ [dθ]×` to first order, Solà 2017, (287).
    fn transport(&self, errors: &SVector<f64, ALL>) -> Transport {
        let of = |pose: &Pose, attitude: usize| {
            let turn = right_jacobian(&three(errors, attitude));
            (turn, pose.attitude.to_rotation_matrix().matrix() * turn)
        };
        let across = |first: usize, turned: &Matrix3<f64>| three(errors, first).cross_matrix() * turned;
        let (own, turned) = of(&self.nominal.pose, ATTITUDE);
        let (cloned, turned_clone) = of(&self.clone, CLONE + 3);
        [
            (ATTITUDE, ATTITUDE, own),
            (PLACE, ATTITUDE, across(PLACE, &turned)),
            (VELOCITY, ATTITUDE, across(VELOCITY, &turned)),
            (CLONE + 3, CLONE + 3, cloned),
            (CLONE, CLONE + 3, across(CLONE, &turned_clone)),
        ]
    }
}

/// Blocks of Γ by row and column; elsewhere it is the identity. Of each attitude that of itself comes first.
type Transport = [(usize, usize, Matrix3<f64>); 5];

/// H Γ
fn carried<const M: usize>(mut h: SMatrix<f64, M, ALL>, transport: &Transport) -> SMatrix<f64, M, ALL> {
    for &(row, column, block) in transport {
        let part = h.fixed_columns::<3>(row) * block;
        let sum = if row == column { part } else { h.fixed_columns::<3>(column) + part };
        h.fixed_columns_mut::<3>(column).copy_from(&sum);
    }
    h
}

fn three(errors: &SVector<f64, ALL>, first: usize) -> Vector3<f64> {
    errors.fixed_rows::<3>(first).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::imu::Biases;
    use nalgebra::UnitQuaternion;

    fn pose(a: f64) -> Pose {
        let attitude = UnitQuaternion::from_scaled_axis(Vector3::new(0.1 * a, -0.2, 0.3));
        Pose { place: Vector3::new(1.0, a, 6.0), attitude }
    }

    /// Γ against differences: errors about the corrected estimate of states with errors near those of the correction.
    #[test]
    fn errors_are_carried_to_the_corrected_estimate() {
        let nominal = Nominal { pose: pose(1.0), velocity: Vector3::new(0.5, 1.0, -2.0), biases: Biases::default() };
        let estimate = Estimate { nominal, clone: pose(2.0), origin: Vector3::new(0.3, 0.2, 0.1) };
        let correction = SVector::<f64, ALL>::from_fn(|i, _| 0.1 * Scalar::sin(i as f64 + 1.0));
        let corrected = estimate.with(&correction);
        // A pose's errors are those of a state that has it.
        let as_state = |pose: Pose| Nominal { pose, ..nominal };
        let errors = |at: Estimate| {
            let (own, origin) = (corrected.nominal.errors(&at.nominal, &estimate.origin), estimate.origin);
            let cloned = as_state(corrected.clone).errors(&as_state(at.clone), &origin);
            SVector::<f64, ALL>::from_fn(|i, _| match i {
                _ if i < CLONE => own[i],
                _ if i < CLONE + 3 => cloned[PLACE + i - CLONE],
                _ => cloned[ATTITUDE + i - CLONE - 3],
            })
        };
        let transport = carried(SMatrix::<f64, ALL, ALL>::identity(), &corrected.transport(&correction));
        let h = 1e-6;
        for i in 0..ALL {
            let moved = |side: f64| {
                let mut near = correction;
                near[i] += side * h;
                errors(estimate.with(&near))
            };
            let difference = (moved(1.0) - moved(-1.0)) / (2.0 * h);
            assert!((difference - transport.column(i)).norm() < 1e-8, "error {i}");
        }
    }

    /// Γ P Γᵀ in place is that of the matrices.
    #[test]
    fn a_covariance_is_carried_as_the_errors_are() {
        let nominal = Nominal { pose: pose(1.0), velocity: Vector3::new(0.5, 1.0, -2.0), biases: Biases::default() };
        let imu = crate::sensors::Sensors::TYPICAL.imu;
        let mut filter = Filter::new(&imu, nominal, Vector3::zeros(), &Uncertainty::START.deviations(&imu));
        let correction = SVector::<f64, ALL>::from_fn(|i, _| 0.1 * Scalar::cos(i as f64));
        let blocks = filter.estimate.transport(&correction);
        let transport = carried(SMatrix::<f64, ALL, ALL>::identity(), &blocks);
        let expected = transport * filter.covariance * transport.transpose();
        filter.reset(&blocks);
        assert!((filter.covariance - expected).norm() < 1e-14);
    }
}
