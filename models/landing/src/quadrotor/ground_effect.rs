//! Ground effect: near a surface rotors push harder at the same speed.
//!
//! ```text
//! T / T∞ = 1 / (1 − (R / 4h)²)
//! ```
//!
//! for a rotor of radius R at the height h over a plane, in hover. The formula comes from one source and its image
//! below the plane; it grows without bound towards `h = R/4`, where no rotor does. Heights below a least one, in radii,
//! are taken for that one.
//!
//! # Source
//! I. C. Cheeseman and W. E. Bennett, *The Effect of the Ground on a Helicopter Rotor in Forward Flight*, Aeronautical
//! Research Council, Reports and Memoranda 3021, 1955, for hover. The least height is assumed.

use mbs_models::check::{self, Invalid};

/// How much harder rotors push near a deck. The deck is taken for an infinite plane, all rotors for equally high over
/// it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundEffect {
    /// R \[m\], positive and finite.
    rotor_radius: f64,
    /// The least height that counts, in radii; above a quarter, finite.
    least_height: f64,
}

/// The height at which the thrust of the formula has no bound \[radii\].
const UNBOUNDED: f64 = 0.25;

/// The least height that counts where none is given \[radii\].
pub const LEAST_HEIGHT: f64 = 0.5;

impl GroundEffect {
    /// Of rotors with this radius \[m\]; heights below half a radius count as that, so that thrust grows to 4/3 at
    /// most.
    ///
    /// # Errors
    /// [`Invalid`].
    pub fn new(rotor_radius: f64) -> Result<Self, Invalid> {
        Self::with_least_height(rotor_radius, LEAST_HEIGHT)
    }

    /// The ground effect of a rotor with another least height \[radii\].
    ///
    /// # Errors
    /// [`Invalid`]: a radius that is not positive, a height that is not above a quarter of it.
    pub fn with_least_height(rotor_radius: f64, least_height: f64) -> Result<Self, Invalid> {
        check::positive("rotor radius", rotor_radius)?;
        check::within("least height", least_height, [UNBOUNDED.next_up(), f64::MAX])?;
        Ok(GroundEffect { rotor_radius, least_height })
    }

    /// `T / T∞` at a height over the deck \[m\], at least 1; NaN where the height is.
    ///
    /// ```
    /// use mbs_landing::quadrotor::ground_effect::GroundEffect;
    ///
    /// let effect = GroundEffect::new(0.4).unwrap();
    /// // One radius up a rotor pushes harder by a fifteenth.
    /// assert!((effect.factor(0.4) - 16.0 / 15.0).abs() < 1e-15);
    /// assert_eq!(effect.factor(0.0), effect.factor(0.2));
    /// ```
    #[must_use]
    pub fn factor(&self, height: f64) -> f64 {
        let radii = height / self.rotor_radius;
        // NaN stays NaN.
        let radii = if radii < self.least_height { self.least_height } else { radii };
        let part = UNBOUNDED / radii;
        1.0 / (1.0 - part * part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thrust_grows_towards_the_deck_and_is_bounded() {
        let effect = GroundEffect::new(0.4).expect("rotors");
        assert_eq!(effect.factor(-3.0), 4.0 / 3.0);
        assert_eq!(effect.factor(0.2), 4.0 / 3.0);
        assert_eq!(effect.factor(f64::INFINITY), 1.0);
        assert!(effect.factor(f64::NAN).is_nan());
        let mut last = f64::INFINITY;
        for i in 0..200 {
            let h = 0.2 + 0.01 * f64::from(i);
            // T∞ / T + (R / 4h)² = 1
            let image = (0.4 / (4.0 * h)).powi(2);
            assert!((1.0 / effect.factor(h) + image - 1.0).abs() < 1e-15);
            assert!(effect.factor(h) < last);
            last = effect.factor(h);
        }
    }

    #[test]
    fn rotors_without_radius_and_heights_without_bound_are_refused() {
        for radius in [0.0, -0.4, f64::NAN, f64::INFINITY] {
            let refused = GroundEffect::new(radius);
            assert!(matches!(refused, Err(Invalid { parameter: "rotor radius", .. })), "{radius}");
        }
        for height in [0.25, 0.0, f64::NAN, f64::INFINITY] {
            let refused = GroundEffect::with_least_height(0.4, height);
            assert!(matches!(refused, Err(Invalid { parameter: "least height", .. })), "{height}");
        }
    }
}
