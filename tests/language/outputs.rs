//! Outputs against what they are derivatives of: velocities, Jacobians and the rates of Jacobians, of every shape, of
//! outputs that move by themselves, interpreted and compiled.

use mbs_derive::expr::{Dual, Graph, Number, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::{declared, derived};
use mbs_models::spherical_pendulum::SphericalPendulum;
use mbs_runtime::Dual as RuntimeDual;
use mbs_tests::compare::assert_close;
use mbs_tests::named;

/// Outputs of every shape, one of which stands still; t, a prescribed formula and a prescribed signal move them.
const SHAPES: &str = "
mechanism Shapes {
    param m: kg = 1;
    param l: m = 0.5;
    param w: 1/s = 3;
    coord x: m;
    coord a: rad;
    coord b: rad;
    prescribed drive: m;
    prescribed lift: m = l*sin(w*t);
    let base = translation([x, drive, lift]) * rot_z(w*t);
    let hand = base * rot_y(a) * translation([l, 0, 0]) * rot_x(b + drive/l);
    kinetic += 1/2*m*dt(x)^2 + rigid_body(m, [0, 0, l/2], diag(1, 1, 1)*m*l^2, hand);
    output number = sqrt(x^2 + l^2)*cos(a)*sin(w*t), jacobian_rate;
    output place = hand.point([0, l, l]), jacobian_rate;
    output matrix = hand.rotation(), jacobian_rate;
    output pose = hand, jacobian_rate;
    output rows = [[x*drive, a], [b^3, dt(drive)*x]], jacobian_rate;
    output fixed = [l, 0, 2*l], jacobian_rate;
    output plain = x*a;
}";

fn derivation(source: &str) -> Derivation {
    let graph = Graph::verbatim();
    let (lagrangian, warnings) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
    assert_eq!(warnings.render("", source), "");
    derived(&lagrangian)
}

fn state() -> State {
    State {
        t: 0.4,
        q: vec![0.3, -0.7, 1.1],
        qd: vec![0.5, 0.8, -0.6],
        qdd: vec![-0.2, 1.3, 0.9],
        u: Vec::new(),
        prescribed: vec![[0.2, -0.4, 0.6]],
    }
}

/// The state a time h later.
fn moved(state: &State, h: f64) -> State {
    let step = |x: &[f64], v: &[f64]| x.iter().zip(v).map(|(x, v)| x + h * v).collect();
    let prescribed = state.prescribed.iter().map(|[s, v, a]| [s + h * v + h * h * a / 2.0, v + h * a, *a]).collect();
    let qd = step(&state.qd, &state.qdd);
    let halfway: Vec<f64> = state.qd.iter().zip(&qd).map(|(a, b)| (a + b) / 2.0).collect();
    State { t: state.t + h, q: step(&state.q, &halfway), qd, prescribed, ..state.clone() }
}

/// The state with its time derivative.
fn moving<V: Value>(state: &State<V>) -> State<Dual<V>> {
    let zero = V::constant(0.0);
    let pairs = |x: &[V], v: &[V]| x.iter().zip(v).map(|(&x, &v)| Dual::new(x, v)).collect();
    State {
        t: Dual::new(state.t, V::constant(1.0)),
        q: pairs(&state.q, &state.qd),
        qd: pairs(&state.qd, &state.qdd),
        qdd: state.qdd.iter().map(|&a| Dual::fixed(a)).collect(),
        u: Vec::new(),
        prescribed: state
            .prescribed
            .iter()
            .map(|&[s, v, a]| [Dual::new(s, v), Dual::new(v, a), Dual::new(a, zero)])
            .collect(),
    }
}

/// Over any kind of number, with the declared parameters.
fn interpreter<V: Value>(derivation: &Derivation) -> Interpreter<'_, V> {
    let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults);
    Interpreter::with_parameters(derivation, defaults.copied().map(Number::to_f64).map(V::constant).collect())
}

/// The outputs whose rates are generated.
fn requested(derivation: &Derivation) -> Vec<&str> {
    let rate = |kind: &FunctionKind| matches!(kind, FunctionKind::OutputJacobianRate(_));
    let rates = derivation.functions.iter().filter(|f| rate(&f.kind));
    rates.map(|f| f.name.strip_suffix("_jacobian_rate").expect("its name")).collect()
}

