//! The Stewart platform and what surrounds it, against `data/stewart.json`, the thesis' values computed by other laws;
//! bad input; direct kinematics from a hundred thousand starts.

mod histories;
mod limits;
mod loops;
mod sensitivity;

use std::f64::consts::FRAC_PI_2;

use mbs_derive::expr::Graph;
use mbs_derive::optimise::FunctionKind;
use mbs_derive::{declared, derived};
use mbs_models::check::Must;
use mbs_models::stewart_platform::Params;
use mbs_models::{Error, Failure};
use mbs_platform::direct::Newton;
use mbs_platform::direct::{SEARCH, SEARCH_AT_SINGULAR};
use mbs_platform::dynamics::{Direction, STILL};
use mbs_platform::geometry::{COINCIDENT, attitude};
use mbs_platform::leg::LegMotion;
use mbs_platform::{Coordinates, HOME, LegVector, Motion, NOT_FINITE, Platform};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use serde_json::Value;

/// Relative; the reference is exact to its last digit but one.
const TOLERANCE: f64 = 1e-9;

fn reference() -> Value {
    serde_json::from_str(include_str!("../data/stewart.json")).expect("valid JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        _ => vec![number(value)],
    }
}

fn vector<const N: usize>(value: &Value) -> [f64; N] {
    numbers(value).try_into().unwrap_or_else(|found| panic!("{N} numbers expected: {found:?}"))
}

fn close(what: &str, got: impl AsRef<[f64]>, want: &Value) {
    // Relative to the largest entry, however small.
    let want = numbers(want);
    let scale = want.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let scaled = |values: &[f64]| -> Vec<f64> { values.iter().map(|x| x / scale).collect() };
    assert_close(what, &scaled(got.as_ref()), &scaled(&want), TOLERANCE);
}

/// The platform with this payload, on legs with or without mass.
pub(crate) fn platform(payload: f64, actuators: bool) -> Platform {
    let loaded = Platform::default().with_payload(payload).expect("a payload");
    if actuators { loaded } else { loaded.without_actuator_inertia() }
}

/// Lengths and forces at t = 0, 0.5, …, 4 s.
fn check_motion(what: &str, platform: &Platform, motion: &Motion, want: &Value) {
    for i in 0..9 {
        let [q, qd, qdd] = motion.at(0.5 * i as f64);
        let what = format!("{what} at {} s", 0.5 * i as f64);
        close(&format!("lengths of {what}"), platform.lengths(&q).unwrap(), &want["lengths"][i]);
        close(&format!("generated lengths of {what}"), platform.model().leg_length(&q), &want["lengths"][i]);
        close(&format!("forces of {what}"), platform.leg_forces(&q, &qd, &qdd).unwrap(), &want["forces"][i]);
    }
}

/// What CasADi needs for a platform of this kind, with constants frozen, is 2301 and 1458 instructions.
#[test]
fn budget() {
    let (_, source) =
        mbs_models::SOURCES.iter().find(|(module, _)| *module == "stewart_platform").expect("a mechanism");
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).expect("a mechanism of the repository");
    let derivation = derived(&lagrangian);
    for (kind, most) in [(FunctionKind::InverseDynamics, 1756), (FunctionKind::MassMatrix, 1206)] {
        let (name, function) = (kind.name(), derivation.function(kind));
        let operations = function.expect("generated for every mechanism").operations;
        assert!(operations.flops() <= most, "{name}: {} > {most}", operations.flops());
        assert_eq!(operations.sincos, 3, "{name}");
    }
}

#[test]
fn table_3() {
    let want = &reference()["table3"];
    for payload in [0, 300, 1250] {
        for (actuators, name) in [(true, "True"), (false, "False")] {
            let case = format!("payload_{payload}_act_{name}");
            check_motion(&case, &platform(f64::from(payload), actuators), &Motion::TABLE_3, &want[&case]);
        }
    }
}

