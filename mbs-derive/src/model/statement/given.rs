//! Numbers with units that are given outside of a declaration, in SI units.

use crate::expr::Number;
use crate::model::value::dimension::{Dimension, Measure, measure};
use crate::parse;
use crate::parse::syntax::StatementKind;
use crate::source::Sources;

/// A unit as a declaration writes it: `N*m`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit<'a>(pub &'a str);

impl Unit<'_> {
    /// The value in SI units of a number with a unit, `20 deg`, whose dimension is that of this unit.
    ///
    /// ```
    /// use mbs_derive::model::Unit;
    /// assert_eq!(Unit("m/s").in_si("90 km/h"), Ok(25.0));
    /// assert!(Unit("m").in_si("20 deg").is_err());
    /// ```
    ///
    /// # Errors
    /// As the end of a sentence: it is not a number with a unit, its unit is not known, or of another dimension, or it
    /// is too large in SI units.
    pub fn in_si(self, text: &str) -> Result<f64, String> {
        let (number, own) = split(text).ok_or("write a number and its unit, as in \"20 deg\"")?;
        let (wanted, found) = (of_unit(self.0)?, of_unit(own)?);
        if wanted.dimension != found.dimension {
            let wanted = if wanted.dimension == Dimension::ONE {
                "an angle or a plain number".to_string()
            } else {
                in_words(wanted.dimension)
            };
            return Err(format!("its unit `{own}` does not fit, {wanted} is wanted"));
        }
        let value = Number::parse_decimal(number.trim_start_matches(['+', '-'])).ok_or("the number is too long")?;
        let value = (value * found.scale).to_f64();
        if !value.is_finite() {
            return Err("it is too large in SI units".to_string());
        }
        Ok(if number.starts_with('-') { -value } else { value })
    }

    /// Whether a unit as documentation writes it, `kg·m²/s²`, is one of those that this one stands for.
    ///
    /// ```
    /// use mbs_derive::model::Unit;
    /// assert!(Unit("N*m").is_shown_as("kg·m²/s²") && !Unit("N").is_shown_as("kg·m²/s²"));
    /// ```
    pub fn is_shown_as(self, shown: &str) -> bool {
        let shown = Unit(shown).in_ascii();
        of_unit(&shown).is_ok_and(|found| of_unit(self.0).is_ok_and(|wanted| wanted.dimension == found.dimension))
    }

    /// A unit as documentation writes it, `kg·m²/s²`, as a declaration does.
    ///
    /// ```
    /// use mbs_derive::model::Unit;
    /// assert_eq!(Unit("kg·m²/s¹²").in_ascii(), "kg*m^2/s^12");
    /// ```
    pub fn in_ascii(self) -> String {
        let mut plain = String::new();
        let mut raised = false;
        for c in self.0.chars() {
            let digit = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|known| known == c);
            match (digit, c) {
                (Some(digit), _) => plain += &format!("{}{digit}", if raised { "" } else { "^" }),
                (None, '·') => plain.push('*'),
                (None, c) => plain.push(c),
            }
            raised = digit.is_some();
        }
        plain
    }

    /// The exponents of kg, m, s, A, K, mol and cd in the unit; `None` where it is none, or they are not whole.
    ///
    /// ```
    /// use mbs_derive::model::Unit;
    /// assert_eq!(Unit("N*m*s/rad").base_exponents(), Some([1, 2, -1, 0, 0, 0, 0]));
    /// ```
    pub fn base_exponents(self) -> Option<[i16; 7]> {
        of_unit(self.0).ok()?.dimension.whole()
    }
}

fn in_words(dimension: Dimension) -> String {
    if dimension == Dimension::ONE { "a plain number".to_string() } else { dimension.to_string() }
}

/// The number and the unit behind it.
fn split(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let digits = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '+' | '-')));
    let number = |end: &usize| text[..*end].parse::<f64>();
    let end = (1..=digits?).rev().find(|end| number(end).is_ok())?;
    let unit = text[end..].trim();
    (number(&end).is_ok_and(f64::is_finite) && !unit.is_empty()).then_some((&text[..end], unit))
}

/// What a unit means, as a declaration would take it.
fn of_unit(unit: &str) -> Result<Measure, String> {
    let unknown = || format!("`{unit}` is not a unit");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '*' | '/' | '^' | '(' | ')' | '-' | ' ' | '%');
    if !unit.chars().all(is_plain) {
        return Err(unknown());
    }
    let statements = parse::shared(&Sources::new("", &format!("const given: {unit} = 1;")));
    let Some(Ok(statements)) = statements else { return Err(unknown()) };
    match statements.first().map(|statement| &statement.kind) {
        Some(StatementKind::Const(quantity)) if statements.len() == 1 => {
            let unit = quantity.unit.as_ref().ok_or_else(unknown)?;
            measure(unit).map_err(|error| match error.help {
                Some(help) => format!("{}; {help}", error.message),
                None => error.message,
            })
        }
        _ => Err(unknown()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_units() {
        let check = |text: &str, unit: &str, expected: f64| assert_eq!(Unit(unit).in_si(text), Ok(expected), "{text}");
        check("20 deg", "rad", 20f64.to_radians());
        check("-20deg", "rad", -20f64.to_radians());
        check("2.5e-1 mm", "m", 2.5e-4);
        check("3 kN*mm", "N*m", 3.0);
        // Next to π/60, as `PI / 60.0` is not.
        check("3 deg/s", "(rad)/s", 0.052_359_877_559_829_89);
        check("3 m/s^2", "(m/s)/s", 3.0);
        check("7 1", "1", 7.0);
    }

    #[test]
    fn units_of_documentation() {
        assert!(
            Unit("N*m").is_shown_as("kg·m²/s²") && Unit("rad").is_shown_as("1") && Unit("m/s^12").is_shown_as("m/s¹²")
        );
        assert!(!Unit("N").is_shown_as("kg·m²/s²") && !Unit("N").is_shown_as("nonsense"));
    }

    #[test]
    fn what_is_none() {
        let check = |text: &str, unit: &str, expected: &str| {
            assert_eq!(Unit(unit).in_si(text).unwrap_err(), expected, "{text}")
        };
        let form = "write a number and its unit, as in \"20 deg\"";
        for text in ["", "deg", "20", "NaN deg", "inf m", "1e999 m", "nan", "infinity m"] {
            check(text, "rad", form);
        }
        check("20 deg", "m", "its unit `deg` does not fit, m is wanted");
        check("20 m", "rad", "its unit `m` does not fit, an angle or a plain number is wanted");
        check("1e308 kN", "N", "it is too large in SI units");
        check("20 m; 3", "m", "`m; 3` is not a unit");
        check("20 m = 3", "m", "`m = 3` is not a unit");
        assert!(Unit("m").in_si("2 furlong").unwrap_err().starts_with("`furlong` is not a unit; "));
    }
}
