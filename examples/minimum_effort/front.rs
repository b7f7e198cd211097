//! Two objectives: little time and little effort.

use mbs_arm::trajectory::minimum_effort::MinimumEffort;
use mbs_arm::trajectory::minimum_effort::front::{self, Choice, Search};
use mbs_models::irb7600::Irb7600;

use super::*;
use crate::motion::transfer;

const SEARCH: Search = Search { intervals: 40, points: 13, bisections: 5, flat: 1e-5 };
/// A time in which the arm arrives with ease, from which the search begins \[s\].
const EASY: f64 = 2.0;

/// The front between the postures.
pub(crate) struct Front(front::Front<6, 6>);

fn choices(motions: &[MinimumEffort<6, 6>]) -> Vec<Choice> {
    motions.iter().map(Choice::of).collect()
}

impl Front {
    pub(crate) fn new() -> Result<Self, Failure> {
        Ok(Self(SEARCH.front(&Irb7600::default(), &transfer(EASY))?))
    }

    pub(crate) fn choices(&self) -> Vec<Choice> {
        choices(&self.0.motions)
    }

    pub(crate) fn dominated(&self) -> Vec<Choice> {
        choices(&self.0.dominated)
    }

    pub(crate) fn to_json(&self) -> Value {
        let row =
            |choice: Choice| json!({ "duration": choice.duration, "effort": choice.effort, "slope": choice.slope });
        let list = |choices: Vec<Choice>| choices.into_iter().map(row).collect::<Value>();
        json!({
            "pareto": list(self.choices()),
            "dominated": list(self.dominated()),
            "shortest_time_within": self.0.gap,
            "iterations": self.0.motions.iter().map(MinimumEffort::iterations).collect::<Vec<_>>(),
        })
    }

    pub(crate) fn text(&self) -> Result<String, Failure> {
        let mut text = String::from("\nThe front of time and effort:\n   time [s]   effort [s]   dJ/dT = H\n");
        for Choice { duration, effort, slope } in self.choices() {
            writeln!(text, "{duration:11.4} {effort:12.6} {slope:11.5}")?;
        }
        writeln!(
            text,
            "In {:.4} s less no motion was found. More time than the last costs effort again: start and stop must be held up.",
            self.0.gap
        )?;
        Ok(text)
    }
}
