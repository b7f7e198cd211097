//! What the landings came to, as text and as JSON.

use mbs_examples::Failure;
use mbs_landing::quadrotor::deck::Relative;
use mbs_models::quadrotor_euler::QuadrotorEuler;
use serde_json::{Map, Value, json};

use crate::landings::Landings;
use mbs_examples::quadrotor_landing::flight::{CASES, Flight, Kind, MARINE, ROTOR_RADIUS, TOLERANCE};
use mbs_examples::quadrotor_landing::gusts;
use mbs_examples::quadrotor_landing::platform::{OnPlatform, force_range};

pub(crate) fn to_json(landings: &Landings) -> Result<Value, Failure> {
    let mut all = Map::new();
    for case in CASES.map(|(case, _)| case).into_iter().chain([MARINE]) {
        let flights = landings.flights.iter().filter(|flight| flight.case == case && flight.kind != Kind::Unguided);
        let mut of_case: Map<String, Value> =
            flights.clone().map(|flight| (flight.kind.name().to_string(), results(flight))).collect();
        let end = flights.map(|flight| flight.touchdown.time).next().unwrap_or_default();
        let [least, greatest] = force_range(&landings.legs(case, end)?);
        let (mut on_platform, lowest) = match landings.on_platform(case) {
            Some(on_platform) => (comparisons(on_platform), on_platform.lowest),
            None => (comparisons(&landings.marine), landings.marine.lowest),
        };
        on_platform.insert("lowest_about_home".to_string(), lowest.into());
        on_platform.insert("leg_force".to_string(), json!({ "min": least, "max": greatest }));
        of_case.insert("platform".to_string(), on_platform.into());
        all.insert(case.to_string(), of_case.into());
    }
    let unguided = landings.flights.iter().filter(|flight| flight.kind == Kind::Unguided);
    all.insert("unguided".to_string(), unguided.map(|flight| (flight.case.to_string(), results(flight))).collect());
    let gusts = landings.gusts.iter().map(|in_gusts| (in_gusts.case.to_string(), in_gusts.to_json()));
    all.insert("gusts".to_string(), gusts.collect());
    Ok(all.into())
}

fn comparisons<const K: usize>(on_platform: &OnPlatform<K>) -> Map<String, Value> {
    on_platform.comparisons().map(|(name, comparison)| (name.to_string(), comparison.to_json())).into_iter().collect()
}

/// When the attitude was within half a degree for good \[s\]; none where it is not at the touchdown.
fn settled(flight: &Flight) -> Option<f64> {
    let end = &flight.touchdown;
    (end.settling_time < end.time).then_some(end.settling_time)
}

fn results(flight: &Flight) -> Value {
    let end = &flight.touchdown;
    let mut results = json!({
        "touchdown_time": end.time,
        "relative_velocity": end.relative_velocity,
        "max_phi_deg": end.greatest_tilt[0].to_degrees(),
        "max_theta_deg": end.greatest_tilt[1].to_degrees(),
        "settling_time": settled(flight),
        "thrust_min": end.thrust_range[0],
        "thrust_max": end.thrust_range[1],
        "horizontal_offset": end.horizontal_offset,
        "rotor_work": end.rotor_work,
        "deck_fall_max": end.deck_fall,
    });
    if flight.case == MARINE {
        let Relative { offset, velocity, attitude } = end.relative;
        results["offset_deck"] = json!(offset);
        results["velocity_deck"] = json!(velocity);
        results["attitude_deck_deg"] = json!(attitude.map(f64::to_degrees));
    }
    results
}

pub(crate) fn text(landings: &Landings) -> Result<String, Failure> {
    let mut text = String::from(
        "case   flight         touchdown    rel. velocity  offset     max φ   max θ   settled  thrust               at a limit  rotor work\n",
    );
    for flight in &landings.flights {
        let end = &flight.touchdown;
        text += &format!(
            "{:<6} {:<14} {:>9.5} s {:>10.5} m/s {:>9.2e} m {:>5.2}° {:>6.2}° {:>8} {:>6.1} to {:>6.1} N {:>8.1} % {:>9.0} J\n",
            flight.case,
            flight.kind.name(),
            end.time,
            end.relative_velocity,
            end.horizontal_offset,
            end.greatest_tilt[0].to_degrees(),
            end.greatest_tilt[1].to_degrees(),
            settled(flight).map_or_else(|| "-".to_string(), |time| format!("{time:.2} s")),
            end.thrust_range[0],
            end.thrust_range[1],
            100.0 * end.limited,
            end.rotor_work,
        );
    }
    let vehicle = QuadrotorEuler::<f64>::default();
    for (case, heave) in CASES {
        let bound = heave.acceleration_bound();
        let fall =
            landings.flights.iter().filter(|flight| flight.case == case).map(|flight| flight.touchdown.deck_fall);
        let fall = fall.fold(0.0, f64::max);
        if fall > vehicle.params().g {
            text += &format!(
                "case {case}: the platform falls with up to {fall:.3} m/s² (bound Σ A ω²: {bound:.2}), faster than freely; nothing that only pushes upwards follows\n",
            );
        }
    }
    text += &format!("unguided: the platform's elevation is followed, down to {TOLERANCE} m over it\n");
    text +=
        &format!("ground_effect: rotors of {ROTOR_RADIUS} m near the deck, of which the controller does not know\n");

    text += "\nDeck at sea, in its axes: offset and velocity at the touchdown, roll, pitch and yaw of the vehicle\n";
    for flight in landings.flights.iter().filter(|flight| flight.case == MARINE) {
        let Relative { offset: [x, y, _], velocity: [xd, yd, zd], attitude } = flight.touchdown.relative;
        let [roll, pitch, yaw] = attitude.map(f64::to_degrees);
        text += &format!(
            "  {:<14} {x:>8.5} {y:>8.5} m   {xd:>8.4} {yd:>8.4} {zd:>8.4} m/s   {roll:>6.2} {pitch:>6.2} {yaw:>6.2}°\n",
            flight.kind.name()
        );
    }

    text += "\nIn sheared wind and gusts, mean and standard deviation; controllers sampled at 500 Hz\n";
    text += &landings.gusts.iter().map(gusts::InGusts::summary).collect::<String>();

    text += "\nForces of the legs along the motions in full, by inverse dynamics, nothing on the platform\n";
    for flight in landings.flights.iter().filter(|flight| flight.kind == Kind::Exact) {
        let [least, greatest] = force_range(&landings.legs(flight.case, flight.touchdown.time)?);
        text += &format!("  {:<6} {least:.0} to {greatest:.0} N a leg\n", flight.case);
    }

    text += "\nOn the Stewart platform under its own control, from rest, controllers sampled at 500 Hz; differences \
             are from an exact deck and a controller in continuous time\n";
    for on_platform in &landings.heaving {
        text += &comparison_text(on_platform);
    }
    text += &comparison_text(&landings.marine);
    Ok(text)
}

fn comparison_text<const K: usize>(on_platform: &OnPlatform<K>) -> String {
    let OnPlatform { case, lowest, .. } = *on_platform;
    let mut text = on_platform.comparisons().map(|(name, comparison)| comparison.summary(case, name)).concat();
    if lowest <= 0.0 {
        text += &format!(
            "{:14}in full about home the platform would come down to {lowest:.3} m, through its own base, where no leg can hold it\n",
            ""
        );
    }
    text
}
