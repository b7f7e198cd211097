//! Events: where a function of `(t, q, q̇)` passes zero during an integration, and what happens then.
//!
//! [`Integrator::integrate_with_events`](crate::Integrator::integrate_with_events) watches them. In each step the
//! functions are looked at in nine places, both ends and seven between, on the dense output. Where a function has
//! changed its sign from one place to the next, the root is bracketed until two neighbouring times are left (ITP, at
//! most a few iterations more than bisection), so that the time is as good as the dense output and the clock allow.
//!
//! - An event happens where its function reaches zero or passes it, not where it leaves zero: a function that is zero
//!   at the start, or after an impact, waits until it has left zero.
//! - A function that touches zero and turns back is not reliably seen: it counts as reaching zero where one of the nine places
//!   falls on the zero itself, as round numbers and fixed steps let it, and goes unseen otherwise. Watch its derivative pass zero.
//! - Two roots of one function less than an eighth of a step apart may go unseen; `max_step` or `step` of the method
//!   is the remedy. Of three in an eighth one is seen.
//! - Events of one step happen in the order of their times, those of the same time in the order in which they are given.
//! - Where the observer replaces the end of a step, what changes the function by no more than an eighth of the step did is a
//!   correction, such as a projection: an event does not happen twice or not at all for it. What changes it by more is a jump,
//!   and passing zero with it no event.
//! - After an action that changes the state, or says [`Response::Restart`], the rest of the step is dropped, and the
//!   integration goes on from the state it left.
//! - Impacts that accumulate (Zeno: a ball that comes to rest) end with
//!   [`EventsAccumulate`](IntegrationError::EventsAccumulate) when they can no longer be told apart. An action that
//!   leaves the motion at rest on a surface has to take away the force into it as well.
//!
//! The step control does not see events. An error-controlled step is made over an impact first, and cut there.
//!
//! Source: E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, section
//! II.6 (event location); I. F. D. Oliveira and R. H. C. Takahashi, *An enhancement of the bisection method average
//! performance preserving minmax optimality*, ACM Transactions on Mathematical Software 47:1, 2020, algorithm 1 (ITP).

use core::fmt;
use core::ops::ControlFlow;

use crate::error::IntegrationError;
use crate::integrator::{Step, is_between};
use crate::state::{Coordinates, State};

/// Into how many parts a step is divided to look for changes of sign.
const PARTS: usize = 8;

/// Which changes of sign count, in the direction of the integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Direction {
    /// All.
    #[default]
    Any,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

/// How the integration goes on after an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Goes on; from the state that the action left if it changed it.
    Continue,
    /// Goes on from the time of the event in a new step: the right-hand side has changed.
    Restart,
    /// Ends at the time of the event, with the state that the action left.
    Stop,
}

/// What happens at an event.
type Action<'a, V> = dyn FnMut(f64, &mut State<V>) -> Response + 'a;

/// A function of `(t, q, q̇)` whose zeros are to be found, and what happens there.
///
/// ```
/// use core::ops::ControlFlow;
/// use mbs_runtime::{Dopri5, Event, Integrator, Response, State};
///
/// // A ball falls from 5 m, bounces off the floor with a third of its speed less, three times, and is caught at the top.
/// let mut bounce = |_, ball: &mut State<[f64; 1]>| {
///     ball.qd[0] *= -2.0 / 3.0;
///     Response::Continue
/// };
/// let mut bounces = 0;
/// let mut count = |_, _: &mut State<[f64; 1]>| {
///     bounces += 1;
///     if bounces == 3 { Response::Stop } else { Response::Continue }
/// };
/// let mut events = [
///     Event::new(&|_, ball: &State<[f64; 1]>| ball.q[0]).falling().with_action(&mut bounce),
///     Event::new(&|_, ball: &State<[f64; 1]>| ball.qd[0]).falling().with_action(&mut count),
/// ];
/// let mut ball = State::new([5.0], [0.0]);
/// let summary = Dopri5::new(1e-10, 1e-12)
///     .integrate_with_events(|_, _, _, qdd| qdd[0] = -10.0, 0.0, 60.0, &mut ball, &mut events, |_| {
///         ControlFlow::Continue(())
///     })
///     .unwrap();
/// let height = 5.0 * (4.0_f64 / 9.0).powi(3);
/// assert!(summary.stopped && (ball.q[0] - height).abs() < 1e-9);
/// assert_eq!((events[0].count(), events[1].count()), (3, 3));
/// ```
pub struct Event<'a, V> {
    function: &'a dyn Fn(f64, &State<V>) -> f64,
    direction: Direction,
    terminal: bool,
    action: Option<&'a mut Action<'a, V>>,
    count: usize,
    /// The sign of the function at the time `since`; 0 where it has not left zero yet.
    side: f64,
    since: f64,
    /// Its sign at the next place looked at.
    next: f64,
    /// Its value at the last place looked at, and how far it had come there from the place before.
    value: f64,
    travel: f64,
    /// When it happens in the part of the step that is looked at, or NaN.
    root: f64,
    /// When it happened last; NaN where it has not.
    last: f64,
    /// The sign it came from then, and the time since it had happened before, infinite where that is no impact.
    came: f64,
    gap: f64,
    /// The size of the function then, which is that of its rounding errors.
    residue: f64,
}

