//! A study with its compiled model, as `identify` needs it.

use std::path::{Path, PathBuf};

use super::Failure;
use super::messages::Messages;
use bramah_analysis::study::{Bound, Recording, Role, Study};
use bramah_circuit::compiled::CompiledModel;
use bramah_solve::lower::Options;
use bramah_syntax::diag::{Checked, Diagnostic, Sources};
use bramah_syntax::world::DiskWorld;

/// A study tied to its model.
pub(super) struct Opened {
    /// The model.
    pub model: CompiledModel,
    /// The study.
    pub bound: Bound,
    /// The texts of the study and its recordings.
    sources: Sources,
    data: Option<PathBuf>,
}

/// Reads a study, compiles its model and ties both together. Recordings are read relative to `data`.
pub(super) fn open(path: &Path, data: Option<&Path>, messages: &mut Messages) -> Result<Opened, Failure> {
    let mut sources = Sources::default();
    let study = said(Study::read(&DiskWorld, path, &mut sources), &sources, messages)?;
    let outcome = bramah_circuit::compiled::compile(&DiskWorld, &study.request(), &Options::default());
    messages.sources = outcome.sources;
    let Some(model) = outcome.value else { return Err(Failure { diagnostics: outcome.diagnostics }) };
    messages.say(&outcome.diagnostics);
    let bound = said(study.bind(&model.flat), &sources, messages)?;
    Ok(Opened { model, bound, sources, data: data.map(Path::to_owned) })
}

impl Opened {
    /// Reads the recordings of one role.
    pub fn load(&mut self, role: Role, messages: &mut Messages) -> Result<Vec<Recording>, Failure> {
        let checked = self.bound.load(&DiskWorld, self.data.as_deref(), role, &mut self.sources);
        said(checked, &self.sources, messages)
    }

    /// A failure whose places lie in the study or its recordings.
    pub fn failure(&self, diagnostics: Vec<Diagnostic>, messages: &mut Messages) -> Failure {
        messages.sources = self.sources.clone();
        Failure { diagnostics }
    }
}

/// Says remarks and warnings about texts of the study and hands out the value, or fails.
fn said<T>(checked: Checked<T>, sources: &Sources, messages: &mut Messages) -> Result<T, Failure> {
    messages.sources = sources.clone();
    messages.value(checked)
}
