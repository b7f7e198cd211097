//! The line that a message is about, as a terminal shows it.

use crate::span::Span;

/// The line that a span begins on, ready to be printed.
pub(super) struct Excerpt {
    /// Counted from 1.
    pub(super) line: usize,
    /// Counted from 1, in characters.
    pub(super) column: usize,
    /// The line, or the part of it around the span.
    pub(super) text: String,
    /// Columns of `text` before the span.
    pub(super) indent: usize,
    /// Columns of the span, at least one.
    pub(super) width: usize,
}

/// Columns shown of a line; of a longer one the part around the span is shown.
pub(super) const WIDTH: usize = 120;

pub(super) fn excerpt(source: &str, span: &Span) -> Excerpt {
    let start = boundary(source, span.start);
    let end = boundary(source, span.end).max(start);
    let line_start = source[..start].rfind('\n').map_or(0, |newline| newline + 1);
    let line_end = source[start..].find('\n').map_or(source.len(), |newline| start + newline);
    // Of a line of megabytes no more than can be shown is looked at.
    let far = 8 * WIDTH;
    let end = boundary(source, end.min(line_end).min(start + far));
    let marked = source[start..end].trim_end();
    let marked_end = start + marked.len();
    let shown_end = boundary(source, line_end.min(marked_end + far));

    let before = source[boundary(source, line_start.max(start.saturating_sub(far)))..start].chars().flat_map(printable);
    let mut shown: Vec<char> = before.collect();
    let from = shown.len();
    shown.extend(marked.chars().flat_map(printable));
    let to = shown.len();
    shown.extend(source[marked_end..shown_end].trim_end().chars().flat_map(printable));

    let first = if shown.len() <= WIDTH { 0 } else { window(shown.len(), from, to) };
    let last = shown.len().min(first + WIDTH);
    let left = if first > 0 { "…" } else { "" };
    let right = if last < shown.len() { "…" } else { "" };
    Excerpt {
        line: source[..line_start].matches('\n').count() + 1,
        column: source[line_start..start].chars().count() + 1,
        text: format!("{left}{}{right}", String::from_iter(&shown[first..last])),
        indent: left.chars().count() + columns(&shown[first..from]),
        width: columns(&shown[from..to.min(last)]).max(1),
    }
}

/// The nearest place at or before `offset` where a character begins.
fn boundary(source: &str, offset: usize) -> usize {
    let mut offset = offset.min(source.len());
    while !source.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// A tab as four spaces; what would disturb a terminal as a replacement character.
fn printable(c: char) -> impl Iterator<Item = char> {
    let bidirectional = matches!(c, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let (c, count) = match c {
        '\t' => (' ', 4),
        c if c.is_control() || bidirectional => (char::REPLACEMENT_CHARACTER, 1),
        c => (c, 1),
    };
    std::iter::repeat_n(c, count)
}

/// Where to begin so that `from..to` stands in the middle of `WIDTH` columns, or its head where it is longer.
fn window(length: usize, from: usize, to: usize) -> usize {
    let margin = WIDTH.saturating_sub(to - from) / 2;
    from.saturating_sub(margin.max(WIDTH / 10)).min(length - WIDTH)
}

/// Columns that characters take on a terminal: combining marks (q̇) take none.
fn columns(text: &[char]) -> usize {
    text.iter().filter(|c| !matches!(c, '\u{300}'..='\u{36f}')).count()
}
