//! Which sides of branches have been taken where the proof was made, and states that take the others.

use crate::expr::branch::{Branches, Side};
use crate::expr::{Dual, Expr, Function, Id, Node, Rounded, Symbol, Tape};
use crate::interpret::State;
use crate::model::Lagrangian;
use crate::model::sample::default_parameters;
use crate::numeric::Random;
use crate::numeric::elimination::ROUNDING;

use super::witness::{exact, moving, output_components};

/// At this many states each side is to be taken.
const WANTED: usize = 2;

/// At most this many sets of sides that are taken together are proved exactly.
const MOST_TOGETHER: usize = 32;

/// A comparison is decided where its operands differ by more than this part of them,
const FAR: f64 = 1e-6;
/// and by more than this many times what rounding does to them.
const ORDERS: f64 = 1e3;

/// From this many random states, of several sizes, a side is sought, with this many steps each.
const STARTS: usize = 24;
const STEPS: usize = 60;

/// Everything declared, on one tape.
pub(super) struct Choices {
    tape: Tape,
    /// The number in the graph of each step.
    ids: Vec<Id>,
}

impl Choices {
    pub(super) fn of(lagrangian: &Lagrangian<'_>) -> Choices {
        let energies = [&lagrangian.kinetic, &lagrangian.potential, &lagrangian.dissipation, &lagrangian.lagrangian];
        let forces = lagrangian.forces.iter().map(|(_, force)| force);
        let at_points = lagrangian.point_forces.iter().flat_map(|f| f.velocity.0.iter().chain(&f.force.0));
        let rows = lagrangian.constraints.iter().flat_map(|constraint| &constraint.rows);
        let outputs = lagrangian.outputs.iter().flat_map(|output| output_components(lagrangian, &output.value));
        let declared = energies.into_iter().flatten().chain(forces).chain(at_points).chain(rows).copied();
        let roots: Vec<Expr<'_>> = declared.chain(outputs).collect();
        Choices { tape: Tape::new(&roots), ids: lagrangian.graph.reachable(roots.iter().map(|root| root.id())) }
    }
}

/// How often each side has been taken.
pub(super) struct Coverage<'c, 'l, 'g> {
    choices: &'c Choices,
    branches: Branches<'c>,
    lagrangian: &'l Lagrangian<'g>,
    taken: Vec<usize>,
    /// Which sides have been met where something declared has no derivative.
    met: Vec<bool>,
    /// A state for each set of sides that are taken together, not on the edge of one.
    inside: Vec<(State, Vec<f64>)>,
    /// These sets.
    together: Vec<Vec<bool>>,
}

impl<'c, 'l, 'g> Coverage<'c, 'l, 'g> {
    pub(super) fn new(choices: &'c Choices, lagrangian: &'l Lagrangian<'g>) -> Self {
        let branches = Branches::of(&choices.tape);
        let taken = vec![0; branches.sides().len()];
        let met = vec![false; taken.len()];
        Coverage { choices, branches, lagrangian, taken, met, inside: Vec::new(), together: Vec::new() }
    }

    /// Counts what is taken at a state where the proof was made.
    pub(super) fn note(&mut self, state: &State, parameters: &[f64]) {
        if !self.taken.is_empty() {
            let values = self.values(state, parameters, None);
            let taken = self.branches.taken(&values);
            taken.iter().zip(&mut self.taken).for_each(|(is, count)| *count += usize::from(*is));
            let is_new = self.together.len() < MOST_TOGETHER && !self.together.contains(&taken);
            if is_new && self.is_inside(state, parameters) {
                self.together.push(taken);
                self.inside.push((state.clone(), parameters.to_vec()));
            }
        }
    }

    /// States, with parameters, one for each set of sides that are taken together; nothing where a side has been taken
    /// at its edge alone.
    pub(super) fn inside(&self) -> &[(State, Vec<f64>)] {
        let is_inside = |side: usize| self.together.iter().any(|taken| taken[side]);
        let are_inside = (0..self.taken.len()).all(|side| self.taken[side] == 0 || is_inside(side));
        if are_inside { &self.inside } else { &[] }
    }

    /// Whether every comparison and every corner is so far away that no rounding reaches it, in whatever order the same
    /// is computed.
    fn is_inside(&self, state: &State, parameters: &[f64]) -> bool {
        self.distances(state, parameters).all(|Distance { away, size, error }| away > FAR * size + ORDERS * error)
    }

