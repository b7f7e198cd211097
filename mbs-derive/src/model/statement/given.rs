//! Numbers with units that are given outside of a declaration, in SI units.

use crate::expr::Number;
use crate::model::value::dimension::{Dimension, Measure, measure};
use crate::parse;
use crate::parse::syntax::StatementKind;
use crate::source::Sources;

/// The value in SI units of a number with a unit, `20 deg`, whose dimension is that of `unit`.
///
/// ```
/// use mbs_derive::model::in_si;
/// assert_eq!(in_si("90 km/h", "m/s"), Ok(25.0));
/// assert!(in_si("20 deg", "m").is_err());
/// ```
///
/// # Errors
/// As the end of a sentence: it is not a number with a unit, its unit is not known, or of another dimension.
pub fn in_si(text: &str, unit: &str) -> Result<f64, String> {
    let (number, own) = split(text).ok_or("write a number and its unit, as in \"20 deg\"")?;
    let (wanted, found) = (of_unit(unit)?, of_unit(own)?);
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
    Ok(if number.starts_with('-') { -value } else { value })
}

/// Whether a unit as documentation writes it, `kg·m²/s²`, is one of those that `unit` stands for.
///
/// ```
/// use mbs_derive::model::is_of;
/// assert!(is_of("kg·m²/s²", "N*m") && !is_of("kg·m²/s²", "N"));
/// ```
pub fn is_of(shown: &str, unit: &str) -> bool {
    let mut plain = String::new();
    let mut raised = false;
    for c in shown.chars() {
        let digit = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|known| known == c);
        match (digit, c) {
            (Some(digit), _) => plain += &format!("{}{digit}", if raised { "" } else { "^" }),
            (None, '·') => plain.push('*'),
            (None, c) => plain.push(c),
        }
        raised = digit.is_some();
    }
    of_unit(&plain).is_ok_and(|found| of_unit(unit).is_ok_and(|wanted| wanted.dimension == found.dimension))
}

/// The exponents of kg, m, s, A, K, mol and cd in a unit; `None` where it is none, or they are not whole.
///
/// ```
/// use mbs_derive::model::base_exponents;
/// assert_eq!(base_exponents("N*m*s/rad"), Some([1, 2, -1, 0, 0, 0, 0]));
/// ```
pub fn base_exponents(unit: &str) -> Option<[i16; 7]> {
    of_unit(unit).ok()?.dimension.whole()
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
        let check = |text: &str, unit: &str, expected: f64| assert_eq!(in_si(text, unit), Ok(expected), "{text}");
        check("20 deg", "rad", 20f64.to_radians());
        check("-20deg", "rad", -20f64.to_radians());
        check("2.5e-1 mm", "m", 2.5e-4);
        check("3 kN*mm", "N*m", 3.0);
        check("3 deg/s", "(rad)/s", std::f64::consts::PI / 60.0);
        check("3 m/s^2", "(m/s)/s", 3.0);
        check("7 1", "1", 7.0);
    }

    #[test]
    fn units_of_documentation() {
        assert!(is_of("kg·m²/s²", "N*m") && is_of("1", "rad") && is_of("m/s¹²", "m/s^12"));
        assert!(!is_of("kg·m²/s²", "N") && !is_of("nonsense", "N"));
    }

    #[test]
    fn what_is_none() {
        let check =
            |text: &str, unit: &str, expected: &str| assert_eq!(in_si(text, unit).unwrap_err(), expected, "{text}");
        let form = "write a number and its unit, as in \"20 deg\"";
        for text in ["", "deg", "20", "NaN deg", "inf m", "1e999 m", "nan", "infinity m"] {
            check(text, "rad", form);
        }
        check("20 deg", "m", "its unit `deg` does not fit, m is wanted");
        check("20 m", "rad", "its unit `m` does not fit, an angle or a plain number is wanted");
        check("20 m; 3", "m", "`m; 3` is not a unit");
        check("20 m = 3", "m", "`m = 3` is not a unit");
        assert!(in_si("2 furlong", "m").unwrap_err().starts_with("`furlong` is not a unit; "));
    }
}
