//! Tables against formulas by hand: values and two derivatives, at samples, between them, outside, as the values of
//! tables change.

use mbs_derive::declared;
use mbs_derive::derived;
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::measured_slider::{MeasuredSlider, Params};
use mbs_tests::random::Random;

/// Where the samples stand; unevenly.
const PLACES: [f64; 5] = [-1.0, 0.0, 1.0, 3.0, 4.0];

fn derivation(source: &str) -> Derivation {
    let graph = Graph::verbatim();
    let (lagrangian, warnings) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
    assert_eq!(warnings.render("", source), "");
    derived(&lagrangian)
}

/// A table as an output, as a potential and as a force.
fn with_table(kind: &str) -> Derivation {
    derivation(&format!(
        "mechanism A {{ param m: kg = 2; param y[5]: J = 1; const x[5]: m = [-1, 0, 1, 3, 4]; coord s: m;
         kinetic += 1/2*m*dt(s)^2; potential += {kind}(s, x, y); output value = {kind}(s, x, y), jacobian_rate; }}"
    ))
}

/// A mechanism whose table holds numbers: a spline, where the other is a tree of branches.
fn with_numbers(kind: &str, y: [f64; 5]) -> Derivation {
    derivation(&format!(
        "mechanism A {{ param m: kg = 2; const y[5]: J = {y:?}; const x[5]: m = [-1, 0, 1, 3, 4]; coord s: m;
         kinetic += 1/2*m*dt(s)^2; potential += {kind}(s, x, y); output value = {kind}(s, x, y), jacobian_rate; }}"
    ))
}

/// Value, slope and curvature: the output's own, the force of the potential, and those that linearization finds.
fn values(derivation: &Derivation, y: [f64; 5], s: f64) -> [f64; 3] {
    let count = derivation.parameters.iter().map(|parameter| parameter.count()).sum();
    let parameters = [2.0].into_iter().chain(y).take(count).collect();
    let interpreter = Interpreter::with_parameters(derivation, parameters);
    let state = State { t: 0.0, q: vec![s], qd: vec![1.0], qdd: vec![0.0], u: vec![], prescribed: vec![] };
    let call = |kind| interpreter.call(kind, &state).expect("generated");
    let of_output = [FunctionKind::Output, FunctionKind::OutputJacobian, FunctionKind::OutputJacobianRate];
    let found = of_output.map(|kind| call(kind(0))[0]);
    assert_eq!(call(FunctionKind::PotentialEnergy), [found[0]], "{s}");
    assert_eq!(call(FunctionKind::Gravity), [found[1]], "{s}");
    // Both are sums `c₁ + 2 c₂ s + 3 c₃ s²` and `2 c₂ + 6 c₃ s`, in an order of their own, with the rounding errors of
    // their terms: `c₂ = (3 δ − 2 a − b)/h` alone is up to 24 times the samples where secants δ and slopes a, b are
    // at most twice and six times as large as these. Less than half of that is allowed for.
    let size = 10.0 * y.iter().fold(0.0_f64, |size, y| size.max(y.abs()));
    assert_close("q̈", &[-2.0 * call(FunctionKind::ForwardDynamics)[0], size], &[found[1], size], 1e-15);
    assert_close("∂q̈/∂s", &[-2.0 * call(FunctionKind::Linearize)[0], size], &[found[2], size], 1e-15);
    found
}

/// Places between the samples and outside them.
fn between() -> impl Iterator<Item = f64> {
    (-60..120).map(|k| 0.05 * f64::from(k) + 0.0125)
}

/// `x³ − 2⟨x − 1⟩³ + 2⟨x − 3⟩³` from 0 on: its curvature is 0 at 4 and continuous, so that it is the natural spline of
/// its samples.
fn cubic(x: f64) -> [f64; 3] {
    let behind = |a: f64| (x - a).max(0.0);
    let terms = [(1.0, behind(0.0)), (-2.0, behind(1.0)), (2.0, behind(3.0))];
    let sum = |f: fn(f64) -> f64| terms.iter().map(|&(factor, x)| factor * f(x)).sum();
    if x > 4.0 {
        let [value, slope, _] = cubic(4.0);
        return [value + slope * (x - 4.0), slope, 0.0];
    }
    [sum(|x| x * x * x), sum(|x| 3.0 * x * x), sum(|x| 6.0 * x)]
}

