//! Motions on constraints: any method, whose steps are brought back to where they have to be.
//!
//! Source: E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006, section IV.4 (standard
//! projection method, algorithm IV.4.2), here in the metric of the mass matrix.

use core::ops::ControlFlow;

use super::{Acceleration, Integrator, Observer, Step, Summary};
use crate::constraint::{Constraints, Projector};
use crate::error::{ConstraintError, IntegrationError};
use crate::event::{Event, Watch};
use crate::scalar::Real;
use crate::state::{Coordinates, State};

/// An integrator whose steps are projected onto constraints: `φ(q, t) = 0` and `A q̇ + b = 0` hold at the end of each
/// of them, and wherever an observer or [`sample`](Integrator::sample) looks between.
///
/// The accelerations have to satisfy `A q̈ + γ = 0`, as those of a generated `forward_dynamics` do; what is taken away
/// is the drift of the method's errors. What [`Step::state`] and [`Step::interpolate`] give has been projected; the
/// functions of events see the method's own interpolant. An observer that replaces the state, or an event that changes
/// it, answers for the constraints itself.
///
/// | field    | meaning                                                                                          |
/// |----------|--------------------------------------------------------------------------------------------------|
/// | `method` | makes the steps                                                                                  |
/// | `drift`  | takes away what they drift: [`Projector::onto`] a mechanism, or whatever knows `φ`, `A`, `A q̇ + b` |
/// |          | and `M`; cloned when an integration starts                                                       |
///
/// ```text
/// let drift = Projector::new([0.0; Projector::<f64, [f64; 0]>::size(3, 2)]).onto(&four_bar);
/// let method = Projected { method: Dop853::new(1e-10, 1e-12), drift };
/// method.integrate(accelerations(&four_bar, |_, _, _| [0.0]), 0.0, 10.0, &mut state, |_| ControlFlow::Continue(()))?;
/// ```
///
/// The manual, `docs/integrators.md`, has a whole example.
#[derive(Clone, Debug)]
pub struct Projected<I, D> {
    /// Makes the steps.
    pub method: I,
    /// Brings their ends back.
    pub drift: D,
}

/// Takes away what a motion has drifted from where it has to be: [`Onto`] constraints, or a rule of one's own, such as
/// a quaternion's norm.
pub trait Drift<T: Real>: Clone {
    /// Brings the state back; where that is not possible it stays as it was.
    ///
    /// # Errors
    /// [`ConstraintError`]: there is no such state nearby.
    fn remove<V: Coordinates<Scalar = T>>(&mut self, t: f64, state: &mut State<V>) -> Result<(), ConstraintError>;
}

/// The projection of states onto constraints, as [`Projector::onto`] makes it.
#[derive(Debug)]
pub struct Onto<'a, C, T, S> {
    constraints: &'a C,
    projector: Projector<T, S>,
}

impl<C, T: Clone, S: Clone> Clone for Onto<'_, C, T, S> {
    fn clone(&self) -> Self {
        Onto { constraints: self.constraints, projector: self.projector.clone() }
    }
}

impl<T, S> Projector<T, S> {
    /// Projects onto these constraints, for [`Projected`].
    pub const fn onto<C>(self, constraints: &C) -> Onto<'_, C, T, S> {
        Onto { constraints, projector: self }
    }
}

impl<T: Real, C: Constraints<T>, S: AsMut<[T]> + Clone> Drift<T> for Onto<'_, C, T, S> {
    fn remove<V: Coordinates<Scalar = T>>(&mut self, t: f64, state: &mut State<V>) -> Result<(), ConstraintError> {
        self.projector.project(self.constraints, t, state)
    }
}

