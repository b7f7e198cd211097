//! The grammar: one function a construct, its rule above it.
//!
//! ```text
//! file        := (inner | doc | import)* "mechanism" name "{" statement* "}"
//! inner       := "#![dimensionless]"
//! statement   := doc* (param | coord | input | prescribed | const | fn | let | assignment | energy | force | force_at
//!                | torque | gravity | reaction | constraint | output | instance) ";" | doc* (for | choice
//!                | part)
//! ```
//!
//! A function that cannot go on notes why in `errors` and answers [`Refused`]; [`Reader::statements`] goes on with the
//! next statement. Places leave this file as byte ranges only.

use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream};
use syn::buffer::Cursor;
use syn::parse::{ParseStream, Parser};

use super::contextual::{begins_call, begins_instance, is_assignment};
use super::guard;
use super::import::Shared;
use super::keyword::{CONTEXTUAL, STATEMENTS};
use super::quantity::{CONST, COORD, INPUT, PARAM, PRESCRIBED};
use super::reader::{Parsed, Reader, Refused, opens, sign, word};
use super::syntax::{
    Comparison, Declaration, EnergyTerm, Expression, ExpressionKind, Import, Name, Quantity, Span, Statement,
    StatementKind,
};
use crate::diagnostic::{Diagnostics, nearest};

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
    file(source, |reader, input| reader.quantity(input, Vec::new(), &CONST))
}

/// The answer to a question about the tokens of a file; none where it cannot be cut into tokens.
pub(super) fn asked<T>(source: &str, question: fn(ParseStream<'_>) -> T) -> Option<T> {
    let answer = |_: &mut Reader<'_>, input: ParseStream<'_>| {
        let answer = question(input);
        // What is left unread is not the question.
        let _ = input.parse::<TokenStream>();
        Ok(answer)
    };
    file(source, answer).content
}

fn file<'s, T>(source: &'s str, read: impl Fn(&mut Reader<'s>, ParseStream<'_>) -> Parsed<T>) -> File<T> {
    let mut reader = Reader { source, last: 0, depth: 0, imports: Vec::new(), errors: Diagnostics::default() };
    let mut count = 0;
    let content = match guard::check(source).and_then(|tokens| Ok((tokens, cut(source)?))) {
        Ok((number, tokens)) => {
            count = number;
            (|input: ParseStream<'_>| Ok(read(&mut reader, input))).parse2(tokens)
        }
        Err(errors) => {
            reader.errors = errors;
            Ok(Err(Refused))
        }
    };
    let Reader { imports, mut errors, .. } = reader;
    let content = match content {
        Ok(content) => content.ok(),
        Err(unread) => {
            // Once something was refused, syn's complaint about what was left unread behind it adds nothing.
            for error in unread.into_iter().filter(|_| !errors.has_errors()).collect::<Vec<_>>() {
                errors.error(error.span().byte_range(), error.to_string());
            }
            None
        }
    };
    File { imports, content, tokens: count, errors }
}

fn cut(source: &str) -> Result<TokenStream, Diagnostics> {
    TokenStream::from_str(source).map_err(|error| {
        let (at, mut errors) = (error.span().byte_range().start, Diagnostics::default());
        let message = "this is neither a number nor a name nor a sign";
        errors.error(at..at + 1, message).help("numbers are decimal, names plain");
        errors
    })
}

// ---- file

/// What stands at the top of a file, imports aside.
pub(super) struct Head {
    /// Where `#![dimensionless]` stands.
    pub(super) dimensionless: Option<Span>,
    docs: Vec<String>,
}

impl Reader<'_> {
    fn file(&mut self, input: ParseStream<'_>) -> Parsed<Declaration> {
        let Head { dimensionless, docs } = self.head(input);
        self.mechanism_keyword(input)?;
        let name = self.declared_name(input, "mechanism");
        if name.is_ok() && !opens(input, Delimiter::Brace) {
            let help = "a mechanism's statements stand between braces: `mechanism Name { … }`";
            self.unexpected(input, "a `{`", help);
        }
        while !input.is_empty() && !opens(input, Delimiter::Brace) {
            self.skip(input);
        }
        if input.is_empty() {
            return Err(Refused);
        }
        let body = self.group(input)?;
        let statements = self.statements(&body.content);
        self.close(body);
        self.end_of_file(input);
        let (dimensionless, imports, imported) = (dimensionless.is_some(), Vec::new(), Vec::new());
        Ok(Declaration { dimensionless, imports, imported, name: name?, docs, statements })
    }

    /// Documentation, `#![…]` and imports, in any order.
    pub(super) fn head(&mut self, input: ParseStream<'_>) -> Head {
        let mut head = Head { dimensionless: None, docs: Vec::new() };
        loop {
            let start = self.next(input).start;
            if word(input.cursor()).is_some_and(|(text, _)| text == "import") {
                if self.import(input).is_err() {
                    self.behind_import(input);
                }
            } else if !self.peek(input, "#") {
                return head;
            } else if let Some((_, lines)) = self.doc(input) {
                head.docs.extend(lines);
            } else if self.inner_attribute(input).is_ok() {
                head.dimensionless = Some(start..self.last);
            }
        }
    }

    fn mechanism_keyword(&mut self, input: ParseStream<'_>) -> Parsed<()> {
        if self.eat_word(input, "mechanism") {
            return Ok(());
        }
        let (span, form) = (self.next(input), "write `mechanism Name { … }`");
        match word(input.cursor()) {
            None if input.is_empty() => Err(self.refuse(span, "this file declares no mechanism", form)),
            Some((text, _)) if STATEMENTS.contains(&&*text) => {
                let message = format!("`{text}` stands outside a mechanism");
                let help = match text.as_str() {
                    "const" | "fn" => {
                        "move it between the braces of `mechanism Name { … }`, or write `import` with this file's name \
                         in the file of a mechanism"
                    }
                    _ => "move it between the braces of `mechanism Name { … }`",
                };
                Err(self.refuse(span, message, help))
            }
            _ => Err(self.unexpected(input, "`mechanism`", form)),
        }
    }

    fn end_of_file(&mut self, input: ParseStream<'_>) {
        let start = self.next(input);
        let documents = std::iter::from_fn(|| self.doc(input)).count() > 0;
        let (span, message, help) = match word(input.cursor()) {
            None if input.is_empty() && !documents => return,
            None if input.is_empty() => (start, "this documents nothing", "move it before what it documents"),
            Some((text, _)) if text == "mechanism" => {
                (self.next(input), "a file declares one mechanism, this is the second", "write it in a file of its own")
            }
            Some((text, _)) if text == "import" => {
                let here = self.next(input);
                self.late_import(here);
                return while !input.is_empty() && !self.skip(input) {};
            }
            _ => {
                let help = "move it between the mechanism's braces, or into a comment";
                (self.next(input), "text stands after the mechanism", help)
            }
        };
        self.errors.error(span, message).help(help);
        while !input.is_empty() {
            self.skip(input);
        }
    }
}

