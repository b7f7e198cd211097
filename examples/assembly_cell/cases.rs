//! Three ways to insert, three holes, two frictions: each flown from the feeder on.

use mbs_arm::assembly::{Cell, Contact, Hole, Impedance, Insertion, Outcome, Peg, Sample, Task, Wrist};
use mbs_examples::Failure;
use mbs_models::scara::{Params, Scara};
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
/// Inserted is what comes so close to the depth wanted \[m\].
const SHORT: f64 = 2e-4;
/// At this push of the wrist the arm stops \[N\].
pub(crate) const GREATEST_PUSH: f64 = 400.0;

/// One cycle.
pub(crate) struct Run {
    pub(crate) way: &'static str,
    pub(crate) error: [f64; 2],
    pub(crate) friction: f64,
    pub(crate) samples: Vec<Sample>,
    pub(crate) found: Insertion,
    /// When the insertion began \[s\], and the whole cycle if nothing stopped it.
    pub(crate) insertion: f64,
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
    let times = [cycle.insertion, cycle.end, cycle.end + REST];
    let task = Task { wanted: &|t| cycle.at(t), times, depth: DEPTH, short: SHORT, greatest_push: GREATEST_PUSH };
    let mut samples = Vec::new();
    let found = cell(way, error, friction)?.insert(&task, |sample| samples.push(sample))?;
    let whole = (found.outcome == Outcome::Inserted).then(|| cycle.time());
    Ok(Run { way: way.0, error, friction, samples, found, insertion: cycle.insertion, cycle: whole })
}
