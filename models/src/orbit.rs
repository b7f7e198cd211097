//! Motion about the Earth and about a station, as chapter 7 of the thesis treats it: what surrounds the generated mechanisms.
//!
//! | thesis                        | here                                                                                      |
//! |-------------------------------|-------------------------------------------------------------------------------------------|
//! | two-body problem              | [`kepler`]: states after a time, on every conic; [`transition`]: their derivatives            |
//! | restricted three-body problem | [`libration`]: points of rest and their stability                                             |
//! | (7.11), study cases           | [`station`]: about a station, by the generated mechanisms; [`collision`]: until bodies meet |
//!
//! Every function takes μ, G times the mass of the centre, and any consistent units; docs name SI units.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 7.

pub mod collision;
mod integrals;
pub mod kepler;
pub mod libration;
pub mod station;
pub mod transition;
mod universal;
pub mod vector;

/// G times the mass of the Earth \[m³/s²\].
pub const EARTH_MU: f64 = 3.986_004_418e14;
/// Radius of the Earth at the equator \[m\].
pub const EARTH_RADIUS: f64 = 6_378_137.0;
