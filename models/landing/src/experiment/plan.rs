//! What all machines do at one scale.

use mbs_models::Failure;
use mbs_models::check::{self, Invalid, Must};
use mbs_runtime::{Dual, Pose};

use super::collision::Shapes;
use super::error::Infeasible;
use super::flight::Flight;
use super::limits::axis_violations;
use super::masses;
use super::rail_arm::{FlangeMotion, RailArm, angles, joined};
use super::survey::{Moment, Survey};
use mbs_arm::inverse::{Branch, Elbow, Shoulder, Wrist};
use mbs_arm::jacobian::determinant_factors;
use mbs_arm::trajectory::JointState;
use mbs_arm::trajectory::cartesian::ON_BRANCH;
use mbs_platform::geometry::attitude;
use mbs_platform::jacobian::angular_rates;
use mbs_platform::limits::LegState;
use mbs_platform::{Coordinates, HOME, Platform};

/// Where things are in the laboratory, in the axes of the rail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The middle of the platform, along the rail and across \[m\].
    pub platform: [f64; 2],
    /// Height of its deck over the arm's base when at rest \[m\].
    pub deck: f64,
}

impl Cell {
    /// The platform 1.3 m beyond the end of the rail, its deck 0.6 m over the arm's base: assumed.
    ///
    /// At rest the deck is 1.1 m over the platform's own base, which is then 0.5 m below the arm's.
    pub const LABORATORY: Self = Self { platform: [23.3, 0.15], deck: 0.6 };
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
    /// How thick everything is, which is to stay apart.
    pub shapes: Shapes,
    /// The landing at full size.
    pub flight: Flight,
    /// What becomes of its attitude.
    pub attitude: Attitude,
    /// The least and the greatest stand-off of the carriage that may be chosen \[m\]; [`plan`](Self::plan) chooses.
    pub standoffs: [f64; 2],
    /// Whether the accelerations of the joints, [`JointLimits::acceleration`](mbs_arm::JointLimits), are limits too.
    ///
    /// They are assumed, and by default they are not: torques limit the drives. An attitude that is flown breaks them
    /// at any scale, since angles are not scaled: right at the start the vehicle's controller turns it back from the
    /// tilt it begins with.
    pub joint_accelerations: bool,
    /// How long the platform heaves, at least to the touchdown \[s\].
    pub heaving: f64,
    /// Between the moments of a survey, positive and no more than [`COARSEST`] \[s\].
    pub sampling: f64,
}

/// The branch that the arm is on: it faces the platform, elbow up, and its wrist does not turn over.
pub const BRANCH: Branch = Branch { shoulder: Shoulder::Front, elbow: Elbow::Positive, wrist: Wrist::Positive };

/// The experiment at one scale, with the carriage at one stand-off.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    experiment: &'a Experiment,
    scale: f64,
    standoff: f64,
}

/// After which the elevations of both cases of the thesis repeat themselves \[s\].
pub const PERIOD: f64 = 40.0;
/// Stand-offs are compared at one in this many moments of a survey.
const COMPARED: usize = 4;
/// Bodies that are so far apart are as far from each other as an axis in the middle of its range from its ends \[m\].
pub const WIDE: f64 = 0.5;
/// A survey has no more moments than this.
const MOST_MOMENTS: f64 = 1e7;
/// The moments of a survey are no farther apart \[s\]: it would miss what happens between them.
pub const COARSEST: f64 = 0.1;

