//! The table of an ensemble: a row for each member, in the order of their indices, what varied before what came of it.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::design::Design;
use crate::error::SweepError;
use crate::journal::{Identity, Row};

#[cfg(feature = "parquet")]
mod parquet;
mod reading;

pub(crate) use reading::is_made_of;
pub use reading::{Numbers, Table};

/// A column with its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// In the header.
    pub name: String,
    /// That of its numbers, `1` for plain ones.
    pub unit: String,
}

impl Column {
    /// A column of this name and unit.
    pub fn new(name: &str, unit: &str) -> Self {
        Column { name: name.to_string(), unit: unit.to_string() }
    }
}

/// What a table is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Commas between, comments with units and provenance above; what is missing is empty.
    Csv,
    /// Apache Parquet, with units and provenance in its metadata; what is missing is null.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// The columns behind `member` and before `stopped`.
pub(crate) fn columns(design: &Design, quantities: &[Column]) -> Vec<Column> {
    let varied = design.variables().iter().map(|variable| Column::new(&variable.name, &variable.unit));
    varied.chain(quantities.iter().cloned()).collect()
}

/// What takes rows one by one.
pub(crate) trait Sink {
    /// A member, its values and quantities.
    fn row(&mut self, index: u64, values: &[f64], row: &Row) -> std::io::Result<()>;
    /// The end of the table.
    fn finish(self: Box<Self>) -> std::io::Result<()>;
}

/// A table of this format at this place.
pub(crate) fn sink(
    format: Format,
    path: &Path,
    columns: &[Column],
    identity: &Identity,
) -> Result<Box<dyn Sink>, SweepError> {
    let failed = |error| SweepError::io("write", path, error);
    let file = File::create(path).map_err(failed)?;
    match format {
        Format::Csv => Ok(Box::new(Csv::new(file, columns, identity).map_err(failed)?)),
        #[cfg(feature = "parquet")]
        Format::Parquet => Ok(Box::new(parquet::Parquet::new(file, columns, identity).map_err(failed)?)),
    }
}

/// Units and provenance as pairs of key and value.
pub(crate) fn metadata<'a>(
    columns: &'a [Column],
    identity: &'a Identity,
) -> impl Iterator<Item = (String, String)> + 'a {
    let units = columns.iter().map(|column| (format!("unit of {}", column.name), column.unit.clone()));
    identity.parts().map(|(name, digest)| (name.to_string(), digest.to_string())).chain(units)
}

struct Csv {
    file: BufWriter<File>,
}

impl Csv {
    fn new(file: File, columns: &[Column], identity: &Identity) -> std::io::Result<Self> {
        let mut file = BufWriter::new(file);
        for (key, value) in metadata(columns, identity) {
            writeln!(file, "# {key}: {value}")?;
        }
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        writeln!(file, "{}", [&["member"], &names[..], &["stopped"]].concat().join(","))?;
        Ok(Csv { file })
    }
}

impl Sink for Csv {
    fn row(&mut self, index: u64, values: &[f64], row: &Row) -> std::io::Result<()> {
        write!(self.file, "{index}")?;
        for number in values.iter().chain(&row.quantities) {
            // `{:?}` is the shortest text that reads as the same number.
            if number.is_nan() { write!(self.file, ",") } else { write!(self.file, ",{number:?}") }?;
        }
        match &row.stopped {
            None => writeln!(self.file, ","),
            Some(reason) => writeln!(self.file, ",\"{}\"", reason.replace('"', "\"\"").replace(['\n', '\r'], " ")),
        }
    }

    fn finish(self: Box<Self>) -> std::io::Result<()> {
        self.file.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()
    }
}
