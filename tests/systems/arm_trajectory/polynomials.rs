//! Conditions, continuity and extrema of the polynomials, at random data.

use mbs_arm::trajectory::{
    ACCELERATION, Extrema, JointState, Knot, Motion, POSITION, Piecewise, RateLimits, VELOCITY, quartic, quintic,
    quintic_between, through, trapezoidal, trapezoidal_within, two_piece_quartic,
};
use mbs_models::{At, Failure};
use mbs_tests::compare::assert_close;
use mbs_tests::random::Random;

fn state(random: &mut Random) -> JointState<3> {
    JointState { q: random.array(-3.0..3.0), qd: random.array(-1.0..1.0), qdd: random.array(-1.0..1.0) }
}

/// q, q̇ and q̈ on both sides of a time are the same, up to how much they change meanwhile.
fn check_continuous<const N: usize>(motion: &impl Motion<N>, t: f64) {
    let [before, after] = [t * (1.0 - 1e-10), t].map(|t| motion.at(t).unwrap());
    for (what, before, after) in [("q", before.q, after.q), ("q̇", before.qd, after.qd), ("q̈", before.qdd, after.qdd)]
    {
        assert_close(&format!("{what} at {t} s"), &before, &after, 1e-8);
    }
}

fn check_state<const N: usize>(found: &JointState<N>, expected: &JointState<N>) {
    assert_close("q", &found.q, &expected.q, 1e-13);
    assert_close("q̇", &found.qd, &expected.qd, 1e-12);
    assert_close("q̈", &found.qdd, &expected.qdd, 1e-11);
}

/// Velocities and accelerations are derivatives: q(t) and q̇(t) come from central differences.
fn check_derivatives<const N: usize>(motion: &impl Motion<N>, t: f64) {
    let h = 1e-4 * motion.duration();
    let [before, at, after] = [t - h, t, t + h].map(|t| motion.at(t).unwrap());
    for i in 0..N {
        assert!(((after.q[i] - before.q[i]) / (2.0 * h) - at.qd[i]).abs() < 1e-5 * (1.0 + at.qd[i].abs()));
        assert!(((after.qd[i] - before.qd[i]) / (2.0 * h) - at.qdd[i]).abs() < 1e-4 * (1.0 + at.qdd[i].abs()));
    }
}

/// No sample lies outside the extrema, and one comes close to each.
fn check_extrema<const N: usize, const P: usize>(motion: &Piecewise<N, P>) {
    let samples: Vec<JointState<N>> =
        (0..=20_000).map(|k| motion.at(motion.duration() * (f64::from(k) / 20_000.0)).unwrap()).collect();
    let check = |extrema: [Extrema; N], value: &dyn Fn(&JointState<N>, usize) -> f64, order: usize| {
        for (i, Extrema { lowest, highest }) in extrema.into_iter().enumerate() {
            let (low, high) = samples
                .iter()
                .map(|state| value(state, i))
                .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
            let size = 1e-12 + 1e-6 * (high - low);
            assert!(
                lowest.value <= low + 1e-12 * (1.0 + low.abs()) && low - lowest.value < 10.0 * size,
                "{order}: {low} {lowest:?}"
            );
            assert!(
                highest.value >= high - 1e-12 * (1.0 + high.abs()) && highest.value - high < 10.0 * size,
                "{order}: {high} {highest:?}"
            );
        }
    };
    check(motion.position_extrema(), &|state, i| state.q[i], 0);
    check(motion.velocity_extrema(), &|state, i| state.qd[i], 1);
}

#[test]
fn quartics_honour_five_conditions_and_two_of_them_all_six() {
    let mut random = Random::new(1);
    for _ in 0..50 {
        let [start, stop, velocity]: [[f64; 3]; 3] = std::array::from_fn(|_| random.array(-2.0..2.0));
        let duration = random.uniform(0.1..20.0);
        let first = JointState { q: start, qd: velocity, qdd: [0.0; 3] };

        let one = quartic(start, velocity, stop, duration).unwrap();
        check_state(&one.at(0.0).unwrap(), &first);
        let end = one.at(duration).unwrap();
        let qdd = std::array::from_fn(|i| {
            (6.0 * velocity[i] * duration - 12.0 * (stop[i] - start[i])) / (duration * duration)
        });
        check_state(&end, &JointState { qdd, ..JointState::at_rest(stop) });
        check_derivatives(&one, 0.3 * duration);
        check_extrema(&one);

        let two = two_piece_quartic(start, velocity, stop, duration).unwrap();
        check_state(&two.at(0.0).unwrap(), &first);
        check_state(&two.at(duration).unwrap(), &JointState::at_rest(stop));
        check_continuous(&two, 0.5 * duration);
        for i in 0..3 {
            // The third derivative: 6 c₃ + 24 c₄ h.
            let [before, after] = [two.coefficients(0, i), two.coefficients(1, i)];
            let h = 0.5 * duration;
            let jump = 6.0 * before[3] + 24.0 * before[4] * h - 6.0 * after[3];
            assert!(jump.abs() * h * h * h < 1e-12, "{jump}");
        }
        check_derivatives(&two, 0.7 * duration);
        check_extrema(&two);

        let five = quintic(start, velocity, stop, duration).unwrap();
        check_state(&five.at(0.0).unwrap(), &first);
        check_state(&five.at(duration).unwrap(), &JointState::at_rest(stop));
        check_extrema(&five);
    }
}

#[test]
fn a_quintic_honours_what_it_is_given() {
    let mut random = Random::new(2);
    for _ in 0..50 {
        let (start, stop, duration) = (state(&mut random), state(&mut random), random.uniform(0.5..5.0));
        let motion = quintic_between(&start, &stop, duration).unwrap();
        check_state(&motion.at(0.0).unwrap(), &start);
        check_state(&motion.at(duration).unwrap(), &stop);
        check_extrema(&motion);
    }
}

