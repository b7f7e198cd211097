//! Figures 7.3 and 7.4 of the thesis and their like, and the motions as numbers.

use std::path::Path;

use crate::{Failure, output};
use mbs_chart::{Figure, Line, Panel, PlaneLine};

use super::flight::{Flight, ORBITS};

/// What the motions rest on.
pub const ASSUMED: [&str; 1] = ["orbit."];

/// File, title, the unit of length in metres with its name, the kind of station, and the motions drawn.
type Drawing = (&'static str, &'static str, (f64, &'static str), &'static str, &'static [&'static str]);

const DRAWINGS: [Drawing; 3] = [
    (
        "near_with_station_mass",
        "3 m from a station that attracts as a point of 420 t",
        (1.0, "m"),
        "station_mass",
        &["near_radial", "near_tangent", "near_2to1_ellipse"],
    ),
    ("elliptic_near", "3.7 m from a station on an ellipse", (1.0, "m"), "elliptic", &["near"]),
    ("elliptic_far", "1000 km from a station on an ellipse", (1e3, "km"), "elliptic", &["far"]),
];

/// Whether the motion stays within a hundredth of its first distance.
fn stands(flight: &Flight) -> bool {
    let [x, y, z] = flight.case.start.q;
    let distance = x.hypot(y).hypot(z);
    flight.path.iter().all(|(_, state)| (state.q[0] - x).hypot(state.q[1] - y).hypot(state.q[2] - z) < 0.01 * distance)
}

/// What a motion begins with.
fn words(name: &str) -> &str {
    match name {
        "far_radial" | "near_radial" => "outwards, at rest",
        "far_tangent" | "near_tangent" => "along the track, at rest",
        "far_same_orbit" => "on the same circle",
        "near_2to1_ellipse" => "outwards, on the closed ellipse",
        other => other,
    }
}

/// Of all flights of a figure those `shown`; the others are lines without points, so that each has one style.
fn plane((unit, name): (f64, &str), flights: &[&Flight], shown: std::ops::Range<usize>) -> Panel {
    // A path too short to be seen is a point with its name.
    let marks = flights[shown.clone()]
        .iter()
        .filter(|flight| stands(flight))
        .map(|flight| {
            let [x, y, _] = flight.case.start.q;
            ([y / unit, x / unit], words(flight.case.name).to_string())
        })
        .chain([([0.0, 0.0], "station".to_string())])
        .collect();
    let line = |(i, flight): (usize, &&Flight)| {
        if !shown.contains(&i) {
            return PlaneLine::new("", Vec::new());
        }
        let points = flight.path.iter().map(|(_, state)| [state.q[1] / unit, state.q[0] / unit]).collect();
        PlaneLine::new(words(flight.case.name), points)
    };
    let labels = [format!("along the track [{name}]"), format!("away from the Earth [{name}]")];
    Panel::plane(labels.each_ref().map(String::as_str), flights.iter().enumerate().map(line).collect(), marks)
}

/// A component or the distance over the orbits of the station.
fn over_orbits(label: &str, unit: f64, flights: &[&Flight], value: fn([f64; 3]) -> f64) -> Panel {
    let line = |flight: &&Flight| {
        let period = flight.case.station.period();
        let points = flight.path.iter().map(|(t, state)| (t / period, value(state.q) / unit)).collect();
        Line::new(words(flight.case.name), points)
    };
    Panel::curves(["orbits of the station", label], 0.0..ORBITS, flights.iter().map(line).collect())
}

fn distance([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// Figures 7.3 and 7.4, of those motions about a station on a circle that are there.
pub fn drawn(flights: &[Flight]) -> Vec<(String, Figure)> {
    let named = |names: &[&str]| -> Vec<&Flight> {
        let is_drawn = |flight: &&Flight| flight.case.group == "circular" && names.contains(&flight.case.name);
        flights.iter().filter(is_drawn).collect()
    };
    let far = named(&["far_radial", "far_tangent", "far_same_orbit"]);
    let km = (1e3, "km");
    let panels = vec![
        Panel::Row(vec![plane(km, &far, 0..1), plane(km, &far, 1..far.len())]),
        over_orbits("distance [km]", 1e3, &far, distance),
    ];
    let title = format!("Figure 7.3: 1000 km from a station on a circle, {ORBITS} orbits");
    let mut figures = vec![("figure_7_3".to_string(), Figure { title, size: (1000, 760), panels })];

    let near = named(&["near_radial", "near_tangent", "near_2to1_ellipse"]);
    let m = (1.0, "m");
    let panels = vec![
        Panel::Row(vec![plane(m, &near, 0..1), plane(m, &near, 1..near.len())]),
        over_orbits("along the track [m]", 1.0, &near, |q| q[1]),
    ];
    let title = format!("Figure 7.4: 3 m from a station on a circle, {ORBITS} orbits");
    figures.push(("figure_7_4".to_string(), Figure { title, size: (1000, 760), panels }));
    figures
}

/// Writes the figures, and each motion as a table.
pub fn write(folder: &Path, flights: &[Flight]) -> Result<(), Failure> {
    output::write_figures(folder, &drawn(flights))?;
    for (file, title, unit, group, names) in DRAWINGS {
        let is_drawn = |flight: &&Flight| flight.case.group == group && names.contains(&flight.case.name);
        let drawn: Vec<&Flight> = flights.iter().filter(is_drawn).collect();
        let panels = vec![plane(unit, &drawn, 0..drawn.len())];
        let title = format!("{title}, {ORBITS} orbits");
        output::write_figure(folder, file, &Figure { title, size: (1000, 520), panels }, &ASSUMED)?;
    }
    for flight in flights {
        let rows = flight.path.iter().map(|(t, state)| [&[*t][..], &state.q, &state.qd].concat());
        let name = format!("{}_{}", flight.case.group, flight.case.name);
        output::write_table(folder, &name, "t_s x_m y_m z_m vx_m_s vy_m_s vz_m_s", rows)?;
    }
    Ok(())
}
