//! The geometric Jacobian (3.13)–(3.16), its singularities, and what it carries over: velocities and forces.
//!
//! ```text
//! [v; ω] = J(q) q̇,   τ = Jᵀ [f; m],   column i of J: [z_{i−1} × (P − P_{i−1}); z_{i−1}]
//! ```
//!
//! Rows are the velocity of the flange's origin, then its angular velocity, in the axes of the base; so are the
//! components of forces and moments, the moment about the flange's origin. Velocities and angular velocities have
//! different units, and singular values mix them: metres and radians count alike here.
//!
//! ```
//! use mbs_arm::Arm;
//!
//! let arm = Arm::default();
//! let q = [0.4, -1.2, 0.3, 0.5, 0.8, -0.1];
//! // A weight of 100 N at the flange, carried by the joints, and the power of both sides.
//! let weight = [0.0, 0.0, -100.0, 0.0, 0.0, 0.0];
//! let torque = arm.joint_torque(&q, &weight);
//! let qd = [0.1, -0.2, 0.3, 0.1, 0.4, -0.5];
//! let twist = arm.flange_velocity(&q, &qd);
//! let power = |a: &[f64; 6], b: &[f64; 6]| -> f64 { (0..6).map(|i| a[i] * b[i]).sum() };
//! assert!((power(&torque, &qd) - power(&weight, &twist)).abs() < 1e-12);
//! // Back from the velocity of the flange to those of the joints.
//! let found = arm.joint_velocity(&q, &twist).unwrap();
//! assert!((0..6).all(|i| (found[i] - qd[i]).abs() < 1e-12));
//! ```
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, section 3.3.

use mbs_models::{Error, Failure, check};
use mbs_runtime::{Pose, Scalar, to_matrix, to_vector};
use nalgebra::{Matrix6, SVD, Vector3, Vector6};

use super::inverse::{L1, PHI};
use super::{A1, A2, A3, Arm, D1, D4, D6, JointVector};

/// Rows of `v`, then of `ω`; columns are joints.
pub type Jacobian = [[f64; 6]; 6];

/// How small the smallest singular value is, against the largest, where the Jacobian counts as singular: of what is
/// carried over, half of the digits would be left.
pub const SINGULAR: f64 = 1e-9;

/// The factors of the Jacobian's determinant, one for each way of being singular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// `a₁ + a₂ c₂ + a₃ c₂₃ − d₄ s₂₃`: the wrist's distance from axis 1, negative behind it \[m\].
    pub shoulder: f64,
    /// `a₃ s₃ + d₄ c₃ = l₁ sin(θ₃ + φ)`: the wrist's distance from the line of the upper arm \[m\].
    pub elbow: f64,
    /// `sin θ₅`.
    pub wrist: f64,
}

impl Factors {
    /// `det J = −a₂ · elbow · wrist · shoulder` \[m³\].
    #[must_use]
    pub fn determinant(&self) -> f64 {
        -A2 * self.elbow * self.wrist * self.shoulder
    }

    /// How far the arm is from its singularities: the smallest magnitude of the three, each as a part of the largest
    /// that it can have. From 0, singular, to less than 1; NaN where a factor is.
    #[must_use]
    pub fn margin(&self) -> f64 {
        let parts = [self.shoulder / (A1 + A2 + L1), self.elbow / L1, self.wrist];
        parts
            .into_iter()
            .fold(1.0, |least, part| if least.is_nan() || part.abs() >= least { least } else { part.abs() })
    }
}

/// The factors of the determinant of the flange's Jacobian; each vanishes at singularities of its own.
#[must_use]
pub fn determinant_factors(q: &JointVector) -> Factors {
    let ((s3, c3), (s23, c23)) = (Scalar::sin_cos(q[2]), Scalar::sin_cos(q[1] + q[2]));
    Factors {
        shoulder: A1 + A2 * Scalar::cos(q[1]) + A3 * c23 - D4 * s23,
        elbow: A3 * s3 + D4 * c3,
        wrist: Scalar::sin(q[4]),
    }
}

