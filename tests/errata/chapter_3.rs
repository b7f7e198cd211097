//! Chapter 3, the serial manipulator, against the generated `irb7600`.

use std::f64::consts::{FRAC_PI_2, PI};

use mbs_arm::inverse::{Branch, Elbow, Shoulder, Wrist};
use mbs_arm::jacobian::{condition, determinant};
use mbs_arm::trajectory::{Motion, Piecewise, quartic, quintic, two_piece_quartic, work};
use mbs_arm::{A1, A2, A3, Arm, D1, D4, D6, JointLimits, JointVector, printed};
use mbs_models::irb7600::{Irb7600, Params};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::arms::{irb7600, thesis_values};
use mbs_tests::reference::lagrange::euler_lagrange;
use nalgebra::{Matrix6, SMatrix, Vector6};

use super::{apart, refuted, times};
use crate::arm_dynamics::{mass_centers, mass_matrix_of_3_19};
use crate::arm_kinematics::{apart as poses_apart, table_1};
use crate::arm_trajectory::{DURATION, table2_ends};

type Rotation = [[f64; 3]; 3];

fn postures(seed: u64, count: usize) -> impl Iterator<Item = JointVector> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| std::array::from_fn(|_| random.uniform(-PI..PI)))
}

/// (3.3) as multiplied out, and (3.4) as printed.
pub(crate) fn flange(q: &JointVector) -> (Rotation, [f64; 3]) {
    let [(s1, c1), (s2, c2), (s4, c4), (s5, c5), (s6, c6)] = [q[0], q[1], q[3], q[4], q[5]].map(f64::sin_cos);
    let (s23, c23) = (q[1] + q[2]).sin_cos();
    let [a, b] = [c4 * c5 * c6 - s4 * s6, s4 * c5 * c6 + c4 * s6];
    let [e, f] = [-c4 * c5 * s6 - s4 * c6, -s4 * c5 * s6 + c4 * c6];
    let arm = SMatrix::<f64, 3, 3>::from([[c1 * c23, s1 * c23, -s23], [s1, -c1, 0.0], [-c1 * s23, -s1 * s23, -c23]]);
    let wrist = SMatrix::<f64, 3, 3>::from([[a, b, s5 * c6], [e, f, -s5 * s6], [-c4 * s5, -s4 * s5, c5]]);
    let ahead = A1 + A2 * c2 + A3 * c23 - D4 * s23 - D6 * c5 * s23 - D6 * c23 * c4 * s5;
    let position = [
        c1 * ahead - D6 * s1 * s4 * s5,
        s1 * ahead + D6 * c1 * s4 * s5,
        -A2 * s2 - A3 * s23 + D6 * c4 * s23 * s5 - D4 * c23 - D6 * c23 * c5 + D1,
    ];
    ((arm * wrist).transpose().into(), position)
}

/// The matrix is lost in print; as multiplied out it is the generated one, and so is the position (3.4).
#[test]
fn e01_orientation_of_the_flange() {
    let arm = Arm::default();
    for q in postures(301, 200) {
        let (found, (rotation, position)) = (arm.pose(&q), flange(&q));
        assert_close("(3.3)", &rotation.concat(), &found.rotation.concat(), 4e-15);
        assert_close("(3.4)", &position, &found.position, 4e-15);
    }
}

/// Numerators and denominators of (3.7) to (3.10), as printed, for the rotation and the position of a flange.
fn quotients(h: &Rotation, p: &[f64; 3], [theta_1, theta_23, theta_4]: [f64; 3]) -> [[f64; 2]; 4] {
    let [(s1, c1), (s23, c23), (s4, c4)] = [theta_1, theta_23, theta_4].map(f64::sin_cos);
    let ahead = |j: usize| h[0][j] * c1 + h[1][j] * s1;
    let aside = |j: usize| h[0][j] * s1 - h[1][j] * c1;
    let sixth = |j: usize| -ahead(j) * c23 * s4 + h[2][j] * s23 * s4 + aside(j) * c4;
    [
        [p[1] - D6 * h[1][2], p[0] - D6 * h[0][2]],
        [aside(2), ahead(2) * c23 - h[2][2] * s23],
        [ahead(2) * c23 * c4 - h[2][2] * s23 * c4 + aside(2) * s4, ahead(2) * s23 + h[2][2] * c23],
        [sixth(0), sixth(1)],
    ]
}

