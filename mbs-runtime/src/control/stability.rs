//! Whether all motions decay, where rounding may have the last word.

use super::ControlError;
use super::dense::{balance, norm, transpose};
use super::eigenvalues::eigenvalues;
use super::natural_frequency;
use super::rank::unreached;

/// Which kind of time, and so which poles belong to motions that decay.
#[derive(Clone, Copy)]
pub(super) enum Time {
    /// Poles to the left of the imaginary axis.
    Continuous,
    /// Poles within the unit circle.
    Sampled,
}

/// A loop whose poles are farther than this from the border, as a part of its norm, does not owe that to rounding.
const CLEAR: f64 = 1e-6;

/// Motions that decay by less than this part of the norm may owe it to rounding. A double pole on the border is torn
/// farther apart than that, but to both sides.
const ROUNDING: f64 = 1e-12;

impl Time {
    /// Whether the loop `closed` is stable in earnest: what the inputs do not reach decays by itself, as a loop shows
    /// that clearly decays, and so does what the weight Q does not see.
    pub(super) fn is_stabilized<const N: usize, const U: usize>(
        self,
        closed: &[[f64; N]; N],
        a: &[[f64; N]; N],
        b: &[[f64; U]; N],
        q: &[[f64; N]; N],
    ) -> Result<bool, ControlError> {
        let margin = self.margin(closed)?;
        let is_reached = margin > CLEAR || margin > 0.0 && self.unreached_decays(a, b)?;
        Ok(is_reached && self.unreached_decays(&transpose(a), q)?)
    }

    fn unreached_decays<const N: usize, const U: usize>(
        self,
        a: &[[f64; N]; N],
        b: &[[f64; U]; N],
    ) -> Result<bool, ControlError> {
        let rest = unreached(a, b, |norm| match self {
            Time::Continuous => -norm.max(f64::MIN_POSITIVE),
            Time::Sampled => 0.0,
        })?;
        Ok(self.margin(&rest)? > ROUNDING)
    }

    /// How far the poles are from those that do not decay, as a part of the norm.
    fn margin<const N: usize>(self, a: &[[f64; N]; N]) -> Result<f64, ControlError> {
        let mut balanced = *a;
        balance(&mut balanced, &mut [[]; N]);
        let size = norm(&balanced);
        let poles = eigenvalues(a)?.into_iter();
        Ok(match self {
            Time::Continuous => poles.map(|pole| -pole.re / size.max(f64::MIN_POSITIVE)).fold(f64::INFINITY, f64::min),
            Time::Sampled => {
                poles.map(|pole| (1.0 - natural_frequency(pole)) / size.max(1.0)).fold(f64::INFINITY, f64::min)
            }
        })
    }
}
