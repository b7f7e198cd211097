//! `mbs derive`: the generated code.
//!
//! - [`json`]: the programs as data;
//! - [`graph`]: the graph of all of them as data.

mod graph;
mod json;

use std::path::PathBuf;

use mbs_derive::emit;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;

use crate::cache::Cache;
use crate::failure::Failure;
use crate::files::Files;
use crate::{mechanism, output};

/// Derive and prove the equations of motion, and print them as code.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// What to print.
    #[arg(long, value_enum, default_value_t = Emit::Rust)]
    emit: Emit,
    /// Print it as it is reviewed: `a * b + c` for `a.mul_add(b, c)`; of a long module signatures, documentation,
    /// operation counts and digests, and what every function gives at three states.
    #[arg(long, conflicts_with = "emit")]
    review: bool,
    /// Write to a file instead of standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Emit {
    /// A module of Rust, as build scripts generate it.
    Rust,
    /// A header of C99, which is C++ as well.
    C,
    /// A document of LaTeX: symbols, outputs, energies, matrices, equations; what is long by its recursion.
    Latex,
    /// The expression graph, and the programs, one instruction a line, with names, shapes and operation counts.
    Json,
}

impl Emit {
    /// What it is kept as.
    fn name(self) -> &'static str {
        match self {
            Emit::Rust => "rust",
            Emit::C => "c",
            Emit::Latex => "latex",
            Emit::Json => "json",
        }
    }
}

/// Prints or writes the code.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut files = Files::default();
    let sources = mechanism::open(&arguments.file, &mut files)?;
    let what = if arguments.review { "review" } else { arguments.emit.name() };
    if let Some(out) = &arguments.out {
        [what, mechanism::MECHANISM].iter().for_each(|what| mechanism::note(what, &sources, cache, &mut files));
        files.writes("--out", out)?;
    }
    let text = match arguments.emit {
        _ if arguments.review => mechanism::code(what, &sources, cache, |derivation| reviewed(derivation, &sources))?,
        Emit::Rust => mechanism::code(what, &sources, cache, |derivation| rust(derivation, &sources))?,
        Emit::C => mechanism::code(what, &sources, cache, |derivation| c(derivation, &sources))?,
        Emit::Latex => mechanism::latex(what, &sources, cache)?,
        Emit::Json => mechanism::code(what, &sources, cache, json::programs)?,
    };
    match &arguments.out {
        None => output::print(&text),
        Some(path) => output::write(path, text.as_bytes()),
    }
}

fn rust(derivation: &Derivation, sources: &Sources) -> String {
    emit::rust(derivation, sources.portable_name(), &emit::Options::default())
}

fn c(derivation: &Derivation, sources: &Sources) -> String {
    emit::c(derivation, sources.portable_name(), &emit::Options::default())
}

fn reviewed(derivation: &Derivation, sources: &Sources) -> String {
    derivation.review(sources.portable_name())
}
