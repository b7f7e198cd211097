//! Chains of 5, 10, 20 and 40 links about skew axes, their inverse and forward dynamics, generated when this crate is
//! built: `growth` and `benches/` time them.

include!(concat!(env!("OUT_DIR"), "/chains.rs"));
