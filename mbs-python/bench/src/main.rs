//! `bench THREADS`: forward dynamics, inverse dynamics and mass matrix of arm6 at 10 000 states, nanoseconds for each.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;

mbs_runtime::include_mechanism!("arm6");
use arm6::Arm6;

const STATES: usize = 10_000;

fn main() {
    let threads = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(1);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().expect("it is built once");
    let arm = Arm6::new(arm6::Params::default());
    let number = |i: usize| ((i * 2_654_435_761) % 1_000_003) as f64 / 500_001.5 - 1.0;
    let states = |kind: usize| -> Vec<[f64; 6]> {
        (0..STATES).map(|i| std::array::from_fn(|j| number(18 * i + 6 * kind + j))).collect()
    };
    let [q, qd, u] = [states(0), states(1), states(2)];
    report("forward_dynamics", || each(&q, &qd, &u, |q, qd, u| arm.forward_dynamics(q, qd, u)));
    report("inverse_dynamics", || each(&q, &qd, &u, |q, qd, u| arm.inverse_dynamics(q, qd, u)));
    report("mass_matrix", || each(&q, &qd, &u, |q, _, _| arm.mass_matrix(q)));
}

/// A new array of results, as Python gets one.
fn each<R: Send + Copy + Default>(
    q: &[[f64; 6]],
    qd: &[[f64; 6]],
    u: &[[f64; 6]],
    f: impl Fn(&[f64; 6], &[f64; 6], &[f64; 6]) -> R + Sync,
) {
    let mut results = vec![R::default(); STATES];
    if rayon::current_num_threads() == 1 {
        results.iter_mut().enumerate().for_each(|(i, result)| *result = f(&q[i], &qd[i], &u[i]));
    } else {
        results.par_iter_mut().with_min_len(256).enumerate().for_each(|(i, result)| *result = f(&q[i], &qd[i], &u[i]));
    }
    black_box(&results);
}

/// The best of many runs.
fn report(name: &str, run: impl Fn()) {
    let best = (0..60).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    });
    println!("{name} {:.2}", best.fold(f64::INFINITY, f64::min) / STATES as f64 * 1e9);
}