#[test]
fn table_4() {
    let data = reference();
    for (case, want) in data["table4"].as_object().expect("cases") {
        let motion = Motion::table_4_turned(vector::<3>(&want["angles_deg"]).map(f64::to_radians));
        check_motion(case, &platform(300.0, true), &motion, &want["with_actuators"]);
        check_motion(case, &platform(300.0, false), &motion, &want["without_actuators"]);
        // The reference saw 4001 instants of one period.
        let survey = platform(300.0, true).survey(&motion, 4.0, 1e-3).unwrap();
        let extremes = [survey.length[0], survey.length[1], survey.condition.0];
        let want = [&want["leg_min_m"], &want["leg_max_m"], &want["max_cond_J"]].map(number);
        assert_close(case, &extremes, &want, 1e-6);
        assert!(!survey.is_clear(), "{case} leaves the stroke");
    }
}

#[test]
fn table_4_from_the_base_passes_through_a_singular_pose() {
    let want = &reference()["table4_from_the_base_phi10"];
    let mut motion = Motion::table_4_turned([10.0, 0.0, 20.0].map(f64::to_radians));
    motion.mean[2] -= HOME[2];
    let determinant = |t: f64| platform(300.0, true).regularity(&motion.at(t)[0]).unwrap().determinant;
    let all: Vec<f64> = (0..=4000).map(|i| determinant(1e-3 * i as f64)).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Rows or columns in another order change the sign alone.
    let sign = (most * number(&want["det_J_max"])).signum();
    let (least, most) = if sign > 0.0 { (least, most) } else { (-most, -least) };
    assert_close("determinant", &[least, most], &[number(&want["det_J_min"]), number(&want["det_J_max"])], 1e-5);
    // Where the sign changes there is a pose that cannot be held.
    let (mut a, mut b) = all
        .windows(2)
        .enumerate()
        .find(|(_, pair)| pair[0] * pair[1] < 0.0)
        .map(|(i, _)| (1e-3 * i as f64, 1e-3 * (i + 1) as f64))
        .expect("the determinant changes its sign");
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if determinant(a) * determinant(middle) <= 0.0 { b = middle } else { a = middle }
    }
    let [q, qd, qdd] = motion.at(a);
    assert!(platform(300.0, true).regularity(&q).unwrap().is_singular());
    assert!(!platform(300.0, true).reaches(&q).unwrap());
    let refused = platform(300.0, true).leg_forces(&q, &qd, &qdd);
    assert!(
        matches!(refused, Err(Error { failure: Failure::Singular { smallest, largest, .. }, .. }) if smallest < 1e-9 * largest),
        "{refused:?}"
    );
}

#[test]
fn home() {
    let want = &reference()["home"];
    let platform = Platform::default();
    close("length", [platform.lengths(&HOME).unwrap()[0]], &want["home_leg_length_m"]);
    close("Jacobian", platform.jacobian(&HOME).unwrap().as_flattened(), &want["home_Jtwist"]);
    close("condition", [platform.regularity(&HOME).unwrap().condition], &want["home_cond"]);
    assert!(platform.reaches(&HOME).unwrap());
}

/// (4.4), as it is printed: the square of the length, multiplied out.
#[test]
fn squares_of_lengths_as_printed() {
    let platform = Platform::default();
    let geometry = platform.geometry();
    let mut random = Random::new(1);
    for _ in 0..100 {
        let q = random_pose(&mut random);
        let (r, lengths) = (attitude(&q), platform.lengths(&q).unwrap());
        for i in 0..6 {
            let ([px, py, _], [bx, by, _]) = (geometry.platform[i], geometry.base[i]);
            let turned = |row: usize| r[row][0] * px + r[row][1] * py;
            let square = q[0] * q[0]
                + q[1] * q[1]
                + q[2] * q[2]
                + 0.9 * 0.9
                + 1.2 * 1.2
                + 2.0 * turned(0) * (q[0] - bx)
                + 2.0 * turned(1) * (q[1] - by)
                + 2.0 * turned(2) * q[2]
                - 2.0 * (q[0] * bx + q[1] * by);
            assert_close("l²", &[lengths[i] * lengths[i]], &[square], 1e-14);
        }
    }
}

