//! The car sets off and drives an eight: `motion.csv` is a table, `motion.svg` a moving picture
//! from above, for a browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, Integrator, Projected, Projector, State, accelerations};

mbs_runtime::include_mechanism!("vehicle");
use vehicle::{Params, Vehicle};

/// Memory for four coordinates and two rows.
const MEMORY: usize = Projector::<f64, [f64; 0]>::size(4, 2);

fn main() -> Result<(), Box<dyn Error>> {
    let car = Vehicle::<f64>::new(Params::default());
    // A driver who keeps 6 m/s and turns the wheel to and fro.
    let driver = |t: f64, q: &[f64; 4], qd: &[f64; 4]| {
        let speed = qd[0] * q[2].cos() + qd[1] * q[2].sin();
        let wanted = 0.35 * (0.25 * t).sin();
        [
            2000.0 * (6.0 - speed),
            400.0 * (wanted - q[3]) - 80.0 * qd[3],
        ]
    };
    let mut state = State {
        q: [0.0; 4],
        qd: [0.0; 4],
    };

    let times: Vec<f64> = (0..=300).map(|i| f64::from(i) * 0.1).collect();
    let mut table = String::from("t,x,y,heading,steer,slip\n");
    let mut frames = Vec::new();
    let projector = Projector::new([0.0; MEMORY]);
    let method = Projected {
        method: Dop853::new(1e-8, 1e-8),
        drift: projector.onto(&car),
    };
    method.sample(
        accelerations(&car, driver),
        0.0,
        &times,
        &mut state,
        |t, state| {
            let slip = car
                .constraint(&state.q, &state.qd)
                .iter()
                .fold(0.0_f64, |slip, v| slip.max(v.abs()));
            let [x, y, heading, steer] = state.q;
            table += &format!("{t},{x},{y},{heading},{steer},{slip}\n");
            let flat = |[x, y, _]: [f64; 3]| [x, y];
            frames.push(vec![vec![
                flat(car.nose(&state.q)),
                flat(car.front_axle(&state.q)),
                flat(car.rear_axle(&state.q)),
            ]]);
        },
    )?;
    std::fs::write("motion.csv", table)?;
    picture::write("motion.svg", &frames, 15.0)?;
    println!(
        "after 30 s at ({:.1}, {:.1}) m; motion.csv, and motion.svg for a browser",
        state.q[0], state.q[1]
    );
    Ok(())
}
