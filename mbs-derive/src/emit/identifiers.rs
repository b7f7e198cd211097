//! What a text in another language than Rust calls things, and what it has in common with others: for who reads it.

use crate::optimise::Derivation;

use super::walk::Walk;
use super::{Language, Options, c, script};

/// Names in a text.
#[derive(Clone, Debug)]
pub(crate) struct Identifiers {
    /// The class or function of the mechanism; in C what all names begin with.
    pub(crate) mechanism: String,
    /// The class of C++.
    pub(crate) class: String,
    /// The fields of the parameters, in their order.
    pub(crate) parameters: Vec<String>,
    /// The functions that are there: their numbers, their names where they are defined, and those that callers know.
    pub(crate) functions: Vec<(usize, String, String)>,
    /// What functions with constraints have in common.
    pub(crate) motion: String,
}

impl Identifiers {
    /// Of a text that was written with these options.
    pub(crate) fn of(language: Language, derivation: &Derivation, options: &Options) -> Self {
        let walk = Walk::new(derivation, "", options);
        match language {
            Language::Js => script::js::identifiers(&walk),
            Language::Python => script::python::identifiers(&walk),
            Language::Matlab => script::matlab::identifiers(&walk),
            Language::Rust | Language::C | Language::Cpp | Language::Cuda | Language::Opencl => c::identifiers(walk),
        }
    }
}

/// The pieces of which texts in a language have those that they need, in their order.
pub(crate) fn shared(language: Language) -> Vec<&'static str> {
    match language {
        Language::Rust => Vec::new(),
        Language::C | Language::Cpp | Language::Cuda | Language::Opencl => c::shared(language),
        Language::Js => script::pieces(script::js::SHARED).collect(),
        Language::Python => script::pieces(script::python::SHARED).collect(),
        Language::Matlab => script::pieces(script::matlab::SHARED).collect(),
    }
}
