//! Three ways to insert, three holes, two frictions: each flown from the feeder on.

use std::ops::ControlFlow;

use mbs_arm::assembly::{Cell, Contact, Hole, Impedance, Peg, Wrist, cell::Numbers, whitney};
use mbs_examples::Failure;
use mbs_models::scara::{Params, Scara};
use mbs_runtime::{Dopri5, Integrator, State};
use rayon::prelude::*;

use crate::cycle::{Cycle, DEPTH, LENGTH, MOUTH, REST};

pub(crate) const PEG: Peg = Peg { radius: 0.010, mass: 0.5, inertia: 5e-4, centre: 0.04 };
/// R − r \[m\], width and height of the chamfer \[m\].
pub(crate) const CLEARANCE: f64 = 5e-5;
const CHAMFER: [f64; 2] = [2e-3, 2e-3];
const CONTACT: Contact = Contact { stiffness: 2e7, damping: 50.0, friction: 0.0, creep_speed: 1e-3 };
/// Almost none; its centre is where the gripper holds the peg.
const RIGID: Wrist =
    Wrist { stiffness: [2e6, 2e6, 2000.0], damping: [600.0, 600.0, 0.8], centre: 0.05, length: LENGTH };
/// Springs that meet at the tip.
const REMOTE: Wrist = Wrist { stiffness: [2e4, 1e6, 150.0], damping: [100.0, 400.0, 0.3], centre: 0.0, length: LENGTH };
const STIFF: Impedance = Impedance { stiffness: [2e5, 2e5, 2e5, 500.0], damping: [2000.0, 2000.0, 1000.0, 6.0] };
const SOFT: Impedance = Impedance { stiffness: [3e3, 3e3, 2e5, 500.0], damping: [350.0, 350.0, 1000.0, 6.0] };
pub(crate) const WAYS: [(&str, Wrist, Impedance); 3] =
    [("position control", RIGID, STIFF), ("impedance control", RIGID, SOFT), ("remote centre", REMOTE, STIFF)];
/// How far the hole is aside \[m\], and how much it leans \[rad\].
const ERRORS: [[f64; 2]; 3] = [[5e-4, 0.0], [1e-3, 5e-3], [1e-3, 2e-2]];
const FRICTIONS: [f64; 2] = [0.1, 0.3];
/// At this push of the wrist the arm stops \[N\].
pub(crate) const GREATEST_PUSH: f64 = 400.0;
/// Between samples \[s\].
const PERIOD: f64 = 1e-3;
/// Inserted is what comes so close to the depth wanted \[m\].
const SHORT: f64 = 2e-4;

/// What is seen of a state.
pub(crate) struct Sample {
    pub(crate) t: f64,
    /// Of the wrist on the peg \[N\].
    pub(crate) push: [f64; 3],
    /// \[N\]: corner left and right, edge left and right.
    pub(crate) normal: [f64; 4],
    /// \[m\], \[rad\]
    pub(crate) depth: f64,
    pub(crate) tilt: f64,
}

/// How an insertion ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Inserted,
    /// Both sides touch, and forces between them may hold each other.
    Wedged,
    /// Both sides touch, and the push is not within the jamming diagram.
    Jammed,
    /// Too strong a push, or not deep enough, in neither of these ways.
    Overloaded,
}

/// One cycle.
pub(crate) struct Run {
    pub(crate) way: &'static str,
    pub(crate) error: [f64; 2],
    pub(crate) friction: f64,
    pub(crate) samples: Vec<Sample>,
    pub(crate) outcome: Outcome,
    /// The greatest force of a single contact \[N\]; that of the wrist, down and to the side \[N\].
    pub(crate) contact_force: f64,
    pub(crate) push: f64,
    pub(crate) side_force: f64,
    pub(crate) depth: f64,
    /// Where both sides began to touch and did so to the end: depth \[m\], and how much the hole leaned against the peg
    /// \[rad\].
    pub(crate) two_points: Option<[f64; 2]>,
    /// `F_x/F_z` and `M/(r F_z)` at the end.
    pub(crate) ratios: [f64; 2],
    /// By which the peg was behind or beside where it had to be, on its way to the hole \[m\].
    pub(crate) carried_error: f64,
    /// Energy less work, the most of it, and the largest energy exchanged \[J\].
    pub(crate) imbalance: f64,
    pub(crate) exchanged: f64,
    /// When the insertion began and ended \[s\], and the whole cycle if nothing stopped it.
    pub(crate) insertion: f64,
    pub(crate) end: f64,
    pub(crate) cycle: Option<f64>,
}

pub(crate) fn all() -> Result<Vec<Run>, Failure> {
    let cycle = Cycle::new()?;
    let mut cases = Vec::new();
    for way in WAYS {
        for error in ERRORS {
            cases.extend(FRICTIONS.map(|friction| (way, error, friction)));
        }
    }
    cases.into_par_iter().map(|(way, error, friction)| run(&cycle, way, error, friction)).collect()
}

