//! JavaScript, Python and MATLAB: every function of every mechanism, run in node, NumPy and Octave, gives the bits of
//! the proved program with the runtime's own sine and cosine, and what else their libraries may differ by.
//!
//! What is not there is skipped, which the output says.

use std::cell::Cell;
use std::path::Path;
use std::process::Command;

use mbs_derive::Analysis;
use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::{Binary, Function as Elementary, Graph, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function, Instruction, Program};
use mbs_derive::source::Sources;
use mbs_runtime::Scalar;
use mbs_tests::random::Random;

use crate::call::{arguments, entries, takes};

/// States of each mechanism, and those of them that Octave gets, which reads every line anew. `MBS_STATES=100` asks for
/// as many in all languages.
fn states() -> [usize; 2] {
    let asked_for = std::env::var("MBS_STATES").ok().and_then(|number| number.parse().ok());
    asked_for.map_or([10, 1], |number| [number; 2])
}

/// How far functions of other libraries may be from those of Rust's, in units of the last place.
const ULPS: f64 = 4.0;

thread_local! {
    /// Seeds what functions are varied by; none where it is zero.
    static VARIED: Cell<u64> = const { Cell::new(0) };
}

/// A double with the sine and cosine that are the same in all languages.
#[derive(Clone, Copy, Debug)]
struct Own(f64);

impl Own {
    /// As another library might give it.
    fn varied(value: f64) -> Own {
        let seed = VARIED.get();
        if seed == 0 {
            return Own(value);
        }
        let mut random = Random::new(seed);
        VARIED.set(random.bits() | 1);
        Own(value + random.uniform(-ULPS..ULPS) * f64::EPSILON * value.abs())
    }
}

impl Value for Own {
    fn constant(value: f64) -> Self {
        Own(value)
    }
    fn neg(self) -> Self {
        Own(-self.0)
    }
    fn add(self, other: Self) -> Self {
        Own(self.0 + other.0)
    }
    fn sub(self, other: Self) -> Self {
        Own(self.0 - other.0)
    }
    fn mul(self, other: Self) -> Self {
        Own(self.0 * other.0)
    }
    fn div(self, other: Self) -> Self {
        Own(self.0 / other.0)
    }
    fn power(self, halves: i32) -> Self {
        Own(Value::power(self.0, halves))
    }
    fn call(self, function: Elementary) -> Self {
        let ([sin], [cos]) = f64::sin_cos_all([self.0]);
        match function {
            Elementary::Sin => Own(sin),
            Elementary::Cos => Own(cos),
            exact @ (Elementary::Abs | Elementary::Signum) => Own(Value::call(self.0, exact)),
            other => Own::varied(Value::call(self.0, other)),
        }
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        Own::varied(Value::call2(self.0, function, other.0))
    }
    fn rate(self) -> Self {
        self
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn exponent(self) -> i32 {
        Value::exponent(self.0)
    }
}

fn has(program: &str, arguments: &[&str]) -> bool {
    let found = Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: {program}, `{}` does not run", arguments.join(" "));
    }
    found
}

#[track_caller]
fn run(program: &str, arguments: &[&str], folder: &Path) -> String {
    let output = Command::new(program).args(arguments).current_dir(folder).output().expect("it runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program} {arguments:?}: {}", &told[..told.len().min(4000)]);
    String::from_utf8(output.stdout).expect("text")
}

/// Those that take a state, as the language calls them.
fn functions(language: Language, text: &str) -> Vec<String> {
    let (class, begin, end) = match language {
        Language::Js => ("\nexport class ", "  ", "("),
        Language::Python => ("\nclass ", "    def ", "(self"),
        _ => ("function m = ", "m.", " = @("),
    };
    let heads = text[text.rfind(class).expect("the mechanism")..]
        .lines()
        .filter_map(|line| line.strip_prefix(begin)?.split_once(end))
        .map(|(name, _)| name);
    let is_word = |name: &&str| name.chars().all(|c| c.is_alphanumeric() || c == '_');
    heads.filter(is_word).filter(|name| !name.starts_with('_') && *name != "constructor").map(String::from).collect()
}

/// A mechanism, where it is run.
struct Case {
    name: String,
    of: Derivation,
    states: Vec<(State<Own>, Vec<Own>)>,
}

impl Case {
    fn new(name: &str, text: &str, random: &mut Random) -> Self {
        let graph = Graph::verbatim();
        let of = Analysis::of(&Sources::new(name, text), &graph).expect("a mechanism").into_programs();
        let states = (0..states()[0]).map(|_| state(&of, random)).collect();
        Case { name: name.to_string(), of, states }
    }

