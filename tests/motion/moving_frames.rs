//! Motion in frames that move: the thesis' equations (7.4) to (7.13), as printed and as corrected, against the
//! generated ones.
//!
//! What a formula typed here says is compared with what the generator makes of the energies of
//! `models/mechanisms/moving_frame.mbs`, `relative_cylindrical.mbs`, `relative_lvlh.mbs` and `relative_isotropic.mbs`.
//! `docs/moving_frames.md` shows them side by side.

use mbs_models::moving_frame::{self, MovingFrame};
use mbs_models::relative_cylindrical::{self, RelativeCylindrical};
use mbs_models::relative_isotropic::{self, RelativeIsotropic};
use mbs_models::relative_lvlh::{self, RelativeLvlh};
use mbs_tests::compare::{assert_close, error};
use mbs_tests::mechanisms::slow_frame::{self, SlowFrame};
use mbs_tests::random::Random;
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

/// With (7.6) for the transport energy `ω × v₀` and `ω × (ω × r)` are lost, and nothing else.
#[test]
fn the_approximation_7_6_loses_two_accelerations() {
    let mut random = Random::new(76);
    for _ in 0..200 {
        let m = random.uniform(0.1..5.0);
        let [r, v, a, v0, v0_dot, w, w_dot] = std::array::from_fn(|_| random_vector(&mut random));
        let frame = [signals([v0, v0_dot, Vector3::zeros()]), signals([w, w_dot, Vector3::zeros()])].concat();
        let frame: [[f64; 3]; 6] = frame.try_into().unwrap();
        let lost = m * (w.cross(&v0) + w.cross(&w.cross(&r)));
        let [r, v, a] = [r, v, a].map(<[f64; 3]>::from);
        let whole = MovingFrame::new(moving_frame::Params { m }).inverse_dynamics(&frame, &r, &v, &a);
        let approximate = SlowFrame::new(slow_frame::Params { m }).inverse_dynamics(&frame, &r, &v, &a);
        let difference: [f64; 3] = std::array::from_fn(|i| whole[i] - approximate[i]);
        assert_close("(7.6)", &difference, lost.as_slice(), TOLERANCE);
    }
}

/// On the orbit of the station what is lost is as large as gravity, and 1.28 m/s² besides at 1000 km: the values of the
/// reference.
#[test]
fn on_an_orbit_7_6_loses_the_acceleration_of_gravity() {
    let (mu, radius): (f64, f64) = (3.986_004_418e14, 6_778_137.0);
    let rate = (mu / radius.powi(3)).sqrt();
    let still = Vector3::zeros();
    let frame = [
        signals([Vector3::new(0.0, rate * radius, 0.0), still, still]),
        signals([Vector3::new(0.0, 0.0, rate), still, still]),
    ];
    let frame: [[f64; 3]; 6] = frame.concat().try_into().unwrap();
    let lost = |r: [f64; 3]| {
        let whole = MovingFrame::<f64>::default().inverse_dynamics(&frame, &r, &[0.0; 3], &[0.0; 3]);
        let approximate = SlowFrame::<f64>::default().inverse_dynamics(&frame, &r, &[0.0; 3], &[0.0; 3]);
        whole[0] - approximate[0]
    };
    let at_the_station = lost([0.0; 3]);
    assert!((at_the_station + 8.675_951_000_931_729).abs() < 1e-12, "{at_the_station}");
    let centrifugal = lost([1e6, 0.0, 0.0]) - at_the_station;
    assert!((centrifugal + 1.279_990_504_903_003_4).abs() < 1e-12, "{centrifugal}");
}

/// A station anywhere, and a body near it, in units in which all numbers are about one.
struct Cylindrical {
    mu: f64,
    station_mass: f64,
    /// r_t, ν with their derivatives.
    frame: [[f64; 3]; 2],
    /// r, θ, z
    q: [f64; 3],
    qd: [f64; 3],
    qdd: [f64; 3],
}

impl Cylindrical {
    fn random(random: &mut Random) -> Self {
        let r_t = [random.uniform(1.0..3.0), random.uniform(-1.0..1.0), random.uniform(-1.0..1.0)];
        Self {
            mu: random.uniform(0.5..2.0),
            station_mass: random.uniform(0.1..1.0) / G,
            frame: [r_t, random.array(-2.0..2.0)],
            q: [random.uniform(0.2..2.0), random.uniform(-3.0..3.0), random.uniform(-1.0..1.0)],
            qd: random.array(-2.0..2.0),
            qdd: random.array(-2.0..2.0),
        }
    }

