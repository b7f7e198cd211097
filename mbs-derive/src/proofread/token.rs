//! Words, numbers and marks of a text, for all languages.

use std::ops::Range;

use super::reading::Reading;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name; where fields belong to it, with those behind it: `self->params.m`, `this.#k`.
    Name,
    Number,
    Text,
    Mark,
    /// What a line begins with, outside of brackets, where lines count.
    Line,
    /// A line for the preprocessor.
    Directive,
    /// Where a text that is expected has what is read by its meaning.
    Slot,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub(super) kind: Kind,
    pub(super) text: &'t str,
    /// Where it begins.
    pub(super) start: usize,
}

impl Token<'_> {
    pub(super) fn range(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    pub(super) fn is(&self, mark: &str) -> bool {
        self.text == mark && !matches!(self.kind, Kind::Text | Kind::Line)
    }
}

/// How words are told from comments and texts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lexis {
    /// What begins a comment up to the end of the line.
    pub(super) comment: &'static str,
    /// Whether there are `/* … */`.
    pub(super) has_blocks: bool,
    /// What joins the words of one name.
    pub(super) joints: &'static [&'static str],
    /// Whether lines that begin with `#` are directives.
    pub(super) has_directives: bool,
    /// What is around texts.
    pub(super) quotes: &'static str,
    /// Whether `"""…"""` is documentation.
    pub(super) has_docstrings: bool,
    /// Whether the ends of lines and, in front of them, spaces count.
    pub(super) lines: Lines,
}

/// What lines are to a language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lines {
    /// Spaces.
    Free,
    /// The ends of statements, which begin as far to the right as the block does.
    Indented,
    /// The ends of statements, and within brackets of rows.
    Rows,
}

/// Marks of more than one character; longer ones first.
const MARKS: [&str; 15] = ["...", "..", "->", "<=", ">=", "==", "!=", "~=", "&&", "||", "++", "+=", "-=", "=>", "::"];

pub(super) fn tokens<'t>(text: &'t str, lexis: &Lexis) -> Reading<Vec<Token<'t>>> {
    let (mut tokens, mut at, mut depth) = (Vec::<Token<'t>>::new(), 0usize, 0usize);
    let mut line: Option<&str> = Some("");
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let to = |found: Option<usize>| found.unwrap_or(rest.len());
        let is_transposed = lexis.lines == Lines::Rows
            && c == '\''
            && tokens.last().is_some_and(|last| last.kind == Kind::Name || [")", "]"].iter().any(|mark| last.is(mark)));
        let (kind, length) = if c == '\n' {
            let indent = rest[1..].len() - rest[1..].trim_start_matches(' ').len();
            let counts = match lexis.lines {
                Lines::Free => false,
                Lines::Indented => depth == 0,
                Lines::Rows => true,
            };
            if counts {
                line = Some(if lexis.lines == Lines::Indented { &rest[1..=indent] } else { "" });
            }
            (None, 1)
        } else if c.is_whitespace() && c != ' ' && lexis.lines != Lines::Free {
            // A form feed begins a line of Python anew.
            return Err(format!("{c:?} is no blank"));
        } else if lexis.lines == Lines::Rows && ["%{", "%}"].iter().any(|mark| rest.starts_with(mark)) {
            return Err("a comment of several lines".to_string());
        } else if c.is_whitespace() {
            (None, c.len_utf8())
        } else if rest.starts_with(lexis.comment) {
            (None, to(rest.find('\n')))
        } else if lexis.has_directives && c == '#' {
            (Some(Kind::Directive), directive(rest))
        } else if lexis.has_blocks && rest.starts_with("/*") {
            (None, to(rest.find("*/").map(|end| end + 2)))
        } else if lexis.has_docstrings && ["\"\"\"", "r\"\"\""].iter().any(|quote| rest.starts_with(quote)) {
            let behind = to(rest.find('"')) + 3;
            (None, to(rest[behind..].find("\"\"\"").map(|end| end + behind + 3)))
        } else if c == '⟨' {
            (Some(Kind::Slot), to(rest.find('⟩').map(|end| end + '⟩'.len_utf8())))
        } else if lexis.quotes.contains(c) && !is_transposed {
            (Some(Kind::Text), quoted(rest, c))
        } else if c.is_ascii_digit() {
            (Some(Kind::Number), number(rest))
        } else if is_word(c) || (c == '#' && rest[1..].starts_with(is_word)) {
            (Some(Kind::Name), name(rest, lexis.joints))
        } else {
            match c {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth = depth.checked_sub(1).ok_or("a bracket closes that none opens")?,
                _ => {}
            }
            let mark = MARKS.iter().find(|mark| rest.starts_with(**mark));
            (Some(Kind::Mark), mark.map_or(c.len_utf8(), |mark| mark.len()))
        };
        if let Some(kind) = kind {
            // Where statements stand, each has its own line.
            if let Some(indent) = line.take()
                && lexis.lines != Lines::Free
                && (kind != Kind::Slot || rest['⟨'.len_utf8()..].starts_with(|c: char| c.is_ascii_digit()))
            {
                tokens.push(Token { kind: Kind::Line, text: indent, start: at });
            }
            tokens.push(Token { kind, text: &rest[..length], start: at });
        }
        at += length;
    }
    Ok(tokens)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// How long a name is with the words that these join to it.
fn name(text: &str, joints: &[&str]) -> usize {
    let word = |from: usize| {
        let rest = &text[from..];
        let own = usize::from(rest.starts_with('#'));
        own + rest[own..].find(|c| !is_word(c)).unwrap_or(rest.len() - own)
    };
    let mut length = word(0);
    loop {
        let mark = joints.iter().find(|mark| text[length..].starts_with(**mark)).map_or(0, |mark| mark.len());
        let behind = &text[length + mark..];
        if mark == 0 || !behind.starts_with(|c: char| c == '#' || (is_word(c) && !c.is_ascii_digit())) {
            return length;
        }
        length += mark + word(length + mark);
    }
}

/// How long a text in quotes is.
fn quoted(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    let close = text[1..].find(|c| {
        let closes = c == quote && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        closes
    });
    close.map_or(text.len(), |close| close + 2)
}

/// How long a directive is: to the end of a line that goes not on.
fn directive(text: &str) -> usize {
    text.match_indices('\n').map(|(at, _)| at).find(|&at| !text[..at].ends_with('\\')).unwrap_or(text.len())
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
