//! Do two bodies that attract each other keep to Kepler's laws?
//!
//! The Earth and a Moon that starts slowly, both in inertial axes, by the generated equations; and an ellipse of
//! eccentricity 0.6 in units in which all is about one, by Kepler's equation and by DOP853. Look at the drift of what
//! is conserved: energy, angular momentum, Laplace's vector, and the barycentre, which does not move.
//!
//! `--out DIR` writes the paths as SVG and PNG, and as CSV.

mod earth_moon;
mod ellipse;

use mbs_chart::{Figure, Panel, Plane, PlaneLine};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_examples::{print, println};
use serde_json::json;

/// What the motion of the Earth and the Moon rests on.
const ASSUMED: [&str; 1] = ["two_body.start"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let ellipse = ellipse::run()?;
    let earth_moon = earth_moon::run()?;
    if let Some(folder) = arguments.folder()? {
        write(folder, &earth_moon)?;
    }
    if arguments.json {
        let samples = |samples: &[(f64, [f64; 4])]| -> Vec<_> {
            samples.iter().map(|(t, state)| json!({"t": t, "state": state})).collect()
        };
        let [body1, body2] = earth_moon.bodies;
        let value = json!({
            "dimensionless": {"kepler": samples(&ellipse.kepler), "dop853": samples(&ellipse.dop853)},
            "earth_moon": {"body1_m": body1, "body2_m": body2, "barycentre_m": earth_moon.barycentre},
            "drift": {
                "energy": ellipse.drift.energy,
                "angular_momentum": ellipse.drift.angular_momentum,
                "laplace_vector": ellipse.drift.laplace_vector,
                "earth_moon_energy": earth_moon.energy_drift,
                "earth_moon_angular_momentum": earth_moon.momentum_drift,
                "barycentre_m": earth_moon.barycentre_drift,
            },
        });
        println!("{}", assumed::with(value, &ASSUMED));
        return Ok(());
    }
    println!("An ellipse of eccentricity 0.6, a = 1, mu = 1, from its pericentre, by Kepler's equation and by DOP853");
    for ((t, kepler), (_, dop853)) in ellipse.kepler.iter().zip(&ellipse.dop853) {
        let apart = kepler.iter().zip(dop853).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        println!("  t = {t:4}  x = {:19.16}  y = {:19.16}  apart by {apart:.1e}", kepler[0], kepler[1]);
    }
    let drift = &ellipse.drift;
    println!(
        "  greatest drift: energy {:.1e}, angular momentum {:.1e}, Laplace's vector {:.1e}",
        drift.energy, drift.angular_momentum, drift.laplace_vector
    );
    println!(
        "The Earth and a Moon that starts 384400 km away with 950 m/s, after {} days, from their barycentre [km]",
        earth_moon::DAYS
    );
    for (name, place) in ["Earth", "Moon"].iter().zip(earth_moon.bodies) {
        println!("  {name:<6} {:14.6} {:14.6}", place[0] / 1e3, place[1] / 1e3);
    }
    println!(
        "  greatest drift: energy {:.1e}, angular momentum {:.1e} of their values, barycentre {:.1e} m",
        earth_moon.energy_drift, earth_moon.momentum_drift, earth_moon.barycentre_drift
    );
    print!("{}", assumed::text(&ASSUMED));
    Ok(())
}

fn write(folder: &std::path::Path, flight: &earth_moon::Flight) -> Result<(), Failure> {
    let km =
        |body: usize| flight.path.iter().map(|row| [row.bodies[body][0] / 1e3, row.bodies[body][1] / 1e3]).collect();
    let seen = flight.path.iter().map(|row| [0, 1].map(|i| (row.bodies[1][i] - row.bodies[0][i]) / 1e3)).collect();
    let plane = |lines, origin: &str| {
        Panel::Plane(Plane {
            labels: ["x [km]", "y [km]"].map(String::from),
            lines,
            marks: vec![([0.0, 0.0], origin.to_string())],
        })
    };
    let title = |what: &str| format!("The Earth and the Moon, {what}");
    let about_the_barycentre = Figure {
        title: title("seen from their barycentre"),
        size: (1000, 900),
        panels: vec![plane(vec![PlaneLine::new("Earth", km(0)), PlaneLine::new("Moon", km(1))], "barycentre")],
    };
    output::write_figure(folder, "two_body_barycentre", &about_the_barycentre, &ASSUMED)?;
    let relative = Figure {
        title: title("the Moon seen from the Earth"),
        size: (1000, 900),
        panels: vec![plane(vec![PlaneLine::new("Moon", seen)], "Earth")],
    };
    output::write_figure(folder, "two_body_relative", &relative, &ASSUMED)?;
    let row = |row: &earth_moon::Moment| [&[row.t][..], &row.bodies[0], &row.bodies[1]].concat();
    output::write_table(
        folder,
        "two_body",
        "t_s earth_x_m earth_y_m earth_z_m moon_x_m moon_y_m moon_z_m",
        flight.path.iter().map(row),
    )
}
