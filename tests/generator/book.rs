//! The book, `docs/`: every page is in it, every link leads somewhere, and every fenced block is run by a test or says
//! why not.
//!
//! Mechanisms are generated here, and programs of Python and Octave run where these are; commands are run by
//! `mbs-cli/tests/cli/book.rs`, examples in Rust are doc tests (`tests/src/lib.rs`), and languages with a page of their
//! own have tests of their own ([`ELSEWHERE`]).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mbs_derive::Analysis;
use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::Graph;
use mbs_derive::source::{Sources, Unreadable};

use crate::downstream::{Downstream, text};
use page::{Block, Page, anchors, blocks, is_shown, links, markdown_below, pages};

#[path = "../../mbs-cli/tests/cli/page.rs"]
mod page;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Pages whose blocks of a kind have a test of their own, which names the page.
const ELSEWHERE: [(&str, &str, &str); 13] = [
    ("language.md", "mbs", "tests/language/manual.rs"),
    ("c.md", "c", "tests/printers/c_header.rs"),
    ("c.md", "cpp", "tests/printers/c_header.rs"),
    ("c.md", "cuda", "tests/printers/c_header/cuda.rs"),
    ("c.md", "python", "tests/printers/c_header/opencl.rs"),
    ("javascript.md", "js", "tests/printers/scripts.rs"),
    ("numpy.md", "python", "tests/printers/scripts.rs"),
    ("matlab.md", "matlab", "tests/printers/scripts.rs"),
    ("python.md", "python", "mbs-python/tests/test_pages.py"),
    ("fmu.md", "python", "tests/systems/fmu_manual.rs"),
    ("import.md", "xml", "mbs-cli/tests/cli/robot.rs"),
    ("import.md", "mbs", "mbs-cli/tests/cli/robot.rs"),
    ("webassembly.md", "js", "mbs-wasm/tests/manual.test.mjs"),
];

/// Texts beside the book whose links must hold, too.
const BESIDE: [&str; 8] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "mbs-cli/README.md",
    "mbs-derive/README.md",
    "mbs-python/README.md",
    "mbs-runtime/README.md",
];

fn root() -> PathBuf {
    fs::canonicalize(ROOT).expect("the workspace")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn book() -> Vec<Page> {
    pages(&root().join("docs")).expect("docs/SUMMARY.md")
}

#[test]
fn every_page_is_in_the_book_once() {
    let docs = root().join("docs");
    let mut listed = vec![docs.join("SUMMARY.md")];
    for page in book() {
        let path = docs.join(&page.name);
        assert!(!listed.contains(&path), "docs/SUMMARY.md has {} twice", page.name);
        listed.push(path);
    }
    let stray: Vec<PathBuf> = markdown_below(&docs).into_iter().filter(|path| !listed.contains(path)).collect();
    assert!(stray.is_empty(), "docs/SUMMARY.md does not have {stray:?}");
}

#[test]
fn every_link_leads_somewhere() {
    let mut texts: Vec<(String, String)> =
        book().into_iter().map(|page| (format!("docs/{}", page.name), page.text)).collect();
    texts.extend(BESIDE.map(|name| (name.to_string(), read(name))));
    let (mut faults, mut count) = (String::new(), 0);
    for (name, text) in &texts {
        for (line, target) in links(text) {
            if target.starts_with("https://") || target.starts_with("http://") {
                continue;
            }
            count += 1;
            if let Err(fault) = leads_somewhere(name, text, &target) {
                faults += &format!("{name}:{line}: {target}: {fault}\n");
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
    assert!(count >= 300, "{count} links found");
}

/// A link of a text, seen from its folder. Pages of the book keep to `docs/`, else they would lead nowhere once it is
/// built.
fn leads_somewhere(name: &str, text: &str, target: &str) -> Result<(), String> {
    let (path, anchor) = target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)));
    let other = match path {
        "" => text.to_string(),
        path => {
            let folder = root().join(name).parent().expect("a folder").to_path_buf();
            let file = fs::canonicalize(folder.join(path)).map_err(|error| error.to_string())?;
            if name.starts_with("docs/") && !file.starts_with(root().join("docs")) {
                return Err("it leads out of the book".to_string());
            }
            if anchor.is_none() {
                return Ok(());
            }
            fs::read_to_string(file).map_err(|error| error.to_string())?
        }
    };
    match anchor {
        Some(anchor) if !anchors(&other).iter().any(|known| known == anchor) => Err("there is no such heading".into()),
        _ => Ok(()),
    }
}

#[test]
fn every_block_is_run_by_a_test_or_says_why_not() {
    let (mut faults, mut count) = (String::new(), 0);
    for page in book() {
        for block in blocks(&page.text) {
            count += 1;
            if let Err(fault) = is_run(&page, &block) {
                faults += &format!("docs/{}:{}: {}: {fault}\n", page.name, block.line, block.kind);
            }
        }
    }
    assert!(faults.is_empty(), "blocks that nothing runs:\n{faults}");
    assert!(count >= 200, "{count} blocks found");
}

/// The test of a page's blocks of this kind, where they have one of their own.
fn elsewhere(page: &Page, kind: &str) -> Option<&'static str> {
    ELSEWHERE.iter().find(|(name, of, _)| *name == page.name && *of == kind).map(|(_, _, test)| *test)
}

