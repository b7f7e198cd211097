//! The generated module of every file in `models/mechanisms/`, and its operation counts, as snapshots; of the files in
//! `tests/mechanisms/` the counts alone.
//!
//! A changed derivation is a reviewed diff: operation counts first, then the code. `identities.rs` and `reference.rs`
//! show that it is right.

use mbs_derive::expr::Graph;
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{declared, derived, emit, generate};

#[test]
fn modules() {
    for (module, source) in mbs_models::SOURCES {
        let generated = generate(&format!("mechanisms/{module}.mbs"), source, &emit::Options::default());
        let generated = generated.unwrap_or_else(|e| panic!("{}", e.render(module, source)));
        assert_eq!(generated.module, *module, "a mechanism is named after its file");
        assert_eq!(generated.warnings, "", "{module}");
        snapshot(module, &generated.code);
    }
}

#[test]
fn operation_counts() {
    for (module, source) in mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES) {
        let graph = Graph::verbatim();
        let (lagrangian, _) = declared(source, &graph, &[]).expect("a mechanism of the repository");
        let mut table =
            format!("{:28} {:>6} {:>6} {:>4} {:>4} {:>6} {:>5}\n", "", "add", "mul", "div", "sqrt", "sincos", "other");
        for function in derived(&lagrangian).functions {
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
        let graph = Graph::verbatim();
        let (lagrangian, _) = declared(source, &graph, &[]).expect("a mechanism of the repository");
        let derivation = derived(&lagrangian);
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
