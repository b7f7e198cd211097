//! Docking of bodies: the generated mechanism against Newton and Euler and closed forms, and every part by itself.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use mbs_models::check::{Invalid, Must};
use mbs_models::{At, Error, Failure};
use mbs_orbit::EARTH_MU;
use mbs_orbit::soft_docking::attitude::AttitudeControl;
use mbs_orbit::soft_docking::bodies::{Body, Pair, rate};
use mbs_orbit::soft_docking::docking_bodies::{DockingBodies, Params};
use mbs_orbit::soft_docking::finite_burn::{Engine, Vehicle};
use mbs_orbit::soft_docking::flight::{SoftDocking, Start};
use mbs_orbit::soft_docking::jets::{JETS, JetSet};
use mbs_orbit::soft_docking::plume::{Panel, Plume};
use mbs_orbit::soft_docking::ring::{Latches, Limit, Outcome, axial_oscillator, meet};
use mbs_orbit::vector::StateVector;
use mbs_runtime::{Dop853, Integrator, State};
use mbs_tests::random::Random;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

/// Far apart in free space, where nothing acts.
fn free() -> Params<f64> {
    Params { mu: 0.0, ..Params::default() }
}

fn still(position: [f64; 3]) -> Body {
    Body { position, velocity: [0.0; 3], attitude: [1.0, 0.0, 0.0, 0.0], spin: [0.0; 3] }
}

fn fly(params: &Params<f64>, pair: &Pair, end: f64, torque: impl Fn(&Pair) -> [f64; 3]) -> Pair {
    let bodies = DockingBodies::new(*params);
    let mut state = pair.to_state(params);
    let motion = |_: f64, q: &[f64; 14], qd: &[f64; 14], qdd: &mut [f64; 14]| {
        let mut inputs = [0.0; 12];
        inputs[3..6].copy_from_slice(&torque(&Pair::from_state(params, &State::new(*q, *qd))));
        *qdd = bodies.forward_dynamics(q, qd, &inputs);
    };
    let summary = Dop853::new(1e-12, 1e-14).integrate(motion, 0.0, end, &mut state, |_| ControlFlow::Continue(()));
    assert!(summary.is_ok());
    Pair::from_state(params, &state)
}

fn rotation(body: &Body) -> Matrix3<f64> {
    let [w, x, y, z] = body.attitude;
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_rotation_matrix().into_inner()
}

/// Place, velocity and angular velocity in inertial axes that coincide with those of free space, and the inertia there.
fn in_space(body: &Body, inertia: [f64; 3]) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>, Matrix3<f64>) {
    let turn = rotation(body);
    let inertia = turn * Matrix3::from_diagonal(&Vector3::from(inertia)) * turn.transpose();
    (Vector3::from(body.position), Vector3::from(body.velocity), turn * Vector3::from(body.spin), inertia)
}

fn momenta(params: &Params<f64>, pair: &Pair) -> (Vector3<f64>, Vector3<f64>) {
    let bodies = [
        (&pair.chaser, params.chaser_mass, params.chaser_inertia),
        (&pair.station, params.station_mass, params.station_inertia),
    ];
    bodies.into_iter().fold((Vector3::zeros(), Vector3::zeros()), |(linear, angular), (body, mass, inertia)| {
        let (r, v, w, i) = in_space(body, inertia);
        (linear + mass * v, angular + r.cross(&(mass * v)) + i * w)
    })
}

/// ω̈ of a symmetric top: its transverse spin goes round at (A − B)/B of the axial one, in its own axes.
#[test]
fn a_symmetric_top_goes_round_as_euler_says() {
    let params = Params { chaser_inertia: [8000.0, 15_000.0, 15_000.0], ..free() };
    let chaser = Body { spin: [0.3, 0.1, 0.0], ..still([0.0, -500.0, 0.0]) };
    let pair = Pair { chaser, station: still([0.0; 3]) };
    let end = fly(&params, &pair, 60.0, |_| [0.0; 3]);
    let angle = (8000.0 - 15_000.0) / 15_000.0 * 0.3 * 60.0;
    // ω̇_y = (C − A)/B ω_z ω_x, so that it turns against the axial spin where A < B.
    for (found, expected) in end.chaser.spin.into_iter().zip([0.3, 0.1 * f64::cos(angle), 0.1 * f64::sin(angle)]) {
        close(found, expected, 1e-10);
    }
}

