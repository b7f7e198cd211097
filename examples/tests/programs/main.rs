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

/// What no test here calls is called by CI, after the tests.
#[test]
fn every_example_is_run() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |file: std::path::PathBuf| std::fs::read_to_string(file).expect("a file");
    let tests = std::fs::read_dir(folder.join("tests/programs")).expect("a folder");
    let tests: String = tests.map(|file| read(file.expect("a file").path())).collect();
    let after = read(folder.join("../.ci/run"));
    let manifest = read(folder.join("Cargo.toml"));
    let names = manifest.split("[[bin]]\nname = \"").skip(1).map(|bin| bin.split('"').next().expect("a name"));
    let names: Vec<&str> = names.collect();
    assert_eq!(names.len(), PROGRAMS.len(), "{names:?}");
    let forgotten: Vec<&&str> = names
        .iter()
        .filter(|name| {
            !tests.contains(&format!("\"CARGO_BIN_EXE_{name}\"")) && !after.contains(&format!("\n{name} --"))
        })
        .collect();
    assert!(forgotten.is_empty(), "never run: {forgotten:?}");
}