    /// Whether rounding decides which side of a choice is taken: then equations that were computed in another order may
    /// be those of the other side.
    pub(super) fn is_undecided(&self, state: &State, parameters: &[f64]) -> bool {
        let is_reached = |Distance { away, error, .. }: Distance| away != 0.0 && away <= ROUNDING * error;
        !self.taken.is_empty() && self.distances(state, parameters).any(is_reached)
    }

    /// How far the comparisons and corners are.
    fn distances(&self, state: &State, parameters: &[f64]) -> impl Iterator<Item = Distance> {
        let (state, parameters) = (exact(state), parameters.iter().copied().map(Rounded::exact).collect::<Vec<_>>());
        let values = self.choices.tape.all(moving(&state, &parameters));
        self.choices.tape.steps().iter().filter_map(move |step| {
            let value = |at: Id| values[at.index()].value;
            match *step {
                Node::Less(a, b) | Node::LessEqual(a, b) if a != b => {
                    let (a, b) = (value(a), value(b));
                    let size = a.value.abs().max(b.value.abs());
                    Some(Distance { away: (a.value - b.value).abs(), size, error: a.error + b.error })
                }
                Node::Call(Function::Abs | Function::Signum, a) => {
                    Some(Distance { away: value(a).value.abs(), size: 0.0, error: value(a).error })
                }
                _ => None,
            }
        })
    }

    /// Takes down what is taken at a state where nothing can be proved.
    pub(super) fn meet(&mut self, state: &State, parameters: &[f64]) {
        if !self.taken.is_empty() {
            let values = self.values(state, parameters, None);
            self.branches.taken(&values).into_iter().zip(&mut self.met).for_each(|(is, met)| *met |= is);
        }
    }

    /// The numbers of the sides that have been taken too seldom.
    pub(super) fn wanted(&self) -> Vec<usize> {
        (0..self.taken.len()).filter(|&side| !self.is_covered(side)).collect()
    }

    /// Whether a side has been taken often enough.
    pub(super) fn is_covered(&self, side: usize) -> bool {
        self.taken[side] >= WANTED
    }

    /// The choices one of whose sides has been taken nowhere: its number in the graph, and which side; and those one of
    /// whose sides has been taken at such states alone at which nothing can be proved.
    pub(super) fn missing(&self) -> [Vec<(Id, bool)>; 2] {
        [false, true].map(|met| {
            let sides = self.branches.sides().iter().enumerate();
            let never =
                sides.filter(|(at, side)| self.taken[*at] == 0 && (self.met[*at] && !self.is_corner(side)) == met);
            let mut missing: Vec<(Id, bool)> =
                never.map(|(_, side)| (self.choices.ids[side.choice], side.yes)).collect();
            missing.sort_unstable();
            missing.dedup();
            missing
        })
    }

    /// Of `abs` and `signum`, which at the corner itself are on neither side.
    fn is_corner(&self, side: &Side) -> bool {
        matches!(self.choices.tape.steps()[side.choice], Node::Call(..))
    }

