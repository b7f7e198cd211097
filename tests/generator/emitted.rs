//! Random mechanisms of every construct as Rust, compiled in one crate: each function gives the interpreter's value to
//! the last bit.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use mbs_derive::emit::Options;
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Argument, Derivation, FunctionKind};
use mbs_derive::source::{Sources, Unreadable};
use mbs_derive::variable::component_names;
use mbs_derive::{Analysis, Error};
use mbs_tests::random::Random;
use mbs_tests::referee::{Construct, Drawn, draw};

/// This many: each construct once at least.
const MECHANISMS: usize = 40;

/// All numbers of a result, in the order of the interpreter.
const FLAT: &str = r#"
pub trait Flat { fn flat(&self, into: &mut Vec<u64>); }
impl Flat for f64 {
    fn flat(&self, into: &mut Vec<u64>) { into.push(if self.is_nan() { 1 } else { self.to_bits() }); }
}
impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(&self, into: &mut Vec<u64>) { self.iter().for_each(|x| x.flat(into)); }
}
impl<const N: usize, const U: usize> Flat for mbs_runtime::Linearization<f64, N, U> {
    fn flat(&self, into: &mut Vec<u64>) { self.q.flat(into); self.qd.flat(into); self.u.flat(into); }
}
impl<const N: usize> Flat for mbs_runtime::InverseDynamicsJacobian<f64, N> {
    fn flat(&self, into: &mut Vec<u64>) { self.q.flat(into); self.qd.flat(into); }
}
impl Flat for mbs_runtime::Pose<f64> {
    fn flat(&self, into: &mut Vec<u64>) { self.position.flat(into); self.rotation.flat(into); }
}
impl Flat for mbs_runtime::Wrench<f64> {
    fn flat(&self, into: &mut Vec<u64>) { self.force.flat(into); self.moment.flat(into); }
}
pub fn say(place: &str, value: &impl Flat) {
    let mut bits = Vec::new();
    value.flat(&mut bits);
    println!("{place}: {bits:?}");
}
"#;

fn sources(drawn: &Drawn) -> Sources {
    Sources::gather("random.mbs", &drawn.text, |path| {
        let text = drawn.imports.get(path).map(|text| text.clone().into_bytes());
        text.ok_or_else(|| Unreadable::new("there is no such file", ""))
    })
}

fn state(derivation: &Derivation, random: &mut Random) -> State {
    let mut some =
        |n: usize| (0..n).map(|_| if random.one_in(6) { 0.0 } else { random.uniform(-1.5..1.5) }).collect::<Vec<_>>();
    let n = derivation.dof();
    let (q, qd, qdd, u) = (some(n), some(n), some(n), some(component_names(&derivation.inputs).len()));
    let prescribed =
        some(3 * component_names(&derivation.prescribed).len()).chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    State { t: some(1)[0], q, qd, qdd, u, prescribed }
}

/// As Rust reads it, to the last bit.
fn written(values: &[f64]) -> String {
    let each = values.iter().map(|x| format!("f64::from_bits({})", x.to_bits())).collect::<Vec<_>>();
    format!("[{}]", each.join(", "))
}

/// What a function is called in Rust: keywords are escaped.
fn spelled(name: &str, generated: &str) -> String {
    let spellings = [name.to_string(), format!("r#{name}"), format!("{name}_")];
    let found = spellings.into_iter().find(|spelling| generated.contains(&format!("fn {spelling}(")));
    found.unwrap_or_else(|| panic!("no function {name} in\n{generated}"))
}

