//! The kinematics of the IRB 7600 against values of a separate program, against itself, and against a numerical search.

use std::f64::consts::{PI, TAU};

use mbs_arm::inverse::{Branch, EXCESS, Elbow, Inexact, PHI, Shoulder, Singularities, Wrist};
use mbs_arm::printed;
use mbs_arm::{A1, A2, A3, Arm, D1, D4, D6, InverseKinematics, JointLimits, JointVector, Solution, Solutions};
use mbs_models::arm6::Arm6;
use mbs_models::scara::Scara;
use mbs_models::{Error, Failure};
use mbs_runtime::attitude::NotARotation;
use mbs_runtime::inverse_kinematics::{DampedLeastSquares, NotReached};
use mbs_runtime::{Pose, to_matrix};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::arms::thesis_values;
use serde_json::Value;

/// Poses that the accuracy is measured on.
const POSES: usize = 10_000;

fn data() -> Value {
    serde_json::from_str(include_str!("../data/arm_kinematics.json")).expect("the data file is JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| number(&value[i]))
}

pub(crate) fn table_1() -> JointVector {
    [45.0, 30.0, 30.0, -45.0, 30.0, 0.0].map(f64::to_radians)
}

/// (3.20) and (3.21): the pose of table 1 as the thesis prints it.
fn printed_pose() -> Pose<f64> {
    Pose {
        position: [0.2586, 0.1336, -0.4601],
        rotation: [[-0.5227, 0.75, -0.4053], [0.3433, -0.25, -0.9053], [-0.7803, -0.6124, -0.1268]],
    }
}

/// The largest difference of two poses, entry by entry.
pub(crate) fn apart(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    let rows = |pose: &Pose<f64>| [pose.position, pose.rotation[0], pose.rotation[1], pose.rotation[2]].concat();
    let differences = rows(a).into_iter().zip(rows(b)).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |largest, x| if x <= largest { largest } else { x })
}

/// The largest difference of two configurations, whole turns aside.
fn turned_apart(a: &JointVector, b: &JointVector) -> f64 {
    let difference = |i: usize| {
        let difference = (a[i] - b[i]).rem_euclid(TAU);
        difference.min(TAU - difference)
    };
    (0..6).map(difference).fold(0.0, f64::max)
}

fn random_configuration(random: &mut Random) -> JointVector {
    std::array::from_fn(|_| random.uniform(-PI..PI))
}

/// All of them reach the pose, are labelled rightly, and are different.
fn check(arm: &Arm, pose: &Pose<f64>, solutions: &Solutions, tolerance: f64) {
    for solution in solutions {
        let q = &solution.q;
        let error = apart(&arm.pose(q), pose);
        assert!(error <= tolerance, "{solution:?} is off by {error:e}");
        assert!(q.iter().all(|&angle| (-PI..=PI).contains(&angle)), "{q:?}");
        let forward = A1 + A2 * q[1].cos() + A3 * (q[1] + q[2]).cos() - D4 * (q[1] + q[2]).sin();
        let bent = (q[2] + PHI).sin();
        let Branch { shoulder, elbow, wrist } = solution.branch;
        // Where a branch meets its neighbour the sign is rounding.
        assert!(forward.abs() < 1e-9 || (forward > 0.0) == (shoulder == Shoulder::Front), "{solution:?}");
        assert!(bent.abs() < 1e-6 || (bent > 0.0) == (elbow == Elbow::Positive), "{solution:?}");
        assert!(q[4].sin().abs() < 1e-9 || (q[4] > 0.0) == (wrist == Wrist::Positive), "{solution:?}");
    }
    for (i, solution) in solutions.iter().enumerate() {
        assert!(solutions[..i].iter().all(|other| other.branch != solution.branch));
    }
}

