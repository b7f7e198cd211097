//! The header of C99: compiled without a warning, as C and as C++, and run under sanitizers: every function of every
//! mechanism gives the bits of the proved program.
//!
//! Skipped where there is no C compiler, which the output says.

mod cuda;
mod opencl;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use mbs_derive::emit::{Language, Options, Trigonometry};
use mbs_derive::interpret::{Interpreter, State, Violation};
use mbs_derive::optimise::{Derivation, FunctionKind, Shape};
use mbs_derive::source::Sources;
use mbs_printers::call::{arguments, takes};
use mbs_printers::case::{ALL, Case, long_chains, named};
use mbs_printers::depth::{self, STATES};
use mbs_printers::tools::{self, each, run};

use crate::elementary;

const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];

/// Numbers as C, JavaScript and Python read and write them.
pub(crate) fn read(path: &Path) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    bytes.as_chunks::<8>().0.iter().map(|x| f64::from_le_bytes(*x)).collect()
}

/// Writes numbers that they read.
pub(crate) fn write(path: &Path, numbers: &[f64]) {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(path, bytes).expect("written");
}

fn has(compiler: &str) -> bool {
    tools::has(compiler, &["--version"])
}

/// Compilers of C that are there, with those of C++ that belong to them.
fn compilers() -> Vec<[&'static str; 2]> {
    [["gcc", "g++"], ["clang", "clang++"]].into_iter().filter(|[c, _]| has(c)).collect()
}

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

#[track_caller]
fn compiled(compiler: &str, arguments: &[&str], folder: &Path) {
    run(compiler, &[arguments, &WARNINGS].concat(), folder);
}

/// A program that reads parameters and says what is wrong with them, or reads states and writes all results, function
/// by function.
fn main_of(of: &Derivation, name: &str, header: &str) -> String {
    let (prefix, names) = (prefix(header), functions(header));
    assert_eq!(names.len(), of.functions.len(), "{name}");
    let all = arguments(of);
    let size: usize = all.iter().map(|(_, n)| n).sum();
    let longest = of.functions.iter().map(Case::size).max().unwrap_or_default().max(1);
    let mut text = format!(
        "#include <stdio.h>\n#include \"{name}.h\"\n\
         static mbs_real states[{STATES}][{size}], out[{longest}];\n\
         static int got(mbs_real *x, size_t n) {{\n\
         for (size_t i = 0; i < n; i++) {{ unsigned long long b; if (scanf(\"%llx\", &b) != 1) return 0; memcpy(x + i, &b, 8); }}\n\
         return 1;\n}}\n\
         int main(int argc, char **argv)\n{{\n\
         {prefix}_parameters params = {prefix}_default_parameters();\n\
         while (argc == 2 && got((mbs_real *)&params, sizeof params/sizeof(mbs_real))) {{\n\
         const char *quantity;\nmbs_real value;\n\
         const int error = {prefix}_check(&params, &quantity, &value);\n\
         unsigned long long b; memcpy(&b, &value, 8); printf(\"%llx %d %s\\n\", b, error, quantity);\n}}\n\
         if (argc < 3) return 0;\n\
         const {prefix} self = {prefix}_new(&params);\n\
         FILE *from = fopen(argv[1], \"rb\"), *to = fopen(argv[2], \"wb\");\n\
         if (!from || !to) return 2;\n\
         const size_t count = fread(states, sizeof states[0], {STATES}, from);\n"
    );
    let places = all.iter().scan(0, |next, (name, n)| Some((*name, std::mem::replace(next, *next + n))));
    let places: Vec<(&str, usize)> = places.collect();
    for (function, name) in of.functions.iter().zip(names) {
        let taken = places.iter().zip(all).filter(|((name, _), (_, n))| *n > 0 && takes(of, function, name));
        let taken = taken.map(|((name, place), _)| match *name {
            "t" => format!("states[i][{place}]"),
            _ => format!("states[i] + {place}"),
        });
        let mut given: Vec<String> = std::iter::once("&self".to_string()).chain(taken).collect();
        let is_number = matches!(function.results.as_slice(), [part] if part.shape == Shape::Scalar);
        let (mut start, mut returned) = (0, "");
        for part in &function.results {
            if is_number {
                returned = "out[0] = ";
            } else if part.shape.entries() > 0 {
                given.push(format!("out + {start}"));
            }
            start += part.shape.entries();
        }
        let _ = writeln!(text, "for (size_t i = 0; i < count; i++) {{\n{returned}{name}({});", given.join(", "));
        let _ = writeln!(text, "if (fwrite(out, 8, {start}, to) != {start}) return 3;\n}}");
    }
    text + "return fclose(from) || fclose(to);\n}\n"
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

/// How a header is compiled and run.
struct Way<'w> {
    compiler: &'w str,
    language: &'w [&'w str],
    trigonometry: Trigonometry,
    is_sanitized: bool,
}

