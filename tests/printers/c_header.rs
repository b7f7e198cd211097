//! The header of C99: compiled without a warning, as C and as C++, and run under sanitizers: every function of every
//! mechanism gives the bits of the proved program.
//!
//! Skipped where there is no C compiler, which the output says.

mod cuda;
mod opencl;
mod own;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use mbs_derive::Analysis;
use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State, Violation};
use mbs_derive::optimise::{Derivation, Function, Shape};
use mbs_derive::source::Sources;
use mbs_tests::random::Random;

use crate::call::{arguments, entries, takes};

use crate::accuracy::states::{Point, on_the_constraints};
use own::Own;

const STATES: usize = 100;
const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];

fn has(compiler: &str) -> bool {
    let found = Command::new(compiler).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: {compiler}, which is not there");
    }
    found
}

/// Compilers of C that are there, with those of C++ that belong to them.
fn compilers() -> Vec<[&'static str; 2]> {
    [["gcc", "g++"], ["clang", "clang++"]].into_iter().filter(|[c, _]| has(c)).collect()
}

/// A larger header takes too long to compile with sanitizers: eleven do.
const LARGE: usize = 400_000;
const SANITIZERS: [&str; 2] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// Those whose sanitizers are there, too: packages of their own.
fn sanitized<'c>(folder: &Path, compilers: &[&'c str]) -> Vec<&'c str> {
    std::fs::write(folder.join("probe.c"), "int main(void) { return 0; }\n").expect("written");
    let mut have = compilers.to_vec();
    have.retain(|compiler| {
        let arguments = [&SANITIZERS[..], &["-x", "c", "probe.c", "-o", "probe"]].concat();
        let has =
            Command::new(compiler).args(arguments).current_dir(folder).output().expect("it runs").status.success();
        if !has {
            println!("skipped: sanitizers of {compiler}, which are not there");
        }
        has
    });
    have
}

/// What the generator makes of a mechanism of the repository.
fn analysed<R>(name: &str, text: &str, make: impl FnOnce(&Derivation) -> R) -> R {
    let graph = Graph::verbatim();
    make(Analysis::of(&Sources::new(name, text), &graph).expect("a mechanism").programs())
}

fn mechanisms() -> impl Iterator<Item = (&'static str, &'static str)> {
    mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES.iter()).copied()
}

#[track_caller]
fn compiled(compiler: &str, arguments: &[&str], folder: &Path) {
    let output = Command::new(compiler).args(arguments).args(WARNINGS).current_dir(folder).output().expect("it runs");
    assert!(output.status.success(), "{arguments:?}\n{}", String::from_utf8_lossy(&output.stderr));
}

