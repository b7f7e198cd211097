//! Doubles against numbers of 200 bits: every generated function of every mechanism of the repository, at random
//! states, and at states that are close, far, stiff and exactly zero, and where the differences that they were written
//! with vanish: what is multiplied out, `x² − 2 a x + a²` for `(x − a)²`, has nothing but errors there.
//!
//! One rounding of the inputs moves a result by some amount, whatever is done with them. The error of the generated
//! code is held against that: `|f̂ − f| ≤ K (max |f(x + δx) − f(x)| + u |f|)`, with `u = 2⁻⁵³`. Each δx is a rounding
//! of all inputs by `± u |x|`, time and parameters among them, and of what is rounded before anything is done with it:
//! constants, sines, roots. |f| is the largest component of its kind (`scale`), and what vanishes for all inputs is
//! moved like the others; of accelerations and their derivatives it is multiplied by the condition of M. What exceeds
//! this by more than the length of a sum explains has lost digits that were there.
//!
//! `f` is what the energies give by differentiation and nothing else, over 200 bits; it is what was declared, evaluated
//! over 200 bits by dual numbers, too.
//!
//! With constraints the condition is that of the scaled bordered matrix, and what is compared is solved with all of it
//! over 200 bits (`bordered`); where rows depend on others, Aᵀλ is compared. What is not determined must be NaN.

mod bordered;
mod close;
mod constants;
mod exact;
mod scale;
mod sines;
pub(crate) mod states;
mod truth;
mod vanishing;

use std::collections::BTreeMap;

use bordered::solved;
use close::{CLOSE, Close};
use exact::{Exact, forgetting, rounding};
use mbs_derive::derive::Route;
use mbs_derive::expr::{Graph, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::{Argument, Completion, Derivation, Function, FunctionKind, by_route};
use mbs_derive::verify::Witness;
use mbs_derive::{declared, derived};
use mbs_tests::random::Random;
use scale::Units;
use states::{Point, near, on_the_constraints, points};
use truth::Truth;

/// u
const UNIT: f64 = f64::EPSILON / 2.0;

/// K
const BOUND: f64 = 32.0;

/// A function is measured at no fewer points.
const LEAST: usize = 3;

/// What formulas lose as they are written is taken at this many states next to one, too.
const NEIGHBOURS: usize = 2;

/// Roundings of the inputs that are tried.
const ROUNDINGS: usize = 4;

/// What is demanded of the formulas that a mechanism is declared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Formula {
    /// That they lose no digits.
    Exact,
    /// Nothing: what they lose in doubles, differentiated as they are written, is the author's.
    AsWritten,
}

/// The largest error of a function, in units of what is explained, and where.
#[derive(Clone, Debug, Default)]
struct Worst {
    ratio: f64,
    place: String,
    /// At how many points all of its components were compared.
    measured: usize,
}

fn worst_of(source: &str, formula: Formula, choose: impl Fn(&Lagrangian<'_>) -> Vec<Point>) -> BTreeMap<String, Worst> {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
    let emitted = derived(&lagrangian);
    let plain = plain(&lagrangian);
    let mut worst: BTreeMap<String, Worst> = BTreeMap::new();
    let mut points = choose(&lagrangian);
    points.extend(on_the_constraints(&emitted, &points));
    for point in points {
        for (name, found) in forgetting(|| errors(&emitted, &plain, &point, formula)) {
            let entry = worst.entry(name).or_default();
            entry.measured += found.measured;
            if found.ratio > entry.ratio {
                (entry.ratio, entry.place) = (found.ratio, found.place);
            }
        }
    }
    worst
}

/// Differentiated and nothing else; of a long chain of bodies there is one route only.
fn plain(lagrangian: &Lagrangian<'_>) -> Derivation {
    let mut ways = [Route::Plain, Route::Structured].into_iter().flat_map(|route| by_route(lagrangian, route));
    ways.next().expect("every mechanism is derived by one of them")
}

/// A mechanism over 200 bits, at a state.
struct At<'d> {
    mechanism: Interpreter<'d, Exact>,
    state: State<Exact>,
    /// How values are rounded on the way, if they are.
    roundings: Option<u64>,
}

