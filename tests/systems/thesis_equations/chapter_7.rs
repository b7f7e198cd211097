//! (7.1)–(7.3) with several constraints and with b_i, (7.12): typed as corrected, against generated mechanisms.

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{declared, derived};
use mbs_models::kepler::Kepler;
use mbs_models::relative_cylindrical::{self, RelativeCylindrical};
use mbs_orbit::EARTH_MU;
use mbs_tests::compare::assert_close;
use mbs_tests::mechanisms::cartesian_pendulum::CartesianPendulum;
use mbs_tests::mechanisms::knife_edge::KnifeEdge;
use mbs_tests::mechanisms::rolling_coin::{self, RollingCoin};
use mbs_tests::mechanisms::slider_crank::{self, SliderCrank};
use mbs_tests::random::Random;
use mbs_tests::reference::lagrange::{Dual, Energies, Number, euler_lagrange};
use nalgebra::{Matrix4, Vector4};

use super::assert_shown;

const G: f64 = 9.80665;

/// A coin by its energies: x, y, heading φ, lean θ, spin ψ.
struct Coin(rolling_coin::Params<f64>);

impl Energies<5> for Coin {
    fn kinetic<S: Number>(&self, &[_, _, _, theta, _]: &[S; 5], &[xd, yd, turn, lean, spin]: &[S; 5]) -> S {
        let p = &self.0;
        let (sink, round) = (theta.sin() * lean * p.radius, turn * theta.cos());
        let about_axis = spin + turn * theta.sin();
        (xd * xd + yd * yd + sink * sink) * (0.5 * p.m)
            + (lean * lean + round * round) * (0.5 * p.transverse)
            + about_axis * about_axis * (0.5 * p.axial)
    }

    fn potential<S: Number>(&self, &[_, _, _, theta, _]: &[S; 5]) -> S {
        theta.cos() * (self.0.m * self.0.g * self.0.radius)
    }
}

/// (7.1) and (7.2) for h = 5 coordinates and p = 2 nonholonomic constraints: along the generated motion the left sides,
/// by nested dual numbers over the energies, are Σ λ_i a_ik with the generated λ_i.
#[test]
fn equations_7_1_and_7_2_of_a_rolling_coin() {
    // In units of a coin: of a metre and a kilogram all terms count.
    let p = rolling_coin::Params { m: 0.7, radius: 0.4, axial: 0.09, transverse: 0.05, g: 9.81 };
    let (coin, mut random) = (RollingCoin::new(p), Random::new(71));
    for _ in 0..100 {
        let mut q: [f64; 5] = random.array(-1.2..1.2);
        q[2] *= 2.0;
        let [turn, lean, spin]: [f64; 3] = random.array(-3.0..3.0);
        let ((sf, cf), (s, c), r) = (q[2].sin_cos(), q[3].sin_cos(), p.radius);
        // The point that touches the table rests.
        let a = [[1.0, 0.0, -r * s * cf, -r * sf * c, -r * cf], [0.0, 1.0, -r * s * sf, r * cf * c, -r * sf]];
        let slid = |row: &[f64; 5]| -(row[2] * turn + row[3] * lean + row[4] * spin);
        let qd = [slid(&a[0]), slid(&a[1]), turn, lean, spin];
        assert_close("a_ik", &coin.constraint_jacobian(&q).concat(), &a.concat(), 1e-15);
        let sums = a.map(|row| (0..5).map(|k| row[k] * qd[k]).sum::<f64>());
        assert_close("(7.2)", &sums, &[0.0; 2], 1e-15);
        assert_close("the generated rows", &coin.constraint_rate(&q, &qd), &[0.0; 2], 1e-14);

        let (qdd, lambda) = (coin.forward_dynamics(&q, &qd), coin.multipliers(&q, &qd));
        let right: [f64; 5] = std::array::from_fn(|k| lambda[0] * a[0][k] + lambda[1] * a[1][k]);
        assert_close("(7.1)", &euler_lagrange(&Coin(p), &q, &qd, &qdd), &right, 1e-11);
    }
}

/// A slider-crank by its energies: angles of crank and rod, place of the piston.
struct Engine(slider_crank::Params<f64>);

impl Energies<3> for Engine {
    fn kinetic<S: Number>(&self, &[q1, q2, _]: &[S; 3], &[w1, w2, v]: &[S; 3]) -> S {
        let ([m1, m2, m3], [r, l]) = (self.0.m, self.0.l);
        w1 * w1 * (0.5 * (m1 / 3.0 + m2) * r * r)
            + w2 * w2 * (m2 * l * l / 6.0)
            + (q1 - q2).cos() * w1 * w2 * (0.5 * m2 * r * l)
            + v * v * (0.5 * m3)
    }

