//! What is wrong with a declaration, where, and what to write instead.
//!
//! A pass collects its errors in a [`Diagnostics`] and stops at its end if there are any. Each has a code, which `mbs
//! explain` has a page for:
//!
//! ```
//! let source = "mechanism Arm { param length = 1.0; }";
//! let error = mbs_derive::generate("arm.mbs", source, &Default::default()).unwrap_err();
//! assert_eq!(error.render("arm.mbs", source), "\
//! error[MBS0401]: `param length` needs a unit
//!  --> arm.mbs:1:17
//!   |
//! 1 | mechanism Arm { param length = 1.0; }
//!   |                 ^^^^^^^^^^^^
//!   = help: write `param length: m = …;`, `1` for a pure number
//! ");
//! ```

mod code;
mod excerpt;
mod nearest;
mod replacement;

use std::fmt;

use crate::source::{Sources, is_written_robot};
use crate::span::Span;

pub(crate) use code::Code;
use excerpt::{Excerpt, excerpt};
pub(crate) use nearest::nearest;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The declaration is refused.
    Error,
    /// The declaration is taken, but probably not meant so.
    Warning,
}

/// One message about one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Its cause.
    code: Code,
    /// What is wrong, lower case, no full stop.
    pub message: String,
    /// The text that it is about.
    pub span: Span,
    /// What to write instead.
    pub help: Option<String>,
    /// Other places that it is about.
    pub notes: Vec<Note>,
}

/// Another place that a message is about.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// The place.
    pub span: Span,
    /// What it has to do with it.
    pub message: String,
}

impl Diagnostic {
    /// The candidate that `name` was probably meant to be, if any is close: case aside, at most one slip in three
    /// letters.
    ///
    /// A slip is a letter too many, one missing, one wrong, or two neighbours exchanged. The first of equally close
    /// candidates is taken.
    ///
    /// ```
    /// # use mbs_derive::diagnostic::Diagnostic;
    /// assert_eq!(Diagnostic::nearest("lenght", ["mass", "length"]), Some("length"));
    /// assert_eq!(Diagnostic::nearest("theta", ["mass", "length"]), None);
    /// ```
    pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
        nearest(name, candidates)
    }

    /// Its cause, as `mbs explain` knows it: `MBS0401`.
    ///
    /// ```
    /// let graph = mbs_derive::expr::Graph::verbatim();
    /// let errors = mbs_derive::declared("mechanism Arm { param length = 1.0; }", &graph, &[]).unwrap_err();
    /// assert_eq!(errors.iter().next().unwrap().code(), "MBS0401");
    /// ```
    pub fn code(&self) -> String {
        self.code.to_string()
    }

    /// All codes that there are, by number.
    pub fn codes() -> impl Iterator<Item = String> {
        Code::ALL.iter().map(Code::to_string)
    }

    /// Adds what to write instead.
    pub fn help(&mut self, help: impl Into<String>) -> &mut Self {
        self.help = Some(help.into());
        self
    }

    /// Adds another place that it is about.
    pub fn note(&mut self, span: Span, message: impl Into<String>) -> &mut Self {
        self.notes.push(Note { span, message: message.into() });
        self
    }
}

/// The messages of a pass, in source order.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Ball { coord x: m; kinetic += y; }";
/// let errors = mbs_derive::declared(text, &graph, &[]).unwrap_err();
/// let first = errors.iter().next().unwrap();
/// assert_eq!(&text[first.span.clone()], "y");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Sorted by where they begin; of two at one place the one found first comes first.
    messages: Vec<Diagnostic>,
    /// How many messages were errors, those that are not kept among them.
    errors: usize,
    /// The last message beyond those that are kept.
    omitted: Option<Box<Diagnostic>>,
}

impl Diagnostics {
    /// How many messages a report shows before it says "… and N more".
    const SHOWN: usize = 20;
    /// How many messages are kept: a file of garbage has one for each character.
    const KEPT: usize = 1000;

