//! Landings of the quadrotor, on a deck that moves exactly, in gusts, on the platform and in great number, and figures
//! 5.2 to 5.9.

pub mod figures;
pub mod flight;
pub mod gusts;
pub mod members;
pub mod platform;
