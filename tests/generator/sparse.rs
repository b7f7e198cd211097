//! Mechanisms of many coordinates whose mass matrix is mostly zero: accelerations are statements without a solver, as
//! many as there are couplings.

use mbs_derive::emit::Options;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Completion, FunctionKind};
use mbs_derive::{Analysis, expr::Graph, source::Sources};

/// Masses in a row, each on springs between its neighbours.
fn springs(n: usize) -> String {
    format!(
        "mechanism Springs {{
            param m[{n}]: kg = 2; param k: N/m = 30; coord x[{n}]: m; input u: N;
            for i in 0..{n} {{ kinetic += m[i]*dt(x[i])^2/2; }}
            for i in 0..{} {{ potential += k*(x[i + 1] - x[i])^2/2; }}
            force x[0] += u;
        }}",
        n - 1
    )
}

/// Pendulums below a cart, whose mass matrix has entries in the first row, the first column and the diagonal.
fn cart(n: usize) -> String {
    format!(
        "mechanism Cart {{
            param m: kg = 2; param l: m = 0.5; param g: m/s^2 = 9.81; coord x: m; coord phi[{n}]: rad; input u: N;
            kinetic += 10 kg*dt(x)^2/2;
            for i in 0..{n} {{
                kinetic += m*(dt(x + l*sin(phi[i]))^2 + dt(l*cos(phi[i]))^2)/2;
                potential += -m*g*l*cos(phi[i]);
            }}
            force x += u;
        }}"
    )
}

/// Numbers without a pattern, within ±1.
fn numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| 2.0 * ((i as f64 + seed) * 0.618_033_988_749_894_9).fract() - 1.0).collect()
}

fn with_analysis(text: &str, check: impl FnOnce(&Analysis<'_>)) {
    let graph = Graph::verbatim();
    check(&Analysis::of(&Sources::new("sparse.mbs", text), &graph).expect("a derivation"));
}

/// `mᵢ ẍᵢ = k (xᵢ₊₁ − 2 xᵢ + xᵢ₋₁)`, at the ends with one spring.
#[test]
fn masses_on_springs_are_accelerated_by_their_neighbours_alone() {
    let n = 40;
    with_analysis(&springs(n), |analysis| {
        let programs = analysis.programs();
        let accelerations = programs.function(FunctionKind::ForwardDynamics).expect("accelerations");
        assert_eq!(accelerations.completion, Completion::None);
        let operations = accelerations.operations;
        assert!(operations.flops() + operations.div <= 5 * n, "{operations:?}");
        let masses: Vec<f64> = numbers(n, 0.1).iter().map(|x| 2.0 + x).collect();
        let (k, q, qd, u) = (30.0, numbers(n, 0.2), numbers(n, 0.3), 0.7);
        let state = State { t: 0.0, q: q.clone(), qd, qdd: vec![0.0; n], u: vec![u], prescribed: Vec::new() };
        let parameters = masses.iter().copied().chain([k]).collect();
        let interpreter = Interpreter::with_parameters(programs, parameters);
        let found = interpreter.call(FunctionKind::ForwardDynamics, &state).expect("accelerations");
        for i in 0..n {
            let from = |j: usize| k * (q[j] - q[i]);
            let before = if i > 0 { from(i - 1) } else { u };
            let behind = if i + 1 < n { from(i + 1) } else { 0.0 };
            assert!((masses[i] * found[i] - before - behind).abs() < 1e-12, "{i}: {}", found[i]);
        }
        // M⁻¹ K is written out, too.
        let linearization = programs.function(FunctionKind::Linearize).expect("a linearization");
        assert_eq!(linearization.completion, Completion::None);
    });
}

/// `(M + n m) ẍ + m l Σ (φ̈ cos φ − φ̇² sin φ) = u`, `l φ̈ + ẍ cos φ + g sin φ = 0`: ẍ by hand, then each φ̈.
#[test]
fn pendulums_below_a_cart_are_eliminated_before_the_cart() {
    let n = 16;
    with_analysis(&cart(n), |analysis| {
        let programs = analysis.programs();
        let accelerations = programs.function(FunctionKind::ForwardDynamics).expect("accelerations");
        assert_eq!(accelerations.completion, Completion::None);
        let (m, l, g, u) = (2.0, 0.5, 9.81, -3.0);
        let angles: Vec<f64> = numbers(n, 0.4).iter().map(|x| 3.0 * x).collect();
        let rates = numbers(n, 0.6);
        let state = State {
            t: 0.0,
            q: [&[0.3], angles.as_slice()].concat(),
            qd: [&[-0.2], rates.as_slice()].concat(),
            qdd: vec![0.0; n + 1],
            u: vec![u],
            prescribed: Vec::new(),
        };
        let found = Interpreter::<f64>::new(programs).call(FunctionKind::ForwardDynamics, &state);
        let found = found.expect("accelerations");
        let sum = |term: &dyn Fn(f64, f64) -> f64| angles.iter().zip(&rates).map(|(&a, &w)| term(a, w)).sum::<f64>();
        let inertia = 10.0 + sum(&|angle, _| m * angle.sin().powi(2));
        let force = u + sum(&|angle, rate| m * angle.sin() * (l * rate * rate + g * angle.cos()));
        let cart = force / inertia;
        assert!((found[0] - cart).abs() < 1e-12, "{} instead of {cart}", found[0]);
        for (i, &angle) in angles.iter().enumerate() {
            let expected = -(cart * angle.cos() + g * angle.sin()) / l;
            assert!((found[i + 1] - expected).abs() < 1e-11, "{i}: {} instead of {expected}", found[i + 1]);
        }
    });
}

/// Of more than a hundred coordinates M is left out where it is mostly zero, but for a mechanism with outputs.
#[test]
fn outputs_of_many_masses_stay() {
    let without = springs(120);
    let with = without.replace("force x[0]", "output end = x[119]; force x[0]");
    let has = |text: &str, kind| {
        let mut found = false;
        with_analysis(text, |analysis| found = analysis.programs().function(kind).is_some());
        found
    };
    assert!(!has(&without, FunctionKind::MassMatrix) && has(&without, FunctionKind::ForwardDynamics));
    assert!(has(&with, FunctionKind::MassMatrix));
    with_analysis(&with, |analysis| assert!(analysis.programs().named("end").is_some()));
}

/// Written out, each mass takes two lines; the full matrix alone would have 90 000 entries.
#[test]
fn three_hundred_masses_take_few_lines() {
    let options = Options::default().functions(["forward_dynamics"]);
    let text = springs(300).replace("m[300]", "m").replace("m[i]", "m");
    let code = mbs_derive::generate("springs.mbs", &text, &options).expect("a derivation").code;
    assert!(code.len() < 60_000, "{} bytes", code.len());
    assert!(!code.contains("ldlt_solve"));
}
