//! What every method has in common: its order, its observers, its errors.

use super::*;
use crate::SingularMassMatrix;
use crate::{Dop853, Dopri5, GaussLegendre4, Rk4, SemiImplicitEuler, StormerVerlet};

fn oscillate(_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]) {
    qdd[0] = -q[0];
}

/// What is left of the way may be short; the step control goes on from the step that it would have made.
#[test]
fn a_short_last_step_says_little_about_the_next() {
    fn check(integrator: &impl Integrator<f64>) {
        let (mut ends, mut count) = ([0.0; 512], 0);
        let watched = |step: &mut dyn Step<[f64; 1]>| {
            count += 1;
            ends[count] = step.time();
            ControlFlow::Continue(())
        };
        integrator.integrate(oscillate, 0.0, 30.0, &mut State::new([1.0], [0.0]), watched).unwrap();
        for k in 1..count - 1 {
            let length = ends[k + 1] - ends[k];
            let t_end = ends[k] + 0.05 * length;
            let mut state = State::new([1.0], [0.0]);
            let go_on = |_: &mut dyn Step<[f64; 1]>| ControlFlow::Continue(());
            let summary = integrator.integrate(oscillate, 0.0, t_end, &mut state, go_on).unwrap();
            assert!((0.999 * length..1e3 * length).contains(&summary.next_step), "{summary:?} after {length}");
        }
    }
    check(&Dopri5::new(1e-8, 1e-8));
    check(&Dop853::new(1e-10, 1e-10));
}

#[test]
fn a_step_that_was_not_tried_is_not_proposed() {
    fn check(integrator: &impl Integrator<f64>) {
        let go_on = |_: &mut dyn Step<[f64; 1]>| ControlFlow::Continue(());
        let summary = integrator.integrate(oscillate, 0.0, 0.3, &mut State::new([1.0], [0.0]), go_on).unwrap();
        assert!(summary.next_step > 0.0 && summary.next_step <= 10.0 * 0.3, "{summary:?}");
    }
    check(&Dopri5::new(1e-8, 1e-8).with_first_step(1e6));
    check(&Dop853::new(1e-10, 1e-10).with_first_step(1e6));
}

/// The largest deviation from a cosine at the times asked for, and the number of answers.
fn check_samples(integrator: &impl Integrator<f64>, times: &[f64], tolerance: f64) {
    let mut seen = 0;
    let mut state = State::new([1.0], [0.0]);
    let summary = integrator
        .sample(oscillate, 0.0, times, &mut state, |t, state| {
            assert_eq!(t, times[seen]);
            assert!((state.q[0] - Scalar::cos(t)).abs() < tolerance, "q at {t}");
            assert!((state.qd[0] + Scalar::sin(t)).abs() < tolerance, "q̇ at {t}");
            seen += 1;
        })
        .unwrap();
    assert_eq!(seen, times.len());
    assert_eq!(summary.time, times.last().copied().unwrap_or(0.0));
}

#[test]
fn samples_forwards_backwards_repeated_and_none() {
    let (dop853, rk4) = (Dop853::new(1e-10, 1e-12), Rk4::new(0.01));
    for times in
        [&[0.0, 0.0, 0.1, 0.1, 0.5, 3.0, 7.0][..], &[1e-9, 20.0], &[-0.1, -0.2, -3.0], &[0.0, -1.0, -1.0], &[0.0], &[]]
    {
        check_samples(&dop853, times, 1e-9);
        check_samples(&rk4, times, 1e-8);
        check_samples(&Dopri5::new(1e-10, 1e-12), times, 1e-8);
        check_samples(&GaussLegendre4::new(0.01), times, 1e-8);
        check_samples(&StormerVerlet::new(0.01), times, 1e-3);
        check_samples(&SemiImplicitEuler::new(1e-4), times, 1e-2);
    }
}

