//! Motion about the Earth and about a station, as chapter 7 of the thesis treats it: what surrounds the generated
//! mechanisms.
//!
//! | thesis                        | here                                                                                      |
//! |-------------------------------|-------------------------------------------------------------------------------------------|
//! | two-body problem              | [`kepler`]: states after a time, on every conic; [`transition`]: their derivatives; [`elements`], [`anomaly`] |
//! | restricted three-body problem | [`libration`]: points of rest and their stability                                         |
//! | (7.4)–(7.11), two motions     | [`lvlh`]: the frame of a station, exact relative motions                                  |
//! | (7.11), study cases           | [`station`]: about a station, by the generated mechanisms; [`collision`]: until bodies meet |
//! | 7.5, near a station           | [`clohessy_wiltshire`], [`yamanaka_ankersen`]: linear, on a circle and on an ellipse        |
//! | rendezvous                    | [`lambert`]: from one place to another in a time; [`mission`]: up to the port of a station     |
//! | docking of bodies             | [`soft_docking`]: ports, attitude, jets, plumes, contact; burns that last                    |
//!
//! # Start here
//! A station goes round, and something is let go beside it. [`station::Station`] is on its orbit, [`lvlh::Frame`] turns
//! inertial states into what is seen from it, [`lvlh::relative_motion`] says where the other one is later:
//!
//! ```
//! use mbs_orbit::EARTH_MU;
//! use mbs_orbit::lvlh::{Frame, relative_motion};
//! use mbs_orbit::station::Station;
//! use mbs_orbit::vector::StateVector;
//!
//! let station = Station::on_a_circle(EARTH_MU, 6_778_137.0).unwrap();
//! // At rest in the station's frame, 3 m above it: x away from the Earth, y along the motion.
//! let above = StateVector::new([3.0, 0.0, 0.0], [0.0; 3]);
//! let after = relative_motion(EARTH_MU, &station.state(0.0).unwrap(), &above, station.period()).unwrap();
//! // After one revolution it has fallen behind by 12π of its height, as Clohessy and Wiltshire say.
//! assert!((after.relative.position[1] + 36.0 * std::f64::consts::PI).abs() < 1e-3);
//! let inertial = Frame::of(&after.station).unwrap().to_inertial(&after.relative);
//! assert!(inertial.position[1] < after.station.position[1]);
//! ```
//!
//! [`kepler`] here carries states by formula; [`mbs_models::kepler`] is the generated mechanism of the same motion.
//!
//! Every function takes μ, G times the mass of the centre, and any consistent units; docs name SI units.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 7.
#![no_std]

#[cfg(feature = "std")]
extern crate std;

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
pub mod soft_docking;
pub mod station;
pub mod transition;
mod universal;
pub mod vector;
pub mod yamanaka_ankersen;

/// G times the mass of the Earth \[m³/s²\].
pub const EARTH_MU: f64 = 3.986_004_418e14;
/// Radius of the Earth at the equator \[m\].
pub const EARTH_RADIUS: f64 = 6_378_137.0;
