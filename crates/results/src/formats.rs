//! The formats of result files, in one table: CSV, Modelica .mat, and Parquet if it is compiled in.
//!
//! The ending of a file name enters; a writer or reader leaves. To add a format, write a module with a [`ResultWriter`]
//! and a reader, and give it a row of [`FORMATS`]. The command's options, help and messages follow from the table.

use crate::{CsvUnits, CsvWriter, ReadStrictness, Signal, Trajectory, csv_bytes_per_row, mat, read_csv};
use bramah_syntax::diag::{Code, Diagnostic, Sources, StageResult};
use std::io::{self, Write};

/// The destination of a writer's bytes.
pub type ByteSink = Box<dyn Write + Send>;

/// A format of result files: its name, and how files are written and read.
pub struct ResultFormat {
    /// The ending of its files, in lower case without the dot.
    pub ending: &'static str,
    /// The name of the format in help texts.
    pub name: &'static str,
    /// True if parameters may be written without being requested, because a constant value takes no space in each row.
    pub constants_are_free: bool,
    /// True if a run that was killed can continue the file behind its last rows.
    pub grows: bool,
    /// Begins a file with these signals. Units are written where the format has a place for them.
    pub create: fn(ByteSink, &[Signal], CsvUnits) -> io::Result<Box<dyn ResultWriter>>,
    /// Reads a complete file.
    pub read: fn(ResultFile<'_>) -> StageResult<Trajectory>,
    /// The approximate size in bytes of a row of these signals, to announce large files.
    pub bytes_per_row: fn(&[Signal]) -> u64,
}

/// All formats. The first one is used for names without an ending, and for the standard output.
pub static FORMATS: &[ResultFormat] = &[
    ResultFormat {
        ending: "csv",
        name: "CSV",
        constants_are_free: false,
        grows: true,
        create: |out, signals, units| Ok(Box::new(CsvWriter::with_units(out, signals, units)?)),
        read: |file| {
            let id = file.sources.add_bytes(file.name.to_owned(), file.bytes);
            // A text is added to the sources, so that messages can show its lines.
            read_csv(file.sources, id, file.time_column, ReadStrictness::Result)
        },
        bytes_per_row: csv_bytes_per_row,
    },
    ResultFormat {
        ending: "mat",
        name: "Modelica .mat",
        constants_are_free: true,
        grows: false,
        // Units are part of the format, in the descriptions.
        create: |out, signals, _| Ok(Box::new(mat::MatWriter::new(out, signals))),
        read: |file| usable(file.name, mat::read(&file.bytes)),
        bytes_per_row: binary_bytes_per_row,
    },
    #[cfg(feature = "parquet")]
    ResultFormat {
        ending: "parquet",
        name: "Parquet",
        constants_are_free: false,
        grows: false,
        create: |out, signals, _| Ok(Box::new(crate::parquet::ParquetWriter::new(out, signals)?)),
        read: |file| usable(file.name, crate::parquet::read(bytes::Bytes::from(file.bytes), file.time_column)),
        bytes_per_row: binary_bytes_per_row,
    },
];

/// A result file whose bytes were read from the disk.
pub struct ResultFile<'a> {
    /// The name of the file, for messages.
    pub name: &'a str,
    /// The complete content.
    pub bytes: Vec<u8>,
    /// The name of the time column. `None` for `time` or, without such a column, the first one.
    pub time_column: Option<&'a str>,
    /// The texts that messages refer to. A text format adds its own.
    pub sources: &'a mut Sources,
}

/// Takes the rows of a run, and writes them to a file.
pub trait ResultWriter: Send {
    /// Writes rows that stand one after the other: the time in s, then one value for each signal.
    ///
    /// # Errors
    /// What the sink reports.
    fn rows(&mut self, rows: &[f64]) -> io::Result<()>;

    /// Writes all rows so far to the file. Formats that grow give the number of bytes that the file then has, others 0.
    ///
    /// # Errors
    /// What the sink reports.
    fn flush(&mut self) -> io::Result<u64>;

    /// Completes the file.
    ///
    /// # Errors
    /// The errors of the destination, and contents that the format cannot hold.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// The format of an ending, in upper or lower case. `None` if there is no such format.
pub fn of_ending(ending: &str) -> Option<&'static ResultFormat> {
    FORMATS.iter().find(|f| f.ending.eq_ignore_ascii_case(ending))
}

/// The endings of all formats, in the order of [`FORMATS`].
pub fn endings() -> Vec<&'static str> {
    FORMATS.iter().map(|f| f.ending).collect()
}

/// The names of all formats for a help text, such as `CSV, Modelica .mat or Parquet`.
pub fn names() -> String {
    let all: Vec<&str> = FORMATS.iter().map(|f| f.name).collect();
    match all.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// The size of a row in a binary format: eight bytes for each number, the time included.
fn binary_bytes_per_row(signals: &[Signal]) -> u64 {
    8 * (signals.len() as u64 + 1)
}

/// The result of a binary reader, with its error as a diagnostic that names the file.
/// Text formats make diagnostics with places themselves.
fn usable(name: &str, read: Result<Trajectory, String>) -> StageResult<Trajectory> {
    match read {
        Ok(trajectory) => StageResult::new(trajectory, Vec::new()),
        Err(why) => {
            StageResult::failed(vec![Diagnostic::new(Code::BadData, format!("`{name}` cannot be used: {why}"))])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Bytes that stay at hand when the writer is gone.
    #[derive(Clone, Default)]
    struct SharedBytes(Arc<Mutex<Vec<u8>>>);

    impl Write for SharedBytes {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn every_format_reads_what_it_wrote() {
        let signals = [Signal::new("x").unit("m"), Signal::new("v[1]")];
        for format in FORMATS {
            let bytes = SharedBytes::default();
            let mut writer = (format.create)(Box::new(bytes.clone()), &signals, CsvUnits::Header).unwrap();
            writer.rows(&[0.0, 1.0, 2.0, 0.5, 1.25, 2.5]).unwrap();
            writer.rows(&[1.0, -1e-300, 7.0]).unwrap();
            writer.finish().unwrap();
            let bytes = bytes.0.lock().unwrap().clone();
            let mut sources = Sources::default();
            let file = ResultFile { name: "a", bytes, time_column: None, sources: &mut sources };
            let found = (format.read)(file).value.unwrap_or_else(|| panic!("{}", format.name));
            assert_eq!(found.times, [0.0, 0.5, 1.0], "{}", format.name);
            assert_eq!(found.columns, [vec![1.0, 1.25, -1e-300], vec![2.0, 2.5, 7.0]], "{}", format.name);
            assert_eq!(found.signals[0].name, "x", "{}", format.name);
        }
    }

    #[test]
    fn a_format_is_found_by_its_ending() {
        assert_eq!(of_ending("MAT").map(|f| f.name), Some("Modelica .mat"));
        assert!(of_ending("xlsx").is_none());
        assert!(names().starts_with("CSV, Modelica .mat"));
    }
}
