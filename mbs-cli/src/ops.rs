//! `mbs ops`: what one call of each function costs.

#[cfg(feature = "accuracy")]
mod accuracy;
pub(crate) mod explanation;

use std::path::PathBuf;

use mbs_derive::Analysis;
use mbs_derive::optimise::{Derivation, Operations};
use serde_json::{Map, Value, json};

use crate::failure::Failure;
use crate::files::Files;
use crate::mechanism::{self, Derived};
use crate::output;
use explanation::Explanation;

/// Count the operations of every generated function.
///
/// Subtractions count as additions, negations are free, a sine and cosine of one angle are one `sincos`; `flops` is
/// add + mul. Of the mass matrix the lower triangle is computed. What depends on parameters alone is computed once,
/// when the mechanism is made, and not counted. The mechanism is derived in any case, never taken from the cache.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs ops pendulum.mbs --explain")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// Also tell which route each function took, what it would cost by the others, and what regrouping of masses saved.
    #[arg(long)]
    explain: bool,
    /// Also measure the error of each function in units of the last place (ulp), against numbers of 200 bits, beside
    /// the condition of what it computes. Example: mbs ops pendulum.mbs --accuracy
    #[arg(long, hide = cfg!(not(feature = "accuracy")))]
    accuracy: bool,
}

/// What is asked for besides, by the word that it has in JSON.
struct Section {
    word: &'static str,
    object: Value,
    table: String,
}

impl Arguments {
    fn sections(&self, analysis: &Analysis<'_>) -> Vec<Section> {
        let mut sections = Vec::new();
        if self.explain {
            let found = Explanation::of(analysis);
            sections.push(Section { word: "explanation", object: found.object(), table: found.table() });
        }
        #[cfg(feature = "accuracy")]
        if self.accuracy {
            let found = accuracy::Accuracy::of(analysis);
            sections.push(Section { word: "accuracy", object: found.object(), table: found.table() });
        }
        sections
    }
}

/// Prints the operation counts.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    #[cfg(not(feature = "accuracy"))]
    if arguments.accuracy {
        return Err(Failure::of_feature("accuracy"));
    }
    let sources = mechanism::open(&arguments.file, &mut Files::default())?;
    let derived = mechanism::proved_and(&sources, |analysis| arguments.sections(analysis))?;
    let tables = || derived.also.iter().fold(table(&derived), |text, section| format!("{text}\n{}", section.table));
    output::print(&if output::is_json() { output::json(&object(&derived)) } else { tables() })
}

fn object(derived: &Derived<Vec<Section>>) -> Value {
    let (derivation, derive_seconds) = (&derived.mechanism.derivation, derived.derive_seconds);
    let functions: Map<String, Value> =
        derivation.functions.iter().map(|f| (f.name.clone(), counts(f.operations))).collect();
    let mut object = json!({ "mechanism": derivation.name, "derive_seconds": derive_seconds, "functions": functions });
    for section in &derived.also {
        object[section.word] = section.object.clone();
    }
    object
}

/// One function's counts.
pub(crate) fn counts(operations: Operations) -> Value {
    let Operations { add, mul, div, sqrt, sincos, other } = operations;
    json!({
        "add": add, "mul": mul, "div": div, "sqrt": sqrt, "sincos": sincos, "other": other,
        "flops": operations.flops(),
    })
}

fn table<T>(derived: &Derived<T>) -> String {
    let (derivation, derive_seconds) = (&derived.mechanism.derivation, derived.derive_seconds);
    let header = ["function", "add", "mul", "div", "sqrt", "sincos", "other", "flops"].map(String::from).to_vec();
    let rows = derivation.functions.iter().map(|f| row(&f.name, f.operations).to_vec());
    let rows: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
    format!("{}, derived in {:.3} s\n\n{}", summary(derivation), derive_seconds, in_columns(&rows, 1))
}

/// Rows of cells below one another, the first ones to the left, the others to the right.
fn in_columns(rows: &[Vec<String>], to_the_left: usize) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let lines = rows.iter().map(|row| {
        let cells = row.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| match i {
            i if i < to_the_left => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ") + "\n"
    });
    lines.collect()
}

fn summary(derivation: &Derivation) -> String {
    format!("{}: {}", derivation.name, crate::words::plural(derivation.dof(), "coordinate", "coordinates"))
}

fn row(name: &str, operations: Operations) -> [String; 8] {
    let Operations { add, mul, div, sqrt, sincos, other } = operations;
    let [add, mul, div, sqrt, sincos, other, flops] =
        [add, mul, div, sqrt, sincos, other, operations.flops()].map(|count| count.to_string());
    [name.to_string(), add, mul, div, sqrt, sincos, other, flops]
}
