//! A mechanism as people review it: a text whose differences they can read.
//!
//! Up to 39 kB it is the generated module, with `a * b + c` for `a.mul_add(b, c)` and traits without their functions.
//! Beyond that nobody reads it: what is left are signatures, documentation, operation counts, a digest of each body,
//! and a table of what every function gives at three states.

use std::fmt::Write;

use crate::emit::{self, Options};
use crate::interpret::{Interpreter, State};
use crate::numeric::Random;
use crate::optimise::{Derivation, Function, FunctionKind};
use crate::shape::Shape;
use crate::variable::{self, Variable};

/// Modules of more bytes than this are summed up.
const FULL: usize = 39_000;

/// At this many states values are shown.
const STATES: usize = 3;

/// This many digits of the largest number that a function returns are shown, and as many places of the others.
const DIGITS: i32 = 12;

impl Derivation {
    /// What is to be reviewed of a mechanism, as [`review`](fn@crate::review) reads it from a file; `source` is what
    /// the first line calls the declaration.
    pub fn review(&self, source: &str) -> String {
        let options = Options { infix: true, ..Options::default() };
        if emit::rust(self, source, &options).len() <= FULL {
            return emit::without_forwarders(self, source, &options);
        }
        format!("{}\n{}", emit::outline(self, source, &options), values(self))
    }
}

/// What every function gives at some states.
fn values(derivation: &Derivation) -> String {
    let interpreter = Interpreter::new(derivation);
    let mut text = String::new();
    for (number, state) in states(&interpreter).iter().enumerate() {
        writeln!(text, "// State {}", number + 1).expect(INFALLIBLE);
        writeln!(text, "t = {:?}", state.t).expect(INFALLIBLE);
        for (name, values) in [("q", &state.q), ("qd", &state.qd), ("qdd", &state.qdd), ("u", &state.u)] {
            writeln!(text, "{name} = {values:?}").expect(INFALLIBLE);
        }
        if !state.prescribed.is_empty() {
            writeln!(text, "prescribed = {:?}", state.prescribed).expect(INFALLIBLE);
        }
        for function in &derivation.functions {
            write_results(&mut text, function, &interpreter.evaluate(function, state));
        }
        text.push('\n');
    }
    text
}

const INFALLIBLE: &str = "a string takes everything";

/// States of few digits at which the energies are finite, the same on every machine.
fn states(interpreter: &Interpreter<'_>) -> Vec<State> {
    let derivation = interpreter.derivation();
    let mut random = Random::new(0x7265_7669);
    let mut rounded = |count: usize| random.vector(count, 200.0).iter().map(|x| x.round() / 100.0).collect::<Vec<_>>();
    let count = |variables: &[Variable]| variable::count(variables);
    let mut state = || State {
        t: rounded(1)[0],
        q: rounded(derivation.dof()),
        qd: rounded(derivation.dof()),
        qdd: rounded(derivation.dof()),
        u: rounded(count(&derivation.inputs)),
        prescribed: (0..count(&derivation.prescribed)).map(|_| [rounded(1)[0], rounded(1)[0], rounded(1)[0]]).collect(),
    };
    let energies = [FunctionKind::KineticEnergy, FunctionKind::PotentialEnergy];
    let is_finite = |state: &State| {
        energies.iter().filter_map(|&energy| interpreter.call(energy, state)).flatten().all(f64::is_finite)
    };
    (0..100 * STATES).map(|_| state()).filter(is_finite).take(STATES).collect()
}

