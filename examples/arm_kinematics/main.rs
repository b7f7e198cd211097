//! Where is the flange of the IRB 7600 in the posture of the thesis' Table 1, how else can the arm reach it, and what
//! does it take to move it there?
//!
//! Look at the eight configurations: all reach the pose to rounding, and the thesis has one of them, by formulas that
//! are given the pose in four digits. It prints 45, 29.9977, 29.9993, −44.9962, 30.0036, −0.0052: what its formulas
//! make of that input.

mod summary;

use mbs_arm::inverse::Solution;
use mbs_arm::jacobian::{self, Jacobian};
use mbs_arm::{Arm, JointLimits, JointVector, printed};
use mbs_examples::numbers::poses_apart;
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_runtime::Pose;

/// Table 1 of the thesis \[°\].
const TABLE_1: JointVector = [45.0, 30.0, 30.0, -45.0, 30.0, 0.0];
/// A state of motion in that posture \[rad/s\], and accelerations \[rad/s²\].
const VELOCITY: JointVector = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7];
const ACCELERATION: JointVector = [0.1, 0.2, -0.3, 0.4, -0.5, 0.6];
/// (3.20) and (3.21): the pose of Table 1 as printed.
const PRINTED: Pose<f64> = Pose {
    position: [0.2586, 0.1336, -0.4601],
    rotation: [[-0.5227, 0.75, -0.4053], [0.3433, -0.25, -0.9053], [-0.7803, -0.6124, -0.1268]],
};

/// What the dynamics rest on; the kinematics rest on Table 1 alone.
const ASSUMED: [&str; 4] = ["gravity", "arm.masses", "arm.mass_centres", "arm.inertias"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let report = Report::new(&Arm::default())?;
    let results = summary::to_json(&report);
    if let Some(folder) = arguments.folder()? {
        let text = format!("{:#}\n", assumed::with(results.clone(), &ASSUMED));
        output::write_file(&folder.join("arm_kinematics.json"), text.as_bytes())?;
    }
    arguments.answer(results, &summary::text(&report), &ASSUMED);
    Ok(())
}

/// Kinematics and dynamics in the posture of Table 1.
struct Report {
    pose: Pose<f64>,
    jacobian: Jacobian,
    determinant: f64,
    singular_values: JointVector,
    /// All configurations, and the distance of their flange from the pose, positions and entries of the rotation alike.
    solutions: Vec<(Solution, f64)>,
    /// By the printed formulas from the printed pose \[°\].
    from_printed: JointVector,
    /// In closed form from the printed pose, its rotation orthonormalized, nearest to Table 1 \[°\].
    from_orthonormalized: JointVector,
    mass_matrix: [[f64; 6]; 6],
    gravity: JointVector,
    /// `C q̇`
    coriolis: JointVector,
    torque: JointVector,
}

impl Report {
    fn new(arm: &Arm) -> Result<Self, Failure> {
        let q = TABLE_1.map(f64::to_radians);
        let (pose, rows) = (arm.pose(&q), arm.jacobian(&q));
        let solutions = arm.inverse(&pose)?;
        let solutions =
            solutions.iter().map(|solution| (*solution, poses_apart(&arm.pose(&solution.q), &pose))).collect();
        let nearest = arm
            .inverse(&PRINTED)?
            .nearest(&unlimited(), &q)
            .ok_or_else(|| Failure::new("the printed pose is out of reach"))?;
        let coriolis_matrix = arm.model.coriolis_matrix(&q, &VELOCITY);
        Ok(Self {
            pose,
            jacobian: rows,
            determinant: jacobian::determinant(&q),
            singular_values: jacobian::singular_values(&rows),
            solutions,
            from_printed: printed::inverse_kinematics(&PRINTED).map(f64::to_degrees),
            from_orthonormalized: nearest.q.map(f64::to_degrees),
            mass_matrix: arm.model.mass_matrix(&q),
            gravity: arm.model.gravity(&q),
            coriolis: coriolis_matrix.map(|row| row.iter().zip(VELOCITY).map(|(c, qd)| c * qd).sum()),
            torque: arm.model.inverse_dynamics(&q, &VELOCITY, &ACCELERATION),
        })
    }
}

/// The posture of Table 1 is out of the ranges of the real axes.
fn unlimited() -> JointLimits {
    JointLimits { lower: [-std::f64::consts::TAU; 6], upper: [std::f64::consts::TAU; 6], ..JointLimits::IRB7600 }
}
