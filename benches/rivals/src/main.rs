//! The benchmark arm by other crates, in one process: inverse dynamics that symplex derives from the same energies, and
//! a step of rapier's multibody.
//!
//! `cargo run --release --manifest-path benches/rivals/Cargo.toml`; with `RUSTFLAGS="-C target-cpu=native"` the
//! processor's widest instructions are used. What is timed agrees before: torques to 1e-9, accelerations of a step of
//! a nanosecond to 1e-4 of the largest.

mod numbers;
mod rapier;

use std::hint::black_box;
use std::time::Instant;

use mbs_benches::{STATES, states};
use mbs_models::arm6::Arm6;
use mbs_runtime::{Integrator, SemiImplicitEuler, State};
use numbers::Arm;

mod symplex {
    #![allow(clippy::all, unused_parens, unused_variables, reason = "it is what symplex writes")]
    include!(concat!(env!("OUT_DIR"), "/symplex_arm6.rs"));
}

/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 51;
/// The step that is timed \[s\].
const STEP: f64 = 1e-3;

type Six = [f64; 6];

fn main() {
    let (arm, states) = (Arm6::<f64>::default(), states::<6, 3>([3.0, 2.0, 5.0]));
    let mut world = rapier::World::new(&Arm::read());
    for [q, qd, qdd] in &states {
        let torques = arm.inverse_dynamics(q, qd, qdd);
        agree("symplex", &torques, &by_symplex(q, qd, qdd), 1e-9);
    }
    for [q, qd, _] in &states[..16] {
        let free = arm.forward_dynamics(q, qd, &[0.0; 6]);
        agree("rapier", &free, &world.accelerations(q, qd), 1e-4);
    }

    let inverse: [fn(&Arm6<f64>, &[Six; 3]) -> Six; 2] =
        [|arm, [q, qd, qdd]| arm.inverse_dynamics(q, qd, qdd), |_, [q, qd, qdd]| by_symplex(q, qd, qdd)];
    let mut rounds = [const { Vec::<f64>::new() }; 4];
    for _ in 0..ROUNDS {
        for (function, times) in inverse.iter().zip(&mut rounds) {
            times.push(ns(&states, |state| function(&arm, state)));
        }
        rounds[2].push(ns(&states[..64], |[q, qd, _]| step(&arm, q, qd)));
        rounds[3].push(ns(&states[..64], |[q, qd, _]| world.step(q, qd, STEP)));
    }
    let [mbs, symplex, step, rapier] = rounds.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    });
    println!(
        "inverse dynamics: mbs {mbs:.0} ns, symplex {symplex:.0} ns (mbs {:.2}), derived in {:.2} s",
        mbs / symplex,
        symplex::SECONDS
    );
    println!(
        "a step: mbs {step:.0} ns, rapier {rapier:.0} ns (mbs {:.3}); rapier's looks for contacts, too",
        step / rapier
    );
}

fn by_symplex(q: &Six, qd: &Six, qdd: &Six) -> Six {
    let ([q0, q1, q2, q3, q4, q5], [qd0, qd1, qd2, qd3, qd4, qd5]) = (*q, *qd);
    let [qdd0, qdd1, qdd2, qdd3, qdd4, qdd5] = *qdd;
    symplex::inverse_dynamics(q0, q1, q2, q3, q4, q5, qd0, qd1, qd2, qd3, qd4, qd5, qdd0, qdd1, qdd2, qdd3, qdd4, qdd5)
}

/// One step of the semi-implicit Euler method, which is rapier's, too.
fn step(arm: &Arm6<f64>, q: &Six, qd: &Six) -> Six {
    let mut state = State::new(*q, *qd);
    let free = |_: f64, q: &Six, qd: &Six, qdd: &mut Six| *qdd = arm.forward_dynamics(q, qd, &[0.0; 6]);
    let method = SemiImplicitEuler::new(STEP);
    let done = method.integrate(free, 0.0, STEP, &mut state, |_| std::ops::ControlFlow::Continue(()));
    done.expect("one step from a finite state");
    state.qd
}

/// Two answers, to a tolerance of the largest number.
fn agree(name: &str, ours: &Six, theirs: &Six, tolerance: f64) {
    let scale = ours.iter().fold(1.0, |largest: f64, x| largest.max(x.abs()));
    let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance * scale, "{name} is off by {off:e} of {scale}: {ours:?} {theirs:?}");
}

/// The time of a call, in a round over the states.
fn ns<S, R>(states: &[S], mut call: impl FnMut(&S) -> R) -> f64 {
    let start = Instant::now();
    for state in states {
        black_box(call(black_box(state)));
    }
    start.elapsed().as_secs_f64() * 1e9 / states.len().min(STATES) as f64
}
