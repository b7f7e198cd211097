//! Warnings about derivatives that are undefined where the mechanism may get to: `norm()` of coincident points, kinks,
//! `atan2(0, 0)`, 0/0.
//!
//! While expressions are built, every call and operator whose derivative fails at some argument is noted with its
//! place. The finished energies, constraints, outputs and forces, simplified as `derive` will simplify them
//! (`sqrt(x)^2` is x), are then evaluated at special states: each coordinate zero, each angle π or π/2, at rest, all
//! zero, all equal. Where an argument is one at which its derivative fails, while the value stays bounded around, there
//! is a warning at the noted place. Gravity `-k/r` grows without bound towards r = 0: no mechanism gets there, and
//! there is no warning.

mod corner;

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Code;
use crate::expr::evaluate::holds;
use crate::expr::{Binary, Expr, Function, Graph, HalfInteger, Id, Node, Rounded, Symbol, Tape, Value as _, carry_out};
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::{Choice, ConstraintKind, Draft, OutputValue};
use crate::model::value::Value;
use crate::model::value::evaluate::Resolver;
use crate::numeric::Random;
use crate::parse::syntax::Span;
use crate::state::State;
use crate::variable::{component_names, count};

/// A call or operator whose derivative fails at some argument.
#[derive(Clone, Debug)]
pub(in crate::model) struct Site<'g> {
    /// As declared: a power, `abs`, `asin`, `acos` or `atan2`.
    expr: Expr<'g>,
    /// The text to be underlined.
    span: Span,
    /// The calls of functions that it stands in, the innermost first.
    calls: Vec<(Span, String)>,
}

/// By the expression that they stand for.
pub(in crate::model) type Sites<'g> = BTreeMap<Id, Site<'g>>;

/// At most this many coordinates are set to zero one by one.
const SINGLE_ZEROS: usize = 16;

// ---- what is noted while expressions are built

impl<'d, 'g> Resolver<'d, 'g> {
    /// Notes the place of a value whose derivative may fail.
    ///
    /// Of a root of a square the user has written no choice: that a side of it is never taken is nothing to be warned
    /// of.
    pub(in crate::model) fn watch(&mut self, value: &Value<'g>, span: &Span, is_root: bool) {
        let exprs = match value {
            Value::Scalar(scalar) => vec![scalar.expr],
            Value::Vector(vector) => vector.components.0.to_vec(),
            _ => return,
        };
        for expr in exprs.iter().filter(|expr| !is_root && is_choice(expr.node())) {
            let choice = Choice { place: self.report.place(span).0, is_condition: false };
            self.lagrangian.choices.entry(expr.id()).or_insert(choice);
        }
        for expr in exprs.into_iter().filter_map(critical) {
            let argument = expr.node().operands().map(|id| self.graph.expr(id));
            let moves = argument.map(|a| self.known.facts.dependence(a).moves()).fold(false, |a, b| a | b);
            if moves && !self.known.sites.contains_key(&expr.id()) {
                let (span, calls) = self.report.place(span);
                self.known.sites.insert(expr.id(), Site { expr, span, calls });
            }
        }
    }
}

/// An `if`, or a function with a corner.
fn is_choice(node: Node) -> bool {
    matches!(node, Node::Select(..) | Node::Call(Function::Abs | Function::Signum, _))
}

/// The part of an expression just built whose derivative may fail.
fn critical(expr: Expr<'_>) -> Option<Expr<'_>> {
    let reciprocal = |id: &Id| matches!(expr.graph().node(*id), Node::Power(_, n) if n.to_halves() < 0);
    match expr.node() {
        Node::Mul(a, b) => [a, b].iter().find(|id| reciprocal(id)).map(|id| expr.graph().expr(*id)),
        node => is_critical(node).then_some(expr),
    }
}

fn is_critical(node: Node) -> bool {
    match node {
        Node::Power(_, n) => n.to_halves() <= Wanted::Second.critical_halves(),
        Node::Call(function, _) => matches!(function, Function::Asin | Function::Acos | Function::Abs),
        Node::Call2(..) => true,
        _ => false,
    }
}

// ---- what is looked for

/// Expressions that are wanted with their derivatives, and what it means where these fail.
struct Group {
    roots: Vec<Id>,
    wanted: Wanted,
    means: &'static str,
}

/// Up to which derivatives.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// Of energies for the equations of motion, of constraints and outputs for their rates.
    First,
    /// Of forces for the linearization, which kinks do no harm.
    FirstBesideKinks,
    /// Of energies for the linearization.
    Second,
}

