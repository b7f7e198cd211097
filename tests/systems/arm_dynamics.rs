//! Jacobians, velocities, forces and dynamics of the IRB 7600: reference values, duality, the thesis' (3.19), and
//! control by the model in closed loop.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use mbs_arm::inverse::PHI;
use mbs_arm::jacobian::{condition, determinant, manipulability, singular_values};
use mbs_arm::{A2, A3, Arm, D4, JointVector};
use mbs_models::irb7600::{Irb7600, Params};
use mbs_models::{Error, Failure};
use mbs_runtime::control::{ComputedTorque, InvalidGain};
use mbs_runtime::{Dop853, Dual, Integrator, Pose, Scalar, State, accelerations, to_matrix};
use mbs_tests::compare::{assert_close, error};
use mbs_tests::random::Random;
use mbs_tests::reference::arms::thesis_values;
use serde_json::Value;

fn configurations(seed: u64, count: usize) -> impl Iterator<Item = JointVector> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| std::array::from_fn(|_| random.uniform(-PI..PI)))
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    (0..6).map(|i| a[i] * b[i]).sum()
}

/// The Jacobian's determinant and singular values that a separate program gives for table 1.
fn serial() -> Value {
    serde_json::from_str(include_str!("../data/serial.json")).expect("the data file is JSON")
}

#[test]
fn the_jacobian_has_the_reference_values() {
    let arm = Arm::default();
    let thesis = thesis_values();
    let jacobian = arm.jacobian(&thesis.q);
    assert_close("jacobian", &jacobian.concat(), &thesis.jacobian.concat(), 1e-12);
    let serial = serial();
    let reference = &serial["jacobian_table1"];
    let want = reference["det"].as_f64().expect("a number");
    assert_close("det J", &[determinant(&thesis.q)], &[want], 1e-12);
    let values: [f64; 6] = std::array::from_fn(|i| reference["singular_values"][i].as_f64().expect("a number"));
    assert_close("singular values", &singular_values(&jacobian), &values, 1e-12);
    assert_close("condition", &[condition(&jacobian)], &[values[0] / values[5]], 1e-12);
    assert_close("manipulability", &[manipulability(&thesis.q)], &[values.iter().product()], 1e-12);
}

#[test]
fn pose_and_jacobian_typed_by_hand_are_those_generated() {
    let arm = Arm::default();
    for q in configurations(1, 2000) {
        let (pose, jacobian) = arm.pose_and_jacobian(&q);
        let generated = arm.pose(&q);
        assert_close("position", &pose.position, &generated.position, 4e-15);
        assert_close("rotation", &pose.rotation.concat(), &generated.rotation.concat(), 4e-15);
        assert_close("jacobian", &jacobian.concat(), &arm.jacobian(&q).concat(), 4e-15);
        assert_close("det J", &[determinant(&q)], &[to_matrix(&jacobian).determinant()], 1e-14);
    }
}

#[test]
fn velocities_and_forces_are_dual() {
    let arm = Arm::default();
    let mut random = Random::new(2);
    let mut inverted = 0;
    for q in configurations(3, 500) {
        let [qd, torque]: [JointVector; 2] = std::array::from_fn(|_| random.array(-2.0..2.0));
        let wrench: [f64; 6] = random.array(-500.0..500.0);
        // A velocity is what the generated function gives, and the power is the same on both sides.
        let twist = arm.flange_velocity(&q, &qd);
        let jacobian = arm.jacobian(&q);
        assert_close("J q̇", &twist, &jacobian.map(|row| dot(&row, &qd)), 1e-14);
        let power = dot(&arm.joint_torque(&q, &wrench), &qd);
        assert_close("power", &[power], &[dot(&wrench, &twist)], 1e-12);
        // And back, as well as the Jacobian's condition allows.
        let condition = condition(&jacobian);
        if condition < 1e4 {
            inverted += 1;
            let found = arm.joint_velocity(&q, &twist).expect("regular");
            assert_close("J⁻¹ J q̇", &found, &qd, 1e-14 * condition);
            let found = arm.flange_wrench(&q, &torque).expect("regular");
            assert_close("Jᵀ J⁻ᵀ τ", &arm.joint_torque(&q, &found), &torque, 1e-14 * condition);
        }
    }
    assert!(inverted > 450, "{inverted}");
}

