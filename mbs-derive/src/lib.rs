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
//! - [`verify`]: the proof; [`interpret`]: Programs run in process; [`emit`]: Rust; `latex`: equations on paper;
//! - `span`, `state`, [`variable`], [`numeric`]: what several passes need, and no mechanics;
//! - [`diagnostic`]: what is wrong with a declaration, where, and what to write instead;
//! - [`source`]: the files of a mechanism: its own, and those that it imports;
//! - `import`: robots of other formats, as texts of the language (feature `import`);
//! - `review`: a mechanism as people review it;
//! - `cargo`: build scripts, the only input and output.

mod analysis;
pub mod builder;
mod cargo;
mod catalogue;
pub mod derive;
pub mod diagnostic;
pub mod emit;
mod equations;
pub mod expr;
#[cfg(feature = "import")]
mod import;
pub mod interpret;
mod latex;
pub mod model;
pub mod numeric;
pub mod optimise;
pub mod parse;
mod review;
mod shape;
pub mod source;
mod span;
mod state;
pub mod variable;
pub mod verify;

use std::fmt;

pub use analysis::Analysis;
pub use cargo::{Config, Digest, Report, compile, read, review, try_compile};
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
    /// The same in the other languages that were asked for: the name of a file, and its text.
    pub others: Vec<(String, String)>,
    /// Warnings, rendered with the source underlined; empty where there are none.
    pub warnings: String,
}

/// Why nothing was generated.
///
/// ```
/// let text = "mechanism Spring { coord x: m; potential += x^2; }";
/// let error = mbs_derive::generate("spring.mbs", text, &Default::default()).unwrap_err();
/// assert!(error.render("spring.mbs", text).contains("--> spring.mbs:1:"));
/// ```
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
/// ```
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let module = mbs_derive::generate("spring.mbs", text, &Default::default()).unwrap();
/// assert_eq!((module.name.as_str(), module.dof, module.inputs), ("Spring", 1, 0));
/// assert!(module.code.contains("pub fn mass_matrix"));
/// ```
///
/// # Errors
/// [`Error::Declaration`] if the text is not a mechanism, [`Error::Proof`] if the derived code disagrees with the
/// energies, [`Error::UnknownFunction`] if the options ask for a function that there is not.
pub fn generate(file_name: &str, source: &str, options: &emit::Options) -> Result<Generated, Error> {
    generated(&Sources::new(file_name, source), options)
}

fn generated(sources: &Sources, options: &emit::Options) -> Result<Generated, Error> {
    Analysis::frozen(sources, &Graph::verbatim(), &options.freeze)?.rust(options)
}

/// `parse` and `model`: the text of a mechanism that imports nothing → its Lagrangian, and warnings. The parameters
/// named in `freeze` become constants.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let (lagrangian, warnings) = mbs_derive::declared(text, &graph, &[]).unwrap();
/// assert_eq!((lagrangian.dof(), warnings.iter().count()), (1, 0));
/// ```
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
pub(crate) fn declared_from<'g>(
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

/// `derive` and `optimise`: a Lagrangian → its Programs, not yet proved.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let (lagrangian, _) = mbs_derive::declared(text, &graph, &[]).unwrap();
/// let derivation = mbs_derive::derived(&lagrangian);
/// assert_eq!(derivation.named("inverse_dynamics").unwrap().operations.flops(), 2); // q̈ + k x
/// ```
pub fn derived(lagrangian: &Lagrangian<'_>) -> Derivation {
    let graph = Graph::new();
    optimise::straight_line(lagrangian, &derive::routes(lagrangian, &graph))
}
