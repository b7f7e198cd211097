//! What `param`, `coord`, `input` and `const` declare: names, units, values.

use super::keyword::taken;
use super::reader::{Parsed, Reader};
use super::syntax::{Expression, Name, Quantity, Span, Unit, UnitFactor};
use crate::diagnostic::Code;

/// What one kind of [`Quantity`] must have.
pub(super) struct Form {
    keyword: &'static str,
    /// The help where the unit is missing; none where it may be missing.
    needs_unit: Option<&'static str>,
    value: FormValue,
}

pub(super) enum FormValue {
    /// There is none, because …
    Absent(&'static str),
    Optional,
    Needed,
}

pub(super) const PARAM: Form = Form { keyword: "param", needs_unit: Some("m = …"), value: FormValue::Optional };
pub(super) const CONST: Form = Form { keyword: "const", needs_unit: None, value: FormValue::Needed };
pub(super) const COORD: Form = Form {
    keyword: "coord",
    needs_unit: Some("rad"),
    value: FormValue::Absent("its initial value is part of the state that a simulation begins with"),
};
pub(super) const INPUT: Form = Form {
    keyword: "input",
    needs_unit: Some("N"),
    value: FormValue::Absent("its value is given while the mechanism moves"),
};

pub(super) const PRESCRIBED: Form = Form { keyword: "prescribed", needs_unit: Some("m"), value: FormValue::Optional };

impl Reader<'_> {
    /// `quantity := keyword name ("[" expression "]" ("[" expression "]")?)? (":" unit)? ("=" expression)? (","
    /// "positive")?`, two lengths and the last of a `param` alone
    pub(super) fn quantity(&mut self, docs: Vec<String>, form: &Form) -> Parsed<Quantity> {
        let start = self.next().start;
        self.eat_word(form.keyword);
        let name = self.declared_name(form.keyword)?;
        let length = self.index()?;
        let here = self.next();
        let columns = self.index()?;
        if columns.is_some() && form.keyword != "param" {
            let help = match form.keyword {
                "const" => "an array of arrays has one: `const a[2]: m = [[1, 2], [3, 4]];`",
                _ => {
                    "write an array for each row, `x[n]` and `y[n]`, or one for all of them, `r[3*n]` with `r[3*i + k]`"
                }
            };
            let message = format!("`{}` takes one index: `param` and `let` take two", form.keyword);
            return Err(self.refuse(Code::IndexForm, here, message, help));
        }
        let declared = start..self.last;
        let unit = self.quantity_unit(form, &declared)?;
        let value = self.quantity_value(form, &declared)?;
        let positive = if form.keyword == PARAM.keyword { self.positive()? } else { None };
        Ok(Quantity { docs, name, length, columns, unit, value, positive })
    }

    /// `"," "positive"`, if a comma comes next.
    fn positive(&mut self) -> Parsed<Option<Span>> {
        if self.eat(",").is_none() {
            return Ok(None);
        }
        let here = self.next();
        if self.eat_word("positive") {
            return Ok(Some(here));
        }
        let help = "several values are written as `[1, 2, 3]`; `positive` says that the parameter must be";
        Err(self.unexpected("`positive`", help))
    }

    fn quantity_unit(&mut self, form: &Form, declared: &Span) -> Parsed<Option<Unit>> {
        let text = &self.source[declared.clone()];
        let colon = self.eat(":").is_some();
        let breaks = !colon && self.begins_line();
        let ends = self.is_at_end() || breaks || ["=", ";"].iter().any(|sign| self.peek(sign));
        match form.needs_unit {
            Some(example) if ends => {
                let help = format!("write `{text}: {example};`, `1` for a pure number");
                Err(self.refuse(Code::MissingUnit, declared.clone(), format!("`{text}` needs a unit"), help))
            }
            None if ends && colon => {
                let help = format!("write `{text}: m = …;`, or leave the `:` out");
                Err(self.refuse(Code::MissingUnit, declared.clone(), format!("`{text}` has a `:` but no unit"), help))
            }
            None if ends => Ok(None),
            _ if colon => self.unit().map(Some),
            _ => Err(self.unexpected("`:` and a unit", &format!("write `{text}: m`, `1` for a pure number"))),
        }
    }

