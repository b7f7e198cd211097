//! Motions about an orbital station, and figures 7.3 and 7.4.

pub mod cases;
pub mod figures;
pub mod flight;
