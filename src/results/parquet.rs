//! Tables written as Apache Parquet, which pandas, Polars, DuckDB and Spark read: columns with their types, in groups of
//! rows, so that a long run needs no more memory than one group.
//!
//! Only what these files need of the format: plain encoding, no compression, one data page a column and group, metadata
//! in Thrift's compact protocol. Source: the format's specification, parquet.thrift of Apache Parquet 2.10.

use std::io::{self, Write};

use super::trajectory::{Kind, Signal};

const MAGIC: &[u8] = b"PAR1";

/// Type numbers of the format.
const BOOLEAN: i64 = 0;
const INT64: i64 = 2;
const DOUBLE: i64 = 5;
const BYTE_ARRAY: i64 = 6;
const PLAIN: i64 = 0;
const RLE: i64 = 3;
/// Annotation of texts.
const UTF8: i64 = 0;

/// The values of one column of a group of rows.
#[derive(Clone, Debug, PartialEq)]
pub enum Values<'a> {
    /// Numbers; NaN where there is none.
    Real(Vec<f64>),
    /// Whole numbers; `None` where there is none.
    Integer(Vec<Option<i64>>),
    /// `None` where there is none.
    Boolean(Vec<Option<bool>>),
    /// `None` where there is none.
    Text(Vec<Option<&'a str>>),
}

/// What stands in the head of a column.
#[derive(Clone, Debug)]
struct Head {
    name: String,
    unit: String,
    kind: i64,
}

/// Where a column of a group stands in the file.
struct Chunk {
    offset: u64,
    bytes: u64,
}

/// Writes a file group by group.
pub struct ParquetWriter<W: Write> {
    out: W,
    heads: Vec<Head>,
    kinds: Vec<Kind>,
    at: u64,
    rows: u64,
    groups: Vec<(u64, Vec<Chunk>)>,
}

impl<W: Write> ParquetWriter<W> {
    /// Begins a file of a run: `time` in seconds, then the signals. Booleans, Integers and enumerations keep their types,
    /// the latter as texts; units stand as JSON in the file's metadata below `units`.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn new(out: W, signals: &[Signal]) -> io::Result<Self> {
        let time = Head { name: "time".into(), unit: "s".into(), kind: DOUBLE };
        let head = |s: &Signal| Head { name: s.name.clone(), unit: s.unit.clone(), kind: number_of(&s.kind) };
        let heads = std::iter::once(time).chain(signals.iter().map(head)).collect();
        let kinds = std::iter::once(Kind::Real).chain(signals.iter().map(|s| s.kind.clone())).collect();
        Self::begin(out, heads, kinds)
    }

    fn begin(mut out: W, heads: Vec<Head>, kinds: Vec<Kind>) -> io::Result<Self> {
        out.write_all(MAGIC)?;
        Ok(ParquetWriter { out, heads, kinds, at: MAGIC.len() as u64, rows: 0, groups: Vec::new() })
    }

    /// Writes rows that stand one after the other, each with its time first, as one group.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn rows(&mut self, rows: &[f64]) -> io::Result<()> {
        let width = self.heads.len();
        if rows.is_empty() {
            return Ok(());
        }
        let kinds = std::mem::take(&mut self.kinds);
        let column = |k: usize| values(&kinds[k], rows.iter().skip(k).step_by(width).copied());
        let written = (0..width).map(|k| self.chunk(&column(k))).collect();
        self.kinds = kinds;
        self.close_group(rows.len() / width, written)
    }

    fn close_group(&mut self, rows: usize, written: io::Result<Vec<Chunk>>) -> io::Result<()> {
        self.groups.push((rows as u64, written?));
        self.rows += rows as u64;
        Ok(())
    }

    /// Writes one column of a group.
    fn chunk(&mut self, values: &Values<'_>) -> io::Result<Chunk> {
        let (count, body) = page(values);
        let mut header = Thrift::default();
        header.int(1, 0).int(2, body.len() as i64).int(3, body.len() as i64);
        let inner = Thrift::default().int(1, count as i64).int(2, PLAIN).int(3, RLE).int(4, RLE).end();
        header.part(5, &inner);
        let header = header.end();
        self.out.write_all(&header)?;
        self.out.write_all(&body)?;
        let chunk = Chunk { offset: self.at, bytes: (header.len() + body.len()) as u64 };
        self.at += chunk.bytes;
        Ok(chunk)
    }

    /// Writes what says where everything is, and hands all to the system.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn finish(mut self) -> io::Result<()> {
        let footer = self.footer();
        self.out.write_all(&footer)?;
        self.out.write_all(&u32::try_from(footer.len()).map_err(|_| io::ErrorKind::FileTooLarge)?.to_le_bytes())?;
        self.out.write_all(MAGIC)?;
        self.out.flush()
    }

    fn footer(&self) -> Vec<u8> {
        let root = Thrift::default().text(4, "schema").int(5, self.heads.len() as i64).end();
        let schema: Vec<Vec<u8>> = std::iter::once(root).chain(self.heads.iter().map(element)).collect();
        let groups: Vec<Vec<u8>> = self.groups.iter().map(|(rows, chunks)| self.group(*rows, chunks)).collect();
        let units: serde_json::Map<String, serde_json::Value> =
            self.heads.iter().filter(|h| !h.unit.is_empty()).map(|h| (h.name.clone(), h.unit.clone().into())).collect();
        let units = Thrift::default().text(1, "units").text(2, &serde_json::Value::Object(units).to_string()).end();
        let mut all = Thrift::default();
        all.int(1, 1).structs(2, &schema).long(3, self.rows).structs(4, &groups).structs(5, &[units]);
        all.text(6, concat!("bramah ", env!("CARGO_PKG_VERSION"))).end()
    }

    fn group(&self, rows: u64, chunks: &[Chunk]) -> Vec<u8> {
        let one = |(head, chunk): (&Head, &Chunk)| {
            let mut about = Thrift::default();
            about.int(1, head.kind).ints(2, &[PLAIN, RLE]).texts(3, &[&head.name]).int(4, 0).long(5, rows);
            about.long(6, chunk.bytes).long(7, chunk.bytes).long(9, chunk.offset);
            Thrift::default().long(2, chunk.offset).part(3, &about.end()).end()
        };
        let columns: Vec<Vec<u8>> = self.heads.iter().zip(chunks).map(one).collect();
        let bytes = chunks.iter().map(|c| c.bytes).sum();
        Thrift::default().structs(1, &columns).long(2, bytes).long(3, rows).end()
    }
}