impl<'d> At<'d> {
    fn new(derivation: &'d Derivation, point: &Point, roundings: Option<u64>) -> Self {
        let mut random = Random::new(roundings.unwrap_or_default());
        let mut lift = |x: &f64| {
            let up = random.one_in(2);
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

    fn call(&self, kind: FunctionKind) -> Vec<Exact> {
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
fn errors(emitted: &Derivation, plain: &Derivation, point: &Point, formula: Formula) -> Vec<(String, Worst)> {
    // An error in one place alone may be small by chance.
    let nearby: Vec<(Point, At<'_>)> = (0..=NEIGHBOURS as u64)
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
            let place = format!("{}: numbers where nothing is determined", point.name);
            return Worst { ratio: if is_nan { 0.0 } else { f64::INFINITY }, place, measured: 0 };
        }
        if is_solution && units.condition.is_infinite() {
            return Worst::default();
        }
        let others: Vec<Vec<Exact>> = rounded.iter().map(|at| compared(at.call(function.kind))).collect();
        let by_definition = plain.function(function.kind).expect("generated by every route");
        let written = |(point, at): &(Point, At<'_>)| {
            let as_written = Interpreter::with_parameters(plain, point.parameters.clone());
            let found = if is_solution && is_constrained {
                solved(&as_written, by_definition, &point.state)
            } else {
                as_written.evaluate(by_definition, &point.state)
            };
            let expected = compared(at.call(function.kind));
            in_doubles(found).into_iter().zip(expected).map(|(a, b)| a.distance(b)).collect::<Vec<f64>>()
        };
        let lost: Vec<Vec<f64>> = match formula {
            Formula::Exact => Vec::new(),
            Formula::AsWritten => nearby.iter().map(written).collect(),
        };
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
            let ratio = if error.is_nan() { f64::INFINITY } else { error / explained };
            if ratio > worst.ratio {
                let (route, at, found) = (function.route, &point.name, found.to_f64());
                let numbers = format!("found {found:e}, expected {value:e}, explained {explained:e}");
                worst = Worst { ratio, place: format!("{route} {at}, component {i}: {numbers}"), ..worst };
            }
        }
        worst
    };
    emitted.functions.iter().map(|function| (function.name.clone(), forgetting(|| error(function)))).collect()
}

/// The point with all inputs rounded to one of the next doubles; itself for the seed zero.
fn neighbour(point: &Point, seed: u64) -> Point {
    let mut random = Random::new(seed);
    let mut next = |x: &f64| match (seed, random.one_in(2)) {
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

/// The functions of which no value is measured, by mechanism, with the reason.
const UNMEASURED: &[(&str, &str, &str)] = &[];

fn check(name: &str, source: &str, formula: Formula, choose: impl Fn(&Lagrangian<'_>) -> Vec<Point>) -> Vec<String> {
    let mut failures = Vec::new();
    for (function, worst) in worst_of(source, formula, choose) {
        let line = format!("{name:26} {function:28} {:2} {:9.2e} {}", worst.measured, worst.ratio, worst.place);
        println!("{line}");
        let is_unmeasured = UNMEASURED.iter().any(|(mechanism, of, _)| (*mechanism, *of) == (name, &function));
        if worst.ratio > BOUND || (worst.measured < LEAST) != is_unmeasured {
            failures.push(line);
        }
    }
    failures
}

#[test]
fn mechanisms() {
    let mut failures = Vec::new();
    for (name, source) in mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES) {
        let started = std::time::Instant::now();
        failures.extend(check(name, source, Formula::AsWritten, points));
        println!("{name} {:?}", started.elapsed());
    }
    assert!(failures.is_empty(), "{} functions lose digits\n{}", failures.len(), failures.join("\n"));
}

/// Where parts touch, the distance between them has the digits that its coordinates give it.
#[test]
fn contacts() {
    let check =
        |case: &Close| check(case.name, case.source, Formula::Exact, |lagrangian| near(lagrangian, case.contact));
    let failures: Vec<String> = CLOSE.iter().flat_map(check).collect();
    assert!(failures.is_empty(), "{} functions lose digits\n{}", failures.len(), failures.join("\n"));
}

/// Where inputs are doubles, and no rounding is known of, differences of inputs are exact: a spring of 1e9 N/m that is
/// stretched by 10 nm pulls with ten newtons, to the last digits.
#[test]
fn differences_of_inputs_are_exact() {
    for case in CLOSE.iter().filter(|case| case.is_exact) {
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            declared(case.source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", case.source)));
        let derivation = derived(&lagrangian);
        for point in near(&lagrangian, case.contact) {
            let doubles = Interpreter::with_parameters(&derivation, point.parameters.clone());
            let exact = At::new(&derivation, &point, None);
            for kind in [
                FunctionKind::Gravity,
                FunctionKind::Bias,
                FunctionKind::InverseDynamics,
                FunctionKind::ForwardDynamics,
                FunctionKind::GeneralizedForce,
                FunctionKind::Linearize,
            ] {
                let (name, found) = (kind.name(), doubles.call(kind, &point.state));
                let found = found.expect("generated for every mechanism");
                for (i, (found, expected)) in found.iter().zip(exact.call(kind)).enumerate() {
                    let (error, value) = (Exact::constant(*found).distance(expected), expected.to_f64());
                    assert!(error <= 8.0 * UNIT * value.abs(), "{}: {name}[{i}] {found:e}, not {value:e}", case.name);
                }
            }
        }
    }
}

/// A crate that hangs on a rope and is moved along with its attitude.
const CRATE: &str = "
mechanism Crate {
    param m: kg = 3;
    param moment: kg*m^2 = 0.5;
    coord p[3]: m;
    coord a[3]: rad;
    input pull[3]: N;
    let body = translation(p) * rot_z(a[0]) * rot_y(a[1]) * rot_x(a[2]);
    kinetic += rigid_body(m, [0, 0, 0], diag(1, 2, 3)*moment, body);
    force at body.point([0.1 m, 0.2 m, 0.3 m]) += pull;
}";

/// A force in axes of the world moves world coordinates without a detour through the axes of the body that it acts on.
#[test]
fn forces_in_axes_of_the_world_are_not_turned_there_and_back() {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(CRATE, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", CRATE)));
    let derivation = derived(&lagrangian);
    let mechanism = Interpreter::new(&derivation);
    let state = State {
        q: vec![0.3, -0.4, 0.5, 0.6, 0.7, -0.8],
        qd: vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        qdd: vec![0.0; 6],
        u: vec![0.0, 0.0, 1e9],
        ..State::default()
    };
    let call = |kind| mechanism.call(kind, &state).expect("generated for every mechanism");
    let accelerations = call(FunctionKind::ForwardDynamics);
    assert_eq!(accelerations[..2], [0.0, 0.0]);
    assert!((accelerations[2] - 1e9 / 3.0).abs() <= 2.0 * f64::EPSILON * accelerations[2], "{accelerations:?}");
    assert!(call(FunctionKind::Linearize)[..3 * 6].iter().all(|slope| *slope == 0.0));
    assert_eq!(call(FunctionKind::GeneralizedForce)[..3], [0.0, 0.0, 1e9]);
    assert_eq!(call(FunctionKind::Bias)[..3], [0.0; 3]);
}

/// What is held against the generated code is what was declared, to a thousandth of what the proof asks. Constants that
/// no fraction holds are doubles in it.
#[test]
fn the_reference_is_what_was_declared() {
    let of_the_repository =
        mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).map(|&(name, source)| (name, source));
    for (name, source) in of_the_repository.chain(CLOSE.iter().map(|case| (case.name, case.source))) {
        let graph = Graph::verbatim();
        let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
        let plain = plain(&lagrangian);
        let witness = Witness::new(&lagrangian);
        let mut compared = 0;
        for point in points(&lagrangian).iter().take(4) {
            forgetting(|| {
                let at = At::new(&plain, point, None);
                let truth = Truth::at(&witness, &at.state, at.mechanism.parameters());
                let largest = |values: &[Exact]| values.iter().map(|v| v.to_f64().abs()).fold(0.0, f64::max);
                for (function, expected) in [
                    (FunctionKind::KineticEnergy, &[truth.kinetic_energy][..]),
                    (FunctionKind::PotentialEnergy, &[truth.potential_energy]),
                    (FunctionKind::InverseDynamics, &truth.inverse_dynamics),
                ] {
                    let scale = largest(expected);
                    for (found, &expected) in at.call(function).into_iter().zip(expected) {
                        let error = found.distance(expected);
                        // At a corner of `abs` there is no derivative.
                        let is_known = expected.to_f64().is_finite();
                        assert!(!is_known || error <= 1e-12 * scale, "{name}: {function:?} {}: {error:e}", point.name);
                        compared += usize::from(is_known);
                    }
                }
            });
        }
        assert!(compared > 2 * lagrangian.dof(), "{name}: {compared}");
    }
}
