//! The tree that the grammar of the manual gives a text.

use std::ops::Range;
use std::rc::Rc;

use super::token::{Token, tokens};
use super::wide::{Wide, decimal};

mod unit;

/// An expression and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Expression {
    pub(super) kind: Kind,
    pub(super) span: Range<usize>,
}

/// What an expression is made of.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    Number(Wide),
    /// A number with its unit behind it.
    Quantity(Wide, Unit),
    Name(Rc<str>),
    /// `f(a, b)`, and `a.f(b)` as well.
    Call(Rc<str>, Vec<Expression>),
    /// `a.f(b)`
    Method(Rc<str>, Vec<Expression>),
    /// `a.x`
    Field(Box<Expression>, Rc<str>),
    Index(Box<Expression>, Box<Expression>),
    Array(Vec<Expression>),
    Unary(char, Box<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    If(Box<Expression>, Box<Expression>, Box<Expression>),
}

impl Expression {
    /// What it is made of, left to right.
    pub(super) fn parts(&self) -> Vec<&Expression> {
        match &self.kind {
            Kind::Number(_) | Kind::Quantity(..) | Kind::Name(_) => Vec::new(),
            Kind::Call(_, arguments) | Kind::Method(_, arguments) | Kind::Array(arguments) => {
                arguments.iter().collect()
            }
            Kind::Field(a, _) | Kind::Unary(_, a) => vec![a],
            Kind::Index(a, b) | Kind::Binary(_, a, b) => vec![a, b],
            Kind::If(a, b, c) => vec![a, b, c],
        }
    }
}

/// A unit: names and their powers.
pub(super) type Unit = Vec<(String, f64)>;

/// `param`, `coord`, `input`, `prescribed` or `const`.
#[derive(Clone, Debug)]
pub(super) struct Declaration {
    pub(super) keyword: String,
    pub(super) name: Rc<str>,
    /// None of a number, one of an array, two of a matrix.
    pub(super) lengths: Vec<Expression>,
    pub(super) unit: Option<Unit>,
    pub(super) value: Option<Expression>,
}

/// A statement.
#[derive(Clone, Debug)]
pub(super) enum Statement {
    Declaration(Declaration),
    Function {
        name: Rc<str>,
        arguments: Vec<Rc<str>>,
        body: Rc<Expression>,
    },
    /// Statements that are used many times.
    Part {
        name: Rc<str>,
        arguments: Vec<Rc<str>>,
        body: Rc<Vec<Statement>>,
    },
    /// A use of them.
    Instance {
        part: Rc<str>,
        name: Rc<str>,
        index: Option<Expression>,
        arguments: Vec<Expression>,
    },
    Let {
        name: Rc<str>,
        value: Expression,
    },
    /// An array without values.
    Array {
        name: Rc<str>,
        lengths: Vec<Expression>,
    },
    Assign {
        name: Rc<str>,
        indices: Vec<Expression>,
        value: Expression,
    },
    /// `kinetic`, `potential`, `dissipation` or `lagrangian`.
    Energy {
        sum: String,
        value: Expression,
    },
    Force {
        name: Rc<str>,
        index: Option<Expression>,
        value: Expression,
    },
    ForceAt {
        place: Expression,
        value: Expression,
    },
    TorqueOn {
        pose: Expression,
        value: Expression,
    },
    Gravity {
        value: Expression,
    },
    Reaction {
        name: Rc<str>,
        index: Option<Expression>,
        pose: Expression,
    },
    /// The statements of the first block whose condition holds.
    Choice {
        blocks: Vec<(Option<Expression>, Vec<Statement>)>,
    },
    Constraint {
        left: Expression,
        right: Expression,
    },
    Output {
        name: Rc<str>,
        index: Option<Expression>,
        value: Expression,
    },
    For {
        name: Rc<str>,
        from: Expression,
        to: Expression,
        body: Vec<Statement>,
    },
}

impl Statement {
    /// Its expressions, those of the statements within a loop included.
    pub(super) fn expressions(&self) -> Vec<&Expression> {
        match self {
            Statement::Declaration(d) => d.lengths.iter().chain(&d.value).collect(),
            Statement::Part { body, .. } => body.iter().flat_map(Statement::expressions).collect(),
            Statement::Instance { index, arguments, .. } => index.iter().chain(arguments).collect(),
            Statement::Function { body, .. } => vec![body],
            Statement::Let { value, .. } | Statement::Energy { value, .. } | Statement::Gravity { value } => {
                vec![value]
            }
            Statement::Array { lengths, .. } => lengths.iter().collect(),
            Statement::Assign { indices, value, .. } => indices.iter().chain([value]).collect(),
            Statement::Output { index, value, .. } => index.iter().chain([value]).collect(),
            Statement::Choice { blocks } => {
                let parts = blocks
                    .iter()
                    .flat_map(|(condition, body)| condition.iter().chain(body.iter().flat_map(Statement::expressions)));
                parts.collect()
            }
            Statement::Force { index, value, .. } => index.iter().chain([value]).collect(),
            Statement::ForceAt { place: left, value: right }
            | Statement::TorqueOn { pose: left, value: right }
            | Statement::Constraint { left, right } => vec![left, right],
            Statement::Reaction { index, pose, .. } => index.iter().chain([pose]).collect(),
            Statement::For { from, to, body, .. } => {
                [from, to].into_iter().chain(body.iter().flat_map(Statement::expressions)).collect()
            }
        }
    }
}

