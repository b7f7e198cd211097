//! A peg put into its hole, simulated from the feeder on: how deep it comes, what it takes, and why it ends.

use core::ops::ControlFlow;

use mbs_models::Error;
use mbs_runtime::{Dopri5, Integrator, Scalar, State};

use super::{Cell, Wanted, cell::Numbers, whitney};

/// What the flange does, and when an insertion has failed.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// Where it is to be at a time \[s\].
    pub wanted: &'a dyn Fn(f64) -> Wanted,
    /// When the insertion begins, when the flange stops, and when the simulation ends \[s\].
    pub times: [f64; 3],
    /// How deep the tip is to be \[m\].
    pub depth: f64,
    /// Inserted is what comes so close to that depth \[m\].
    pub short: f64,
    /// At this push of the wrist the arm stops \[N\].
    pub greatest_push: f64,
}

/// What is seen of a state.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// When \[s\].
    pub t: f64,
    /// Force of the wrist on the peg \[N\].
    pub push: [f64; 3],
    /// Forces at the corners left and right, and at the edges left and right \[N\].
    pub normal: [f64; 4],
    /// Depth of the tip \[m\].
    pub depth: f64,
    /// How much the peg leans \[rad\].
    pub tilt: f64,
}

/// How an insertion ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As deep as was asked for.
    Inserted,
    /// Both sides touch, and forces between them may hold each other.
    Wedged,
    /// Both sides touch, and the push is not within the jamming diagram.
    Jammed,
    /// Too strong a push, or not deep enough, in neither of these ways.
    Overloaded,
}

/// What came of it.
#[derive(Clone, Copy, Debug)]
pub struct Insertion {
    /// How it ended.
    pub outcome: Outcome,
    /// The greatest force of a single contact \[N\].
    pub contact_force: f64,
    /// The greatest force of the wrist, down \[N\].
    pub push: f64,
    /// The greatest force of the wrist, to the side \[N\].
    pub side_force: f64,
    /// Depth of the tip at the end \[m\].
    pub depth: f64,
    /// Where both sides began to touch and did so to the end: depth \[m\], and how much the hole leaned against the peg
    /// \[rad\].
    pub two_points: Option<[f64; 2]>,
    /// `F_x/F_z` and `M/(r F_z)` at the end.
    pub ratios: [f64; 2],
    /// By which the peg was behind or beside where it had to be, on its way to the hole \[m\].
    pub carried_error: f64,
    /// Energy less work, the most of it, and the largest energy exchanged \[J\].
    pub energy: [f64; 2],
    /// When it ended \[s\].
    pub end: f64,
}

/// Between samples \[s\].
const PERIOD: f64 = 1e-3;

