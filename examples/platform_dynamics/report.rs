//! The JSON: the tables at t = 0, 0.5, …, 4 s, the equations of motion at one moment, and the eight cases.

use mbs_examples::Failure;
use mbs_examples::platform_dynamics::tables::{Run, Samples, TABLE_4, table_3, table_4};
use mbs_platform::{Motion, Platform};
use serde_json::{Value, json};

use crate::{MOMENT, Results, along, cases, direct};

pub(crate) fn to_json(platform: &Platform, results: &Results) -> Result<Value, Failure> {
    let samples = Samples::coarse();
    let table_3 = table_3(platform, &samples)?;
    let forces = |run: &Run| json!({"with_actuators": run.forces, "without_actuators": run.forces_without_actuators});
    let by_payload: Value = table_3.iter().map(|run| (format!("payload_{}", run.payload), forces(run))).collect();
    let mut by_angles = json!({});
    for (name, angles) in TABLE_4 {
        let run = table_4(platform, angles, &samples)?;
        by_angles[name] = json!({
            "lengths": run.lengths,
            "with_actuators": run.forces,
            "without_actuators": run.forces_without_actuators,
        });
    }
    let found = direct(platform)?;
    let [q, qd, _] = Motion::COMBINED.at(MOMENT);
    let mut report = json!({
        "table3": {"lengths": table_3[0].lengths, "forces": by_payload},
        "table4": by_angles,
        "direct_kinematics": {"pose": found.pose, "iterations": found.iterations, "residual": found.residual},
        "mass_matrix": platform.model().mass_matrix(&q),
        "coriolis_matrix": platform.model().coriolis_matrix(&q, &qd),
        "gravity": platform.model().gravity(&q),
        "cases": cases::to_json(&results.cases),
        "sensitivity": along::to_json(&results.tables),
    });
    if let Some((pair, courses)) = &results.pair {
        report["sensitivity_of"] = along::pair_to_json(courses, *pair);
    }
    Ok(report)
}