/// Principal values of quotients reach one pose in ten, atan2 of the printed arguments another pose; with the signs of
/// sine and cosine all angles come back.
#[test]
fn e02_arc_tangents_of_quotients() {
    let arm = Arm::default();
    let mut random = Random::new(5);
    let mut right = |most: f64| {
        let reached =
            |q: JointVector| poses_apart(&arm.pose(&printed::inverse_kinematics(&arm.pose(&q))), &arm.pose(&q)) < 1e-9;
        (0..2000).filter(|_| reached(std::array::from_fn(|_| random.uniform(-most..most)))).count()
    };
    assert!((140..280).contains(&right(PI)), "a tenth of all poses");
    assert!(right(1.0) > 1700, "nearly everywhere in front of the arm");

    for q in postures(302, 200) {
        let pose = arm.pose(&q);
        let [first, fourth, fifth, sixth] = quotients(&pose.rotation, &pose.position, [q[0], q[1] + q[2], q[3]]);
        let same = |what: &str, [n, d]: [f64; 2], sign: f64, angle: f64| {
            let found = (sign * n).atan2(sign * d);
            assert_close(what, &[found.sin(), found.cos()], &[angle.sin(), angle.cos()], 1e-12);
        };
        let forward = A1 + A2 * q[1].cos() + A3 * (q[1] + q[2]).cos() - D4 * (q[1] + q[2]).sin();
        same("(3.7)", first, forward.signum(), q[0]);
        same("(3.8)", fourth, -q[4].sin().signum(), q[3]);
        same("(3.9)", fifth, -1.0, q[4]);
        same("(3.10)", sixth, 1.0, q[5]);
    }

    let (pose, mut q) = (arm.pose(&table_1()), table_1());
    for (i, quotient) in [(3, 1), (4, 2), (5, 3)] {
        let [n, d] = quotients(&pose.rotation, &pose.position, [q[0], q[1] + q[2], q[3]])[quotient];
        q[i] = n.atan2(d);
    }
    assert_close("plain atan2", &[q[3], q[4], q[5].abs()].map(f64::to_degrees), &[135.0, 150.0, 180.0], 1e-12);
    assert!(poses_apart(&arm.pose(&q), &pose) > 0.1, "another pose");
}

/// Without the bracket numerator and denominator are sine and cosine of θ₆. Had one been lost behind the leading minus,
/// the denominator would be another.
#[test]
fn e03_a_bracket_too_many() {
    let arm = Arm::default();
    let mut worst = 0.0_f64;
    for q in postures(303, 200) {
        let h = arm.pose(&q).rotation;
        let [.., [n, d]] = quotients(&h, &[0.0; 3], [q[0], q[1] + q[2], q[3]]);
        assert_close("(3.10)", &[n, d], &[q[5].sin(), q[5].cos()], 1e-14);
        let [(s1, c1), (s23, c23), (s4, c4)] = [q[0], q[1] + q[2], q[3]].map(f64::sin_cos);
        let [h12, h22, h32] = [h[0][1], h[1][1], h[2][1]];
        let bracketed = -((h12 * c1 + h22 * s1) * c23 * s4 + h32 * s23 * s4 + (h12 * s1 - h22 * c1) * c4);
        worst = worst.max((bracketed - d).abs());
    }
    assert!(worst > 1.0, "{worst}");
}

