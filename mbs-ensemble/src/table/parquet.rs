//! The table as Apache Parquet, in row groups of as many members as memory holds easily, whatever their number.

use std::fs::File;
use std::io;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::{Column, Identity, Row, Sink, metadata};

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
