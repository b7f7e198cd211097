//! `mbs check`: is the declaration good, and can its equations be proved.

pub(crate) mod freedom;
mod proof;

use std::path::PathBuf;

use mbs_derive::variable::Variable;
use mbs_derive::variable::component_names;
use serde_json::{Value, json};

pub(crate) use freedom::Freedom;
pub(crate) use proof::Evidence;

use crate::cache::Cache;
use crate::failure::Failure;
use crate::mechanism::Mechanism;
use crate::state::{self, Request};
use crate::words::{abridged, plural};
use crate::{mechanism, output};

/// Check a mechanism: its declaration, its physical dimensions, and the proof of its equations.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs check pendulum.mbs")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,

    /// Count the degrees of freedom as the mechanism is assembled at this state, or nearest to it; a file, `-` for
    /// standard input, or JSON itself, as of `mbs eval`. Constraints may leave more motions at some states than at
    /// others.
    #[arg(long, value_name = "STATE.json")]
    state: Option<String>,

    /// Show the points, the fields and the degrees of the proof, and each claim that is proved in doubles alone.
    #[arg(long)]
    verbose: bool,
}

/// Prints one line about a mechanism that is good.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mechanism = mechanism::read(&arguments.file, cache)?;
    let freedom = freedom(arguments, &mechanism)?;
    let details = || if arguments.verbose { mechanism.evidence.details() } else { String::new() };
    output::answer(|| object(&mechanism, &freedom), || summary(&mechanism, &freedom) + &details())
}

fn freedom(arguments: &Arguments, mechanism: &Mechanism) -> Result<Freedom, Failure> {
    let derivation = &mechanism.derivation;
    let Some(state) = &arguments.state else { return Freedom::of(derivation) };
    let points = match state::read(state, derivation, &[])? {
        Request::One(point) => vec![point],
        Request::Many(points) if points.is_empty() => {
            return Err(Failure::new("the array of --state has no state: give one, or leave it out"));
        }
        Request::Many(points) => points,
    };
    if derivation.constraints.is_empty() {
        output::warn(format_args!("{} has no constraints, --state does nothing", derivation.name));
        return Freedom::of(derivation);
    }
    Freedom::at(derivation, &points)
}

/// What a mechanism is, in numbers and names.
pub(crate) fn object(mechanism: &Mechanism, freedom: &Freedom) -> Value {
    let derivation = &mechanism.derivation;
    let names = |variables: &[Variable]| -> Value { component_names(variables).into() };
    json!({
        "mechanism": derivation.name,
        "coordinates": names(&derivation.coordinates),
        "inputs": names(&derivation.inputs),
        "prescribed": names(&derivation.prescribed),
        "parameters": names(&derivation.parameters),
        "bodies": mechanism.bodies,
        "constraint_rows": freedom.rows,
        "degrees_of_freedom": freedom.count(),
        "degrees_of_freedom_found": freedom.counts(),
        "proved_at": mechanism.proved_at,
        "singular_at": mechanism.singular_at,
        "proof": mechanism.evidence.object(),
    })
}

/// What a mechanism is, in a line.
pub(crate) fn summary(mechanism: &Mechanism, freedom: &Freedom) -> String {
    let derivation = &mechanism.derivation;
    let singular = match mechanism.singular_at {
        0 => String::new(),
        count => format!(", at {count} of which some motion has no inertia"),
    };
    format!(
        "{}: {}, {}, {}, {}{}; proved at {}{singular}; {}\n",
        derivation.name,
        counted(&derivation.coordinates, "coordinate"),
        counted(&derivation.inputs, "input"),
        counted(&derivation.parameters, "parameter"),
        plural(mechanism.bodies, "body", "bodies"),
        freedom.summary(),
        plural(mechanism.proved_at, "state", "states"),
        mechanism.evidence.summary(),
    )
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
