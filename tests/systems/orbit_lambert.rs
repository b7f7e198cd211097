//! Lambert's problem: arcs flown by Kepler propagation reach their place.

use std::f64::consts::PI;

use mbs_models::check::{Invalid, Must};
use mbs_models::{Error, Failure};
use mbs_orbit::kepler::propagate;
use mbs_orbit::lambert::{Branch, ConicArc, Route, arc};
use mbs_orbit::transition::state_transition;
use mbs_orbit::vector::StateVector;
use mbs_tests::random::Random;
use nalgebra::Vector3;

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (Vector3::from(*a) - Vector3::from(*b)).norm()
}

fn random_vector(random: &mut Random, length: f64) -> [f64; 3] {
    let direction = Vector3::from_fn(|_, _| random.uniform(-1.0..1.0));
    (direction.normalize() * length).into()
}

/// How far an arc ends from its place, relative to it; and what one unit in the last place of place and velocity causes
/// there.
fn miss(from: &[f64; 3], to: &[f64; 3], time: f64, found: &ConicArc) -> (f64, f64) {
    let start = StateVector::new(*from, found.departure);
    let there = state_transition(1.0, &start, time).unwrap();
    let size = Vector3::from(*to).norm();
    let x = start.to_array();
    let effect = (0..6).map(|j| {
        let unit = x[j].abs().next_up() - x[j].abs();
        unit * (0..3).map(|i| there.matrix[i][j].powi(2)).sum::<f64>().sqrt()
    });
    (distance(&there.state.position, to) / size, effect.fold(0.0, f64::max) / size)
}

/// Arcs of random places, times and revolutions that exist, and whether they end where they shall.
fn check_random_arcs(seed: u64, count: usize, sizes: f64, times: [f64; 2], good: impl Fn(f64, f64) -> bool) {
    let mut random = Random::new(seed);
    let (mut flown, mut refused) = ([0; 3], 0);
    while flown.iter().sum::<usize>() < count {
        let from = random_vector(&mut random, 1.0);
        let size = 10_f64.powf(random.uniform(-sizes..sizes));
        let to = random_vector(&mut random, size);
        let time = 10_f64.powf(random.uniform(times[0]..times[1]));
        let route = if random.one_in(2) { Route::prograde() } else { Route::retrograde() };
        let kind = (random.bits() % 3) as usize;
        let route = if kind == 0 {
            route
        } else {
            let branch = if kind == 1 { Branch::LargerAxis } else { Branch::SmallerAxis };
            route.with_revolutions(1 + (random.bits() % 5) as u32, branch)
        };
        match arc(1.0, &from, &to, time, &route) {
            Ok(found) => {
                flown[kind] += 1;
                let (error, effect) = miss(&from, &to, time, &found);
                assert!(good(error, effect), "{error}, one unit causes {effect}: {from:?} {to:?} {time} {route:?}");
                assert!(found.iterations <= 8, "{} iterations: {from:?} {to:?} {time} {route:?}", found.iterations);
                let momentum = Vector3::from(from).cross(&Vector3::from(found.departure));
                assert!(momentum.dot(&Vector3::from(route.pole)) > 0.0);
            }
            Err(Error { failure: Failure::Invalid(Invalid { value, must: Must::BeAtLeast(least), .. }), .. }) => {
                refused += 1;
                assert_eq!(value, time);
                assert!(least > time && route.revolutions > 0);
                if refused % 8 != 0 {
                    continue;
                }
                // Given a little more than that, both conics are there, and nearly the same where it is very little.
                for more in [1e-2, 1e-6, 1e-10] {
                    let enough = (1.0 + more) * least;
                    let [low, high] = [Branch::SmallerAxis, Branch::LargerAxis]
                        .map(|branch| arc(1.0, &from, &to, enough, &Route { branch, ..route }).unwrap());
                    assert!(distance(&low.departure, &high.departure) > 1e-3 * more.sqrt());
                    for found in [low, high] {
                        let (error, effect) = miss(&from, &to, enough, &found);
                        assert!(error <= 50.0 * effect, "{error}, {effect}: {from:?} {to:?} {enough} {route:?}");
                    }
                }
            }
            Err(error) => panic!("{error}: {from:?} {to:?} {time} {route:?}"),
        }
    }
    assert!(flown.iter().all(|&n| n > count / 20) && refused > 0, "{flown:?} {refused}");
}