/// γ of (3.11), β of (3.12), and the wrist seen from axis 2, at this first angle.
fn triangle(wrist: [f64; 3], theta_1: f64) -> ([f64; 2], [f64; 2]) {
    let (s1, c1) = theta_1.sin_cos();
    let (r, h) = (wrist[0] * c1 + wrist[1] * s1 - A1, wrist[2] - D1);
    let (l1, p14) = (A3.hypot(D4), r.hypot(h));
    let gamma = ((A2 * A2 + l1 * l1 - p14 * p14) / (2.0 * A2 * l1)).acos();
    let beta = ((A2 * A2 + p14 * p14 - l1 * l1) / (2.0 * A2 * p14)).acos();
    ([gamma, beta], [r, h])
}

fn wrist_of(arm: &Arm, q: &JointVector) -> [f64; 3] {
    let pose = arm.pose(q);
    [0, 1, 2].map(|i| pose.position[i] - D6 * pose.rotation[i][2])
}

/// The pose of table 1 is reached in eight ways, of which the print has one; (3.12) is wrong behind the line from base
/// to shoulder even on its own branch.
#[test]
fn e04_one_configuration_of_eight() {
    let arm = Arm::default();
    let pose = arm.pose(&table_1());
    let solutions = arm.inverse(&pose).expect("reachable");
    assert_eq!(solutions.len(), 8);
    let printed_ones = printed::inverse_kinematics(&pose);
    assert_eq!(solutions.iter().filter(|solution| apart(&solution.q, &printed_ones) < 1e-9).count(), 1);
    let phi = D4.atan2(A3);
    for solution in &solutions {
        let Branch { elbow, .. } = solution.branch;
        let e = if elbow == Elbow::Positive { 1.0 } else { -1.0 };
        let ([gamma, beta], [r, h]) = triangle(wrist_of(&arm, &table_1()), solution.q[0]);
        let found = [(-h).atan2(r) - e * beta, e * (PI - gamma) - phi];
        let turns = [0, 1].map(|i| ((found[i] - solution.q[1 + i]) / (2.0 * PI)).round());
        let want = [0, 1].map(|i| solution.q[1 + i] + 2.0 * PI * turns[i]);
        assert_close("(3.12), (3.11)", &found, &want, 1e-12);
    }

    // The wrist 80° above the horizontal of axis 2, in front of axis 1, elbow and shoulder on the branch of the print.
    let mut q = [0.3, 0.0, 0.5, 0.4, 0.7, 0.2];
    let ([_, beta], _) = triangle(wrist_of(&arm, &q), q[0]);
    q[1] = -80f64.to_radians() - beta;
    let behind = arm.pose(&q);
    let first = Branch { shoulder: Shoulder::Front, elbow: Elbow::Positive, wrist: Wrist::Positive };
    let right = arm.inverse(&behind).expect("reachable").of_branch(first).expect("that branch").q;
    assert_close("all branches", &right, &q, 1e-12);
    let printed_ones = printed::inverse_kinematics(&behind);
    assert_close("(3.11) holds", &[printed_ones[2]], &[q[2]], 1e-12);
    refuted("(3.12)", &printed_ones[1..2], &q[1..2], 0.1);
}

/// A link is moved by its own joint and those before it.
#[test]
fn e05_link_velocities_take_their_own_joints() {
    let arm = Arm::default();
    let mut random = Random::new(305);
    for q in postures(306, 50) {
        let qd: JointVector = random.array(-2.0..2.0);
        let jacobians = arm.mass_center_jacobians(&q);
        for (k, jacobian) in jacobians.iter().enumerate() {
            assert!(jacobian.iter().all(|row| row[k + 1..].iter().all(|&entry| entry == 0.0)), "link {}", k + 1);
        }
        let found = arm.model.center_2_velocity(&q, &qd);
        assert_close("J_v3, J_ω3", &times(&jacobians[2], &qd), &found, 1e-13);
    }
    // With n = 6, as (3.15) has it, it is the velocity of the flange.
    let thesis = thesis_values();
    let flange = times(&arm.jacobian(&thesis.q), &thesis.qd);
    refuted("(3.15) for link 3", &flange, &arm.model.center_2_velocity(&thesis.q, &thesis.qd), 0.1);
}

