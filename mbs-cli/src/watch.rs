//! `mbs watch`: checks a mechanism again whenever its text, or one that it imports, changes.
//!
//! Texts are read again a few times a second and compared: nothing else tells of changes on every system, in network
//! folders, and through editors that write a new file in place of the old one; and it needs no further crate.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use mbs_derive::source::Sources;

use crate::cache::Cache;
use crate::check::{self, Freedom};
use crate::failure::Failure;
use crate::message::Messages;
use crate::{mechanism, output};

/// Check a mechanism whenever its text, or one that it imports, changes; until interrupted.
///
/// Each time it prints the line of `mbs check`, or with --json its object, in one line. What is wrong goes to standard
/// error, and watching goes on.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs watch pendulum.mbs")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// Check once and end, with the exit code of `mbs check`.
    #[arg(long)]
    once: bool,
    /// Look for changes this often.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 200, value_parser = clap::value_parser!(u64).range(10..=60_000))]
    every: u64,
}

/// Checks, and checks again.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut seen = read(arguments);
    loop {
        let outcome = checked(&seen, cache);
        if arguments.once {
            return outcome;
        }
        if let Err(failure) = outcome {
            output::report(failure.messages());
        }
        seen = changed(arguments, seen);
    }
}

/// Waits for other texts, and until they stay as they are: an editor may not have written all of them yet.
fn changed(arguments: &Arguments, seen: Result<Sources, String>) -> Result<Sources, String> {
    let mut last = seen.clone();
    loop {
        thread::sleep(Duration::from_millis(arguments.every));
        let now = read(arguments);
        if now == last && now != seen {
            return now;
        }
        last = now;
    }
}

/// The texts, or the report on a file that cannot be read.
fn read(arguments: &Arguments) -> Result<Sources, String> {
    mbs_derive::read(&arguments.file)
}

fn checked(sources: &Result<Sources, String>, cache: &Cache) -> Result<(), Failure> {
    let sources = sources.as_ref().map_err(|report| Failure::from(Messages::of_file(report.clone())))?;
    let mechanism = mechanism::proved(sources, cache)?;
    let freedom = Freedom::of(&mechanism.derivation)?;
    let object = || check::object(&mechanism, &freedom);
    output::print(&if output::is_json() { format!("{}\n", object()) } else { check::summary(&mechanism, &freedom) })
}
