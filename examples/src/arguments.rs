//! `[--json] [--out DIR]`

use std::path::PathBuf;

/// What every example is told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arguments {
    /// Print one JSON object instead of a summary.
    pub json: bool,
    /// Where figures and tables go; none are written without.
    pub out: Option<PathBuf>,
}

impl Arguments {
    /// Those of this process; wrong ones end it with exit code 2.
    #[must_use]
    pub fn from_process() -> Self {
        Self::parse(std::env::args().skip(1)).unwrap_or_else(|wrong| {
            eprintln!("error: {wrong}\nusage: [--json] [--out DIR]");
            std::process::exit(2)
        })
    }

    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut parsed = Self::default();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--json" => parsed.json = true,
                "--out" => parsed.out = Some(arguments.next().ok_or("--out needs a folder")?.into()),
                _ => return Err(format!("unexpected argument {argument}")),
            }
        }
        Ok(parsed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_in_any_order() {
        let parse = |text: &str| Arguments::parse(text.split_whitespace().map(String::from));
        assert_eq!(parse(""), Ok(Arguments::default()));
        assert_eq!(parse("--out a/b --json"), Ok(Arguments { json: true, out: Some("a/b".into()) }));
        assert_eq!(parse("--out"), Err("--out needs a folder".to_string()));
        assert_eq!(parse("--fast"), Err("unexpected argument --fast".to_string()));
    }
}
