//! The mechanisms of mbs, each described once by its energies in `mechanisms/*.mbs` and generated at build time.
//!
//! A new mechanism is one new file there. [`SOURCES`] lists the declarations; [`for_each_mechanism!`] hands every
//! mechanism to a macro, which is how the property tests reach all of them. Beside them stands what they need around
//! their dynamics: [`arm`], [`orbit`], [`platform`], [`quadrotor`]; and what brings three of them together: [`experiment`].
#![no_std]

#[cfg(feature = "std")]
extern crate std;

#[cfg(any(feature = "std", feature = "libm"))]
pub mod arm;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod experiment;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod orbit;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod platform;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod quadrotor;
#[cfg(any(feature = "std", feature = "libm"))]
mod vector;

include!(concat!(env!("OUT_DIR"), "/mechanisms.rs"));

/// The Rust on the page about frames that move is tested with that of this crate.
#[cfg(doctest)]
#[doc = include_str!("../../docs/moving_frames.md")]
struct MovingFrames;
