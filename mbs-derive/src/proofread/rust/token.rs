//! Words, numbers, texts and marks of Rust, as far as it is emitted.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Name,
    Number,
    Text,
    Mark,
}

/// A token, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub(super) kind: Kind,
    pub(super) text: &'t str,
    pub(super) start: usize,
}

impl Token<'_> {
    pub(super) fn is(&self, mark: &str) -> bool {
        self.kind != Kind::Text && self.text == mark
    }

    pub(super) fn range(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// Marks of more than one character; longer ones first.
const MARKS: [&str; 21] = [
    "..=", "...", "<<=", ">>=", "::", "->", "=>", "..", "&&", "||", "==", "!=", "<=", ">=", "+=", "-=", "*=", "/=",
    "%=", "<<", ">>",
];

/// All of a text but spaces and comments up to the ends of lines; others are marks that nothing knows.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut tokens, mut start) = (Vec::new(), 0);
    while let Some(c) = text[start..].chars().next() {
        let rest = &text[start..];
        let (kind, length) = if c.is_whitespace() {
            (None, c.len_utf8())
        } else if rest.starts_with("//") {
            (None, rest.find('\n').unwrap_or(rest.len()))
        } else if c == '"' {
            (Some(Kind::Text), quoted(rest))
        } else if c.is_ascii_digit() {
            (Some(Kind::Number), number(rest))
        } else if is_word(c) {
            (Some(Kind::Name), name(rest))
        } else {
            let mark = MARKS.iter().find(|mark| rest.starts_with(**mark));
            (Some(Kind::Mark), mark.map_or(c.len_utf8(), |mark| mark.len()))
        };
        if let Some(kind) = kind {
            tokens.push(Token { kind, text: &rest[..length], start });
        }
        start += length;
    }
    tokens
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word(text: &str) -> usize {
    text.find(|c| !is_word(c)).unwrap_or(text.len())
}

/// How long a name is, with its escape.
fn name(text: &str) -> usize {
    match text.strip_prefix("r#") {
        Some(rest) => 2 + word(rest),
        None => word(text),
    }
}

/// How long a text in quotes is.
fn quoted(text: &str) -> usize {
    let mut is_escaped = false;
    let close = text[1..].find(|c| {
        let closes = c == '"' && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        closes
    });
    close.map_or(text.len(), |close| close + 2)
}

/// How long a number is, with what is written at it: `12`, `0.5`, `1e-9`, `0.5_f32`; `1..3` is two.
fn number(text: &str) -> usize {
    let mut length = word(text);
    if text[length..].starts_with('.') && text[length + 1..].starts_with(|c: char| c.is_ascii_digit()) {
        length += 1 + word(&text[length + 1..]);
    }
    if text[..length].ends_with(['e', 'E']) && text[length..].starts_with(['-', '+']) {
        length += 1 + word(&text[length + 1..]);
    }
    length
}
