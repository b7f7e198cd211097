//! The text of a state file, read: what is asked for, or all that is wrong with it. No input and no output.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use mbs_derive::diagnostic::{Diagnostic, Diagnostics};
use mbs_derive::expr::Number;
use mbs_derive::interpret::{State, Violation};
use mbs_derive::model::Unit;
use mbs_derive::optimise::Derivation;
use mbs_derive::variable::Variable;
use mbs_derive::variable::component_names;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::words::{abridged, plural};

/// What a state file asks for.
#[derive(Clone, Debug)]
pub(crate) enum Request {
    /// An object.
    One(Point),
    /// An array of objects.
    Many(Vec<Point>),
}

/// A state and the parameters that hold there.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Time, coordinates, velocities, accelerations, inputs.
    pub(crate) state: State,
    /// Whether accelerations are among what was given.
    pub(crate) accelerations_are_given: bool,
    /// All parameters, flattened in declaration order.
    pub(crate) parameters: Vec<f64>,
}

/// A state file that is right.
#[derive(Clone, Debug)]
pub(crate) struct Reading {
    /// What it asks for.
    pub(crate) request: Request,
    /// The numbers of the prescribed signals that it does not give.
    pub(crate) left_out: BTreeSet<usize>,
    /// The numbers of the parameters that were declared in another unit and are given without one.
    pub(crate) plain: BTreeSet<usize>,
}

/// Why a state file is refused.
#[derive(Clone, Debug)]
pub(crate) enum Refusal {
    /// It is no JSON, at a place.
    Syntax(Diagnostics),
    /// It does not fit the mechanism.
    Misfit(Vec<String>),
}

const KEYS: [&str; 7] = ["t", "q", "qd", "qdd", "u", "params", "prescribed"];

/// Reads a text of JSON, which messages call `name`.
///
/// # Errors
/// All that is wrong with it.
pub(crate) fn reading(name: &str, text: &str, derivation: &Derivation) -> Result<Reading, Refusal> {
    let json = parse(text)?;
    request(name, &json, derivation)
}

/// JSON, and beyond it the words `NaN` and `Infinity`, as strings, so that the key they stand under can be named.
fn parse(text: &str) -> Result<Value, Refusal> {
    let read = |text: &str| serde_json::from_str(text).map(|Unambiguous(json)| json);
    read(text).or_else(|error| {
        let quoted = with_words_quoted(text);
        read(&quoted).ok().filter(|_| quoted != text).ok_or_else(|| syntax_error(text, &error))
    })
}

/// JSON in whose objects no key stands twice; [`Value`] alone takes the last of them.
struct Unambiguous(Value);

impl<'de> Deserialize<'de> for Unambiguous {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(UnambiguousVisitor).map(Unambiguous)
    }
}

struct UnambiguousVisitor;

impl<'de> Visitor<'de> for UnambiguousVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }
    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }
    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }
    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }
    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }
    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }
    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(Unambiguous(value)) = items.next_element()? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }
    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut values = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if values.contains_key(&key) {
                return Err(A::Error::custom(format_args!("the key {} stands here twice", Value::from(key))));
            }
            let Unambiguous(value) = entries.next_value()?;
            values.insert(key, value);
        }
        Ok(Value::Object(values))
    }
}

fn with_words_quoted(text: &str) -> String {
    const WORDS: [&str; 3] = ["NaN", "-Infinity", "Infinity"];
    let mut quoted = String::new();
    let (mut in_string, mut escaped) = (false, false);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let word = WORDS.into_iter().find(|word| !in_string && rest.starts_with(word));
        match word {
            Some(word) => quoted += &format!("\"{word}\""),
            None => quoted.push(c),
        }
        if c == '"' && !escaped {
            in_string = !in_string;
        }
        escaped = in_string && c == '\\' && !escaped;
        rest = &rest[word.map_or(c.len_utf8(), str::len)..];
    }
    quoted
}

/// The parser's message with its place.
fn syntax_error(text: &str, error: &serde_json::Error) -> Refusal {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or(&message);
    let line_start: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    // The parser counts bytes, and ends behind the last one.
    let byte = (line_start + error.column().saturating_sub(1)).min(text.len());
    let start = (0..=byte).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let end = start + text[start..].chars().next().map_or(0, char::len_utf8);
    let mut diagnostics = Diagnostics::default();
    diagnostics.data(start..end, format!("unreadable JSON: {message}"));
    Refusal::Syntax(diagnostics)
}

