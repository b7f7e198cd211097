//! Runs Programs in process: the command line, the proofs and the tests evaluate the very code that is emitted.

use crate::expr::{Number, Symbol};
use crate::optimise::{Argument, Completion, Derivation, Function, Instruction, Program, ResultPart, Shape};

/// The arguments of a mechanism's functions, flattened in declaration order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time.
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub qd: Vec<f64>,
    /// Accelerations.
    pub qdd: Vec<f64>,
    /// Inputs.
    pub u: Vec<f64>,
}

/// A mechanism with values for its parameters.
#[derive(Clone, Debug)]
pub struct Interpreter<'d> {
    derivation: &'d Derivation,
    parameters: Vec<f64>,
    hoisted: Vec<f64>,
}

impl<'d> Interpreter<'d> {
    /// With the declared defaults.
    pub fn new(derivation: &'d Derivation) -> Self {
        let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults);
        Self::with_parameters(derivation, defaults.copied().map(Number::to_f64).collect())
    }

    /// With these parameters, flattened in declaration order.
    pub fn with_parameters(derivation: &'d Derivation, parameters: Vec<f64>) -> Self {
        let state = State::default();
        let hoisted = Run { state: &state, parameters: &parameters, hoisted: &[] }.results(&derivation.constructor);
        Interpreter { derivation, parameters, hoisted }
    }

    /// The mechanism.
    pub fn derivation(&self) -> &'d Derivation {
        self.derivation
    }

    /// The parameters, flattened in declaration order.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// The results of the function with this name, part by part and row by row, symmetric matrices in full.
    /// `None` if there is no such function.
    pub fn call(&self, name: &str, state: &State) -> Option<Vec<f64>> {
        self.derivation.function(name).map(|function| self.evaluate(function, state))
    }

    /// The results of one of the mechanism's functions, part by part and row by row, symmetric matrices in full.
    pub fn evaluate(&self, function: &Function, state: &State) -> Vec<f64> {
        match function.completion {
            Completion::None => {
                let values = self.run(&function.program, state);
                expand_symmetric(&function.results, values)
            }
            Completion::Solve => self.solve(function, state),
        }
    }

    fn run(&self, program: &Program, state: &State) -> Vec<f64> {
        Run { state, parameters: &self.parameters, hoisted: &self.hoisted }.results(program)
    }

    /// `M x = b` for each column b, as the runtime does it.
    fn solve(&self, function: &Function, state: &State) -> Vec<f64> {
        let n = self.derivation.dof();
        let needs_acceleration = !function.arguments.contains(&Argument::Qdd)
            && function.program.uses(|symbol| matches!(symbol, Symbol::Acceleration(_)));
        let qdd = if needs_acceleration { self.call("forward_dynamics", state).unwrap_or_default() } else { Vec::new() };
        let values = self.run(&function.program, &State { qdd, ..state.clone() });
        let (triangle, mut right_sides) = (&values[..n * (n + 1) / 2], values[n * (n + 1) / 2..].to_vec());
        let factors = Factors::new(n, triangle);
        let mut start = 0;
        for part in &function.results {
            let columns = part.shape.count() / n;
            for column in 0..columns {
                factors.solve(|i| start + i * columns + column, &mut right_sides);
            }
            start += part.shape.count();
        }
        right_sides
    }
}

fn expand_symmetric(results: &[ResultPart], values: Vec<f64>) -> Vec<f64> {
    let [ResultPart { shape: Shape::Symmetric(n), .. }] = results else { return values };
    let entry = |i: usize, j: usize| values[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    (0..*n).flat_map(|i| (0..*n).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect()
}

struct Run<'a> {
    state: &'a State,
    parameters: &'a [f64],
    hoisted: &'a [f64],
}

impl Run<'_> {
    fn results(&self, program: &Program) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(program.instructions.len());
        for instruction in &program.instructions {
            let value = match *instruction {
                Instruction::Constant(number) => number.to_f64(),
                Instruction::Symbol(symbol) => self.symbol(symbol),
                Instruction::Hoisted(k) => self.hoisted[k as usize],
                Instruction::Neg(a) => -values[a.index()],
                Instruction::Add(a, b) => values[a.index()] + values[b.index()],
                Instruction::Sub(a, b) => values[a.index()] - values[b.index()],
                Instruction::Mul(a, b) => values[a.index()] * values[b.index()],
                Instruction::Div(a, b) => values[a.index()] / values[b.index()],
                Instruction::Sqrt(a) => values[a.index()].sqrt(),
                Instruction::Call(function, a) => function.value(values[a.index()]),
                Instruction::Call2(function, a, b) => function.value(values[a.index()], values[b.index()]),
            };
            values.push(value);
        }
        program.results.iter().map(|v| values[v.index()]).collect()
    }

    fn symbol(&self, symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Time => self.state.t,
            Symbol::Coordinate(i) => self.state.q[i as usize],
            Symbol::Velocity(i) => self.state.qd[i as usize],
            Symbol::Acceleration(i) => self.state.qdd[i as usize],
            Symbol::Parameter(i) => self.parameters[i as usize],
            Symbol::Input(i) => self.state.u[i as usize],
        }
    }
}

/// `M = L D Lᵀ` in the order of operations of the runtime's `Ldlt`, so that the results are the same bits.
struct Factors {
    lower: Vec<Vec<f64>>,
    reciprocal: Vec<f64>,
}

impl Factors {
    fn new(n: usize, triangle: &[f64]) -> Self {
        let m = |i: usize, j: usize| triangle[i * (i + 1) / 2 + j];
        let mut lower: Vec<Vec<f64>> = Vec::new();
        let mut reciprocal: Vec<f64> = Vec::new();
        for i in 0..n {
            let mut scaled: Vec<f64> = Vec::new();
            for j in 0..i {
                scaled.push((0..j).fold(m(i, j), |sum, k| sum - scaled[k] * lower[j][k]));
            }
            let row: Vec<f64> = (0..i).map(|j| scaled[j] * reciprocal[j]).collect();
            let pivot = (0..i).fold(m(i, i), |sum, k| sum - scaled[k] * row[k]);
            reciprocal.push(1.0 / pivot);
            lower.push(row);
        }
        Factors { lower, reciprocal }
    }

    /// Solves in place for the column whose components stand at `at(0)`, `at(1)`, ….
    fn solve(&self, at: impl Fn(usize) -> usize, x: &mut [f64]) {
        let n = self.reciprocal.len();
        for i in 0..n {
            x[at(i)] = (0..i).fold(x[at(i)], |sum, k| sum - self.lower[i][k] * x[at(k)]);
        }
        for i in 0..n {
            x[at(i)] *= self.reciprocal[i];
        }
        for i in (0..n).rev() {
            x[at(i)] = (i + 1..n).fold(x[at(i)], |sum, k| sum - self.lower[k][i] * x[at(k)]);
        }
    }
}
