//! Control by the model: the forces of the legs that bring the platform onto an imposed motion.
//!
//! ```
//! use core::ops::ControlFlow;
//! use mbs_platform::control::ComputedTorque;
//! use mbs_platform::{HOME, Motion, Platform};
//! use mbs_runtime::{Dop853, Integrator, State};
//!
//! let platform = Platform::default();
//! let control = ComputedTorque::critically_damped(8.0).unwrap();
//! let motion = Motion::COMBINED;
//! // From rest at home onto the motion, with what the actuators can give.
//! let mut state = State::new(HOME, [0.0; 6]);
//! Dop853::new(1e-8, 1e-8)
//!     .integrate(
//!         |t, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
//!             let forces = control.limited_forces(&platform, &motion.at(t), q, qd).unwrap_or([f64::NAN; 6]);
//!             *qdd = platform.model().forward_dynamics(q, qd, &forces);
//!         },
//!         0.0,
//!         3.0,
//!         &mut state,
//!         |_| ControlFlow::Continue(()),
//!     )
//!     .unwrap();
//! assert!((0..6).all(|i| (state.q[i] - motion.at(3.0)[0][i]).abs() < 1e-6));
//! ```

use super::limits::InvalidLimits;
use super::{Coordinates, LegVector, Platform, PoseError};

/// A gain that is not a positive number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a gain must be positive and finite, that of coordinate {coordinate} is {gain}")]
pub struct InvalidGain {
    /// The coordinate, counted from 0.
    pub coordinate: usize,
    /// The gain given: `K_p` \[1/s²\], `K_d` \[1/s\], or the natural frequency \[rad/s\] of which they are made.
    pub gain: f64,
}

/// Why there are no forces within the limits.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotControlled {
    /// Nothing can keep the limits.
    #[error(transparent)]
    Limits(#[from] InvalidLimits),
    /// The pose, the reference or the forces.
    #[error(transparent)]
    Pose(#[from] PoseError),
}

/// Computed-torque control: the model turns the platform into six independent oscillators.
///
/// ```text
/// F = J_q⁻ᵀ [M(q) (q̈_d + K_d ė + K_p e) + C(q, q̇) q̇ + G(q)],   e = q_d − q
/// ```
///
/// With this the error obeys `ë + K_d ė + K_p e = 0` for each coordinate by itself, as far as the model is right and
/// the actuators can give the forces.
///
/// # Source
/// J. Y. S. Luh, M. W. Walker, R. P. C. Paul, *Resolved-acceleration control of mechanical manipulators*, IEEE
/// Transactions on Automatic Control 25:3, 1980, for the coordinates of the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComputedTorque {
    /// `K_p` \[1/s²\], positive and finite.
    stiffness: Coordinates,
    /// `K_d` \[1/s\], positive and finite.
    damping: Coordinates,
}

impl ComputedTorque {
    /// With these gains, one a coordinate: `K_p` \[1/s²\] and `K_d` \[1/s\].
    ///
    /// # Errors
    /// [`InvalidGain`], the first that is not positive and finite.
    pub fn new(stiffness: Coordinates, damping: Coordinates) -> Result<Self, InvalidGain> {
        for coordinate in 0..6 {
            for gain in [stiffness[coordinate], damping[coordinate]] {
                positive(coordinate, gain)?;
            }
        }
        Ok(Self { stiffness, damping })
    }

    /// `K_p = ω²`, `K_d = 2 ω`: every error dies as `(e₀ + (ė₀ + ω e₀) t) exp(−ω t)`.
    ///
    /// # Errors
    /// [`InvalidGain`] if the natural frequency `ω` \[rad/s\] is not positive, or its square is not finite.
    pub fn critically_damped(natural_frequency: f64) -> Result<Self, InvalidGain> {
        positive(0, natural_frequency)?;
        Self::new([natural_frequency * natural_frequency; 6], [2.0 * natural_frequency; 6])
    }

    /// `K_p` \[1/s²\].
    #[must_use]
    pub fn stiffness(&self) -> &Coordinates {
        &self.stiffness
    }

    /// `K_d` \[1/s\].
    #[must_use]
    pub fn damping(&self) -> &Coordinates {
        &self.damping
    }

    /// The accelerations `q̈_d + K_d ė + K_p e` that are asked of the platform.
    #[must_use]
    pub fn acceleration(&self, reference: &[Coordinates; 3], q: &Coordinates, qd: &Coordinates) -> Coordinates {
        let [q_d, qd_d, qdd_d] = reference;
        core::array::from_fn(|i| qdd_d[i] + self.damping[i] * (qd_d[i] - qd[i]) + self.stiffness[i] * (q_d[i] - q[i]))
    }

    /// The forces of the legs \[N\] at this state.
    ///
    /// | argument    | meaning                                                       | unit      |
    /// |-------------|---------------------------------------------------------------|-----------|
    /// | `platform`  | the model, which may differ from the plant                    |           |
    /// | `reference` | coordinates, rates, accelerations wanted, as of [`Motion::at`](super::Motion::at) | m, rad, s |
    /// | `q`, `qd`   | the state                                                     | m, rad, s |
    ///
    /// # Errors
    /// [`PoseError`], as [`Platform::leg_forces`].
    pub fn forces(
        &self,
        platform: &Platform,
        reference: &[Coordinates; 3],
        q: &Coordinates,
        qd: &Coordinates,
    ) -> Result<LegVector, PoseError> {
        platform.leg_forces(q, qd, &self.acceleration(reference, q, qd))
    }

    /// The forces of the legs \[N\], cut to what the actuators of `platform` give.
    ///
    /// # Errors
    /// [`NotControlled::Limits`]; [`NotControlled::Pose`], as [`Platform::leg_forces`].
    pub fn limited_forces(
        &self,
        platform: &Platform,
        reference: &[Coordinates; 3],
        q: &Coordinates,
        qd: &Coordinates,
    ) -> Result<LegVector, NotControlled> {
        platform.limits.check()?;
        Ok(platform.limits.saturated(&self.forces(platform, reference, q, qd)?))
    }
}

fn positive(coordinate: usize, gain: f64) -> Result<(), InvalidGain> {
    if gain > 0.0 && gain.is_finite() { Ok(()) } else { Err(InvalidGain { coordinate, gain }) }
}