    fn file(&self) -> String {
        let file = Language::Python.file_name(&self.of);
        file.strip_suffix(".py").expect("a module").to_string()
    }

    /// Writes its code, and its states; the list's entry.
    fn written(&self, folder: &Path) -> String {
        let of = &self.of;
        let called = RUNS.map(|(language, ..)| {
            let text = language.write(of, &self.name, &Options::default());
            assert_eq!(text, language.write(of, &self.name, &Options::default()));
            std::fs::write(folder.join(language.file_name(of)), &text).expect("written");
            let names = functions(language, &text);
            assert_eq!(names.len(), of.functions.len(), "{}: {names:?}", self.name);
            names
        });
        let numbers = self.states.iter().flat_map(|(state, multipliers)| {
            let prescribed = state.prescribed.as_flattened();
            [&[state.t], prescribed, &state.q, &state.qd, &state.qdd, &state.u, multipliers].concat()
        });
        let bytes: Vec<u8> = numbers.flat_map(|x| x.0.to_le_bytes()).collect();
        std::fs::write(folder.join(format!("{}.states", self.name)), bytes).expect("written");
        let all = arguments(of);
        let quoted = |names: Vec<String>| names.join(", ");
        let functions = of.functions.iter().enumerate().map(|(i, function)| {
            let taken = all.iter().filter(|(name, n)| *n > 0 && takes(of, function, name));
            let taken = quoted(taken.map(|(name, _)| format!("\"{name}\"")).collect());
            let parts = function.results.len();
            let [js, python, matlab] = called.each_ref().map(|names| &names[i]);
            format!(
                "{{\"js\": \"{js}\", \"python\": \"{python}\", \"matlab\": \"{matlab}\", \"takes\": [{taken}], \
                 \"parts\": {parts}}}"
            )
        });
        format!(
            "{{\"name\": \"{}\", \"file\": \"{}\", \"class\": \"{}\", \"states\": {}, \"octave_states\": {}, \
             \"layout\": [{}], \"functions\": [{}]}}",
            self.name,
            self.file(),
            of.name,
            self.states.len(),
            states()[1],
            quoted(all.iter().map(|(name, n)| format!("[\"{name}\", {n}]")).collect()),
            quoted(functions.collect())
        )
    }

    /// What each function gives at the first states, this many, and how far other libraries may be from that.
    fn wanted(&self, states: usize) -> Vec<(f64, f64)> {
        let defaults = self.of.parameters.iter().flat_map(|p| &p.defaults);
        let defaults: Vec<Own> = defaults.map(|value| Own(value.to_f64())).collect();
        let results = |seed: u64, function: &Function, (state, multipliers): &(State<Own>, Vec<Own>)| {
            VARIED.set(seed);
            let interpreter = Interpreter::with_parameters(&self.of, defaults.clone());
            let results = interpreter.evaluate_with(function, state, multipliers);
            VARIED.set(0);
            results
        };
        let exact = Interpreter::with_parameters(&self.of, defaults.clone());
        let calls = |program: &Program| program.instructions.iter().any(is_varied);
        let any_calls = calls(&self.of.constructor) || self.of.functions.iter().any(|f| calls(&f.program));
        let mut wanted = Vec::new();
        for function in &self.of.functions {
            for state in &self.states[..states] {
                let own = exact.evaluate_with(function, &state.0, &state.1);
                // The results' own rounding, where it may fall to the other side.
                let rounding = |x: &Own| if any_calls { ULPS * f64::EPSILON * x.0.abs() } else { 0.0 };
                let mut spread: Vec<f64> = own.iter().map(rounding).collect();
                for seed in (1..=4).filter(|_| any_calls) {
                    for (spread, (a, b)) in spread.iter_mut().zip(results(seed, function, state).iter().zip(&own)) {
                        *spread = f64::max(*spread, 4.0 * (a.0 - b.0).abs());
                    }
                }
                wanted.extend(own.iter().zip(spread).map(|(x, spread)| (x.0, spread)));
            }
        }
        wanted
    }
}

/// Whether libraries may differ in it.
fn is_varied(instruction: &Instruction) -> bool {
    match instruction {
        Instruction::Call(function, _) => {
            !matches!(function, Elementary::Sin | Elementary::Cos | Elementary::Abs | Elementary::Signum)
        }
        Instruction::Call2(..) => true,
        _ => false,
    }
}

