//! `--until`: a formula that ends a motion where it passes zero.

use std::str::FromStr;

use mbs_derive::diagnostic::Diagnostics;
use mbs_derive::expr::Graph;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::{Analysis, Error};
use mbs_ensemble::plan::Direction;

use super::drive;
use super::formula::{Formula, runtime};
use crate::failure::Failure;
use crate::message::Messages;

/// The option.
const OPTION: &str = "--until";

/// A formula and the direction in which it passes zero: `height falling`.
#[derive(Clone, Debug)]
pub(crate) struct Until {
    formula: String,
    direction: Direction,
}

impl FromStr for Until {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let (formula, direction) = match text.rsplit_once(char::is_whitespace) {
            Some((formula, "rising")) => (formula, Direction::Rising),
            Some((formula, "falling")) => (formula, Direction::Falling),
            Some((formula, "any")) => (formula, Direction::Any),
            _ => (text, Direction::Any),
        };
        let formula = formula.trim().to_string();
        match formula.as_str() {
            "" | "rising" | "falling" | "any" => {
                Err("write a formula and, if need be, its direction: `height falling`".to_string())
            }
            _ => Ok(Until { formula, direction }),
        }
    }
}

impl Until {
    /// As a sentence has it.
    pub(crate) fn text(&self) -> String {
        let direction = match self.direction {
            Direction::Any => "",
            Direction::Rising => " rising",
            Direction::Falling => " falling",
        };
        format!("{}{direction}", self.formula)
    }

    /// What is to be declared for it besides: the formula, if it is no word that every mechanism has.
    pub(crate) fn watched(&self, sources: &Sources) -> Result<Vec<String>, Failure> {
        let text = sources.main().text.clone().unwrap_or_default();
        if Formula::is_word(&self.formula, &text) {
            return Ok(Vec::new());
        }
        drive::check_formula(OPTION, &format!("\"{}\"", self.formula), &self.formula)?;
        Ok(vec![self.formula.clone()])
    }

    /// What is wrong with the formula in a mechanism that was declared with it; `None` where it is the mechanism that
    /// is wrong.
    pub(crate) fn refused(&self, sources: &Sources) -> Option<Failure> {
        let Err(Error::Declaration(errors)) = Analysis::of(sources, &Graph::verbatim()) else { return None };
        let text = sources.main().text.clone().ok()?;
        let place = drive::places_of_watched(&text).into_iter().next()?;
        let mut diagnostics = Diagnostics::default();
        for error in errors.iter().filter(|error| place.contains(&error.span.start)) {
            let span = error.span.start - place.start..error.span.end.min(place.end) - place.start;
            let diagnostic = diagnostics.data(span, error.message.clone());
            if let Some(help) = &error.help {
                diagnostic.help(help.clone());
            }
        }
        let shown = || Messages::of(&diagnostics, &Sources::new(OPTION, &self.formula)).into();
        diagnostics.has_errors().then(shown)
    }

    /// What evaluates it.
    pub(crate) fn resolved(&self, derivation: &Derivation) -> Result<Ending, Failure> {
        let found = Formula::resolved(derivation, &self.formula, std::slice::from_ref(&self.formula))
            .or_else(|| Formula::resolved(derivation, &self.formula, &[]));
        let (formula, _) = found.ok_or_else(|| {
            Failure::new(format_args!("{OPTION} \"{}\": a formula that passes zero is one number", self.formula))
        })?;
        Ok(Ending { text: self.formula.clone(), formula, direction: runtime(self.direction) })
    }
}

/// What ends a motion.
#[derive(Clone, Debug)]
pub(crate) struct Ending {
    pub(crate) text: String,
    pub(crate) formula: Formula,
    pub(crate) direction: mbs_runtime::Direction,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_the_last_word() {
        let read = |text: &str| text.parse::<Until>().map(|until| (until.formula, until.direction));
        assert_eq!(read("l - 2*x falling"), Ok(("l - 2*x".to_string(), Direction::Falling)));
        assert_eq!(read(" x rising "), Ok(("x".to_string(), Direction::Rising)));
        assert_eq!(read("x any"), Ok(("x".to_string(), Direction::Any)));
        assert_eq!(read("x_falling"), Ok(("x_falling".to_string(), Direction::Any)));
        for text in ["", " ", "falling", " any"] {
            assert!(read(text).is_err(), "{text:?}");
        }
    }
}
