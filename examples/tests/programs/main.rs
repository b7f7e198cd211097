//! The examples as outside programs call them: what they print and what they write.

mod arm;
mod docking;
mod estimator;
mod experiment;
mod gallery;
mod orbits;
mod platform;
mod quadrotor;
mod support;