fn state(of: &Derivation, random: &mut Random) -> (State<Own>, Vec<Own>) {
    let mut numbers = |n: usize| (0..n).map(|_| Own(random.uniform(-1.5..1.5))).collect::<Vec<_>>();
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
fn every_function_gives_the_bits_of_its_program_in_every_language() {
    let [all, few] = states();
    let languages = [
        ("js", "node", vec!["--version"], vec!["drive.mjs"], all),
        ("python", "python3", vec!["-c", "import numpy"], vec!["-W", "error", "drive.py"], all),
        ("matlab", "octave-cli", vec!["--version"], vec!["--no-gui", "--quiet", "--norc", "drive.m"], few),
    ];
    let languages: Vec<_> = languages.into_iter().filter(|(_, program, shown, ..)| has(program, shown)).collect();
    if languages.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for (name, text) in [
        ("drive.mjs", include_str!("scripts/drive.mjs")),
        ("drive.py", include_str!("scripts/drive.py")),
        ("drive.m", include_str!("scripts/drive.m")),
    ] {
        std::fs::write(folder.join(name), text).expect("written");
    }
    let mut random = Random::new(18);
    let sources = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES);
    let cases: Vec<Case> = sources.map(|(name, text)| Case::new(name, text, &mut random)).collect();
    let list: Vec<String> = cases.iter().map(|case| case.written(folder)).collect();
    std::fs::write(folder.join("list.json"), format!("[{}]", list.join(",\n"))).expect("written");
    let mut compared = 0;
    std::thread::scope(|scope| {
        let running: Vec<_> = languages
            .iter()
            .map(|(_, program, _, arguments, _)| scope.spawn(move || run(program, arguments, folder)))
            .collect();
        let wanted: Vec<_> = cases.iter().map(|case| [case.wanted(all), case.wanted(few)]).collect();
        for ((language, .., states), running) in languages.iter().zip(running) {
            running.join().expect("it ends");
            for (case, wanted) in cases.iter().zip(&wanted) {
                let wanted = &wanted[usize::from(*states != all)];
                let bytes = std::fs::read(folder.join(format!("{}.{language}.results", case.name))).expect("results");
                let found: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|x| f64::from_le_bytes(*x)).collect();
                compared += compare(language, case, &found, wanted, *states);
            }
        }
    });
    assert!(compared > 50_000, "{compared}");
}

fn compare(language: &str, case: &Case, found: &[f64], wanted: &[(f64, f64)], states: usize) -> usize {
    assert_eq!(found.len(), wanted.len(), "{language}, {}", case.name);
    let mut place = 0;
    for function in &case.of.functions {
        let size: usize = function.results.iter().map(|part| entries(part.shape)).sum();
        for state in 0..states {
            for i in 0..size {
                let (found, (want, spread)) = (found[place], wanted[place]);
                let is_same = found.to_bits() == want.to_bits() || (found.is_nan() && want.is_nan());
                assert!(
                    is_same || (found - want).abs() <= spread || (spread.is_nan() && !want.is_finite()),
                    "{language}, {}, {}, state {state}, number {i}: {found:e}, not {want:e} ± {spread:e}",
                    case.name,
                    function.name
                );
                place += 1;
            }
        }
    }
    place
}

/// A mechanism in a language, in a folder.
fn place(folder: &Path, language: Language, name: &str, text: &str) {
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&Sources::new(name, text), &graph).expect("a mechanism");
    let of = analysis.programs();
    std::fs::write(folder.join(language.file_name(of)), language.write(of, name, &Options::default()))
        .expect("written");
}

fn shipped(name: &str) -> &'static str {
    mbs_models::SOURCES.iter().find(|(known, _)| *known == name).expect("it is shipped").1
}

