//! Events: where a function of `(t, q, q̇)` passes zero during an integration, and what happens then.
//!
//! [`Integrator::integrate_with_events`](crate::Integrator::integrate_with_events) watches them. In each step the
//! functions are looked at in nine places, both ends and seven between, on the dense output. Where a function has
//! changed its sign from one place to the next, the root is bracketed to some units in the last place of its time (ITP,
//! at most a few iterations more than bisection), so that the time is as good as the dense output and the clock allow.
//!
//! - An event happens where its function reaches zero or passes it, not where it leaves zero: a function that is zero
//!   at the start, or after an impact, waits until it has left zero.
//! - A function that touches zero and turns back is not reliably seen: it counts as reaching zero where one of the nine
//!   places falls on the zero itself, as round numbers and fixed steps let it, and goes unseen otherwise. Watch its
//!   derivative pass zero.
//! - Two roots of one function less than an eighth of a step apart may go unseen; `max_step` or `step` of the method
//!   is the remedy. Of three in an eighth one is seen.
//! - Events of one step happen in the order of their times, those of the same time in the order in which they are
//!   given. Times that the clock does not tell apart are one time. So are the times of events whose functions are all
//!   at or past zero at the first of these times.
//! - Where the observer replaces the end of a step, what changes the function by no more than an eighth of the step did
//!   is a correction, such as a projection: an event does not happen twice or not at all for it. What changes it by
//!   more is a jump, and passing zero with it no event.
//! - After an action that changes the state, or says [`Response::Restart`], the rest of the step is dropped, and the
//!   integration goes on from the state it left.
//! - An event that ends the integration ends it right behind its zero, so that it does not happen again where the
//!   motion is gone on with, of a projected motion where the projected state is behind it; where an action has changed
//!   the state, as at an impact, right before it.
//! - Impacts that accumulate (Zeno: a ball that comes to rest) end with
//!   [`EventsAccumulate`](IntegrationError::EventsAccumulate) when they can no longer be told apart. An action that
//!   leaves the motion at rest on a surface has to take away the force into it as well.
//!
//! The step control does not see events. An error-controlled step is made over an impact first, and cut there: behind
//! it the functions need not be finite.
//!
//! Source: E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, section
//! II.6 (event location); I. F. D. Oliveira and R. H. C. Takahashi, *An enhancement of the bisection method average
//! performance preserving minmax optimality*, ACM Transactions on Mathematical Software 47:1, 2020, algorithm 1 (ITP).

use core::fmt;
use core::ops::ControlFlow;

use crate::error::IntegrationError;
use crate::integrator::{Observer, Step};
use crate::state::{Coordinates, State};

mod location;
mod part;

use location::{resolution, sign};
use part::Part;

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
#[non_exhaustive]
pub enum Response {
    /// Goes on; from the state that the action left if it changed it.
    Continue,
    /// Goes on from the time of the event in a new step: the right-hand side has changed.
    Restart,
    /// Ends right behind the zero; where the action changed the state, at the time of the event with the state it left.
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
/// // A ball falls from 5 m, bounces off the floor with a third of its speed less, three times, is caught at the top.
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
    /// Its sign at the next place looked at; NaN where it is not finite on the way there.
    next: f64,
    /// Its value at the last place looked at, and how far it had come there from the place before.
    value: f64,
    travel: f64,
    /// Its value at the root looked at, before the actions.
    reached: f64,
    /// When it happens in the part of the step that is looked at, or NaN; and the first time found behind it.
    root: f64,
    behind: f64,
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
            reached: f64::NAN,
            root: f64::NAN,
            behind: f64::NAN,
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

    /// Ends the integration right behind the first of them, after its action: see [`Response::Stop`].
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

    /// When it happened last in the last integration \[s\]; where it ended that, the end, which may be some units in
    /// the last place later than what its action was told, of a projected motion by as much as the projection leads
    /// back.
    #[must_use]
    pub const fn last_time(&self) -> Option<f64> {
        if self.count == 0 { None } else { Some(self.last) }
    }

