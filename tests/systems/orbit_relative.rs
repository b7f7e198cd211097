//! Motion about a station: exact, and by the two linear models, against the reference values and each other.

use std::f64::consts::PI;

use mbs_models::check::{Invalid, Must};
use mbs_models::{Error, Failure};
use mbs_orbit::EARTH_MU;
use mbs_orbit::clohessy_wiltshire::{self, ACROSS, IN_PLANE};
use mbs_orbit::elements::Elements;
use mbs_orbit::kepler::propagate;
use mbs_orbit::lvlh::{Frame, relative_motion};
use mbs_orbit::transition;
use mbs_orbit::vector::StateVector;
use mbs_orbit::yamanaka_ankersen;
use mbs_tests::random::Random;
use nalgebra::{Matrix6, Vector3, Vector6};
use serde_json::Value;

/// What `orbit_relative.py` computes; in km.
fn reference() -> Value {
    serde_json::from_str(include_str!("../data/orbit_relative.json")).unwrap()
}

const KM_MU: f64 = EARTH_MU * 1e-9;

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (Vector3::from(*a) - Vector3::from(*b)).norm()
}

fn matrix(rows: &[[f64; 6]; 6]) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| rows[i][j])
}

/// Velocities in km/s times a thousand seconds are as large as positions.
fn alike(m: Matrix6<f64>) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| m[(i, j)] * if i < 3 { 1.0 } else { 1e3 } / if j < 3 { 1.0 } else { 1e3 })
}

/// Of an orbit in any plane \[km\].
fn station(a: f64, e: f64, true_anomaly: f64) -> StateVector {
    let elements = Elements {
        semi_latus_rectum: a * (1.0 - e * e),
        eccentricity: e,
        inclination: 0.9,
        ascending_node: 4.0,
        argument_of_periapsis: 1.0,
        true_anomaly,
    };
    elements.to_state(KM_MU).unwrap()
}

