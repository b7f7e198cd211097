//! Lengths and forces of the legs along the motions of tables 3 and 4.

use crate::Failure;
use mbs_platform::{LegVector, Motion, Platform};

/// The payloads \[kg\].
pub const PAYLOADS: [u32; 3] = [0, 300, 1250];
/// Of the motion of table 4 \[kg\].
pub const PAYLOAD_OF_TABLE_4: u32 = 300;
/// The runs of the sensitivity analysis: names, and the angles φ, θ, ψ \[°\].
pub const TABLE_4: [(&str, [f64; 3]); 3] =
    [("base_psi20", [0.0, 0.0, 20.0]), ("theta10_psi20", [0.0, 10.0, 20.0]), ("phi10_psi20", [10.0, 0.0, 20.0])];
/// One period of both motions \[s\].
pub const DURATION: f64 = 4.0;

/// Moments of a motion \[s\].
pub struct Samples(pub(crate) Vec<f64>);

impl Samples {
    /// 0, 0.5, …, 4 s.
    pub fn coarse() -> Self {
        Self((0..=8).map(|i| 0.5 * f64::from(i)).collect())
    }

    /// Every hundredth of a second, for curves.
    pub fn fine() -> Self {
        Self((0..=400).map(|i| f64::from(i) / 100.0).collect())
    }
}

/// What the legs do along a motion, one row a sample.
pub struct Run {
    /// The payload \[kg\].
    pub payload: u32,
    /// The lengths \[m\].
    pub lengths: Vec<LegVector>,
    /// The forces \[N\].
    pub forces: Vec<LegVector>,
    /// The forces without actuators \[N\].
    pub forces_without_actuators: Vec<LegVector>,
}

/// Lengths and forces along a motion with a payload \[kg\].
pub fn run(platform: &Platform, payload: u32, motion: &Motion, samples: &Samples) -> Result<Run, Failure> {
    let loaded = platform.with_payload(f64::from(payload))?;
    let bare = loaded.without_actuator_inertia();
    let mut run = Run { payload, lengths: Vec::new(), forces: Vec::new(), forces_without_actuators: Vec::new() };
    for &t in &samples.0 {
        let [q, qd, qdd] = motion.at(t);
        run.lengths.push(loaded.lengths(&q)?);
        run.forces.push(loaded.leg_forces(&q, &qd, &qdd)?);
        run.forces_without_actuators.push(bare.leg_forces(&q, &qd, &qdd)?);
    }
    Ok(run)
}

/// One run for each payload.
pub fn table_3(platform: &Platform, samples: &Samples) -> Result<Vec<Run>, Failure> {
    PAYLOADS.iter().map(|&payload| run(platform, payload, &Motion::TABLE_3, samples)).collect()
}

/// Along the motion of Table 4 with an attitude in degrees.
pub fn table_4(platform: &Platform, angles: [f64; 3], samples: &Samples) -> Result<Run, Failure> {
    let motion = Motion::table_4_turned(angles.map(f64::to_radians));
    run(platform, PAYLOAD_OF_TABLE_4, &motion, samples)
}
