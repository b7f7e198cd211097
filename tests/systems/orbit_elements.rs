//! Orbital elements and anomalies: states come back, known orbits have known elements, Kepler's equation is solved.

use std::f64::consts::{FRAC_PI_2, PI};

use mbs_models::check::Must;
use mbs_models::{Error, Failure};
use mbs_orbit::EARTH_MU;
use mbs_orbit::anomaly;
use mbs_orbit::elements::Elements;
use mbs_orbit::kepler::propagate;
use mbs_orbit::vector::StateVector;
use mbs_tests::random::Random;
use nalgebra::{Rotation3, Vector3};

const STRAIGHT: Failure = Failure::Undetermined("the orbital plane of a motion along a straight line");

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

fn assert_same(found: &StateVector, expected: &StateVector, tolerance: f64, what: &str) {
    for (found, expected) in [(found.position, expected.position), (found.velocity, expected.velocity)] {
        let (found, expected) = (Vector3::from(found), Vector3::from(expected));
        assert!((found - expected).norm() <= tolerance * expected.norm(), "{what}: {found}, not {expected}");
    }
}

/// Written as rotations about the axes z, x, z, which `Elements::axes` does not do.
fn by_rotations(mu: f64, e: &Elements) -> StateVector {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), e.ascending_node)
        * Rotation3::from_axis_angle(&Vector3::x_axis(), e.inclination)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), e.argument_of_periapsis + e.true_anomaly);
    let r = e.semi_latus_rectum / (1.0 + e.eccentricity * e.true_anomaly.cos());
    let transverse = (mu * e.semi_latus_rectum).sqrt() / r;
    let radial = (mu / e.semi_latus_rectum).sqrt() * e.eccentricity * e.true_anomaly.sin();
    StateVector::new((turn * Vector3::new(r, 0.0, 0.0)).into(), (turn * Vector3::new(radial, transverse, 0.0)).into())
}

#[test]
fn elements_and_states_both_ways() {
    let mut random = Random::new(1);
    for k in 0..20_000 {
        let e = [random.uniform(0.0..1.0), 1.0, random.uniform(1.0..5.0), 0.0][k % 4];
        let limit = if e < 1.0 { PI } else { 0.95 * (-1.0 / e).acos() };
        let elements = Elements {
            semi_latus_rectum: random.uniform(0.5..3.0),
            eccentricity: e,
            inclination: [random.uniform(0.01..3.1), 0.0, PI][(k / 4) % 3],
            ascending_node: random.uniform(0.0..2.0 * PI),
            argument_of_periapsis: random.uniform(0.0..2.0 * PI),
            true_anomaly: random.uniform(-limit..limit),
        };
        let state = elements.to_state(2.0).unwrap();
        // As it stands in textbooks, 1 + e cos ν cancels far out.
        let ratio = 1.0 + e * elements.true_anomaly.cos();
        assert_same(&state, &by_rotations(2.0, &elements), 1e-14 + 2.0 * f64::EPSILON / ratio, "rotations");
        let found = Elements::from_state(2.0, &state).unwrap();
        assert_same(&found.to_state(2.0).unwrap(), &state, 1e-13, "there and back");
        close(found.semi_latus_rectum, elements.semi_latus_rectum, 1e-12);
        close(found.eccentricity, e, 1e-12);
        close(found.inclination, elements.inclination, 1e-12);
        let angle = |found: f64, expected: f64, tolerance: f64| {
            close((found - expected + PI).rem_euclid(2.0 * PI), PI, tolerance);
        };
        if e > 0.01 {
            angle(found.true_anomaly, elements.true_anomaly, 1e-12);
        }
        if (k / 4) % 3 == 0 {
            angle(found.ascending_node, elements.ascending_node, 1e-12);
            if e > 0.01 {
                angle(found.argument_of_periapsis, elements.argument_of_periapsis, 1e-11);
            }
        } else {
            assert_eq!(found.ascending_node, 0.0);
        }
        if found.eccentricity < 1e-15 {
            assert_eq!(found.argument_of_periapsis, 0.0);
        }
    }
}

