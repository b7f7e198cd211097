//! Errors, estimates and V over time, as figures and as tables.

use std::path::Path;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, assumed, output};
use mbs_runtime::control::BodyParameters;

use crate::arm::{self, Comparison};
use crate::quadrotor;
use crate::run::{Run, Sample};
use crate::summary::VEHICLE;

/// What captions say; of the quadrotor beside what every landing rests on.
const ARM: [&str; 8] = [
    "gravity",
    "arm.masses",
    "arm.mass_centres",
    "arm.inertias",
    "adaptive.payload",
    "adaptive.arm",
    "adaptive.arm_adaptation",
    "adaptive.sines",
];
const QUADROTOR: [&str; 2] = ["adaptive.vehicle", "adaptive.quadrotor"];

pub(crate) fn write(folder: &Path, arm: &arm::Study, quadrotor: &quadrotor::Study) -> Result<(), Failure> {
    for of in &arm.payload {
        arm_figure(folder, &format!("arm_{}", of.motion), "Arm with an unknown payload", of)?;
    }
    arm_figure(folder, "arm_all_links", "Arm of which no link is known", &arm.links)?;
    for of in &quadrotor.flights {
        let name = format!("quadrotor_{}", of.reference);
        let runs = [
            ("backstepping, wrong model", &of.wrong.run),
            ("backstepping, right model", &of.right.run),
            ("adaptive", &of.adaptive.run),
        ];
        let estimates = (0..4).map(|k| relative(VEHICLE[k], &of.adaptive.run, k, quadrotor.truth[k])).collect();
        figure(
            folder,
            &name,
            "Quadrotor of unknown mass and inertia",
            &[assumed::LANDING, &QUADROTOR].concat(),
            runs,
            estimates,
            of.duration,
        )?;
        let forces = "thrust_N tau_x_Nm tau_y_Nm tau_z_Nm";
        table(folder, &name, &of.adaptive.run, forces, &VEHICLE.map(String::from))?;
    }
    Ok(())
}

fn arm_figure<const P: usize>(folder: &Path, name: &str, title: &str, of: &Comparison<P>) -> Result<(), Failure> {
    let runs = [
        ("computed torque, wrong model", &of.wrong),
        ("computed torque, right model", &of.right),
        ("adaptive", &of.adaptive),
    ];
    // Of sixty the last link's ten; of these the large ones, since small ones are hardly told.
    let ten = || (0..10).map(|k| (k, P - 10 + k));
    let estimates = ten()
        .filter(|&(_, k)| of.truth[k].abs() > 20.0)
        .map(|(name, k)| relative(BodyParameters::NAMES[name], &of.adaptive, k, of.truth[k]))
        .collect();
    figure(folder, name, title, &ARM, runs, estimates, of.duration)?;
    let names: Vec<String> =
        (0..P).map(|k| format!("{}{}", BodyParameters::NAMES[k % 10], 7 - P / 10 + k / 10)).collect();
    table(folder, name, &of.adaptive, "tau[1-6]_Nm", &names)
}

fn figure(
    folder: &Path,
    name: &str,
    title: &str,
    keys: &[&str],
    runs: [(&str, &Run); 3],
    estimates: Vec<Line>,
    duration: f64,
) -> Result<(), Failure> {
    // Errors spread over powers of ten; what is below a micrometre is drawn there.
    let logarithm = |s: &Sample| (1e3 * s.seen.error).max(1e-3).log10();
    let errors = runs.map(|(name, run)| line(name, run, logarithm)).into();
    let [.., (_, adaptive)] = runs;
    let v = vec![line("", adaptive, |s| s.seen.lyapunov)];
    let panels = vec![
        Panel::over_time("log₁₀ of the error in mm, at least −3", 0.0..duration, errors),
        Panel::over_time("estimate / truth", 0.0..duration, estimates),
        Panel::over_time("V [J]", 0.0..duration, v),
    ];
    let title = title.to_string();
    output::write_figure(folder, name, &Figure { title, size: (1100, 1100), panels }, keys)
}

fn relative(name: &str, run: &Run, k: usize, truth: f64) -> Line {
    line(name, run, |s| s.seen.estimate[k] / truth)
}

fn line(name: &str, run: &Run, value: impl Fn(&Sample) -> f64) -> Line {
    Line::new(name, run.samples.iter().step_by(5).map(|s| (s.t, value(s))).collect())
}

fn table(folder: &Path, name: &str, run: &Run, forces: &str, estimates: &[String]) -> Result<(), Failure> {
    let estimates: String = estimates.iter().map(|name| format!(" estimate_{name}")).collect();
    let words = format!("t_s error_m V_J q[1-6] {forces}{estimates}");
    let row = |s: &Sample| {
        [&[s.t, s.seen.error, s.seen.lyapunov][..], &s.motion[0], &s.seen.forces, &s.seen.estimate].concat()
    };
    output::write_table(folder, name, &words, run.samples.iter().step_by(5).map(row))
}
