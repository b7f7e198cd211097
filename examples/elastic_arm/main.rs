//! How does the IRB 7600 ring when it stops, if joints and gears give way?
//!
//! Its motors follow case 1 of the thesis, the way of Table 2 in 50 s, by motor encoders and a model that knows the
//! weight; the joints hang on springs behind them. The quartic of the thesis stops with a jump of the acceleration
//! (E9): look at the flange after the stop, beside the quintic, which has none. The natural frequencies and what the
//! flange gives way under its payload stand above it.
//!
//! `--out DIR` writes the figure (SVG and PNG) and the curves (CSV).

mod ringing;

use std::path::Path;

use mbs_arm::elastic::ElasticArm;
use mbs_arm::trajectory::{quartic, quintic};
use mbs_arm::{Arm, JointVector};
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::arm_trajectory::cases;
use mbs_examples::{Failure, arguments::Arguments, output};
use serde_json::json;

use ringing::{BEFORE, BEHIND, Ringing, ringing};

/// What frequencies and deflections rest on.
const ASSUMED: [&str; 6] = ["gravity", "arm.masses", "arm.mass_centres", "arm.inertias", "elastic.", "arm.quartic"];
/// The greatest payload of the robot, as its name has it \[kg\].
const PAYLOAD: f64 = 500.0;
/// Natural frequency of the motors' control \[rad/s\].
const CONTROL: f64 = 20.0;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let (arm, elastic) = (Arm::default(), ElasticArm::default());
    let [start, stop] = cases::ends();
    let rest = [0.0; 6];
    let by_quartic = ringing(&arm, &elastic, &quartic(start, rest, stop, cases::DURATION)?)?;
    let by_quintic = ringing(&arm, &elastic, &quintic(start, rest, stop, cases::DURATION)?)?;
    let frequencies = elastic.natural_frequencies(&stop).map(|omega| omega / std::f64::consts::TAU);
    let weight = -arm.model.params().g * PAYLOAD;
    let sinks = elastic.compliance(&stop).map(|row| row[2] * weight);
    let curves = [("quartic", by_quartic), ("quintic", by_quintic)];
    if let Some(folder) = arguments.folder()? {
        write(folder, &curves)?;
    }
    let [quartic, quintic] = curves.each_ref().map(|(_, ringing)| swing(ringing));
    let results = json!({
        "natural_frequencies_hz": frequencies,
        "payload": PAYLOAD,
        "deflection": sinks,
        "swing_after_stop": { "quartic": quartic, "quintic": quintic },
    });
    arguments.answer(results, &text(&frequencies, &sinks, [quartic, quintic]), &ASSUMED);
    Ok(())
}

fn text(frequencies: &JointVector, sinks: &[f64; 6], [quartic, quintic]: [f64; 2]) -> String {
    let hertz = frequencies.map(|frequency| format!("{frequency:.2}")).join(", ");
    let [x, y, z] = [sinks[0], sinks[1], sinks[2]].map(|metres| 1e3 * metres);
    format!(
        "The IRB 7600 with elastic joints and gears, at the stop of Table 2.\n\n\
         natural frequencies, motors held: {hertz} Hz\n\
         {PAYLOAD} kg at the flange move it by ({x:.2}, {y:.2}, {z:.2}) mm\n\
         after the stop the flange swings by {:.3} µm with the quartic, by {:.3} µm with the quintic\n",
        1e6 * quartic,
        1e6 * quintic
    )
}

/// From the lowest to the highest place after the stop \[m\].
fn swing(ringing: &Ringing) -> f64 {
    let after = || ringing.iter().filter(|point| point.0 > 0.0).map(|point| point.1);
    after().fold(f64::NEG_INFINITY, f64::max) - after().fold(f64::INFINITY, f64::min)
}

fn write(folder: &Path, curves: &[(&str, Ringing); 2]) -> Result<(), Failure> {
    let line = |(name, ringing): &(&str, Ringing)| {
        Line::new(*name, ringing.iter().map(|(t, height)| (*t, 1e6 * height)).collect())
    };
    let labels = ["time after the stop [s]", "flange above where it should be [µm]"];
    let panel = Panel::curves(labels, -BEFORE..BEHIND, curves.iter().map(line).collect());
    let title = "The flange of an arm with elastic joints, case 1".to_string();
    output::write_figure(folder, "elastic_arm", &Figure { title, size: (900, 560), panels: vec![panel] }, &ASSUMED)?;
    let rows = curves[0].1.iter().zip(&curves[1].1).map(|((t, first), (_, second))| vec![*t, *first, *second]);
    output::write_table(folder, "elastic_arm", "t_s quartic_m quintic_m", rows)
}
