//! What does a small body do that the Earth and the Moon, or another pair on circles, attract?
//!
//! The five points where it rests and whether it stays there; Arenstorf's orbit, which comes back after three loops if
//! and only if the equations and the integration are right; asteroids that keep company with a planet in its orbit, as
//! a tadpole about L₄ and as a horseshoe. Look at Jacobi's constant, the energy integral that the generator found by
//! itself: how little it changes says how good the motion is.
//!
//! `--out DIR` writes the orbits as SVG and PNG, and as CSV.

mod orbits;

use mbs_examples::{print, println};
use std::path::Path;

use mbs_chart::{Figure, Panel, Plane, PlaneLine};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_orbit::libration::{Modes, Point, points};
use serde_json::{Value, json};

use orbits::{Flight, arenstorf, asteroids};

/// The mass ratios whose points are printed.
const PAIRS: [(&str, f64); 2] = [("earth_moon", 0.012_150_585_6), ("arenstorf", orbits::ARENSTORF_MU)];

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
    if arguments.json {
        let (mut libration, mut growth) = (json!({}), json!({}));
        for (name, mu) in PAIRS {
            libration[name] = json!(points(mu)?);
            growth[name] = json!(growths(mu)?);
        }
        let asteroids: Value = asteroids
            .iter()
            .map(|asteroid| (asteroid.name.to_string(), json!({"jacobi_drift": asteroid.flight.jacobi_drift})))
            .collect();
        let value = json!({
            "libration": libration,
            "libration_growth": growth,
            "arenstorf_return_error": closed.return_error(),
            "jacobi_drift": closed.jacobi_drift,
            "asteroids": asteroids,
        });
        println!("{}", assumed::with(value, &ASSUMED));
        return Ok(());
    }
    println!("Units: the distance of the primaries, their mass together, the inverse of their rate of turn");
    for (name, mu) in PAIRS {
        println!("Points of rest for the mass ratio {mu} ({name})");
        for (i, (point, growth)) in points(mu)?.iter().zip(growths(mu)?).enumerate() {
            let fate = if growth == 0.0 { "stable".to_string() } else { format!("grows as exp({growth:.6} t)") };
            println!("  L{}  x = {:19.16}  y = {:19.16}  {fate}", i + 1, point[0], point[1]);
        }
    }
    println!("Arenstorf's orbit by DOP853, {} steps", closed.steps);
    println!("  comes back to {:.2e}, Jacobi's constant drifts by {:.2e}", closed.return_error(), closed.jacobi_drift);
    for asteroid in &asteroids {
        println!(
            "An asteroid on a {} with the Sun and Jupiter: {:.0} revolutions of the planet, Jacobi's constant drifts by {:.2e}",
            asteroid.name,
            asteroid.flight.time / std::f64::consts::TAU,
            asteroid.flight.jacobi_drift
        );
    }
    print!("{}", assumed::text(&ASSUMED));
    Ok(())
}

/// How fast small motions about each of the five points grow.
fn growths(mu: f64) -> Result<Vec<f64>, Failure> {
    Point::ALL.into_iter().map(|point| Ok(Modes::about(mu, point)?.growth())).collect()
}

fn write(folder: &Path, name: &str, title: &str, flight: &Flight, keys: &[&str]) -> Result<(), Failure> {
    let mut marks = vec![([-flight.mu, 0.0], "m₁".to_string()), ([1.0 - flight.mu, 0.0], "m₂".to_string())];
    marks.extend(points(flight.mu)?.iter().enumerate().map(|(i, &point)| (point, format!("L{}", i + 1))));
    let plane = Plane {
        labels: ["x", "y"].map(String::from),
        lines: vec![PlaneLine::new("orbit", flight.path.iter().map(|row| [row[1], row[2]]).collect())],
        marks,
    };
    let figure = Figure { title: title.to_string(), size: (1000, 900), panels: vec![Panel::Plane(plane)] };
    output::write_figure(folder, name, &figure, keys)?;
    output::write_table(folder, name, "t x y x_dot y_dot jacobi", flight.path.iter().map(|row| row.to_vec()))
}
