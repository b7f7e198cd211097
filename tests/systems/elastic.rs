//! Arm and platform with elastic drives against the rigid ones, put together by hand as Spong has it.

use mbs_arm::elastic::ElasticArm;
use mbs_models::irb7600::{self, Irb7600};
use mbs_models::irb7600_elastic::{self, Irb7600Elastic};
use mbs_models::stewart_platform::{self, StewartPlatform};
use mbs_models::stewart_platform_elastic::{self, StewartPlatformElastic};
use mbs_platform::{HOME, Platform};
use mbs_runtime::control::{StateSpace, natural_frequency};
use mbs_runtime::{Integrator, Linearization, Rk4, State};
use nalgebra::{DMatrix, DVector};

const POSTURE: [f64; 6] = [0.3, -1.2, 0.4, 0.2, 0.7, -0.3];

/// States that repeat nowhere.
fn scattered<const N: usize>(seed: usize, size: f64) -> [f64; N] {
    std::array::from_fn(|i| size * ((3 * seed + 1) as f64 * 1.3 + 2.1 * i as f64).sin())
}

fn close<const N: usize>(found: [f64; N], want: [f64; N], within: f64) {
    let size = want.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    assert!((0..N).all(|i| (found[i] - want[i]).abs() <= within * size), "{found:?} {want:?}");
}

fn pair<const N: usize>(first: [f64; N], second: [f64; N]) -> [f64; 12] {
    std::array::from_fn(|i| if i < 6 { first[i] } else { second[i - 6] })
}

#[test]
fn the_arm_is_the_rigid_one_on_springs() {
    let (rigid, params) = (irb7600::Params::<f64>::default(), irb7600_elastic::Params::<f64>::default());
    let irb7600::Params { mass, com_x, com_y, com_z, i_xx, i_yy, i_zz, g } = rigid;
    let shared = irb7600_elastic::Params { mass, com_x, com_y, com_z, i_xx, i_yy, i_zz, g, ..params };
    assert_eq!(shared, params);
    let (rigid, elastic) = (Irb7600::<f64>::default(), Irb7600Elastic::new(params));
    let inertia = ElasticArm::default().rotor_inertia();
    for seed in 0..50 {
        let (q, qd) = (scattered::<6>(seed, 2.0), scattered::<6>(seed + 100, 1.0));
        let (bent, turning) = (scattered::<6>(seed + 200, 1e-2), scattered::<6>(seed + 300, 1.0));
        let theta: [f64; 6] = std::array::from_fn(|i| q[i] + bent[i]);
        let tau = scattered::<6>(seed + 400, 1e4);
        let spring: [f64; 6] =
            std::array::from_fn(|i| params.stiffness[i] * (theta[i] - q[i]) + params.damping[i] * (turning[i] - qd[i]));
        let motors = std::array::from_fn(|i| (tau[i] - spring[i]) / inertia[i]);
        let want = pair(rigid.forward_dynamics(&q, &qd, &spring), motors);
        close(elastic.forward_dynamics(&pair(q, theta), &pair(qd, turning), &tau), want, 1e-9);
    }
}

#[test]
fn the_platform_is_the_rigid_one_on_springs() {
    let (rigid, params) =
        (stewart_platform::Params::<f64>::default(), stewart_platform_elastic::Params::<f64>::default());
    // All parameters of the rigid one, in its order, and four more before gravity.
    let texts = [format!("{rigid:?}"), format!("{params:?}")].map(|text| text.split_once(' ').unwrap().1.to_string());
    let own = texts[1].find(", rotor").unwrap()..texts[1].find(", g:").unwrap();
    assert_eq!(texts[0], [&texts[1][..own.start], &texts[1][own.end..]].concat());
    let (rigid, elastic) = (StewartPlatform::<f64>::default(), StewartPlatformElastic::new(params));
    let platform = Platform::default();
    for seed in 0..30 {
        let q: [f64; 6] = std::array::from_fn(|i| HOME[i] + scattered::<6>(seed, 0.1)[i]);
        let qd = scattered::<6>(seed + 100, 0.5);
        let (lengths, rates) = (platform.lengths(&q).unwrap(), platform.leg_rates(&q, &qd).unwrap());
        let drive: [f64; 6] = std::array::from_fn(|i| lengths[i] + scattered::<6>(seed + 200, 1e-4)[i]);
        let driving = scattered::<6>(seed + 300, 0.5);
        let force = scattered::<6>(seed + 400, 1e3);
        let spring: [f64; 6] = std::array::from_fn(|i| {
            params.stiffness[i] * (drive[i] - lengths[i]) + params.damping[i] * (driving[i] - rates[i])
        });
        let inertia = |i: usize| params.rotor[i] / (params.lead * params.lead);
        let motors = std::array::from_fn(|i| (force[i] - spring[i]) / inertia(i));
        let want = pair(rigid.forward_dynamics(&q, &qd, &spring), motors);
        close(elastic.forward_dynamics(&pair(q, drive), &pair(qd, driving), &force), want, 1e-8);
    }
}