impl Wanted {
    /// `x^(halves/2)` has no such derivative at 0 where the exponent is no greater.
    fn critical_halves(self) -> i32 {
        match self {
            Wanted::First | Wanted::FirstBesideKinks => 1,
            Wanted::Second => 3,
        }
    }
}

const EQUATIONS: &str = "the equations of motion are NaN or infinite there";
const CONSTRAINT: &str = "the constraint's Jacobian is NaN or infinite there";
const LINEARIZATION: &str = "the motion goes on, its linearization is NaN or infinite there";
const OUTPUT: &str = "the output's velocity and Jacobian are NaN or infinite there";

/// The declared expressions as `derive` sees them, ready to be evaluated.
struct Search<'l, 'g, 's> {
    lagrangian: &'l Draft<'g>,
    graph: &'s Graph,
    /// The energies first.
    groups: Vec<Group>,
    /// The holonomic rows.
    rows: Vec<Id>,
    /// All nodes of the groups, operands first; their positions; whether each changes along a motion.
    nodes: Vec<Id>,
    positions: BTreeMap<Id, usize>,
    moves: Vec<bool>,
    tape: Tape,
    parameters: Vec<f64>,
}

/// A node whose derivative fails at a state.
struct Fault {
    /// The number of the group that it is part of.
    group: usize,
    node: Id,
    /// What must not have this value there.
    arguments: Vec<Id>,
}

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn warn_of_singular_derivatives(&mut self) {
        if self.known.sites.is_empty() {
            return;
        }
        let sites: Vec<Site<'g>> = std::mem::take(&mut self.known.sites).into_values().collect();
        let graph = Graph::new();
        let (search, copies) = Search::new(&self.lagrangian, &sites, &graph);
        if !search.nodes.iter().any(|id| is_critical(graph.node(*id))) {
            return;
        }
        let mut found: BTreeMap<(usize, usize), (usize, String)> = BTreeMap::new();
        for special in search.special_states() {
            let values = search.values(&special.state);
            for fault in search.faults(&special, &values) {
                let Some(site) = search.site(&fault, &copies) else { continue };
                let place = (sites[site].span.start, sites[site].span.end);
                if !found.contains_key(&place) && search.is_reachable(&fault, &special, &values) {
                    found.insert(place, (site, search.message(&fault, &special)));
                }
            }
        }
        for (site, message) in found.into_values() {
            let Site { expr, span, calls } = &sites[site];
            let warning = self.report.errors.warning(Code::NoDerivative, span.clone(), message).help(help(expr.node()));
            for (call, what) in calls {
                warning.note(call.clone(), what);
            }
        }
    }
}

