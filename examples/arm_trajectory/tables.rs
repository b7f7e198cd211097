//! Every curve as numbers, and the fastest motion along the same way.

use std::path::Path;

use mbs_arm::Arm;
use mbs_examples::{Failure, output::write_table};

use mbs_examples::arm_trajectory::cases::{self, Case, Sample};

pub(crate) fn write(folder: &Path, arm: &Arm, case: &Case) -> Result<(), Failure> {
    for run in &case.runs {
        write_table(folder, &format!("{}_{}", case.name, run.method), &header(), run.samples.iter().map(row))?;
    }
    if case.number == 1 {
        let samples = cases::samples(arm, &cases::fastest(arm)?)?;
        write_table(folder, "fastest", &header(), samples.iter().map(row))?;
    }
    Ok(())
}

fn header() -> Vec<String> {
    let joints = |name: &str, unit: &str| (1..=6).map(|i| format!("{name}{i}_{unit}")).collect::<Vec<_>>();
    let mut header = vec!["t_s".to_string()];
    header.extend(joints("q", "deg"));
    header.extend(joints("qd", "deg_s"));
    header.extend(joints("qdd", "deg_s2"));
    header.extend(joints("torque", "Nm"));
    header.extend(["x_m", "y_m", "z_m", "det_jacobian_m3", "power_W"].map(String::from));
    header
}

fn row(sample: &Sample) -> Vec<f64> {
    let [q, qd, qdd] = [sample.state.q, sample.state.qd, sample.state.qdd].map(|values| values.map(f64::to_degrees));
    let rest = [sample.determinant, sample.power()];
    [&[sample.t][..], &q, &qd, &qdd, &sample.torque, &sample.position, &rest].concat()
}
