//! The ABB IRB 7600-500/2.55 as chapter 3 of the thesis treats it: what surrounds the generated dynamics of
//! [`irb7600`](mbs_models::irb7600).
//!
//! | thesis            | here                                                                                          |
//! |-------------------|-----------------------------------------------------------------------------------------------|
//! | (3.1)–(3.4)       | [`Arm::pose`]: direct kinematics                                                              |
//! | (3.5)–(3.12)      | [`inverse`]: all configurations of a pose, in closed form; [`printed`]: the formulas as printed |
//! | (3.13)–(3.16)     | [`jacobian`]: of the flange and of the mass centres; singularities, velocities, forces        |
//! | (3.17)–(3.19)     | [`irb7600`](mbs_models::irb7600), generated; [`control`] by it; [`limits`] of the drives           |
//! | 8.3               | [`elastic`]: joints and gears that give way; [`assistive`]: an arm that carries a person's     |
//! | 3.5, 3.6, table 2 | [`trajectory`]: motions from one posture to another, and along paths                              |
//! | 8.3               | [`assembly`]: a SCARA that puts a peg into a hole                                             |
//! | 8.3               | [`inertial`]: the numbers that forces are linear in; [`adaptive`]: control that learns them   |
//!
//! Angles are those of Denavit and Hartenberg \[rad\], as in the thesis' tables: the second is the robot's own angle
//! minus 90°. Positions are in m, axes those of the base, z up.
//!
//! ```
//! use mbs_arm::Arm;
//!
//! let arm = Arm::default();
//! let q = [45.0, 30.0, 30.0, -45.0, 30.0, 0.0].map(f64::to_radians); // table 1 of the thesis
//! let pose = arm.pose(&q);
//! let solutions = arm.inverse(&pose).unwrap();
//! assert_eq!(solutions.len(), 8);
//! for solution in &solutions {
//!     let found = arm.pose(&solution.q);
//!     assert!((0..3).all(|i| (found.position[i] - pose.position[i]).abs() < 1e-12));
//! }
//! ```
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 3.
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod adaptive;
pub mod assembly;
pub mod assistive;
pub mod control;
pub mod elastic;
pub mod inertial;
pub mod inverse;
pub mod jacobian;
pub mod limits;
pub mod printed;
pub mod trajectory;

use mbs_models::Error;
use mbs_runtime::Pose;

pub use inverse::{InverseKinematics, Solution, Solutions};
pub use limits::JointLimits;
use mbs_models::irb7600::Irb7600;

/// Six numbers, one a joint: angles \[rad\], their rates \[rad/s\] and accelerations \[rad/s²\], or torques \[N·m\].
pub type JointVector = [f64; 6];

/// Where axis 2 stands off axis 1: `a₁` \[m\].
pub const A1: f64 = 0.41;
/// Length of the upper arm, from axis 2 to axis 3: `a₂` \[m\].
pub const A2: f64 = 1.075;
/// Offset of the forearm from axis 3: `a₃` \[m\].
pub const A3: f64 = 0.165;
/// Height of axis 2 above the base: `d₁` \[m\].
pub const D1: f64 = 0.78;
/// Length of the forearm, up to the wrist: `d₄` \[m\].
pub const D4: f64 = 1.056;
/// From the wrist to the flange: `d₆` \[m\].
pub const D6: f64 = 0.25;

/// The arm: its generated dynamics, and what its drives allow.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Equations of motion, energies and outputs.
    pub model: Irb7600<f64>,
    /// Ranges of the joints, their speeds, accelerations and torques.
    pub limits: JointLimits,
}

impl Default for Arm {
    /// With the declared masses and inertias, and [`JointLimits::IRB7600`].
    fn default() -> Self {
        Self { model: Irb7600::default(), limits: JointLimits::IRB7600 }
    }
}

impl Arm {
    /// Position \[m\] and attitude of the flange, in the axes of the base.
    ///
    /// # Source
    /// Thesis, equations (3.1)–(3.4), with the constants of table 1.
    #[must_use]
    #[inline]
    pub fn pose(&self, q: &JointVector) -> Pose<f64> {
        self.model.flange(q)
    }

    /// All configurations that reach a pose of the flange: [`InverseKinematics::solve`] with its default options.
    ///
    /// # Errors
    /// [`Error`] where the pose is none, or out of reach.
    #[inline]
    pub fn inverse(&self, pose: &Pose<f64>) -> Result<Solutions, Error> {
        InverseKinematics::default().solve(pose)
    }
}