// ---- statements

impl Reader<'_> {
    /// Every statement that can be read; of the others, why not.
    pub(super) fn statements(&mut self, input: ParseStream<'_>) -> Vec<Statement> {
        let (mut statements, depth) = (Vec::new(), self.depth);
        while !input.is_empty() {
            let start = input.cursor();
            match self.statement(input) {
                Ok(statement) => statements.extend(statement),
                Err(Refused) => self.recover(input, start),
            }
            self.depth = depth;
        }
        statements
    }

    /// Goes to where the next statement probably begins: behind `;` or braces, or at a keyword that begins a line.
    fn recover(&mut self, input: ParseStream<'_>, start: Cursor<'_>) {
        while !input.is_empty() {
            let keyword = word(input.cursor()).is_some_and(|(text, _)| STATEMENTS.contains(&&*text));
            if keyword && input.cursor() != start && self.begins_line(input) {
                return;
            }
            if self.skip(input) {
                // Braces that a value began with, as in `let x = { … };`, or that a branch of it ends with.
                let otherwise = word(input.cursor()).is_some_and(|(text, _)| text == "else");
                let goes_on = sign(input.cursor()).is_some_and(|(sign, _)| sign != "#") && !self.begins_line(input);
                if self.eat(input, ";").is_some() || !otherwise && !goes_on {
                    return;
                }
            }
        }
    }

    /// Nothing where only documentation is left.
    fn statement(&mut self, input: ParseStream<'_>) -> Parsed<Option<Statement>> {
        let docs = self.docs(input)?;
        let here = self.next(input);
        match word(input.cursor()) {
            None if input.is_empty() => Ok(None),
            None => Err(self.no_statement(input)),
            Some((text, _)) if text == "for" => self.for_loop(input).map(Some),
            Some((text, _)) if text == "if" => self.choice(input).map(Some),
            Some((text, _)) if text == "part" && begins_call(input) => self.part(input).map(Some),
            Some((text, _)) => self.plain_statement(input, &text, docs, here).map(Some),
        }
    }

    /// A statement without statements inside; it begins with the word `text`.
    fn plain_statement(
        &mut self,
        input: ParseStream<'_>,
        text: &str,
        docs: Vec<String>,
        here: Span,
    ) -> Parsed<Statement> {
        let start = here.start;
        let kind = match text {
            "param" => StatementKind::Param(self.quantity(input, docs, &PARAM)?),
            "coord" => self.coordinate(input, docs)?,
            "input" => StatementKind::Input(self.quantity(input, docs, &INPUT)?),
            "prescribed" => StatementKind::Prescribed(self.quantity(input, docs, &PRESCRIBED)?),
            "const" => StatementKind::Const(self.quantity(input, docs, &CONST)?),
            "fn" => self.function(input)?,
            "let" => self.binding(input)?,
            "kinetic" => self.energy(input, EnergyTerm::Kinetic)?,
            "potential" => self.energy(input, EnergyTerm::Potential)?,
            "dissipation" => self.energy(input, EnergyTerm::Dissipation)?,
            "lagrangian" => self.energy(input, EnergyTerm::Lagrangian)?,
            "force" => self.force(input)?,
            "torque" => self.torque(input)?,
            "reaction" => self.reaction(input, docs)?,
            "constraint" => self.constraint(input, docs)?,
            "output" => self.output(input, docs)?,
            "gravity" if !is_assignment(input) => self.gravity(input)?,
            "else" => {
                return Err(self.refuse(here, "an `else` without its `if`", "write `if n == 1 { … } else { … }`"));
            }
            "import" => return Err(self.late_import(here)),
            _ if !CONTEXTUAL.contains(&text) && begins_instance(input) => self.instance(input)?,
            _ => self.assignment(input)?,
        };
        self.semicolon(input)?;
        Ok(Statement { kind, span: start..self.last })
    }

    /// A statement whose semicolon is missing is complete all the same: nothing is skipped.
    fn semicolon(&mut self, input: ParseStream<'_>) -> Parsed<()> {
        let keyword = word(input.cursor()).is_some_and(|(text, _)| STATEMENTS.contains(&&*text));
        if self.eat(input, ";").is_some() {
            Ok(())
        } else if input.is_empty() || keyword || self.begins_line(input) {
            self.errors.error(self.last..self.last, "a `;` is missing").help("end the statement with `;`");
            Ok(())
        } else {
            Err(self.stray(input))
        }
    }

    fn no_statement(&mut self, input: ParseStream<'_>) -> Refused {
        let span = self.next(input);
        let forms = "a statement begins with `param`, `coord`, `input`, `prescribed`, `const`, `fn`, `let`, `kinetic`, \
                     `potential`, `dissipation`, `lagrangian`, `force`, `torque`, `gravity`, `reaction`, `constraint`, \
                     `output`, `part`, `for` or `if`, or is an assignment `x = …;`";
        match word(input.cursor()) {
            Some((text, _)) if text == "mechanism" => {
                self.refuse(span, "a mechanism stands within a mechanism", "write it in a file of its own")
            }
            Some((text, _)) => {
                let help = match nearest(&text, STATEMENTS.into_iter().chain(CONTEXTUAL)) {
                    Some(keyword) => format!("did you mean `{keyword}`?"),
                    None => forms.to_string(),
                };
                self.refuse(span, format!("`{text}` begins no statement"), help)
            }
            None if self.peek(input, ";") => self.refuse(span, "this `;` ends nothing", "leave it out"),
            None => self.unexpected(input, "a statement", forms),
        }
    }
}

