//! The grammar: one function a construct, its rule above it.
//!
//! ```text
//! file        := (inner | doc)* "mechanism" name "{" statement* "}"
//! inner       := "#![dimensionless]"
//! statement   := doc* (param | coord | input | const | let | assignment | energy | force | output) ";" | doc* for
//! ```
//!
//! A function that cannot go on notes why in `errors` and answers [`Refused`]; [`Reader::statements`] goes on with the
//! next statement. Places leave this file as byte ranges only.

use std::str::FromStr;

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use syn::buffer::Cursor;
use syn::parse::discouraged::AnyDelimiter;
use syn::parse::{ParseBuffer, ParseStream, Parser};

use super::MAX_DEPTH;
use super::keyword::{RESERVED, STATEMENTS, keyword, taken};
use super::syntax::{
    BinaryOperator, Declaration, EnergyTerm, Expression, ExpressionKind, Name, Quantity, Span, Statement,
    StatementKind, Unit, UnitFactor,
};
use crate::diagnostic::{Diagnostics, nearest};

/// Reads a file that `guard` has let pass.
pub(super) fn declaration(source: &str) -> Result<Declaration, Diagnostics> {
    let mut reader = Reader { source, last: 0, depth: 0, errors: Diagnostics::default() };
    let tokens = match TokenStream::from_str(source) {
        Ok(tokens) => tokens,
        Err(error) => {
            let at = error.span().byte_range().start;
            let message = "this is neither a number nor a name nor a sign";
            reader.errors.error(at..at + 1, message).help("numbers are decimal, names plain");
            return Err(reader.errors);
        }
    };
    // Once something was refused, syn's complaint about what was left unread behind it adds nothing.
    let parsed = (|input: ParseStream<'_>| Ok(reader.file(input))).parse2(tokens);
    match parsed {
        Ok(Ok(declaration)) => reader.errors.finish(declaration),
        Err(unread) if !reader.errors.has_errors() => {
            for error in unread {
                reader.errors.error(error.span().byte_range(), error.to_string());
            }
            Err(reader.errors)
        }
        Ok(Err(Refused)) | Err(_) => Err(reader.errors),
    }
}

/// The construct is given up; why has been noted in `errors`.
struct Refused;

type Parsed<T> = Result<T, Refused>;

struct Reader<'s> {
    source: &'s str,
    /// Where the last token taken ends.
    last: usize,
    /// How deep the construct at hand is nested.
    depth: usize,
    errors: Diagnostics,
}

// ---- file