#[test]
fn exact_motions_are_those_of_the_reference() {
    let reference = reference();
    let cases = [("relative_circular", station(6778.137, 0.0, 0.3)), ("relative_elliptic", station(7500.0, 0.1, 0.0))];
    let mut checked = 0;
    for (key, station) in cases {
        for (name, case) in reference[key].as_object().unwrap() {
            let start = StateVector::from_array(numbers(&case["initial_lvlh_km_km_s"]));
            let near = Vector3::from(start.position).norm() < 1.0;
            for sample in case["samples"].as_array().unwrap() {
                let time = sample["t_s"].as_f64().unwrap();
                let found = relative_motion(KM_MU, &station, &start, time).unwrap().relative;
                let error = distance(&found.position, &numbers(&sample["position_km"]));
                // 1e-9 m for 3 m, 1e-9 km for 1000 km.
                assert!(error <= if near { 1e-12 } else { 1e-9 }, "{name} {time}: {error} km");
                let error = distance(&found.velocity, &numbers(&sample["velocity_km_s"]));
                assert!(error <= if near { 1e-15 } else { 1e-11 }, "{name} {time}: {error} km/s");
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 38);
}

#[test]
fn linear_motions_are_those_of_the_reference() {
    let reference = reference();
    let n = (KM_MU / 6778.137_f64.powi(3)).sqrt();
    for (name, case) in reference["relative_circular"].as_object().unwrap() {
        let start = StateVector::from_array(numbers(&case["initial_lvlh_km_km_s"]));
        for sample in case["samples"].as_array().unwrap() {
            let found = clohessy_wiltshire::propagate(n, &start, sample["t_s"].as_f64().unwrap()).unwrap();
            let expected = numbers(&sample["hcw_position_km"]);
            assert!(distance(&found.position, &expected) <= 1e-13 * 80_000.0, "{name}");
        }
    }
    let case = &reference["relative_elliptic"]["near"];
    let start = Vector6::from(numbers::<6>(&case["initial_lvlh_km_km_s"]));
    for sample in case["samples"].as_array().unwrap() {
        let time = sample["t_s"].as_f64().unwrap();
        let phi = yamanaka_ankersen::state_transition(KM_MU, &station(7500.0, 0.1, 0.0), time).unwrap();
        let found = matrix(&phi) * start;
        let expected = numbers(&sample["tschauner_hempel_YA_position_km"]);
        let error = distance(&[found[0], found[1], found[2]], &expected);
        assert!(error <= 1e-15, "{time}: {error} km");
    }
}

/// The matrix of Kepler's motion, turned into the station's frame at both ends, is another way to the same.
#[test]
fn yamanaka_ankersen_is_the_derivative_of_the_exact_motion() {
    let mut random = Random::new(1);
    for _ in 0..2000 {
        let e = random.uniform(0.0..0.95);
        let start = station(7500.0 / (1.0 - e), e, random.uniform(-PI..PI));
        let time = random.uniform(-20_000.0..20_000.0);
        let kepler = transition::state_transition(KM_MU, &start, time).unwrap();
        let (before, after) = (Frame::of(&start).unwrap(), Frame::of(&kepler.state).unwrap());
        let turned = Matrix6::from_columns(&std::array::from_fn::<_, 6, _>(|j| {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let out = before.turned_out(&StateVector::from_array(unit));
            let carried = matrix(&kepler.matrix) * Vector6::from(out.to_array());
            Vector6::from(after.turned_in(&StateVector::from_array(carried.into())).to_array())
        }));
        let found = matrix(&yamanaka_ankersen::state_transition(KM_MU, &start, time).unwrap());
        let (found, turned) = (alike(found), alike(turned));
        let error = (found - turned).amax() / turned.amax();
        assert!(error <= 1e-11, "{error}: e = {e}, {time} s");
    }
}

#[test]
fn yamanaka_ankersen_on_a_circle_is_clohessy_wiltshire() {
    let n = (KM_MU / 7000.0_f64.powi(3)).sqrt();
    for e in [0.0, 1e-15, 1e-8, 1e-4] {
        for time in [-9000.0, 10.0, 1000.0, 5828.0, 20_000.0] {
            let found = yamanaka_ankersen::state_transition(KM_MU, &station(7000.0, e, 2.0), time).unwrap();
            let (found, expected) =
                (alike(matrix(&found)), alike(matrix(&clohessy_wiltshire::state_transition(n, time).unwrap())));
            let error = (found - expected).amax() / expected.amax();
            assert!(error <= 1e-12 + 10.0 * e, "{error}: e = {e}, {time} s");
            assert!(e < 1e-10 || error > 1e-3 * e, "{error}: e = {e} is no circle");
        }
    }
}

#[test]
fn transitions_compose() {
    let mut random = Random::new(2);
    for _ in 0..1000 {
        let [s, t]: [f64; 2] = [random.uniform(-8000.0..8000.0), random.uniform(-8000.0..8000.0)];
        let e = random.uniform(0.0..0.8);
        let start = station(9000.0, e, random.uniform(-PI..PI));
        let between = propagate(KM_MU, &start, s).unwrap().state;
        let of =
            |from: &StateVector, time: f64| matrix(&yamanaka_ankersen::state_transition(KM_MU, from, time).unwrap());
        let (once, first, second) = (of(&start, s + t), of(&start, s), of(&between, t));
        let size = second.amax() * first.amax();
        assert!((second * first - once).amax() <= 1e-12 * size, "e = {e}, {s}, {t}");
        let n = 1.1e-3;
        let of = |time: f64| matrix(&clohessy_wiltshire::state_transition(n, time).unwrap());
        let size = of(t).amax() * of(s).amax();
        assert!((of(t) * of(s) - of(s + t)).amax() <= 1e-13 * size);
    }
}

/// Hill's equations themselves, by differences of the matrix.
#[test]
fn clohessy_wiltshire_obeys_hills_equations() {
    let n = 1.13e-3;
    let mut system = Matrix6::zeros();
    (0..3).for_each(|i| system[(i, i + 3)] = 1.0);
    (system[(3, 0)], system[(3, 4)], system[(4, 3)], system[(5, 2)]) = (3.0 * n * n, 2.0 * n, -2.0 * n, -n * n);
    for time in [0.0, 1.0, 500.0, 4000.0, 12_000.0] {
        let of = |time: f64| matrix(&clohessy_wiltshire::state_transition(n, time).unwrap());
        let h = 1.0;
        let rate = (8.0 * (of(time + h) - of(time - h)) - (of(time + 2.0 * h) - of(time - 2.0 * h))) / (12.0 * h);
        let expected = system * of(time);
        for i in 0..6 {
            for j in 0..6 {
                let scale = n.powi(i32::from(i >= 3) + 1 - i32::from(j >= 3)) * (1.0 + n * time);
                assert!((rate[(i, j)] - expected[(i, j)]).abs() <= 1e-9 * scale, "{time} ({i}, {j})");
            }
        }
    }
}

/// What is neglected is of second order: a quarter for half the distance.
#[test]
fn the_linear_motion_errs_by_squares() {
    let station = station(6778.137, 0.0, 0.0);
    let n = (KM_MU / 6778.137_f64.powi(3)).sqrt();
    let period = 2.0 * PI / n;
    let error = |x: f64| {
        let start = StateVector::new([x, 0.0, 0.0], [0.0; 3]);
        let exact = relative_motion(KM_MU, &station, &start, period).unwrap().relative;
        distance(&exact.position, &clohessy_wiltshire::propagate(n, &start, period).unwrap().position)
    };
    // At 3 m, after one revolution, that of the reference.
    let sample = &reference()["relative_circular"]["near_radial"]["samples"][2];
    assert!((sample["t_s"].as_f64().unwrap() - period).abs() < 1e-6);
    let expected = distance(&numbers(&sample["position_km"]), &numbers(&sample["hcw_position_km"]));
    assert!((error(0.003) - expected).abs() < 1e-12, "{}, not {expected}", error(0.003));
    for x in [1e-4, 1e-3, 1e-2, 1e-1] {
        assert!((error(2.0 * x) / error(x) - 4.0).abs() < 1e-3 + 3.0 * x, "{x}: {}", error(2.0 * x) / error(x));
    }
}

#[test]
fn frames_turn_there_and_back() {
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let e = random.uniform(0.0..0.9);
        let station = station(7500.0, e, random.uniform(-PI..PI));
        let frame = Frame::of(&station).unwrap();
        let relative = StateVector::from_array(random.array(-100.0..100.0));
        let back = frame.to_relative(&frame.to_inertial(&relative));
        assert!(distance(&back.position, &relative.position) < 1e-11);
        let back = frame.turned_in(&frame.turned_out(&relative));
        assert!(distance(&back.position, &relative.position) < 1e-12);
        assert!(distance(&back.velocity, &relative.velocity) < 1e-12);
        // At rest in the frame is going round with it.
        let [x, y, z] = frame.axes().map(Vector3::from);
        assert!((x.cross(&y) - z).norm() < 1e-15);
        let rest = frame.turned_out(&StateVector::new([1.0, 2.0, 3.0], [0.0; 3]));
        let expected = (frame.rate() * z).cross(&Vector3::from(rest.position));
        assert!((Vector3::from(rest.velocity) - expected).norm() < 1e-14 * frame.rate());
        let [r, v] = [station.position, station.velocity].map(Vector3::from);
        assert!((frame.rate() * r.norm_squared() / r.cross(&v).norm() - 1.0).abs() < 1e-15);
    }
}

/// The spread of two motions as `relative_motion` takes it, in which 0.01 is the border of its two ways.
fn spread(station: &StateVector, difference: &StateVector, time: f64) -> f64 {
    let elements = Elements::from_state(KM_MU, station).unwrap();
    let (q, e) = (elements.periapsis(), elements.eccentricity);
    let speed = (KM_MU * (1.0 + e) / q).sqrt();
    let tau = time.abs() * speed / q;
    let drift = (1.0 / (1.0 - e).abs()).max(1.0).min(1.0 + tau);
    let [r, v] = [difference.position, difference.velocity].map(|x| Vector3::from(x).norm());
    (r / q + v / speed) * (1.0 + tau * drift)
}

/// What the difference of two propagated states says.
fn plain(station: &StateVector, relative: &StateVector, time: f64) -> StateVector {
    let end = propagate(KM_MU, station, time).unwrap().state;
    let other = propagate(KM_MU, &Frame::of(station).unwrap().to_inertial(relative), time).unwrap().state;
    Frame::of(&end).unwrap().to_relative(&other)
}

/// On both sides of the border the two ways agree, at short times and after a hundred revolutions, whatever the
/// separation is made of; on the near side the quadrature is taken, on the far one the difference.
#[test]
fn near_and_far_motions_agree_where_they_meet() {
    let mut random = Random::new(6);
    for e in [0.0, 0.1, 0.5, 0.9, 0.99, 1.01, 2.0, 20.0] {
        let q = 7000.0;
        let elements = Elements {
            semi_latus_rectum: q * (1.0 + e),
            eccentricity: e,
            inclination: 0.9,
            ascending_node: 4.0,
            argument_of_periapsis: 1.0,
            true_anomaly: -1.4,
        };
        let station = elements.to_state(KM_MU).unwrap();
        let frame = Frame::of(&station).unwrap();
        let revolution = 2.0 * PI * (q * q * q / KM_MU).sqrt();
        for revolutions in [-100.0, -1.3, 0.05, 1.0, 100.0, 1000.0] {
            // In units of the revolution of a circle at the nearest distance.
            let time = revolutions * revolution;
            for kind in 0..6 {
                // δr alone, δv alone, both.
                let direction = |random: &mut Random| {
                    let (longitude, z) = (random.uniform(-PI..PI), random.uniform(-1.0..1.0));
                    let across = f64::sqrt(1.0 - z * z);
                    Vector3::new(across * longitude.cos(), across * longitude.sin(), z)
                };
                let position = direction(&mut random) * if kind % 3 == 1 { 0.0 } else { 1.0 };
                let velocity = direction(&mut random) * if kind % 3 == 0 { 0.0 } else { 1e-3 };
                let unit = StateVector::new(position.into(), velocity.into());
                let size = spread(&station, &unit, time);
                for (part, is_near) in [(0.0099, true), (0.0101, false)] {
                    let scaled = |x: [f64; 3]| x.map(|x| x * part / size);
                    let difference = StateVector::new(scaled(unit.position), scaled(unit.velocity));
                    let relative = frame.turned_in(&difference);
                    let found = relative_motion(KM_MU, &station, &relative, time).unwrap();
                    let plain = plain(&station, &relative, time);
                    assert_eq!(found.relative == plain, !is_near, "e = {e}, {revolutions}, {kind}, {part}");
                    // What one unit in the last place of either start causes.
                    let phi = transition::state_transition(KM_MU, &station, time).unwrap().matrix;
                    let x = station.to_array();
                    let rounding: f64 = (0..6)
                        .map(|j| (0..3).map(|i| phi[i][j].powi(2)).sum::<f64>().sqrt() * (x[j].abs() * f64::EPSILON))
                        .sum();
                    let end = Vector3::from(found.station.position).norm();
                    let error = distance(&found.relative.position, &plain.position);
                    assert!(
                        error <= 20.0 * (rounding + end * f64::EPSILON),
                        "e = {e}, {revolutions}, {kind}, {part}: {error} km, {rounding} km"
                    );

                    // In two halves the quadrature errs 256 times less: here its remainder alone is left.
                    let half =
                        StateVector::new(difference.position.map(|x| 0.5 * x), difference.velocity.map(|x| 0.5 * x));
                    let middle = StateVector::new(
                        std::array::from_fn(|i| station.position[i] + half.position[i]),
                        std::array::from_fn(|i| station.velocity[i] + half.velocity[i]),
                    );
                    let out = |start: &StateVector, difference: &StateVector| {
                        let seen = Frame::of(start).unwrap().turned_in(difference);
                        let motion = relative_motion(KM_MU, start, &seen, time).unwrap();
                        Vector3::from(Frame::of(&motion.station).unwrap().turned_out(&motion.relative).position)
                    };
                    if is_near {
                        let whole = out(&station, &difference);
                        let halves = out(&station, &half) + out(&middle, &half);
                        // The transition matrix knows the station to its rounding.
                        let error = (whole - halves).norm() / whole.norm() / (1.0 + rounding / end / f64::EPSILON);
                        // Far out on fast hyperbolas large terms cancel in the matrix; that is no matter of the
                        // quadrature.
                        let limit = if e < 1.5 { 1e-13 } else { 2e-11 };
                        assert!(error <= limit, "e = {e}, {revolutions}, {kind}: {error}");
                    }
                }
            }
        }
    }
}

/// A radial displacement of 35 km alone, at the same inertial velocity, changes the period: after a hundred revolutions
/// the body is somewhere else on another ellipse. Against that ellipse by its elements.
#[test]
fn a_displacement_alone_drifts_round_the_orbit() {
    let (r, height) = (7000.0, 35.0);
    let speed = f64::sqrt(KM_MU / r);
    let station = StateVector::new([r, 0.0, 0.0], [0.0, speed, 0.0]);
    let frame = Frame::of(&station).unwrap();
    let relative = frame.turned_in(&StateVector::new([height, 0.0, 0.0], [0.0; 3]));
    let period = 2.0 * PI * r / speed;
    for (height, revolutions) in [(35.0, 30.0), (35.0, 100.0), (5.0, 1000.0)] {
        let relative = StateVector::new(
            relative.position.map(|x| x * height / 35.0),
            relative.velocity.map(|x| x * height / 35.0),
        );
        let time = revolutions * period;
        let found = relative_motion(KM_MU, &station, &relative, time).unwrap();
        let inertial = Frame::of(&found.station).unwrap().to_inertial(&found.relative).position;
        // Let go at the nearest point of an ellipse.
        let q = r + height;
        let e = q * speed * speed / KM_MU - 1.0;
        let a = q / (1.0 - e);
        let mean = (time * f64::sqrt(KM_MU / (a * a * a))) % (2.0 * PI);
        let mut anomaly = mean;
        (0..20).for_each(|_| anomaly -= (anomaly - e * anomaly.sin() - mean) / (1.0 - e * anomaly.cos()));
        let expected = [a * (anomaly.cos() - e), a * (1.0 - e * e).sqrt() * anomaly.sin(), 0.0];
        let error = distance(&inertial, &expected);
        assert!(error < 1e-7, "{height} km, {revolutions} revolutions: {error} km");
        let away = distance(&found.relative.position, &[0.0; 3]);
        assert!(away > 1000.0, "{away}");
    }
}

#[test]
fn velocities_that_lead_to_a_place() {
    let n = 1.13e-3;
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let (from, to): ([f64; 3], [f64; 3]) = (random.array(-1e4..1e4), random.array(-1e4..1e4));
        let time = random.uniform(10.0..2500.0);
        let found = clohessy_wiltshire::transfer(n, &from, &to, time).unwrap();
        let end = clohessy_wiltshire::propagate(n, &StateVector::new(from, found.departure), time).unwrap();
        assert!(distance(&end.position, &to) <= 1e-9, "{time}: {end:?}");
        assert_eq!(end.velocity, found.arrival);
    }
    let (from, to) = ([-1000.0, -5000.0, 0.0], [0.0, -1000.0, 0.0]);
    let period = 2.0 * PI / n;
    for turns in [1.0, 2.0] {
        let time = turns * period;
        assert_eq!(
            clohessy_wiltshire::transfer(n, &from, &to, time),
            Err(Failure::Undetermined(IN_PLANE).at_time(time))
        );
    }
    // 8 (1 − cos) = 3 nt sin at 1.406 revolutions.
    let mut nt: f64 = 8.83;
    for _ in 0..50 {
        let f = 8.0 * (1.0 - nt.cos()) - 3.0 * nt * nt.sin();
        nt -= f / (5.0 * nt.sin() - 3.0 * nt * nt.cos());
    }
    assert!((nt / (2.0 * PI) - 1.406).abs() < 1e-3);
    let time = nt / n;
    assert_eq!(clohessy_wiltshire::transfer(n, &from, &to, time), Err(Failure::Undetermined(IN_PLANE).at_time(time)));
    let time = 0.5 * period;
    // In the plane half a revolution leads there: x = 7 x₀ + 4 v/n and y = y₀ − 6π x₀ − 4 u/n − 3π v/n.
    let [u, v, w] = clohessy_wiltshire::transfer(n, &from, &to, time).unwrap().departure;
    assert!((v - 0.25 * n * 7000.0).abs() < 1e-12 && w == 0.0, "{v}");
    assert!((u - 0.25 * n * (-5000.0 + 6000.0 * PI - 3.0 * PI * v / n + 1000.0)).abs() < 1e-12, "{u}");
    let across = [0.0, -1000.0, 50.0];
    assert_eq!(clohessy_wiltshire::transfer(n, &from, &across, time), Err(Failure::Undetermined(ACROSS).at_time(time)));
    for (time, must) in [(0.0, Must::BePositive), (-5.0, Must::BePositive), (f64::INFINITY, Must::BeFinite)] {
        let found = clohessy_wiltshire::transfer(n, &from, &to, time);
        assert_eq!(found, Err(must.broken_by("time", time).into()));
    }
    let nan = [f64::NAN, 0.0, 0.0];
    let refused = clohessy_wiltshire::transfer(n, &nan, &to, 1.0).unwrap_err();
    assert_eq!(refused.to_string(), "from[0] must be finite, it is NaN");
}

