//! The quadrotor against Euler's equations typed by hand, its two declarations against each other, its landings against
//! the reference values.
//!
//! # Source
//!
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 5, corrected; the values were
//! computed by two integrators that share no code with this project (DOP853 and RK4 in Python).

use std::ops::ControlFlow;

use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::backstepping::Reference;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Controller, HEIGHT, Landing, Plant};
use mbs_landing::quadrotor::lqr::{Lqr, Weights};
use mbs_landing::quadrotor::mixer::{Effort, Mixer};
use mbs_models::check::{Invalid, Must};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_models::quadrotor_quaternion::{Params as QuaternionParams, QuadrotorQuaternion};
use mbs_models::{At, Error, Failure};
use mbs_runtime::{Dop853, Integrator, State};
use mbs_tests::random::{Random, states};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

pub(crate) const CALM: [[f64; 3]; 3] = [[0.0; 3]; 3];

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

/// `ω = T (φ̇, θ̇, ψ̇)`, in body axes.
pub(crate) fn rates(q: &[f64]) -> Matrix3<f64> {
    let ((sr, cr), (sp, cp)) = (q[3].sin_cos(), q[4].sin_cos());
    Matrix3::new(1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp)
}

/// Of the matrix, along the motion.
fn rates_dot(q: &[f64], qd: &[f64]) -> Matrix3<f64> {
    let ((sr, cr), (sp, cp), (r, p)) = (q[3].sin_cos(), q[4].sin_cos(), (qd[3], qd[4]));
    Matrix3::new(0.0, 0.0, -cp * p, 0.0, -sr * r, cr * cp * r - sr * sp * p, 0.0, -cr * r, -sr * cp * r - cr * sp * p)
}

/// `φ̈, θ̈, ψ̈` from Euler's equations, `I ω̇ + ω × (I ω + H e_z) = τ`.
pub(crate) fn euler(params: &Params<f64>, q: &[f64], qd: &[f64], torque: Vector3<f64>, spin: f64) -> Vector3<f64> {
    let tensor = Matrix3::from_diagonal(&Vector3::from(params.inertias));
    let t = rates(q);
    let angle_rates = Vector3::new(qd[3], qd[4], qd[5]);
    let w = t * angle_rates;
    let wd = Vector3::from_fn(|i, _| {
        let moment = torque - w.cross(&(tensor * w + Vector3::new(0.0, 0.0, spin)));
        moment[i] / params.inertias[i]
    });
    t.try_inverse().expect("away from θ = 90°") * (wd - rates_dot(q, qd) * angle_rates)
}

#[test]
fn the_attitude_obeys_eulers_equations() {
    let mut random = Random::new(17);
    for state in states::<6>(5, 200) {
        let params = Params { m: 3.0, inertias: [0.7, 1.1, 1.5], rotor_inertia: 0.03, ..Params::default() };
        let (mut q, qd) = (state.q, state.qd);
        q[4] = 1.3 * q[4].sin();
        let speeds: [f64; 4] = random.array(0.0..400.0);
        let effort = Mixer::new(&params).effort(&speeds);
        let spin = params.rotor_inertia * (speeds[1] + speeds[3] - speeds[0] - speeds[2]);
        let found = QuadrotorEuler::new(params).forward_dynamics(&CALM, &q, &qd, &speeds);
        let expected = euler(&params, &q, &qd, Vector3::from(effort.torque), spin);
        // The torques are of some 100 N·m, and angles near 90° take twice the division by cos θ.
        let size = expected.amax() + 100.0;
        (0..3).for_each(|i| close(found[3 + i], expected[i], 1e-12 * size / q[4].cos().powi(2)));
        let axis = Rotation3::from_euler_angles(q[3], q[4], q[5]) * Vector3::z();
        for i in 0..3 {
            let drag = -0.5 * params.air_density * params.area * qd[i].abs() * qd[i];
            let weight = if i == 2 { params.g } else { 0.0 };
            close(found[i], (effort.thrust * axis[i] + drag) / params.m - weight, 1e-12 * (1.0 + effort.thrust));
        }
    }
}

