//! The motions about a station, in its axes: x away from the Earth, y along the track, z along the normal of the orbit.

use crate::Failure;
use mbs_orbit::EARTH_MU;
use mbs_orbit::station::Station;
use mbs_runtime::State;

/// Distance of the station from the centre of the Earth on its circle \[m\]: 400 km above the equator.
pub const CIRCLE: f64 = 6_778_137.0;
/// Mass of the station \[kg\], assumed.
pub const STATION_MASS: f64 = 420e3;

/// One motion.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Kind of station, as JSON has it.
    pub group: &'static str,
    /// Of the motion, as JSON has it.
    pub name: &'static str,
    /// The orbit about which it moves.
    pub station: Station,
    /// The mass of the station \[kg\]; zero where it attracts nothing.
    pub mass: f64,
    /// Metres and metres per second.
    pub start: State<[f64; 3]>,
}

/// On a circle; the astronaut at rest in the station's axes, on the same circle, or on a closed ellipse.
pub fn circular() -> Result<Vec<Case>, Failure> {
    let station = Station::on_a_circle(EARTH_MU, CIRCLE)?;
    // A chord of 1000 km to a point of the same circle.
    let chord = 1e6;
    let sagitta = chord * chord / (2.0 * CIRCLE);
    let along = (chord * chord - sagitta * sagitta).sqrt();
    let n = station.rate();
    let at_rest = |place| State { q: place, qd: [0.0; 3] };
    let cases = [
        ("far_radial", at_rest([1e6, 0.0, 0.0])),
        ("far_tangent", at_rest([0.0, 1e6, 0.0])),
        ("far_same_orbit", at_rest([-sagitta, along, 0.0])),
        ("near_radial", at_rest([3.0, 0.0, 0.0])),
        ("near_tangent", at_rest([0.0, 3.0, 0.0])),
        ("near_2to1_ellipse", State { q: [3.0, 0.0, 0.0], qd: [0.0, -2.0 * n * 3.0, 0.0] }),
        ("near_3d", NEAR_3D),
    ];
    Ok(cases.map(|(name, start)| Case { group: "circular", name, station, mass: 0.0, start }).into())
}

const NEAR_3D: State<[f64; 3]> = State { q: [2.0, 1.0, 2.0], qd: [1e-3, -2e-3, 1.5e-3] };

/// On an ellipse of 7500 km and eccentricity 0.1, from its perigee on.
fn elliptic() -> Result<Vec<Case>, Failure> {
    let station = Station::from_periapsis(EARTH_MU, 0.9 * 7.5e6, 0.1)?;
    let cases = [
        ("near", State { q: [3.0, 1.0, 2.0], qd: [1e-3, -6e-3, 1e-3] }),
        ("far", State { q: [0.0, 1e6, 0.0], qd: [0.0; 3] }),
    ];
    Ok(cases.map(|(name, start)| Case { group: "elliptic", name, station, mass: 0.0, start }).into())
}

/// The near motions in the plane, about a station that attracts as a point.
pub fn with_mass() -> Result<Vec<Case>, Failure> {
    let names = ["near_radial", "near_tangent", "near_2to1_ellipse"];
    let heavy = |case: Case| {
        let station = case.station.with_mass(STATION_MASS)?;
        Ok(Case { group: "station_mass", station, mass: STATION_MASS, ..case })
    };
    circular()?.into_iter().filter(|case| names.contains(&case.name)).map(heavy).collect()
}

/// All motions, group by group.
pub fn all() -> Result<Vec<Case>, Failure> {
    Ok([circular()?, elliptic()?, with_mass()?].concat())
}
