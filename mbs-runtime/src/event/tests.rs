use std::vec::Vec;

use super::*;
use crate::{Dop853, Dopri5, GaussLegendre4, Integrator, Rk4, SemiImplicitEuler, StormerVerlet, Summary};

mod rounding;

type One = State<[f64; 1]>;

fn go_on<V: Coordinates>(_: &mut dyn Step<V>) -> ControlFlow<f64> {
    ControlFlow::Continue(())
}

fn fall(_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]) {
    qdd[0] = -10.0;
}

fn oscillate(_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]) {
    qdd[0] = -q[0];
}

fn height(_: f64, ball: &One) -> f64 {
    ball.q[0]
}

/// The times at which a ball bounces that falls from rest at 5 m and keeps the part `restitution` of its speed.
fn bounces(
    integrator: &impl Integrator<f64>,
    restitution: f64,
    t_end: f64,
) -> (Vec<f64>, One, Result<Summary, IntegrationError>) {
    let mut times = Vec::new();
    let mut bounce = |t, ball: &mut One| {
        times.push(t);
        ball.qd[0] *= -restitution;
        Response::Continue
    };
    let mut ball = State::new([5.0], [0.0]);
    let mut floor = [Event::new(&height).falling().with_action(&mut bounce)];
    let result = integrator.integrate_with_events(fall, 0.0, t_end, &mut ball, &mut floor, |step| {
        assert!(step.time() >= step.previous_time());
        assert!(step.state().q[0] >= -1e-12 && step.previous_state().q[0] >= -1e-12, "{:?}", step.state());
        ControlFlow::Continue(())
    });
    assert_eq!(floor[0].count(), times.len());
    (times, ball, result)
}

#[test]
fn a_ball_bounces_when_it_should() {
    fn check(integrator: &impl Integrator<f64>) {
        for (restitution, t_end) in [(0.5, 2.97), (0.9, 10.0), (1.0, 10.0)] {
            let (times, ball, result) = bounces(integrator, restitution, t_end);
            assert_eq!(result.unwrap().time, t_end);
            let (mut expected, mut speed) = (1.0, 10.0);
            for time in &times {
                assert!((time - expected).abs() < 1e-12, "{restitution}: {time} for {expected}");
                speed *= restitution;
                expected += 2.0 * speed / 10.0;
            }
            let since = t_end - (expected - 2.0 * speed / 10.0);
            assert!(times.len() > 1 && expected > t_end && since > 0.0);
            assert!((ball.q[0] - (speed * since - 5.0 * since * since)).abs() < 1e-10, "{ball:?}");
        }
    }
    check(&Dop853::new(1e-10, 1e-12));
    check(&Dopri5::new(1e-10, 1e-12));
    check(&Rk4::new(0.1));
    check(&Rk4::new(10.0));
    check(&StormerVerlet::new(0.013));
    check(&GaussLegendre4::new(0.1));
}

#[test]
fn bounces_that_accumulate_end() {
    // A ball comes to rest at 1 + 2 Σ restitutionⁿ.
    fn check(integrator: &impl Integrator<f64>, restitution: f64) {
        let (times, ball, result) = bounces(integrator, restitution, 50.0);
        let Err(IntegrationError::EventsAccumulate { time, event: 0 }) = result else {
            panic!("{restitution}: {result:?} after {} bounces", times.len())
        };
        let rest = 1.0 + 2.0 * restitution / (1.0 - restitution);
        assert!((time - rest).abs() < 1e-6, "{time} for {rest}");
        assert!(ball.q[0].abs() < 1e-12 && ball.qd[0].abs() < 1e-5, "{ball:?}");
        assert!(times.len() < 1000);
    }
    for restitution in [0.01, 0.1, 0.5, 0.8, 0.95] {
        check(&Dop853::new(1e-10, 1e-12), restitution);
        check(&Dopri5::new(1e-8, 1e-8), restitution);
        check(&Rk4::new(0.1), restitution);
        check(&Rk4::new(60.0), restitution);
        check(&StormerVerlet::new(0.013), restitution);
        check(&GaussLegendre4::new(0.1), restitution);
    }
}

