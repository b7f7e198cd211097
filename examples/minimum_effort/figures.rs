//! Both motions one above the other, and the front.

use std::path::Path;

use mbs_arm::trajectory::minimum_effort::front::Choice;
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};

use crate::front::Front;
use crate::motion::{Comparison, DURATION, Sample, effort};

pub(crate) fn write(folder: &Path, comparison: &Comparison, front: &Front) -> Result<(), Failure> {
    let joints = |what: &str, value: fn(&Sample) -> [f64; 6]| {
        [("quintic", &comparison.by_quintic), ("least effort", &comparison.by_optimum)].map(|(name, samples)| {
            let line = |i: usize| {
                let points = samples.iter().map(|sample| (sample.t, value(sample)[i])).collect();
                Line::new(format!("joint {}", i + 1), points)
            };
            Panel::over_time(&format!("{name}: {what}"), 0.0..DURATION, (0..6).map(line).collect())
        })
    };
    let panels = [
        joints("q [°]", |sample| sample.state.q.map(f64::to_degrees)),
        joints("dq/dt [°/s]", |sample| sample.state.qd.map(f64::to_degrees)),
        joints("τ, part of the limit", |sample| sample.torque),
    ];
    let title = "From posture to posture: a quintic, and the least effort".to_string();
    let figure = Figure { title, size: (900, 1500), panels: panels.into_iter().flatten().collect() };
    output::write_figure(folder, "minimum_effort", &figure, &crate::ASSUMED)?;
    let title = "Time against effort of the arm's motion".to_string();
    let figure = Figure { title, size: (900, 640), panels: vec![pareto(comparison, front)] };
    output::write_figure(folder, "pareto", &figure, &crate::ASSUMED)
}

fn pareto(comparison: &Comparison, front: &Front) -> Panel {
    let (choices, dominated) = (front.choices(), front.dominated());
    let point = |choice: &Choice| (choice.duration, choice.effort);
    let [first, last] = [&choices[0], &choices[choices.len() - 1]].map(point);
    let ends = format!("fastest in {:.3} s, with the least effort in {:.3} s", first.0, last.0);
    let beyond: Vec<_> = std::iter::once(last).chain(dominated.iter().map(point)).collect();
    let end = beyond[beyond.len() - 1].0;
    let line = Line::new("Pareto front", choices.iter().map(point).collect());
    let quintic = format!("the quintic in {DURATION} s: J = {:.3} s", effort(&comparison.by_quintic));
    let lines = vec![line, Line::new("dominated: slower and more effort", beyond)];
    let labels = [&format!("time T [s]   ({ends}; {quintic})"), "least effort J [s]"];
    Panel::curves(labels, first.0 - 0.02..end, lines)
}

pub(crate) fn write_tables(folder: &Path, comparison: &Comparison, front: &Front) -> Result<(), Failure> {
    let row = |sample: &Sample| {
        let [q, qd] = [sample.state.q, sample.state.qd].map(|values| values.map(f64::to_degrees));
        [&[sample.t][..], &q, &qd, &sample.torque].concat()
    };
    for (name, samples) in [("quintic", &comparison.by_quintic), ("minimum_effort", &comparison.by_optimum)] {
        output::write_table(
            folder,
            name,
            "t_s q[1-6]_deg qd[1-6]_deg_s torque[1-6]_of_limit",
            samples.iter().map(row),
        )?;
    }
    let rows = front.choices().into_iter().map(|choice| vec![choice.duration, choice.effort, choice.slope]);
    output::write_table(folder, "pareto", "time_s effort_s slope", rows)
}
