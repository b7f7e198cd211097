//! Elements of arrays: `road[0]` as it is declared, `road_0` as it is called in tables.

use std::collections::BTreeMap;
use std::ops::Range;

use mbs_derive::parse::{Statement, StatementKind};
use mbs_derive::source::Insertion;
use mbs_derive::variable::Variable;

use super::{Drive, Source, in_si_units};

/// `road[0]` as it is called in tables, `road_0`; any other name unchanged.
pub(super) fn column(name: &str) -> String {
    let digits = |index: &str| !index.is_empty() && index.bytes().all(|digit| digit.is_ascii_digit());
    match name.strip_suffix(']').and_then(|name| name.rsplit_once('[')) {
        Some((array, index)) if is_name(array) && digits(index) => format!("{array}_{index}"),
        _ => name.to_string(),
    }
}

fn is_name(word: &str) -> bool {
    !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The components that a name stands for, one or all of an array: their numbers and their names.
pub(super) fn components(variables: &[Variable], name: &str) -> Option<Vec<(usize, String)>> {
    let all = || variables.iter().flat_map(|variable| (variable.first..).zip(variable.component_names()));
    match variables.iter().find(|variable| variable.name == name) {
        Some(variable) => Some((variable.first..).zip(variable.component_names()).collect()),
        None => all().find(|(_, component)| component == name).map(|component| vec![component]),
    }
}

/// An input or a prescribed signal as it is declared.
pub(super) struct Declared {
    pub(super) name: String,
    pub(super) unit: String,
    /// Before the `;` of its statement.
    pub(super) end: usize,
    has_value: bool,
    is_array: bool,
    /// Of an array, where it is written as a number, or as a constant that is.
    length: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Input,
    Signal,
}

/// All of a kind.
pub(super) fn declared(text: &str, statements: &[Statement], kind: Kind) -> Vec<Declared> {
    let written = |span: &std::ops::Range<usize>| text.get(span.clone()).unwrap_or_default().trim();
    let constant = |name: &str| {
        statements.iter().find_map(|statement| match &statement.kind {
            StatementKind::Const(quantity) if quantity.name.text == name => quantity.value.as_ref(),
            _ => None,
        })
    };
    let number = |length: &str| {
        let value = || constant(length).map_or("", |value| written(&value.span));
        length.parse().or_else(|_| value().parse()).ok()
    };
    let found = statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Input(quantity) if kind == Kind::Input => Some((statement, quantity)),
        StatementKind::Prescribed(quantity) if kind == Kind::Signal => Some((statement, quantity)),
        _ => None,
    });
    let declared = found.map(|(statement, quantity)| Declared {
        name: quantity.name.text.clone(),
        unit: quantity.unit.as_ref().map_or("1".to_string(), ToString::to_string),
        end: statement.span.end.saturating_sub(1),
        has_value: quantity.value.is_some(),
        is_array: quantity.length.is_some(),
        length: quantity.length.as_ref().and_then(|length| number(written(&length.span))),
    });
    declared.collect()
}

/// What they and their elements are called, as far as that is known.
pub(super) fn names(declared: &[Declared]) -> Vec<String> {
    let of = |known: &Declared| match known.length {
        Some(length) => (0..length).map(|i| format!("{}_{i}", known.name)).collect(),
        None => vec![known.name.clone()],
    };
    declared.iter().flat_map(of).collect()
}

impl Declared {
    /// Whether it, or an element of it, has this name.
    pub(super) fn is_called(&self, name: &str) -> bool {
        self.name == name || self.element(name).is_some()
    }

    fn element(&self, name: &str) -> Option<usize> {
        let index = name.strip_prefix(self.name.as_str())?.strip_prefix('_').filter(|_| self.is_array)?;
        let number = index.parse().ok().filter(|number: &usize| number.to_string() == index)?;
        self.length.is_none_or(|length| number < length).then_some(number)
    }

