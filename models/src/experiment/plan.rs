//! What all machines do at one scale, and which limit breaks first.

use core::error::Error;
use core::fmt;

use mbs_runtime::{Dual, Pose};

use super::flight::{Flight, OutsideFlight};
use super::masses::{self, InvalidMass};
use super::rail_arm::{FlangeMotion, NotFollowed, RailArm, RailVector, angles};
use crate::arm::inverse::{Branch, Elbow, Shoulder, Wrist};
use crate::arm::jacobian::determinant_factors;
use crate::arm::limits::{InvalidLimits, LIMIT_TOLERANCE};
use crate::arm::trajectory::JointState;
use crate::platform::geometry::attitude;
use crate::platform::jacobian::angular_rates;
use crate::platform::limits::{InvalidLimits as InvalidActuators, LegState, Violation};
use crate::platform::{Coordinates, HOME, Platform, PoseError};

/// Where things are in the laboratory, in the axes of the rail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The middle of the platform, along the rail and across \[m\].
    pub platform: [f64; 2],
    /// Height of its deck over the arm's base when at rest \[m\].
    pub deck: f64,
}

impl Cell {
    /// The platform beside the middle of the rail, its deck 0.6 m over the arm's base: assumed.
    ///
    /// At rest the deck is 1.1 m over the platform's own base, which is then 0.5 m below the arm's.
    pub const LABORATORY: Self = Self { platform: [12.0, 0.15], deck: 0.6 };
}

/// What the flange does with the vehicle's attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attitude {
    /// It takes it on.
    Flown,
    /// It stays level: the tool points straight down.
    Level,
}

/// Arm, platform and the flight that they repeat.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The arm on its rail, with the vehicle at its flange.
    pub robot: RailArm,
    /// The platform.
    pub platform: Platform,
    /// Where it stands.
    pub cell: Cell,
    /// The landing at full size.
    pub flight: Flight,
    /// What becomes of its attitude.
    pub attitude: Attitude,
    /// The least and the greatest stand-off of the carriage that may be chosen \[m\]; [`plan`](Self::plan) chooses.
    pub standoffs: [f64; 2],
    /// Whether the accelerations of the joints, [`JointLimits::acceleration`](crate::arm::JointLimits), are limits too.
    ///
    /// They are assumed, and by default they are not: torques limit the drives. An attitude that is flown breaks them at any scale,
    /// since angles are not scaled: right at the start the vehicle's controller turns it back from the tilt it begins with.
    pub joint_accelerations: bool,
    /// How long the platform heaves, at least to the touchdown \[s\].
    pub heaving: f64,
    /// Between the moments of a survey, positive and no more than [`COARSEST`] \[s\].
    pub sampling: f64,
}

/// The branch that the arm is on: it faces the platform, elbow up, and its wrist does not turn over.
pub const BRANCH: Branch = Branch { shoulder: Shoulder::Front, elbow: Elbow::Positive, wrist: Wrist::Positive };

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

/// Everything at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// \[s\]
    pub time: f64,
    /// What the flange is to do.
    pub flange: FlangeMotion,
    /// What carriage and joints do for it.
    pub axes: JointState<7>,
    /// Force of the carriage \[N\] and torques \[N·m\].
    pub forces: RailVector,
    /// The arm's [margin](crate::arm::jacobian::Factors::margin) from singularities.
    pub margin: f64,
    /// Coordinates of the platform from its own base, their rates and accelerations.
    pub deck: [Coordinates; 3],
    /// Its legs.
    pub legs: LegState,
}

/// The experiment at one scale, with the carriage at one stand-off.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    experiment: &'a Experiment,
    scale: f64,
    standoff: f64,
}

/// A value, and when it was seen \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// In its unit, or as a part of a limit.
    pub value: f64,
    /// \[s\]
    pub time: f64,
}

/// What a plan asks of the machines: of the robot from the beginning to the touchdown, of the platform as long as it heaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// The limit that breaks first.
    pub broken: Option<Infeasible>,
    /// From where to where the axes go \[m, rad\].
    pub positions: [[f64; 2]; 7],
    /// The largest speeds \[m/s, rad/s\].
    pub speeds: RailVector,
    /// The largest accelerations \[m/s², rad/s²\].
    pub accelerations: RailVector,
    /// The largest forces \[N, N·m\].
    pub forces: RailVector,
    /// The largest speed as a part of its limit.
    pub speed_ratio: Seen,
    /// The largest acceleration as a part of its limit, whether that [counts](Experiment::joint_accelerations) or not.
    pub acceleration_ratio: Seen,
    /// The largest force or torque as a part of its limit.
    pub force_ratio: Seen,
    /// The arm's smallest [margin](crate::arm::jacobian::Factors::margin) from singularities.
    pub singularity_margin: Seen,
    /// Shortest and longest length of any leg of the platform \[m\].
    pub leg_length: [f64; 2],
    /// The largest speed of any leg \[m/s\].
    pub leg_speed: f64,
    /// The largest force of any leg \[N\].
    pub leg_force: f64,
}

