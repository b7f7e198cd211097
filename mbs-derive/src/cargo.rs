//! For build scripts: the only input and output of this crate.

use std::fs;
use std::path::{Path, PathBuf};

use crate::emit::Options;
use crate::{Generated, generate, parse};

/// Generates one mechanism with default options, for `mbs_runtime::include_mechanism!`.
///
/// To be called from a build script. The module goes to `OUT_DIR`, under its own name: `CartPole` to `cart_pole.rs`. If the
/// file cannot be read, is not a mechanism or cannot be proved, the report is printed and the script exits with 1.
///
/// ```no_run
/// mbs_derive::compile("mechanisms/cart_pole.mbs");
/// ```
pub fn compile(file: impl AsRef<Path>) {
    Config::new().compile(file);
}

/// Options of a generation.
///
/// ```no_run
/// mbs_derive::Config::new().serde(true).freeze(["g"]).compile("mechanisms/cart_pole.mbs");
/// ```
#[derive(Clone, Debug, Default)]
#[must_use]
pub struct Config {
    options: Options,
    out_dir: Option<PathBuf>,
}

impl Config {
    /// The defaults: no serde, all functions, all parameters at run time, output to `OUT_DIR`.
    pub fn new() -> Self {
        Self::default()
    }

    /// Derives serde's traits for `Params`, through the feature `serde` of mbs-runtime.
    pub fn serde(mut self, serde: bool) -> Self {
        self.options.serde = serde;
        self
    }

    /// Makes parameters constants with their declared defaults: shorter code, a smaller `Params`.
    pub fn freeze<S: Into<String>>(mut self, parameters: impl IntoIterator<Item = S>) -> Self {
        self.options.freeze.extend(parameters.into_iter().map(Into::into));
        self
    }

    /// Generates only these functions (and what they call). The trait `Mechanism` is implemented only where all that it
    /// needs is among them.
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.options.functions.get_or_insert_default().extend(names.into_iter().map(Into::into));
        self
    }

    /// Writes to this folder instead of `OUT_DIR`: for code that is checked in.
    pub fn out_dir(mut self, folder: impl Into<PathBuf>) -> Self {
        self.out_dir = Some(folder.into());
        self
    }

    /// Generates one mechanism; see [`compile`].
    pub fn compile(&self, file: impl AsRef<Path>) {
        println!("cargo::rerun-if-changed={}", file.as_ref().display());
        or_exit(self.write(file.as_ref()));
    }

    /// Generates every `.mbs` file of a folder, sorted by name, and `mechanisms.rs`, which includes them all, lists their
    /// texts in `SOURCES` and `GENERATED`, and hands every mechanism to a macro of your choice:
    /// `for_each_mechanism!(callback)` becomes `callback! { cart_pole CartPole 2 1; … }`, module, type, number of
    /// coordinates and of inputs.
    ///
    /// `include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));`
    pub fn compile_folder(&self, folder: impl AsRef<Path>) {
        println!("cargo::rerun-if-changed={}", folder.as_ref().display());
        or_exit(self.write_folder(folder.as_ref()));
    }

    fn write(&self, file: &Path) -> Result<Generated, String> {
        let name = file.to_string_lossy();
        let bytes = fs::read(file).map_err(|e| format!("error: cannot read {name}: {e}"))?;
        let source = parse::text(&name, bytes)?;
        let generated = generate(&name, &source, &self.options).map_err(|e| e.render(&name, &source))?;
        for line in generated.warnings.lines() {
            println!("cargo::warning={line}");
        }
        self.write_file(&generated.module, &generated.code)?;
        Ok(generated)
    }

    fn write_folder(&self, folder: &Path) -> Result<(), String> {
        let name = folder.display();
        let entries = fs::read_dir(folder).map_err(|e| format!("error: cannot read {name}: {e}"))?;
        let mut files: Vec<PathBuf> = entries
            .filter_map(|entry| entry.ok().map(|e| e.path()))
            .filter(|path| path.extension().is_some_and(|e| e == "mbs"))
            .collect();
        files.sort();
        let mut generated = Vec::new();
        for file in files {
            println!("cargo::rerun-if-changed={}", file.display());
            generated.push((self.write(&file)?, file));
        }
        self.write_file("mechanisms", &index(&generated))
    }

    /// Whole or not at all: written beside and renamed.
    fn write_file(&self, module: &str, code: &str) -> Result<(), String> {
        let folder = match (&self.out_dir, std::env::var_os("OUT_DIR")) {
            (Some(folder), _) => folder.clone(),
            (None, Some(folder)) => PathBuf::from(folder),
            (None, None) => {
                return Err("error: OUT_DIR is not set: call this from a build script, or name a folder with \
                            `Config::out_dir`"
                    .to_string());
            }
        };
        let path = folder.join(format!("{module}.rs"));
        let beside = folder.join(format!("{module}.rs.new"));
        fs::write(&beside, code)
            .and_then(|()| fs::rename(&beside, &path))
            .map_err(|e| format!("error: cannot write {}: {e}", path.display()))
    }
}

/// The file that includes all mechanisms of a folder.
fn index(generated: &[(Generated, PathBuf)]) -> String {
    let mut text = String::from("// Generated by mbs. Do not edit.\n\n");
    for (mechanism, _) in generated {
        text += &format!("include!(concat!(env!(\"OUT_DIR\"), \"/{}.rs\"));\n", mechanism.module);
    }
    text += "\n/// The declarations of all mechanisms: module and text, sorted by file name.\n";
    text += "pub const SOURCES: &[(&str, &str)] = &[\n";
    for (mechanism, file) in generated {
        let path = format!("/{}", file.display());
        text +=
            &format!("    ({:?}, include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {path:?}))),\n", mechanism.module);
    }
    text += "];\n\n/// The generated code of all mechanisms: module and text, for snapshots.\n";
    text += "pub const GENERATED: &[(&str, &str)] = &[\n";
    for (mechanism, _) in generated {
        let module = &mechanism.module;
        text += &format!("    ({module:?}, include_str!(concat!(env!(\"OUT_DIR\"), \"/{module}.rs\"))),\n");
    }
    text += "];\n\n/// Calls a macro with every mechanism: module, type, number of coordinates and of inputs.\n";
    text += "#[macro_export]\nmacro_rules! for_each_mechanism {\n    ($callback:ident) => {\n        $callback! {\n";
    for (mechanism, _) in generated {
        let Generated { module, name, dof, inputs, .. } = mechanism;
        text += &format!("            {module} {name} {dof} {inputs};\n");
    }
    text + "        }\n    };\n}\n"
}

/// A build script prints the report and exits with 1; no panic, no trace.
fn or_exit<T>(result: Result<T, String>) {
    if let Err(report) = result {
        eprintln!("{report}");
        std::process::exit(1);
    }
}