/// An asymmetric top comes back to its spin after the period 4 K(k)/p of Jacobi's functions, K by Gauss' mean.
#[test]
fn an_asymmetric_top_has_the_period_of_jacobi() {
    let (a, b, c) = (8000.0, 12_000.0, 16_000.0);
    let params = Params { chaser_inertia: [a, b, c], ..free() };
    let spin = [0.05, 0.0, 0.2];
    let pair = Pair { chaser: Body { spin, ..still([0.0, -500.0, 0.0]) }, station: still([0.0; 3]) };
    let energy = a * spin[0] * spin[0] + c * spin[2] * spin[2];
    let momentum = (a * spin[0]).powi(2) + (c * spin[2]).powi(2);
    // Landau, Lifshitz, Mechanics, 1976, (37.8) to (37.12), for L² > 2 E B.
    assert!(momentum > energy * b);
    let p = ((c - b) * (momentum - energy * a) / (a * b * c)).sqrt();
    let square = (b - a) * (energy * c - momentum) / ((c - b) * (momentum - energy * a));
    let (mut mean, mut geometric) = (1.0_f64, (1.0 - square).sqrt());
    for _ in 0..8 {
        (mean, geometric) = (0.5 * (mean + geometric), (mean * geometric).sqrt());
    }
    let period = 4.0 * (0.5 * PI / mean) / p;
    let end = fly(&params, &pair, period, |_| [0.0; 3]);
    for (found, expected) in end.chaser.spin.into_iter().zip(spin) {
        close(found, expected, 1e-10);
    }
    let half = fly(&params, &pair, 0.5 * period, |_| [0.0; 3]);
    close(half.chaser.spin[0], -spin[0], 1e-10);
}

/// About the normal of the orbit a station swings with n √(3 (I_y − I_x)/I_z).
#[test]
fn the_gravity_gradient_makes_the_station_swing() {
    let params = Params::<f64>::default();
    let n = rate(&params);
    let [a, b, c] = params.station_inertia;
    let frequency = n * (3.0 * (b - a) / c).sqrt();
    let angle = 1e-4_f64;
    let attitude = [(0.5 * angle).cos(), 0.0, 0.0, (0.5 * angle).sin()];
    let station = Body { attitude, spin: [0.0, 0.0, n], ..still([0.0; 3]) };
    let chaser = Body { spin: [0.0, 0.0, n], ..still([0.0, -5000.0, 0.0]) };
    for part in [0.25, 0.5, 1.0] {
        let end = fly(&params, &Pair { chaser, station }, part * TAU / frequency, |_| [0.0; 3]);
        let found = 2.0 * end.station.attitude[3];
        // The vertical turns by 3e-10, since the gradient moves the mass centre along the orbit.
        close(found, angle * (part * TAU).cos(), 1e-9);
    }
}

