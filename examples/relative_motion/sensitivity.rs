//! What becomes of a small displacement.

use mbs_examples::Failure;

use mbs_examples::relative_motion::cases::{Case, circular, with_mass};
use mbs_examples::relative_motion::flight::carried;

/// By which the beginning is displaced along x \[m\].
pub(crate) const OFFSET: f64 = 1e-6;
/// How many orbits of the station are flown.
const ORBITS: usize = 6;

/// What the thesis calls chaos, said plainly.
pub(crate) const PLAINLY: &str = "\
Without a mass of the station the displacement grows by the same amount with every orbit, as the drift of two satellites of unlike periods
does: regular motion (E46). The 1/r of the thesis is one of its coordinates, not of these forces. A station that attracts as a point of 420 t
multiplies the displacement in the one passage close by, five times for the release on the 2:1 ellipse; then the astronaut has drifted
away and it grows evenly again: sensitive, but not chaotic over these orbits. A real station has no such point: its hull is wider than
the 1.94 m of its Hill sphere.
";

/// The growth of a displacement.
pub(crate) struct Growth {
    pub(crate) case: &'static str,
    pub(crate) station_mass: f64,
    /// After 1, 2, 3, … orbits, of [`OFFSET`].
    pub(crate) amplification: Vec<f64>,
}

pub(crate) fn all() -> Result<Vec<Growth>, Failure> {
    let cases = [circular()?, with_mass()?].concat();
    let names = ["near_radial", "near_2to1_ellipse"];
    cases.iter().filter(|case| names.contains(&case.name)).map(growth).collect()
}

fn growth(case: &Case) -> Result<Growth, Failure> {
    let period = case.station.period();
    let mut pair = [case.start; 2];
    pair[1].q[0] += OFFSET;
    let mut amplification = Vec::new();
    for orbit in 0..ORBITS {
        let span = [orbit as f64 * period, (orbit + 1) as f64 * period];
        for state in &mut pair {
            *state = carried(case, *state, span)?;
        }
        let [x, y, z] = std::array::from_fn(|i| pair[1].q[i] - pair[0].q[i]);
        amplification.push(f64::hypot(x, y).hypot(z) / OFFSET);
    }
    Ok(Growth { case: case.name, station_mass: case.mass, amplification })
}
