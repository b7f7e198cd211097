//! Expressions with infix operators, evaluated as they are read: by the precedence of operators, with a stack, so that
//! no depth is too deep (Dijkstra, *Algol 60 translation*, 1961).

use std::collections::HashMap;
use std::rc::Rc;

use super::super::numbering::{Number, Numbering};
use super::super::reading::{Reading, unknown};
use super::super::token::{Kind, Token};
use super::dialect::{Dialect, Family, Meant};

/// What a variable is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(Number),
    /// Numbers that the caller gives, row by row, and how many there are along each axis.
    Array(Rc<[usize]>, Rc<[Number]>),
    /// Numbers of the function's own.
    List(Rc<[Number]>),
    /// This many numbers, which are given one by one: those of `Reader::kept`.
    Kept(usize),
}

impl Value {
    pub(super) fn vector(numbers: Vec<Number>) -> Self {
        Value::Array([numbers.len()].into(), numbers.into())
    }
}

/// What is open around an operand.
#[derive(Clone, Copy, Debug)]
enum Open {
    Bracket,
    /// A call, and how many arguments are behind this one.
    Call(Meant, usize),
    /// `c ?` and `c ? a :`
    Then,
    Otherwise,
    /// The first character of an operator, how many it has, and how tightly it binds.
    Infix(char, usize, usize),
    Minus,
    Not,
}

/// A turn of a loop.
pub(super) struct Turn<'t> {
    /// What the index is called, and its value in this turn.
    pub(super) index: &'t str,
    pub(super) value: usize,
    /// Names that have values in this turn alone.
    pub(super) bound: Vec<&'t str>,
}

/// Reads the tokens of a text.
pub(super) struct Reader<'r, 't> {
    pub(super) dialect: &'r Dialect,
    pub(super) numbering: &'r mut Numbering,
    pub(super) tokens: &'r [Token<'t>],
    pub(super) at: usize,
    /// The numbers of the splines.
    pub(super) tables: Vec<usize>,
    /// What evaluates the spline with a number, in C.
    pub(super) table: String,
    /// The variables of the function that is read.
    pub(super) names: HashMap<String, Value>,
    /// What has been given to those of them that are given numbers one by one.
    pub(super) kept: HashMap<String, Vec<Option<Number>>>,
    /// The loop that is read, if one is.
    pub(super) turn: Option<Turn<'t>>,
    /// What the constructor has computed, by the names of fields.
    pub(super) hoisted: HashMap<&'t str, Number>,
    /// The fields that were declared for it, and those that were given values.
    pub(super) declared: Vec<&'t str>,
    pub(super) given: Vec<&'t str>,
    /// Whether the constructor is read.
    pub(super) is_constructor: bool,
}

