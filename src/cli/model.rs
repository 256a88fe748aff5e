//! From what the user names to a compiled model, and everything there is to say about it.

use std::path::{Path, PathBuf};

use super::CommandFailure;
use super::messages::MessageReporter;
use super::request::library_folders;
use bramah_analysis::experiment::ExperimentSpecification;
use bramah_circuit::compiled::CompiledModel;
use bramah_model::compile::{CompileOutcome, FrontEndResult, Request};
use bramah_model::flat::FlatModel;
use bramah_model::instance::Override;
use bramah_model::network::ComponentGraph;
use bramah_model::structure::Dae;
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::{Diagnostic, Severity};
use bramah_syntax::world::DiskWorld;

/// Up to the flat model, which exists also where the equations do not fit together.
pub(super) fn flatten(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<FrontEndResult, CommandFailure> {
    let outcome = bramah_model::compile::flatten(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Name, components and connections, also where ports are open.
pub(super) fn graph(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<(String, ComponentGraph), CommandFailure> {
    let outcome = bramah_model::compile::graph(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Up to the sorted equations, without running.
pub(super) fn sort(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<(FlatModel, ComponentGraph, Dae), CommandFailure> {
    let outcome = bramah_model::compile::sort(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Names of all models of a source that can run.
pub(super) fn runnable(experiment: &ExperimentSpecification) -> Result<Vec<String>, CommandFailure> {
    let found = bramah_model::compile::runnable(&DiskWorld, &request(experiment)?)
        .map_err(|diagnostics| CommandFailure { diagnostics })?;
    Ok(found.into_iter().map(|r| r.class).collect())
}

/// The description of a class, or nothing.
pub(super) fn described(request: &Request, class: &str) -> String {
    let all = bramah_model::compile::runnable(&DiskWorld, request).unwrap_or_default();
    all.into_iter().find(|r| r.class == class).map(|r| r.description).unwrap_or_default()
}

/// The whole way to a system that can run.
pub(super) fn compile(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<CompiledModel, CommandFailure> {
    let outcome = bramah_circuit::compiled::compile(&DiskWorld, &request(experiment)?, &LoweringOptions::default());
    pass(outcome, experiment, messages)
}

pub(super) fn request(experiment: &ExperimentSpecification) -> Result<Request, CommandFailure> {
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

fn overrides(experiment: &ExperimentSpecification) -> Vec<Override> {
    let of = |(name, value): &(String, String)| Override { name: name.clone(), value: value.clone() };
    experiment.set.iter().map(of).collect()
}

/// Says remarks and warnings and hands out the value, or fails with everything that was said.
fn pass<T>(
    outcome: CompileOutcome<T>,
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<T, CommandFailure> {
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
        _ => Err(CommandFailure { diagnostics }),
    }
}

fn deny(diagnostic: &mut Diagnostic) {
    if diagnostic.severity == Severity::Warning {
        diagnostic.severity = Severity::Error;
    }
}