/// Newton and Euler by hand, tide, gradient and ring, at random states.
#[test]
fn accelerations_are_those_of_newton_and_euler() {
    let mut random = Random::new(17);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.uniform(-size..size));
    for latched in [0.0, 1.0] {
        let params = Params { latched, ..Params::default() };
        let (n, bodies) = (Vector3::new(0.0, 0.0, rate(&params)), DockingBodies::new(params));
        for _ in 0..20 {
            let mut start = SoftDocking::to_the_station();
            start.params = params;
            let aside = vector(0.2);
            // In the ring beyond the depth of the trip.
            start.start = Start {
                distance: -0.05 - 0.1 * aside.x.abs(),
                aside: [aside.y, aside.z],
                angles: vector(0.2).into(),
                spin: vector(0.01).into(),
            };
            let mut pair = start.pair();
            pair.chaser.velocity = (Vector3::from(pair.chaser.velocity) + vector(0.1)).into();
            pair.station.spin = (Vector3::from(pair.station.spin) + vector(0.002)).into();
            let state = pair.to_state(&params);
            let inputs: [f64; 12] = std::array::from_fn(|i| vector(if i < 6 { 100.0 } else { 1000.0 })[i % 3]);
            let qdd = bodies.forward_dynamics(&state.q, &state.qd, &inputs);
            let input = |at: usize| Vector3::new(inputs[at], inputs[at + 1], inputs[at + 2]);

            // The ring, at the chaser's port, in the axes of the orbit.
            let (r, v, w, i) = in_space(&pair.chaser, params.chaser_inertia);
            let (s, u, x, j) = in_space(&pair.station, params.station_inertia);
            let ring = rotation(&pair.station) * rotation(&Body { attitude: yaw(0.5 * PI), ..still([0.0; 3]) });
            let arm = rotation(&pair.chaser) * Vector3::from(params.chaser_port);
            let port = r + arm;
            let origin = s + rotation(&pair.station) * Vector3::from(params.station_port);
            let apart = ring.transpose() * (port - origin);
            let slide = v + (w - n).cross(&arm) - u - (x - n).cross(&(port - s));
            let slide = ring.transpose() * slide;
            let stiffness = Vector3::new(params.axial_stiffness, params.lateral_stiffness, params.lateral_stiffness);
            let damping = Vector3::new(params.axial_damping, params.lateral_damping, params.lateral_damping);
            let force = -(ring * (stiffness.component_mul(&apart) + damping.component_mul(&slide)));
            // Of V = k (3 − tr R)/2 with R from the station's port to the chaser's: half of k times the sum of a × b.
            let turned: Vector3<f64> = (0..3)
                .map(|k| {
                    let own = rotation(&pair.chaser).column(k).into_owned();
                    own.cross(&ring.column(k).into_owned())
                })
                .sum();
            let torque = 0.5 * params.angular_stiffness * turned - params.angular_damping * (w - x);

            let tide = |place: Vector3<f64>, velocity: Vector3<f64>| {
                let whole = Vector3::new(params.radius, 0.0, 0.0) + place;
                -2.0 * n.cross(&velocity) - n.cross(&n.cross(&whole)) - whole * (params.mu / whole.norm().powi(3))
            };
            let gradient = |place: Vector3<f64>, inertia: &Matrix3<f64>| {
                let whole = Vector3::new(params.radius, 0.0, 0.0) + place;
                3.0 * params.mu / whole.norm().powi(5) * whole.cross(&(inertia * whole))
            };
            let push = rotation(&pair.chaser) * input(0);
            let expected = tide(r, v) + (force + push) / params.chaser_mass;
            let other = tide(s, u) + (rotation(&pair.station) * input(6) - force) / params.station_mass;
            for k in 0..3 {
                // MacCullagh's term moves mass centres, too, by 2e-10 m/s², which is left out by hand.
                close(qdd[k], expected[k], 1e-11);
                close(qdd[7 + k], other[k], 1e-9);
            }
            // Euler in the axes of each body; ω̇ from the second derivative of the quaternion, with what the axes' own
            // turning adds.
            let spin_rate = |body: &Body, at: usize| {
                let e = Quaternion::new(state.q[at], state.q[at + 1], state.q[at + 2], state.q[at + 3]);
                let ed = Quaternion::new(state.qd[at], state.qd[at + 1], state.qd[at + 2], state.qd[at + 3]);
                let edd = Quaternion::new(qdd[at], qdd[at + 1], qdd[at + 2], qdd[at + 3]);
                let against = 2.0 * (e.conjugate() * ed).imag();
                let turning = rotation(body).transpose() * n;
                2.0 * (e.conjugate() * edd).imag() + turning.cross(&against)
            };
            let about = |body: &Body, principal: [f64; 3], torque: Vector3<f64>, at: usize| {
                let (spin, inertia) = (Vector3::from(body.spin), Matrix3::from_diagonal(&Vector3::from(principal)));
                let euler = inertia * spin_rate(body, at) + spin.cross(&(inertia * spin));
                let expected = rotation(body).transpose() * torque;
                for k in 0..3 {
                    close(euler[k], expected[k], 1e-9 * (1.0 + principal[k]).max(expected.norm()));
                }
            };
            let on_chaser = rotation(&pair.chaser) * input(3) + arm.cross(&force) + torque + gradient(r, &i);
            let on_station = rotation(&pair.station) * input(9) - (port - s).cross(&force) - torque + gradient(s, &j);
            about(&pair.chaser, params.chaser_inertia, on_chaser, 3);
            about(&pair.station, params.station_inertia, on_station, 10);

            // The ports as the mechanism has them.
            let ports = pair.misalignment(&params);
            let (gap, speed) = (bodies.gap(&state.q), bodies.gap_velocity(&state.q, &state.qd));
            for k in 0..3 {
                close(ports.place[k], gap[k], 1e-13);
                close(ports.velocity[k], speed[k], 1e-13);
            }
        }
    }
}

