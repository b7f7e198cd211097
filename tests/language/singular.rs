//! Exact zeros, straight arms, coincident points: what is finite in mathematics is finite in the generated functions,
//! and what is not is warned of, where it stands.

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{declared, derived, emit, generate};

/// The results of a function of a mechanism at a state, and whether there is a warning about it.
fn results(source: &str, function: FunctionKind, q: &[f64], qd: &[f64]) -> (Vec<f64>, bool) {
    let generated = generate("case.mbs", source, &emit::Options::default());
    let warnings = generated.unwrap_or_else(|e| panic!("{}", e.render("case.mbs", source))).warnings;
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).expect("just generated");
    let derivation = derived(&lagrangian);
    let state = State {
        t: 0.0,
        q: q.to_vec(),
        qd: qd.to_vec(),
        qdd: vec![0.0; q.len()],
        u: vec![0.0; lagrangian.inputs.len()],
        prescribed: Vec::new(),
    };
    let found = Interpreter::new(&derivation).call(function, &state).expect("a function of the mechanism");
    let is_about_values =
        |line: &str| function == FunctionKind::Linearize || !line.contains("its linearization is NaN");
    let alarm = |line: &str| line.contains("is not finite where") || line.contains("0/0 where");
    (found, warnings.lines().any(|line| alarm(line) && is_about_values(line)))
}

/// A mechanism of two coordinates in a plane, with these statements.
fn plane(statements: &str) -> String {
    format!(
        "mechanism Plane {{ param m: kg = 2; param k: N/m = 3; param l: m = 0.5; coord x: m; coord y: m; {statements} }}"
    )
}

const KINETIC: &str = "kinetic += particle(m, [x, y, 0]);";

#[track_caller]
fn finite(source: &str, function: FunctionKind, [q, qd]: [&[f64]; 2], expected: &[f64]) {
    let (found, warned) = results(source, function, q, qd);
    let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()));
    assert!(found.len() == expected.len() && close, "{source}\n{function:?}: {found:?}, not {expected:?}");
    assert!(!warned, "{source}: a false alarm");
}

#[track_caller]
fn not_finite(source: &str, function: FunctionKind, [q, qd]: [&[f64]; 2]) {
    let (found, warned) = results(source, function, q, qd);
    assert!(found.iter().any(|value| !value.is_finite()), "{source}\n{function:?}: {found:?}");
    assert!(warned, "{source}: no warning");
}

const ZERO: [&[f64]; 2] = [&[0.0, 0.0], &[0.0, 0.0]];

/// Each root is met by its like before anything is differentiated.
#[test]
fn roots_that_are_squared_leave_no_trace() {
    for square in [
        "[x, y, 0].norm()^2",
        "[x, y, 0].norm()*[x, y, 0].norm()",
        "sqrt(x^2 + y^2)^2",
        "sqrt(x^2 + y^2)*sqrt(x^2 + y^2)",
        "hypot(x, y)^2",
        "abs(x)^2 + abs(y)*abs(y)",
        "hypot(x, y)^4/hypot(x, y)^2",
    ] {
        let source = plane(&format!("{KINETIC} potential += 1/2*k*({square});"));
        if !square.contains('/') {
            finite(&source, FunctionKind::Gravity, ZERO, &[0.0, 0.0]);
            finite(&source, FunctionKind::Linearize, ZERO, &[-1.5, 0.0, 0.0, -1.5, 0.0, 0.0, 0.0, 0.0]);
        }
        finite(&source, FunctionKind::Gravity, [&[0.25, -0.5], &[0.0, 0.0]], &[0.75, -1.5]);
    }
    for speed in ["abs(dt(x))^2 + dt(y)^2", "dt([x, y, 0]).norm()^2", "hypot(dt(x), dt(y))^2"] {
        finite(&plane(&format!("kinetic += 1/2*m*({speed});")), FunctionKind::MassMatrix, ZERO, &[2.0, 0.0, 0.0, 2.0]);
    }
}

#[test]
fn odd_powers_of_lengths_have_a_slope_at_zero() {
    let cubic = plane(&format!("{KINETIC} potential += k*[x, y, 0].norm()^3/l;"));
    finite(&cubic, FunctionKind::Gravity, ZERO, &[0.0, 0.0]);
    not_finite(&cubic, FunctionKind::Linearize, ZERO);
    let drag = plane(&format!("{KINETIC} const c: kg/m = 4; dissipation += c*dt([x, y, 0]).norm()^3/3;"));
    finite(&drag, FunctionKind::DissipationForce, ZERO, &[0.0, 0.0]);
    finite(&drag, FunctionKind::DissipationForce, [&[0.0, 0.0], &[3.0, 4.0]], &[60.0, 80.0]);
    let powers = plane(&format!("{KINETIC} potential += k*l^(2/3)*(x + l)^(4/3);"));
    finite(&powers, FunctionKind::Gravity, [&[-0.5, 0.0], &[0.0, 0.0]], &[0.0, 0.0]);
}

