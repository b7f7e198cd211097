//! For build scripts: the only input and output of this crate.
//!
//! A mechanism whose texts, options and generator are those of the last run is left as it is in `OUT_DIR`: see
//! [`Digest`].

mod digest;
mod kept;

use std::collections::BTreeMap;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::analysis::{self, Analysis};
use crate::builder::Mechanism;
use crate::diagnostic::{Code, nearest};
use crate::emit::{Language, Options, Trigonometry};
use crate::expr::Graph;
use crate::generated::{Error, Generated};
use crate::parse;
use crate::source::{MAX_BYTES, Sources, Unreadable};
pub use digest::Digest;
use kept::Kept;

/// Generates one mechanism with default options, for `mbs_runtime::include_mechanism!`.
///
/// To be called from a build script. The module goes to `OUT_DIR`, under its own name: `CartPole` to `cart_pole.rs`. If
/// the file cannot be read, is not a mechanism or cannot be proved, the script ends and cargo shows the report.
///
/// ```no_run
/// mbs_derive::compile("mechanisms/cart_pole.mbs");
/// ```
pub fn compile(file: impl AsRef<Path>) {
    Config::new().compile(file);
}

/// Generates one mechanism with default options as [`compile`] does, for a build script that handles the error itself.
/// After an error there is no module in `OUT_DIR`, not even that of an earlier run; folders of [`Config::out_dir`] stay
/// as they are.
///
/// ```no_run
/// if let Err(report) = mbs_derive::try_compile("mechanisms/cart_pole.mbs") {
///     println!("cargo::warning=without the cart: {}", report.to_string().lines().next().unwrap_or_default());
/// }
/// ```
///
/// # Errors
/// The report that `compile` prints: the file cannot be read, is not a mechanism, or cannot be proved.
pub fn try_compile(file: impl AsRef<Path>) -> Result<(), Report> {
    Config::new().try_compile(file)
}

/// A mechanism as it is reviewed, for a snapshot: the generated module with `a * b + c` for `a.mul_add(b, c)`; where
/// that is long, signatures, documentation, operation counts, digests of the bodies, and what every function gives at
/// three states.
///
/// ```no_run
/// // In a test, where mbs-derive is among the dev-dependencies: `insta::assert_snapshot!(text)`.
/// let text = mbs_derive::review("mechanisms/cart_pole.mbs").unwrap();
/// ```
///
/// # Errors
/// The report that a build script prints: the file cannot be read, is not a mechanism, or cannot be proved.
pub fn review(file: impl AsRef<Path>) -> Result<String, Report> {
    let sources = read(file.as_ref())?;
    let graph = Graph::verbatim();
    let proved =
        Analysis::of(&sources, &graph).and_then(|analysis| analysis.prove(analysis.programs()).map(|_| analysis));
    let analysis = proved.map_err(|error| Report(error.render_in(&sources)))?;
    Ok(analysis.programs().review(sources.portable_name()))
}

/// What is wrong, as a build script prints it: file, line, column, the text underlined, and what to write instead.
#[derive(Clone, PartialEq, Eq)]
pub struct Report(String);

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The report as it is: `unwrap` shows it with its lines.
impl fmt::Debug for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

impl std::error::Error for Report {}

