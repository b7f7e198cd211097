//! Doubles against numbers of 200 bits: every generated function of a mechanism, at random states, and at states that
//! are close, far, stiff and exactly zero, and where the differences that they were written with vanish: what is
//! multiplied out, `x² − 2 a x + a²` for `(x − a)²`, has nothing but errors there.
//!
//! One rounding of the inputs moves a result by some amount, whatever is done with them. The error of the generated
//! code is held against that: `|f̂ − f| ≤ K (max |f(x + δx) − f(x)| + u |f|)`, with `u = 2⁻⁵³`. Each δx is a rounding
//! of all inputs by `± u |x|`, time and parameters among them, and of what is rounded before anything is done with it:
//! constants, sines, roots. |f| is the largest component of its kind (`scale`), and what vanishes for all inputs is
//! moved like the others; of accelerations and their derivatives it is multiplied by the condition of M. What exceeds
//! this by more than the length of a sum explains has lost digits that were there.
//!
//! `f` is what the energies give by differentiation and nothing else, over 200 bits.
//!
//! With constraints the condition is that of the scaled bordered matrix, and what is compared is solved with all of it
//! over 200 bits (`bordered`); where rows depend on others, Aᵀλ is compared. What is not determined must be NaN.
//!
//! The tests of the workspace are made of these files, too (`tests/generator/accuracy.rs`).

#[path = "accuracy/bordered.rs"]
mod bordered;
#[path = "accuracy/exact.rs"]
pub(crate) mod exact;
#[path = "accuracy/scale.rs"]
mod scale;
#[path = "accuracy/states.rs"]
pub(crate) mod states;
#[path = "accuracy/vanishing.rs"]
mod vanishing;

use std::collections::BTreeMap;

use bordered::solved;
use exact::{Exact, forgetting, rounding};
use mbs_derive::derive::Route;
use mbs_derive::expr::Value;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Lagrangian;
use mbs_derive::numeric::Random;
use mbs_derive::optimise::{Argument, Completion, Derivation, Function, FunctionKind, by_route};
use scale::Units;
use states::{Point, on_the_constraints};

/// u
const UNIT: f64 = f64::EPSILON / 2.0;

/// Roundings of the inputs that are tried.
const ROUNDINGS: usize = 4;

/// The largest error of a function, and where it is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Worst {
    /// In units of what is explained.
    pub(crate) ratio: f64,
    /// There.
    pub(crate) place: String,
    /// What is compared there.
    pub(crate) numbers: String,
    /// In units in the last place of the largest component of its kind.
    pub(crate) ulp: f64,
    /// What is explained where the error has most of these units, in the same.
    pub(crate) condition: f64,
    /// At how many points all of its components were compared.
    pub(crate) measured: usize,
}

impl Worst {
    /// The worse one of both.
    fn join(&mut self, other: Worst) {
        self.measured += other.measured;
        if other.ratio > self.ratio {
            (self.ratio, self.place, self.numbers) = (other.ratio, other.place, other.numbers);
        }
        if other.ulp > self.ulp {
            (self.ulp, self.condition) = (other.ulp, other.condition);
        }
    }
}

/// The errors of each function of a mechanism, at some points and at the nearest ones to them that constraints allow.
///
/// What its formulas lose in doubles as they are written is the author's, and explained, too: at each point and its
/// neighbours, `as_written` in number.
pub(crate) fn worst(
    lagrangian: &Lagrangian<'_>,
    emitted: &Derivation,
    mut points: Vec<Point>,
    as_written: usize,
) -> BTreeMap<String, Worst> {
    let plain = plain(lagrangian);
    let mut worst: BTreeMap<String, Worst> = BTreeMap::new();
    points.extend(on_the_constraints(emitted, &points));
    for point in points {
        for (name, found) in forgetting(|| errors(emitted, &plain, &point, as_written)) {
            worst.entry(name).or_default().join(found);
        }
    }
    worst
}

/// Differentiated and nothing else; of a long chain of bodies there is one route only.
pub(crate) fn plain(lagrangian: &Lagrangian<'_>) -> Derivation {
    let mut ways = [Route::Plain, Route::Structured].into_iter().flat_map(|route| by_route(lagrangian, route));
    ways.next().expect("every mechanism is derived by one of them")
}

/// A mechanism over 200 bits, at a state.
pub(crate) struct At<'d> {
    pub(crate) mechanism: Interpreter<'d, Exact>,
    pub(crate) state: State<Exact>,
    /// How values are rounded on the way, if they are.
    roundings: Option<u64>,
}

