//! Pass 6: [`Derivation`](crate::optimise::Derivation) → Rust and other languages, one module a mechanism.
//!
//! - `walk`: what all languages have in common: which statements stand where, with which names;
//! - `body`: one function body: bindings, then the result; `statement`: what it is made of;
//! - `links`: statements of one link together; `rolled`: those of long chains in loops over the links;
//! - `angles`: which sines and cosines one call computes;
//! - `expression`: values: order of operands, products that sums use;
//! - `shape`: the components of results;
//! - `doc`: what documentation says;
//! - `name`: identifiers, from the declaration where they can be;
//! - `rust`: how that is written in Rust; `c`: in C99, C++, CUDA and OpenCL C; `script`: in languages that are not
//!   compiled;
//! - `language`: the list of languages; `identifiers`: what a text in one of them calls things.

mod angles;
mod body;
mod c;
mod doc;
mod expression;
mod identifiers;
mod language;
mod links;
mod name;
mod rolled;
mod rust;
mod script;
mod shape;
mod statement;
mod walk;

pub use crate::expr::sin_cos::Trigonometry;
pub use c::Interface;
pub(crate) use identifiers::{Identifiers, shared};
pub use language::Language;
pub(crate) use rust::rust;
pub(crate) use rust::{implements_mechanism, module_name, outline, type_name, without_forwarders};

/// What is generated.
///
/// ```
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let options = mbs_derive::emit::Options::default().freeze(["k"]);
/// let module = mbs_derive::generate("spring.mbs", text, &options).unwrap();
/// assert!(!module.code.contains("pub k: T"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Options {
    /// Derive serde's traits for the parameters, through `::mbs_runtime::serde`. serde knows arrays of up to 32.
    pub serde: bool,
    /// Parameters that become constants with their declared defaults; carried out by `model`.
    pub freeze: Vec<String>,
    /// The functions to generate, with those that they call; `None` for all.
    pub functions: Option<Vec<String>>,
    /// Write `a * b + c` instead of `a.mul_add(b, c)`: for people who review the code. It computes the same bits where
    /// the target has no fused multiply–add.
    pub infix: bool,
    /// Which sines and cosines are computed.
    pub trigonometry: Trigonometry,
    /// Languages that the mechanism is written in besides Rust; carried out where files are made.
    pub languages: Vec<Language>,
}

impl Options {
    /// Derives serde's traits for the parameters, or does not.
    #[must_use]
    pub fn serde(mut self, serde: bool) -> Self {
        self.serde = serde;
        self
    }

    /// Makes these parameters constants, too.
    #[must_use]
    pub fn freeze<S: Into<String>>(mut self, parameters: impl IntoIterator<Item = S>) -> Self {
        self.freeze.extend(parameters.into_iter().map(Into::into));
        self
    }

    /// Generates these functions alone, with those that they call, added to those that were named before.
    ///
    /// Not derived either are C and G, the derivatives of inverse dynamics, and those of accelerations, where none of
    /// them is named: their cost grows with the square of the number of coordinates.
    #[must_use]
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.functions.get_or_insert_default().extend(names.into_iter().map(Into::into));
        self
    }

    /// Writes `a * b + c`, or `a.mul_add(b, c)`.
    #[must_use]
    pub fn infix(mut self, infix: bool) -> Self {
        self.infix = infix;
        self
    }

    /// Chooses the sines and cosines.
    #[must_use]
    pub fn trigonometry(mut self, trigonometry: Trigonometry) -> Self {
        self.trigonometry = trigonometry;
        self
    }

    /// Writes the mechanism in these languages as well.
    #[must_use]
    pub fn languages(mut self, languages: impl IntoIterator<Item = Language>) -> Self {
        self.languages.extend(languages);
        self
    }
}
