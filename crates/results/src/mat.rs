//! Modelica result files: MATLAB `.mat` version 4 with the layout "dsres", as Dymola, OMEdit, DyMat and SciPy read
//! them.
//!
//! A file has six matrices: `Aclass` (the kind of file), `name` and `description` (one text for each signal),
//! `dataInfo`
//! (the place of each signal's values), `data_1` (constant signals, at the first and last time) and `data_2` (the
//! others
//! over time). Signals with equal values share one row. All matrices are transposed (`binTrans`). Units are in the
//! description as `[unit|displayUnit]`, and types other than Real as `:#(type=Boolean)`.

use std::hash::Hasher;
use std::io::{self, Write};

use rustc_hash::FxHashMap;

use super::trajectory::{Kind, Signal, Trajectory};

/// Element types of a version 4 matrix: the last two digits of its type number (double, single, int32, text).
const DOUBLE: i32 = 0;
const SINGLE: i32 = 10;
const INT32: i32 = 20;
const TEXT: i32 = 51;

/// The largest size of a matrix in bytes. Other tools read no larger ones.
const LARGEST: u64 = i32::MAX as u64;

/// Writes a trajectory as a complete file.
///
/// # Errors
/// The errors of `out`, and [`io::ErrorKind::FileTooLarge`] beyond 2 GB, which the format cannot hold.
pub fn write(mut out: impl Write, trajectory: &Trajectory) -> io::Result<()> {
    let plan = MatLayout::new(trajectory);
    let bytes = (plan.moving.len() as u64 + 1) * trajectory.len() as u64 * 8;
    if bytes > LARGEST {
        let text = "a Modelica .mat file holds at most 2 GB: choose fewer variables, a longer output interval, or CSV";
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    let signals = &trajectory.signals;
    write_class(&mut out)?;
    let names = std::iter::once("time").chain(signals.iter().map(|s| s.name.as_str()));
    write_texts(&mut out, "name", &names.map(str::to_owned).collect::<Vec<_>>())?;
    let descriptions = std::iter::once("Simulation time [s]".to_owned()).chain(signals.iter().map(describe));
    write_texts(&mut out, "description", &descriptions.collect::<Vec<_>>())?;
    write_info(&mut out, &plan)?;
    write_constants(&mut out, trajectory, &plan)?;
    write_moving(&mut out, trajectory, &plan)?;
    out.flush()
}

/// Collects rows and writes them at the end. The format has the number of rows at the head of a matrix, and needs to
/// know
/// which signals are constant.
pub struct MatWriter<W: Write> {
    /// The destination.
    out: W,
    /// The rows so far.
    rows: Trajectory,
}

impl<W: Write> MatWriter<W> {
    /// A writer without rows. Nothing is written before `finish`.
    pub fn new(out: W, signals: &[Signal]) -> Self {
        MatWriter { out, rows: Trajectory::new(signals.to_vec()) }
    }
}

impl<W: Write + Send> crate::formats::ResultWriter for MatWriter<W> {
    fn rows(&mut self, rows: &[f64]) -> io::Result<()> {
        rows.chunks_exact(self.rows.columns.len() + 1).for_each(|row| self.rows.push(row[0], &row[1..]));
        Ok(())
    }

    fn flush(&mut self) -> io::Result<u64> {
        // Nothing is written before the end.
        Ok(0)
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        write(self.out, &self.rows)
    }
}

/// Writes one matrix of numbers, given by columns. Several matrices in a row are a file that MATLAB and SciPy read.
///
/// # Errors
/// The errors of `out`.
pub fn write_matrix(out: &mut impl Write, name: &str, rows: usize, values: &[f64]) -> io::Result<()> {
    header(out, name, DOUBLE, rows, values.len() / rows.max(1))?;
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

/// The place of each signal's values.
struct MatLayout {
    /// For each signal its matrix (1 or 2) and row, counted from 1. Row 1 is time.
    rows: Vec<(i32, i32)>,
    /// The signals whose values are the rows of `data_1`, after time.
    constant: Vec<usize>,
    /// The signals whose values are the rows of `data_2`, after time.
    moving: Vec<usize>,
}

impl MatLayout {
    /// Assigns a row to each signal. Signals with equal values get the same one.
    fn new(trajectory: &Trajectory) -> Self {
        let mut plan = MatLayout { rows: Vec::new(), constant: Vec::new(), moving: Vec::new() };
        let mut known: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
        for (i, column) in trajectory.columns.iter().enumerate() {
            // Columns with equal hashes are compared, since different ones may have the same hash.
            let like = known.entry(fingerprint(column)).or_default();
            let same = like.iter().find(|&&j| equal(&trajectory.columns[j], column));
            let row = match same {
                // Equal columns share a row of the file.
                Some(&j) => plan.rows[j],
                None => {
                    like.push(i);
                    plan.place(i, column)
                }
            };
            plan.rows.push(row);
        }
        plan
    }

    /// Adds a row for a signal, in the matrix of constant or of changing signals.
    fn place(&mut self, signal: usize, column: &[f64]) -> (i32, i32) {
        // By bits, so that NaN equals itself.
        let constant = column.windows(2).all(|w| w[0].to_bits() == w[1].to_bits());
        let (matrix, list) = if constant { (1, &mut self.constant) } else { (2, &mut self.moving) };
        list.push(signal);
        (matrix, i32::try_from(list.len()).unwrap_or(i32::MAX - 1) + 1)
    }
}

/// A hash of the values of a column.
fn fingerprint(column: &[f64]) -> u64 {
    let mut hasher = rustc_hash::FxHasher::default();
    column.iter().for_each(|v| hasher.write_u64(v.to_bits()));
    hasher.finish()
}

/// True if two columns agree to the bit.
fn equal(a: &[f64], b: &[f64]) -> bool {
    a.iter().map(|v| v.to_bits()).eq(b.iter().map(|v| v.to_bits()))
}

/// Writes the header of a matrix: type, rows, columns, whether it is complex, and the name with a final zero byte.
fn header(out: &mut impl Write, name: &str, kind: i32, rows: usize, columns: usize) -> io::Result<()> {
    let size = |n: usize| i32::try_from(n).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge));
    for word in [kind, size(rows)?, size(columns)?, 0, size(name.len() + 1)?] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(name.as_bytes())?;
    out.write_all(&[0])
}

