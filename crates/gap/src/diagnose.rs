//! The entry of the crate: from a study file to a [`Diagnosis`] with verdict, words, HTML page and corrected model.
//!
//! Enters: a study and its recordings, read through a `World`. Leaves: a [`Diagnosis`], or the diagnostics of what is
//! wrong. [`fn@diagnose`] and [`diagnose_as`] are called by the library's front and by the command `bramah gap`.

use super::clock::Budget;
use super::fixed;
use super::hypotheses::{Hypothesis, NetworkLocation};
use super::report;
use super::select::models;
use super::select::search::{DiagnosisError, DiagnosisProgress, EffectSearchResult, Stage, explained, search};
use super::study::{DiagnosisStudy, HoldoutData, StudyError, question};
use super::verdict::{Verdict, conclude};
use super::words;
use bramah_analysis::study::Study;
use bramah_plot::Figure;
use bramah_syntax::diag::{Code, Diagnostic, Error, Sources, StageResult};
use bramah_syntax::world::World;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// Result of a diagnosis, with everything that is needed to show it.
pub struct Diagnosis<'a> {
    /// The study with its problem.
    question: DiagnosisStudy<'a>,
    /// Recordings that took no part in fitting.
    held: HoldoutData,
    /// Fitted models and accepted effects.
    found: EffectSearchResult,
    /// The statement that follows from them.
    verdict: Verdict,
}

/// Options of a diagnosis; the default is a complete search without a limit of time.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiagnoseOptions<'a> {
    /// Folder of the recordings; `None` means the folder of the study.
    pub data: Option<&'a Path>,
    /// Time that the search may take. `None` means that all hypotheses are fitted, however long that takes.
    pub budget: Option<Budget<'a>>,
    /// If given, only this effect is fitted, and shown even where a search would reject it. Form:
    /// `Effects.SensorLag@p`.
    pub effect: Option<&'a str>,
}

/// Reads a study, and diagnoses the gap between its model and its recordings.
///
/// ```no_run
/// use bramah::world::DiskWorld;
///
/// # fn main() -> Result<(), bramah::Error> {
/// let diagnosis = bramah::diagnose(&DiskWorld, "rig/study.toml".as_ref())?;
/// println!("{}", diagnosis.words());
/// for effect in &diagnosis.verdict().effects {
///     println!("{} at {}", effect.effect, effect.places[0].place);
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// What is wrong with the study, its model or its recordings.
pub fn diagnose<'a>(world: &'a dyn World, study: &Path) -> Result<Diagnosis<'a>, Error> {
    // nobody watches the progress, so nothing stops the search
    let silent = &mut |_| ControlFlow::Continue(());
    diagnose_as(world, study, DiagnoseOptions::default(), silent).map(|(diagnosis, _)| diagnosis)
}

/// [`fn@diagnose`] with options and progress.
/// `progress` is called at the beginning of each stage and can end the search there.
/// The second value has the texts into which the warnings of the diagnosis point.
///
/// # Errors
/// As [`fn@diagnose`]; `E507` if `progress` ended the search.
pub fn diagnose_as<'a>(
    world: &'a dyn World,
    study: &Path,
    options: DiagnoseOptions<'_>,
    progress: DiagnosisProgress<'_>,
) -> Result<(Diagnosis<'a>, Sources), Error> {
    let data = options.data;
    let mut sources = Sources::default();
    let failed = |diagnostics, sources| Error { diagnostics, sources: Arc::new(sources) };
    let read = Study::read(world, study, &mut sources);
    let Some(study) = read.value else { return Err(failed(read.diagnostics, sources)) };
    let asked = match question(world, &study, data, &mut sources) {
        Ok(asked) => asked,
        // an error of the model points into the model's own texts, not into the study
        Err(StudyError { diagnostics, sources: of_model, .. }) => {
            return Err(failed(diagnostics, of_model.unwrap_or(sources)));
        }
    };
    let held = match asked.held(data, &mut sources) {
        Ok(held) => held,
        Err(diagnostics) => return Err(failed(diagnostics, sources)),
    };
    match Diagnosis::new(asked, held, options, progress) {
        Ok(diagnosis) => Ok((diagnosis, sources)),
        Err(diagnostics) => Err(failed(diagnostics, sources)),
    }
}