/// One configuration for each way of being singular.
fn singular_configurations() -> [JointVector; 3] {
    let theta_2 = -2.0_f64;
    let above = ((-0.41 - A2 * theta_2.cos()) / A3.hypot(D4)).acos() - PHI - theta_2;
    [[0.3, -1.2, 0.4, 0.9, 0.0, -0.5], [0.3, -1.2, -PHI, 0.9, 0.7, -0.5], [0.3, theta_2, above, 0.9, 0.7, -0.5]]
}

#[test]
fn singular_velocities_are_refused_or_damped() {
    let arm = Arm::default();
    let twist = [0.1, -0.2, 0.3, 0.4, 0.1, -0.3];
    for q in singular_configurations() {
        assert!(determinant(&q).abs() < 1e-15, "{q:?}");
        let found = arm.joint_velocity(&q, &twist);
        assert!(
            matches!(found, Err(Error { failure: Failure::Singular { smallest, largest, .. }, .. }) if smallest < 1e-12 && largest > 1.0),
            "{found:?}"
        );
        assert!(matches!(arm.flange_wrench(&q, &twist), Err(Error { failure: Failure::Singular { .. }, .. })));
        assert!(condition(&arm.jacobian(&q)) > 1e12);
        for damping in [1e-1, 1e-2, 1e-3] {
            let qd = arm.joint_velocity_damped(&q, &twist, damping).expect("damped");
            assert!(dot(&qd, &qd).sqrt() <= dot(&twist, &twist).sqrt() / (2.0 * damping));
            // Stationary: Jᵀ (J q̇ − [v; ω]) + λ² q̇ = 0.
            let left = arm.flange_velocity(&q, &qd);
            let residual = std::array::from_fn(|i| left[i] - twist[i]);
            let gradient = arm.joint_torque(&q, &residual);
            let gradient: [f64; 6] = std::array::from_fn(|i| gradient[i] + damping * damping * qd[i]);
            assert_close("gradient", &gradient, &[0.0; 6], 1e-11);
        }
    }
    // Away from singularities a small damping changes little.
    let q = [0.4, -1.2, 0.3, 0.5, 0.8, -0.1];
    let exact = arm.joint_velocity(&q, &twist).expect("regular");
    assert!(error(&arm.joint_velocity_damped(&q, &twist, 1e-4).expect("damped"), &exact) < 1e-6);
    for damping in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = arm.joint_velocity_damped(&q, &twist, damping);
        assert!(found.is_err_and(|error| error.invalid().is_some()), "{damping}: {found:?}");
    }
    let nan = [0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0];
    let is_refused = |found: Result<[f64; 6], Error>| matches!(found.unwrap_err().failure, Failure::NotFinite(_));
    assert!(is_refused(arm.joint_velocity(&nan, &twist)));
    assert!(is_refused(arm.joint_velocity(&q, &nan)));
    assert!(is_refused(arm.flange_wrench(&q, &nan)));
    assert!(is_refused(arm.joint_velocity_damped(&nan, &twist, 0.1)));
    assert!(singular_values(&arm.jacobian(&nan)).iter().all(|value| value.is_nan()));
}

