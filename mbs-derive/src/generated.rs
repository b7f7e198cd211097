//! What a generation comes to: a module, or the reason why there is none.

use std::fmt;
use std::ops::Range;

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::Sources;
use crate::verify::Failure;

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
    /// Number of rows of the constraints.
    pub constraints: usize,
    /// Whether the module implements `mbs_runtime::Mechanism`; not where only some functions were asked for.
    pub implements_mechanism: bool,
    /// The module's text.
    pub code: String,
    /// The module in the other languages that were asked for: the name of a file, and its text.
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
    Proof(Failure),
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
                let codes: String = self.codes().iter().map(|code| format!("[{code}]")).collect();
                format!("error{codes}: {self}\n --> {}:1:1\n", sources.main().name)
            }
        }
    }

    /// Its messages; those that are about the mechanism as a whole at `span`.
    pub fn at(&self, span: Range<usize>) -> Diagnostics {
        let code = match self {
            Error::Declaration(diagnostics) => return diagnostics.clone(),
            Error::Proof(failure) => failure.code(),
            Error::UnknownFunction { .. } => Code::UnknownRequest,
        };
        let mut diagnostics = Diagnostics::default();
        diagnostics.error(code, span, self.to_string());
        diagnostics
    }

    /// The code of each message, as `mbs explain` knows it.
    ///
    /// ```
    /// let text = "mechanism Spring { coord x: m; potential += x^2; }";
    /// let error = mbs_derive::generate("spring.mbs", text, &Default::default()).unwrap_err();
    /// assert_eq!(error.codes(), ["MBS0801"]);
    /// ```
    pub fn codes(&self) -> Vec<String> {
        match self {
            Error::Declaration(diagnostics) => diagnostics.iter().map(Diagnostic::code).collect(),
            Error::Proof(failure) => vec![failure.code().to_string()],
            Error::UnknownFunction { .. } => vec![Code::UnknownRequest.to_string()],
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

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        Error::Proof(failure)
    }
}