/// Writes `Aclass`, the only matrix that is not transposed: its rows are texts.
fn write_class(out: &mut impl Write) -> io::Result<()> {
    let lines = ["Atrajectory", "1.1", "", "binTrans"];
    header(out, "Aclass", TEXT, lines.len(), 11)?;
    for column in 0..11 {
        for line in lines {
            out.write_all(&[line.as_bytes().get(column).copied().unwrap_or(b' ')])?;
        }
    }
    Ok(())
}

/// Writes a matrix of texts, one in each column, filled up with blanks.
/// The matrix is as wide as the longest text.
fn write_texts(out: &mut impl Write, name: &str, texts: &[String]) -> io::Result<()> {
    let width = texts.iter().map(String::len).max().unwrap_or(0).max(1);
    header(out, name, TEXT, width, texts.len())?;
    for text in texts {
        out.write_all(text.as_bytes())?;
        out.write_all(&vec![b' '; width - text.len()])?;
    }
    Ok(())
}

/// The description of a signal with its units and type in brackets, as other tools expect it.
/// The order is `description [unit|displayUnit:#(type=..)]`.
fn describe(signal: &Signal) -> String {
    let kind = match &signal.kind {
        Kind::Real => "",
        Kind::Integer => ":#(type=Integer)",
        Kind::Boolean => ":#(type=Boolean)",
        // The format has no enumerations.
        Kind::Enumeration(_) => ":#(type=Integer)",
    };
    let display = if signal.display_unit.is_empty() || signal.display_unit == signal.unit {
        String::new()
    } else {
        format!("|{}", signal.display_unit)
    };
    let bracket = format!("{}{display}{kind}", signal.unit);
    let text = signal.description.trim();
    match (text.is_empty(), bracket.is_empty()) {
        (_, true) => text.to_owned(),
        (true, false) => format!("[{bracket}]"),
        (false, false) => format!("{text} [{bracket}]"),
    }
}

/// Writes `dataInfo`: for each signal its matrix, its row, 0 for linear interpolation, and -1 for no extrapolation.
fn write_info(out: &mut impl Write, plan: &MatLayout) -> io::Result<()> {
    header(out, "dataInfo", INT32, 4, plan.rows.len() + 1)?;
    let infos = std::iter::once([0, 1, 0, -1]).chain(plan.rows.iter().map(|&(matrix, row)| [matrix, row, 0, -1]));
    for word in infos.flatten() {
        out.write_all(&word.to_le_bytes())?;
    }
    Ok(())
}