#[test]
fn a_spline_is_the_cubics_that_its_samples_are_of() {
    let derivation = with_table("table_spline");
    let y = PLACES.map(|x| cubic(x)[0]);
    for x in between() {
        assert_close(&x.to_string(), &values(&derivation, y, x), &cubic(x), 1e-13);
    }
    for (x, y_here) in PLACES.into_iter().zip(y) {
        assert_eq!(values(&derivation, y, x)[0], y_here, "a sample is hit exactly");
    }
    let line = PLACES.map(|x| 3.0 - 2.0 * x);
    for x in between() {
        assert_close(&x.to_string(), &values(&derivation, line, x), &[3.0 - 2.0 * x, -2.0, 0.0], 1e-14);
    }
}

/// By search from the left and two-point interpolation.
fn straight(y: [f64; 5], x: f64) -> [f64; 3] {
    match (0..4).find(|&k| PLACES[k] <= x && x < PLACES[k + 1]) {
        Some(k) => {
            let slope = (y[k + 1] - y[k]) / (PLACES[k + 1] - PLACES[k]);
            [(y[k] * (PLACES[k + 1] - x) + y[k + 1] * (x - PLACES[k])) / (PLACES[k + 1] - PLACES[k]), slope, 0.0]
        }
        None if x < PLACES[0] => [y[0], 0.0, 0.0],
        None => [y[4], 0.0, 0.0],
    }
}

#[test]
fn lines_are_between_their_ends() {
    let (derivation, mut random) = (with_table("table"), Random::new(3));
    for x in between().chain(PLACES) {
        let y = random.array(-2.0..2.0);
        assert_close(&x.to_string(), &values(&derivation, y, x), &straight(y, x), 1e-14);
    }
    let y = [0.3, -0.1, 0.7, 0.2, 1e-3];
    for (place, value) in PLACES.into_iter().zip(y) {
        assert_eq!(values(&derivation, y, place)[0], value, "a sample is hit exactly");
    }
    assert_eq!([-1e300, 1e300].map(|x| values(&derivation, y, x)[0]), [0.3, 1e-3], "far outside");
}

/// Hermite's cubic in its basis `h₀₀ … h₁₁`, with the slopes of Fritsch and Butland and Moler's at the ends.
fn monotone(y: [f64; 5], x: f64) -> [f64; 3] {
    let h: [f64; 4] = std::array::from_fn(|k| PLACES[k + 1] - PLACES[k]);
    let d: [f64; 4] = std::array::from_fn(|k| (y[k + 1] - y[k]) / h[k]);
    let inner = |k: usize| {
        let (v, w) = (2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]);
        if d[k - 1] * d[k] <= 0.0 { 0.0 } else { (v + w) / (v / d[k - 1] + w / d[k]) }
    };
    let end = |h: [f64; 2], d: [f64; 2]| {
        let slope = ((2.0 * h[0] + h[1]) * d[0] - h[0] * d[1]) / (h[0] + h[1]);
        if slope * d[0] <= 0.0 {
            0.0
        } else if d[0] * d[1] <= 0.0 && slope.abs() > 3.0 * d[0].abs() {
            3.0 * d[0]
        } else {
            slope
        }
    };
    let m = [end([h[0], h[1]], [d[0], d[1]]), inner(1), inner(2), inner(3), end([h[3], h[2]], [d[3], d[2]])];
    if !(PLACES[0]..PLACES[4]).contains(&x) {
        let (k, slope) = if x < PLACES[0] { (0, m[0]) } else { (4, m[4]) };
        return [y[k] + slope * (x - PLACES[k]), slope, 0.0];
    }
    let k = (0..4).find(|&k| x < PLACES[k + 1]).expect("inside");
    let s = (x - PLACES[k]) / h[k];
    let combined = |b: [f64; 4]| b[0] * y[k] + b[1] * h[k] * m[k] + b[2] * y[k + 1] + b[3] * h[k] * m[k + 1];
    let (square, cube) = (s * s, s * s * s);
    [
        combined([2.0 * cube - 3.0 * square + 1.0, cube - 2.0 * square + s, 3.0 * square - 2.0 * cube, cube - square]),
        combined([
            6.0 * square - 6.0 * s,
            3.0 * square - 4.0 * s + 1.0,
            6.0 * s - 6.0 * square,
            3.0 * square - 2.0 * s,
        ]) / h[k],
        combined([12.0 * s - 6.0, 6.0 * s - 4.0, 6.0 - 12.0 * s, 6.0 * s - 2.0]) / (h[k] * h[k]),
    ]
}

