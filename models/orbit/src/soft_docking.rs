//! The last metres up to a soft docking, of bodies: by their port frames, under attitude control, with jets that fire
//! pulses, plumes that push the station, and a compliant ring that captures or does not.
//!
//! | part            | what                                                                                          |
//! |-----------------|-----------------------------------------------------------------------------------------------|
//! | [`docking_bodies`] | the generated mechanism: two rigid bodies with quaternions in the axes of the orbit, tide, gravity gradient, ring |
//! | [`bodies`]      | place, velocity, attitude and spin of both; how their ports are misaligned                       |
//! | [`attitude`]    | quaternion feedback                                                                           |
//! | [`jets`]        | which jets make a wrench, and pulses that are not shorter than the valves allow                  |
//! | [`plume`]       | what a jet's exhaust does to a surface                                                        |
//! | [`ring`]        | touch, trip of the latches, capture or rebound                                                |
//! | [`flight`]      | all together: the final approach                                                              |
//! | [`finite_burn`] | burns that last, for the far phases, against the impulses that they are planned as               |
//!
//! ```
//! use mbs_orbit::soft_docking::flight::SoftDocking;
//! use mbs_orbit::soft_docking::ring::Outcome;
//!
//! let report = SoftDocking::to_the_station().fly(|_| {}).unwrap();
//! assert_eq!(report.contact.outcome, Outcome::Captured);
//! ```
//!
//! # Source
//! Fehse, *Automated Rendezvous and Docking of Spacecraft*, 2003, chapters 4, 5 and 8.

mbs_runtime::include_mechanism!("docking_bodies");

pub mod attitude;
pub mod bodies;
pub mod finite_burn;
pub mod flight;
pub mod jets;
pub mod plume;
pub mod ring;
