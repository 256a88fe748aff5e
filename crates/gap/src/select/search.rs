//! The search: one effect after another, until no hypothesis is sure, worth it and confirmed; then whether a shape that has
//! no name says more.

use super::super::clock::{Budget, Deadline};
use super::super::data::RecordingData;
use super::super::estimate::{CandidateModel, ModelFit};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{EFFECTS, SEEN, SETTLING};
use super::super::problem::{DiagnosisProblem, HypothesisValues, ToleranceParameter};
use super::choose::{AcceptedEffect, EffectSelector, HypothesisTrial};
use super::compare::needed;
use super::confirm::HoldoutRecordings;
use super::criteria::{CrossValidationScore, RejectionReason, RivalHypothesis, SelectionCriteria};
use super::models;
use super::rivals::fitted;
use super::screen::{ScreeningContext, screened};
use super::weighed::{CrossValidatedFit, ahead, as_in, left_by, settled, weighed, widened};
use bramah_syntax::diag::Diagnostic;
use partners::EffectExplanation;
use std::fmt;
use std::ops::ControlFlow;

mod partners;

/// A stage of the diagnosis, for progress bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The model within its tolerances.
    Tolerances,
    /// All hypotheses, looking for the n-th effect.
    Screen(usize),
    /// The best of them, fitted.
    Fit(usize),
    /// Shapes without a name.
    Shapes,
    /// Figures of the verdict.
    Figures,
}

impl fmt::Display for Stage {
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

/// Why there is no verdict.
#[derive(Clone, Debug)]
pub enum DiagnosisError {
    /// The nominal model could not be compiled with its parameters free.
    Model(Vec<Diagnostic>),
    /// It does not reach the end of a recording: the file, and when it stops, s.
    Stops(String, f64),
    /// Whoever watches did not want to go on.
    Stopped,
}

/// Hears of each stage as it begins, and may end the search there.
pub type DiagnosisProgress<'a> = &'a mut dyn FnMut(Stage) -> ControlFlow<()>;

/// Passes stages on; once it was asked to stop, no stage begins.
struct StageWatch<'a> {
    progress: DiagnosisProgress<'a>,
    stopped: bool,
}

impl StageWatch<'_> {
    fn begin(&mut self, stage: Stage) -> Option<()> {
        self.stopped = self.stopped || (self.progress)(stage).is_break();
        (!self.stopped).then_some(())
    }
}

/// What a search came to.
pub struct EffectSearchResult {
    /// The model within its tolerances.
    pub base: CrossValidatedFit,
    /// With everything that was taken.
    pub last: CrossValidatedFit,
    /// What was taken, in the order of the last model's causes.
    pub taken: Vec<AcceptedEffect>,
    /// A shape that says more of what is left than any effect.
    pub shape: Option<AcceptedEffect>,
    /// Share of the hypotheses that these recordings would show at their usual size.
    pub visible: f64,
    /// What the judge says of an effect that was asked for.
    pub asked: Option<String>,
    /// Everything that was weighed, best of each step first.
    pub trials: Vec<HypothesisTrial>,
}

/// A search on its way.
struct EffectSearch<'a> {
    problem: &'a DiagnosisProblem<'a>,
    chooser: EffectSelector<'a>,
    /// Share of the hypotheses of the first step that would be seen.
    visible: Option<f64>,
    trials: Vec<HypothesisTrial>,
    /// What the screen left aside in this step.
    passed: Vec<HypothesisTrial>,
    /// What is worth it in the last step, where left-out data were sure of nothing.
    undecided: Vec<RivalHypothesis>,
    /// Shapes were worth a fit beside the last model.
    shape_says_more: bool,
    /// When the time is over.
    ends: Deadline<'a>,
}

