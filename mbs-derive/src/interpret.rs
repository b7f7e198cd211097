//! Runs Programs in process: the command line, the proofs and the tests evaluate the very code that is emitted.
//!
//! - `eliminated`: what the system of a mechanism that is eliminated in a known order tells besides its solution.

mod eliminated;

use crate::expr::evaluate::{holds, truth};
use crate::expr::{Number, Symbol, Terms, Trigonometry, Value, largest};
use crate::optimise::{
    Argument, Completion, Derivation, Function, FunctionKind, Instruction, Program, ResultPart, Shape, Value as Step,
};
pub use crate::state::State;
use crate::variable::component_names;

/// A mechanism with values for its parameters: doubles, or dual numbers that carry derivatives.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let spring = mbs_derive::interpret::Interpreter::new(analysis.programs());
/// let state = mbs_derive::interpret::State { q: vec![0.5], qd: vec![0.0], ..Default::default() };
/// let force = spring.call(mbs_derive::optimise::FunctionKind::Gravity, &state).unwrap();
/// assert_eq!(force, [2.0]); // k x
/// ```
#[derive(Clone, Debug)]
pub struct Interpreter<'d, V = f64> {
    derivation: &'d Derivation,
    parameters: Vec<V>,
    hoisted: Vec<V>,
    trigonometry: Trigonometry,
}

impl<'d> Interpreter<'d> {
    /// With the declared defaults.
    pub fn new(derivation: &'d Derivation) -> Self {
        Self::with_trigonometry(derivation, Trigonometry::default())
    }

    /// With the declared defaults, and sines and cosines as code generated with this option has them.
    pub fn with_trigonometry(derivation: &'d Derivation, trigonometry: Trigonometry) -> Self {
        let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults);
        Self::made(derivation, defaults.copied().map(Number::to_f64).collect(), trigonometry)
    }
}

/// A parameter, or an expression of parameters, that the mechanism cannot have.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The parameter by its name, or the expression.
    pub quantity: String,
    /// Its value in SI units; of an inertia the least principal moment, or the greatest less the other two.
    pub value: f64,
    /// What it must be, as the end of a sentence: `must not be negative`.
    pub must: &'static str,
}

impl Violation {
    /// Which parameters, flattened in declaration order, the mechanism cannot have: those that are not finite, or else
    /// those that break its requirements.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, interpret::Violation, source::Sources};
    /// let text = "mechanism Ball { param m: kg = 1; coord x: m; kinetic += m*dt(x)^2/2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("ball.mbs", text), &graph).unwrap();
    /// assert!(Violation::all(analysis.programs(), &[2.0]).is_empty());
    /// assert_eq!(Violation::all(analysis.programs(), &[-2.0])[0].quantity, "m");
    /// ```
    pub fn all(derivation: &Derivation, parameters: &[f64]) -> Vec<Violation> {
        // Names are made where one is wanted: ensembles ask a million times.
        if parameters.iter().any(|value| !value.is_finite()) {
            let names = component_names(&derivation.parameters).into_iter().zip(parameters);
            let broken = names.filter(|(_, value)| !value.is_finite());
            return broken.map(|(quantity, &value)| Violation { quantity, value, must: "must be finite" }).collect();
        }
        let state = State::default();
        let trigonometry = Trigonometry::default();
        let values = Run { state: &state, multipliers: &[], parameters, hoisted: &[], trigonometry }
            .results(&derivation.required);
        let broken = derivation.conditions(&values).filter_map(|(requirement, values)| {
            let (value, must) = requirement.condition.violation(values)?;
            Some(Violation { quantity: requirement.quantity.clone(), value, must })
        });
        broken.collect()
    }
}

impl<'d, V: Value> Interpreter<'d, V> {
    /// With these parameters, flattened in declaration order.
    pub fn with_parameters(derivation: &'d Derivation, parameters: Vec<V>) -> Self {
        Self::made(derivation, parameters, Trigonometry::default())
    }

    fn made(derivation: &'d Derivation, parameters: Vec<V>, trigonometry: Trigonometry) -> Self {
        let t = V::constant(0.0);
        let state = State { t, q: Vec::new(), qd: Vec::new(), qdd: Vec::new(), u: Vec::new(), prescribed: Vec::new() };
        let hoisted = Run { state: &state, multipliers: &[], parameters: &parameters, hoisted: &[], trigonometry }
            .results(&derivation.constructor);
        Interpreter { derivation, parameters, hoisted, trigonometry }
    }

