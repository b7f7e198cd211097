//! Derives equations of motion from energies.

pub mod derive;
pub mod diagnostic;
pub mod expr;
pub mod interpret;
pub mod model;
pub mod optimise;
pub mod parse;