    fn potential<S: Number>(&self, &[q1, q2, _]: &[S; 3]) -> S {
        let ([m1, m2, _], [r, l], g) = (self.0.m, self.0.l, self.0.g);
        q1.sin() * ((0.5 * m1 + m2) * g * r) + q2.sin() * (0.5 * m2 * g * l)
    }
}

/// (7.3) for two closed loops' rows Φ_i: ∂U_Φ/∂q with U_Φ = Σ λ_i Φ_i, the generated λ_i held.
#[test]
fn equation_7_3_of_a_slider_crank() {
    let p = slider_crank::Params { m: [0.9, 0.6, 0.5], l: [0.3, 1.1], offset: 0.1, g: 9.81, c: 0.8 };
    let (engine, mut random, [r, l]) = (SliderCrank::new(p), Random::new(73), p.l);
    for _ in 0..100 {
        let (crank, rate): (f64, f64) = (random.uniform(-3.0..3.0), random.uniform(-5.0..5.0));
        let rod = ((p.offset - r * crank.sin()) / l).asin();
        let q = [crank, rod, r * crank.cos() + l * rod.cos()];
        let swing = -r * crank.cos() / (l * rod.cos()) * rate;
        let qd = [rate, swing, -r * crank.sin() * rate - l * rod.sin() * swing];
        let [tau, gas]: [f64; 2] = random.array(-8.0..8.0);
        let (qdd, lambda) = (engine.forward_dynamics(&q, &qd, &[tau, gas]), engine.multipliers(&q, &qd, &[tau, gas]));
        let u_phi = |q: [Dual<f64>; 3]| {
            let phi = [q[0].cos() * r + q[1].cos() * l - q[2], q[0].sin() * r + q[1].sin() * l];
            phi[0] * lambda[0] + phi[1] * lambda[1]
        };
        let force = [tau, 0.0, -gas - p.c * qd[2]];
        let right: [f64; 3] = std::array::from_fn(|k| {
            let moved = std::array::from_fn(|i| Dual { value: q[i], derivative: f64::from(u8::from(i == k)) });
            force[k] + u_phi(moved).derivative
        });
        assert_close("(7.3)", &euler_lagrange(&Engine(p), &q, &qd, &qdd), &right, 1e-11);
    }
}

/// A knife edge on a belt that runs across: the blade's velocity against the belt is along it.
const BELT: &str = "
mechanism Belt {
    param m: kg = 2;
    param moment: kg*m^2 = 0.3;
    param belt: m/s = 0.8;
    coord x: m;
    coord y: m;
    coord phi: rad;
    input push: N;
    kinetic += particle(m, [x, y, 0]) + 1/2*moment*dt(phi)^2;
    force x += push;
    constraint blade: dt(x)*sin(phi) - (dt(y) - belt)*cos(phi) = 0;
}";

/// (7.2) with b = v cos φ, which is not zero: the Programs that Rust is printed from are interpreted.
#[test]
fn equation_7_2_with_its_last_term() {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(BELT, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("belt", BELT)));
    let derivation = derived(&lagrangian);
    let (program, mut random) = (Interpreter::new(&derivation), Random::new(72));
    for _ in 0..50 {
        let [phi, along, turn, push]: [f64; 4] = random.array(-2.0..2.0);
        let (sin, cos) = phi.sin_cos();
        let [xd, yd] = [along * cos, along * sin + 0.8];
        let (q, qd) = (vec![0.4, -0.1, phi], vec![xd, yd, turn]);
        let state = interpret::State { t: 0.0, q, qd, qdd: vec![0.0; 3], u: vec![push], prescribed: Vec::new() };
        let call = |kind| program.call(kind, &state).expect("a mechanism with constraints has it");
        let a = [sin, -cos, 0.0];
        let sum = a[0] * xd + a[1] * yd + 0.8 * cos;
        assert_close("(7.2)", &[sum], &[0.0], 1e-15);
        assert_close("generated", &call(FunctionKind::ConstraintRate), &[sum], 1e-15);
        // m ẍ = push + λ a_x, m ÿ = λ a_y, I φ̈ = 0, and the rate of (7.2).
        let mut system = Matrix4::from_diagonal(&Vector4::new(2.0, 2.0, 0.3, 0.0));
        (0..3).for_each(|k| (system[(k, 3)], system[(3, k)]) = (-a[k], a[k]));
        let bias = (xd * cos + yd * sin - 0.8 * sin) * turn;
        let solution = system.lu().solve(&Vector4::new(push, 0.0, 0.0, -bias)).expect("regular");
        assert_close("q̈ of (7.1)", &call(FunctionKind::ForwardDynamics), &solution.as_slice()[..3], 1e-13);
        assert_close("λ of (7.1)", &call(FunctionKind::Multipliers), &solution.as_slice()[3..], 1e-13);
    }
}

