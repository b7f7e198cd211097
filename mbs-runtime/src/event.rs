//! Events: where a function of `(t, q, q̇)` passes zero during an integration, and what happens then.
//!
//! [`Integrator::integrate_with_events`](crate::Integrator::integrate_with_events) watches them. In each step the
//! functions are looked at in nine places, both ends and seven between, on the dense output. Where a function has
//! changed its sign from one place to the next, the root is bracketed until two neighbouring times are left (ITP, at
//! most a few iterations more than bisection), so that the time is as good as the dense output and the clock allow.
//!
//! - An event happens where its function reaches zero or passes it, not where it leaves zero: a function that is zero
//!   at the start, or after an impact, waits until it has left zero.
//! - Two roots of one function less than an eighth of a step apart may go unseen; `max_step` or `step` of the method
//!   is the remedy. Of three in an eighth one is seen.
//! - Events of one step happen in the order of their times, those of the same time in the order in which they are given.
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
use crate::integrator::Step;
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
    action: Option<&'a mut dyn FnMut(f64, &mut State<V>) -> Response>,
    count: usize,
    /// The sign of the function where it was last looked at; 0 where it has not left zero yet.
    side: f64,
    /// When it happened last; NaN where it has not.
    last: f64,
    /// When it happens in the part of the step that is looked at, or NaN.
    root: f64,
    /// The size of the function where it happened last, which is that of its rounding errors.
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
            last: f64::NAN,
            root: f64::NAN,
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

    /// Whether a change from `self.side` to `side` counts.
    fn counts(&self, side: f64) -> bool {
        self.side != 0.0
            && side != self.side
            && match self.direction {
                Direction::Any => true,
                Direction::Rising => self.side < 0.0,
                Direction::Falling => self.side > 0.0,
            }
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
    /// The state at the time looked at.
    there: State<V>,
    /// The state that the actions left.
    after: State<V>,
    fault: Option<IntegrationError>,
}

/// An interval of time inside the step.
#[derive(Clone, Copy)]
struct Interval {
    from: f64,
    to: f64,
}

/// What the events of a step have decided.
struct Cut {
    /// When.
    time: f64,
    /// Whether the integration ends there.
    stop: bool,
    /// Whether an action changed the state.
    changed: bool,
}

impl<'e, 'a, V: Coordinates> Watch<'e, 'a, V> {
    pub(crate) fn new(events: &'e mut [Event<'a, V>], like: &State<V>) -> Self {
        for event in events.iter_mut() {
            (event.count, event.side, event.last, event.root, event.residue) = (0, 0.0, f64::NAN, f64::NAN, 0.0);
        }
        Self { events, jumped: true, there: like.clone(), after: like.clone(), fault: None }
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
                // An error of the interpolant ends the integration by itself.
                self.fault = Some(error);
                return ControlFlow::Break(error.time().unwrap_or(step.time()));
            }
        };
        let time = cut.as_ref().map_or(step.time(), |cut| cut.time);
        let mut part = Part { whole: step, time, state: &self.there, cut: cut.is_some(), replaced: false, moved: false };
        let answer = observer(&mut part);
        let Part { replaced, moved, .. } = part;
        self.jumped = replaced || moved;
        if let (ControlFlow::Break(time), _) | (ControlFlow::Continue(()), Some(Cut { time, stop: true, changed: false })) =
            (answer, cut.as_ref().map(|cut| Cut { ..*cut }))
            && (answer.is_break() || !replaced)
        {
            return ControlFlow::Break(time);
        }
        todo!()
    }
}