impl<'l, 'g, 's> Search<'l, 'g, 's> {
    /// The search, and the copies of the sites.
    fn new(lagrangian: &'l Draft<'g>, sites: &[Site<'g>], graph: &'s Graph) -> (Self, Vec<Expr<'s>>) {
        let energies = [&lagrangian.kinetic, &lagrangian.potential, &lagrangian.dissipation, &lagrangian.lagrangian];
        let energies: Vec<Expr<'g>> = energies.into_iter().flatten().copied().collect();
        let at_points = lagrangian.point_forces.iter().flat_map(|f| f.force.0.iter().chain(&f.velocity.0));
        let forces: Vec<Expr<'g>> =
            lagrangian.forces.iter().map(|(_, force)| force).chain(at_points).copied().collect();
        let mut declared = vec![(EQUATIONS, Wanted::First, energies.clone())];
        declared.extend(lagrangian.constraints.iter().map(|c| (CONSTRAINT, Wanted::First, c.rows.clone())));
        let outputs = lagrangian.outputs.iter().map(|o| components(lagrangian, &o.value));
        declared.extend(outputs.map(|components| (OUTPUT, Wanted::First, components)));
        declared.push((LINEARIZATION, Wanted::FirstBesideKinks, forces));
        declared.push((LINEARIZATION, Wanted::Second, energies));
        let noted = sites.iter().map(|site| site.expr);
        let all: Vec<Expr<'g>> = declared.iter().flat_map(|(.., exprs)| exprs.clone()).chain(noted).collect();
        let mut copies = carry_out(&all, graph, |symbol| along_the_motion(graph, symbol));
        let of_sites = copies.split_off(copies.len() - sites.len());

        let mut ids = copies.iter().map(|copy| copy.id());
        let groups: Vec<Group> = declared
            .iter()
            .map(|(means, wanted, exprs)| Group {
                roots: ids.by_ref().take(exprs.len()).collect(),
                wanted: *wanted,
                means,
            })
            .collect();
        let kinds = lagrangian.constraints.iter().map(|c| c.kind);
        let holonomic = groups[1..].iter().zip(kinds).filter(|(_, kind)| *kind == ConstraintKind::Holonomic);
        let rows = holonomic.flat_map(|(group, _)| group.roots.clone()).collect();
        let nodes = graph.reachable(copies.iter().map(|copy| copy.id()));
        let positions: BTreeMap<Id, usize> = nodes.iter().enumerate().map(|(at, &id)| (id, at)).collect();
        let mut moves: Vec<bool> = Vec::new();
        for &id in &nodes {
            let own = matches!(graph.node(id), Node::Symbol(symbol) if changes(symbol));
            moves.push(own || graph.node(id).operands().any(|operand| moves[positions[&operand]]));
        }
        let tape = Tape::new(&nodes.iter().map(|&id| graph.expr(id)).collect::<Vec<_>>());
        let parameters = default_parameters(lagrangian);
        (Search { lagrangian, graph, groups, rows, nodes, positions, moves, tape, parameters }, of_sites)
    }
}

fn components<'g>(lagrangian: &Draft<'g>, value: &OutputValue<'g>) -> Vec<Expr<'g>> {
    let places = value.frames().iter().flat_map(|frame| lagrangian.frames.get(*frame).position.0);
    value.numbers().into_iter().chain(places).collect()
}

/// `dt` of each symbol.
pub(in crate::model) fn along_the_motion(graph: &Graph, symbol: Symbol) -> Option<Expr<'_>> {
    match symbol {
        Symbol::Time => Some(graph.integer(1)),
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Prescribed(i, order) => Some(graph.symbol(Symbol::Prescribed(i, order + 1))),
        _ => None,
    }
}

fn changes(symbol: Symbol) -> bool {
    match symbol {
        Symbol::Time | Symbol::Coordinate(_) | Symbol::Velocity(_) | Symbol::Prescribed(..) => true,
        Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Multiplier(_) => false,
    }
}

// ---- states

/// A state, and what is special about its symbols.
struct Special {
    state: State,
    /// Values that are not random, as messages show them.
    shown: BTreeMap<Symbol, &'static str>,
}

