//! Rust, as far as it is emitted, read as meanings: each expression is evaluated into the numbers of its values.
//!
//! What is not known here is refused: a text that cannot be read is not the Program.

mod assignment;

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use crate::expr::{Binary, Function, Trigonometry};

use super::meaning::Meaning;
use super::numbering::{Number, Numbering};
use super::reading::{Reading, cannot_read, unknown};
use super::rust::{Block, Expression, ExpressionKind, Pattern, PatternKind, Statement, compact};

/// A function of the mechanism that others may call.
pub(super) struct Method {
    /// What it is to be called with.
    pub(super) arguments: Vec<Meaning>,
    /// What it gives.
    pub(super) result: Meaning,
}

/// What all functions of a module see.
#[derive(Default)]
pub(super) struct Module {
    /// Constants, by name: the tables.
    pub(super) constants: BTreeMap<String, Meaning>,
    /// Functions of the mechanism.
    pub(super) methods: BTreeMap<String, Method>,
    pub(super) trigonometry: Trigonometry,
}

/// Reads one function.
pub(super) struct Reader<'r> {
    module: &'r Module,
    numbering: &'r mut Numbering,
    /// Where the meaning of each name in sight is.
    names: HashMap<String, usize>,
    /// The meanings of all locals; of those that are declared and not yet bound there is none.
    locals: Vec<Option<Meaning>>,
    /// What names meant before inner blocks gave them another meaning.
    shadowed: Vec<(String, Option<usize>)>,
    /// The locals before this one are not a closure's own.
    outer: usize,
    /// The local that is written for the caller, and nowhere read.
    storage: Option<usize>,
    /// What was asked of parameters, in order: the function of the runtime and its arguments.
    pub(super) required: Vec<Meaning>,
}

impl<'r> Reader<'r> {
    pub(super) fn new<'a>(
        module: &'r Module,
        numbering: &'r mut Numbering,
        bound: impl IntoIterator<Item = (&'a str, Meaning)>,
    ) -> Self {
        let (names, locals, shadowed, required) = (HashMap::new(), Vec::new(), Vec::new(), Vec::new());
        let mut reader = Reader { module, numbering, names, locals, shadowed, outer: 0, storage: None, required };
        bound.into_iter().for_each(|(name, meaning)| reader.define(name.to_string(), Some(meaning)));
        reader
    }

    // ---- statements

    /// The value of a block.
    pub(super) fn block(&mut self, block: &Block<'_>) -> Reading<Meaning> {
        self.within(|reader| {
            block.statements.iter().try_for_each(|statement| reader.statement(statement))?;
            block.value.as_ref().map_or(Ok(Meaning::Tuple(Rc::new([]))), |last| reader.value(last))
        })
    }

    /// What names mean within is forgotten behind.
    fn within<V>(&mut self, read: impl FnOnce(&mut Self) -> Reading<V>) -> Reading<V> {
        let before = self.shadowed.len();
        let value = read(self)?;
        for (name, place) in self.shadowed.split_off(before).into_iter().rev() {
            match place {
                Some(place) => self.names.insert(name, place),
                None => self.names.remove(&name),
            };
        }
        Ok(value)
    }

    fn statement(&mut self, statement: &Statement<'_>) -> Reading<()> {
        match statement {
            Statement::Let(Pattern { kind: PatternKind::Name(name, true), .. }, value)
            | Statement::Static(name, value) => {
                let value = self.value(value)?;
                self.define(name.to_string(), Some(value));
                Ok(())
            }
            Statement::Let(pattern, value) => {
                let value = self.value(value)?;
                self.bind(pattern, value)
            }
            Statement::Declare(pattern, declared) => self.declare(pattern, declared),
            Statement::Block(inner) => self.block(inner).and_then(nothing),
            Statement::Assign(place, value) => {
                let value = self.value(value)?;
                self.assign(place, value)
            }
            Statement::For(pattern, values, body) => {
                let Meaning::List(entries) = self.value(values)? else { return unknown(values.text) };
                for entry in entries.iter() {
                    self.within(|reader| {
                        reader.bind(pattern, entry.clone())?;
                        reader.block(body).and_then(nothing)
                    })?;
                }
                Ok(())
            }
            Statement::Try(tried) => {
                let required = self.value(tried)?;
                self.required.push(required);
                Ok(())
            }
        }
    }