/// A program that reads parameters and says what is wrong with them, or reads states as bits and writes the bits of all
/// results, function by function.
fn main_of(of: &Derivation, name: &str, header: &str) -> String {
    let (prefix, names) = (prefix(header), functions(header));
    assert_eq!(names.len(), of.functions.len(), "{name}");
    let mut text = format!(
        "#include <stdio.h>\n#include <string.h>\n#include \"{name}.h\"\n\
         static int got(mbs_real *x, size_t n) {{\n\
         for (size_t i = 0; i < n; i++) {{ unsigned long long b; if (scanf(\"%llx\", &b) != 1) return 0; memcpy(x + i, &b, 8); }}\n\
         return 1;\n}}\n\
         static void put(const mbs_real *x, size_t n) {{\n\
         for (size_t i = 0; i < n; i++) {{ unsigned long long b; memcpy(&b, x + i, 8); printf(\"%llx \", b); }}\n}}\n\
         int main(int argc, char **argv)\n{{\n\
         (void)argv;\n\
         {prefix}_parameters params = {prefix}_default_parameters();\n\
         const char *quantity;\nmbs_real value;\n\
         while (argc > 1 && got((mbs_real *)&params, sizeof params/sizeof(mbs_real))) {{\n\
         const int error = {prefix}_check(&params, &quantity, &value);\n\
         put(&value, 1); printf(\"%d %s\\n\", error, quantity);\n}}\n\
         const {prefix} self = {prefix}_new(&params);\n"
    );
    let all = arguments(of);
    for (name, n) in all {
        let _ = writeln!(text, "mbs_real {name}[{}];", n.max(1));
    }
    let read: Vec<String> = all.iter().map(|(name, n)| format!("got({name}, {n})")).collect();
    let _ = writeln!(text, "while ({}) {{", read.join(" && "));
    let mut longest = 1;
    for (function, name) in of.functions.iter().zip(names) {
        let given = all.iter().filter(|(name, n)| *n > 0 && takes(of, function, name));
        let mut given: Vec<String> =
            given.map(|(name, _)| if *name == "t" { "t[0]".into() } else { (*name).to_string() }).collect();
        given.insert(0, "&self".into());
        if let [part] = function.results.as_slice()
            && part.shape == Shape::Scalar
        {
            let _ = writeln!(text, "out[0] = {name}({}); put(out, 1);", given.join(", "));
        } else {
            let mut start = 0;
            for part in &function.results {
                if entries(part.shape) > 0 {
                    given.push(format!("out + {start}"));
                }
                start += entries(part.shape);
            }
            longest = longest.max(start);
            let _ = writeln!(text, "{name}({}); put(out, {start});", given.join(", "));
        }
        text += "printf(\"\\n\");\n";
    }
    text += "}\nreturn 0;\n}\n";
    text.replace("(void)argv;\n", &format!("(void)argv;\nstatic mbs_real out[{longest}];\n"))
}

/// As the header calls the mechanism.
fn prefix(header: &str) -> &str {
    let end = header.find("_default_parameters(void)").expect("defaults");
    header[..end].rsplit(' ').next().expect("a name")
}

/// Those that are documented with what they cost, as the header calls them.
fn functions(header: &str) -> Vec<&str> {
    let (_, functions) = header.split_once("_new(const ").expect("the constructor");
    let blocks = functions.split("/**").filter(|block| block.contains("\n * Operations: "));
    blocks
        .map(|block| {
            let (_, head) = block.split_once("MBS_FN ").expect("a function");
            head[..head.find('(').expect("arguments")].rsplit(' ').next().expect("a name")
        })
        .collect()
}

fn state(of: &Derivation, random: &mut Random) -> (State, Vec<f64>) {
    let mut numbers = |n: usize| (0..n).map(|_| random.uniform(-1.5..1.5)).collect::<Vec<f64>>();
    let [_, (_, signals), (_, n), _, _, (_, inputs), (_, rows)] = arguments(of);
    let state = State {
        t: numbers(1)[0],
        prescribed: numbers(signals).chunks(3).map(|signal| [signal[0], signal[1], signal[2]]).collect(),
        q: numbers(n),
        qd: numbers(n),
        qdd: numbers(n),
        u: numbers(inputs),
    };
    (state, numbers(rows))
}

/// Random states, and with constraints some that satisfy them, for rows that depend on others; at rest and straight.
fn states(of: &Derivation, count: usize, random: &mut Random) -> Vec<(State, Vec<f64>)> {
    let mut states: Vec<(State, Vec<f64>)> = (0..count).map(|_| state(of, random)).collect();
    let parameters: Vec<f64> = of.parameters.iter().flat_map(|p| &p.defaults).map(|value| value.to_f64()).collect();
    let point = |state: &State| Point { name: String::new(), state: state.clone(), parameters: parameters.clone() };
    let points: Vec<Point> = states.iter().take(2).map(|(state, _)| point(state)).collect();
    for (place, nearest) in states.iter_mut().zip(on_the_constraints(of, &points)) {
        place.0 = nearest.state;
    }
    if let Some((straight, _)) = states.last_mut() {
        straight.q.iter_mut().chain(&mut straight.qd).for_each(|x| *x = 0.0);
    }
    states
}

