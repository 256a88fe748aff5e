//! Writes trajectories as CSV, row by row, so that a long run needs no memory for its rows.

use std::io::{self, Write};

use super::texts::NumberTextCache;
use super::trajectory::{Kind, Signal};

/// The place of the units in a CSV file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CsvUnits {
    /// No units: plain names, as other Modelica tools write them.
    #[default]
    None,
    /// Behind the names, such as `line.p [Pa]`.
    Header,
    /// In a row of their own below the names.
    Row,
}

impl std::str::FromStr for CsvUnits {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "none" => Ok(CsvUnits::None),
            "header" => Ok(CsvUnits::Header),
            "row" => Ok(CsvUnits::Row),
            _ => Err(format!("`{text}` is not known; write `none`, `header` or `row`")),
        }
    }
}

/// Writes a line of names, and then one line for each row.
///
/// The first column is `time`. Booleans are `false` and `true`, enumerations are their literals, and Integers have no
/// decimals. Reals have the fewest digits that read back as the same value.
#[derive(Debug)]
pub struct CsvWriter<W: Write> {
    /// The destination.
    out: W,
    /// The type of each signal.
    kinds: Vec<Kind>,
    /// Numbers as text, for values that repeat.
    texts: NumberTextCache,
    /// The line being made; kept to reuse its memory.
    line: Vec<u8>,
    /// The number of bytes written so far.
    bytes: u64,
}

impl<W: Write> CsvWriter<W> {
    /// Begins a file without units.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn new(out: W, signals: &[Signal]) -> io::Result<Self> {
        Self::with_units(out, signals, CsvUnits::None)
    }

    /// Begins a file with the line of names, and with units where `units` says.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn with_units(out: W, signals: &[Signal], units: CsvUnits) -> io::Result<Self> {
        let behind = |unit: &str| match units {
            CsvUnits::Header if !unit.is_empty() => format!(" [{unit}]"),
            _ => String::new(),
        };
        let mut line = format!("time{}", behind("s"));
        for signal in signals {
            line.push(',');
            push_name(&mut line, &format!("{}{}", signal.name, behind(&signal.unit)));
        }
        line.push('\n');
        if units == CsvUnits::Row {
            line.push('s');
            for signal in signals {
                line.push(',');
                // `1` marks a signal without a unit, because an empty cell could be anything.
                push_name(&mut line, if signal.unit.is_empty() { "1" } else { &signal.unit });
            }
            line.push('\n');
        }
        let line = line.into_bytes();
        let kinds = signals.iter().map(|s| s.kind.clone()).collect();
        let mut writer = CsvWriter { out, kinds, texts: NumberTextCache::default(), line, bytes: 0 };
        writer.flush_line()?;
        Ok(writer)
    }

    /// Continues a file behind `bytes`, which an earlier writer of the same signals has written.
    pub fn resume(out: W, signals: &[Signal], bytes: u64) -> Self {
        let kinds = signals.iter().map(|s| s.kind.clone()).collect();
        CsvWriter { out, kinds, texts: NumberTextCache::default(), line: Vec::new(), bytes }
    }

    /// Flushes the destination and gives the number of bytes written so far.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn flush(&mut self) -> io::Result<u64> {
        self.out.flush()?;
        Ok(self.bytes)
    }

    /// Writes one row. `values` has one value for each signal, in their order.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn row(&mut self, time: f64, values: impl IntoIterator<Item = f64>) -> io::Result<()> {
        self.line.clear();
        self.texts.push(&mut self.line, time);
        for (kind, value) in self.kinds.iter().zip(values) {
            self.line.push(b',');
            push_value(&mut self.line, &mut self.texts, kind, value);
        }
        self.line.push(b'\n');
        self.flush_line()
    }

    /// Flushes the destination and gives the number of bytes of the file.
    ///
    /// # Errors
    /// The errors of the destination.
    pub fn finish(mut self) -> io::Result<u64> {
        self.out.flush()?;
        Ok(self.bytes)
    }

    /// Writes the line that was made.
    fn flush_line(&mut self) -> io::Result<()> {
        self.bytes += self.line.len() as u64;
        self.out.write_all(&self.line)
    }
}

impl<W: Write + Send> crate::formats::ResultWriter for CsvWriter<W> {
    fn rows(&mut self, rows: &[f64]) -> io::Result<()> {
        // The time is not among the signals.
        let mut rows = rows.chunks_exact(self.kinds.len() + 1);
        rows.try_for_each(|row| self.row(row[0], row[1..].iter().copied()))
    }

    fn flush(&mut self) -> io::Result<u64> {
        CsvWriter::flush(self)
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        CsvWriter::finish(*self).map(drop)
    }
}

/// The approximate size in bytes of a row of these signals, to announce large files.
pub fn csv_bytes_per_row(signals: &[Signal]) -> u64 {
    // A Real usually takes up to 17 digits, a point and a comma.
    let cell = |kind: &Kind| match kind {
        Kind::Real => 19,
        Kind::Integer => 4,
        Kind::Boolean => 6,
        Kind::Enumeration(literals) => literals.iter().map(|l| l.len() as u64).max().unwrap_or(0) + 1,
    };
    12 + signals.iter().map(|s| cell(&s.kind)).sum::<u64>()
}

/// Appends a name, in quotes if a reader could take a character in it for a delimiter.
/// Quotes inside are doubled.
fn push_name(line: &mut String, name: &str) {
    if name.contains([',', '"', '\n', '\r', ';', '\t']) {
        line.push('"');
        line.push_str(&name.replace('"', "\"\""));
        line.push('"');
    } else {
        line.push_str(name);
    }
}

/// Appends a value as its type is written. A number that is no literal is written as a number.
fn push_value(line: &mut Vec<u8>, texts: &mut NumberTextCache, kind: &Kind, value: f64) {
    match kind {
        // A missing Boolean is an empty cell, like a missing number.
        Kind::Boolean if !value.is_nan() => line.extend_from_slice(if value == 0.0 { b"false" } else { b"true" }),
        Kind::Enumeration(literals) => match literal(literals, value) {
            Some(name) => line.extend_from_slice(name.as_bytes()),
            None => texts.push(line, value),
        },
        _ => texts.push(line, value),
    }
}

/// The literal with this number, counted from 1. `None` if there is none.
fn literal(literals: &[String], value: f64) -> Option<&str> {
    let index = value - 1.0;
    let inside = index >= 0.0 && index < literals.len() as f64 && index.fract() == 0.0;
    inside.then(|| literals[index as usize].as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_all_kinds() {
        let signals = [
            Signal::new("v[1].p"),
            Signal::new("A[1,2]"),
            Signal { kind: Kind::Boolean, ..Signal::new("on") },
            Signal { kind: Kind::Integer, ..Signal::new("n") },
            Signal { kind: Kind::Enumeration(vec!["stick".into(), "slip".into()]), ..Signal::new("mode") },
        ];
        let mut bytes = Vec::new();
        let mut writer = CsvWriter::new(&mut bytes, &signals).unwrap();
        writer.row(0.0, [1e5, -1e-7, 1.0, 3.0, 2.0]).unwrap();
        writer.row(0.1, [f64::NAN, 0.1, 0.0, -1.0, 7.0]).unwrap();
        assert_eq!(writer.finish().unwrap(), 78);
        insta::assert_snapshot!(String::from_utf8(bytes).unwrap(), @r#"
        time,v[1].p,"A[1,2]",on,n,mode
        0,100000,-1e-7,true,3,slip
        0.1,,0.1,false,-1,7
        "#);
    }
}