#[test]
fn mean_motions_that_are_none_are_refused() {
    let start = StateVector::new([1.0, 2.0, 3.0], [0.0; 3]);
    let refused = |n: f64, time: f64| {
        let error = clohessy_wiltshire::state_transition(n, time).unwrap_err();
        let others = [
            clohessy_wiltshire::propagate(n, &start, time).unwrap_err(),
            clohessy_wiltshire::transfer(n, &start.position, &[0.0; 3], time).unwrap_err(),
        ];
        // NaN is not equal to itself.
        others.iter().for_each(|other| assert_eq!(other.to_string(), error.to_string()));
        error
    };
    for n in [0.0, -0.0, -1e-3, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(refused(n, 10.0), Must::BePositive.broken_by("mean motion", n).into());
    }
    assert!(refused(f64::NAN, 10.0).invalid().is_some_and(|error| error.value.is_nan()));
    assert_eq!(refused(1e-3, f64::INFINITY), Must::BeFinite.broken_by("time", f64::INFINITY).into());
    assert!(refused(1e-3, f64::NAN).invalid().is_some_and(|error| error.value.is_nan()));
    for (n, time) in [(1e200, 1e200), (1e-300, 1e308)] {
        assert_eq!(refused(n, time), Failure::OutOfRange.into());
    }
    let nan = StateVector::new([0.0; 3], [f64::NAN, 0.0, 0.0]);
    let refused = clohessy_wiltshire::propagate(1e-3, &nan, 1.0).unwrap_err();
    assert_eq!(refused.to_string(), "velocity[0] must be finite, it is NaN");
    let huge = StateVector::new([1e308; 3], [1e308; 3]);
    assert_eq!(clohessy_wiltshire::propagate(1e-3, &huge, 1e4), Err(Failure::OutOfRange.into()));
}

