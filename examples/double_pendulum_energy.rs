//! How well does DOP853 keep the energy of a chaotic double pendulum?
//!
//! Released at rest at (2.0, 2.5) rad, 100 s. Look at the drift: it falls with the tolerance until rounding remains,
//! while the evaluations grow by about a third per decade.

use mbs_examples::println;
use std::ops::ControlFlow;

use mbs_examples::arguments::Arguments;
use mbs_models::double_pendulum::DoublePendulum;
use mbs_runtime::{Dop853, IntegrationError, Integrator, State, accelerations};
use serde_json::json;

fn main() -> Result<(), IntegrationError> {
    let as_json = Arguments::of(include_str!("double_pendulum_energy.rs")).json;
    let runs = [1e-6, 1e-8, 1e-10, 1e-12].map(|rtol| run(rtol).map(|(drift, evaluations)| (rtol, drift, evaluations)));
    let mut rows = Vec::new();
    for run in runs {
        let (rtol, drift, evaluations) = run?;
        rows.push(json!({"rtol": rtol, "energy_drift": drift, "evaluations": evaluations}));
        if !as_json {
            println!(
                "rtol {rtol:5.0e}: energy drift {drift:9.2e} of the largest kinetic energy, {evaluations} evaluations"
            );
        }
    }
    if as_json {
        println!("{}", json!({"runs": rows}));
    }
    Ok(())
}

/// The drift of `T + V` over the largest T, and the evaluations it took.
fn run(rtol: f64) -> Result<(f64, usize), IntegrationError> {
    let pendulum = DoublePendulum::<f64>::default();
    let mut state = State { q: [2.0, 2.5], qd: [0.0; 2] };
    let total = |s: &State<[f64; 2]>| pendulum.kinetic_energy(&s.q, &s.qd) + pendulum.potential_energy(&s.q);
    let start = total(&state);
    let (mut drift, mut largest) = (0.0f64, 0.0f64);
    let motion = accelerations(&pendulum, |_, _, _| []);
    let summary = Dop853::new(rtol, rtol).integrate(motion, 0.0, 100.0, &mut state, |step| {
        largest = largest.max(pendulum.kinetic_energy(&step.state().q, &step.state().qd));
        drift = drift.max((total(step.state()) - start).abs());
        ControlFlow::Continue(())
    })?;
    Ok((drift / largest, summary.evaluations))
}
