//! What adaptive control rests on: regressors against formulas by hand, base parameters, and `Ṁ − 2C`.

use mbs_arm::inertial::{MASSES_ALONE, flat, links, model, parts};
use mbs_models::double_pendulum::{self, DoublePendulum};
use mbs_models::{irb7600, quadrotor_euler};
use mbs_runtime::control::{AdaptiveControl, BodyParameters, RegressorStack, Sliding, regressor};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;

/// Of a motion, not of a reference: what the inverse dynamics is linear in.
fn along<const N: usize>(qd: [f64; N], qdd: [f64; N]) -> Sliding<N> {
    Sliding { error: [0.0; N], qd, qdd }
}

/// Two masses on rods, columns m₁ and m₂ typed by hand; Slotine's and Li's form has the velocity of the reference once:
/// C in Christoffel's form is `c₁₂ = m₂ l₁ l₂ sin(θ₁ − θ₂) θ̇₂`, `c₂₁ = −m₂ l₁ l₂ sin(θ₁ − θ₂) θ̇₁`, the rest zero.
#[test]
fn the_regressor_of_a_double_pendulum_is_that_by_hand() {
    let (l1, l2, g) = (0.7, 1.3, 9.81);
    let mut random = Random::new(17);
    for _ in 0..200 {
        let [q, qd, qd_r, qdd_r]: [[f64; 2]; 4] = std::array::from_fn(|_| random.array(-3.0..3.0));
        let forces = |&[m1, m2]: &[f64; 2]| {
            let of = DoublePendulum::new(double_pendulum::Params { m1, m2, l1, l2, g });
            along(qd_r, qdd_r).forces_of(&of, 0.0, &q, &qd)
        };
        let found = regressor(forces, &[1.0, 1.0]);
        let (sin, cos) = (q[0] - q[1]).sin_cos();
        let upper = l1 * l1 * qdd_r[0] + g * l1 * q[0].sin();
        let want = [
            [upper, upper + l1 * l2 * (cos * qdd_r[1] + sin * qd[1] * qd_r[1])],
            [0.0, l2 * l2 * qdd_r[1] + l1 * l2 * (cos * qdd_r[0] - sin * qd[0] * qd_r[0]) + g * l2 * q[1].sin()],
        ];
        assert_close("Y", &found.concat(), &want.concat(), 1e-13);
    }
}

/// `Y(q, q̇, q̈) π` is the inverse dynamics of the thesis' arm, which is another mechanism, without products of
/// inertia.
#[test]
fn sixty_numbers_give_the_torques_of_the_arm() {
    let arm = irb7600::Irb7600::default();
    let numbers = flat(&links(&irb7600::Params::default()));
    let g = irb7600::Params::<f64>::default().g;
    let mut random = Random::new(18);
    for _ in 0..200 {
        let [q, qd, qdd]: [[f64; 6]; 3] = std::array::from_fn(|_| random.array(-3.0..3.0));
        let y = regressor(|n: &[f64; 60]| along(qd, qdd).forces_of(&model(&parts(n), g), 0.0, &q, &qd), &MASSES_ALONE);
        let found: [f64; 6] = std::array::from_fn(|i| (0..60).map(|k| y[i][k] * numbers[k]).sum());
        let generated = arm.inverse_dynamics(&q, &qd, &qdd);
        // Relative to the largest: sixty terms cancel where a torque is small.
        let size = generated.iter().fold(1.0, |most: f64, torque| most.max(torque.abs()));
        assert_close("Y π", &found.map(|x| x / size), &generated.map(|x| x / size), 1e-12);
    }
}

/// 36, what Mayeda, Yoshida and Osuka (*Base parameters of manipulator dynamic models*, IEEE Transactions on Robotics
/// and Automation 6:3, 1990) count for six revolute joints of which the first is vertical, the second and third
/// parallel and the others at right angles: 7 n − 4 − 2. Numbers that differ where no torque does have the same 36.
#[test]
fn an_arm_has_thirty_six_base_parameters() {
    let mut random = Random::new(19);
    let mut stack = RegressorStack::<60>::default();
    let y = |q: &[f64; 6], qd, qdd| {
        regressor(|n: &[f64; 60]| along(qd, qdd).forces_of(&model(&parts(n), 9.81), 0.0, q, &qd), &MASSES_ALONE)
    };
    for _ in 0..40 {
        let [q, qd, qdd]: [[f64; 6]; 3] = std::array::from_fn(|_| random.array(-3.0..3.0));
        stack.add(&y(&q, qd, qdd));
    }
    let base = stack.base(1e-9).expect("numbers");
    assert_eq!((base.rank(), base.dependent().len()), (36, 24));
    let [taken, left] = base.gap();
    assert!(taken > 0.01 && left < 1e-12, "{taken} {left}");

    let numbers: [f64; 60] = std::array::from_fn(|_| random.uniform(1.0..2.0));
    let mut short = [0.0; 60];
    base.independent().iter().zip(base.values(&numbers)).for_each(|(&k, value)| short[k] = value);
    let [q, qd, qdd]: [[f64; 6]; 3] = std::array::from_fn(|_| random.array(-3.0..3.0));
    let times = |n: &[f64; 60]| y(&q, qd, qdd).map(|row| row.iter().zip(n).map(|(a, b)| a * b).sum::<f64>());
    assert_close("torques", &times(&short), &times(&numbers), 1e-10);
}

