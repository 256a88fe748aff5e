//! CSV files read back: results of any program, and recordings of a bench that drive or judge a model.
//!
//! Recognised without being told: delimiters `,` `;` and tab, decimal commas, a row of units below the names (or
//! `name [unit]`), `#` lines, a byte order mark, quoted names. Everything that is wrong is said with its place.

use std::ops::Range;

use indexmap::IndexMap;

use super::cells::{CellRows, TextCell};
use super::number;
use super::trajectory::{Kind, Signal, Trajectory};
use bramah_expr::units::MeasurementUnit;
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources, Span, StageResult};

/// What is asked of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadStrictness<'a> {
    /// Every column is read. Empty cells, words (`true`, literals) and rows of equal time are fine.
    Result,
    /// Only these columns are read, and must hold numbers. Time must not fall and have no gaps; rows of equal time are jumps.
    Inputs(&'a [String]),
    /// Only these columns are read. Time must grow without gaps; cells of `inputs` must all hold numbers, those of
    /// `outputs` may be empty.
    Recording {
        /// Columns that drive the model.
        inputs: &'a [String],
        /// Columns to compare with.
        outputs: &'a [String],
    },
}

/// Names under which programs write the time, tried in this order before the first column is taken.
const TIME_NAMES: [&str; 6] = ["time", "t", "t_s", "time_s", "timestamp", "zeit"];

/// Reads a CSV file that was added to `sources`.
///
/// The time column is `time_column`, else one with a usual name, else the first.
///
/// # Errors
/// [`Code::BadData`] with file, line and column: missing or doubled columns, time that does not grow, gaps, NaN, words
/// where a number is needed, rows of other length. A fault is reported once a column, with the number of cells.
pub fn read_csv(
    sources: &Sources,
    file: FileId,
    time_column: Option<&str>,
    strictness: ReadStrictness<'_>,
) -> StageResult<Trajectory> {
    let mut rows = CellRows::new(&sources.get(file).text);
    let mut cells = Vec::new();
    if !rows.next_row(&mut cells) {
        return StageResult::failed(vec![
            Diagnostic::new(Code::BadData, "the file holds no data")
                .at(Span { file, start: 0, end: 0 }, "a row of column names is expected here"),
        ]);
    }
    let mut head = HeaderRow::new(file, &cells, rows.decimal_comma());
    let (time, wanted) = match head.choose(time_column, strictness) {
        Ok(chosen) => chosen,
        Err(diagnostics) => return StageResult::failed(diagnostics),
    };
    let strict = strictness != ReadStrictness::Result;
    let mut reader = RecordingReader::new(file, time, &wanted, head.width, strict, rows.decimal_comma());
    reader.jumps = matches!(strictness, ReadStrictness::Inputs(_));
    let mut first = true;
    while rows.next_row(&mut cells) {
        if !(std::mem::take(&mut first) && head.take_units(&cells, time, rows.decimal_comma())) {
            reader.row(&cells, &head.names);
        }
    }
    reader.finish(&head, &wanted)
}

/// The names of the columns of a CSV text, without units.
pub fn column_names(text: &str) -> Vec<String> {
    let mut cells = Vec::new();
    CellRows::new(text).next_row(&mut cells);
    cells.iter().map(|c| split_unit(&c.text).0.to_owned()).collect()
}

/// The unit that the file itself gives a column, and where it does.
pub(super) fn unit_place(sources: &Sources, file: FileId, column: &str) -> Option<(String, Span)> {
    let mut rows = CellRows::new(&sources.get(file).text);
    let mut cells = Vec::new();
    if !rows.next_row(&mut cells) {
        return None;
    }
    let mut head = HeaderRow::new(file, &cells, rows.decimal_comma());
    let index = head.find(column).ok()?;
    if rows.next_row(&mut cells) {
        let time = (0..head.width).find(|&i| cells.get(i).is_some_and(|c| !c.text.is_empty())).unwrap_or(0);
        head.take_units(&cells, time, rows.decimal_comma());
    }
    let unit = head.units[index].clone();
    (!unit.is_empty()).then(|| (unit, span(file, &head.unit_places[index])))
}

/// A column that is read.
#[derive(Clone, Copy, Debug)]
struct ColumnRequest {
    /// Its index in the file.
    index: usize,
    /// Every cell must hold a number.
    complete: bool,
}

