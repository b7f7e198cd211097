//! Expressions of languages with infix operators, evaluated as they are parsed.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::expr::{Binary, Function};

use super::super::numbering::{Number, Numbering};
use super::super::reader::Reading;
use super::dialect::{Dialect, Family, Meant};
use super::token::{Kind, Token};
use super::value::{Step, Value};

/// A function that others call: what with, and what it gives.
#[derive(Clone, Debug)]
pub(super) struct Method {
    pub(super) arguments: Vec<Value>,
    pub(super) result: Value,
}

/// What all functions of a text see.
#[derive(Default)]
pub(super) struct Surroundings {
    pub(super) methods: BTreeMap<String, Method>,
    /// The number of the spline that a function of C evaluates.
    pub(super) tables: BTreeMap<String, usize>,
    /// Constants of the module.
    pub(super) constants: BTreeMap<String, Value>,
}

/// Reads the tokens of one function.
pub(super) struct Reader<'r, 't> {
    pub(super) dialect: &'r Dialect,
    pub(super) surroundings: &'r Surroundings,
    pub(super) numbering: &'r mut Numbering,
    pub(super) tokens: &'r [Token<'t>],
    pub(super) at: usize,
    pub(super) names: HashMap<String, Value>,
    /// What names meant before they were changed, while a side of a branch is read.
    pub(super) changes: Vec<(String, Option<Value>)>,
    /// How many sides of branches are around.
    pub(super) sides: usize,
    /// The arguments whose sizes were looked at.
    pub(super) looked_at: BTreeSet<String>,
}

