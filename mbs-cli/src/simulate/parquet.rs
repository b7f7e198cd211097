//! The motion as Apache Parquet: the columns of the CSV, doubles, one row group.

use std::sync::Arc;

use parquet::data_type::DoubleType;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::column::Column;
use super::motion::Motion;
use crate::failure::Failure;

/// The file; with units the names of the columns end in them.
pub(crate) fn table(motion: &Motion, units: bool) -> Result<Vec<u8>, Failure> {
    written(motion, units).map_err(|error| Failure::new(format_args!("cannot write Parquet: {error}")))
}

fn written(motion: &Motion, units: bool) -> parquet::errors::Result<Vec<u8>> {
    let time = Column::new("time", "t", "s");
    let columns: Vec<&Column> = [&time].into_iter().chain(&motion.columns).collect();
    let field = |column: &&Column| {
        let name = if units { column.name_with_unit() } else { column.name.clone() };
        let kind = Type::primitive_type_builder(&name, parquet::basic::Type::DOUBLE);
        kind.with_repetition(parquet::basic::Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<parquet::errors::Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("motion").with_fields(fields).build()?;
    let properties = WriterProperties::builder().set_created_by(format!("mbs {}", env!("CARGO_PKG_VERSION"))).build();
    let mut file = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut file, Arc::new(schema), Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for number in 0..columns.len() {
        let value = |row: &super::motion::Row| if number == 0 { row.t } else { row.values[number - 1] };
        let values: Vec<f64> = motion.rows.iter().map(value).collect();
        let Some(mut column) = rows.next_column()? else { break };
        column.typed::<DoubleType>().write_batch(&values, None, None)?;
        column.close()?;
    }
    rows.close()?;
    writer.close()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    use super::super::motion::Row;
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let row = |t: f64| Row { t, kinetic: 0.0, potential: 0.0, values: vec![2.0 * t, -t] };
        let columns = vec![Column::new("coordinates", "x", "m"), Column::new("velocities", "x_dot", "m/s")];
        let motion = Motion { name: "A".to_string(), columns, rows: vec![row(0.0), row(0.5), row(1.0)], stopped: None };
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, &table(&motion, true).unwrap()).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let names: Vec<&str> =
            reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name()).collect();
        assert_eq!(names, ["t_s", "x_m", "x_dot_m_s"]);
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 3);
        assert_eq!((rows[1].get_double(0).unwrap(), rows[1].get_double(1).unwrap()), (0.5, 1.0));
    }
}