impl<'a, V> Event<'a, V> {
    /// The zeros of `function(t, state)`, in both directions, which are counted and nothing else.
    #[must_use]
    pub fn new(function: &'a dyn Fn(f64, &State<V>) -> f64) -> Self {
        Self {
            function,
            direction: Direction::Any,
            terminal: false,
            action: None,
            count: 0,
            side: 0.0,
            since: f64::NAN,
            next: 0.0,
            value: f64::NAN,
            travel: 0.0,
            root: f64::NAN,
            last: f64::NAN,
            came: 0.0,
            gap: f64::INFINITY,
            residue: 0.0,
        }
    }

    /// Counts changes of sign in this direction only.
    #[must_use]
    pub const fn direction(mut self, direction: Direction) -> Self {
        self.direction = direction;
        self
    }

    /// Counts zeros on the way up only.
    #[must_use]
    pub const fn rising(self) -> Self {
        self.direction(Direction::Rising)
    }

    /// Counts zeros on the way down only.
    #[must_use]
    pub const fn falling(self) -> Self {
        self.direction(Direction::Falling)
    }

    /// Ends the integration at the first of them, after its action.
    #[must_use]
    pub const fn terminal(mut self) -> Self {
        self.terminal = true;
        self
    }

    /// Calls `action(t, state)` at each of them. It may change the state, but not the number of coordinates.
    #[must_use]
    pub fn with_action(mut self, action: &'a mut dyn FnMut(f64, &mut State<V>) -> Response) -> Self {
        self.action = Some(action);
        self
    }

    /// How often it happened in the last integration.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// When it happened last in the last integration \[s\].
    #[must_use]
    pub const fn last_time(&self) -> Option<f64> {
        if self.count == 0 { None } else { Some(self.last) }
    }

    /// Whether a change from `side` to `next` counts.
    fn has_root(&self) -> bool {
        self.side != 0.0
            && self.next != self.side
            && match self.direction {
                Direction::Any => true,
                Direction::Rising => self.side < 0.0,
                Direction::Falling => self.side > 0.0,
            }
    }

    /// It happens at the time `root`, at a state where the function is `value`; whether the integration goes on from
    /// there or ends, if either.
    fn happen(&mut self, value: f64, state: &mut State<V>) -> Response {
        self.gap = self.root - self.last;
        (self.last, self.came, self.residue) = (self.root, self.side, value.abs());
        self.count += 1;
        let response = self.action.as_mut().map_or(Response::Continue, |action| action(self.last, state));
        if self.terminal { Response::Stop } else { response }
    }
}

impl<V> fmt::Debug for Event<'_, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event")
            .field("direction", &self.direction)
            .field("terminal", &self.terminal)
            .field("count", &self.count)
            .finish_non_exhaustive()
    }
}

/// The events of one integration.
pub(crate) struct Watch<'e, 'a, V> {
    events: &'e mut [Event<'a, V>],
    /// Whether the next step begins with a state that no event function has seen.
    jumped: bool,
    /// Whether that state stands for the end of the step before, as a projection does.
    replaced: bool,
    /// The state at the time looked at.
    there: State<V>,
    /// The state that the actions left.
    after: State<V>,
    fault: Option<IntegrationError>,
}

/// Where an event ends a step.
#[derive(Clone, Copy)]
struct Cut {
    time: f64,
    /// Whether it ends the integration, too.
    stop: bool,
    /// Whether an action changed the state.
    changed: bool,
}

