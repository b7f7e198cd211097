//! Figures 7.3 and 7.4 of the thesis and their like, and the motions as numbers.

use std::path::Path;

use mbs_chart::{Figure, Panel, Plane, PlaneLine};
use mbs_examples::{Failure, output};

use crate::flight::{Flight, ORBITS};

/// File, title, the unit of length in metres with its name, the kind of station, and the motions drawn in each panel.
type Drawing = (&'static str, &'static str, (f64, &'static str), &'static str, &'static [&'static [&'static str]]);

const DRAWINGS: [Drawing; 5] = [
    (
        "figure_7_3",
        "Figure 7.3: 1000 km from a station on a circle",
        (1e3, "km"),
        "circular",
        &[&["far_radial"], &["far_tangent", "far_same_orbit"]],
    ),
    (
        "figure_7_4",
        "Figure 7.4: 3 m from a station on a circle",
        (1.0, "m"),
        "circular",
        &[&["near_radial"], &["near_tangent", "near_2to1_ellipse"]],
    ),
    (
        "near_with_station_mass",
        "3 m from a station that attracts as a point of 420 t",
        (1.0, "m"),
        "station_mass",
        &[&["near_radial", "near_tangent", "near_2to1_ellipse"]],
    ),
    ("elliptic_near", "3.7 m from a station on an ellipse", (1.0, "m"), "elliptic", &[&["near"]]),
    ("elliptic_far", "1000 km from a station on an ellipse", (1e3, "km"), "elliptic", &[&["far"]]),
];

/// Height of a panel in pixels.
const HEIGHT: u32 = 480;

/// Whether the motion stays within a hundredth of its first distance.
fn stands(flight: &Flight) -> bool {
    let [x, y, z] = flight.case.start.q;
    let distance = x.hypot(y).hypot(z);
    flight.path.iter().all(|(_, state)| (state.q[0] - x).hypot(state.q[1] - y).hypot(state.q[2] - z) < 0.01 * distance)
}

fn plane<'a>((unit, name): (f64, &str), flights: impl Iterator<Item = &'a Flight> + Clone) -> Panel {
    // A path too short to be seen is a point with its name.
    let standing = flights.clone().filter(|flight| stands(flight)).map(|flight| {
        let [x, y, _] = flight.case.start.q;
        ([y / unit, x / unit], flight.case.name.to_string())
    });
    let line = |flight: &Flight| {
        let points = flight.path.iter().map(|(_, state)| [state.q[1] / unit, state.q[0] / unit]).collect();
        PlaneLine::new(flight.case.name, points)
    };
    Panel::Plane(Plane {
        labels: [format!("along the track [{name}]"), format!("away from the Earth [{name}]")],
        marks: standing.chain([([0.0, 0.0], "station".to_string())]).collect(),
        lines: flights.map(line).collect(),
    })
}

pub(crate) fn write(folder: &Path, flights: &[Flight]) -> Result<(), Failure> {
    for (file, title, unit, group, panels) in DRAWINGS {
        let panel = |names: &&[&str]| {
            let is_drawn = |flight: &&Flight| flight.case.group == group && names.contains(&flight.case.name);
            plane(unit, flights.iter().filter(is_drawn))
        };
        let size = (1100, 40 + HEIGHT * panels.len() as u32);
        let title = format!("{title}, {ORBITS} orbits");
        output::write_figure(folder, file, &Figure { title, size, panels: panels.iter().map(panel).collect() })?;
    }
    let header = ["t_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s"].map(String::from);
    for flight in flights {
        let rows = flight.path.iter().map(|(t, state)| [&[*t][..], &state.q, &state.qd].concat());
        output::write_table(folder, &format!("{}_{}", flight.case.group, flight.case.name), &header, rows)?;
    }
    Ok(())
}
