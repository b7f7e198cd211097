//! Where the motions lead to and how they grow, as JSON and as text.

use mbs_examples::relative_motion::cases::Case;
use mbs_examples::relative_motion::flight::Flight;
use serde_json::{Map, Value, json};

use crate::sensitivity::{Growth, OFFSET, PLAINLY};

pub(crate) fn to_json(flights: &[Flight], growths: &[Growth]) -> Value {
    let mut groups = Map::new();
    for flight in flights {
        let group = groups.entry(flight.case.group).or_insert_with(|| json!({}));
        group[flight.case.name] = results(flight);
    }
    let hcw = flights.iter().find(|flight| flight.case.name == "near_radial").and_then(|flight| flight.hcw_difference);
    groups.insert("hcw_difference_m".into(), json!(hcw));
    let growth = |growth: &Growth| {
        json!({
            "case": growth.case,
            "station_mass_kg": growth.station_mass,
            "initial_perturbation_m": OFFSET,
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
    for (key, difference) in [
        ("kepler_difference_m", flight.kepler_difference),
        ("hcw_difference_m", flight.hcw_difference),
        ("cylindrical_difference_m", flight.cylindrical_difference),
    ] {
        if let Some(difference) = difference {
            value[key] = json!(difference);
        }
    }
    value
}

pub(crate) fn text(flights: &[Flight], growths: &[Growth]) -> String {
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
    text + PLAINLY
}
