//! `mbs explain`: the page of a diagnostic.
//!
//! The pages are `pages/*.md`, a file for each group of codes; a page is what stands from one heading `## MBS0101: …`
//! to the next. Its code blocks are a wrong model and the right one, each perhaps with the files that it imports:
//! `mbs,wrong`, `mbs,right`, `csv,wrong,spring.csv`.

use mbs_derive::diagnostic::Diagnostic;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output;

/// Explain a diagnostic: what is wrong, a wrong model, the right one; without a code, list all of them.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs explain MBS0703")]
pub(crate) struct Arguments {
    /// The code in a message, as in `error[MBS0703]`; `mbs0703` and `703` will do.
    #[arg(value_name = "CODE")]
    code: Option<String>,
}

const FILES: [&str; 12] = [
    include_str!("../pages/text.md"),
    include_str!("../pages/statements.md"),
    include_str!("../pages/files.md"),
    include_str!("../pages/units.md"),
    include_str!("../pages/names.md"),
    include_str!("../pages/calls.md"),
    include_str!("../pages/values.md"),
    include_str!("../pages/energies.md"),
    include_str!("../pages/bodies.md"),
    include_str!("../pages/constraints.md"),
    include_str!("../pages/outputs.md"),
    include_str!("../pages/proof.md"),
];

/// What is said of one code.
struct Page<'a> {
    code: &'a str,
    title: &'a str,
    /// What is wrong, and why.
    text: &'a str,
    blocks: Vec<Block<'a>>,
}

/// A text of the wrong or of the right model.
struct Block<'a> {
    /// `wrong` or `right`.
    which: &'a str,
    /// Of a file that the model imports, its name.
    file: Option<&'a str>,
    text: &'a str,
}

/// Prints a page, or the list.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(asked) = &arguments.code else {
        let list = || pages().map(|page| json!({ "code": page.code, "title": page.title })).collect();
        return output::answer(list, || pages().map(|page| format!("{}  {}\n", page.code, page.title)).collect());
    };
    let wanted = in_full(asked);
    match pages().find(|page| page.code == wanted) {
        Some(page) => output::answer(|| page.object(), || page.written()),
        None => {
            let codes: Vec<String> = Diagnostic::codes().collect();
            let near = Diagnostic::nearest(&wanted, codes.iter().map(String::as_str));
            let hint = near.map_or(String::new(), |near| format!(" (did you mean {near}?)"));
            Err(Failure::new(format_args!("there is no code `{asked}`{hint}; `mbs explain` lists them")))
        }
    }
}

/// `mbs0703`, `703`, `[MBS0703]` → `MBS0703`
fn in_full(asked: &str) -> String {
    let word = asked.trim_matches(|c: char| !c.is_ascii_alphanumeric()).to_ascii_uppercase();
    match word.strip_prefix("MBS").unwrap_or(&word).parse::<u16>() {
        Ok(number) => format!("MBS{number:04}"),
        Err(_) => word,
    }
}

/// All of them, by number.
fn pages() -> impl Iterator<Item = Page<'static>> {
    FILES.into_iter().flat_map(|file| file.split("\n## ").skip(1)).filter_map(Page::read)
}

impl<'a> Page<'a> {
    fn read(section: &'a str) -> Option<Self> {
        let (heading, rest) = section.split_once('\n')?;
        let (code, title) = heading.split_once(": ")?;
        let mut parts = rest.split("```");
        let text = parts.next()?.trim();
        // Between two fences stands a block, or what separates blocks.
        let blocks = parts.step_by(2).filter_map(|block| {
            let (info, text) = block.split_once('\n')?;
            let mut info = info.split(',').skip(1);
            Some(Block { which: info.next()?, file: info.next(), text })
        });
        Some(Page { code, title, text, blocks: blocks.collect() })
    }

    fn written(&self) -> String {
        let mut text = format!("{}: {}\n\n{}\n", self.code, self.title, self.text);
        for Block { which, file, text: model } in &self.blocks {
            let name = file.map_or(String::new(), |file| format!(", {file}"));
            text += &format!("\n{which}{name}:\n\n");
            text.extend(model.lines().map(|line| format!("    {line}").trim_end().to_string() + "\n"));
        }
        text
    }

