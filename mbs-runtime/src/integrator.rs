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
//! nothing, or a `Result<(), E>`: where it refuses, error control tries shorter steps before the integration ends. Time
//! is `f64` whatever the scalar, so that a long run of `f32` keeps its clock; the closure gets it as a scalar.
//!
//! After each accepted step an observer sees the [`Step`]: its two ends, and the solution between them. It goes on with
//! `ControlFlow::Continue(())`, or ends the integration at a time of its choice inside the step with
//! `ControlFlow::Break(time)`. An observer that may fail returns a `Result<ControlFlow<f64>, E>`, whose error ends the
//! integration at once. What either of them stops with comes back as [`IntegrationError::Stopped`], in its own type.
//!
//! Whatever happens, the caller's [`State`] is the last accepted one afterwards. Nothing is allocated in a step: what
//! an integrator needs is cloned from the initial state when it starts.

use core::convert::Infallible;
use core::ops::ControlFlow;

use crate::error::IntegrationError;
use crate::event::{Event, Watch};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// `Self` with one field set, for settings that may get more fields.
macro_rules! settings {
    ($($settings:ident: $($doc:literal $with:ident $field:ident $type:ty = $value:expr;)+)+) => {$(
        impl $settings {$(
            #[doc = $doc]
            #[must_use]
            pub const fn $with(mut self, $field: $type) -> Self {
                self.$field = $value;
                self
            }
        )+}
    )+};
}

/// A method with equal steps: how it is made, its settings, and that its steps work in what is made of the first state.
macro_rules! equal_steps {
    ($method:ident: |$first:ident| $work:expr) => {
        impl $method {
            /// Steps of `step` seconds, or a little less; any number of them.
            #[must_use]
            pub const fn new(step: f64) -> Self {
                Self { step, max_steps: usize::MAX }
            }
        }

        settings! {
            $method:
            "The number of steps allowed in one integration." with_max_steps max_steps usize = max_steps;
        }

        impl<T: $crate::Scalar> super::Integrator<T> for $method {
            /// # Errors
            /// [`IntegrationError::InvalidStep`](crate::IntegrationError::InvalidStep) if `step` is not positive;
            /// [`IntegrationError::TooManySteps`](crate::IntegrationError::TooManySteps) at once if `max_steps` are too
            /// few; otherwise [`IntegrationError`](crate::IntegrationError) where the first bad number appears.
            fn run<V, F>(
                &self,
                acceleration: F,
                t: f64,
                t_end: f64,
                state: &mut State<V>,
                observer: impl super::Observer<V, F::Error>,
            ) -> Result<super::Summary, $crate::IntegrationError<F::Error>>
            where
                V: Coordinates<Scalar = T>,
                F: super::Acceleration<V>,
            {
                let $first = &*state;
                let steps = (self.step, self.max_steps);
                super::fixed::integrate(steps, $work, acceleration, t, t_end, state, observer)
            }
        }
    };
}

/// A method with steps by error control: its settings, and that its steps work in what is made of the first state.
macro_rules! controlled_steps {
    ($method:ident: |$first:ident, $control:ident| $work:expr) => {
        settings! {
            $method:
            "The length of the first step, positive \\[s\\]." with_first_step first_step f64 = Some(first_step);
            "The shortest step that may be tried \\[s\\]." with_min_step min_step f64 = min_step;
            "The longest step, positive \\[s\\]." with_max_step max_step f64 = max_step;
            "The number of steps allowed in one integration." with_max_steps max_steps usize = max_steps;
            "`β` of the step control." with_beta beta f64 = beta;
        }

        impl<T: Real> super::Integrator<T> for $method {
            /// # Errors
            /// [`IntegrationError`](crate::IntegrationError): a tolerance, the gain or a limit of the step is bad; the
            /// tolerances cannot be met; there is no finite acceleration from some time on; the steps are used up.
            fn run<V, F>(
                &self,
                acceleration: F,
                t: f64,
                t_end: f64,
                state: &mut State<V>,
                observer: impl super::Observer<V, F::Error>,
            ) -> Result<super::Summary, $crate::IntegrationError<F::Error>>
            where
                V: Coordinates<Scalar = T>,
                F: super::Acceleration<V>,
            {
                let ($first, $control) = (&*state, &self.control());
                super::adaptive::integrate($control, $work, acceleration, t, t_end, state, observer)
            }
        }
    };
}

