//! The pages of `docs/thesis/`: every number of the thesis has its entry on its chapter's page and its row in the table
//! of equations, every erratum its test; files, functions and tests that the pages name are there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Numbered equations, figures: chapter and how many.
const EQUATIONS: [(u32, u32); 4] = [(3, 21), (4, 18), (5, 12), (7, 13)];
const FIGURES: [(u32, u32); 4] = [(3, 11), (4, 12), (5, 9), (7, 4)];
/// Tables 1 to 4: their chapters.
const TABLES: [u32; 4] = [3, 3, 4, 4];
const ERRATA: usize = 50;
/// Sections of the table of contents, by chapters that have any.
const SECTIONS: [(u32, &[&str]); 5] = [
    (3, &["3.1", "3.2", "3.3", "3.4", "3.5", "3.6", "3.7"]),
    (4, &["4.1", "4.2.1", "4.2.2", "4.3", "4.4"]),
    (5, &["5.1", "5.2", "5.3"]),
    (7, &["7.1", "7.2", "7.3", "7.4", "7.5", "7.6"]),
    (8, &["8.1", "8.2", "8.3"]),
];

fn folder() -> PathBuf {
    Path::new(ROOT).join("docs/thesis")
}

pub(crate) fn page(name: &str) -> String {
    let path = folder().join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The pages of chapters 1 to 8, with their numbers.
pub(crate) fn chapters() -> Vec<(u32, String)> {
    (1..=8).map(|chapter| (chapter, page(&format!("chapter_{chapter}.md")))).collect()
}

/// All pages, with their names.
fn pages() -> Vec<(String, String)> {
    let names = fs::read_dir(folder()).expect("the folder").map(|entry| entry.expect("an entry").file_name());
    names.map(|name| name.to_string_lossy().into_owned()).map(|name| (name.clone(), page(&name))).collect()
}

/// The entry stands once, in its own chapter.
#[track_caller]
fn assert_entry(entry: &str, chapter: u32) {
    for (number, page) in chapters() {
        let found = page.matches(entry).count();
        assert_eq!(found, usize::from(number == chapter), "{entry} in chapter {number}");
    }
}

#[test]
fn every_equation_table_and_figure_has_an_entry() {
    for (chapter, last) in EQUATIONS {
        (1..=last).for_each(|number| assert_entry(&format!("**({chapter}.{number})**"), chapter));
        let page = page(&format!("chapter_{chapter}.md"));
        assert_eq!(page.matches("**(").count(), last as usize, "entries that are no equations of chapter {chapter}");
    }
    for (table, chapter) in (1..).zip(TABLES) {
        assert_entry(&format!("**Table {table}**"), chapter);
    }
    for (chapter, last) in FIGURES {
        (1..=last).for_each(|number| assert_entry(&format!("| Figure {chapter}.{number} |"), chapter));
    }
    let index = page("README.md");
    (1..=8).for_each(|chapter| assert!(index.contains(&format!("(chapter_{chapter}.md)")), "chapter {chapter}"));
}

#[test]
fn every_section_has_its_heading() {
    for (chapter, sections) in SECTIONS {
        let page = page(&format!("chapter_{chapter}.md"));
        let headings = page.lines().filter(|line| line.starts_with("## "));
        let words: Vec<&str> = headings.flat_map(|line| line.split(' ')).collect();
        sections.iter().for_each(|section| assert!(words.contains(section), "section {section}"));
    }
}

/// Names of the tests in the sources of a folder and of those in it.
fn tests(folder: &Path) -> BTreeSet<String> {
    let mut named = BTreeSet::new();
    for path in fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            named.append(&mut tests(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a source");
            let functions = text.split("\n#[test]\nfn ").skip(1).filter_map(|rest| rest.split('(').next());
            named.extend(functions.map(String::from));
        }
    }
    named
}

/// A row of `equations.md`.
struct Row {
    number: String,
    print: String,
    generated: String,
    tests: String,
}

fn rows() -> Vec<Row> {
    let page = page("equations.md");
    let row = |line: &str| {
        let cells: Vec<String> = line.trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect();
        let [number, what, print, here, generated, tests] = &cells[..] else { panic!("six cells: {line}") };
        assert!(!what.is_empty() && here.contains('`'), "{line}");
        let [number, print, generated, tests] = [number, print, generated, tests].map(String::clone);
        Row { number, print, generated, tests }
    };
    page.lines().filter(|line| line.starts_with("| (") || line.starts_with("| Table")).map(row).collect()
}

#[test]
fn every_number_has_its_row() {
    let mut wanted = Vec::new();
    for (chapter, last) in EQUATIONS {
        wanted.extend((1..=last).map(|number| format!("({chapter}.{number})")));
        let tables = (1..).zip(TABLES).filter(|(_, of)| *of == chapter);
        wanted.extend(tables.map(|(table, _)| format!("Table {table}")));
    }
    assert_eq!(rows().into_iter().map(|row| row.number).collect::<Vec<_>>(), wanted);
}

/// Numbers that the title of an erratum names, `(3.7)–(3.10)` all four of them, `Tables 1, 2` both.
fn titled(title: &str) -> BTreeSet<String> {
    let parts = title.split(['(', ')']).collect::<Vec<_>>();
    let number = |text: &str| text.split_once('.').and_then(|(c, n)| Some((c.parse().ok()?, n.parse().ok()?)));
    let mut found: BTreeSet<String> = BTreeSet::new();
    let mut before: Option<(u32, u32)> = None;
    for (between, inner) in parts.chunks(2).filter_map(|pair| Some((pair[0], pair.get(1)?))) {
        let Some((chapter, last)) = number(inner) else { continue };
        let first = before.filter(|_| between == "–").map_or(last, |(_, first)| first);
        found.extend((first..=last).map(|number| format!("({chapter}.{number})")));
        before = Some((chapter, last));
    }
    if let Some(rest) = title.strip_prefix("Table") {
        let numbers = rest.trim_start_matches('s').split(',').map_while(|word| word.trim().parse::<u32>().ok());
        found.extend(numbers.map(|table| format!("Table {table}")));
    }
    found
}

/// `e07_…`
fn is_of_an_erratum(test: &str) -> bool {
    let digits = test.strip_prefix('e').and_then(|rest| rest.split_once('_')).map(|(digits, _)| digits);
    digits.is_some_and(|digits| digits.len() == 2 && digits.parse::<u32>().is_ok())
}

/// What a row cites are the errata whose titles name its number; without any it is as printed.
#[test]
fn rows_cite_the_errata_of_their_number() {
    assert_eq!(titled("(3.7)–(3.10), (7.4), arctg"), titled("(7.4), (3.7), (3.8), (3.9), (3.10)"));
    let errata = page("errata.md");
    let title = |section: &str| Some(section.split("**").nth(1)?.to_string());
    let titles: Vec<String> = errata.split("\n### E").skip(1).filter_map(title).collect();
    assert_eq!(titles.len(), ERRATA);
    for Row { number, print, .. } in rows() {
        let wanted: Vec<usize> =
            (1..).zip(&titles).filter(|(_, title)| titled(title).contains(&number)).map(|(n, _)| n).collect();
        let found: Vec<usize> = print.split("[E").skip(1).flat_map(|rest| cited(&format!("E{rest}")).next()).collect();
        assert_eq!(found, wanted, "{number}: {print}");
        assert!(print.starts_with("as printed") || !found.is_empty(), "{number}: {print}");
    }
}

/// Words between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Generated functions are in the snapshots of their mechanisms, tests in the sources.
#[test]
fn rows_name_functions_and_tests_that_there_are() {
    let tests = tests(&Path::new(ROOT).join("tests"));
    for Row { number, generated, tests: named, .. } in rows() {
        assert!(generated == "–" || generated.contains("::"), "{number}: {generated}");
        for function in quoted(&generated) {
            let (mechanism, name) = function.split_once("::").unwrap_or_else(|| panic!("{number}: {function}"));
            let snapshot = |end: &str| {
                fs::read_to_string(Path::new(ROOT).join(format!("tests/snapshots/{mechanism}{end}")))
                    .unwrap_or_default()
            };
            let is_there = snapshot(".snap").contains(&format!("pub fn {name}("))
                || snapshot(".operations.snap").lines().any(|line| line.split(' ').next() == Some(name));
            assert!(is_there, "{number}: {function}");
        }
        assert!(named.contains('`'), "{number} has no test");
        quoted(&named).for_each(|test| assert!(tests.contains(test), "{number}: no test {test}"));
    }
}

#[test]
fn every_erratum_has_its_test() {
    let page = page("errata.md");
    let sections: Vec<&str> = page.split("\n### E").skip(1).collect();
    assert_eq!(sections.len(), ERRATA);
    let mut named = BTreeSet::new();
    for (number, section) in (1..).zip(sections) {
        assert!(section.starts_with(&format!("{number}\n")), "E{number} is out of order: {section}");
        for part in ["- Printed: ", "- Right: ", "- Why: "] {
            assert!(section.contains(part), "E{number} has no {part}");
        }
        let (_, test) = section.split_once("- Test: `").unwrap_or_else(|| panic!("E{number} has no test"));
        let test = test.split('`').next().expect("a name");
        assert!(test.starts_with(&format!("e{number:02}_")), "E{number}: {test}");
        named.insert(test.to_string());
    }
    let mut there = tests(&Path::new(ROOT).join("tests/errata"));
    there.retain(|name| is_of_an_erratum(name));
    assert_eq!(named, there, "what the page names and what there is");
}

/// Numbers of errata behind an E, as pages and messages cite them.
fn cited(text: &str) -> impl Iterator<Item = usize> + '_ {
    let number = |rest: &str| rest.chars().take_while(char::is_ascii_digit).collect::<String>();
    let behind = move |(i, _): (usize, &str)| {
        let before = text[..i].chars().next_back();
        (!before.is_some_and(|c| c.is_alphanumeric() || c == '.' || c == '_')).then(|| number(&text[i + 1..]))
    };
    text.match_indices('E').filter_map(behind).filter_map(|digits| digits.parse().ok())
}

