//! Results and recordings read from files, whatever their format.

use std::path::Path;

use super::Failure;
use super::files::access;
use super::messages::Messages;
use bramah_expr::units::Unit;
use bramah_results::{Strictness, Trajectory, mat, parquet, read_csv};
use bramah_syntax::diag::{Code, Diagnostic, FileId};

/// Reads a data file as text; letters of old encodings in remarks and units do no harm.
pub(super) fn text(path: &Path, messages: &mut Messages) -> Result<FileId, Failure> {
    let bytes = std::fs::read(path).map_err(|e| access(path, "read", &e))?;
    let text = String::from_utf8(bytes).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned());
    Ok(messages.sources.add(path.display().to_string(), text))
}

/// Reads a result or a recording with all its signals: CSV, Modelica `.mat`, or Parquet.
pub(super) fn result(path: &Path, time_column: Option<&str>, messages: &mut Messages) -> Result<Trajectory, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if extension == "mat" {
        let bytes = std::fs::read(path).map_err(|e| access(path, "read", &e))?;
        let unusable = |e| Diagnostic::new(Code::BadData, format!("`{}` cannot be used: {e}", path.display()));
        return mat::read(&bytes).map_err(|e| unusable(e).into());
    }
    if extension == "parquet" {
        let file = std::fs::File::open(path).map_err(|e| access(path, "read", &e))?;
        let unusable = |e| Diagnostic::new(Code::BadData, format!("`{}` cannot be used: {e}", path.display()));
        return parquet::read(file, time_column).map_err(|e| unusable(e).into());
    }
    let file = text(path, messages)?;
    let checked = read_csv(&messages.sources, file, time_column, Strictness::Result);
    checked.value.ok_or(Failure { diagnostics: checked.diagnostics })
}

/// `--unit 'p_*=Pa:bar'`: units for signals of files that carry none.
pub(super) fn apply_units(trajectory: &mut Trajectory, assignments: &[String]) -> Result<(), Failure> {
    for assignment in assignments {
        let wrong = |why: String| Failure::new(Code::BadArgument, format!("`--unit {assignment}`: {why}"));
        let (pattern, units) =
            assignment.rsplit_once('=').ok_or_else(|| wrong("NAME=UNIT or NAME=UNIT:SHOWN is expected".to_owned()))?;
        let (unit, shown) = units.split_once(':').unwrap_or((units, ""));
        let parse = |text: &str| Unit::parse(text).map_err(|e| wrong(e.to_string()));
        let (from, to) = (parse(unit)?, parse(shown)?);
        if !shown.trim().is_empty() && from.convert(0.0, &to).is_none() {
            return Err(wrong(format!("`{unit}` cannot be shown in `{shown}`")));
        }
        let globs = bramah_results::Globs::new(&[pattern]);
        for signal in trajectory.signals.iter_mut().filter(|s| globs.matches(&s.name)) {
            signal.unit = unit.trim().to_owned();
            signal.display_unit = shown.trim().to_owned();
        }
    }
    Ok(())
}
