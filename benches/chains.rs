//! Chains of 5 to 200 links in space: inverse dynamics, and forward dynamics by articulated bodies where they
//! need fewer operations; beside the general algorithms of Featherstone on nalgebra.
//!
//! `cargo bench -p mbs-benches --bench chains`; `items` are states. `growth` times the same, and checks that they
//! agree.

#[path = "../examples/speed/featherstone.rs"]
#[expect(dead_code, reason = "`speed` times more of its algorithms")]
mod featherstone;

use divan::Bencher;
use featherstone::Model;
use mbs_benches::{each, states};
use mbs_examples::chains;

fn main() {
    divan::main();
}

/// Angles, rates, and accelerations or torques.
const MOST: [f64; 3] = [3.0, 1.0, 2.0];

/// One chain of all contenders.
macro_rules! chain {
    ($module:ident, $links:literal) => {
        mod $module {
            use super::{Bencher, MOST, chains, each, states};

            #[divan::bench]
            fn inverse_dynamics_mbs(bencher: Bencher<'_, '_>) {
                let chain = chains::$module::NChain::<f64>::default();
                each(bencher, &states::<$links, 3>(MOST), move |[q, qd, qdd]| chain.inverse_dynamics(q, qd, qdd));
            }

            #[divan::bench]
            fn inverse_dynamics_featherstone(bencher: Bencher<'_, '_>) {
                let mut model = super::general($links);
                each(bencher, &states::<$links, 3>(MOST), move |[q, qd, qdd]| model.inverse_dynamics(q, qd, Some(qdd)));
            }

            #[divan::bench]
            fn forward_dynamics_mbs(bencher: Bencher<'_, '_>) {
                let chain = chains::$module::NChain::<f64>::default();
                each(bencher, &states::<$links, 3>(MOST), move |[q, qd, tau]| chain.forward_dynamics(q, qd, tau));
            }

            #[divan::bench]
            fn forward_dynamics_featherstone(bencher: Bencher<'_, '_>) {
                let mut model = super::general($links);
                each(bencher, &states::<$links, 3>(MOST), move |[q, qd, tau]| model.forward_dynamics(q, qd, tau));
            }
        }
    };
}

chain!(five, 5);
chain!(ten, 10);
chain!(twenty, 20);
chain!(forty, 40);
chain!(fifty, 50);
chain!(two_hundred, 200);

/// As many hinges, one like the other; the general algorithms take the same time for all numbers.
fn general(links: usize) -> Model {
    let inertia = [0.0083, 0.0211, 0.0204, 0.0009, -0.0007, 0.0006];
    Model::serial(&vec![([0.04, 0.23, 0.8], 1.4, [0.11, -0.02, 0.03], inertia); links], 9.81)
}
