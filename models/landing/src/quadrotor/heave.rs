//! Elevation of the platform: a sum of sines, (5.9).
//!
//! As a motion of the platform it is [`Heave::about`], a [`Superposition`] of sines in all six coordinates. This one is
//! kept beside it for two reasons: the landings of the thesis are computed with exactly these products, `A ω` and `A
//! ω²`, which that one rounds in another order; and it needs one sine and one cosine a wave, not one of each for all
//! six coordinates, at every evaluation of a landing. That both are the same motion is tested.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, equation (5.9) and cases I and II.

use core::f64::consts::PI;

use mbs_runtime::Scalar;

use super::backstepping::Reference;
use mbs_platform::Superposition;

/// `z(t) = Σ Aᵢ sin(ωᵢ t)`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heave<const K: usize> {
    /// A \[m\].
    pub amplitude: [f64; K],
    /// ω \[rad/s\].
    pub frequency: [f64; K],
}

impl Heave<4> {
    /// Case I of the thesis: up to ±1.45 m, which is beyond the stroke of the platform of chapter 4.
    pub const CASE_I: Self = Heave { amplitude: AMPLITUDE, frequency: [0.3 * PI, 0.4 * PI, 0.2 * PI, 0.25 * PI] };
    /// Case II: it falls faster than a quadrotor can follow, up to 11.04 m/s².
    pub const CASE_II: Self = Heave { amplitude: AMPLITUDE, frequency: [1.2 * PI, PI, 0.5 * PI, 0.75 * PI] };
}

const AMPLITUDE: [f64; 4] = [0.2, 0.6, 0.5, 0.3];

impl<const K: usize> Heave<K> {
    /// Elevation \[m\], its rate and its acceleration.
    #[must_use]
    pub fn at(&self, t: f64) -> Reference {
        let mut at = Reference::default();
        for (&a, &w) in self.amplitude.iter().zip(&self.frequency) {
            let (sin, cos) = Scalar::sin_cos(w * t);
            at.value += a * sin;
            at.rate += a * w * cos;
            at.acceleration -= a * w * w * sin;
        }
        at
    }

    /// A platform that heaves so, level, about this height over its base \[m\].
    #[must_use]
    pub fn about(&self, middle: f64) -> Superposition<K> {
        Superposition::heave(middle, &self.amplitude, &self.frequency)
    }

    /// The greatest downward acceleration that it may have, `Σ Aᵢ ωᵢ²` \[m/s²\]: above g nothing that only falls can
    /// follow.
    #[must_use]
    pub fn acceleration_bound(&self) -> f64 {
        self.amplitude.iter().zip(&self.frequency).map(|(a, w)| a.abs() * w * w).sum()
    }
}
