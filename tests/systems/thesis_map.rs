//! The pages of `docs/thesis/`: every number of the thesis has its entry, every erratum its test, every file that they
//! name is there.

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

fn folder() -> PathBuf {
    Path::new(ROOT).join("docs/thesis")
}

pub(super) fn page(name: &str) -> String {
    let path = folder().join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The pages of chapters 1 to 8, with their numbers.
pub(super) fn chapters() -> Vec<(u32, String)> {
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

/// Names of the tests of errata in the sources beside this one.
fn tests() -> BTreeSet<String> {
    let folder = Path::new(ROOT).join("tests/errata");
    let sources = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    let texts = sources.map(|path| fs::read_to_string(path).expect("a source"));
    let named = |text: String| -> Vec<String> {
        let behind =
            text.split("\n#[test]\nfn ").skip(1).map(|rest| rest[..rest.find('(').expect("a function")].to_string());
        behind.filter(|name| name.starts_with('e') && name[1..3].parse::<u32>().is_ok()).collect()
    };
    texts.flat_map(named).collect()
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
    assert_eq!(named, tests(), "what the page names and what there is");
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
    let quoted = text.split('`').skip(1).step_by(2).filter(|word| word.contains('/') && !word.contains([' ', '(']));
    let in_repository =
        |path: &&str| ["mbs-", "models/", "tests/", "examples/", "docs/"].iter().any(|top| path.starts_with(top));
    let linked = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let beside = linked.filter(|target| !target.is_empty()).map(|target| format!("docs/thesis/{target}"));
    quoted.filter(in_repository).map(String::from).chain(beside).collect()
}

#[test]
fn files_that_the_pages_name_are_there() {
    let examples = fs::read_to_string(Path::new(ROOT).join("examples/Cargo.toml")).expect("the manifest");
    let mut count = 0;
    for (name, page) in pages() {
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
