//! Reading states: what a mechanism is to be evaluated at, or to move from.
//!
//! ```json
//! {"t": 0, "q": [0.1, 0.2], "qd": [0, 0], "qdd": [0, 0], "u": [1.5], "params": {"m": 2.0, "length": [1, 1]},
//!  "prescribed": {}}
//! ```
//!
//! All but `q` may be left out: zero, or the declared default. Arrays are flattened in declaration order; instead of an
//! array may stand an object of names, `{"q": {"theta": 0.3}}`, or the names themselves, `{"theta": 0.3, "theta_dot":
//! 1, "push": 2}`. A parameter is given by its name, an array parameter as an array or component by component
//! (`length_0`). A number is in SI units; one with its unit is a string, `"20 deg"`. All that is wrong with a state is
//! reported at once, parameters that the mechanism cannot have included; nothing is given twice. Warnings name signals
//! that are left out, for hardly any motion that comes from outside is no motion, and plain numbers for parameters that
//! were declared in other units than those of the SI.

mod reading;

use std::fs;
use std::io;
use std::path::Path;

use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::variable::Variable;
use mbs_derive::variable::component_names;

use crate::failure::Failure;
use crate::files::Files;
use crate::message::Messages;
use crate::output;
use crate::words::{self, abridged};

pub(crate) use reading::{Point, Request, hint};
use reading::{Reading, Refusal, reading};

/// Notes the file that the argument `--state` names.
pub(crate) fn note(argument: &str, files: &mut Files) {
    match argument {
        "-" => files.reads_standard_input(),
        _ if is_json(argument) => {}
        _ => files.reads("--state", Path::new(argument)),
    }
}

fn is_json(argument: &str) -> bool {
    argument.trim_start().starts_with(['{', '['])
}

/// Reads the states that the argument `--state` stands for: a file, `-` for standard input, or JSON itself.
///
/// The signals named are given otherwise: nobody misses them.
pub(crate) fn read(argument: &str, derivation: &Derivation, given: &[String]) -> Result<Request, Failure> {
    let (name, text) = if is_json(argument) {
        ("--state".to_string(), argument.to_string())
    } else if argument == "-" {
        ("standard input".to_string(), text("standard input", io::read_to_string(io::stdin()))?)
    } else {
        (argument.to_string(), text(argument, fs::read_to_string(argument))?)
    };
    let text = text.trim_start_matches('\u{feff}');
    match reading(&name, text, derivation) {
        Ok(reading) => {
            warn(&name, &reading, derivation, given);
            Ok(reading.request)
        }
        Err(Refusal::Syntax(diagnostics)) => Err(Messages::of(&diagnostics, &Sources::new(&name, text)).into()),
        Err(Refusal::Misfit(errors)) => Err(Failure::several(&errors)),
    }
}

/// What may not have been meant.
fn warn(name: &str, Reading { request, left_out, plain }: &Reading, derivation: &Derivation, given: &[String]) {
    let names = component_names(&derivation.prescribed);
    let signals: Vec<String> =
        left_out.iter().map(|&i| names[i].clone()).filter(|name| !given.contains(name)).collect();
    if !signals.is_empty() {
        let many = matches!(request, Request::Many(_));
        output::warn(format_args!(
            "{name}: \"prescribed\" does not give {}{}: zero, at rest",
            abridged(&signals),
            if many { " in all states" } else { "" }
        ));
    }
    for &i in plain {
        let Variable { name: parameter, unit, declared_unit, .. } = &derivation.parameters[i];
        let declared = declared_unit.as_deref().unwrap_or_default();
        output::warn(format_args!(
            "{name}: \"params\".\"{parameter}\" is declared in {declared}; a plain number is in {unit}, write it with its \
             unit, \"20 {declared}\""
        ));
    }
}

fn text(name: &str, content: io::Result<String>) -> Result<String, Failure> {
    content.map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => Failure::new(format_args!("{name} is not UTF-8 text")),
        _ => Failure::new(format_args!("cannot read {name}: {error}")),
    })
}
