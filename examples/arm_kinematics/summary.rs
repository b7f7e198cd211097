//! What the posture comes to, as JSON and as text.

use mbs_arm::inverse::Solution;
use serde_json::{Value, json};

use crate::{ACCELERATION, Report, TABLE_1, VELOCITY};

pub(crate) fn to_json(report: &Report) -> Value {
    json!({
        "fk_position": report.pose.position,
        "fk_rotation": report.pose.rotation,
        "jacobian": report.jacobian,
        "jacobian_det": report.determinant,
        "singular_values": report.singular_values,
        "ik": report.solutions.iter().map(|(solution, _)| solution.q.map(f64::to_degrees)).collect::<Vec<_>>(),
        "ik_from_printed": report.from_printed,
        "mass_matrix": report.mass_matrix,
        "gravity": report.gravity,
        "coriolis": report.coriolis,
        "torque": report.torque,
    })
}

pub(crate) fn text(report: &Report) -> String {
    let mut text = format!(
        "The IRB 7600 with joint angles ({})°, Table 1 of the thesis\n\n\
         Flange: position {} m, rotation\n",
        TABLE_1.map(|q| q.to_string()).join(", "),
        row(&report.pose.position, 7)
    );
    text += &rows(&report.pose.rotation, 7);
    text += "\nJacobian: velocity and angular velocity per joint velocity [m, 1]\n";
    text += &rows(&report.jacobian, 6);
    text += &format!(
        "  determinant {:.10} m³, singular values {}\n\nConfigurations that reach the pose [°]\n",
        report.determinant,
        row(&report.singular_values, 4)
    );
    for (Solution { q, branch, .. }, distance) in &report.solutions {
        let name = format!("{:?}, {:?}, {:?}", branch.shoulder, branch.elbow, branch.wrist);
        text += &format!("  {} {name:26} off by {distance:.0e}\n", row(&q.map(f64::to_degrees), 4));
    }
    text += &format!(
        "\nFrom the printed pose (3.20), (3.21) [°]\n  {} by the printed formulas (3.7)–(3.12)\n  \
         {} in closed form, its rotation orthonormalized\n",
        row(&report.from_printed, 4),
        row(&report.from_orthonormalized, 4)
    );
    text += "\nMass matrix [kg·m²]\n";
    text += &rows(&report.mass_matrix, 4);
    text += &format!(
        "\nGravity, Coriolis forces and torques [N·m]\n  moving with {} rad/s, {} rad/s²\n",
        row(&VELOCITY, 1),
        row(&ACCELERATION, 1)
    );
    for (name, forces) in [("G", &report.gravity), ("C q̇", &report.coriolis), ("τ", &report.torque)] {
        text += &format!("  {} {name}\n", row(forces, 5));
    }
    text
}

fn rows<const N: usize>(matrix: &[[f64; N]], decimals: usize) -> String {
    matrix.iter().map(|entries| format!("  {}\n", row(entries, decimals))).collect()
}

fn row(numbers: &[f64], decimals: usize) -> String {
    // Rounding is no sign.
    let text = |x: &f64| {
        format!("{:>1$.decimals$}", if x.abs() < 0.5 * 0.1_f64.powi(decimals as i32) { 0.0 } else { *x }, decimals + 6)
    };
    numbers.iter().map(text).collect::<Vec<_>>().join(" ")
}