/// A file: what it imports, and its statements.
#[derive(Clone, Debug)]
pub(super) struct File {
    pub(super) imports: Vec<String>,
    pub(super) dimensionless: bool,
    pub(super) statements: Vec<Statement>,
}

/// Reads a table: its first line names the columns, and each becomes an array of constants.
///
/// # Errors
/// What was expected.
pub(super) fn read_table(text: &str) -> Result<Vec<Statement>, String> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let header = lines.next().ok_or("a table without a line")?;
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').map(str::trim).collect()).collect();
    let column = |(i, head): (usize, &str)| {
        let (name, unit) = head.trim().trim_end_matches(']').split_once('[').unwrap_or((head.trim(), "1"));
        let cells = rows.iter().map(|row| *row.get(i).unwrap_or(&"")).collect::<Vec<_>>();
        let number = |cell: &str| {
            let (sign, digits) =
                cell.strip_prefix('-').map_or(("", cell.trim_start_matches('+')), |digits| ("-", digits));
            format!("{sign}{}{digits}", if digits.starts_with('.') { "0" } else { "" })
        };
        let values: Vec<String> = cells.iter().map(|cell| number(cell)).collect();
        let written = format!("const {}[{}]: {unit} = [{}];", name.trim(), rows.len(), values.join(", "));
        Reader { tokens: tokens(&written)?, at: 0 }.statement()
    };
    header.split(',').enumerate().map(column).collect()
}

/// Reads a file.
///
/// # Errors
/// What was expected, and where.
pub(super) fn read(text: &str) -> Result<File, String> {
    let mut reader = Reader { tokens: tokens(text)?, at: 0 };
    let mut file = File { imports: Vec::new(), dimensionless: false, statements: Vec::new() };
    loop {
        if reader.accept("#![") {
            file.dimensionless |= reader.name()?.as_ref() == "dimensionless";
            reader.expect("]")?;
        } else if reader.accept("import") {
            let Token::Text(path) = reader.next() else { return Err(reader.expected("a path")) };
            file.imports.push(path);
            reader.expect(";")?;
        } else {
            break;
        }
    }
    if reader.accept("mechanism") {
        reader.name()?;
        file.statements = reader.block()?;
    } else {
        while reader.peek() != &Token::End {
            file.statements.push(reader.statement()?);
        }
    }
    if reader.peek() == &Token::End { Ok(file) } else { Err(reader.expected("the end")) }
}

struct Reader {
    tokens: Vec<(Token, Range<usize>)>,
    at: usize,
}