#[test]
fn points_are_passed_in_time_and_smoothly() {
    let mut random = Random::new(3);
    let mut time = 0.0;
    let start = state(&mut random);
    let knots: [Knot<3>; 5] = std::array::from_fn(|_| {
        time += random.uniform(0.5..2.0);
        Knot { time, q: random.array(-2.0..2.0) }
    });
    let last = [0.3, 0.0, -0.2];
    let motion = through(&start, &knots, last).unwrap();
    check_state(&motion.at(0.0).unwrap(), &start);
    for knot in &knots {
        assert_close("knot", &motion.at(knot.time).unwrap().q, &knot.q, 1e-13);
    }
    knots[..4].iter().for_each(|knot| check_continuous(&motion, knot.time));
    check_state(&motion.at(time).unwrap(), &JointState { q: knots[4].q, qd: last, qdd: [0.0; 3] });
    check_extrema(&motion);
    // The first and the last piece are quartics, the others cubics.
    let degree = |piece| motion.coefficients(piece, 0).iter().rposition(|c| *c != 0.0);
    assert_eq!([0, 1, 2, 3, 4].map(degree), [4, 3, 3, 3, 4].map(Some));

    let two = through(&start, &[knots[0], knots[1]], last).unwrap();
    check_continuous(&two, knots[0].time);
    check_state(&two.at(knots[1].time).unwrap(), &JointState { q: knots[1].q, qd: last, qdd: [0.0; 3] });
    let one = through(&start, &[knots[0]], last).unwrap();
    check_state(&one.at(knots[0].time).unwrap(), &JointState { q: knots[0].q, qd: last, qdd: [0.0; 3] });
}

#[test]
fn trapezoids_hold_their_limits_and_use_them() {
    let (start, stop) = ([0.0, 1.0, 5.0], [1.0, -3.0, 5.0]);
    let even = trapezoidal(start, stop, 10.0, 2.0).unwrap();
    check_state(&even.at(0.0).unwrap(), &JointState { qdd: [0.0625, -0.25, 0.0], ..JointState::at_rest(start) });
    assert_eq!(even.at(5.0).unwrap(), JointState { q: [0.5, -1.0, 5.0], qd: [0.125, -0.5, 0.0], qdd: [0.0; 3] });
    check_state(&even.at(10.0).unwrap(), &JointState { qdd: [-0.0625, 0.25, 0.0], ..JointState::at_rest(stop) });
    check_extrema(&even);

    // The second joint goes farther and is the slower one: 4 rad at 1 rad/s and 0.5 rad/s² take 4/1 + 1/0.5 s.
    let limits = RateLimits { speed: [1.0, 1.0, 1.0], acceleration: [9.0, 0.5, f64::INFINITY] };
    let fast = trapezoidal_within(start, stop, &limits).unwrap();
    assert!((fast.duration() - 6.0).abs() < 1e-14, "{}", fast.duration());
    assert!((fast.velocity_extrema()[1].farthest().value + 1.0).abs() < 1e-14);
    assert!((fast.acceleration_extrema()[1].farthest().value.abs() - 0.5).abs() < 1e-14);
    // Half the way is too short for full speed: a triangle of 2 √(D/a).
    let limits = RateLimits { speed: [9.0; 3], acceleration: [9.0, 1.0, 9.0] };
    let triangle = trapezoidal_within(start, stop, &limits).unwrap();
    assert!((triangle.duration() - 4.0).abs() < 1e-14, "{}", triangle.duration());
    check_state(&triangle.at(4.0).unwrap(), &JointState { qdd: [-0.25, 1.0, 0.0], ..JointState::at_rest(stop) });
    check_extrema(&triangle);
}

#[test]
fn limits_that_are_exceeded_are_named() {
    // Fastest at 2 s with 16/9 · D/T; overshoots where the velocity at the start is too high.
    let motion = quartic([0.0; 2], [0.0, 3.0], [1.0, 1.0], 3.0).unwrap();
    let ranges = [[-1.0, 1.5]; 2];
    let highest = motion.position_extrema()[1].highest;
    assert!(highest.value > 1.5);
    let error = Failure::LimitExceeded { quantity: POSITION, unit: "rad", index: 1, value: highest.value, limit: 1.5 }
        .at_time(highest.time);
    assert_eq!(motion.check_ranges(&ranges), Err(error));
    assert_eq!(motion.check_ranges(&[[-1.0, 1.5], [-1.0, 9.0]]), Ok(()));

    let fastest = motion.velocity_extrema()[0].highest;
    let limits = RateLimits { speed: [0.5, 9.0], acceleration: [9.0; 2] };
    let error =
        Failure::LimitExceeded { quantity: VELOCITY, unit: "rad/s", index: 0, value: fastest.value, limit: 0.5 }
            .at_time(fastest.time);
    assert!((fastest.time - 2.0).abs() < 1e-14);
    assert_eq!(motion.check_rates(&limits), Err(error));
    let limits = RateLimits { speed: [9.0; 2], acceleration: [1.0, 9.0] };
    let error = motion.check_rates(&limits).unwrap_err();
    assert_eq!(error.at, Some(At::Time(3.0)));
    assert!(matches!(error.failure, Failure::LimitExceeded { quantity: ACCELERATION, index: 0, .. }), "{error}");
    assert_eq!(motion.check_rates(&RateLimits { speed: [9.0; 2], acceleration: [9.0; 2] }), Ok(()));
}
