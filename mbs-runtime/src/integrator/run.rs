//! What all methods share: the right-hand side, a step on its way through the observer, and what goes before and after.

use core::ops::ControlFlow;

use super::{Acceleration, Observer, Step, Summary, check_input, is_between};
use crate::error::IntegrationError;
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// Why a step is refused.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fault<E> {
    Inaccurate,
    NonFinite,
    /// What the right-hand side says.
    NoAcceleration(E),
    /// The stages of an implicit method, after as many iterations.
    NotConverged(usize),
}

impl<E> Fault<E> {
    /// The error to end with, at the last accepted `time`, when a step of length `step` could not be made.
    pub(super) fn at(self, time: f64, step: f64) -> IntegrationError<E> {
        match self {
            Self::Inaccurate => IntegrationError::StepTooSmall { time, step },
            Self::NonFinite => IntegrationError::NonFiniteState { time },
            Self::NoAcceleration(error) => IntegrationError::Stopped { time, error },
            Self::NotConverged(iterations) => IntegrationError::NotConverged { time, iterations },
        }
    }
}

/// The right-hand side, and how often it was evaluated.
pub(super) struct System<F> {
    acceleration: F,
    evaluations: usize,
}

impl<F> System<F> {
    /// `q̈ = f(t, q, q̇)`, finite.
    #[inline]
    pub(super) fn evaluate<V>(&mut self, t: f64, q: &V, qd: &V, qdd: &mut V) -> Result<(), Fault<F::Error>>
    where
        V: Coordinates,
        F: Acceleration<V>,
    {
        self.evaluations += 1;
        (self.acceleration)(V::Scalar::from_f64(t), q, qd, qdd).map_err(Fault::NoAcceleration)?;
        if qdd.is_finite() { Ok(()) } else { Err(Fault::NonFinite) }
    }
}

/// The two ends of an accepted step.
pub(super) struct Span<'a, V> {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) old: &'a State<V>,
    pub(super) new: &'a State<V>,
}

/// A method of one step at a time, with what it carries from step to step.
pub(super) trait Method<V: Coordinates> {
    /// What a step says about its error: nothing, or its size in units of the tolerance.
    type Error;

    /// Makes ready for a step from a state that does not come from this method: the first one, or after a jump.
    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>>;

    /// Makes ready for the step after the one just made; `prepared` where that one was interpolated.
    fn proceed<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
        prepared: bool,
    ) -> Result<(), Fault<F::Error>>;

    /// The step from `old` at the time `t` to `new`, finite, `length` \[s\] later; negative backwards.
    fn advance<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<Self::Error, Fault<F::Error>>;

    /// Evaluates and stores what [`interpolate`](Self::interpolate) needs, if the step has not done so.
    fn prepare<F: Acceleration<V>>(&mut self, _: &mut System<F>, _: &Span<'_, V>) -> Result<(), Fault<F::Error>> {
        Ok(())
    }

    /// The solution at the fraction `theta` of the step.
    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>);
}

/// One integration under way.
pub(super) struct Run<'a, V, F, M, O> {
    pub(super) system: System<F>,
    pub(super) method: M,
    observer: O,
    pub(super) state: &'a mut State<V>,
    new: State<V>,
    /// Where the observer wants to go on from.
    replacement: State<V>,
    pub(super) summary: Summary,
    /// Whether the method knows `state` as the end of its last step, and whether that one was interpolated.
    known: Option<bool>,
    /// How many times in succession the observer went on from where a step had begun.
    idle: usize,
}

/// An observer may have a step made anew from its beginning, but not for ever.
const MOST_IDLE: usize = 1000;

/// How the integration goes on after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// From the end of the step.
    Step,
    /// From a time inside the step.
    Again,
    /// Not at all.
    Stop,
}

