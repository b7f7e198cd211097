//! Tokens → a tree: by the precedence of operators, each read as Rust reads it. What is not emitted is refused.

use super::super::reading::{Reading, cannot_read, unknown};
use super::super::token::{Kind, Token};
use super::tokens;
use super::tree::{Block, Expression, ExpressionKind, Pattern, PatternKind, Statement};

/// Operators of two operands, those that bind least first.
const LEVELS: [&[&str]; 4] = [&[".."], &["&"], &["+", "-"], &["*", "/"]];

/// The tree of a block's text.
pub(in crate::proofread) fn block(text: &str) -> Reading<Block<'_>> {
    whole(text, Parser::block)
}

/// The tree of an expression's text.
pub(in crate::proofread) fn expression(text: &str) -> Reading<Expression<'_>> {
    whole(text, Parser::expression)
}

fn whole<'t, T>(text: &'t str, read: impl FnOnce(&mut Parser<'t>) -> Reading<T>) -> Reading<T> {
    let mut parser = Parser { source: text, tokens: tokens(text)?, at: 0, is_head: false };
    let tree = read(&mut parser)?;
    if parser.at == parser.tokens.len() { Ok(tree) } else { parser.unknown() }
}

struct Parser<'t> {
    source: &'t str,
    tokens: Vec<Token<'t>>,
    at: usize,
    /// Whether a brace begins the body of a loop, and not the fields of a record.
    is_head: bool,
}

impl<'t> Parser<'t> {
    fn is_next(&self, mark: &str) -> bool {
        self.tokens.get(self.at).is_some_and(|token| token.is(mark))
    }

    fn takes(&mut self, mark: &str) -> bool {
        let is_there = self.is_next(mark);
        self.at += usize::from(is_there);
        is_there
    }

    fn expect(&mut self, mark: &str) -> Reading<()> {
        if self.takes(mark) { Ok(()) } else { self.unknown() }
    }

    fn unknown<T>(&self) -> Reading<T> {
        let some = self.tokens[self.at.saturating_sub(1).min(self.tokens.len())..].iter().take(3);
        unknown(&some.map(|token| token.text).collect::<Vec<_>>().join(" "))
    }