fn lifted(state: &State) -> State<Own> {
    let all = |values: &[f64]| values.iter().copied().map(Own).collect::<Vec<Own>>();
    State {
        t: Own(state.t),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Own)).collect(),
        q: all(&state.q),
        qd: all(&state.qd),
        qdd: all(&state.qdd),
        u: all(&state.u),
    }
}

/// The proved programs with the header's sines and cosines.
fn interpreted(of: &Derivation) -> Interpreter<'_, Own> {
    let defaults = of.parameters.iter().flat_map(|p| &p.defaults);
    Interpreter::with_parameters(of, defaults.map(|value| Own(value.to_f64())).collect())
}

fn want(interpreter: &Interpreter<'_, Own>, function: &Function, state: &State, multipliers: &[f64]) -> Vec<f64> {
    let multipliers: Vec<Own> = multipliers.iter().copied().map(Own).collect();
    interpreter.evaluate_with(function, &lifted(state), &multipliers).into_iter().map(|x| x.0).collect()
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn bits(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{:x} ", x.to_bits())).collect()
}

fn numbers<'a>(bits: impl Iterator<Item = &'a str>) -> Vec<f64> {
    bits.map(|bits| f64::from_bits(u64::from_str_radix(bits, 16).expect("bits"))).collect()
}

/// What a program prints that is given this.
fn printed(program: &Path, arguments: &[&str], given: String) -> String {
    let folder = program.parent().expect("a folder");
    let mut running = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut input = running.stdin.take().expect("piped");
    let writer = std::thread::spawn(move || input.write_all(given.as_bytes()));
    let output = running.wait_with_output().expect("it ends");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {error}", program.display());
    writer.join().expect("no panic").expect("it reads");
    String::from_utf8(output.stdout).expect("text")
}

/// In C and C++ of both compilers in turn.
#[test]
fn every_function_gives_the_bits_of_its_program() {
    let compilers = compilers();
    if compilers.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let sanitized = sanitized(folder.path(), compilers.as_flattened());
    let mut random = Random::new(18);
    let mut compared = 0;
    for (number, (name, text)) in mechanisms().enumerate() {
        analysed(name, text, |of| {
            let header = Language::C.write(of, name, &Options::default());
            assert_eq!(header, Language::C.write(of, name, &Options::default()));
            let file = |ending: &str| format!("{name}.{ending}");
            std::fs::write(folder.path().join(file("h")), &header).expect("written");
            std::fs::write(folder.path().join(file("c")), main_of(of, name, &header)).expect("written");
            let pair = compilers[number / 2 % compilers.len()];
            let language: &[&str] = if number % 2 == 0 { &["-std=c99"] } else { &["-x", "c++", "-std=c++17"] };
            let (compiler, source) = (pair[number % 2], file("c"));
            let is_checked = header.len() < LARGE && sanitized.contains(&compiler);
            let checks: &[&str] = if is_checked { &SANITIZERS } else { &[] };
            let all = [language, &["-O0", "-ffp-contract=off"], checks, &[source.as_str(), "-o", name, "-lm"]];
            compiled(compiler, &all.concat(), folder.path());
            let program = folder.path().join(name);
            compared += compare(of, name, &program, &mut random);
            refuse(of, &program);
        });
    }
    assert!(compared > 1_000_000, "{compared}");
}

fn compare(of: &Derivation, name: &str, program: &Path, random: &mut Random) -> usize {
    let states = states(of, STATES, random);
    let given = states.iter().map(|(state, multipliers)| {
        let all = [&[state.t], state.prescribed.as_flattened(), &state.q, &state.qd, &state.qdd, &state.u, multipliers];
        bits(&all.concat())
    });
    let printed = printed(program, &[], given.collect());
    let mut lines = printed.lines();
    let interpreter = interpreted(of);
    let mut compared = 0;
    for (state, multipliers) in &states {
        for function in &of.functions {
            let found = numbers(lines.next().expect("a line").split_whitespace());
            let want = want(&interpreter, function, state, multipliers);
            assert!(
                found.len() == want.len() && found.iter().zip(&want).all(|(&a, &b)| same(a, b)),
                "{name}, {}: {found:?}, not {want:?}",
                function.name
            );
            compared += want.iter().filter(|x| x.is_finite()).count();
        }
    }
    assert_eq!(lines.next(), None, "{name}");
    compared
}

