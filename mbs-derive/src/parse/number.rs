//! Numbers, alone or before a unit.

use super::in_place::is_unit;
use super::reader::{Parsed, Reader};
use super::syntax::Expression;
use crate::diagnostic::Code;

impl Reader<'_> {
    /// `number := digits "." | digits ("." digits)? (("e" | "E") ("+" | "-")? digits)?`, as large as an `f64` can be;
    /// `quantity := number unit`
    pub(super) fn number(&mut self) -> Parsed<Box<Expression>> {
        let Some(text) = self.literal() else { return Err(self.no_value()) };
        let span = self.last - text.len()..self.last;
        let (decimal, suffix) = text.split_at(decimal_length(text));
        let decimal: String = decimal.chars().filter(|&c| c != '_').collect();
        if let Some((message, help)) = no_number(text, &decimal, suffix) {
            return Err(self.refuse(Code::NumberForm, span, message, help));
        }
        self.number_or_quantity(span.start, decimal, suffix)
    }
}

/// Why `text`, which is `decimal` with underscores and then `suffix`, is not a number, and what to write.
pub(super) fn no_number(text: &str, decimal: &str, suffix: &str) -> Option<(String, String)> {
    const TYPES: [&str; 8] = ["f32", "f64", "i32", "i64", "u32", "u64", "usize", "isize"];
    if decimal.is_empty() {
        return Some((format!("`{text}` is not a value"), "write a number".to_string()));
    }
    if decimal.len() > 100 {
        return Some(("this number is longer than 100 characters".to_string(), "an `f64` has 17 digits".to_string()));
    }
    if decimal == "0" && suffix.starts_with(['x', 'o', 'b']) {
        return Some((format!("`{text}` is not a decimal number"), "write it with digits 0 to 9".to_string()));
    }
    if TYPES.contains(&suffix.trim_start_matches('_')) {
        return Some(("a number has no type".to_string(), format!("write `{decimal}`")));
    }
    if !suffix.is_empty() && !is_unit(suffix) {
        let help = format!("write `{decimal}*{suffix}` for a product; `{suffix}` is not a unit");
        return Some((format!("`{text}` is neither a number nor a name"), help));
    }
    let mantissa = decimal.split(['e', 'E']).next().unwrap_or_default();
    let zero = !mantissa.contains(|c: char| ('1'..='9').contains(&c));
    match decimal.parse::<f64>() {
        Ok(value) if value.is_finite() && (value != 0.0 || zero) => None,
        _ => Some((format!("`{text}` is beyond the range of an `f64`"), "choose other units".to_string())),
    }
}

/// How much of `text` is a decimal number, the underscores among and behind its digits included, but not those before a
/// suffix: `2k_g` and `2_m` are no quantities.
fn decimal_length(text: &str) -> usize {
    let digits = |from: usize| match text[from..].starts_with('_') {
        true => 0,
        false => text[from..].bytes().take_while(|c| c.is_ascii_digit() || *c == b'_').count(),
    };
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end += 1 + digits(end + 1);
    }
    let sign = usize::from(text[end..].get(1..).is_some_and(|rest| rest.starts_with(['+', '-'])));
    if text[end..].starts_with(['e', 'E']) && digits(end + 1 + sign) > 0 {
        end += 1 + sign + digits(end + 1 + sign);
    }
    if end == text.len() { end } else { text[..end].trim_end_matches('_').len() }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, statement};
    use super::super::syntax::StatementKind;

    #[test]
    fn reads_numbers_next_to_points() {
        let check = |text: &str, expected: &str| match statement(&format!("let x = {text};")) {
            StatementKind::Let { value, .. } => assert_eq!(prefix(&value), expected, "{text}"),
            other => panic!("{other:?}"),
        };
        check("1.sin()", "1.sin()");
        check("1.0.sin()", "1.0.sin()");
        check("1_000.5", "1000.5");
        check("1_000_", "1000");
        check("1_.5_e-1_0", "1.5e-10");
        check("1.", "1.");
        check("1e-3", "1e-3");
        check("1.5E+3", "1.5E+3");
        check("1e5", "1e5");
        check("0", "0");
        check("0.0e-999", "0.0e-999");
        check("2.-1.", "(- 2. 1.)");
        assert!(matches!(statement("for i in 0..6 {}"), StatementKind::For { .. }));
        assert!(matches!(statement("for i in 0. .. 6. {}"), StatementKind::For { .. }));
        assert!(matches!(statement("for i in 0.0..6.0 {}"), StatementKind::For { .. }));
    }
}
