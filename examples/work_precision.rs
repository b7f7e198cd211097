//! How much work does each method need for how much precision, and does another crate need less?
//!
//! Error of the final state against evaluations of the right-hand side, on a Kepler orbit, the Arenstorf orbit and a
//! generated double pendulum: every method of `mbs_runtime`, and DOP853 as other crates have it, at the same
//! tolerances (`russell_ode`, a minute of compilation, with `--features russell`). Look at the slopes (a method of
//! order p gains p digits for ten times the work), and at the last table of a problem: below 1 the other crate needs
//! fewer evaluations, or less time. The column `f` is the time of right-hand sides alone, as many as `mbs_runtime`
//! evaluates: no implementation that makes the same evaluations takes less.
//!
//! `--out DIR` writes the figure (SVG and PNG), all runs as CSV, and the JSON.

use mbs_examples::{print, println};

use mbs_chart::{Curves, Figure, Line, Panel};
use mbs_examples::work_precision::{EXPONENTS, Point, Report, least_time_ratio, least_work_ratio, reports, tolerances};
use mbs_examples::{Failure, arguments::Arguments, output};
use serde_json::{Value, json};

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("work_precision.rs"));

    let reports = reports().map_err(|error| Failure::new(error.to_string()))?;
    if let Some(folder) = arguments.folder()? {
        std::fs::write(folder.join("work_precision.json"), format!("{}\n", to_json(&reports)))?;
        std::fs::write(folder.join("work_precision.csv"), csv(&reports))?;
        output::write_figure(folder, "work_precision", &figure(&reports), &[])?;
    }
    if arguments.json {
        println!("{}", to_json(&reports));
    } else {
        reports.iter().for_each(print);
    }
    Ok(())
}

fn print(report: &Report) {
    println!("{}: every method\n", report.problem);
    for (method, points) in &report.methods {
        println!("{method:18} {:>10} {:>11} {:>9}", "setting", "evaluations", "error");
        for Point { setting, evaluations, error } in points {
            println!("{:18} {setting:10.2e} {evaluations:11} {error:9.1e}", "");
        }
    }
    println!("\n{}: DOP853 at eight tolerances: evaluations, error, time in µs\n", report.problem);
    print!("{:10}", "tolerance");
    report.crates.iter().for_each(|(name, ..)| print!("  {name:>25}"));
    println!("  {:>8}", "f");
    for (i, tolerance) in tolerances(EXPONENTS).enumerate() {
        print!("{tolerance:<10.0e}");
        for (_, points, fastest) in &report.crates {
            print!("  {:6} {:9.2e} {:8.1}", points[i].evaluations, points[i].error, fastest[i]);
        }
        println!("  {:8.1}", report.right_hand_sides[i]);
    }
    let (_, ours, time) = &report.crates[0];
    println!("\n{:24} least work for the same error / ours   least time at the same tolerance / ours", "");
    for (name, points, fastest) in &report.crates[1..] {
        println!("{name:24} {:38.3} {:41.3}", least_work_ratio(ours, points), least_time_ratio(time, fastest));
    }
    println!();
}

fn to_json(reports: &[Report]) -> Value {
    let point = |p: &Point| json!({ "setting": p.setting, "evaluations": p.evaluations, "error": p.error });
    let points = |points: &[Point]| points.iter().map(point).collect::<Value>();
    let problem = |report: &Report| {
        let (_, ours, time) = &report.crates[0];
        let methods = report.methods.iter().map(|(name, curve)| (name.to_string(), points(curve)));
        let crates = report.crates.iter().map(|(name, curve, fastest)| {
            let mut entry = json!({ "points": points(curve), "microseconds": fastest });
            if *name != "mbs_runtime" {
                entry["least_work_ratio"] = json!(least_work_ratio(ours, curve));
                entry["least_time_ratio"] = json!(least_time_ratio(time, fastest));
            }
            (name.to_string(), entry)
        });
        let (methods, crates): (serde_json::Map<_, _>, serde_json::Map<_, _>) = (methods.collect(), crates.collect());
        (
            report.problem.to_string(),
            json!({ "methods": methods, "dop853": crates, "right_hand_sides_microseconds": report.right_hand_sides }),
        )
    };
    Value::Object(reports.iter().map(problem).collect())
}

/// One row a run.
fn csv(reports: &[Report]) -> String {
    let mut text = "problem,method,crate,setting,evaluations,error,microseconds\n".to_string();
    let mut row = |problem: &str, method: &str, of: &str, p: &Point, time: Option<f64>| {
        let time = time.map_or(String::new(), |time| time.to_string());
        text += &format!("{problem},{method},{of},{:e},{},{:e},{time}\n", p.setting, p.evaluations, p.error);
    };
    for Report { problem, methods, crates, .. } in reports {
        for (method, points) in methods {
            points.iter().for_each(|point| row(problem, method, "mbs_runtime", point, None));
        }
        for (of, points, fastest) in crates {
            points.iter().zip(fastest).for_each(|(point, &time)| row(problem, "Dop853", of, point, Some(time)));
        }
    }
    text
}

/// Error against evaluations in logarithms, a panel a problem, a line a method.
fn figure(reports: &[Report]) -> Figure {
    let panel = |report: &Report| {
        let logarithms = |points: &[Point]| {
            let points = points.iter().filter(|point| point.error > 0.0);
            points.map(|p| ((p.evaluations as f64).log10(), p.error.log10())).collect::<Vec<_>>()
        };
        let lines: Vec<_> = report.methods.iter().map(|(method, points)| (*method, logarithms(points))).collect();
        let work = lines.iter().flat_map(|(_, points)| points.iter().map(|point| point.0));
        let (least, most) = work.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        Panel::Curves(Curves {
            x_label: "log10 of the evaluations".to_string(),
            y_label: format!("{}: log10 of the error", report.problem.replace('_', " ")),
            x_range: least..most,
            lines: lines.into_iter().map(|(method, points)| Line::new(method, points)).collect(),
        })
    };
    let title = "How much work each method needs for how much precision".to_string();
    Figure { title, size: (1000, 1050), panels: reports.iter().map(panel).collect() }
}
