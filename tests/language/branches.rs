//! Branches in compiled code: the side that is not taken is never executed, lanes execute both and select, and neither
//! leaves a trace in values or derivatives; comparisons are those of IEEE 754 wherever they are made.
//!
//! The mechanism is `mechanisms/branches.mbs`, whose sides have no value where the other one is taken; that of
//! `mechanisms/long_branches.mbs` is cut into blocks.

mod watched;

use mbs_derive::declared;
use mbs_derive::expr::{self, Graph, Rounded, Symbol, Tape, Value};
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::model::OutputValue;
use mbs_derive::optimise::Derivation;
use mbs_runtime::wide::{f32x8, f64x4};
use mbs_runtime::{Dual, Mechanism, Scalar};
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::branches::Branches;
use mbs_tests::mechanisms::long_branches::LongBranches;
use mbs_tests::mechanisms::switched_spring::{Params, SwitchedSpring};
use mbs_tests::{derivation, named, source};
use watched::{Tally, Watched};

/// `q`, `q̇`, `q̈` and `u`.
type Arguments<S> = ([S; 3], [S; 3], [S; 3], [S; 1]);

/// On all sides of all branches, and on the borders between them.
fn states() -> Vec<Arguments<f64>> {
    let mut states = Vec::new();
    for x in [-2.0, -0.5, -0.4, -0.25, -0.1, 0.0, 0.1, 0.25, 0.4, 0.5, 2.0] {
        for y in [-1.0, 0.0, 0.1, 0.25, 0.3, 1.5] {
            for z in [-1.0, -0.25, 0.0, 0.1, 0.25, 1.0] {
                let y_dot = [-1.0, 0.0, 0.7, 1.0][states.len() % 4];
                states.push(([x, y, z], [0.3, y_dot, -0.8], [1.1, -0.6, 0.2], [0.9]));
            }
        }
    }
    states
}

/// The functions that are compared.
const FUNCTIONS: [&str; 13] = [
    "kinetic_energy",
    "potential_energy",
    "momentum",
    "mass_matrix",
    "coriolis_matrix",
    "gravity",
    "bias",
    "dissipation_force",
    "generalized_force",
    "inverse_dynamics",
    "forward_dynamics",
    "linearize",
    "inverse_dynamics_jacobian",
];

/// What the compiled code gives, numbers in a row.
fn compiled<S: Scalar>(function: &str, (q, qd, qdd, u): &Arguments<S>) -> Vec<S> {
    let (mechanism, t) = (Branches::<S>::default(), S::zero());
    match function {
        "kinetic_energy" => vec![mechanism.kinetic_energy(q, qd)],
        "potential_energy" => vec![mechanism.potential_energy(q)],
        "momentum" => mechanism.momentum(q, qd).to_vec(),
        "mass_matrix" => Mechanism::mass_matrix(&mechanism, t, q).concat(),
        "coriolis_matrix" => mechanism.coriolis_matrix(q, qd).concat(),
        "gravity" => mechanism.gravity(q).to_vec(),
        "bias" => mechanism.bias(q, qd).to_vec(),
        "dissipation_force" => mechanism.dissipation_force(q, qd).to_vec(),
        "generalized_force" => mechanism.generalized_force(q, qd, u).to_vec(),
        "inverse_dynamics" => mechanism.inverse_dynamics(q, qd, qdd).to_vec(),
        "forward_dynamics" => mechanism.forward_dynamics(q, qd, u).to_vec(),
        "linearize" => {
            let l = mechanism.linearize(q, qd, u);
            [l.q.concat(), l.qd.concat(), l.u.concat()].concat()
        }
        "inverse_dynamics_jacobian" => {
            let j = mechanism.inverse_dynamics_jacobian(q, qd, qdd);
            [j.q.concat(), j.qd.concat()].concat()
        }
        "comparisons" => mechanism.comparisons(q).to_vec(),
        other => panic!("{other} is not a function of the mechanism"),
    }
}

fn arguments<S>((q, qd, qdd, u): &Arguments<f64>, from: impl Fn(f64) -> S) -> Arguments<S> {
    (q.map(&from), qd.map(&from), qdd.map(&from), u.map(&from))
}

fn state<V: Value>((q, qd, qdd, u): &Arguments<V>) -> interpret::State<V> {
    let [q, qd, qdd] = [q, qd, qdd].map(|values| values.to_vec());
    interpret::State { t: V::constant(0.0), q, qd, qdd, u: u.to_vec(), prescribed: Vec::new() }
}

fn interpreter<V: Value>(derivation: &Derivation) -> Interpreter<'_, V> {
    let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults);
    Interpreter::with_parameters(derivation, defaults.map(|number| V::constant(number.to_f64())).collect())
}