/// Writes `data_1`, with two columns: the values at the first and at the last time.
/// Values at both times are equal.
fn write_constants(out: &mut impl Write, trajectory: &Trajectory, plan: &MatLayout) -> io::Result<()> {
    header(out, "data_1", DOUBLE, plan.constant.len() + 1, 2)?;
    let ends = [trajectory.times.first(), trajectory.times.last()];
    for time in ends {
        out.write_all(&time.copied().unwrap_or(0.0).to_le_bytes())?;
        for &i in &plan.constant {
            // An empty trajectory has no values; the matrix still needs a column.
            let value = trajectory.columns[i].first().copied().unwrap_or(0.0);
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Writes `data_2`, with one column for each time.
/// The first row is time.
fn write_moving(out: &mut impl Write, trajectory: &Trajectory, plan: &MatLayout) -> io::Result<()> {
    header(out, "data_2", DOUBLE, plan.moving.len() + 1, trajectory.len())?;
    for (row, time) in trajectory.times.iter().enumerate() {
        out.write_all(&time.to_le_bytes())?;
        for &i in &plan.moving {
            out.write_all(&trajectory.columns[i][row].to_le_bytes())?;
        }
    }
    Ok(())
}

/// One matrix of a file that is read.
struct MatMatrix<'a> {
    /// The name.
    name: String,
    /// The type number, whose last two digits are the element type.
    kind: i32,
    /// The number of rows.
    rows: usize,
    /// The number of columns.
    columns: usize,
    /// The elements, column by column.
    bytes: &'a [u8],
}

/// Reads a file of bramah or another Modelica tool.
///
/// # Errors
/// A sentence about what is wrong with the file.
pub fn read(bytes: &[u8]) -> Result<Trajectory, String> {
    let matrices = matrices(bytes)?;
    let find = |name: &str| {
        matrices.iter().find(|m| m.name == name).ok_or_else(|| format!("the file holds no matrix `{name}`"))
    };
    let class = find("Aclass")?;
    let layout = class.text_by_row(3);
    // Tools write either layout: signals in columns, or in rows.
    if class.text_by_row(0) != "Atrajectory" || (layout != "binTrans" && layout != "binNormal") {
        return Err("the file is no Modelica result (`Aclass` does not say so)".to_owned());
    }
    let transposed = layout == "binTrans";
    let names = find("name")?.texts(transposed);
    let descriptions = find("description")?.texts(transposed);
    let (info, first, second) = (find("dataInfo")?, find("data_1")?, find("data_2")?);
    let rows = if transposed { second.columns } else { second.rows };
    let mut trajectory = Trajectory::default();
    for (i, name) in names.iter().enumerate() {
        let entry = |k: usize| info.at(i, k, transposed).map(|v| v as i64);
        let (matrix, place) = entry(0).zip(entry(1)).ok_or_else(|| format!("`{name}` has no entry in `dataInfo`"))?;
        let source = if matrix == 1 { first } else { second };
        let values = source.series(place, rows, matrix == 1, transposed);
        let values = values.ok_or_else(|| format!("the values of `{name}` lie outside the data"))?;
        // The first signal is time.
        if i == 0 {
            trajectory.times = values;
        } else {
            trajectory.signals.push(signal(name, descriptions.get(i).map_or("", String::as_str)));
            trajectory.columns.push(values);
        }
    }
    Ok(trajectory)
}

/// A signal from its name and description, such as `pressure [Pa|bar:#(type=Real)]`.
fn signal(name: &str, description: &str) -> Signal {
    let mut signal = Signal::new(name);
    let bracket = description.strip_suffix(']').and_then(|d| d.rsplit_once('['));
    let Some((text, inside)) = bracket else {
        signal.description = description.to_owned();
        return signal;
    };
    signal.description = text.trim().to_owned();
    let (units, kind) = inside.split_once(":#").unwrap_or((inside, ""));
    let (unit, display) = units.split_once('|').unwrap_or((units, ""));
    signal.unit = unit.to_owned();
    signal.display_unit = display.to_owned();
    signal.kind = match kind {
        "(type=Boolean)" => Kind::Boolean,
        "(type=Integer)" => Kind::Integer,
        _ => Kind::Real,
    };
    signal
}

/// The matrices of a file, in order. The bytes are not copied.
/// Each has a header of 20 bytes, its name, and its elements.
fn matrices(bytes: &[u8]) -> Result<Vec<MatMatrix<'_>>, String> {
    let damaged = || "the file is damaged or no .mat file of version 4".to_owned();
    let mut at = 0;
    let mut all = Vec::new();
    while at < bytes.len() {
        let word = |k: usize| {
            let four = bytes.get(at + 4 * k..at + 4 * k + 4)?;
            Some(i32::from_le_bytes(four.try_into().ok()?))
        };
        let kind = word(0).ok_or_else(damaged)?;
        let size = |k: usize| word(k).and_then(|w| usize::try_from(w).ok()).ok_or_else(damaged);
        let (rows, columns, name) = (size(1)?, size(2)?, size(4)?);
        let width = element_bytes(kind).ok_or_else(damaged)?;
        let from = at + 20 + name;
        let length = rows.checked_mul(columns).and_then(|n| n.checked_mul(width)).ok_or_else(damaged)?;
        let end = from.checked_add(length).ok_or_else(damaged)?;
        // Sizes come from the file and may be wrong in a damaged one.
        let data = bytes.get(from..end).ok_or_else(damaged)?;
        let title = String::from_utf8_lossy(&bytes[at + 20..from]).trim_end_matches('\0').to_owned();
        all.push(MatMatrix { name: title, kind, rows, columns, bytes: data });
        at = end;
    }
    Ok(all)
}

/// The size of an element in bytes, by the type number. `None` if it is no type of this format.
fn element_bytes(kind: i32) -> Option<usize> {
    match kind {
        DOUBLE => Some(8),
        SINGLE | INT32 => Some(4),
        // 30 is a signed and 40 an unsigned integer of 16 bits; 50 is one of 8 bits.
        30 | 40 => Some(2),
        50 | TEXT => Some(1),
        _ => None,
    }
}

impl MatMatrix<'_> {
    /// The element with this index, counted by columns. `None` outside.
    fn element(&self, index: usize) -> Option<f64> {
        let width = element_bytes(self.kind)?;
        let b = self.bytes.get(index * width..(index + 1) * width)?;
        Some(match self.kind {
            DOUBLE => f64::from_le_bytes(b.try_into().ok()?),
            SINGLE => f64::from(f32::from_le_bytes(b.try_into().ok()?)),
            INT32 => f64::from(i32::from_le_bytes(b.try_into().ok()?)),
            30 => f64::from(i16::from_le_bytes(b.try_into().ok()?)),
            40 => f64::from(u16::from_le_bytes(b.try_into().ok()?)),
            _ => f64::from(b[0]),
        })
    }

    /// Entry `k` of item `i`. Items are columns if `transposed`, else rows. `None` outside.
    fn at(&self, i: usize, k: usize, transposed: bool) -> Option<f64> {
        let (row, column) = if transposed { (k, i) } else { (i, k) };
        if row >= self.rows || column >= self.columns {
            return None;
        }
        self.element(column * self.rows + row)
    }

    /// The `rows` values of the signal at `place`, which counts from 1 and is negative for negated values.
    /// Of a `constant` signal the first value is repeated. `None` if the place is outside of the matrix.
    fn series(&self, place: i64, rows: usize, constant: bool, transposed: bool) -> Option<Vec<f64>> {
        // Row 1 has index 0; a place of 0 is invalid.
        let index = usize::try_from(place.unsigned_abs()).ok()?.checked_sub(1)?;
        let sign = if place < 0 { -1.0 } else { 1.0 };
        let row = |r: usize| if constant { 0 } else { r };
        (0..rows).map(|r| self.at(row(r), index, transposed).map(|v| sign * v)).collect()
    }

    /// The text in a row, without blanks at its end.
    fn text_by_row(&self, row: usize) -> String {
        let bytes = (0..self.columns).filter_map(|c| self.bytes.get(c * self.rows + row).copied());
        trimmed(bytes.collect())
    }

    /// All texts of a matrix, which are in columns if `transposed`.
    fn texts(&self, transposed: bool) -> Vec<String> {
        if transposed {
            self.bytes.chunks(self.rows.max(1)).map(|c| trimmed(c.to_vec())).collect()
        } else {
            (0..self.rows).map(|row| self.text_by_row(row)).collect()
        }
    }
}

