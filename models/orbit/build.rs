//! The two bodies of a soft docking.
fn main() {
    // Without what nobody asks of 14 coordinates: linearizations of 50 000 operations.
    let functions = [
        "kinetic_energy",
        "potential_energy",
        "mass_matrix",
        "forward_dynamics",
        "dissipation_force",
        "conserved",
        "constraint",
        "constraint_rate",
        "constraint_jacobian",
        "gap",
        "gap_velocity",
    ];
    mbs_derive::Config::new().functions(functions).compile("mechanisms/docking_bodies.mbs");
}