// ---- values by hand

/// `x`, `y`, `z` as doubles choose the side, as dual numbers they are what is differentiated.
struct Sides {
    beyond: Dual<f64>,
    root: Dual<f64>,
    logarithm: Dual<f64>,
    reciprocal: Dual<f64>,
    nested: Dual<f64>,
}

const M: f64 = 2.0;
const K: f64 = 3.0;
const EDGE: f64 = 0.25;

fn sides([x, y, z]: [Dual<f64>; 3]) -> Sides {
    let c = Dual::constant;
    let square_root = || (x * x - c(EDGE * EDGE)).sqrt();
    Sides {
        beyond: match x.value {
            x if x < -0.5 => square_root(),
            x if x > 0.5 => c(2.0) * square_root(),
            _ => c(0.0),
        },
        root: match x.value {
            x_ if x_ > EDGE => x.sqrt(),
            x_ if x_ < -EDGE => (-x).sqrt() * y.sin() + c(3.0),
            _ => x * x + c(1.0),
        },
        logarithm: if y.value > EDGE { y.ln() } else { c(1.0) / (y - c(2.0 * EDGE)) },
        reciprocal: if z.value.abs() >= EDGE { c(1.0) / z } else { c(K) * z },
        nested: match (x.value > EDGE, y.value > EDGE) {
            (true, true) => (x * y).ln() / x.sqrt(),
            (true, false) => x.ln() - y * c(K.sqrt()),
            (false, true) => y.ln() * x,
            (false, false) => x * y,
        },
    }
}

fn potential(q: [Dual<f64>; 3]) -> Dual<f64> {
    let s = sides(q);
    s.nested + s.logarithm * q[2] + s.reciprocal * q[1]
}

#[test]
fn values_and_derivatives_are_those_of_the_side_taken() {
    for arguments in states() {
        let (q, qd, _, u) = arguments;
        let Sides { beyond, root, reciprocal, .. } = sides(q.map(Dual::constant));
        let (b, r) = (beyond.value, reciprocal.value);
        let m = [M + b, 0.0, 0.0, 0.0, 1.0 + root.value + r * r, M * r, 0.0, M * r, M * M];
        let along =
            |i: usize| std::array::from_fn(|j| if i == j { Dual::variable(q[j]) } else { Dual::constant(q[j]) });
        let gravity: Vec<f64> = (0..3).map(|i| potential(along(i)).derivative).collect();
        let choice = f64::max((q[0] * q[0] + 1.0).sqrt() * q[1], q[2]);
        let drive = if qd[1] > 0.0 { qd[1].sqrt() } else { 1.0 / (qd[1] - 1.0) };
        let force = [choice + q[0].min(q[1]) * u[0], (K * q[2]).clamp(-1.0, 1.0) * qd[0] + drive, 0.0];
        let expected = [
            ("mass_matrix", m.to_vec()),
            ("potential_energy", vec![potential(q.map(Dual::constant)).value]),
            ("gravity", gravity),
            ("dissipation_force", vec![0.0, 0.0, K * (b + 1.0) * qd[2]]),
            ("generalized_force", force.to_vec()),
        ];
        for (function, expected) in expected {
            assert_close(&format!("{function} at {arguments:?}"), &compiled(function, &arguments), &expected, 1e-14);
        }
    }
}

// ---- one number at a time

#[test]
fn what_is_executed_is_defined_and_needed() {
    let derivation = derivation(source(mbs_models::SOURCES, "branches"));
    let interpreter = interpreter::<Watched>(&derivation);
    let mut taken: Vec<Tally> = Vec::new();
    for arguments_ in states() {
        let watched = arguments(&arguments_, Watched);
        for function in FUNCTIONS {
            let new = Watched::tally(Branches::<Watched>::default).1;
            let (values, mut executed) = Watched::tally(|| compiled(function, &watched));
            executed.sums -= new.sums;
            executed.products -= new.products;
            executed.quotients -= new.quotients;
            // Nothing was a NaN or an infinity, and nothing was computed but what the result needs.
            assert_eq!(executed.undefined, 0, "{function} at {arguments_:?}");
            let (interpreted, needed) = Watched::tally(|| named(&interpreter, function, &state(&watched)));
            // Of an angle both are computed where one is needed.
            let angles = executed.waves / 2;
            assert!((angles..=2 * angles).contains(&needed.waves), "{function} at {arguments_:?}");
            executed.waves = needed.waves;
            assert_eq!(executed, needed, "{function} at {arguments_:?}");
            let plain = compiled(function, &arguments_);
            assert_eq!(values.iter().map(|v| v.0).collect::<Vec<_>>(), plain);
            assert_eq!(interpreted.expect("a function of the mechanism"), values);
            if !taken.contains(&executed) {
                taken.push(executed);
            }
        }
    }
    assert!(taken.len() > 50, "{} ways through the branches", taken.len());
}

