//! The flights, the contacts and the burns that are looked at.

use mbs_examples::Failure;
use mbs_orbit::soft_docking::docking_bodies::Params;
use mbs_orbit::soft_docking::finite_burn::{Engine, Raise};
use mbs_orbit::soft_docking::flight::{Moment, Report, SoftDocking, Start};
use mbs_orbit::soft_docking::jets::JetSet;
use mbs_orbit::soft_docking::ring::{Contact, Pressing, meet};
use mbs_orbit::{EARTH_MU, EARTH_RADIUS};

/// Thrusts of the engine that the far burns are flown by \[N\].
const THRUSTS: [f64; 11] = [400.0, 450.0, 520.0, 620.0, 800.0, 1100.0, 1600.0, 2400.0, 3200.0, 6400.0, 12_800.0];
/// Effective velocity of its exhaust \[m/s\].
const EXHAUST: f64 = 3000.0;
/// Altitudes of the circles, those of `docking` \[m\].
const ALTITUDES: [f64; 2] = [320e3, 400e3];

pub(crate) struct Flight {
    pub(crate) moments: Vec<Moment>,
    pub(crate) report: Report,
    pub(crate) docking: SoftDocking,
}

/// With jets that are canted away from the station, and with straight ones.
pub(crate) fn flights() -> Result<[Flight; 2], Failure> {
    let canted = SoftDocking::to_the_station();
    let straight = SoftDocking { jets: JetSet::capsule(0.0), ..canted };
    Ok([flight(canted)?, flight(straight)?])
}

fn flight(docking: SoftDocking) -> Result<Flight, Failure> {
    let mut moments = Vec::new();
    let report = docking.fly(|moment| moments.push(*moment))?;
    Ok(Flight { moments, report, docking })
}

/// A contact that is begun at touch.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) contact: Contact,
    pub(crate) way: Vec<Pressing>,
}

pub(crate) fn contacts() -> Result<Vec<Case>, Failure> {
    // Speed, beside the axis, tilt, roll.
    let cases: [(&str, f64, f64, f64, f64); 7] = [
        ("aligned", 0.07, 0.0, 0.0, 0.0),
        ("within all limits", 0.07, 0.08, 3.0, 3.0),
        ("beside the axis", 0.07, 0.15, 0.0, 0.0),
        ("tilted", 0.07, 0.0, 6.0, 0.0),
        ("too fast", 0.14, 0.0, 0.0, 0.0),
        ("too slow", 0.02, 0.0, 0.0, 0.0),
        ("beside the ring", 0.07, 0.8, 0.0, 0.0),
    ];
    cases.into_iter().map(|(name, speed, aside, tilt, roll)| case(name, speed, aside, [roll, tilt, 0.0])).collect()
}

fn case(name: &'static str, speed: f64, aside: f64, angles: [f64; 3]) -> Result<Case, Failure> {
    let docking = SoftDocking::to_the_station();
    let start = Start { distance: 0.0, aside: [aside, 0.0], angles: angles.map(f64::to_radians), spin: [0.0; 3] };
    let docking = SoftDocking { start, speeds: [speed, speed], ..docking };
    let mut state = docking.pair().to_state(&docking.params);
    let mut way = Vec::new();
    let times = [0.0, docking.contact];
    let contact = meet(&docking.params, &docking.latches, &mut state, times, |pressing| way.push(*pressing))?;
    Ok(Case { name, contact, way })
}

/// A thrust, and the way from the lower circle to the higher one by it.
pub(crate) struct Burn {
    pub(crate) thrust: f64,
    pub(crate) raise: Raise,
}

pub(crate) fn burns() -> Result<Vec<Burn>, Failure> {
    let radii = ALTITUDES.map(|altitude| EARTH_RADIUS + altitude);
    let mass = Params::<f64>::default().chaser_mass;
    let burn = |thrust: f64| {
        let raise = Engine { thrust, exhaust_velocity: EXHAUST }.raise(EARTH_MU, mass, radii)?;
        Ok(Burn { thrust, raise })
    };
    THRUSTS.into_iter().map(burn).collect()
}