    fn generated(&self, mu: f64, station_mass: f64) -> RelativeCylindrical<f64> {
        RelativeCylindrical::new(relative_cylindrical::Params { m: 1.0, mu, station_mass })
    }

    /// Φ, ∂Φ/∂θ, and their total time derivatives.
    fn phi(&self) -> [f64; 4] {
        let ([[r, rd, rdd], [_, nd, ndd]], theta, td) = (self.frame, self.q[1], self.qd[1]);
        let (sin, cos) = theta.sin_cos();
        [
            rd * cos + r * nd * sin,
            -rd * sin + r * nd * cos,
            rdd * cos - rd * sin * td + (rd * nd + r * ndd) * sin + r * nd * cos * td,
            -rdd * sin - rd * cos * td + (rd * nd + r * ndd) * cos - r * nd * sin * td,
        ]
    }

    /// The left sides of (7.8), (7.9) corrected, (7.10).
    fn left_sides(&self) -> [f64; 3] {
        let ([r, _, _], [rd, td, _], [rdd, tdd, zdd], [_, [_, nd, ndd]]) = (self.q, self.qd, self.qdd, self.frame);
        let [phi, slope, phi_rate, slope_rate] = self.phi();
        let turn = td + nd;
        let rate_of_square = 2.0 * r * rd * turn + r * r * (tdd + ndd);
        let rate_of_bracket = rate_of_square + rd * slope + r * slope_rate;
        [rdd - r * turn * turn + phi_rate - turn * slope, rate_of_bracket - rd * slope + r * turn * phi, zdd]
    }

    /// What (7.9) as printed has more: its factors of 2.
    fn surplus_of_7_9(&self) -> f64 {
        let [phi, slope, ..] = self.phi();
        -self.qd[0] * slope + self.q[0] * (self.qd[1] + self.frame[1][1]) * phi
    }

    /// The right sides of (7.11), corrected: forces per mass.
    fn right_sides(&self) -> [f64; 3] {
        let ([r, theta, z], r_t) = (self.q, self.frame[0][0]);
        let (sin, cos) = theta.sin_cos();
        let d = (r_t * r_t + r * r + 2.0 * r_t * r * cos + z * z).powf(1.5);
        let own = G * self.station_mass / (r * r + z * z).powf(1.5);
        [-self.mu * (r + r_t * cos) / d - own * r, self.mu * r_t * r * sin / d, -self.mu * z / d - own * z]
    }

    /// Left less right sides of (7.11) as printed, row by row.
    fn printed_7_11(&self) -> [f64; 3] {
        let ([r, theta, z], [rd, td, _], [rdd, tdd, zdd], [[r_t, ..], [_, nd, ndd]]) =
            (self.q, self.qd, self.qdd, self.frame);
        let [phi, slope, phi_rate, slope_rate] = self.phi();
        let (turn, (sin, cos)) = (nd + td, theta.sin_cos());
        let d = (r_t * r_t + r * r + 2.0 * r_t * r * cos + z * z).powf(1.5);
        let rate_of_square = 2.0 * r * rd * turn + r * r * (ndd + tdd);
        [
            rdd + phi_rate - r * turn * turn - turn * slope
                + self.mu * (r + r_t * cos) / d
                + G * self.station_mass / (r * r),
            rate_of_square + r * slope_rate - rd * slope + r * turn * phi - self.mu * r_t * r * sin / d,
            zdd + self.mu * z / d,
        ]
    }

    fn kinetic_energy_7_7(&self) -> f64 {
        let ([r, _, _], [rd, td, zd], [[r_t, r_td, _], [_, nd, _]]) = (self.q, self.qd, self.frame);
        let [phi, slope, ..] = self.phi();
        let turn = td + nd;
        let transport = r_td * r_td + r_t * r_t * nd * nd;
        0.5 * (transport + rd * rd + r * r * turn * turn + zd * zd + 2.0 * rd * phi + 2.0 * r * turn * slope)
    }
}

/// (7.7): the kinetic energy as printed.
#[test]
fn equation_7_7_is_the_kinetic_energy() {
    let mut random = Random::new(77);
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = state.generated(state.mu, 0.0).kinetic_energy(&state.frame, &state.q, &state.qd);
        assert_close("(7.7)", &[generated], &[state.kinetic_energy_7_7()], TOLERANCE);
    }
}

