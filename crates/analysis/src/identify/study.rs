//! The whole identification in one call: from a study file to estimated parameters.
//!
//! A world of files and the path of a study enter; an [`Identified`] with numbers, text and warnings leaves. The
//! library `bramah` and the Python package call it; the command takes the single steps, because it prints between them.

use super::{Identification, IdentificationProblem, IdentificationReport, IdentifyMethod, doubts, fit_words};
use crate::study::{Recording, RecordingRole, Study};
use bramah_circuit::compiled::compile;
use bramah_solve::lower::LoweringOptions;
use bramah_syntax::diag::render::full;
use bramah_syntax::diag::{Diagnostic, Error, Sources, StageResult};
use bramah_syntax::world::World;
use std::path::Path;
use std::sync::Arc;

/// The result of [`identify`].
#[derive(Clone, Debug)]
pub struct Identified {
    /// The numbers; serializes as the JSON of `bramah identify`.
    pub report: IdentificationReport,
    /// The result as text.
    pub words: String,
    /// Warnings about study, recordings and fit.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that the warnings point into.
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

/// Options of [`identify_as`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifyOptions {
    /// The residual to minimise.
    pub method: IdentifyMethod,
    /// Number of searches; the first one starts from the values of the model.
    pub starts: usize,
    /// Seed of the random starts.
    pub seed: u64,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        IdentifyOptions { method: IdentifyMethod::Auto, starts: 1, seed: 1 }
    }
}

/// As [`identify`], with options, and with recordings from the folder `data` in place of the folder of the study.
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
    // Held recordings are read only after the fit, so that they cannot influence it.
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

/// Warnings so far, with the texts that they point into.
#[derive(Default)]
struct IdentificationMessages {
    sources: Sources,
    diagnostics: Vec<Diagnostic>,
}

impl IdentificationMessages {
    /// The value of a stage, whose warnings are kept; an error where the stage has none.
    fn take<T>(&mut self, checked: StageResult<T>) -> Result<T, Error> {
        let Some(value) = checked.value else { return Err(self.error(checked.diagnostics)) };
        self.diagnostics.extend(checked.diagnostics);
        Ok(value)
    }

    /// An error with these diagnostics.
    fn error(&self, diagnostics: Vec<Diagnostic>) -> Error {
        Error { diagnostics, sources: Arc::new(self.sources.clone()) }
    }
}
