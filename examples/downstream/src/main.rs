//! A crane driven by a constant force for two seconds: how far does the load swing?

use mbs_runtime::{Dop853, IntegrationError, Integrator, State, accelerations};

mbs_runtime::include_mechanism!("crane");
use crane::{Crane, Params};

fn main() -> Result<(), IntegrationError> {
    let crane = Crane::new(Params { rope: 8.0, ..Params::default() });
    let drive = |t: f64, _: &[f64; 2], _: &[f64; 2]| [if t < 2.0 { 1500.0 } else { 0.0 }];
    let mut state = State { q: [0.0; 2], qd: [0.0; 2] };
    let times = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0];
    Dop853::new(1e-9, 1e-9).sample(accelerations(&crane, drive), 0.0, &times, &mut state, |t, state| {
        let [x, _, z] = crane.hook(&state.q);
        println!(
            "{t:4.1} s: trolley {:6.3} m, sway {:6.2}°, load at ({x:.3}, {z:.3}) m",
            state.q[0],
            state.q[1].to_degrees()
        );
    })?;
    Ok(())
}
