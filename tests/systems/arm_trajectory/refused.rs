//! What no trajectory is made of: each earns its own error, with the number at fault.

use mbs_arm::trajectory::sign_change::sign_changes;
use mbs_arm::trajectory::{
    ACCELERATION, INTERVALS, JointState, Knot, Motion, POSITION, RateLimits, StraightPath, VELOCITY, quartic, quintic,
    quintic_between, through, trapezoidal, trapezoidal_within, two_piece_quartic,
};
use mbs_models::check::Must;
use mbs_models::{Error, Failure};

const START: [f64; 2] = [0.0, 1.0];
const STOP: [f64; 2] = [1.0, 1.0];
const REST: [f64; 2] = [0.0; 2];

/// The error that every polynomial gives for these data.
fn polynomials(start: [f64; 2], velocity: [f64; 2], stop: [f64; 2], duration: f64) -> Error {
    let errors = [
        quartic(start, velocity, stop, duration).unwrap_err(),
        two_piece_quartic(start, velocity, stop, duration).unwrap_err(),
        quintic(start, velocity, stop, duration).unwrap_err(),
    ];
    assert_eq!(format!("{:?}", errors[0]), format!("{:?}", errors[1]));
    assert_eq!(format!("{:?}", errors[0]), format!("{:?}", errors[2]));
    errors[0]
}

#[test]
fn durations() {
    for duration in [0.0, -0.0, -1.0, f64::INFINITY] {
        assert_eq!(polynomials(START, REST, STOP, duration), Must::BePositive.broken_by("duration", duration).into());
        assert_eq!(
            trapezoidal(START, STOP, duration, 0.1).unwrap_err(),
            Must::BePositive.broken_by("duration", duration).into()
        );
    }
    let error = polynomials(START, REST, STOP, f64::NAN);
    assert!(error.invalid().is_some_and(|wrong| wrong.value.is_nan()), "{error}");
    let [from, to] = [START, STOP].map(JointState::at_rest);
    assert_eq!(quintic_between(&from, &to, 0.0).unwrap_err(), Must::BePositive.broken_by("duration", 0.0).into());
}

#[test]
fn equal_postures() {
    let nothing = Error::from(Failure::NoMotion);
    assert_eq!(polynomials(START, REST, START, 1.0), nothing);
    assert_eq!(trapezoidal(START, START, 1.0, 0.5).unwrap_err(), nothing);
    let rest = JointState::at_rest(START);
    assert_eq!(quintic_between(&rest, &rest, 1.0).unwrap_err(), nothing);
    let knots = [Knot { time: 1.0, q: START }, Knot { time: 2.0, q: START }];
    assert_eq!(through(&rest, &knots, REST).unwrap_err(), nothing);
    assert_eq!(StraightPath::new(START, START).unwrap_err(), nothing);
    let limits = RateLimits { speed: [1.0; 2], acceleration: [1.0; 2] };
    assert_eq!(trapezoidal_within(START, START, &limits).unwrap_err(), nothing);
    // There and back again is a motion; so is one of a single joint.
    assert!(quartic(START, [0.1, 0.0], START, 1.0).is_ok());
    assert!(quartic(START, REST, STOP, 1.0).is_ok());
}

#[test]
fn numbers_that_are_not_finite() {
    let infinite = f64::INFINITY;
    // NaN is not equal to itself.
    let named = |error: Error| {
        let found = error.invalid().expect("a number");
        assert!(!found.value.is_finite() && found.must == Must::BeFinite, "{error}");
        (found.parameter, found.index.expect("of several"))
    };
    assert_eq!(named(polynomials([0.0, f64::NAN], REST, STOP, 1.0)), (POSITION, 1));
    assert_eq!(named(polynomials(START, [infinite, 0.0], STOP, 1.0)), (VELOCITY, 0));
    assert_eq!(named(polynomials(START, REST, [0.0, -infinite], 1.0)), (POSITION, 1));
    assert_eq!(named(StraightPath::new(START, [f64::NAN, 0.0]).unwrap_err()), (POSITION, 0));
    let start = JointState { qdd: [0.0, f64::NAN], ..JointState::at_rest(START) };
    let stop = JointState::at_rest(STOP);
    assert_eq!(named(quintic_between(&start, &stop, 1.0).unwrap_err()), (ACCELERATION, 1));
    let knots = [Knot { time: 1.0, q: [f64::NAN; 2] }];
    assert_eq!(named(through(&stop, &knots, REST).unwrap_err()), (POSITION, 0));
}

#[test]
fn numbers_that_overflow() {
    let named = |error: Error| {
        let found = error.invalid().expect("a number");
        (found.parameter, found.index.expect("of several"))
    };
    assert_eq!(named(polynomials([-1e308, 0.0], REST, [1e308, 0.0], 1.0)), (POSITION, 0));
    assert_eq!(named(polynomials(START, REST, STOP, 1e-308)), (VELOCITY, 0));
    assert_eq!(named(polynomials(START, REST, STOP, 1e-160)), (ACCELERATION, 0));
    assert_eq!(named(trapezoidal(START, STOP, 1.0, 1e-320).unwrap_err()), (ACCELERATION, 0));
    let knots = [Knot { time: 1e-320, q: STOP }, Knot { time: 1.0, q: START }];
    named(through(&JointState::at_rest(START), &knots, REST).unwrap_err());
}

