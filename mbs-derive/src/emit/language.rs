//! The languages that a derivation is written in: one list for the command line and for build scripts.

use crate::optimise::Derivation;

use super::c::{Dialect, c, written};
use super::name::{Names, snake_case};
use super::{Options, Trigonometry, doc, rust, script};

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

    /// The file of a mechanism: its name in snake case, which Python and MATLAB must be able to import, and the ending
    /// of the language.
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
            Language::Matlab => script::matlab::file(&stem),
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

    /// What the generated functions are called, without the escapes of a language, and what their documentation says,
    /// line by line; in the order of the derivation.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Spring { param k: N/m = 4; coord x: m; potential += k*x^2/2; kinetic += 1 kg*dt(x)^2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
    /// let functions = mbs_derive::emit::Language::documented(analysis.programs());
    /// assert!(functions.iter().any(|(name, docs)| name == "mass_matrix" && docs[0].contains("M")));
    /// ```
    pub fn documented(derivation: &Derivation) -> Vec<(String, Vec<String>)> {
        let names = Names::of(derivation, Trigonometry::default()).functions;
        let plain = |name: String| name.strip_prefix("r#").map_or(name.clone(), str::to_string);
        let functions = names.into_iter().zip(&derivation.functions);
        functions.map(|(name, function)| (plain(name), doc::function(derivation, function, false))).collect()
    }
}
