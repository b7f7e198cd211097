//! The arm on the way of Table 2: its cases, and figures 3.4 to 3.11.

pub mod cases;
pub mod figures;