impl<'e, 'a, V: Coordinates> Watch<'e, 'a, V> {
    pub(crate) fn new(events: &'e mut [Event<'a, V>], like: &State<V>) -> Self {
        for event in events.iter_mut() {
            (event.count, event.last) = (0, f64::NAN);
        }
        Self { events, jumped: true, replaced: false, there: like.clone(), after: like.clone(), fault: None }
    }

    /// The error that ended the integration from here, or else its result.
    pub(crate) fn conclude<S>(self, result: Result<S, IntegrationError>) -> Result<S, IntegrationError> {
        self.fault.map_or(result, Err)
    }

    /// Looks for events in the step, and shows the observer what is left of it.
    pub(crate) fn observe<O>(&mut self, step: &mut dyn Step<V>, observer: &mut O) -> ControlFlow<f64>
    where
        O: FnMut(&mut dyn Step<V>) -> ControlFlow<f64>,
    {
        if self.events.is_empty() {
            return observer(step);
        }
        let cut = match self.look(step) {
            Ok(cut) => cut,
            Err(error) => {
                self.fault = Some(error);
                return ControlFlow::Break(error.time().unwrap_or(step.time()));
            }
        };
        let mut part = Part { whole: step, there: &self.there, cut, origin: None, fault: None };
        let answer = observer(&mut part);
        let (end, Part { origin, fault, .. }) = (part.time(), part);
        self.fault = fault;
        if fault.is_some() {
            return ControlFlow::Break(end);
        }
        self.jumped = origin.is_some() || cut.is_some();
        self.replaced = cut.is_none() && origin == Some(end);
        match (answer, cut) {
            (ControlFlow::Continue(()), Some(cut)) => {
                let time = origin.unwrap_or(cut.time);
                if origin.is_none() && step.restart(time, &self.after).is_err() {
                    return ControlFlow::Continue(());
                }
                if cut.stop { ControlFlow::Break(time) } else { ControlFlow::Continue(()) }
            }
            (answer, _) => answer,
        }
    }

    /// Lets the events of the step happen, as far as the first one from which a new step begins.
    ///
    /// `there` is then the state at that time as it was, `after` as the actions left it.
    fn look(&mut self, step: &mut dyn Step<V>) -> Result<Option<Cut>, IntegrationError> {
        let (start, end) = (step.previous_time(), step.time());
        if self.jumped {
            self.there.copy_from(step.previous_state());
            self.arm(start)?;
        }
        let mut from = start;
        for part in 1..=PARTS {
            let to = if part == PARTS { end } else { start + (end - start) * (part as f64 / PARTS as f64) };
            for index in 0..self.events.len() {
                if self.events[index].side == 0.0 {
                    self.leave_zero(step, index, from, to)?;
                }
            }
            step.interpolate(to, &mut self.there)?;
            for index in 0..self.events.len() {
                let value = self.value(index, to, from)?;
                let event = &mut self.events[index];
                // What has not left zero yet still has to, beyond rounding.
                let zero = event.side == 0.0 && value.abs() <= 8.0 * event.residue;
                event.next = if zero { 0.0 } else { sign(value) };
                event.travel = (value - event.value).abs();
                event.value = value;
            }
            for index in 0..self.events.len() {
                let root = if self.events[index].has_root() { self.locate(step, index, to)? } else { f64::NAN };
                self.events[index].root = root;
            }
            // NaN is no minimum.
            while let Some(time) = self.first_root(end >= start) {
                step.interpolate(time, &mut self.there)?;
                let cut = self.happen(time)?;
                if cut.is_some() {
                    return Ok(cut);
                }
            }
            for event in self.events.iter_mut() {
                (event.side, event.since) = (event.next, to);
            }
            from = to;
        }
        Ok(None)
    }

    /// The signs at the beginning of a step after a jump, or of the first one; the state is `there`.
    fn arm(&mut self, start: f64) -> Result<(), IntegrationError> {
        for index in 0..self.events.len() {
            let value = self.value(index, start, start)?;
            let event = &mut self.events[index];
            event.since = start;
            let change = (value - event.value).abs();
            event.value = value;
            // A correction keeps the side: where it passes zero the event happens, where it leads back it has happened.
            if self.replaced && event.side != 0.0 && change <= event.travel {
                continue;
            }
            event.side = sign(value);
            if event.last == start && value.abs() <= 8.0 * event.residue {
                event.side = 0.0;
            } else {
                event.residue = 0.0;
            }
        }
        Ok(())
    }

    /// Looks ever farther from `from` for the sign with which the event's function leaves zero.
    ///
    /// Two values in succession, the second the larger one, are believed, if they exceed the rounding errors.
    fn leave_zero(&mut self, step: &mut dyn Step<V>, index: usize, from: f64, to: f64) -> Result<(), IntegrationError> {
        let length = to - from;
        let mut distance = (2.0 * resolution(from, to)).max(1e-14 * length.abs());
        let mut previous = 0.0_f64;
        while distance < length.abs() {
            let time = from + distance.copysign(length);
            step.interpolate(time, &mut self.there)?;
            let value = self.value(index, time, from)?;
            let event = &mut self.events[index];
            if value.abs() <= 8.0 * event.residue {
                previous = 0.0;
            } else if value * previous.signum() > previous.abs() && previous != 0.0 {
                (event.side, event.since) = (sign(value), time);
                // An impact that leads through the surface all the same, soon after the one before, was the last one.
                if event.last == from && event.side != event.came && event.gap.abs() < 1e3 * distance {
                    return Err(IntegrationError::EventsAccumulate { time: from, event: index });
                }
                return Ok(());
            } else {
                previous = value;
            }
            distance *= 4.0;
        }
        Ok(())
    }

    /// The time between `since` and `to` at which the event's function changes its sign: the last one found before it,
    /// or where it is zero.
    ///
    /// ITP: bisection, where the regula falsi, moved towards the middle, has a say as long as it does no harm.
    fn locate(&mut self, step: &mut dyn Step<V>, index: usize, to: f64) -> Result<f64, IntegrationError> {
        let Event { side, since, .. } = self.events[index];
        // The function positive before the root and negative after; rounding errors do not count.
        let mut value = |time: f64| -> Result<f64, IntegrationError> {
            step.interpolate(time, &mut self.there)?;
            Ok(side * self.value(index, time, since)?)
        };
        let (mut a, mut b) = (since, to);
        let (mut at_a, mut at_b) = (value(a)?.max(0.0), value(b)?.min(0.0));
        let tolerance = f64::EPSILON * a.abs().max(b.abs());
        let pull = 0.2 / (b - a).abs();
        let mut bound = tolerance.max(f64::MIN_POSITIVE);
        while bound < (b - a).abs() {
            bound *= 2.0;
        }
        while (b - a).abs() > 2.0 * tolerance && at_b != 0.0 {
            let (middle, width) = (a + 0.5 * (b - a), (b - a).abs());
            let falsi = if at_a > 0.0 { a + (b - a) * (at_a / (at_a - at_b)) } else { middle };
            let inwards = middle - falsi;
            let moved = falsi + inwards.abs().min(pull * width * width).copysign(inwards);
            let radius = bound - 0.5 * width;
            let x = if (moved - middle).abs() <= radius { moved } else { middle - radius.copysign(inwards) };
            let x = if is_between(a, x, b) && x != a && x != b { x } else { middle };
            if x == a || x == b {
                break;
            }
            let at_x = value(x)?;
            if at_x > 0.0 {
                (a, at_a) = (x, at_x)
            } else {
                (b, at_b) = (x, at_x)
            }
            bound *= 0.5;
        }
        Ok(if at_b == 0.0 { b } else { a })
    }

    /// The earliest root that has not happened yet.
    fn first_root(&self, forwards: bool) -> Option<f64> {
        let roots = self.events.iter().map(|event| event.root).filter(|root| !root.is_nan());
        roots.reduce(|x, y| if forwards { x.min(y) } else { x.max(y) })
    }

    /// Lets the events with this root happen, at the state `there`.
    fn happen(&mut self, time: f64) -> Result<Option<Cut>, IntegrationError> {
        self.after.copy_from(&self.there);
        let (mut stop, mut restart, mut changed) = (false, false, false);
        for index in 0..self.events.len() {
            if self.events[index].root != time {
                continue;
            }
            let value = self.value(index, time, time)?;
            let event = &mut self.events[index];
            let too_soon = (time - event.last).abs() <= resolution(time, event.last);
            let response = event.happen(value, &mut self.after);
            event.root = f64::NAN;
            let jump = !equal(&self.after, &self.there);
            if !jump {
                event.gap = f64::INFINITY;
            }
            if !self.after.is_finite() {
                return Err(IntegrationError::NonFiniteState { time });
            }
            if too_soon && response != Response::Stop {
                return Err(IntegrationError::EventsAccumulate { time, event: index });
            }
            stop |= response == Response::Stop;
            restart |= response == Response::Restart;
            changed |= jump;
        }
        Ok((stop || restart || changed).then_some(Cut { time, stop, changed }))
    }

    /// The event's function at the state `there`; where it is not finite, the last good time is `good`.
    fn value(&self, index: usize, time: f64, good: f64) -> Result<f64, IntegrationError> {
        let value = (self.events[index].function)(time, &self.there);
        if value.is_finite() { Ok(value) } else { Err(IntegrationError::NonFiniteEvent { time: good, event: index }) }
    }
}