    fn object(&self) -> Value {
        let blocks = |wanted: &str| -> Value {
            let chosen = self.blocks.iter().filter(|block| block.which == wanted);
            chosen.map(|block| json!({ "file": block.file, "text": block.text })).collect()
        };
        let prose = self.text.replace('\n', " ");
        json!({
            "code": self.code, "title": self.title, "text": prose, "wrong": blocks("wrong"), "right": blocks("right"),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use mbs_derive::builder::Mechanism;
    use mbs_derive::diagnostic::Diagnostics;
    use mbs_derive::expr::Graph;
    use mbs_derive::source::Sources;
    use mbs_derive::{Analysis, Config, emit};

    use super::*;

    #[test]
    fn every_code_has_a_page_and_every_page_a_code() {
        let written: Vec<String> = pages().map(|page| page.code.to_string()).collect();
        assert_eq!(written, Diagnostic::codes().collect::<Vec<_>>());
        for Page { code, title, text, blocks } in pages() {
            assert!(title.chars().count() < 90 && !title.ends_with('.') && text.len() >= 30, "{code}");
            assert!(title.starts_with(|c: char| !c.is_ascii_uppercase()), "{code}: {title}");
            let models = ["wrong", "right"].map(|which| blocks.iter().filter(|b| b.which == which).count());
            assert_eq!(models[0] > 0, models[1] > 0, "{code}");
        }
    }

    /// The codes of all messages about a model, warnings of one that is good included.
    fn codes(folder: &Path) -> BTreeSet<String> {
        let sources = match mbs_derive::read(&folder.join("model.mbs")) {
            Ok(sources) => sources,
            Err(report) => return report.split(['[', ']']).nth(1).map(str::to_string).into_iter().collect(),
        };
        let graph = Graph::verbatim();
        match Analysis::of(&sources, &graph) {
            Ok(analysis) => match analysis.prove(analysis.programs()) {
                Ok(proof) => analysis.warnings(Some(&proof)).iter().map(Diagnostic::code).collect(),
                Err(error) => error.codes().into_iter().collect(),
            },
            Err(error) => error.codes().into_iter().collect(),
        }
    }

    /// Every wrong model earns its own code and no other, every right one is good, without a warning.
    #[test]
    fn models_of_the_pages_are_as_wrong_as_they_say() {
        let mut faults = Vec::new();
        let mut tried = 0;
        for page in pages().filter(|page| !page.blocks.is_empty()) {
            for which in ["wrong", "right"] {
                let folder = tempfile::tempdir().unwrap();
                for block in page.blocks.iter().filter(|block| block.which == which) {
                    std::fs::write(folder.path().join(block.file.unwrap_or("model.mbs")), block.text).unwrap();
                }
                let expected = if which == "wrong" { BTreeSet::from([page.code.to_string()]) } else { BTreeSet::new() };
                let found = codes(folder.path());
                if found != expected {
                    faults.push(format!("{}, {which}: {found:?}", page.code));
                }
                tried += 1;
            }
        }
        assert!(tried > 250, "{tried}");
        assert!(faults.is_empty(), "{faults:#?}");
    }

    /// What no short text on a page can show.
    #[test]
    fn codes_without_models_are_earned_otherwise() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.mbs");
        let of_bytes = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            codes(folder.path())
        };
        let cart = |kinetic: &str| format!("mechanism Cart {{ param m: kg = 1; coord x: m; kinetic += {kinetic}; }}");
        let good = cart("1/2*m*dt(x)^2");
        let deep = cart(&format!("1/2*m*{}dt(x){}^2", "(".repeat(300), ")".repeat(300)));
        let build = |config: Config| {
            std::fs::write(&path, &good).unwrap();
            let report = config.out_dir(folder.path()).try_compile(&path).unwrap_err().to_string();
            BTreeSet::from([report.split(['[', ']']).nth(1).unwrap().to_string()])
        };
        let mut data = Diagnostics::default();
        data.data(0..1, "unreadable JSON");
        let infinite = {
            let mut mechanism = Mechanism::new("Cart", "");
            let _ = mechanism.param("m", "kg", f64::INFINITY);
            Analysis::written(&mechanism, &Graph::verbatim(), &[]).err().unwrap().codes()
        };
        let earned = [
            ("MBS0101", of_bytes(b"mechanism Caf\xe9 {}")),
            ("MBS0102", of_bytes(b"mechanism Cart {\r// the mass\rparam m: kg = 1; }\r")),
            ("MBS0103", of_bytes(&b"; ".repeat(1_000_001))),
            ("MBS0106", of_bytes(deep.as_bytes())),
            ("MBS0308", build(Config::new().freeze(["mass"]))),
            ("MBS0309", build(Config::new().functions(["multipliers"]))),
            ("MBS0310", data.iter().map(Diagnostic::code).collect()),
            ("MBS0419", infinite.into_iter().collect()),
        ];
        for (code, found) in &earned {
            assert!(found.contains(*code), "{code}: {found:?}");
        }
        // A disagreement is a mistake of the generator: there is no text for it.
        let shown: BTreeSet<String> =
            earned.iter().map(|(code, _)| code.to_string()).chain(["MBS1205", "MBS1206"].map(String::from)).collect();
        let without: BTreeSet<String> =
            pages().filter(|page| page.blocks.is_empty()).map(|page| page.code.to_string()).collect();
        assert_eq!(shown, without);
        let sources = Sources::new("cart.mbs", &good);
        assert!(Analysis::of(&sources, &Graph::verbatim()).unwrap().rust(&emit::Options::default()).is_ok());
    }

    #[test]
    fn codes_are_found_however_they_are_written() {
        for asked in ["MBS0703", "mbs0703", "703", "0703", "[MBS0703]", "error[MBS0703]"] {
            let wanted = in_full(asked.trim_start_matches("error"));
            assert_eq!(wanted, "MBS0703", "{asked}");
        }
        assert_eq!(in_full("nothing"), "NOTHING");
    }
}