impl Cell {
    /// Simulates a task from rest in the feeder on; `see` gets a sample every millisecond, and one of the end. The
    /// greatest values, and whether the arm stops, are those at ends of the integrator's steps.
    ///
    /// # Errors
    /// [`Error`] for places that the arm does not reach, and where the integration fails.
    pub fn insert(&self, task: &Task<'_>, mut see: impl FnMut(Sample)) -> Result<Insertion, Error> {
        let mut state = self.rest((task.wanted)(0.0)[0])?;
        let energy = self.energy(&state.q, &state.qd);
        let mut run = Insertion {
            outcome: Outcome::Overloaded,
            contact_force: 0.0,
            push: 0.0,
            side_force: 0.0,
            depth: 0.0,
            two_points: None,
            ratios: [0.0; 2],
            carried_error: 0.0,
            energy: [0.0; 2],
            end: 0.0,
        };
        let moving = |t: f64, q: &Numbers, v: &Numbers, a: &mut Numbers| {
            *a = self.accelerations(&(task.wanted)(t), &[0.0; 3], q, v);
        };
        let sample = |t: f64, State { q, qd }: &State<Numbers>| {
            let touch = self.touch(q, qd);
            Sample { t, push: self.wrist_force(q, qd), normal: touch.normal, depth: touch.depth, tilt: q[7] }
        };
        let (mut between, mut seen) = (state, 0_u64);
        let [insertion, stop, whole] = task.times;
        // Each phase by itself: the acceleration wanted may jump between them.
        for [from, to] in [[0.0, insertion], [insertion, stop], [stop, whole]] {
            let summary = Dopri5::new(1e-7, 1e-9).integrate(moving, from, to, &mut state, |step| {
                while seen as f64 * PERIOD <= step.time() {
                    let t = seen as f64 * PERIOD;
                    if step.interpolate(t, &mut between).is_err() {
                        // The integration ends with this error.
                        return ControlFlow::Break(step.time());
                    }
                    see(sample(t, &between));
                    seen += 1;
                }
                let (t, State { q, qd }) = (step.time(), step.state());
                let push = self.wrist_force(q, qd);
                let touch = self.touch(q, qd);
                let now = self.energy(q, qd) - energy;
                run.energy = [run.energy[0].max((now - qd[8]).abs()), run.energy[1].max(now.abs())];
                if t <= insertion {
                    let wanted = (task.wanted)(t)[0];
                    let place = [q[4], q[5], q[6] - self.peg.centre + self.wrist.length];
                    let square = (0..3).map(|i| (place[i] - wanted[i]) * (place[i] - wanted[i])).sum::<f64>();
                    run.carried_error = run.carried_error.max(Scalar::sqrt(square));
                } else {
                    run.contact_force = touch.normal.into_iter().fold(run.contact_force, f64::max);
                    run.push = run.push.max(-push[2]);
                    run.side_force = run.side_force.max(push[0].abs());
                    let first = || [touch.depth, self.hole.tilt - q[7]];
                    run.two_points = two_points(&touch.normal).then(|| run.two_points.unwrap_or_else(first));
                }
                if -push[2] > task.greatest_push { ControlFlow::Break(t) } else { ControlFlow::Continue(()) }
            })?;
            run.end = summary.time;
            if summary.stopped {
                break;
            }
        }
        if (seen as f64 - 1.0) * PERIOD < run.end {
            see(sample(run.end, &state));
        }
        let touch = self.touch(&state.q, &state.qd);
        let push = self.wrist_force(&state.q, &state.qd);
        run.depth = touch.depth;
        // The support's force acts at its centre; its moment at the tip counts from x to z.
        let moment = -self.wrist.centre * push[0] + self.wrist.stiffness[2] * state.q[7];
        run.ratios = [push[0] / -push[2], moment / (self.peg.radius * -push[2])];
        run.outcome = self.outcome(task.depth - task.short, &run, &touch.normal);
        Ok(run)
    }

    fn outcome(&self, enough: f64, run: &Insertion, normal: &[f64; 4]) -> Outcome {
        let (radius, friction) = (self.peg.radius, self.contact.friction);
        let two_points = two_points(normal);
        if run.depth >= enough {
            Outcome::Inserted
        } else if two_points && whitney::can_wedge(run.depth, radius, friction) {
            Outcome::Wedged
        } else if two_points && whitney::jams(run.ratios, run.depth, radius, friction) {
            Outcome::Jammed
        } else {
            Outcome::Overloaded
        }
    }
}

/// A corner on one side and the edge on the other.
fn two_points(&[left, right, left_edge, right_edge]: &[f64; 4]) -> bool {
    (left > 0.0 && right_edge > 0.0) || (right > 0.0 && left_edge > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_are_on_opposite_sides() {
        assert!(two_points(&[1.0, 0.0, 0.0, 1.0]) && two_points(&[0.0, 1.0, 1.0, 0.0]));
        assert!(!two_points(&[1.0, 1.0, 0.0, 0.0]) && !two_points(&[1.0, 0.0, 1.0, 0.0]));
    }
}
