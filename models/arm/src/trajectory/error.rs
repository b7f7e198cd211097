//! Why there is no such trajectory, with the numbers that matter.

use core::fmt;
use mbs_models::check::Invalid;

/// What a limit is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A joint angle \[rad\].
    Position,
    /// A joint velocity \[rad/s\].
    Velocity,
    /// A joint acceleration \[rad/s²\].
    Acceleration,
    /// A joint torque \[N·m\].
    Torque,
}

impl Quantity {
    const fn unit(self) -> &'static str {
        match self {
            Self::Position => "rad",
            Self::Velocity => "rad/s",
            Self::Acceleration => "rad/s²",
            Self::Torque => "N·m",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Torque => "torque",
        })
    }
}

/// Why a trajectory was refused. Joints are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Start and stop are the same posture, and nothing moves in between.
    #[error("start and stop are the same posture")]
    NoMotion,
    /// An angle, a velocity or an acceleration, given or what comes of those given, is infinite or NaN.
    #[error("the {quantity} of joint {joint} is infinite or NaN")]
    NonFinite {
        /// Which of them.
        quantity: Quantity,
        /// The joint, counted from 0.
        joint: usize,
    },
    /// A time does not lie after the one before it, or is not finite.
    #[error("knot {index} is at {time} s, not after the one before it at {before} s")]
    TimesOutOfOrder {
        /// Which knot, counted from 0.
        index: usize,
        /// The time of the knot before it \[s\].
        before: f64,
        /// Its time \[s\].
        time: f64,
    },
    /// The time asked for is not within the motion.
    #[error("{time} s is not within the motion, which lasts from 0 to {duration} s")]
    OutsideDuration {
        /// The time asked for \[s\].
        time: f64,
        /// The motion lasts from 0 to here \[s\].
        duration: f64,
    },
    /// The time of acceleration is not positive, or takes more than half of the motion.
    #[error("an acceleration of {time} s does not fit twice into a motion of {duration} s")]
    InvalidAccelerationTime {
        /// The time given \[s\].
        time: f64,
        /// The duration of the motion \[s\].
        duration: f64,
    },
    /// A limit is zero, negative or NaN, or a range is empty.
    #[error("the {quantity} limit of joint {joint} is not one: {value} {}", .quantity.unit())]
    InvalidLimit {
        /// What is limited.
        quantity: Quantity,
        /// The joint, counted from 0.
        joint: usize,
        /// The limit given.
        value: f64,
    },
    /// A joint goes beyond its limit.
    #[error(
        "the {quantity} of joint {joint} is {value} {unit} at {time} s, its limit is {limit} {unit}",
        unit = .quantity.unit()
    )]
    LimitExceeded {
        /// What exceeds the limit.
        quantity: Quantity,
        /// Which joint.
        joint: usize,
        /// When it is farthest beyond the limit \[s\].
        time: f64,
        /// What it is then.
        value: f64,
        /// What it may be.
        limit: f64,
    },
    /// A path needs at least this many intervals of its grid.
    #[error("a grid of {intervals} intervals is too coarse: at least {least}")]
    GridTooCoarse {
        /// The number of intervals given.
        intervals: usize,
        /// The least number.
        least: usize,
    },
    /// The path parameter asked for is not on the path.
    #[error("{s} is not on the path, which goes from 0 to {length}")]
    OutsidePath {
        /// The path parameter asked for.
        s: f64,
        /// The path goes from 0 to here.
        length: f64,
    },
    /// The path has no posture with a tangent here: it is singular.
    #[error("the path is singular at s = {s}")]
    PathSingular {
        /// The path parameter.
        s: f64,
    },
    /// No joint moves with the path parameter here: the path has a corner or is badly parametrized.
    #[error("no joint moves along the path at s = {s}")]
    PathStandsStill {
        /// The path parameter.
        s: f64,
    },
    /// No speed along the path satisfies all limits here, at the best approach and continuation.
    #[error("no speed along the path satisfies the limits at s = {s}")]
    Infeasible {
        /// The path parameter.
        s: f64,
    },
    /// The mechanism has forces that grow with the velocity (dissipation): limits are then not linear in the square of
    /// the speed along the path.
    #[error("joint {joint} has a force that grows with the velocity (s = {s}): not of this method")]
    VelocityForce {
        /// The path parameter at which it was noticed.
        s: f64,
        /// Which joint.
        joint: usize,
    },
    /// A function of the posture is infinite or NaN.
    #[error("the function is infinite or NaN at t = {time} s")]
    NonFiniteFunction {
        /// When \[s\].
        time: f64,
    },
    /// An integral did not come to its tolerance.
    #[error("the integral does not converge around t = {time} s")]
    NotConverged {
        /// The time around which it did not \[s\].
        time: f64,
    },
    /// The search for a motion of least effort did not come to its tolerance: limits leave no motion, or it was not
    /// found.
    #[error(
        "no motion of least effort was found: after {iterations} iterations the largest defect is {defect:e}, \
         the largest derivative {stationarity:e}"
    )]
    NoOptimum {
        /// Newton steps that were taken.
        iterations: usize,
        /// The largest derivative of the Lagrangian, in scaled variables.
        stationarity: f64,
        /// The largest defect, in scaled variables.
        defect: f64,
    },
}