/// Searches, for so long; held recordings only confirm.
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
    for step in 1..=EFFECTS + 1 {
        let found = if step <= EFFECTS { search.step(step, &mut last, &mut watch) } else { None };
        let found = found.or_else(|| {
            watch.begin(Stage::Shapes)?;
            search.shape(step, &mut last)
        });
        if taken.is_empty() {
            base.clone_from(&last);
        }
        let Some((chosen, effect)) = found else { break };
        if search.h(effect.hypothesis).is_shape() {
            shape = Some(effect);
            break;
        }
        last = search.freed(chosen);
        taken.push(effect);
        search.drop_needless(&mut last, &mut taken);
        let reconsiders = step == 2 && taken.len() == 2;
        if reconsiders {
            let stands = search.reconsidered(&base, EffectExplanation { model: last, taken });
            (last, taken) = (stands.model, stands.taken);
        }
        // what stands alone has been asked for a second effect
        if search.is_recording_error(&taken) || reconsiders && taken.len() < 2 {
            break;
        }
    }
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

/// One hypothesis beside the model within its tolerances, taken whether it may be or not, with the reason why not; `None`
/// where the model has no values with it.
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
    let taken = vec![AcceptedEffect { hypothesis, evidence: *evidence, t: *t, closes, set: Vec::new() }];
    let said = reason
        .as_ref()
        .map_or_else(|| "among no others it would be taken".to_string(), |why| format!("it would be refused: {why}"));
    Ok(Some(EffectSearchResult { base, last, taken, shape: None, visible: 1.0, asked: Some(said), trials }))
}

/// The model within its tolerances, and what a search needs.
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
    let ends = Deadline::of(budget, || drop(nominal.evaluate(&x, &problem.train)));
    let until = ends.of_step();
    let base = weighed(problem, &sensors, (nominal.clone(), x.clone()), until);
    let base = base.ok_or_else(|| stops(problem, &nominal, &x))?;
    let base = settled(problem, &sensors, base, until);
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

/// A hypothesis for which the time did not last.
fn passed(step: usize, hypothesis: usize) -> HypothesisTrial {
    let chosen = HypothesisValues { hypothesis, values: Vec::new() };
    HypothesisTrial { step, chosen, found: None, reason: Some(RejectionReason::Behind) }
}

/// Where the nominal model stops.
fn stops(problem: &DiagnosisProblem<'_>, nominal: &CandidateModel, x: &[f64]) -> DiagnosisError {
    let stop = |(r, file): (&RecordingData, &String)| Some(DiagnosisError::Stops(file.clone(), nominal.stops(x, r)?));
    let first = problem.train.iter().zip(&problem.files).find_map(stop);
    first.unwrap_or_else(|| DiagnosisError::Stops(String::new(), 0.0))
}