/// The outputs at the mass centres, over any numbers: poses and Jacobians.
pub(crate) fn mass_centers<T: Scalar>(arm: &Irb7600<T>, q: &[T; 6]) -> [(Pose<T>, [[T; 6]; 6]); 6] {
    [
        (arm.center_0(q), arm.center_0_jacobian(q)),
        (arm.center_1(q), arm.center_1_jacobian(q)),
        (arm.center_2(q), arm.center_2_jacobian(q)),
        (arm.center_3(q), arm.center_3_jacobian(q)),
        (arm.center_4(q), arm.center_4_jacobian(q)),
        (arm.center_5(q), arm.center_5_jacobian(q)),
    ]
}

/// `M = Σ (mᵢ J_vᵀ J_v + J_ωᵀ Rᵢ Iᵢ Rᵢᵀ J_ω)`, over any numbers.
pub(crate) fn mass_matrix_of_3_19<T: Scalar>(arm: &Irb7600<T>, params: &Params<T>, q: &[T; 6]) -> [[T; 6]; 6] {
    let mut m = [[T::zero(); 6]; 6];
    for (i, (pose, jacobian)) in mass_centers(arm, q).iter().enumerate() {
        let principal = [params.i_xx[i], params.i_yy[i], params.i_zz[i]];
        // Angular velocities in the axes of the link.
        let body: [[T; 6]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|c| (0..3).fold(T::zero(), |sum, r| sum + pose.rotation[r][k] * jacobian[3 + r][c]))
        });
        for (a, b) in (0..6).flat_map(|a| (0..6).map(move |b| (a, b))) {
            for r in 0..3 {
                m[a][b] = m[a][b] + params.mass[i] * jacobian[r][a] * jacobian[r][b];
                m[a][b] = m[a][b] + principal[r] * body[r][a] * body[r][b];
            }
        }
    }
    m
}

/// The parameters as numbers without derivative.
fn constant(params: &Params<f64>) -> Params<Dual<f64>> {
    let six = |values: [f64; 6]| values.map(Dual::constant);
    Params {
        mass: six(params.mass),
        com_x: six(params.com_x),
        com_y: six(params.com_y),
        com_z: six(params.com_z),
        i_xx: six(params.i_xx),
        i_yy: six(params.i_yy),
        i_zz: six(params.i_zz),
        g: Dual::constant(params.g),
    }
}

/// Thesis (3.19), corrected: `τ = M q̈ + c + G` with `M` summed over the links, `c = Ṁ q̇ − ½ [q̇ᵀ ∂M/∂q_k q̇]` and
/// `G = −Σ J_vᵀ mᵢ g`. The printed form lacks the sum over the inertias and multiplies `c` by `q̇` once more.
#[test]
fn the_dynamics_are_those_of_3_19() {
    let arm = Arm::default();
    let params = *arm.model.params();
    let dual_params = constant(&params);
    let dual_model = Irb7600::new(dual_params);
    let mut random = Random::new(9);
    for q in configurations(4, 50) {
        let [qd, qdd]: [JointVector; 2] = std::array::from_fn(|_| random.array(-2.0..2.0));
        let m = mass_matrix_of_3_19(&arm.model, &params, &q);
        assert_close("M", &m.concat(), &arm.model.mass_matrix(&q).concat(), 1e-13);
        // ∂M/∂q_k, exactly.
        let derivative = |k: usize| {
            let q = std::array::from_fn(|i| if i == k { Dual::variable(q[i]) } else { Dual::constant(q[i]) });
            mass_matrix_of_3_19(&dual_model, &dual_params, &q).map(|row| row.map(|entry| entry.derivative))
        };
        let derivatives: [[[f64; 6]; 6]; 6] = std::array::from_fn(derivative);
        let c: [f64; 6] = std::array::from_fn(|i| {
            let rate = (0..6).map(|k| dot(&derivatives[k][i], &qd) * qd[k]).sum::<f64>();
            rate - 0.5 * dot(&derivatives[i].map(|row| dot(&row, &qd)), &qd)
        });
        let coriolis = arm.model.coriolis_matrix(&q, &qd).map(|row| dot(&row, &qd));
        assert_close("c", &c, &coriolis, 1e-12);
        let mut gravity = [0.0; 6];
        for (i, jacobian) in arm.mass_center_jacobians(&q).iter().enumerate() {
            for k in 0..6 {
                gravity[k] += params.mass[i] * params.g * jacobian[2][k];
            }
        }
        assert_close("G", &gravity, &arm.gravity_compensation(&q), 1e-13);
        let torque: [f64; 6] = std::array::from_fn(|i| dot(&m[i], &qdd) + c[i] + gravity[i]);
        assert_close("τ", &arm.model.inverse_dynamics(&q, &qd, &qdd), &torque, 1e-12);
        // And back.
        assert_close("q̈", &arm.model.forward_dynamics(&q, &qd, &torque), &qdd, 1e-9);
    }
}

