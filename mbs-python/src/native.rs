//! Functions that a C compiler makes of the generated header, kept in a folder and loaded.
#![allow(unsafe_code)] // code that is compiled at run time has no types: this file writes it and calls it

use std::ffi::{OsString, c_void};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs};

use mbs_derive::optimise::{Derivation, Shape};
use mbs_derive::{Digest, emit, variable::component_names};

use crate::engine::Arguments;

/// Bits are those of the interpreter: products and sums are not contracted; `errno` is not set.
const FLAGS: [&str; 7] = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared", "-w"];

/// GCC's long functions wait for memory less where they are scheduled with an eye on registers: arm6 takes 190 ns in
/// place of 220. Clang does so by itself and refuses the words.
const OF_GCC: [&str; 2] = ["-fschedule-insns", "-fsched-pressure"];

/// `(mechanism, states, arguments, their strides, results)`
type Loop = unsafe extern "C" fn(*const c_void, usize, *const *const f64, *const usize, *const *mut f64);

/// Compiled functions of one mechanism.
pub(crate) struct Library {
    functions: Vec<Option<Loop>>,
    new: unsafe extern "C" fn(*const f64, *mut c_void),
    /// Of the struct of the mechanism, in units of 8 bytes.
    size: usize,
    /// Last, so that nothing of it is used after it.
    _library: libloading::Library,
}

impl Library {
    /// What is compiled, and kept from an earlier time if it was; the reason where it is not.
    pub(crate) fn of(derivation: &Derivation) -> Result<Self, String> {
        let (text, names) = source(derivation)?;
        let mut reasons = Vec::new();
        let mut path = None;
        for compiler in compilers() {
            match made(&text, &compiler) {
                Ok(library) => {
                    path = Some(library);
                    break;
                }
                Err(reason) => reasons.push(reason),
            }
        }
        let path = path.ok_or_else(|| match reasons.is_empty() {
            true => "there is no C compiler: cc, gcc, clang, or what MBS_CC names".to_string(),
            false => reasons.join("; "),
        })?;
        // SAFETY: it was made from `text` alone, which runs nothing when it is loaded.
        let library = unsafe { libloading::Library::new(&path) }.map_err(|error| error.to_string())?;
        let missing = |error: libloading::Error| error.to_string();
        // SAFETY: `source` writes these functions with these types.
        unsafe {
            let size = library.get::<unsafe extern "C" fn() -> usize>(c"mbs_py_size").map_err(missing)?();
            let new = *library.get(c"mbs_py_new").map_err(missing)?;
            let functions = names.iter().map(|name| match name {
                None => Ok(None),
                Some(name) => library.get::<Loop>(name.as_str()).map(|f| Some(*f)).map_err(missing),
            });
            let functions = functions.collect::<Result<_, _>>()?;
            Ok(Library { functions, new, size: size.div_ceil(8), _library: library })
        }
    }

    /// Whether the function with this number is compiled.
    pub(crate) fn has(&self, number: usize) -> bool {
        self.functions[number].is_some()
    }

    /// The struct of the mechanism with these parameters.
    pub(crate) fn constructed(&self, parameters: &[f64]) -> Vec<u64> {
        let mut own = vec![0_u64; self.size];
        // SAFETY: as many parameters as the struct has, and memory of its size, aligned for doubles.
        unsafe { (self.new)(parameters.as_ptr(), own.as_mut_ptr().cast()) };
        own
    }

    /// The states from `first` on, as many as the results have place for; `false` where it is not compiled.
    pub(crate) fn run(
        &self,
        number: usize,
        own: &[u64],
        arguments: &Arguments<'_>,
        first: usize,
        count: usize,
        results: &mut [&mut [f64]],
    ) -> bool {
        let Some(function) = self.functions[number] else { return false };
        assert!(own.len() == self.size && results.len() <= MOST, "a mechanism of another kind");
        let mut data = [std::ptr::null(); MOST];
        let mut strides = [0; MOST];
        for (i, (values, stride)) in arguments.iter().enumerate() {
            data[i] = values[(first * stride).min(values.len())..].as_ptr();
            strides[i] = *stride;
        }
        let mut targets = [std::ptr::null_mut(); MOST];
        results.iter_mut().zip(&mut targets).for_each(|(result, target)| *target = result.as_mut_ptr());
        // SAFETY: `function::Call` has made arguments and results as long as the function reads and writes.
        unsafe { function(own.as_ptr().cast(), count, data.as_ptr(), strides.as_ptr(), targets.as_ptr()) };
        true
    }
}

