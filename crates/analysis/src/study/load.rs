//! Reads the recordings of a study, checks them and converts them to the units of the model.
//!
//! CSV files enter through a [`World`]; [`Recording`]s leave, whose columns are in the order of the study's inputs and
//! signals. `bramah_results` finds separators, headers and units of the files.

use super::bind::{BoundStudy, conversion};
use super::table::at;
use super::{InputColumn, RecordingFile, RecordingRole};
use bramah_results::{ReadStrictness, Trajectory, contradiction, number, read_csv};
use bramah_solve::Interpolation;
use bramah_syntax::diag::{Code, Diagnostic, Sources, Span, StageResult};
use bramah_syntax::world::World;
use std::path::Path;

/// One recording in the units of the model. All columns are as long as `times`.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The file as the study names it.
    pub file: String,
    /// Its role.
    pub role: RecordingRole,
    /// Times of the samples in seconds, ascending.
    pub times: Vec<f64>,
    /// One column for each entry of [`BoundStudy::inputs`], without NaN.
    pub inputs: Vec<Vec<f64>>,
    /// One column for each entry of [`BoundStudy::signals`], with the sign applied; NaN where nothing was measured.
    pub signals: Vec<Vec<f64>>,
    /// Number of pieces for multiple shooting; 1 where it is not cut.
    pub pieces: usize,
}

impl BoundStudy {
    /// Reads the recordings of one role. File names are relative to `data`, or without it to the folder of the study.
    ///
    /// Texts are added to `sources`. Optional recordings that do not exist are left out. The result carries warnings
    /// about signals that never change, and about inputs that are constant in all train recordings.
    ///
    /// # Errors
    /// [`Code::BadStudy`] for files that do not exist or hold too few samples in their window; [`Code::BadData`] for
    /// missing columns, times that do not grow, gaps, inputs with empty cells, columns without any number or in a unit
    /// that cannot be converted.
    pub fn load(
        &self,
        world: &dyn World,
        data: Option<&Path>,
        role: RecordingRole,
        sources: &mut Sources,
    ) -> StageResult<Vec<Recording>> {
        let mut loader = RecordingLoader { bound: self, role, sources, diagnostics: Vec::new() };
        let mut found = Vec::new();
        for file in self.recordings.iter().filter(|r| r.role == role) {
            // `join` keeps absolute paths as they are.
            let path = data.unwrap_or(&self.folder).join(&file.file);
            found.extend(loader.recording(world, file, &path));
        }
        if found.is_empty() && role == RecordingRole::Train && loader.diagnostics.is_empty() {
            let d = Diagnostic::new(Code::BadStudy, "there is no recording to fit to");
            loader.diagnostics.push(d.help("give at least one existing recording the role `train`"));
        }
        if role == RecordingRole::Train {
            loader.check_excitation(&found);
        }
        if loader.diagnostics.iter().any(Diagnostic::is_error) {
            StageResult::failed(loader.diagnostics)
        } else {
            StageResult::new(found, loader.diagnostics)
        }
    }

    /// Whether the study lists recordings of this role.
    pub fn has(&self, role: RecordingRole) -> bool {
        self.recordings.iter().any(|r| r.role == role)
    }

    /// Files of the study and their roles, in its order.
    pub fn files(&self) -> impl Iterator<Item = (&str, RecordingRole)> {
        self.recordings.iter().map(|r| (r.file.as_str(), r.role))
    }
}

/// For each signal the sensor's range, in the variable's unit.
///
/// It is the `full_scale` of the study, else peak to peak over `train`; for a constant signal its size, or 1 where that
/// is zero.
pub fn full_scales(bound: &BoundStudy, train: &[Recording]) -> Vec<f64> {
    let range = |k: usize| {
        let values = || train.iter().flat_map(|r| r.signals[k].iter().copied()).filter(|v| !v.is_nan());
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        match high - low {
            range if range > 0.0 => range,
            _ if high == 0.0 => 1.0,
            _ => high.abs(),
        }
    };
    bound.signals.iter().enumerate().map(|(k, s)| s.full_scale.unwrap_or_else(|| range(k))).collect()
}

