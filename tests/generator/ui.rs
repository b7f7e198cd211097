//! What users get wrong with generated code, `tests/ui/*.rs`, and what the compiler says of it, in `*.stderr` beside
//! them.
//!
//! `TRYBUILD=overwrite cargo test -p mbs-tests --test generator ui` writes down what it says now.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use mbs_derive::emit::Options;
use mbs_derive::generate;

use crate::downstream::{Downstream, text};

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/ui");

/// Set where the test runs in the crate that it has made.
const IN_THE_CRATE: &str = "MBS_TESTS_UI";

#[test]
fn misuse_does_not_compile() {
    if env::var_os(IN_THE_CRATE).is_some() {
        trybuild::TestCases::new().compile_fail("tests/ui/*.rs");
        return;
    }
    let options = Options::default().functions(["mass_matrix", "forward_dynamics"]);
    let generated = generate("trolley.mbs", include_str!("../ui/trolley.mbs"), &options).expect("a mechanism");
    let manifest = "[lib]\nname = \"trolley\"\n\n[dependencies]\nmbs-runtime = { path = \"../mbs/mbs-runtime\" }\n";
    let crate_ = Downstream::new("trolley", manifest);
    crate_.write("src/lib.rs", &generated.code);
    let is_case = |path: &Path| path.extension().is_some_and(|end| end == "rs" || end == "stderr");
    let files = |folder: &Path| {
        let entries = fs::read_dir(folder).expect("the cases").map(|entry| entry.expect("a case").path());
        entries.filter(|path| is_case(path)).collect::<Vec<_>>()
    };
    for file in files(Path::new(CASES)) {
        let name = file.file_name().expect("a name").to_string_lossy();
        crate_.write(&format!("tests/ui/{name}"), &fs::read_to_string(&file).expect("a case"));
    }
    let mut run = Command::new(env::current_exe().expect("this program"));
    run.args(["ui::misuse_does_not_compile", "--exact"])
        .env(IN_THE_CRATE, "1")
        .env("CARGO_MANIFEST_DIR", crate_.path(""));
    let output = crate_.within(&mut run).output().expect("it runs");
    if env::var("TRYBUILD").is_ok_and(|update| update == "overwrite") {
        for file in files(&crate_.path("tests/ui")) {
            fs::copy(&file, Path::new(CASES).join(file.file_name().expect("a name"))).expect("the cases");
        }
    }
    assert!(output.status.success(), "{}", text(&output));
}
