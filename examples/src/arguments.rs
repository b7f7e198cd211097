//! `[--json] [--out DIR]`, and what an example asks for besides; `--help` is what stands on top of its source.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{CommandFactory, FromArgMatches, Parser};
use serde_json::Value;

use crate::{Failure, assumed, output};

/// The arguments that every example takes, and options of its own.
#[derive(Clone, Debug, Parser)]
pub struct Arguments<O: clap::Args = ()> {
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    pub json: bool,
    /// Where figures and tables go; none are written without.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The options of this example.
    #[command(flatten)]
    pub options: O,
}

impl Arguments {
    /// Those of this process, for an example with this source; wrong ones end it with exit code 2.
    #[must_use]
    pub fn of(source: &str) -> Self {
        Self::with_options(source)
    }
}

impl<O: clap::Args> Arguments<O> {
    /// Those of this process, for an example with this source and own options; wrong ones end it with exit code 2.
    #[must_use]
    pub fn with_options(source: &str) -> Self {
        let command = described(Self::command(), source);
        Self::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit())
    }

    /// The folder of `--out`, made with those that it lies in.
    ///
    /// # Errors
    /// What the file system refuses, with the folder's name.
    pub fn folder(&self) -> Result<Option<&Path>, Failure> {
        self.out.as_deref().map(|folder| output::create_folder(folder).map(|()| folder)).transpose()
    }

    /// Prints one JSON object or a summary, with what the numbers rest on: rows of `docs/thesis/assumed.md`, none where
    /// everything is known.
    pub fn answer(&self, results: Value, summary: &str, keys: &[&str]) {
        match (self.json, keys) {
            (true, []) => crate::println!("{results}"),
            (true, keys) => crate::println!("{}", assumed::with(results, keys)),
            (false, []) => crate::print!("{summary}"),
            (false, keys) => crate::print!("{summary}{}", assumed::text(keys)),
        }
    }
}

/// A parser for an option that takes one of these names, and gives the value of the name.
pub fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    values: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(values.each_ref().map(|(name, _)| *name)).map(move |name| {
        let found = values.iter().find(|(own, _)| *own == name);
        found.map(|(_, value)| value.clone()).expect("one of the possible values")
    })
}

/// With the documentation of a source as the description.
fn described(command: clap::Command, source: &str) -> clap::Command {
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    let text: Vec<&str> = lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    command.about(text.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, clap::Args)]
    struct Options {
        #[arg(long)]
        case: Option<String>,
    }

    #[test]
    fn arguments_in_any_order() {
        let parse = |text: &str| Arguments::<Options>::try_parse_from(["example"].into_iter().chain(text.split(' ')));
        let parsed = parse("--out a/b --json --case II").unwrap();
        assert_eq!((parsed.json, parsed.out, parsed.options.case.as_deref()), (true, Some("a/b".into()), Some("II")));
        for wrong in ["--out", "--case", "--fast"] {
            assert_eq!(parse(wrong).unwrap_err().exit_code(), 2, "{wrong}");
        }
    }

    #[test]
    fn the_help_is_what_stands_on_top_of_the_source() {
        let help =
            described(Arguments::<()>::command(), "//! How far?\n//!\n//! Look.\n\nuse std::fmt;\n").render_help();
        assert!(help.to_string().starts_with("How far?\n\nLook.\n"), "{help}");
    }
}