    /// The mechanism.
    pub fn derivation(&self) -> &'d Derivation {
        self.derivation
    }

    /// The parameters, flattened in declaration order.
    pub fn parameters(&self) -> &[V] {
        &self.parameters
    }

    /// The results of a function, part by part and row by row, symmetric matrices in full; `None` where the mechanism
    /// does not have it. M and A are there where they are left out, if they are eliminated in a known order.
    pub fn call(&self, kind: FunctionKind, state: &State<V>) -> Option<Vec<V>> {
        let evaluated = self.derivation.function(kind).map(|function| self.evaluate(function, state));
        evaluated.or_else(|| self.matrix_of_motion(kind, state))
    }

    /// The results of a function that mechanisms with constraints have, row by row; there are none without constraints.
    ///
    /// # Panics
    /// If a mechanism with constraints does not have it, either.
    pub fn rows(&self, kind: FunctionKind, state: &State<V>) -> Vec<V> {
        match self.derivation.constraints.is_empty() {
            true => Vec::new(),
            false => self.call(kind, state).unwrap_or_else(|| panic!("there is no function `{}`", kind.name())),
        }
    }

    /// The results of one of the mechanism's functions, part by part and row by row, symmetric matrices in full. Where
    /// it takes multipliers, they are those of forward dynamics.
    pub fn evaluate(&self, function: &Function, state: &State<V>) -> Vec<V> {
        let takes_multipliers = function.arguments.contains(&Argument::Multipliers);
        let multipliers =
            takes_multipliers.then(|| self.call(FunctionKind::Multipliers, state)).flatten().unwrap_or_default();
        self.evaluate_with(function, state, &multipliers)
    }

    /// [`evaluate`](Self::evaluate) with given multipliers.
    pub fn evaluate_with(&self, function: &Function, state: &State<V>, multipliers: &[V]) -> Vec<V> {
        match function.completion {
            Completion::None => {
                let values = self.run(&function.program, state, multipliers);
                expand_symmetric(&function.results, values)
            }
            Completion::Solve | Completion::SolveConstrained | Completion::SolveMultipliers => {
                self.solve(function, state)
            }
        }
    }

    fn run(&self, program: &Program, state: &State<V>, multipliers: &[V]) -> Vec<V> {
        let Interpreter { parameters, hoisted, trigonometry, .. } = self;
        Run { state, multipliers, parameters, hoisted, trigonometry: *trigonometry }.results(program)
    }

    /// The solution of the system that the program sets up, for each right side, as the runtime finds it.
    fn solve(&self, function: &Function, state: &State<V>) -> Vec<V> {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let (mut values, terms) = self.system(function, state);
        let right_sides = values.split_off(self.derivation.matrix_entries());
        let width = |part: &ResultPart| match part.shape {
            Shape::Matrix(_, columns) => columns,
            _ => 1,
        };
        let widths: Vec<usize> = function.results.iter().map(width).collect();
        let mut columns = columns(&right_sides, &widths, n + k);
        match (function.completion, &self.derivation.elimination) {
            (Completion::None, _) => unreachable!("there is no system"),
            (Completion::Solve, _) => V::solve_symmetric(&values, &mut columns),
            (_, Some(elimination)) => {
                let solve = V::eliminated(elimination, values);
                columns.iter_mut().for_each(|column| *column = solve(column));
            }
            (_, None) => {
                let jacobian = values.split_off(n * (n + 1) / 2);
                let vectors = &self.derivation.constraint_vectors;
                columns = V::constrained_columns(n, values, jacobian, vectors)(&columns, &terms);
            }
        }
        if function.completion == Completion::SolveMultipliers {
            return columns[0][n..].to_vec();
        }
        let mut columns = columns.iter();
        let parts = widths.iter().flat_map(|&width| {
            let part: Vec<&Vec<V>> = columns.by_ref().take(width).collect();
            (0..n).flat_map(move |i| part.clone().into_iter().map(move |column| column[i])).collect::<Vec<V>>()
        });
        parts.collect()
    }

    /// The values of a program whose accelerations and multipliers are those of the motion, and what its columns are
    /// measured by.
    fn system(&self, function: &Function, state: &State<V>) -> (Vec<V>, Terms<V>) {
        let none = Terms { sizes: Vec::new(), motion: Vec::new(), scales: Vec::new() };
        let is_of_motion = |symbol| matches!(symbol, Symbol::Acceleration(_) | Symbol::Multiplier(_));
        if !function.program.uses(is_of_motion) {
            let is_slope = matches!(function.kind, FunctionKind::Linearize | FunctionKind::LinearizeParameters);
            let is_constrained = function.completion.is_constrained() && is_slope;
            let motion = is_constrained.then(|| self.call(FunctionKind::ForwardDynamics, state)).flatten();
            let terms = motion.map_or(none, |motion| self.measured(function, state, motion));
            return (self.run(&function.program, state, &[]), terms);
        }
        let Some(forward_dynamics) = self.derivation.function(FunctionKind::ForwardDynamics) else {
            return (Vec::new(), none);
        };
        let mut qdd = match forward_dynamics.completion {
            Completion::SolveConstrained => self.constrained_motion(forward_dynamics, state),
            Completion::None | Completion::Solve | Completion::SolveMultipliers => {
                self.evaluate(forward_dynamics, state)
            }
        };
        let multipliers = qdd.split_off(self.derivation.dof());
        let terms = self.measured(function, state, qdd.clone());
        (self.run(&function.program, &State { qdd, ..state.clone() }, &multipliers), terms)
    }

    /// How large that is by which the columns of a linearization are derivatives, as the runtime's `state_sizes` has
    /// it.
    fn measured(&self, function: &Function, state: &State<V>, motion: Vec<V>) -> Terms<V> {
        let scales = if function.kind == FunctionKind::LinearizeParameters {
            self.parameters.clone()
        } else {
            let kinds = self.derivation.coordinate_kinds();
            let alike = |values: &[V], kind: usize| {
                largest(values.iter().zip(&kinds).filter(|(_, other)| **other == kind).map(|(&x, _)| x))
            };
            let place = |&kind: &usize| if kind == 0 { V::constant(1.0) } else { alike(&state.q, kind) };
            let rate = |&kind: &usize| alike(&state.qd, kind);
            let inputs = state.u.iter().map(|_| V::constant(0.0));
            kinds.iter().map(place).chain(kinds.iter().map(rate)).chain(inputs).collect()
        };
        Terms { sizes: Vec::new(), motion, scales }
    }

    /// q̈, then λ.
    fn constrained_motion(&self, forward_dynamics: &Function, state: &State<V>) -> Vec<V> {
        if let Some(elimination) = &self.derivation.elimination {
            let mut entries = self.run(&forward_dynamics.program, state, &[]);
            let right_side = entries.split_off(elimination.entries.len());
            return V::eliminated(elimination, entries)(&right_side);
        }
        let System { mass, jacobian, right_side } = self.system_of_motion(forward_dynamics, state);
        V::constrained(self.derivation.dof(), mass, jacobian, &self.derivation.constraint_vectors)(&right_side)
    }

    /// The values of a function's program, of given accelerations and multipliers, before what it sets up is solved.
    pub(crate) fn values(&self, function: &Function, state: &State<V>, multipliers: &[V]) -> Vec<V> {
        self.run(&function.program, state, multipliers)
    }

    /// The values of all instructions of a program without branches.
    pub(crate) fn steps(&self, program: &Program, state: &State<V>, multipliers: &[V]) -> Vec<V> {
        let Interpreter { parameters, hoisted, trigonometry, .. } = self;
        let run = Run { state, multipliers, parameters, hoisted, trigonometry: *trigonometry };
        run.steps(program)
    }

    /// What a program sets up for the motion with constraints.
    pub(crate) fn system_of_motion(&self, forward_dynamics: &Function, state: &State<V>) -> System<V> {
        let mut matrices = self.run(&forward_dynamics.program, state, &[]);
        let right_side = matrices.split_off(self.derivation.matrix_entries());
        let n = self.derivation.dof();
        let (mass, jacobian) = match &self.derivation.elimination {
            Some(elimination) => elimination.in_full(&matrices),
            None => {
                let jacobian = matrices.split_off(n * (n + 1) / 2);
                (matrices, jacobian)
            }
        };
        System { mass, jacobian, right_side }
    }
}