impl From<String> for Report {
    fn from(report: String) -> Self {
        Report(report)
    }
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
        self.options = self.options.serde(serde);
        self
    }

    /// Makes parameters constants with their declared defaults: shorter code, a smaller `Params`.
    pub fn freeze<S: Into<String>>(mut self, parameters: impl IntoIterator<Item = S>) -> Self {
        self.options = self.options.freeze(parameters);
        self
    }

    /// Derives and generates only these functions (and what they call). Of the runtime's traits those are implemented
    /// all of whose functions are among them.
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.options = self.options.functions(names);
        self
    }

    /// Writes the mechanism in these languages as well, `cart_pole.h` beside `cart_pole.rs`.
    ///
    /// ```no_run
    /// use mbs_derive::{Config, emit::Language};
    /// Config::new().languages([Language::C]).out_dir("generated").compile("mechanisms/cart_pole.mbs");
    /// ```
    pub fn languages(mut self, languages: impl IntoIterator<Item = Language>) -> Self {
        self.options = self.options.languages(languages);
        self
    }

    /// Chooses between sines and cosines by polynomials, all at once, which is the default, and those of the standard
    /// library.
    pub fn trigonometry(mut self, trigonometry: Trigonometry) -> Self {
        self.options = self.options.trigonometry(trigonometry);
        self
    }

    /// Writes to this folder instead of `OUT_DIR`: for code that is checked in.
    pub fn out_dir(mut self, folder: impl Into<PathBuf>) -> Self {
        self.out_dir = Some(folder.into());
        self
    }

    /// Generates one mechanism; see [`compile`].
    pub fn compile(&self, file: impl AsRef<Path>) {
        or_exit(self.write(file.as_ref()));
    }

    /// Generates one mechanism; see [`try_compile`].
    ///
    /// # Errors
    /// The report that [`compile`](Self::compile) prints.
    pub fn try_compile(&self, file: impl AsRef<Path>) -> Result<(), Report> {
        self.write(file.as_ref()).map_err(|report| {
            self.forget(file.as_ref());
            Report(report)
        })
    }

    /// Generates a mechanism that is written as Rust values. Files that it was made of are the script's to name, by
    /// `cargo::rerun-if-changed`.
    pub fn compile_mechanism(&self, mechanism: &Mechanism) {
        or_exit(self.write_mechanism(mechanism));
    }

    /// Generates every `.mbs` file of a folder, sorted by name, and `mechanisms.rs`, which includes them all, lists
    /// their texts, with what they import put in place, in `SOURCES` and their code in `GENERATED`, and hands every
    /// mechanism to a macro of your choice:
    /// `for_each_mechanism!(callback)` becomes `callback! { cart_pole CartPole 2 1 0; … }`, module, type, numbers of
    /// coordinates, of inputs and of constraint rows; those that do not implement the trait `Mechanism`, for want of
    /// functions, are left out. Files without a mechanism, which hold `const` and `fn` to be imported, are only looked
    /// through.
    ///
    /// `include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));`
    pub fn compile_folder(&self, folder: impl AsRef<Path>) {
        println!("cargo::rerun-if-changed={}", folder.as_ref().display());
        or_exit(self.write_folder(folder.as_ref()));
    }

    fn write(&self, file: &Path) -> Result<(), String> {
        let made = self.make(watched(file)?)?;
        self.write_module(&made, &[&made.sources])
    }

    /// What an earlier run has made of a file has the equations of another text.
    fn forget(&self, file: &Path) {
        let Ok(Some(folder)) = self.folder_of_records() else { return };
        // A record is known by the file's path alone.
        let nothing = Sources::new(&file.to_string_lossy(), "");
        if let Some(kept) = Kept::new(&folder, &nothing, &self.options) {
            kept.forget(|_| true);
        }
    }

    fn write_mechanism(&self, mechanism: &Mechanism) -> Result<(), String> {
        let sources = mechanism.sources();
        let declaration = mechanism.declaration().map_err(|e| e.render_in(&sources))?;
        let folder = self.folder_of_records()?;
        let kept = folder.and_then(|folder| Kept::written(&folder, &declaration, &sources, &self.options));
        let made = self.made(sources, kept, |_| mechanism.generate(&self.options))?;
        self.write_module(&made, &[])
    }

    fn make(&self, sources: Sources) -> Result<Made, String> {
        let kept = self.folder_of_records()?.and_then(|folder| Kept::new(&folder, &sources, &self.options));
        self.made(sources, kept, |sources| analysis::generated(sources, &self.options))
    }

    /// What is kept of an earlier run, or what is generated now.
    fn made(
        &self,
        sources: Sources,
        kept: Option<Kept>,
        generate: impl FnOnce(&Sources) -> Result<Generated, Error>,
    ) -> Result<Made, String> {
        let generated = match kept.as_ref().and_then(Kept::read) {
            Some(generated) => generated,
            None => generate(&sources).map_err(|e| e.render_in(&sources))?,
        };
        tell(&generated.warnings);
        Ok(Made { generated, sources, kept })
    }

    /// Beside code that is checked in nothing is kept.
    fn folder_of_records(&self) -> Result<Option<PathBuf>, String> {
        self.out_dir.is_none().then(|| self.folder()).transpose()
    }

    /// Nothing is written before everything has been generated.
    fn write_folder(&self, folder: &Path) -> Result<(), String> {
        let mut mechanisms = Vec::new();
        for file in mechanism_files(folder)? {
            let sources = watched(&file)?;
            match parse::shared(&sources) {
                None => mechanisms.push(self.make(sources)?),
                Some(declarations) => drop(declarations.map_err(|e| e.render_in(&sources))?),
            }
        }
        check_modules(&mechanisms)?;
        let sources: Vec<&Sources> = mechanisms.iter().map(|made| &made.sources).collect();
        mechanisms.iter().try_for_each(|made| self.write_module(made, &sources))?;
        self.write_file(&format!("{INDEX}.rs"), &index(&mechanisms)?, &sources)
    }

    /// The record last: it is of the module that is there.
    fn write_module(&self, made: &Made, read: &[&Sources]) -> Result<(), String> {
        let (Generated { module, name, .. }, sources) = (&made.generated, &made.sources);
        let from = sources.call(&(0..0)).map_or_else(|| sources.main().name.clone(), |call| call.to_string());
        let path = self.folder()?.join(module);
        let is_other = |other: &&String| **other != from && !is_same(Path::new(*other), Path::new(&from));
        if let Some(other) = written().get(&path).filter(is_other) {
            return Err(format!(
                "error: `{name}` of {from} would be written to {module}.rs, as the mechanism of {other}\n  \
                 = help: give the mechanism another name\n"
            ));
        }
        // The mechanism may have had another name.
        made.kept.iter().for_each(|kept| kept.forget(|old| old.module != *module));
        self.write_files(&made.generated, read)?;
        written().insert(path, from);
        let Some((file, text)) = made.kept.as_ref().map(|kept| kept.record(&made.generated)) else { return Ok(()) };
        self.write_file(file, &text, read)
    }

    /// The module, and the files of other languages.
    fn write_files(&self, generated: &Generated, read: &[&Sources]) -> Result<(), String> {
        self.write_file(&format!("{}.rs", generated.module), &generated.code, read)?;
        generated.others.iter().try_for_each(|(file, text)| self.write_file(file, text, read))
    }

    fn folder(&self) -> Result<PathBuf, String> {
        self.out_dir.clone().or_else(|| std::env::var_os("OUT_DIR").map(PathBuf::from)).ok_or_else(|| {
            "error: OUT_DIR is not set: call this from a build script, or name a folder with `Config::out_dir`\n".into()
        })
    }

    /// Whole or not at all: written beside and renamed; never over a file that was read.
    fn write_file(&self, name: &str, text: &str, read: &[&Sources]) -> Result<(), String> {
        let folder = self.folder()?;
        let [path, beside] = [folder.join(name), folder.join(format!("{name}.new"))];
        for own in [&path, &beside] {
            if let Some(name) =
                read.iter().flat_map(|sources| sources.names()).find(|name| is_same(own, Path::new(name)))
            {
                let own = own.file_name().unwrap_or_default().display();
                return Err(format!("error: {own} would overwrite {name}, which was read\n"));
            }
        }
        // What is left of an earlier call may be a link to elsewhere.
        let _ = fs::remove_file(&beside);
        fs::write(&beside, text)
            .and_then(|()| fs::rename(&beside, &path))
            .map_err(|e| format!("error: cannot write {}: {e}", path.display()))
    }
}

