//! The search for missing effects, one after another.
//!
//! Enters: a problem with its train recordings, the held recordings and a budget. Leaves: an [`EffectSearchResult`].
//! Each step screens all open hypotheses, fits the promising ones and accepts the best one that left-out data are sure
//! of, that is worth a name and that held recordings confirm. The search ends when a step accepts nothing, or after
//! [`EFFECTS`] effects; then shapes without a physical name are tried on what is left.
//! Method: `docs/gap_method.md`, "Which of several is taken" and "When nothing is sure".

use super::super::clock::{Budget, Deadline};
use super::super::data::RecordingData;
use super::super::estimate::{CandidateModel, ModelFit};
use super::super::hypotheses::Hypothesis;
use super::super::problem::{DiagnosisProblem, HypothesisValues, ToleranceParameter};
use super::choose::{AcceptedEffect, EffectSelector, HypothesisTrial};
use super::compare::needed;
use super::confirm::HoldoutRecordings;
use super::criteria::{CrossValidationScore, RejectionReason, RivalHypothesis, SelectionCriteria};
use super::models;
use super::rivals::fitted;
use super::screen::{ScreeningContext, screened};
use super::weighed::{CrossValidatedFit, ahead, as_in, left_by, settled, weighed, widened};
use crate::policy::{EFFECTS, SEEN, SETTLING};
use bramah_syntax::diag::Diagnostic;
use partners::EffectExplanation;
use std::fmt;
use std::ops::ControlFlow;

mod partners;

/// A stage of the diagnosis, reported for progress bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Fit of the nominal model with its parameters free within their tolerances.
    Tolerances,
    /// Linear screening of all hypotheses, in the search for the n-th effect.
    Screen(usize),
    /// Fits of the most promising hypotheses, in the search for the n-th effect.
    Fit(usize),
    /// Shapes without a physical name, tried on the remaining gap.
    Shapes,
    /// Computation of the verdict's figures.
    Figures,
}

impl fmt::Display for Stage {
    /// Text of the stage for progress bars.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stage::Tolerances => f.write_str("parameters within their tolerances"),
            Stage::Screen(n) => write!(f, "all hypotheses for effect {n}"),
            Stage::Fit(n) => write!(f, "the best of them for effect {n}"),
            Stage::Shapes => f.write_str("shapes of what is left"),
            Stage::Figures => f.write_str("figures"),
        }
    }
}

/// Why a search ended without a result.
#[derive(Clone, Debug)]
pub enum DiagnosisError {
    /// The nominal model with free parameters does not compile.
    Model(Vec<Diagnostic>),
    /// The simulation of the nominal model stops before the end of a recording: the file, and the time in s.
    Stops(String, f64),
    /// The progress callback asked to end the search.
    Stopped,
}

/// Callback at the beginning of each stage. `Break` ends the search before that stage.
pub type DiagnosisProgress<'a> = &'a mut dyn FnMut(Stage) -> ControlFlow<()>;

/// Passes stages on to the progress callback and remembers a request to stop.
struct StageWatch<'a> {
    /// The caller's callback.
    progress: DiagnosisProgress<'a>,
    /// The callback asked to stop; no further stage begins.
    stopped: bool,
}

impl StageWatch<'_> {
    /// Reports a stage. `None` means that the search must end.
    fn begin(&mut self, stage: Stage) -> Option<()> {
        self.stopped = self.stopped || (self.progress)(stage).is_break();
        (!self.stopped).then_some(())
    }
}

/// Result of a search.
pub struct EffectSearchResult {
    /// The nominal model with its parameters fitted within their tolerances.
    pub base: CrossValidatedFit,
    /// The model with all accepted effects; equal to `base` where none was accepted.
    pub last: CrossValidatedFit,
    /// Accepted effects, in the order of the causes of `last`.
    pub taken: Vec<AcceptedEffect>,
    /// A shape without a physical name that was accepted because no effect explains the remaining gap as well.
    pub shape: Option<AcceptedEffect>,
    /// Share of the hypotheses that the recordings would show at their usual size, 0 to 1.
    pub visible: f64,
    /// Only where one effect was asked for: whether it would be accepted, in words.
    pub asked: Option<String>,
    /// Every hypothesis of every step with its score and the reason why it was not taken; best first within a step.
    pub trials: Vec<HypothesisTrial>,
}

