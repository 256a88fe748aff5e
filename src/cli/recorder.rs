//! Writes the rows of a run into a result file or to stdout.
//!
//! Rows enter one at a time from `simulate`. They are buffered in memory and leave in large blocks through the writer
//! of the file's format. The file gets its final name when the run is over.
//!
//! Small writers for texts and tables that other subcommands use stand at the end.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::CommandFailure;
use super::checkpoint::ResultPosition;
use super::files::{NewFile, access, ending, print};
use bramah_results::formats::{self, FORMATS, ResultFormat, ResultWriter};
use bramah_results::{CsvUnits, CsvWriter, Signal, Trajectory};
use bramah_syntax::diag::{Code, Diagnostic};

/// Bytes of rows that are buffered before they are written (32 MiB). Large blocks keep the run undisturbed; in Parquet
/// one block is a row group.
const BUFFER_BYTES: usize = 32 << 20;
/// Results larger than this many bytes are announced before the run.
const LARGE: u64 = 1_000_000_000;

/// Where a result goes, and in which format.
#[derive(Clone)]
pub(super) struct ResultTarget {
    /// The file. `None` for stdout.
    path: Option<PathBuf>,
    /// The format, found by the ending of the file's name.
    format: &'static ResultFormat,
}

impl ResultTarget {
    /// CSV on stdout.
    pub fn stdout() -> Self {
        // The first entry of the table of formats is CSV.
        ResultTarget { path: None, format: &FORMATS[0] }
    }

    /// The target with this name; `-` is stdout. The ending of the name decides the format.
    ///
    /// `Err`: the ending belongs to a picture or to no known format.
    pub fn new(name: &str) -> Result<ResultTarget, CommandFailure> {
        let path = PathBuf::from(name);
        if name == "-" {
            return Ok(ResultTarget::stdout());
        }
        // A common mistake, which deserves a better help text than the list of formats.
        if path.extension().is_some_and(|e| ["html", "svg", "png"].iter().any(|p| e.eq_ignore_ascii_case(p))) {
            return Err(Diagnostic::new(Code::BadArgument, format!("`{name}` is no result file"))
                .help("a picture is written by `--plot`, or by `bramah plot` afterwards")
                .into());
        }
        let ending = ending(&path, "a result", &formats::endings())?;
        let format = formats::of_ending(ending).expect("one of the endings");
        Ok(ResultTarget { path: Some(path), format })
    }

    /// The entry of the format table.
    pub fn format(&self) -> &'static ResultFormat {
        self.format
    }

    /// The name as it appears in messages.
    pub fn name(&self) -> String {
        self.path.as_ref().map_or_else(|| "stdout".to_owned(), |path| path.display().to_string())
    }
}

/// Takes the rows of one run and writes them.
pub(super) struct ResultRecorder {
    /// Where the rows go.
    target: ResultTarget,
    /// Encodes rows into the format of the file. `None` after a failure.
    writer: Option<Box<dyn ResultWriter>>,
    /// The file under its temporary name. `None` for stdout.
    file: Option<NewFile>,
    /// Buffered rows, row after row; each row is its time followed by its values. One row at a time is several times
    /// faster than one column at a time when there are many columns.
    waiting: Vec<f64>,
    /// The signals; and all rows when `keep` is set.
    rows: Trajectory,
    /// Keep all rows in memory for use after the run.
    keep: bool,
    /// The first error of writing, reported by `finish`.
    failure: Option<CommandFailure>,
    /// Rows taken so far, those before a checkpoint included.
    count: usize,
    /// The reader of stdout has closed the pipe.
    unread: bool,
    /// Time spent on writing.
    writing: Duration,
}

impl ResultRecorder {
    /// Opens the target before the run, so that a wrong name is reported at once.
    ///
    /// `keep`: all rows are needed after the run.
    pub fn new(
        target: ResultTarget,
        signals: Vec<Signal>,
        units: CsvUnits,
        keep: bool,
    ) -> Result<Self, CommandFailure> {
        let file = target.path.as_deref().map(NewFile::create).transpose()?;
        Ok(Self::on(target, file, (signals, units), keep, None))
    }

    /// Opens a CSV file that survives when the process is killed.
    ///
    /// `written` is the position of a checkpoint; the file is cut there and continued. `None` begins a new file. `Err`:
    /// the format cannot grow, or the file cannot be opened or is shorter than the checkpoint says.
    pub fn lasting(
        target: ResultTarget,
        signals: Vec<Signal>,
        units: CsvUnits,
        written: Option<&ResultPosition>,
    ) -> Result<Self, CommandFailure> {
        // Only formats whose files grow row by row can be continued.
        let Some(path) = target.path.as_deref().filter(|_| target.format.grows) else {
            let text = format!("a run with checkpoints writes a CSV file, and the result is `{}`", target.name());
            return Err(Diagnostic::new(Code::BadArgument, text)
                .help("name one with `-o`; `bramah plot` draws it afterwards")
                .into());
        };
        let file = NewFile::lasting(path, written.map(|w| w.bytes))?;
        Ok(Self::on(target, Some(file), (signals, units), false, written))
    }