#[test]
fn roots_and_logarithms_are_taken_where_they_are_written() {
    let check = |q: [f64; 3], roots: usize, logarithms: usize, quotients: usize| {
        let q = q.map(Watched);
        let mechanism = Branches::<Watched>::default();
        let tally = Watched::tally(|| mechanism.potential_energy(&q)).1;
        assert_eq!((tally.roots, tally.logarithms, tally.quotients), (roots, logarithms, quotients), "{q:?}");
    };
    check([0.0, 0.0, 0.0], 0, 0, 1); // x y, 1/(y − …)
    check([0.0, 0.3, 0.0], 0, 1, 0); // ln y, once for two branches
    check([1.0, 0.0, 0.0], 1, 1, 1); // ln x − y √k, 1/(y − …)
    check([1.0, 0.3, 0.0], 1, 2, 1); // ln(x y)/√x, ln y
    check([0.0, 0.0, 0.5], 0, 0, 2); // 1/z
}

// ---- long ones

#[test]
fn blocks_see_what_they_need() {
    let mechanism = LongBranches::<f64>::default();
    for (x, y) in [0.05, 0.3, -1.0].into_iter().flat_map(|x| [0.2, 0.7, 1.5, -2.0].map(|y| (x, y))) {
        let along = |dx: f64, dy: f64| {
            let decay =
                |a: Dual<f64>| (0..1100).fold(a, |a, _| a * (Dual::constant(1.0) - a * a * Dual::constant(0.01)));
            let (x, y) = (Dual { value: x, derivative: dx }, Dual { value: y, derivative: dy });
            let root = || if x.value > 0.1 { decay(x).sqrt() } else { Dual::constant(1.0) };
            let first = decay(x) + if y.value > 0.5 { decay(y) + root() } else { x };
            let second = if x.value > 0.1 && y.value <= 1.0 { root() * y } else { y };
            [first, second]
        };
        let q = [x, y, 0.1, 0.2, 0.3];
        let values = along(0.0, 0.0).map(|force| force.value);
        assert_close("force", &mechanism.generalized_force(&q, &[0.0; 5])[..2], &values, 1e-13);
        let slopes = mechanism.linearize(&q, &[0.0; 5]).q;
        for (j, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let expected = along(direction[0], direction[1]).map(|force| force.derivative);
            assert_close("slope", &[slopes[0][j], slopes[1][j]], &expected, 1e-13);
        }
    }
}

// ---- lanes and single precision

/// States side by side: `lanes` makes a number of those that a function gives for each.
fn beside<L>(states: &[Arguments<f64>], lanes: impl Fn(&dyn Fn(usize) -> f64) -> L) -> Arguments<L> {
    let all = |of: fn(&Arguments<f64>, usize) -> f64, i: usize| lanes(&|k| of(&states[k], i));
    let q = std::array::from_fn(|i| all(|a, i| a.0[i], i));
    let qd = std::array::from_fn(|i| all(|a, i| a.1[i], i));
    let qdd = std::array::from_fn(|i| all(|a, i| a.2[i], i));
    (q, qd, qdd, [all(|a, i| a.3[i], 0)])
}

#[test]
fn lanes_go_both_ways_and_select() {
    let states = states();
    // Neighbours in the list are on different sides of most branches.
    for four in states.chunks_exact(4).chain(states.chunks_exact(4).rev().step_by(3)) {
        let together = beside(four, |of| f64x4::from(std::array::from_fn::<f64, 4, _>(of)));
        for function in FUNCTIONS {
            let values = compiled(function, &together);
            for (k, alone) in four.iter().enumerate() {
                let lane: Vec<f64> = values.iter().map(|v| v.to_array()[k]).collect();
                // The functions of lanes are good to a few units in the last place.
                assert_close(&format!("{function} at {alone:?}"), &lane, &compiled(function, alone), 1e-13);
            }
        }
    }
}

