//! Ranges and images about an estimate: residuals, and Jacobians from the generated ones of the sensor head.

use nalgebra::{SMatrix, SVector};

use super::filter::{ALL, CLONE, Estimate, Linearized};
use super::nominal::{ATTITUDE, PLACE, errors_to_coordinates};
use crate::quadrotor::deck::DeckState;
use crate::sensors::camera::{Image, MARKERS, in_world};
use crate::sensors::{Sensors, deck_inputs};
use mbs_models::sensors::sensor_head::SensorHead;
use mbs_runtime::to_matrix;
use nalgebra::Vector3;

/// Rows of an image.
pub const PIXELS: usize = 2 * MARKERS;

/// A range at the present pose, over the deck of this moment.
#[must_use]
pub fn range(
    sensors: &Sensors,
    head: &SensorHead<f64>,
    deck: &DeckState,
    range: f64,
    estimate: &Estimate,
) -> Linearized<1> {
    let pose = &estimate.nominal.pose;
    let (q, u) = (pose.coordinates(), deck_inputs(deck, &Vector3::zeros()));
    let mut jacobian = SMatrix::zeros();
    let by_q = to_matrix(&head.range_jacobian(&q, &u));
    place_rows(&mut jacobian, 0, [PLACE, ATTITUDE], &by_q, &errors_to_coordinates(pose, &estimate.origin));
    Linearized {
        residual: SVector::<f64, 1>::new(range - head.range(&q, &u)),
        jacobian,
        variance: SVector::<f64, 1>::new(sensors.altimeter.noise * sensors.altimeter.noise),
        freedom: 1,
    }
}

/// An image at the pose of the clone, over the deck of that moment; rows of markers that were not seen are zero.
#[must_use]
pub fn image(
    sensors: &Sensors,
    head: &SensorHead<f64>,
    deck: &DeckState,
    image: &Image,
    estimate: &Estimate,
) -> Linearized<PIXELS> {
    let (pose, q) = (&estimate.clone, estimate.clone.coordinates());
    let noise = sensors.camera.noise;
    let mut all = Linearized {
        residual: SVector::zeros(),
        jacobian: SMatrix::zeros(),
        variance: SVector::repeat(noise * noise),
        freedom: 0,
    };
    for (i, (seen, marker)) in image.iter().zip(&sensors.markers).enumerate() {
        let Some(seen) = seen else { continue };
        let u = deck_inputs(deck, &in_world(deck, marker));
        let expected = head.pixel(&q, &u);
        for k in 0..2 {
            all.residual[2 * i + k] = seen[k] - expected[k];
        }
        let by_q = to_matrix(&head.pixel_jacobian(&q, &u));
        place_rows(&mut all.jacobian, 2 * i, [CLONE, CLONE + 3], &by_q, &errors_to_coordinates(pose, &estimate.origin));
        all.freedom += 2;
    }
    all
}

/// Rows by errors of place and attitude of a pose, from those by its coordinates.
fn place_rows<const ROWS: usize, const M: usize>(
    jacobian: &mut SMatrix<f64, M, ALL>,
    row: usize,
    [place, attitude]: [usize; 2],
    by_coordinates: &SMatrix<f64, ROWS, 7>,
    by_errors: &SMatrix<f64, 7, 6>,
) {
    let by_errors = by_coordinates * by_errors;
    jacobian.fixed_view_mut::<ROWS, 3>(row, place).copy_from(&by_errors.fixed_columns::<3>(0));
    jacobian.fixed_view_mut::<ROWS, 3>(row, attitude).copy_from(&by_errors.fixed_columns::<3>(3));
}