/// Frequencies of `det(K − ω² M) = 0`, the lowest first, by nalgebra.
fn frequencies(m: DMatrix<f64>, k: DMatrix<f64>) -> Vec<f64> {
    let l = m.cholesky().unwrap().l();
    let half = l.solve_lower_triangular(&k).unwrap();
    let whole = l.solve_lower_triangular(&half.transpose()).unwrap();
    let mut squares: Vec<f64> = whole.symmetric_eigenvalues().iter().copied().collect();
    squares.sort_unstable_by(f64::total_cmp);
    squares.into_iter().map(|square| square.max(0.0).sqrt()).collect()
}

/// Those of the undamped motion `δq̈ = A δq`, the lowest first.
fn of_linearization<const U: usize>(linear: &Linearization<f64, 12, U>) -> Vec<f64> {
    let mut a = [[0.0; 24]; 24];
    for i in 0..12 {
        a[i][12 + i] = 1.0;
        a[12 + i][..12].copy_from_slice(&linear.q[i]);
    }
    let plant = StateSpace::<24, 1, 1> { a, b: [[0.0]; 24], c: [[0.0; 24]], d: [[0.0]] };
    // Unstable motions, of an arm whose motors are free to fall, are no frequencies.
    let mut found: Vec<f64> =
        plant.poles().unwrap().into_iter().filter(|pole| pole.im > 1.0).map(natural_frequency).collect();
    found.sort_unstable_by(f64::total_cmp);
    found
}

fn derivative<const N: usize>(f: impl Fn(&[f64; N]) -> [f64; N], at: &[f64; N]) -> DMatrix<f64> {
    DMatrix::from_fn(N, N, |i, j| {
        let ends = [1e-5, -1e-5].map(|step| {
            let mut moved = *at;
            moved[j] += step;
            f(&moved)[i]
        });
        (ends[0] - ends[1]) / 2e-5
    })
}

#[test]
fn the_arm_swings_with_the_frequencies_of_its_springs() {
    let (rigid, arm) = (Irb7600::<f64>::default(), ElasticArm::default());
    let params = *arm.model.params();
    let (masses, weight) = (rigid.mass_matrix(&POSTURE), derivative(|q| rigid.gravity(q), &POSTURE));
    // Motors held: the lowest is that of the shoulder, a few hertz.
    let held = arm.natural_frequencies(&POSTURE);
    let spring = DMatrix::from_diagonal(&DVector::from_row_slice(&params.stiffness));
    let want = frequencies(DMatrix::from_fn(6, 6, |i, j| masses[i][j]), spring.clone());
    for (found, want) in held.into_iter().zip(&want) {
        assert!((found / want - 1.0).abs() < 1e-9, "{held:?} {want:?}");
    }
    assert!((2.0..12.0).contains(&(held[0] / std::f64::consts::TAU)), "{held:?}");

    // Motors free: M and K of all twelve, by hand, against the poles of the generated linearization in equilibrium.
    let gravity = rigid.gravity(&POSTURE);
    let theta = std::array::from_fn(|i| POSTURE[i] + gravity[i] / params.stiffness[i]);
    let undamped = ElasticArm::new(irb7600_elastic::Params { damping: [0.0; 6], ..params });
    let inertia = undamped.rotor_inertia();
    let found = of_linearization(&undamped.model.linearize(&pair(POSTURE, theta), &[0.0; 12], &gravity));
    let m = DMatrix::from_fn(12, 12, |i, j| match (i < 6, j < 6) {
        (true, true) => masses[i][j],
        (false, false) if i == j => inertia[i - 6],
        _ => 0.0,
    });
    let k = DMatrix::from_fn(12, 12, |i, j| {
        let sign = if (i < 6) == (j < 6) { 1.0 } else { -1.0 };
        let own = if i < 6 && j < 6 { 0.5 * (weight[(i, j)] + weight[(j, i)]) } else { 0.0 };
        own + if i % 6 == j % 6 { sign * params.stiffness[i % 6] } else { 0.0 }
    });
    let want = frequencies(m, k);
    let highest = &want[want.len() - 6..];
    let found = &found[found.len() - 6..];
    assert!(found.iter().zip(highest).all(|(found, want)| (found / want - 1.0).abs() < 1e-6), "{found:?} {highest:?}");
}

