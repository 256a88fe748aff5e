//! Reads CSV files: results of any program, and recordings of a test bench that drive or judge a model.
//! Text enters, a [`Trajectory`] or diagnostics leave. The crates `analysis` and `gap` and the command call
//! [`read_csv`].
//!
//! These are recognised: delimiters `,` `;` and tab, decimal commas, a row of units below the names (or `name [unit]`),
//! lines with `#`, a byte order mark, quoted names. Every fault is reported with its place.

use std::ops::Range;

use indexmap::IndexMap;

use super::cells::{CellRows, TextCell};
use super::number;
use super::trajectory::{Kind, Signal, Trajectory};
use bramah_expr::units::MeasurementUnit;
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources, Span, StageResult};

/// The requirements on a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadStrictness<'a> {
    /// All columns are read. Empty cells, words (`true`, literals) and rows of equal time are allowed.
    Result,
    /// Only these columns are read, and they must hold numbers. Time must not decrease or have gaps; rows of equal time
    /// are
    /// jumps.
    Inputs(&'a [String]),
    /// Only these columns are read. Time must increase without gaps. The cells of `inputs` must all hold numbers, those
    /// of
    /// `outputs` may be empty.
    Recording {
        /// Columns that drive the model.
        inputs: &'a [String],
        /// Columns to compare with.
        outputs: &'a [String],
    },
}

/// Names by which programs call the time, in the order in which they are tried before the first column is taken.
const TIME_NAMES: [&str; 6] = ["time", "t", "t_s", "time_s", "timestamp", "zeit"];

/// Reads a CSV file whose text was added to `sources`.
///
/// The time column is `time_column`, else one with a usual name, else the first one.
///
/// # Errors
/// [`Code::BadData`] with file, line and column: missing or doubled columns, decreasing time, gaps, NaN, words where a
/// number is needed, rows of another length. A kind of fault is reported once a column, with the number of cells.
pub fn read_csv(
    sources: &Sources,
    file: FileId,
    time_column: Option<&str>,
    strictness: ReadStrictness<'_>,
) -> StageResult<Trajectory> {
    let mut rows = CellRows::new(&sources.get(file).text);
    let mut cells = Vec::new();
    if !rows.next_row(&mut cells) {
        // There is not even a row of names.
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
        // Only the first row below the names may be one of units.
        if !(std::mem::take(&mut first) && head.take_units(&cells, time, rows.decimal_comma())) {
            reader.row(&cells, &head.names);
        }
    }
    reader.finish(&head, &wanted)
}

/// The names of the columns of a CSV text, without their units.
pub fn column_names(text: &str) -> Vec<String> {
    let mut cells = Vec::new();
    CellRows::new(text).next_row(&mut cells);
    cells.iter().map(|c| split_unit(&c.text).0.to_owned()).collect()
}

/// The unit that the file gives a column, and its place. `None` if there is no such column or no unit.
pub(super) fn unit_place(sources: &Sources, file: FileId, column: &str) -> Option<(String, Span)> {
    let mut rows = CellRows::new(&sources.get(file).text);
    let mut cells = Vec::new();
    if !rows.next_row(&mut cells) {
        return None;
    }
    let mut head = HeaderRow::new(file, &cells, rows.decimal_comma());
    let index = head.find(column).ok()?;
    if rows.next_row(&mut cells) {
        // Any column with a cell will do here, because only words are looked for.
        let time = (0..head.width).find(|&i| cells.get(i).is_some_and(|c| !c.text.is_empty())).unwrap_or(0);
        head.take_units(&cells, time, rows.decimal_comma());
    }
    let unit = head.units[index].clone();
    (!unit.is_empty()).then(|| (unit, span(file, &head.unit_places[index])))
}

/// A column that is to be read.
#[derive(Clone, Copy, Debug)]
struct ColumnRequest {
    /// Its index in the file.
    index: usize,
    /// True if every cell must hold a number.
    complete: bool,
}

/// The row of names, and the units if the file gives them.
struct HeaderRow {
    /// The file.
    file: FileId,
    /// The name of each column, without its unit.
    names: Vec<String>,
    /// The unit of each column. Empty if there is none.
    units: Vec<String>,
    /// The place of each name.
    places: Vec<Range<usize>>,
    /// The place of each unit: the cell of the name, or of the row of units.
    unit_places: Vec<Range<usize>>,
    /// The number of columns.
    width: usize,
    /// True if all names are numbers, so that the row of names is missing.
    numeric: bool,
}

impl HeaderRow {
    /// The names of the first row, with the units that stand behind them.
    /// A cell without text makes a column without a name.
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

