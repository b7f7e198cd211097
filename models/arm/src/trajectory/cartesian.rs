//! The flange along a straight line, turning about one axis, and the joints that make it do so.
//!
//! ```
//! use mbs_arm::Arm;
//! use mbs_arm::trajectory::cartesian::{CartesianPath, FlangeLine};
//! use mbs_arm::trajectory::{AlongPath, Motion, quintic};
//!
//! // Half a metre forward and down, without turning, in four seconds.
//! let arm = Arm::default();
//! let start = [0.2, -1.3, 0.1, 0.3, 0.9, 0.0];
//! let from = arm.pose(&start);
//! let mut to = from;
//! to.position[0] += 0.3;
//! to.position[2] -= 0.4;
//! let path = CartesianPath::<33>::new(&arm, FlangeLine::new(&from, &to)?, &start)?;
//! let motion = AlongPath::new(path, quintic([0.0], [0.0], [1.0], 4.0)?)?;
//! let halfway = arm.pose(&motion.at(2.0)?.q).position;
//! assert!((0..3).all(|i| (halfway[i] - 0.5 * (from.position[i] + to.position[i])).abs() < 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use core::f64::consts::TAU;
use core::fmt;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::attitude::{difference, exp, orthonormalized};
use mbs_runtime::{Dual, Pose, to_matrix, to_rows};
use nalgebra::{Matrix3, Vector3};

use super::{JointPath, POSITION, PathPoint};
use crate::inverse::{Branch, InverseKinematics, L1, Solution};
use crate::jacobian::determinant_factors;
use crate::{A1, A2, Arm, JointVector};
use mbs_models::irb7600::Irb7600;

/// A straight line of the flange's origin, while the flange turns evenly about one axis: `0 ≤ s ≤ 1`.
///
/// `p = p₀ + s (p₁ − p₀)` and `R = exp(s φ×) R₀` with `φ = log(R₁ R₀ᵀ)`, which is Shoemake's slerp. It turns the
/// shorter way; where both are half a turn, `φ` has its largest component positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlangeLine {
    position: [f64; 3],
    way: [f64; 3],
    rotation: Matrix3<f64>,
    turn: Vector3<f64>,
}

impl FlangeLine {
    /// From one pose of the flange to another.
    ///
    /// # Errors
    /// Matrices that are no rotations, or too far from one to be orthonormalized; positions that are not finite; poses
    /// that are the same.
    pub fn new(from: &Pose<f64>, to: &Pose<f64>) -> Result<Self, Error> {
        let rotation =
            |pose: &Pose<f64>, s| orthonormalized(&pose.rotation).map_err(|error| Failure::from(error).at_path(s));
        for (pose, s) in [(from, 0.0), (to, 1.0)] {
            check::finite("position", pose.position).map_err(|error| error.at_path(s))?;
        }
        let (start, stop) = (rotation(from, 0.0)?, rotation(to, 1.0)?);
        let way = core::array::from_fn(|i| to.position[i] - from.position[i]);
        let turn = Vector3::from(difference(&stop, &start));
        if way == [0.0; 3] && start == stop {
            return Err(Failure::NoMotion.into());
        }
        Ok(Self { position: from.position, way, rotation: to_matrix(&start), turn })
    }

    /// The pose at `s`, on the line's continuation beyond 0 and 1.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose<f64> {
        let position = core::array::from_fn(|i| self.position[i] + s * self.way[i]);
        Pose { position, rotation: to_rows(&(to_matrix(&exp(&(self.turn * s).into())) * self.rotation)) }
    }

    /// `d/ds` of the position \[m\] and the angular velocity per `s` \[rad\], the same all along, in the axes of the
    /// base.
    #[must_use]
    pub fn twist(&self) -> [f64; 6] {
        let ([x, y, z], turn) = (self.way, self.turn);
        [x, y, z, turn.x, turn.y, turn.z]
    }
}

/// The joints of the arm while its flange follows a [`FlangeLine`], on one branch of the inverse kinematics; `K`
/// postures along it are kept, from which those between are found.
///
/// `q′ = J⁻¹ [p′; φ]` and `q″ = −J⁻¹ J′ q′`, where J′ is the generated Jacobian evaluated in dual numbers.
#[derive(Clone, Debug)]
pub struct CartesianPath<'a, const K: usize> {
    arm: &'a Arm,
    /// The same geometry, for derivatives.
    dual: Irb7600<Dual<f64>>,
    line: FlangeLine,
    branch: Branch,
    /// At equal distances; neighbours differ by less than `APART` in every joint.
    postures: [JointVector; K],
}

