//! The arm on its rail: seven axes, of which the first slides. Its redundancy is resolved by a stand-off.
//!
//! A pose of the flange leaves one of seven axes open. Here the carriage keeps the flange a constant stand-off `ρ`
//! ahead of the arm's base, along the rail:
//!
//! ```text
//! r = x − ρ,   ṙ = ẋ,   r̈ = ẍ
//! ```
//!
//! so that the motion along the rail is all the carriage's, and the arm sees a flange that moves across and up and
//! down. The six angles are those of the closed form on one branch; rates and accelerations follow from the Jacobian
//! `J = [J_r J_θ]`:
//!
//! ```text
//! θ̇ = J_θ⁻¹ (V − J_r ṙ),   θ̈ = J_θ⁻¹ (V̇ − J_r r̈ − J̇ q̇),   V = [v; ω]
//! ```
//!
//! ```
//! use mbs_arm::inverse::{Branch, Elbow, Shoulder, Wrist};
//! use mbs_landing::experiment::rail_arm::{FlangeMotion, RailArm};
//!
//! // Tool down, 1.6 m ahead of the base, on the way up with 0.1 m/s and along the rail with 0.3 m/s.
//! let robot = RailArm::default();
//! let mut flange = FlangeMotion::at_rest([12.0, 0.15, 1.2], [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
//! flange.twist = [0.3, 0.0, 0.1, 0.0, 0.0, 0.0];
//! let branch = Branch { shoulder: Shoulder::Front, elbow: Elbow::Positive, wrist: Wrist::Positive };
//! let state = robot.follow(&flange, 1.6, branch).unwrap();
//! assert!((state.q[0] - 10.4).abs() < 1e-12 && state.qd[0] == 0.3);
//! let twist = robot.model.flange_velocity(&state.q, &state.qd);
//! assert!((0..6).all(|i| (twist[i] - flange.twist[i]).abs() < 1e-12));
//! ```

use mbs_models::{Error, Failure};
use mbs_runtime::{Pose, to_matrix, to_vector};
use nalgebra::Vector6;

use mbs_arm::inverse::{Branch, InverseKinematics, Solutions};
use mbs_arm::jacobian::determinant_factors;
use mbs_arm::trajectory::JointState;
use mbs_arm::trajectory::cartesian::ON_BRANCH;
use mbs_arm::{JointLimits, JointVector};
use mbs_models::irb7600_rail::Irb7600Rail;

/// Seven numbers, one an axis: the carriage \[m\], then the six joints \[rad\]; their rates, accelerations, or forces.
pub type RailVector = [f64; 7];

/// What the rail and the carriage's drive allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RailLimits {
    /// The ends of the rail \[m\].
    pub range: [f64; 2],
    /// Largest speed \[m/s\].
    pub speed: f64,
    /// Largest acceleration, either way \[m/s²\].
    pub acceleration: f64,
    /// Largest force of the drive \[N\].
    pub force: f64,
}

impl RailLimits {
    /// 22 m, 1.2 m/s, 1.5 m/s², 10 kN.
    ///
    /// # Source
    /// The length is that of the thesis, chapter 6; the others are assumed, the force of the size that 2.8 t at that
    /// acceleration ask for twice.
    pub const LABORATORY: Self = Self { range: [0.0, 22.0], speed: 1.2, acceleration: 1.5, force: 10e3 };
}

/// Where the flange is to be, and how it is to move there, in the axes of the rail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlangeMotion {
    /// Position \[m\] and attitude.
    pub pose: Pose<f64>,
    /// Velocity \[m/s\] and angular velocity \[rad/s\].
    pub twist: [f64; 6],
    /// Their rates \[m/s², rad/s²\].
    pub twist_rate: [f64; 6],
}

impl FlangeMotion {
    /// Standing still.
    #[must_use]
    pub fn at_rest(position: [f64; 3], rotation: [[f64; 3]; 3]) -> Self {
        Self { pose: Pose { position, rotation }, twist: [0.0; 6], twist_rate: [0.0; 6] }
    }
}

const FLANGE_MOTION: &str = "a velocity or an acceleration of the flange";

/// A margin that is no larger counts as singular: half of the digits of the rates would be lost.
pub const SINGULAR: f64 = 1e-8;

/// The arm on its rail: its generated dynamics, and what its drives allow.
#[derive(Clone, Debug)]
pub struct RailArm {
    /// Equations of motion, energies and outputs, with what the flange carries.
    pub model: Irb7600Rail<f64>,
    /// Ranges of the joints, their speeds, accelerations and torques.
    pub joints: JointLimits,
    /// Those of the carriage.
    pub rail: RailLimits,
}

