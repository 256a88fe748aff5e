//! Turns a recording into the inputs of a model for `bramah simulate`.
//!
//! The experiment (`--input`, `--map`, `--interpolation`) and the sorted model enter. One time series for each driven
//! input leaves, in the unit of the model.
//!
//! Every input of the model must be driven by a column or have a constant value. Everything that does not fit is an
//! error before the run starts.

use std::path::Path;
use std::sync::Arc;

use super::messages::MessageReporter;
use super::{CommandFailure, data};
use bramah_analysis::experiment::{ExperimentSpecification, InputHold, InputMap};
use bramah_expr::VarId;
use bramah_expr::units::MeasurementUnit;
use bramah_model::flat::{FlatVariable, ScalarType};
use bramah_model::structure::Dae;
use bramah_results::{ReadStrictness, Trajectory, contradiction, number, read_csv};
use bramah_solve::{Interpolation, RecordedInput, missing_inputs};
use bramah_syntax::diag::{Code, Diagnostic, nearest};

/// The recorded inputs of a run, and the time span of their recording.
#[derive(Debug, Default)]
pub(super) struct InputRecording {
    /// One entry for each input that the recording drives.
    pub inputs: Vec<RecordedInput>,
    /// The time span of the recording. `None`: there is no recording, or it is empty.
    pub covered: Option<RecordingSpan>,
}

/// First time, last time and step of a recording, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordingSpan {
    /// Time of the first row.
    pub start: f64,
    /// Time of the last row.
    pub stop: f64,
    /// Mean time between rows.
    pub step: f64,
}

/// Reads the recording that an experiment names and ties its columns to inputs.
///
/// Without a recording the result is empty. `Err`: a mapped input or column does not exist, a unit does not fit, the
/// file cannot be read, or an input has no value.
pub(super) fn prepare(
    experiment: &ExperimentSpecification,
    dae: &Dae,
    messages: &mut MessageReporter,
) -> Result<InputRecording, CommandFailure> {
    // A wrong input name is reported first; it needs only the model, not the file.
    for entry in &experiment.map {
        if input(dae, &entry.input).is_none() {
            return Err(no_input(dae, &entry.input).into());
        }
    }
    let Some(file) = &experiment.input else {
        if let Some(entry) = experiment.map.first() {
            let text = format!("the input `{}` is mapped to a column, but there is no recording", entry.input);
            return Err(Diagnostic::new(Code::BadMap, text).help("name it: --input bench.csv").into());
        }
        return all_driven(dae, &[]).map(|()| InputRecording::default());
    };
    let path = Path::new(file);
    let id = data::text(path, messages)?;
    // Inputs may be driven by columns of equal name, so the names of the columns are needed before the columns are
    // read.
    let entries = entries(experiment, dae, messages.sources.get(id).text.as_str());
    let columns: Vec<String> = entries.iter().map(|e| e.column.clone()).collect();
    let strictness = ReadStrictness::Inputs(&columns);
    let checked = read_csv(&messages.sources, id, experiment.time_column.as_deref(), strictness);
    let recording = messages.value(checked)?;
    let times: Arc<[f64]> = recording.times.as_slice().into();
    let mut inputs = Vec::new();
    // The reader returns the columns in the order of the entries, so `k` is also the index of the column.
    for (k, entry) in entries.iter().enumerate() {
        let Some(variable) = input(dae, &entry.input) else { continue };
        inputs.push(track(entry, variable, dae, &recording, k, &times, experiment.interpolation)?);
    }
    all_driven(dae, &inputs)?;
    if let Some(note) = held_without_asking(experiment, &entries, dae, &inputs) {
        messages.say(&[note]);
    }
    // A unit in `--map` against a different one in the file is an error: one of them is wrong, and a guess would scale
    // the input.
    for entry in &experiment.map {
        let Some(unit) = entry.unit.as_deref() else { continue };
        if let Some(d) = contradiction(&messages.sources, id, &entry.column, unit) {
            let said = format!("`{}` is mapped to `{}[{unit}]`", entry.input, entry.column);
            let help = format!("leave `[{unit}]` out of the map where the file is right; else correct the file");
            return Err(d.note(said).help(help).into());
        }
    }
    Ok(InputRecording { inputs, covered: covered(&recording) })
}

