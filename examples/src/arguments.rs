//! `[--json] [--out DIR]`, and numbers and words that an example may ask for

use std::collections::BTreeMap;
use std::path::PathBuf;

/// The arguments that every example takes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arguments {
    /// Print one JSON object instead of a summary.
    pub json: bool,
    /// Where figures and tables go; none are written without.
    pub out: Option<PathBuf>,
    /// Numbers that the example asks for, by their names.
    pub numbers: BTreeMap<&'static str, usize>,
    /// Words that the example asks for, by their names.
    pub words: BTreeMap<&'static str, String>,
}

impl Arguments {
    /// Those of this process; wrong ones end it with exit code 2.
    #[must_use]
    pub fn from_process() -> Self {
        Self::with_numbers(&[])
    }

    /// The same, for an example with options that are followed by a positive whole number.
    #[must_use]
    pub fn with_numbers(names: &[&'static str]) -> Self {
        Self::parse(std::env::args().skip(1), names, &[]).unwrap_or_else(|wrong| {
            let numbers: String = names.iter().map(|name| format!(" [{name} N]")).collect();
            refuse(&wrong, &numbers)
        })
    }

    /// The same, for an example with options that are followed by a word, given as name and what the usage says of the
    /// word.
    #[must_use]
    pub fn with_words(options: &[(&'static str, &str)]) -> Self {
        let names: Vec<&'static str> = options.iter().map(|option| option.0).collect();
        Self::parse(std::env::args().skip(1), &[], &names).unwrap_or_else(|wrong| Self::refuse(&wrong, options))
    }

    /// Ends the process with exit code 2 because of a word that means nothing.
    pub fn refuse(wrong: &str, options: &[(&'static str, &str)]) -> ! {
        let words: String = options.iter().map(|(name, word)| format!(" [{name} {word}]")).collect();
        refuse(wrong, &words)
    }

    fn parse(
        mut arguments: impl Iterator<Item = String>,
        names: &[&'static str],
        words: &[&'static str],
    ) -> Result<Self, String> {
        let mut parsed = Self::default();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--json" => parsed.json = true,
                "--out" => parsed.out = Some(arguments.next().ok_or("--out needs a folder")?.into()),
                _ => {
                    if let Some(name) = words.iter().find(|&&name| name == argument) {
                        let word = arguments.next().ok_or_else(|| format!("{name} needs a word"))?;
                        parsed.words.insert(name, word);
                        continue;
                    }
                    let name = names.iter().find(|&&name| name == argument);
                    let name = name.ok_or_else(|| format!("unexpected argument {argument}"))?;
                    let number = arguments.next().and_then(|text| text.parse().ok()).filter(|&n| n > 0);
                    parsed.numbers.insert(name, number.ok_or_else(|| format!("{name} needs a positive whole number"))?);
                }
            }
        }
        Ok(parsed)
    }
}

fn refuse(wrong: &str, options: &str) -> ! {
    eprintln!("error: {wrong}\nusage: [--json] [--out DIR]{options}");
    std::process::exit(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_in_any_order() {
        let parse =
            |text: &str| Arguments::parse(text.split_whitespace().map(String::from), &["--members"], &["--case"]);
        assert_eq!(parse(""), Ok(Arguments::default()));
        assert_eq!(
            parse("--out a/b --json"),
            Ok(Arguments { json: true, out: Some("a/b".into()), ..Arguments::default() })
        );
        assert_eq!(parse("--out"), Err("--out needs a folder".to_string()));
        assert_eq!(parse("--members 12").map(|parsed| parsed.numbers["--members"]), Ok(12));
        assert_eq!(parse("--members 0"), Err("--members needs a positive whole number".to_string()));
        assert_eq!(parse("--case II --json").map(|parsed| parsed.words["--case"].clone()), Ok("II".to_string()));
        assert_eq!(parse("--case"), Err("--case needs a word".to_string()));
        assert_eq!(parse("--fast"), Err("unexpected argument --fast".to_string()));
    }
}