#[test]
fn citations_are_of_errata_that_there_are() {
    for (name, page) in pages() {
        for number in cited(&page) {
            assert!((1..=ERRATA).contains(&number), "{name} cites E{number}");
        }
    }
    // `(E30)`, `[E30](errata.md#e30)`: the link is that of its text.
    for (chapter, page) in chapters() {
        for link in page.split("[E").skip(1) {
            let Some((text, rest)) = link.split_once("](") else { continue };
            assert!(rest.starts_with(&format!("errata.md#e{text})")), "chapter {chapter}: E{text} links to {rest:.20}");
        }
    }
    let summary = fs::read_to_string(Path::new(ROOT).join("examples/arm_trajectory/summary.rs")).expect("the example");
    let lines: Vec<usize> = summary
        .split("\"  E")
        .skip(1)
        .map(|rest| rest.chars().take_while(char::is_ascii_digit).collect::<String>().parse().expect("a number"))
        .collect();
    assert_eq!(lines, [9, 11, 48, 49, 50], "what the example says of the errata of chapter 3");
}

/// Paths between backticks or as targets of links, from the repository's root.
fn paths(text: &str) -> Vec<String> {
    let paths = quoted(text).filter(|word| word.contains('/') && !word.contains([' ', '(']));
    let folders = ["mbs-", "models/", "tests/", "examples/", "docs/", ".ci/"];
    let in_repository = |path: &&str| folders.iter().any(|top| path.starts_with(top));
    let linked = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let beside = linked.filter(|target| !target.is_empty()).map(|target| format!("docs/thesis/{target}"));
    paths.filter(in_repository).map(String::from).chain(beside).collect()
}

