//! Diagnostics with their texts, as the error of a function.

use super::render::{DiagnosticFormat, full, render};
use super::{Diagnostic, Sources};
use std::fmt;
use std::sync::Arc;

/// What went wrong, with the texts that its places point into. Prints as short messages, one a line, in `Debug` too: a
/// test's `unwrap` shows what a user reads, not the texts of the library.
#[derive(Clone)]
pub struct Error {
    /// The diagnostics, errors among them.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts.
    pub sources: Arc<Sources>,
}

impl Error {
    /// What the command prints: with the text concerned, causes and help.
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