    fn quantity_value(&mut self, form: &Form, declared: &Span) -> Parsed<Option<Expression>> {
        let (text, keyword) = (&self.source[declared.clone()], form.keyword);
        let here = self.next();
        match (&form.value, self.eat("=").is_some()) {
            (FormValue::Absent(why), true) => Err(self.refuse(
                Code::ValueOfACoordinate,
                here,
                format!("`{text}` cannot have a value"),
                format!("leave it out: {why}"),
            )),
            (FormValue::Needed, false) if self.is_at_end() || self.peek(";") => {
                let help = format!("write `{text} = …;`, or make it a `param`");
                Err(self.refuse(Code::MissingValue, declared.clone(), format!("this `{keyword}` needs a value"), help))
            }
            (_, true) => self.expression().map(Some),
            (_, false) => Ok(None),
        }
    }

    /// `unit := unit_factor (("*" | "/") unit_factor)*`
    fn unit(&mut self) -> Parsed<Unit> {
        let (start, mut factors) = (self.next().start, Vec::new());
        self.unit_product(1, &mut factors)?;
        if !self.begins_line() && self.word().is_some() {
            let (span, found) = (self.next(), self.found());
            return Err(self.refuse(
                Code::UnitForm,
                span,
                format!("a `*` is missing before the unit {found}"),
                "write it as in `N*m`",
            ));
        }
        if self.number_at(self.at) {
            return Err(self.unexpected("`=` or `;`", "write a value behind `=`"));
        }
        Ok(Unit { factors, span: start..self.last })
    }

    fn unit_product(&mut self, sign: i32, factors: &mut Vec<UnitFactor>) -> Parsed<()> {
        self.unit_factor(sign, factors)?;
        loop {
            if self.eat("*").is_some() {
                self.unit_factor(sign, factors)?;
            } else if self.eat("/").is_some() {
                self.unit_factor(-sign, factors)?;
            } else if self.peek("**") {
                return Err(self.double_star());
            } else {
                return Ok(());
            }
        }
    }

    /// `unit_factor := "1" | name ("^" unit_exponent)? | "(" unit ")"`
    fn unit_factor(&mut self, sign: i32, factors: &mut Vec<UnitFactor>) -> Parsed<()> {
        let (span, help) = (self.next(), "write a unit such as `kg*m^2/s^2`, `1` for a pure number");
        if let Some(number) = self.literal() {
            let help = "numbers belong to the value; write a root as `m^(1/2)`";
            return match number {
                "1" => Ok(()),
                _ => Err(self.refuse(Code::UnitForm, span, format!("`{number}` is not a unit"), help)),
            };
        }
        if self.opens('(') {
            self.open()?;
            self.unit_product(sign, factors)?;
            if !self.is_at_end() {
                return Err(self.unexpected("`*`, `/` or `)`", help));
            }
            self.close();
            return match self.eat("^") {
                Some(span) => Err(self.refuse(
                    Code::UnitForm,
                    span,
                    "a unit in parentheses has no power",
                    "write the power of each unit",
                )),
                None => Ok(()),
            };
        }
        if self.word().is_none() {
            return Err(self.unexpected("a unit", help));
        }
        let name = self.name("`:`")?;
        let (numerator, denominator) = match self.eat("^") {
            Some(_) => self.unit_exponent()?,
            None => (1, 1),
        };
        factors.push(UnitFactor { name, exponent: (sign * numerator, denominator) });
        Ok(())
    }

    /// `unit_exponent := "-"? whole | "(" "-"? whole ("/" whole)? ")"`
    pub(super) fn unit_exponent(&mut self) -> Parsed<(i32, i32)> {
        if !self.opens('(') {
            return Ok((self.signed_whole()?, 1));
        }
        self.open()?;
        let numerator = self.signed_whole()?;
        let slash = self.eat("/").is_some();
        let (span, denominator) = (self.next(), if slash { self.whole()? } else { 1 });
        if denominator == 0 {
            return Err(self.refuse(
                Code::UnitForm,
                span,
                "this exponent divides by zero",
                "write a fraction such as `m^(1/2)`",
            ));
        }
        if !self.is_at_end() {
            return Err(self.unexpected("`)`", "write a fraction such as `m^(1/2)`"));
        }
        self.close();
        Ok((numerator, denominator))
    }

    fn signed_whole(&mut self) -> Parsed<i32> {
        let sign = if self.eat("-").is_some() { -1 } else { 1 };
        Ok(sign * self.whole()?)
    }

