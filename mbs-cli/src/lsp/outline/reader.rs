//! Tokens → what a file declares, statement by statement; what cannot be read is passed over.

use std::ops::Range;

use super::{Kind, Outline, Role, Scope, Symbol, Word};

/// What a statement begins with that cannot stand in another one.
const STATEMENTS: [&str; 15] = [
    "param",
    "coord",
    "input",
    "prescribed",
    "const",
    "fn",
    "let",
    "kinetic",
    "potential",
    "dissipation",
    "lagrangian",
    "torque",
    "constraint",
    "output",
    "reaction",
];

pub(super) struct Reader<'t> {
    text: &'t str,
    tokens: Vec<Range<usize>>,
    at: usize,
    scope: usize,
    /// Blocks that are open: their scopes, those of functions aside.
    blocks: Vec<usize>,
    docs: Vec<&'t str>,
    /// Each with the coherent unit that it is a multiple of.
    units: Vec<(String, String)>,
    outline: Outline,
}

// ---- tokens

impl<'t> Reader<'t> {
    fn token(&self, at: usize) -> &'t str {
        self.tokens.get(at).map_or("", |span| &self.text[span.clone()])
    }

    fn is_word(&self, at: usize) -> bool {
        self.token(at).starts_with(|c: char| c == '_' || c.is_alphabetic())
    }

    fn is_doc(&self, at: usize) -> bool {
        ["///", "//!", "/**", "/*!"].iter().any(|marks| self.token(at).starts_with(marks))
    }

    fn span(&self, at: usize) -> Range<usize> {
        self.tokens.get(at).cloned().unwrap_or(self.text.len()..self.text.len())
    }

    fn begins_line(&self, at: usize) -> bool {
        let before = at.checked_sub(1).map_or(0, |before| self.span(before).end);
        self.text[before..self.span(at).start].contains('\n')
    }

    /// Takes a word in a role.
    fn take(&mut self, role: Role) {
        let (span, scope) = (self.span(self.at), self.scope);
        self.outline.words.push(Word { span, role, scope });
        self.at += 1;
    }

    fn keyword(&mut self) {
        self.take(Role::Keyword);
    }

    /// Takes a name that is declared; `first` is the first token of its statement.
    fn declare(&mut self, kind: Kind, first: usize) -> Option<usize> {
        if !self.is_word(self.at) {
            return None;
        }
        let (symbol, span) = (self.outline.symbols.len(), self.span(self.at));
        let statement = self.span(first).start..span.end;
        let docs = match kind {
            Kind::Argument | Kind::Loop => String::new(),
            _ => self.docs.iter().map(|doc| documentation(doc)).collect::<Vec<_>>().join("\n"),
        };
        let name = self.token(self.at).to_string();
        let (scope, body, part, has_unit) = (self.scope, None, None, false);
        self.outline.symbols.push(Symbol { name, kind, span, statement, docs, scope, body, part, has_unit });
        self.take(Role::Declared(symbol));
        Some(symbol)
    }

    fn enter(&mut self, is_body: bool) {
        let start = self.span(self.at).start;
        self.outline.scopes.push(Scope { parent: self.scope, span: start..self.text.len(), is_body });
        self.scope = self.outline.scopes.len() - 1;
    }

    fn leave(&mut self) {
        let end = self.at.checked_sub(1).map_or(0, |last| self.span(last).end);
        self.outline.scopes[self.scope].span.end = end;
        self.scope = self.outline.scopes[self.scope].parent;
    }
}

