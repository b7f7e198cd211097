//! The other languages: one tokenizer and one evaluator with a table of what they differ in.
//!
//! Read are the constructor, the declared parameters, tables, and the functions of the mechanism with their arguments
//! and results. What files bring with them, the same in each, is the tests' affair.
//!
//! - `token`: words, numbers, marks; `routine`: the functions of a text;
//! - `dialect`: what languages differ in; `constructor`: parameters, and what is made of them;
//! - `value`, `expression`, `statement`: what is computed;
//! - `result`: what functions are to give.

mod constructor;
mod dialect;
mod expression;
mod result;
mod routine;
mod statement;
#[cfg(test)]
mod tests;
mod token;
mod value;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::emit::{Language, Options};
use crate::expr::Trigonometry;
use crate::optimise::{Argument, Completion, Derivation, Function, FunctionKind};
use crate::shape::Shape;
use crate::verify::Failure;

use super::meaning::Expectation;
use super::misprint;
use super::numbering::Numbering;
use super::reader::Reading;
use dialect::{Dialect, Family};
use expression::{Method, Reader, Surroundings, table};
use routine::{Routine, routines, spaced, written};
use token::{Token, tokens};
use value::{Value, output};

/// Reads a text in another language than Rust.
pub(super) fn proofread(
    derivation: &Derivation,
    language: Language,
    options: &Options,
    code: &str,
) -> Result<(), Failure> {
    let Some(dialect) = Dialect::of(language, options.trigonometry) else { return Ok(()) };
    let in_text = |what| misprint("text", what);
    let tokens = tokens(code, &dialect.lexis).map_err(in_text)?;
    let routines = routines(&dialect, &tokens).map_err(in_text)?;
    let mut numbering = Numbering::default();
    numbering.divide_for_sech(dialect.family != Family::C);
    let expectation = Expectation::new(derivation, &mut numbering);
    let surroundings = Surroundings::default();
    let mut text = Foreign {
        derivation,
        dialect,
        tokens: &tokens,
        routines,
        prefix: String::new(),
        numbering,
        expectation,
        surroundings,
        itself: Value::Unset,
    };
    if dialect.family == Family::C {
        text.prefix(options, code).map_err(in_text)?;
    }
    text.tables().map_err(|what| misprint("tables", what))?;
    text.constructor().map_err(|what| misprint("new", what))?;
    text.functions(options)
}

struct Foreign<'d, 't> {
    derivation: &'d Derivation,
    dialect: Dialect,
    tokens: &'t [Token<'t>],
    routines: BTreeMap<&'t str, Option<Routine<'t, 't>>>,
    /// What names of a header begin with.
    prefix: String,
    numbering: Numbering,
    expectation: Expectation<'d>,
    surroundings: Surroundings,
    /// The mechanism, as functions see it.
    itself: Value,
}

impl<'d, 't> Foreign<'d, 't> {
    fn routine(&self, name: &str) -> Reading<Routine<'t, 't>> {
        let found = self.routines.get(name).ok_or_else(|| format!("`{name}` is missing"))?;
        found.ok_or_else(|| format!("`{name}` is there twice"))
    }