/// `M q̈ − Aᵀ λ = f`, `A q̈ = c`: the lower triangle of M and A, row by row, and f, then c.
pub(crate) struct System<V> {
    pub mass: Vec<V>,
    pub jacobian: Vec<V>,
    pub right_side: Vec<V>,
}

/// The columns of right sides with `rows` rows each; each part has columns of its own, row by row.
pub(crate) fn columns<V: Value>(mut right_sides: &[V], widths: &[usize], rows: usize) -> Vec<Vec<V>> {
    let mut columns = Vec::new();
    for &width in widths {
        let (part, behind) = right_sides.split_at(rows * width);
        columns.extend((0..width).map(|column| part.iter().skip(column).step_by(width).copied().collect()));
        right_sides = behind;
    }
    columns
}

fn expand_symmetric<V: Value>(results: &[ResultPart], values: Vec<V>) -> Vec<V> {
    let [ResultPart { shape: Shape::Symmetric(n), .. }] = results else { return values };
    let entry = |i: usize, j: usize| values[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    (0..*n).flat_map(|i| (0..*n).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect()
}

struct Run<'a, V> {
    state: &'a State<V>,
    multipliers: &'a [V],
    parameters: &'a [V],
    hoisted: &'a [V],
    trigonometry: Trigonometry,
}

impl<V: Value> Run<'_, V> {
    fn results(&self, program: &Program) -> Vec<V> {
        let values = self.steps(program);
        program.results.iter().map(|value| values[value.index()]).collect()
    }

    /// All values; what stands on one side of a branch only is computed where that side is taken, and else is zero.
    fn steps(&self, program: &Program) -> Vec<V> {
        let is_choice = |instruction: &Instruction| matches!(instruction, Instruction::Select(..));
        let is_straight = program.regions.are_certain() && !program.instructions.iter().any(is_choice);
        if V::TAKES_BOTH_SIDES || is_straight {
            let mut values = Vec::with_capacity(program.instructions.len());
            for &instruction in &program.instructions {
                values.push(self.step(program, instruction, &values));
            }
            return values;
        }
        let mut taken = Taken::none(program);
        let mut waiting = Vec::new();
        for (i, &instruction) in program.instructions.iter().enumerate() {
            let value = Step(i as u32);
            if !program.regions.is_certain(value) {
                continue;
            }
            // In a program that was altered, what is certain may need what was not.
            if is_choice(&instruction) || instruction.operands().any(|operand| taken.lacks(operand)) {
                waiting.push(value);
                self.compute(program, &mut waiting, &mut taken);
            } else {
                taken.put(value, self.step(program, instruction, &taken.values));
            }
        }
        waiting.extend(program.results.iter().filter(|result| taken.lacks(**result)));
        self.compute(program, &mut waiting, &mut taken);
        taken.values
    }

    /// Computes the values that are waited for, after what they need; of a choice that is the side taken.
    fn compute(&self, program: &Program, waiting: &mut Vec<Step>, taken: &mut Taken<V>) {
        while let Some(&value) = waiting.last() {
            let (instruction, before) = (program.instructions[value.index()], waiting.len());
            let missing = |operand: &Step| taken.lacks(*operand);
            match instruction {
                _ if !missing(&value) => {}
                Instruction::Select(c, _, _) if missing(&c) => waiting.push(c),
                Instruction::Select(c, a, b) => {
                    let side = if holds(taken.values[c.index()]) { a } else { b };
                    waiting.extend(Some(side).filter(missing));
                }
                _ => waiting.extend(instruction.operands().filter(missing)),
            }
            if waiting.len() == before {
                if missing(&value) {
                    taken.put(value, self.step(program, instruction, &taken.values));
                }
                waiting.pop();
            }
        }
    }

    /// One instruction, what it needs being known.
    fn step(&self, program: &Program, instruction: Instruction, values: &[V]) -> V {
        let v = |operand: Step| values[operand.index()];
        match instruction {
            Instruction::Constant(number) => V::number(number),
            Instruction::Symbol(symbol) => self.symbol(symbol),
            Instruction::Hoisted(k) => self.hoisted[k as usize],
            Instruction::Neg(a) => v(a).neg(),
            Instruction::Add(a, b) => v(a).add(v(b)),
            Instruction::Sub(a, b) => v(a).sub(v(b)),
            Instruction::Mul(a, b) => v(a).mul(v(b)),
            Instruction::Div(a, b) => v(a).div(v(b)),
            Instruction::Sqrt(a) => v(a).power(1),
            Instruction::Call(function, a) => match self.trigonometry {
                Trigonometry::Polynomials => v(a).call(function),
                Trigonometry::Library => v(a).call_library(function),
            },
            Instruction::Call2(function, a, b) => v(a).call2(function, v(b)),
            Instruction::Spline(d, a) => v(a).spline(&program.splines[d.spline as usize], d.order as usize),
            Instruction::Less(a, b) => v(a).condition(v(b), false),
            Instruction::LessEqual(a, b) => v(a).condition(v(b), true),
            Instruction::And(a, b) if V::TAKES_BOTH_SIDES => v(a).mul(v(b)),
            Instruction::Not(a) if V::TAKES_BOTH_SIDES => V::constant(1.0).sub(v(a)),
            Instruction::Select(c, a, b) if V::TAKES_BOTH_SIDES => v(c).select(v(a), v(b)),
            Instruction::And(a, b) => truth(holds(v(a)) && holds(v(b))),
            Instruction::Not(a) => truth(!holds(v(a))),
            Instruction::Select(c, a, b) => v(if holds(v(c)) { a } else { b }),
        }
    }

    fn symbol(&self, symbol: Symbol) -> V {
        match symbol {
            Symbol::Parameter(i) => self.parameters[i as usize],
            Symbol::Multiplier(i) => self.multipliers[i as usize],
            symbol => self.state.value_of(symbol).expect("the other symbols are of the state"),
        }
    }
}

