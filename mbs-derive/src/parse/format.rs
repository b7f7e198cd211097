//! A file in one style: what stands on which line stays; indentation, blank lines and spaces do not.
//!
//! - A statement a line, four spaces for each block and for each line that goes on; empty blocks are `{}`.
//! - Blanks around `+ - = += < && …`, none around `^ . ..` and within brackets; around `* /` as they were written: both
//!   or none, because `0.3 kg*m` and `0.3 kg * m` say different things. None in the units of declarations.
//! - `+=` of neighbouring lines in one column if they were so, and comments behind statements as well.
//! - One blank line at most, none at the ends of a block. Line breaks within statements stay; no line is broken.
//!
//! Nothing but white space is changed, within comments none but at the ends of lines.

mod line;

use std::collections::BTreeSet;

use super::grammar::{self, File};
use super::import::{Shared, begins_as_shared};
use super::lexer::{self, Kind, Token};
use super::syntax::{Declaration, Import, Quantity, Span, Statement, StatementKind};
use crate::diagnostic::Diagnostics;
use line::{Addition, Comment, Line, aligned};

/// Columns for each block, and for each line that goes on.
const STEP: usize = 4;

/// The text in the style.
///
/// # Errors
/// What in it is not the model language.
pub(super) fn formatted(source: &str) -> Result<String, Diagnostics> {
    let mut layout = Layout::of(source)?;
    layout.write();
    let text = aligned(layout.lines);
    let ends_as_on_windows = source.split_once('\n').is_some_and(|(first, _)| first.ends_with('\r'));
    Ok(if ends_as_on_windows { text.replace('\n', "\r\n") } else { text })
}

/// What a comment is, and how it stands.
struct Remark<'s> {
    text: String,
    /// Where it begins.
    start: usize,
    /// Line breaks before it.
    breaks: usize,
    /// `// …`: nothing can stand behind it.
    is_of_line: bool,
    /// What stands before it on its line.
    before: &'s str,
}

struct Layout<'s> {
    source: &'s str,
    tokens: Vec<Token>,
    /// Tokens that a line begins with: statements, documentation.
    beginnings: BTreeSet<usize>,
    /// Braces around statements, opening and closing.
    blocks: BTreeSet<usize>,
    /// Tokens of units of declarations.
    units: BTreeSet<usize>,
    /// `gravity` where it begins a statement.
    fields: BTreeSet<usize>,
    lines: Vec<Line>,
    /// Blocks that are open.
    depth: usize,
    /// For each bracket that is open within a statement, how far the line is indented that it stands on.
    brackets: Vec<usize>,
    /// Where the statement that is being written begins, and the line that it began.
    statement: (usize, usize),
}

// ---- what stands where

impl<'s> Layout<'s> {
    fn of(source: &'s str) -> Result<Self, Diagnostics> {
        let mut layout = Layout {
            source,
            tokens: lexer::tokens(source)?,
            beginnings: BTreeSet::new(),
            blocks: BTreeSet::new(),
            units: BTreeSet::new(),
            fields: BTreeSet::new(),
            lines: Vec::new(),
            depth: 0,
            brackets: Vec::new(),
            statement: (0, 0),
        };
        if begins_as_shared(source) {
            let File { imports, content, errors, .. } = grammar::shared(source);
            if let Some(Shared::Declarations(statements)) = errors.finish(content)? {
                layout.note(&imports, &statements);
            }
        } else {
            let File { imports, content, errors, .. } = grammar::mechanism(source);
            if let Some(declaration) = errors.finish(content)? {
                layout.note(&imports, &declaration.statements);
                layout.note_mechanism(&declaration);
            }
        }
        for i in 0..layout.tokens.len() {
            let attribute = layout.text(i) == "#";
            if layout.is_doc(i) || attribute {
                layout.beginnings.insert(i);
            }
        }
        Ok(layout)
    }

    fn note_mechanism(&mut self, declaration: &Declaration) {
        let name = self.token_at(declaration.name.span.start);
        self.beginnings.insert(name.saturating_sub(1));
        self.note_block(self.brace_from(declaration.name.span.end));
    }