/// Writes a table whose columns are at hand.
///
/// # Errors
/// What `out` reports.
pub fn write_table(out: impl Write, columns: &[(String, Values<'_>)]) -> io::Result<()> {
    let head =
        |(name, values): &(String, Values<'_>)| Head { name: name.clone(), unit: String::new(), kind: type_of(values) };
    let mut writer = ParquetWriter::begin(out, columns.iter().map(head).collect(), Vec::new())?;
    let rows = columns.first().map_or(0, |(_, values)| page(values).0);
    let written = columns.iter().map(|(_, values)| writer.chunk(values)).collect();
    writer.close_group(rows, written)?;
    writer.finish()
}

fn number_of(kind: &Kind) -> i64 {
    match kind {
        Kind::Real => DOUBLE,
        Kind::Integer => INT64,
        Kind::Boolean => BOOLEAN,
        Kind::Enumeration(_) => BYTE_ARRAY,
    }
}

fn type_of(values: &Values<'_>) -> i64 {
    match values {
        Values::Real(_) => DOUBLE,
        Values::Integer(_) => INT64,
        Values::Boolean(_) => BOOLEAN,
        Values::Text(_) => BYTE_ARRAY,
    }
}

/// The values of a signal as what they stand for.
fn values(kind: &Kind, column: impl Iterator<Item = f64>) -> Values<'_> {
    let known = |v: f64| Some(v).filter(|v| !v.is_nan());
    match kind {
        Kind::Real => Values::Real(column.collect()),
        Kind::Integer => Values::Integer(column.map(|v| known(v).map(|v| v as i64)).collect()),
        Kind::Boolean => Values::Boolean(column.map(|v| known(v).map(|v| v != 0.0)).collect()),
        Kind::Enumeration(literals) => {
            let literal = |v: f64| literals.get((v - 1.0) as usize).filter(|_| v >= 1.0).map(String::as_str);
            Values::Text(column.map(literal).collect())
        }
    }
}

/// How many values a page has, and its bytes. Only numbers are always there; others say first which are.
fn page(values: &Values<'_>) -> (usize, Vec<u8>) {
    match values {
        Values::Real(v) => (v.len(), v.iter().flat_map(|v| v.to_le_bytes()).collect()),
        Values::Integer(v) => {
            (v.len(), levels(v).into_iter().chain(v.iter().flatten().flat_map(|v| v.to_le_bytes())).collect())
        }
        Values::Boolean(v) => {
            let known: Vec<bool> = v.iter().flatten().copied().collect();
            let byte = |bits: &[bool]| bits.iter().enumerate().fold(0u8, |all, (k, &bit)| all | u8::from(bit) << k);
            (v.len(), levels(v).into_iter().chain(known.chunks(8).map(byte)).collect())
        }
        Values::Text(v) => {
            let mut bytes = levels(v);
            for text in v.iter().flatten() {
                bytes.extend((text.len() as u32).to_le_bytes());
                bytes.extend(text.as_bytes());
            }
            (v.len(), bytes)
        }
    }
}

/// Which values are there, as runs of equal ones behind their length in bytes.
fn levels<T>(values: &[Option<T>]) -> Vec<u8> {
    let mut runs = Vec::new();
    for run in values.chunk_by(|a, b| a.is_some() == b.is_some()) {
        push_varint(&mut runs, (run.len() as u64) << 1);
        runs.push(u8::from(run[0].is_some()));
    }
    let mut all = (runs.len() as u32).to_le_bytes().to_vec();
    all.extend(runs);
    all
}

/// A column of the schema.
fn element(head: &Head) -> Vec<u8> {
    let mut all = Thrift::default();
    all.int(1, head.kind).int(3, i64::from(head.kind != DOUBLE)).text(4, &head.name);
    if head.kind == BYTE_ARRAY {
        all.int(6, UTF8);
    }
    all.end()
}

fn push_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// A struct in Thrift's compact protocol, field by field in the order of their numbers.
#[derive(Default)]
struct Thrift {
    bytes: Vec<u8>,
    last: u8,
}

/// Type numbers of the protocol.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

impl Thrift {
    fn field(&mut self, number: u8, kind: u8) {
        self.bytes.push((number - self.last) << 4 | kind);
        self.last = number;
    }

    fn zigzag(&mut self, value: i64) {
        push_varint(&mut self.bytes, (value << 1 ^ value >> 63) as u64);
    }

    fn int(&mut self, number: u8, value: i64) -> &mut Self {
        self.field(number, I32);
        self.zigzag(value);
        self
    }

    fn long(&mut self, number: u8, value: u64) -> &mut Self {
        self.field(number, I64);
        self.zigzag(value as i64);
        self
    }

    fn push_text(&mut self, text: &str) {
        push_varint(&mut self.bytes, text.len() as u64);
        self.bytes.extend(text.as_bytes());
    }

    fn text(&mut self, number: u8, text: &str) -> &mut Self {
        self.field(number, BINARY);
        self.push_text(text);
        self
    }

    fn part(&mut self, number: u8, part: &[u8]) -> &mut Self {
        self.field(number, STRUCT);
        self.bytes.extend(part);
        self
    }

    fn list(&mut self, number: u8, count: usize, kind: u8) {
        self.field(number, LIST);
        if count < 15 {
            self.bytes.push((count as u8) << 4 | kind);
        } else {
            self.bytes.push(0xF0 | kind);
            push_varint(&mut self.bytes, count as u64);
        }
    }

    fn structs(&mut self, number: u8, all: &[Vec<u8>]) -> &mut Self {
        self.list(number, all.len(), STRUCT);
        all.iter().for_each(|one| self.bytes.extend(one));
        self
    }

    fn ints(&mut self, number: u8, all: &[i64]) -> &mut Self {
        self.list(number, all.len(), I32);
        all.iter().for_each(|&one| self.zigzag(one));
        self
    }

    fn texts(&mut self, number: u8, all: &[&str]) -> &mut Self {
        self.list(number, all.len(), BINARY);
        all.iter().for_each(|one| self.push_text(one));
        self
    }

    fn end(&mut self) -> Vec<u8> {
        self.bytes.push(0);
        std::mem::take(&mut self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals() -> Vec<Signal> {
        vec![
            Signal { unit: "Pa".into(), ..Signal::new("v[1].p") },
            Signal { kind: Kind::Boolean, ..Signal::new("on") },
            Signal { kind: Kind::Integer, ..Signal::new("n") },
            Signal { kind: Kind::Enumeration(vec!["stick".into(), "slip".into()]), ..Signal::new("mode") },
        ]
    }

    /// The bytes are those that pyarrow 26 was seen to read (`tests/parquet.rs` asks it again where it is installed).
    #[test]
    fn two_groups_of_all_kinds() {
        let mut bytes = Vec::new();
        let mut writer = ParquetWriter::new(&mut bytes, &signals()).unwrap();
        writer.rows(&[0.0, 1e5, 1.0, 3.0, 2.0, 0.5, f64::NAN, 0.0, -1.0, 7.0]).unwrap();
        writer.rows(&[1.0, 2e5, f64::NAN, f64::NAN, 1.0]).unwrap();
        writer.rows(&[]).unwrap();
        writer.finish().unwrap();
        assert!(bytes.starts_with(MAGIC) && bytes.ends_with(MAGIC));
        let length = u32::from_le_bytes(bytes[bytes.len() - 8..bytes.len() - 4].try_into().unwrap()) as usize;
        let footer = String::from_utf8_lossy(&bytes[bytes.len() - 8 - length..]).into_owned();
        assert!(footer.contains("v[1].p") && footer.contains(r#"{"time":"s","v[1].p":"Pa"}"#), "{footer}");
        assert_eq!(&bytes[4..], include_bytes!("snapshots/kinds.parquet").get(4..).unwrap());
    }

    #[test]
    fn numbers_of_the_protocol() {
        let mut out = Vec::new();
        push_varint(&mut out, 300);
        assert_eq!(out, [0xAC, 0x02]);
        assert_eq!(Thrift::default().int(1, -1).text(4, "a").end(), [0x15, 0x01, 0x38, 0x01, b'a', 0]);
        assert_eq!(levels(&[Some(1), Some(2), None]), [4, 0, 0, 0, 4, 1, 2, 0]);
    }
}