impl EffectSearch<'_> {
    fn h(&self, index: usize) -> &Hypothesis {
        &self.problem.hypotheses[index]
    }

    /// The rival that is taken. If from its parameters the model before comes out so well that the rival shows nothing beside
    /// it, that one was not at its optimum: it moves there, and the rivals are compared with it again.
    fn choose(
        &mut self,
        step: usize,
        before: &mut CrossValidatedFit,
        rivals: Vec<RivalHypothesis>,
    ) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let mut choice = self.chooser.choose(step, before, rivals.clone(), self.ends);
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

    /// Looks for one more effect.
    fn step(
        &mut self,
        step: usize,
        before: &mut CrossValidatedFit,
        watch: &mut StageWatch<'_>,
    ) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let open = self.open(&before.fit);
        self.beside(step, before, &open, watch)
    }

    /// The best of some hypotheses beside a model.
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

    fn shapes(&self) -> Vec<usize> {
        (0..self.problem.hypotheses.len()).filter(|&i| self.h(i).is_shape()).collect()
    }

    /// A shape beside a model to which no effect could be added; or an effect after all, if with a shape it is sure that
    /// something is missing.
    fn shape(&mut self, step: usize, last: &mut CrossValidatedFit) -> Option<(CrossValidatedFit, AcceptedEffect)> {
        let mut rivals = self.rivals(step, last, &self.shapes(), None);
        self.shape_says_more = !rivals.is_empty();
        if rivals.is_empty() {
            self.trials.append(&mut self.passed);
            return None;
        }
        // they are weighed once: now
        let again =
            |t: &HypothesisTrial| t.step == step && self.undecided.iter().any(|r| r.hypothesis == t.chosen.hypothesis);
        self.trials.retain(|t| !again(t));
        rivals.append(&mut self.undecided);
        self.choose(step, last, rivals)
    }

    /// A shape in the place of the only effect, where one may say something beside it, if it surely leaves less: then the
    /// effect is named for want of a better one.
    fn shape_instead(
        &mut self,
        base: &CrossValidatedFit,
        last: &CrossValidatedFit,
        watch: &mut StageWatch<'_>,
    ) -> Option<AcceptedEffect> {
        if !self.shape_says_more {
            return None;
        }
        self.undecided.clear();
        let (model, shape) = self.beside(2, &mut base.clone(), &self.shapes(), watch)?;
        let SelectionCriteria { sensors, .. } = &self.chooser.criteria;
        let leaves_less = model.gap(sensors) < last.gap(sensors) && self.chooser.criteria.worse(&model, last).is_some();
        leaves_less.then_some(shape)
    }

    /// Hypotheses with a name that may be tried beside what was taken.
    fn open(&self, before: &ModelFit) -> Vec<usize> {
        let taken: Vec<usize> = before.candidate.causes.iter().map(|c| c.hypothesis).collect();
        let one_law = |i: usize, t: usize| {
            let (a, b) = (self.h(i), self.h(t));
            a.law() == b.law() && a.attachments[0].site.is_at(&b.attachments[0].site)
        };
        let known = |i: usize, t: &ToleranceParameter| t.name == self.h(i).attachments[0].place.place && !t.free;
        let may_be_off =
            |i: usize| self.h(i).family != "parameter" || self.problem.tolerances.iter().any(|t| known(i, t));
        let open = |&i: &usize| {
            let first = !self.h(i).is_recording_error() || taken.is_empty();
            first && !self.h(i).is_shape() && may_be_off(i) && !taken.iter().any(|&t| t == i || one_law(i, t))
        };
        (0..self.problem.hypotheses.len()).filter(open).collect()
    }

    /// The rivals of a step, each fitted.
    fn rivals(
        &mut self,
        step: usize,
        before: &CrossValidatedFit,
        open: &[usize],
        watch: Option<&mut StageWatch<'_>>,
    ) -> Vec<RivalHypothesis> {
        if self.visible.is_some() && self.chooser.criteria.nothing_is_worth_it(before) {
            return Vec::new();
        }
        // a step that ends before it begins would only add to what was fitted when there was time
        if self.visible.is_some() && self.ends.is_over() {
            self.passed = open.iter().map(|&i| passed(step, i)).collect();
            return Vec::new();
        }
        let (problem, sensors) = (self.problem, &self.chooser.criteria.sensors);
        let ground = ScreeningContext { problem, sensors, before: &before.fit };
        let until = self.ends.of_step();
        let screen = screened(&ground, open, until.of_step());
        let seen = |visible: &[f64]| visible.iter().filter(|v| **v > SEEN).count() as f64 / visible.len().max(1) as f64;
        self.visible.get_or_insert(seen(&screen.visible));
        if watch.is_some_and(|w| w.begin(Stage::Fit(step)).is_none()) {
            return Vec::new();
        }
        let found = fitted(&ground, screen.order, until);
        self.passed = found.passed.into_iter().chain(screen.passed).map(|i| passed(step, i)).collect();
        found.rivals
    }

    /// The model of a step that is taken: with its widths free, at its optimum.
    fn freed(&self, chosen: CrossValidatedFit) -> CrossValidatedFit {
        let (problem, sensors) = (self.problem, &self.chooser.criteria.sensors);
        let wider = widened(problem, sensors, &chosen, self.ends);
        settled(problem, sensors, wider.unwrap_or(chosen), self.ends)
    }

    /// A model fitted from where it is.
    fn weighed(&self, model: CandidateModel) -> Option<CrossValidatedFit> {
        let x = model.present();
        weighed(self.problem, &self.chooser.criteria.sensors, (model, x), self.ends)
    }

    /// Drops what was taken before and is not missed any more.
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

    fn is_recording_error(&self, taken: &[AcceptedEffect]) -> bool {
        taken.iter().any(|t| self.h(t.hypothesis).is_recording_error())
    }
}