impl Search<'_, '_, '_> {
    /// What is special about few symbols comes before what is special about many.
    fn special_states(&self) -> Vec<Special> {
        use std::f64::consts::{FRAC_PI_2, PI};
        let n = self.lagrangian.dof();
        let coordinates = || (0..n as u32).map(Symbol::Coordinate);
        let velocities = || (0..n as u32).map(Symbol::Velocity);
        let signals = || (0..count(&self.lagrangian.prescribed) as u32).map(|i| Symbol::Prescribed(i, 0));
        let angles = self.lagrangian.coordinates.iter().filter(|c| c.unit == "rad");
        let angles: Vec<u32> = angles.flat_map(|c| c.first as u32..(c.first + c.count()) as u32).collect();
        let mut sets: Vec<Vec<(Symbol, f64, &'static str)>> = Vec::new();
        let zero = |symbol| (symbol, 0.0, "0");
        sets.extend(coordinates().take(SINGLE_ZEROS).map(|q| vec![zero(q)]));
        sets.extend(velocities().take(SINGLE_ZEROS).map(|qd| vec![zero(qd)]));
        sets.extend(angles.iter().take(SINGLE_ZEROS).map(|&i| vec![(Symbol::Coordinate(i), PI, "π")]));
        sets.extend(angles.iter().take(SINGLE_ZEROS).map(|&i| vec![(Symbol::Coordinate(i), FRAC_PI_2, "π/2")]));
        sets.push(vec![zero(Symbol::Time)]);
        sets.push(coordinates().map(|q| (q, 0.75, "equal")).collect());
        sets.push(coordinates().map(zero).collect());
        sets.push(velocities().map(zero).collect());
        sets.push(coordinates().chain(velocities()).map(zero).collect());
        sets.push(signals().chain(coordinates()).chain(velocities()).chain([Symbol::Time]).map(zero).collect());
        let mut random = Random::new(0x7369_6e67);
        sets.iter().map(|set| self.special(set, &mut random)).collect()
    }

    fn special(&self, set: &[(Symbol, f64, &'static str)], random: &mut Random) -> Special {
        let mut state = random.state(self.lagrangian);
        for &(symbol, value, _) in set {
            match symbol {
                Symbol::Time => state.t = value,
                Symbol::Coordinate(i) => state.q[i as usize] = value,
                Symbol::Velocity(i) => state.qd[i as usize] = value,
                Symbol::Prescribed(i, _) => state.prescribed[i as usize] = [value; 3],
                _ => {}
            }
        }
        Special { state, shown: set.iter().map(|&(symbol, _, text)| (symbol, text)).collect() }
    }

    fn value(&self, state: &State, symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Time => state.t,
            Symbol::Coordinate(i) => state.q[i as usize],
            Symbol::Velocity(i) => state.qd[i as usize],
            Symbol::Parameter(i) => self.parameters[i as usize],
            Symbol::Input(i) => state.u[i as usize],
            Symbol::Prescribed(i, order @ 0..=2) => state.prescribed[i as usize][usize::from(order)],
            Symbol::Prescribed(..) | Symbol::Acceleration(_) | Symbol::Multiplier(_) => 0.0,
        }
    }
}

// ---- faults

impl Search<'_, '_, '_> {
    fn values(&self, state: &State) -> Vec<Rounded> {
        self.tape.run(|symbol| Rounded::constant(self.value(state, symbol)))
    }

    fn faults(&self, special: &Special, values: &[Rounded]) -> Vec<Fault> {
        (0..self.groups.len()).flat_map(|group| self.faults_of(group, values, &special.state)).collect()
    }

    /// Of the branches that are taken there.
    fn faults_of(&self, group: usize, values: &[Rounded], state: &State) -> Vec<Fault> {
        let mut found = Vec::new();
        let mut stack = self.groups[group].roots.clone();
        let mut seen = BTreeSet::new();
        while let Some(id) = stack.pop() {
            if !self.moves[self.positions[&id]] || !seen.insert(id) {
                continue;
            }
            let node = self.graph.node(id);
            found.extend(self.fault(group, id, node, values));
            match node {
                Node::Select(c, a, b) => stack.push(if holds(values[self.positions[&c]]) { a } else { b }),
                Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => {}
                node => stack.extend(node.operands()),
            }
        }
        let fails = |fault: &Fault| match self.groups[group].wanted {
            Wanted::Second => self.has_gap(fault, state),
            Wanted::First | Wanted::FirstBesideKinks => self.has_kink(fault, state),
        };
        found.retain(|fault| !self.is_abs(fault) || fails(fault));
        found
    }

    fn fault(&self, group: usize, id: Id, node: Node, values: &[Rounded]) -> Option<Fault> {
        let value = |id: Id| values[self.positions[&id]];
        let wanted = self.groups[group].wanted;
        let fails = match node {
            Node::Power(a, n) => n.to_halves() <= wanted.critical_halves() && is_zero(value(a)),
            Node::Call(Function::Abs, a) => wanted != Wanted::FirstBesideKinks && is_zero(value(a)),
            Node::Call(Function::Asin | Function::Acos, a) => {
                let distance = Rounded { value: value(a).value.abs() - 1.0, error: value(a).error + f64::EPSILON };
                is_zero(distance)
            }
            Node::Call2(Binary::Atan2, a, b) => is_zero(value(a)) && is_zero(value(b)),
            Node::Call2(Binary::Powf, a, b) => {
                is_zero(value(a)) && 2.0 * value(b).value < f64::from(wanted.critical_halves() + 1)
            }
            _ => false,
        };
        let arguments = || node.operands().filter(|a| self.moves[self.positions[a]]).collect::<Vec<_>>();
        Some(Fault { group, node: id, arguments: arguments() }).filter(|fault| fails && !fault.arguments.is_empty())
    }

    fn is_abs(&self, fault: &Fault) -> bool {
        matches!(self.graph.node(fault.node), Node::Call(Function::Abs, _))
    }

    fn symbols(&self, of: &[Id]) -> BTreeSet<Symbol> {
        let nodes = self.graph.reachable(of.iter().copied()).into_iter().map(|id| self.graph.node(id));
        nodes.filter_map(|node| if let Node::Symbol(s) = node { changes(s).then_some(s) } else { None }).collect()
    }

    fn tape_of(&self, group: usize) -> Tape {
        let roots = self.groups[group].roots.iter().map(|&id| self.graph.expr(id));
        Tape::new(&roots.collect::<Vec<_>>())
    }

    /// Whether the mechanism may get there: the constraints hold, and neither the energies nor the values that are
    /// wanted are infinite, or grow without bound as what matters comes near.
    fn is_reachable(&self, fault: &Fault, special: &Special, values: &[Rounded]) -> bool {
        let value = |id: &Id| values[self.positions[id]].value;
        let is_infinite = |group: usize| self.groups[group].roots.iter().any(|root| value(root).is_infinite());
        let groups = BTreeSet::from([0, fault.group]);
        let violated = self.rows.iter().any(|row| value(row).abs() > 1e-9);
        !violated
            && !groups.iter().any(|&g| is_infinite(g))
            && groups.iter().all(|&g| self.is_bounded(g, fault, special))
    }

    fn is_bounded(&self, group: usize, fault: &Fault, special: &Special) -> bool {
        let (tape, near) = (self.tape_of(group), self.symbols(&fault.arguments));
        let mut random = Random::new(0x6e65_6172);
        (0..2).all(|_| {
            let elsewhere = random.state(self.lagrangian);
            let directions: BTreeMap<Symbol, f64> = near.iter().map(|&s| (s, random.symmetric())).collect();
            let size = |step: f64| {
                let values = tape.run(|symbol| match directions.get(&symbol) {
                    Some(direction) => self.value(&special.state, symbol) + step * direction,
                    None => self.value(&elsewhere, symbol),
                });
                values.into_iter().fold(0.0, |s: f64, x| s.max(x.abs()))
            };
            size(1e-6) <= 10.0 * size(1e-3) + 1e-9
        })
    }
}

