//! Chapter 5, the quadrotor, against the generated `quadrotor_euler`.

use mbs_landing::quadrotor::flatness;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::mixer::{Effort, Mixer};
use mbs_landing::quadrotor::small_angle;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_platform::{HOME, Platform};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use nalgebra::{Rotation3, SMatrix, Vector3};

use super::refuted;
use crate::quadrotor::{CALM, euler, rates};

const G: f64 = 9.80665;
/// φ, θ, ψ of the reference point, and their rates.
const ANGLES: [f64; 3] = [0.2, -0.3, 0.5];
const RATES: [f64; 3] = [0.4, -0.6, 0.8];

fn state(place: [f64; 3], angles: [f64; 3]) -> [f64; 6] {
    [place[0], place[1], place[2], angles[0], angles[1], angles[2]]
}

/// In vacuum.
fn undragged() -> Params<f64> {
    Params { drag_coefficient: 0.0, ..Params::default() }
}

/// (5.2): the energy of the rotation, as printed.
fn equation_5_2(inertias: [f64; 3], [phi, theta, _]: [f64; 3], [phid, thetad, psid]: [f64; 3]) -> f64 {
    let ((sr, cr), (sp, cp)) = (phi.sin_cos(), theta.sin_cos());
    let [ix, iy, iz] = inertias;
    0.5 * ix * (phid - psid * sp).powi(2)
        + 0.5 * iy * (thetad * cr + psid * sr * cp).powi(2)
        + 0.5 * iz * (thetad * sr - psid * cr * cp).powi(2)
}

/// Without moments of inertia nothing is left of (5.2), and the mass matrix has rank three.
#[test]
fn e22_moments_of_inertia_count() {
    let inertias = Params::<f64>::default().inertias;
    assert!(equation_5_2(inertias, ANGLES, RATES) > 1.0);
    assert_eq!(equation_5_2([0.0; 3], ANGLES, RATES), 0.0);
    let rank = |inertias| {
        let m = QuadrotorEuler::new(Params { inertias, ..undragged() }).mass_matrix(&CALM, &state([0.0; 3], ANGLES));
        SMatrix::<f64, 6, 6>::from_fn(|i, j| m[i][j]).rank(1e-9)
    };
    assert_eq!((rank(inertias), rank([0.0; 3])), (6, 3));
}

/// The generated energy is (5.2) and that of the translation.
#[test]
fn e23_kinetic_energy_of_translation() {
    let vehicle = QuadrotorEuler::<f64>::default();
    let mut random = Random::new(523);
    for _ in 0..50 {
        let [place, angles, v, w]: [[f64; 3]; 4] = std::array::from_fn(|_| random.array(-1.4..1.4));
        let generated = vehicle.kinetic_energy(&CALM, &state(place, angles), &state(v, w));
        let rotation = equation_5_2(vehicle.params().inertias, angles, w);
        let translation = 0.5 * 40.0 * v.map(|v| v * v).iter().sum::<f64>();
        assert_close("½ m v² + (5.2)", &[translation + rotation], &[generated], 1e-14);
        if translation > 1.0 {
            refuted("(5.2)", &[rotation], &[generated], 0.9);
        }
    }
}

/// The bracket of (5.3).
fn bracket([x, y, z]: [f64; 3], [phi, theta, _]: [f64; 3]) -> f64 {
    let ((sr, cr), (sp, cp)) = (phi.sin_cos(), theta.sin_cos());
    -x * sp + y * cp * sr + z * cp * cr
}

