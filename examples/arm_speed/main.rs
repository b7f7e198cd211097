//! What does the kinematics of an arm cost, counted in sines?
//!
//! Inverse kinematics in closed form with all eight branches, pose and Jacobian of the flange, against one `sin_cos` of
//! the standard library and against the same written plainly with nalgebra. All contenders agree before anything is
//! timed; times are medians of rounds in which everyone has a turn, in one process. Look at the column `sin_cos`: 60
//! and 15 are the bounds that the two are held to.

mod agreement;
mod plain;

use std::f64::consts::PI;

use mbs_arm::{Arm, InverseKinematics, jacobian};
use mbs_examples::contest::{Contender, medians, tenths};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_runtime::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::{Map, Value, json};

/// Configurations that are gone through in a round.
const STATES: usize = 1024;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 201;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));

    let arm = Arm::default();
    let configurations = configurations(&arm);
    let poses: Vec<Pose<f64>> = configurations.iter().map(|q| arm.pose(q)).collect();
    agreement::check(&arm, &configurations, &poses)?;

    let angles: Vec<f64> = configurations.iter().map(|q| q[0]).collect();
    let solver = InverseKinematics::default();
    let contenders = vec![
        Contender::new("sin_cos", &angles, |angle| angle.sin_cos()),
        Contender::new("inverse", &poses, |pose| solver.solve(pose)),
        Contender::new("inverse_nalgebra", &poses, plain::inverse),
        Contender::new("pose_and_jacobian", &configurations, |q| arm.pose_and_jacobian(q)),
        Contender::new("pose_and_jacobian_generated", &configurations, |q| (arm.pose(q), arm.jacobian(q))),
        Contender::new("pose_and_jacobian_nalgebra", &configurations, plain::pose_and_jacobian),
    ];
    let report = report(&medians(contenders, ROUNDS));
    if let Some(folder) = arguments.folder()? {
        output::write_json(folder, "arm_speed", &report)?;
    }
    let table = table(&report);
    arguments.answer(report, &table, &[]);
    Ok(())
}

/// Configurations whose poses have eight, away from singularities by 0.05; the same in every run.
fn configurations(arm: &Arm) -> Vec<[f64; 6]> {
    let mut random = Pcg64::seed_from_u64(1);
    let regular = |q: &[f64; 6]| {
        let factors = jacobian::determinant_factors(q);
        [factors.shoulder, factors.elbow, factors.wrist].iter().all(|factor| factor.abs() > 0.05)
    };
    std::iter::repeat_with(|| std::array::from_fn(|_| random.random_range(-PI..PI)))
        .filter(|q| regular(q) && arm.inverse(&arm.pose(q)).is_ok_and(|solutions| solutions.len() == 8))
        .take(STATES)
        .collect()
}

/// In ns a call, and in calls of `sin_cos`, which is the first contender.
fn report(medians: &[(&str, f64)]) -> Value {
    let entry = |(name, seconds): &(&str, f64)| {
        let ns = seconds * 1e9 / STATES as f64;
        (name.to_string(), json!({ "ns": tenths(ns), "sin_cos": tenths(seconds / medians[0].1) }))
    };
    Value::Object(medians.iter().map(entry).collect::<Map<_, _>>())
}

fn table(report: &Value) -> String {
    let mut text = format!("{:30} {:>9} {:>9}\n", "", "ns", "sin_cos");
    for (name, times) in report.as_object().into_iter().flatten() {
        let number = |key: &str| times[key].as_f64().unwrap_or(f64::NAN);
        text += &format!("{name:30} {:9.1} {:9.1}\n", number("ns"), number("sin_cos"));
    }
    text
}
