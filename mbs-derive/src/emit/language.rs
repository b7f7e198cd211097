//! The languages that a derivation is written in: one list for the command line and for build scripts.

use crate::optimise::Derivation;

use super::c::{Dialect, c, written};
use super::name::snake_case;
use super::{Options, rust};

/// A language that a mechanism is written in.
///
/// ```
/// use mbs_derive::emit::Language;
/// assert_eq!(Language::ALL.map(Language::name), ["rust", "c", "cpp", "cuda", "opencl"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Language {
    /// A module of Rust for mbs-runtime.
    Rust,
    /// A header of C99.
    C,
    /// The header as C++17.
    Cpp,
    /// The header for CUDA and HIP.
    Cuda,
    /// The header as OpenCL C.
    Opencl,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 5] = [Language::Rust, Language::C, Language::Cpp, Language::Cuda, Language::Opencl];

    /// What `mbs derive --emit` calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Language::Rust => "rust",
            Language::C => "c",
            Language::Cpp => "cpp",
            Language::Cuda => "cuda",
            Language::Opencl => "opencl",
        }
    }

    /// The file of a mechanism: its name in snake case, and the ending of the language.
    #[must_use]
    pub fn file_name(self, derivation: &Derivation) -> String {
        let ending = match self {
            Language::Rust => "rs",
            Language::C => "h",
            Language::Cpp => "hpp",
            Language::Cuda => "cuh",
            Language::Opencl => "cl",
        };
        format!("{}.{ending}", snake_case(&derivation.name))
    }

    /// The text of that file; `source` is what its first line calls the declaration.
    #[must_use]
    pub fn write(self, derivation: &Derivation, source: &str, options: &Options) -> String {
        match self {
            Language::Rust => rust(derivation, source, options),
            Language::C => c(derivation, source, options),
            Language::Cpp => written(derivation, source, options, Dialect::Cpp),
            Language::Cuda => written(derivation, source, options, Dialect::Cuda),
            Language::Opencl => written(derivation, source, options, Dialect::OpenCl),
        }
    }
}