impl Survey {
    /// True where no limit is broken.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.broken.is_none()
    }

    /// How much of its stroke the platform needs \[m\].
    #[must_use]
    pub fn platform_stroke(&self) -> f64 {
        self.leg_length[1] - self.leg_length[0]
    }
}

/// After which the elevations of both cases of the thesis repeat themselves \[s\].
pub const PERIOD: f64 = 40.0;
/// Stand-offs are compared at one of so many moments of a survey.
const COMPARED: usize = 4;
/// A survey has no more moments than this.
const MOST_MOMENTS: f64 = 1e7;
/// The moments of a survey are no farther apart \[s\]: it would miss what happens between them.
pub const COARSEST: f64 = 0.1;

impl Experiment {
    /// The default arm and platform in [`Cell::LABORATORY`]; the flange takes on the vehicle's attitude, the platform heaves for
    /// one [`PERIOD`].
    #[must_use]
    pub fn new(flight: Flight) -> Self {
        Self {
            robot: RailArm::default(),
            platform: Platform::default(),
            cell: Cell::LABORATORY,
            flight,
            attitude: Attitude::Flown,
            standoffs: [1.0, 2.0],
            joint_accelerations: false,
            heaving: PERIOD,
            sampling: 0.01,
        }
    }

    /// The plan at this scale with this stand-off of the carriage \[m\].
    ///
    /// # Errors
    /// [`PlanError`], but for [`PlanError::Infeasible`], which a [survey](Plan::survey) tells.
    pub fn plan_at(&self, scale: f64, standoff: f64) -> Result<Plan<'_>, PlanError> {
        self.check()?;
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(PlanError::InvalidScale { scale });
        }
        if !standoff.is_finite() {
            return Err(PlanError::NotFinite { parameter: "standoff", value: standoff });
        }
        Ok(Plan { experiment: self, scale, standoff })
    }

    fn check(&self) -> Result<(), PlanError> {
        let Cell { platform: [x, y], deck } = self.cell;
        let [least, greatest] = self.standoffs;
        let finite = [
            ("cell.platform[0]", x),
            ("cell.platform[1]", y),
            ("cell.deck", deck),
            ("standoffs[0]", least),
            ("standoffs[1]", greatest),
            ("heaving", self.heaving),
        ];
        if let Some((parameter, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(PlanError::NotFinite { parameter, value });
        }
        if greatest < least {
            return Err(PlanError::Standoffs { range: self.standoffs });
        }
        let longest = self.flight.touchdown().max(self.heaving);
        if !(self.sampling > 0.0 && self.sampling <= COARSEST && longest / self.sampling < MOST_MOMENTS) {
            return Err(PlanError::Sampling { step: self.sampling, end: longest });
        }
        masses::check(self.robot.model.params()).map_err(PlanError::Mass)?;
        self.robot.joints.check().map_err(PlanError::Joints)?;
        self.platform.limits.check().map_err(PlanError::Actuators)?;
        let rail = &self.robot.rail;
        let (range, bounds) = (rail.range, [rail.speed, rail.acceleration, rail.force]);
        let sound = range[0] <= range[1] && bounds.iter().all(|&bound| bound > 0.0);
        if sound { Ok(()) } else { Err(PlanError::Rail { range, bounds }) }
    }
}

