//! The attitude and the thrust that an acceleration asks for: (5.10) and (5.11), corrected.
//!
//! From `m (a + g e_z) = U R e_z`, with the yaw given.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, equations (5.10) and (5.11), which print
//! velocities in the place of some accelerations, and lose one (E33, E34 of `docs/thesis/errata.md`).

use mbs_models::check::{self, Invalid};
use mbs_runtime::Scalar;

/// Roll and pitch \[rad\], and the thrust per mass \[m/s²\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude {
    /// φ, between ±90°.
    pub roll: f64,
    /// θ, between ±90°.
    pub pitch: f64,
    /// `|a + g e_z|`.
    pub specific_thrust: f64,
}

/// The attitude with yaw ψ \[rad\] in which thrust gives the acceleration a \[m/s²\] against gravity g \[m/s²\].
///
/// # Errors
/// [`Invalid`] where `g + a_z` is not positive: rotors that only push upwards cannot give such an acceleration with an
/// attitude that is not upside down.
pub fn attitude(acceleration: [f64; 3], yaw: f64, gravity: f64) -> Result<Attitude, Invalid> {
    let [x, y, z] = acceleration;
    let upward = gravity + z;
    check::finite("acceleration", acceleration)?;
    check::positive("g + a_z", upward)?;
    let (sin, cos) = Scalar::sin_cos(yaw);
    let (ahead, aside) = (x * cos + y * sin, x * sin - y * cos);
    let in_plane = Scalar::sqrt(ahead * ahead + upward * upward);
    // asin(aside / |a + g e_z|), without its loss of digits near ±90°
    Ok(Attitude {
        roll: Scalar::atan2(aside, in_plane),
        pitch: Scalar::atan2(ahead, upward),
        specific_thrust: Scalar::sqrt(aside * aside + in_plane * in_plane),
    })
}

#[cfg(test)]
mod tests {
    use mbs_models::check::Must;

    use super::*;

    #[test]
    fn thrust_in_that_attitude_gives_the_acceleration() {
        for (a, yaw) in [([1.0, -2.0, 3.0], 0.4), ([0.0, 0.0, -9.0], 2.0), ([-30.0, 25.0, -5.0], -1.2)] {
            let Attitude { roll, pitch, specific_thrust: u } = attitude(a, yaw, 9.81).expect("upright");
            let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
            let axis = [sr * sy + cr * sp * cy, -cy * sr + sy * sp * cr, cp * cr];
            let found = [u * axis[0], u * axis[1], u * axis[2] - 9.81];
            assert!(found.iter().zip(a).all(|(f, a)| (f - a).abs() < 1e-13), "{found:?}");
        }
    }

    #[test]
    fn no_attitude_falls_faster_than_freely() {
        assert_eq!(attitude([0.0, 0.0, -11.0], 0.0, 9.0), Err(Must::BePositive.broken_by("g + a_z", -2.0)));
        assert!(attitude([f64::NAN, 0.0, 0.0], 0.0, 9.0).is_err());
    }
}
