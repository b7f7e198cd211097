//! Orbits of the planar restricted problem.

use mbs_examples::{Failure, numbers::apart};
use mbs_models::cr3bp_planar::{Cr3bpPlanar, Params};
use mbs_orbit::collision::fly;
use mbs_orbit::libration::points;
use mbs_runtime::{Dop853, State, accelerations};

/// Mass ratio of Arenstorf's orbit.
pub(crate) const ARENSTORF_MU: f64 = 0.012_277_471;
/// R. F. Arenstorf, *Periodic Solutions of the Restricted Three Body Problem Representing Analytic Continuations of
/// Keplerian Elliptic Motions*, 1963; to more digits in Hairer, Nørsett, Wanner, *Solving Ordinary Differential
/// Equations I*, II.0.
#[allow(clippy::excessive_precision)] // as it is printed
const ARENSTORF: ([f64; 2], [f64; 2], f64) =
    ([0.994, 0.0], [0.0, -2.001_585_106_379_082_522_405_378_622_24], 17.065_216_560_157_962_558_891_720_624_9);
/// Mass ratio of a planet in whose orbit asteroids keep: Jupiter, of which the Sun has 1047.3486 masses (International
/// Astronomical Union, *Current Best Estimates*, 2009).
const JUPITER_MU: f64 = 1.0 / 1_048.348_6;
/// How much farther out than the points of rest the asteroids start.
const STRETCHES: [f64; 2] = [1.004, 1.003];
/// In units of the distance of the primaries: nearer is a collision.
const CONTACT: f64 = 1e-5;

/// Of a step that are drawn.
const POINTS: usize = 24;

/// Rows t, x, y, ẋ, ẏ, C.
type Row = [f64; 6];

/// An orbit that was flown.
pub(crate) struct Flight {
    pub(crate) mu: f64,
    pub(crate) time: f64,
    pub(crate) steps: usize,
    /// At the accepted steps, and between them.
    pub(crate) path: Vec<Row>,
    /// Greatest change of Jacobi's constant at the accepted steps.
    pub(crate) jacobi_drift: f64,
    start: State<[f64; 2]>,
    end: State<[f64; 2]>,
}

impl Flight {
    fn of(mu: f64, start: State<[f64; 2]>, time: f64, dop853: &Dop853) -> Result<Self, Failure> {
        let system = Cr3bpPlanar::new(Params { mu });
        // The energy integral is −C/2.
        let jacobi = |s: &State<[f64; 2]>| -2.0 * system.conserved(&s.q, &s.qd)[0];
        let row = |t: f64, s: &State<[f64; 2]>| [t, s.q[0], s.q[1], s.qd[0], s.qd[1], jacobi(s)];
        let nearest = |_: f64, s: &State<[f64; 2]>| (s.q[0] + mu).hypot(s.q[1]).min((s.q[0] + mu - 1.0).hypot(s.q[1]));
        let (mut path, mut end) = (vec![row(0.0, &start)], start);
        let (mut steps, mut jacobi_drift) = (0, 0.0_f64);
        let motion = accelerations(&system, |_, _: &[f64; 2], _: &[f64; 2]| []);
        fly(dop853, motion, [0.0, time], &mut end, nearest, CONTACT, |step| {
            let (from, to) = (step.previous_time(), step.time());
            let mut between = start;
            for part in 1..POINTS {
                let t = from + (to - from) * part as f64 / POINTS as f64;
                if step.interpolate(t, &mut between).is_ok() {
                    path.push(row(t, &between));
                }
            }
            path.push(row(to, step.state()));
            steps += 1;
            jacobi_drift = jacobi_drift.max((jacobi(step.state()) - jacobi(&start)).abs());
        })?;
        Ok(Self { mu, time, steps, path, jacobi_drift, start, end })
    }

    /// The greatest difference of the four numbers of the state at the end from those at the beginning.
    pub(crate) fn return_error(&self) -> f64 {
        apart(&self.start.q, &self.end.q).max(apart(&self.start.qd, &self.end.qd))
    }
}

pub(crate) fn arenstorf() -> Result<Flight, Failure> {
    let (q, qd, period) = ARENSTORF;
    Flight::of(ARENSTORF_MU, State { q, qd }, period, &Dop853::new(1e-13, 1e-15))
}

/// An asteroid in the orbit of a planet.
pub(crate) struct Asteroid {
    pub(crate) name: &'static str,
    pub(crate) flight: Flight,
}

/// Released at rest a little outside L₄, and on the far side a little outside L₃.
pub(crate) fn asteroids() -> Result<[Asteroid; 2], Failure> {
    let [_, _, l3, l4, _] = points(JUPITER_MU)?;
    let dop853 = Dop853::new(1e-12, 1e-14);
    let fly = |[x, y]: [f64; 2], stretch: f64, revolutions: f64| {
        let start = State { q: [stretch * x, stretch * y], qd: [0.0; 2] };
        Flight::of(JUPITER_MU, start, revolutions * std::f64::consts::TAU, &dop853)
    };
    Ok([
        Asteroid { name: "tadpole", flight: fly(l4, STRETCHES[0], 40.0)? },
        Asteroid { name: "horseshoe", flight: fly(l3, STRETCHES[1], 120.0)? },
    ])
}
