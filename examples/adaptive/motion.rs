//! What the arm is to do: the thesis' way there and back, and one that shows all masses.

use mbs_arm::JointVector;
use mbs_arm::trajectory::{Piecewise, Sines, ThereAndBack, quintic};
use mbs_models::Error;

/// Table 2 of the thesis \[°\].
const START: JointVector = [20.0, 10.0, 10.0, 10.0, 20.0, 10.0];
const STOP: JointVector = [50.0, 90.0, 120.0, 80.0, 60.0, 100.0];
/// One way \[s\].
const ONE_WAY: f64 = 50.0;

/// From the start of Table 2 to its stop and back, by quintics, in 100 s.
pub(crate) fn there_and_back() -> Result<ThereAndBack<Piecewise<6, 1>>, Error> {
    Ok(ThereAndBack(quintic(START.map(f64::to_radians), [0.0; 6], STOP.map(f64::to_radians), ONE_WAY)?))
}

/// m, in the angles of Denavit and Hartenberg \[°\].
const MIDDLE: JointVector = [0.0, -70.0, 10.0, 0.0, 40.0, 0.0];
/// A \[°\] and T \[s\] of each joint.
const WAVES: [[(f64, f64); 2]; 6] = [
    [(25.0, 7.1), (8.0, 3.1)],
    [(14.0, 8.3), (4.0, 3.7)],
    [(16.0, 6.7), (5.0, 2.9)],
    [(30.0, 5.9), (10.0, 2.3)],
    [(25.0, 6.1), (8.0, 2.7)],
    [(45.0, 5.3), (15.0, 2.1)],
];

/// Two sines in each joint, about a posture in front of the robot.
pub(crate) fn sines() -> Sines<6, 2> {
    let waves = WAVES.map(|waves| waves.map(|(amplitude, period)| (amplitude.to_radians(), period)));
    Sines { middle: MIDDLE.map(f64::to_radians), waves, duration: 60.0 }
}
