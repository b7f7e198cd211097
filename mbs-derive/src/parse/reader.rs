//! Tokens one by one, with where they stand; refusals; documentation.

use super::MAX_DEPTH;
use super::lexer::{Kind, Token};
use super::syntax::{Import, Span};
use crate::diagnostic::{Code, Diagnostics};

/// The construct is given up; why has been noted in `errors`.
pub(super) struct Refused;

pub(super) type Parsed<T> = Result<T, Refused>;

pub(super) struct Reader<'s> {
    pub(super) source: &'s str,
    pub(super) tokens: Vec<Token>,
    /// The token that stands next.
    pub(super) at: usize,
    /// The closing brackets of the groups that are being read, the innermost last.
    pub(super) groups: Vec<usize>,
    /// Where the last token taken ends.
    pub(super) last: usize,
    /// How deep the construct at hand is nested.
    pub(super) depth: usize,
    /// What the file imports.
    pub(super) imports: Vec<Import>,
    pub(super) errors: Diagnostics,
}

impl<'s> Reader<'s> {
    pub(super) fn new(source: &'s str, tokens: Vec<Token>) -> Self {
        let (groups, imports, errors) = (Vec::new(), Vec::new(), Diagnostics::default());
        Reader { source, tokens, at: 0, groups, last: 0, depth: 0, imports, errors }
    }

    fn text(&self, token: Token) -> &'s str {
        &self.source[token.span()]
    }
}

// ---- what comes, none of it behind the group that is being read

impl<'s> Reader<'s> {
    fn end(&self) -> usize {
        self.groups.last().copied().unwrap_or(self.tokens.len())
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.at >= self.end()
    }

    fn token_at(&self, at: usize) -> Option<Token> {
        self.tokens[..self.end()].get(at).copied()
    }

    pub(super) fn word_at(&self, at: usize) -> Option<&'s str> {
        self.token_at(at).filter(|token| token.kind == Kind::Word).map(|token| self.text(token))
    }

    pub(super) fn sign_at(&self, at: usize) -> Option<&'static str> {
        match self.token_at(at)?.kind {
            Kind::Sign(sign) => Some(sign),
            Kind::Doc => Some("#"),
            _ => None,
        }
    }

    pub(super) fn number_at(&self, at: usize) -> bool {
        self.token_at(at).is_some_and(|token| token.kind == Kind::Number)
    }

    pub(super) fn opens_at(&self, at: usize, bracket: char) -> bool {
        self.behind_group(at, bracket).is_some()
    }

    /// The token behind the group that begins at `at` with `bracket`, if one does.
    pub(super) fn behind_group(&self, at: usize, bracket: char) -> Option<usize> {
        match self.token_at(at)?.kind {
            Kind::Open(open, close) if open == bracket => Some(close + 1),
            _ => None,
        }
    }

    /// The token behind the token or the group at `at`.
    pub(super) fn behind(&self, at: usize) -> usize {
        match self.tokens[at].kind {
            Kind::Open(_, close) => close + 1,
            _ => at + 1,
        }
    }

    pub(super) fn word(&self) -> Option<&'s str> {
        self.word_at(self.at)
    }

    pub(super) fn sign(&self) -> Option<&'static str> {
        self.sign_at(self.at)
    }

    pub(super) fn opens(&self, bracket: char) -> bool {
        self.opens_at(self.at, bracket)
    }

    pub(super) fn peek(&self, text: &str) -> bool {
        self.sign() == Some(text)
    }

    /// Where the next token stands: of a group its opening bracket, at a group's end its closing bracket.
    pub(super) fn next(&self) -> Span {
        self.tokens.get(self.at).map_or(self.last..self.last, |token| token.span())
    }

    /// Whether a line break stands between the last token and the next one.
    pub(super) fn begins_line(&self) -> bool {
        let is_first = self.last == 0;
        is_first || self.source.get(self.last..self.next().start).is_some_and(|between| between.contains('\n'))
    }
}

// ---- taking it

impl<'s> Reader<'s> {
    pub(super) fn eat(&mut self, text: &str) -> Option<Span> {
        if !self.peek(text) {
            return None;
        }
        self.skip();
        Some(self.last - text.len()..self.last)
    }

    pub(super) fn eat_word(&mut self, text: &str) -> bool {
        let found = self.word() == Some(text);
        if found {
            self.skip();
        }
        found
    }