/// The times at which each of two functions passes zero, on `q = cos t`, to `t_end`.
fn passed(direction: Direction, integrator: &impl Integrator<f64>, t_end: f64) -> Vec<(char, f64)> {
    let log = core::cell::RefCell::new(Vec::new());
    let mut position = |t, _: &mut One| {
        log.borrow_mut().push(('q', t));
        Response::Continue
    };
    let mut velocity = |t, _: &mut One| {
        log.borrow_mut().push(('v', t));
        Response::Continue
    };
    let mut events = [
        Event::new(&|_, state: &One| state.qd[0] + 0.5).direction(direction).with_action(&mut velocity),
        Event::new(&|_, state: &One| state.q[0] - 0.5).direction(direction).with_action(&mut position),
    ];
    let mut state = State::new([1.0], [0.0]);
    let summary = integrator.integrate_with_events(oscillate, 0.0, t_end, &mut state, &mut events, go_on).unwrap();
    assert!(!summary.stopped && summary.time == t_end);
    log.into_inner()
}

#[test]
fn directions_and_order_within_a_step() {
    let pi = core::f64::consts::PI;
    // q̇ = −sin t passes −1/2 at π/6 downwards and 5π/6 upwards; q passes 1/2 at π/3 downwards and 5π/3 upwards.
    let falling = [('v', pi / 6.0), ('q', pi / 3.0)];
    let rising = [('v', 5.0 * pi / 6.0), ('q', 5.0 * pi / 3.0)];
    let all = [falling[0], falling[1], rising[0], rising[1]];
    let precise = Dop853 { first_step: Some(1.5), ..Dop853::new(1e-13, 1e-13) };
    for (direction, expected) in
        [(Direction::Falling, &falling[..]), (Direction::Rising, &rising), (Direction::Any, &all)]
    {
        for (method, found) in [
            passed(direction, &precise, 6.0),
            passed(direction, &Dopri5 { max_step: 0.01, ..Dopri5::new(1e-13, 1e-13) }, 6.0),
        ]
        .into_iter()
        .enumerate()
        {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (found, expected) in found.iter().zip(expected) {
                assert_eq!(found.0, expected.0);
                assert!((found.1 - expected.1).abs() < 1e-12, "{method} {direction:?}: {found:?} {expected:?}");
            }
        }
    }
    // One step holds them all.
    let whole = Dop853 { first_step: Some(2.8), ..Dop853::new(1e9, 1e9) };
    let long = passed(Direction::Any, &whole, 2.8);
    assert_eq!(long.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ['v', 'q', 'v']);
    assert!(long.is_sorted_by(|x, y| x.1 < y.1));
    // Backwards in time, directions are those of the way.
    let back = passed(Direction::Falling, &precise, -6.0);
    let expected = [('q', -pi / 3.0), ('v', -7.0 * pi / 6.0)];
    assert_eq!(back.len(), 2);
    for (found, expected) in back.iter().zip(expected) {
        assert!(found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-12, "{back:?}");
    }
}

