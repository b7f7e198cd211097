//! Wind near the ground: shear of the mean wind, and Dryden's turbulence at low altitude.
//!
//! The mean wind W(h) is horizontal and grows with the height h over the ground. Turbulence is carried past the vehicle
//! at the airspeed V as a frozen field; u is along the mean wind, v across it, w up. The spectra over the spatial
//! frequency Ω are
//!
//! ```text
//! Φ_u = σ_u² 2L_u/π 1/(1 + (L_u Ω)²)        Φ_v = σ_v² L_v/π (1 + 3 (L_v Ω)²)/(1 + (L_v Ω)²)²,  Φ_w alike
//! ```
//!
//! and the signals those of white noise n of unit intensity behind the filters
//!
//! ```text
//! H_u(s) = σ_u √(2τ) 1/(1 + τ s)            H_v(s) = σ_v √τ (1 + √3 τ s)/(1 + τ s)²,            τ = L/V
//! ```
//!
//! In the time `s = t/τ` the second one is `ẍ + 2ẋ + x = n`, `v = σ (x + √3 ẋ)`, where x and ẋ have the variance ¼ and
//! no covariance. [`Gusts`] keeps x and ẋ, whose stationary distribution depends neither on σ nor on τ, so that both
//! may change on the way down. A step is exact for constant τ: [`Gusts::advance`].
//!
//! Below 1000 ft, with h in feet and the wind W₂₀ at 20 ft,
//!
//! ```text
//! L_w = h,       L_u = L_v = h/(0.177 + 0.000823 h)^1.2
//! σ_w = 0.1 W₂₀, σ_u = σ_v = σ_w/(0.177 + 0.000823 h)^0.4
//! ```
//!
//! Heights below 10 ft count as 10 ft, those above 1000 ft as 1000 ft. MIL-HDBK-1797 has the same spectra and calls
//! half of these L_v and L_w its lengths.
//!
//! # Source
//! MIL-F-8785C, *Flying Qualities of Piloted Airplanes*, 1980, sections 3.7.1 to 3.7.3; MIL-HDBK-1797, *Flying
//! Qualities of Piloted Aircraft*, 1997, appendix A, 4.9.

use mbs_models::check::{Invalid, finite, not_negative, positive, within};
use mbs_runtime::Scalar;

/// One foot \[m\].
const FOOT: f64 = 0.3048;
/// Heights between which the formulas hold \[ft\].
const HEIGHTS: [f64; 2] = [10.0, 1000.0];
/// The height at which the wind is given \[ft\].
const GIVEN: f64 = 20.0;
/// Heights below count as this one in the logarithmic profile \[ft\].
const LEAST_SHEARED: f64 = 3.0;

/// How the mean wind grows with height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shear {
    /// `W = W₂₀ ln(h/z₀)/ln(20 ft/z₀)`; heights below 3 ft count as 3 ft.
    Logarithmic {
        /// z₀ \[m\], positive and less than 3 ft.
        roughness: f64,
    },
    /// `W = W₂₀ (h/20 ft)^p`.
    Power {
        /// p, not negative.
        exponent: f64,
    },
}

impl Shear {
    /// The logarithmic profile of take-off and landing, with a roughness of 0.15 ft.
    pub const LANDING: Self = Shear::Logarithmic { roughness: 0.15 * FOOT };

    /// W(h)/W₂₀ at a height \[m\]; NaN where that is.
    #[must_use]
    pub fn factor(&self, height: f64) -> f64 {
        match *self {
            Shear::Logarithmic { roughness } => {
                let height = raised(height, LEAST_SHEARED * FOOT);
                Scalar::ln(height / roughness) / Scalar::ln(GIVEN * FOOT / roughness)
            }
            Shear::Power { exponent } => Scalar::powf(raised(height, 0.0) / (GIVEN * FOOT), exponent),
        }
    }

    fn check(&self) -> Result<(), Invalid> {
        match *self {
            Shear::Logarithmic { roughness } => {
                positive("roughness", roughness)?;
                within("roughness", roughness, [0.0, (LEAST_SHEARED * FOOT).next_down()])
            }
            Shear::Power { exponent } => not_negative("exponent", exponent),
        }
    }
}

/// Not below the least one; NaN stays NaN.
fn raised(height: f64, least: f64) -> f64 {
    if height < least { least } else { height }
}

/// Lengths and standard deviations of turbulence at a height: of u, v, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turbulence {
    /// L \[m\], as MIL-F-8785C defines it.
    pub length: [f64; 3],
    /// σ \[m/s\].
    pub deviation: [f64; 3],
}

impl Turbulence {
    /// At a height \[m\] over the ground, with this wind at 20 ft \[m/s\].
    #[must_use]
    pub fn at(height: f64, wind_at_20_ft: f64) -> Self {
        let [least, greatest] = HEIGHTS;
        let feet = raised(height / FOOT, least);
        let feet = if feet > greatest { greatest } else { feet };
        let slender = 0.177 + 0.000_823 * feet;
        let along = FOOT * feet / Scalar::powf(slender, 1.2);
        let up = 0.1 * wind_at_20_ft;
        let ahead = up / Scalar::powf(slender, 0.4);
        Turbulence { length: [along, along, FOOT * feet], deviation: [ahead, ahead, up] }
    }
}

