//! Parameters of a mechanism, and what its constructor makes of them.

use std::collections::{BTreeMap, HashMap};

use super::super::meaning::{Meaning, nested};
use super::super::numbering::Number;
use super::super::reader::Reading;
use super::Foreign;
use super::dialect::Family;
use super::routine::{spaced, written};
use super::token::{self, Token};
use super::value::Value;

impl<'t> Foreign<'_, 't> {
    /// The parameters' values, as functions see them, by the names of their fields.
    fn parameters(&mut self, fields: &[String]) -> Reading<Value> {
        let parameters = &self.derivation.parameters;
        if fields.len() != parameters.len() {
            return Err(format!("there are {} parameters instead of {}", fields.len(), parameters.len()));
        }
        let mut all = BTreeMap::new();
        for (parameter, field) in parameters.iter().zip(fields) {
            // Names that are longer than the language allows are cut.
            let start = parameter.name.get(..40).filter(|_| field.len() > 60);
            if !field.contains(start.unwrap_or(&parameter.name)) {
                return Err(format!("`{field}` instead of `{}`", parameter.name));
            }
            all.insert(field.clone(), Value::from(&self.expectation.parameter(parameter, &mut self.numbering)));
        }
        if all.len() != parameters.len() {
            Err("two parameters have one name".to_string())
        } else {
            Ok(Value::Struct(all))
        }
    }

    /// The declared values, in the order of the declaration.
    fn defaults(&mut self) -> Vec<Value> {
        let mut defaults = Vec::new();
        for parameter in &self.derivation.parameters {
            let numbers: Vec<Number> =
                parameter.defaults.iter().map(|value| self.numbering.constant(value.to_f64())).collect();
            let mut numbers = numbers.into_iter().map(Meaning::Number);
            defaults.push(Value::from(&nested(&parameter.lengths(), &mut numbers)));
        }
        defaults
    }

    pub(super) fn compare(&self, found: &Value, expected: &Value) -> Reading<()> {
        found.difference(expected, &self.numbering).map_or(Ok(()), Err)
    }

    pub(super) fn constructor(&mut self) -> Reading<()> {
        self.itself = match self.dialect.family {
            Family::C => self.constructor_of_c()?,
            Family::Js => self.constructor_of_js()?,
            Family::Python => self.constructor_of_python()?,
            Family::Matlab => self.constructor_of_matlab()?,
        };
        Ok(())
    }

    fn constructor_of_c(&mut self) -> Reading<Value> {
        let prefix = self.prefix.clone();
        let mut fields = self.fields_of_c(&format!("{prefix}_parameters"))?;
        let mut defaults = self.defaults();
        if defaults.is_empty() {
            defaults.push(self.numbering.constant(0.0).into());
            fields.clear();
        }
        let default = self.routine(&format!("{prefix}_default_parameters"))?;
        let given = self.behind(default.body, &format!("const {prefix}_parameters params ="))?;
        let mut reader = self.reader(given, HashMap::new());
        let found = reader.expression()?;
        let rest = written(&reader.tokens[reader.at..]);
        if rest != "; return params ;" {
            return Err(format!("`{rest}` stands behind the declared parameters"));
        }
        self.compare(&found, &Value::Array(defaults))?;
        let params = self.parameters(&fields)?;
        let new = self.routine(&format!("{prefix}_new"))?;
        self.look_at(&written(new.arguments), &format!("const {prefix}_parameters *params"))?;
        let body = self.behind(new.body, &format!("{prefix} self;"))?;
        let copy = token::tokens("self.params = *params;", &self.dialect.lexis)?;
        let is_copy =
            |window: &[Token<'_>]| window.iter().map(|token| token.text).eq(copy.iter().map(|token| token.text));
        let at = body.windows(copy.len()).position(is_copy).ok_or("the parameters are not kept")?;
        let body = [&body[..at], &body[at + copy.len()..]].concat();
        let names = [("params".to_string(), params.clone()), ("self".to_string(), Value::Struct(BTreeMap::new()))];
        let mut reader = self.reader(&body, names.into());
        let returned = reader.body()?;
        let mut itself = reader.names.remove("self").unwrap_or(Value::Unset);
        if returned != Some(Value::Text("self".to_string())) {
            return Err("it does not return what it makes".to_string());
        }
        if let Value::Struct(fields) = &mut itself {
            fields.insert("params".to_string(), params);
        }
        Ok(itself)
    }

    /// The fields of a struct of numbers.
    fn fields_of_c(&self, name: &str) -> Reading<Vec<String>> {
        let is_it = |window: &[Token<'_>]| window[0].is("struct") && window[1].is(name) && window[2].is("{");
        let at = self.tokens.windows(3).position(is_it).ok_or_else(|| format!("`{name}` is missing"))?;
        let inside = self.tokens[at + 3..].iter().take_while(|token| !token.is("}")).collect::<Vec<_>>();
        let fields = inside.windows(2).filter(|pair| pair[0].is("mbs_real")).map(|pair| pair[1].text.to_string());
        Ok(fields.collect())
    }

    fn constructor_of_js(&mut self) -> Reading<Value> {
        let found = {
            let body = self.routine("defaults")?.body;
            let mut reader = self.reader(body, HashMap::new());
            reader.body()?
        };
        // Of a name that JavaScript or Rust cannot have the text has another.
        let is_there = |field: &String| matches!(&found, Some(Value::Struct(fields)) if fields.contains_key(field));
        let field = |name: &str| {
            let candidates = [name.to_string(), format!("{name}_"), format!("js_{name}"), format!("{name}__2")];
            candidates.into_iter().find(is_there).unwrap_or_default()
        };
        let fields: Vec<String> = self.derivation.parameters.iter().map(|parameter| field(&parameter.name)).collect();
        let expected = fields.iter().cloned().zip(self.defaults()).collect();
        self.compare(&found.unwrap_or(Value::Unset), &Value::Struct(expected))?;
        let params = self.parameters(&fields)?;
        let is_class = |pair: &[Token<'_>]| pair[0].is("export") && pair[1].is("class");
        let at = self.tokens.windows(2).position(is_class).ok_or("there is no class")?;
        let class = self.tokens[at + 2].text;
        let constructor = self.routine("constructor")?;
        self.look_at(&written(constructor.arguments), "params = {}")?;
        let first = format!("this.params = mbs_parameters({class}.defaults(), params);");
        let body = self.behind(constructor.body, &first)?;
        let itself = Value::Struct([("params".to_string(), params)].into());
        self.made(body, "this", itself)
    }

    /// The mechanism as a constructor makes it of this.
    fn made(&mut self, body: &'t [Token<'t>], name: &str, itself: Value) -> Reading<Value> {
        let mut reader = self.reader(body, [(name.to_string(), itself)].into());
        match reader.body()? {
            None => Ok(reader.names.remove(name).unwrap_or(Value::Unset)),
            Some(_) => Err("a constructor returns something".to_string()),
        }
    }

    fn constructor_of_python(&mut self) -> Reading<Value> {
        let is_class = |pair: &[Token<'_>]| pair[0].is("class") && pair[1].is("Params");
        let at = self.tokens.windows(2).position(is_class).ok_or("there are no parameters")?;
        let (mut fields, mut found) = (Vec::new(), Vec::new());
        let lines = self.tokens[at + 3..].split(|token| token.kind == token::Kind::End).filter(|line| !line.is_empty());
        let lines: Vec<&'t [Token<'t>]> = lines.take_while(|line| line[0].indent == 4).collect();
        for line in lines {
            match line {
                [name, colon, kind, equals, value @ ..]
                    if colon.is(":") && (kind.is("float") || kind.is("tuple")) && equals.is("=") =>
                {
                    fields.push(name.text.to_string());
                    found.push(self.reader(value, HashMap::new()).expression()?);
                }
                other => return Err(format!("`{}` cannot be read", written(other))),
            }
        }
        let defaults = self.defaults();
        self.compare(&Value::Array(found), &Value::Array(defaults))?;
        let params = self.parameters(&fields)?;
        let init = self.routine("__init__")?;
        self.look_at(&written(init.arguments), "self, params=None")?;
        let mut first =
            "self.params = params = Params() if params is None else params self._params = SimpleNamespace(".to_string();
        for (parameter, name) in self.derivation.parameters.iter().zip(&fields) {
            let lengths: String = parameter.lengths().iter().map(|n| format!(", {n}")).collect();
            first += &format!("{name}=mbs_parameter(\"{name}\", params.{name}{lengths}),");
        }
        let body = self.behind(init.body, &(first + ")"))?;
        let itself = Value::Struct([("_params".to_string(), params)].into());
        self.made(body, "self", itself)
    }

    fn constructor_of_matlab(&mut self) -> Reading<Value> {
        // The main function is the first one, which takes what is given.
        let main = self.routines.values().flatten().find(|routine| written(routine.head) == "m").copied();
        let main = main.ok_or("there is no main function")?;
        let body = self.behind(main.body, "if nargin < 1 given = struct(); end params = struct();")?;
        let keeps = spaced(&self.dialect, "c.params = mbs_parameters(params, given);")?;
        let lines: Vec<&'t [Token<'t>]> = body.split_inclusive(|token| token.kind == token::Kind::End).collect();
        let at = lines.iter().position(|line| written(line) == keeps).ok_or("the parameters are not kept")?;
        let (mut fields, mut found) = (Vec::new(), Vec::new());
        for line in lines[..at].iter().filter(|line| !written(line).is_empty()) {
            match line {
                [params, point, name, equals, value @ ..] if params.is("params") && point.is(".") && equals.is("=") => {
                    fields.push(name.text.to_string());
                    found.push(self.reader(value, HashMap::new()).expression()?);
                }
                other => return Err(format!("`{}` cannot be read", written(other))),
            }
        }
        let mut defaults = self.defaults();
        // One number is an array of one.
        for (parameter, (default, found)) in self.derivation.parameters.iter().zip(defaults.iter_mut().zip(&mut found))
        {
            if parameter.lengths().iter().product::<usize>() > 0 {
                (*default, *found) = (Value::Array(default.flat()?), Value::Array(found.flat()?));
            }
        }
        self.compare(&Value::Array(found), &Value::Array(defaults))?;
        let params = self.parameters(&fields)?;
        let mut itself: BTreeMap<String, Value> = [("params".to_string(), params)].into();
        let mut at = at + 1;
        for number in 0..self.derivation.splines().len() {
            let line = format!("[c.table_{number}_places, c.table_{number}_rows] = table_{number}();");
            self.look_at(&written(lines[at]), &line)?;
            at += 1;
            let table = self.routine(&format!("table_{number}"))?;
            self.look_at(&written(table.head), "[places, rows]")?;
            let mut reader = self.reader(table.body, HashMap::new());
            reader.body()?;
            for part in ["places", "rows"] {
                let value = reader.names.remove(part).ok_or("a table is incomplete")?;
                itself.insert(format!("table_{number}_{part}"), value);
            }
        }
        let end = spaced(&self.dialect, "m = struct();")?;
        let length = lines[at..].iter().position(|line| written(line) == end).ok_or("nothing is returned")?;
        let from: usize = lines[..at].iter().map(|line| line.len()).sum();
        let to: usize = lines[..at + length].iter().map(|line| line.len()).sum();
        self.made(&body[from..to], "c", Value::Struct(itself))
    }
}