/// Compiles the header of a mechanism and a program for it, runs it at all states; its name and what it gave.
fn ran(case: &Case, way: &Way<'_>, folder: &Path) -> (String, Vec<f64>) {
    let options = Options::default().trigonometry(way.trigonometry);
    let name = format!("{}_{}_{:?}", case.name, way.compiler.replace('+', "p"), way.trigonometry);
    let header = Language::C.write(&case.of, &case.name, &options);
    assert_eq!(header, Language::C.write(&case.of, &case.name, &options));
    let source = format!("{name}.c");
    std::fs::write(folder.join(format!("{name}.h")), &header).expect("written");
    std::fs::write(folder.join(&source), main_of(&case.of, &name, &header)).expect("written");
    let is_sanitized = way.is_sanitized && header.len() < depth::longest_with_sanitizers();
    let checks: &[&str] = if is_sanitized { &SANITIZERS } else { &[] };
    let all = [way.language, &["-O0", "-ffp-contract=off"], checks, &[source.as_str(), "-o", &name, "-lm"]];
    compiled(way.compiler, &all.concat(), folder);
    let [states, results] = ["states", "results"].map(|ending| format!("{name}.{ending}"));
    write(&folder.join(&states), &case.numbers(STATES));
    run(folder.join(&name), &[states.as_str(), results.as_str()], folder);
    let found = read(&folder.join(&results));
    (name, found)
}

/// Compilers, C and C++ in turn: each mechanism meets two of them, one with the library's sine and cosine.
fn ways<'w>(number: usize, compilers: &[[&'w str; 2]], sanitized: &[&str]) -> [Way<'w>; 2] {
    const LANGUAGES: [&[&str]; 2] = [&["-std=c99"], &["-x", "c++", "-std=c++17"]];
    [(number, Trigonometry::Polynomials), (number + 1, Trigonometry::Library)].map(|(number, trigonometry)| {
        let pair = compilers[number / 2 % compilers.len()];
        let compiler = pair[number % 2];
        let is_sanitized = trigonometry == Trigonometry::Polynomials && sanitized.contains(&compiler);
        Way { compiler, language: LANGUAGES[number % 2], trigonometry, is_sanitized }
    })
}

/// In C and C++ of both compilers in turn. With the library's sine and cosine, within running error bounds.
#[test]
fn every_function_gives_the_bits_of_its_program() {
    let compilers = compilers();
    if compilers.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let sanitized = sanitized(folder.path(), compilers.as_flattened());
    let compared = each(ALL.iter().enumerate(), |(number, case)| {
        let folder = folder.path();
        let [own, library] = ways(number, &compilers, &sanitized);
        let (program, found) = ran(case, &own, folder);
        refuse(&case.of, &folder.join(program));
        // The functions of one library are the same in Rust and in C.
        let mut wanted = case.wanted(Trigonometry::Polynomials, STATES);
        wanted.bounds.fill(0.0);
        let mut compared = case.compare(own.compiler, &found, &wanted, STATES)[0];
        if depth::is_complete() {
            let (_, found) = ran(case, &library, folder);
            let wanted = case.wanted(Trigonometry::Library, STATES);
            compared += case.compare(library.compiler, &found, &wanted, STATES).iter().sum::<usize>();
        }
        compared
    });
    let compared: usize = compared.iter().sum();
    println!("{} mechanisms, {compared} numbers", ALL.len());
    assert!(ALL.len() > 60 && compared > 2_500_000, "{compared}");
}