#[test]
fn the_dynamics_have_the_reference_values() {
    let (arm, thesis) = (Arm::default(), thesis_values());
    let torque = arm.model.inverse_dynamics(&thesis.q, &thesis.qd, &thesis.qdd);
    assert_close("τ", &torque, &thesis.torques, 1e-12);
    assert_close("G", &arm.gravity_compensation(&thesis.q), &thesis.gravity, 1e-12);
}

/// The derivatives of the poses of the mass centres are what their Jacobians say.
#[test]
fn mass_centers_move_as_their_jacobians_say() {
    let arm = Arm::default();
    let dual_model = Irb7600::new(constant(arm.model.params()));
    let mut random = Random::new(12);
    for q in configurations(6, 50) {
        let qd: JointVector = random.array(-2.0..2.0);
        let moving: [Dual<f64>; 6] = std::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] });
        let poses = mass_centers(&dual_model, &moving).map(|(pose, _)| pose);
        let (at, jacobians) = (arm.mass_center_poses(&q), arm.mass_center_jacobians(&q));
        for i in 0..6 {
            let twist = jacobians[i].map(|row| dot(&row, &qd));
            assert_close("velocity", &poses[i].position.map(|x| x.derivative), &twist[..3], 1e-13);
            // Ṙ = ω × R.
            let rate = poses[i].rotation.map(|row| row.map(|x| x.derivative));
            let [x, y, z] = [twist[3], twist[4], twist[5]];
            let skew = to_matrix(&[[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]);
            let want = skew * to_matrix(&at[i].rotation);
            assert_close("rotation", to_matrix(&rate).as_slice(), want.as_slice(), 1e-13);
        }
    }
}

/// A motion to follow: sines of different frequency.
fn wanted(t: f64) -> [JointVector; 3] {
    let middle = [0.3, -1.4, 0.2, 0.5, 0.6, -0.2];
    let amplitude = [0.5, 0.2, 0.3, 0.6, 0.4, 0.8];
    let rate = [0.9, 1.3, 0.7, 1.1, 1.7, 0.5];
    let each = |f: &dyn Fn(usize) -> f64| std::array::from_fn(f);
    [
        each(&|i| middle[i] + amplitude[i] * (rate[i] * t).sin()),
        each(&|i| amplitude[i] * rate[i] * (rate[i] * t).cos()),
        each(&|i| -amplitude[i] * rate[i] * rate[i] * (rate[i] * t).sin()),
    ]
}

#[test]
fn under_computed_torque_the_error_decays_as_designed() {
    let arm = Arm::default();
    let omega = 4.0_f64;
    let control = ComputedTorque::critically_damped(omega).expect("positive");
    let (e, ed) = ([0.2, -0.1, 0.15, 0.3, -0.2, 0.1], [0.5, 0.0, -0.4, 1.0, 0.3, -0.6]);
    let [start_q, start_qd, _] = wanted(0.0);
    let mut state =
        State::new(std::array::from_fn(|i| start_q[i] - e[i]), std::array::from_fn(|i| start_qd[i] - ed[i]));
    let motion = accelerations(&arm.model, |t, q, qd| arm.computed_torque(&control, &wanted(t), q, qd));
    let times: Vec<f64> = (1..=20).map(|k| 0.1 * f64::from(k)).collect();
    let mut compared = 0;
    Dop853::new(1e-11, 1e-12)
        .sample(motion, 0.0, &times, &mut state, |t, state| {
            let decay = (-omega * t).exp();
            let found: [f64; 6] = std::array::from_fn(|i| wanted(t)[0][i] - state.q[i]);
            let want: [f64; 6] = std::array::from_fn(|i| (e[i] + (ed[i] + omega * e[i]) * t) * decay);
            assert_close("error", &found, &want, 1e-9);
            compared += 1;
        })
        .expect("integrated");
    assert_eq!(compared, 20);
}

