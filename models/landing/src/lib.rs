//! A quadrotor lands on a moving platform, chapter 5 of the thesis: [`quadrotor`]; and the laboratory experiment of
//! chapter 6 that shows such a landing to scale, arm, platform and quadrotor together: [`experiment`]. What the
//! vehicle's sensors see, and where it is by them: [`sensors`], [`estimator`].
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod estimator;
pub mod experiment;
pub mod quadrotor;
pub mod sensors;