impl Default for RailArm {
    /// With the declared masses and inertias, the quadrotor at the flange, [`JointLimits::IRB7600`] and
    /// [`RailLimits::LABORATORY`].
    fn default() -> Self {
        Self { model: Irb7600Rail::default(), joints: JointLimits::IRB7600, rail: RailLimits::LABORATORY }
    }
}

/// The six angles \[rad\], without the carriage.
#[must_use]
pub fn angles(q: &RailVector) -> JointVector {
    let [_, joints @ ..] = *q;
    joints
}

impl RailArm {
    /// Position \[m\] and attitude of the flange, in the axes of the rail.
    #[must_use]
    pub fn pose(&self, q: &RailVector) -> Pose<f64> {
        self.model.flange(q)
    }

    /// All configurations of the arm that reach a pose of the flange while the carriage is at `rail` \[m\].
    ///
    /// # Errors
    /// [`Error`] where the pose, or the place of the carriage, is none, or the pose is out of reach from there.
    pub fn inverse(&self, pose: &Pose<f64>, rail: f64) -> Result<Solutions, Error> {
        let [x, y, z] = pose.position;
        InverseKinematics::default().solve(&Pose { position: [x - rail, y, z], rotation: pose.rotation })
    }

    /// Positions, rates and accelerations of all axes while the flange moves so, the carriage a stand-off \[m\] behind
    /// it.
    ///
    /// Angles are in `[−π, π]`: ranges are checked by whoever asks.
    ///
    /// # Errors
    /// [`Error`].
    pub fn follow(&self, flange: &FlangeMotion, standoff: f64, branch: Branch) -> Result<JointState<7>, Error> {
        let rail = flange.pose.position[0] - standoff;
        let solution = self.inverse(&flange.pose, rail)?.of_branch(branch).ok_or(Failure::Missing(ON_BRANCH))?;
        let margin = determinant_factors(&solution.q).margin();
        let singular =
            Failure::Singular { of: "the arm", smallest: margin, largest: 1.0, unit: "relative to the largest" };
        // NaN is not.
        let is_regular = margin > SINGULAR;
        if !is_regular {
            return Err(singular.into());
        }
        let q = joined(rail, solution.q);
        let jacobian = self.model.flange_jacobian(&q);
        let of_joints = jacobian.map(|row| core::array::from_fn::<f64, 6, _>(|j| row[1 + j]));
        let factors = to_matrix(&of_joints).lu();
        // The carriage moves with the flange's x.
        let solve = |carriage: f64, rest: [f64; 6]| -> Result<RailVector, Failure> {
            let rest: [f64; 6] = core::array::from_fn(|i| rest[i] - jacobian[i][0] * carriage);
            let found: Option<Vector6<f64>> = factors.solve(&to_vector(&rest));
            let found = found.ok_or(singular)?;
            let all = joined(carriage, found.into());
            if all.iter().all(|x| x.is_finite()) { Ok(all) } else { Err(Failure::NotFinite(FLANGE_MOTION)) }
        };
        let qd = solve(flange.twist[0], flange.twist)?;
        let jacobian_rate = self.model.flange_jacobian_rate(&q, &qd);
        let missing =
            core::array::from_fn(|i| flange.twist_rate[i] - (0..7).map(|j| jacobian_rate[i][j] * qd[j]).sum::<f64>());
        let qdd = solve(flange.twist_rate[0], missing)?;
        Ok(JointState { q, qd, qdd })
    }

    /// Force of the carriage \[N\] and torques of the joints \[N·m\] that move the axes so.
    #[must_use]
    pub fn forces(&self, state: &JointState<7>) -> RailVector {
        self.model.inverse_dynamics(&state.q, &state.qd, &state.qdd)
    }

    /// The largest force of the carriage \[N\] and the largest torques \[N·m\].
    #[must_use]
    pub fn force_limits(&self) -> RailVector {
        joined(self.rail.force, self.joints.torque)
    }

    /// The largest speeds \[m/s, rad/s\].
    #[must_use]
    pub fn speed_limits(&self) -> RailVector {
        joined(self.rail.speed, self.joints.speed)
    }

    /// The largest accelerations \[m/s², rad/s²\].
    #[must_use]
    pub fn acceleration_limits(&self) -> RailVector {
        joined(self.rail.acceleration, self.joints.acceleration)
    }

    /// The ends of the rail \[m\] and of the ranges of the joints \[rad\].
    #[must_use]
    pub fn ranges(&self) -> [[f64; 2]; 7] {
        core::array::from_fn(|axis| match axis.checked_sub(1) {
            None => self.rail.range,
            Some(joint) => [self.joints.lower[joint], self.joints.upper[joint]],
        })
    }
}

/// The carriage, then the joints.
pub(super) fn joined(carriage: f64, joints: JointVector) -> RailVector {
    let [a, b, c, d, e, f] = joints;
    [carriage, a, b, c, d, e, f]
}