/// Times closer than this are not told apart \[s\]; false for NaN in comparisons.
fn resolution(a: f64, b: f64) -> f64 {
    16.0 * f64::EPSILON * a.abs().max(b.abs())
}

/// −1, 0 or 1.
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Whether the states are the same, number by number.
fn equal<V: Coordinates>(a: &State<V>, b: &State<V>) -> bool {
    a.q.as_slice() == b.q.as_slice() && a.qd.as_slice() == b.qd.as_slice()
}

/// A step as far as the event that cuts it.
struct Part<'a, V> {
    whole: &'a mut dyn Step<V>,
    /// The state at the cut, before the actions.
    there: &'a State<V>,
    cut: Option<Cut>,
    /// The time from which the observer wants to go on with a state of its own.
    origin: Option<f64>,
    fault: Option<IntegrationError>,
}

impl<V: Coordinates> Part<'_, V> {
    /// Refuses times after the cut.
    fn check(&mut self, t: f64) -> Result<(), IntegrationError> {
        if is_between(self.previous_time(), t, self.time()) {
            return Ok(());
        }
        self.refuse(IntegrationError::InvalidTime { time: t })
    }

    /// Refuses states to go on from that are not finite.
    fn check_state(&mut self, state: &State<V>) -> Result<(), IntegrationError> {
        if state.is_finite() {
            return Ok(());
        }
        self.refuse(IntegrationError::NonFiniteState { time: self.time() })
    }

    fn refuse(&mut self, error: IntegrationError) -> Result<(), IntegrationError> {
        self.fault = Some(error);
        Err(error)
    }
}