impl Reader<'_> {
    fn file(&mut self, input: ParseStream<'_>) -> Parsed<Declaration> {
        let (dimensionless, docs) = self.head(input);
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
        Ok(Declaration { dimensionless, name: name?, docs, statements })
    }

    /// Documentation and `#![…]`, in any order.
    fn head(&mut self, input: ParseStream<'_>) -> (bool, Vec<String>) {
        let (mut dimensionless, mut docs) = (false, Vec::new());
        while self.peek(input, "#") {
            match self.doc(input) {
                Some((_, lines)) => docs.extend(lines),
                None => dimensionless |= self.inner_attribute(input).is_ok(),
            }
        }
        (dimensionless, docs)
    }

    /// `inner := "#![dimensionless]"`
    fn inner_attribute(&mut self, input: ParseStream<'_>) -> Parsed<()> {
        let start = self.next(input).start;
        self.eat(input, "#");
        self.eat(input, "!");
        if opens(input, Delimiter::Bracket) {
            self.skip(input);
        }
        let span = start..self.last;
        let text: String = self.source[span.clone()].split_whitespace().collect();
        let (message, help) = match text.as_str() {
            "#![dimensionless]" => return Ok(()),
            "#[dimensionless]" => ("this attribute is about the whole file", "write `#![dimensionless]`"),
            _ => ("this attribute is not known", "the only one is `#![dimensionless]`"),
        };
        Err(self.refuse(span, message, help))
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
                Err(self.refuse(span, message, "move it between the braces of `mechanism Name { … }`"))
            }
            Some((text, _)) if RESERVED.contains(&&*text) => Err(self.reserved(span, &text)),
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
    fn statements(&mut self, input: ParseStream<'_>) -> Vec<Statement> {
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
                // Braces that a value began with, as in `let x = { … };`.
                self.eat(input, ";");
                return;
            }
        }
    }

    /// Nothing where only documentation is left.
    fn statement(&mut self, input: ParseStream<'_>) -> Parsed<Option<Statement>> {
        let docs = self.docs(input)?;
        let here = self.next(input);
        let start = here.start;
        let Some((text, _)) = word(input.cursor()) else {
            return if input.is_empty() { Ok(None) } else { Err(self.no_statement(input)) };
        };
        let kind = match text.as_str() {
            "param" => StatementKind::Param(self.quantity(input, docs, &PARAM)?),
            "coord" => StatementKind::Coord(self.quantity(input, docs, &COORD)?),
            "input" => StatementKind::Input(self.quantity(input, docs, &INPUT)?),
            "const" => StatementKind::Const(self.quantity(input, docs, &CONST)?),
            "let" => self.binding(input)?,
            "kinetic" => self.energy(input, EnergyTerm::Kinetic)?,
            "potential" => self.energy(input, EnergyTerm::Potential)?,
            "dissipation" => self.energy(input, EnergyTerm::Dissipation)?,
            "lagrangian" => self.energy(input, EnergyTerm::Lagrangian)?,
            "force" => self.force(input)?,
            "output" => self.output(input, docs)?,
            "for" => {
                let kind = self.for_loop(input)?;
                return Ok(Some(Statement { kind, span: start..self.last }));
            }
            text if RESERVED.contains(&text) => return Err(self.reserved(here, text)),
            _ => self.assignment(input)?,
        };
        self.semicolon(input)?;
        Ok(Some(Statement { kind, span: start..self.last }))
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
        let forms = "a statement begins with `param`, `coord`, `input`, `const`, `let`, `kinetic`, `potential`, \
                     `dissipation`, `lagrangian`, `force`, `output` or `for`, or is an assignment `x = …;`";
        match word(input.cursor()) {
            Some((text, _)) if text == "mechanism" => {
                self.refuse(span, "a mechanism stands within a mechanism", "write it in a file of its own")
            }
            Some((text, _)) => {
                let help = match nearest(&text, STATEMENTS) {
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

// ---- declarations

/// What one kind of [`Quantity`] must have.
struct Form {
    keyword: &'static str,
    /// The help where the unit is missing; none where it may be missing.
    needs_unit: Option<&'static str>,
    value: FormValue,
}

enum FormValue {
    /// There is none, because …
    Absent(&'static str),
    Optional,
    Needed,
}

const PARAM: Form = Form { keyword: "param", needs_unit: Some("m = …"), value: FormValue::Optional };
const CONST: Form = Form { keyword: "const", needs_unit: None, value: FormValue::Needed };
const COORD: Form = Form {
    keyword: "coord",
    needs_unit: Some("rad"),
    value: FormValue::Absent("its initial value is part of the state that a simulation begins with"),
};
const INPUT: Form = Form {
    keyword: "input",
    needs_unit: Some("N"),
    value: FormValue::Absent("its value is given while the mechanism moves"),
};

impl Reader<'_> {
    /// `quantity := keyword name ("[" expression "]")? (":" unit)? ("=" expression)?`
    fn quantity(&mut self, input: ParseStream<'_>, docs: Vec<String>, form: &Form) -> Parsed<Quantity> {
        let start = self.next(input).start;
        self.eat_word(input, form.keyword);
        let name = self.declared_name(input, form.keyword)?;
        let length = self.index(input)?;
        let declared = start..self.last;
        let unit = self.quantity_unit(input, form, &declared)?;
        let value = self.quantity_value(input, form, &declared)?;
        Ok(Quantity { docs, name, length, unit, value })
    }

    fn quantity_unit(&mut self, input: ParseStream<'_>, form: &Form, declared: &Span) -> Parsed<Option<Unit>> {
        let text = &self.source[declared.clone()];
        let colon = self.eat(input, ":").is_some();
        let breaks = !colon && self.begins_line(input);
        let ends = input.is_empty() || breaks || ["=", ";"].iter().any(|sign| self.peek(input, sign));
        match form.needs_unit {
            Some(example) if ends => {
                let help = format!("write `{text}: {example};`, `1` for a pure number");
                Err(self.refuse(declared.clone(), format!("`{text}` needs a unit"), help))
            }
            None if ends && colon => {
                let help = format!("write `{text}: m = …;`, or leave the `:` out");
                Err(self.refuse(declared.clone(), format!("`{text}` has a `:` but no unit"), help))
            }
            None if ends => Ok(None),
            _ if colon => self.unit(input).map(Some),
            _ => Err(self.unexpected(input, "`:` and a unit", &format!("write `{text}: m`, `1` for a pure number"))),
        }
    }

    fn quantity_value(&mut self, input: ParseStream<'_>, form: &Form, declared: &Span) -> Parsed<Option<Expression>> {
        let (text, keyword) = (&self.source[declared.clone()], form.keyword);
        let here = self.next(input);
        match (&form.value, self.eat(input, "=").is_some()) {
            (FormValue::Absent(why), true) => {
                Err(self.refuse(here, format!("`{text}` cannot have a value"), format!("leave it out: {why}")))
            }
            (FormValue::Needed, false) if input.is_empty() || self.peek(input, ";") => {
                let help = format!("write `{text} = …;`, or make it a `param`");
                Err(self.refuse(declared.clone(), format!("this `{keyword}` needs a value"), help))
            }
            (_, true) => self.expression(input).map(Some),
            (_, false) => Ok(None),
        }
    }

    /// `unit := unit_factor (("*" | "/") unit_factor)*`
    fn unit(&mut self, input: ParseStream<'_>) -> Parsed<Unit> {
        let (start, mut factors) = (self.next(input).start, Vec::new());
        self.unit_product(input, 1, &mut factors)?;
        if !self.begins_line(input) && word(input.cursor()).is_some() {
            let (span, found) = (self.next(input), self.found(input));
            return Err(self.refuse(span, format!("a `*` is missing before the unit {found}"), "write it as in `N*m`"));
        }
        if input.cursor().literal().is_some() {
            return Err(self.unexpected(input, "`=` or `;`", "write a value behind `=`"));
        }
        Ok(Unit { factors, span: start..self.last })
    }

    fn unit_product(&mut self, input: ParseStream<'_>, sign: i32, factors: &mut Vec<UnitFactor>) -> Parsed<()> {
        self.unit_factor(input, sign, factors)?;
        loop {
            if self.eat(input, "*").is_some() {
                self.unit_factor(input, sign, factors)?;
            } else if self.eat(input, "/").is_some() {
                self.unit_factor(input, -sign, factors)?;
            } else if self.peek(input, "**") {
                return Err(self.double_star(input));
            } else {
                return Ok(());
            }
        }
    }

    /// `unit_factor := "1" | name ("^" unit_exponent)? | "(" unit ")"`
    fn unit_factor(&mut self, input: ParseStream<'_>, sign: i32, factors: &mut Vec<UnitFactor>) -> Parsed<()> {
        let (span, help) = (self.next(input), "write a unit such as `kg*m^2/s^2`, `1` for a pure number");
        if let Some(number) = self.literal(input) {
            let help = "numbers belong to the value; write a root as `m^(1/2)`";
            return match number.as_str() {
                "1" => Ok(()),
                _ => Err(self.refuse(span, format!("`{number}` is not a unit"), help)),
            };
        }
        if opens(input, Delimiter::Parenthesis) {
            let group = self.group(input)?;
            self.unit_product(&group.content, sign, factors)?;
            if !group.content.is_empty() {
                return Err(self.unexpected(&group.content, "`*`, `/` or `)`", help));
            }
            self.close(group);
            return match self.eat(input, "^") {
                Some(span) => Err(self.refuse(span, "a unit in parentheses has no power", "write the power of each unit")),
                None => Ok(()),
            };
        }
        if word(input.cursor()).is_none() {
            return Err(self.unexpected(input, "a unit", help));
        }
        let name = self.name(input, "`:`")?;
        let (numerator, denominator) = match self.eat(input, "^") {
            Some(_) => self.unit_exponent(input)?,
            None => (1, 1),
        };
        factors.push(UnitFactor { name, exponent: (sign * numerator, denominator) });
        Ok(())
    }

    /// `unit_exponent := "-"? whole | "(" "-"? whole ("/" whole)? ")"`
    fn unit_exponent(&mut self, input: ParseStream<'_>) -> Parsed<(i32, i32)> {
        if !opens(input, Delimiter::Parenthesis) {
            return Ok((self.signed_whole(input)?, 1));
        }
        let group = self.group(input)?;
        let numerator = self.signed_whole(&group.content)?;
        let slash = self.eat(&group.content, "/").is_some();
        let (span, denominator) = (self.next(&group.content), if slash { self.whole(&group.content)? } else { 1 });
        if denominator == 0 {
            return Err(self.refuse(span, "this exponent divides by zero", "write a fraction such as `m^(1/2)`"));
        }
        if !group.content.is_empty() {
            return Err(self.unexpected(&group.content, "`)`", "write a fraction such as `m^(1/2)`"));
        }
        self.close(group);
        Ok((numerator, denominator))
    }

    fn signed_whole(&mut self, input: ParseStream<'_>) -> Parsed<i32> {
        let sign = if self.eat(input, "-").is_some() { -1 } else { 1 };
        Ok(sign * self.whole(input)?)
    }

    /// A whole number up to 100, so that no arithmetic with exponents overflows.
    fn whole(&mut self, input: ParseStream<'_>) -> Parsed<i32> {
        let span = self.next(input);
        let help = "write a whole number as in `m^2`, or a fraction as in `m^(1/2)`, up to 100";
        match self.literal(input) {
            Some(text) => match text.parse() {
                Ok(number @ 0..=100) => Ok(number),
                _ => Err(self.refuse(span, format!("`{text}` cannot be the exponent of a unit"), help)),
            },
            None => Err(self.unexpected(input, "the exponent of a unit", help)),
        }
    }

    /// A name that is being declared behind the word `after`.
    fn declared_name(&mut self, input: ParseStream<'_>, after: &str) -> Parsed<Name> {
        let name = self.name(input, &format!("`{after}`"))?;
        match taken(&name.text) {
            Some(what) => {
                let help = format!("choose another name, such as `{}_`", name.text);
                Err(self.refuse(name.span.clone(), format!("`{}` cannot be declared: it is {what}", name.text), help))
            }
            None => Ok(name),
        }
    }

    /// A name of letters, digits and `_`, with at least one letter.
    fn name(&mut self, input: ParseStream<'_>, after: &str) -> Parsed<Name> {
        let Some((text, _)) = word(input.cursor()) else {
            return Err(self.unexpected(input, &format!("a name after {after}"), "a name begins with a letter"));
        };
        self.skip(input);
        let span = self.last - text.len()..self.last;
        if let Some(plain) = text.strip_prefix("r#") {
            return Err(self.refuse(span, format!("`{text}` is not a name"), format!("write `{plain}_`")));
        }
        if !text.contains(|c: char| c.is_ascii_alphabetic()) {
            return Err(self.refuse(span, format!("`{text}` is not a name"), "a name has at least one letter"));
        }
        Ok(Name { text, span })
    }
}

// ---- what statements say

impl Reader<'_> {
    /// `binding := "let" "mut"? name "=" expression`
    fn binding(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        self.eat_word(input, "let");
        let mutable = self.eat_word(input, "mut");
        let name = self.declared_name(input, if mutable { "mut" } else { "let" })?;
        if let Some(colon) = self.eat(input, ":") {
            let help = format!("write `let {} = …;`: the unit follows from the value", name.text);
            return Err(self.refuse(colon, "a `let` declares no unit", help));
        }
        self.equals(input, &format!("write `let {} = …;`", name.text))?;
        Ok(StatementKind::Let { mutable, name, value: self.expression(input)? })
    }

    /// `assignment := name "=" expression`
    fn assignment(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let Some((text, behind)) = word(input.cursor()) else { return Err(self.no_statement(input)) };
        match sign(behind) {
            Some(("=", _)) => {
                let name = self.name(input, "this")?;
                self.equals(input, "write `x = …;`")?;
                Ok(StatementKind::Assign { name, value: self.expression(input)? })
            }
            Some((sign @ ("+=" | "-=" | "*=" | "/="), _)) => {
                let help = match nearest(&text, ["kinetic", "potential", "dissipation", "lagrangian"]) {
                    Some(energy) => format!("did you mean `{energy}`?"),
                    None => format!("write `{text} = {text} {} …;`", &sign[..1]),
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

    /// `force := "force" name ("[" expression "]")? "+=" expression`
    fn force(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
        let start = self.next(input).start;
        self.eat_word(input, "force");
        let coordinate = self.name(input, "`force`")?;
        let index = self.index(input)?;
        if word(input.cursor()).is_some_and(|(text, _)| text == "at") {
            return Err(self.reserved(self.next(input), "at"));
        }
        self.adds(input, start)?;
        Ok(StatementKind::Force { coordinate, index, value: self.expression(input)? })
    }

    /// The `+=` behind the sum that begins at `start`.
    fn adds(&mut self, input: ParseStream<'_>, start: usize) -> Parsed<()> {
        let (target, here) = (&self.source[start..self.last], self.next(input));
        if self.eat(input, "+=").is_some() {
            return Ok(());
        }
        let help = match sign(input.cursor()) {
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

    /// `output := "output" name "=" expression`
    fn output(&mut self, input: ParseStream<'_>, docs: Vec<String>) -> Parsed<StatementKind> {
        self.eat_word(input, "output");
        let name = self.declared_name(input, "output")?;
        self.equals(input, &format!("write `output {} = …;`", name.text))?;
        Ok(StatementKind::Output { docs, name, value: self.expression(input)? })
    }

    /// `for := "for" name "in" expression ".." expression "{" statement* "}"`
    fn for_loop(&mut self, input: ParseStream<'_>) -> Parsed<StatementKind> {
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
        if !opens(input, Delimiter::Brace) {
            return Err(self.unexpected(input, "a `{`", form));
        }
        let group = self.group(input)?;
        let body = self.statements(&group.content);
        self.close(group);
        Ok(StatementKind::For { variable, start, end, body })
    }

    fn equals(&mut self, input: ParseStream<'_>, help: &str) -> Parsed<()> {
        match self.eat(input, "=") {
            Some(_) => Ok(()),
            None => Err(self.unexpected(input, "`=`", help)),
        }
    }
}

// ---- expressions

const SUM: [(&str, BinaryOperator); 2] = [("+", BinaryOperator::Add), ("-", BinaryOperator::Sub)];
const PRODUCT: [(&str, BinaryOperator); 2] = [("*", BinaryOperator::Mul), ("/", BinaryOperator::Div)];

impl Reader<'_> {
    /// `expression := product (("+" | "-") product)*`
    fn expression(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        let mut sum = self.product(input)?;
        while let Some(operator) = self.operator(input, &SUM) {
            sum = binary(operator, sum, self.product(input)?);
        }
        Ok(sum)
    }

    /// `product := signed (("*" | "/") signed)*`
    fn product(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        let mut product = self.signed(input)?;
        while let Some(operator) = self.operator(input, &PRODUCT) {
            product = binary(operator, product, self.signed(input)?);
        }
        match self.peek(input, "**") {
            true => Err(self.double_star(input)),
            false => Ok(product),
        }
    }

    /// `signed := "-" signed | postfix ("^" signed)?`, so that `-x^2` is `-(x^2)` and `x^-y^z` is `x^(-(y^z))`.
    fn signed(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        if let Some(here) = self.eat(input, "-") {
            self.enter(&here)?;
            let value = self.signed(input)?;
            self.depth -= 1;
            let span = here.start..value.span.end;
            return Ok(Expression { kind: ExpressionKind::Negate(Box::new(value)), span });
        }
        let base = self.postfix(input)?;
        match self.eat(input, "^") {
            Some(here) => {
                self.enter(&here)?;
                let exponent = self.signed(input)?;
                self.depth -= 1;
                Ok(binary(BinaryOperator::Pow, base, exponent))
            }
            None => Ok(base),
        }
    }

    /// `postfix := primary ("." name | "." name "(" arguments ")" | "[" expression "]")*`
    fn postfix(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        let mut value = self.primary(input)?;
        let (start, depth) = (value.span.start, self.depth);
        loop {
            let behind = self.last;
            let kind = if let Some(index) = self.index(input)? {
                ExpressionKind::Index(Box::new(value), Box::new(index))
            } else if self.eat(input, ".").is_some() {
                self.member(input, value)?
            } else if opens(input, Delimiter::Parenthesis) && !self.begins_line(input) {
                let (here, help) = (self.next(input), "write `*` for a product");
                return Err(self.refuse(here, "only a function's name can stand before `(`", help));
            } else {
                self.depth = depth;
                return Ok(value);
            };
            self.enter(&(behind..self.last))?;
            value = Expression { kind, span: start..self.last };
        }
    }

    /// What stands behind a `.`: a component or a method.
    fn member(&mut self, input: ParseStream<'_>, value: Expression) -> Parsed<ExpressionKind> {
        let here = self.next(input);
        if let Some(number) = self.literal(input) {
            let help = "write `[0]` for the first component, `[1]` for the second";
            return Err(self.refuse(here, format!("`.{number}` is not a component"), help));
        }
        let name = self.name(input, "`.`")?;
        if opens(input, Delimiter::Parenthesis) {
            return Ok(ExpressionKind::Method(Box::new(value), name, self.arguments(input)?));
        }
        match &value.kind {
            ExpressionKind::Number(number) => {
                let message = format!("a number has no component `{}`", name.text);
                Err(self.refuse(here, message, format!("write a digit behind the point: `{number}.0`")))
            }
            _ => Ok(ExpressionKind::Field(Box::new(value), name)),
        }
    }

    /// `primary := number | name | name "(" arguments ")" | "[" arguments "]" | "(" expression ")"`
    fn primary(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        let here = self.next(input);
        if opens(input, Delimiter::Parenthesis) {
            return self.parenthesized(input);
        }
        let kind = if opens(input, Delimiter::Bracket) {
            ExpressionKind::Array(self.arguments(input)?)
        } else if let Some(text) = self.literal(input) {
            ExpressionKind::Number(self.number(&text, here.clone())?)
        } else if let Some((text, _)) = word(input.cursor()) {
            self.no_keyword(here.clone(), &text)?;
            let name = self.name(input, "this")?;
            if opens(input, Delimiter::Parenthesis) && !self.begins_line(input) {
                ExpressionKind::Call(name, self.arguments(input)?)
            } else {
                ExpressionKind::Name(name.text)
            }
        } else {
            return Err(self.no_value(input));
        };
        Ok(Expression { kind, span: here.start..self.last })
    }

    /// Its place includes the parentheses.
    fn parenthesized(&mut self, input: ParseStream<'_>) -> Parsed<Expression> {
        let start = self.next(input).start;
        let group = self.group(input)?;
        let mut value = self.expression(&group.content)?;
        if !group.content.is_empty() {
            return Err(self.stray(&group.content));
        }
        self.close(group);
        value.span = start..self.last;
        Ok(value)
    }

    /// `arguments := (expression ("," expression)* ","?)?`, between brackets of any kind.
    fn arguments(&mut self, input: ParseStream<'_>) -> Parsed<Vec<Expression>> {
        let (group, mut values) = (self.group(input)?, Vec::new());
        while !group.content.is_empty() {
            values.push(self.expression(&group.content)?);
            if !group.content.is_empty() && self.eat(&group.content, ",").is_none() {
                return Err(self.stray(&group.content));
            }
        }
        self.close(group);
        Ok(values)
    }

    /// `("[" expression "]")?`: an array's length, or an index.
    fn index(&mut self, input: ParseStream<'_>) -> Parsed<Option<Expression>> {
        if !opens(input, Delimiter::Bracket) {
            return Ok(None);
        }
        let group = self.group(input)?;
        let index = self.expression(&group.content)?;
        if self.peek(&group.content, ",") {
            let span = self.next(&group.content);
            return Err(self.refuse(span, "an index is one number", "write `a[i][j]` for an element of a matrix"));
        }
        if !group.content.is_empty() {
            return Err(self.stray(&group.content));
        }
        self.close(group);
        Ok(Some(index))
    }

    /// `number := digits ("." digits?)? (("e" | "E") ("+" | "-")? digits)?`, as large as an `f64` can be.
    fn number(&mut self, text: &str, span: Span) -> Parsed<String> {
        let digits: String = text.chars().filter(|&c| c != '_').collect();
        let (decimal, suffix) = digits.split_at(decimal_length(&digits));
        if decimal.len() > 100 {
            return Err(self.refuse(span, "this number is longer than 100 characters", "an `f64` has 17 digits"));
        }
        if digits.starts_with("0x") || digits.starts_with("0o") || digits.starts_with("0b") {
            return Err(self.refuse(span, format!("`{text}` is not a decimal number"), "write it with digits 0 to 9"));
        }
        if decimal.is_empty() {
            return Err(self.refuse(span, format!("`{text}` is not a value"), "write a number"));
        }
        let type_suffix = ["f32", "f64", "i32", "i64", "u32", "u64", "usize", "isize"].contains(&suffix);
        if type_suffix {
            return Err(self.refuse(span, "a number has no type", format!("write `{decimal}`")));
        }
        if !suffix.is_empty() {
            let help = format!(
                "write `{decimal} * {suffix}` for a product; \
                 units belong to declarations, as in `param length: m = {decimal};`"
            );
            return Err(self.refuse(span, format!("`{text}` is neither a number nor a name"), help));
        }
        let mantissa = decimal.split(['e', 'E']).next().unwrap_or_default();
        let zero = !mantissa.contains(|c: char| ('1'..='9').contains(&c));
        match decimal.parse::<f64>() {
            Ok(value) if value.is_finite() && (value != 0.0 || zero) => Ok(decimal.to_string()),
            _ => Err(self.refuse(span, format!("`{text}` is beyond the range of an `f64`"), "choose other units")),
        }
    }

    fn operator(&mut self, input: ParseStream<'_>, operators: &[(&str, BinaryOperator)]) -> Option<BinaryOperator> {
        let (found, _) = sign(input.cursor())?;
        let (_, operator) = operators.iter().find(|(sign, _)| *sign == found)?;
        self.skip(input);
        Some(*operator)
    }

    fn double_star(&mut self, input: ParseStream<'_>) -> Refused {
        let span = self.next(input);
        self.refuse(span, "`**` is not an operator", "write `^` for a power: `x^2`")
    }

    fn no_keyword(&mut self, span: Span, text: &str) -> Parsed<()> {
        match keyword(text) {
            Some(_) if RESERVED.contains(&text) => Err(self.reserved(span, text)),
            Some(what) => Err(self.refuse(span, format!("`{text}` is {what}, not a value"), "write a value here")),
            None => Ok(()),
        }
    }

    /// Where a value must begin, something else does.
    fn no_value(&mut self, input: ParseStream<'_>) -> Refused {
        let here = self.next(input);
        match sign(input.cursor()) {
            Some(("+", _)) => self.refuse(here, "a `+` before a value says nothing", "leave it out"),
            Some(("*", _)) if self.source[..here.start].trim_end().ends_with('*') => self.double_star(input),
            Some((".", behind)) if behind.literal().is_some() => {
                let (number, _) = behind.literal().expect("just seen");
                self.refuse(here, "a number begins with a digit", format!("write `0.{number}`"))
            }
            _ => {
                let help = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
                self.unexpected(input, "a value", help)
            }
        }
    }

    /// Behind a complete value stands what neither continues nor ends it.
    fn stray(&mut self, input: ParseStream<'_>) -> Refused {
        let (here, found) = (self.next(input), self.found(input));
        let (message, help) = match sign(input.cursor()) {
            Some(("=" | "+=" | "-=" | "*=" | "/=", _)) => {
                (format!("{found} cannot stand behind a value"), "end the statement before with `;`")
            }
            Some(("==" | "!=" | "<" | "<=" | ">" | ">=", _)) => {
                ("comparisons are not part of the language yet".to_string(), "leave it out")
            }
            Some((",", _)) => (format!("{found} cannot stand here"), "write a vector as `[x, y, z]`"),
            Some((";", _)) => (format!("{found} cannot stand within brackets"), "write `,` between values"),
            Some((".." | "..=", _)) => ("a range stands behind `in` only".to_string(), "write `for i in 0..6 { … }`"),
            Some((":", _)) => {
                let help = "units belong to declarations, as in `param length: m = 2;`";
                ("a value has no unit of its own".to_string(), help)
            }
            Some(_) => (format!("{found} is not an operator"), "the operators are `+`, `-`, `*`, `/` and `^`"),
            None if opens(input, Delimiter::Brace) => {
                (format!("{found} cannot stand behind a value"), "end the statement with `;`")
            }
            None => match word(input.cursor()) {
                Some((text, _)) if RESERVED.contains(&&*text) => return self.reserved(here, &text),
                _ => (format!("an operator is missing before {found}"), "write `*` for a product"),
            },
        };
        self.refuse(here, message, help)
    }
}

fn binary(operator: BinaryOperator, left: Expression, right: Expression) -> Expression {
    let span = left.span.start..right.span.end;
    Expression { kind: ExpressionKind::Binary(operator, Box::new(left), Box::new(right)), span }
}

/// How much of `text` is a decimal number.
fn decimal_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end += 1 + digits(end + 1);
    }
    let sign = usize::from(text[end..].get(1..).is_some_and(|rest| rest.starts_with(['+', '-'])));
    if text[end..].starts_with(['e', 'E']) && digits(end + 1 + sign) > 0 {
        end += 1 + sign + digits(end + 1 + sign);
    }
    end
}

// ---- documentation

impl Reader<'_> {
    /// The documentation before a statement, and complaints about what else begins with `#`.
    fn docs(&mut self, input: ParseStream<'_>) -> Parsed<Vec<String>> {
        let mut docs = Vec::new();
        while self.peek(input, "#") {
            let (trails, start) = (!self.begins_line(input), self.next(input).start);
            match self.doc(input) {
                Some((span, lines)) => {
                    let text = &self.source[span.clone()];
                    if text.starts_with("//!") || text.starts_with("/*!") {
                        let error = self.errors.error(span, "this documents the whole file");
                        error.help("write `///`, or move it to the top of the file");
                    } else if trails && text.starts_with("///") {
                        let error = self.errors.error(span, "this would document what follows, not what stands before it");
                        error.help("write it on the line before, or as a comment after `//`");
                    } else {
                        docs.extend(lines);
                    }
                }
                None => {
                    self.inner_attribute(input)?;
                    let message = "an attribute of the file stands within the mechanism";
                    return Err(self.refuse(start..self.last, message, "move it to the top of the file"));
                }
            }
        }
        Ok(docs)
    }

    /// One comment of documentation, which the tokenizer has made an attribute of.
    fn doc(&mut self, input: ParseStream<'_>) -> Option<(Span, Vec<String>)> {
        let span = self.next(input);
        let text = self.source.get(span.clone())?;
        let lines = match text.get(..3)? {
            "///" | "//!" => vec![doc_line(&text[3..])],
            "/**" | "/*!" => doc_block(text[3..].strip_suffix("*/")?),
            _ => return None,
        };
        self.skip(input);
        if self.peek(input, "!") {
            self.skip(input);
        }
        self.skip(input);
        Some((span, lines))
    }
}

fn doc_line(text: &str) -> String {
    text.strip_prefix(' ').unwrap_or(text).trim_end().to_string()
}

/// Its lines without the stars that they begin with.
fn doc_block(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = text.lines().map(|line| doc_line(line.trim_start().trim_start_matches('*'))).collect();
    while lines.first().is_some_and(String::is_empty) {
        lines.remove(0);
    }
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    lines
}

// ---- refusals

impl Reader<'_> {
    fn refuse(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) -> Refused {
        self.errors.error(span, message).help(help);
        Refused
    }

    fn unexpected(&mut self, input: ParseStream<'_>, expected: &str, help: &str) -> Refused {
        let (span, found) = (self.next(input), self.found(input));
        self.refuse(span, format!("expected {expected}, found {found}"), help)
    }

    fn reserved(&mut self, span: Span, word: &str) -> Refused {
        let help = "see the language's documentation for what it has";
        self.refuse(span, format!("`{word}` is reserved: it is not part of the language yet"), help)
    }

    /// What stands next, for a message.
    fn found(&self, input: ParseStream<'_>) -> String {
        let span = self.next(input);
        match (sign(input.cursor()), self.source.get(span)) {
            (Some((sign, _)), _) => format!("`{sign}`"),
            (None, Some(text)) if !text.is_empty() => {
                let shown: String = text.chars().take(40).collect();
                format!("`{shown}{}`", if shown.len() < text.len() { "…" } else { "" })
            }
            (None, _) => "the end of the file".to_string(),
        }
    }
}

// ---- tokens

/// What stands between two brackets.
struct Group<'t> {
    content: ParseBuffer<'t>,
    /// Where its closing bracket ends.
    end: usize,
}

impl Reader<'_> {
    /// Where the next token stands: of a group its opening bracket, at a group's end its closing bracket.
    fn next(&self, input: ParseStream<'_>) -> Span {
        let span = input.span().byte_range();
        match sign(input.cursor()) {
            Some((sign, _)) if sign.len() > 1 => span.start..span.start + sign.len(),
            _ if input.is_empty() && span == (0..0) => self.last..self.last,
            _ => span,
        }
    }

    /// Whether a line break stands between the last token and the next one.
    fn begins_line(&self, input: ParseStream<'_>) -> bool {
        self.source.get(self.last..self.next(input).start).is_some_and(|between| between.contains('\n'))
    }

    fn peek(&self, input: ParseStream<'_>, text: &str) -> bool {
        sign(input.cursor()).is_some_and(|(found, _)| found == text)
    }

    fn eat(&mut self, input: ParseStream<'_>, text: &str) -> Option<Span> {
        if !self.peek(input, text) {
            return None;
        }
        for _ in text.chars() {
            self.skip(input);
        }
        Some(self.last - text.len()..self.last)
    }

    fn eat_word(&mut self, input: ParseStream<'_>, text: &str) -> bool {
        let found = word(input.cursor()).is_some_and(|(found, _)| found == text);
        if found {
            self.skip(input);
        }
        found
    }

    fn literal(&mut self, input: ParseStream<'_>) -> Option<String> {
        let (literal, _) = input.cursor().literal()?;
        self.skip(input);
        Some(literal.to_string())
    }

    /// Takes one token or one group; answers whether a statement may end with it.
    fn skip(&mut self, input: ParseStream<'_>) -> bool {
        let Ok(token) = input.parse::<TokenTree>() else { return true };
        self.last = token.span().byte_range().end;
        match token {
            TokenTree::Punct(punct) => punct.as_char() == ';',
            TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
            TokenTree::Ident(_) | TokenTree::Literal(_) => false,
        }
    }

    /// Enters the group that comes next; [`Reader::close`] leaves it.
    fn group<'t>(&mut self, input: &'t ParseBuffer<'_>) -> Parsed<Group<'t>> {
        let here = self.next(input);
        self.enter(&here)?;
        match input.parse_any_delimiter() {
            Ok((_, brackets, content)) => {
                self.last = here.end;
                Ok(Group { content, end: brackets.close().byte_range().end })
            }
            Err(_) => Err(self.unexpected(input, "a bracket", "write `(`, `[` or `{`")),
        }
    }

    fn close(&mut self, group: Group<'_>) {
        self.depth -= 1;
        self.last = group.end;
    }

    /// One level deeper; the caller comes back up by itself.
    fn enter(&mut self, here: &Span) -> Parsed<()> {
        self.depth += 1;
        if self.depth <= MAX_DEPTH {
            return Ok(());
        }
        let message = format!("this is nested deeper than {MAX_DEPTH} levels");
        Err(self.refuse(here.clone(), message, "name the inner values with `let`"))
    }
}

fn opens(input: ParseStream<'_>, delimiter: Delimiter) -> bool {
    input.cursor().group(delimiter).is_some()
}

fn word(cursor: Cursor<'_>) -> Option<(String, Cursor<'_>)> {
    let (ident, rest) = cursor.ident()?;
    Some((ident.to_string(), rest))
}

/// Signs of several characters; of two that begin alike the longer one comes first.
const LONG_SIGNS: [&str; 16] =
    ["..=", "..", "**", "+=", "-=", "*=", "/=", "==", "!=", "<=", ">=", "->", "=>", "&&", "||", "::"];

/// Signs of one character.
const SIGNS: &str = "+-*/^=.,;:#!<>%&|@$~?";

/// The sign that stands next, the longest that can be read, and what is behind it.
fn sign(cursor: Cursor<'_>) -> Option<(&'static str, Cursor<'_>)> {
    let (first, rest) = cursor.punct()?;
    let long = || LONG_SIGNS.into_iter().find_map(|text| Some((text, behind(cursor, text)?)));
    let at = SIGNS.find(first.as_char())?;
    let short = (&SIGNS[at..at + 1], rest);
    if first.spacing() == Spacing::Joint { long().or(Some(short)) } else { Some(short) }
}

fn behind<'t>(mut cursor: Cursor<'t>, text: &str) -> Option<Cursor<'t>> {
    for (i, c) in text.chars().enumerate() {
        let (punct, rest) = cursor.punct()?;
        let joined = i + 1 == text.len() || punct.spacing() == Spacing::Joint;
        if punct.as_char() != c || !joined {
            return None;
        }
        cursor = rest;
    }
    Some(cursor)
}

