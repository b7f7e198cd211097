//! JavaScript, Python and MATLAB: every function of every mechanism, run in node, NumPy and Octave, gives the bits of
//! the proved program where `+ − × ÷ √`, sines and cosines occur alone, and is within the running error bound of the
//! program where functions of the language's library do.
//!
//! What is not there is skipped, which the output says.

use std::path::Path;

use mbs_derive::emit::{Language, Options, Trigonometry};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::source::Sources;
use mbs_printers::call::{arguments, takes};
use mbs_printers::case::{ALL, Case, Wanted, long_chains, named};
use mbs_printers::depth::{STATES, is_complete, states_of_octave, states_of_scripts};
use mbs_printers::tools::{each, has, run};

use crate::c_header::{read, write};
use crate::elementary;

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

/// Writes the code of a mechanism, and its states; its entry of the list.
fn written(case: &Case, trigonometry: Trigonometry, states: [usize; 2], folder: &Path) -> String {
    let of = &case.of;
    let options = Options::default().trigonometry(trigonometry);
    let called = RUNS.map(|(language, ..)| {
        let text = language.write(of, &case.name, &options);
        assert_eq!(text, language.write(of, &case.name, &options));
        std::fs::write(folder.join(language.file_name(of)), &text).expect("written");
        let names = functions(language, &text);
        assert_eq!(names.len(), of.functions.len(), "{}: {names:?}", case.name);
        names
    });
    write(&folder.join(format!("{}.states", case.name)), &case.numbers(states[0]));
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
    let file = Language::Python.file_name(of);
    format!(
        "{{\"name\": \"{}\", \"file\": \"{}\", \"class\": \"{}\", \"states\": {}, \"octave_states\": {}, \
         \"layout\": [{}], \"functions\": [{}]}}",
        case.name,
        file.strip_suffix(".py").expect("a module"),
        of.name,
        states[0],
        states[1],
        quoted(all.iter().map(|(name, n)| format!("[\"{name}\", {n}]")).collect()),
        quoted(functions.collect())
    )
}

/// Runs all mechanisms in all languages that are there, a process each, and compares at `states[0]` states, of Octave
/// at `states[1]`; how many numbers have the same bits, and how many are within their bounds only.
fn compared(
    cases: &[&Case],
    trigonometry: Trigonometry,
    states: [usize; 2],
    wanted: impl Fn(&Case, usize) -> Wanted + Sync,
) -> [usize; 2] {
    let programs = RUNS.into_iter().zip(DRIVERS).filter(|((_, program, shown, _), _)| has(program, shown));
    let programs: Vec<_> = programs.collect();
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let list = each(cases, |case| written(case, trigonometry, states, folder));
    std::fs::write(folder.join("list.json"), format!("[{}]", list.join(",\n"))).expect("written");
    each(programs.iter().rev(), |((language, program, ..), (arguments, text))| {
        std::fs::write(folder.join(arguments[arguments.len() - 1]), text).expect("written");
        let started = std::time::Instant::now();
        run(program, arguments, folder);
        println!("{program}, {trigonometry:?}: {:.0} s", started.elapsed().as_secs_f64());
        language
    });
    let counts = each(cases, |case| {
        let mut counts = [0, 0];
        let wanted = if states[0] == states[1] {
            vec![wanted(case, states[0])]
        } else {
            states.iter().map(|&states| wanted(case, states)).collect()
        };
        for ((language, ..), _) in &programs {
            let is_octave = *language == Language::Matlab;
            let (states, wanted) = (states[usize::from(is_octave)], &wanted[usize::from(is_octave) % wanted.len()]);
            let found = read(&folder.join(format!("{}.{}.results", case.name, language.name())));
            let [same, close] = case.compare(language.name(), &found, wanted, states);
            counts = [counts[0] + same, counts[1] + close];
        }
        counts
    });
    counts.into_iter().fold([0, 0], |[a, b], [c, d]| [a + c, b + d])
}