    /// `let [a, b]: [T; 2];`
    fn declare(&mut self, pattern: &Pattern<'_>, declared: &str) -> Reading<()> {
        let PatternKind::List(elements, false) = &pattern.kind else { return unknown(pattern.text) };
        if compact(declared) != format!("[T;{}]", elements.len()) {
            return unknown(declared);
        }
        for element in elements {
            match element.kind {
                PatternKind::Name(name, false) => self.define(name.to_string(), None),
                _ => return unknown(element.text),
            }
        }
        Ok(())
    }

    fn define(&mut self, name: String, meaning: Option<Meaning>) {
        let before = self.names.insert(name.clone(), self.locals.len());
        self.shadowed.push((name, before));
        self.locals.push(meaning);
    }

    /// Reads a block that writes to storage of the caller, of this name and with nothing written; what is there then.
    pub(super) fn written(&mut self, block: &Block<'_>, name: &str, unwritten: Meaning) -> Reading<Meaning> {
        let local = self.locals.len();
        self.define(name.to_string(), Some(unwritten));
        self.storage = Some(local);
        self.block(block).and_then(nothing)?;
        self.locals[local].clone().ok_or_else(|| format!("`{name}` is not written"))
    }

    /// Gives the names of a pattern their meaning.
    fn bind(&mut self, pattern: &Pattern<'_>, meaning: Meaning) -> Reading<()> {
        match (&pattern.kind, meaning) {
            (PatternKind::Wild, _) => Ok(()),
            (PatternKind::Name(name, false), meaning) => {
                self.define(name.to_string(), Some(meaning));
                Ok(())
            }
            (PatternKind::Typed(typed, of), meaning @ Meaning::Closure(_)) if compact(of) == "&dynFn()->T" => {
                self.bind(typed, meaning)
            }
            (PatternKind::List(elements, rest), meaning) => {
                let count = elements.len();
                let values = match meaning {
                    Meaning::List(values) if *rest && values.len() >= count => values[..count].to_vec(),
                    meaning if !rest => self.entries(meaning, count)?,
                    _ => return unknown(pattern.text),
                };
                elements.iter().zip(values).try_for_each(|(element, value)| self.bind(element, value))
            }
            (PatternKind::Tuple(elements), Meaning::Tuple(values)) if elements.len() == values.len() => {
                elements.iter().zip(values.iter()).try_for_each(|(element, value)| self.bind(element, value.clone()))
            }
            (PatternKind::Record(own, read, rest), Meaning::Record(path, fields)) if *own == path => {
                if !rest && read.len() != fields.len() {
                    return Err(format!("not all fields of `{path}` are read"));
                }
                read.iter().try_for_each(|(name, element)| {
                    let value = fields.get(*name).ok_or_else(|| format!("`{path}` has no field `{name}`"))?;
                    self.bind(element, value.clone())
                })
            }
            _ => unknown(pattern.text),
        }
    }

    /// The entries of an array of this length.
    fn entries(&mut self, meaning: Meaning, count: usize) -> Reading<Vec<Meaning>> {
        match meaning {
            Meaning::List(values) if values.len() == count => Ok(values.to_vec()),
            Meaning::Derivatives(table, x) => {
                Ok((0..count).map(|order| Meaning::Number(self.numbering.spline(table, order, x))).collect())
            }
            other => Err(format!("{} are taken apart as {count}", other.shown(self.numbering))),
        }
    }

    // ---- expressions

