//! The mechanisms of mbs, each described once by its energies in `models/mechanisms/*.mbs` and generated at build time.
//!
//! A new mechanism is one new file there. [`SOURCES`] lists the declarations; [`for_each_mechanism!`] hands every
//! mechanism to a macro, which is how the property tests reach all of them. What systems need around their dynamics is
//! in crates of their own: `mbs-arm`, `mbs-platform`, `mbs-landing`, `mbs-orbit`.
#![no_std]

pub mod check;

include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));

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
