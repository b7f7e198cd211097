//! `mbs fmt`: files in one style.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use mbs_derive::source::Sources;
use serde_json::json;

use crate::failure::Failure;
use crate::message::Messages;
use crate::output::{self, Staged};

/// Write mechanisms, and files that they import, in one style: indentation, spaces, blank lines. Comments stay.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs fmt pendulum.mbs")]
pub(crate) struct Arguments {
    /// The files, which are replaced whole or not at all; `-` reads standard input and writes standard output.
    #[arg(value_name = "FILE.mbs", required = true)]
    files: Vec<PathBuf>,
    /// Write nothing: name the files that are not in the style, and end with exit code 1 if there are any.
    #[arg(long)]
    check: bool,
}

/// Formats each file by itself: one that cannot be read is reported and left alone, the others are formatted.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut reports = Messages::default();
    let mut replaced: Vec<&Path> = Vec::new();
    for path in &arguments.files {
        match formatted(path) {
            Ok(text) if arguments.check => {
                if text.is_changed {
                    let message = format_args!("{} is not formatted; `mbs fmt` does it", text.name);
                    reports.append(Failure::new(message).messages());
                }
            }
            Ok(text) => {
                let written = match path == Path::new("-") {
                    true => output::answer(|| json!({ "text": text.formatted }), || text.formatted.clone()),
                    false if text.is_changed => write(path, &text.formatted),
                    false => Ok(()),
                };
                match written {
                    Ok(()) if text.is_changed && path != Path::new("-") => replaced.push(path),
                    Ok(()) => {}
                    Err(failure) => reports.append(failure.messages()),
                }
            }
            Err(failure) => reports.append(failure.messages()),
        }
    }
    if !arguments.check && arguments.files.iter().any(|path| path != Path::new("-")) {
        output::wrote(&replaced)?;
    }
    if reports.is_empty() { Ok(()) } else { Err(reports.into()) }
}

struct Text {
    name: String,
    formatted: String,
    is_changed: bool,
}

fn formatted(path: &Path) -> Result<Text, Failure> {
    let is_standard_input = path == Path::new("-");
    let name = if is_standard_input { "standard input".to_string() } else { path.display().to_string() };
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")) {
        return Err(Failure::new(format_args!("{name} is a table; files of the model language are formatted")));
    }
    let mut bytes = Vec::new();
    let read = if is_standard_input { io::stdin().lock().read_to_end(&mut bytes) } else { read(path, &mut bytes) };
    read.map_err(|error| Failure::new(format_args!("cannot read {name}: {error}")))?;
    let text = mbs_derive::parse::text(&name, bytes).map_err(|report| Failure::from(Messages::of_file(report)))?;
    let sources = Sources::new(&name, &text);
    let formatted = sources.formatted().map_err(|errors| Failure::from(Messages::of(&errors, &sources)))?;
    if !says_the_same(&text, &formatted) {
        return Err(Failure::new(format_args!(
            "{name} is left alone: a bug of `mbs fmt` would have changed what it says"
        )));
    }
    Ok(Text { is_changed: formatted != text, name, formatted })
}

fn read(path: &Path, bytes: &mut Vec<u8>) -> io::Result<usize> {
    *bytes = fs::read(path)?;
    Ok(bytes.len())
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    Staged::new(path, text.as_bytes())?.commit()
}

/// Whether both are made of the same words, numbers and signs: the last look before a file is replaced.
fn says_the_same(before: &str, after: &str) -> bool {
    let tokens = |text: &str| -> Vec<String> {
        let spans = Sources::new("", text).tokens().0.into_iter();
        spans.map(|span| text[span].lines().map(str::trim_end).collect::<Vec<_>>().join("\n")).collect()
    };
    tokens(before) == tokens(after)
}
