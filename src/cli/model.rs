//! From what the user names to a compiled model, stage by stage.

use std::path::PathBuf;

use super::messages::Messages;
use super::request::library_folders;
use super::{DiskWorld, Failure};
use crate::diag::{Checked, Diagnostic, Severity};
use crate::experiment::Experiment;
use crate::instance::Override;
use crate::structure::Dae;
use crate::units;
use crate::{Flattened, Request};

/// Parses, resolves, instantiates and flattens; says what there is to say.
pub(super) fn flatten(experiment: &Experiment, messages: &mut Messages) -> Result<Flattened, Failure> {
    let request = Request {
        source: PathBuf::from(experiment.file.as_deref().unwrap_or_default()),
        model: experiment.model.clone(),
        overrides: overrides(experiment),
        libraries: library_folders(experiment)?,
    };
    let outcome = crate::flatten(&DiskWorld, &request);
    messages.sources = outcome.sources;
    let mut diagnostics = outcome.diagnostics;
    if let Some(flattened) = &outcome.value {
        diagnostics.extend(units::check(&flattened.flat));
    }
    pass(Checked { value: outcome.value, diagnostics }, experiment, messages)
}

/// Sorts the equations.
pub(super) fn structure(
    flattened: &Flattened,
    experiment: &Experiment,
    messages: &mut Messages,
) -> Result<Dae, Failure> {
    pass(crate::analyze(&flattened.flat), experiment, messages)
}

fn overrides(experiment: &Experiment) -> Vec<Override> {
    let of = |(name, value): &(String, String)| Override { name: name.clone(), value: value.clone() };
    experiment.set.iter().map(of).collect()
}

/// Says remarks and warnings and hands out the value, or fails with everything that was said.
fn pass<T>(mut checked: Checked<T>, experiment: &Experiment, messages: &Messages) -> Result<T, Failure> {
    if experiment.deny_warnings == Some(true) {
        checked.diagnostics.iter_mut().for_each(deny);
    }
    let failed = checked.diagnostics.iter().any(Diagnostic::is_error);
    match checked.value {
        Some(value) if !failed => {
            messages.say(&checked.diagnostics);
            Ok(value)
        }
        _ => Err(Failure { diagnostics: checked.diagnostics }),
    }
}

fn deny(diagnostic: &mut Diagnostic) {
    if diagnostic.severity == Severity::Warning {
        diagnostic.severity = Severity::Error;
    }
}