#[cfg(test)]
mod tests {
    use super::super::declaration;
    use super::*;

    /// The statements between the braces of a mechanism.
    fn statements(body: &str) -> Vec<Statement> {
        let source = format!("mechanism A {{ {body} }}");
        match declaration(&source) {
            Ok(declaration) => declaration.statements.clone(),
            Err(errors) => panic!("{}", errors.render("test", &source)),
        }
    }

    fn statement(text: &str) -> StatementKind {
        let mut statements = statements(text);
        assert_eq!(statements.len(), 1, "{text}");
        statements.remove(0).kind
    }

    /// With the operator before its operands, as in `(+ a (* b c))`.
    fn prefix(expression: &Expression) -> String {
        let all = |values: &[Expression]| values.iter().map(prefix).collect::<Vec<_>>().join(" ");
        match &expression.kind {
            ExpressionKind::Number(text) | ExpressionKind::Name(text) => text.clone(),
            ExpressionKind::Negate(value) => format!("(neg {})", prefix(value)),
            ExpressionKind::Binary(operator, left, right) => {
                let sign = match operator {
                    BinaryOperator::Add => "+",
                    BinaryOperator::Sub => "-",
                    BinaryOperator::Mul => "*",
                    BinaryOperator::Div => "/",
                    BinaryOperator::Pow => "^",
                };
                format!("({sign} {} {})", prefix(left), prefix(right))
            }
            ExpressionKind::Call(name, values) => format!("{}({})", name.text, all(values)),
            ExpressionKind::Method(value, name, values) => format!("{}.{}({})", prefix(value), name.text, all(values)),
            ExpressionKind::Field(value, name) => format!("{}.{}", prefix(value), name.text),
            ExpressionKind::Index(value, index) => format!("{}[{}]", prefix(value), prefix(index)),
            ExpressionKind::Array(values) => format!("[{}]", all(values)),
        }
    }

