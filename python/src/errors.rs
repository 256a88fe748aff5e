//! Turns diagnostics into Python exceptions. All functions of the package that fail call [`raised`].

use bramah::{Diagnostic, Severity, Sources};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The exception `bramah.Error` for an error: its message as the command prints it, and its diagnostics as
/// dictionaries.
/// If the exception itself cannot be made, the error of Python is returned.
pub fn raised(py: Python<'_>, error: &bramah::Error) -> PyErr {
    let made = || -> PyResult<PyErr> {
        // The class is defined in Python, so that users can catch and document it there.
        let class = py.import("bramah.errors")?.getattr("Error")?;
        let all: Vec<Bound<'_, PyDict>> =
            error.diagnostics.iter().map(|d| fields(py, d, &error.sources)).collect::<PyResult<_>>()?;
        Ok(PyErr::from_value(class.call1((error.full(), all))?))
    };
    made().unwrap_or_else(|other| other)
}

/// The fields of a diagnostic: code, severity, message, help, file and line. The last two are `None` without a place.
fn fields<'py>(py: Python<'py>, diagnostic: &Diagnostic, sources: &Sources) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let severity = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    dict.set_item("code", diagnostic.code.id())?;
    dict.set_item("severity", severity)?;
    dict.set_item("message", &diagnostic.message)?;
    dict.set_item("help", diagnostic.help.join("\n"))?;
    let place = diagnostic.labels.first().map(|label| {
        let source = sources.get(label.span.file);
        // Lines count from 1.
        let line = 1 + source.text[..label.span.start as usize].matches('\n').count();
        (source.path.clone(), line)
    });
    dict.set_item("file", place.as_ref().map(|p| &p.0))?;
    dict.set_item("line", place.as_ref().map(|p| p.1))?;
    Ok(dict)
}
