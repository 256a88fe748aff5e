//! Reads results and recordings from files of any supported format.
//!
//! Paths enter; texts or trajectories leave. Used by `plot`, `compare` and the inputs of `simulate`.

use std::path::Path;

use super::CommandFailure;
use super::files::access;
use super::messages::MessageReporter;
use bramah_expr::units::MeasurementUnit;
use bramah_results::Trajectory;
use bramah_results::formats::{self, FORMATS, ResultFile};
use bramah_syntax::diag::{Code, FileId};

/// Adds a data file to the sources as text. Bytes that are not UTF-8 are replaced, since remarks and units of old
/// programs often contain them.
///
/// `Err`: the file cannot be read.
pub(super) fn text(path: &Path, messages: &mut MessageReporter) -> Result<FileId, CommandFailure> {
    let bytes = std::fs::read(path).map_err(|e| access(path, "read", &e))?;
    Ok(messages.sources.add_bytes(path.display().to_string(), bytes))
}

/// Reads a result or recording with all its signals. The ending names the format; without a known ending it is CSV.
///
/// `time_column` is used by CSV and Parquet; `None` for the usual one.
pub(super) fn result(
    path: &Path,
    time_column: Option<&str>,
    messages: &mut MessageReporter,
) -> Result<Trajectory, CommandFailure> {
    let bytes = std::fs::read(path).map_err(|e| access(path, "read", &e))?;
    let named = path.extension().and_then(|e| formats::of_ending(&e.to_string_lossy()));
    let name = path.display().to_string();
    let file = ResultFile { name: &name, bytes, time_column, sources: &mut messages.sources };
    let read = (named.unwrap_or(&FORMATS[0]).read)(file);
    read.value.ok_or(CommandFailure { diagnostics: read.diagnostics })
}

/// Applies assignments such as `p_*=Pa:bar`: the unit of the signals and, after the colon, the unit in which they are
/// shown.
///
/// `Err`: an assignment is not of this form, a unit is unknown, or the two units are of different kinds.
pub(super) fn apply_units(trajectory: &mut Trajectory, assignments: &[String]) -> Result<(), CommandFailure> {
    for assignment in assignments {
        let wrong = |why: String| CommandFailure::new(Code::BadArgument, format!("`--unit {assignment}`: {why}"));
        let (pattern, units) =
            // Split at the last `=`, because a pattern may contain one and a unit never does.
            assignment.rsplit_once('=').ok_or_else(|| wrong("NAME=UNIT or NAME=UNIT:SHOWN is expected".to_owned()))?;
        let (unit, shown) = units.split_once(':').unwrap_or((units, ""));
        let parse = |text: &str| MeasurementUnit::parse(text).map_err(|e| wrong(e.to_string()));
        let (from, to) = (parse(unit)?, parse(shown)?);
        if !shown.trim().is_empty() && from.convert(0.0, &to).is_none() {
            return Err(wrong(format!("`{unit}` cannot be shown in `{shown}`")));
        }
        let globs = bramah_results::GlobPatterns::new(&[pattern]);
        for signal in trajectory.signals.iter_mut().filter(|s| globs.matches(&s.name)) {
            signal.unit = unit.trim().to_owned();
            signal.display_unit = shown.trim().to_owned();
        }
    }
    Ok(())
}