#[test]
fn jacobians_are_derivatives_of_the_lengths() {
    let platform = Platform::default();
    let mut random = Random::new(2);
    for _ in 0..100 {
        let q = random_pose(&mut random);
        let jacobian = platform.coordinate_jacobian(&q).unwrap();
        assert_close("J_q", jacobian.as_flattened(), platform.model().leg_length_jacobian(&q).as_flattened(), 1e-13);
        let qd = random.array(-1.0..1.0);
        let rates = platform.leg_rates(&q, &qd).unwrap();
        assert_close("l̇", &rates, &platform.model().leg_length_velocity(&q, &qd), 1e-13);
        assert_close("q̇", &platform.coordinate_rates(&q, &rates).unwrap(), &qd, 1e-12);
        let twist = platform.model().pose_velocity(&q, &qd);
        let by_twist: Vec<f64> = platform.jacobian(&q).unwrap().iter().map(|row| dot(row, &twist)).collect();
        assert_close("J [v; ω]", &by_twist, &rates, 1e-13);
    }
}

#[test]
fn general_motion() {
    let data = reference();
    for want in data["general"].as_array().expect("moments") {
        let platform = platform(number(&want["payload_kg"]), want["actuators"].as_bool().expect("a flag"));
        let motion = Motion::COMBINED.at(number(&want["t_s"]));
        for (name, got) in ["q", "qd", "qdd"].iter().zip(&motion) {
            close(name, got, &want[name]);
        }
        let [q, qd, qdd] = ["q", "qd", "qdd"].map(|name| vector(&want[name]));
        close("Q", platform.generalized_force(&q, &qd, &qdd), &want["Q_N_or_Nm"]);
        let forces = platform.leg_forces(&q, &qd, &qdd).unwrap();
        close("forces", forces, &want["leg_force_N"]);
        assert_close("back", &platform.accelerations(&q, &qd, &forces).unwrap(), &qdd, 1e-11);
    }
}

#[test]
fn equation_4_18() {
    let [q, qd, _] = Motion::COMBINED.at(0.3);
    for (actuators, name) in [(true, "with_actuators"), (false, "without_actuators")] {
        let (platform, data) = (platform(300.0, actuators), reference());
        let want = &data["eq_4_18"][name];
        close("M", platform.model().mass_matrix(&q).as_flattened(), &want["M"]);
        close("C", platform.model().coriolis_matrix(&q, &qd).as_flattened(), &want["C"]);
        close("G", platform.model().gravity(&q), &want["G"]);
    }
}

#[test]
fn spherical_coordinates_of_a_leg() {
    let data = reference();
    let want = &data["spherical_leg"];
    let of = |names: [&str; 3]| names.map(|name| number(&want["inputs"][name]));
    let motion = LegMotion {
        position: of(["rho", "alpha", "beta"]),
        rate: of(["rhod", "alphad", "betad"]),
        acceleration: of(["rhodd", "alphadd", "betadd"]),
    };
    close("velocity", motion.joint_velocity(), &want["velocity"]);
    close("acceleration", motion.joint_acceleration(), &want["acceleration"]);
    close("C", motion.matrix().as_flattened(), &want["C"]);
    let place = motion.direction().map(|e| motion.position[0] * e);
    let back = LegMotion::of_joint(&place, &motion.joint_velocity(), &motion.joint_acceleration()).unwrap();
    assert_close("position", &back.position, &motion.position, 1e-14);
    assert_close("rates", &back.rate, &motion.rate, 1e-14);
    assert_close("accelerations", &back.acceleration, &motion.acceleration, 1e-14);
}