/// The wind over a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// W₂₀, at 20 ft over the ground \[m/s\].
    at_20_ft: f64,
    /// Where it blows to, from x towards y \[rad\].
    direction: f64,
    shear: Shear,
    /// The ground's height in the world \[m\].
    ground: f64,
}

impl Wind {
    /// The wind of this speed \[m/s\] at 20 ft, blowing towards a direction \[rad, from x towards y\], over a ground at
    /// this z \[m\].
    ///
    /// # Errors
    /// [`Invalid`]: a negative speed, a profile that has none at some height, numbers that are not finite.
    pub fn new(at_20_ft: f64, direction: f64, shear: Shear, ground: f64) -> Result<Self, Invalid> {
        not_negative("wind at 20 ft", at_20_ft)?;
        finite("direction", direction)?;
        shear.check()?;
        finite("ground", ground)?;
        Ok(Wind { at_20_ft, direction, shear, ground })
    }

    /// The mean wind at a height in the world \[m\], in world axes \[m/s\].
    #[must_use]
    pub fn mean(&self, z: f64) -> [f64; 3] {
        self.in_world([self.at_20_ft * self.shear.factor(z - self.ground), 0.0, 0.0])
    }

    /// The turbulence at a height in the world \[m\].
    #[must_use]
    pub fn turbulence(&self, z: f64) -> Turbulence {
        Turbulence::at(z - self.ground, self.at_20_ft)
    }

    /// Mean wind and gusts \[m/s\] at a place and a velocity of the vehicle, once the gusts have moved on for a time
    /// \[s\] with these normal deviates.
    ///
    /// The field passes at the airspeed `V = |W(h) − ẋ|`.
    pub fn blow(&self, gusts: &mut Gusts, z: f64, velocity: &[f64; 3], dt: f64, deviates: &[f64; 5]) -> [f64; 3] {
        let (mean, Turbulence { length, deviation }) = (self.mean(z), self.turbulence(z));
        let squares: f64 = mean.iter().zip(velocity).map(|(wind, own)| (wind - own) * (wind - own)).sum();
        let airspeed = Scalar::sqrt(squares);
        gusts.advance(length.map(|length| airspeed * dt / length), deviates);
        let unit = gusts.values();
        let gust = self.in_world([0, 1, 2].map(|i| deviation[i] * unit[i]));
        core::array::from_fn(|i| mean[i] + gust[i])
    }

    /// From along the wind, across it and up to the axes of the world.
    fn in_world(&self, [along, across, up]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = Scalar::sin_cos(self.direction);
        [cos * along - sin * across, sin * along + cos * across, up]
    }
}

/// Turbulence of unit variance at a moment: the states of the three filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    along: f64,
    /// x and ẋ, ẋ by t/τ.
    across: [f64; 2],
    up: [f64; 2],
}

impl Gusts {
    /// Drawn from the stationary distribution by five normal deviates.
    #[must_use]
    pub fn stationary(deviates: &[f64; 5]) -> Self {
        let [along, a, b, c, d] = *deviates;
        Gusts { along, across: [0.5 * a, 0.5 * b], up: [0.5 * c, 0.5 * d] }
    }

    /// u/σ_u, v/σ_v, w/σ_w.
    #[must_use]
    pub fn values(&self) -> [f64; 3] {
        let second = |[x, rate]: [f64; 2]| x + Scalar::sqrt(3.0) * rate;
        [self.along, second(self.across), second(self.up)]
    }

    /// A step of `d = V dt/L` for each of u, v, w, not negative, with five normal deviates.
    ///
    /// ```text
    /// u → e^−d u + √(1 − e^−2d) n        (x, ẋ) → Φ (x, ẋ) + √Q n,   Φ = e^−d [[1 + d, d], [−d, 1 − d]]
    /// Q = ∫ (s, 1 − s)ᵀ (s, 1 − s) e^−2s ds from 0 to d = ¼ (1 − Φ Φᵀ)
    /// ```
    pub fn advance(&mut self, steps: [f64; 3], deviates: &[f64; 5]) {
        let [along, across, up] = steps;
        let [n, a, b, c, d] = *deviates;
        self.along = Scalar::exp(-along) * self.along + Scalar::sqrt(2.0 * moment(0, along)) * n;
        self.across = second_order(self.across, across, [a, b]);
        self.up = second_order(self.up, up, [c, d]);
    }
}

fn second_order([x, rate]: [f64; 2], d: f64, [n, m]: [f64; 2]) -> [f64; 2] {
    let decay = Scalar::exp(-d);
    let moved = [decay * ((1.0 + d) * x + d * rate), decay * ((1.0 - d) * rate - d * x)];
    // Still air moves nothing, and has no noise to share out.
    if d == 0.0 {
        return moved;
    }
    let [one, first, second] = [moment(0, d), moment(1, d), moment(2, d)];
    let root = Scalar::sqrt(second);
    let shared = (first - second) / root;
    let own = one - 2.0 * first + second - shared * shared;
    [moved[0] + root * n, moved[1] + shared * n + Scalar::sqrt(own) * m]
}

