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

/// Functions of C as one compiler made them.
struct Build {
    name: &'static str,
    new: unsafe extern "C" fn(),
    inverse_dynamics: unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64),
    mass_matrix: unsafe extern "C" fn(*const f64, *mut f64),
    forward_dynamics: unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64),
}

macro_rules! builds {
    ($($cfg:ident, $name:literal: $new:ident $inverse_dynamics:ident $mass_matrix:ident $forward_dynamics:ident;)*) => {
        $(#[cfg($cfg)]
        unsafe extern "C" {
            fn $new();
            fn $inverse_dynamics(q: *const f64, qd: *const f64, qdd: *const f64, result: *mut f64);
            fn $mass_matrix(q: *const f64, result: *mut f64);
            fn $forward_dynamics(q: *const f64, qd: *const f64, u: *const f64, result: *mut f64);
        })*

        /// Those whose compiler was there when this was built.
        const BUILDS: &[Build] = &[$(
            #[cfg($cfg)]
            Build {
                name: $name,
                new: $new,
                inverse_dynamics: $inverse_dynamics,
                mass_matrix: $mass_matrix,
                forward_dynamics: $forward_dynamics,
            },
        )*];
    };
}

builds! {
    gcc_o2, "gcc -O2": gcc_o2_new gcc_o2_inverse_dynamics gcc_o2_mass_matrix gcc_o2_forward_dynamics;
    gcc_o3, "gcc -O3": gcc_o3_new gcc_o3_inverse_dynamics gcc_o3_mass_matrix gcc_o3_forward_dynamics;
    clang_o2, "clang -O2": clang_o2_new clang_o2_inverse_dynamics clang_o2_mass_matrix clang_o2_forward_dynamics;
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

/// Writes the results at a state.
type Way<'a, const M: usize> = &'a dyn Fn(&State, &mut [f64; M]);

/// The least time for one call of each \[ns\], in turn.
fn least<const M: usize>(states: &[State], ways: &[Way<'_, M>]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; ways.len()];
    let mut result = [0.0; M];
    for _ in 0..ROUNDS {
        for (least, way) in least.iter_mut().zip(ways) {
            let start = Instant::now();
            for state in states {
                way(black_box(state), &mut result);
                black_box(&result);
            }
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / states.len() as f64);
        }
    }
    least
}

/// Compares the results of Rust, which is first, and of every build of C, and says what they cost.
fn report<const M: usize>(states: &[State], name: &str, ways: &[Way<'_, M>]) {
    let times = least(states, ways);
    println!("{name:16} {:7.1} ns in Rust", times[0]);
    for ((build, way), time) in BUILDS.iter().zip(&ways[1..]).zip(&times[1..]) {
        let (mut equal, mut worst) = (0, 0.0_f64);
        for state in states {
            let (mut a, mut b) = ([0.0; M], [0.0; M]);
            ways[0](state, &mut a);
            way(state, &mut b);
            let size = a.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            equal += usize::from(a.map(f64::to_bits) == b.map(f64::to_bits));
            worst = a.iter().zip(&b).fold(worst, |worst, (a, b)| worst.max((a - b).abs() / size));
        }
        assert!(worst < 1e-9, "{name}: {worst}");
        let (ratio, share) = (time / times[0], 100.0 * equal as f64 / states.len() as f64);
        println!("  {:14} {time:7.1} ns in C: {ratio:.3} of Rust's; {share:.0} % the same bits", build.name);
    }
}

fn main() {
    // SAFETY: each writes a variable of its own, before anything reads it.
    BUILDS.iter().for_each(|build| unsafe { (build.new)() });
    let arm: Arm6 = Arm6::new(Params::default());
    let states = states(STATES);

    // SAFETY of all calls: pointers to as many numbers as the functions read and write.
    let inverse_dynamics = BUILDS.iter().map(|build| {
        |s: &State, result: &mut [f64; 6]| unsafe {
            (build.inverse_dynamics)(s.q.as_ptr(), s.qd.as_ptr(), s.w.as_ptr(), result.as_mut_ptr());
        }
    });
    let mass_matrix = BUILDS.iter().map(|build| {
        |s: &State, result: &mut [f64; 36]| unsafe { (build.mass_matrix)(s.q.as_ptr(), result.as_mut_ptr()) }
    });
    let forward_dynamics = BUILDS.iter().map(|build| {
        |s: &State, result: &mut [f64; 6]| unsafe {
            (build.forward_dynamics)(s.q.as_ptr(), s.qd.as_ptr(), s.w.as_ptr(), result.as_mut_ptr());
        }
    });
    let (inverse_dynamics, mass_matrix, forward_dynamics): (Vec<_>, Vec<_>, Vec<_>) =
        (inverse_dynamics.collect(), mass_matrix.collect(), forward_dynamics.collect());

    let rust = |s: &State, result: &mut [f64; 6]| *result = arm.inverse_dynamics(&s.q, &s.qd, &s.w);
    let mut ways: Vec<Way<'_, 6>> = vec![&rust];
    ways.extend(inverse_dynamics.iter().map(|way| way as Way<'_, 6>));
    report(&states, "inverse_dynamics", &ways);

    let rust = |s: &State, result: &mut [f64; 36]| result.copy_from_slice(arm.mass_matrix(&s.q).as_flattened());
    let mut ways: Vec<Way<'_, 36>> = vec![&rust];
    ways.extend(mass_matrix.iter().map(|way| way as Way<'_, 36>));
    report(&states, "mass_matrix", &ways);

    let rust = |s: &State, result: &mut [f64; 6]| *result = arm.forward_dynamics(&s.q, &s.qd, &s.w);
    let mut ways: Vec<Way<'_, 6>> = vec![&rust];
    ways.extend(forward_dynamics.iter().map(|way| way as Way<'_, 6>));
    report(&states, "forward_dynamics", &ways);
    #[cfg(feature = "opencl")]
    device::report(&arm);
}