    /// The meaning of an expression.
    pub(super) fn value(&mut self, expression: &Expression<'_>) -> Reading<Meaning> {
        match &expression.kind {
            ExpressionKind::Same(inner) => self.value(inner),
            ExpressionKind::Block(inner) => self.block(inner),
            ExpressionKind::Float(value) => Ok(Meaning::Literal(*value)),
            ExpressionKind::Integer(value) => Ok(Meaning::Integer(*value)),
            ExpressionKind::Text(text) => Ok(Meaning::Text(text.clone())),
            ExpressionKind::Path(path) => self.path(path),
            ExpressionKind::Unary(sign, operand) => self.unary(*sign, operand, expression.text),
            ExpressionKind::Range(ends) => match (self.value(&ends[0])?, self.value(&ends[1])?) {
                (Meaning::Integer(start), Meaning::Integer(end)) => {
                    Ok(Meaning::list((start..end).map(Meaning::Integer)))
                }
                _ => unknown(expression.text),
            },
            ExpressionKind::Binary(sign, operands) if self.is_integer(&operands[0]) => {
                let integer = match (self.value(&operands[0])?, sign, self.value(&operands[1])?) {
                    (Meaning::Integer(a), '+', Meaning::Integer(b)) => a.checked_add(b),
                    (Meaning::Integer(a), '-', Meaning::Integer(b)) => a.checked_sub(b),
                    (Meaning::Integer(a), '*', Meaning::Integer(b)) => a.checked_mul(b),
                    _ => None,
                };
                integer.map_or_else(|| unknown(expression.text), |integer| Ok(Meaning::Integer(integer)))
            }
            ExpressionKind::Binary(sign, operands) => {
                let [a, b] = [self.number(&operands[0])?, self.number(&operands[1])?];
                Ok(Meaning::Number(match sign {
                    '+' => self.numbering.sum(a, b),
                    '-' => self.numbering.sum(a, b.opposite()),
                    '*' => self.numbering.product(a, b),
                    '/' => self.numbering.quotient(a, b),
                    '&' => self.numbering.and(a, b),
                    _ => return unknown(expression.text),
                }))
            }
            ExpressionKind::Array(entries) => self.values(entries).map(Meaning::list),
            ExpressionKind::Tuple(parts) => self.values(parts).map(|parts| Meaning::Tuple(parts.into())),
            ExpressionKind::Repeat(parts) => {
                let Meaning::Integer(count) = self.value(&parts[1])? else { return unknown(expression.text) };
                let value = self.value(&parts[0])?;
                Ok(Meaning::list(vec![value; count]))
            }
            ExpressionKind::Record(path, given) => {
                let mut fields = BTreeMap::new();
                for (name, value) in given {
                    fields.insert(name.to_string(), self.value(value)?);
                }
                Ok(Meaning::Record(path.clone(), Rc::new(fields)))
            }
            ExpressionKind::Field(of, name) => {
                let of = self.value(of)?;
                let found = match &of {
                    Meaning::Record(_, fields) => fields.get(*name),
                    Meaning::Tuple(parts) => name.parse().ok().and_then(|i: usize| parts.get(i)),
                    _ => None,
                };
                found.cloned().ok_or_else(|| format!("there is no field `{name}`"))
            }
            ExpressionKind::Index(parts) => match (self.value(&parts[0])?, self.value(&parts[1])?) {
                (Meaning::List(entries), Meaning::Integer(i)) if i < entries.len() => Ok(entries[i].clone()),
                _ => unknown(expression.text),
            },
            ExpressionKind::Closure(body) => {
                let outer = std::mem::replace(&mut self.outer, self.locals.len());
                let value = self.value(body)?;
                self.outer = outer;
                Ok(Meaning::Closure(Rc::new(value)))
            }
            ExpressionKind::Call(function, arguments) => self.call(function, arguments, expression.text),
            ExpressionKind::Method(receiver, name, arguments) => {
                self.method(receiver, name, arguments, expression.text)
            }
            ExpressionKind::Wild | ExpressionKind::Function => unknown(expression.text),
        }
    }

    /// Whether it is an index, or begins with one.
    fn is_integer(&self, expression: &Expression<'_>) -> bool {
        match &expression.kind {
            ExpressionKind::Path(path) => {
                let local = self.names.get(path);
                local.is_some_and(|&local| matches!(self.locals[local], Some(Meaning::Integer(_))))
            }
            ExpressionKind::Integer(_) => true,
            ExpressionKind::Same(inner) => self.is_integer(inner),
            ExpressionKind::Binary(_, operands) => self.is_integer(&operands[0]),
            _ => false,
        }
    }

