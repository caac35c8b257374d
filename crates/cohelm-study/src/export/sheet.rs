//! A table with a meaning for every column, written as CSV, as Parquet and into the data dictionary.

use super::ExportError;
use crate::csv::{Cell, Csv};
use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

/// Of which type a column's values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Text, or one of a list of words.
    Text,
    /// A whole number.
    Integer,
    /// A number.
    Number,
    /// True or false.
    Truth,
}

impl Kind {
    /// The word for it in the dictionary.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Text => "text",
            Kind::Integer => "integer",
            Kind::Number => "number",
            Kind::Truth => "boolean",
        }
    }
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub key: String,
    /// What it means.
    pub meaning: String,
    /// In what it counts.
    pub unit: String,
    /// Of which type its values are.
    pub kind: Kind,
    /// Which values it can have.
    pub range: String,
    /// When it is empty.
    pub missing_when: String,
}

/// A table. Every row has a cell a column, of the column's type or empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Its name, that of its files.
    pub name: &'static str,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

impl Sheet {
    /// As CSV, formulas in text defused.
    pub fn csv(&self) -> Csv {
        let mut csv = Csv::new(self.columns.iter().map(|column| column.key.as_str()));
        self.rows.iter().for_each(|row| csv.push(row.iter().cloned()));
        csv
    }

    /// As Parquet: one row group, uncompressed, every column optional. Equal tables have equal bytes.
    ///
    /// # Errors
    /// The library refuses; no table that this crate makes does that.
    pub fn parquet(&self) -> Result<Vec<u8>, ExportError> {
        self.write_parquet()
            .map_err(|error| ExportError::Parquet { table: self.name, reason: error.to_string() })
    }

    fn write_parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let fields = self.columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
        let schema = Type::group_type_builder(self.name).with_fields(fields).build()?;
        let properties = WriterProperties::builder()
            .set_created_by("cohelm".to_owned())
            .set_writer_version(WriterVersion::PARQUET_1_0)
            .set_compression(Compression::UNCOMPRESSED)
            .build();
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        let mut index = 0;
        while let Some(mut column) = group.next_column()? {
            let cells = self.rows.iter().map(|row| row.get(index).unwrap_or(&Cell::Empty));
            write_column(column.untyped(), cells)?;
            column.close()?;
            index += 1;
        }
        group.close()?;
        writer.close()?;
        Ok(bytes)
    }
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
    let physical = match column.kind {
        Kind::Text => Physical::BYTE_ARRAY,
        Kind::Integer => Physical::INT64,
        Kind::Number => Physical::DOUBLE,
        Kind::Truth => Physical::BOOLEAN,
    };
    let builder = Type::primitive_type_builder(&column.key, physical).with_repetition(Repetition::OPTIONAL);
    let builder = match column.kind {
        Kind::Text => {
            builder.with_logical_type(Some(LogicalType::String)).with_converted_type(ConvertedType::UTF8)
        }
        _ => builder,
    };
    Ok(Arc::new(builder.build()?))
}

fn write_column<'a>(
    writer: &mut ColumnWriter<'_>,
    cells: impl Iterator<Item = &'a Cell> + Clone,
) -> Result<(), ParquetError> {
    match writer {
        ColumnWriter::ByteArrayColumnWriter(writer) => {
            let (values, levels) = split(cells, text_of);
            writer.write_batch(&values, Some(&levels), None)?;
        }
        ColumnWriter::Int64ColumnWriter(writer) => {
            let (values, levels) = split(cells, integer_of);
            writer.write_batch(&values, Some(&levels), None)?;
        }
        ColumnWriter::DoubleColumnWriter(writer) => {
            let (values, levels) = split(cells, number_of);
            writer.write_batch(&values, Some(&levels), None)?;
        }
        ColumnWriter::BoolColumnWriter(writer) => {
            let (values, levels) = split(cells, truth_of);
            writer.write_batch(&values, Some(&levels), None)?;
        }
        _ => return Err(ParquetError::General("a column of a type that was not asked for".to_owned())),
    }
    Ok(())
}

/// The values that are there, and for every row whether one is.
fn split<'a, T>(
    cells: impl Iterator<Item = &'a Cell>,
    value_of: impl Fn(&Cell) -> Option<T>,
) -> (Vec<T>, Vec<i16>) {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for cell in cells {
        let value = value_of(cell);
        levels.push(i16::from(value.is_some()));
        values.extend(value);
    }
    (values, levels)
}

fn text_of(cell: &Cell) -> Option<ByteArray> {
    match cell {
        Cell::Text(text) => Some(ByteArray::from(text.as_str())),
        _ => None,
    }
}

fn integer_of(cell: &Cell) -> Option<i64> {
    match cell {
        Cell::Integer(integer) => Some(*integer),
        _ => None,
    }
}

fn number_of(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(number) => Some(*number).filter(|number| number.is_finite()),
        Cell::Integer(integer) => Some(*integer as f64),
        _ => None,
    }
}

/// [`Cell::from`] writes a truth as a word.
fn truth_of(cell: &Cell) -> Option<bool> {
    match cell {
        Cell::Text(text) => text.parse().ok(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    fn sheet() -> Sheet {
        let column = |key: &str, kind| Column {
            key: key.into(),
            meaning: String::new(),
            unit: String::new(),
            kind,
            range: String::new(),
            missing_when: String::new(),
        };
        let columns = vec![
            column("who", Kind::Text),
            column("ticks", Kind::Integer),
            column("share", Kind::Number),
            column("right", Kind::Truth),
        ];
        let rows = vec![
            vec![Cell::from("=1+1"), Cell::from(-7_i64), Cell::from(0.1 + 0.2), Cell::from(true)],
            vec![Cell::Empty, Cell::Empty, Cell::from(f64::NAN), Cell::Empty],
        ];
        Sheet { name: "trials", columns, rows }
    }

    #[test]
    fn parquet_brings_back_every_value_and_what_is_missing() {
        let reader = SerializedFileReader::new(bytes::Bytes::from(sheet().parquet().unwrap())).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0].get_string(0).unwrap(), "=1+1", "no apostrophe: no spreadsheet evaluates Parquet");
        assert_eq!(rows[0].get_long(1).unwrap(), -7);
        assert_eq!(rows[0].get_double(2).unwrap(), 0.1 + 0.2);
        assert!(rows[0].get_bool(3).unwrap());
        assert_eq!(rows[1].to_string(), "{who: null, ticks: null, share: null, right: null}");
    }

    #[test]
    fn equal_tables_have_equal_bytes_and_an_empty_one_its_columns() {
        assert_eq!(sheet().parquet().unwrap(), sheet().parquet().unwrap());
        let empty = Sheet { rows: Vec::new(), ..sheet() };
        let reader = SerializedFileReader::new(bytes::Bytes::from(empty.parquet().unwrap())).unwrap();
        assert_eq!(reader.metadata().file_metadata().schema_descr().num_columns(), 4);
        assert_eq!(reader.get_row_iter(None).unwrap().count(), 0);
    }

    #[test]
    fn csv_defuses_text_and_leaves_numbers_alone() {
        let csv = sheet().csv().to_string();
        assert_eq!(csv.lines().nth(1), Some("'=1+1,-7,0.30000000000000004,true"));
    }
}