/// The modules that this program has written, with what they were made of: of two mechanisms that a script calls alike,
/// the second would be written over the first.
fn written() -> MutexGuard<'static, BTreeMap<PathBuf, String>> {
    static WRITTEN: Mutex<BTreeMap<PathBuf, String>> = Mutex::new(BTreeMap::new());
    WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A mechanism of the folder.
struct Made {
    generated: Generated,
    sources: Sources,
    kept: Option<Kept>,
}

/// Whether two paths lead to one file, through whichever links.
fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

// ---- a folder of mechanisms

/// The file that includes all mechanisms of a folder.
const INDEX: &str = "mechanisms";

/// All `.mbs` files of a folder, sorted.
fn mechanism_files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let paths = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut files = paths().map_err(|e| format!("error: cannot read {}: {e}\n", folder.display()))?;
    files.retain(|path| path.extension().is_some_and(|e| e == "mbs"));
    files.sort();
    Ok(files)
}

/// Modules become files: two of one name would be written to one.
fn check_modules(mechanisms: &[Made]) -> Result<(), String> {
    let mut known: BTreeMap<&str, &str> = BTreeMap::new();
    for Made { generated: Generated { module, name, .. }, sources, .. } in mechanisms {
        let file = sources.main().name.as_str();
        let place = format!(" --> {file}:1:1\n  = help: give the mechanism another name\n");
        if module == INDEX {
            return Err(format!("error: `{name}` would be written to {INDEX}.rs, which lists all mechanisms\n{place}"));
        }
        if let Some(other) = known.insert(module, file) {
            return Err(format!(
                "error: `{name}` would be written to {module}.rs, as the mechanism of {other}\n{place}"
            ));
        }
    }
    Ok(())
}