/// Statements of a long chain are written once, in loops, and what they are compiled to gives the same bits.
#[test]
fn links_of_a_long_chain_are_loops() {
    let folder = tempfile::tempdir().expect("a folder");
    for chain in &long_chains() {
        let header = Language::C.write(&chain.of, &chain.name, &Options::default());
        assert!(header.contains("; i -= ") && header.contains("for (int i = "), "it has no loops");
        for [c, cpp] in compilers() {
            for (compiler, language) in [(c, &["-std=c99"][..]), (cpp, &["-x", "c++", "-std=c++17"])] {
                let is_sanitized = compiler == c;
                let way = Way { compiler, language, trigonometry: Trigonometry::Polynomials, is_sanitized };
                let (name, found) = ran(chain, &way, folder.path());
                chain.compare(compiler, &found, &chain.wanted(Trigonometry::Polynomials, STATES), STATES);
                // Where it optimizes, a compiler looks for what is read before it is written.
                let source = format!("{name}.c");
                compiled(compiler, &[language, &["-O2", "-c", &source, "-o", "optimized.o"]].concat(), folder.path());
            }
        }
    }
}

/// Every function that the language of mechanisms has.
#[test]
fn the_librarys_functions_are_within_4_ulp() {
    let (case, wanted) = elementary::case();
    let folder = tempfile::tempdir().expect("a folder");
    for [compiler, _] in compilers() {
        for trigonometry in [Trigonometry::Polynomials, Trigonometry::Library] {
            let way = Way { compiler, language: &["-std=c99"], trigonometry, is_sanitized: false };
            let (_, found) = ran(&case, &way, folder.path());
            case.compare(compiler, &found, &wanted(&case, trigonometry), STATES);
        }
    }
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
    // Those of subfolders are as long as all others together.
    for Case { name, of, .. } in ALL.iter().filter(|case| depth::is_complete() || case.of.dof() < 9) {
        for (language, list) in [(Language::C, &mut all), (Language::Cpp, &mut classes)] {
            let file = language.file_name(of);
            let text = language.write(of, name, &Options::default());
            std::fs::write(folder.path().join(&file), text).expect("written");
            let _ = writeln!(list, "#include \"{file}\"");
        }
    }
    let main = "int main(void) { return 0; }\n";
    std::fs::write(folder.path().join("all.c"), all + main).expect("written");
    std::fs::write(folder.path().join("all.cpp"), classes + "int main() { return 0; }\n").expect("written");
    for [c, cpp] in compilers() {
        compiled(c, &["-std=c99", "-fsyntax-only", "all.c"], folder.path());
        // Of processors without double arithmetic nothing is asked in it.
        compiled(c, &["-std=c99", "-DMBS_REAL=float", "-Wdouble-promotion", "-fsyntax-only", "all.c"], folder.path());
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
    let text = "mechanism Round { param exp: kg = 2; param q: kg = 2; param NAN: kg = 1; param I: kg = 0.5; param CHAR_BIT: kg = 1; param reciprocals: N/m = 3; coord double: m; coord DOUBLE: m; coord y0: m; coord signgam: m; kinetic += I*dt(signgam)^2/2 + CHAR_BIT*signgam^2/(1 m^2)*dt(signgam)^2; kinetic += exp*dt(DOUBLE)^2; \
                kinetic += exp/2*(dt(double)^2 + dt(y0)^2) + exp/4*sin(double/(1 m))*dt(double)*dt(y0) + (q + NAN)*dt(y0)^2; \
                potential += reciprocals*(double^2 + y0^2)/2; output result = double; output NULL = y0; output parameters = y0*double; }";
    let folder = tempfile::tempdir().expect("a folder");
    let round = Case::new("round", &Sources::new("round.mbs", text));
    let header = Language::C.write(&round.of, "round.mbs", &Options::default());
    std::fs::write(folder.path().join("round.h"), header).expect("written");
    let main = "#include <complex.h>\n#include <limits.h>\n#include \"round.h\"\nint main(void) { return 0; }\n";
    std::fs::write(folder.path().join("main.c"), main).expect("written");
    compiled("cc", &["-std=c99", "-fsyntax-only", "main.c"], folder.path());
    compiled("cc", &["-std=c99", "-D_DEFAULT_SOURCE", "-fsyntax-only", "main.c"], folder.path());
    compiled("cc", &["-x", "c++", "-std=c++17", "-fsyntax-only", "main.c"], folder.path());
}

/// Outputs and mechanisms that are called like what the class of C++ has itself.
#[test]
fn names_of_the_class_are_no_trouble() {
    if !has("c++") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (mut includes, mut calls) = (String::new(), String::new());
    // What the class is called, and its functions of the first two outputs.
    let all = [
        ("Odd", ["Odd", "c_Odd", "c_Parameters"]),
        ("Parameters", ["c_Parameters", "Odd", "c_c_Parameters"]),
        ("std", ["c_std", "Odd", "c_Parameters"]),
    ];
    for (name, [class, first, second]) in all {
        let text = format!(
            "mechanism {name} {{ param m: kg = 1; coord x: m; kinetic += m*dt(x)^2; output Odd = 2*x; \
             output Parameters = 3*x; output std = 5*x; }}"
        );
        let case = Case::new(name, &Sources::new("odd.mbs", &text));
        let file = Language::Cpp.file_name(&case.of);
        std::fs::write(folder.path().join(&file), Language::Cpp.write(&case.of, name, &Options::default()))
            .expect("written");
        let _ = writeln!(includes, "#include \"{file}\"");
        let _ = writeln!(
            calls,
            "const mbs::{class} {name}_{{mbs::{class}::Parameters{{2}}}};\nstd::printf(\"%g %g %g %g\\n\", \
             {name}_.params().m, {name}_.{first}({{1}}), {name}_.{second}({{1}}), {name}_.std({{1}}));"
        );
    }
    let main = format!("#include <cstdio>\n{includes}int main()\n{{\n{calls}}}\n");
    std::fs::write(folder.path().join("main.cpp"), main).expect("written");
    compiled("c++", &["-std=c++17", "main.cpp", "-o", "main"], folder.path());
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "2 2 3 5\n".repeat(3));
}

