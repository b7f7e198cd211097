//! The Earth and the Moon in inertial axes about their barycentre, the Moon slower than it is.

use mbs_examples::{Failure, numbers::apart};
use mbs_models::two_body::TwoBody;
use mbs_orbit::EARTH_RADIUS;
use mbs_orbit::collision::fly;
use mbs_runtime::{Dop853, State, accelerations};

/// How long they are followed.
pub(crate) const DAYS: f64 = 10.0;
/// Distance \[m\] and relative speed \[m/s\] at the beginning, at right angles.
const START: [f64; 2] = [384.4e6, 950.0];
/// Radii of the Earth and the Moon, together \[m\]: nearer than that they touch.
const RADII: f64 = EARTH_RADIUS + 1_737_400.0;
/// Rows of the table in each period.
const ROWS: usize = 600;

pub(crate) struct Moment {
    pub(crate) t: f64,
    pub(crate) bodies: [[f64; 3]; 2],
}

pub(crate) struct Flight {
    /// Places after [`DAYS`].
    pub(crate) bodies: [[f64; 3]; 2],
    pub(crate) barycentre: [f64; 3],
    /// Of the value, greatest at the accepted steps.
    pub(crate) energy_drift: f64,
    pub(crate) momentum_drift: f64,
    /// The barycentre drift \[m\].
    pub(crate) barycentre_drift: f64,
    /// Over a whole revolution.
    pub(crate) path: Vec<Moment>,
}

fn bodies(state: &State<[f64; 6]>) -> [[f64; 3]; 2] {
    let [a, b, c, d, e, f] = state.q;
    [[a, b, c], [d, e, f]]
}

pub(crate) fn run() -> Result<Flight, Failure> {
    let pair = TwoBody::<f64>::default();
    let [m1, m2] = pair.params().mass;
    let (share1, share2) = (m2 / (m1 + m2), m1 / (m1 + m2));
    let [r, v] = START;
    let start =
        State { q: [-share1 * r, 0.0, 0.0, share2 * r, 0.0, 0.0], qd: [0.0, -share1 * v, 0.0, 0.0, share2 * v, 0.0] };
    let mu = pair.params().G * (m1 + m2);
    let axis = 1.0 / (2.0 / r - v * v / mu);
    let period = std::f64::consts::TAU * axis * (axis / mu).sqrt();

    let dop853 = Dop853::new(2.3e-14, 1e-9);
    let motion = || accelerations(&pair, |_, _: &[f64; 6], _: &[f64; 6]| []);
    let distance = |_: f64, s: &State<[f64; 6]>| {
        let [a, b] = bodies(s);
        (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
    };
    const ORIGIN: [f64; 3] = [0.0; 3];
    let energy = |s: &State<[f64; 6]>| pair.conserved(&s.q, &s.qd)[0];
    let momentum = |s: &State<[f64; 6]>| pair.angular_momentum(&s.q, &s.qd);
    let mut flight = Flight {
        bodies: [[0.0; 3]; 2],
        barycentre: [0.0; 3],
        energy_drift: 0.0,
        momentum_drift: 0.0,
        barycentre_drift: 0.0,
        path: Vec::new(),
    };
    let mut state = start;
    fly(&dop853, motion(), [0.0, DAYS * 86_400.0], &mut state, distance, RADII, |step| {
        let now = step.state();
        flight.energy_drift = flight.energy_drift.max(((energy(now) - energy(&start)) / energy(&start)).abs());
        let [l, l0] = [momentum(now), momentum(&start)];
        flight.momentum_drift = flight.momentum_drift.max(apart(&l, &l0) / apart(&l0, &ORIGIN));
        flight.barycentre_drift = flight.barycentre_drift.max(apart(&pair.barycentre(&now.q), &ORIGIN));
    })?;
    (flight.bodies, flight.barycentre) = (bodies(&state), pair.barycentre(&state.q));

    let mut state = start;
    for row in 0..=ROWS {
        let t = |row: usize| period * row as f64 / ROWS as f64;
        if row > 0 {
            fly(&dop853, motion(), [t(row - 1), t(row)], &mut state, distance, RADII, |_| ())?;
        }
        flight.path.push(Moment { t: t(row), bodies: bodies(&state) });
    }
    Ok(flight)
}
