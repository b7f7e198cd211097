//! Every file in `mechanisms/` becomes a module of `mbs_tests::mechanisms`.
fn main() {
    mbs_derive::Config::new().serde(true).compile_folder("mechanisms");
}
