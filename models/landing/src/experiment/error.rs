//! Why an experiment is not planned, or cannot be followed.

use super::collision::Nearest;
use super::flight::OutsideFlight;
use super::limits::AxisViolation;
use super::plan::COARSEST;
use super::rail_arm::NotFollowed;
use mbs_arm::limits::InvalidLimits;
use mbs_models::check::Invalid;
use mbs_platform::PoseError;
use mbs_platform::limits::{InvalidLimits as InvalidActuators, Violation};

/// Why there is no plan, or none that can be followed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// The least stand-off is greater than the greatest.
    #[error("there is no stand-off from {} to {} m", .range[0], .range[1])]
    Standoffs {
        /// Those given \[m\].
        range: [f64; 2],
    },
    /// Moments are not apart, or more than [`COARSEST`], or there are more than ten million.
    #[error("moments every {step} s up to {end} s are none, without end, too many or more than {COARSEST} s apart")]
    Sampling {
        /// Between moments \[s\].
        step: f64,
        /// The last one \[s\].
        end: f64,
    },
    /// Nothing can keep the limits of the joints.
    #[error(transparent)]
    Joints(InvalidLimits),
    /// Nothing can keep those of the platform.
    #[error(transparent)]
    Actuators(InvalidActuators),
    /// Nothing can keep those of the rail: its range is empty, or a bound is not positive.
    #[error("the rail from {} to {} m, with {bounds:?} m/s, m/s² and N, lets nothing move", .range[0], .range[1])]
    Rail {
        /// The ends of the rail \[m\].
        range: [f64; 2],
        /// Speed \[m/s\], acceleration \[m/s²\] and force \[N\].
        bounds: [f64; 3],
    },
    /// The arm or the platform cannot be where it is to be.
    #[error(transparent)]
    Infeasible(#[from] Infeasible),
}

/// What breaks first, and when \[s\].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Infeasible {
    /// The flight has no such moment.
    #[error(transparent)]
    Flight(#[from] OutsideFlight),
    /// The arm cannot follow.
    #[error("t = {time:.3} s: {reason}")]
    Arm {
        /// When.
        time: f64,
        /// Why.
        reason: NotFollowed,
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
        reason: PoseError,
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
}

impl Infeasible {
    /// When \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        match self {
            Self::Flight(OutsideFlight { time, .. })
            | Self::Arm { time, .. }
            | Self::Pose { time, .. }
            | Self::Collision { time, .. } => *time,
            Self::Axis(violation) => violation.time,
            Self::Leg(violation) => violation.time,
        }
    }
}
