//! The languages that a derivation is written in: one list for the command line and for build scripts.

use crate::optimise::Derivation;

use super::c::{Dialect, c, written};
use super::name::snake_case;
use super::{Options, rust, script};

/// A language that a mechanism is written in.
///
/// ```
/// use mbs_derive::emit::Language;
/// assert_eq!(Language::ALL.map(Language::name), ["rust", "c", "cpp", "cuda", "opencl", "python", "js", "matlab"]);
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
    /// A module for NumPy.
    Python,
    /// An ES module.
    Js,
    /// A function of MATLAB and Octave.
    Matlab,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 8] = [
        Language::Rust,
        Language::C,
        Language::Cpp,
        Language::Cuda,
        Language::Opencl,
        Language::Python,
        Language::Js,
        Language::Matlab,
    ];

    /// What `mbs derive --emit` calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Language::Rust => "rust",
            Language::C => "c",
            Language::Cpp => "cpp",
            Language::Cuda => "cuda",
            Language::Opencl => "opencl",
            Language::Python => "python",
            Language::Js => "js",
            Language::Matlab => "matlab",
        }
    }

    /// The file of a mechanism: its name in snake case, which Python and MATLAB must be able to import, and the ending of
    /// the language.
    #[must_use]
    pub fn file_name(self, derivation: &Derivation) -> String {
        let ending = match self {
            Language::Rust => "rs",
            Language::C => "h",
            Language::Cpp => "hpp",
            Language::Cuda => "cuh",
            Language::Opencl => "cl",
            Language::Python => "py",
            Language::Js => "mjs",
            Language::Matlab => "m",
        };
        let stem = snake_case(&derivation.name);
        let stem = match self {
            Language::Python => script::python::identifier(&stem),
            Language::Matlab => script::matlab::identifier(&stem),
            _ => stem,
        };
        format!("{stem}.{ending}")
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
            Language::Python => script::python::python(derivation, source, options),
            Language::Js => script::js::js(derivation, source, options),
            Language::Matlab => script::matlab::matlab(derivation, source, options),
        }
    }
}