    /// States, with parameters, at which a side is taken: found by steps along the gradients of the differences that
    /// its conditions compare, at the defaults of the parameters unless a condition is about them alone.
    pub(super) fn states_on(&self, side: usize) -> impl Iterator<Item = (State, Vec<f64>)> + '_ {
        let side: Side = self.branches.sides()[side];
        let mut random = Random::new(0x7369_6465 + side.choice as u64);
        let starts = (0..STARTS).map(move |start| {
            let size = [1.0, 10.0, 0.1, 1e3, 1e6, 1e-3][start / 2 % 6];
            (scaled(random.state(self.lagrangian), size), start % 2 == 1, random.clone())
        });
        let starts: Vec<_> = starts.collect();
        starts.into_iter().filter_map(move |(state, by_the_second, random)| {
            self.reach(&self.branches.way(side, by_the_second), state, random)
        })
    }

    /// States, with parameters, at which what comparisons compare is equal, where `<` and `<=` differ: of symbols,
    /// their absolute values and constants, which no rounding keeps apart.
    pub(super) fn states_on_edges(&self) -> Vec<(State, Vec<f64>)> {
        let mut seen = Vec::new();
        let mut states = Vec::new();
        for (number, &side) in self.branches.sides().iter().enumerate() {
            for (at, _) in self.branches.way(side, false).into_iter().chain(self.branches.way(side, true)) {
                let (Node::Less(a, b) | Node::LessEqual(a, b)) = self.choices.tape.steps()[at] else { continue };
                let (Some(a), Some(b)) = (self.exact(a.index()), self.exact(b.index())) else { continue };
                if seen.contains(&at) {
                    continue;
                }
                seen.push(at);
                let on_this_side = self.states_on(number).next();
                states.extend(on_this_side.into_iter().filter_map(|state| on_the_edge(a, b, state)));
            }
        }
        states
    }

    /// A step that is a symbol that may be moved, its absolute value or a constant, with a sign.
    fn exact(&self, mut at: usize) -> Option<Exact> {
        let steps = self.choices.tape.steps();
        let exact = |symbol, constant| Some(Exact { symbol, constant, is_size: false, negative: false });
        let (mut is_size, mut negative) = (false, false);
        loop {
            let found = match steps[at] {
                Node::Neg(a) => {
                    negative ^= !is_size;
                    at = a.index();
                    continue;
                }
                Node::Call(Function::Abs, a) => {
                    is_size = true;
                    at = a.index();
                    continue;
                }
                Node::Rate(a) => match steps[a.index()] {
                    Node::Symbol(Symbol::Coordinate(i)) => exact(Some(Symbol::Velocity(i)), 0.0),
                    _ => None,
                },
                Node::Symbol(Symbol::Parameter(_) | Symbol::Multiplier(_)) => None,
                Node::Symbol(symbol) => exact(Some(symbol), 0.0),
                Node::Constant(number) => exact(None, number.to_f64()),
                _ => None,
            };
            return found.map(|found| Exact { is_size, negative, ..found });
        }
    }

    fn reach(&self, way: &[(usize, bool)], state: State, mut random: Random) -> Option<(State, Vec<f64>)> {
        let (mut state, mut parameters) = (state, default_parameters(self.lagrangian));
        for _ in 0..STEPS {
            let margins: Vec<f64> = {
                let values = self.values(&state, &parameters, None);
                way.iter().map(|&comparison| self.margin(comparison, |at| values[at].value.value)).collect()
            };
            let Some(at) = (0..way.len()).rev().find(|&at| margins[at] <= 0.0 || margins[at].is_nan()) else {
                return Some((state, parameters));
            };
            let gradient = self.gradient(way[at], &state, &parameters);
            let square: f64 = gradient.iter().map(|(_, slope)| slope * slope).sum();
            // Beyond the border, by a part of the way to it.
            let beyond = (0.1 + random.symmetric().abs()) * margins[at].abs() + 1e-6 * random.symmetric().abs();
            let step = (beyond - margins[at]) / square;
            if !step.is_finite() {
                return None;
            }
            gradient
                .into_iter()
                .for_each(|(symbol, slope)| *place(symbol, &mut state, &mut parameters) += step * slope);
        }
        None
    }

    /// What must be positive so that a comparison comes out as wanted.
    fn margin(&self, (at, holds): (usize, bool), value: impl Fn(usize) -> f64) -> f64 {
        let difference = match self.choices.tape.steps()[at] {
            Node::Less(a, b) | Node::LessEqual(a, b) => value(b.index()) - value(a.index()),
            step => step.operands().map(|argument| value(argument.index())).sum(),
        };
        if holds { difference } else { -difference }
    }

    /// Its slopes in what it depends on; in the parameters where it depends on nothing else.
    fn gradient(&self, comparison: (usize, bool), state: &State, parameters: &[f64]) -> Vec<(Symbol, f64)> {
        let slope = |symbol: Symbol| {
            let values = self.values(state, parameters, Some(symbol));
            self.margin(comparison, |at| values[at].value.derivative)
        };
        let (fixed, free): (Vec<Symbol>, Vec<Symbol>) =
            self.symbols(comparison.0).into_iter().partition(|symbol| matches!(symbol, Symbol::Parameter(_)));
        let moved = if free.is_empty() { fixed } else { free };
        moved.into_iter().map(|symbol| (symbol, slope(symbol))).collect()
    }

    /// What a comparison depends on, rates of coordinates and signals included.
    fn symbols(&self, comparison: usize) -> Vec<Symbol> {
        let steps = self.choices.tape.steps();
        let mut wanted = vec![false; comparison + 1];
        wanted[comparison] = true;
        let mut symbols = Vec::new();
        for at in (0..=comparison).rev() {
            if !wanted[at] {
                continue;
            }
            steps[at].operands().for_each(|operand| wanted[operand.index()] = true);
            match steps[at] {
                Node::Symbol(symbol @ Symbol::Coordinate(i)) => symbols.extend([symbol, Symbol::Velocity(i)]),
                Node::Symbol(symbol @ Symbol::Prescribed(i, order @ 0..=1)) => {
                    symbols.extend([symbol, Symbol::Prescribed(i, order + 1)]);
                }
                Node::Symbol(symbol) => symbols.push(symbol),
                _ => {}
            }
        }
        symbols.sort_unstable();
        symbols.dedup();
        symbols
    }

    /// The values of all steps with their rates, and the slopes of both along a symbol.
    fn values(&self, state: &State, parameters: &[f64], along: Option<Symbol>) -> Vec<Dual<Dual<f64>>> {
        let at = |symbol: Symbol| {
            let value = match symbol {
                Symbol::Time => state.t,
                Symbol::Coordinate(i) => state.q[i as usize],
                Symbol::Velocity(i) => state.qd[i as usize],
                Symbol::Acceleration(i) => state.qdd[i as usize],
                Symbol::Parameter(i) => parameters[i as usize],
                Symbol::Input(i) => state.u[i as usize],
                Symbol::Prescribed(i, order) => {
                    state.prescribed[i as usize].get(usize::from(order)).copied().unwrap_or(0.0)
                }
                Symbol::Multiplier(_) => f64::NAN,
            };
            Dual::new(value, f64::from(u8::from(along == Some(symbol))))
        };
        self.choices.tape.all(|symbol| match symbol {
            Symbol::Time => Dual::new(at(symbol), Dual::fixed(1.0)),
            Symbol::Coordinate(i) => Dual::new(at(symbol), at(Symbol::Velocity(i))),
            Symbol::Velocity(i) => Dual::new(at(symbol), at(Symbol::Acceleration(i))),
            Symbol::Prescribed(i, order) => Dual::new(at(symbol), at(Symbol::Prescribed(i, order + 1))),
            other => Dual::fixed(at(other)),
        })
    }
}

