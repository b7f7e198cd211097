//! [`Rk4`] in lanes: the same steps for all.

use super::{EnsembleIntegrator, Lanes, Outcome, Watch, check, summary_at, take, times};
use crate::error::IntegrationError;
use crate::integrator::fixed;
use crate::integrator::rk4::{Rk4, Rk4Stepper};
use crate::state::State;

impl EnsembleIntegrator for Rk4 {
    fn integrate_block<L, F, const N: usize>(
        &self,
        mut acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<[L; N]>,
        outcomes: &mut [Outcome],
    ) where
        L: Lanes,
        F: FnMut(L, &[L; N], &[L; N], &mut [L; N]),
    {
        let fine = check(t, t_end, state, outcomes);
        let mut watch = Watch { fine, evaluations: [0; super::MOST] };
        let steps = if self.step.is_nan() || self.step <= 0.0 {
            Err(IntegrationError::InvalidStep { step: self.step })
        } else if t == t_end {
            Ok(0)
        } else {
            fixed::count(t, t_end, self.step, self.max_steps).ok_or_else(|| fixed::too_many(t, self.max_steps))
        };
        let steps = match steps {
            Ok(steps) => steps,
            Err(error) => {
                let good = outcomes.iter_mut().zip(fine).filter(|(_, fine)| *fine);
                return good.for_each(|(outcome, _)| *outcome = Err(error));
            }
        };
        let h = (t_end - t) / steps as f64;
        let mut stepper = Rk4Stepper::new(state);
        let mut new = *state;
        let mut start = t;
        for i in 1..=steps {
            let end = if i == steps { t_end } else { t + i as f64 * h };
            let before = watch.fine;
            stepper.step_with(times(|_| h), state, &mut new, |stage, q, qd, qdd| {
                let time = start + [0.0, 0.5 * h, 0.5 * h, h][stage];
                acceleration(times(|_| time), q, qd, qdd);
                watch.evaluated(qdd);
            });
            watch.ended(&new);
            take(&watch.fine, &new.q, &mut state.q);
            take(&watch.fine, &new.qd, &mut state.qd);
            for (lane, outcome) in outcomes.iter_mut().enumerate() {
                if before[lane] && !watch.fine[lane] {
                    *outcome = Err(IntegrationError::NonFiniteState { time: start });
                }
            }
            if !watch.fine.contains(&true) {
                return;
            }
            start = end;
        }
        for (lane, outcome) in outcomes.iter_mut().enumerate().filter(|(lane, _)| watch.fine[*lane]) {
            let mut summary = summary_at(t_end);
            summary.evaluations = watch.evaluations[lane];
            (summary.accepted, summary.next_step) = (steps, self.step);
            *outcome = Ok(summary);
        }
    }
}