/// It is the height of a point of the body; used for the mass centre, gravity turns the vehicle and weighs less.
#[test]
fn e24_potential_energy_is_height() {
    let vehicle = QuadrotorEuler::<f64>::default();
    let (place, angles) = ([0.3, -0.4, 1.2], ANGLES);
    let q = state(place, angles);
    assert_close("m g z", &[vehicle.potential_energy(&CALM, &q)], &[40.0 * G * 1.2], 1e-15);
    assert_close("G", &vehicle.gravity(&CALM, &q), &[0.0, 0.0, 40.0 * G, 0.0, 0.0, 0.0], 1e-15);
    let turned = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]) * Vector3::from(place);
    assert_close("height of a point of the body", &[bracket(place, angles)], &[turned.z], 1e-15);
    let h = 1e-6;
    let slope = |i: usize| {
        let at = |step: f64| {
            let mut q = q;
            q[i] += step;
            40.0 * G * bracket([q[0], q[1], q[2]], [q[3], q[4], q[5]])
        };
        (at(h) - at(-h)) / (2.0 * h)
    };
    let printed: [f64; 6] = std::array::from_fn(slope);
    refuted("weight", &printed[2..3], &[40.0 * G], 20.0);
    refuted("torques of gravity", &printed[3..5], &[0.0; 2], 100.0);
    // Level, they are m g y and −m g x.
    let level = |i: usize| {
        let at = |step: f64| 40.0 * G * bracket(place, [step * f64::from(i == 3), step * f64::from(i == 4), 0.0]);
        (at(h) - at(-h)) / (2.0 * h)
    };
    assert_close("level", &[level(3), level(4)], &[-0.4 * 40.0 * G, -0.3 * 40.0 * G], 1e-8);
}

/// Generated are `Tᵀ τ`, of the same power as τ and ω; the moments themselves are other numbers.
#[test]
fn e25_moments_are_not_generalized_torques() {
    let params = Params { rotor_inertia: 0.0, ..undragged() };
    let (vehicle, mixer) = (QuadrotorEuler::new(params), Mixer::new(&params));
    let asked = Effort { thrust: 420.0, torque: [10.0, -6.0, 2.0] };
    let speeds = mixer.speeds(&asked).speed;
    let (q, qd) = (state([0.0; 3], ANGLES), state([0.0; 3], RATES));
    let force = vehicle.generalized_force(&CALM, &q, &qd, &speeds);
    let torque = Vector3::from(asked.torque);
    assert_close("Tᵀ τ", &force[3..], (rates(&q).transpose() * torque).as_slice(), 1e-12);
    let power = (0..3).map(|i| force[3 + i] * RATES[i]).sum::<f64>();
    let omega = rates(&q) * Vector3::from(RATES);
    assert_close("power", &[power], &[torque.dot(&omega)], 1e-12);
    refuted("(5.1)", &asked.torque, &force[3..], 1.0);
}

/// The direction of the thrust is that of the body's third axis; with cos ψ it is no direction.
#[test]
fn e26_thrust_along_z() {
    let vehicle = QuadrotorEuler::new(undragged());
    let speeds = [300.0; 4];
    let thrust = Mixer::new(vehicle.params()).effort(&speeds).thrust;
    let [(sr, cr), (sp, cp), (sy, cy)] = ANGLES.map(f64::sin_cos);
    let found = vehicle.forward_dynamics(&CALM, &state([0.0; 3], ANGLES), &[0.0; 6], &speeds);
    let direction = |z: f64| [sr * sy + cr * sp * cy, -cy * sr + sy * sp * cr, z];
    let right = direction(cp * cr);
    let expected: [f64; 3] = std::array::from_fn(|i| right[i] * thrust / 40.0 - if i == 2 { G } else { 0.0 });
    assert_close("(5.7)", &expected, &found[..3], 1e-13);
    let norm = |d: [f64; 3]| Vector3::from(d).norm();
    assert_close("a direction", &[norm(right)], &[1.0], 1e-15);
    refuted("(5.7) in z", &[cy * cr], &[cp * cr], 0.05);
    refuted("length as printed", &[norm(direction(cy * cr))], &[1.0], 0.05);
}

