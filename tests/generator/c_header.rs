//! The header of C99: compiled without a warning, as C and as C++, and run: every function of every mechanism gives the
//! bits of the proved program.
//!
//! Skipped where there is no C compiler, which the output says.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use mbs_derive::Analysis;
use mbs_derive::emit::{self, Options, Trigonometry};
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Argument, Derivation, Function, Shape};
use mbs_derive::source::Sources;
use mbs_derive::variable::Variable;
use mbs_tests::random::Random;

const STATES: usize = 100;
const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];

fn has(compiler: &str) -> bool {
    let found = Command::new(compiler).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: {compiler}, which is not there");
    }
    found
}

#[track_caller]
fn compiled(compiler: &str, arguments: &[&str], folder: &Path) {
    let output = Command::new(compiler).args(arguments).args(WARNINGS).current_dir(folder).output().expect("it runs");
    assert!(output.status.success(), "{arguments:?}\n{}", String::from_utf8_lossy(&output.stderr));
}

fn count(variables: &[Variable]) -> usize {
    variables.iter().map(Variable::count).sum()
}

/// Names and lengths of the arguments of all functions, as `main` reads them.
fn arguments(of: &Derivation) -> [(&'static str, usize); 7] {
    [
        ("t", 1),
        ("prescribed", 3 * count(&of.prescribed)),
        ("q", of.dof()),
        ("qd", of.dof()),
        ("qdd", of.dof()),
        ("u", count(&of.inputs)),
        ("multipliers", of.constraints.len()),
    ]
}

fn takes(of: &Derivation, function: &Function, name: &str) -> bool {
    let argument = match name {
        "t" => return of.depends_on_time,
        "prescribed" => return !of.prescribed.is_empty(),
        "q" => Argument::Q,
        "qd" => Argument::Qd,
        "qdd" => Argument::Qdd,
        "u" => Argument::U,
        _ => Argument::Multipliers,
    };
    function.arguments.contains(&argument)
}

/// How many numbers a part of a result is.
fn entries(shape: Shape) -> usize {
    match shape {
        Shape::Symmetric(n) => n * n,
        other => other.count(),
    }
}

/// The functions that the header has.
fn written(of: &Derivation) -> impl Iterator<Item = &Function> {
    of.functions.iter().filter(|function| !function.completion.is_constrained())
}

/// A program that reads states as bits, and writes the bits of all results, function by function.
fn main_of(of: &Derivation, name: &str, header: &str) -> String {
    let (prefix, names) = (prefix(header), functions(header));
    assert_eq!(names.len(), written(of).count(), "{name}");
    let mut text = format!(
        "#include <stdio.h>\n#include <string.h>\n#include \"{name}.h\"\n\
         static int got(mbs_real *x, size_t n) {{\n\
         for (size_t i = 0; i < n; i++) {{ unsigned long long b; if (scanf(\"%llx\", &b) != 1) return 0; memcpy(x + i, &b, 8); }}\n\
         return 1;\n}}\n\
         static void put(const mbs_real *x, size_t n) {{\n\
         for (size_t i = 0; i < n; i++) {{ unsigned long long b; memcpy(&b, x + i, 8); printf(\"%llx \", b); }}\n}}\n\
         int main(void)\n{{\n\
         const {prefix}_parameters params = {prefix}_default_parameters();\n\
         const {prefix} self = {prefix}_new(&params);\n"
    );
    let all = arguments(of);
    for (name, n) in all {
        let _ = writeln!(text, "mbs_real {name}[{}];", n.max(1));
    }
    let read: Vec<String> = all.iter().map(|(name, n)| format!("got({name}, {n})")).collect();
    let _ = writeln!(text, "while ({}) {{", read.join(" && "));
    let mut longest = 1;
    for (function, name) in written(of).zip(names) {
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
    text.replace("int main(void)\n{\n", &format!("int main(void)\n{{\nstatic mbs_real out[{longest}];\n"))
}

/// As the header calls the mechanism.
fn prefix(header: &str) -> &str {
    let end = header.find("_default_parameters(void)").expect("defaults");
    header[..end].rsplit(' ').next().expect("a name")
}

/// Those that take a mechanism, as the header calls them.
fn functions(header: &str) -> Vec<&str> {
    let heads = header.lines().zip(header.lines().skip(1)).filter(|(head, next)| {
        head.starts_with("static inline") && (head.contains(" *self") || next.contains(" *self"))
    });
    heads.map(|(head, _)| head[..head.find('(').expect("arguments")].rsplit(' ').next().expect("a name")).collect()
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

#[test]
fn every_function_gives_the_bits_of_its_program() {
    if !has("cc") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = Random::new(18);
    let mut compared = 0;
    for &(name, text) in mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES) {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&Sources::new(name, text), &graph).expect("a mechanism");
        let of = analysis.programs();
        let header = emit::c(of, name, &Options::default());
        assert_eq!(header, emit::c(of, name, &Options::default()));
        let file = |ending: &str| format!("{name}.{ending}");
        std::fs::write(folder.path().join(file("h")), &header).expect("written");
        std::fs::write(folder.path().join(file("c")), main_of(of, name, &header)).expect("written");
        compiled("cc", &["-std=c99", "-O0", "-ffp-contract=off", &file("c"), "-o", name, "-lm"], folder.path());

        let states: Vec<(State, Vec<f64>)> = (0..STATES).map(|_| state(of, &mut random)).collect();
        let program = folder.path().join(name);
        let mut running =
            Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
        let mut given = String::new();
        for (state, multipliers) in &states {
            let all =
                [&[state.t], state.prescribed.as_flattened(), &state.q, &state.qd, &state.qdd, &state.u, multipliers];
            all.concat().iter().for_each(|x| given += &format!("{:x} ", x.to_bits()));
        }
        let mut input = running.stdin.take().expect("piped");
        let writer = std::thread::spawn(move || input.write_all(given.as_bytes()));
        let output = running.wait_with_output().expect("it ends");
        writer.join().expect("no panic").expect("it reads");
        assert!(output.status.success(), "{name}");
        let printed = String::from_utf8(output.stdout).expect("text");
        let mut lines = printed.lines();
        let interpreter = Interpreter::with_trigonometry(of, Trigonometry::Library);
        for (state, multipliers) in &states {
            for function in written(of) {
                let line = lines.next().expect("a line");
                let found = line.split_whitespace().map(|bits| u64::from_str_radix(bits, 16).expect("bits"));
                let found: Vec<f64> = found.map(f64::from_bits).collect();
                let want = interpreter.evaluate_with(function, state, multipliers);
                let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
                assert!(
                    found.len() == want.len() && found.iter().zip(&want).all(same),
                    "{name}, {}: {found:?}, not {want:?}",
                    function.name
                );
                compared += want.len();
            }
        }
        assert_eq!(lines.next(), None, "{name}");
    }
    assert!(compared > 1_000_000, "{compared}");
}

/// All headers in one file of C++, and in single precision.
#[test]
fn headers_are_cpp_and_single_precision_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut all = String::new();
    for &(name, text) in mbs_models::SOURCES.iter().filter(|(name, _)| *name != "stewart_platform") {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&Sources::new(name, text), &graph).expect("a mechanism");
        let header = emit::c(analysis.programs(), name, &Options::default());
        std::fs::write(folder.path().join(format!("{name}.h")), header).expect("written");
        let _ = writeln!(all, "#include \"{name}.h\"");
    }
    all += "int main() { return 0; }\n";
    std::fs::write(folder.path().join("all.cpp"), all.clone()).expect("written");
    std::fs::write(folder.path().join("single.c"), all.replace("main()", "main(void)")).expect("written");
    if has("c++") {
        compiled("c++", &["-std=c++17", "-fsyntax-only", "all.cpp"], folder.path());
    }
    if has("cc") {
        compiled("cc", &["-std=c99", "-DMBS_REAL=float", "-fsyntax-only", "single.c"], folder.path());
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
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&Sources::new("round.mbs", text), &graph).expect("a mechanism");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("round.h"), emit::c(analysis.programs(), "round.mbs", &Options::default()))
        .expect("written");
    std::fs::write(folder.path().join("main.c"), "#include \"round.h\"\nint main(void) { return 0; }\n")
        .expect("written");
    compiled("cc", &["-std=c99", "-fsyntax-only", "main.c"], folder.path());
    compiled("cc", &["-x", "c++", "-std=c++17", "-fsyntax-only", "main.c"], folder.path());
}

