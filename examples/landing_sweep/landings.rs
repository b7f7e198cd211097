//! What a plan may vary of a landing, and the landing with these values.

use mbs_ensemble::Member;
use mbs_examples::dispersion::Dispersion;
use mbs_examples::quadrotor_landing::members::{PERIOD, SEEN, around};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// What the plan may vary, with units.
pub(crate) const VARIABLES: [(&str, &str); 12] = [
    ("mass", "kg"),
    ("inertia", "1"),
    ("drag", "1"),
    ("wind_x", "m/s"),
    ("wind_y", "m/s"),
    ("wind_z", "m/s"),
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    // What the sensors' noise, the deck's amplitudes and its frequencies are multiplied by.
    ("sensors", "1"),
    ("sea", "1"),
    ("swell", "1"),
];

/// What is measured at a touchdown.
pub(crate) const QUANTITIES: [(&str, &str); 3] =
    [("touchdown_time", "s"), ("relative_velocity", "m/s"), ("horizontal_offset", "m")];

/// A landing with its touchdown's quantities; the controller knows the vehicle as it was designed.
pub(crate) fn land(dispersion: &Dispersion, member: &Member) -> Result<Vec<f64>, String> {
    let calm = Landing::new(Plant::Exact, Heave::CASE_I);
    let designed = *calm.vehicle.params();
    let usual = [designed.m, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let [m, inertia, drag, wind_x, wind_y, wind_z, x, y, z, sensors, sea, swell] =
        dispersion.in_order(&VARIABLES, usual, member);
    let heave = Heave {
        amplitude: Heave::CASE_I.amplitude.map(|amplitude| sea * amplitude),
        frequency: Heave::CASE_I.frequency.map(|frequency| swell * frequency),
    };
    let mut landing = Landing::new(Plant::Exact, heave);
    landing.vehicle = QuadrotorEuler::new(Params {
        m,
        inertias: designed.inertias.map(|of| inertia * of),
        drag_coefficient: drag * designed.drag_coefficient,
        ..designed
    });
    landing.wind = [wind_x, wind_y, wind_z];
    let mut start = Landing::initial_state();
    [x, y, z].iter().enumerate().for_each(|(i, off)| start.q[i] += off);
    let (mut random, seen) = (Pcg64Mcg::from_rng(&mut member.random()), SEEN.map(|deviation| sensors * deviation));
    let see = |_, state: &_| around(state, seen, || StandardNormal.sample(&mut random));
    let end = landing.simulate_sampled(start, PERIOD, see).map_err(|error| error.to_string())?;
    Ok(vec![end.time, end.relative_velocity, end.horizontal_offset])
}
