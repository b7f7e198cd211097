//! Long runs: what the equations conserve stays what it is.

use mbs_models::double_pendulum::DoublePendulum;
use mbs_models::n_pendulum::NPendulum;
use mbs_runtime::{Dop853, Integrator, Mechanism, State, accelerations};

/// Largest change of `T + V` over the largest T, along a run from rest at `q`.
fn energy_drift<const N: usize>(mechanism: &impl Mechanism<N, 0, Scalar = f64>, q: [f64; N], t_end: f64) -> f64 {
    let energy = |q: &[f64; N], qd: &[f64; N]| {
        let kinetic = mechanism.kinetic_energy(0.0, q, qd);
        (kinetic, kinetic + mechanism.potential_energy(0.0, q))
    };
    let mut state = State { q, qd: [0.0; N] };
    let (_, start) = energy(&state.q, &state.qd);
    let (mut drift, mut largest) = (0.0f64, 0.0f64);
    todo_integrate(mechanism, &mut state, t_end, |q, qd| {
        let (kinetic, total) = energy(q, qd);
        largest = largest.max(kinetic);
        drift = drift.max((total - start).abs());
    });
    drift / largest
}
