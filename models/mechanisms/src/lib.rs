//! The mechanisms of mbs, each described once by its energies in `models/mechanisms/*.mbs` and generated at build time.
//!
//! A new mechanism is one new file there. [`SOURCES`] lists the declarations; [`for_each_mechanism!`] hands every
//! mechanism to a macro, which is how the property tests reach all of them; [`marine_platform`] is apart. What systems
//! need around their dynamics is in crates of their own: `mbs-arm`, `mbs-platform`, `mbs-landing`, `mbs-orbit`.
#![no_std]

pub mod check;

include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));
include!(concat!(env!("OUT_DIR"), "/marine_platform.rs"));

/// The declaration of [`marine_platform`], which is not among [`SOURCES`]: no snapshot is kept of its code.
pub const MARINE_PLATFORM: &str = include_str!("../marine/marine_platform.mbs");

/// The Rust on the page about frames that move is tested with that of this crate.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/moving_frames.md")]
struct MovingFrames;
