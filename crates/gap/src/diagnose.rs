//! A diagnosis from its study to what is shown of it: verdict, words, page, corrected model.

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

/// What a diagnosis came to.
pub struct Diagnosis<'a> {
    question: DiagnosisStudy<'a>,
    held: HoldoutData,
    found: EffectSearchResult,
    verdict: Verdict,
}

/// How a gap is diagnosed.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiagnoseOptions<'a> {
    /// The folder of the recordings; that of the study where there is none.
    pub data: Option<&'a Path>,
    /// How long the search may take, by the caller's clock; until all is weighed where nothing is said.
    pub budget: Option<Budget<'a>>,
    /// This effect alone is fitted, and taken even where a search would refuse it: `Effects.SensorLag@p`.
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
    let silent = &mut |_| ControlFlow::Continue(());
    diagnose_as(world, study, DiagnoseOptions::default(), silent).map(|(diagnosis, _)| diagnosis)
}

/// The same with a choice of folder and effect; `progress` hears of each stage and can stop the search. With the texts that
/// the warnings of the diagnosis point into.
///
/// # Errors
/// As [`diagnose`]; `E507` where `progress` stopped it.
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
    /// Searches for what the model lacks; held recordings only confirm. The folder among the options has been read already.
    ///
    /// # Errors
    /// The nominal model does not compile or cannot follow a recording, there is no such effect, or `progress` stopped it.
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
        // The figures are not worth stopping for: they take less than a stage of the search.
        let _ = progress(Stage::Figures);
        let verdict = conclude(problem, &found, &held.recordings, 0.0);
        Ok(Diagnosis { question, held, found, verdict })
    }

    /// Notes in the verdict how long it took, in seconds: only the caller has a clock.
    pub fn took(&mut self, seconds: f64) {
        self.verdict.seconds = seconds;
    }

    /// What was found, with its figures; serializes as the JSON of `bramah gap`.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// The same in words for people.
    pub fn words(&self) -> String {
        words::words(&self.verdict)
    }

    /// The same as one HTML page with network, tables and curves.
    pub fn report(&self) -> String {
        report::report(&self.question.problem, &self.found, &self.verdict, &self.held)
    }

    /// The corrected model, class `Fixed`, with every class it needs, as Modelica text.
    pub fn corrected(&self) -> StageResult<String> {
        fixed::corrected(&self.question.problem, &self.found.last.fit)
    }

    /// Warnings about study and recordings.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.question.diagnostics
    }
}

impl DiagnosisStudy<'_> {
    /// The nominal model and the recordings used, signal by signal: the model is simulated from the inputs alone, after
    /// its initial state was fitted to the first samples.
    ///
    /// # Errors
    /// The nominal model does not compile, or cannot follow a recording.
    pub fn compared(&self) -> Result<Figure, Vec<Diagnostic>> {
        let nominal = models::nominal(&self.problem)?;
        report::compared(&self.problem, &nominal).map_err(|(file, time)| said(DiagnosisError::Stops(file, time)))
    }
}

/// The hypothesis `EFFECT@PLACE`; a mistake of a recording is none.
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

/// What stops a diagnosis: the nominal model does not compile, or cannot follow the recordings.
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

fn bad_data(text: String) -> Vec<Diagnostic> {
    vec![Diagnostic::new(Code::BadData, text)]
}
