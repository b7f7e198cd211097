//! What the generated code is checked against.
//!
//! - [`random`]: seeded states, with exact zeros and straight arms among them;
//! - [`compare`]: one error measure for numbers, vectors and matrices;
//! - [`mod@reference`]: equations of motion derived another way, with no generator in sight;
//! - [`robustness`]: random models, most of them wrong;
//! - [`mechanisms`]: generated from `mechanisms/*.mbs`, which were written from the manual alone.

pub mod compare;
pub mod mechanisms;
pub mod random;
pub mod reference;
pub mod robustness;