/// A language, the program that runs it and what shows that it is there, and the name of a file.
type Run = (Language, &'static str, &'static [&'static str], &'static [&'static str]);

const RUNS: [Run; 3] = [
    (Language::Js, "node", &["--version"], &["main.mjs"]),
    (Language::Python, "python3", &["-c", "import numpy"], &["-W", "error", "main.py"]),
    (Language::Matlab, "octave-cli", &["--version"], &["--quiet", "--norc", "main.m"]),
];

/// The programs of the manual, and what they print.
#[test]
fn the_manual_has_programs_that_run() {
    let manuals = [
        ("```js\n", include_str!("../../docs/javascript.md")),
        ("```python\n", include_str!("../../docs/numpy.md")),
        ("```matlab\n", include_str!("../../docs/matlab.md")),
    ];
    let text = shipped("double_pendulum");
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&Sources::new("double_pendulum.mbs", text), &graph).expect("a mechanism");
    // m1, l1, m2, l2, g or the like: the one that is changed by its name.
    let parameters =
        analysis.programs().parameters.iter().map(|p| if p.name == "l2" { 0.5 } else { p.defaults[0].to_f64() });
    let interpreter = Interpreter::with_parameters(analysis.programs(), parameters.map(Own).collect());
    let call = |name: &str, q: [f64; 2]| {
        let state = State {
            q: q.map(Own).to_vec(),
            qd: vec![Own(0.0); 2],
            ..state(analysis.programs(), &mut Random::new(1)).0
        };
        interpreter.evaluate(analysis.programs().named(name).expect("it is there"), &state)
    };
    let accelerations = call("forward_dynamics", [0.3, -0.2]);
    let first = format!("{:.12} {:.12}\n", accelerations[0].0, accelerations[1].0);
    let mass = format!("{:.12}\n", call("mass_matrix", [0.3, -0.2])[1].0);
    let last = format!("{:.12}\n", call("mass_matrix", [8.0 / 9.0, 1.0])[1].0);
    let printed = [
        format!("{first}{mass}theta1 theta2\n"),
        format!("{first}(5, 2) (5, 2, 2)\n{last}"),
        format!("{first}{mass}2 2\n"),
    ];
    for (((language, program, shown, arguments), (begin, manual)), printed) in
        RUNS.into_iter().zip(manuals).zip(printed)
    {
        if !has(program, shown) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        place(folder.path(), language, "double_pendulum.mbs", text);
        let (_, rest) = manual.split_once(begin).expect("a program");
        let (main, _) = rest.split_once("```").expect("its end");
        std::fs::write(folder.path().join(arguments[arguments.len() - 1]), main).expect("written");
        assert_eq!(run(program, arguments, folder.path()), printed, "{program}");
    }
}

/// A mechanism, coordinates, parameters and outputs that are called like what the languages have already; and what is
/// refused: another number of coordinates, a parameter that there is not, of another shape, or infinite.
#[test]
fn awkward_names_and_bad_input() {
    let text = "mechanism While { param lambda: kg = 2; param q: kg = 2; param result: kg = 1; param reciprocals: N/m = 3; \
                param l[2]: kg = [1, 2]; coord def: m; coord batch: m; coord function: m; kinetic += lambda*dt(batch)^2; \
                kinetic += lambda/2*(dt(def)^2 + dt(function)^2) + lambda/4*sin(def/(1 m))*dt(def)*dt(function); \
                kinetic += (q + result + l[0] + l[1])*dt(function)^2; \
                potential += reciprocals*(def^2 + function^2)/2; \
                output constructor = def; output delete = batch; output end = function*def; }";
    let mains = [
        "import { While } from './while.mjs';
const m = new While({ lambda: 3 });
console.log(m.constructor_2([1, 2, 3]), m.delete([1, 2, 3]), m.end([1, 2, 3]), m.params.lambda);
const refused = [() => m.delete([1]), () => m.delete(), () => new While({ lamda: 3 }), () => new While({ l: [1] }),
  () => new While({ q: Infinity }), () => new While({ q: '1' })];
for (const call of refused) {
  try {
    call();
    console.log('not refused', call.toString());
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
  }
}
",
        "from py_while import While, Params
m = While(Params(py_lambda=3))
q = [1, 2, 3]
print(int(m.constructor(q)), int(m.delete(q)), int(m.end(q)), m.params.py_lambda)
for call in [lambda: m.delete([1]), lambda: m.delete(1.0), lambda: While(Params(l=(1,))), lambda: While(Params(q=float('inf')))]:
    try:
        call()
        print('not refused')
    except ValueError:
        pass
",
        "m = m_while(struct('lambda', 3));
q = [1; 2; 3];
printf('%d %d %d %d\\n', m.constructor(q), m.delete(q), m.m_end(q), m.params.lambda);
refused = {@() m.delete(1), @() m_while(struct('lamda', 3)), @() m_while(struct('l', 1)), @() m_while(struct('q', Inf))};
for k = 1:numel(refused)
  try
    refused{k}();
    printf('not refused %d\\n', k);
  catch failure
    assert(strncmp(failure.identifier, 'mbs:', 4), failure.message);
  end
end
",
    ];
    for ((language, program, shown, arguments), main) in RUNS.into_iter().zip(mains) {
        if !has(program, shown) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        place(folder.path(), language, "while.mbs", text);
        std::fs::write(folder.path().join(arguments[arguments.len() - 1]), main).expect("written");
        assert_eq!(run(program, arguments, folder.path()), "1 2 3 3\n", "{program}");
    }
}
