//! Texts that are put into a mechanism's own file by a program, such as formulas of a command line: places in them are
//! shown where they were written.

use std::ops::Range;

use crate::span::Span;

/// A text that is put into the mechanism's own file, parts of which a user has written elsewhere than in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Insertion {
    text: String,
    /// The parts that stand elsewhere, in order.
    quotes: Vec<Quote>,
}

/// A part of a text that was written elsewhere.
#[derive(Clone, Debug, PartialEq)]
struct Quote {
    /// Where it stands in the insertion.
    at: usize,
    /// As reports call the text that it is a part of.
    name: String,
    /// All of that text.
    text: String,
    /// The part.
    part: Range<usize>,
}

impl Insertion {
    /// All of a text that a user has written, by the name that reports call it.
    #[must_use]
    pub fn quoted(name: &str, text: &str) -> Self {
        let quote = Quote { at: 0, name: name.to_string(), text: text.to_string(), part: 0..text.len() };
        Insertion { text: text.to_string(), quotes: vec![quote] }
    }

    /// A part of it, by its bytes.
    #[must_use]
    pub fn slice(&self, range: Range<usize>) -> Self {
        let part = |quote: &Quote| {
            let (start, end) = (quote.at.max(range.start), (quote.at + quote.part.len()).min(range.end));
            let within = |at: usize| quote.part.start + (at - quote.at);
            let is_in = start < end;
            is_in.then(|| Quote { at: start - range.start, part: within(start)..within(end), ..quote.clone() })
        };
        let text = self.text.get(range.clone()).unwrap_or_default().to_string();
        Insertion { text, quotes: self.quotes.iter().filter_map(part).collect() }
    }

    /// Adds a text of the program.
    pub fn push(&mut self, text: &str) {
        self.text += text;
    }

    /// Adds another insertion.
    pub fn append(&mut self, other: Insertion) {
        let start = self.text.len();
        self.text += &other.text;
        self.quotes.extend(other.quotes.into_iter().map(|quote| Quote { at: start + quote.at, ..quote }));
    }

    /// All of it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text of the user that a place in the insertion is about, and the place in it: the nearest where it is about
    /// none.
    fn quote_of(&self, place: &Span) -> Option<(&Quote, Span)> {
        let end = |quote: &Quote| quote.at + quote.part.len();
        let inside = |quote: &&Quote| quote.at < place.end.max(place.start + 1) && place.start < end(quote);
        let before = || self.quotes.iter().rev().find(|quote| end(quote) <= place.start);
        let first = self.quotes.iter().find(inside).or_else(before).or(self.quotes.first())?;
        let same = |quote: &&Quote| quote.name == first.name;
        let last = self.quotes.iter().rev().filter(same).find(inside).unwrap_or(first);
        let within = |quote: &Quote, at: usize| quote.part.start + at.saturating_sub(quote.at).min(quote.part.len());
        let start = within(first, place.start);
        Some((first, start..within(last, place.end).max(start)))
    }
}

/// A text before anything was put into it, and what was.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Edited {
    original: String,
    /// Each with its place in the edited text, in order.
    insertions: Vec<(usize, Insertion)>,
}

impl Edited {
    /// The text with the insertions at their places, and how to find back. Of several at one place the last one is
    /// first.
    pub(super) fn new(original: &str, mut insertions: Vec<(usize, Insertion)>) -> (String, Self) {
        insertions.reverse();
        insertions.sort_by_key(|(place, _)| *place);
        let (mut text, mut copied) = (String::new(), 0);
        for (place, insertion) in &mut insertions {
            text += original.get(copied..*place).unwrap_or_default();
            copied = (*place).max(copied);
            *place = text.len();
            text += &insertion.text;
        }
        text += original.get(copied..).unwrap_or_default();
        (text, Edited { original: original.to_string(), insertions })
    }

    /// The name of the text that a place in the edited text is about, where it is not the file, the text, and the place
    /// in it.
    pub(super) fn locate(&self, span: &Span) -> (Option<&str>, &str, Span) {
        let holding =
            self.insertions.iter().find(|(at, inserted)| (*at..at + inserted.text.len()).contains(&span.start));
        if let Some((at, insertion)) = holding
            && let Some((quote, place)) = insertion.quote_of(&(span.start - at..span.end.saturating_sub(*at)))
        {
            return (Some(&quote.name), &quote.text, place);
        }
        let original = |offset: usize| {
            let before = self.insertions.iter().filter(|(at, _)| *at < offset);
            offset - before.map(|(at, inserted)| inserted.text.len().min(offset - at)).sum::<usize>()
        };
        let start = original(span.start);
        (None, &self.original, start..original(span.end).max(start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Sources;

    #[test]
    fn places_are_found_where_they_were_written() {
        let original = "mechanism A { coord x: m; }";
        let mut constants = Insertion::default();
        constants.push("const one = 1; ");
        let mut formula = Insertion::default();
        formula.push(" output a = one*(");
        let quoted = Insertion::quoted("--input a", "2*t + foo");
        formula.append(quoted.slice(0..2));
        formula.push("(");
        formula.append(quoted.slice(2..3));
        formula.push("/s)");
        formula.append(quoted.slice(3..9));
        formula.push(");");
        let insertions = vec![(original.find(" }").unwrap(), formula), (original.find("coord").unwrap(), constants)];
        let sources = Sources::new("a.mbs", original).with_insertions(insertions);
        let text = sources.main().text.clone().unwrap();
        assert_eq!(text, "mechanism A { const one = 1; coord x: m; output a = one*(2*(t/s) + foo); }");
        let found = |part: &str| {
            let start = text.find(part).unwrap();
            let (name, source, span) = sources.locate(&(start..start + part.len()));
            format!("{name}: {}", &source[span])
        };
        assert_eq!(found("coord x: m;"), "a.mbs: coord x: m;");
        assert_eq!(found("foo"), "--input a: foo");
        assert_eq!(found("(t/s)"), "--input a: t");
        assert_eq!(found("2*(t/s) +"), "--input a: 2*t +");
        assert_eq!(found("output a = one*(2*(t/s) + foo);"), "--input a: 2*t + foo");
        assert_eq!(found(");"), "--input a: ");
        assert_eq!(found("A { const one = 1; coord"), "a.mbs: A { coord");
        assert_eq!(found("const one"), "a.mbs: ");
    }
}
