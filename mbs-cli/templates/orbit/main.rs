//! A month of the Moon: `motion.csv` is a table, `motion.svg` a moving picture for a browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, Integrator, State, accelerations};

mbs_runtime::include_mechanism!("orbit");
use orbit::{Orbit, Params};

/// Distance \[m\] and speed \[m/s\] of the Moon at its perigee, and the share of the Earth in both.
const PERIGEE: f64 = 363.3e6;
const SPEED: f64 = 1082.0;
const SHARE: f64 = 7.342e22 / (7.342e22 + 5.9722e24);

fn main() -> Result<(), Box<dyn Error>> {
    let orbit = Orbit::<f64>::new(Params::default());
    let free = |_t: f64, _q: &[f64; 6], _qd: &[f64; 6]| [];
    // The barycentre rests at the origin.
    let q = [
        -SHARE * PERIGEE,
        0.0,
        0.0,
        (1.0 - SHARE) * PERIGEE,
        0.0,
        0.0,
    ];
    let qd = [0.0, -SHARE * SPEED, 0.0, 0.0, (1.0 - SHARE) * SPEED, 0.0];
    let mut state = State { q, qd };
    let energy = |state: &State<[f64; 6]>| {
        orbit.kinetic_energy(&state.q, &state.qd) + orbit.potential_energy(&state.q)
    };
    let begun = energy(&state);

    let days = 28;
    let times: Vec<f64> = (0..=240)
        .map(|i| f64::from(i * days) * 86400.0 / 240.0)
        .collect();
    let mut table = String::from("t,x,y,distance\n");
    let mut frames = Vec::new();
    Dop853::new(1e-11, 1e-3).sample(
        accelerations(&orbit, free),
        0.0,
        &times,
        &mut state,
        |t, state| {
            let [earth_x, earth_y, _, x, y, _] = state.q;
            table += &format!("{t},{x},{y},{}\n", (x - earth_x).hypot(y - earth_y));
            frames.push(vec![vec![[x, y]; 2], vec![[earth_x, earth_y]; 2]]);
        },
    )?;
    std::fs::write("motion.csv", table)?;
    picture::write("motion.svg", &frames, 14.0)?;
    let drift = (energy(&state) / begun - 1.0).abs();
    println!("{days} days, energy kept to {drift:.1e}; motion.csv, and motion.svg for a browser");
    Ok(())
}