/// The results of a function, a row of a matrix in a line.
fn write_results(text: &mut String, function: &Function, mut values: &[f64]) {
    let finite = values.iter().copied().filter(|x| x.is_finite());
    let largest = magnitude(finite.fold(f64::MIN_POSITIVE, |largest, x| largest.max(x.abs())));
    for part in &function.results {
        let (count, columns) = match part.shape {
            Shape::Symmetric(n) => (n * n, n),
            Shape::Matrix(_, columns) | Shape::Matrices(_, _, columns) => (part.shape.count(), columns),
            Shape::Pose | Shape::Wrench | Shape::Wrenches(_) | Shape::Poses(_) => (part.shape.count(), 3),
            Shape::Scalar | Shape::Vector(_) => (part.shape.count(), part.shape.count()),
        };
        let (own, rest) = values.split_at(count);
        values = rest;
        let dot = if part.name.is_empty() { "" } else { "." };
        write!(text, "{}{dot}{} =", function.name, part.name).expect(INFALLIBLE);
        if own.iter().all(|&x| x == 0.0) {
            text.push_str(" 0\n");
            continue;
        }
        if count > columns {
            text.push('\n');
        }
        for row in own.chunks(columns) {
            let numbers = row.iter().map(|&value| rounded(value, largest + 1 - DIGITS));
            let line = numbers.fold(String::new(), |line, number| line + " " + &number);
            writeln!(text, "{line}").expect(INFALLIBLE);
        }
    }
}

/// The power of ten of the first digit.
fn magnitude(x: f64) -> i32 {
    x.abs().log10().floor() as i32
}

/// A number to the digit of this power of ten, without zeros at its end.
fn rounded(value: f64, place: i32) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let digits = if value == 0.0 { -1 } else { magnitude(value) - place };
    let Ok(digits) = usize::try_from(digits) else { return "0".to_string() };
    let written = format!("{value:.digits$e}");
    let shortest: f64 = written.parse().expect("a number");
    if (1e-3..1e6).contains(&shortest.abs()) { shortest.to_string() } else { format!("{shortest:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn derivation(source: &str) -> Derivation {
        let graph = crate::expr::Graph::verbatim();
        crate::derived(&crate::declared(source, &graph, &[]).expect("a mechanism").0)
    }

    #[test]
    fn short_modules_are_shown_in_full_and_infix() {
        let short = derivation(
            "mechanism Oscillator { param m: kg = 1; param k: N/m = 4; coord x: m; input f: N; \
             kinetic += 1/2*m*dt(x)^2; potential += 1/2*k*x^2; force x += f; }",
        );
        let text = short.review("oscillator.mbs");
        assert!(text.contains("[m * x_ddot + k * x]") && !text.contains("mul_add"), "{text}");
        assert!(
            text.contains("    /// Implements `Dynamics`, `Energies`, `Linearized`, `Mechanism` of mbs-runtime.\n"),
            "{text}"
        );
        assert!(!text.contains("::mbs_runtime::Mechanism"), "{text}");
    }

    /// What is shown is what the functions give, and long bodies are digests.
    #[test]
    fn long_modules_are_summed_up() {
        let chain = derivation(
            "mechanism Chain { const n = 5; param m: kg = 1; param l: m = 1; param g: m/s^2 = 10; coord q[n]: rad; \
             let mut x = 0 m; let mut y = 0 m; \
             for i in 0..n { x = x + l*sin(q[i]); y = y - l*cos(q[i]); \
             kinetic += 1/2*m*(dt(x)^2 + dt(y)^2); potential += m*g*y; } }",
        );
        let text = chain.review("chain.mbs");
        assert!(text.len() < FULL && text.contains("Digest of the body: ") && text.contains("pub fn mass_matrix"));
        let states = text.matches("// State ").count();
        assert_eq!(states, STATES);
        let line = |name: &str| {
            let numbers = text.lines().find_map(|line| line.strip_prefix(&format!("{name} ="))).expect("a line of it");
            numbers.split_whitespace().map(|x| x.parse().expect("a number")).collect::<Vec<f64>>()
        };
        let interpreter = Interpreter::new(&chain);
        let state = &super::states(&interpreter)[0];
        for kind in [FunctionKind::PotentialEnergy, FunctionKind::Bias, FunctionKind::ForwardDynamics] {
            let name = chain.function(kind).expect("a function").name.as_str();
            let expected = interpreter.call(kind, state).expect("a function");
            let largest = expected.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            for (found, expected) in line(name).iter().zip(&expected) {
                assert!((found - expected).abs() <= 1e-11 * largest, "{name}: {found} {expected}");
            }
        }
    }
}