impl<'a, V, F, M, O> Run<'a, V, F, M, O>
where
    V: Coordinates,
    F: Acceleration<V>,
    M: Method<V>,
    O: Observer<V, F::Error>,
{
    /// Checks what is given; nothing is evaluated yet.
    pub(super) fn new(
        method: M,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &'a mut State<V>,
        observer: O,
    ) -> Result<Self, IntegrationError<F::Error>> {
        check_input(t, t_end, state).map_err(IntegrationError::widen)?;
        Ok(Self {
            system: System { acceleration, evaluations: 0 },
            method,
            observer,
            new: state.clone(),
            replacement: state.clone(),
            state,
            summary: Summary { time: t, stopped: false, evaluations: 0, accepted: 0, rejected: 0, next_step: 0.0 },
            known: None,
            idle: 0,
        })
    }

    /// Makes the method ready for a step from here.
    #[inline]
    pub(super) fn ready(&mut self) -> Result<(), Fault<F::Error>> {
        let t = self.summary.time;
        match self.known {
            None => self.method.begin(&mut self.system, t, self.state),
            Some(prepared) => self.method.proceed(&mut self.system, t, self.state, prepared),
        }
    }

    /// Tries a step of the length `length`.
    #[inline]
    pub(super) fn advance(&mut self, length: f64) -> Result<M::Error, Fault<F::Error>> {
        self.method.advance(&mut self.system, self.summary.time, length, self.state, &mut self.new)
    }

    /// Accepts the step just made, which ends at the time `end`, and asks the observer.
    #[inline]
    pub(super) fn accept(&mut self, end: f64) -> Result<Next, IntegrationError<F::Error>> {
        let onward = Accepted {
            span: Span { start: self.summary.time, end, old: self.state, new: &self.new },
            system: &mut self.system,
            method: &mut self.method,
            replacement: &mut self.replacement,
            prepared: false,
            origin: None,
            fault: None,
        }
        .observe(&mut self.observer);
        self.state.copy_from(&self.new);
        let Onward { stopped, prepared, origin, error } = onward?;
        if origin.is_some() {
            self.state.copy_from(&self.replacement);
        }
        if let Some(error) = error {
            return Err(error);
        }
        self.known = if origin.is_some() { None } else { Some(prepared) };
        self.idle = if origin == Some(self.summary.time) { self.idle + 1 } else { 0 };
        self.summary.accepted += 1;
        self.summary.time = origin.unwrap_or(end);
        if self.idle > MOST_IDLE {
            return Err(IntegrationError::TooManySteps { time: self.summary.time, steps: self.summary.accepted });
        }
        self.summary.stopped = stopped;
        self.summary.evaluations = self.system.evaluations;
        Ok(match origin {
            _ if stopped => Next::Stop,
            Some(time) if time != end => Next::Again,
            _ => Next::Step,
        })
    }
}

/// A step on its way through the observer.
struct Accepted<'a, V, F: Acceleration<V>, M>
where
    V: Coordinates,
{
    span: Span<'a, V>,
    system: &'a mut System<F>,
    method: &'a mut M,
    replacement: &'a mut State<V>,
    prepared: bool,
    /// The time at which the integration goes on from the replacement.
    origin: Option<f64>,
    fault: Option<IntegrationError<F::Error>>,
}

/// What the observer wants.
struct Onward<E> {
    /// Whether it ended the integration.
    stopped: bool,
    /// Whether the interpolant was prepared.
    prepared: bool,
    /// The time at which the integration goes on, or ends, with the replacement.
    origin: Option<f64>,
    /// What the observer ended it with.
    error: Option<IntegrationError<E>>,
}

impl<V, F, M> Accepted<'_, V, F, M>
where
    V: Coordinates,
    F: Acceleration<V>,
    M: Method<V>,
{
    /// Shows the step to the observer; how the integration goes on.
    #[inline]
    fn observe(
        mut self,
        observer: &mut impl Observer<V, F::Error>,
    ) -> Result<Onward<F::Error>, IntegrationError<F::Error>> {
        let answer = observer(&mut self);
        if let Some(error) = self.fault {
            return Err(error);
        }
        // An error with a time inside the step leaves the state of that time.
        let (last, stopped, error) = match answer {
            Ok(ControlFlow::Continue(())) => (None, false, None),
            Ok(ControlFlow::Break(time)) => (Some(time), true, None),
            Err(error) => (error.time(), true, Some(error)),
        };
        if let Some(time) = last
            && time != self.origin.unwrap_or(self.span.end)
        {
            let Self { span, system, method, replacement, prepared, .. } = &mut self;
            interpolate(span, (system, *method, prepared), time, replacement)?;
            if !self.replacement.is_finite() {
                return Err(IntegrationError::NonFiniteState { time: self.span.end });
            }
            self.origin = Some(time);
        }
        Ok(Onward { stopped, prepared: self.prepared, origin: self.origin, error })
    }

    fn try_interpolate(&mut self, t: f64, state: &mut State<V>) -> Result<(), IntegrationError<F::Error>> {
        interpolate(&self.span, (self.system, self.method, &mut self.prepared), t, state)
    }

    fn go_on_from(&mut self, t: f64, state: &State<V>) -> Result<(), IntegrationError> {
        if !state.is_finite() {
            let error = IntegrationError::NonFiniteState { time: self.span.end };
            self.fault = Some(error.widen());
            return Err(error);
        }
        self.replacement.copy_from(state);
        self.origin = Some(t);
        Ok(())
    }
}