#[test]
fn direct_kinematics_has_the_reference_values() {
    let arm = Arm::default();
    let thesis = thesis_values();
    let at_table_1 = arm.pose(&table_1());
    assert_close("position", &at_table_1.position, &thesis.position, 1e-12);
    assert_close("rotation", &at_table_1.rotation.concat(), &thesis.rotation.concat(), 1e-12);
    assert!(apart(&at_table_1, &printed_pose()) < 5e-5, "(3.20), (3.21)");
    let data = data();
    for key in ["fk_table2_start", "fk_table2_stop"] {
        let pose = arm.pose(&numbers(&data[key]["theta_deg"]).map(f64::to_radians));
        assert_close(key, &pose.position, &numbers::<3>(&data[key]["P_m"]), 1e-12);
        for row in 0..3 {
            assert_close(key, &pose.rotation[row], &numbers::<3>(&data[key]["R"][row]), 1e-12);
        }
    }
}

#[test]
fn table_1_has_the_eight_reference_configurations() {
    let arm = Arm::default();
    let solutions = arm.inverse(&arm.pose(&table_1())).expect("reachable");
    let data = data();
    let reference = data["ik_table1"].as_array().expect("a list");
    assert_eq!((solutions.len(), reference.len()), (8, 8));
    for entry in reference {
        let branch = Branch {
            shoulder: if entry["shoulder"] == "front" { Shoulder::Front } else { Shoulder::Back },
            elbow: if entry["elbow"] == 1 { Elbow::Positive } else { Elbow::Negative },
            wrist: if entry["wrist"] == 1 { Wrist::Positive } else { Wrist::Negative },
        };
        let solution = solutions.of_branch(branch).expect("all branches");
        let error = turned_apart(&solution.q, &numbers(&entry["theta_rad"]));
        assert!(error < 1e-13, "{branch:?}: {error:e}");
        assert!(!solution.singular.any());
    }
}

#[test]
fn random_poses_are_reached_by_every_branch() {
    let arm = Arm::default();
    let mut random = Random::new(7);
    let mut counts = [0; 9];
    for _ in 0..POSES {
        let q = random_configuration(&mut random);
        let pose = arm.pose(&q);
        let solutions = arm.inverse(&pose).expect("reachable");
        check(&arm, &pose, &solutions, 1e-12);
        // The configuration that the pose came from is among them; near singularities its angles are less sharp than
        // the pose.
        let nearest = solutions.iter().map(|solution| turned_apart(&solution.q, &q)).fold(f64::INFINITY, f64::min);
        let singular = arm_factors(&q).into_iter().fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-13 / singular.min(1.0), "{q:?}: {nearest:e}, {singular:e}");
        // A shoulder that is missing is out of reach.
        let wrist = wrist_of(&pose);
        let reach = |sign: f64| (sign * wrist[0].hypot(wrist[1]) - A1).hypot(wrist[2] - D1);
        for (shoulder, sign) in [(Shoulder::Front, 1.0), (Shoulder::Back, -1.0)] {
            let count = solutions.iter().filter(|solution| solution.branch.shoulder == shoulder).count();
            let within = reach(sign) < A2 + A3.hypot(D4) && reach(sign) > A2 - A3.hypot(D4);
            assert_eq!(count, if within { 4 } else { 0 }, "{shoulder:?} at {q:?}");
        }
        counts[solutions.len()] += 1;
    }
    assert_eq!(counts[4] + counts[8], POSES);
    assert!(counts[4] > POSES / 10 && counts[8] > POSES / 10, "{counts:?}");
}

/// Wrist from axis 1, elbow, and wrist from straight, as sines or metres.
fn arm_factors(q: &JointVector) -> [f64; 3] {
    let factors = mbs_arm::jacobian::determinant_factors(q);
    [factors.shoulder, factors.elbow, factors.wrist].map(f64::abs)
}

fn wrist_of(pose: &Pose<f64>) -> [f64; 3] {
    std::array::from_fn(|i| pose.position[i] - D6 * pose.rotation[i][2])
}