/// State of a search.
struct EffectSearch<'a> {
    /// What is diagnosed.
    problem: &'a DiagnosisProblem<'a>,
    /// Criteria of acceptance, with the held recordings.
    chooser: EffectSelector<'a>,
    /// Share of the hypotheses of the first step that the recordings would show; `None` before the first step.
    visible: Option<f64>,
    /// Hypotheses judged so far.
    trials: Vec<HypothesisTrial>,
    /// Hypotheses of the current step that were not fitted for lack of time.
    passed: Vec<HypothesisTrial>,
    /// Hypotheses of the last step that are worth a name although left-out data were not sure of any.
    undecided: Vec<RivalHypothesis>,
    /// At least one shape was fitted beside the last model.
    shape_says_more: bool,
    /// Deadline of the complete search.
    ends: Deadline<'a>,
}

/// Searches for the missing effects within a budget. Held recordings only confirm.
///
/// # Errors
/// [`DiagnosisError`].
pub fn search<'a>(
    problem: &'a DiagnosisProblem<'a>,
    held: &'a [RecordingData],
    budget: Option<Budget<'a>>,
    progress: DiagnosisProgress<'_>,
) -> Result<EffectSearchResult, DiagnosisError> {
    let mut watch = StageWatch { progress, stopped: false };
    let (mut search, mut base) = begun(problem, held, budget, &mut watch)?;
    let (mut last, mut taken) = (base.clone(), Vec::new());
    let mut shape = None;
    // one step more than there may be effects: the last one tries shapes only
    for step in 1..=EFFECTS + 1 {
        let found = if step <= EFFECTS { search.step(step, &mut last, &mut watch) } else { None };
        let found = found.or_else(|| {
            watch.begin(Stage::Shapes)?;
            search.shape(step, &mut last)
        });
        // `choose` may have moved the model without effects to a better optimum
        if taken.is_empty() {
            base.clone_from(&last);
        }
        let Some((chosen, effect)) = found else { break };
        // a shape has no name, so that no effect is searched beside it
        if search.h(effect.hypothesis).is_shape() {
            shape = Some(effect);
            break;
        }
        // until an effect is accepted its widths are fixed
        last = search.freed(chosen);
        taken.push(effect);
        search.drop_needless(&mut last, &mut taken);
        // the first effect was chosen among equals before the second one was known
        let reconsiders = step == 2 && taken.len() == 2;
        if reconsiders {
            let stands = search.reconsidered(&base, EffectExplanation { model: last, taken });
            (last, taken) = (stands.model, stands.taken);
        }
        // What stands alone has already been searched for a second effect.
        // A wrong sign or unit falsifies everything that could be fitted beside it.
        if search.is_recording_error(&taken) || reconsiders && taken.len() < 2 {
            break;
        }
    }
    // a single effect may be only the best approximation in the library: a shape in its place may explain more
    if let [only] = taken.as_slice()
        && !search.h(only.hypothesis).is_recording_error()
        && let Some(instead) = search.shape_instead(&base, &last, &mut watch)
    {
        (shape, last) = (Some(instead), base.clone());
        taken.clear();
    }
    if watch.stopped {
        return Err(DiagnosisError::Stopped);
    }
    let visible = search.visible.unwrap_or(0.0);
    Ok(EffectSearchResult { base, last, taken, shape, visible, asked: None, trials: search.trials })
}