#[test]
fn velocities_that_lead_to_a_place_on_an_ellipse() {
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let start = station(8000.0, random.uniform(0.0..0.6), random.uniform(-PI..PI));
        let (from, to): ([f64; 3], [f64; 3]) = (random.array(-10.0..10.0), random.array(-10.0..10.0));
        let time = random.uniform(100.0..2000.0);
        let found = yamanaka_ankersen::transfer(KM_MU, &start, &from, &to, time).unwrap();
        let phi = matrix(&yamanaka_ankersen::state_transition(KM_MU, &start, time).unwrap());
        let end = phi * Vector6::from(StateVector::new(from, found.departure).to_array());
        assert!(
            distance(&[end[0], end[1], end[2]], &to) < 1e-9
                && distance(&[end[3], end[4], end[5]], &found.arrival) < 1e-12
        );
    }
    // On a circle as by Clohessy and Wiltshire, whose whole revolution is singular, too.
    let start = station(7000.0, 0.0, 1.0);
    let n = Frame::of(&start).unwrap().rate();
    let (from, to) = ([-1.0, -5.0, 0.3], [0.0, -1.0, 0.0]);
    let elliptic = yamanaka_ankersen::transfer(KM_MU, &start, &from, &to, 1000.0).unwrap();
    let circular = clohessy_wiltshire::transfer(n, &from, &to, 1000.0).unwrap();
    assert!(distance(&elliptic.departure, &circular.departure) < 1e-12);
    for time in [2.0 * PI / n, PI / n] {
        let found = yamanaka_ankersen::transfer(KM_MU, &start, &from, &to, time);
        assert_eq!(found, Err(Failure::Undetermined("the velocity to a place").at_time(time)));
    }
}