/// The row of names, and of units where there is one.
struct HeaderRow {
    file: FileId,
    names: Vec<String>,
    units: Vec<String>,
    places: Vec<Range<usize>>,
    /// Where the units stand: the cell of the name, or of the row of units.
    unit_places: Vec<Range<usize>>,
    width: usize,
    numeric: bool,
}

impl HeaderRow {
    fn new(file: FileId, cells: &[TextCell<'_>], decimal_comma: bool) -> Self {
        let mut head = HeaderRow {
            file,
            names: Vec::new(),
            units: Vec::new(),
            places: Vec::new(),
            unit_places: Vec::new(),
            width: cells.len(),
            numeric: cells.iter().all(|c| number::parse(&c.text, decimal_comma).is_some()),
        };
        for cell in cells {
            let (name, unit) = split_unit(&cell.text);
            head.names.push(name.to_owned());
            head.units.push(unit.to_owned());
            head.places.push(cell.place.clone());
            head.unit_places.push(cell.place.clone());
        }
        head
    }

    fn error(&self, place: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Code::BadData, message).at(span(self.file, &place), label)
    }

    /// The time column and the columns to read.
    fn choose(
        &self,
        time_column: Option<&str>,
        strictness: ReadStrictness<'_>,
    ) -> Result<(usize, Vec<ColumnRequest>), Vec<Diagnostic>> {
        if self.numeric {
            let place = self.places[0].clone();
            return Err(vec![
                self.error(place, "the first row holds numbers, not the names of the columns", "names belong here")
                    .help("put a row such as `time,u,y` above the numbers"),
            ]);
        }
        let time = match time_column {
            Some(name) => self.find(name).map_err(|d| vec![d])?,
            None => self.usual_time(),
        };
        let wanted = match strictness {
            ReadStrictness::Result => self.all_but(time)?,
            ReadStrictness::Inputs(inputs) => self.named(inputs, &[])?,
            ReadStrictness::Recording { inputs, outputs } => self.named(inputs, outputs)?,
        };
        Ok((time, wanted))
    }

    fn usual_time(&self) -> usize {
        let same = |usual: &str| self.names.iter().position(|n| n.eq_ignore_ascii_case(usual));
        TIME_NAMES.iter().find_map(|usual| same(usual)).unwrap_or(0)
    }

    fn all_but(&self, time: usize) -> Result<Vec<ColumnRequest>, Vec<Diagnostic>> {
        let columns = (0..self.width).filter(|&i| i != time && !self.names[i].is_empty());
        let wanted: Vec<ColumnRequest> = columns.map(|index| ColumnRequest { index, complete: false }).collect();
        if wanted.is_empty() {
            let place = self.places[time].clone();
            return Err(vec![self.error(place, "the file has no column besides time", "the only column")]);
        }
        Ok(wanted)
    }

    fn named(&self, inputs: &[String], outputs: &[String]) -> Result<Vec<ColumnRequest>, Vec<Diagnostic>> {
        let mut wanted = Vec::new();
        let mut problems = Vec::new();
        let all = inputs.iter().map(|n| (n, true)).chain(outputs.iter().map(|n| (n, false)));
        for (name, complete) in all {
            match self.find(name) {
                Ok(index) => wanted.push(ColumnRequest { index, complete }),
                Err(problem) => problems.push(problem),
            }
        }
        if problems.is_empty() { Ok(wanted) } else { Err(problems) }
    }

    fn find(&self, name: &str) -> Result<usize, Diagnostic> {
        let mut found = (0..self.width).filter(|&i| self.names[i] == name);
        match (found.next(), found.next()) {
            (Some(first), None) => Ok(first),
            (Some(_), Some(second)) => {
                let place = self.places[second].clone();
                Err(self.error(place, format!("two columns are named `{name}`"), "the second one"))
            }
            _ => Err(self.missing(name)),
        }
    }

    fn missing(&self, name: &str) -> Diagnostic {
        let place = self.places[0].start..self.places[self.width - 1].end;
        let known: Vec<String> = self.names.iter().map(|n| format!("`{n}`")).collect();
        let shown = known.iter().take(10).cloned().collect::<Vec<_>>().join(", ");
        let more = if known.len() > 10 { format!(" and {} more", known.len() - 10) } else { String::new() };
        let problem = self
            .error(place, format!("there is no column `{name}`"), "the names of the columns")
            .note(format!("the file has {shown}{more}"));
        if let Some(near) = bramah_syntax::diag::nearest(name, self.names.iter().map(String::as_str)) {
            return problem.help(format!("did you mean `{near}`?"));
        }
        problem.help("name one of these")
    }

