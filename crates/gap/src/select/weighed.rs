//! Fits with their left-out errors, by two weightings of the signals.
//!
//! A MAP estimate weighs errors as large and as correlated as it leaves them, so it can have two solutions: one in
//! which the tolerances hold and one in which the data do. Both are tried here, and left-out data with the prior
//! decide. Called by `search`, `rivals` and the verdict. Method: `docs/gap_method.md`, "Two weightings".

use super::super::clock::Deadline;
use super::super::estimate::{CandidateModel, FitTask, ModelFit, SignalWeights};
use super::super::problem::DiagnosisProblem;
use super::compare::{SensorAccuracy, differences, evidence, gap, signal_gap, t_statistic};
use super::folds::{LeftOutErrors, left_out};
use super::models;
use crate::policy::{LEAST, OTHER_WEIGHTING, SETTLING, SURE};

/// A fitted model with its left-out errors.
#[derive(Clone, Debug)]
pub struct CrossValidatedFit {
    /// The fit to all train data.
    pub fit: ModelFit,
    /// Left-out errors by scheme: first by pieces, then by recordings if there are enough of them.
    pub left: Vec<LeftOutErrors>,
}

impl CrossValidatedFit {
    /// Computes the left-out errors of a fit.
    pub fn new(problem: &DiagnosisProblem<'_>, fit: ModelFit) -> Self {
        CrossValidatedFit { left: left_out(&fit, &problem.train), fit }
    }

    /// Noise-free gap of left-out pieces over all signals, in parts of full scale.
    pub fn gap(&self, sensors: &SensorAccuracy) -> f64 {
        gap(&self.left[0], sensors)
    }
}

/// Fits a model from the coordinates `x` with both weightings and keeps the one that left-out data and the prior
/// prefer. The second weighting is left out behind the deadline. `None` if the model cannot be simulated.
pub fn weighed(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    (candidate, x): (CandidateModel, Vec<f64>),
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let task = problem.task(until);
    let one = CrossValidatedFit::new(problem, as_they_are(task, candidate, x)?);
    let other = if until.is_over() { None } else { at_the_noise(problem, sensors, &one, until) };
    Some(other.unwrap_or(one))
}

/// Fits a model again with the weights that it left, until left-out data see no difference or the time is over.
/// A model that is not at its optimum would be improved by any effect.
pub fn settled(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    mut model: CrossValidatedFit,
    until: Deadline<'_>,
) -> CrossValidatedFit {
    for round in 0..SETTLING {
        // the first round ignores the deadline, so that every accepted model is fitted at least once more
        let until = if round == 0 { Deadline::default() } else { until };
        if until.is_over() {
            break;
        }
        let (candidate, x) = (model.fit.candidate.clone(), model.fit.x.clone());
        let Some(fit) = as_they_are(problem.task(until), candidate, x) else { break };
        let next = CrossValidatedFit::new(problem, fit);
        if !better(&model, &next, sensors) {
            break;
        }
        model = next;
    }
    model
}

/// The model with the widths of all its effects free; `None` if it has no widths or left-out data do not prefer it.
pub fn widened(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let causes = one.fit.causes();
    let wider = models::candidate(problem, &causes, Some(&one.fit.tolerances()), causes.len())?;
    if wider.coordinates.len() <= one.fit.x.len() {
        return None;
    }
    let x = wider.present();
    let fitted = weighed(problem, sensors, (wider, x), until)?;
    (ahead(one, &fitted, sensors) > 0.0).then_some(fitted)
}

/// The model before a rival, fitted anew from the rival's parameters; `None` if left-out data do not prefer that.
/// It has no deadline, since a model before that is not at its optimum would make an effect of anything.
pub fn as_in(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    before: &CrossValidatedFit,
    rival: &ModelFit,
) -> Option<CrossValidatedFit> {
    // the rival has the same coordinates first; those of its additional cause come last
    let x = rival.x[..before.fit.x.len()].to_vec();
    let other = CrossValidatedFit::new(
        problem,
        as_they_are(problem.task(Deadline::default()), before.fit.candidate.clone(), x)?,
    );
    better(before, &other, sensors).then_some(other)
}

/// A fit that weighs errors as large and as correlated as it leaves them, in two rounds.
fn as_they_are(task: FitTask<'_>, candidate: CandidateModel, x: Vec<f64>) -> Option<ModelFit> {
    ModelFit::of(candidate, x, task, None, 2)
}