    fn note(&mut self, imports: &[Import], statements: &[Statement]) {
        let starts = imports.iter().map(|import| self.token_at(import.span.start)).collect::<Vec<_>>();
        self.beginnings.extend(starts);
        let mut waiting: Vec<&Statement> = statements.iter().collect();
        while let Some(statement) = waiting.pop() {
            let first = self.token_at(statement.span.start);
            self.beginnings.insert(first);
            match &statement.kind {
                StatementKind::Param(quantity)
                | StatementKind::Coord(quantity)
                | StatementKind::Input(quantity)
                | StatementKind::Prescribed(quantity)
                | StatementKind::Const(quantity) => self.note_unit(quantity),
                StatementKind::Gravity { .. } => drop(self.fields.insert(first)),
                StatementKind::Part { body, .. } | StatementKind::For { body, .. } => {
                    self.note_last_block(&statement.span);
                    waiting.extend(body);
                }
                StatementKind::If { branches, otherwise } => {
                    self.note_last_block(&statement.span);
                    for (condition, body) in branches {
                        self.note_block(self.brace_from(condition.span.end));
                        waiting.extend(body);
                    }
                    waiting.extend(otherwise);
                }
                StatementKind::Let { .. }
                | StatementKind::Elements { .. }
                | StatementKind::Assign { .. }
                | StatementKind::Energy { .. }
                | StatementKind::Force { .. }
                | StatementKind::Function { .. }
                | StatementKind::ForceAt { .. }
                | StatementKind::TorqueOn { .. }
                | StatementKind::Instance { .. }
                | StatementKind::Reaction { .. }
                | StatementKind::Constraint { .. }
                | StatementKind::Shape { .. }
                | StatementKind::Output { .. } => {}
            }
        }
    }

    fn note_unit(&mut self, quantity: &Quantity) {
        let Some(unit) = &quantity.unit else { return };
        let (first, behind) = (self.token_at(unit.span.start), self.token_at(unit.span.end));
        self.units.extend(first..behind);
    }

    /// The braces that open at a token.
    fn note_block(&mut self, open: usize) {
        if let Some(Kind::Open('{', close)) = self.tokens.get(open).map(|token| token.kind) {
            self.blocks.extend([open, close]);
            self.beginnings.insert(close);
        }
    }

    /// The braces that a statement ends with.
    fn note_last_block(&mut self, span: &Span) {
        let last = self.token_at(span.end).saturating_sub(1);
        let opens = |token: &Token| matches!(token.kind, Kind::Open('{', close) if close == last);
        let first = self.token_at(span.start);
        if let Some(open) = self.tokens[first..last].iter().position(opens) {
            self.note_block(first + open);
        }
    }

    /// The first token that begins there or later.
    fn token_at(&self, place: usize) -> usize {
        self.tokens.partition_point(|token| token.span().start < place)
    }

    /// The first opening brace there or later.
    fn brace_from(&self, place: usize) -> usize {
        let first = self.token_at(place);
        let brace = self.tokens[first..].iter().position(|token| matches!(token.kind, Kind::Open('{', _)));
        brace.map_or(self.tokens.len(), |brace| first + brace)
    }

    fn text(&self, i: usize) -> &'s str {
        self.tokens.get(i).map_or("", |token| &self.source[token.span()])
    }

    fn is_doc(&self, i: usize) -> bool {
        self.tokens.get(i).is_some_and(|token| token.kind == Kind::Doc)
    }

    fn kind(&self, i: usize) -> Option<Kind> {
        self.tokens.get(i).map(|token| token.kind)
    }

    fn opens(&self, i: usize) -> bool {
        matches!(self.kind(i), Some(Kind::Open(..)))
    }

    fn closes(&self, i: usize) -> bool {
        self.kind(i) == Some(Kind::Close)
    }
}

// ---- writing

impl<'s> Layout<'s> {
    fn write(&mut self) {
        let mut end = if self.source.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        for i in 0..=self.tokens.len() {
            let start = self.tokens.get(i).map_or(self.source.len(), |token| token.span().start);
            let (remarks, breaks) = remarks(self.source, end..start);
            let last_of_line = remarks.last().map(|remark| remark.is_of_line);
            let count = remarks.len();
            for (n, remark) in remarks.into_iter().enumerate() {
                self.remark(i, remark, n == 0, n + 1 == count && breaks > 0);
            }
            if i < self.tokens.len() {
                self.token(i, breaks, last_of_line);
                end = self.tokens[i].span().end;
            }
        }
    }