impl Reader {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }
    fn start(&self) -> usize {
        self.tokens[self.at].1.start
    }
    fn end(&self) -> usize {
        self.tokens[self.at - 1].1.end
    }
    fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }
    fn is(&self, word: &str) -> bool {
        match self.peek() {
            Token::Sign(sign) => *sign == word,
            Token::Name(name) => name == word,
            _ => false,
        }
    }
    fn accept(&mut self, word: &str) -> bool {
        let found = self.is(word);
        if found {
            self.next();
        }
        found
    }
    fn expect(&mut self, word: &str) -> Result<(), String> {
        if self.accept(word) { Ok(()) } else { Err(self.expected(word)) }
    }
    fn expected(&self, what: &str) -> String {
        format!("expected {what}, found {:?} at byte {}", self.peek(), self.start())
    }
    fn name(&mut self) -> Result<Rc<str>, String> {
        match self.next() {
            Token::Name(name) => Ok(name.into()),
            _ => Err(self.expected("a name")),
        }
    }

    fn block(&mut self) -> Result<Vec<Statement>, String> {
        self.expect("{")?;
        let mut statements = Vec::new();
        while !self.accept("}") {
            statements.push(self.statement()?);
        }
        Ok(statements)
    }

    fn statement(&mut self) -> Result<Statement, String> {
        let Token::Name(word) = self.peek().clone() else { return Err(self.expected("a statement")) };
        match word.as_str() {
            "for" => self.repetition(),
            "if" => self.choice(),
            "part" if self.begins_part() => self.part(),
            _ => {
                let statement = self.simple(&word)?;
                self.expect(";")?;
                Ok(statement)
            }
        }
    }

    /// `part` is a name as well.
    fn begins_part(&self) -> bool {
        let next = |n: usize| self.tokens.get(self.at + n).map(|(token, _)| token);
        matches!(next(1), Some(Token::Name(_)))
            && next(2) == Some(&Token::Sign("("))
            && self.tokens[self.at + 3..]
                .iter()
                .find(|(token, _)| matches!(token, Token::Sign("{" | ";")))
                .is_some_and(|(token, _)| token == &Token::Sign("{"))
    }

    fn part(&mut self) -> Result<Statement, String> {
        self.expect("part")?;
        let (name, arguments) = (self.name()?, self.names()?);
        Ok(Statement::Part { name, arguments, body: Rc::new(self.block()?) })
    }

    /// Names in brackets.
    fn names(&mut self) -> Result<Vec<Rc<str>>, String> {
        self.expect("(")?;
        let mut names = Vec::new();
        while !self.accept(")") {
            names.push(self.name()?);
            if !self.is(")") {
                self.expect(",")?;
            }
        }
        Ok(names)
    }

    fn repetition(&mut self) -> Result<Statement, String> {
        self.expect("for")?;
        let name = self.name()?;
        self.expect("in")?;
        let from = self.expression()?;
        self.expect("..")?;
        let to = self.expression()?;
        Ok(Statement::For { name, from, to, body: self.block()? })
    }

    fn choice(&mut self) -> Result<Statement, String> {
        let mut blocks = Vec::new();
        while self.accept("if") {
            blocks.push((Some(self.expression()?), self.block()?));
            if !self.accept("else") {
                return Ok(Statement::Choice { blocks });
            }
        }
        blocks.push((None, self.block()?));
        Ok(Statement::Choice { blocks })
    }

    fn indices(&mut self) -> Result<Vec<Expression>, String> {
        let mut indices = Vec::new();
        while let Some(index) = self.index()? {
            indices.push(index);
        }
        Ok(indices)
    }

    fn simple(&mut self, word: &str) -> Result<Statement, String> {
        let first = self.name()?;
        match word {
            "param" | "coord" | "input" | "prescribed" | "const" => self.declaration(word),
            "fn" => self.function(),
            "let" => {
                self.accept("mut");
                let (name, lengths) = (self.name()?, self.indices()?);
                if !lengths.is_empty() {
                    return Ok(Statement::Array { name, lengths });
                }
                self.expect("=")?;
                Ok(Statement::Let { name, value: self.expression()? })
            }
            "kinetic" | "potential" | "dissipation" | "lagrangian" => {
                self.expect("+=")?;
                Ok(Statement::Energy { sum: word.to_string(), value: self.expression()? })
            }
            "force" if self.accept("at") => {
                let place = self.expression()?;
                self.expect("+=")?;
                Ok(Statement::ForceAt { place, value: self.expression()? })
            }
            "force" => {
                let name = self.name()?;
                let index = self.index()?;
                self.expect("+=")?;
                Ok(Statement::Force { name, index, value: self.expression()? })
            }
            "torque" => {
                self.expect("on")?;
                let pose = self.expression()?;
                self.expect("+=")?;
                Ok(Statement::TorqueOn { pose, value: self.expression()? })
            }
            "reaction" => {
                let name = self.name()?;
                let index = self.index()?;
                self.expect("at")?;
                Ok(Statement::Reaction { name, index, pose: self.postfix()? })
            }
            "constraint" => {
                self.name()?;
                self.index()?;
                self.expect(":")?;
                let left = self.expression()?;
                self.expect("=")?;
                Ok(Statement::Constraint { left, right: self.expression()? })
            }
            "output" => {
                let (name, index) = (self.name()?, self.index()?);
                self.expect("=")?;
                let value = self.expression()?;
                if self.accept(",") {
                    self.expect("jacobian_rate")?;
                }
                Ok(Statement::Output { name, index, value })
            }
            // What a body looks like moves nothing: a choice of no statement.
            "shape" if !self.is("=") && !self.is("[") => {
                self.expression()?;
                self.expect("+=")?;
                self.name()?;
                self.expect("(")?;
                if let Token::Text(_) = self.peek() {
                    self.next();
                    self.accept(",");
                }
                self.arguments(")")?;
                Ok(Statement::Choice { blocks: Vec::new() })
            }
            "gravity" if !self.is("=") => Ok(Statement::Gravity { value: self.expression()? }),
            _ if matches!(self.peek(), Token::Name(_)) => {
                let (name, index) = (self.name()?, self.index()?);
                self.expect("(")?;
                Ok(Statement::Instance { part: first, name, index, arguments: self.arguments(")")? })
            }
            _ => {
                let indices = self.indices()?;
                self.expect("=")?;
                Ok(Statement::Assign { name: first, indices, value: self.expression()? })
            }
        }
    }

    fn index(&mut self) -> Result<Option<Expression>, String> {
        if !self.accept("[") {
            return Ok(None);
        }
        let index = self.expression()?;
        self.expect("]")?;
        Ok(Some(index))
    }

    fn declaration(&mut self, keyword: &str) -> Result<Statement, String> {
        let name = self.name()?;
        let lengths = self.indices()?;
        let unit = if self.accept(":") { Some(self.unit()?) } else { None };
        let value = if self.accept("=") { Some(self.expression()?) } else { None };
        if self.accept(",") {
            self.expect("positive")?;
        }
        Ok(Statement::Declaration(Declaration { keyword: keyword.to_string(), name, lengths, unit, value }))
    }

    fn function(&mut self) -> Result<Statement, String> {
        let (name, arguments) = (self.name()?, self.names()?);
        self.expect("=")?;
        Ok(Statement::Function { name, arguments, body: Rc::new(self.expression()?) })
    }

    /// The binary operators, loosest first.
    fn expression(&mut self) -> Result<Expression, String> {
        self.binary(0)
    }

    fn binary(&mut self, level: usize) -> Result<Expression, String> {
        const LEVELS: [&[&str]; 5] = [&["||"], &["&&"], &["<=", ">=", "<", ">", "==", "!="], &["+", "-"], &["*", "/"]];
        let Some(operators) = LEVELS.get(level) else { return self.signed() };
        let start = self.start();
        let mut left = self.binary(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.is(operator)) {
            self.next();
            let right = self.binary(level + 1)?;
            let kind = Kind::Binary(operator, Box::new(left), Box::new(right));
            left = Expression { kind, span: start..self.end() };
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<Expression, String> {
        let start = self.start();
        for (sign, operator) in [("-", '-'), ("!", '!')] {
            if self.accept(sign) {
                let kind = Kind::Unary(operator, Box::new(self.signed()?));
                return Ok(Expression { kind, span: start..self.end() });
            }
        }
        let base = self.postfix()?;
        if !self.accept("^") {
            return Ok(base);
        }
        let kind = Kind::Binary("^", Box::new(base), Box::new(self.signed()?));
        Ok(Expression { kind, span: start..self.end() })
    }

    fn postfix(&mut self) -> Result<Expression, String> {
        let start = self.start();
        let mut value = self.primary()?;
        loop {
            let kind = if self.accept(".") {
                let name = self.name()?;
                if self.accept("(") {
                    let arguments = self.arguments(")")?;
                    Kind::Method(name, [value].into_iter().chain(arguments).collect())
                } else {
                    Kind::Field(Box::new(value), name)
                }
            } else if let Some(index) = self.index()? {
                Kind::Index(Box::new(value), Box::new(index))
            } else {
                return Ok(value);
            };
            value = Expression { kind, span: start..self.end() };
        }
    }

    fn arguments(&mut self, close: &str) -> Result<Vec<Expression>, String> {
        let mut arguments = Vec::new();
        while !self.accept(close) {
            arguments.push(self.expression()?);
            if !self.is(close) {
                self.expect(",")?;
            }
        }
        Ok(arguments)
    }

    fn primary(&mut self) -> Result<Expression, String> {
        let start = self.start();
        let kind = match self.next() {
            Token::Number(digits) => {
                let number = decimal(&digits).ok_or("a number that cannot be read")?;
                let unit = self.unit_behind()?;
                if unit.is_empty() { Kind::Number(number) } else { Kind::Quantity(number, unit) }
            }
            Token::Sign("[") => Kind::Array(self.arguments("]")?),
            Token::Sign("(") => {
                let mut inner = self.expression()?;
                self.expect(")")?;
                inner.span = start..self.end();
                return Ok(inner);
            }
            Token::Name(word) if word == "if" => self.conditional()?,
            Token::Name(name) if self.accept("(") => Kind::Call(name.into(), self.arguments(")")?),
            Token::Name(name) => Kind::Name(name.into()),
            _ => return Err(self.expected("a value")),
        };
        Ok(Expression { kind, span: start..self.end() })
    }

    /// What follows `if`.
    fn conditional(&mut self) -> Result<Kind, String> {
        let condition = self.expression()?;
        let taken = self.braced()?;
        self.expect("else")?;
        let start = self.start();
        let other = if self.accept("if") {
            let kind = self.conditional()?;
            Expression { kind, span: start..self.end() }
        } else {
            self.braced()?
        };
        Ok(Kind::If(Box::new(condition), Box::new(taken), Box::new(other)))
    }

    fn braced(&mut self) -> Result<Expression, String> {
        self.expect("{")?;
        let value = self.expression()?;
        self.expect("}")?;
        Ok(value)
    }
}
