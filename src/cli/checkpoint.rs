//! Checkpoint files of `bramah simulate --checkpoint`: written during a run, read to continue it.
//!
//! A file has a head line, four marks that identify the run, the position in the result file, and the solver's
//! checkpoint. A run continues only when all marks agree, because another model or setting would give a result that
//! fits neither run.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::CommandFailure;
use super::files::{access, write};
use super::recorder::ResultTarget;
use bramah_solve::{Checkpoint, RecordedInput, Settings};
use bramah_syntax::diag::{Code, Diagnostic, Sources};

/// The first line of a file. The number grows when the format changes.
const HEAD: &str = "bramah checkpoint 1";
/// Checkpoints in a run when the user asks for no distance.
const PARTS: f64 = 20.0;

/// Identifies a run. All of it must agree with the checkpoint for the run to continue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RunFingerprint {
    /// A mark for each part (version, model, settings, inputs) with the part's name in messages.
    marks: [(&'static str, String); 4],
}

impl RunFingerprint {
    /// The fingerprint of a run.
    ///
    /// It covers the version of bramah, the texts of the model (values from `--set` and tables included), the settings
    /// with the recorded columns, and the recorded inputs.
    pub fn new(class: &str, sources: &Sources, settings: &Settings, inputs: &[RecordedInput]) -> Self {
        let mut model = FnvHash::default();
        model.text(class);
        sources.iter().for_each(|source| model.text(&source.text));
        let mut recorded = FnvHash::default();
        for input in inputs {
            recorded.text(&format!("{} {:?}", input.variable.0, input.interpolation));
            // The bits of the numbers, since printed numbers would be slower and need care with rounding.
            input.times.iter().chain(input.values.iter()).for_each(|x| recorded.bytes(&x.to_bits().to_le_bytes()));
        }
        let mut asked = FnvHash::default();
        // The debug text covers every field, so a new setting cannot be forgotten.
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

/// 64-bit FNV-1a, a hash that is the same on every machine and in every version, unlike the standard library's.
#[derive(Clone, Copy)]
struct FnvHash {
    /// The hash of the bytes so far.
    state: u64,
}

impl Default for FnvHash {
    fn default() -> Self {
        // The offset basis that FNV-1a prescribes.
        FnvHash { state: 0xcbf2_9ce4_8422_2325 }
    }
}

impl FnvHash {
    /// Adds bytes.
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // The prime that FNV-1a prescribes for 64 bits.
            self.state = (self.state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Adds a text and a zero byte, so that `ab`, `c` differs from `a`, `bc`.
    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
        self.bytes(&[0]);
    }
}

/// How far the result file was written at a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ResultPosition {
    /// The name of the result file.
    pub file: String,
    /// Valid bytes of its `.part` file.
    pub bytes: u64,
    /// Rows in these bytes.
    pub rows: usize,
}

/// The checkpoint file of a run. It holds only the latest checkpoint.
#[derive(Clone, Debug)]
pub(super) struct CheckpointFile {
    /// Path of the file.
    path: PathBuf,
    /// Fingerprint of the present run.
    marks: RunFingerprint,
}

/// The distance of checkpoints in seconds of simulated time when the user asks for none: a twentieth of the run.
pub(super) fn usual_distance(settings: &Settings) -> f64 {
    (settings.stop_time - settings.start_time) / PARTS
}

impl CheckpointFile {
    /// The checkpoint file at `path` for a run with this fingerprint. Nothing is read or written yet.
    pub fn new(path: &str, marks: RunFingerprint) -> Self {
        CheckpointFile { path: PathBuf::from(path), marks }
    }

    /// The file name for messages.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Replaces the file with a new checkpoint. The old one stays when this fails.
    pub fn save(&self, at: &Checkpoint, written: &ResultPosition) -> Result<(), CommandFailure> {
        let mut text = format!("{HEAD}\n");
        for (_, mark) in &self.marks.marks {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{mark}");
        }
        let _ = writeln!(text, "{} {} {}", written.bytes, written.rows, written.file);
        text += &at.text();
        write(&self.path, text.as_bytes())
    }

    /// Reads the checkpoint. `None`: there is no file, and the run begins at its start.
    ///
    /// `Err`: the file is damaged, or belongs to another run or result file.
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
            // The solver counts lines in its own part, which begins after six lines.
            .map_err(|line| self.unusable(&format!("its line {} cannot be read", line + 6)))?;
        Ok(Some((at, written)))
    }

    /// Removes the file when the run is over. A missing file is no error.
    pub fn remove(&self) -> Result<(), CommandFailure> {
        match std::fs::remove_file(&self.path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(access(&self.path, "removed", &e)),
            _ => Ok(()),
        }
    }

    /// The failure for a checkpoint that cannot be used, with advice.
    fn unusable(&self, why: &str) -> CommandFailure {
        Diagnostic::new(Code::BadCheckpoint, format!("cannot go on from `{}`: {why}", self.path.display()))
            .help(
                "repeat the command that began the run, with the files as they were; or remove the file to begin anew",
            )
            .into()
    }
}

/// Splits the four marks from the rest of the text. `None`: another head line, or too few lines.
fn read_marks(text: &str) -> Option<([&str; 4], &str)> {
    let mut rest = text.strip_prefix(HEAD)?.strip_prefix('\n')?;
    let mut marks = [""; 4];
    for mark in &mut marks {
        (*mark, rest) = rest.split_once('\n')?;
    }
    Some((marks, rest))
}

/// Reads the line with the position in the result file; returns the rest too. `None`: the line is damaged.
fn read_written(text: &str) -> Option<(ResultPosition, &str)> {
    let (line, rest) = text.split_once('\n')?;
    // Three parts at most: the file name comes last because it may contain spaces.
    let mut words = line.splitn(3, ' ');
    let (bytes, rows) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    Some((ResultPosition { bytes, rows, file: words.next()?.to_owned() }, rest))
}