/// The values that the sides taken need, so far.
struct Taken<V> {
    values: Vec<V>,
    is_known: Vec<bool>,
}

impl<V: Value> Taken<V> {
    fn none(program: &Program) -> Self {
        let count = program.instructions.len();
        Taken { values: vec![V::constant(0.0); count], is_known: vec![false; count] }
    }

    fn lacks(&self, value: Step) -> bool {
        !self.is_known[value.index()]
    }

    fn put(&mut self, value: Step, number: V) {
        (self.values[value.index()], self.is_known[value.index()]) = (number, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Binary, Expr, Function, Graph};
    use crate::optimise::lower::program;
    use crate::optimise::schedule::Hoisting;

    /// A double of which nothing undefined may be asked.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Defined(f64);

    impl Defined {
        fn new(value: f64) -> Self {
            assert!(value.is_finite(), "a side is computed that is not taken");
            Defined(value)
        }
    }

    impl Value for Defined {
        fn constant(value: f64) -> Self {
            Defined::new(value)
        }
        fn neg(self) -> Self {
            Defined::new(-self.0)
        }
        fn add(self, other: Self) -> Self {
            Defined::new(self.0 + other.0)
        }
        fn sub(self, other: Self) -> Self {
            Defined::new(self.0 - other.0)
        }
        fn mul(self, other: Self) -> Self {
            Defined::new(self.0 * other.0)
        }
        fn div(self, other: Self) -> Self {
            Defined::new(self.0 / other.0)
        }
        fn power(self, halves: i32) -> Self {
            Defined::new(self.0.power(halves))
        }
        fn call(self, function: Function) -> Self {
            Defined::new(function.value(self.0))
        }
        fn call2(self, function: Binary, other: Self) -> Self {
            Defined::new(function.value(self.0, other.0))
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
    }

    fn run<V: Value>(build: impl for<'g> Fn([Expr<'g>; 2], &'g Graph) -> Expr<'g>, x: V, y: V) -> V {
        let graph = Graph::new();
        let symbols = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        execute(&program(&[build(symbols, &graph)], &Hoisting::none()), x, y)
    }

    fn execute<V: Value>(program: &Program, x: V, y: V) -> V {
        let none = Vec::new;
        let state = State { t: x, q: vec![x, y], qd: none(), qdd: none(), u: none(), prescribed: Vec::new() };
        Run { state: &state, multipliers: &[], parameters: &[], hoisted: &[], trigonometry: Trigonometry::default() }
            .results(program)[0]
    }

    #[track_caller]
    fn check(build: impl for<'g> Fn([Expr<'g>; 2], &'g Graph) -> Expr<'g>, x: f64, y: f64, expected: f64) {
        assert_eq!(run(&build, x, y), expected);
        assert_eq!(run(&build, Defined(x), Defined(y)), Defined(expected));
    }