/// Largest absolute value of a column, in SI units: sums of squares must not overflow.
const LARGEST: f64 = 1e100;

/// From this many jumps on an input counts as stepped.
const MANY_JUMPS: usize = 4;

/// Reads recordings of one role and collects messages about them.
struct RecordingLoader<'a> {
    bound: &'a BoundStudy,
    role: RecordingRole,
    sources: &'a mut Sources,
    diagnostics: Vec<Diagnostic>,
}

impl RecordingLoader<'_> {
    /// Reads one file; `None` with a message where it cannot be used, or without one where it is optional and missing.
    fn recording(&mut self, world: &dyn World, file: &RecordingFile, path: &Path) -> Option<Recording> {
        let text = match world.read(path) {
            Ok(text) => text,
            Err(_) if file.optional => return None,
            Err(why) => {
                let text = format!("the recording `{}` cannot be read: {why}", path.display());
                let help = "a path is relative to the folder of the study, or to the one given with `--data`";
                self.diagnostics.push(at(file.span, text, "named here").help(help));
                return None;
            }
        };
        let id = self.sources.add(path.display().to_string(), text);
        let head = Span { file: id, start: 0, end: 0 };
        let inputs: Vec<String> = self.bound.inputs.iter().map(|i| i.entry.column.clone()).collect();
        let outputs: Vec<String> = self.bound.signals.iter().map(|s| s.entry.column.clone()).collect();
        let strictness = ReadStrictness::Recording { inputs: &inputs, outputs: &outputs };
        let mut table = read_csv(self.sources, id, file.time.as_deref(), strictness).sink(&mut self.diagnostics)?;
        if let Some((from, to)) = file.window {
            table.keep(from..=to);
        }
        if table.len() < 2 {
            let text = format!("the recording `{}` has {} samples in its window", file.file, table.len());
            self.diagnostics.push(at(file.span, text, "too few to use"));
            return None;
        }
        // Each piece has to determine an initial state from its own samples.
        if table.len() < 2 * file.pieces {
            let text = format!("`{}` has {} samples for {} pieces", file.file, table.len(), file.pieces);
            self.diagnostics.push(at(file.span, text, "each piece needs two at least"));
            return None;
        }
        Some(self.converted(file, table, head))
    }

    /// Converts the columns of a table: first those of the inputs, then those of the signals.
    fn converted(&mut self, file: &RecordingFile, table: Trajectory, head: Span) -> Recording {
        let count = self.bound.inputs.len();
        let mut columns = table.columns.into_iter();
        let mut inputs = Vec::new();
        for (input, values) in self.bound.inputs.iter().zip(columns.by_ref()) {
            let said = &table.signals[inputs.len()].unit;
            // The unit in the study goes before the one in the file's head; `check_said` reports a contradiction.
            let unit = input.entry.unit.as_deref().unwrap_or(said);
            self.check_said(&input.entry.column, input.entry.unit.as_deref(), input.entry.span, head);
            let to = (input.unit.as_str(), input.difference);
            let values = self.in_unit(values, unit, to, 1.0, &input.entry.column, head);
            if input.interpolation == Interpolation::Linear {
                self.check_course(&values, &input.entry, head);
            }
            inputs.push(values);
        }
        let mut signals = Vec::new();
        for (signal, values) in self.bound.signals.iter().zip(columns) {
            let said = &table.signals[count + signals.len()].unit;
            let unit = signal.entry.unit.as_deref().unwrap_or(said);
            self.check_said(&signal.entry.column, signal.entry.unit.as_deref(), signal.entry.span, head);
            let to = (signal.unit.as_str(), signal.difference);
            let values = self.in_unit(values, unit, to, signal.entry.sign, &signal.entry.column, head);
            self.check_signal(&values, &signal.entry.column, head);
            signals.push(values);
        }
        Recording { file: file.file.clone(), role: self.role, times: table.times, inputs, signals, pieces: file.pieces }
    }

    /// Reports a unit of the study that contradicts the one in the file.
    fn check_said(&mut self, column: &str, said: Option<&str>, entry: Span, head: Span) {
        let Some(said) = said else { return };
        if let Some(d) = contradiction(self.sources, head.file, column, said) {
            let d = d.at(entry, format!("`unit = \"{said}\"` in the study"));
            self.diagnostics
                .push(d.help("leave `unit` out of the study where the file is right; else correct the file"));
        }
    }

    /// Converts a column and applies its sign. The values come back unchanged, with a message, where that fails.
    fn in_unit(
        &mut self,
        values: Vec<f64>,
        from: &str,
        (to, difference): (&str, bool),
        sign: f64,
        column: &str,
        head: Span,
    ) -> Vec<f64> {
        let converted: Vec<f64> = match conversion(from, to) {
            Ok(None) => values.iter().map(|v| sign * v).collect(),
            Ok(Some((own, wanted))) => {
                let (own, wanted) = (own.meant(difference), wanted.meant(difference));
                values.iter().map(|v| sign * own.convert(*v, &wanted).unwrap_or(f64::NAN)).collect()
            }
            Err(()) => {
                let text = format!("the column `{column}` is in `{from}`, which cannot be converted to `{to}`");
                self.diagnostics.push(Diagnostic::new(Code::BadData, text).at(head, "in this file"));
                return values;
            }
        };
        if let Some(i) = converted.iter().position(|v| v.abs() > LARGEST) {
            let text = format!("the column `{column}` holds {}, which nothing measures", number::text(values[i]));
            let d = Diagnostic::new(Code::BadData, text).at(head, "in this file");
            self.diagnostics.push(d.help("is it a mark for a missing value? Leave the cell empty, or write `NaN`"));
        }
        converted
    }

    /// Warns about an input that is interpolated linearly but consists of steps: its source probably holds it.
    fn check_course(&mut self, values: &[f64], entry: &InputColumn, head: Span) {
        let changes = (1..values.len()).filter(|&i| values[i] != values[i - 1]);
        let (mut jumps, mut ramps) = (0, 0);
        for i in changes {
            let stays = |a: usize, b: usize| values.get(a) == values.get(b);
            // A change between two equal pairs of samples is a step; a ramp changes several times in a row.
            let alone = (i < 2 || stays(i - 2, i - 1)) && (i + 1 == values.len() || stays(i, i + 1));
            if alone { jumps += 1 } else { ramps += 1 }
        }
        if jumps >= MANY_JUMPS && ramps <= jumps / 10 {
            let text = format!("`{}` jumps {jumps} times and is joined by straight lines", entry.name);
            let d = Diagnostic::new(Code::SteppingInput, text).at(entry.span, "`hold = false`");
            self.diagnostics.push(d.at(head, "in this file").help("a source that holds its output is `hold = true`"));
        }
    }

    /// Warns about an input that is constant in all recordings. In a single one it may be.
    fn check_excitation(&mut self, recordings: &[Recording]) {
        for (k, input) in self.bound.inputs.iter().enumerate() {
            let mut values = recordings.iter().flat_map(|r| r.inputs[k].iter().copied());
            let Some(first) = values.next() else { continue };
            if values.all(|v| v == first) {
                let (column, value) = (&input.entry.column, number::text(first));
                let text = format!("the input column `{column}` never changes: it is {value} in every recording");
                let d = Diagnostic::new(Code::StuckSignal, text).at(input.entry.span, "this input");
                self.diagnostics.push(d.help("nothing is learnt of what acts through it: is it the right column?"));
            }
        }
    }

    /// Reports a signal without any number, and warns about one that never changes.
    fn check_signal(&mut self, values: &[f64], column: &str, head: Span) {
        let mut known = values.iter().copied().filter(|v| !v.is_nan());
        let Some(first) = known.next() else {
            let d = Diagnostic::new(Code::BadData, format!("the column `{column}` holds no number"));
            self.diagnostics.push(d.at(head, "in this file"));
            return;
        };
        if known.all(|v| v == first) {
            let text = format!("the column `{column}` never changes: it is {} throughout", number::text(first));
            let d = Diagnostic::new(Code::StuckSignal, text).at(head, "in this file");
            self.diagnostics.push(d.help("is the sensor connected? Take the signal out of the study if not"));
        }
    }
}
