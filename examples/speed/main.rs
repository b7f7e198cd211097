//! Is the generated code as fast as dynamics that a specialist writes by hand for one robot?
//!
//! The benchmark arm in one process: the generated code, the same customised by hand (`custom_newton_euler`, with its
//! sines one by one; `custom_vector_sines`, with all of them from one call; `custom_lanes`, for four states at once),
//! and the general algorithms in [`featherstone`]. `ns_batch` is generated code for four states at once, a state.
//! Look at the ratios; with `RUSTFLAGS="-C target-cpu=native"` the processor's widest instructions are used. The arms
//! agree to 1e-9 before anything is timed.

mod contenders;
mod custom_lanes;
mod custom_newton_euler;
mod custom_vector_sines;
mod featherstone;
mod states;
mod table;

use contenders::{Entry, of_arm6};
use mbs_examples::contest::{medians, tenths};
use mbs_examples::numbers::apart;
use mbs_examples::{Failure, arguments::Arguments, output};
use serde_json::{Map, Value, json};
use states::States;

/// States that are gone through in a round; more than fit into the first-level cache.
const STATES: usize = 1024;
/// Rounds, in each of which every contender has a turn.
const ROUNDS: usize = 101;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));

    let states = States::random(STATES);
    let mut functions = Map::new();
    for (function, contenders) in of_arm6(&states) {
        agree(function, &contenders, &states)?;
        functions.insert(function.to_string(), timed(contenders));
    }
    let report = json!({ "arm6": functions });
    if let Some(folder) = arguments.folder()? {
        output::write_json(folder, "speed", &report)?;
    }
    let table = table::of(&report["arm6"]);
    arguments.answer(report, &table, &[]);
    Ok(())
}

/// All contenders against the first, to 1e-9 of the largest entry.
fn agree(function: &str, contenders: &[Entry<'_>], states: &States) -> Result<(), Failure> {
    let (first, others) = contenders.split_first().ok_or_else(|| Failure::new("no contenders"))?;
    for other in others {
        for ((found, want), state) in other.results.iter().zip(&first.results).zip(&states.one_by_one) {
            let scale = want.iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
            let difference = apart(found, want);
            // Accelerations are as good as M allows: its condition number reaches 6e4.
            if difference.is_nan() || difference > 1e-9 * scale {
                let (name, q) = (other.timed.name, state.q);
                return Err(Failure::new(format!("{function}: {name} is off by {difference:e} at {q:?}")));
            }
        }
    }
    Ok(())
}

/// In ns a state: of the generated code, one by one and in lanes, and of all others.
fn timed(contenders: Vec<Entry<'_>>) -> Value {
    let medians = medians(contenders.into_iter().map(|entry| entry.timed).collect(), ROUNDS);
    let ns = |seconds: f64| json!(tenths(seconds * 1e9 / STATES as f64));
    let mut rivals: Map<_, _> = medians.into_iter().map(|(name, seconds)| (name.to_string(), ns(seconds))).collect();
    let [ns, ns_batch] = ["mbs", "mbs_batch"].map(|name| rivals.shift_remove(name));
    json!({ "ns": ns, "ns_batch": ns_batch, "rivals": rivals })
}
