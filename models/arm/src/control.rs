//! Control by the model: the arm's own equations of motion, evaluated at each moment.
//!
//! ```
//! use mbs_arm::Arm;
//! use mbs_arm::control::{ComputedTorque, Reference};
//!
//! let arm = Arm::default();
//! let control = ComputedTorque::critically_damped(4.0).unwrap();
//! let q = [0.1, -1.5, 0.2, 0.0, 0.4, 0.0];
//! // At rest where it should be, the arm needs its weight carried and nothing else.
//! let torque = control.torque(&arm, &Reference::at_rest(q), &q, &[0.0; 6]);
//! let gravity = arm.gravity_compensation(&q);
//! assert!((0..6).all(|i| (torque[i] - gravity[i]).abs() < 1e-9));
//! ```

use super::{Arm, JointVector};

/// The motion that a controller is to follow, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Angles `q_d` \[rad\].
    pub q: JointVector,
    /// Rates \[rad/s\].
    pub qd: JointVector,
    /// Accelerations \[rad/s²\].
    pub qdd: JointVector,
}

impl Reference {
    /// A place to stay at.
    #[must_use]
    pub fn at_rest(q: JointVector) -> Self {
        Self { q, qd: [0.0; 6], qdd: [0.0; 6] }
    }
}

/// A gain that is not a positive number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a gain must be positive and finite, that of joint {joint} is {gain}")]
pub struct InvalidGain {
    /// The joint, counted from 0.
    pub joint: usize,
    /// The gain given: `K_p` \[1/s²\], `K_d` \[1/s\], or the natural frequency \[rad/s\] of which they are made.
    pub gain: f64,
}

/// Computed-torque control: the model turns the arm into six independent oscillators.
///
/// ```text
/// τ = M(q) (q̈_d + K_d ė + K_p e) + C(q, q̇) q̇ + G(q),   e = q_d − q
/// ```
///
/// With this the error obeys `ë + K_d ė + K_p e = 0` for each joint by itself, as far as the model is right.
///
/// # Source
/// J. Y. S. Luh, M. W. Walker, R. P. C. Paul, *Resolved-acceleration control of mechanical manipulators*, IEEE
/// Transactions on Automatic Control 25:3, 1980, for joint angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComputedTorque {
    /// `K_p` \[1/s²\], positive and finite.
    stiffness: JointVector,
    /// `K_d` \[1/s\], positive and finite.
    damping: JointVector,
}

impl ComputedTorque {
    /// With these gains, one a joint: `K_p` \[1/s²\] and `K_d` \[1/s\].
    ///
    /// # Errors
    /// [`InvalidGain`], the first that is not positive and finite.
    pub fn new(stiffness: JointVector, damping: JointVector) -> Result<Self, InvalidGain> {
        for joint in 0..6 {
            for gain in [stiffness[joint], damping[joint]] {
                positive(joint, gain)?;
            }
        }
        Ok(Self { stiffness, damping })
    }

    /// `K_p = ω²`, `K_d = 2 ω`: every error dies as `(e₀ + (ė₀ + ω e₀) t) exp(−ω t)`, without overshoot from rest.
    ///
    /// # Errors
    /// [`InvalidGain`] if the natural frequency `ω` \[rad/s\] is not positive, or its square is not finite.
    pub fn critically_damped(natural_frequency: f64) -> Result<Self, InvalidGain> {
        positive(0, natural_frequency)?;
        Self::new([natural_frequency * natural_frequency; 6], [2.0 * natural_frequency; 6])
    }

    /// `K_p` \[1/s²\].
    #[must_use]
    pub fn stiffness(&self) -> &JointVector {
        &self.stiffness
    }

    /// `K_d` \[1/s\].
    #[must_use]
    pub fn damping(&self) -> &JointVector {
        &self.damping
    }

    /// The joint torques \[N·m\] at this state: the inputs of the arm.
    ///
    /// | argument    | meaning                                   | unit             |
    /// |-------------|-------------------------------------------|------------------|
    /// | `arm`       | the model, which may differ from the plant |                 |
    /// | `reference` | the motion wanted at this moment           | rad, s           |
    /// | `q`, `qd`   | the state                                  | rad, rad/s       |
    #[must_use]
    pub fn torque(&self, arm: &Arm, reference: &Reference, q: &JointVector, qd: &JointVector) -> JointVector {
        let acceleration = core::array::from_fn(|i| {
            let (error, rate) = (reference.q[i] - q[i], reference.qd[i] - qd[i]);
            reference.qdd[i] + self.damping[i] * rate + self.stiffness[i] * error
        });
        arm.model.inverse_dynamics(q, qd, &acceleration)
    }
}

fn positive(joint: usize, gain: f64) -> Result<(), InvalidGain> {
    if gain > 0.0 && gain.is_finite() { Ok(()) } else { Err(InvalidGain { joint, gain }) }
}

impl Arm {
    /// The joint torques \[N·m\] that carry the arm's weight: `G(q)`. Under them alone it stays where it is at rest.
    #[must_use]
    pub fn gravity_compensation(&self, q: &JointVector) -> JointVector {
        self.model.gravity(q)
    }
}
