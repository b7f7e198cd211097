//! Numbers: fractions where people write fractions, decimals where they write decimals.

use crate::expr::Number;

use super::notation::script;

/// A positive number: an integer, a fraction or a decimal, as people write it.
pub(super) fn number(value: Number) -> String {
    let (numerator, denominator) = numerator_and_denominator(value);
    if denominator == "1" { numerator } else { format!("\\frac{{{numerator}}}{{{denominator}}}") }
}

pub(super) fn numerator_and_denominator(value: Number) -> (String, String) {
    let Number::Exact { numerator, denominator, pi } = value else { return (decimal(value), "1".to_string()) };
    let digits = || if pi == 0 { decimal(value) } else { decimal(value * power_of_pi(-pi)) };
    let terminates = (0..19).fold(denominator, |rest, _| match () {
        () if rest % 5 == 0 => rest / 5,
        () if rest % 2 == 0 => rest / 2,
        () => rest,
    }) == 1;
    // 3/8 and 2/5 are fractions, 9.81 and 0.05 are decimals.
    let fraction = denominator <= 4 || denominator == 8 || denominator == 16 || (denominator == 5 && numerator < 10);
    let long = numerator > 999_999 || denominator > 9_999;
    let (above, below) = match denominator {
        1 if !long => (numerator.to_string(), 1),
        _ if !long && (fraction || !terminates) => (numerator.to_string(), denominator),
        _ => (digits(), 1),
    };
    let symbol = script_power("\\pi", pi.unsigned_abs());
    let with = |number: String| match (number.as_str(), symbol.as_str()) {
        (_, "") => number,
        ("1", _) => symbol.clone(),
        _ => format!("{number} {symbol}"),
    };
    if pi >= 0 { (with(above), below.to_string()) } else { (above, with(below.to_string())) }
}

fn power_of_pi(n: i8) -> Number {
    Number::PI.power(2 * i32::from(n)).unwrap_or(Number::ONE)
}

fn script_power(base: &str, exponent: u8) -> String {
    match exponent {
        0 => String::new(),
        1 => base.to_string(),
        n => format!("{base}{}", script('^', &n.to_string())),
    }
}

/// The shortest decimal, `6.67 \cdot 10^{-11}` for very large and very small ones.
pub(super) fn decimal(value: Number) -> String {
    let text = format!("{:?}", value.to_f64());
    let text = text.strip_suffix(".0").unwrap_or(&text);
    match text.split_once('e') {
        Some(("1", exponent)) => format!("10^{{{exponent}}}"),
        Some((digits, exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
        None => text.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_fractions_where_people_write_fractions() {
        let written = |text: &str| number(Number::parse_decimal(text).unwrap_or(Number::ZERO));
        assert_eq!(
            ["2", "0.5", "0.4", "9.81", "0.05", "1e-11"].map(written),
            ["2", r"\frac{1}{2}", r"\frac{2}{5}", "9.81", "0.05", "1 \\cdot 10^{-11}"]
                .map(|text| text.replace("1 \\cdot ", ""))
        );
        assert_eq!(number(Number::PI * Number::rational(3, 2).unwrap_or(Number::ONE)), r"\frac{3 \pi}{2}");
        assert_eq!(number(Number::rounded(1.5e-11, 0.0)), r"1.5 \cdot 10^{-11}");
    }
}
