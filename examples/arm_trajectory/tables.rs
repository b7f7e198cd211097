//! Every curve as numbers, and the fastest motion along the same way.

use std::path::Path;

use mbs_arm::Arm;
use mbs_examples::{Failure, output::write_table};

use mbs_examples::arm_trajectory::cases::{self, Case, Sample};

pub(crate) fn write(folder: &Path, arm: &Arm, case: &Case) -> Result<(), Failure> {
    for run in &case.runs {
        write_table(folder, &format!("{}_{}", case.name, run.method), COLUMNS, run.samples.iter().map(row))?;
    }
    if case.number == 1 {
        let samples = cases::samples(arm, &cases::fastest(arm)?)?;
        write_table(folder, "fastest", COLUMNS, samples.iter().map(row))?;
    }
    Ok(())
}

const COLUMNS: &str = "t_s q[1-6]_deg qd[1-6]_deg_s qdd[1-6]_deg_s2 torque[1-6]_Nm x_m y_m z_m det_jacobian_m3 power_W";

fn row(sample: &Sample) -> Vec<f64> {
    let [q, qd, qdd] = [sample.state.q, sample.state.qd, sample.state.qdd].map(|values| values.map(f64::to_degrees));
    let rest = [sample.determinant, sample.power()];
    [&[sample.t][..], &q, &qd, &qdd, &sample.torque, &sample.position, &rest].concat()
}
