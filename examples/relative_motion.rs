//! How does an astronaut drift about an orbital station, 1000 km and 3 m away from it?
//!
//! Released at rest relative to the station, or on the station's own orbit; a station on a circle or an ellipse, with
//! and without a mass of its own. Each motion is integrated in the station's axes by the generated equations, and found
//! again as the difference of two Kepler motions. Look at the last table: it says what becomes of a thousandth of a
//! millimetre, and with that whether the motion near the station is chaotic.
//!
//! `--out DIR` writes figures 7.3 and 7.4 and their like as SVG and PNG, and every motion as CSV.

#[path = "relative_motion/sensitivity.rs"]
mod sensitivity;

use mbs_examples::relative_motion::cases::{self, Case};
use mbs_examples::relative_motion::figures;
use mbs_examples::relative_motion::flight::Flight;
use mbs_examples::{Failure, arguments::Arguments};
use mbs_orbit::EARTH_RADIUS;
use serde_json::{Map, Value, json};

/// What the motions rest on.
const ASSUMED: [&str; 1] = ["orbit."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("relative_motion.rs"));
    let flights: Vec<Flight> = cases::all()?.into_iter().map(Flight::of).collect::<Result<_, _>>()?;
    let growths = sensitivity::all()?;
    for flight in &flights {
        if let Some(warning) = flight.case.station.below(EARTH_RADIUS) {
            eprintln!("warning: {}: {warning}", flight.case.name);
        }
    }
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &flights)?;
    }
    arguments.answer(to_json(&flights, &growths), &summary(&flights, &growths), &ASSUMED);
    Ok(())
}

fn to_json(flights: &[Flight], growths: &[sensitivity::Growth]) -> Value {
    let mut groups = Map::new();
    for flight in flights {
        let group = groups.entry(flight.case.group).or_insert_with(|| json!({}));
        group[flight.case.name] = results(flight);
    }
    let hcw = flights.iter().find(|flight| flight.case.name == "near_radial").and_then(|flight| flight.hcw_difference);
    groups.insert("hcw_difference_m".into(), json!(hcw));
    let growth = |growth: &sensitivity::Growth| {
        json!({
            "case": growth.case,
            "station_mass_kg": growth.station_mass,
            "initial_perturbation_m": sensitivity::OFFSET,
            "amplification_after_orbits": growth.amplification,
        })
    };
    groups.insert("sensitivity".into(), growths.iter().map(growth).collect());
    Value::Object(groups)
}

fn results(flight: &Flight) -> Value {
    let end = &flight.end;
    let mut value = json!({
        "position_km": end.q.map(|x| x / 1e3),
        "velocity_km_s": end.qd.map(|x| x / 1e3),
        "position_m": end.q,
        "velocity_m_s": end.qd,
    });
    if let Some(difference) = flight.kepler_difference {
        value["kepler_difference_m"] = json!(difference);
    }
    if let Some(difference) = flight.hcw_difference {
        value["hcw_difference_m"] = json!(difference);
    }
    if let Some(difference) = flight.cylindrical_difference {
        value["cylindrical_difference_m"] = json!(difference);
    }
    value
}

fn summary(flights: &[Flight], growths: &[sensitivity::Growth]) -> String {
    let mut text = String::from(
        "circular: 400 km above the Earth; elliptic: a = 7500 km, e = 0.1, from the perigee on; station_mass: circular, a point of 420 t\n\
         released at rest in the station's axes, but for far_same_orbit, near_2to1_ellipse, near_3d and near\n\
         the last columns: apart by how many metres from two Kepler motions, from Clohessy and Wiltshire, from cylindrical coordinates\n\n\
         after one orbit of the station                x [m]              y [m]         z [m]   two Keplers    linear  cylindrical\n",
    );
    for flight in flights {
        let Case { group, name, .. } = flight.case;
        let [x, y, z] = flight.end.q;
        let or_dash = |difference: Option<f64>| difference.map_or_else(|| "-".to_string(), |d| format!("{d:.1e}"));
        text += &format!(
            "{group:<13} {name:<17} {x:18.6} {y:18.6} {z:13.6} {:>13} {:>9} {:>12}\n",
            or_dash(flight.kepler_difference),
            or_dash(flight.hcw_difference),
            or_dash(flight.cylindrical_difference)
        );
    }
    text += "\nby what factor a displacement of 1e-6 m has grown after 1, 2, 3, … orbits\n";
    for growth in growths {
        let factors: Vec<String> = growth.amplification.iter().map(|factor| format!("{factor:9.1}")).collect();
        text += &format!("{:<17} station of {:>6.0} t {}\n", growth.case, growth.station_mass / 1e3, factors.join(" "));
    }
    text + sensitivity::PLAINLY
}
