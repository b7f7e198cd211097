//! Compiled functions, loaded and called.
#![allow(unsafe_code)] // code that is compiled at run time has no types: `source` writes it, and this file calls it

use std::ffi::c_void;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use mbs_derive::optimise::{Derivation, Function};
use mbs_derive::variable::component_names;

use crate::argument::arguments;
use crate::compiler::Compilers;
use crate::error::{Misfit, NotCompiled};
use crate::source::source;

/// Arguments, or parts of the result, of one function, at most; a function with more is not compiled.
pub const MOST: usize = 8;

/// `(mechanism, states, arguments, their strides, results)`
type Loop = unsafe extern "C" fn(*const c_void, usize, *const *const f64, *const usize, *const *mut f64);

/// A compiled function, and how many numbers it reads and writes at one state.
struct Entry {
    function: Loop,
    arguments: Vec<usize>,
    results: Vec<usize>,
}

struct Loaded {
    entries: Vec<Option<Entry>>,
    new: unsafe extern "C" fn(*const f64, *mut c_void),
    parameters: usize,
    /// The size of the mechanism's struct, in units of 8 bytes.
    size: usize,
    /// Last, so that nothing of it is used after it.
    _library: libloading::Library,
}

/// Functions of one mechanism, compiled; a copy is the same library.
#[derive(Clone)]
pub struct Library(Arc<Loaded>);

impl Library {
    /// Those functions of a mechanism that are wanted, compiled by the first compiler that can, and kept in a folder.
    ///
    /// The folder is made if it is not there, for its owner alone: what is in it is run. A library that is there is
    /// taken if it was made of the same code.
    ///
    /// # Errors
    /// There is no compiler, or none compiles, or the folder or the library cannot be used.
    pub fn compiled(
        derivation: &Derivation,
        compilers: &Compilers,
        folder: &Path,
        wanted: impl Fn(&Function) -> bool,
    ) -> Result<Self, NotCompiled> {
        let (text, names) = source(derivation, wanted)?;
        let failed = |error: libloading::Error| NotCompiled::Unloadable { reason: error.to_string() };
        // SAFETY: it was made from `text` alone, which runs nothing when it is loaded.
        let loaded = |path: &Path| unsafe { libloading::Library::new(path) };
        let path = compilers.made(&text, folder)?;
        let library = loaded(&path).or_else(|_| {
            // What was kept is damaged, perhaps since the disk was full.
            let _ = std::fs::remove_file(&path);
            loaded(&compilers.made(&text, folder)?).map_err(failed)
        })?;
        // SAFETY: `source` writes these functions with these types.
        let (size, new) = unsafe {
            let size = library.get::<unsafe extern "C" fn() -> usize>(c"mbs_native_size").map_err(failed)?();
            (size, *library.get(c"mbs_native_new").map_err(failed)?)
        };
        let entry = |(number, name): (usize, &Option<String>)| {
            let Some(name) = name else { return Ok(None) };
            // SAFETY: `source` writes all loops with this type.
            let function = unsafe { *library.get::<Loop>(name.as_str()).map_err(failed)? };
            let arguments = arguments(derivation, number).iter().map(|argument| argument.count()).collect();
            let results = derivation.functions[number].results.iter().map(|part| part.shape.entries()).collect();
            Ok(Some(Entry { function, arguments, results }))
        };
        let entries = names.iter().enumerate().map(entry).collect::<Result<_, _>>()?;
        let parameters = component_names(&derivation.parameters).len();
        Ok(Library(Arc::new(Loaded { entries, new, parameters, size: size.div_ceil(8), _library: library })))
    }

    /// Whether the function with this number in the derivation is compiled.
    pub fn has(&self, number: usize) -> bool {
        self.0.entries.get(number).is_some_and(Option::is_some)
    }

    /// The mechanism with these parameters, flattened in declaration order. Nothing is checked but their number: with
    /// what is not finite, or cannot be, results are what the formulas give, NaN among them.
    ///
    /// # Errors
    /// There are more or fewer parameters than the mechanism has.
    pub fn instance(&self, parameters: &[f64]) -> Result<Instance, Misfit> {
        let (expected, found) = (self.0.parameters, parameters.len());
        if expected != found {
            return Err(Misfit::Count { what: "parameters", expected, found });
        }
        let mut own = vec![0_u64; self.0.size];
        // SAFETY: as many parameters as the struct has, and memory of its size, aligned for doubles.
        unsafe { (self.0.new)(parameters.as_ptr(), own.as_mut_ptr().cast()) };
        Ok(Instance { library: self.clone(), own })
    }
}

