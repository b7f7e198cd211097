//! The ellipse a = 1, e = 0.6 about a centre with μ = 1, from its periapsis.

use mbs_examples::{Failure, numbers::apart};
use mbs_models::kepler::{Kepler, Params};
use mbs_orbit::collision::fly;
use mbs_orbit::{kepler::propagate, vector::StateVector};
use mbs_runtime::{Dop853, Integrator, State, accelerations};

/// When it is looked at.
const TIMES: [f64; 5] = [1.0, 2.0, 3.0, 5.0, 10.0];

/// States x, y, ẋ, ẏ by their times, found in two ways.
pub(crate) struct Ellipse {
    pub(crate) kepler: Vec<(f64, [f64; 4])>,
    pub(crate) dop853: Vec<(f64, [f64; 4])>,
    pub(crate) drift: Drift,
}

/// Greatest changes at the accepted steps of DOP853.
#[derive(Default)]
pub(crate) struct Drift {
    pub(crate) energy: f64,
    pub(crate) angular_momentum: f64,
    pub(crate) laplace_vector: f64,
}

pub(crate) fn run() -> Result<Ellipse, Failure> {
    let body = Kepler::new(Params { mu: 1.0, m: 1.0 });
    let start = State { q: [0.4, 0.0, 0.0], qd: [0.0, 2.0, 0.0] };
    let dop853 = Dop853::new(2.3e-14, 1e-16);

    let begin = StateVector::new(start.q, start.qd);
    let mut kepler = Vec::new();
    for t in TIMES {
        let StateVector { position: [x, y, _], velocity: [u, v, _] } = propagate(1.0, &begin, t)?.state;
        kepler.push((t, [x, y, u, v]));
    }

    let mut sampled = Vec::new();
    let mut state = start;
    for t in TIMES {
        // Ended where it is looked at: the dense output is of a lower order than the method.
        let from = sampled.last().map_or(0.0, |&(t, _)| t);
        dop853.integrate(accelerations(&body, |_, _, _| [0.0; 3]), from, t, &mut state, |_| {
            std::ops::ControlFlow::Continue(())
        })?;
        sampled.push((t, [state.q[0], state.q[1], state.qd[0], state.qd[1]]));
    }

    let mut drift = Drift::default();
    let constants = |s: &State<[f64; 3]>| {
        (body.conserved(&s.q, &s.qd)[0], body.angular_momentum(&s.q, &s.qd), body.eccentricity(&s.q, &s.qd))
    };
    let first = constants(&start);
    let mut state = start;
    let motion = accelerations(&body, |_, _: &[f64; 3], _: &[f64; 3]| [0.0; 3]);
    let distance = |_, s: &State<[f64; 3]>| s.q[0].hypot(s.q[1]);
    fly(&dop853, motion, [0.0, TIMES[4]], &mut state, distance, 0.0, |step| {
        let (energy, momentum, laplace) = constants(step.state());
        drift.energy = drift.energy.max((energy - first.0).abs());
        drift.angular_momentum = drift.angular_momentum.max(apart(&momentum, &first.1));
        drift.laplace_vector = drift.laplace_vector.max(apart(&laplace, &first.2));
    })?;
    Ok(Ellipse { kepler, dop853: sampled, drift })
}