/// The left side of (3.17) by nested dual numbers: six torques, all different.
#[test]
fn e06_each_torque_has_its_index() {
    let thesis = thesis_values();
    let left = euler_lagrange(&irb7600(), &thesis.q, &thesis.qd, &thesis.qdd);
    let torques = Irb7600::<f64>::default().inverse_dynamics(&thesis.q, &thesis.qd, &thesis.qdd);
    assert_close("(3.17)", &left, &torques, 1e-12);
    for k in 1..6 {
        refuted("one τ for all", &[torques[0]; 1], &[torques[k]; 1], 50.0);
    }
}

/// Twice the speed makes four times the Coriolis forces; the printed ones, times q̇ once more, grow eightfold.
#[test]
fn e07_coriolis_forces_are_quadratic() {
    let (arm, thesis) = (Irb7600::<f64>::default(), thesis_values());
    let twice = thesis.qd.map(|rate| 2.0 * rate);
    let forces = |qd: &JointVector| times(&arm.coriolis_matrix(&thesis.q, qd), qd);
    let printed = |qd: &JointVector| -> [f64; 6] {
        let forces = forces(qd);
        std::array::from_fn(|k| forces[k] * qd[k])
    };
    let still = irb7600().newton_euler(&thesis.q, &[0.0; 6], &[0.0; 6]);
    let moving = irb7600().newton_euler(&thesis.q, &thesis.qd, &[0.0; 6]);
    let by_newton: [f64; 6] = std::array::from_fn(|k| moving[k] - still[k]);
    assert_close("c", &forces(&thesis.qd), &by_newton, 1e-12);
    assert_close("c(2q̇)", &forces(&twice), &forces(&thesis.qd).map(|c| 4.0 * c), 1e-13);
    assert_close("printed (2q̇)", &printed(&twice), &printed(&thesis.qd).map(|c| 8.0 * c), 1e-13);
    refuted("(3.19), Coriolis forces", &printed(&thesis.qd), &by_newton, 40.0);

    // One link for the sum.
    let last = |values: [f64; 6]| std::array::from_fn(|i| if i == 5 { values[5] } else { 0.0 });
    let all = *arm.params();
    let one = Params { mass: last(all.mass), i_xx: last(all.i_xx), i_yy: last(all.i_yy), i_zz: last(all.i_zz), ..all };
    let right = arm.mass_matrix(&thesis.q).concat();
    assert_close("the sum", &mass_matrix_of_3_19(&arm, &all, &thesis.q).concat(), &right, 1e-13);
    refuted("(3.19) without a sum", &mass_matrix_of_3_19(&arm, &one, &thesis.q).concat(), &right, 1000.0);
}

/// With columns of the frames' origins, or inertias in the links' axes, M is another matrix.
#[test]
fn e08_inertia_at_the_mass_centre() {
    let (arm, q) = (Irb7600::<f64>::default(), thesis_values().q);
    let params = *arm.params();
    let right = arm.mass_matrix(&q).concat();
    let of = |linear: &dyn Fn(usize) -> [[f64; 6]; 6], turned: bool| {
        let mut m = SMatrix::<f64, 6, 6>::zeros();
        for (i, (pose, jacobian)) in mass_centers(&arm, &q).into_iter().enumerate() {
            let rows = |jacobian: [[f64; 6]; 6], from: usize| {
                SMatrix::<f64, 3, 6>::from_fn(|row, column| jacobian[from + row][column])
            };
            let (v, w) = (rows(linear(i), 0), rows(jacobian, 3));
            let own = SMatrix::<f64, 3, 3>::from_diagonal(&[params.i_xx[i], params.i_yy[i], params.i_zz[i]].into());
            let r = SMatrix::<f64, 3, 3>::from_fn(|row, column| pose.rotation[row][column]);
            let inertia = if turned { r * own * r.transpose() } else { own };
            m += params.mass[i] * v.transpose() * v + w.transpose() * inertia * w;
        }
        <[[f64; 6]; 6]>::from(m).concat()
    };
    let centres = mass_centers(&arm, &q).map(|(_, jacobian)| jacobian);
    assert_close("(3.19)", &of(&|i| centres[i], true), &right, 1e-13);
    refuted("I_i not turned", &of(&|i| centres[i], false), &right, 1.0);
    // (3.15) has the flange in J_vi, with the columns of the joints before link i.
    let flange = arm.flange_jacobian(&q);
    let own = |i: usize| flange.map(|row| std::array::from_fn(|k| if k <= i { row[k] } else { 0.0 }));
    refuted("J_vi of (3.15)", &of(&own, true), &right, 100.0);
}

