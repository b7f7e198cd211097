//! Mutants: single changes of the source that a test must notice.
//!
//! A table, `tests/mutants/*.txt`, is a list of entries between empty lines; lines that begin with `#` are remarks:
//!
//! ```text
//! event: order of two events backwards
//! in mbs-runtime/src/event.rs
//! - else { x.max(y) }
//! + else { x.min(y) }
//! test -p mbs-runtime --lib event
//! ```
//!
//! The text after `- ` occurs once in the file, and that after `+ ` takes its place; the arguments after `test ` are
//! those of `cargo test`. The program `mutants` of this crate tries them.

use std::path::Path;

/// One change of the source, and the test that must fail for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mutant {
    /// What is wrong with it.
    pub name: String,
    /// The file, from the root of the repository.
    pub file: String,
    /// What is replaced, which occurs once.
    pub original: String,
    /// What stands there instead.
    pub replacement: String,
    /// The arguments of `cargo test`.
    pub test: Vec<String>,
}

/// The mutants of a table.
///
/// # Errors
/// What is wrong with an entry.
pub fn parse(table: &str) -> Result<Vec<Mutant>, String> {
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    let entries = lines.split(|line| line.trim().is_empty()).filter(|entry| !entry.is_empty());
    entries.map(|entry| mutant(entry).map_err(|error| format!("{}: {error}", entry[0]))).collect()
}

fn mutant(entry: &[&str]) -> Result<Mutant, String> {
    let [name, file, original, replacement, test] = entry else {
        return Err(format!("{} lines, not 5", entry.len()));
    };
    let rest = |line: &str, begin: &str| {
        // An editor may have taken the blank from the end of a replacement by nothing.
        let line = if line == begin.trim_end() { begin } else { line };
        line.strip_prefix(begin).map(str::to_string).ok_or_else(|| format!("`{line}` does not begin with `{begin}`"))
    };
    Ok(Mutant {
        name: (*name).to_string(),
        file: rest(file, "in ")?,
        original: rest(original, "- ")?,
        replacement: rest(replacement, "+ ")?,
        test: rest(test, "test ")?.split_whitespace().map(str::to_string).collect(),
    })
}

impl Mutant {
    /// The source with the change.
    ///
    /// # Errors
    /// What is wrong: the original is not there, or more than once, or stays.
    pub fn apply(&self, source: &str) -> Result<String, String> {
        match source.matches(&self.original).count() {
            1 if self.original != self.replacement => Ok(source.replacen(&self.original, &self.replacement, 1)),
            1 => Err(format!("{}: nothing changes", self.name)),
            count => Err(format!("{}: `{}` occurs {count} times in {}, not once", self.name, self.original, self.file)),
        }
    }

    /// The file with the change, read from a copy of the repository.
    ///
    /// # Errors
    /// As [`apply`](Self::apply), or that the file cannot be read.
    pub fn apply_in(&self, root: &Path) -> Result<String, String> {
        let source =
            std::fs::read_to_string(root.join(&self.file)).map_err(|error| format!("{}: {error}", self.file))?;
        self.apply(&source)
    }
}