/// A stretched spring whose ends meet pulls in no direction.
#[test]
fn springs_between_coincident_points() {
    let spring = |length: &str| plane(&format!("{KINETIC} potential += spring(k, {length}, l);"));
    not_finite(&spring("[x, y, 0].norm()"), FunctionKind::Gravity, ZERO);
    not_finite(&spring("hypot(x, y)"), FunctionKind::ForwardDynamics, ZERO);
    finite(&spring("sqrt(x^2 + y^2 + l^2/10000)"), FunctionKind::Gravity, ZERO, &[0.0, 0.0]);
    finite(&spring("sqrt(x^2 + y^2 + l^2/10000)"), FunctionKind::ForwardDynamics, ZERO, &[0.0, 0.0]);
    let (found, warned) = results(&spring("(x - y)"), FunctionKind::Gravity, &[0.0, 0.0], &[0.0, 0.0]);
    assert!(!warned && found == [-1.5, 1.5], "{found:?}");
}

#[test]
fn quotients_and_angles_at_zero() {
    let wave = |v: &str| plane(&format!("{KINETIC} potential += k*l^2*({v});"));
    not_finite(&wave("sin(x/l)/(x/l)"), FunctionKind::Gravity, ZERO);
    finite(
        &wave("if x^2 < l^2/1000000 { 1 - (x/l)^2/6 } else { sin(x/l)/(x/l) }"),
        FunctionKind::Gravity,
        ZERO,
        &[0.0, 0.0],
    );
    not_finite(&wave("acos(cos(x/l))"), FunctionKind::Gravity, ZERO);
    finite(&wave("atan2(sin(x/l), cos(x/l))"), FunctionKind::Gravity, ZERO, &[1.5, 0.0]);
    let azimuth = plane(&format!("{KINETIC} output azimuth = atan2(y, x);"));
    not_finite(&azimuth, FunctionKind::OutputJacobian(0), ZERO);
}

/// The accelerations of a double pendulum, straight down, straight up and folded, at rest: none.
#[test]
fn straight_arms() {
    let (_, source) = mbs_models::SOURCES.iter().find(|(name, _)| *name == "double_pendulum").expect("a mechanism");
    let pi = std::f64::consts::PI;
    for q in [[0.0, 0.0], [pi, pi], [0.0, pi], [pi, 0.0]] {
        finite(source, FunctionKind::ForwardDynamics, [&q, &[0.0, 0.0]], &[0.0, 0.0]);
    }
    // Whirling straight: of equal rods the lower one pulls along itself.
    finite(source, FunctionKind::ForwardDynamics, [&[0.0, 0.0], &[3.0, 3.0]], &[0.0, 0.0]);
    let arm = "mechanism Arm { param m: kg = 1; param l: m = 1; coord q[2]: rad; \
               let a = rot_z(q[0]) * translation([l, 0, 0]); let tip = (a * rot_z(q[1])).point([l, 0, 0]); \
               kinetic += particle(m, a.origin()) + particle(m, tip); output reach = tip.norm(); }";
    finite(&arm.replace("output reach = tip.norm();", ""), FunctionKind::ForwardDynamics, ZERO, &[0.0, 0.0]);
    // Folded, its tip comes back to the base but for rounding: the Jacobian is noise.
    assert!(results(arm, FunctionKind::Output(0), &[0.3, pi], &[0.0, 0.0]).1);
}

/// At the pole the azimuth has no inertia; what does not divide by it is finite.
#[test]
fn a_spherical_pendulum_at_the_pole() {
    let (_, source) = mbs_models::SOURCES.iter().find(|(name, _)| *name == "spherical_pendulum").expect("a mechanism");
    let pole: [&[f64]; 2] = [&[0.0, 0.7], &[1.5, 0.4]];
    finite(source, FunctionKind::MassMatrix, pole, &[1.0, 0.0, 0.0, 0.0]);
    finite(source, FunctionKind::Gravity, pole, &[0.0, 0.0]);
    finite(source, FunctionKind::Bias, pole, &[0.0, 0.0]);
    finite(source, FunctionKind::InverseDynamics, pole, &[0.0, 0.0]);
    finite(source, FunctionKind::OutputVelocity(0), pole, &[1.5 * 0.7f64.cos(), 1.5 * 0.7f64.sin(), 0.0]);
}
