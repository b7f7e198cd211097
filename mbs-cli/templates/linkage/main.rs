//! A motor turns the crank, and the loop stays closed: `motion.csv` is a table, `motion.svg` a
//! moving picture for a browser.

mod picture;

use std::error::Error;

use mbs_runtime::{Dop853, Integrator, Projected, Projector, State, accelerations};

mbs_runtime::include_mechanism!("linkage");
use linkage::coordinate::{COUPLER, CRANK, ROCKER};
use linkage::{Linkage, Params};

/// Memory for three coordinates and the two rows of the closure.
const MEMORY: usize = Projector::<f64, [f64; 0]>::size(3, 2);

fn main() -> Result<(), Box<dyn Error>> {
    let linkage = Linkage::<f64>::new(Params::default());
    // The motor turns the crank at 5 rad/s.
    let motor = |_t: f64, _q: &[f64; 3], qd: &[f64; 3]| [2.0 * (5.0 - qd[CRANK])];

    // Assembled from a guess of the angles of coupler and rocker, with the crank as given.
    let mut state = State {
        q: [0.0; 3],
        qd: [0.0; 3],
    };
    (state.q[CRANK], state.q[COUPLER], state.q[ROCKER]) = (0.5, 0.9, 1.6);
    let mut projector = Projector::new([0.0; MEMORY]);
    projector
        .assemble(&linkage, 0.0, &mut state, |i| i == CRANK)
        .map_err(|open| open.to_string())?;

    let times: Vec<f64> = (0..=250).map(|i| f64::from(i) * 0.02).collect();
    let mut table = String::from("t,crank,coupler,rocker,open\n");
    let mut frames = Vec::new();
    let mut largest = 0.0_f64;
    let method = Projected {
        method: Dop853::new(1e-9, 1e-9),
        drift: projector.onto(&linkage),
    };
    method.sample(
        accelerations(&linkage, motor),
        0.0,
        &times,
        &mut state,
        |t, state| {
            let open = linkage
                .constraint(&state.q, &state.qd)
                .iter()
                .fold(0.0_f64, |open, phi| open.max(phi.abs()));
            largest = largest.max(open);
            let [crank, coupler, rocker] = [CRANK, COUPLER, ROCKER].map(|i| state.q[i]);
            table += &format!("{t},{crank},{coupler},{rocker},{open}\n");
            let [knee, hinge, middle] = [
                linkage.knee(&state.q),
                linkage.hinge(&state.q),
                linkage.middle(&state.q),
            ];
            let flat = |[x, _, z]: [f64; 3]| [x, z];
            let bars = vec![
                [0.0, 0.0],
                flat(knee),
                flat(hinge),
                [linkage.params().ground, 0.0],
            ];
            frames.push(vec![vec![flat(middle); 2], bars]);
        },
    )?;
    std::fs::write("motion.csv", table)?;
    picture::write("motion.svg", &frames, 5.0)?;
    let turns = state.q[CRANK] / std::f64::consts::TAU;
    println!(
        "{turns:.2} turns, open by {largest:.1e} m at most; motion.csv, and motion.svg for a browser"
    );
    Ok(())
}
