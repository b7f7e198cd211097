//! The sea, the response to it, and the motion.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};
use mbs_platform::marine::excitation::{amplitude_operator, unit_wave};
use mbs_platform::marine::simulation::Moment;

use crate::run::{Run, Study};
use crate::summary::COORDINATES;

/// How much of the motion is drawn \[s\].
const SHOWN: f64 = 300.0;

pub(crate) fn write(folder: &Path, study: &Study, keys: &[&str]) -> Result<(), Failure> {
    let write = |name: &str, what: &str, height: u32, panels: Vec<Panel>| {
        let title = what.to_string();
        output::write_figure(folder, name, &Figure { title, size: (1100, height), panels }, keys)
    };
    write("marine_sea", "The sea", 750, vec![spectrum(study), elevation(study)])?;
    write("marine_response", "Linear response to regular waves, uncontrolled", 900, response(study))?;
    let motion = (0..4).map(|i| motion(study, i)).collect();
    write("marine_motion", "The motion at sea", 1100, motion)?;
    write("marine_thrust", "Thrusts under control", 650, vec![lift(&study.runs[1]), lateral(&study.runs[1])])?;
    write("marine_spectra", "The motion at sea, as spectra", 1000, (0..4).map(|i| spectra(study, i)).collect())
}

type Points = Vec<(f64, f64)>;

fn curves(labels: [&str; 2], x_range: std::ops::Range<f64>, lines: Vec<(&str, Points)>) -> Panel {
    Panel::curves(labels, x_range, lines.into_iter().map(|(name, points)| Line::new(name, points)).collect())
}

/// The density that was asked for, and that of the record.
fn spectrum(study: &Study) -> Panel {
    let peak = study.spectrum.peak();
    let range = 0.0..4.0 * peak;
    let asked = (1..=800).map(|k| 0.005 * f64::from(k) * peak).map(|w| (w, study.spectrum.density(w))).collect();
    let found = density(&study.elevation());
    curves(["ω [rad/s]", "S [m²·s]"], range, vec![("JONSWAP", asked), ("of the record, half an hour", found)])
}

fn elevation(study: &Study) -> Panel {
    let start = study.runs[0].moments[0].time;
    let points = study.runs[0].moments.iter().zip(study.elevation()).map(|(m, z)| (m.time - start, z)).collect();
    curves(["t [s]", "elevation over the middle [m]"], 0.0..SHOWN, vec![("", points)])
}

fn response(study: &Study) -> Vec<Panel> {
    let range = 0.2..1.6;
    let panel = |(i, label): (usize, &str)| {
        let line = |degrees: f64| -> Points {
            let scale = if i == 0 { 1.0 } else { 1.0_f64.to_degrees() };
            let frequencies = (0..=1400).map(|k| 0.2 + 0.001 * f64::from(k));
            let at = |w: f64| amplitude_operator(&study.hull, &unit_wave(w, (180.0 - degrees).to_radians()))[i];
            frequencies.map(|w| (w, scale * at(w))).collect()
        };
        let lines = vec![("from ahead", line(0.0)), ("from 45° beside", line(45.0)), ("from the side", line(90.0))];
        curves(["ω [rad/s]", label], range.clone(), lines)
    };
    ["heave [m/m]", "roll [°/m]", "pitch [°/m]", "yaw [°/m]"].into_iter().enumerate().map(panel).collect()
}

fn series(run: &Run, value: impl Fn(&Moment) -> f64) -> Points {
    let start = run.moments[0].time;
    let shown = run.moments.iter().take_while(|moment| moment.time - start <= SHOWN);
    shown.map(|moment| (moment.time - start, value(moment))).collect()
}

fn scaled(i: usize, value: f64) -> f64 {
    if i == 0 { value } else { value.to_degrees() }
}

