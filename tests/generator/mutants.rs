//! The tables of mutants fit the source; whether tests notice the mutants, the program `mutants` says.

use std::collections::BTreeSet;
use std::path::Path;

use mbs_tests::mutants::{Mutant, parse};

fn tables() -> [Vec<Mutant>; 2] {
    [include_str!("../mutants/runtime.txt"), include_str!("../mutants/generator.txt")]
        .map(|table| parse(table).unwrap())
}

#[test]
fn every_mutant_can_be_made() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut names = BTreeSet::new();
    let mut faults = Vec::new();
    for (table, folder) in tables().iter().zip(["mbs-runtime/src/", "mbs-derive/src/"]) {
        assert!(table.len() >= 50, "{} mutants of {folder}", table.len());
        for mutant in table {
            faults.extend(mutant.apply_in(root).err());
            assert!(names.insert(&mutant.name), "two mutants are called {}", mutant.name);
            assert!(mutant.file.starts_with(folder), "{} is not in {folder}", mutant.file);
            assert!(mutant.test.len() >= 2 && mutant.test[0] == "-p", "{}: {:?}", mutant.name, mutant.test);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_mutant_is_one_change() {
    let mutant = &parse("# a remark\n\nname\nin a.rs\n- a + b\n+ a - b\ntest -p x --lib y\n").unwrap()[0];
    assert_eq!(mutant.test, ["-p", "x", "--lib", "y"]);
    assert_eq!(mutant.apply("let c = a + b;").unwrap(), "let c = a - b;");
    assert_eq!(mutant.apply("let c = 1;").unwrap_err(), "name: `a + b` occurs 0 times in a.rs, not once");
    assert!(mutant.apply("a + b + a + b").is_err());
    assert_eq!(parse("name\nin a.rs\n- x\n+\ntest -p x").unwrap()[0].replacement, "");
    assert_eq!(parse("name\nin a.rs").unwrap_err(), "name: 2 lines, not 5");
    assert!(parse("name\nin a.rs\n- x\nx\ntest -p x").is_err());
}
