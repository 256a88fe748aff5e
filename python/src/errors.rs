//! Diagnostics as Python exceptions.

use bramah::{Diagnostic, Severity, Sources};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// `bramah.Error` of what went wrong.
pub fn raised(py: Python<'_>, error: &bramah::Error) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import("bramah.errors")?.getattr("Error")?;
        let all: Vec<Bound<'_, PyDict>> =
            error.diagnostics.iter().map(|d| fields(py, d, &error.sources)).collect::<PyResult<_>>()?;
        Ok(PyErr::from_value(class.call1((error.full(), all))?))
    };
    made().unwrap_or_else(|other| other)
}

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
        let line = 1 + source.text[..label.span.start as usize].matches('\n').count();
        (source.path.clone(), line)
    });
    dict.set_item("file", place.as_ref().map(|p| &p.0))?;
    dict.set_item("line", place.as_ref().map(|p| p.1))?;
    Ok(dict)
}
