//! Derives equations of motion from energies.

pub mod diagnostic;
pub mod expr;
pub mod model;
pub mod parse;
