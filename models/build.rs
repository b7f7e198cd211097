//! Every file in `mechanisms/` becomes a module of this crate.
fn main() {
    mbs_derive::Config::new().compile_folder("mechanisms");
}
