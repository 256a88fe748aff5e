//! Diagnostics together with their texts, as the error type of functions that fail.
//! The front crate and the Python package hand it to their users.

use super::render::{DiagnosticFormat, full, render};
use super::{Diagnostic, Sources};
use std::fmt;
use std::sync::Arc;

/// What went wrong, with the texts that the places point into.
///
/// `Display` prints short messages, one a line. `Debug` does the same, so that the `unwrap` of a test shows what a user
/// reads and not the texts of the library.
#[derive(Clone)]
pub struct Error {
    /// The diagnostics, errors among them.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that the spans of the diagnostics refer to.
    pub sources: Arc<Sources>,
}

impl Error {
    /// The messages as the command prints them: with lines of the text, causes and help.
    pub fn full(&self) -> String {
        full(&self.sources, &self.diagnostics)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(render(&self.sources, &self.diagnostics, DiagnosticFormat::Short, 120, false).trim_end())
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Error(\n{self}\n)")
    }
}

impl std::error::Error for Error {}
