//! Error against evaluations in logarithms, a panel a problem, a line a method.

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::work_precision::{Point, Report};

pub(crate) fn of(reports: &[Report]) -> Figure {
    let panel = |report: &Report| {
        let logarithms = |points: &[Point]| {
            let points = points.iter().filter(|point| point.error > 0.0);
            points.map(|p| ((p.evaluations as f64).log10(), p.error.log10())).collect::<Vec<_>>()
        };
        let lines = report.methods.iter().map(|(method, points)| Line::new(*method, logarithms(points))).collect();
        let y_label = format!("{}: log10 of the error", report.problem.replace('_', " "));
        Panel::fitted(["log10 of the evaluations", &y_label], 0.0, lines)
    };
    let title = "How much work each method needs for how much precision".to_string();
    Figure { title, size: (1000, 1050), panels: reports.iter().map(panel).collect() }
}
