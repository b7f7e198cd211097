//! Landings of the quadrotor, on a deck that moves exactly, in gusts, and on the platform, and figures 5.2 to 5.9.

pub mod figures;
pub mod flight;
pub mod gusts;
pub mod platform;
