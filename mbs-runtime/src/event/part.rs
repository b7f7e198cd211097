//! What the observer sees of a step with events.

use super::Cut;
use crate::error::IntegrationError;
use crate::integrator::{Step, is_between};
use crate::state::{Coordinates, State};

/// A step as far as the event that cuts it.
pub(super) struct Part<'a, V> {
    pub(super) whole: &'a mut dyn Step<V>,
    /// The state at the cut, before the actions.
    pub(super) there: &'a State<V>,
    pub(super) cut: Option<Cut>,
    /// The time from which the observer wants to go on with a state of its own.
    pub(super) origin: Option<f64>,
    pub(super) fault: Option<IntegrationError>,
}

impl<V: Coordinates> Part<'_, V> {
    /// Refuses times after the cut.
    fn check(&mut self, t: f64) -> Result<(), IntegrationError> {
        if is_between(self.previous_time(), t, self.time()) {
            return Ok(());
        }
        self.refuse(IntegrationError::InvalidTime { time: t })
    }

    /// Refuses to end after the cut.
    pub(super) fn check_end(&mut self, t: f64) {
        if self.fault.is_none() {
            // The integration ends with the error.
            let _ = self.check(t);
        }
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
