//! The platform along the motions of Tables 3 and 4, and figures 4.5 to 4.12.

pub mod figures;
pub mod tables;
