//! Tokens one by one, with where they stand; refusals; documentation.

use proc_macro2::{Delimiter, Spacing, TokenTree};
use syn::buffer::Cursor;
use syn::parse::discouraged::AnyDelimiter;
use syn::parse::{ParseBuffer, ParseStream};

use super::MAX_DEPTH;
use super::syntax::{Import, Span};
use crate::diagnostic::Diagnostics;

/// The construct is given up; why has been noted in `errors`.
pub(super) struct Refused;

pub(super) type Parsed<T> = Result<T, Refused>;

pub(super) struct Reader<'s> {
    pub(super) source: &'s str,
    /// Where the last token taken ends.
    pub(super) last: usize,
    /// How deep the construct at hand is nested.
    pub(super) depth: usize,
    /// What the file imports.
    pub(super) imports: Vec<Import>,
    pub(super) errors: Diagnostics,
}

/// What stands between two brackets.
pub(super) struct Group<'t> {
    pub(super) content: ParseBuffer<'t>,
    /// Where its closing bracket ends.
    end: usize,
}

impl Reader<'_> {
    /// Where the next token stands: of a group its opening bracket, at a group's end its closing bracket.
    pub(super) fn next(&self, input: ParseStream<'_>) -> Span {
        let span = input.span().byte_range();
        match sign(input.cursor()) {
            Some((sign, _)) if sign.len() > 1 => span.start..span.start + sign.len(),
            _ if input.is_empty() && span == (0..0) => self.last..self.last,
            _ => span,
        }
    }

    /// Whether a line break stands between the last token and the next one.
    pub(super) fn begins_line(&self, input: ParseStream<'_>) -> bool {
        self.source.get(self.last..self.next(input).start).is_some_and(|between| between.contains('\n'))
    }

    pub(super) fn peek(&self, input: ParseStream<'_>, text: &str) -> bool {
        sign(input.cursor()).is_some_and(|(found, _)| found == text)
    }

    pub(super) fn eat(&mut self, input: ParseStream<'_>, text: &str) -> Option<Span> {
        if !self.peek(input, text) {
            return None;
        }
        for _ in text.chars() {
            self.skip(input);
        }
        Some(self.last - text.len()..self.last)
    }

    pub(super) fn eat_word(&mut self, input: ParseStream<'_>, text: &str) -> bool {
        let found = word(input.cursor()).is_some_and(|(found, _)| found == text);
        if found {
            self.skip(input);
        }
        found
    }

    pub(super) fn literal(&mut self, input: ParseStream<'_>) -> Option<String> {
        let (literal, _) = input.cursor().literal()?;
        self.skip(input);
        Some(literal.to_string())
    }

    /// Takes one token or one group; answers whether a statement may end with it.
    pub(super) fn skip(&mut self, input: ParseStream<'_>) -> bool {
        let Ok(token) = input.parse::<TokenTree>() else { return true };
        self.last = token.span().byte_range().end;
        match token {
            TokenTree::Punct(punct) => punct.as_char() == ';',
            TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
            TokenTree::Ident(_) | TokenTree::Literal(_) => false,
        }
    }

    /// Enters the group that comes next; [`Reader::close`] leaves it.
    pub(super) fn group<'t>(&mut self, input: &'t ParseBuffer<'_>) -> Parsed<Group<'t>> {
        let here = self.next(input);
        self.enter(&here)?;
        match input.parse_any_delimiter() {
            Ok((_, brackets, content)) => {
                self.last = here.end;
                Ok(Group { content, end: brackets.close().byte_range().end })
            }
            Err(_) => Err(self.unexpected(input, "a bracket", "write `(`, `[` or `{`")),
        }
    }

    pub(super) fn close(&mut self, group: Group<'_>) {
        self.depth -= 1;
        self.last = group.end;
    }

    /// One level deeper; the caller comes back up by itself.
    pub(super) fn enter(&mut self, here: &Span) -> Parsed<()> {
        self.depth += 1;
        if self.depth <= MAX_DEPTH {
            return Ok(());
        }
        let message = format!("this is nested deeper than {MAX_DEPTH} levels");
        Err(self.refuse(here.clone(), message, "name the inner values with `let`"))
    }
}

pub(super) fn opens(input: ParseStream<'_>, delimiter: Delimiter) -> bool {
    input.cursor().group(delimiter).is_some()
}

pub(super) fn word(cursor: Cursor<'_>) -> Option<(String, Cursor<'_>)> {
    let (ident, rest) = cursor.ident()?;
    Some((ident.to_string(), rest))
}

/// Signs of several characters; of two that begin alike the longer one comes first.
const LONG_SIGNS: [&str; 16] =
    ["..=", "..", "**", "+=", "-=", "*=", "/=", "==", "!=", "<=", ">=", "->", "=>", "&&", "||", "::"];

/// Signs of one character.
const SIGNS: &str = "+-*/^=.,;:#!<>%&|@$~?";