/// The program of docs/c.md, and what it prints.
#[test]
fn the_manual_has_a_program_that_runs() {
    if !has("cc") {
        return;
    }
    let manual = include_str!("../../docs/c.md");
    let (_, rest) = manual.split_once("```c\n").expect("a program");
    let (program, _) = rest.split_once("```").expect("its end");
    let (_, text) = mbs_models::SOURCES.iter().find(|(name, _)| *name == "double_pendulum").expect("it is shipped");
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&Sources::new("double_pendulum.mbs", text), &graph).expect("a mechanism");
    let header = emit::c(analysis.programs(), "double_pendulum.mbs", &Options::default());
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("double_pendulum.h"), header).expect("written");
    std::fs::write(folder.path().join("main.c"), program).expect("written");
    compiled("cc", &["-std=c99", "main.c", "-o", "main", "-lm"], folder.path());
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    let printed = String::from_utf8(output.stdout).expect("text");

    let params = mbs_models::double_pendulum::Params { l2: 0.5, ..Default::default() };
    let pendulum = mbs_models::double_pendulum::DoublePendulum::new(params);
    let q = [0.3, -0.2];
    let [a, b] = pendulum.forward_dynamics(&q, &[0.0; 2]);
    assert_eq!(printed, format!("{a:.12} {b:.12}\n{:.12}\n", pendulum.mass_matrix(&q)[0][1]));
}