    #[test]
    fn a_side_is_computed_where_it_is_taken() {
        for (x, expected) in [(4.0, 2.0), (-4.0, 0.25), (0.0, 1.0)] {
            // √x, −1/x, 1: each is undefined where another one is taken.
            check(
                |[x, y], graph| {
                    let below = graph.select(x.less(y), -(1 / x), graph.integer(1));
                    graph.select(y.less(x), x.sqrt(), below)
                },
                x,
                0.0,
                expected,
            );
        }
    }

    #[test]
    fn what_several_sides_share_is_computed_where_one_of_them_is_taken() {
        for (x, expected) in [(4.0, 6.0), (-4.0, 7.0)] {
            check(
                |[x, y], graph| {
                    let condition = x.less(y);
                    let twice = graph.select(condition, graph.integer(3), x.sqrt());
                    twice + graph.select(condition.and(y.less(x).not()), graph.integer(4), x.sqrt() * 2)
                },
                x,
                0.0,
                expected,
            );
        }
    }

    #[test]
    fn comparisons_are_those_of_doubles() {
        let chosen = |condition: fn([Expr<'_>; 2]) -> crate::expr::Condition<'_>| {
            [(1.0, 2.0), (2.0, 2.0), (2.0, 1.0), (f64::NAN, 1.0)].map(|(x, y)| {
                run(|symbols, graph| graph.select(condition(symbols), graph.integer(1), graph.integer(0)), x, y)
            })
        };
        assert_eq!(chosen(|[x, y]| x.less(y)), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(chosen(|[x, y]| x.less_equal(y)), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!(chosen(|[x, y]| x.less(y).not()), [0.0, 1.0, 1.0, 1.0]);
        assert_eq!(chosen(|[x, y]| x.less_equal(y).and(y.less_equal(x))), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(chosen(|[x, y]| x.less(y).or(y.less(x))), [1.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn branches_within_branches_are_no_recursion() {
        // The last one whose knot is below x: √(x − knot).
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let deep = (0..20_000).fold(x, |f, i| graph.select(x.less(graph.integer(i)), f, (x - i).sqrt()));
        let program = program(&[deep], &Hoisting::none());
        for (x, expected) in [(-1.5, -1.5), (2.25, 0.5), (15_000.25, 0.5), (20_003.0, 2.0)] {
            assert_eq!(execute(&program, Defined(x), Defined(0.0)), Defined(expected));
        }
    }

    /// A four-bar linkage that is balanced, so that accelerations are what rounding has left of them. A coupler that
    /// leans out of the plane could not turn any more: that says nothing where it does not turn.
    #[test]
    fn a_linearization_at_rest_is_no_contradiction() {
        let text = include_str!("verify/closed_loop.mbs");
        let graph = Graph::verbatim();
        let lagrangian =
            crate::declared(text, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("loop.mbs", text))).0;
        let derivation = crate::derived(&lagrangian);
        let q = vec![
            -1.7811705169993333,
            2.469589117828098,
            -0.0417651709662768,
            -0.19559056852046233,
            0.0,
            1.0956488399068933,
            0.0,
            0.0,
        ];
        let state = State { qd: vec![0.0; q.len()], q, ..State::default() };
        let interpreter = Interpreter::new(&derivation);
        let accelerations = interpreter.call(FunctionKind::ForwardDynamics, &state).unwrap();
        assert!(accelerations.iter().all(|qdd| qdd.abs() < 1e-12), "{accelerations:?}");
        let slopes = interpreter.call(FunctionKind::Linearize, &state).unwrap();
        assert!(slopes.iter().all(|x| x.is_finite()), "{slopes:?}");
    }
}