/// Rows for q, q̇, q̈ at 0 and 1 of c₀ + c₁ s + … + c₄ s⁴, and what they should be from rest to rest.
#[test]
fn e09_six_conditions_on_five_coefficients() {
    let rows: [[f64; 5]; 6] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 2.0, 0.0, 0.0],
        [1.0, 1.0, 1.0, 1.0, 1.0],
        [0.0, 1.0, 2.0, 3.0, 4.0],
        [0.0, 0.0, 2.0, 6.0, 12.0],
    ];
    let wanted = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    assert_eq!(SMatrix::<f64, 6, 5>::from_fn(|i, j| rows[i][j]).rank(1e-9), 5);
    assert_eq!(Matrix6::from_fn(|i, j| if j < 5 { rows[i][j] } else { wanted[i] }).rank(1e-9), 6);
    // The least squares that any quartic leaves.
    let matrix = SMatrix::<f64, 6, 5>::from_fn(|i, j| rows[i][j]);
    let best = matrix.svd(true, true).solve(&Vector6::from(wanted), 1e-12).expect("a solution");
    assert!((matrix * best - Vector6::from(wanted)).norm() > 0.08);

    let [start, stop] = table2_ends();
    let end = quartic(start, [0.0; 6], stop, DURATION).unwrap().at(DURATION).unwrap();
    let left: JointVector = std::array::from_fn(|i| -12.0 * (stop[i] - start[i]) / (DURATION * DURATION));
    assert_close("−12 D/T²", &end.qdd, &left, 1e-15);
    let five = quintic(start, [0.0; 6], stop, DURATION).unwrap();
    assert_close("all six", &five.at(DURATION).unwrap().qdd, &[0.0; 6], 1e-15);
    let two = two_piece_quartic(start, [0.0; 6], stop, DURATION).unwrap();
    assert_close("all six", &two.at(DURATION).unwrap().qdd, &[0.0; 6], 1e-15);
}

/// What "Figure 33", "(6.11)" and "Figure 6.4" mean has its place in the documentation; what they say has none.
#[test]
fn e10_references_to_other_numbers() {
    let pages = crate::thesis_map::chapters();
    let has = |text: &str| pages.iter().any(|(_, page)| page.contains(text));
    assert!(has("| Figure 3.3 |") && has("**(7.11)**") && has("| Figure 7.4 |"));
    assert!(!has("| Figure 33 |") && !has("**(6.") && !has("| Figure 6."));
}

/// With the robot's own angles, the second is larger by 90°: tables 1 and 2 are beyond its ranges, and the flange below
/// its base.
#[test]
fn e11_angles_of_denavit_and_hartenberg() {
    let (arm, limits) = (Arm::default(), JointLimits::IRB7600);
    let zero = arm.pose(&[0.0, -FRAC_PI_2, 0.0, 0.0, 0.0, 0.0]);
    assert_close("the robot's zero", &zero.position, &[1.716, 0.0, 2.02], 1e-15);
    refuted("θ = 0 for it", &arm.pose(&[0.0; 6]).position, &zero.position, 1.0);
    let [start, stop] = table2_ends();
    let own = |q: &JointVector| (q[1] + FRAC_PI_2).to_degrees();
    assert_close("axis 2", &[own(&table_1()), own(&stop)], &[120.0, 180.0], 1e-13);
    assert_eq!(limits.violation(&table_1()), Some(1));
    assert!(limits.excess(1, stop[1]) > 1.0 && limits.excess(2, stop[2]) > 1.0);
    let heights = [table_1(), start].map(|q| arm.pose(&q).position[2]);
    assert_close("below the base", &heights, &[-0.460_100_812_636, -0.647_375_921_796], 1e-12);
}