    /// A comment before token `i`, the first one there or not; whether a line break follows.
    fn remark(&mut self, i: usize, remark: Remark<'s>, is_first: bool, ends_line: bool) {
        if remark.breaks == 0 && !self.lines.is_empty() {
            let trails = remark.is_of_line || ends_line || self.begins(i);
            let line = self.lines.last_mut().expect("a line is there");
            if trails && line.comment.is_none() {
                let gap = remark.before.chars().rev().take_while(|c| lexer::is_space(*c)).count();
                let column = remark.before.chars().count();
                line.comment = Some(Comment { text: remark.text, gap: gap.max(1), column });
            } else if let Some(comment) = &mut line.comment {
                comment.text += &format!(" {}", remark.text);
            } else {
                line.text += &format!("{}{}", if line.text.is_empty() { "" } else { " " }, remark.text);
            }
            return;
        }
        let indent = match self.begins(i) || i == self.tokens.len() {
            true => STEP * self.depth,
            false if self.is_else(i) => STEP * self.depth,
            false if self.closes(i) => self.brackets.last().map_or(0, |indent| indent + STEP),
            false => self.continued(i),
        };
        let within = is_first && i > 0 && self.blocks.contains(&(i - 1)) && self.opens(i - 1);
        let is_blank = remark.breaks > 1 && !within && (self.begins(i) || i == self.tokens.len());
        let is_behind_blank = is_blank && !self.lines.is_empty();
        self.lines.push(Line { is_behind_blank, is_remark: true, ..Line::new(indent, remark.text) });
    }

    fn token(&mut self, i: usize, breaks: usize, behind_remark_of_line: Option<bool>) {
        let text = match self.kind(i) {
            Some(Kind::Doc) => without_trailing_space(self.text(i)),
            _ => self.text(i).to_string(),
        };
        let closes_block = self.blocks.contains(&i) && self.closes(i);
        let behind_block = i > 0 && self.blocks.contains(&(i - 1));
        if closes_block {
            self.depth -= 1;
        }
        let goes_on = match behind_remark_of_line {
            None => closes_block && behind_block && self.opens(i - 1) || self.is_else(i),
            // A comment before what it is about, on the same line.
            Some(of_line) => !of_line && breaks == 0 && self.lines.last().is_some_and(|line| line.comment.is_none()),
        };
        let is_else = self.is_else(i);
        if (self.begins(i) || is_else) && !goes_on || self.lines.is_empty() {
            let opened = behind_block && self.opens(i - 1) && behind_remark_of_line.is_none();
            let documented = i > 0
                && !["//!", "/*!"].iter().any(|marks| self.text(i - 1).starts_with(marks))
                && self.is_doc(i - 1)
                && !self.is_doc(i)
                && behind_remark_of_line.is_none();
            let is_behind_blank =
                breaks > 1 && !opened && !documented && !closes_block && !is_else && !self.lines.is_empty();
            self.lines.push(Line { is_behind_blank, ..Line::new(STEP * self.depth, text) });
        } else if !self.begins(i) && !goes_on && (breaks > 0 || behind_remark_of_line == Some(true)) {
            let indent = self.continued(i);
            self.lines.push(Line::new(indent, text));
        } else {
            let is_spaced = behind_remark_of_line.is_some() || i > 0 && self.is_spaced(i);
            let addition = self.addition(i);
            let line = self.lines.last_mut().expect("a line is there");
            if is_spaced {
                line.text.push(' ');
            }
            line.addition =
                line.addition.take().or(addition.map(|addition| Addition { at: line.text.len(), ..addition }));
            line.text += &text;
            line.is_remark = false;
        }
        if self.begins(i) {
            self.brackets.clear();
            // `+=` behind a comment is in no column.
            let is_first = self.lines.last().is_some_and(|line| line.text.len() == self.text(i).len());
            self.statement = (self.tokens[i].span().start, if is_first { self.lines.len() } else { 0 });
        } else if self.closes(i) && !closes_block {
            self.brackets.pop();
        }
        if self.blocks.contains(&i) {
            self.depth += usize::from(self.opens(i));
        } else if self.opens(i) {
            self.brackets.push(self.lines.last().map_or(0, |line| line.indent));
        }
    }

    /// The `else` of a statement.
    fn is_else(&self, i: usize) -> bool {
        self.text(i) == "else" && i > 0 && self.blocks.contains(&(i - 1))
    }

    fn begins(&self, i: usize) -> bool {
        self.beginnings.contains(&i)
    }

