//! The manual `docs/language.md`: every mechanism in it is generated and proved.

use mbs_derive::emit::Options;

const MANUAL: &str = include_str!("../docs/language.md");

/// The blocks fenced as `mbs`: the line that each begins on, and its text.
fn mechanisms() -> Vec<(usize, String)> {
    let (mut found, mut open) = (Vec::new(), None);
    for (number, line) in (1..).zip(MANUAL.lines()) {
        match (&mut open, line) {
            (None, "```mbs") => open = Some((number + 1, String::new())),
            (Some(_), "```") => found.extend(open.take()),
            (Some((_, text)), line) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, _) => {}
        }
    }
    assert!(open.is_none(), "a block of the manual is not closed");
    found
}

#[test]
fn every_mechanism_of_the_manual_is_generated_without_a_warning() {
    let mechanisms = mechanisms();
    assert!(mechanisms.len() >= 10, "{} mechanisms found in the manual", mechanisms.len());
    let mut reports = String::new();
    for (line, source) in mechanisms {
        let name = format!("language.md, block from line {line}");
        match mbs_derive::generate(&name, &source, &Options::default()) {
            Ok(generated) => reports += &generated.warnings,
            Err(error) => reports += &error.render(&name, &source),
        }
    }
    assert!(reports.is_empty(), "{reports}");
}
