//! What the program `mbs` shares with the examples: figures.

pub mod chart;
