//! The reference systems: what a simulation, a controller and a filter call.
//!
//! `cargo bench -p mbs-benches --bench mechanisms`; `items` are states.

use divan::Bencher;
use mbs_benches::{each, states};
use mbs_models::four_bar::FourBar;
use mbs_models::irb7600::Irb7600;
use mbs_models::quadrotor_quaternion::QuadrotorQuaternion;
use mbs_models::stewart_platform::StewartPlatform;

fn main() {
    divan::main();
}

/// Functions of q, q̇ and a third vector, of a mechanism whose coordinates are each other's equals.
macro_rules! mechanism {
    ($module:ident, $mechanism:ident, $most:expr) => {
        mod $module {
            use super::{Bencher, each, shifted, $mechanism};

            #[divan::bench]
            fn inverse_dynamics(bencher: Bencher<'_, '_>) {
                let model = $mechanism::<f64>::default();
                each(bencher, &shifted($most), move |[q, qd, qdd]| model.inverse_dynamics(q, qd, qdd));
            }

            #[divan::bench]
            fn forward_dynamics(bencher: Bencher<'_, '_>) {
                let model = $mechanism::<f64>::default();
                each(bencher, &shifted($most), move |[q, qd, u]| model.forward_dynamics(q, qd, u));
            }

            #[divan::bench]
            fn linearize(bencher: Bencher<'_, '_>) {
                let model = $mechanism::<f64>::default();
                each(bencher, &shifted($most), move |[q, qd, u]| model.linearize(q, qd, u));
            }
        }
    };
}

mechanism!(irb7600, Irb7600, ([0.0; 6], [3.0, 2.0, 100.0]));
// About its home position, a metre up.
mechanism!(stewart_platform, StewartPlatform, ([0.0, 0.0, 1.2, 0.0, 0.0, 0.0], [0.1, 0.5, 100.0]));

/// Random vectors, the first of each state about `middle`.
fn shifted<const N: usize>((middle, most): ([f64; N], [f64; 3])) -> Vec<[[f64; N]; 3]> {
    let mut states = states(most);
    for [q, ..] in &mut states {
        q.iter_mut().zip(middle).for_each(|(q, middle)| *q += middle);
    }
    states
}

/// One constraint: the length of the quaternion.
mod quadrotor_quaternion {
    use super::{Bencher, QuadrotorQuaternion, each, states};

    #[divan::bench]
    fn forward_dynamics(bencher: Bencher<'_, '_>) {
        let model = QuadrotorQuaternion::<f64>::default();
        let states: Vec<_> = states::<7, 2>([1.0, 1.0]).into_iter().map(of_length_one).collect();
        let (wind, rotors) = ([[0.0; 3]; 3], [300.0; 4]);
        each(bencher, &states, move |[q, qd]| model.forward_dynamics(&wind, q, qd, &rotors));
    }

    /// With a quaternion of length one, and rates that keep it so.
    fn of_length_one([mut q, mut qd]: [[f64; 7]; 2]) -> [[f64; 7]; 2] {
        let length = q[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
        q[3..].iter_mut().for_each(|x| *x /= length);
        let along: f64 = q[3..].iter().zip(&qd[3..]).map(|(x, rate)| x * rate).sum();
        qd[3..].iter_mut().zip(&q[3..]).for_each(|(rate, x)| *rate -= along * x);
        [q, qd]
    }
}

/// A closed chain: two constraints.
mod four_bar {
    use super::{Bencher, FourBar, each, states};

    #[divan::bench]
    fn forward_dynamics(bencher: Bencher<'_, '_>) {
        let model = FourBar::<f64>::default();
        each(bencher, &states([3.0, 2.0]), move |[q, qd]| model.forward_dynamics(q, qd, &[1.0]));
    }
}
