//! Integration of `q̈ = f(t, q, q̇)` over time.
//!
//! An [`Integrator`] is a small set of settings; one method per file:
//!
//! | method | step | file |
//! |--------|------|------|
//! | [`SemiImplicitEuler`](crate::SemiImplicitEuler) | fixed; order 1, symplectic; any [`Scalar`] | `semi_implicit_euler.rs` |
//! | [`StormerVerlet`](crate::StormerVerlet) | fixed; order 2, symplectic, for `f(t, q)`; any [`Scalar`] | `verlet.rs` |
//! | [`Rk4`](crate::Rk4) | fixed; order 4; any [`Scalar`], lanes too | `rk4.rs` |
//! | [`GaussLegendre4`](crate::GaussLegendre4) | fixed; order 4, symplectic, implicit | `gauss_legendre.rs` |
//! | [`Dopri5`](crate::Dopri5) | by error control; order 5, dense output of order 4 | `dopri5.rs` |
//! | [`Dop853`](crate::Dop853) | by error control; order 8, dense output of order 7 | `dop853.rs` |
//!
//! The right-hand side is a closure `|t, q, qd, qdd|` that writes the accelerations into its last argument. It returns
//! nothing, or a `Result<(), SingularMassMatrix>`. Time is `f64` whatever the scalar, so that a long run of `f32` keeps
//! its clock; the closure gets it as a scalar.
//!
//! After each accepted step an observer sees the [`Step`]: its two ends, and the solution between them. It goes on with
//! `ControlFlow::Continue(())`, or ends the integration at a time of its choice inside the step with
//! `ControlFlow::Break(time)`.
//!
//! Whatever happens, the caller's [`State`] is the last accepted one afterwards. Nothing is allocated in a step: what
//! an integrator needs is cloned from the initial state when it starts.

use core::ops::ControlFlow;

use crate::error::{IntegrationError, SingularMassMatrix};
use crate::event::{Event, Watch};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

mod adaptive;
mod compensation;
pub(crate) mod dop853;
pub(crate) mod dopri5;
mod fixed;
pub(crate) mod gauss_legendre;
mod hermite;
#[cfg(all(test, feature = "std"))]
mod long_runs;
#[cfg(all(test, feature = "std"))]
mod projected;
pub(crate) mod rk4;
mod run;
pub(crate) mod semi_implicit_euler;
pub(crate) mod verlet;