/// A documentation comment without its marks.
fn documentation(comment: &str) -> String {
    let text = comment[3..].strip_suffix("*/").unwrap_or(&comment[3..]);
    let line = |line: &str| {
        let line = if comment.starts_with("/*") { line.trim_start().trim_start_matches('*') } else { line };
        line.strip_prefix(' ').unwrap_or(line).trim_end().to_string()
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n").trim().to_string()
}

// ---- statements

impl<'t> Reader<'t> {
    pub(super) fn new(
        text: &'t str,
        tokens: Vec<Range<usize>>,
        units: Vec<(String, String)>,
        outline: Outline,
    ) -> Self {
        Reader { text, tokens, at: 0, scope: 0, blocks: Vec::new(), docs: Vec::new(), units, outline }
    }

    pub(super) fn read(mut self) -> Outline {
        self.file();
        self.outline
    }
}

impl Reader<'_> {
    fn file(&mut self) {
        while self.at < self.tokens.len() {
            let (first, found) = (self.at, self.outline.symbols.len());
            if self.is_doc(self.at) {
                self.docs.push(&self.text[self.span(self.at)]);
                self.at += 1;
                continue;
            }
            self.statement();
            // Whatever it is, something is taken.
            self.at = self.at.max(first + 1);
            self.docs.clear();
            let end = self.span(self.at - 1).end;
            for symbol in &mut self.outline.symbols[found..] {
                let in_scope = symbol.statement.start == self.tokens[first].start && symbol.kind != Kind::Loop;
                if in_scope {
                    symbol.statement.end = end;
                }
            }
        }
        while let Some(scope) = self.blocks.pop() {
            self.scope = scope;
            self.leave();
            self.end_of(scope);
        }
    }

    fn statement(&mut self) {
        let first = self.at;
        match self.token(first) {
            "}" => {
                self.at += 1;
                if let Some(scope) = self.blocks.pop() {
                    self.scope = scope;
                    self.leave();
                    self.end_of(scope);
                }
            }
            "import" => {
                self.keyword();
                if self.token(self.at).starts_with('"') {
                    self.outline.paths.push(self.span(self.at));
                    self.at += 1;
                }
                self.at += usize::from(self.token(self.at) == ";");
            }
            "mechanism" => {
                self.keyword();
                self.outline.is_mechanism = true;
                let symbol = self.declare(Kind::Mechanism, first);
                if self.block(false)
                    && let Some(symbol) = symbol
                {
                    self.outline.symbols[symbol].body = Some(self.scope);
                }
            }
            "param" => self.quantity(Kind::Parameter),
            "coord" => self.quantity(Kind::Coordinate),
            "input" => self.quantity(Kind::Input),
            "prescribed" => self.quantity(Kind::Prescribed),
            "const" => self.quantity(Kind::Constant),
            "let" => {
                self.keyword();
                if self.token(self.at) == "mut" {
                    self.keyword();
                }
                self.declare(Kind::Local, first);
                self.rest();
            }
            "fn" => self.function(),
            "part" if self.is_word(first + 1) && self.token(first + 2) == "(" => self.part(),
            "for" => self.repetition(),
            "if" => {
                self.keyword();
                self.expression(true);
                self.block(false);
            }
            "else" => {
                self.keyword();
                if self.token(self.at) == "if" {
                    self.keyword();
                    self.expression(true);
                }
                self.block(false);
            }
            "kinetic" | "potential" | "dissipation" | "lagrangian" => {
                self.keyword();
                self.rest();
            }
            "force" | "torque" => {
                self.keyword();
                if matches!(self.token(self.at), "at" | "on") {
                    self.keyword();
                }
                self.rest();
            }
            "output" => self.named(Kind::Output),
            "constraint" => self.named(Kind::Constraint),
            "reaction" => self.named(Kind::Reaction),
            "gravity" if !self.is_assignment() => {
                self.keyword();
                self.rest();
            }
            "#" => {
                while self.at < self.tokens.len() && self.token(self.at) != "]" {
                    self.at += 1;
                }
                self.at += 1;
            }
            _ if self.is_word(first) && self.is_word(first + 1) => self.instance(),
            _ => self.rest(),
        }
    }

    /// Whether a name or an element of it is given a value.
    fn is_assignment(&self) -> bool {
        let mut at = self.at + 1;
        while self.token(at) == "[" {
            while at < self.tokens.len() && !matches!(self.token(at), "]" | ";" | "=") {
                at += 1;
            }
            at += usize::from(self.token(at) == "]");
        }
        self.token(at) == "="
    }

    fn quantity(&mut self, kind: Kind) {
        let first = self.at;
        self.keyword();
        let symbol = self.declare(kind, first);
        while self.token(self.at) == "[" {
            self.at += 1;
            self.within("]");
        }
        if self.token(self.at) == ":" {
            self.at += 1;
            if let Some(symbol) = symbol {
                self.outline.symbols[symbol].has_unit = true;
            }
            while self.at < self.tokens.len()
                && !matches!(self.token(self.at), "=" | ";" | "," | "}")
                && !self.is_next()
            {
                match self.is_word(self.at) {
                    true => self.take(Role::Unit),
                    false => self.at += 1,
                }
            }
        }
        self.rest();
    }

    fn named(&mut self, kind: Kind) {
        let first = self.at;
        self.keyword();
        self.declare(kind, first);
        self.rest();
    }

    fn function(&mut self) {
        let first = self.at;
        self.keyword();
        let symbol = self.declare(Kind::Function, first);
        self.enter(true);
        if let Some(symbol) = symbol {
            self.outline.symbols[symbol].body = Some(self.scope);
        }
        self.arguments(first);
        self.rest();
        self.leave();
    }

    fn part(&mut self) {
        let first = self.at;
        self.keyword();
        let symbol = self.declare(Kind::Part, first);
        self.enter(true);
        let own = self.scope;
        if let Some(symbol) = symbol {
            self.outline.symbols[symbol].body = Some(own);
        }
        self.arguments(first);
        if self.token(self.at) == "{" {
            self.at += 1;
            self.blocks.push(own);
        } else {
            self.leave();
        }
    }

    /// A part and a mechanism end where their braces do.
    fn end_of(&mut self, scope: usize) {
        let end = self.span(self.at - 1).end;
        for symbol in &mut self.outline.symbols {
            if symbol.body == Some(scope) {
                symbol.statement.end = end;
            }
        }
    }

    /// `(x, y)`
    fn arguments(&mut self, first: usize) {
        if self.token(self.at) != "(" {
            return;
        }
        self.at += 1;
        while self.at < self.tokens.len() && !matches!(self.token(self.at), ")" | "=" | ";" | "{" | "}") {
            if self.declare(Kind::Argument, first).is_none() {
                self.at += 1;
            }
        }
        self.at += usize::from(self.token(self.at) == ")");
    }

    fn repetition(&mut self) {
        let first = self.at;
        self.keyword();
        // Its range is of the block around it; the name is of its own.
        let name = self.at;
        self.at += usize::from(self.is_word(name));
        let place = self.outline.words.len();
        if self.token(self.at) == "in" {
            self.keyword();
        }
        self.expression(true);
        let behind = self.at;
        if self.block(false) && self.is_word(name) {
            let after = std::mem::replace(&mut self.at, name);
            let words = self.outline.words.split_off(place);
            self.declare(Kind::Loop, first);
            self.outline.words.extend(words);
            self.at = after;
        } else {
            self.at = behind;
        }
    }

    fn instance(&mut self) {
        let first = self.at;
        let part = self.token(first).to_string();
        self.take(Role::Part);
        if let Some(symbol) = self.declare(Kind::Instance, first) {
            self.outline.symbols[symbol].part = Some(part);
        }
        self.rest();
    }

    /// `{`, if it stands here.
    fn block(&mut self, is_body: bool) -> bool {
        if self.token(self.at) != "{" {
            return false;
        }
        self.enter(is_body);
        self.blocks.push(self.scope);
        self.at += 1;
        true
    }

    /// The rest of a statement with its semicolon.
    fn rest(&mut self) {
        self.expression(false);
        self.at += usize::from(self.token(self.at) == ";");
    }

    /// Whether another statement begins here, though the one before has no end.
    fn is_next(&self) -> bool {
        self.begins_line(self.at) && STATEMENTS.contains(&self.token(self.at)) || self.is_doc(self.at)
    }

    /// Words and signs up to a semicolon, or to the brace of a block.
    fn expression(&mut self, ends_at_brace: bool) {
        let first = self.at;
        // Brackets that are open, and blocks of values that an `if` still needs.
        let (mut open, mut needed): (Vec<&str>, usize) = (Vec::new(), 0);
        while self.at < self.tokens.len() {
            if self.at > first && self.is_next() {
                return;
            }
            let token = &self.text[self.span(self.at)];
            match token {
                // Nothing goes on over the end of a statement.
                ";" => return,
                "{" if needed == 0 => {
                    if ends_at_brace || open.is_empty() {
                        return;
                    }
                    open.push(token);
                    self.at += 1;
                }
                "{" => {
                    needed -= 1;
                    open.push(token);
                    self.at += 1;
                }
                "(" | "[" => {
                    open.push(token);
                    self.at += 1;
                }
                "}" if !open.contains(&"{") => return,
                ")" | "]" | "}" => {
                    open.pop();
                    self.at += 1;
                }
                "if" => {
                    needed += if self.at > 0 && self.token(self.at - 1) == "else" { 1 } else { 2 };
                    self.keyword();
                }
                "else" | "in" => self.keyword(),
                _ if self.is_word(self.at) => self.word(),
                _ => self.at += 1,
            }
        }
    }

    /// Up to a closing bracket.
    fn within(&mut self, close: &str) {
        while self.at < self.tokens.len() && !matches!(self.token(self.at), ";" | "{" | "}") {
            if self.token(self.at) == close {
                self.at += 1;
                return;
            }
            match self.is_word(self.at) {
                true => self.word(),
                false => self.at += 1,
            }
        }
    }

    fn word(&mut self) {
        let (at, next) = (self.at, self.token(self.at + 1));
        let before = if at > 0 { self.token(at - 1) } else { "" };
        if before == "." {
            let chain = self.chain();
            return self.take(Role::Member(chain));
        }
        if self.is_unit() {
            return self.take(Role::Unit);
        }
        let behind = matches!(before, "," | "]") || self.is_word(at.wrapping_sub(1));
        match self.token(at) {
            "positive" | "jacobian_rate" if before == "," && matches!(next, ";" | "") => self.keyword(),
            "at" if behind && before != "," => self.keyword(),
            _ if next == "(" => self.take(Role::Called),
            _ => self.take(Role::Value),
        }
    }

    /// A unit behind a number, or behind another unit of the same number without a blank.
    fn is_unit(&self) -> bool {
        let (at, word) = (self.at, self.token(self.at));
        if at == 0 || self.coherent(word).is_none() {
            return false;
        }
        let is_applied = matches!(self.token(at + 1), "(" | "[") || self.token(at + 1) == "." && self.is_word(at + 2);
        if is_applied {
            return false;
        }
        if self.token(at - 1).starts_with(|c: char| c.is_ascii_digit()) {
            return !self.begins_line(at);
        }
        // `kg*m^2/s`: back over the exponent of the unit before.
        let joined = |i: usize| i > 0 && self.span(i - 1).end == self.span(i).start;
        if !matches!(self.token(at - 1), "*" | "/") || !joined(at) || !joined(at - 1) || word == "t" {
            return false;
        }
        let mut last = at - 2;
        while last > 0 && !self.is_word(last) && matches!(self.token(last), ")" | "(" | "-" | "/" | "^")
            || self.is_exponent(last)
        {
            last -= 1;
        }
        let unit = |word: &Word| word.span == self.span(last) && word.role == Role::Unit;
        self.outline.words.last().is_some_and(unit) && !self.repeats(word)
    }

    fn coherent(&self, word: &str) -> Option<&str> {
        self.units.iter().find(|(unit, _)| unit == word).map(|(_, coherent)| coherent.as_str())
    }

    fn is_exponent(&self, at: usize) -> bool {
        at > 1
            && self.token(at).starts_with(|c: char| c.is_ascii_digit())
            && matches!(self.token(at - 1), "^" | "-" | "(" | "/")
    }

    /// A second unit of the same quantity is a name, the `g` of `0.3 kg*g`; that of `m/s/s` or `m*s^-1/s` divides
    /// again. As for the parser, the first unit of the quantity counts.
    fn repeats(&self, word: &str) -> bool {
        let (mut behind, mut repeats) = (self.span(self.at).start, false);
        let divides = |place: usize| self.text[..place].ends_with('/');
        for before in self.outline.words.iter().rev().take_while(|before| before.role == Role::Unit) {
            let (name, between) = (&self.text[before.span.clone()], &self.text[before.span.end..behind]);
            let goes_on =
                matches!(between, "*" | "/") || between.starts_with('^') && !between.contains(char::is_whitespace);
            if !goes_on {
                break;
            }
            if self.coherent(name) == self.coherent(word) {
                let is_below = divides(before.span.start) != between.contains('-');
                repeats = !(name == word && divides(self.span(self.at).start) && is_below);
            }
            behind = before.span.start;
        }
        repeats
    }

    /// The words before the point that comes before this one: `arm`, `tip` of `arm[i].tip.x`.
    fn chain(&self) -> Vec<usize> {
        let mut chain = Vec::new();
        let mut at = self.at;
        while at >= 2 && self.token(at - 1) == "." {
            at -= 2;
            while self.token(at) == "]" && at > 0 {
                let mut depth = 0;
                loop {
                    match self.token(at) {
                        "]" => depth += 1,
                        "[" => depth -= 1,
                        _ => {}
                    }
                    if at == 0 || depth == 0 {
                        break;
                    }
                    at -= 1;
                }
                at = at.saturating_sub(1);
            }
            let place = self.span(at);
            let word = self.outline.words.iter().rposition(|word| word.span == place);
            match word.filter(|_| self.is_word(at)) {
                Some(word) => chain.push(word),
                None => return Vec::new(),
            }
        }
        chain.reverse();
        chain
    }
}
