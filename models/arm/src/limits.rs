//! What the drives of the arm allow.

use core::f64::consts::TAU;

use super::JointVector;
use mbs_models::check::{Invalid, Must};

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
    /// The second angle of Denavit and Hartenberg, which [`lower`](Self::lower) and [`upper`](Self::upper) bound, is
    /// the robot's own minus 90°.
    ///
    /// # Source
    /// Ranges and speeds are recalled from the manufacturer's product specification and were not looked up; that the
    /// senses of the axes are those of Denavit and Hartenberg is not verified against a drawing. Accelerations and
    /// torques are not published: they are assumed here, of the size that a payload of 500 kg asks for.
    pub const IRB7600: Self = Self {
        lower: radians([-180.0, -150.0, -180.0, -300.0, -100.0, -300.0]),
        upper: radians([180.0, -5.0, 60.0, 300.0, 100.0, 300.0]),
        speed: radians([75.0, 50.0, 55.0, 100.0, 100.0, 160.0]),
        acceleration: radians([90.0, 60.0, 70.0, 150.0, 150.0, 250.0]),
        torque: [20e3, 25e3, 12e3, 2.5e3, 2.5e3, 1.2e3],
    };

    /// Whether every range holds an angle, and every bound is positive; infinite ones are.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not so.
    pub fn check(&self) -> Result<(), Invalid> {
        for joint in 0..6 {
            let (lower, upper) = (self.lower[joint], self.upper[joint]);
            Must::BeAtLeast(lower).check("largest angle of joint", upper).map_err(|error| error.of(joint))?;
        }
        Must::BeMoreThan(0.0).check("largest speed of joint", self.speed)?;
        Must::BeMoreThan(0.0).check("largest acceleration of joint", self.acceleration)?;
        Must::BeMoreThan(0.0).check("largest torque of joint", self.torque)
    }

    /// How far the angle is out of the joint's range, turned as near to it as whole turns bring it \[rad\]; zero
    /// within.
    ///
    /// Infinite where the angle is, which no turn brings anywhere; NaN where the angle or an end of the range is.
    #[must_use]
    pub fn excess(&self, joint: usize, angle: f64) -> f64 {
        let (lower, upper) = (self.lower[joint], self.upper[joint]);
        if angle.is_nan() || lower.is_nan() || upper.is_nan() {
            return f64::NAN;
        }
        if angle.is_infinite() {
            return f64::INFINITY;
        }
        if lower == f64::NEG_INFINITY || upper == f64::INFINITY {
            return 0.0;
        }
        let middle = 0.5 * (lower + upper);
        let difference = angle - middle;
        let nearest = difference - round(difference / TAU) * TAU;
        (nearest.abs() - 0.5 * (upper - lower)).max(0.0)
    }

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

    /// The angle, of those that differ from `angle` by whole turns and lie in the range of the joint, that is nearest
    /// to `near`; `None` where none does.
    ///
    /// Axes 4 and 6 turn by more than once: there most angles have two values.
    ///
    /// ```
    /// use mbs_arm::JointLimits;
    ///
    /// let limits = JointLimits::IRB7600;
    /// let turn = |angle: f64, near: f64| limits.nearest_turn(3, angle.to_radians(), near.to_radians());
    /// let degrees = |angle, near| turn(angle, near).map(f64::to_degrees);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers() {
        for (x, down, up, nearest) in
            [(1.5, 1.0, 2.0, 2.0), (-1.5, -2.0, -1.0, -1.0), (3.0, 3.0, 3.0, 3.0), (-0.2, -1.0, 0.0, 0.0)]
        {
            assert_eq!((floor(x), ceil(x), round(x)), (down, up, nearest), "{x}");
        }
    }

    #[test]
    fn turns_are_found_where_the_range_has_them() {
        let limits = JointLimits { lower: radians([-300.0; 6]), upper: radians([300.0; 6]), ..JointLimits::IRB7600 };
        for angle in -720..=720 {
            for near in -400..=400 {
                let [angle, near] = [f64::from(angle), f64::from(near)];
                let found = limits.nearest_turn(0, angle.to_radians(), near.to_radians()).map(f64::to_degrees);
                let turns = (-4..=4).map(|turn| angle + 360.0 * f64::from(turn)).filter(|turn| turn.abs() <= 300.0);
                let best = turns.map(|turn| (turn - near).abs()).fold(f64::INFINITY, f64::min);
                assert!(
                    found.is_some_and(|found| ((found - near).abs() - best).abs() < 1e-9),
                    "{angle} near {near}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn limits_that_nothing_can_keep_are_named() {
        let limits = JointLimits::IRB7600;
        assert_eq!(limits.check(), Ok(()));
        let mut crossed = limits;
        crossed.upper[2] = -4.0;
        let range = Must::BeAtLeast(limits.lower[2]).broken_by("largest angle of joint", -4.0).of(2);
        assert_eq!(crossed.check(), Err(range));
        let mut still = limits;
        still.torque[5] = 0.0;
        assert_eq!(still.check(), Err(Must::BeMoreThan(0.0).broken_by("largest torque of joint", 0.0).of(5)));
        let mut unknown = limits;
        unknown.lower[1] = f64::NAN;
        assert!(matches!(unknown.check(), Err(Invalid { index: Some(1), must: Must::BeAtLeast(_), .. })));
    }

    #[test]
    fn the_excess_is_that_of_the_nearest_turn() {
        let limits = JointLimits::IRB7600;
        for (joint, degrees, want) in
            [(4, 110.0, 10.0), (4, -110.0, 10.0), (4, 250.0, 10.0), (4, 180.0, 80.0), (4, 0.0, 0.0), (1, 10.0, 15.0)]
        {
            let found = limits.excess(joint, f64::to_radians(degrees)).to_degrees();
            assert!((found - want).abs() < 1e-12, "{joint} at {degrees}: {found}");
        }
    }

    #[test]
    fn what_is_no_angle_is_never_within() {
        let bounded = JointLimits::IRB7600;
        let unbounded = JointLimits { lower: [f64::NEG_INFINITY; 6], upper: [f64::INFINITY; 6], ..bounded };
        for limits in [bounded, unbounded] {
            assert!(limits.excess(2, f64::NAN).is_nan());
            assert_eq!(limits.excess(2, f64::INFINITY), f64::INFINITY);
            assert_eq!(limits.excess(2, f64::NEG_INFINITY), f64::INFINITY);
            let mut unknown = limits;
            unknown.lower[2] = f64::NAN;
            assert!(unknown.excess(2, 0.0).is_nan());
            unknown = limits;
            unknown.upper[2] = f64::NAN;
            assert!(unknown.excess(2, 0.0).is_nan());
        }
        assert_eq!(unbounded.excess(2, 1e9), 0.0);
    }

    #[test]
    fn ends_belong_to_the_range() {
        let limits = JointLimits::IRB7600;
        assert_eq!((limits.violation(&limits.lower), limits.violation(&limits.upper)), (None, None));
        assert_eq!(limits.nearest_turn(1, limits.lower[1] - 1e-12, 0.0), Some(limits.lower[1] - 1e-12));
        assert_eq!(limits.nearest_turn(1, limits.lower[1] - 1e-6, 0.0), None);
        let mut q = [-0.5; 6];
        assert_eq!(limits.violation(&q), None);
        q[4] = f64::NAN;
        assert_eq!((limits.violation(&q), limits.nearest_turn(4, f64::NAN, 0.0)), (Some(4), None));
        assert_eq!(limits.nearest_turn(3, f64::INFINITY, 0.0), None);
        // Where nothing is known of the wanted place, the value itself if it can be.
        assert_eq!(limits.nearest_turn(3, 2.0, f64::NAN), Some(2.0));
    }
}