/// A method that integrates `q̈ = f(t, q, q̇)`.
pub trait Integrator<T: Scalar> {
    /// Carries `state` from the time `t` to `t_end`, which may lie before `t`; the last step ends exactly there.
    ///
    /// | argument       | meaning                                                    | unit |
    /// |----------------|------------------------------------------------------------|------|
    /// | `acceleration` | writes `q̈ = f(t, q, q̇)` into its last argument             |      |
    /// | `t`, `t_end`   | first and last time                                        | s    |
    /// | `state`        | `(q, q̇)` at `t`, afterwards at [`Summary::time`]           |      |
    /// | `observer`     | called after each accepted step; `Break(time)` ends at `time` |   |
    ///
    /// ```
    /// use core::ops::ControlFlow;
    /// use mbs_runtime::{Dop853, Integrator, State};
    ///
    /// // A stone falls from 20 m. Where is it after a second, and what if a net catches it 5 m above the ground?
    /// let fall = |_, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -10.0;
    /// let dop853 = Dop853::new(1e-10, 1e-12);
    /// let mut stone = State::new([20.0], [0.0]);
    /// dop853.integrate(fall, 0.0, 1.0, &mut stone, |_| ControlFlow::Continue(())).unwrap();
    /// assert!((stone.q[0] - 15.0).abs() < 1e-12);
    ///
    /// let caught = 3.0_f64.sqrt(); // an event in earnest searches for the root of the interpolant
    /// let summary = dop853.integrate(fall, 1.0, 2.0, &mut stone, |step| {
    ///     if step.state().q[0] < 5.0 { ControlFlow::Break(caught) } else { ControlFlow::Continue(()) }
    /// });
    /// assert!(summary.unwrap().stopped && (stone.q[0] - 5.0).abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// [`IntegrationError`]; `state` is then the last accepted one.
    fn integrate<V, F, R, O>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        observer: O,
    ) -> Result<Summary, IntegrationError>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome,
        O: FnMut(&mut dyn Step<V>) -> ControlFlow<f64>;

    /// Carries `state` from the time `t` to the last of `times` and hands out the solution at each of them.
    ///
    /// `times` go one way from `t`, forwards or backwards; one that is repeated is handed out again. They do not limit
    /// the step: what lies inside a step is interpolated.
    ///
    /// ```
    /// use mbs_runtime::{Dop853, Integrator, State};
    ///
    /// let mut heights = [0.0; 3];
    /// let mut i = 0;
    /// Dop853::new(1e-10, 1e-12)
    ///     .sample(|_, _, _, qdd| qdd[0] = -10.0, 0.0, &[0.0, 1.0, 2.0], &mut State::new([20.0], [0.0]), |_, stone| {
    ///         heights[i] = stone.q[0];
    ///         i += 1;
    ///     })
    ///     .unwrap();
    /// assert!(heights.iter().zip([20.0, 15.0, 0.0]).all(|(x, y): (&f64, f64)| (x - y).abs() < 1e-12));
    /// ```
    ///
    /// # Errors
    /// [`IntegrationError::InvalidTime`] if `times` turn back; otherwise as [`integrate`](Integrator::integrate).
    fn sample<V, F, R>(
        &self,
        acceleration: F,
        t: f64,
        times: &[f64],
        state: &mut State<V>,
        mut output: impl FnMut(f64, &State<V>),
    ) -> Result<Summary, IntegrationError>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome,
    {
        let t_end = times.last().copied().unwrap_or(t);
        check_input(t, t_end, state)?;
        check_order(t, times, t_end)?;
        let mut sampled = state.clone();
        let mut times = times.iter().copied().peekable();
        while times.next_if_eq(&t).is_some() {
            output(t, state);
        }
        self.integrate(acceleration, t, t_end, state, |step| {
            let end = step.time();
            while let Some(time) = times.next_if(|&time| is_between(t, time, end)) {
                if step.interpolate(time, &mut sampled).is_err() {
                    return ControlFlow::Break(end);
                }
                output(time, &sampled);
            }
            ControlFlow::Continue(())
        })
    }

    /// [`integrate`](Integrator::integrate), with events: where their functions pass zero they happen.
    ///
    /// Each event is found on the dense output of the step, to the resolution of the clock, and its action may change
    /// the state, have the rest of the step made anew, or end the integration; see [`event`](crate::event) for what is
    /// found and what is not. Looking between the ends of steps costs the interpolant of each of them: three
    /// evaluations for
    /// [`Dop853`](crate::Dop853), two for [`GaussLegendre4`](crate::GaussLegendre4), none for the others.
    ///
    /// The observer sees each step after its events: as far as the one from which the integration goes on anew, with
    /// the state before its action. `replace` does not undo an action there. An event that never happens is no error:
    /// its
    /// [`count`](Event::count) is 0.
    ///
    /// ```
    /// use core::ops::ControlFlow;
    /// use mbs_runtime::{Dop853, Event, Integrator, State};
    ///
    /// // A stone falls from 20 m. When does it arrive?
    /// let fall = |_, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -10.0;
    /// let mut stone = State::new([20.0], [0.0]);
    /// let mut ground = [Event::new(&|_, stone: &State<[f64; 1]>| stone.q[0]).falling().terminal()];
    /// let summary = Dop853::new(1e-10, 1e-12)
    ///     .integrate_with_events(fall, 0.0, 60.0, &mut stone, &mut ground, |_| ControlFlow::Continue(()))
    ///     .unwrap();
    /// assert!(summary.stopped && (summary.time - 2.0).abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// [`IntegrationError::NonFiniteEvent`] if an event's function is infinite or NaN,
    /// [`IntegrationError::EventsAccumulate`] if one follows itself too closely, [`IntegrationError::NonFiniteState`]
    /// if an action leaves such numbers; otherwise as [`integrate`](Integrator::integrate).
    fn integrate_with_events<V, F, R, O>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        events: &mut [Event<'_, V>],
        mut observer: O,
    ) -> Result<Summary, IntegrationError>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome,
        O: FnMut(&mut dyn Step<V>) -> ControlFlow<f64>,
    {
        let mut watch = Watch::new(events, state);
        let result = self.integrate(acceleration, t, t_end, state, |step| watch.observe(step, &mut observer));
        watch.conclude(result)
    }
}

/// One accepted step, as an observer sees it.
pub trait Step<V: Coordinates> {
    /// The time at which the step began \[s\].
    fn previous_time(&self) -> f64;

    /// The time at which the step ends \[s\].
    fn time(&self) -> f64;

    /// The state at the beginning.
    fn previous_state(&self) -> &State<V>;

    /// The state at the end.
    fn state(&self) -> &State<V>;