/// What is [missing](Failure::Missing) where a pose is reached on other branches, but not on the one asked for.
pub const ON_BRANCH: &str = "configuration on the branch";
/// What is too much where more postures must be kept along the line \[rad\].
pub const TURN: &str = "turn from one posture kept to the next of joint";

/// How far a posture may be from that at the start of the line \[m, rad\].
const START_TOLERANCE: f64 = 1e-6;
/// A step along the line turns no joint by more \[rad\].
const STEP: f64 = 0.1;
/// A step that is halved to this meets a jump.
const SHORTEST: f64 = 1e-10;
/// Two postures that are kept differ by less \[rad\], so that whole turns are told apart between them.
const APART: f64 = 2.0;

impl<'a, const K: usize> CartesianPath<'a, K> {
    /// Follows `line` from the posture `start`, which must be at its beginning.
    ///
    /// The branch is that of `start`, all along; steps are halved until no joint jumps. The ranges of the joints are
    /// those of
    /// [`Arm::limits`].
    ///
    /// # Errors
    /// [`Error`] with the place along the line: where it leaves the reach or the [branch](ON_BRANCH), where a joint
    /// comes to the end of its range, where the arm becomes singular, or so nearly that a joint turns by more than 0.1
    /// rad in 1e-10 of the line.
    pub fn new(arm: &'a Arm, line: FlangeLine, start: &JointVector) -> Result<Self, Error> {
        const { assert!(K > 1, "both ends of the line are kept") };
        check_start(arm, &line, start)?;
        let mut path = Self { arm, dual: Irb7600::default(), line, branch: branch_of(start), postures: [*start; K] };
        for k in 1..K {
            let [from, to] = [k - 1, k].map(|k| k as f64 / (K - 1) as f64);
            let q = path.follow(path.postures[k - 1], from, to)?;
            let apart: [f64; 6] = core::array::from_fn(|i| (q[i] - path.postures[k - 1][i]).abs());
            Must::BeLessThan(APART).check(TURN, apart).map_err(|error| error.at_path(to))?;
            path.postures[k] = q;
        }
        Ok(path)
    }

    /// The postures that are kept, at equal distances along the line, both ends included.
    #[must_use]
    pub const fn postures(&self) -> &[JointVector; K] {
        &self.postures
    }

    /// The line of the flange.
    #[must_use]
    pub const fn line(&self) -> &FlangeLine {
        &self.line
    }

    /// The branch of the inverse kinematics that the arm stays on.
    #[must_use]
    pub const fn branch(&self) -> Branch {
        self.branch
    }

    /// From the posture `q` at `s` to the one at `end`, by steps in which no joint jumps.
    fn follow(&self, mut q: JointVector, mut s: f64, end: f64) -> Result<JointVector, Error> {
        let mut step = end - s;
        while s < end {
            let next = if s + step >= end { end } else { s + step };
            match self.step(&q, next) {
                Ok(found) => (q, s, step) = (found, next, 2.0 * step),
                Err(error) if step <= SHORTEST => return Err(error),
                Err(_) => step *= 0.5,
            }
        }
        Ok(q)
    }

    /// The posture at `s` near `q`.
    fn step(&self, q: &JointVector, s: f64) -> Result<JointVector, Error> {
        let found = self.solve(q, s)?;
        if (0..6).any(|i| (found[i] - q[i]).abs() > STEP) {
            return Err(Failure::Degenerate(nearest_singularity(q).name()).at_path(s));
        }
        for joint in 0..6 {
            if !self.arm.limits.admits(joint, found[joint]) {
                let (angle, limits) = (found[joint], &self.arm.limits);
                let limit = if angle < limits.lower[joint] { limits.lower[joint] } else { limits.upper[joint] };
                return Err(out_of_range(joint, angle, limit).at_path(s));
            }
        }
        Ok(found)
    }

    /// The posture at `s` on the branch, by whole turns next to `near`.
    fn solve(&self, near: &JointVector, s: f64) -> Result<JointVector, Error> {
        let inverse = InverseKinematics { reference: *near, ..InverseKinematics::default() };
        let solutions = inverse.solve(&self.line.pose(s)).map_err(|error| error.or_at_path(s))?;
        match solutions.of_branch(self.branch) {
            Some(Solution { q, singular, .. }) if !singular.any() => {
                Ok(core::array::from_fn(|i| q[i] + TAU * turns(near[i] - q[i])))
            }
            // One shoulder alone reaches the pose where it is not this one.
            None if !solutions.iter().any(|solution| solution.singular.any()) => {
                Err(Failure::Missing(ON_BRANCH).at_path(s))
            }
            _ => Err(Failure::Degenerate(nearest_singularity(near).name()).at_path(s)),
        }
    }