    /// Takes the row as units when it holds words only, also in the time column.
    fn take_units(&mut self, cells: &[TextCell<'_>], time: usize, decimal_comma: bool) -> bool {
        let is_word = |c: &TextCell<'_>| !c.text.is_empty() && number::parse(&c.text, decimal_comma).is_none();
        // `1` is the unit of what has none
        let words_only = cells.iter().all(|c| c.text.is_empty() || is_word(c) || c.text.trim() == "1");
        if cells.len() != self.width || !words_only || !cells.get(time).is_some_and(is_word) {
            return false;
        }
        for (i, cell) in cells.iter().enumerate() {
            let text = cell.text.trim_matches(['[', ']', '(', ')', ' ']);
            if !text.is_empty() && text != "-" {
                self.units[i] = text.to_owned();
                self.unit_places[i] = cell.place.clone();
            }
        }
        true
    }
}

/// `tau [N]` is a name with a unit; `v[3]` is a name.
fn split_unit(text: &str) -> (&str, &str) {
    let inside = text.strip_suffix(']').and_then(|t| t.rsplit_once(" ["));
    match inside {
        Some((name, unit)) if !name.trim().is_empty() => (name.trim(), unit.trim()),
        _ => (text, ""),
    }
}

fn span(file: FileId, place: &Range<usize>) -> Span {
    let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    Span { file, start: byte(place.start), end: byte(place.end) }
}

/// What can be wrong with a cell or row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum CellFault {
    Length,
    NoTime,
    TimeFalls,
    TimeStands,
    Gap,
    Word,
    Empty,
    NotFinite,
}

/// The first cell with a fault, and how many there are.
struct FaultRecord {
    place: Range<usize>,
    text: String,
    count: usize,
}

/// Values of one column as they come in.
struct ColumnBuilder {
    index: usize,
    complete: bool,
    values: Vec<f64>,
    /// Words in order of appearance; a cell's value is the word's number, counted from 1.
    words: IndexMap<String, ()>,
    numbers: bool,
}

struct RecordingReader {
    file: FileId,
    time: usize,
    width: usize,
    strict: bool,
    /// Whether rows may have equal times all the same.
    jumps: bool,
    decimal_comma: bool,
    times: Vec<f64>,
    time_places: Vec<Range<usize>>,
    columns: Vec<ColumnBuilder>,
    faults: IndexMap<(CellFault, usize), FaultRecord>,
}

impl RecordingReader {
    fn new(
        file: FileId,
        time: usize,
        wanted: &[ColumnRequest],
        width: usize,
        strict: bool,
        decimal_comma: bool,
    ) -> Self {
        let column = |w: &ColumnRequest| ColumnBuilder {
            index: w.index,
            complete: w.complete,
            values: Vec::new(),
            words: IndexMap::new(),
            numbers: false,
        };
        RecordingReader {
            file,
            time,
            width,
            strict,
            jumps: false,
            decimal_comma,
            times: Vec::new(),
            time_places: Vec::new(),
            columns: wanted.iter().map(column).collect(),
            faults: IndexMap::new(),
        }
    }

    fn fault(&mut self, fault: CellFault, column: usize, place: &Range<usize>, text: impl Into<String>) {
        let found = self.faults.entry((fault, column)).or_insert_with(|| FaultRecord {
            place: place.clone(),
            text: text.into(),
            count: 0,
        });
        found.count += 1;
    }

