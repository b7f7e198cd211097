//! What does a small body do that the Earth and the Moon, or another pair on circles, attract?
//!
//! The five points where it rests and whether it stays there; Arenstorf's orbit, which comes back after three loops if
//! and only if the equations and the integration are right; asteroids that keep company with a planet in its orbit, as
//! a tadpole about L₄ and as a horseshoe. Look at Jacobi's constant, the energy integral that the generator found by
//! itself: how little it changes says how good the motion is.
//!
//! `--out DIR` writes the orbits as SVG and PNG, and as CSV.

mod orbits;
mod summary;

use std::path::Path;

use mbs_chart::{Figure, Panel, PlaneLine};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_orbit::libration::points;

use orbits::{Flight, arenstorf, asteroids};

/// What the motions of the asteroids rest on.
const ASSUMED: [&str; 1] = ["three_body.asteroids"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let closed = arenstorf()?;
    let asteroids = asteroids()?;
    if let Some(folder) = arguments.folder()? {
        write(folder, "arenstorf", "Arenstorf's orbit", &closed, &[])?;
        for asteroid in &asteroids {
            write(folder, asteroid.name, &format!("An asteroid: {}", asteroid.name), &asteroid.flight, &ASSUMED)?;
        }
    }
    let results = summary::to_json(&closed, &asteroids)?;
    arguments.answer(results, &summary::text(&closed, &asteroids)?, &ASSUMED);
    Ok(())
}

fn write(folder: &Path, name: &str, title: &str, flight: &Flight, keys: &[&str]) -> Result<(), Failure> {
    let mut marks = vec![([-flight.mu, 0.0], "m₁".to_string()), ([1.0 - flight.mu, 0.0], "m₂".to_string())];
    marks.extend(points(flight.mu)?.iter().enumerate().map(|(i, &point)| (point, format!("L{}", i + 1))));
    let orbit = PlaneLine::new("orbit", flight.path.iter().map(|row| [row[1], row[2]]).collect());
    let panels = vec![Panel::plane(["x", "y"], vec![orbit], marks)];
    let figure = Figure { title: title.to_string(), size: (1000, 900), panels };
    output::write_figure(folder, name, &figure, keys)?;
    output::write_table(folder, name, "t x y x_dot y_dot jacobi", flight.path.iter().map(|row| row.to_vec()))
}
