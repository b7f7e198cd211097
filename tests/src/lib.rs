//! What the generated code is checked against.
//!
//! - [`random`]: seeded states, with exact zeros and straight arms among them;
//! - [`compare`]: one error measure for numbers, vectors and matrices;
//! - [`by_hand`]: formulas of mechanics texts, typed to be run, and [`counting`]: numbers that count what is done to
//!   them;
//! - [`mod@reference`]: equations of motion derived another way, with no generator in sight;
//! - [`referee`]: a second reading of the language, and random mechanisms of every construct;
//! - [`robustness`]: random models, most of them wrong;
//! - [`mutants`]: changes of the source that tests must notice;
//! - [`mechanisms`]: generated from `mechanisms/*.mbs`, which were written from the manual alone.

/// The examples of the book in Rust.
#[cfg(doctest)]
pub mod book {
    #[doc = include_str!("../../docs/integrators.md")]
    pub mod integrators {}
    #[doc = include_str!("../../docs/mathematics/constraints.md")]
    pub mod constraints {}
    #[doc = include_str!("../../docs/mathematics/coriolis.md")]
    pub mod coriolis {}
    #[doc = include_str!("../../docs/mathematics/lanes.md")]
    pub mod lanes {}
    #[doc = include_str!("../../docs/moving_frames.md")]
    pub mod moving_frames {}
}

pub mod by_hand;
pub mod compare;
pub mod counting;
pub mod mechanisms;
pub mod mutants;
pub mod random;
pub mod referee;
pub mod reference;
pub mod robustness;

use mbs_derive::expr::Value;
use mbs_derive::interpret::{Interpreter, State};

/// The results of a function that the text of a mechanism has named: an output's or a reaction's.
pub fn named<V: Value>(interpreter: &Interpreter<'_, V>, name: &str, state: &State<V>) -> Option<Vec<V>> {
    interpreter.derivation().named(name).map(|function| interpreter.evaluate(function, state))
}
