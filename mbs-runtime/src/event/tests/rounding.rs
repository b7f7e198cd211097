//! Where an event happens to the last place, and what happens there together, once, and not again.

use super::*;

/// Two balls fall equally deep onto floors of their own, and bounce at the same times but for rounding.
#[test]
fn what_happens_at_one_time_but_for_rounding_is_not_lost() {
    fn check<T: crate::Real>(integrator: &impl Integrator<T>, h: f64, floor: f64) {
        let mut bounces = [0, 1].map(|i| {
            move |_: f64, balls: &mut State<[T; 2]>| {
                balls.qd[i] = balls.qd[i] * T::from_f64(-0.8);
                Response::Continue
            }
        });
        let [first, second] = &mut bounces;
        let low = |_: f64, balls: &State<[T; 2]>| balls.q[0].to_f64();
        let high = |_: f64, balls: &State<[T; 2]>| (balls.q[1] - T::from_f64(floor)).to_f64();
        let mut floors =
            [Event::new(&low).falling().with_action(first), Event::new(&high).falling().with_action(second)];
        let mut balls = State::new([h, h + floor].map(T::from_f64), [T::zero(); 2]);
        let fall = |_: T, _: &[T; 2], _: &[T; 2], qdd: &mut [T; 2]| *qdd = [T::from_f64(-9.81); 2];
        // They land at √(2h/g), and after 2.6 and 3.88 times as long.
        let t_end = 3.0 * (2.0 * h / 9.81).sqrt();
        integrator.integrate_with_events(fall, 0.0, t_end, &mut balls, &mut floors, go_on).unwrap();
        assert_eq!([floors[0].count(), floors[1].count()], [2, 2], "{h} {floor}: {balls:?}");
    }
    check::<f64>(&Dopri5::new(1e-8, 1e-10), 4.35, 0.44);
    for k in 1..300 {
        let (h, floor) = (0.03 * f64::from(k), 0.17 * f64::from(k % 20 - 10));
        check::<f64>(&Dop853::new(1e-10, 1e-12), h, floor);
        check::<f64>(&Rk4::new(0.05), h, floor);
        check::<f32>(&Dopri5::new(1e-5, 1e-6), h, floor);
        check::<f32>(&GaussLegendre4::new(0.05), h, floor);
    }
}

/// One event is counted, the other one begins a new step at the same place, whose function is written differently.
#[test]
fn a_surface_written_twice_is_passed_once() {
    fn check(w: f64, phase: f64, level: f64, t_end: f64, second: &dyn Fn(f64, &One) -> f64) {
        let first = |_: f64, state: &One| state.q[0] - level;
        let mut restart = |_, _: &mut One| Response::Restart;
        let mut events = [Event::new(&first), Event::new(second).with_action(&mut restart)];
        let mut state = State::new([phase.cos()], [-w * phase.sin()]);
        let swing = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -w * w * q[0];
        Dop853::new(1e-10, 1e-12).integrate_with_events(swing, 0.0, t_end, &mut state, &mut events, go_on).unwrap();
        // cos α = level at α = ± acos level + 2πk.
        let passed = |angle: f64| {
            let turns = |alpha: f64| ((alpha - angle) / core::f64::consts::TAU).floor();
            turns(w * t_end + phase) - turns(phase)
        };
        let expected = (passed(level.acos()) + passed(-level.acos())) as usize;
        assert_eq!([events[0].count(), events[1].count()], [expected; 2], "{w} {phase} {level}");
    }
    let (w, level) = (2.6212017531536516, -0.8114746661045938);
    check(w, 2.9475111657203845, level, 30.0, &|_, state| state.q[0].sin() - level.sin());
    for k in 0..60 {
        let (w, level) = (0.5 + 0.061 * f64::from(k), (0.37 * f64::from(k)).sin());
        for phase in [0.3, 2.1] {
            check(w, phase, level, 20.0, &|_, state| state.q[0].sin() - level.sin());
            check(w, phase, level, 20.0, &|_, state| (state.q[0] - level).powi(3));
        }
    }
}

/// Where a function stays zero it happens when it gets there, and again after it has left zero.
#[test]
fn a_function_that_stays_zero_happens_where_it_reaches_zero() {
    fn check(integrator: &impl Integrator<f64>) {
        let drift = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
        let saturated = |_: f64, state: &One| state.q[0].max(0.0);
        let switch = |t: f64, _: &One| if t < 1.0 { 1.0 } else { 0.0 };
        for function in [&saturated as &dyn Fn(f64, &One) -> f64, &switch] {
            let mut state = State::new([1.0], [-1.0]);
            let mut events = [Event::new(function).terminal()];
            let summary = integrator.integrate_with_events(drift, 0.0, 9.0, &mut state, &mut events, go_on).unwrap();
            assert!((summary.time - 1.0).abs() < 1e-14 && state.q[0].abs() < 1e-14, "{summary:?} {state:?}");
        }
        // cos t falls to zero at π/2 and 5π/2.
        let mut times = Vec::new();
        let mut note = |t, _: &mut One| {
            times.push(t);
            Response::Continue
        };
        let mut events = [Event::new(&saturated).with_action(&mut note)];
        let mut state = State::new([1.0], [0.0]);
        integrator.integrate_with_events(oscillate, 0.0, 10.0, &mut state, &mut events, go_on).unwrap();
        let expected = [0.5, 2.5].map(|turns| turns * core::f64::consts::PI);
        assert!(times.len() == 2 && times.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-8), "{times:?}");
    }
    check(&Dop853::new(1e-9, 1e-9));
    check(&Dopri5::new(1e-10, 1e-10));
    check(&Rk4::new(0.01));
    check(&GaussLegendre4::new(0.01));
}

