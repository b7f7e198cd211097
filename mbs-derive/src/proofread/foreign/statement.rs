//! Statements, carried out on values.

use std::collections::BTreeMap;

use super::super::reader::Reading;
use super::dialect::Family;
use super::expression::Reader;
use super::token::{Kind, Token};
use super::value::{Step, Value, output};

/// Words that begin a declaration.
const DECLARED: [&str; 4] = ["const", "let", "mbs_real", "int"];

impl<'t> Reader<'_, 't> {
    /// All statements; what is returned, if anything is.
    pub(super) fn body(&mut self) -> Reading<Option<Value>> {
        let mut returned = None;
        while self.peek().is_some() {
            if returned.is_some() && !self.is_end() {
                return Err("there are statements behind the result".to_string());
            }
            if let Some(value) = self.statement()? {
                returned = Some(value);
            }
        }
        Ok(returned)
    }

    fn is_end(&self) -> bool {
        self.peek().is_none_or(|token| token.kind == Kind::End || token.is(";"))
    }

    /// One statement; what it returns, if it does.
    fn statement(&mut self) -> Reading<Option<Value>> {
        if self.is_end() {
            self.at += 1;
            return Ok(None);
        }
        if self.takes("return") {
            let first = self.expression()?;
            if !self.is_next(",") {
                return self.ended().map(|()| Some(first));
            }
            let mut parts = vec![first];
            while self.takes(",") {
                parts.push(self.expression()?);
            }
            return self.ended().map(|()| Some(Value::Array(parts)));
        }
        if self.takes("if") {
            return self.branch().map(|()| None);
        }
        if self.takes("for") {
            return self.copied().map(|()| None);
        }
        let begins = |words: &[&str], reader: &Self| words.iter().any(|word| reader.is_next(word));
        if begins(&["void", "("], self) {
            // Compilers are told that an argument may not be read.
            while !self.takes(";") {
                self.next()?;
            }
        } else if begins(&DECLARED, self) && matches!(self.dialect.family, Family::C | Family::Js) {
            self.declaration()?;
        } else if self.is_call() {
            self.effect()?;
        } else {
            self.assignment()?;
        }
        Ok(None)
    }

    fn ended(&mut self) -> Reading<()> {
        match self.peek() {
            None => Ok(()),
            Some(token) if token.is(";") || token.kind == Kind::End => {
                self.at += 1;
                Ok(())
            }
            Some(_) => self.unknown(),
        }
    }

    /// Gives a name a value.
    fn define(&mut self, name: &str, value: Value) {
        let before = self.names.insert(name.to_string(), value);
        self.changes.push((name.to_string(), before));
    }

    // ---- declarations

    fn declaration(&mut self) -> Reading<()> {
        while DECLARED.iter().any(|word| self.is_next(word)) {
            self.at += 1;
        }
        loop {
            if self.takes("[") {
                let names = self.several("]")?;
                self.expect("=")?;
                let value = self.expression()?;
                self.taken_apart(&names, value)?;
            } else if self.takes("{") {
                let names = self.several("}")?;
                self.expect("=")?;
                let value = self.expression()?;
                for name in names {
                    let part = value.part(&Step::Field(name.to_string())).cloned();
                    self.define(name, part.ok_or_else(|| format!("there is no `{name}`"))?);
                }
            } else {
                let name = self.name()?;
                if self.names.contains_key(name) {
                    return Err(format!("`{name}` is declared twice"));
                }
                let count = if self.takes("[") {
                    let Value::Integer(count) = self.expression()? else { return self.unknown() };
                    self.expect("]")?;
                    Some(count)
                } else {
                    None
                };
                let value = match (self.takes("="), count) {
                    (true, count) => {
                        let value = self.expression()?;
                        match (&value, count) {
                            (Value::Array(entries), Some(count)) if entries.len() != count => {
                                return Err(format!("`{name}` has {} entries instead of {count}", entries.len()));
                            }
                            _ => value,
                        }
                    }
                    (false, Some(count)) => Value::Array(vec![Value::Unset; count]),
                    (false, None) => Value::Unset,
                };
                self.define(name, value);
            }
            if !self.takes(",") {
                return self.ended();
            }
        }
    }

    /// `a, b]`
    fn several(&mut self, close: &str) -> Reading<Vec<&'t str>> {
        let mut names = Vec::new();
        loop {
            names.push(if self.takes("~") { "~" } else { self.name()? });
            if self.takes(close) {
                return Ok(names);
            }
            self.expect(",")?;
        }
    }

    fn taken_apart(&mut self, names: &[&str], value: Value) -> Reading<()> {
        match value {
            Value::Array(values) if values.len() == names.len() => {
                for (name, value) in names.iter().zip(values) {
                    if !["~", "_"].contains(name) {
                        self.define(name, value);
                    }
                }
                Ok(())
            }
            Value::Struct(outputs) if outputs.contains_key(&output(names.len())) => {
                for (i, name) in names.iter().enumerate().filter(|(_, name)| **name != "~") {
                    self.define(name, outputs[&output(i + 1)].clone());
                }
                Ok(())
            }
            value @ Value::Call(..) => {
                for (i, name) in names.iter().enumerate() {
                    self.define(name, Value::call("part", [value.clone(), Value::Integer(i)]));
                }
                Ok(())
            }
            other => Err(format!("{} are taken apart as {}", other.shown(self.numbering), names.len())),
        }
    }

    // ---- assignments

    fn assignment(&mut self) -> Reading<()> {
        if self.dialect.family == Family::Matlab && self.takes("[") {
            let names = self.several("]")?;
            self.expect("=")?;
            let value = self.expression()?;
            self.taken_apart(&names, value)?;
            return self.ended();
        }
        let name = self.name()?;
        if self.is_next(",") {
            let mut names = vec![name];
            while self.takes(",") {
                names.push(self.name()?);
            }
            self.expect("=")?;
            let value = self.expression()?;
            self.taken_apart(&names, value)?;
            return self.ended();
        }
        let mut steps = Vec::new();
        while let Some(more) = self.step()? {
            steps.extend(more);
        }
        self.expect("=")?;
        let value = self.expression()?;
        self.assign(name, &steps, value)?;
        self.ended()
    }

    fn assign(&mut self, name: &str, steps: &[Step], value: Value) -> Reading<()> {
        let Some((last, before)) = steps.split_last() else {
            // Of several outputs the first one.
            let first = value.part(&Step::Field(output(1))).cloned();
            self.define(name, first.unwrap_or(value));
            return Ok(());
        };
        if self.sides > 0 {
            return Err(format!("a part of `{name}` is given a value on one side"));
        }
        let mut place = self.names.get_mut(name).ok_or_else(|| format!("`{name}` is not declared"))?;
        for step in before {
            place = match place.part_mut(step) {
                Some(part) => part,
                None => return Err(format!("`{name}` has no such part")),
            };
        }
        match (place, last) {
            // The columns of a vector are one.
            (place @ (Value::Number(_) | Value::Unset), Step::Index(0)) => *place = value,
            (Value::Struct(fields), Step::Field(field)) => {
                if fields.insert(field.clone(), value).is_some() {
                    return Err(format!("`{field}` is given two values"));
                }
            }
            (place, last) => *place.part_mut(last).ok_or_else(|| format!("`{name}` has no such part"))? = value,
        }
        Ok(())
    }

    // ---- branches

    /// A condition and two sides, which give the same names their values.
    fn branch(&mut self) -> Reading<()> {
        let condition = self.number()?;
        let is_braced = self.dialect.family != Family::Matlab;
        let (ends, closes): (&[&str], _) = if is_braced { (&["}"], "}") } else { (&["else"], "end") };
        if is_braced {
            self.expect("{")?;
        }
        let then = self.side(ends)?;
        if is_braced {
            self.expect("else")?;
            self.expect("{")?;
        }
        let otherwise = self.side(&[closes])?;
        for (name, then) in then {
            let Some(other) = otherwise.iter().find(|(other, _)| *other == name) else { continue };
            let [then, otherwise] = [self.as_number(then)?, self.as_number(other.1.clone())?];
            let selected = self.numbering.select(condition, then, otherwise);
            self.define(&name, selected.into());
        }
        Ok(())
    }

    /// What a side of a branch gives names, which have their values from before afterwards.
    fn side(&mut self, ends: &[&str]) -> Reading<Vec<(String, Value)>> {
        let outer = std::mem::take(&mut self.changes);
        self.sides += 1;
        while !ends.iter().any(|end| self.is_next(end)) {
            if self.peek().is_none() || self.statement()?.is_some() {
                return self.unknown();
            }
        }
        self.at += 1;
        self.sides -= 1;
        let mut before: BTreeMap<String, Option<Value>> = BTreeMap::new();
        for (name, value) in std::mem::replace(&mut self.changes, outer) {
            before.entry(name).or_insert(value);
        }
        let mut given = Vec::new();
        for (name, before) in before {
            let value = match before {
                None => self.names.remove(&name),
                Some(Value::Unset) => self.names.insert(name.clone(), Value::Unset),
                Some(_) => return Err(format!("`{name}` is given another value on one side")),
            };
            given.extend(value.map(|value| (name, value)));
        }
        Ok(given)
    }

    // ---- calls that stand by themselves

    fn is_call(&self) -> bool {
        let ahead = |i: usize| self.tokens.get(self.at + i);
        let is_called = ahead(0).is_some_and(|token| token.kind == Kind::Name) && ahead(1).is_some_and(|t| t.is("("));
        // `result(1, 2) = …` is no call.
        let mut depth = 0;
        let close = (1..).map_while(|i| ahead(i).map(|token| (i, token))).find(|(_, token)| {
            depth += usize::from(token.is("("));
            depth -= usize::from(token.is(")"));
            depth == 0
        });
        is_called && close.is_some_and(|(i, _)| ahead(i + 1).is_none_or(|t| t.is(";") || t.kind == Kind::End))
    }

    /// The arguments of a call: values, and the names of variables that may receive some.
    fn passed(&mut self) -> Reading<Vec<(Option<&'t str>, Value)>> {
        self.expect("(")?;
        let mut passed = Vec::new();
        while !self.takes(")") {
            let ahead = |i: usize| self.tokens.get(self.at + i).copied();
            let is_last = |i: usize| ahead(i).is_some_and(|token| token.is(",") || token.is(")"));
            let variable = |i: usize| match ahead(i) {
                Some(Token { kind: Kind::Name, text, .. }) if is_last(i + 1) && self.names.contains_key(text) => {
                    Some(text)
                }
                _ => None,
            };
            let found =
                if self.is_next("&") { variable(1).map(|name| (name, 2)) } else { variable(0).map(|name| (name, 1)) };
            match found {
                Some((name, length)) => {
                    self.at += length;
                    passed.push((Some(name), self.names[name].clone()));
                }
                None => {
                    let value = self.expression()?;
                    passed.push((None, value));
                }
            }
            if !self.takes(",") && !self.is_next(")") {
                return self.unknown();
            }
        }
        Ok(passed)
    }

    /// A call that changes variables, or looks at arguments.
    fn effect(&mut self) -> Reading<()> {
        let name = self.name()?;
        let passed = self.passed()?;
        self.ended()?;
        let values: Vec<Value> = passed.iter().map(|(_, value)| value.clone()).collect();
        let variable =
            |i: usize| passed.get(i).and_then(|(name, _)| *name).ok_or_else(|| format!("`{name}` has no result"));
        match (name, values.as_slice()) {
            ("mbs_sized", [Value::Text(name), value, count]) => self.sized(name, value, std::slice::from_ref(count)),
            ("mbs_sin_cos", [Value::Number(angle), Value::Unset, Value::Unset]) => {
                let [sin, cos] = self.sine_and_cosine(*angle);
                self.define(variable(1)?, sin);
                self.define(variable(2)?, cos);
                Ok(())
            }
            ("mbs_sin_cos_all", [Value::Integer(count), Value::Array(angles), sines, cosines]) => {
                let unset = Value::Array(vec![Value::Unset; *count]);
                if angles.len() != *count || [sines, cosines] != [&unset, &unset] {
                    return Err("sines are of other angles".to_string());
                }
                let [mut sines, mut cosines] = [Vec::new(), Vec::new()];
                for angle in angles {
                    let angle = self.as_number(angle.clone())?;
                    let [sin, cos] = self.sine_and_cosine(angle);
                    sines.push(sin);
                    cosines.push(cos);
                }
                self.define(variable(2)?, Value::Array(sines));
                self.define(variable(3)?, Value::Array(cosines));
                Ok(())
            }
            ("mbs_ldlt", [n, matrix, _]) => {
                let factors = Value::call(name, [n.clone(), matrix.clone()]);
                self.define(variable(1)?, factors.clone());
                self.define(variable(2)?, Value::call("reciprocals", [factors]));
                Ok(())
            }
            ("mbs_ldlt_solve", [arguments @ .., _]) => {
                self.define(variable(arguments.len())?, Value::call(name, values));
                Ok(())
            }
            ("mbs_state_sizes", [arguments @ .., _]) => {
                self.define(variable(arguments.len())?, Value::call(name, arguments.to_vec()));
                Ok(())
            }
            _ => self.called(name, &passed),
        }
    }

    fn sine_and_cosine(&mut self, angle: super::super::numbering::Number) -> [Value; 2] {
        use crate::expr::Function::{Cos, Sin};
        [Sin, Cos].map(|function| self.numbering.call(function, angle).into())
    }

    /// A function of the mechanism that writes its results.
    fn called(&mut self, name: &str, passed: &[(Option<&str>, Value)]) -> Reading<()> {
        if name.ends_with("_constrained_solution") {
            // What it gives is the value of its last arguments, whichever are there.
            let (given, results) = passed.split_at(passed.len().saturating_sub(2));
            let given: Vec<Value> = given.iter().map(|(_, value)| value.clone()).collect();
            for (i, (variable, _)) in results.iter().enumerate() {
                if let Some(variable) = variable {
                    let result = Value::call(name, given.iter().cloned().chain([Value::Integer(i)]));
                    self.define(variable, result);
                }
            }
            return Ok(());
        }
        let method = self.surroundings.methods.get(name).cloned().ok_or_else(|| format!("`{name}` is not known"))?;
        let Value::Array(results) = method.result else { return self.unknown() };
        let (given, receiving) = passed.split_at(method.arguments.len().min(passed.len()));
        let is_given = given.iter().map(|(_, value)| value).eq(&method.arguments);
        if !is_given || receiving.len() != results.len() {
            return Err(format!("`{name}` is called with other arguments than it takes"));
        }
        for ((variable, before), result) in receiving.iter().zip(results) {
            let variable = variable.ok_or_else(|| format!("`{name}` has no result"))?;
            if before.flat().is_ok_and(|entries| !entries.is_empty()) {
                return Err(format!("`{variable}` has a value already"));
            }
            self.define(variable, result);
        }
        Ok(())
    }

    /// `for (int i = 0; i < 2; i++) { for (int j = 0; j < 3; j++) { to[i * 3 + j] = from[i * 7 + 4 + j]; } }`
    fn copied(&mut self) -> Reading<()> {
        let mut found = (Vec::new(), Vec::new());
        self.pattern("( int i = 0 ; i < N ; i ++ ) { for ( int j = 0 ; j < N ; j ++ ) {", &mut found)?;
        self.pattern("V [ i * N + j ] = V [ i * N +", &mut found)?;
        if self.is_next("j") {
            self.pattern("j ] ; } }", &mut found)?;
            found.0.push(0);
        } else {
            self.pattern("N + j ] ; } }", &mut found)?;
        }
        let (numbers, names) = found;
        let ([rows, width, stride, all, first], [to, from]) = (numbers.as_slice(), names.as_slice()) else {
            return self.unknown();
        };
        if stride != width || first + width > *all {
            return Err(format!("`{to}` is copied from other places"));
        }
        let from = self.names.get(*from).cloned().ok_or_else(|| format!("`{from}` is not known"))?;
        let numbers = [rows, width, all, first].map(|number| Value::Integer(*number));
        let columns = Value::call("columns", [from].into_iter().chain(numbers));
        self.define(to, columns);
        Ok(())
    }

    /// Reads marks, numbers where an N stands, and names where a V does.
    fn pattern(&mut self, pattern: &str, (numbers, names): &mut (Vec<usize>, Vec<&'t str>)) -> Reading<()> {
        for word in pattern.split(' ') {
            match word {
                "N" => match self.next()?.text.parse() {
                    Ok(number) => numbers.push(number),
                    Err(_) => return self.unknown(),
                },
                "V" => names.push(self.name()?),
                mark => self.expect(mark)?,
            }
        }
        Ok(())
    }
}
