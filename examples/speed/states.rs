//! Where everyone computes.

use std::f64::consts::PI;

use mbs_runtime::Lanes;
use mbs_runtime::wide::f64x4;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Angles, rates, and accelerations or torques; of one state or of several in lanes.
pub(crate) struct State<T> {
    pub(crate) q: [T; 6],
    pub(crate) qd: [T; 6],
    pub(crate) qdd: [T; 6],
    pub(crate) tau: [T; 6],
}

/// The same states twice.
pub(crate) struct States {
    pub(crate) one_by_one: Vec<State<f64>>,
    pub(crate) in_lanes: Vec<State<f64x4>>,
}

impl States {
    /// Angles in ±π, rates in ±2, accelerations in ±5, torques in ±100; the same in every run.
    pub(crate) fn random(count: usize) -> States {
        let mut random = Pcg64::seed_from_u64(1);
        let mut six = |most: f64| std::array::from_fn(|_| random.random_range(-most..most));
        let state = |_| State { q: six(PI), qd: six(2.0), qdd: six(5.0), tau: six(100.0) };
        let one_by_one: Vec<State<f64>> = (0..count).map(state).collect();
        let in_lanes = one_by_one.chunks(f64x4::COUNT).map(|states| {
            let pack = |numbers: &dyn Fn(&State<f64>) -> [f64; 6]| {
                std::array::from_fn(|i| <f64x4 as Lanes>::from_fn(|lane| numbers(&states[lane])[i]))
            };
            State { q: pack(&|s| s.q), qd: pack(&|s| s.qd), qdd: pack(&|s| s.qdd), tau: pack(&|s| s.tau) }
        });
        States { in_lanes: in_lanes.collect(), one_by_one }
    }
}
