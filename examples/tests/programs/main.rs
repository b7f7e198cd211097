//! The examples as outside programs call them: what they print and what they write.

mod adaptive;
mod arm;
mod assembly_cell;
mod assistive_arm;
mod dispersions;
mod docking;
mod elastic_arm;
mod estimator;
mod experiment;
mod four_bar;
mod gallery;
mod growth;
mod landing_maps;
mod marine;
mod minimum_effort;
mod mpc;
mod nonholonomic;
mod orbits;
mod platform;
mod quadrotor;
mod rapid;
mod rapid_reader;
mod soft_docking;
mod support;
mod touchdown;
