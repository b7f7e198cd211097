//! The JONSWAP spectrum of a sea that the wind still raises.
//!
//! ```text
//! S(ω) = C ω⁻⁵ exp(−5/4 (ω_p/ω)⁴) γ^r,   r = exp(−(ω/ω_p − 1)²/(2 σ²)),   σ = 0.07 below ω_p, 0.09 above
//! ```
//!
//! C is such that `m₀ = ∫ S dω = Hs²/16`. With `v = (ω_p/ω)²`, in which the tail ω⁻⁵ has a finite range, moments are
//! `m_n = C' ω_pⁿ ∫ ½ v^(1 − n/2) exp(−5/4 v²) γ^r dv`.
//!
//! # Source
//! K. Hasselmann et al., *Measurements of wind-wave growth and swell decay during the Joint North Sea Wave Project*,
//! Deutsche Hydrographische Zeitschrift, supplement A 8:12, 1973. The steepest seas: DNV-RP-C205, *Environmental
//! conditions and environmental loads*, section 3.5.

use core::f64::consts::PI;

use mbs_models::check::{Invalid, Must, positive, within};
use mbs_runtime::Scalar;

/// Acceleration of gravity that seas are reckoned with, assumed: the standard one \[m/s²\].
pub const GRAVITY: f64 = 9.80665;
/// γ, the mean of what was measured in the project.
pub const PEAKEDNESS: f64 = 3.3;
/// v beyond which nothing is left: frequencies below 0.4 ω_p.
const LONGEST: f64 = 6.0;
/// Cells to the unit of v; a panel of Simpson's rule ends at the kink v = 1.
const STEPS: usize = 1000;
const PANELS: usize = LONGEST as usize * STEPS;

/// A spectrum of waves; made by [`Jonswap::new`], which refuses seas that there are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jonswap {
    /// Hs \[m\], positive.
    height: f64,
    /// Tp \[s\], long enough for this height.
    period: f64,
    /// γ, at least 1.
    peakedness: f64,
    /// `∫ x⁻⁵ exp(−5/4 x⁻⁴) γ^r dx`, x = ω/ω_p.
    area: f64,
}

impl Jonswap {
    /// By the significant wave height Hs \[m\], the peak period Tp \[s\] and the peakedness γ, from 1 (a fully
    /// developed sea, Pierson and Moskowitz) to 7.
    ///
    /// ```
    /// use mbs_platform::marine::spectrum::Jonswap;
    ///
    /// let sea = Jonswap::new(2.5, 10.0, 3.3).unwrap();
    /// assert_eq!(sea.variance(), 2.5 * 2.5 / 16.0);
    /// assert!(Jonswap::new(6.0, 5.0, 3.3).unwrap_err().to_string().contains("must be at most"));
    /// ```
    ///
    /// # Errors
    /// [`Invalid`], also where `2π Hs/(g Tp²)` is more than 1/15 (from 15 s on
    /// 1/25, linear between 8 s and 15 s).
    pub fn new(height: f64, period: f64, peakedness: f64) -> Result<Self, Invalid> {
        positive("significant wave height", height)?;
        positive("peak period", period)?;
        within("peakedness", peakedness, [1.0, 7.0])?;
        let steepness = 2.0 * PI * height / (GRAVITY * period * period);
        let longer = ((period - 8.0) / 7.0).clamp(0.0, 1.0);
        let limit = (1.0 - longer) / 15.0 + longer / 25.0;
        Must::BeAtMost(limit).check("steepness 2π Hs/(g Tp²) of the waves", steepness)?;
        let area = simpson(LONGEST, PANELS, |v| v * shape(v, peakedness));
        Ok(Self { height, period, peakedness, area })
    }

    /// Hs \[m\].
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Tp \[s\].
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period
    }

    /// γ.
    #[must_use]
    pub fn peakedness(&self) -> f64 {
        self.peakedness
    }

    /// ω_p \[rad/s\].
    #[must_use]
    pub fn peak(&self) -> f64 {
        2.0 * PI / self.period
    }

    /// `m₀ = Hs²/16`, the variance of the elevation \[m²\].
    #[must_use]
    pub fn variance(&self) -> f64 {
        self.height * self.height / 16.0
    }

    /// S(ω) \[m²·s\] at a frequency \[rad/s\]; 0 where that is not positive.
    #[must_use]
    pub fn density(&self, frequency: f64) -> f64 {
        if frequency <= 0.0 {
            return 0.0;
        }
        let x = frequency / self.peak();
        let v = 1.0 / (x * x);
        // x⁻⁵ is v² √v.
        self.variance() / (self.area * self.peak()) * 2.0 * v * v * Scalar::sqrt(v) * shape(v, self.peakedness)
    }

    /// `Tz = 2π √(m₀/m₂)`, the mean time between two upward crossings of the mean level \[s\]; waves of every length
    /// count.
    #[must_use]
    pub fn zero_crossing_period(&self) -> f64 {
        let second = simpson(LONGEST, PANELS, |v| shape(v, self.peakedness));
        self.period * Scalar::sqrt(self.area / second)
    }

    /// Calls `take(frequency)` for each of the frequencies \[rad/s\] below which the given parts of the energy are,
    /// in order from the longest wave to the shortest, of those not shorter than `shortest` peak frequencies.
    ///
    /// `parts` rise from 0 to 1.
    pub(super) fn quantiles(&self, shortest: f64, parts: impl Iterator<Item = f64>, mut take: impl FnMut(f64)) {
        // From long to short waves v falls.
        let end = 1.0 / (shortest * shortest);
        let cells = 20 * STEPS;
        let width = (LONGEST - end) / cells as f64;
        let energy = |cell: usize| {
            let v = LONGEST - (cell as f64 + 0.5) * width;
            v * shape(v, self.peakedness)
        };
        let total: f64 = (0..cells).map(energy).sum();
        let (mut cell, mut below) = (0, 0.0);
        for part in parts {
            let wanted = part * total;
            while cell + 1 < cells && below + energy(cell) < wanted {
                below += energy(cell);
                cell += 1;
            }
            let within = ((wanted - below) / energy(cell)).clamp(0.0, 1.0);
            let v = LONGEST - (cell as f64 + within) * width;
            take(self.peak() / Scalar::sqrt(v));
        }
    }
}

/// `½ exp(−5/4 v²) γ^r`.
fn shape(v: f64, peakedness: f64) -> f64 {
    let width = if v >= 1.0 { 0.07 } else { 0.09 };
    // Far out on the side of short waves γ^r is 1.
    let r = if v > 0.0 {
        let off = (1.0 / Scalar::sqrt(v) - 1.0) / width;
        Scalar::exp(-0.5 * off * off)
    } else {
        0.0
    };
    0.5 * Scalar::exp(r * Scalar::ln(peakedness) - 1.25 * v * v)
}

/// `∫₀^end f`, by Simpson's rule over this many equal panels.
pub(super) fn simpson(end: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    let step = 0.5 * end / panels as f64;
    let panel = |k: usize| {
        let a = 2.0 * step * k as f64;
        f(a) + 4.0 * f(a + step) + f(a + 2.0 * step)
    };
    step / 3.0 * (0..panels).map(panel).sum::<f64>()
}
