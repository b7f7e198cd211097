//! Where is the flange of the IRB 7600 in the posture of the thesis' Table 1, how else can the arm reach it, and what
//! does it take to move it there?
//!
//! Look at the eight configurations: all reach the pose to rounding, and the thesis has one of them, by formulas that
//! are given the pose in four digits. It prints 45, 29.9977, 29.9993, −44.9962, 30.0036, −0.0052: what its formulas
//! make of that input.

use mbs_arm::inverse::Solution;
use mbs_arm::jacobian::{self, Jacobian};
use mbs_arm::{Arm, JointLimits, JointVector, printed};
use mbs_examples::{Failure, arguments::Arguments, assumed};
use mbs_examples::{print, println};
use mbs_runtime::Pose;
use serde_json::{Value, json};

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
    let arguments = Arguments::of(include_str!("arm_kinematics.rs"));
    let report = Report::new(&Arm::default())?;
    if let Some(folder) = arguments.folder()? {
        std::fs::write(
            folder.join("arm_kinematics.json"),
            format!("{:#}\n", assumed::with(report.to_json(), &ASSUMED)),
        )?;
    }
    if arguments.json {
        println!("{}", assumed::with(report.to_json(), &ASSUMED));
    } else {
        report.print();
        print!("{}", assumed::text(&ASSUMED));
    }
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
        let solutions = solutions.iter().map(|solution| (*solution, distance(&arm.pose(&solution.q), &pose))).collect();
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

    fn to_json(&self) -> Value {
        json!({
            "fk_position": self.pose.position,
            "fk_rotation": self.pose.rotation,
            "jacobian": self.jacobian,
            "jacobian_det": self.determinant,
            "singular_values": self.singular_values,
            "ik": self.solutions.iter().map(|(solution, _)| solution.q.map(f64::to_degrees)).collect::<Vec<_>>(),
            "ik_from_printed": self.from_printed,
            "mass_matrix": self.mass_matrix,
            "gravity": self.gravity,
            "coriolis": self.coriolis,
            "torque": self.torque,
        })
    }

    fn print(&self) {
        println!(
            "The IRB 7600 with joint angles ({})°, Table 1 of the thesis\n",
            TABLE_1.map(|q| q.to_string()).join(", ")
        );
        println!("Flange: position {} m, rotation", row(&self.pose.position, 7));
        self.pose.rotation.iter().for_each(|entries| println!("  {}", row(entries, 7)));
        println!("\nJacobian: velocity and angular velocity per joint velocity [m, 1]");
        self.jacobian.iter().for_each(|entries| println!("  {}", row(entries, 6)));
        println!("  determinant {:.10} m³, singular values {}", self.determinant, row(&self.singular_values, 4));
        println!("\nConfigurations that reach the pose [°]");
        for (Solution { q, branch, .. }, distance) in &self.solutions {
            let name = format!("{:?}, {:?}, {:?}", branch.shoulder, branch.elbow, branch.wrist);
            println!("  {} {name:26} off by {distance:.0e}", row(&q.map(f64::to_degrees), 4));
        }
        println!("\nFrom the printed pose (3.20), (3.21) [°]");
        println!("  {} by the printed formulas (3.7)–(3.12)", row(&self.from_printed, 4));
        println!("  {} in closed form, its rotation orthonormalized", row(&self.from_orthonormalized, 4));
        println!("\nMass matrix [kg·m²]");
        self.mass_matrix.iter().for_each(|entries| println!("  {}", row(entries, 4)));
        println!("\nGravity, Coriolis forces and torques [N·m]");
        println!("  moving with {} rad/s, {} rad/s²", row(&VELOCITY, 1), row(&ACCELERATION, 1));
        for (name, forces) in [("G", &self.gravity), ("C q̇", &self.coriolis), ("τ", &self.torque)] {
            println!("  {} {name}", row(forces, 5));
        }
    }
}

fn row(numbers: &[f64], decimals: usize) -> String {
    // Rounding is no sign.
    let text = |x: &f64| {
        format!("{:>1$.decimals$}", if x.abs() < 0.5 * 0.1_f64.powi(decimals as i32) { 0.0 } else { *x }, decimals + 6)
    };
    numbers.iter().map(text).collect::<Vec<_>>().join(" ")
}

/// The largest difference of two poses, positions and entries of the rotation alike.
fn distance(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    let entries = |pose: &Pose<f64>| [pose.position.to_vec(), pose.rotation.concat()].concat();
    entries(a).iter().zip(entries(b)).fold(0.0, |largest, (a, b)| f64::max(largest, (a - b).abs()))
}

/// The posture of Table 1 is out of the ranges of the real axes.
fn unlimited() -> JointLimits {
    JointLimits { lower: [-std::f64::consts::TAU; 6], upper: [std::f64::consts::TAU; 6], ..JointLimits::IRB7600 }
}
