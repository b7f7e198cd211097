//! How light is a forearm that an assistive arm carries, and how much do its springs take off the motors?
//!
//! A person pushes the arm's end up, then to the side and forwards, and lets go. The motors make it feel like a small
//! mass in a viscous medium; springs of zero free length carry the weight in every posture. Look at the torques that
//! lift: without springs they are those of the weight. A second arm has springs for a lighter forearm than it carries.
//!
//! `--out DIR` writes the figure (SVG and PNG) and the curves (CSV).

use std::ops::ControlFlow;
use std::path::Path;

use mbs_arm::assistive::{Admittance, balancing_rates};
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_models::assistive_arm::{AssistiveArm, Params};
use mbs_runtime::{Dop853, Integrator, State};
use serde_json::{Value, json};

/// What torques and motions rest on.
const ASSUMED: [&str; 2] = ["gravity", "assistive."];
/// Yaw of shoulder and elbow, elevation of both links at the start \[°\].
const START: [f64; 4] = [20.0, 90.0, 0.0, -40.0];
/// How long it takes \[s\].
const DURATION: f64 = 4.0;
const SAMPLES: usize = 400;
/// A push: when it begins and how long it lasts \[s\], its greatest force in the axes of the base \[N\].
const PUSHES: [(f64, f64, [f64; 3]); 2] = [(0.2, 1.0, [0.0, 0.0, 6.0]), (1.8, 1.0, [3.0, -4.0, 0.0])];
/// What the hand feels.
const FEEL: Admittance = Admittance { mass: 2.0, damping: 10.0, settling: 5.0 };
/// By how much the forearm is heavier than the springs of the second arm know \[kg\].
const EXCESS: f64 = 0.3;

/// One arm's run.
struct Run {
    name: &'static str,
    /// Time \[s\], place of the hand \[m\], torques of the motors \[N·m\].
    samples: Vec<(f64, [f64; 3], [f64; 4])>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("assistive_arm.rs"));
    FEEL.check()?;
    let bare = Params::default();
    let balanced = Params { rate: balancing_rates(&bare), ..bare };
    let lighter = Params { rate: balancing_rates(&Params { payload: bare.payload - EXCESS, ..bare }), ..bare };
    let runs = [run("without springs", bare)?, run("balanced", balanced)?, run("0.3 kg too heavy", lighter)?];
    if let Some(folder) = arguments.folder()? {
        write(folder, &runs)?;
    }
    let row = |run: &Run| {
        let values = json!({ "holding_torque": run.samples[0].2, "peak_torque": peak(run), "way": way(run) });
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
        let torques = peak(run).map(|torque| format!("{torque:9.3}")).concat();
        let way = way(run).map(|metres| format!("{metres:9.4}")).concat();
        text += &format!("{:18}{torques}   {way}\n", run.name);
    }
    text
}

/// The person's force at the hand \[N\].
fn push(t: f64) -> [f64; 3] {
    let mut force = [0.0; 3];
    for (begin, length, most) in PUSHES {
        let part = (t - begin) / length;
        if (0.0..1.0).contains(&part) {
            let rise = (std::f64::consts::PI * part).sin().powi(2);
            force = most.map(|most| rise * most);
        }
    }
    force
}

fn run(name: &'static str, params: Params<f64>) -> Result<Run, Failure> {
    let arm = AssistiveArm::try_new(params)?;
    let torques = |t: f64, q: &[f64; 4], qd: &[f64; 4]| {
        FEEL.torques(&arm, q, qd, &push(t)).ok_or_else(|| Failure::new(format!("singular at {t} s")))
    };
    let mut state = State::new(START.map(f64::to_radians), [0.0; 4]);
    let mut samples = Vec::new();
    let time = |k: usize| DURATION * k as f64 / SAMPLES as f64;
    for k in 0..=SAMPLES {
        samples.push((time(k), arm.hand_place(&state.q), torques(time(k), &state.q, &state.qd)?));
        if k == SAMPLES {
            break;
        }
        let moving = |t: f64, q: &[f64; 4], qd: &[f64; 4], qdd: &mut [f64; 4]| {
            let force = push(t);
            // Where there are no torques the accelerations are NaN, which the integrator reports.
            let torque = FEEL.torques(&arm, q, qd, &force).unwrap_or([f64::NAN; 4]);
            *qdd = arm.forward_dynamics(
                q,
                qd,
                &[torque[0], torque[1], torque[2], torque[3], force[0], force[1], force[2]],
            );
        };
        let settings = Dop853::new(1e-10, 1e-12);
        settings.integrate(moving, time(k), time(k + 1), &mut state, |_| ControlFlow::Continue(()))?;
    }
    Ok(Run { name, samples })
}

fn peak(run: &Run) -> [f64; 4] {
    std::array::from_fn(|i| run.samples.iter().map(|sample| sample.2[i].abs()).fold(0.0, f64::max))
}

/// From the start to where the hand came to rest \[m\].
fn way(run: &Run) -> [f64; 3] {
    let (start, stop) = (run.samples[0].1, run.samples[SAMPLES].1);
    std::array::from_fn(|i| stop[i] - start[i])
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