/// (7.1) and (7.3) in the numbers of the page: the knife edge at φ = 0.5 rad, 1.2 m/s along and 0.7 rad/s; the pendulum
/// 0.8 rad off, at 1.5 m/s.
#[test]
fn equations_7_1_and_7_3_in_numbers() {
    let edge = KnifeEdge::<f64>::default();
    let (sin, cos) = 0.5_f64.sin_cos();
    let (q, qd) = ([0.0, 0.0, 0.5], [1.2 * cos, 1.2 * sin, 0.7]);
    let pull = G * 20_f64.to_radians().sin();
    // Across the blade ẍ sin φ − ÿ cos φ = −v φ̇, of which the weight has pull · sin φ.
    let lambda = -1.2 * 0.7 - pull * sin;
    let typed = [pull + lambda * sin, -lambda * cos, 0.0, lambda];
    let generated = [&edge.forward_dynamics(&q, &qd)[..], &edge.multipliers(&q, &qd)].concat();
    assert_close("(7.1)", &typed, &generated, 1e-14);
    assert_shown(7, &generated[..3], 6);
    assert_shown(7, &generated[3..], 6);

    let pendulum = CartesianPendulum::<f64>::default();
    let (sin, cos) = 0.8_f64.sin_cos();
    let (q, qd) = ([sin, -cos], [1.5 * cos, 1.5 * sin]);
    let lambda = -(G * cos + 1.5 * 1.5);
    let typed = [lambda * sin, -G - lambda * cos, lambda];
    let generated = [&pendulum.forward_dynamics(&q, &qd)[..], &pendulum.multipliers(&q, &qd)].concat();
    assert_close("(7.3)", &typed, &generated, 1e-14);
    assert_shown(7, &generated[..2], 6);
    assert_shown(7, &generated[2..], 6);
}

/// (7.12): at this rate, and at no other, a body goes round by the generated equations of Kepler's problem, and one on
/// the station's circle stays where it is beside the station.
#[test]
fn equation_7_12_is_the_rate_of_the_generated_motions() {
    for radius in [6_778_137.0, 4.2164e7, 3.844e8_f64] {
        let omega = (EARTH_MU / radius.powi(3)).sqrt();
        let kepler = Kepler::<f64>::default();
        let (sin, cos) = 0.7_f64.sin_cos();
        let place = [radius * cos, radius * sin, 0.0];
        let velocity = [-radius * omega * sin, radius * omega * cos, 0.0];
        let found = kepler.forward_dynamics(&place, &velocity, &[0.0; 3]);
        assert_close("−ω² r", &found.map(|a| a / (omega * omega * radius)), &place.map(|x| -x / radius), 1e-15);
        let e = kepler.eccentricity(&place, &velocity);
        assert_close("a circle", &e, &[0.0; 3], 1e-15);

        // 0.3 rad ahead on the same circle: a chord from the station.
        let body = RelativeCylindrical::new(relative_cylindrical::Params {
            station_mass: 0.0,
            ..relative_cylindrical::Params::default()
        });
        let [x, y] = [radius * (0.3_f64.cos() - 1.0), radius * 0.3_f64.sin()];
        let beside = [x.hypot(y), y.atan2(x), 0.0];
        let still = |rate: f64| {
            let frame = [[radius, 0.0, 0.0], [0.4, rate, 0.0]];
            let [r, theta, z] = body.forward_dynamics(&frame, &beside, &[0.0; 3]);
            [r, theta * beside[0], z].map(|a| a / (omega * omega * radius))
        };
        assert_close("at rest", &still(omega), &[0.0; 3], 1e-14);
        assert!(still(1.01 * omega)[0].abs() > 1e-3, "1 % faster it does not stay");
    }
    let omega = (EARTH_MU / 6_778_137.0_f64.powi(3)).sqrt();
    assert_shown(7, &[omega * 1e3], 15);
}
