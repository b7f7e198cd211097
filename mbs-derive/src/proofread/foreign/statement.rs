//! Statements that give values names: bindings, arrays, sines and cosines, branches, fields of the constructor.

use std::rc::Rc;

use crate::expr::Function;

use super::super::numbering::Number;
use super::super::reading::Reading;
use super::super::token::Kind;
use super::dialect::Family;
use super::expression::{Reader, Value};

/// A side of a branch that is open, and what is known of the other one.
pub(super) struct Side<'t> {
    condition: Number,
    /// What both sides are to give values, where it is declared before.
    declared: Option<Vec<&'t str>>,
    /// Names that have values within this side alone, in the order in which they got them.
    bound: Vec<&'t str>,
    /// Those of the first side, when the second one is read.
    then: Option<Vec<(&'t str, Number)>>,
}

impl<'t> Reader<'_, 't> {
    /// All statements up to what `is_end` says.
    pub(super) fn statements(&mut self, is_end: impl Fn(&Self) -> bool) -> Reading<()> {
        let mut sides: Vec<Side<'t>> = Vec::new();
        while !sides.is_empty() || !is_end(self) {
            if let Some(line) = self.peek().filter(|token| token.kind == Kind::Line) {
                if line.text.len() != self.column() {
                    return Err("a line begins in another column than its block".to_string());
                }
                self.at += 1;
            }
            self.statement(&mut sides)?;
        }
        Ok(())
    }

    /// How far to the right statements begin, where that has a meaning.
    pub(super) fn column(&self) -> usize {
        let within = if self.dialect.family == Family::Python && self.turn.is_some() { 4 } else { 0 };
        self.dialect.indent.len() + within
    }

    fn statement(&mut self, sides: &mut Vec<Side<'t>>) -> Reading<()> {
        let family = self.dialect.family;
        let Some(token) = self.peek() else { return self.unknown() };
        match (family, token.text) {
            (Family::C, "const") => self.constant_of_c(sides),
            (Family::C, "static") if sides.is_empty() => self.table(sides),
            (_, "for") if sides.is_empty() => self.repeated(),
            (Family::C, "mbs_real") | (Family::Js, "let") => self.declared(sides),
            (Family::C | Family::Js, "}") => self.end_of_side(sides),
            (Family::Matlab, "else" | "end") => self.end_of_side(sides),
            (Family::Matlab, "if") => self.begin(sides, None),
            (Family::Js, "const") => {
                self.at += 1;
                match self.is_next("[") {
                    true => self.pair(sides),
                    false if self.is_array() => self.array_of_script(sides),
                    false => self.constant_binding(sides),
                }
            }
            (Family::Matlab, "[") => self.pair(sides),
            (Family::Python, _) if self.tokens.get(self.at + 1).is_some_and(|token| token.is(",")) => self.pair(sides),
            _ if self.is_constructor && token.text.starts_with(self.dialect.own[0]) => self.field(token.text),
            (Family::C | Family::Js, _) => self.assignment(sides),
            (Family::Python | Family::Matlab, name) => match self.names.get(name) {
                Some(&Value::Kept(count)) if sides.is_empty() => self.keep(name, count),
                _ if self.is_array() => self.array_of_script(sides),
                _ => self.binding(sides),
            },
        }
    }

    pub(super) fn ended(&mut self) -> Reading<()> {
        match self.dialect.family {
            Family::Python if self.peek().is_none_or(|token| token.kind == Kind::Line) => Ok(()),
            Family::Python => self.unknown(),
            Family::C | Family::Js | Family::Matlab => self.expect(";"),
        }
    }

    /// Gives a new name a value, within the side that is open.
    fn bind(&mut self, name: &'t str, value: Value, sides: &mut [Side<'t>]) -> Reading<()> {
        if self.turn.as_ref().is_some_and(|turn| turn.index == name) {
            return Err(format!("`{name}` is the index of the loop"));
        }
        let is_known = self.names.contains_key(name);
        // Where nothing is declared, a name may be given to another value, but for one side alone.
        if is_known && (self.dialect.has_choices || !sides.is_empty()) {
            return Err(format!("`{name}` has a value already"));
        }
        self.names.insert(name.to_string(), value);
        if let Some(side) = sides.last_mut() {
            side.bound.push(name);
        } else if let Some(turn) = &mut self.turn {
            turn.bound.push(name);
        }
        Ok(())
    }

    /// `name = value`
    fn binding(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let name = self.name()?;
        self.expect("=")?;
        let value = self.expression()?;
        self.bind(name, Value::Number(value), sides)?;
        self.ended()
    }

    /// `name = value` of a constant, which hides no name that waits for a value.
    fn constant_binding(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let name = self.peek().map_or("", |token| token.text);
        if sides.iter().any(|side| side.declared.iter().flatten().any(|declared| *declared == name)) {
            return Err(format!("`{name}` is declared twice"));
        }
        self.binding(sides)
    }

    /// `this.#name = value`, where nothing else has its name.
    fn field(&mut self, path: &'t str) -> Reading<()> {
        self.at += 1;
        self.expect("=")?;
        let (field, value) = (&path[self.dialect.own[0].len()..], self.expression()?);
        let is_taken = field == "params" || field.starts_with("table_");
        if is_taken || self.hoisted.insert(field, value).is_some() {
            return Err(format!("`{field}` has a value already"));
        }
        self.given.push(field);
        self.ended()
    }

    // ---- sines and cosines

    fn sine_and_cosine(&mut self, angle: Number) -> [Value; 2] {
        [Function::Sin, Function::Cos].map(|function| Value::Number(self.numbering.call(function, angle)))
    }

    /// `[sin, cos] = mbs_sin_cos(angle)`, or `mbs_sin_cos_all(angles)`; in Python without brackets.
    fn pair(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let has_brackets = self.takes("[");
        let sin = self.name()?;
        self.expect(",")?;
        let cos = self.name()?;
        if has_brackets {
            self.expect("]")?;
        }
        self.expect("=")?;
        let values = match self.has_all() {
            true => {
                ["mbs_sin_cos_all", "("].into_iter().try_for_each(|word| self.expect(word))?;
                let angles = self.angles()?;
                self.sines_and_cosines(&angles)
            }
            false => {
                let angle = self.angle()?;
                self.sine_and_cosine(angle)
            }
        };
        self.expect(")")?;
        for (name, value) in [sin, cos].into_iter().zip(values) {
            self.bind(name, value, sides)?;
        }
        self.ended()
    }

    /// Whether what comes next computes the sines and cosines of several angles.
    fn has_all(&self) -> bool {
        self.dialect.has_pairs() && self.is_next("mbs_sin_cos_all")
    }

    /// The name of an array or a list that has all of its values.
    fn angles(&mut self) -> Reading<Rc<[Number]>> {
        let given = self.name()?;
        match self.names.get(given) {
            Some(Value::List(angles)) => Ok(angles.clone()),
            Some(Value::Kept(_)) => {
                let angles: Option<Rc<[Number]>> = self.kept.get(given).and_then(|all| all.iter().copied().collect());
                angles.ok_or_else(|| format!("`{given}` has not all of its values"))
            }
            _ => self.unknown(),
        }
    }

    fn sines_and_cosines(&mut self, angles: &[Number]) -> [Value; 2] {
        let mut all =
            |function| Value::List(angles.iter().map(|&angle| self.numbering.call(function, angle)).collect());
        [all(Function::Sin), all(Function::Cos)]
    }

    /// `mbs_sin_cos(angle`
    fn angle(&mut self) -> Reading<Number> {
        if !self.dialect.has_pairs() {
            return self.unknown();
        }
        self.expect("mbs_sin_cos")?;
        self.expect("(")?;
        self.expression()
    }

    /// `static const mbs_real NUMBERS[2] = {1.0, -2.0,};`: constants alone, since it is made once.
    fn table(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        self.expect("static")?;
        let name = self.tokens.get(self.at + 2).map_or("", |token| token.text);
        self.constant_of_c(sides)?;
        match self.names.get(name) {
            Some(Value::List(numbers)) if numbers.iter().all(|number| self.numbering.is_constant(*number)) => Ok(()),
            _ => Err(format!("`{name}` is no table of constants")),
        }
    }

    /// `const mbs_real name = value;`, or `const mbs_real angles[2] = {a, b};`, with or without a comma at the end
    fn constant_of_c(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        self.expect("const")?;
        self.expect("mbs_real")?;
        if !self.tokens.get(self.at + 1).is_some_and(|token| token.is("[")) {
            return self.constant_binding(sides);
        }
        let (name, count) = self.array()?;
        self.expect("=")?;
        let numbers = self.numbers(["{", "}"])?;
        if numbers.len() != count {
            return Err(format!("`{name}` has another number of entries"));
        }
        self.bind(name, Value::List(numbers.into()), sides)?;
        self.ended()
    }

    /// `{a, b,}`
    fn numbers(&mut self, [open, close]: [&str; 2]) -> Reading<Vec<Number>> {
        let mut numbers = Vec::new();
        self.expect(open)?;
        self.row_goes_on()?;
        while !self.takes(close) {
            let first = self.at;
            numbers.push(self.expression()?);
            self.is_one_entry(first)?;
            if !self.takes(",") {
                self.expect(close)?;
                break;
            }
            self.row_goes_on()?;
        }
        Ok(numbers)
    }

    /// An error where blanks within brackets of MATLAB make several entries of one expression: `[a -b]` has two.
    fn is_one_entry(&self, first: usize) -> Reading<()> {
        let mut depth = 0;
        for pair in self.tokens[first..self.at].windows(2) {
            depth += usize::from(pair[0].is("("));
            depth -= usize::from(pair[0].is(")"));
            let is_apart = pair[1].start > pair[0].start + pair[0].text.len();
            if self.dialect.family == Family::Matlab && depth == 0 && is_apart {
                return self.unknown();
            }
        }
        Ok(())
    }

    /// `...` at the end of a line, within brackets of MATLAB.
    fn row_goes_on(&mut self) -> Reading<()> {
        if self.dialect.family != Family::Matlab || !self.takes("...") {
            return Ok(());
        }
        match self.peek() {
            Some(token) if token.kind == Kind::Line => {
                self.at += 1;
                Ok(())
            }
            _ => self.unknown(),
        }
    }

    /// Whether a name is given to an array or a list.
    fn is_array(&self) -> bool {
        let word = |ahead: usize| self.tokens.get(self.at + ahead).map_or("", |token| token.text);
        word(1) == "=" && ["[", "new", "zeros"].contains(&word(2))
    }

    /// `kept = [0.0] * 2`, `const kept = new Float64Array(2);`, `kept = zeros(1, 2);`, or `angles = [a, b]`.
    fn array_of_script(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let name = self.name()?;
        self.expect("=")?;
        let begins: &[&str] = match self.dialect.family {
            Family::C => return self.unknown(),
            Family::Js => &["new", "Float64Array", "("],
            Family::Python => &["[", "0.0", "]", "*"],
            Family::Matlab => &["zeros", "(", "1", ","],
        };
        let coming = self.tokens.iter().skip(self.at).map(|token| token.text);
        let value = match coming.take(begins.len()).eq(begins.iter().copied()) {
            true => {
                begins.iter().try_for_each(|word| self.expect(word))?;
                let count = self.integer()?;
                if self.dialect.family != Family::Python {
                    self.expect(")")?;
                }
                self.kept.insert(name.to_string(), vec![None; count]);
                Value::Kept(count)
            }
            false => Value::List(self.numbers(["[", "]"])?.into()),
        };
        self.bind(name, value, sides)?;
        self.ended()
    }

    /// `name[2]`
    fn array(&mut self) -> Reading<(&'t str, usize)> {
        let name = self.name()?;
        self.expect("[")?;
        let count = self.integer()?;
        self.expect("]").map(|()| (name, count))
    }

    /// `mbs_real kept[2];`, or `mbs_real sines[2], cosines[2]; mbs_sin_cos_all(2, angles, sines, cosines);`
    fn arrays(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let (sines, count) = self.array()?;
        if self.takes(";") {
            self.kept.insert(sines.to_string(), vec![None; count]);
            return self.bind(sines, Value::Kept(count), sides);
        }
        self.expect(",")?;
        let (cosines, other) = self.array()?;
        self.ended()?;
        self.expect("mbs_sin_cos_all")?;
        self.expect("(")?;
        let called = self.integer()?;
        self.expect(",")?;
        let angles = self.angles()?;
        if [count, other, called] != [angles.len(); 3] {
            return self.unknown();
        }
        [",", sines, ",", cosines, ")"].into_iter().try_for_each(|word| self.expect(word))?;
        for (name, values) in [sines, cosines].into_iter().zip(self.sines_and_cosines(&angles)) {
            self.bind(name, values, sides)?;
        }
        self.ended()
    }

    // ---- branches

    /// `let a, b;`, and what gives them their values.
    fn declared(&mut self, sides: &mut Vec<Side<'t>>) -> Reading<()> {
        self.at += 1;
        if self.dialect.family == Family::C && self.tokens.get(self.at + 1).is_some_and(|token| token.is("[")) {
            return self.arrays(sides);
        }
        let mut names = vec![self.name()?];
        while self.takes(",") {
            names.push(self.name()?);
        }
        self.ended()?;
        if self.is_next("if") {
            return self.begin(sides, Some(names));
        }
        let [sin, cos] = names[..] else { return self.unknown() };
        let angle = self.angle()?;
        [",", "&", sin, ",", "&", cos, ")"].into_iter().try_for_each(|word| self.expect(word))?;
        for (name, value) in [sin, cos].into_iter().zip(self.sine_and_cosine(angle)) {
            self.bind(name, value, sides)?;
        }
        self.ended()
    }

    /// `if (condition) {`
    fn begin(&mut self, sides: &mut Vec<Side<'t>>, declared: Option<Vec<&'t str>>) -> Reading<()> {
        self.expect("if")?;
        let is_c_like = declared.is_some();
        if is_c_like && !self.is_next("(") {
            return self.unknown();
        }
        let condition = self.expression()?;
        if is_c_like {
            self.expect("{")?;
        }
        if let Some(known) = declared.iter().flatten().find(|name| self.names.contains_key(**name)) {
            return Err(format!("`{known}` has a value already"));
        }
        sides.push(Side { condition, declared, bound: Vec::new(), then: None });
        Ok(())
    }

    /// `name = value;` of a name that was declared before the branch, or `name[i] = value;`.
    fn assignment(&mut self, sides: &mut [Side<'t>]) -> Reading<()> {
        let is_declared = |side: &Side<'t>| {
            let name = self.peek().map_or("", |token| token.text);
            side.declared.as_ref().is_some_and(|names| names.contains(&name))
        };
        if sides.last().is_some_and(is_declared) {
            return self.binding(sides);
        }
        let name = self.peek().filter(|_| sides.is_empty()).map_or("", |token| token.text);
        match self.names.get(name) {
            Some(&Value::Kept(count)) => self.keep(name, count),
            _ => self.unknown(),
        }
    }

    /// `} else {` or `}`
    fn end_of_side(&mut self, sides: &mut Vec<Side<'t>>) -> Reading<()> {
        let Some(mut side) = sides.pop() else { return self.unknown() };
        let mut given = Vec::new();
        for name in side.bound.drain(..) {
            if let Some(Value::Number(value)) = self.names.remove(name) {
                given.push((name, value));
            }
        }
        if let Some(names) = &side.declared {
            self.expect("}")?;
            given.retain(|(name, _)| names.contains(name));
            if given.len() != names.len() {
                return Err("a side of a branch does not give all values".to_string());
            }
        }
        let Some(then) = side.then.take() else {
            self.expect("else")?;
            if side.declared.is_some() {
                self.expect("{")?;
            }
            sides.push(Side { then: Some(given), ..side });
            return Ok(());
        };
        if side.declared.is_none() {
            self.expect("end")?;
        }
        for (name, then) in then {
            if let Some((_, otherwise)) = given.iter().find(|(other, _)| *other == name) {
                let value = self.numbering.select(side.condition, then, *otherwise);
                self.bind(name, Value::Number(value), sides)?;
            }
        }
        Ok(())
    }
}