/// A call of each function, and the lines that it should print.
fn calls(number: usize, derivation: &Derivation, generated: &str, state: &State) -> (String, String) {
    let interpreter = Interpreter::new(derivation);
    let mut code = format!("    let m = m{number}::random::Random::<f64>::default();\n");
    let mut expected = String::new();
    let prescribed: Vec<String> = state.prescribed.iter().map(|signal| written(signal)).collect();
    for function in &derivation.functions {
        let multipliers = interpreter.rows(FunctionKind::Multipliers, state);
        let time = derivation.depends_on_time.then(|| format!("f64::from_bits({})", state.t.to_bits()));
        let signals = (!prescribed.is_empty()).then(|| format!("&[{}]", prescribed.join(", ")));
        let given = |argument: &&Argument| **argument != Argument::U || !state.u.is_empty();
        let others = function.arguments.iter().filter(given).map(|argument| {
            format!(
                "&{}",
                match argument {
                    Argument::Q => written(&state.q),
                    Argument::Qd => written(&state.qd),
                    Argument::Qdd => written(&state.qdd),
                    Argument::U => written(&state.u),
                    Argument::Multipliers => written(&multipliers),
                }
            )
        });
        let arguments: Vec<String> = time.into_iter().chain(signals).chain(others).collect();
        let (name, place) = (spelled(&function.name, generated), format!("{number} {}", function.name));
        writeln!(code, "    say(\"{place}\", &m.{name}({}));", arguments.join(", ")).expect("a string");
        let bits: Vec<u64> =
            interpreter.evaluate(function, state).iter().map(|x| if x.is_nan() { 1 } else { x.to_bits() }).collect();
        writeln!(expected, "{place}: {bits:?}").expect("a string");
    }
    (code, expected)
}

#[test]
fn compiled_and_interpreted_agree_to_the_last_bit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let root = fs::canonicalize(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).expect("the workspace");
    fs::create_dir(folder.path().join("src")).expect("a temporary folder");
    let manifest = format!(
        "[package]\nname = \"emitted\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\nmbs-runtime = {{ path = \
         \"{}/mbs-runtime\" }}\n\n[workspace]\n",
        root.display()
    );
    fs::write(folder.path().join("Cargo.toml"), manifest).expect("a temporary folder");
    fs::copy(root.join("Cargo.lock"), folder.path().join("Cargo.lock")).expect("the lockfile");

    let mut random = Random::new(3);
    let (mut modules, mut main, mut expected) = (String::new(), String::new(), String::new());
    for (number, construct) in Construct::ALL.into_iter().cycle().take(MECHANISMS).enumerate() {
        let drawn = draw(77 + number as u64, Some(construct), &[]);
        let sources = sources(&drawn);
        let graph = Graph::verbatim();
        let told = |error: Error| format!("{}\n{}", error.render_in(&sources), drawn.text);
        let analysis = Analysis::of(&sources, &graph).map_err(told).unwrap_or_else(|report| panic!("{report}"));
        let generated = analysis.rust(&Options::default()).map_err(told).unwrap_or_else(|report| panic!("{report}"));
        fs::write(folder.path().join(format!("src/m{number}.rs")), &generated.code).expect("a temporary folder");
        let derivation = analysis.programs();
        let (code, lines) = calls(number, derivation, &generated.code, &state(derivation, &mut random));
        write!(modules, "mod m{number} {{ include!(\"m{number}.rs\"); }}\nfn c{number}() {{\n{code}}}\n")
            .expect("a string");
        writeln!(main, "    c{number}();").expect("a string");
        expected += &lines;
    }
    let program = format!("#![allow(warnings)]\n{FLAT}{modules}fn main() {{\n{main}}}\n");
    fs::write(folder.path().join("src/main.rs"), program).expect("a temporary folder");

    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("downstream");
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", target)
        .env("CARGO_NET_OFFLINE", "true")
        .output()
        .expect("cargo runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let printed = String::from_utf8_lossy(&run.stdout);
    assert_eq!(printed.lines().count(), expected.lines().count());
    for (found, expected) in printed.lines().zip(expected.lines()) {
        assert_eq!(found, expected);
    }
    assert!(expected.lines().count() > 700, "{} functions", expected.lines().count());
}