/// A motion that a terminal event has ended is gone on with from there: the event does not happen again at once.
#[test]
fn a_motion_goes_on_behind_its_terminal_event() {
    fn check(integrator: &impl Integrator<f64>, tolerance: f64) {
        for level in [0.0, 0.3, -0.7, 0.9995_f64] {
            let direct = move |_: f64, state: &One| state.q[0] - level;
            let curved = move |_: f64, state: &One| state.q[0].sin() - level.sin();
            for function in [&direct as &dyn Fn(f64, &One) -> f64, &curved] {
                let (mut t, mut state) = (0.0, State::new([1.0], [0.0]));
                for turn in 0..6 {
                    // cos α = level at α = ± acos level + 2πk.
                    let turn = core::f64::consts::TAU * f64::from(turn);
                    for expected in [turn + level.acos(), turn + core::f64::consts::TAU - level.acos()] {
                        let mut events = [Event::new(function).terminal(), Event::new(&direct)];
                        let summary = integrator
                            .integrate_with_events(oscillate, t, 100.0, &mut state, &mut events, go_on)
                            .unwrap();
                        t = summary.time;
                        assert!((t - expected).abs() < tolerance, "{level}: {t} for {expected}");
                        assert_eq!([&events[0], &events[1]].map(Event::last_time), [Some(t); 2]);
                        assert_eq!([events[0].count(), events[1].count()], [1, 1]);
                    }
                }
            }
        }
    }
    check(&Dop853::new(1e-10, 1e-12), 1e-6);
    check(&Dopri5::new(1e-10, 1e-12), 1e-6);
    check(&Rk4::new(0.01), 1e-5);
    check(&GaussLegendre4::new(0.01), 1e-5);
}

/// Of an event with three roots in an eighth of a step another one is found than the one that is passed where the
/// motion ends: it ends there all the same.
#[test]
fn a_terminal_event_is_not_moved_to_roots_behind_it() {
    let cubic = |t: f64, _: &One| -(t - 0.03) * (t - 0.06) * (t - 0.1);
    let mut events = [Event::new(&|t, _: &One| t - 0.05).terminal(), Event::new(&cubic)];
    let mut state = State::new([1.0], [0.0]);
    let summary = Rk4::new(1.0).integrate_with_events(oscillate, 0.0, 1.0, &mut state, &mut events, go_on).unwrap();
    assert!((summary.time - 0.05).abs() < 1e-15, "{summary:?}");
    assert_eq!([&events[0], &events[1]].map(Event::last_time), [Some(summary.time); 2]);
}

/// A projection at the cut of an event that begins a new step leads back over the surface: the event has happened.
#[test]
fn a_correction_at_the_cut_does_not_repeat_the_event() {
    for correction in [-1e-6, 1e-6, 0.0] {
        let mut restart = |_, _: &mut One| Response::Restart;
        let ahead = |_: f64, state: &One| state.q[0] - 0.83;
        let mut passed = [Event::new(&ahead).with_action(&mut restart), Event::new(&ahead)];
        let mut state = State::new([0.0], [1.0]);
        let drift = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
        Rk4::new(0.25)
            .integrate_with_events(drift, 0.0, 2.0, &mut state, &mut passed, |step| {
                let State { q, qd } = *step.state();
                step.replace(&State::new([q[0] + correction], qd));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!([passed[0].count(), passed[1].count()], [1, 1], "{correction}");
    }
}

/// A level just above the floor is passed in the eighth of a step in which the ball bounces, and again on the way up.
#[test]
fn a_level_is_passed_on_both_sides_of_an_impact() {
    for step in [0.05, 0.3, 0.8] {
        let mut bounce = |_, ball: &mut One| {
            ball.qd[0] *= -0.8;
            Response::Continue
        };
        for level in [0.02, 0.1, 0.3] {
            let above = |_: f64, ball: &One| ball.q[0] - level;
            let mut events = [Event::new(&height).falling().with_action(&mut bounce), Event::new(&above)];
            let mut ball = State::new([5.0], [0.0]);
            // It bounces at 1 s, 2.6 s and 3.88 s, and is on its way up again until 4.392 s.
            Rk4::new(step).integrate_with_events(fall, 0.0, 4.3, &mut ball, &mut events, go_on).unwrap();
            assert_eq!([events[0].count(), events[1].count()], [3, 6], "{step} {level}: {ball:?}");
        }
    }
}
