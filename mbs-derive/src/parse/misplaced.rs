//! What stands where a value should, or behind one: most often something of another language.

use super::condition::no_condition;
use super::reader::{Reader, Refused};
use super::syntax::Span;
use crate::diagnostic::Code;
use crate::expr::Function;

impl Reader<'_> {
    /// Where a value must begin, something else does.
    pub(super) fn no_value(&mut self) -> Refused {
        let here = self.next();
        match self.sign() {
            Some("+") => self.refuse(Code::ForeignOperator, here, "a `+` before a value says nothing", "leave it out"),
            Some("*") if self.source[..here.start].trim_end().ends_with('*') => self.double_star(),
            Some(".") if self.number_at(self.at + 1) => {
                self.skip();
                let number = self.literal().unwrap_or_default();
                self.refuse(Code::NumberForm, here, "a number begins with a digit", format!("write `0.{number}`"))
            }
            _ => {
                let help = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
                self.unexpected("a value", help)
            }
        }
    }

    /// Behind a complete value stands what neither continues nor ends it.
    pub(super) fn stray(&mut self) -> Refused {
        let (here, found) = (self.next(), self.found());
        let (message, help) = match self.sign() {
            Some("=" | "+=" | "-=" | "*=" | "/=") => {
                (format!("{found} cannot stand behind a value"), "end the statement before with `;`")
            }
            Some(sign @ ("&" | "|" | "=>")) => no_condition(sign),
            Some(",") => match self.decimal_comma(&here) {
                Some(number) => {
                    return self.refuse(
                        Code::NumberForm,
                        here,
                        "a decimal point is a `.`",
                        format!("write `{number}`"),
                    );
                }
                None => (format!("{found} cannot stand here"), "write a vector as `[x, y, z]`"),
            },
            Some(";") => (format!("{found} cannot stand within brackets"), "write `,` between values"),
            Some(".." | "..=") => ("a range stands behind `in` only".to_string(), "write `for i in 0..6 { … }`"),
            Some(":") => {
                let help = "a number has its unit right behind it: `2 m`";
                ("`:` and a unit belong to declarations".to_string(), help)
            }
            Some(_) => (format!("{found} is not an operator"), "the operators are `+`, `-`, `*`, `/` and `^`"),
            None if self.opens('{') => (format!("{found} cannot stand behind a value"), "end the statement with `;`"),
            None => return self.no_operator(here, &found),
        };
        self.refuse(Code::Unexpected, here, message, help)
    }

    /// Two values stand side by side.
    fn no_operator(&mut self, here: Span, found: &str) -> Refused {
        let before = self.source[..here.start].trim_end();
        let word = before.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default();
        if Function::ALL.iter().any(|f| f.name() == word) || ["sqrt", "dt"].contains(&word) {
            let message = format!("the argument of `{word}` stands in brackets");
            return self.refuse(
                Code::MissingOperator,
                here,
                message,
                format!("write `{word}({})`", found.trim_matches('`')),
            );
        }
        let help = match is_within_brackets(before) {
            true => "write `*` for a product, `,` between two values".to_string(),
            false if word.starts_with(|c: char| c.is_ascii_digit()) => {
                format!("write `*` for a product; {found} is not a unit")
            }
            false => "write `*` for a product".to_string(),
        };
        self.refuse(Code::MissingOperator, here, format!("an operator is missing before {found}"), help)
    }

    /// `1.5`, where `here` is the comma of `1,5`.
    fn decimal_comma(&self, here: &Span) -> Option<String> {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let (before, after) = (&self.source[..here.start], &self.source[here.end..]);
        let whole = before.len() - before.bytes().rev().take_while(u8::is_ascii_digit).count();
        let (whole, fraction) = (&before[whole..], &after[..digits(after)]);
        (!whole.is_empty() && !fraction.is_empty()).then(|| format!("{whole}.{fraction}"))
    }
}

/// Whether a parenthesis or bracket of the last statement is open at the end of the text.
fn is_within_brackets(text: &str) -> bool {
    let mut closed = 0;
    for c in text.chars().rev() {
        match c {
            ')' | ']' => closed += 1,
            '(' | '[' if closed == 0 => return true,
            '(' | '[' => closed -= 1,
            ';' | '{' | '}' => return false,
            _ => {}
        }
    }
    false
}