/// Backwards the printed drag pushes on.
#[test]
fn e27_drag_opposes_motion() {
    let (vehicle, still) = (QuadrotorEuler::<f64>::default(), [0.0; 4]);
    let k = 1.0 * 1.225 * 0.5 / 80.0;
    for v in [2.0, -2.0] {
        let found = vehicle.forward_dynamics(&CALM, &[0.0; 6], &state([v, 0.0, 0.0], [0.0; 3]), &still)[0];
        assert_close("−k |ẋ| ẋ", &[found], &[-k * v.abs() * v], 1e-15);
        assert!(found * v < 0.0, "it takes energy");
        let printed = -k * v * v;
        assert_eq!(printed * v < 0.0, v > 0.0, "as printed only forwards");
    }
}

/// Rotors that spin, without torques: [300, 290, 300, 290] rad/s have Ω_r = −20 rad/s.
const SPINNING: [f64; 4] = [300.0, 290.0, 300.0, 290.0];
const OMEGA_R: f64 = -20.0;

fn accelerations(angles: [f64; 3], angle_rates: [f64; 3], speeds: &[f64; 4]) -> [f64; 3] {
    let params = Params { drag_factor: 0.0, ..undragged() };
    let vehicle = QuadrotorEuler::new(params);
    let found = vehicle.forward_dynamics(&CALM, &state([0.0; 3], angles), &state([0.0; 3], angle_rates), speeds);
    [found[3], found[4], found[5]]
}

/// Tilted and at rest nothing turns; turning about y the rotors' spin turns it about x. `mbs check` refuses the print:
/// `language::misprints::equation_5_8`.
#[test]
fn e28_gyroscopic_torque_takes_the_rate() {
    let tilted = accelerations([0.0, 0.3, 0.0], [0.0; 3], &SPINNING);
    assert_close("at rest", &tilted, &[0.0; 3], 1e-15);
    refuted("−J_r θ Ω_r/I_xx", &[-0.012 * 0.3 * OMEGA_R / 3.2], &tilted[..1], 0.02);
    let turning = accelerations([0.0; 3], [0.0, 0.3, 0.0], &SPINNING);
    assert_close("−J_r θ̇ Ω_r/I_xx", &turning[..1], &[-0.012 * 0.3 * OMEGA_R / 3.2], 1e-15);
}

/// The difference of thrusts of rotors 3 and 1 acts on the arm.
#[test]
fn e29_arm_not_inertia() {
    let speeds = [290.0, 300.0, 310.0, 300.0];
    let u_3 = 1.1e-3 * (310.0_f64.powi(2) - 290.0_f64.powi(2));
    let found = accelerations([0.0; 3], [0.0; 3], &speeds)[1];
    assert_close("l U₃/I_yy", &[0.75 * u_3 / 3.2], &[found], 1e-14);
    refuted("I U₃/I_yy", &[3.2 * u_3 / 3.2], &[found], 10.0);
}

/// The force U₂ of (5.8), put into (5.12), which takes a torque, is off by the arm.
#[test]
fn e30_forces_or_torques() {
    let speeds = [300.0, 290.0, 300.0, 310.0];
    let params = undragged();
    let u_2 = params.thrust_factor * (310.0_f64.powi(2) - 290.0_f64.powi(2));
    let found = accelerations([0.0; 3], [0.0; 3], &speeds)[0];
    let torque = Mixer::new(&params).effort(&speeds).torque[0];
    assert_close("l U₂/I_xx, U₂ a force", &[params.arm * u_2 / 3.2], &[found], 1e-14);
    assert_close("U₂/I_xx, U₂ a torque", &[torque / 3.2], &[found], 1e-14);
    refuted("U₂/I_xx, U₂ a force", &[u_2 / 3.2], &[found], 1.0);
}

/// Rolling with spinning rotors it pitches; as (5.4) and (5.8) have it, not as (5.12).
#[test]
fn e31_sign_of_the_gyroscopic_torque() {
    let found = accelerations([0.0; 3], [0.4, 0.0, 0.0], &SPINNING)[1];
    let term = 0.012 * OMEGA_R / 3.2 * 0.4;
    assert_close("+J_r Ω_r/I_yy x₂", &[term], &[found], 1e-14);
    refuted("−J_r Ω_r/I_yy x₂", &[-term], &[found], 0.05);
    let (q, qd) = ([0.0; 6], [0.0, 0.0, 0.0, 0.4, 0.0, 0.0]);
    let by_euler = euler(&undragged(), &q, &qd, Vector3::zeros(), 0.012 * OMEGA_R);
    assert_close("−ω × (0, 0, J_r Ω_r)", &[by_euler.y], &[found], 1e-14);
}