#[test]
fn a_hundred_thousand_arcs_reach_their_place() {
    check_random_arcs(1, 100_000, 0.4, [-0.5, 1.3], |error, _| error <= 1e-12);
}

/// Long arcs to places near the centre: what one unit in the last place of the departure causes is more than 1e-12.
#[test]
fn extreme_arcs_miss_by_roundings_of_their_departure() {
    check_random_arcs(2, 30_000, 2.0, [-2.0, 4.0], |error, effect| error <= 50.0 * effect);
}

#[test]
fn both_ends_and_both_ways() {
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let (from, to) = (random_vector(&mut random, 1.0), random_vector(&mut random, 1.7));
        let time = random.uniform(0.5..5.0);
        let route = Route::prograde();
        let there = arc(1.0, &from, &to, time, &route).unwrap();
        let end = propagate(1.0, &StateVector::new(from, there.departure), time).unwrap().state;
        assert!(distance(&end.velocity, &there.arrival) < 1e-10);
        // Time reversed: the same arc, backwards.
        let back = arc(1.0, &to, &from, time, &Route::retrograde()).unwrap();
        let reversed = back.departure.map(|v| -v);
        assert!(distance(&reversed, &there.arrival) < 1e-10, "{back:?} {there:?}");
        // The pole only says which way round.
        let pole = Vector3::from(from).cross(&Vector3::from(there.departure));
        assert_eq!(arc(1.0, &from, &to, time, &route.about(pole.into())).unwrap(), there);
    }
}

/// With revolutions there are two conics: of the same time, one with a larger major axis.
#[test]
fn the_branches_are_told_apart_by_the_axis() {
    let (from, to) = ([1.0, 0.0, 0.0], [0.2, 1.1, 0.3]);
    let axis = |found: &ConicArc| 1.0 / (2.0 - Vector3::from(found.departure).norm_squared());
    for revolutions in 1..20 {
        let time = 2.0 * PI * f64::from(revolutions) * 1.5;
        let [smaller, larger] = [Branch::SmallerAxis, Branch::LargerAxis].map(|branch| {
            arc(1.0, &from, &to, time, &Route::prograde().with_revolutions(revolutions, branch)).unwrap()
        });
        assert!(axis(&larger) > axis(&smaller) && axis(&smaller) > 0.0, "{smaller:?} {larger:?}");
    }
}

/// A parabola, by Euler's equation: `6 √μ t = (r₁ + r₂ + c)^{3/2} − (r₁ + r₂ − c)^{3/2}` for less than half a turn.
#[test]
fn the_parabola_in_between() {
    let (from, to) = ([1.0_f64, 0.0, 0.0], [-0.3_f64, 1.2, 0.4]);
    let [r, s] = [from, to].map(|x| Vector3::from(x).norm());
    let chord = distance(&from, &to);
    let time = ((r + s + chord).powf(1.5) - (r + s - chord).powf(1.5)) / 6.0;
    for part in [1.0 - 1e-9, 1.0, 1.0 + 1e-9, 0.999, 1.001] {
        let found = arc(1.0, &from, &to, part * time, &Route::prograde()).unwrap();
        let energy = Vector3::from(found.departure).norm_squared() / 2.0 - 1.0 / r;
        assert!(energy.abs() < 1e-14 + 2.0 * (1.0 - part).abs() && (part - 1.0) * energy <= 1e-15, "{part}: {energy}");
        let (error, effect) = miss(&from, &to, part * time, &found);
        assert!(error <= 30.0 * effect, "{part}: {error}");
    }
}