fn yaw(angle: f64) -> [f64; 4] {
    [(0.5 * angle).cos(), 0.0, 0.0, (0.5 * angle).sin()]
}

/// Two masses on a line, latched: the damped oscillator of the reduced mass.
#[test]
fn a_latched_ring_is_a_damped_oscillator() {
    let params = Params { latched: 1.0, ..free() };
    let start = SoftDocking { params, speeds: [0.07; 2], ..SoftDocking::to_the_station() };
    let start = at_touch(start, [0.0; 2], [0.0; 3], [0.0; 3]);
    let [frequency, damping] = axial_oscillator(&params);
    let mass: f64 = 1.0 / (1.0 / 7000.0 + 1.0 / 420_000.0);
    close(frequency, (2000.0 / mass).sqrt(), 1e-12);
    let damped = frequency * (1.0 - damping * damping).sqrt();
    for t in [0.7, 3.0, 11.0] {
        let depth = fly(&params, &start.pair(), t, |_| [0.0; 3]).misalignment(&params).place[0];
        close(depth, 0.07 / damped * (-damping * frequency * t).exp() * (damped * t).sin(), 1e-11);
    }
}

/// At touch, so.
fn at_touch(docking: SoftDocking, aside: [f64; 2], angles: [f64; 3], spin: [f64; 3]) -> SoftDocking {
    SoftDocking { start: Start { distance: 0.0, aside, angles, spin }, ..docking }
}

/// In free space, through touch, trip and capture, or rebound.
#[test]
fn contact_keeps_both_momenta_and_loses_energy() {
    for (tilt, outcome) in [(0.05, Outcome::Captured), (0.1, Outcome::Bounced)] {
        let docking = SoftDocking { params: free(), speeds: [0.07; 2], ..SoftDocking::to_the_station() };
        let docking = at_touch(docking, [0.05, -0.03], [0.02, tilt, 0.0], [0.001, 0.002, 0.0]);
        let first = momenta(&docking.params, &docking.pair());
        let mut state = docking.pair().to_state(&docking.params);
        let (mut last, mut drift, mut looks) = (f64::INFINITY, [0.0_f64; 2], 0);
        let contact = meet(&docking.params, &docking.latches, &mut state, [0.0, 30.0], |pressing| {
            let (linear, angular) = momenta(&docking.params, &pressing.pair);
            drift = [drift[0].max((linear - first.0).norm()), drift[1].max((angular - first.1).norm())];
            assert!(pressing.energy <= last + 1e-9, "{} after {last}", pressing.energy);
            (last, looks) = (pressing.energy, looks + 1);
        });
        let contact = contact.unwrap();
        assert_eq!(contact.outcome, outcome, "{contact:?}");
        // Of 490 kg·m/s and of 7400 kg·m²/s.
        assert!(looks > 100 && drift[0] < 1e-7 && drift[1] < 1e-3, "{drift:?}");
        assert!(contact.energy[1] < contact.energy[0] - 1.0, "{contact:?}");
    }
}

#[test]
fn latches_close_within_their_limits_alone() {
    let limits = Latches::STANDARD;
    let case = |speed: f64, aside: f64, angles: [f64; 3]| {
        let docking = SoftDocking { speeds: [speed; 2], ..SoftDocking::to_the_station() };
        let docking = at_touch(docking, [aside, 0.0], angles, [0.0; 3]);
        let mut state = docking.pair().to_state(&docking.params);
        let contact = meet(&docking.params, &limits, &mut state, [0.0, 60.0], |_| {}).unwrap();
        (contact.outcome, contact.refused)
    };
    assert_eq!(case(0.07, 0.05, [0.03, 0.03, 0.0]), (Outcome::Captured, None));
    assert_eq!(case(0.14, 0.0, [0.0; 3]), (Outcome::Bounced, Some(Limit::TooFast)));
    assert_eq!(case(0.03, 0.0, [0.0; 3]), (Outcome::Bounced, Some(Limit::TooSlow)));
    assert_eq!(case(0.07, 0.15, [0.0; 3]), (Outcome::Bounced, Some(Limit::Lateral)));
    assert_eq!(case(0.07, 0.0, [0.0, 0.1, 0.0]), (Outcome::Bounced, Some(Limit::Tilt)));
    assert_eq!(case(0.07, 0.0, [0.1, 0.0, 0.0]), (Outcome::Bounced, Some(Limit::Roll)));
    assert_eq!(case(0.07, 0.7, [0.0; 3]), (Outcome::Missed, None));
}

