//! `mbs check`: is the declaration good, and can its equations be proved.

pub(crate) mod freedom;

use std::path::PathBuf;

use mbs_derive::variable::Variable;
use mbs_derive::variable::component_names;

use crate::cache::Cache;
use crate::failure::Failure;
use crate::{mechanism, output};

/// Check a mechanism: its declaration, its physical dimensions, and the proof of its equations.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
}

/// Prints one line about a mechanism that is good.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mechanism = mechanism::read(&arguments.file, cache)?;
    let derivation = &mechanism.derivation;
    let singular = match mechanism.singular_at {
        0 => String::new(),
        count => format!(", at {count} of which some motion has no inertia"),
    };
    output::print(&format!(
        "{}: {}, {}, {}, {}{}; proved at {}{singular}\n",
        derivation.name,
        counted(&derivation.coordinates, "coordinate"),
        counted(&derivation.inputs, "input"),
        counted(&derivation.parameters, "parameter"),
        plural(mechanism.bodies, "body", "bodies"),
        freedom::summary(derivation)?,
        plural(mechanism.proved_at, "state", "states"),
    ))
}

/// `2 coordinates (x, theta)`; long lists are cut.
fn counted(variables: &[Variable], what: &str) -> String {
    let count = component_names(variables).len();
    let names: Vec<String> = variables
        .iter()
        .map(|variable| {
            let lengths: String = variable.lengths().into_iter().map(|n| format!("[{n}]")).collect();
            format!("{}{lengths}", variable.name)
        })
        .collect();
    let number = plural(count, what, &format!("{what}s"));
    if names.is_empty() { number } else { format!("{number} ({})", abridged(&names)) }
}

/// At most eight names.
pub(crate) fn abridged(names: &[String]) -> String {
    match names {
        [head @ .., last] if names.len() > 8 => format!("{}, …, {last}", head[..6].join(", ")),
        _ => names.join(", "),
    }
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
