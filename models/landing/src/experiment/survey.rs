//! What a plan asks of the machines, gathered over its moments.

use super::collision::{Body, Nearest};
use super::error::Infeasible;
use super::rail_arm::{FlangeMotion, RailArm, RailVector};
use mbs_arm::trajectory::JointState;
use mbs_platform::Coordinates;
use mbs_platform::limits::LegState;

/// Everything at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time \[s\].
    pub time: f64,
    /// What the flange is to do.
    pub flange: FlangeMotion,
    /// What carriage and joints do for it.
    pub axes: JointState<7>,
    /// Force of the carriage \[N\] and torques \[N·m\].
    pub forces: RailVector,
    /// The arm's [margin](mbs_arm::jacobian::Factors::margin) from singularities.
    pub margin: f64,
    /// Coordinates of the platform from its own base, their rates and accelerations.
    pub deck: [Coordinates; 3],
    /// Its legs.
    pub legs: LegState,
    /// What is nearest to each other of arm, vehicle and platform.
    pub nearest: Nearest,
}

/// A value, and when it was seen \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// In its unit, or as a part of a limit.
    pub value: f64,
    /// The time \[s\].
    pub time: f64,
}

/// What a plan asks of the machines: of the robot from the beginning to the touchdown, of the platform as long as it
/// heaves.
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
    /// The largest acceleration as a part of its limit, whether that
    /// [counts](super::plan::Experiment::joint_accelerations) or not.
    pub acceleration_ratio: Seen,
    /// The largest force or torque as a part of its limit.
    pub force_ratio: Seen,
    /// The arm's smallest [margin](mbs_arm::jacobian::Factors::margin) from singularities.
    pub singularity_margin: Seen,
    /// The smallest distance of two bodies that are to stay apart \[m\], negative where they overlap.
    pub distance: Seen,
    /// Which.
    pub nearest: [Body; 2],
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

impl Survey {
    pub(super) fn new() -> Self {
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
            distance: Seen { value: f64::INFINITY, time: 0.0 },
            nearest: [Body::Base, Body::Forearm],
            leg_length: [f64::INFINITY, f64::NEG_INFINITY],
            leg_speed: 0.0,
            leg_force: 0.0,
        }
    }

    pub(super) fn add(&mut self, moment: &Moment, robot: &RailArm) {
        let Moment { time, axes: JointState { q, qd, qdd }, forces, margin, legs, nearest, .. } = moment;
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
        self.distance.lower(nearest.distance, time);
        if self.distance.time == time {
            self.nearest = nearest.bodies;
        }
        self.add_legs(legs);
    }

    pub(super) fn add_legs(&mut self, legs: &LegState) {
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
    use crate::experiment::flight::Flight;
    use crate::experiment::plan::Experiment;
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
