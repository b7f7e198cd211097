//! Kepler propagation: a million states forward and back, a thousand against 80 digits, straight lines, bad input.

use std::f64::consts::PI;

use mbs_models::check::Must;
use mbs_models::{Error, Failure};
use mbs_orbit::EARTH_MU;
use mbs_orbit::kepler::propagate;
use mbs_orbit::transition::{Transition, state_transition};
use mbs_orbit::vector::StateVector;
use mbs_tests::random::Random;
use nalgebra::{Matrix6, UnitQuaternion, Vector3};

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (Vector3::from(*a) - Vector3::from(*b)).norm()
}

/// A state of eccentricity e and |a| = 1 about μ = 1, in random axes.
fn random_state(random: &mut Random, e: f64) -> StateVector {
    let (cos, sin, versine) = if e < 1.0 {
        let anomaly = random.uniform(-PI..PI);
        (anomaly.cos(), anomaly.sin(), 2.0 * (0.5 * anomaly).sin().powi(2))
    } else {
        let anomaly = random.uniform(-5.0..5.0);
        (anomaly.cosh(), anomaly.sinh(), 2.0 * (0.5 * anomaly).sinh().powi(2))
    };
    let q = (1.0 - e).abs();
    let (r, b) = (q + e * versine, (q * (1.0 + e)).sqrt());
    let angles: [f64; 3] = [PI, 0.5 * PI, PI].map(|bound| random.uniform(-bound..bound));
    let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
    let position = turn * Vector3::new(q - versine, b * sin, 0.0);
    let velocity = turn * Vector3::new(-sin / r, b * cos / r, 0.0);
    StateVector::new(position.into(), velocity.into())
}

/// The greatest change of position and of velocity that one unit in the last place of one component causes.
fn effect_of_rounding(start: &StateVector, transition: &Transition) -> [f64; 2] {
    let x = start.to_array();
    let mut greatest = [0.0; 2];
    for j in 0..6 {
        let unit = x[j].abs().next_up() - x[j].abs();
        for (half, greatest) in greatest.iter_mut().enumerate() {
            let column: f64 = (3 * half..3 * half + 3).map(|i| transition.matrix[i][j].powi(2)).sum();
            *greatest = f64::max(*greatest, unit * column.sqrt());
        }
    }
    greatest
}

/// Errors of the way forward and back, in effects of one unit in the last place of the state between; and the
/// iterations.
fn round_trip(state: &StateVector, time: f64) -> (f64, u32) {
    let there = propagate(1.0, state, time).unwrap();
    let back = propagate(1.0, &there.state, -time).unwrap();
    let effect = effect_of_rounding(&there.state, &state_transition(1.0, &there.state, -time).unwrap());
    let position = distance(&back.state.position, &state.position) / effect[0];
    let velocity = distance(&back.state.velocity, &state.velocity) / effect[1];
    (position.max(velocity), there.iterations.max(back.iterations))
}

/// Random states, mean anomaly changed by up to 100 rad.
fn check_round_trips(seed: u64, count: usize, mut eccentricity: impl FnMut(&mut Random) -> f64) {
    let mut random = Random::new(seed);
    for _ in 0..count {
        let e = eccentricity(&mut random);
        let state = random_state(&mut random, e);
        let time = random.uniform(-100.0..100.0);
        let (error, iterations) = round_trip(&state, time);
        assert!(error <= 50.0 && iterations <= 12, "{error}, {iterations} iterations: e = {e}, {time}, {state:?}");
    }
}

/// The greatest error is 28 units, half of the states are below 1.4; no search takes more than 2 iterations.
#[test]
fn a_million_states_forward_and_back() {
    check_round_trips(1, 1_000_000, |random| random.uniform(0.0..5.0));
}

#[test]
fn near_circles_and_near_parabolas_forward_and_back() {
    check_round_trips(2, 100_000, |random| 10_f64.powf(random.uniform(-17.0..0.0)));
    check_round_trips(3, 100_000, |random| 1.0 - 10_f64.powf(random.uniform(-13.0..0.0)));
    check_round_trips(4, 100_000, |random| 1.0 + 10_f64.powf(random.uniform(-13.0..0.0)));
    check_round_trips(5, 100_000, |random| 10_f64.powf(random.uniform(0.0..6.0)));
}

