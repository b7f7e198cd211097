//! Tables of times and values, as files of CSV.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};

use mbs_derive::model::Unit;

use super::super::curve::Curve;
use super::element::column;
use crate::failure::Failure;

/// What a column of a table is wanted for.
pub(super) struct Wanted<'a> {
    pub(super) name: &'a str,
    pub(super) unit: &'a str,
    /// Whether the table gives other elements of an array, too: then a header has to tell its columns apart.
    pub(super) is_one_of_several: bool,
}

/// The columns of a table that count: times, and values.
struct Columns {
    /// Where the values stand.
    values: usize,
    /// What times and values are multiplied by: they are in the units of the header, without one in SI units.
    scales: [f64; 2],
}

impl Columns {
    /// As a table without a header has them.
    const FIRST_TWO: Columns = Columns { values: 1, scales: [1.0; 2] };

    /// From a header, `t [ms], push [kN]`: the first column is the time, that of the name has the values.
    fn of(header: &csv::StringRecord, wanted: &Wanted<'_>) -> Result<Columns, String> {
        let headings: Vec<_> = header.iter().map(|cell| heading(cell, wanted.name)).collect();
        let name = wanted.name;
        let called: Vec<usize> = (0..headings.len()).filter(|&i| headings[i].0 == name).collect();
        let values = match called.as_slice() {
            [0] => {
                return Err(format!(
                    "the first column is `{name}`: put it behind that of the time, which is the first"
                ));
            }
            [one] => *one,
            [] => {
                let names: Vec<&str> = headings.iter().map(|(name, _)| *name).collect();
                let separator =
                    if header.len() == 1 { header[0].chars().find(|c| matches!(c, ';' | '\t')) } else { None };
                return Err(match separator {
                    Some(separator) => format!("columns are separated by commas, here by {separator:?}; write commas"),
                    None => format!("there is no column `{name}`; the columns are {}", names.join(", ")),
                });
            }
            _ => return Err(format!("{} columns are called `{name}`; leave one of them", called.len())),
        };
        let scale = |column: usize, unit: &str| match headings[column] {
            (_, None) => Ok(1.0),
            (name, Some(own)) => {
                Unit(unit).in_si(&format!("1 {own}")).map_err(|reason| format!("column `{name}`: {reason}"))
            }
        };
        Ok(Columns { values, scales: [scale(0, "s")?, scale(values, wanted.unit)?] })
    }
}

/// The name and the unit of a column, `push [kN]`; an element may be called as it is declared, `tau[0] [N*m]`.
fn heading<'a>(cell: &'a str, wanted: &'a str) -> (&'a str, Option<&'a str>) {
    let called = |name: &'a str| if column(name) == wanted { wanted } else { name };
    match cell.strip_suffix(']').and_then(|cell| cell.rsplit_once('[')) {
        Some((name, unit)) if column(cell) != wanted => (called(name.trim()), Some(unit.trim())),
        _ => (called(cell), None),
    }
}

/// The tables that were read, each once, however many columns are wanted.
#[derive(Default)]
pub(super) struct Tables(BTreeMap<PathBuf, Vec<csv::StringRecord>>);

impl Tables {
    /// A table whose first column is the time; the values are in the column of this name, without a header in the
    /// second.
    pub(super) fn curve(
        &mut self,
        path: &Path,
        wanted: &Wanted<'_>,
        (start, end): (f64, f64),
        curve: fn(Vec<f64>, Vec<f64>) -> Curve,
    ) -> Result<Curve, Failure> {
        let refused = |reason: String| Failure::new(format_args!("{}: {reason}", path.display()));
        let (times, values) = columns(self.records(path)?, wanted).map_err(refused)?;
        let curve = curve(times, values);
        let (first, last) = curve.range();
        if start < first || end > last {
            return Err(refused(format!(
                "it goes from t = {first:?} to {last:?}, the motion from {start:?} to {end:?}"
            )));
        }
        Ok(curve)
    }

    fn records(&mut self, path: &Path) -> Result<&[csv::StringRecord], Failure> {
        match self.0.entry(path.to_path_buf()) {
            Entry::Occupied(entry) => Ok(entry.into_mut()),
            Entry::Vacant(entry) => Ok(entry.insert(read(path)?)),
        }
    }
}

fn read(path: &Path) -> Result<Vec<csv::StringRecord>, Failure> {
    let shown = path.display();
    let bytes = fs::read(path).map_err(|error| Failure::new(format_args!("cannot read {shown}: {error}")))?;
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).comment(Some(b'#')).trim(csv::Trim::All).from_reader(&*bytes);
    let records: Result<_, csv::Error> = reader.records().collect();
    records.map_err(|error| Failure::new(format_args!("{shown}: {error}")))
}

/// Times and values.
fn columns(records: &[csv::StringRecord], wanted: &Wanted<'_>) -> Result<(Vec<f64>, Vec<f64>), String> {
    let (mut times, mut values, mut columns) = (Vec::new(), Vec::new(), Columns::FIRST_TWO);
    for (number, record) in records.iter().enumerate() {
        let line = record.position().map_or(0, |position| position.line());
        let cell = |i: usize| -> Result<f64, String> {
            let text = record.get(i).ok_or_else(|| format!("line {line} has no column {}", i + 1))?;
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| format!("line {line}, column {}: `{text}` is not a finite number", i + 1))
        };
        if number == 0 && record.iter().any(|cell| cell.parse::<f64>().is_err()) {
            columns = Columns::of(record, wanted)?;
            continue;
        }
        if number == 0 && wanted.is_one_of_several {
            let name = wanted.name;
            return Err(format!(
                "a table for a whole array needs a header, with a column for `{name}`: `t, {name}, …`"
            ));
        }
        let [time, value] = [columns.scales[0] * cell(0)?, columns.scales[1] * cell(columns.values)?];
        if let Some(last) = times.last().filter(|last| **last >= time) {
            return Err(format!("line {line}: times must increase, {time:?} comes after {last:?}"));
        }
        times.push(time);
        values.push(value);
    }
    if times.len() < 2 {
        return Err("a table has two rows at least".to_string());
    }
    Ok((times, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_once_for_all_its_columns() {
        let path = std::env::temp_dir().join(format!("mbs_table_{}.csv", std::process::id()));
        fs::write(&path, "t, a [mm], b\n0, 1000, 3\n1, 2000, 4\n").unwrap();
        let mut tables = Tables::default();
        let mut at_half = |name: &str| {
            let curve = tables.curve(
                &path,
                &Wanted { name, unit: "m", is_one_of_several: true },
                (0.0, 1.0),
                Curve::broken_line,
            );
            curve.map(|curve| curve.at(0.5)[0]).ok()
        };
        assert_eq!(at_half("a"), Some(1.5));
        fs::remove_file(&path).unwrap();
        assert_eq!(at_half("b"), Some(3.5));
    }
}