/// The input of the model with this name.
fn input(dae: &Dae, name: &str) -> Option<VarId> {
    dae.inputs.iter().copied().find(|v| dae.variables[v.index()].name == name)
}

/// The entries of `--map`, followed by one entry for each other input that has a column of equal name.
///
/// `text` is the text of the recording.
fn entries(experiment: &ExperimentSpecification, dae: &Dae, text: &str) -> Vec<InputMap> {
    let mut entries = experiment.map.clone();
    let columns = bramah_results::recording::column_names(text);
    for v in &dae.inputs {
        let name = &dae.variables[v.index()].name;
        if columns.contains(name) && !entries.iter().any(|e| &e.input == name) {
            entries.push(InputMap { input: name.clone(), column: name.clone(), unit: None, hold: None });
        }
    }
    entries
}

/// The time series of one input: its column, converted to the unit of the input.
///
/// `column` is the index in the recording, `usual` the interpolation where the entry has none. `Err`: the units do not
/// fit, or a discrete input gets fractions.
fn track(
    entry: &InputMap,
    variable: VarId,
    dae: &Dae,
    recording: &Trajectory,
    column: usize,
    times: &Arc<[f64]>,
    usual: Option<InputHold>,
) -> Result<RecordedInput, CommandFailure> {
    let target = &dae.variables[variable.index()];
    let unit = entry.unit.as_deref().unwrap_or(&recording.signals[column].unit);
    let mut values = recording.columns[column].clone();
    convert(&mut values, unit, target, entry)?;
    // Integer, Boolean and enumeration inputs take whole numbers only.
    if target.ty != ScalarType::Real
        && let Some(value) = values.iter().find(|v| v.fract() != 0.0)
    {
        let text = format!("`{}` takes whole numbers, the column `{}` holds {value}", target.name, entry.column);
        return Err(CommandFailure::new(Code::BadMap, text));
    }
    let values: Arc<[f64]> = values.into();
    // Discrete inputs always hold: values between two samples would be invalid.
    let linear = target.ty == ScalarType::Real && entry.hold.or(usual) == Some(InputHold::Linear);
    let interpolation = if linear { Interpolation::Linear } else { Interpolation::Held };
    Ok(RecordedInput { variable, times: times.clone(), values, interpolation })
}

/// A note when inputs hold their samples although they rise or fall over several rows, and the user has not chosen an
/// interpolation.
///
/// Such a signal was probably sampled from a continuous one. A command that only steps up and down gets no note.
/// `None`: there is no such input.
fn held_without_asking(
    experiment: &ExperimentSpecification,
    entries: &[InputMap],
    dae: &Dae,
    inputs: &[RecordedInput],
) -> Option<Diagnostic> {
    let asked = |v: VarId| {
        let name = &dae.variables[v.index()].name;
        experiment.interpolation.is_some() || entries.iter().any(|e| &e.input == name && e.hold.is_some())
    };
    // Two steps in a row with the same sign.
    let rises = |i: &RecordedInput| i.values.windows(3).any(|v| (v[1] - v[0]) * (v[2] - v[1]) > 0.0);
    let real = |i: &RecordedInput| dae.variables[i.variable.index()].ty == ScalarType::Real;
    let held = inputs.iter().filter(|i| real(i) && !asked(i.variable) && rises(i));
    let names: Vec<String> = held.map(|i| format!("`{}`", dae.variables[i.variable.index()].name)).collect();
    let (first, rest) = names.split_first()?;
    let others = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
    let text = format!("{first}{others} hold{} each sample until the next one", if rest.is_empty() { "s" } else { "" });
    let help = "`--interpolation linear` joins samples by straight lines, `--interpolation held` says that they hold";
    Some(Diagnostic::new(Code::InputsHeld, text).help(help))
}