#[test]
fn the_platform_swings_with_the_frequencies_of_its_legs() {
    let params = stewart_platform_elastic::Params::<f64>::default();
    let (rigid, platform) = (StewartPlatform::<f64>::default(), Platform::default());
    let masses = rigid.mass_matrix(&HOME);
    let stiffness = platform.stiffness(&HOME, &params.stiffness).unwrap();
    let want = frequencies(DMatrix::from_fn(6, 6, |i, j| masses[i][j]), DMatrix::from_fn(6, 6, |i, j| stiffness[i][j]));
    // Drives as heavy as if they were held; without weight, so that home is an equilibrium of unloaded legs.
    let heavy = stewart_platform_elastic::Params { rotor: [1e6; 6], damping: [0.0; 6], g: 0.0, ..params };
    let lengths = platform.lengths(&HOME).unwrap();
    let linear = StewartPlatformElastic::new(heavy).linearize(&pair(HOME, lengths), &[0.0; 12], &[0.0; 6]);
    let found = of_linearization(&linear);
    assert_eq!(found.len(), 6, "{found:?}");
    assert!(found.iter().zip(&want).all(|(found, want)| (found / want - 1.0).abs() < 1e-5), "{found:?} {want:?}");
    assert!(want[0] / std::f64::consts::TAU > 5.0, "{want:?}");
}

/// The equilibrium under a load at the flange, found by Newton's method on the generated gravity, against `J K⁻¹ Jᵀ F`.
#[test]
fn the_flange_gives_way_as_the_compliance_says() {
    let arm = ElasticArm::default();
    let rigid = mbs_arm::Arm::default();
    let stiffness = arm.model.params().stiffness;
    let place = |q: &[f64; 6]| rigid.pose(q).position;
    // Motors stand where they hold the posture without the load.
    let theta: [f64; 6] = std::array::from_fn(|i| POSTURE[i] + rigid.model.gravity(&POSTURE)[i] / stiffness[i]);
    let mut errors = [0.0; 2];
    for (error, mass) in errors.iter_mut().zip([50.0, 500.0]) {
        let wrench = [0.0, 0.0, -9.80665 * mass, 0.0, 0.0, 0.0];
        // What is left of `K (θ − q) + Jᵀ F − G`.
        let excess = |q: &[f64; 6]| -> [f64; 6] {
            let (gravity, load) = (rigid.model.gravity(q), rigid.joint_torque(q, &wrench));
            std::array::from_fn(|i| stiffness[i] * (theta[i] - q[i]) + load[i] - gravity[i])
        };
        let mut q = POSTURE;
        for _ in 0..20 {
            let step = derivative(excess, &q).lu().solve(&DVector::from_row_slice(&excess(&q))).unwrap();
            q = std::array::from_fn(|i| q[i] - step[i]);
        }
        close(excess(&q), [0.0; 6], 1e-6);
        let compliance = arm.compliance(&POSTURE);
        let (before, after) = (place(&POSTURE), place(&q));
        let sinks = before[2] - after[2];
        assert!((1e-6..2e-5).contains(&(sinks / mass)), "{sinks} m under {mass} kg");
        // With the change of the arm's weight with its posture, which the formula leaves out: a few percent.
        let spring = DMatrix::from_diagonal(&DVector::from_row_slice(&stiffness));
        let whole = (spring + derivative(|q| rigid.model.gravity(q), &POSTURE)).lu();
        let turned = whole.solve(&DVector::from_row_slice(&rigid.joint_torque(&POSTURE, &wrench))).unwrap();
        let jacobian = rigid.jacobian(&POSTURE);
        for i in 0..3 {
            let plain: f64 = (0..6).map(|j| compliance[i][j] * wrench[j]).sum();
            assert!((after[i] - before[i] - plain).abs() < 0.03 * sinks, "{plain} {sinks}");
            let full: f64 = (0..6).map(|j| jacobian[i][j] * turned[j]).sum();
            *error = f64::max(*error, (after[i] - before[i] - full).abs());
        }
    }
    // What both leave out is as the square of the load.
    assert!((errors[1] / errors[0] / 100.0 - 1.0).abs() < 0.1, "{errors:?}");
}

