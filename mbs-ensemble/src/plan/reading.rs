//! From the tables of a text of TOML to a plan, with all that is wrong on the way.

use std::ops::Range;
use std::path::PathBuf;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Amount, Correlation, Crossing, Direction, Located, Motion, Named, Plan, Quantity, Reduction, Spread};
use crate::fault::{Fault, Faults};
use crate::sequence::Kind;

type Value<'t> = Spanned<DeValue<'t>>;

/// The plan that a text's tables hold.
pub(super) fn plan(table: &Spanned<DeTable<'_>>) -> Result<Plan, Faults> {
    let mut reader = Reader { faults: Vec::new() };
    let plan = reader.plan(table);
    Faults::finish(reader.faults, plan)
}

struct Reader {
    faults: Vec<Fault>,
}

/// A table whose keys are asked for one by one; what nobody asks for is unknown.
struct Section<'a, 't> {
    entries: Vec<(Located<String>, &'a Value<'t>)>,
    known: Vec<String>,
    span: Range<usize>,
}

impl<'a, 't> Section<'a, 't> {
    fn of(table: &'a DeTable<'t>, span: Range<usize>) -> Self {
        let entry = |(key, value): (&'a Spanned<_>, &'a Value<'t>)| {
            let key: &Spanned<std::borrow::Cow<'t, str>> = key;
            (Located { value: key.get_ref().to_string(), span: key.span() }, value)
        };
        let mut entries: Vec<_> = table.iter().map(entry).collect();
        entries.sort_by_key(|(key, _)| key.span.start);
        Section { entries, known: Vec::new(), span }
    }

    fn get(&mut self, key: &str) -> Option<&'a Value<'t>> {
        self.known.push(key.to_string());
        self.entries.iter().find(|(own, _)| own.value == key).map(|(_, value)| *value)
    }

    /// Whether a key, which is known already, is there.
    fn has(&self, key: &str) -> bool {
        self.entries.iter().any(|(own, _)| own.value == key)
    }
}

impl Reader {
    fn fault<T>(&mut self, fault: Fault) -> Option<T> {
        self.faults.push(fault);
        None
    }

    fn misfit<T>(&mut self, value: &Value<'_>, wanted: &str) -> Option<T> {
        self.fault(Fault::new(value.span(), format!("{wanted} is wanted here, found {}", kind(value.get_ref()))))
    }

    fn plan(&mut self, table: &Spanned<DeTable<'_>>) -> Plan {
        let mut section = Section::of(table.get_ref(), table.span());
        let mechanism = section.get("mechanism").and_then(|value| self.text(value));
        let members = section.get("members").and_then(|value| self.count(value));
        let seed = section.get("seed").and_then(|value| self.natural(value)).map_or(0, |seed| seed.value);
        let kind = section.get("design").and_then(|value| self.kind(value)).unwrap_or_default();
        let degree = section.get("degree").and_then(|value| self.count(value));
        let parameters = self.entries(section.get("parameters"), Self::amount);
        let fixed = self.entries(section.get("fixed"), Self::amount);
        let vary = self.entries(section.get("vary"), |reader, value| {
            Some(Located { value: reader.spread(value)?, span: value.span() })
        });
        let correlation = section.get("correlation").map(|value| self.correlations(value)).unwrap_or_default();
        let inputs = self.entries(section.get("inputs"), Self::text);
        let signals = self.entries(section.get("signals"), Self::text);
        let motion = section.get("motion").and_then(|value| self.motion(value));
        let quantities = self.entries(section.get("quantities"), Self::quantity);
        self.finish(section);
        let mechanism = mechanism.map(|path| Located { value: PathBuf::from(path.value), span: path.span });
        Plan {
            mechanism,
            members,
            seed,
            kind,
            degree,
            parameters,
            fixed,
            vary,
            correlation,
            inputs,
            signals,
            motion,
            quantities,
        }
    }

