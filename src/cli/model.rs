//! Compiles the model that the user names, up to the stage that a subcommand needs, and reports its messages.
//!
//! An `ExperimentSpecification` enters. It becomes a compile request for the disk. The result of a stage leaves, and
//! its warnings go to the [`MessageReporter`].
//!
//! `--deny-warnings` is applied here, so it works for all subcommands alike.

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

/// Compiles up to the flat model (scalar variables and equations).
///
/// It exists even when the number of equations is wrong. `Err`: an earlier stage has errors.
pub(super) fn flatten(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<FrontEndResult, CommandFailure> {
    let outcome = bramah_model::compile::flatten(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// The name of the class with its components and connections, even when ports are still open.
pub(super) fn graph(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<(String, ComponentGraph), CommandFailure> {
    let outcome = bramah_model::compile::graph(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Compiles up to the sorted equations, without machine code. `Err`: the model has errors.
pub(super) fn sort(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<(FlatModel, ComponentGraph, Dae), CommandFailure> {
    let outcome = bramah_model::compile::sort(&DiskWorld, &request(experiment)?);
    pass(outcome, experiment, messages)
}

/// Full names of all models in the source that can run. `Err`: the source cannot be read.
pub(super) fn runnable(experiment: &ExperimentSpecification) -> Result<Vec<String>, CommandFailure> {
    let found = bramah_model::compile::runnable(&DiskWorld, &request(experiment)?)
        .map_err(|diagnostics| CommandFailure { diagnostics })?;
    Ok(found.into_iter().map(|r| r.class).collect())
}

/// The description of a class; empty when it has none or is not found.
pub(super) fn described(request: &Request, class: &str) -> String {
    let all = bramah_model::compile::runnable(&DiskWorld, request).unwrap_or_default();
    all.into_iter().find(|r| r.class == class).map(|r| r.description).unwrap_or_default()
}

/// Compiles a model completely, ready to run. `Err`: the model has errors.
pub(super) fn compile(
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<CompiledModel, CommandFailure> {
    let outcome = bramah_circuit::compiled::compile(&DiskWorld, &request(experiment)?, &LoweringOptions::default());
    pass(outcome, experiment, messages)
}

/// The compile request for an experiment. `Err`: a folder of `--library` does not exist.
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

/// The absolute path of a file that external functions call. Names that are no files stay as they are.
fn external(file: &str) -> PathBuf {
    // A relative path would be searched again wherever the library is loaded.
    let path = Path::new(file);
    if path.exists() { std::path::absolute(path).unwrap_or_else(|_| path.into()) } else { path.into() }
}

/// The path to compile: the one the user named, or its absolute form inside a package.
///
/// The absolute form is needed when the working directory belongs to a package: its enclosing folders, which give the
/// full class name, are not part of a relative path.
pub(super) fn source(named: &Path) -> PathBuf {
    // A path that begins with `..` leads out of this folder and reaches the packages above by itself.
    let in_package = named.is_relative() && !named.starts_with("..") && Path::new("package.mo").exists();
    let whole = if in_package && named.exists() { std::path::absolute(named).ok() } else { None };
    whole.unwrap_or_else(|| named.to_path_buf())
}

/// The values of `--set` as overrides of the request.
fn overrides(experiment: &ExperimentSpecification) -> Vec<Override> {
    let of = |(name, value): &(String, String)| Override { name: name.clone(), value: value.clone() };
    experiment.set.iter().map(of).collect()
}

/// Takes over the texts of a stage, prints its messages and returns its value.
///
/// With `--deny-warnings` warnings count as errors. `Err` has all diagnostics when there is an error or no value; they
/// are then printed by `main`.
fn pass<T>(
    outcome: CompileOutcome<T>,
    experiment: &ExperimentSpecification,
    messages: &mut MessageReporter,
) -> Result<T, CommandFailure> {
    // Before anything is printed, as the labels point into these texts.
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

/// Raises a warning to an error. Notes stay.
fn deny(diagnostic: &mut Diagnostic) {
    if diagnostic.severity == Severity::Warning {
        diagnostic.severity = Severity::Error;
    }
}
