//! Parameter estimation and diagnosis from recordings. A study file and its recordings enter, by their paths or as
//! texts
//! from Python; reports leave, as JSON, text and HTML.

#![allow(clippy::disallowed_methods, reason = "notes how long a diagnosis took")]

use crate::errors::raised;
use crate::threads::pooled;
use bramah::internals::diag::render::full;
use bramah::world::{DiskWorld, MemoryWorld, Overlay};
use bramah::{Budget, DiagnoseOptions, Error, IdentifyMethod, IdentifyOptions, Stage, diagnose_as};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

/// A world with files that Python holds in memory, laid over those of the disk.
fn world(files: Vec<(String, String)>) -> Overlay<'static> {
    let mut held = MemoryWorld::default();
    files.into_iter().for_each(|(path, text)| held.add(path, text));
    Overlay { base: &DiskWorld, files: held }
}

/// JSON report, words and warnings of a fit by `auto`, `output` or `inverse`, from so many starts.
#[pyfunction]
#[pyo3(signature = (files, study, data, method, starts, seed))]
pub fn identify(
    py: Python<'_>,
    files: Vec<(String, String)>,
    study: String,
    data: Option<String>,
    method: &str,
    starts: usize,
    seed: u64,
) -> PyResult<(String, String, String)> {
    let method = match method {
        "auto" => IdentifyMethod::Auto,
        "output" => IdentifyMethod::Output,
        "inverse" => IdentifyMethod::Inverse,
        other => {
            let text = format!("the method is \"auto\", \"output\" or \"inverse\", not {other:?}");
            return Err(PyValueError::new_err(text));
        }
    };
    let options = IdentifyOptions { method, starts, seed };
    let data = data.as_deref().map(Path::new);
    let found = py.detach(|| pooled(|| bramah::identify_as(&world(files), Path::new(&study), data, &options)));
    let found = found.map_err(|e| raised(py, &e))?;
    let json = serde_json::to_string(&found.report).expect("numbers and texts always serialize");
    let messages = found.messages();
    Ok((json, found.words, messages))
}

/// The result of a diagnosis: verdict as JSON, text, report as HTML, corrected model if there is one, warnings.
type Found = (String, String, String, Option<String>, String);

/// Diagnoses; `progress` hears of each stage.
#[pyfunction]
#[pyo3(signature = (files, study, data, effect, budget, progress))]
pub fn diagnose(
    py: Python<'_>,
    files: Vec<(String, String)>,
    study: String,
    data: Option<String>,
    effect: Option<String>,
    budget: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let begun = std::time::Instant::now();
    // A negative, infinite or zero time is refused.
    let positive = |seconds: f64| Duration::try_from_secs_f64(seconds).ok().filter(|t| !t.is_zero());
    let no_time = || PyValueError::new_err("the budget must be a time above zero, s");
    let time = budget.map(|seconds| positive(seconds).ok_or_else(no_time)).transpose()?;
    let mut stopped = None;
    let work = || -> Result<Found, Error> {
        let world = world(files);
        let mut show = |stage: Stage| {
            // Called between stages, so that Ctrl-C ends the diagnosis.
            let asked = Python::attach(|py| {
                py.check_signals()?;
                progress.as_ref().map_or(Ok(()), |p| p.call1(py, (stage.to_string(),)).map(drop))
            });
            match asked {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    stopped = Some(error);
                    ControlFlow::Break(())
                }
            }
        };
        // The time is measured here, because crates below the command read no clock.
        let gone = || begun.elapsed();
        let budget = Some(Budget { time, gone: &gone });
        let options = DiagnoseOptions { data: data.as_deref().map(Path::new), budget, effect: effect.as_deref() };
        let (mut diagnosis, sources) = diagnose_as(&world, Path::new(&study), options, &mut show)?;
        diagnosis.took(begun.elapsed().as_secs_f64());
        let json = serde_json::to_string(diagnosis.verdict()).expect("numbers and texts always serialize");
        let fixed = diagnosis.corrected();
        let warnings = [diagnosis.diagnostics(), &fixed.diagnostics].concat();
        Ok((json, diagnosis.words(), diagnosis.report(), fixed.value, full(&sources, &warnings)))
    };
    let found = py.detach(|| pooled(work));
    match stopped {
        // An exception of Python takes precedence over the error that the stop has caused.
        Some(error) => Err(error),
        None => found.map_err(|e| raised(py, &e)),
    }
}
