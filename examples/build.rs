//! The nonholonomic mechanisms of `nonholonomic`, which the tests have beside others of their kind.

fn main() {
    for name in ["knife_edge", "chaplygin_sleigh", "rolling_coin"] {
        mbs_derive::compile(format!("../tests/mechanisms/{name}.mbs"));
    }
}
