//! The systems of `mbs_models`: arm, platform, quadrotor, orbits, and the experiment that joins them.

mod adaptive_control;
mod arm_dynamics;
mod arm_kinematics;
mod arm_trajectory;
mod assembly;
mod assistive;
mod elastic;
#[path = "../errata.rs"]
mod errata;
mod estimator;
mod experiment;
mod fmu_manual;
mod marine;
mod orbit_anomaly;
mod orbit_docking;
mod orbit_elements;
mod orbit_extremes;
mod orbit_kepler;
mod orbit_lambert;
mod orbit_mission;
mod orbit_relative;
mod orbits;
mod platform;
mod quadrotor;
mod quadrotor_decks;
mod quadrotor_refused;
mod quadrotor_standing;
mod quadrotor_wind;
mod sensors;
mod thesis_equations;
mod thesis_map;
