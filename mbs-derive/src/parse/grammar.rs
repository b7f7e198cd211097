//! The grammar: one function a construct, its rule above it.
//!
//! ```text
//! file        := (inner | doc | import)* "mechanism" name "{" statement* "}"
//! inner       := "#![dimensionless]"
//! statement   := doc* (param | coord | input | prescribed | const | fn | let | assignment | energy | force | force_at
//!                | torque | gravity | reaction | constraint | output | shape | instance) ";" | doc* (for
//!                | choice | part)
//! ```
//!
//! A function that cannot go on notes why in `errors` and answers [`Refused`]; [`Reader::statements`] goes on with the
//! next statement. Places leave this file as byte ranges only.

use super::import::Shared;
use super::keyword::{CONTEXTUAL, STATEMENTS};
use super::lexer;
use super::quantity::{CONST, INPUT, PARAM, PRESCRIBED};
use super::reader::{Parsed, Reader, Refused, is_of_file};
use super::syntax::{Declaration, EnergyTerm, Import, Quantity, Span, Statement, StatementKind};
use crate::diagnostic::{Code, Diagnostics, nearest};

/// One file, read by itself.
pub(super) struct File<T> {
    /// What it imports.
    pub(super) imports: Vec<Import>,
    /// What it holds, as far as that could be read; nothing only where there are errors.
    pub(super) content: Option<T>,
    /// How many names, numbers and signs it has.
    pub(super) tokens: usize,
    pub(super) errors: Diagnostics,
}

/// Reads the file of a mechanism.
pub(super) fn mechanism(source: &str) -> File<Declaration> {
    file(source, Reader::file)
}

/// Reads a file that is imported.
pub(super) fn shared(source: &str) -> File<Shared> {
    file(source, Reader::shared)
}

/// Reads `name: unit = value`, a constant without its first word.
pub(super) fn quantity(source: &str) -> File<Quantity> {
    file(source, |reader| {
        let quantity = reader.quantity(Vec::new(), &CONST)?;
        match reader.is_at_end() {
            true => Ok(quantity),
            false => Err(reader.unexpected("the end", "write a name and its unit, `stretch [mm]`")),
        }
    })
}

/// The answer to a question about the tokens of a file; none where it cannot be cut into tokens.
pub(super) fn asked<'s, T>(source: &'s str, question: fn(&Reader<'s>) -> T) -> Option<T> {
    file(source, |reader| Ok(question(reader))).content
}

fn file<'s, T>(source: &'s str, read: impl Fn(&mut Reader<'s>) -> Parsed<T>) -> File<T> {
    let tokens = match lexer::tokens(source) {
        Ok(tokens) => tokens,
        Err(errors) => return File { imports: Vec::new(), content: None, tokens: 0, errors },
    };
    let (count, mut reader) = (tokens.len(), Reader::new(source, tokens));
    let content = read(&mut reader).ok();
    File { imports: reader.imports, content, tokens: count, errors: reader.errors }
}

// ---- file

/// What stands at the top of a file, imports aside.
pub(super) struct Head {
    /// Where `#![dimensionless]` stands.
    pub(super) dimensionless: Option<Span>,
    docs: Vec<String>,
    /// The first of the comments `///` that it ends with: those of a statement, where one follows.
    pub(super) of_statement: usize,
}

