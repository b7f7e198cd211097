//! Why an experiment is not planned, or cannot be followed.

use core::error::Error;
use core::fmt;

use super::flight::OutsideFlight;
use super::limits::AxisViolation;
use super::masses::InvalidMass;
use super::plan::COARSEST;
use super::rail_arm::NotFollowed;
use mbs_arm::limits::InvalidLimits;
use mbs_platform::PoseError;
use mbs_platform::limits::{InvalidLimits as InvalidActuators, Violation};

/// Why there is no plan, or none that can be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanError {
    /// The scale is not a positive number.
    InvalidScale {
        /// The scale given.
        scale: f64,
    },
    /// What must be finite is not.
    NotFinite {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// The least stand-off is greater than the greatest.
    Standoffs {
        /// Those given \[m\].
        range: [f64; 2],
    },
    /// Moments are not apart, or more than [`COARSEST`], or there are more than ten million.
    Sampling {
        /// Between moments \[s\].
        step: f64,
        /// The last one \[s\].
        end: f64,
    },
    /// The arm has a mass that no body has.
    Mass(InvalidMass),
    /// Nothing can keep the limits of the joints.
    Joints(InvalidLimits),
    /// Nothing can keep those of the platform.
    Actuators(InvalidActuators),
    /// Nothing can keep those of the rail: its range is empty, or a bound is not positive.
    Rail {
        /// The ends of the rail \[m\].
        range: [f64; 2],
        /// Speed \[m/s\], acceleration \[m/s²\] and force \[N\].
        bounds: [f64; 3],
    },
    /// The arm or the platform cannot be where it is to be.
    Infeasible(Infeasible),
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidScale { scale } => write!(f, "the scale must be positive, it is {scale}"),
            Self::NotFinite { parameter, value } => write!(f, "{parameter} must be finite, it is {value}"),
            Self::Standoffs { range: [least, greatest] } => {
                write!(f, "there is no stand-off from {least} to {greatest} m")
            }
            Self::Sampling { step, end } => {
                write!(
                    f,
                    "moments every {step} s up to {end} s are none, without end, too many or more than {COARSEST} s apart"
                )
            }
            Self::Mass(error) => error.fmt(f),
            Self::Joints(error) => error.fmt(f),
            Self::Actuators(error) => error.fmt(f),
            Self::Rail { range: [lower, upper], bounds: [speed, acceleration, force] } => write!(
                f,
                "the rail from {lower} to {upper} m, with {speed} m/s, {acceleration} m/s² and {force} N, lets nothing move"
            ),
            Self::Infeasible(reason) => reason.fmt(f),
        }
    }
}

impl Error for PlanError {}

impl From<Infeasible> for PlanError {
    fn from(reason: Infeasible) -> Self {
        Self::Infeasible(reason)
    }
}

/// What breaks first, and when \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Infeasible {
    /// The flight has no such moment.
    Flight(OutsideFlight),
    /// The arm cannot follow.
    Arm {
        /// When.
        time: f64,
        /// Why.
        reason: NotFollowed,
    },
    /// An axis of the robot exceeds a limit.
    Axis(AxisViolation),
    /// The platform has no legs, or no forces.
    Pose {
        /// When.
        time: f64,
        /// Why.
        reason: PoseError,
    },
    /// A leg of the platform exceeds a limit.
    Leg(Violation),
}

impl Infeasible {
    /// When \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        match self {
            Self::Flight(OutsideFlight { time, .. }) | Self::Arm { time, .. } | Self::Pose { time, .. } => *time,
            Self::Axis(violation) => violation.time,
            Self::Leg(violation) => violation.time,
        }
    }
}

impl fmt::Display for Infeasible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flight(error) => error.fmt(f),
            Self::Arm { time, reason } => write!(f, "t = {time:.3} s: {reason}"),
            Self::Axis(violation) => violation.fmt(f),
            Self::Pose { time, reason } => write!(f, "t = {time:.3} s: platform: {reason}"),
            Self::Leg(violation) => write!(f, "platform: {violation}"),
        }
    }
}

impl Error for Infeasible {}

impl From<OutsideFlight> for Infeasible {
    fn from(error: OutsideFlight) -> Self {
        Self::Flight(error)
    }
}