/// Down to straight lines, a state comes back from its elements, or there are none: rounding of e and ν is magnified by
/// `r/p`.
#[test]
fn elements_of_nearly_straight_orbits_are_right_or_refused() {
    let mut random = Random::new(4);
    let mut refused = 0;
    for k in 0..100_000 {
        let less = 10_f64.powf(random.uniform(-17.0..0.0));
        let e = [1.0 - less, 1.0, 1.0 + less, 1.0 + 1e3 * less][k % 4];
        // At a distance r, in and out; where an ellipse does not come so far, at its farthest point.
        let ratio = 10_f64.powf(random.uniform(-18.0..0.0)).max(1.0 - e);
        let (radial, across) = (((e + 1.0 - ratio) * (e - 1.0 + ratio)).max(0.0).sqrt(), ratio);
        let radial = if random.one_in(2) { -radial } else { radial };
        let (r, speed) = (random.uniform(0.5..2.0), (1.0 / ratio).sqrt());
        let axes =
            Rotation3::from_euler_angles(random.uniform(-PI..PI), random.uniform(-PI..PI), random.uniform(-PI..PI));
        let [position, velocity] =
            [Vector3::new(r, 0.0, 0.0), Vector3::new(radial, across, 0.0) * (speed / r.sqrt())].map(|x| axes * x);
        let state = StateVector::new(position.into(), velocity.into());
        match Elements::from_state(1.0, &state) {
            Ok(found) => {
                let tolerance = 1e-14 + 4.0 * f64::EPSILON * (1.0 + e) / ratio;
                assert!(tolerance < 1e-7, "p/r = {ratio:e}, e = {e}");
                assert_same(&found.to_state(1.0).unwrap(), &state, tolerance, &format!("p/r = {ratio:e}, e = {e}"));
                // What the state's own rounding leaves of p: h is a difference of products of r and v.
                let cancelled = radial.hypot(across) / across;
                close(found.semi_latus_rectum / (ratio * r), 1.0, 1e-14 + 8.0 * f64::EPSILON * cancelled);
            }
            Err(Error { failure: Failure::NearlyStraight { semi_latus_rectum, distance }, .. }) => {
                assert!(
                    semi_latus_rectum / distance < 1e-6 * (1.0 + e) && (distance / r - 1.0).abs() < 1e-14,
                    "p/r = {ratio:e}"
                );
                refused += 1;
            }
            Err(error) => {
                assert!(error == STRAIGHT.into() && across < 1e-14 * radial.abs(), "p/r = {ratio:e}: {error}")
            }
        }
    }
    assert!((10_000..90_000).contains(&refused), "{refused}");
}

/// All but the true anomaly stay, and the mean anomaly grows with the time.
#[test]
fn elements_stay_while_the_mean_anomaly_grows() {
    let mut random = Random::new(2);
    for k in 0..5000 {
        let e = [random.uniform(0.05..0.95), 1.0, random.uniform(1.05..4.0)][k % 3];
        let start = Elements {
            semi_latus_rectum: 1.3,
            eccentricity: e,
            inclination: 1.0,
            ascending_node: 2.0,
            argument_of_periapsis: 3.0,
            true_anomaly: random.uniform(-1.5..1.5),
        };
        let time = random.uniform(-4.0..4.0);
        let state = propagate(1.0, &start.to_state(1.0).unwrap(), time).unwrap().state;
        let end = Elements::from_state(1.0, &state).unwrap();
        close(end.semi_latus_rectum, 1.3, 1e-12);
        close(end.eccentricity, e, 1e-12);
        let mean = anomaly::mean_from_true(e, start.true_anomaly).unwrap() + start.mean_motion(1.0) * time;
        let expected = anomaly::true_from_mean(e, mean).unwrap();
        close((end.true_anomaly - expected + PI).rem_euclid(2.0 * PI), PI, 1e-11);
    }
}