/// `det J = −a₂ (a₃ s₃ + d₄ c₃) s₅ (a₁ + a₂ c₂ + a₃ c₂₃ − d₄ s₂₃)` of the flange \[m³\].
#[must_use]
pub fn determinant(q: &JointVector) -> f64 {
    determinant_factors(q).determinant()
}

/// The angles of axis 3 at which the arm is stretched and folded \[rad\]: `−φ` and `π − φ`.
pub const STRETCHED_AND_FOLDED: [f64; 2] = [-PHI, core::f64::consts::PI - PHI];

/// The singular values of a Jacobian, largest first; NaN where an entry is infinite or NaN.
#[must_use]
pub fn singular_values(jacobian: &Jacobian) -> [f64; 6] {
    match decomposition(jacobian, false) {
        Some(svd) => core::array::from_fn(|i| svd.singular_values[i]),
        None => [f64::NAN; 6],
    }
}

/// The largest singular value over the smallest: infinite where the Jacobian is singular, NaN where an entry is
/// infinite or NaN.
#[must_use]
pub fn condition(jacobian: &Jacobian) -> f64 {
    let values = singular_values(jacobian);
    values[0] / values[5]
}

/// Yoshikawa's measure of manipulability `√det(J Jᵀ)`, the product of the singular values; of the flange it is `|det
/// J|` \[m³\].
///
/// # Source
/// T. Yoshikawa, *Manipulability of robotic mechanisms*, International Journal of Robotics Research 4:2, 1985, equation
/// (3).
#[must_use]
pub fn manipulability(q: &JointVector) -> f64 {
    determinant(q).abs()
}

impl Arm {
    /// The Jacobian of the flange, as generated.
    #[must_use]
    #[inline]
    pub fn jacobian(&self, q: &JointVector) -> Jacobian {
        self.model.flange_jacobian(q)
    }

    /// Pose and Jacobian of the flange at once, sharing sines, cosines and axes.
    ///
    /// Typed by hand from (3.15), (3.16) in the axes of the arm's plane, because the generated functions each evaluate
    /// the sines again and the generated Jacobian costs three times as much; the results are the same up to rounding.
    ///
    /// With `e` forward in the arm's plane and `z` up, `z₁ = z₂` is across it, and `z₁ × e = −z`, `z₁ × z = e`.
    #[must_use]
    #[inline]
    pub fn pose_and_jacobian(&self, q: &JointVector) -> (Pose<f64>, Jacobian) {
        let [(s1, c1), (s2, c2), (s3, c3), (s4, c4), (s5, c5), (s6, c6)] = q.map(Scalar::sin_cos);
        let (s23, c23) = (s2 * c3 + c2 * s3, c2 * c3 - s2 * s3);
        // Frame 3 has the axes (c₂₃ e − s₂₃ z), across, and z₃ = −s₂₃ e − c₂₃ z.
        let x3 = [c1 * c23, s1 * c23, -s23];
        let across = [-s1, c1, 0.0];
        let z3 = [-c1 * s23, -s1 * s23, -c23];
        // The second axis of frame 3 is (s₁, −c₁, 0).
        let x4: [f64; 3] = core::array::from_fn(|i| c4 * x3[i] - s4 * across[i]);
        let z4: [f64; 3] = core::array::from_fn(|i| s4 * x3[i] + c4 * across[i]);
        let x5: [f64; 3] = core::array::from_fn(|i| c5 * x4[i] + s5 * z3[i]);
        let z5: [f64; 3] = core::array::from_fn(|i| c5 * z3[i] - s5 * x4[i]);
        let rotation = core::array::from_fn(|i| [c6 * x5[i] - s6 * z4[i], -s6 * x5[i] - c6 * z4[i], z5[i]]);

        let tool = z5.map(|z| D6 * z);
        // Forward and up, from axis 2 and from axis 3.
        let tool_forward = c1 * tool[0] + s1 * tool[1];
        let (forward_3, up_3) = (A3 * c23 - D4 * s23 + tool_forward, -A3 * s23 - D4 * c23 + tool[2]);
        let (forward_2, up_2) = (A2 * c2 + forward_3, up_3 - A2 * s2);
        let lateral = c1 * tool[1] - s1 * tool[0];
        let forward = A1 + forward_2;
        let position = [c1 * forward - s1 * lateral, s1 * forward + c1 * lateral, D1 + up_2];

        let [v4, v5] = [z3, z4].map(|axis| Vector3::from(axis).cross(&Vector3::from(tool)));
        let jacobian = [
            [-position[1], c1 * up_2, c1 * up_3, v4[0], v5[0], 0.0],
            [position[0], s1 * up_2, s1 * up_3, v4[1], v5[1], 0.0],
            [0.0, -forward_2, -forward_3, v4[2], v5[2], 0.0],
            [0.0, across[0], across[0], z3[0], z4[0], z5[0]],
            [0.0, across[1], across[1], z3[1], z4[1], z5[1]],
            [1.0, across[2], across[2], z3[2], z4[2], z5[2]],
        ];
        (Pose { position, rotation }, jacobian)
    }