    /// Where a line begins on which a statement goes on.
    fn continued(&self, i: usize) -> usize {
        match self.brackets.last() {
            Some(&opened) if self.closes(i) => opened,
            Some(&opened) if self.opens(i - 1) || self.text(i - 1) == "," => opened + STEP,
            Some(&opened) => opened + 2 * STEP,
            None => STEP * (self.depth + 1),
        }
    }

    /// `+=` on the line that its statement begins.
    fn addition(&self, i: usize) -> Option<Addition> {
        let (start, line) = self.statement;
        if self.text(i) != "+=" || line != self.lines.len() {
            return None;
        }
        let before = self.source.get(start..self.tokens[i].span().start)?;
        let padding = before.chars().rev().take_while(|c| lexer::is_space(*c)).count();
        Some(Addition { at: 0, column: before.chars().count(), is_padded: padding > 1 })
    }
}

// ---- spaces

impl Layout<'_> {
    /// Whether a space stands between a token and the one before it, on one line.
    fn is_spaced(&self, i: usize) -> bool {
        let (before, text) = (self.text(i - 1), self.text(i));
        // `2. ..` would be `2 ...`.
        if before.ends_with('.') && before.len() > 1 && text.starts_with('.') && self.kind(i - 1) == Some(Kind::Number)
        {
            return true;
        }
        match (before, text) {
            (_, "," | ";" | ":" | ")" | "]" | "." | ".." | "^") | ("(" | "[" | "." | ".." | "^" | "#", _) => false,
            ("{", "}") => false,
            _ if self.is_prefix(i - 1) => false,
            (_, "*" | "/") => self.is_wide(i),
            ("*" | "/", _) => self.is_wide(i - 1),
            (_, "(" | "[") => match self.kind(i - 1) {
                Some(Kind::Word) => self.is_keyword(i - 1),
                Some(Kind::Close) => false,
                _ => true,
            },
            _ => true,
        }
    }

    /// A sign that stands before its only operand.
    fn is_prefix(&self, i: usize) -> bool {
        if !matches!(self.text(i), "-" | "!") {
            return false;
        }
        match i.checked_sub(1).and_then(|before| self.kind(before)) {
            Some(Kind::Word) => self.is_keyword(i - 1),
            Some(Kind::Number | Kind::Close | Kind::Path) => false,
            Some(Kind::Sign(_) | Kind::Open(..) | Kind::Doc) | None => true,
        }
    }

    /// A word behind which a value begins.
    fn is_keyword(&self, i: usize) -> bool {
        match self.text(i) {
            "if" | "in" | "else" => true,
            "at" => i > 0 && self.text(i - 1) == "force",
            "on" => i > 0 && self.text(i - 1) == "torque",
            "gravity" => self.fields.contains(&i),
            _ => false,
        }
    }

    /// Whether spaces stand around `*` or `/`: if on one side at least.
    fn is_wide(&self, i: usize) -> bool {
        let end = |i: usize| self.tokens[i].span().end;
        let start = |i: usize| self.tokens.get(i).map_or(self.source.len(), |token| token.span().start);
        !self.units.contains(&i) && (end(i - 1) < start(i) || end(i) < start(i + 1))
    }
}

// ---- comments

/// The comments of a text that holds nothing else but white space, and the line breaks behind the last one.
fn remarks(source: &str, gap: Span) -> (Vec<Remark<'_>>, usize) {
    let (mut found, mut breaks, mut at) = (Vec::new(), 0, gap.start);
    while let Some(c) = source[at..gap.end].chars().next() {
        let rest = &source[at..gap.end];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            lexer::block_comment_length(rest.as_bytes()).unwrap_or(rest.len())
        } else {
            breaks += usize::from(c == '\n');
            at += c.len_utf8();
            continue;
        };
        let before = &source[source[..at].rfind('\n').map_or(0, |newline| newline + 1)..at];
        let text = without_trailing_space(&rest[..length]);
        found.push(Remark { text, start: at, breaks, is_of_line: rest.starts_with("//"), before });
        (at, breaks) = (at + length, 0);
    }
    if let Some(first) =
        found.first_mut().filter(|first| source[..first.start].trim_start_matches('\u{feff}').trim().is_empty())
    {
        first.breaks = first.breaks.max(1);
    }
    (found, breaks)
}

/// Each line without the white space that it ends with.
fn without_trailing_space(text: &str) -> String {
    text.split('\n').map(str::trim_end).collect::<Vec<_>>().join("\n")
}
