//! Every `.mbs` file of this folder becomes a module of this crate, and so does the one in `marine/`.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
    mbs_derive::compile("marine/marine_platform.mbs");
}
