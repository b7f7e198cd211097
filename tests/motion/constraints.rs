//! Constraints of every mechanism: `A` and `γ` against numerical differences of the constraint along motions, and the
//! compiled functions against the interpreted ones.

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::model::ConstraintKind;
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{declared, derived};
use mbs_tests::compare::{assert_close, error};
use mbs_tests::random::{Random, State, states};

/// A bead on a wire that sways, slows down along x and is driven round at run time: constraints with `b`, of both
/// kinds.
const SWAYING: &str = "mechanism Swaying {
    param m: kg = 0.3; param l: m = 0.8; param omega: 1/s = 2;
    coord r[3]: m; coord phi: rad;
    prescribed drive: rad;
    prescribed height: m = l*sin(omega*t);
    kinetic += particle(m, r) + 1/2*m*l^2*dt(phi)^2;
    constraint wire: [r[0], r[1]] = [l*cos(phi + drive), (l + height)*sin(phi)];
    constraint sway: dt(r[2]) - height*dt(phi) = omega*height + l*dt(drive);
}";

/// Every mechanism of the repository that has constraints, and [`SWAYING`].
fn constrained() -> Vec<(&'static str, &'static str)> {
    let sources = mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES).copied();
    let chosen = sources.filter(|(_, source)| source.contains("\n    constraint "));
    chosen.chain([("swaying", SWAYING)]).collect()
}

#[test]
fn some_mechanisms_are_constrained() {
    let modules: Vec<&str> = constrained().iter().map(|(module, _)| *module).collect();
    let expected = [
        "four_bar",
        "quadrotor_quaternion",
        "bouncing_pendulum",
        "cartesian_pendulum",
        "chaplygin_sleigh",
        "four_bar_with_reactions",
        "loop_",
        "knife_edge",
        "rolling_coin",
        "slider_crank",
        "whipple_bicycle",
        "swaying",
    ];
    assert_eq!(modules, expected);
}

/// Along `q(s) = q + s q̇ + ½ s² q̈` at t + s: a holonomic φ has the slope `A q̇ + b` and the curvature `A q̈ + γ`; a
/// Pfaffian `A q̇ + b` has the slope `A q̈ + γ`, and A is its derivative by q̇.
#[test]
fn jacobian_and_bias_are_differences_along_motions() {
    for (module, source) in constrained() {
        let graph = Graph::verbatim();
        let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render(module, source)));
        let derivation = derived(&lagrangian);
        let along = Along { interpreter: Interpreter::new(&derivation) };
        let kinds: Vec<ConstraintKind> =
            lagrangian.constraints.iter().flat_map(|c| c.rows.iter().map(|_| c.kind)).collect();
        // The bicycle has the most coordinates, eight.
        for State { q, qd, qdd } in states::<8>(31, 24) {
            let n = derivation.dof();
            let [q, qd, qdd] = [q, qd, qdd].map(|values| values[..n].to_vec());
            let prescribed = derivation.prescribed.iter().map(|_| [0.4, -0.7, 1.3]).collect();
            let u = vec![0.0; derivation.inputs.len()];
            let state = interpret::State { t: 0.6, q, qd, qdd, u, prescribed };
            along.check(module, &kinds, &state);
        }
    }
}

struct Along<'d> {
    interpreter: Interpreter<'d>,
}

/// Five-point formulas at this step err by some h⁴ and by rounding over h².
const STEP: f64 = 2e-3;
const TOLERANCE: f64 = 1e-7;

impl Along<'_> {
    fn call(&self, kind: FunctionKind, state: &interpret::State) -> Vec<f64> {
        self.interpreter.call(kind, state).expect("generated where there are constraints")
    }

    fn check(&self, module: &str, kinds: &[ConstraintKind], state: &interpret::State) {
        let n = state.q.len();
        let jacobian = self.call(FunctionKind::ConstraintJacobian, state);
        let gamma = self.call(FunctionKind::ConstraintBias, state);
        let [f0, f1, f2, f3, f4] =
            [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| self.call(FunctionKind::Constraint, &moved(state, k * STEP)));
        for (row, kind) in kinds.iter().enumerate() {
            let a = &jacobian[row * n..][..n];
            let dot = |x: &[f64]| a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
            let f = [&f0, &f1, &f2, &f3, &f4].map(|f| f[row]);
            let slope = (f[0] - 8.0 * f[1] + 8.0 * f[3] - f[4]) / (12.0 * STEP);
            let curvature = (-f[0] + 16.0 * f[1] - 30.0 * f[2] + 16.0 * f[3] - f[4]) / (12.0 * STEP * STEP);
            let acceleration = dot(&state.qdd) + gamma[row];
            let (rate, varied): (f64, fn(&mut interpret::State) -> &mut Vec<f64>) = match kind {
                ConstraintKind::Holonomic => (curvature, |state| &mut state.q),
                ConstraintKind::Pfaffian => (slope, |state| &mut state.qd),
            };
            assert_close(&format!("{module} {row}: A q̈ + γ"), &[acceleration], &[rate], 10.0 * TOLERANCE);
            if *kind == ConstraintKind::Holonomic {
                let held = self.explicit_rate(state, row);
                assert_close(&format!("{module} {row}: A q̇ + b"), &[dot(&state.qd) + held], &[slope], TOLERANCE);
            }
            for column in 0..n {
                let at = |k: f64| {
                    let mut state = state.clone();
                    varied(&mut state)[column] += k * STEP;
                    self.call(FunctionKind::Constraint, &state)[row]
                };
                let slope = (at(-2.0) - 8.0 * at(-1.0) + 8.0 * at(1.0) - at(2.0)) / (12.0 * STEP);
                assert_close(&format!("{module} {row}: A {column}"), &[a[column]], &[slope], TOLERANCE);
            }
        }
    }

    /// `b`: the slope of φ while the coordinates are held.
    fn explicit_rate(&self, state: &interpret::State, row: usize) -> f64 {
        let n = state.q.len();
        let held = interpret::State { qd: vec![0.0; n], qdd: vec![0.0; n], ..state.clone() };
        let f = [-2.0, -1.0, 1.0, 2.0].map(|k| self.call(FunctionKind::Constraint, &moved(&held, k * STEP))[row]);
        (f[0] - 8.0 * f[1] + 8.0 * f[2] - f[3]) / (12.0 * STEP)
    }
}

