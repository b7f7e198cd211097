//! Words, numbers and marks of a text, for all languages that are not Rust.

use super::super::reader::Reading;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `#` belongs to a name of JavaScript.
    Name,
    Number,
    Text,
    Mark,
    /// The end of a line, outside of brackets.
    End,
}

/// A token, and how far to the right its line begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub(super) kind: Kind,
    pub(super) text: &'t str,
    pub(super) indent: usize,
}

impl Token<'_> {
    pub(super) fn is(&self, mark: &str) -> bool {
        self.text == mark && self.kind != Kind::Text
    }
}

/// How words are told from comments and texts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lexis {
    /// What begins a comment up to the end of the line.
    pub(super) comment: &'static str,
    /// Whether there are `/* … */`.
    pub(super) has_blocks: bool,
    /// Whether lines that begin with `#` are directives.
    pub(super) has_directives: bool,
    /// What is around texts.
    pub(super) quotes: &'static str,
    /// Whether `"""…"""` is documentation.
    pub(super) has_docstrings: bool,
    /// Whether the end of a line ends a row within `[ ]`.
    pub(super) has_rows: bool,
}

/// Marks of more than one character; longer ones first.
const MARKS: [&str; 13] = ["...", "->", "<=", ">=", "==", "!=", "~=", "&&", "||", "++", "+=", "=>", "::"];

pub(super) fn tokens<'t>(text: &'t str, lexis: &Lexis) -> Reading<Vec<Token<'t>>> {
    let (mut tokens, mut at, mut depth, mut indent) = (Vec::<Token<'t>>::new(), 0usize, 0usize, 0usize);
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let to = |found: Option<usize>| found.unwrap_or(rest.len());
        let is_transposed = lexis.has_rows
            && c == '\''
            && tokens.last().is_some_and(|last| last.kind == Kind::Name || [")", "]"].iter().any(|mark| last.is(mark)));
        let (kind, length) = if c == '\n' {
            (if depth == 0 || lexis.has_rows { Some(Kind::End) } else { None }, 1)
        } else if c.is_whitespace() {
            (None, c.len_utf8())
        } else if rest.starts_with(lexis.comment) {
            (None, to(rest.find('\n')))
        } else if lexis.has_directives && c == '#' {
            (None, directive(rest))
        } else if lexis.has_blocks && rest.starts_with("/*") {
            (None, to(rest.find("*/").map(|end| end + 2)))
        } else if lexis.has_docstrings && ["\"\"\"", "r\"\"\""].iter().any(|quote| rest.starts_with(quote)) {
            let behind = rest.find('"').unwrap_or_default() + 3;
            (None, to(rest[behind..].find("\"\"\"").map(|end| end + behind + 3)))
        } else if lexis.quotes.contains(c) && !is_transposed {
            (Some(Kind::Text), to(rest[1..].find(c).map(|end| end + 2)))
        } else if c.is_ascii_digit() {
            (Some(Kind::Number), number(rest))
        } else if is_word(c) || (c == '#' && rest[1..].starts_with(is_word)) {
            (
                Some(Kind::Name),
                c.len_utf8() + rest[c.len_utf8()..].find(|c| !is_word(c)).unwrap_or(rest.len() - c.len_utf8()),
            )
        } else {
            match c {
                '(' | '[' => depth += 1,
                ')' | ']' => depth = depth.checked_sub(1).ok_or("a bracket closes that none opens")?,
                _ => {}
            }
            let mark = MARKS.iter().find(|mark| rest.starts_with(**mark));
            (Some(Kind::Mark), mark.map_or(c.len_utf8(), |mark| mark.len()))
        };
        if let Some(kind) = kind {
            tokens.push(Token { kind, text: &rest[..length], indent });
        }
        at += length;
        if c == '\n' {
            indent = text[at..].len() - text[at..].trim_start_matches(' ').len();
        }
    }
    Ok(tokens)
}

/// How long a directive is: to the end of a line that goes not on.
fn directive(text: &str) -> usize {
    let ends = text.match_indices('\n').map(|(at, _)| at);
    ends.into_iter().find(|&at| !text[..at].ends_with('\\')).unwrap_or(text.len())
}

/// How long a number is: `12`, `0.5`, `1e-9`; `1:3` is two, and `2.` none.
fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'-' | b'+')));
        if digits((length + 1 + sign).min(bytes.len())) > 0 {
            length += 1 + sign + digits(length + 1 + sign);
        }
    }
    length
}
