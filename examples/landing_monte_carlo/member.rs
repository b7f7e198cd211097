//! One landing with a vehicle, a wind, a start and sensors of its own.

use mbs_examples::quadrotor_landing::members::{around, deviates};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_models::Error;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};

/// The period of the controller and of RK4 \[s\].
const PERIOD: f64 = 1.0 / 500.0;
/// Standard deviations of mass, inertia and drag, relative.
const MASS: f64 = 0.02;
const INERTIA: f64 = 0.03;
const DRAG: f64 = 0.1;
/// The deviation of each component of a steady wind \[m/s\]; the vertical one is a tenth of it.
const WIND: f64 = 1.5;
/// The deviations of the first state \[m\], \[rad\], \[m/s\], \[rad/s\].
const START: [f64; 4] = [0.3, 0.035, 0.2, 0.05];
/// The deviations of what the sensors say, white, in the same units.
const SEEN: [f64; 4] = [0.005, 0.001, 0.01, 0.002];

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
