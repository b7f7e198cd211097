//! The same declaration gives the same bytes in another process, whatever was generated before it.

use std::process::Command;

use mbs_derive::{emit, generate};

/// Set in the process that this test starts: where it is to write what it generates.
const CHILD: &str = "MBS_TESTS_DETERMINISM_CHILD";

type Source = (&'static str, &'static str);

/// All mechanisms.
fn sources() -> Vec<&'static Source> {
    mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).collect()
}

/// The module of each, generated in this order.
fn modules<'a>(sources: impl Iterator<Item = &'a &'static Source>) -> Vec<String> {
    let options = emit::Options::default();
    let module = |(module, source): &&Source| {
        let generated = generate(&format!("mechanisms/{module}.mbs"), source, &options);
        generated.unwrap_or_else(|e| panic!("{}", e.render(module, source))).code
    };
    sources.map(module).collect()
}

#[test]
fn two_processes_generate_the_same_bytes() {
    if let Some(file) = std::env::var_os(CHILD) {
        let mut backwards = modules(sources().iter().rev());
        backwards.reverse();
        std::fs::write(file, backwards.concat()).expect("writing to a temporary folder");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("generated.rs");
    let mut other = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "determinism::two_processes_generate_the_same_bytes"])
        .env(CHILD, &file)
        .spawn()
        .expect("this test starts again");
    let here = modules(sources().iter()).concat();
    assert!(other.wait().expect("the other process ends").success());
    assert!(here == std::fs::read_to_string(&file).expect("what the other process wrote"), "in two processes");
}
