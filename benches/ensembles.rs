//! Many motions at once: 4096 double pendulums for two seconds, one after the other or four in lanes, by the method
//! with fixed steps and by the one with error control of each lane's own.
//!
//! `cargo bench -p mbs-benches --bench ensembles`; `items` are motions. With `--features rayon` blocks go to all cores.

use divan::Bencher;
use divan::counter::ItemsCount;
use mbs_benches::states;
use mbs_models::double_pendulum::DoublePendulum;
use mbs_runtime::wide::f64x4;
use mbs_runtime::{Dop853, Ensemble, EnsembleIntegrator, Lanes, Rk4, Scalar, State, accelerations};

fn main() {
    divan::main();
}

/// Four times as many motions as states are timed elsewhere.
const MOTIONS: usize = 4 * mbs_benches::STATES;

#[divan::bench(types = [f64, f64x4])]
fn rk4<L: Lanes + Scalar + Send + Sync>(bencher: Bencher<'_, '_>)
where
    L::Real: From<f64>,
{
    motions::<L>(bencher, &Rk4::new(1e-2));
}

#[divan::bench(types = [f64, f64x4])]
fn dop853<L: Lanes + Scalar + Send + Sync>(bencher: Bencher<'_, '_>)
where
    L::Real: From<f64>,
{
    motions::<L>(bencher, &Dop853::new(1e-9, 1e-9));
}

fn motions<L: Lanes + Scalar + Send + Sync>(bencher: Bencher<'_, '_>, method: &impl EnsembleIntegrator)
where
    L::Real: From<f64>,
{
    let starts = states::<2, 2>([1.0, 1.0]).into_iter().cycle().take(MOTIONS);
    let starts: Vec<_> = starts.map(|[q, qd]| State::new(q.map(L::Real::from), qd.map(L::Real::from))).collect();
    bencher.counter(ItemsCount::new(MOTIONS)).with_inputs(|| Ensemble::<L, 2>::new(starts.iter().copied())).bench_refs(
        |pendulums| {
            pendulums.integrate(method, 0.0, 2.0, |_| {
                let pendulum = DoublePendulum::<L>::default();
                move |t, q: &_, qd: &_, qdd: &mut _| accelerations(&pendulum, |_, _, _| [])(t, q, qd, qdd)
            })
        },
    );
}
