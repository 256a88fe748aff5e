//! Writes and reads Apache Parquet, which pandas, Polars, DuckDB and Spark read.
//! Columns keep their types. They are written in groups of rows, so that a long run needs the memory of one group only.
//! The crate `parquet` implements the format; values are not compressed.

#[cfg(feature = "parquet")]
pub use reader::read;
#[cfg(feature = "parquet")]
pub use writer::{ParquetWriter, write_table};

/// The values of one column, for one group of rows.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues<'a> {
    /// Numbers. NaN if there is no value.
    Real(Vec<f64>),
    /// Integers. `None` if there is no value.
    Integer(Vec<Option<i64>>),
    /// Boolean values. `None` if there is no value.
    Boolean(Vec<Option<bool>>),
    /// Texts. `None` if there is no value.
    Text(Vec<Option<&'a str>>),
}

#[cfg(feature = "parquet")]
mod writer {
    use super::ColumnValues;
    use crate::trajectory::{Kind, Signal};
    use ::parquet::basic::{LogicalType, Repetition, Type as Physical};
    use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
    use ::parquet::errors::ParquetError;
    use ::parquet::file::metadata::KeyValue;
    use ::parquet::file::properties::WriterProperties;
    use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
    use ::parquet::schema::types::{ColumnPath, Type};
    use std::io::{self, Write};
    use std::sync::Arc;

    /// The description of a column.
    struct ColumnHeader {
        /// The name of the column.
        name: String,
        /// The unit. Empty if there is none.
        unit: String,
        /// The type in the file.
        kind: Physical,
    }

    /// Writes a file, one group of rows after the other.
    pub struct ParquetWriter<W: Write + Send> {
        /// The writer of the crate `parquet`.
        file: SerializedFileWriter<W>,
        /// The types of all columns, time first.
        kinds: Vec<Kind>,
    }

    impl<W: Write + Send> ParquetWriter<W> {
        /// Begins the file of a run: `time` in s, then the signals. Booleans, Integers and enumerations keep their
        /// types, the
        /// latter as texts. Units are in the metadata of the file, as JSON below the key `units`.
        ///
        /// # Errors
        /// The errors of the destination.
        pub fn new(out: W, signals: &[Signal]) -> io::Result<Self> {
            let time = ColumnHeader { name: "time".into(), unit: "s".into(), kind: Physical::DOUBLE };
            let head =
                |s: &Signal| ColumnHeader { name: s.name.clone(), unit: s.unit.clone(), kind: physical(&s.kind) };
            let heads: Vec<ColumnHeader> = std::iter::once(time).chain(signals.iter().map(head)).collect();
            let kinds = std::iter::once(Kind::Real).chain(signals.iter().map(|s| s.kind.clone())).collect();
            Ok(ParquetWriter { file: begin(out, &heads)?, kinds })
        }

        /// Writes rows that stand one after the other, each with its time first, as one group.
        ///
        /// # Errors
        /// The errors of the destination.
        pub fn rows(&mut self, rows: &[f64]) -> io::Result<()> {
            // An empty group would be legal but useless.
            if rows.is_empty() {
                return Ok(());
            }
            let width = self.kinds.len();
            // Rows become columns: every `width`-th number belongs to the same one.
            let column = |k: usize| rows.iter().skip(k).step_by(width).copied();
            let columns = self.kinds.iter().enumerate().map(|(k, kind)| values(kind, column(k)));
            write_group(&mut self.file, columns)
        }

        /// Writes the footer of the file, which says where everything is, and flushes the destination.
        ///
        /// # Errors
        /// The errors of the destination.
        pub fn finish(mut self) -> io::Result<()> {
            self.file.finish().map_err(reported)?;
            self.file.inner_mut().flush()
        }
    }

    impl<W: Write + Send> crate::formats::ResultWriter for ParquetWriter<W> {
        fn rows(&mut self, rows: &[f64]) -> io::Result<()> {
            ParquetWriter::rows(self, rows)
        }

        fn flush(&mut self) -> io::Result<u64> {
            // The size is not needed, since the format does not grow.
            self.file.inner_mut().flush()?;
            Ok(0)
        }

        fn finish(self: Box<Self>) -> io::Result<()> {
            ParquetWriter::finish(*self)
        }
    }