#[test]
fn files_that_the_pages_name_are_there() {
    let examples = fs::read_to_string(Path::new(ROOT).join("examples/Cargo.toml")).expect("the manifest");
    let (tests, mut count) = (tests(&Path::new(ROOT).join("tests")), 0);
    let is_numbered = |word: &&str| word.starts_with("equation") && word.contains('_') || is_of_an_erratum(word);
    for (name, page) in pages() {
        for test in quoted(&page).filter(is_numbered) {
            assert!(tests.contains(test), "{name} names the test {test}");
        }
        for path in paths(&page) {
            count += 1;
            assert!(Path::new(ROOT).join(&path).exists(), "{name} names {path}");
        }
        // Figures are drawn by programs that there are.
        for drawn in page.lines().filter(|line| line.starts_with("| Figure ") && line.contains("`, `figure_")) {
            let program = drawn.rsplit("| `").next().and_then(|cell| cell.split('`').next()).expect("a program");
            assert!(examples.contains(&format!("name = \"{program}\"")), "{drawn}");
        }
    }
    assert!(count > 150, "{count}");
    let index = page("README.md");
    let rows = index.lines().filter(|line| line.contains("(chapter_"));
    for program in rows.filter_map(|row| row.split('|').nth(5)).flat_map(|cell| cell.split('`').skip(1).step_by(2)) {
        assert!(examples.contains(&format!("name = \"{program}\"")), "example {program}");
    }
}
