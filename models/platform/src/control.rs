//! Control by the model: the forces of the legs that bring the platform onto an imposed motion.
//!
//! ```
//! use core::ops::ControlFlow;
//! use mbs_platform::{HOME, Motion, Platform};
//! use mbs_runtime::control::ComputedTorque;
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
//!             let forces = platform.limited_forces(&control, &motion.at(t), q, qd).unwrap_or([f64::NAN; 6]);
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

use mbs_models::Error;
use mbs_runtime::control::ComputedTorque;

use super::{Coordinates, LegVector, Platform};

impl Platform {
    /// The forces of the legs \[N\] of computed torque at this state, by this platform as the model, from which the
    /// plant may differ: `F = J_q⁻ᵀ [M(q) (q̈_d + K_d ė + K_p e) + C(q, q̇) q̇ + G(q)]`.
    ///
    /// | argument    | meaning                                                       | unit      |
    /// |-------------|---------------------------------------------------------------|-----------|
    /// | `reference` | coordinates, rates, accelerations wanted, as of [`Motion::at`](super::Motion::at) | m, rad, s |
    /// | `q`, `qd`   | the state                                                     | m, rad, s |
    ///
    /// # Errors
    /// [`Error`], as [`Platform::leg_forces`].
    pub fn computed_forces(
        &self,
        control: &ComputedTorque<6>,
        reference: &[Coordinates; 3],
        q: &Coordinates,
        qd: &Coordinates,
    ) -> Result<LegVector, Error> {
        self.leg_forces(q, qd, &control.acceleration(reference, q, qd))
    }

    /// The forces of [`computed_forces`](Self::computed_forces) \[N\], cut to what its actuators give.
    ///
    /// # Errors
    /// [`Error`], as [`Platform::leg_forces`], or of the limits.
    pub fn limited_forces(
        &self,
        control: &ComputedTorque<6>,
        reference: &[Coordinates; 3],
        q: &Coordinates,
        qd: &Coordinates,
    ) -> Result<LegVector, Error> {
        self.limits.check()?;
        Ok(self.limits.saturated(&self.computed_forces(control, reference, q, qd)?))
    }
}
