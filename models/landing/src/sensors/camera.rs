//! A camera that looks along −z of the body and tells where known markers of the deck are in its image, some time
//! after.
//!
//! The image is that of a pinhole, lens errors are taken as calibrated. A marker is told where it is in the image with
//! a margin for its size; whether it is does not depend on the noise.

use nalgebra::Vector3;

use super::{Normal, Pose, deck_inputs};
use crate::quadrotor::deck::DeckState;
use mbs_models::check::{Invalid, finite, not_negative, positive};
use mbs_models::sensors::sensor_head::SensorHead;
use mbs_runtime::to_matrix;

/// This many markers are on the deck.
pub const MARKERS: usize = 8;

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// From the mass centre, in axes of the body \[m\].
    pub place: [f64; 3],
    /// Focal length \[px\].
    pub focal: f64,
    /// Width and height of the image \[px\]; the optical axis meets its middle.
    pub size: [f64; 2],
    /// Standard deviation of each of a marker's two coordinates \[px\].
    pub noise: f64,
    /// How far from the edge of the image a marker must be \[px\].
    pub margin: f64,
    /// The least distance along the optical axis at which a marker is sharp \[m\].
    pub least_depth: f64,
    /// From one image to the next \[s\].
    pub period: f64,
    /// From an image to what is told of it, less than the period \[s\].
    pub delay: f64,
}

/// What is told of an image: of each marker its place \[px\], if it was seen.
pub type Image = [Option<[f64; 2]>; MARKERS];

impl Camera {
    /// Of the markers at these places in axes of the deck \[m\].
    pub fn look(
        &self,
        head: &SensorHead<f64>,
        imu: &Pose,
        deck: &DeckState,
        markers: &[[f64; 3]; MARKERS],
        normal: &mut impl Normal,
    ) -> Image {
        markers.map(|marker| {
            let (q, u) = (imu.coordinates(), deck_inputs(deck, &in_world(deck, &marker)));
            let pixel = head.pixel(&q, &u);
            let noise = [normal.next(), normal.next()];
            let is_seen = head.depth(&q, &u) >= self.least_depth && self.is_inside(&pixel);
            is_seen.then(|| core::array::from_fn(|i| pixel[i] + self.noise * noise[i]))
        })
    }

    fn is_inside(&self, pixel: &[f64; 2]) -> bool {
        pixel.iter().zip(&self.size).all(|(x, size)| self.margin <= *x && *x <= size - self.margin)
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        finite("camera.place", self.place)?;
        for (name, value) in [
            ("camera.focal", self.focal),
            ("camera.noise", self.noise),
            ("camera.least_depth", self.least_depth),
            ("camera.period", self.period),
        ] {
            positive(name, value)?;
        }
        positive("camera.size", self.size)?;
        not_negative("camera.margin", self.margin)?;
        not_negative("camera.delay", self.delay)
    }
}

/// A place in axes of the deck, in the world \[m\].
#[must_use]
pub fn in_world(deck: &DeckState, place: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(deck.position) + to_matrix(&deck.rotation) * Vector3::from(*place)
}
