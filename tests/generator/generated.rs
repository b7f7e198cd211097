//! Every file in `models/mechanisms/` as it is reviewed, with its operation counts, as snapshots; of the files in
//! `tests/mechanisms/` the counts alone. Equations in print are in `textbook.rs`.
//!
//! A changed derivation is a reviewed diff: equations and operation counts first, then the code. `identities.rs` and
//! `reference.rs` show that it is right.

use std::fs;
use std::path::Path;

use mbs_derive::optimise::FunctionKind;
use mbs_derive::{emit, generate};
use mbs_tests::derivation;

#[test]
fn modules() {
    for (module, source) in mbs_models::SOURCES {
        let file = format!("mechanisms/{module}.mbs");
        let generated = generate(&file, source, &emit::Options::default());
        let generated = generated.unwrap_or_else(|e| panic!("{}", e.render(module, source)));
        assert_eq!(generated.module, *module, "a mechanism is named after its file");
        assert_eq!(generated.warnings, "", "{module}");
        snapshot(module, &derivation(source).review(&file));
    }
}

/// People read them: a mechanism whose snapshot grows beyond that is to be summed up, or is one too many.
#[test]
fn all_snapshots_are_at_most_a_megabyte() {
    fn size(path: &Path) -> u64 {
        let entries = |folder| fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
        if path.is_dir() {
            entries(path).map(|entry| size(&entry)).sum()
        } else {
            path.metadata().expect("a file").len()
        }
    }
    let size = size(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/snapshots")));
    assert!(size <= 1_000_000, "{size} bytes");
}

#[test]
fn operation_counts() {
    for (module, source) in mbs_tests::mechanisms::SOURCES {
        let mut table =
            format!("{:28} {:>6} {:>6} {:>4} {:>4} {:>6} {:>5}\n", "", "add", "mul", "div", "sqrt", "sincos", "other");
        for function in &derivation(source).functions {
            let o = function.operations;
            let name = &function.name;
            table +=
                &format!("{name:28} {:6} {:6} {:4} {:4} {:6} {:5}\n", o.add, o.mul, o.div, o.sqrt, o.sincos, o.other);
        }
        snapshot(&format!("{module}.operations"), &table);
    }
}

/// The README's table of operation counts is this one.
#[test]
fn the_readme_tells_the_operation_counts() {
    let functions = [
        FunctionKind::MassMatrix,
        FunctionKind::CoriolisMatrix,
        FunctionKind::Bias,
        FunctionKind::InverseDynamics,
        FunctionKind::ForwardDynamics,
    ];
    let mut table =
        String::from("| mechanism | coordinates | M | C | C q̇ + G | inverse dynamics | forward dynamics |\n");
    table += "|---|---|---|---|---|---|---|\n";
    for (module, source) in mbs_models::SOURCES {
        let derivation = derivation(source);
        let counts = functions.map(|kind| derivation.function(kind).map_or(0, |f| f.operations.flops()).to_string());
        table += &format!("| `{module}` | {} | {} |\n", derivation.dof(), counts.join(" | "));
    }
    let readme = include_str!("../../README.md");
    assert!(readme.contains(&table), "the README should say\n\n{table}");
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}