impl fmt::Debug for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Library").field("functions", &self.0.entries.iter().flatten().count()).finish_non_exhaustive()
    }
}

/// Compiled functions of a mechanism with values of its parameters.
#[derive(Clone, Debug)]
pub struct Instance {
    library: Library,
    /// What the C code calls the mechanism: a struct of parameters and of what depends on them alone.
    own: Vec<u64>,
}

impl Instance {
    /// Whether the function with this number in the derivation is compiled.
    pub fn has(&self, number: usize) -> bool {
        self.library.has(number)
    }

    /// Calls the function with this number in the derivation at `count` states.
    ///
    /// | argument    | meaning                                                                                    |
    /// |-------------|--------------------------------------------------------------------------------------------|
    /// | `arguments` | numbers in the order of [`arguments`](crate::arguments), and how many further those of the next state are: 0 where all share them |
    /// | `results`   | a slice for each part of the result, row by row, state after state                          |
    ///
    /// A result is NaN where the function has no value: outside of the domain of a formula, where constraints
    /// contradict each other, where inertia is missing, and where an argument is not finite.
    ///
    /// # Errors
    /// The function is not compiled, or arguments or results have not as many numbers as it reads and writes; nothing
    /// was computed then.
    pub fn call(
        &self,
        number: usize,
        arguments: &[(&[f64], usize)],
        count: usize,
        results: &mut [&mut [f64]],
    ) -> Result<(), Misfit> {
        let entry = self.library.0.entries.get(number).and_then(Option::as_ref).ok_or(Misfit::Function { number })?;
        fits("arguments", entry.arguments.len(), arguments.len())?;
        fits("results", entry.results.len(), results.len())?;
        let mut data = [std::ptr::null(); MOST];
        let mut strides = [0; MOST];
        for (place, ((values, stride), size)) in arguments.iter().zip(&entry.arguments).enumerate() {
            let read = count.checked_sub(1).map(|last| last.checked_mul(*stride).and_then(|at| at.checked_add(*size)));
            holds("argument", place, read.unwrap_or(Some(0)), values.len())?;
            (data[place], strides[place]) = (values.as_ptr(), *stride);
        }
        let mut targets = [std::ptr::null_mut(); MOST];
        for (place, (result, size)) in results.iter_mut().zip(&entry.results).enumerate() {
            holds("result", place, count.checked_mul(*size), result.len())?;
            targets[place] = result.as_mut_ptr();
        }
        // SAFETY: arguments and results are as long as the function reads and writes, as was just checked, and `own` is
        // what the same library has made.
        unsafe {
            (entry.function)(self.own.as_ptr().cast(), count, data.as_ptr(), strides.as_ptr(), targets.as_ptr());
        }
        Ok(())
    }
}

fn fits(what: &'static str, expected: usize, found: usize) -> Result<(), Misfit> {
    if expected == found { Ok(()) } else { Err(Misfit::Count { what, expected, found }) }
}

/// Whether a slice has as many numbers as are read or written; `None` is more than can be counted.
fn holds(what: &'static str, place: usize, expected: Option<usize>, found: usize) -> Result<(), Misfit> {
    let expected = expected.unwrap_or(usize::MAX);
    if found >= expected { Ok(()) } else { Err(Misfit::Numbers { what, place, expected, found }) }
}

#[cfg(test)]
mod tests {
    use mbs_derive::Analysis;
    use mbs_derive::expr::Graph;
    use mbs_derive::interpret::{Interpreter, State};
    use mbs_derive::optimise::FunctionKind;
    use mbs_derive::source::Sources;

    use super::*;

    const TEXT: &str = "mechanism Pendulum { param m: kg = 2; param l: m = 0.5; coord theta: rad; input tau: N*m; \
                        kinetic += m*(l*dt(theta))^2/2; potential += -m*9.81 m/s^2*l*cos(theta); \
                        force theta += tau - 0.1 N*m*s/rad*if dt(theta) < 0 rad/s { 2 } else { 1 }*dt(theta); \
                        output height = -l*cos(theta); }";