    fn name(&mut self) -> Reading<&'t str> {
        match self.tokens.get(self.at) {
            Some(Token { kind: Kind::Name, text, .. }) => {
                self.at += 1;
                Ok(text)
            }
            _ => self.unknown(),
        }
    }

    /// The text from this token to the last one that was read.
    fn text(&self, from: usize) -> &'t str {
        let end = self.tokens[..self.at].last().map_or(0, |token| token.range().end);
        let start = self.tokens.get(from).map_or(end, |token| token.start);
        self.source.get(start..end).unwrap_or_default()
    }

    /// Parts with commas between them, up to this mark; a comma may be behind the last one.
    fn list<T>(&mut self, close: &str, mut part: impl FnMut(&mut Self) -> Reading<T>) -> Reading<Vec<T>> {
        let mut parts = Vec::new();
        while !self.takes(close) {
            parts.push(part(self)?);
            if !self.is_next(close) {
                self.expect(",")?;
            }
        }
        Ok(parts)
    }

    // ---- statements

    fn block(&mut self) -> Reading<Block<'t>> {
        let is_head = std::mem::take(&mut self.is_head);
        self.expect("{")?;
        let (mut statements, mut value) = (Vec::new(), None);
        while !self.takes("}") {
            if let Some(last) = self.statement(&mut statements)? {
                value = Some(Box::new(last));
                self.expect("}")?;
                break;
            }
        }
        self.is_head = is_head;
        Ok(Block { statements, value })
    }

    /// One statement; or the value that the block ends with.
    fn statement(&mut self, statements: &mut Vec<Statement<'t>>) -> Reading<Option<Expression<'t>>> {
        let start = self.at;
        if self.is_next("{") {
            let block = self.block()?;
            if self.is_next("}") {
                return Ok(Some(Expression { kind: ExpressionKind::Block(block), text: self.text(start) }));
            }
            statements.push(Statement::Block(block));
            return Ok(None);
        }
        let statement = if self.takes("let") {
            self.binding()?
        } else if self.takes("static") {
            let name = self.name()?;
            self.expect(":")?;
            self.type_up_to("=")?;
            Statement::Static(name, self.expression()?)
        } else if self.takes("for") {
            let pattern = self.pattern()?;
            self.expect("in")?;
            self.is_head = true;
            let values = self.expression()?;
            self.is_head = false;
            statements.push(Statement::For(pattern, values, self.block()?));
            return Ok(None);
        } else {
            let expression = self.expression()?;
            if self.is_next("}") {
                return Ok(Some(expression));
            }
            if self.takes("=") {
                Statement::Assign(expression, self.expression()?)
            } else {
                self.expect("?")?;
                Statement::Try(expression)
            }
        };
        self.expect(";")?;
        statements.push(statement);
        Ok(None)
    }

    /// What is behind `let`.
    fn binding(&mut self) -> Reading<Statement<'t>> {
        let start = self.at;
        let mut pattern = self.pattern()?;
        if self.takes(":") {
            let typed = self.type_up_to("=")?;
            if self.is_next(";") {
                return Ok(Statement::Declare(pattern, typed));
            }
            pattern = Pattern { kind: PatternKind::Typed(Box::new(pattern), typed), text: self.text(start) };
        } else {
            self.expect("=")?;
        }
        Ok(Statement::Let(pattern, self.expression()?))
    }

    /// The text of a type, and the mark behind it, which may be missing at the end of a statement.
    fn type_up_to(&mut self, mark: &str) -> Reading<&'t str> {
        let (start, mut depth) = (self.at, 0_usize);
        while let Some(token) = self.tokens.get(self.at) {
            match token.text {
                "[" | "(" => depth += 1,
                "]" | ")" if depth > 0 => depth -= 1,
                text if depth == 0 && (text == mark || text == ";") => {
                    let typed = self.text(start);
                    self.at += usize::from(text == mark);
                    return Ok(typed);
                }
                "{" | "}" => break,
                _ => {}
            }
            self.at += 1;
        }
        self.unknown()
    }

    // ---- patterns

    fn pattern(&mut self) -> Reading<Pattern<'t>> {
        let start = self.at;
        let kind = if self.takes("_") {
            PatternKind::Wild
        } else if self.takes("mut") {
            PatternKind::Name(self.name()?, true)
        } else if self.takes("[") {
            let (parts, rest) = self.patterns("]")?;
            PatternKind::List(parts, rest)
        } else if self.takes("(") {
            match self.patterns(")")? {
                (parts, false) => PatternKind::Tuple(parts),
                _ => return self.unknown(),
            }
        } else {
            let path = self.path()?;
            match self.takes("{") {
                true => self.fields_of_pattern(path)?,
                false if path == self.text(start) => PatternKind::Name(self.text(start), false),
                false => return self.unknown(),
            }
        };
        Ok(Pattern { kind, text: self.text(start) })
    }

    /// Patterns up to this mark, and whether the last one is `..`.
    fn patterns(&mut self, close: &str) -> Reading<(Vec<Pattern<'t>>, bool)> {
        let mut rest = false;
        let parts = self.list(close, |parser| match (rest, parser.takes("..")) {
            (true, _) => parser.unknown(),
            (false, true) => {
                rest = true;
                Ok(None)
            }
            (false, false) => parser.pattern().map(Some),
        })?;
        Ok((parts.into_iter().flatten().collect(), rest))
    }

    fn fields_of_pattern(&mut self, path: String) -> Reading<PatternKind<'t>> {
        let mut rest = false;
        let fields = self.list("}", |parser| {
            if rest || parser.takes("..") {
                return if std::mem::replace(&mut rest, true) { parser.unknown() } else { Ok(None) };
            }
            let start = parser.at;
            let name = parser.name()?;
            let own = Pattern { kind: PatternKind::Name(name, false), text: parser.text(start) };
            Ok(Some((name, if parser.takes(":") { parser.pattern()? } else { own })))
        })?;
        Ok(PatternKind::Record(path, fields.into_iter().flatten().collect(), rest))
    }

    // ---- expressions

    fn expression(&mut self) -> Reading<Expression<'t>> {
        self.level(0)
    }

    /// Operands with operators of this level, or those that bind tighter, between them.
    fn level(&mut self, level: usize) -> Reading<Expression<'t>> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let start = self.at;
        let mut left = self.level(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.is_next(operator)) {
            self.at += 1;
            let both = Box::new([left, self.level(level + 1)?]);
            let kind = match *operator {
                ".." => ExpressionKind::Range(both),
                operator => ExpressionKind::Binary(operator.chars().next().unwrap_or_default(), both),
            };
            left = Expression { kind, text: self.text(start) };
        }
        Ok(left)
    }

    fn unary(&mut self) -> Reading<Expression<'t>> {
        let start = self.at;
        let kind = if let Some(sign) = ["-", "!", "*"].into_iter().find(|sign| self.is_next(sign)) {
            self.at += 1;
            ExpressionKind::Unary(sign.chars().next().unwrap_or_default(), Box::new(self.unary()?))
        } else if self.takes("&") {
            ExpressionKind::Same(Box::new(self.unary()?))
        } else if self.takes("||") {
            ExpressionKind::Closure(Box::new(self.expression()?))
        } else if self.takes("|") {
            self.name()?;
            self.expect("|")?;
            self.expression()?;
            ExpressionKind::Function
        } else {
            return self.postfix();
        };
        Ok(Expression { kind, text: self.text(start) })
    }

    fn postfix(&mut self) -> Reading<Expression<'t>> {
        let start = self.at;
        let mut of = self.primary()?;
        loop {
            let kind = if self.takes(".") {
                match self.tokens.get(self.at).copied() {
                    Some(Token { kind: Kind::Name | Kind::Number, text, .. }) => {
                        self.at += 1;
                        match self.takes("(") {
                            true => ExpressionKind::Method(Box::new(of), text, self.arguments()?),
                            false => ExpressionKind::Field(Box::new(of), text),
                        }
                    }
                    _ => return self.unknown(),
                }
            } else if self.takes("[") {
                let index = self.within(Self::expression)?;
                self.expect("]")?;
                ExpressionKind::Index(Box::new([of, index]))
            } else if self.is_next("(") {
                let ExpressionKind::Path(function) = of.kind else { return self.unknown() };
                self.at += 1;
                ExpressionKind::Call(function, self.arguments()?)
            } else {
                return Ok(of);
            };
            of = Expression { kind, text: self.text(start) };
        }
    }

    /// Within brackets a brace begins the fields of a record again.
    fn within<T>(&mut self, read: impl FnOnce(&mut Self) -> Reading<T>) -> Reading<T> {
        let is_head = std::mem::take(&mut self.is_head);
        let found = read(self)?;
        self.is_head = is_head;
        Ok(found)
    }

    fn arguments(&mut self) -> Reading<Vec<Expression<'t>>> {
        self.within(|parser| parser.list(")", Self::expression))
    }

    fn primary(&mut self) -> Reading<Expression<'t>> {
        let start = self.at;
        let Some(&token) = self.tokens.get(self.at) else { return self.unknown() };
        let kind = match (token.kind, token.text) {
            (Kind::Number, text) => {
                self.at += 1;
                let float = || text.parse().ok().map(ExpressionKind::Float);
                let integer = text.parse().ok().map(ExpressionKind::Integer);
                match integer.or_else(float) {
                    Some(kind) => kind,
                    None => return Err(cannot_read(text)),
                }
            }
            (Kind::Text, text) => {
                self.at += 1;
                let literal = syn::parse_str::<syn::LitStr>(text).map_err(|_| cannot_read(text))?;
                ExpressionKind::Text(literal.value())
            }
            (Kind::Name, "_") => {
                self.at += 1;
                ExpressionKind::Wild
            }
            (Kind::Name, _) | (_, "::") => {
                let path = self.path()?;
                match !self.is_head && self.takes("{") {
                    true => ExpressionKind::Record(path, self.within(Self::fields)?),
                    false => ExpressionKind::Path(path),
                }
            }
            (_, "(") => {
                self.at += 1;
                self.tuple()?
            }
            (_, "[") => {
                self.at += 1;
                self.within(Self::array)?
            }
            (_, "{") => ExpressionKind::Block(self.block()?),
            _ => return self.unknown(),
        };
        Ok(Expression { kind, text: self.text(start) })
    }

    /// `::mbs_runtime::Pose`, without what is in front of the first name.
    fn path(&mut self) -> Reading<String> {
        self.takes("::");
        let mut path = self.name()?.to_string();
        while self.takes("::") {
            path.push_str("::");
            path.push_str(self.name()?);
        }
        Ok(path)
    }

    fn fields(&mut self) -> Reading<Vec<(&'t str, Expression<'t>)>> {
        self.list("}", |parser| {
            let start = parser.at;
            let name = parser.name()?;
            let own = Expression { kind: ExpressionKind::Path(name.to_string()), text: parser.text(start) };
            Ok((name, if parser.takes(":") { parser.expression()? } else { own }))
        })
    }

    /// Behind a bracket: an expression, or several with commas.
    fn tuple(&mut self) -> Reading<ExpressionKind<'t>> {
        let first = self.at;
        let mut parts = self.arguments()?;
        let has_comma = self.tokens[first..self.at - 1].last().is_some_and(|token| token.is(","));
        Ok(match parts.pop() {
            Some(only) if parts.is_empty() && !has_comma => ExpressionKind::Same(Box::new(only)),
            last => ExpressionKind::Tuple(parts.into_iter().chain(last).collect()),
        })
    }

    /// Behind a square bracket.
    fn array(&mut self) -> Reading<ExpressionKind<'t>> {
        if self.takes("]") {
            return Ok(ExpressionKind::Array(Vec::new()));
        }
        let first = self.expression()?;
        if self.takes(";") {
            let length = self.expression()?;
            self.expect("]")?;
            return Ok(ExpressionKind::Repeat(Box::new([first, length])));
        }
        let mut entries = vec![first];
        if !self.is_next("]") {
            self.expect(",")?;
        }
        entries.extend(self.list("]", Self::expression)?);
        Ok(ExpressionKind::Array(entries))
    }
}
