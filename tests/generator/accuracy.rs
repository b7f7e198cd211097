//! Every generated function of every mechanism of the repository against numbers of 200 bits, as `mbs ops --accuracy`
//! does it (`measure`), the numbers against what was declared, evaluated by dual numbers, and constants that are folded
//! at build time.

mod close;
mod constants;
#[path = "../../mbs-cli/src/accuracy.rs"]
mod measure;
mod sines;
mod truth;

use close::{CLOSE, Close, near};
use mbs_derive::expr::{Graph, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::FunctionKind;
use mbs_derive::verify::Witness;
use mbs_derive::{declared, derived};
use measure::exact::{Exact, forgetting};
use measure::states::{Point, points};
use measure::{At, Worst, plain, worst};
use truth::Truth;

/// u
const UNIT: f64 = f64::EPSILON / 2.0;

/// K
const BOUND: f64 = 32.0;

/// A function is measured at no fewer points.
const LEAST: usize = 3;

/// What formulas lose as they are written is taken at this many states; an error in one place alone may be small by
/// chance.
const AS_WRITTEN: usize = 3;

/// The functions of which no value is measured, by mechanism, with the reason.
const UNMEASURED: &[(&str, &str, &str)] = &[];

fn check(name: &str, source: &str, as_written: usize, choose: impl Fn(&Lagrangian<'_>) -> Vec<Point>) -> Vec<String> {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
    let mut failures = Vec::new();
    for (function, worst) in worst(&lagrangian, &derived(&lagrangian), choose(&lagrangian), as_written) {
        let Worst { ratio, place, numbers, ulp, condition, measured } = worst;
        let most = format!("at most {ulp:9.2e} ulp, explained {condition:9.2e}");
        let line = format!("{name:26} {function:28} {measured:2} {ratio:9.2e} {most} {place}: {numbers}");
        println!("{line}");
        let is_unmeasured = UNMEASURED.iter().any(|(mechanism, of, _)| (*mechanism, *of) == (name, &function));
        if ratio > BOUND || (measured < LEAST) != is_unmeasured {
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
        failures.extend(check(name, source, AS_WRITTEN, points));
        println!("{name} {:?}", started.elapsed());
    }
    assert!(failures.is_empty(), "{} functions lose digits\n{}", failures.len(), failures.join("\n"));
}

/// Where parts touch, the distance between them has the digits that its coordinates give it.
#[test]
fn contacts() {
    let check = |case: &Close| check(case.name, case.source, 0, |lagrangian| near(lagrangian, case.contact));
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