/// Arguments or results of one function, at most.
const MOST: usize = 8;

/// The header, with a loop over states for each function of it, and their names.
fn source(derivation: &Derivation) -> Result<(String, Vec<Option<String>>), String> {
    let mut text = emit::Language::C.write(derivation, "Python", &Default::default());
    let read = derivation.proofread(emit::Language::C, &Default::default(), &text);
    read.map_err(|misprint| misprint.to_string())?;
    let prefix = text.split_once("_parameters {").and_then(|(before, _)| before.rsplit("typedef struct ").next());
    let prefix = prefix.ok_or("the header has no struct of parameters")?.to_string();
    let parameters = component_names(&derivation.parameters).len();
    text += "#include <string.h>\n";
    let _ = writeln!(text, "size_t mbs_py_size(void) {{ return sizeof({prefix}); }}");
    let _ = writeln!(text, "void mbs_py_new(const double *mbs_from, void *mbs_own)\n{{");
    let _ = writeln!(text, "    {prefix}_parameters mbs_params = {prefix}_default_parameters();");
    if parameters > 0 {
        let _ = writeln!(text, "    memcpy(&mbs_params, mbs_from, {parameters} * sizeof(double));");
    }
    let _ = writeln!(text, "    {prefix} mbs_new = {prefix}_new(&mbs_params);");
    text += "    memcpy(mbs_own, &mbs_new, sizeof mbs_new);\n}\n";
    let mut names = Vec::new();
    for (number, (name, _)) in emit::Language::documented(derivation).iter().enumerate() {
        let is_taken = ["parameters", "default_parameters"].contains(&name.as_str());
        let function = format!("{prefix}_{name}{}", if is_taken { "_2" } else { "" });
        let kinds = ["void", "mbs_real"].map(|kind| format!("MBS_FN {kind} {function}("));
        if !kinds.iter().any(|head| text.contains(head)) {
            names.push(None);
            continue;
        }
        text += &looped(derivation, number, &prefix, &function);
        names.push(Some(format!("mbs_py_{number}")));
    }
    Ok((text, names))
}

fn looped(derivation: &Derivation, number: usize, prefix: &str, function: &str) -> String {
    let declared = crate::function::arguments(derivation, number);
    let given = declared.iter().enumerate().map(|(i, argument)| match argument.name {
        "t" => format!(", mbs_args[{i}][mbs_i * mbs_by[{i}]]"),
        _ => format!(", mbs_args[{i}] + mbs_i * mbs_by[{i}]"),
    });
    let given: String = given.collect();
    let parts = &derivation.functions[number].results;
    let is_scalar = matches!(parts.as_slice(), [part] if part.shape == Shape::Scalar);
    let mut call = if is_scalar { "mbs_out[0][mbs_i] = ".to_string() } else { String::new() };
    call += &format!("{function}(mbs_self{given}");
    if !is_scalar {
        for (i, part) in parts.iter().enumerate().filter(|(_, part)| part.shape.count() > 0) {
            call += &format!(", mbs_out[{i}] + mbs_i * {}", part.shape.entries());
        }
    }
    format!(
        "void mbs_py_{number}(const void *mbs_own, size_t mbs_count, const double *const *mbs_args,\n    \
         const size_t *mbs_by, double *const *mbs_out)\n{{\n    const {prefix} *const mbs_self = \
         (const {prefix} *)mbs_own;\n    (void)mbs_args;\n    (void)mbs_by;\n    \
         for (size_t mbs_i = 0; mbs_i < mbs_count; mbs_i++) {{\n        {call});\n    }}\n}}\n"
    )
}

