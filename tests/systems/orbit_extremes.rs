//! Zeros, infinities, NaN, the largest and the smallest numbers: a function of `mbs_orbit` returns an error or
//! finite numbers.

use mbs_orbit::elements::Elements;
use mbs_orbit::lambert::{Branch, Route, arc};
use mbs_orbit::libration::{Modes, Point, points};
use mbs_orbit::lvlh::{Frame, relative_motion};
use mbs_orbit::mission::glideslope::Glideslope;
use mbs_orbit::station::{Station, to_cylindrical};
use mbs_orbit::vector::StateVector;
use mbs_orbit::{anomaly, clohessy_wiltshire, kepler, transition, yamanaka_ankersen};
use mbs_tests::random::Random;

const EXTREMES: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e308,
    -1e308,
    1e-308,
    5e-324,
    1e154,
    1e-154,
    1e-20,
];

/// One number of three is extreme.
fn number(random: &mut Random) -> f64 {
    if random.bits().is_multiple_of(3) {
        return EXTREMES[(random.bits() % EXTREMES.len() as u64) as usize];
    }
    let size = 10_f64.powf(random.uniform(-3.0..3.0));
    if random.one_in(2) { size } else { -size }
}

fn vector(random: &mut Random) -> [f64; 3] {
    std::array::from_fn(|_| number(random))
}

/// Counts what was finite; what was not panics with the input.
struct Results(u32);

impl Results {
    fn finite<'a>(&mut self, name: &str, numbers: impl IntoIterator<Item = &'a f64>, input: &dyn std::fmt::Debug) {
        let numbers: Vec<f64> = numbers.into_iter().copied().collect();
        assert!(numbers.iter().all(|x| x.is_finite()), "{name}: {numbers:?} from {input:?}");
        self.0 += 1;
    }
}

#[test]
fn results_are_finite_or_errors() {
    let mut random = Random::new(77);
    let mut results = Results(0);
    for _ in 0..40_000 {
        let [mu, e, a, time]: [f64; 4] = std::array::from_fn(|_| number(&mut random));
        let state = StateVector::new(vector(&mut random), vector(&mut random));
        let other = StateVector::new(vector(&mut random), vector(&mut random));
        let input = (mu, e, a, time, state, other);
        if let Ok(found) = kepler::propagate(mu, &state, time) {
            results.finite("propagate", &found.state.to_array(), &input);
        }
        if let Ok(found) = transition::state_transition(mu, &state, time) {
            results.finite("transition", found.matrix.iter().flatten(), &input);
        }
        if let Ok(found) = Elements::from_state(mu, &state) {
            results.finite("elements", &[found.semi_latus_rectum, found.eccentricity, found.true_anomaly], &input);
            assert!(found.periapsis() > 0.0 && !found.period(mu).is_nan() && !found.semi_major_axis().is_nan());
        }
        let elements = Elements {
            semi_latus_rectum: a,
            eccentricity: e,
            inclination: number(&mut random),
            ascending_node: 1.0,
            argument_of_periapsis: 2.0,
            true_anomaly: time,
        };
        if let Ok(found) = elements.to_state(mu) {
            results.finite("state", &found.to_array(), &(elements, mu));
        }
        for (name, found) in [
            ("eccentric_from_true", anomaly::eccentric_from_true(e, a)),
            ("true_from_eccentric", anomaly::true_from_eccentric(e, a)),
            ("mean_from_eccentric", anomaly::mean_from_eccentric(e, a)),
            ("eccentric_from_mean", anomaly::eccentric_from_mean(e, a)),
        ] {
            if let Ok(found) = found {
                results.finite(name, &[found], &input);
            }
        }
        if let Ok(found) = clohessy_wiltshire::propagate(a, &state, time) {
            results.finite("Clohessy and Wiltshire", &found.to_array(), &input);
        }
        for (name, found) in [
            ("circular transfer", clohessy_wiltshire::transfer(a, &state.position, &state.velocity, time).ok()),
            ("elliptic transfer", yamanaka_ankersen::transfer(mu, &state, &other.position, &other.velocity, time).ok()),
        ] {
            if let Some(found) = found {
                results.finite(name, found.departure.iter().chain(&found.arrival), &input);
            }
        }
        if let Ok(frame) = Frame::of(&state) {
            results.finite("frame", frame.axes().iter().flatten().chain([&frame.rate()]), &input);
        }
        if let Ok(found) = relative_motion(mu, &state, &other, time) {
            results.finite("relative motion", &found.relative.to_array(), &input);
        }
        let branch = if random.one_in(2) { Branch::LargerAxis } else { Branch::SmallerAxis };
        let revolutions = [0, 1, 1000, u32::MAX][(random.bits() % 4) as usize];
        let route = Route::prograde().with_revolutions(revolutions, branch);
        if let Ok(found) = arc(mu, &state.position, &state.velocity, time, &route) {
            results.finite("arc", found.departure.iter().chain(&found.arrival), &input);
        }
        if let Ok(station) = Station::from_periapsis(mu, a, e) {
            assert!(station.rate() > 0.0 && station.rate().is_finite() && station.period() > 0.0, "{station:?}");
            if let Ok(found) = station.signals(time) {
                results.finite("signals", found.iter().flatten(), &input);
            }
        }
        if let Ok(found) = to_cylindrical(&state.into()) {
            results.finite("cylindrical", found.q.iter().chain(&found.qd), &input);
        }
        if let Ok(found) = points(a) {
            results.finite("points", found.iter().flatten(), &input);
        }
        if let Ok(found) = Modes::about(a, Point::L1) {
            results.finite("modes", found.plane.iter().flatten().chain([&found.growth()]), &input);
        }
        if let Ok(slope) = Glideslope::new(a, e, time) {
            results.finite("slope", &[slope.rate(), slope.duration()], &input);
        }
    }
    assert!(results.0 > 100_000, "{}", results.0);
}

/// A million revolutions are as exact as the period: rounding of the start moves the end by `3π n ε a/q`.
#[test]
fn a_million_revolutions() {
    for e in [0.0, 0.3, 0.9] {
        let start = StateVector::new([1.0, 0.0, 0.0], [0.0, f64::sqrt(1.0 + e), 0.0]);
        let axis = 1.0 / (1.0 - e);
        let period = 2.0 * std::f64::consts::PI * axis * axis.sqrt();
        for revolutions in [1e3, 1e6, 1e9] {
            let far = kepler::propagate(1.0, &start, revolutions * period + 0.3).unwrap().state;
            let near =
                kepler::propagate(1.0, &start, (revolutions * period + 0.3) - revolutions * period).unwrap().state;
            let error = (0..3).map(|i| (far.position[i] - near.position[i]).powi(2)).sum::<f64>().sqrt();
            let limit = 20.0 * revolutions * period * f64::EPSILON * axis;
            assert!(error < limit, "e = {e}, {revolutions}: {error}, {limit}");
        }
    }
}
