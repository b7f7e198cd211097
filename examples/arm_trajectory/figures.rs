//! Figures 3.4 to 3.11 of the thesis, and the torques that it does not show.

use std::path::Path;

use mbs_cli::chart::{Curves, Figure, Line, Panel, Space, SpaceLine};
use mbs_examples::{Failure, output::write_figure};
use mbs_models::arm::Arm;

use crate::cases::{Case, DURATION, Run, Sample};

/// Names, titles, axes and values of what is drawn over time; the number of the figure for each case.
type Curve = (&'static str, [usize; 2], &'static str, fn(&Sample) -> [f64; 6]);
const CURVES: [Curve; 3] = [
    ("joint angles", [6, 7], "q [°]", |sample| sample.state.q.map(f64::to_degrees)),
    ("joint velocities", [8, 9], "dq/dt [°/s]", |sample| sample.state.qd.map(f64::to_degrees)),
    ("joint accelerations", [10, 11], "d²q/dt² [°/s²]", |sample| sample.state.qdd.map(f64::to_degrees)),
];

pub(crate) fn write(folder: &Path, arm: &Arm, case: &Case) -> Result<(), Failure> {
    let number = 3 + case.number;
    let title = format!("Figure 3.{number}: path of the flange, case {}", case.number);
    let figure = Figure { title, size: (1100, 800), panels: vec![path(arm, case)?] };
    write_figure(folder, &format!("figure_3_{number}"), &figure)?;
    for (what, numbers, label, value) in CURVES {
        let number = numbers[case.number - 1];
        let title = format!("Figure 3.{number}: {what}, case {}", case.number);
        write_figure(folder, &format!("figure_3_{number}"), &over_time(title, case, label, value))?;
    }
    let title = format!("Joint torques, case {}", case.number);
    write_figure(folder, &format!("torques_{}", case.name), &over_time(title, case, "τ [N·m]", |sample| sample.torque))
}

/// One panel for each method; the torques of axes 1 and 4 to 6 are small beside those that carry the arm, and have one more.
fn over_time(title: String, case: &Case, label: &str, value: fn(&Sample) -> [f64; 6]) -> Figure {
    let panel = |run: &Run| {
        let curve = |i: usize| run.samples.iter().map(|sample| (sample.t, value(sample)[i])).collect();
        Panel::Curves(Curves {
            x_label: "t [s]".to_string(),
            y_label: format!("{}: {label}", method_name(run)),
            x_range: 0.0..DURATION,
            lines: (0..6).map(|i| Line::new(format!("joint {}", i + 1), curve(i))).collect(),
        })
    };
    Figure { title, size: (1100, 1000), panels: case.runs.iter().map(panel).collect() }
}

fn method_name(run: &Run) -> &'static str {
    match run.method {
        "quartic" => "quartic",
        "two_piece_quartic" => "two quartics",
        _ => "quintic",
    }
}

/// From rest all methods go the same way.
fn path(arm: &Arm, case: &Case) -> Result<Panel, Failure> {
    let shown = if case.number == 1 { 1 } else { case.runs.len() };
    let line = |run: &Run| -> Result<SpaceLine, Failure> {
        let [first, last] = [&run.samples[0], &run.samples[run.samples.len() - 1]].map(|sample| sample.position);
        let mut marks = vec![(first, "start".to_string()), (last, "stop".to_string())];
        for (time, singularity) in &run.singularities {
            marks.push((arm.pose(&run.motion.at(*time)?.q).position, format!("{singularity}, {time:.1} s")));
        }
        let points = run.samples.iter().map(|sample| sample.position).collect();
        Ok(SpaceLine { name: method_name(run).to_string(), points, marks })
    };
    let lines = case.runs[..shown].iter().map(line).collect::<Result<_, _>>()?;
    Ok(Panel::Space(Space { labels: ["x [m]", "y [m]", "z [m]"].map(String::from), lines }))
}