/// It stands in the same folder as the modules, and includes them as what stands beside it.
fn index(mechanisms: &[Made]) -> Result<String, String> {
    let mut text = String::from("// Generated by mbs. Do not edit.\n\n");
    for Made { generated, .. } in mechanisms {
        text += &format!("include!(\"{}.rs\");\n", generated.module);
    }
    text += "\n/// The declarations of all mechanisms: module and text, sorted by file name; what they import stands in\n/// their texts, which need no other.\n";
    text += "pub const SOURCES: &[(&str, &str)] = &[\n";
    for Made { generated, sources, .. } in mechanisms {
        let whole = parse::in_one_text(sources).map_err(|e| e.render_in(sources))?;
        text += &format!("    ({:?}, {whole:?}),\n", generated.module);
    }
    text += "];\n\n/// The generated code of all mechanisms: module and text, for snapshots.\n";
    text += "pub const GENERATED: &[(&str, &str)] = &[\n";
    for Made { generated, .. } in mechanisms {
        text += &format!("    ({0:?}, include_str!(\"{0}.rs\")),\n", generated.module);
    }
    text += "];\n\n/// Calls a macro with every mechanism that implements the trait `Mechanism`: module, type, numbers of coordinates,\n";
    text += "/// of inputs and of constraint rows.\n";
    text += "#[macro_export]\nmacro_rules! for_each_mechanism {\n    ($callback:ident) => {\n        $callback! {\n";
    for Made { generated, .. } in mechanisms.iter().filter(|made| made.generated.implements_mechanism) {
        let Generated { module, name, dof, inputs, constraints, .. } = generated;
        text += &format!("            {module} {name} {dof} {inputs} {constraints};\n");
    }
    Ok(text + "        }\n    };\n}\n")
}

// ---- reading

