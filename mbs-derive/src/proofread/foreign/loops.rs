//! Loops over links, read turn by turn, and arrays whose numbers they give.

use super::super::numbering::Number;
use super::super::reading::Reading;
use super::super::token::Kind;
use super::dialect::Family;
use super::expression::{Reader, Turn, Value};

/// How many tokens a loop of C has before its first statement.
const BODY_OF_LOOP: usize = 16;

/// The name of an index, and its values.
type Turns<'t> = (&'t str, Vec<usize>);

impl<'t> Reader<'_, 't> {
    /// `name[i] = value;` of an array whose numbers are given one by one, each once.
    pub(super) fn keep(&mut self, name: &'t str, count: usize) -> Reading<()> {
        self.at += 1;
        let place = self.index(&[count], false)?;
        self.expect("=")?;
        let value = self.expression()?;
        match self.kept.get_mut(name).map(|numbers| numbers[place].replace(value)) {
            Some(None) => self.ended(),
            _ => Err(format!("`{name}[{place}]` has a value already")),
        }
    }

    /// Whether what comes next is written to an array of the caller: `result[…`, or
    /// `for (int i = 0; i < 9; i += 1) { result[…`.
    pub(super) fn is_storing(&self, array: &str) -> bool {
        let ahead = if self.is_next("for") { BODY_OF_LOOP } else { 0 };
        self.tokens.get(self.at + ahead).is_some_and(|token| token.is(array))
    }

    /// The numbers that a loop writes to an array of the caller.
    pub(super) fn kept_in_loop(&mut self, array: &str, count: usize) -> Reading<Vec<Number>> {
        self.names.insert(array.to_string(), Value::Kept(count));
        self.kept.insert(array.to_string(), vec![None; count]);
        self.repeated()?;
        self.names.remove(array);
        let numbers: Option<Vec<Number>> = self.kept.remove(array).into_iter().flatten().collect();
        numbers.ok_or_else(|| format!("`{array}` has not all of its values"))
    }

    /// A loop, read once for each turn.
    pub(super) fn repeated(&mut self) -> Reading<()> {
        if self.turn.is_some() {
            return self.unknown();
        }
        self.expect("for")?;
        let (index, values) = match self.dialect.family {
            Family::C | Family::Js => self.turns(),
            Family::Python => self.turns_of_python(),
            Family::Matlab => self.turns_of_matlab(),
        }?;
        if self.names.contains_key(index) {
            return Err(format!("`{index}` has a value already"));
        }
        if values.is_empty() {
            return Err("a loop has no turns".to_string());
        }
        let start = self.at;
        for value in values {
            self.at = start;
            self.turn = Some(Turn { index, value, bound: Vec::new() });
            self.statements(Self::is_end_of_loop)?;
            for name in self.turn.take().into_iter().flat_map(|turn| turn.bound) {
                self.names.remove(name);
            }
        }
        match self.dialect.family {
            Family::C | Family::Js => self.expect("}"),
            Family::Python => Ok(()),
            Family::Matlab => {
                self.at += 1;
                self.expect("end")
            }
        }
    }

    fn is_end_of_loop(&self) -> bool {
        let next = self.peek();
        match self.dialect.family {
            Family::C | Family::Js => self.is_next("}"),
            Family::Python => next.is_none_or(|token| token.kind == Kind::Line && token.text.len() < self.column()),
            Family::Matlab => {
                let behind = self.tokens.get(self.at + 1);
                next.is_some_and(|token| token.kind == Kind::Line) && behind.is_some_and(|token| token.is("end"))
            }
        }
    }

    /// `(int i = 1; i < 9; i += 1) {`, or `(let i = 7; i >= 1; i -= 1) {`
    fn turns(&mut self) -> Reading<Turns<'t>> {
        self.expect("(")?;
        self.expect(if self.dialect.family == Family::C { "int" } else { "let" })?;
        let index = self.name()?;
        self.expect("=")?;
        let first = self.integer()?;
        [";", index].into_iter().try_for_each(|word| self.expect(word))?;
        let is_inwards = self.takes(">=");
        if !is_inwards {
            self.expect("<")?;
        }
        let end = self.integer()?;
        let onwards = if is_inwards { "-=" } else { "+=" };
        [";", index, onwards, "1", ")", "{"].into_iter().try_for_each(|word| self.expect(word))?;
        Ok((index, if is_inwards { (end..=first).rev().collect() } else { (first..end).collect() }))
    }

    /// `i in range(9):`, `i in range(1, 9):`, or `i in reversed(range(1, 8)):`
    fn turns_of_python(&mut self) -> Reading<Turns<'t>> {
        let index = self.name()?;
        self.expect("in")?;
        let is_inwards = self.takes("reversed");
        if is_inwards {
            self.expect("(")?;
        }
        ["range", "("].into_iter().try_for_each(|word| self.expect(word))?;
        let (mut first, mut end) = (0, self.integer()?);
        if self.takes(",") {
            (first, end) = (end, self.integer()?);
        }
        self.expect(")")?;
        if is_inwards {
            self.expect(")")?;
        }
        self.expect(":")?;
        Ok((index, if is_inwards { (first..end).rev().collect() } else { (first..end).collect() }))
    }

    /// `i = 1:8`, or `i = 7:-1:1`
    fn turns_of_matlab(&mut self) -> Reading<Turns<'t>> {
        let index = self.name()?;
        self.expect("=")?;
        let first = self.integer()?;
        self.expect(":")?;
        if !self.takes("-") {
            let last = self.integer()?;
            return Ok((index, (first..=last).collect()));
        }
        ["1", ":"].into_iter().try_for_each(|word| self.expect(word))?;
        let last = self.integer()?;
        Ok((index, (last..=first).rev().collect()))
    }
}