/// Zero but for rounding.
fn is_zero(x: Rounded) -> bool {
    x.error.is_finite() && x.value.abs() <= 8.0 * x.error
}

// ---- places and messages

impl Search<'_, '_, '_> {
    /// The site of a fault: the one whose expression it is, else the first one in which the same expression vanishes.
    fn site(&self, fault: &Fault, copies: &[Expr<'_>]) -> Option<usize> {
        let base = singular_base(self.graph.expr(fault.node));
        let itself = copies.iter().position(|copy| copy.id() == fault.node);
        itself.or_else(|| copies.iter().position(|copy| singular_base(without_factor(*copy)) == base))
    }

    fn message(&self, fault: &Fault, special: &Special) -> String {
        let place = self.place(fault, special);
        let means = self.groups[fault.group].means;
        match self.graph.node(fault.node) {
            Node::Call(Function::Abs, _) if self.groups[fault.group].wanted == Wanted::Second => {
                format!(
                    "this has a corner where {place}: in the linearization its second derivative is taken as 0 there"
                )
            }
            Node::Call(Function::Abs, _) => {
                format!("this has a kink where {place}: the derivative jumps, and is taken as 0 there")
            }
            Node::Power(_, n) if n.to_halves() < 0 && n.to_integer().is_some() => {
                format!("this is 0/0 where {place}: {means}")
            }
            _ => {
                let which =
                    if self.groups[fault.group].wanted == Wanted::Second { "second derivative" } else { "derivative" };
                format!("the {which} of this is not finite where {place}: {means}")
            }
        }
    }

    /// "`x` = 0, `y` = 0"
    fn place(&self, fault: &Fault, special: &Special) -> String {
        const SHOWN: usize = 6;
        let symbols: Vec<Symbol> = self.symbols(&fault.arguments).into_iter().collect();
        let known = symbols.iter().filter_map(|symbol| Some((self.name(*symbol)?, *special.shown.get(symbol)?)));
        let (equal, given): (Vec<_>, Vec<_>) = known.partition(|(_, value)| *value == "equal");
        if !equal.is_empty() {
            return format!("{} are equal", abridged(equal.into_iter().map(|(name, _)| name).collect(), SHOWN));
        }
        abridged(given.into_iter().map(|(name, value)| format!("{name} = {value}")).collect(), SHOWN)
    }

    fn name(&self, symbol: Symbol) -> Option<String> {
        let of = |variables, i: u32| component_names(variables).get(i as usize).cloned();
        match symbol {
            Symbol::Time => Some("`t`".to_string()),
            Symbol::Coordinate(i) => of(&self.lagrangian.coordinates, i).map(|name| format!("`{name}`")),
            Symbol::Velocity(i) => of(&self.lagrangian.coordinates, i).map(|name| format!("`dt({name})`")),
            Symbol::Prescribed(i, 0) => of(&self.lagrangian.prescribed, i).map(|name| format!("`{name}`")),
            _ => None,
        }
    }
}

