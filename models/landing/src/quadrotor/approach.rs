//! The way down: height over the platform against time.

use super::backstepping::Reference;

/// Height over the platform against time: a quintic down to a last height, then a steady sink rate. Assumed; the thesis
/// prints none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Height at the beginning \[m\], where it rests over the platform.
    pub height: f64,
    /// Height at which the quintic ends \[m\].
    pub last_height: f64,
    /// Sink rate from then on, not negative \[m/s\].
    pub sink_rate: f64,
    /// How long the quintic takes, positive \[s\].
    pub duration: f64,
}

impl Default for Approach {
    fn default() -> Self {
        Approach { height: 10.0, last_height: 0.25, sink_rate: 0.2, duration: 12.0 }
    }
}

impl Approach {
    /// No guidance: the deck's elevation itself is followed, z_r = z_p. The vehicle nears it without reaching it, so a
    /// landing needs a `touchdown_height` above zero.
    pub const UNGUIDED: Self = Approach { height: 0.0, last_height: 0.0, sink_rate: 0.0, duration: 1.0 };

    /// Height over the platform at t, the first one before t = 0.
    #[must_use]
    pub fn at(&self, t: f64) -> Reference {
        let Approach { height, last_height, sink_rate, duration: end } = *self;
        if t < 0.0 {
            return Reference::fixed(height);
        }
        if t >= end {
            return Reference { value: last_height - sink_rate * (t - end), rate: -sink_rate, acceleration: 0.0 };
        }
        // s³ (a + b s + c s²) of the fall and its rate at the end, at rest before; accelerations vanish at both ends.
        let (s, fall, rate) = (t / end, last_height - height, -sink_rate * end);
        let (a, b, c) = (10.0 * fall - 4.0 * rate, -15.0 * fall + 7.0 * rate, 6.0 * fall - 3.0 * rate);
        let s2 = s * s;
        Reference {
            value: height + s2 * s * (a + s * (b + s * c)),
            rate: s2 * (3.0 * a + s * (4.0 * b + s * 5.0 * c)) / end,
            acceleration: s * (6.0 * a + s * (12.0 * b + s * 20.0 * c)) / (end * end),
        }
    }
}