    /// Notes an error and returns it, so that a help can be added.
    pub(crate) fn error(&mut self, code: Code, span: Span, message: impl Into<String>) -> &mut Diagnostic {
        self.insert(Severity::Error, code, span, message.into())
    }

    /// Notes an error in data that are given beside a mechanism, such as a state, and returns it, so that a help can be
    /// added.
    ///
    /// ```
    /// # use mbs_derive::diagnostic::Diagnostics;
    /// let mut errors = Diagnostics::default();
    /// errors.data(1..2, "unreadable JSON: expected a key");
    /// assert!(errors.render("state.json", "{q}").starts_with("error[MBS0310]: unreadable JSON"));
    /// ```
    pub fn data(&mut self, span: Span, message: impl Into<String>) -> &mut Diagnostic {
        self.error(Code::Data, span, message)
    }

    /// Notes a warning and returns it, so that a help can be added.
    pub(crate) fn warning(&mut self, code: Code, span: Span, message: impl Into<String>) -> &mut Diagnostic {
        self.insert(Severity::Warning, code, span, message.into())
    }

    fn insert(&mut self, severity: Severity, code: Code, span: Span, message: String) -> &mut Diagnostic {
        let place = self.messages.partition_point(|m| m.span.start <= span.start);
        let message = Diagnostic { severity, code, message, span, help: None, notes: Vec::new() };
        let failed = self.has_errors();
        self.errors += usize::from(severity == Severity::Error);
        if self.messages.len() >= Self::KEPT && (failed || severity == Severity::Warning) {
            return self.omitted.insert(Box::new(message));
        }
        self.messages.insert(place, message);
        &mut self.messages[place]
    }

    /// Whether it has failed with as many messages as are kept: nobody reads on.
    pub fn is_full(&self) -> bool {
        self.has_errors() && self.messages.len() >= Self::KEPT
    }

    /// Adds a place to the messages about `span` that do not show it yet.
    pub fn note(&mut self, span: &Span, place: &Span, message: &str) {
        for found in self.messages.iter_mut().filter(|m| m.span == *span) {
            if found.notes.iter().all(|note| note.span != *place) {
                found.note(place.clone(), message);
            }
        }
    }

    /// Whether any message is an error.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// How many messages are errors.
    pub fn error_count(&self) -> usize {
        self.errors
    }

    /// Keeps the messages that are to be seen, and forgets the others.
    ///
    /// ```
    /// # use mbs_derive::diagnostic::Diagnostics;
    /// let mut errors = Diagnostics::default();
    /// errors.data(1..2, "one");
    /// errors.data(5..6, "two");
    /// errors.retain(|message| message.span.start > 3);
    /// assert_eq!((errors.error_count(), errors.iter().next().unwrap().message.as_str()), (1, "two"));
    /// ```
    pub fn retain(&mut self, keep: impl Fn(&Diagnostic) -> bool) {
        let forgotten = self.messages.iter().filter(|m| m.severity == Severity::Error && !keep(m)).count();
        self.errors -= forgotten;
        self.messages.retain(keep);
    }

    /// A pass's last line: `value` where nothing was wrong with it, else the messages.
    pub fn finish<T>(self, value: T) -> Result<T, Self> {
        if self.has_errors() { Err(self) } else { Ok(value) }
    }

