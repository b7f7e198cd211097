//! Tables that were written, column by column.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::Column;
use crate::error::SweepError;
use crate::journal::Identity;

/// A table that was written: by an ensemble, or by another program with numbers in columns.
///
/// ```
/// use mbs_ensemble::table::Table;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("throws.csv");
/// std::fs::write(&path, "# unit of height: m\nmember,height,stopped\n0,1.25,\n1,,\"it fell\"\n")?;
/// let table = Table::read(&path)?;
/// assert_eq!((table.rows, table.stopped), (2, 1));
/// let height = table.column("height").unwrap();
/// assert_eq!((height.about.unit.as_str(), height.values[0]), ("m", 1.25));
/// assert!(height.values[1].is_nan());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// How many rows there are.
    pub rows: usize,
    /// How many say why they stopped.
    pub stopped: usize,
    /// The columns of numbers, in their order, but for `member`.
    pub columns: Vec<Numbers>,
    /// Units and provenance.
    metadata: Vec<(String, String)>,
}

/// A column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Its name and unit.
    pub about: Column,
    /// One for each row, NaN where there is none.
    pub values: Vec<f64>,
}

/// The column that has the members' indices, and the one that says why they stopped.
const INDEX: &str = "member";
const STOPPED: &str = "stopped";

impl Table {
    /// Reads a file: Parquet where its name ends so, and this crate has the feature, else CSV.
    ///
    /// # Errors
    /// The file cannot be read, or is no table with a column of numbers.
    pub fn read(path: &Path) -> Result<Table, SweepError> {
        let table = match is_parquet(path) {
            #[cfg(feature = "parquet")]
            true => super::parquet::read(path)?,
            #[cfg(not(feature = "parquet"))]
            true => return Err(SweepError::table(path, "it is Parquet, which this program is built without")),
            false => csv(path)?,
        };
        if table.columns.is_empty() {
            return Err(SweepError::table(path, "it has no column of numbers"));
        }
        Ok(table)
    }

    /// The column with this name.
    pub fn column(&self, name: &str) -> Option<&Numbers> {
        self.columns.iter().find(|column| column.about.name == name)
    }

    /// The names of what it was not made of: `the plan`, for example.
    pub fn differences(&self, identity: &Identity) -> Vec<String> {
        differences(&self.metadata, identity)
    }

    /// Of columns that were read, those that count.
    pub(super) fn of(
        names: Vec<String>,
        values: Vec<Vec<f64>>,
        stopped: usize,
        metadata: Vec<(String, String)>,
    ) -> Self {
        let rows = values.iter().map(Vec::len).max().unwrap_or(0);
        let unit = |name: &str| {
            let key = format!("unit of {name}");
            metadata.iter().find(|(other, _)| *other == key).map_or("1", |(_, unit)| unit.as_str())
        };
        let columns = names.into_iter().zip(values).filter(|(name, values)| {
            // The index says nothing about a member, and the reason why it stopped is a text.
            name != INDEX && values.iter().any(|value| value.is_finite())
        });
        let columns = columns.map(|(name, values)| Numbers { about: Column::new(&name, unit(&name)), values });
        let columns = columns.collect();
        Table { rows, stopped, columns, metadata }
    }
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

/// Whether a file is a table that was made of this; none of its rows is read.
pub(crate) fn is_made_of(path: &Path, identity: &Identity) -> bool {
    let metadata = match is_parquet(path) {
        #[cfg(feature = "parquet")]
        true => super::parquet::metadata_of(path),
        #[cfg(not(feature = "parquet"))]
        true => return false,
        false => csv_metadata(path),
    };
    metadata.is_ok_and(|metadata| differences(&metadata, identity).is_empty())
}

/// The names of what a table with these units and provenance was not made of.
fn differences(metadata: &[(String, String)], identity: &Identity) -> Vec<String> {
    let has = |name: &str, digest: &str| metadata.iter().any(|(key, value)| key == name && value == digest);
    let missing = identity.parts().filter(|(name, digest)| !has(name, digest));
    missing.map(|(name, _)| format!("the {name}")).collect()
}

/// The pairs in the comments above the header.
fn csv_metadata(path: &Path) -> Result<Vec<(String, String)>, SweepError> {
    let failed = |error| SweepError::io("read", path, error);
    let mut metadata = Vec::new();
    for line in BufReader::new(File::open(path).map_err(failed)?).lines() {
        let line = line.map_err(failed)?;
        let Some(comment) = line.strip_prefix('#') else { break };
        let pair = comment.trim().split_once(": ");
        metadata.extend(pair.map(|(key, value)| (key.to_string(), value.to_string())));
    }
    Ok(metadata)
}

fn csv(path: &Path) -> Result<Table, SweepError> {
    let failed = |error| SweepError::io("read", path, error);
    let refused = |error: csv::Error| match error.into_kind() {
        csv::ErrorKind::Io(error) => failed(error),
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.map_or(0, |place| place.line());
            SweepError::table(path, &format!("line {line} has {len} cells, the header {expected_len}"))
        }
        _ => SweepError::table(path, "it is no table of commas and lines"),
    };
    let metadata = csv_metadata(path)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(refused)?;
    let names: Vec<String> = reader.headers().map_err(refused)?.iter().map(str::to_string).collect();
    let place = names.iter().position(|name| name == STOPPED);
    let mut values = vec![Vec::new(); names.len()];
    let (mut record, mut stopped) = (csv::ByteRecord::new(), 0);
    while reader.read_byte_record(&mut record).map_err(refused)? {
        for (number, (column, cell)) in values.iter_mut().zip(&record).enumerate() {
            if place == Some(number) {
                stopped += usize::from(!cell.is_empty());
                continue;
            }
            let value = std::str::from_utf8(cell).ok().and_then(|cell| cell.parse().ok());
            column.push(value.unwrap_or(f64::NAN));
        }
    }
    Ok(Table::of(names, values, stopped, metadata))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: &str) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        std::fs::write(&path, text).unwrap();
        let found = match Table::read(&path) {
            Ok(table) => {
                let columns = table.columns.iter().map(|c| format!("{} {} {:?}", c.about.name, c.about.unit, c.values));
                format!("{} {}: {}", table.rows, table.stopped, columns.collect::<Vec<_>>().join("; "))
            }
            Err(error) => error.to_string().replace(&path.display().to_string(), "FILE"),
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn tables_are_read_or_refused() {
        check("# unit of x: m\nmember,x,stopped\n0,1.5,\n1,,\"no, \"\"it\"\" fell\"\n", "2 1: x m [1.5, NaN]");
        check("x,y,word\n1,2,a\n3,4,b\n", "2 0: x 1 [1.0, 3.0]; y 1 [2.0, 4.0]");
        check("member,stopped\n0,\n", "FILE: it has no column of numbers");
        check("x,y\n", "FILE: it has no column of numbers");
        check("", "FILE: it has no column of numbers");
        check("x,y\n1\n", "FILE: line 2 has 1 cells, the header 2");
    }

    #[test]
    fn a_table_knows_what_it_was_made_of() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        std::fs::write(&path, "# plan: a\n# mechanism: b\nmember,x\n0,1\n").unwrap();
        let table = Table::read(&path).unwrap();
        let identity = |plan: &str| Identity::new([("plan", plan.to_string()), ("mechanism", "b".to_string())]);
        assert!(table.differences(&identity("a")).is_empty());
        assert_eq!(table.differences(&identity("c")), ["the plan"]);
    }
}