/// What decides how functions are compiled: the compilers, and the folder that is asked for.
pub(crate) fn surroundings() -> (Vec<PathBuf>, Option<OsString>) {
    (compilers(), env::var_os("MBS_CACHE_DIR"))
}

/// What `MBS_CC`, which may be empty for none, or `CC` names; else what is in the path.
fn compilers() -> Vec<PathBuf> {
    let named = ["MBS_CC", "CC"].into_iter().find_map(env::var_os);
    let candidates = named.map_or_else(|| ["cc", "gcc", "clang"].map(OsString::from).to_vec(), |name| vec![name]);
    let folders: Vec<PathBuf> = env::var_os("PATH").map(|path| env::split_paths(&path).collect()).unwrap_or_default();
    let found = |name: OsString| {
        let path = PathBuf::from(&name);
        let in_folders = || folders.iter().map(|folder| folder.join(&name)).find(|path| path.is_file());
        if path.components().count() > 1 { Some(path).filter(|path| path.is_file()) } else { in_folders() }
    };
    candidates.into_iter().filter(|name| !name.is_empty()).filter_map(found).collect()
}

/// The path of the library, compiled unless it is there.
fn made(text: &str, compiler: &Path) -> Result<PathBuf, String> {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let stamp = fs::metadata(compiler).and_then(|file| file.modified()).map(|time| format!("{time:?}"));
    let program = format!("{} {:?} {FLAGS:?} {OF_GCC:?} {}", compiler.display(), stamp.ok(), env!("CARGO_PKG_VERSION"));
    let name = Digest::of([text.as_bytes(), program.as_bytes()]).to_string();
    let (folder, own) = (folder()?, format!("{}-{}", std::process::id(), CALLS.fetch_add(1, Ordering::Relaxed)));
    let library = folder.join(format!("{name}.so"));
    let code = folder.join(format!("{name}.c"));
    // Digests are not against forgery: the text is compared.
    if library.is_file() && fs::read_to_string(&code).is_ok_and(|kept| kept == text) {
        return Ok(library);
    }
    let [unfinished_code, unfinished] = ["c", "so"].map(|kind| folder.join(format!("{name}-{own}.{kind}")));
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    fs::write(&unfinished_code, text).map_err(wrong)?;
    let compiled = |more: &[&str]| {
        let mut command = Command::new(compiler);
        command.args(FLAGS).args(more).arg(&unfinished_code).arg("-o").arg(&unfinished).arg("-lm").output()
    };
    let run = match compiled(&OF_GCC) {
        Ok(run) if !run.status.success() => compiled(&[]),
        run => run,
    };
    let run = run.map_err(|error| format!("{}: {error}", compiler.display()));
    let made = run.and_then(|run| match run.status.success() {
        true => fs::rename(&unfinished, &library).and_then(|()| fs::rename(&unfinished_code, &code)).map_err(wrong),
        false => Err(format!("{}: {}", compiler.display(), String::from_utf8_lossy(&run.stderr))),
    });
    if made.is_err() {
        let _ = (fs::remove_file(&unfinished), fs::remove_file(&unfinished_code));
    }
    made.map(|()| library)
}

/// `MBS_CACHE_DIR`, or `mbs/python` in the user's cache folder; for nobody else's eyes or hands.
fn folder() -> Result<PathBuf, String> {
    let named = env::var_os("MBS_CACHE_DIR").filter(|name| !name.is_empty()).map(PathBuf::from);
    let cache = || env::var_os("XDG_CACHE_HOME").filter(|name| !name.is_empty()).map(PathBuf::from);
    let home = || env::var_os("HOME").filter(|name| !name.is_empty()).map(|home| PathBuf::from(home).join(".cache"));
    let beside = named.or_else(cache).or_else(home).ok_or("no folder to keep compiled code in: set MBS_CACHE_DIR")?;
    let folder = beside.join("mbs").join("python");
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    fs::canonicalize(&folder).map_err(|error| format!("{}: {error}", folder.display()))
}