    /// The frames of the links, each moved to its link's mass centre, in the axes of the base.
    #[must_use]
    pub fn mass_center_poses(&self, q: &JointVector) -> [Pose<f64>; 6] {
        let arm = &self.model;
        [arm.center_0(q), arm.center_1(q), arm.center_2(q), arm.center_3(q), arm.center_4(q), arm.center_5(q)]
    }

    /// The Jacobians of the links' mass centres: velocities of the centres, then angular velocities of the links.
    ///
    /// They give the mass matrix, `M = Σ (mᵢ J_vᵀ J_v + J_ωᵀ Rᵢ Iᵢ Rᵢᵀ J_ω)`, and the gravity, `G = −Σ J_vᵀ mᵢ g`, of
    /// (3.19).
    #[must_use]
    pub fn mass_center_jacobians(&self, q: &JointVector) -> [Jacobian; 6] {
        let arm = &self.model;
        [
            arm.center_0_jacobian(q),
            arm.center_1_jacobian(q),
            arm.center_2_jacobian(q),
            arm.center_3_jacobian(q),
            arm.center_4_jacobian(q),
            arm.center_5_jacobian(q),
        ]
    }

    /// Velocity \[m/s\] and angular velocity \[rad/s\] of the flange: `J q̇`, without forming `J`.
    #[must_use]
    pub fn flange_velocity(&self, q: &JointVector, qd: &JointVector) -> [f64; 6] {
        self.model.flange_velocity(q, qd)
    }

    /// The joint velocities \[rad/s\] that move the flange with this velocity \[m/s\] and angular velocity \[rad/s\]:
    /// `J⁻¹ [v; ω]`.
    ///
    /// # Errors
    /// [`Error`] where the smallest singular value is below [`SINGULAR`] of the largest, or something is not
    /// finite.
    pub fn joint_velocity(&self, q: &JointVector, twist: &[f64; 6]) -> Result<JointVector, Error> {
        let (u, values, v_t) = self.regular(q, twist)?;
        let along = u.tr_mul(&to_vector(twist)).component_div(&values);
        Ok(finite(v_t.tr_mul(&along))?.into())
    }