/// The sign that stands next, the longest that can be read, and what is behind it.
pub(super) fn sign(cursor: Cursor<'_>) -> Option<(&'static str, Cursor<'_>)> {
    let (first, rest) = cursor.punct()?;
    let long = || LONG_SIGNS.into_iter().find_map(|text| Some((text, behind(cursor, text)?)));
    let at = SIGNS.find(first.as_char())?;
    let short = (&SIGNS[at..at + 1], rest);
    if first.spacing() == Spacing::Joint { long().or(Some(short)) } else { Some(short) }
}

fn behind<'t>(mut cursor: Cursor<'t>, text: &str) -> Option<Cursor<'t>> {
    for (i, c) in text.chars().enumerate() {
        let (punct, rest) = cursor.punct()?;
        let joined = i + 1 == text.len() || punct.spacing() == Spacing::Joint;
        if punct.as_char() != c || !joined {
            return None;
        }
        cursor = rest;
    }
    Some(cursor)
}

impl Reader<'_> {
    pub(super) fn refuse(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Refused {
        self.errors.error(span, message).help(help);
        Refused
    }

    pub(super) fn unexpected(&mut self, input: ParseStream<'_>, expected: &str, help: &str) -> Refused {
        let (span, found) = (self.next(input), self.found(input));
        self.refuse(span, format!("expected {expected}, found {found}"), help)
    }

    /// What stands next, for a message.
    pub(super) fn found(&self, input: ParseStream<'_>) -> String {
        let span = self.next(input);
        match (sign(input.cursor()), self.source.get(span)) {
            (Some((sign, _)), _) => format!("`{sign}`"),
            (None, Some(text)) if !text.is_empty() => {
                let shown: String = text.chars().take(40).collect();
                format!("`{shown}{}`", if shown.len() < text.len() { "…" } else { "" })
            }
            (None, _) => "the end of the file".to_string(),
        }
    }
}

impl Reader<'_> {
    /// The documentation before a statement, and complaints about what else begins with `#`.
    pub(super) fn docs(&mut self, input: ParseStream<'_>) -> Parsed<Vec<String>> {
        let mut docs = Vec::new();
        while self.peek(input, "#") {
            let (trails, start) = (!self.begins_line(input), self.next(input).start);
            match self.doc(input) {
                Some((span, lines)) => {
                    let text = &self.source[span.clone()];
                    if text.starts_with("//!") || text.starts_with("/*!") {
                        let error = self.errors.error(span, "this documents the whole file");
                        error.help("write `///`, or move it to the top of the file");
                    } else if trails && text.starts_with("///") {
                        let error =
                            self.errors.error(span, "this would document what follows, not what stands before it");
                        error.help("write it on the line before, or as a comment after `//`");
                    } else {
                        docs.extend(lines);
                    }
                }
                None => {
                    self.inner_attribute(input)?;
                    let message = "an attribute of the file stands within the mechanism";
                    return Err(self.refuse(start..self.last, message, "move it to the top of the file"));
                }
            }
        }
        Ok(docs)
    }

    /// `inner := "#![dimensionless]"`
    pub(super) fn inner_attribute(&mut self, input: ParseStream<'_>) -> Parsed<()> {
        let start = self.next(input).start;
        self.eat(input, "#");
        self.eat(input, "!");
        if opens(input, Delimiter::Bracket) {
            self.skip(input);
        }
        let span = start..self.last;
        let text: String = self.source[span.clone()].split_whitespace().collect();
        let (message, help) = match text.as_str() {
            "#![dimensionless]" => return Ok(()),
            "#[dimensionless]" => ("this attribute is about the whole file", "write `#![dimensionless]`"),
            _ => ("this attribute is not known", "the only one is `#![dimensionless]`"),
        };
        Err(self.refuse(span, message, help))
    }

    /// One comment of documentation, which the tokenizer has made an attribute of.
    pub(super) fn doc(&mut self, input: ParseStream<'_>) -> Option<(Span, Vec<String>)> {
        let span = self.next(input);
        let text = self.source.get(span.clone())?;
        let lines = match text.get(..3)? {
            "///" | "//!" => vec![doc_line(&text[3..])],
            "/**" | "/*!" => doc_block(text[3..].strip_suffix("*/")?),
            _ => return None,
        };
        self.skip(input);
        if self.peek(input, "!") {
            self.skip(input);
        }
        self.skip(input);
        Some((span, lines))
    }
}

fn doc_line(text: &str) -> String {
    text.strip_prefix(' ').unwrap_or(text).trim_end().to_string()
}

/// Its lines without the stars that they begin with.
fn doc_block(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = text.lines().map(|line| doc_line(line.trim_start().trim_start_matches('*'))).collect();
    while lines.first().is_some_and(String::is_empty) {
        lines.remove(0);
    }
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    lines
}