/// Writes the solution at the time `t` inside the step, which has to be `prepared` between its ends.
fn interpolate<V, F, M>(
    span: &Span<'_, V>,
    (system, method, prepared): (&mut System<F>, &mut M, &mut bool),
    t: f64,
    state: &mut State<V>,
) -> Result<(), IntegrationError<F::Error>>
where
    V: Coordinates,
    F: Acceleration<V>,
    M: Method<V>,
{
    let Span { start, end, old, new } = *span;
    if t == end {
        state.copy_from(new);
    } else if t == start {
        state.copy_from(old);
    } else if is_between(start, t, end) {
        if !*prepared {
            method.prepare(system, span).map_err(|fault| fault.at(end, end - start))?;
            *prepared = true;
        }
        let theta = V::Scalar::from_f64((t - start) / (end - start));
        method.interpolate(span, theta, state);
    } else {
        return Err(IntegrationError::InvalidTime { time: t });
    }
    Ok(())
}

impl<V, F, M> Step<V> for Accepted<'_, V, F, M>
where
    V: Coordinates,
    F: Acceleration<V>,
    M: Method<V>,
{
    fn previous_time(&self) -> f64 {
        self.span.start
    }

    fn time(&self) -> f64 {
        self.span.end
    }

    fn previous_state(&self) -> &State<V> {
        self.span.old
    }

    fn state(&self) -> &State<V> {
        self.span.new
    }

    fn interpolate(&mut self, t: f64, state: &mut State<V>) -> Result<(), IntegrationError> {
        self.try_interpolate(t, state).map_err(|error| {
            let seen = match error {
                IntegrationError::InvalidTime { time } => IntegrationError::InvalidTime { time },
                _ => IntegrationError::NonFiniteState { time: self.span.end },
            };
            self.fault = Some(error);
            seen
        })
    }

    fn replace(&mut self, state: &State<V>) {
        // The integration ends with the error when the observer returns.
        let _ = self.go_on_from(self.span.end, state);
    }

    fn restart(&mut self, t: f64, state: &State<V>) -> Result<(), IntegrationError> {
        if !is_between(self.span.start, t, self.span.end) {
            let error = IntegrationError::InvalidTime { time: t };
            self.fault = Some(error.widen());
            return Err(error);
        }
        self.go_on_from(t, state)
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
    use crate::integrator::Integrator;
    use crate::{Dopri5, GaussLegendre4, Rk4, SemiImplicitEuler, StormerVerlet};

    fn swing(_: f64, q: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]) {
        qdd[0] = -q[0].sin() - 0.01 * qd[0];
    }

    /// Where a step ends in a jump, the next one begins as one from a state that is given: to the bit the same motion.
    fn forgets_what_was_before_a_jump(method: impl Integrator<f64>) {
        let (jump, end, after) = (3.125, 40.0, State::new([0.7], [-0.2]));
        let mut state = State::new([1.1], [0.3]);
        let replaced = |step: &mut dyn Step<[f64; 1]>| {
            if step.time() == jump {
                step.replace(&after);
            }
            ControlFlow::Continue(())
        };
        method.integrate(swing, 0.0, end, &mut state, replaced).unwrap();
        let mut fresh = after;
        method.integrate(swing, jump, end, &mut fresh, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(state, fresh);
    }

    #[test]
    fn methods_forget_what_was_before_a_jump() {
        // A power of two, so that all ends of steps are exact.
        let step = 0.03125;
        forgets_what_was_before_a_jump(StormerVerlet::new(step));
        forgets_what_was_before_a_jump(SemiImplicitEuler::new(step));
        forgets_what_was_before_a_jump(GaussLegendre4::new(step));
        forgets_what_was_before_a_jump(Rk4::new(step));
        forgets_what_was_before_a_jump(Dopri5 { first_step: Some(step), max_step: step, ..Dopri5::new(1e-3, 1e-3) });
    }

    #[test]
    fn a_step_is_not_made_anew_for_ever() {
        let mut calls = 0;
        let again = |step: &mut dyn Step<[f64; 1]>| {
            calls += 1;
            assert!(calls < 10 * MOST_IDLE, "it goes on for ever");
            let (start, state) = (step.previous_time(), *step.previous_state());
            step.restart(start, &state).unwrap();
            ControlFlow::Continue(())
        };
        let result = Rk4::new(0.1).integrate(swing, 0.0, 1.0, &mut State::new([1.0], [0.0]), again);
        assert_eq!(result, Err(IntegrationError::TooManySteps { time: 0.0, steps: MOST_IDLE + 1 }));
    }
}