impl Reader<'_> {
    fn file(&mut self) -> Parsed<Declaration> {
        let Head { dimensionless, docs, .. } = self.head();
        self.mechanism_keyword()?;
        let name = self.declared_name("mechanism");
        if name.is_ok() && !self.opens('{') {
            let help = "a mechanism's statements stand between braces: `mechanism Name { … }`";
            self.unexpected("a `{`", help);
        }
        while !self.is_at_end() && !self.opens('{') {
            self.skip();
        }
        if self.is_at_end() {
            return Err(Refused);
        }
        self.open()?;
        let statements = self.statements();
        self.close();
        self.end_of_file();
        let (dimensionless, imports, imported) = (dimensionless.is_some(), Vec::new(), Vec::new());
        let (name, warnings) = (name?, Diagnostics::default());
        Ok(Declaration { dimensionless, imports, imported, name, docs, statements, of_robots: 0, warnings })
    }

    /// Documentation, `#![…]` and imports, in any order.
    pub(super) fn head(&mut self) -> Head {
        let mut head = Head { dimensionless: None, docs: Vec::new(), of_statement: self.at };
        loop {
            let start = self.next().start;
            if self.word().is_some_and(|text| text == "import") {
                if self.import().is_err() {
                    self.behind_import();
                }
            } else if !self.peek("#") {
                return head;
            } else if let Some((span, lines)) = self.doc() {
                head.docs.extend(lines);
                if !is_of_file(&self.source[span]) {
                    continue;
                }
            } else if self.inner_attribute().is_ok() {
                head.dimensionless = Some(start..self.last);
            }
            head.of_statement = self.at;
        }
    }

    fn mechanism_keyword(&mut self) -> Parsed<()> {
        if self.eat_word("mechanism") {
            return Ok(());
        }
        let (span, form) = (self.next(), "write `mechanism Name { … }`");
        match self.word() {
            None if self.is_at_end() => {
                Err(self.refuse(Code::NoMechanism, span, "this file declares no mechanism", form))
            }
            Some(text) if STATEMENTS.contains(&text) => {
                let message = format!("`{text}` stands outside a mechanism");
                let help = match text {
                    "const" | "fn" => {
                        "move it between the braces of `mechanism Name { … }`, or write `import` with this file's name \
                         in the file of a mechanism"
                    }
                    _ => "move it between the braces of `mechanism Name { … }`",
                };
                Err(self.refuse(Code::OutsideTheMechanism, span, message, help))
            }
            _ => Err(self.unexpected("`mechanism`", form)),
        }
    }

    fn end_of_file(&mut self) {
        let start = self.next();
        let documents = std::iter::from_fn(|| self.doc()).count() > 0;
        let (span, message, help) = match self.word() {
            None if self.is_at_end() && !documents => return,
            None if self.is_at_end() => (start, "this documents nothing", "move it before what it documents"),
            Some("mechanism") => {
                (self.next(), "a file declares one mechanism, this is the second", "write it in a file of its own")
            }
            Some("import") => {
                let here = self.next();
                self.late_import(here);
                return while !self.is_at_end() && !self.skip() {};
            }
            _ => {
                let help = "move it between the mechanism's braces, or into a comment";
                (self.next(), "text stands after the mechanism", help)
            }
        };
        self.errors.error(Code::OutsideTheMechanism, span, message).help(help);
        while !self.is_at_end() {
            self.skip();
        }
    }
}

// ---- statements