#[test]
fn every_function_gives_the_bits_of_its_program_in_every_language() {
    if !RUNS.iter().any(|(_, program, shown, _)| has(program, shown)) {
        return;
    }
    let cases: Vec<&Case> = ALL.iter().collect();
    // Octave takes minutes for a hundred states: the library's sines are compared at ten.
    let ways = [(Trigonometry::Polynomials, states_of_octave()), (Trigonometry::Library, states_of_octave().min(10))];
    for (trigonometry, states_of_octave) in ways {
        if trigonometry == Trigonometry::Library && !is_complete() {
            continue;
        }
        let states = [states_of_scripts(), states_of_octave];
        let [same, close] = compared(&cases, trigonometry, states, |case, n| case.wanted(trigonometry, n));
        println!("{trigonometry:?}: {same} numbers with the same bits, {close} within their bounds");
        assert!(same > 50_000, "{same} {close}");
    }
}

/// Statements of a long chain are written once, in loops, and give the same bits.
#[test]
fn links_of_a_long_chain_are_loops() {
    let chains = long_chains();
    for (chain, (language, loops)) in chains.iter().flat_map(|chain| LOOPS.map(|loops| (chain, loops))) {
        let text = language.write(&chain.of, &chain.name, &Options::default());
        assert!(loops.iter().all(|begin| text.contains(begin)), "{} has no loops", language.name());
    }
    let cases: Vec<&Case> = chains.iter().collect();
    let [same, close] =
        compared(&cases, Trigonometry::Polynomials, [STATES, 5], |case, n| case.wanted(Trigonometry::Polynomials, n));
    println!("{same} numbers with the same bits");
    let is_there = RUNS.iter().any(|(_, program, shown, _)| has(program, shown));
    assert!(close == 0 && (same > 500 || !is_there), "{same} {close}");
}

/// What loops begin with, outwards and inwards.
const LOOPS: [(Language, [&str; 2]); 3] = [
    (Language::Js, ["for (let i = 1; i < ", "i -= 1) {"]),
    (Language::Python, ["for i in range(", "for i in reversed(range("]),
    (Language::Matlab, ["for k = 1:", ":-1:"]),
];

/// Every function that the language of mechanisms has.
#[test]
fn the_librarys_functions_are_within_4_ulp() {
    let (case, wanted) = elementary::case();
    for trigonometry in [Trigonometry::Polynomials, Trigonometry::Library] {
        compared(&[&case], trigonometry, [STATES; 2], |case, _| wanted(case, trigonometry));
    }
}

/// A mechanism in a language, in a folder.
fn place(folder: &Path, language: Language, case: &Case) {
    let text = language.write(&case.of, &case.name, &Options::default());
    std::fs::write(folder.join(language.file_name(&case.of)), text).expect("written");
}

