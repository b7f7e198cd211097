//! Gusts on what stands above the water.
//!
//! The wind is its mean U and gusts u with Davenport's spectrum,
//!
//! ```text
//! f S(f)/U² = 4 κ χ²/(1 + χ²)^(4/3),   χ = 1200 m f/U,   ∫ S df = 6 κ U²
//! ```
//!
//! drawn as waves are: N components of equal energy, each out of its part of it. Below χ is the part `1 − (1 +
//! χ²)^(−1/3)` of the energy; gusts faster than [`FASTEST`] are left out, for they do not reach over the whole of it.
//! The wind's force attacks at one point:
//!
//! ```text
//! F = ½ ρ C (A_front V|V| cos β, A_side V|V| sin β),   V = U + u,   K = −h F_y,   M = h F_x,   N = x F_y
//! ```
//!
//! β is where it blows to against the platform at rest; that the platform turns and moves is left out.
//!
//! # Source
//! A. G. Davenport, *The spectrum of horizontal gustiness near the ground in high winds*, Quarterly Journal of the
//! Royal Meteorological Society 87, 1961; κ over the sea, and forces: O. M. Faltinsen, *Sea Loads on Ships and Offshore
//! Structures*, 1990, chapters 2 and 6.

use core::f64::consts::PI;

use mbs_models::check::{Invalid, finite, not_negative};
use mbs_runtime::Scalar;

use super::{Four, drawn};

/// κ, the drag of the sea's surface.
pub const SURFACE_DRAG: f64 = 0.0015;
/// The fastest gusts that count \[Hz\].
pub const FASTEST: f64 = 0.5;
/// Davenport's length \[m\].
const LENGTH: f64 = 1200.0;

/// What the wind blows at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superstructure {
    /// Areas seen from ahead and from the side \[m²\].
    pub areas: [f64; 2],
    /// C.
    pub drag_coefficient: f64,
    /// ρ of the air \[kg/m³\].
    pub air_density: f64,
    /// Where the force attacks: ahead of and over the mass centre \[m\].
    pub place: [f64; 2],
}

impl Default for Superstructure {
    /// 60 and 90 m², C = 1.1, 1.5 m ahead of and 8 m over the mass centre.
    fn default() -> Self {
        Self { areas: [60.0, 90.0], drag_coefficient: 1.1, air_density: 1.225, place: [1.5, 8.0] }
    }
}

/// A wind with N gusts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind<const N: usize> {
    /// U, at a height of 10 m \[m/s\].
    pub mean: f64,
    /// β, where it blows to, from the x axis towards y \[rad\].
    pub direction: f64,
    /// Amplitude of every gust \[m/s\].
    pub amplitude: f64,
    /// Frequency \[rad/s\] and phase \[rad\] of each.
    pub gusts: [[f64; 2]; N],
}

impl<const N: usize> Wind<N> {
    /// A wind of this mean \[m/s\] and direction \[rad\]; `uniform` gives random numbers from 0 to below 1, two for a
    /// gust. Without a mean it is calm.
    ///
    /// # Errors
    /// [`Invalid`] where the mean is negative, something is not finite, a random number is out of its
    /// range, or N is zero.
    pub fn new(mean: f64, direction: f64, uniform: impl FnMut() -> f64) -> Result<Self, Invalid> {
        not_negative("mean wind", mean)?;
        finite("direction of the wind", direction)?;
        let mut gusts: [[f64; 2]; N] = drawn("number of gusts", uniform)?;
        // Of a calm nothing is drawn: `amplitude` is zero.
        let fastest = if mean > 0.0 { LENGTH * FASTEST / mean } else { 0.0 };
        let counted = 1.0 - Scalar::powf(1.0 + fastest * fastest, -1.0 / 3.0);
        for (n, [first, second]) in gusts.iter_mut().enumerate() {
            let left = 1.0 - counted * (n as f64 + *first) / N as f64;
            let chi = Scalar::sqrt(1.0 / (left * left * left) - 1.0);
            (*first, *second) = (2.0 * PI * chi * mean / LENGTH, 2.0 * PI * *second);
        }
        let amplitude = mean * Scalar::sqrt(2.0 * 6.0 * SURFACE_DRAG * counted / N as f64);
        Ok(Self { mean, direction, amplitude, gusts })
    }

    /// V at a time \[s\], gusts included \[m/s\].
    #[must_use]
    pub fn speed(&self, t: f64) -> f64 {
        let gust = |[frequency, phase]: &[f64; 2]| Scalar::cos(frequency * t + phase);
        self.mean + self.amplitude * self.gusts.iter().map(gust).sum::<f64>()
    }

    /// No force in heave, and moments about the platform's axes at a time \[s\] \[N, N·m\].
    #[must_use]
    pub fn at(&self, superstructure: &Superstructure, t: f64) -> Four {
        let Superstructure { areas: [front, side], drag_coefficient, air_density, place: [ahead, over] } =
            *superstructure;
        let speed = self.speed(t);
        let pressure = 0.5 * air_density * drag_coefficient * speed * speed.abs();
        let (sin, cos) = Scalar::sin_cos(self.direction);
        let (along, across) = (pressure * front * cos, pressure * side * sin);
        [0.0, -over * across, over * along, ahead * across]
    }
}