#[test]
fn legs_of_the_platform_in_spherical_coordinates() {
    let platform = Platform::default();
    for i in 0..40 {
        let [q, qd, qdd] = Motion::COMBINED.at(0.1 * f64::from(i));
        let (lengths, rates) = (platform.lengths(&q).unwrap(), platform.leg_rates(&q, &qd).unwrap());
        for leg in 0..6 {
            let motion = platform.spherical_leg(leg, &q, &qd, &qdd).unwrap();
            let [_, velocity, acceleration] = platform.joint_motion(leg, &q, &qd, &qdd);
            assert_close("length and rate", &[motion.position[0], motion.rate[0]], &[lengths[leg], rates[leg]], 1e-13);
            assert_close("(4.7)", &motion.joint_velocity(), &velocity, 1e-13);
            assert_close("(4.8)", &motion.joint_acceleration(), &acceleration, 1e-13);
        }
    }
    let falling = LegMotion::of_joint(&[0.0, 0.0, 1.0], &[0.0; 3], &[0.0; 3]);
    assert_eq!(falling, Err(Failure::Undetermined("the azimuth of a vertical leg").into()));
    let short = Must::BePositive.broken_by("length of the leg", 0.0);
    assert_eq!(LegMotion::of_joint(&[0.0; 3], &[0.0; 3], &[0.0; 3]), Err(short.into()));
    assert_eq!(LegMotion::of_joint(&[f64::NAN, 0.0, 1.0], &[0.0; 3], &[0.0; 3]), Err(NOT_FINITE.into()));
}

#[test]
fn direct_kinematics_of_the_reference() {
    let data = reference();
    let (lengths, want) = (vector(&data["fk_newton"]["lengths_m"]), vector::<6>(&data["fk_newton"]["q_true"]));
    let found = Platform::default().direct(&lengths, &HOME).unwrap();
    assert!(found.iterations <= 5 && found.residual <= 1e-12, "{found:?}");
    assert!((0..6).all(|i| (found.pose[i] - want[i]).abs() <= 1e-12), "{found:?}");
}

/// Within 0.4 m and 20° of the middle, all legs within their stroke.
pub(crate) fn random_pose(random: &mut Random) -> Coordinates {
    let platform = Platform::default();
    loop {
        let turn = 20.0_f64.to_radians();
        let ranges = [-0.4..0.4, -0.4..0.4, 0.7..1.5, -turn..turn, -turn..turn, -turn..turn];
        let q = ranges.map(|range| random.uniform(range));
        if platform.lengths(&q).is_ok_and(|lengths| lengths.iter().all(|&l| platform.limits.admits(l))) {
            return q;
        }
    }
}

#[test]
fn direct_kinematics_from_a_hundred_thousand_starts() {
    let (platform, mut random) = (Platform::default(), Random::new(3));
    let (mut histogram, mut worst) = ([0; 6], 0.0_f64);
    for _ in 0..100_000 {
        let q = random_pose(&mut random);
        let lengths = platform.lengths(&q).unwrap();
        // Off by 5 cm in a random direction, and turned by 5° about each axis at most.
        let (mut direction, turn) = ([0.0; 3], 5.0_f64.to_radians());
        direction = direction.map(|_: f64| random.uniform(-1.0..1.0));
        let norm = dot(&direction, &direction).sqrt();
        let mut start = q;
        for i in 0..3 {
            start[i] += 0.05 * direction[i] / norm;
            start[i + 3] += random.uniform(-turn..turn);
        }
        let found = platform.direct(&lengths, &start).unwrap_or_else(|error| panic!("{error} at {q:?}"));
        assert!(found.iterations <= 5 && found.residual <= 1e-12, "{found:?} for {q:?}");
        histogram[found.iterations] += 1;
        worst = (0..6).fold(worst, |worst, i| worst.max((found.pose[i] - q[i]).abs()));
    }
    assert!(worst <= 1e-12, "{worst:e}");
    // What it costs: solutions of six linear equations.
    let steps: usize = histogram.iter().enumerate().map(|(steps, poses)| steps * poses).sum();
    println!("iterations {histogram:?}, worst coordinate off by {worst:e}");
    assert!(steps <= 410_000, "{steps} steps for 100 000 poses");
}

#[test]
fn tracking_by_the_last_pose() {
    let platform = Platform::default();
    let mut pose = Motion::COMBINED.at(0.0)[0];
    for i in 1..=2000 {
        let q = Motion::COMBINED.at(0.005 * f64::from(i))[0];
        let found = platform.direct(&platform.lengths(&q).unwrap(), &pose).unwrap();
        assert!(found.iterations <= 3, "{found:?}");
        pose = found.pose;
        assert!((0..6).all(|i| (pose[i] - q[i]).abs() <= 1e-12), "{pose:?} {q:?}");
    }
}

