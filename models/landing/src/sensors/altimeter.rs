//! A laser altimeter: the range along −z of the body to the plane of the deck, which moves and may be tilted.

use nalgebra::Vector3;

use super::{Normal, Pose, deck_inputs};
use crate::quadrotor::deck::DeckState;
use mbs_models::check::{Invalid, finite, positive, within};
use mbs_models::sensors::sensor_head::SensorHead;

/// A laser altimeter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Altimeter {
    /// From the mass centre, in axes of the body \[m\].
    pub place: [f64; 3],
    /// Standard deviation of a range \[m\].
    pub noise: f64,
    /// From one range to the next \[s\].
    pub period: f64,
    /// The least and the greatest range \[m\].
    pub ranges: [f64; 2],
    /// The greatest angle between beam and normal of the deck \[rad\].
    pub greatest_incidence: f64,
}

impl Altimeter {
    /// The range, where there is one: within its limits, not too oblique.
    pub fn measure(
        &self,
        head: &SensorHead<f64>,
        imu: &Pose,
        deck: &DeckState,
        normal: &mut impl Normal,
    ) -> Option<f64> {
        let (q, u) = (imu.coordinates(), deck_inputs(deck, &Vector3::zeros()));
        let (range, incidence) = (head.range(&q, &u), head.incidence(&q, &u));
        let noise = self.noise * normal.next();
        let [least, greatest] = self.ranges;
        let is_seen =
            least <= range && range <= greatest && incidence >= mbs_runtime::Scalar::cos(self.greatest_incidence);
        is_seen.then_some(range + noise)
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        finite("altimeter.place", self.place)?;
        positive("altimeter.noise", self.noise)?;
        positive("altimeter.period", self.period)?;
        let [least, greatest] = self.ranges;
        positive("altimeter.ranges", least)?;
        within("altimeter.ranges", greatest, [least, f64::MAX])?;
        within("altimeter.greatest_incidence", self.greatest_incidence, [0.0, core::f64::consts::FRAC_PI_2])
    }
}
