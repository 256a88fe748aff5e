//! The table of a sweep: one line for each run, in CSV.
//!
//! Lines are written as runs finish, so an interrupted sweep can be continued from its table, and parts that were
//! computed on several machines can be merged. A fingerprint in the first line identifies the sweep.

use bramah_results::number;
use bramah_results::parquet::ColumnValues;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Start of the first line; the fingerprint and the number of runs follow.
const MARK: &str = "# bramah sweep ";

/// The finished runs of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepTable {
    /// The fingerprint of the sweep.
    pub fingerprint: String,
    /// Number of runs of the whole sweep.
    pub runs: usize,
    /// Names of the columns: parameters, then results.
    pub columns: Vec<String>,
    /// By number of the run (from 1): values of the columns, and `ok` or the reason of a failure (values are then NaN).
    pub rows: BTreeMap<usize, (Vec<f64>, String)>,
}

/// A hash (64-bit FNV-1a) of the words and of the bits of the numbers, in hexadecimal digits.
pub fn fingerprint(words: &[String], numbers: &[Vec<f64>]) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut eat = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    for word in words {
        word.bytes().chain([0]).for_each(&mut eat);
    }
    for number in numbers.iter().flatten() {
        number.to_bits().to_le_bytes().into_iter().for_each(&mut eat);
    }
    format!("{hash:016x}")
}

impl SweepTable {
    /// An empty table.
    pub fn new(fingerprint: String, runs: usize, columns: Vec<String>) -> SweepTable {
        SweepTable { fingerprint, runs, columns, rows: BTreeMap::new() }
    }

    /// The first two lines: fingerprint and names of the columns.
    pub fn head(&self) -> String {
        let mut out = format!("{MARK}{} {}\nrun", self.fingerprint, self.runs);
        for name in &self.columns {
            out.push(',');
            out.push_str(&quoted(name));
        }
        out.push_str(",status\n");
        out
    }

    /// A run as a line.
    pub fn line(run: usize, values: &[f64], status: &str) -> String {
        let mut out = format!("{run}");
        for value in values {
            out.push(',');
            number::push(&mut out, *value);
        }
        let _ = writeln!(out, ",{}", quoted(&status.replace(['\n', '\r'], " ")));
        out
    }

    /// The whole table, ordered by runs.
    pub fn text(&self) -> String {
        let lines = self.rows.iter().map(|(run, (values, status))| SweepTable::line(*run, values, status));
        self.head() + &lines.collect::<String>()
    }

    /// Reads a table. Lines that are incomplete are left out, as after an interruption.
    ///
    /// # Errors
    /// A sentence where the text is not the table of a sweep.
    pub fn read(text: &str) -> Result<SweepTable, String> {
        let no_table = || "it is not the table of a sweep".to_owned();
        let (first, rest) = text.split_once('\n').ok_or_else(no_table)?;
        let (print, runs) = first.strip_prefix(MARK).and_then(|t| t.trim().split_once(' ')).ok_or_else(no_table)?;
        let runs = runs.parse().map_err(|_| no_table())?;
        let (head, body) = rest.split_once('\n').ok_or_else(no_table)?;
        let names = cells(head);
        if names.len() < 2 || names[0] != "run" || names[names.len() - 1] != "status" {
            return Err(no_table());
        }
        let columns = names[1..names.len() - 1].to_vec();
        let mut table = SweepTable::new(print.to_owned(), runs, columns);
        for line in body.split_inclusive('\n').filter(|l| l.ends_with('\n')) {
            let cells = cells(line.trim_end_matches(['\n', '\r']));
            let run = cells[0].parse::<usize>().ok().filter(|_| cells.len() == names.len());
            let Some(run) = run else { continue };
            let values = cells[1..cells.len() - 1].iter().map(|c| c.parse().unwrap_or(f64::NAN)).collect();
            table.rows.insert(run, (values, cells[cells.len() - 1].clone()));
        }
        Ok(table)
    }

    /// Adds the rows of another part of the same sweep.
    ///
    /// # Errors
    /// A sentence where it belongs to another sweep.
    pub fn merge(&mut self, other: SweepTable) -> Result<(), String> {
        if other.fingerprint != self.fingerprint || other.columns != self.columns {
            return Err("it belongs to another sweep".to_owned());
        }
        self.rows.extend(other.rows);
        Ok(())
    }

    /// All columns with their types: `run`, parameters and results, `status`.
    pub fn typed(&self) -> Vec<(String, ColumnValues<'_>)> {
        let run = ColumnValues::Integer(self.rows.keys().map(|&run| i64::try_from(run).ok()).collect());
        let numbers = |k: usize| ColumnValues::Real(self.rows.values().map(|row| row.0[k]).collect());
        let status = ColumnValues::Text(self.rows.values().map(|row| Some(row.1.as_str())).collect());
        let columns = self.columns.iter().enumerate().map(|(k, name)| (name.clone(), numbers(k)));
        std::iter::once(("run".to_owned(), run)).chain(columns).chain([("status".to_owned(), status)]).collect()
    }

    /// The values of one column for all runs; NaN where a run is missing.
    pub fn column(&self, index: usize) -> Vec<f64> {
        (1..=self.runs).map(|run| self.rows.get(&run).map_or(f64::NAN, |r| r.0[index])).collect()
    }
}

/// A cell, in quotes where it holds a comma or quotes.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

/// The cells of a line without their quotes.
fn cells(line: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut inside = false;
    let mut letters = line.chars().peekable();
    while let Some(c) = letters.next() {
        let last = out.len() - 1;
        match c {
            '"' if inside && letters.peek() == Some(&'"') => {
                letters.next();
                out[last].push('"');
            }
            '"' => inside = !inside,
            ',' if !inside => out.push(String::new()),
            c => out[last].push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> SweepTable {
        let print = fingerprint(&["a".into()], &[vec![1.0]]);
        let mut table = SweepTable::new(print, 3, vec!["v[1,2].p".into(), "peak".into()]);
        table.rows.insert(2, (vec![1.5, f64::NAN], "it said \"no\", twice".into()));
        table.rows.insert(1, (vec![1e-7, 3.0], "ok".into()));
        table
    }

    #[test]
    fn tables_are_read_back_and_a_torn_line_is_left_out() {
        let text = table().text();
        let again = SweepTable::read(&(text.clone() + "3,1.5,2")).unwrap();
        assert_eq!(again.text(), text);
        assert_eq!(again.column(1)[0], 3.0);
        assert!(again.column(1)[1..].iter().all(|v| v.is_nan()));
        assert!(SweepTable::read("time,x\n0,1\n").is_err() && SweepTable::read("").is_err());
    }

    #[test]
    fn parts_are_merged() {
        let mut whole = table();
        let mut part = SweepTable::new(whole.fingerprint.clone(), 3, whole.columns.clone());
        part.rows.insert(3, (vec![0.0, 1.0], "ok".into()));
        whole.merge(part).unwrap();
        assert_eq!(whole.rows.len(), 3);
        assert!(whole.merge(SweepTable::default()).is_err());
        assert_ne!(fingerprint(&["a".into()], &[]), fingerprint(&["b".into()], &[]));
    }
}