#[test]
fn output_times_that_turn_back_are_refused() {
    for (times, bad) in [(&[1.0, 0.5, 2.0][..], 0.5), (&[-1.0, 1.0], -1.0), (&[2.0, 1.0], 2.0)] {
        let mut state = State::new([1.0], [0.0]);
        let result = Rk4::new(0.1).sample(oscillate, 0.0, times, &mut state, |_, _| {});
        assert_eq!(result, Err(IntegrationError::InvalidTime { time: bad }));
        assert_eq!(state, State::new([1.0], [0.0]));
    }
    let result = Rk4::new(0.1).sample(oscillate, 0.0, &[0.5, f64::NAN, 1.0], &mut State::default(), |_, _| {});
    assert!(matches!(result, Err(IntegrationError::InvalidTime { time }) if time.is_nan()));
}

/// The observer's powers, for any method.
fn check_observer(integrator: &impl Integrator<f64>) {
    // Ends inside a step, where asked.
    let mut state = State::new([1.0], [0.0]);
    let stop = |step: &mut dyn Step<[f64; 1]>| {
        if step.time() > 1.0 { ControlFlow::Break(1.0) } else { ControlFlow::Continue(()) }
    };
    let summary = integrator.integrate(oscillate, 0.0, 5.0, &mut state, stop).unwrap();
    assert_eq!((summary.time, summary.stopped), (1.0, true));
    assert!((state.q[0] - Scalar::cos(1.0)).abs() < 1e-8);

    // A time outside the step is an error, and the state the last accepted one.
    let mut end = f64::NAN;
    let mut last = State::default();
    let result = integrator.integrate(oscillate, 0.0, 5.0, &mut state, |step| {
        (end, last) = (step.time(), *step.state());
        ControlFlow::Break(-1.0)
    });
    assert_eq!(result, Err(IntegrationError::InvalidTime { time: -1.0 }));
    assert!(end > 0.0 && state == last);

    // Both ends are exact, the inside continuous.
    let mut state = State::new([1.0], [0.0]);
    let mut previous = state;
    integrator
        .integrate(oscillate, 0.0, 5.0, &mut state, |step| {
            let mut there = State::default();
            assert_eq!(*step.previous_state(), previous);
            step.interpolate(step.previous_time(), &mut there).unwrap();
            assert_eq!(there, previous);
            step.interpolate(step.time(), &mut there).unwrap();
            assert_eq!(there, *step.state());
            let almost = step.time() - 1e-9 * (step.time() - step.previous_time());
            step.interpolate(almost, &mut there).unwrap();
            assert!((there.q[0] - step.state().q[0]).abs() < 1e-8);
            previous = *step.state();
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(state, previous);

    // Going on from a replaced state: reversed in mid-flight, an oscillator comes back.
    let mut state = State::new([1.0], [0.5]);
    let mut turned = 0.0;
    integrator
        .integrate(oscillate, 0.0, 2.0, &mut state, |step| {
            if turned == 0.0 {
                turned = step.time();
                let State { q, qd } = *step.state();
                step.replace(&State::new(q, [-qd[0]]));
            } else if step.time() >= 2.0 * turned {
                return ControlFlow::Break(2.0 * turned);
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!((state.q[0] - 1.0).abs() < 1e-8 && (state.qd[0] + 0.5).abs() < 1e-8, "{state:?}");
}

#[test]
fn an_observer_stops_interpolates_and_replaces() {
    check_observer(&Dop853::new(1e-11, 1e-12));
    check_observer(&Rk4::new(0.01));
    check_observer(&Dopri5::new(1e-11, 1e-12));
    check_observer(&GaussLegendre4::new(0.01));
    check_observer(&StormerVerlet::new(1e-4));
}

#[test]
fn a_restart_drops_the_rest_of_the_step() {
    fn check(integrator: &impl Integrator<f64>) {
        // Thrown back at q = cos 1: from there it moves as before time 1, backwards.
        let mut state = State::new([1.0], [0.0]);
        let mut thrown = false;
        let summary = integrator
            .integrate(oscillate, 0.0, 2.0, &mut state, |step| {
                if !thrown && step.time() >= 1.0 {
                    thrown = true;
                    let mut there = State::default();
                    step.interpolate(1.0, &mut there).unwrap();
                    step.restart(1.0, &State::new(there.q, [-there.qd[0]])).unwrap();
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!((summary.time, summary.stopped), (2.0, false));
        assert!((state.q[0] - 1.0).abs() < 1e-7 && state.qd[0].abs() < 1e-7, "{state:?}");
        // A time outside is an error, the time of a restart one to stop at.
        let outside = |step: &mut dyn Step<[f64; 1]>| {
            let state = *step.state();
            step.restart(-1.0, &state).unwrap_err();
            ControlFlow::Continue(())
        };
        let result = integrator.integrate(oscillate, 0.0, 2.0, &mut state, outside);
        assert_eq!(result, Err(IntegrationError::InvalidTime { time: -1.0 }));
        let summary = integrator.integrate(oscillate, 0.0, 2.0, &mut state, |step| {
            let middle = 0.5 * (step.previous_time() + step.time());
            step.restart(middle, &State::new([7.0], [8.0])).unwrap();
            ControlFlow::Break(middle)
        });
        assert!(summary.unwrap().stopped && state == State::new([7.0], [8.0]));
    }
    check(&Dop853::new(1e-10, 1e-12));
    check(&Dopri5::new(1e-10, 1e-12));
    check(&Rk4::new(0.013));
    check(&GaussLegendre4::new(0.013));
    check(&StormerVerlet::new(0.7e-4));
}

/// The slope of the error at `t = 4` over the step, in logarithms, for `q = cos t + sin(2t)/2`.
///
/// The solution solves `q̈ = −q − (3/2) sin 2t + friction (q̇ − d/dt (cos t + sin(2t)/2))` whatever the friction.
fn order<I: Integrator<f64>>(method: impl Fn(f64) -> I, friction: f64, steps: [f64; 4]) -> f64 {
    let velocity = |t: f64| Scalar::cos(2.0 * t) - Scalar::sin(t);
    let points = steps.map(|steps| {
        let mut state = State::new([1.0], [1.0]);
        let forced = |t: f64, q: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| {
            qdd[0] = -q[0] - 1.5 * Scalar::sin(2.0 * t) + friction * (qd[0] - velocity(t));
        };
        let summary =
            method(4.0 / steps).integrate(forced, 0.0, 4.0, &mut state, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(summary.accepted as f64, steps);
        let q = Scalar::cos(4.0) + 0.5 * Scalar::sin(8.0);
        let error = Scalar::abs(state.q[0] - q).max(Scalar::abs(state.qd[0] - velocity(4.0)));
        [Scalar::ln(4.0 / steps), Scalar::ln(error)]
    });
    let mean = [0, 1].map(|i| points.iter().map(|point| point[i]).sum::<f64>() / 4.0);
    let moment = |i: usize, j: usize| -> f64 { points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum() };
    moment(0, 1) / moment(0, 0)
}

#[test]
fn every_method_has_its_order() {
    let dopri5 = |h| Dopri5 { first_step: Some(h), max_step: h, ..Dopri5::new(1e9, 1e9) };
    let dop853 = |h| Dop853 { first_step: Some(h), max_step: h, ..Dop853::new(1e9, 1e9) };
    let many = [100.0, 140.0, 200.0, 280.0];
    for (name, found, expected) in [
        ("semi-implicit Euler", order(SemiImplicitEuler::new, 0.2, [400.0, 600.0, 800.0, 1200.0]), 1.0),
        ("Störmer–Verlet", order(StormerVerlet::new, 0.0, many), 2.0),
        ("Störmer–Verlet with friction", order(StormerVerlet::new, 0.2, many.map(|n| 10.0 * n)), 1.0),
        ("Runge–Kutta", order(Rk4::new, 0.2, many), 4.0),
        ("Gauss–Legendre", order(GaussLegendre4::new, 0.2, many), 4.0),
        ("Dormand–Prince 5", order(dopri5, 0.2, many), 5.0),
        ("Dormand–Prince 8", order(dop853, 0.2, [10.0, 14.0, 20.0, 28.0]), 8.0),
    ] {
        assert!(Scalar::abs(found - expected) < 0.15, "{name}: order {found}");
    }
}

fn check_bad_input(integrator: &impl Integrator<f64>) {
    let go = |t, t_end, state: State<[f64; 1]>| {
        let mut left = state;
        let result = integrator.integrate(oscillate, t, t_end, &mut left, |_| ControlFlow::Continue(()));
        assert!(left == state || result.is_ok() || !state.is_finite());
        result
    };
    let state = State::new([1.0], [0.0]);
    assert!(matches!(go(f64::NAN, 1.0, state), Err(IntegrationError::InvalidTime { .. })));
    assert!(matches!(go(0.0, f64::NAN, state), Err(IntegrationError::InvalidTime { .. })));
    assert!(matches!(go(0.0, f64::INFINITY, state), Err(IntegrationError::InvalidTime { .. })));
    let nan = State::new([f64::NAN], [0.0]);
    assert_eq!(go(2.0, 3.0, nan), Err(IntegrationError::NonFiniteState { time: 2.0 }));
    assert!(go(-1e308, 1e308, state).is_err());
    let nothing = go(1.0, 1.0, state).unwrap();
    assert_eq!((nothing.time, nothing.evaluations, nothing.accepted), (1.0, 0, 0));
    assert_eq!(go(0.0, 1e-300, state).unwrap().time, 1e-300);
    assert_eq!(go(1.0, 1.0 + f64::EPSILON, state).unwrap().time, 1.0 + f64::EPSILON);
}

#[test]
fn bad_input_is_an_error() {
    check_bad_input(&Dopri5 { max_steps: 1000, ..Dopri5::new(1e-9, 1e-9) });
    check_bad_input(&SemiImplicitEuler { max_steps: 1000, ..SemiImplicitEuler::new(0.01) });
    check_bad_input(&StormerVerlet { max_steps: 1000, ..StormerVerlet::new(0.01) });
    check_bad_input(&GaussLegendre4 { max_steps: 1000, ..GaussLegendre4::new(0.01) });
    check_bad_input(&Dop853 { max_steps: 1000, ..Dop853::new(1e-9, 1e-9) });
    check_bad_input(&Rk4 { max_steps: 1000, ..Rk4::new(0.01) });
}

/// An observer that goes on from nonsense, or never goes on.
fn check_bad_observer(integrator: &impl Integrator<f64>) {
    let nonsense = State::new([1.0], [f64::NAN]);
    for when in [0.5, 1.0] {
        let mut state = State::new([1.0], [0.0]);
        let mut last = (0.0, state);
        let result = integrator.integrate(oscillate, 0.0, 1.0, &mut state, |step| {
            last = (step.time(), *step.state());
            if step.time() >= when {
                step.replace(&nonsense);
            }
            ControlFlow::Continue(())
        });
        assert_eq!((result, state), (Err(IntegrationError::NonFiniteState { time: last.0 }), last.1));
    }
    let mut state = State::new([1.0], [0.0]);
    let result = integrator.integrate(oscillate, 0.0, 1.0, &mut state, |step| {
        let start = step.previous_time();
        assert!(matches!(step.restart(start, &nonsense), Err(IntegrationError::NonFiniteState { .. })));
        ControlFlow::Break(start)
    });
    assert!(matches!(result, Err(IntegrationError::NonFiniteState { .. })) && state.is_finite(), "{result:?}");
    let mut state = State::new([1.0], [0.0]);
    let result = integrator.integrate(oscillate, 0.0, 1.0, &mut state, |step| {
        let (start, before) = (step.previous_time(), *step.previous_state());
        step.restart(start, &before).unwrap();
        ControlFlow::Continue(())
    });
    assert!(matches!(result, Err(IntegrationError::TooManySteps { time: 0.0, .. })), "{result:?}");
    assert_eq!(state, State::new([1.0], [0.0]));
}

#[test]
fn an_observer_that_errs_is_an_error() {
    check_bad_observer(&Dopri5::new(1e-9, 1e-9));
    check_bad_observer(&SemiImplicitEuler::new(0.01));
    check_bad_observer(&StormerVerlet::new(0.01));
    check_bad_observer(&GaussLegendre4::new(0.01));
    check_bad_observer(&Dop853::new(1e-9, 1e-9));
    check_bad_observer(&Rk4::new(0.01));
}

fn check_failures(integrator: &impl Integrator<f64>) {
    // Free fall into a wall at q = 0, behind which the function is NaN.
    let mut state = State::new([1.0], [-1.0]);
    let wall = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| {
        qdd[0] = if q[0] > 0.0 { 0.0 } else { f64::NAN };
    };
    let result = integrator.integrate(wall, 0.0, 2.0, &mut state, |_| ControlFlow::Continue(()));
    let Err(IntegrationError::NonFiniteState { time }) = result else { panic!("{result:?}") };
    assert!(time > 0.9 && state.q[0] > 0.0 && (state.q[0] - (1.0 - time)).abs() < 1e-12, "{state:?}");

    // The same with a mass that vanishes there.
    let mut state = State::new([1.0], [-1.0]);
    let massless = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| {
        qdd[0] = 0.0;
        if q[0] > 0.0 { Ok(()) } else { Err(SingularMassMatrix { pivot: q[0], index: 0 }) }
    };
    let result = integrator.integrate(massless, 0.0, 2.0, &mut state, |_| ControlFlow::Continue(()));
    let Err(IntegrationError::Stopped { time, error: SingularMassMatrix { pivot, index: 0 } }) = result else {
        panic!("{result:?}")
    };
    assert!(time > 0.9 && state.q[0] > 0.0 && pivot <= 0.0);

    // Nothing to start from.
    let mut state = State::new([-1.0], [0.0]);
    let result = integrator.integrate(wall, 3.0, 4.0, &mut state, |_| ControlFlow::Continue(()));
    assert_eq!(result, Err(IntegrationError::NonFiniteState { time: 3.0 }));
}

#[test]
fn failures_leave_the_last_good_state() {
    check_failures(&Dopri5::new(1e-9, 1e-9));
    check_failures(&SemiImplicitEuler::new(0.01));
    check_failures(&StormerVerlet::new(0.01));
    check_failures(&GaussLegendre4::new(0.0123));
    check_failures(&Dop853::new(1e-9, 1e-9));
    check_failures(&Rk4::new(0.01));
}

#[test]
fn a_solution_that_ends_is_an_error() {
    // q̇ = 1/(1 − t): its acceleration is its square. Fixed steps go past the end, and overflow soon after.
    fn check(integrator: &impl Integrator<f64>) {
        let explosive = |_: f64, _: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = qd[0] * qd[0];
        let mut state = State::new([0.0], [1.0]);
        let mut last = (0.0, state);
        let error = integrator
            .integrate(explosive, 0.0, 2.0, &mut state, |step| {
                assert!(step.state().is_finite());
                last = (step.time(), *step.state());
                ControlFlow::Continue(())
            })
            .unwrap_err();
        assert_eq!((error.time(), state), (Some(last.0), last.1));
        assert!((last.0 - 1.0).abs() < 0.05, "{error}");
    }
    check(&Dopri5::new(1e-8, 1e-8));
    check(&Dop853::new(1e-8, 1e-8));
    check(&Rk4::new(1e-3));
    check(&GaussLegendre4::new(1e-3));
    check(&StormerVerlet::new(1e-3));
    check(&SemiImplicitEuler::new(1e-3));
}

#[test]
fn steps_used_up_are_an_error() {
    fn check(integrator: &impl Integrator<f64>) {
        let mut state = State::new([1.0], [0.0]);
        let result = integrator.integrate(oscillate, 0.0, 50.0, &mut state, |_| ControlFlow::Continue(()));
        let Err(IntegrationError::TooManySteps { time, steps: 7 }) = result else { panic!("{result:?}") };
        assert!((state.q[0] - Scalar::cos(time)).abs() < 1e-3, "{time}");
    }
    let max_steps = 7;
    check(&Dopri5 { max_steps, ..Dopri5::new(1e-5, 1e-5) });
    check(&Dop853 { max_steps, ..Dop853::new(1e-5, 1e-5) });
    check(&Rk4 { max_steps, ..Rk4::new(0.1) });
    check(&GaussLegendre4 { max_steps, ..GaussLegendre4::new(0.1) });
    check(&StormerVerlet { max_steps, ..StormerVerlet::new(0.1) });
    check(&SemiImplicitEuler { max_steps, ..SemiImplicitEuler::new(0.1) });
}

#[cfg(feature = "std")]
#[test]
fn vectors_and_arrays_give_the_same_bits() {
    let (mut array, mut vector) =
        (State::new([1.0, 0.2], [0.0, 0.1]), State::new(std::vec![1.0, 0.2], std::vec![0.0, 0.1]));
    fn pull(q: &[f64], qdd: &mut [f64]) {
        qdd[0] = -q[0] + 0.1 * q[1].sin();
        qdd[1] = -2.0 * q[1] * q[0];
    }
    let dop853 = Dop853::new(1e-9, 1e-9);
    let go_on = |_: &mut dyn Step<_>| ControlFlow::Continue(());
    let a = dop853.integrate(|_, q: &[f64; 2], _, qdd| pull(q, qdd), 0.0, 10.0, &mut array, go_on);
    let b = dop853.integrate(|_, q, _, qdd| pull(q, qdd), 0.0, 10.0, &mut vector, |_| ControlFlow::Continue(()));
    assert_eq!(a, b);
    assert_eq!((&array.q[..], &array.qd[..]), (&vector.q[..], &vector.qd[..]));
    vector.q.push(0.0);
    let result = dop853.integrate(|_, q, _, qdd| pull(q, qdd), 0.0, 1.0, &mut vector, |_| ControlFlow::Continue(()));
    assert_eq!(result, Err(IntegrationError::DimensionMismatch { coordinates: 3, velocities: 2 }));
}

#[test]
fn observers_and_accelerations_stop_with_errors_of_their_own() {
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct TooFar(f64);
    fn check(integrator: &impl Integrator<f64>) {
        // The observer's error comes at once, with the state that it saw.
        let mut state = State::new([1.0], [0.0]);
        let watched = |step: &mut dyn Step<[f64; 1]>| {
            let q = step.state().q[0];
            if q < 0.5 { Err(TooFar(q)) } else { Ok(ControlFlow::Continue(())) }
        };
        let result = integrator.integrate(oscillate, 0.0, 5.0, &mut state, watched);
        let Err(IntegrationError::Stopped { time, error: TooFar(q) }) = result else { panic!("{result:?}") };
        assert!(q == state.q[0] && (q - Scalar::cos(time)).abs() < 1e-4, "{state:?} {time}");

        // The right-hand side's as soon as no shorter step helps; both may err, in the same way.
        let mut state = State::new([1.0], [0.0]);
        let refusing = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| {
            qdd[0] = -q[0];
            if q[0] < 0.5 { Err(TooFar(q[0])) } else { Ok(()) }
        };
        let result = integrator.integrate(refusing, 0.0, 5.0, &mut state, |_| Ok(ControlFlow::Continue(())));
        let Err(IntegrationError::Stopped { error: TooFar(q), .. }) = result else { panic!("{result:?}") };
        assert!(q < 0.5 && state.q[0] >= 0.5);
        let mut state = State::new([1.0], [0.0]);
        let again = integrator.sample(refusing, 0.0, &[5.0], &mut state, |_, _| {});
        assert!(matches!(again, Err(IntegrationError::Stopped { error: TooFar(_), .. })), "{again:?}");
        assert_eq!(
            result.map_err(|error| error.map(|TooFar(q)| q < 0.5)).unwrap_err().time(),
            again.unwrap_err().time()
        );
    }
    check(&Dopri5::new(1e-9, 1e-9));
    check(&SemiImplicitEuler::new(1e-5));
    check(&StormerVerlet::new(0.01));
    check(&GaussLegendre4::new(0.0123));
    check(&Dop853::new(1e-9, 1e-9));
    check(&Rk4::new(0.01));
}