#[test]
fn the_stretched_arm_loses_no_digits() {
    let arm = Arm::default();
    let mut random = Random::new(11);
    for case in 0..2000 {
        let mut q = random_configuration(&mut random);
        // Down to 1e-9 m short of stretched, which is 6e-5 rad, and through it.
        let bend = random.uniform(-9.0..-4.2);
        q[2] = if case % 5 == 0 { -PHI } else { -PHI + 10_f64.powf(bend) * if case % 2 == 0 { 1.0 } else { -1.0 } };
        let pose = arm.pose(&q);
        let solutions = arm.inverse(&pose).unwrap_or_else(|error| panic!("{q:?}: {error}"));
        check(&arm, &pose, &solutions, 1e-12);
        let stretched = (q[2] + PHI).abs();
        let found = solutions.iter().filter(|solution| turned_apart(&solution.q, &q) < 1e-7).count();
        assert!(stretched < 1.5e-7 || found == 1, "{q:?}: {stretched:e}, {solutions:?}");
        assert!(stretched > 1e-9 || solutions.iter().any(|solution| solution.singular.elbow), "{q:?}");
    }
    // Folded, which the drives do not allow but the geometry does: axis 2 to wrist is 6 mm.
    for _ in 0..500 {
        let mut q = random_configuration(&mut random);
        q[2] = PI - PHI + random.uniform(-1e-4..1e-4);
        let pose = arm.pose(&q);
        check(&arm, &pose, &arm.inverse(&pose).expect("reachable"), 1e-12);
    }
}

/// The numerical search from many guesses finds the configurations of the closed form, all of them, and no others.
#[test]
fn a_numerical_search_finds_the_same_configurations() {
    let arm = Arm::default();
    let solver = DampedLeastSquares::default();
    let mut random = Random::new(3);
    let mut poses = vec![arm.pose(&table_1())];
    while poses.len() < 13 {
        let q = random_configuration(&mut random);
        // Away from singularities, where basins are too small to be hit.
        if arm_factors(&q).into_iter().all(|factor| factor > 0.1) {
            poses.push(arm.pose(&q));
        }
    }
    let (mut starts, mut converged) = (0, 0);
    for pose in poses {
        let solutions = arm.inverse(&pose).expect("reachable");
        let mut hits = vec![0; solutions.len()];
        for _ in 0..400 {
            starts += 1;
            let guess = random_configuration(&mut random);
            let Ok(found) = solver.solve(|q| (arm.pose(q), arm.jacobian(q)), &pose, &guess) else { continue };
            converged += 1;
            let branch = solutions.iter().position(|solution| turned_apart(&solution.q, &found.q) < 1e-6);
            hits[branch.unwrap_or_else(|| panic!("{found:?} is missing from {solutions:?}"))] += 1;
        }
        assert!(hits.iter().all(|&hits| hits > 0), "{hits:?} of {solutions:?}");
    }
    // The others end in local minima, with the arm stretched or the wrist above the base.
    assert!(converged * 10 > starts * 8, "{converged} of {starts}");
}