fn cell(
    (_, wrist, control): (&str, Wrist, Impedance),
    [aside, tilt]: [f64; 2],
    friction: f64,
) -> Result<Cell, Failure> {
    let params = Params::default();
    let place = [MOUTH[0] - aside, MOUTH[2]];
    let hole = Hole { radius: PEG.radius + CLEARANCE, chamfer: CHAMFER, place, tilt };
    let contact = Contact { friction, ..CONTACT };
    let cell = Cell { scara: Scara::try_new(params)?, params, wrist, peg: PEG, hole, contact, control };
    cell.check()?;
    Ok(cell)
}

fn run(cycle: &Cycle, way: (&'static str, Wrist, Impedance), error: [f64; 2], friction: f64) -> Result<Run, Failure> {
    let cell = cell(way, error, friction)?;
    let mut state = cell.rest(cycle.at(0.0)[0])?;
    let energy = cell.energy(&state.q, &state.qd);
    let mut run = Run {
        way: way.0,
        error,
        friction,
        samples: Vec::new(),
        outcome: Outcome::Overloaded,
        contact_force: 0.0,
        push: 0.0,
        side_force: 0.0,
        depth: 0.0,
        two_points: None,
        ratios: [0.0; 2],
        carried_error: 0.0,
        imbalance: 0.0,
        exchanged: 0.0,
        insertion: cycle.insertion,
        end: 0.0,
        cycle: None,
    };
    let moving = |t: f64, q: &Numbers, v: &Numbers, a: &mut Numbers| {
        *a = cell.accelerations(&cycle.at(t), &[0.0; 3], q, v);
    };
    let whole = cycle.end + REST;
    // Each phase by itself: the acceleration wanted may jump between them.
    for [from, to] in [[0.0, cycle.insertion], [cycle.insertion, cycle.end], [cycle.end, whole]] {
        let mut next = from;
        let summary = Dopri5::new(1e-7, 1e-9).integrate(moving, from, to, &mut state, |step| {
            let (t, State { q, qd }) = (step.time(), step.state());
            let push = cell.wrist_force(q, qd);
            let touch = cell.touch(q, qd);
            let now = cell.energy(q, qd) - energy;
            run.imbalance = run.imbalance.max((now - qd[8]).abs());
            run.exchanged = run.exchanged.max(now.abs());
            if t <= cycle.insertion {
                let wanted = cycle.at(t)[0];
                let place = [q[4], q[5], q[6] - PEG.centre + LENGTH];
                let error = (0..3).map(|i| (place[i] - wanted[i]).powi(2)).sum::<f64>().sqrt();
                run.carried_error = run.carried_error.max(error);
            } else {
                run.contact_force = touch.normal.into_iter().fold(run.contact_force, f64::max);
                run.push = run.push.max(-push[2]);
                run.side_force = run.side_force.max(push[0].abs());
                let first = || [touch.depth, run.error[1] - q[7]];
                run.two_points = two_points(&touch.normal).then(|| run.two_points.unwrap_or_else(first));
            }
            let stop = -push[2] > GREATEST_PUSH;
            if t >= next || stop {
                next += PERIOD;
                run.samples.push(Sample { t, push, normal: touch.normal, depth: touch.depth, tilt: q[7] });
            }
            if stop { ControlFlow::Break(t) } else { ControlFlow::Continue(()) }
        })?;
        run.end = summary.time;
        if summary.stopped {
            break;
        }
    }
    let touch = cell.touch(&state.q, &state.qd);
    let push = cell.wrist_force(&state.q, &state.qd);
    run.depth = touch.depth;
    // The support's force acts at its centre; its moment at the tip counts from x to z.
    let moment = -cell.wrist.centre * push[0] + cell.wrist.stiffness[2] * state.q[7];
    run.ratios = [push[0] / -push[2], moment / (PEG.radius * -push[2])];
    run.outcome = outcome(&run, &touch.normal);
    run.cycle = (run.outcome == Outcome::Inserted).then(|| cycle.time());
    Ok(run)
}

/// A corner on one side and the edge on the other.
fn two_points(&[left, right, left_edge, right_edge]: &[f64; 4]) -> bool {
    (left > 0.0 && right_edge > 0.0) || (right > 0.0 && left_edge > 0.0)
}

fn outcome(run: &Run, normal: &[f64; 4]) -> Outcome {
    let two_points = two_points(normal);
    if run.depth >= DEPTH - SHORT {
        Outcome::Inserted
    } else if two_points && whitney::can_wedge(run.depth, PEG.radius, run.friction) {
        Outcome::Wedged
    } else if two_points && whitney::jams(run.ratios, run.depth, PEG.radius, run.friction) {
        Outcome::Jammed
    } else {
        Outcome::Overloaded
    }
}