    fn expression(text: &str) -> String {
        match statement(&format!("let x = {text};")) {
            StatementKind::Let { value, .. } => prefix(&value),
            other => panic!("{other:?}"),
        }
    }

    fn unit(text: &str) -> Vec<(String, (i32, i32))> {
        match statement(&format!("coord x: {text};")) {
            StatementKind::Coord(Quantity { unit: Some(unit), .. }) => {
                unit.factors.into_iter().map(|factor| (factor.name.text, factor.exponent)).collect()
            }
            other => panic!("{other:?}"),
        }
    }

    /// Every message with the text that it points at: `text: message; help`.
    fn report(source: &str) -> Vec<String> {
        let errors = declaration(source).err().unwrap_or_default();
        let line = |m: &crate::diagnostic::Diagnostic| {
            format!("{}: {}; {}", &source[m.span.clone()], m.message, m.help.as_deref().unwrap_or("no help"))
        };
        errors.iter().map(line).collect()
    }

    /// The one error in the statements `body`.
    #[track_caller]
    fn refused(body: &str, expected: &str) {
        assert_eq!(report(&format!("mechanism A {{\n{body}\n}}")), [expected], "{body}");
    }

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
    fn reads_declarations() {
        let StatementKind::Param(mass) = statement("param mass[6]: kg = [1, 2];") else { panic!() };
        assert_eq!((mass.name.text.as_str(), mass.length.as_ref().map(prefix)), ("mass", Some("6".to_string())));
        assert_eq!(mass.value.as_ref().map(prefix), Some("[1 2]".to_string()));
        let StatementKind::Param(free) = statement("param free: 1;") else { panic!() };
        assert!(free.value.is_none() && free.unit.unwrap().factors.is_empty());
        let StatementKind::Coord(q) = statement("coord q[2*n]: rad;") else { panic!() };
        assert_eq!(q.length.as_ref().map(prefix), Some("(* 2 n)".to_string()));
        let StatementKind::Input(tau) = statement("input tau: N*m;") else { panic!() };
        assert!(tau.value.is_none() && tau.length.is_none());
        let StatementKind::Const(n) = statement("const n = 6;") else { panic!() };
        assert!(n.unit.is_none() && n.value.is_some());
        let StatementKind::Const(d) = statement("const d[6]: m = [1];") else { panic!() };
        assert!(d.unit.is_some() && d.length.is_some());
    }