    fn values(&mut self, expressions: &[Expression<'_>]) -> Reading<Vec<Meaning>> {
        expressions.iter().map(|expression| self.value(expression)).collect()
    }

    fn number(&mut self, expression: &Expression<'_>) -> Reading<Number> {
        match self.value(expression)? {
            Meaning::Number(number) => Ok(number),
            other => Err(format!("{} stands for a number", other.shown(self.numbering))),
        }
    }

    fn path(&mut self, name: &str) -> Reading<Meaning> {
        if let Some(&local) = self.names.get(name) {
            if Some(local) == self.storage {
                return Err(format!("`{name}` is read"));
            }
            let known = self.locals[local].clone();
            return known.ok_or_else(|| format!("`{name}` is read before it has a value"));
        }
        match name {
            "T::from_f64" => Ok(Meaning::FromF64),
            "core::f64::consts::PI" => Ok(Meaning::Literal(std::f64::consts::PI)),
            _ if name.starts_with("mbs_runtime::") || name.starts_with("core::") => Ok(Meaning::Path(name.to_string())),
            _ => self.module.constants.get(name).cloned().ok_or_else(|| format!("`{name}` is not known")),
        }
    }

    fn unary(&mut self, sign: char, operand: &Expression<'_>, text: &str) -> Reading<Meaning> {
        match (sign, self.value(operand)?) {
            ('-', Meaning::Number(a)) => Ok(Meaning::Number(a.opposite())),
            ('-', Meaning::Literal(value)) => Ok(Meaning::Literal(-value)),
            ('!', Meaning::Number(a)) => Ok(Meaning::Number(self.numbering.not(a))),
            ('*', Meaning::OnDemand(of)) => Ok((*of).clone()),
            ('*', of @ (Meaning::List(_) | Meaning::Record(..))) => Ok(of),
            _ => unknown(text),
        }
    }

    /// A call of a function by its path.
    fn call(&mut self, function: &str, arguments: &[Expression<'_>], text: &str) -> Reading<Meaning> {
        if function == "core::array::from_fn" {
            return self.columns(text);
        }
        let arguments = self.values(arguments)?;
        let constant = |reader: &mut Self, value: f64| Ok(Meaning::Number(reader.numbering.constant(value)));
        match (function, arguments.as_slice()) {
            ("T::zero", []) => constant(self, 0.0),
            ("T::one", []) => constant(self, 1.0),
            ("T::select", [Meaning::Number(c), Meaning::Closure(a), Meaning::Closure(b)]) => match (&**a, &**b) {
                (Meaning::Number(a), Meaning::Number(b)) => Ok(Meaning::Number(self.numbering.select(*c, *a, *b))),
                _ => unknown(text),
            },
            ("T::blend", [Meaning::Number(c), Meaning::Number(a), Meaning::Number(b)]) => {
                Ok(Meaning::Number(self.numbering.select(*c, *a, *b)))
            }
            ("T::select_each", [Meaning::Number(c), Meaning::Closure(a), Meaning::Closure(b)]) => match (&**a, &**b) {
                (Meaning::List(a), Meaning::List(b)) if a.len() == b.len() => {
                    let mut selected = Vec::new();
                    for pair in a.iter().zip(b.iter()) {
                        let (Meaning::Number(a), Meaning::Number(b)) = pair else { return unknown(text) };
                        selected.push(Meaning::Number(self.numbering.select(*c, *a, *b)));
                    }
                    Ok(Meaning::list(selected))
                }
                _ => unknown(text),
            },
            ("T::sin_cos_all", [Meaning::List(angles)]) if self.module.trigonometry == Trigonometry::Polynomials => {
                self.sines_and_cosines(angles).map(|parts| Meaning::Tuple(parts.map(Meaning::list).into()))
            }
            ("core::cell::LazyCell::new", [Meaning::Closure(of)]) => Ok(Meaning::OnDemand(of.clone())),
            ("core::result::Result::Ok", [result]) => Ok(result.clone()),
            _ if function.starts_with("mbs_runtime::") => Ok(Meaning::Call(function.to_string(), arguments.into())),
            _ => match (self.path(function)?, arguments.as_slice()) {
                (Meaning::FromF64, [Meaning::Literal(value)]) => constant(self, *value),
                _ => unknown(text),
            },
        }
    }

    fn sines_and_cosines(&mut self, angles: &[Meaning]) -> Reading<[Vec<Meaning>; 2]> {
        let [mut sines, mut cosines] = [Vec::new(), Vec::new()];
        for angle in angles {
            let Meaning::Number(angle) = angle else { return Err("an angle is not a number".to_string()) };
            sines.push(Meaning::Number(self.numbering.call(Function::Sin, *angle)));
            cosines.push(Meaning::Number(self.numbering.call(Function::Cos, *angle)));
        }
        Ok([sines, cosines])
    }

    /// `from_fn(|i| from_fn(|j| solution[i][2 + j]))`
    fn columns(&mut self, call: &str) -> Reading<Meaning> {
        let start = "::core::array::from_fn(|i|::core::array::from_fn(|j|solution[i][";
        // Blocks are the formatter's.
        let written = compact(call).replace(['{', '}'], "");
        let column = written.strip_prefix(start).and_then(|rest| rest.strip_suffix("]))"));
        let first = match column {
            Some("j") => Some(0),
            Some(column) => column.strip_suffix("+j").and_then(|first| first.parse().ok()),
            None => None,
        };
        let first = first.ok_or_else(|| cannot_read(call))?;
        let solution = self.path("solution")?;
        Ok(Meaning::Columns(Rc::new(solution), first))
    }

    fn method(
        &mut self,
        receiver: &Expression<'_>,
        name: &str,
        arguments: &[Expression<'_>],
        text: &str,
    ) -> Reading<Meaning> {
        if matches!(&receiver.kind, ExpressionKind::Path(path) if path == "self") {
            let method = self.module.methods.get(name).ok_or_else(|| format!("there is no function `{name}`"))?;
            if self.values(arguments)? != method.arguments {
                return Err(format!("`{name}` is called with other arguments than it takes"));
            }
            return Ok(method.result.clone());
        }
        let receiver = self.value(receiver)?;
        if let (Meaning::List(entries), "map", [argument]) = (&receiver, name, arguments) {
            return self.mapped(entries, argument.text);
        }
        let arguments = self.values(arguments)?;
        match (receiver, name, arguments.as_slice()) {
            (Meaning::Number(a), name, arguments) => {
                let mut numbers = Vec::new();
                for argument in arguments {
                    let Meaning::Number(number) = argument else { return unknown(text) };
                    numbers.push(*number);
                }
                self.operation(name, a, &numbers).unwrap_or_else(|| unknown(text))
            }
            (Meaning::Table(table), "derivatives", [Meaning::Number(x)]) => Ok(Meaning::Derivatives(table, *x)),
            (factors @ Meaning::Call(..), "solve_many", [right_side]) => {
                Ok(Meaning::Call(name.to_string(), [factors, right_side.clone()].into()))
            }
            (list @ Meaning::List(_), "into_iter", []) => Ok(list),
            (Meaning::List(entries), "rev", []) => Ok(Meaning::list(entries.iter().rev().cloned())),
            (Meaning::List(rows), "flatten", []) => {
                let mut all = Vec::new();
                for row in rows.iter() {
                    let Meaning::List(entries) = row else { return unknown(text) };
                    all.extend(entries.iter().cloned());
                }
                Ok(Meaning::list(all))
            }
            (Meaning::List(a), "zip", [Meaning::List(b)]) if a.len() == b.len() => {
                let pairs = a.iter().zip(b.iter()).map(|(a, b)| Meaning::Tuple([a.clone(), b.clone()].into()));
                Ok(Meaning::list(pairs))
            }
            _ => unknown(text),
        }
    }

    /// `[0.5, 1.0].map(T::from_f64)`, or of rows `.map(|row| row.map(T::from_f64))`.
    fn mapped(&mut self, entries: &[Meaning], by: &str) -> Reading<Meaning> {
        let mut of_each = |entries: &[Meaning]| {
            let mut numbers = Vec::new();
            for entry in entries {
                let Meaning::Literal(value) = entry else { return unknown(by) };
                numbers.push(Meaning::Number(self.numbering.constant(*value)));
            }
            Ok(Meaning::list(numbers))
        };
        match compact(by).as_str() {
            "T::from_f64" => of_each(entries),
            "|row|row.map(T::from_f64)" => {
                let mut rows = Vec::new();
                for row in entries {
                    let Meaning::List(entries) = row else { return unknown(by) };
                    rows.push(of_each(entries)?);
                }
                Ok(Meaning::list(rows))
            }
            _ => unknown(by),
        }
    }

    /// A method of a number; `None` where there is no such.
    fn operation(&mut self, name: &str, a: Number, arguments: &[Number]) -> Option<Reading<Meaning>> {
        let numbering = &mut *self.numbering;
        let number = match (name, arguments) {
            ("mul_add", [b, c]) => {
                let product = numbering.product(a, *b);
                numbering.sum(product, *c)
            }
            ("sqrt", []) => numbering.root(a),
            ("less", [b]) => numbering.less(a, *b),
            ("less_equal", [b]) => numbering.less_equal(a, *b),
            ("sin_cos", []) if self.module.trigonometry == Trigonometry::Library => {
                let parts = self.sines_and_cosines(&[Meaning::Number(a)]);
                let first = |list: Vec<Meaning>| list.into_iter().next().expect("one angle");
                return Some(parts.map(|parts| Meaning::Tuple(parts.map(first).into())));
            }
            ("sin" | "cos", _) if self.module.trigonometry == Trigonometry::Polynomials => return None,
            (name, []) => {
                let all = Function::ALL.into_iter().chain([Function::Sech]);
                numbering.call(all.into_iter().find(|function| function.name() == name)?, a)
            }
            (name, [b]) => numbering.call2(Binary::ALL.into_iter().find(|function| function.name() == name)?, a, *b),
            _ => return None,
        };
        Some(Ok(Meaning::Number(number)))
    }
}

fn nothing(value: Meaning) -> Reading<()> {
    match value {
        Meaning::Tuple(parts) if parts.is_empty() => Ok(()),
        _ => Err("a block gives a value that nothing takes".to_string()),
    }
}