impl<T: Real, I: Integrator<T>, D: Drift<T>> Integrator<T> for Projected<I, D> {
    /// # Errors
    /// [`IntegrationError::Constraint`] where no state near the end of a step satisfies the constraints; otherwise
    /// those of the method.
    fn run<V, F>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        mut observer: impl Observer<V, F::Error>,
    ) -> Result<Summary, IntegrationError<F::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: Acceleration<V>,
    {
        let mut work = Work::new(&self.drift, state);
        self.method.run(acceleration, t, t_end, state, |step: &mut dyn Step<V>| {
            Closed::observe(step, &mut work, &mut observer)
        })
    }

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
        let mut work = Work::new(&self.drift, state);
        let mut again = self.drift.clone();
        let mut correction = |t: f64, state: &mut State<V>| again.remove(t, state).is_ok();
        let mut watch = Watch::new(events, state).with_correction(&mut correction);
        let mut closed = |step: &mut dyn Step<V>| Closed::observe(step, &mut work, &mut observer);
        self.method.run(acceleration, t, t_end, state, |step: &mut dyn Step<V>| watch.observe(step, &mut closed))
    }
}

/// What the steps of one integration work in.
struct Work<V, D> {
    drift: D,
    /// The end of the step.
    end: State<V>,
    /// What is asked for before it.
    between: State<V>,
}

impl<V: Clone, D: Clone> Work<V, D> {
    fn new(drift: &D, like: &State<V>) -> Self {
        Self { drift: drift.clone(), end: like.clone(), between: like.clone() }
    }
}

/// A step whose end, and whatever is asked for before it, is on the constraints.
struct Closed<'a, V, D> {
    whole: &'a mut dyn Step<V>,
    work: &'a mut Work<V, D>,
    /// Whether the observer goes on from a state of its own.
    replaced: bool,
    fault: Option<IntegrationError>,
}

impl<T: Real, V: Coordinates<Scalar = T>, D: Drift<T>> Closed<'_, V, D> {
    /// Projects the end of the step, shows it to the observer, and goes on from there.
    fn observe<E>(
        step: &mut dyn Step<V>,
        work: &mut Work<V, D>,
        observer: &mut impl Observer<V, E>,
    ) -> Result<ControlFlow<f64>, IntegrationError<E>> {
        let time = step.time();
        work.end.copy_from(step.state());
        work.drift.remove(time, &mut work.end).map_err(|error| IntegrationError::Constraint { time, error })?;
        let mut closed = Closed { whole: step, work, replaced: false, fault: None };
        let answer = observer(&mut closed);
        let replaced = closed.replaced;
        if !replaced
            && let Ok(ControlFlow::Break(last)) = answer
            && last != time
        {
            closed.look(last).and_then(|()| closed.whole.restart(last, &closed.work.between)).ok();
        } else if !replaced {
            closed.whole.replace(&closed.work.end);
        }
        closed.fault.map_or(answer, |error| Err(error.widen()))
    }

    /// Writes the solution at the time `t` to `between`.
    fn look(&mut self, t: f64) -> Result<(), IntegrationError> {
        let Work { drift, end, between } = &mut *self.work;
        if t == self.whole.time() {
            between.copy_from(end);
            return Ok(());
        }
        self.whole.interpolate(t, between)?;
        if t == self.whole.previous_time() {
            return Ok(());
        }
        drift.remove(t, between).map_err(|error| {
            let error = IntegrationError::Constraint { time: t, error };
            self.fault = Some(error);
            error
        })
    }
}

impl<T: Real, V: Coordinates<Scalar = T>, D: Drift<T>> Step<V> for Closed<'_, V, D> {
    fn previous_time(&self) -> f64 {
        self.whole.previous_time()
    }

    fn time(&self) -> f64 {
        self.whole.time()
    }

    fn previous_state(&self) -> &State<V> {
        self.whole.previous_state()
    }

    fn state(&self) -> &State<V> {
        &self.work.end
    }

    fn interpolate(&mut self, t: f64, state: &mut State<V>) -> Result<(), IntegrationError> {
        self.look(t)?;
        state.copy_from(&self.work.between);
        Ok(())
    }

    fn replace(&mut self, state: &State<V>) {
        self.replaced = true;
        self.whole.replace(state);
    }

    fn restart(&mut self, t: f64, state: &State<V>) -> Result<(), IntegrationError> {
        self.replaced = true;
        self.whole.restart(t, state)
    }
}

#[cfg(all(test, feature = "std"))]
mod tests;