#[test]
fn a_terminal_event_ends_at_its_time() {
    fn check(integrator: &impl Integrator<f64>, tolerance: f64) {
        let mut ends = Vec::new();
        let mut events = [Event::new(&|_, state: &One| state.q[0]).terminal(), Event::new(&|t, _: &One| t - 1.7)];
        let mut state = State::new([1.0], [0.0]);
        let summary = integrator
            .integrate_with_events(oscillate, 0.0, 10.0, &mut state, &mut events, |step| {
                let mut there = State::default();
                step.interpolate(step.time(), &mut there).unwrap();
                assert_eq!(there, *step.state());
                ends.push(step.time());
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!((summary.time - core::f64::consts::FRAC_PI_2).abs() < tolerance, "{summary:?}");
        assert!(summary.stopped && state.q[0].abs() < 1e-14);
        assert_eq!((events[0].count(), events[1].count()), (1, 0));
        assert_eq!(events[0].last_time(), Some(summary.time));
        assert_eq!((ends.last(), ends.is_sorted()), (Some(&summary.time), true));
    }
    check(&Dop853::new(1e-13, 1e-13), 1e-12);
    check(&Dopri5::new(1e-12, 1e-12), 1e-9);
    check(&Rk4::new(0.01), 1e-9);
    check(&GaussLegendre4::new(0.01), 1e-9);
    check(&StormerVerlet::new(0.01), 1e-4);
    check(&SemiImplicitEuler::new(0.001), 1e-2);
}

#[test]
fn a_zero_at_the_start_does_not_happen() {
    fn check(integrator: &impl Integrator<f64>) {
        // Thrown up from the floor: it lands after 2 s, once, although the whole throw is one step.
        let mut ball = State::new([0.0], [10.0]);
        let mut floor = [Event::new(&height).terminal()];
        let summary = integrator.integrate_with_events(fall, 0.0, 2.5, &mut ball, &mut floor, go_on).unwrap();
        assert!((summary.time - 2.0).abs() < 1e-12, "{summary:?}");
        // Resting, it never lands; and a function that is always zero never happens.
        let mut ball = State::new([0.0], [0.0]);
        let mut floor = [Event::new(&height), Event::new(&|_, _: &One| 0.0), Event::new(&|_, _: &One| 1.0)];
        let rest = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
        let summary = integrator.integrate_with_events(rest, 0.0, 3.0, &mut ball, &mut floor, go_on).unwrap();
        assert!(summary.time == 3.0 && floor.iter().all(|event| event.count() == 0));
    }
    check(&Dop853::new(1e-10, 1e-12));
    check(&Dopri5::new(1e-10, 1e-12));
    check(&Rk4::new(10.0));
    check(&GaussLegendre4::new(0.5));
}

/// A touch counts where a place that is looked at falls on it, and only there.
#[test]
fn a_touch_is_seen_where_a_place_falls_on_it() {
    for (touch, count) in [(0.5, 1), (0.53125, 1), (0.53, 0)] {
        let function = |t: f64, _: &One| (t - touch) * (t - touch);
        let derivative = |t: f64, _: &One| t - touch;
        let mut events = [Event::new(&function), Event::new(&derivative)];
        let mut state = State::new([1.0], [0.0]);
        Rk4::new(0.25).integrate_with_events(oscillate, 0.0, 1.0, &mut state, &mut events, go_on).unwrap();
        assert_eq!([events[0].count(), events[1].count()], [count, 1], "{touch}");
        assert!((events[1].last_time().unwrap() - touch).abs() < 1e-15);
    }
}

/// After an event, values of the size that the function had there are rounding, however often they change their sign.
#[test]
fn what_has_not_left_zero_is_no_event() {
    const NOISE: f64 = 1e-9;
    let function = |t: f64, _: &One| {
        let noise = if t < 1.0 || (8.0 * t) as i64 % 2 == 0 { NOISE } else { -NOISE };
        if t > 2.0 { noise - (t - 2.0) * (t - 4.0) } else { noise * if t == 1.0 { -1.0 } else { 1.0 } }
    };
    for step in [0.3, 1.1, 0.07] {
        let mut restart = |_, _: &mut One| Response::Restart;
        let mut events = [Event::new(&function).with_action(&mut restart)];
        let mut state = State::new([1.0], [0.0]);
        Rk4::new(step).integrate_with_events(oscillate, 0.0, 5.0, &mut state, &mut events, go_on).unwrap();
        assert_eq!(events[0].count(), 2, "{step}: {:?}", events[0].last_time());
        assert!((events[0].last_time().unwrap() - 4.0).abs() < 1e-8, "{:?}", events[0].last_time());
    }
}

/// Two events between two places that are looked at happen in the order of the way.
#[test]
fn order_within_an_eighth_of_a_step_both_ways() {
    for way in [1.0, -1.0] {
        let log = core::cell::RefCell::new(Vec::new());
        let [mut first, mut second] = ['1', '2'].map(|name| {
            let log = &log;
            move |t: f64, _: &mut One| {
                log.borrow_mut().push((name, t));
                Response::Continue
            }
        });
        let [near, far] = [0.51, 0.6].map(|at| move |t: f64, _: &One| t - way * at);
        // Given in the other order.
        let mut events = [Event::new(&far).with_action(&mut second), Event::new(&near).with_action(&mut first)];
        let mut state = State::new([1.0], [0.0]);
        Rk4::new(1.0).integrate_with_events(oscillate, 0.0, way, &mut state, &mut events, go_on).unwrap();
        let log = log.into_inner();
        assert_eq!([log[0].0, log[1].0], ['1', '2'], "{log:?}");
        assert!(log.len() == 2 && (log[0].1 - way * 0.51).abs() < 1e-15, "{log:?}");
    }
}

/// An alarm that sets itself anew a little later each time: told at once where the clock cannot tell the times apart,
/// and after a million events in the time of one step where it can.
#[test]
fn an_alarm_without_progress_is_an_error() {
    fn ring(integrator: &impl Integrator<f64>, later: f64) -> (IntegrationError, usize) {
        let alarm = core::cell::Cell::new(1.0);
        let mut again = |t: f64, _: &mut One| {
            alarm.set(t + later);
            Response::Restart
        };
        let function = |t: f64, _: &One| t - alarm.get();
        let mut events = [Event::new(&function).rising().with_action(&mut again)];
        let mut state = State::new([1.0], [0.0]);
        let result = integrator.integrate_with_events(oscillate, 0.0, 3.0, &mut state, &mut events, go_on);
        let error = result.unwrap_err();
        assert!((error.time().unwrap() - 1.0).abs() < 1e-5 && (state.q[0] - 1.0_f64.cos()).abs() < 1e-3, "{error}");
        (error, events[0].count())
    }
    fn check(integrator: &impl Integrator<f64>) {
        let (error, count) = ring(integrator, 1e-15);
        assert!(matches!(error, IntegrationError::EventsAccumulate { event: 0, .. }) && count < 10, "{error} {count}");
        let (error, count) = ring(integrator, 1e-13);
        assert!(matches!(error, IntegrationError::TooManySteps { .. }), "{error}");
        assert!((900_000..=1_000_100).contains(&count), "{count}");
    }
    check(&Rk4::new(0.1));
    check(&Dopri5::new(1e-9, 1e-9));
}

#[test]
fn a_zero_reached_at_the_end_happens() {
    let mut ball = State::new([5.0], [0.0]);
    let mut alarm = [Event::new(&|t, _: &One| t - 1.5), Event::new(&|t, _: &One| t - 0.75)];
    let summary = Rk4::new(0.25).integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut alarm, go_on).unwrap();
    assert_eq!((summary.time, summary.accepted), (1.5, 6));
    assert_eq!([alarm[0].count(), alarm[1].count()], [1, 1]);
    assert_eq!(alarm[1].last_time(), Some(0.75));
}

#[test]
fn a_right_hand_side_may_change() {
    // The engine stops after 1 s: v = 3 from then on.
    for step in [0.3, 1.0, 7.0] {
        let force = core::cell::Cell::new(3.0);
        let mut cut = |_, _: &mut One| {
            force.set(0.0);
            Response::Restart
        };
        let engine = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = force.get();
        let mut state = State::new([0.0], [0.0]);
        let mut events = [Event::new(&|t, _: &One| t - 1.0).with_action(&mut cut)];
        Rk4::new(step).integrate_with_events(engine, 0.0, 3.0, &mut state, &mut events, go_on).unwrap();
        assert!((state.q[0] - 7.5).abs() < 1e-12 && (state.qd[0] - 3.0).abs() < 1e-12, "{state:?}");
        assert_eq!(events[0].count(), 1);
    }
}

#[test]
fn a_kick_on_the_way_through_is_one_event() {
    // At q = 0 on the way up the speed is doubled: the amplitude doubles each period.
    for integrator in [Dop853::new(1e-11, 1e-12), Dop853 { max_step: 0.1, ..Dop853::new(1e-11, 1e-12) }] {
        let mut kick = |_, state: &mut One| {
            state.qd[0] *= 2.0;
            Response::Continue
        };
        let mut state = State::new([-1.0], [0.0]);
        let mut events = [Event::new(&height).rising().with_action(&mut kick), Event::new(&height)];
        let t_end = 10.0 * core::f64::consts::TAU;
        integrator.integrate_with_events(oscillate, 0.0, t_end, &mut state, &mut events, go_on).unwrap();
        assert_eq!([events[0].count(), events[1].count()], [10, 20]);
        assert!((state.q[0] + 1024.0).abs() < 1e-6, "{state:?}");
    }
}

#[test]
fn events_at_one_time_all_happen() {
    // Into a corner: both velocities turn.
    let mut turn = [0, 1].map(|i| {
        move |_: f64, state: &mut State<[f64; 2]>| {
            state.qd[i] = -state.qd[i];
            Response::Continue
        }
    });
    let [x, y] = &mut turn;
    let mut walls = [
        Event::new(&|_, state: &State<[f64; 2]>| state.q[0]).falling().with_action(x),
        Event::new(&|_, state: &State<[f64; 2]>| state.q[1]).falling().with_action(y),
    ];
    let mut state = State::new([3.0, 1.5], [-2.0, -1.0]);
    let straight = |_: f64, _: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]| *qdd = [0.0; 2];
    Dop853::new(1e-9, 1e-9).integrate_with_events(straight, 0.0, 4.0, &mut state, &mut walls, go_on).unwrap();
    assert!((state.q[0] - 5.0).abs() < 1e-12 && (state.q[1] - 2.5).abs() < 1e-12, "{state:?}");
    assert_eq!([walls[0].count(), walls[1].count()], [1, 1]);
}