/// Whether something runs a block. `text` is a formula, a fragment, or what a program prints.
fn is_run(page: &Page, block: &Block) -> Result<(), String> {
    if let Some(test) = elsewhere(page, &block.kind) {
        let is_named = read(test).contains(&page.name);
        return is_named.then_some(()).ok_or(format!("{test} does not name it"));
    }
    match (&*block.kind, &*block.argument) {
        _ if block.not_run.as_ref().is_some_and(|reason| reason.len() > 10) => Ok(()),
        ("text" | "mbs" | "sh" | "console", _) => Ok(()),
        ("json", _) => serde_json::from_str::<serde_json::Value>(&block.text).map(drop).map_err(|e| e.to_string()),
        ("rust", "") => {
            let examples = format!("include_str!(\"../../docs/{}\")", page.name);
            read("tests/src/lib.rs")
                .contains(&examples)
                .then_some(())
                .ok_or(format!("no {examples} in tests/src/lib.rs"))
        }
        ("rust" | "toml", "Cargo.toml" | "build.rs" | "src/main.rs" | "tests/review.rs") if page.name == START => {
            Ok(())
        }
        ("rust" | "toml", file) if !file.is_empty() => is_of(&block.text, file),
        ("python" | "matlab", program) if needs(program).is_some() => Ok(()),
        _ => Err("mark it ` ```text `, or `<!-- not run: reason -->`".to_string()),
    }
}

/// The paragraphs of a block stand in a file of the repository.
fn is_of(text: &str, file: &str) -> Result<(), String> {
    let whole = fs::read_to_string(root().join(file)).map_err(|error| format!("{file}: {error}"))?;
    match text.trim_end().split("\n\n").find(|paragraph| !whole.contains(paragraph)) {
        Some(paragraph) => Err(format!("{file} has no\n{paragraph}")),
        None => Ok(()),
    }
}

/// `sympy` of `needs sympy`.
fn needs(argument: &str) -> Option<&str> {
    argument.strip_prefix("needs ")
}

#[test]
fn every_mechanism_of_the_book_is_generated_without_a_warning() {
    let (mut reports, mut count) = (String::new(), 0);
    for page in book().iter().filter(|page| elsewhere(page, "mbs").is_none()) {
        for block in blocks(&page.text).iter().filter(|block| block.kind == "mbs") {
            let name = format!("docs/{}, block from line {}", page.name, block.line);
            let sources = Sources::gather(&name, &block.text, |_| Err(Unreadable::new("a page imports nothing", "")));
            let graph = Graph::verbatim();
            match Analysis::of(&sources, &graph).and_then(|analysis| analysis.rust(&Options::default())) {
                Ok(generated) => reports += &generated.warnings,
                Err(error) => reports += &error.render_in(&sources),
            }
            count += 1;
        }
    }
    assert!(reports.is_empty(), "{reports}");
    assert!(count >= 5, "{count} mechanisms found in the book");
}

/// A program of a page: its place, what it needs, its text, and what the block of `text` behind it shows.
struct Program {
    place: String,
    needs: String,
    text: String,
    shown: String,
}