    /// An error at a place of the header.
    /// Its code is [`Code::BadData`].
    fn error(&self, place: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Code::BadData, message).at(span(self.file, &place), label)
    }

    /// The index of the time column, and the columns to be read.
    ///
    /// # Errors
    /// The row of names is missing, or there is no such column, or it is there twice.
    fn choose(
        &self,
        time_column: Option<&str>,
        strictness: ReadStrictness<'_>,
    ) -> Result<(usize, Vec<ColumnRequest>), Vec<Diagnostic>> {
        // Without names columns could only be numbered, and the first row would be lost.
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

    /// The index of a column with a usual name for time, else 0.
    /// Upper and lower case do not matter.
    fn usual_time(&self) -> usize {
        let same = |usual: &str| self.names.iter().position(|n| n.eq_ignore_ascii_case(usual));
        TIME_NAMES.iter().find_map(|usual| same(usual)).unwrap_or(0)
    }

    /// All named columns except for time.
    /// Columns without a name are left out. None of them must be complete.
    fn all_but(&self, time: usize) -> Result<Vec<ColumnRequest>, Vec<Diagnostic>> {
        let columns = (0..self.width).filter(|&i| i != time && !self.names[i].is_empty());
        let wanted: Vec<ColumnRequest> = columns.map(|index| ColumnRequest { index, complete: false }).collect();
        if wanted.is_empty() {
            let place = self.places[time].clone();
            return Err(vec![self.error(place, "the file has no column besides time", "the only column")]);
        }
        Ok(wanted)
    }

    /// The columns of these names. The errors list all that are missing.
    /// Inputs come first, and must be complete; outputs need not be.
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

    /// The index of the column of this name, of which there must be one only.
    fn find(&self, name: &str) -> Result<usize, Diagnostic> {
        let mut found = (0..self.width).filter(|&i| self.names[i] == name);
        match (found.next(), found.next()) {
            (Some(first), None) => Ok(first),
            // Which of them is meant cannot be known.
            (Some(_), Some(second)) => {
                let place = self.places[second].clone();
                Err(self.error(place, format!("two columns are named `{name}`"), "the second one"))
            }
            _ => Err(self.missing(name)),
        }
    }

    /// The error that a column is missing, with the names that there are and the nearest one.
    /// At most ten names are shown.
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

    /// Takes a row as units if it holds only words, in the time column too. False if it does not; it is then a row of
    /// values.
    fn take_units(&mut self, cells: &[TextCell<'_>], time: usize, decimal_comma: bool) -> bool {
        let is_word = |c: &TextCell<'_>| !c.text.is_empty() && number::parse(&c.text, decimal_comma).is_none();
        // `1` is the unit of what has none.
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

/// Splits a name from its unit: `tau [N]` has one, `v[3]` is a name. The unit is empty if there is none.
fn split_unit(text: &str) -> (&str, &str) {
    let inside = text.strip_suffix(']').and_then(|t| t.rsplit_once(" ["));
    match inside {
        Some((name, unit)) if !name.trim().is_empty() => (name.trim(), unit.trim()),
        _ => (text, ""),
    }
}

/// The span of some bytes of the file.
fn span(file: FileId, place: &Range<usize>) -> Span {
    let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    Span { file, start: byte(place.start), end: byte(place.end) }
}

/// The kinds of faults of a cell or row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum CellFault {
    /// The row has another number of cells than the row of names.
    Length,
    /// The time is no finite number.
    NoTime,
    /// The time is smaller than that of the row before.
    TimeFalls,
    /// The time is equal to that of the row before.
    TimeStands,
    /// The step in time is much longer than usual.
    Gap,
    /// A word stands where a number is needed.
    Word,
    /// A cell of an input is empty.
    Empty,
    /// A value is infinite or NaN.
    NotFinite,
}

/// The first cell with a fault, and the number of such cells.
struct FaultRecord {
    /// The place of the first one.
    place: Range<usize>,
    /// Its text, or what a message says about it.
    text: String,
    /// How many there are.
    count: usize,
}

/// The values of one column while the file is read.
struct ColumnBuilder {
    /// The index of the column in the file.
    index: usize,
    /// True if every cell must hold a number.
    complete: bool,
    /// One value for each row. NaN for an empty cell.
    values: Vec<f64>,
    /// The distinct words in order of appearance. The value of a cell is the number of its word, counted from 1.
    words: IndexMap<String, ()>,
    /// True if a number was read. Words after numbers are faults.
    numbers: bool,
}

/// The state of reading the rows of a file.
struct RecordingReader {
    /// The file.
    file: FileId,
    /// The index of the time column.
    time: usize,
    /// The number of columns.
    width: usize,
    /// True unless the file is read as a result.
    strict: bool,
    /// True if rows may have equal times although `strict` is true.
    jumps: bool,
    /// True if numbers may have a decimal comma.
    decimal_comma: bool,
    /// The time of each row, in the file's unit.
    times: Vec<f64>,
    /// The place of each time, for messages about gaps. Empty unless `strict`.
    time_places: Vec<Range<usize>>,
    /// The columns that are read.
    columns: Vec<ColumnBuilder>,
    /// The faults by kind and column, in the order in which they were found.
    faults: IndexMap<(CellFault, usize), FaultRecord>,
}

impl RecordingReader {
    /// A reader for the columns `wanted`.
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

    /// Records a fault. Only the first of a kind and column keeps its place.
    /// `text` is what the message says about it.
    fn fault(&mut self, fault: CellFault, column: usize, place: &Range<usize>, text: impl Into<String>) {
        let found = self.faults.entry((fault, column)).or_insert_with(|| FaultRecord {
            place: place.clone(),
            text: text.into(),
            count: 0,
        });
        found.count += 1;
    }

    /// Takes a row of cells.
    /// A row of another length is recorded as a fault and skipped.
    fn row(&mut self, cells: &[TextCell<'_>], names: &[String]) {
        // Some programs end each row with a delimiter, which makes an empty cell.
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

    /// Takes the time of a row. False if it is no number; the row is then skipped.
    /// Times that do not increase are faults, and are kept all the same.
    fn take_time(&mut self, cell: &TextCell<'_>) -> bool {
        let Some(time) = number::parse(&cell.text, self.decimal_comma).filter(|t| t.is_finite()) else {
            self.fault(CellFault::NoTime, 0, &cell.place, cell.text.as_ref());
            return false;
        };
        // The first row has nothing to compare with.
        if let Some(&last) = self.times.last() {
            let said = format!("{} after {}", number::text(time), number::text(last));
            if time < last {
                self.fault(CellFault::TimeFalls, 0, &cell.place, said);
            } else if time == last && self.strict && !self.jumps {
                self.fault(CellFault::TimeStands, 0, &cell.place, said);
            }
        }
        self.times.push(time);
        // Places are needed only for gaps, and take more memory than the times.
        if self.strict {
            self.time_places.push(cell.place.clone());
        }
        true
    }

    /// Takes a cell of column `i`.
    /// `name` is that of the column, for messages.
    fn cell(&mut self, i: usize, cell: &TextCell<'_>, name: &str) {
        let column = &mut self.columns[i];
        // In recordings the words `true` and `false` are numbers; in results they make a Boolean column.
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
                // An empty cell is NaN, and allowed except in inputs.
                column.values.push(f64::NAN);
                if complete {
                    self.fault(CellFault::Empty, index, &cell.place, name);
                }
            }
            // The first cell decides whether a column of a result holds words.
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

    /// Records gaps in a recording with regular steps: a step of more than five times the usual one.
    fn look_for_gaps(&mut self) {
        let mut steps: Vec<f64> = self.times.windows(2).map(|w| w[1] - w[0]).collect();
        // With few rows no step is usual.
        if steps.len() < 10 {
            return;
        }
        let all = steps.clone();
        steps.sort_by(f64::total_cmp);
        let usual = steps[steps.len() / 2];
        let regular = steps.iter().filter(|&&s| (s - usual).abs() <= 0.2 * usual).count();
        // Nine steps of ten must be near the median, or the recording is not regular.
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

    /// The trajectory, or the faults.
    /// The warning about the unit of time comes with the trajectory.
    fn finish(mut self, head: &HeaderRow, wanted: &[ColumnRequest]) -> StageResult<Trajectory> {
        if self.strict && self.faults.is_empty() {
            // A row that was skipped would look like a gap.
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
        // Before times are converted, because the warning quotes the file's numbers.
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

    /// A warning if times without a unit, which are read as seconds, look like counted milliseconds.
    /// They do if the steps are equal and at least 1, over 1000 or more. Steps of whole minutes are excluded, because
    /// slow
    /// test benches are sampled so.
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

/// Converts times to s. A unit that is none of time is taken for a remark, and the times stay.
fn in_seconds(times: &mut [f64], unit: &str) {
    if let (Ok(unit), Ok(second)) = (MeasurementUnit::parse(unit), MeasurementUnit::parse("s"))
        && !unit.dimension.is_none()
    {
        times.iter_mut().for_each(|t| *t = unit.convert(*t, &second).unwrap_or(*t));
    }
}

/// The value of a Boolean word, in upper or lower case. `None` if it is none.
fn truth(word: &str) -> Option<f64> {
    match word.to_ascii_lowercase().as_str() {
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ => None,
    }
}

/// The type and values of a column. One with words is a Boolean if all of them are, else an enumeration.
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

/// The diagnostic about a fault, with its help.
/// `column` is the name of the column concerned.
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
