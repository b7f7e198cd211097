//! Derives a mechanism's equations of motion from its energies, proves them, and emits them as Rust.
//!
//! A mechanism is a file of energies in a small language; [`generate`] turns its text into a module of readable
//! `no_std` Rust. Build scripts call [`compile`] or [`Config`], which do the same for files:
//!
//! ```no_run
//! // build.rs
//! mbs_derive::compile("mechanisms/cart_pole.mbs");
//! ```
//!
//! and the crate includes the module with `mbs_runtime::include_mechanism!("cart_pole");`.
//!
//! The generator is a straight pipeline; each pass is a function from the former one's result to its own:
//!
//! ```text
//! text ──parse──▶ Declaration ──model──▶ Lagrangian ──derive──▶ Equations ──optimise──▶ Derivation (Programs)
//!      ──verify──▶ the Programs proved against the energies ──emit──▶ Rust
//!                                                           └─interpret──▶ numbers, in process
//! ```
//!
//! - [`expr`]: the calculus: a hash-consed expression graph with exact constants, and its derivatives;
//! - [`parse`], [`model`]: the language; [`builder`]: mechanisms written as Rust values, in place of a text;
//! - [`Analysis`]: what is derived from one mechanism, pass by pass;
//! - [`derive`](mod@derive): mechanics: Lagrange's equations, still symbolic;
//! - `catalogue`: every generated function, declared once ([`optimise::FunctionKind`]);
//! - [`optimise`]: straight-line programs and their operation counts;
//! - [`verify`]: the proof; [`interpret`]: Programs run in process; [`emit`]: Rust; [`latex`]: equations on paper;
//! - [`span`], [`state`], [`variable`], [`numeric`]: what several passes need, and no mechanics;
//! - [`diagnostic`]: what is wrong with a declaration, where, and what to write instead;
//! - [`source`]: the files of a mechanism: its own, and those that it imports;
//! - [`review`](mod@review): a mechanism as people review it;
//! - [`cargo`]: build scripts, the only input and output.

mod analysis;
pub mod builder;
pub mod cargo;
mod catalogue;
pub mod derive;
pub mod diagnostic;
pub mod emit;
mod equations;
pub mod expr;
pub mod interpret;
pub mod latex;
pub mod model;
pub mod numeric;
pub mod optimise;
pub mod parse;
pub mod review;
mod shape;
pub mod source;
pub mod span;
pub mod state;
pub mod variable;
pub mod verify;

use std::fmt;

pub use analysis::Analysis;
pub use cargo::{Config, compile, review, try_compile};
use diagnostic::Diagnostics;
use expr::Graph;
use model::Lagrangian;
use optimise::Derivation;
use source::Sources;

/// A generated module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Generated {
    /// The module's name, snake case of the mechanism's.
    pub module: String,
    /// The name of the mechanism's struct: `r#loop` where that is a keyword of Rust.
    pub name: String,
    /// Number of coordinates.
    pub dof: usize,
    /// Number of inputs.
    pub inputs: usize,
    /// Whether the module implements `mbs_runtime::Mechanism`; not where motions are given at run time.
    pub implements_mechanism: bool,
    /// The module's text.
    pub code: String,
    /// Warnings, rendered with the source underlined; empty where there are none.
    pub warnings: String,
}

/// Why nothing was generated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The declaration is wrong.
    Declaration(Diagnostics),
    /// The derivation could not be proved.
    Proof(verify::Failure),
    /// A function that was asked for is not generated for this mechanism.
    UnknownFunction {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
}

impl Error {
    /// The report for people: file, line, column, the text underlined, and what to write instead. For a mechanism that
    /// imports nothing; else see [`render_in`](Self::render_in).
    pub fn render(&self, file_name: &str, source: &str) -> String {
        self.render_in(&Sources::new(file_name, source))
    }

    /// The report for people: file, line, column, the text underlined, and what to write instead.
    pub fn render_in(&self, sources: &Sources) -> String {
        match self {
            Error::Declaration(diagnostics) => diagnostics.render_in(sources),
            Error::Proof(_) | Error::UnknownFunction { .. } => {
                format!("error: {self}\n --> {}:1:1\n", sources.main().name)
            }
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Declaration(diagnostics) => diagnostics.fmt(f),
            Error::Proof(failure) => failure.fmt(f),
            Error::UnknownFunction { name, known } => {
                write!(f, "there is no function `{name}` to generate; there are {}", known.join(", "))
            }
        }
    }
}

impl std::error::Error for Error {}

impl From<Diagnostics> for Error {
    fn from(diagnostics: Diagnostics) -> Self {
        Error::Declaration(diagnostics)
    }
}

impl From<verify::Failure> for Error {
    fn from(failure: verify::Failure) -> Self {
        Error::Proof(failure)
    }
}

/// The text of a mechanism that imports nothing → a module of Rust, proved.
///
/// `file_name` is what the module's first line and the reports call the source.
///
/// # Errors
/// [`Error::Declaration`] if the text is not a mechanism, [`Error::Proof`] if the derived code disagrees with the
/// energies, [`Error::UnknownFunction`] if the options ask for a function that there is not.
pub fn generate(file_name: &str, source: &str, options: &emit::Options) -> Result<Generated, Error> {
    generate_from(&Sources::new(file_name, source), options)
}

/// The texts of a mechanism and of all that it imports → a module of Rust, proved.
///
/// # Errors
/// As [`generate`].
pub fn generate_from(sources: &Sources, options: &emit::Options) -> Result<Generated, Error> {
    Analysis::frozen(sources, &Graph::verbatim(), &options.freeze)?.rust(options)
}

/// `parse` and `model`: the text of a mechanism that imports nothing → its Lagrangian, and warnings. The parameters
/// named in `freeze` become constants.
///
/// # Errors
/// All mistakes of the first pass that finds any.
pub fn declared<'g>(
    source: &str,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    declared_from(&Sources::new("", source), graph, freeze)
}

/// `parse` and `model`: the texts of a mechanism and of all that it imports → its Lagrangian, and warnings. The
/// parameters named in `freeze` become constants.
///
/// # Errors
/// All mistakes of the first pass that finds any.
pub fn declared_from<'g>(
    sources: &Sources,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    resolved(parse::declaration_of(sources)?, graph, freeze)
}

/// `model`, with the parameters named in `freeze` as constants.
fn resolved<'g>(
    mut declaration: parse::syntax::Declaration,
    graph: &'g Graph,
    freeze: &[String],
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    declaration.freeze(freeze)?;
    model::resolve(&declaration, graph)
}

/// What each function of [`derived`] would cost by each route, those for comparison included; in the same order.
pub fn compared(lagrangian: &Lagrangian<'_>) -> Vec<Vec<(derive::Route, optimise::Operations)>> {
    let graph = Graph::new();
    optimise::compared(&derive::all_routes(lagrangian, &graph))
}

/// `derive` and `optimise`: a Lagrangian → its Programs, not yet proved.
pub fn derived(lagrangian: &Lagrangian<'_>) -> Derivation {
    let graph = Graph::new();
    optimise::straight_line(lagrangian, &derive::routes(lagrangian, &graph))
}
