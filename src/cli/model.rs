//! From what the user names to a compiled model, and everything there is to say about it.

use std::path::{Path, PathBuf};

use super::Failure;
use super::messages::Messages;
use super::request::library_folders;
use bramah_analysis::experiment::Experiment;
use bramah_circuit::compiled::CompiledModel;
use bramah_model::compile::{Flattened, Outcome, Request};
use bramah_model::flat::FlatModel;
use bramah_model::instance::Override;
use bramah_model::network::Graph;
use bramah_model::structure::Dae;
use bramah_solve::lower::Options;
use bramah_syntax::diag::{Diagnostic, Severity};
use bramah_syntax::world::DiskWorld;

/// Up to the flat model, which exists also where the equations do not fit together.
pub(super) fn flatten(experiment: &Experiment, messages: &mut Messages) -> Result<Flattened, Failure> {
    let outcome = bramah_model::compile::flatten(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Name, components and connections, also where ports are open.
pub(super) fn graph(experiment: &Experiment, messages: &mut Messages) -> Result<(String, Graph), Failure> {
    let outcome = bramah_model::compile::graph(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Up to the sorted equations, without running.
pub(super) fn sort(experiment: &Experiment, messages: &mut Messages) -> Result<(FlatModel, Graph, Dae), Failure> {
    let outcome = bramah_model::compile::sort(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Names of all models of a source that can run.
pub(super) fn runnable(experiment: &Experiment) -> Result<Vec<String>, Failure> {
    let found = bramah_model::compile::runnable(&DiskWorld, &request(experiment)?)
        .map_err(|diagnostics| Failure { diagnostics })?;
    Ok(found.into_iter().map(|r| r.class).collect())
}

/// The description of a class, or nothing.
pub(super) fn described(request: &Request, class: &str) -> String {
    let all = bramah_model::compile::runnable(&DiskWorld, request).unwrap_or_default();
    all.into_iter().find(|r| r.class == class).map(|r| r.description).unwrap_or_default()
}

/// The whole way to a system that can run.
pub(super) fn compile(experiment: &Experiment, messages: &mut Messages) -> Result<CompiledModel, Failure> {
    let outcome = bramah_circuit::compiled::compile(&DiskWorld, &request(experiment)?, &Options::default());
    pass(outcome, experiment, messages)
}

pub(super) fn request(experiment: &Experiment) -> Result<Request, Failure> {
    Ok(Request {
        source: source(Path::new(experiment.file.as_deref().unwrap_or_default())),
        model: experiment.model.clone(),
        overrides: overrides(experiment),
        libraries: library_folders(experiment)?,
        beside: Vec::new(),
        externals: experiment.external.iter().map(|file| external(file)).collect(),
        ..Request::default()
    })
}

/// The whole path of a file, by which a library is found where it is loaded.
fn external(file: &str) -> PathBuf {
    let path = Path::new(file);
    if path.exists() { std::path::absolute(path).unwrap_or_else(|_| path.into()) } else { path.into() }
}

/// The file or folder that is named; the whole path of one in a package whose folders lie above where the command runs.
pub(super) fn source(named: &Path) -> PathBuf {
    let in_package = named.is_relative() && !named.starts_with("..") && Path::new("package.mo").exists();
    let whole = if in_package && named.exists() { std::path::absolute(named).ok() } else { None };
    whole.unwrap_or_else(|| named.to_path_buf())
}

fn overrides(experiment: &Experiment) -> Vec<Override> {
    let of = |(name, value): &(String, String)| Override { name: name.clone(), value: value.clone() };
    experiment.set.iter().map(of).collect()
}

/// Says remarks and warnings and hands out the value, or fails with everything that was said.
fn pass<T>(outcome: Outcome<T>, experiment: &Experiment, messages: &mut Messages) -> Result<T, Failure> {
    messages.sources = outcome.sources;
    let mut diagnostics = outcome.diagnostics;
    if experiment.deny_warnings == Some(true) {
        diagnostics.iter_mut().for_each(deny);
    }
    let failed = diagnostics.iter().any(Diagnostic::is_error);
    match outcome.value {
        Some(value) if !failed => {
            messages.say(&diagnostics);
            Ok(value)
        }
        _ => Err(Failure { diagnostics }),
    }
}

fn deny(diagnostic: &mut Diagnostic) {
    if diagnostic.severity == Severity::Warning {
        diagnostic.severity = Severity::Error;
    }
}