/// Angles, rates and torques of the reference point, scaled: the error of (5.8) and (5.12) is of the first order,
/// relative to the accelerations.
#[test]
fn e32_small_angles_only() {
    let error = |scale: f64| {
        let scaled = |values: [f64; 3]| values.map(|x| x * scale);
        let (q, qd) = (state([0.0; 3], scaled(ANGLES)), state([0.0; 3], scaled(RATES)));
        let effort = Effort { thrust: 420.0, torque: scaled([1.0, -2.0, 0.5]) };
        let speeds = Mixer::new(&Params::default()).speeds(&effort).speed;
        let total = speeds[1] + speeds[3] - speeds[0] - speeds[2];
        // Only the product of the rotors' inertia and speed counts, and the torques fix the speeds.
        let params = Params { rotor_inertia: 0.012 * 20.0 * scale / total, ..Params::default() };
        let exact = QuadrotorEuler::new(params).forward_dynamics(&CALM, &q, &qd, &speeds);
        let approximate = small_angle::accelerations(&params, &[0.0; 3], &q, &qd, &speeds);
        let by_euler = euler(&params, &q, &qd, Vector3::from(effort.torque), 0.012 * 20.0 * scale);
        assert_close("exact", &exact[3..], by_euler.as_slice(), 1e-9);
        let difference = (3..6).map(|i| (exact[i] - approximate[i]).abs()).fold(0.0, f64::max);
        difference / exact[3..].iter().map(|x| x.abs()).fold(0.0, f64::max)
    };
    let found = [1.0, 0.1, 0.01].map(error);
    assert!((found[0] - 1.10).abs() < 0.01 && (found[1] - 0.080).abs() < 0.001, "{found:?}");
    assert!((found[1] / found[2] - 10.0).abs() < 0.5 && (found[2] / error(0.001) - 10.0).abs() < 0.1, "{found:?}");
}

/// An acceleration that is asked for, the velocity at that moment, and the yaw.
const ASKED: ([f64; 3], [f64; 3], f64) = ([1.0, -2.0, 3.0], [7.0, 4.0, -0.4], 0.4);

/// What thrust gives in this attitude, with the size that the acceleration asks for.
fn given(roll: f64, pitch: f64) -> [f64; 3] {
    let ([x, y, z], _, yaw) = ASKED;
    let axis = Rotation3::from_euler_angles(roll, pitch, yaw) * Vector3::z();
    (axis * Vector3::new(x, y, z + G).norm() - Vector3::new(0.0, 0.0, G)).into()
}

/// (5.10) with these squares under the root.
fn equation_5_10([a, b]: [f64; 2]) -> f64 {
    let ([x, y, z], _, yaw) = ASKED;
    ((x * yaw.sin() - y * yaw.cos()) / (a * a + b * b + (z + G).powi(2)).sqrt()).asin()
}

/// (5.11) with or without the x in the print's gap.
fn equation_5_11(x: f64) -> f64 {
    let ([_, y, z], _, yaw) = ASKED;
    ((x * yaw.cos() + y * yaw.sin()) / (z + G)).atan()
}

/// With accelerations under the root, thrust gives what was asked for; with velocities it does not.
#[test]
fn e33_roll_from_accelerations() {
    let ([x, y, z], [xd, yd, _], yaw) = ASKED;
    let attitude = flatness::attitude([x, y, z], yaw, G).expect("upright");
    let (right, printed) = (equation_5_10([x, y]), equation_5_10([xd, yd]));
    assert_close("(5.10)", &[right], &[attitude.roll], 1e-15);
    assert_close("acceleration", &given(right, attitude.pitch), &[x, y, z], 1e-14);
    refuted("acceleration by the print", &given(printed, attitude.pitch), &[x, y, z], 0.01);
}