/// About one axis, without limits: a damped oscillator of the angle.
#[test]
fn quaternion_feedback_brings_a_small_angle_back() {
    let params = free();
    let control = AttitudeControl { frequency: 0.2, damping: 0.7 };
    let angle = 1e-4_f64;
    let chaser = Body { attitude: [(0.5 * angle).cos(), (0.5 * angle).sin(), 0.0, 0.0], ..still([0.0, -500.0, 0.0]) };
    let pair = Pair { chaser, station: still([0.0; 3]) };
    let torque =
        |pair: &Pair| control.torque(&params.chaser_inertia, &pair.chaser.attitude, &pair.chaser.spin, &[0.0; 3]);
    let end = fly(&params, &pair, 9.0, torque);
    let damped = 0.2 * (1.0 - 0.49_f64).sqrt();
    let expected = (-0.14 * 9.0_f64).exp() * ((damped * 9.0).cos() + 0.14 / damped * (damped * 9.0).sin());
    close(2.0 * end.chaser.attitude[1] / angle, expected, 1e-7);
}

#[test]
fn jets_make_the_wrench_and_never_pull() {
    let jets = JetSet::capsule(20.0 * PI / 180.0);
    let mut random = Random::new(5);
    for _ in 0..200 {
        let wrench: [f64; 6] = std::array::from_fn(|_| random.uniform(-300.0..300.0));
        let thrusts = jets.allocate(&wrench);
        assert!(thrusts.iter().all(|thrust| *thrust >= 0.0), "{thrusts:?}");
        for (found, asked) in jets.wrench(&thrusts).into_iter().zip(wrench) {
            close(found, asked, 1e-3);
        }
    }
    // Ahead by the four behind alone, alike.
    let ahead = jets.allocate(&[200.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for (jet, thrust) in ahead.into_iter().enumerate() {
        close(thrust, if (4..8).contains(&jet) { 50.0 } else { 0.0 }, 1e-4);
    }
    // What is asked for is fired in the long run, though no pulse is shorter than the valve allows.
    let (mut owed, mut fired) = ([0.0; JETS], 0.0);
    for _ in 0..1000 {
        let open = jets.pulses(&[0.3; JETS], &mut owed);
        assert!(open.iter().all(|time| *time == 0.0 || (jets.shortest..=jets.period).contains(time)));
        fired += open[0] * jets.thrust;
    }
    close(fired, 300.0, jets.thrust * jets.shortest);
    let open = jets.pulses(&[400.0; JETS], &mut [0.0; JETS]);
    assert_eq!(open, [jets.period; JETS]);
}

/// The momentum through a hemisphere, and that on a wide plate, are the thrust.
#[test]
fn a_plume_has_the_momentum_of_the_thrust() {
    let plume = Plume { exponent: 10.0, parts: 400 };
    let steps = 20_000;
    let sum: f64 = (0..steps)
        .map(|i| {
            let angle = 0.5 * PI * (f64::from(i) + 0.5) / f64::from(steps);
            let ring = TAU * 9.0 * angle.sin() * 0.5 * PI / f64::from(steps);
            plume.pressure(100.0, 3.0, angle.cos()) * angle.cos() * ring
        })
        .sum();
    close(sum, 100.0, 1e-5);
    let plate = Panel { middle: [2.0, 0.0, 0.0], halves: [[0.0, 0.0, 30.0], [0.0, 30.0, 0.0]] };
    let [force, torque] = plume.wrench(100.0, &[0.0; 3], &[1.0, 0.0, 0.0], &[plate]);
    close(force[0], 100.0, 0.05);
    assert!(force[1].abs() < 1e-9 && torque.iter().all(|torque| torque.abs() < 1e-9), "{force:?} {torque:?}");
    // From behind nothing meets it.
    assert_eq!(plume.wrench(100.0, &[4.0, 0.0, 0.0], &[-1.0, 0.0, 0.0], &[plate]), [[0.0; 3]; 2]);
}

/// The more thrust, the nearer to the impulse: the gravity loss with the square of the duration, by Tsiolkovsky's mass.
#[test]
fn finite_burns_become_impulses() {
    let raise = |thrust: f64| {
        Engine { thrust, exhaust_velocity: 3000.0 }.raise(EARTH_MU, 7000.0, [6_698_137.0, 6_778_137.0]).unwrap()
    };
    let [weak, strong] = [1600.0, 3200.0].map(raise);
    let ratio = weak.gravity_loss / strong.gravity_loss;
    close(ratio, 4.0, 0.01);
    assert!(raise(1e6).gravity_loss.abs() < 1e-6 && raise(1e6).too_low[0].abs() < 0.05);
    let total = weak.delta_v[0] + weak.delta_v[1];
    close(weak.propellant, 7000.0 * (1.0 - (-total / 3000.0).exp()), 1e-8);
    // Without attraction to speak of the change of velocity is all of it.
    let state = StateVector::new([7e6, 0.0, 0.0], [0.0; 3]);
    let engine = Engine { thrust: 500.0, exhaust_velocity: 3000.0 };
    let (end, time) = engine.burn(1e-6, &Vehicle { state, mass: 1000.0 }, &[0.0, 800.0, 0.0]).unwrap();
    close(end.state.velocity[1], 800.0, 1e-7);
    close(end.mass, 1000.0 * (-800.0_f64 / 3000.0).exp(), 1e-8);
    close(time, (1000.0 - end.mass) * 3000.0 / 500.0, 1e-8);
}

#[test]
fn a_final_approach_is_captured() {
    let mut moments = 0;
    let report = SoftDocking::to_the_station().fly(|_| moments += 1).unwrap();
    assert_eq!(report.contact.outcome, Outcome::Captured, "{report:?}");
    let touch = &report.contact.touch;
    assert!(touch.lateral() < 0.03 && touch.tilt < 0.01 && (0.06..0.08).contains(&touch.closing()), "{touch:?}");
    close(report.propellant, report.impulse / (285.0 * 9.80665), 1e-12);
    // What plumes gave the station is more than what its mass centre has, for they do not all push one way.
    let speed = Vector3::from(report.station.velocity).norm();
    assert!(speed > 0.0 && speed * 420_000.0 < report.plume_impulse * 1.2, "{report:?}");
    assert!(moments > 200 && report.contact.ports.lateral() < 1e-3, "{report:?}");
}

#[test]
fn what_it_does_not_work_with_is_refused() {
    let good = SoftDocking::to_the_station();
    let refused = |docking: SoftDocking| docking.fly(|_| {}).unwrap_err();
    let error = refused(SoftDocking { start: Start { distance: -1.0, ..good.start }, ..good });
    let expected = Invalid { parameter: "start.distance", index: None, value: -1.0, must: Must::BePositive };
    assert_eq!(error, expected.into());
    let angles = [0.0, f64::NAN, 0.0];
    assert!(matches!(
        refused(SoftDocking { start: Start { angles, ..good.start }, ..good }),
        Error { failure: Failure::Invalid(Invalid { parameter: "start.angles", index: Some(1), .. }), .. }
    ));
    let params = Params { chaser_mass: -1.0, ..good.params };
    assert!(matches!(refused(SoftDocking { params, ..good }), Error { failure: Failure::Parameters(_), .. }));
    let short = refused(SoftDocking { longest: 20.0, ..good });
    let Error { failure: Failure::NoContact { distance }, at: Some(At::Time(time)) } = short else { panic!("{short}") };
    assert!(time > 20.0 && distance > 20.0, "{short}");
    assert!(Engine { thrust: f64::NAN, exhaust_velocity: 3000.0 }.raise(EARTH_MU, 1.0, [7e6, 8e6]).is_err());
}
