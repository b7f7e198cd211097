//! The tables of the manual `docs/language.md` against those of the code: what the one has the other has, too.

use std::collections::BTreeSet;
use std::path::Path;

use crate::model::names::function::{MAX_CALLS, library};
use crate::model::statement::MAX_TURNS;
use crate::model::statement::declare::MAX_COORDINATES;
use crate::model::statement::drawing::MAX_SHAPES;
use crate::model::statement::reaction::MAX_JOINTS;
use crate::model::value::builtin::{FUNCTIONS, METHODS};
use crate::model::value::dimension::UNITS;
use crate::model::value::evaluate::{MAX_NODES, MAX_STEPS};
use crate::parse::syntax::StatementKind;
use crate::parse::{MAX_DEPTH, MAX_TOKENS};
use crate::source::{self, MAX_BYTES, MAX_IMPORTS};

/// The manual, which is no part of the crate's package: `None` outside of the repository.
pub(crate) fn manual() -> Option<String> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let is_repository = repository.join("ARCHITECTURE.md").exists();
    is_repository.then(|| std::fs::read_to_string(repository.join("docs/language.md")).expect("the manual"))
}

/// The prose and the tables of a section, blocks of code left out.
fn section(manual: &str, number: usize) -> String {
    let begin = format!("\n## {number}. ");
    let (_, after) = manual.split_once(&begin).unwrap_or_else(|| panic!("the manual has no section {number}"));
    let text = after.split("\n## ").next().unwrap_or(after);
    text.split("```").step_by(2).collect()
}

/// What stands between backquotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The names that a piece of code calls.
fn called(code: &str) -> Vec<&str> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let name = |at: usize| code[..at].rsplit(|c| !is_part(c)).next().filter(|name| !name.is_empty());
    code.match_indices('(').filter_map(|(at, _)| name(at)).collect()
}

fn equal<'a>(what: &str, manual: BTreeSet<&'a str>, code: BTreeSet<&'a str>) {
    let only = |a: &BTreeSet<&'a str>, b: &BTreeSet<&'a str>| a.difference(b).copied().collect::<Vec<_>>();
    let (manual_only, code_only) = (only(&manual, &code), only(&code, &manual));
    assert!(manual_only.is_empty(), "{what} in the manual only: {manual_only:?}");
    assert!(code_only.is_empty(), "{what} in the code only: {code_only:?}");
}

#[test]
fn functions_are_those_of_the_manual() {
    let Some(manual) = manual() else { return };
    let text = [6, 7, 8].map(|number| section(&manual, number)).concat();
    let library = library();
    let written = library.statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Function { name, .. } => Some(name.text.as_str()),
        _ => None,
    });
    let code = FUNCTIONS.iter().chain(METHODS).map(|builtin| builtin.name).chain(written).collect();
    equal("functions", quoted(&text).into_iter().flat_map(called).collect(), code);
}

/// As they are called: `dot(a, b)` and `a.dot(b)` are two entries.
#[test]
fn methods_are_those_of_the_manual() {
    let Some(manual) = manual() else { return };
    let text = [6, 7].map(|number| section(&manual, number)).concat();
    let rows: Vec<_> = quoted(&text).into_iter().filter_map(|code| code.split_once('.')).collect();
    let is_name = |receiver: &str| receiver.chars().all(|c| c.is_ascii_lowercase());
    let manual = rows.iter().filter(|(receiver, _)| is_name(receiver)).flat_map(|(_, call)| called(call)).collect();
    equal("methods", manual, METHODS.iter().map(|method| method.name).collect());
}

#[test]
fn units_are_those_of_the_manual() {
    let Some(manual) = manual() else { return };
    let text = section(&manual, 9);
    let cells = text.lines().filter_map(|line| line.strip_prefix("| ")?.split_once('|')).map(|(_, units)| units);
    // `1` is a plain number, and not a name.
    let manual = cells.flat_map(quoted).filter(|&unit| unit != "1").collect();
    equal("units", manual, UNITS.iter().map(|unit| unit.name).collect());
}

/// Those of a mechanism that has all of them, outputs aside.
#[test]
fn generated_functions_are_those_of_the_manual() {
    let Some(manual) = manual() else { return };
    let text = section(&manual, 11);
    let cells = text.lines().filter_map(|line| line.strip_prefix("| `")?.split_once(" |")).map(|(names, _)| names);
    let manual = cells.flat_map(|names| names.split(['`', ',', ' '])).filter(|name| !name.is_empty());
    let source = "#![dimensionless] mechanism A { param m: 1 = 1; coord x: 1; coord y: 1; \
                  kinetic += m*dt(x)^2 + m*dt(y)^2; constraint c: x = y; }";
    let graph = crate::expr::Graph::verbatim();
    let (lagrangian, _) = crate::declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("a", source)));
    let derivation = crate::derived(&lagrangian);
    let code = derivation.functions.iter().map(|function| function.name.as_str()).collect();
    equal("generated functions", manual.collect(), code);
}

/// Thousands apart, as the manual writes them.
fn spaced(number: usize) -> String {
    let digits = number.to_string();
    let groups: Vec<_> = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    groups.join(" ")
}

#[test]
fn limits_are_those_of_the_manual() {
    let Some(manual) = manual() else { return };
    let text = section(&manual, 10);
    let limit = |row: &str, limit: String| {
        let found = text.lines().find(|line| line.starts_with(&format!("| {row}"))).unwrap_or_else(|| panic!("{row}"));
        assert!(found.contains(&format!(" {limit} ")), "{found}: the code has {limit}");
    };
    limit("nesting", spaced(MAX_DEPTH));
    limit("coordinates", spaced(MAX_COORDINATES));
    limit("joints", spaced(MAX_JOINTS));
    limit("shapes", spaced(MAX_SHAPES));
    limit("loops", spaced(MAX_TURNS));
    limit("calls", spaced(MAX_CALLS));
    limit("nodes", spaced(MAX_NODES));
    limit("steps", spaced(MAX_STEPS));
    limit("file", spaced(MAX_BYTES >> 20));
    limit("names, numbers", spaced(MAX_TOKENS));
    limit("imports", spaced(MAX_IMPORTS));
    limit("imports", spaced(source::MAX_DEPTH));
}