    fn row(&mut self, cells: &[TextCell<'_>], names: &[String]) {
        let surplus = cells.len() == self.width + 1 && cells[self.width].text.is_empty();
        if cells.len() != self.width && !surplus {
            let place = cells[0].place.start..cells[cells.len() - 1].place.end;
            let said = format!("{} cells instead of {}", cells.len(), self.width);
            self.fault(CellFault::Length, 0, &place, said);
            return;
        }
        if !self.take_time(&cells[self.time]) {
            return;
        }
        for i in 0..self.columns.len() {
            let index = self.columns[i].index;
            self.cell(i, &cells[index], &names[index]);
        }
    }

    fn take_time(&mut self, cell: &TextCell<'_>) -> bool {
        let Some(time) = number::parse(&cell.text, self.decimal_comma).filter(|t| t.is_finite()) else {
            self.fault(CellFault::NoTime, 0, &cell.place, cell.text.as_ref());
            return false;
        };
        if let Some(&last) = self.times.last() {
            let said = format!("{} after {}", number::text(time), number::text(last));
            if time < last {
                self.fault(CellFault::TimeFalls, 0, &cell.place, said);
            } else if time == last && self.strict && !self.jumps {
                self.fault(CellFault::TimeStands, 0, &cell.place, said);
            }
        }
        self.times.push(time);
        if self.strict {
            self.time_places.push(cell.place.clone());
        }
        true
    }

    fn cell(&mut self, i: usize, cell: &TextCell<'_>, name: &str) {
        let column = &mut self.columns[i];
        let value = number::parse(&cell.text, self.decimal_comma).or_else(|| self.strict.then(|| truth(&cell.text))?);
        let (index, complete) = (column.index, column.complete);
        match value {
            Some(value) if column.words.is_empty() => {
                column.numbers = true;
                column.values.push(value);
                if self.strict && !value.is_finite() {
                    self.fault(CellFault::NotFinite, index, &cell.place, name);
                }
            }
            None if cell.text.is_empty() => {
                column.values.push(f64::NAN);
                if complete {
                    self.fault(CellFault::Empty, index, &cell.place, name);
                }
            }
            None if !self.strict && !column.numbers => {
                let number = column.words.insert_full(cell.text.to_string(), ()).0 + 1;
                column.values.push(number as f64);
            }
            _ => {
                column.values.push(f64::NAN);
                self.fault(CellFault::Word, index, &cell.place, cell.text.as_ref());
            }
        }
    }

    /// Holes in a regular recording: a step much longer than the usual one.
    fn look_for_gaps(&mut self) {
        let mut steps: Vec<f64> = self.times.windows(2).map(|w| w[1] - w[0]).collect();
        if steps.len() < 10 {
            return;
        }
        let all = steps.clone();
        steps.sort_by(f64::total_cmp);
        let usual = steps[steps.len() / 2];
        let regular = steps.iter().filter(|&&s| (s - usual).abs() <= 0.2 * usual).count();
        if usual <= 0.0 || regular * 10 < steps.len() * 9 {
            return;
        }
        for (i, &step) in all.iter().enumerate() {
            if step > 5.0 * usual {
                let said = format!(
                    "{} s pass here; the file is sampled every {} s",
                    number::rounded(step, 4),
                    number::rounded(usual, 4)
                );
                let place = self.time_places[i + 1].clone();
                self.fault(CellFault::Gap, 0, &place, said);
            }
        }
    }

    fn finish(mut self, head: &HeaderRow, wanted: &[ColumnRequest]) -> StageResult<Trajectory> {
        if self.strict && self.faults.is_empty() {
            self.look_for_gaps();
        }
        let mut diagnostics: Vec<Diagnostic> = self
            .faults
            .iter()
            .map(|(&(fault, column), found)| describe(self.file, fault, &head.names[column], found))
            .collect();
        if self.times.is_empty() && diagnostics.is_empty() {
            let end = head.places[head.width - 1].clone();
            diagnostics.push(head.error(end, "the file has names but no rows", "nothing below"));
        }
        if !diagnostics.is_empty() {
            return StageResult::failed(diagnostics);
        }
        let doubt = self.strict.then(|| self.doubt_seconds(head)).flatten();
        in_seconds(&mut self.times, &head.units[self.time]);
        let mut trajectory = Trajectory { times: self.times, ..Trajectory::default() };
        for (column, w) in self.columns.into_iter().zip(wanted) {
            let mut signal = Signal::new(&head.names[w.index]).unit(&head.units[w.index]);
            let (kind, values) = typed(column);
            signal.kind = kind;
            trajectory.signals.push(signal);
            trajectory.columns.push(values);
        }
        StageResult::new(trajectory, doubt.into_iter().collect())
    }

    /// A warning where times without a unit, which are read as seconds, look like counted milliseconds: equal steps of
    /// one or more over a thousand and more. Steps of whole minutes are how slow rigs are sampled.
    fn doubt_seconds(&self, head: &HeaderRow) -> Option<Diagnostic> {
        let name = &head.names[self.time];
        let says_seconds = name.to_ascii_lowercase().ends_with("_s");
        if !head.units[self.time].is_empty() || says_seconds {
            return None;
        }
        let length = self.times.last()? - self.times.first()?;
        let mut steps: Vec<f64> = self.times.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        let usual = *steps.get(steps.len() / 2)?;
        let whole = self.times.iter().all(|t| t.fract() == 0.0);
        let even = steps.iter().all(|s| (s - usual).abs() <= 1e-6 * usual);
        if usual < 1.0 || length < 1000.0 || usual % 60.0 == 0.0 || !(whole || even) {
            return None;
        }
        let (unit, units, smaller) =
            if usual < 1000.0 { ("ms", "milliseconds", 1e3) } else { ("us", "microseconds", 1e6) };
        let shown = |x: f64| number::rounded(x, 4);
        let message = format!(
            "the time column `{name}` has no unit: read as seconds it lasts {} s, with a sample every {} s",
            shown(length),
            shown(usual)
        );
        Some(
            Diagnostic::new(Code::TimeUnit, message)
                .at(span(self.file, &head.places[self.time]), "no unit here, and no row of units below")
                .note(format!(
                    "as {units} it would last {} s, with {} samples a second",
                    shown(length / smaller),
                    shown(smaller / usual)
                ))
                .help(format!("write `{name} [{unit}]` where these are {units}, `{name} [s]` where they are seconds")),
        )
    }
}

/// Times in another unit become seconds; a unit that is none of time is taken as a remark.
fn in_seconds(times: &mut [f64], unit: &str) {
    if let (Ok(unit), Ok(second)) = (MeasurementUnit::parse(unit), MeasurementUnit::parse("s"))
        && !unit.dimension.is_none()
    {
        times.iter_mut().for_each(|t| *t = unit.convert(*t, &second).unwrap_or(*t));
    }
}

/// The value of a Boolean word.
fn truth(word: &str) -> Option<f64> {
    match word.to_ascii_lowercase().as_str() {
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ => None,
    }
}

/// Columns of words are Booleans or enumerations.
fn typed(mut column: ColumnBuilder) -> (Kind, Vec<f64>) {
    if column.words.is_empty() {
        return (Kind::Real, column.values);
    }
    let truth: Option<Vec<f64>> = column.words.keys().map(|w| truth(w)).collect();
    match truth {
        Some(truth) => {
            for value in column.values.iter_mut().filter(|v| !v.is_nan()) {
                *value = truth[*value as usize - 1];
            }
            (Kind::Boolean, column.values)
        }
        None => (Kind::Enumeration(column.words.into_keys().collect()), column.values),
    }
}

fn describe(file: FileId, fault: CellFault, column: &str, found: &FaultRecord) -> Diagnostic {
    let text = &found.text;
    let (message, label, help) = match fault {
        CellFault::Length => ("a row has another length than the row of names".to_owned(), text.clone(), ""),
        CellFault::NoTime => ("a row has no time".to_owned(), format!("`{text}` is no number"), ""),
        CellFault::TimeFalls => (
            "time runs backwards".to_owned(),
            text.clone(),
            "sort the rows, or cut the file where a new recording begins",
        ),
        CellFault::TimeStands => ("time does not grow".to_owned(), text.clone(), "keep one row of each time"),
        CellFault::Gap => ("the recording has a gap".to_owned(), text.clone(), "cut the file at the gap, or fill it"),
        CellFault::Word => (
            format!("a word stands in column `{column}` where a number is needed"),
            format!("`{text}` is no number"),
            "",
        ),
        CellFault::Empty => (
            format!("a cell of the input `{text}` is empty"),
            "inputs must be complete".to_owned(),
            "fill it, or cut the file",
        ),
        CellFault::NotFinite => (format!("a value of `{text}` is not finite"), "NaN or infinite".to_owned(), ""),
    };
    let label = if found.count > 1 { format!("{label} (first of {})", found.count) } else { label };
    let diagnostic = Diagnostic::new(Code::BadData, message).at(span(file, &found.place), label);
    if help.is_empty() { diagnostic } else { diagnostic.help(help) }
}

#[cfg(test)]
#[path = "recording_tests.rs"]
mod tests;
