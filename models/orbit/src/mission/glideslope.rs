//! A straight approach by many pulses, slower the nearer it comes.
//!
//! ```text
//! ρ̇ = a ρ + ρ̇_T,   a = (ρ̇₀ − ρ̇_T)/ρ₀,   T = ln(ρ̇_T/ρ̇₀)/a
//! ρ(t) = ρ₀ e^{at} + (ρ̇_T/a) (e^{at} − 1)
//! ```
//!
//! with ρ the distance to go and ρ̇ < 0. Pulses come at equal intervals; each aims at the point of the line where the
//! next one is due. Between pulses the path leaves the line a little, less with more pulses.
//!
//! # Source
//! Hablani, Tapper, Dana-Bashian, *Guidance and relative navigation for autonomous rendezvous in a circular orbit*,
//! Journal of Guidance, Control, and Dynamics 25(3), 2002.

use mbs_models::{Error, Failure, check};
use mbs_runtime::Scalar;

/// Distance to go, and speeds at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glideslope {
    distance: f64,
    first_speed: f64,
    last_speed: f64,
}

impl Glideslope {
    /// Over a distance ρ₀ \[m\], from a speed −ρ̇₀ to a speed −ρ̇_T, both positive \[m/s\].
    ///
    /// # Errors
    /// [`Error`].
    pub fn new(distance: f64, first_speed: f64, last_speed: f64) -> Result<Self, Error> {
        check::positive("distance", distance)?;
        check::positive("first_speed", first_speed)?;
        check::positive("last_speed", last_speed)?;
        let slope = Self { distance, first_speed, last_speed };
        let (rate, duration) = (slope.rate(), slope.duration());
        let is_in_range = rate.is_finite() && duration > 0.0 && duration.is_finite();
        if is_in_range { Ok(slope) } else { Err(Failure::OutOfRange.into()) }
    }

    /// `a`, negative where it slows down \[1/s\].
    #[must_use]
    pub fn rate(&self) -> f64 {
        (self.last_speed - self.first_speed) / self.distance
    }

    /// `T` \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        // ln(1 + x)/x, which is 1 where both speeds are one.
        let x = (self.last_speed - self.first_speed) / self.first_speed;
        let ratio = if x.abs() < 1e-4 {
            1.0 - x * (0.5 - x * (1.0 / 3.0 - 0.25 * x))
        } else {
            Scalar::ln(self.last_speed / self.first_speed) / x
        };
        self.distance / self.first_speed * ratio
    }

    /// Distance to go after a time \[m\].
    #[must_use]
    pub fn distance(&self, time: f64) -> f64 {
        // (e^x − 1)/x, which is 1 where both speeds are one.
        let x = self.rate() * time;
        let ratio =
            if x.abs() < 1e-4 { 1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)) } else { (Scalar::exp(x) - 1.0) / x };
        // ρ₀ + (a ρ₀ + ρ̇_T) t (e^x − 1)/x, and the bracket is ρ̇₀.
        self.distance - self.first_speed * time * ratio
    }
}
