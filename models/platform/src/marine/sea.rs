//! Waves of a sea: components of equal energy with frequencies and phases at random.
//!
//! ```text
//! ζ(x, y, t) = Σ_n A cos(ω_n t − k_n (x cos χ_n + y sin χ_n) + ε_n),   k_n = ω_n²/g,   A = √(2 m₀/N)
//! ```
//!
//! Component n is drawn out of the n-th of N parts of the spectrum with equal energy, so that `Σ ½ A² = m₀` exactly,
//! frequencies are in no ratio, and the record does not repeat. Waves shorter than [`SHORTEST`] are left out: they have
//! 0.1 % of the energy and do not move a platform that is longer than they are.
//!
//! # Source
//! O. M. Faltinsen, *Sea Loads on Ships and Offshore Structures*, 1990, chapter 2 (irregular waves, deep water,
//! directional spreading).

use core::f64::consts::{FRAC_PI_2, PI};

use mbs_models::check::{Invalid, finite};
use mbs_runtime::Scalar;

use super::drawn;
use super::spectrum::{GRAVITY, Jonswap};

/// The highest frequency, in peak frequencies.
pub const SHORTEST: f64 = 5.0;

/// A component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// A \[m\].
    pub amplitude: f64,
    /// ω \[rad/s\].
    pub frequency: f64,
    /// χ, where it goes to, from the x axis towards y \[rad\].
    pub direction: f64,
    /// ε \[rad\].
    pub phase: f64,
}

impl Wave {
    /// `k = ω²/g` in deep water, under the standard acceleration of gravity, [`GRAVITY`] \[rad/m\].
    #[must_use]
    pub fn number(&self) -> f64 {
        self.frequency * self.frequency / GRAVITY
    }

    /// ωt + ε less the phase that a place is behind \[rad\].
    fn angle(&self, [x, y]: [f64; 2], t: f64) -> f64 {
        let (sin, cos) = Scalar::sin_cos(self.direction);
        self.frequency * t - self.number() * (x * cos + y * sin) + self.phase
    }
}

/// How waves go in directions beside the main one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spreading {
    /// All in one direction: long crests.
    None,
    /// With the energy `2/π cos²` of the angle from the main direction, up to a right angle.
    CosineSquared,
}

/// A sea of N waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sea<const N: usize> {
    /// From the longest to the shortest.
    pub waves: [Wave; N],
}

impl<const N: usize> Sea<N> {
    /// A sea with this spectrum and this main direction \[rad\].
    ///
    /// `uniform` gives random numbers from 0 to below 1; three of them make a wave. The same numbers make the same sea.
    ///
    /// # Errors
    /// [`Invalid`] where the direction is not finite, a random number is out of its range, or N is zero.
    pub fn new(
        spectrum: &Jonswap,
        direction: f64,
        spreading: Spreading,
        uniform: impl FnMut() -> f64,
    ) -> Result<Self, Invalid> {
        finite("direction of the waves", direction)?;
        let drawn: [[f64; 3]; N] = drawn("number of waves", uniform)?;
        let amplitude = Scalar::sqrt(2.0 * spectrum.variance() / N as f64);
        let mut waves = drawn.map(|[_, beside, turn]| Wave {
            amplitude,
            frequency: 0.0,
            direction: direction
                + match spreading {
                    Spreading::None => 0.0,
                    Spreading::CosineSquared => cosine_squared(beside),
                },
            phase: 2.0 * PI * turn,
        });
        let parts = drawn.iter().enumerate().map(|(n, [within, ..])| (n as f64 + within) / N as f64);
        let mut next = 0;
        spectrum.quantiles(SHORTEST, parts, |frequency| {
            waves[next].frequency = frequency;
            next += 1;
        });
        Ok(Self { waves })
    }

    /// ζ at a place (x, y) \[m\] and a time \[s\].
    #[must_use]
    pub fn elevation(&self, place: [f64; 2], t: f64) -> f64 {
        self.waves.iter().map(|wave| wave.amplitude * Scalar::cos(wave.angle(place, t))).sum()
    }

    /// `Σ ½ A² ωⁿ` \[m²/sⁿ\].
    #[must_use]
    pub fn moment(&self, order: i32) -> f64 {
        let power = |x: f64| (0..order).fold(1.0, |product, _| product * x);
        self.waves.iter().map(|wave| 0.5 * wave.amplitude * wave.amplitude * power(wave.frequency)).sum()
    }
}

/// The angle below which this part of the energy `2/π cos² χ` goes: `½ + (χ + ½ sin 2χ)/π`, by halving.
fn cosine_squared(part: f64) -> f64 {
    let (mut low, mut high) = (-FRAC_PI_2, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let below = 0.5 + (middle + 0.5 * Scalar::sin(2.0 * middle)) / PI;
        if below < part { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
