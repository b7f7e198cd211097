//! Numbers at states: random ones, and elimination of matrices of them.
//!
//! - `random`: random numbers, the same in every process;
//! - `elimination`: definiteness of symmetric matrices that are known to rounding;
//! - `echelon`: ranks and dependent rows in a finite field.

pub(crate) mod echelon;
pub(crate) mod elimination;
pub(crate) mod random;

pub use elimination::eliminate;
pub use random::Random;