#[test]
fn times_out_of_order() {
    let start = JointState::at_rest(START);
    let knots = |times: [f64; 3]| times.map(|time| Knot { time, q: [2.0, 2.0] });
    assert!(through(&start, &knots([1.0, 2.0, 3.0]), REST).is_ok());
    for (times, index, before) in [([1.0, 3.0, 2.0], 2, 3.0), ([1.0, 1.0, 2.0], 1, 1.0), ([0.0, 1.0, 2.0], 0, 0.0)] {
        let expected = Must::BeMoreThan(before).broken_by("time of knot", times[index]).of(index);
        assert_eq!(through(&start, &knots(times), REST).unwrap_err(), expected.into());
    }
    let error = through(&start, &knots([1.0, f64::NAN, 2.0]), REST).unwrap_err();
    assert!(error.invalid().is_some_and(|wrong| wrong.index == Some(1)), "{error}");
    let error = through(&start, &knots([1.0, 2.0, f64::INFINITY]), REST).unwrap_err();
    assert!(error.invalid().is_some_and(|wrong| wrong.index == Some(2)), "{error}");
}

#[test]
fn limits_that_are_none() {
    for value in [0.0, -1.0] {
        let limits = RateLimits { speed: [1.0, value], acceleration: [1.0; 2] };
        let error = Must::BeMoreThan(0.0).broken_by("largest speed", value).of(1).into();
        assert_eq!(trapezoidal_within(START, STOP, &limits).unwrap_err(), error);
        assert_eq!(quartic(START, REST, STOP, 1.0).unwrap().check_rates(&limits).unwrap_err(), error);
    }
    let limits = RateLimits { speed: [1.0; 2], acceleration: [f64::INFINITY; 2] };
    let error = Must::BeFinite.broken_by("largest acceleration", f64::INFINITY).of(0);
    assert_eq!(trapezoidal_within(START, STOP, &limits).unwrap_err(), error.into());
    let motion = quartic(START, REST, STOP, 1.0).unwrap();
    let error = Must::BeAtLeast(2.0).broken_by("largest angle of joint", -2.0).of(0);
    assert_eq!(motion.check_ranges(&[[2.0, -2.0]; 2]).unwrap_err(), error.into());
    assert!(motion.check_ranges(&[[f64::NAN, 2.0]; 2]).is_err());
}

#[test]
fn acceleration_times() {
    for time in [0.0, -1.0, 0.6] {
        let must = if time > 0.0 { Must::BeAtMost(0.5) } else { Must::BePositive };
        let expected = must.broken_by("time of acceleration", time);
        assert_eq!(trapezoidal(START, STOP, 1.0, time).unwrap_err(), expected.into());
    }
    assert!(trapezoidal(START, STOP, 1.0, f64::NAN).is_err());
    assert!(trapezoidal(START, STOP, 1.0, 0.5).is_ok());
}

#[test]
fn times_outside_the_motion() {
    let motion = quartic(START, [0.5, 0.0], STOP, 2.0).unwrap();
    for time in [-1e-9, 2.0000001, f64::INFINITY] {
        let outside = Must::BeWithin([0.0, 2.0]).broken_by("time", time);
        assert_eq!(motion.at(time).unwrap_err(), outside.into());
    }
    assert!(motion.at(f64::NAN).is_err());
    // A controller goes on asking.
    assert_eq!(motion.held_at(3.0).unwrap(), JointState::at_rest(STOP));
    assert_eq!(motion.held_at(-3.0).unwrap(), JointState::at_rest(START));
    assert_eq!(motion.held_at(1.0), motion.at(1.0));
    assert!(motion.held_at(f64::NAN).is_err());
}

#[test]
fn functions_without_a_value() {
    let motion = quartic(START, REST, STOP, 2.0).unwrap();
    let none = Must::BePositive.broken_by(INTERVALS, 0.0);
    assert_eq!(sign_changes(&motion, |q| q[0], 0).err(), Some(none.into()));
    let mut found = sign_changes(&motion, |q| 1.0 / q[0], 10).unwrap();
    assert_eq!(found.next(), Some(Err(Failure::NotFinite("the function").at_time(0.0))));
    assert_eq!(found.next(), None);
    // A zero at the end, or one that is only touched, is no change of sign.
    let touched = sign_changes(&motion, |q| (q[0] - 0.5) * (q[0] - 0.5), 1000).unwrap();
    assert_eq!(touched.count(), 0);
    assert_eq!(sign_changes(&motion, |q| q[0], 10).unwrap().count(), 0);
}
