//! (5.1)–(5.12): the quadrotor, typed from the print or as corrected, against the generated `quadrotor_euler`.

use mbs_landing::quadrotor::small_angle;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::{Dual, Scalar};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::lagrange::{Energies, Number, euler_lagrange};
use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::quadrotor::CALM;

const G: f64 = 9.80665;

/// Three different moments of inertia, and rotors that count.
fn params() -> Params<f64> {
    Params { inertias: [3.2, 4.1, 5.6], rotor_inertia: 0.03, ..Params::default() }
}

/// A state with |θ| below 70°, and speeds of rotors.
fn state(random: &mut Random) -> ([f64; 6], [f64; 6], [f64; 4]) {
    let mut q: [f64; 6] = random.array(-2.0..2.0);
    q[4] *= 0.6;
    (q, random.array(-2.0..2.0), random.array(100.0..500.0))
}

/// E_c of (5.2) with the energy of the translation, E_p of (5.3) corrected.
struct Vehicle(Params<f64>);

impl Energies<6> for Vehicle {
    fn kinetic<S: Number>(&self, &[_, _, _, phi, theta, _]: &[S; 6], &[xd, yd, zd, pd, td, sd]: &[S; 6]) -> S {
        let [ix, iy, iz] = self.0.inertias;
        let (sr, cr, sp, cp) = (phi.sin(), phi.cos(), theta.sin(), theta.cos());
        let [a, b, c] = [pd - sd * sp, td * cr + sd * sr * cp, td * sr - sd * cr * cp];
        (xd * xd + yd * yd + zd * zd) * (0.5 * self.0.m) + a * a * (0.5 * ix) + b * b * (0.5 * iy) + c * c * (0.5 * iz)
    }

    fn potential<S: Number>(&self, &[_, _, z, ..]: &[S; 6]) -> S {
        z * (self.0.m * G)
    }
}

/// T of ω = T (φ̇, θ̇, ψ̇), body axes.
fn rates<T: Scalar>(phi: T, theta: T) -> [[T; 3]; 3] {
    let ((sr, cr), (sp, cp), [zero, one]) = (phi.sin_cos(), theta.sin_cos(), [T::zero(), T::one()]);
    [[one, zero, -sp], [zero, cr, sr * cp], [zero, -sr, cr * cp]]
}

/// (5.4), as printed, with ω in body axes.
fn equation_5_4(p: &Params<f64>, [w_x, w_y]: [f64; 2], [o1, o2, o3, o4]: [f64; 4]) -> Vector3<f64> {
    let (b, l, d, j) = (p.thrust_factor, p.arm, p.drag_factor, p.rotor_inertia);
    Vector3::new(
        b * l * (o4 * o4 - o2 * o2) + j * w_y * (o1 + o3 - o2 - o4),
        b * l * (o3 * o3 - o1 * o1) + j * w_x * (-o1 - o3 + o2 + o4),
        d * (o1 * o1 - o2 * o2 + o3 * o3 - o4 * o4),
    )
}

/// (5.7), z corrected, with U₁ = Σ b Ω².
fn equation_5_7(p: &Params<f64>, [phi, theta, psi]: [f64; 3], speeds: &[f64; 4]) -> [f64; 3] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [phi, theta, psi].map(f64::sin_cos);
    let u_1 = p.thrust_factor * speeds.iter().map(|o| o * o).sum::<f64>();
    [(sr * sy + cr * sp * cy) * u_1, (-cy * sr + sy * sp * cr) * u_1, cp * cr * u_1]
}

/// Drag of (5.8), corrected.
fn drag(p: &Params<f64>, v: f64) -> f64 {
    -0.5 * p.drag_coefficient * p.air_density * p.area * v.abs() * v
}