/// The same for a model that contains the model `before`.
/// If it comes out behind that one, it is fitted from the weights of `before` too, and the better fit counts.
pub fn no_worse(task: FitTask<'_>, before: &ModelFit, candidate: CandidateModel, x: Vec<f64>) -> Option<ModelFit> {
    let fit = as_they_are(task, candidate.clone(), x.clone());
    if fit.as_ref().is_some_and(|f| before.ahead(f) >= 0.0) {
        return fit;
    }
    let weights = Some(before.weights.clone());
    let other = ModelFit::of(candidate, x, task, weights, 2);
    fit.into_iter().chain(other).reduce(ModelFit::better_of)
}

/// A fit that begins as if only the sensors' noise were left; `None` if left-out data do not prefer it to `one`.
pub fn at_the_noise(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let task = problem.task(until);
    let white = SignalWeights::sensors(&sensors.noise, &problem.full_scale);
    let (candidate, x) = (one.fit.candidate.clone(), one.fit.x.clone());
    // one round with white weights, then the usual weighting from the point that it found
    let begun = ModelFit::of(candidate, x, task, Some(white), 1)?;
    let other = CrossValidatedFit::new(problem, as_they_are(task, begun.candidate, begun.x)?);
    better(one, &other, sensors).then_some(other)
}

/// Whether left-out data surely prefer the second of two fits of one model: by [`OTHER_WEIGHTING`] nats, or by any
/// evidence with a t statistic over blocks above [`SURE`].
fn better(one: &CrossValidatedFit, other: &CrossValidatedFit, sensors: &SensorAccuracy) -> bool {
    let ahead = ahead(one, other, sensors);
    let surely = || t_statistic(&differences(&one.left[0], &other.left[0], sensors)) > SURE;
    ahead > OTHER_WEIGHTING || ahead > 0.0 && surely()
}

/// A fit that begins with the parameters at their data sheet; `None` if they are near it, or left-out data do not
/// prefer it. What was missing before has bent the parameters, and the fit with the effect need not find back.
pub fn from_nominal(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let ModelFit { candidate, x, .. } = &one.fit;
    if one.fit.prior() <= OTHER_WEIGHTING {
        return None;
    }
    let begun = as_they_are(problem.task(until), candidate.clone(), at_nominal(problem, candidate, x))?;
    let other = CrossValidatedFit::new(problem, begun);
    (ahead(one, &other, sensors) > 0.0).then_some(other)
}

/// The coordinates `x` with all tolerance parameters at their nominal values.
pub fn at_nominal(problem: &DiagnosisProblem<'_>, candidate: &CandidateModel, x: &[f64]) -> Vec<f64> {
    let nominal = candidate.coordinates.iter().zip(&problem.tolerances).map(|(c, t)| c.of(t.nominal));
    // tolerance parameters are always the first coordinates
    nominal.chain(x[problem.tolerances.len()..].iter().copied()).collect()
}

/// Evidence of left-out data for `b` over `a`, nats, by the scheme of this index.
/// The number of independent samples follows from the larger correlation time of the two fits.
pub fn nats(a: &CrossValidatedFit, b: &CrossValidatedFit, scheme: usize, sensors: &SensorAccuracy) -> f64 {
    let tau = |i: usize| a.fit.weights.tau[i].max(b.fit.weights.tau[i]);
    let independent: Vec<f64> = (0..sensors.noise.len()).map(|i| a.fit.samples(i) / tau(i)).collect();
    evidence(&a.left[scheme], &b.left[scheme], &independent, sensors)
}

/// Prior that `b` saves over `a`, nats.
/// Without the effect parameters move off their data sheet, which left-out data cannot see.
pub fn saved(a: &CrossValidatedFit, b: &CrossValidatedFit) -> f64 {
    a.fit.prior() - b.fit.prior()
}

/// Nats by which left-out pieces and the prior prefer `b` to `a`.
pub fn ahead(a: &CrossValidatedFit, b: &CrossValidatedFit, sensors: &SensorAccuracy) -> f64 {
    nats(a, b, 0, sensors) + saved(a, b)
}

/// Noise-free gap of a signal in its SI unit; a small positive number where it is closed, so that ratios exist.
pub fn left_by(left: &LeftOutErrors, signal: usize, sensors: &SensorAccuracy) -> f64 {
    signal_gap(left, signal, sensors).max(0.1 * LEAST * sensors.full_scale[signal])
}