    /// A number with what is written against it.
    pub(super) fn literal(&mut self) -> Option<&'s str> {
        let token = self.token_at(self.at).filter(|token| token.kind == Kind::Number)?;
        self.skip();
        Some(self.text(token))
    }

    /// A path, without its quotation marks.
    pub(super) fn path(&mut self) -> Option<&'s str> {
        let token = self.token_at(self.at).filter(|token| token.kind == Kind::Path)?;
        self.skip();
        Some(self.text(token).trim_matches('"'))
    }

    /// Takes one token or one group; answers whether a statement may end with it.
    pub(super) fn skip(&mut self) -> bool {
        let Some(token) = self.token_at(self.at) else { return true };
        self.at = self.behind(self.at);
        self.last = self.tokens[self.at - 1].span().end;
        matches!(token.kind, Kind::Sign(";") | Kind::Open('{', _))
    }

    /// Goes back to a token that was read before, in the same group, as if the text began there.
    pub(super) fn begin_at(&mut self, at: usize) {
        (self.at, self.last) = (at, 0);
    }

    /// Enters the group that comes next; [`Reader::close`] leaves it.
    pub(super) fn open(&mut self) -> Parsed<()> {
        let here = self.next();
        self.enter(&here)?;
        match self.token_at(self.at).map(|token| token.kind) {
            Some(Kind::Open(_, close)) => {
                self.groups.push(close);
                self.at += 1;
                self.last = here.end;
                Ok(())
            }
            _ => Err(self.unexpected("a bracket", "write `(`, `[` or `{`")),
        }
    }

    /// Goes behind the group that was entered last.
    pub(super) fn close(&mut self) {
        self.depth -= 1;
        if let Some(close) = self.groups.pop() {
            self.at = close + 1;
            self.last = self.tokens[close].span().end;
        }
    }

    /// Goes behind all groups but the outer `kept`, which something wrong was found in.
    pub(super) fn leave(&mut self, kept: usize) {
        if let Some(&close) = self.groups.get(kept) {
            self.at = close + 1;
            self.groups.truncate(kept);
        }
    }

    /// One level deeper; the caller comes back up by itself.
    pub(super) fn enter(&mut self, here: &Span) -> Parsed<()> {
        self.depth += 1;
        if self.depth <= MAX_DEPTH {
            return Ok(());
        }
        let message = format!("this is nested deeper than {MAX_DEPTH} levels");
        Err(self.refuse(Code::TooDeep, here.clone(), message, "name the inner values with `let`"))
    }
}

impl Reader<'_> {
    pub(super) fn refuse(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Refused {
        self.errors.error(code, span, message).help(help);
        Refused
    }

    pub(super) fn unexpected(&mut self, expected: &str, help: &str) -> Refused {
        let (span, found) = (self.next(), self.found());
        self.refuse(Code::Unexpected, span, format!("expected {expected}, found {found}"), help)
    }

    /// What stands next, for a message.
    pub(super) fn found(&self) -> String {
        let span = self.next();
        match (self.sign(), self.source.get(span)) {
            (Some(sign), _) => format!("`{sign}`"),
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
    pub(super) fn docs(&mut self) -> Parsed<Vec<String>> {
        let mut docs = Vec::new();
        while self.peek("#") {
            let (trails, start) = (!self.begins_line(), self.next().start);
            match self.doc() {
                Some((span, lines)) => {
                    let text = &self.source[span.clone()];
                    if is_of_file(text) {
                        let error = self.errors.error(Code::Documentation, span, "this documents the whole file");
                        error.help("write `///`, or move it to the top of the file");
                    } else if trails && text.starts_with("///") {
                        let error = self.errors.error(
                            Code::Documentation,
                            span,
                            "this would document what follows, not what stands before it",
                        );
                        error.help("write it on the line before, or as a comment after `//`");
                    } else {
                        docs.extend(lines);
                    }
                }
                None => {
                    self.inner_attribute()?;
                    let message = "an attribute of the file stands within the mechanism";
                    return Err(self.refuse(
                        Code::Attribute,
                        start..self.last,
                        message,
                        "move it to the top of the file",
                    ));
                }
            }
        }
        Ok(docs)
    }

    /// `inner := "#![dimensionless]"`
    pub(super) fn inner_attribute(&mut self) -> Parsed<()> {
        let start = self.next().start;
        self.eat("#");
        self.eat("!");
        if self.opens('[') {
            self.skip();
        }
        let span = start..self.last;
        let text: String = self.source[span.clone()].split_whitespace().collect();
        let (message, help) = match text.as_str() {
            "#![dimensionless]" => return Ok(()),
            "#[dimensionless]" => ("this attribute is about the whole file", "write `#![dimensionless]`"),
            _ => ("this attribute is not known", "the only one is `#![dimensionless]`"),
        };
        Err(self.refuse(Code::Attribute, span, message, help))
    }

    /// One comment of documentation.
    pub(super) fn doc(&mut self) -> Option<(Span, Vec<String>)> {
        let token = self.token_at(self.at).filter(|token| token.kind == Kind::Doc)?;
        self.skip();
        let (comment, text) = self.text(token).split_at(3);
        let lines = match comment {
            "///" | "//!" => vec![doc_line(text)],
            _ => doc_block(text.strip_suffix("*/").unwrap_or(text)),
        };
        Some((token.span(), lines))
    }
}

/// Whether a comment of documentation is about the whole file.
pub(super) fn is_of_file(comment: &str) -> bool {
    comment.starts_with("//!") || comment.starts_with("/*!")
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
