//! Every `.mbs` file of this folder becomes a module of this crate. Those in folders do too, the large ones of `elastic/`
//! with the functions that motions, vibrations and their derivatives need.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
    let dynamics = ["kinetic_energy", "potential_energy", "mass_matrix", "gravity", "forward_dynamics", "linearize"];
    only("elastic/irb7600_elastic.mbs", &[&dynamics[..], &["flange", "flange_jacobian"]].concat());
    only("elastic/stewart_platform_elastic.mbs", &dynamics);
    mbs_derive::compile("elastic/assistive_arm.mbs");
    mbs_derive::compile("marine/marine_platform.mbs");
}

/// These functions of a mechanism.
fn only(file: &str, functions: &[&str]) {
    mbs_derive::Config::new().functions(functions.iter().copied()).compile(file);
}
