//! Formulas that are evaluated along a motion, and in which direction they pass zero.

use mbs_derive::interpret::State;
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_ensemble::plan::Direction;

use super::drive;
use crate::equations::{Equations, Motion as Moving};

/// What is evaluated along a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Formula {
    /// The number of the function that computes it.
    Function(usize),
    /// T
    KineticEnergy,
    /// V
    PotentialEnergy,
    /// T + V
    Energy,
}

impl Formula {
    /// The formula that a word stands for.
    pub(crate) fn of_word(word: &str) -> Option<Self> {
        match word {
            "kinetic_energy" => Some(Formula::KineticEnergy),
            "potential_energy" => Some(Formula::PotentialEnergy),
            "energy" => Some(Formula::Energy),
            _ => None,
        }
    }

    /// Whether a formula is such a word, which the text of a mechanism does not declare to be something else.
    pub(crate) fn is_word(formula: &str, text: &str) -> bool {
        let declares = |word: &str| text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).any(|w| w == word);
        Formula::of_word(formula).is_some() && !declares(formula)
    }

    /// What evaluates a formula, and its unit, where these are watched; `None` where it is not one number.
    pub(crate) fn resolved(derivation: &Derivation, formula: &str, watched: &[String]) -> Option<(Self, String)> {
        match watched.iter().position(|other| other == formula) {
            None => Formula::of_word(formula).map(|word| (word, "J".to_string())),
            Some(number) => match drive::watched(derivation, number) {
                Some((number, [unit])) => Some((Formula::Function(number), unit.clone())),
                _ => None,
            },
        }
    }

    /// At a time and a place.
    pub(crate) fn value(self, equations: &Equations<'_>, t: f64, moving: &Moving) -> f64 {
        equations.at(t, &moving.q, &moving.qd, |state| self.of(equations, state))
    }

    /// At a state.
    pub(crate) fn of(self, equations: &Equations<'_>, state: &State) -> f64 {
        let energy = |kind| equations.scalar(kind, state);
        match self {
            Formula::Function(number) => equations.evaluate_number(number, state),
            Formula::KineticEnergy => energy(FunctionKind::KineticEnergy),
            Formula::PotentialEnergy => energy(FunctionKind::PotentialEnergy),
            Formula::Energy => energy(FunctionKind::KineticEnergy) + energy(FunctionKind::PotentialEnergy),
        }
    }
}

/// As the integrators know it.
pub(crate) fn runtime(direction: Direction) -> mbs_runtime::Direction {
    match direction {
        Direction::Any => mbs_runtime::Direction::Any,
        Direction::Rising => mbs_runtime::Direction::Rising,
        Direction::Falling => mbs_runtime::Direction::Falling,
    }
}