    fn reader<'r>(&'r mut self, tokens: &'r [Token<'t>], names: HashMap<String, Value>) -> Reader<'r, 't> {
        Reader {
            dialect: &self.dialect,
            surroundings: &self.surroundings,
            numbering: &mut self.numbering,
            tokens,
            at: 0,
            names,
            changes: Vec::new(),
            sides: 0,
            looked_at: BTreeSet::new(),
        }
    }

    /// The tokens behind a text that they begin with.
    fn behind(&self, tokens: &'t [Token<'t>], text: &str) -> Reading<&'t [Token<'t>]> {
        let expected = token::tokens(text, &self.dialect.lexis)?;
        let mut rest = tokens;
        for token in expected.iter().filter(|token| token.kind != token::Kind::End) {
            let ends = rest.iter().take_while(|token| token.kind == token::Kind::End).count();
            rest = &rest[ends..];
            match rest.split_first() {
                Some((found, behind)) if found.text == token.text => rest = behind,
                found => {
                    let found = found.map_or("the end", |(found, _)| found.text);
                    return Err(format!("`{found}` instead of `{}` in `{text}`", token.text));
                }
            }
        }
        Ok(rest)
    }

    /// What the names of a header begin with; whose sines it has.
    fn prefix(&mut self, options: &Options, code: &str) -> Reading<()> {
        let mut known = self.routines.iter().filter_map(|(name, new)| Some((name, (*new)?)));
        let new = known.find(|(name, new)| **name == format!("{}_new", written(new.head)));
        self.prefix = new.map(|(_, new)| written(new.head)).ok_or("there is no constructor")?;
        let is_library = code.contains("#ifndef MBS_LIBRARY_TRIGONOMETRY\n#define MBS_LIBRARY_TRIGONOMETRY\n#endif\n");
        if is_library != (options.trigonometry == Trigonometry::Library) {
            return Err("sines are those of another library".to_string());
        }
        Ok(())
    }

    // ---- tables

    fn tables(&mut self) -> Reading<()> {
        self.surroundings.constants.insert("None".to_string(), Value::Text("None".to_string()));
        for number in 0..self.derivation.splines().len() {
            match self.dialect.family {
                Family::C => self.table_of_c(number)?,
                Family::Matlab => {}
                Family::Js | Family::Python => {
                    for part in ["PLACES", "ROWS"] {
                        let name = format!("TABLE_{number}_{part}");
                        let value = self.constant(&name)?;
                        self.surroundings.constants.insert(name, value);
                    }
                }
            }
        }
        Ok(())
    }

    /// The value of `NAME = …`, of which NumPy makes an array.
    fn constant(&mut self, name: &str) -> Reading<Value> {
        let is_it = |pair: &[Token<'_>]| pair[0].is(name) && pair[1].is("=");
        let at = self.tokens.windows(2).position(is_it).ok_or_else(|| format!("`{name}` is missing"))?;
        let tokens = &self.tokens[at + 2..];
        if self.dialect.family == Family::Python {
            let tokens = self.behind(tokens, "np.array(")?;
            return self.reader(tokens, HashMap::new()).expression();
        }
        self.reader(tokens, HashMap::new()).expression()
    }

    /// `static const mbs_real table_places[…] = {…}` and so on, in the function or before it.
    fn table_of_c(&mut self, number: usize) -> Reading<()> {
        let name = format!("{}_table_{number}", self.prefix);
        let list = |part: &str, text: &mut Self| {
            let full = format!("{name}_{part}");
            let is_it = |window: &[Token<'_>]| window[0].is("mbs_real") && window[1].is(&full) && window[2].is("[");
            let at = text.tokens.windows(3).position(is_it).ok_or_else(|| format!("`{full}` is missing"))?;
            let tokens = &text.tokens[at + 3..];
            let mut reader = text.reader(tokens, HashMap::new());
            let count = reader.expression()?;
            reader.expect("]")?;
            reader.expect("=")?;
            match (reader.expression()?, count) {
                (Value::Array(values), Value::Integer(count)) if values.len() == count => Ok(values),
                _ => Err(format!("`{full}` has another number of entries")),
            }
        };
        let (places, rows) = (list("places", self)?, list("rows", self)?);
        let columns = rows.len() / (places.len() + 1);
        let call = format!("return mbs_spline({}, {name}_places, {columns}, {name}_rows, order, x);", places.len());
        let body = written(self.routine(&name)?.body);
        if !body.ends_with(&spaced(&self.dialect, &call)?) {
            return Err(format!("`{name}` evaluates something else"));
        }
        let rows = rows.chunks(columns.max(1)).map(|row| Value::Array(row.to_vec())).collect();
        let number = table(&mut self.numbering, &Value::Array(places), &Value::Array(rows));
        self.surroundings.tables.insert(name, number.ok_or("a table has no numbers")?);
        Ok(())
    }

    /// An error unless a text is what it should be.
    fn look_at(&self, found: &str, expected: &str) -> Reading<()> {
        let expected = spaced(&self.dialect, expected)?;
        if found == expected { Ok(()) } else { Err(format!("`{found}` instead of `{expected}`")) }
    }

    // ---- functions

    /// The name of a function in the text: as it is, or what the language makes of it.
    fn name_of(&self, name: &str) -> Option<&'t str> {
        let prefix = &self.prefix;
        let candidates = match self.dialect.family {
            Family::C => [format!("{prefix}_{name}"), format!("{prefix}_{name}_2")],
            Family::Js => [name.to_string(), format!("{name}_2")],
            Family::Python => [name.to_string(), format!("py_{name}")],
            Family::Matlab => [format!("f_{name}"), format!("m_f_{name}")],
        };
        let is_own = |candidate: &String| match (self.dialect.family, name) {
            (Family::C, "check" | "new" | "parameters" | "default_parameters" | "constrained_solution") => {
                candidate.ends_with("_2")
            }
            (Family::Js, "constructor") | (Family::Python, "coordinates" | "inputs") => candidate != name,
            _ => true,
        };
        let known = candidates.iter().filter(|name| is_own(name)).find_map(|name| self.routines.get_key_value(&**name));
        let long = || {
            let start = format!("f_{name}");
            let mut all = self.routines.iter().filter(|(name, _)| name.len() == 63 && start.starts_with(&name[..54]));
            all.next().filter(|_| start.len() > 63)
        };
        let second = || self.routines.get_key_value(&*format!("{name}_2"));
        known.or_else(long).or_else(second).map(|(name, _)| *name)
    }

    fn functions(&mut self, options: &Options) -> Result<(), Failure> {
        let is_asked_for = |f: &Function| options.functions.as_ref().is_none_or(|names| names.contains(&f.name));
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        let mut found = Vec::new();
        for function in &self.derivation.functions {
            let times = seen.entry(&function.name).and_modify(|times| *times += 1).or_insert(1);
            let name = if *times > 1 { format!("{}_{times}", function.name) } else { function.name.clone() };
            // What Rust cannot escape has a line behind.
            match self.name_of(&name).or_else(|| self.name_of(&format!("{name}_"))) {
                Some(name) => found.push((function, name)),
                None if is_asked_for(function) => return Err(misprint(&function.name, "it is missing".to_string())),
                None => {}
            }
        }
        let motion = self.declare(&found).map_err(|what| misprint("constrained_motion", what))?;
        for (function, name) in found {
            let read = self.routine(name).and_then(|routine| self.function(function, routine, false));
            read.map_err(|what| misprint(&function.name, what))?;
        }
        if let Some((function, name)) = motion {
            let read = self.routine(name).and_then(|routine| self.function(function, routine, true));
            read.map_err(|what| misprint("constrained_motion", what))?;
        }
        Ok(())
    }

    /// Makes known what functions give when others call them; the motion with constraints, if it is there.
    fn declare(&mut self, found: &[(&'d Function, &'t str)]) -> Reading<Option<(&'d Function, &'t str)>> {
        let Some(forward_dynamics) = self.derivation.function(FunctionKind::ForwardDynamics) else { return Ok(None) };
        let arguments = self.expectation.arguments(forward_dynamics, &mut self.numbering);
        let arguments: Vec<Value> = arguments.iter().map(|(name, value)| self.given(name, value)).collect();
        let itself = match self.dialect.family {
            Family::C => Some(self.itself.clone()),
            Family::Matlab => Some(Value::Text("c".to_string())),
            Family::Js | Family::Python => None,
        };
        let arguments = itself.into_iter().chain(arguments).collect();
        let [accelerations, multipliers] = [Argument::Qdd, Argument::Multipliers]
            .map(|argument| Value::from(&self.expectation.of_the_motion(argument, &mut self.numbering)));
        if !forward_dynamics.completion.is_constrained() {
            let own = found.iter().find(|(function, _)| function.kind == FunctionKind::ForwardDynamics);
            if let Some((_, name)) = own {
                let is_written = self.dialect.family == Family::C;
                let result = if is_written { Value::Array(vec![accelerations]) } else { accelerations };
                self.surroundings.methods.insert((*name).to_string(), Method { arguments, result });
            }
            return Ok(None);
        }
        if !found.iter().any(|(function, _)| function.completion.is_constrained()) {
            return Ok(None);
        }
        let name = match self.dialect.family {
            Family::Js => "#constrained_motion",
            Family::Python => "_constrained_motion",
            Family::C | Family::Matlab => "constrained_motion",
        };
        let result = match self.dialect.family {
            Family::C | Family::Python => Value::Array(vec![accelerations, multipliers]),
            Family::Js => Value::Struct([("qdd".into(), accelerations), ("multipliers".into(), multipliers)].into()),
            Family::Matlab => Value::Struct([(output(1), accelerations), (output(2), multipliers)].into()),
        };
        let is_taken = found.iter().any(|(function, _)| function.name == "constrained_motion");
        let name = if is_taken { format!("{name}_2") } else { name.to_string() };
        let name = self.name_of(&name).ok_or("it is missing")?;
        self.surroundings.methods.insert(name.to_string(), Method { arguments, result });
        Ok(Some((forward_dynamics, name)))
    }

    /// An argument as this language has it.
    fn given(&self, name: &str, meaning: &super::meaning::Meaning) -> Value {
        let value = Value::from(meaning);
        match (self.dialect.family, name) {
            (Family::C, "prescribed") => value.flat().map_or(Value::Unset, Value::Array),
            _ => value,
        }
    }

    /// One function, or the motion with constraints.
    fn function(&mut self, function: &'d Function, routine: Routine<'t, 't>, is_motion: bool) -> Reading<()> {
        let all = self.expectation.arguments(function, &mut self.numbering);
        // Of no multipliers there is no argument.
        let arguments: Vec<(&str, Value)> = all
            .iter()
            .map(|(name, meaning)| (*name, self.given(name, meaning)))
            .filter(|(_, value)| !matches!(value, Value::Array(entries) if entries.is_empty()))
            .collect();
        let outputs = self.outputs(function, is_motion);
        let sized = self.sized(function, is_motion, &arguments);
        self.look_at(&written(routine.arguments), &self.head(&arguments, &outputs))?;
        let mut names: HashMap<String, Value> =
            arguments.into_iter().map(|(name, value)| (name.to_string(), value)).collect();
        names.insert(self.dialect.itself.to_string(), self.itself.clone());
        if self.dialect.family == Family::C {
            for (name, count) in &outputs {
                names.insert(name.clone(), Value::Array(vec![Value::Unset; *count]));
            }
        }
        let body = match self.dialect.family {
            Family::Python => self.without_batch(routine.body, &self.batch(&all)?),
            Family::C | Family::Js | Family::Matlab => routine.body.to_vec(),
        };
        if body.len() < routine.body.len() {
            names.insert("batch".to_string(), Value::Text("batch".to_string()));
        }
        if self.dialect.family == Family::Matlab {
            let list: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
            let expected =
                if let [one] = list.as_slice() { (*one).to_string() } else { format!("[{}]", list.join(", ")) };
            self.look_at(&written(routine.head), &expected)?;
        }
        let mut reader = self.reader(&body, names);
        let returned = reader.body()?;
        let mut names = std::mem::take(&mut reader.names);
        if reader.looked_at != sized {
            return Err("it looks at the sizes of other arguments than it takes".to_string());
        }
        let is_written = match self.dialect.family {
            Family::C => !outputs.is_empty(),
            Family::Matlab => true,
            Family::Js | Family::Python => false,
        };
        let found = match (is_written, returned) {
            (true, None) => {
                let given = outputs.iter().map(|(name, _)| names.remove(name).unwrap_or(Value::Unset));
                Value::Array(given.collect())
            }
            (false, Some(value)) => value,
            (true, Some(_)) => return Err("it returns a value".to_string()),
            (false, None) => return Err("it returns nothing".to_string()),
        };
        let expected = self.expected(function, is_motion)?;
        let found = if self.is_flat(function, is_motion) { flattened(&found)? } else { found };
        self.compare(&found, &expected)
    }

    /// Whether results are compared number by number, whatever their shape is.
    fn is_flat(&self, function: &Function, is_motion: bool) -> bool {
        let is_written = matches!(self.dialect.family, Family::C | Family::Matlab);
        let is_of_motion = self.is_of_the_motion(function);
        is_written
            && !is_motion
            && !self.outputs(function, false).is_empty()
            && (function.completion == Completion::None || is_of_motion)
    }

    /// The names of what a function writes, and how many numbers each is.
    fn outputs(&self, function: &Function, is_motion: bool) -> Vec<(String, usize)> {
        let (n, rows) = (self.derivation.dof(), self.derivation.constraints.len());
        let is_c = self.dialect.family == Family::C;
        if is_motion {
            let names = if is_c { ["accelerations", "forces"] } else { ["qdd", "multipliers"] };
            return names.map(String::from).into_iter().zip([n, rows]).collect();
        }
        if is_c && matches!(function.results.as_slice(), [part] if part.shape == Shape::Scalar) {
            return Vec::new();
        }
        let name = |part: &str| if part.is_empty() { "result".to_string() } else { format!("by_{part}") };
        let parts = function.results.iter().map(|part| (name(part.name), part.shape.entries()));
        parts.filter(|(_, count)| !is_c || *count > 0).collect()
    }

    /// What stands in the brackets of a function.
    fn head(&self, arguments: &[(&str, Value)], outputs: &[(String, usize)]) -> String {
        let names = arguments.iter().map(|(name, _)| (*name).to_string());
        let first = match self.dialect.family {
            Family::Js => None,
            Family::Python | Family::Matlab => Some(self.dialect.itself.to_string()),
            Family::C => {
                let input = |(name, value): &(&str, Value)| match value {
                    Value::Array(entries) => format!("const mbs_real {name}[{}]", entries.len()),
                    _ => format!("mbs_real {name}"),
                };
                let inputs = arguments.iter().map(input);
                let outputs = outputs.iter().map(|(name, count)| format!("mbs_real {name}[{count}]"));
                let first = [format!("const {} *self", self.prefix)];
                return first.into_iter().chain(inputs).chain(outputs).collect::<Vec<_>>().join(", ");
            }
        };
        first.into_iter().chain(names).collect::<Vec<_>>().join(", ")
    }

    /// What the axes of a batch of NumPy are.
    fn batch(&self, arguments: &[(&str, super::meaning::Meaning)]) -> Reading<String> {
        let shapes = arguments.iter().filter_map(|(name, meaning)| match (*name, Value::from(meaning)) {
            ("prescribed", _) => Some("prescribed.shape[:-2]".to_string()),
            (_, Value::Array(entries)) if entries.is_empty() => None,
            (name, Value::Array(_)) => Some(format!("{name}.shape[:-1]")),
            (name, _) => Some(format!("{name}.shape")),
        });
        let shapes: Vec<String> = shapes.collect();
        spaced(&self.dialect, &format!("batch = np.broadcast_shapes({})", shapes.join(", ")))
    }

    /// A body without the line that says what the batch is.
    fn without_batch(&self, body: &[Token<'t>], batch: &str) -> Vec<Token<'t>> {
        let lines: Vec<&[Token<'t>]> = body.split_inclusive(|token| token.kind == token::Kind::End).collect();
        match lines.iter().position(|line| written(line) == batch) {
            Some(at) => [lines[..at].concat(), lines[at + 1..].concat()].concat(),
            None => body.to_vec(),
        }
    }

    /// The arguments whose sizes a function must look at; one that calls another leaves that to it.
    fn sized(&self, function: &Function, is_motion: bool, arguments: &[(&str, Value)]) -> BTreeSet<String> {
        let is_looked_at = |value: &Value| match self.dialect.family {
            Family::C => false,
            Family::Js => matches!(value, Value::Array(_)),
            Family::Python | Family::Matlab => true,
        };
        let of_the_motion = !is_motion && self.is_of_the_motion(function);
        let arguments = arguments.iter().filter(|(_, value)| !of_the_motion && is_looked_at(value));
        arguments.map(|(name, _)| (*name).to_string()).collect()
    }

    /// Whether a function gives a part of the motion with constraints.
    fn is_of_the_motion(&self, function: &Function) -> bool {
        function.completion == Completion::SolveMultipliers
            || (function.kind == FunctionKind::ForwardDynamics && function.completion.is_constrained())
    }
}

fn flattened(value: &Value) -> Reading<Value> {
    match value {
        Value::Array(_) | Value::Struct(_) => value.flat().map(Value::Array),
        other => Ok(Value::Array(vec![other.clone()])),
    }
}
