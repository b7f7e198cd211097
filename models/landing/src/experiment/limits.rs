//! Limits of the carriage and the joints, and which of them a moment exceeds.

use core::fmt;

use super::rail_arm::RailArm;
use super::survey::Moment;
use mbs_arm::limits::LIMIT_TOLERANCE;
use mbs_arm::trajectory::JointState;

/// Which limit of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisQuantity {
    /// The end of its range.
    Position,
    /// Its speed.
    Speed,
    /// Its acceleration.
    Acceleration,
    /// The force or the torque of its drive.
    Force,
}

impl AxisQuantity {
    /// In which it is given, for an axis, the carriage being the axis 0.
    #[must_use]
    pub fn unit(self, axis: usize) -> &'static str {
        match (self, axis) {
            (Self::Position, 0) => "m",
            (Self::Position, _) => "rad",
            (Self::Speed, 0) => "m/s",
            (Self::Speed, _) => "rad/s",
            (Self::Acceleration, 0) => "m/s²",
            (Self::Acceleration, _) => "rad/s²",
            (Self::Force, 0) => "N",
            (Self::Force, _) => "N·m",
        }
    }
}

impl fmt::Display for AxisQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
        })
    }
}

const DEGREES: f64 = 180.0 / core::f64::consts::PI;

/// A limit that an axis exceeds at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisViolation {
    /// The axis: 0 is the carriage, 1 to 6 are the joints.
    pub axis: usize,
    /// Which limit.
    pub quantity: AxisQuantity,
    /// When \[s\].
    pub time: f64,
    /// What the axis has.
    pub value: f64,
    /// What it may have.
    pub limit: f64,
}

impl fmt::Display for AxisViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { axis, quantity, time, value, limit } = *self;
        match axis {
            0 => write!(f, "t = {time:.3} s, carriage")?,
            joint => write!(f, "t = {time:.3} s, joint {joint}")?,
        }
        // Angles are read in degrees.
        let (unit, factor) = match (quantity, axis) {
            (AxisQuantity::Force, _) | (_, 0) => (quantity.unit(axis), 1.0),
            (AxisQuantity::Position, _) => ("°", DEGREES),
            (AxisQuantity::Speed, _) => ("°/s", DEGREES),
            (AxisQuantity::Acceleration, _) => ("°/s²", DEGREES),
        };
        write!(f, ": {quantity} {:.4} {unit}, the limit is {:.4} {unit}", factor * value, factor * limit)
    }
}

/// What of the axes exceeds the limits, axis by axis.
pub(super) fn axis_violations(
    robot: &RailArm,
    all_accelerations: bool,
    moment: &Moment,
) -> impl Iterator<Item = AxisViolation> + use<> {
    let (ranges, speeds, forces) = (robot.ranges(), robot.speed_limits(), robot.force_limits());
    let (time, JointState { q, qd, qdd }, force) = (moment.time, moment.axes, moment.forces);
    let accelerations = robot.acceleration_limits();
    (0..7).flat_map(move |axis| {
        let [lower, upper] = ranges[axis];
        let end = if q[axis] < lower { lower } else { upper };
        let inside = lower - LIMIT_TOLERANCE <= q[axis] && q[axis] <= upper + LIMIT_TOLERANCE;
        let bounded = |value: f64, bound: f64| value.abs() <= bound;
        let checks = [
            (AxisQuantity::Position, q[axis], end, inside),
            (AxisQuantity::Speed, qd[axis], speeds[axis], bounded(qd[axis], speeds[axis])),
            (
                AxisQuantity::Acceleration,
                qdd[axis],
                accelerations[axis],
                (axis > 0 && !all_accelerations) || bounded(qdd[axis], accelerations[axis]),
            ),
            (AxisQuantity::Force, force[axis], forces[axis], bounded(force[axis], forces[axis])),
        ];
        let broken = checks.into_iter().filter(|(.., kept)| !kept);
        broken.map(move |(quantity, value, limit, _)| AxisViolation { axis, quantity, time, value, limit })
    })
}