/// `NAME_check` refuses what the generator's own check of parameters refuses, whose principal moments are computed
/// another way.
fn refuse(of: &Derivation, program: &Path) {
    let defaults: Vec<f64> = of.parameters.iter().flat_map(|p| &p.defaults).map(|value| value.to_f64()).collect();
    let mut sets = vec![defaults.clone()];
    for (i, &value) in defaults.iter().enumerate() {
        for other in [f64::NAN, f64::NEG_INFINITY, 0.0, -1.0 - value, 5.0 * value] {
            let mut set = defaults.clone();
            set[i] = other;
            sets.push(set);
        }
    }
    if defaults.is_empty() {
        return;
    }
    let printed = printed(program, &["check"], sets.iter().map(|set| bits(set)).collect());
    assert_eq!(printed.lines().count(), sets.len());
    for (line, set) in printed.lines().zip(&sets) {
        let mut words = line.splitn(3, ' ');
        let value = numbers(words.by_ref().take(1))[0];
        let (error, quantity) = (words.next().expect("a number"), words.next().expect("a name"));
        let violation = Violation::all(of, set).into_iter().next();
        let must = [
            "",
            "must be finite",
            "must not be zero",
            "must not be negative",
            "must be positive",
            "must have no negative principal moment",
            "must have no principal moment greater than the sum of the other two",
        ];
        let expected = violation.as_ref().map_or(("", "", 0.0), |v| (v.must, v.quantity.as_str(), v.value));
        let error: usize = error.parse().expect("a number");
        // One number says both things of the inertia of a body.
        let says = must[error] == expected.0 || (error == 6 && expected.0 == must[5]);
        // Of two equal moments a closed form finds half the digits.
        let is_close = same(value, expected.2) || (value - expected.2).abs() <= 1e-7 * (1.0 + value.abs());
        assert!(says && quantity == expected.1 && is_close, "{line}: {violation:?}");
    }
}

/// All headers in one file: in both languages of both compilers, with the library's functions, in single precision.
#[test]
fn headers_are_clean_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut all, mut classes) = (String::new(), String::new());
    for (name, text) in mbs_models::SOURCES.iter().copied() {
        analysed(name, text, |of| {
            for (language, list) in [(Language::C, &mut all), (Language::Cpp, &mut classes)] {
                let file = language.file_name(of);
                let text = language.write(of, name, &Options::default());
                std::fs::write(folder.path().join(&file), text).expect("written");
                let _ = writeln!(list, "#include \"{file}\"");
            }
        });
    }
    let main = "int main(void) { return 0; }\n";
    std::fs::write(folder.path().join("all.c"), all + main).expect("written");
    std::fs::write(folder.path().join("all.cpp"), classes + "int main() { return 0; }\n").expect("written");
    for [c, cpp] in compilers() {
        compiled(c, &["-std=c99", "-fsyntax-only", "all.c"], folder.path());
        compiled(c, &["-std=c99", "-DMBS_REAL=float", "-fsyntax-only", "all.c"], folder.path());
        compiled(c, &["-std=c99", "-DMBS_LIBRARY_TRIGONOMETRY", "-fsyntax-only", "all.c"], folder.path());
        compiled(cpp, &["-std=c++17", "-fsyntax-only", "all.cpp"], folder.path());
    }
}