    /// Between the postures that are kept.
    fn interpolated(&self, s: f64) -> JointVector {
        let place = s * (K - 1) as f64;
        // At least 0, at most the last interval.
        let k = (place as usize).min(K - 2);
        let part = place - k as f64;
        core::array::from_fn(|i| (1.0 - part) * self.postures[k][i] + part * self.postures[k + 1][i])
    }
}

impl<const K: usize> JointPath<6> for CartesianPath<'_, K> {
    fn length(&self) -> f64 {
        1.0
    }

    fn point(&self, s: f64) -> Result<PathPoint<6>, Error> {
        check::within("path parameter", s, [0.0, 1.0])?;
        let singular = Failure::Degenerate("path").at_path(s);
        let q = self.solve(&self.interpolated(s), s).map_err(|_| singular)?;
        let tangent = self.arm.joint_velocity(&q, &self.line.twist()).map_err(|_| singular)?;
        let moving: [Dual<f64>; 6] = core::array::from_fn(|i| Dual { value: q[i], derivative: tangent[i] });
        let jacobian = self.dual.flange_jacobian(&moving);
        let missing = jacobian.map(|row| -row.iter().zip(&tangent).map(|(j, qd)| j.derivative * qd).sum::<f64>());
        let curvature = self.arm.joint_velocity(&q, &missing).map_err(|_| singular)?;
        Ok(PathPoint { q, tangent, curvature })
    }
}

fn out_of_range(index: usize, value: f64, limit: f64) -> Failure {
    Failure::LimitExceeded { quantity: POSITION, unit: "rad", index, value, limit }
}

fn check_start(arm: &Arm, line: &FlangeLine, start: &JointVector) -> Result<(), Error> {
    let (found, expected) = (arm.pose(start), line.pose(0.0));
    let apart: [f64; 3] = core::array::from_fn(|i| found.position[i] - expected.position[i]);
    let distance = Vector3::from(apart).norm();
    let angle = Vector3::from(difference(&found.rotation, &expected.rotation)).norm();
    Must::BeAtMost(START_TOLERANCE).check("distance from the beginning of the line", distance)?;
    Must::BeAtMost(START_TOLERANCE).check("turn from the beginning of the line", angle)?;
    match arm.limits.violation(start) {
        Some(joint) => {
            let angle = start[joint];
            let limit = if angle < arm.limits.lower[joint] { arm.limits.lower[joint] } else { arm.limits.upper[joint] };
            Err(out_of_range(joint, angle, limit).at_path(0.0))
        }
        None => Ok(()),
    }
}

/// The branch that a posture is on; where branches meet, the positive one.
#[must_use]
pub fn branch_of(q: &JointVector) -> Branch {
    use crate::inverse::{Elbow, Shoulder, Wrist};
    let factors = determinant_factors(q);
    Branch {
        shoulder: if factors.shoulder >= 0.0 { Shoulder::Front } else { Shoulder::Back },
        elbow: if factors.elbow >= 0.0 { Elbow::Positive } else { Elbow::Negative },
        wrist: if factors.wrist >= 0.0 { Wrist::Positive } else { Wrist::Negative },
    }
}

/// The singularity that a posture is nearest to, each factor of the determinant measured by its largest value.
#[must_use]
pub fn nearest_singularity(q: &JointVector) -> Singularity {
    let factors = determinant_factors(q);
    let candidates = [
        (Singularity::Shoulder, factors.shoulder / (A1 + A2 + L1)),
        (Singularity::Elbow, factors.elbow / L1),
        (Singularity::Wrist, factors.wrist),
    ];
    candidates.into_iter().fold(candidates[0], |best, next| if next.1.abs() < best.1.abs() { next } else { best }).0
}

/// The whole turns next to an angle.
fn turns(angle: f64) -> f64 {
    let turns = angle / TAU;
    let half = if turns < 0.0 { -0.5 } else { 0.5 };
    // Angles of joints are a few turns at most; `as` saturates.
    (turns + half) as i64 as f64
}

/// Where branches of the inverse kinematics meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Singularity {
    /// The wrist is on axis 1.
    Shoulder,
    /// The arm is stretched or folded.
    Elbow,
    /// Axes 4 and 6 are in line.
    Wrist,
}

impl Singularity {
    /// What is [degenerate](Failure::Degenerate) then.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shoulder => "shoulder",
            Self::Elbow => "elbow",
            Self::Wrist => "wrist",
        }
    }
}

impl fmt::Display for Singularity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
