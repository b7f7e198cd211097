//! A mechanism of a thousand bodies: derived, proved, printed in loops over its links, compiled, run.

use std::fs;

use super::downstream::{Downstream, text};

/// Links of the chain.
const LINKS: usize = 1000;

/// Accelerations, what they take, and whether that gives them back, on a stack of a mebibyte.
const PROGRAM: &str = "
include!(\"chain.rs\");

const LINKS: usize = 1000;

fn numbers(most: f64, seed: f64) -> [f64; LINKS] {
    std::array::from_fn(|i| most * (2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0))
}

fn off() -> f64 {
    let chain = n_chain::NChain::<f64>::default();
    let (q, qd, qdd) = (numbers(3.0, 0.0), numbers(0.1, 0.3), numbers(2.0, 0.7));
    let found = chain.forward_dynamics(&q, &qd, &chain.inverse_dynamics(&q, &qd, &qdd));
    found.iter().zip(&qdd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn main() {
    let off = std::thread::Builder::new().stack_size(1 << 20).spawn(off).unwrap().join().unwrap();
    println!(\"off by {off:e}\");
    assert!(off < 1e-5);
}
";

#[test]
fn a_thousand_links_move_on_a_stack_of_a_mebibyte() {
    let chain = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms/n_chain.mbs")).expect("the chain");
    let chain = chain.replace("const n = 5;", &format!("const n = {LINKS};"));
    let options = mbs_derive::emit::Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
    let generated = mbs_derive::generate("n_chain.mbs", &chain, &options);
    let code = generated.unwrap_or_else(|e| panic!("{}", e.render("n_chain.mbs", &chain))).code;
    assert!(code.len() < 1_000_000, "{} bytes", code.len());
    let dependencies = "[dependencies]\nmbs-runtime = { path = \"../mbs/mbs-runtime\", features = [\"std\"] }\n";
    let crate_ = Downstream::new("rope", dependencies);
    crate_.write("src/chain.rs", &code);
    crate_.write("src/main.rs", PROGRAM);
    let run = crate_.cargo(&["run"]);
    assert!(run.status.success() && text(&run).contains("off by "), "{}", text(&run));
}