impl<'a> Plan<'a> {
    /// What is planned.
    #[must_use]
    pub fn experiment(&self) -> &'a Experiment {
        self.experiment
    }

    /// The scale of lengths.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// How far the carriage keeps behind the flange \[m\].
    #[must_use]
    pub fn standoff(&self) -> f64 {
        self.standoff
    }

    /// The same with another stand-off, which is finite.
    pub(super) fn standing_off(self, standoff: f64) -> Self {
        Self { standoff, ..self }
    }

    /// What the flange is to do at a time \[s\].
    ///
    /// # Errors
    /// [`OutsideFlight`].
    pub fn flange(&self, t: f64) -> Result<FlangeMotion, OutsideFlight> {
        let Experiment { cell, flight, attitude: taken, .. } = self.experiment;
        let [q, qd, qdd] = flight.at(t)?;
        let scaled = |x: &Coordinates| [0, 1, 2].map(|axis| self.scale * x[axis]);
        let ([x, y, z], [vx, vy, vz], [ax, ay, az]) = (scaled(&q), scaled(&qd), scaled(&qdd));
        let [px, py] = flight.platform.map(|place| self.scale * place);
        let position = [cell.platform[0] + (x - px), cell.platform[1] + (y - py), cell.deck + z];
        let (rotation, [w, wd]) = match taken {
            Attitude::Level => (LEVEL, [[0.0; 3]; 2]),
            Attitude::Flown => (turned_over(attitude(&q)), angular_motion(&q, &qd, &qdd)),
        };
        Ok(FlangeMotion {
            pose: Pose { position, rotation },
            twist: [vx, vy, vz, w[0], w[1], w[2]],
            twist_rate: [ax, ay, az, wd[0], wd[1], wd[2]],
        })
    }

    /// What carriage and joints do at a time \[s\].
    ///
    /// # Errors
    /// [`Infeasible::Arm`], [`Infeasible::Flight`].
    pub fn axes(&self, t: f64) -> Result<JointState<7>, Infeasible> {
        self.followed(t).map(|(_, axes)| axes)
    }

    fn followed(&self, time: f64) -> Result<(FlangeMotion, JointState<7>), Infeasible> {
        let failed = |reason| Infeasible::Arm { time, reason };
        let flange = self.flange(time)?;
        let axes = self.experiment.robot.follow(&flange, self.standoff, BRANCH).map_err(failed)?;
        Ok((flange, axes))
    }

    /// Height of the deck over the arm's base \[m\], and its rate \[m/s\].
    #[must_use]
    pub fn deck_height(&self, t: f64) -> [f64; 2] {
        let elevation = self.experiment.flight.heave.at(t);
        [self.experiment.cell.deck + self.scale * elevation.value, self.scale * elevation.rate]
    }

    /// Coordinates of the platform over its own base, their rates and accelerations.
    #[must_use]
    pub fn deck(&self, t: f64) -> [Coordinates; 3] {
        let elevation = self.experiment.flight.heave.at(t);
        let mut motion = [HOME, [0.0; 6], [0.0; 6]];
        motion[0][2] += self.scale * elevation.value;
        motion[1][2] = self.scale * elevation.rate;
        motion[2][2] = self.scale * elevation.acceleration;
        motion
    }

    /// Everything at a time \[s\].
    ///
    /// # Errors
    /// [`Infeasible::Flight`], [`Infeasible::Arm`], [`Infeasible::Pose`]; limits are not looked at.
    pub fn moment(&self, time: f64) -> Result<Moment, Infeasible> {
        let (flange, axes) = self.followed(time)?;
        let forces = self.experiment.robot.forces(&axes);
        let margin = determinant_factors(&angles(&axes.q)).margin();
        Ok(Moment { time, flange, axes, forces, margin, deck: self.deck(time), legs: self.legs(time)? })
    }

    /// How far the arm keeps from the ends of its ranges, each as a part of half the range, and from singularities: the least on the
    /// way, at every fourth moment of a survey; negative where a range is left.
    ///
    /// # Errors
    /// [`Infeasible::Arm`], where the flange cannot go all the way.
    pub fn clearance(&self) -> Result<f64, Infeasible> {
        let joints = &self.experiment.robot.joints;
        let mut least = f64::INFINITY;
        for time in self.times().step_by(COMPARED) {
            let failed = |reason| Infeasible::Arm { time, reason };
            let pose = self.flange(time)?.pose;
            let solutions = self.experiment.robot.inverse(&pose, pose.position[0] - self.standoff);
            let solution = solutions.map_err(|reason| failed(reason.into()))?.of_branch(BRANCH);
            let q = solution.ok_or(failed(NotFollowed::BranchEnds { branch: BRANCH }))?.q;
            least = least.min(determinant_factors(&q).margin());
            for joint in 0..6 {
                let (lower, upper) = (joints.lower[joint], joints.upper[joint]);
                // A range without an end is kept.
                if upper - lower < f64::INFINITY {
                    least = least.min(2.0 * (q[joint] - lower).min(upper - q[joint]) / (upper - lower));
                }
            }
        }
        Ok(least)
    }

    /// The moments of a survey: the beginning, the touchdown, and between them every [`Experiment::sampling`] \[s\].
    pub fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let (step, end) = (self.experiment.sampling, self.experiment.flight.touchdown());
        (0_u32..).map(move |k| f64::from(k) * step).take_while(move |&t| t < end).chain([end])
    }

    /// What the plan asks of the machines, and which limit breaks first.
    ///
    /// Positions, speeds and forces of all axes are checked, the acceleration of the carriage, those of the joints
    /// [where they count](Experiment::joint_accelerations), and stroke, speed and force of the platform's legs.
    ///
    /// # Errors
    /// [`Infeasible::Arm`], [`Infeasible::Pose`], where there is nothing to survey.
    pub fn survey(&self) -> Result<Survey, Infeasible> {
        let Experiment { robot, heaving, sampling, flight, .. } = self.experiment;
        let mut survey = Survey::new();
        for time in self.times() {
            let moment = self.moment(time)?;
            survey.add(&moment, robot);
            if survey.broken.is_none() {
                survey.broken = self.broken(&moment);
            }
        }
        // The platform goes on.
        let after = (0_u32..).map(|k| f64::from(k) * sampling).skip_while(|&t| t <= flight.touchdown());
        for time in after.take_while(|t| t <= heaving) {
            let legs = self.legs(time)?;
            survey.add_legs(&legs);
            if survey.broken.is_none() {
                survey.broken = self.broken_leg(time, legs);
            }
        }
        Ok(survey)
    }

    /// Lengths, rates and forces of the platform's legs at a time \[s\].
    ///
    /// # Errors
    /// [`Infeasible::Pose`].
    pub fn legs(&self, time: f64) -> Result<LegState, Infeasible> {
        let [q, qd, qdd] = self.deck(time);
        self.experiment.platform.leg_state(&q, &qd, &qdd).map_err(|reason| Infeasible::Pose { time, reason })
    }

    /// The first limit that is broken at a moment: axis by axis, then leg by leg.
    #[must_use]
    pub fn broken(&self, moment: &Moment) -> Option<Infeasible> {
        let Experiment { robot, joint_accelerations, .. } = self.experiment;
        let axis = axis_violations(robot, *joint_accelerations, moment).next().map(Infeasible::Axis);
        axis.or_else(|| self.broken_leg(moment.time, moment.legs))
    }

    fn broken_leg(&self, time: f64, legs: LegState) -> Option<Infeasible> {
        self.experiment.platform.limits.violations(time, legs).next().map(Infeasible::Leg)
    }
}