    /// The joint velocities \[rad/s\] that move the flange nearly so, and stay bounded near singularities:
    /// `Jᵀ (J Jᵀ + λ² 1)⁻¹ [v; ω]`, by singular values; the minimum of `|J q̇ − [v; ω]|² + λ² |q̇|²`.
    ///
    /// They are no larger than `|[v; ω]|/(2 λ)`.
    ///
    /// | argument  | meaning                                     | unit       |
    /// |-----------|---------------------------------------------|------------|
    /// | `twist`   | velocity and angular velocity of the flange | m/s, rad/s |
    /// | `damping` | `λ`                                         | m, or 1    |
    ///
    /// # Errors
    /// [`Failure::Invalid`] if `λ` is not positive, [`Failure::NotFinite`] if something is not finite.
    ///
    /// # Source
    /// Y. Nakamura and H. Hanafusa, *Inverse kinematic solutions with singularity robustness for robot manipulator
    /// control*, Journal of Dynamic Systems, Measurement, and Control 108:3, 1986.
    pub fn joint_velocity_damped(&self, q: &JointVector, twist: &[f64; 6], damping: f64) -> Result<JointVector, Error> {
        check::positive("damping", damping)?;
        let (u, values, v_t) = self.decomposed(q, twist)?;
        // σ/(σ² + λ²), of which nothing is lost where σ vanishes.
        let gain = values.map(|value| if value == 0.0 { 0.0 } else { value / (value * value + damping * damping) });
        Ok(finite(v_t.tr_mul(&u.tr_mul(&to_vector(twist)).component_mul(&gain)))?.into())
    }

    /// The joint torques \[N·m\] that a force \[N\] and a moment \[N·m\] on the flange are worth: `Jᵀ [f; m]`.
    ///
    /// The drives hold the arm against them with the opposite torques.
    #[must_use]
    pub fn joint_torque(&self, q: &JointVector, wrench: &[f64; 6]) -> JointVector {
        to_matrix(&self.jacobian(q)).tr_mul(&to_vector(wrench)).into()
    }

    /// The force \[N\] and the moment \[N·m\] on the flange that are worth these joint torques \[N·m\]: `J⁻ᵀ τ`.
    ///
    /// # Errors
    /// [`Error`], as [`joint_velocity`](Self::joint_velocity).
    pub fn flange_wrench(&self, q: &JointVector, torque: &JointVector) -> Result<[f64; 6], Error> {
        let (u, values, v_t) = self.regular(q, torque)?;
        Ok(finite(u * (v_t * to_vector(torque)).component_div(&values))?.into())
    }

    /// `U`, the singular values and `Vᵀ` of the Jacobian, where it can be inverted.
    fn regular(&self, q: &JointVector, of: &[f64; 6]) -> Result<Factorization, Error> {
        let factors = self.decomposed(q, of)?;
        let (smallest, largest) = (factors.1[5], factors.1[0]);
        if smallest > SINGULAR * largest {
            Ok(factors)
        } else {
            Err(Failure::Singular { of: "the arm", smallest, largest, unit: "in m and rad" }.into())
        }
    }

    /// `U`, the singular values and `Vᵀ` of the Jacobian, where all numbers are finite.
    fn decomposed(&self, q: &JointVector, of: &[f64; 6]) -> Result<Factorization, Error> {
        if !of.iter().all(|x| x.is_finite()) {
            return Err(NOT_FINITE.into());
        }
        let svd = decomposition(&self.jacobian(q), true).ok_or(NOT_FINITE)?;
        let (u, v_t) = svd.u.zip(svd.v_t).ok_or(NOT_FINITE)?;
        Ok((u, svd.singular_values, v_t))
    }
}

type Factorization = (Matrix6<f64>, Vector6<f64>, Matrix6<f64>);
type Decomposition = SVD<f64, nalgebra::U6, nalgebra::U6>;

/// The singular value decomposition, ordered; `None` where an entry is infinite or NaN.
fn decomposition(jacobian: &Jacobian, with_vectors: bool) -> Option<Decomposition> {
    if !jacobian.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    SVD::try_new(to_matrix(jacobian), with_vectors, with_vectors, f64::EPSILON, SVD_STEPS)
}

const NOT_FINITE: Failure = Failure::NotFinite("an angle, or a component of what is to be carried over,");

/// Far above the few steps a 6 × 6 matrix takes.
const SVD_STEPS: usize = 1000;

fn finite(x: Vector6<f64>) -> Result<Vector6<f64>, Error> {
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(NOT_FINITE.into()) }
}
