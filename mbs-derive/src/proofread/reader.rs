//! Rust, as far as it is emitted, read as meanings: each expression is evaluated into the numbers of its values.
//!
//! What is not known here is refused: a text that cannot be read is not the Program.

mod assignment;

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use quote::ToTokens;
use syn::{BinOp, Block, Expr, Item, Lit, Member, Pat, PatType, StaticMutability, Stmt, UnOp};

use crate::expr::{Binary, Function, Trigonometry};

use super::meaning::Meaning;
use super::numbering::{Number, Numbering};

/// What is wrong with a text.
pub(super) type Reading<T> = Result<T, String>;

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
    pub(super) fn block(&mut self, block: &Block) -> Reading<Meaning> {
        self.within(|reader| {
            let (last, statements) = match block.stmts.split_last() {
                Some((Stmt::Expr(last, None), statements)) if !is_statement(last) => (Some(last), statements),
                _ => (None, block.stmts.as_slice()),
            };
            statements.iter().try_for_each(|statement| reader.statement(statement))?;
            last.map_or(Ok(Meaning::Tuple(Rc::new([]))), |last| reader.value(last))
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

    fn statement(&mut self, statement: &Stmt) -> Reading<()> {
        match statement {
            Stmt::Local(local) => match (&local.init, &local.pat) {
                (Some(init), Pat::Ident(name)) if init.diverge.is_none() && is_changed_later(name) => {
                    let value = self.value(&init.expr)?;
                    self.define(name.ident.to_string(), Some(value));
                    Ok(())
                }
                (Some(init), pattern) if init.diverge.is_none() => {
                    let value = self.value(&init.expr)?;
                    self.bind(pattern, value)
                }
                (None, Pat::Type(declared)) => self.declare(declared),
                _ => unknown(statement),
            },
            Stmt::Expr(Expr::Block(inner), _) if inner.label.is_none() => self.block(&inner.block).and_then(nothing),
            Stmt::Expr(Expr::Assign(assignment), Some(_)) => {
                let value = self.value(&assignment.right)?;
                self.assign(&assignment.left, value)
            }
            Stmt::Expr(Expr::ForLoop(each), _) if each.label.is_none() => {
                let Meaning::List(entries) = self.value(&each.expr)? else { return unknown(&each.expr) };
                for entry in entries.iter() {
                    self.within(|reader| {
                        reader.bind(&each.pat, entry.clone())?;
                        reader.block(&each.body).and_then(nothing)
                    })?;
                }
                Ok(())
            }
            Stmt::Expr(Expr::Try(tried), Some(_)) => {
                let required = self.value(&tried.expr)?;
                self.required.push(required);
                Ok(())
            }
            Stmt::Item(Item::Static(table)) if matches!(table.mutability, StaticMutability::None) => {
                let value = self.value(&table.expr)?;
                self.define(table.ident.to_string(), Some(value));
                Ok(())
            }
            Stmt::Expr(..) | Stmt::Item(_) | Stmt::Macro(_) => unknown(statement),
        }
    }

    /// `let [a, b]: [T; 2];`
    fn declare(&mut self, declared: &PatType) -> Reading<()> {
        let Pat::Slice(slice) = &*declared.pat else { return unknown(declared) };
        if compact(&declared.ty) != format!("[T;{}]", slice.elems.len()) {
            return unknown(declared);
        }
        for element in &slice.elems {
            match element {
                Pat::Ident(name) if is_plain(name) => self.define(name.ident.to_string(), None),
                other => return unknown(other),
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
    pub(super) fn written(&mut self, block: &Block, name: &str, unwritten: Meaning) -> Reading<Meaning> {
        let local = self.locals.len();
        self.define(name.to_string(), Some(unwritten));
        self.storage = Some(local);
        self.block(block).and_then(nothing)?;
        self.locals[local].clone().ok_or_else(|| format!("`{name}` is not written"))
    }

    /// Gives the names of a pattern their meaning.
    fn bind(&mut self, pattern: &Pat, meaning: Meaning) -> Reading<()> {
        match (pattern, meaning) {
            (Pat::Wild(_), _) => Ok(()),
            (Pat::Ident(name), meaning) if is_plain(name) => {
                self.define(name.ident.to_string(), Some(meaning));
                Ok(())
            }
            (Pat::Type(typed), meaning @ Meaning::Closure(_)) if compact(&typed.ty) == "&dynFn()->T" => {
                self.bind(&typed.pat, meaning)
            }
            (Pat::Slice(slice), meaning) => {
                let rest = slice.elems.last().is_some_and(|last| matches!(last, Pat::Rest(_)));
                let count = slice.elems.len() - usize::from(rest);
                let values = match meaning {
                    Meaning::List(values) if rest && values.len() >= count => {
                        values.iter().take(count).cloned().collect()
                    }
                    meaning if !rest => self.entries(meaning, count)?,
                    _ => return unknown(pattern),
                };
                slice.elems.iter().zip(values).try_for_each(|(element, value)| self.bind(element, value))
            }
            (Pat::Tuple(tuple), Meaning::Tuple(values)) if tuple.elems.len() == values.len() => {
                tuple.elems.iter().zip(values.iter()).try_for_each(|(element, value)| self.bind(element, value.clone()))
            }
            (Pat::Struct(record), Meaning::Record(path, fields)) if path_of(&record.path) == path => {
                if record.rest.is_none() && record.fields.len() != fields.len() {
                    return Err(format!("not all fields of `{path}` are read"));
                }
                record.fields.iter().try_for_each(|field| {
                    let name = member(&field.member);
                    let value = fields.get(&name).ok_or_else(|| format!("`{path}` has no field `{name}`"))?;
                    self.bind(&field.pat, value.clone())
                })
            }
            _ => unknown(pattern),
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
    pub(super) fn value(&mut self, expression: &Expr) -> Reading<Meaning> {
        match expression {
            Expr::Paren(inner) => self.value(&inner.expr),
            Expr::Reference(inner) if inner.mutability.is_none() => self.value(&inner.expr),
            Expr::Block(inner) if inner.label.is_none() => self.block(&inner.block),
            Expr::Lit(literal) => match &literal.lit {
                Lit::Float(value) if value.suffix().is_empty() => {
                    value.base10_parse().map(Meaning::Literal).map_err(|_| cannot_read(expression))
                }
                Lit::Int(value) if value.suffix().is_empty() => {
                    value.base10_parse().map(Meaning::Integer).map_err(|_| cannot_read(expression))
                }
                Lit::Str(text) => Ok(Meaning::Text(text.value())),
                _ => unknown(expression),
            },
            Expr::Path(path) if path.qself.is_none() => self.path(&path.path),
            Expr::Unary(unary) => self.unary(unary),
            Expr::Range(range) if matches!(range.limits, syn::RangeLimits::HalfOpen(_)) => {
                let (Some(start), Some(end)) = (&range.start, &range.end) else { return unknown(expression) };
                match (self.value(start)?, self.value(end)?) {
                    (Meaning::Integer(start), Meaning::Integer(end)) => {
                        Ok(Meaning::list((start..end).map(Meaning::Integer)))
                    }
                    _ => unknown(expression),
                }
            }
            Expr::Binary(binary) if self.is_integer(&binary.left) => {
                match (self.value(&binary.left)?, &binary.op, self.value(&binary.right)?) {
                    (Meaning::Integer(a), BinOp::Add(_), Meaning::Integer(b)) => Ok(Meaning::Integer(a + b)),
                    (Meaning::Integer(a), BinOp::Sub(_), Meaning::Integer(b)) if b <= a => Ok(Meaning::Integer(a - b)),
                    (Meaning::Integer(a), BinOp::Div(_), Meaning::Integer(b @ 1..)) => Ok(Meaning::Integer(a / b)),
                    _ => unknown(expression),
                }
            }
            Expr::Binary(binary) => {
                let [a, b] = [self.number(&binary.left)?, self.number(&binary.right)?];
                Ok(Meaning::Number(match binary.op {
                    BinOp::Add(_) => self.numbering.sum(a, b),
                    BinOp::Sub(_) => self.numbering.sum(a, b.opposite()),
                    BinOp::Mul(_) => self.numbering.product(a, b),
                    BinOp::Div(_) => self.numbering.quotient(a, b),
                    BinOp::BitAnd(_) => self.numbering.and(a, b),
                    _ => return unknown(expression),
                }))
            }
            Expr::Array(array) => self.values(&array.elems).map(Meaning::list),
            Expr::Tuple(tuple) => self.values(&tuple.elems).map(|parts| Meaning::Tuple(parts.into())),
            Expr::Repeat(repeat) => {
                let Meaning::Integer(count) = self.value(&repeat.len)? else { return unknown(expression) };
                let value = self.value(&repeat.expr)?;
                Ok(Meaning::list(vec![value; count]))
            }
            Expr::Struct(record) if record.rest.is_none() && record.qself.is_none() => {
                let mut fields = BTreeMap::new();
                for field in &record.fields {
                    fields.insert(member(&field.member), self.value(&field.expr)?);
                }
                Ok(Meaning::Record(path_of(&record.path), Rc::new(fields)))
            }
            Expr::Field(field) => {
                let (of, name) = (self.value(&field.base)?, member(&field.member));
                let found = match &of {
                    Meaning::Record(_, fields) => fields.get(&name),
                    Meaning::Tuple(parts) => name.parse().ok().and_then(|i: usize| parts.get(i)),
                    _ => None,
                };
                found.cloned().ok_or_else(|| format!("there is no field `{name}`"))
            }
            Expr::Index(index) => match (self.value(&index.expr)?, self.value(&index.index)?) {
                (Meaning::List(entries), Meaning::Integer(i)) if i < entries.len() => Ok(entries[i].clone()),
                _ => unknown(expression),
            },
            Expr::Closure(closure) if closure.inputs.is_empty() => {
                let outer = std::mem::replace(&mut self.outer, self.locals.len());
                let value = self.value(&closure.body)?;
                self.outer = outer;
                Ok(Meaning::Closure(Rc::new(value)))
            }
            Expr::Call(call) => self.call(call),
            Expr::MethodCall(call) if call.turbofish.is_none() => self.method(call),
            _ => unknown(expression),
        }
    }

    /// Whether it is a name that stands for an index, or begins with one.
    fn is_integer(&self, expression: &Expr) -> bool {
        let path = match expression {
            Expr::Path(path) => path,
            Expr::Paren(inner) => return self.is_integer(&inner.expr),
            Expr::Binary(binary) => return self.is_integer(&binary.left),
            _ => return false,
        };
        let local = path.path.get_ident().and_then(|name| self.names.get(&name.to_string()));
        local.is_some_and(|&local| matches!(self.locals[local], Some(Meaning::Integer(_))))
    }

    fn values<'e>(&mut self, expressions: impl IntoIterator<Item = &'e Expr>) -> Reading<Vec<Meaning>> {
        expressions.into_iter().map(|expression| self.value(expression)).collect()
    }

    fn number(&mut self, expression: &Expr) -> Reading<Number> {
        match self.value(expression)? {
            Meaning::Number(number) => Ok(number),
            other => Err(format!("{} stands for a number", other.shown(self.numbering))),
        }
    }

    fn path(&mut self, path: &syn::Path) -> Reading<Meaning> {
        let name = path_of(path);
        if let Some(&local) = self.names.get(&name) {
            if Some(local) == self.storage {
                return Err(format!("`{name}` is read"));
            }
            let known = self.locals[local].clone();
            return known.ok_or_else(|| format!("`{name}` is read before it has a value"));
        }
        match name.as_str() {
            "T::from_f64" => Ok(Meaning::FromF64),
            "core::f64::consts::PI" => Ok(Meaning::Literal(std::f64::consts::PI)),
            _ if name.starts_with("mbs_runtime::") || name.starts_with("core::") => Ok(Meaning::Path(name)),
            _ => self.module.constants.get(&name).cloned().ok_or_else(|| format!("`{name}` is not known")),
        }
    }

    fn unary(&mut self, unary: &syn::ExprUnary) -> Reading<Meaning> {
        match (&unary.op, self.value(&unary.expr)?) {
            (UnOp::Neg(_), Meaning::Number(a)) => Ok(Meaning::Number(a.opposite())),
            (UnOp::Neg(_), Meaning::Literal(value)) => Ok(Meaning::Literal(-value)),
            (UnOp::Not(_), Meaning::Number(a)) => Ok(Meaning::Number(self.numbering.not(a))),
            (UnOp::Deref(_), Meaning::OnDemand(of)) => Ok((*of).clone()),
            (UnOp::Deref(_), of @ (Meaning::List(_) | Meaning::Record(..))) => Ok(of),
            _ => unknown(unary),
        }
    }

    /// A call of a function by its path.
    fn call(&mut self, call: &syn::ExprCall) -> Reading<Meaning> {
        let Expr::Path(function) = &*call.func else { return unknown(call) };
        let name = path_of(&function.path);
        if name == "core::array::from_fn" {
            return self.columns(call);
        }
        let arguments = self.values(&call.args)?;
        let constant = |reader: &mut Self, value: f64| Ok(Meaning::Number(reader.numbering.constant(value)));
        match (name.as_str(), arguments.as_slice()) {
            ("T::zero", []) => constant(self, 0.0),
            ("T::one", []) => constant(self, 1.0),
            ("T::select", [Meaning::Number(c), Meaning::Closure(a), Meaning::Closure(b)]) => match (&**a, &**b) {
                (Meaning::Number(a), Meaning::Number(b)) => Ok(Meaning::Number(self.numbering.select(*c, *a, *b))),
                _ => unknown(call),
            },
            ("T::blend", [Meaning::Number(c), Meaning::Number(a), Meaning::Number(b)]) => {
                Ok(Meaning::Number(self.numbering.select(*c, *a, *b)))
            }
            ("T::select_each", [Meaning::Number(c), Meaning::Closure(a), Meaning::Closure(b)]) => match (&**a, &**b) {
                (Meaning::List(a), Meaning::List(b)) if a.len() == b.len() => {
                    let mut selected = Vec::new();
                    for pair in a.iter().zip(b.iter()) {
                        let (Meaning::Number(a), Meaning::Number(b)) = pair else { return unknown(call) };
                        selected.push(Meaning::Number(self.numbering.select(*c, *a, *b)));
                    }
                    Ok(Meaning::list(selected))
                }
                _ => unknown(call),
            },
            ("T::sin_cos_all", [Meaning::List(angles)]) if self.module.trigonometry == Trigonometry::Polynomials => {
                self.sines_and_cosines(angles).map(|parts| Meaning::Tuple(parts.map(Meaning::list).into()))
            }
            ("core::cell::LazyCell::new", [Meaning::Closure(of)]) => Ok(Meaning::OnDemand(of.clone())),
            ("core::result::Result::Ok", [result]) => Ok(result.clone()),
            _ if name.starts_with("mbs_runtime::") => Ok(Meaning::Call(name, arguments.into())),
            _ => match (self.path(&function.path)?, arguments.as_slice()) {
                (Meaning::FromF64, [Meaning::Literal(value)]) => constant(self, *value),
                _ => unknown(call),
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
    fn columns(&mut self, call: &syn::ExprCall) -> Reading<Meaning> {
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
        let solution = self.path(&syn::parse_quote!(solution))?;
        Ok(Meaning::Columns(Rc::new(solution), first))
    }

    fn method(&mut self, call: &syn::ExprMethodCall) -> Reading<Meaning> {
        let name = call.method.to_string();
        if let Expr::Path(receiver) = &*call.receiver
            && receiver.path.is_ident("self")
        {
            let method = self.module.methods.get(&name).ok_or_else(|| format!("there is no function `{name}`"))?;
            if self.values(&call.args)? != method.arguments {
                return Err(format!("`{name}` is called with other arguments than it takes"));
            }
            return Ok(method.result.clone());
        }
        let receiver = self.value(&call.receiver)?;
        if let (Meaning::List(entries), "map") = (&receiver, name.as_str()) {
            return self.mapped(entries, call);
        }
        let arguments = self.values(&call.args)?;
        match (receiver, name.as_str(), arguments.as_slice()) {
            (Meaning::Number(a), name, arguments) => {
                let mut numbers = Vec::new();
                for argument in arguments {
                    let Meaning::Number(number) = argument else { return unknown(call) };
                    numbers.push(*number);
                }
                self.operation(name, a, &numbers).unwrap_or_else(|| unknown(call))
            }
            (Meaning::Table(table), "derivatives", [Meaning::Number(x)]) => Ok(Meaning::Derivatives(table, *x)),
            (factors @ Meaning::Call(..), "solve_many", [right_side]) => {
                Ok(Meaning::Call(name, [factors, right_side.clone()].into()))
            }
            (list @ Meaning::List(_), "into_iter", []) => Ok(list),
            (Meaning::List(entries), "step_by", [Meaning::Integer(stride @ 1..)]) => {
                Ok(Meaning::list(entries.iter().step_by(*stride).cloned()))
            }
            (Meaning::List(entries), "rev", []) => Ok(Meaning::list(entries.iter().rev().cloned())),
            (Meaning::List(rows), "flatten", []) => {
                let mut all = Vec::new();
                for row in rows.iter() {
                    let Meaning::List(entries) = row else { return unknown(call) };
                    all.extend(entries.iter().cloned());
                }
                Ok(Meaning::list(all))
            }
            (Meaning::List(a), "zip", [Meaning::List(b)]) if a.len() == b.len() => {
                let pairs = a.iter().zip(b.iter()).map(|(a, b)| Meaning::Tuple([a.clone(), b.clone()].into()));
                Ok(Meaning::list(pairs))
            }
            _ => unknown(call),
        }
    }

    /// `[0.5, 1.0].map(T::from_f64)`, or of rows `.map(|row| row.map(T::from_f64))`.
    fn mapped(&mut self, entries: &[Meaning], call: &syn::ExprMethodCall) -> Reading<Meaning> {
        let written = compact(&call.args);
        let mut of_each = |entries: &[Meaning]| {
            let mut numbers = Vec::new();
            for entry in entries {
                let Meaning::Literal(value) = entry else { return unknown(call) };
                numbers.push(Meaning::Number(self.numbering.constant(*value)));
            }
            Ok(Meaning::list(numbers))
        };
        match written.as_str() {
            "T::from_f64" => of_each(entries),
            "|row|row.map(T::from_f64)" => {
                let mut rows = Vec::new();
                for row in entries {
                    let Meaning::List(entries) = row else { return unknown(call) };
                    rows.push(of_each(entries)?);
                }
                Ok(Meaning::list(rows))
            }
            _ => unknown(call),
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

/// Whether an expression without a semicolon is a statement.
fn is_statement(expression: &Expr) -> bool {
    matches!(expression, Expr::ForLoop(_))
}

/// Whether it is `mut name`.
fn is_changed_later(name: &syn::PatIdent) -> bool {
    name.mutability.is_some() && name.by_ref.is_none() && name.subpat.is_none()
}

fn is_plain(name: &syn::PatIdent) -> bool {
    name.by_ref.is_none() && name.mutability.is_none() && name.subpat.is_none()
}

fn nothing(value: Meaning) -> Reading<()> {
    match value {
        Meaning::Tuple(parts) if parts.is_empty() => Ok(()),
        _ => Err("a block gives a value that nothing takes".to_string()),
    }
}

/// `mbs_runtime::Pose`, without arguments of types.
pub(super) fn path_of(path: &syn::Path) -> String {
    let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
    names.join("::")
}

fn member(member: &Member) -> String {
    match member {
        Member::Named(name) => name.to_string(),
        Member::Unnamed(index) => index.index.to_string(),
    }
}

/// Tokens without spaces.
pub(super) fn compact(what: &impl ToTokens) -> String {
    what.to_token_stream().to_string().split_whitespace().collect()
}

fn cannot_read(what: &impl ToTokens) -> String {
    let text = what.to_token_stream().to_string();
    let short: String = text.chars().take(100).collect();
    format!("`{short}{}` cannot be read", if short.len() < text.len() { "…" } else { "" })
}

pub(super) fn unknown<T>(what: &impl ToTokens) -> Reading<T> {
    Err(cannot_read(what))
}
