//! Text → tokens, and what is wrong with characters, comments, quotation marks and brackets.
//!
//! Outside comments and the paths of imports only ASCII without quotes becomes tokens. Brackets know the one that
//! closes them, so that nothing needs to search for it.

use super::lookalike::{is_lookalike, meant, transliterated};
use super::syntax::Span;
use super::{MAX_DEPTH, MAX_TOKENS};
use crate::diagnostic::{Code, Diagnostics};
use crate::source::MAX_BYTES;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name or a keyword: `mass`, `param`.
    Word,
    /// Digits and what is written against them: `1.5e-3`, `2kg`, `0x10`.
    Number,
    /// The path behind `import` or in `mesh(…)`, with its quotation marks.
    Path,
    /// A comment of documentation.
    Doc,
    /// The longest sign that can be read: `+`, `+=`.
    Sign(&'static str),
    /// An opening bracket, and which token closes it.
    Open(char, usize),
    /// A closing bracket.
    Close,
}

/// One token, and where it stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token {
    pub(super) kind: Kind,
    /// Four bytes each: no file is larger than [`MAX_BYTES`].
    start: u32,
    end: u32,
}

impl Token {
    pub(super) fn span(self) -> Span {
        self.start as usize..self.end as usize
    }
}

/// Cuts a text into tokens.
///
/// # Errors
/// What in it is no token of the language, and brackets that do not match.
pub(super) fn tokens(source: &str) -> Result<Vec<Token>, Diagnostics> {
    let (tokens, errors) = cut(source);
    errors.finish(tokens)
}

/// Cuts a text into tokens as far as that can be done; the rest are errors.
pub(super) fn cut(source: &str) -> (Vec<Token>, Diagnostics) {
    let (tokens, errors) = (Vec::new(), Diagnostics::default());
    let mut lexer = Lexer { source, at: 0, tokens, open: Vec::new(), counted: (0, 0), errors };
    if source.len() > MAX_BYTES {
        lexer.errors.error(Code::TooLong, 0..0, "this file is larger than 64 MiB").help("write one mechanism a file");
    } else {
        lexer.file();
    }
    (lexer.tokens, lexer.errors)
}

struct Lexer<'s> {
    source: &'s str,
    /// How far the text has been looked at; always where a character begins.
    at: usize,
    tokens: Vec<Token>,
    /// The opening brackets that are not closed, as tokens.
    open: Vec<usize>,
    /// The lines that end before an offset; counted so far.
    counted: (usize, usize),
    errors: Diagnostics,
}

impl<'s> Lexer<'s> {
    fn file(&mut self) {
        self.at += if self.source.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        if let Some(at) = self.source.find('\r').filter(|_| !self.source.contains('\n')) {
            // A `//` would reach to the end of the file.
            let error =
                self.errors.error(Code::LineEnds, at..at + 1, "the lines of this file end with carriage returns alone");
            error.help("save it with line feeds, `\\n` or `\\r\\n`");
            return;
        }
        while let Some(c) = self.rest().chars().next() {
            if self.errors.is_full() {
                return;
            }
            match c {
                '/' if self.rest().starts_with("//") => self.line_comment(),
                '/' if self.rest().starts_with("/*") => self.block_comment(),
                '"' if self.imports() => self.path(),
                '"' => self.quotation(self.at, 1, "\"", true),
                '\'' => self.apostrophe(),
                '(' | '[' | '{' if self.open.len() == MAX_DEPTH => return self.too_deep(),
                '(' | '[' | '{' => self.opening(c),
                ')' | ']' | '}' => self.closing(c),
                ';' => self.semicolon(),
                '0'..='9' => self.number(),
                c if begins_word(c) => self.word(),
                c if is_space(c) => self.at += c.len_utf8(),
                c => match self.sign() {
                    Some(sign) => self.push(Kind::Sign(sign), sign.len()),
                    None => self.stranger(c),
                },
            }
            if self.tokens.len() > MAX_TOKENS {
                return self.too_many();
            }
        }
        if let Some(&innermost) = self.open.last() {
            self.report_unclosed(innermost, "the end of the file");
        }
    }

