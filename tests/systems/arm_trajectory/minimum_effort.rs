//! Motions of least effort against closed forms, and against the differential equations of Pontryagin's principle,
//! typed by hand and solved by shooting.

use mbs_arm::trajectory::minimum_effort::front::Search;
use mbs_arm::trajectory::minimum_effort::{Limits, MinimumEffort, Transfer, minimum_effort};
use mbs_arm::trajectory::{Motion, POSITION};
use mbs_models::cart_pole::{self, CartPole};
use mbs_models::check::Must;
use mbs_models::pendulum::{Params, Pendulum};
use mbs_models::{Error, Failure};
use mbs_runtime::{Dual, Scalar};

mod arm;
mod pontryagin;

/// A wheel of 1 kg m² without gravity: `θ̈ = τ`.
fn wheel() -> Pendulum<Dual<f64>> {
    Pendulum::new(Params { g: Dual::constant(0.0), ..Params::default() })
}

fn turn(angle: f64, duration: f64, limits: Limits<1, 1>) -> Transfer<1, 1> {
    Transfer { start: [[0.0], [0.0]], stop: [[angle], [0.0]], duration, scale: [1.0], limits }
}

#[test]
fn a_double_integrator_follows_a_cubic() {
    let (angle, duration) = (0.7, 3.0_f64);
    let want = 12.0 * angle * angle / duration.powi(3);
    for intervals in [1, 2, 7, 50] {
        let motion = minimum_effort(&wheel(), &turn(angle, duration, Limits::NONE), intervals, None).unwrap();
        assert!((motion.effort() / want - 1.0).abs() < 1e-12, "{intervals}: {}, {want}", motion.effort());
        assert!(motion.residual().largest() < 1e-12);
        for k in 0..=40 {
            let t = duration * f64::from(k) / 40.0;
            let (s, state) = (t / duration, motion.at(t).unwrap());
            let input = 6.0 * angle / duration.powi(2) * (1.0 - 2.0 * s);
            assert!((state.q[0] - angle * s * s * (3.0 - 2.0 * s)).abs() < 1e-12);
            assert!((state.qd[0] - 6.0 * angle / duration * s * (1.0 - s)).abs() < 1e-12);
            assert!((state.qdd[0] - input).abs() < 1e-11 && (motion.input_at(t).unwrap()[0] - input).abs() < 1e-11);
        }
        for point in motion.points() {
            // ∂H/∂τ = 0: p = −2 τ for the velocity, constant for the angle; H = dJ/dT.
            assert!((point.costate[1][0] + 2.0 * point.input[0]).abs() < 1e-11);
            assert!((point.costate[0][0] + 24.0 * angle / duration.powi(3)).abs() < 1e-11);
            assert!((point.hamiltonian + 3.0 * want / duration).abs() < 1e-11);
        }
    }
}

/// Full torque for a second, then falling to the opposite in two, and full torque again.
#[test]
fn a_torque_limit_saturates_the_straight_line() {
    let limits = Limits { input: [1.0], ..Limits::NONE };
    let motion = minimum_effort(&wheel(), &turn(11.0 / 3.0, 4.0, limits), 8, None).unwrap();
    assert!((motion.effort() - 8.0 / 3.0).abs() < 1e-6, "{}", motion.effort());
    for point in motion.points() {
        let want = (2.0 - point.t).clamp(-1.0, 1.0);
        // In the corners neither the limit nor its multiplier holds the torque: there it is the root of the tolerance
        // off.
        assert!((point.input[0] - want).abs() < 2e-4, "{}: {}", point.t, point.input[0]);
    }
    // Without the limit less effort does it, with more torque than that.
    let free = minimum_effort(&wheel(), &turn(11.0 / 3.0, 4.0, Limits::NONE), 8, None).unwrap();
    assert!(free.effort() < motion.effort() && free.points()[0].input[0] > 1.3);
}

/// A parabola up to the limit, along it without effort, and down again: `J = 8 V²/(3 t₁)`.
#[test]
fn a_speed_limit_is_followed() {
    let limits = Limits { speed: [1.0], ..Limits::NONE };
    let motion = minimum_effort(&wheel(), &turn(3.0, 4.0, limits), 8, None).unwrap();
    assert!((motion.effort() - 8.0 / 4.5).abs() < 1e-6, "{}", motion.effort());
    for point in motion.points() {
        let rest = 1.0 - point.t.min(4.0 - point.t).min(1.5) / 1.5;
        assert!((point.state.qd[0] - (1.0 - rest * rest)).abs() < 1e-5, "{}: {}", point.t, point.state.qd[0]);
    }
}

