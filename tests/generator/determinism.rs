//! The same declaration gives the same bytes: twice in one process, and in another process.

use std::process::Command;

use mbs_derive::{emit, generate};

/// Set in the process that this test starts: where it is to write what it generates.
const CHILD: &str = "MBS_TESTS_DETERMINISM_CHILD";

fn everything() -> String {
    let options = emit::Options::default();
    let sources = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES);
    let modules = sources.map(|(module, source)| {
        let generated = generate(&format!("mechanisms/{module}.mbs"), source, &options);
        generated.unwrap_or_else(|e| panic!("{}", e.render(module, source))).code
    });
    modules.collect()
}

#[test]
fn two_processes_generate_the_same_bytes() {
    if let Some(file) = std::env::var_os(CHILD) {
        std::fs::write(file, everything()).expect("writing to a temporary folder");
        return;
    }
    let here = everything();
    assert_eq!(here, everything(), "twice in one process");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("generated.rs");
    let status = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "determinism::two_processes_generate_the_same_bytes"])
        .env(CHILD, &file)
        .status()
        .expect("this test starts again");
    assert!(status.success());
    assert!(here == std::fs::read_to_string(&file).expect("what the other process wrote"), "in two processes");
}
