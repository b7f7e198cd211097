//! The flange along straight lines: on the line, on one branch, and refused with the place where it cannot go on.

use mbs_arm::Arm;
use mbs_arm::jacobian::determinant_factors;
use mbs_arm::trajectory::cartesian::{CartesianPath, FlangeLine, Singularity};
use mbs_arm::trajectory::time_optimal::{MotorLimits, retime};
use mbs_arm::trajectory::{AlongPath, JointPath, Motion, POSITION, quintic, trapezoidal};
use mbs_models::check::Must;
use mbs_models::{At, Error, Failure};
use mbs_runtime::attitude::{difference, exp};
use mbs_runtime::nalgebra::Vector3;
use mbs_runtime::{Pose, to_matrix, to_rows};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;

/// Well within all ranges and far from singularities.
const START: [f64; 6] = [0.2, -1.3, 0.1, 0.3, 0.9, 0.0];

/// No limits: lines are followed through any angle.
fn unlimited() -> Arm {
    let mut arm = Arm::default();
    (arm.limits.lower, arm.limits.upper) = ([-100.0; 6], [100.0; 6]);
    arm
}

/// `pose` displaced \[m\] and turned \[rad\], in the axes of the base.
fn moved(pose: &Pose<f64>, displacement: [f64; 3], turn: [f64; 3]) -> Pose<f64> {
    let rotation = to_matrix(&exp(&turn)) * to_matrix(&pose.rotation);
    Pose { position: std::array::from_fn(|i| pose.position[i] + displacement[i]), rotation: to_rows(&rotation) }
}

fn line_from(arm: &Arm, start: &[f64; 6], displacement: [f64; 3], turn: [f64; 3]) -> FlangeLine {
    let from = arm.pose(start);
    FlangeLine::new(&from, &moved(&from, displacement, turn)).unwrap()
}

#[test]
fn a_line_turns_evenly_about_one_axis() {
    let arm = Arm::default();
    let turn = [0.5, -1.0, 1.5];
    let line = line_from(&arm, &START, [0.4, 0.2, -0.3], turn);
    let from = arm.pose(&START);
    for k in 0..=10 {
        let s = f64::from(k) / 10.0;
        let pose = line.pose(s);
        let expected = moved(&from, [0.4 * s, 0.2 * s, -0.3 * s], turn.map(|x| x * s));
        assert_close("p", &pose.position, &expected.position, 1e-15);
        assert_close("R", &pose.rotation.concat(), &expected.rotation.concat(), 1e-14);
    }
    assert_close("twist", &line.twist(), &[0.4, 0.2, -0.3, 0.5, -1.0, 1.5], 1e-14);
}

#[test]
fn the_flange_stays_on_the_line_and_the_arm_on_its_branch() {
    let arm = unlimited();
    let mut random = Random::new(11);
    let mut followed = 0;
    for _ in 0..200 {
        let start: [f64; 6] = std::array::from_fn(|_| random.uniform(-3.0..3.0));
        let displacement = std::array::from_fn(|_| random.uniform(-0.5..0.5));
        let turn = std::array::from_fn(|_| random.uniform(-1.0..1.0));
        let line = line_from(&arm, &start, displacement, turn);
        let Ok(path) = CartesianPath::<65>::new(&arm, line, &start) else { continue };
        followed += 1;
        let signs = |q: &[f64; 6]| {
            let factors = determinant_factors(q);
            [factors.shoulder, factors.elbow, factors.wrist].map(|factor| factor > 0.0)
        };
        let mut before = start;
        for k in 0..=400 {
            let s = f64::from(k) / 400.0;
            let point = path.point(s).unwrap();
            let (found, expected) = (arm.pose(&point.q), line.pose(s));
            assert_close("p", &found.position, &expected.position, 1e-11);
            let error = Vector3::from(difference(&found.rotation, &expected.rotation)).norm();
            assert!(error < 1e-11, "{error}");
            assert_eq!(signs(&point.q), signs(&start));
            // Continuous: no joint moves farther than its tangent says, with room for curvature.
            for i in 0..6 {
                assert!((point.q[i] - before[i]).abs() < 0.8, "joint {i} jumps at s = {s}");
            }
            before = point.q;
        }
    }
    assert!(followed > 60, "{followed}");
}

