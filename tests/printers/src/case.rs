//! The mechanisms of the repository, states, and what each function gives there by the proved program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use mbs_derive::Analysis;
use mbs_derive::emit::{Options, Trigonometry};
use mbs_derive::expr::{Binary, Function as Elementary, Graph, Rounded};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Completion, Derivation, Function, FunctionKind, Instruction, Program};
use mbs_derive::source::Sources;
use nalgebra::{DMatrix, DVector};

use crate::call::arguments;
use crate::depth::STATES;
use crate::random::Random;
use crate::tools;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Where mechanisms are declared that are generated; wrong ones, misprinted ones and copies are elsewhere.
const FOLDERS: [&str; 5] = ["models", "tests/mechanisms", "tests/platform", "examples/downstream", "examples/embedded"];

/// A mechanism, derived, and the states at which it is compared.
pub struct Case {
    /// As its file is called.
    pub name: String,
    /// Its programs.
    pub of: Derivation,
    /// With multipliers. The first three are special: two on the constraints, one at rest and straight.
    pub states: Vec<(State, Vec<f64>)>,
}

/// Results, function by function, state by state, number by number, and how far another language may be from each: not
/// a bit where it is zero.
pub struct Wanted {
    /// The program's own.
    pub values: Vec<f64>,
    /// Twice the running error bound, because both sides have been rounded; zero where bits are the same everywhere.
    pub bounds: Vec<f64>,
}

/// All of them, by name.
pub static ALL: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let files: BTreeMap<String, PathBuf> =
        FOLDERS.iter().flat_map(|folder| files(&Path::new(ROOT).join(folder))).collect();
    tools::each(files, |(name, path)| {
        let sources = mbs_derive::read(&path).unwrap_or_else(|error| panic!("{error}"));
        Case::new(&name, &sources)
    })
});

/// Those with a mechanism in it, by what they are called without the ending.
fn files(folder: &Path) -> Vec<(String, PathBuf)> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let is_mechanism = || {
                let text = std::fs::read_to_string(&path).expect("a text");
                text.lines().any(|line| line.starts_with("mechanism "))
            };
            match path.extension().and_then(|ending| ending.to_str()) {
                _ if path.is_dir() && !path.ends_with("target") => folders.push(path),
                Some("mbs") if is_mechanism() => {
                    found.push((path.file_stem().expect("a name").to_string_lossy().into_owned(), path));
                }
                _ => {}
            }
        }
    }
    found
}

/// The one of this name.
///
/// # Panics
/// If there is none.
#[must_use]
pub fn named(name: &str) -> &'static Case {
    ALL.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("there is no mechanism {name}"))
}

/// Links on universal joints: a turn of a loop is two links, the angles of the second ones stand behind all others.
const CABLE: &str = "mechanism LongCable {
    const n = 20;
    coord a[n]: rad;
    coord b[n]: rad;
    let mut link = world;
    for i in 0..n {
        link = link * rot_x(a[i]) * rot_y(b[i]);
        kinetic += rigid_body(2 kg, [0, 0, -0.15 m], diag(0.02 kg*m^2, 0.02 kg*m^2, 0.003 kg*m^2), link);
        potential += 2 kg * 9.81 m/s^2 * link.point([0, 0, -0.15 m]).z + 3 N*m*(a[i]^2 + b[i]^2)/2;
        link = link * translation([0, 0, -0.3 m]);
    }
}";

/// Mechanisms whose links are written in loops: on hinges, and on universal joints.
pub fn long_chains() -> [Case; 2] {
    let text = include_str!("../../mechanisms/n_chain.mbs").replace("const n = 5;", "const n = 40;");
    let options = Options::default().functions(["inverse_dynamics", "forward_dynamics"]);
    let case = |name: &str, file: &str, text: &str| Case::with_options(name, &Sources::new(file, text), &options);
    [case("long_chain", "n_chain.mbs", &text), case("long_cable", "long_cable.mbs", CABLE)]
}

impl Case {
    /// Of a text.
    ///
    /// # Panics
    /// If it declares no mechanism.
    #[must_use]
    pub fn new(name: &str, sources: &Sources) -> Case {
        Case::with_options(name, sources, &Options::default())
    }

    /// Of a text, with the functions that are asked for.
    ///
    /// # Panics
    /// If it declares no mechanism.
    #[must_use]
    pub fn with_options(name: &str, sources: &Sources, options: &Options) -> Case {
        let graph = Graph::verbatim();
        let analysis = Analysis::with_options(sources, &graph, options);
        let of = analysis.unwrap_or_else(|error| panic!("{}", error.render_in(sources))).into_programs();
        let mut random = Random::new(18);
        let mut states: Vec<(State, Vec<f64>)> = (0..STATES).map(|_| state(&of, &mut random)).collect();
        states[..2].iter_mut().for_each(|(state, _)| on_the_constraints(&of, state));
        let straight = &mut states[2].0;
        straight.q.iter_mut().chain(&mut straight.qd).for_each(|x| *x = 0.0);
        Case { name: name.to_string(), of, states }
    }

    /// The first states, number after number, in the order of [`arguments`].
    #[must_use]
    pub fn numbers(&self, states: usize) -> Vec<f64> {
        let all = self.states[..states].iter().flat_map(|(state, multipliers)| {
            let prescribed = state.prescribed.as_flattened();
            [&[state.t], prescribed, &state.q, &state.qd, &state.qdd, &state.u, multipliers].concat()
        });
        all.collect()
    }

    /// How many numbers a function gives.
    #[must_use]
    pub fn size(function: &Function) -> usize {
        function.results.iter().map(|part| part.shape.entries()).sum()
    }