/// With ẍ thrust gives what was asked for; with the gap read as 1, or left out, it does not.
#[test]
fn e34_pitch_from_both_accelerations() {
    // 1 for ẍ is what the gap could be read as: not 1 here.
    let ([x, y, z], _, yaw) = ([1.6, -2.0, 3.0], (), ASKED.2);
    let attitude = flatness::attitude([x, y, z], yaw, G).expect("upright");
    assert_close("(5.11)", &[equation_5_11(x)], &[attitude.pitch], 1e-15);
    refuted("(5.11), a gap of 1", &[equation_5_11(1.0)], &[attitude.pitch], 0.03);
    refuted("(5.11), a gap of 0", &[equation_5_11(0.0)], &[attitude.pitch], 0.1);
}

/// Four inputs reach four of six accelerations, and no velocity is forbidden; twice the state has not twice the rate.
#[test]
fn e35_underactuated_not_constrained() {
    let vehicle = QuadrotorEuler::<f64>::default();
    let (q, speeds) = (state([0.0; 3], ANGLES), [300.0; 4]);
    let by_inputs = vehicle.linearize(&CALM, &q, &state([0.0; 3], RATES), &speeds).u;
    assert_eq!(SMatrix::<f64, 6, 4>::from_fn(|i, j| by_inputs[i][j]).rank(1e-9), 4);
    // Six momenta from six velocities: a nonholonomic constraint would leave fewer.
    let m = vehicle.mass_matrix(&CALM, &q);
    assert_eq!(SMatrix::<f64, 6, 6>::from_fn(|i, j| m[i][j]).rank(1e-9), 6);
    let rate = |scale: f64| {
        let [q, qd] = [ANGLES, RATES].map(|values| state([0.0; 3], values.map(|x| scale * x)));
        small_angle::accelerations(vehicle.params(), &[0.0; 3], &q, &qd, &speeds)
    };
    let (once, twice, none) = (rate(1.0), rate(2.0), rate(0.0));
    let linear: [f64; 6] = std::array::from_fn(|i| 2.0 * once[i] - none[i]);
    refuted("(5.12) linear", &linear, &twice, 0.1);
}

/// Elevations of the thesis against the platform of its chapter 4 and against free fall.
#[test]
fn e36_platform_out_of_reach() {
    let largest = |heave: Heave<4>| {
        let mut most = [0.0_f64; 3];
        for i in 0..=40_000 {
            let at = heave.at(1e-3 * f64::from(i));
            for (most, value) in most.iter_mut().zip([at.value, at.rate, at.acceleration]) {
                *most = most.max(value.abs());
            }
        }
        most
    };
    let [first, second] = [Heave::CASE_I, Heave::CASE_II].map(largest);
    assert_close("case I", &first, &[1.451_655_770_5, 1.492_256_510_5, 1.420_120_921_1], 1e-5);
    assert_close("case II", &second, &[1.447_550_954_1, 4.131_194_339_5, 11.037_016_332_2], 1e-5);
    let platform = Platform::default();
    for (heave, most) in [(Heave::CASE_I, first), (Heave::CASE_II, second)] {
        assert!(HOME[2] - most[0] < 0.0, "through its own base");
        let survey = platform.survey(&heave.about(2.0), 40.0, 0.02).expect("high enough to be computed");
        assert!(!survey.is_clear() && survey.length[1] - survey.length[0] > 2.0, "strokes of {:?}", survey.length);
    }
    assert!(second[2] < Heave::CASE_II.acceleration_bound() && second[2] > G);
    let falling = flatness::attitude([0.0, 0.0, -second[2]], 0.0, G);
    assert!(falling.is_err_and(|wrong| wrong.value < -1.0), "{falling:?}");
}