/// (5.1) by nested dual numbers over (5.2) and (5.3), along the generated motion: its right sides are Tᵀ times (5.4).
/// The rows of x, y, z are (5.5): m times the acceleration is (5.7), the drag and the weight, which (5.3) has.
#[test]
fn equations_5_1_to_5_5_hold_along_the_generated_motion() {
    let (vehicle, mut random) = (QuadrotorEuler::new(params()), Random::new(51));
    for _ in 0..100 {
        let (q, qd, speeds) = state(&mut random);
        let qdd = vehicle.forward_dynamics(&CALM, &q, &qd, &speeds);
        let left = euler_lagrange(&Vehicle(params()), &q, &qd, &qdd);
        let t = Matrix3::from_fn(|i, j| rates(q[3], q[4])[i][j]);
        let w = t * Vector3::new(qd[3], qd[4], qd[5]);
        let torques = t.transpose() * equation_5_4(&params(), [w.x, w.y], speeds);
        assert_close("(5.1)", &left[3..], torques.as_slice(), 1e-12);
        let thrust = equation_5_7(&params(), [q[3], q[4], q[5]], &speeds);
        let force: [f64; 3] = std::array::from_fn(|i| thrust[i] + drag(&params(), qd[i]));
        assert_close("(5.5), (5.7)", &left[..3], &force, 1e-13);
    }
}

/// (5.6) in inertial axes: the rate of H = R I ω, an exact derivative along the generated motion, is R times (5.4).
#[test]
fn equation_5_6_holds_along_the_generated_motion() {
    let (vehicle, mut random) = (QuadrotorEuler::new(params()), Random::new(56));
    for _ in 0..100 {
        let (q, qd, speeds) = state(&mut random);
        let qdd = vehicle.forward_dynamics(&CALM, &q, &qd, &speeds);
        let path = |i: usize| Dual { value: q[i], derivative: qd[i] };
        let t = rates(path(3), path(4));
        let angle_rates: [Dual<f64>; 3] = std::array::from_fn(|i| Dual { value: qd[3 + i], derivative: qdd[3 + i] });
        let w = t.map(|row| row[0] * angle_rates[0] + row[1] * angle_rates[1] + row[2] * angle_rates[2]);
        let [(sr, cr), (sp, cp), (sy, cy)] = [path(3), path(4), path(5)].map(Scalar::sin_cos);
        let r = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        let momentum: [Dual<f64>; 3] = std::array::from_fn(|i| Dual::constant(params().inertias[i]) * w[i]);
        let rate = r.map(|row| (row[0] * momentum[0] + row[1] * momentum[1] + row[2] * momentum[2]).derivative);
        let torque = equation_5_4(&params(), [w[0].value, w[1].value], speeds);
        let turned = Matrix3::from_fn(|i, j| r[i][j].value) * torque;
        assert_close("(5.6)", &rate, turned.as_slice(), 1e-11);
    }
}

/// ẋ₂, ẋ₄, … ẋ₁₂ of (5.12), corrected, in the order of q̈; U₁ to U₄ from the speeds, torques.
fn equation_5_12(p: &Params<f64>, q: &[f64; 6], qd: &[f64; 6], speeds: &[f64; 4]) -> [f64; 6] {
    let [o1, o2, o3, o4] = *speeds;
    let [ix, iy, iz] = p.inertias;
    let [_, _, _, x1, x3, x5] = *q;
    let [_, _, _, x2, x4, x6] = *qd;
    let u = equation_5_4(p, [0.0; 2], *speeds);
    let u_1 = p.thrust_factor * (o1 * o1 + o2 * o2 + o3 * o3 + o4 * o4);
    let spin = p.rotor_inertia * (o2 + o4 - o1 - o3);
    [
        u_1 / p.m * (x1.cos() * x3.sin() * x5.cos() + x1.sin() * x5.sin()),
        u_1 / p.m * (x1.cos() * x3.sin() * x5.sin() - x1.sin() * x5.cos()),
        -G + u_1 / p.m * x1.cos() * x3.cos(),
        (iy - iz) / ix * x4 * x6 + u[0] / ix - spin / ix * x4,
        (iz - ix) / iy * x2 * x6 + u[1] / iy + spin / iy * x2,
        (ix - iy) / iz * x2 * x4 + u[2] / iz,
    ]
}