#[test]
fn monotone_tables_are_those_of_fritsch_and_butland() {
    let (derivation, mut random) = (with_table("table_monotone"), Random::new(4));
    for round in 0..40 {
        let mut y: [f64; 5] = random.array(-2.0..2.0);
        match round % 4 {
            // It rises; it is level somewhere; everywhere.
            0 => y.sort_by(f64::total_cmp),
            1 => y[2] = y[3],
            2 => y = [y[0]; 5],
            _ => {}
        }
        for x in between().chain(PLACES) {
            let found = values(&derivation, y, x);
            assert_close(&format!("{y:?} at {x}"), &found, &monotone(y, x), 1e-12);
            if round % 4 == 0 {
                assert!(found[1] >= -1e-13, "{y:?} falls at {x}: {found:?}");
            }
        }
        for (place, value) in PLACES.into_iter().zip(y) {
            assert_eq!(values(&derivation, y, place)[0], value, "a sample is hit exactly");
        }
    }
}

#[test]
fn tables_of_numbers_are_those_of_parameters() {
    let mut random = Random::new(5);
    for kind in ["table", "table_monotone", "table_spline"] {
        let parametric = with_table(kind);
        for _ in 0..10 {
            let y: [f64; 5] = random.array(-2.0..2.0);
            let numbers = with_numbers(kind, y);
            assert!(numbers.functions.iter().all(|f| f.program.instructions.len() < 40), "no branches");
            for x in between() {
                assert_close(&x.to_string(), &values(&numbers, y, x), &values(&parametric, y, x), 1e-13);
            }
            for (place, value) in PLACES.into_iter().zip(y) {
                assert_eq!(values(&numbers, y, place)[0], value, "a sample is hit exactly");
            }
            let value = |x: f64| values(&numbers, y, x);
            assert!(value(-1e300)[0].is_finite() && value(1e300)[0].is_finite(), "far outside");
        }
    }
}

/// The cost of a table does not grow with its samples, neither that of its functions nor that of its proof.
#[test]
fn a_table_of_ten_thousand_samples_costs_what_one_of_ten_does() {
    let table = |count: usize| {
        let list =
            |f: &dyn Fn(f64) -> f64| (0..count).map(|k| f(k as f64 / count as f64).to_string()).collect::<Vec<_>>();
        let (places, values) = (list(&|x| 10.0 * x).join(", "), list(&|x| (10.0 * x).sin()).join(", "));
        derivation(&format!(
            "mechanism A {{ param m: kg = 2; coord s: m; const x[{count}]: m = [{places}]; const y[{count}]: J = [{values}];
             kinetic += 1/2*m*dt(s)^2; potential += table_spline(s, x, y); }}"
        ))
    };
    let (small, large) = (table(10), table(10_000));
    let counts = |derivation: &Derivation| derivation.functions.iter().map(|f| f.operations).collect::<Vec<_>>();
    assert_eq!(counts(&small), counts(&large));
    let interpreter = Interpreter::with_parameters(&large, vec![2.0]);
    for s in [1.0, 2.5, 6.0] {
        let state = State { t: 0.0, q: vec![s], qd: vec![0.0], qdd: vec![0.0], u: vec![], prescribed: vec![] };
        assert_close("sin′", &interpreter.call(FunctionKind::Gravity, &state).expect("generated"), &[s.cos()], 1e-9);
    }
}

/// Compiled, one state after the other and four at a time; nothing is NaN at a sample.
#[test]
fn compiled_tables_are_chosen_by_each_lane() {
    use mbs_runtime::wide::f64x4;
    let slider = MeasuredSlider::<f64>::default();
    let wide = MeasuredSlider::<f64x4>::new(Params::default());
    let places: Vec<f64> = (-30..30).map(|k| 0.004 * f64::from(k)).chain([-0.04, -0.015, 0.0, 0.015]).collect();
    for four in places.as_chunks::<4>().0 {
        let found = wide.linearize(&[f64x4::new(*four)], &[f64x4::new([1.0, -0.5, 0.0, 7.0])]);
        let speeds = [1.0, -0.5, 0.0, 7.0];
        for (lane, (&x, v)) in four.iter().zip(speeds).enumerate() {
            let one = slider.linearize(&[x], &[v]);
            assert!(one.q[0][0].is_finite() && one.qd[0][0].is_finite(), "{x}");
            assert_eq!(found.q[0][0].to_array()[lane], one.q[0][0], "{x}");
            assert_eq!(found.qd[0][0].to_array()[lane], one.qd[0][0], "{v}");
        }
    }
    // By hand: 20 N at 15 mm, −12 N at −1 m/s, and beyond that no more.
    let acceleration = |x: f64, v: f64| slider.forward_dynamics(&[x], &[v])[0];
    assert_eq!(acceleration(0.015, 0.0), -10.0);
    assert_eq!([-1.0, -30.0].map(|v| acceleration(0.0, v)), [6.0, 6.0]);
    assert!(acceleration(f64::NAN, 0.0).is_nan());
}