// ---- what statements say

impl Reader<'_> {
    /// `coord := quantity`, of any name but `at`.
    fn coordinate(&mut self, input: ParseStream<'_>, docs: Vec<String>) -> Parsed<StatementKind> {
        let quantity = self.quantity(input, docs, &COORD)?;
        if quantity.name.text == "at" {
            let help = "choose another name: `force at …` is a force on a point";
            return Err(self.refuse(quantity.name.span, "a coordinate cannot be called `at`", help));
        }
        Ok(StatementKind::Coord(quantity))
    }

    /// `fn := "fn" name "(" (name ("," name)* ","?)? ")" "=" expression`
    fn function(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        self.eat_word(input, "fn");
        let name = self.declared_name(input, "fn")?;
        let form = format!("write `fn {}(x, y) = …;`", name.text);
        if !opens(input, Delimiter::Parenthesis) {
            return Err(self.unexpected(input, "a `(`", &form));
        }
        let parameters = self.names_in_brackets(input, "fn", &form)?;
        if opens(input, Delimiter::Brace) {
            return Err(self.refuse(self.next(input), "a function is one formula", form));
        }
        self.equals(input, &form)?;
        Ok(StatementKind::Function { name, parameters, body: self.expression(input)? })
    }

    /// `"(" (name ("," name)* ","?)? ")"`
    pub(super) fn names_in_brackets(&mut self, input: ParseStream<'_>, keyword: &str, form: &str) -> Parsed<Vec<Name>> {
        let (group, mut names) = (self.group(input)?, Vec::new());
        while !group.content.is_empty() {
            names.push(self.declared_name(&group.content, keyword)?);
            if !group.content.is_empty() && self.eat(&group.content, ",").is_none() {
                return Err(self.unexpected(&group.content, "`,` or `)`", form));
            }
        }
        self.close(group);
        Ok(names)
    }

    /// `binding := "let" "mut"? name "=" expression`, `elements := "let" "mut"? name ("[" expression "]")+`
    fn binding(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        self.eat_word(input, "let");
        let mutable = self.eat_word(input, "mut");
        let name = self.declared_name(input, if mutable { "mut" } else { "let" })?;
        if let Some(colon) = self.eat(input, ":") {
            let help = format!("write `let {} = …;`: the unit follows from the value", name.text);
            return Err(self.refuse(colon, "a `let` declares no unit", help));
        }
        let lengths = self.indices(input)?;
        if !lengths.is_empty() {
            return match self.peek(input, "=") {
                true => Err(self.no_length(input, &name.text)),
                false => Ok(StatementKind::Elements { mutable, name, lengths }),
            };
        }
        self.equals(input, &format!("write `let {} = …;`", name.text))?;
        Ok(StatementKind::Let { mutable, name, value: self.expression(input)? })
    }

    fn no_length(&mut self, input: ParseStream<'_>, name: &str) -> Refused {
        let help =
            format!("write `let {name} = …;`, or `let {name}[n];` and give each element its value: `{name}[i] = …;`");
        self.refuse(self.next(input), "a `let` with a value has the length of the value", help)
    }

    /// `assignment := name ("[" expression "]")* "=" expression`
    fn assignment(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let Some((text, mut behind)) = word(input.cursor()) else { return Err(self.no_statement(input)) };
        while let Some((_, _, rest)) = behind.group(Delimiter::Bracket) {
            behind = rest;
        }
        match sign(behind) {
            Some(("=", _)) => {
                let name = self.name(input, "this")?;
                let indices = self.indices(input)?;
                self.equals(input, "write `x = …;`")?;
                Ok(StatementKind::Assign { name, indices, value: self.expression(input)? })
            }
            Some((sign @ ("+=" | "-=" | "*=" | "/="), _)) => {
                let help = match nearest(&text, ["kinetic", "potential", "dissipation", "lagrangian"]) {
                    Some(energy) => format!("did you mean `{energy}`?"),
                    None => {
                        let target = self.source[self.next(input).start..behind.span().byte_range().start].trim_end();
                        format!("write `{target} = {target} {} …;`", &sign[..1])
                    }
                };
                let message = format!("`{text}` is not an energy, `{sign}` cannot change it");
                Err(self.refuse(self.next(input), message, help))
            }
            _ => Err(self.no_statement(input)),
        }
    }

    /// `energy := ("kinetic" | "potential" | "dissipation" | "lagrangian") "+=" expression`
    fn energy(&mut self, input: ParseStream<'_>, term: EnergyTerm) -> Parsed<StatementKind> {
        let start = self.next(input).start;
        self.skip(input);
        self.adds(input, start)?;
        Ok(StatementKind::Energy { term, value: self.expression(input)? })
    }

    /// `force := "force" name ("[" expression "]")? "+=" expression`,
    /// `force_at := "force" "at" expression "+=" expression`
    fn force(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let start = self.next(input).start;
        self.eat_word(input, "force");
        if self.eat_word(input, "at") {
            let point = self.expression(input)?;
            self.adds(input, start)?;
            return Ok(StatementKind::ForceAt { point, value: self.expression(input)? });
        }
        let coordinate = self.name(input, "`force`")?;
        let index = self.index(input)?;
        if word(input.cursor()).is_some_and(|(text, _)| text == "at") {
            let help = "the point comes first: `force at point += F;`";
            return Err(self.refuse(self.next(input), "a force at a point begins with `force at`", help));
        }
        self.adds(input, start)?;
        Ok(StatementKind::Force { coordinate, index, value: self.expression(input)? })
    }

    /// `torque := "torque" "on" expression "+=" expression`
    fn torque(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let start = self.next(input).start;
        self.eat_word(input, "torque");
        if !self.eat_word(input, "on") {
            let help = "write `torque on pose += [x, y, z];`; on a coordinate it is `force theta += …;`";
            return Err(self.unexpected(input, "`on`", help));
        }
        let pose = self.expression(input)?;
        self.adds(input, start)?;
        Ok(StatementKind::TorqueOn { pose, value: self.expression(input)? })
    }

    /// `reaction := "reaction" name ("[" expression "]")? "at" name ("[" expression "]")*`
    fn reaction(&mut self, input: ParseStream<'_>, docs: Vec<String>) -> Parsed<StatementKind> {
        self.eat_word(input, "reaction");
        let name = self.declared_name(input, "reaction")?;
        let index = self.index(input)?;
        let form = format!("write `reaction {} at pose;`", name.text);
        if !self.eat_word(input, "at") {
            return Err(self.unexpected(input, "`at`", &form));
        }
        let here = self.next(input);
        let pose = self.expression(input)?;
        match pose.element_of() {
            Some((text, element)) => {
                let pose = Name { text: text.to_string(), span: here.start..here.start + text.len() };
                Ok(StatementKind::Reaction { docs, name, index, pose, element: element.into_iter().cloned().collect() })
            }
            None => {
                let help = "name the pose, and build on the name: `let joint = …; reaction name at joint;`";
                Err(self.refuse(pose.span.clone(), "a reaction is that of a pose with a name", help))
            }
        }
    }

    /// `constraint := "constraint" name ("[" expression "]")? ":" expression "=" expression`
    fn constraint(&mut self, input: ParseStream<'_>, docs: Vec<String>) -> Parsed<StatementKind> {
        let form = "write `constraint name: left = right;`";
        self.eat_word(input, "constraint");
        let name = self.declared_name(input, "constraint")?;
        let index = self.index(input)?;
        if self.eat(input, ":").is_none() {
            return Err(self.unexpected(input, "`:`", form));
        }
        let left = self.expression(input)?;
        if let ExpressionKind::Compare(Comparison::Equal, a, b) = &left.kind {
            let signs = a.span.end..b.span.start;
            let start = signs.start + self.source[signs.clone()].find("==").unwrap_or_default();
            return Err(self.refuse(start..start + 2, "an equation is written with `=`", form));
        }
        self.equals(input, form)?;
        Ok(StatementKind::Constraint { docs, name, index, left, right: self.expression(input)? })
    }

    /// The `+=` behind the sum that begins at `start`.
    fn adds(&mut self, input: ParseStream<'_>, start: usize) -> Parsed<()> {
        let (target, here) = (&self.source[start..self.last], self.next(input));
        if self.eat(input, "+=").is_some() {
            return Ok(());
        }
        let help = match sign(input.cursor()) {
            Some(("-=", _)) if target == "kinetic" => {
                "kinetic energy is positive; the energy of springs and weights is `potential += …;`".to_string()
            }
            Some(("-=", _)) if target == "dissipation" => {
                "dissipation is positive and acts against the motion: write `dissipation += …;`".to_string()
            }
            Some(("-=", _)) => format!("write `{target} += -(…);`"),
            _ => format!("write `{target} += …;`"),
        };
        match sign(input.cursor()) {
            Some((found @ ("=" | "-=" | "*=" | "/=" | "+"), _)) => {
                let message = format!("`{target}` is a sum that statements add to, `{found}` does not");
                Err(self.refuse(here, message, help))
            }
            _ => Err(self.unexpected(input, "`+=`", &help)),
        }
    }

    /// `output := "output" name ("[" expression "]")? "=" expression ("," "jacobian_rate")?`
    fn output(&mut self, input: ParseStream<'_>, docs: Vec<String>) -> Parsed<StatementKind> {
        self.eat_word(input, "output");
        if word(input.cursor()).is_none() {
            let help = "an output has a name and a value: write `output name = …;`";
            return Err(self.unexpected(input, "a name after `output`", help));
        }
        let name = self.declared_name(input, "output")?;
        let index = self.index(input)?;
        let help = format!("an output has a name and a value: write `output name = {};`", name.text);
        self.equals(input, if self.peek(input, ";") { &help } else { "write `output name = …;`" })?;
        let value = self.expression(input)?;
        Ok(StatementKind::Output { docs, name, index, value, jacobian_rate: self.jacobian_rate(input)? })
    }

    /// `"," "jacobian_rate"`, if a comma comes next.
    fn jacobian_rate(&mut self, input: ParseStream<'_>) -> Parsed<Option<Span>> {
        if self.eat(input, ",").is_none() {
            return Ok(None);
        }
        let here = self.next(input);
        if self.eat_word(input, "jacobian_rate") {
            return Ok(Some(here));
        }
        let help = "a vector is written as `[x, y, z]`; `jacobian_rate` asks for the time derivative of the Jacobian";
        Err(self.unexpected(input, "`jacobian_rate`", help))
    }

    /// `for := "for" name "in" expression ".." expression "{" statement* "}"`
    fn for_loop(&mut self, input: ParseStream<'_>) -> Parsed<Statement> {
        let first = self.next(input).start;
        let (variable, start, end) = self.for_head(input)?;
        let group = self.group(input)?;
        let body = self.statements(&group.content);
        self.close(group);
        Ok(Statement { kind: StatementKind::For { variable, start, end, body }, span: first..self.last })
    }

    fn for_head(&mut self, input: ParseStream<'_>) -> Parsed<(Name, Expression, Expression)> {
        let form = "write `for i in 0..6 { … }`";
        self.eat_word(input, "for");
        let variable = self.declared_name(input, "for")?;
        if !self.eat_word(input, "in") {
            return Err(self.unexpected(input, "`in`", form));
        }
        let start = self.expression(input)?;
        if let Some(dots) = self.eat(input, "..=") {
            return Err(self.refuse(dots, "a range ends before its end", "write `0..n + 1` for the numbers 0 to n"));
        }
        if self.eat(input, "..").is_none() {
            return Err(self.unexpected(input, "`..`", form));
        }
        let end = self.expression(input)?;
        match opens(input, Delimiter::Brace) {
            true => Ok((variable, start, end)),
            false => Err(self.unexpected(input, "a `{`", form)),
        }
    }

    fn equals(&mut self, input: ParseStream<'_>, help: &str) -> Parsed<()> {
        match self.eat(input, "=") {
            Some(_) => Ok(()),
            None => Err(self.unexpected(input, "`=`", help)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, report, statement};
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
        check(
            "mechanism A { x = 0b12; }",
            "0: this is neither a number nor a name nor a sign; numbers are decimal, names plain",
        );
    }

    #[test]
    fn energies_are_added_to() {
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
                assert!(errors.render("a.mbs", source).contains("error: "));
            }
        }
    }

    #[test]
    fn any_text_is_answered() {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let pieces = [
            "mechanism",
            "A",
            "{",
            "}",
            "(",
            ")",
            "[",
            "]",
            "param",
            "coord",
            "input",
            "const",
            "let",
            "mut",
            "for",
            "in",
            "kinetic",
            "force",
            "output",
            "fn",
            "if",
            "else",
            "prescribed",
            "constraint",
            "torque on",
            "force at",
            "&&",
            "||",
            "<=",
            "if a < b { x } else ",
            "x",
            "t",
            "r#x",
            "_",
            "=",
            "+=",
            "==",
            "+",
            "-",
            "*",
            "/",
            "^",
            "**",
            ".",
            "..",
            "..=",
            ",",
            ";",
            ":",
            "#",
            "!",
            "#![dimensionless]",
            "/// doc\n",
            "//! doc\n",
            "/** d */",
            "// c\n",
            "/*",
            "*/",
            "0",
            "1.",
            "1.5",
            "1e",
            "1e-5",
            "2m",
            "0x",
            "0b2",
            "r#\"",
            "\"",
            "'",
            "'a'",
            "'a",
            "b'",
            "\\",
            "θ",
            "²",
            "·",
            "q\u{307}",
            "\r",
            "\n",
            "\t",
            "\0",
            "\u{feff}",
            "🦀",
            "(/*ERROR*/)",
            "kg",
            "<",
            "&",
            "@",
            "if",
            "mechanism A {",
            "import",
            "import \"a.mbs\";",
            "let x = ",
            "param m: kg = 1;",
            "for i in 0..3 {",
            "coord q[3]: rad;",
            "u32",
            "e5",
            "$",
            "?",
            "~",
            "|",
            "%",
        ];
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
