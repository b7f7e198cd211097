//! Quantities in place: a number with its unit behind it, `0.3 kg`, `9.81 m/s^2`.
//!
//! ```text
//! quantity := number unit_name exponent? (("*" | "/") unit_name exponent?)*   (white space behind the number only)
//! ```
//!
//! The unit binds more tightly than any operator and is the longest that can be read: `0.3 kg*x` is `(0.3 kg)*x`, for
//! `x` is no unit. It ends before a name that is called, indexed or has a component, before `t`, which is the time, and
//! before a second unit of the same quantity, so that the `g` of `0.3 kg*g` is a name (`m/s/s` may be written). Whether
//! a name of the mechanism might have been meant in place of a unit is for the next pass to say, which knows these
//! names.

use super::reader::{Parsed, Reader, Refused};
use super::syntax::{BinaryOperator, Expression, ExpressionKind, Name, Span, Unit, UnitFactor};
use crate::diagnostic::Code;

/// The names of all units, those of one quantity together.
pub(crate) const UNITS: [&[&str]; 20] = [
    &["kg", "g", "t"],
    &["m", "km", "dm", "cm", "mm", "um"],
    &["s", "ms", "us", "min", "h"],
    &["rad", "deg"],
    &["N", "mN", "kN", "MN"],
    &["J", "kJ", "MJ"],
    &["W", "kW", "MW"],
    &["Pa", "kPa", "MPa", "GPa", "bar"],
    &["Hz", "kHz", "rpm"],
    &["A", "mA"],
    &["V"],
    &["C"],
    &["T"],
    &["Wb"],
    &["H"],
    &["F"],
    &["ohm"],
    &["K"],
    &["mol"],
    &["cd"],
];

/// Which quantity it is a unit of, if it is one.
fn quantity(name: &str) -> Option<usize> {
    UNITS.iter().position(|names| names.contains(&name))
}

pub(super) fn is_unit(name: &str) -> bool {
    quantity(name).is_some()
}

impl Reader<'_> {
    /// The number `decimal`, which begins at `start`, or a quantity where `suffix` or what stands behind it is a unit.
    pub(super) fn number_or_quantity(
        &mut self,
        start: usize,
        decimal: String,
        suffix: &str,
    ) -> Parsed<Box<Expression>> {
        let Some(first) = self.first_unit(suffix) else {
            return Ok(Box::new(Expression { kind: ExpressionKind::Number(decimal), span: start..self.last }));
        };
        let unit = self.unit_in_place(first)?;
        Ok(Box::new(Expression { kind: ExpressionKind::Quantity(decimal, unit), span: start..self.last }))
    }

    /// `2m`, or `2 m`.
    fn first_unit(&mut self, suffix: &str) -> Option<Name> {
        if !suffix.is_empty() {
            let span = self.last - suffix.len()..self.last;
            return quantity(suffix).map(|_| Name { text: suffix.to_string(), span });
        }
        let text = self.word()?;
        if quantity(text).is_none() || self.begins_line() || self.is_applied(self.at + 1) {
            return None;
        }
        self.skip();
        Some(Name { span: self.last - text.len()..self.last, text: text.to_string() })
    }

    fn unit_in_place(&mut self, first: Name) -> Parsed<Unit> {
        let start = first.span.start;
        let mut factors = Vec::new();
        self.factor_in_place(first, 1, &mut factors)?;
        while let Some((sign, text)) = self.next_factor(&factors) {
            self.skip();
            self.skip();
            let name = Name { span: self.last - text.len()..self.last, text };
            self.factor_in_place(name, sign, &mut factors)?;
        }
        Ok(Unit { factors, span: start..self.last })
    }

    fn factor_in_place(&mut self, name: Name, sign: i32, factors: &mut Vec<UnitFactor>) -> Parsed<()> {
        let (numerator, denominator) = match self.peek("^") && self.next().start == self.last {
            true => {
                self.eat("^");
                self.unit_exponent()?
            }
            false => (1, 1),
        };
        factors.push(UnitFactor { name, exponent: (sign * numerator, denominator) });
        Ok(())
    }

    /// The sign of its exponent and the name, if the unit goes on.
    fn next_factor(&self, before: &[UnitFactor]) -> Option<(i32, String)> {
        let operator = self.sign().filter(|sign| ["*", "/"].contains(sign))?;
        let text = self.word_at(self.at + 1)?;
        let name = self.tokens[self.at + 1].span();
        let is_joined = self.next().start == self.last && name.start == self.last + operator.len();
        let kind = quantity(text)?;
        let of_the_same = |factor: &&UnitFactor| quantity(&factor.name.text) == Some(kind);
        let divides_again = |factor: &UnitFactor| operator == "/" && factor.name.text == text && factor.exponent.0 < 0;
        let is_new = before.iter().find(of_the_same).is_none_or(divides_again);
        let goes_on = is_joined && is_new && text != "t" && !self.is_applied(self.at + 2);
        goes_on.then(|| (if operator == "/" { -1 } else { 1 }, text.to_string()))
    }

    /// Whether what stands at token `behind` calls the name before it, indexes it, or is a component or method of it.
    fn is_applied(&self, behind: usize) -> bool {
        let component = self.sign_at(behind) == Some(".") && self.word_at(behind + 1).is_some();
        component || self.opens_at(behind, '(') || self.opens_at(behind, '[')
    }
}

// ---- what may be read in two ways

