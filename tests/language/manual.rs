//! The manual `docs/language.md`: every mechanism in it is generated and proved, with what it imports.

use mbs_derive::Analysis;
use mbs_derive::emit::Options;
use mbs_derive::expr::Graph;
use mbs_derive::source::{Sources, Unreadable};

const MANUAL: &str = include_str!("../../docs/language.md");

/// The blocks fenced as `mbs`: the name that the fence gives, or the line that each begins on; and its text.
fn blocks() -> Vec<(Result<&'static str, usize>, String)> {
    let (mut found, mut open) = (Vec::new(), None);
    for (number, line) in (1..).zip(MANUAL.lines()) {
        match (&mut open, line) {
            (None, "```mbs") => open = Some((Err(number + 1), String::new())),
            (None, line) => open = line.strip_prefix("```mbs ").map(|name| (Ok(name), String::new())),
            (Some(_), "```") => found.extend(open.take()),
            (Some((_, text)), line) => {
                text.push_str(line);
                text.push('\n');
            }
        }
    }
    assert!(open.is_none(), "a block of the manual is not closed");
    found
}

/// A file of the manual, whose fence names it.
fn read(name: &str) -> Result<Vec<u8>, Unreadable> {
    let block = blocks().into_iter().find(|(title, _)| *title == Ok(name));
    block.map(|(_, text)| text.into_bytes()).ok_or_else(|| Unreadable::new("the manual has no such block", ""))
}

#[test]
fn every_mechanism_of_the_manual_is_generated_without_a_warning() {
    let mechanisms = blocks().into_iter().filter_map(|(title, source)| Some((title.err()?, source)));
    let (mut reports, mut count) = (String::new(), 0);
    for (line, source) in mechanisms {
        let sources = Sources::gather(&format!("language.md, block from line {line}"), &source, read);
        let graph = Graph::verbatim();
        match Analysis::of(&sources, &graph).and_then(|analysis| analysis.rust(&Options::default())) {
            Ok(generated) => reports += &generated.warnings,
            Err(error) => reports += &error.render_in(&sources),
        }
        count += 1;
    }
    assert!(count >= 10, "{count} mechanisms found in the manual");
    assert!(reports.is_empty(), "{reports}");
}

/// The blocks fenced as `text` that are statements: parts of mechanisms, which are read as they stand.
#[test]
fn every_statement_of_the_manual_can_be_read() {
    let fragments =
        MANUAL.split("\n```text\n").skip(1).filter_map(|rest| rest.split_once("\n```").map(|(text, _)| text));
    let of_statements = fragments.filter(|text| text.lines().all(|line| line.split("//").next().is_some_and(ends)));
    let mut count = 0;
    for text in of_statements {
        let source = format!("mechanism Fragment {{\n{text}\n}}");
        if let Err(errors) = mbs_derive::parse::declaration_of(&Sources::new("language.md", &source)) {
            panic!("{}", errors.render("language.md", &source));
        }
        count += 1;
    }
    assert!(count >= 3, "{count} blocks of statements found in the manual");
}

/// Whether a line of code is a statement.
fn ends(code: &str) -> bool {
    code.trim_end().ends_with(';')
}