    /// Keys that nobody has asked for.
    fn finish(&mut self, section: Section<'_, '_>) {
        for (key, _) in section.entries {
            if !section.known.contains(&key.value) {
                self.faults.push(Fault::unknown(key.span, "key", &key.value, &section.known));
            }
        }
    }

    fn table<'a, 't>(&mut self, value: &'a Value<'t>) -> Option<Section<'a, 't>> {
        match value.get_ref() {
            DeValue::Table(table) => Some(Section::of(table, value.span())),
            _ => self.misfit(value, "a table"),
        }
    }

    /// All entries of a table, in the order of the text.
    fn entries<T>(
        &mut self,
        value: Option<&Value<'_>>,
        mut read: impl FnMut(&mut Self, &Value<'_>) -> Option<T>,
    ) -> Vec<Named<T>> {
        let Some(section) = value.and_then(|value| self.table(value)) else { return Vec::new() };
        let entry = |(name, value)| Some(Named { name, value: read(self, value)? });
        section.entries.into_iter().filter_map(entry).collect()
    }

    fn text(&mut self, value: &Value<'_>) -> Option<Located<String>> {
        match value.get_ref() {
            DeValue::String(text) if !text.trim().is_empty() => {
                Some(Located { value: text.to_string(), span: value.span() })
            }
            DeValue::String(_) => self.misfit(value, "a text that is not empty"),
            _ => self.misfit(value, "a text"),
        }
    }

    fn words(&mut self, value: &Value<'_>) -> Option<Vec<Located<String>>> {
        let Some(items) = value.get_ref().as_array() else { return self.misfit(value, "an array of names") };
        items.iter().map(|item| self.text(item)).collect()
    }

    fn natural(&mut self, value: &Value<'_>) -> Option<Located<u64>> {
        let number = value.get_ref().as_integer();
        let number = number.and_then(|number| u64::from_str_radix(number.as_str(), number.radix()).ok());
        match number {
            Some(number) => Some(Located { value: number, span: value.span() }),
            None => self.misfit(value, "a whole number, not negative,"),
        }
    }

    fn count(&mut self, value: &Value<'_>) -> Option<Located<u64>> {
        let count = self.natural(value)?;
        if count.value == 0 { self.misfit(value, "a count of one or more") } else { Some(count) }
    }

    fn number(&mut self, value: &Value<'_>) -> Option<Located<f64>> {
        let number = match value.get_ref() {
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64),
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        };
        match number.filter(|number: &f64| number.is_finite()) {
            Some(number) => Some(Located { value: number, span: value.span() }),
            None => self.misfit(value, "a finite number"),
        }
    }

    fn positive(&mut self, value: &Value<'_>) -> Option<Located<f64>> {
        let number = self.number(value)?;
        if number.value > 0.0 { Some(number) } else { self.misfit(value, "a positive number") }
    }

    fn amount(&mut self, value: &Value<'_>) -> Option<Located<Amount>> {
        match value.get_ref() {
            DeValue::String(text) => Some(Located { value: Amount::Text(text.to_string()), span: value.span() }),
            DeValue::Integer(_) | DeValue::Float(_) => {
                self.number(value).map(|number| Located { value: Amount::Number(number.value), span: number.span })
            }
            _ => self.misfit(value, "a number, or a text with number and unit,"),
        }
    }

    fn amounts<const N: usize>(&mut self, value: &Value<'_>, what: &str) -> Option<[Located<Amount>; N]> {
        let items = value.get_ref().as_array().filter(|items| items.len() == N);
        let Some(items) = items else { return self.misfit(value, &format!("an array of {N}, {what},")) };
        let amounts: Option<Vec<_>> = items.iter().map(|item| self.amount(item)).collect();
        amounts?.try_into().ok()
    }

    fn kind(&mut self, value: &Value<'_>) -> Option<Kind> {
        let known = Kind::ALL.map(|kind| kind.name().to_string());
        let text = self.text(value)?;
        let kind = Kind::ALL.into_iter().find(|kind| kind.name() == text.value);
        kind.or_else(|| self.fault(Fault::unknown(text.span, "design", &text.value, &known)))
    }