impl Reader<'_> {
    /// Whether it is a quantity that no parentheses enclose.
    pub(super) fn is_bare_quantity(&self, value: &Expression) -> bool {
        matches!(value.kind, ExpressionKind::Quantity(..)) && !self.source[value.span.start..].starts_with('(')
    }

    /// A quantity right behind `/` or `^`.
    pub(super) fn quantity_behind(&mut self, operator: BinaryOperator, quantity: &Expression) -> Refused {
        let text = self.source[quantity.span.clone()].to_string();
        if operator == BinaryOperator::Pow {
            let help = "write the power in brackets, and `*` before a quantity";
            return self.refuse(Code::QuantityOrProduct, quantity.span.clone(), "an exponent is a plain number", help);
        }
        let product = text.split_whitespace().collect::<Vec<_>>().join("*");
        let help = format!(
            "write `/({text})` to divide by it, `/{product}` where that is a name; a fraction of a unit is a decimal: `0.5 kg`, \
             not `1/2 kg`"
        );
        self.refuse(
            Code::QuantityOrProduct,
            quantity.span.clone(),
            format!("does the unit of `/{text}` belong to the divisor?"),
            help,
        )
    }

    /// `2 m ^2`, which is neither `2 m^2` nor `(2 m)^2`.
    pub(super) fn power_of_a_quantity(&mut self, quantity: &Expression) -> Refused {
        let (text, here): (_, Span) = (self.source[quantity.span.clone()].to_string(), self.last - 1..self.last);
        let help = format!("write `({text})^2`, or `{text}^2` without white space for a power of the unit");
        self.refuse(Code::QuantityOrProduct, here, "is this a power of the unit, or of the quantity?", help)
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, statement};
    use super::super::syntax::StatementKind;

    fn check(text: &str, expected: &str) {
        match statement(&format!("let x = {text};")) {
            StatementKind::Let { value, .. } => assert_eq!(prefix(&value), expected, "{text}"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn units_bind_more_tightly_than_operators() {
        check("0.3 kg", "0.3{kg}");
        check("0.3kg", "0.3{kg}");
        check("1e3 rpm", "1e3{rpm}");
        check("1e3rpm", "1e3{rpm}");
        check("1_500 rpm", "1500{rpm}");
        check("9.81 m/s^2", "9.81{m*s^-2}");
        check("9.81 m/s/s", "9.81{m*s^-1*s^-1}");
        check("0.02 N*m*s", "0.02{N*m*s}");
        check("2 m^(1/2)*kg^-1", "2{m^(1/2)*kg^-1}");
        check("-20 deg", "(neg 20{deg})");
        check("0.3 kg*x", "(* 0.3{kg} x)");
        check("1/2*0.3 kg*v^2", "(* (* (/ 1 2) 0.3{kg}) (^ v 2))");
        check("0.3 kg*9.81 m/s^2*z", "(* (* 0.3{kg} 9.81{m*s^-2}) z)");
        check("f(2 m, 30 deg)", "f(2{m} 30{deg})");
        check("[1 m, 2 m]", "[1{m} 2{m}]");
        check("(2 m)^2/(4 s)", "(/ (^ 2{m} 2) 4{s})");
        check("2 m + 3 cm - 1 mm", "(- (+ 2{m} 3{cm}) 1{mm})");
        check("if x < 2 m { 1 N } else { 0 }", "(if (< x 2{m}) 1{N} 0)");
    }

    #[test]
    fn units_end_where_names_begin() {
        // With white space around it, an operator is one.
        check("5 N * m", "(* 5{N} m)");
        check("9.81 m / s^2", "(/ 9.81{m} (^ s 2))");
        check("5 N* m", "(* 5{N} m)");
        check("2 rad/s*t", "(* 2{rad*s^-1} t)");
        check("3 m/t", "(/ 3{m} t)");
        check("5 t", "5{t}");
        check("0.3 kg*g*h", "(* (* 0.3{kg} g) h)");
        check("3 m*m", "(* 3{m} m)");
        check("5 N*m[0]", "(* 5{N} m[0])");
        check("5 N*s.x", "(* 5{N} s.x)");
        check("5 s*min(a, b)", "(* 5{s} min(a b))");
        check("2 kg*x/s", "(/ (* 2{kg} x) s)");
        check("2 N*(m + s)", "(* 2{N} (+ m s))");
        check("m*2", "(* m 2)");
    }

    #[test]
    fn what_may_be_read_in_two_ways_is_refused() {
        let divisor = |text: &str| {
            format!(
                "{text}: does the unit of `/{text}` belong to the divisor?; write `/({text})` to divide by it, `/{}` where \
                 that is a name; a fraction of a unit is a decimal: `0.5 kg`, not `1/2 kg`",
                text.replace(' ', "*")
            )
        };
        refused("let x = 1/2 kg*v^2;", &divisor("2 kg"));
        refused("let x = y/3 s;", &divisor("3 s"));
        refused("let x = y/-3 s;", &divisor("3 s"));
        refused(
            "let x = y^2 m;",
            "2 m: an exponent is a plain number; write the power in brackets, and `*` before a quantity",
        );
        refused(
            "let x = 2 m ^2;",
            "^: is this a power of the unit, or of the quantity?; write `(2 m)^2`, or `2 m^2` without white space for a power \
             of the unit",
        );
        refused(
            "let x = 2 m^n;",
            "n: expected the exponent of a unit, found `n`; write a whole number as in `m^2`, or a fraction as in `m^(1/2)`, up \
             to 100",
        );
        refused("let x = 2 m kg;", "kg: an operator is missing before `kg`; write `*` for a product");
        refused("let x = 2 x;", "x: an operator is missing before `x`; write `*` for a product; `x` is not a unit");
        refused("let x = 2x;", "2x: `2x` is neither a number nor a name; write `2*x` for a product; `x` is not a unit");
        refused("let x = 2\ncoord m: m;", ": a `;` is missing; end the statement with `;`");
    }
}