/// `∫ sᵏ e^−2s ds` from 0 to d, for k up to 2: `k!/2ᵏ⁺¹ (1 − e^−z Σ zʲ/j!)` of j up to k, with z = 2d.
fn moment(k: i32, d: f64) -> f64 {
    let z = 2.0 * d;
    let (mut term, mut head) = (Scalar::exp(-z), 0.0);
    for j in 0..=k {
        head += term;
        term *= z / f64::from(j + 1);
    }
    let scale = if k == 0 { 0.5 } else { 0.25 };
    if z >= 1.0 || z.is_nan() {
        return scale * (1.0 - head);
    }
    // The rest of the series, where the difference would lose its digits.
    let mut tail = 0.0;
    for j in k + 1..k + 20 {
        tail += term;
        term *= z / f64::from(j + 1);
    }
    scale * tail
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Profiles and lengths by hand: 20 ft are 6.096 m; at 200 ft `0.177 + 0.1646 = 0.3416`.
    #[test]
    fn profiles_and_lengths_are_those_of_the_handbook() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a}, not {b}");
        close(Shear::LANDING.factor(6.096), 1.0);
        close(Shear::LANDING.factor(60.96), (200.0_f64 / 0.15).ln() / (20.0_f64 / 0.15).ln());
        close(Shear::LANDING.factor(-1.0), (3.0_f64 / 0.15).ln() / (20.0_f64 / 0.15).ln());
        close(Shear::Power { exponent: 0.25 }.factor(16.0 * 6.096), 2.0);
        let Turbulence { length, deviation } = Turbulence::at(60.96, 15.0);
        close(length[2], 60.96);
        close(length[0], 60.96 / 0.3416_f64.powf(1.2));
        close(deviation[2], 1.5);
        close(deviation[1], 1.5 / 0.3416_f64.powf(0.4));
        assert_eq!(Turbulence::at(1.0, 15.0), Turbulence::at(3.048, 15.0));
        // Far up turbulence is isotropic: 0.177 + 0.823 = 1.
        let high = Turbulence::at(2000.0, 15.0);
        close(high.length[0], 304.8);
        close(high.deviation[0], 1.5);
    }

    /// The noise of a step against `¼ (1 − Φ Φᵀ)`, and of two short steps against a long one.
    #[test]
    fn the_discretization_is_exact() {
        let noise = |d: f64| {
            let [n, m] = [[1.0, 0.0], [0.0, 1.0]].map(|deviates| second_order([0.0; 2], d, deviates));
            [n[0] * n[0] + m[0] * m[0], n[0] * n[1] + m[0] * m[1], n[1] * n[1] + m[1] * m[1]]
        };
        let transition = |d: f64| [[1.0, 0.0], [0.0, 1.0]].map(|x| second_order(x, d, [0.0; 2]));
        let carried = |[xx, xy, yy]: [f64; 3], d: f64| {
            let [[a, c], [b, e]] = transition(d);
            [
                a * a * xx + 2.0 * a * b * xy + b * b * yy,
                a * c * xx + (a * e + b * c) * xy + b * e * yy,
                c * c * xx + 2.0 * c * e * xy + e * e * yy,
            ]
        };
        for d in [0.3, 0.49, 0.51, 2.0, 9.0] {
            let left = carried([0.25, 0.0, 0.25], d);
            for (found, expected) in noise(d).iter().zip([0.25 - left[0], -left[1], 0.25 - left[2]]) {
                assert!((found - expected).abs() < 1e-15, "{d}: {found}, not {expected}");
            }
        }
        for d in [1e-4, 0.02, 0.4] {
            let (long, short) = (noise(2.0 * d), noise(d));
            let twice = carried(short, d);
            for i in 0..3 {
                assert!((twice[i] + short[i] - long[i]).abs() < 1e-13 * long[i].abs(), "{d}");
            }
        }
        assert_eq!(second_order([0.3, -0.2], 0.0, [1.0, 1.0]), [0.3, -0.2]);
    }

    #[test]
    fn wind_without_a_profile_is_refused() {
        let of = |speed: f64, shear: Shear| Wind::new(speed, 0.0, shear, 0.0);
        assert!(of(-1.0, Shear::LANDING).is_err() && of(f64::NAN, Shear::LANDING).is_err());
        for roughness in [0.0, 1.0, f64::NAN] {
            assert_eq!(of(5.0, Shear::Logarithmic { roughness }).unwrap_err().parameter, "roughness");
        }
        assert_eq!(of(5.0, Shear::Power { exponent: -0.1 }).unwrap_err().parameter, "exponent");
        assert!(Wind::new(5.0, 0.0, Shear::LANDING, f64::INFINITY).is_err());
    }
}