/// Two links that are fixed to each other: the torques are those of the one with both numbers.
#[test]
fn a_payload_is_added_to_the_last_link() {
    let payload = BodyParameters::about_center(120.0, [0.1, -0.2, 0.3], [5.0, 6.0, 7.0, 0.3, -0.2, 0.1]);
    let params = irb7600::Params::<f64>::default();
    let mut loaded = links(&params);
    loaded[5] = loaded[5].plus(&payload);
    let mut alone = [BodyParameters::default(); 6];
    alone[5] = payload;
    let (q, qd, qdd) =
        ([0.3, -1.1, 0.4, 0.9, -0.6, 0.2], [0.5, -0.2, 0.7, 0.1, -0.9, 0.3], [1.0, 0.4, -0.3, 2.0, 0.5, -1.0]);
    let torques = |of: &[BodyParameters; 6]| model(of, params.g).inverse_dynamics(&q, &qd, &qdd);
    let (bare, added) = (torques(&links(&params)), torques(&alone));
    assert_close("torques", &torques(&loaded), &std::array::from_fn::<_, 6, _>(|i| bare[i] + added[i]), 1e-12);
}

/// V̇ = −sᵀ K_D s needs `xᵀ (Ṁ − 2C) x = 0`, for any x, not only for the velocity: Ṁ by central differences along q̇.
#[test]
fn the_rate_of_the_mass_matrix_less_twice_c_is_skew() {
    let calm = [[0.0; 3]; 3];
    let quadrotor = quadrotor_euler::QuadrotorEuler::default();
    let arm = model(&links(&irb7600::Params::default()), 9.81);
    let mut random = Random::new(20);
    for _ in 0..50 {
        let [q, qd]: [[f64; 6]; 2] = std::array::from_fn(|_| random.array(-1.2..1.2));
        let h = 1e-5;
        let ahead = |sign: f64| std::array::from_fn(|i| q[i] + sign * h * qd[i]);
        let check = |masses: &dyn Fn(&[f64; 6]) -> [[f64; 6]; 6], c: [[f64; 6]; 6]| {
            let (after, before, m) = (masses(&ahead(1.0)), masses(&ahead(-1.0)), masses(&q));
            let scale = m.concat().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
            for i in 0..6 {
                for j in 0..6 {
                    let rate = |i: usize, j: usize| (after[i][j] - before[i][j]) / (2.0 * h) - 2.0 * c[i][j];
                    assert!((rate(i, j) + rate(j, i)).abs() < 1e-8 * scale, "{i} {j}");
                }
            }
        };
        check(&|q| arm.mass_matrix(q), arm.coriolis_matrix(&q, &qd));
        check(&|q| quadrotor.mass_matrix(&calm, q), quadrotor.coriolis_matrix(&calm, &q, &qd));
    }
}

/// Another motion of the same arm: with the true numbers the forces are those of the inverse dynamics, nothing is
/// learnt, and V is zero.
#[test]
fn who_knows_the_truth_learns_nothing() {
    let control = AdaptiveControl::new([5.0; 6], [100.0; 6], [10.0; 60]).expect("gains");
    let numbers = flat(&links(&irb7600::Params::default()));
    let arm = model(&parts(&numbers), 9.81);
    let (q, qd, qdd) =
        ([0.3, -1.1, 0.4, 0.9, -0.6, 0.2], [0.5, -0.2, 0.7, 0.1, -0.9, 0.3], [1.0, 0.4, -0.3, 2.0, 0.5, -1.0]);
    let sliding = control.sliding(&[q, qd, qdd], &q, &qd);
    let y = regressor(|n: &[f64; 60]| sliding.forces_of(&model(&parts(n), 9.81), 0.0, &q, &qd), &MASSES_ALONE);
    assert_close("Q", &control.forces(&y, &numbers, &sliding.error), &arm.inverse_dynamics(&q, &qd, &qdd), 1e-11);
    assert_eq!(control.estimate_rate(&y, &sliding.error), [0.0; 60]);
    assert_eq!(control.lyapunov(&arm.mass_matrix(&q), &sliding.error, &[0.0; 60]), 0.0);
}