#[test]
fn lengths_that_belong_to_no_pose_end_in_an_error() {
    let platform = Platform::default();
    // One leg of 4 m beside five of 1.2 m: the triangle with its neighbour does not close.
    let torn = [4.0, 1.2, 1.2, 1.2, 1.2, 1.2];
    match platform.direct(&torn, &HOME) {
        Err(Error { failure: Failure::NotConverged { iterations, residual, .. }, .. }) => {
            assert!(iterations <= 50 && residual > 0.1, "{iterations} {residual}");
        }
        other => panic!("{other:?}"),
    }
    let few = Newton { iterations: 2, ..Newton::default() };
    let lengths = platform.lengths(&[0.1, 0.1, 1.2, 0.2, 0.1, 0.2]).unwrap();
    let stopped = few.solve(&platform, &lengths, &HOME);
    let Err(Error { failure: Failure::NotConverged { what: SEARCH, iterations: 2, residual, unit: "m" }, .. }) =
        stopped
    else {
        panic!("{stopped:?}")
    };
    assert!(residual > 1e-13, "{residual}");
    let invalid = Newton { tolerance: -1.0, ..few }.solve(&platform, &lengths, &HOME);
    assert_eq!(invalid, Err(Must::BePositive.broken_by("tolerance", -1.0).into()));
    for length in [0.0, -1.0, f64::INFINITY] {
        let mut lengths = lengths;
        lengths[4] = length;
        let refused = Must::BePositive.broken_by("length of leg", length).of(4);
        assert_eq!(platform.direct(&lengths, &HOME), Err(refused.into()));
    }
    let mut start = HOME;
    start[5] = f64::NAN;
    let refused = platform.direct(&lengths, &start).unwrap_err();
    assert_eq!(refused.to_string(), "start[5] must be finite, it is NaN");
    // Flat on the base the legs cannot tell up from down.
    let flat = platform.direct(&lengths, &[0.0; 6]);
    let Err(Error { failure: Failure::NotConverged { what, iterations: 0, .. }, .. }) = flat else {
        panic!("{flat:?}")
    };
    assert_eq!(what, SEARCH_AT_SINGULAR);
}