    /// A whole number up to 100, so that no arithmetic with exponents overflows.
    fn whole(&mut self) -> Parsed<i32> {
        let span = self.next();
        let help = "write a whole number as in `m^2`, or a fraction as in `m^(1/2)`, up to 100";
        match self.literal() {
            Some(text) => match text.parse() {
                Ok(number @ 0..=100) => Ok(number),
                _ => Err(self.refuse(Code::UnitForm, span, format!("`{text}` cannot be the exponent of a unit"), help)),
            },
            None => Err(self.unexpected("the exponent of a unit", help)),
        }
    }

    /// A name that is being declared behind the word `after`.
    pub(super) fn declared_name(&mut self, after: &str) -> Parsed<Name> {
        let name = self.name(&format!("`{after}`"))?;
        match taken(&name.text) {
            Some(what) => {
                let help = format!("choose another name, such as `{}_`", name.text);
                Err(self.refuse(
                    Code::ReservedName,
                    name.span.clone(),
                    format!("`{}` cannot be declared: it is {what}", name.text),
                    help,
                ))
            }
            None => Ok(name),
        }
    }

    /// A name of letters, digits and `_`, with at least one letter.
    pub(super) fn name(&mut self, after: &str) -> Parsed<Name> {
        let Some(text) = self.word() else {
            return Err(self.unexpected(&format!("a name after {after}"), "a name begins with a letter"));
        };
        self.skip();
        let span = self.last - text.len()..self.last;
        if let Some(plain) = text.strip_prefix("r#") {
            let help = format!("write `{plain}{}`", if taken(plain).is_some() { "_" } else { "" });
            return Err(self.refuse(Code::NotAName, span, format!("`{text}` is not a name"), help));
        }
        if !text.contains(|c: char| c.is_ascii_alphabetic()) {
            return Err(self.refuse(
                Code::NotAName,
                span,
                format!("`{text}` is not a name"),
                "a name has at least one letter",
            ));
        }
        Ok(Name { text: text.to_string(), span })
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, statement};
    use super::super::syntax::StatementKind;
    use super::*;

