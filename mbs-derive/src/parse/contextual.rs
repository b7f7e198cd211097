//! Statements that begin with a word that may be a name, too: `gravity = …;` gives a `let mut` a new value.

use proc_macro2::Delimiter;
use syn::buffer::Cursor;
use syn::parse::ParseStream;

use super::reader::{Parsed, Reader, sign, word};
use super::syntax::StatementKind;

impl Reader<'_> {
    /// `gravity := "gravity" expression`
    pub(super) fn gravity(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        self.eat_word(input, "gravity");
        if self.peek(input, "+=") {
            let help = "write `gravity [0, 0, -g];`: it acts on all bodies, so there is one";
            return Err(self.refuse(self.next(input), "gravity is declared once, not added to", help));
        }
        Ok(StatementKind::Gravity { acceleration: self.expression(input)? })
    }
}

/// Whether the name that comes next, or an element of it, is given a value.
pub(super) fn is_assignment(input: ParseStream<'_>) -> bool {
    let Some((_, mut behind)) = word(input.cursor()) else { return false };
    while let Some(rest) = behind_brackets(behind) {
        behind = rest;
    }
    sign(behind).is_some_and(|(sign, _)| sign == "=")
}

fn behind_brackets(cursor: Cursor<'_>) -> Option<Cursor<'_>> {
    cursor.group(Delimiter::Bracket).map(|(_, _, rest)| rest)
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, statement};
    use super::*;

    #[test]
    fn gravity_is_a_statement_and_a_name() {
        let StatementKind::Gravity { acceleration } = statement("gravity [0, 0, -g];") else { panic!() };
        assert_eq!(prefix(&acceleration), "[0 0 (neg g)]");
        assert!(matches!(statement("gravity tilted * down;"), StatementKind::Gravity { .. }));
        assert!(matches!(statement("gravity = 2;"), StatementKind::Assign { name, .. } if name.text == "gravity"));
        assert!(matches!(statement("let mut gravity = gravity;"), StatementKind::Let { .. }));
        refused(
            "gravity += [0, 0, -g];",
            "+=: gravity is declared once, not added to; write `gravity [0, 0, -g];`: it acts on all bodies, so there is one",
        );
        refused("gravty [0, 0, -g];", "gravty: `gravty` begins no statement; did you mean `gravity`?");
    }
}
