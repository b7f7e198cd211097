//! The arm in Rust, in C, which is compiled, and in OpenCL C.

use mbs_derive::Config;
use mbs_derive::emit::Language;

fn main() {
    Config::new().languages([Language::C, Language::Opencl]).compile("../../models/mechanisms/arm6.mbs");
    println!("cargo::rerun-if-changed=src/arm6.c");
    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    let mut build = cc::Build::new();
    build.file("src/arm6.c").include(folder).opt_level(3).flag("-std=c99").flag("-ffp-contract=off");
    build.compile("arm6");
}