    fn rest(&self) -> &'s str {
        &self.source[self.at..]
    }

    /// The next `length` bytes as one token.
    fn push(&mut self, kind: Kind, length: usize) {
        let start = self.at;
        self.at += length;
        self.tokens.push(Token { kind, start: start as u32, end: self.at as u32 });
    }

    fn too_many(&mut self) {
        let start = self.tokens[MAX_TOKENS].span().start;
        let message = format!("this file is longer than {MAX_TOKENS} names, numbers and signs");
        self.errors
            .error(Code::TooLong, start..start + 1, message)
            .help("write sums as loops, and leave tables to the program that uses them");
    }

    fn line_comment(&mut self) {
        let line = self.rest().split_inclusive('\n').next().unwrap_or_default();
        let text = line.strip_suffix("\r\n").or(line.strip_suffix('\n')).unwrap_or(line);
        let documents = (text.starts_with("///") && !text.starts_with("////")) || text.starts_with("//!");
        match documents {
            true => self.documentation(text),
            false => self.at += line.len(),
        }
    }

    fn block_comment(&mut self) {
        let Some(length) = block_comment_length(self.rest().as_bytes()) else {
            let error = self.errors.error(Code::Unclosed, self.at..self.at + 2, "this comment is never closed");
            error.help("write `*/` where it ends");
            return self.give_up();
        };
        let text = &self.rest()[..length];
        let plain = text == "/**/" || text.starts_with("/***");
        match !plain && (text.starts_with("/**") || text.starts_with("/*!")) {
            true => self.documentation(text),
            false => self.at += length,
        }
    }

    /// Where text is not closed, whatever else is open or wrong may be meant as part of it.
    fn give_up(&mut self) {
        self.open.clear();
        self.at = self.source.len();
    }

    fn documentation(&mut self, text: &str) {
        if let Some((i, _)) = text.match_indices('\r').find(|(i, _)| !text[i + 1..].starts_with('\n')) {
            let message = "a carriage return without a line feed stands in this documentation comment";
            self.errors
                .error(Code::LineEnds, self.at + i..self.at + i + 1, message)
                .help("end its lines with `\\n` or `\\r\\n`");
        }
        self.push(Kind::Doc, text.len());
    }

    /// Quoted text that begins at `start` and whose opening quote is the `opening` bytes from here on.
    fn quotation(&mut self, start: usize, opening: usize, closing: &str, escapes: bool) {
        self.at += opening;
        let length = quotation_length(self.rest(), closing, escapes);
        let (message, help) = match length {
            Some(length) => {
                self.at += length;
                ("quoted text has no meaning in a mechanism", "write a comment after `//`, documentation after `///`")
            }
            None => ("this quotation mark is never closed", "leave it out: quoted text has no meaning in a mechanism"),
        };
        self.errors.error(Code::QuotedText, start..self.at, message).help(help);
        if length.is_none() {
            self.give_up();
        }
    }

    /// Whether a path is expected here: before this place stands `import` or `mesh(`.
    fn imports(&self) -> bool {
        let before = self.source[..self.at].trim_end();
        let mesh = || before.strip_suffix('(').and_then(|before| before.trim_end().strip_suffix("mesh"));
        before.strip_suffix("import").or_else(mesh).is_some_and(|before| !before.ends_with(continues_word))
    }

    /// What is quoted behind `import`, on one line and without what only some systems write in a path.
    fn path(&mut self) {
        let line = self.rest()[1..].split('\n').next().unwrap_or_default();
        let Some(length) = line.find('"') else {
            let error = self.errors.error(Code::Unclosed, self.at..self.at + 1, "this quotation mark is never closed");
            error.help("write `\"` behind the path");
            return self.at += 1 + line.len();
        };
        let start = self.at + 1;
        for (i, c) in line[..length].char_indices().filter(|(_, c)| *c == '\\' || c.is_control()) {
            let error =
                self.errors.error(Code::ImportPath, start + i..start + i + c.len_utf8(), "this cannot stand in a path");
            error.help(if c == '\\' { "write `/` between folders" } else { "leave it out" });
        }
        self.push(Kind::Path, length + 2);
    }

    /// `'x'` is quoted text; any other `'` was probably meant as a derivative.
    fn apostrophe(&mut self) {
        let quoted = self.rest()[1..].split(['\'', '\n']).next().unwrap_or_default();
        let closed = self.rest()[1 + quoted.len()..].starts_with('\'');
        if closed && self.imports() {
            let place = self.at..self.at + quoted.len() + 2;
            let shown = if quoted.contains(['"', '\\']) { "file.mbs" } else { quoted };
            let error = self.errors.error(Code::ImportPath, place.clone(), "a path stands in double quotation marks");
            error.help(match self.source[..place.start].trim_end().ends_with('(') {
                true => format!("write `mesh(\"{shown}\")`"),
                false => format!("write `import \"{shown}\";`"),
            });
            self.at = place.end;
            return;
        }
        if closed && (quoted.chars().count() == 1 || quoted.starts_with('\\')) {
            return self.quotation(self.at, 1, "'", true);
        }
        let error =
            self.errors.error(Code::ForeignCharacter, self.at..self.at + 1, "`'` has no meaning in a mechanism");
        error.help("write `dt(x)` for the time derivative of `x`");
        self.at += 1;
    }

    fn too_deep(&mut self) {
        let error = self.errors.error(
            Code::TooDeep,
            self.at..self.at + 1,
            format!("this is nested deeper than {MAX_DEPTH} levels"),
        );
        error.help("name the inner values with `let`");
    }

    fn opening(&mut self, bracket: char) {
        self.open.push(self.tokens.len());
        // Which token closes it is known there.
        self.push(Kind::Open(bracket, 0), 1);
    }

    fn closing(&mut self, close: char) {
        let (here, token) = (self.at, self.tokens.len());
        self.push(Kind::Close, 1);
        let matching = self.open.iter().rposition(|&open| closer(self.bracket(open)) == close);
        // Within braces `)` and `]` belong to brackets within the same braces.
        let braces = self.open.iter().rposition(|&open| self.bracket(open) == '{');
        let innermost = self.open.last().copied();
        match (matching, innermost) {
            (Some(matching), Some(innermost)) if braces <= Some(matching) => {
                if matching + 1 < self.open.len() {
                    let place = self.place(here);
                    self.report_unclosed(innermost, &format!("the `{close}` {place}"));
                }
                if let Kind::Open(_, partner) = &mut self.tokens[self.open[matching]].kind {
                    *partner = token;
                }
                self.open.truncate(matching);
            }
            (_, Some(innermost)) if braces.is_none_or(|i| i + 1 < self.open.len()) => {
                let (open, place) = (self.bracket(innermost), self.place(here));
                let start = self.tokens[innermost].span();
                let error = self.errors.error(Code::Brackets, start, format!("this `{open}` is closed by a `{close}`"));
                error.help(format!("write `{}` instead of the `{close}` {place}", closer(open)));
                self.open.pop();
            }
            _ => {
                let error = self.errors.error(Code::Brackets, here..here + 1, format!("this `{close}` closes nothing"));
                error.help("leave it out, or write what it is to close");
            }
        }
    }

    /// No parenthesis or bracket goes on over the end of a statement.
    fn semicolon(&mut self) {
        let here = self.at;
        self.push(Kind::Sign(";"), 1);
        let Some(&innermost) = self.open.last() else { return };
        let open = self.bracket(innermost);
        let line = self.rest().split([';', '\n']).next().unwrap_or_default();
        if open == '{' || line.contains(closer(open)) {
            return;
        }
        let place = self.place(here);
        self.report_unclosed(innermost, &format!("the `;` {place}"));
        let braces = self.open.iter().rposition(|&open| self.bracket(open) == '{');
        self.open.truncate(braces.map_or(0, |braces| braces + 1));
    }

    fn report_unclosed(&mut self, open: usize, before: &str) {
        let (bracket, here) = (self.bracket(open), self.tokens[open].span());
        let error = self.errors.error(Code::Brackets, here, format!("this `{bracket}` is not closed"));
        error.help(format!("write `{}` before {before}", closer(bracket)));
    }

    fn bracket(&self, open: usize) -> char {
        char::from(self.source.as_bytes()[self.tokens[open].span().start])
    }

    /// "on line 3", for the help of a message about another place. Places are asked for in source order.
    fn place(&mut self, at: usize) -> String {
        let (before, lines) = self.counted;
        self.counted = (at, lines + self.source[before..at].matches('\n').count());
        format!("on line {}", self.counted.1 + 1)
    }

    /// `1.5e-3kg`: digits, decimals, an exponent, and the letters and digits behind it.
    fn number(&mut self) {
        let text = self.rest();
        let run =
            |from: usize, is_part: fn(char) -> bool| text[from..].find(|c| !is_part(c)).unwrap_or(text.len() - from);
        let is_digit = |c: char| c.is_ascii_digit() || c == '_';
        let mut end = run(0, is_digit);
        let point = text[end..].strip_prefix('.');
        // `1.sin()` and `0..n` are a number and what follows it.
        if point.is_some_and(|behind| !behind.starts_with(|c: char| c == '.' || begins_word(c))) {
            end += 1 + run(end + 1, is_digit);
        }
        if let Some(exponent) = text[end..].strip_prefix(['e', 'E']) {
            let signed = usize::from(exponent.starts_with(['+', '-']));
            if exponent[signed..].starts_with(|c: char| c.is_ascii_digit()) {
                end += 1 + signed + run(end + 1 + signed, is_digit);
            }
        }
        self.push(Kind::Number, end + run(end, |c| c.is_ascii_alphanumeric() || c == '_'));
    }

    fn word(&mut self) {
        let (start, text) = (self.at, self.rest());
        let length = |text: &str| text.find(|c| !continues_word(c)).unwrap_or(text.len());
        let word = &text[..length(text)];
        let behind = &text[word.len()..];
        let hashes = behind.len() - behind.trim_start_matches('#').len();
        if matches!(word, "r" | "br" | "cr") && behind[hashes..].starts_with('"') {
            self.at += word.len();
            return self.quotation(start, hashes + 1, &format!("\"{}", "#".repeat(hashes)), false);
        }
        // A keyword of Rust as a name, `r#type`, is one token to be refused.
        let raw = word == "r" && hashes == 1 && behind[1..].starts_with(begins_word);
        let length = if raw { 2 + length(&behind[1..]) } else { word.len() };
        self.push(Kind::Word, length);
        if !word.is_ascii() {
            let error = self.errors.error(
                Code::ForeignCharacter,
                start..self.at,
                "names are made of ASCII letters, digits and `_`",
            );
            error.help(match transliterated(&self.source[..start], word) {
                Some(ascii) => format!("write `{ascii}`"),
                None => "write it in Latin letters without accents".to_string(),
            });
        }
    }

    /// The longest sign that can be read here.
    fn sign(&self) -> Option<&'static str> {
        let rest = self.rest();
        let short = || SIGNS.iter().find(|sign| rest.starts_with(**sign));
        LONG_SIGNS.iter().find(|sign| rest.starts_with(**sign)).or_else(short).copied()
    }

    fn stranger(&mut self, c: char) {
        if c == '\0' {
            let span = self.at..self.at + 1;
            let error =
                self.errors.error(Code::NotText, span, "this is not the text of a mechanism: a zero byte stands here");
            error.help("is it the right file, saved as UTF-8?");
            return self.give_up();
        }
        let (span, help) = meant(self.source, self.at);
        self.at = span.end;
        let shown = if c.is_control() { format!("U+{:04X}", u32::from(c)) } else { c.to_string() };
        let message = format!("the character `{shown}` has no meaning in a mechanism");
        self.errors.error(Code::ForeignCharacter, span, message).help(help);
    }
}