    /// The messages in source order.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.messages.iter()
    }

    /// Takes the messages of another pass, or about another file.
    pub fn append(&mut self, other: Diagnostics) {
        for Diagnostic { severity, code, message, span, help, notes } in other.messages {
            let taken = self.insert(severity, code, span, message);
            (taken.help, taken.notes) = (help, notes);
        }
    }

    /// Moves all places to one.
    pub(crate) fn at(mut self, place: &Span) -> Self {
        for message in &mut self.messages {
            message.span = place.clone();
            message.notes.clear();
        }
        self
    }

    /// Moves all places to where their text stands among others.
    pub(crate) fn shift(&mut self, start: usize) {
        for message in &mut self.messages {
            let notes = message.notes.iter_mut().map(|note| &mut note.span);
            for span in notes.chain([&mut message.span]) {
                *span = span.start + start..span.end + start;
            }
        }
    }

    /// The report as a person reads it: every message with its place and the line of `source` that it is about. For a
    /// mechanism that imports nothing; else see [`render_in`](Self::render_in).
    pub fn render(&self, file_name: &str, source: &str) -> String {
        if self.messages.is_empty() { String::new() } else { self.render_in(&Sources::new(file_name, source)) }
    }

    /// The report as a person reads it: every message with its file, its place and the line that it is about. Where
    /// there are too many to show, errors go before warnings.
    pub fn render_in(&self, sources: &Sources) -> String {
        let mut shown: Vec<&Diagnostic> = self.messages.iter().collect();
        shown.sort_by_key(|message| message.severity);
        shown.truncate(Self::SHOWN);
        shown.sort_by_key(|message| message.span.start);
        let mut blocks: Vec<String> = shown.iter().map(|m| block(m, sources)).collect();
        if self.messages.len() > Self::SHOWN {
            let more = self.messages.len() - Self::SHOWN;
            let at_least = if self.messages.len() >= Self::KEPT { "at least " } else { "" };
            blocks.push(format!("… and {at_least}{more} more\n"));
        }
        blocks.join("\n")
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        })
    }
}

/// One line without a place: `error[MBS0401]: …; help: …`. [`Diagnostics::render`] shows the place.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]: {}", self.severity, self.code, self.message)?;
        match &self.help {
            Some(help) => write!(f, "; help: {help}"),
            None => Ok(()),
        }
    }
}

/// One line a message, without places: for where the source is no longer at hand.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, message) in self.messages.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{message}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

fn block(message: &Diagnostic, sources: &Sources) -> String {
    let title = format!("{}[{}]: {}", message.severity, message.code, abridged(&message.message));
    let (mut block, gutter) = marked(&title, &message.span, sources);
    if let Some(help) = &message.help {
        block += &format!("{gutter} = help: {}\n", abridged(help).replace('\n', &format!("\n{gutter}         ")));
    }
    for note in &message.notes {
        block += &marked(&format!("note: {}", note.message), &note.span, sources).0;
    }
    block
}

