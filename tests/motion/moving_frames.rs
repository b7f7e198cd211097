//! Motion in frames that move: the thesis' equations (7.4) to (7.13), corrected, against the generated ones. What the
//! print has is refuted in `tests/errata/chapter_7.rs`.
//!
//! What a formula typed here says is compared with what the generator makes of the energies of
//! `models/mechanisms/moving_frame.mbs`, `relative_cylindrical.mbs`, `relative_lvlh.mbs` and `relative_isotropic.mbs`.
//! `docs/moving_frames.md` shows them side by side.

use mbs_models::moving_frame::{self, MovingFrame};
use mbs_models::relative_cylindrical::{self, RelativeCylindrical};
use mbs_models::relative_isotropic::{self, RelativeIsotropic};
use mbs_models::relative_lvlh::{self, RelativeLvlh};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;
use mbs_tests::reference::cylindrical::{Cylindrical, equation_7_13};
use nalgebra::Vector3;

const TOLERANCE: f64 = 1e-12;

/// Constant of gravitation \[m³/(kg s²)\].
const G: f64 = 6.6743e-11;

/// A vector of time, with its first and second derivative.
type Moving = [Vector3<f64>; 3];

/// Rows of prescribed signals, from a vector of time.
fn signals([value, rate, acceleration]: Moving) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| [value[i], rate[i], acceleration[i]])
}

fn random_vector(random: &mut Random) -> Vector3<f64> {
    Vector3::from(random.array(-2.0..2.0))
}

/// (7.4) with the whole of (7.5): every inertia force is there, typed from the textbook.
#[test]
fn a_particle_in_a_moving_frame_feels_every_inertia_force() {
    let mut random = Random::new(74);
    for _ in 0..200 {
        let m = random.uniform(0.1..5.0);
        let [r, v, a, v0, v0_dot, w, w_dot] = std::array::from_fn(|_| random_vector(&mut random));
        let frame = [signals([v0, v0_dot, Vector3::zeros()]), signals([w, w_dot, Vector3::zeros()])].concat();
        let frame: [[f64; 3]; 6] = frame.try_into().unwrap();
        let a0 = v0_dot + w.cross(&v0);
        let textbook = m * (a + a0 + w_dot.cross(&r) + 2.0 * w.cross(&v) + w.cross(&w.cross(&r)));
        let particle = MovingFrame::new(moving_frame::Params { m });
        let [r, v, a] = [r, v, a].map(<[f64; 3]>::from);
        let generated = particle.inverse_dynamics(&frame, &r, &v, &a);
        assert_close("(7.4)", &generated, textbook.as_slice(), TOLERANCE);

        // Forces F move it as the same equation says.
        let force = random.array::<3>(-3.0..3.0);
        let found = particle.forward_dynamics(&frame, &r, &v, &force);
        let needed = particle.inverse_dynamics(&frame, &r, &v, &found);
        assert_close("forward", &needed, &force, TOLERANCE);
    }
}

/// The generated mechanism of a body of 1 kg, by G times the masses of centre and station.
fn generated(mu: f64, station_mu: f64) -> RelativeCylindrical<f64> {
    RelativeCylindrical::new(relative_cylindrical::Params { m: 1.0, mu, station_mass: station_mu / G })
}

/// (7.7): the kinetic energy as printed.
#[test]
fn equation_7_7_is_the_kinetic_energy() {
    let mut random = Random::new(77);
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = generated(state.mu, 0.0).kinetic_energy(&state.frame, &state.q, &state.qd);
        assert_close("(7.7)", &[generated], &[state.kinetic_energy_7_7()], TOLERANCE);
    }
}

/// (7.8) and (7.10) as printed, (7.9) with factors 1.
#[test]
fn equations_7_8_to_7_10_come_out_of_the_lagrangian() {
    let mut random = Random::new(78);
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = generated(0.0, 0.0).inverse_dynamics(&state.frame, &state.q, &state.qd, &state.qdd);
        assert_close("(7.8) to (7.10)", &generated, &state.left_sides(), TOLERANCE);
    }
}

/// (7.11) corrected: no term `−ṙ ∂φ/∂θ` in the second row, and the station's attraction along the line to it.
#[test]
fn equation_7_11_comes_out_of_the_lagrangian() {
    let mut random = Random::new(711);
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = generated(state.mu, state.station_mu);
        let residual = generated.inverse_dynamics(&state.frame, &state.q, &state.qd, &state.qdd);
        let (left, right) = (state.left_sides(), state.right_sides());
        assert_close("(7.11)", &residual, &std::array::from_fn::<_, 3, _>(|i| left[i] - right[i]), TOLERANCE);
    }
}

