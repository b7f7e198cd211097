//! How well does DOP853 keep the energy of a chaotic double pendulum?
//!
//! Released at rest at (2.0, 2.5) rad, 100 s. Look at the drift: it falls with the tolerance until rounding remains,
//! while the evaluations grow by about a third per decade.
//!
//! `--out DIR` draws the drift over time (SVG and PNG).

use std::ops::ControlFlow;

use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_models::double_pendulum::DoublePendulum;
use mbs_runtime::{Dop853, IntegrationError, Integrator, State, accelerations};
use serde_json::json;

/// How long it swings \[s\].
const DURATION: f64 = 100.0;

/// Where rounding ends, in figures.
const LEAST: f64 = 1e-17;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("double_pendulum_energy.rs"));
    let runs: Vec<Run> = [1e-6, 1e-8, 1e-10, 1e-12].into_iter().map(run).collect::<Result<_, _>>()?;
    if let Some(folder) = arguments.folder()? {
        output::write_figure(folder, "double_pendulum_energy", &figure(&runs), &[])?;
    }
    let row = |run: &Run| json!({"rtol": run.rtol, "energy_drift": run.greatest(), "evaluations": run.evaluations});
    let line = |run: &Run| {
        let (rtol, drift, evaluations) = (run.rtol, run.greatest(), run.evaluations);
        format!(
            "rtol {rtol:5.0e}: energy drift {drift:9.2e} of the largest kinetic energy, {evaluations} evaluations\n"
        )
    };
    let results = json!({"runs": runs.iter().map(row).collect::<Vec<_>>()});
    arguments.answer(results, &runs.iter().map(line).collect::<String>(), &[]);
    Ok(())
}

/// A run at a tolerance.
struct Run {
    rtol: f64,
    /// At the accepted steps: the time \[s\], and the change of `T + V` over the largest T of the run.
    drift: Vec<(f64, f64)>,
    evaluations: usize,
}

impl Run {
    fn greatest(&self) -> f64 {
        self.drift.iter().fold(0.0, |greatest, (_, drift)| drift.max(greatest))
    }
}

fn run(rtol: f64) -> Result<Run, IntegrationError> {
    let pendulum = DoublePendulum::<f64>::default();
    let mut state = State { q: [2.0, 2.5], qd: [0.0; 2] };
    let total = |s: &State<[f64; 2]>| pendulum.kinetic_energy(&s.q, &s.qd) + pendulum.potential_energy(&s.q);
    let start = total(&state);
    let (mut changes, mut largest) = (Vec::new(), 0.0_f64);
    let motion = accelerations(&pendulum, |_, _, _| []);
    let summary = Dop853::new(rtol, rtol).integrate(motion, 0.0, DURATION, &mut state, |step| {
        largest = largest.max(pendulum.kinetic_energy(&step.state().q, &step.state().qd));
        changes.push((step.time(), (total(step.state()) - start).abs()));
        ControlFlow::Continue(())
    })?;
    let drift = changes.into_iter().map(|(t, change)| (t, change / largest)).collect();
    Ok(Run { rtol, drift, evaluations: summary.evaluations })
}

/// The drift over time in logarithms, a line a tolerance.
fn figure(runs: &[Run]) -> Figure {
    let line = |run: &Run| {
        let points = run.drift.iter().map(|&(t, drift)| (t, drift.max(LEAST).log10())).collect();
        Line::new(format!("tolerance {:.0e}", run.rtol), points)
    };
    let label = "log10 of the change of T + V over the largest T";
    let panels = vec![Panel::over_time(label, 0.0..DURATION, runs.iter().map(line).collect())];
    Figure { title: "The energy of a double pendulum by DOP853".to_string(), size: (1000, 600), panels }
}