#[test]
fn tangent_and_curvature_are_derivatives() {
    let arm = Arm::default();
    let path =
        CartesianPath::<33>::new(&arm, line_from(&arm, &START, [0.3, 0.2, -0.4], [0.3, 0.2, 0.5]), &START).unwrap();
    let h = 1e-5;
    for k in 1..20 {
        let s = f64::from(k) / 20.0;
        let [before, at, after] = [s - h, s, s + h].map(|s| path.point(s).unwrap());
        let difference = |a: [f64; 6], b: [f64; 6]| -> [f64; 6] { std::array::from_fn(|i| (b[i] - a[i]) / (2.0 * h)) };
        assert_close("q′", &difference(before.q, after.q), &at.tangent, 1e-9);
        assert_close("q″", &difference(before.tangent, after.tangent), &at.curvature, 1e-8);
    }
}

#[test]
fn a_law_of_time_along_the_line() {
    let arm = Arm::default();
    let path = CartesianPath::<33>::new(&arm, line_from(&arm, &START, [0.3, 0.2, -0.4], [0.0; 3]), &START).unwrap();
    let motion = AlongPath::new(&path, trapezoidal([0.0], [1.0], 5.0, 1.0).unwrap()).unwrap();
    // At constant speed the flange moves on at 1/4 of the line per second.
    let state = motion.at(2.0).unwrap();
    assert_close("v", &arm.flange_velocity(&state.q, &state.qd), &[0.075, 0.05, -0.1, 0.0, 0.0, 0.0], 1e-12);
    let h = 1e-5;
    let [before, after] = [2.0 - h, 2.0 + h].map(|t| motion.at(t).unwrap());
    let rate: [f64; 6] = std::array::from_fn(|i| (after.qd[i] - before.qd[i]) / (2.0 * h));
    assert_close("q̈", &rate, &state.qdd, 1e-8);
    let beyond = quintic([0.0], [0.0], [1.5], 1.0).unwrap();
    let error = AlongPath::new(&path, beyond).unwrap_err();
    assert_eq!(error, Must::BeWithin([0.0, 1.0]).broken_by("path parameter", 1.5).into());
}

#[test]
fn the_fastest_motion_along_a_line() {
    let arm = Arm::default();
    let path = CartesianPath::<33>::new(&arm, line_from(&arm, &START, [0.3, 0.2, -0.4], [0.0; 3]), &START).unwrap();
    let limits = MotorLimits::from(&arm.limits);
    let motion = retime(&path, &arm.model, &limits, 400).unwrap();
    let mut full = 0;
    for k in 0..=1000 {
        let state = motion.at(motion.duration() * (f64::from(k) / 1000.0)).unwrap();
        let torque = arm.model.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        let over = |values: [f64; 6], limits: [f64; 6]| -> f64 {
            values.iter().zip(limits).fold(0.0, |worst, (value, limit)| worst.max(value.abs() / limit))
        };
        let limits = &arm.limits;
        let worst =
            over(state.qd, limits.speed).max(over(state.qdd, limits.acceleration)).max(over(torque, limits.torque));
        assert!(worst <= 1.0 + 1e-5, "{worst}");
        full += usize::from(worst > 0.97);
    }
    assert!(full > 980, "{full}");
    assert!((0.5..3.0).contains(&motion.duration()), "{}", motion.duration());
}

/// Where along the line it failed.
fn place(error: &Error) -> f64 {
    let Some(At::Path(s)) = error.at else { panic!("{error}") };
    s
}

#[test]
fn lines_out_of_reach_end_where_the_arm_is_stretched() {
    let arm = unlimited();
    let line = line_from(&arm, &START, [3.0, 0.0, 0.0], [0.0; 3]);
    let error = CartesianPath::<33>::new(&arm, line, &START).unwrap_err();
    // Stretched: right there branches meet, and beyond nothing reaches.
    let s = place(&error);
    let stretched = Failure::Degenerate(Singularity::Elbow.name());
    assert!(matches!(error.failure, Failure::TooFar { .. }) || error.failure == stretched, "{error}");
    // Bisection of "some configuration reaches the pose" gives the place.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if arm.inverse(&line.pose(middle)).is_ok() { low = middle } else { high = middle }
    }
    assert!((s - low).abs() < 1e-8, "{s}, {low}");
}