/// A language, the program that runs it and what shows that it is there, and the name of a file.
type Run = (Language, &'static str, &'static [&'static str], &'static [&'static str]);

const RUNS: [Run; 3] = [
    (Language::Js, "node", &["--version"], &["main.mjs"]),
    (Language::Python, "python3", &["-c", "import numpy"], &["-W", "error", "main.py"]),
    (Language::Matlab, "octave-cli", &["--version"], &["--quiet", "--norc", "main.m"]),
];

/// How the same programs run all functions.
const DRIVERS: [(&[&str], &str); 3] = [
    (&["drive.mjs"], include_str!("scripts/drive.mjs")),
    (&["-W", "error", "drive.py"], include_str!("scripts/drive.py")),
    (&["--no-gui", "--quiet", "--norc", "drive.m"], include_str!("scripts/drive.m")),
];

/// The programs of the manual, and what they print.
#[test]
fn the_manual_has_programs_that_run() {
    let manuals = [
        ("```js\n", include_str!("../../docs/javascript.md")),
        ("```python\n", include_str!("../../docs/numpy.md")),
        ("```matlab\n", include_str!("../../docs/matlab.md")),
    ];
    let pendulum = named("double_pendulum");
    let of = &pendulum.of;
    // m1, l1, m2, l2, g or the like: the one that is changed by its name.
    let parameters = of.parameters.iter().map(|p| if p.name == "l2" { 0.5 } else { p.defaults[0].to_f64() });
    let interpreter = Interpreter::with_parameters(of, parameters.collect());
    let call = |name: &str, q: [f64; 2]| {
        let state = State { q: q.to_vec(), qd: vec![0.0; 2], ..pendulum.states[0].0.clone() };
        interpreter.evaluate(of.named(name).expect("it is there"), &state)
    };
    let accelerations = call("forward_dynamics", [0.3, -0.2]);
    let first = format!("{:.12} {:.12}\n", accelerations[0], accelerations[1]);
    let mass = format!("{:.12}\n", call("mass_matrix", [0.3, -0.2])[1]);
    let last = format!("{:.12}\n", call("mass_matrix", [8.0 / 9.0, 1.0])[1]);
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
        place(folder.path(), language, pendulum);
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
  () => new While({ q: Infinity }), () => new While({ q: '1' }), () => new While({ l: ['1', '2'] }),
  () => new While({ l: [null, 1] }), () => new While({ q: null }), () => new While({ q: [2] }),
  () => m.delete([null, 2, 3]), () => m.delete(['1', '2', '3']), () => m.delete([undefined, 2, 3]), () => m.delete('123')];
for (const call of refused) {
  try {
    call();
    console.log('not refused', call.toString());
  } catch (error) {
    if (!(error instanceof RangeError) || error.message.includes('stack')) throw error;
  }
}
",
        "from py_while import While, Params
m = While(Params(py_lambda=3))
q = [1, 2, 3]
print(int(m.constructor(q)), int(m.delete(q)), int(m.end(q)), m.params.py_lambda)
for call in [lambda: m.delete([1]), lambda: m.delete(1.0), lambda: While(Params(l=(1,))), lambda: While(Params(q=float('inf'))),
             lambda: m.delete([1j, 2, 3]), lambda: m.delete(['1', '2', '3']), lambda: m.delete([None, 2, 3]),
             lambda: While(Params(q='2')), lambda: While(Params(q=2j)), lambda: While(Params(l=(None, 1)))]:
    try:
        call()
        print('not refused')
    except ValueError:
        pass
",
        "m = m_while(struct('lambda', 3));
q = [1; 2; 3];
printf('%d %d %d %d\\n', m.constructor(q), m.delete(q), m.m_end(q), m.params.lambda);
qdd = m.forward_dynamics(q, q);
assert(isequal(qdd, m.forward_dynamics(int32(q), q), m.forward_dynamics(single(q), uint8(q))));
refused = {@() m.delete(1), @() m_while(struct('lamda', 3)), @() m_while(struct('l', 1)), @() m_while(struct('q', Inf)), ...
  @() m.delete([1i; 2; 3]), @() m.delete('123'), @() m_while(struct('q', 2i))};
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
    let case = Case::new("while", &Sources::new("while.mbs", text));
    for ((language, program, shown, arguments), main) in RUNS.into_iter().zip(mains) {
        if !has(program, shown) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        place(folder.path(), language, &case);
        std::fs::write(folder.path().join(arguments[arguments.len() - 1]), main).expect("written");
        assert_eq!(run(program, arguments, folder.path()), "1 2 3 3\n", "{program}");
    }
}

/// A file that is called as a function that it calls, parameters in columns, and prescribed motions of another shape.
#[test]
fn octave_has_its_own_names_and_shapes() {
    let (language, program, shown, arguments) = RUNS[2];
    if !has(program, shown) {
        return;
    }
    let text = "mechanism Double { param m[2]: kg = [1, 2]; coord x: m; prescribed s: m; prescribed r: m; \
                kinetic += (m[0] + 2*m[1])*dt(x + s)^2/2 + m[1]*dt(r)*dt(x); }";
    let main = "row = m_double(struct('m', [3, 4]));
column = m_double(struct('m', [3; 4]));
given = [0, 0, 5; 0, 0, 7];
printf('%g %g\\n', row.forward_dynamics(given, 0, 0), column.forward_dynamics(given, 0, 0));
for wrong = {given', given(:), given(1, :), reshape(given, 1, 6)}
  try
    row.forward_dynamics(wrong{1}, 0, 0);
    printf('not refused\\n');
  catch failure
    assert(failure.identifier, 'mbs:size');
  end
end
";
    let folder = tempfile::tempdir().expect("a folder");
    place(folder.path(), language, &Case::new("double", &Sources::new("double.mbs", text)));
    std::fs::write(folder.path().join("main.m"), main).expect("written");
    // (m₀ + 2 m₁) (ẍ + s̈) + m₁ r̈ = 0
    let expected = -5.0 - 4.0 * 7.0 / 11.0;
    assert_eq!(run(program, arguments, folder.path()), format!("{expected:.5} {expected:.5}\n"));
}
