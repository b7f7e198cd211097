//! The examples as outside programs call them: what they print and what they write.

mod arm;
mod docking;
mod experiment;
mod gallery;
mod mpc;
mod orbits;
mod platform;
mod quadrotor;
mod support;
