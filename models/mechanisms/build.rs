//! Every `.mbs` file of this folder becomes a module of this crate. Those in folders do too: the large ones of
//! `elastic/` with the functions that motions, vibrations and their derivatives need; those of `sensors/`, which are
//! declared for their outputs, with these alone.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
    let dynamics = ["kinetic_energy", "potential_energy", "mass_matrix", "gravity", "forward_dynamics", "linearize"];
    only("elastic/irb7600_elastic.mbs", [&dynamics[..], &["flange", "flange_jacobian"]].concat());
    only("elastic/stewart_platform_elastic.mbs", dynamics);
    mbs_derive::compile("elastic/assistive_arm.mbs");
    mbs_derive::compile("marine/marine_platform.mbs");
    let step = |output: &str| all_of(output, &["", "_jacobian", "_jacobian_qd", "_jacobian_u"]);
    let turn = all_of("next_attitude", &["", "_jacobian", "_jacobian_u"]);
    only("sensors/strapdown.mbs", [step("next_place"), step("next_velocity"), turn].concat());
    let measured = ["pixel", "range"].map(|output| all_of(output, &["", "_jacobian"])).concat();
    only("sensors/sensor_head.mbs", [measured, all_of("depth", &[""]), all_of("incidence", &[""])].concat());
}

/// These functions of a mechanism.
fn only(file: &str, functions: impl IntoIterator<Item = impl Into<String>>) {
    mbs_derive::Config::new().functions(functions).compile(file);
}

/// These functions of an output.
fn all_of(output: &str, functions: &[&str]) -> Vec<String> {
    functions.iter().map(|function| format!("{output}{function}")).collect()
}