#[test]
fn single_precision_takes_the_same_sides() {
    let states = states();
    for eight in states.chunks_exact(8) {
        let together = beside(eight, |of| f32x8::from(std::array::from_fn::<f32, 8, _>(|k| of(k) as f32)));
        for function in FUNCTIONS {
            let values = compiled(function, &together);
            for (k, alone) in eight.iter().enumerate() {
                let doubles = compiled(function, alone);
                let lane: Vec<f64> = values.iter().map(|v| f64::from(v.to_array()[k])).collect();
                let single = compiled(function, &arguments(alone, |x| x as f32));
                let single: Vec<f64> = single.into_iter().map(f64::from).collect();
                // Rounding to 6e-8, times what the inverse of M makes of it.
                assert_close(&format!("{function} at {alone:?}, single"), &single, &doubles, 1e-5);
                assert_close(&format!("{function} at {alone:?}, lane"), &lane, &doubles, 1e-5);
            }
        }
    }
}

// ---- comparisons

/// What the output `comparisons` is, by the comparisons of doubles.
#[allow(clippy::neg_cmp_op_on_partial_ord)] // with NaN a comparison and the negation of its opposite differ
fn comparisons(x: f64, y: f64) -> Vec<f64> {
    let conditions =
        [x < y, x <= y, x > y, x >= y, !(x < y), !(x <= y), !(x > y), !(x >= y), x < y || x >= y, !(x < y && y <= x)];
    let [smaller, larger] = if x < y { [x, y] } else { [y, x] };
    conditions.map(|holds| if holds { 1.0 } else { 0.0 }).into_iter().chain([smaller, larger]).collect()
}

#[test]
fn comparisons_are_those_of_ieee_754() {
    let derivation = derivation(source(mbs_models::SOURCES, "branches"));
    let (doubles, duals) = (interpreter::<f64>(&derivation), interpreter::<expr::Dual<Rounded>>(&derivation));
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source(mbs_models::SOURCES, "branches"), &graph, &[]).expect("a mechanism");
    let declared = lagrangian.outputs.iter().find(|output| output.name == "comparisons").map(|output| &output.value);
    let Some(OutputValue::Array(declared)) = declared else { panic!("an array is declared") };
    let bits = |values: &[f64]| values.iter().map(|v| if v.is_nan() { 1 } else { v.to_bits() }).collect::<Vec<_>>();
    let all = [f64::NAN, f64::NEG_INFINITY, -1.0, -0.0, 0.0, 2.0, f64::INFINITY];
    for (x, y) in all.iter().flat_map(|&x| all.map(|y| (x, y))) {
        let expected = bits(&comparisons(x, y));
        let check = |who: &str, found: Vec<f64>| assert_eq!(bits(&found), expected, "{who}: x = {x}, y = {y}");
        let arguments_ = ([x, y, 0.0], [0.0; 3], [0.0; 3], [0.0]);
        check("f64", compiled("comparisons", &arguments_));
        let single = compiled("comparisons", &arguments(&arguments_, |x| x as f32));
        check("f32", single.into_iter().map(f64::from).collect());
        let dual = compiled("comparisons", &arguments(&arguments_, Dual::variable));
        check("dual", dual.iter().map(|v| v.value).collect());
        let lanes = compiled("comparisons", &arguments(&arguments_, f64x4::splat));
        check("lanes", lanes.iter().map(|v| v.to_array()[3]).collect());
        check("interpreter", named(&doubles, "comparisons", &state(&arguments_)).expect("an output"));
        let lifted = arguments(&arguments_, |x| expr::Dual::fixed(Rounded::exact(x)));
        let interpreted = named(&duals, "comparisons", &state(&lifted)).expect("an output");
        check("interpreter, dual", interpreted.iter().map(|v| v.value.value).collect());
        let witness = Tape::new(declared).run(|symbol| match symbol {
            Symbol::Coordinate(i) => expr::Dual::fixed(Rounded::exact([x, y, 0.0][i as usize])),
            other => panic!("{other:?} is not compared"),
        });
        check("witness", witness.iter().map(|v| v.value.value).collect());
    }
}

/// Conditions on parameters alone are truth values, which a constructor does not keep.
#[test]
fn parameters_choose_a_side() {
    let (m, k, q) = (1.5, 3.0, [0.4, -0.7]);
    let accelerations =
        |kind: f64| SwitchedSpring::new(Params { m, k, kind }).forward_dynamics(&q, &[0.0; 2]).map(|qdd| m * qdd);
    let [x, y] = q;
    assert_close("hard", &accelerations(2.0), &[-2.0 * k * x * 2.0_f64.sqrt(), -k * y], 1e-15);
    assert_close("soft", &accelerations(0.5), &[-k * x - k * x, -k * y], 1e-15);
    assert_close("a force", &accelerations(-4.0), &[-k * x, 2.0 * k * x], 1e-15);
    let chosen = |kind: f64| SwitchedSpring::new(Params { m, k, kind }).chosen(&q);
    assert_eq!([chosen(2.0), chosen(1.0)], [x, 2.0 * x + y]);
}
