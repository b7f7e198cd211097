//! One landing with a vehicle, a wind, a start and sensors of its own.

use mbs_examples::quadrotor_landing::members::{DRAG, INERTIA, MASS, PERIOD, SEEN, START, WIND, around, deviates};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_models::Error;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};

/// Time, relative velocity and horizontal offset of the touchdown; the controller knows the vehicle as it was designed.
pub(crate) fn landed(seed: u64) -> Result<[f64; 3], Error> {
    let mut normal = deviates(seed);
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let designed = *landing.vehicle.params();
    let mut relative = |value: f64, deviation: f64| value * (deviation * normal()).exp();
    landing.vehicle = QuadrotorEuler::new(Params {
        m: relative(designed.m, MASS),
        inertias: designed.inertias.map(|inertia| relative(inertia, INERTIA)),
        drag_coefficient: relative(designed.drag_coefficient, DRAG),
        ..designed
    });
    landing.wind = [WIND, WIND, 0.1 * WIND].map(|deviation| deviation * normal());
    let start = around(&Landing::initial_state(), START, &mut normal);
    let end = landing.simulate_sampled(start, PERIOD, |_, state| around(state, SEEN, &mut normal))?;
    Ok([end.time, end.relative_velocity, end.horizontal_offset])
}
