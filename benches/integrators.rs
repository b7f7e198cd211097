//! DOP853 of this crate and of others, with their defaults but for the tolerances: one period of the Arenstorf orbit.
//!
//! `cargo bench -p mbs-benches --bench integrators`; `work_precision` has the errors and evaluations of these runs.

use divan::Bencher;
use mbs_examples::work_precision::arenstorf;

fn main() {
    divan::main();
}

#[divan::bench(args = [1e-6, 1e-9, 1e-12])]
fn mbs_runtime(bencher: Bencher<'_, '_>, tolerance: f64) {
    time(bencher, "mbs_runtime", tolerance);
}

#[divan::bench(args = [1e-6, 1e-9, 1e-12])]
fn ode_solvers(bencher: Bencher<'_, '_>, tolerance: f64) {
    time(bencher, "ode_solvers", tolerance);
}

#[divan::bench(args = [1e-6, 1e-9, 1e-12])]
fn differential_equations(bencher: Bencher<'_, '_>, tolerance: f64) {
    time(bencher, "differential-equations", tolerance);
}

fn time(bencher: Bencher<'_, '_>, of: &str, tolerance: f64) {
    bencher.bench(|| arenstorf(of, tolerance).unwrap_or_else(|error| panic!("{of}: {error}")));
}