/// (7.8) and (7.10) as printed, (7.9) with factors 1; as printed it is off by exactly the terms that it doubles.
#[test]
fn equations_7_8_to_7_10_come_out_of_the_lagrangian() {
    let mut random = Random::new(78);
    let mut worst_print = 0.0_f64;
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = state.generated(0.0, 0.0).inverse_dynamics(&state.frame, &state.q, &state.qd, &state.qdd);
        let typed = state.left_sides();
        assert_close("(7.8) to (7.10)", &generated, &typed, TOLERANCE);
        let printed = typed[1] + state.surplus_of_7_9();
        worst_print = worst_print.max((printed - generated[1]).abs());
    }
    assert!(worst_print > 1.0, "the print is refuted: {worst_print}");
}

/// (7.11) corrected: no term `−ṙ ∂φ/∂θ` in the second row, and the station's attraction along the line to it.
#[test]
fn equation_7_11_comes_out_of_the_lagrangian() {
    let mut random = Random::new(711);
    let mut worst_print = [0.0_f64; 3];
    for _ in 0..200 {
        let state = Cylindrical::random(&mut random);
        let generated = state.generated(state.mu, state.station_mass);
        let residual = generated.inverse_dynamics(&state.frame, &state.q, &state.qd, &state.qdd);
        let (left, right) = (state.left_sides(), state.right_sides());
        assert_close("(7.11)", &residual, &std::array::from_fn::<_, 3, _>(|i| left[i] - right[i]), TOLERANCE);

        let printed = state.printed_7_11();
        for ((worst, printed), residual) in worst_print.iter_mut().zip(printed).zip(residual) {
            *worst = worst.max((printed - residual).abs());
        }
    }
    assert!(worst_print.iter().all(|&worst| worst > 0.1), "each row of the print is refuted: {worst_print:?}");
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
        let qdd = state.generated(state.mu, state.station_mass).forward_dynamics(&state.frame, &state.q, &state.qd);
        let across = [qdd[0] - r * td * td, r * qdd[1] + 2.0 * rd * td];
        let want = [cos * across[0] - sin * across[1], sin * across[0] + cos * across[1], qdd[2]];
        let body = RelativeLvlh::new(relative_lvlh::Params { m: 3.0, mu: state.mu, station_mass: state.station_mass });
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

/// (7.13) along the motion: u' and u'' of u = 1/r against θ, from the generated accelerations.
fn equation_7_13(body: &RelativeIsotropic<f64>, q: [f64; 2], qd: [f64; 2], exponent: i32) -> [f64; 2] {
    let relative_isotropic::Params { omega, station_mass, .. } = *body.params();
    let ([r, _], [rd, td]) = (q, qd);
    let [rdd, tdd] = body.forward_dynamics(&q, &qd);
    let slope = -rd / (r * r * td);
    let curvature = (-rdd / (r * r * td) + 2.0 * rd * rd / (r * r * r * td) + rd * tdd / (r * r * td * td)) / td;
    let c = r * r * (1.0 + td / omega);
    let areas = c - r * r;
    [
        areas.powi(exponent) / (r * r) * curvature + 2.0 * r * areas * slope * slope + c * c / (r * r * r),
        r + G * station_mass / (omega * omega * r * r),
    ]
}

/// (7.13) with the square holds along the motion that leaves out part of the tide; as printed it does not.
#[test]
fn equation_7_13_holds_with_its_square() {
    let mut random = Random::new(7130);
    let mut worst_print = 0.0_f64;
    for _ in 0..200 {
        let params = relative_isotropic::Params {
            m: 2.0,
            omega: random.uniform(0.5..2.0),
            station_mass: random.uniform(0.0..1.0) / G,
        };
        let body = RelativeIsotropic::new(params);
        let q = [random.uniform(0.5..2.0), random.uniform(-3.0..3.0)];
        let qd = [random.uniform(-1.0..1.0), random.uniform(0.5..2.0)];
        let [left, right] = equation_7_13(&body, q, qd, 2);
        assert_close("(7.13)", &[left], &[right], TOLERANCE);
        let [left, right] = equation_7_13(&body, q, qd, 1);
        worst_print = worst_print.max(error(&[left], &[right]));
        // C_r does not change: r² (ω + θ̇) is the angular momentum in axes that do not turn.
        let [_, tdd] = body.forward_dynamics(&q, &qd);
        let rate = 2.0 * q[0] * qd[0] * (1.0 + qd[1] / params.omega) + q[0] * q[0] * tdd / params.omega;
        assert_close("Ċ_r", &[rate], &[0.0], TOLERANCE);
    }
    assert!(worst_print > 0.1, "the print is refuted: {worst_print}");
}