/// Bytes as text, without zeros and blanks at the end.
fn trimmed(bytes: Vec<u8>) -> String {
    String::from_utf8_lossy(&bytes).trim_end_matches(['\0', ' ']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Trajectory {
        let mut p = Signal::new("pump.p").unit("Pa");
        p.display_unit = "bar".into();
        p.description = "pressure".into();
        let signals = vec![
            p,
            Signal { kind: Kind::Boolean, ..Signal::new("on") },
            Signal::new("V").unit("m3"),
            Signal::new("pump.q"),
            Signal::new("W").unit("m3"),
        ];
        let mut t = Trajectory::new(signals);
        t.push(0.0, &[1e5, 0.0, 2.0, 1e5, 2.0]);
        t.push(0.5, &[2e5, 1.0, 2.0, 2e5, 2.0]);
        t.push(0.5, &[3e5, 1.0, 2.0, 3e5, 2.0]);
        t
    }

    #[test]
    fn reads_what_it_wrote() {
        let mut bytes = Vec::new();
        write(&mut bytes, &sample()).unwrap();
        assert_eq!(read(&bytes).unwrap(), sample());
    }

    #[test]
    fn equal_and_constant_signals_share_rows() {
        let plan = MatLayout::new(&sample());
        assert_eq!(plan.rows, [(2, 2), (2, 3), (1, 2), (2, 2), (1, 2)]);
    }

    #[test]
    fn damaged_files_are_told() {
        let mut bytes = Vec::new();
        write(&mut bytes, &sample()).unwrap();
        for cut in 0..bytes.len() {
            let _ = read(&bytes[..cut]);
        }
        assert!(read(&bytes[..bytes.len() - 1]).unwrap_err().contains("damaged"));
        assert!(read(b"").unwrap_err().contains("Aclass"));
    }
}