impl<V: Coordinates> Step<V> for Part<'_, V> {
    fn previous_time(&self) -> f64 {
        self.whole.previous_time()
    }

    fn time(&self) -> f64 {
        self.cut.map_or(self.whole.time(), |cut| cut.time)
    }

    fn previous_state(&self) -> &State<V> {
        self.whole.previous_state()
    }

    fn state(&self) -> &State<V> {
        if self.cut.is_some() { self.there } else { self.whole.state() }
    }

    fn interpolate(&mut self, t: f64, state: &mut State<V>) -> Result<(), IntegrationError> {
        self.check(t)?;
        self.whole.interpolate(t, state)
    }

    fn replace(&mut self, state: &State<V>) {
        if self.check_state(state).is_err() {
            return;
        }
        match self.cut {
            None => {
                self.origin = Some(self.whole.time());
                self.whole.replace(state);
            }
            // An impact is not undone.
            Some(Cut { changed: true, .. }) => {}
            Some(Cut { time, .. }) => {
                // The time is that of the cut, and so inside.
                if self.whole.restart(time, state).is_ok() {
                    self.origin = Some(time);
                }
            }
        }
    }

    fn restart(&mut self, t: f64, state: &State<V>) -> Result<(), IntegrationError> {
        self.check(t)?;
        self.check_state(state)?;
        self.whole.restart(t, state)?;
        self.origin = Some(t);
        Ok(())
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::{Dop853, Dopri5, GaussLegendre4, Integrator, Rk4, SemiImplicitEuler, StormerVerlet, Summary};

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

    /// An alarm that sets itself anew a little later each time: told at once where the clock cannot tell the times apart, and
    /// after a million events in the time of one step where it can.
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
            assert!(
                matches!(error, IntegrationError::EventsAccumulate { event: 0, .. }) && count < 10,
                "{error} {count}"
            );
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
        // A function that is no number from some time on, or from the start.
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
        for (level, correction) in [(1.0001, 2e-4), (0.9999, -2e-4)] {
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
        // A replacement that is no number is refused, at an event, too: the state is the one before.
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
        // Times after the cut are outside the step.
        let mut stop = [Event::new(&height).terminal()];
        let result =
            dop853.integrate_with_events(oscillate, 0.0, 9.0, &mut State::new([1.0], [0.0]), &mut stop, |step| {
                let mut there = State::default();
                if step.time() > 1.57 && step.interpolate(step.time() + 1e-9, &mut there).is_ok() {
                    panic!("an interpolation beyond the event");
                }
                ControlFlow::Continue(())
            });
        assert!(matches!(result, Err(IntegrationError::InvalidTime { .. })), "{result:?}");
    }
}