/// Within the ranges of the drives, and for mechanisms without a closed form: the benchmark arm, and four joints of a
/// SCARA arm.
#[test]
fn the_numerical_search_keeps_limits_and_serves_any_mechanism() {
    let arm = Arm::default();
    let limits = &arm.limits;
    let solver = DampedLeastSquares::default().with_limits(limits.lower, limits.upper);
    let mut random = Random::new(31);
    let mut within = || -> JointVector { std::array::from_fn(|i| random.uniform(limits.lower[i]..limits.upper[i])) };
    let (mut found, mut held) = (0, 0);
    for _ in 0..200 {
        let (pose, guess) = (arm.pose(&within()), within());
        match solver.solve(|q| arm.pose_and_jacobian(q), &pose, &guess) {
            Ok(approach) => {
                found += 1;
                assert_eq!(limits.violation(&approach.q), None);
                assert!(apart(&arm.pose(&approach.q), &pose) < 2e-10);
                assert!(approach.evaluations <= solver.evaluations);
            }
            Err(NotReached::AtLimits { best, held: joints }) => {
                held += 1;
                assert_eq!(limits.violation(&best.q), None);
                assert!((0..6).all(|i| !joints[i] || best.q[i] == limits.lower[i] || best.q[i] == limits.upper[i]));
            }
            Err(NotReached::Stationary(best) | NotReached::TooManyEvaluations(best)) => {
                assert_eq!(limits.violation(&best.q), None);
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(found > 60 && held > 10, "{found} {held}");

    let benchmark = Arm6::<f64>::default();
    let solver = DampedLeastSquares::default();
    let model = |q: &JointVector| (benchmark.flange(q), benchmark.flange_jacobian(q));
    let (target, _) = model(&[0.4, -1.1, 0.3, 0.5, 0.8, -0.1]);
    let approach = solver.solve(model, &target, &[0.0, -1.0, 0.0, 0.0, 0.5, 0.0]).expect("reached");
    assert!(apart(&benchmark.flange(&approach.q), &target) < 2e-10 && approach.evaluations < 20);

    let scara = Scara::<f64>::default();
    let model = |q: &[f64; 4]| (scara.flange(q), scara.flange_jacobian(q));
    let (target, _) = model(&[0.4, 1.1, 0.1, 0.5]);
    let approach = DampedLeastSquares::default().solve(model, &target, &[0.0, 0.5, 0.0, 0.0]).expect("reached");
    assert!(apart(&scara.flange(&approach.q), &target) < 2e-10 && approach.evaluations < 20);
    // Four joints do not tilt the hand.
    let tilted = Pose { rotation: arm.pose(&table_1()).rotation, ..target };
    let error = DampedLeastSquares::default().solve(model, &tilted, &[0.0, 0.5, 0.0, 0.0]);
    assert!(matches!(error, Err(NotReached::Stationary(best)) if best.rotation_error > 0.5), "{error:?}");
}

#[test]
fn a_straight_wrist_takes_the_angle_of_the_reference() {
    let arm = Arm::default();
    let q = [0.3, -1.2, 0.4, 0.9, 0.0, -0.5];
    let pose = arm.pose(&q);
    let reference = [0.0, 0.0, 0.0, 0.25, 0.0, 0.0];
    for (solver, theta_4) in
        [(InverseKinematics::default(), 0.0), (InverseKinematics { reference, ..Default::default() }, 0.25)]
    {
        let solutions = solver.solve(&pose).expect("reachable");
        check(&arm, &pose, &solutions, 1e-12);
        let straight: Vec<_> = solutions.iter().filter(|solution| solution.singular.wrist).collect();
        assert_eq!(straight.len(), 1, "one stands for both signs of the wrist: {solutions:?}");
        let only = Singularities { wrist: true, ..Default::default() };
        assert_eq!(straight[0].singular, only);
        assert_eq!(straight[0].q[3], theta_4);
        assert!((straight[0].q[3] + straight[0].q[5] - 0.4).abs() < 1e-14, "the sum is what the pose determines");
    }
    // Half a turn of the wrist is singular, too: there the difference is determined.
    let folded = arm.pose(&[0.3, -1.2, 0.4, 0.9, PI, -0.5]);
    let solutions = InverseKinematics { reference, ..Default::default() }.solve(&folded).expect("reachable");
    check(&arm, &folded, &solutions, 1e-12);
    let straight = solutions.iter().find(|solution| solution.singular.wrist).expect("singular");
    assert!((straight.q[3] - straight.q[5] - 1.4).abs() < 1e-14);
}

/// As close to singular as a number can be: the residual does not grow.
#[test]
fn nearly_singular_poses_keep_their_digits() {
    let arm = Arm::default();
    let mut random = Random::new(23);
    for case in 0..3000 {
        let mut q = random_configuration(&mut random);
        let small = 10_f64.powf(random.uniform(-17.0..-6.0));
        match case % 3 {
            0 => q[4] = small,
            1 => q[4] = PI - small,
            _ => {
                // The wrist near axis 1: θ₃ closes a₁ + a₂ c₂ + l₁ cos(θ₂ + θ₃ + φ) = small.
                q[1] = random.uniform(-2.5..-1.7);
                let cosine = (small - A1 - A2 * q[1].cos()) / A3.hypot(D4);
                q[2] = cosine.acos() - PHI - q[1];
            }
        }
        let pose = arm.pose(&q);
        let solutions = arm.inverse(&pose).unwrap_or_else(|error| panic!("{q:?}: {error}"));
        assert!(!solutions.is_empty());
        check(&arm, &pose, &solutions, 1e-12);
    }
}

#[test]
fn a_wrist_on_axis_1_takes_the_angle_of_the_reference() {
    let arm = Arm::default();
    // Wrist straight above the base: a₁ + a₂ c₂ + l₁ cos(θ₂ + θ₃ + φ) = 0.
    let theta_2 = -2.0_f64;
    let theta_3 = ((-A1 - A2 * theta_2.cos()) / A3.hypot(D4)).acos() - PHI - theta_2;
    // About the base's own axis only the attitude turns.
    let pose = arm.pose(&[0.0, theta_2, theta_3, 0.7, 0.8, 0.2]);
    let wrist = wrist_of(&pose);
    assert!(wrist[0].hypot(wrist[1]) < 1e-15);
    let solver = InverseKinematics { reference: [0.6, 0.0, 0.0, 0.0, 0.0, 0.0], ..Default::default() };
    let solutions = solver.solve(&pose).expect("reachable");
    check(&arm, &pose, &solutions, 1e-12);
    assert_eq!(solutions.len(), 4, "the shoulder's branches are one");
    for solution in &solutions {
        assert_eq!(solution.q[0], 0.6);
        assert_eq!(solution.singular, Singularities { shoulder: true, ..Default::default() });
    }
    // All three singularities at once: the arm stretched cannot have its wrist on axis 1, but a straight wrist can be
    // there.
    let straight = arm.pose(&[0.0, theta_2, theta_3, 0.7, 0.0, 0.2]);
    let solutions = InverseKinematics::default().solve(&straight).expect("reachable");
    check(&arm, &straight, &solutions, 1e-12);
    assert!(solutions.iter().any(|solution| solution.singular.shoulder && solution.singular.wrist));
}

#[test]
fn a_stretched_or_folded_arm_has_one_elbow() {
    let arm = Arm::default();
    let q = [0.3, -0.7, -PHI, 0.9, 0.5, -0.5];
    let pose = arm.pose(&q);
    let solutions = arm.inverse(&pose).expect("reachable");
    check(&arm, &pose, &solutions, 1e-12);
    let only = Singularities { elbow: true, ..Default::default() };
    let front: Vec<_> = solutions.iter().filter(|solution| solution.branch.shoulder == Shoulder::Front).collect();
    assert_eq!(front.len(), 2);
    assert!(front.iter().all(|solution| solution.singular == only && solution.branch.elbow == Elbow::Positive));
    // Folded, with the wrist 6 mm from axis 2, the branches are one as well.
    let folded = arm.pose(&[0.3, -0.7, PI - PHI, 0.9, 0.5, -0.5]);
    let solutions = arm.inverse(&folded).expect("reachable");
    check(&arm, &folded, &solutions, 1e-12);
    let front: Vec<_> = solutions.iter().filter(|solution| solution.branch.shoulder == Shoulder::Front).collect();
    assert_eq!(front.len(), 2, "{front:?}");
    assert!(front.iter().all(|solution| solution.singular == only));
    assert!(
        solutions.iter().filter(|solution| solution.branch.shoulder == Shoulder::Back).all(|back| !back.singular.any())
    );
    let reference = &data()["elbow_singularity_theta3_deg"];
    assert_close("θ₃", &[(PI - PHI).to_degrees(), (-PHI).to_degrees()], &numbers::<2>(reference), 1e-14);
}

#[test]
fn limits_are_kept_on_request() {
    let arm = Arm::default();
    let limits = &arm.limits;
    let home = [0.2, -1.3, 0.3, 3.5, 0.6, -4.0];
    assert_eq!(limits.violation(&home), None);
    let solutions = arm.inverse(&arm.pose(&home)).expect("reachable");
    let admitted = solutions.within(limits, &[0.0; 6]);
    assert!(!admitted.is_empty() && admitted.len() < solutions.len(), "{admitted:?}");
    assert!(admitted.iter().all(|solution| limits.violation(&solution.q).is_none()));
    // Those left out have an angle that no turn brings into its range.
    for solution in &solutions {
        let kept = admitted.of_branch(solution.branch).is_some();
        let can = (0..6).all(|i| (-2..=2).any(|turn| limits.admits(i, solution.q[i] + f64::from(turn) * TAU)));
        assert_eq!(kept, can, "{solution:?}");
    }
    // The nearest is the configuration itself, with its turns of axes 4 and 6.
    let nearest = solutions.nearest(limits, &home).expect("within");
    assert_close("nearest", &nearest.q, &home, 1e-13);
    let elsewhere = [0.2, -1.3, 0.3, 3.5 - TAU, 0.6, -4.0 + TAU];
    assert_close("the other turns", &solutions.nearest(limits, &elsewhere).expect("within").q, &elsewhere, 1e-13);
    // Wrapped, they are all there; those that can be are in range.
    let wrapped = solutions.wrapped(limits, &home);
    assert_eq!(wrapped.len(), solutions.len());
    for (moved, solution) in wrapped.iter().zip(&solutions) {
        assert!(turned_apart(&moved.q, &solution.q) < 1e-14);
        for i in 0..6 {
            let can = (-2..=2).any(|turn| limits.admits(i, solution.q[i] + f64::from(turn) * TAU));
            assert_eq!(limits.admits(i, moved.q[i]), can, "{moved:?}");
        }
    }
    // Nothing is within ranges that are crossed, or NaN.
    let crossed = JointLimits { lower: limits.upper, upper: limits.lower, ..*limits };
    assert!(solutions.within(&crossed, &home).is_empty() && solutions.nearest(&crossed, &home).is_none());
    let unknown = JointLimits { lower: [f64::NAN; 6], ..*limits };
    assert!(solutions.within(&unknown, &home).is_empty());
    // The thesis' table 1 is outside of the range of axis 2, and the nearest configuration is another one.
    let thesis = arm.inverse(&arm.pose(&table_1())).expect("reachable");
    assert_eq!(limits.violation(&table_1()), Some(1));
    assert!(thesis.within(limits, &table_1()).iter().all(|solution| turned_apart(&solution.q, &table_1()) > 0.1));
    // By how much, where all cross a limit.
    assert_eq!(solutions.choose(limits, &home), Ok(nearest_of(&solutions, limits, &home)));
    let narrow = JointLimits { lower: [-0.1; 6], upper: [0.1; 6], ..*limits };
    match solutions.choose(&narrow, &home) {
        Err(error @ Error { failure: Failure::LimitExceeded { quantity: EXCESS, index, value: by, .. }, .. }) => {
            let worst = |q: &JointVector| (0..6).map(|i| narrow.excess(i, q[i])).fold(0.0, f64::max);
            let best = |solution: &Solution| by == worst(&solution.q) && by == narrow.excess(index, solution.q[index]);
            assert!(by > 0.0 && solutions.iter().any(best), "{error}");
            assert!(solutions.iter().all(|solution| worst(&solution.q) >= by));
            assert!(error.to_string().contains(&format!("joint {index} comes to {by}")), "{error}");
        }
        other => panic!("{other:?}"),
    }
    let refused = solutions.choose(&crossed, &home).unwrap_err().invalid().expect("a number");
    assert!(refused.parameter == "largest angle of joint" && refused.index == Some(0), "{refused}");
    let free = JointLimits { lower: [-TAU; 6], upper: [TAU; 6], ..*limits };
    assert_close("table 1", &thesis.nearest(&free, &table_1()).expect("free").q, &table_1(), 1e-13);
}

fn nearest_of(solutions: &Solutions, limits: &JointLimits, near: &JointVector) -> Solution {
    solutions.nearest(limits, near).expect("within")
}

#[test]
fn out_of_reach_the_error_says_by_how_much() {
    let arm = Arm::default();
    let level = [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]];
    let reach = A2 + A3.hypot(D4);
    assert!((A1 + reach - number(&data()["reach"]["max_wrist_distance_from_axis1_m"])).abs() < 1e-14);
    // The wrist at the height of axis 2, 0.1 m beyond the stretched arm.
    let pose = Pose { position: [A1 + reach + D6 + 0.1, 0.0, D1], rotation: level };
    match arm.inverse(&pose) {
        Err(error @ Error { failure: Failure::TooFar { by }, .. }) => {
            assert!((by - 0.1).abs() < 1e-14, "{by}");
            assert!(error.to_string().starts_with("the wrist is out of reach by 0.1"), "{error}");
        }
        other => panic!("{other:?}"),
    }
    // Just within, and just at the end.
    for beyond in [-1e-9, -1e-12, -1e-15, 0.0, 1e-15] {
        let pose = Pose { position: [A1 + reach + D6 + beyond, 0.0, D1], rotation: level };
        let solutions = arm.inverse(&pose).unwrap_or_else(|error| panic!("{beyond:e}: {error}"));
        check(&arm, &pose, &solutions, 1e-12);
    }
    let pose = Pose { position: [A1 + reach + D6 + 1e-9, 0.0, D1], rotation: level };
    assert!(
        matches!(arm.inverse(&pose), Err(Error { failure: Failure::TooFar { by }, .. }) if (by - 1e-9).abs() < 1e-14)
    );
    // The wrist on axis 2: nearer than the folded arm gets, and too far for the other shoulder? No: that one reaches
    // it.
    let near = Pose { position: [A1 + D6, 0.0, D1], rotation: level };
    let solutions = arm.inverse(&near).expect("the other shoulder reaches it");
    check(&arm, &near, &solutions, 1e-12);
    assert!(solutions.iter().all(|solution| solution.branch.shoulder == Shoulder::Back));
}

#[test]
fn what_is_no_pose_is_refused() {
    let arm = Arm::default();
    let good = arm.pose(&table_1());
    let mut mirrored = good;
    mirrored.rotation = mirrored.rotation.map(|row| [row[0], row[1], -row[2]]);
    match arm.inverse(&mirrored) {
        Err(Error { failure: Failure::Rotation(NotARotation::Reflection { determinant }), .. }) => {
            assert!((determinant + 1.0).abs() < 1e-14);
        }
        other => panic!("{other:?}"),
    }
    for broken in [f64::NAN, f64::INFINITY] {
        let mut pose = good;
        pose.rotation[2][1] = broken;
        let error = NotARotation::NonFinite { row: 2, column: 1 };
        assert_eq!(arm.inverse(&pose), Err(error.into()));
        let mut pose = good;
        pose.position[1] = broken;
        let refused = arm.inverse(&pose).unwrap_err().invalid().expect("a number");
        assert!(refused.parameter == "position" && refused.index == Some(1), "{refused}");
    }
    // The largest numbers there are, and no overflow into NaN.
    let far = Pose { position: [1e300, -1e300, 1e300], ..good };
    assert!(matches!(arm.inverse(&far), Err(Error { failure: Failure::TooFar { by }, .. }) if by > 1e299));
}

#[test]
fn inexact_rotations_are_orthonormalized_or_rejected() {
    let arm = Arm::default();
    // Four digits: orthonormalized by default, and near the thesis' table.
    let solutions = arm.inverse(&printed_pose()).expect("within the tolerance");
    assert_eq!(solutions.len(), 8);
    let nearest = solutions.iter().map(|solution| turned_apart(&solution.q, &table_1())).fold(f64::INFINITY, f64::min);
    assert!(nearest < 2e-4, "{nearest}");
    let found = arm.pose(&solutions[0].q);
    assert!(apart(&found, &printed_pose()) < 1e-4);
    assert!(to_matrix(&found.rotation).determinant() - 1.0 < 1e-14);
    let strict = InverseKinematics { inexact: Inexact::Reject(1e-6), ..Default::default() };
    match strict.solve(&printed_pose()) {
        Err(Error { failure: Failure::Rotation(NotARotation::NotOrthogonal { error, tolerance }), .. }) => {
            assert!((error - 8.558e-5).abs() < 1e-8 && tolerance == 1e-6, "{error:e}");
        }
        other => panic!("{other:?}"),
    }
    let exact = arm.pose(&table_1());
    assert_eq!(strict.solve(&exact), arm.inverse(&exact));
}

#[test]
fn the_printed_formulas_give_the_printed_angles() {
    let found = printed::inverse_kinematics(&printed_pose()).map(f64::to_degrees);
    let rounded = found.map(|angle| (angle * 1e4).round() / 1e4);
    assert_eq!(rounded, [45.0, 29.9977, 29.9993, -44.9962, 30.0036, -0.0052]);
    assert_close("all digits", &found, &numbers::<6>(&data()["ik_printed_rounded_inputs_deg"]), 1e-12);
}
