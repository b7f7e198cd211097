//! The benchmark arm as Rust.

fn main() {
    mbs_derive::compile("../../models/mechanisms/arm6.mbs");
}
