//! The table as Apache Parquet, in row groups of as many members as memory holds easily, whatever their number.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::{FileMetaData, KeyValue};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::reading::Table;
use super::{Column, Identity, Row, Sink, metadata};
use crate::error::SweepError;

/// Rows of a row group.
const GROUP: usize = 1 << 16;

/// A table that is being written.
pub(super) struct Parquet {
    writer: SerializedFileWriter<File>,
    members: Vec<i64>,
    /// Column by column.
    numbers: Vec<Vec<f64>>,
    stopped: Vec<Option<String>>,
}

impl Parquet {
    pub(super) fn new(file: File, columns: &[Column], identity: &Identity) -> io::Result<Self> {
        let created = || -> Result<_, ParquetError> {
            let field = |name: &str, kind, repetition, converted| {
                let builder = Type::primitive_type_builder(name, kind).with_repetition(repetition);
                builder.with_converted_type(converted).build().map(Arc::new)
            };
            let mut fields = vec![field("member", Physical::INT64, Repetition::REQUIRED, ConvertedType::NONE)?];
            for column in columns {
                fields.push(field(&column.name, Physical::DOUBLE, Repetition::OPTIONAL, ConvertedType::NONE)?);
            }
            fields.push(field("stopped", Physical::BYTE_ARRAY, Repetition::OPTIONAL, ConvertedType::UTF8)?);
            let schema = Arc::new(Type::group_type_builder("ensemble").with_fields(fields).build()?);
            let pairs = metadata(columns, identity).map(|(key, value)| KeyValue::new(key, value)).collect();
            let properties = WriterProperties::builder()
                .set_created_by(format!("mbs {}", env!("CARGO_PKG_VERSION")))
                .set_key_value_metadata(Some(pairs));
            SerializedFileWriter::new(file, schema, Arc::new(properties.build()))
        };
        let writer = created().map_err(io::Error::other)?;
        Ok(Parquet { writer, members: Vec::new(), numbers: vec![Vec::new(); columns.len()], stopped: Vec::new() })
    }

    /// Writes the rows that were gathered.
    fn group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        if let Some(mut column) = group.next_column()? {
            column.typed::<Int64Type>().write_batch(&self.members, None, None)?;
            column.close()?;
        }
        for numbers in &self.numbers {
            let Some(mut column) = group.next_column()? else { break };
            let present: Vec<f64> = numbers.iter().copied().filter(|number| !number.is_nan()).collect();
            let levels: Vec<i16> = numbers.iter().map(|number| i16::from(!number.is_nan())).collect();
            column.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
            column.close()?;
        }
        if let Some(mut column) = group.next_column()? {
            let present: Vec<ByteArray> = self.stopped.iter().flatten().map(|reason| reason.as_str().into()).collect();
            let levels: Vec<i16> = self.stopped.iter().map(|reason| i16::from(reason.is_some())).collect();
            column.typed::<ByteArrayType>().write_batch(&present, Some(&levels), None)?;
            column.close()?;
        }
        group.close()?;
        self.members.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
        self.stopped.clear();
        Ok(())
    }
}

impl Sink for Parquet {
    fn row(&mut self, index: u64, values: &[f64], row: &Row) -> io::Result<()> {
        self.members.push(index as i64);
        for (column, number) in self.numbers.iter_mut().zip(values.iter().chain(&row.quantities)) {
            column.push(*number);
        }
        self.stopped.push(row.stopped.clone());
        if self.members.len() == GROUP { self.group().map_err(io::Error::other) } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if !self.members.is_empty() {
            self.group().map_err(io::Error::other)?;
        }
        let file = self.writer.into_inner().map_err(io::Error::other)?;
        file.sync_all()
    }
}

/// Reads a table: its columns of numbers, whoever wrote it.
pub(super) fn read(path: &Path) -> Result<Table, SweepError> {
    let file = File::open(path).map_err(|error| SweepError::io("read", path, error))?;
    read_from(file).map_err(|error| SweepError::table(path, &error.to_string()))
}