impl Experiment {
    /// The default arm and platform in [`Cell::LABORATORY`]; the flange takes on the vehicle's attitude, the platform
    /// heaves for one [`PERIOD`].
    #[must_use]
    pub fn new(flight: Flight) -> Self {
        Self {
            robot: RailArm::default(),
            platform: Platform::default(),
            cell: Cell::LABORATORY,
            shapes: Shapes::LABORATORY,
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
    /// [`Infeasible::Refused`]; what breaks first is told by a [survey](Plan::survey).
    pub fn plan_at(&self, scale: f64, standoff: f64) -> Result<Plan<'_>, Infeasible> {
        self.check()?;
        check::positive("scale", scale)?;
        check::finite("standoff", standoff)?;
        Ok(Plan { experiment: self, scale, standoff })
    }

    fn check(&self) -> Result<(), Invalid> {
        check::finite("cell.platform", self.cell.platform)?;
        check::finite("cell.deck", self.cell.deck)?;
        check::finite("standoffs", self.standoffs)?;
        self.shapes.check()?;
        check::finite("heaving", self.heaving)?;
        let [least, greatest] = self.standoffs;
        Must::BeAtLeast(least).check("greatest standoff", greatest)?;
        let longest = self.flight.touchdown().max(self.heaving);
        check::positive("sampling", self.sampling)?;
        Must::BeAtMost(COARSEST).check("sampling", self.sampling)?;
        Must::BeLessThan(MOST_MOMENTS).check("number of moments", longest / self.sampling)?;
        masses::check(self.robot.model.params())?;
        self.robot.joints.check()?;
        self.platform.limits.check()?;
        let rail = &self.robot.rail;
        Must::BeAtLeast(rail.range[0]).check("end of the rail", rail.range[1])?;
        Must::BeMoreThan(0.0).check("largest speed on the rail", rail.speed)?;
        Must::BeMoreThan(0.0).check("largest acceleration on the rail", rail.acceleration)?;
        Must::BeMoreThan(0.0).check("largest force on the rail", rail.force)
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

    /// The plan with another stand-off, which is finite.
    pub(super) fn standing_off(self, standoff: f64) -> Self {
        Self { standoff, ..self }
    }

    /// What the flange is to do at a time \[s\].
    ///
    /// # Errors
    /// [`Invalid`] for a time outside of the flight.
    pub fn flange(&self, t: f64) -> Result<FlangeMotion, Invalid> {
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
    /// [`Infeasible::Arm`], [`Infeasible::Refused`].
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
    /// [`Infeasible::Refused`], [`Infeasible::Arm`], [`Infeasible::Pose`]; limits are not looked at.
    pub fn moment(&self, time: f64) -> Result<Moment, Infeasible> {
        let (flange, axes) = self.followed(time)?;
        let forces = self.experiment.robot.forces(&axes);
        let margin = determinant_factors(&angles(&axes.q)).margin();
        let deck = self.deck(time);
        let nearest = self.nearest(&axes.q, &deck[0]).map_err(|reason| Infeasible::Pose { time, reason })?;
        Ok(Moment { time, flange, axes, forces, margin, deck, legs: self.legs(time)?, nearest })
    }

    /// How far the arm keeps from the ends of its ranges, each as a part of half the range, from singularities, and
    /// from other bodies as a part of [`WIDE`]: the least on the way, at every fourth moment of a survey; negative
    /// where a range is left or bodies overlap.
    ///
    /// # Errors
    /// [`Infeasible::Arm`], where the flange cannot go all the way; [`Infeasible::Pose`].
    pub fn clearance(&self) -> Result<f64, Infeasible> {
        let joints = &self.experiment.robot.joints;
        let mut least = f64::INFINITY;
        for time in self.times().step_by(COMPARED) {
            let failed = |reason| Infeasible::Arm { time, reason };
            let pose = self.flange(time)?.pose;
            let rail = pose.position[0] - self.standoff;
            let solutions = self.experiment.robot.inverse(&pose, rail);
            let solution = solutions.map_err(failed)?.of_branch(BRANCH);
            let q = solution.ok_or(failed(Failure::Missing(ON_BRANCH).into()))?.q;
            let nearest = self.nearest(&joined(rail, q), &self.deck(time)[0]);
            let nearest = nearest.map_err(|reason| Infeasible::Pose { time, reason })?;
            least = least.min(determinant_factors(&q).margin()).min(nearest.distance / WIDE);
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

    /// The first limit that is broken at a moment: axis by axis, then leg by leg, then what overlaps.
    #[must_use]
    pub fn broken(&self, moment: &Moment) -> Option<Infeasible> {
        let Experiment { robot, joint_accelerations, .. } = self.experiment;
        let axis = axis_violations(robot, *joint_accelerations, moment).next().map(Infeasible::Axis);
        let Moment { time, legs, nearest, .. } = *moment;
        let collision = || Infeasible::Collision { time, nearest };
        axis.or_else(|| self.broken_leg(time, legs)).or_else(|| nearest.overlaps().then(collision))
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

/// Angular velocity and acceleration in the axes of the world: `ω = E(q) (φ̇, θ̇, ψ̇)`, `ω̇ = E (φ̈, θ̈, ψ̈) + Ė (φ̇,
/// θ̇, ψ̇)`.
fn angular_motion(q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> [[f64; 3]; 2] {
    let moving: [Dual<f64>; 6] = core::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] });
    let rates = angular_rates(&moving);
    let of = |x: &Coordinates, part: fn(&Dual<f64>) -> f64| {
        rates.map(|row| (0..3).map(|j| part(&row[j]) * x[3 + j]).sum::<f64>())
    };
    let (held, turning) = (of(qdd, |entry| entry.value), of(qd, |entry| entry.derivative));
    [of(qd, |entry| entry.value), [0, 1, 2].map(|i| held[i] + turning[i])]
}