/// The program of docs/c.md in a language.
fn manual(language: &str) -> &'static str {
    let manual = include_str!("../../docs/c.md");
    let (_, rest) = manual.split_once(&format!("```{language}\n")).expect("a program");
    rest.split_once("```").expect("its end").0
}

/// Writes the double pendulum of the manual in a language, and the manual's program.
fn write_manual(folder: &Path, language: Language, file: &str, program: &str) {
    let of = &named("double_pendulum").of;
    let header = language.write(of, "double_pendulum.mbs", &Options::default());
    std::fs::write(folder.join(language.file_name(of)), header).expect("written");
    std::fs::write(folder.join(file), program).expect("written");
}

/// What that of the manual's programs gives, with its parameter.
fn pendulum(kind: FunctionKind, q: [f64; 2]) -> Vec<f64> {
    let of = &named("double_pendulum").of;
    let parameters = of.parameters.iter().map(|p| if p.name == "l2" { 0.5 } else { p.defaults[0].to_f64() });
    let state = State { q: q.to_vec(), qd: vec![0.0; 2], qdd: vec![0.0; 2], ..State::default() };
    Interpreter::with_parameters(of, parameters.collect()).call(kind, &state).expect("every mechanism has it")
}

/// The programs of docs/c.md in C and C++, and what they print.
#[test]
fn the_manual_has_programs_that_run() {
    let q = [0.3, -0.2];
    let accelerations = pendulum(FunctionKind::ForwardDynamics, q);
    let (a, b) = (accelerations[0], accelerations[1]);
    let folder = tempfile::tempdir().expect("a folder");
    let prints = |expected: String| {
        let output = Command::new(folder.path().join("main")).output().expect("it runs");
        assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    };
    if has("cc") {
        write_manual(folder.path(), Language::C, "main.c", manual("c"));
        compiled("cc", &["-std=c99", "main.c", "-o", "main", "-lm"], folder.path());
        prints(format!("{a:.12} {b:.12}\n{:.12}\n", pendulum(FunctionKind::MassMatrix, q)[1]));
    }
    if has("c++") {
        write_manual(folder.path(), Language::Cpp, "main.cpp", manual("cpp"));
        compiled("c++", &["-std=c++17", "main.cpp", "-o", "main"], folder.path());
        let slopes = pendulum(FunctionKind::Linearize, q);
        prints(format!("{a:.12} {b:.12} {:.12}\n", slopes[1]));
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
