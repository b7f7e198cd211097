//! The other languages: what a text is to be is written once more from the derivation, with slots where values are
//! computed, and the emitted text is read along it, token by token.
//!
//! Outside of slots, each token is compared: heads, arguments, results, calls of solvers, wrappers. In slots stand
//! statements, which give names values, and expressions, whose value is to be that of the Program. So every token is
//! read but for comments and documentation. What files of a language share is compared with what it is kept as.
//!
//! - `dialect`: what languages differ in;
//! - `expression`, `statement`, `loops`: what is computed;
//! - `sheet`: what functions are to give, with slots for it;
//! - `c`, `js`, `python`, `matlab`: how a language writes that.

mod c;
mod dialect;
mod expression;
mod js;
mod loops;
mod matlab;
mod python;
mod sheet;
mod statement;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use crate::emit::{self, Language, Options};
use crate::optimise::Derivation;
use crate::verify::Failure;

use super::misprint;
use super::numbering::{Number, Numbering};
use super::reading::Reading;
use super::token::{Kind, Token, tokens};
use dialect::{Dialect, Family};
use expression::Reader;
use sheet::Sheet;

/// Reads a text in another language than Rust.
pub(super) fn proofread(
    derivation: &Derivation,
    language: Language,
    options: &Options,
    code: &str,
) -> Result<(), Failure> {
    read(derivation, language, options, code, None)
}

/// Reads the header of an interface and what follows it, with the operands of what this mechanism compares.
pub(super) fn proofread_interface(derivation: &Derivation, interface: &emit::Interface) -> Result<(), Failure> {
    let code = [interface.header.as_str(), &interface.definitions].concat();
    read(&interface.told, Language::C, &Options::default(), &code, Some(derivation))
}

fn read(
    derivation: &Derivation,
    language: Language,
    options: &Options,
    code: &str,
    compared: Option<&Derivation>,
) -> Result<(), Failure> {
    let Some(dialect) = Dialect::of(language, options.trigonometry) else { return Ok(()) };
    let mut numbering = Numbering::default();
    numbering.divide_for_sech(dialect.family != Family::C);
    let sheet = Sheet::new(derivation, dialect, options, &mut numbering).map_err(|what| misprint("text", what))?;
    let in_text = |what| misprint("text", what);
    let expected = match dialect.family {
        Family::C => c::text(sheet, compared),
        Family::Js => js::text(sheet),
        Family::Python => python::text(sheet),
        Family::Matlab => matlab::text(sheet),
    };
    let found = tokens(code, &dialect.lexis).map_err(in_text)?;
    if dialect.family == Family::Js && returns_nothing(code) {
        return Err(in_text("a line ends behind `return`".to_string()));
    }
    let template = tokens(&expected.text, &dialect.lexis).map_err(in_text)?;
    let reader = Reader {
        dialect: &dialect,
        tables: derivation.splines().iter().map(|spline| numbering.table(spline.places(), spline.rows())).collect(),
        numbering: &mut numbering,
        tokens: &found,
        at: 0,
        table: expected.table.clone(),
        names: HashMap::new(),
        kept: HashMap::new(),
        turn: None,
        hoisted: HashMap::new(),
        declared: Vec::new(),
        given: Vec::new(),
        is_constructor: false,
    };
    let mut comparison =
        Comparison { reader, sheet: &expected, function: "text".to_string(), counted: None, known: HashSet::new() };
    let compared = comparison.compare(&template);
    compared.map_err(|what| misprint(&comparison.function, what))
}

/// Whether the end of a line ends a statement that was to return something.
fn returns_nothing(code: &str) -> bool {
    code.lines().any(|line| line.trim_end().ends_with(" return"))
}

/// A text beside what it is to be.
struct Comparison<'c, 't> {
    reader: Reader<'c, 't>,
    sheet: &'c sheet::Expected,
    /// Where in the text it is.
    function: String,
    /// How many numbers a mechanism is said to be.
    counted: Option<usize>,
    /// The words of what files of the language share.
    known: HashSet<&'static str>,
}