/// A mechanism, a coordinate, parameters and outputs that are called like what C has already.
#[test]
fn names_of_the_library_are_no_trouble() {
    if !has("cc") {
        return;
    }
    let text = "mechanism Round { param exp: kg = 2; param q: kg = 2; param NAN: kg = 1; param reciprocals: N/m = 3; coord double: m; coord DOUBLE: m; coord y0: m; kinetic += exp*dt(DOUBLE)^2; \
                kinetic += exp/2*(dt(double)^2 + dt(y0)^2) + exp/4*sin(double/(1 m))*dt(double)*dt(y0) + (q + NAN)*dt(y0)^2; \
                potential += reciprocals*(double^2 + y0^2)/2; output result = double; output NULL = y0; output parameters = y0*double; }";
    let folder = tempfile::tempdir().expect("a folder");
    let header = analysed("round.mbs", text, |of| Language::C.write(of, "round.mbs", &Options::default()));
    std::fs::write(folder.path().join("round.h"), header).expect("written");
    std::fs::write(folder.path().join("main.c"), "#include \"round.h\"\nint main(void) { return 0; }\n")
        .expect("written");
    compiled("cc", &["-std=c99", "-fsyntax-only", "main.c"], folder.path());
    compiled("cc", &["-x", "c++", "-std=c++17", "-fsyntax-only", "main.c"], folder.path());
}

/// The program of docs/c.md in a language.
fn manual(language: &str) -> &'static str {
    let manual = include_str!("../../docs/c.md");
    let (_, rest) = manual.split_once(&format!("```{language}\n")).expect("a program");
    rest.split_once("```").expect("its end").0
}

/// Writes the double pendulum of the manual in a language, and the manual's program.
fn write_manual(folder: &Path, language: Language, file: &str, program: &str) {
    let (_, text) = mechanisms().find(|(name, _)| *name == "double_pendulum").expect("it is shipped");
    analysed("double_pendulum", text, |of| {
        let header = language.write(of, "double_pendulum.mbs", &Options::default());
        std::fs::write(folder.join(language.file_name(of)), header).expect("written");
    });
    std::fs::write(folder.join(file), program).expect("written");
}

/// That of the manual's programs.
fn pendulum() -> mbs_models::double_pendulum::DoublePendulum {
    let params = mbs_models::double_pendulum::Params { l2: 0.5, ..Default::default() };
    mbs_models::double_pendulum::DoublePendulum::new(params)
}

/// The programs of docs/c.md in C and C++, and what they print.
#[test]
fn the_manual_has_programs_that_run() {
    let (pendulum, q) = (pendulum(), [0.3, -0.2]);
    let [a, b] = pendulum.forward_dynamics(&q, &[0.0; 2]);
    let folder = tempfile::tempdir().expect("a folder");
    let prints = |expected: String| {
        let output = Command::new(folder.path().join("main")).output().expect("it runs");
        assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    };
    if has("cc") {
        write_manual(folder.path(), Language::C, "main.c", manual("c"));
        compiled("cc", &["-std=c99", "main.c", "-o", "main", "-lm"], folder.path());
        prints(format!("{a:.12} {b:.12}\n{:.12}\n", pendulum.mass_matrix(&q)[0][1]));
    }
    if has("c++") {
        write_manual(folder.path(), Language::Cpp, "main.cpp", manual("cpp"));
        compiled("c++", &["-std=c++17", "main.cpp", "-o", "main"], folder.path());
        let slopes = pendulum.linearize(&q, &[0.0; 2]);
        prints(format!("{a:.12} {b:.12} {:.12}\n", slopes.q[0][1]));
    }
}

/// What the class of C++ refuses, it names.
#[test]
fn the_class_throws_what_is_wrong() {
    if !has("c++") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let program = "#include <cstdio>\n#include \"double_pendulum.hpp\"\nint main()\n{\n\
                   auto params = double_pendulum_default_parameters();\nparams.m2 = -1;\n\
                   try { mbs::DoublePendulum pendulum(params); } catch (const std::invalid_argument &e) {\n\
                   std::printf(\"%s\\n\", e.what());\n}\n}\n";
    write_manual(folder.path(), Language::Cpp, "main.cpp", program);
    compiled("c++", &["-std=c++17", "main.cpp", "-o", "main"], folder.path());
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "m2 is -1.000000\n");
}
