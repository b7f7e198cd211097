//! States at which functions are timed, and how: all states in one loop, into which the function is compiled.

use std::hint::black_box;

use divan::Bencher;
use divan::counter::ItemsCount;
use mbs_runtime::{Lanes, wide::f64x4};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// States that one sample goes through; more than fit into the first-level cache.
pub const STATES: usize = 1024;

/// `K` vectors of `N` numbers for each of [`STATES`] states, those of vector k between ∓`most[k]`; the same in every
/// run.
#[must_use]
pub fn states<const N: usize, const K: usize>(most: [f64; K]) -> Vec<[[f64; N]; K]> {
    let mut random = Pcg64::seed_from_u64(20_261_126);
    (0..STATES).map(|_| most.map(|most| std::array::from_fn(|_| random.random_range(-most..most)))).collect()
}

/// The same states, four in lanes.
#[must_use]
pub fn in_lanes<const N: usize, const K: usize>(states: &[[[f64; N]; K]]) -> Vec<[[f64x4; N]; K]> {
    let lanes = |four: &[[[f64; N]; K]]| {
        std::array::from_fn(|k| std::array::from_fn(|i| <f64x4 as Lanes>::from_fn(|lane| four[lane][k][i])))
    };
    states.chunks_exact(f64x4::COUNT).map(lanes).collect()
}

/// Times a function of one state; `items per second` are states.
pub fn each<S, R>(bencher: Bencher<'_, '_>, states: &[S], mut function: impl FnMut(&S) -> R) {
    bencher.counter(ItemsCount::new(STATES)).bench_local(|| {
        for state in states {
            black_box(function(black_box(state)));
        }
    });
}