#[test]
fn rates_are_generated_where_they_are_asked_for() {
    let derivation = derivation(SHAPES);
    assert_eq!(requested(&derivation), ["number", "place", "matrix", "pose", "rows", "fixed"]);
    for name in requested(&derivation) {
        let shape = |suffix: &str| derivation.named(&format!("{name}{suffix}")).expect("generated").results.clone();
        assert_eq!(shape("_jacobian_rate"), shape("_jacobian"), "{name}");
    }
}

/// Central differences of the Jacobian along the motion.
#[test]
fn a_rate_is_the_slope_of_the_jacobian() {
    let derivation = derivation(SHAPES);
    let (interpreter, state, h) = (Interpreter::new(&derivation), state(), 1e-5);
    for name in requested(&derivation) {
        let jacobian = |h: f64| named(&interpreter, &format!("{name}_jacobian"), &moved(&state, h)).expect("generated");
        let slope: Vec<f64> = jacobian(h).iter().zip(jacobian(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        let rate = named(&interpreter, &format!("{name}_jacobian_rate"), &state).expect("generated");
        assert_close(name, &rate, &slope, 1e-8);
        assert_eq!(rate.iter().all(|entry| *entry == 0.0), name == "fixed", "{name}");
    }
}

/// With the velocity `J q̇ + b`: the acceleration is `J q̈ + J̇ q̇ + ḃ`, by first derivatives of the velocity, and by
/// second derivatives of the value.
#[test]
fn accelerations_follow_from_the_rate() {
    let derivation = derivation(SHAPES);
    let (plain, once) = (Interpreter::new(&derivation), interpreter::<Dual<f64>>(&derivation));
    let twice = interpreter::<Dual<Dual<f64>>>(&derivation);
    let state = state();
    let along = moving(&state);
    for name in requested(&derivation) {
        let call = |suffix: &str| named(&plain, &format!("{name}{suffix}"), &state).expect("generated");
        let slope = |suffix: &str, state: &State<Dual<f64>>| -> Vec<f64> {
            let values = named(&once, &format!("{name}{suffix}"), state).expect("generated");
            values.iter().map(|v| v.derivative).collect()
        };
        // b is the velocity where q̇ = 0, at all times.
        let drift = slope("_velocity", &State { qd: vec![Dual::fixed(0.0); 3], ..along.clone() });
        let (jacobian, rate) = (call("_jacobian"), call("_jacobian_rate"));
        let row = |matrix: &[f64], i: usize, x: &[f64]| (0..3).map(|j| matrix[3 * i + j] * x[j]).sum::<f64>();
        let acceleration = |i: usize| row(&jacobian, i, &state.qdd) + row(&rate, i, &state.qd) + drift[i];
        let acceleration: Vec<f64> = (0..drift.len()).map(acceleration).collect();
        assert_close(name, &acceleration, &slope("_velocity", &along), 1e-12);

        let second = named(&twice, name, &moving(&along)).expect("generated");
        let second: Vec<f64> = second.iter().map(|v| v.derivative.derivative).collect();
        let places = if name == "pose" { 3 } else { second.len() };
        if name != "rows" {
            // There the second derivative of `dt(drive)` would be the third of `drive`.
            assert_close(name, &acceleration[..places], &second[..places], 1e-12);
        }
    }
}

/// The code that rustc compiles, by second derivatives in dual numbers.
#[test]
fn compiled_rates() {
    let pendulum = SphericalPendulum::<f64>::default();
    let dual = SphericalPendulum::<RuntimeDual<f64>>::default();
    let (q, qd) = ([0.7, -1.2], [0.9, 0.4]);
    let along = [0, 1].map(|i| RuntimeDual { value: q[i], derivative: qd[i] });
    let expected = dual.bob_position_jacobian(&along).map(|row| row.map(|entry| entry.derivative));
    assert_close("J̇", &pendulum.bob_position_jacobian_rate(&q, &qd).concat(), &expected.concat(), 1e-14);
}

/// A robot's flange, too.
#[test]
fn the_rate_of_a_robot_costs_three_jacobians() {
    let (_, source) = mbs_models::SOURCES.iter().find(|(module, _)| *module == "irb7600").expect("irb7600");
    let derivation = derivation(&source.replace("output flange = link;", "output flange = link, jacobian_rate;"));
    let flops = |name: &str| derivation.named(name).expect("generated").operations.flops();
    let (jacobian, rate) = (flops("flange_jacobian"), flops("flange_jacobian_rate"));
    assert!(rate <= 3 * jacobian, "{rate} for the rate, {jacobian} for the Jacobian");
    let state = State { prescribed: Vec::new(), q: vec![0.3, -0.2, 0.5, 0.1, 0.7, -0.4], ..state() };
    let state = State { qd: vec![0.2, 0.4, -0.5, 0.6, 0.1, 0.3], qdd: vec![0.0; 6], ..state };
    let rates = named(&interpreter::<Dual<f64>>(&derivation), "flange_jacobian", &moving(&state)).expect("generated");
    let expected: Vec<f64> = rates.iter().map(|v| v.derivative).collect();
    let found = named(&Interpreter::new(&derivation), "flange_jacobian_rate", &state).expect("generated");
    assert_close("flange", &found, &expected, 1e-13);
}

/// An output of rates and inputs has derivatives in both, and no other one has.
#[test]
fn derivatives_by_rates_and_inputs() {
    let source =
        "mechanism Winch { param m: kg = 2; param r: m = 0.3; coord x: m; coord a: rad; input f[2]: N; input tau: N*m;
        kinetic += 1/2*m*dt(x)^2 + 1/2*m*r^2*dt(a)^2; force x += f[0] - f[1]; force a += tau;
        output power = f[0]*dt(x) + tau*dt(a)*cos(a);
        output rates = [dt(x)*a, dt(a)^2];
        output loads = [[f[0]*x, r*f[1]], [tau/r, 0*f[0]]];
        output place = x*cos(a); }";
    let derivation = derivation(source);
    let state =
        State { q: vec![0.4, 0.6], qd: vec![1.5, -0.7], u: vec![3.0, 5.0, 7.0], qdd: vec![0.0; 2], ..State::default() };
    let interpreter = Interpreter::new(&derivation);
    let call = |name: &str| named(&interpreter, name, &state);
    let cos = 0.6_f64.cos();
    assert_eq!(call("power_jacobian_qd"), Some(vec![3.0, 7.0 * cos]));
    assert_eq!(call("power_jacobian_u"), Some(vec![1.5, 0.0, -0.7 * cos]));
    assert_eq!(call("rates_jacobian"), Some(vec![0.0, 1.5, 0.0, 0.0]));
    assert_eq!(call("rates_jacobian_qd"), Some(vec![0.6, 0.0, 0.0, -1.4]));
    assert_close(
        "loads",
        &call("loads_jacobian_u").unwrap(),
        &[0.4, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 1.0 / 0.3, 0.0, 0.0, 0.0],
        1e-15,
    );
    for absent in ["rates_jacobian_u", "loads_jacobian_qd", "place_jacobian_qd", "place_jacobian_u"] {
        assert_eq!(call(absent), None, "{absent}");
    }
    let (taken, graph) = (source.replace("place = x*cos(a)", "power_jacobian_u = x"), Graph::verbatim());
    let report = declared(&taken, &graph, &[]).expect_err("a name taken").render("", &taken);
    assert!(report.contains("there is already an output `power`"), "{report}");
}

/// Compiled: `∂(r × v)/∂v = r×`.
#[test]
fn an_angular_momentum_by_the_velocity() {
    let kepler = mbs_models::kepler::Kepler::<f64>::default();
    let (q, qd) = ([0.3, -0.8, 0.5], [1.1, 0.2, -0.4]);
    let [x, y, z] = q;
    let expected = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    assert_eq!(kepler.angular_momentum_jacobian_qd(&q).map(|row| row.map(|entry| entry + 0.0)), expected);
    assert_eq!(kepler.angular_momentum(&q, &qd)[2], x * qd[1] - y * qd[0]);
}
