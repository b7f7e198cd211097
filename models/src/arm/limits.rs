//! What the drives of the arm allow.

use core::f64::consts::TAU;

use super::JointVector;

/// Ranges of the joint angles, and bounds of the magnitudes of their rates, accelerations and torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// Smallest angles \[rad\].
    pub lower: JointVector,
    /// Largest angles \[rad\].
    pub upper: JointVector,
    /// Largest speeds \[rad/s\].
    pub speed: JointVector,
    /// Largest accelerations \[rad/s²\].
    pub acceleration: JointVector,
    /// Largest torques \[N·m\].
    pub torque: JointVector,
}

/// How far past a limit an angle counts as on it \[rad\]: what rounding may add to an angle that was computed.
pub const LIMIT_TOLERANCE: f64 = 1e-10;

impl JointLimits {
    /// The IRB 7600-500/2.55.
    ///
    /// | joint | range of the robot's own angle | speed   | acceleration | torque    |
    /// |-------|--------------------------------|---------|--------------|-----------|
    /// | 1     | ±180°                          | 75 °/s  | 90 °/s²      | 20 kN·m   |
    /// | 2     | −60° … 85°                     | 50 °/s  | 60 °/s²      | 25 kN·m   |
    /// | 3     | −180° … 60°                    | 55 °/s  | 70 °/s²      | 12 kN·m   |
    /// | 4     | ±300°                          | 100 °/s | 150 °/s²     | 2.5 kN·m  |
    /// | 5     | ±100°                          | 100 °/s | 150 °/s²     | 2.5 kN·m  |
    /// | 6     | ±300°                          | 160 °/s | 250 °/s²     | 1.2 kN·m  |
    ///
    /// The second angle of Denavit and Hartenberg, which [`lower`](Self::lower) and [`upper`](Self::upper) bound, is the
    /// robot's own minus 90°.
    ///
    /// # Source
    /// Ranges and speeds are recalled from the manufacturer's product specification and were not looked up; that the senses of
    /// the axes are those of Denavit and Hartenberg is not verified against a drawing. Accelerations and torques are not
    /// published: they are assumed here, of the size that a payload of 500 kg asks for.
    pub const IRB7600: Self = Self {
        lower: radians([-180.0, -150.0, -180.0, -300.0, -100.0, -300.0]),
        upper: radians([180.0, -5.0, 60.0, 300.0, 100.0, 300.0]),
        speed: radians([75.0, 50.0, 55.0, 100.0, 100.0, 160.0]),
        acceleration: radians([90.0, 60.0, 70.0, 150.0, 150.0, 250.0]),
        torque: [20e3, 25e3, 12e3, 2.5e3, 2.5e3, 1.2e3],
    };

    /// The first joint whose angle is out of its range by more than [`LIMIT_TOLERANCE`], or NaN, counted from 0.
    #[must_use]
    pub fn violation(&self, q: &JointVector) -> Option<usize> {
        (0..6).find(|&i| !self.admits(i, q[i]))
    }

    /// Whether the range of the joint, counted from 0, holds the angle.
    #[must_use]
    pub fn admits(&self, joint: usize, angle: f64) -> bool {
        self.lower[joint] - LIMIT_TOLERANCE <= angle && angle <= self.upper[joint] + LIMIT_TOLERANCE
    }

    /// The angle, of those that differ from `angle` by whole turns and lie in the range of the joint, that is nearest to
    /// `near`; `None` where none does.
    ///
    /// Axes 4 and 6 turn by more than once: there most angles have two values.
    ///
    /// ```
    /// use mbs_models::arm::JointLimits;
    ///
    /// let limits = JointLimits::IRB7600;
    /// let degrees = |angle: f64, near: f64| limits.nearest_turn(3, angle.to_radians(), near.to_radians()).map(f64::to_degrees);
    /// assert_eq!(degrees(100.0, -250.0).map(f64::round), Some(-260.0));
    /// assert_eq!(degrees(100.0, 0.0).map(f64::round), Some(100.0));
    /// // The fifth joint ends at ±100°.
    /// assert_eq!(limits.nearest_turn(4, 2.0, 0.0), None);
    /// ```
    #[must_use]
    pub fn nearest_turn(&self, joint: usize, angle: f64, near: f64) -> Option<f64> {
        let [lower, upper] = [self.lower[joint] - LIMIT_TOLERANCE, self.upper[joint] + LIMIT_TOLERANCE];
        let turns = round((near - angle) / TAU);
        let fewest = ceil((lower - angle) / TAU);
        let most = floor((upper - angle) / TAU);
        // NaN and empty ranges fail the comparison.
        (fewest <= most).then(|| angle + turns.clamp(fewest, most) * TAU).filter(|&found| self.admits(joint, found))
    }
}

const fn radians(degrees: JointVector) -> JointVector {
    let mut angles = degrees;
    let mut i = 0;
    while i < 6 {
        angles[i] = degrees[i].to_radians();
        i += 1;
    }
    angles
}

/// The next smaller integer, where turns are counted: between ±2⁶³, as `as` saturates.
fn floor(x: f64) -> f64 {
    let integer = x as i64 as f64;
    if integer > x { integer - 1.0 } else { integer }
}

fn ceil(x: f64) -> f64 {
    -floor(-x)
}

fn round(x: f64) -> f64 {
    floor(x + 0.5)
}