/// With gains of its own for each joint, and a model that knows nothing of a heavier hand: an error is left, and stays
/// small.
#[test]
fn a_wrong_model_leaves_a_bounded_error() {
    let model = Arm::default();
    let mut params = *model.model.params();
    params.mass[5] += 100.0;
    let plant = Irb7600::new(params);
    let control = ComputedTorque::new([100.0, 120.0, 100.0, 150.0, 150.0, 200.0], [20.0, 22.0, 20.0, 25.0, 25.0, 28.0])
        .expect("positive");
    let [place, ..] = wanted(0.0);
    let mut state = State::new(place, [0.0; 6]);
    let motion = accelerations(&plant, |_, q, qd| model.computed_torque(&control, &[place, [0.0; 6], [0.0; 6]], q, qd));
    Dop853::new(1e-9, 1e-10)
        .integrate(motion, 0.0, 5.0, &mut state, |_| ControlFlow::Continue(()))
        .expect("integrated");
    // At rest the springs carry what the model does not: M_model K_p e = G_plant − G_model.
    let e: JointVector = std::array::from_fn(|i| place[i] - state.q[i]);
    let spring: JointVector = std::array::from_fn(|i| control.stiffness()[i] * e[i]);
    let carried = model.model.mass_matrix(&state.q).map(|row| dot(&row, &spring));
    let missing = plant.gravity(&state.q);
    let known = model.gravity_compensation(&state.q);
    let missing: JointVector = std::array::from_fn(|i| missing[i] - known[i]);
    assert_close("torque", &carried, &missing, 1e-5);
    assert!(missing[1].abs() > 100.0 && e[1].abs() > 1e-3 && e.iter().all(|e| e.abs() < 0.1), "{e:?}");
}

#[test]
fn gravity_compensation_holds_the_arm() {
    let arm = Arm::default();
    for q in configurations(8, 5) {
        let mut state = State::new(q, [0.0; 6]);
        let motion = accelerations(&arm.model, |_, q, _| arm.gravity_compensation(q));
        Dop853::new(1e-10, 1e-12)
            .integrate(motion, 0.0, 2.0, &mut state, |_| ControlFlow::Continue(()))
            .expect("integrated");
        assert_close("q", &state.q, &q, 1e-10);
        // Without it the arm falls.
        let mut falling = State::new(q, [0.0; 6]);
        let motion = accelerations(&arm.model, |_, _, _| [0.0; 6]);
        Dop853::new(1e-6, 1e-6)
            .integrate(motion, 0.0, 0.1, &mut falling, |_| ControlFlow::Continue(()))
            .expect("integrated");
        assert!(error(&falling.q, &q) > 1e-3);
    }
}

#[test]
fn gains_must_be_positive() {
    for frequency in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = ComputedTorque::<6>::critically_damped(frequency);
        assert!(matches!(found, Err(InvalidGain { coordinate: 0, .. })), "{found:?}");
    }
    let mut damping = [2.0; 6];
    damping[3] = -2.0;
    let found = ComputedTorque::new([1.0; 6], damping);
    assert!(matches!(found, Err(InvalidGain { coordinate: 3, gain: -2.0, .. })), "{found:?}");
}