/// The attitude of the flange over a level vehicle: half a turn about x.
const LEVEL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];

/// `R diag(1, −1, −1)`: from the attitude of the vehicle to that of the flange, and back.
#[must_use]
pub fn turned_over(rotation: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    rotation.map(|[x, y, z]| [x, -y, -z])
}

/// Angular velocity and acceleration in the axes of the world: `ω = E(q) (φ̇, θ̇, ψ̇)`, `ω̇ = E (φ̈, θ̈, ψ̈) + Ė (φ̇, θ̇, ψ̇)`.
fn angular_motion(q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> [[f64; 3]; 2] {
    let moving: [Dual<f64>; 6] = core::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] });
    let rates = angular_rates(&moving);
    let of = |x: &Coordinates, part: fn(&Dual<f64>) -> f64| {
        rates.map(|row| (0..3).map(|j| part(&row[j]) * x[3 + j]).sum::<f64>())
    };
    let (held, turning) = (of(qdd, |entry| entry.value), of(qd, |entry| entry.derivative));
    [of(qd, |entry| entry.value), [0, 1, 2].map(|i| held[i] + turning[i])]
}

/// What of the axes exceeds the limits, axis by axis.
fn axis_violations(
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

impl Survey {
    fn new() -> Self {
        let none = Seen { value: 0.0, time: 0.0 };
        Self {
            broken: None,
            positions: [[f64::INFINITY, f64::NEG_INFINITY]; 7],
            speeds: [0.0; 7],
            accelerations: [0.0; 7],
            forces: [0.0; 7],
            speed_ratio: none,
            acceleration_ratio: none,
            force_ratio: none,
            singularity_margin: Seen { value: f64::INFINITY, time: 0.0 },
            leg_length: [f64::INFINITY, f64::NEG_INFINITY],
            leg_speed: 0.0,
            leg_force: 0.0,
        }
    }

    fn add(&mut self, moment: &Moment, robot: &RailArm) {
        let Moment { time, axes: JointState { q, qd, qdd }, forces, margin, legs, .. } = moment;
        let time = *time;
        for axis in 0..7 {
            let [least, greatest] = self.positions[axis];
            self.positions[axis] = [lesser(least, q[axis]), greater(greatest, q[axis])];
            self.speeds[axis] = greater(self.speeds[axis], qd[axis].abs());
            self.accelerations[axis] = greater(self.accelerations[axis], qdd[axis].abs());
            self.forces[axis] = greater(self.forces[axis], forces[axis].abs());
        }
        self.speed_ratio.raise(greatest_part(qd, &robot.speed_limits()), time);
        self.acceleration_ratio.raise(greatest_part(qdd, &robot.acceleration_limits()), time);
        self.force_ratio.raise(greatest_part(forces, &robot.force_limits()), time);
        self.singularity_margin.lower(*margin, time);
        self.add_legs(legs);
    }

    fn add_legs(&mut self, legs: &LegState) {
        for leg in 0..6 {
            let [shortest, longest] = self.leg_length;
            self.leg_length = [lesser(shortest, legs.length[leg]), greater(longest, legs.length[leg])];
            self.leg_speed = greater(self.leg_speed, legs.rate[leg].abs());
            self.leg_force = greater(self.leg_force, legs.force[leg].abs());
        }
    }
}

impl Seen {
    /// Where the value is greater, or the first that is NaN.
    pub(super) fn raise(&mut self, value: f64, time: f64) {
        if value > self.value || (value.is_nan() && !self.value.is_nan()) {
            *self = Self { value, time };
        }
    }

    /// Where the value is less, or the first that is NaN.
    fn lower(&mut self, value: f64, time: f64) {
        if value < self.value || (value.is_nan() && !self.value.is_nan()) {
            *self = Self { value, time };
        }
    }
}

/// The greater of two numbers; NaN where one is, which `f64::max` would leave out.
fn greater(one: f64, other: f64) -> f64 {
    if other > one || other.is_nan() { other } else { one }
}

/// The lesser of two numbers; NaN where one is.
fn lesser(one: f64, other: f64) -> f64 {
    if other < one || other.is_nan() { other } else { one }
}

/// The greatest magnitude as a part of its limit; NaN where one is.
pub(super) fn greatest_part(values: &RailVector, limits: &RailVector) -> f64 {
    (0..7).map(|axis| values[axis].abs() / limits[axis]).fold(0.0, greater)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrotor::heave::Heave;
    use crate::quadrotor::landing::{Landing, Plant};

    #[test]
    fn a_number_that_is_none_is_not_left_out() {
        let flight = Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I)).expect("a landing");
        let experiment = Experiment::new(flight);
        let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
        let good = plan.moment(1.0).expect("reachable");
        for axis in 0..7 {
            let mut bad = plan.moment(2.0).expect("reachable");
            for values in [&mut bad.axes.q, &mut bad.axes.qd, &mut bad.axes.qdd, &mut bad.forces] {
                values[axis] = f64::NAN;
            }
            bad.margin = f64::NAN;
            bad.legs.length[axis % 6] = f64::NAN;
            bad.legs.rate[axis % 6] = f64::NAN;
            bad.legs.force[axis % 6] = f64::NAN;
            let mut survey = Survey::new();
            // What comes after it does not hide it.
            for moment in [&good, &bad, &good] {
                survey.add(moment, &experiment.robot);
            }
            let of_axis = [survey.speeds, survey.accelerations, survey.forces].map(|values| values[axis]);
            assert!(of_axis.iter().chain(&survey.positions[axis]).all(|x| x.is_nan()), "{survey:?}");
            let Survey { speed_ratio, acceleration_ratio, force_ratio, singularity_margin, .. } = survey;
            for seen in [speed_ratio, acceleration_ratio, force_ratio, singularity_margin] {
                assert!(seen.value.is_nan() && seen.time == 2.0, "{survey:?}");
            }
            let Survey { leg_length: [shortest, longest], leg_speed, leg_force, .. } = survey;
            assert!([shortest, longest, leg_speed, leg_force].iter().all(|x| x.is_nan()), "{survey:?}");
            assert!(plan.broken(&bad).is_some());
        }
    }
}