#[test]
fn bad_input_is_refused() {
    let fast = StateVector::new([7000.0, 0.0, 0.0], [0.0, 12.0, 0.0]);
    let error = yamanaka_ankersen::state_transition(KM_MU, &fast, 10.0).unwrap_err();
    let Some(Invalid { value, must: Must::BeLessThan(1.0), .. }) = error.invalid() else { panic!("{error}") };
    assert!((value - (7000.0 * 144.0 / KM_MU - 1.0)).abs() < 1e-12);
    let straight = StateVector::new([7000.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let open = Error::from(Failure::Undetermined("the frame of a station that moves along a straight line"));
    assert_eq!(Frame::of(&straight), Err(open));
    assert_eq!(yamanaka_ankersen::state_transition(KM_MU, &straight, 1.0), Err(open));
    let relative = StateVector::default();
    assert_eq!(relative_motion(KM_MU, &straight, &relative, 1.0), Err(open));
    let good = station(7000.0, 0.0, 0.0);
    let found = relative_motion(KM_MU, &good, &relative, f64::INFINITY);
    assert_eq!(found, Err(Must::BeFinite.broken_by("time", f64::INFINITY).into()));
    let nan = StateVector::new([f64::NAN, 0.0, 0.0], [0.0; 3]);
    let refused = relative_motion(KM_MU, &good, &nan, 1.0).unwrap_err();
    assert!(refused.invalid().is_some_and(|error| error.parameter == "position"), "{refused}");
}
