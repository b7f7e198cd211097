//! The arm in Rust, in C, which compilers make as they are used to, and in OpenCL C.

use std::process::Command;

use mbs_derive::Config;
use mbs_derive::emit::Language;

/// Compilers and what they are told, by the words that begin the names of their functions.
const BUILDS: [(&str, &str, u32); 3] = [("gcc_o2", "gcc", 2), ("gcc_o3", "gcc", 3), ("clang_o2", "clang", 2)];

fn main() {
    Config::new().languages([Language::C, Language::Opencl]).compile("../../models/mechanisms/arm6.mbs");
    println!("cargo::rerun-if-changed=src/arm6.c");
    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    for (name, compiler, level) in BUILDS {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if !Command::new(compiler).arg("--version").output().is_ok_and(|output| output.status.success()) {
            println!("cargo::warning=skipped: {compiler}, which is not there");
            continue;
        }
        println!("cargo::rustc-cfg={name}");
        let mut build = cc::Build::new();
        build.compiler(compiler).file("src/arm6.c").include(&folder).define("BUILD", name);
        build.opt_level(level).flag("-std=c99").flag("-ffp-contract=off").compile(name);
    }
}
