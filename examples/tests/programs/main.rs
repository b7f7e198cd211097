//! The examples as outside programs call them: what they print and what they write.

mod arm;
mod assistive_arm;
mod docking;
mod elastic_arm;
mod experiment;
mod gallery;
mod minimum_effort;
mod orbits;
mod platform;
mod quadrotor;
mod support;
