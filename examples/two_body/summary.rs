//! Where the bodies are, and what drifts, as JSON and as text.

use mbs_examples::numbers::apart;
use serde_json::{Value, json};

use crate::earth_moon::{DAYS, Flight};
use crate::ellipse::Ellipse;

pub(crate) fn to_json(ellipse: &Ellipse, earth_moon: &Flight) -> Value {
    let samples = |samples: &[(f64, [f64; 4])]| -> Vec<_> {
        samples.iter().map(|(t, state)| json!({"t": t, "state": state})).collect()
    };
    let [body1, body2] = earth_moon.bodies;
    json!({
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
    })
}

pub(crate) fn text(ellipse: &Ellipse, earth_moon: &Flight) -> String {
    let mut text = String::from(
        "An ellipse of eccentricity 0.6, a = 1, mu = 1, from its pericentre, by Kepler's equation and by DOP853\n",
    );
    for ((t, kepler), (_, dop853)) in ellipse.kepler.iter().zip(&ellipse.dop853) {
        let ([x, y, ..], apart) = (kepler, apart(kepler, dop853));
        text += &format!("  t = {t:4}  x = {x:19.16}  y = {y:19.16}  apart by {apart:.1e}\n");
    }
    let drift = &ellipse.drift;
    text += &format!(
        "  greatest drift: energy {:.1e}, angular momentum {:.1e}, Laplace's vector {:.1e}\n\
         The Earth and a Moon that starts 384400 km away with 950 m/s, after {DAYS} days, from their barycentre [km]\n",
        drift.energy, drift.angular_momentum, drift.laplace_vector
    );
    for (name, place) in ["Earth", "Moon"].iter().zip(earth_moon.bodies) {
        text += &format!("  {name:<6} {:14.6} {:14.6}\n", place[0] / 1e3, place[1] / 1e3);
    }
    text + &format!(
        "  greatest drift: energy {:.1e}, angular momentum {:.1e} of their values, barycentre {:.1e} m\n",
        earth_moon.energy_drift, earth_moon.momentum_drift, earth_moon.barycentre_drift
    )
}
