//! How do equations grow with the number of links?
//!
//! Chains of 5 to 200 links about skew axes (`tests/mechanisms/n_chain.mbs`): how long it takes to derive and prove
//! inverse and forward dynamics, how long the generated code is, and how long a call takes, beside the general
//! algorithms of [`featherstone`] on nalgebra for as many hinges. Look at what a further link costs: the same whether
//! it is the tenth or the two hundredth, and of code no more than numbers in tables.

#[path = "speed/featherstone.rs"]
#[expect(dead_code, reason = "`speed` times more of its algorithms")]
mod featherstone;

use std::hint::black_box;
use std::time::Instant;

use featherstone::Model;
use mbs_examples::arguments::Arguments;
use mbs_examples::chains::{self, CHAIN};
use mbs_examples::{Failure, output, print, println};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::{Value, json};

/// The functions that are derived.
const FUNCTIONS: [&str; 2] = ["inverse_dynamics", "forward_dynamics"];
/// States that are gone through in a round.
const STATES: usize = 64;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 31;

/// One chain.
struct Growth {
    n: usize,
    /// Inverse and forward dynamics, generated.
    ns: [f64; 2],
    /// By the general algorithms.
    general_ns: [f64; 2],
    derive_seconds: f64,
    emitted_bytes: usize,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("growth.rs"));

    let chains = [
        growth(chains::five::NChain::<f64>::default())?,
        growth(chains::ten::NChain::<f64>::default())?,
        growth(chains::twenty::NChain::<f64>::default())?,
        growth(chains::forty::NChain::<f64>::default())?,
        growth(chains::fifty::NChain::<f64>::default())?,
        growth(chains::two_hundred::NChain::<f64>::default())?,
    ];
    let report = json!({ "n_chain": chains.iter().map(Growth::to_json).collect::<Vec<_>>() });
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
        std::fs::write(folder.join("growth.json"), format!("{report}\n"))?;
    }
    if arguments.json {
        println!("{report}");
    } else {
        print!("{}", table(&chains));
    }
    Ok(())
}

/// What the generated code of a chain of N links does.
trait Chain<const N: usize> {
    fn inverse_dynamics(&self, q: &[f64; N], qd: &[f64; N], qdd: &[f64; N]) -> [f64; N];
    fn forward_dynamics(&self, q: &[f64; N], qd: &[f64; N], tau: &[f64; N]) -> [f64; N];
}

macro_rules! chain {
    ($module:ident, $n:literal) => {
        impl Chain<$n> for chains::$module::NChain<f64> {
            fn inverse_dynamics(&self, q: &[f64; $n], qd: &[f64; $n], qdd: &[f64; $n]) -> [f64; $n] {
                self.inverse_dynamics(q, qd, qdd)
            }
            fn forward_dynamics(&self, q: &[f64; $n], qd: &[f64; $n], tau: &[f64; $n]) -> [f64; $n] {
                self.forward_dynamics(q, qd, tau)
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

/// Derives a chain once more, and times what was generated of it when this program was built.
fn growth<const N: usize>(chain: impl Chain<N>) -> Result<Growth, Failure> {
    let text = CHAIN.replace("const n = 5;", &format!("const n = {N};"));
    let start = Instant::now();
    let options = mbs_derive::emit::Options::default().functions(FUNCTIONS);
    let generated = mbs_derive::generate("n_chain.mbs", &text, &options);
    let generated = generated.map_err(|error| Failure::new(error.render("n_chain.mbs", &text)))?;
    let derive_seconds = start.elapsed().as_secs_f64();

    let mut random = Pcg64::seed_from_u64(N as u64);
    let mut numbers = |most: f64| -> [f64; N] { std::array::from_fn(|_| random.random_range(-most..most)) };
    let states: Vec<[[f64; N]; 3]> = (0..STATES).map(|_| [numbers(3.0), numbers(1.0), numbers(2.0)]).collect();
    let mut model = general::<N>();
    // What inverse dynamics asks for moves the chain so.
    for [q, qd, qdd] in &states {
        let moved = chain.forward_dynamics(q, qd, &chain.inverse_dynamics(q, qd, qdd));
        let off = moved.iter().zip(qdd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if off.is_nan() || off > 1e-6 {
            return Err(Failure::new(format!("a chain of {N} links accelerates by {off:e} more than it should")));
        }
    }
    let mut rounds: [Vec<f64>; 4] = Default::default();
    for _ in 0..ROUNDS {
        let [inverse, forward, general_inverse, general_forward] = &mut rounds;
        inverse.push(ns(&states, |[q, qd, qdd]| chain.inverse_dynamics(q, qd, qdd)));
        forward.push(ns(&states, |[q, qd, tau]| chain.forward_dynamics(q, qd, tau)));
        general_inverse.push(ns(&states, |[q, qd, qdd]| model.inverse_dynamics(q, qd, Some(qdd))));
        general_forward.push(ns(&states, |[q, qd, tau]| model.forward_dynamics(q, qd, tau)));
    }
    let [inverse, forward, general_inverse, general_forward] = rounds.map(|mut round| {
        round.sort_by(f64::total_cmp);
        round[ROUNDS / 2]
    });
    Ok(Growth {
        n: N,
        ns: [inverse, forward],
        general_ns: [general_inverse, general_forward],
        derive_seconds,
        emitted_bytes: generated.code.len(),
    })
}

/// The time of a call, in a round over all states.
fn ns<const N: usize>(states: &[[[f64; N]; 3]], mut call: impl FnMut(&[[f64; N]; 3]) -> [f64; N]) -> f64 {
    let start = Instant::now();
    for state in states {
        black_box(call(black_box(state)));
    }
    start.elapsed().as_secs_f64() * 1e9 / STATES as f64
}

/// As many hinges, one like the other; the general algorithms take the same time for all numbers.
fn general<const N: usize>() -> Model {
    let inertia = [0.0083, 0.0211, 0.0204, 0.0009, -0.0007, 0.0006];
    Model::serial(&[([0.04, 0.23, 0.8], 1.4, [0.11, -0.02, 0.03], inertia); N], 9.81)
}

impl Growth {
    fn to_json(&self) -> Value {
        let [inverse, forward] = self.ns;
        let [general_inverse, general_forward] = self.general_ns;
        json!({
            "n": self.n,
            "inverse_dynamics_ns": inverse,
            "forward_dynamics_ns": forward,
            "derive_seconds": self.derive_seconds,
            "emitted_bytes": self.emitted_bytes,
            "rivals": { "featherstone_nalgebra": {
                "inverse_dynamics_ns": general_inverse,
                "forward_dynamics_ns": general_forward,
            } },
        })
    }
}

fn table(chains: &[Growth]) -> String {
    let mut text = format!(
        "{:>5} {:>34} {:>34} {:>8} {:>9}\n",
        "links", "inverse dynamics, ns (Featherstone)", "forward dynamics, ns (Featherstone)", "derive s", "bytes"
    );
    for Growth { n, ns, general_ns, derive_seconds, emitted_bytes } in chains {
        let [inverse, forward] =
            [0, 1].map(|i| format!("{:.0} ({:.2} of {:.0})", ns[i], ns[i] / general_ns[i], general_ns[i]));
        text += &format!("{n:5} {inverse:>35} {forward:>35} {derive_seconds:8.2} {emitted_bytes:9}\n");
    }
    text
}