    /// Hands out the derivation with a library of it; says that it skips where there is no compiler.
    fn with_library(test: impl FnOnce(&Derivation, &Library)) {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&Sources::new("pendulum.mbs", TEXT), &graph).unwrap();
        let folder = tempfile::tempdir().unwrap();
        match Library::compiled(analysis.programs(), &Compilers::of_environment(), folder.path(), |_| true) {
            Ok(library) => test(analysis.programs(), &library),
            Err(NotCompiled::NoCompiler { .. }) => eprintln!("skipped: compiled code, there is no C compiler"),
            Err(error) => panic!("{error}"),
        }
    }

    fn number(derivation: &Derivation, kind: FunctionKind) -> usize {
        derivation.functions.iter().position(|function| function.kind == kind).unwrap()
    }

    #[test]
    fn compiled_functions_give_the_bits_of_the_interpreter() {
        with_library(|derivation, library| {
            let parameters = [1.3, 0.7];
            let (instance, interpreter) =
                (library.instance(&parameters).unwrap(), Interpreter::with_parameters(derivation, parameters.to_vec()));
            let number = number(derivation, FunctionKind::ForwardDynamics);
            let states: Vec<[f64; 3]> =
                (0..200).map(|i| [0.1 * f64::from(i), 3.0 - 0.03 * f64::from(i), 0.7 * f64::from(i % 5)]).collect();
            let flat = states.concat();
            let mut found = vec![0.0; states.len()];
            let arguments = [(&flat[..], 3), (&flat[1..], 3), (&flat[2..], 3)];
            instance.call(number, &arguments, states.len(), &mut [&mut found]).unwrap();
            for ([q, qd, u], found) in states.iter().zip(&found) {
                let state = State { q: vec![*q], qd: vec![*qd], u: vec![*u], ..State::default() };
                let expected = interpreter.evaluate(&derivation.functions[number], &state);
                assert_eq!(found.to_bits(), expected[0].to_bits(), "{q} {qd} {u}");
            }
        });
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        with_library(|derivation, library| {
            let count = |what, expected, found| Misfit::Count { what, expected, found };
            assert_eq!(library.instance(&[1.0]).unwrap_err(), count("parameters", 2, 1));
            let (instance, number) =
                (library.instance(&[1.0, 1.0]).unwrap(), number(derivation, FunctionKind::Gravity));
            let mut result = [f64::NAN; 2];
            let mut check = |number, arguments: &[(&[f64], usize)], states, expected| {
                assert_eq!(instance.call(number, arguments, states, &mut [&mut result]), Err(expected));
                assert!(result.iter().all(|x| x.is_nan()), "nothing is computed");
            };
            let numbers = |what, place, expected, found| Misfit::Numbers { what, place, expected, found };
            check(number, &[], 1, count("arguments", 1, 0));
            check(number, &[(&[], 0)], 1, numbers("argument", 0, 1, 0));
            check(number, &[(&[0.0, 1.0], 2)], 2, numbers("argument", 0, 3, 2));
            check(number, &[(&[0.0], 0)], 3, numbers("result", 0, 3, 2));
            check(number, &[(&[0.0, 0.0], usize::MAX)], 3, numbers("argument", 0, usize::MAX, 2));
            check(1000, &[(&[0.0], 0)], 1, Misfit::Function { number: 1000 });
            assert_eq!(instance.call(number, &[(&[0.0], 0)], 1, &mut []), Err(count("results", 1, 0)));
            assert_eq!(instance.call(number, &[(&[], 1)], 0, &mut [&mut []]), Ok(()), "no states");
            assert_eq!(instance.call(number, &[(&[f64::NAN], 0)], 1, &mut [&mut result]), Ok(()));
            assert!(result[0].is_nan());
        });
    }

    #[test]
    fn a_damaged_library_is_made_again() {
        with_library(|derivation, _| {
            let (folder, compilers) = (tempfile::tempdir().unwrap(), Compilers::of_environment());
            let compiled = || Library::compiled(derivation, &compilers, folder.path(), |_| true).map(drop);
            compiled().unwrap();
            for file in std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().path()) {
                if file.extension().is_some_and(|kind| kind == "so") {
                    std::fs::write(&file, "").unwrap();
                }
            }
            compiled().unwrap();
        });
    }

    #[test]
    fn without_a_compiler_the_reason_is_said() {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&Sources::new("pendulum.mbs", TEXT), &graph).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let check = |compilers: Compilers, folder: &Path, expected: &str| {
            let error = Library::compiled(analysis.programs(), &compilers, folder, |_| true).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        };
        check(Compilers::named("no-such-compiler"), folder.path(), "there is no C compiler `no-such-compiler`");
        check(Compilers::named(""), folder.path(), "there is no C compiler");
        #[cfg(unix)]
        check(Compilers::named("false"), folder.path(), "false: ");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing half made is left");
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        if !Compilers::of_environment().found().is_empty() {
            check(Compilers::of_environment(), &file.join("folder"), "folder");
        }
    }
}