/// Signs of several characters; of two that begin alike the longer one comes first.
const LONG_SIGNS: [&str; 16] =
    ["..=", "..", "**", "+=", "-=", "*=", "/=", "==", "!=", "<=", ">=", "->", "=>", "&&", "||", "::"];

/// Signs of one character, brackets and quotes aside.
const SIGNS: [&str; 21] =
    ["+", "-", "*", "/", "^", "=", ".", ",", ";", ":", "#", "!", "<", ">", "%", "&", "|", "@", "$", "~", "?"];

fn begins_word(c: char) -> bool {
    c == '_' || (c.is_alphabetic() && !is_lookalike(c))
}

/// Combining marks are part of the letter before them.
fn continues_word(c: char) -> bool {
    c == '_' || matches!(c, '\u{300}'..='\u{36f}') || (c.is_alphanumeric() && !is_lookalike(c))
}

/// What is skipped: white space, and the marks that set the direction of writing.
pub(super) fn is_space(c: char) -> bool {
    c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}')
}

fn closer(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// Comments nest.
pub(super) fn block_comment_length(text: &[u8]) -> Option<usize> {
    let (mut depth, mut end) = (0, 0);
    loop {
        match text[end..] {
            [b'/', b'*', ..] => (depth, end) = (depth + 1, end + 2),
            [b'*', b'/', ..] => (depth, end) = (depth - 1, end + 2),
            [_, ..] => end += 1,
            [] => return None,
        }
        if depth == 0 {
            return Some(end);
        }
    }
}

/// How much is quoted, the closing quote included.
fn quotation_length(text: &str, closing: &str, escapes: bool) -> Option<usize> {
    let mut end = 0;
    while end < text.len() {
        let escaped = escapes && text.as_bytes()[end] == b'\\';
        if text.as_bytes()[end..].starts_with(closing.as_bytes()) {
            return Some(end + closing.len());
        }
        end += if escaped { 2 } else { 1 };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every message with the text that it points at: `text: message; help`.
    fn report(source: &str) -> Vec<String> {
        let errors = tokens(source).err().unwrap_or_default();
        let line = |m: &crate::diagnostic::Diagnostic| {
            format!("{}..{}: {}; {}", m.span.start, m.span.end, m.message, m.help.as_deref().unwrap_or("no help"))
        };
        errors.iter().map(line).collect()
    }

    fn accepted(source: &str) {
        assert_eq!(report(source), [""; 0], "{source}");
    }

    #[test]
    fn plain_text_passes() {
        accepted("");
        accepted("\u{feff}mechanism A { let x = [1.5e-3, f(a[2])]; }");
        accepted("a ~ ! @ # $ % ^ & * - = + | ; : , < . > / ?\u{a0}\u{200e}b");
        accepted("[0; 3]");
    }

    #[test]
    fn comments_hold_anything() {
        accepted("// it's ((( \" θ\nx");
        accepted("/// q̇ {{{");
        accepted("/* /* ( */ \" ' */ /**/ /***/ /****/ x");
        accepted("/** ( */ /*! [ */ //! {");
        accepted("// carriage \r return\r\n/* \r */ /// doc\r\n");
        accepted("x // \"");
    }

    #[test]
    fn open_comments_are_reported_where_they_begin() {
        assert_eq!(report("x { /* a /* b */"), ["4..6: this comment is never closed; write `*/` where it ends"]);
        assert_eq!(report("/*/"), ["0..2: this comment is never closed; write `*/` where it ends"]);
        assert_eq!(report("/*").len(), 1);
        assert_eq!(report("/// a\rb").len(), 1);
        assert_eq!(report("/// a\r").len(), 1);
        assert_eq!(report("/** a\rb */").len(), 1);
    }

    #[test]
    fn brackets_are_reported_where_they_open() {
        let check = |source: &str, expected: &str| assert_eq!(report(source), [expected], "{source}");
        check("a { b", "2..3: this `{` is not closed; write `}` before the end of the file");
        check("{ let x = (a + b; }", "10..11: this `(` is not closed; write `)` before the `;` on line 1");
        check("{\n\nf(a[1); }", "6..7: this `[` is not closed; write `]` before the `)` on line 3");
        check("{ f(a }", "3..4: this `(` is not closed; write `)` before the `}` on line 1");
        check("{ f(a]; }", "3..4: this `(` is closed by a `]`; write `)` instead of the `]` on line 1");
        check("( }", "0..1: this `(` is closed by a `}`; write `)` instead of the `}` on line 1");
        check("{ a); }", "3..4: this `)` closes nothing; leave it out, or write what it is to close");
        check("} x", "0..1: this `}` closes nothing; leave it out, or write what it is to close");
        assert_eq!(report("{ f(a; g[b; h(c }").len(), 3);
    }

    #[test]
    fn quotes_are_refused_but_skipped() {
        let quoted = "quoted text has no meaning in a mechanism; write a comment after `//`, documentation after `///`";
        let check = |source: &str, place: &str| assert_eq!(report(source), [format!("{place}: {quoted}")], "{source}");
        check("\"(((\" x", "0..5");
        check("\"a\\\"(\"", "0..6");
        check("'(' x", "0..3");
        check("'\\'' x", "0..4");
        check("r\"\\\" x", "0..4");
        check("r##\"(\"# (\"## x", "0..12");
        check("\"θ\" x", "0..4");
        assert_eq!(report("\"abc").len(), 1);
        assert_eq!(report("\"abc\\").len(), 1);
        assert_eq!(
            report("x'"),
            ["1..2: `'` has no meaning in a mechanism; write `dt(x)` for the time derivative of `x`"]
        );
        assert_eq!(report("r'").len(), 1);
        assert_eq!(report("'a").len(), 1);
    }

    #[test]
    fn paths_in_single_quotes_get_double_ones() {
        let expected = "7..12: a path stands in double quotation marks; write `import \"lib\";`";
        assert_eq!(report("import 'lib'; mechanism A { }"), [expected]);
        assert_eq!(report("import 'l'; x").len(), 1);
        assert_eq!(report("import 'l").len(), 1);
    }

    #[test]
    fn lines_of_carriage_returns_are_refused() {
        let expected = "13..14: the lines of this file end with carriage returns alone; save it with line feeds, `\\n` or `\\r\\n`";
        assert_eq!(report("mechanism A {\r // x\r }"), [expected]);
        accepted("x\r\ny");
        accepted("x\r y\n");
    }

    #[test]
    fn other_alphabets_are_refused_with_what_to_write() {
        let help =
            |source: &str| report(source).iter().map(|r| r.split("; ").last().unwrap().to_string()).collect::<Vec<_>>();
        assert_eq!(help("θ1 + x"), ["write `theta1`"]);
        assert_eq!(help("Δ"), ["write `Delta`"]);
        assert_eq!(help("ω"), ["write `omega`"]);
        assert_eq!(help("q\u{307}"), ["write `dt(q)`"]);
        assert_eq!(help("θ\u{308}"), ["write `dt(dt(theta))`"]);
        assert_eq!(help("kg·m²"), ["write `*`", "write `^2`"]);
        assert_eq!(help("½*x½ + ⅓"), ["write `0.5`", "write a decimal number", "write `(1/3)`"]);
        assert_eq!(help("2π + Ω + 5 Ω + 3 µm"), ["write `*pi`", "write `Omega`", "write `ohm`", "write `um`"]);
        assert_eq!(help("k: N/μm = μm; constraint c: Ω = 0"), ["write `um`", "write `mum`", "write `Omega`"]);
        assert_eq!(
            help("x¹² + y⁻¹ + x²⁻ + x²3"),
            [&["write `^12`", "write `^-1`"], &["write an exponent as in `x^2`"; 2][..]].concat()
        );
        assert_eq!(help("9·81 + 3×2"), ["write `*`, or `.` in a decimal number", "write `*`"]);
        assert_eq!(help("a ≤ b ≠ 30°"), ["write `<=`", "write `!=`", "write `deg`"]);
        assert_eq!(report("10 ¼; 9.81½")[0], "0..5: the character `¼` has no meaning in a mechanism; write `10.25`");
        assert_eq!(help("9.81½; 2⅓; x^2 ½"), ["write a decimal number"; 3]);
        assert_eq!(help("größe"), ["write it in Latin letters without accents"]);
        assert_eq!(help("\u{1} \\ 🦀"), ["leave it out"; 3]);
        assert_eq!(help("(\0 \0"), ["is it the right file, saved as UTF-8?"]);
        assert_eq!(report("x²"), ["1..3: the character `²` has no meaning in a mechanism; write `^2`"]);
    }

    #[test]
    fn the_number_of_tokens_is_limited() {
        let count = |source: &str| tokens(source).map(|tokens| tokens.len()).ok();
        assert_eq!(count("// (1 2)\nlet x1 = f(-2.5e3)[0]; /* a b */"), Some(12));
        assert_eq!(count("/// two words\nx"), Some(2));
        accepted(&"// 0.125, 0.250\n".repeat(MAX_TOKENS + 1));
        accepted(&"x+".repeat(MAX_TOKENS / 2));
        let expected = "1000000..1000001: this file is longer than 1000000 names, numbers and signs; write sums as loops, and \
                        leave tables to the program that uses them";
        assert_eq!(report(&"x+".repeat(10_000_000)), [expected]);
        assert_eq!(report(&"/// x\n".repeat(MAX_TOKENS + 1)).len(), 1);
    }

    #[test]
    fn depth_is_limited() {
        for (open, close) in [("(", ")"), ("[", "]"), ("{", "}")] {
            accepted(&[open.repeat(MAX_DEPTH), close.repeat(MAX_DEPTH)].concat());
            let deep = [open.repeat(MAX_DEPTH + 1), close.repeat(MAX_DEPTH + 1)].concat();
            let expected = "256..257: this is nested deeper than 256 levels; name the inner values with `let`";
            assert_eq!(report(&deep), [expected]);
            assert_eq!(report(&open.repeat(100_000)), [expected]);
        }
    }
}