fn request(name: &str, json: &Value, derivation: &Derivation) -> Result<Reading, Refusal> {
    let mut errors = Vec::new();
    let (mut left_out, mut plain) = (BTreeSet::new(), BTreeSet::new());
    let mut point = |json: &Value, place: String| {
        let mut reader = Reader { derivation, place, errors: Vec::new(), left_out: &mut left_out, plain: &mut plain };
        let point = reader.point(json);
        errors.append(&mut reader.errors);
        point
    };
    let request = match json {
        Value::Array(items) => {
            Request::Many(items.iter().enumerate().map(|(i, item)| point(item, format!("{name}: state {i}"))).collect())
        }
        _ => Request::One(point(json, name.to_string())),
    };
    if errors.is_empty() { Ok(Reading { request, left_out, plain }) } else { Err(Refusal::Misfit(errors)) }
}

/// Matches one JSON object with a mechanism.
struct Reader<'a> {
    derivation: &'a Derivation,
    /// Which file and which of its states.
    place: String,
    errors: Vec<String>,
    /// The numbers of the prescribed signals that this or another state does not give.
    left_out: &'a mut BTreeSet<usize>,
    /// The numbers of the parameters that were declared in another unit and are given without one.
    plain: &'a mut BTreeSet<usize>,
}

/// What a number is called, and the unit that it is in.
struct Slot {
    name: String,
    unit: String,
}

/// What the names of rates and accelerations end in.
const SUFFIXES: [&str; 3] = ["", "_dot", "_ddot"];

/// The numbers of the components that a name stands for, and whether they are an array.
fn of(variables: &[Variable], name: &str) -> Option<(Range<usize>, bool)> {
    let whole = variables.iter().find(|variable| variable.name == name);
    if let Some(variable) = whole {
        return Some((variable.first..variable.first + variable.count(), variable.length.is_some()));
    }
    let component = component_names(variables).iter().position(|component| component == name)?;
    Some((component..component + 1, false))
}

/// The components of some variables, differentiated with respect to time `derivatives` times.
fn slots(variables: &[Variable], derivatives: usize) -> Vec<Slot> {
    let slot = |unit: &str, name: String| Slot { name, unit: format!("({unit}){}", "/s".repeat(derivatives)) };
    variables.iter().flat_map(|v| v.component_names().into_iter().map(|name| slot(&v.unit, name))).collect()
}

