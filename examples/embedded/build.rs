//! Generates the equations of motion; for the microcontroller, tells the linker what memory there is.

fn main() {
    mbs_derive::compile("mechanisms/balancer.mbs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "none") {
        println!("cargo::rerun-if-changed=memory.x");
        println!("cargo::rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
    }
}