impl<'r, 't> Reader<'r, 't> {
    pub(super) fn peek(&self) -> Option<Token<'t>> {
        self.tokens.get(self.at).copied()
    }

    pub(super) fn next(&mut self) -> Reading<Token<'t>> {
        let token = self.peek().ok_or("the text ends too early")?;
        self.at += 1;
        Ok(token)
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

    pub(super) fn name(&mut self) -> Reading<&'t str> {
        match self.next()? {
            Token { kind: Kind::Name, text, .. } => Ok(text),
            _ => {
                self.at -= 1;
                self.unknown()
            }
        }
    }

    /// What is refused: the tokens from here on.
    pub(super) fn unknown<T>(&self) -> Reading<T> {
        let from = self.at.saturating_sub(3).min(self.tokens.len());
        let some = self.tokens[from..].iter().take(12).map(|token| token.text.trim());
        Err(format!("`{}` cannot be read", some.collect::<Vec<_>>().join(" ")))
    }

    /// The value of an expression.
    pub(super) fn expression(&mut self) -> Reading<Value> {
        let value = self.level(0)?;
        if !self.dialect.has_choices || !self.takes("?") {
            return Ok(value);
        }
        let condition = self.as_number(value)?;
        let then = self.level(0)?;
        self.expect(":")?;
        let otherwise = self.expression()?;
        let [then, otherwise] = [self.as_number(then)?, self.as_number(otherwise)?];
        Ok(self.numbering.select(condition, then, otherwise).into())
    }

    pub(super) fn number(&mut self) -> Reading<Number> {
        let value = self.expression()?;
        self.as_number(value)
    }

    pub(super) fn as_number(&self, value: Value) -> Reading<Number> {
        match value {
            Value::Number(number) => Ok(number),
            other => Err(format!("{} stands for a number", other.shown(self.numbering))),
        }
    }

    /// Operators of this level and of all that bind tighter.
    fn level(&mut self, level: usize) -> Reading<Value> {
        let Some(operators) = self.dialect.levels.get(level) else { return self.unary() };
        let mut value = self.level(level + 1)?;
        while let Some(operator) = operators.iter().find(|operator| self.is_next(operator)) {
            self.at += 1;
            let other = self.level(level + 1)?;
            let (a, b) = (self.as_number(value)?, self.as_number(other)?);
            let numbering = &mut *self.numbering;
            value = Value::Number(match *operator {
                "+" => numbering.sum(a, b),
                "-" => numbering.sum(a, b.opposite()),
                "*" => numbering.product(a, b),
                "/" => numbering.quotient(a, b),
                "<" => numbering.less(a, b),
                "<=" => numbering.less_equal(a, b),
                _ => numbering.and(a, b),
            });
        }
        Ok(value)
    }

    fn unary(&mut self) -> Reading<Value> {
        if self.takes("-") {
            let value = self.unary()?;
            return Ok(self.as_number(value)?.opposite().into());
        }
        if self.takes(self.dialect.not) {
            let value = self.unary()?;
            let condition = self.as_number(value)?;
            return Ok(self.numbering.not(condition).into());
        }
        let value = self.primary()?;
        self.behind(value)
    }

    fn primary(&mut self) -> Reading<Value> {
        let token = self.next()?;
        match token.kind {
            Kind::Number if token.text.contains(['.', 'e', 'E']) => {
                let value = token.text.parse().map_err(|_| format!("`{}` is no number", token.text))?;
                Ok(self.numbering.constant(value).into())
            }
            Kind::Number => {
                token.text.parse().map(Value::Integer).map_err(|_| format!("`{}` is no number", token.text))
            }
            Kind::Text => Ok(Value::Text(token.text[1..token.text.len() - 1].to_string())),
            Kind::Name => self.named(token.text),
            Kind::Mark if token.text == "(" => {
                let (mut values, is_tuple) = self.list(")")?;
                if values.len() == 1 && !is_tuple { Ok(values.remove(0)) } else { Ok(Value::Array(values)) }
            }
            Kind::Mark if token.text == "[" => self.rows(),
            Kind::Mark if token.text == "{" && self.dialect.has_objects => self.object(),
            Kind::Mark if token.text == "{" => self.list("}").map(|(values, _)| Value::Array(values)),
            Kind::Mark | Kind::End => {
                self.at -= 1;
                self.unknown()
            }
        }
    }

    /// Values up to a bracket, and whether a comma is behind the last one.
    pub(super) fn list(&mut self, close: &str) -> Reading<(Vec<Value>, bool)> {
        let mut values = Vec::new();
        loop {
            self.skip_ends();
            if self.takes(close) {
                return Ok((values, true));
            }
            values.push(self.expression()?);
            self.skip_ends();
            if self.takes(close) {
                return Ok((values, false));
            }
            self.expect(",")?;
        }
    }

    pub(super) fn skip_ends(&mut self) {
        while self.peek().is_some_and(|token| token.kind == Kind::End) {
            self.at += 1;
        }
    }

    /// `[a, b]`, or rows `[a, b; c, d]`.
    fn rows(&mut self) -> Reading<Value> {
        let (mut rows, mut row) = (Vec::new(), Vec::new());
        loop {
            let is_row = self.peek().is_some_and(|token| token.is(";") || token.kind == Kind::End);
            if is_row || self.is_next("]") {
                self.at += 1;
                if !row.is_empty() {
                    rows.push(Value::Array(std::mem::take(&mut row)));
                }
                if is_row {
                    continue;
                }
                let is_matrix = rows.len() > 1;
                return Ok(if is_matrix { Value::Array(rows) } else { rows.pop().unwrap_or(Value::Array(Vec::new())) });
            }
            row.push(self.expression()?);
            let _ = self.takes(",");
        }
    }

    /// `{ position: a, rotation }`
    fn object(&mut self) -> Reading<Value> {
        let mut fields = BTreeMap::new();
        loop {
            self.skip_ends();
            if self.takes("}") {
                return Ok(Value::Struct(fields));
            }
            let name = self.name()?;
            let value = if self.takes(":") { self.expression()? } else { self.named(name)? };
            if fields.insert(name.to_string(), value).is_some() {
                return Err(format!("`{name}` is there twice"));
            }
            self.skip_ends();
            if !self.takes(",") && !self.is_next("}") {
                return self.unknown();
            }
        }
    }

    /// What begins with a name: a variable, a constant, or a call.
    fn named(&mut self, name: &'t str) -> Reading<Value> {
        if name == "new" {
            let name = self.name()?;
            return self.named(name);
        }
        let is_itself = name == self.dialect.itself;
        if let Some(found) = self.names.get(name)
            && !is_itself
        {
            return match self.reached(found.clone())? {
                Value::Unset => Err(format!("`{name}` is read before it has a value")),
                value => Ok(value),
            };
        }
        let mut path = name.to_string();
        while self.is_next(".") || self.is_next("->") {
            self.at += 1;
            let field = self.name()?;
            path = format!("{path}.{field}");
            if let (true, Some(part)) = (is_itself, self.names.get(name)) {
                // A field of the mechanism; else a function of it.
                match part.part(&Step::Field(field.to_string())) {
                    Some(part) => {
                        let part = part.clone();
                        return self.reached(part);
                    }
                    None => path = field.to_string(),
                }
            }
        }
        if self.takes("(") {
            let (arguments, _) = self.list(")")?;
            return self.call(&path, arguments);
        }
        if self.dialect.pi == path {
            return Ok(self.numbering.constant(std::f64::consts::PI).into());
        }
        if is_itself && path == name {
            return Ok(Value::Text(name.to_string()));
        }
        self.surroundings.constants.get(&path).cloned().ok_or_else(|| format!("`{path}` is not known"))
    }

    /// The part of a value that the fields and indices behind lead to.
    fn reached(&mut self, mut value: Value) -> Reading<Value> {
        while let Value::Array(_) | Value::Struct(_) = value {
            let steps = match self.step()? {
                Some(steps) => steps,
                None => break,
            };
            for step in &steps {
                value = value.part(step).cloned().ok_or_else(|| format!("there is no part {step:?}"))?;
            }
        }
        Ok(value)
    }

    /// `.field`, `[i]`, `[..., i, j]` or `(i, j)`, if it is there.
    pub(super) fn step(&mut self) -> Reading<Option<Vec<Step>>> {
        if self.takes(".") || self.takes("->") {
            return Ok(Some(vec![Step::Field(self.name()?.to_string())]));
        }
        let [open, close] = self.dialect.index;
        if !self.takes(open) {
            return Ok(None);
        }
        let mut steps = Vec::new();
        if self.takes("...") {
            self.expect(",")?;
        }
        loop {
            match self.next()? {
                Token { kind: Kind::Number, text, .. } => {
                    let index: usize = text.parse().map_err(|_| format!("`{text}` is no index"))?;
                    let index = index.checked_sub(self.dialect.first).ok_or("an index is too small")?;
                    steps.push(Step::Index(index));
                }
                _ => {
                    self.at -= 1;
                    return self.unknown();
                }
            }
            if self.takes(close) {
                return Ok(Some(steps));
            }
            self.expect(",")?;
        }
    }

    /// Fields, indices and functions of what a call has given.
    fn behind(&mut self, mut value: Value) -> Reading<Value> {
        loop {
            let is_called = matches!(value, Value::Call(..));
            if is_called && self.takes(".") {
                let name = self.name()?;
                let mut arguments = vec![value];
                if self.takes("(") {
                    arguments.extend(self.list(")")?.0);
                }
                value = Value::call(&format!(".{name}"), arguments);
            } else if is_called && self.takes(self.dialect.index[0]) {
                let mut arguments = vec![value];
                arguments.extend(self.parts()?);
                value = Value::call("[]", arguments);
            } else if let (Value::Array(_) | Value::Struct(_), true) =
                (&value, self.is_next(".") || self.is_next(self.dialect.index[0]))
            {
                value = self.reached(value)?;
            } else {
                return Ok(value);
            }
        }
    }

    /// Indices of a part: numbers, `1:3`, `...`, `()`.
    fn parts(&mut self) -> Reading<Vec<Value>> {
        let close = self.dialect.index[1];
        let mut parts = Vec::new();
        loop {
            if self.takes("...") {
                parts.push(Value::Text("...".to_string()));
            } else if self.takes(":") {
                let end = self.level(0)?;
                parts.push(Value::call(":", [end]));
            } else {
                let first = self.level(0)?;
                let is_range = self.takes(":");
                let has_end = is_range && !self.is_next(",") && !self.is_next(close);
                parts.push(match (is_range, has_end) {
                    (true, true) => {
                        let end = self.level(0)?;
                        Value::call(":", [first, end])
                    }
                    (true, false) => Value::call(":", [first, Value::Unset]),
                    (false, _) => first,
                });
            }
            if self.takes(close) {
                return Ok(parts);
            }
            self.expect(",")?;
        }
    }

    /// A call of a function.
    fn call(&mut self, name: &str, arguments: Vec<Value>) -> Reading<Value> {
        if let Some(method) = self.surroundings.methods.get(name) {
            if arguments != method.arguments {
                return Err(format!("`{name}` is called with other arguments than it takes"));
            }
            return Ok(method.result.clone());
        }
        if let (Some(&table), [Value::Integer(order), Value::Number(x)]) =
            (self.surroundings.tables.get(name), arguments.as_slice())
        {
            return Ok(self.numbering.spline(table, *order, *x).into());
        }
        let Some(meant) = self.dialect.function(name) else {
            let is_shared =
                name.starts_with("mbs_") || name.ends_with("Result") || self.dialect.library.contains(&name);
            return if is_shared { Ok(Value::call(name, arguments)) } else { Err(format!("`{name}` is not known")) };
        };
        self.computed(meant, name, &arguments)
    }

    /// What functions of the language compute.
    fn computed(&mut self, meant: Meant, name: &str, arguments: &[Value]) -> Reading<Value> {
        if let (Meant::Argument, [Value::Text(name), value, sizes @ ..]) = (meant, arguments) {
            self.sized(name, value, sizes)?;
            return Ok(value.clone());
        }
        let numbering = &mut *self.numbering;
        let found = match (meant, arguments) {
            (Meant::Itself, [Value::Number(a)]) => *a,
            (Meant::Root, [Value::Number(a)]) => numbering.root(*a),
            (Meant::Call(function), [Value::Number(a)]) => numbering.call(function, *a),
            (Meant::Call2(function), [Value::Number(a), Value::Number(b)]) => numbering.call2(function, *a, *b),
            (Meant::Select, [Value::Number(c), Value::Number(a), Value::Number(b)]) => numbering.select(*c, *a, *b),
            (Meant::SinCos, [Value::Number(angle)]) => {
                let both = [Function::Sin, Function::Cos].map(|function| numbering.call(function, *angle));
                return Ok(Value::Array(both.map(Value::from).to_vec()));
            }
            (Meant::Spline, [places, rows, Value::Integer(order), Value::Number(x)]) => {
                let table = table(numbering, places, rows).ok_or("a spline is of no table")?;
                numbering.spline(table, *order, *x)
            }
            (Meant::Zeros, [Value::Integer(rows), Value::Integer(columns)]) => {
                let zero = Value::Number(numbering.constant(0.0));
                let row = if *columns == 1 { zero } else { Value::Array(vec![zero; *columns]) };
                return Ok(Value::Array(vec![row; *rows]));
            }
            (Meant::Zeros, [Value::Integer(n), Value::Integer(rows), Value::Integer(columns)]) => {
                let zero = Value::Number(numbering.constant(0.0));
                return Ok(Value::Array(vec![Value::Array(vec![Value::Array(vec![zero; *columns]); *rows]); *n]));
            }
            (Meant::Zeros, [Value::Integer(n)]) => {
                let zero = Value::Number(numbering.constant(0.0));
                return Ok(Value::Array(vec![Value::Array(vec![zero; *n]); *n]));
            }
            (Meant::Struct, [Value::Text(first), a, Value::Text(second), b]) => {
                let fields = [(first.clone(), a.clone()), (second.clone(), b.clone())];
                return Ok(Value::Struct(fields.into()));
            }
            (Meant::Repeated, [value, Value::Integer(count), Value::Integer(1)]) => {
                return Ok(Value::Array(vec![value.clone(); *count]));
            }
            _ => return Err(format!("`{name}` has other arguments than it takes")),
        };
        Ok(found.into())
    }

    /// Whether an argument is what it is called and has as many components as are asked for.
    pub(super) fn sized(&mut self, name: &str, value: &Value, sizes: &[Value]) -> Reading<()> {
        let count = sizes.iter().try_fold(1, |count, size| match size {
            Value::Integer(size) => Ok(count * size),
            _ => Err("a size is no number".to_string()),
        })?;
        // JavaScript counts motions, each of which is three numbers.
        let found = match value {
            Value::Array(entries) if self.dialect.family == Family::Js => entries.len(),
            other => other.flat()?.len(),
        };
        if self.names.get(name) != Some(value) || found != count {
            return Err(format!("`{name}` is not looked at as it should be"));
        }
        self.looked_at.insert(name.to_string());
        Ok(())
    }
}

/// The number of the spline with these places and rows.
pub(super) fn table(numbering: &mut Numbering, places: &Value, rows: &Value) -> Option<usize> {
    let numbers = |value: &Value| match value {
        Value::Array(entries) => {
            let number = |entry: &Value| match entry {
                Value::Number(number) => numbering.known(*number),
                _ => None,
            };
            entries.iter().map(number).collect::<Option<Vec<f64>>>()
        }
        _ => None,
    };
    let Value::Array(all) = rows else { return None };
    let rows = all.iter().map(numbers).collect::<Option<Vec<_>>>()?;
    let places = numbers(places)?;
    Some(numbering.table(&places, &rows))
}

/// A function of two arguments by its name on `Scalar`.
pub(super) fn binary(name: &str) -> Option<Binary> {
    Binary::ALL.into_iter().find(|function| function.name() == name)
}

/// A function of one argument by its name on `Scalar`.
pub(super) fn unary(name: &str) -> Option<Function> {
    Function::ALL.into_iter().chain([Function::Sech]).find(|function| function.name() == name)
}
