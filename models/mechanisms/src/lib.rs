//! The mechanisms of mbs, each described once by its energies in `models/mechanisms/*.mbs` and generated at build time.
//!
//! A new mechanism is one new file there. [`SOURCES`] lists the declarations; [`for_each_mechanism!`] hands every
//! mechanism to a macro, which is how the property tests reach all of them. Those in folders are apart: no snapshot is
//! kept of their code. `tables/` holds what several of them have in common, which they import; in [`SOURCES`] it stands
//! in their texts. What systems need around their dynamics is in crates of their own: `mbs-arm`, `mbs-platform`,
//! `mbs-landing`, `mbs-orbit`.
#![no_std]

pub mod check;
#[cfg(any(feature = "std", feature = "libm"))]
mod error;

#[cfg(any(feature = "std", feature = "libm"))]
pub use error::{At, Error, Failure};

include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));
include!(concat!(env!("OUT_DIR"), "/marine_platform.rs"));

/// The declaration of [`marine_platform`], which is not among [`SOURCES`].
pub const MARINE_PLATFORM: &str = include_str!("../marine/marine_platform.mbs");

// What `elastic/` declares: mechanisms with springs, which have tests of their own and no snapshots.
include!(concat!(env!("OUT_DIR"), "/assistive_arm.rs"));
include!(concat!(env!("OUT_DIR"), "/irb7600_elastic.rs"));
include!(concat!(env!("OUT_DIR"), "/stewart_platform_elastic.rs"));

/// What sensors on a body see, and where it is after a step of their time: declared for its outputs alone, of which
/// values and Jacobians are generated and nothing else.
pub mod sensors {
    include!(concat!(env!("OUT_DIR"), "/strapdown.rs"));
    include!(concat!(env!("OUT_DIR"), "/sensor_head.rs"));
}

/// The Rust on the page about frames that move is tested with that of this crate.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/moving_frames.md")]
struct MovingFrames;