/// Converts values from the unit of the column to the unit of the input.
///
/// Nothing happens when one of the units is not known. `Err`: the unit is invalid or of another kind.
fn convert(values: &mut [f64], unit: &str, target: &FlatVariable, entry: &InputMap) -> Result<(), CommandFailure> {
    let Some(wanted) = target.unit.as_deref().filter(|u| !u.is_empty() && !unit.is_empty() && *u != unit) else {
        return Ok(());
    };
    let wrong = |why: String| {
        CommandFailure::from(
            Diagnostic::new(Code::BadMap, why)
                .help(format!("say it: --map '{}={}[{wanted}]'", entry.input, entry.column)),
        )
    };
    let from = MeasurementUnit::parse(unit).map_err(|e| wrong(format!("column `{}`: {e}", entry.column)))?;
    let Ok(to) = MeasurementUnit::parse(wanted) else { return Ok(()) };
    if from.convert(0.0, &to).is_none() {
        let text = format!("the column `{}` is in `{unit}`, the input `{}` in `{wanted}`", entry.column, target.name);
        return Err(wrong(text));
    }
    // A temperature difference is converted without the offset between degC and K.
    let (from, to) = (from.meant(target.difference), to.meant(target.difference));
    values.iter_mut().for_each(|v| *v = from.convert(*v, &to).unwrap_or(*v));
    Ok(())
}

/// Checks that each input is driven or has a constant value. `Err` lists the others with advice.
fn all_driven(dae: &Dae, inputs: &[RecordedInput]) -> Result<(), CommandFailure> {
    let help = |name: &str| {
        vec![
            format!("drive it by a recording: --input bench.csv --map '{name}=COLUMN'"),
            format!("or give it a constant value: --set {name}=0"),
        ]
    };
    let diagnostics = missing_inputs(dae, inputs, help);
    if diagnostics.is_empty() { Ok(()) } else { Err(CommandFailure { diagnostics }) }
}

/// The diagnostic for a mapped input that the model does not have.
///
/// It suggests the nearest name or lists up to ten inputs.
fn no_input(dae: &Dae, name: &str) -> Diagnostic {
    let names: Vec<&str> = dae.inputs.iter().map(|v| dae.variables[v.index()].name.as_str()).collect();
    let diagnostic = Diagnostic::new(Code::BadMap, format!("the model has no input `{name}`"));
    let list = names.iter().take(10).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    match nearest(name, names.iter().copied()) {
        Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
        None if names.is_empty() => diagnostic.note("it has no inputs at all: `input Real u;` at the top makes one"),
        None => diagnostic.note(format!("its inputs are {list}")),
    }
}

/// The time span of a recording; `None` when it has no rows.
fn covered(recording: &Trajectory) -> Option<RecordingSpan> {
    let (start, stop) = (*recording.times.first()?, *recording.times.last()?);
    let intervals = recording.len().saturating_sub(1).max(1);
    Some(RecordingSpan { start, stop, step: (stop - start) / intervals as f64 })
}

/// Checks that a run from `start` to `stop` (seconds) lies in its recording. `Err` names both spans.
///
/// About one step beyond the ends is allowed, since the last sample stands for the time until the next one would come.
pub(super) fn check_cover(covered: RecordingSpan, start: f64, stop: f64) -> Result<(), CommandFailure> {
    // A hundredth of a step more, against rounding of the mean step.
    let slack = 1.01 * covered.step + 1e-9 * (covered.stop - covered.start).abs();
    if start >= covered.start - slack && stop <= covered.stop + slack {
        return Ok(());
    }
    let shown = |t| number::rounded(t, 9);
    let text = format!(
        "the run from {} s to {} s goes beyond its recording, which holds {} s to {} s",
        shown(start),
        shown(stop),
        shown(covered.start),
        shown(covered.stop)
    );
    let help = format!("--start-time {} --stop-time {}", shown(covered.start), shown(covered.stop));
    Err(Diagnostic::new(Code::BadData, text).help(help).into())
}