impl Reader<'_> {
    /// Every statement that can be read; of the others, why not.
    pub(super) fn statements(&mut self) -> Vec<Statement> {
        let (mut statements, depth, groups) = (Vec::new(), self.depth, self.groups.len());
        while !self.is_at_end() {
            let start = self.at;
            match self.statement() {
                Ok(statement) => statements.extend(statement),
                Err(Refused) => {
                    self.leave(groups);
                    self.recover(start);
                }
            }
            self.depth = depth;
        }
        statements
    }

    /// Goes to where the next statement probably begins: behind `;` or braces, or at a keyword that begins a line.
    fn recover(&mut self, start: usize) {
        while !self.is_at_end() {
            let keyword = self.word().is_some_and(|text| STATEMENTS.contains(&text));
            if keyword && self.at != start && self.begins_line() {
                return;
            }
            if self.skip() {
                // Braces that a value began with, as in `let x = { … };`, or that a branch of it ends with.
                let otherwise = self.word().is_some_and(|text| text == "else");
                let goes_on = self.sign().is_some_and(|sign| sign != "#") && !self.begins_line();
                if self.eat(";").is_some() || !otherwise && !goes_on {
                    return;
                }
            }
        }
    }

    /// Nothing where only documentation is left.
    fn statement(&mut self) -> Parsed<Option<Statement>> {
        let docs = self.docs()?;
        let here = self.next();
        match self.word() {
            None if self.is_at_end() => Ok(None),
            None => Err(self.no_statement()),
            Some("for") => self.for_loop().map(Some),
            Some("if") => self.choice().map(Some),
            Some("part") if self.begins_call() => self.part().map(Some),
            Some(text) => self.plain_statement(text, docs, here).map(Some),
        }
    }

    /// A statement without statements inside; it begins with the word `text`.
    fn plain_statement(&mut self, text: &str, docs: Vec<String>, here: Span) -> Parsed<Statement> {
        let start = here.start;
        let kind = match text {
            "param" => StatementKind::Param(self.quantity(docs, &PARAM)?),
            "coord" => self.coordinate(docs)?,
            "input" => StatementKind::Input(self.quantity(docs, &INPUT)?),
            "prescribed" => StatementKind::Prescribed(self.quantity(docs, &PRESCRIBED)?),
            "const" => StatementKind::Const(self.quantity(docs, &CONST)?),
            "fn" => self.function()?,
            "let" => self.binding()?,
            "kinetic" => self.energy(EnergyTerm::Kinetic)?,
            "potential" => self.energy(EnergyTerm::Potential)?,
            "dissipation" => self.energy(EnergyTerm::Dissipation)?,
            "lagrangian" => self.energy(EnergyTerm::Lagrangian)?,
            "force" => self.force()?,
            "torque" => self.torque()?,
            "reaction" => self.reaction(docs)?,
            "constraint" => self.constraint(docs)?,
            "output" => self.output(docs)?,
            "gravity" if !self.is_assignment() => self.gravity()?,
            "shape" if !self.is_assignment() => self.shape()?,
            "else" => {
                return Err(self.refuse(
                    Code::ConditionForm,
                    here,
                    "an `else` without its `if`",
                    "write `if n == 1 { … } else { … }`",
                ));
            }
            "import" => return Err(self.late_import(here)),
            _ if !CONTEXTUAL.contains(&text) && self.begins_instance() => self.instance()?,
            _ => self.assignment()?,
        };
        self.semicolon()?;
        Ok(Statement { kind, span: start..self.last })
    }

    /// A statement whose semicolon is missing is complete all the same: nothing is skipped.
    fn semicolon(&mut self) -> Parsed<()> {
        let keyword = self.word().is_some_and(|text| STATEMENTS.contains(&text));
        if self.eat(";").is_some() {
            Ok(())
        } else if self.is_at_end() || keyword || self.begins_line() {
            self.errors
                .error(Code::MissingSemicolon, self.last..self.last, "a `;` is missing")
                .help("end the statement with `;`");
            Ok(())
        } else {
            Err(self.stray())
        }
    }

    pub(super) fn no_statement(&mut self) -> Refused {
        let span = self.next();
        let forms = "a statement begins with `param`, `coord`, `input`, `prescribed`, `const`, `fn`, `let`, `kinetic`, \
                     `potential`, `dissipation`, `lagrangian`, `force`, `torque`, `gravity`, `reaction`, `constraint`, \
                     `output`, `shape`, `part`, `for` or `if`, or is an assignment `x = …;`";
        match self.word() {
            Some("mechanism") => self.refuse(
                Code::OutsideTheMechanism,
                span,
                "a mechanism stands within a mechanism",
                "write it in a file of its own",
            ),
            Some(text) => {
                let help = match nearest(text, STATEMENTS.into_iter().chain(CONTEXTUAL)) {
                    Some(keyword) => format!("did you mean `{keyword}`?"),
                    None => forms.to_string(),
                };
                self.refuse(Code::UnknownStatement, span, format!("`{text}` begins no statement"), help)
            }
            None if self.peek(";") => {
                self.refuse(Code::MissingSemicolon, span, "this `;` ends nothing", "leave it out")
            }
            None => self.unexpected("a statement", forms),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{refused, report};
    use super::super::declaration;
    use super::super::syntax::ExpressionKind;
    use super::*;

    #[test]
    fn reads_a_whole_mechanism() {
        let source = "\
//! About the file.
#![dimensionless]
/// A pendulum hinged on a cart.
///
/** It slides on
 *  a straight rail. */
mechanism CartPole {
    /// Mass of the cart, q̇ and θ.
    param m_cart: kg = 1.0;
    let mut bob = [x + length*sin(theta), 0, -length*cos(theta)]; // not documentation
    for i in 0..6 { bob = bob; }
    /// The tip.
    output tip = bob;
    // trailing
    /// nothing left
}
";
        let declaration = declaration(source).unwrap();
        assert!(declaration.dimensionless);
        assert_eq!(declaration.name.text, "CartPole");
        assert_eq!(source[declaration.name.span.clone()], *"CartPole");
        let docs = ["About the file.", "A pendulum hinged on a cart.", "", "It slides on", " a straight rail."];
        assert_eq!(declaration.docs, docs);
        let texts: Vec<&str> = declaration.statements.iter().map(|s| &source[s.span.clone()]).collect();
        let expected = [
            "param m_cart: kg = 1.0;",
            "let mut bob = [x + length*sin(theta), 0, -length*cos(theta)];",
            "for i in 0..6 { bob = bob; }",
            "output tip = bob;",
        ];
        assert_eq!(texts, expected);
        match &declaration.statements[0].kind {
            StatementKind::Param(quantity) => assert_eq!(quantity.docs, ["Mass of the cart, q̇ and θ."]),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn every_part_keeps_its_place() {
        // Greek letters in a comment: offsets are bytes, not characters.
        let source = "mechanism A { /* θω */ force q[i] += -(a + b) * f(c).d; coord x: kg /*θ*/ * m; }";
        for _ in 0..2 {
            // A second file in one process begins at offset 0 again.
            let declaration = declaration(source).unwrap();
            let StatementKind::Force { coordinate, index, value } = &declaration.statements[0].kind else { panic!() };
            let text = |span: &Span| &source[span.clone()];
            assert_eq!(text(&coordinate.span), "q");
            assert_eq!(text(&index.as_ref().unwrap().span), "i");
            assert_eq!(text(&value.span), "-(a + b) * f(c).d");
            let ExpressionKind::Binary(_, left, right) = &value.kind else { panic!() };
            assert_eq!((text(&left.span), text(&right.span)), ("-(a + b)", "f(c).d"));
            let ExpressionKind::Negate(sum) = &left.kind else { panic!() };
            assert_eq!(text(&sum.span), "(a + b)");
            let ExpressionKind::Field(call, d) = &right.kind else { panic!() };
            assert_eq!((text(&call.span), text(&d.span)), ("f(c)", "d"));
            let StatementKind::Coord(x) = &declaration.statements[1].kind else { panic!() };
            assert_eq!(text(&x.unit.as_ref().unwrap().span), "kg /*θ*/ * m");
        }
        let with_mark = declaration("\u{feff}mechanism A {}").unwrap();
        assert_eq!(with_mark.name.span, 13..14);
        assert_eq!(declaration("mechanism A {\r\n}\r\n").unwrap().name.span, 10..11);
    }

    #[test]
    fn files_have_one_mechanism() {
        let check = |source: &str, expected: &str| assert_eq!(report(source), [expected], "{source}");
        check("", ": this file declares no mechanism; write `mechanism Name { … }`");
        check("// nothing\n", ": this file declares no mechanism; write `mechanism Name { … }`");
        check("/// doc", ": this file declares no mechanism; write `mechanism Name { … }`");
        check("mechanisn A {}", "mechanisn: expected `mechanism`, found `mechanisn`; write `mechanism Name { … }`");
        check("{}", "{: expected `mechanism`, found `{`; write `mechanism Name { … }`");
        check(
            "param m: kg = 1; mechanism A {}",
            "param: `param` stands outside a mechanism; move it between the braces of `mechanism Name { … }`",
        );
        check(
            "const n = 1;",
            "const: `const` stands outside a mechanism; move it between the braces of `mechanism Name { … }`, or write \
             `import` with this file's name in the file of a mechanism",
        );
        check(
            "mechanism A {} /// doc\nmechanism B {}",
            "mechanism: a file declares one mechanism, this is the second; write it in a file of its own",
        );
        check(
            "mechanism A {} x",
            "x: text stands after the mechanism; move it between the mechanism's braces, or into a comment",
        );
        check("mechanism A {} /// x", "/// x: this documents nothing; move it before what it documents");
        check("mechanism {}", "{: expected a name after `mechanism`, found `{`; a name begins with a letter");
        check("mechanism 3D {}", "3D: expected a name after `mechanism`, found `3D`; a name begins with a letter");
        check(
            "mechanism",
            ": expected a name after `mechanism`, found the end of the file; a name begins with a letter",
        );
        check(
            "mechanism A",
            ": expected a `{`, found the end of the file; \
             a mechanism's statements stand between braces: `mechanism Name { … }`",
        );
        check(
            "mechanism A B {}",
            "B: expected a `{`, found `B`; a mechanism's statements stand between braces: `mechanism Name { … }`",
        );
        check(
            "#![no_std] mechanism A {}",
            "#![no_std]: this attribute is not known; the only one is `#![dimensionless]`",
        );
        check(
            "#[dimensionless] mechanism A {}",
            "#[dimensionless]: this attribute is about the whole file; write `#![dimensionless]`",
        );
        check("mechanism A { } }", "}: this `}` closes nothing; leave it out, or write what it is to close");
        check("mechanism A { x = 0b12; }", "0b12: `0b12` is not a decimal number; write it with digits 0 to 9");
    }

    #[test]
    fn semicolons_end_statements() {
        refused("let x = 1", ": a `;` is missing; end the statement with `;`");
        refused("let x = a\nlet y = b;", ": a `;` is missing; end the statement with `;`");
        refused("let x = a let y = b;", ": a `;` is missing; end the statement with `;`");
        refused("let x = a\ny = b;", ": a `;` is missing; end the statement with `;`");
        refused("coord x: m\ncoord y: m;", ": a `;` is missing; end the statement with `;`");
        refused("param x\n: m = 1\n", ": a `;` is missing; end the statement with `;`");
        let errors = declaration("mechanism A {\n  let x = a\n  let y = b;\n}").unwrap_err();
        assert_eq!(errors.iter().next().unwrap().span, 25..25);
    }

    #[test]
    fn all_errors_are_reported_in_source_order() {
        let source = "\
mechanism A {
    param length = 1.0;
    coord x: m;
    for i in 0..3 {
        kinetic = x;
        let y = 2 x;
        let z = a b
        parm m: kg = 1;
    }
    potential += (a + );
    output x = 1
}
extra
";
        let messages: Vec<String> = report(source).iter().map(|r| r.split(';').next().unwrap().to_string()).collect();
        let expected = [
            "param length: `param length` needs a unit",
            "=: `kinetic` is a sum that statements add to, `=` does not",
            "x: an operator is missing before `x`",
            "b: an operator is missing before `b`",
            "): expected a value, found `)`",
            ": a `",
            "extra: text stands after the mechanism",
        ];
        assert_eq!(messages, expected);
        // A statement without its semicolon does not swallow the next one's errors.
        let source = "mechanism A {\nparam l = 1\ncoord x;\n}";
        assert_eq!(report(source).len(), 2);
    }

    /// Xorshift: reproducible and good enough to mix tokens.
    struct Random(u64);

    impl Random {
        fn below(&mut self, n: usize) -> usize {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 % n as u64) as usize
        }
    }

    /// Neither panics nor answers without a reason, and what it says can be shown.
    fn survives(source: &str) {
        match declaration(source) {
            Ok(declaration) => assert!(declaration.name.span.end <= source.len()),
            Err(errors) => {
                assert!(errors.has_errors(), "{source:?}");
                for message in errors.iter() {
                    assert!(source.get(message.span.clone()).is_some(), "{source:?} {message:?}");
                    assert!(message.help.is_some() && !message.message.ends_with('.'), "{source:?} {message:?}");
                }
                assert!(errors.render("a.mbs", source).contains("error[MBS"));
            }
        }
    }

    #[test]
    fn any_text_is_answered() {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let pieces: Vec<&str> = concat!(
            "mechanism¦A¦{¦}¦(¦)¦[¦]¦param¦coord¦input¦const¦let¦mut¦for¦in¦kinetic¦force¦output¦fn¦if¦else¦",
            "prescribed¦constraint¦torque on¦force at¦&&¦||¦<=¦if a < b { x } else ¦x¦t¦r#x¦_¦=¦+=¦==¦+¦-¦*¦",
            "/¦^¦**¦.¦..¦..=¦,¦;¦:¦#¦!¦#![dimensionless]¦/// doc\n¦//! doc\n¦/** d */¦// c\n¦/*¦*/¦0¦1.¦1.5¦",
            "1e¦1e-5¦2m¦0x¦0b2¦r#\"¦\"¦'¦'a'¦'a¦b'¦\\¦θ¦²¦·¦q\u{307}¦\r¦\n¦\t¦\0¦\u{feff}¦🦀¦kg¦<¦&¦@¦if¦",
            "mechanism A {¦import¦import \"a.mbs\";¦let x = ¦param m: kg = 1;¦for i in 0..3 {¦",
            "coord q[3]: rad;¦u32¦e5¦$¦?¦~¦|¦%",
        )
        .split('¦')
        .collect();
        for round in 0..6000 {
            let mut source = String::from(if round % 2 == 0 { "mechanism A { " } else { "" });
            for _ in 0..random.below(24) {
                source += pieces[random.below(pieces.len())];
                source += [" ", "", "\n"][random.below(3)];
            }
            source += if round % 4 == 0 { " }" } else { "" };
            survives(&source);
        }
        for _ in 0..4000 {
            let bytes: Vec<u8> = (0..random.below(40)).map(|_| random.below(256) as u8).collect();
            survives(&String::from_utf8_lossy(&bytes));
            let ascii: String = (0..random.below(40)).map(|_| char::from(32 + random.below(95) as u8)).collect();
            survives(&ascii);
            survives(&format!("mechanism A {{ {ascii} }}"));
        }
    }

    #[test]
    fn any_cut_of_a_mechanism_is_answered() {
        let source = "//! f\n#![dimensionless]\n/// d\nmechanism A {\n param m[2]: kg*m^(1/2)/s = [1.5e-3, 2];\n coord q: rad; \
                      /* c */ for i in 0..2 { kinetic += -1/2*m[i]*dt(q)^2; } let v = [q, 0, 1].norm(); force q += v.x; }";
        for (i, _) in source.char_indices() {
            survives(&source[..i]);
            survives(&source[i..]);
            survives(&format!("{}{}", &source[..i], &source[i + 1..]));
        }
    }
}
