//! What is wrong with a plan, and where.

use std::fmt;
use std::ops::Range;

/// A mistake at a place of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The bytes of the plan that it is about.
    pub span: Range<usize>,
    /// Lower case, no full stop.
    pub message: String,
    /// What to write instead.
    pub help: Option<String>,
}

impl Fault {
    /// A mistake without a hint.
    pub fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Fault { span, message: message.into(), help: None }
    }

    /// A mistake with what to write instead.
    pub fn with_help(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Fault { help: Some(help.into()), ..Fault::new(span, message) }
    }

    /// A name that is not known, with the nearest of those that are.
    pub fn unknown(span: Range<usize>, what: &str, name: &str, known: &[String]) -> Self {
        let help = match nearest(name, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => format!("there is no {what} at all"),
            None => format!("one of {}", abridged(known)),
        };
        Fault::with_help(span, format!("there is no {what} `{name}`"), help)
    }
}

/// The known name that differs least, if it is near enough to have been meant.
fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a String> {
    let distance = |other: &&String| strsim::damerau_levenshtein(name, other);
    let length = name.chars().count();
    known.iter().min_by_key(distance).filter(|other| distance(other) <= (length / 3).max(1) && distance(other) < length)
}

/// At most twelve names.
fn abridged(names: &[String]) -> String {
    const MOST: usize = 12;
    let shown = names.iter().take(MOST).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}

/// All that is wrong with a plan, in the order in which it stands there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// The last line of a pass: `value` where nothing was found wrong with it.
    pub(crate) fn finish<T>(faults: Vec<Fault>, value: T) -> Result<T, Faults> {
        if faults.is_empty() { Ok(value) } else { Err(Faults::from(faults)) }
    }

    /// One by one.
    pub fn iter(&self) -> impl Iterator<Item = &Fault> {
        self.0.iter()
    }

    /// A line for each, with the line and the column of the plan's text: `plan.toml:3:5: there is no …`.
    pub fn render(&self, name: &str, text: &str) -> String {
        let line = |fault: &Fault| {
            let start = (0..=fault.span.start.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
            let begin = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
            let (line, column) = (text[..begin].matches('\n').count() + 1, text[begin..start].chars().count() + 1);
            let help = fault.help.as_ref().map_or(String::new(), |help| format!("; {help}"));
            format!("{name}:{line}:{column}: {}{help}\n", fault.message)
        };
        self.0.iter().map(line).collect()
    }
}

impl From<Vec<Fault>> for Faults {
    fn from(mut faults: Vec<Fault>) -> Self {
        faults.sort_by_key(|fault| fault.span.start);
        Faults(faults)
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Faults(vec![fault])
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let messages: Vec<&str> = self.0.iter().map(|fault| fault.message.as_str()).collect();
        f.write_str(&messages.join("; "))
    }
}

impl std::error::Error for Faults {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_lines_and_columns() {
        let text = "a = 1\nbé = mass\n";
        let at = text.find("mass").unwrap();
        let known = ["m".to_string(), "masss".to_string()];
        let faults = Faults::from(Fault::unknown(at..at + 4, "parameter", "mass", &known));
        assert_eq!(faults.render("p.toml", text), "p.toml:2:6: there is no parameter `mass`; did you mean `masss`?\n");
        let far = Fault::unknown(0..1, "parameter", "stiffness", &known);
        assert_eq!(far.help.unwrap(), "one of `m`, `masss`");
    }
}
