//! The filter: a nominal state with the covariance of its errors, and of those of the clone.

use nalgebra::{SMatrix, SVector, Vector3};

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

/// Normal deviate beyond which a measurement is not believed: one in 100 000 of good ones.
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
    /// \[m\]
    pub place: f64,
    /// \[m/s\]
    pub velocity: f64,
    /// \[rad\]
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
    /// Of a first state with independent errors.
    #[must_use]
    pub fn new(imu: &Imu, nominal: Nominal, deviations: &SVector<f64, ERRORS>) -> Self {
        let Imu { interval, gyro, accelerometer, gravity, .. } = *imu;
        let of_both = |gyro: f64, accelerometer: f64| {
            SVector::<f64, 6>::from_fn(|i, _| if i < 3 { gyro * gyro } else { accelerometer * accelerometer })
        };
        let mut covariance = SMatrix::<f64, ALL, ALL>::zeros();
        covariance.fixed_view_mut::<ERRORS, ERRORS>(0, 0).set_diagonal(&deviations.component_mul(deviations));
        let mut filter = Filter {
            estimate: Estimate { nominal, clone: nominal.pose },
            covariance,
            model: Strapdown::new(Params { interval, g: gravity }),
            white: of_both(gyro.density, accelerometer.density) / interval,
            walk: of_both(gyro.walk, accelerometer.walk) * interval,
        };
        filter.clone_pose();
        filter
    }

    /// An interval on: `P⁺ = F P Fᵀ + G W Gᵀ + W_b`. The clone stays.
    pub fn propagate(&mut self, sample: &ImuSample) {
        let step = self.estimate.nominal.step(&self.model, sample);
        self.estimate.nominal = step.next;
        let (f, p) = (&step.transition, &self.covariance);
        let own = p.fixed_view::<ERRORS, ERRORS>(0, 0);
        let crossed = f * p.fixed_view::<ERRORS, 6>(0, CLONE);
        let scaled = step.input * SMatrix::<f64, 6, 6>::from_diagonal(&self.white);
        let mut own = f * own * f.transpose() + scaled * step.input.transpose();
        for i in 0..6 {
            own[(GYRO + i, GYRO + i)] += self.walk[i];
        }
        self.covariance.fixed_view_mut::<ERRORS, ERRORS>(0, 0).copy_from(&own);
        self.covariance.fixed_view_mut::<ERRORS, 6>(0, CLONE).copy_from(&crossed);
        self.covariance.fixed_view_mut::<6, ERRORS>(CLONE, 0).copy_from(&crossed.transpose());
        self.symmetrize();
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
    /// The estimate is the minimum of `‖δ‖²` in the metric of P⁻¹ and of the residual in that of its own variance, found
    /// by Gauss and Newton's iterations, of which the first is the extended Kalman filter's. The covariance is Joseph's,
    /// `(I − K H) P (I − K H)ᵀ + K V Kᵀ`, and is then carried to the axes of the corrected attitudes.
    pub fn correct<const M: usize>(&mut self, measured: impl Fn(&Estimate) -> Linearized<M>) -> Innovation {
        let (p, prior) = (self.covariance, self.estimate);
        let mut errors = SVector::<f64, ALL>::zeros();
        let mut innovation = None;
        let mut last = None;
        for _ in 0..ITERATIONS {
            let mut about = measured(&prior.with(&errors));
            carry_columns(&mut about.jacobian, &errors);
            let h = about.jacobian;
            let expected = about.residual + h * errors;
            let ph = p * h.transpose();
            let s = h * ph + SMatrix::<f64, M, M>::from_diagonal(&about.variance);
            let Some(s) = s.cholesky() else {
                return Innovation { squared: f64::NAN, freedom: about.freedom, accepted: false };
            };
            let seen = innovation.get_or_insert_with(|| {
                let squared = expected.dot(&s.solve(&expected));
                let accepted = squared <= chi_square::quantile(GATE, about.freedom as f64);
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
            let left = SMatrix::<f64, ALL, ALL>::identity() - gain * h;
            let noise = gain * SMatrix::<f64, M, M>::from_diagonal(&variance) * gain.transpose();
            self.covariance = left * p * left.transpose() + noise;
        }
        self.reset(&errors);
        self.symmetrize();
        innovation.unwrap_or(Innovation { squared: 0.0, freedom: 0, accepted: true })
    }

    /// What is left of the errors after a correction by δ, in the axes of the corrected attitude: `J(δθ) (δθ_true − δθ)`
    /// with the right Jacobian J, `I − ½ [δθ]×` to first order. Solà 2017, (287).
    fn reset(&mut self, errors: &SVector<f64, ALL>) {
        for first in [ATTITUDE, CLONE + 3] {
            let turn = right_jacobian(&turn_at(errors, first));
            let rows = turn * self.covariance.fixed_rows::<3>(first);
            self.covariance.fixed_rows_mut::<3>(first).copy_from(&rows);
            let columns = self.covariance.fixed_columns::<3>(first) * turn.transpose();
            self.covariance.fixed_columns_mut::<3>(first).copy_from(&columns);
        }
    }

    fn symmetrize(&mut self) {
        self.covariance = 0.5 * (self.covariance + self.covariance.transpose());
    }

    /// Covariance of the state alone.
    #[must_use]
    pub fn state_covariance(&self) -> SMatrix<f64, ERRORS, ERRORS> {
        self.covariance.fixed_view::<ERRORS, ERRORS>(0, 0).into_owned()
    }

    /// Normalized estimation error squared, `δᵀ P⁻¹ δ` of the state's errors where that is the truth; NaN where P is not
    /// positive definite.
    #[must_use]
    pub fn normalized_error(&self, truth: &Nominal) -> f64 {
        let errors = self.estimate.nominal.errors(truth);
        self.state_covariance().cholesky().map_or(f64::NAN, |p| errors.dot(&p.solve(&errors)))
    }
}

impl Estimate {
    /// With these errors.
    #[must_use]
    pub fn with(&self, errors: &SVector<f64, ALL>) -> Self {
        Estimate {
            nominal: self.nominal.with(&errors.fixed_rows::<ERRORS>(0).into_owned()),
            clone: moved(&self.clone, &turn_at(errors, CLONE), &turn_at(errors, CLONE + 3)),
        }
    }
}

fn turn_at(errors: &SVector<f64, ALL>, first: usize) -> Vector3<f64> {
    errors.fixed_rows::<3>(first).into_owned()
}

/// From errors about the corrected estimate to those about the first one: `ε = J(δθ) (δ − δθ)`.
fn carry_columns<const M: usize>(jacobian: &mut SMatrix<f64, M, ALL>, errors: &SVector<f64, ALL>) {
    for first in [ATTITUDE, CLONE + 3] {
        let carried = jacobian.fixed_columns::<3>(first) * right_jacobian(&turn_at(errors, first));
        jacobian.fixed_columns_mut::<3>(first).copy_from(&carried);
    }
}
