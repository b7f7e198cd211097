//! The summary: figures of every run, then what they say about the thesis.

use std::fmt::Write;

use mbs_arm::Arm;
use mbs_arm::trajectory::Motion;
use mbs_arm::trajectory::cartesian::{CartesianPath, FlangeLine, branch_of};
use mbs_examples::Failure;
use mbs_models::{At, Error};

use crate::rapid;
use mbs_examples::arm_trajectory::cases::{self, Case};

pub(crate) fn of(arm: &Arm, cases: &[Case]) -> Result<String, Failure> {
    let mut text = String::from(
        "Table 2 of the thesis: the IRB 7600 from (20, 10, 10, 10, 20, 10)° to (50, 90, 120, 80, 60, 100)° in 50 s.\n\n",
    );
    runs(&mut text, cases)?;
    energies(&mut text, cases)?;
    lines(&mut text, arm)?;
    writeln!(
        text,
        "\nThe same way from rest to rest as fast as the assumed drives can: {:.3} s.",
        cases::fastest(arm)?.duration()
    )?;
    writeln!(
        text,
        "\nOut of the ranges of the real axes (their RAPID modules say so, too; those named in_range keep them):"
    )?;
    for case in cases {
        for warning in rapid::warnings(arm, &*case.runs[0].motion)? {
            writeln!(text, "  {}: {warning}", case.name)?;
        }
    }
    errata(&mut text, cases)?;
    Ok(text)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn runs(text: &mut String, cases: &[Case]) -> Result<(), Failure> {
    writeln!(
        text,
        "                          peak speed   acceleration    at the stop      energy          effort   singular"
    )?;
    writeln!(text, "                               [°/s]         [°/s²]         [°/s²]         [J]       [N²·m²·s]")?;
    for case in cases {
        for run in &case.runs {
            let stop = &run.samples[run.samples.len() - 1].state.qdd;
            let [speed, acceleration, stop] =
                [largest(&run.peak_speed), largest(&run.peak_acceleration), largest(&stop.map(f64::abs))]
                    .map(f64::to_degrees);
            // An acceleration of rounding is none.
            let stop = if stop < 1e-12 { 0.0 } else { stop };
            let singular: Vec<String> =
                run.singularities.iter().map(|(time, what)| format!("{what} at {time:.6} s")).collect();
            writeln!(
                text,
                "{} {:18} {speed:11.4} {acceleration:14.4} {stop:14.4} {:11.4} {:15.6e}   {}",
                case.name,
                run.method,
                run.energy.value,
                run.effort.value,
                singular.join(", ")
            )?;
        }
    }
    let error = cases.iter().flat_map(|case| &case.runs).map(|run| run.energy.error / run.energy.value);
    writeln!(
        text,
        "\nEnergy is ∫ Σ |τ q̇| dt, effort ∫ Σ τ² dt; the quadrature is good to {:.0e}.",
        error.fold(0.0, f64::max)
    )?;
    Ok(())
}

/// The thesis' claim about energy, computed.
fn energies(text: &mut String, cases: &[Case]) -> Result<(), Failure> {
    writeln!(
        text,
        "\nDoes the initial velocity of case 2 cost energy, as the thesis says? With the assumed masses of the links:"
    )?;
    for (first, second) in cases[0].runs.iter().zip(&cases[1].runs) {
        let change = 100.0 * (second.energy.value / first.energy.value - 1.0);
        let answer = if change > 0.0 { "yes" } else { "no" };
        writeln!(text, "  {:18} {answer}: {change:+.2} % of work", first.method)?;
    }
    Ok(())
}

/// What becomes of a straight line of the flange between the same poses.
fn lines(text: &mut String, arm: &Arm) -> Result<(), Failure> {
    let [start, stop] = cases::ends();
    let line = FlangeLine::new(&arm.pose(&start), &arm.pose(&stop))?;
    writeln!(text, "\nThe flange on a straight line between the same poses:")?;
    let on_line = |arm: &Arm| match CartesianPath::<65>::new(arm, line, &start) {
        Ok(path) => {
            let end = path.postures()[64];
            let other = branch_of(&end) != branch_of(&stop);
            let elbow = if other { ", on another branch than the stop of Table 2" } else { "" };
            format!("it arrives with ({})°{elbow}", end.map(|q| format!("{:.2}", q.to_degrees())).join(", "))
        }
        Err(Error { failure: mbs_models::Failure::LimitExceeded { index, .. }, at: Some(At::Path(s)) }) => {
            format!("axis {} is out of range at s = {s}", index + 1)
        }
        Err(error) => error.to_string(),
    };
    writeln!(text, "  within the ranges of the axes: {}", on_line(arm))?;
    let mut unlimited = arm.clone();
    (unlimited.limits.lower, unlimited.limits.upper) = ([-10.0; 6], [10.0; 6]);
    writeln!(text, "  whatever the ranges: {}", on_line(&unlimited))?;
    Ok(())
}

fn errata(text: &mut String, cases: &[Case]) -> Result<(), Failure> {
    let [case1, case2] = [&cases[0].runs, &cases[1].runs];
    let peak = |i: usize| largest(&case1[i].peak_acceleration).to_degrees();
    let lowest = case1[0].samples.iter().map(|sample| sample.position[2]).fold(f64::INFINITY, f64::min);
    let fastest = cases.iter().map(|case| largest(&case.runs[0].peak_speed)).fold(0.0, f64::max).to_degrees();
    let times: Vec<String> =
        [case1, case2].iter().flat_map(|runs| &runs[0].singularities).map(|(time, _)| format!("{time:.3} s")).collect();
    writeln!(text, "\nWhere the thesis needs correction:")?;
    writeln!(
        text,
        "  E9   a quartic has five coefficients for six conditions: it stops with up to {:.3} °/s² in case 1",
        peak(0)
    )?;
    writeln!(
        text,
        "  E11  Tables 1 and 2 are angles of Denavit and Hartenberg, not the robot's own: the flange dips to z = {lowest:.3} m"
    )?;
    writeln!(
        text,
        "  E48  the quartic does not minimize accelerations: {:.3} °/s², two quartics {:.3}, a quintic {:.3}",
        peak(0),
        peak(1),
        peak(2)
    )?;
    writeln!(
        text,
        "  E49  the initial velocity does not push motors to their maximum: no joint exceeds {fastest:.2} °/s; case 2 takes {:+.2} % of work",
        100.0 * (case2[0].energy.value / case1[0].energy.value - 1.0)
    )?;
    writeln!(
        text,
        "  E50  the motion crosses the elbow singularity, at {}: joint interpolation passes, resolved rates would not",
        times.join(" and ")
    )?;
    Ok(())
}