    #[test]
    fn reads_other_statements() {
        assert!(matches!(statement("let mut y = 1;"), StatementKind::Let { mutable: true, .. }));
        assert!(matches!(statement("y = 1;"), StatementKind::Assign { name, .. } if name.text == "y"));
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
        let StatementKind::For { variable, start, end, body } = statement("for i in a+1..2*n { y = i; for j in 0 .. i {} }")
        else {
            panic!()
        };
        assert_eq!((variable.text.as_str(), prefix(&start), prefix(&end)), ("i", "(+ a 1)".into(), "(* 2 n)".into()));
        assert_eq!(body.len(), 2);
    }

    #[test]
    fn operators_bind_as_in_textbooks() {
        let check = |text: &str, expected: &str| assert_eq!(expression(text), expected, "{text}");
        check("a + b * c", "(+ a (* b c))");
        check("a - b - c + d", "(+ (- (- a b) c) d)");
        check("a / b / c * d", "(* (/ (/ a b) c) d)");
        check("1/2 * m * v^2", "(* (* (/ 1 2) m) (^ v 2))");
        check("-x^2", "(neg (^ x 2))");
        check("(-x)^2", "(^ (neg x) 2)");
        check("x^-2", "(^ x (neg 2))");
        check("x^-y^z", "(^ x (neg (^ y z)))");
        check("a^b^c", "(^ a (^ b c))");
        check("(a^b)^c", "(^ (^ a b) c)");
        check("-a * b", "(* (neg a) b)");
        check("a * -b", "(* a (neg b))");
        check("a - -b", "(- a (neg b))");
        check("a--b", "(- a (neg b))");
        check("- -a", "(neg (neg a))");
        check("2^x.y", "(^ 2 x.y)");
        check("-q[0]^2", "(neg (^ q[0] 2))");
        check("(a + b) * c", "(* (+ a b) c)");
    }

