//! Lets the pendulum go at 2.5 rad: `motion.csv` is a table, `motion.svg` a moving picture for a
//! browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, Integrator, State, accelerations};

mbs_runtime::include_mechanism!("pendulum");
use pendulum::{Params, Pendulum};

fn main() -> Result<(), Box<dyn Error>> {
    let pendulum = Pendulum::new(Params {
        length: 0.6,
        ..Params::default()
    });
    let motor = |_t: f64, _q: &[f64; 1], _qd: &[f64; 1]| [0.0];
    let mut state = State {
        q: [2.5],
        qd: [0.0],
    };

    let times: Vec<f64> = (0..=250).map(|i| f64::from(i) * 0.04).collect();
    let mut table = String::from("t,theta,theta_dot,energy\n");
    let mut frames = Vec::new();
    Dop853::new(1e-9, 1e-9).sample(
        accelerations(&pendulum, motor),
        0.0,
        &times,
        &mut state,
        |t, state| {
            let ([theta], [rate]) = (state.q, state.qd);
            let energy =
                pendulum.kinetic_energy(&state.q, &state.qd) + pendulum.potential_energy(&state.q);
            table += &format!("{t},{theta},{rate},{energy}\n");
            let [x, _, z] = pendulum.tip(&state.q);
            frames.push(vec![vec![[0.0, 0.0], [x, z]]]);
        },
    )?;
    std::fs::write("motion.csv", table)?;
    picture::write("motion.svg", &frames, 10.0)?;
    println!(
        "after 10 s at {:.3} rad; motion.csv, and motion.svg for a browser",
        state.q[0]
    );
    Ok(())
}