/// The state after `s`, on a parabola in the coordinates and in the motions that are prescribed.
fn moved(state: &interpret::State, s: f64) -> interpret::State {
    let parabola = |x: f64, rate: f64, acceleration: f64| x + s * rate + 0.5 * s * s * acceleration;
    let n = state.q.len();
    interpret::State {
        t: state.t + s,
        q: (0..n).map(|i| parabola(state.q[i], state.qd[i], state.qdd[i])).collect(),
        qd: (0..n).map(|i| state.qd[i] + s * state.qdd[i]).collect(),
        prescribed: state.prescribed.iter().map(|&[x, v, a]| [parabola(x, v, a), v + s * a, a]).collect(),
        ..state.clone()
    }
}

macro_rules! compiled_is_interpreted {
    ($($test:ident: $mechanism:ty, $n:literal $u:literal, ($($input:ident)?);)*) => {$(
        #[test]
        fn $test() {
            let mechanism = <$mechanism>::default();
            let mut random = Random::new(17);
            let (module, source) =
                *constrained().iter().find(|(module, _)| *module == stringify!($test)).expect("a file of this name");
            let graph = Graph::verbatim();
            let (lagrangian, _) = declared(source, &graph, &[]).expect(module);
            let derivation = derived(&lagrangian);
            let interpreter = Interpreter::new(&derivation);
            for State { q, qd, .. } in states::<$n>(33, 30) {
                let u = random.array::<$u>(-5.0..5.0);
                let [q_flat, qd_flat, u_flat] = [&q[..], &qd, &u].map(<[f64]>::to_vec);
                let state = interpret::State { q: q_flat, qd: qd_flat, u: u_flat, ..interpret::State::default() };
                let same = |kind: FunctionKind, compiled: &[f64]| {
                    let (name, interpreted) = (kind.name(), interpreter.call(kind, &state).expect("generated where there are constraints"));
                    // A wheel that lies on the ground has no lowest point.
                    let undefined = interpreted.iter().any(|x| x.is_nan()) && compiled.iter().any(|x| x.is_nan());
                    let agrees = undefined || error(compiled, &interpreted) <= 1e-12;
                    assert!(agrees, "{name}: {compiled:?} {interpreted:?} at {state:?}");
                };
                same(FunctionKind::Constraint, &mechanism.constraint(&q, &qd));
                same(FunctionKind::ConstraintRate, &mechanism.constraint_rate(&q, &qd));
                same(FunctionKind::ConstraintRateJacobian, &mechanism.constraint_rate_jacobian(&q, &qd).concat());
                same(FunctionKind::ConstraintJacobian, &mechanism.constraint_jacobian(&q).concat());
                same(FunctionKind::ConstraintBias, &mechanism.constraint_bias(&q, &qd));
                $(let $input = &u;)?
                let multipliers = mechanism.multipliers(&q, &qd $(, $input)?);
                if multipliers.iter().all(|lambda| lambda.is_finite()) {
                    same(FunctionKind::Multipliers, &multipliers);
                }
            }
        }
    )*};
}
compiled_is_interpreted! {
    four_bar: mbs_models::four_bar::FourBar<f64>, 3 1, (inputs);
    bouncing_pendulum: mbs_tests::mechanisms::bouncing_pendulum::BouncingPendulum<f64>, 3 0, ();
    cartesian_pendulum: mbs_tests::mechanisms::cartesian_pendulum::CartesianPendulum<f64>, 2 0, ();
    chaplygin_sleigh: mbs_tests::mechanisms::chaplygin_sleigh::ChaplyginSleigh<f64>, 3 2, (inputs);
    knife_edge: mbs_tests::mechanisms::knife_edge::KnifeEdge<f64>, 3 0, ();
    rolling_coin: mbs_tests::mechanisms::rolling_coin::RollingCoin<f64>, 5 0, ();
    slider_crank: mbs_tests::mechanisms::slider_crank::SliderCrank<f64>, 3 2, (inputs);
    whipple_bicycle: mbs_tests::mechanisms::whipple_bicycle::WhippleBicycle<f64>, 8 2, (inputs);
}
