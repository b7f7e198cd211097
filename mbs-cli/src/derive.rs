//! `mbs derive`: the generated code.
//!
//! - [`mod@json`]: the programs as data;
//! - [`graph`]: the graph of all of them as data.

mod graph;
mod json;

use std::path::PathBuf;

use mbs_derive::Error;
use mbs_derive::emit::{Language, Options, Trigonometry};
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use serde_json::json;

use crate::cache::Cache;
use crate::failure::Failure;
use crate::files::Files;
use crate::{mechanism, output};

/// Derive and prove the equations of motion, and print them as code.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs derive pendulum.mbs --emit c --out pendulum.h")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// What to print.
    #[arg(long, value_enum, default_value_t = Emit::Code(Language::Rust))]
    emit: Emit,
    /// Print it as it is reviewed: `a * b + c` for `a.mul_add(b, c)`; of a long module signatures, documentation,
    /// operation counts and digests, and what every function gives at three states.
    #[arg(long, conflicts_with = "emit")]
    review: bool,
    /// Which sines and cosines the code computes.
    #[arg(long, value_enum, value_name = "WHOSE", default_value_t = Sines::Polynomials, conflicts_with = "review")]
    trigonometry: Sines,
    /// Derive, prove and print these functions alone, with those that they call.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with = "review")]
    only: Vec<String>,
    /// Write to a file instead of standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Sines {
    /// Those of mbs-runtime: the same bits in every language and on every machine
    Polynomials,
    /// Those of the language's library; bits depend on it
    Library,
}

impl From<Sines> for Trigonometry {
    fn from(sines: Sines) -> Self {
        match sines {
            Sines::Polynomials => Trigonometry::Polynomials,
            Sines::Library => Trigonometry::Library,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Emit {
    Code(Language),
    Latex,
    Json,
}

impl Emit {
    /// What it is called, and kept as.
    fn name(self) -> &'static str {
        match self {
            Emit::Code(language) => language.name(),
            Emit::Latex => "latex",
            Emit::Json => "json",
        }
    }

    fn help(self) -> &'static str {
        match self {
            Emit::Code(Language::Rust) => "A module of Rust, as build scripts generate it",
            Emit::Code(Language::C) => "A header of C99, which is C++ as well",
            Emit::Code(Language::Cpp) => "The header as C++17",
            Emit::Code(Language::Cuda) => "The header for CUDA and HIP",
            Emit::Code(Language::Opencl) => "The header as OpenCL C",
            Emit::Code(Language::Python) => "A module of Python for NumPy",
            Emit::Code(Language::Js) => "An ES module of JavaScript",
            Emit::Code(Language::Matlab) => "A function of MATLAB and Octave",
            Emit::Latex => {
                "A document of LaTeX: symbols, outputs, energies, matrices, equations; what is long by its recursion"
            }
            Emit::Json => {
                "The expression graph, and the programs, one instruction a line, with names, shapes and operation counts"
            }
        }
    }
}

/// The languages of the generator, and what is read by other programs.
impl clap::ValueEnum for Emit {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [Emit; Language::ALL.len() + 2] = {
            let mut all = [Emit::Latex; Language::ALL.len() + 2];
            let mut i = 0;
            while i < Language::ALL.len() {
                all[i] = Emit::Code(Language::ALL[i]);
                i += 1;
            }
            all[i + 1] = Emit::Json;
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(clap::builder::PossibleValue::new(self.name()).help(self.help()))
    }
}

/// Prints or writes the code.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut files = Files::default();
    let sources = mechanism::open(&arguments.file, &mut files)?;
    let what = match arguments.trigonometry {
        _ if arguments.review => "review".to_string(),
        Sines::Polynomials => arguments.emit.name().to_string(),
        Sines::Library if matches!(arguments.emit, Emit::Code(_)) => format!("{} library", arguments.emit.name()),
        Sines::Library => {
            let message = format!("`--emit {}` computes no sines: leave `--trigonometry` out", arguments.emit.name());
            return Err(Failure::of_usage(message));
        }
    };
    if !arguments.only.is_empty() && !matches!(arguments.emit, Emit::Code(_)) {
        let message = format!("`--emit {}` is of all functions: leave `--only` out", arguments.emit.name());
        return Err(Failure::of_usage(message));
    }
    let what = match arguments.only.as_slice() {
        [] => what,
        names => format!("{what} only {}", names.join(",")),
    };
    let what = what.as_str();
    if let Some(out) = &arguments.out {
        [what, mechanism::MECHANISM].iter().for_each(|what| mechanism::note(what, &sources, cache, &mut files));
        files.writes("--out", out)?;
    }
    let text = match arguments.emit {
        _ if arguments.review => {
            mechanism::code(what, &sources, cache, |derivation| Ok(reviewed(derivation, &sources)))?
        }
        Emit::Code(language) => {
            let mut options = Options::default().trigonometry(arguments.trigonometry.into());
            if !arguments.only.is_empty() {
                options = options.functions(&arguments.only);
            }
            let write = |derivation: &Derivation| written(language, derivation, &sources, &options);
            match options.functions {
                None => mechanism::code(what, &sources, cache, write)?,
                Some(_) => mechanism::chosen(what, &sources, cache, &options, write)?,
            }
        }
        Emit::Latex => mechanism::latex(what, &sources, cache)?,
        Emit::Json => mechanism::code(what, &sources, cache, |derivation| Ok(json::programs(derivation)))?,
    };
    match &arguments.out {
        None if arguments.emit == Emit::Json => output::print(&text),
        None => output::answer(|| json!({ "emit": what, "text": text }), || text.clone()),
        Some(path) => output::write(path, text.as_bytes()).and_then(|()| output::wrote(&[path])),
    }
}

/// The code, read again.
fn written(language: Language, derivation: &Derivation, sources: &Sources, options: &Options) -> Result<String, Error> {
    let code = language.write(derivation, sources.portable_name(), options);
    derivation.proofread(language, options, &code)?;
    Ok(code)
}

fn reviewed(derivation: &Derivation, sources: &Sources) -> String {
    derivation.review(sources.portable_name())
}