impl Reader<'_> {
    fn error(&mut self, message: String) {
        self.errors.push(format!("{}: {message}", self.place));
    }

    fn point(&mut self, json: &Value) -> Point {
        let empty = Map::new();
        let object = json.as_object().unwrap_or(&empty);
        if !json.is_object() {
            self.error(format!("a state is an object {{\"q\": […], …}}, found {}", kind(json)));
        } else if !object.contains_key("q") && !object.keys().any(|key| self.is_coordinate(key)) {
            let names = component_names(&self.derivation.coordinates);
            self.error(format!("\"q\" is missing: {}, or one of them by its name", expected(&names)));
        }
        let names = || object.keys().filter(|key| !KEYS.contains(&key.as_str()));
        let meant: Vec<(&String, Vec<String>)> = names().map(|key| (key, self.meanings(key))).collect();
        for (key, places) in meant.iter().filter(|(_, places)| places.len() > 1) {
            let (key, places) = (Value::from(key.as_str()), places.join(" or "));
            self.error(format!("{key} is the name of more than one number: write {places}"));
        }
        let unknown: Vec<&String> = meant.iter().filter(|(_, places)| places.is_empty()).map(|(key, _)| *key).collect();
        for key in unknown {
            let names = component_names(&self.derivation.coordinates);
            let rates = names.iter().flat_map(|name| SUFFIXES.map(|suffix| format!("{name}{suffix}")));
            let inputs = component_names(&self.derivation.inputs);
            let known: Vec<String> = KEYS.into_iter().map(String::from).chain(rates).chain(inputs).collect();
            let near = Diagnostic::nearest(key, known.iter().map(String::as_str));
            let known = if near.is_some() { known } else { KEYS.map(String::from).to_vec() };
            let hint = hint(key, &known, "keys");
            self.error(format!("unknown key {}{hint}", Value::from(key.as_str())));
        }
        let derivation = self.derivation;
        let coordinates = &derivation.coordinates;
        let state = State {
            t: object.get("t").map_or(0.0, |json| self.number("\"t\"", json, "s")),
            q: self.vector(object, "q", coordinates, 0),
            qd: self.vector(object, "qd", coordinates, 1),
            qdd: self.vector(object, "qdd", coordinates, 2),
            u: self.vector(object, "u", &derivation.inputs, 0),
            prescribed: self.prescribed(object.get("prescribed")),
        };
        let is_acceleration =
            |key: &String| key.strip_suffix(SUFFIXES[2]).is_some_and(|name| of(coordinates, name).is_some());
        let accelerations_are_given = object.contains_key("qdd") || object.keys().any(is_acceleration);
        let errors = self.errors.len();
        let parameters = self.parameters(object.get("params"));
        // What could not be read is not what would be refused.
        if self.errors.len() == errors {
            self.check(&parameters);
        }
        Point { state, accelerations_are_given, parameters }
    }

    /// Whether a key is the name of a coordinate.
    fn is_coordinate(&self, key: &str) -> bool {
        of(&self.derivation.coordinates, key).is_some()
    }

    /// Where a key could stand with its name: as a coordinate, its rate or acceleration, or an input.
    fn meanings(&self, key: &str) -> Vec<String> {
        let coordinates = &self.derivation.coordinates;
        let of_coordinates = ["q", "qd", "qdd"].into_iter().zip(SUFFIXES).map(|(of, suffix)| (of, coordinates, suffix));
        let all = of_coordinates.chain([("u", &self.derivation.inputs, "")]);
        let named = |(list, variables, suffix): (&str, &Vec<Variable>, &str)| {
            let name = key.strip_suffix(suffix).filter(|name| of(variables, name).is_some())?;
            Some(format!("{{\"{list}\": {{{}: …}}}}", Value::from(name)))
        };
        all.filter_map(named).collect()
    }

    /// An array with all numbers, or an object of some by name, the others being zero; and what stands by name in the
    /// state itself.
    fn vector(
        &mut self,
        object: &Map<String, Value>,
        key: &str,
        variables: &[Variable],
        derivatives: usize,
    ) -> Vec<f64> {
        let slots = slots(variables, derivatives);
        let (mut values, mut is_given) = (vec![0.0; slots.len()], vec![false; slots.len()]);
        let mut named: Vec<(String, &str, &Value)> = Vec::new();
        match object.get(key) {
            Some(Value::Object(items)) => {
                for (name, json) in items {
                    let place = format!("\"{key}\".{}", Value::from(name.as_str()));
                    if of(variables, name).is_none() {
                        let known: Vec<String> = slots.iter().map(|slot| slot.name.clone()).collect();
                        self.error(format!("unknown name {place}{}", hint(name, &known, "names")));
                    }
                    named.push((place, name, json));
                }
            }
            Some(json) => {
                let before = self.errors.len();
                values = self.numbers(&format!("\"{key}\""), json, &slots);
                match (self.errors.len() == before, self.meanings(key).first(), self.errors.last_mut()) {
                    (true, ..) => is_given.fill(true),
                    (false, Some(place), Some(error)) => {
                        *error += &format!("; {key:?} is the name of a variable, too, which is given by {place}");
                    }
                    (false, ..) => {}
                }
            }
            None => {}
        }
        let own = object.iter().filter(|(name, _)| !KEYS.contains(&name.as_str()));
        named.extend(own.filter_map(|(name, json)| {
            Some((Value::from(name.as_str()).to_string(), name.strip_suffix(SUFFIXES[derivatives])?, json))
        }));
        for (place, name, json) in named {
            let Some((range, is_array)) = of(variables, name) else { continue };
            if is_given[range.clone()].contains(&true) {
                self.error(format!("{place} is given twice"));
            }
            is_given[range.clone()].fill(true);
            let numbers = match is_array {
                true => self.numbers(&place, json, &slots[range.clone()]),
                false => vec![self.number(&place, json, &slots[range.start].unit)],
            };
            values[range].copy_from_slice(&numbers);
        }
        values
    }

    /// An array with one number for each slot.
    fn numbers(&mut self, key: &str, json: &Value, slots: &[Slot]) -> Vec<f64> {
        let expected = || expected(&slots.iter().map(|slot| slot.name.clone()).collect::<Vec<_>>());
        match json.as_array() {
            None => self.error(format!("{key} must be an array of {}, found {}", expected(), kind(json))),
            Some(items) if items.len() != slots.len() => {
                self.error(format!("{key} must hold {}, found {}", expected(), items.len()));
            }
            Some(items) => {
                let named = items.iter().zip(slots).enumerate();
                let number = |(i, (item, slot)): (usize, (_, &Slot))| {
                    self.number(&format!("{key}[{i}] ({})", slot.name), item, &slot.unit)
                };
                return named.map(number).collect();
            }
        }
        vec![0.0; slots.len()]
    }

    /// A number in SI units, or a string with a number and a unit.
    fn number(&mut self, key: &str, json: &Value, unit: &str) -> f64 {
        let is_word = |text: &str| text.parse::<f64>().is_ok_and(|number| !number.is_finite());
        match json {
            Value::String(text) if !is_word(text) => Unit(unit).in_si(text).unwrap_or_else(|reason| {
                self.error(format!("{key} is {json}: {reason}"));
                0.0
            }),
            _ => json.as_f64().filter(|number| number.is_finite()).unwrap_or_else(|| {
                self.error(format!("{key} must be a finite number, found {}", kind(json)));
                0.0
            }),
        }
    }

    /// The mechanism can have these parameters.
    fn check(&mut self, parameters: &[f64]) {
        for Violation { quantity, value, must } in Violation::all(self.derivation, parameters) {
            self.error(format!("\"params\": `{quantity}` {must}, it is {value:?}"));
        }
    }

    fn parameters(&mut self, json: Option<&Value>) -> Vec<f64> {
        let declared = &self.derivation.parameters;
        let mut values: Vec<f64> = declared.iter().flat_map(|p| &p.defaults).map(|&n| Number::to_f64(n)).collect();
        let Some(json) = json else { return values };
        let Some(given) = json.as_object() else {
            self.error(format!("\"params\" must be an object {{name: value}}, found {}", kind(json)));
            return values;
        };
        let components = component_names(declared);
        for (name, json) in given {
            let key = format!("\"params\".{}", Value::from(name.as_str()));
            let whole = declared.iter().find(|p| p.length.is_some() && p.component_names().contains(name));
            if let Some(whole) = whole.filter(|whole| given.contains_key(&whole.name)) {
                let whole = Value::from(whole.name.as_str());
                self.error(format!("{key} is given twice, by itself and in \"params\".{whole}"));
            }
            if let Some(variable) = declared.iter().find(|p| p.name == *name) {
                let numbers = self.parameter(&key, json, variable);
                values[variable.first..variable.first + variable.count()].copy_from_slice(&numbers);
                self.note_plain(json, variable);
            } else if let (Some(component), Some(whole)) =
                (components.iter().position(|component| component == name), whole)
            {
                values[component] = self.number(&key, json, &whole.unit);
                self.note_plain(json, whole);
            } else {
                let names: Vec<String> = declared.iter().map(|p| p.name.clone()).collect();
                self.error(format!("unknown parameter {key}{}", hint(name, &names, "parameters")));
            }
        }
        values
    }

    fn parameter(&mut self, key: &str, json: &Value, variable: &Variable) -> Vec<f64> {
        let slots = slots(std::slice::from_ref(variable), 0);
        match (variable.length, variable.columns) {
            (None, _) => vec![self.number(key, json, &variable.unit)],
            (Some(_), None) => self.numbers(key, json, &slots),
            (Some(n), Some(columns)) => match json.as_array() {
                Some(rows) if rows.len() == n / columns => {
                    let rows = rows.iter().zip(slots.chunks(columns)).enumerate();
                    rows.flat_map(|(i, (row, slots))| self.numbers(&format!("{key}[{i}]"), row, slots)).collect()
                }
                _ => {
                    let rows = plural(n / columns, "array", "arrays");
                    let found = json.as_array().map_or(kind(json), |rows| rows.len().to_string());
                    self.error(format!("{key} must hold {rows}, one for each row, found {found}"));
                    vec![0.0; n]
                }
            },
        }
    }

    /// A number without a unit is in SI units; where the declaration is in others, that may not be what was meant.
    fn note_plain(&mut self, json: &Value, variable: &Variable) {
        let number = self.derivation.parameters.iter().position(|parameter| parameter.first == variable.first);
        if variable.declared_unit.is_some() && has_plain(json) {
            self.plain.extend(number);
        }
    }

    /// Value, first and second derivative of every signal; zero where none is given.
    fn prescribed(&mut self, json: Option<&Value>) -> Vec<[f64; 3]> {
        let names = component_names(&self.derivation.prescribed);
        let mut signals = vec![[0.0; 3]; names.len()];
        let is_given = |name: &String| json.is_some_and(|json| json.get(name).is_some());
        self.left_out.extend((0..names.len()).filter(|&i| !is_given(&names[i])));
        let Some(json) = json else { return signals };
        let Some(given) = json.as_object() else {
            let found = kind(json);
            self.error(format!(
                "\"prescribed\" must be an object {{name: [value, rate, acceleration]}}, found {found}"
            ));
            return signals;
        };
        let units: Vec<String> = slots(&self.derivation.prescribed, 0).into_iter().map(|slot| slot.unit).collect();
        let orders = |unit: &str| {
            let slot = |(name, per): (&str, &str)| Slot { name: name.to_string(), unit: format!("{unit}{per}") };
            [("value", ""), ("rate", "/s"), ("acceleration", "/s/s")].map(slot)
        };
        for (name, json) in given {
            let key = format!("\"prescribed\".{}", Value::from(name.as_str()));
            match names.iter().position(|known| known == name) {
                Some(i) => signals[i].copy_from_slice(&self.numbers(&key, json, &orders(&units[i]))),
                None if names.is_empty() => {
                    self.error(format!("unknown signal {key}; the mechanism has no prescribed signals"));
                }
                None => self.error(format!("unknown signal {key}{}", hint(name, &names, "prescribed signals"))),
            }
        }
        signals
    }
}

