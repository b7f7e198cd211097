//! Why there is no library, and why a call is refused.

use std::path::PathBuf;

/// Why functions are not compiled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotCompiled {
    /// None of the compilers that were asked for is there.
    #[error("there is no C compiler{}", named(.names))]
    NoCompiler {
        /// What was asked for.
        names: Vec<String>,
    },
    /// Every compiler that is there fails.
    #[error("{}", .reports.join("; "))]
    Failed {
        /// What each says, with its name.
        reports: Vec<String>,
    },
    /// The folder of what is compiled cannot be used.
    #[error("{}: {error}", .folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The C code, read again, is not what it was printed from: a mistake of the generator.
    #[error("{reason}")]
    Misprint {
        /// Where.
        reason: String,
    },
    /// The system does not load what was compiled.
    #[error("the compiled library cannot be loaded: {reason}")]
    Unloadable {
        /// What the system says.
        reason: String,
    },
}

fn named(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    if quoted.is_empty() { String::new() } else { format!(" {}", quoted.join(", ")) }
}

/// Why a call is refused: nothing was computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Misfit {
    /// This function is not compiled.
    #[error("the function with the number {number} is not compiled")]
    Function {
        /// Its number in the derivation.
        number: usize,
    },
    /// There are more or fewer parameters, arguments or results than the function has.
    #[error("{expected} {what} are wanted, found {found}")]
    Count {
        /// Parameters, arguments or results.
        what: &'static str,
        /// As many are wanted.
        expected: usize,
        /// As many are given.
        found: usize,
    },
    /// An argument or a result has fewer numbers than are read or written.
    #[error("{what} {place} has {found} numbers, at least {expected} are wanted")]
    Numbers {
        /// Whether it is an argument or a result.
        what: &'static str,
        /// From 0.
        place: usize,
        /// As many are read or written.
        expected: usize,
        /// As many are there.
        found: usize,
    },
}
