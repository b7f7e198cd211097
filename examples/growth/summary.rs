//! What each chain costs, for people and for programs.

use serde_json::{Value, json};

/// One chain.
pub(crate) struct Growth {
    pub(crate) n: usize,
    /// Inverse and forward dynamics, generated.
    pub(crate) ns: [f64; 2],
    /// By the general algorithms.
    pub(crate) general_ns: [f64; 2],
    pub(crate) derive_seconds: f64,
    pub(crate) emitted_bytes: usize,
}

pub(crate) fn json(chains: &[Growth]) -> Value {
    let of_chain = |chain: &Growth| {
        let ([inverse, forward], [general_inverse, general_forward]) = (chain.ns, chain.general_ns);
        json!({
            "n": chain.n,
            "inverse_dynamics_ns": inverse,
            "forward_dynamics_ns": forward,
            "derive_seconds": chain.derive_seconds,
            "emitted_bytes": chain.emitted_bytes,
            "rivals": { "featherstone_nalgebra": {
                "inverse_dynamics_ns": general_inverse,
                "forward_dynamics_ns": general_forward,
            } },
        })
    };
    json!({ "n_chain": chains.iter().map(of_chain).collect::<Vec<_>>() })
}

pub(crate) fn table(chains: &[Growth]) -> String {
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