/// Reads the file of a mechanism, and all that it imports.
///
/// ```no_run
/// let sources = mbs_derive::read("mechanisms/cart_pole.mbs".as_ref()).unwrap();
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let analysis = mbs_derive::Analysis::of(&sources, &graph).unwrap();
/// ```
///
/// # Errors
/// A report for people, if the file cannot be read or is not UTF-8. What is wrong with imports is told by the passes
/// that are given the result, at the place of the import.
pub fn read(file: &Path) -> Result<Sources, String> {
    let name = file.to_string_lossy();
    let bytes = bytes(file).map_err(|error| format!("error: cannot read {name}: {error}\n"))?;
    if bytes.len() > MAX_BYTES {
        return Err(format!("error[{}]: this file is larger than 64 MiB\n --> {name}:1:1\n", Code::TooLong));
    }
    let text = parse::text(&name, bytes)?;
    Ok(Sources::gather(&name, &text, import))
}

/// Reads, and tells cargo of every file, those that are not there included.
fn watched(file: &Path) -> Result<Sources, String> {
    println!("cargo::rerun-if-changed={}", file.display());
    let sources = read(file)?;
    sources.names().skip(1).for_each(|name| println!("cargo::rerun-if-changed={name}"));
    Ok(sources)
}

/// One byte more than is allowed shows that it is too large.
fn bytes(file: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(file)?.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn import(name: &str) -> Result<Vec<u8>, Unreadable> {
    // The folder that a path is seen from has no name.
    let path = Path::new(if name.is_empty() { "." } else { name });
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(Unreadable::new("it is a folder", "import its files one by one")),
        Ok(there) if !there.is_file() => Err(Unreadable::new("it is not a regular file", "import a file of text")),
        Ok(_) => bytes(path).map_err(|error| Unreadable::new(error.to_string(), "see that it can be read")),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(missing(path)),
        Err(error) => Err(Unreadable::new(error.to_string(), "see that it can be read")),
    }
}

fn missing(path: &Path) -> Unreadable {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let there = mechanism_files(folder).unwrap_or_default();
    let there: Vec<_> = there.iter().filter_map(|file| file.file_name()?.to_str()).collect();
    let help = match nearest(&wanted, there.iter().copied()).or(nearest(&format!("{wanted}.mbs"), there)) {
        Some(near) => format!("did you mean `{near}`, which is in that folder?"),
        None => "paths are seen from the folder of the file that they stand in".to_string(),
    };
    Unreadable::new(format!("there is no file `{}`", path.display()), help)
}

/// Ends the program on a report: a build script by what cargo reads, without a panic and cargo's account of the script;
/// any other program with exit code 1.
fn or_exit<T>(result: Result<T, String>) {
    if let Err(report) = result {
        tell(&report);
        std::process::exit(i32::from(!is_build_script()));
    }
}

/// `cargo run` and `cargo test` set `OUT_DIR` as well, the number of jobs cargo tells build scripts alone.
fn is_build_script() -> bool {
    ["OUT_DIR", "NUM_JOBS"].iter().all(|name| std::env::var_os(name).is_some())
}

/// Prints a report; in a build script for cargo, which writes `error:` or `warning:` and the package before each line.
fn tell(report: &str) {
    if is_build_script() {
        directives(report).iter().for_each(|line| println!("{line}"));
    } else {
        eprint!("{report}");
    }
}

/// A report, line by line, as cargo reads it from a build script.
fn directives(report: &str) -> Vec<String> {
    let mut severity = "error";
    let directive = |line| {
        let (of_block, text) = ["error", "warning"]
            .into_iter()
            .find_map(|name| Some((name, title(str::strip_prefix(line, name)?)?)))
            .unwrap_or((severity, line.to_string()));
        severity = of_block;
        format!("cargo::{severity}={text}")
    };
    report.lines().filter(|line| !line.is_empty()).map(directive).collect()
}