/// Under smooth torques the joints move as those of the rigid arm with its rotors' inertia; what differs is as 1/k.
#[test]
fn stiff_joints_are_rigid_ones() {
    let rigid = Irb7600::<f64>::default();
    let inertia = ElasticArm::default().rotor_inertia();
    let torque = |t: f64| {
        let gravity = rigid.gravity(&POSTURE);
        let pulse = t * t * (1.0 - t) * (1.0 - t);
        std::array::from_fn(|i| gravity[i] * (1.0 + 3.0 * pulse))
    };
    let step = 1e-4;
    // (M + n² J) q̈ + h = τ.
    let mut reference = State::new(POSTURE, [0.0; 6]);
    let heavy = |t: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
        let (masses, bias, tau): (_, _, [f64; 6]) = (rigid.mass_matrix(q), rigid.bias(q, qd), torque(t));
        let m = DMatrix::from_fn(6, 6, |i, j| masses[i][j] + if i == j { inertia[i] } else { 0.0 });
        let right = DVector::from_fn(6, |i, _| tau[i] - bias[i]);
        *qdd = m.cholesky().unwrap().solve(&right).as_slice().try_into().unwrap();
    };
    integrate(heavy, &mut reference, step);
    let errors = [1.0, 4.0, 16.0].map(|stiffer| {
        let params = irb7600_elastic::Params::<f64>::default();
        let stiffness = params.stiffness.map(|k| stiffer * k);
        // Damping grows with the root, so that vibrations die as quickly.
        let damping = params.damping.map(|d| 4.0 * d * stiffer.sqrt());
        let arm = Irb7600Elastic::new(irb7600_elastic::Params { stiffness, damping, ..params });
        let gravity = rigid.gravity(&POSTURE);
        let theta = std::array::from_fn(|i| POSTURE[i] + gravity[i] / stiffness[i]);
        let mut state = State::new(pair(POSTURE, theta), [0.0; 12]);
        let free = |t: f64, q: &[f64; 12], qd: &[f64; 12], qdd: &mut [f64; 12]| {
            *qdd = arm.forward_dynamics(q, qd, &torque(t));
        };
        integrate(free, &mut state, step);
        (0..6).map(|i| (state.q[i] - reference.q[i]).abs()).fold(0.0, f64::max)
    });
    let moved = (0..6).map(|i| (reference.q[i] - POSTURE[i]).abs()).fold(0.0, f64::max);
    assert!(moved > 1e-2 && errors[0] < 0.1 * moved, "{moved} {errors:?}");
    for pair in errors.windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// One second of steps of Runge and Kutta's.
fn integrate<const N: usize>(
    motion: impl FnMut(f64, &[f64; N], &[f64; N], &mut [f64; N]),
    state: &mut State<[f64; N]>,
    step: f64,
) {
    Rk4::new(step).integrate(motion, 0.0, 1.0, state, |_| std::ops::ControlFlow::Continue(())).unwrap();
}
