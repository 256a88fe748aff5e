//! Opens a study with its compiled model for `bramah identify`.
//!
//! A study file enters; a [`StudySession`] leaves, from which recordings are read by their role. Study and model have
//! separate source texts, so each message must be printed with the right ones. The functions here switch the sources of
//! the reporter.

use std::path::{Path, PathBuf};

use super::CommandFailure;
use super::messages::MessageReporter;
use bramah_analysis::study::{BoundStudy, Recording, RecordingRole, Study};
use bramah_circuit::compiled::CompiledModel;
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::{Diagnostic, Sources, StageResult};
use bramah_syntax::world::DiskWorld;

/// A study whose names are tied to the variables of its compiled model.
pub(super) struct StudySession {
    /// The compiled model.
    pub model: CompiledModel,
    /// The study with its columns and parameters tied to variables.
    pub bound: BoundStudy,
    /// The texts of the study and its recordings, into which their diagnostics point.
    sources: Sources,
    /// The folder of the recordings; `None` for that of the study.
    data: Option<PathBuf>,
}

/// Reads a study, compiles its model and ties both together. `data` is the folder of the recordings.
///
/// `Err`: the study or the model has errors, or the names do not fit.
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
    /// Reads the recordings of one role. `Err`: a file or column cannot be used.
    pub fn load(
        &mut self,
        role: RecordingRole,
        messages: &mut MessageReporter,
    ) -> Result<Vec<Recording>, CommandFailure> {
        let checked = self.bound.load(&DiskWorld, self.data.as_deref(), role, &mut self.sources);
        said(checked, &self.sources, messages)
    }

    /// A failure whose diagnostics point into the study or its recordings.
    pub fn failure(&self, diagnostics: Vec<Diagnostic>, messages: &mut MessageReporter) -> CommandFailure {
        messages.sources = self.sources.clone();
        CommandFailure { diagnostics }
    }
}

/// Prints warnings that point into the texts of the study and returns the value. `Err` when there are errors.
fn said<T>(checked: StageResult<T>, sources: &Sources, messages: &mut MessageReporter) -> Result<T, CommandFailure> {
    messages.sources = sources.clone();
    messages.value(checked)
}