/// What stands behind `error` or `warning` where a message begins: `[MBS0101] …`, or without a code.
fn title(rest: &str) -> Option<String> {
    let coded = || rest.strip_prefix('[')?.split_once("]: ").map(|(code, text)| format!("[{code}] {text}"));
    rest.strip_prefix(": ").map(str::to_string).or_else(coded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cargo_says_once_what_is_an_error_and_what_a_warning() {
        let report = "error[MBS0501]: no `x`\n --> m.mbs:1:1\n  = help: declare it\n\nwarning: an angle\n --> m.mbs:2:1\n\n… and 3 more\n";
        let expected = "cargo::error=[MBS0501] no `x`\ncargo::error= --> m.mbs:1:1\ncargo::error=  = help: declare it\n\
                        cargo::warning=an angle\ncargo::warning= --> m.mbs:2:1\ncargo::warning=… and 3 more";
        assert_eq!(directives(report).join("\n"), expected);
    }

    #[test]
    fn code_does_not_replace_what_it_is_made_of() {
        let folder = std::env::temp_dir().join(format!("mbs_derive_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let text = "mechanism Spring { param m: kg = 1; coord x: m; kinetic += m*dt(x)^2; }";
        for name in ["spring.rs", "spring.rs.new"] {
            let file = folder.join(name);
            fs::write(&file, text).unwrap();
            let report = Config::new().out_dir(folder.join(".")).write(&file).unwrap_err();
            let left = fs::read_to_string(&file).unwrap();
            fs::remove_file(&file).unwrap();
            assert!(report.starts_with(&format!("error: {name} would overwrite ")) && left == text, "{report}");
        }
        // A link by which the module would be written elsewhere.
        let (file, linked) = (folder.join("spring.mbs"), folder.join("spring.rs.new"));
        fs::write(&file, text).unwrap();
        fs::hard_link(&file, &linked).unwrap();
        Config::new().out_dir(&folder).write(&file).unwrap();
        let left = fs::read_to_string(&file).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(left, text);
    }

    #[test]
    fn two_mechanisms_of_one_name_are_refused() {
        let folder = std::env::temp_dir().join(format!("mbs_derive_twice_{}", std::process::id()));
        let (config, place) = (Config::new().out_dir(&folder), |name: &str| folder.join(name));
        fs::create_dir_all(&folder).unwrap();
        let text = "mechanism Spring { param m: kg = 1; coord x: m; kinetic += m*dt(x)^2; }";
        ["a.mbs", "b.mbs"].iter().for_each(|name| fs::write(place(name), text).unwrap());
        let written = |name: &str| config.try_compile(place(name)).map_err(|report| report.to_string());
        let results = [written("a.mbs"), written("b.mbs"), written("./a.mbs")];
        fs::remove_dir_all(&folder).unwrap();
        let (a, b) = (place("a.mbs"), place("b.mbs"));
        let twice = format!(
            "error: `Spring` of {} would be written to spring.rs, as the mechanism of {}\n  \
             = help: give the mechanism another name\n",
            b.display(),
            a.display()
        );
        assert_eq!(results, [Ok(()), Err(twice), Ok(())]);
    }

    #[test]
    fn other_languages_are_written_beside_the_module() {
        let folder = std::env::temp_dir().join(format!("mbs_derive_languages_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let text = "mechanism Swing { param m: kg = 1; param l: m = 1; param g: m/s^2 = 9.81; coord a: rad; \
                    kinetic += m*l^2*dt(a)^2/2; potential += m*g*l*cos(a); }";
        let file = folder.join("swing.mbs");
        fs::write(&file, text).unwrap();
        let config = Config::new().out_dir(&folder).languages([Language::Js, Language::C]);
        config.write(&file).unwrap();
        let own = fs::read_to_string(folder.join("swing.mjs")).unwrap();
        let header = fs::read_to_string(folder.join("swing.h")).unwrap();
        config.trigonometry(Trigonometry::Library).write(&file).unwrap();
        let library = fs::read_to_string(folder.join("swing.mjs")).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert!(header.contains("swing_gravity") && own.contains("mbs_own_sin(a)"));
        assert!(library.contains("Math.sin(a)") && !library.contains("mbs_own_sin"));
    }
}
