//! The arm goes from one posture to another under a controller that knows gravity: `motion.csv` is
//! a table, `motion.svg` a moving picture of it from the side, for a browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, Integrator, State, accelerations};

mbs_runtime::include_mechanism!("arm");
use arm::{Arm, Params};

/// Stiffness [N·m/rad] and damping [N·m·s/rad] of the controller, a joint each.
const STIFFNESS: [f64; 3] = [60.0, 120.0, 40.0];
const DAMPING: [f64; 3] = [15.0, 25.0, 6.0];

fn main() -> Result<(), Box<dyn Error>> {
    let arm = Arm::<f64>::new(Params::default());
    let goal: [f64; 3] = [0.6, 0.9, -1.4];
    // Gravity is held by the model; what is left behaves like springs to the goal, and dampers.
    let control = |_t: f64, q: &[f64; 3], qd: &[f64; 3]| {
        let weight = arm.gravity(q);
        std::array::from_fn(|i| weight[i] + STIFFNESS[i] * (goal[i] - q[i]) - DAMPING[i] * qd[i])
    };
    let mut state = State {
        q: [0.0, -0.5, 1.2],
        qd: [0.0; 3],
    };

    let times: Vec<f64> = (0..=150).map(|i| f64::from(i) * 0.04).collect();
    let mut table = String::from("t,q_0,q_1,q_2,hand_x,hand_y,hand_z\n");
    let mut frames = Vec::new();
    Dop853::new(1e-8, 1e-8).sample(
        accelerations(&arm, control),
        0.0,
        &times,
        &mut state,
        |t, state| {
            let places = [
                arm.shoulder(&state.q),
                arm.elbow(&state.q),
                arm.hand(&state.q),
            ];
            let ([q0, q1, q2], [x, y, z]) = (state.q, places[2]);
            table += &format!("{t},{q0},{q1},{q2},{x},{y},{z}\n");
            let mut line = vec![[0.0, 0.0]];
            line.extend(places.map(|[x, _, z]| [x, z]));
            frames.push(vec![line]);
        },
    )?;
    std::fs::write("motion.csv", table)?;
    picture::write("motion.svg", &frames, 6.0)?;
    let left = (0..3)
        .map(|i| (state.q[i] - goal[i]).abs())
        .fold(0.0, f64::max);
    println!(
        "after 6 s within {left:.1e} rad of the goal; motion.csv, and motion.svg for a browser"
    );
    Ok(())
}