/// Fits one hypothesis beside the model within its tolerances, and accepts it even if the criteria reject it.
/// The verdict of the criteria is in `asked`. `None` if the model with the hypothesis cannot be simulated.
///
/// # Errors
/// [`DiagnosisError`].
pub fn explained(
    problem: &DiagnosisProblem<'_>,
    held: &[RecordingData],
    hypothesis: usize,
    progress: DiagnosisProgress<'_>,
) -> Result<Option<EffectSearchResult>, DiagnosisError> {
    let mut watch = StageWatch { progress, stopped: false };
    // without a budget: one hypothesis is fitted to the end, however long that takes
    let (search, base) = begun(problem, held, None, &mut watch)?;
    watch.begin(Stage::Fit(1)).ok_or(DiagnosisError::Stopped)?;
    let sensors = &search.chooser.criteria.sensors;
    let ground = ScreeningContext { problem, sensors, before: &base.fit };
    let screen = screened(&ground, &[hypothesis], Deadline::default());
    let rivals = fitted(&ground, screen.order, Deadline::default()).rivals;
    let Some(last) = rivals.first().map(|r| r.model.clone()) else { return Ok(None) };
    let closes = 1.0 - last.gap(sensors) / base.gap(sensors).max(f64::MIN_POSITIVE);
    let trials = search.chooser.choose(1, &base, rivals, Deadline::default()).trials;
    let Some(HypothesisTrial { found: Some(CrossValidationScore { evidence, t, .. }), reason, .. }) = trials.first()
    else {
        return Ok(None);
    };
    // there is nothing to be indistinguishable from
    let taken = vec![AcceptedEffect { hypothesis, evidence: *evidence, t: *t, closes, set: Vec::new() }];
    let said = reason
        .as_ref()
        .map_or_else(|| "among no others it would be taken".to_string(), |why| format!("it would be refused: {why}"));
    Ok(Some(EffectSearchResult { base, last, taken, shape: None, visible: 1.0, asked: Some(said), trials }))
}

/// Fits the nominal model within its tolerances and sets up the search.
fn begun<'a>(
    problem: &'a DiagnosisProblem<'a>,
    held: &'a [RecordingData],
    budget: Option<Budget<'a>>,
    watch: &mut StageWatch<'_>,
) -> Result<(EffectSearch<'a>, CrossValidatedFit), DiagnosisError> {
    watch.begin(Stage::Tolerances).ok_or(DiagnosisError::Stopped)?;
    let sensors = models::sensors(problem);
    let nominal = models::nominal(problem).map_err(DiagnosisError::Model)?;
    let x = nominal.present();
    // an unlimited budget of a slow model is counted in simulations, which are timed here
    let ends = Deadline::of(budget, || drop(nominal.evaluate(&x, &problem.train)));
    let until = ends.of_step();
    let base = weighed(problem, &sensors, (nominal.clone(), x.clone()), until);
    let base = base.ok_or_else(|| stops(problem, &nominal, &x))?;
    let base = settled(problem, &sensors, base, until);
    // gaps before any effect: later effects must close a part of these too
    let first = (0..sensors.noise.len()).map(|i| left_by(&base.left[0], i, &sensors)).collect();
    let criteria = SelectionCriteria { sensors, first, count: problem.hypotheses.len() };
    let held = HoldoutRecordings::new(held, &nominal, &x, &criteria.sensors);
    let search = EffectSearch {
        problem,
        chooser: EffectSelector { problem, held, criteria },
        visible: None,
        trials: Vec::new(),
        passed: Vec::new(),
        undecided: Vec::new(),
        shape_says_more: false,
        ends,
    };
    Ok((search, base))
}

/// Entry for a hypothesis that was not fitted for lack of time.
fn passed(step: usize, hypothesis: usize) -> HypothesisTrial {
    let chosen = HypothesisValues { hypothesis, values: Vec::new() };
    HypothesisTrial { step, chosen, found: None, reason: Some(RejectionReason::Behind) }
}

/// The error that names the recording in which the nominal model stops, and when.
fn stops(problem: &DiagnosisProblem<'_>, nominal: &CandidateModel, x: &[f64]) -> DiagnosisError {
    let stop = |(r, file): (&RecordingData, &String)| Some(DiagnosisError::Stops(file.clone(), nominal.stops(x, r)?));
    let first = problem.train.iter().zip(&problem.files).find_map(stop);
    first.unwrap_or_else(|| DiagnosisError::Stops(String::new(), 0.0))
}

