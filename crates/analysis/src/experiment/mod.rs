//! Experiment files: what to run, as TOML. Every key is a flag of `bramah simulate` without its dashes.
//!
//! ```toml
//! file = "Press.mo"
//! model = "Press"
//! stop-time = "2 s"
//! variables = ["cyl.*", "pump.b.p"]
//! output-file = "press.csv"
//!
//! [set]
//! pump.D = "0.8 ml"
//!
//! [map]
//! F = "tau_N[N]"
//! ```

mod input;
mod sweep;
mod table;

pub use input::{InputHold, InputMap};
pub use sweep::{ParameterSweep, ParameterVariation, SamplingMethod};
pub use table::parse;

use bramah_results::CsvUnits;

/// What to run. `None` and empty lists stand for what the file or the command line does not state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExperimentSpecification {
    /// A file, a folder that is a package, or the dotted name of a class that ships with bramah.
    pub file: Option<String>,
    /// The dotted name of the class to run.
    pub model: Option<String>,
    /// Values of parameters: dotted name, and the value as written, with or without unit.
    pub set: Vec<(String, String)>,
    /// Start time in seconds.
    pub start_time: Option<f64>,
    /// Stop time in seconds.
    pub stop_time: Option<f64>,
    /// Seconds between output rows.
    pub output_interval: Option<f64>,
    /// Largest number of rows written at events: 0 for none, `u64::MAX` for all.
    pub event_rows: Option<u64>,
    /// Where a CSV file states the units of its columns.
    pub csv_units: Option<CsvUnits>,
    /// Relative tolerance of the integration.
    pub relative_tolerance: Option<f64>,
    /// Patterns of variables to write.
    pub variables: Vec<String>,
    /// The file of the result.
    pub output_file: Option<String>,
    /// The file of a picture of the result.
    pub plot: Option<String>,
    /// The recording that drives the inputs.
    pub input: Option<String>,
    /// The recording's time column.
    pub time_column: Option<String>,
    /// Which column drives which input, and how.
    pub map: Vec<InputMap>,
    /// Interpolation of inputs whose entry in `map` does not state it.
    pub interpolation: Option<InputHold>,
    /// Folders with further packages.
    pub library: Vec<String>,
    /// C sources and shared libraries that external functions may call.
    pub external: Vec<String>,
    /// The file of the statistics of the run.
    pub statistics: Option<String>,
    /// Whether warnings are errors.
    pub deny_warnings: Option<bool>,
    /// What `bramah sweep` varies.
    pub sweep: Option<ParameterSweep>,
}

impl ExperimentSpecification {
    /// Merges two specifications: `self` where it states something, else `other`.
    ///
    /// Parameters and inputs are merged one by one.
    #[must_use]
    pub fn over(mut self, other: ExperimentSpecification) -> ExperimentSpecification {
        let own: Vec<String> = self.set.iter().map(|s| s.0.clone()).collect();
        let mut set: Vec<(String, String)> = other.set.into_iter().filter(|s| !own.contains(&s.0)).collect();
        set.append(&mut self.set);
        let mut map: Vec<InputMap> =
            other.map.into_iter().filter(|m| !self.map.iter().any(|own| own.input == m.input)).collect();
        map.append(&mut self.map);
        let or = |own: Vec<String>, other: Vec<String>| if own.is_empty() { other } else { own };
        ExperimentSpecification {
            file: self.file.or(other.file),
            model: self.model.or(other.model),
            set,
            start_time: self.start_time.or(other.start_time),
            stop_time: self.stop_time.or(other.stop_time),
            output_interval: self.output_interval.or(other.output_interval),
            event_rows: self.event_rows.or(other.event_rows),
            csv_units: self.csv_units.or(other.csv_units),
            relative_tolerance: self.relative_tolerance.or(other.relative_tolerance),
            variables: or(self.variables, other.variables),
            output_file: self.output_file.or(other.output_file),
            plot: self.plot.or(other.plot),
            input: self.input.or(other.input),
            time_column: self.time_column.or(other.time_column),
            map,
            interpolation: self.interpolation.or(other.interpolation),
            library: or(self.library, other.library),
            external: or(self.external, other.external),
            statistics: self.statistics.or(other.statistics),
            deny_warnings: self.deny_warnings.or(other.deny_warnings),
            sweep: self.sweep.or(other.sweep),
        }
    }
}

/// Parses a time: a number in seconds, or a number with a unit of time.
///
/// # Errors
/// A sentence that says what is expected.
pub fn seconds(text: &str) -> Result<f64, String> {
    let (value, unit) = bramah_expr::units::quantity(text).map_err(|e| e.to_string())?;
    let second = bramah_expr::units::MeasurementUnit::parse("s").map_err(|e| e.to_string())?;
    let time = match unit {
        None => Some(value),
        Some(unit) => unit.convert(value, &second),
    };
    time.filter(|t| t.is_finite()).ok_or_else(|| format!("`{text}` is no time; write `2`, `2 s` or `500 ms`"))
}

/// Parses a number of event rows: `all`, `none` or a number.
///
/// # Errors
/// A sentence that says what is expected.
pub fn event_rows(text: &str) -> Result<u64, String> {
    match text.trim() {
        "all" => Ok(u64::MAX),
        "none" => Ok(0),
        number => match number.parse::<f64>() {
            Ok(n) if n >= 0.0 && n.fract() == 0.0 => Ok(n as u64),
            _ => Err(format!("`{text}` is no number of rows; write `all`, `none` or a number such as `100000`")),
        },
    }
}

/// Parses a positive length of time in seconds, written as for [`seconds`].
///
/// # Errors
/// A sentence that says what is expected.
pub fn duration(text: &str) -> Result<f64, String> {
    match seconds(text)? {
        length if length > 0.0 => Ok(length),
        _ => Err(format!("`{text}` is no length of time; write a positive one, such as `1 ms`")),
    }
}

/// Parses a relative tolerance between 0 and 1.
///
/// # Errors
/// A sentence that says what is expected.
pub fn tolerance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(v) if v > 0.0 && v < 1.0 => Ok(v),
        _ => Err(format!("`{text}` is no relative tolerance; write a number between 0 and 1, such as 1e-6")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_tolerances() {
        assert_eq!(seconds("2"), Ok(2.0));
        assert_eq!(seconds("500 ms"), Ok(0.5));
        assert_eq!(seconds("2min"), Ok(120.0));
        assert!(seconds("2 m").unwrap_err().contains("no time"));
        assert!(seconds("soon").is_err());
        assert_eq!(duration("2 ms"), Ok(0.002));
        assert!(duration("0").unwrap_err().contains("positive"));
        assert!(duration("-1 s").is_err());
        assert_eq!(tolerance("1e-6"), Ok(1e-6));
        assert!(tolerance("0").is_err() && tolerance("2").is_err() && tolerance("nan").is_err());
    }

    #[test]
    fn the_command_line_goes_over_the_file() {
        let set = |v: &str| vec![("pump.D".to_owned(), v.to_owned())];
        let file = ExperimentSpecification {
            set: set("1"),
            stop_time: Some(1.0),
            model: Some("A".into()),
            ..ExperimentSpecification::default()
        };
        let line =
            ExperimentSpecification { set: set("2"), stop_time: Some(2.0), ..ExperimentSpecification::default() };
        let both = line.over(file);
        assert_eq!((both.set, both.stop_time, both.model.as_deref()), (set("2"), Some(2.0), Some("A")));
    }
}