    /// Writes a table whose columns are in memory.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn write_table(out: impl Write + Send, columns: &[(String, ColumnValues<'_>)]) -> io::Result<()> {
        let kind = |values: &ColumnValues<'_>| match values {
            ColumnValues::Real(_) => Physical::DOUBLE,
            ColumnValues::Integer(_) => Physical::INT64,
            ColumnValues::Boolean(_) => Physical::BOOLEAN,
            ColumnValues::Text(_) => Physical::BYTE_ARRAY,
        };
        let head = |(name, values): &(String, ColumnValues<'_>)| ColumnHeader {
            name: name.clone(),
            unit: String::new(),
            kind: kind(values),
        };
        let mut file = begin(out, &columns.iter().map(head).collect::<Vec<_>>())?;
        write_group(&mut file, columns.iter().map(|(_, values)| values.clone()))?;
        file.finish().map(|_| ()).map_err(reported)
    }

    /// Begins a file: schema, metadata, and properties of the columns.
    fn begin<W: Write + Send>(out: W, heads: &[ColumnHeader]) -> io::Result<SerializedFileWriter<W>> {
        let fields: Result<Vec<_>, ParquetError> = heads.iter().map(|h| field(h).map(Arc::new)).collect();
        let root =
            Type::group_type_builder("schema").with_fields(fields.map_err(reported)?).build().map_err(reported)?;
        let units: serde_json::Map<String, serde_json::Value> =
            heads.iter().filter(|h| !h.unit.is_empty()).map(|h| (h.name.clone(), h.unit.clone().into())).collect();
        let units = KeyValue::new("units".to_owned(), serde_json::Value::Object(units).to_string());
        let mut properties = WriterProperties::builder()
            .set_created_by(concat!("bramah ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(vec![units]))
            .set_dictionary_enabled(false);
        // Texts of an enumeration or a status repeat; a dictionary stores each of them once.
        for head in heads.iter().filter(|h| h.kind == Physical::BYTE_ARRAY) {
            properties = properties.set_column_dictionary_enabled(ColumnPath::new(vec![head.name.clone()]), true);
        }
        SerializedFileWriter::new(out, Arc::new(root), Arc::new(properties.build())).map_err(reported)
    }

    /// A column of the schema. Only numbers are required, since NaN stands for a missing one; other types are optional.
    fn field(head: &ColumnHeader) -> Result<Type, ParquetError> {
        let always = head.kind == Physical::DOUBLE;
        Type::primitive_type_builder(&head.name, head.kind)
            .with_repetition(if always { Repetition::REQUIRED } else { Repetition::OPTIONAL })
            .with_logical_type((head.kind == Physical::BYTE_ARRAY).then_some(LogicalType::String))
            .build()
    }

    /// Writes a group of rows, column by column in the order of the schema.
    fn write_group<'a, W: Write + Send>(
        file: &mut SerializedFileWriter<W>,
        columns: impl Iterator<Item = ColumnValues<'a>>,
    ) -> io::Result<()> {
        let mut group = file.next_row_group().map_err(reported)?;
        for values in columns {
            let mut column = group.next_column().map_err(reported)?.expect("as many columns as in the schema");
            write_column(&mut column, values).map_err(reported)?;
            column.close().map_err(reported)?;
        }
        group.close().map(|_| ()).map_err(reported)
    }

    /// Writes the values of one column.
    fn write_column(column: &mut SerializedColumnWriter<'_>, values: ColumnValues<'_>) -> Result<(), ParquetError> {
        match values {
            ColumnValues::Real(v) => {
                column.typed::<DoubleType>().write_batch(&v, None, None)?;
            }
            ColumnValues::Integer(v) => write_known::<Int64Type>(column, v)?,
            ColumnValues::Boolean(v) => write_known::<BoolType>(column, v)?,
            ColumnValues::Text(v) => {
                write_known::<ByteArrayType>(column, v.into_iter().map(|t| t.map(ByteArray::from)).collect())?;
            }
        }
        Ok(())
    }

    /// Writes values of which some may be missing.
    fn write_known<T: DataType>(
        column: &mut SerializedColumnWriter<'_>,
        values: Vec<Option<T::T>>,
    ) -> Result<(), ParquetError> {
        // Definition levels: 1 for a value, 0 for a missing one. Only existing values are stored.
        let there: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
        let known: Vec<T::T> = values.into_iter().flatten().collect();
        column.typed::<T>().write_batch(&known, Some(&there), None).map(|_| ())
    }

    /// The type in the file for a type of signal.
    fn physical(kind: &Kind) -> Physical {
        match kind {
            Kind::Real => Physical::DOUBLE,
            Kind::Integer => Physical::INT64,
            Kind::Boolean => Physical::BOOLEAN,
            Kind::Enumeration(_) => Physical::BYTE_ARRAY,
        }
    }

    /// The values of a signal in the type of its column. NaN becomes a missing value.
    fn values(kind: &Kind, column: impl Iterator<Item = f64>) -> ColumnValues<'_> {
        let known = |v: f64| Some(v).filter(|v| !v.is_nan());
        match kind {
            Kind::Real => ColumnValues::Real(column.collect()),
            Kind::Integer => ColumnValues::Integer(column.map(|v| known(v).map(|v| v as i64)).collect()),
            Kind::Boolean => ColumnValues::Boolean(column.map(|v| known(v).map(|v| v != 0.0)).collect()),
            Kind::Enumeration(literals) => {
                let literal = |v: f64| literals.get((v - 1.0) as usize).filter(|_| v >= 1.0).map(String::as_str);
                ColumnValues::Text(column.map(literal).collect())
            }
        }
    }

    /// The error of the crate as an `io::Error`. One of the system is unwrapped, so that a full disk is reported as
    /// such.
    fn reported(error: ParquetError) -> io::Error {
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(error) => *error,
                Err(other) => io::Error::other(other),
            },
            other => io::Error::other(other),
        }
    }
}