#[test]
fn known_orbits() {
    // The station: a circle 400 km up, inclined by 51.6°, over the ascending node.
    let (r, i) = (6_778_137.0, 51.6_f64.to_radians());
    let v = (EARTH_MU / r).sqrt();
    let state = StateVector::new([r, 0.0, 0.0], [0.0, v * i.cos(), v * i.sin()]);
    let station = Elements::from_state(EARTH_MU, &state).unwrap();
    close(station.inclination, i, 1e-15);
    close(station.semi_major_axis(), r, 1e-8);
    close(station.period(EARTH_MU), 5_553.624_271_252_228, 1e-9);
    assert_eq!((station.ascending_node, station.argument_of_periapsis, station.true_anomaly), (0.0, 0.0, 0.0));

    // An ellipse from its farthest point, in the plane z = 0 and backwards: ω counts in the direction of the motion.
    let (a, e) = (1.0_f64, 0.6_f64);
    let speed = ((1.0 - e) / (1.0 + e) / a).sqrt();
    let far = Elements::from_state(1.0, &StateVector::new([0.0, a * (1.0 + e), 0.0], [speed, 0.0, 0.0])).unwrap();
    close(far.inclination, PI, 0.0);
    close(far.true_anomaly.abs(), PI, 1e-15);
    close(far.argument_of_periapsis, FRAC_PI_2, 1e-14);
    close(far.periapsis(), 0.4, 1e-15);
    close(far.apoapsis(), 1.6, 1e-14);

    let parabola = Elements::from_state(1.0, &StateVector::new([2.0, 0.0, 0.0], [0.0, 1.0, 0.0])).unwrap();
    assert_eq!((parabola.eccentricity, parabola.semi_latus_rectum), (1.0, 4.0));
    assert_eq!((parabola.semi_major_axis(), parabola.apoapsis()), (f64::INFINITY, f64::INFINITY));
    assert_eq!(parabola.period(1.0), f64::INFINITY);
    let hyperbola = Elements::from_state(1.0, &StateVector::new([1.0, 0.0, 0.0], [0.0, 2.0, 0.0])).unwrap();
    assert_eq!(hyperbola.eccentricity, 3.0);
    close(hyperbola.semi_major_axis(), -0.5, 1e-15);
}

#[test]
fn keplers_equation_is_solved() {
    let mut random = Random::new(3);
    for k in 0..100_000 {
        let e = match k % 4 {
            0 => random.uniform(0.0..1.0),
            1 => 1.0 + random.uniform(0.0..5.0),
            2 => 1.0 - 10_f64.powf(random.uniform(-12.0..-1.0)),
            _ => 1.0 + 10_f64.powf(random.uniform(-12.0..-1.0)),
        };
        let mean = random.uniform(-100.0..100.0);
        let middle = anomaly::eccentric_from_mean(e, mean).unwrap();
        let back = anomaly::mean_from_eccentric(e, middle).unwrap();
        close(back, mean, 1e-14 * (1.0 + mean.abs()));
        // As it stands in textbooks; it cancels near the parabola.
        let plain = if e < 1.0 { middle - e * middle.sin() } else { e * middle.sinh() - middle };
        close(plain, mean, 1e-13 * (1.0 + mean.abs()) * if e < 1.0 { 1.0 } else { middle.abs().max(1.0) });
        let true_anomaly = anomaly::true_from_eccentric(e, middle).unwrap();
        let r = if e < 1.0 { 1.0 - e * middle.cos() } else { e * middle.cosh() - 1.0 };
        let x = if e < 1.0 { middle.cos() - e } else { e - middle.cosh() };
        close(true_anomaly.cos(), x / r, 1e-9);
        if e < 1.0 {
            close(anomaly::eccentric_from_true(e, true_anomaly).unwrap(), middle, 1e-7);
            assert!((true_anomaly - middle).abs() < PI, "whole turns are kept");
        }
    }
    for d in [-3.0, -0.1, 0.0, 0.5, 2.0] {
        let mean = anomaly::mean_from_eccentric(1.0, d).unwrap();
        close(mean, d + d * d * d / 3.0, 1e-15);
        close(anomaly::eccentric_from_mean(1.0, mean).unwrap(), d, 1e-14);
        close(anomaly::true_from_eccentric(1.0, d).unwrap(), 2.0 * f64::atan(d), 1e-15);
        close(anomaly::eccentric_from_true(1.0, 2.0 * f64::atan(d)).unwrap(), d, 1e-14);
    }
}