/// Units and provenance of a file.
pub(super) fn metadata_of(path: &Path) -> Result<Vec<(String, String)>, SweepError> {
    let file = File::open(path).map_err(|error| SweepError::io("read", path, error))?;
    let reader = SerializedFileReader::new(file).map_err(|error| SweepError::table(path, &error.to_string()))?;
    Ok(pairs(reader.metadata().file_metadata()))
}

fn pairs(about: &FileMetaData) -> Vec<(String, String)> {
    let pairs = about.key_value_metadata().into_iter().flatten();
    pairs.filter_map(|pair| Some((pair.key.clone(), pair.value.clone()?))).collect()
}

fn read_from(file: File) -> Result<Table, ParquetError> {
    let reader = SerializedFileReader::new(file)?;
    let about = reader.metadata().file_metadata();
    let pairs = pairs(about);
    let names: Vec<String> = about.schema_descr().columns().iter().map(|column| column.name().to_string()).collect();
    let mut values = vec![Vec::new(); names.len()];
    let mut stopped = 0;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = group.metadata().num_rows() as usize;
        for (number, values) in values.iter_mut().enumerate() {
            match group.get_column_reader(number)? {
                ColumnReader::DoubleColumnReader(column) => values.extend(numbers(column, rows, |x| *x)?),
                ColumnReader::FloatColumnReader(column) => values.extend(numbers(column, rows, |x| f64::from(*x))?),
                ColumnReader::Int32ColumnReader(column) => values.extend(numbers(column, rows, |x| f64::from(*x))?),
                ColumnReader::Int64ColumnReader(column) => values.extend(numbers(column, rows, |x| *x as f64)?),
                ColumnReader::ByteArrayColumnReader(column) if names[number] == "stopped" => {
                    stopped += numbers(column, rows, |_| 1.0)?.into_iter().filter(|value| *value == 1.0).count();
                }
                _ => {}
            }
        }
    }
    Ok(Table::of(names, values, stopped, pairs))
}

/// The numbers of a column of one row group, NaN where it is null.
fn numbers<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: usize,
    number: impl Fn(&T::T) -> f64,
) -> Result<Vec<f64>, ParquetError> {
    let (mut found, mut levels) = (Vec::new(), Vec::new());
    // The levels stay empty where a column has no nulls.
    let (records, _, _) = column.read_records(rows, Some(&mut levels), None, &mut found)?;
    if records != rows {
        return Err(ParquetError::EOF(format!("{rows} rows are promised, {records} are there")));
    }
    let mut present = found.iter().map(number);
    if levels.is_empty() {
        return Ok(present.collect());
    }
    Ok(levels.iter().map(|level| if *level > 0 { present.next().unwrap_or(f64::NAN) } else { f64::NAN }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More rows than a row group has, some without a number.
    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        let columns = [Column::new("x", "m"), Column::new("y", "1")];
        let identity = Identity::new([("plan", "p".to_string())]);
        let mut sink = Box::new(Parquet::new(File::create(&path).unwrap(), &columns, &identity).unwrap());
        let count = GROUP as u64 + 10;
        let y = |index: u64| if index.is_multiple_of(3) { f64::NAN } else { index as f64 / 7.0 };
        for index in 0..count {
            let stopped = index.is_multiple_of(3).then(|| "it \"fell\"".to_string());
            sink.row(index, &[index as f64], &Row { quantities: vec![y(index)], stopped }).unwrap();
        }
        sink.finish().unwrap();
        let table = Table::read(&path).unwrap();
        assert_eq!((table.rows as u64, table.stopped as u64), (count, count.div_ceil(3)));
        assert!(table.differences(&identity).is_empty());
        let [x, found] = &table.columns[..] else { panic!("{:?}", table.columns.len()) };
        assert_eq!((&x.about, &found.about), (&columns[0], &columns[1]));
        for index in 0..count {
            assert_eq!(x.values[index as usize], index as f64);
            assert_eq!(found.values[index as usize].to_bits(), y(index).to_bits(), "{index}");
        }
        std::fs::write(&path, "no table").unwrap();
        assert!(Table::read(&path).unwrap_err().to_string().contains("table.parquet: "));
    }
}