/// `data/orbit_kepler.json`: by the classical equations, near circles and parabolas and parabolas to the last bit among
/// them.
#[test]
fn a_thousand_states_against_80_digits() {
    let data: serde_json::Value = serde_json::from_str(include_str!("../data/orbit_kepler.json")).unwrap();
    let rows = data["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1000);
    let mut parabolas = 0;
    for row in rows {
        let row: Vec<f64> = row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let (mu, time) = (row[0], row[1]);
        let state = |from: usize| StateVector::from_array(std::array::from_fn(|i| row[from + i]));
        let (before, after) = (state(2), state(8));
        let transition = state_transition(mu, &before, time).unwrap();
        let found = propagate(mu, &before, time).unwrap().state;
        assert_eq!(transition.state, found);
        let effect = effect_of_rounding(&before, &transition);
        let error = [distance(&found.position, &after.position), distance(&found.velocity, &after.velocity)];
        assert!((0..2).all(|k| error[k] <= 25.0 * effect[k]), "{error:?}, one unit causes {effect:?}: {row:?}");
        let [r, v] = [before.position, before.velocity].map(Vector3::from);
        parabolas += usize::from(v.norm_squared() * r.norm() == 2.0 * mu);
    }
    assert_eq!(parabolas, 40);
}

/// `orbit.two_body_dimensionless` of the reference values: μ = 1, a = 1, e = 0.6, from the nearest point.
#[test]
fn the_dimensionless_orbit_of_the_reference() {
    let start = StateVector::new([0.4, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let expected = [
        (1.0, [-0.6289481768266242, 0.7996647309700393, -0.9825156909388113, -0.02276317009743042]),
        (2.0, [-1.3398590471389715, 0.5382095296765307, -0.4659288895440953, -0.40991821689643543]),
        (3.0, [-1.596083002870164, 0.0707385106686625, -0.055345757399723826, -0.49877413775984764]),
        (10.0, [-1.5350235919098136, -0.28366840649978087, 0.22715073207749834, -0.47918775820321957]),
        (5.0, [-0.8837707793862566, -0.7671137155927865, 0.8193821223981331, -0.19398778461076005]),
    ];
    for (time, [x, y, u, v]) in expected {
        let found = propagate(1.0, &start, time).unwrap().state;
        assert!(distance(&found.position, &[x, y, 0.0]) <= 1e-13, "{time}: {found:?}");
        assert!(distance(&found.velocity, &[u, v, 0.0]) <= 1e-13, "{time}: {found:?}");
    }
}

#[test]
fn the_transition_matrix_is_the_derivative_and_symplectic() {
    let mut random = Random::new(11);
    let unit = Matrix6::from_fn(|i, j| f64::from(i8::from(j == i + 3) - i8::from(i == j + 3)));
    for k in 0..2000 {
        let e = if k % 4 == 0 { 1.0 + random.uniform(-1e-6..1e-6) } else { random.uniform(0.0..3.0) };
        let state = random_state(&mut random, e);
        let scale = Vector3::from(state.position).norm().min(1.0);
        let time = random.uniform(-20.0..20.0);
        let transition = state_transition(1.0, &state, time).unwrap();
        let matrix = Matrix6::from_fn(|i, j| transition.matrix[i][j]);
        let size = matrix.amax().max(1.0);
        let defect = (matrix.transpose() * unit * matrix - unit).amax();
        assert!(defect <= 1e-12 * size * size, "{defect} of {size}²: e = {e}, {time}, {state:?}");

        // Central differences of fourth order, in steps small beside the nearest distance.
        let step = 1e-4 * scale * (1.0 - e).abs().clamp(1e-6, 1.0);
        let differences = Matrix6::from_columns(&std::array::from_fn::<_, 6, _>(|j| {
            let at = |by: f64| {
                let mut x = state.to_array();
                x[j] += by * step;
                let x = propagate(1.0, &StateVector::from_array(x), time).unwrap().state.to_array();
                nalgebra::Vector6::from(x)
            };
            (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step)
        }));
        if e < 0.8 || (1.3..2.5).contains(&e) {
            let error = (matrix - differences).amax() / size;
            assert!(error <= 1e-5, "{error}: e = {e}, {time}, {state:?}");
        }
    }
}

#[test]
fn no_time_changes_nothing_and_times_add_up() {
    let mut random = Random::new(12);
    for _ in 0..1000 {
        let e = random.uniform(0.0..3.0);
        let state = random_state(&mut random, e);
        assert_eq!(propagate(1.0, &state, 0.0).unwrap().state, state);
        let [s, t] = [random.uniform(-5.0..5.0), random.uniform(-5.0..5.0)];
        let once = propagate(1.0, &state, s + t).unwrap().state;
        let half = propagate(1.0, &state, s).unwrap().state;
        let twice = propagate(1.0, &half, t).unwrap().state;
        let [a, b] = [
            effect_of_rounding(&state, &state_transition(1.0, &state, s + t).unwrap()),
            effect_of_rounding(&half, &state_transition(1.0, &half, t).unwrap()),
        ];
        assert!(distance(&once.position, &twice.position) <= 50.0 * (a[0] + b[0]), "e = {e}, {s}, {t}: {state:?}");
    }
}

/// Let go at rest at the distance r, a body falls for `π/√8 · √(r³/μ)`; on the way its distance is a cycloid's.
#[test]
fn straight_lines_end_in_the_centre() {
    let (mu, r) = (EARTH_MU, 1e7);
    let fall = PI / 8.0_f64.sqrt() * (r * r * r / mu).sqrt();
    let axis = Vector3::new(2.0, -3.0, 6.0) / 7.0;
    let rest = StateVector::new((r * axis).into(), [0.0; 3]);
    for eta in [0.1_f64, 1.0, 2.0, 3.0] {
        // r(η) = r cos²(η/2), t(η) = √(r³/8μ) (η + sin η)
        let time = (r * r * r / (8.0 * mu)).sqrt() * (eta + eta.sin());
        let found = propagate(mu, &rest, time).unwrap().state;
        let distance_left = r * (0.5 * eta).cos().powi(2);
        assert!(distance(&found.position, &(distance_left * axis).into()) <= 1e-7, "{eta}: {found:?}");
        let speed = -(2.0 * mu * (1.0 / distance_left - 1.0 / r)).sqrt();
        assert!(distance(&found.velocity, &(speed * axis).into()) <= 1e-7 * speed.abs(), "{eta}: {found:?}");
        // And back up.
        let up = propagate(mu, &found, -time).unwrap().state;
        assert!(distance(&up.position, &rest.position) <= 1e-5, "{eta}: {up:?}");
    }
    for (time, expected) in [(1.001 * fall, fall), (10.0 * fall, fall), (-1.001 * fall, -fall)] {
        let Err(Error { failure: Failure::Falls { time: found }, .. }) = propagate(mu, &rest, time) else {
            panic!("{time}")
        };
        assert!((found - expected).abs() <= 1e-12 * fall, "{found}, not {expected}");
    }

    // Upwards on an ellipse, a parabola and a hyperbola: it came out of the centre; the ellipse falls back, the others
    // do not.
    let escape = (2.0 * mu / r).sqrt();
    for part in [0.5, 1.0, 2.0] {
        let up = StateVector::new((r * axis).into(), (part * escape * axis).into());
        let Err(Error { failure: Failure::Falls { time: born }, .. }) = propagate(mu, &up, -1e6) else {
            panic!("{part}")
        };
        assert!(born < 0.0);
        let near = propagate(mu, &up, 0.999 * born).unwrap().state;
        assert!(Vector3::from(near.position).norm() < 0.02 * r);
        match propagate(mu, &up, 1e7) {
            Err(Error { failure: Failure::Falls { time }, .. }) => {
                let a = r / (2.0 - 2.0 * part * part);
                let period = 2.0 * PI * (a * a * a / mu).sqrt();
                assert!(part < 1.0 && (time - born - period).abs() <= 1e-9 * period, "{part}: {time}");
            }
            Ok(far) => assert!(part >= 1.0 && Vector3::from(far.state.position).norm() > 10.0 * r),
            Err(other) => panic!("{part}: {other}"),
        }
    }
}

#[test]
fn bad_input_is_refused_with_its_value() {
    let state = StateVector::new([7e6, 0.0, 0.0], [0.0, 7500.0, 0.0]);
    for mu in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(propagate(mu, &state, 1.0), Err(Must::BePositive.broken_by("μ", mu).into()));
    }
    assert!(propagate(f64::NAN, &state, 1.0).unwrap_err().invalid().is_some_and(|error| error.value.is_nan()));
    for time in [f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(propagate(EARTH_MU, &state, time), Err(Must::BeFinite.broken_by("time", time).into()));
        assert_eq!(state_transition(EARTH_MU, &state, time), Err(Must::BeFinite.broken_by("time", time).into()));
    }
    for component in 0..6 {
        let mut x = state.to_array();
        x[component] = f64::INFINITY;
        let found = propagate(EARTH_MU, &StateVector::from_array(x), 1.0);
        let of = if component < 3 { "position" } else { "velocity" };
        assert_eq!(found, Err(Must::BeFinite.broken_by(of, f64::INFINITY).of(component % 3).into()));
        x[component] = f64::NAN;
        let found = propagate(EARTH_MU, &StateVector::from_array(x), 1.0);
        let named = found.unwrap_err().invalid().unwrap();
        assert!(named.parameter == of && named.index == Some(component % 3) && named.value.is_nan());
    }
    let centre = StateVector::new([0.0; 3], [1.0, 0.0, 0.0]);
    assert_eq!(propagate(1.0, &centre, 1.0), Err(Must::BePositive.broken_by("distance from the centre", 0.0).into()));
    for (scale, speed) in [(1e200, 1.0), (1.0, 1e200), (1e-200, 1.0)] {
        let extreme = StateVector::new([scale, 0.0, 0.0], [0.0, speed, 0.0]);
        match propagate(1.0, &extreme, 1.0) {
            Ok(found) => assert!(found.state.is_finite()),
            Err(error) => assert_eq!(error, Failure::OutOfRange.into()),
        }
    }
    // Revolutions enough that nothing is known of the last one; an ellipse so large that a revolution is infinite.
    assert_eq!(propagate(EARTH_MU, &state, 1e25), Err(Failure::OutOfRange.into()));
    assert!(propagate(EARTH_MU, &state, 1e15).is_ok());
    let nearly_straight = StateVector::new([1.0, 0.0, 0.0], [0.0, 2.0_f64.sqrt().next_down(), 0.0]);
    assert!(propagate(1.0, &nearly_straight, 1e6).unwrap().state.is_finite());
    assert_eq!(propagate(-1.0, &state, 1.0).unwrap_err().to_string(), "μ must be positive, it is -1");
}
