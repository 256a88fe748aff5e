//! The section `[sweep]` of an experiment file: which parameters vary how, and what is kept of each run.
//!
//! ```toml
//! [sweep]
//! method = "grid"                       # list, latin-hypercube, sobol, monte-carlo
//! count = 100                           # for the last three
//! seed = 1
//!
//! [sweep.parameters]
//! "relief.p_set" = "150:200:6 bar"      # grid, list: values, or FROM:TO:COUNT
//! "pump.D" = { min = "1 ml", max = "2 ml" }
//! "cyl.m" = { sigma = "3 %" }           # monte-carlo: around the model's value
//!
//! [sweep.results]
//! peak = "max(cyl.v)"
//! ```

use toml::de::DeValue;

use super::table::{ExperimentReader, ExperimentValue, scalar};

/// How the parameter values of the runs are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplingMethod {
    /// All combinations of values.
    #[default]
    Grid,
    /// The first values of all parameters, then the second ones, and so on.
    List,
    /// Latin hypercube: one sample in each of as many equal intervals as there are samples, for each parameter.
    LatinHypercube,
    /// A Sobol' sequence in the design for sensitivity indices.
    Sobol,
    /// Independent random numbers.
    MonteCarlo,
}

/// Names of the methods in the file.
const METHODS: &[(&str, SamplingMethod)] = &[
    ("grid", SamplingMethod::Grid),
    ("list", SamplingMethod::List),
    ("latin-hypercube", SamplingMethod::LatinHypercube),
    ("sobol", SamplingMethod::Sobol),
    ("monte-carlo", SamplingMethod::MonteCarlo),
];

/// How a parameter varies. Values stay as written, in the parameter's unit or with a unit.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterVariation {
    /// `1,2,5` or `FROM:TO:COUNT`, with one unit for all at the end.
    Values(String),
    /// Uniform between two values.
    Range {
        /// The smallest value.
        min: String,
        /// The largest value.
        max: String,
        /// Whether it is uniform in the logarithm.
        logarithmic: bool,
    },
    /// Normal around the model's value; log-normal where the value is positive and the deviation relative.
    Sigma(String),
}

/// The section `[sweep]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterSweep {
    /// How samples are chosen.
    pub method: SamplingMethod,
    /// Number of samples of the random methods, and of base points for Sobol' indices.
    pub count: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Names of parameters and how they vary.
    pub parameters: Vec<(String, ParameterVariation)>,
    /// Names of results and their expressions.
    pub results: Vec<(String, String)>,
}

/// Keys of `[sweep]`.
const KEYS: &[&str] = &["method", "count", "seed", "parameters", "results"];
/// Keys of a parameter's table.
const SPREAD_KEYS: &[&str] = &["min", "max", "log", "sigma"];

/// Reads the section; `None` where it is no table.
pub(super) fn sweep(reader: &mut ExperimentReader, value: &ExperimentValue<'_>) -> Option<ParameterSweep> {
    let DeValue::Table(table) = value.get_ref() else {
        reader.wrong_kind("sweep", value, "a table");
        return None;
    };
    let mut sweep = ParameterSweep { count: 100, seed: 1, ..ParameterSweep::default() };
    for (key, value) in table {
        match key.get_ref().as_ref() {
            "method" => sweep.method = method(reader, value),
            "count" => sweep.count = whole(reader, "count", value) as usize,
            "seed" => sweep.seed = whole(reader, "seed", value),
            "parameters" => parameters(reader, "", value, &mut sweep.parameters),
            "results" => results(reader, value, &mut sweep.results),
            other => reader.unknown(other, &key.span(), KEYS),
        }
    }
    if sweep.parameters.is_empty() {
        reader.report(&value.span(), "the sweep varies no parameter", "add them below `[sweep.parameters]`");
    }
    Some(sweep)
}

/// The key `method`.
fn method(reader: &mut ExperimentReader, value: &ExperimentValue<'_>) -> SamplingMethod {
    let text = value.get_ref().as_str().unwrap_or("");
    match METHODS.iter().find(|m| m.0 == text) {
        Some(m) => m.1,
        None => {
            let known: Vec<String> = METHODS.iter().map(|m| format!("`{}`", m.0)).collect();
            reader.report(&value.span(), format!("`method` is one of {}", known.join(", ")), "this is none of them");
            SamplingMethod::Grid
        }
    }
}

/// An integer from 0 to 1e8; 1, with a message, for other values.
fn whole(reader: &mut ExperimentReader, key: &str, value: &ExperimentValue<'_>) -> u64 {
    let number = scalar(value.get_ref()).and_then(|t| t.parse::<u64>().ok()).filter(|n| *n <= 100_000_000);
    if number.is_none() {
        reader.wrong_kind(key, value, "a whole number that is not negative");
    }
    number.unwrap_or(1)
}

/// Reads `[sweep.parameters]`. Dotted keys arrive as tables inside tables; `prefix` is the name so far.
fn parameters(
    reader: &mut ExperimentReader,
    prefix: &str,
    value: &ExperimentValue<'_>,
    out: &mut Vec<(String, ParameterVariation)>,
) {
    let DeValue::Table(table) = value.get_ref() else {
        reader.wrong_kind("parameters", value, "a table of parameters");
        return;
    };
    for (key, value) in table {
        let name = if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
        match value.get_ref() {
            DeValue::Table(inner) if inner.iter().all(|(_, v)| v.get_ref().is_table()) && !inner.is_empty() => {
                parameters(reader, &name, value, out);
            }
            DeValue::Table(_) => out.extend(spread(reader, value).map(|s| (name, s))),
            DeValue::Array(items) => {
                let all: Option<Vec<String>> = items.iter().map(|v| scalar(v.get_ref())).collect();
                match all {
                    Some(all) => out.push((name, ParameterVariation::Values(all.join(",")))),
                    None => reader.wrong_kind(&name, value, "a list of numbers"),
                }
            }
            other => match scalar(other) {
                Some(text) => out.push((name, ParameterVariation::Values(text))),
                None => reader.wrong_kind(&name, value, "values, or a table with `min` and `max`, or `sigma`"),
            },
        }
    }
}

fn spread(reader: &mut ExperimentReader, value: &ExperimentValue<'_>) -> Option<ParameterVariation> {
    let table = value.get_ref().as_table()?;
    let (mut min, mut max, mut sigma, mut logarithmic) = (None, None, None, false);
    for (key, value) in table {
        match key.get_ref().as_ref() {
            "min" => min = scalar(value.get_ref()),
            "max" => max = scalar(value.get_ref()),
            "sigma" => sigma = scalar(value.get_ref()),
            "log" => logarithmic = value.get_ref().as_bool().unwrap_or(false),
            other => reader.unknown(other, &key.span(), SPREAD_KEYS),
        }
    }
    match (min, max, sigma) {
        (Some(min), Some(max), None) => Some(ParameterVariation::Range { min, max, logarithmic }),
        (None, None, Some(sigma)) => Some(ParameterVariation::Sigma(sigma)),
        _ => {
            reader.report(&value.span(), "a parameter varies by `min` and `max`, or by `sigma`", "this one");
            None
        }
    }
}

/// Reads `[sweep.results]`.
fn results(reader: &mut ExperimentReader, value: &ExperimentValue<'_>, out: &mut Vec<(String, String)>) {
    let DeValue::Table(table) = value.get_ref() else {
        reader.wrong_kind("results", value, "a table of names and expressions");
        return;
    };
    for (key, value) in table {
        out.extend(reader.text(key.get_ref(), value).map(|t| (key.get_ref().to_string(), t)));
    }
}