    /// Writes the solution at the time `t` inside the step; exact at both ends.
    ///
    /// The first call in a step evaluates what the interpolant needs: three accelerations for
    /// [`Dop853`](crate::Dop853), two for [`GaussLegendre4`](crate::GaussLegendre4), for [`Rk4`](crate::Rk4) the one
    /// that the next step begins with; none for the others.
    ///
    /// # Errors
    /// [`IntegrationError::InvalidTime`] if `t` is not inside the step; [`IntegrationError::NonFiniteState`] or
    /// [`IntegrationError::SingularMassMatrix`] if there is no acceleration where the interpolant needs one. `state` is
    /// then untouched. The integration ends with this error, too, when the observer returns, whatever it returns.
    fn interpolate(&mut self, t: f64, state: &mut State<V>) -> Result<(), IntegrationError>;

    /// Goes on from `state` instead of the end of the step: for a projection onto constraints, or a jump.
    ///
    /// The solution inside the step stays what it was. `Break(time)` with a time before the end drops it. A state that
    /// is not finite is not taken: the integration ends with [`IntegrationError::NonFiniteState`].
    fn replace(&mut self, state: &State<V>);

    /// Goes on from `state` at the time `t` inside the step, and drops what came after it: for an impact.
    ///
    /// The solution inside the step stays what it was. `Break(t)` with this time ends the integration with `state`.
    ///
    /// # Errors
    /// [`IntegrationError::InvalidTime`] if `t` is not inside the step, [`IntegrationError::NonFiniteState`] if the
    /// state is not finite; the integration ends with this error, too.
    fn restart(&mut self, t: f64, state: &State<V>) -> Result<(), IntegrationError>;
}

/// What an integration did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Summary {
    /// The time of the final state \[s\].
    pub time: f64,
    /// True where the observer ended the integration.
    pub stopped: bool,
    /// The number of accelerations evaluated, those of the interpolant included.
    pub evaluations: usize,
    /// The number of accepted steps.
    pub accepted: usize,
    /// The number of rejected steps.
    pub rejected: usize,
    /// A good length of the first step for whoever goes on from here, positive \[s\]; 0 where no step was made.
    pub next_step: f64,
}

/// What an acceleration closure returns: nothing, or whether it could be computed.
pub trait Outcome {
    /// The same as a `Result`.
    ///
    /// # Errors
    /// [`SingularMassMatrix`] if there is no acceleration.
    fn into_result(self) -> Result<(), SingularMassMatrix>;
}

impl Outcome for () {
    #[inline]
    fn into_result(self) -> Result<(), SingularMassMatrix> {
        Ok(())
    }
}

impl Outcome for Result<(), SingularMassMatrix> {
    #[inline]
    fn into_result(self) -> Result<(), SingularMassMatrix> {
        self
    }
}

/// Refuses what no method can start from.
fn check_input<V: Coordinates>(t: f64, t_end: f64, state: &State<V>) -> Result<(), IntegrationError> {
    for time in [t, t_end] {
        if !time.is_finite() {
            return Err(IntegrationError::InvalidTime { time });
        }
    }
    let (coordinates, velocities) = (state.q.as_slice().len(), state.qd.as_slice().len());
    if coordinates != velocities {
        return Err(IntegrationError::DimensionMismatch { coordinates, velocities });
    }
    if state.is_finite() { Ok(()) } else { Err(IntegrationError::NonFiniteState { time: t }) }
}

/// Refuses output times that do not go one way from `t` to `t_end`.
fn check_order(t: f64, times: &[f64], t_end: f64) -> Result<(), IntegrationError> {
    let mut previous = t;
    for &time in times {
        if !is_between(previous, time, t_end) {
            return Err(IntegrationError::InvalidTime { time });
        }
        previous = time;
    }
    Ok(())
}

/// True where `time` is on the way from `start` to `end`, both included; false for NaN.
pub(crate) fn is_between(start: f64, time: f64, end: f64) -> bool {
    if start <= end { start <= time && time <= end } else { end <= time && time <= start }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
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
        for times in [
            &[0.0, 0.0, 0.1, 0.1, 0.5, 3.0, 7.0][..],
            &[1e-9, 20.0],
            &[-0.1, -0.2, -3.0],
            &[0.0, -1.0, -1.0],
            &[0.0],
            &[],
        ] {
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
        let Err(IntegrationError::SingularMassMatrix { time, pivot, index: 0 }) = result else { panic!("{result:?}") };
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
        let result =
            dop853.integrate(|_, q, _, qdd| pull(q, qdd), 0.0, 1.0, &mut vector, |_| ControlFlow::Continue(()));
        assert_eq!(result, Err(IntegrationError::DimensionMismatch { coordinates: 3, velocities: 2 }));
    }
}
