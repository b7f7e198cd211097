//! The examples as outside programs call them: what they print and what they write.

mod arm;
mod docking;
mod experiment;
mod gallery;
mod orbits;
mod platform;
mod quadrotor;
mod rapid;
mod rapid_reader;
mod support;