/// (5.8) is (5.12) with drag, and both are the model for small angles, wherever they are evaluated.
#[test]
fn equations_5_8_and_5_12_are_the_model_for_small_angles() {
    let mut random = Random::new(58);
    for _ in 0..100 {
        let (q, qd, speeds) = state(&mut random);
        let right = equation_5_12(&params(), &q, &qd, &speeds);
        let vacuum = Params { drag_coefficient: 0.0, ..params() };
        assert_close("(5.12)", &small_angle::accelerations(&vacuum, &[0.0; 3], &q, &qd, &speeds), &right, 1e-13);
        let slowed: [f64; 6] =
            std::array::from_fn(|i| right[i] + if i < 3 { drag(&params(), qd[i]) / params().m } else { 0.0 });
        assert_close("(5.8)", &small_angle::accelerations(&params(), &[0.0; 3], &q, &qd, &speeds), &slowed, 1e-13);
    }
}

/// Level and at rest, with rotors whose torques cancel, (5.12) and the generated equations have the same accelerations
/// and the same derivatives: what `linearize` generates is what the thesis calls "the linearized system".
#[test]
fn equation_5_12_is_exact_to_first_order_where_the_vehicle_is_level() {
    let p = Params { drag_factor: 0.0, drag_coefficient: 0.0, ..params() };
    let (q, qd, speeds) = ([0.0; 6], [0.0; 6], [300.0, 290.0, 300.0, 290.0]);
    let vehicle = QuadrotorEuler::new(p);
    let level = vehicle.forward_dynamics(&CALM, &q, &qd, &speeds);
    assert_close("level", &level, &equation_5_12(&p, &q, &qd, &speeds), 1e-14);
    let generated = vehicle.linearize(&CALM, &q, &qd, &speeds);
    let moved =
        |values: [f64; 6], k: usize, by: f64| std::array::from_fn(|i| values[i] + if i == k { by } else { 0.0 });
    let slope = |of: &dyn Fn(f64) -> [f64; 6], h: f64| -> [f64; 6] {
        let (later, earlier) = (of(h), of(-h));
        std::array::from_fn(|i| (later[i] - earlier[i]) / (2.0 * h))
    };
    for k in 0..6 {
        let by_q = slope(&|h| equation_5_12(&p, &moved(q, k, h), &qd, &speeds), 1e-5);
        assert_close("∂/∂q", &generated.q.map(|row| row[k]), &by_q, 1e-8);
        let by_qd = slope(&|h| equation_5_12(&p, &q, &moved(qd, k, h), &speeds), 1e-5);
        assert_close("∂/∂q̇", &generated.qd.map(|row| row[k]), &by_qd, 1e-8);
    }
    for rotor in 0..4 {
        let faster = |h: f64| std::array::from_fn(|i| speeds[i] + if i == rotor { h } else { 0.0 });
        let by_u = slope(&|h| equation_5_12(&p, &q, &qd, &faster(h)), 1e-2);
        assert_close("∂/∂Ω", &generated.u.map(|row| row[rotor]), &by_u, 1e-9);
    }
    // Gyroscopic terms are among them, with the sign of E31.
    assert!(SMatrix::<f64, 6, 6>::from_fn(|i, j| generated.qd[i][j]).fixed_view::<2, 2>(3, 3).norm() > 0.1);
}

/// In the attitude of (5.10) and (5.11), corrected, and with thrust m √(ẍ² + ÿ² + (z̈ + g)²), the generated vehicle has
/// the acceleration that was asked for.
#[test]
fn equations_5_10_and_5_11_give_the_acceleration_asked_for() {
    let (p, mut random) = (Params { drag_coefficient: 0.0, ..params() }, Random::new(510));
    for _ in 0..100 {
        let [x, y, z]: [f64; 3] = random.array(-4.0..4.0);
        let psi = random.uniform(-3.0..3.0);
        let size = (x * x + y * y + (z + G).powi(2)).sqrt();
        let phi = ((x * psi.sin() - y * psi.cos()) / size).asin();
        let theta = ((x * psi.cos() + y * psi.sin()) / (z + G)).atan();
        let speed = (p.m * size / (4.0 * p.thrust_factor)).sqrt();
        let q = [0.0, 0.0, 0.0, phi, theta, psi];
        let found = QuadrotorEuler::new(p).forward_dynamics(&CALM, &q, &[0.0; 6], &[speed; 4]);
        assert_close("(5.10), (5.11)", &found[..3], &[x, y, z], 1e-13);
    }
}