    #[test]
    fn reads_what_stands_behind_values() {
        let check = |text: &str, expected: &str| assert_eq!(expression(text), expected, "{text}");
        check("v.z", "v.z");
        check("x.y.z", "x.y.z");
        check("a.cross(b).norm()", "a.cross(b).norm()");
        check("a.dot(b, c,)", "a.dot(b c)");
        check("m[1][2]", "m[1][2]");
        check("[a, b][0]", "[a b][0]");
        check("[[1, 0], [0, 1],]", "[[1 0] [0 1]]");
        check("[]", "[]");
        check("f()", "f()");
        check("f(a)", "f(a)");
        check("dt(dt(x))", "dt(dt(x))");
        check("(a + b).norm()", "(+ a b).norm()");
        check("t + world.x + m", "(+ (+ t world.x) m)");
    }

    #[test]
    fn reads_numbers_next_to_points() {
        let check = |text: &str, expected: &str| assert_eq!(expression(text), expected, "{text}");
        check("1.sin()", "1.sin()");
        check("1.0.sin()", "1.0.sin()");
        check("1_000.5", "1000.5");
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

    #[test]
    fn reads_units() {
        let check = |text: &str, expected: &[(&str, (i32, i32))]| {
            let expected: Vec<_> = expected.iter().map(|&(name, exponent)| (name.to_string(), exponent)).collect();
            assert_eq!(unit(text), expected, "{text}");
        };
        check("1", &[]);
        check("kg*m^2/s^2", &[("kg", (1, 1)), ("m", (2, 1)), ("s", (-2, 1))]);
        check("m^(1/2)", &[("m", (1, 2))]);
        check("m^(-3/2)", &[("m", (-3, 2))]);
        check("m^(-3)", &[("m", (-3, 1))]);
        check("1/s", &[("s", (-1, 1))]);
        check("s^-2", &[("s", (-2, 1))]);
        check("1/s^-2", &[("s", (2, 1))]);
        check("J/(kg*K/s)", &[("J", (1, 1)), ("kg", (-1, 1)), ("K", (-1, 1)), ("s", (1, 1))]);
        check("m/s/s", &[("m", (1, 1)), ("s", (-1, 1)), ("s", (-1, 1))]);
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
            "import a;",
            "import: `import` is reserved: it is not part of the language yet; \
             see the language's documentation for what it has",
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
        check("mechanism", ": expected a name after `mechanism`, found the end of the file; a name begins with a letter");
        check(
            "mechanism A",
            ": expected a `{`, found the end of the file; \
             a mechanism's statements stand between braces: `mechanism Name { … }`",
        );
        check(
            "mechanism A B {}",
            "B: expected a `{`, found `B`; a mechanism's statements stand between braces: `mechanism Name { … }`",
        );
        check("mechanism match {}", "match: `match` cannot be declared: it is a keyword of Rust; choose another name, such as `match_`");
        check("#![no_std] mechanism A {}", "#![no_std]: this attribute is not known; the only one is `#![dimensionless]`");
        check(
            "#[dimensionless] mechanism A {}",
            "#[dimensionless]: this attribute is about the whole file; write `#![dimensionless]`",
        );
        check("mechanism A { } }", "}: this `}` closes nothing; leave it out, or write what it is to close");
        check("mechanism A { x = 0b12; }", "0: this is neither a number nor a name nor a sign; numbers are decimal, names plain");
    }

    #[test]
    fn declarations_say_what_they_lack() {
        refused("param length = 1.0;", "param length: `param length` needs a unit; write `param length: m = …;`, `1` for a pure number");
        refused("coord q[6];", "coord q[6]: `coord q[6]` needs a unit; write `coord q[6]: rad;`, `1` for a pure number");
        refused("input u:;", "input u: `input u` needs a unit; write `input u: N;`, `1` for a pure number");
        refused("const n: = 6;", "const n: `const n` has a `:` but no unit; write `const n: m = …;`, or leave the `:` out");
        refused("param l m = 1;", "m: expected `:` and a unit, found `m`; write `param l: m`, `1` for a pure number");
        refused("const n: 1;", "const n: this `const` needs a value; write `const n = …;`, or make it a `param`");
        refused(
            "coord q: rad = 1;",
            "=: `coord q` cannot have a value; \
             leave it out: its initial value is part of the state that a simulation begins with",
        );
        refused("input u: N = 1;", "=: `input u` cannot have a value; leave it out: its value is given while the mechanism moves");
        refused("param : kg = 1;", ":: expected a name after `param`, found `:`; a name begins with a letter");
        refused("param 2m: kg = 1;", "2m: expected a name after `param`, found `2m`; a name begins with a letter");
        refused("param a[1, 2]: m = 1;", ",: an index is one number; write `a[i][j]` for an element of a matrix");
        let value = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
        refused("param a[]: m = 1;", &format!("]: expected a value, found `]`; {value}"));
        refused("param a: m = ;", &format!(";: expected a value, found `;`; {value}"));
        refused("param a: m 1;", "1: expected `=` or `;`, found `1`; write a value behind `=`");
    }

    #[test]
    fn names_are_free_words() {
        let taken = |name: &str, what: &str| {
            let expected = format!("{name}: `{name}` cannot be declared: it is {what}; choose another name, such as `{name}_`");
            refused(&format!("param {name}: m = 1;"), &expected);
            refused(&format!("let mut {name} = 1;"), &expected);
            refused(&format!("output {name} = 1;"), &expected);
            refused(&format!("for {name} in 0..1 {{}}"), &expected);
        };
        for name in ["force", "coord", "prescribed", "in", "mechanism"] {
            taken(name, "a keyword of the language");
        }
        taken("match", "a keyword of Rust");
        taken("t", "the time");
        refused("let _ = 1;", "_: `_` is not a name; a name has at least one letter");
        refused("let r#loop = 1;", "r#loop: `r#loop` is not a name; write `loop_`");
        statement("let force_ = 1;");
        statement("let union = 1;");
    }

    #[test]
    fn units_are_products_of_powers() {
        refused("coord x: N m;", "m: a `*` is missing before the unit `m`; write it as in `N*m`");
        refused("coord x: m^1/2;", "2: `2` is not a unit; numbers belong to the value; write a root as `m^(1/2)`");
        let whole = "write a whole number as in `m^2`, or a fraction as in `m^(1/2)`, up to 100";
        refused("coord x: m^0.5;", &format!("0.5: `0.5` cannot be the exponent of a unit; {whole}"));
        refused("coord x: m^999;", &format!("999: `999` cannot be the exponent of a unit; {whole}"));
        refused("coord x: m^n;", &format!("n: expected the exponent of a unit, found `n`; {whole}"));
        refused("coord x: m^(1/0);", "0: this exponent divides by zero; write a fraction such as `m^(1/2)`");
        refused("coord x: m**2;", "**: `**` is not an operator; write `^` for a power: `x^2`");
        refused("coord x: m*;", ";: expected a unit, found `;`; write a unit such as `kg*m^2/s^2`, `1` for a pure number");
        refused("coord x: (m/s)^2;", "^: a unit in parentheses has no power; write the power of each unit");
    }

    #[test]
    fn energies_are_added_to() {
        refused("kinetic = x;", "=: `kinetic` is a sum that statements add to, `=` does not; write `kinetic += …;`");
        refused("kinetic -= x;", "-=: `kinetic` is a sum that statements add to, `-=` does not; write `kinetic += -(…);`");
        refused("force q[1] = x;", "=: `force q[1]` is a sum that statements add to, `=` does not; write `force q[1] += …;`");
        refused("potential x;", "x: expected `+=`, found `x`; write `potential += …;`");
        refused("kinetc += x;", "kinetc: `kinetc` is not an energy, `+=` cannot change it; did you mean `kinetic`?");
        refused("y -= x;", "y: `y` is not an energy, `-=` cannot change it; write `y = y - …;`");
        refused(
            "force F at p += x;",
            "at: `at` is reserved: it is not part of the language yet; see the language's documentation for what it has",
        );
    }

    #[test]
    fn statements_begin_with_known_words() {
        refused("parm m: kg = 1;", "parm: `parm` begins no statement; did you mean `param`?");
        refused("forse q += 1;", "forse: `forse` begins no statement; did you mean `force`?");
        refused("mechanism B {}", "mechanism: a mechanism stands within a mechanism; write it in a file of its own");
        refused(";", ";: this `;` ends nothing; leave it out");
        refused("output = 1;", "=: expected a name after `output`, found `=`; a name begins with a letter");
        refused("let x: m = 1;", ":: a `let` declares no unit; write `let x = …;`: the unit follows from the value");
        refused("let x += 1;", "+=: expected `=`, found `+=`; write `let x = …;`");
        refused("for i = 0..3 {}", "=: expected `in`, found `=`; write `for i in 0..6 { … }`");
        refused("for i in 3 {}", "{: expected `..`, found `{`; write `for i in 0..6 { … }`");
        refused("for i in 0..=3 {}", "..=: a range ends before its end; write `0..n + 1` for the numbers 0 to n");
        refused("for i in 0..3;", ";: expected a `{`, found `;`; write `for i in 0..6 { … }`");
        refused("#[x] let a = 1;", "#[x]: this attribute is not known; the only one is `#![dimensionless]`");
        refused("#![dimensionless]", "#![dimensionless]: an attribute of the file stands within the mechanism; move it to the top of the file");
        refused("//! doc\nlet a = 1;", "//! doc: this documents the whole file; write `///`, or move it to the top of the file");
        refused(
            "let a = 1; /// doc\nlet b = 2;",
            "/// doc: this would document what follows, not what stands before it; \
             write it on the line before, or as a comment after `//`",
        );
        assert!(report("mechanism A { 1 + 2; }")[0].starts_with("1: expected a statement, found `1`; a statement begins with"));
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
    fn values_are_formulas() {
        let check = |value: &str, expected: &str| refused(&format!("let x = {value};"), expected);
        let value = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
        check("a b", "b: an operator is missing before `b`; write `*` for a product");
        check("2 (a)", "(: only a function's name can stand before `(`; write `*` for a product");
        check("a ** 2", "**: `**` is not an operator; write `^` for a power: `x^2`");
        check("a * * 2", "*: `**` is not an operator; write `^` for a power: `x^2`");
        check("+a", "+: a `+` before a value says nothing; leave it out");
        check("a + + b", "+: a `+` before a value says nothing; leave it out");
        check("a +", &format!(";: expected a value, found `;`; {value}"));
        check("f(a", "(: this `(` is not closed; write `)` before the `;` on line 2");
        check("f(, a)", &format!(",: expected a value, found `,`; {value}"));
        check("()", &format!("): expected a value, found `)`; {value}"));
        check("!a", &format!("!: expected a value, found `!`; {value}"));
        check("{ a }", &format!("{{: expected a value, found `{{`; {value}"));
        check("(a, b)", ",: `,` cannot stand here; write a vector as `[x, y, z]`");
        check("[0; 3]", ";: `;` cannot stand within brackets; write `,` between values");
        check("[a b]", "b: an operator is missing before `b`; write `*` for a product");
        check("a % b", "%: `%` is not an operator; the operators are `+`, `-`, `*`, `/` and `^`");
        check("a < b", "<: comparisons are not part of the language yet; leave it out");
        check("a == b", "==: comparisons are not part of the language yet; leave it out");
        check("a = b", "=: `=` cannot stand behind a value; end the statement before with `;`");
        check("a..b", "..: a range stands behind `in` only; write `for i in 0..6 { … }`");
        check("2 : m", ":: a value has no unit of its own; units belong to declarations, as in `param length: m = 2;`");
        check("a {}", "{: `{` cannot stand behind a value; end the statement with `;`");
        let reserved = "if: `if` is reserved: it is not part of the language yet; see the language's documentation for what it has";
        check("if a", reserved);
        check("a if b", reserved);
        check("force", "force: `force` is a keyword of the language, not a value; write a value here");
        check("true", "true: `true` is a keyword of Rust, not a value; write a value here");
        check("q.0", "0: `.0` is not a component; write `[0]` for the first component, `[1]` for the second");
        check("q.", ";: expected a name after `.`, found `;`; a name begins with a letter");
        check("1.e5", "e5: a number has no component `e5`; write a digit behind the point: `1.0`");
        check(".5", ".: a number begins with a digit; write `0.5`");
        check("1.0f64", "1.0f64: a number has no type; write `1.0`");
        let units = "units belong to declarations, as in `param length: m = 2;`";
        check("2m", &format!("2m: `2m` is neither a number nor a name; write `2 * m` for a product; {units}"));
        check("0x10", "0x10: `0x10` is not a decimal number; write it with digits 0 to 9");
        check("1e400", "1e400: `1e400` is beyond the range of an `f64`; choose other units");
        check("1e-400", "1e-400: `1e-400` is beyond the range of an `f64`; choose other units");
        check("r#a", "r#a: `r#a` is not a name; write `a_`");
        check("x'", "': `'` has no meaning in a mechanism; write `dt(x)` for the time derivative of `x`");
        check("(/*ERROR*/)", "(/*ERROR*/): `(/*ERROR*/)` is not a value; write a number");
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

    /// Runs `test` on a thread with the stack of a test thread, whatever `RUST_MIN_STACK` says.
    fn in_two_mebibytes(test: impl FnOnce() + Send + 'static) {
        std::thread::Builder::new().stack_size(2 << 20).spawn(test).unwrap().join().unwrap();
    }

    #[test]
    fn nesting_is_limited() {
        in_two_mebibytes(|| {
            let kinds = [
                ("(", "x", ")"),
                ("[", "x", "]"),
                ("f(", "x", ")"),
                ("-", "x", ""),
                ("- ", "x", ""),
                ("x^", "x", ""),
                ("x^-", "x", ""),
                ("-(", "x", ")"),
                ("a + b*x^(", "x", ")"),
                ("a[", "x", "]"),
                ("", "x", ".a"),
                ("", "x", ".f()"),
                ("", "x", "[1]"),
                ("x.f(", "1", ")"),
                ("{", "x", "}"),
            ];
            for (before, middle, after) in kinds {
                let nested = |n| format!("mechanism A {{ let x = {}{middle}{}; }}", before.repeat(n), after.repeat(n));
                if before != "{" {
                    assert_eq!(report(&nested(100)), [""; 0], "{before}");
                }
                for n in [255, 256, 257, 1000, 100_000] {
                    let _ = report(&nested(n));
                }
                let errors = report(&nested(1000));
                assert!(before == "{" || errors[0].contains("nested deeper than 256 levels"), "{before} {errors:?}");
            }
            let loops = |n: usize| format!("mechanism A {{ {} {} }}", "for i in 0..1 { ".repeat(n), "}".repeat(n));
            assert_eq!(report(&loops(255)), [""; 0]);
            assert_eq!(report(&loops(256)), ["{: this is nested deeper than 256 levels; name the inner values with `let`"]);
            let units = |n: usize| format!("mechanism A {{ coord x: {}m{}; }}", "1/(".repeat(n), ")".repeat(n));
            assert_eq!(report(&units(255)), [""; 0]);
            assert_eq!(report(&units(100_000)).len(), 1);
        });
    }

    #[test]
    fn the_deepest_expressions_are_read() {
        in_two_mebibytes(|| {
            // One level is the mechanism's braces.
            for (before, after) in [("(", ")"), ("-", ""), ("x^", ""), ("[", "]"), ("a + b*f(", ")")] {
                let nested = |n| format!("mechanism A {{ let x = {}x{}; }}", before.repeat(n), after.repeat(n));
                assert_eq!(report(&nested(255)), [""; 0], "{before}");
                assert_eq!(report(&nested(256)).len(), 1, "{before}");
            }
        });
    }

    #[test]
    fn long_sums_need_no_stack() {
        in_two_mebibytes(|| {
            for term in [" + x", " - x", " * x", " / x", " + 2 * x^2"] {
                let source = format!("mechanism A {{ let y = x{}; }}", term.repeat(100_000));
                let declaration = declaration(&source).unwrap();
                let StatementKind::Let { value, .. } = &declaration.statements[0].kind else { panic!() };
                assert_eq!(value.left_spine().1.len(), 100_000);
                assert_eq!(value.span, 22..source.len() - 3);
            }
            let source = format!("mechanism A {{ let y = x{} x; }}", " + x".repeat(100_000));
            assert_eq!(report(&source).len(), 1);
        });
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
            "mechanism", "A", "{", "}", "(", ")", "[", "]", "param", "coord", "input", "const", "let", "mut", "for", "in",
            "kinetic", "force", "output", "x", "t", "r#x", "_", "=", "+=", "==", "+", "-", "*", "/", "^", "**", ".", "..",
            "..=", ",", ";", ":", "#", "!", "#![dimensionless]", "/// doc\n", "//! doc\n", "/** d */", "// c\n", "/*", "*/",
            "0", "1.", "1.5", "1e", "1e-5", "2m", "0x", "0b2", "r#\"", "\"", "'", "'a'", "'a", "b'", "\\", "θ", "²", "·",
            "q\u{307}", "\r", "\n", "\t", "\0", "\u{feff}", "🦀", "(/*ERROR*/)", "kg", "<", "&", "@", "if", "mechanism A {",
            "let x = ", "param m: kg = 1;", "for i in 0..3 {", "coord q[3]: rad;", "u32", "e5", "$", "?", "~", "|", "%",
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
