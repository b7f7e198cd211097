//! The paths of the Earth and the Moon.

use std::path::Path;

use mbs_chart::{Figure, Panel, PlaneLine};
use mbs_examples::{Failure, output};

use crate::earth_moon::{Flight, Moment};

pub(crate) fn write(folder: &Path, flight: &Flight) -> Result<(), Failure> {
    let km =
        |body: usize| flight.path.iter().map(|row| [row.bodies[body][0] / 1e3, row.bodies[body][1] / 1e3]).collect();
    let seen = flight.path.iter().map(|row| [0, 1].map(|i| (row.bodies[1][i] - row.bodies[0][i]) / 1e3)).collect();
    let figure = |name: &str, what: &str, lines: Vec<PlaneLine>, origin: &str| {
        let plane = Panel::plane(["x [km]", "y [km]"], lines, vec![([0.0, 0.0], origin.to_string())]);
        let title = format!("The Earth and the Moon, {what}");
        output::write_figure(folder, name, &Figure { title, size: (1000, 900), panels: vec![plane] }, &crate::ASSUMED)
    };
    let both = vec![PlaneLine::new("Earth", km(0)), PlaneLine::new("Moon", km(1))];
    figure("two_body_barycentre", "seen from their barycentre", both, "barycentre")?;
    figure("two_body_relative", "the Moon seen from the Earth", vec![PlaneLine::new("Moon", seen)], "Earth")?;
    let row = |row: &Moment| [&[row.t][..], &row.bodies[0], &row.bodies[1]].concat();
    output::write_table(
        folder,
        "two_body",
        "t_s earth_x_m earth_y_m earth_z_m moon_x_m moon_y_m moon_z_m",
        flight.path.iter().map(row),
    )
}
