//! Statements that begin with a word that may be a name, too: `gravity = …;` gives a `let mut` a new value.

use proc_macro2::Delimiter;
use syn::buffer::Cursor;
use syn::parse::ParseStream;

use super::keyword::CONTEXTUAL;
use super::reader::{Parsed, Reader, opens, sign, word};
use super::syntax::{Statement, StatementKind};

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

impl Reader<'_> {
    /// `part := "part" name "(" names ")" "{" statement* "}"`
    pub(super) fn part(&mut self, input: ParseStream<'_>) -> Parsed<Statement> {
        let first = self.next(input).start;
        self.eat_word(input, "part");
        let name = self.declared_name(input, "part")?;
        if CONTEXTUAL.contains(&name.text.as_str()) {
            let message = format!("`{}` cannot name a part: it begins a statement of its own", name.text);
            return Err(self.refuse(name.span, message, "choose another name"));
        }
        let form = format!("write `part {}(x, y) {{ … }}`", name.text);
        let parameters = self.names_in_brackets(input, "part", &form)?;
        if !opens(input, Delimiter::Brace) {
            return Err(self.unexpected(input, "a `{`", &form));
        }
        let group = self.group(input)?;
        let body = self.statements(&group.content);
        self.close(group);
        Ok(Statement { kind: StatementKind::Part { name, parameters, body }, span: first..self.last })
    }

    /// `instance := name name ("[" expression "]")? "(" arguments ")"`
    pub(super) fn instance(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let part = self.name(input, "this")?;
        let name = self.declared_name(input, &part.text)?;
        let index = self.index(input)?;
        let arguments = self.arguments(input)?;
        Ok(StatementKind::Instance { part, name, index, arguments })
    }
}

/// Whether a word, a name and arguments in brackets come next, as in `part link(m)`.
pub(super) fn begins_call(input: ParseStream<'_>) -> bool {
    let name = word(input.cursor()).and_then(|(_, behind)| word(behind));
    name.is_some_and(|(_, behind)| behind.group(Delimiter::Parenthesis).is_some())
}

/// Whether a part is used next, as in `link arm[i](m)`.
pub(super) fn begins_instance(input: ParseStream<'_>) -> bool {
    let Some((_, mut behind)) = word(input.cursor()).and_then(|(_, behind)| word(behind)) else { return false };
    if let Some(rest) = behind_brackets(behind) {
        behind = rest;
    }
    let Some((_, _, end)) = behind.group(Delimiter::Parenthesis) else { return false };
    end.group(Delimiter::Brace).is_none() && sign(end).is_none_or(|(sign, _)| sign == ";")
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

    #[test]
    fn parts_are_declared_and_used() {
        let StatementKind::Part { name, parameters, body } =
            statement("part link(m, pose) { kinetic += m; let a = m; }")
        else {
            panic!()
        };
        assert_eq!((name.text.as_str(), parameters.len(), body.len()), ("link", 2, 2));
        let StatementKind::Instance { part, name, index, arguments } = statement("link arm[i + 1](m, world * p);")
        else {
            panic!()
        };
        assert_eq!((part.text.as_str(), name.text.as_str()), ("link", "arm"));
        assert_eq!((index.as_ref().map(prefix), arguments.len()), (Some("(+ i 1)".to_string()), 2));
        // A function of the mechanism's own gives the acceleration.
        assert!(matches!(statement("gravity down(g);"), StatementKind::Gravity { .. }));
        refused(
            "part gravity(m) { let a = m; }",
            "gravity: `gravity` cannot name a part: it begins a statement of its own; choose another name",
        );
        assert!(matches!(statement("let part = part;"), StatementKind::Let { .. }));
        assert!(matches!(statement("part = part(x);"), StatementKind::Assign { .. }));
        refused("part link(m);", ";: expected a `{`, found `;`; write `part link(x, y) { … }`");
        refused("part link(m n) {}", "n: expected `,` or `)`, found `n`; write `part link(x, y) { … }`");
        refused("prt link(m) {}", "prt: `prt` begins no statement; did you mean `part`?");
        refused(
            "link for(m);",
            "for: `for` cannot be declared: it is a keyword of the language; choose another name, such as `for_`",
        );
    }
}
