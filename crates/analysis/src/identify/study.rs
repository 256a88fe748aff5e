//! From a study file to its parameters.

use super::{Identification, IdentificationProblem, IdentificationReport, IdentifyMethod, doubts, fit_words};
use crate::study::{Recording, RecordingRole, Study};
use bramah_circuit::compiled::compile;
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Diagnostic, Error, Sources, StageResult};
use bramah_syntax::world::World;
use std::path::Path;
use std::sync::Arc;

/// Parameters found from recordings.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The numbers; serializes as the JSON of `bramah identify`.
    pub report: IdentificationReport,
    /// The same in words for people.
    pub words: String,
    /// Warnings about study, recordings and fit.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that these point into.
    pub sources: Arc<Sources>,
}

impl Identified {
    /// The warnings as the command prints them.
    pub fn messages(&self) -> String {
        full(&self.sources, &self.diagnostics)
    }
}

/// Reads a study, and finds the parameters that it lists from its recordings.
///
/// ```no_run
/// use bramah::world::DiskWorld;
///
/// # fn main() -> Result<(), bramah::Error> {
/// let found = bramah::identify(&DiskWorld, "rig/study.toml".as_ref())?;
/// println!("{}", found.words);
/// println!("{}", found.report.parameters["load.J"]["value"]);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// What is wrong with the study, its model or its recordings; that runs fail.
pub fn identify(world: &dyn World, study: &Path) -> Result<Identified, Error> {
    identify_as(world, study, None, &IdentifyOptions::default())
}

/// How parameters are searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifyOptions {
    /// Against which errors.
    pub method: IdentifyMethod,
    /// From so many places, the values of the model first.
    pub starts: usize,
    /// Draws the places.
    pub seed: u64,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        IdentifyOptions { method: IdentifyMethod::Auto, starts: 1, seed: 1 }
    }
}

/// The same with a choice of method and starts, and with recordings from another folder than that of the study.
///
/// # Errors
/// As [`identify`].
pub fn identify_as(
    world: &dyn World,
    study: &Path,
    data: Option<&Path>,
    asked: &IdentifyOptions,
) -> Result<Identified, Error> {
    let mut said = IdentificationMessages::default();
    let read = Study::read(world, study, &mut said.sources);
    let study = said.take(read)?;
    let outcome = compile(world, &study.request(), &LoweringOptions::default());
    let Some(model) = outcome.value else {
        return Err(Error { diagnostics: outcome.diagnostics, sources: Arc::new(outcome.sources) });
    };
    let bound = said.take(study.bind(&model.flat))?;
    let load = |role, said: &mut IdentificationMessages| -> Result<Vec<Recording>, Error> {
        let loaded = bound.load(world, data, role, &mut said.sources);
        said.take(loaded)
    };
    let train = load(RecordingRole::Train, &mut said)?;
    let problem = IdentificationProblem::new(&model, &bound, &train).map_err(|d| said.error(d))?;
    let found = Identification::new(&problem, &train, asked.method).map_err(|d| said.error(vec![d]))?;
    let fit = found.fit_from(asked.starts, asked.seed).map_err(|d| said.error(vec![d]))?;
    let held = if bound.has(RecordingRole::Held) { load(RecordingRole::Held, &mut said)? } else { Vec::new() };
    let held = match held.is_empty() {
        true => Vec::new(),
        false => found.judge_held(&fit, &held).map_err(|d| said.error(vec![d]))?,
    };
    said.diagnostics.extend(found.suspicions.iter().cloned());
    said.diagnostics.extend(doubts(&problem, &fit, &held));
    Ok(Identified {
        report: IdentificationReport::new(&problem, &found, &fit, &held, &[]),
        words: fit_words(&problem, &fit, &held),
        diagnostics: said.diagnostics,
        sources: Arc::new(said.sources),
    })
}

/// What was said so far, with the texts it points into.
#[derive(Default)]
struct IdentificationMessages {
    sources: Sources,
    diagnostics: Vec<Diagnostic>,
}

impl IdentificationMessages {
    fn take<T>(&mut self, checked: StageResult<T>) -> Result<T, Error> {
        let Some(value) = checked.value else { return Err(self.error(checked.diagnostics)) };
        self.diagnostics.extend(checked.diagnostics);
        Ok(value)
    }

    fn error(&self, diagnostics: Vec<Diagnostic>) -> Error {
        Error { diagnostics, sources: Arc::new(self.sources.clone()) }
    }
}
