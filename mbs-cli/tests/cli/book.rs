//! The commands of the book, `docs/`, do what its pages show. `tests/generator/book.rs` sees to all other blocks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::page::{Block, blocks, is_shown, pages};

/// What a command of the book may begin with. What else a page tells to run is marked `<!-- not run: reason -->`.
const PROGRAMS: [&str; 3] = ["mbs ", "sed ", "head "];

/// The workspace; a package of mbs-cli alone has no book.
fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A command with what is shown of its output: all of it, or nothing.
struct Run {
    line: usize,
    command: String,
    shown: String,
}

/// `sh` has a command a line, `console` those behind `$` with what they print below; `\` at its end goes on.
fn runs(block: &Block) -> Vec<Run> {
    let mut found: Vec<Run> = Vec::new();
    for (line, text) in (block.line..).zip(block.text.lines()) {
        let command = if block.kind == "sh" { Some(text) } else { text.strip_prefix("$ ") };
        match (command, found.last_mut()) {
            (_, Some(run)) if run.command.ends_with('\\') => run.command.extend(["\n", text]),
            (Some(command), _) => found.push(Run { line, command: command.to_string(), shown: String::new() }),
            (None, Some(run)) => run.shown.extend([text, "\n"]),
            (None, None) => panic!("line {line}: {text} is printed by no command"),
        }
    }
    found
}

/// A folder in which a page's commands run: with the repository's folders, and the files that the page has itself.
fn workshop(repository: &Path, blocks: &[Block]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    #[cfg(unix)]
    for name in ["models", "examples", "tests"] {
        let there = fs::canonicalize(repository.join(name)).expect("a folder of the repository");
        std::os::unix::fs::symlink(there, folder.path().join(name)).expect("a link");
    }
    for block in blocks.iter().filter(|block| block.kind == "mbs" && !block.argument.is_empty()) {
        let path = folder.path().join(&block.argument);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, &block.text).expect("written");
    }
    folder
}

#[test]
#[cfg(unix)]
fn commands_of_the_book_print_what_it_shows() {
    let Some(pages) = pages(&repository().join("docs")) else { return };
    let program = Path::new(env!("CARGO_BIN_EXE_mbs"));
    let path = [program.parent().expect("a folder").as_os_str(), &std::env::var_os("PATH").unwrap_or_default()];
    let cache = tempfile::tempdir().expect("a folder");
    let (mut faults, mut count) = (String::new(), 0);
    for page in &pages {
        let blocks = blocks(&page.text);
        let commands: Vec<Run> = blocks
            .iter()
            .filter(|block| ["sh", "console"].contains(&&*block.kind) && block.not_run.is_none())
            .flat_map(runs)
            .collect();
        if commands.is_empty() {
            continue;
        }
        let folder = workshop(&repository(), &blocks);
        for Run { line, command, shown } in commands {
            assert!(
                PROGRAMS.iter().any(|program| command.starts_with(program)),
                "docs/{}:{line}: `{command}` is not run; mark its block `<!-- not run: reason -->`",
                page.name
            );
            let output = Command::new("sh")
                .args(["-c", &format!("{{ {command}\n}} 2>&1")])
                .current_dir(&folder)
                .env("PATH", path.join(std::ffi::OsStr::new(":")))
                .env("MBS_CACHE_DIR", cache.path())
                .output()
                .expect("a shell");
            let printed = String::from_utf8_lossy(&output.stdout);
            let is_meant_to_fail = shown.starts_with("error");
            if output.status.success() == is_meant_to_fail || !shown.is_empty() && !is_shown(&shown, &printed) {
                faults += &format!("docs/{}:{line}: $ {command}\n{printed}\n", page.name);
            }
            count += 1;
        }
    }
    assert!(faults.is_empty(), "what these print is not what is shown:\n{faults}");
    assert!(count >= 15, "{count} commands found in the book");
}