    fn spread(&mut self, value: &Value<'_>) -> Option<Spread> {
        let mut section = self.table(value)?;
        let faults = self.faults.len();
        let mut found: Vec<Option<Spread>> = Vec::new();
        if let Some(value) = section.get("values") {
            found.push(self.values(value));
        }
        let range = ["from", "to", "count"].map(|key| section.get(key));
        if range.iter().any(Option::is_some) {
            found.push(self.range(range, &section.span));
        }
        if let Some(value) = section.get("uniform") {
            found.push(self.amounts(value, "lowest and highest").map(Spread::Uniform));
        }
        if let Some(value) = section.get("triangular") {
            found.push(self.amounts(value, "lowest, most likely and highest").map(Spread::Triangular));
        }
        let within = section.get("within").map(|value| (value, self.amounts(value, "lowest and highest")));
        if let Some(value) = section.get("normal") {
            let of = self.amounts(value, "mean and deviation");
            let within = within.as_ref().and_then(|(_, within)| within.clone());
            found.push(of.map(|of| Spread::Normal { of, within }));
        } else if let Some((value, _)) = within {
            self.faults.push(Fault::new(value.span(), "`within` cuts off a `normal` distribution, and there is none"));
        }
        if let Some(value) = section.get("lognormal") {
            found.push(self.amounts(value, "median and deviation of the logarithm").map(Spread::Lognormal));
        }
        let span = section.span.clone();
        self.finish(section);
        match found.len() {
            1 => found.pop().flatten(),
            0 if self.faults.len() > faults => None,
            0 => {
                self.fault(Fault::with_help(span, "there is nothing to vary by", "`{ uniform = [1, 2] }`, for example"))
            }
            _ => self.fault(Fault::new(span, "a variable varies in one way, here are several")),
        }
    }

    fn values(&mut self, value: &Value<'_>) -> Option<Spread> {
        let items = value.get_ref().as_array().filter(|items| !items.is_empty());
        let Some(items) = items else { return self.misfit(value, "an array of values") };
        let amounts: Option<Vec<_>> = items.iter().map(|item| self.amount(item)).collect();
        amounts.map(Spread::Values)
    }