/// The angle may not go beyond where it must arrive: it would, with this velocity at the start.
#[test]
fn a_range_is_kept() {
    let start = [[0.0], [3.0]];
    let limits = Limits { upper: [1.0], ..Limits::NONE };
    let free = Transfer { start, ..turn(1.0, 2.0, Limits::NONE) };
    let highest = |limits| {
        let motion = minimum_effort(&wheel(), &Transfer { limits, ..free }, 20, None).unwrap();
        (motion.points().iter().map(|point| point.state.q[0]).fold(0.0, f64::max), motion.effort())
    };
    let ((beyond, least), (within, more)) = (highest(Limits::NONE), highest(limits));
    assert!(beyond > 1.05 && within <= 1.0 && more > least, "{beyond} {within} {least} {more}");
}

/// Warm starts lead to the same motion, in fewer steps.
#[test]
fn a_guess_saves_steps() {
    let limits = Limits { input: [4.0], ..Limits::NONE };
    let swing = |duration| Transfer { limits, ..turn(2.0, duration, limits) };
    let pendulum = Pendulum::<Dual<f64>>::default();
    let first = minimum_effort(&pendulum, &swing(3.0), 20, None).unwrap();
    let cold = minimum_effort(&pendulum, &swing(3.03), 20, None).unwrap();
    let warm = minimum_effort(&pendulum, &swing(3.03), 20, Some(&first)).unwrap();
    assert!((cold.effort() / warm.effort() - 1.0).abs() < 1e-8, "{} {}", cold.effort(), warm.effort());
    assert!(warm.iterations() < cold.iterations(), "{} {}", warm.iterations(), cold.iterations());
    assert_eq!(
        minimum_effort(&pendulum, &swing(3.0), 21, Some(&first)).unwrap_err(),
        Must::BeWithin([21.0, 21.0]).broken_by("intervals of the guess", 20.0).into()
    );
}

/// A wheel at 1 rad/s goes on by 1 rad: `H = 12 (1 − T)(T − 3)/T⁴`, whose secant from 1.3 s and 1.17 s leads to −0.5 s.
#[test]
fn a_front_without_an_end_or_without_points_is_refused() {
    let search = Search { intervals: 4, points: 3, bisections: 0, flat: 1e-5 };
    let rolling = Transfer { start: [[0.0], [1.0]], stop: [[1.0], [1.0]], ..turn(1.0, 1.3, Limits::NONE) };
    let of = |search: Search| search.front(&wheel(), &rolling).unwrap_err();
    for points in 0..3 {
        let few = Must::BeAtLeast(3.0).broken_by("points", points as f64);
        assert_eq!(of(Search { points, ..search }), few.into());
    }
    let endless = of(search);
    let expected = "the search of the time of least effort";
    assert!(
        matches!(endless.failure, Failure::NotConverged { what, iterations: 1, .. } if what == expected),
        "{endless}"
    );
}

fn refused(transfer: Transfer<1, 1>) -> Error {
    minimum_effort(&wheel(), &transfer, 4, None).unwrap_err()
}

#[test]
fn what_cannot_be_is_named() {
    let good = turn(1.0, 2.0, Limits::NONE);
    let none = Must::BePositive.broken_by("intervals", 0.0);
    assert_eq!(minimum_effort(&wheel(), &good, 0, None).unwrap_err(), none.into());
    assert_eq!(refused(Transfer { duration: -1.0, ..good }), Must::BePositive.broken_by("duration", -1.0).into());
    assert_eq!(refused(Transfer { scale: [0.0], ..good }), Must::BePositive.broken_by("scale", 0.0).into());
    let nowhere = refused(Transfer { start: [[f64::NAN], [0.0]], ..good });
    assert!(nowhere.invalid().is_some_and(|wrong| wrong.parameter == POSITION), "{nowhere}");
    let limited = |limits| refused(Transfer { limits, ..good });
    assert_eq!(
        limited(Limits { speed: [0.0], ..Limits::NONE }),
        Must::BeMoreThan(0.0).broken_by("largest speed", 0.0).into()
    );
    assert_eq!(
        limited(Limits { input: [-2.0], ..Limits::NONE }),
        Must::BeMoreThan(0.0).broken_by("largest input", -2.0).into()
    );
    let crossed = Must::BeMoreThan(2.0).broken_by("largest angle of joint", 1.0).of(0);
    assert_eq!(limited(Limits { lower: [2.0], upper: [1.0], ..Limits::NONE }), crossed.into());
    assert_eq!(
        limited(Limits { upper: [0.5], ..Limits::NONE }),
        Failure::LimitExceeded { quantity: POSITION, unit: "rad", index: 0, value: 1.0, limit: 0.5 }.at_time(2.0)
    );
    // 1 rad in 2 s asks for 1 N·m at least, bang-bang.
    let found = limited(Limits { input: [0.9], ..Limits::NONE });
    assert!(matches!(found.failure, Failure::NotConverged { residual, .. } if residual > 1e-3), "{found}");
    assert!(minimum_effort(&wheel(), &good, 4, None).unwrap().input_at(2.1).is_err());
}