mod adaptive;
mod compensation;
pub(crate) mod dop853;
pub(crate) mod dopri5;
#[cfg(feature = "std")]
pub(crate) mod ensemble;
pub(crate) mod fixed;
pub(crate) mod gauss_legendre;
mod hermite;
#[cfg(all(test, feature = "std"))]
mod long_runs;
pub(crate) mod projected;
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
    fn integrate<V, F, R, O, A>(
        &self,
        mut acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        mut observer: O,
    ) -> Result<Summary, IntegrationError<R::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome<A>,
        O: FnMut(&mut dyn Step<V>) -> A,
    {
        let acceleration = move |t: T, q: &V, qd: &V, qdd: &mut V| acceleration(t, q, qd, qdd).into_result();
        #[cfg(debug_assertions)]
        let acceleration = &mut { acceleration } as &mut RightHandSide<'_, V, R::Error>;
        let observer = &mut |step: &mut dyn Step<V>| R::answer(observer(step), step.time());
        self.run(acceleration, t, t_end, state, observer as &mut Watcher<'_, V, R::Error>)
    }

    /// [`integrate`](Integrator::integrate), of a right-hand side and an observer in one form: what a method
    /// implements.
    ///
    /// # Errors
    /// As [`integrate`](Integrator::integrate).
    fn run<V, F>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        observer: impl Observer<V, F::Error>,
    ) -> Result<Summary, IntegrationError<F::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: Acceleration<V>;

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
    ) -> Result<Summary, IntegrationError<R::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome,
    {
        let t_end = times.last().copied().unwrap_or(t);
        check_input(t, t_end, state).and_then(|()| check_order(t, times, t_end)).map_err(IntegrationError::widen)?;
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
    /// the state before its action. `replace` does not undo an action there, and `Break` with that time, or an error,
    /// ends with the state after it; later times are outside the step. An event that never happens is no error: its
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
    /// [`IntegrationError::NonFiniteEvent`] if an event's function is infinite or NaN where the motion gets to,
    /// [`IntegrationError::EventsAccumulate`] if one follows itself too closely, [`IntegrationError::NonFiniteState`]
    /// if an action leaves such numbers; otherwise as [`integrate`](Integrator::integrate).
    fn integrate_with_events<V, F, R, O, A>(
        &self,
        mut acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        events: &mut [Event<'_, V>],
        mut observer: O,
    ) -> Result<Summary, IntegrationError<R::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: FnMut(T, &V, &V, &mut V) -> R,
        R: Outcome<A>,
        O: FnMut(&mut dyn Step<V>) -> A,
    {
        let acceleration = move |t: T, q: &V, qd: &V, qdd: &mut V| acceleration(t, q, qd, qdd).into_result();
        #[cfg(debug_assertions)]
        let acceleration = &mut { acceleration } as &mut RightHandSide<'_, V, R::Error>;
        let observer = &mut |step: &mut dyn Step<V>| R::answer(observer(step), step.time());
        self.watch(acceleration, t, t_end, state, events, observer as &mut Watcher<'_, V, R::Error>)
    }

    /// [`run`](Integrator::run), with events.
    ///
    /// # Errors
    /// As [`integrate_with_events`](Integrator::integrate_with_events).
    fn watch<V, F>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        events: &mut [Event<'_, V>],
        mut observer: impl Observer<V, F::Error>,
    ) -> Result<Summary, IntegrationError<F::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: Acceleration<V>,
    {
        let mut watch = Watch::new(events, state);
        self.run(acceleration, t, t_end, state, |step: &mut dyn Step<V>| watch.observe(step, &mut observer))
    }
}

/// One accepted step, as an observer sees it.
pub trait Step<V> {
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
    /// [`IntegrationError::InvalidTime`] if `t` is not inside the step; [`IntegrationError::NonFiniteState`] if there
    /// is no acceleration where the interpolant needs one; [`IntegrationError::Constraint`] if
    /// [`Projected`](crate::Projected) finds no state on the constraints there. `state` is then untouched. When the
    /// observer returns, whatever it returns, the integration ends with this error, or with the one that the right-hand
    /// side refused with.
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

/// A right-hand side in the form that methods take: it writes `q̈ = f(t, q, q̇)` into its last argument, or refuses.
pub trait Acceleration<V: Coordinates>: FnMut(V::Scalar, &V, &V, &mut V) -> Result<(), Self::Error> {
    /// What it refuses with.
    type Error;
}

impl<V: Coordinates, E, F: FnMut(V::Scalar, &V, &V, &mut V) -> Result<(), E>> Acceleration<V> for F {
    type Error = E;
}

/// A right-hand side behind a pointer: in debug builds one copy of a method serves all of one kind of state, so that
/// what integrates is compiled sooner. The numbers are the same to the bit.
#[cfg(debug_assertions)]
type RightHandSide<'f, V, E> = dyn FnMut(<V as Coordinates>::Scalar, &V, &V, &mut V) -> Result<(), E> + 'f;

/// An observer behind a pointer, in every build: it is called once a step.
type Watcher<'f, V, E> = dyn FnMut(&mut dyn Step<V>) -> Result<ControlFlow<f64>, IntegrationError<E>> + 'f;

/// An observer in the form that methods take.
pub trait Observer<V, E>: FnMut(&mut dyn Step<V>) -> Result<ControlFlow<f64>, IntegrationError<E>> {}

impl<V, E, O: FnMut(&mut dyn Step<V>) -> Result<ControlFlow<f64>, IntegrationError<E>>> Observer<V, E> for O {}

/// What an acceleration closure returns beside an observer that returns `A`.
///
/// | acceleration    | observer                       | `Error`      |
/// |-----------------|--------------------------------|--------------|
/// | `()`            | `ControlFlow<f64>`             | `Infallible` |
/// | `Result<(), E>` | `ControlFlow<f64>`             | `E`          |
/// | `()`            | `Result<ControlFlow<f64>, E>`  | `E`          |
/// | `Result<(), E>` | `Result<ControlFlow<f64>, E>`  | `E`          |
pub trait Outcome<A = ControlFlow<f64>> {
    /// What either of them stops with.
    type Error;

    /// The acceleration's outcome as a `Result`.
    ///
    /// # Errors
    /// What it refuses with.
    fn into_result(self) -> Result<(), Self::Error>;

    /// The observer's answer to a step that ends at `time`.
    ///
    /// # Errors
    /// [`IntegrationError::Stopped`] with what it stops with.
    fn answer(answer: A, time: f64) -> Result<ControlFlow<f64>, IntegrationError<Self::Error>>;
}

macro_rules! outcome {
    ([$($parameter:ident)?] $acceleration:ty, $observer:ty, $error:ty: $result:expr, $answer:expr) => {
        impl$(<$parameter>)? Outcome<$observer> for $acceleration {
            type Error = $error;

            #[inline]
            fn into_result(self) -> Result<(), $error> {
                $result(self)
            }

            #[inline]
            fn answer(answer: $observer, time: f64) -> Result<ControlFlow<f64>, IntegrationError<$error>> {
                let result: Result<_, $error> = $answer(answer);
                result.map_err(|error| IntegrationError::Stopped { time, error })
            }
        }
    };
}
outcome!([] (), ControlFlow<f64>, Infallible: Ok, Ok);
outcome!([E] Result<(), E>, ControlFlow<f64>, E: core::convert::identity, Ok);
outcome!([E] (), Result<ControlFlow<f64>, E>, E: Ok, core::convert::identity);
outcome!([E] Result<(), E>, Result<ControlFlow<f64>, E>, E: core::convert::identity, core::convert::identity);

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
mod tests;
