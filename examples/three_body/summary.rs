//! Where a small body rests, and how good the motions are, as JSON and as text.

use std::f64::consts::TAU;

use mbs_examples::Failure;
use mbs_orbit::libration::{Modes, Point, points};
use serde_json::{Value, json};

use crate::orbits::{ARENSTORF_MU, Asteroid, Flight};

/// The mass ratios whose points are printed.
const PAIRS: [(&str, f64); 2] = [("earth_moon", 0.012_150_585_6), ("arenstorf", ARENSTORF_MU)];

pub(crate) fn to_json(closed: &Flight, asteroids: &[Asteroid]) -> Result<Value, Failure> {
    let (mut libration, mut growth) = (json!({}), json!({}));
    for (name, mu) in PAIRS {
        libration[name] = json!(points(mu)?);
        growth[name] = json!(growths(mu)?);
    }
    let asteroids: Value = asteroids
        .iter()
        .map(|asteroid| (asteroid.name.to_string(), json!({"jacobi_drift": asteroid.flight.jacobi_drift})))
        .collect();
    Ok(json!({
        "libration": libration,
        "libration_growth": growth,
        "arenstorf_return_error": closed.return_error(),
        "jacobi_drift": closed.jacobi_drift,
        "asteroids": asteroids,
    }))
}

pub(crate) fn text(closed: &Flight, asteroids: &[Asteroid]) -> Result<String, Failure> {
    let mut text =
        String::from("Units: the distance of the primaries, their mass together, the inverse of their rate of turn\n");
    for (name, mu) in PAIRS {
        text += &format!("Points of rest for the mass ratio {mu} ({name})\n");
        for (i, ([x, y], growth)) in points(mu)?.into_iter().zip(growths(mu)?).enumerate() {
            let fate = if growth == 0.0 { "stable".to_string() } else { format!("grows as exp({growth:.6} t)") };
            text += &format!("  L{}  x = {x:19.16}  y = {y:19.16}  {fate}\n", i + 1);
        }
    }
    text += &format!(
        "Arenstorf's orbit by DOP853, {} steps\n  comes back to {:.2e}, Jacobi's constant drifts by {:.2e}\n",
        closed.steps,
        closed.return_error(),
        closed.jacobi_drift
    );
    for Asteroid { name, flight } in asteroids {
        let (turns, drift) = (flight.time / TAU, flight.jacobi_drift);
        text += &format!(
            "An asteroid on a {name} with the Sun and Jupiter: {turns:.0} revolutions of the planet, \
             Jacobi's constant drifts by {drift:.2e}\n"
        );
    }
    Ok(text)
}

/// How fast small motions about each of the five points grow.
fn growths(mu: f64) -> Result<Vec<f64>, Failure> {
    Point::ALL.into_iter().map(|point| Ok(Modes::about(mu, point)?.growth())).collect()
}
