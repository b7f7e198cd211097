//! What a function of the six-joint arm costs in Rust and in C, in one process; with the feature `opencl` also what the
//! kernels of OpenCL do a second, against rayon.
//!
//! ```sh
//! cargo run --release --manifest-path examples/c_cost/Cargo.toml --features opencl
//! ```
//!
//! Each number is the best of many rounds, in which Rust and C take turns. Results are compared as well.

use std::hint::black_box;
use std::time::Instant;

include!(concat!(env!("OUT_DIR"), "/arm6.rs"));

use arm6::{Arm6, Params};

#[cfg(feature = "opencl")]
mod device;

const N: usize = 6;
const STATES: usize = 1000;
const ROUNDS: usize = 200;

/// A state, and what acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) q: [f64; N],
    pub(crate) qd: [f64; N],
    pub(crate) w: [f64; N],
}

unsafe extern "C" {
    fn c_new();
    fn c_inverse_dynamics(q: *const f64, qd: *const f64, qdd: *const f64, result: *mut f64);
    fn c_mass_matrix(q: *const f64, result: *mut f64);
    fn c_forward_dynamics(q: *const f64, qd: *const f64, u: *const f64, result: *mut f64);
}

/// States of a sequence without pattern, between −2 and 2.
pub(crate) fn states(count: usize) -> Vec<State> {
    let mut bits = 18_u64;
    let mut next = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1_u64 << 53) as f64 * 4.0 - 2.0
    };
    let mut numbers = || std::array::from_fn(|_| next());
    (0..count).map(|_| State { q: numbers(), qd: numbers(), w: numbers() }).collect()
}

/// The least time for one call of each \[ns\], in turn.
fn least(states: &[State], ways: [&dyn Fn(&State) -> f64; 2]) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (least, way) in least.iter_mut().zip(ways) {
            let start = Instant::now();
            states.iter().for_each(|state| {
                black_box(way(black_box(state)));
            });
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / states.len() as f64);
        }
    }
    least
}

fn main() {
    // SAFETY: it writes a variable of its own, before anything reads it.
    unsafe { c_new() };
    let arm: Arm6 = Arm6::new(Params::default());
    let states = states(STATES);
    type Way<'a, const M: usize> = (&'a str, &'a dyn Fn(&State) -> [f64; M], &'a dyn Fn(&State) -> [f64; M]);

    fn report<const M: usize>(states: &[State], (name, rust, c): Way<'_, M>) {
        let mut worst = 0.0_f64;
        let mut equal = 0;
        for state in states {
            let (a, b) = (rust(state), c(state));
            let size = a.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            equal += usize::from(a.map(f64::to_bits) == b.map(f64::to_bits));
            worst = a.iter().zip(&b).fold(worst, |worst, (a, b)| worst.max((a - b).abs() / size));
        }
        assert!(worst < 1e-9, "{name}: {worst}");
        let sum = |x: [f64; M]| x.iter().sum();
        let [own, other] = least(states, [&|state| sum(rust(state)), &|state| sum(c(state))]);
        let share = 100.0 * equal as f64 / states.len() as f64;
        println!("{name:18} {own:7.1} ns in Rust, {other:7.1} ns in C: {:.3}; {share:.0} % the same bits", other / own);
    }

    // SAFETY of all calls: pointers to as many numbers as the functions read and write.
    report::<6>(
        &states,
        ("inverse_dynamics", &|s| arm.inverse_dynamics(&s.q, &s.qd, &s.w), &|s| {
            let mut result = [0.0; 6];
            unsafe { c_inverse_dynamics(s.q.as_ptr(), s.qd.as_ptr(), s.w.as_ptr(), result.as_mut_ptr()) };
            result
        }),
    );
    report::<36>(
        &states,
        (
            "mass_matrix",
            &|s| {
                let mut all = [0.0; 36];
                all.copy_from_slice(arm.mass_matrix(&s.q).as_flattened());
                all
            },
            &|s| {
                let mut result = [0.0; 36];
                unsafe { c_mass_matrix(s.q.as_ptr(), result.as_mut_ptr()) };
                result
            },
        ),
    );
    report::<6>(
        &states,
        ("forward_dynamics", &|s| arm.forward_dynamics(&s.q, &s.qd, &s.w), &|s| {
            let mut result = [0.0; 6];
            unsafe { c_forward_dynamics(s.q.as_ptr(), s.qd.as_ptr(), s.w.as_ptr(), result.as_mut_ptr()) };
            result
        }),
    );
    #[cfg(feature = "opencl")]
    device::report(&arm);
}