#[test]
fn bad_input_is_refused() {
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let route = Route::prograde();
    assert_eq!(arc(-1.0, &x, &y, 1.0, &route), Err(Must::BePositive.broken_by("μ", -1.0).into()));
    for time in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(arc(1.0, &x, &y, time, &route), Err(Must::BePositive.broken_by("time", time).into()));
    }
    assert!(arc(1.0, &x, &y, f64::NAN, &route).unwrap_err().invalid().is_some_and(|error| error.value.is_nan()));
    let named = |found: Result<ConicArc, Error>| found.unwrap_err().invalid().map(|error| error.parameter);
    assert_eq!(named(arc(1.0, &[f64::NAN, 0.0, 0.0], &y, 1.0, &route)), Some("from"));
    assert_eq!(named(arc(1.0, &x, &y, 1.0, &route.about([f64::INFINITY; 3]))), Some("pole"));
    let at_centre = Must::BePositive.broken_by("distance from the centre", 0.0).of(1);
    assert_eq!(arc(1.0, &x, &[0.0; 3], 1.0, &route), Err(at_centre.into()));
    for multiple in [-2.0, 1.0, 3.0] {
        let open = Failure::Undetermined("the plane through places in line with the centre");
        assert_eq!(arc(1.0, &x, &[multiple, 0.0, 0.0], 1.0, &route), Err(open.into()));
    }
    let open = Failure::Undetermined("the way round a pole in the plane of the motion");
    assert_eq!(arc(1.0, &x, &[0.0, 0.0, 1.0], 1.0, &route), Err(open.into()));
    let error = arc(1.0, &x, &y, 3.0, &route.with_revolutions(2, Branch::LargerAxis)).unwrap_err();
    let Some(Invalid { value: 3.0, must: Must::BeAtLeast(least), .. }) = error.invalid() else { panic!("{error}") };
    assert!(least > 12.0, "{error}");
}

/// The long way and whole revolutions between places that are nearly one, down to where they are in line with the
/// centre: the chord says all about the direction, and the time about the size of the ellipse.
#[test]
fn places_that_are_nearly_one() {
    let mut random = Random::new(4);
    let mut flown = 0;
    for _ in 0..20_000 {
        let from = random_vector(&mut random, 1.0);
        let size = 10_f64.powf(random.uniform(-13.0..-1.0));
        let step = random_vector(&mut random, size);
        let to = std::array::from_fn(|i| from[i] + step[i]);
        let time = 10_f64.powf(random.uniform(0.5..2.0));
        let route = if random.one_in(2) { Route::prograde() } else { Route::retrograde() };
        let route = route.with_revolutions((random.bits() % 3) as u32, Branch::LargerAxis);
        let found = match arc(1.0, &from, &to, time, &route) {
            Ok(found) => found,
            Err(Error { failure: Failure::Undetermined(_), .. }) => continue,
            Err(Error { failure: Failure::Invalid(Invalid { must: Must::BeAtLeast(_), .. }), .. }) => continue,
            Err(error) => panic!("{error}: {from:?} {to:?} {time} {route:?}"),
        };
        // Nearly straight ones pass the centre so near that rounding of the departure decides how.
        let momentum = Vector3::from(from).cross(&Vector3::from(found.departure)).norm();
        if momentum < 0.1 {
            continue;
        }
        flown += 1;
        let (error, effect) = miss(&from, &to, time, &found);
        assert!(error <= 50.0 * effect, "{error}, one unit causes {effect}: {from:?} {to:?} {time} {route:?}");
    }
    assert!(flown > 5000, "{flown}");
}

/// The short way in a time that is long for it: thrown up, a body falls back beside where it was, nearly along a line.
#[test]
fn thrown_up_and_back() {
    let from = [0.39079016242358267, -0.6629435651643104, 0.6385834936483903];
    let to = [0.39079016242357606, -0.6629435651643077, 0.6385834936483911];
    let r = Vector3::from(from).norm();
    for time in [1e-3, 0.120_976_507_419_622_52, 1.0, 2.5] {
        for route in [Route::prograde(), Route::retrograde()] {
            let found = arc(1.0, &from, &to, time, &route).unwrap();
            let speed = Vector3::from(found.departure).dot(&Vector3::from(from)) / r;
            let short = Vector3::from(from).cross(&Vector3::from(to)).dot(&Vector3::from(route.pole)) > 0.0;
            if short {
                // Up for half of the time: (η + sin η)/(1 + cos η)^{3/2}, cos²(η/2) = r/r_top, v² = 2/r − 2/r_top.
                let top = 1.0 / (1.0 / r - 0.5 * speed * speed);
                let eta = 2.0 * (r / top).sqrt().acos();
                let flown = 2.0 * (top * top * top / 8.0).sqrt() * (eta + eta.sin());
                assert!((flown / time - 1.0).abs() < 1e-7 && speed > 0.0, "{flown}, not {time}");
            }
        }
    }
}