fn abridged(mut words: Vec<String>, shown: usize) -> String {
    if words.len() > shown {
        words.truncate(shown - 1);
        words.push("…".to_string());
    }
    words.join(", ")
}

/// What to write instead of a declared expression.
fn help(declared: Node) -> String {
    let help = match declared {
        Node::Power(_, HalfInteger::HALF) => {
            "a small constant keeps it smooth: `sqrt(v.norm_squared() + small^2)`; where the square will do, use that"
        }
        Node::Power(..) => {
            "cancel what vanishes, or choose around there: `if x^2 < 1e-8 { … } else { … }` with its series in the first \
             branch"
        }
        Node::Call(Function::Abs, _) => "a small constant rounds it off: `sqrt(x^2 + small^2)`",
        Node::Call(Function::Asin | Function::Acos, _) => {
            "where both the sine and the cosine are at hand, `atan2(sine, cosine)` is regular"
        }
        Node::Call2(Binary::Atan2, ..) => "a point at the centre has no angle: use its coordinates instead",
        _ => "an exponent of at least 1 has a finite derivative there",
    };
    help.to_string()
}

/// Without a constant factor and its sign.
fn without_factor(expr: Expr<'_>) -> Expr<'_> {
    let graph = expr.graph();
    match expr.node() {
        Node::Neg(a) => without_factor_of_product(graph.expr(a)),
        _ => without_factor_of_product(expr),
    }
}

fn without_factor_of_product(expr: Expr<'_>) -> Expr<'_> {
    match expr.node() {
        Node::Mul(c, x) if expr.graph().expr(c).as_constant().is_some() => expr.graph().expr(x),
        _ => expr,
    }
}

/// What vanishes where the derivative fails; the derivative of a function is a power of the same.
fn singular_base(expr: Expr<'_>) -> Expr<'_> {
    let graph = expr.graph();
    match expr.node() {
        Node::Power(a, _) => without_factor(graph.expr(a)),
        Node::Call(Function::Asin | Function::Acos, a) => graph.integer(1) - graph.expr(a).powi(2),
        Node::Call2(Binary::Atan2, a, b) => graph.expr(a).powi(2) + graph.expr(b).powi(2),
        Node::Call2(Binary::Powf, a, _) => graph.expr(a),
        _ => expr,
    }
}

#[cfg(test)]
mod tests;
