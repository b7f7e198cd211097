//! Why an experiment is not planned, or cannot be followed.

use super::collision::Nearest;
use super::limits::AxisViolation;
use mbs_models::Error;
use mbs_models::check::Invalid;
use mbs_platform::limits::Violation;

/// Why there is no plan, or none that can be followed: what breaks first, and when \[s\].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Infeasible {
    /// There is no such experiment, plan or simulation, whatever the machines could do.
    #[error(transparent)]
    Refused(#[from] Error),
    /// The arm cannot follow.
    #[error("t = {time:.3} s: {reason}")]
    Arm {
        /// When.
        time: f64,
        /// Why.
        reason: Error,
    },
    /// An axis of the robot exceeds a limit.
    #[error("{0}")]
    Axis(AxisViolation),
    /// The platform has no legs, or no forces.
    #[error("t = {time:.3} s: platform: {reason}")]
    Pose {
        /// When.
        time: f64,
        /// Why.
        reason: Error,
    },
    /// A leg of the platform exceeds a limit.
    #[error("platform: {0}")]
    Leg(Violation),
    /// Two bodies touch that are to stay apart.
    #[error("t = {time:.3} s: {nearest}")]
    Collision {
        /// When.
        time: f64,
        /// Which.
        nearest: Nearest,
    },
    /// The flight is over, and the flange has not come down.
    #[error("no contact until t = {time} s, the flange is {height} m over the deck")]
    NoContact {
        /// When it was given up.
        time: f64,
        /// How high it is \[m\].
        height: f64,
    },
}

impl From<Invalid> for Infeasible {
    fn from(error: Invalid) -> Self {
        Self::Refused(error.into())
    }
}

impl From<mbs_runtime::IntegrationError> for Infeasible {
    fn from(error: mbs_runtime::IntegrationError) -> Self {
        Self::Refused(error.into())
    }
}
