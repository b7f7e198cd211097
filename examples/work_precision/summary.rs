//! All runs as text, as JSON and as a table.

use mbs_examples::work_precision::{EXPONENTS, Point, Report, least_time_ratio, least_work_ratio, tolerances};
use serde_json::{Value, json};

pub(crate) fn text(reports: &[Report]) -> String {
    reports.iter().map(of_problem).collect()
}

fn of_problem(report: &Report) -> String {
    let mut text = format!("{}: every method\n\n", report.problem);
    for (method, points) in &report.methods {
        text += &format!("{method:18} {:>10} {:>11} {:>9}\n", "setting", "evaluations", "error");
        for Point { setting, evaluations, error } in points {
            text += &format!("{:18} {setting:10.2e} {evaluations:11} {error:9.1e}\n", "");
        }
    }
    text += &format!("\n{}: DOP853 at eight tolerances: evaluations, error, time in µs\n\n", report.problem);
    text += &format!("{:10}", "tolerance");
    for (name, ..) in &report.crates {
        text += &format!("  {name:>25}");
    }
    text += &format!("  {:>8}\n", "f");
    for (i, tolerance) in tolerances(EXPONENTS).enumerate() {
        text += &format!("{tolerance:<10.0e}");
        for (_, points, fastest) in &report.crates {
            text += &format!("  {:6} {:9.2e} {:8.1}", points[i].evaluations, points[i].error, fastest[i]);
        }
        text += &format!("  {:8.1}\n", report.right_hand_sides[i]);
    }
    let (_, ours, time) = &report.crates[0];
    text += &format!("\n{:24} least work for the same error / ours   least time at the same tolerance / ours\n", "");
    for (name, points, fastest) in &report.crates[1..] {
        let (work, time) = (least_work_ratio(ours, points), least_time_ratio(time, fastest));
        text += &format!("{name:24} {work:38.3} {time:41.3}\n");
    }
    text + "\n"
}

pub(crate) fn to_json(reports: &[Report]) -> Value {
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
pub(crate) fn csv(reports: &[Report]) -> String {
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