fn motion(study: &Study, i: usize) -> Panel {
    let lines = study.runs.iter().map(|run| (run.name, series(run, |moment| scaled(i, moment.q[i])))).collect();
    let (name, unit) = COORDINATES[i];
    curves(["t [s]", &format!("{name} [{unit}]")], 0.0..SHOWN, lines)
}

fn lift(run: &Run) -> Panel {
    let names = ["ahead left", "ahead right", "behind left", "behind right"];
    let lines = names.into_iter().enumerate().map(|(i, name)| (name, series(run, |moment| moment.thrust[i] / 1e3)));
    curves(["t [s]", "upward thrust [kN]"], 0.0..SHOWN, lines.collect())
}

fn lateral(run: &Run) -> Panel {
    let names = ["ahead", "behind"];
    let lines = names.into_iter().enumerate().map(|(i, name)| (name, series(run, |moment| moment.thrust[4 + i] / 1e3)));
    curves(["t [s]", "thrust to the left [kN]"], 0.0..SHOWN, lines.collect())
}

fn spectra(study: &Study, i: usize) -> Panel {
    let line = |run: &Run| density(&run.coordinate(i).iter().map(|&value| scaled(i, value)).collect::<Vec<_>>());
    let lines = study.runs.iter().map(|run| (run.name, line(run))).collect();
    let (name, unit) = COORDINATES[i];
    curves(["ω [rad/s]", &format!("{name} [{unit}²·s]")], 0.0..1.6, lines)
}

/// The density of a record over the frequency \[rad/s\]: periodograms of pieces of 200 s under Hann's window, which
/// overlap by half, averaged.
///
/// # Source
/// P. D. Welch, *The use of fast Fourier transform for the estimation of power spectra*, IEEE Transactions on Audio and
/// Electroacoustics 15:2, 1967.
fn density(values: &[f64]) -> Points {
    use std::f64::consts::PI;
    // Four times a second: frequencies are far below.
    let (every, step) = (5, 5.0 * crate::run::PERIOD);
    let thinned: Vec<f64> = values.iter().step_by(every).copied().collect();
    let length = (200.0 / step) as usize;
    let window: Vec<f64> = (0..length).map(|k| 0.5 - 0.5 * (2.0 * PI * k as f64 / length as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let mean = thinned.iter().sum::<f64>() / thinned.len() as f64;
    let pieces: Vec<&[f64]> = thinned.windows(length).step_by(length / 2).collect();
    let at = |bin: usize| {
        let frequency = 2.0 * PI * bin as f64 / (length as f64 * step);
        let energy = |piece: &&[f64]| {
            let turn = |k: usize| frequency * step * k as f64;
            let part = |f: fn(f64) -> f64| -> f64 {
                piece.iter().zip(&window).enumerate().map(|(k, (value, w))| w * (value - mean) * f(turn(k))).sum()
            };
            part(f64::cos).powi(2) + part(f64::sin).powi(2)
        };
        let energy = pieces.iter().map(energy).sum::<f64>() / pieces.len() as f64;
        (frequency, energy * step / (PI * power))
    };
    (1..80).map(at).collect()
}

/// Every fifth of a second: elevation, coordinates and thrusts of both runs.
pub(crate) fn write_tables(folder: &Path, study: &Study) -> Result<(), Failure> {
    let [one, other] = study
        .runs
        .each_ref()
        .map(|Run { name, .. }| format!("{name}_heave_m {name}_roll_rad {name}_pitch_rad {name}_yaw_rad"));
    let words = format!("t_s elevation_m {one} {other} thrust_[1-6]_N");
    let elevation = study.elevation();
    let [free, controlled] = &study.runs;
    let row = |k: usize| {
        let (a, b) = (&free.moments[k], &controlled.moments[k]);
        [&[a.time, elevation[k]][..], &a.q, &b.q, &b.thrust].concat()
    };
    output::write_table(folder, "marine_motion", &words, (0..elevation.len()).step_by(4).map(row))
}
