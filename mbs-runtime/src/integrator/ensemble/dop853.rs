//! [`Dop853`] in lanes: each has its own time, error and step.

use core::convert::Infallible;

use super::{EnsembleIntegrator, Lanes, MOST, Outcome, Watch, check, summary_at, take, times};
use crate::integrator::adaptive::{Attempt, Pace, first_guess, first_step};
use crate::integrator::dop853::{Dop853, END, NODES, Sweep};
use crate::integrator::run::Fault;
use crate::scalar::Scalar;
use crate::state::State;

/// One lane on its way.
#[derive(Clone, Copy)]
struct Motion {
    summary: super::Summary,
    pace: Pace,
    attempt: Attempt,
    /// The length of the step that is tried \[s\], negative backwards; 0 of a lane that has ended.
    length: f64,
}

impl EnsembleIntegrator for Dop853 {
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
        let control = self.control();
        let mut active = check(t, t_end, state, outcomes);
        let end_all = |active: &[bool; MOST], outcomes: &mut [Outcome], end: Outcome| {
            outcomes.iter_mut().zip(active).filter(|(_, active)| **active).for_each(|(outcome, _)| *outcome = end);
        };
        if let Err(error) = control.check::<L::Real>(t) {
            return end_all(&active, outcomes, Err(error));
        }
        if t == t_end {
            return end_all(&active, outcomes, Ok(summary_at(t)));
        }
        let mut sweep = Sweep::new(state, &control);
        let mut watch = Watch { fine: active, evaluations: [0; MOST] };

        // The first stage of the first step.
        let stages = &mut sweep.stages;
        stages.v[0] = state.qd;
        acceleration(times(|_| t), &state.q, &state.qd, &mut stages.a[0]);
        watch.evaluated(&stages.a[0]);
        for (lane, outcome) in outcomes.iter_mut().enumerate().filter(|(lane, _)| active[*lane]) {
            if !watch.fine[lane] {
                *outcome = Err(Fault::<Infallible>::NonFinite.at(t, 0.0));
            }
        }
        active = watch.fine;

        let longest = (t_end - t).abs().min(control.max_step);
        let first: [f64; MOST] = match self.first_step {
            Some(step) => [step.min(longest); MOST],
            None => {
                let direction = if t_end > t { 1.0 } else { -1.0 };
                let (d0, d1) = stages.sizes(state);
                let guesses: [f64; MOST] = core::array::from_fn(|lane| {
                    if lane < L::COUNT { first_guess(d0.lane(lane), d1.lane(lane), longest) } else { 0.0 }
                });
                let h = times(|lane| direction * guesses[lane]);
                stages.euler_step(h, state);
                let (q, qd, qdd) = stages.at_euler_step();
                acceleration(times(|lane| t + direction * guesses[lane]), q, qd, qdd);
                watch.evaluated(qdd);
                let d2 = stages.bend(h, state);
                core::array::from_fn(|lane| match guesses[lane] {
                    guess if !watch.fine[lane] => guess,
                    guess => first_step(d1.lane(lane), d2.lane(lane), 8.0, guess, longest),
                })
            }
        };
        let mut motions = first.map(|step| Motion {
            summary: summary_at(t),
            pace: Pace::new(step),
            attempt: Attempt::none(),
            length: 0.0,
        });

        let mut new = *state;
        loop {
            for lane in 0..outcomes.len() {
                let motion = &mut motions[lane];
                motion.length = 0.0;
                if active[lane] {
                    match motion.pace.attempt::<L::Real, Infallible>(&control, &motion.summary, t_end) {
                        Ok(attempt) => {
                            (motion.attempt, motion.length) = (attempt, attempt.end - motion.summary.time);
                        }
                        Err(error) => (outcomes[lane], active[lane]) = (Err(error), false),
                    }
                }
            }
            if !active.contains(&true) {
                return;
            }
            watch.fine = active;
            let h = times(|lane| motions[lane].length);
            let Ok(()) = sweep.step::<Infallible>(
                |s, q, qd, qdd| {
                    let time = times(|lane| motions[lane].summary.time + NODES[s] * motions[lane].length);
                    acceleration(time, q, qd, qdd);
                    watch.evaluated(qdd);
                    Ok(())
                },
                h,
                state,
                &mut new,
            );
            let error = sweep.error(h, state, &new);
            watch.ended(&new);
            // Those whose error is too large need no acceleration at the end, and are no worse for one.
            let finite = watch.fine;
            let small: [bool; MOST] = core::array::from_fn(|lane| finite[lane] && error.lane(lane) <= L::Real::one());
            watch.fine = small;
            if small.contains(&true) {
                let stages = &mut sweep.stages;
                stages.v[END] = new.qd;
                let time = times(|lane| motions[lane].summary.time + motions[lane].length);
                acceleration(time, &new.q, &new.qd, &mut stages.a[END]);
                watch.evaluated(&stages.a[END]);
            }
            let accepted = watch.fine;
            for lane in 0..outcomes.len() {
                if !active[lane] {
                    continue;
                }
                let Motion { summary, pace, attempt, .. } = &mut motions[lane];
                if accepted[lane] {
                    summary.accepted += 1;
                    summary.time = attempt.end;
                    summary.evaluations = watch.evaluations[lane];
                    summary.next_step = pace.accept(&control, attempt, error.lane(lane));
                    if summary.time == t_end {
                        (outcomes[lane], active[lane]) = (Ok(*summary), false);
                    }
                } else {
                    let refused =
                        if finite[lane] && !small[lane] { Ok(error.lane(lane)) } else { Err(Fault::NonFinite) };
                    if let Err(error) = pace.refuse::<L::Real, Infallible>(&control, attempt, summary, refused) {
                        (outcomes[lane], active[lane]) = (Err(error), false);
                    }
                }
            }
            take(&accepted, &new.q, &mut state.q);
            take(&accepted, &new.qd, &mut state.qd);
            let stages = &mut sweep.stages;
            let (v, a) = (stages.v[END], stages.a[END]);
            take(&accepted, &v, &mut stages.v[0]);
            take(&accepted, &a, &mut stages.a[0]);
        }
    }
}
