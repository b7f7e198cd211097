//! The arm with elastic joints and gears: how far it gives way, and how fast it swings.
//!
//! Of each motor the rotor turns about its own axis only, behind a gear and a spring: with angles θ of the motors seen
//! at the joints,
//!
//! ```text
//! M(q) q̈ + C q̇ + G + D (q̇ − θ̇) + K (q − θ) = 0,   J θ̈ + D (θ̇ − q̇) + K (θ − q) = τ,   J = n² J_rotor
//! ```
//!
//! These equations are generated, from [`irb7600_elastic`]; stiffness, damping, rotors and ratios are its parameters.
//!
//! # Source
//! M. W. Spong, *Modeling and control of elastic joint robots*, Journal of Dynamic Systems, Measurement, and Control
//! 109:4, 1987, equations (9) and (10).

use mbs_models::irb7600_elastic::{self, Irb7600Elastic};
use mbs_runtime::nalgebra::Matrix6;
use mbs_runtime::to_matrix;

use super::JointVector;

/// The arm on its springs.
#[derive(Clone, Debug)]
pub struct ElasticArm {
    /// Equations of motion of joints and motors, `(q, θ)`.
    pub model: Irb7600Elastic<f64>,
}

impl Default for ElasticArm {
    /// With the declared parameters.
    fn default() -> Self {
        Self::new(irb7600_elastic::Params::default())
    }
}

impl ElasticArm {
    /// With these parameters; see [`Params::check`](irb7600_elastic::Params::check).
    #[must_use]
    pub fn new(params: irb7600_elastic::Params<f64>) -> Self {
        Self { model: Irb7600Elastic::new(params) }
    }

    /// Inertias of the rotors as the joints feel them, `n² J_rotor` \[kg·m²\].
    #[must_use]
    pub fn rotor_inertia(&self) -> JointVector {
        let params = self.model.params();
        core::array::from_fn(|i| params.rotor[i] * params.ratio[i] * params.ratio[i])
    }

    /// By how much the flange gives way to a force \[N\] and a moment \[N·m\] on it, motors held: `J K⁻¹ Jᵀ`, for
    /// displacement \[m\] and rotation \[rad\] in the axes of the base.
    ///
    /// # Source
    /// J. K. Salisbury, *Active stiffness control of a manipulator in Cartesian coordinates*, 1980, section 2.
    #[must_use]
    pub fn compliance(&self, q: &JointVector) -> [[f64; 6]; 6] {
        let jacobian = self.model.flange_jacobian(&doubled(q));
        let stiffness = self.model.params().stiffness;
        // The last six columns are of the motors, which do not move the flange.
        let entry = |i: usize, j: usize| (0..6).map(|k| jacobian[i][k] * jacobian[j][k] / stiffness[k]).sum();
        core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)))
    }

    /// Natural frequencies at this posture \[rad/s\], motors held, the lowest first: `det(K − ω² M) = 0`; the change of
    /// weight with the angles, small beside K, and damping are left out.
    ///
    /// NaN where the mass matrix is not positive definite.
    #[must_use]
    pub fn natural_frequencies(&self, q: &JointVector) -> JointVector {
        let masses = self.model.mass_matrix(&doubled(q));
        let masses: [[f64; 6]; 6] = core::array::from_fn(|i| core::array::from_fn(|j| masses[i][j]));
        let stiffness = Matrix6::from_diagonal(&self.model.params().stiffness.into());
        let Some(factor) = to_matrix(&masses).cholesky() else { return [f64::NAN; 6] };
        // L⁻¹ K L⁻ᵀ has the squares.
        let halved = factor.l().solve_lower_triangular(&stiffness);
        let Some(whole) = halved.and_then(|half| factor.l().solve_lower_triangular(&half.transpose())) else {
            return [f64::NAN; 6];
        };
        let mut squares: JointVector = (0.5 * (whole + whole.transpose())).symmetric_eigenvalues().into();
        squares.sort_unstable_by(f64::total_cmp);
        squares.map(mbs_runtime::Scalar::sqrt)
    }
}

/// Joints and motors at the same angles.
fn doubled(q: &JointVector) -> [f64; 12] {
    core::array::from_fn(|i| q[i % 6])
}