impl<'d> At<'d> {
    pub(crate) fn new(derivation: &'d Derivation, point: &Point, roundings: Option<u64>) -> Self {
        let mut random = Random::new(roundings.unwrap_or_default());
        let mut lift = |x: &f64| {
            let up = random.symmetric() > 0.0;
            Exact::perturbed(
                *x,
                if roundings.is_none() {
                    0.0
                } else if up {
                    UNIT
                } else {
                    -UNIT
                },
            )
        };
        let state = State {
            t: lift(&point.state.t),
            q: point.state.q.iter().map(&mut lift).collect(),
            qd: point.state.qd.iter().map(&mut lift).collect(),
            qdd: point.state.qdd.iter().map(&mut lift).collect(),
            u: point.state.u.iter().map(&mut lift).collect(),
            prescribed: point.state.prescribed.iter().map(|p| [lift(&p[0]), lift(&p[1]), lift(&p[2])]).collect(),
        };
        let parameters: Vec<Exact> = point.parameters.iter().map(&mut lift).collect();
        let make = || Interpreter::with_parameters(derivation, parameters);
        let mechanism = if let Some(seed) = roundings { rounding(seed, make) } else { make() };
        At { mechanism, state, roundings }
    }

    pub(crate) fn call(&self, kind: FunctionKind) -> Vec<Exact> {
        let derivation = self.mechanism.derivation();
        let function = derivation.function(kind).expect("generated by every route");
        let takes_multipliers = function.arguments.contains(&Argument::Multipliers);
        let multipliers = if takes_multipliers { self.call(FunctionKind::Multipliers) } else { Vec::new() };
        let call = || match function.completion {
            Completion::SolveConstrained | Completion::SolveMultipliers => {
                solved(&self.mechanism, function, &self.state)
            }
            Completion::None | Completion::Solve => self.mechanism.evaluate_with(function, &self.state, &multipliers),
        };
        if let Some(seed) = self.roundings { rounding(seed, call) } else { call() }
    }
}

