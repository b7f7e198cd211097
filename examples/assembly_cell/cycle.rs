//! From the feeder to the bottom of the hole: where the flange is to be, and when.

use mbs_arm::assembly::Wanted;
use mbs_arm::trajectory::{JointState, Motion, RateLimits, quintic, trapezoidal_within};
use mbs_examples::Failure;

/// From the flange down to the tip of the peg \[m\].
pub(crate) const LENGTH: f64 = 0.10;
/// Where the tip stands in the feeder, and where the mouth of the hole is believed to be \[m\].
const FEEDER: [f64; 3] = [0.35, 0.0, 0.75];
pub(crate) const MOUTH: [f64; 3] = [0.55, 0.0, 0.75];
/// How much higher the peg is carried, and how far above the mouth it stops \[m\].
const CLEAR: f64 = 0.05;
const ABOVE: f64 = 0.004;
/// Durations of lifting, carrying, lowering \[s\].
const DURATIONS: [f64; 3] = [0.30, 0.55, 0.30];
/// Depth to reach \[m\], speed \[m/s\] and acceleration \[m/s²\] of the insertion.
pub(crate) const DEPTH: f64 = 0.030;
const SPEED: f64 = 0.02;
const ACCELERATION: f64 = 0.5;
/// The gripper closes or opens; the arm comes to rest in the hole \[s\].
const GRIP: f64 = 0.15;
pub(crate) const REST: f64 = 0.25;

/// Motions one after the other.
pub(crate) struct Cycle {
    /// When each begins \[s\].
    phases: Vec<(f64, Box<dyn Motion<3> + Send + Sync>)>,
    /// When the insertion begins, and when the last motion ends \[s\].
    pub(crate) insertion: f64,
    pub(crate) end: f64,
}

impl Cycle {
    pub(crate) fn new() -> Result<Self, Failure> {
        let flange = |[x, y, z]: [f64; 3], above: f64| [x, y, z + LENGTH + above];
        let ways = [
            (flange(FEEDER, 0.0), flange(FEEDER, CLEAR)),
            (flange(FEEDER, CLEAR), flange(MOUTH, CLEAR)),
            (flange(MOUTH, CLEAR), flange(MOUTH, ABOVE)),
        ];
        let mut cycle = Self { phases: Vec::new(), insertion: 0.0, end: 0.0 };
        for ((from, to), duration) in ways.into_iter().zip(DURATIONS) {
            cycle.push(Box::new(quintic(from, [0.0; 3], to, duration)?));
        }
        cycle.insertion = cycle.end;
        let limits = RateLimits { speed: [SPEED; 3], acceleration: [ACCELERATION; 3] };
        cycle.push(Box::new(trapezoidal_within(flange(MOUTH, ABOVE), flange(MOUTH, -DEPTH), &limits)?));
        Ok(cycle)
    }

    fn push(&mut self, motion: Box<dyn Motion<3> + Send + Sync>) {
        let start = self.end;
        self.end += motion.duration();
        self.phases.push((start, motion));
    }

    /// Where the flange is to be; not a number where there is nothing, which the integrator refuses.
    pub(crate) fn at(&self, t: f64) -> Wanted {
        let phase = self.phases.iter().rev().find(|(start, _)| *start <= t);
        let state = phase.and_then(|(start, motion)| motion.held_at(t - start).ok());
        state.map_or([[f64::NAN; 3]; 3], |JointState { q, qd, qdd }| [q, qd, qdd])
    }

    /// Gripping, the way to the hole and into it, letting go, and the way back, which is planned only \[s\].
    pub(crate) fn time(&self) -> f64 {
        2.0 * GRIP + self.end + REST + DURATIONS.iter().sum::<f64>()
    }
}
