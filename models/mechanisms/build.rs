//! Every `.mbs` file of this folder becomes a module of this crate; those of `elastic/` too, the large ones with the
//! functions that motions, vibrations and their derivatives need.
fn main() {
    mbs_derive::Config::new().compile_folder(".");
    mbs_derive::Config::new().compile("elastic/assistive_arm.mbs");
    let functions = ["kinetic_energy", "potential_energy", "mass_matrix", "gravity", "forward_dynamics", "linearize"];
    for (file, outputs) in [("irb7600_elastic", &["flange", "flange_jacobian"][..]), ("stewart_platform_elastic", &[])]
    {
        mbs_derive::Config::new()
            .functions(functions)
            .functions(outputs.iter().copied())
            .compile(format!("elastic/{file}.mbs"));
    }
}
