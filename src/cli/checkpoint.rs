//! `--checkpoint`: points of a run on disk, and going on from them.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::CommandFailure;
use super::files::{access, write};
use super::recorder::ResultTarget;
use bramah_solve::{Checkpoint, RecordedInput, Settings};
use bramah_syntax::diag::{Code, Diagnostic, Sources};

/// The first line of a file; the number grows when its form changes.
const HEAD: &str = "bramah checkpoint 1";
/// Parts of a run between checkpoints where nothing is said.
const PARTS: f64 = 20.0;

/// What must be the same for a run to go on, each as a number that changes with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RunFingerprint {
    /// By what they are called in messages.
    marks: [(&'static str, String); 4],
}

impl RunFingerprint {
    /// Of a run: the texts that the model was made of, values given from outside and tables included; the settings and
    /// the columns; the recorded inputs.
    pub fn new(class: &str, sources: &Sources, settings: &Settings, inputs: &[RecordedInput]) -> Self {
        let mut model = FnvHash::default();
        model.text(class);
        sources.iter().for_each(|source| model.text(&source.text));
        let mut recorded = FnvHash::default();
        for input in inputs {
            recorded.text(&format!("{} {:?}", input.variable.0, input.interpolation));
            input.times.iter().chain(input.values.iter()).for_each(|x| recorded.bytes(&x.to_bits().to_le_bytes()));
        }
        let mut asked = FnvHash::default();
        asked.text(&format!("{settings:?}"));
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let marks = [model, asked, recorded].map(|hash| format!("{:016x}", hash.state));
        let [model, asked, recorded] = marks;
        RunFingerprint {
            marks: [
                ("version of bramah", version),
                ("model or one of its values", model),
                ("settings (times, interval, tolerance, variables, distance of checkpoints)", asked),
                ("recorded input", recorded),
            ],
        }
    }
}

/// Fowler, Noll and Vo's hash (FNV-1a) of 64 bits: the same in every version and on every machine.
#[derive(Clone, Copy)]
struct FnvHash {
    state: u64,
}

impl Default for FnvHash {
    fn default() -> Self {
        FnvHash { state: 0xcbf2_9ce4_8422_2325 }
    }
}

impl FnvHash {
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.state = (self.state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// A text and its end.
    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
        self.bytes(&[0]);
    }
}

/// How far the result had come at a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ResultPosition {
    /// The result's name.
    pub file: String,
    /// Bytes in its part.
    pub bytes: u64,
    /// Rows.
    pub rows: usize,
}

/// A file of checkpoints: always the last one.
#[derive(Clone, Debug)]
pub(super) struct CheckpointFile {
    path: PathBuf,
    marks: RunFingerprint,
}

/// The distance of checkpoints when none is said.
pub(super) fn usual_distance(settings: &Settings) -> f64 {
    (settings.stop_time - settings.start_time) / PARTS
}

impl CheckpointFile {
    /// For a run with these marks.
    pub fn new(path: &str, marks: RunFingerprint) -> Self {
        CheckpointFile { path: PathBuf::from(path), marks }
    }

    /// The file's name.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Writes a checkpoint in place of the last one.
    pub fn save(&self, at: &Checkpoint, written: &ResultPosition) -> Result<(), CommandFailure> {
        let mut text = format!("{HEAD}\n");
        for (_, mark) in &self.marks.marks {
            // writing to a string cannot fail
            let _ = writeln!(text, "{mark}");
        }
        let _ = writeln!(text, "{} {} {}", written.bytes, written.rows, written.file);
        text += &at.text();
        write(&self.path, text.as_bytes())
    }

    /// The checkpoint to go on from; `None` when there is no file.
    pub fn load(&self, target: &ResultTarget) -> Result<Option<(Checkpoint, ResultPosition)>, CommandFailure> {
        let text = match std::fs::read_to_string(&self.path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(access(&self.path, "read", &e)),
        };
        let (marks, rest) = read_marks(&text).ok_or_else(|| self.unusable("it is no file of checkpoints"))?;
        for ((what, mine), its) in self.marks.marks.iter().zip(marks) {
            if mine != its {
                return Err(self.unusable(&format!("it belongs to another run: another {what}")));
            }
        }
        let (written, rest) = read_written(rest).ok_or_else(|| self.unusable("its line 6 cannot be read"))?;
        if written.file != target.name() {
            return Err(self.unusable(&format!("the result of its run is `{}`", written.file)));
        }
        let at = Checkpoint::from_text(rest)
            .map_err(|line| self.unusable(&format!("its line {} cannot be read", line + 6)))?;
        Ok(Some((at, written)))
    }

    /// The run is over.
    pub fn remove(&self) -> Result<(), CommandFailure> {
        match std::fs::remove_file(&self.path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(access(&self.path, "removed", &e)),
            _ => Ok(()),
        }
    }

    fn unusable(&self, why: &str) -> CommandFailure {
        Diagnostic::new(Code::BadCheckpoint, format!("cannot go on from `{}`: {why}", self.path.display()))
            .help(
                "repeat the command that began the run, with the files as they were; or remove the file to begin anew",
            )
            .into()
    }
}

fn read_marks(text: &str) -> Option<([&str; 4], &str)> {
    let mut rest = text.strip_prefix(HEAD)?.strip_prefix('\n')?;
    let mut marks = [""; 4];
    for mark in &mut marks {
        (*mark, rest) = rest.split_once('\n')?;
    }
    Some((marks, rest))
}

fn read_written(text: &str) -> Option<(ResultPosition, &str)> {
    let (line, rest) = text.split_once('\n')?;
    let mut words = line.splitn(3, ' ');
    let (bytes, rows) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    Some((ResultPosition { bytes, rows, file: words.next()?.to_owned() }, rest))
}