#[test]
fn bad_platforms_and_poses() {
    let params = Params::default();
    let refused = |params: Params| Platform::new(params).expect_err("no platform");
    assert_eq!(
        refused(Params { payload_mass: -5.0, ..params }),
        Must::NotBeNegative.broken_by("payload_mass", -5.0).into()
    );
    assert_eq!(
        refused(Params { piston_mass: -1.0, ..params }),
        Must::NotBeNegative.broken_by("piston_mass", -1.0).into()
    );
    assert_eq!(refused(Params { base_radius: 0.0, ..params }), Must::BePositive.broken_by("base_radius", 0.0).into());
    assert_eq!(
        refused(Params { base_half_angle: 0.0, ..params }),
        Must::BeMoreThan(COINCIDENT * params.base_radius).broken_by("clearance of base joint", 0.0).of(0).into()
    );
    // Pairs of 60° to each side meet their neighbours.
    let met = refused(Params { platform_half_angle: 60.0_f64.to_radians(), ..params });
    let named = met.invalid().expect("a number");
    assert!(named.parameter == "clearance of platform joint" && named.index == Some(0) && named.value < 1e-15, "{met}");
    assert_eq!(refused(Params { g: f64::NAN, ..params }).to_string(), "g must be finite, it is NaN");
    let refused = refused(Params { platform_inertia: [55.0, 0.0, 105.0], ..params });
    assert_eq!(refused.to_string(), "platform_inertia[1] must be positive, it is 0");

    // Joints of one radius and angle, plates on each other: every leg has the length zero.
    let stacked = Platform::new(Params {
        platform_radius: 1.2,
        base_half_angle: 30.0_f64.to_radians(),
        platform_half_angle: 30.0_f64.to_radians(),
        ..params
    })
    .unwrap();
    let zero = stacked.lengths(&[0.0; 6]);
    let named = zero.unwrap_err().invalid().expect("a number");
    assert!(named.parameter == "length of leg" && named.index == Some(0) && named.value < 1e-15, "{named}");
    // Straight up it cannot be held against a turn about z: the classical singularity of equal plates.
    let upright = stacked.leg_forces(&HOME, &[0.0; 6], &[0.0; 6]);
    assert!(matches!(upright, Err(Error { failure: Failure::Singular { .. }, .. })), "{upright:?}");

    let platform = Platform::default();
    for place in 0..6 {
        let mut q = HOME;
        q[place] = f64::INFINITY;
        assert_eq!(platform.lengths(&q), Err(NOT_FINITE.into()));
        assert_eq!(platform.leg_forces(&HOME, &q, &[0.0; 6]), Err(NOT_FINITE.into()));
        assert_eq!(platform.accelerations(&HOME, &[0.0; 6], &q), Err(NOT_FINITE.into()));
    }
    // θ = 90°: the legs are fine, the angles are not.
    let upended = platform.leg_forces(&[0.0, 0.0, 1.5, 0.0, FRAC_PI_2, 0.0], &[0.0; 6], &[0.0; 6]);
    assert!(matches!(upended, Err(Error { failure: Failure::Singular { .. }, .. })), "{upended:?}");
    // Nor do accelerations follow there, or so near that M, which goes as cos² θ, is rounding.
    for off in [0.0, 1e-12, -1e-8, 1e-5] {
        for side in [1.0, -1.0] {
            let q = [0.0, 0.0, 1.5, 0.2, side * (FRAC_PI_2 + off), 0.3];
            let upended = platform.accelerations(&q, &[0.1; 6], &[1000.0; 6]);
            assert!(
                matches!(upended, Err(Error { failure: Failure::Singular { smallest, largest, .. }, .. }) if smallest < 1e-5 && (largest - 2.0_f64.sqrt()).abs() < 1e-9),
                "{upended:?}"
            );
        }
    }
    // Where they are given they are right.
    let (q, qd, qdd) = ([0.0, 0.0, 1.5, 0.2, FRAC_PI_2 - 1e-3, 0.3], [0.1; 6], [0.5; 6]);
    let forces = platform.leg_forces(&q, &qd, &qdd).unwrap();
    assert_close("q̈ near θ = 90°", &platform.accelerations(&q, &qd, &forces).unwrap(), &qdd, 1e-6);
    // The legs of equal plates cannot hold the platform, and yet it falls.
    let falling = stacked.accelerations(&HOME, &[0.0; 6], &[0.0; 6]).unwrap();
    assert!(falling[2] < -9.0, "{falling:?}");
}

#[test]
fn derivatives_of_forces_are_those_of_finite_differences() {
    let platform = Platform::default();
    let [q, qd, qdd] = Motion::COMBINED.at(0.7);
    let p = *platform.params();
    let forces = |params: Params| Platform::new(params).unwrap().leg_forces(&q, &qd, &qdd).unwrap();
    let along = [
        ("payload", Direction { payload_mass: 1.0, ..STILL }),
        ("radius of the base", Direction { base_radius: 1.0, ..STILL }),
        ("radius of the platform", Direction { platform_radius: 1.0, ..STILL }),
        ("half angle of the base", Direction { base_half_angle: 1.0, ..STILL }),
        ("half angle of the platform", Direction { platform_half_angle: 1.0, ..STILL }),
    ];
    for (name, along) in along {
        let at = |h: f64| Params {
            payload_mass: p.payload_mass + h * along.payload_mass,
            base_radius: p.base_radius + h * along.base_radius,
            platform_radius: p.platform_radius + h * along.platform_radius,
            base_half_angle: p.base_half_angle + h * along.base_half_angle,
            platform_half_angle: p.platform_half_angle + h * along.platform_half_angle,
            ..p
        };
        let got = platform.leg_forces_along(&along, &q, &qd, &qdd).unwrap();
        let h = 1e-5;
        let (more, less) = (forces(at(h)), forces(at(-h)));
        let want: LegVector = std::array::from_fn(|i| (more[i] - less[i]) / (2.0 * h));
        // Differences are good to h² and ε/h.
        assert_close(name, &got, &want, 1e-7);
    }
    // Displaced along each coordinate, and along all of them, while the rates stay.
    let displaced = |dq: &Coordinates, h: f64| {
        let q = std::array::from_fn(|i| q[i] + h * dq[i]);
        platform.leg_forces(&q, &qd, &qdd).unwrap()
    };
    let one = |coordinate: usize| std::array::from_fn(|i| if i == coordinate { 1.0 } else { 0.0 });
    for (name, dq) in [
        ("x", one(0)),
        ("y", one(1)),
        ("z", one(2)),
        ("φ", one(3)),
        ("θ", one(4)),
        ("ψ", one(5)),
        ("all", [0.3, -0.2, 0.1, -0.5, 0.4, 0.6]),
    ] {
        let got = platform.leg_forces_displaced(&dq, &q, &qd, &qdd).unwrap();
        let h = 1e-5;
        let (more, less) = (displaced(&dq, h), displaced(&dq, -h));
        let want: LegVector = std::array::from_fn(|i| (more[i] - less[i]) / (2.0 * h));
        assert_close(name, &got, &want, 1e-7);
    }
    // The terms of velocity are in them: at rest, derivatives differ by more than differences could.
    let (moving, still) = (
        platform.leg_forces_displaced(&one(3), &q, &qd, &qdd).unwrap(),
        platform.leg_forces_displaced(&one(3), &q, &[0.0; 6], &qdd).unwrap(),
    );
    assert!((0..6).any(|i| (moving[i] - still[i]).abs() > 1e-3 * moving[i].abs()), "{moving:?} {still:?}");
}