impl EffectSearch<'_> {
    /// The hypothesis of this index.
    fn h(&self, index: usize) -> &Hypothesis {
        &self.problem.hypotheses[index]
    }

    /// Chooses a rival, and records all rivals of the step as trials.
    ///
    /// The model before may not have been at its optimum. It is therefore fitted anew from the parameters of the chosen
    /// rival. If the rival then gains no more than the evidence that is needed, that fit replaces the model before, and
    /// the rivals are compared again (`docs/gap_method.md`, "The model before is at its optimum").
    fn choose(
        &mut self,
        step: usize,
        before: &mut CrossValidatedFit,
        rivals: Vec<RivalHypothesis>,
    ) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let mut choice = self.chooser.choose(step, before, rivals.clone(), self.ends);
        // each pass takes a model before that left-out data prefer; the limit bounds the time
        for _ in 0..SETTLING {
            let sensors = &self.chooser.criteria.sensors;
            let Some((rival, _)) = &choice.taken else { break };
            let again = as_in(self.problem, sensors, before, &rival.fit);
            let shows_nothing = |a: &CrossValidatedFit| ahead(a, rival, sensors) <= needed(self.chooser.criteria.count);
            let Some(again) = again.filter(shows_nothing) else { break };
            *before = again;
            choice = self.chooser.choose(step, before, rivals.clone(), self.ends);
        }
        self.trials.append(&mut choice.trials);
        self.trials.append(&mut self.passed);
        self.undecided = choice.undecided;
        choice.taken
    }

    /// Searches for one more effect beside `before`; `None` if nothing is accepted.
    fn step(
        &mut self,
        step: usize,
        before: &mut CrossValidatedFit,
        watch: &mut StageWatch<'_>,
    ) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let open = self.open(&before.fit);
        self.beside(step, before, &open, watch)
    }

    /// Chooses the best of the hypotheses `open` beside a model; `None` if nothing is accepted or the search was
    /// stopped.
    fn beside(
        &mut self,
        step: usize,
        before: &mut CrossValidatedFit,
        open: &[usize],
        watch: &mut StageWatch<'_>,
    ) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        watch.begin(Stage::Screen(step))?;
        let rivals = self.rivals(step, before, open, Some(watch));
        self.choose(step, before, rivals)
    }

    /// Indices of all hypotheses that are shapes.
    fn shapes(&self) -> Vec<usize> {
        (0..self.problem.hypotheses.len()).filter(|&i| self.h(i).is_shape()).collect()
    }

    /// Tries shapes beside a model to which no effect could be added.
    /// If a shape is sure, something is missing: then the undecided effects compete with the shapes again, and an
    /// effect that explains as much is accepted after all. `None` if nothing is accepted.
    fn shape(&mut self, step: usize, last: &mut CrossValidatedFit) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let mut rivals = self.rivals(step, last, &self.shapes(), None);
        self.shape_says_more = !rivals.is_empty();
        if rivals.is_empty() {
            self.trials.append(&mut self.passed);
            return None;
        }
        // the undecided ones are judged again now; their first entry would appear twice
        let again =
            |t: &HypothesisTrial| t.step == step && self.undecided.iter().any(|r| r.hypothesis == t.chosen.hypothesis);
        self.trials.retain(|t| !again(t));
        rivals.append(&mut self.undecided);
        self.choose(step, last, rivals)
    }

    /// A shape in place of the only accepted effect, if it leaves a smaller gap and surely less.
    /// `None` if no shape was promising beside the effect, or none is better.
    fn shape_instead(
        &mut self,
        base: &CrossValidatedFit,
        last: &CrossValidatedFit,
        watch: &mut StageWatch<'_>,
    ) -> Option<AcceptedEffect> {
        if !self.shape_says_more {
            return None;
        }
        // undecided effects take no part: the comparison is between the accepted effect and shapes
        self.undecided.clear();
        let (model, shape) = self.beside(2, &mut base.clone(), &self.shapes(), watch)?;
        let SelectionCriteria { sensors, .. } = &self.chooser.criteria;
        let leaves_less = model.gap(sensors) < last.gap(sensors) && self.chooser.criteria.worse(&model, last).is_some();
        leaves_less.then_some(shape)
    }

    /// Indices of the named hypotheses that may be tried beside the accepted ones.
    ///
    /// Left out are shapes, hypotheses that are accepted already, other forms of an accepted law at the same place, and
    /// parameters without a known tolerance. Errors of recordings are tried only before anything is accepted: a wrong
    /// unit is wrong from the beginning.
    fn open(&self, before: &ModelFit) -> Vec<usize> {
        let taken: Vec<usize> = before.candidate.causes.iter().map(|c| c.hypothesis).collect();
        let one_law = |i: usize, t: usize| {
            let (a, b) = (self.h(i), self.h(t));
            a.law() == b.law() && a.attachments[0].site.is_at(&b.attachments[0].site)
        };
        // a parameter that the study leaves free has no data sheet value from which it could deviate
        let known = |i: usize, t: &ToleranceParameter| t.name == self.h(i).attachments[0].place.place && !t.free;
        let may_be_off =
            |i: usize| self.h(i).family != "parameter" || self.problem.tolerances.iter().any(|t| known(i, t));
        let open = |&i: &usize| {
            let first = !self.h(i).is_recording_error() || taken.is_empty();
            first && !self.h(i).is_shape() && may_be_off(i) && !taken.iter().any(|&t| t == i || one_law(i, t))
        };
        (0..self.problem.hypotheses.len()).filter(open).collect()
    }

    /// Screens and fits the hypotheses of a step.
    /// Empty if no gap is worth a name, if the time is over, or if `watch` ends the search.
    fn rivals(
        &mut self,
        step: usize,
        before: &CrossValidatedFit,
        open: &[usize],
        watch: Option<&mut StageWatch<'_>>,
    ) -> Vec<RivalHypothesis> {
        // The first step always screens, because `visible` is determined by it.
        if self.visible.is_some() && self.chooser.criteria.nothing_is_worth_it(before) {
            return Vec::new();
        }
        // Behind the deadline no further step begins; its hypotheses are recorded as not fitted.
        if self.visible.is_some() && self.ends.is_over() {
            self.passed = open.iter().map(|&i| passed(step, i)).collect();
            return Vec::new();
        }
        let (problem, sensors) = (self.problem, &self.chooser.criteria.sensors);
        let ground = ScreeningContext { problem, sensors, before: &before.fit };
        // screening may take half of the time of the step, the fits have the rest
        let until = self.ends.of_step();
        let screen = screened(&ground, open, until.of_step());
        // share of the hypotheses that gain more than `SEEN` nats
        let seen = |visible: &[f64]| visible.iter().filter(|v| **v > SEEN).count() as f64 / visible.len().max(1) as f64;
        self.visible.get_or_insert(seen(&screen.visible));
        if watch.is_some_and(|w| w.begin(Stage::Fit(step)).is_none()) {
            return Vec::new();
        }
        let found = fitted(&ground, screen.order, until);
        self.passed = found.passed.into_iter().chain(screen.passed).map(|i| passed(step, i)).collect();
        found.rivals
    }

    /// The chosen model with the widths of its corners free, where that is better, fitted to its optimum.
    fn freed(&self, chosen: CrossValidatedFit) -> CrossValidatedFit {
        let (problem, sensors) = (self.problem, &self.chooser.criteria.sensors);
        let wider = widened(problem, sensors, &chosen, self.ends);
        settled(problem, sensors, wider.unwrap_or(chosen), self.ends)
    }

    /// Fits a model from its present parameters with both weightings; `None` if it cannot be simulated.
    fn weighed(&self, model: CandidateModel) -> Option<CrossValidatedFit> {
        let x = model.present();
        weighed(self.problem, &self.chooser.criteria.sensors, (model, x), self.ends)
    }

    /// Drops earlier effects without which the model is not surely worse.
    /// The effect accepted last stays: it has just passed the criteria.
    fn drop_needless(&self, last: &mut CrossValidatedFit, taken: &mut Vec<AcceptedEffect>) {
        let mut i = 0;
        while i + 1 < taken.len() {
            let mut causes = last.fit.causes();
            causes.remove(i);
            let without = models::candidate(self.problem, &causes, Some(&last.fit.tolerances()), causes.len());
            let fitted = without.and_then(|c| self.weighed(c));
            match fitted.filter(|f| self.chooser.criteria.worse(last, f).is_none()) {
                Some(fitted) => {
                    *last = fitted;
                    taken.remove(i);
                }
                None => i += 1,
            }
        }
    }

    /// Whether an error of a recording was accepted.
    fn is_recording_error(&self, taken: &[AcceptedEffect]) -> bool {
        taken.iter().any(|t| self.h(t.hypothesis).is_recording_error())
    }
}
