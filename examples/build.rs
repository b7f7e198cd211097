//! The nonholonomic mechanisms of `nonholonomic`, which the tests have beside others of their kind, and the chains of
//! `growth`.

use std::path::Path;

/// A chain whose length is a number in its text.
const CHAIN: &str = "../tests/mechanisms/n_chain.mbs";

/// Their modules, and how many links they have.
const CHAINS: [(&str, usize); 6] =
    [("five", 5), ("ten", 10), ("twenty", 20), ("forty", 40), ("fifty", 50), ("two_hundred", 200)];

fn main() {
    for name in ["knife_edge", "chaplygin_sleigh", "rolling_coin"] {
        mbs_derive::compile(format!("../tests/mechanisms/{name}.mbs"));
    }
    println!("cargo::rerun-if-changed={CHAIN}");
    let text = std::fs::read_to_string(CHAIN).unwrap_or_else(|error| panic!("{CHAIN}: {error}"));
    let options = mbs_derive::emit::Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
    let modules = CHAINS.map(|(name, n)| {
        let text = text.replace("const n = 5;", &format!("const n = {n};"));
        let chain =
            mbs_derive::generate(CHAIN, &text, &options).unwrap_or_else(|e| panic!("{}", e.render(CHAIN, &text)));
        format!("/// A chain of {n} links.\npub mod {name} {{\n{}\npub use n_chain::NChain;\n}}\n", chain.code)
    });
    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    let constant = format!("/// The chain, of five links.\npub const CHAIN: &str = {text:?};\n");
    std::fs::write(Path::new(&folder).join("chains.rs"), constant + &modules.concat()).expect("cargo's folder");
}