/// `∂F/∂k` against the forces of a platform on springs, whose pose is found by balance.
#[test]
fn derivative_by_stiffness_is_that_of_a_platform_on_springs() {
    let platform = Platform::default();
    let (rest, q) = ([0.0; 6], [0.05, -0.1, 1.15, 0.1, -0.05, 0.2]);
    let commanded = platform.leg_forces(&q, &rest, &rest).unwrap();
    let rigid = platform.lengths(&q).unwrap();
    // Fixed point: lengths give forces, forces give lengths.
    let sprung = |k: f64| {
        let mut forces = commanded;
        for _ in 0..60 {
            let lengths = std::array::from_fn(|i| rigid[i] - forces[i] / k);
            let pose = platform.direct(&lengths, &q).unwrap().pose;
            forces = platform.leg_forces(&pose, &rest, &rest).unwrap();
        }
        forces
    };
    let k = 2e6;
    let (more, less) = (sprung(1.01 * k), sprung(0.99 * k));
    let want: LegVector = std::array::from_fn(|i| (more[i] - less[i]) / (0.02 * k) * 1e6);
    let got = platform.leg_forces_by_stiffness(k, &q, &rest, &rest).unwrap().map(|x| x * 1e6);
    // The next order is 1/k smaller: half a millimetre of a metre.
    assert_close("∂F/∂k", &got, &want, 5e-3);
    assert!(got.iter().any(|x| x.abs() > 0.1), "{got:?}");
}

#[test]
fn stiffness_is_the_work_of_the_springs() {
    let (platform, leg) = (Platform::default(), [1e7, 2e7, 1.5e7, 1e7, 3e7, 1e7]);
    let q = [0.05, -0.1, 1.15, 0.1, -0.05, 0.2];
    let stiffness = platform.stiffness(&q, &leg).unwrap();
    let rest = platform.lengths(&q).unwrap();
    let mut random = Random::new(4);
    for _ in 0..20 {
        let qd = random.array(-1.0..1.0);
        let twist = platform.model().pose_velocity(&q, &qd);
        // V = ½ Σ k (l − l₀)² along q + h q̇, to second order; the third cancels.
        let energy = |h: f64| -> f64 {
            let lengths = platform.lengths(&std::array::from_fn(|i| q[i] + h * qd[i])).unwrap();
            (0..6).map(|i| 0.5 * leg[i] * (lengths[i] - rest[i]).powi(2)).sum()
        };
        let want = (energy(1e-4) + energy(-1e-4)) / 1e-8;
        let got: f64 = (0..6).map(|i| twist[i] * dot(&stiffness[i], &twist)).sum();
        assert!((got / want - 1.0).abs() < 1e-6, "{got} {want}");
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
