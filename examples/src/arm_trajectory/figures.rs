//! Figures 3.4 to 3.11 of the thesis, and the torques that it does not show.

use std::path::Path;

use crate::Failure;
use crate::output::{write_figure, write_figures};
use mbs_arm::Arm;
use mbs_chart::{Figure, Line, Panel, Space, SpaceLine};

use super::cases::{Case, DURATION, Run, Sample};

/// Names, titles, axes and values of what is drawn over time; the number of the figure for each case.
type Curve = (&'static str, [usize; 2], &'static str, Value);
type Value = fn(&Sample) -> [f64; 6];
const JOINTS: [usize; 6] = [0, 1, 2, 3, 4, 5];
const CURVES: [Curve; 3] = [
    ("joint angles", [6, 7], "q [°]", |sample| sample.state.q.map(f64::to_degrees)),
    ("joint velocities", [8, 9], "dq/dt [°/s]", |sample| sample.state.qd.map(f64::to_degrees)),
    ("joint accelerations", [10, 11], "d²q/dt² [°/s²]", |sample| sample.state.qdd.map(f64::to_degrees)),
];

/// What torques rest on.
const TORQUES: [&str; 6] = ["gravity", "arm.masses", "arm.mass_centres", "arm.inertias", "arm.quartic", "arm.case_2"];

/// Writes the figures of the thesis, and the torques.
pub fn write(folder: &Path, arm: &Arm, case: &Case) -> Result<(), Failure> {
    write_figures(folder, &drawn(arm, case)?)?;
    write_figure(folder, &format!("torques_{}", case.name), &torques(case), &TORQUES)
}

/// The figures of the thesis with the names of their files.
pub fn drawn(arm: &Arm, case: &Case) -> Result<Vec<(String, Figure)>, Failure> {
    let number = 3 + case.number;
    let title = format!("Figure 3.{number}: path of the flange, case {}", case.number);
    let mut figures =
        vec![(format!("figure_3_{number}"), Figure { title, size: (900, 720), panels: vec![path(arm, case)?] })];
    for (what, numbers, label, value) in CURVES {
        let number = numbers[case.number - 1];
        let title = format!("Figure 3.{number}: {what}, case {}", case.number);
        let panels = if what == "joint angles" { angles(case, label, value) } else { over_time(case, label, value) };
        figures.push((format!("figure_3_{number}"), Figure { title, size: (900, 860), panels }));
    }
    Ok(figures)
}

/// One panel for each method.
fn over_time(case: &Case, label: &str, value: Value) -> Vec<Panel> {
    case.runs.iter().map(|run| panel(run, label, value, &JOINTS)).collect()
}

/// Those of the quartic, and by how much the other methods' are more: angles of all three look alike.
fn angles(case: &Case, label: &str, value: Value) -> Vec<Panel> {
    let [first, others @ ..] = &case.runs[..] else { return Vec::new() };
    let difference = |run: &Run| {
        let at = |i: usize| {
            let pairs = run.samples.iter().zip(&first.samples);
            pairs.map(|(a, b)| (a.t, value(a)[i] - value(b)[i])).collect()
        };
        let label = format!("{} less {}: {label}", method_name(run), method_name(first));
        curves(&label, &JOINTS, at)
    };
    std::iter::once(panel(first, label, value, &JOINTS)).chain(others.iter().map(difference)).collect()
}

/// Two panels for each method: axes 2 and 3 carry the arm, the torques of the others are small beside theirs.
fn torques(case: &Case) -> Figure {
    let groups = |run| [&[1, 2][..], &[0, 3, 4, 5]].map(|joints| panel(run, "τ [N·m]", |sample| sample.torque, joints));
    let panels = case.runs.iter().flat_map(groups).collect();
    Figure { title: format!("Joint torques, case {}", case.number), size: (900, 1700), panels }
}

fn panel(run: &Run, label: &str, value: Value, joints: &[usize]) -> Panel {
    let at = |i: usize| run.samples.iter().map(|sample| (sample.t, value(sample)[i])).collect();
    curves(&format!("{}: {label}", method_name(run)), joints, at)
}

/// A line for each joint.
fn curves(label: &str, joints: &[usize], points: impl Fn(usize) -> Vec<(f64, f64)>) -> Panel {
    let lines = joints.iter().map(|&i| Line::new(format!("joint {}", i + 1), points(i))).collect();
    Panel::over_time(label, 0.0..DURATION, lines)
}

fn method_name(run: &Run) -> &'static str {
    match run.method {
        "quartic" => "quartic",
        "two_piece_quartic" => "two quartics",
        _ => "quintic",
    }
}

/// By the quartic; the other methods lead along nearly the same way, and from rest along the very same.
fn path(arm: &Arm, case: &Case) -> Result<Panel, Failure> {
    let run = &case.runs[0];
    let [first, last] = [&run.samples[0], &run.samples[run.samples.len() - 1]].map(|sample| sample.position);
    let mut marks = vec![(first, "start".to_string()), (last, "stop".to_string())];
    for (time, singularity) in &run.singularities {
        marks.push((arm.pose(&run.motion.at(*time)?.q).position, format!("{singularity} singular at {time:.1} s")));
    }
    let points = run.samples.iter().map(|sample| sample.position).collect();
    let lines = vec![SpaceLine { name: method_name(run).to_string(), points, marks }];
    Ok(Panel::Space(Space { labels: ["x [m]", "y [m]", "z [m]"].map(String::from), lines }))
}