    /// Whether it counts where its function comes from `side` to zero.
    fn is_armed(&self) -> bool {
        self.side != 0.0
            && match self.direction {
                Direction::Any => true,
                Direction::Rising => self.side < 0.0,
                Direction::Falling => self.side > 0.0,
            }
    }

    /// Whether it has not left zero at the time `time` yet, on the way that leads in the direction `way`.
    fn waits(&self, time: f64, way: f64) -> bool {
        self.side == 0.0 || (self.since - time) * way > 0.0
    }

    /// Sees the state at the next place, the time `to`.
    fn look(&mut self, to: f64, state: &State<V>) {
        let value = (self.function)(to, state);
        // What has not left zero yet still has to, beyond rounding.
        let zero = self.side == 0.0 && value.abs() <= 8.0 * self.residue;
        self.next = if zero {
            0.0
        } else if value.is_finite() {
            sign(value)
        } else {
            f64::NAN
        };
        self.travel = (value - self.value).abs();
        self.value = value;
    }

    /// It happens at the time `root`; whether the integration goes on from there or ends, if either.
    fn happen(&mut self, state: &mut State<V>) -> Response {
        self.gap = self.root - self.last;
        (self.last, self.came, self.residue) = (self.root, self.side, self.reached.abs());
        // It has to leave zero first.
        (self.side, self.since, self.root) = (0.0, self.last, f64::NAN);
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
    /// How the next step begins.
    start: Start,
    /// The state at the time looked at.
    there: State<V>,
    /// The state that the actions left.
    after: State<V>,
    /// Brings a state to where the end of a step will be brought; false where there is none.
    correction: Option<&'e mut Correction<'e, V>>,
}

/// A change of a state at a time, if it is possible.
type Correction<'e, V> = dyn FnMut(f64, &mut State<V>) -> bool + 'e;

/// What the state at the beginning of a step has to do with the step before.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// It is where that one ended.
    Same,
    /// It stands for where that one ended, as a projection does.
    Corrected,
    /// It is where an event cut that one.
    Cut,
    /// It has nothing to do with that one.
    Jump,
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
            (event.count, event.last, event.value, event.residue) = (0, f64::NAN, f64::NAN, 0.0);
        }
        Self { events, start: Start::Jump, there: like.clone(), after: like.clone(), correction: None }
    }

    /// Whose ends of steps are corrected, as by a projection.
    pub(crate) fn with_correction(mut self, correction: &'e mut Correction<'e, V>) -> Self {
        self.correction = Some(correction);
        self
    }

    /// Looks for events in the step, and shows the observer what is left of it.
    pub(crate) fn observe<E>(
        &mut self,
        step: &mut dyn Step<V>,
        observer: &mut impl Observer<V, E>,
    ) -> Result<ControlFlow<f64>, IntegrationError<E>> {
        if self.events.is_empty() {
            return observer(step);
        }
        let cut = self.look(step).map_err(IntegrationError::widen)?;
        let mut part = Part { whole: step, there: &self.there, cut, origin: None, fault: None };
        let answer = observer(&mut part);
        if let Ok(ControlFlow::Break(time)) = answer {
            part.check_end(time);
        }
        let (end, Part { origin, fault, .. }) = (part.time(), part);
        if let Some(error) = fault {
            if let Some(Cut { time, .. }) = cut {
                let _ = step.restart(time, &self.there); // a state inside the step, and finite
            }
            return Err(error.widen());
        }
        self.start = match origin {
            None if cut.is_some() => Start::Cut,
            None => Start::Same,
            Some(time) if time == end => Start::Corrected,
            Some(_) => Start::Jump,
        };
        let Some(cut) = cut else { return answer };
        let time = match &answer {
            Ok(ControlFlow::Continue(())) => origin.unwrap_or(cut.time),
            Ok(ControlFlow::Break(time)) => *time,
            Err(error) => error.time().unwrap_or(cut.time),
        };
        if time == cut.time && origin != Some(time) {
            step.restart(time, &self.after).map_err(IntegrationError::widen)?;
        }
        match answer {
            Ok(ControlFlow::Continue(())) if cut.stop && time == cut.time => Ok(ControlFlow::Break(time)),
            answer => answer,
        }
    }

    /// Lets the events of the step happen, as far as the first one from which a new step begins.
    ///
    /// `there` is then the state at that time as it was, `after` as the actions left it.
    fn look(&mut self, step: &mut dyn Step<V>) -> Result<Option<Cut>, IntegrationError> {
        let (start, end) = (step.previous_time(), step.time());
        if self.start != Start::Same {
            self.there.copy_from(step.previous_state());
            self.arm(start, end - start)?;
        }
        let mut from = start;
        for part in 1..=PARTS {
            let to = if part == PARTS { end } else { start + (end - start) * (part as f64 / PARTS as f64) };
            let cut = self.look_between(step, from, to)?;
            if cut.is_some() {
                return Ok(cut);
            }
            from = to;
        }
        Ok(None)
    }

    /// Lets the events between two neighbouring places happen, as far as the first one from which a new step begins.
    fn look_between(&mut self, step: &mut dyn Step<V>, from: f64, to: f64) -> Result<Option<Cut>, IntegrationError> {
        for index in 0..self.events.len() {
            if self.events[index].side == 0.0 {
                self.leave_zero(step, index, from, to)?;
            }
        }
        step.interpolate(to, &mut self.there)?;
        for event in self.events.iter_mut() {
            event.look(to, &self.there);
        }
        for index in 0..self.events.len() {
            self.find_root(step, index, to)?;
        }
        let mut good = from;
        loop {
            // NaN is no minimum.
            let Some(time) = self.first_root(to >= from) else {
                if self.find_hidden_roots(step, to)? {
                    continue;
                }
                break;
            };
            step.interpolate(time, &mut self.there)?;
            if self.gather(step, time, to - from)? {
                continue;
            }
            if let Some(cut) = self.happen(time)? {
                return if cut.stop && !cut.changed { self.pass(step, cut).map(Some) } else { Ok(Some(cut)) };
            }
            good = time;
        }
        // No cut lies before the place where a function is not finite: the motion gets there.
        if let Some(event) = self.events.iter().position(|event| event.next.is_nan()) {
            return Err(IntegrationError::NonFiniteEvent { time: good, event });
        }
        for event in self.events.iter_mut() {
            (event.side, event.since) = (event.next, to);
        }
        Ok(None)
    }

    /// Finds the root of an event before the place `to` that has just been looked at, if there is one.
    fn find_root(&mut self, step: &mut dyn Step<V>, index: usize, to: f64) -> Result<(), IntegrationError> {
        let event = &mut self.events[index];
        event.root = f64::NAN;
        if !event.is_armed() || event.next == event.side || event.next.is_nan() {
            return Ok(());
        }
        match self.locate(step, index, to) {
            Err(IntegrationError::NonFiniteEvent { .. }) => {
                self.events[index].next = f64::NAN;
                Ok(())
            }
            result => result,
        }
    }

    /// The signs at the beginning of a step in the direction `way` after a jump, or of the first one; the state is
    /// `there`.
    fn arm(&mut self, start: f64, way: f64) -> Result<(), IntegrationError> {
        for index in 0..self.events.len() {
            let value = self.value(index, start, start)?;
            let event = &mut self.events[index];
            let (change, waits) = ((value - event.value).abs(), event.waits(start, way));
            (event.value, event.since) = (value, start);
            // A correction keeps the side: where it passes zero the event happens, where it leads back it has happened.
            if self.start == Start::Corrected && change <= event.travel {
                continue;
            }
            let unchanged = self.start == Start::Cut && change == 0.0;
            let passed = event.last.is_finite() && value * event.came < 0.0;
            if waits && (unchanged && !passed || value.abs() <= 8.0 * event.residue) {
                event.side = 0.0;
            } else if !unchanged || value != 0.0 {
                (event.side, event.residue) = (sign(value), 0.0);
            }
        }
        Ok(())
    }

    /// The earliest root that has not happened yet.
    fn first_root(&self, forwards: bool) -> Option<f64> {
        let roots = self.events.iter().map(|event| event.root).filter(|root| !root.is_nan());
        roots.reduce(|x, y| if forwards { x.min(y) } else { x.max(y) })
    }

    /// Gives this root to the events that have reached zero there, too: for the clock, or by their functions at the
    /// state `there`. True where an earlier root was found instead, of a function that is not finite behind.
    fn gather(&mut self, step: &mut dyn Step<V>, time: f64, way: f64) -> Result<bool, IntegrationError> {
        for index in 0..self.events.len() {
            let event = &mut self.events[index];
            event.reached = (event.function)(time, &self.there);
            let passed = event.side * event.reached <= 0.0 && event.is_armed() && !event.waits(time, way);
            let width = (event.behind - event.root).abs().max(resolution(event.root, time));
            let near = (event.root - time).abs() <= width;
            if !event.root.is_nan() && (passed || near) {
                // A root that is not near is another one than what it has passed here.
                (event.root, event.behind) = (time, if near { event.behind } else { time });
            } else if event.next.is_nan() && passed && event.reached != 0.0 {
                self.locate(step, index, time)?;
                return Ok(true);
            } else if event.next.is_nan() && event.is_armed() && !event.reached.is_finite() && !event.waits(time, way) {
                if self.find_hidden_root(step, index, time)? {
                    return Ok(true);
                }
                step.interpolate(time, &mut self.there)?;
            }
        }
        Ok(false)
    }

    /// Lets the events with this root happen, at the state `there`.
    fn happen(&mut self, time: f64) -> Result<Option<Cut>, IntegrationError> {
        self.after.copy_from(&self.there);
        let (mut stop, mut restart, mut changed) = (false, false, false);
        for index in 0..self.events.len() {
            if self.events[index].root != time {
                continue;
            }
            let event = &mut self.events[index];
            let too_soon = (time - event.last).abs() <= resolution(time, event.last);
            let response = event.happen(&mut self.after);
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
        if !(stop || restart || changed) {
            return Ok(None);
        }
        for event in self.events.iter_mut() {
            event.value = event.reached;
        }
        Ok(Some(Cut { time, stop, changed }))
    }

    /// Moves the end of the integration behind the events that have just happened: they do not happen again where it is
    /// gone on with.
    fn pass(&mut self, step: &mut dyn Step<V>, cut: Cut) -> Result<Cut, IntegrationError> {
        let happened = |event: &&mut Event<'a, V>| event.last == cut.time;
        let far = |time: f64| (time - cut.time).abs();
        let mut time = cut.time;
        for event in self.events.iter_mut().filter(happened) {
            time = if far(event.behind) > far(time) { event.behind } else { time };
        }
        let time = self.beyond_correction(step, cut.time, time)?;
        for event in self.events.iter_mut().filter(happened) {
            event.last = time;
        }
        step.interpolate(time, &mut self.there)?;
        self.after.copy_from(&self.there);
        Ok(Cut { time, ..cut })
    }

    /// The event's function at the state `there`; where it is not finite, the last good time is `good`.
    fn value(&self, index: usize, time: f64, good: f64) -> Result<f64, IntegrationError> {
        let value = (self.events[index].function)(time, &self.there);
        if value.is_finite() { Ok(value) } else { Err(IntegrationError::NonFiniteEvent { time: good, event: index }) }
    }
}

/// Whether the states are the same, number by number.
fn equal<V: Coordinates>(a: &State<V>, b: &State<V>) -> bool {
    a.q.as_slice() == b.q.as_slice() && a.qd.as_slice() == b.qd.as_slice()
}

#[cfg(all(test, feature = "std"))]
mod tests;