    /// The recorder of an opened file. A failure to write the header is kept and reported by `finish`.
    fn on(
        target: ResultTarget,
        file: Option<NewFile>,
        (signals, units): (Vec<Signal>, CsvUnits),
        keep: bool,
        written: Option<&ResultPosition>,
    ) -> ResultRecorder {
        let mut recorder = ResultRecorder {
            target,
            writer: None,
            file,
            waiting: Vec::new(),
            rows: Trajectory::new(signals),
            keep,
            failure: None,
            // Rows of an earlier start count too, since the summary and later checkpoints refer to the entire file.
            count: written.map_or(0, |w| w.rows),
            unread: false,
            writing: Duration::ZERO,
        };
        match recorder.open(units, written.map(|w| w.bytes)) {
            Ok(writer) => recorder.writer = Some(writer),
            Err(error) => recorder.fail(&error),
        }
        recorder
    }

    /// The writer of the format. It writes the header, or continues after `written` bytes.
    fn open(&self, units: CsvUnits, written: Option<u64>) -> std::io::Result<Box<dyn ResultWriter>> {
        let out: Box<dyn Write + Send> = match &self.file {
            // CSV rows arrive in large blocks, so a second buffer would only copy them.
            Some(file) if self.target.format.grows => Box::new(file.handle()?),
            Some(file) => Box::new(std::io::BufWriter::new(file.handle()?)),
            None => Box::new(std::io::BufWriter::new(std::io::stdout())),
        };
        match written {
            Some(bytes) => Ok(Box::new(CsvWriter::resume(out, &self.rows.signals, bytes))),
            None => (self.target.format.create)(out, &self.rows.signals, units),
        }
    }

    /// Notes a failure and drops the writer; further rows are ignored.
    fn fail(&mut self, error: &std::io::Error) {
        // A closed pipe is normal (`| head`); it ends the run without an error.
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            self.unread = true;
        } else {
            self.failure = Some(access(&PathBuf::from(self.target.name()), "written", error));
        }
        self.writer = None;
    }

    /// Takes a row. Returns false when writing has failed, so that the run can stop.
    pub fn row(&mut self, time: f64, values: &[f64]) -> bool {
        self.count += 1;
        if self.keep {
            self.rows.push(time, values);
        }
        if self.writer.is_some() {
            self.waiting.push(time);
            self.waiting.extend_from_slice(values);
        }
        // 8 bytes a value.
        if 8 * self.waiting.len() > BUFFER_BYTES {
            self.flush();
        }
        self.failure.is_none() && !self.unread
    }

    /// Whether the reader of stdout has closed the pipe. The command then ends without an error.
    pub fn is_unread(&self) -> bool {
        self.unread
    }

    /// Time spent on writing so far.
    pub fn writing(&self) -> Duration {
        self.writing
    }

    /// Writes the buffered rows and measures the time that it takes.
    fn flush(&mut self) {
        let clock = Instant::now();
        if let Some(writer) = &mut self.writer
            && let Err(error) = writer.rows(&self.waiting)
        {
            self.fail(&error);
        }
        self.waiting.clear();
        self.writing += clock.elapsed();
    }

    /// Writes all rows to the disk and returns the position that a checkpoint stores. `None` after a failure.
    pub fn mark(&mut self) -> Option<ResultPosition> {
        self.flush();
        let bytes = match self.writer.as_mut().map(|writer| writer.flush()) {
            Some(Ok(bytes)) => bytes,
            Some(Err(error)) => {
                self.fail(&error);
                return None;
            }
            None => return None,
        };
        // The data must be on the disk, not only in the system's cache, before a checkpoint refers to it.
        if let Some(Err(failure)) = self.file.as_ref().map(NewFile::sync) {
            self.failure = Some(failure);
            return None;
        }
        Some(ResultPosition { file: self.target.name(), bytes, rows: self.count })
    }

    /// Notes a failure from outside, such as a checkpoint that could not be written.
    pub fn failed(&mut self, failure: CommandFailure) {
        self.failure = Some(failure);
    }

    /// Ends without renaming the file. Rows up to the last mark are used when the run is continued.
    ///
    /// `Err` is the failure noted during the run, if there was one.
    pub fn suspend(mut self) -> Result<(), CommandFailure> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Number of rows taken so far.
    pub fn rows(&self) -> usize {
        self.count
    }

    /// Writes the remaining rows and renames the file to its final name.
    ///
    /// Returns the trajectory, which has rows only when `keep` was set. `Err`: something could not be written; what was
    /// written stays in `NAME.part`.
    pub fn finish(mut self) -> Result<Trajectory, CommandFailure> {
        self.flush();
        if let Some(writer) = self.writer.take()
            && let Err(error) = writer.finish()
        {
            self.fail(&error);
        }
        // A file is renamed only when everything was written; otherwise a broken file would look complete.
        match (self.failure.take(), self.file.take()) {
            (None, Some(file)) => file.finish()?,
            (Some(failure), file) => return Err(kept(failure, file)),
            (None, None) => {}
        }
        Ok(std::mem::take(&mut self.rows))
    }
}

