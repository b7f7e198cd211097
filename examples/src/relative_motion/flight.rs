//! A motion over one orbit of the station, found in several ways.

use crate::{Failure, numbers::apart};
use mbs_models::relative_cylindrical::{Params, RelativeCylindrical};
use mbs_orbit::EARTH_MU;
use mbs_orbit::clohessy_wiltshire;
use mbs_orbit::collision::fly;
use mbs_orbit::lvlh::relative_motion;
use mbs_orbit::station::{from_cylindrical, to_cylindrical};
use mbs_orbit::vector::StateVector;
use mbs_runtime::{Dop853, State};

use super::cases::Case;

/// Rows of a table.
const ROWS: usize = 500;
/// Orbits of the station in figures and tables.
pub const ORBITS: f64 = 2.0;

/// A motion and what it is compared with; differences are those of the component that differs most.
pub struct Flight {
    /// What it begins with.
    pub case: Case,
    /// After one orbit.
    pub end: State<[f64; 3]>,
    /// From the difference of two Kepler motions \[m\], where the station has no mass.
    pub kepler_difference: Option<f64>,
    /// From the linear motion of Hill, Clohessy and Wiltshire \[m\], near a station on a circle without a mass.
    pub hcw_difference: Option<f64>,
    /// From the same in cylindrical coordinates \[m\], where the station has no mass.
    pub cylindrical_difference: Option<f64>,
    /// Times and states over [`ORBITS`].
    pub path: Vec<(f64, State<[f64; 3]>)>,
}

/// The one of all motions.
pub fn integrator() -> Dop853 {
    Dop853::new(2.3e-14, 1e-13)
}

/// Distance from the station.
fn distance(_: f64, state: &State<[f64; 3]>) -> f64 {
    let [x, y, z] = state.q;
    x.hypot(y).hypot(z)
}

/// The state of a case at a time, integrated from the beginning.
pub fn carried(case: &Case, start: State<[f64; 3]>, [from, to]: [f64; 2]) -> Result<State<[f64; 3]>, Failure> {
    let mut state = start;
    fly(&integrator(), case.station.accelerations_about(), [from, to], &mut state, distance, 0.0, |_| ())?;
    Ok(state)
}

/// The end in cylindrical coordinates, taken back.
fn by_cylindrical(case: &Case, time: f64) -> Result<State<[f64; 3]>, Failure> {
    let params = Params { mu: EARTH_MU, station_mass: case.mass, ..Params::default() };
    let body = RelativeCylindrical::new(params);
    let station = case.station;
    let motion = |t: f64, q: &[f64; 3], qd: &[f64; 3], qdd: &mut [f64; 3]| {
        *qdd = station.signals(t).map_or([f64::NAN; 3], |signals| body.forward_dynamics(&signals, q, qd));
    };
    let mut state = to_cylindrical(&case.start)?;
    fly(&integrator(), motion, [0.0, time], &mut state, |_, s| s.q[0].hypot(s.q[2]), 0.0, |_| ())?;
    Ok(from_cylindrical(&state))
}

impl Flight {
    /// Integrates a motion and compares it.
    pub fn of(case: Case) -> Result<Self, Failure> {
        let period = case.station.period();
        let end = carried(&case, case.start, [0.0, period])?;
        let mut path = vec![(0.0, case.start)];
        let mut state = case.start;
        for row in 1..=ROWS {
            let t = |row: usize| ORBITS * period * row as f64 / ROWS as f64;
            state = carried(&case, state, [t(row - 1), t(row)])?;
            path.push((t(row), state));
        }

        let is_light = case.mass == 0.0;
        let is_near_a_circle = case.group == "circular" && distance(0.0, &case.start) < 100.0;
        let begin = StateVector::from(case.start);
        let kepler_difference = match is_light {
            true => {
                let exact = relative_motion(EARTH_MU, &case.station.state(0.0)?, &begin, period)?.relative;
                Some(apart(&end.q, &exact.position))
            }
            false => None,
        };
        let hcw_difference = match is_light && is_near_a_circle {
            true => {
                let linear = clohessy_wiltshire::propagate(case.station.rate(), &begin, period)?;
                Some(apart(&end.q, &linear.position))
            }
            false => None,
        };
        let cylindrical_difference = match is_light {
            true => Some(apart(&end.q, &by_cylindrical(&case, period)?.q)),
            false => None,
        };
        Ok(Self { case, end, kepler_difference, hcw_difference, cylindrical_difference, path })
    }
}
