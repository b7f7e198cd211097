//! The benchmark arm: generated code, the same customised by hand, and general algorithms; one state a call, and four
//! in lanes.
//!
//! `cargo bench -p mbs-benches --bench arm6`; `items` are states. The example `speed` times the same functions in
//! turns, and checks that they agree.

// As in `speed`, the contenders are compiled with the program, so that each is inlined alike.
#[path = "../examples/speed/custom_lanes.rs"]
mod custom_lanes;
#[path = "../examples/speed/custom_newton_euler.rs"]
mod custom_newton_euler;
#[path = "../examples/speed/custom_vector_sines.rs"]
mod custom_vector_sines;

use mbs_benches::{each, in_lanes, states};
use mbs_models::arm6::Arm6;
use mbs_models::arm6_params::Arm6Params;
use mbs_runtime::wide::f64x4;

fn main() {
    divan::main();
}

/// One function of all contenders.
macro_rules! function {
    ($function:ident($($argument:ident),+), $most:expr) => {
        mod $function {
            use divan::Bencher;

            use super::{Arm6, Arm6Params, custom_lanes, custom_newton_euler, custom_vector_sines, each, f64x4, in_lanes, states};

            #[divan::bench]
            fn mbs(bencher: Bencher<'_, '_>) {
                let arm = Arm6::<f64>::default();
                each(bencher, &states($most), move |[$($argument),+]| arm.$function($($argument),+));
            }

            #[divan::bench]
            fn mbs_numbers_at_run_time(bencher: Bencher<'_, '_>) {
                let arm = Arm6Params::<f64>::default();
                each(bencher, &states($most), move |[$($argument),+]| arm.$function($($argument),+));
            }

            #[divan::bench]
            fn mbs_batch(bencher: Bencher<'_, '_>) {
                let arm = Arm6::<f64x4>::default();
                each(bencher, &in_lanes(&states($most)), move |[$($argument),+]| arm.$function($($argument),+));
            }

            #[divan::bench]
            fn custom_newton_euler(bencher: Bencher<'_, '_>) {
                each(bencher, &states($most), |[$($argument),+]| custom_newton_euler::arm::$function($($argument),+));
            }

            #[divan::bench]
            fn custom_vector_sines(bencher: Bencher<'_, '_>) {
                each(bencher, &states($most), |[$($argument),+]| custom_vector_sines::arm::$function($($argument),+));
            }

            #[divan::bench]
            fn custom_lanes(bencher: Bencher<'_, '_>) {
                each(bencher, &in_lanes(&states($most)), |[$($argument),+]| custom_lanes::arm::$function($($argument),+));
            }
        }
    };
}

function!(inverse_dynamics(q, qd, qdd), [3.0, 2.0, 5.0]);
function!(bias(q, qd), [3.0, 2.0]);
function!(mass_matrix(q), [3.0]);
function!(forward_dynamics(q, qd, tau), [3.0, 2.0, 100.0]);