/// Keeps the written part of a result under `NAME.part` and adds its name to the failure.
fn kept(mut failure: CommandFailure, file: Option<NewFile>) -> CommandFailure {
    if let (Some(path), Some(first)) = (file.and_then(NewFile::keep_part), failure.diagnostics.first_mut()) {
        first.notes.push(format!("what could be written is in `{}`", path.display()));
    }
    failure
}

/// A note that the result will take more than 1 GB; `None` for smaller ones.
///
/// `intervals` is the number of output intervals of the run. Rows at events are not counted.
pub(super) fn announcement(signals: &[Signal], intervals: f64, target: &ResultTarget) -> Option<Diagnostic> {
    let row = (target.format.bytes_per_row)(signals);
    let bytes = row as f64 * (intervals + 1.0);
    (bytes > LARGE as f64).then(|| {
        let text = format!("the result will take about {:.1} GB in `{}`", bytes / 1e9, target.name());
        Diagnostic::new(Code::LargeResult, text)
            .note(format!("{} variables, about {intervals:.0} rows", signals.len()))
            .help("choose variables with --variables, or a longer --output-interval")
    })
}

/// Writes a text to a file, or to stdout when the name is `-`.
pub(super) fn write_text(name: &str, text: &str) -> Result<(), CommandFailure> {
    if name == "-" { print(text) } else { super::files::write(Path::new(name), text.as_bytes()) }
}

/// Writes a CSV table of operating points, one point a row; `-` is stdout. The first column numbers the points from 0.
pub(super) fn write_points(
    path: &Path,
    signals: &[Signal],
    rows: impl Iterator<Item = Vec<f64>>,
) -> Result<(), CommandFailure> {
    let mut out = Vec::new();
    let io = |e: std::io::Error| access(path, "written", &e);
    let mut writer = CsvWriter::new(&mut out, signals).map_err(io)?;
    for (i, row) in rows.enumerate() {
        writer.row(i as f64, row).map_err(io)?;
    }
    writer.finish().map_err(io)?;
    // The CSV writer names its first column `time`; here it holds the number of the point.
    let text = String::from_utf8_lossy(&out).replacen("time", "point", 1);
    write_text(&path.display().to_string(), &text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_reach_the_file_when_all_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        let target = ResultTarget::new(path.to_str().unwrap()).unwrap();
        let mut recorder = ResultRecorder::new(target, vec![Signal::new("x")], CsvUnits::None, false).unwrap();
        assert!(recorder.row(0.0, &[1.0]));
        recorder.flush();
        assert!(recorder.row(0.5, &[2.0]));
        assert!(!path.exists());
        recorder.finish().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time,x\n0,1\n0.5,2\n");
    }

    #[test]
    fn a_mat_file_and_kept_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.mat");
        let mut recorder = ResultRecorder::new(
            ResultTarget::new(path.to_str().unwrap()).unwrap(),
            vec![Signal::new("x")],
            CsvUnits::None,
            true,
        )
        .unwrap();
        recorder.row(0.0, &[1.0]);
        recorder.row(1.0, &[2.0]);
        let rows = recorder.finish().unwrap();
        assert_eq!(bramah_results::mat::read(&std::fs::read(path).unwrap()).unwrap(), rows);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told() {
        let mut recorder =
            ResultRecorder::new(ResultTarget::new("/dev/full").unwrap(), vec![Signal::new("x")], CsvUnits::None, false)
                .unwrap();
        recorder.row(0.0, &[1.0]);
        let failure = recorder.finish().unwrap_err();
        assert!(failure.diagnostics[0].message.contains("the disk is full"), "{failure:?}");
    }

    #[test]
    fn large_results_are_announced() {
        let signals = vec![Signal::new("x"); 1000];
        let target = ResultTarget::stdout();
        assert!(announcement(&signals, 500.0, &target).is_none());
        assert!(announcement(&signals, 1e5, &target).unwrap().message.contains("GB"));
    }
}
