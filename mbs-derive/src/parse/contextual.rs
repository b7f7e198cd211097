//! Statements that begin with a word that may be a name, too: `gravity = …;` gives a `let mut` a new value.

use super::keyword::{CONTEXTUAL, SHAPES};
use super::reader::{Parsed, Reader};
use super::syntax::{Name, Statement, StatementKind};
use crate::diagnostic::{Code, nearest};

impl Reader<'_> {
    /// `gravity := "gravity" expression`
    pub(super) fn gravity(&mut self) -> Parsed<StatementKind> {
        self.eat_word("gravity");
        if self.peek("+=") {
            let help = "write `gravity [0, 0, -g];`: it acts on all bodies, so there is one";
            return Err(self.refuse(Code::WrongSign, self.next(), "gravity is declared once, not added to", help));
        }
        Ok(StatementKind::Gravity { acceleration: self.expression()? })
    }
}

impl Reader<'_> {
    /// `shape := "shape" expression "+=" name "(" path? ("," expression)* ")"`
    pub(super) fn shape(&mut self) -> Parsed<StatementKind> {
        const FORM: &str = "write `shape pose += box([x, y, z]);`, `cylinder(radius, length)`, `sphere(radius)` or \
                            `mesh(\"file.stl\")`";
        let start = self.next().start;
        self.eat_word("shape");
        if self.sign().is_some() {
            return Err(self.unexpected("a pose behind `shape`", FORM));
        }
        let pose = self.expression()?;
        self.adds(start)?;
        let Some(kind) = self.word() else { return Err(self.unexpected("a shape", FORM)) };
        let here = self.next();
        if !SHAPES.contains(&kind) {
            let help = nearest(kind, SHAPES).map_or(FORM.to_string(), |meant| format!("did you mean `{meant}`?"));
            return Err(self.refuse(Code::UnknownShape, here, format!("`{kind}` is no shape"), help));
        }
        let kind = Name { text: kind.to_string(), span: here };
        self.skip();
        if !self.opens('(') {
            return Err(self.unexpected("a `(`", FORM));
        }
        self.open()?;
        let file = self.path().map(str::to_string);
        if kind.text == "mesh" && file.is_none() {
            return Err(self.unexpected("the path of a file in quotation marks", FORM));
        }
        if file.is_some() && !self.is_at_end() && self.eat(",").is_none() {
            return Err(self.unexpected("`,` or `)`", FORM));
        }
        let mut sizes = Vec::new();
        while !self.is_at_end() {
            sizes.push(self.expression()?);
            if !self.is_at_end() && self.eat(",").is_none() {
                return Err(self.stray());
            }
        }
        self.close();
        Ok(StatementKind::Shape { pose, kind, file, sizes })
    }
}

impl Reader<'_> {
    /// `part := "part" name "(" names ")" "{" statement* "}"`
    pub(super) fn part(&mut self) -> Parsed<Statement> {
        let first = self.next().start;
        self.eat_word("part");
        let name = self.declared_name("part")?;
        if CONTEXTUAL.contains(&name.text.as_str()) {
            let message = format!("`{}` cannot name a part: it begins a statement of its own", name.text);
            return Err(self.refuse(Code::ReservedName, name.span, message, "choose another name"));
        }
        let form = format!("write `part {}(x, y) {{ … }}`", name.text);
        let parameters = self.names_in_brackets("part", &form)?;
        if !self.opens('{') {
            return Err(self.unexpected("a `{`", &form));
        }
        self.open()?;
        let body = self.statements();
        self.close();
        Ok(Statement { kind: StatementKind::Part { name, parameters, body }, span: first..self.last })
    }

    /// `instance := name name ("[" expression "]")? "(" arguments ")"`
    pub(super) fn instance(&mut self) -> Parsed<StatementKind> {
        let part = self.name("this")?;
        let name = self.declared_name(&part.text)?;
        let index = self.index()?;
        let arguments = self.arguments()?;
        Ok(StatementKind::Instance { part, name, index, arguments })
    }
}

// ---- what stands behind such a word

impl Reader<'_> {
    /// Whether a word, a name and arguments in brackets come next, as in `part link(m)`.
    pub(super) fn begins_call(&self) -> bool {
        self.word_at(self.at + 1).is_some() && self.opens_at(self.at + 2, '(')
    }

    /// Whether a part is used next, as in `link arm[i](m)`.
    pub(super) fn begins_instance(&self) -> bool {
        if self.word_at(self.at + 1).is_none() {
            return false;
        }
        let name = self.at + 2;
        let arguments = self.behind_group(name, '[').unwrap_or(name);
        let Some(end) = self.behind_group(arguments, '(') else { return false };
        !self.opens_at(end, '{') && self.sign_at(end).is_none_or(|sign| sign == ";")
    }

    /// Whether the name that comes next, or an element of it, is given a value.
    pub(super) fn is_assignment(&self) -> bool {
        self.sign_at(self.behind_indices(self.at + 1)) == Some("=")
    }

    /// What stands behind `[i][j]`, which may begin at token `at`.
    pub(super) fn behind_indices(&self, mut at: usize) -> usize {
        while let Some(behind) = self.behind_group(at, '[') {
            at = behind;
        }
        at
    }
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
    fn shapes_are_statements_and_names() {
        let StatementKind::Shape { pose, kind, file, sizes } = statement("shape link*tilt += cylinder(r, 2*l);") else {
            panic!()
        };
        let sizes: Vec<_> = sizes.iter().map(prefix).collect();
        assert_eq!((prefix(&pose).as_str(), kind.text.as_str(), file), ("(* link tilt)", "cylinder", None));
        assert_eq!(sizes, ["r", "(* 2 l)"]);
        let StatementKind::Shape { file, sizes, .. } = statement("shape a[1] += mesh( \"b/c d.stl\" , 1e-3,);") else {
            panic!()
        };
        assert_eq!((file.as_deref(), sizes.len()), (Some("b/c d.stl"), 1));
        assert!(matches!(statement("let shape = 1;"), StatementKind::Let { .. }));
        assert!(matches!(statement("shape[1] = 2;"), StatementKind::Assign { .. }));
        assert!(matches!(statement("let mesh = mesh(1);"), StatementKind::Let { .. }));
        let form = "write `shape pose += box([x, y, z]);`, `cylinder(radius, length)`, `sphere(radius)` or \
                    `mesh(\"file.stl\")`";
        refused("shape link += cone(1);", &format!("cone: `cone` is no shape; {form}"));
        refused("shape link += spere(1);", "spere: `spere` is no shape; did you mean `sphere`?");
        refused("shape link += 3;", &format!("3: expected a shape, found `3`; {form}"));
        refused("shape link += box;", &format!(";: expected a `(`, found `;`; {form}"));
        refused("shape += box(1);", &format!("+=: expected a pose behind `shape`, found `+=`; {form}"));
        refused(
            "shape link = box(1);",
            "=: `shape link` is a sum that statements add to, `=` does not; write `shape link += …;`",
        );
        let path = "expected the path of a file in quotation marks, found";
        refused("shape link += mesh(link);", &format!("link: {path} `link`; {form}"));
        refused("shape link += mesh(\"a.stl\" 2);", &format!("2: expected `,` or `)`, found `2`; {form}"));
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