    fn unit(text: &str) -> Vec<(String, (i32, i32))> {
        match statement(&format!("coord x: {text};")) {
            StatementKind::Coord(Quantity { unit: Some(unit), .. }) => {
                unit.factors.into_iter().map(|factor| (factor.name.text, factor.exponent)).collect()
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn reads_declarations() {
        let StatementKind::Param(mass) = statement("param mass[6]: kg = [1, 2];") else { panic!() };
        assert_eq!((mass.name.text.as_str(), mass.length.as_ref().map(prefix)), ("mass", Some("6".to_string())));
        assert_eq!(mass.value.as_ref().map(prefix), Some("[1 2]".to_string()));
        let StatementKind::Param(free) = statement("param free: 1;") else { panic!() };
        assert!(free.value.is_none() && free.unit.unwrap().factors.is_empty());
        let StatementKind::Coord(q) = statement("coord q[2*n]: rad;") else { panic!() };
        assert_eq!(q.length.as_ref().map(prefix), Some("(* 2 n)".to_string()));
        let StatementKind::Input(tau) = statement("input tau: N*m;") else { panic!() };
        assert!(tau.value.is_none() && tau.length.is_none());
        let StatementKind::Const(n) = statement("const n = 6;") else { panic!() };
        assert!(n.unit.is_none() && n.value.is_some());
        let StatementKind::Const(d) = statement("const d[6]: m = [1];") else { panic!() };
        assert!(d.unit.is_some() && d.length.is_some());
    }

    #[test]
    fn reads_units() {
        let check = |text: &str, expected: &[(&str, (i32, i32))]| {
            let expected: Vec<_> = expected.iter().map(|&(name, exponent)| (name.to_string(), exponent)).collect();
            assert_eq!(unit(text), expected, "{text}");
        };
        check("1", &[]);
        check("kg*m^2/s^2", &[("kg", (1, 1)), ("m", (2, 1)), ("s", (-2, 1))]);
        check("m^(1/2)", &[("m", (1, 2))]);
        check("m^(-3/2)", &[("m", (-3, 2))]);
        check("m^(-3)", &[("m", (-3, 1))]);
        check("1/s", &[("s", (-1, 1))]);
        check("s^-2", &[("s", (-2, 1))]);
        check("1/s^-2", &[("s", (2, 1))]);
        check("J/(kg*K/s)", &[("J", (1, 1)), ("kg", (-1, 1)), ("K", (-1, 1)), ("s", (1, 1))]);
        check("m/s/s", &[("m", (1, 1)), ("s", (-1, 1)), ("s", (-1, 1))]);
    }

    #[test]
    fn declarations_say_what_they_lack() {
        refused(
            "param length = 1.0;",
            "param length: `param length` needs a unit; write `param length: m = …;`, `1` for a pure number",
        );
        refused(
            "coord q[6];",
            "coord q[6]: `coord q[6]` needs a unit; write `coord q[6]: rad;`, `1` for a pure number",
        );
        refused("input u:;", "input u: `input u` needs a unit; write `input u: N;`, `1` for a pure number");
        refused(
            "const n: = 6;",
            "const n: `const n` has a `:` but no unit; write `const n: m = …;`, or leave the `:` out",
        );
        refused("param l m = 1;", "m: expected `:` and a unit, found `m`; write `param l: m`, `1` for a pure number");
        refused("const n: 1;", "const n: this `const` needs a value; write `const n = …;`, or make it a `param`");
        refused(
            "coord q: rad = 1;",
            "=: `coord q` cannot have a value; \
             leave it out: its initial value is part of the state that a simulation begins with",
        );
        refused(
            "input u: N = 1;",
            "=: `input u` cannot have a value; leave it out: its value is given while the mechanism moves",
        );
        refused("param : kg = 1;", ":: expected a name after `param`, found `:`; a name begins with a letter");
        refused("param 2m: kg = 1;", "2m: expected a name after `param`, found `2m`; a name begins with a letter");
        refused(
            "coord x[2][3]: m;",
            "[: `coord` takes one index: `param` and `let` take two; write an array for each row, `x[n]` and `y[n]`, \
             or one for all of them, `r[3*n]` with `r[3*i + k]`",
        );
        refused("param a[1, 2]: m = 1;", ",: an index is one number; write `a[i][j]` for an element of a matrix");
        let value = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
        refused("param a[]: m = 1;", &format!("]: expected a value, found `]`; {value}"));
        refused("param a: m = ;", &format!(";: expected a value, found `;`; {value}"));
        refused("param a: m 1;", "1: expected `=` or `;`, found `1`; write a value behind `=`");
    }

    #[test]
    fn names_are_free_words() {
        let taken = |name: &str, what: &str| {
            let expected =
                format!("{name}: `{name}` cannot be declared: it is {what}; choose another name, such as `{name}_`");
            refused(&format!("param {name}: m = 1;"), &expected);
            refused(&format!("let mut {name} = 1;"), &expected);
            refused(&format!("output {name} = 1;"), &expected);
            refused(&format!("for {name} in 0..1 {{}}"), &expected);
        };
        for name in ["force", "coord", "prescribed", "in", "mechanism"] {
            taken(name, "a keyword of the language");
        }
        taken("t", "the time");
        refused("let _ = 1;", "_: `_` is not a name; a name has at least one letter");
        refused("let r#loop = 1;", "r#loop: `r#loop` is not a name; write `loop`");
        refused("let r#for = 1;", "r#for: `r#for` is not a name; write `for_`");
        for name in ["match", "self", "Self", "crate", "type", "true", "gen"] {
            statement(&format!("param {name}: m = 1;"));
            statement(&format!("let x = {name}*{name}[0]*{name}(1);"));
        }
        statement("let force_ = 1;");
        statement("let union = 1;");
    }

    #[test]
    fn units_are_products_of_powers() {
        refused("coord x: N m;", "m: a `*` is missing before the unit `m`; write it as in `N*m`");
        refused("coord x: m^1/2;", "2: `2` is not a unit; numbers belong to the value; write a root as `m^(1/2)`");
        let whole = "write a whole number as in `m^2`, or a fraction as in `m^(1/2)`, up to 100";
        refused("coord x: m^0.5;", &format!("0.5: `0.5` cannot be the exponent of a unit; {whole}"));
        refused("coord x: m^999;", &format!("999: `999` cannot be the exponent of a unit; {whole}"));
        refused("coord x: m^n;", &format!("n: expected the exponent of a unit, found `n`; {whole}"));
        refused("coord x: m^(1/0);", "0: this exponent divides by zero; write a fraction such as `m^(1/2)`");
        refused("coord x: m**2;", "**: `**` is not an operator; write `^` for a power: `x^2`");
        refused(
            "coord x: m*;",
            ";: expected a unit, found `;`; write a unit such as `kg*m^2/s^2`, `1` for a pure number",
        );
        refused("coord x: (m/s)^2;", "^: a unit in parentheses has no power; write the power of each unit");
    }
}
