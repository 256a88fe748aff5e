//! A study with its compiled model, as `identify` needs it.

use std::path::{Path, PathBuf};

use super::CommandFailure;
use super::messages::MessageReporter;
use bramah_analysis::study::{BoundStudy, Recording, RecordingRole, Study};
use bramah_circuit::compiled::CompiledModel;
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::{Diagnostic, Sources, StageResult};
use bramah_syntax::world::DiskWorld;

/// A study tied to its model.
pub(super) struct StudySession {
    /// The model.
    pub model: CompiledModel,
    /// The study.
    pub bound: BoundStudy,
    /// The texts of the study and its recordings.
    sources: Sources,
    data: Option<PathBuf>,
}

/// Reads a study, compiles its model and ties both together. Recordings are read relative to `data`.
pub(super) fn open(
    path: &Path,
    data: Option<&Path>,
    messages: &mut MessageReporter,
) -> Result<StudySession, CommandFailure> {
    let mut sources = Sources::default();
    let study = said(Study::read(&DiskWorld, path, &mut sources), &sources, messages)?;
    let outcome = bramah_circuit::compiled::compile(&DiskWorld, &study.request(), &LoweringOptions::default());
    messages.sources = outcome.sources;
    let Some(model) = outcome.value else { return Err(CommandFailure { diagnostics: outcome.diagnostics }) };
    messages.say(&outcome.diagnostics);
    let bound = said(study.bind(&model.flat), &sources, messages)?;
    Ok(StudySession { model, bound, sources, data: data.map(Path::to_owned) })
}

impl StudySession {
    /// Reads the recordings of one role.
    pub fn load(
        &mut self,
        role: RecordingRole,
        messages: &mut MessageReporter,
    ) -> Result<Vec<Recording>, CommandFailure> {
        let checked = self.bound.load(&DiskWorld, self.data.as_deref(), role, &mut self.sources);
        said(checked, &self.sources, messages)
    }

    /// A failure whose places lie in the study or its recordings.
    pub fn failure(&self, diagnostics: Vec<Diagnostic>, messages: &mut MessageReporter) -> CommandFailure {
        messages.sources = self.sources.clone();
        CommandFailure { diagnostics }
    }
}

/// Says remarks and warnings about texts of the study and hands out the value, or fails.
fn said<T>(checked: StageResult<T>, sources: &Sources, messages: &mut MessageReporter) -> Result<T, CommandFailure> {
    messages.sources = sources.clone();
    messages.value(checked)
}