impl<'a> Diagnosis<'a> {
    /// Searches for the effects that the model lacks. Held recordings only confirm.
    /// `options.data` is not used: the recordings have been read.
    ///
    /// # Errors
    /// The nominal model does not compile or its simulation does not reach the end of a recording, the effect asked for
    /// does not exist, or `progress` ended the search.
    pub fn new(
        question: DiagnosisStudy<'a>,
        held: HoldoutData,
        options: DiagnoseOptions<'_>,
        progress: DiagnosisProgress<'_>,
    ) -> Result<Self, Vec<Diagnostic>> {
        let problem = &question.problem;
        let found = match options.effect {
            None => search(problem, &held.recordings, options.budget, progress).map_err(said)?,
            Some(asked) => {
                let hypothesis = at(&problem.hypotheses, asked)?;
                let found = explained(problem, &held.recordings, hypothesis, progress).map_err(said)?;
                found.ok_or_else(|| bad_data(format!("the model has no values with `{asked}`")))?
            }
        };
        // The figures take less time than a stage of the search, so a request to stop is ignored here.
        let _ = progress(Stage::Figures);
        // the time is not known here: `took` sets it later
        let verdict = conclude(problem, &found, &held.recordings, 0.0);
        Ok(Diagnosis { question, held, found, verdict })
    }

    /// Writes the duration in seconds into the verdict. Only the caller has a clock.
    pub fn took(&mut self, seconds: f64) {
        self.verdict.seconds = seconds;
    }

    /// The verdict with its figures; serialised it is the JSON of `bramah gap`.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// The verdict as text for people.
    pub fn words(&self) -> String {
        words::words(&self.verdict)
    }

    /// The verdict as one HTML page with network, tables and curves.
    pub fn report(&self) -> String {
        report::report(&self.question.problem, &self.found, &self.verdict, &self.held)
    }

    /// The corrected model as Modelica text: class `Fixed`, with every class that it needs.
    pub fn corrected(&self) -> StageResult<String> {
        fixed::corrected(&self.question.problem, &self.found.last.fit)
    }

    /// Warnings about the study and its recordings.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.question.diagnostics
    }
}

impl DiagnosisStudy<'_> {
    /// A figure of the nominal model and the train recordings, signal by signal.
    /// The model is simulated from the inputs alone; its initial state is fitted to the first samples.
    ///
    /// # Errors
    /// The nominal model does not compile, or its simulation does not reach the end of a recording.
    pub fn compared(&self) -> Result<Figure, Vec<Diagnostic>> {
        let nominal = models::nominal(&self.problem)?;
        report::compared(&self.problem, &nominal).map_err(|(file, time)| said(DiagnosisError::Stops(file, time)))
    }
}

/// Index of the hypothesis that `EFFECT@PLACE` names. Errors of recordings cannot be named.
/// The prefix `Effects.` may be left out, and a place may have any name of its node.
fn at(all: &[Hypothesis], asked: &str) -> Result<usize, Vec<Diagnostic>> {
    let is_asked = |h: &Hypothesis| {
        let (effect, place) = asked.split_once('@').unwrap_or((asked, ""));
        let of_effect = h.effect == effect || h.effect.strip_prefix("Effects.") == Some(effect);
        let here = |p: &&NetworkLocation| p.place == place || p.node.iter().any(|n| n == place);
        of_effect && !h.is_recording_error() && h.places().iter().any(here)
    };
    all.iter().position(is_asked).ok_or_else(|| {
        let text = format!("there is no effect at a place that is called `{asked}`");
        vec![
            Diagnostic::new(Code::BadStudy, text)
                .help("`bramah gap STUDY.toml --list` shows all: `Effects.SensorOffset@p`, for example"),
        ]
    })
}

/// Diagnostics of an error that ended a search.
fn said(trouble: DiagnosisError) -> Vec<Diagnostic> {
    match trouble {
        DiagnosisError::Model(diagnostics) => diagnostics,
        DiagnosisError::Stops(file, time) => {
            let text = format!("the nominal model cannot follow `{file}`: its simulation stops at {time} s");
            let help = "check the units and signs of the inputs in the study, and the model's start values";
            vec![Diagnostic::new(Code::BadData, text).help(help)]
        }
        DiagnosisError::Stopped => vec![Diagnostic::new(Code::Interrupted, "the diagnosis was stopped")],
    }
}

/// One diagnostic about the recordings, with this text.
fn bad_data(text: String) -> Vec<Diagnostic> {
    vec![Diagnostic::new(Code::BadData, text)]
}
