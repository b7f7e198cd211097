//! Motion about the Earth and about a station, as chapter 7 of the thesis treats it: what surrounds the generated mechanisms.
//!
//! | thesis                        | here                                                                                      |
//! |-------------------------------|-------------------------------------------------------------------------------------------|
//! | two-body problem              | [`kepler`]: states after a time, on every conic; [`transition`]: their derivatives            |
//!
//! Every function takes μ, G times the mass of the centre, and any consistent units; docs name SI units.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 7.

mod integrals;
pub mod kepler;
pub mod transition;
mod universal;
pub mod vector;

/// G times the mass of the Earth \[m³/s²\].
pub const EARTH_MU: f64 = 3.986_004_418e14;
/// Radius of the Earth at the equator \[m\].
pub const EARTH_RADIUS: f64 = 6_378_137.0;
