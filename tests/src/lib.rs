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
    #[doc = include_str!("../../docs/ensembles.md")]
    pub mod ensembles {}
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

use mbs_derive::expr::{Graph, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::Derivation;
use mbs_derive::{declared, derived};

/// The text of a mechanism, by its module: of `models`, which are mbs-models' `SOURCES`, of those beside them, or of
/// [`mechanisms`].
///
/// # Panics
/// If there is none.
pub fn source(models: &[(&'static str, &'static str)], module: &str) -> &'static str {
    let apart = [
        ("marine_platform", include_str!("../../models/mechanisms/marine/marine_platform.mbs")),
        ("assistive_arm", include_str!("../../models/mechanisms/elastic/assistive_arm.mbs")),
    ];
    let mut all = models.iter().chain(mechanisms::SOURCES).chain(&apart);
    all.find(|(name, _)| *name == module).unwrap_or_else(|| panic!("no mechanism {module}")).1
}

/// The programs of a mechanism, not proved.
///
/// # Panics
/// With the report if the text is none.
pub fn derivation(source: &str) -> Derivation {
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("case.mbs", source)));
    derived(&lagrangian)
}

/// The results of a function that the text of a mechanism has named: an output's or a reaction's.
pub fn named<V: Value>(interpreter: &Interpreter<'_, V>, name: &str, state: &State<V>) -> Option<Vec<V>> {
    interpreter.derivation().named(name).map(|function| interpreter.evaluate(function, state))
}