#[test]
fn what_goes_wrong_is_an_error() {
    // A function that is NaN from some time on, or from the start.
    for (start, good) in [(1.0, 0.9..=1.0), (-1.0, 0.0..=0.0)] {
        let mut state = State::new([1.0], [0.0]);
        let function = |t: f64, _: &One| if t > start { f64::NAN } else { 1.0 };
        let mut events = [Event::new(&function)];
        let result = Rk4::new(0.1).integrate_with_events(oscillate, 0.0, 3.0, &mut state, &mut events, go_on);
        let Err(IntegrationError::NonFiniteEvent { time, event: 0 }) = result else { panic!("{result:?}") };
        assert!(good.contains(&time) && (state.q[0] - time.cos()).abs() < 1e-6, "{time} {state:?}");
    }
    // An action that leaves NaN: the state is the one before.
    let mut ruin = |_, state: &mut One| {
        state.qd[0] = f64::NAN;
        Response::Continue
    };
    let mut state = State::new([1.0], [0.0]);
    let mut events = [Event::new(&height).with_action(&mut ruin)];
    let result = Rk4::new(0.1).integrate_with_events(oscillate, 0.0, 3.0, &mut state, &mut events, go_on);
    assert!(matches!(result, Err(IntegrationError::NonFiniteState { time }) if (time - 1.57).abs() < 0.01));
    assert!(state.is_finite());
    // Errors of the integration itself come through.
    let mut state = State::new([f64::NAN], [0.0]);
    let result =
        Rk4::new(0.1).integrate_with_events(oscillate, 0.0, 3.0, &mut state, &mut [Event::new(&height)], go_on);
    assert_eq!(result, Err(IntegrationError::NonFiniteState { time: 0.0 }));
}

