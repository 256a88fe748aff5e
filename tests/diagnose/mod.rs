//! Compiles a text, and runs it if asked to, and tells what bramah says about it. Used by several test files.
#![allow(dead_code, reason = "each test file uses a part")]

use bramah::Request;
use bramah::internals::compile::CompileOutcome;
use bramah::internals::diag::{Diagnostic, Severity, Sources};
use bramah::internals::expr::VarId;
use bramah::internals::lower::LoweringOptions;
use bramah::internals::solve::{Control, RowSink, Settings, simulate};
use bramah::world::MemoryWorld;
use std::ops::ControlFlow;

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
    let world = MemoryWorld::single("model.mo", text);
    let request = Request { source: "model.mo".into(), model: model.map(Into::into), ..Request::default() };
    let CompileOutcome { sources, mut diagnostics, value } =
        bramah::internals::compile::compile(&world, &request, &LoweringOptions::INTERPRETED);
    if let Some(model) = value.filter(|_| run) {
        let all = (0..model.flat.variables.len()).map(|i| VarId(u32::try_from(i).expect("few variables")));
        let settings = Settings { wanted: all.collect(), ..Settings::from_experiment(&model.flat.experiment) };
        let ended = simulate(&model.system, &settings, &[], None, &mut Nowhere, &mut Control::default());
        diagnostics.extend(ended.diagnostics);
    }
    Report { sources, diagnostics }
}

/// Forgets the results.
struct Nowhere;

impl RowSink for Nowhere {
    fn row(&mut self, _time: f64, _values: &[f64]) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