    /// Results at the first states, and how far those of other languages may be from them.
    #[must_use]
    pub fn wanted(&self, trigonometry: Trigonometry, states: usize) -> Wanted {
        let interpreter = Interpreter::with_trigonometry(&self.of, trigonometry);
        let defaults = self.of.parameters.iter().flat_map(|p| &p.defaults);
        let defaults = defaults.map(|value| Rounded::exact(value.to_f64())).collect();
        let rounded = Interpreter::with_parameters(&self.of, defaults);
        let mut wanted = Wanted { values: Vec::new(), bounds: Vec::new() };
        for function in &self.of.functions {
            let differs = self.differs(function, trigonometry);
            for (state, multipliers) in &self.states[..states] {
                let values = interpreter.evaluate_with(function, state, multipliers);
                let bounds =
                    if differs { bounds(&rounded, function, state, multipliers) } else { vec![0.0; values.len()] };
                wanted.values.extend(values);
                wanted.bounds.extend(bounds);
            }
        }
        wanted
    }

    /// Whether something occurs in a function, or before it, that libraries may compute differently.
    fn differs(&self, function: &Function, trigonometry: Trigonometry) -> bool {
        let differs = |program: &Program| program.instructions.iter().any(|i| is_the_librarys(i, trigonometry));
        let dynamics = self.of.function(FunctionKind::ForwardDynamics);
        let before = dynamics.filter(|_| function.completion != Completion::None);
        let mut programs =
            [Some(&self.of.constructor), Some(&function.program), before.map(|f| &f.program)].into_iter();
        programs.any(|program| program.is_some_and(differs))
    }

    /// Compares what a language found at the first states; how many numbers have the same bits, and how many are within
    /// their bounds only.
    ///
    /// # Panics
    /// With the language, the function, the state and the number, if one is neither.
    #[track_caller]
    pub fn compare(&self, language: &str, found: &[f64], wanted: &Wanted, states: usize) -> [usize; 2] {
        assert_eq!(found.len(), wanted.values.len(), "{language}, {}", self.name);
        let (mut place, mut counts) = (0, [0, 0]);
        for function in &self.of.functions {
            for state in 0..states {
                for i in 0..Case::size(function) {
                    let (found, want, bound) = (found[place], wanted.values[place], wanted.bounds[place]);
                    let is_same = found.to_bits() == want.to_bits() || (found.is_nan() && want.is_nan());
                    let is_close = (found - want).abs() <= bound || (bound.is_nan() && !want.is_finite());
                    assert!(
                        is_same || is_close,
                        "{language}, {}, {}, state {state}, number {i}: {found:e}, not {want:e} ± {bound:e}",
                        self.name,
                        function.name
                    );
                    counts[usize::from(!is_same)] += 1;
                    place += 1;
                }
            }
        }
        counts
    }
}

/// Whether libraries may differ in it.
fn is_the_librarys(instruction: &Instruction, trigonometry: Trigonometry) -> bool {
    match instruction {
        Instruction::Call(Elementary::Sin | Elementary::Cos, _) => trigonometry == Trigonometry::Library,
        Instruction::Call(function, _) => !matches!(function, Elementary::Abs | Elementary::Signum),
        Instruction::Call2(Binary::Atan2 | Binary::Powf, ..) => true,
        _ => false,
    }
}

fn bounds(interpreter: &Interpreter<'_, Rounded>, function: &Function, state: &State, multipliers: &[f64]) -> Vec<f64> {
    let exact = |values: &[f64]| values.iter().copied().map(Rounded::exact).collect::<Vec<_>>();
    let state = State {
        t: Rounded::exact(state.t),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Rounded::exact)).collect(),
        q: exact(&state.q),
        qd: exact(&state.qd),
        qdd: exact(&state.qdd),
        u: exact(&state.u),
    };
    let results = interpreter.evaluate_with(function, &state, &exact(multipliers));
    results.iter().map(|result| 2.0 * result.error).collect()
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

/// Moves a state to where the constraints hold, for there rows may depend on others; leaves it where that fails.
fn on_the_constraints(of: &Derivation, state: &mut State) {
    if let Some(nearest) = nearest(of, state) {
        *state = nearest;
    }
}

fn nearest(of: &Derivation, from: &State) -> Option<State> {
    if of.constraints.is_empty() {
        return None;
    }
    let mechanism = Interpreter::new(of);
    let change = |state: &State, residuals: Vec<f64>| {
        let slopes = mechanism.rows(FunctionKind::ConstraintJacobian, state);
        let numbers = slopes.iter().chain(&residuals);
        if !numbers.copied().all(f64::is_finite) {
            return None;
        }
        let slopes = DMatrix::from_row_slice(residuals.len(), state.q.len(), &slopes);
        let inverse = slopes.try_svd(true, true, f64::EPSILON, 1000)?.pseudo_inverse(1e-9).ok()?;
        Some(inverse * DVector::from_vec(residuals))
    };
    let mut state = from.clone();
    for _ in 0..50 {
        let rows = mechanism.rows(FunctionKind::Constraint, &state).into_iter().zip(&of.holonomic);
        let residuals = rows.map(|(residual, is_place)| if *is_place { residual } else { 0.0 }).collect();
        let change = change(&state, residuals)?;
        state.q.iter_mut().zip(change.iter()).for_each(|(q, change)| *q -= change);
    }
    let change = change(&state, mechanism.rows(FunctionKind::ConstraintRate, &state))?;
    state.qd.iter_mut().zip(change.iter()).for_each(|(qd, change)| *qd -= change);
    Some(state)
}
