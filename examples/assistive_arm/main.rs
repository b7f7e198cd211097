//! How light is a forearm that an assistive arm carries, and how much do its springs take off the motors?
//!
//! A person pushes the arm's end up, then to the side and forwards, and lets go. The motors make it feel like a small
//! mass in a viscous medium; springs of zero free length carry the weight in every posture. Look at the torques that
//! lift: without springs they are those of the weight. A second arm has springs for a lighter forearm than it carries.
//!
//! `--out DIR` writes the figure (SVG and PNG) and the curves (CSV).

mod motion;

use std::path::Path;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_models::assistive_arm::Params;
use serde_json::{Value, json};

use motion::{DURATION, Run, SAMPLES, push};

/// What torques and motions rest on.
const ASSUMED: [&str; 2] = ["gravity", "assistive."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let (balanced, runs) = motion::all()?;
    if let Some(folder) = arguments.folder()? {
        write(folder, &runs)?;
    }
    let row = |run: &Run| {
        let values = json!({ "holding_torque": run.samples[0].2, "peak_torque": run.peak(), "way": run.way() });
        (run.name.to_string(), values)
    };
    let results = json!({ "rates": balanced.rate, "runs": runs.iter().map(row).collect::<Value>() });
    arguments.answer(results, &text(&balanced, &runs), &ASSUMED);
    Ok(())
}

fn text(balanced: &Params<f64>, runs: &[Run; 3]) -> String {
    let (payload, [first, second]) = (balanced.payload, balanced.rate);
    let mut text = format!(
        "An assistive arm with a forearm of {payload} kg; springs of {first:.0} and {second:.0} N/m balance it.\n\n\
         \x20                    peak torques of the motors [N·m]            way of the hand [m]\n\
         \x20                     yaw 1    yaw 2   lift 1   lift 2          x        y        z\n"
    );
    for run in runs {
        let torques = run.peak().map(|torque| format!("{torque:9.3}")).concat();
        let way = run.way().map(|metres| format!("{metres:9.4}")).concat();
        text += &format!("{:18}{torques}   {way}\n", run.name);
    }
    text
}

fn write(folder: &Path, runs: &[Run; 3]) -> Result<(), Failure> {
    let panel = |label: &str, lines: Vec<Line>| Panel::over_time(label, 0.0..DURATION, lines);
    let axes = ["x", "y", "z"];
    let force = (0..3).map(|i| {
        let points = runs[0].samples.iter().map(|sample| (sample.0, push(sample.0)[i])).collect();
        Line::new(axes[i], points)
    });
    let place = (0..3).map(|i| {
        let start = runs[1].samples[0].1[i];
        Line::new(axes[i], runs[1].samples.iter().map(|sample| (sample.0, 1e3 * (sample.1[i] - start))).collect())
    });
    let lift =
        runs.iter().map(|run| Line::new(run.name, run.samples.iter().map(|sample| (sample.0, sample.2[2])).collect()));
    let panels = vec![
        panel("force of the person [N]", force.collect()),
        panel("way of the hand, balanced [mm]", place.collect()),
        panel("torque that lifts the upper arm [N·m]", lift.collect()),
    ];
    let title = "An assistive arm in a person's hand".to_string();
    output::write_figure(folder, "assistive_arm", &Figure { title, size: (900, 860), panels }, &ASSUMED)?;
    let lifts = runs.each_ref().map(|run| format!(" lift_{}_Nm", run.name.replace(' ', "_"))).concat();
    let row = |k: usize| {
        let (t, place, _) = runs[1].samples[k];
        [&[t][..], &place, &runs.each_ref().map(|run| run.samples[k].2[2])].concat()
    };
    output::write_table(folder, "assistive_arm", &format!("t_s x_m y_m z_m{lifts}"), (0..=SAMPLES).map(row))
}
