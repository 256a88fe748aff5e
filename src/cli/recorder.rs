//! Rows of a run on their way into files.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::CommandFailure;
use super::checkpoint::ResultPosition;
use super::files::{NewFile, access, ending, print};
use bramah_results::formats::{self, FORMATS, ResultFormat, ResultWriter};
use bramah_results::{CsvUnits, CsvWriter, Signal, Trajectory};
use bramah_syntax::diag::{Code, Diagnostic};

/// Rows wait in memory until they take this much, so that writing hardly disturbs the run; in Parquet a group of rows.
const BUFFER_BYTES: usize = 32 << 20;
/// Results larger than this are announced before the run.
const LARGE: u64 = 1_000_000_000;

/// Where a result goes.
#[derive(Clone)]
pub(super) struct ResultTarget {
    /// The file; `None` for stdout.
    path: Option<PathBuf>,
    format: &'static ResultFormat,
}

impl ResultTarget {
    /// CSV on stdout.
    pub fn stdout() -> Self {
        ResultTarget { path: None, format: &FORMATS[0] }
    }

    /// The format follows from the file's name.
    pub fn new(name: &str) -> Result<ResultTarget, CommandFailure> {
        let path = PathBuf::from(name);
        if name == "-" {
            return Ok(ResultTarget::stdout());
        }
        if path.extension().is_some_and(|e| ["html", "svg", "png"].iter().any(|p| e.eq_ignore_ascii_case(p))) {
            return Err(Diagnostic::new(Code::BadArgument, format!("`{name}` is no result file"))
                .help("a picture is written by `--plot`, or by `bramah plot` afterwards")
                .into());
        }
        let ending = ending(&path, "a result", &formats::endings())?;
        let format = formats::of_ending(ending).expect("one of the endings");
        Ok(ResultTarget { path: Some(path), format })
    }

    /// What the format of the file is like.
    pub fn format(&self) -> &'static ResultFormat {
        self.format
    }

    /// The name for messages.
    pub fn name(&self) -> String {
        self.path.as_ref().map_or_else(|| "stdout".to_owned(), |path| path.display().to_string())
    }
}

/// Takes the rows of a run.
pub(super) struct ResultRecorder {
    target: ResultTarget,
    /// Writes to the file or to stdout; gone after a failure.
    writer: Option<Box<dyn ResultWriter>>,
    file: Option<NewFile>,
    /// Rows for the writer, each with its time first, one after the other: with many columns a row at a time is
    /// several times faster than a column at a time.
    waiting: Vec<f64>,
    /// All rows, where they are wanted after the run.
    rows: Trajectory,
    keep: bool,
    failure: Option<CommandFailure>,
    count: usize,
    unread: bool,
    writing: Duration,
}

impl ResultRecorder {
    /// Opens the file at once, so that a run is not lost to a wrong name. `keep`: all rows are wanted after the run.
    pub fn new(
        target: ResultTarget,
        signals: Vec<Signal>,
        units: CsvUnits,
        keep: bool,
    ) -> Result<Self, CommandFailure> {
        let file = target.path.as_deref().map(NewFile::create).transpose()?;
        Ok(Self::on(target, file, (signals, units), keep, None))
    }

    /// Rows into a file that survives a run that is killed; behind those of a checkpoint, if there is one.
    pub fn lasting(
        target: ResultTarget,
        signals: Vec<Signal>,
        units: CsvUnits,
        written: Option<&ResultPosition>,
    ) -> Result<Self, CommandFailure> {
        let Some(path) = target.path.as_deref().filter(|_| target.format.grows) else {
            let text = format!("a run with checkpoints writes a CSV file, and the result is `{}`", target.name());
            return Err(Diagnostic::new(Code::BadArgument, text)
                .help("name one with `-o`; `bramah plot` draws it afterwards")
                .into());
        };
        let file = NewFile::lasting(path, written.map(|w| w.bytes))?;
        Ok(Self::on(target, Some(file), (signals, units), false, written))
    }

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

    /// Begins the file, or goes on behind the bytes that it has.
    fn open(&self, units: CsvUnits, written: Option<u64>) -> std::io::Result<Box<dyn ResultWriter>> {
        let out: Box<dyn Write + Send> = match &self.file {
            // rows of CSV come in large pieces already
            Some(file) if self.target.format.grows => Box::new(file.handle()?),
            Some(file) => Box::new(std::io::BufWriter::new(file.handle()?)),
            None => Box::new(std::io::BufWriter::new(std::io::stdout())),
        };
        match written {
            Some(bytes) => Ok(Box::new(CsvWriter::resume(out, &self.rows.signals, bytes))),
            None => (self.target.format.create)(out, &self.rows.signals, units),
        }
    }

    fn fail(&mut self, error: &std::io::Error) {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            self.unread = true;
        } else {
            self.failure = Some(access(&PathBuf::from(self.target.name()), "written", error));
        }
        self.writer = None;
    }

    /// Takes a row; false when it makes no sense to go on because nothing can be written any more.
    pub fn row(&mut self, time: f64, values: &[f64]) -> bool {
        self.count += 1;
        if self.keep {
            self.rows.push(time, values);
        }
        if self.writer.is_some() {
            self.waiting.push(time);
            self.waiting.extend_from_slice(values);
        }
        if 8 * self.waiting.len() > BUFFER_BYTES {
            self.flush();
        }
        self.failure.is_none() && !self.unread
    }

    /// True when the reader of stdout has gone away (`| head`): nothing is left to do, and nothing is wrong.
    pub fn is_unread(&self) -> bool {
        self.unread
    }

    /// How long writing has taken.
    pub fn writing(&self) -> Duration {
        self.writing
    }

    /// Writes what waits.
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

    /// Puts all rows on the disk and says how far they reach; `None` after a failure.
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
        if let Some(Err(failure)) = self.file.as_ref().map(NewFile::sync) {
            self.failure = Some(failure);
            return None;
        }
        Some(ResultPosition { file: self.target.name(), bytes, rows: self.count })
    }

    /// Notes why no checkpoint could be written.
    pub fn failed(&mut self, failure: CommandFailure) {
        self.failure = Some(failure);
    }

    /// Ends without giving the file its name: what it holds up to the last mark is for another run.
    pub fn suspend(mut self) -> Result<(), CommandFailure> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// How many rows have come.
    pub fn rows(&self) -> usize {
        self.count
    }

    /// Writes the rest and gives the file its name; hands out the rows where they were to be kept.
    pub fn finish(mut self) -> Result<Trajectory, CommandFailure> {
        self.flush();
        if let Some(writer) = self.writer.take()
            && let Err(error) = writer.finish()
        {
            self.fail(&error);
        }
        match (self.failure.take(), self.file.take()) {
            (None, Some(file)) => file.finish()?,
            (Some(failure), file) => return Err(kept(failure, file)),
            (None, None) => {}
        }
        Ok(std::mem::take(&mut self.rows))
    }
}

/// The part of a result that could be written is kept under another name.
fn kept(mut failure: CommandFailure, file: Option<NewFile>) -> CommandFailure {
    if let (Some(path), Some(first)) = (file.and_then(NewFile::keep_part), failure.diagnostics.first_mut()) {
        first.notes.push(format!("what could be written is in `{}`", path.display()));
    }
    failure
}

/// A note about a result that will be large.
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

/// Writes a text to a file, or to stdout for `-`.
pub(super) fn write_text(name: &str, text: &str) -> Result<(), CommandFailure> {
    if name == "-" { print(text) } else { super::files::write(Path::new(name), text.as_bytes()) }
}

/// Writes a table of operating points, a row each, numbered in the first column; `-` is stdout.
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
