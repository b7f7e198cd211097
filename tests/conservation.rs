//! Long runs: what the equations conserve stays what it is.

use std::ops::ControlFlow;

use mbs_models::double_pendulum::DoublePendulum;
use mbs_models::heavy_top::HeavyTop;
use mbs_models::n_pendulum::NPendulum;
use mbs_runtime::{Dop853, Integrator, Mechanism, State, accelerations};

/// Largest change of `T + V` over the largest T, at the accepted steps of a run.
fn energy_drift<const N: usize>(
    mechanism: &impl Mechanism<N, 0, Scalar = f64>,
    start: State<[f64; N]>,
    t_end: f64,
) -> f64 {
    let kinetic = |s: &State<[f64; N]>| mechanism.kinetic_energy(0.0, &s.q, &s.qd);
    let total = |s: &State<[f64; N]>| kinetic(s) + mechanism.potential_energy(0.0, &s.q);
    let (mut drift, mut largest) = (0.0f64, 0.0f64);
    let mut state = start;
    let motion = accelerations(mechanism, |_, _, _| []);
    let summary = Dop853::new(1e-12, 1e-12).integrate(motion, 0.0, t_end, &mut state, |step| {
        largest = largest.max(kinetic(step.state()));
        drift = drift.max((total(step.state()) - total(&start)).abs());
        ControlFlow::Continue(())
    });
    assert_eq!(summary.expect("a smooth motion").time, t_end);
    drift / largest
}

#[test]
fn double_pendulum_keeps_its_energy_over_100_seconds() {
    let drift = energy_drift(&DoublePendulum::<f64>::default(), State { q: [2.0, 2.5], qd: [0.0; 2] }, 100.0);
    assert!(drift <= 1e-9, "{drift:e}");
}

#[test]
fn ten_links_keep_their_energy_over_10_seconds() {
    let q = std::array::from_fn(|i| 0.5 + 0.1 * i as f64);
    let drift = energy_drift(&NPendulum::<f64>::default(), State { q, qd: [0.0; 10] }, 10.0);
    assert!(drift <= 1e-10, "{drift:e}");
}

/// A fast top keeps its energy and both momenta, which the generator found by itself.
#[test]
fn heavy_top_keeps_its_momenta() {
    let top = HeavyTop::<f64>::default();
    assert_eq!(mbs_models::heavy_top::CONSERVED, ["energy_integral", "p_phi", "p_psi"]);
    let start = State { q: [0.0, 0.4, 0.0], qd: [0.0, 0.0, 200.0] };
    let mut state = start;
    let motion = accelerations(&top, |_, _, _| []);
    let run = Dop853::new(1e-12, 1e-12).integrate(motion, 0.0, 5.0, &mut state, |_| ControlFlow::Continue(()));
    run.expect("a smooth motion");
    let [before, after] = [start, state].map(|s| top.conserved(&s.q, &s.qd));
    for (a, b) in before.iter().zip(&after) {
        assert!((a - b).abs() <= 1e-10 * a.abs(), "{before:?} {after:?}");
    }
}