/// The programs of a kind that say what they need.
fn programs(kind: &str) -> Vec<Program> {
    let mut found = Vec::new();
    for page in book() {
        let blocks = blocks(&page.text);
        for (block, next) in blocks.iter().zip(blocks.iter().skip(1)) {
            let is_program = block.kind == kind && block.not_run.is_none();
            if let Some(needs) = needs(&block.argument).filter(|_| is_program) {
                let place = format!("docs/{}:{}", page.name, block.line);
                assert_eq!(next.kind, "text", "{place}: what it prints is shown behind it");
                found.push(Program { place, needs: needs.into(), text: block.text.clone(), shown: next.text.clone() });
            }
        }
    }
    found
}

/// Runs programs in a folder of their own, by an interpreter whose first arguments are given, the program being a file.
fn run(program: &Program, interpreter: &str, arguments: &[&str], file: &str, folder: &Path) {
    fs::write(folder.join(file), &program.text).expect("written");
    let output = Command::new(interpreter).args(arguments).arg(file).current_dir(folder).output().expect("it runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}: {}", program.place, text(&output));
    assert!(is_shown(&program.shown, &printed), "{} prints\n{printed}", program.place);
}

#[test]
fn python_of_the_book_prints_what_it_shows() {
    let python = std::env::var("MBS_PYTHON").unwrap_or("python3".to_string());
    let programs = programs("python");
    assert!(programs.len() >= 4, "{} programs found", programs.len());
    for program in programs {
        let import = ["-c", &format!("import numpy, {}", program.needs)];
        if Command::new(&python).args(import).output().is_ok_and(|output| output.status.success()) {
            let folder = tempfile::tempdir().expect("a folder");
            run(&program, &python, &["-W", "error"], "program.py", folder.path());
        } else {
            println!("skipped: {}, {python} has no numpy or no {}", program.place, program.needs);
        }
    }
}

#[test]
fn matlab_of_the_book_prints_what_it_shows() {
    let programs = programs("matlab");
    assert!(!programs.is_empty(), "no program found");
    for program in programs {
        if Command::new("octave-cli").arg("--version").output().is_ok_and(|output| output.status.success()) {
            let folder = tempfile::tempdir().expect("a folder");
            let (_, mechanism) =
                mbs_models::SOURCES.iter().find(|(name, _)| *name == program.needs).expect("a mechanism");
            let file = format!("{}.mbs", program.needs);
            let graph = Graph::verbatim();
            let analysis = Analysis::of(&Sources::new(&file, mechanism), &graph).expect("a mechanism");
            let code = Language::Matlab.write(analysis.programs(), &file, &Options::default());
            fs::write(folder.path().join(format!("{}.m", program.needs)), code).expect("written");
            run(&program, "octave-cli", &["--quiet", "--norc"], "program.m", folder.path());
        } else {
            println!("skipped: {}, there is no octave-cli", program.place);
        }
    }
}

/// The page that makes a crate.
const START: &str = "start.md";

/// The block of the first page whose fence is this.
fn start(kind: &str, argument: &str) -> String {
    let page = book().into_iter().find(|page| page.name == START).expect("the first page");
    let block = blocks(&page.text).into_iter().find(|block| block.kind == kind && block.argument == argument);
    block.unwrap_or_else(|| panic!("docs/{START} has no block {kind},{argument}")).text
}

#[test]
fn the_first_page_makes_a_crate() {
    let crate_ = Downstream::new("start", &start("toml", "Cargo.toml"));
    crate_.write("mechanisms/pendulum.mbs", &start("mbs", "pendulum.mbs"));
    crate_.write("build.rs", &start("rust", "build.rs"));
    crate_.write("src/main.rs", &start("rust", "src/main.rs"));
    let run = crate_.cargo(&["run"]);
    let printed = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success() && is_shown(&start("text", "printed"), &printed), "{}", text(&run));

    // The review is that of `examples/downstream`, which CI runs.
    let review = start("rust", "tests/review.rs").replace("pendulum", "crane");
    assert!(read("examples/downstream/tests/review.rs").ends_with(&review), "{review}");
}