/// Under the floor, where a step leads before it is cut at the impact, a function may be what it likes.
#[test]
fn a_place_that_the_motion_never_reaches_is_no_error() {
    fn check(integrator: &impl Integrator<f64>) {
        let mut bounce = |_, ball: &mut One| {
            ball.qd[0] *= -0.5;
            Response::Continue
        };
        let (mut times, mut sides) = (Vec::new(), Vec::new());
        let mut note = |t, _: &mut One| {
            times.push(t);
            Response::Continue
        };
        let mut note_side = |t, _: &mut One| {
            sides.push(t);
            Response::Restart
        };
        let mut events = [
            Event::new(&height).falling().with_action(&mut bounce),
            Event::new(&|_, ball: &One| ball.q[0].sqrt() - 0.5).with_action(&mut note),
            Event::new(&|_, ball: &One| 0.5 - ball.q[0].sqrt()).with_action(&mut note_side),
        ];
        let mut ball = State::new([5.0], [0.0]);
        integrator.integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut events, go_on).unwrap();
        // 5 − 5t² = 1/4, and 5s − 5s² = 1/4 with s = t − 1, which is highest at the end.
        let expected = [0.95_f64.sqrt(), 1.0 + 0.5 * (1.0 - 0.8_f64.sqrt())];
        for times in [times, sides] {
            assert!(times.len() == 2 && times.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-12), "{times:?}");
        }
        assert!((ball.q[0] - 1.25).abs() < 1e-10, "{ball:?}");
    }
    check(&Dop853::new(1e-9, 1e-9));
    check(&Dopri5::new(1e-9, 1e-9));
    check(&Rk4::new(0.3));
    check(&Rk4::new(5.0));
    check(&GaussLegendre4::new(0.7));
    // Without a floor it gets there: the events before have happened, and what is left is the last good state.
    let mut ball = State::new([5.0], [0.0]);
    let mut events = [Event::new(&|_, ball: &One| ball.q[0].sqrt() - 0.5), Event::new(&|t, _: &One| t - 0.95)];
    let result = Rk4::new(1.5).integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut events, go_on);
    let Err(IntegrationError::NonFiniteEvent { time, event: 0 }) = result else { panic!("{result:?}") };
    assert!((time - 0.95_f64.sqrt()).abs() < 1e-15 && (ball.q[0] - 0.25).abs() < 1e-12, "{time} {ball:?}");
    assert_eq!([events[0].count(), events[1].count()], [1, 1]);
    // So it does not where one of them ends the motion; what comes later in the same eighth does not happen.
    let mut ball = State::new([5.0], [0.0]);
    let function = |_: f64, ball: &One| ball.q[0].sqrt() - 0.5;
    let mut events = [Event::new(&function).falling().terminal(), Event::new(&|t, _: &One| t - 1.05)];
    let result = Rk4::new(1.5).integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut events, go_on);
    assert!((result.unwrap().time - 0.95_f64.sqrt()).abs() < 1e-15 && (ball.q[0] - 0.25).abs() < 1e-12, "{ball:?}");
    assert_eq!([events[0].count(), events[1].count()], [1, 0]);
}