/// Of what is compared how far it is apart, how large it is, and how far rounding may have carried it.
struct Distance {
    away: f64,
    size: f64,
    error: f64,
}

/// What is compared: `±x`, `±|x|`, with a symbol or a constant for x.
#[derive(Clone, Copy, Debug)]
struct Exact {
    symbol: Option<Symbol>,
    constant: f64,
    is_size: bool,
    negative: bool,
}

impl Exact {
    fn value(self, state: &mut State) -> f64 {
        let x = self.symbol.map_or(self.constant, |symbol| *place(symbol, state, &mut []));
        let x = if self.is_size { x.abs() } else { x };
        if self.negative { -x } else { x }
    }
}

/// The state with the one or the other moved until both are equal; `None` where neither can be.
fn on_the_edge(a: Exact, b: Exact, (mut state, parameters): (State, Vec<f64>)) -> Option<(State, Vec<f64>)> {
    let (moved, other) = if a.symbol.is_some() { (a, b) } else { (b, a) };
    let wanted = other.value(&mut state);
    let wanted = if moved.negative { -wanted } else { wanted };
    let x = place(moved.symbol?, &mut state, &mut []);
    *x = if moved.is_size { wanted.copysign(*x) } else { wanted };
    (a.value(&mut state) == b.value(&mut state)).then_some((state, parameters))
}

fn scaled(state: State, size: f64) -> State {
    let all = |values: Vec<f64>| values.into_iter().map(|value| size * value).collect();
    State {
        t: size * state.t,
        q: all(state.q),
        qd: all(state.qd),
        u: all(state.u),
        prescribed: state.prescribed.into_iter().map(|signal| signal.map(|value| size * value)).collect(),
        qdd: state.qdd,
    }
}

fn place<'s>(symbol: Symbol, state: &'s mut State, parameters: &'s mut [f64]) -> &'s mut f64 {
    match symbol {
        Symbol::Time => &mut state.t,
        Symbol::Coordinate(i) => &mut state.q[i as usize],
        Symbol::Velocity(i) => &mut state.qd[i as usize],
        Symbol::Acceleration(i) => &mut state.qdd[i as usize],
        Symbol::Parameter(i) => &mut parameters[i as usize],
        Symbol::Input(i) => &mut state.u[i as usize],
        Symbol::Prescribed(i, order) => &mut state.prescribed[i as usize][usize::from(order)],
        Symbol::Multiplier(_) => unreachable!("multipliers are not declared"),
    }
}
