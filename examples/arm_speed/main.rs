//! What does the kinematics of an arm cost, counted in sines?
//!
//! Inverse kinematics in closed form with all eight branches, pose and Jacobian of the flange, against one `sin_cos` of
//! the standard library and against the same written plainly with nalgebra. All contenders agree before anything is
//! timed; times are medians of rounds in which everyone has a turn, in one process. Look at the column `sin_cos`: 60
//! and 15 are the bounds that the two are held to.

mod plain;

use std::hint::black_box;
use std::time::Instant;

use mbs_arm::{Arm, InverseKinematics};
use mbs_examples::{Failure, arguments::Arguments};
use mbs_runtime::Pose;
use serde_json::{Map, Value, json};

/// Configurations that are gone through in a round.
const STATES: usize = 1024;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 201;

/// One function of one contender, and the seconds that a round of it takes.
struct Contender {
    name: &'static str,
    round: Box<dyn FnMut() -> f64>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));

    let arm = Arm::default();
    let configurations = configurations(&arm);
    let poses: Vec<Pose<f64>> = configurations.iter().map(|q| arm.pose(q)).collect();
    agree(&arm, &configurations, &poses)?;

    let angles: Vec<f64> = configurations.iter().map(|q| q[0]).collect();
    let solver = InverseKinematics::default();
    let model = arm.clone();
    let both = arm.clone();
    let mut contenders = vec![
        contender("sin_cos", angles, |angle| angle.sin_cos()),
        contender("inverse", poses.clone(), move |pose| solver.solve(pose)),
        contender("inverse_nalgebra", poses, plain::inverse),
        contender("pose_and_jacobian", configurations.clone(), move |q| both.pose_and_jacobian(q)),
        contender("pose_and_jacobian_generated", configurations.clone(), move |q| (model.pose(q), model.jacobian(q))),
        contender("pose_and_jacobian_nalgebra", configurations, plain::pose_and_jacobian),
    ];
    let report = timed(&mut contenders);
    if let Some(folder) = arguments.folder()? {
        std::fs::write(folder.join("arm_speed.json"), format!("{report}\n"))?;
    }
    let table = table(&report);
    arguments.answer(report, &table, &[]);
    Ok(())
}

/// The loop over the arguments is compiled with the function in it, so that nothing but the function is timed.
fn contender<A: 'static, R>(
    name: &'static str,
    arguments: Vec<A>,
    mut call: impl FnMut(&A) -> R + 'static,
) -> Contender {
    let round = move || {
        let start = Instant::now();
        for argument in &arguments {
            black_box(call(black_box(argument)));
        }
        start.elapsed().as_secs_f64()
    };
    Contender { name, round: Box::new(round) }
}

/// Medians in ns a call, and in calls of `sin_cos`, which is the first contender.
fn timed(contenders: &mut [Contender]) -> Value {
    let mut seconds = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for _ in 0..ROUNDS {
        for (contender, seconds) in contenders.iter_mut().zip(&mut seconds) {
            seconds.push((contender.round)());
        }
    }
    let median = |seconds: &mut Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        seconds[ROUNDS / 2] * 1e9 / STATES as f64
    };
    let medians: Vec<f64> = seconds.iter_mut().map(median).collect();
    let tenths = |x: f64| (x * 10.0).round() / 10.0;
    let entry = |(contender, ns): (&Contender, &f64)| {
        (contender.name.to_string(), json!({ "ns": tenths(*ns), "sin_cos": tenths(ns / medians[0]) }))
    };
    Value::Object(contenders.iter().zip(&medians).map(entry).collect::<Map<_, _>>())
}

fn table(report: &Value) -> String {
    let mut text = format!("{:30} {:>9} {:>9}\n", "", "ns", "sin_cos");
    for (name, times) in report.as_object().into_iter().flatten() {
        let number = |key: &str| times[key].as_f64().unwrap_or(f64::NAN);
        text += &format!("{name:30} {:9.1} {:9.1}\n", number("ns"), number("sin_cos"));
    }
    text
}

/// Everybody computes the same, to 1e-9.
fn agree(arm: &Arm, configurations: &[[f64; 6]], poses: &[Pose<f64>]) -> Result<(), Failure> {
    for (q, pose) in configurations.iter().zip(poses) {
        let (by_hand, jacobian) = arm.pose_and_jacobian(q);
        let (plain, plain_jacobian) = plain::pose_and_jacobian(q);
        let generated = arm.jacobian(q);
        let mut difference = apart(&by_hand, pose);
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            difference = difference.max((jacobian[i][j] - generated[i][j]).abs());
            difference = difference.max((plain_jacobian[(i, j)] - generated[i][j]).abs());
        }
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            difference = difference.max((plain[(i, j)] - pose.rotation[i][j]).abs());
            difference = difference.max((plain[(i, 3)] - pose.position[i]).abs());
        }
        let found = arm.inverse(pose)?;
        let rival = plain::inverse(pose);
        if found.len() != rival.len() {
            return Err(Failure::new(format!("{} against {} configurations at {q:?}", found.len(), rival.len())));
        }
        for (solution, rival) in found.iter().zip(&rival) {
            difference = difference.max(apart(&arm.pose(&solution.q), pose));
            for (a, b) in solution.q.iter().zip(rival) {
                difference = difference.max((0.5 * (a - b)).sin().abs());
            }
        }
        if difference.is_nan() || difference > 1e-9 {
            return Err(Failure::new(format!("off by {difference:e} at {q:?}")));
        }
    }
    Ok(())
}

/// The largest difference of two poses.
fn apart(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    let rows = |pose: &Pose<f64>| [pose.position, pose.rotation[0], pose.rotation[1], pose.rotation[2]].concat();
    rows(a).iter().zip(rows(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Configurations whose poses have eight, away from singularities by 0.05; the same in every run.
fn configurations(arm: &Arm) -> Vec<[f64; 6]> {
    let mut seed = 1_u64;
    // SplitMix64: Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014.
    let mut uniform = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0) * std::f64::consts::PI
    };
    let regular = |q: &[f64; 6]| {
        let factors = mbs_arm::jacobian::determinant_factors(q);
        [factors.shoulder, factors.elbow, factors.wrist].iter().all(|factor| factor.abs() > 0.05)
    };
    std::iter::repeat_with(|| std::array::from_fn(|_| uniform()))
        .filter(|q| regular(q) && arm.inverse(&arm.pose(q)).is_ok_and(|solutions| solutions.len() == 8))
        .take(STATES)
        .collect()
}