/// In the station's own axes and about a freely falling station it is the same motion, at any distance.
#[test]
fn both_kinds_of_coordinates_fall_alike() {
    let mut random = Random::new(713);
    for _ in 0..200 {
        let mut state = Cylindrical::random(&mut random);
        let [[r_t, r_td, _], [nu, nd, _]] = state.frame;
        state.frame = [[r_t, r_td, r_t * nd * nd - state.mu / (r_t * r_t)], [nu, nd, -2.0 * r_td * nd / r_t]];
        let ([r, theta, z], [rd, td, zd]) = (state.q, state.qd);
        let (sin, cos) = theta.sin_cos();
        // Not where the body passes the centre of attraction.
        if (r * cos + r_t).hypot(r * sin).hypot(z) < 0.3 {
            continue;
        }
        let qdd = generated(state.mu, state.station_mu).forward_dynamics(&state.frame, &state.q, &state.qd);
        let across = [qdd[0] - r * td * td, r * qdd[1] + 2.0 * rd * td];
        let want = [cos * across[0] - sin * across[1], sin * across[0] + cos * across[1], qdd[2]];
        let body =
            RelativeLvlh::new(relative_lvlh::Params { m: 3.0, mu: state.mu, station_mass: state.station_mu / G });
        let (q, qd) = ([r * cos, r * sin, z], [rd * cos - r * td * sin, rd * sin + r * td * cos, zd]);
        let found = body.forward_dynamics(&state.frame, &q, &qd, &[0.0; 3]);
        assert_close("accelerations", &found, &want, TOLERANCE);
    }
}

/// The tide 3 m from a station on its orbit, to the last digits: the linear one and the next order of the series, typed
/// by hand.
#[test]
fn the_tide_keeps_its_digits_next_to_the_station() {
    let (mu, radius): (f64, f64) = (3.986_004_418e14, 6_778_137.0);
    let rate = (mu / radius.powi(3)).sqrt();
    let body = RelativeLvlh::new(relative_lvlh::Params { m: 200.0, mu, station_mass: 0.0 });
    let frame = [[radius, 0.0, 0.0], [0.0, rate, 0.0]];
    for scale in [3.0, 3e-3, 3e-6] {
        let [x, y, z] = [0.6, -0.5, 0.3].map(|part| part * scale);
        let found = body.forward_dynamics(&frame, &[x, y, z], &[0.0; 3], &[0.0; 3]);
        let (n2, fourth) = (rate * rate, 1.5 * mu / radius.powi(4));
        let want = [
            3.0 * n2 * x - fourth * (2.0 * x * x - y * y - z * z),
            fourth * 2.0 * x * y,
            -n2 * z + fourth * 2.0 * x * z,
        ];
        // In y the tide and the centrifugal acceleration cancel but for the second order.
        let size = 3.0 * n2 * scale;
        for (found, want) in found.iter().zip(want) {
            assert!((found - want).abs() <= 1e-12 * size, "at {scale} m: {found:e}, {want:e}");
        }
    }
}

/// (7.13), with its square, holds along the motion that leaves out part of the tide.
#[test]
fn equation_7_13_holds_with_its_square() {
    let mut random = Random::new(7130);
    for _ in 0..200 {
        let (omega, station_mu) = (random.uniform(0.5..2.0), random.uniform(0.0..1.0));
        let body = RelativeIsotropic::new(relative_isotropic::Params { m: 2.0, omega, station_mass: station_mu / G });
        let q = [random.uniform(0.5..2.0), random.uniform(-3.0..3.0)];
        let qd = [random.uniform(-1.0..1.0), random.uniform(0.5..2.0)];
        let [rdd, tdd] = body.forward_dynamics(&q, &qd);
        let [left, right] = equation_7_13([q[0], qd[0], rdd], [qd[1], tdd], omega, station_mu, 2);
        assert_close("(7.13)", &[left], &[right], TOLERANCE);
        // C_r does not change: r² (ω + θ̇) is the angular momentum in axes that do not turn.
        let rate = 2.0 * q[0] * qd[0] * (1.0 + qd[1] / omega) + q[0] * q[0] * tdd / omega;
        assert_close("Ċ_r", &[rate], &[0.0], TOLERANCE);
    }
}