#[test]
fn joints_at_the_end_of_their_range_are_named() {
    let arm = Arm::default();
    // The fifth joint may turn to 100°.
    let line = line_from(&arm, &START, [0.0; 3], [0.0, 2.0, 0.0]);
    let error = CartesianPath::<33>::new(&arm, line, &START).unwrap_err();
    let s = place(&error);
    let Failure::LimitExceeded { quantity: POSITION, index: joint, value: angle, limit, .. } = error.failure else {
        panic!("{error}")
    };
    assert!((angle - limit).abs() < 1e-7, "joint {joint} at {angle}, limit {limit}");
    let reached = CartesianPath::<33>::new(&unlimited(), line, &START).map(|path| path.point(s).unwrap().q[joint]);
    assert!((reached.unwrap() - limit).abs() < 1e-7);
    let outside = [0.2, 0.5, 0.1, 0.3, 0.9, 0.0];
    let line = line_from(&arm, &outside, [0.1; 3], [0.0; 3]);
    let error = CartesianPath::<33>::new(&arm, line, &outside).unwrap_err();
    assert!(place(&error) == 0.0 && matches!(error.failure, Failure::LimitExceeded { index: 1, .. }), "{error}");
}

#[test]
fn singularities_that_are_crossed_are_named_with_their_place() {
    let arm = unlimited();
    // Held in the attitude of a posture with θ₅ = 0, the flange is moved through its place.
    let middle = arm.pose(&[0.2, -1.3, 0.1, 0.3, 0.0, 0.0]);
    let [from, to] = [-1.0, 1.0].map(|sign| moved(&middle, [0.1 * sign, 0.15 * sign, -0.2 * sign], [0.0; 3]));
    for start in arm.inverse(&from).unwrap().iter().filter(|start| start.q[0].abs() < 1.0 && start.q[2] > -1.0) {
        let error = CartesianPath::<33>::new(&arm, FlangeLine::new(&from, &to).unwrap(), &start.q).unwrap_err();
        assert_eq!(error.failure, Failure::Degenerate(Singularity::Wrist.name()));
        assert!((place(&error) - 0.5).abs() < 1e-8, "{error}");
    }

    // The wrist passes axis 1: the flange, held level, moves straight across the base.
    let start = [0.0, -1.6, -1.0, 0.0, 0.7, 0.0];
    let wrist = arm.pose(&start);
    let axis: [f64; 3] = std::array::from_fn(|i| wrist.position[i] - 0.25 * wrist.rotation[i][2]);
    let line = line_from(&arm, &start, [-2.0 * axis[0], -2.0 * axis[1], 0.0], [0.0; 3]);
    let error = CartesianPath::<33>::new(&arm, line, &start).unwrap_err();
    assert_eq!(error.failure, Failure::Degenerate(Singularity::Shoulder.name()));
    assert!((place(&error) - 0.5).abs() < 1e-8, "{error}");
}

#[test]
fn what_is_no_line_is_refused() {
    let arm = Arm::default();
    let from = arm.pose(&START);
    assert_eq!(FlangeLine::new(&from, &from).unwrap_err(), Failure::NoMotion.into());
    let mut mirrored = from;
    mirrored.rotation[0] = mirrored.rotation[0].map(|x| -x);
    let error = FlangeLine::new(&from, &mirrored).unwrap_err();
    assert!(place(&error) == 1.0 && matches!(error.failure, Failure::Rotation(_)), "{error}");
    let mut nowhere = from;
    nowhere.position[1] = f64::NAN;
    let error = FlangeLine::new(&nowhere, &from).unwrap_err();
    assert_eq!(error.to_string(), "s = 0: position[1] must be finite, it is NaN");
    let line = line_from(&arm, &START, [0.1; 3], [0.0; 3]);
    let elsewhere = START.map(|q| q + 0.1);
    let error = CartesianPath::<9>::new(&arm, line, &elsewhere).unwrap_err();
    assert!(error.to_string().starts_with("distance from the beginning of the line must be at most"), "{error}");
    assert!(CartesianPath::<9>::new(&arm, line, &[f64::NAN; 6]).is_err());
    let path = CartesianPath::<9>::new(&arm, line, &START).unwrap();
    assert_eq!(path.point(-0.1).unwrap_err(), Must::BeWithin([0.0, 1.0]).broken_by("path parameter", -0.1).into());
    assert!(path.point(f64::NAN).is_err());
    // The wrist in line at the start: joints 4 and 6 are undetermined.
    let singular = [0.2, -1.3, 0.1, 0.3, 0.0, 0.0];
    let line = line_from(&arm, &singular, [0.1; 3], [0.0; 3]);
    let error = CartesianPath::<9>::new(&arm, line, &singular).unwrap_err();
    assert_eq!(error.failure, Failure::Degenerate(Singularity::Wrist.name()));
}
