//! Motion about the Earth and about a station, as chapter 7 of the thesis treats it: what surrounds the generated mechanisms.
//!
//! | thesis                        | here                                                                                      |
//! |-------------------------------|-------------------------------------------------------------------------------------------|
//! | two-body problem              | [`kepler`]: states after a time, on every conic; [`transition`]: their derivatives; [`elements`], [`anomaly`] |
//! | restricted three-body problem | [`libration`]: points of rest and their stability                                         |
//! | (7.4)–(7.11), two motions     | [`lvlh`]: the frame of a station, exact relative motions                                  |
//! | (7.11), study cases           | [`station`]: about a station, by the generated mechanisms; [`collision`]: until bodies meet |
//! | 7.5, near a station           | [`clohessy_wiltshire`], [`yamanaka_ankersen`]: linear, on a circle and on an ellipse        |
//! | rendezvous                    | [`lambert`]: from one place to another in a time; [`mission`]: up to the port of a station     |
//!
//! Every function takes μ, G times the mass of the centre, and any consistent units; docs name SI units.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 7.

pub mod anomaly;
pub mod clohessy_wiltshire;
pub mod collision;
pub mod elements;
mod integrals;
pub mod kepler;
pub mod lambert;
pub mod libration;
pub mod lvlh;
pub mod mission;
pub mod station;
pub mod transition;
mod universal;
pub mod vector;
pub mod yamanaka_ankersen;

/// G times the mass of the Earth \[m³/s²\].
pub const EARTH_MU: f64 = 3.986_004_418e14;
/// Radius of the Earth at the equator \[m\].
pub const EARTH_RADIUS: f64 = 6_378_137.0;