/// `quad.attitude_exact_point`. Only the product of the rotors' inertia and speed counts, so the torques fix the
/// speeds.
#[test]
fn the_point_of_the_reference() {
    let speeds = Mixer::new(&Params::default()).speeds(&Effort { thrust: 420.0, torque: [1.0, -2.0, 0.5] }).speed;
    let total = speeds[1] + speeds[3] - speeds[0] - speeds[2];
    let params = Params { rotor_inertia: 0.012 * 20.0 / total, ..Params::default() };
    let (q, qd) = ([0.0, 0.0, 0.0, 0.2, -0.3, 0.5], [0.0, 0.0, 0.0, 0.4, -0.6, 0.8]);
    let found = QuadrotorEuler::new(params).forward_dynamics(&CALM, &q, &qd, &speeds);
    let expected = [0.18399991431112553, -0.4830489503653016, -0.0450076749148055];
    (0..3).for_each(|i| close(found[3 + i], expected[i], 1e-9));
}

/// A tumbling flight, both ways: the quaternion's sign and length are its own.
#[test]
fn angles_and_quaternion_fly_alike() {
    let speeds = [300.0, 299.0, 300.0, 299.5];
    let wind = [[2.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    let (angles, quaternion) = (QuadrotorEuler::default(), QuadrotorQuaternion::default());
    let start = State::new([0.0, 0.0, 0.0, 0.3, -0.2, 0.1], [1.0, -0.5, 0.2, 0.4, 0.05, -0.1]);
    let dop853 = Dop853::new(1e-13, 1e-14);
    let mut by_angles = start;
    let mut steepest: f64 = 0.0;
    let fly = |_: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
        *qdd = angles.forward_dynamics(&wind, q, qd, &speeds);
    };
    dop853
        .integrate(fly, 0.0, 10.0, &mut by_angles, |step| {
            steepest = steepest.max(step.state().q[4].abs());
            ControlFlow::Continue(())
        })
        .expect("a flight");
    assert!(steepest < 1.4, "away from the singularity: {steepest}");
    assert!(by_angles.q[3].abs() > 2.0, "it tumbles: {}", by_angles.q[3]);

    let mut by_quaternion = in_quaternions(&start);
    let fly = |_: f64, q: &[f64; 7], qd: &[f64; 7], qdd: &mut [f64; 7]| {
        *qdd = quaternion.forward_dynamics(&wind, q, qd, &speeds);
    };
    dop853.integrate(fly, 0.0, 10.0, &mut by_quaternion, |_| ControlFlow::Continue(())).expect("a flight");
    let (a, b) = (angles.pose(&wind, &by_angles.q), quaternion.pose(&wind, &by_quaternion.q));
    for i in 0..3 {
        close(b.position[i], a.position[i], 1e-9 * (1.0 + a.position[i].abs()));
        (0..3).for_each(|j| close(b.rotation[i][j], a.rotation[i][j], 1e-9));
    }
}

fn in_quaternions(state: &State<[f64; 6]>) -> State<[f64; 7]> {
    let State { q, qd } = *state;
    let e = UnitQuaternion::from_euler_angles(q[3], q[4], q[5]);
    let w = rates(&q) * Vector3::new(qd[3], qd[4], qd[5]);
    // ė = ½ e ω
    let ed = e.into_inner() * nalgebra::Quaternion::from_imag(w) * 0.5;
    State::new([q[0], q[1], q[2], e.w, e.i, e.j, e.k], [qd[0], qd[1], qd[2], ed.w, ed.i, ed.j, ed.k])
}

/// Pitched through 90°, where the angles have no rates: without torques it turns uniformly.
#[test]
fn the_quaternion_passes_the_singularity_of_the_angles() {
    let params = QuaternionParams { rotor_inertia: 0.0, drag_coefficient: 0.0, ..QuaternionParams::default() };
    let vehicle = QuadrotorQuaternion::new(params);
    let rate = 0.9;
    let mut state = State::new([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, rate / 2.0, 0.0]);
    let coast = |_: f64, q: &[f64; 7], qd: &[f64; 7], qdd: &mut [f64; 7]| {
        *qdd = vehicle.forward_dynamics(&CALM, q, qd, &[0.0; 4]);
    };
    let end = std::f64::consts::PI / rate;
    Dop853::new(1e-13, 1e-14).integrate(coast, 0.0, end, &mut state, |_| ControlFlow::Continue(())).expect("a flight");
    close(state.q[3], 0.0, 1e-10);
    close(state.q[5], 1.0, 1e-10);
    close(state.q[2], -0.5 * 9.80665 * end * end, 1e-9);
}

#[test]
fn the_platform_heaves() {
    let points = [
        (Heave::CASE_I, 1.0, 1.238_461_969_154_282_4, 0.764_556_529_273_185_1, -1.291_711_011_965_446_7),
        (Heave::CASE_I, 7.5, -0.473_383_673_472_217_44, -0.403_011_762_306_342, 0.142_590_046_583_808_44),
        (Heave::CASE_II, 3.0, -0.478_079_268_903_066_4, -1.152_137_936_964_004_1, 2.759_344_071_173_579_5),
        (Heave::CASE_II, 15.0, -0.712_132_034_355_961_4, -1.630_797_685_835_144, 2.411_383_883_825_204),
    ];
    for (heave, t, z, zd, zdd) in points {
        let Reference { value, rate, acceleration } = heave.at(t);
        close(value, z, 1e-13);
        close(rate, zd, 1e-12);
        close(acceleration, zdd, 1e-12);
    }
    assert!(Heave::CASE_I.acceleration_bound() < 9.8 && Heave::CASE_II.acceleration_bound() > 9.8);
}

#[test]
fn the_approach_is_smooth() {
    let approach = Approach::default();
    let end = approach.at(12.0 - 1e-9);
    close(end.value, 0.25, 1e-9);
    close(end.rate, -0.2, 1e-8);
    close(end.acceleration, 0.0, 1e-8);
    let h = 1e-5;
    for t in [0.5, 3.0, 7.7, 11.9, 13.0] {
        let [before, here, after] = [t - h, t, t + h].map(|t| approach.at(t));
        close((after.value - before.value) / (2.0 * h), here.rate, 1e-8);
        close((after.rate - before.rate) / (2.0 * h), here.acceleration, 1e-8);
    }
}

/// What a landing of the reference gives.
struct Expected {
    plant: Plant,
    heave: Heave<4>,
    time: f64,
    relative_velocity: f64,
    horizontal_offset: f64,
    /// Roll and pitch at most \[°\].
    tilt: [f64; 2],
    settling_time: f64,
    thrust: [f64; 2],
    /// Relative, of what depends on the limiter.
    tolerance: f64,
}

/// `quad.landing` of the reference values.
const LANDINGS: [Expected; 4] = [
    Expected {
        plant: Plant::SmallAngle,
        heave: Heave::CASE_I,
        time: 13.254_642_806_506_784,
        relative_velocity: -0.200_219_079_165_423_36,
        horizontal_offset: 8.006_023_104_986_414e-8,
        tilt: [3.0, 8.0],
        settling_time: 2.988_921_952_867_279_7,
        thrust: [316.154_336_420_899_4, 698.462_595_179_117_4],
        tolerance: 0.02,
    },
    Expected {
        plant: Plant::Exact,
        heave: Heave::CASE_I,
        time: 13.254_642_785_856_516,
        relative_velocity: -0.200_219_070_194_215_8,
        horizontal_offset: 8.003_225_359_706_338e-8,
        tilt: [3.0, 8.0],
        settling_time: 2.988_921_948_210_644,
        thrust: [316.154_195_713_093_26, 698.462_595_179_117_4],
        tolerance: 0.02,
    },
    Expected {
        plant: Plant::SmallAngle,
        heave: Heave::CASE_II,
        time: 13.253_187_511_549_939,
        relative_velocity: -0.198_488_290_675_218_9,
        horizontal_offset: 3.673_239_971_465_485e-5,
        tilt: [10.538_811_035_591_93, 21.744_144_214_310_182],
        settling_time: 4.731_387_941_623_328,
        thrust: [19.6133, 862.9852],
        tolerance: 0.05,
    },
    Expected {
        plant: Plant::Exact,
        heave: Heave::CASE_II,
        time: 13.253_187_507_321_867,
        relative_velocity: -0.198_488_288_738_778_1,
        horizontal_offset: 3.621_129_885_747_774e-5,
        tilt: [7.056_604_125_844_076, 22.667_646_178_882_766],
        settling_time: 4.728_074_643_237_075_5,
        thrust: [19.6133, 862.9852],
        tolerance: 0.05,
    },
];

#[test]
fn landings_of_the_thesis() {
    for expected in LANDINGS {
        let landing = Landing::new(expected.plant, expected.heave);
        let found = landing.simulate(Landing::initial_state(), |_, _, _| ()).expect("a touchdown");
        close(found.time, expected.time, 1e-5);
        close(found.relative_velocity, expected.relative_velocity, 1e-5);
        close(found.horizontal_offset, expected.horizontal_offset, 1e-6);
        let relative = |found: f64, expected: f64, tolerance: f64| close(found, expected, tolerance * expected);
        (0..2).for_each(|i| {
            relative(found.greatest_tilt[i].to_degrees(), expected.tilt[i], expected.tolerance);
            relative(found.thrust_range[i], expected.thrust[i], expected.tolerance);
        });
        relative(found.settling_time, expected.settling_time, expected.tolerance);
    }
}

/// A controller sampled at 500 Hz is nearly one in continuous time; a regulator lands as well.
#[test]
fn other_pilots_land_alike() {
    let start = Landing::initial_state();
    let landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let sampled = landing.simulate_sampled(start, 0.002, |_, state| *state).expect("a touchdown");
    close(sampled.time, 13.254_64, 5e-3);
    close(sampled.relative_velocity, -0.200_22, 2e-3);
    let finer = landing.simulate_sampled(start, 0.0002, |_, state| *state).expect("a touchdown");
    assert!((finer.time - 13.254_642_8).abs() < 0.2 * (sampled.time - 13.254_642_8).abs());

    let mut regulated = landing.clone();
    let lqr = Lqr::new(*regulated.vehicle.params(), &Weights::default()).expect("a regulator");
    regulated.controller = Controller::Lqr(lqr);
    for heave in [Heave::CASE_I, Heave::CASE_II] {
        regulated.deck.heave = heave;
        let end = regulated.simulate(start, |_, _, _| ()).expect("a touchdown");
        close(end.relative_velocity, -0.2, 0.01);
        close(end.horizontal_offset, 0.0, 1e-5);
    }
}

#[test]
fn landings_that_cannot_be_are_refused() {
    let start = Landing::initial_state();
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    landing.vehicle = QuadrotorEuler::new(Params { m: 0.0, ..Params::default() });
    let refused = landing.simulate(start, |_, _, _| ());
    assert_eq!(refused, Err(Must::BePositive.broken_by("m", 0.0).into()));

    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let below = State::new([12.0, 7.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6]);
    let below_deck = Must::BeMoreThan(0.0).broken_by(HEIGHT, -1.0);
    assert_eq!(landing.simulate(below, |_, _, _| ()), Err(below_deck.into()));
    let nowhere = State::new([12.0, 7.0, f64::NAN, 0.0, 0.0, 0.0], [0.0; 6]);
    let refused = landing.simulate(nowhere, |_, _, _| ());
    assert!(
        matches!(refused.as_ref().unwrap_err().invalid(), Some(Invalid { parameter: "q", index: Some(2), .. })),
        "{refused:?}"
    );

    type Damage = fn(&mut Landing);
    let broken: [(&str, Damage); 2] = [
        ("approach.last_height", |landing| landing.approach.last_height = f64::NAN),
        ("wind[2]", |landing| landing.wind[2] = f64::NAN),
    ];
    for (name, damage) in broken {
        let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
        damage(&mut landing);
        let refused = landing.simulate(start, |_, _, _| ());
        assert!(
            refused.as_ref().is_err_and(|error| error.invalid().is_some() && error.to_string().starts_with(name)),
            "{refused:?}"
        );
    }
    // A controller with a NaN estimate.
    let mut blind = Landing::new(Plant::Exact, Heave::CASE_I);
    if let Controller::Backstepping(controller) = &mut blind.controller {
        controller.params.m = f64::NAN;
    }
    let refused = blind.simulate(start, |_, _, _| ());
    assert!(
        matches!(refused.as_ref().unwrap_err().invalid(), Some(Invalid { parameter: "controller.params.m", .. })),
        "{refused:?}"
    );
    let sampled = landing
        .simulate_sampled(start, 0.002, |t, state| if t > 1.0 { State::new([f64::NAN; 6], state.qd) } else { *state });
    assert!(
        matches!(sampled, Err(Error { failure: Failure::NotFinite("what a sensor gives"), at: Some(At::Time(time)) }) if (time - 1.002).abs() < 1e-9),
        "{sampled:?}"
    );
    let refused = landing.simulate_sampled(start, 0.0, |_, state| *state);
    assert_eq!(refused, Err(Must::BePositive.broken_by("period", 0.0).into()));

    landing.t_end = 5.0;
    let refused = landing.simulate(start, |_, _, _| ());
    assert!(
        matches!(refused, Err(Error { failure: Failure::NoContact { distance }, at: Some(At::Time(5.0)) }) if distance > 1.0),
        "{refused:?}"
    );
}
