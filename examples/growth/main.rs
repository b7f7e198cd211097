//! How do equations grow with the number of links?
//!
//! Chains of 5 to 200 links about skew axes (`tests/mechanisms/n_chain.mbs`): how long it takes to derive and prove
//! inverse and forward dynamics, how long the generated code is, and how long a call takes, beside the general
//! algorithms of [`featherstone`] on nalgebra for as many hinges. Look at what a further link costs: the same whether
//! it is the tenth or the two hundredth, and of code no more than numbers in tables.

#[path = "../speed/featherstone.rs"]
#[expect(dead_code, reason = "`speed` times more of its algorithms")]
mod featherstone;
mod summary;

use std::time::Instant;

use featherstone::Model;
use mbs_examples::chains::{CHAIN, Chain, fifty, five, forty, ten, twenty, two_hundred};
use mbs_examples::contest::{Contender, medians};
use mbs_examples::numbers::apart;
use mbs_examples::{Failure, arguments::Arguments, output};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use summary::Growth;

/// The functions that are derived.
const FUNCTIONS: [&str; 2] = ["inverse_dynamics", "forward_dynamics"];
/// States that are gone through in a round.
const STATES: usize = 64;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 31;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));

    let chains = [
        growth(five::NChain::default())?,
        growth(ten::NChain::default())?,
        growth(twenty::NChain::default())?,
        growth(forty::NChain::default())?,
        growth(fifty::NChain::default())?,
        growth(two_hundred::NChain::default())?,
    ];
    let report = summary::json(&chains);
    if let Some(folder) = arguments.folder()? {
        output::write_json(folder, "growth", &report)?;
    }
    arguments.answer(report, &summary::table(&chains), &[]);
    Ok(())
}

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
    // What inverse dynamics asks for moves the chain so.
    for [q, qd, qdd] in &states {
        let off = apart(&chain.forward_dynamics(q, qd, &chain.inverse_dynamics(q, qd, qdd)), qdd);
        if off.is_nan() || off > 1e-6 {
            return Err(Failure::new(format!("a chain of {N} links accelerates by {off:e} more than it should")));
        }
    }
    let [mut inverse, mut forward] = [general::<N>(), general::<N>()];
    let contenders = vec![
        Contender::new("inverse", &states, |[q, qd, qdd]| chain.inverse_dynamics(q, qd, qdd)),
        Contender::new("forward", &states, |[q, qd, tau]| chain.forward_dynamics(q, qd, tau)),
        Contender::new("general_inverse", &states, move |[q, qd, qdd]| inverse.inverse_dynamics(q, qd, Some(qdd))),
        Contender::new("general_forward", &states, move |[q, qd, tau]| forward.forward_dynamics(q, qd, tau)),
    ];
    let times = medians(contenders, ROUNDS);
    let ns = |k: usize| times[k].1 * 1e9 / STATES as f64;
    let (ns, general_ns) = ([ns(0), ns(1)], [ns(2), ns(3)]);
    Ok(Growth { n: N, ns, general_ns, derive_seconds, emitted_bytes: generated.code.len() })
}

/// As many hinges, one like the other; the general algorithms take the same time for all numbers.
fn general<const N: usize>() -> Model {
    let inertia = [0.0083, 0.0211, 0.0204, 0.0009, -0.0007, 0.0006];
    Model::serial(&[([0.04, 0.23, 0.8], 1.4, [0.11, -0.02, 0.03], inertia); N], 9.81)
}
