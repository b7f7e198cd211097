//! What does the IRB 7600 do on its way from the start to the stop of the thesis' Table 2, in 50 s?
//!
//! Case 1 starts from rest, case 2 with 1.5 °/s in every joint. Each is done by one quartic per joint, which cannot end
//! without acceleration, by two quartics that meet half-way, and by a quintic. Look at the accelerations at the end
//! (figures 3.10 and 3.11), at the flange below the base (3.4), at the time at which the arm is stretched or folded,
//! and at the energies: the thesis says that case 2 needs more.
//!
//! `--out DIR` writes figures 3.4 to 3.11 and the torques as SVG and PNG, every curve as CSV, and the joint angles as
//! RAPID modules for the robot's controller or its simulator: `case1.mod` and `case2.mod` as printed, which leave the
//! ranges of axes 2 and 3, and `case1_in_range.mod` and `case2_in_range.mod`, a variant that keeps them.

mod rapid;
mod summary;
mod tables;

use mbs_arm::Arm;
use mbs_examples::arm_trajectory::cases::{self, Case, Run};
use mbs_examples::arm_trajectory::figures;
use mbs_examples::{Failure, arguments::Arguments, output};
use serde_json::{Value, json};

/// What torques, work and limits rest on.
const ASSUMED: [&str; 2] = ["gravity", "arm."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let arm = Arm::default();
    let cases = cases::both(&arm)?;
    if let Some(folder) = arguments.folder()? {
        for case in &cases {
            figures::write(folder, &arm, case)?;
            tables::write(folder, &arm, case)?;
            for (name, text) in rapid::modules(&arm, case)? {
                output::write_file(&folder.join(name), text.as_bytes())?;
            }
        }
    }
    arguments.answer(
        cases.iter().map(|case| (case.name.to_string(), to_json(case))).collect::<Value>(),
        &summary::of(&arm, &cases)?,
        &ASSUMED,
    );
    Ok(())
}

fn to_json(case: &Case) -> Value {
    case.runs.iter().map(|run| (run.method.to_string(), run_to_json(run))).collect()
}

/// Rows by time, every five seconds; degrees, N·m and J.
fn run_to_json(run: &Run) -> Value {
    let rows = |of: &dyn Fn(&cases::Sample) -> [f64; 6]| {
        run.samples.iter().step_by(run.samples.len() / 10).map(of).collect::<Vec<_>>()
    };
    json!({
        "t": run.samples.iter().step_by(run.samples.len() / 10).map(|sample| sample.t).collect::<Vec<_>>(),
        "q_deg": rows(&|sample| sample.state.q.map(f64::to_degrees)),
        "qd_deg": rows(&|sample| sample.state.qd.map(f64::to_degrees)),
        "qdd_deg": rows(&|sample| sample.state.qdd.map(f64::to_degrees)),
        "torque": rows(&|sample| sample.torque),
        "peak_speed_deg": run.peak_speed.map(f64::to_degrees),
        "energy_joule": run.energy.value,
        "singularities": run.singularities.iter().map(|(time, _)| *time).collect::<Vec<_>>(),
    })
}