/// `2 numbers (x, theta)`
fn expected(names: &[String]) -> String {
    let count = plural(names.len(), "number", "numbers");
    if names.is_empty() { count } else { format!("{count} ({})", abridged(names)) }
}

/// What to write instead of an unknown name.
pub(crate) fn hint(name: &str, known: &[String], what: &str) -> String {
    match Diagnostic::nearest(name, known.iter().map(String::as_str)) {
        Some(near) => format!("; did you mean {}?", Value::from(near)),
        None if known.is_empty() => format!("; the mechanism has no {what}"),
        None => format!("; the {what} are {}", abridged(known)),
    }
}

/// Whether a number without a unit, other than zero, stands in it.
fn has_plain(json: &Value) -> bool {
    match json {
        Value::Array(items) => items.iter().any(has_plain),
        _ => json.as_f64().is_some_and(|number| number != 0.0),
    }
}

/// What stands in the place of what should.
fn kind(json: &Value) -> String {
    match json {
        Value::Null => "null".to_string(),
        Value::Bool(_) => "a truth value".to_string(),
        Value::Number(number) => format!("the number {number}"),
        Value::String(word) if matches!(word.as_str(), "NaN" | "Infinity" | "-Infinity") => word.clone(),
        Value::String(_) => "a string".to_string(),
        Value::Array(_) => "an array".to_string(),
        Value::Object(_) => "an object".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Refusal, parse, with_words_quoted};

    #[test]
    fn mistakes_lie_between_characters() {
        for text in ["", "{", "{\"q\": é}", "é", "{\"q̇\": [1,\n🛰]}", "{\"x\": 1,}", "\n"] {
            let Err(Refusal::Syntax(errors)) = parse(text) else { panic!("{text} is read") };
            for error in errors.iter() {
                assert!(text.get(error.span.clone()).is_some(), "{text}: {:?}", error.span);
            }
        }
    }

    #[test]
    fn words_in_strings_stay_as_they_are() {
        let text = r#"{"NaN": [NaN, -Infinity, Infinity], "say \"NaN": 1, "q̇\\": NaN}"#;
        let quoted = r#"{"NaN": ["NaN", "-Infinity", "Infinity"], "say \"NaN": 1, "q̇\\": "NaN"}"#;
        assert_eq!(with_words_quoted(text), quoted);
    }
}