/// For each function the largest error of a component, in units of what is explained.
fn errors(emitted: &Derivation, plain: &Derivation, point: &Point, as_written: usize) -> Vec<(String, Worst)> {
    // An error in one place alone may be small by chance.
    let nearby: Vec<(Point, At<'_>)> = (0..as_written as u64)
        .map(|seed| neighbour(point, seed))
        .map(|point| {
            let at = At::new(plain, &point, None);
            (point, at)
        })
        .collect();
    let doubles = Interpreter::with_parameters(emitted, point.parameters.clone());
    let exact = At::new(plain, point, None);
    let rounded: Vec<_> = (1..=ROUNDINGS as u64).map(|seed| At::new(plain, point, Some(seed))).collect();
    let numbers = |kind| exact.call(kind).into_iter().map(Exact::to_f64).collect::<Vec<f64>>();
    let mass_matrix = forgetting(|| numbers(FunctionKind::MassMatrix));
    let of_forces = Units::of(&mass_matrix);
    let is_constrained = !emitted.constraints.is_empty();
    let jacobian = if is_constrained { exact.call(FunctionKind::ConstraintJacobian) } else { Vec::new() };
    let of_solutions = if is_constrained {
        let jacobian: Vec<f64> = jacobian.iter().map(|a| a.to_f64()).collect();
        Units::of_constrained(&mass_matrix, &jacobian)
    } else {
        of_forces.clone()
    };
    let accelerations = forgetting(|| numbers(FunctionKind::ForwardDynamics));
    let scaled = accelerations.iter().zip(&of_solutions.coordinates).map(|(a, unit)| (a / unit).abs());
    let largest_acceleration = scaled.fold(0.0, f64::max);
    let error = |function: &Function| {
        let is_solution = is_solution(&function.kind);
        let units = if is_solution { &of_solutions } else { &of_forces };
        // Of multipliers that are some of many the forces that they stand for.
        let is_shared = function.kind == FunctionKind::Multipliers && units.is_redundant;
        let compared = |values: Vec<Exact>| if is_shared { forces(&jacobian, &values) } else { values };
        let in_doubles = |values: Vec<f64>| compared(values.into_iter().map(Exact::constant).collect());
        let found = in_doubles(doubles.evaluate(function, &point.state));
        let expected = compared(exact.call(function.kind));
        if is_solution && is_constrained && expected.iter().all(|x| x.to_f64().is_nan()) {
            let is_nan = found.iter().all(|x| x.to_f64().is_nan());
            let numbers = "numbers where nothing is determined".to_string();
            let ratio = if is_nan { 0.0 } else { f64::INFINITY };
            return Worst { ratio, place: point.name.clone(), numbers, ..Worst::default() };
        }
        if is_solution && units.condition.is_infinite() {
            return Worst::default();
        }
        let others: Vec<Vec<Exact>> = rounded.iter().map(|at| compared(at.call(function.kind))).collect();
        let by_definition = plain.function(function.kind).expect("generated by every route");
        let as_written = |(point, at): &(Point, At<'_>)| {
            let doubles = Interpreter::with_parameters(plain, point.parameters.clone());
            let found = if is_solution && is_constrained {
                solved(&doubles, by_definition, &point.state)
            } else {
                doubles.evaluate(by_definition, &point.state)
            };
            let expected = compared(at.call(function.kind));
            in_doubles(found).into_iter().zip(expected).map(|(a, b)| a.distance(b)).collect::<Vec<f64>>()
        };
        let lost: Vec<Vec<f64>> = nearby.iter().map(as_written).collect();
        let scales = units.scales(function);
        assert_eq!(scales.len(), found.len(), "{}", function.name);
        let moved: Vec<f64> = (0..expected.len())
            .map(|i| others.iter().map(|other| other[i].distance(expected[i])).fold(0.0, f64::max))
            .collect();
        let mut largest: BTreeMap<usize, f64> = BTreeMap::new();
        let mut largest_move: f64 = 0.0;
        for ((scale, value), moved) in scales.iter().zip(&expected).zip(&moved) {
            let value = value.to_f64().abs() * scale.unit;
            let entry = largest.entry(scale.kind).or_default();
            *entry = entry.max(value);
            largest_move = largest_move.max(moved * scale.unit + UNIT * value);
        }
        let condition = if is_solution { units.condition } else { 1.0 };
        let mut worst = Worst { measured: 1, ..Worst::default() };
        for (i, (&found, &expected)) in found.iter().zip(&expected).enumerate() {
            let (value, scale) = (expected.to_f64(), scales[i]);
            // What vanishes for all inputs is compared with what does not.
            let vanishes = moved[i].max(value.abs()) * scale.unit <= 1e-12 * largest_move;
            let moved = if vanishes { largest_move / scale.unit } else { moved[i] };
            if !value.is_finite() || !moved.is_finite() {
                worst.measured = 0;
                continue;
            }
            let mut of_its_kind = largest[&scale.kind];
            if function.kind == FunctionKind::LinearizeParameters {
                // By a relative change of the parameter it is as accurate as what it is the derivative of.
                let parameter = point.parameters[i % point.parameters.len()].abs();
                of_its_kind += if parameter > 0.0 { largest_acceleration / parameter } else { 0.0 };
            }
            let lost = lost.iter().map(|lost| lost[i]).filter(|lost| lost.is_finite()).fold(0.0, f64::max);
            let explained = lost + moved + UNIT * condition * of_its_kind / scale.unit + f64::MIN_POSITIVE;
            let error = found.distance(expected);
            let unit = f64::EPSILON * of_its_kind / scale.unit;
            let (route, at, found) = (function.route, &point.name, found.to_f64());
            worst.join(Worst {
                ratio: if error.is_nan() { f64::INFINITY } else { error / explained },
                place: format!("{at}, component {i}"),
                numbers: format!("{route}: found {found:e}, expected {value:e}, explained {explained:e}"),
                ulp: if unit > 0.0 { error / unit } else { 0.0 },
                condition: explained / unit,
                measured: 0,
            });
        }
        worst
    };
    emitted.functions.iter().map(|function| (function.name.clone(), forgetting(|| error(function)))).collect()
}

/// The point with all inputs rounded to one of the next doubles; itself for the seed zero.
fn neighbour(point: &Point, seed: u64) -> Point {
    let mut random = Random::new(seed);
    let mut next = |x: &f64| match (seed, random.symmetric() > 0.0) {
        (0, _) => *x,
        (_, true) => x.next_up(),
        (_, false) => x.next_down(),
    };
    // What is exactly zero stays so.
    let mut all = |values: &[f64]| values.iter().map(|x| if *x == 0.0 { *x } else { next(x) }).collect::<Vec<f64>>();
    let state = State {
        t: all(&[point.state.t])[0],
        q: all(&point.state.q),
        qd: all(&point.state.qd),
        qdd: all(&point.state.qdd),
        u: all(&point.state.u),
        prescribed: point.state.prescribed.iter().map(|p| [0, 1, 2].map(|k| all(&p[k..=k])[0])).collect(),
    };
    Point { name: point.name.clone(), state, parameters: all(&point.parameters) }
}

/// Aᵀλ
fn forces(jacobian: &[Exact], multipliers: &[Exact]) -> Vec<Exact> {
    let n = jacobian.len() / multipliers.len();
    let along = |i: usize| {
        let terms = multipliers.iter().enumerate().map(|(k, l)| jacobian[k * n + i].mul(*l));
        terms.fold(Exact::constant(0.0), Exact::add)
    };
    (0..n).map(along).collect()
}

/// Whether it is what `M q̈ = …` is solved for.
fn is_solution(kind: &FunctionKind) -> bool {
    use FunctionKind as Kind;
    matches!(kind, Kind::ForwardDynamics | Kind::Linearize | Kind::LinearizeParameters | Kind::Multipliers)
}
