//! The laboratory experiment of chapter 6 of the thesis: the arm on its rail carries the vehicle along a scaled
//! landing, down to the platform that heaves to scale.
//!
//! | here          | what                                                                                             |
//! |---------------|--------------------------------------------------------------------------------------------------|
//! | [`rail_arm`]  | the arm on its rail, [`irb7600_rail`](mbs_models::irb7600_rail): seven axes, redundancy, rates, forces   |
//! | [`flight`]    | the landing of chapter 5 as a function of time                                                     |
//! | [`inbound`]   | a landing that comes from afar along the rail                                                      |
//! | [`plan`]      | what all machines do at one scale                                                                  |
//! | [`limits`]    | limits of carriage and joints, and what exceeds them                                               |
//! | [`collision`] | arm, vehicle and platform as capsules, and how far they are apart                                  |
//! | [`survey`]    | the extremes of a plan, and which limit breaks first                                               |
//! | [`error`]     | why there is no plan, or none that can be followed                                                 |
//! | [`search`]    | the greatest scale at which none breaks                                                            |
//! | [`tracking`]  | the arm simulated under its controller, up to the contact with the platform                        |
//! | [`landed`]    | arm and platform simulated through the contact, with the force between them                        |
//!
//! The flange plays the vehicle. Its origin is the vehicle's mass centre, its z axis points down where the vehicle's
//! points up:
//!
//! ```text
//! p = (x_c + s (x − x_p), y_c + s (y − y_p), d + s z),   R = Rz(ψ) Ry(θ) Rx(φ) diag(1, −1, −1)
//! ```
//!
//! with the scale `s`, the vehicle at `(x, y, z)` over a platform at `(x_p, y_p)`, and the platform of the laboratory,
//! whose deck is at the height `d` when at rest, at `(x_c, y_c)`. The deck goes up and down with `d + s z_p`. Lengths
//! are scaled, times and angles are not. Axes are those of the rail: x along it, z up, the arm's base at z = 0.
//!
//! ```
//! use mbs_landing::experiment::Experiment;
//! use mbs_landing::experiment::flight::Flight;
//! use mbs_landing::quadrotor::heave::Heave;
//! use mbs_landing::quadrotor::landing::{Landing, Plant};
//!
//! // What the guidance asks for, at a tenth of its size.
//! let landing = Landing::new(Plant::Exact, Heave::CASE_I);
//! let experiment = Experiment::new(Flight::guided(&landing)?);
//! let survey = experiment.plan(0.1)?.survey()?;
//! assert!(survey.is_feasible());
//! // The flange starts 1 m over the deck.
//! let start = experiment.plan(0.1)?.flange(0.0)?.pose.position;
//! assert!((start[2] - 1.6).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 6. Where things stand in the
//! laboratory is assumed: the thesis' summary prints none of it.

#[cfg(feature = "std")]
pub mod collision;
#[cfg(feature = "std")]
pub mod error;
#[cfg(feature = "std")]
pub mod flight;
#[cfg(feature = "std")]
pub mod inbound;
#[cfg(feature = "std")]
pub mod landed;
#[cfg(feature = "std")]
pub mod limits;
#[cfg(feature = "std")]
mod masses;
#[cfg(feature = "std")]
pub mod plan;
pub mod rail_arm;
#[cfg(feature = "std")]
pub mod search;
#[cfg(feature = "std")]
mod standoff;
#[cfg(feature = "std")]
pub mod survey;
#[cfg(feature = "std")]
pub mod tracking;

#[cfg(feature = "std")]
pub use plan::Experiment;