/// Without the rest of a message that quotes a name of a thousand letters.
fn abridged(text: &str) -> String {
    const LONGEST: usize = 600;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// The title, and the line of a place with the place underlined; how far the bars are indented.
fn marked(title: &str, span: &Span, sources: &Sources) -> (String, String) {
    if let Some(call) = sources.call(span) {
        return (format!("{title}\n --> {call}\n"), " ".to_string());
    }
    let (file_name, source, span) = sources.locate(span);
    let Excerpt { line, column, text, indent, width } = excerpt(source, &span);
    let (number, gutter) = (line.to_string(), " ".repeat(line.to_string().len()));
    let underline = format!("{}{}", " ".repeat(indent), "^".repeat(width));
    // The text of a robot that is imported is what `mbs import` prints.
    let file = match is_written_robot(file_name, source) {
        true => format!("`mbs import {file_name}`"),
        false => file_name.to_string(),
    };
    let mut block = format!("{title}\n{gutter}--> {file}:{line}:{column}\n{gutter} |\n");
    block += format!("{number} | {text}").trim_end();
    block += &format!("\n{gutter} | {underline}\n");
    (block, gutter)
}

#[cfg(test)]
mod tests {
    use super::excerpt::WIDTH;
    use super::*;

    fn rendered(source: &str, span: Span) -> String {
        let mut errors = Diagnostics::default();
        errors.error(Code::Unexpected, span, "wrong");
        errors.render("a.mbs", source)
    }

    /// The excerpt's text and underline, without gutters.
    fn excerpt_lines(source: &str, span: Span) -> (String, String) {
        let report = rendered(source, span);
        let lines: Vec<&str> = report.lines().collect();
        let content = |line: &str| line.split_once('|').unwrap().1.strip_prefix(' ').unwrap_or("").to_string();
        (content(lines[3]), content(lines[4]))
    }

    #[test]
    fn looks_as_in_the_style_guide() {
        let line = "kinetic += 1/2 * m * l * dt(theta);";
        let source = format!("{}{line}\n}}\n", "\n".repeat(8));
        let mut errors = Diagnostics::default();
        errors
            .error(
                Code::EnergyDimension,
                8 + 11..8 + 34,
                "kinetic energy must be an energy (kg·m²/s²), this term is kg·m/s",
            )
            .help("a speed enters squared: did you mean `1/2 * m * (l * dt(theta))^2`?");
        let expected = "\
error[MBS0801]: kinetic energy must be an energy (kg·m²/s²), this term is kg·m/s
 --> mechanisms/pendulum.mbs:9:12
  |
9 | kinetic += 1/2 * m * l * dt(theta);
  |            ^^^^^^^^^^^^^^^^^^^^^^^
  = help: a speed enters squared: did you mean `1/2 * m * (l * dt(theta))^2`?
";
        assert_eq!(errors.render("mechanisms/pendulum.mbs", &source), expected);
    }

    #[test]
    fn gutter_is_as_wide_as_the_line_number() {
        let source = format!("{}x", "\n".repeat(99));
        let expected = "error[MBS0201]: wrong\n   --> a.mbs:100:1\n    |\n100 | x\n    | ^\n";
        assert_eq!(rendered(&source, 99..100), expected);
    }

    #[test]
    fn messages_come_in_source_order_with_a_line_between() {
        let mut errors = Diagnostics::default();
        errors.error(Code::Unexpected, 2..3, "second");
        errors.warning(Code::Unused, 0..1, "first").help("one\ntwo");
        errors.error(Code::Unexpected, 2..3, "third");
        let expected = "\
warning[MBS0514]: first
 --> a.mbs:1:1
  |
1 | a b
  | ^
  = help: one
          two

error[MBS0201]: second
 --> a.mbs:1:3
  |
1 | a b
  |   ^

error[MBS0201]: third
 --> a.mbs:1:3
  |
1 | a b
  |   ^
";
        assert_eq!(errors.render("a.mbs", "a b"), expected);
        assert_eq!(
            errors.to_string(),
            "warning[MBS0514]: first; help: one\ntwo\nerror[MBS0201]: second\nerror[MBS0201]: third"
        );
    }

    #[test]
    fn notes_show_other_places() {
        let mut errors = Diagnostics::default();
        errors.error(Code::Unexpected, 0..1, "wrong").help("right").note(4..5, "here too");
        let expected = "\
error[MBS0201]: wrong
 --> a.mbs:1:1
  |
1 | a b
  | ^
  = help: right
note: here too
 --> a.mbs:2:1
  |
2 | c
  | ^
";
        assert_eq!(errors.render("a.mbs", "a b\nc"), expected);
    }

    #[test]
    fn twenty_messages_are_enough() {
        let mut errors = Diagnostics::default();
        for i in 0..23 {
            errors.error(Code::Unexpected, i..i + 1, format!("number {i}"));
        }
        let report = errors.render("a.mbs", &"x".repeat(23));
        assert_eq!(report.matches("error[MBS0201]: ").count(), 20);
        assert!(report.ends_with("\n\n… and 3 more\n"), "{report}");
    }

    #[test]
    fn warnings_hide_no_error() {
        let mut errors = Diagnostics::default();
        for i in 0..30 {
            errors.warning(Code::Unused, i..i + 1, "odd");
        }
        errors.error(Code::Unexpected, 30..31, "wrong");
        let report = errors.render("a.mbs", &"x".repeat(31));
        assert_eq!(report.matches("warning[MBS0514]: odd").count(), 19);
        assert!(report.ends_with("^\n\n… and 11 more\n") && report.contains("error[MBS0201]: wrong"), "{report}");
    }

    #[test]
    fn a_million_messages_take_no_memory_without_end() {
        let mut errors = Diagnostics::default();
        for i in 0..Diagnostics::KEPT {
            errors.warning(Code::Unused, i..i + 1, "odd");
        }
        assert!(!errors.is_full() && !errors.has_errors());
        for i in 0..100_000 {
            errors.error(Code::Unexpected, i..i + 1, "wrong").help("right");
        }
        assert!(errors.has_errors());
        assert_eq!(errors.iter().count(), Diagnostics::KEPT + 1);
        assert!(errors.render("a.mbs", "x").ends_with("… and at least 981 more\n"));
    }

    #[test]
    fn columns_count_characters() {
        // Two Greek letters of two bytes each stand before the `x`.
        assert_eq!(rendered("θω x", 5..6), "error[MBS0201]: wrong\n --> a.mbs:1:4\n  |\n1 | θω x\n  |    ^\n");
        assert_eq!(excerpt_lines("q\u{307}*x", 4..5), ("q\u{307}*x".into(), "  ^".into()));
    }

    #[test]
    fn tabs_are_four_spaces_and_control_characters_are_harmless() {
        assert_eq!(excerpt_lines("\tx\t= y", 1..5), ("    x    = y".into(), "    ^^^^^^".into()));
        assert!(rendered("\tx", 1..2).contains("a.mbs:1:2\n"));
        assert_eq!(excerpt_lines("\u{1b}[31m\u{202e}x", 8..9).0, "\u{fffd}[31m\u{fffd}x");
    }

    #[test]
    fn several_lines_are_shown_by_the_first() {
        assert_eq!(excerpt_lines("a + \r\n b;", 0..9), ("a +".into(), "^^^".into()));
    }

    #[test]
    fn end_of_file_is_a_place() {
        assert_eq!(rendered("", 0..0), "error[MBS0201]: wrong\n --> a.mbs:1:1\n  |\n1 |\n  | ^\n");
        assert_eq!(rendered("ab", 2..2), "error[MBS0201]: wrong\n --> a.mbs:1:3\n  |\n1 | ab\n  |   ^\n");
        assert_eq!(rendered("ab\n", 3..3), "error[MBS0201]: wrong\n --> a.mbs:2:1\n  |\n2 |\n  | ^\n");
        assert_eq!(rendered("ab\n", 2..3), "error[MBS0201]: wrong\n --> a.mbs:1:3\n  |\n1 | ab\n  |   ^\n");
    }

    #[test]
    fn long_lines_are_trimmed_around_the_span() {
        let source = format!("{}abc{}", "x".repeat(500), "y".repeat(500));
        let (text, underline) = excerpt_lines(&source, 500..503);
        assert!(text.starts_with("…x") && text.ends_with("y…") && text.chars().count() == WIDTH + 2, "{text}");
        assert_eq!(text.find("abc").map(|at| text[..at].chars().count()), underline.find('^'));
        assert_eq!(underline.matches('^').count(), 3);

        let (text, underline) = excerpt_lines(&source, 0..1003);
        assert!(text.starts_with('x') && underline.len() == WIDTH, "{text}\n{underline}");
        let (text, underline) = excerpt_lines(&source, 1003..1003);
        assert!(text.ends_with('y') && underline.len() == WIDTH + 2, "{text}\n{underline}");
    }

    #[test]
    fn any_span_is_rendered() {
        for source in ["", "é", "a\né\n", "\r\n\r\n", "\u{feff}x"] {
            for start in 0..8 {
                for end in 0..8 {
                    assert!(rendered(source, start..end).contains("^"));
                }
            }
        }
    }

    #[test]
    fn nearest_finds_slips() {
        let candidates = ["param", "potential", "coord", "m_cart", "x", "t"];
        let check = |name: &str, expected: Option<&str>| assert_eq!(nearest(name, candidates), expected, "{name}");
        check("parm", Some("param"));
        check("papam", Some("param"));
        check("apram", Some("param"));
        check("Param", Some("param"));
        check("potentail", Some("potential"));
        check("potintiel", Some("potential"));
        check("cord", Some("coord"));
        check("m_crat", Some("m_cart"));
        check("y", None);
        check("inertia", None);
        check("", None);
        check(&"x".repeat(100_000), None);
    }
}
