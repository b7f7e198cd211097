//! `growth`: what it prints, and that code grows with the number of links as it says.

use crate::support::{good, json, keys};

const GROWTH: &str = env!("CARGO_BIN_EXE_growth");

#[test]
fn code_grows_with_the_number_of_links() {
    let report = json(&good(GROWTH, &["--json"]));
    assert_eq!(keys(&report), ["n_chain"]);
    let chains = report["n_chain"].as_array().unwrap();
    let of = |key: &str| -> Vec<f64> { chains.iter().map(|chain| chain[key].as_f64().unwrap()).collect() };
    assert_eq!(of("n"), [5.0, 10.0, 20.0, 40.0, 50.0, 200.0]);
    for key in ["inverse_dynamics_ns", "forward_dynamics_ns", "derive_seconds"] {
        assert!(of(key).iter().all(|&time| time > 0.0), "{key}: {report}");
    }
    let bytes = of("emitted_bytes");
    let [first, second] = [(bytes[1] - bytes[0]) / 5.0, (bytes[2] - bytes[1]) / 10.0];
    assert!((second / first - 1.0).abs() < 0.05, "{first} bytes a link, then {second}");
    // Where links are in loops, tables of their numbers and the key are all that grows.
    let [first, second] = [(bytes[4] - bytes[3]) / 10.0, (bytes[5] - bytes[4]) / 150.0];
    assert!(first < 700.0 && (second / first - 1.0).abs() < 0.05, "{first} bytes a link in loops, then {second}");
    assert!(bytes[5] < bytes[2], "{bytes:?}");
}