/// From rest to rest over unit way and time the largest accelerations are 12, 6 and 10/√3.
#[test]
fn e48_quartic_has_the_largest_acceleration() {
    fn peak<const P: usize>(motion: &Piecewise<1, P>) -> f64 {
        motion.acceleration_extrema()[0].farthest().value.abs()
    }
    let (start, rest, stop) = ([0.0], [0.0], [1.0]);
    let one = quartic(start, rest, stop, 1.0).unwrap();
    let found = [
        peak(&one),
        peak(&two_piece_quartic(start, rest, stop, 1.0).unwrap()),
        peak(&quintic(start, rest, stop, 1.0).unwrap()),
    ];
    assert_close("largest accelerations", &found, &[12.0, 6.0, 10.0 / 3.0_f64.sqrt()], 1e-13);
    assert_close("a jump at the end", &one.at(1.0).unwrap().qdd, &[-12.0], 1e-13);
    // 16/9 at two thirds.
    let fastest = one.velocity_extrema()[0].highest;
    assert!((fastest.value - 16.0 / 9.0).abs() < 1e-15 && (fastest.time - 2.0 / 3.0).abs() < 1e-15);
}

/// Both cases stay below a tenth of the joints' speeds, and the second needs less work.
#[test]
fn e49_initial_velocity_costs_no_more() {
    let (arm, limits, [start, stop]) = (Irb7600::<f64>::default(), JointLimits::IRB7600, table2_ends());
    let [first, second] = [0.0, 1.5_f64.to_radians()].map(|rate| {
        let motion = quartic(start, [rate; 6], stop, DURATION).unwrap();
        let fastest = motion.velocity_extrema().map(|extrema| extrema.farthest().value.abs());
        assert!(fastest.iter().all(|&rate| rate <= 4.0_f64.to_radians()), "{fastest:?}");
        assert!((0..6).all(|i| fastest[i] < 0.1 * limits.speed[i]));
        work::energy(&arm, &motion).unwrap().value
    });
    assert!((first - 9546.2).abs() < 0.1 && (second - 9509.1).abs() < 0.1, "{first} {second}");
    assert!(second < first, "the print: more");
}

/// det J changes its sign on the way: no joint velocity gives the flange one that was asked for.
#[test]
fn e50_motion_through_a_singularity() {
    let (arm, [start, stop]) = (Arm::default(), table2_ends());
    assert!(determinant(&start) * determinant(&stop) < 0.0);
    for (rate, time) in [(0.0, 39.638_804_823), (1.5_f64.to_radians(), 37.085_631_415)] {
        let motion = quartic(start, [rate; 6], stop, DURATION).unwrap();
        let before = |early: f64| motion.at(time - early).unwrap().q;
        assert!(determinant(&before(1e-6)) * determinant(&before(-1e-6)) < 0.0);
        // Resolved from a velocity across the lost direction, rates grow as the inverse of the time left.
        assert!(condition(&arm.jacobian(&before(1e-6))) > 1e6, "at the elbow");
        let rates = |early: f64| {
            let qd = arm.joint_velocity(&before(early), &[0.1, 0.1, 0.1, 0.0, 0.0, 0.0]).expect("not there yet");
            qd.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
        };
        let growth = rates(1e-4) / rates(1e-3);
        assert!((growth - 10.0).abs() < 0.1, "{growth}");
        // The joints' own motion passes.
        assert!(motion.at(time).unwrap().qd.iter().all(|rate| rate.abs() < 0.07));
    }
}
