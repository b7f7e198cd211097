//! The thesis' inverse kinematics as printed: one configuration, by principal arc tangents of quotients.
//!
//! They hold where all angles that the arc tangents give are within ±90°, the wrist is in front of the shoulder and the
//! elbow positive: on about one pose in ten. [`inverse`](super::inverse) gives all configurations, everywhere.

use core::f64::consts::PI;

use mbs_runtime::{Pose, Scalar};

use super::{A1, A2, A3, D1, D4, D6, JointVector};

/// The joint angles \[rad\] of formulas (3.7)–(3.12) as printed, evaluated in the order `θ₁`, `θ₃`, `θ₂`, `θ₄`, `θ₅`,
/// `θ₆`.
///
/// ```text
/// (3.7)   θ₁ = arctg((P_y − d₆ h₂₃)/(P_x − d₆ h₁₃))
/// (3.8)   θ₄ = arctg((h₁₃s₁ − h₂₃c₁)/((h₁₃c₁ + h₂₃s₁)c₂₃ − h₃₃s₂₃))
/// (3.9)   θ₅ = arctg(((h₁₃c₁ + h₂₃s₁)c₂₃c₄ − h₃₃s₂₃c₄ + (h₁₃s₁ − h₂₃c₁)s₄)/((h₁₃c₁ + h₂₃s₁)s₂₃ + h₃₃c₂₃))
/// (3.10)  θ₆ = arctg((−(h₁₁c₁ + h₂₁s₁)c₂₃s₄ + h₃₁s₂₃s₄ + (h₁₁s₁ − h₂₁c₁)c₄)
///                   /(−(h₁₂c₁ + h₂₂s₁)c₂₃s₄ + h₃₂s₂₃s₄ + (h₁₂s₁ − h₂₂c₁)c₄))
/// (3.11)  θ₃ = π − arctg(d₄/a₃) − arccos((a₂² + l₁² − P₁₄²)/(2 a₂ l₁))
/// (3.12)  θ₂ = π − arccos((a₂² + P₁₄² − l₁²)/(2 a₂ P₁₄)) − arccos((P₀₁² + P₁₄² − P₀₄²)/(2 P₀₁ P₁₄)) − arctg(d₁/a₁)
/// ```
///
/// `P₀₁` is the distance of joint 2 from the base, `P₀₄` that of the wrist, `P₁₄` that of the wrist from joint 2. The
/// closing bracket that (3.10) has too many is left out. The matrix is used as it is given, rotation or not.
///
/// Algebra, as the generated functions are: the angles are NaN out of reach, and those of another pose than the given
/// one where the formulas do not hold.
///
/// ```
/// use mbs_arm::printed::inverse_kinematics;
/// use mbs_runtime::Pose;
///
/// // (3.20), (3.21): the pose of table 1 in four digits.
/// // The thesis prints 45, 29.9977, 29.9993, −44.9962, 30.0036, −0.0052.
/// let pose = Pose {
///     position: [0.2586, 0.1336, -0.4601],
///     rotation: [[-0.5227, 0.75, -0.4053], [0.3433, -0.25, -0.9053], [-0.7803, -0.6124, -0.1268]],
/// };
/// let degrees = inverse_kinematics(&pose).map(|angle| (angle.to_degrees() * 1e4).round() / 1e4);
/// assert_eq!(degrees, [45.0, 29.9977, 29.9993, -44.9962, 30.0036, -0.0052]);
/// ```
///
/// # Source
/// Doctoral thesis *Dynamics of multibody systems in a gravitational field*, equations (3.7)–(3.12), with the constants
/// of table 1.
#[must_use]
pub fn inverse_kinematics(pose: &Pose<f64>) -> JointVector {
    let [px, py, pz] = pose.position;
    let [[h11, h12, h13], [h21, h22, h23], [h31, h32, h33]] = pose.rotation;
    let wrist = [px - D6 * h13, py - D6 * h23, pz - D6 * h33];
    let theta_1: f64 = Scalar::atan(wrist[1] / wrist[0]);
    let (s1, c1) = Scalar::sin_cos(theta_1);

    let l1_squared = A3 * A3 + D4 * D4;
    let l1: f64 = Scalar::sqrt(l1_squared);
    let p14_squared = square(wrist[0] - A1 * c1) + square(wrist[1] - A1 * s1) + square(wrist[2] - D1);
    let p14 = Scalar::sqrt(p14_squared);
    let p01_squared = A1 * A1 + D1 * D1;
    let p01: f64 = Scalar::sqrt(p01_squared);
    let p04_squared = square(wrist[0]) + square(wrist[1]) + square(wrist[2]);
    let elbow: f64 = (A2 * A2 + l1_squared - p14_squared) / (2.0 * A2 * l1);
    let theta_3 = PI - Scalar::atan(D4 / A3) - Scalar::acos(elbow);
    let upper_arm: f64 = (A2 * A2 + p14_squared - l1_squared) / (2.0 * A2 * p14);
    let base: f64 = (p01_squared + p14_squared - p04_squared) / (2.0 * p01 * p14);
    let theta_2 = PI - Scalar::acos(upper_arm) - Scalar::acos(base) - Scalar::atan(D1 / A1);
    let (s23, c23) = Scalar::sin_cos(theta_2 + theta_3);

    let numerator_4 = h13 * s1 - h23 * c1;
    let denominator_4 = (h13 * c1 + h23 * s1) * c23 - h33 * s23;
    let theta_4: f64 = Scalar::atan(numerator_4 / denominator_4);
    let (s4, c4) = Scalar::sin_cos(theta_4);

    let numerator_5 = (h13 * c1 + h23 * s1) * c23 * c4 - h33 * s23 * c4 + (h13 * s1 - h23 * c1) * s4;
    let denominator_5 = (h13 * c1 + h23 * s1) * s23 + h33 * c23;
    let theta_5: f64 = Scalar::atan(numerator_5 / denominator_5);

    let numerator_6 = -(h11 * c1 + h21 * s1) * c23 * s4 + h31 * s23 * s4 + (h11 * s1 - h21 * c1) * c4;
    let denominator_6 = -(h12 * c1 + h22 * s1) * c23 * s4 + h32 * s23 * s4 + (h12 * s1 - h22 * c1) * c4;
    let theta_6: f64 = Scalar::atan(numerator_6 / denominator_6);

    [theta_1, theta_2, theta_3, theta_4, theta_5, theta_6]
}

fn square(x: f64) -> f64 {
    x * x
}