    /// What a formula gives, by components: itself, or the elements of `[…, …]` of an array as a whole.
    pub(super) fn formulas_of(&self, drive: &Drive, formula: Insertion) -> Result<Vec<(String, Insertion)>, String> {
        let name = &self.name;
        if !self.is_array || *name != drive.name {
            return Ok(vec![(drive.name.clone(), formula)]);
        }
        let Some(elements) = elements(formula.text()) else {
            let help = format!("write `{name}_0=…`, `{name}_1=…`, or `{name}=[…, …]`");
            return Err(format!("{name}: `{name}` is an array, whose elements have a formula each: {help}"));
        };
        if let Some(length) = self.length.filter(|length| *length != elements.len()) {
            return Err(format!("{name}: `{name}` has {length} elements, this has {}", elements.len()));
        }
        let of = |(i, part): (usize, _)| (format!("{name}_{i}"), formula.slice(part));
        Ok((0..).zip(elements).map(of).collect())
    }

    /// ` = value` for the statement of a signal, from what gives it and its elements by an option; none where no
    /// formula does.
    pub(super) fn value_of(&self, drives: &[&Drive], option: &str) -> Result<Option<Insertion>, String> {
        let name = &self.name;
        let mut value = Insertion::default();
        value.push(" = ");
        let mut formulas: BTreeMap<usize, Insertion> = BTreeMap::new();
        for drive in drives {
            let Source::Formula(formula) = &drive.source else { continue };
            if self.has_value {
                return Err(format!("{}: `{name}` is declared by a formula already", drive.given));
            }
            for (component, formula) in self.formulas_of(drive, drive.quoted(option, formula))? {
                let number = self.element(&component).unwrap_or(0);
                if formulas.insert(number, in_si_units(&formula, name)).is_some() {
                    return Err(format!("{component} is given twice"));
                }
            }
        }
        if formulas.is_empty() {
            return Ok(None);
        }
        if !self.is_array {
            formulas.into_values().take(1).for_each(|formula| value.append(formula));
            return Ok(Some(value));
        }
        if drives.iter().any(|drive| matches!(drive.source, Source::Table(_))) {
            let help = "put the table in a formula: `import` it in the mechanism, and write `table_monotone(t, …)`";
            return Err(format!("{name}: formulas give all elements of an array, or tables do; {help}"));
        }
        let count = self.length.unwrap_or(formulas.keys().last().map_or(0, |last| last + 1));
        if let Some(missing) = (0..count).find(|number| !formulas.contains_key(number)) {
            return Err(format!("{name}: formulas give all elements of an array: write `{name}_{missing}=…`, too"));
        }
        for (i, formula) in formulas.into_values().enumerate() {
            value.push(if i == 0 { "[" } else { ", " });
            value.append(formula);
        }
        value.push("]");
        Ok(Some(value))
    }
}

/// Where the elements of `[…, …]` stand; none of anything else.
fn elements(formula: &str) -> Option<Vec<Range<usize>>> {
    let begin = formula.find('[').filter(|&at| formula[..at].trim().is_empty())? + 1;
    let end = formula.rfind(']').filter(|&at| at >= begin && formula[at + 1..].trim().is_empty())?;
    let mut depth = 0_usize;
    let mut parts: Vec<Range<usize>> = std::iter::once(begin..end).collect();
    for (at, c) in formula[begin..end].char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            // `[a, b] + [c, d]`
            ')' | ']' | '}' => depth = depth.checked_sub(1)?,
            ',' if depth == 0 => {
                parts.last_mut()?.end = begin + at;
                parts.push(begin + at + 1..end);
            }
            _ => {}
        }
    }
    let trimmed = |part: Range<usize>| {
        let text = &formula[part.clone()];
        let start = part.start + text.len() - text.trim_start().len();
        start..start + text.trim().len()
    };
    let parts: Vec<Range<usize>> = parts.into_iter().map(trimmed).collect();
    parts.iter().all(|part| !part.is_empty()).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_elements() {
        for (given, called) in [("road[0]", "road_0"), ("road_0", "road_0"), ("road", "road"), ("f(x)[1]", "f(x)[1]")] {
            assert_eq!(column(given), called);
        }
    }

    #[test]
    fn elements_of_an_array_are_told_from_sums_of_arrays() {
        let of = |formula: &str| {
            let parts = elements(formula)?;
            Some(parts.into_iter().map(|part| &formula[part]).collect::<Vec<_>>().join("|"))
        };
        assert_eq!(of("[a, max(b, c)]").as_deref(), Some("a|max(b, c)"));
        assert_eq!(of("[a, b] + [c, d]"), None);
        assert_eq!(of(" [ a ,b ] ").as_deref(), Some("a|b"));
        assert_eq!(of("2*a"), None);
        assert_eq!(of("[a, ]"), None);
    }
}
