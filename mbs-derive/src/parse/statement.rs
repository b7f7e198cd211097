//! What each statement says: one function a construct, its rule above it.

use super::quantity::COORD;
use super::reader::{Parsed, Reader, Refused};
use super::syntax::{Comparison, EnergyTerm, Expression, ExpressionKind, Name, Span, Statement, StatementKind};
use crate::diagnostic::{Code, nearest};

impl Reader<'_> {
    /// `coord := quantity`, of any name but `at`.
    pub(super) fn coordinate(&mut self, docs: Vec<String>) -> Parsed<StatementKind> {
        let quantity = self.quantity(docs, &COORD)?;
        if quantity.name.text == "at" {
            let help = "choose another name: `force at …` is a force on a point";
            return Err(self.refuse(
                Code::ReservedName,
                quantity.name.span,
                "a coordinate cannot be called `at`",
                help,
            ));
        }
        Ok(StatementKind::Coord(quantity))
    }

    /// `fn := "fn" name "(" (name ("," name)* ","?)? ")" "=" expression`
    pub(super) fn function(&mut self) -> Parsed<StatementKind> {
        self.eat_word("fn");
        let name = self.declared_name("fn")?;
        let form = format!("write `fn {}(x, y) = …;`", name.text);
        if !self.opens('(') {
            return Err(self.unexpected("a `(`", &form));
        }
        let parameters = self.names_in_brackets("fn", &form)?;
        if self.opens('{') {
            return Err(self.refuse(Code::FunctionForm, self.next(), "a function is one formula", form));
        }
        self.equals(&form)?;
        Ok(StatementKind::Function { name, parameters, body: self.expression()? })
    }

    /// `"(" (name ("," name)* ","?)? ")"`
    pub(super) fn names_in_brackets(&mut self, keyword: &str, form: &str) -> Parsed<Vec<Name>> {
        self.open()?;
        let mut names = Vec::new();
        while !self.is_at_end() {
            names.push(self.declared_name(keyword)?);
            if !self.is_at_end() && self.eat(",").is_none() {
                return Err(self.unexpected("`,` or `)`", form));
            }
        }
        self.close();
        Ok(names)
    }

    /// `binding := "let" "mut"? name "=" expression`, `elements := "let" "mut"? name ("[" expression "]")+`
    pub(super) fn binding(&mut self) -> Parsed<StatementKind> {
        self.eat_word("let");
        let mutable = self.eat_word("mut");
        let name = self.declared_name(if mutable { "mut" } else { "let" })?;
        if let Some(colon) = self.eat(":") {
            let help = format!("write `let {} = …;`: the unit follows from the value", name.text);
            return Err(self.refuse(Code::LetForm, colon, "a `let` declares no unit", help));
        }
        let lengths = self.indices()?;
        if !lengths.is_empty() {
            return match self.peek("=") {
                true => Err(self.no_length(&name.text)),
                false => Ok(StatementKind::Elements { mutable, name, lengths }),
            };
        }
        self.equals(&format!("write `let {} = …;`", name.text))?;
        Ok(StatementKind::Let { mutable, name, value: self.expression()? })
    }

    fn no_length(&mut self, name: &str) -> Refused {
        let help =
            format!("write `let {name} = …;`, or `let {name}[n];` and give each element its value: `{name}[i] = …;`");
        self.refuse(Code::LetForm, self.next(), "a `let` with a value has the length of the value", help)
    }

    /// `assignment := name ("[" expression "]")* "=" expression`
    pub(super) fn assignment(&mut self) -> Parsed<StatementKind> {
        let Some(text) = self.word() else { return Err(self.no_statement()) };
        let behind = self.behind_indices(self.at + 1);
        match self.sign_at(behind) {
            Some("=") => {
                let name = self.name("this")?;
                let indices = self.indices()?;
                self.equals("write `x = …;`")?;
                Ok(StatementKind::Assign { name, indices, value: self.expression()? })
            }
            Some(sign @ ("+=" | "-=" | "*=" | "/=")) => {
                let help = match nearest(text, ["kinetic", "potential", "dissipation", "lagrangian"]) {
                    Some(energy) => format!("did you mean `{energy}`?"),
                    None => {
                        let target = self.source[self.next().start..self.tokens[behind].span().start].trim_end();
                        format!("write `{target} = {target} {} …;`", &sign[..1])
                    }
                };
                let message = format!("`{text}` is not an energy, `{sign}` cannot change it");
                Err(self.refuse(Code::WrongSign, self.next(), message, help))
            }
            _ => Err(self.no_statement()),
        }
    }

    /// `energy := ("kinetic" | "potential" | "dissipation" | "lagrangian") "+=" expression`
    pub(super) fn energy(&mut self, term: EnergyTerm) -> Parsed<StatementKind> {
        let start = self.next().start;
        self.skip();
        self.adds(start)?;
        Ok(StatementKind::Energy { term, value: self.expression()? })
    }

    /// `force := "force" name ("[" expression "]")? "+=" expression`,
    /// `force_at := "force" "at" expression "+=" expression`
    pub(super) fn force(&mut self) -> Parsed<StatementKind> {
        let start = self.next().start;
        self.eat_word("force");
        if self.eat_word("at") {
            let point = self.expression()?;
            self.adds(start)?;
            return Ok(StatementKind::ForceAt { point, value: self.expression()? });
        }
        let coordinate = self.name("`force`")?;
        let index = self.index()?;
        if self.word().is_some_and(|text| text == "at") {
            let help = "the point comes first: `force at point += F;`";
            return Err(self.refuse(Code::ForceForm, self.next(), "a force at a point begins with `force at`", help));
        }
        if let Some(meant) = self.word().filter(|_| coordinate.text == "on") {
            let help = format!("write `force {meant} += …;`, or for a body `torque on pose += [x, y, z];`");
            return Err(self.unexpected("`+=`", &help));
        }
        self.adds(start)?;
        Ok(StatementKind::Force { coordinate, index, value: self.expression()? })
    }

    /// `torque := "torque" "on" expression "+=" expression`
    pub(super) fn torque(&mut self) -> Parsed<StatementKind> {
        let start = self.next().start;
        self.eat_word("torque");
        if !self.eat_word("on") {
            let help = "write `torque on pose += [x, y, z];`; on a coordinate it is `force theta += …;`";
            return Err(self.unexpected("`on`", help));
        }
        let pose = self.expression()?;
        self.adds(start)?;
        Ok(StatementKind::TorqueOn { pose, value: self.expression()? })
    }

    /// `reaction := "reaction" name ("[" expression "]")? "at" name ("[" expression "]")*`
    pub(super) fn reaction(&mut self, docs: Vec<String>) -> Parsed<StatementKind> {
        self.eat_word("reaction");
        let name = self.declared_name("reaction")?;
        let index = self.index()?;
        let form = format!("write `reaction {} at pose;`", name.text);
        if !self.eat_word("at") {
            return Err(self.unexpected("`at`", &form));
        }
        let here = self.next();
        let pose = self.expression()?;
        match pose.element_of() {
            Some((text, element)) => {
                let pose = Name { text: text.to_string(), span: here.start..here.start + text.len() };
                Ok(StatementKind::Reaction { docs, name, index, pose, element: element.into_iter().cloned().collect() })
            }
            None => {
                let help = "name the pose, and build on the name: `let joint = …; reaction name at joint;`";
                Err(self.refuse(
                    Code::ReactionOfAName,
                    pose.span.clone(),
                    "a reaction is that of a pose with a name",
                    help,
                ))
            }
        }
    }

    /// `constraint := "constraint" name ("[" expression "]")? ":" expression "=" expression`
    pub(super) fn constraint(&mut self, docs: Vec<String>) -> Parsed<StatementKind> {
        let form = "write `constraint name: left = right;`";
        self.eat_word("constraint");
        let name = self.declared_name("constraint")?;
        let index = self.index()?;
        if self.eat(":").is_none() {
            return Err(self.unexpected("`:`", form));
        }
        let left = self.expression()?;
        if let ExpressionKind::Compare(Comparison::Equal, a, b) = &left.kind {
            let signs = a.span.end..b.span.start;
            let start = signs.start + self.source[signs.clone()].find("==").unwrap_or_default();
            return Err(self.refuse(Code::WrongSign, start..start + 2, "an equation is written with `=`", form));
        }
        self.equals(form)?;
        Ok(StatementKind::Constraint { docs, name, index, left, right: self.expression()? })
    }

    /// The `+=` behind the sum that begins at `start`.
    pub(super) fn adds(&mut self, start: usize) -> Parsed<()> {
        let (target, here) = (&self.source[start..self.last], self.next());
        if self.eat("+=").is_some() {
            return Ok(());
        }
        let help = match self.sign() {
            Some("-=") if target == "kinetic" => {
                "kinetic energy is positive; the energy of springs and weights is `potential += …;`".to_string()
            }
            Some("-=") if target == "dissipation" => {
                "dissipation is positive and acts against the motion: write `dissipation += …;`".to_string()
            }
            Some("-=") => format!("write `{target} += -(…);`"),
            _ => format!("write `{target} += …;`"),
        };
        match self.sign() {
            Some(found @ ("=" | "-=" | "*=" | "/=" | "+")) => {
                let message = format!("`{target}` is a sum that statements add to, `{found}` does not");
                Err(self.refuse(Code::WrongSign, here, message, help))
            }
            _ => Err(self.unexpected("`+=`", &help)),
        }
    }

    /// `output := "output" name ("[" expression "]")? "=" expression ("," "jacobian_rate")?`
    pub(super) fn output(&mut self, docs: Vec<String>) -> Parsed<StatementKind> {
        self.eat_word("output");
        if self.word().is_none() {
            let help = "an output has a name and a value: write `output name = …;`";
            return Err(self.unexpected("a name after `output`", help));
        }
        let name = self.declared_name("output")?;
        let index = self.index()?;
        let help = format!("an output has a name and a value: write `output name = {};`", name.text);
        self.equals(if self.peek(";") { &help } else { "write `output name = …;`" })?;
        let value = self.expression()?;
        Ok(StatementKind::Output { docs, name, index, value, jacobian_rate: self.jacobian_rate()? })
    }

    /// `"," "jacobian_rate"`, if a comma comes next.
    fn jacobian_rate(&mut self) -> Parsed<Option<Span>> {
        if self.eat(",").is_none() {
            return Ok(None);
        }
        let here = self.next();
        if self.eat_word("jacobian_rate") {
            return Ok(Some(here));
        }
        let help = "a vector is written as `[x, y, z]`; `jacobian_rate` asks for the time derivative of the Jacobian";
        Err(self.unexpected("`jacobian_rate`", help))
    }

    /// `for := "for" name "in" expression ".." expression "{" statement* "}"`
    pub(super) fn for_loop(&mut self) -> Parsed<Statement> {
        let first = self.next().start;
        let (variable, start, end) = self.for_head()?;
        self.open()?;
        let body = self.statements();
        self.close();
        Ok(Statement { kind: StatementKind::For { variable, start, end, body }, span: first..self.last })
    }

    fn for_head(&mut self) -> Parsed<(Name, Expression, Expression)> {
        let form = "write `for i in 0..6 { … }`";
        self.eat_word("for");
        let variable = self.declared_name("for")?;
        if !self.eat_word("in") {
            return Err(self.unexpected("`in`", form));
        }
        let start = self.expression()?;
        if let Some(dots) = self.eat("..=") {
            return Err(self.refuse(
                Code::RangeForm,
                dots,
                "a range ends before its end",
                "write `0..n + 1` for the numbers 0 to n",
            ));
        }
        if self.eat("..").is_none() {
            return Err(self.unexpected("`..`", form));
        }
        let end = self.expression()?;
        match self.opens('{') {
            true => Ok((variable, start, end)),
            false => Err(self.unexpected("a `{`", form)),
        }
    }

    pub(super) fn equals(&mut self, help: &str) -> Parsed<()> {
        match self.eat("=") {
            Some(_) => Ok(()),
            None => Err(self.unexpected("`=`", help)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, report, statement};
    use super::super::syntax::*;

    #[test]
    fn reads_other_statements() {
        assert!(matches!(statement("let mut y = 1;"), StatementKind::Let { mutable: true, .. }));
        assert!(matches!(statement("y = 1;"), StatementKind::Assign { name, .. } if name.text == "y"));
        assert!(matches!(statement("y[i][2] = 1;"), StatementKind::Assign { indices, .. } if indices.len() == 2));
        let elements = |text| match statement(text) {
            StatementKind::Elements { mutable, lengths, .. } => (mutable, lengths.len()),
            other => panic!("{other:?}"),
        };
        assert_eq!((elements("let p[n];"), elements("let mut p[n][3];")), ((false, 1), (true, 2)));
        assert!(matches!(statement("output p[i] = 1;"), StatementKind::Output { index: Some(_), .. }));
        refused(
            "let p[3] = 1;",
            "=: a `let` with a value has the length of the value; write `let p = …;`, or `let p[n];` and give each element \
             its value: `p[i] = …;`",
        );
        refused("p[1] += 1;", "p: `p` is not an energy, `+=` cannot change it; write `p[1] = p[1] + …;`");
        let terms = [
            ("kinetic", EnergyTerm::Kinetic),
            ("potential", EnergyTerm::Potential),
            ("dissipation", EnergyTerm::Dissipation),
            ("lagrangian", EnergyTerm::Lagrangian),
        ];
        for (keyword, expected) in terms {
            let kind = statement(&format!("{keyword} += 1;"));
            assert!(matches!(kind, StatementKind::Energy { term, .. } if term == expected), "{keyword}");
        }
        assert!(matches!(statement("force x += -1;"), StatementKind::Force { index: None, .. }));
        let StatementKind::Force { coordinate, index, value } = statement("force q[i] += tau[i];") else { panic!() };
        assert_eq!((coordinate.text.as_str(), index.as_ref().map(prefix)), ("q", Some("i".to_string())));
        assert_eq!(prefix(&value), "tau[i]");
        let StatementKind::For { variable, start, end, body } =
            statement("for i in a+1..2*n { y = i; for j in 0 .. i {} }")
        else {
            panic!()
        };
        assert_eq!((variable.text.as_str(), prefix(&start), prefix(&end)), ("i", "(+ a 1)".into(), "(* 2 n)".into()));
        assert_eq!(body.len(), 2);
    }

    #[test]
    fn energies_are_added_to() {
        refused(
            "force on theta += tau;",
            "theta: expected `+=`, found `theta`; write `force theta += …;`, or for a body `torque on pose += [x, y, z];`",
        );
        refused("kinetic = x;", "=: `kinetic` is a sum that statements add to, `=` does not; write `kinetic += …;`");
        refused(
            "kinetic -= x;",
            "-=: `kinetic` is a sum that statements add to, `-=` does not; kinetic energy is positive; the energy of springs and weights is `potential += …;`",
        );
        refused(
            "force q[1] = x;",
            "=: `force q[1]` is a sum that statements add to, `=` does not; write `force q[1] += …;`",
        );
        refused("potential x;", "x: expected `+=`, found `x`; write `potential += …;`");
        refused("kinetc += x;", "kinetc: `kinetc` is not an energy, `+=` cannot change it; did you mean `kinetic`?");
        refused("y -= x;", "y: `y` is not an energy, `-=` cannot change it; write `y = y - …;`");
        refused(
            "force at = x;",
            "=: expected a value, found `=`; a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`",
        );
        refused(
            "force at p = x;",
            "=: `force at p` is a sum that statements add to, `=` does not; write `force at p += …;`",
        );
        refused(
            "force F at p += x;",
            "at: a force at a point begins with `force at`; the point comes first: `force at point += F;`",
        );
        refused(
            "torque q += x;",
            "q: expected `on`, found `q`; write `torque on pose += [x, y, z];`; on a coordinate it is `force theta += …;`",
        );
        refused(
            "torque on p -= x;",
            "-=: `torque on p` is a sum that statements add to, `-=` does not; write `torque on p += -(…);`",
        );
        refused(
            "coord at: m;",
            "at: a coordinate cannot be called `at`; choose another name: `force at …` is a force on a point",
        );
    }

    #[test]
    fn functions_are_formulas() {
        refused("fn f = x;", "=: expected a `(`, found `=`; write `fn f(x, y) = …;`");
        refused("fn f(x) { x }", "{: a function is one formula; write `fn f(x, y) = …;`");
        refused("fn f(x y) = x;", "y: expected `,` or `)`, found `y`; write `fn f(x, y) = …;`");
        refused("fn f(1) = x;", "1: expected a name after `fn`, found `1`; a name begins with a letter");
        refused("fn f(t) = t;", "t: `t` cannot be declared: it is the time; choose another name, such as `t_`");
        refused("fn f(x): m = x;", ":: expected `=`, found `:`; write `fn f(x, y) = …;`");
        refused(
            "fn torque(x) = x;",
            "torque: `torque` cannot be declared: it is a keyword of the language; choose another name, such as `torque_`",
        );
        let StatementKind::Function { name, parameters, body } = statement("fn f(x, y,) = x*y;") else { panic!() };
        let names: Vec<&str> = parameters.iter().map(|p| p.text.as_str()).collect();
        assert_eq!((name.text.as_str(), names, prefix(&body)), ("f", vec!["x", "y"], "(* x y)".to_string()));
    }

    #[test]
    fn prescribed_motions_and_constraints() {
        let StatementKind::Prescribed(heave) = statement("prescribed heave: m = a*sin(t);") else { panic!() };
        assert_eq!(heave.value.as_ref().map(prefix).as_deref(), Some("(* a sin(t))"));
        assert!(matches!(statement("prescribed s[2]: m;"), StatementKind::Prescribed(s) if s.value.is_none()));
        refused(
            "prescribed s;",
            "prescribed s: `prescribed s` needs a unit; write `prescribed s: m;`, `1` for a pure number",
        );
        let StatementKind::Constraint { name, left, right, .. } = statement("constraint rod: x^2 = l^2;") else {
            panic!()
        };
        assert_eq!((name.text.as_str(), prefix(&left), prefix(&right)), ("rod", "(^ x 2)".into(), "(^ l 2)".into()));
        refused("constraint x^2 = l^2;", "^: expected `:`, found `^`; write `constraint name: left = right;`");
        refused("constraint rod: x^2 - l^2;", ";: expected `=`, found `;`; write `constraint name: left = right;`");
        let equation = "==: an equation is written with `=`; write `constraint name: left = right;`";
        refused("constraint rod: x == l;", equation);
        refused("constraint rod: (x == l) = 0;", equation);
        assert!(matches!(statement("constraint rod[i]: x = l;"), StatementKind::Constraint { index: Some(_), .. }));
        assert!(matches!(statement("force at p + q += F;"), StatementKind::ForceAt { .. }));
        assert!(matches!(statement("torque on arm[2] += [0, 0, u];"), StatementKind::TorqueOn { .. }));
        let StatementKind::Reaction { name, index, pose, element, .. } =
            statement("reaction joint[i + 1] at link[i][0];")
        else {
            panic!()
        };
        assert_eq!((name.text.as_str(), pose.text.as_str()), ("joint", "link"));
        assert_eq!(index.as_ref().map(prefix), Some("(+ i 1)".to_string()));
        assert_eq!(element.iter().map(prefix).collect::<Vec<_>>(), ["i", "0"]);
    }

    #[test]
    fn statements_begin_with_known_words() {
        refused("parm m: kg = 1;", "parm: `parm` begins no statement; did you mean `param`?");
        refused("forse q += 1;", "forse: `forse` begins no statement; did you mean `force`?");
        refused("mechanism B {}", "mechanism: a mechanism stands within a mechanism; write it in a file of its own");
        refused(";", ";: this `;` ends nothing; leave it out");
        assert!(matches!(
            statement("output a = [x, y, z], jacobian_rate;"),
            StatementKind::Output { jacobian_rate: Some(_), .. }
        ));
        assert!(matches!(statement("output jacobian_rate = x;"), StatementKind::Output { jacobian_rate: None, .. }));
        let form = "a vector is written as `[x, y, z]`; `jacobian_rate` asks for the time derivative of the Jacobian";
        refused("output a = x, y, z;", &format!("y: expected `jacobian_rate`, found `y`; {form}"));
        refused("output a = x, ;", &format!(";: expected `jacobian_rate`, found `;`; {form}"));
        refused("output a = x, jacobian_rate, y;", ",: `,` cannot stand here; write a vector as `[x, y, z]`");
        refused(
            "output = 1;",
            "=: expected a name after `output`, found `=`; an output has a name and a value: write `output name = …;`",
        );
        refused("let x: m = 1;", ":: a `let` declares no unit; write `let x = …;`: the unit follows from the value");
        refused("let x += 1;", "+=: expected `=`, found `+=`; write `let x = …;`");
        refused("for i = 0..3 {}", "=: expected `in`, found `=`; write `for i in 0..6 { … }`");
        refused("for i in 3 {}", "{: expected `..`, found `{`; write `for i in 0..6 { … }`");
        refused("for i in 0..=3 {}", "..=: a range ends before its end; write `0..n + 1` for the numbers 0 to n");
        refused("for i in 0..3;", ";: expected a `{`, found `;`; write `for i in 0..6 { … }`");
        refused("#[x] let a = 1;", "#[x]: this attribute is not known; the only one is `#![dimensionless]`");
        refused(
            "#![dimensionless]",
            "#![dimensionless]: an attribute of the file stands within the mechanism; move it to the top of the file",
        );
        refused(
            "//! doc\nlet a = 1;",
            "//! doc: this documents the whole file; write `///`, or move it to the top of the file",
        );
        refused(
            "let a = 1; /// doc\nlet b = 2;",
            "/// doc: this would document what follows, not what stands before it; \
             write it on the line before, or as a comment after `//`",
        );
        assert!(
            report("mechanism A { 1 + 2; }")[0]
                .starts_with("1: expected a statement, found `1`; a statement begins with")
        );
        assert!(report("mechanism A { x; }")[0].starts_with("x: `x` begins no statement; a statement begins with"));
    }
}
