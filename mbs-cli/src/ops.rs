//! `mbs ops`: what one call of each function costs.

use std::path::PathBuf;

use mbs_derive::optimise::{Derivation, Operations};
use serde_json::{Map, Value, json};

use crate::failure::Failure;
use crate::mechanism::{self, Mechanism};
use crate::output;

/// Count the operations of every generated function.
///
/// Subtractions count as additions, negations are free, a sine and cosine of one angle are one `sincos`; `flops` is add +
/// mul. Of the mass matrix the lower triangle is computed. What depends on parameters alone is computed once, when the
/// mechanism is made, and not counted.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Prints the operation counts.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mechanism = mechanism::read(&arguments.file)?;
    output::print(&if arguments.json { output::json(&object(&mechanism)) } else { table(&mechanism) })
}

fn object(mechanism: &Mechanism) -> Value {
    let Mechanism { derivation, derive_seconds, .. } = mechanism;
    let functions: Map<String, Value> =
        derivation.functions.iter().map(|f| (f.name.clone(), counts(f.operations))).collect();
    json!({ "mechanism": derivation.name, "derive_seconds": derive_seconds, "functions": functions })
}

/// One function's counts.
pub(crate) fn counts(operations: Operations) -> Value {
    let Operations { add, mul, div, sqrt, sincos, other } = operations;
    json!({
        "add": add, "mul": mul, "div": div, "sqrt": sqrt, "sincos": sincos, "other": other,
        "flops": operations.flops(),
    })
}

fn table(mechanism: &Mechanism) -> String {
    let Mechanism { derivation, derive_seconds, .. } = mechanism;
    let mut rows = vec![["function", "add", "mul", "div", "sqrt", "sincos", "other", "flops"].map(String::from)];
    rows.extend(derivation.functions.iter().map(|f| row(&f.name, f.operations)));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let lines = rows.iter().map(|row| {
        let cells = row.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| match i {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ") + "\n"
    });
    format!("{}, derived in {:.3} s\n\n{}", summary(derivation), derive_seconds, lines.collect::<String>())
}

fn summary(derivation: &Derivation) -> String {
    format!("{}: {}", derivation.name, crate::check::plural(derivation.dof(), "coordinate", "coordinates"))
}

fn row(name: &str, operations: Operations) -> [String; 8] {
    let Operations { add, mul, div, sqrt, sincos, other } = operations;
    let [add, mul, div, sqrt, sincos, other, flops] =
        [add, mul, div, sqrt, sincos, other, operations.flops()].map(|count| count.to_string());
    [name.to_string(), add, mul, div, sqrt, sincos, other, flops]
}