impl Comparison<'_, '_> {
    fn compare(&mut self, template: &[Token<'_>]) -> Reading<()> {
        for (i, token) in template.iter().enumerate() {
            if token.kind != Kind::Slot {
                self.literal(token)?;
                continue;
            }
            let slot = token.text.trim_matches(['⟨', '⟩']);
            match slot.split_once(' ').unwrap_or((slot, "")) {
                ("", _) if let Some((array, _)) = template.get(i + 1).and_then(stored) => {
                    self.reader.statements(|reader| reader.is_storing(array))?;
                }
                ("", _) => {
                    let begins = |token: &&Token<'_>| token.text.starts_with("⟨function");
                    let behind = template[i + 1..].iter().filter(|token| !begins(token)).copied();
                    let run: Vec<Token<'_>> = behind.take_while(|token| token.kind != Kind::Slot).collect();
                    self.reader.statements(|reader| follows(reader, &run))?;
                }
                ("stored", _) => {
                    let (array, slots) = stored(token).ok_or("a slot names no array")?;
                    self.stored(array, slots)?;
                }
                ("function", number) => self.enter(number.parse().unwrap_or_default()),
                ("fields", _) => self.fields()?,
                ("count", parameters) => {
                    let count = self.directive_count()?;
                    self.counted = count.checked_sub(parameters.parse().unwrap_or_default());
                }
                ("shared", _) => self.shared()?,
                ("imports", _) => self.imports()?,
                (number, _) => {
                    let slot = number.parse::<usize>().map_err(|_| "a slot is not numbered")?;
                    let found = self.reader.expression()?;
                    self.is_expected(found, slot)?;
                }
            }
        }
        self.function = "text".to_string();
        if self.reader.peek().is_some() {
            return self.reader.unknown();
        }
        self.finished()
    }

    /// An error unless it is what is to stand in this slot.
    fn is_expected(&mut self, found: Number, slot: usize) -> Reading<()> {
        let (expected, numbering) = (self.sheet.numbers[slot], &self.reader.numbering);
        if found == expected {
            return Ok(());
        }
        let [found, expected] = numbering.difference(found, expected).map(|number| numbering.shown(number));
        Err(format!("`{found}` instead of `{expected}`"))
    }

    /// What is written to an array of the caller: one number after the other, or all of them in a loop.
    fn stored(&mut self, array: &str, slots: Range<usize>) -> Reading<()> {
        if self.reader.is_next("for") {
            for (found, slot) in self.reader.kept_in_loop(array, slots.len())?.into_iter().zip(slots) {
                self.is_expected(found, slot)?;
            }
            return Ok(());
        }
        for (place, slot) in slots.enumerate() {
            [array, "[", &place.to_string(), "]", "="].into_iter().try_for_each(|word| self.reader.expect(word))?;
            let found = self.reader.expression()?;
            self.is_expected(found, slot)?;
            self.reader.expect(";")?;
        }
        Ok(())
    }

    /// A token that is to be there as it is.
    fn literal(&mut self, expected: &Token<'_>) -> Reading<()> {
        let is_it = |token: &Token<'_>| (token.kind, token.text) == (expected.kind, expected.text);
        let reader = &mut self.reader;
        // A list with an entry a line has a comma behind the last one.
        let may_trail = matches!(reader.dialect.family, Family::Js | Family::Python);
        if may_trail
            && matches!(expected.text, ")" | "]" | "}")
            && reader.is_next(",")
            && reader.tokens.get(reader.at + 1).is_some_and(is_it)
        {
            reader.at += 1;
        }
        match reader.peek() {
            Some(found) if is_it(&found) => {
                reader.at += 1;
                Ok(())
            }
            found => {
                let before =
                    reader.tokens[reader.at.saturating_sub(3)..reader.at].iter().map(|token| token.text.trim());
                let before: Vec<&str> = before.collect();
                let found = found.map_or("nothing", |token| token.text.trim());
                Err(format!("`{found}` instead of `{}` behind `{}`", expected.text.trim(), before.join(" ")))
            }
        }
    }

    /// From here on it is this function.
    fn enter(&mut self, number: usize) {
        let scope = &self.sheet.scopes[number];
        self.function.clone_from(&scope.function);
        self.reader.names = scope.names.iter().cloned().collect();
        self.reader.kept.clear();
        self.reader.is_constructor = scope.is_constructor;
    }

    /// The fields of what the constructor computes.
    fn fields(&mut self) -> Reading<()> {
        let reader = &mut self.reader;
        loop {
            let own = match reader.peek() {
                Some(Token { kind: Kind::Name, text: "mbs_real", .. }) => {
                    reader.at += 1;
                    reader.name()?
                }
                Some(Token { kind: Kind::Name, text, .. }) if text.starts_with('#') => {
                    reader.at += 1;
                    &text[1..]
                }
                _ => return Ok(()),
            };
            reader.declared.push(own);
            reader.expect(";")?;
        }
    }

    /// `#define SPRING_NUMBERS 5`
    fn directive_count(&mut self) -> Reading<usize> {
        let (reader, name) = (&mut self.reader, &self.sheet.numbers_name);
        let directive = reader.peek().filter(|token| token.kind == Kind::Directive);
        let count = directive
            .and_then(|token| token.text.strip_prefix("#define ")?.strip_prefix(name.as_str())?.trim().parse().ok());
        reader.at += 1;
        count.ok_or_else(|| format!("`{name}` is missing"))
    }

    /// The modules that Python imports.
    fn imports(&mut self) -> Reading<()> {
        let reader = &mut self.reader;
        for (module, line) in [
            ("math", "import math"),
            ("dataclass", "from dataclasses import dataclass"),
            ("SimpleNamespace", "from types import SimpleNamespace"),
            ("NamedTuple", "from typing import NamedTuple"),
        ] {
            let line = tokens(line, &reader.dialect.lexis)?;
            let is_there = follows(reader, &line);
            if is_there {
                reader.at += line.len();
            }
            let mut behind = reader.tokens[reader.at.min(reader.tokens.len())..].iter();
            if is_there != behind.any(|token| token.kind == Kind::Name && token.text.split('.').next() == Some(module))
            {
                return Err(format!("`{module}` is imported without need, or not where there is need"));
            }
        }
        Ok(())
    }

    /// What files of the language share: whole pieces, in their order.
    fn shared(&mut self) -> Reading<()> {
        let reader = &mut self.reader;
        for piece in emit::shared(reader.dialect.language) {
            let piece = tokens(piece, &reader.dialect.lexis)?;
            if !piece.is_empty() && follows(reader, &piece) {
                reader.at += piece.len();
                let words = piece.iter().flat_map(|token| token.text.split(|c: char| !c.is_alphanumeric() && c != '_'));
                self.known.extend(words.filter(|word| word.to_lowercase().starts_with("mbs_")));
            }
        }
        Ok(())
    }

    /// What concerns the text as a whole.
    fn finished(&self) -> Reading<()> {
        let reader = &self.reader;
        if reader.dialect.has_choices && reader.declared != reader.given {
            return Err("the constructor makes other fields than there are".to_string());
        }
        if self.counted.is_some_and(|count| count != reader.declared.len()) {
            return Err("a mechanism is of another number of numbers".to_string());
        }
        // What is called is there.
        let called = reader.tokens.iter().zip(reader.tokens.iter().skip(1)).filter(|(_, next)| next.is("("));
        let is_known = |name: &str| self.known.contains(name) || self.sheet.own.contains(name);
        let is_missing = |name: &&str| name.to_lowercase().starts_with("mbs_") && !is_known(name);
        let names = called.map(|(token, _)| token.text.split('.').next().unwrap_or_default());
        match names.filter(|name| !["mbs_self", "mbs_result", "mbs_fmu_switches"].contains(name)).find(is_missing) {
            Some(name) => Err(format!("`{name}` is missing")),
            None => Ok(()),
        }
    }
}

/// `⟨stored result 7 12⟩`: the array, and the slots from one to another of what is written to it.
fn stored<'s>(slot: &Token<'s>) -> Option<(&'s str, Range<usize>)> {
    let mut words = slot.text.strip_prefix("⟨stored ")?.strip_suffix('⟩')?.split(' ');
    let array = words.next()?;
    let [first, end] = [words.next()?, words.next()?].map(|word| word.parse().ok());
    Some((array, first?..end?))
}

/// Whether these tokens come next.
fn follows(reader: &Reader<'_, '_>, expected: &[Token<'_>]) -> bool {
    let found = reader.tokens[reader.at.min(reader.tokens.len())..].iter();
    let same = found.zip(expected).take_while(|(a, b)| (a.kind, a.text) == (b.kind, b.text)).count();
    same == expected.len()
}