    fn range(&mut self, parts: [Option<&Value<'_>>; 3], span: &Range<usize>) -> Option<Spread> {
        let [Some(from), Some(to), Some(count)] = parts else {
            return self.fault(Fault::new(span.clone(), "a range has `from`, `to` and `count`"));
        };
        let (from, to, count) = (self.amount(from)?, self.amount(to)?, self.count(count)?);
        Some(Spread::Range { from, to, count: count.value })
    }

    fn correlations(&mut self, value: &Value<'_>) -> Vec<Correlation> {
        let Some(items) = value.get_ref().as_array() else {
            self.misfit::<()>(value, "an array of `[\"one\", \"other\", coefficient]`");
            return Vec::new();
        };
        items.iter().filter_map(|item| self.correlation(item)).collect()
    }

    fn correlation(&mut self, value: &Value<'_>) -> Option<Correlation> {
        let parts = value.get_ref().as_array().filter(|parts| parts.len() == 3);
        let Some(parts) = parts else { return self.misfit(value, "an array `[\"one\", \"other\", coefficient]`") };
        let of = [self.text(&parts[0])?, self.text(&parts[1])?];
        let coefficient = self.number(&parts[2])?;
        if coefficient.value.abs() > 1.0 {
            return self.misfit(&parts[2], "a number from -1 to 1");
        }
        Some(Correlation { of, coefficient })
    }

    fn direction(&mut self, value: &Value<'_>) -> Option<Direction> {
        let text = self.text(value)?;
        match text.value.as_str() {
            "any" => Some(Direction::Any),
            "rising" => Some(Direction::Rising),
            "falling" => Some(Direction::Falling),
            _ => self.misfit(value, "\"rising\", \"falling\" or \"any\""),
        }
    }

    fn motion(&mut self, value: &Value<'_>) -> Option<Motion> {
        let mut section = self.table(value)?;
        let duration = section.get("duration").and_then(|value| self.amount(value));
        let method = section.get("method").and_then(|value| self.text(value));
        let relative = section.get("rtol").and_then(|value| self.positive(value));
        let absolute = section.get("atol").and_then(|value| self.positive(value));
        let step = section.get("step").and_then(|value| self.amount(value));
        let max_step = section.get("max_step").and_then(|value| self.amount(value));
        let redundant = section.get("redundant").and_then(|value| self.text(value));
        let hold = section.get("hold").and_then(|value| self.words(value));
        let until = section.get("until").and_then(|value| self.crossing(value));
        let span = section.span.clone();
        let is_missing = !section.has("duration");
        self.finish(section);
        if is_missing {
            return self.fault(Fault::with_help(span, "`duration` is missing", "`duration = \"10 s\"`, for example"));
        }
        Some(Motion { duration: duration?, method, relative, absolute, step, max_step, redundant, hold, until })
    }

    /// `{ zero = "height", direction = "falling" }`, or the formula alone.
    fn crossing(&mut self, value: &Value<'_>) -> Option<Crossing> {
        if value.get_ref().is_str() {
            return Some(Crossing { formula: self.text(value)?, direction: Direction::Any });
        }
        let mut section = self.table(value)?;
        let formula = section.get("zero").and_then(|value| self.text(value));
        let direction = section.get("direction").and_then(|value| self.direction(value)).unwrap_or_default();
        let (span, is_missing) = (section.span.clone(), !section.has("zero"));
        self.finish(section);
        if is_missing {
            return self.fault(Fault::new(span, "`zero` is missing, the formula that passes zero"));
        }
        Some(Crossing { formula: formula?, direction })
    }

    /// `{ max = "height" }`; a formula alone is that at the end.
    fn quantity(&mut self, value: &Value<'_>) -> Option<Quantity> {
        if value.get_ref().is_str() {
            return Some(Quantity { reduction: Reduction::Final, formula: self.text(value)? });
        }
        let mut section = self.table(value)?;
        let direction = section.get("direction");
        let given = direction.and_then(|value| self.direction(value)).unwrap_or_default();
        let reductions = [
            ("final", Reduction::Final),
            ("min", Reduction::Min),
            ("max", Reduction::Max),
            ("mean", Reduction::Mean),
            ("time_of", Reduction::TimeOf(given)),
            ("count", Reduction::Count(given)),
            ("happened", Reduction::Happened(given)),
        ];
        let (span, faults) = (section.span.clone(), self.faults.len());
        let mut found: Vec<(Reduction, &Value<'_>)> = Vec::new();
        for (key, reduction) in reductions {
            found.extend(section.get(key).map(|value| (reduction, value)));
        }
        self.finish(section);
        if found.is_empty() && self.faults.len() > faults {
            return None;
        }
        let [(reduction, value)] = &found[..] else {
            return self.fault(Fault::with_help(
                span,
                "a quantity is one reduction of a formula",
                "`{ max = \"height\" }`, for example; final, min, max, mean, time_of, count and happened are there",
            ));
        };
        let passes_zero = matches!(reduction, Reduction::TimeOf(_) | Reduction::Count(_) | Reduction::Happened(_));
        if let (Some(direction), false) = (direction, passes_zero) {
            return self.fault(Fault::new(direction.span(), "a direction is for time_of, count and happened"));
        }
        Some(Quantity { reduction: reduction.clone(), formula: self.text(value)? })
    }
}

/// What stands in the place of what should.
fn kind(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the text {text:?}"),
        DeValue::Integer(number) => format!("the number {}", number.as_str()),
        DeValue::Float(number) => format!("the number {}", number.as_str()),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(_) => "a date".to_string(),
        DeValue::Array(items) => format!("an array of {}", items.len()),
        DeValue::Table(_) => "a table".to_string(),
    }
}