#[cfg(feature = "parquet")]
mod reader {
    use crate::trajectory::{Kind, Signal, Trajectory};
    use ::parquet::basic::{ConvertedType, Type as Physical};
    use ::parquet::errors::ParquetError;
    use ::parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
    use ::parquet::record::Field;
    use ::parquet::schema::types::ColumnDescriptor;
    use std::collections::BTreeMap;

    /// Reads a flat table: a run of bramah, or a file of another program.
    /// `time_column` is the column of times (s). Without it, it is `time` or the first column.
    ///
    /// # Errors
    /// A sentence: it is no Parquet file, a column holds neither numbers nor texts, or there is no such time column.
    pub fn read(file: impl ChunkReader + 'static, time_column: Option<&str>) -> Result<Trajectory, String> {
        let file = SerializedFileReader::new(file).map_err(|e| e.to_string())?;
        let head = file.metadata().file_metadata();
        let columns = head.schema_descr().columns();
        let names: Vec<String> = columns.iter().map(|c| c.path().string()).collect();
        let time = match time_column {
            Some(wanted) => {
                names.iter().position(|n| n == wanted).ok_or_else(|| format!("there is no column `{wanted}`"))?
            }
            None => names.iter().position(|n| n == "time").unwrap_or(0),
        };
        let units = units(head.key_value_metadata());
        let mut literals: Vec<Vec<String>> = vec![Vec::new(); names.len()];
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        for row in file.get_row_iter(None).map_err(|e| e.to_string())? {
            let row = row.map_err(|e: ParquetError| e.to_string())?;
            for (k, (name, field)) in row.get_column_iter().enumerate() {
                let value = number(field, &mut literals[k]);
                values[k].push(value.ok_or_else(|| format!("column `{name}` holds neither numbers nor texts"))?);
            }
        }
        if values.is_empty() {
            return Err("it has no columns".to_owned());
        }
        let mut signals = Vec::new();
        for (k, name) in names.iter().enumerate() {
            let kind = kind(&columns[k], std::mem::take(&mut literals[k]));
            let unit = units.get(name).map_or("", String::as_str);
            signals.push(Signal { kind, ..Signal::new(name).unit(unit) });
        }
        let times = values.remove(time);
        signals.remove(time);
        // Rows of equal time are allowed: they are events.
        if times.iter().any(|t| !t.is_finite()) || times.windows(2).any(|w| w[1] < w[0]) {
            return Err(format!("the times in `{}` do not increase", names[time]));
        }
        Ok(Trajectory { signals, times, columns: values })
    }

    /// The unit of each column from the metadata of bramah's own files. Empty for other files.
    fn units(entries: Option<&Vec<::parquet::file::metadata::KeyValue>>) -> BTreeMap<String, String> {
        let entry = entries.into_iter().flatten().find(|e| e.key == "units");
        entry.and_then(|e| serde_json::from_str(e.value.as_deref()?).ok()).unwrap_or_default()
    }

    /// The type of a signal. Decimal numbers are stored as integers, but are Reals.
    fn kind(column: &ColumnDescriptor, literals: Vec<String>) -> Kind {
        match column.physical_type() {
            Physical::BOOLEAN => Kind::Boolean,
            Physical::INT32 | Physical::INT64 if column.converted_type() != ConvertedType::DECIMAL => Kind::Integer,
            Physical::BYTE_ARRAY => Kind::Enumeration(literals),
            _ => Kind::Real,
        }
    }

    /// The value of a cell. A missing one is NaN; a text is its number among the distinct texts of the column, from 1.
    /// `None` for types that are neither numbers nor texts.
    fn number(field: &Field, literals: &mut Vec<String>) -> Option<f64> {
        Some(match field {
            Field::Null => f64::NAN,
            Field::Bool(v) => f64::from(u8::from(*v)),
            Field::Byte(v) => f64::from(*v),
            Field::Short(v) => f64::from(*v),
            Field::Int(v) => f64::from(*v),
            Field::Long(v) => *v as f64,
            Field::UByte(v) => f64::from(*v),
            Field::UShort(v) => f64::from(*v),
            Field::UInt(v) => f64::from(*v),
            Field::ULong(v) => *v as f64,
            Field::Float(v) => f64::from(*v),
            Field::Double(v) => *v,
            Field::Str(text) => {
                let known = literals.iter().position(|l| l == text);
                let place = known.unwrap_or_else(|| {
                    literals.push(text.clone());
                    literals.len() - 1
                });
                (place + 1) as f64
            }
            _ => return None,
        })
    }
}
