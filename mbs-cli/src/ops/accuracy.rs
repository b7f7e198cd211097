//! `mbs ops --accuracy`: how many digits the generated functions lose, measured against numbers of 200 bits.

use std::collections::BTreeMap;

use mbs_derive::Analysis;
use serde_json::{Map, Value, json};

use super::in_columns;
use crate::accuracy::{Worst, states, worst};

/// The worst errors of a mechanism's functions, in the order of the documentation.
pub(crate) struct Accuracy {
    functions: Vec<(String, Worst)>,
    /// At how many states.
    states: usize,
}

impl Accuracy {
    /// Of code that is run in process.
    pub(crate) fn of(analysis: &Analysis<'_>) -> Self {
        let (lagrangian, programs) = (analysis.lagrangian(), analysis.programs());
        let points = states::points(lagrangian);
        let states = points.len();
        let mut worst: BTreeMap<String, Worst> = worst(lagrangian, programs, points, 0);
        let of = |name: &String| Some((name.clone(), worst.remove(name)?));
        Accuracy { functions: programs.functions.iter().map(|f| &f.name).filter_map(of).collect(), states }
    }

    /// Per function its worst error, what explains it, and where it is most times as large.
    pub(crate) fn object(&self) -> Value {
        let function = |(name, worst): &(String, Worst)| {
            let Worst { ratio, place, numbers, ulp, condition, measured } = worst;
            let object = json!({
                "ulp": ulp, "condition": condition, "ratio": ratio, "at": place, "numbers": numbers, "states": measured,
            });
            (name.clone(), object)
        };
        Value::Object(self.functions.iter().map(function).collect::<Map<_, _>>())
    }

    /// As a table, and what it says.
    pub(crate) fn table(&self) -> String {
        let header = ["function", "error [ulp]", "condition [ulp]", "error/condition", "where"].map(String::from);
        let number = |x: f64| if x < 1e4 { format!("{x:.2}") } else { format!("{x:.1e}") };
        let rows = self.functions.iter().map(|(name, worst)| {
            let place = if worst.ratio > 0.0 { worst.place.clone() } else { String::new() };
            [name.clone(), number(worst.ulp), number(worst.condition), number(worst.ratio), place]
        });
        let rows: Vec<Vec<String>> = std::iter::once(header).chain(rows).map(Vec::from).collect();
        format!("{}\n{}", in_columns(&rows, 1), self.words())
    }

    fn words(&self) -> String {
        format!(
            "Errors of doubles against numbers of 200 bits, at {} states: random, far away, and where things touch,\n\
             are at right angles or zero. ulp: a unit in the last place of the largest component of its kind;\n\
             condition: how many of these come of half a unit in every input and constant, where the error is\n\
             largest. Where error/condition, the largest of all states, is more than 32, digits are lost that\n\
             were there.\n",
            self.states
        )
    }
}