impl<'t> Reader<'_, 't> {
    pub(super) fn peek(&self) -> Option<Token<'t>> {
        self.tokens.get(self.at).copied()
    }

    pub(super) fn is_next(&self, mark: &str) -> bool {
        self.peek().is_some_and(|token| token.is(mark))
    }

    /// Whether the next token is this one, which is taken then.
    pub(super) fn takes(&mut self, mark: &str) -> bool {
        let is_there = self.is_next(mark);
        self.at += usize::from(is_there);
        is_there
    }

    pub(super) fn expect(&mut self, mark: &str) -> Reading<()> {
        if self.takes(mark) { Ok(()) } else { self.unknown() }
    }

    /// A name without fields behind it.
    pub(super) fn name(&mut self) -> Reading<&'t str> {
        match self.peek() {
            Some(Token { kind: Kind::Name, text, .. }) if !text.contains(['.', '-', '#']) => {
                self.at += 1;
                Ok(text)
            }
            _ => self.unknown(),
        }
    }

    /// A number without a point, and without a zero in front, with which it is octal in C.
    pub(super) fn integer(&mut self) -> Reading<usize> {
        let is_decimal = |text: &str| text == "0" || !text.starts_with('0');
        let token = self.peek().filter(|token| token.kind == Kind::Number && is_decimal(token.text));
        let number = token.and_then(|token| token.text.parse().ok());
        match number {
            Some(number) => {
                self.at += 1;
                Ok(number)
            }
            None => self.unknown(),
        }
    }

    /// What is refused: the tokens around.
    pub(super) fn unknown<T>(&self) -> Reading<T> {
        let some = self.tokens[self.at.saturating_sub(4).min(self.tokens.len())..].iter().take(10);
        let some: Vec<&str> = some.map(|token| token.text.trim()).filter(|text| !text.is_empty()).collect();
        unknown(&some.join(" "))
    }

    /// The number of an expression.
    pub(super) fn expression(&mut self) -> Reading<Number> {
        let mut stack = Stack::default();
        loop {
            self.operand(&mut stack)?;
            if !self.operator(&mut stack)? {
                break;
            }
        }
        match (stack.values.as_slice(), stack.open.is_empty()) {
            ([value], true) => Ok(*value),
            _ => self.unknown(),
        }
    }

    /// What begins an expression, a part in brackets or an argument, up to the first operand of it.
    fn operand(&mut self, stack: &mut Stack) -> Reading<()> {
        loop {
            let Some(token) = self.peek() else { return self.unknown() };
            let open = match token.kind {
                Kind::Mark if token.text == "-" => Open::Minus,
                Kind::Mark if token.text == self.dialect.not => Open::Not,
                Kind::Mark if token.text == "(" => Open::Bracket,
                Kind::Number => {
                    let number = self.constant(token.text, stack)?;
                    stack.values.push(number);
                    return Ok(());
                }
                Kind::Name => match self.variable(token.text)? {
                    Some(number) => {
                        stack.values.push(number);
                        return Ok(());
                    }
                    None => {
                        let called = self.called(token.text)?;
                        stack.open.push(Open::Call(called, called.arguments() - 1));
                        continue;
                    }
                },
                Kind::Mark | Kind::Text | Kind::Line | Kind::Directive | Kind::Slot => return self.unknown(),
            };
            self.at += 1;
            stack.open.push(open);
        }
    }

    /// What is behind an operand: brackets that close, then an operator; whether another operand is to follow.
    fn operator(&mut self, stack: &mut Stack) -> Reading<bool> {
        while let Some(token) = self.peek().filter(|token| token.kind == Kind::Mark) {
            if let Some(level) = self.dialect.level(token.text) {
                self.reduce(stack, level, false)?;
                stack.open.push(Open::Infix(token.text.chars().next().unwrap_or_default(), token.text.len(), level));
            } else if self.dialect.has_choices && token.text == "?" {
                self.reduce(stack, 0, false)?;
                stack.open.push(Open::Then);
            } else {
                self.reduce(stack, 0, true)?;
                match (token.text, stack.open.last_mut()) {
                    (":", Some(open @ Open::Then)) => *open = Open::Otherwise,
                    (",", Some(Open::Call(_, rest))) if *rest > 0 => *rest -= 1,
                    (")", Some(Open::Bracket | Open::Call(_, 0))) => {
                        self.at += 1;
                        if let Some(Open::Call(called, _)) = stack.open.pop() {
                            self.call(stack, called)?;
                        }
                        continue;
                    }
                    _ => return Ok(false),
                }
            }
            self.at += 1;
            return Ok(true);
        }
        self.reduce(stack, 0, true).map(|()| false)
    }

    /// Carries out what binds at least as tightly as this level; where an expression ends, choices too.
    fn reduce(&mut self, stack: &mut Stack, least: usize, choices: bool) -> Reading<()> {
        while let Some(open) = stack.open.last().copied() {
            let numbering = &mut *self.numbering;
            let number = match open {
                Open::Minus => stack.value()?.opposite(),
                Open::Not => numbering.not(stack.value()?),
                Open::Infix(operator, length, level) if level >= least => {
                    let (b, a) = (stack.value()?, stack.value()?);
                    match (operator, length) {
                        ('+', _) => numbering.sum(a, b),
                        ('-', _) => numbering.sum(a, b.opposite()),
                        ('*', _) => numbering.product(a, b),
                        ('/', _) => numbering.quotient(a, b),
                        ('<', 1) => numbering.less(a, b),
                        ('<', _) => numbering.less_equal(a, b),
                        _ => numbering.and(a, b),
                    }
                }
                Open::Otherwise if choices => {
                    let (b, a, condition) = (stack.value()?, stack.value()?, stack.value()?);
                    numbering.select(condition, a, b)
                }
                Open::Infix(..) | Open::Otherwise | Open::Then | Open::Bracket | Open::Call(..) => return Ok(()),
            };
            stack.open.pop();
            stack.values.push(number);
        }
        Ok(())
    }

    /// A function of arguments that are known.
    fn call(&mut self, stack: &mut Stack, called: Meant) -> Reading<()> {
        let numbering = &mut *self.numbering;
        let number = match called {
            Meant::Constant => stack.value()?,
            Meant::Root => numbering.root(stack.value()?),
            Meant::Call(function) => numbering.call(function, stack.value()?),
            Meant::Spline(table, order) => numbering.spline(table, order, stack.value()?),
            Meant::Call2(function) => {
                let (b, a) = (stack.value()?, stack.value()?);
                numbering.call2(function, a, b)
            }
            Meant::Select => {
                let (b, a, condition) = (stack.value()?, stack.value()?, stack.value()?);
                numbering.select(condition, a, b)
            }
        };
        stack.values.push(number);
        Ok(())
    }

    /// A literal. In C each is made a number of the number type.
    fn constant(&mut self, text: &str, stack: &Stack) -> Reading<Number> {
        let is_of_the_type = || {
            let around = stack.open.iter().rev().find(|open| !matches!(open, Open::Minus));
            matches!(around, Some(Open::Call(Meant::Constant, _)))
        };
        let value = text.parse().ok().filter(|_| text.contains(['.', 'e']));
        match value {
            Some(value) if self.dialect.family != Family::C || is_of_the_type() => {
                self.at += 1;
                Ok(self.numbering.constant(value))
            }
            _ => self.unknown(),
        }
    }

    /// A variable, or a component of one; `None` where the name is that of a function.
    fn variable(&mut self, path: &str) -> Reading<Option<Number>> {
        let [_, own] = self.dialect.own;
        let hoisted = || path.strip_prefix(own).and_then(|field| self.hoisted.get(field)).copied();
        let value = match self.names.get(path) {
            Some(value) => value.clone(),
            None if path == self.dialect.pi => Value::Number(self.numbering.constant(std::f64::consts::PI)),
            None => match hoisted() {
                Some(number) => Value::Number(number),
                None => return Ok(None),
            },
        };
        self.at += 1;
        match value {
            Value::Number(number) => Ok(Some(number)),
            Value::Array(lengths, numbers) => {
                // What a caller gives has axes of batches in front.
                let has_batches = self.dialect.family == Family::Python && !path.contains('.');
                let place = self.index(&lengths, has_batches)?;
                Ok(Some(numbers[place]))
            }
            Value::List(numbers) => {
                let place = self.index(&[numbers.len()], false)?;
                Ok(Some(numbers[place]))
            }
            Value::Kept(count) => {
                let place = self.index(&[count], false)?;
                match self.kept.get(path).and_then(|numbers| numbers[place]) {
                    Some(number) => Ok(Some(number)),
                    None => Err(format!("`{path}[{place}]` has no value yet")),
                }
            }
        }
    }

    /// `[i][j]`, `[..., i, j]`, `(i, j)`: the place among all numbers.
    pub(super) fn index(&mut self, lengths: &[usize], has_batches: bool) -> Reading<usize> {
        let [open, close] = self.dialect.index;
        let is_c_like = self.dialect.has_choices;
        let mut place = 0;
        self.expect(open)?;
        if has_batches {
            self.expect("...")?;
            self.expect(",")?;
        }
        for (axis, length) in lengths.iter().enumerate() {
            if axis > 0 {
                let between: &[&str] = if is_c_like { &["]", "["] } else { &[","] };
                between.iter().try_for_each(|mark| self.expect(mark))?;
            }
            match self.place()?.checked_sub(self.dialect.first) {
                Some(index) if index < *length => place = place * length + index,
                _ => return self.unknown(),
            }
        }
        self.expect(close).map(|()| place)
    }

    /// `3`; in a loop also `i`, `i - 1`, `i + 2`, `2 * i + 1`.
    fn place(&mut self) -> Reading<usize> {
        let Some((index, value)) = self.turn.as_ref().map(|turn| (turn.index, turn.value)) else {
            return self.integer();
        };
        let mut place = match self.takes(index) {
            true => Some(value),
            false => {
                let number = self.integer()?;
                if self.takes("*") { self.expect(index).map(|()| number.checked_mul(value))? } else { Some(number) }
            }
        };
        if self.takes("+") {
            let more = self.integer()?;
            place = place.and_then(|place| place.checked_add(more));
        } else if self.takes("-") {
            let less = self.integer()?;
            place = place.and_then(|place| place.checked_sub(less));
        }
        place.map_or_else(|| self.unknown(), Ok)
    }

    /// A function by its name, and the bracket behind it.
    fn called(&mut self, name: &str) -> Reading<Meant> {
        let Some(called) = self.dialect.function(name) else { return self.spline(name) };
        self.at += 1;
        self.expect("(").map(|()| called)
    }

    /// `TABLE_0` in one way or another, and the order of the derivative.
    fn spline(&mut self, name: &str) -> Reading<Meant> {
        let own = name.strip_prefix(&self.table).filter(|_| self.dialect.family == Family::C);
        let arguments = |table: &str| match self.dialect.family {
            Family::Matlab => format!("c.table_{table}_places , c.table_{table}_rows ,"),
            Family::C | Family::Js | Family::Python => format!("TABLE_{table}_PLACES , TABLE_{table}_ROWS ,"),
        };
        let table = match own {
            Some(table) => table.parse::<usize>().ok(),
            None if name == "mbs_spline" => {
                let places = self.tokens.get(self.at + 2).map_or("", |token| token.text);
                places.split('_').find_map(|part| part.parse().ok())
            }
            None => return Err(format!("`{name}` is not known")),
        };
        let known = table.and_then(|table| Some((table, *self.tables.get(table)?)));
        let Some((table, number)) = known else { return self.unknown() };
        let arguments = if own.is_none() { arguments(&table.to_string()) } else { String::new() };
        self.at += 1;
        self.expect("(")?;
        arguments.split_whitespace().try_for_each(|word| self.expect(word))?;
        let order = self.integer()?;
        self.expect(",").map(|()| Meant::Spline(number, order))
    }
}

/// Operands, and what waits for them.
#[derive(Default)]
struct Stack {
    values: Vec<Number>,
    open: Vec<Open>,
}

impl Stack {
    fn value(&mut self) -> Reading<Number> {
        self.values.pop().ok_or_else(|| "an operand is missing".to_string())
    }
}
