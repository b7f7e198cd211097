//! The examples as outside programs call them: what they print and what they write.

mod adaptive;
mod arm;
mod assembly_cell;
mod assistive_arm;
mod dispersions;
mod docking;
mod elastic_arm;
mod estimator;
mod experiment;
mod four_bar;
mod gallery;
mod growth;
mod landing_maps;
mod marine;
mod minimum_effort;
mod mpc;
mod nonholonomic;
mod orbits;
mod platform;
mod quadrotor;
mod rapid;
mod rapid_reader;
mod soft_docking;
mod support;
mod touchdown;

/// What cargo has built of these names.
macro_rules! programs {
    ($($name:literal)+) => { [$(env!(concat!("CARGO_BIN_EXE_", $name))),+] };
}

const PROGRAMS: [&str; 32] = programs! {
    "adaptive" "arm_kinematics" "arm_speed" "arm_trajectory" "assembly_cell" "assistive_arm" "docking"
    "docking_dispersions" "double_pendulum_energy" "elastic_arm" "estimator" "experiment" "four_bar" "gallery" "growth"
    "landing_maps" "landing_monte_carlo" "landing_sweep" "marine" "minimum_effort" "mpc" "nonholonomic"
    "platform_dynamics" "platform_sensitivity" "quadrotor_landing" "relative_motion" "soft_docking" "speed" "three_body"
    "touchdown" "two_body" "work_precision"
};

#[test]
fn wrong_usage_is_refused_by_all() {
    for program in PROGRAMS {
        for arguments in [&["--fast"][..], &["--out"]] {
            assert!(support::refused(program, arguments).contains("--help"), "{program} {arguments:?}");
        }
    }
}