#[test]
fn bad_input_is_refused_with_its_value() {
    let good = StateVector::new([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for mu in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(Elements::from_state(mu, &good), Err(Must::BePositive.broken_by("mu", mu).into()));
    }
    let mut bad = good;
    bad.velocity[1] = f64::INFINITY;
    let expected = Must::BeFinite.broken_by("velocity", f64::INFINITY).of(1).into();
    assert_eq!(Elements::from_state(1.0, &bad), Err(expected));
    for straight in [[0.0; 3], [3.0, 0.0, 0.0]] {
        let state = StateVector::new([1.0, 0.0, 0.0], straight);
        assert_eq!(Elements::from_state(1.0, &state), Err(STRAIGHT.into()));
    }
    assert_eq!(Elements::from_state(1.0, &StateVector::default()), Err(STRAIGHT.into()));
    let elements = Elements::from_state(1.0, &good).unwrap();
    let beyond = Elements { eccentricity: 2.0, true_anomaly: 2.2, ..elements };
    let limit = 2.0 * 3_f64.sqrt().atan();
    let expected = Must::BeLessThan(limit).broken_by("|true_anomaly|", 2.2);
    assert_eq!(beyond.to_state(1.0), Err(expected.into()));
    // Far out the anomaly is that of the asymptote, and says nothing of the place.
    let far = Elements::from_state(1.0, &StateVector::new([1e17, 0.0, 0.0], [1.5e-8, 1e-17, 0.0])).unwrap_err();
    assert_eq!(far, Failure::NearlyStraight { semi_latus_rectum: 1.0, distance: 1e17 }.into());
    let expected = "at the distance 100000000000000000 m an orbit of the semi-latus rectum 1 m is too nearly a straight line: \
                    its elements would not give the state back";
    assert_eq!(far.to_string(), expected);
    let negative = Elements { semi_latus_rectum: -1.0, ..elements };
    assert_eq!(negative.to_state(1.0), Err(Must::BePositive.broken_by("semi_latus_rectum", -1.0).into()));
    let negative = Elements { eccentricity: -0.1, ..elements }.to_state(1.0).unwrap_err();
    assert_eq!(negative, Must::NotBeNegative.broken_by("eccentricity", -0.1).into());
    assert_eq!(negative.to_string(), "eccentricity must not be negative, it is -0.1");
    let infinite = Elements { eccentricity: f64::INFINITY, ..elements }.to_state(1.0);
    assert_eq!(infinite, Err(Must::NotBeNegative.broken_by("eccentricity", f64::INFINITY).into()));
    let nan = Elements { inclination: f64::NAN, ..elements };
    assert!(nan.to_state(1.0).unwrap_err().invalid().is_some_and(|error| error.parameter == "inclination"));

    assert_eq!(
        anomaly::eccentric_from_mean(-0.1, 1.0),
        Err(Must::NotBeNegative.broken_by("eccentricity", -0.1).into())
    );
    for (e, message) in [
        (f64::INFINITY, "eccentricity must be finite and not negative, it is inf"),
        (f64::NAN, "eccentricity must be finite and not negative, it is NaN"),
    ] {
        assert_eq!(anomaly::true_from_eccentric(e, 1.0).unwrap_err().to_string(), message);
    }
    assert_eq!(
        anomaly::true_from_mean(0.5, f64::INFINITY),
        Err(Must::BeFinite.broken_by("anomaly", f64::INFINITY).into())
    );
    for true_anomaly in [2.2_f64, -2.2, PI, 7.0] {
        let expected = Must::BeLessThan(limit).broken_by("|true_anomaly|", true_anomaly.abs());
        assert_eq!(anomaly::mean_from_true(2.0, true_anomaly), Err(expected.into()));
    }
}
