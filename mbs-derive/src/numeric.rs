//! Numbers at states: random ones, and elimination of matrices of them.
//!
//! - `random`: random numbers, the same in every process;
//! - `elimination`: definiteness of symmetric matrices that are known to rounding;
//! - `moments`: principal moments of inertia, and whether a body can have them;
//! - `echelon`: ranks and dependent rows in a finite field.

pub(crate) mod echelon;
pub(crate) mod elimination;
pub(crate) mod moments;
pub(crate) mod random;

pub use elimination::eliminate;
pub use random::Random;
