//! (3.1)–(3.18): the arm, from Table 1 as printed, against the generated `irb7600`.

use mbs_arm::Arm;
use mbs_models::irb7600::Irb7600;
use mbs_runtime::{Dual, Pose};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::arms::thesis_values;
use nalgebra::{Matrix4, SMatrix, Vector3};

use super::{along, assert_shown};
use crate::arm_kinematics::table_1;
use crate::errata::{chapter_3, times};

/// Table 1: d \[m\], a \[m\], α \[°\].
const TABLE_1: [[f64; 3]; 6] = [
    [0.78, 0.41, -90.0],
    [0.0, 1.075, 0.0],
    [0.0, 0.165, -90.0],
    [1.056, 0.0, 90.0],
    [0.0, 0.0, -90.0],
    [0.25, 0.0, 0.0],
];

/// (3.1), as printed.
fn equation_3_1(theta: f64, [d, a, alpha]: [f64; 3]) -> Matrix4<f64> {
    let (s, c) = theta.sin_cos();
    // Sine and cosine of −90, 0 and 90° without rounding.
    let (sa, ca) = (alpha / 90.0, 1.0 - (alpha / 90.0).abs());
    Matrix4::from_row_slice(
        &[[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]].concat(),
    )
}

/// (3.2): `T_0⁰` to `T_6⁰`.
fn equation_3_2(q: &[f64; 6]) -> [Matrix4<f64>; 7] {
    let mut chain = [Matrix4::identity(); 7];
    for i in 0..6 {
        chain[i + 1] = chain[i] * equation_3_1(q[i], TABLE_1[i]);
    }
    chain
}

fn postures(seed: u64) -> impl Iterator<Item = [f64; 6]> {
    let mut random = Random::new(seed);
    (0..100).map(move |_| random.array(-3.0..3.0))
}

#[test]
fn equations_3_1_and_3_2_are_the_generated_frames() {
    let arm = Irb7600::<f64>::default();
    for q in postures(31) {
        let chain = equation_3_2(&q);
        let flange = arm.flange(&q);
        let turned = chain[6].fixed_view::<3, 3>(0, 0).transpose();
        assert_close("rotation", turned.as_slice(), &flange.rotation.concat(), 4e-15);
        assert_close("position", &chain[6].as_slice()[12..15], &flange.position, 4e-15);
        // The frame of the third link, moved to its mass centre.
        let p = arm.params();
        let centre = chain[3] * nalgebra::Vector4::new(p.com_x[2], p.com_y[2], p.com_z[2], 1.0);
        assert_close("link 3", &centre.as_slice()[..3], &arm.center_2(&q).position, 4e-15);
    }
}

/// (3.3) and (3.4) at Table 1, as the page shows them; (3.20) and (3.21) are the same in four decimals.
#[test]
fn equations_3_3_and_3_4_in_numbers() {
    let (q, thesis) = (table_1(), thesis_values());
    let (rotation, position) = chapter_3::flange(&q);
    let Pose { rotation: generated, position: place } = Irb7600::<f64>::default().flange(&q);
    assert_close("(3.3)", &rotation.concat(), &generated.concat(), 4e-16);
    assert_close("(3.4)", &position, &place, 4e-16);
    assert_close("another program", &rotation.concat(), &thesis.rotation.concat(), 1e-12);
    for row in rotation {
        assert_shown(3, &row, 10);
    }
    assert_shown(3, &position, 10);
}

/// (3.5), (3.6): twelve entries of a pose, of which six move by themselves.
#[test]
fn equation_3_6_has_six_independent_rows() {
    let arm = Irb7600::<Dual<f64>>::default();
    let (q, own) = (table_1(), Irb7600::<f64>::default());
    let slopes = SMatrix::<f64, 12, 6>::from_fn(|row, joint| {
        let along = along(&q, &std::array::from_fn(|i| f64::from(u8::from(i == joint))));
        let pose = arm.flange(&along);
        if row < 9 { pose.rotation[row / 3][row % 3].derivative } else { pose.position[row - 9].derivative }
    });
    assert_eq!(slopes.rank(1e-9), 6);
    let solutions = Arm::default().inverse(&own.flange(&q)).expect("reachable");
    for solution in &solutions {
        let pose = own.flange(&solution.q);
        let h = own.flange(&q);
        assert_close("T = H, rotation", &pose.rotation.concat(), &h.rotation.concat(), 1e-14);
        assert_close("T = H, position", &pose.position, &h.position, 1e-14);
    }
}

/// (3.15) and (3.16) from the chain (3.2) are the columns of the generated Jacobian, and (3.13) with the q̇ of (3.14)
/// the velocity of the flange.
#[test]
fn equations_3_13_to_3_16_are_the_generated_jacobian() {
    let (arm, mut random) = (Irb7600::<f64>::default(), Random::new(316));
    for q in postures(315) {
        let chain = equation_3_2(&q);
        let origin = |i: usize| chain[i].fixed_view::<3, 1>(0, 3).into_owned();
        let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
        for i in 1..=6 {
            let axis = chain[i - 1].fixed_view::<3, 3>(0, 0) * Vector3::z();
            jacobian.fixed_view_mut::<3, 1>(0, i - 1).copy_from(&axis.cross(&(origin(6) - origin(i - 1))));
            jacobian.fixed_view_mut::<3, 1>(3, i - 1).copy_from(&axis);
        }
        let generated = arm.flange_jacobian(&q);
        assert_close("(3.15), (3.16)", jacobian.transpose().as_slice(), &generated.concat(), 4e-15);
        let qd: [f64; 6] = random.array(-2.0..2.0);
        let twist = arm.flange_velocity(&q, &qd);
        assert_close("(3.13)", &times(&generated, &qd), &twist, 1e-14);
    }
}

/// (3.18), of the generated terms.
#[test]
fn equation_3_18_of_the_generated_terms() {
    let (arm, mut random) = (Irb7600::<f64>::default(), Random::new(318));
    for q in postures(319) {
        let [qd, qdd] = std::array::from_fn(|_| random.array(-2.0..2.0));
        let (inertia, coriolis) = (times(&arm.mass_matrix(&q), &qdd), times(&arm.coriolis_matrix(&q, &qd), &qd));
        let gravity = arm.gravity(&q);
        let left: [f64; 6] = std::array::from_fn(|i| inertia[i] + coriolis[i] + gravity[i]);
        assert_close("(3.18)", &left, &arm.inverse_dynamics(&q, &qd, &qdd), 1e-13);
        assert_close("τ there, q̈ back", &arm.forward_dynamics(&q, &qd, &left), &qdd, 1e-10);
    }
}
