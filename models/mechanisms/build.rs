//! Every `.mbs` file of this folder becomes a module of this crate.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
}