#[test]
fn the_observer_stops_and_replaces_as_ever() {
    let mut state = State::new([1.0], [0.0]);
    let mut events = [Event::new(&height)];
    let dop853 = Dop853::new(1e-10, 1e-12);
    let summary = dop853
        .integrate_with_events(oscillate, 0.0, 9.0, &mut state, &mut events, |step| {
            if step.time() > 1.0 { ControlFlow::Break(1.0) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    assert!(summary.stopped && summary.time == 1.0 && (state.q[0] - 1.0_f64.cos()).abs() < 1e-9);
    // A replacement on the other side of zero is a jump, and not an event.
    let mut state = State::new([1.0], [0.0]);
    let mut replaced = false;
    dop853
        .integrate_with_events(oscillate, 0.0, 1.5, &mut state, &mut events, |step| {
            if !replaced {
                replaced = true;
                step.replace(&State::new([-1.0], [0.0]));
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(replaced && events[0].count() == 0 && state.q[0] < 0.0);
    // A correction is no jump: what it leads past zero happens, what it leads back has happened. Steps end at 1.
    for (level, correction) in [(1.0001, 2e-4), (0.9999, -2e-4), (1.0, -2e-4)] {
        let ahead = |_: f64, state: &One| state.q[0] - level;
        let mut passed = [Event::new(&ahead), Event::new(&ahead).rising()];
        let mut state = State::new([0.0], [1.0]);
        let drift = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
        Rk4::new(0.25)
            .integrate_with_events(drift, 0.0, 2.0, &mut state, &mut passed, |step| {
                let correction = if step.time() == 1.0 { correction } else { 0.0 };
                let State { q, qd } = *step.state();
                step.replace(&State::new([q[0] + correction], qd));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!([passed[0].count(), passed[1].count()], [1, 1], "{level}");
        assert!((passed[0].last_time().unwrap() - 1.0).abs() < 2e-4, "{:?}", passed[0].last_time());
    }
    // A NaN replacement is refused, at an event, too: the state is the one before.
    let mut dry = [Event::new(&height).terminal()];
    let mut state = State::new([1.0], [0.0]);
    let result = dop853.integrate_with_events(oscillate, 0.0, 9.0, &mut state, &mut dry, |step| {
        if step.state().q[0] < 1e-3 {
            step.replace(&State::new([f64::NAN], [0.0]));
        }
        ControlFlow::Continue(())
    });
    let Err(IntegrationError::NonFiniteState { time }) = result else { panic!("{result:?}") };
    assert!((time - core::f64::consts::FRAC_PI_2).abs() < 1e-9 && state.q[0].abs() < 1e-12, "{state:?}");
}

/// A ball from 5 m bounces at 1 s, and each of three observers ends its step there, or tries to.
#[test]
fn an_observer_ends_no_later_than_the_event() {
    fn ended(end: impl Fn(f64) -> Result<ControlFlow<f64>, char>) -> (Result<Summary, IntegrationError<char>>, One) {
        let mut bounce = |_, ball: &mut One| {
            ball.qd[0] *= -0.5;
            Response::Continue
        };
        let mut floor = [Event::new(&height).falling().with_action(&mut bounce)];
        let mut ball = State::new([5.0], [0.0]);
        let method = Dop853 { first_step: Some(1.5), ..Dop853::new(1e-9, 1e-9) };
        let result = method.integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut floor, |step| end(step.time()));
        assert_eq!(floor[0].count(), 1);
        (result, ball)
    }
    let (late, ball) = ended(|_| Ok(ControlFlow::Break(1.2)));
    assert_eq!(late, Err(IntegrationError::InvalidTime { time: 1.2 }));
    assert!(ball.q[0].abs() < 1e-12, "{ball:?}");
    // The action has been called, and so the state is the one that it left.
    let (there, ball) = ended(|time| Ok(ControlFlow::Break(time)));
    assert!((there.unwrap().time - 1.0).abs() < 1e-12 && (ball.qd[0] - 5.0).abs() < 1e-10, "{ball:?}");
    let (refused, ball) = ended(|_| Err('x'));
    assert!(matches!(refused, Err(IntegrationError::Stopped { error: 'x', .. })) && (ball.qd[0] - 5.0).abs() < 1e-10);
    let (before, ball) = ended(|_| Ok(ControlFlow::Break(0.5)));
    assert!(before.unwrap().time == 0.5 && (ball.q[0] - 3.75).abs() < 1e-12, "{ball:?}");
    // One that goes on from before a terminal event comes to it again.
    let mut floor = [Event::new(&height).terminal()];
    let (mut ball, mut again) = (State::new([5.0], [0.0]), true);
    let summary = Rk4::new(1.5).integrate_with_events(fall, 0.0, 1.5, &mut ball, &mut floor, |step| {
        if core::mem::take(&mut again) {
            step.restart(0.5, &State::new([3.75], [-5.0])).unwrap();
        }
        ControlFlow::Continue(())
    });
    assert!((summary.unwrap().time - 1.0).abs() < 1e-12 && ball.q[0].abs() < 1e-12, "{ball:?}");
    assert_eq!(floor[0].count(), 2);
}

#[test]
fn times_after_an_event_are_outside_the_step() {
    let mut stop = [Event::new(&height).terminal()];
    let dop853 = Dop853::new(1e-10, 1e-12);
    let result = dop853.integrate_with_events(oscillate, 0.0, 9.0, &mut State::new([1.0], [0.0]), &mut stop, |step| {
        let mut there = State::default();
        if step.time() > 1.57 && step.interpolate(step.time() + 1e-9, &mut there).is_ok() {
            panic!("an interpolation beyond the event");
        }
        ControlFlow::Continue(())
    });
    assert!(matches!(result, Err(IntegrationError::InvalidTime { .. })), "{result:?}");
}
