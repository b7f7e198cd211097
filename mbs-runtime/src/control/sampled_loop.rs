//! A controller that sees samples, computes for a while, and holds what it found, in the loop with a motion.

use crate::error::IntegrationError;
use crate::integrator::fixed::rounding_of_clock;
use crate::integrator::{Integrator, Outcome, Step, Summary};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// Samples at `t₀ + k T` before the end; what is computed from one acts from `delay` later, and until the next one
/// does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLoop<const U: usize> {
    /// T \[s\].
    pub sample_time: f64,
    /// From a sample to the moment when its input acts \[s\], at most T.
    pub delay: f64,
    /// What acts until the first input does.
    pub initial: [f64; U],
}

impl<const U: usize> SampledLoop<U> {
    /// Carries `state` from `t` to `t_end`, later or the same.
    ///
    /// | argument       | meaning                                                             |
    /// |----------------|---------------------------------------------------------------------|
    /// | `integrator`   | carries the motion from one change of the input to the next          |
    /// | `law`          | the input, from the time and the state at a sample; the first is at `t` |
    /// | `acceleration` | writes `q̈ = f(t, q, q̇, u)` into its last argument                   |
    /// | `observer`     | as for [`Integrator::integrate`]; it may see the input besides       |
    ///
    /// ```
    /// use core::ops::ControlFlow;
    /// use mbs_runtime::control::SampledLoop;
    /// use mbs_runtime::{Rk4, State};
    ///
    /// // A mass of 1 kg is brought to rest in two samples of a second (dead beat).
    /// let sampled = SampledLoop { sample_time: 1.0, delay: 0.0, initial: [0.0] };
    /// let mut state = State::new([1.0], [0.0]);
    /// let summary = sampled.integrate(
    ///     &Rk4::new(0.1),
    ///     |_, state| [-state.q[0] - 1.5 * state.qd[0]],
    ///     |_, _, _, u, qdd| qdd[0] = u[0],
    ///     0.0,
    ///     2.0,
    ///     &mut state,
    ///     |_, _| ControlFlow::Continue(()),
    /// );
    /// assert!(summary.unwrap().time == 2.0 && state.q[0].abs() < 1e-12 && state.qd[0].abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// [`IntegrationError::InvalidStep`] if the sample time is not positive and finite, or the delay not between zero
    /// and it; [`IntegrationError::InvalidTime`] if `t_end` lies before `t`; otherwise as [`Integrator::integrate`]. An
    /// input that is infinite or NaN ends in [`IntegrationError::NonFiniteState`] where the accelerations are.
    pub fn integrate<T, V, I, F, R, O, A>(
        &self,
        integrator: &I,
        mut law: impl FnMut(f64, &State<V>) -> [f64; U],
        mut acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        mut observer: O,
    ) -> Result<Summary, IntegrationError<R::Error>>
    where
        T: Scalar,
        V: Coordinates<Scalar = T>,
        I: Integrator<T>,
        F: FnMut(T, &V, &V, &[f64; U], &mut V) -> R,
        R: Outcome<A>,
        O: FnMut(&mut dyn Step<V>, &[f64; U]) -> A,
    {
        self.check(t, t_end).map_err(IntegrationError::widen)?;
        let mut all = Summary { time: t, stopped: false, evaluations: 0, accepted: 0, rejected: 0, next_step: 0.0 };
        let (mut held, mut sample) = (self.initial, 0.0);
        // 11 · 0.03 is less than 0.33 by rounding alone: no sample comes so shortly before the end.
        let late = t_end - rounding_of_clock(t, t_end, self.sample_time);
        while all.time < t_end {
            let start = t + sample * self.sample_time;
            let computed = law(start, state);
            let change =
                if self.delay == self.sample_time { t + (sample + 1.0) * self.sample_time } else { start + self.delay };
            sample += 1.0;
            for (end, next) in [(change, Some(computed)), (t + sample * self.sample_time, None)] {
                let end = if end < late { end } else { t_end };
                if end > all.time {
                    let part = integrator.integrate(
                        |t, q: &V, qd: &V, qdd: &mut V| acceleration(t, q, qd, &held, qdd),
                        all.time,
                        end,
                        state,
                        |step| observer(step, &held),
                    )?;
                    all = Summary {
                        evaluations: all.evaluations + part.evaluations,
                        accepted: all.accepted + part.accepted,
                        rejected: all.rejected + part.rejected,
                        ..part
                    };
                    if part.stopped {
                        return Ok(all);
                    }
                }
                held = next.unwrap_or(held);
            }
            // Where the clock does not tell two samples apart, it does not go on.
            if t + sample * self.sample_time <= start {
                return Err(IntegrationError::InvalidStep { step: self.sample_time });
            }
        }
        Ok(all)
    }

    fn check(&self, t: f64, t_end: f64) -> Result<(), IntegrationError> {
        if !(self.sample_time > 0.0 && self.sample_time.is_finite()) {
            return Err(IntegrationError::InvalidStep { step: self.sample_time });
        }
        if !(0.0..=self.sample_time).contains(&self.delay) {
            return Err(IntegrationError::InvalidStep { step: self.delay });
        }
        let refused = [t, t_end].into_iter().find(|time| !time.is_finite()).or((t_end < t).then_some(t_end));
        refused.map_or(Ok(()), |time| Err(IntegrationError::InvalidTime { time }))
    }
}
